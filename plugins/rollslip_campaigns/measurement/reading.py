"""Read data sets from their folders, with all faults of their files in one error.

- A folder has ``measurement.toml``, and beside it the scenes, rigs and tables of numbers that it names.
- A cell of a header is a key of the scene with the unit of the values below, ``operation.radial_load [N]``; a name,
  such as that of a model, has no unit. The scene defines what a key accepts: each row is read as a change of the scene.
- Nothing is repaired and nothing is left out. A value without an uncertainty is not a measurement.
"""

import csv
import os
import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, Final

import attrs

from rollslip.errors import SceneError, did_you_mean, nearest
from rollslip.files import faults_of, readable, text_named
from rollslip.references import Reference
from rollslip.scene.changes import evolve, parse_set
from rollslip.scene.reading import load_scene
from rollslip.scene.values import Scene
from rollslip.structure import FrozenTable, Location, raise_problem_if, structure
from rollslip.toml import as_table, parse
from rollslip.units import NUMBER, UnitError, as_written, check_unit, quantity
from rollslip_campaigns.measurement.rig import (
    FilmRow,
    ResistanceRow,
    Rig,
    RigData,
    TractionRow,
    load_rig,
    read_data,
)
from rollslip_campaigns.measurement.values import (
    FORM,
    QUANTITIES,
    ContactSeries,
    Measurement,
    MeasurementTable,
    Row,
    Series,
    SeriesTable,
    SourceTable,
    Statement,
    StatementTable,
    Step,
)

__all__ = ["FILE", "load_measurement", "load_measurements"]

#: Name of the file of a data set in its folder.
FILE: Final = "measurement.toml"
#: Column of the measured value.
MEASURED = "measured"
#: Column of its standard uncertainty.
UNCERTAINTY = "uncertainty"
#: Rows of a quantity of a contact, where they are not those of traction.
_CONTACT_ROWS: Final[Mapping[str, type]] = {
    "film-thickness": FilmRow,
    "contact-resistance": ResistanceRow,
}
#: A variable of a study: STUDY/VARIABLE.
_STUDY_VARIABLE: Final = re.compile(r"[\w-]+/\w+", re.ASCII)
#: How the values of a form are read, which has none yet.
_TO_READ: Final = "to be digitised"
#: Licence under which the numbers may not be passed on.
_CLOSED: Final = "not redistributable"
#: Words that a citation has at least, such as author, title and year. Chosen; it refuses bare keys and links.
_MIN_CITATION_LENGTH = 3


def load_measurements(folder: str | os.PathLike[str]) -> list[Measurement]:
    """Return the data sets in the subfolders of a folder, in the order of their names."""
    if not (folders := sorted(path.parent for path in Path(folder).glob(f"*/{FILE}"))):
        raise SceneError([f"{readable(os.fspath(folder))}: no folder in it has a file {FILE}"])
    return list(map(load_measurement, folders))


def load_measurement(folder: str | os.PathLike[str]) -> Measurement:
    """Return the data set in a folder; all faults of its files are raised in one error."""
    base = Path(folder)
    source, text = text_named(base / FILE)
    raw, origins = parse(text, source)
    problems: list[str] = []
    where = Location(origins)
    if (table := structure(MeasurementTable, raw, where, problems)) is None:
        raise SceneError(problems)
    measurement = _Reader(base, table, where, problems).measurement()
    if problems:
        raise faults_of(source, problems)
    return measurement


@attrs.define
class _Reader:
    """Reads the files that the table of a data set names, and collects faults."""

    folder: Path
    table: MeasurementTable
    where: Location
    problems: list[str]
    _scenes: dict[str, Scene | None] = attrs.field(factory=dict)

    def measurement(self) -> Measurement:
        """Return the data set, without series and statements that cannot be read."""
        table = self.table
        series = [
            self._series(each, self.where.at("series").at(k)) for k, each in enumerate(table.series)
        ]
        statements = [
            self._statement(each, self.where.at("statements").at(k))
            for k, each in enumerate(table.statements)
        ]
        self._check_names()
        references = self._references(table.source)
        # what could not be read may have values
        self._check_source(
            table.source, any(each is None or each.rows for each in series) or bool(statements)
        )
        self._check_estimates()
        measurement = Measurement(
            name=table.name,
            description=table.description,
            references=references,
            read=table.source.read,
            by=table.source.by,
            licence=table.source.licence,
            recipe=table.source.recipe,
            measured=table.source.read != "computed"
            if table.source.measured is None
            else table.source.measured,
            estimated=FrozenTable(dict(table.estimated)),
            series=tuple(each for each in series if each is not None),
            statements=tuple(each for each in statements if each is not None),
            folder=str(self.folder),
        )
        if measurement.is_form:
            return attrs.evolve(measurement, description=f"{FORM}: {measurement.description}")
        return measurement

    # Names and sources -----------------------------------------------------------------------------------------------

    def _check_names(self) -> None:
        """Collect faults of the names of the data set and of its series."""
        if not re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", self.table.name, re.ASCII):
            self._add_problem(
                "name",
                f"{as_written(self.table.name)} is not made of small letters, digits and hyphens",
            )
        if not self.table.series and not self.table.statements:
            self._add_problem(
                "series",
                "missing: a data set has [[series]] of numbers, or [[statements]], or both",
            )
        names = [series.name for series in self.table.series]
        for name in {name for name in names if names.count(name) > 1}:
            self._add_problem(
                "series", f"two are called {as_written(name)}; give each its own name"
            )

    def _add_problem(self, key: str, reason: str) -> None:
        """Collect a fault of a key of the data set."""
        self.problems.append(self.where.at(key).message(reason))

    def _references(self, source: SourceTable) -> tuple[Any, ...]:
        """Return the citations of the data set."""
        references: list[Reference | str] = []
        where = self.where.at("source").at("references")
        for k, citation in enumerate(source.references):
            if isinstance(citation, Mapping):
                try:
                    fields: dict[str, Any] = dict(citation)
                    references.append(Reference(**fields))
                except (TypeError, ValueError) as error:
                    self.problems.append(where.at(k).message(str(error)))
            elif isinstance(citation, str) and len(citation.split()) >= _MIN_CITATION_LENGTH:
                references.append(citation)
            else:
                self.problems.append(
                    where.at(k).message("a citation is expected: who, what, where and when")
                )
        if not source.references:
            self.problems.append(
                where.message(
                    "missing, but required: a citation of what the values stand in, or of the rig's own record"
                )
            )
        return tuple(references)

    def _check_source(self, source: SourceTable, has_values: bool) -> None:
        """Collect faults of licence, reading and recipe."""
        where = self.where.at("source")
        digitised = source.read == "digitised"
        closed = source.licence == _CLOSED
        faults = [
            (
                not source.licence.strip(),
                where.at("licence"),
                "is empty; name the licence under which the values stand",
            ),
            (
                digitised and not source.by.strip(),
                where.at("by"),
                "missing: digitised values name who read them off",
            ),
            *(
                (
                    True,
                    self.where.at("series").at(k).at("reading_error"),
                    "missing: digitised values have an error of reading, such as '2 %'",
                )
                for k, series in enumerate(self.table.series)
                if digitised and series.reading_error is None
            ),
            (
                source.read == _TO_READ and has_values,
                where.at("read"),
                "'to be digitised' has no values yet; say 'digitised', and by whom",
            ),
            (
                (closed or not has_values) and not source.recipe.strip(),
                where.at("recipe"),
                "missing: values that are not here need a recipe of how to get them",
            ),
            (
                closed and has_values,
                where.at("licence"),
                f"{_CLOSED!r}, but the values stand here; leave them out and give the recipe",
            ),
        ]
        self.problems += [place.message(reason) for is_fault, place, reason in faults if is_fault]

    def _check_estimates(self) -> None:
        """Collect estimated keys that no scene states, and estimated numbers without a distribution."""
        scenes = [scene for scene in self._scenes.values() if scene is not None]
        for key in self.table.estimated:
            path = key.split(".")
            values = [_nested_value(scene.raw or {}, path) for scene in scenes]
            if scenes and all(value is None for value in values):
                reason = "no scene of the data set states this key"
                self.problems.append(self.where.at("estimated").at(key).message(reason))
            for scene, value in zip(scenes, values, strict=True):
                if _is_number(value) and _nested_value(scene.uncertainty or {}, path) is None:
                    self.problems.append(
                        f"{readable(scene.source)}: uncertainty.{key}: missing: {as_written(value)} is estimated, so "
                        "it needs a distribution, such as { distribution = 'uniform', scatter = 0.25 }"
                    )

    # Scenes and quantities --------------------------------------------------------------------------------------------

    def _scene(self, name: str, where: Location) -> Scene | None:
        """Return the scene in a file, or None after collecting its faults."""
        if name not in self._scenes:
            self._scenes[name] = self._try(lambda: load_scene(self._file(name, where)))
        return self._scenes[name]

    def _file(self, name: str, where: Location) -> Path:
        """Return the path of a file in the folder of the data set."""
        path = self.folder / name
        raise_problem_if(
            Path(name).name != name or not path.is_file(),
            where.message(f"{as_written(name)} is not a file in {readable(str(self.folder))}"),
        )
        return path

    def _try(self, read: "Callable[[], Any]") -> Any:
        """Return what a function reads, or None after collecting the faults that it raises."""
        try:
            return read()
        except SceneError as error:
            self.problems += error.problems
            return None

    def _unit(self, table: SeriesTable | StatementTable, where: Location) -> str | None:
        """Return the SI unit of the quantity, or None after collecting a fault."""
        if table.quantity in QUANTITIES:
            return QUANTITIES[table.quantity].unit
        if not _STUDY_VARIABLE.fullmatch(table.quantity):
            self._add_unknown(table.quantity, where)
        elif not table.unit:
            self.problems.append(
                where.at("unit").message(
                    "missing: the variable of a study needs its SI unit, '1' for none"
                )
            )
        else:
            try:
                return check_unit(table.unit)
            except UnitError as error:
                self.problems.append(where.at("unit").message(str(error)))
        return None

    def _add_unknown(self, name: str, where: Location) -> None:
        """Collect the fault of a quantity that is not known."""
        near = nearest(name, QUANTITIES, count=1)
        hint = did_you_mean(near, f"there are: {', '.join(QUANTITIES)}; and STUDY/VARIABLE")
        self.problems.append(
            where.at("quantity").message(f"{as_written(name)} is not a known quantity; {hint}")
        )

    # Series -----------------------------------------------------------------------------------------------------------

    def _series(self, table: SeriesTable, where: Location) -> Series | None:
        """Return a series, or None after collecting faults that prevent it."""
        if (unit := self._unit(table, where)) is None:
            return None
        if not table.uncertainty.strip():
            self.problems.append(
                where.at("uncertainty").message(
                    "is empty; say what the column of uncertainty rests on"
                )
            )
        of_contact = table.quantity in QUANTITIES and QUANTITIES[table.quantity].of == "contact"
        required, other = ("rig", "scene") if of_contact else ("scene", "rig")
        if not getattr(table, required):
            self.problems.append(
                where.at(required).message(
                    f"missing: a {table.quantity} is measured on a {required}"
                )
            )
            return None
        if getattr(table, other):
            self.problems.append(
                where.at(other).message(
                    f"a {table.quantity} is measured on a {required}; leave this out"
                )
            )
        common: dict[str, Any] = {
            "name": table.name,
            "quantity": table.quantity,
            "unit": unit,
            "at": table.at,
            "about_uncertainty": table.uncertainty,
        }
        if of_contact:
            return self._contact_series(table, where, common)
        scene = self._scene(table.scene, where.at("scene"))
        if scene is not None and table.changes:
            unchanged = scene
            scene = self._try(lambda: evolve(unchanged, table.changes, si=True))
        rows = self._rows(table, unit, scene, where)
        return None if scene is None else Series(scene=scene, rows=tuple(rows), **common)

    def _contact_series(
        self, table: SeriesTable, where: Location, common: Mapping[str, Any]
    ) -> Series | None:
        """Return a series of a rig, or None after collecting faults that prevent it."""
        column = table.quantity.replace("-", "_")
        rig: Rig | None = self._try(lambda: load_rig(self._file(table.rig, where.at("rig"))))
        if rig is not None and self.table.source.read == _TO_READ:  # a form has no values yet
            self._try(lambda: self._file(table.data, where.at("data")))
            return Series(rows=(), **common)
        row = _CONTACT_ROWS.get(table.quantity, TractionRow)
        data: RigData | None = self._try(
            lambda: read_data(self._file(table.data, where.at("data")), row)
        )
        if rig is None or data is None:
            return None
        if f"{column}_uncertainty" not in data.columns:
            self.problems.append(
                f"{data.source}: {column}_uncertainty: missing, but required of a data set"
            )
            return None
        conditions = [name for name in data.columns if not name.startswith(column)]
        rows = list[Row]()
        line_of = dict[FrozenTable, int]()
        for k, line in enumerate(data.lines):
            changes = FrozenTable({name: float(data.columns[name][k]) for name in conditions})
            if changes in line_of:
                self.problems.append(
                    f"{data.source}:{line}: the conditions of line {line_of[changes]} once more"
                )
            line_of[changes] = line
            measured, sigma = (
                float(data.columns[name][k]) for name in (column, f"{column}_uncertainty")
            )
            sigma = _add_reading_error(table, measured, sigma)
            rows.append(Row(changes=changes, measured=measured, uncertainty=sigma, line=line))
        return ContactSeries(rig=rig, data=data, rows=tuple(rows), **common)

    def _rows(
        self, table: SeriesTable, unit: str, scene: Scene | None, where: Location
    ) -> Iterator[Row]:
        """Yield the rows of a file; faults of others are collected."""
        path = self._try(lambda: self._file(table.data, where.at("data")))
        if path is None:
            return
        source, text = text_named(path)
        lines = [
            (number, next(csv.reader([line], skipinitialspace=True)))
            for number, line in enumerate(map(str.strip, text.split("\n")), 1)
            if line and not line.startswith("#")
        ]
        if not lines:
            self.problems.append(
                f"{source}: no header, such as 'operation.radial_load [N], measured [%], uncertainty [%]'"
            )
            return
        number, cells = lines[0]
        header = list(map(_parse_head, cells))
        n_problems = len(self.problems)
        self.problems += _header_problems(header, unit, f"{source}:{number}")
        if len(self.problems) > n_problems:
            return
        line_of = dict[FrozenTable, int]()
        for number, cells in lines[1:]:
            cells = [cell.strip() for cell in cells]
            row = self._row(cells, header, unit, f"{source}:{number}", table, number)
            if row is None:
                continue
            if row.changes in line_of:
                self.problems.append(
                    f"{source}:{number}: the conditions of line {line_of[row.changes]} once more"
                )
                continue
            line_of[row.changes] = number
            if scene is not None:
                self._check_changes(scene, row.changes, f"{source}:{number}")
            yield row

    def _row(
        self,
        cells: list[str],
        header: list[tuple[str, str]],
        unit: str,
        where: str,
        table: SeriesTable,
        line: int,
    ) -> Row | None:
        """Return the row in some cells, or None after collecting faults."""
        if len(cells) != len(header):
            hint = "; a decimal comma is not read, write 0.05" if len(cells) > len(header) else ""
            self.problems.append(f"{where}: {len(cells)} values under {len(header)} columns{hint}")
            return None
        changes = dict[str, object]()
        values = dict[str, float]()
        n_problems = len(self.problems)
        for (name, cell_unit), cell in zip(header, cells, strict=True):
            if cell_unit and not NUMBER.fullmatch(cell):
                reason = "is empty" if not cell else f"{as_written(cell)} is not a number alone"
                self.problems.append(f"{where}: {name}: {reason}; its unit stands in the header")
            elif name in (MEASURED, UNCERTAINTY):
                values[name] = quantity(f"{cell} {cell_unit}", unit)
            else:
                changes[name] = _scene_value(cell, cell_unit)
        if values.get(UNCERTAINTY, 1.0) <= 0.0:
            self.problems.append(
                f"{where}: {UNCERTAINTY}: must be above 0, the standard uncertainty of the value"
            )
        if len(self.problems) > n_problems:
            return None
        sigma = _add_reading_error(table, values[MEASURED], values[UNCERTAINTY])
        return Row(
            changes=FrozenTable(changes), measured=values[MEASURED], uncertainty=sigma, line=line
        )

    def _check_changes(self, scene: Scene, changes: Mapping[str, object], where: str) -> None:
        """Collect faults of changes of a scene."""
        try:
            evolve(scene, changes, si=True)
        except SceneError as error:
            self.problems += [
                f"{where}: {problem.removeprefix('changes: ')}" for problem in error.problems
            ]

    # Statements -------------------------------------------------------------------------------------------------------

    def _statement(self, table: StatementTable, where: Location) -> Statement | None:
        """Return a statement, or None after collecting faults that prevent it."""
        unit = self._unit(table, where)
        scene = self._scene(table.scene, where.at("scene"))
        n_problems = len(self.problems)
        if not table.source.strip():
            self.problems.append(
                where.at("source").message("is empty; name the author and the publication")
            )
        steps = self._steps(table, where)
        limit = self._limit(table, unit, where)
        if scene is not None:
            for step in steps:
                name = step.quantity
                if name and name not in QUANTITIES and not _STUDY_VARIABLE.fullmatch(name):
                    self._add_unknown(name, where.at("steps"))
                self._check_changes(scene, step.changes, where.at("steps").message(step.text))
        if unit is None or scene is None or len(self.problems) > n_problems:
            return None
        return Statement(
            quantity=table.quantity,
            unit=unit,
            at=table.at,
            scene=scene,
            text=table.text,
            by_whom=table.source,
            expect=table.expect,
            by=table.by,
            limit=limit,
            steps=steps,
        )

    def _steps(self, table: StatementTable, where: Location) -> tuple[Step, ...]:
        """Return the steps of a statement: those stated, one for each value of its key, or the scene as it is."""
        if bool(table.key) != bool(table.values) or (table.key and table.steps):
            self.problems.append(
                where.at("key").message("give a key with its values, or steps, and not both")
            )
        steps = table.steps
        if not steps and table.key:
            steps = tuple(
                Step(text=str(value), changes=FrozenTable({table.key: value}))
                for value in table.values
            )
        steps = steps or (Step(text="the scene as it is"),)
        if table.expect in ("rises", "falls") and len(steps) < 2:
            self.problems.append(where.message(f"what {table.expect} needs two steps at least"))
        return steps

    def _limit(self, table: StatementTable, unit: str | None, where: Location) -> float | None:
        """Return the limit of a statement in the SI unit, or None where it has none."""
        bounded = table.expect in ("below", "above")
        if bounded != (table.limit is not None):
            reason = (
                f"missing: {table.expect!r} what?"
                if bounded
                else f"{table.expect!r} has no limit; leave it out"
            )
            self.problems.append(where.at("limit").message(reason))
        elif bounded and unit is not None:
            try:
                return quantity(table.limit, unit)
            except UnitError as error:
                self.problems.append(where.at("limit").message(str(error)))
        return None


def _nested_value(table: Mapping[str, Any], path: list[str]) -> Any:
    """Return the value at a path in nested tables, also under a key with dots; None where there is none."""
    for n in (len(path), *range(1, len(path))):
        if (value := table.get(".".join(path[:n]))) is not None:
            return value if n == len(path) else _nested_value(as_table(value), path[n:])
    return None


def _is_number(value: object) -> bool:
    """Return whether a value of a scene is a number, also as a text with a unit."""
    if isinstance(value, str):
        return NUMBER.match(value) is not None
    return isinstance(value, int | float) and not isinstance(value, bool)


def _parse_head(cell: str) -> tuple[str, str]:
    """Return name and unit of a column; the unit is empty where none is given."""
    name, bracket, rest = (part.strip() for part in cell.partition("["))
    return name, rest.removesuffix("]").strip() if bracket else ""


def _header_problems(header: list[tuple[str, str]], unit: str, where: str) -> Iterator[str]:
    """Yield the faults of a header."""
    names = [name for name, _ in header]
    yield from (
        f"{where}: {as_written(name)} stands there twice"
        for name in dict.fromkeys(names)
        if names.count(name) > 1
    )
    yield from (
        f"{where}: {name}: missing, but required"
        for name in (MEASURED, UNCERTAINTY)
        if name not in names
    )
    for name, column_unit in header:
        if name in (MEASURED, UNCERTAINTY):
            try:
                quantity(f"1 {column_unit}" if column_unit else "1 ?", unit)
            except UnitError as error:
                reason = str(error) if column_unit else f"has no unit, write {name} [{unit}]"
                yield f"{where}: {name}: {reason}"
        elif "." not in name:
            yield f"{where}: {as_written(name)} is not a key of the scene, such as operation.radial_load"


def _scene_value(cell: str, unit: str) -> object:
    """Return the value of a cell as a scene takes it; a list is written as in TOML."""
    if cell.startswith("["):
        return parse_set(f"{MEASURED}={cell}")[1]
    if not unit:
        return int(cell) if re.fullmatch(r"\d+", cell) else cell
    return float(cell) if unit == "1" else f"{cell} {unit}"


def _add_reading_error(table: SeriesTable, measured: float, sigma: float) -> float:
    """Return the standard uncertainty with that of reading the value off a figure."""
    return float((sigma**2 + (abs(measured) * (table.reading_error or 0.0)) ** 2) ** 0.5)
