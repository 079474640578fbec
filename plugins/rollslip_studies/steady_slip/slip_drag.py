"""The slip-drag curve: torques along the loading branch, the onset of skidding, and the slip after the jump.

The points are those of the loading branch, with more at slips uniform in logit(slip) where the branch has fewer than
requested. The interpolation error is estimated by leaving out each point in turn: its distance from the cubic through
its four neighbours (Lagrange interpolation), over the order by which a cubic with the point is more exact.
"""

import math
from collections.abc import Callable
from functools import partial
from typing import Any, Final

import numpy as np

from rollslip.bearing.raceway import RINGS, Array
from rollslip.errors import ConvergenceError, DomainError
from rollslip.results.dataset import about
from rollslip.results.text import SWITCHED_OFF, Status
from rollslip_studies.motion.loading_branch import Jump, LoadingBranch, SteadyMotion
from rollslip_studies.motion.spins import logit_slip, slip_from_logit
from rollslip_studies.motion.torque_balance import Orbit, TorqueBalance, describe_no_skidding
from rollslip_studies.steady_slip.outputs import OUTPUTS

#: Ratio of the error of a cubic at a point that was left out to its error between neighbours. For points at equal
#: distances h the products of distances are 4 h^4 and 9/16 h^4, a ratio of 7; 4 allows for unequal distances. Twice as
#: much halves the stated error of the curve.
_LEFT_OUT_ERROR_RATIO: Final = 4.0

#: Slope of the excess torque over slip at which a stable and an unstable slip count as one, a fold: relative to the
#: largest torque of the loading branch. Twice as much calls twice as near slips a fold; chosen, above the error of a
#: slope between points of the branch.
_FOLD_SLOPE: Final = 1e-3


def slip_drag_variables(
    balance: TorqueBalance,
    branch: LoadingBranch,
    slips: list[float],
    max_cage_slip: float,
    points: int,
    table: str,
) -> tuple[dict[str, Any], dict[str, Any], float]:
    """Return variables of the slip-drag curve and of its maxima, their coordinates, and the error of the curve.

    The error is that of interpolation between the points, relative to the largest torque. Numbers of maxima that were
    not found are NaN, with their statuses.

    Parameters
    ----------
    balance : TorqueBalance
        Torque balance of the bearing.
    branch : LoadingBranch
        Its loading branch.
    slips : list of float
        Steady cage slips [-].
    max_cage_slip : float
        Slip to which the curve goes [-]; it goes to the end of the branch where the answer is beyond.
    points : int
        Number of points of the curve, at least.
    table : str
        Table of the scene with the settings of the study.
    """
    onset = branch.skidding_jump
    first_drag, first_slip, _, first_jump_slip = _jump_numbers(next(iter(branch.jumps), None))
    limit_drag, skidding_slip, limit_error, jump_slip = _jump_numbers(onset)
    is_inside = max(slips or [math.inf]) <= max_cage_slip or skidding_slip <= max_cage_slip
    end = min(max_cage_slip, branch.end) if is_inside else branch.end
    slip, torque = _curve(branch, end, points)
    largest_slip, largest = branch.maximum
    tolerance = balance.assembly.scene.accuracy.tolerance
    fraction = max(error for error in (tolerance, limit_error) if math.isfinite(error))
    low, high = (math.nan, math.nan) if onset is None else onset.slips_within(fraction)
    status = Status.FOUND if onset else describe_no_skidding(branch, f"{table}.max_cage_slip")
    jump_status = status
    if onset is not None and not jump_slip > 0.0:
        jump_status = f"a larger drag is carried by no slip up to {branch.end:.4g}"
    values = {
        "driving_torque": torque,
        "drag_torque": np.array([-balance.drag(cage_slip) for cage_slip in slip.tolist()]),
        "limit_drag": limit_drag,
        "skidding_slip": skidding_slip,
        "limit_drag_error": limit_error,
        "limit_drag_low": low,
        "limit_drag_high": high,
        "skidding_status": status,
        "jump_slip": jump_slip,
        "jump_slip_status": jump_status,
        "largest_torque": largest,
        "largest_torque_slip": largest_slip,
        "largest_torque_error": _or_nan(lambda: branch.maximum_error),
        "first_maximum_torque": first_drag,
        "first_maximum_slip": first_slip,
        "first_jump_slip": first_jump_slip,
    }
    known = ~np.isnan(torque)
    left_out = _left_out_errors(slip[known], torque[known]).max(initial=0.0)
    error = float(left_out / (np.nanmax(np.abs(torque)) or 1.0)) / _LEFT_OUT_ERROR_RATIO
    variables = {name: OUTPUTS[name].variable(value) for name, value in values.items()}
    for name in ("limit_drag_low", "limit_drag_high"):
        variables[name][2]["within"] = fraction
    coords = {
        "cage_slip": ("cage_slip", slip, about("1", "cage slip")),
        "ring": ("ring", np.array(RINGS), about("1", "ring")),
    }
    return variables, coords, error


def _jump_numbers(jump: Jump | None) -> tuple[float, float, float, float]:
    """Return drag [N m], slip, relative error of the drag, and slip after a jump; all NaN without a jump."""
    if jump is None:
        return math.nan, math.nan, math.nan, math.nan
    return jump.drag, jump.slip, jump.error, jump.slip_after


def _curve(branch: LoadingBranch, end: float, points: int) -> tuple[Array, Array]:
    """Return slips of the loading branch up to an end and torques there [N m], at least a number of points, (n,)."""
    slip, torque = branch.torque_curve
    own = slip[slip <= end]
    more = [end]
    if own.size < points:
        start = logit_slip(own[1]) if own.size > 1 else logit_slip(0.5 * end)
        more = [slip_from_logit(logit) for logit in np.linspace(start, logit_slip(end), points)]
    if new := [cage_slip for cage_slip in more if cage_slip not in own]:
        found = [_or_nan(partial(_torque, branch, cage_slip)) for cage_slip in new]
        slip = np.append(slip, new)
        torque = np.append(torque, found)
    order = np.argsort(slip)
    inside = order[slip[order] <= end]
    return slip[inside], torque[inside]


def _torque(branch: LoadingBranch, slip: float) -> float:
    """Return the torque of the rollers on the cage at a slip [N m]."""
    return branch.interpolate([slip])[0].torque


def _or_nan(compute: Callable[[], float]) -> float:
    """Return a number, or NaN where it cannot be computed, because the other numbers are an answer without it."""
    try:
        return compute()
    except (DomainError, ConvergenceError):
        return math.nan


def _left_out_errors(slip: Array, values: Array) -> Array:
    """Return by how much each inner point differs from the cubic through its four nearest neighbours, (n - 2,)."""
    inner = np.arange(1, slip.size - 1)
    first = np.clip(inner - 2, 0, slip.size - 5)
    others = first[:, None] + np.arange(5)
    others = others[others != inner[:, None]].reshape(-1, 4)
    x = slip[others]
    y = values[others]
    weights = np.ones_like(x)
    for i in range(4):
        for j in range(4):
            if i != j:
                weights[:, i] *= (slip[inner] - x[:, j]) / (x[:, i] - x[:, j])
    return np.asarray(np.abs((weights * y).sum(axis=1) - values[1:-1]))


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
