"""The account of effective friction."""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar, Final

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account, Figures, PlainAccount
from rollslip.results.words import runs_at, runs_away

if TYPE_CHECKING:
    import xarray as xr


_RUNAWAY: Final = ("runaway_slip", "runaway_drag", "runaway_status")
_STEADY: Final = ("steady_cage_slip", "steady_drag", "steady_status")


def _curves(dataset: "xr.Dataset") -> "xr.Dataset":
    """All but where the cage runs and runs away, of which each is one sentence."""
    return dataset.drop_vars((*_RUNAWAY, *_STEADY), errors="ignore")


class EffectiveFrictionAccount(PlainAccount):
    """How effective friction is told: by its curves, and by how finely it was computed."""

    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {
        "closure": ("closure: what the rollers spin at", ""),
    }

    knows_operation: ClassVar[int] = 1

    def headline(self, dataset: "xr.Dataset") -> str:
        """Return where the cage runs away."""
        if "runaway_slip" not in dataset:
            return ""
        away = (dataset[name].item() for name in _RUNAWAY)
        return runs_away(*away)

    def operation(self, dataset: "xr.Dataset") -> str:
        """Return steady slip and reserve of drag."""
        if "steady_cage_slip" not in dataset:
            return ""
        slip, drag, status = (dataset[name].item() for name in _STEADY)
        if math.isnan(slip):
            return str(status)
        reserve, known = dataset["runaway_drag"].item() / drag if drag > 0.0 else math.nan, "found"
        if "drag_reserve" in dataset:
            reserve, known = dataset["drag_reserve"].item(), dataset["reserve_status"].item()
        return runs_at(slip, dataset["runaway_slip"].item(), reserve, known)

    def topics(self, dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say where the cage runs away and runs, and what was found of each curve."""
        said = {"running away": self.headline(dataset), "steady slip": self.operation(dataset)}
        return {about: [text] for about, text in said.items() if text} | super().topics(_curves(dataset))

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Return where the cage runs away and runs, and what was found of each curve."""
        return [*self.known_better(dataset), *super().sentences(_curves(dataset))]

    def known_better(self, dataset: "xr.Dataset") -> list[str]:
        """Return where the cage runs away and runs."""
        return [text for text in (self.headline(dataset), self.operation(dataset)) if text]

    def lines(self, dataset: "xr.Dataset") -> list[str]:
        """Return what is said on a terminal."""
        said, a = [*self.known_better(dataset), *super().lines(_curves(dataset))], dataset.attrs
        if "instants_error" in a:
            slices = a.get("slices_error", 0.0)  # one slice under an even load leaves none
            said.append(
                f"{a['instants']} instants of a pitch and {a['slices']} slices of a roller leave relative errors of "
                f"about {a['instants_error']:.1e} and {slices:.1e}; residual of the forces {a['force_residual']:.1e}"
            )
        return said

    def figures(self, dataset: "xr.Dataset") -> Figures:
        """Draw the curves, the single rollers and the map."""
        from rollslip_studies.effective_friction.figures import figures

        yield from figures(dataset)


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [EffectiveFrictionAccount("effective-friction")]
