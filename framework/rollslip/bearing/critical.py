"""Find the critical slip of friction curves: the slip of largest friction, beyond which friction falls with slip.

1. On the grid of a curve take the largest value, and the first maximum behind which friction falls (`_grid_maxima`).
2. Between the neighbours of each of these points refine the maximum by successive parabolic interpolation
   (`rollslip.search.find_maxima`). All curves are refined at once, so that their friction is evaluated in one call.
3. A maximum counts if friction at the end of the range is below it by more than rounding; otherwise the status says
   whether friction still rises there.
"""

import math
from collections.abc import Callable, Sequence
from typing import TypeAlias

import attrs
import numpy as np

from rollslip.errors import DomainError
from rollslip.search import Array as Array  # other modules take it from here
from rollslip.search import Rows, find_maxima

#: Relative difference of friction that is taken for rounding: a maximum that exceeds the end of the curve by less is
#: not followed by a falling branch. Doubling it changes nothing on smooth curves. Chosen well above the rounding of a
#: compiled law (1e-12) and far below any fall that matters.
_ROUNDING = 1e-9
#: Largest slip of a cage that hints propose to search [1]. The cage stands still at 1, where no contact rolls.
MAX_CAGE_SLIP = 0.99
#: Slide-roll ratio of pure sliding [1]: one of the two surfaces is at rest. It follows from |V|/u, u the mean speed.
PURE_SLIDING = 2.0
#: Fraction of a maximum by which friction has to fall behind it on the grid, so that it is reported as a first maximum
#: although friction is larger at a higher slip. Doubling it hides shallow first maxima. Chosen; tables of friction are
#: accurate to about this fraction.
_MIN_FALL = 1e-3


def slip_grid(max_slip: float, points: int) -> Array:
    """Return slips from 0 to the maximum, quadratically denser towards 0, where friction rises steeply."""
    return np.asarray(max_slip * np.linspace(0.0, 1.0, points) ** 2)


@attrs.frozen
class Critical:
    """The largest friction of a curve: ``slip`` and ``friction``, both NaN unless it lies inside the range.

    ``status`` is "found", or a sentence which says why both are NaN. ``first_slip`` and ``first_friction`` are the
    first maximum, from which friction falls; it is the largest one unless friction rises again. Both are NaN if
    friction does not fall anywhere in the range. ``bound`` is a lower bound of the slip: the slip itself, or the end of
    a range in which friction does not fall; NaN without friction.
    """

    slip: float
    friction: float
    status: str
    first_slip: float = math.nan
    first_friction: float = math.nan
    bound: float = math.nan


def search_range_hint(key: str, current_slip: float, max_slip: float) -> str:
    """Return what to type so that a range of slips goes ten times as far, but not beyond the maximum.

    The hint is empty where the range ends at the maximum already, or where there is no key.

    Examples
    --------
    >>> search_range_hint("study.friction-curve.max_slip", 0.3, 2.0)
    '; look further with --set study.friction-curve.max_slip=2'
    """
    proposed = min(10.0 * current_slip, max_slip)
    return (
        f"; look further with --set {key}={proposed:.3g}" if key and proposed > current_slip else ""
    )


#: Returns the friction of curves, by their number, at slips.
Evaluate: TypeAlias = Callable[[list[tuple[int, Array]]], Sequence[Array]]


@attrs.frozen(eq=False)
class Curve:
    """A friction curve on a grid, of which the maximum is searched."""

    #: Slips of the grid, ascending, (n,).
    slip: Array
    #: Friction at the slips, (n,).
    friction: Array
    #: Key of the setting that widens the range, as it is typed; it is part of the status. Empty if there is none.
    range_key: str
    #: Largest slip that a hint proposes.
    max_slip: float = MAX_CAGE_SLIP


def find_critical_slip(
    curve: Callable[[float], float], slip: Array, friction: Array, range_key: str
) -> Critical:
    """Return the critical slip of one `Curve` whose friction is a function of one slip (`find_critical_slips`)."""
    (critical,) = find_critical_slips(
        [Curve(slip, friction, range_key)],
        lambda requested: [np.array([curve(float(s))]) for _, (s,) in requested],
    )
    return critical


def find_critical_slips(curves: Sequence[Curve], evaluate: Evaluate) -> list[Critical]:
    """Return the largest friction of continuous curves, and the first maxima before these.

    The maximum is searched on the two intervals around the largest value of the grid; of equal values the first one
    counts. A first maximum is one behind which friction falls by a thousandth on the grid before it is larger again.

    Parameters
    ----------
    curves : sequence of Curve
        The curves on their grids.
    evaluate : callable
        Returns the friction, (1,) each, for a list of curve numbers and slips, (1,) each.

    Raises
    ------
    DomainError
        If the friction of a curve is NaN or infinite on its grid.
    """
    owners = list[int]()
    brackets = list[list[int]]()
    for k, curve in enumerate(curves):
        for top in _grid_maxima(curve):
            owners.append(k)
            brackets.append([max(top - 1, 0), top, min(top + 1, curve.slip.size - 1)])
    maxima: list[list[tuple[float, float]]] = [[] for _ in curves]
    if owners:

        def friction(rows: Rows, slips: Array) -> Array:
            return np.concatenate(
                evaluate([(owners[k], slips[i : i + 1]) for i, k in enumerate(rows.tolist())])
            )

        slips, heights = find_maxima(
            friction,
            np.array([curves[k].slip[near] for k, near in zip(owners, brackets, strict=True)]),
            np.array([curves[k].friction[near] for k, near in zip(owners, brackets, strict=True)]),
        )
        for k, slip, height in zip(owners, slips.tolist(), heights.tolist(), strict=True):
            maxima[k].append((slip, height))
    return [_critical_slip(curve, found) for curve, found in zip(curves, maxima, strict=True)]


def _grid_maxima(curve: Curve) -> list[int]:
    """Return the index of the largest friction, and that of the first maximum if they differ; none without friction."""
    friction = curve.friction
    if not np.isfinite(friction).all():
        bad = int(np.argmin(np.isfinite(friction)))
        raise DomainError(
            f"the friction is {friction[bad]} at a slip of {curve.slip[bad]:.4g}: it must be finite all along"
        )
    best = int(np.argmax(friction))
    if not friction[best] > 0.0:
        return []
    before = np.maximum.accumulate(friction)
    fallen = (before > 0.0) & (friction < (1.0 - _MIN_FALL) * before)
    top = int(np.argmax(friction[: int(np.argmax(fallen))])) if fallen.any() else best
    return [best, top] if top < best else [best]


def _critical_slip(curve: Curve, maxima: Sequence[tuple[float, float]]) -> Critical:
    """Return the critical slip of the refined maxima of a curve, the largest one first, with its status."""
    slip = curve.slip
    friction = curve.friction
    if not maxima:
        return Critical(
            np.nan, np.nan, "no slip at largest traction: there is no friction in the range"
        )
    top, height = maxima[0]
    falls = height - friction[-1] > _ROUNDING * height
    first = maxima[-1] if falls or len(maxima) > 1 else (math.nan, math.nan)
    if falls:
        return Critical(top, height, "found", *first, bound=top)
    rises = friction[-1] - friction[-2] > _ROUNDING * height
    what = "still rises at the end of" if rises else "stays at its largest value up to the end of"
    further = search_range_hint(curve.range_key, float(slip[-1]), curve.max_slip)
    status = f"no slip at largest traction: friction {what} the range, {slip[-1]:.4g}{further}"
    return Critical(np.nan, np.nan, status, *first, bound=float(slip[-1]))
