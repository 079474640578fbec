"""What an explorer is made of: what sliders move, which models can be chosen, and at how many points it is computed."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

import attrs

from rollslip.bearing.assembly import assemble
from rollslip.catalogue.registry import get_class
from rollslip.errors import SceneError
from rollslip.results.words import short_label
from rollslip.scene.changes import Quantity, unknown
from rollslip.studies.study import settings
from rollslip.units import UnitError, check_typed, evenly, shown_unit
from rollslip_campaigns.explorer.grid import Dial, Explorer
from rollslip_campaigns.sweep.sampling import read_overs
from rollslip_studies.effective_friction.study import EffectiveFriction
from rollslip_studies.variation.quantities import quantities

if TYPE_CHECKING:
    from rollslip_campaigns.explorer import ExplorerSettings

__all__ = ["plan_explorer"]

#: What moves if nobody says what: key -> how far to both sides of the scene's value, and nodes, of which that value is
#: one. Loads and speeds in shares of the value, temperatures in degrees, clearances in diameters of the inner raceway.
_DIALS: Final[Mapping[str, tuple[float, int]]] = {
    "operation.radial_load": (0.5, 5),
    "operation.inner_speed": (0.3, 3),
    "operation.temperature": (15.0, 3),
    "bearing.radial_clearance": (2e-4, 5),
}
#: Ratio of the ends beyond which a quantity is taken by its logarithm.
_FACTOR: Final = 3.0
_NODES: Final = 4
_MOST: Final = 20_000


def plan_explorer(requested: "ExplorerSettings") -> Explorer:
    """Return what an explorer computes."""
    given = requested.given
    over = read_overs(requested.over)
    base = attrs.evolve(given, sweep=None, uncertainty=None)
    known = quantities(assemble(base), settings(base, EffectiveFriction.name))
    wanted: dict[str, object] = over or _defaults(known)
    dials = list[Dial]()
    choices = dict[str, tuple[str, ...]]()
    problems = list[str]()
    for key, value in wanted.items():
        if key not in known:
            problems.append(f"{key}: {unknown(key, known)}")
        elif known[key].unit is None:
            names = tuple(map(str, value)) if isinstance(value, list | tuple) else (str(value),)
            choices[key] = names
        else:
            try:
                dials.append(_dial(known[key], value if isinstance(value, str) else str(value)))
            except (UnitError, ValueError) as error:
                problems.append(f"{key}: {error}")
    if not dials and not problems:
        problems.append(
            "nothing to move by a slider; name a quantity, such as operation.radial_load='1 kN:5 kN'"
        )
    planned = Explorer(base, tuple(dials), choices, requested.checks)
    if not problems and planned.size > _MOST:
        problems.append(
            f"{planned.size} points are more than {_MOST}; take fewer quantities, nodes or models"
        )
    if problems:
        raise SceneError(problems)
    return planned


def _defaults(known: Mapping[str, Quantity]) -> dict[str, object]:
    found: dict[str, object] = {}
    diameter = known["bearing.inner_raceway_diameter"].value
    for key, (far, count) in _DIALS.items():
        now = known[key].value if key in known else None
        if not isinstance(now, float):
            continue
        unit = {"K": 1.0, "m": diameter}.get(str(known[key].unit), abs(now))
        if isinstance(unit, float) and unit > 0.0:
            low = now - far * unit
            low = low if now < 0.0 or low > 0.0 else min(now, 0.0)  # no clearance of another sign
            found[key] = f"{low!r}:{now + far * unit!r}:{count}"
    for key, one in known.items():
        if one.model == "traction" and (solves := get_class("traction", str(one.value)).solved_by):
            found[key] = [str(one.value), solves]
    return found


def _dial(quantity: Quantity, text: str) -> Dial:
    parts = [part.strip() for part in text.split(":")]
    if len(parts) not in (2, 3) or not all(parts):
        raise ValueError(f"{text!r} is no range; write LOW:HIGH or LOW:HIGH:NODES, with units")
    count = (
        int(parts[2])
        if len(parts) == 3 and parts[2].isdecimal()
        else _NODES
        if len(parts) == 2
        else 0
    )
    if not 2 <= count <= 33:
        raise ValueError(f"{text!r}: {parts[-1]!r} is no number of nodes from 2 to 33")
    unit = str(quantity.unit)
    check_typed(text, parts[:2], unit)
    low, high = evenly(parts[0], parts[1], 2, unit)
    if not low < high:
        raise ValueError(f"{text!r}: the first end must be below the second")
    for end in (low, high):
        quantity.read(end)
    now = quantity.value if isinstance(quantity.value, float) else 0.5 * (low + high)
    return Dial(
        key=quantity.key,
        name=short_label(quantity.key),
        unit=unit,
        shown=shown_unit(max(abs(low), abs(high)), unit),
        low=low,
        high=high,
        start=min(max(now, low), high),
        count=count,
        logarithmic=low > 0.0 and high > _FACTOR * low and unit != "K",
    )
