"""The account of error against cost."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account, Figures, Table
from rollslip_campaigns.pareto import findings

if TYPE_CHECKING:
    import xarray as xr


class ParetoAccount(Account):
    """How a family of choices is told: with a table for each study; what nothing dominates has a star."""

    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {
        "rounds": ("rounds in which choices were timed", ""),
    }

    def topics(self, dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say what was found, by what it is about."""
        return {"found": findings.findings(dataset)}

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Return all that is said."""
        return findings.findings(dataset)

    def record(self, dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the single values."""
        return findings.record(dataset)

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return the choices of each study, with their times and errors."""
        return [Table(*table) for table in findings.tables(dataset)]

    def figures(self, dataset: "xr.Dataset") -> Figures:
        """Draw the front of each result."""
        from rollslip_campaigns.pareto.figures import front_figures

        yield from front_figures(dataset)


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [ParetoAccount("pareto")]
