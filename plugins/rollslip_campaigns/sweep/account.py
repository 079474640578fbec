"""The account of a sweep."""

from typing import TYPE_CHECKING, Any, ClassVar

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account, Figures
from rollslip_campaigns.sweep import findings

if TYPE_CHECKING:
    import xarray as xr


class SweepAccount(Account):
    """How a sweep is told: by the range of every output."""

    names_first: ClassVar[bool] = True

    def topics(self, dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say what was found, by what it is about."""
        return findings.topics(dataset)

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Return all that is said."""
        return findings.sentences(dataset)

    def record(self, dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the single values."""
        return findings.record(dataset)

    def figures(self, dataset: "xr.Dataset") -> Figures:
        """Draw a map of the critical slip, and models against the scatter of the data."""
        from rollslip_campaigns.sweep.figures import sweep_figures

        yield from sweep_figures(dataset)


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [SweepAccount("sweep")]
