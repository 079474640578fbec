"""Steady slips alone, by a short way: where a quick first look at the torques has them, and few motions of the rollers.

- The first look, `rollslip.motion.runaway.scan`, is off by a few percent. Where torque and drag cross beyond doubt it
  tells how often, and where to begin; secants on the torque itself then place each slip.
- Where it leaves a doubt there is no short way: the curve has to be refined.
"""

from collections.abc import Callable
from typing import Final

import numpy as np

from rollslip.bearing.raceway import Array
from rollslip.motion.continuation import crossing, surmised
from rollslip.motion.runaway import scan
from rollslip.motion.torque_balance import TorqueBalance

#: Instants of a pitch at which doublings give up.
MOST_INSTANTS: Final = 256
#: By how much the first look may be off, relative to the torque, and to what a slip is found, relative to it.
_OFF, _FOUND = 0.15, 1e-8
#: To what it is found with the first instants, relative to the tolerance.
_ROUGHLY: Final = 0.1


def crossings(balance_at: Callable[[int], TorqueBalance], first: int, largest: float) -> list[float] | None:
    """Return the steady slips above zero; None where the short way cannot tell them, or there is none.

    Parameters
    ----------
    balance_at : callable
        Balance of torques by the number of instants of a pitch.
    first : int
        Instants from which they are doubled until the slips move by less than the tolerance, unless the resolution
        says how many.
    largest : float
        Largest cage slip.
    """
    balance = balance_at(first)
    assembly, tolerance = balance.assembly, balance.assembly.scene.accuracy.tolerance
    if (instants := assembly.resolution.instants) is not None and instants != first:
        balance = balance_at(instants)
    if balance.rolls_freely:
        return None
    slip, torque, refusal = scan(assembly, largest)
    if refusal:
        return None
    slip, torque = np.insert(slip, 0, 0.0), np.insert(torque, 0, balance.torque(0.0))
    near, before = surmised(slip, torque, balance.drag, _OFF), None
    while near and balance.instants <= MOST_INSTANTS:
        settles = instants is not None or before is not None
        precise = _FOUND if settles else _ROUGHLY * tolerance
        found = [crossing(balance.excess, *one, largest, precise) for one in near]
        near = [one for one in found if one is not None]
        if len(near) < len(found):
            return None
        slips: Array = np.array([at for at, _ in near])
        if instants is not None or (before is not None and np.abs(slips / before - 1.0).max() <= tolerance):
            return [float(at) for at in slips]
        before, balance = slips, balance_at(2 * balance.instants)
    return None
