"""The units of the numbers in the JSON of commands, which stand beside their keys."""

from collections.abc import Mapping, MutableMapping
from typing import TYPE_CHECKING, Any, Final

from rollslip.results.accounts import account_of

if TYPE_CHECKING:
    import xarray as xr

#: What records of several commands have: times, and what only counts or compares.
_COMMON: Final[Mapping[str, str]] = {
    **dict.fromkeys(("cost", "left", "planning", "quiet", "seconds", "wall_time"), "s"),
    **dict.fromkeys(
        ("accuracy", "beyond_the_range", "computed", "counts", "degrees_of_freedom", "done", "errors", "evaluations",
         "positions_error", "known", "missing", "number", "points", "resolutions", "samples", "slices_error", "total",
         "reserve to slipping", "slip", "unknown", "values", "severity", "writers"), "1"
    ),
    "friction torque": "N m",
}  # fmt: skip


def with_units(record: dict[str, Any], dataset: "xr.Dataset | None" = None) -> dict[str, Any]:
    """Return a record with the units of its numbers: those of variables of a result, and what its account says.

    A mapping ``units`` stands beside the keys. The unit of a number is the entry of its own key, else of the table that
    it stands in; where there is none, ``unit`` beside it. What stands nearest counts.
    """
    own = dict[str, str]()
    variables = dict[str, str]()
    if dataset is not None:
        account = account_of(dataset)
        variables = {
            str(name): one.attrs["units"]
            for name, one in dataset.variables.items()
            if "units" in one.attrs
        }
        own = {name: unit or "1" for name, (_, unit) in account.numbers.items()} | dict(
            account.units
        )
    units = dict[str, str]()
    for key, value in record.items():
        _collect(value, (key,), {**_COMMON, **own}, {**_COMMON, **variables, **own}, units)
    return {**record, "units": units} if units else record


def _collect(
    value: Any,
    keys: tuple[str, ...],
    own: Mapping[str, str],
    known: Mapping[str, str],
    units: MutableMapping[str, str],
) -> None:
    """Put the units of numbers into `units`; a table with a ``unit`` gets its own for what that is not the unit of."""
    if isinstance(value, dict) and "units" not in value:
        inner = dict[str, str]() if isinstance(value.get("unit"), str) else None
        for key, one in value.items():
            if inner is None:
                _collect(one, (*keys, key), own, known, units)
            else:
                _collect(one, (key,), own, own, inner)
        if inner:
            value["units"] = inner
    elif isinstance(value, list):
        for one in value:
            _collect(one, keys, own, known, units)
    elif value is None or (isinstance(value, int | float) and not isinstance(value, bool)):
        name = next((key for key in reversed(keys) if key in known), None)
        if name is not None and (value is not None or name == keys[-1]):
            units[name] = known[name]
