"""Report on a fit: parameters with intervals, correlations, and what the data do not determine.

A value that the data do not determine is None, with a status that says so.
"""

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from rollslip.results.account import Account, Table
from rollslip.results.answer import MAX_ROWS, Answer
from rollslip.results.curves import or_none
from rollslip.results.dataset import rows_along, xr
from rollslip.results.text import first_line, format_count
from rollslip.units import format_quantity

__all__ = ["FitAccount", "headline", "parameter_rows"]

#: Part of the status of a side whose limit is not known, in contrast to one that the data do not limit.
UNKNOWN: Final = "is not known"
#: Status of a parameter whose interval has both limits.
DETERMINED: Final = "determined"
#: Words for two parameters of which the data determine a combination only.
EXCHANGEABLE: Final = "are exchangeable"
#: Correlation above which two parameters are reported as exchangeable: the error of either is then at least seven
#: times, 1/sqrt(1 - 0.99^2), what it would be if the other was known. Doubling the distance from 1 reports five times.
_MIN_EXCHANGEABLE: Final = 0.99
#: Headings of the table of parameters.
_HEAD: Final = ("parameter", "value", "error", "68 %", "95 %", "what the data determine")


def headline(dataset: "xr.Dataset") -> str:
    """Return the line on provenance: version, data with hash, and models with third-party packages."""
    a = dataset.attrs
    return first_line(
        json.loads(a["packages"])["rollslip"],
        a["source"],
        a["data_sha256"],
        (
            (model["kind"], model["name"], model["package"], model["version"])
            for model in json.loads(a["models"])
        ),
    )


def parameter_rows(dataset: "xr.Dataset") -> list[tuple[str, ...]]:
    """Return rows of parameter, value, standard error, 68 % and 95 % interval and status."""
    rows = []
    limits = zip(dataset["interval"].to_numpy(), dataset["limit_status"].to_numpy(), strict=True)
    for row, (intervals, statuses) in zip(rows_along(dataset, "parameter"), limits, strict=True):
        unit = row["unit"]
        value = row["value"]
        error = row["standard_error"]
        fraction = f"{100 * error / abs(value):.2g} %" if value else format_quantity(error, unit, 2)
        unknown = [UNKNOWN in status for status in statuses]
        rows.append(
            (
                row["parameter"],
                format_quantity(value, unit, 4),
                "-" if math.isnan(error) else fraction,
                *(_interval(ends, unit, unknown) for ends in intervals),
                row["status"],
            )
        )
    return rows


def _interval(limits: NDArray[np.float64], unit: str, unknown: Sequence[bool]) -> str:
    """Return an interval in words: "none" where the data give no limit, "?" where it is not known."""
    low, high = (
        format_quantity(float(limit), unit, 4) if math.isfinite(limit) else "?" * is_unknown
        for limit, is_unknown in zip(limits, unknown, strict=True)
    )
    if low == high == "?":
        return "not known"
    if "?" in (low, high):
        return f"{low or 'none'} to {high or 'none'}"
    if low and high:
        number, _, low_unit = low.partition(" ")
        return f"{number if high.endswith(f' {low_unit}') else low} to {high}"
    if low:
        return f"above {low}"
    return f"below {high}" if high else "none"


class FitAccount(Account):
    """Reports a fit with a table of its parameters."""

    units: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("chi2", "correlation", "freedom", "operating_points", "rows", "scatter", "spread"), "1"
    )
    figures_function = ".figures:figures"

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return the first parameter with its interval, and a row for each parameter."""
        rows = parameter_rows(dataset)
        name, value, _, _, limits, _ = rows[0]
        others = f"; {len(rows) - 1} more below" * (len(rows) > 1)
        table = FitAccount("fit").tables(dataset)[0]
        return Answer(
            summary=f"{name} {value} (95 %: {limits}){others}",
            table=((*_HEAD[:-1], "status"), *map(tuple, table.rows[:MAX_ROWS])),
            omitted=max(len(rows) - MAX_ROWS, 0),
            faults=tuple(
                line.partition(":")[0] for line in FitAccount.lines(dataset) if EXCHANGEABLE in line
            ),
        )

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Return a sentence on each parameter: value, interval and status."""
        return {
            name: [f"{value}, 95 %: {limits}; {status}"]
            for name, value, _, _, limits, status in parameter_rows(dataset)
        }

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Return the sentences on all parameters."""
        return [f"{name}: {text}" for name, (text,) in self.topics(dataset).items()]

    @staticmethod
    def lines(dataset: "xr.Dataset") -> list[str]:
        """Return lines on the scatter, the strongest correlations, and exchangeable parameters."""
        a = dataset.attrs
        largest = float(np.abs(dataset["friction"]).max())
        chi2 = f", chi2 {a['chi2']:.4g}" if "chi2" in a else ""
        points = format_count(dataset.sizes["point"], "operating point")
        lines = [
            f"{dataset.sizes['row']} rows at {points}, {a['freedom']} degrees of freedom"
            f"{chi2}; residuals of {a['scatter']:.3g}, {a['scatter'] / largest:.2%} of the largest friction; "
            f"uncertainties {a['uncertainties']}"
        ]
        names = dataset["parameter"].values
        correlation = dataset["correlation"].to_numpy()
        pairs = [
            (i, j) for i in range(names.size) for j in range(i) if math.isfinite(correlation[i, j])
        ]
        if pairs:
            # more digits close to 1
            lines.append(
                "correlation: "
                + ", ".join(
                    f"{names[j]} with {names[i]} "
                    f"{correlation[i, j]:.{3 if abs(correlation[i, j]) < 0.999 else 6}f}"
                    for i, j in sorted(pairs, key=lambda pair: -abs(correlation[pair]))[:3]
                )
            )
        for i, j in pairs:
            if (r := abs(correlation[i, j])) >= _MIN_EXCHANGEABLE:
                factor = 1.0 / math.sqrt(max(1.0 - r**2, 1e-24))
                lines.append(
                    f"{names[j]} and {names[i]} {EXCHANGEABLE}: the data determine a combination of them only, and "
                    f"the error of either is {factor:.2g} times what it would be if the other was known; leave out the "
                    "one that is known from elsewhere, or measure where they act differently, at other pressures, "
                    "temperatures or slips"
                )
        return lines

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return the parameters with their errors and intervals."""
        return [Table("", _HEAD, list(map(list, parameter_rows(dataset))))]

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return a fit as plain values; a value that is not determined is None, with its status."""
        a = dataset.attrs
        others = dataset["with_parameter"].to_numpy().tolist()
        parameters = {}
        for k, row in enumerate(rows_along(dataset, "parameter")):
            intervals, statuses, correlation = (
                dataset[name].to_numpy()[k].tolist()
                for name in ("interval", "limit_status", "correlation")
            )
            parameters[row["parameter"]] = {
                **{name: row[name] for name in ("unit", "meaning", "value", "start_value")},
                "standard_error": or_none(row["standard_error"]),
                "status": row["status"],
                "interval 68 %": [*map(or_none, intervals[0])],
                "interval 95 %": [*map(or_none, intervals[1])],
                "limit_status": dict(zip(("lower", "upper"), statuses, strict=True)),
                "correlation": dict(zip(others, map(or_none, correlation), strict=True)),
            }
        return {
            "rollslip": json.loads(a["packages"])["rollslip"],
            "data": a["source"],
            "data_sha256": a["data_sha256"],
            "models": {model["kind"]: model["name"] for model in json.loads(a["models"])},
            "rows": dataset.sizes["row"],
            "operating_points": dataset.sizes["point"],
            "freedom": int(a["freedom"]),
            "chi2": float(a["chi2"]) if "chi2" in a else None,
            "scatter": float(a["scatter"]),
            "uncertainties": a["uncertainties"],
            "parameters": parameters,
            "spread": [*map(or_none, dataset["spread"].to_numpy())],
            "warnings": json.loads(a["warnings"]),
            "evaluations": int(a["evaluations"]),
            "wall_time": float(a["wall_time"]),
        }


ACCOUNT: Final = FitAccount("fit")
