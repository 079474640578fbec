"""Default scatter of a scene without a table ``[uncertainty]``: that of its oil and its bearing, and that of defaults.

- A named oil, bearing or surface declares the scatter of its data. A field of a model, a drag or a table declares that
  of its default: ``parameter(..., scatter=Scatter(...))``. There is no other list.
- A value that the scene states, or ``--set KEY=VALUE``, is certain and does not scatter, except values for which an oil
  has bounds, such as an Eyring stress that was not measured.
- With a table ``[uncertainty]``, only the values of that table scatter.
"""

import math
from collections.abc import Iterator, Mapping

import attrs

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.catalogue.discovery import load, named_data
from rollslip.errors import SceneError
from rollslip.fields import Scatter
from rollslip.scene.changes import Quantity, stated_values
from rollslip.scene.clearance import clearance_scatter
from rollslip.scene.values import Scene
from rollslip.structure import FrozenTable, Location, resolved
from rollslip.studies.quantities import quantities
from rollslip_studies.variation.distributions import Uncertainty, read_uncertainty

__all__ = ["read_scatter", "scattering", "states", "with_scatter"]

#: Factor on data -> the data, "" for the table of the factor: a scene that states these has no use for the factor.
_MEASURED: Mapping[str, tuple[str, ...]] = {
    "viscosity_factor": ("points", "viscosity"),
    "pressure_viscosity_factor": ("pressure_viscosity",),
    "depth_factor": ("",),
}


def scattering(assembly: Assembly) -> dict[str, tuple[Scatter, Quantity]]:
    """Return the default scatter of a bearing by key, with the value that scatters."""
    scene = assembly.scene
    raw: dict[str, object] = dict(scene.raw or resolved(scene))
    stated = stated_values(scene)
    known = quantities(assembly, {})
    oil = assembly.lubricant
    offered = {
        key: scatter for scatter in oil.scatter for key in _keys_of_oil(scatter.quantity, known)
    }
    if not math.isnan(oil.pressure_viscosity_law.coefficient(oil.minimum_temperature)):
        # the law has constants of its own
        offered.pop("lubricant.pressure_viscosity_factor", None)
        offered.pop("lubricant.pressure_exponent_factor", None)
    for offer in named_data(raw):
        if offer.kind != "lubricant":
            offered |= {
                f"{offer.kind}.{scatter.quantity}": scatter
                for scatter in getattr(load(offer), "scatter", ())
            }
    for scatter in clearance_scatter(scene.bearing):
        offered[f"bearing.{scatter.quantity}"] = scatter
    for key, quantity in known.items():
        if (declared := quantity.attribute.metadata.get("scatter")) is not None:
            offered.setdefault(key, declared)
    has_axial_load = bool(scene.operation.axial_load)  # without it ribs do nothing
    return {
        key: (scatter, known[key])
        for key, scatter in offered.items()
        if key in known
        and (has_axial_load or not key.startswith("bearing.ribs."))
        and not _is_fraction_of_zero(scatter, known[key])
        and not _is_certain(stated, key, scatter)
    }


def _keys_of_oil(quantity: str, known: Mapping[str, Quantity]) -> Iterator[str]:
    """Yield the keys of a datum of an oil: one of its table, or a constant "LAW.PARAMETER" wherever the law is used."""
    law, _, name = quantity.rpartition(".")
    if not law:
        yield f"lubricant.{name}"
        return
    for key, chosen in known.items():
        if key.startswith("models.") and chosen.value == law:
            yield f"{key}.{name}"


def _is_certain(raw: Mapping[str, object], key: str, scatter: Scatter) -> bool:
    """Return whether a scene states a value, or the data of its oil that a factor refers to."""
    table, _, name = key.rpartition(".")
    if table == "lubricant" and {"low", "high"} <= scatter.parameters.keys():
        return False
    return any(
        states(raw, stated)
        for stated in (key, *(f"{table}.{other}".strip(".") for other in _MEASURED.get(name, ())))
    )


def _is_fraction_of_zero(scatter: Scatter, quantity: Quantity) -> bool:
    """Return whether the scatter is relative to a value that is 0 or missing."""
    fractions = {"scatter", "deviation_of_ln"} & scatter.parameters.keys()
    return (
        bool(fractions)
        and scatter.parameters.keys() <= {*fractions, "at_least", "at_most"}
        and not quantity.value
    )


def states(raw: Mapping[str, object], key: str) -> bool:
    """Return whether a raw scene states the value of a key; models in a list are found by their names.

    Parameters
    ----------
    raw : mapping
        The scene as it is written. An empty table states nothing.
    key : str
        Dotted key.
    """
    value: object = raw
    for part in key.split("."):
        if isinstance(value, list | tuple):
            value = next(
                (item for item in value if isinstance(item, Mapping) and item.get("model") == part),
                None,
            )
        elif isinstance(value, Mapping) and part in value:
            value = value[part]
        else:
            return False
    return value is not None and value != {}


def with_scatter(scene: Scene) -> tuple[Scene, tuple[str, ...]]:
    """Return the scene with a table ``[uncertainty]``, by default with the default scatter, and the sources of that."""
    if scene.uncertainty:
        return scene, ()
    assembly = assemble(scene)
    if not (scatters := scattering(assembly)):
        raise SceneError(
            [
                "uncertainty: the scene has no such table, and nothing is known of the scatter of oil "
                f"{assembly.lubricant.name!r}; state what is uncertain, such as [uncertainty.lubricant] "
                "pressure_viscosity_factor = { distribution = 'uniform', scatter = 0.25 }"
            ]
        )
    table = {
        key: {"distribution": scatter.distribution, **scatter.parameters}
        for key, (scatter, _) in scatters.items()
    }
    raw = {**dict(scene.raw or resolved(scene)), "uncertainty": table}
    sources = tuple(
        f"{key} {scatter.grade}: {scatter.source}" for key, (scatter, _) in scatters.items()
    )
    return attrs.evolve(scene, uncertainty=FrozenTable(table), raw=FrozenTable(raw)), sources


def read_scatter(scene: Scene, known: dict[str, Quantity]) -> Uncertainty | None:
    """Return what scatters in a scene, or by default; None where nothing is known of that.

    Parameters
    ----------
    scene : Scene
        The scene.
    known : dict of str to Quantity
        The values of the scene that can be varied, by key.
    """
    problems = list[str]()
    try:
        uncertain, _ = with_scatter(scene)
    except SceneError:
        return None
    table = read_uncertainty(uncertain.uncertainty or {}, Location({}), known, problems)
    return None if problems or not table.distributions else table
