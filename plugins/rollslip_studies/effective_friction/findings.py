"""The account of effective friction."""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar, Final

from rollslip.results.accounts import PlainAccount
from rollslip.results.answer import Answer, assumed_of
from rollslip.results.words import Status, describe_running, describe_skidding
from rollslip_studies.steady_slip.findings import (
    UNCOMPUTED_MINIMUM_LOAD,
    next_of_others,
    reserve_row,
    slip_row,
)

if TYPE_CHECKING:
    import xarray as xr


_SKIDDING: Final = ("skidding_slip", "limit_drag", "skidding_status")
_STEADY: Final = ("steady_cage_slip", "steady_drag", "steady_status")
#: What slip and reserve may be off those of every slice, relative: docs/tables/skidding_effective_summary.csv.
_WITHIN: Final = 0.25


def _curves(dataset: "xr.Dataset") -> "xr.Dataset":
    """All but where the cage runs and runs away, of which each is one sentence."""
    return dataset.drop_vars((*_SKIDDING, *_STEADY), errors="ignore")


def _describe_skidding(dataset: "xr.Dataset") -> str:
    """Say where the cage runs away; nothing where that was not asked for."""
    return (
        describe_skidding(*(dataset[name].item() for name in _SKIDDING))
        if "skidding_slip" in dataset
        else ""
    )


def _runs(dataset: "xr.Dataset") -> str:
    """Say steady slip and reserve of drag; nothing where they were not asked for."""
    if "steady_cage_slip" not in dataset:
        return ""
    slip, drag, status = (dataset[name].item() for name in _STEADY)
    if math.isnan(slip):
        return str(status)
    reserve = dataset["limit_drag"].item() / drag if drag > 0.0 else math.nan
    known = str(Status.FOUND)
    if "drag_reserve" in dataset:
        reserve = dataset["drag_reserve"].item()
        known = dataset["reserve_status"].item()
    return describe_running(slip, dataset["skidding_slip"].item(), reserve, known)


class EffectiveFrictionAccount(PlainAccount):
    """How effective friction is told: by its curves, and by how finely it was computed."""

    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {
        "closure": ("closure: what the rollers spin at", ""),
    }
    units: ClassVar[Mapping[str, str]] = {"critical_slip": "1"}

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return slip and reserve of drag, which a study of steady slips knows better."""
        if "steady_cage_slip" not in dataset:
            return Answer(commands=next_of_others(dataset))
        slip = dataset["steady_cage_slip"].item()
        status = dataset["steady_status"].item()
        rows = [
            slip_row(dataset, slip, str(status), known=1, within=_WITHIN),
            UNCOMPUTED_MINIMUM_LOAD,
        ]
        if "drag_reserve" in dataset:
            reserve = dataset["drag_reserve"].item(), str(dataset["reserve_status"].item())
            rows.append(reserve_row(*reserve, known=1, within=_WITHIN, slip=slip))
        return Answer(
            rows=tuple(rows), assumed=assumed_of(dataset), commands=next_of_others(dataset)
        )

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say where the cage runs away and runs, and what was found of each curve."""
        said = {"skidding": _describe_skidding(dataset), "steady slip": _runs(dataset)}
        return {about: [text] for about, text in said.items() if text} | PlainAccount.topics(
            _curves(dataset)
        )

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Return where the cage runs away and runs, and what was found of each curve."""
        return [
            *filter(None, (_describe_skidding(dataset), _runs(dataset))),
            *super().sentences(_curves(dataset)),
        ]

    def lines(self, dataset: "xr.Dataset") -> list[str]:
        """Return what is said on a terminal."""
        said = [
            *filter(None, (_describe_skidding(dataset), _runs(dataset))),
            *super().lines(_curves(dataset)),
        ]
        a = dataset.attrs
        if {"positions_error", "resolution"} <= a.keys():
            slices = a.get("slices_error", 0.0)  # one slice under an even load leaves none
            said.append(
                f"{a['n_positions']} roller positions within a pitch and {a['slices']} "
                "slices of a roller leave relative "
                f"errors of about {a['positions_error']:.1e} and {slices:.1e}; residual of the forces "
                f"{a['force_residual']:.1e}"
            )
        return said

    drawn = ".figures:figures"


ACCOUNT: Final = EffectiveFrictionAccount("effective-friction")
