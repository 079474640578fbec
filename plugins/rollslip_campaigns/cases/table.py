"""Read a table of load cases from CSV, xlsx or pandas, with all its faults in one error."""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar, Final
from zipfile import BadZipFile

import attrs
import numpy as np

from rollslip.errors import RollslipError, SceneError
from rollslip.fields import FieldError
from rollslip.files import readable
from rollslip.scene.changes import Quantity, describe_unknown_key, full_key
from rollslip.search import Array
from rollslip.structure import raise_problem_if
from rollslip.units import NUMBER, UnitError, as_written
from rollslip.units import quantity as in_unit
from rollslip_campaigns.measurement.rig import faults_of, text_named
from rollslip_campaigns.sweep.sampling import Axis, Design

__all__ = ["CaseDesign", "CaseTable", "read_cases"]

#: Names of the column with the part of the time that a case takes -> its SI unit.
_TIMES: Final[Mapping[str, str]] = {"share": "1", "time": "s"}


@attrs.frozen(eq=False)
class CaseDesign(Design):
    """The rows of a table: its numbers are the samples of a design without axes, and names stand beside them.

    Attributes
    ----------
    named : tuple of Axis
        Columns of names and whole numbers, with a value for each row.
    """

    named: tuple[Axis, ...] = ()
    samples_name: ClassVar[str] = "cases"

    @property
    def has_samples(self) -> bool:
        """Whether the design has a dimension of samples, here of rows."""
        return True

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys of the numbers, then those of the names."""
        return (*super().keys, *(axis.key for axis in self.named))

    @property
    def checked_axes(self) -> tuple[Axis, ...]:
        """The columns of names, with each of their values once."""
        return tuple(
            attrs.evolve(
                axis,
                values=tuple({repr(value): value for value in axis.values}.values()),
                listed=(),
            )
            for axis in self.named
        )

    def changes(self, number: int) -> dict[str, object]:
        """Return the values that the row of a number changes in the scene, by key."""
        names = {axis.key: axis.values[number] for axis in self.named}
        return super().changes(number) | names

    @property
    def further_facts(self) -> dict[str, Any]:
        """The columns of names, as plain values of JSON."""
        return {"named": {axis.key: list(axis.values) for axis in self.named}}


@attrs.frozen(eq=False)
class CaseTable:
    """A table of load cases, with values as the scene takes them.

    Attributes
    ----------
    source : str
        Name of the table for messages.
    design : CaseDesign
        The cases.
    fractions : ndarray
        Part of the time that each case takes, shape (n,); the sum is 1.
    """

    source: str
    design: CaseDesign
    fractions: Array


def read_cases(given: object, known: Mapping[str, Quantity]) -> CaseTable:
    """Return the load cases of a table; all faults of the table are raised in one error.

    Parameters
    ----------
    given : path or pandas.DataFrame
        The table.
    known : mapping of str to Quantity
        Quantities of the scene by key.
    """
    source, rows = _rows_of(given)
    raise_problem_if(len(rows) < 2, f"{source}: a head and a row below it are expected")
    (head_place, head), *cases = rows
    problems = list[str]()
    columns = [_parse_head(cell, known, head_place, problems) for cell in head]
    problems += _head_faults([column.key for column in columns if column is not None], head_place)
    values = _read_values(columns, cases, problems)
    if problems:
        raise faults_of(source, problems)
    numbers = [column for column in columns if column and column.is_number]
    names = [column for column in columns if column and not (column.is_number or column.is_time)]
    samples = np.array([values[column.key] for column in numbers], dtype=float)
    return CaseTable(
        source,
        CaseDesign(
            (),
            tuple(column.quantity for column in numbers),
            samples.T.reshape(len(cases), len(numbers)),
            tuple(Axis(column.quantity, tuple(values[column.key])) for column in names),
        ),
        _fractions(values, len(cases), source),
    )


def _head_faults(keys: Sequence[str], place: str) -> list[str]:
    """Return the faults of the keys of a head: those that stand there twice, and if there is none of the scene."""
    twice = [key for key in dict.fromkeys(keys) if keys.count(key) > 1]
    faults = [f"{place}: {key} stands there twice" for key in twice]
    if not set(keys) - set(_TIMES):
        faults.append(f"{place}: no column has a key of the scene")
    return faults


def _read_values(
    columns: Sequence["_Column | None"],
    cases: Sequence[tuple[str, list[str]]],
    problems: list[str],
) -> dict[str, list[Any]]:
    """Return the values of each column by its key, after collecting the faults of cells and rows."""
    values = {column.key: list[Any]() for column in columns if column is not None}
    for place, cells in cases:
        if len(cells) != len(columns):
            problems.append(f"{place}: {len(cells)} values under {len(columns)} columns")
            continue
        for column, cell in zip(columns, cells, strict=True):
            if column is not None:
                values[column.key].append(column.read(cell, place, problems))
    return values


@attrs.frozen
class _Column:
    """A column of a table: its key and the unit of its values, and the quantity of the scene."""

    key: str
    unit: str
    #: The quantity of the scene; None for the part of the time.
    quantity: Any

    @property
    def is_time(self) -> bool:
        """Whether it has the part of the time that a case takes."""
        return self.quantity is None

    @property
    def is_number(self) -> bool:
        """Whether it has numbers of the scene."""
        return not self.is_time and self.quantity.unit is not None

    def read(self, cell: str, place: str, problems: list[str]) -> object:
        """Return the value of a cell as the scene takes it, or None after collecting its fault."""
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
        if not (self.is_time or self.is_number or self.quantity.whole):
            return self.quantity.read(cell)
        raise_problem_if(not cell, "is empty")
        raise_problem_if(
            not NUMBER.fullmatch(cell),
            f"{as_written(cell)} is not a number alone; its unit stands in the head",
        )
        written = f"{cell} {self.unit}" if self.unit else float(cell)
        if not self.is_time:
            return self.quantity.read(written)
        value = in_unit(written, _TIMES[self.key])
        raise_problem_if(value < 0.0, f"{as_written(cell)} is below zero")
        return value


def _parse_head(
    cell: str, known: Mapping[str, Quantity], place: str, problems: list[str]
) -> _Column | None:
    """Return the column under a cell of the head, or None after collecting its fault."""
    name, bracket, rest = (part.strip() for part in cell.partition("["))
    unit = rest.removesuffix("]").strip() if bracket else ""
    key = name
    quantity = None
    si: str | None = _TIMES.get(name)
    if name not in _TIMES:
        matches = [key for key in known if key.endswith(f".{name}")]
        key = matches[0] if len(matches) == 1 else full_key(name)
        if key not in known:
            problems.append(f"{place}: {describe_unknown_key(key, dict(known))}")
            return None
        quantity = known[key]
        si = quantity.unit
    if si is None and unit:
        problems.append(f"{place}: {key}: has no unit, [{unit}] is wrong here")
        return None
    if si not in (None, "1") and not unit:
        problems.append(
            f"{place}: {key}: the unit is missing; write {as_written(f'{name} [{si}]')}"
        )
        return None
    try:
        if unit:
            in_unit(f"1 {unit}", si or "1")
    except UnitError as error:
        problems.append(f"{place}: {key}: {error}")
        return None
    return _Column(key, unit, quantity)


def _fractions(values: Mapping[str, Sequence[float]], count: int, source: str) -> Array:
    """Return the part of the time that each case takes; equal parts without a column of times."""
    columns = [values[name] for name in _TIMES if name in values]
    raise_problem_if(len(columns) > 1, f"{source}: give share or time, and not both")
    times = np.array(columns[0]) if columns else np.ones(count)
    raise_problem_if(not times.sum() > 0.0, f"{source}: the shares of all cases are zero")
    return np.asarray(times / times.sum(), dtype=float)


def _rows_of(given: object) -> tuple[str, list[tuple[str, list[str]]]]:
    """Return the name of a table, and place and cells of its rows; the first one is its head."""
    if not isinstance(given, str | Path):
        return _rows_of_frame(given)
    path = Path(given)
    if path.suffix.lower() == ".xlsx":
        return readable(str(path)), _rows_of_workbook(path)
    source, text = text_named(path)
    lines = [
        (f"{source}:{number}", [cell.strip() for cell in next(csv.reader([line]))])
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    return source, lines


def _rows_of_frame(given: Any) -> tuple[str, list[tuple[str, list[str]]]]:
    """Return the rows of a pandas.DataFrame."""
    try:
        head = [str(name) for name in given.columns]
        rows = given.to_numpy().tolist()
    except AttributeError:
        raise SceneError(
            [
                f"table: a file .csv or .xlsx or a pandas.DataFrame is expected, not {as_written(given)}"
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
