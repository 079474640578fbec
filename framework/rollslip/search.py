"""Maxima and roots of curves that are expensive to evaluate.

- `find_maxima`: maxima between three samples of each of many curves, which are evaluated together; Chandrupatla's
  combination of parabolic interpolation and golden section.
- `polynomial_maximum`: the maximum of an interpolating polynomial, where a further sample would be expensive.
- `illinois_root`: a root in a bracket with known values, by the Illinois algorithm (modified regula falsi).
- `secant_root`: a root near a point with known slope, by the secant method, which must not leave a branch.

SciPy's searches evaluate known values again, and importing them takes a fifth of the time of a run.
"""

import math
from collections.abc import Callable, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Rows = NDArray[np.intp]

#: Length at which the search of a maximum ends, over that of its interval [1]. It is the square root of the rounding
#: error of a value: a maximum is flat, so that a smaller length cannot be resolved; doubling it saves an evaluation.
_RESOLUTION: Final = 1e-8
#: Distance over the length of the interval [1] at which a curve is evaluated to see whether it rises from an end, and
#: on both sides of a smooth maximum to locate it by a parabola. It has to exceed the noise of the curve, whose square
#: root is `_RESOLUTION`; doubling it makes the parabola less accurate by a factor of four.
_DISTANCE = 1e-4
#: Largest correction by that parabola, over `_DISTANCE` [1]; a kink would give a larger one. Doubling it accepts more
#: of these. Chosen.
_MAX_CORRECTION = 1e-2
#: Golden section (3 - sqrt(5))/2 [1].
_GOLDEN: Final = 0.5 * (3.0 - math.sqrt(5.0))
#: Largest number of evaluations of a search. It ends an endless loop only: bisection needs fewer than 60.
_MAX_EVALUATIONS: Final = 200
#: Largest number of secant steps: close to a root six suffice, and after twelve there is no root near the start.
_MAX_SECANTS: Final = 12


def find_maxima(
    evaluate: Callable[[Rows, Array], Array], x: Array, y: Array
) -> tuple[Array, Array]:
    """Return abscissa and value of the maximum of each of n curves between its samples, (n,) each.

    1. Where the middle sample is an end of the interval, evaluate at a distance of 1e-4 of the interval from it; where
       the curve does not rise, the end is the maximum.
    2. Divide the larger of both intervals at the vertex of the parabola through the three points, or by golden section
       where the vertex is not between them or the steps do not shrink (Chandrupatla).
    3. Keep the three points around the largest value, until both intervals are below 1e-8 of the first one.
    4. Correct a smooth maximum by the parabola through it and two points at a distance of 1e-4.

    Parameters
    ----------
    evaluate : callable
        Returns the values of curves, (m,), by their numbers, (m,), at one abscissa each, (m,).
    x, y : ndarray
        Abscissae, ascending, and values of three samples of each curve, (n, 3). The middle value is the largest, and
        positive; where it is an end of the interval, its abscissa is there twice.

    Returns
    -------
    tuple of ndarray
        The middle sample where no value is larger. NaN of a curve counts as no maximum.

    References
    ----------
    T. R. Chandrupatla, "An efficient quadratic fit-sectioning algorithm for minimization without derivatives",
    Computer Methods in Applied Mechanics and Engineering 152 (1998) 211-217.
    """
    low = x[:, 0]
    width = x[:, 2] - x[:, 0]
    top = y[:, 1].copy()
    fraction = np.full(top.size, np.nan)
    rows = np.arange(top.size)
    # three points of each curve, relative to interval and largest sample
    point = ((x - low[:, None]) / width[:, None]).T
    value = (y / top[:, None]).T
    is_end = (point[1] == point[0]) | (point[1] == point[2])
    if is_end.any():
        point[1, is_end] = np.abs(point[1, is_end] - _DISTANCE)
        inside = evaluate(rows[is_end], low[is_end] + point[1, is_end] * width[is_end])
        value[1, is_end] = inside / top[is_end]
        is_end[is_end] = ~(value[1, is_end] > 1.0)
        rows = rows[~is_end]
        point = point[:, ~is_end]
        value = value[:, ~is_end]
    last_vertex = point[2]
    for _ in range(_MAX_EVALUATIONS):
        # the second interval becomes the larger one
        swap = np.abs(point[2] - point[1]) < np.abs(point[1] - point[0])
        point = np.where(swap, point[::-1], point)
        value = np.where(swap, value[::-1], value)
        continues = (np.abs(point[2] - point[1]) > 2.0 * _RESOLUTION) & (
            2.0 * value[1] - value[0] - value[2] > 0.0
        )
        # a value that is not larger than the sample is beside a kink or on a plateau, and not taken
        is_found = ~continues & (value[1] > 1.0)
        found_rows = rows[is_found]
        fraction[found_rows] = point[1, is_found]
        top[found_rows] = value[1, is_found] * top[found_rows]
        rows = rows[continues]
        point = point[:, continues]
        value = value[:, continues]
        last_vertex = last_vertex[continues]
        if not rows.size:
            break
        (a, b, c) = point
        falls = value - value[1]
        with np.errstate(invalid="ignore"):
            weight = (b - a) * falls[2] / ((b - a) * falls[2] + (c - b) * falls[0])
            vertex = 0.5 * (weight * (a - c) + b + c)
            is_trusted = np.abs(vertex - last_vertex) < 0.5 * np.abs(b - a)
            is_near = np.abs(vertex - b) <= _RESOLUTION
        new = np.where(is_near, b + np.copysign(_RESOLUTION, c - b), vertex)
        new = np.where(is_trusted, new, b + _GOLDEN * (c - b))
        last_vertex = vertex
        new_value = evaluate(rows, low[rows] + new * width[rows]) / top[rows]
        new_value = np.where(np.isnan(new_value), -np.inf, new_value)
        is_larger = new_value >= value[1]
        columns = np.arange(rows.size)
        replaced = np.where(((new - b) * (c - b) > 0.0) ^ is_larger, 2, 0)
        point[replaced, columns] = np.where(is_larger, b, new)
        value[replaced, columns] = np.where(is_larger, value[1], new_value)
        point[1] = np.where(is_larger, new, b)
        value[1] = np.where(is_larger, new_value, value[1])
    rows = np.flatnonzero((fraction > _DISTANCE) & (fraction < 1.0 - _DISTANCE))
    if rows.size:
        sides = np.concatenate((fraction[rows] - _DISTANCE, fraction[rows] + _DISTANCE))
        left, right = np.split(
            evaluate(np.tile(rows, 2), np.tile(low[rows], 2) + sides * np.tile(width[rows], 2)), 2
        )
        with np.errstate(divide="ignore", invalid="ignore"):
            step = 0.5 * _DISTANCE * (right - left) / (2.0 * top[rows] - right - left)
        fraction[rows] += np.where(np.abs(step) <= _MAX_CORRECTION * _DISTANCE, step, 0.0)
    return np.where(np.isnan(fraction), x[:, 1], low + fraction * width), top


def polynomial_maximum(
    x: Sequence[float] | Array, y: Sequence[float] | Array
) -> tuple[float, float]:
    """Return abscissa and value of the maximum of the polynomial through the five samples around the largest one.

    Abscissae ascend, (n,). The maximum is between the neighbours of the largest sample; at an end it is that sample.
    """
    best = int(np.argmax(y))
    if not 0 < best < len(x) - 1:
        return float(x[best]), float(y[best])
    first = max(min(best - 2, len(x) - 5), 0)
    distance = np.asarray(x[first : first + 5]) - x[best]
    width = x[best + 1] - x[best - 1]
    t = distance / width
    curve = np.polynomial.Polynomial((0.0,))
    # Newton's divided differences, distant points last, which remain accurate where two points nearly coincide
    order = np.argsort(np.abs(t))
    t = t[order]
    terms = np.asarray(y[first : first + 5], dtype=float)[order]
    for k in range(1, t.size):
        terms[k:] = np.diff(terms[k - 1 :]) / (t[k:] - t[:-k])
    for root, term in zip(t[::-1], terms[::-1], strict=True):
        curve = curve * np.polynomial.Polynomial((-root, 1.0)) + term
    extrema = curve.deriv().roots()
    extrema = extrema.real[np.abs(extrema.imag) < 1e-9]
    inside = [t for t in extrema.tolist() if x[best - 1] < x[best] + width * t < x[best + 1]]
    top = float(max([0.0, *inside], key=curve))
    return float(x[best] + width * top), float(curve(top))


def illinois_root(
    curve: Callable[[float], float],
    low: float,
    high: float,
    at_low: float,
    at_high: float,
    *,
    tolerance: float = 0.0,
    relative: float = 0.0,
) -> float:
    """Return a root of a curve between two points at which its signs differ, by the Illinois algorithm.

    The search ends when the bracket, or the last step if it has at least halved the value, is below the tolerance. A
    jump through zero counts as a root. The root is the point of the last evaluation.

    Parameters
    ----------
    curve : callable
        The curve.
    low, high : float
        The bracket.
    at_low, at_high : float
        Values there.
    tolerance : float
        Allowed error of the root.
    relative : float
        Allowed error over the root [1]; both are added.

    References
    ----------
    M. Dowell, P. Jarratt, "A modified regula falsi method for computing the root of an equation", BIT 11 (1971)
    168-174.
    """
    positive = at_high > at_low
    last_side = 0
    root = low
    for _ in range(_MAX_EVALUATIONS):
        root = high - at_high * (high - low) / (at_high - at_low)
        value = curve(root)
        width = abs(high - low)
        is_halved = abs(value) <= 0.5 * abs(at_low if (value < 0.0) == positive else at_high)
        if (value < 0.0) == positive:
            low = root
            at_low = value
            at_high = at_high * (0.5 if last_side > 0 else 1.0)
            last_side = 1
        else:
            high = root
            at_high = value
            at_low = at_low * (0.5 if last_side < 0 else 1.0)
            last_side = -1
        new_width = abs(high - low)
        error = min(width - new_width if is_halved else width, new_width)
        if value == 0.0 or error <= tolerance + relative * abs(root):
            break
    return root


def secant_root(
    curve: Callable[[float], float],
    start: float,
    slope: float,
    *,
    tolerance: float,
    within: tuple[float, float],
    longest: float = math.inf,
) -> tuple[float, float] | None:
    """Return a root of a curve near a start, by the secant method, and the slope there; None if it diverges.

    Parameters
    ----------
    curve : callable
        The curve.
    start : float
        Start of the search.
    slope : float
        Approximate slope of the curve there.
    tolerance : float
        Length of the last step; the error of the root is far smaller.
    within : (float, float)
        Range that the search must not leave.
    longest : float
        Largest length of a step.

    Returns
    -------
    (float, float) or None
        The root, and the slope of the last secant: the one passed in where the first step is within the tolerance. None
        if the search leaves the range or does not converge in twelve steps.
    """
    root = start
    value = curve(start)
    for _ in range(_MAX_SECANTS):
        step = min(max(-value / slope, -longest), longest) if slope else math.nan
        if not within[0] <= root + step <= within[1]:
            return None
        root += step
        if abs(step) <= tolerance:
            return root, slope
        last_value = value
        value = curve(root)
        slope = (value - last_value) / step
    return None
