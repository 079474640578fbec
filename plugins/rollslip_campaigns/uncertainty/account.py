"""The account of an allowable slip and its margin."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account, Table
from rollslip.results.words import two
from rollslip_campaigns.uncertainty import findings

if TYPE_CHECKING:
    import xarray as xr


class UncertaintyAccount(Account):
    """How slips of scattering data are told."""

    units: ClassVar[Mapping[str, str]] = {"probability": "1", "reserve_is_a_lower_bound_in": "1"}
    answer = staticmethod(findings.answer)
    topics = staticmethod(findings.topics)
    record = staticmethod(findings.record)
    sheets = staticmethod(findings.sheets)

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return a row for each quantity, those that people act on first, and one for each input."""

        def told(*values: float | None) -> str:
            return " to ".join("-" if value is None else two(value) for value in values)

        (head, rows), (inputs, ranks) = findings.sheets(dataset).values()
        shown = [
            [f"{name} [{unit}]" if unit else name, told(middle), told(low, high), f"{sure} {told(bound)}", told(*ends)]
            for name, unit, middle, low, high, sure, bound, *ends, _, _, _ in rows
            if any(value is not None for value in (middle, low, high, bound, *ends))
        ]
        decides = [[name, *("-" if rank is None else f"{rank:+.2f}" for rank in of)] for name, *of in ranks]
        of = [name.removeprefix(findings.RANKED) for name in inputs]
        return [
            Table(
                "quantities, - where one is beyond its range or not known",
                ("quantity", "median", "5 to 95 %", head[6], "95 % interval of that"),
                shown,
            ),
            Table("what decides, by rank correlation with", tuple(of), decides),
        ]

    drawn = "rollslip_campaigns.uncertainty.figures:uncertainty_figures"


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [UncertaintyAccount("uncertainty")]
