"""Report the results of a sweep as sentences, tables and plain values, from its dataset alone."""

import json
import shlex
from collections.abc import Collection, Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rollslip.results.account import Account, SpreadsheetRows, Table
from rollslip.results.answer import ACCEPTABLE, MAX_ROWS, Answer, Row, with_verdict
from rollslip.results.dataset import STATUS_VARIABLE, UNITS, xr
from rollslip.results.table import sheet
from rollslip.results.text import (
    Status,
    format_count,
    format_plain,
    in_brackets,
    in_percent,
    short_label,
    two_digits,
    with_unit,
)
from rollslip.results.verdict import Verdict
from rollslip.units import format_quantity

__all__ = [
    "SweepAccount",
    "answer_table",
    "axis_keys",
    "closure_note",
    "main_reason",
    "named_dims",
    "point_table",
    "split_by_name",
]

#: Maximum number of points of a sweep that is printed as a table with a row for each point. Chosen: a table that fits
#: on the screen of a terminal.
_MAX_ROWS: Final = 24
#: Maximum number of columns of such a table. Chosen: columns that fit the width of a terminal.
_MAX_COLUMNS: Final = 10


def axis_keys(dataset: "xr.Dataset") -> dict[str, str]:
    """Return the dimension of each axis -> its key in the scene. In older results the dimension is the key."""
    names_by_key = {
        str(coordinate.attrs.get("key", name)): str(name)
        for name, coordinate in dataset.coords.items()
    }
    return {names_by_key.get(key, key): key for key in json.loads(dataset.attrs["axes"])}


class SweepAccount(Account):
    """Report of a sweep: a table of the points if it is short, and the range of each output."""

    figures_function = ".figures:sweep_figures"

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return the range of the first output with a value, the points at which the cage skids, and some points."""
        summaries = _summaries(dataset)
        outputs = sorted(summaries.items(), key=lambda item: not item[1]["values"])
        name, summary = next(iter(outputs), ("no output", None))
        counts = json.loads(dataset.attrs["counts"])
        number = sum(counts.values())
        parts = [f"{name.replace('_', ' ')} {_format_range(name, summary)} over {number} points"]
        skids, first = _skidding_points(dataset)
        if skids:
            parts.append(f"skids at {skids} of {counts['ok']}, the first at {first}")
        tables = SweepAccount("sweep").tables(dataset)
        rows = [
            Row(
                key=key,
                label=key.replace("_", " "),
                text=_format_range(key, item),
                note=f"none at {item['missing']} points" * bool(item["missing"]),
            )
            for key, item in summaries.items()
        ]
        missing = number - counts["ok"]
        return Answer(
            summary="; ".join(parts),
            rows=() if tables else tuple(rows),
            faults=(f"{missing} of {number} points have no result",) * bool(missing),
            next=_next_steps(dataset, missing - counts["pending"]),
            **answer_table(tables),
        )

    @staticmethod
    def sentences(dataset: "xr.Dataset") -> list[str]:
        """Return a line with the number of points by status, and a line for each output with its range."""
        counts = json.loads(dataset.attrs["counts"])
        lines = [
            ", ".join(f"{count} {name}" for name, count in counts.items() if count) or "no points"
        ]
        for name, row in _summaries(dataset).items():
            extent = "none"
            if row["values"]:
                smallest, largest, median = (
                    _format_value(row[statistic], name, row["unit"])
                    for statistic in ("smallest", "largest", "median")
                )
                extent = f"{smallest} to {largest}, median {median}"
            label = f"{name}{closure_note(dataset, name)}"
            values = format_count(row["values"], "value")
            why = in_brackets(row["why"])
            lines.append(f"{label}: {extent}; {values}, {row['missing']} without one{why}")
        return lines

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Return the sentences by topic: the points, and each output."""
        first, *others = SweepAccount.sentences(dataset)
        return {"points": [first]} | {
            line.partition(":")[0]: [line.partition(": ")[2]] for line in others
        }

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the results as plain values."""
        return {"counts": json.loads(dataset.attrs["counts"]), "outputs": _summaries(dataset)}

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return a table with a row for each point, or none if it would be too long."""
        return point_table(sheet(dataset), set(axis_keys(dataset).values()))


def point_table(spreadsheet: SpreadsheetRows, varied: Collection[str]) -> list[Table]:
    """Return a table for print of a spreadsheet of points, without the columns of statuses; none if it is too large.

    Parameters
    ----------
    spreadsheet : tuple
        Head and rows, with a row for each point.
    varied : collection of str
        Names of columns with varied quantities, whose numbers are printed as they were given.
    """
    head, rows = spreadsheet
    columns = [
        k
        for k, name in enumerate(head)
        # of an output of both rings the name of the ring follows
        if not name.partition(" ")[0].endswith("status")
        and name.partition(" [")[0] not in ("message", "seconds")
    ]
    if len(rows) > _MAX_ROWS or not len(varied) < len(columns) <= _MAX_COLUMNS:
        return []

    def format_cell(value: object, name: str) -> str:
        if not isinstance(value, float):
            return "-" if value is None else str(value)
        return format_plain(value) if name.partition(" [")[0] in varied else two_digits(value)

    return [
        Table(
            "",
            tuple(head[k] for k in columns),
            [[format_cell(row[k], head[k]) for k in columns] for row in rows],
        )
    ]


def answer_table(tables: list[Table], numbers: Sequence[int] | None = None) -> dict[str, Any]:
    """Return the arguments of an answer for the first of some tables: some of its rows, and how many more there are.

    Parameters
    ----------
    tables : list of Table
        Tables of a result; may be empty.
    numbers : sequence of int, optional
        Numbers of the rows to show, in their order; by default rows that are spread evenly.
    """
    if not tables:
        return {}
    rows = tables[0].rows
    if numbers is None:
        numbers = sorted({*np.linspace(0, len(rows) - 1, MAX_ROWS).round().astype(int).tolist()})
    head = tuple(_format_head(name) for name in tables[0].head)
    return {
        "table": (head, *(tuple(rows[k]) for k in numbers)),
        "omitted": len(rows) - len(numbers),
    }


def _format_head(name: str) -> str:
    """Return the head of a column with a short label in place of a key."""
    key, bracket, unit = name.partition(" [")
    return f"{key.replace('_', ' ') if ' ' in key else short_label(key)}{bracket}{unit}"


def _format_range(name: str, summary: Mapping[str, Any] | None) -> str:
    """Return smallest and largest value of an output with its unit; "none" without a value."""
    if not summary or not summary["values"]:
        return "none"
    ends = (summary["smallest"], summary["largest"])
    if in_percent(name, summary["unit"]):
        texts = [two_digits(100.0 * end) for end in ends]
        return f"{' to '.join(dict.fromkeys(texts))} %"
    return " to ".join(dict.fromkeys(with_unit(end, summary["unit"], 2) for end in ends))


def _next_steps(dataset: "xr.Dataset", failed: int) -> tuple[str, ...]:
    """Return the command for points that failed, else the search for the acceptable slip that is passed."""
    if failed:
        return ("rollslip sweep retry FOLDER --failed",)
    keys = axis_keys(dataset)
    if len(keys) != 1 or "steady_slip" not in dataset:
        return ()
    ((dim, key),) = keys.items()
    slips = np.abs(dataset["steady_slip"].to_numpy())
    is_passed = bool((slips <= ACCEPTABLE).any() and not (slips <= ACCEPTABLE).all())
    if not is_passed or dataset[dim].dtype.kind != "f":
        return ()
    low, high = (_format_coordinate(dataset[dim][k]) for k in (0, -1))
    span = shlex.quote(f"{key}={low}:{high}")
    return (
        f"rollslip limit {{scene}} --study {dataset.attrs['swept']} --over {span} "
        f"--keep 'steady_slip<={100 * ACCEPTABLE:g} %'",
    )


def _skidding_points(dataset: "xr.Dataset") -> tuple[int, str]:
    """Return the number of points at which the cage skids by its steady slip, and the first of them in words."""
    if "steady_slip" not in dataset:
        return 0, ""
    slips = dataset["steady_slip"]
    reasons = _status_of(dataset, slips)
    texts = (
        np.full(slips.shape, "") if reasons is None else reasons.broadcast_like(slips).to_numpy()
    )
    skids = [
        at
        for at, slip in np.ndenumerate(slips.to_numpy())
        if _is_skidding(float(slip), str(texts[at]))
    ]
    if not skids:
        return 0, ""
    first = slips.isel(dict(zip(slips.dims, skids[0], strict=True)))
    keys = axis_keys(dataset)
    values = [
        f"{short_label(keys[str(dim)])} {_format_coordinate(first[dim])}"
        for dim in slips.dims
        if str(dim) in keys
    ]
    return len(skids), ", ".join(values) or f"sample {skids[0][0]}"


def _is_skidding(slip: float, status: str) -> bool:
    """Whether the cage skids by the rules of the verdict on its slip, or by the status where it has none."""
    if np.isnan(slip):
        return Status.of(status) in (Status.SKIDS, Status.NO_STEADY_SLIP)
    row = Row(key="cage_slip", label="cage slip", value=slip, text="")
    return with_verdict(Answer(rows=(row,))).verdict == Verdict.SKIDS


def _format_coordinate(coordinate: "xr.DataArray") -> str:
    """Return the value of an axis in the unit in which it was given."""
    value = coordinate.item()
    if not isinstance(value, float):
        return str(value)
    return format_quantity(
        value, coordinate.attrs.get("units", "1"), 4, coordinate.attrs.get("written_in")
    )


def _format_value(value: float, name: str, unit: str) -> str:
    """Text of a value with its unit; slips in percent."""
    return f"{100.0 * value:.4g} %" if in_percent(name, unit) else with_unit(value, unit)


def closure_note(dataset: "xr.Dataset", name: str) -> str:
    """Return the closure of a critical slip, after a space; "" of another output, and where it varies or is unknown.

    Parameters
    ----------
    dataset : xarray.Dataset
        Result of a sweep.
    name : str
        Name of the output.
    """
    if not name.startswith("critical_") or "curves_with" not in dataset.attrs:
        return ""
    return f" {dataset.attrs['curves_with']}"


def named_dims(values: "xr.DataArray", keys: Collection[str]) -> list[str]:
    """Return the dimensions of an output whose coordinates are names, such as rings, measures or parts.

    Parameters
    ----------
    values : xarray.DataArray
        The output.
    keys : collection of str
        Dimensions of the sweep, which are not returned.
    """
    inner = [str(dim) for dim in values.dims if dim not in keys and dim in values.coords]
    return [dim for dim in inner if values[dim].dtype.kind not in "fiub"]


def split_by_name(values: "xr.DataArray", dim: str) -> "list[tuple[str, xr.DataArray]]":
    """Return (label, values) for each name along a dimension, with the unit of each.

    Parameters
    ----------
    values : xarray.DataArray
        The output.
    dim : str
        Dimension whose coordinate is names.
    """
    units = json.loads(values[dim].attrs.get(UNITS, "{}"))
    pieces = []
    for name in map(str, values[dim].to_numpy()):
        piece = values.sel({dim: name})
        label = f"{name} ring" if dim == "ring" else name
        piece.attrs["units"] = units.get(name, piece.attrs["units"])
        piece.attrs["long_name"] = f"{piece.attrs.get('long_name', values.name)}, {label}"
        pieces.append((label, piece))
    return pieces


def _summaries(dataset: "xr.Dataset") -> dict[str, dict[str, Any]]:
    """Range and median of each numeric output, and the number of points without a value, with the main reason."""
    summaries = {}
    sampled = {*axis_keys(dataset), "sample"}
    for name, variable in dataset.data_vars.items():
        if name == "seconds" or variable.dtype.kind != "f":
            continue
        status = _status_of(dataset, variable)
        pieces = {str(name): variable}
        name_dims = named_dims(variable, sampled)
        if {*variable.dims} - sampled == {*name_dims}:
            for dim in name_dims:
                pieces = {
                    f"{prefix}, {part_label}": part
                    for prefix, piece in pieces.items()
                    for part_label, part in split_by_name(piece, dim)
                }
        for label, piece in pieces.items():
            values = piece.to_numpy()
            finite = values[np.isfinite(values)]
            why = None
            if status is not None:
                split_dims = {*name_dims} & {*status.dims} - {*piece.dims}
                reasons = status.sel({dim: piece[dim] for dim in split_dims}).broadcast_like(piece)
                why = main_reason(reasons.transpose(*piece.dims).to_numpy()[~np.isfinite(values)])
            summaries[label] = {
                "unit": piece.attrs["units"],
                "values": int(finite.size),
                "missing": int(values.size - finite.size),
                "why": why,
                **dict.fromkeys(("smallest", "median", "largest")),
            }
            if finite.size:
                summaries[label] |= {
                    "smallest": float(finite.min()),
                    "median": float(np.median(finite)),
                    "largest": float(finite.max()),
                }
    return summaries


def _status_of(dataset: "xr.Dataset", variable: "xr.DataArray") -> "xr.DataArray | None":
    """The status variable of a variable: the one that its attribute names, else the only one of the same dimensions."""
    if (status_name := variable.attrs.get(STATUS_VARIABLE)) in dataset:
        return dataset[status_name]
    names = [
        name
        for name, other in dataset.data_vars.items()
        if str(name).endswith("_status")
        and other.dims == variable.dims
        and other.dtype.kind not in "fiub"
    ]
    return dataset[names[0]] if len(names) == 1 else None


def main_reason(statuses: NDArray[Any]) -> str | None:
    """Return the most frequent status, with "mostly" if there are others; failed points have none."""
    reasons, counts = np.unique(
        statuses[statuses.astype(str) != ""].astype(str), return_counts=True
    )
    if not reasons.size:
        return None
    reason = str(reasons[np.argmax(counts)])
    return reason if reasons.size == 1 else f"mostly {reason}"


ACCOUNT: Final = SweepAccount("sweep")
