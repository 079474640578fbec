"""Sentences that several studies and campaigns say alike, and the verdict that stands before all of them."""

import json
import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Final

from rollslip.results.account import account_of, headline_of
from rollslip.results.curves import percent
from rollslip.units import format_quantity

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["UNSURE", "runs_away", "verdict"]

#: What is known of effective friction near the slip of running away; docs/tables/runaway_effective_summary.csv.
UNSURE: Final = (
    "by effective friction the drag of running away is off by 2.7 % in the middle of 62 random bearings and by up to "
    "23 %, the slip by up to 41 points"
)


#: Share of the contact force outside a bound from which on it counts.
TOLD_FROM: Final = 0.005


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


def verdict(datasets: "Iterable[xr.Dataset]") -> list[str]:
    """Return what has to be known first, one line each, no full stops; nothing where no result has a headline.

    Where the cage runs away; how it runs, with what reserve; how far to trust that.
    """
    every = list(datasets)
    if not (first := headline_of(every)):
        return []
    runs = next(filter(None, (account_of(dataset).operation(dataset) for dataset in every)), "")
    return [first, *filter(None, [runs, _trust(every)])]


def _trust(datasets: "list[xr.Dataset]") -> str:
    """Say what results rest on: a law that approximates another, bounds that were left, and the data of the oil."""
    judged: list[dict[str, Any]] = [json.loads(d.attrs["validity"]) for d in datasets if d.attrs.get("validity")]
    said = list[str]()
    if off := [one["approximation"] for one in judged if one.get("approximation")]:
        most = max(off, key=lambda one: float(one["rms"]))
        said.append(
            f"{most['law']!r} is {100.0 * most['rms']:.2g} % (rms) off {most['reference']!r}, which it approximates"
        )
    left = {bound["law"] for one in judged for bound in one.get("bounds", ()) if bound["share_outside"] >= TOLD_FROM}
    if left:
        said.append(f"outside what it was made for: {', '.join(sorted(left))}, as the warnings say")
    oils = [json.loads(d.attrs["lubricant"]) for d in datasets if d.attrs.get("lubricant")]
    if grades := sorted({grade for oil in oils for grade in oil.get("grades", {}).values()}):
        said.append(
            f"oil data of grade{'s' * (len(grades) > 1)} {' and '.join(dict.fromkeys((grades[0], grades[-1])))}"
        )
    return f"how far to trust it: {'; '.join(said)}" if said else ""
