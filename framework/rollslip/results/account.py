"""The base class of accounts: how results of one study or campaign are reported, as text, values, tables and figures.

- Console, report, figures and JSON get accounts from `rollslip.results.accounts` and know no study by name. An account
  is found by the dataset's attribute ``study`` among the entry points ``rollslip.account``, built-in or third-party.
- Everything is computed from the dataset alone, so that a stored result is reported in the same way years later.
- An account is also imported for texts alone. Modules that load Matplotlib are imported where figures are drawn.
"""

from collections.abc import Iterator, Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Any, ClassVar, Final, TypeAlias

import attrs

from rollslip.catalogue.kinds import Kind
from rollslip.results.answer import Answer
from rollslip.results.text import capitalise

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

__all__ = ["ACCOUNT", "Account", "Contact", "Figures", "SpreadsheetRows", "Story", "Table"]


@attrs.frozen
class Table:
    """A table of a report: its caption, its head, and rows of texts."""

    caption: str
    head: tuple[str, ...]
    rows: list[list[str]]


@attrs.frozen
class Contact:
    """A contact of a result: its film regime, if it is the same everywhere, and its smallest film parameter."""

    name: str
    regime: str
    film_parameter: float


#: The findings in the order of a report: texts, lists of sentences without full stops, tables.
Story: TypeAlias = list[str | list[str] | Table]
#: Head and rows of a spreadsheet: numbers and texts; None where there is no value.
SpreadsheetRows: TypeAlias = tuple[list[str], list[list[Any]]]
#: Name, caption and figure of each figure of a result.
Figures: TypeAlias = "Iterator[tuple[str, str, Figure]]"


@attrs.frozen
class Account:
    """How the results of one study are reported; a study or campaign derives its own class from this one.

    Methods that are not overridden report nothing. An account should have `topics` or `sentences`, `record` and
    figures.
    """

    name: str  #: The study, as the attribute ``study`` of its datasets has it.
    #: Attribute of its datasets that is a number -> its name in texts, and its unit.
    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {}
    #: Key of its records that is neither a variable nor one of `numbers` -> its unit.
    units: ClassVar[Mapping[str, str]] = {}
    #: Function that draws its figures: "module:function", ".module:function" relative to its package; empty for none.
    figures_function: ClassVar[str] = ""
    #: Function that draws several of its results together, by their names; written like `figures_function`.
    together_function: ClassVar[str] = ""

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return the answer: rows of quantities, assumptions, and commands by verdict."""
        return Answer()

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Return the findings by topic, the most important first, as sentences without full stops."""
        return {}

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Return all findings, as sentences without full stops."""
        return [text for texts in self.topics(dataset).values() for text in texts]

    def lines(self, dataset: "xr.Dataset") -> list[str]:
        """Return the findings for a terminal."""
        return self.sentences(dataset)

    def paragraph(self, dataset: "xr.Dataset") -> str:
        """Return all findings as one text, for readers who cannot see the figures."""
        return " ".join(f"{capitalise(text)}." for text in self.sentences(dataset))

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the single values, for JSON; a missing value is None, and its status is another item."""
        return {}

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return the tables of a report."""
        return []

    def sheets(self, dataset: "xr.Dataset") -> dict[str, SpreadsheetRows]:
        """Return head and rows of spreadsheets, by name; empty for those of an answer or of each point."""
        return {}

    def story(self, dataset: "xr.Dataset") -> Story:
        """Return the findings for a report."""
        return [self.sentences(dataset), *self.tables(dataset)]

    def figures(self, dataset: "xr.Dataset") -> "Figures":
        """Yield file name, caption and figure; figures are drawn during the iteration, with the style of the caller."""
        yield from self._draw(self.figures_function, dataset)

    def together(self, datasets: "Mapping[str, xr.Dataset]") -> "Figures":
        """Yield the figures of several results by their names, drawn together; none where the study has none."""
        yield from self._draw(self.together_function, datasets)

    def _draw(self, name: str, results: object) -> "Figures":
        """Yield the figures of a function; none where it has no name."""
        if name:
            module, _, function = name.partition(":")
            package = type(self).__module__.rpartition(".")[0]
            yield from getattr(import_module(module, package), function)(results)

    def contacts(self, dataset: "xr.Dataset") -> list[Contact]:
        """Return the contacts of the load parameters of the dataset, in their order."""
        return []


#: The kind of an account; packages that offer studies offer theirs.
ACCOUNT: Final = Kind(name="account", hook="accounts", base=Account, data=True, listed=False)
