"""The account of a thermal balance."""

from collections.abc import Mapping
from typing import ClassVar

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account
from rollslip_studies.thermal_balance import findings


class ThermalBalanceAccount(Account):
    """How bulk temperatures are told."""

    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {
        "thermal": ("thermal model", ""),
        "evaluated_temperatures": ("temperatures at which a steady slip was sought", ""),
    }

    answer = staticmethod(findings.answer)
    topics = staticmethod(findings.topics)

    record = staticmethod(findings.record)

    drawn = "rollslip_studies.thermal_balance.figures:thermal_figures"


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [ThermalBalanceAccount("thermal-balance")]
