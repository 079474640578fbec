"""The account of steady slips."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account, Figures
from rollslip_studies.steady_slip import findings

if TYPE_CHECKING:
    import xarray as xr


class SteadySlipAccount(Account):
    """How steady slips are told."""

    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {
        "inertia_effect": ("relative effect of the inertia of the rollers' spin", "1"),
        "curve_error": ("relative error left by the points of the slip-drag curve, estimated", "1"),
        "friction": ("friction of the motion", ""),
    }

    knows_operation: ClassVar[int] = 2
    most_important: ClassVar[int] = 3

    def headline(self, dataset: "xr.Dataset") -> str:
        """Return where the cage runs away."""
        return findings.headline(dataset)

    def operation(self, dataset: "xr.Dataset") -> str:
        """Return steady slip, reserve of drag, and the least load of an acceptable slip."""
        return findings.operation(dataset)

    def untold(self, dataset: "xr.Dataset | None") -> str:
        """Return how to know the load that a slip takes."""
        if dataset is not None and "least_load" in dataset:
            return ""
        return (
            "the least load of a cage slip, of 5 % for example, beside what makers ask for (--study steady-slip --set "
            "study.steady-slip.acceptable_slip=0.05)"
        )

    def topics(self, dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say what was found, by what it is about."""
        return findings.topics(dataset)

    def record(self, dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the single values."""
        return findings.record(dataset)

    def figures(self, dataset: "xr.Dataset") -> Figures:
        """Draw torques, orbit and the slips that were followed."""
        from rollslip_studies.steady_slip.figures import steady_figures

        yield from steady_figures(dataset)


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [SteadySlipAccount("steady-slip")]
