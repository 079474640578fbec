"""What a sweep has found, in sentences and plain values, from the dataset alone."""

import json
from collections.abc import Collection
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from rollslip.results.account import Account, Sheet, Table
from rollslip.results.dataset import STATUS_VARIABLE, UNITS
from rollslip.results.table import sheet
from rollslip.results.words import format_plain, in_percent, two_digits, with_unit

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["SweepAccount", "axes", "by_name", "named_dims", "point_table", "resting"]

#: Sweeps of at most this many points are shown as a table with a row for each point.
_POINTS: Final = 24
#: Such a table has at most this many columns, which fit the width of a terminal.
_COLUMNS: Final = 10


def axes(dataset: "xr.Dataset") -> dict[str, str]:
    """Return the dimension of each axis -> its key, as the scene has it.

    Older results have keys as names of dimensions.
    """
    known = {
        str(coordinate.attrs.get("key", name)): str(name)
        for name, coordinate in dataset.coords.items()
    }
    return {known.get(key, key): key for key in json.loads(dataset.attrs["axes"])}


class SweepAccount(Account):
    """How a sweep is told: point by point where these are few, and by the range of every output."""

    drawn = ".figures:sweep_figures"

    @staticmethod
    def sentences(dataset: "xr.Dataset") -> list[str]:
        """Return what a sweep found, line by line: every output with the range of its values."""
        counts = json.loads(dataset.attrs["counts"])
        lines = [
            ", ".join(f"{count} {name}" for name, count in counts.items() if count) or "no points"
        ]
        for name, row in _ranges(dataset).items():
            where = "none"
            if row["values"]:
                told = {
                    which: _shown(row[which], name, row["unit"])
                    for which in ("least", "largest", "median")
                }
                where = f"{told['least']} to {told['largest']}, median {told['median']}"
            why = f" ({row['why']})" if row["why"] else ""
            called = f"{name}{resting(dataset)}" if name.startswith("critical_") else name
            values = f"{row['values']} value{'s' * (row['values'] != 1)}"
            lines.append(f"{called}: {where}; {values}, {row['missing']} without one{why}")
        return lines

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Return what a sweep found, by what it is about."""
        first, *others = SweepAccount.sentences(dataset)
        return {"points": [first]} | {
            line.partition(":")[0]: [line.partition(": ")[2]] for line in others
        }

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return what a sweep found, as plain values."""
        return {"counts": json.loads(dataset.attrs["counts"]), "outputs": _ranges(dataset)}

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return a row for each point, if there are not too many to read."""
        return point_table(sheet(dataset), set(axes(dataset).values()))


def point_table(of: Sheet, varied: Collection[str]) -> list[Table]:
    """Return the rows of a spreadsheet as people read them, without how points ended, if there are not too many."""
    head, rows = of
    words = {"status", "message", "seconds"}
    kept = [
        k
        for k, name in enumerate(head)
        if not name.endswith("status") and name.partition(" [")[0] not in words
    ]
    if len(rows) > _POINTS or not len(varied) < len(kept) <= _COLUMNS:
        return []

    def told(value: object, name: str) -> str:
        if not isinstance(value, float):
            return "-" if value is None else str(value)
        return format_plain(value) if name.partition(" [")[0] in varied else two_digits(value)

    return [
        Table(
            "",
            tuple(head[k] for k in kept),
            [[told(row[k], head[k]) for k in kept] for row in rows],
        )
    ]


def _shown(value: float, name: str, unit: str) -> str:
    return f"{100.0 * value:.4g} %" if in_percent(name, unit) else with_unit(value, unit)


def resting(dataset: "xr.Dataset") -> str:
    """Return what critical slips rest on, after a space; nothing where it varies or is not known."""
    return f" {dataset.attrs['curves_with']}" if "curves_with" in dataset.attrs else ""


def named_dims(values: "xr.DataArray", keys: Collection[str]) -> list[str]:
    """Return the dimensions of an output along which it has names, such as rings, measures or parts."""
    inner = [str(dim) for dim in values.dims if dim not in keys and dim in values.coords]
    return [dim for dim in inner if values[dim].dtype.kind not in "fiub"]


def by_name(values: "xr.DataArray", dim: str) -> "list[tuple[str, xr.DataArray]]":
    """Return an output name by name, each piece with its own unit."""
    units = json.loads(values[dim].attrs.get(UNITS, "{}"))
    found = []
    for name in map(str, values[dim].to_numpy()):
        piece = values.sel({dim: name})
        called = f"{name} ring" if dim == "ring" else name
        piece.attrs["units"] = units.get(name, piece.attrs["units"])
        piece.attrs["long_name"] = f"{piece.attrs.get('long_name', values.name)}, {called}"
        found.append((called, piece))
    return found


def _ranges(dataset: "xr.Dataset") -> dict[str, dict[str, Any]]:
    """Range of every output that is a number; what has no value is counted."""
    ranges = {}
    sampled = {*axes(dataset), "sample"}
    for name, variable in dataset.data_vars.items():
        if name == "seconds" or variable.dtype.kind != "f":
            continue
        status = _status_of(dataset, variable)
        pieces = {str(name): variable}
        named = named_dims(variable, sampled)
        if {*variable.dims} - sampled == {*named}:
            for dim in named:
                pieces = {
                    f"{k}, {one}": of
                    for k, piece in pieces.items()
                    for one, of in by_name(piece, dim)
                }
        for called, piece in pieces.items():
            values = piece.to_numpy()
            known = values[np.isfinite(values)]
            at = {dim: piece[dim] for dim in named if dim not in piece.dims}
            why = None
            if status is not None:
                words = status.sel(
                    {dim: one for dim, one in at.items() if dim in status.dims}
                ).broadcast_like(piece)
                why = _most_frequent(words.transpose(*piece.dims).to_numpy()[~np.isfinite(values)])
            ranges[called] = {
                "unit": piece.attrs["units"],
                "values": int(known.size),
                "missing": int(values.size - known.size),
                "why": why,
                **dict.fromkeys(("least", "median", "largest")),
            }
            if known.size:
                ends = {"least": float(known.min()), "largest": float(known.max())}
                ranges[called] |= {"median": float(np.median(known)), **ends}
    return ranges


def _status_of(dataset: "xr.Dataset", variable: "xr.DataArray") -> "xr.DataArray | None":
    """The words beside a variable that say why it has no value, if there is one such variable."""
    if (told := variable.attrs.get(STATUS_VARIABLE)) in dataset:
        return dataset[told]
    names = [
        name
        for name, other in dataset.data_vars.items()
        if str(name).endswith("_status")
        and other.dims == variable.dims
        and other.dtype.kind not in "fiub"
    ]
    return dataset[names[0]] if len(names) == 1 else None


def _most_frequent(words: NDArray[Any]) -> str | None:
    """The reason that is given most often, and whether there are others; points that failed give none."""
    reasons, counts = np.unique(words[words.astype(str) != ""].astype(str), return_counts=True)
    if not reasons.size:
        return None
    most = str(reasons[np.argmax(counts)])
    return most if reasons.size == 1 else f"mostly {most}"


ACCOUNT: Final = SweepAccount("sweep")
