"""What an account is: how the results of one study or campaign are told, in words, as plain values, tables and figures.

- Console, report, figures and JSON ask `account_of` for it and know no study by name. It is found by the dataset's
  attribute ``study`` among the entry points ``rollslip.account``, our own like a stranger's.
- Everything is told from the dataset alone, so that a stored result is told alike years later.
- A study without an account is told by what its dataset says of itself: friction curves where attribute ``curves`` says
  what they are, and single values by name, unit and status.
- An account is imported for words alone too: what loads Matplotlib is imported where figures are drawn.
"""

import math
from collections.abc import Hashable, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Final, TypeAlias

import attrs

from rollslip.catalogue.kinds import Kind
from rollslip.catalogue.registry import available, get_class
from rollslip.results.curves import Curves, critical_rows, curves
from rollslip.units import UnitError, format_quantity

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

__all__ = [
    "ACCOUNT", "Account", "Contact", "PlainAccount", "Story", "Table", "account_of", "capital", "headline_of",
    "told_elsewhere", "untold", "with_unit",
]  # fmt: skip


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


#: Values of a variable that are told one by one, at most.
_FEW: Final = 8
#: What was found, in the order of a report: texts, lists of sentences without their full stops, tables.
Story: TypeAlias = list[str | list[str] | Table]
#: Name, caption and figure of all that a result has something to show for.
Figures: TypeAlias = "Iterator[tuple[str, str, Figure]]"


@attrs.frozen
class Account:
    """How the results of one study are told; a study or campaign derives a class of its own from this one.

    What is left out is told by nothing: `topics` or `sentences`, `record` and `figures` are what there should be.

    Attributes
    ----------
    name : str
        The study, as the attribute ``study`` of its datasets has it.
    numbers : mapping of str to tuple of str
        Attributes of its datasets that are numbers of interest: what each is called, and its unit.
    names_first : bool
        Whether sentences begin with names, which keep their small letters.
    knows_operation : int
        How much it knows of how the bearing runs: of several results that of the largest speaks.
    most_important : int
        How many of its `lines` a short form has, the first ones.
    """

    name: str
    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {}
    names_first: ClassVar[bool] = False
    knows_operation: ClassVar[int] = 0
    most_important: ClassVar[int] = 2

    def headline(self, dataset: "xr.Dataset") -> str:
        """Return what has to be known before all else, without its full stop; nothing where there is no such thing."""
        return ""

    def operation(self, dataset: "xr.Dataset") -> str:
        """Return how the bearing runs, and with what reserve, without its full stop; nothing where it is not known."""
        return ""

    def known_better(self, dataset: "xr.Dataset") -> list[str]:
        """Return which of its sentences one that knows more of how the bearing runs tells in place of it."""
        return []

    def chance(self, dataset: "xr.Dataset") -> str:
        """Return how probably the cage does not run away where data scatter; nothing where it is not known."""
        return ""

    def harm(self, dataset: "xr.Dataset") -> str:
        """Return which limits of its surfaces a bearing passes, without its full stop; nothing where it passes none."""
        return ""

    def untold(self, dataset: "xr.Dataset | None") -> str:
        """Return what its study would add to a verdict, with what to type, where it did not run or does not say it."""
        return ""

    def topics(self, dataset: "xr.Dataset") -> dict[str, list[str]]:
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
        return " ".join(f"{text if self.names_first else capital(text)}." for text in self.sentences(dataset))

    def record(self, dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the single values as JSON has them; what has no value is None, with its status beside it."""
        return {}

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return what is told in tables."""
        return []

    def story(self, dataset: "xr.Dataset") -> Story:
        """Return what a report says was found."""
        return [self.sentences(dataset), *self.tables(dataset)]

    def figures(self, dataset: "xr.Dataset") -> "Figures":
        """Draw the figures; give name of the file, caption and figure of each.

        Artists take their style when they are made: figures are drawn while they are iterated.
        """
        yield from ()

    def contacts(self, dataset: "xr.Dataset") -> list[Contact]:
        """Return the contacts that the load parameters of the dataset are of, in their order."""
        return []


class PlainAccount(Account):
    """How a dataset is told by what it says of itself: its friction curves, and its single values."""

    names_first: ClassVar[bool] = True

    def topics(self, dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say what was found of each curve, and every single value."""
        slips = {
            name: [row["status"] if row["critical_slip"] is None else _critical(dataset, row)]
            for name, row in critical_rows(dataset).items()
        }
        return slips | {name: [text] for name, text in _single_values(dataset).items()}

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Return what was found of each curve, and every single value."""
        return [curve.finding() for curve in curves(dataset)] + _named(_single_values(dataset))

    def lines(self, dataset: "xr.Dataset") -> list[str]:
        """Return critical slip and largest friction of each curve, and every single value."""
        slips = {
            curve.name: f"critical slip {curve.critical_slip:.2%} {curve.rests_on}".rstrip()
            + f", largest friction {curve.critical_friction:.4g}"
            if curve.has_critical
            else curve.status
            for curve in curves(dataset)
        }
        for curve in curves(dataset):
            if curve.falls_before:
                slips[curve.name] += (
                    f"; friction falls already from a slip of {curve.first_slip:.2%} on, then rises again"
                )
        return _named(slips | _single_values(dataset))

    def record(self, dataset: "xr.Dataset") -> dict[str, Any]:
        """Return critical slip, largest friction and status of each curve, and every single value."""
        singles: dict[str, Any] = {}
        for name in map(str, dataset.data_vars):
            for _, at in _places(dataset, name):
                value = dataset[name].isel(at).item()
                value = None if isinstance(value, float) and not math.isfinite(value) else value
                if at:
                    (dim, k), *_ = at.items()
                    singles.setdefault(name, {})[str(dataset[dim].to_numpy()[k])] = value
                else:
                    singles[name] = value
        return critical_rows(dataset) | singles

    def figures(self, dataset: "xr.Dataset") -> "Figures":
        """Draw the curves, if there are any."""
        if curves(dataset):
            from rollslip.results.curve_figures import plain_curves

            yield self.name, f"Friction over slip, {self.name}.", plain_curves(dataset)

    def contacts(self, dataset: "xr.Dataset") -> list[Contact]:
        """Return the contacts that the curves are of."""
        return [
            Contact(one.name, one.regime, float(one.film_parameter[one.film_parameter > 0.0].min(initial=math.inf)))
            for one in curves(dataset)
        ]


def headline_of(datasets: "Iterable[xr.Dataset]") -> str:
    """Return the headline of the result that knows most of how the bearing runs; nothing if none has one."""
    told = sorted(((account_of(d), d) for d in datasets), key=lambda one: -one[0].knows_operation)
    return next(filter(None, (account.headline(dataset) for account, dataset in told)), "")


def told_elsewhere(datasets: "Iterable[xr.Dataset]") -> set[str]:
    """Return sentences of results beside which another one knows it better: one number is told once."""
    told = [(account_of(dataset), dataset) for dataset in datasets]
    most = max((account.knows_operation for account, _ in told), default=0)
    return {text for account, dataset in told if account.knows_operation < most
            for text in account.known_better(dataset)}  # fmt: skip


def untold(datasets: "Iterable[xr.Dataset]") -> list[str]:
    """Return what studies and campaigns that some results are not of would add to their verdict."""
    there = {str(dataset.attrs.get("study", "")): dataset for dataset in datasets}
    accounts: Iterator[Account] = (get_class("account", name) for name in available("account"))
    return [text for account in accounts if (text := account.untold(there.get(account.name)))]


def account_of(dataset: "xr.Dataset") -> Account:
    """Return how a dataset is told: the account of its study, or one that knows no more than the dataset says."""
    name = str(dataset.attrs.get("study", ""))
    if name not in available("account"):
        return PlainAccount(name)
    account: Account = get_class("account", name)
    return account


def capital(text: str) -> str:
    """Return a text with a capital as its first letter."""
    return f"{text[:1].upper()}{text[1:]}"


def _critical(dataset: "xr.Dataset", row: Mapping[str, Any]) -> str:
    """Critical slip of a curve, and what the curve rests on."""
    return f"critical slip {row['critical_slip']:.2%} {dataset.attrs.get('curves_with', '')}".rstrip()


def _named(texts: Mapping[str, str]) -> list[str]:
    return [f"{name}: {text}" for name, text in texts.items()]


def _single_values(dataset: "xr.Dataset") -> dict[str, str]:
    """Every single number and text by its long name; in place of a number that is not there, its status.

    A variable with one value for each of a few names, of the rings for example, gives a line for each.
    """
    found = {}
    for name in map(str, dataset.data_vars):
        for label, at in _places(dataset, name):
            one = dataset[name].isel(at)
            value, said_by = one.item(), next((s for s in (f"{name}_status", "status") if s in dataset), None)
            if isinstance(value, float):
                status = None if said_by is None else dataset[said_by]
                missing = "no value" if status is None else str(status.isel(at if status.ndim else {}).item())
                said = with_unit(value, one.attrs.get("units", "1")) if math.isfinite(value) else missing
            elif name.endswith("_status") and name.removesuffix("_status") in dataset:
                continue  # said where the value is missing
            else:
                said = str(value)
            found[f"{one.attrs.get('long_name', name)}{label}"] = said
    return found


def _places(dataset: "xr.Dataset", name: str) -> "list[tuple[str, dict[Hashable, int]]]":
    """Where a variable has single values, and what tells them apart; nowhere if it has many or curves speak for it."""
    variable = dataset[name]
    if variable.ndim == 0:
        return [("", {})]
    dim = variable.dims[0]
    if (
        variable.ndim > 1
        or Curves.of(dataset) is not None
        or dim not in dataset.coords
        or dataset[dim].dtype.kind not in "UO"
        or variable.size > _FEW
    ):
        return []
    return [(f", {value} {dim}", {dim: k}) for k, value in enumerate(dataset[dim].to_numpy())]


def with_unit(value: float, unit: str) -> str:
    """Return a value of a result as people read it."""
    try:
        return format_quantity(value, unit, 4)
    except UnitError:  # a unit for which there is no other way to write it
        return f"{value:.4g} {unit.partition(',')[0]}"


#: The kind of an account; packages that offer studies offer theirs.
ACCOUNT: Final = Kind(name="account", hook="accounts", base=Account, data=True)
