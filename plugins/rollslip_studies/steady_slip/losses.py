"""What a bearing loses to friction at its steady slips, as variables of the result."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from rollslip.bearing.raceway import RINGS
from rollslip.motion.losses import power_balance
from rollslip.motion.torque_balance import Orbit, TorqueBalance
from rollslip.results.dataset import about
from rollslip.studies.steady_slip.torque import by_formula
from rollslip_studies.steady_slip.outputs import LOSSES


def losses(balance: TorqueBalance, states: Sequence[Orbit], *, steady: bool) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the losses at some states as variables, and their coordinates; NaN where none is steady.

    Beside them stand the friction torques by the formulas that the scene names, which know no slip.
    """
    balances = [power_balance(balance, state) for state in (states if steady else states[:1])]
    power = np.array([[loss.power for loss in one.losses] for one in balances]).T
    turns = abs(balance.assembly.scene.operation.inner_speed - balance.assembly.scene.operation.outer_speed)
    found = {
        "loss": power,
        "ring_power": np.array([one.rings for one in balances]).T.reshape(len(RINGS), -1),
        "stored_power": np.array([one.stored for one in balances]),
        "friction_torque": power.sum(axis=0) / turns,
    }
    sources = [loss.source for loss in balances[0].losses]
    variables = {
        name: LOSSES[name].variable(values if steady else np.full_like(values, np.nan))
        for name, values in found.items()
    }
    formulas, named = by_formula(balance.assembly)
    return variables | formulas, {"source": ("source", sources, about("1", "what loses power")), **named}
