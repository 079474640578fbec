"""What a model of kind ``thermal`` must offer: how the heat of the losses leaves a bearing, and what it heats.

- A model has nodes, each with one temperature, and says what heat flows into each. It knows nothing of films and slips:
  losses come as power by place (`rollslip_studies.motion.losses`), temperatures go to the scene by its own keys.
- One node *leads*: all balances are found by going through its temperature while the other nodes follow.
- Heat is conserved: what flows into all nodes is what is lost less what is carried away. The conformance kit holds it.
"""

import abc
from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Final, Self, cast

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.catalogue.kinds import Kind
from rollslip.catalogue.registry import structure_model
from rollslip.errors import SceneError
from rollslip.references import Citation
from rollslip.scene.values import Scene
from rollslip.structure import Location
from rollslip.units import format_quantity

if TYPE_CHECKING:
    from rollslip.bearing.assembly import Assembly

__all__ = ["PLACES", "ROLES", "THERMAL", "ThermalModel", "from_bearing", "thermal_model"]

Array = NDArray[np.float64]

#: Where losses make heat: contacts, pockets, the lands that guide the cage, and the oil between the rings.
PLACES: Final = ("inner contact", "outer contact", "pocket", "inner land", "outer land", "oil")
#: Keys of a scene that are bulk temperatures -> what they are called.
ROLES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "operation.temperature": "oil",
        "operation.inner_ring_temperature": "inner ring",
        "operation.roller_temperature": "rollers",
        "operation.outer_ring_temperature": "outer ring",
    }
)


class ThermalModel(abc.ABC):
    """How heat flows between the parts of a bearing and leaves it; its parameters are its attrs fields."""

    name: ClassVar[str]
    equation: ClassVar[str]
    references: ClassVar[tuple[Citation, ...]]
    #: Rule of the conformance kit that the model breaks for a reason -> that reason.
    expected_failures: ClassVar[Mapping[str, str]] = MappingProxyType({})

    @property
    @abc.abstractmethod
    def nodes(self) -> tuple[str, ...]:
        """Names of the nodes, n of them, that which leads first; none if temperatures are not to follow from losses."""

    def of(self, assembly: "Assembly") -> Self:
        """Return the model with all that it leaves to the bearing.

        Heat that has no way out is a `SceneError`, and a bearing that does not give what is needed.
        """
        return self

    @abc.abstractmethod
    def start(self, scene: Scene) -> Array:
        """Return temperatures of the nodes from which their course begins, and the search for balances [K], (n,)."""

    @abc.abstractmethod
    def capacities(self) -> Array:
        """Return heat capacities of the nodes [J/K], (n,), above 0."""

    @abc.abstractmethod
    def inflows(self, temperatures: Array, losses: Mapping[str, float]) -> Array:
        """Return the heat flow into each node [W], (n,), by temperatures [K], (n,), and losses by `PLACES` [W]."""

    @abc.abstractmethod
    def carried_away(self, temperatures: Array) -> dict[str, float]:
        """Return the heat that leaves the bearing, by what carries it [W]."""

    @abc.abstractmethod
    def changes(self, temperatures: Array, scene: Scene) -> dict[str, float]:
        """Return what temperatures [K], (n,), change of the scene that was written: SI values by key, as `ROLES`."""

    @property
    def inlet(self) -> tuple[float, float] | None:
        """Temperature [K] of what flows into the leading node, and heat for each kelvin [W/K]; None for nothing."""
        return None


def thermal_model(scene: Scene) -> ThermalModel | None:
    """Return the model that a scene names under ``models.thermal``; None where temperatures are as they are given."""
    choice = scene.models.thermal
    problems = list[str]()
    if choice is None:
        return None
    where = Location(scene.origins, ("models", "thermal"))
    model: Any = structure_model(
        "thermal", {"model": choice.name, **choice.parameters}, where, problems
    )
    if problems:
        raise SceneError(problems)
    return model  # type: ignore[no-any-return]


def from_bearing(scene: Scene, model: ThermalModel) -> dict[str, str]:
    """Return the parameters that a scene does not give and its model took from the bearing, as people read them."""
    given = thermal_model(scene)
    kinds = cast("Any", type(model))
    if given is None:
        return {}
    return {
        field.name: format_quantity(value, field.metadata.get("unit", "1"), 3)
        for field in attrs.fields(kinds)
        if getattr(given, field.name) is None
        and isinstance(value := getattr(model, field.name), float)
    }


THERMAL: Final = Kind(
    name="thermal",
    hook="thermal_models",
    base=ThermalModel,
)
