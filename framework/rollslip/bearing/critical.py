"""The critical slip: where the friction of a curve is largest, beyond which it falls with slip.

The best point of a grid, and the first one behind which friction falls, are where it is looked for between the points.
Several curves are searched in step, so that what they ask for is evaluated in one go: `searched`.
"""

import math
from collections.abc import Callable, Sequence
from typing import TypeAlias

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.errors import DomainError
from rollslip.search import Rows, largest

Array = NDArray[np.float64]

#: A maximum that the rest of the curve undercuts by less than this share is rounding, not a falling branch.
_FLAT = 1e-9
#: Up to which slip of a cage it is advised to look, whose range is open at 1; and slide-roll ratio of pure sliding.
MAX_CAGE_SLIP = 0.99
PURE_SLIDING = 2.0
#: Share of a maximum by which friction has to fall behind it so that it is told beside a larger one further on.
_FALL = 1e-3


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


def search_range_hint(key: str, largest: float, most: float) -> str:
    """Return what to type so that a range of slips goes further: ten times as far, but not beyond the most.

    Empty where the range is at its end already.

    Examples
    --------
    >>> search_range_hint("study.friction-curve.max_slip", 0.3, 2.0)
    '; look further with --set study.friction-curve.max_slip=2'
    """
    to = min(10.0 * largest, most)
    return f"; look further with --set {key}={to:.3g}" if key and to > largest else ""


#: Returns the friction of curves, by their number, at slips.
Evaluate: TypeAlias = Callable[[list[tuple[int, Array]]], Sequence[Array]]


@attrs.frozen(eq=False)
class Curve:
    """A curve whose largest friction is looked for."""

    #: slip, friction: The curve on a grid, slip ascending, (n,).
    slip: Array
    friction: Array
    allow: str  # key of the setting that widens the range, as it is typed, for the status; empty if there is none
    most: float = MAX_CAGE_SLIP  # largest slip to look for: of a cage one that still turns


def locate(curve: Callable[[float], float], slip: Array, friction: Array, allow: str) -> Critical:
    """Locate the largest friction of one `Curve`, by a function of one slip, as `searched` does."""
    (found,) = searched(
        [Curve(slip, friction, allow)],
        lambda requested: [np.array([curve(float(at))]) for _, (at,) in requested],
    )
    return found


def searched(curves: Sequence[Curve], evaluate: Evaluate) -> list[Critical]:
    """Locate the largest friction of continuous curves, not of their grids, and the first maxima before these.

    That is the maximum on the two intervals of the grid around the best point, by `rollslip.search.largest`;
    the first of equal ones. A first maximum is one behind which friction falls by a thousandth on the grid before it is
    larger again. A curve that holds NaN or infinity is refused.
    """
    owners = list[int]()
    beside = list[list[int]]()
    for k, one in enumerate(curves):
        for top in _tops(one):
            owners.append(k)
            beside.append([max(top - 1, 0), top, min(top + 1, one.slip.size - 1)])
    maxima: list[list[tuple[float, float]]] = [[] for _ in curves]
    if owners:

        def friction(rows: Rows, slips: Array) -> Array:
            return np.concatenate(
                evaluate([(owners[k], slips[i : i + 1]) for i, k in enumerate(rows.tolist())])
            )

        places, heights = largest(
            friction,
            np.array([curves[k].slip[near] for k, near in zip(owners, beside, strict=True)]),
            np.array([curves[k].friction[near] for k, near in zip(owners, beside, strict=True)]),
        )
        for k, at, height in zip(owners, places.tolist(), heights.tolist(), strict=True):
            maxima[k].append((at, height))
    return [_told(one, found) for one, found in zip(curves, maxima, strict=True)]


def _tops(curve: Curve) -> list[int]:
    """Best point of a grid, and the first one behind which friction falls if it is another; none without friction."""
    slip = curve.slip
    friction = curve.friction
    if not np.isfinite(friction).all():
        bad = int(np.argmin(np.isfinite(friction)))
        raise DomainError(
            f"the friction is {friction[bad]} at a slip of {slip[bad]:.4g}: it must be finite all along"
        )
    best = int(np.argmax(friction))
    if not friction[best] > 0.0:
        return []
    before = np.maximum.accumulate(friction)
    fallen = (before > 0.0) & (friction < (1.0 - _FALL) * before)
    top = int(np.argmax(friction[: int(np.argmax(fallen))])) if fallen.any() else best
    return [best, top] if top < best else [best]


def _told(curve: Curve, maxima: Sequence[tuple[float, float]]) -> Critical:
    """What the maxima of a curve are: the largest, and the first if it is another."""
    slip = curve.slip
    friction = curve.friction
    if not maxima:
        return Critical(
            np.nan, np.nan, "no slip at largest traction: there is no friction in the range"
        )
    at, height = maxima[0]
    found = height - friction[-1] > _FLAT * height
    first = maxima[-1] if found or len(maxima) > 1 else (math.nan, math.nan)
    if found:
        return Critical(at, height, "found", *first)
    rises = friction[-1] - friction[-2] > _FLAT * height
    what = "still rises at the end of" if rises else "stays at its largest value up to the end of"
    further = search_range_hint(curve.allow, float(slip[-1]), curve.most)
    said = f"no slip at largest traction: friction {what} the range, {slip[-1]:.4g}{further}"
    return Critical(np.nan, np.nan, said, *first)
