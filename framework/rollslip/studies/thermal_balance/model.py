"""The interface of models of kind ``thermal``: how the heat of the losses leaves a bearing, and which parts it heats.

- A model is a lumped-parameter network: it has nodes, each with one temperature, and gives the heat flow into each. It
  does not depend on films and slips: losses are powers by place (`rollslip_studies.motion.losses`), and temperatures
  change the scene by its keys.
- One node *leads*: all balances are found by varying its temperature while the other nodes follow.
- Heat is conserved: the flows into all nodes are the losses minus the heat carried away. The conformance kit checks it.
"""

import abc
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Final, Self, cast

import attrs

from rollslip.bearing.assembly import Assembly
from rollslip.catalogue.kinds import Kind
from rollslip.catalogue.registry import right_model
from rollslip.references import CitedModel
from rollslip.scene.values import Scene
from rollslip.search import Array
from rollslip.structure import Location
from rollslip.units import format_quantity

__all__ = ["PLACES", "ROLES", "THERMAL", "ThermalModel", "from_bearing", "thermal_model"]


#: Places at which losses become heat: contacts, pockets, the lands that guide the cage, and the oil between the rings.
PLACES: Final = ("inner contact", "outer contact", "pocket", "inner land", "outer land", "oil")
#: Keys of a scene that are bulk temperatures -> parts of the bearing that have them.
ROLES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "operation.temperature": "oil",
        "operation.inner_ring_temperature": "inner ring",
        "operation.roller_temperature": "rollers",
        "operation.outer_ring_temperature": "outer ring",
    }
)


class ThermalModel(CitedModel):
    """A model of the heat flow between the parts of a bearing and out of it; its parameters are its attrs fields."""

    @property
    @abc.abstractmethod
    def nodes(self) -> tuple[str, ...]:
        """Names of the n nodes, the leading one first; none if temperatures do not follow from losses."""

    def of(self, assembly: "Assembly") -> Self:
        """Return the model with values from the bearing for all parameters that the scene does not give.

        Raises
        ------
        SceneError
            If heat cannot leave the bearing, or the bearing does not give a value that is needed.
        """
        return self

    @abc.abstractmethod
    def start(self, scene: Scene) -> Array:
        """Return the temperatures of the nodes at which their course and the search for balances start [K], (n,)."""

    @abc.abstractmethod
    def capacities(self) -> Array:
        """Return the heat capacities of the nodes [J/K], (n,), above 0."""

    @abc.abstractmethod
    def inflows(self, temperatures: Array, losses: Mapping[str, float]) -> Array:
        """Return the heat flow into each node [W], (n,).

        Parameters
        ----------
        temperatures : ndarray, shape (n,)
            Temperatures of the nodes [K].
        losses : mapping
            Losses by place, one of `PLACES` [W].
        """

    @abc.abstractmethod
    def carried_away(self, temperatures: Array) -> dict[str, float]:
        """Return the heat that leaves the bearing at temperatures of the nodes [K], (n,), by what carries it [W]."""

    @abc.abstractmethod
    def changes(self, temperatures: Array, scene: Scene) -> dict[str, float]:
        """Return the values of the scene that temperatures change, by key as in `ROLES`, in SI units.

        Parameters
        ----------
        temperatures : ndarray, shape (n,)
            Temperatures of the nodes [K].
        scene : Scene
            The scene as the user wrote it.
        """

    @property
    def inlet(self) -> tuple[float, float] | None:
        """Temperature [K] and heat capacity flow [W/K] of the fluid that enters the leading node; None without one."""
        return None


def thermal_model(scene: Scene) -> ThermalModel | None:
    """Return the model that a scene names under ``models.thermal``; None where the scene gives the temperatures."""
    if (choice := scene.models.thermal) is None:
        return None
    where = Location(scene.origins, ("models", "thermal"))
    model: ThermalModel = right_model("thermal", {"model": choice.name, **choice.parameters}, where)
    return model


def from_bearing(scene: Scene, model: ThermalModel) -> dict[str, str]:
    """Return the parameters that a scene does not give and its model took from the bearing, as text by name.

    Parameters
    ----------
    scene : Scene
        The scene.
    model : ThermalModel
        Its thermal model with the values from the bearing.
    """
    model_class = cast("Any", type(model))
    of_scene = thermal_model(scene) or model_class()
    return {
        field.name: format_quantity(value, field.metadata.get("unit", "1"), 3)
        for field in attrs.fields(model_class)
        if getattr(of_scene, field.name) is None
        and isinstance(value := getattr(model, field.name), float)
        and value != 0.0  # the flow of a bath
    }


THERMAL: Final = Kind(
    name="thermal",
    hook="thermal_models",
    base=ThermalModel,
)
