"""Sentences that several studies and campaigns say alike."""

import math

from rollslip.results.curves import percent
from rollslip.units import format_quantity

__all__ = ["UNSURE", "runs_away"]

#: What is known of effective friction near the slip of running away; docs/tables/runaway_effective_summary.csv.
UNSURE = (
    "by effective friction the drag of running away is off by 2.7 % in the middle of 62 random bearings, by up to 23 % "
    "and the slip by up to 41 points"
)


def runs_away(slip: float, drag: float, status: str) -> str:
    """Say where a cage runs away, or what was found instead; no full stop.

    Parameters
    ----------
    slip : float
        Cage slip at which the balance of torques has its fold; NaN if there is none.
    drag : float
        Drag torque that the rollers carry there, the largest of all [N m].
    status : str
        What was found.
    """
    if math.isnan(slip):
        return status
    return f"the cage runs away at {percent(slip)} cage slip, at a drag of {format_quantity(drag, 'N m', 3)}"
