"""The account of damage."""

from typing import TYPE_CHECKING, Any, ClassVar

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account, Figures
from rollslip_studies.surface_damage import findings

if TYPE_CHECKING:
    import xarray as xr


class SurfaceDamageAccount(Account):
    """How measures of damage are told."""

    most_important: ClassVar[int] = 6

    def harm(self, dataset: "xr.Dataset") -> str:
        """Return which measures are beyond their limits."""
        return findings.harm(dataset)

    def topics(self, dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say what was found, measure by measure."""
        return findings.topics(dataset)

    def record(self, dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the single values."""
        return findings.record(dataset)

    def figures(self, dataset: "xr.Dataset") -> Figures:
        """Draw the measures over the orbit and across the worst contacts."""
        from rollslip_studies.surface_damage.figures import damage_figures

        yield from damage_figures(dataset)


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [SurfaceDamageAccount("surface-damage")]
