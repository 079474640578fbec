"""The critical slip: where the friction of a curve is largest, beyond which it falls with slip."""

import math
from collections.abc import Callable
from typing import Final

import attrs
import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from rollslip.errors import DomainError

Array = NDArray[np.float64]

#: A maximum that the rest of the curve undercuts by less than this share is rounding, not a falling branch.
_FLAT = 1e-9
#: Up to which slip of a cage it is advised to look, whose range is open at 1; and slide-roll ratio of pure sliding.
MOST_CAGE_SLIP, PURE_SLIDING = 0.99, 2.0
#: Share of a maximum by which friction has to fall behind it so that it is told beside a larger one further on.
_FALL = 1e-3
#: Where a search ends, relative to its interval: the root of the rounding of a value that is 1.
_PLACE = 1e-8
#: Chebyshev's points of an interval, from -1 to 1, and what makes terms of values there.
_NODES: Final = -np.cos(np.pi * (np.arange(12) + 0.5) / 12)
_TERMS: Final = np.linalg.inv(chebyshev.chebvander(_NODES, _NODES.size - 1))
#: Highest terms, and their size relative to the lowest, at which a curve is resolved; steps of Newton's method.
_TAIL, _RESOLVED, _STEPS = 3, 1e-11, 12
_GOLDEN = 0.5 * (3.0 - math.sqrt(5.0))


def slip_grid(largest: float, points: int) -> Array:
    """Return slips from 0 to the largest, quadratically denser towards 0, where friction rises steeply."""
    return np.asarray(largest * np.linspace(0.0, 1.0, points) ** 2)


@attrs.frozen
class Critical:
    """The largest friction of a curve: ``slip`` and ``friction``, both NaN unless it lies inside the range.

    ``status`` says in words what was found. ``first_slip`` and ``first_friction`` are the first maximum, from which
    friction falls: the largest one too, unless friction rises once more. NaN if friction falls nowhere in the range.
    """

    slip: float
    friction: float
    status: str
    first_slip: float = math.nan
    first_friction: float = math.nan


def look_further(key: str, largest: float, most: float) -> str:
    """Return what to type so that a range of slips goes further: ten times as far, but not beyond the most.

    Empty where the range is at its end already.

    Examples
    --------
    >>> look_further("study.friction-curve.max_slip", 0.3, 2.0)
    '; look further with --set study.friction-curve.max_slip=2'
    """
    to = min(10.0 * largest, most)
    return f"; look further with --set {key}={to:.3g}" if key and to > largest else ""


def locate(
    curve: Callable[[float], float],
    slip: Array,
    friction: Array,
    allow: str,
    *,
    most: float = MOST_CAGE_SLIP,
    sought: str = "critical slip",
    of: str = "friction",
    many: Callable[[Array], Array] | None = None,
) -> Critical:
    """Locate the largest friction on the continuous curve, not on its grid, and the first maximum before it.

    Parameters
    ----------
    curve : callable
        Friction at one slip.
    slip, friction : ndarray
        The curve on a grid, slip ascending, shape (n,).
    allow : str
        Key of the setting that widens the range, as it is typed, for the status; empty if there is none.
    most : float
        Largest slip to look for: of a cage one that still turns.
    sought, of : str
        What the status calls the slip that is sought, and what is largest there.
    many : callable, optional
        Friction at several slips, where these cost little more than one.

    Returns
    -------
    Critical
        The maximum after Brent's method on the two grid intervals around the best point; the first of equal ones. Its
        place is known to the root of the rounding of the friction, some 1e-8 of the interval, since a maximum is flat.
        With ``many`` it is that of the polynomial through Chebyshev's points of these intervals, where that converges.
        A first maximum is one behind which friction falls by a thousandth on the grid before it is larger again.

    Raises
    ------
    DomainError
        If the curve holds NaN or infinity.
    """
    if not np.all(np.isfinite(friction)):
        bad = int(np.argmin(np.isfinite(friction)))
        raise DomainError(f"the {of} is {friction[bad]} at a slip of {slip[bad]:.4g}: it must be finite all along")
    best = int(np.argmax(friction))
    if not friction[best] > 0.0:
        return Critical(np.nan, np.nan, f"no {sought}: there is no {of} in the range")
    at, largest = _around(curve, many, slip, friction, best)
    found = largest - friction[-1] > _FLAT * largest
    before = np.maximum.accumulate(friction)
    fallen = (before > 0.0) & (friction < (1.0 - _FALL) * before)
    top = int(np.argmax(friction[: int(np.argmax(fallen))])) if np.any(fallen) else best
    first = (
        _around(curve, many, slip, friction, top) if top < best else (at, largest) if found else (math.nan, math.nan)
    )
    if found:
        return Critical(at, largest, "found", *first)
    rises = friction[-1] - friction[-2] > _FLAT * largest
    what = "still rises at the end of" if rises else "stays at its largest value up to the end of"
    status = f"no {sought}: {of} {what} the range, {slip[-1]:.4g}{look_further(allow, float(slip[-1]), most)}"
    return Critical(np.nan, np.nan, status, *first)


def _around(
    curve: Callable[[float], float],
    many: Callable[[Array], Array] | None,
    slip: Array,
    friction: Array,
    top: int,
) -> tuple[float, float]:
    """Place and value of the largest friction on the two intervals around a point of the grid that tops both."""
    first, last = max(top - 1, 0), min(top + 1, slip.size - 1)
    low, high = float(slip[first]), float(slip[last])
    at, largest = float(slip[top]), float(friction[top])
    if many is not None and first < top < last and (found := _smooth(many, low, high)) is not None:
        return found if found[1] > largest else (at, largest)

    # relative to the interval and to the best value, so that no size of either is lost in a tolerance
    def relative(share: float) -> float:
        return curve(low + share * (high - low)) / float(friction[top])

    known = [((float(slip[k]) - low) / (high - low), float(friction[k]) / largest) for k in (top, first, last)]
    share, value = _peak(relative, known)
    if value > 1.0:  # else a kink or a plateau, which the search did not hit
        at, largest = low + share * (high - low), value * largest
    return at, largest


def _smooth(many: Callable[[Array], Array], low: float, high: float) -> tuple[float, float] | None:
    """Place and size of the largest value inside an interval, of the polynomial through it; None where it has no end.

    Its highest terms tell whether it is the curve: beside a kink they fall too slowly.
    """
    values = many(low + 0.5 * (high - low) * (1.0 + _NODES))
    terms = _TERMS @ values
    if not np.abs(terms[-_TAIL:]).max() <= _RESOLVED * abs(terms[0]):
        return None
    slope = chebyshev.chebder(terms)
    bend, x = chebyshev.chebder(slope), float(_NODES[np.argmax(values)])
    for _ in range(_STEPS):
        step = float(chebyshev.chebval(x, slope) / chebyshev.chebval(x, bend))
        x -= step
        if not abs(x) < 1.0:
            return None
        if abs(step) <= _PLACE:
            return low + 0.5 * (high - low) * (1.0 + x), float(chebyshev.chebval(x, terms))
    return None


def _peak(curve: Callable[[float], float], known: list[tuple[float, float]]) -> tuple[float, float]:
    """Largest value between 0 and 1 and its place, by Brent's method: parabolas, or golden sections if those fail.

    ``known`` are the best of three points and both ends. A best point that is an end has the largest value unless the
    curve rises from there.
    """
    (x, fx), (w, fw), (v, fv) = known
    if x in (0.0, 1.0):
        x = abs(x - _PLACE)
        fx = curve(x)
        if fx <= known[0][1]:
            return known[0]
    low, high, step, before = 0.0, 1.0, 1.0, 1.0
    while max(x - low, high - x) > 2.0 * _PLACE:
        # the parabola through the three best points, unless it leads outside or its steps do not shrink
        r, q = (x - w) * (fx - fv), (x - v) * (fx - fw)
        p, q = (x - v) * q - (x - w) * r, 2.0 * (q - r)
        to = x - p / q if q != 0.0 else math.inf
        if low < to < high and abs(to - x) < 0.5 * abs(before):
            before, step = step, to - x
        else:
            before = (low if x > 0.5 * (low + high) else high) - x
            step = _GOLDEN * before
        u = x + math.copysign(max(abs(step), _PLACE), step)
        if not low < u < high:
            u = 0.5 * (x + (low if u <= low else high))
        fu = curve(u)
        if fu >= fx:
            low, high = (x, high) if u > x else (low, x)
            (v, fv), (w, fw), (x, fx) = (w, fw), (x, fx), (u, fu)
        else:
            low, high = (low, u) if u > x else (u, high)
            if fu >= fw or w == x:
                (v, fv), (w, fw) = (w, fw), (u, fu)
            elif fu >= fv or v in (x, w):
                v, fv = u, fu
    return x, fx
