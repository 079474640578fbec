"""The account of effective friction."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account, Figures, PlainAccount

if TYPE_CHECKING:
    import xarray as xr


class EffectiveFrictionAccount(PlainAccount):
    """How effective friction is told: by its curves, and by how finely it was computed."""

    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {
        "closure": ("closure: what the rollers spin at", ""),
    }

    def lines(self, dataset: "xr.Dataset") -> list[str]:
        """Return what is said on a terminal."""
        said, a = super().lines(dataset), dataset.attrs
        if "instants_error" in a:
            slices = a.get("slices_error", 0.0)  # one slice under an even load leaves none
            said.append(
                f"{a['instants']} instants of a pitch and {a['slices']} slices of a roller leave relative errors of "
                f"about {a['instants_error']:.1e} and {slices:.1e}; residual of the forces {a['force_residual']:.1e}"
            )
        return said

    def figures(self, dataset: "xr.Dataset") -> Figures:
        """Draw the curves, the single rollers and the map."""
        from rollslip.studies.effective_friction.figures import figures

        yield from figures(dataset)


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [EffectiveFrictionAccount("effective-friction")]
