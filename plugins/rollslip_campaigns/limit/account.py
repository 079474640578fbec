"""The account of a search for a limit."""

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account
from rollslip_campaigns.limit import findings


class LimitAccount(Account):
    """How it is told where a limit is kept."""

    answer = staticmethod(findings.answer)
    topics = staticmethod(findings.topics)
    record = staticmethod(findings.record)
    drawn = "rollslip_campaigns.limit.figures:limit_figures"


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [LimitAccount("limit")]
