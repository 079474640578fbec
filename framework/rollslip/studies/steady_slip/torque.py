"""What a formula of kind ``torque`` must offer: the friction torque of a bearing as a maker or a standard gives it.

- Such formulas know a bearing from outside and no slip. They stand beside the losses that are computed, as rows of a
  comparison, and nothing is computed with them.
- A scene names those that it wants under ``models.torque``; without any, none is evaluated.
"""

import abc
import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.cards import Card
from rollslip.catalogue.kinds import Kind, Template
from rollslip.catalogue.registry import structure_models
from rollslip.errors import DomainError
from rollslip.references import Citation
from rollslip.results.dataset import about
from rollslip.scene.values import Scene
from rollslip.structure import Location
from rollslip.studies.answers import Output

__all__ = ["BY_FORMULA", "TORQUE", "Duty", "TorqueFormula", "by_formula", "torque_formulas"]

#: What `by_formula` gives.
BY_FORMULA: Final[Mapping[str, Output]] = MappingProxyType(
    {
        "formula_torque": Output(
            "formula", "N m", "friction torque of the bearing by formula", status="formula_status"
        ),
        "formula_term": Output("formula_part", "N m", "term of a friction torque by formula"),
        "formula_status": Output("formula", "1", "what was found by a formula"),
    }
)


@attrs.frozen(kw_only=True)
class Duty:
    """A bearing at work as catalogues know it.

    Attributes
    ----------
    bore, outside_diameter : float
        Boundary dimensions d and D [m], estimated: the raceway of a ring lies half a diameter of a roller from them,
        within 9 and 7 % of the bearings whose inner geometry is known (D).
    pitch_diameter : float
        Diameter of the pitch circle d_m [m].
    radial_load : float
        F_r [N].
    speed : float
        Relative speed of the rings [rad/s], not negative.
    viscosity : float
        Dynamic viscosity of the oil at its temperature and ambient pressure [Pa s].
    density : float or None
        Density of the oil [kg/m3], None if the scene does not know it.
    """

    bore: float
    outside_diameter: float
    pitch_diameter: float
    radial_load: float
    speed: float
    viscosity: float
    density: float | None = None

    @classmethod
    def of(cls, assembly: Assembly) -> "Duty":
        """Return that of a scene."""
        b, operation, oil = assembly.scene.bearing, assembly.scene.operation, assembly.lubricant
        T = operation.temperature
        return cls(
            bore=b.boundaries[0],
            outside_diameter=b.boundaries[1],
            pitch_diameter=0.5 * (b.inner_raceway_diameter + b.outer_raceway_diameter),
            radial_load=operation.radial_load,
            speed=abs(operation.inner_speed - operation.outer_speed),
            viscosity=oil.at(T).viscosity,
            density=None if oil.density is None else oil.density(T),
        )

    @property
    def kinematic_viscosity(self) -> float:
        """Kinematic viscosity of the oil [m2/s].

        Raises
        ------
        DomainError
            If the density of the oil is not known.
        """
        if self.density is None:
            raise DomainError("needs the oil's kinematic viscosity: give lubricant.density, such as '870 kg/m3'")
        return self.viscosity / self.density

    @property
    def revolutions(self) -> float:
        """Relative speed of the rings [1/min]."""
        return self.speed * 30.0 / math.pi


class TorqueFormula(Card, abc.ABC):
    """Friction torque of a bearing by a formula of its boundary dimensions; its parameters are its attrs fields."""

    name: ClassVar[str]
    equation: ClassVar[str]
    references: ClassVar[tuple[Citation, ...]]
    #: Rule of the conformance kit that the formula breaks for a reason -> that reason.
    expected_failures: ClassVar[Mapping[str, str]] = MappingProxyType({})

    @abc.abstractmethod
    def terms(self, duty: Duty) -> Mapping[str, float]:
        """Return the friction torque [N m] by what makes it, none below zero.

        Raises
        ------
        DomainError
            If something is not known that the formula takes.
        """


def torque_formulas(scene: Scene) -> tuple[TorqueFormula, ...]:
    """Return the formulas that a scene names under ``models.torque``, in its order.

    Raises
    ------
    SceneError
        If a parameter of one is wrong, or two are called alike.
    PluginError
        If one does not exist or cannot be loaded.
    """
    named = [(choice.name, choice.parameters) for choice in scene.models.torque]
    return structure_models("torque", named, Location(scene.origins, ("models", "torque")))


def by_formula(assembly: Assembly) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the friction torques by the formulas of the scene as variables, and their coordinates; none without."""
    formulas = torque_formulas(assembly.scene)
    if not formulas:
        return {}, {}
    duty, totals, parts, status = Duty.of(assembly), [], dict[str, float](), []
    for formula in formulas:
        try:
            terms = formula.terms(duty)
            totals.append(sum(terms.values()))
            parts |= {f"{formula.name}: {term}": torque for term, torque in terms.items()}
            status.append("found")
        except DomainError as error:
            totals.append(math.nan)
            status.append(str(error))
    values = {
        "formula_torque": np.array(totals),
        "formula_term": np.array(list(parts.values())),
        "formula_status": np.array(status),
    }
    return {name: BY_FORMULA[name].variable(one) for name, one in values.items()}, {
        "formula": ("formula", [formula.name for formula in formulas], about("1", "formula of the friction torque")),
        "formula_part": ("formula_part", np.array(list(parts), dtype=np.str_), about("1", "formula and its term")),
    }


TORQUE: Final = Kind(
    name="torque",
    hook="torque_formulas",
    base=TorqueFormula,
    template=Template(
        summary="A formula of the friction torque",
        contents="its terms by load, speed, size and oil",
        use="rollslip run 1032930-70C --study steady-slip --set models.torque=${model}",
        classes=("TorqueFormula", "Duty"),
    ),
)
