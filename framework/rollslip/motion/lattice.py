"""Torques of rollers at cage slips that samples of one bearing share, and what follows from them between these slips.

- Loads depend on slip through centrifugal force alone, and not on the oil. At slips of one lattice, even in
  ln(S/(1 - S)), equilibria are solved once for all samples of a bearing that is loaded alike; with them come few loads
  for each roller that stand for all of its slices (`TorqueBalance.by_few_loads`).
- Over the lattice the torque is smooth: the polynomial through five of its slips places a maximum, or a balance with
  the drag, far more exactly than either is asked for.
- Nothing is believed. The polynomial through four of the five has to say the same, and all slices have to give the same
  torque in the motion that few loads have found; else there is no short way, and who asks goes the long one.
"""

import math
from collections.abc import Callable
from functools import partial
from typing import Final

import attrs
import numpy as np

from rollslip.motion.torque_balance import TorqueBalance, alike

_STEP: Final = 0.0625
#: Slips that a polynomial goes through, and steps of the lattice that a search goes at most.
_FIVE, _MOST = 5, 24
#: Steps of secants on a polynomial; the first and the last of them, in steps of the lattice.
_STEPS, _FIRST, _LAST = 30, 1e-2, 1e-10
#: Coefficients, from the lowest degree on, of the polynomials through values at 0, 1, 2, 3, 4, the first and the last
#: four of them.
_THROUGH: Final = [
    np.linalg.inv(np.vander(np.arange(float(first), last), increasing=True)) for first, last in ((0, 5), (0, 4), (1, 5))
]


def slip_of(place: float) -> float:
    """Return the cage slip at a place of the lattice: whole numbers, and where it is to be finer their halves again."""
    return 1.0 / (1.0 + math.exp(-_STEP * place))


def place_of(slip: float) -> float:
    """Return the place of a cage slip between 0 and 1."""
    return math.log(slip / (1.0 - slip)) / _STEP


@attrs.frozen(eq=False)
class Torques:
    """Torques of the rollers of one bearing at slips of the lattice up to the largest."""

    balance: TorqueBalance
    largest: float

    def __call__(self, place: float, beside: float | None = None) -> float:
        """Torque [N m] at a place of the lattice, going on from the motion beside it, or the nearest."""
        near = None if beside is None else self.balance.by_few_loads(slip_of(beside))
        return self.balance.by_few_loads(slip_of(place), near).torque

    def inside(self, place: float) -> bool:
        """Whether a place of the lattice is in the range."""
        return slip_of(place) <= self.largest

    def agree(self, place: float, error: float) -> bool:
        """Whether few loads give the torque of all slices there, up to an error relative to it."""
        return self.balance.missed(self.balance.by_few_loads(slip_of(place))) <= error

    def alike(self, *places: float) -> bool:
        """Whether rollers have one kind of motion at some places in order."""
        return alike([self.balance.by_few_loads(slip_of(place)) for place in places])

    def polynomials(self, first: int) -> list[list[float]]:
        """Coefficients over the place from the first one on: through five slips, and the first and last four of them.

        Where the torque has a corner between its slips they do not say the same.
        """
        values = np.array([self(number) for number in range(first, first + _FIVE)])
        parts = values, values[:-1], values[1:]
        return [(through @ part).tolist() for through, part in zip(_THROUGH, parts, strict=True)]


def highest(torques: Torques, start: float) -> int | None:
    """Return the slip of the lattice with more torque than those beside it, near a start; None at the end of the range.

    From the end of the range it goes in large steps first.
    """
    best, stride = round(place_of(start)), 1
    while not torques.inside(best + stride):
        best, stride = best - 1, 4
    while stride:
        for _ in range(_MOST):
            if torques.inside(best + stride) and torques(best + stride) > torques(best):
                best += stride
            elif torques(best - stride) > torques(best):
                best -= stride
            else:
                break
        stride //= 2
    return best if torques.inside(best + 1) else None


def maximum(torques: Torques, best: int, close: float, flat: float) -> tuple[float, float] | None:
    """Return slip and size [N m] of the maximum beside the highest slip of the lattice; None if few loads do not do.

    Where polynomials do not say the same the torque has a corner, because a roller changes its motion at once: there
    the lattice is halved instead, and each motion goes on from the highest so far: near a corner rollers may hold two.

    Parameters
    ----------
    torques : Torques
        Those of the bearing.
    best : int
        What `highest` gives.
    close : float
        To what it is to be placed, and polynomials may place it apart, relative to the slip.
    flat : float
        By how much few loads may miss all slices there, relative to the torque, and ten times polynomials each other.
    """
    if not torques.agree(best, flat):
        return None
    first = best - 2 if torques.inside(best + 2) else best - 3
    # polynomials through the torques of two kinds of motion may agree by chance
    if torques.alike(best - 1, best, best + 1) and torques.alike(*range(first, first + _FIVE)):
        tops = []
        for curve in torques.polynomials(first):
            rises = [k * of for k, of in enumerate(curve)][1:]
            at = _root(partial(_value, rises), best - first)
            tops.append((at, _value(curve, at)))
        (at, height), *others = tops
        same = all(abs(at - x) * _STEP <= close and abs(height - y) <= 0.1 * flat * height for x, y in others)
        if same and abs(first + at - best) <= 1.0:
            return slip_of(first + at), height
    place, part = float(best), 1.0
    while slip_of(place + part) - slip_of(place - part) > 2.0 * close * slip_of(place):
        sides = [side for side in (-part, part) if not torques.alike(*sorted((place, place + side)))]
        part *= 0.5
        beside = [place + math.copysign(part, side) for side in sides or (-part, part)]
        place = max((place, *beside), key=partial(torques, beside=place))
    return (slip_of(place), torques(place)) if torques.agree(place, flat) else None


def balanced(torques: Torques, start: float, drag: Callable[[float], float], close: float) -> float | None:
    """Return the slip near a start at which the torque balances a drag; None if there is no short way to it.

    Parameters
    ----------
    torques : Torques
        Those of the bearing.
    start : float
        Cage slip from which it is looked for.
    drag : callable
        Torque of the drags at a slip [N m], negative where it resists.
    close : float
        By how much two polynomials may place it apart, relative to the slip, and few loads the torque, relative to it.
    """

    def excess(number: int) -> float:
        return torques(number) + drag(slip_of(number))

    low = math.floor(place_of(start))
    for _ in range(_MOST):
        if not torques.inside(low + 1):
            return None
        left, right = excess(low), excess(low + 1)
        if (left < 0.0) != (right < 0.0):
            break
        low += 1 if (abs(right) < abs(left)) else -1
    else:
        return None
    first = low - 2 if abs(left) < abs(right) or not torques.inside(low + 3) else low - 1
    near = low + left / (left - right)
    found = []
    for curve in torques.polynomials(first):

        def over(x: float, of: list[float] = curve) -> float:
            return _value(of, x) + drag(slip_of(first + x))

        found.append(_root(over, near - first))
    at, *others = found
    same = all(abs(at - x) * _STEP <= close for x in others)
    if not (same and low <= first + at <= low + 1 and torques.agree(low, close)):
        return None
    return slip_of(first + at)


def _value(coefficients: list[float], x: float) -> float:
    """Value of a polynomial, its coefficients from the lowest degree on."""
    value = 0.0
    for of in reversed(coefficients):
        value = value * x + of
    return value


def _root(function: Callable[[float], float], start: float) -> float:
    """Zero of a function near a start, by secants; NaN if they find none."""
    at, step = start, _FIRST
    value = function(at)
    for _ in range(_STEPS):
        before, value, at = value, function(at + step), at + step
        if value == before:
            return at if value == 0.0 else math.nan
        step *= value / (before - value)
        if abs(step) <= _LAST:
            return at + step
        if not abs(at + step - start) <= _FIVE:
            return math.nan
    return math.nan
