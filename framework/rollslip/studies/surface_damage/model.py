"""Interface of models of kind ``damage``: one measure of the effect of slip on the surfaces of a contact.

- No measure of smearing, scuffing or wear has general validity. Therefore each is a plugin that states what it
  measures, in which unit, up to which limit if one is published, and what it does not cover (`DamageModel.scope`).
- A model has evaluated slices and their surfaces, and neither bearing nor motion, so that the same measure can be used
  for a steady slip, a map or a rig.
"""

import abc
import json
from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any, ClassVar, Final, Literal, Self

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import Ring
from rollslip.catalogue.kinds import Kind
from rollslip.catalogue.registry import structure_models
from rollslip.errors import DomainError
from rollslip.geometry.surfaces import Material
from rollslip.references import CitedModel
from rollslip.results.dataset import UNITS, about
from rollslip.scene.values import Scene
from rollslip.search import Array
from rollslip.structure import Location
from rollslip.studies.answers import Output, Part
from rollslip_kernels.slices import Slices

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


@attrs.frozen(eq=False, kw_only=True)
class Contacts:
    """Evaluated slices of rollers on one ring, and the materials and temperatures of their surfaces."""

    #: Load, half width, pressure, film thickness, friction and speeds, with the common conditions.
    slices: Slices
    ring: "Ring"  #: The ring.
    #: ring_temperature, roller_temperature: Bulk temperatures [K].
    ring_temperature: float
    roller_temperature: float
    material: Material  #: Material of the raceway.
    #: Material of the rollers.
    roller_material: Material = attrs.field(
        default=attrs.Factory(lambda own: own.material, takes_self=True)
    )

    @classmethod
    def of(cls, assembly: "Assembly", ring: "Ring", slices: Slices) -> "Contacts":
        """Return slices of a bearing with the surfaces of its scene.

        Parameters
        ----------
        assembly : Assembly
            The bearing.
        ring : {"inner", "outer"}
            The ring.
        slices : Slices
            The evaluated slices.
        """
        operation = assembly.scene.operation
        return cls(
            slices=slices,
            ring=ring,
            ring_temperature=getattr(operation, f"{ring}_ring_temperature"),
            roller_temperature=operation.roller_temperature,
            material=assembly.scene.bearing.material_of(ring),
            roller_material=assembly.scene.bearing.material,
        )

    @property
    def surface_speeds(self) -> tuple[Array, Array]:
        """Speeds of ring and roller relative to the contact [m/s], (n,) each, not negative.

        The surface that drives the roller is the faster one: the ring at the inner ring, the roller at the outer ring.
        Of a surface that moves backwards in its contact it is the magnitude.
        """
        u = self.slices.rolling_speed
        V = self.slices.sliding_speed
        ahead = 0.5 * V if self.ring == "inner" else -0.5 * V
        return np.abs(u + ahead), np.abs(u - ahead)

    @property
    def friction_power(self) -> Array:
        """Friction power per length of contact, the magnitude of mu w V [W/m], (n,)."""
        slices = self.slices
        return np.abs(slices.friction * slices.load * slices.sliding_speed)


#: Unit of variables that hold several measures, each in a unit of its own.
OWN: Final = "own SI unit"
#: Outputs that describe each measure.
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


class DamageModel(CitedModel):
    """One measure of the effect of slip on surfaces; its parameters are its attrs fields."""

    #: What it measures, for example "sliding power density".
    measure: ClassVar[str]
    #: SI unit of the measure.
    unit: ClassVar[str]
    #: What it does not cover, or where it was not validated: one sentence without its full stop.
    scope: ClassVar[str]
    #: Whether it is a difference of temperatures, which is printed in K.
    difference: ClassVar[bool] = False
    #: Whether damage is more probable where the measure is large, or where it is small.
    worst: ClassVar[Literal["largest", "smallest"]] = "largest"

    def of(self, assembly: "Assembly") -> Self:
        """Return the measure with the data of oil and bearing for its limit; SceneError if they are missing."""
        return self

    @abc.abstractmethod
    def evaluate(self, contacts: Contacts) -> Array:
        """Return the measure of every slice in its unit, (n,), without changing the slices.

        A slice for which the measure is not defined is a `DomainError`.
        """

    def across(self, contacts: Contacts, places: Array) -> Array | None:
        """Return the measure across the contacts, (n, m); None if it has one value for a slice.

        Parameters
        ----------
        contacts : Contacts
            Contacts with n slices.
        places : ndarray
            Positions across a contact, (m,), in half widths from the middle: -1 is the inlet, 1 the outlet.
        """
        return None

    @property
    def limit(self) -> tuple[float, str] | None:
        """Value beyond which damage was observed, in the unit of the measure, and its source; None if there is none."""
        return None


def named_damage(scene: Scene) -> tuple[DamageModel, ...]:
    """Return the models that a scene names under ``models.damage``, in its order."""
    named = [(choice.name, choice.parameters) for choice in scene.models.damage]
    return structure_models("damage", named, Location(scene.origins, ("models", "damage")))


def damage_of(assembly: "Assembly") -> tuple[DamageModel, ...]:
    """Return the models that a scene names, each with the data of its bearing."""
    return tuple(model.of(assembly) for model in named_damage(assembly.scene))


def values_of(model: DamageModel, contacts: Contacts) -> Array:
    """Return a measure of every slice, (n,); DomainError if a value is not finite.

    Parameters
    ----------
    model : DamageModel
        The measure.
    contacts : Contacts
        Contacts with n slices.
    """
    values = np.asarray(model.evaluate(contacts), dtype=float)
    if not np.isfinite(values).all():
        raise DomainError(
            f"{model.name} has no value for {np.count_nonzero(~np.isfinite(values))} slices"
        )
    return values


def harm(model: DamageModel, values: Any) -> Any:
    """Return values of a measure with such a sign that the largest is the worst.

    Parameters
    ----------
    model : DamageModel
        The measure.
    values : float or ndarray
        The values, of any shape.
    """
    return values if model.worst == "largest" else -values


def described(measures: tuple[DamageModel, ...]) -> dict[str, NDArray[Any]]:
    """Return the variables that describe measures, by the names of `DESCRIBED`, (measures,) each."""
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
    """Return the unit of a measure in results."""
    return "K, a difference" if model.difference else model.unit


def parts(measures: Iterable[DamageModel], reason: str = "models.damage names it") -> list[Part]:
    """Return the lines of a plan about measures, with the reason why they are taken."""
    return [
        Part(part="damage", choice=model.name, resolution=model.equation, reason=reason)
        for model in measures
    ]


def texts(values: Iterable[object]) -> NDArray[Any]:
    """Return values as an array of texts."""
    return np.array([*values], dtype=np.str_)


DAMAGE: Final = Kind(
    name="damage",
    hook="damage_models",
    base=DamageModel,
)
