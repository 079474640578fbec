"""What a search for a limit has found, in sentences and plain values, from the dataset alone."""

import math
from collections import Counter
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from rollslip.results.account import Account, Sheet, Table
from rollslip.results.answer import Answer, Row
from rollslip.results.curves import or_none
from rollslip.results.dataset import rows_along
from rollslip.results.table import of_points
from rollslip.results.words import in_percent
from rollslip.units import format_quantity
from rollslip_campaigns.sweep.findings import point_table

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["LimitAccount", "headline", "satisfied_spans"]

#: Share of the span of all results, and times that of the values, by which two neighbours at a limit are apart where
#: the result jumps.
_JUMP = 0.1
_STEEP = 10.0
#: Changes of the result below this share of its range are no change of its course.
_FLAT: Final = 1e-6


class LimitAccount(Account):
    """How it is told where a limit is kept."""

    drawn = ".figures:limit_figures"

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return where the limit is kept."""
        return Answer(rows=(Row(key="limit", label="limit", text="", note=headline(dataset)),))

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Return what was found, by what it is about."""
        found = {"limit": [headline(dataset)]}
        others = {
            "width": _unknown(dataset),
            "jump": _jumps(dataset),
            "course": _course(dataset),
            "values missing": _without(dataset),
            "points failed": _failed(dataset),
        }
        return found | {name: lines for name, lines in others.items() if lines}

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return what was found as plain values, in SI units; what has no value is null."""
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
            "found": headline(dataset),
            "kept": [{"from": low, "to": high} for low, high, *_ in satisfied_spans(dataset)],
            "edges": [
                {
                    "kept": one["edge_kept"],
                    "passed": one["edge_passed"],
                    "points_failed_between": bool(one["edge_unknown"]),
                }
                for one in rows_along(dataset, "edge")
            ],
            "one_way": _turns(dataset) == 0,
            "points": [
                {
                    "searched": or_none(one["searched"]),
                    "result": or_none(one["result"]),
                    "status": one["status"],
                }
                for one in rows_along(dataset, "point")
            ],
        }

    def sheets(self, dataset: "xr.Dataset") -> dict[str, Sheet]:
        """Return a row for each value: what was searched, what came out, and whether it keeps the limit."""
        ended = dataset["status"].to_numpy()
        kept = np.where(ended == "ok", np.where(dataset["keeps"] > 0.0, "yes", "no"), ended)
        told = dataset[["searched", "result"]].assign(kept=("point", kept))
        return {
            "": of_points(told.assign(dataset[["status", "message", "result_status", "seconds"]]))
        }

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return a row for each value, in ascending order, if there are not too many to read."""
        return point_table(self.sheets(dataset)[""], [dataset.attrs["searched_key"]])


def satisfied_spans(dataset: "xr.Dataset") -> list[tuple[float, float, bool, bool]]:
    """Return the spans of values at which the limit is kept: both ends, and whether each is an end of the range."""
    ok = dataset["status"].to_numpy() == "ok"
    values = dataset["searched"].to_numpy()[ok]
    keeps = dataset["keeps"].to_numpy()[ok] > 0.0
    spans = list[tuple[float, float, bool, bool]]()
    begin = None
    for k in range(values.size):
        begin = k if keeps[k] and begin is None else begin
        if begin is not None and (k + 1 == values.size or not keeps[k + 1]):
            spans.append((float(values[begin]), float(values[k]), begin == 0, k + 1 == values.size))
            begin = None
    return spans


def headline(dataset: "xr.Dataset") -> str:
    """Say where the limit is kept."""
    what = dataset.attrs["requirement"]
    key = dataset.attrs["searched_key"]
    ok = dataset["status"].to_numpy() == "ok"
    values = dataset["searched"].to_numpy()[ok]
    if not values.size:
        return (
            f"whether {what} is kept is not known: none of {ok.size} values of {key} has a result"
        )
    spans = satisfied_spans(dataset)
    if len(spans) == 1 and spans[0][2] and spans[0][3]:
        return f"{what} is kept at all {values.size} values of {key} from {_ends(dataset, values)}{_nearest(dataset)}"
    if not spans:
        return (
            f"{what} is kept at none of {values.size} values of {key} from "
            f"{_ends(dataset, values)}{_nearest(dataset)}"
        )
    said = ", and ".join(_span(dataset, *span) for span in spans)
    passed = dataset["edge_passed"].to_numpy().tolist()
    beyond = "; ".join(f"at {_value(dataset, one)} {_result(dataset, one)}" for one in passed)
    return f"{what} is kept with {key} {said}; {beyond}"


def _span(dataset: "xr.Dataset", low: float, high: float, first: bool, last: bool) -> str:
    below = _value(dataset, low)
    above = _value(dataset, high)
    if first:
        return f"from {below}, where the range begins, up to {above}"
    if last:
        return f"from {below} on, up to {above}, where the range ends"
    return f"from {below} to {above}"


def _ends(dataset: "xr.Dataset", values: NDArray[Any]) -> str:
    return f"{_value(dataset, float(values[0]))} to {_value(dataset, float(values[-1]))}"


def _nearest(dataset: "xr.Dataset") -> str:
    """Say at which value the result is nearest to the limit, and what would have to be looked at beyond."""
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
    return f"; nearest to the limit is {_value(dataset, at)}, where {_result(dataset, at)}"


def _unknown(dataset: "xr.Dataset") -> list[str]:
    """Say which passages could not be narrowed down."""
    return [
        f"between {_value(dataset, one['edge_kept'])} and {_value(dataset, one['edge_passed'])} the limit could not be "
        "narrowed down, as points there failed"
        for one in rows_along(dataset, "edge")
        if one["edge_unknown"]
    ]


def _jumps(dataset: "xr.Dataset") -> list[str]:
    """Say where the limit is passed by a jump, so that no value is at it, and what the study says of either side."""
    values = dataset["searched"].to_numpy()
    results = dataset["result"].to_numpy()
    x = np.log(values) if dataset.attrs["logarithmic"] else values
    words = dataset["result_status"].values
    said = []
    for ends in zip(
        dataset["edge_kept"].to_numpy(), dataset["edge_passed"].to_numpy(), strict=True
    ):
        a, b = np.searchsorted(values, sorted(ends)).tolist()
        fraction = max(_JUMP, _STEEP * float(x[b] - x[a]) / float(np.ptp(x)))
        if abs(results[b] - results[a]) > fraction * float(np.nanmax(results) - np.nanmin(results)):
            told = [
                f"{_value(dataset, float(values[k]))}, where {_result(dataset, float(values[k]))}"
                + (f" ({words[k]})" if words[k] not in ("", "found") else "")
                for k in (a, b)
            ]
            said.append(f"the result jumps across the limit between {told[0]}, and {told[1]}")
    return said


def _turns(dataset: "xr.Dataset") -> int:
    """How often the result turns back along the values that have one."""
    results = dataset["result"].to_numpy()
    steps = np.diff(results[np.isfinite(results)])
    signs = (
        np.sign(steps[np.abs(steps) > _FLAT * np.ptp(results[np.isfinite(results)], axis=0)])
        if steps.size
        else steps
    )
    return int((np.diff(signs) != 0.0).sum())


def _course(dataset: "xr.Dataset") -> list[str]:
    """Say whether the result goes one way, on which the search relies between the values."""
    name = dataset.attrs["output"]
    n = int(np.isfinite(dataset["result"].to_numpy()).sum())
    if n < 2:
        return []
    turns = _turns(dataset)
    if not turns:
        return [
            f"{name} is monotonic over the {n} values with a result: none of them suggests further passages"
        ]
    more = f"--over {dataset.attrs['searched_key']}=LOW:HIGH:{2 * int(dataset.attrs['first']) - 1} looks at more"
    return [
        f"{name} turns back {turns} time{'s' * (turns != 1)} over the {n} values with a result: between two of the "
        f"first {int(dataset.attrs['first'])} it may pass the limit and come back unseen; {more}"
    ]


def _without(dataset: "xr.Dataset") -> list[str]:
    ok = dataset["status"].to_numpy() == "ok"
    results = dataset["result"].to_numpy()
    missing = ok & ~np.isfinite(results)
    if not missing.any():
        return []
    words = Counter(filter(None, dataset["result_status"].to_numpy()[missing].astype(str).tolist()))
    why = f" ({words.most_common(1)[0][0]})" if words else ""
    return [
        f"at {int(missing.sum())} of {int(ok.sum())} values the study has no {dataset.attrs['output']}{why}; they "
        "count as not keeping the limit"
    ]


def _failed(dataset: "xr.Dataset") -> list[str]:
    lost = [one for one in rows_along(dataset, "point") if one["status"] != "ok"]
    return [
        f"{len(lost)} of {dataset.sizes['point']} points failed, which says nothing of the limit there; the first, at "
        f"{_value(dataset, one['searched'])}, is {one['status']}: {one['message']}"
        for one in lost[:1]
    ]


def _value(dataset: "xr.Dataset", value: float) -> str:
    """Return a value of what is searched as it was given."""
    return format_quantity(
        value, dataset["searched"].attrs["units"], 4, dataset.attrs["searched_given"] or None
    )


def _result(dataset: "xr.Dataset", at: float) -> str:
    """Say what the result is at a value."""
    k = int(np.argmin(np.abs(dataset["searched"].to_numpy() - at)))
    result = float(dataset["result"][k])
    name = dataset.attrs["output"]
    if math.isnan(result):
        return f"{name} has no value"
    unit = dataset["result"].attrs["units"]
    given = dataset.attrs["limit_given"] or None
    return f"{name} is {format_quantity(result, unit, 4, given)}"


ACCOUNT: Final = LimitAccount("limit")
