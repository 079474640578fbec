"""Classes of data sets: what was measured, on what, how well, where it was published, how it was read, and the licence.

- A row has one number, of a *quantity*: a result of a study of a bearing, or of a contact of a rig. A finding in words
  is a `Statement`: how a quantity changes along some steps.
- Rows state their conditions by keys of the scene, so that conditions can be whatever a scene can state.
- What a source does not state is estimated: the data set names these keys and the reasons for their values, and the
  table ``[uncertainty]`` of the scene their scatter. Nothing is estimated without notice.
- A data set without rows is a form: complete except for the numbers, which are still to be read off.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

import attrs

from rollslip.catalogue.kinds import Kind
from rollslip.fields import choice_of, field, positive
from rollslip.references import Citation
from rollslip.scene.values import Scene
from rollslip.structure import FrozenTable
from rollslip.units import format_quantity
from rollslip_campaigns.measurement.rig import (
    FilmRow,
    ResistanceRow,
    Rig,
    RigData,
    TractionRow,
)

__all__ = [
    "EXPECTED",
    "FORM",
    "LICENCES",
    "MEASUREMENT",
    "QUANTITIES",
    "READ",
    "ContactSeries",
    "Measured",
    "Measurement",
    "Quantity",
    "Row",
    "Series",
    "SeriesTable",
    "SourceTable",
    "Statement",
    "StatementTable",
    "Step",
]


@attrs.frozen
class Quantity:
    """Quantity that can be measured: SI unit, description, and whether it is of a bearing, a contact or an oil."""

    unit: str
    doc: str
    of: str = "bearing"


#: Quantities of data sets, by name; also, ``STUDY/VARIABLE`` for a variable of any study.
QUANTITIES: Final[Mapping[str, Quantity]] = MappingProxyType(
    {
        "critical-slip": Quantity("1", "cage slip of the largest effective friction of a ring"),
        "skidding-slip": Quantity("1", "cage slip at which skidding begins"),
        "limit-drag": Quantity("N m", "limit drag torque of the cage"),
        "cage-slip": Quantity("1", "cage slip of steady operation, the smallest that lasts"),
        "cage-speed": Quantity(
            "rad/s", "speed of the cage in steady operation, at the smallest slip that lasts"
        ),
        "friction-torque": Quantity(
            "N m", "friction torque of the bearing in steady operation, at that slip"
        ),
        "minimum-load": Quantity("N", "minimum radial load for an acceptable slip"),
        "largest-cage-slip": Quantity("1", "cage slip of steady operation, the largest that lasts"),
        "friction": Quantity("1", "traction coefficient of a contact", "contact"),
        "film-thickness": Quantity("m", "film thickness of a contact", "contact"),
        "contact-resistance": Quantity(
            "N/m",
            "rolling resistance of a contact per length, by the drag that at.law names",
            "contact",
        ),
        "pressure-viscosity": Quantity(
            "1/Pa",
            "pressure-viscosity coefficient of the oil of the scene: ln(eta/eta0)/p at at.pressure, without it at no "
            "pressure",
            "oil",
        ),
    }
)
#: How values came from their source into the file.
READ: Final = ("printed", "digitised", "computed", "recalled", "recorded", "to be digitised")
#: First words of the description of a data set without numbers.
FORM: Final = "A FORM without numbers, no measurement yet"
#: What a statement may expect of the values along its steps.
EXPECTED: Final = ("rises", "falls", "below", "above", "none")
#: Description of what a licence may be.
LICENCES: Final = "a licence such as 'CC BY 4.0', 'facts' for single numbers, or 'not redistributable' with a recipe"


def _text(doc: str, default: object = attrs.NOTHING) -> str:
    """Return the field of a text."""
    text: str = field(doc=doc, default=default)
    return text


# Tables of the file --------------------------------------------------------------------------------------------------


@attrs.frozen(kw_only=True)
class SourceTable:
    """Source of the values, and how they were read."""

    references: tuple[object, ...] = field(
        doc="citations, texts or tables of a reference's fields", default=()
    )
    read: str = field(doc="how the values were read", validator=choice_of(*READ))
    by: str = _text("who read them, where they are digitised", "")
    licence: str = _text(LICENCES)
    recipe: str = _text("how to get what is not here", "")
    measured: bool | None = field(
        doc="whether the values were measured, and not computed by others; by default unless they are read as computed",
        default=None,
    )


@attrs.frozen(kw_only=True)
class SeriesTable:
    """Rows of one quantity."""

    name: str = _text("what distinguishes it from the others, in a few words")
    quantity: str = _text("what was measured")
    unit: str = _text("SI unit of the variable of a study", "")
    at: FrozenTable = field(
        doc="which of several values, such as { ring = 'inner' }", default=FrozenTable()
    )
    scene: str = _text("file of the scene, beside this one", "")
    changes: FrozenTable = field(doc="what all rows change in it, by key", default=FrozenTable())
    rig: str = _text("file of the rig, beside this one", "")
    data: str = _text("file of the rows, beside this one")
    uncertainty: str = _text("what the column of uncertainty rests on")
    reading_error: float | None = field(
        doc="standard error of reading it off a figure, as a fraction of the value",
        unit="1",
        default=None,
        validator=attrs.validators.optional(positive),
    )


@attrs.frozen(kw_only=True)
class Step:
    """One of the states that a statement compares."""

    text: str = _text("what is so at this step")
    quantity: str = _text(
        "what it is about, where that is not the statement's; of the same unit", ""
    )
    at: FrozenTable = field(doc="which of several values of that quantity", default=FrozenTable())
    changes: FrozenTable = field(doc="what it changes in the scene, by key", default=FrozenTable())


@attrs.frozen(kw_only=True)
class StatementTable:
    """A finding in words: how a quantity changes along some steps, or where it lies."""

    text: str = _text("the statement, in a few words")
    source: str = _text("who says so, where")
    quantity: str = _text("what it is about")
    unit: str = _text("SI unit of the variable of a study", "")
    at: FrozenTable = field(doc="which of several values of the quantity", default=FrozenTable())
    scene: str = _text("file of the scene, beside this one")
    expect: str = field(
        doc="how the values go along the steps, or where they lie", validator=choice_of(*EXPECTED)
    )
    by: float = field(
        doc="least change from step to step that counts, as a fraction of the value before",
        unit="1",
        default=0.02,
        validator=positive,
    )
    limit: object = field(doc="of 'below' and 'above', with its unit", default=None)
    key: str = _text("key of the scene that the steps change, where it is one", "")
    values: tuple[object, ...] = field(doc="its values", default=())
    steps: tuple[Step, ...] = field(doc="the steps, where more than a key changes", default=())


@attrs.frozen(kw_only=True)
class MeasurementTable:
    """A file ``measurement.toml``."""

    name: str = _text("what `rollslip validate` calls it")
    description: str = _text("what was measured on what, in one line")
    source: SourceTable = field(doc="where it stands and how it was read")
    estimated: Mapping[str, str] = field(
        doc="what the source does not state: key of the scene -> why the value it has",
        default=FrozenTable(),
    )
    series: tuple[SeriesTable, ...] = field(doc="what was measured", default=())
    statements: tuple[StatementTable, ...] = field(doc="what was said in words", default=())


# Data sets -----------------------------------------------------------------------------------------------------------


@attrs.frozen(kw_only=True)
class Row:
    """One measured value: its conditions by keys of the scene, value and standard uncertainty in SI units."""

    changes: FrozenTable
    measured: float
    uncertainty: float
    line: int

    @property
    def label(self) -> str:
        """The conditions as text."""
        return ", ".join(
            f"{key.rpartition('.')[2].replace('_', ' ')} {_format_condition(key, value)}"
            for key, value in self.changes.items()
            if not isinstance(value, tuple)
        )


def _format_condition(key: str, value: object) -> object:
    """Return a condition of a rig with its unit; of a scene as it was written."""
    unit = _RIG_UNITS.get(key)
    return (
        value if unit is None or not isinstance(value, float) else format_quantity(value, unit, 3)
    )


#: SI units of the columns of rigs.
_RIG_UNITS: Final = {
    attribute.name: attribute.metadata["unit"]
    for row in (TractionRow, FilmRow, ResistanceRow)
    for attribute in attrs.fields(row)
}


@attrs.frozen(kw_only=True)
class Measured:
    """Quantity, unit, coordinates and scene of a series or a statement."""

    quantity: str
    unit: str
    at: FrozenTable = attrs.field(factory=FrozenTable)
    scene: Scene | None = None


@attrs.frozen(kw_only=True)
class Series(Measured):
    """Rows of one quantity of a bearing; a form has none yet."""

    name: str
    rows: tuple[Row, ...]
    about_uncertainty: str


@attrs.frozen(kw_only=True)
class ContactSeries(Series):
    """Rows of one quantity of a contact in a rig."""

    rig: Rig
    data: RigData


@attrs.frozen(kw_only=True)
class Statement(Measured):
    """A finding in words; see `StatementTable`."""

    text: str
    by_whom: str
    expect: str
    by: float
    limit: float | None
    steps: tuple[Step, ...]


@attrs.frozen(kw_only=True)
class Measurement:
    """A data set for the validation of models; `load_measurement` reads one from its folder.

    Attributes
    ----------
    name, description : str
        Name, and description in one line.
    references : tuple of Reference or str
        Publications of the values.
    read, by, licence, recipe : str
        How the values were read, by whom, their licence, and how to get what is not included.
    measured : bool
        Whether the values were measured, and not computed by others.
    estimated : mapping
        Reasons for the values of keys of the scene that the source does not state, by key.
    series : tuple of Series
        Measured rows.
    statements : tuple of Statement
        Findings in words.
    folder : str
        Folder of the files; equal data sets may be in different folders.
    """

    name: str
    description: str
    references: tuple[Citation, ...]
    read: str
    by: str = ""
    licence: str
    recipe: str = ""
    measured: bool = False
    estimated: FrozenTable = attrs.field(factory=FrozenTable)
    series: tuple[Series, ...] = ()
    statements: tuple[Statement, ...] = ()
    folder: str = attrs.field(default="", eq=False)

    @property
    def is_form(self) -> bool:
        """Whether its numbers are still to be read off."""
        return not self.statements and not any(series.rows for series in self.series)

    @property
    def source(self) -> str:
        """Where the values come from, in one line."""
        by = f" by {self.by}" if self.by else ""
        recipe = f"; {self.recipe}" if self.recipe else ""
        return f"{self.read}{by}; licence: {self.licence}{recipe}"

    @property
    def validity(self) -> str:
        """The estimated keys, in one line."""
        if not self.estimated:
            return "the source states all that was needed"
        return f"estimated, since the source does not state it: {', '.join(self.estimated)}"

    @property
    def data(self) -> "Contents":
        """The number of rows and statements, for lists."""
        return Contents(
            rows={series.name: len(series.rows) for series in self.series},
            statements=len(self.statements),
        )


@attrs.frozen(kw_only=True)
class Contents:
    """Number of rows of each series, and of statements."""

    rows: Mapping[str, int] = field(doc="rows of each series")
    statements: int = field(doc="statements")


#: Plugin kind of data sets.
MEASUREMENT: Final = Kind(
    name="measurement",
    hook="measurements",
    base=Measurement,
    data=True,
    rules="rollslip_campaigns.measurement.rules",
)
