"""Report a table of load cases as sentences, tables and plain values, from its dataset alone."""

import json
import shlex
from collections.abc import Mapping
from typing import Any, ClassVar, Final

import numpy as np

from rollslip.results.account import Account, SpreadsheetRows, Table
from rollslip.results.answer import Answer
from rollslip.results.curves import or_none
from rollslip.results.dataset import xr
from rollslip.results.table import point_rows
from rollslip.results.text import format_hours, percent
from rollslip.results.verdict import Verdict, is_as_bad
from rollslip.units import format_quantity
from rollslip_campaigns.sweep.findings import answer_table, point_table

__all__ = ["CasesAccount", "life_of_spectrum", "mean_over_time", "time_by_verdict", "worst_first"]

#: Cases in an answer, the worst ones. Chosen: with rows, notes and next step they fill 15 lines.
_SHOWN: Final = 5
#: Variables of the cases in an answer.
_COLUMNS: Final = ("verdict", "slip", "minimum_load", "friction_torque")

#: Variables whose mean over time is reported.
_AVERAGED: Final = ("friction_torque", "heat")


class CasesAccount(Account):
    """Report of the campaign ``cases``."""

    units: ClassVar[Mapping[str, str]] = {"time_by_verdict": "1", "worst_case": "1"}
    figures_function = ".figures:case_figures"

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return the part of the time in which the cage slips and skids, means over time, and the worst cases."""
        counts = json.loads(dataset.attrs["counts"])
        missing = sum(counts.values()) - counts["ok"]
        worst = worst_first(dataset)
        shown = dataset.isel(case=worst[:_SHOWN])
        faults = (f"{missing} of {sum(counts.values())} cases have no result",) * bool(missing)
        return Answer(
            summary="; ".join(
                [
                    _describe_time(dataset),
                    _describe_worst(dataset),
                    *_means(dataset),
                    *_describe_life(dataset),
                ]
            ),
            faults=faults,
            assumed=(
                *_describe_interpolation(dataset),
                "verdicts are by the values alone, without bands: a run of a case has them",
            ),
            next=(_run_of(dataset, worst[0]),),
            **answer_table(_table(shown), range(shown.sizes["case"]))
            | {"omitted": dataset.sizes["case"] - shown.sizes["case"]},
        )

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Return sentences by topic: the time by verdict, and means."""
        topics = {
            "time": [_describe_time(dataset)],
            "worst case": [_describe_worst(dataset)],
            "means": _means(dataset),
            "interpolation": _describe_interpolation(dataset),
            "rating life": _describe_life(dataset),
        }
        return {name: lines for name, lines in topics.items() if lines}

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the results as plain values, in SI units; None (null in JSON) where there is no value."""
        return {
            "counts": json.loads(dataset.attrs["counts"]),
            "time_by_verdict": time_by_verdict(dataset),
            "worst_case": int(dataset["case"][worst_first(dataset)[0]]),
            "means": {name: or_none(mean_over_time(dataset, name)) for name in _AVERAGED},
            "life": or_none(life_of_spectrum(dataset)),
        }

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return a table with a row for each case, or none if it would be too long."""
        return _table(dataset)

    def sheets(self, dataset: "xr.Dataset") -> dict[str, SpreadsheetRows]:
        """Return a row for each case: what varies, its part of the time, verdict and values."""
        return {"": _rows(dataset, [str(name) for name in dataset.data_vars])}


def time_by_verdict(dataset: "xr.Dataset") -> dict[str, float]:
    """Return the part of the time by verdict, from the worst to the best; "" has the cases without a result."""
    names = (Verdict.SKIDS, Verdict.UNKNOWN, Verdict.SLIPS, Verdict.OK, "")
    verdicts = dataset["verdict"].to_numpy().astype(str)
    fractions = dataset["time_fraction"].to_numpy()
    return {str(name): float(fractions[verdicts == str(name)].sum()) for name in names}


def worst_first(dataset: "xr.Dataset") -> list[int]:
    """Return the indices of the cases from the worst to the best: by verdict, then by the size of the slip."""
    verdicts = dataset["verdict"].to_numpy().astype(str)
    slips = np.nan_to_num(np.abs(dataset["slip"].to_numpy()), nan=np.inf)
    ranks = [sum(is_as_bad(verdict, other) for other in Verdict) for verdict in verdicts]
    return [int(k) for k in np.lexsort((-slips, -np.array(ranks)))]


def mean_over_time(dataset: "xr.Dataset", name: str) -> float:
    """Return the mean of a variable over time; cases without a value do not count, and NaN is the mean of none."""
    values = dataset[name].to_numpy() if name in dataset else np.empty(0)
    weights = dataset["time_fraction"].to_numpy()[np.isfinite(values)] if values.size else values
    return float(values[np.isfinite(values)] @ weights / weights.sum()) if weights.sum() else np.nan


def life_of_spectrum(dataset: "xr.Dataset") -> float:
    """Return the life in which all cases together use up the bearing [s]: parts of the damage add up (Miner).

    It is NaN for an older result, which has no lives of the cases.
    """
    if "life" not in dataset:
        return np.nan
    with np.errstate(divide="ignore"):
        return float(1.0 / np.sum(dataset["time_fraction"] / dataset["life"]))


def _describe_life(dataset: "xr.Dataset") -> list[str]:
    """Return the life of the spectrum in words; nothing for an older result."""
    life = life_of_spectrum(dataset)
    return [f"rating life {format_hours(life)} by ISO 281"] * (not np.isnan(life))


def _describe_interpolation(dataset: "xr.Dataset") -> list[str]:
    """Return how many cases are interpolated and how exactly, in words; nothing where all are computed."""
    if not (count := int(dataset.attrs.get("interpolated_cases", 0))):
        return []
    error = percent(float(dataset.attrs["interpolation_error"]))
    checked = dataset.attrs["checked_cases"]
    return [
        f"{count} of {dataset.sizes['case']} cases are interpolated: {checked} drawn at random err by up to {error}"
    ]


def _describe_time(dataset: "xr.Dataset") -> str:
    """Return the part of the time by verdict in words."""
    times = time_by_verdict(dataset)
    verbs = {
        "skids": Verdict.SKIDS,
        "slips": Verdict.SLIPS,
        "may skid": Verdict.UNKNOWN,
        "is OK": Verdict.OK,
        "has no result": "",
    }
    parts = [f"{verb} {percent(times[name])}" for verb, name in verbs.items() if times[name]]
    return f"{', '.join(parts)} of the time"


def _describe_worst(dataset: "xr.Dataset") -> str:
    """Return number and slip of the worst case in words."""
    worst = dataset.isel(case=worst_first(dataset)[0])
    slip = float(worst["slip"])
    found = f"slip {percent(slip)}" if np.isfinite(slip) else "no steady slip"
    return f"worst is case {int(worst['case'])}, {found}"


def _means(dataset: "xr.Dataset") -> list[str]:
    """Return torque and heat in the mean over time in words."""
    return [
        f"{name.replace('_', ' ')} {format_quantity(mean, dataset[name].attrs['units'], 2)} in the mean over time"
        for name in _AVERAGED
        if np.isfinite(mean := mean_over_time(dataset, name))
    ]


def _rows(dataset: "xr.Dataset", names: list[str]) -> SpreadsheetRows:
    """Return head and rows of the cases: what varies, and some variables."""
    varied = [str(name) for name in dataset.coords if name != "case"]
    return point_rows(dataset.reset_coords(varied)[[*varied, *names]])


def _table(dataset: "xr.Dataset") -> list[Table]:
    """Return a table for print with a row for each case."""
    keys = [str(c.attrs["key"]) for c in dataset.coords.values() if "key" in c.attrs]
    return point_table(_rows(dataset, [*_COLUMNS, "status"]), keys)


def _run_of(dataset: "xr.Dataset", index: int) -> str:
    """Return the command that runs a case."""
    case = dataset.isel(case=index)
    changes = [
        f"--set {c.attrs['key']}='{_as_written(c)}'"
        for c in case.coords.values()
        if "key" in c.attrs
    ]
    return " ".join(["rollslip run", shlex.quote(str(dataset.attrs["source"])), *changes])


def _as_written(coordinate: "xr.DataArray") -> str:
    """Return the value of a coordinate as a scene takes it."""
    value = coordinate.item()
    unit = str(coordinate.attrs.get("units", ""))
    return format_quantity(value, unit, 6) if isinstance(value, float) else str(value)


ACCOUNT: Final = CasesAccount("cases")
