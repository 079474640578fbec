"""The account of an allowable slip and its margin."""

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account
from rollslip_campaigns.uncertainty import findings


class UncertaintyAccount(Account):
    """How slips of scattering data are told."""

    answer = staticmethod(findings.answer)
    topics = staticmethod(findings.topics)
    record = staticmethod(findings.record)
    drawn = "rollslip_campaigns.uncertainty.figures:uncertainty_figures"


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [UncertaintyAccount("uncertainty")]
