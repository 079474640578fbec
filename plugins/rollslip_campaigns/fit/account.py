"""The account of a fit."""

from typing import TYPE_CHECKING, Any, ClassVar

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account, Figures, Table
from rollslip_campaigns.fit import findings

if TYPE_CHECKING:
    import xarray as xr


class FitAccount(Account):
    """How a fit is told: with a table of its parameters."""

    names_first: ClassVar[bool] = True

    def topics(self, dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say what was found, by what it is about."""
        return findings.topics(dataset)

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Return all that is said."""
        return [f"{name}: {text}" for name, (text,) in self.topics(dataset).items()]

    def lines(self, dataset: "xr.Dataset") -> list[str]:
        """Return what is said on a terminal beside the table."""
        return findings.notes(dataset)

    def record(self, dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the single values."""
        return findings.record(dataset)

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return the parameters with their errors and intervals."""
        return [Table("", findings.HEAD, [list(row) for row in findings.parameter_rows(dataset)])]

    def figures(self, dataset: "xr.Dataset") -> Figures:
        """Draw friction, residuals and profiles."""
        from rollslip_campaigns.fit.figures import figures

        yield from figures(dataset)


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [FitAccount("fit")]
