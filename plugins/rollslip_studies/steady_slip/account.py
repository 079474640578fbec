"""The account of steady slips."""

from collections.abc import Mapping
from typing import ClassVar

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account
from rollslip_studies.steady_slip import findings
from rollslip_studies.steady_slip.rows import answer


class SteadySlipAccount(Account):
    """How steady slips are told."""

    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {
        "inertia_effect": ("relative effect of the inertia of the rollers' spin", "1"),
        "curve_error": ("relative error left by the points of the slip-drag curve, estimated", "1"),
        "friction": ("friction of the motion", ""),
    }

    answer = staticmethod(answer)
    topics = staticmethod(findings.topics)

    record = staticmethod(findings.record)

    drawn = "rollslip_studies.steady_slip.figures:steady_figures"


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [SteadySlipAccount("steady-slip")]
