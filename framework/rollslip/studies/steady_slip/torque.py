"""Interface of the kind ``torque``: formulas of makers and standards for the friction torque of a bearing.

Such formulas take boundary dimensions and operating conditions, and no slip. Results print them for comparison with the
computed losses; nothing is computed from them. A scene names formulas under ``models.torque``, by default two with
different sources. None of them is a measured torque of one bearing.
"""

import abc
import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.catalogue.kinds import Kind
from rollslip.catalogue.registry import structure_models
from rollslip.errors import DomainError
from rollslip.geometry.bearing import Catalogue
from rollslip.references import CitedModel
from rollslip.results.dataset import about
from rollslip.results.text import Status
from rollslip.scene.values import Scene
from rollslip.structure import Location
from rollslip.studies.answers import Output

__all__ = [
    "FORMULA_OUTPUTS",
    "TORQUE",
    "Duty",
    "TorqueFormula",
    "formula_variables",
    "torque_formulas",
]

#: Ratio of the width of a bearing to the length of its rollers, where the scene has no designation. Formulas with the
#: width scale with it; grade D, within 10 % in reinforced bearings and up to 40 % too small in old and light ones.
_WIDTH_RATIO: Final = 1.65
#: Variables of `formula_variables`.
FORMULA_OUTPUTS: Final[Mapping[str, Output]] = MappingProxyType(
    {
        "formula_torque": Output(
            "formula", "N m", "friction torque of the bearing by formula", status="formula_status"
        ),
        "formula_term": Output("formula_part", "N m", "term of a friction torque by formula"),
        "formula_status": Output("formula", "1", "what was found by a formula"),
        "formula_basis": Output("formula", "1", "what a formula rests on"),
        "formula_estimated": Output(
            "", "1", "what of the bearing's boundary dimensions is estimated for the formulas"
        ),
        "formula_speed": Output(
            "", "m/s", "mean diameter times revolutions in a unit of time, n d_m"
        ),
    }
)


@attrs.frozen(kw_only=True)
class Duty:
    """Boundary dimensions and operating conditions of a bearing, as formulas of catalogues take them.

    Dimensions of a designation are exact. Without one the bore d and the outside diameter D lie half a roller's
    diameter from the raceways, within 9 and 7 % of the bearings whose inner geometry is known, and the width B is 1.65
    times the length of the rollers, within 10 % in reinforced bearings and up to 40 % too small in old and light ones
    (D).
    """

    bore: float  #: Boundary dimension d [m].
    outside_diameter: float  #: Boundary dimension D [m].
    pitch_diameter: float  #: Diameter of the pitch circle d_m [m].
    radial_load: float  #: F_r [N].
    speed: float  #: Relative speed of the rings [rad/s], not negative.
    #: Dynamic viscosity of the oil at its temperature and ambient pressure [Pa s].
    viscosity: float
    density: float | None = None  #: Density of the oil [kg/m3], None if the scene does not know it.
    width: float | None = None  #: Boundary dimension B [m], None if it is not known.
    #: Dimension series as designations have it, such as "22"; empty if the bearing has no designation.
    series: str = ""
    estimated: tuple[
        str, ...
    ] = ()  #: Names of the boundary dimensions that are estimated from the rollers.
    #: Diameter of a roller [m], from which formulas of drag take the height of the centre of the lowest roller.
    roller_diameter: float | None = None
    supply: str = (
        "bath"  #: Supply of oil: "bath", "splash", "circulating", "jet", "mist" or "grease".
    )
    #: Level of a bath above the lowest point of the outer raceway [m]; None for the centre of the lowest roller.
    oil_level: float | None = None
    temperature: float | None = None  #: Temperature of the oil [K], None if it is not known.
    axial_load: float = 0.0  #: F_a on ribs [N].

    @classmethod
    def of(cls, assembly: Assembly, **conditions: float) -> "Duty":
        """Return the duty of an assembled bearing.

        Parameters
        ----------
        assembly : Assembly
            The bearing.
        **conditions : float
            Temperature of the oil, radial load and relative speed of the rings, where they differ from the scene.
        """
        bearing = assembly.scene.bearing
        operation = assembly.scene.operation
        oil = assembly.lubricant
        T = conditions.get("temperature", operation.temperature)
        listed = bearing.catalogue or Catalogue()
        guessed: dict[str, Any] = {
            "bore": bearing.boundaries[0],
            "outside_diameter": bearing.boundaries[1],
            "width": _WIDTH_RATIO * bearing.roller_length,
            "series": "",
        }
        known = {name: value for name in guessed if (value := getattr(listed, name))}
        return cls(
            **guessed | known,
            estimated=tuple(name for name in guessed if name not in known),
            roller_diameter=bearing.roller_diameter,
            supply=assembly.scene.lubrication.supply,
            oil_level=assembly.scene.lubrication.oil_level,
            axial_load=abs(operation.axial_load or 0.0),
            pitch_diameter=bearing.pitch_diameter,
            radial_load=conditions.get("radial_load", operation.radial_load),
            speed=conditions.get("speed", abs(operation.inner_speed - operation.outer_speed)),
            viscosity=oil.at(T).viscosity,
            temperature=T,
            density=None if oil.density is None else oil.density(T),
        )

    @property
    def kinematic_viscosity(self) -> float:
        """Kinematic viscosity of the oil [m2/s]; a `DomainError` where its density is not known."""
        if self.density is None:
            raise DomainError(
                "needs the oil's kinematic viscosity: give lubricant.density, such as '870 kg/m3'"
            )
        return self.viscosity / self.density

    @property
    def viscosity_ratio(self) -> tuple[float, str]:
        """Kappa = nu/nu_1 and its status; NaN where the density of the oil is not known.

        nu_1 = 45000 n^-0.83 d_m^-0.5 below n = 1000/min and 4500 (n d_m)^-0.5 from there on [mm2/s], with the relative
        speed n [1/min] and the pitch diameter d_m [mm], after ISO 281:2007.
        """
        n = self.revolutions
        try:
            nu = 1e6 * self.kinematic_viscosity
        except DomainError as error:
            return math.nan, str(error)
        reference = 45000.0 * n**-0.83 if n < 1000.0 else 4500.0 * n**-0.5
        return nu / (reference * (1e3 * self.pitch_diameter) ** -0.5), Status.FOUND

    @property
    def mean_diameter(self) -> float:
        """Mean of bore and outside diameter, which catalogues call d_m [m]."""
        return 0.5 * (self.bore + self.outside_diameter)

    @property
    def revolutions(self) -> float:
        """Relative speed of the rings [1/min]."""
        return self.speed * 30.0 / math.pi


class TorqueFormula(CitedModel):
    """Friction torque of a bearing by a formula of its boundary dimensions; its parameters are its attrs fields."""

    #: Source of its numbers, in a few words: "tests of ...", "a regression of ...".
    basis: ClassVar[str] = ""

    @abc.abstractmethod
    def terms(self, duty: Duty) -> Mapping[str, float]:
        """Return the terms of the friction torque [N m] by name, each zero or more.

        Raises
        ------
        DomainError
            If the duty lacks a number that the formula takes.
        """


def torque_formulas(scene: Scene) -> tuple[TorqueFormula, ...]:
    """Return the formulas of a scene, ``models.torque``, in its order."""
    return structure_models(
        "torque",
        [(choice.name, choice.parameters) for choice in scene.models.torque],
        Location(scene.origins, ("models", "torque")),
    )


def formula_variables(assembly: Assembly) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the friction torques by the formulas of a scene as variables, and their coordinates.

    Both are empty without formulas, and for a tapered bearing, of which none of them is. The torque is NaN where its
    status says what the formula lacks.
    """
    formulas = torque_formulas(assembly.scene)
    if not formulas or assembly.scene.bearing.contact_angle is not None:
        return {}, {}
    duty = Duty.of(assembly)
    totals = []
    parts = dict[str, float]()
    status = []
    for formula in formulas:
        try:
            terms = formula.terms(duty)
            totals.append(sum(terms.values()))
            parts |= {f"{formula.name}: {term}": torque for term, torque in terms.items()}
            status.append(str(Status.FOUND))
        except DomainError as error:
            totals.append(math.nan)
            status.append(str(error))
    values = {
        "formula_torque": np.array(totals),
        "formula_term": np.array(list(parts.values())),
        "formula_status": np.array(status),
        "formula_basis": np.array([formula.basis for formula in formulas]),
        "formula_estimated": ", ".join(duty.estimated).replace("_", " "),
        "formula_speed": duty.mean_diameter * duty.speed / (2.0 * math.pi),
    }
    return {name: FORMULA_OUTPUTS[name].variable(value) for name, value in values.items()}, {
        "formula": (
            "formula",
            [formula.name for formula in formulas],
            about("1", "formula of the friction torque"),
        ),
        "formula_part": (
            "formula_part",
            np.array(list(parts), dtype=np.str_),
            about("1", "formula and its term"),
        ),
    }


TORQUE: Final = Kind(
    name="torque",
    hook="torque_formulas",
    base=TorqueFormula,
)
