"""The account of damage."""

from typing import TYPE_CHECKING

import attrs

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account
from rollslip.results.answer import Answer
from rollslip_studies.steady_slip.account import next_of_others
from rollslip_studies.surface_damage import findings

if TYPE_CHECKING:
    import xarray as xr


class SurfaceDamageAccount(Account):
    """How measures of damage are told."""

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return the slip, which another study knows better, and the worst of every measure."""
        return attrs.evolve(findings.answer(dataset), commands=next_of_others(dataset))

    topics = staticmethod(findings.topics)

    record = staticmethod(findings.record)

    drawn = "rollslip_studies.surface_damage.figures:damage_figures"


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [SurfaceDamageAccount("surface-damage")]
