"""What scatters of a scene that says nothing of it: what its oil and its bearing come with, and what fields declare.

- A named oil, bearing or surface says how its data scatter. A field of a model, of a drag or of a table says so of the
  value that it has by default: ``parameter(..., scatter=Scatter(...))``. No list of them is kept anywhere.
- A value that the scene states is taken for known: it does not scatter. ``--set KEY=VALUE`` fixes it likewise. Only
  what an oil has between ends of its own, as an Eyring stress that nobody measures, scatters all the same.
- A table ``[uncertainty]`` says all: with one nothing else scatters.
"""

import math
from collections.abc import Mapping

import attrs

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.catalogue.discovery import load, named_data
from rollslip.datasets import Scatter
from rollslip.errors import SceneError
from rollslip.scene.changes import Quantity
from rollslip.scene.clearance import clearance_scatter
from rollslip.scene.values import Scene
from rollslip.structure import FrozenTable, resolved
from rollslip_studies.variation.quantities import quantities

__all__ = ["scattering", "with_scatter"]

#: Data of an oil in place of which its factors stand.
_MEASURED: Mapping[str, tuple[str, ...]] = {
    "viscosity_factor": ("points", "viscosity"),
    "pressure_viscosity_factor": ("pressure_viscosity",),
}


def scattering(assembly: Assembly) -> dict[str, tuple[Scatter, Quantity]]:
    """Return what scatters of a bearing by default, by key, with the value that it has."""
    scene = assembly.scene
    raw: dict[str, object] = dict(scene.raw or resolved(scene))
    known = quantities(assembly, {})
    oil = assembly.lubricant
    offered = {f"lubricant.{one.quantity}": one for one in oil.scatter}
    if not math.isnan(oil.pressure_viscosity_law.coefficient(oil.minimum_temperature)):
        for name in (
            "pressure_viscosity_factor",
            "pressure_exponent_factor",
        ):  # the law has constants of its own
            offered.pop(f"lubricant.{name}", None)
    for offer in named_data(raw):
        if offer.kind != "lubricant":
            offered |= {
                f"{offer.kind}.{one.quantity}": one for one in getattr(load(offer), "scatter", ())
            }
    offered |= {f"bearing.{one.quantity}": one for one in clearance_scatter(scene.bearing)}
    for key, quantity in known.items():
        if (declared := quantity.attribute.metadata.get("scatter")) is not None:
            offered.setdefault(key, declared)
    return {
        key: (one, known[key])
        for key, one in offered.items()
        if key in known and not _of_nothing(one, known[key]) and not _is_known(raw, key, one)
    }


def _is_known(raw: Mapping[str, object], key: str, scatter: Scatter) -> bool:
    """Whether a scene states a value, or data of its oil in place of a factor on them."""
    table, _, name = key.rpartition(".")
    if table == "lubricant" and {"low", "high"} <= scatter.parameters.keys():
        return False
    return any(
        _states(raw, stated)
        for stated in (key, *(f"{table}.{other}" for other in _MEASURED.get(name, ())))
    )


def _of_nothing(scatter: Scatter, quantity: Quantity) -> bool:
    """Whether a value is zero, or is not there, of which a share scatters."""
    fractions = {"scatter", "deviation_of_ln"} & scatter.parameters.keys()
    return (
        bool(fractions)
        and scatter.parameters.keys() <= {*fractions, "at_least", "at_most"}
        and not quantity.value
    )


def _states(raw: Mapping[str, object], key: str) -> bool:
    """Whether a raw scene states the value of a key; of models in a list it is found by their name."""
    at: object = raw
    for part in key.split("."):
        if isinstance(at, list | tuple):
            at = next(
                (one for one in at if isinstance(one, Mapping) and one.get("model") == part), None
            )
        elif isinstance(at, Mapping) and part in at:
            at = at[part]
        else:
            return False
    return at is not None


def with_scatter(scene: Scene) -> tuple[Scene, tuple[str, ...]]:
    """Return the scene with a table ``[uncertainty]``, what scatters by default where it has none, and who says so."""
    if scene.uncertainty:
        return scene, ()
    assembly = assemble(scene)
    used = scattering(assembly)
    if not used:
        raise SceneError(
            [
                "uncertainty: the scene has no such table, and nothing is known of the scatter of oil "
                f"{assembly.lubricant.name!r}; state what is uncertain, such as [uncertainty.lubricant] "
                "pressure_viscosity_factor = { distribution = 'uniform', scatter = 0.25 }"
            ]
        )
    table = {
        key: {"distribution": one.distribution, **one.parameters} for key, (one, _) in used.items()
    }
    raw = {**dict(scene.raw or resolved(scene)), "uncertainty": table}
    said = tuple(f"{key} {one.grade}: {one.source}" for key, (one, _) in used.items())
    return attrs.evolve(scene, uncertainty=FrozenTable(table), raw=FrozenTable(raw)), said
