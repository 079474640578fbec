"""What a model of kind ``damage`` must offer: one measure of what slip does to the surfaces of a contact.

- No measure of smearing, scuffing or wear has general validity. That is why each is a plugin that says what it
  measures, in which unit, up to which limit if one is published, and what it does not say (`DamageModel.scope`).
- A model sees evaluated slices and the surfaces that they are of. It knows neither bearing nor motion, so that the same
  measure serves for a steady slip, a map or a rig.
"""

import abc
import json
from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Final, Literal, Self

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.catalogue.kinds import Kind
from rollslip.catalogue.registry import structure_models
from rollslip.datasets import Material
from rollslip.errors import DomainError
from rollslip.references import Citation
from rollslip.results.dataset import UNITS, about
from rollslip.scene.values import Scene
from rollslip.structure import Location
from rollslip.studies.answers import Output, Part
from rollslip_kernels.slices import Slices

if TYPE_CHECKING:
    from rollslip.bearing.assembly import Assembly
    from rollslip.bearing.raceway import Ring

__all__ = [
    "DAMAGE",
    "DESCRIBED",
    "OWN",
    "Contacts",
    "DamageModel",
    "damage_of",
    "described",
    "harm",
    "named",
    "named_damage",
    "parts",
    "texts",
    "values_of",
]

Array = NDArray[np.float64]


@attrs.frozen(eq=False, kw_only=True)
class Contacts:
    """Evaluated slices of rollers on one ring, and what their surfaces are of."""

    #: With load, half width, pressure, film thickness, friction and speeds, and the conditions that they share.
    slices: Slices
    ring: "Ring"  #: The ring.
    #: ring_temperature, roller_temperature: Bulk temperatures [K].
    ring_temperature: float
    roller_temperature: float
    material: Material  #: Of the raceway.
    #: Of the rollers.
    roller_material: Material = attrs.field(
        default=attrs.Factory(lambda own: own.material, takes_self=True)
    )

    @classmethod
    def of(cls, assembly: "Assembly", ring: "Ring", slices: Slices) -> "Contacts":
        """Return slices of a bearing with the surfaces that its scene gives."""
        operation = assembly.scene.operation
        return cls(
            slices=slices,
            ring=ring,
            ring_temperature=operation.inner_ring_temperature
            if ring == "inner"
            else operation.outer_ring_temperature,
            roller_temperature=operation.roller_temperature,
            material=assembly.scene.bearing.material_of(ring),
            roller_material=assembly.scene.bearing.material,
        )

    @property
    def surface_speeds(self) -> tuple[Array, Array]:
        """Speeds of ring and roller relative to the contact [m/s], (n,) each, not negative.

        The surface that pushes the roller forward is the faster one: the ring on the inner side, the roller on the
        outer. A surface that turns back in its contact has the speed of its size.
        """
        u = self.slices.rolling_speed
        V = self.slices.sliding_speed
        ahead = 0.5 * V if self.ring == "inner" else -0.5 * V
        return np.abs(u + ahead), np.abs(u - ahead)

    @property
    def friction_power(self) -> Array:
        """Power that sliding turns into heat on a length of contact, the size of mu w V [W/m], (n,)."""
        slices = self.slices
        return np.abs(slices.friction * slices.load * slices.sliding_speed)


#: Unit of variables that hold several measures, each in a unit of its own.
OWN: Final = "own SI unit"
#: What results say of each measure.
DESCRIBED: Final[Mapping[str, Output]] = MappingProxyType(
    {
        "limit": Output("measure", OWN, "value beyond which harm was seen", status="limit_source"),
        "limit_source": Output("measure", "1", "where the limit comes from"),
        "unit": Output("measure", "1", "unit of the measure"),
        "meaning": Output("measure", "1", "what is measured"),
        "sense": Output("measure", "1", "which value is the worst"),
        "scope": Output("measure", "1", "what the measure does not say"),
    }
)


class DamageModel(abc.ABC):
    """One measure of what slip does to surfaces; its parameters are its attrs fields."""

    name: ClassVar[str]
    equation: ClassVar[str]
    references: ClassVar[tuple[Citation, ...]]
    #: What it measures, as in "sliding power density", and its SI unit.
    measure: ClassVar[str]
    unit: ClassVar[str]
    #: What it does not say, or where it was never tried: one sentence without its full stop.
    scope: ClassVar[str]
    #: Whether it is a difference of temperatures, which is told in K.
    difference: ClassVar[bool] = False
    #: Whether surfaces fare worse where it is large, or where it is small.
    worst: ClassVar[Literal["largest", "smallest"]] = "largest"
    #: Rule of the conformance kit that the model breaks for a reason -> that reason.
    expected_failures: ClassVar[Mapping[str, str]] = MappingProxyType({})

    def of(self, assembly: "Assembly") -> Self:
        """Return the measure with what its limit takes of the oil and the bearing.

        What the scene does not give is a `SceneError`.
        """
        return self

    @abc.abstractmethod
    def evaluate(self, contacts: Contacts) -> Array:
        """Return the measure of every slice in its unit, (n,), without changing the slices.

        A slice outside of what the measure is defined on is a `DomainError`.
        """

    def across(self, contacts: Contacts, places: Array) -> Array | None:
        """Return the measure across the contacts, (n, m); None if it has one value for a slice.

        Places, (m,), are in half widths from the middle, -1 where surfaces enter and 1 where they leave.
        """
        return None

    @property
    def limit(self) -> tuple[float, str] | None:
        """Value beyond which harm was seen, in the unit of the measure, and its source; None if there is none."""
        return None


def named_damage(scene: Scene) -> tuple[DamageModel, ...]:
    """Return the models that a scene names under ``models.damage``, in its order."""
    named = [(choice.name, choice.parameters) for choice in scene.models.damage]
    return structure_models("damage", named, Location(scene.origins, ("models", "damage")))


def damage_of(assembly: "Assembly") -> tuple[DamageModel, ...]:
    """Return the models that a scene names, each with what it takes of the bearing."""
    return tuple(model.of(assembly) for model in named_damage(assembly.scene))


def values_of(model: DamageModel, contacts: Contacts) -> Array:
    """Return a measure of every slice, (n,)."""
    values = np.asarray(model.evaluate(contacts), dtype=float)
    if not np.isfinite(values).all():
        raise DomainError(
            f"{model.name} has no value for {np.count_nonzero(~np.isfinite(values))} slices"
        )
    return values


def harm(model: DamageModel, values: Any) -> Any:
    """Return ``values`` of a measure with the sign by which the larger is the worse, as ``model`` has it."""
    return values if model.worst == "largest" else -values


def described(measures: tuple[DamageModel, ...]) -> dict[str, NDArray[Any]]:
    """Return what results say of measures, by the names of `DESCRIBED`, (measures,) each."""
    limits = [model.limit or (np.nan, "no limit is published or given") for model in measures]
    return {
        "limit": np.array([value for value, _ in limits]),
        "limit_source": texts(source for _, source in limits),
        "unit": texts(map(_unit, measures)),
        "meaning": texts(model.measure for model in measures),
        "sense": texts(model.worst for model in measures),
        "scope": texts(model.scope for model in measures),
    }


def named(measures: tuple[DamageModel, ...]) -> tuple[str, NDArray[Any], dict[str, str]]:
    """Return the coordinate of measures, with the unit of each by its name (`rollslip.results.dataset.UNITS`)."""
    units = {model.name: _unit(model) for model in measures}
    return "measure", texts(units), about("1", "damage model") | {UNITS: json.dumps(units)}


def _unit(model: DamageModel) -> str:
    return "K, a difference" if model.difference else model.unit


def parts(scene: Scene) -> list[Part]:
    """Return the lines of a plan about what is measured."""
    return [
        Part(
            part="damage",
            choice=model.name,
            resolution=model.equation,
            reason="models.damage names it",
        )
        for model in named_damage(scene)
    ]


def texts(words: Iterable[object]) -> NDArray[Any]:
    """Return words as an array."""
    return np.array([*words], dtype=np.str_)


DAMAGE: Final = Kind(
    name="damage",
    hook="damage_models",
    base=DamageModel,
)
