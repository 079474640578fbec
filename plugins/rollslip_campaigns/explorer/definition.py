"""Plan an explorer: the quantities with sliders, the models to choose from, and the number of points."""

from collections.abc import Mapping
from typing import Final

import attrs
import numpy as np

from rollslip.bearing.assembly import assemble
from rollslip.catalogue.registry import get_class
from rollslip.errors import RollslipError
from rollslip.results.text import short_label
from rollslip.scene.changes import Quantity, describe_unknown_key
from rollslip.scene.values import Scene
from rollslip.structure import raise_problems
from rollslip.studies.quantities import quantities
from rollslip.studies.study import settings
from rollslip.toml import as_list
from rollslip.units import UnitError, evenly, shown_unit
from rollslip_campaigns.explorer import ExplorerSettings
from rollslip_campaigns.explorer.grid import Dial, Explorer
from rollslip_campaigns.sweep.sampling import read_overs, read_span
from rollslip_studies.steady_slip.minimum_load import minimum_loads_of_makers
from rollslip_studies.steady_slip.study import SteadySlip

__all__ = ["plan_explorer"]

#: Quantities that have sliders by default: key -> half of the range, and number of nodes, of which the value of the
#: scene is one. Half ranges of loads and speeds are fractions of the value, of temperatures kelvin, of clearances
#: fractions of the diameter of the inner raceway. Chosen: 5 x 3 x 3 x 3 nodes are 135 points for each combination of
#: models.
_DEFAULT_RANGES: Final[Mapping[str, tuple[float, int]]] = {
    "operation.radial_load": (0.5, 5),
    "operation.inner_speed": (0.3, 3),
    "operation.temperature": (15.0, 3),
    "bearing.radial_clearance": (2e-4, 3),
}
#: Factor on the largest minimum load of a maker up to which loads go, so that its mark is seen. Chosen.
_BEYOND_MAKERS: Final = 1.05
#: Default number of nodes of a range. Twice as many make the error of interpolation far smaller, and the number of
#: points twice as large for each quantity. Chosen: a cubic polynomial.
_DEFAULT_NODES: Final = 4
#: Maximum number of points of an explorer. More make a page that browsers load slowly. Chosen.
_MAX_POINTS: Final = 20_000


def plan_explorer(requested: "ExplorerSettings") -> Explorer:
    """Check the settings of an explorer and return its plan; wrong settings raise SceneError with all faults."""
    over = read_overs(requested.over)
    base = attrs.evolve(requested.base_scene, sweep=None, uncertainty=None)
    known = quantities(assemble(base), settings(base, SteadySlip.name))
    dials = list[Dial]()
    choices = dict[str, tuple[str, ...]]()
    problems = list[str]()
    for key, value in (over or _defaults(known, base)).items():
        if key not in known:
            problems.append(f"{key}: {describe_unknown_key(key, known)}")
        elif known[key].unit is None:
            choices[key] = tuple(map(str, as_list(value)))
        else:
            try:
                dials.append(
                    _read_dial(known[key], value if isinstance(value, str) else str(value))
                )
            except (RollslipError, UnitError, ValueError) as error:
                problems.append(f"{key}: {getattr(error, 'reason', error)}")
    if not dials and not problems:
        problems.append(
            "nothing to move by a slider; name a quantity, such as operation.radial_load='1 kN:5 kN'"
        )
    planned = Explorer(base, tuple(dials), choices, requested.checks)
    if not problems and planned.size > _MAX_POINTS:
        problems.append(
            f"{planned.size} points are more than {_MAX_POINTS}; take fewer quantities, nodes or models"
        )
    raise_problems(problems)
    return planned


def _defaults(known: Mapping[str, Quantity], scene: Scene) -> dict[str, object]:
    """Default ranges of quantities, and the model of traction with the one that solves it, if there is one.

    Loads go up to the largest minimum load of a maker.
    """
    makers_load = float(np.nanmax(minimum_loads_of_makers(scene)[0], initial=0.0))
    defaults: dict[str, object] = {}
    diameter = known["bearing.inner_raceway_diameter"].value
    for key, (half_width, count) in _DEFAULT_RANGES.items():
        scene_value = known[key].value if key in known else None
        if not isinstance(scene_value, float):
            continue
        unit = {"K": 1.0, "m": diameter}.get(str(known[key].unit), abs(scene_value))
        if isinstance(unit, float) and unit > 0.0:
            low = scene_value - half_width * unit
            # a clearance keeps its sign
            if low <= 0.0 <= scene_value:
                low = 0.0
            high = scene_value + half_width * unit
            if key == "operation.radial_load":
                high = max(high, _BEYOND_MAKERS * makers_load)
            defaults[key] = f"{low!r}:{high!r}:{count}"
    for key, quantity in known.items():
        if quantity.model == "traction" and (
            solves := get_class("traction", str(quantity.value)).solved_by
        ):
            defaults[key] = [str(quantity.value), solves]
    return defaults


def _read_dial(quantity: Quantity, text: str) -> Dial:
    """The dial of a quantity and a range, LOW:HIGH or LOW:HIGH:NODES; an error if it is wrong."""
    ends, count, logarithmic = read_span(quantity, text, _DEFAULT_NODES, range(2, 34))
    unit = str(quantity.unit)
    low, high = evenly(*ends, 2, unit)
    if not low < high:
        raise ValueError(f"{text!r}: the first end must be below the second")
    for bound in (low, high):
        quantity.read(bound)
    scene_value = quantity.value if isinstance(quantity.value, float) else 0.5 * (low + high)
    return Dial(
        key=quantity.key,
        name=short_label(quantity.key),
        unit=unit,
        shown=shown_unit(max(abs(low), abs(high)), unit),
        low=low,
        high=high,
        start=min(max(scene_value, low), high),
        count=count,
        logarithmic=logarithmic,
    )
