"""What a bearing loses to friction at its steady slips, as variables of the result, and its viscosity ratio."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import RINGS
from rollslip.errors import ConvergenceError, DomainError
from rollslip.results.dataset import about
from rollslip.studies.steady_slip.torque import Duty, by_formula
from rollslip_studies.motion.losses import power_balance
from rollslip_studies.motion.torque_balance import Orbit, TorqueBalance
from rollslip_studies.steady_slip.outputs import LOSSES, RATIO


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
    for name, value in zip(RATIO, viscosity_ratio(balance.assembly), strict=True):
        variables[name] = RATIO[name].variable(value)
    return variables | formulas, {"source": ("source", sources, about("1", "what loses power")), **named}


def viscosity_ratio(assembly: Assembly) -> tuple[float, str]:
    """Return kappa = nu/nu_1 and "found", or NaN and what is missing.

    nu_1 = 45000 n^-0.83 d_m^-0.5 below n = 1000/min and 4500 (n d_m)^-0.5 from there on [mm2/s], with the relative
    speed n [1/min] and the pitch diameter d_m [mm], after ISO 281:2007.
    """
    duty = Duty.of(assembly)
    n, d_m = duty.revolutions, 1e3 * duty.pitch_diameter
    try:
        nu = 1e6 * duty.kinematic_viscosity
    except DomainError as error:
        return math.nan, str(error)
    return nu / ((45000.0 * n**-0.83 if n < 1000.0 else 4500.0 * n**-0.5) * d_m**-0.5), "found"


def acceptable_reserve(balance: TorqueBalance, slip: float) -> tuple[float, str]:
    """Return the torque of the rollers over the drag at a slip, and "found", or NaN and why there is none."""
    drag = -balance.drag(slip)
    if not drag > 0.0:
        return math.nan, f"nothing drags the cage at a slip of {slip:g}"
    try:
        return float(balance.torques(np.array([slip]))[0]) / drag, "found"
    except (DomainError, ConvergenceError) as error:
        return math.nan, str(error)
