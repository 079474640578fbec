"""The account of a comparison of models."""

from typing import TYPE_CHECKING

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account, Story, Table, account_of
from rollslip.results.curves import curve_names
from rollslip_campaigns.comparison import findings

if TYPE_CHECKING:
    import xarray as xr


class ComparisonAccount(Account):
    """How models beside one another are told: with a table for each curve."""

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say what was found, by what it is about."""
        return {
            f"{label}, {name}": texts
            for label, one in findings.members(dataset)
            for name, texts in account_of(one).topics(one).items()
            if name in curve_names(dataset)  # not what is single only for one combination
        }

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Return all that is said."""
        return findings.findings(dataset)

    record = staticmethod(findings.record)

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return a table for each curve."""
        tables = findings.tables(dataset)
        return [Table(findings.captioned(dataset, name), head, rows) for name, head, rows in tables]

    def story(self, dataset: "xr.Dataset") -> Story:
        """Return what was found, with the differences bin by bin."""
        exchanged = dataset.attrs["exchanged"]
        bins = [
            Table(f"{name}: relative differences by regime", head, rows)
            for name, head, rows in findings.bin_tables(dataset)
        ]
        return [*([f"{exchanged}."] if exchanged else []), *self.tables(dataset), self.sentences(dataset), *bins]

    drawn = "rollslip_campaigns.comparison.figures:figures"


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [ComparisonAccount("comparison")]
