"""What a validation found, in sentences, tables and plain values."""

import json
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account, Table
from rollslip.results.curves import or_none
from rollslip.units import format_quantity

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["ROWS", "STATEMENTS", "ValidationAccount", "row_tables", "shown", "statement_tables", "together"]

#: Heads of the tables.
ROWS: Final = ("condition", "models", "measured, 95 %", "calculated, 95 %", "ratio, 95 %", "verdict")
CHI_SQUARE: Final = ("data set", "series", "models", "chi-square", "degrees of freedom", "probability")
STATEMENTS: Final = ("statement", "models", "verdict", "found")
INSIDE, OUTSIDE, UNTOLD, HELD = "inside", "outside", "cannot be determined", "held"


def shown(value: float, unit: str, quantity: str, digits: int = 3) -> str:
    """Show a value of a quantity in people's units; slips in percent."""
    if math.isnan(value):
        return "none"
    if math.isinf(value):
        return "beyond" if value > 0.0 else "below"
    if unit == "1":
        return f"{100 * value:.{digits}g} %" if "slip" in quantity.rpartition("/")[2] else f"{value:.{digits}g}"
    return format_quantity(value, unit, digits)


def _band(low: float, high: float, unit: str = "1", quantity: str = "") -> str:
    if math.isnan(low) or math.isnan(high):
        return ""
    texts = (shown(end, unit, quantity) for end in (low, high))
    return f" ({' to '.join(texts)})"


def together(dataset: "xr.Dataset", *names: str, of: str = "row") -> list[tuple[str, ...]]:
    """Return the combinations of texts of rows, or statements, each once."""
    return list(dict.fromkeys(zip(*(map(str, dataset[f"{of}_{name}"].to_numpy()) for name in names), strict=True)))


def row_tables(dataset: "xr.Dataset") -> list[tuple[str, list[list[str]]]]:
    """Return caption and rows of a table for each series."""
    return [
        (f"{data_set}: {series}", _rows(dataset, data_set, series))
        for data_set, series in together(dataset, "data_set", "series")
    ]


def _rows(dataset: "xr.Dataset", data_set: str, series: str) -> list[list[str]]:
    mask = (dataset["row_data_set"].to_numpy() == data_set) & (dataset["row_series"].to_numpy() == series)
    cells = []
    for k in np.flatnonzero(mask):
        one = dataset.isel(row=int(k))
        unit = str(one["row_unit"].item())
        value = {name: float(one[name]) for name in _NUMBERS}
        of = unit, str(one["row_quantity"].item())
        calculated = shown(value["calculated"], *of)
        calculated += _band(value["calculated_low"], value["calculated_high"], *of)
        ratio = f"{value['ratio']:.3g}" if math.isfinite(value["ratio"]) else ""
        cells.append(
            [
                *(str(one[f"row_{name}"].item()) for name in ("condition", "models")),
                f"{shown(value['measured'], *of)} ± {shown(1.96 * value['uncertainty'], *of, 2)}",
                calculated,
                f"{ratio}{_band(value['ratio_low'], value['ratio_high'])}".strip(),
                str(one["row_verdict"].item()),
            ]
        )
    return cells


_NUMBERS: Final = (
    "measured", "uncertainty", "calculated", "calculated_low", "calculated_high", "ratio", "ratio_low", "ratio_high",
    "seconds",
)  # fmt: skip


def statement_tables(dataset: "xr.Dataset") -> list[tuple[str, list[list[str]]]]:
    """Return caption and rows of a table for the statements of each data set."""
    names = ("says", "models", "verdict", "found")
    return [
        (
            f"{data_set}, in words",
            [
                [str(dataset[f"statement_{name}"].to_numpy()[k]) for name in names]
                for k in np.flatnonzero(dataset["statement_data_set"].to_numpy() == data_set)
            ],
        )
        for (data_set,) in together(dataset, "data_set", of="statement")
    ]


class ValidationAccount(Account):
    """How models that were held against what was measured are told."""

    units: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("chi2", "freedom", "probability", "ratio", "ratio_high", "ratio_low"), "1"
    )
    drawn = ".figures:figures"

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say how many values lie inside and which statements hold, by the models."""
        models = dict.fromkeys(
            [*map(str, dataset["row_models"].to_numpy()), *map(str, dataset["statement_models"].to_numpy())]
        )
        found = {name: [_of_models(dataset, name)] for name in models}
        sets: dict[str, Any] = json.loads(dataset.attrs["data_sets"])
        estimated = [
            f"{name}: {', '.join(about['estimated'])}"
            for name, about in sets.items()
            if about["estimated"] and not about["form"]
        ]
        if estimated:
            found["estimated"] = [f"not stated by the source and estimated: {'; '.join(estimated)}"]
        open_ = dataset["row_verdict"].to_numpy() == UNTOLD
        reasons = dict.fromkeys(map(str, dataset["row_status"].to_numpy()[open_]))
        found["not told"] = [f"cannot be determined: {reason}" for reason in reasons if reason]
        return {name: texts for name, texts in found.items() if texts}

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return what was found as plain values; what has no value is null."""
        texts = ("data_set", "series", "models", "quantity", "unit", "condition", "verdict", "status")
        rows = [
            {name: str(dataset[f"row_{name}"].to_numpy()[k]) for name in texts}
            | {name: or_none(dataset[name].to_numpy()[k]) for name in _NUMBERS}
            for k in range(dataset.sizes["row"])
        ]
        groups = [
            {name: str(dataset[f"group_{name}"].to_numpy()[k]) for name in ("data_set", "series", "models")}
            | {name: or_none(dataset[name].to_numpy()[k]) for name in ("chi2", "freedom", "probability")}
            | {"status": str(dataset["chi2_status"].to_numpy()[k])}
            for k in range(dataset.sizes["group"])
        ]
        said = ("data_set", "models", "says", "by", "verdict", "found")
        statements = [
            {name: str(dataset[f"statement_{name}"].to_numpy()[k]) for name in said}
            for k in range(dataset.sizes["statement"])
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
        return [*rows, *said, *([Table("All rows of a series together", CHI_SQUARE, chi2)] if chi2 else [])]


def _of_models(dataset: "xr.Dataset", name: str) -> str:
    rows = dataset["row_verdict"].to_numpy()[dataset["row_models"].to_numpy() == name]
    said = dataset["statement_verdict"].to_numpy()[dataset["statement_models"].to_numpy() == name]
    parts = []
    if rows.size:
        judged = int((rows != UNTOLD).sum())
        parts.append(f"{int((rows == INSIDE).sum())} of {judged} values inside the 95 % band of both uncertainties")
        if judged < rows.size:
            parts.append(f"of {rows.size - judged} it cannot be determined")
    if said.size:
        judged = int((said != UNTOLD).sum())
        parts.append(f"{int((said == HELD).sum())} of {judged} statements hold")
        if judged < said.size:
            parts.append(f"of {said.size - judged} it cannot be determined")
    seconds = dataset["seconds"].to_numpy()[dataset["row_models"].to_numpy() == name]
    if np.isfinite(seconds).any():
        parts.append(f"a value takes {format_quantity(float(np.nanmedian(seconds)), 's', 2)}")
    return f"{'models as stated' if name == 'as stated' else name}: {', '.join(parts)}"


def chi_square_cells(dataset: "xr.Dataset") -> list[list[str]]:
    """Return chi-square of every series of several rows that has one, as texts."""
    cells = []
    for k in range(dataset.sizes["group"]):
        one = dataset.isel(group=k)
        chi2, freedom = float(one["chi2"]), int(one["freedom"])
        if math.isfinite(chi2) and freedom > 1:
            names = [str(one[f"group_{name}"].item()) for name in ("data_set", "series", "models")]
            cells.append([*names, f"{chi2:.3g}", str(freedom), f"{float(one['probability']):.2g}"])
    return cells


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [ValidationAccount("validation")]
