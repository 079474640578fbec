"""Read tables whose columns are keys of a scene, with all faults of a table in one error.

- A table is CSV, xlsx, a pandas.DataFrame, an xarray.Dataset, or the load cases of another program's file
  (`SceneFormat.load_cases`).
- The first row has the key of each column, or its last part where that is unique, with the unit of the values below.
- Further columns, such as a measured value, are named by the caller, with their units.
- A cell is a number alone, or a name. Nothing is repaired and nothing is left out.
"""

import csv
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final
from zipfile import BadZipFile

import attrs

from rollslip.errors import RollslipError, SceneError, nearest
from rollslip.fields import FieldError
from rollslip.files import content_named, faults_of, readable, text_named
from rollslip.scene.changes import Quantity, describe_unknown_key, full_key
from rollslip.scene.formats import format_of
from rollslip.structure import raise_problem_if
from rollslip.units import NUMBER, UnitError, as_written
from rollslip.units import quantity as in_unit

__all__ = ["Column", "FurtherColumn", "KeyTable", "read_table"]

#: Similarity from which an unknown heading is taken for a misspelt further column, and not for a key. Chosen: one wrong
#: letter of ten.
_NEAR: Final = 0.85


@attrs.frozen
class FurtherColumn:
    """A column that is not a key of the scene.

    Attributes
    ----------
    unit : str
        SI unit of its values.
    minimum : float
        Smallest value, in this unit.
    """

    unit: str
    minimum: float = -math.inf


@attrs.frozen
class Column:
    """A column of a table.

    Attributes
    ----------
    key : str
        Key of the scene, or name of a further column.
    unit : str
        Unit of its values, as the table has it; empty for names and whole numbers.
    quantity : Quantity or None
        The quantity of the scene; None for a further column.
    further : FurtherColumn or None
        The further column; None for a quantity of the scene.
    """

    key: str
    unit: str
    quantity: Quantity | None
    further: FurtherColumn | None = None

    @property
    def is_number(self) -> bool:
        """Whether it has numbers with a unit of the scene."""
        return self.quantity is not None and self.quantity.unit is not None

    def read(self, cell: str, place: str, problems: list[str]) -> object:
        """Return the value of a cell as the scene takes it, or None after collecting its fault.

        Parameters
        ----------
        cell : str
            The text of the cell.
        place : str
            File and line, for the message.
        problems : list of str
            Messages on faults, to which that of this cell is added.
        """
        try:
            return self._value(cell)
        except FieldError as error:
            reason = error.reason
        except SceneError as error:
            reason = "; ".join(error.problems)
        except (RollslipError, ValueError, TypeError) as error:
            reason = str(error)
        problems.append(f"{place}: {self.key}: {reason}")
        return None

    def _value(self, cell: str) -> object:
        """Return the value of a cell as the scene takes it."""
        if self.quantity is not None and not (self.is_number or self.quantity.whole):
            return self.quantity.read(cell)
        raise_problem_if(not cell, "is empty")
        raise_problem_if(
            not NUMBER.fullmatch(cell),
            f"{as_written(cell)} is not a number alone; its unit stands in the head",
        )
        written = f"{cell} {self.unit}" if self.unit else float(cell)
        if self.quantity is not None:
            return self.quantity.read(written)
        assert self.further is not None
        value = in_unit(written, self.further.unit)
        below = f"below {self.further.minimum:g}" if self.further.minimum else "below zero"
        raise_problem_if(value < self.further.minimum, f"{as_written(cell)} is {below}")
        return value


@attrs.frozen
class KeyTable:
    """A table whose columns are keys of a scene.

    Attributes
    ----------
    source : str
        Name of the table for messages.
    columns : tuple of Column
        Its columns.
    places : tuple of str
        Place of each row for messages: file and line.
    values : mapping of str to list
        Values of each column as the scene takes them, by its key.
    """

    source: str
    columns: tuple[Column, ...]
    places: tuple[str, ...]
    values: Mapping[str, list[Any]]


def read_table(
    given: object, known: Mapping[str, Quantity], further: Mapping[str, FurtherColumn]
) -> KeyTable:
    """Return a table; all its faults are raised in one error.

    Parameters
    ----------
    given : path or pandas.DataFrame or xarray.Dataset
        A file .csv or .xlsx, one of another program with load cases, a frame, or a data set.
    known : mapping of str to Quantity
        Quantities of the scene by key.
    further : mapping of str to FurtherColumn
        Columns that are not keys of the scene, by name.
    """
    source, rows = _rows_of(given)
    raise_problem_if(len(rows) < 2, f"{source}: a head and a row below it are expected")
    (head_place, head), *body = rows
    problems = list[str]()
    columns = [_parse_head(cell, known, further, head_place, problems) for cell in head]
    keys = [column.key for column in columns if column is not None]
    twice = [key for key in dict.fromkeys(keys) if keys.count(key) > 1]
    problems += [f"{head_place}: {key} stands there twice" for key in twice]
    values = _read_values(columns, body, problems)
    if problems:
        raise faults_of(source, problems)
    return KeyTable(
        source,
        tuple(column for column in columns if column is not None),
        tuple(place for place, _ in body),
        values,
    )


def _read_values(
    columns: Sequence[Column | None], body: Sequence[tuple[str, list[str]]], problems: list[str]
) -> dict[str, list[Any]]:
    """Return the values of each column by its key, after collecting the faults of cells and rows."""
    values = {column.key: list[Any]() for column in columns if column is not None}
    for place, cells in body:
        if len(cells) != len(columns):
            problems.append(f"{place}: {len(cells)} values under {len(columns)} columns")
            continue
        for column, cell in zip(columns, cells, strict=True):
            if column is not None:
                values[column.key].append(column.read(cell, place, problems))
    return values


def _parse_head(
    cell: str,
    known: Mapping[str, Quantity],
    further: Mapping[str, FurtherColumn],
    place: str,
    problems: list[str],
) -> Column | None:
    """Return the column under a cell of the head, or None after collecting its fault."""
    name, bracket, rest = (part.strip() for part in cell.partition("["))
    unit = rest.removesuffix("]").strip() if bracket else ""
    own = further.get(name)
    if own is None and name not in known:
        own = further.get(underscored := name.replace(" ", "_"))  # as answers print it
        name = underscored if own is not None else name
    if own is not None:
        column = Column(name, unit, None, own)
    else:
        matches = [key for key in known if key.endswith(f".{name}")]
        key = matches[0] if len(matches) == 1 else full_key(name)
        if key not in known:
            near = nearest(name, further, count=1, cutoff=_NEAR)
            near = near or sorted(
                (other for other in further if other.endswith(f"_{name}")), key=len
            )
            reason = f"did you mean {near[0]!r}?" if near else ""
            reason = reason or describe_unknown_key(key, dict(known))
            problems.append(f"{place}: {as_written(name)}: is not a known column; {reason}")
            return None
        column = Column(key, unit, known[key])
    if fault := _fault_of_unit(name, column):
        problems.append(f"{place}: {column.key}: {fault}")
        return None
    return column


def _fault_of_unit(name: str, column: Column) -> str:
    """Return the fault of the unit of a column with a name in the head; empty if there is none."""
    si = column.further.unit if column.further is not None else None
    if column.quantity is not None:
        si = column.quantity.unit
    if si is None:
        return f"has no unit, [{column.unit}] is wrong here" if column.unit else ""
    if not column.unit:
        return "" if si == "1" else f"the unit is missing; write {as_written(f'{name} [{si}]')}"
    try:
        in_unit(f"1 {column.unit}", si)
    except UnitError as error:
        return str(error)
    return ""


def _rows_of(given: object) -> tuple[str, list[tuple[str, list[str]]]]:
    """Return the name of a table, and place and cells of its rows; the first one is its head."""
    if not isinstance(given, str | Path):
        return _rows_of_frame(given)
    path = Path(given)
    if path.suffix.lower() == ".xlsx":
        return readable(str(path)), _rows_of_workbook(path)
    if path.suffix.lower() != ".csv" and (file_format := format_of(path)) is not None:
        source, content = content_named(path)
        rows = [*file_format.load_cases(content, source)]
        raise_problem_if(
            not rows, f"{source}: has no table of load cases; give one as a file .csv or .xlsx"
        )
        return source, rows
    source, text = text_named(path)
    lines = [
        (f"{source}:{number}", [cell.strip() for cell in next(csv.reader([line]))])
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    return source, lines


def _rows_of_frame(given: Any) -> tuple[str, list[tuple[str, list[str]]]]:
    """Return the rows of a pandas.DataFrame, or of an xarray.Dataset, whose units are those of its variables."""
    units = dict[Any, str]()
    try:
        if hasattr(given, "to_dataframe"):
            units = {
                name: values.attrs.get("units", "") for name, values in given.variables.items()
            }
            given = given.to_dataframe().reset_index()[[*units]]
        head = [
            f"{name} [{units[name]}]" if units.get(name) else str(name) for name in given.columns
        ]
        rows = given.to_numpy().tolist()
    except AttributeError:
        raise SceneError(
            [
                "table: a file .csv or .xlsx, a pandas.DataFrame or an xarray.Dataset is expected, not "
                f"{as_written(given)}"
            ]
        ) from None
    lines = [(f"table: row {k}", [str(cell) for cell in row]) for k, row in enumerate(rows, 1)]
    return "table", [("table: head", head), *lines]


def _rows_of_workbook(path: Path) -> list[tuple[str, list[str]]]:
    """Return the rows of the first sheet of an Excel workbook."""
    try:
        from openpyxl import load_workbook
        from openpyxl.utils.exceptions import InvalidFileException
    except ImportError:
        raise SceneError(
            [f"{readable(str(path))}: needs openpyxl; pip install 'rollslip[xlsx]', or write csv"]
        ) from None
    try:
        sheet = load_workbook(path, read_only=True, data_only=True).worksheets[0]
    except (OSError, ValueError, KeyError, BadZipFile, InvalidFileException) as error:
        raise SceneError([f"{readable(str(path))}: cannot be read: {error}"]) from error
    return [
        (f"{readable(path.name)}: row {number}", ["" if c is None else str(c).strip() for c in row])
        for number, row in enumerate(sheet.iter_rows(values_only=True), 1)
        if any(cell is not None for cell in row)
    ]
