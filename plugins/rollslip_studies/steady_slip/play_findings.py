"""Rows and sentences on the play of rollers: in the pockets of a cage, and in a set of rollers without a cage."""

import math
from typing import Final

from rollslip.results.dataset import xr
from rollslip.results.text import Status, percent, precise_percent
from rollslip.units import format_quantity

#: Words on a value that is not known for rollers with play.
WITHOUT_PLAY: Final = "without play in the pockets"


def play_note(slip: float, without: float, status: str) -> str:
    """Return what the play in the pockets does to a slip, in a few words; empty where both are printed alike.

    Parameters
    ----------
    slip, without : float
        Cage slip with play, and that of rollers set in the cage.
    status : str
        What was found of the play.
    """
    if Status.of(status) in (Status.NOT_KNOWN, Status.NO_STEADY_SLIP):
        return status
    return f"without play {percent(without)}" if percent(without) != percent(slip) else ""


def steady_play_note(dataset: "xr.Dataset", slip_name: str) -> str:
    """Return what the play in the pockets does to a steady slip of a dataset; that it has none without the play.

    Parameters
    ----------
    dataset : Dataset
        With the slip, and what was found of the play where there is any.
    slip_name : str
        Name of the slip.
    """
    if "play_status" not in dataset:
        return WITHOUT_PLAY
    without = float(dataset["slip_without_play"])
    return play_note(float(dataset[slip_name]), without, str(dataset["play_status"].item()))


def slip_without_play(dataset: "xr.Dataset") -> str:
    """Return the slip of rollers set in the cage where it is printed otherwise than that with play; else empty."""
    if "play_status" not in dataset or dataset["play_status"].item() != Status.FOUND:
        return ""
    without = float(dataset["slip_without_play"])
    return play_note(float(dataset["steady_slip"][0]), without, Status.FOUND)


def assumed_without_play(dataset: "xr.Dataset") -> tuple[str, ...]:
    """Return why the slip is that of rollers set in the cage though they have play; empty where it is not."""
    status = str(dataset["play_status"].item()) if "play_status" in dataset else ""
    reason = status.partition(": ")[2]
    is_left_out = Status.of(status) is Status.NOT_KNOWN
    return (f"no play in the pockets: {reason}",) if is_left_out else ()


def describe_play(dataset: "xr.Dataset") -> list[str]:
    """Return the slip that the play of rollers without a cage adds at most."""
    if math.isnan(slower := float(dataset.attrs.get("slower_by_play", math.nan))):
        return []
    play = format_quantity(float(dataset.attrs["train_play"]), "m", 2)
    return [
        f"without a cage loaded rollers run ahead until the play of {play} is used up; then they slide with the set, "
        f"which is slower by up to about another {precise_percent(slower)} than that slip"
    ]


def describe_pockets(dataset: "xr.Dataset") -> list[str]:
    """Return what the play in the pockets does to the slip, or why it is left out; empty if it was not asked for."""
    if "play_status" not in dataset:
        return []
    slip = float(dataset["slip_without_play"])
    if dataset["play_status"].item() != Status.FOUND:
        return [f"play in the pockets is left out: {dataset['play_status'].item()}"]
    return [
        f"without play in the pockets the cage slip would be {precise_percent(slip)}: with it a roller drives "
        f"the cage for {precise_percent(float(dataset['driving_fraction']))} of a turn, crosses its pocket for "
        f"{precise_percent(float(dataset['crossing_fraction']))} and is pushed by the cage for "
        f"{precise_percent(float(dataset['pushed_fraction']))}"
    ]
