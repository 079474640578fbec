"""Tables of results for a spreadsheet: one row a quantity or a point, in people's units, which stand in the head.

A run gives the rows of its answer; what was computed at many points gives a row a point: what varies first, then what
came out, a column for each of its values, and in words what has none. A number that is not known is an empty cell.
"""

import csv
import itertools
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rollslip.errors import OutputError
from rollslip.files import whole_file
from rollslip.results.account import Sheet
from rollslip.results.accounts import account_of, answer
from rollslip.results.text import in_percent
from rollslip.units import converted, expect_results, shown_unit

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

__all__ = ["FORMATS", "in_people_s_unit", "of_points", "save_tables", "sheet", "table"]

#: Values of one variable at a point that have a column each, at most; more are curves, which stay in the .nc file.
_COLUMNS: Final = 12


def table(*results: "xr.Dataset") -> "pd.DataFrame":
    """Return results as a table, in people's units: of a run the rows of its answer, of many points a row each.

    Parameters
    ----------
    *results : xarray.Dataset
        Result of a campaign, or those of one run.

    Returns
    -------
    pandas.DataFrame
        What ``--format csv`` writes; units stand in the heads of columns, or in one of their own.

    Examples
    --------
    >>> import rollslip
    >>> rollslip.table(rollslip.run("gearbox", "steady-slip")).loc[0, ["quantity", "in words"]].to_list()
    ['cage slip', '1.5 %']
    """
    import pandas as pd  # which xarray brings

    expect_results("table", *results)
    head, rows = sheet(*results)
    return pd.DataFrame(rows, columns=head)


def sheet(*results: "xr.Dataset") -> Sheet:
    """Return head and rows of results, as `table` has them."""
    for own in account_of(results[0]).sheets(results[0]).values():
        return own
    return of_points(results[0]) if _has_points(results[0]) else _of_answer(results)


def save_tables(
    results: Mapping[str, "xr.Dataset"], folder: Path, formats: Iterable[str]
) -> list[Path]:
    """Write tables into a folder and return the files: ``answer`` of a run, and NAME of what has many points."""
    found = {
        f"{name}{more}": of
        for name, one in results.items()
        for more, of in account_of(one).sheets(one).items()
    }
    found |= {
        name: of_points(one)
        for name, one in results.items()
        if _has_points(one) and name not in found
    }
    written = []
    for name, of in (found or {"answer": sheet(*results.values())}).items():
        for ending in formats:
            path = folder / f"{name}.{ending}"
            with whole_file(path) as partial:
                FORMATS[ending](partial, *of)
            written.append(path)
    return written


def in_people_s_unit(
    name: str, values: Iterable[float], unit: str, given: str = ""
) -> tuple[str, list[float | None]]:
    """Return the unit in which people read the largest of some values, percent of shares, and them in it, or None.

    That in which they were given comes first.
    """
    values = list(values)
    shown = "%" if in_percent(name, unit) else given if given != "1" else ""
    if unit != "1" and not shown:
        shown = shown_unit(
            float(np.max(np.abs([x for x in values if math.isfinite(x)]), initial=0.0)), unit
        )
    return shown, [
        float(f"{converted(x, unit, shown):.12g}") if math.isfinite(x) else None for x in values
    ]


def _has_points(dataset: "xr.Dataset") -> bool:
    return "status" in dataset and bool(dataset["status"].dims)


def _of_answer(results: Sequence["xr.Dataset"]) -> Sheet:
    rows = []
    for row in answer(*results).rows:
        ends = row.band or (math.nan, math.nan)
        unit, (value, low, high) = in_people_s_unit(row.key, (row.value, *ends), row.unit)
        rows.append([row.label, value, unit, low, high, row.text, row.note])
    return ["quantity", "value", "unit", "low", "high", "in words", "remark"], rows


def of_points(dataset: "xr.Dataset") -> Sheet:
    """Return head and rows of what has many points: a row each."""
    over = dataset["status"].dims
    shape = tuple(dataset.sizes[name] for name in over)
    columns = dict[str, Any]()
    for name, of in (
        *((name, dataset[name]) for name in over if name in dataset.coords),
        *dataset.data_vars.items(),
    ):
        inner = [dim for dim in of.dims if dim not in over]
        if not set(of.dims) & set(over) or math.prod(of.sizes[dim] for dim in inner) > _COLUMNS:
            continue
        for place in itertools.product(*(range(of.sizes[dim]) for dim in inner)):
            one = of.isel(dict(zip(inner, place, strict=True)))
            labels = [str(of[dim][k].item() if dim in of.coords else k + 1) for dim, k in zip(inner, place, strict=True)
                      if of.sizes[dim] > 1]  # fmt: skip
            missing = [dim for dim in over if dim not in one.dims]
            whole = (
                one.expand_dims({dim: dataset.sizes[dim] for dim in missing})
                .transpose(*over)
                .to_numpy()
            )
            label = " ".join((str(one.attrs.get("key", name)), *labels))
            if whole.dtype.kind == "f":
                si = str(one.attrs.get("units", "1"))
                given = str(one.attrs.get("given", ""))
                unit, values = in_people_s_unit(
                    label.rpartition(".")[2], whole.ravel().tolist(), si, given
                )
                columns[f"{label} [{unit}]" if unit else label] = values
            else:
                columns[label] = whole.ravel().tolist()
    return list(columns), [list(row) for row in zip(*columns.values(), strict=True)] if math.prod(
        shape
    ) else []


def _csv(path: Path, head: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([head, *rows])


def _xlsx(path: Path, head: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
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
        sheet.append(list(row))
    for cell in sheet[1]:
        cell.font = Font(bold=True)
    sheet.freeze_panes = "A2"
    book.save(path)


#: Ending -> what writes it.
FORMATS: Final[Mapping[str, Callable[[Path, Sequence[str], Iterable[Sequence[Any]]], None]]] = (
    MappingProxyType({"csv": _csv, "xlsx": _xlsx})
)
