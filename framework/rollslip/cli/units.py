"""Add the units of numbers to the JSON output of commands."""

from collections.abc import Mapping, MutableMapping
from typing import Any, Final

from rollslip.results.accounts import account_of
from rollslip.results.dataset import xr

#: Units of keys in records of several commands: times, and plain numbers.
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
    """Return a record with the units of its numbers: those of variables of a result and of its account.

    They are added as a mapping ``units``. The unit of a number is the entry of its own key, or of the table that
    contains it; without an entry it is the value of the key ``unit`` in the same table. The innermost one counts.
    """
    own = dict[str, str]()
    variables = dict[str, str]()
    if dataset is not None:
        account = account_of(dataset)
        variables = {
            str(name): variable.attrs["units"]
            for name, variable in dataset.variables.items()
            if "units" in variable.attrs
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
    """Add the units of numbers to `units`; a table with a ``unit`` has its own mapping for numbers of other units."""
    if isinstance(value, dict) and isinstance(value.get("unit"), str) and "units" not in value:
        inner = dict[str, str]()
        for key, entry in value.items():
            _collect(entry, (key,), own, own, inner)
        if inner:
            value["units"] = inner
    elif isinstance(value, dict) and "units" not in value:
        for key, entry in value.items():
            _collect(entry, (*keys, key), own, known, units)
    elif isinstance(value, list):
        for entry in value:
            _collect(entry, keys, own, known, units)
    elif value is None or (isinstance(value, int | float) and not isinstance(value, bool)):
        _add_unit(value, keys, known, units)


def _add_unit(
    value: float | None,
    keys: tuple[str, ...],
    known: Mapping[str, str],
    units: MutableMapping[str, str],
) -> None:
    """Add the unit of a number by its innermost known key; of a missing number only by its own key."""
    name = next((key for key in reversed(keys) if key in known), None)
    if name is not None and (value is not None or name == keys[-1]):
        units[name] = known[name]
