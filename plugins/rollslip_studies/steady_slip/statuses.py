"""Texts of statuses: whether a bearing has a steady slip, whether the slip is stable, and why it has no limit."""

from typing import Final

import numpy as np

from rollslip.bearing.critical import MAX_CAGE_SLIP, search_range_hint
from rollslip.results.text import SWITCHED_OFF, Status
from rollslip.units import format_quantity
from rollslip_studies.motion.loading_branch import LoadingBranch, SteadyMotion
from rollslip_studies.motion.torque_balance import Orbit, TorqueBalance
from rollslip_studies.steady_slip.branches import Branch
from rollslip_studies.steady_slip.outputs import VARIED

#: Slope of the excess torque over slip at which a stable and an unstable slip count as one, a fold: relative to the
#: largest torque of the loading branch. Twice as much calls twice as near slips a fold; chosen, above the error of a
#: slope between points of the branch.
_FOLD_SLOPE: Final = 1e-3
#: Part of a range of parameters that a branch may leave out and still count as going through it. It covers the last
#: step of the continuation, which ends inside the range; twice as much calls shorter branches complete. Chosen.
_RANGE_TOLERANCE: Final = 1e-3


def describe_steady_status(
    balance: TorqueBalance, branch: LoadingBranch, slips: list[float]
) -> str:
    """Return `Status.FOUND` where there are steady slips on the loading branch, else why there are none."""
    if balance.rolls_freely:
        return f"{SWITCHED_OFF}, so the cage runs at its epicyclic speed"
    if slips:
        return Status.FOUND
    if branch.torque_without_slip + balance.drag(0.0) > 0.0:
        return (
            f"{Status.DRIVEN}: it runs at more than twice its epicyclic speed; "
            f"no slip up to {branch.end:g} is steady"
        )
    slip, torque = branch.maximum
    carried = (
        f"the drag is larger than the cage can carry up to a cage slip of {branch.end:g} "
        f"({-balance.drag(slip):.3g} N m where the rollers drive it with most, {torque:.3g} N m at a slip of {slip:.3g}"
    )
    if slip == branch.end:
        end = "slip leaves the range" if branch.refusal else Status.SKIDS
        return f"{carried}, where it still rises): {end}"
    return f"{carried}): {Status.SKIDS}"


def describe_stability(branch: LoadingBranch, state: Orbit, steady: SteadyMotion) -> str:
    """Return "stable" where more slip leaves more torque to speed the cage up, else why a steady slip is not stable."""
    if abs(steady.slope) <= _FOLD_SLOPE * branch.maximum[1]:
        return "a fold: a stable and an unstable slip meet"
    if steady.slope < 0.0:
        return "unstable: with more slip the rollers drive the cage less than the drag brakes it"
    return (
        "stable" if abs(state.multiplier) < 1.0 else "unstable: the rollers do not hold their spin"
    )


def describe_no_fold(
    name: str,
    limits: tuple[float, float],
    branches: list[Branch],
    table: str,
    max_cage_slip: float,
    *,
    free: bool = False,
) -> str:
    """Return why the smallest steady slip has no fold over a range of an operating condition.

    Parameters
    ----------
    name : str
        Name of the operating condition, a key of `VARIED`.
    limits : tuple of float
        Its smallest and largest value, in SI units.
    branches : list of Branch
        Steady slips over the condition, that of the smallest slip first.
    table : str
        Table of the scene with the settings of the study.
    max_cage_slip : float
        Largest cage slip of the branches [-].
    free : bool
        Whether nothing drags the cage.

    Examples
    --------
    >>> describe_no_fold("radial_load", (100.0, 200.0), [], "study.steady-slip", 0.9)
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
    if np.isclose(slip[[0, -1]], max_cage_slip).any():
        at = format_quantity(float(value[np.argmax(slip)]), unit, 4)
        further = search_range_hint(f"{table}.max_cage_slip", max_cage_slip, MAX_CAGE_SLIP)
        return f"{unknown}: at {at} the steady slip leaves the range, {max_cage_slip:g}{further}"
    if np.ptp(value) < (1.0 - _RANGE_TOLERANCE) * (limits[1] - limits[0]):
        ends = " and ".join(format_quantity(float(end), unit, 4) for end in np.sort(value[[0, -1]]))
        return f"{unknown}: the least steady slip has no fold between {ends}, and ends there"
    return f"no limit of the {what}: the least steady slip has no fold between {low} and {high}"
