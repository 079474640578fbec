"""The slip-drag curve: torques on the way up, where the cage runs away, and where the slip jumps to."""

import math
from typing import Any, Final

import numpy as np

from rollslip.bearing.raceway import RINGS
from rollslip.motion.continuation import left_out
from rollslip.motion.torque_balance import TorqueBalance, nowhere
from rollslip.motion.way_up import WayUp
from rollslip.results.dataset import about
from rollslip.studies.steady_slip.outputs import OUTPUTS

#: How many times as exact a cubic is between neighbours as with a point left out.
_EXACTER: Final = 4.0


def slip_drag(
    balance: TorqueBalance, way: WayUp, slips: list[float], range_: float, table: str
) -> tuple[dict[str, Any], dict[str, Any], float]:
    """Return variables of the curve and its maxima, coordinates, and what the points of the curve leave.

    Parameters
    ----------
    balance, way : TorqueBalance, WayUp
        Those of the bearing.
    slips : list of float
        Its steady slips.
    range_ : float
        Slip up to which the curve goes, further where the answer lies beyond.
    table : str
        That of the study in a scene.
    """
    (slip, torque), away, first = way.curve, way.runs_away, next(iter(way.jumps), None)
    if max(slips or [math.inf]) <= range_ or (away is not None and away.slip <= range_):
        inside = slip <= range_
        slip, torque = slip[inside], torque[inside]
    most_slip, most = way.largest
    values = {
        "driving_torque": torque,
        "drag_torque": np.array([-balance.drag(float(one)) for one in slip]),
        "largest_drag": math.nan if away is None else away.drag,
        "largest_drag_slip": math.nan if away is None else away.slip,
        "largest_drag_error": math.nan if away is None else away.error,
        "largest_drag_low": math.nan if away is None else away.low,
        "largest_drag_high": math.nan if away is None else away.high,
        "largest_drag_status": "found" if away else nowhere(way, f"{table}.max_cage_slip"),
        "jump_slip": math.nan if away is None else away.to,
        "most_torque": most,
        "most_torque_slip": most_slip,
        "most_torque_error": way.largest_error,
        "first_maximum_torque": math.nan if first is None else first.drag,
        "first_maximum_slip": math.nan if first is None else first.slip,
    }
    coords = {
        "cage_slip": ("cage_slip", slip, about("1", "cage slip")),
        "ring": ("ring", np.array(RINGS), about("1", "ring")),
    }
    error = float(left_out(slip, torque).max() / (np.abs(torque).max() or 1.0)) / _EXACTER
    return {name: OUTPUTS[name].variable(value) for name, value in values.items()}, coords, error
