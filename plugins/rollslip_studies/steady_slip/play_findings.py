"""Rows and sentences on the play of rollers: in the pockets of a cage, and in a set of rollers without a cage."""

import math

from rollslip.results.answer import Row
from rollslip.results.dataset import xr
from rollslip.results.text import percent
from rollslip.units import format_quantity


def play_row(dataset: "xr.Dataset") -> Row | None:
    """Return the row of the slip with play in the pockets; None if it was not requested."""
    if "slip_with_play" not in dataset:
        return None
    slip = float(dataset["slip_with_play"])
    is_known = math.isfinite(slip)
    return Row(
        key="slip_with_play",
        label="slip with play",
        value=slip,
        text=percent(slip) if is_known else "not found",
        note="verdict and other rows are of rollers without play"
        if is_known
        else str(dataset["play_status"].item()),
    )


def describe_play(dataset: "xr.Dataset") -> list[str]:
    """Return the slip that the play of rollers without a cage adds at most."""
    if math.isnan(slower := float(dataset.attrs.get("slower_by_play", math.nan))):
        return []
    play = format_quantity(float(dataset.attrs["train_play"]), "m", 2)
    return [
        f"without a cage loaded rollers run ahead until the play of {play} is used up; then they slide with the set, "
        f"which is slower by up to about another {_percent(slower)} than that slip"
    ]


def describe_pockets(dataset: "xr.Dataset") -> list[str]:
    """Return the slip with play in the pockets beside that without, or why there is none; empty if not requested."""
    if "slip_with_play" not in dataset:
        return []
    slip = float(dataset["slip_with_play"])
    if math.isnan(slip):
        return [f"no slip with play in the pockets: {dataset['play_status'].item()}"]
    return [
        f"with play in the pockets the cage slip is {_percent(slip)}, with rollers set in the cage "
        f"{_percent(float(dataset['steady_slip'][0]))}: a roller drives the cage for "
        f"{_percent(float(dataset['driving_fraction']))} of a turn only"
    ]


def _percent(fraction: float) -> str:
    """Return a fraction in per cent with three digits."""
    return f"{100.0 * fraction:.3g} %"
