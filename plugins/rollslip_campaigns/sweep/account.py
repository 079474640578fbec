"""The account of a sweep."""

from typing import TYPE_CHECKING

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account
from rollslip_campaigns.sweep import findings

if TYPE_CHECKING:
    import xarray as xr


class SweepAccount(Account):
    """How a sweep is told: by the range of every output."""

    topics = staticmethod(findings.topics)
    record = staticmethod(findings.record)
    drawn = "rollslip_campaigns.sweep.figures:sweep_figures"

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Return all that is said."""
        return findings.sentences(dataset)


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [SweepAccount("sweep")]
