"""Read a table of load cases from CSV, xlsx or pandas, with all its faults in one error."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.fields import parameter
from rollslip.scene.changes import Quantity
from rollslip.scene.formats import format_of
from rollslip.scene.values import Scene
from rollslip.search import Array
from rollslip.structure import Location, raise_problem_if, raise_problems, structure
from rollslip.studies.tables import FurtherColumn, read_table
from rollslip_campaigns.sweep.sampling import Axis, Design

__all__ = ["CaseDesign", "CaseTable", "CasesOfScene", "files_of", "read_cases"]

#: Columns of the part of the time that a case takes.
_TIMES: Final[Mapping[str, FurtherColumn]] = {
    "share": FurtherColumn("1", minimum=0.0),
    "time": FurtherColumn("s", minimum=0.0),
}


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


@attrs.frozen(kw_only=True)
class CasesOfScene:
    """The table ``[cases]`` of a scene."""

    table: str = parameter(
        doc="file of the load cases, .csv or .xlsx: its name beside the scene, or its full path"
    )
    measured: str | None = parameter(
        default=None, doc="file of measured points to compare with, likewise"
    )


def files_of(scene: Scene) -> tuple[Path, Path | None]:
    """Return the files of load cases and of measured points that a scene names, beside it or with their full paths.

    A scene that was read from another program's file names this file.
    """
    if scene.cases is None and format_of(scene.source) is not None:
        return Path(scene.source), None
    where = Location(scene.origins, ("cases",))
    raise_problem_if(
        scene.cases is None,
        "cases: name a table of load cases: rollslip cases SCENE duty.csv, or [cases] with table = 'duty.csv' in the "
        "scene",
    )
    problems = list[str]()
    named = structure(CasesOfScene, dict(scene.cases or {}), where, problems)
    raise_problems(problems)
    assert named is not None
    folder = Path(scene.source).parent if scene.source.endswith(".toml") else Path()
    measured = None if named.measured is None else folder / named.measured
    return folder / named.table, measured


def read_cases(given: object, known: Mapping[str, Quantity]) -> CaseTable:
    """Return the load cases of a table; all faults of the table are raised in one error.

    Parameters
    ----------
    given : path or pandas.DataFrame
        The table.
    known : mapping of str to Quantity
        Quantities of the scene by key.
    """
    table = read_table(given, known, _TIMES)
    varied = [column.quantity for column in table.columns if column.quantity is not None]
    raise_problem_if(not varied, f"{table.source}: no column has a key of the scene")
    numbers = [quantity for quantity in varied if quantity.unit is not None]
    names = [quantity for quantity in varied if quantity.unit is None]
    samples = np.array([table.values[quantity.key] for quantity in numbers], dtype=float)
    count = len(table.places)
    return CaseTable(
        table.source,
        CaseDesign(
            (),
            tuple(numbers),
            samples.T.reshape(count, len(numbers)),
            tuple(Axis(quantity, tuple(table.values[quantity.key])) for quantity in names),
        ),
        _fractions(table.values, count, table.source),
    )


def _fractions(values: Mapping[str, Sequence[float]], count: int, source: str) -> Array:
    """Return the part of the time that each case takes; equal parts without a column of times."""
    columns = [values[name] for name in _TIMES if name in values]
    raise_problem_if(len(columns) > 1, f"{source}: give share or time, and not both")
    times = np.array(columns[0]) if columns else np.ones(count)
    raise_problem_if(not times.sum() > 0.0, f"{source}: the shares of all cases are zero")
    return np.asarray(times / times.sum(), dtype=float)
