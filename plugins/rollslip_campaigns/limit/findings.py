"""Report the results of a search for a limit as sentences, tables and plain values, from its dataset alone."""

import json
import math
import shlex
from typing import Any, Final

import numpy as np

from rollslip.results.account import Account, SpreadsheetRows, Table
from rollslip.results.answer import Answer, Row
from rollslip.results.curves import or_none
from rollslip.results.dataset import rows_along, xr
from rollslip.results.table import point_rows
from rollslip.results.text import (
    Status,
    format_count,
    format_force,
    in_brackets,
    in_percent,
    short_label,
)
from rollslip.units import format_quantity
from rollslip_campaigns.sweep.findings import answer_table, main_reason, point_table

__all__ = ["LimitAccount", "describe_limit", "satisfied_spans"]

#: A result jumps between two neighbours at the limit if their difference is at least this fraction of the range of all
#: results. A larger value reports fewer jumps, a smaller one reports steep curves as jumps. Chosen.
_JUMP_FRACTION = 0.1
#: The second condition of a jump: the mean slope between the neighbours is at least this multiple of that over the
#: whole range. It matters where neighbours are far apart. Chosen.
_JUMP_STEEPNESS = 10.0
#: Number of points in an answer, those nearest to the limit. Chosen: with notes and next step they fill 15 lines.
_NEAREST: Final = 6
#: Differences of neighbouring results below this fraction of their range do not count as a change of direction, because
#: they may be errors of the results. Twice the value ignores larger ripples. Chosen: well below all tolerances.
_FLAT_FRACTION: Final = 1e-6


class LimitAccount(Account):
    """Report of the campaign ``limit``."""

    figures_function = ".figures:limit_figures"

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return the limit, the points nearest to it, and a run at the limit as the next step."""
        edges = dataset["edge_kept"].to_numpy()
        points = np.arange(dataset.sizes["point"])
        nearest = points
        if edges.size:
            indices = np.searchsorted(dataset["searched"].to_numpy(), edges)
            distances = np.abs(points[:, np.newaxis] - indices).min(axis=1)
            nearest = np.argsort(distances, kind="stable")
        topics = LimitAccount.topics(dataset)
        return Answer(
            summary=summarise_limit(dataset),
            rows=tuple(
                Row(key=name, label=name, text="", note=text)
                for name in ("width", "jump", "points failed")
                for text in topics.get(name, ())
            ),
            faults=tuple(_turns(dataset)),
            next=tuple(_next_steps(dataset)),
            **answer_table(
                LimitAccount("limit").tables(dataset), sorted(nearest[:_NEAREST].tolist())
            ),
        )

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Return sentences by topic."""
        topics = {
            "limit": [describe_limit(dataset)],
            "width": [
                f"between {_format_searched(dataset, edge['edge_kept'])} and "
                f"{_format_searched(dataset, edge['edge_passed'])} the limit could not be "
                "narrowed down, as points there failed"
                for edge in rows_along(dataset, "edge")
                if edge["edge_unknown"]
            ],
            "jump": _describe_jumps(dataset),
            "course": _describe_monotonicity(dataset),
            "values missing": _describe_missing(dataset),
            "points failed": _describe_failures(dataset),
        }
        return {name: lines for name, lines in topics.items() if lines}

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the results as plain values, in SI units; None (null in JSON) where there is no value."""
        a = dataset.attrs
        return {
            "requirement": a["requirement"],
            "key": a["searched_key"],
            "unit": dataset["searched"].attrs["units"],
            "output": {
                "name": a["output"],
                "unit": dataset["result"].attrs["units"],
                "limit": float(a["limit"]),
            },
            "found": describe_limit(dataset),
            "kept": [{"from": low, "to": high} for low, high, *_ in satisfied_spans(dataset)],
            "edges": [
                {
                    "kept": edge["edge_kept"],
                    "passed": edge["edge_passed"],
                    "points_failed_between": bool(edge["edge_unknown"]),
                }
                for edge in rows_along(dataset, "edge")
            ],
            "one_way": _turning_points(dataset) == 0,
            "points": [
                {
                    "searched": or_none(point["searched"]),
                    "result": or_none(point["result"]),
                    "status": point["status"],
                }
                for point in rows_along(dataset, "point")
            ],
        }

    def sheets(self, dataset: "xr.Dataset") -> dict[str, SpreadsheetRows]:
        """Return a row for each value: the value, its result, and whether the limit is kept."""
        status = dataset["status"].to_numpy()
        verdict = np.where(status == "ok", np.where(dataset["keeps"] > 0.0, "yes", "no"), status)
        columns = dataset[["searched", "result"]].assign({"kept": ("point", verdict)})
        return {
            "": point_rows(
                columns.assign(dataset[["status", "message", "result_status", "seconds"]])
            )
        }

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return a table with a row for each value, in ascending order, or none if it would be too long."""
        return point_table(self.sheets(dataset)[""], [dataset.attrs["searched_key"]])


def satisfied_spans(dataset: "xr.Dataset") -> list[tuple[float, float, bool, bool]]:
    """Return the spans of values at which the limit is kept: both bounds, and whether each is a bound of the range."""
    ok = dataset["status"].to_numpy() == "ok"
    values = dataset["searched"].to_numpy()[ok]
    satisfied = dataset["keeps"].to_numpy()[ok] > 0.0
    changes = np.diff(np.concatenate(([0], satisfied.astype(int), [0])))
    starts = np.flatnonzero(changes == 1).tolist()
    ends = (np.flatnonzero(changes == -1) - 1).tolist()
    return [
        (float(values[start]), float(values[end]), start == 0, end + 1 == values.size)
        for start, end in zip(starts, ends, strict=True)
    ]


def summarise_limit(dataset: "xr.Dataset") -> str:
    """Return the limit in a few words: "minimum radial load 0.875 kN for steady slip up to 5 %"."""
    a = dataset.attrs
    unit = dataset["result"].attrs["units"]
    limit = format_quantity(float(a["limit"]), unit, 6, a["limit_given"] or None)
    side = "up to" if a["sense"] == "<=" else "of at least"
    requirement = f"{a['output'].replace('_', ' ')} {side} {limit}"
    label = short_label(a["searched_key"])
    values = dataset["searched"].to_numpy()[dataset["status"].to_numpy() == "ok"]
    if not values.size:
        return f"no {label} has a result, so that the limit is unknown"
    spans = satisfied_spans(dataset)
    extent = (
        f"from {_format_searched(dataset, values[0])} to {_format_searched(dataset, values[-1])}"
    )
    if not spans:
        return f"{requirement} at no {label} {extent}"
    if len(spans) > 1:
        texts = (
            f"{_format_searched(dataset, low)} to {_format_searched(dataset, high)}"
            for low, high, *_ in spans
        )
        return f"{requirement} with {label} {', and '.join(texts)}"
    ((low, high, is_first, is_last),) = spans
    if is_first and is_last:
        return f"{requirement} at every {label} {extent}"
    bounds = (
        f"{extreme} {label} {_format_searched(dataset, bound, 3)}"
        for extreme, bound, is_end in (("minimum", low, is_first), ("maximum", high, is_last))
        if not is_end
    )
    largest = ""
    if "largest_load" in a:  # of a search over the load
        load = float(a["largest_load"])
        largest = f"; largest load {format_force(load, load)}, {a['largest_load_limit']}"
    return f"{', '.join(bounds)} for {requirement}{largest}"


def _turns(dataset: "xr.Dataset") -> list[str]:
    """Return a remark where the result is not monotonic, so that the limit may be crossed unseen."""
    turns = _turning_points(dataset)
    return [f"the result turns back {turns} times: the limit may be crossed more often"] * bool(
        turns
    )


def _next_steps(dataset: "xr.Dataset") -> list[str]:
    """Return a search with more values where the result is not monotonic, else the run at the limit."""
    a = dataset.attrs
    low, high = json.loads(a["range"])
    search = f"rollslip limit {{scene}} --over {shlex.quote(a['searched_key'] + '=' + low + ':' + high + ':{}')}"
    search += f" --keep {shlex.quote(a['requirement'])}"
    edges = dataset["edge_kept"].to_numpy()
    if _turning_points(dataset):
        return [search.replace(":{}", f":{2 * int(a['first']) - 1}")]
    if not edges.size:
        return []
    value = _format_searched(dataset, float(edges[0]))
    return [f"rollslip run {{scene}} --set {a['searched_key']}={shlex.quote(value)}"]


def describe_limit(dataset: "xr.Dataset") -> str:
    """Return a sentence on the limit, with the results just beyond it, or nearest to it where it is not crossed."""
    summary = summarise_limit(dataset)
    if not (dataset["status"].to_numpy() == "ok").any():
        return summary
    beyond = [
        f"at {_format_searched(dataset, value)} {_describe_result(dataset, value)}"
        for value in dataset["edge_passed"].to_numpy().tolist()
    ]
    return "; ".join((summary, *beyond)) if beyond else summary + _describe_nearest(dataset)


def _describe_nearest(dataset: "xr.Dataset") -> str:
    """Text on the value at which the result is nearest to the limit."""
    results = dataset["result"].to_numpy()
    if not np.isfinite(results).any():
        return ", and at none of them has the study a value"
    size = (
        np.abs(results)
        if in_percent(dataset.attrs["output"], dataset["result"].attrs["units"])
        else results
    )
    k = int(np.nanargmin(np.abs(size - float(dataset.attrs["limit"]))))
    at = float(dataset["searched"][k])
    return f"; nearest to the limit is {_format_searched(dataset, at)}, where {_describe_result(dataset, at)}"


def _describe_jumps(dataset: "xr.Dataset") -> list[str]:
    """Sentences on jumps of the result across the limit, with its status on either side."""
    values = dataset["searched"].to_numpy()
    results = dataset["result"].to_numpy()
    x = np.log(values) if dataset.attrs["logarithmic"] else values
    statuses = dataset["result_status"].values
    sentences = []
    for ends in zip(
        dataset["edge_kept"].to_numpy(), dataset["edge_passed"].to_numpy(), strict=True
    ):
        a, b = np.searchsorted(values, sorted(ends)).tolist()
        fraction = max(_JUMP_FRACTION, _JUMP_STEEPNESS * float(x[b] - x[a]) / float(np.ptp(x)))
        if abs(results[b] - results[a]) > fraction * float(np.nanmax(results) - np.nanmin(results)):
            sides = [
                f"{_format_searched(dataset, float(values[k]))}, where {_describe_result(dataset, float(values[k]))}"
                + (f" ({statuses[k]})" if statuses[k] not in ("", Status.FOUND) else "")
                for k in (a, b)
            ]
            sentences.append(
                f"the result jumps across the limit between {sides[0]}, and {sides[1]}"
            )
    return sentences


def _turning_points(dataset: "xr.Dataset") -> int:
    """Number of changes of direction of the result along the values; 0 if it is monotonic."""
    results = dataset["result"].dropna("point").to_numpy()
    steps = np.diff(results)
    extent = results.max(initial=-np.inf) - results.min(initial=np.inf)
    signs = np.sign(steps[np.abs(steps) > _FLAT_FRACTION * extent])
    return int((np.diff(signs) != 0.0).sum())


def _describe_monotonicity(dataset: "xr.Dataset") -> list[str]:
    """Sentence on whether the result is monotonic, which the search assumes between the values."""
    name = dataset.attrs["output"]
    n = int(np.isfinite(dataset["result"].to_numpy()).sum())
    if n < 2:
        return []
    if not (turns := _turning_points(dataset)):
        return [
            f"{name} is monotonic over the {n} values with a result: the limit is crossed at most once"
        ]
    first = int(dataset.attrs["first"])
    return [
        f"{name} turns back {format_count(turns, 'time')} over the {n} values with a result: between two of the "
        f"first {first} it may pass the limit and come back unseen; --over {dataset.attrs['searched_key']}="
        f"LOW:HIGH:{2 * first - 1} looks at more"
    ]


def _describe_missing(dataset: "xr.Dataset") -> list[str]:
    """Sentence on values at which the study has no result, with the most frequent status."""
    ok = dataset["status"].to_numpy() == "ok"
    missing = ok & ~np.isfinite(dataset["result"].to_numpy())
    if not missing.any():
        return []
    why = in_brackets(main_reason(dataset["result_status"].to_numpy()[missing]) or "")
    return [
        f"at {int(missing.sum())} of {int(ok.sum())} values the study has no {dataset.attrs['output']}{why}; they "
        "count as not keeping the limit"
    ]


def _describe_failures(dataset: "xr.Dataset") -> list[str]:
    """Sentence on the points that failed, with the message of the first one."""
    failed = [point for point in rows_along(dataset, "point") if point["status"] != "ok"]
    if not failed:
        return []
    first = failed[0]
    return [
        f"{len(failed)} of {dataset.sizes['point']} points failed, which says nothing of the limit there; the first, "
        f"at {_format_searched(dataset, first['searched'])}, is {first['status']}: {first['message']}"
    ]


def _format_searched(dataset: "xr.Dataset", value: float, digits: int = 4) -> str:
    """Text of a value of the varied quantity, in the unit in which it was given."""
    return format_quantity(
        value, dataset["searched"].attrs["units"], digits, dataset.attrs["searched_given"] or None
    )


def _describe_result(dataset: "xr.Dataset", at: float) -> str:
    """Text on the result at a value."""
    k = int(np.argmin(np.abs(dataset["searched"].to_numpy() - at)))
    result = float(dataset["result"][k])
    name = dataset.attrs["output"]
    if math.isnan(result):
        return f"{name} has no value"
    given = dataset.attrs["limit_given"] or None
    return f"{name} is {format_quantity(result, dataset['result'].attrs['units'], 4, given)}"


ACCOUNT: Final = LimitAccount("limit")
