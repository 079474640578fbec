"""What a data set is: what was measured, on what, how well, where it stands, how it was read, and under which licence.

- What is measured is one number a row, a *quantity*: a result of a study of a bearing, or of a contact of a rig. What
  was said in words alone is a `Statement`: how a quantity goes along some steps.
- Rows say under which conditions they hold by keys of the scene: whatever a scene can state can be measured at.
- What a source does not state is estimated: the data set says which keys these are and why their values, the table
  ``[uncertainty]`` of the scene how they scatter. Nothing is estimated in silence.
- A data set without rows is a form: complete but for the numbers that a person has to read off.
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
from rollslip_campaigns.measurement.rig import FilmRow, Rig, RigData, TractionRow

__all__ = [
    "EXPECTED", "FORM", "LICENCES", "MEASUREMENT", "QUANTITIES", "READ", "ContactSeries", "Measured", "Measurement",
    "Quantity", "Row", "Series", "SeriesTable", "SourceTable", "Statement", "StatementTable", "Step",
]  # fmt: skip


@attrs.frozen
class Quantity:
    """What can be measured: its SI unit, its meaning, and whether it is of a bearing's scene or of a rig's contact."""

    unit: str
    doc: str
    of: str = "bearing"


#: What data sets can hold, by name; besides, ``STUDY/VARIABLE`` for a variable of any study.
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
        "least-load": Quantity("N", "minimum radial load for an acceptable slip"),
        "largest-cage-slip": Quantity("1", "cage slip of steady operation, the largest that lasts"),
        "largest-drag-slip": Quantity(
            "1", "cage slip of the limit drag torque, beyond which no slip lasts"
        ),
        "friction": Quantity("1", "traction coefficient of a contact", "contact"),
        "film-thickness": Quantity("m", "film thickness of a contact", "contact"),
    }
)
#: How values came from their source into the file.
READ: Final = ("printed", "digitised", "computed", "recalled", "to be digitised")
#: How the description of a data set begins whose numbers are still to be read off, wherever it is listed.
FORM: Final = "A FORM without numbers, no measurement yet"
#: What a statement may expect of the values along its steps.
EXPECTED: Final = ("rises", "falls", "below", "above", "none")
LICENCES: Final = "a licence such as 'CC BY 4.0', 'facts' for single numbers, or 'not redistributable' with a recipe"


def _text(doc: str, default: object = attrs.NOTHING) -> str:
    text: str = field(doc=doc, default=default)
    return text


# As the file has it -------------------------------------------------------------------------------------------------


@attrs.frozen(kw_only=True)
class SourceTable:
    """Where the values stand, and how they came here."""

    references: tuple[object, ...] = field(
        doc="citations, texts or tables of a reference's fields", default=()
    )
    read: str = field(doc="how the values were read", validator=choice_of(*READ))
    by: str = _text("who read them, where they are digitised", "")
    licence: str = _text(LICENCES)
    recipe: str = _text("how to get what is not here", "")


@attrs.frozen(kw_only=True)
class SeriesTable:
    """Rows of one quantity."""

    name: str = _text("what tells it from the others, in a few words")
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
        doc="standard error of reading it off a figure, as a share of the value", unit="1", default=None,
        validator=attrs.validators.optional(positive),
    )  # fmt: skip


@attrs.frozen(kw_only=True)
class Step:
    """One of the states that a statement speaks of."""

    text: str = _text("what is so at this step")
    quantity: str = _text(
        "what it is about, where that is not the statement's; of the same unit", ""
    )
    at: FrozenTable = field(doc="which of several values of that quantity", default=FrozenTable())
    changes: FrozenTable = field(doc="what it changes in the scene, by key", default=FrozenTable())


@attrs.frozen(kw_only=True)
class StatementTable:
    """What was said in words: how a quantity goes along some steps, or where it lies."""

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
        doc="least change from step to step that counts, as a share of the value before", unit="1", default=0.02,
        validator=positive,
    )  # fmt: skip
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


# As it is used ------------------------------------------------------------------------------------------------------


@attrs.frozen(kw_only=True)
class Row:
    """One measured value: its conditions by keys of the scene, value and standard uncertainty in SI units."""

    changes: FrozenTable
    measured: float
    uncertainty: float
    line: int

    @property
    def label(self) -> str:
        """The conditions in words."""
        return ", ".join(
            f"{key.rpartition('.')[2].replace('_', ' ')} {_shown(key, v)}"
            for key, v in self.changes.items()
        )


def _shown(key: str, value: object) -> object:
    """A value of a rig with its unit; of a scene as it was written."""
    unit = _RIG_UNITS.get(key)
    return (
        value if unit is None or not isinstance(value, float) else format_quantity(value, unit, 3)
    )


_RIG_UNITS: Final = {
    attribute.name: attribute.metadata["unit"]
    for row in (TractionRow, FilmRow)
    for attribute in attrs.fields(row)
}


@attrs.frozen(kw_only=True)
class Measured:
    """What series and statements share: the quantity, which of several values, its unit, and the scene."""

    quantity: str
    unit: str
    at: FrozenTable = attrs.field(factory=FrozenTable)
    scene: Scene | None = None


@attrs.frozen(kw_only=True)
class Series(Measured):
    """Rows of one quantity, on a bearing; none yet in a form."""

    name: str
    rows: tuple[Row, ...]
    about_uncertainty: str


@attrs.frozen(kw_only=True)
class ContactSeries(Series):
    """Rows of one quantity, on a contact in a rig."""

    rig: Rig
    data: RigData


@attrs.frozen(kw_only=True)
class Statement(Measured):
    """What was said in words; see `StatementTable`."""

    text: str
    by_whom: str
    expect: str
    by: float
    limit: float | None
    steps: tuple[Step, ...]


@attrs.frozen(kw_only=True)
class Measurement:
    """A data set that models are held against; `load_measurement` reads one from its folder.

    Attributes
    ----------
    name, description : str
        What it is called, and what it is in one line.
    references : tuple of Reference or str
        Where the values stand.
    read, by, licence, recipe : str
        How they were read, by whom, what may be done with them, how to get what is not here.
    estimated : mapping
        What the source does not state: key of the scene -> why the value it has.
    series : tuple of Series
        What was measured.
    statements : tuple of Statement
        What was said in words.
    folder : str
        Where it was read from; equal data sets may stand in different places.
    """

    name: str
    description: str
    references: tuple[Citation, ...]
    read: str
    by: str = ""
    licence: str
    recipe: str = ""
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
        """What is estimated, in one line."""
        if not self.estimated:
            return "the source states all that was needed"
        return f"estimated, since the source does not state it: {', '.join(self.estimated)}"

    @property
    def data(self) -> "Contents":
        """How much there is of each, for lists."""
        return Contents(
            rows={one.name: len(one.rows) for one in self.series}, statements=len(self.statements)
        )


@attrs.frozen(kw_only=True)
class Contents:
    """How many rows each series has, and how many statements there are."""

    rows: Mapping[str, int] = field(doc="rows of each series")
    statements: int = field(doc="statements")


#: The kind of a data set.
MEASUREMENT: Final = Kind(
    name="measurement",
    hook="measurements",
    base=Measurement,
    data=True,
    rules="rollslip_campaigns.measurement.rules",
)
