"""Tables of results for spreadsheets, in engineering units, which are in the head of the columns.

The table of a run has its verdict, bearing, quantities, assumptions and notes. A result of many points has a row for
each point: first what varies, then the values, a column for each, and their statuses. A number that is not known is an
empty cell.
"""

import csv
import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rollslip.errors import OutputError
from rollslip.files import readable, whole_file
from rollslip.results.account import SpreadsheetRows
from rollslip.results.accounts import account_of, answer
from rollslip.results.text import in_percent
from rollslip.units import NUMBER, converted, expect_results, shown_unit

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

__all__ = ["FORMATS", "in_shown_unit", "point_rows", "save_tables", "sheet", "table"]

#: Values of one variable at a point that get a column each, at most. Chosen: variables with more values are curves,
#: which are in the .nc file only.
_MAX_COLUMNS: Final = 12


def table(*results: "xr.Dataset") -> "pd.DataFrame":
    """Return results as a table in engineering units: of a run the rows of its answer, of many points a row each.

    Parameters
    ----------
    *results : xarray.Dataset
        Result of a campaign, or those of one run.

    Returns
    -------
    pandas.DataFrame
        The table of ``--format csv``; units are in the heads of columns, or in a column of their own.

    Examples
    --------
    >>> import rollslip
    >>> rollslip.table(rollslip.run("gearbox", "steady-slip")).loc[2, ["quantity", "in words"]].to_list()
    ['cage slip', '2.0 %']
    """
    import pandas as pd  # a dependency of xarray

    expect_results("table", *results)
    head, rows = sheet(*results)
    return pd.DataFrame(rows, columns=head)


def sheet(*results: "xr.Dataset") -> SpreadsheetRows:
    """Return head and rows of results, as `table` has them."""
    for own_sheet in account_of(results[0]).sheets(results[0]).values():
        return own_sheet
    return point_rows(results[0]) if _has_points(results[0]) else _answer_rows(results)


def save_tables(
    results: Mapping[str, "xr.Dataset"], folder: Path, formats: Iterable[str]
) -> list[Path]:
    """Write tables into a folder and return the files: "answer" of a run, NAME of a result of many points.

    Parameters
    ----------
    results : mapping of str to xarray.Dataset
        Results by name.
    folder : Path
        Folder of the files.
    formats : iterable of str
        Suffixes, of `FORMATS`.
    """
    sheets = {
        f"{name}{suffix}": own_sheet
        for name, result in results.items()
        for suffix, own_sheet in account_of(result).sheets(result).items()
    }
    sheets |= {
        name: point_rows(result)
        for name, result in results.items()
        if _has_points(result) and name not in sheets
    }
    if not sheets:
        sheets = {"answer": sheet(*results.values())}
    paths = []
    for name, (head, rows) in sheets.items():
        for suffix in formats:
            path = folder / f"{name}.{suffix}"
            with whole_file(path) as partial:
                FORMATS[suffix](partial, head, rows)
            paths.append(path)
    return paths


def in_shown_unit(
    name: str, values: Iterable[float], unit: str, given: str = ""
) -> tuple[str, list[float | None]]:
    """Return the unit in which values are shown, and the values in it.

    Parameters
    ----------
    name : str
        Name of the quantity: fractions are shown in percent.
    values : iterable of float
        Values in SI units.
    unit : str
        SI unit.
    given : str
        Unit in which the user gave the values; otherwise the unit fits the largest value.

    Returns
    -------
    str, list
        The unit; the values, None for those that are not finite.
    """
    values = list(values)
    shown = "" if given == "1" else given
    if in_percent(name, unit):
        shown = "%"
    if unit != "1" and not shown:
        shown = shown_unit(
            float(np.max(np.abs([x for x in values if math.isfinite(x)]), initial=0.0)), unit
        )
    return shown, [
        float(f"{converted(x, unit, shown):.12g}") if math.isfinite(x) else None for x in values
    ]


def _has_points(dataset: "xr.Dataset") -> bool:
    """Whether a result has many points, each with a status."""
    return "status" in dataset and bool(dataset["status"].dims)


def _answer_rows(results: Sequence["xr.Dataset"]) -> SpreadsheetRows:
    """Return head and rows of the answer of a run: verdict, bearing, quantities, assumptions and notes."""
    of_run = answer(*results)
    rows: list[list[Any]] = []
    bearing, *operation = of_run.case or ("",)
    for label, text, remark in (
        ("verdict", of_run.verdict, of_run.rule),
        ("bearing", bearing, ", ".join(operation)),
    ):
        if text:
            rows.append([label, None, "", None, None, text, remark])
    for row in of_run.rows:
        for part in row.parts or (row,):
            band = part.band or (math.nan, math.nan)
            unit, (value, low, high) = in_shown_unit(part.key, (part.value, *band), part.unit)
            remark = row.note if part.key == row.key else ""
            rows.append([part.label, value, unit, low, high, part.text, remark])
    for label, texts in (("assumed", of_run.assumed), ("fault", of_run.faults)):
        rows += [[label, None, "", None, None, text, ""] for text in texts]
    for note in of_run.notes:
        rows.append([f"note {note.code}", None, "", None, None, note.short, note.consequence])
    return ["quantity", "value", "unit", "low", "high", "in words", "remark"], rows


def point_rows(dataset: "xr.Dataset") -> SpreadsheetRows:
    """Return head and rows of a result of many points, a row for each."""
    dims = dataset["status"].dims
    variables = {str(name): dataset[name] for name in dims if name in dataset.coords}
    variables |= {str(name): variable for name, variable in dataset.data_vars.items()}
    columns = dict[str, Any]()
    for name, variable in variables.items():
        if set(variable.dims) & set(dims):
            columns |= _point_columns(name, variable, dataset.sizes, dims)
    if not math.prod(dataset.sizes[name] for name in dims):
        return list(columns), []
    return list(columns), list(map(list, zip(*columns.values(), strict=True)))


def _point_columns(
    name: str, variable: "xr.DataArray", sizes: Mapping[Any, int], dims: Sequence[Any]
) -> Iterator[tuple[str, list[Any]]]:
    """Yield head and values of the columns of a variable, for all points in order; none for a curve."""
    inner = [dim for dim in variable.dims if dim not in dims]
    if math.prod(variable.sizes[dim] for dim in inner) > _MAX_COLUMNS:
        return
    for indices in itertools.product(*(range(variable.sizes[dim]) for dim in inner)):
        at = dict(zip(inner, indices, strict=True))
        column = variable.isel(at)
        labels = (
            str(variable[dim][k].item() if dim in variable.coords else k + 1)
            for dim, k in at.items()
            if variable.sizes[dim] > 1
        )
        label = " ".join((str(column.attrs.get("key", name)), *labels))
        missing = {dim: sizes[dim] for dim in dims if dim not in column.dims}
        values = column.expand_dims(missing).transpose(*dims).to_numpy().ravel()
        if values.dtype.kind != "f":
            yield label, values.tolist()
            continue
        unit, shown = in_shown_unit(
            label.rpartition(".")[2],
            values.tolist(),
            str(column.attrs.get("units", "1")),
            str(column.attrs.get("given", "")),
        )
        yield f"{label} [{unit}]" if unit else label, shown


def _csv(path: Path, head: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
    """Write a table as CSV."""
    with path.open("w", newline="", encoding="utf-8") as file:
        table = ([*map(_cell, row)] for row in (head, *rows))
        csv.writer(file, lineterminator="\n").writerows(table)


def _cell(value: Any) -> Any:
    """Return the value of a cell; a text that a spreadsheet would run as a formula gets an apostrophe before it."""
    if not isinstance(value, str):
        return value
    is_formula = value.startswith(("=", "+", "-", "@", "\t", "\r")) and not NUMBER.match(value)
    return "'" * is_formula + readable(value)


def _xlsx(path: Path, head: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
    """Write a table as an Excel workbook with a bold head that stays visible."""
    try:
        from openpyxl import Workbook
        from openpyxl.styles import Font
    except ImportError:
        raise OutputError(
            "xlsx: needs openpyxl; pip install 'rollslip[xlsx]', or take csv"
        ) from None
    book = Workbook()
    sheet = book.active
    for row in (head, *rows):
        sheet.append([*map(_cell, row)])
    for cell in sheet[1]:
        cell.font = Font(bold=True)
    sheet.freeze_panes = "A2"
    book.save(path)


#: Suffix of a file -> function that writes it.
FORMATS: Final[Mapping[str, Callable[[Path, Sequence[str], Iterable[Sequence[Any]]], None]]] = (
    MappingProxyType({"csv": _csv, "xlsx": _xlsx})
)
