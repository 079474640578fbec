"""The slip-drag curve: torques on the way up, where the cage runs away, and where the slip jumps to."""

import math
from collections.abc import Callable
from functools import partial
from typing import Any, Final

import numpy as np

from rollslip.bearing.raceway import RINGS, Array
from rollslip.errors import ConvergenceError, DomainError
from rollslip.results.dataset import about
from rollslip.results.words import Status
from rollslip_studies.motion.loading_branch import LoadingBranch
from rollslip_studies.motion.spins import logit_slip, slip_of
from rollslip_studies.motion.torque_balance import TorqueBalance, nowhere
from rollslip_studies.steady_slip.outputs import OUTPUTS

#: How many times as exact a cubic is between neighbours as with a point left out.
_EXACTER: Final = 4.0


def slip_drag(
    balance: TorqueBalance,
    way: LoadingBranch,
    slips: list[float],
    range_: float,
    points: int,
    table: str,
) -> tuple[dict[str, Any], dict[str, Any], float]:
    """Return variables of the curve and its maxima, coordinates, and what the points of the curve leave."""
    away = way.describe_skidding
    first = next(iter(way.jumps), None)
    inside = max(slips or [math.inf]) <= range_ or (away is not None and away.slip <= range_)
    slip, torque = _curve(way, min(range_, way.end) if inside else way.end, points)
    most_slip, most = way.largest
    errors = (balance.assembly.scene.accuracy.tolerance, 0.0 if away is None else away.error)
    fraction = max(one for one in errors if math.isfinite(one))
    low, high = (math.nan, math.nan) if away is None else away.around(fraction)
    values = {
        "driving_torque": torque,
        "drag_torque": np.array([-balance.drag(float(one)) for one in slip]),
        "limit_drag": math.nan if away is None else away.drag,
        "skidding_slip": math.nan if away is None else away.slip,
        "limit_drag_error": math.nan if away is None else away.error,
        "limit_drag_low": low,
        "limit_drag_high": high,
        "skidding_status": Status.FOUND if away else nowhere(way, f"{table}.max_cage_slip"),
        "jump_slip": math.nan if away is None else away.to,
        "largest_torque": most,
        "largest_torque_slip": most_slip,
        "largest_torque_error": _or_unknown(lambda: way.largest_error),
        "first_maximum_torque": math.nan if first is None else first.drag,
        "first_maximum_slip": math.nan if first is None else first.slip,
    }
    away_status = str(values["skidding_status"])
    carries = f"a larger drag is carried by no slip up to {way.end:.4g}"
    values["jump_slip_status"] = away_status if away is None or away.to > 0.0 else carries
    coords = {
        "cage_slip": ("cage_slip", slip, about("1", "cage slip")),
        "ring": ("ring", np.array(RINGS), about("1", "ring")),
    }
    known = ~np.isnan(torque)
    error = (
        float(_left_out(slip[known], torque[known]).max() / (np.nanmax(np.abs(torque)) or 1.0))
        / _EXACTER
    )
    variables = {name: OUTPUTS[name].variable(value) for name, value in values.items()}
    variables["limit_drag_low"][2]["within"] = variables["limit_drag_high"][2]["within"] = fraction
    return variables, coords, error


def _curve(way: LoadingBranch, end: float, points: int) -> tuple[Array, Array]:
    """Slips of the way up to some slip and torques there [N m], more where there are fewer than are asked for."""
    slip, torque = way.curve
    own = slip[slip <= end]
    begin = logit_slip(own[1]) if own.size > 1 else logit_slip(0.5 * end)
    more = (
        [slip_of(place) for place in np.linspace(begin, logit_slip(end), points)]
        if own.size < points
        else [end]
    )
    if new := [one for one in more if one not in own]:
        found = [_or_unknown(partial(_torque, way, one)) for one in new]
        slip = np.append(slip, new)
        torque = np.append(torque, found)
    order = np.argsort(slip)
    inside = order[slip[order] <= end]
    return slip[inside], torque[inside]


def _torque(way: LoadingBranch, slip: float) -> float:
    return way.at([slip])[0].torque


def _or_unknown(found: Callable[[], float]) -> float:
    """What is found, or NaN: neither the end of the curve nor an error is a reason to lose the answer."""
    try:
        return found()
    except (DomainError, ConvergenceError):
        return math.nan


def _left_out(slip: Array, values: Array) -> Array:
    """By how much each inner point differs from the cubic through the four nearest others, (n,)."""
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
    error = np.zeros_like(slip)
    error[1:-1] = np.abs((weights * y).sum(axis=1) - values[1:-1])
    return error
