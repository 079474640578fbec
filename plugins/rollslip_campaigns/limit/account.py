"""The account of a search for a limit."""

from typing import TYPE_CHECKING, Any, ClassVar

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account, Figures
from rollslip_campaigns.limit import findings

if TYPE_CHECKING:
    import xarray as xr


class LimitAccount(Account):
    """How it is told where a limit is kept."""

    names_first: ClassVar[bool] = True

    def headline(self, dataset: "xr.Dataset") -> str:
        """Return where the limit is kept."""
        return findings.headline(dataset)

    def topics(self, dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say what was found, by what it is about."""
        return findings.topics(dataset)

    def record(self, dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the single values."""
        return findings.record(dataset)

    def figures(self, dataset: "xr.Dataset") -> Figures:
        """Draw the result over what is searched."""
        from rollslip_campaigns.limit.figures import limit_figures

        yield from limit_figures(dataset)


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [LimitAccount("limit")]
