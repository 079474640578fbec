"""The account of an allowable slip and its margin."""

from typing import TYPE_CHECKING, Any

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account, Figures
from rollslip_campaigns.uncertainty import findings

if TYPE_CHECKING:
    import xarray as xr


class UncertaintyAccount(Account):
    """How slips of scattering data are told."""

    def headline(self, dataset: "xr.Dataset") -> str:
        """Return the reserve of drag, or where the cage runs away."""
        return findings.headline(dataset)

    def chance(self, dataset: "xr.Dataset") -> str:
        """Return how probably the cage runs below the slip at which it runs away, where steady slips were sampled."""
        return findings.margin(dataset) if "margin" in dataset else ""

    def untold(self, dataset: "xr.Dataset | None") -> str:
        """Return how to know what scatter does."""
        if dataset is not None and "margin" in dataset:
            return ""
        return "how probably scatter of the data makes the cage run away (rollslip uncertainty SCENE)"

    def topics(self, dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say what was found, by what it is about."""
        return findings.topics(dataset)

    def record(self, dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the single values."""
        return findings.record(dataset)

    def figures(self, dataset: "xr.Dataset") -> Figures:
        """Draw margin, indices and convergence."""
        from rollslip_campaigns.uncertainty.figures import uncertainty_figures

        yield from uncertainty_figures(dataset)


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [UncertaintyAccount("uncertainty")]
