"""Steady slips alone, by a short way: where a quick first look at the torques has them, and few motions of the rollers.

- The first look, `rollslip.motion.runaway.scan`, is off by a few percent. Where torque and drag cross beyond doubt it
  tells how often, and where to begin; torques at slips that samples share then place each slip, or where these do not
  serve (`rollslip.motion.lattice`), secants on the torque itself.
- Where it leaves a doubt there is no short way: the curve has to be refined.
"""

from collections.abc import Callable
from typing import Final

import numpy as np

from rollslip.bearing.raceway import Array
from rollslip.motion.continuation import crossing, surmised
from rollslip.motion.lattice import Torques, balanced, place_of, slip_of
from rollslip.motion.runaway import scan
from rollslip.motion.torque_balance import TorqueBalance

#: Instants of a pitch at which doublings give up.
MOST_INSTANTS: Final = 256
#: By how much the first look may be off, relative to the torque, and to what a slip is found, relative to it.
_OFF, _FOUND = 0.15, 1e-8
#: To what it is found with the first instants, relative to the tolerance.
_ROUGHLY: Final = 0.1
#: To what slips that samples share place it, relative to the tolerance.
_CLOSE: Final = 0.01


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
    slip, torque = np.insert(slip, 0, 0.0), np.insert(torque, 0, _at_rest(balance))
    near, before = surmised(slip, torque, balance.drag, _OFF), None
    if near and not balance.assembly.inner.chain.bounds:
        settled = instants is not None
        at_once = [_shared(balance_at, balance, at, largest, tolerance, settled=settled) for at, _ in near]
        if None not in at_once:
            return [one for one in at_once if one is not None]
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


def _at_rest(balance: TorqueBalance) -> float:
    """Torque without slip, for a first look."""
    bounds = balance.assembly.inner.chain.bounds
    return balance.torque(0.0) if bounds else balance.by_few_loads(0.0).torque


def _shared(
    balance_at: Callable[[int], TorqueBalance],
    first: TorqueBalance,
    start: float,
    largest: float,
    tolerance: float,
    *,
    settled: bool,
) -> float | None:
    """Slip near a start by slips that samples share; None where these do not tell it.

    Instants are doubled, unless they are ``settled``, until they move the torque by less than the tolerance would do.
    """
    fewer, balance = first, first if settled else balance_at(2 * first.instants)
    while balance.instants <= MOST_INSTANTS:
        torques = Torques(balance, largest)
        at = balanced(torques, start, balance.drag, _CLOSE * tolerance)
        if at is None or settled:
            return at
        place = round(place_of(at))
        rises = torques(place + 1) - torques(place)
        rises += balance.drag(slip_of(place + 1)) - balance.drag(slip_of(place))
        apart = slip_of(place + 1) - slip_of(place)
        if abs(torques(place) - Torques(fewer, largest)(place)) * apart <= tolerance * at * abs(rises):
            return at
        fewer, balance = balance, balance_at(2 * balance.instants)
    return None
