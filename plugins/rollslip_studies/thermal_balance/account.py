"""The account of a thermal balance."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account, Figures
from rollslip_studies.thermal_balance import findings

if TYPE_CHECKING:
    import xarray as xr


class ThermalBalanceAccount(Account):
    """How bulk temperatures are told."""

    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {
        "thermal": ("thermal model", ""),
        "evaluated_temperatures": ("temperatures at which a steady slip was sought", ""),
    }

    def headline(self, dataset: "xr.Dataset") -> str:
        """Return that there is no balance, where that is so."""
        return findings.headline(dataset)

    def topics(self, dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say what was found, by what it is about."""
        return findings.topics(dataset)

    def record(self, dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the single values."""
        return findings.record(dataset)

    def figures(self, dataset: "xr.Dataset") -> Figures:
        """Draw the excess heat, and temperatures over time."""
        from rollslip_studies.thermal_balance.figures import thermal_figures

        yield from thermal_figures(dataset)


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [ThermalBalanceAccount("thermal-balance")]
