"""What a validation found, in sentences, tables and plain values."""

import json
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np

from rollslip.results.account import Account, Table
from rollslip.results.curves import or_none
from rollslip.results.dataset import rows_along
from rollslip.units import format_quantity

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "ROWS",
    "STATEMENTS",
    "ValidationAccount",
    "models_of",
    "row_tables",
    "shown",
    "statement_tables",
    "together",
]

#: Heads of the tables.
ROWS: Final = (
    "condition",
    "models",
    "measured, 95 %",
    "calculated, 95 %",
    "ratio, 95 %",
    "verdict",
)
CHI_SQUARE: Final = (
    "data set",
    "series",
    "models",
    "chi-square",
    "degrees of freedom",
    "probability",
)
STATEMENTS: Final = ("statement", "models", "verdict", "found")
INSIDE: Final = "inside"
UNDETERMINED: Final = "cannot be determined"
HELD: Final = "held"


def shown(value: float, unit: str, quantity: str, digits: int = 3) -> str:
    """Show a value of a quantity in people's units; slips in percent."""
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
    if math.isnan(low) or math.isnan(high):
        return ""
    texts = (shown(end, unit, quantity) for end in (low, high))
    return f" ({' to '.join(texts)})"


def together(dataset: "xr.Dataset", *names: str, of: str = "row") -> list[tuple[str, ...]]:
    """Return the combinations of texts of rows, or statements, each once."""
    return list(
        dict.fromkeys(
            zip(*(map(str, dataset[f"{of}_{name}"].to_numpy()) for name in names), strict=True)
        )
    )


def row_tables(dataset: "xr.Dataset") -> list[tuple[str, list[list[str]]]]:
    """Return caption and rows of a table for each series."""
    tables = dict[str, list[list[str]]]()
    for one in rows_along(dataset, "row"):
        of = one["row_unit"], one["row_quantity"]
        ratio = f"{one['ratio']:.3g}" if math.isfinite(one["ratio"]) else ""
        tables.setdefault(f"{one['row_data_set']}: {one['row_series']}", []).append(
            [
                one["row_condition"],
                one["row_models"],
                f"{shown(one['measured'], *of)} ± {shown(1.96 * one['uncertainty'], *of, 2)}",
                shown(one["calculated"], *of)
                + _band(one["calculated_low"], one["calculated_high"], *of),
                f"{ratio}{_band(one['ratio_low'], one['ratio_high'])}".strip(),
                one["row_verdict"],
            ]
        )
    return [*tables.items()]


_NUMBERS: Final = (
    "measured", "uncertainty", "calculated", "calculated_low", "calculated_high", "ratio", "ratio_low", "ratio_high",
    "seconds",
)  # fmt: skip


def statement_tables(dataset: "xr.Dataset") -> list[tuple[str, list[list[str]]]]:
    """Return caption and rows of a table for the statements of each data set."""
    tables = dict[str, list[list[str]]]()
    for one in rows_along(dataset, "statement"):
        cells = [one[f"statement_{name}"] for name in ("text", "models", "verdict", "found")]
        tables.setdefault(f"{one['statement_data_set']}, in words", []).append(cells)
    return [*tables.items()]


class ValidationAccount(Account):
    """How models that were held against what was measured are told."""

    units: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("chi2", "freedom", "probability", "ratio", "ratio_high", "ratio_low"), "1"
    )
    drawn = ".figures:figures"

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say how many values lie inside and which statements hold, by the models."""
        found = {name: [_of_models(dataset, name)] for name in models_of(dataset)}
        sets: dict[str, Any] = json.loads(dataset.attrs["data_sets"])
        estimated = [
            f"{name}: {', '.join(about['estimated'])}"
            for name, about in sets.items()
            if about["estimated"] and not about["form"]
        ]
        if estimated:
            found["estimated"] = [f"not stated by the source and estimated: {'; '.join(estimated)}"]
        open_ = dataset["row_verdict"].to_numpy() == UNDETERMINED
        reasons = dict.fromkeys(map(str, dataset["row_status"].to_numpy()[open_]))
        found["not told"] = [f"cannot be determined: {reason}" for reason in reasons if reason]
        return {name: texts for name, texts in found.items() if texts}

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return what was found as plain values; what has no value is null."""
        texts = (
            "data_set",
            "series",
            "models",
            "quantity",
            "unit",
            "condition",
            "verdict",
            "status",
        )
        rows = [
            {name: one[f"row_{name}"] for name in texts}
            | {name: or_none(one[name]) for name in _NUMBERS}
            for one in rows_along(dataset, "row")
        ]
        groups = [
            {name: one[f"group_{name}"] for name in ("data_set", "series", "models")}
            | {name: or_none(one[name]) for name in ("chi2", "freedom", "probability")}
            | {"status": one["chi2_status"]}
            for one in rows_along(dataset, "group")
        ]
        statements = [
            {name.removeprefix("statement_"): text for name, text in one.items()}
            for one in rows_along(dataset, "statement")
        ]
        return {
            "data_sets": json.loads(dataset.attrs["data_sets"]),
            "rows": rows,
            "groups": groups,
            "statements": statements,
            "samples": int(dataset.attrs["samples"]),
        }

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return rows and statements."""
        rows = [Table(caption, ROWS, cells) for caption, cells in row_tables(dataset)]
        said = [Table(caption, STATEMENTS, cells) for caption, cells in statement_tables(dataset)]
        chi2 = chi_square_cells(dataset)
        return [
            *rows,
            *said,
            *([Table("All rows of a series together", CHI_SQUARE, chi2)] if chi2 else []),
        ]


def models_of(dataset: "xr.Dataset") -> list[str]:
    """Return the models of rows and statements, each once."""
    return list(
        dict.fromkeys(
            map(str, (*dataset["row_models"].to_numpy(), *dataset["statement_models"].to_numpy()))
        )
    )


def _of_models(dataset: "xr.Dataset", name: str) -> str:
    parts = []
    for of, good, what in (
        ("row", INSIDE, "values inside the 95 % band of both uncertainties"),
        ("statement", HELD, "statements hold"),
    ):
        verdicts = dataset[f"{of}_verdict"].to_numpy()[dataset[f"{of}_models"].to_numpy() == name]
        undetermined = int((verdicts == UNDETERMINED).sum())
        if verdicts.size:
            parts.append(
                f"{int((verdicts == good).sum())} of {verdicts.size - undetermined} {what}"
            )
        if undetermined:
            parts.append(f"of {undetermined} it cannot be determined")
    seconds = dataset["seconds"].to_numpy()[dataset["row_models"].to_numpy() == name]
    if np.isfinite(seconds).any():
        parts.append(f"a value takes {format_quantity(float(np.nanmedian(seconds)), 's', 2)}")
    return f"{'models as stated' if name == 'as stated' else name}: {', '.join(parts)}"


def chi_square_cells(dataset: "xr.Dataset") -> list[list[str]]:
    """Return chi-square of every series of several rows that has one, as texts."""
    return [
        [
            one["group_data_set"], one["group_series"], one["group_models"], f"{one['chi2']:.3g}", str(one["freedom"]),
            f"{one['probability']:.2g}",
        ]
        for one in rows_along(dataset, "group")
        if math.isfinite(one["chi2"]) and one["freedom"] > 1
    ]  # fmt: skip


ACCOUNT: Final = ValidationAccount("validation")
