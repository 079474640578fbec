"""The account of a fit."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account, Table
from rollslip_campaigns.fit import findings

if TYPE_CHECKING:
    import xarray as xr


class FitAccount(Account):
    """How a fit is told: with a table of its parameters."""

    topics = staticmethod(findings.topics)

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Return all that is said."""
        return [f"{name}: {text}" for name, (text,) in self.topics(dataset).items()]

    def lines(self, dataset: "xr.Dataset") -> list[str]:
        """Return what is said on a terminal beside the table."""
        return findings.notes(dataset)

    units: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("chi2", "correlation", "freedom", "operating_points", "rows", "scatter", "spread"), "1"
    )
    record = staticmethod(findings.record)

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return the parameters with their errors and intervals."""
        return [Table("", findings.HEAD, [list(row) for row in findings.parameter_rows(dataset)])]

    drawn = "rollslip_campaigns.fit.figures:figures"


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [FitAccount("fit")]
