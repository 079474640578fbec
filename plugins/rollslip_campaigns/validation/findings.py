"""Report on a validation: sentences, tables and plain values."""

import json
import math
from collections.abc import Mapping
from typing import Any, ClassVar, Final

import numpy as np

from rollslip.results.account import Account, Table
from rollslip.results.answer import MAX_ROWS, Answer, Row
from rollslip.results.curves import json_value
from rollslip.results.dataset import rows_along, xr
from rollslip.results.text import two_digits
from rollslip.units import format_quantity

__all__ = [
    "ROWS",
    "STATEMENTS",
    "ValidationAccount",
    "format_value",
    "models_of",
    "row_tables",
    "statement_tables",
    "unique_texts",
]

#: Headings of the table of rows.
ROWS: Final = (
    "condition",
    "models",
    "measured, 95 %",
    "calculated, 95 %",
    "ratio, 95 %",
    "verdict",
)
#: Headings of the table of chi-square.
CHI_SQUARE: Final = (
    "data set",
    "series",
    "models",
    "chi-square",
    "degrees of freedom",
    "probability",
)
#: Headings of the table of statements.
STATEMENTS: Final = ("statement", "models", "verdict", "found")
#: Verdict of a row whose band of differences includes zero.
INSIDE: Final = "inside"
#: Verdict of a row whose band of differences does not include zero.
OUTSIDE: Final = "outside"
#: Verdict of a row or statement without enough values, or with values of another kind than was measured.
UNDETERMINED: Final = "cannot be determined"
#: Verdict of a statement with which the calculated values agree.
CONFIRMED: Final = "held"
#: Verdict of a statement with which the calculated values do not agree.
NOT_CONFIRMED: Final = "not held"


def format_value(value: float, unit: str, quantity: str, digits: int = 3) -> str:
    """Return a value of a quantity as text, in a readable unit; slips in percent.

    Parameters
    ----------
    value : float
        The value, in the unit; NaN is "none", an infinite value is beyond or below the range.
    unit : str
        SI unit.
    quantity : str
        Name of the quantity.
    digits : int
        Significant digits.
    """
    if math.isnan(value):
        return "none"
    if math.isinf(value):
        return "beyond" if value > 0.0 else "below"
    if unit == "1":
        return (
            f"{100 * value:.{digits}g} %"
            if "slip" in quantity.rpartition("/")[2]
            else f"{value:.{digits}g}"
        )
    return format_quantity(value, unit, digits)


def _band(low: float, high: float, unit: str = "1", quantity: str = "") -> str:
    """Return a band in parentheses, or nothing where an end is NaN."""
    if math.isnan(low) or math.isnan(high):
        return ""
    texts = (format_value(end, unit, quantity) for end in (low, high))
    return f" ({' to '.join(texts)})"


def unique_texts(dataset: "xr.Dataset", *names: str) -> list[tuple[str, ...]]:
    """Return the combinations of texts of rows, each once, in their order.

    Parameters
    ----------
    dataset : xarray.Dataset
        Result of a validation.
    *names : str
        Names of text variables without their prefix.
    """
    columns = [map(str, dataset[f"row_{name}"].to_numpy()) for name in names]
    return list(dict.fromkeys(zip(*columns, strict=True)))


def row_tables(dataset: "xr.Dataset") -> list[tuple[str, list[list[str]]]]:
    """Return caption and rows of a table for each series."""
    tables = dict[str, list[list[str]]]()
    for row in rows_along(dataset, "row"):
        unit = row["row_unit"], row["row_quantity"]
        ratio = f"{row['ratio']:.3g}" if math.isfinite(row["ratio"]) else ""
        tables.setdefault(f"{row['row_data_set']}: {row['row_series']}", []).append(
            [
                row["row_condition"],
                row["row_models"],
                f"{format_value(row['measured'], *unit)} ± {format_value(1.96 * row['uncertainty'], *unit, 2)}",
                format_value(row["calculated"], *unit)
                + _band(row["calculated_low"], row["calculated_high"], *unit),
                f"{ratio}{_band(row['ratio_low'], row['ratio_high'])}".strip(),
                row["row_verdict"],
            ]
        )
    return [*tables.items()]


def statement_tables(dataset: "xr.Dataset") -> list[tuple[str, list[list[str]]]]:
    """Return caption and rows of a table for the statements of each data set."""
    tables = dict[str, list[list[str]]]()
    for row in rows_along(dataset, "statement"):
        cells = [row[f"statement_{name}"] for name in ("text", "models", "verdict", "found")]
        tables.setdefault(f"{row['statement_data_set']}, statements", []).append(cells)
    return [*tables.items()]


class ValidationAccount(Account):
    """Reports models compared with data: tables of rows and statements, and numbers of values inside."""

    units: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("chi2", "freedom", "probability", "ratio", "ratio_high", "ratio_low"), "1"
    )
    figures_function = ".figures:figures"

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return the numbers of statements that hold and of values inside, and those that disagree first."""
        counts = [_count_verdicts(dataset, name) for name in models_of(dataset)]
        sets: dict[str, Any] = json.loads(dataset.attrs["data_sets"])
        rows = sorted(
            rows_along(dataset, "row"),
            key=lambda row: not sets[str(row["row_data_set"])].get("measured"),
        )
        body = [
            (
                row["row_condition"],
                f"{row['ratio']:.2f}" if math.isfinite(row["ratio"]) else "-",
                row["row_verdict"],
            )
            for row in rows
        ]
        body += [
            (row["statement_text"], "", row["statement_verdict"])
            for row in rows_along(dataset, "statement")
        ]
        estimated = sum(len(about["estimated"]) for about in sets.values() if not about["form"])
        body.sort(key=lambda cells: cells[-1] in (INSIDE, CONFIRMED))
        return Answer(
            summary=_describe_nearness(dataset),
            rows=tuple(
                Row(key=name, label=name, text="", note=text.partition(": ")[2])
                for name, text in zip(models_of(dataset)[1:], counts[1:], strict=True)
            ),
            table=(("value or statement", "calculated/measured", "verdict"), *body[:MAX_ROWS]),
            omitted=max(len(body) - MAX_ROWS, 0),
            assumed=(f"{estimated} values that the sources do not state (-v)",) * bool(estimated),
        )

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Return the counts of verdicts for each combination of models, and reasons of missing verdicts."""
        topics = {name: [_count_verdicts(dataset, name)] for name in models_of(dataset)}
        sets: dict[str, Any] = json.loads(dataset.attrs["data_sets"])
        estimated = [
            f"{name}: {', '.join(about['estimated'])}"
            for name, about in sets.items()
            if about["estimated"] and not about["form"]
        ]
        if estimated:
            topics["estimated"] = [
                f"not stated by the source and estimated: {'; '.join(estimated)}"
            ]
        undetermined = dataset["row_verdict"].to_numpy() == UNDETERMINED
        topics["undetermined"] = [
            f"cannot be determined: {reason}"
            for reason in dict.fromkeys(map(str, dataset["row_status"].to_numpy()[undetermined]))
            if reason
        ]
        return {name: texts for name, texts in topics.items() if texts}

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return rows, series and statements as plain values; a missing value is None."""
        return {
            "data_sets": json.loads(dataset.attrs["data_sets"]),
            "rows": _plain_values(dataset, "row"),
            "groups": _plain_values(dataset, "group"),
            "statements": _plain_values(dataset, "statement"),
            "samples": int(dataset.attrs["samples"]),
        }

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return tables of rows, statements and chi-square."""
        tables = [Table(caption, ROWS, cells) for caption, cells in row_tables(dataset)]
        tables += [
            Table(caption, STATEMENTS, cells) for caption, cells in statement_tables(dataset)
        ]
        if chi2 := chi_square_cells(dataset):
            tables.append(Table("All rows of a series together", CHI_SQUARE, chi2))
        return tables


def _describe_nearness(dataset: "xr.Dataset") -> str:
    """Return how near the models of the data sets come to values that were measured, or computed by others."""
    sets: dict[str, Any] = json.loads(dataset.attrs["data_sets"])
    own = models_of(dataset)[:1]
    rows = [row for row in rows_along(dataset, "row") if row["row_models"] in own]
    measured = [row for row in rows if sets[str(row["row_data_set"])].get("measured")]
    computed = [row for row in rows if row not in measured]
    parts = list[str]()
    if measured:
        quantities = dict.fromkeys(row["row_quantity"] for row in measured)
        ratios = [
            _ratios([row for row in measured if row["row_quantity"] == quantity], quantity)
            for quantity in quantities
        ]
        parts.append(f"calculated over measured: {', '.join(ratios)}; {_count_inside(measured)}")
    if computed:
        others = f"{'' if measured else 'calculated '}over what others computed"
        parts.append(f"{others}: {_ratios(computed)}; {_count_inside(computed)}")
    verdicts = [
        row["statement_verdict"]
        for row in rows_along(dataset, "statement")
        if row["statement_models"] in own
    ]
    if verdicts:
        known = len(verdicts) - verdicts.count(UNDETERMINED)
        parts.append(f"{verdicts.count(CONFIRMED)} of {known} statements hold")
    return "; ".join(parts) or "nothing to compare: forms have no numbers"


def _ratios(rows: list[dict[str, Any]], quantity: str = "") -> str:
    """Return name of a quantity, and median and range of the ratios of some rows."""
    name = (quantity.rpartition("/")[2] or quantity).replace("-", " ").replace("_", " ")
    ratios = [row["ratio"] for row in rows if math.isfinite(row["ratio"])]
    if not ratios:
        return f"{name} -".strip()
    low, median, high = (two_digits(float(np.quantile(ratios, q))) for q in (0.0, 0.5, 1.0))
    return f"{name} {median} ({low} to {high})".strip()


def _count_inside(rows: list[dict[str, Any]]) -> str:
    """Return how many of some rows are inside the bands of both uncertainties, and of how many that is not known."""
    verdicts = [row["row_verdict"] for row in rows]
    undetermined = verdicts.count(UNDETERMINED)
    text = f"{verdicts.count(INSIDE)} of {len(verdicts) - undetermined} inside both uncertainties"
    return f"{text}, {undetermined} cannot be determined" if undetermined else text


def _plain_values(dataset: "xr.Dataset", dim: str) -> list[dict[str, Any]]:
    """Return the values along a dimension as plain values, by names without the dimension."""
    return [
        {
            name.removeprefix(f"{dim}_").removeprefix("chi2_"): json_value(value)
            for name, value in row.items()
        }
        for row in rows_along(dataset, dim)
    ]


def models_of(dataset: "xr.Dataset") -> list[str]:
    """Return the models of rows and statements, each once."""
    return list(
        dict.fromkeys(
            map(str, (*dataset["row_models"].to_numpy(), *dataset["statement_models"].to_numpy()))
        )
    )


def _count_verdicts(dataset: "xr.Dataset", name: str) -> str:
    """Return a sentence on the verdicts of all rows and statements under some models."""
    parts = []
    for prefix, verdict, text in (
        ("row", INSIDE, "values inside the 95 % band of both uncertainties"),
        ("statement", CONFIRMED, "statements hold"),
    ):
        verdicts = dataset[f"{prefix}_verdict"].to_numpy()[
            dataset[f"{prefix}_models"].to_numpy() == name
        ]
        undetermined = int((verdicts == UNDETERMINED).sum())
        if verdicts.size:
            parts.append(
                f"{int((verdicts == verdict).sum())} of {verdicts.size - undetermined} {text}"
            )
        if undetermined:
            parts.append(f"of {undetermined} it cannot be determined")
    seconds = dataset["seconds"].to_numpy()[dataset["row_models"].to_numpy() == name]
    if np.isfinite(seconds).any():
        parts.append(f"a value takes {format_quantity(float(np.nanmedian(seconds)), 's', 2)}")
    return f"{'models as stated' if name == 'as stated' else name}: {', '.join(parts)}"


def chi_square_cells(dataset: "xr.Dataset") -> list[list[str]]:
    """Return the cells of the table of chi-square, for each series of several rows that has a value of it."""
    return [
        [
            row["group_data_set"],
            row["group_series"],
            row["group_models"],
            f"{row['chi2']:.3g}",
            str(row["freedom"]),
            f"{row['probability']:.2g}",
        ]
        for row in rows_along(dataset, "group")
        if math.isfinite(row["chi2"]) and row["freedom"] > 1
    ]


ACCOUNT: Final = ValidationAccount("validation")
