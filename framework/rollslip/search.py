"""Where a curve that takes time to evaluate is largest, and where it passes zero.

- `largest`: between three samples of each of many curves, which are evaluated together.
- `vertex`: of the polynomial through samples, where each further one costs much.
- `bracketed`: a root between two places at which the values are known.
- `secants`: a root beside a place at which the slope is known, on a branch that must not be left.

SciPy's searches evaluate once more what is known, and their import takes a fifth of what a run does.
"""

import math
from collections.abc import Callable, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Rows = NDArray[np.intp]

#: Where a search of a maximum ends, relative to its interval: the root of the rounding of a value that is 1.
_PLACE: Final = 1e-8
#: How far beside an end it is told whether a curve rises from there, more than its noise, and beside a smooth maximum
#: two more values place it better; and by how much at most, relative to that.
_BESIDE = 1e-4
_MOVED = 1e-2
_GOLDEN: Final = 0.5 * (3.0 - math.sqrt(5.0))
#: Most evaluations of a search, far more than halving takes.
_MOST: Final = 200
#: And of secants, which go beside a root or lead elsewhere.
_SECANTS: Final = 12


def largest(evaluate: Callable[[Rows, Array], Array], x: Array, y: Array) -> tuple[Array, Array]:
    """Return place and value of the largest of each of n curves between its samples, (n,) each.

    Of the three samples of each curve, (n, 3), places ascend, and the middle one is as large as the others or larger,
    and above zero. Where it is an end of the interval its place stands twice; a maximum nearer to it than 1e-4 of the
    interval is not looked for. Curves are evaluated by their numbers, at one place each, (m,) both.

    It is found after Chandrupatla's method, parabolas or golden sections where these fail, to 1e-8 of the interval.
    That is the root of the rounding of the value, since a maximum is flat; the parabola through two values further off
    tells more of it. It is the middle sample where no value is larger. A gap in which a curve is NaN is nowhere larger.

    References
    ----------
    T. R. Chandrupatla, "An efficient quadratic fit-sectioning algorithm for minimization without derivatives",
    Computer Methods in Applied Mechanics and Engineering 152 (1998) 211-217.
    """
    low = x[:, 0]
    wide = x[:, 2] - x[:, 0]
    top = y[:, 1].copy()
    fraction = np.full(top.size, np.nan)
    rows = np.arange(top.size)
    # three places of each curve and the values there, relative to interval and largest sample: no size gets lost
    at = ((x - low[:, None]) / wide[:, None]).T
    value = (y / top[:, None]).T
    if (
        ends := (at[1] == at[0]) | (at[1] == at[2])
    ).any():  # the largest there, unless the curve rises from it
        at[1, ends] = np.abs(at[1, ends] - _BESIDE)
        value[1, ends] = evaluate(rows[ends], low[ends] + at[1, ends] * wide[ends]) / top[ends]
        ends[ends] = ~(value[1, ends] > 1.0)
        rows = rows[~ends]
        at = at[:, ~ends]
        value = value[:, ~ends]
    before = at[2]
    for _ in range(_MOST):
        swap = np.abs(at[2] - at[1]) < np.abs(at[1] - at[0])  # the larger interval is the second
        at = np.where(swap, at[::-1], at)
        value = np.where(swap, value[::-1], value)
        goes_on = (np.abs(at[2] - at[1]) > 2.0 * _PLACE) & (
            2.0 * value[1] - value[0] - value[2] > 0.0
        )
        known = rows[
            ended := ~goes_on & (value[1] > 1.0)
        ]  # else a kink or a plateau, which the search did not hit
        fraction[known] = at[1, ended]
        top[known] = value[1, ended] * top[known]
        rows = rows[goes_on]
        at = at[:, goes_on]
        value = value[:, goes_on]
        before = before[goes_on]
        if not rows.size:
            break
        (a, b, c) = at
        falls = value - value[1]
        with np.errstate(invalid="ignore"):
            weight = (b - a) * falls[2] / ((b - a) * falls[2] + (c - b) * falls[0])
            turns = 0.5 * (weight * (a - c) + b + c)
            trusted = np.abs(turns - before) < 0.5 * np.abs(b - a)
            near = np.abs(turns - b) <= _PLACE
        new = np.where(near, b + np.copysign(_PLACE, c - b), turns)
        new = np.where(trusted, new, b + _GOLDEN * (c - b))
        before = turns
        found = evaluate(rows, low[rows] + new * wide[rows]) / top[rows]
        found = np.where(np.isnan(found), -np.inf, found)
        better = found >= value[1]
        every = np.arange(rows.size)
        end = np.where(((new - b) * (c - b) > 0.0) ^ better, 2, 0)
        at[end, every] = np.where(better, b, new)
        value[end, every] = np.where(better, value[1], found)
        at[1] = np.where(better, new, b)
        value[1] = np.where(better, found, value[1])
    rows = np.flatnonzero((fraction > _BESIDE) & (fraction < 1.0 - _BESIDE))
    if rows.size:
        beside = np.concatenate((fraction[rows] - _BESIDE, fraction[rows] + _BESIDE))
        behind, ahead = np.split(
            evaluate(np.tile(rows, 2), np.tile(low[rows], 2) + beside * np.tile(wide[rows], 2)), 2
        )
        with np.errstate(divide="ignore", invalid="ignore"):
            step = 0.5 * _BESIDE * (ahead - behind) / (2.0 * top[rows] - ahead - behind)
        fraction[rows] += np.where(
            np.abs(step) <= _MOVED * _BESIDE, step, 0.0
        )  # a kink moves it further
    return np.where(np.isnan(fraction), x[:, 1], low + fraction * wide), top


def vertex(x: Sequence[float] | Array, y: Sequence[float] | Array) -> tuple[float, float]:
    """Return place and height of the largest value of the polynomial through the five samples nearest to the largest.

    That is between its two neighbours; an end is the largest itself. The places ascend, (n,).
    """
    best = int(np.argmax(y))
    if not 0 < best < len(x) - 1:
        return float(x[best]), float(y[best])
    first = max(min(best - 2, len(x) - 5), 0)
    at = np.asarray(x[first : first + 5]) - x[best]
    width = x[best + 1] - x[best - 1]
    t = at / width
    curve = np.polynomial.Polynomial((0.0,))
    near = np.argsort(
        np.abs(t)
    )  # Newton's differences, far points last: a fit would take near ones for the same
    t = t[near]
    terms = np.asarray(y[first : first + 5], dtype=float)[near]
    for k in range(1, t.size):
        terms[k:] = np.diff(terms[k - 1 :]) / (t[k:] - t[:-k])
    for root, term in zip(t[::-1], terms[::-1], strict=True):
        curve = curve * np.polynomial.Polynomial((-root, 1.0)) + term
    turns = curve.deriv().roots()
    turns = turns.real[np.abs(turns.imag) < 1e-9]
    inside = [t for t in turns.tolist() if x[best - 1] < x[best] + width * t < x[best + 1]]
    top = float(max([0.0, *inside], key=curve))
    return float(x[best] + width * top), float(curve(top))


def bracketed(
    curve: Callable[[float], float],
    low: float,
    high: float,
    at_low: float,
    at_high: float,
    *,
    tolerance: float = 0.0,
    relative: float = 0.0,
) -> float:
    """Return where a curve passes zero between two places at which its signs differ, by secants, Illinois.

    The last step, if it has halved the value at least, or what is left between the places is within the tolerance, or
    the relative one of the place; a jump past zero counts as a root. The curve has been evaluated there, at last.

    References
    ----------
    M. Dowell, P. Jarratt, "A modified regula falsi method for computing the root of an equation", BIT 11 (1971)
    168-174.
    """
    positive = at_high > at_low
    side = 0
    at = low
    for _ in range(_MOST):
        at = high - at_high * (high - low) / (at_high - at_low)
        value = curve(at)
        wide = abs(high - low)
        fallen = abs(value) <= 0.5 * abs(at_low if (value < 0.0) == positive else at_high)
        if (value < 0.0) == positive:
            low = at
            at_low = value
            at_high = at_high * (0.5 if side > 0 else 1.0)
            side = 1
        else:
            high = at
            at_high = value
            at_low = at_low * (0.5 if side < 0 else 1.0)
            side = -1
        left = abs(high - low)
        if value == 0.0 or min(wide - left if fallen else wide, left) <= tolerance + relative * abs(
            at
        ):
            break
    return at


def secants(
    curve: Callable[[float], float],
    start: float,
    slope: float,
    *,
    tolerance: float,
    within: tuple[float, float],
    longest: float = math.inf,
) -> tuple[float, float] | None:
    """Return where a curve passes zero beside a place, by secants, and its slope there; None if they lead elsewhere.

    They start with about the slope at the place, and end with a step of the tolerance: what is left is far less. Steps
    are no longer than ``longest``, and leave ``within`` nowhere; there are twelve at most.
    """
    at = start
    value = curve(start)
    for _ in range(_SECANTS):
        step = min(max(-value / slope, -longest), longest) if slope else math.nan
        if not within[0] <= at + step <= within[1]:
            return None
        at += step
        if abs(step) <= tolerance:
            return at, slope
        before = value
        value = curve(at)
        slope = (value - before) / step
    return None
