"""Why a bearing has a steady slip or none, and why a range that was followed has no limit, in words."""

from typing import Final

import numpy as np

from rollslip.bearing.critical import MAX_CAGE_SLIP, search_range_hint
from rollslip.results.words import SWITCHED_OFF, Status
from rollslip.units import format_quantity
from rollslip_studies.motion.loading_branch import LoadingBranch, Steady
from rollslip_studies.motion.torque_balance import Orbit, TorqueBalance
from rollslip_studies.steady_slip.branches import Branch
from rollslip_studies.steady_slip.outputs import VARIED

#: Slope of the excess torque, relative to the largest torque over the range, below which branches are said to meet.
_LEVEL: Final = 1e-3
#: What a branch may miss of a range that it goes through, relative.
_THROUGH = 1e-3


def status_of(balance: TorqueBalance, way: LoadingBranch, slips: list[float]) -> str:
    """Say whether there are steady slips on the way up, or why there are none."""
    if balance.rolls_freely:
        return f"{SWITCHED_OFF}, so the cage runs at its epicyclic speed"
    if slips:
        return Status.FOUND
    if way.at_rest + balance.drag(0.0) > 0.0:
        faster = "it runs at more than twice its epicyclic speed"
        return f"{Status.DRIVEN}: {faster}; no slip up to {way.end:g} is steady"
    slip, torque = way.largest
    carried = (
        f"the drag is larger than the cage can carry up to a cage slip of {way.end:g} "
        f"({-balance.drag(slip):.3g} N m where the rollers drive it with most, {torque:.3g} N m at a slip of {slip:.3g}"
    )
    if slip == way.end:
        end = "slip leaves the range" if way.refusal else Status.SKIDS
        return f"{carried}, where it still rises): {end}"
    return f"{carried}): {Status.SKIDS}"


def stability_of(way: LoadingBranch, state: Orbit, steady: Steady) -> str:
    """Say whether the cage holds a slip: whether more slip leaves more torque to speed it up."""
    if abs(steady.slope) <= _LEVEL * way.largest[1]:
        return "a fold: a stable and an unstable slip meet"
    if steady.slope < 0.0:
        return "unstable: with more slip the rollers drive the cage less than the drag asks for"
    return (
        "stable" if abs(state.multiplier) < 1.0 else "unstable: the rollers do not hold their spin"
    )


def no_fold(
    name: str,
    limits: tuple[float, float],
    branches: list[Branch],
    table: str,
    most: float,
    *,
    free: bool = False,
) -> str:
    """Say why the least steady slip has no fold: it goes through, leaves the range of slips, or is not there.

    Examples
    --------
    >>> no_fold("radial_load", (100.0, 200.0), [], "study.steady-slip", 0.9)
    'no limit of the radial load is known: no steady slip at 100 N and none at 200 N; none was sought between them'
    """
    unit, what = VARIED[name]
    low, high = (format_quantity(value, unit) for value in limits)
    if free:
        return f"no limit of the {what}: {SWITCHED_OFF}"
    unknown = f"no limit of the {what} is known"
    if not branches:
        return (
            f"{unknown}: no steady slip at {low} and none at {high}; none was sought between them"
        )
    slip = branches[0].slip
    value = branches[0].parameter
    if np.isclose(slip[[0, -1]], most).any():
        at = format_quantity(float(value[np.argmax(slip)]), unit, 4)
        key = f"{table}.max_cage_slip"
        further = search_range_hint(key, most, MAX_CAGE_SLIP)
        return f"{unknown}: at {at} the steady slip leaves the range, {most:g}{further}"
    if np.ptp(value) < (1.0 - _THROUGH) * (limits[1] - limits[0]):
        ends = " and ".join(format_quantity(float(end), unit, 4) for end in np.sort(value[[0, -1]]))
        return f"{unknown}: the least steady slip has no fold between {ends}, and ends there"
    return f"no limit of the {what}: the least steady slip has no fold between {low} and {high}"
