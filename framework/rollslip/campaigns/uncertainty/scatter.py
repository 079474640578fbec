"""What scatters of a scene that says nothing of it: what its oil and its bearing come with."""

import math
from collections.abc import Mapping

import attrs

from rollslip.bearing.assembly import assemble
from rollslip.catalogue.discovery import load, named_data
from rollslip.datasets import Scatter
from rollslip.errors import SceneError
from rollslip.scene.clearance import clearance_scatter
from rollslip.scene.values import Scene, resolved
from rollslip.structure import FrozenTable

__all__ = ["with_scatter"]


def with_scatter(scene: Scene) -> tuple[Scene, tuple[str, ...]]:
    """Return the scene with a table ``[uncertainty]``, that of its data where it has none, and what these say of it.

    Values that the scene gives in place of the data's do not scatter like those.

    Raises
    ------
    SceneError
        If nothing is known of any scatter.
    """
    if scene.uncertainty:
        return scene, ()
    assembly, data = assemble(scene), dict(scene.lubricant.data)
    oil = assembly.lubricant
    fixed = not math.isnan(oil.pressure_viscosity_law.coefficient(oil.minimum_temperature))
    own = {
        "viscosity_factor": "points" in data or "viscosity" in data,
        "pressure_viscosity_factor": fixed or "pressure_viscosity" in data,
        "pressure_exponent_factor": fixed or "pressure_exponent_factor" in data,
    }
    used: dict[str, list[Scatter]] = {"lubricant": [one for one in oil.scatter if not own.get(one.quantity, False)]}
    raw = dict(scene.raw or resolved(scene))
    for offer in named_data(raw):
        written = raw[offer.kind]
        if offer.kind != "lubricant" and isinstance(written, Mapping):
            scatter = getattr(load(offer), "scatter", ())
            used[offer.kind] = [one for one in scatter if one.quantity not in written]
    used["bearing"] = [*used.get("bearing", ()), *clearance_scatter(scene.bearing)]
    used = {table: scatters for table, scatters in used.items() if scatters}
    if not used:
        raise SceneError(
            [
                f"uncertainty: the scene has no such table, and nothing is known of the scatter of oil {oil.name!r}; "
                "state what is uncertain, such as [uncertainty.lubricant] "
                "pressure_viscosity_factor = { distribution = 'uniform', scatter = 0.25 }"
            ]
        )
    table = {
        name: {one.quantity: {"distribution": one.distribution, **one.parameters} for one in scatters}
        for name, scatters in used.items()
    }
    said = tuple(f"{name}.{one.quantity} {one.grade}: {one.source}" for name, of in used.items() for one in of)
    return attrs.evolve(scene, uncertainty=FrozenTable(table), raw=FrozenTable({**raw, "uncertainty": table})), said
