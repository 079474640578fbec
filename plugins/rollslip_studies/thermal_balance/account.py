"""The account of a thermal balance."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

import attrs

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account
from rollslip.results.answer import Answer
from rollslip_studies.steady_slip.account import next_of_others
from rollslip_studies.thermal_balance import findings

if TYPE_CHECKING:
    import xarray as xr


class ThermalBalanceAccount(Account):
    """How bulk temperatures are told."""

    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {
        "thermal": ("thermal model", ""),
        "evaluated_temperatures": ("temperatures at which a steady slip was sought", ""),
    }
    units: ClassVar[Mapping[str, str]] = {"temperatures": "K"}

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return temperatures and slip in balance; the slip at those of the scene another study knows."""
        return attrs.evolve(findings.answer(dataset), commands=next_of_others(dataset))

    topics = staticmethod(findings.topics)

    record = staticmethod(findings.record)

    drawn = "rollslip_studies.thermal_balance.figures:thermal_figures"


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [ThermalBalanceAccount("thermal-balance")]
