"""The account of a friction curve."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account, Figures, PlainAccount

if TYPE_CHECKING:
    import xarray as xr


class FrictionCurveAccount(PlainAccount):
    """How friction of one contact is told: by its curves."""

    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {
        "ring": ("ring", ""),
        "rolling_speed": ("entrainment speed", "m/s"),
    }

    def figures(self, dataset: "xr.Dataset") -> Figures:
        """Draw the curves."""
        from rollslip_studies.friction_curve.figures import figures

        yield from figures(dataset)


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [FrictionCurveAccount("friction-curve")]
