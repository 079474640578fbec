"""Reads data sets from their folders, with every fault of all their files in one error.

- A folder has ``measurement.toml``; the scenes, rigs and tables of numbers that it names stand beside it.
- A header cell is a key of the scene with the unit of the values below, ``operation.radial_load [N]``; a name, a model
  for example, has no unit. What the key takes, the scene says: every row is read as a change of it.
- Nothing is repaired, nothing is left out, and a value without uncertainty is no measurement.
"""

import csv
import os
import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, Final

import attrs

from rollslip.errors import SceneError, did_you_mean, nearest
from rollslip.files import readable
from rollslip.references import Reference
from rollslip.scene.changes import evolve
from rollslip.scene.reading import load_scene
from rollslip.scene.values import Scene
from rollslip.structure import FrozenTable, Location, structure
from rollslip.toml import parse
from rollslip.units import UnitError, as_written, check_unit, quantity
from rollslip_campaigns.measurement.rig import (
    FilmRow,
    Rig,
    RigData,
    TractionRow,
    faults_of,
    load_rig,
    read_data,
    text_named,
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

FILE: Final = "measurement.toml"
#: Columns of the value and of its standard uncertainty.
MEASURED = "measured"
UNCERTAINTY = "uncertainty"
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?", re.ASCII)
#: The variable of a study.
_OF_STUDY: Final = re.compile(r"[\w-]+/\w+", re.ASCII)
#: How values are read that are not there yet.
_TO_READ: Final = "to be digitised"
#: What a licence says that the numbers may not be passed on.
_CLOSED: Final = "not redistributable"


def load_measurements(folder: str | os.PathLike[str]) -> list[Measurement]:
    """Return the data sets in the folders below one, in the order of their names."""
    found = sorted(path.parent for path in Path(folder).glob(f"*/{FILE}"))
    if not found:
        raise SceneError([f"{readable(os.fspath(folder))}: no folder in it has a file {FILE}"])
    return [load_measurement(path) for path in found]


def load_measurement(folder: str | os.PathLike[str]) -> Measurement:
    """Read a data set."""
    base = Path(folder)
    source, text = text_named(base / FILE)
    raw, origins = parse(text, source)
    problems: list[str] = []
    where = Location(origins)
    table = structure(MeasurementTable, raw, where, problems)
    if table is None:
        raise SceneError(problems)
    made = _Reader(base, table, where, problems).measurement()
    if problems:
        raise faults_of(source, problems)
    return made


@attrs.define
class _Reader:
    """Reads what a data set's table names, and notes what is wrong with it."""

    folder: Path
    table: MeasurementTable
    where: Location
    problems: list[str]
    _scenes: dict[str, Scene | None] = attrs.field(factory=dict)

    def measurement(self) -> Measurement:
        table = self.table
        series = [
            self._series(one, self.where.at("series").at(k)) for k, one in enumerate(table.series)
        ]
        said = [
            self._statement(one, self.where.at("statements").at(k))
            for k, one in enumerate(table.statements)
        ]
        self._check_names()
        references = self._references(table.source)
        # what could not be read may have values
        has_values = any(one is None or one.rows for one in series) or bool(said)
        self._check_source(table.source, has_values)
        self._check_estimates()
        made = Measurement(
            name=table.name,
            description=table.description,
            references=references,
            read=table.source.read,
            by=table.source.by,
            licence=table.source.licence,
            recipe=table.source.recipe,
            estimated=FrozenTable(dict(table.estimated)),
            series=tuple(one for one in series if one is not None),
            statements=tuple(one for one in said if one is not None),
            folder=str(self.folder),
        )
        return (
            attrs.evolve(made, description=f"{FORM}: {made.description}") if made.is_form else made
        )

    # About the whole -------------------------------------------------------------------------------------------------

    def _check_names(self) -> None:
        if not re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", self.table.name, re.ASCII):
            self._note(
                "name",
                f"{as_written(self.table.name)} is not made of small letters, digits and hyphens",
            )
        if not self.table.series and not self.table.statements:
            self._note(
                "series",
                "missing: a data set has [[series]] of numbers, or [[statements]], or both",
            )
        names = [one.name for one in self.table.series]
        for name in {name for name in names if names.count(name) > 1}:
            self._note("series", f"two are called {as_written(name)}; give each a name of its own")

    def _note(self, key: str, reason: str) -> None:
        self.problems.append(self.where.at(key).message(reason))

    def _references(self, source: SourceTable) -> tuple[Any, ...]:
        found: list[Reference | str] = []
        where = self.where.at("source").at("references")
        for k, one in enumerate(source.references):
            if isinstance(one, Mapping):
                try:
                    fields: dict[str, Any] = dict(one)
                    found.append(Reference(**fields))
                except (TypeError, ValueError) as error:
                    self.problems.append(where.at(k).message(str(error)))
            elif isinstance(one, str) and len(one.split()) >= 3:
                found.append(one)
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
        return tuple(found)

    def _check_source(self, source: SourceTable, has_values: bool) -> None:
        where = self.where.at("source")
        digitised = source.read == "digitised"
        closed = source.licence == _CLOSED
        without = [
            k for k, one in enumerate(self.table.series) if digitised and one.reading_error is None
        ]
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
                for k in without
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
        self.problems += [at.message(reason) for wrong, at, reason in faults if wrong]

    def _check_estimates(self) -> None:
        """What is estimated stands in a scene, and scatters where it is a number."""
        scenes = [scene for scene in self._scenes.values() if scene is not None]
        for key in self.table.estimated:
            at = self.where.at("estimated").at(key)
            path = key.split(".")
            stated = [
                value for scene in scenes if (value := _deep(scene.raw or {}, path)) is not None
            ]
            if scenes and not stated:
                self.problems.append(at.message("no scene of the data set states this key"))
            for scene in scenes:
                value = _deep(scene.raw or {}, path)
                number = isinstance(value, int | float) or (
                    isinstance(value, str) and _NUMBER.match(value)
                )
                if (
                    number
                    and not isinstance(value, bool)
                    and _deep(scene.uncertainty or {}, path) is None
                ):
                    place = readable(scene.source)
                    self.problems.append(
                        f"{place}: uncertainty.{key}: missing: {as_written(value)} is estimated, so it needs a "
                        "distribution, such as { distribution = 'uniform', scatter = 0.25 }"
                    )

    # Scenes and quantities --------------------------------------------------------------------------------------------

    def _scene(self, name: str, where: Location) -> Scene | None:
        if name not in self._scenes:
            self._scenes[name] = self._noted(lambda: load_scene(self._beside(name, where)))
        return self._scenes[name]

    def _beside(self, name: str, where: Location) -> Path:
        path = self.folder / name
        if Path(name).name != name or not path.is_file():
            raise SceneError(
                [where.message(f"{as_written(name)} is no file in {readable(str(self.folder))}")]
            )
        return path

    def _noted(self, read: "Callable[[], Any]") -> Any:
        try:
            return read()
        except SceneError as error:
            self.problems += error.problems
            return None

    def _unit(self, one: SeriesTable | StatementTable, where: Location) -> str | None:
        """SI unit of the quantity, or None after noting what is wrong."""
        if one.quantity in QUANTITIES:
            return QUANTITIES[one.quantity].unit
        if not _OF_STUDY.fullmatch(one.quantity):
            self._unknown(one.quantity, where)
        elif not one.unit:
            reason = "missing: the variable of a study needs its SI unit, '1' for none"
            self.problems.append(where.at("unit").message(reason))
        else:
            try:
                return check_unit(one.unit)
            except UnitError as error:
                self.problems.append(where.at("unit").message(str(error)))
        return None

    def _unknown(self, name: str, where: Location) -> None:
        near = nearest(name, QUANTITIES, count=1)
        hint = did_you_mean(near, f"there are: {', '.join(QUANTITIES)}; and STUDY/VARIABLE")
        self.problems.append(
            where.at("quantity").message(f"{as_written(name)} is none that is known; {hint}")
        )

    # Series -----------------------------------------------------------------------------------------------------------

    def _series(self, one: SeriesTable, where: Location) -> Series | None:
        unit = self._unit(one, where)
        if unit is None:
            return None
        if not one.uncertainty.strip():
            self.problems.append(
                where.at("uncertainty").message(
                    "is empty; say what the column of uncertainty rests on"
                )
            )
        of_contact = one.quantity in QUANTITIES and QUANTITIES[one.quantity].of == "contact"
        wanted, other = ("rig", "scene") if of_contact else ("scene", "rig")
        if not getattr(one, wanted):
            self.problems.append(
                where.at(wanted).message(f"missing: a {one.quantity} is measured on a {wanted}")
            )
            return None
        if getattr(one, other):
            self.problems.append(
                where.at(other).message(
                    f"a {one.quantity} is measured on a {wanted}; leave this out"
                )
            )
        common: dict[str, Any] = {
            "name": one.name,
            "quantity": one.quantity,
            "unit": unit,
            "at": one.at,
            "about_uncertainty": one.uncertainty,
        }
        if of_contact:
            return self._of_contact(one, where, common)
        scene = self._scene(one.scene, where.at("scene"))
        if scene is not None and one.changes:
            given = scene
            scene = self._noted(lambda: evolve(given, one.changes))
        rows = self._rows(one, unit, scene, where)
        return None if scene is None else Series(scene=scene, rows=tuple(rows), **common)

    def _of_contact(
        self, one: SeriesTable, where: Location, common: Mapping[str, Any]
    ) -> Series | None:
        column = one.quantity.replace("-", "_")
        rig: Rig | None = self._noted(lambda: load_rig(self._beside(one.rig, where.at("rig"))))
        if (
            rig is not None and self.table.source.read == _TO_READ
        ):  # a form: there is nothing to read yet
            self._noted(lambda: self._beside(one.data, where.at("data")))
            return Series(rows=(), **common)
        row = FilmRow if one.quantity == "film-thickness" else TractionRow
        data: RigData | None = self._noted(
            lambda: read_data(self._beside(one.data, where.at("data")), row)
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
        seen = dict[FrozenTable, int]()
        for k, line in enumerate(data.lines):
            changes = FrozenTable({name: float(data.columns[name][k]) for name in conditions})
            if changes in seen:
                self.problems.append(
                    f"{data.source}:{line}: the conditions of line {seen[changes]} once more"
                )
            seen[changes] = line
            measured, sigma = (
                float(data.columns[name][k]) for name in (column, f"{column}_uncertainty")
            )
            sigma = _with_reading(one, measured, sigma)
            rows.append(Row(changes=changes, measured=measured, uncertainty=sigma, line=line))
        return ContactSeries(rig=rig, data=data, rows=tuple(rows), **common)

    def _rows(
        self, one: SeriesTable, unit: str, scene: Scene | None, where: Location
    ) -> Iterator[Row]:
        """Rows of a file; what is wrong with them is noted."""
        path = self._noted(lambda: self._beside(one.data, where.at("data")))
        if path is None:
            return
        source, text = text_named(path)
        stripped = ((number, line.strip()) for number, line in enumerate(text.split("\n"), 1))
        lines = [(number, next(csv.reader([line], skipinitialspace=True))) for number, line in stripped
                 if line and not line.startswith("#")]  # fmt: skip
        if not lines:
            example = "operation.radial_load [N], measured [%], uncertainty [%]"
            self.problems.append(f"{source}: no header, such as '{example}'")
            return
        number, cells = lines[0]
        header = [_cell(cell) for cell in cells]
        before = len(self.problems)
        self.problems += _of_header(header, unit, f"{source}:{number}")
        if len(self.problems) > before:
            return
        seen = dict[FrozenTable, int]()
        for number, cells in lines[1:]:
            row = self._row(
                [cell.strip() for cell in cells], header, unit, f"{source}:{number}", one, number
            )
            if row is None:
                continue
            if row.changes in seen:
                self.problems.append(
                    f"{source}:{number}: the conditions of line {seen[row.changes]} once more"
                )
                continue
            seen[row.changes] = number
            if scene is not None:
                self._fits(scene, row.changes, f"{source}:{number}")
            yield row

    def _row(
        self,
        cells: list[str],
        header: list[tuple[str, str]],
        unit: str,
        where: str,
        one: SeriesTable,
        line: int,
    ) -> Row | None:
        if len(cells) != len(header):
            hint = "; a decimal comma is not read, write 0.05" if len(cells) > len(header) else ""
            self.problems.append(f"{where}: {len(cells)} values under {len(header)} columns{hint}")
            return None
        changes = dict[str, object]()
        values = dict[str, float]()
        before = len(self.problems)
        for (name, of), cell in zip(header, cells, strict=True):
            if of and not _NUMBER.fullmatch(cell):
                reason = "is empty" if not cell else f"{as_written(cell)} is not a number alone"
                self.problems.append(f"{where}: {name}: {reason}; its unit stands in the header")
            elif name in (MEASURED, UNCERTAINTY):
                values[name] = quantity(f"{cell} {of}", unit)
            else:
                changes[name] = _plain(cell, of)
        if values.get(UNCERTAINTY, 1.0) <= 0.0:
            self.problems.append(
                f"{where}: {UNCERTAINTY}: must be above 0, the standard uncertainty of the value"
            )
        if len(self.problems) > before:
            return None
        sigma = _with_reading(one, values[MEASURED], values[UNCERTAINTY])
        return Row(
            changes=FrozenTable(changes), measured=values[MEASURED], uncertainty=sigma, line=line
        )

    def _fits(self, scene: Scene, changes: Mapping[str, object], where: str) -> None:
        """Note what the scene says against changes of it."""
        try:
            evolve(scene, changes)
        except SceneError as error:
            self.problems += [
                f"{where}: {problem.removeprefix('changes: ')}" for problem in error.problems
            ]

    # Statements -------------------------------------------------------------------------------------------------------

    def _statement(self, one: StatementTable, where: Location) -> Statement | None:
        unit = self._unit(one, where)
        scene = self._scene(one.scene, where.at("scene"))
        before = len(self.problems)
        if not one.source.strip():
            self.problems.append(
                where.at("source").message("is empty; name who says so, and where")
            )
        if bool(one.key) != bool(one.values) or (one.key and one.steps):
            self.problems.append(
                where.at("key").message("give a key with its values, or steps, and not both")
            )
        steps = (
            one.steps
            or tuple(
                Step(text=str(value), changes=FrozenTable({one.key: value}))
                for value in (one.values if one.key else ())
            )
            or (Step(text="the scene as it is"),)
        )
        if one.expect in ("rises", "falls") and len(steps) < 2:
            self.problems.append(where.message(f"what {one.expect} needs two steps at least"))
        limit = self._limit(one, unit, where)
        if scene is not None:
            for step in steps:
                if (
                    step.quantity
                    and step.quantity not in QUANTITIES
                    and not _OF_STUDY.fullmatch(step.quantity)
                ):
                    self._unknown(step.quantity, where.at("steps"))
                self._fits(scene, step.changes, where.at("steps").message(step.text))
        if unit is None or scene is None or len(self.problems) > before:
            return None
        return Statement(
            quantity=one.quantity, unit=unit, at=one.at, scene=scene, text=one.text, by_whom=one.source,
            expect=one.expect, by=one.by, limit=limit, steps=steps,
        )  # fmt: skip

    def _limit(self, one: StatementTable, unit: str | None, where: Location) -> float | None:
        bounded = one.expect in ("below", "above")
        if bounded != (one.limit is not None):
            reason = (
                f"missing: {one.expect!r} what?"
                if bounded
                else f"{one.expect!r} has no limit; leave it out"
            )
            self.problems.append(where.at("limit").message(reason))
        elif bounded and unit is not None:
            try:
                return quantity(one.limit, unit)
            except UnitError as error:
                self.problems.append(where.at("limit").message(str(error)))
        return None


def _deep(table: Mapping[str, Any], path: list[str]) -> Any:
    """Value deep in tables, also under a key that was written in quotes."""
    for n in (len(path), *range(1, len(path))):
        below = table.get(".".join(path[:n]))
        if below is not None:
            return (
                below
                if n == len(path)
                else _deep(below, path[n:])
                if isinstance(below, Mapping)
                else None
            )
    return None


def _cell(cell: str) -> tuple[str, str]:
    """Name and unit of a column; no unit where none is given."""
    name, bracket, rest = (part.strip() for part in cell.partition("["))
    return name, rest.removesuffix("]").strip() if bracket else ""


def _of_header(header: list[tuple[str, str]], unit: str, where: str) -> Iterator[str]:
    """Say what is wrong with a header."""
    names = [name for name, _ in header]
    twice = [name for name in dict.fromkeys(names) if names.count(name) > 1]
    yield from (f"{where}: {as_written(name)} stands there twice" for name in twice)
    yield from (
        f"{where}: {name}: missing, but required"
        for name in (MEASURED, UNCERTAINTY)
        if name not in names
    )
    for name, of in header:
        if name in (MEASURED, UNCERTAINTY):
            try:
                quantity(f"1 {of}" if of else "1 ?", unit)
            except UnitError as error:
                yield f"{where}: {name}: {error if of else f'has no unit, write {name} [{unit}]'}"
        elif "." not in name:
            yield f"{where}: {as_written(name)} is no key of the scene, such as operation.radial_load"


def _plain(cell: str, unit: str) -> object:
    """What the scene is given for a cell."""
    if not unit:
        return int(cell) if re.fullmatch(r"\d+", cell) else cell
    return float(cell) if unit == "1" else f"{cell} {unit}"


def _with_reading(one: SeriesTable, measured: float, sigma: float) -> float:
    """Uncertainty with that of reading off a figure."""
    return float((sigma**2 + (abs(measured) * (one.reading_error or 0.0)) ** 2) ** 0.5)
