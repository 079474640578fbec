"""What an account is: how the results of one study or campaign are told, in words, as plain values, tables and figures.

- Console, report, figures and JSON ask `rollslip.results.accounts` for it and know no study by name. It is found by the
  dataset's attribute ``study`` among the entry points ``rollslip.account``, our own like a stranger's.
- Everything is told from the dataset alone, so that a stored result is told alike years later.
- An account is imported for words alone too: what loads Matplotlib is imported where figures are drawn.
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

__all__ = ["ACCOUNT", "Account", "Contact", "Figures", "Sheet", "Story", "Table"]


@attrs.frozen
class Table:
    """A table of a result: what it is called, its head, and its rows of texts."""

    caption: str
    head: tuple[str, ...]
    rows: list[list[str]]


@attrs.frozen
class Contact:
    """A contact that a result speaks of: its film regime if it is one all along, and its smallest film parameter."""

    name: str
    regime: str
    film_parameter: float


#: What was found, in the order of a report: texts, lists of sentences without their full stops, tables.
Story: TypeAlias = list[str | list[str] | Table]
#: Head and rows of a spreadsheet: numbers and texts; None where there is no value.
Sheet: TypeAlias = tuple[list[str], list[list[Any]]]
#: Name, caption and figure of all that a result has something to show for.
Figures: TypeAlias = "Iterator[tuple[str, str, Figure]]"


@attrs.frozen
class Account:
    """How the results of one study are told; a study or campaign derives a class of its own from this one.

    What is left out is told by nothing: `topics` or `sentences`, `record` and `figures` are what there should be.
    """

    name: str  #: The study, as the attribute ``study`` of its datasets has it.
    #: Attributes of its datasets that are numbers of interest: what each is called, and its unit.
    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {}
    #: Keys of its records whose numbers are no variables and none of `numbers`: the unit of each.
    units: ClassVar[Mapping[str, str]] = {}
    #: Function that draws its figures: "module:function", ".module:function" beside its class, or empty for none.
    drawn: ClassVar[str] = ""

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return what has to be known first: rows of quantities, what is assumed, and commands by verdict."""
        return Answer()

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say what was found, by what it is about, the most important first; no sentence has its full stop."""
        return {}

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Return all that is said; no sentence has its full stop."""
        return [text for texts in self.topics(dataset).values() for text in texts]

    def lines(self, dataset: "xr.Dataset") -> list[str]:
        """Return what is said on a terminal."""
        return self.sentences(dataset)

    def paragraph(self, dataset: "xr.Dataset") -> str:
        """Return all that is said as one text, for those who cannot see the figures."""
        return " ".join(f"{capitalise(text)}." for text in self.sentences(dataset))

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the single values as JSON has them; what has no value is None, with its status beside it."""
        return {}

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return what is told in tables."""
        return []

    def sheets(self, dataset: "xr.Dataset") -> dict[str, Sheet]:
        """Return head and rows of what a spreadsheet gets, by name; nothing for rows of an answer or of each point."""
        return {}

    def story(self, dataset: "xr.Dataset") -> Story:
        """Return what a report says was found."""
        return [self.sentences(dataset), *self.tables(dataset)]

    def figures(self, dataset: "xr.Dataset") -> "Figures":
        """Draw the figures while they are iterated, as artists take their style; give file name, caption, figure."""
        if self.drawn:
            module, _, function = self.drawn.partition(":")
            beside = type(self).__module__.rpartition(".")[0]
            yield from getattr(import_module(module, beside), function)(dataset)

    def contacts(self, dataset: "xr.Dataset") -> list[Contact]:
        """Return the contacts that the load parameters of the dataset are of, in their order."""
        return []


#: The kind of an account; packages that offer studies offer theirs.
ACCOUNT: Final = Kind(name="account", hook="accounts", base=Account, data=True, listed=False)
