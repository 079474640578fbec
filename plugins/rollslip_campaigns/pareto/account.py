"""The account of error against cost."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account, Table
from rollslip_campaigns.pareto import findings

if TYPE_CHECKING:
    import xarray as xr


class ParetoAccount(Account):
    """How a family of choices is told: with a table for each study; what nothing dominates has a star."""

    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {
        "rounds": ("rounds in which choices were timed", ""),
    }
    units: ClassVar[Mapping[str, str]] = {"floors": "1"}

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say what was found, by what it is about."""
        return {"found": findings.findings(dataset)}

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Return all that is said."""
        return findings.findings(dataset)

    record = staticmethod(findings.record)

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return the choices of each study, with their times and errors."""
        return [Table(*table) for table in findings.tables(dataset)]

    drawn = "rollslip_campaigns.pareto.figures:front_figures"


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [ParetoAccount("pareto")]
