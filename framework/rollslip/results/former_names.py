"""Names of variables, attributes and keys in results that were stored before these were renamed.

Stored results stay readable: `rollslip.results.dataset.open_result` replaces these names. A name is added here when a
variable is renamed, and never removed while results with it may exist.
"""

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["FORMER_NAMES", "with_present_names"]

#: Former name -> present name.
FORMER_NAMES: Final[Mapping[str, str]] = {
    "bin_share": "bin_fraction",
    "contact_share": "contact_fraction",
    "error_asked": "error_requested",
    "indexed_asked": "indexed_requested",
    "instants": "n_positions",
    "instants_error": "positions_error",
    "largest_drag": "limit_drag",
    "largest_drag_error": "limit_drag_error",
    "largest_drag_high": "limit_drag_high",
    "largest_drag_low": "limit_drag_low",
    "largest_drag_slip": "skidding_slip",
    "largest_drag_status": "skidding_status",
    "least_cage_slip": "smallest_cage_slip",
    "least_cage_slip_time": "smallest_cage_slip_time",
    "least_load": "minimum_load",
    "least_load_status": "minimum_load_status",
    "least_margin_time": "smallest_margin_time",
    "least_margin_to_runaway": "smallest_margin_to_skidding",
    "least_ratio": "smallest_ratio",
    "light_share": "light_fraction",
    "makers_least_load": "makers_minimum_load",
    "most_ratio": "largest_ratio",
    "most_torque": "largest_torque",
    "most_torque_error": "largest_torque_error",
    "most_torque_slip": "largest_torque_slip",
    "regime_share": "regime_fraction",
    "runaway_drag": "limit_drag",
    "runaway_drag_along": "limit_drag_along",
    "runaway_range": "skidding_range",
    "runaway_slip": "skidding_slip",
    "runaway_slip_along": "skidding_slip_along",
    "runaway_status": "skidding_status",
    "settled_slip": "stationary_slip",
    "settled_status": "stationary_status",
    "settled_temperature": "stationary_temperature",
    "share_outside": "fraction_outside",
    "statement_says": "statement_text",
    "taken_back": "reinstated",
    "time_beyond_runaway": "time_beyond_skidding",
}
#: A former name in the JSON text of an attribute.
_QUOTED: Final = re.compile(f'"({"|".join(FORMER_NAMES)})"')
#: A scene has one key that was called so: the number of points of the course of temperatures over time.
_KEYS_OF_SCENES: Final = {"instants": "course_points"}


def _with_present_keys(value: Any, names: Mapping[str, str]) -> Any:
    """Return a text with the present names of its keys, and any other value as it is."""
    if not isinstance(value, str):
        return value
    return _QUOTED.sub(lambda key: f'"{names[key[1]]}"', value)


def with_present_names(dataset: "xr.Dataset") -> "xr.Dataset":
    """Return a result with the present names of its variables, its attributes, and the keys in its JSON texts."""
    attributes: dict[str, Any] = {}
    for name, value in dataset.attrs.items():
        names = {**FORMER_NAMES, **_KEYS_OF_SCENES} if name == "scene_resolved" else FORMER_NAMES
        attributes[FORMER_NAMES.get(str(name), str(name))] = _with_present_keys(value, names)
    renamed = dataset.rename(
        {name: FORMER_NAMES[str(name)] for name in dataset.variables if name in FORMER_NAMES}
    )
    renamed.attrs = attributes
    return renamed
