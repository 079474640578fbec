"""Least squares with an account of what the data tell: several starts, covariance, profile likelihood.

Decisions:

- Coordinates are such that 1 is a large step (`rollslip_campaigns.fit.fit` takes the logarithm over the start), and the
  search is bounded: a parameter that the data do not see must not run away.
- The covariance of the Jacobian takes the law for linear. The profile does not: it follows one parameter, with all
  others fitted anew at each of its values, until chi2 has risen by the quantile. Where it does not, there is no limit,
  or none is known, because another has met a bound or the law has no value there.
- A residual function returns NaN where the law has no value; the search turns back there.
- Nothing here knows of oil.
"""

import math
from collections.abc import Callable
from functools import partial
from itertools import pairwise
from typing import Final, TypeAlias

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.errors import ConvergenceError
from rollslip.search import Array

Indices = NDArray[np.intp]
Residuals = Callable[[Array], Array]
#: Told how far something is, in words and as a share.
Report: TypeAlias = Callable[[str, float], None]
Stop: TypeAlias = tuple[int, ...] | None

#: Of the intervals: one standard deviation of a normal distribution, and 95 %.
LEVELS: Final = (math.erf(math.sqrt(0.5)), 0.95)
#: Points of a profile on either side of the estimate.
PROFILE_POINTS: Final = 15

_STEP = 1e-5  # of the central difference: its two errors are both about 1e-11
_EVALUATIONS = 200  # of a search, far more than one that converges needs
_OTHER_STARTS = 8
_SPREAD = math.log(5.0)  # of the other starts
_RANK = 1e-9  # singular values below this share of the largest are rounding
_ROUNDING = 1e-9  # share of the data below which residuals are rounding


@attrs.frozen(eq=False, kw_only=True)
class Minimum:
    """Where a search ended: ``x``, its residuals and their Jacobian."""

    start: Array
    x: Array
    chi2: float
    residuals: Array
    jacobian: Array
    converged: bool


@attrs.frozen(eq=False, kw_only=True)
class LikelihoodProfile:
    """Rise of chi2, over the variance, with one parameter, all others fitted anew.

    Attributes
    ----------
    x, rise : ndarray
        The curve, x ascending, `PROFILE_POINTS` on either side of the estimate.
    limits : ndarray
        Shape (level, side), NaN where there is none.
    ends : tuple of float
        Lowest and highest x looked at.
    stops : tuple
        Why each side ended there without a limit: the other parameters that were held by a bound of theirs, none where
        x itself met its bound; None where the law has no value beyond.
    """

    x: Array
    rise: Array
    limits: Array
    ends: tuple[float, float]
    stops: tuple[Stop, Stop] = ((), ())


@attrs.frozen(eq=False, kw_only=True)
class LeastSquaresEstimate:
    """A minimum with its uncertainty.

    Attributes
    ----------
    best : Minimum
        The lowest minimum found.
    others : tuple of Minimum or None
        Where the searches ended, that from the origin first; None where the law has no value at the start.
    freedom : int
        Degrees of freedom.
    scale : float
        Standard deviation of a residual: 1 if it is known, otherwise estimated.
    covariance : ndarray
        Of x, NaN for parameters without one.
    spread, directions : ndarray
        Standard deviations along the principal directions of the Jacobian, ascending, and these, shape (direction,
        parameter); infinite where the data do not tell.
    quantiles : tuple of float
        Rise of chi2 over the variance at which the intervals of `LEVELS` end.
    profiles : tuple of LikelihoodProfile
        One for each parameter.
    """

    best: Minimum
    others: tuple[Minimum | None, ...]
    freedom: int
    scale: float
    covariance: Array
    spread: Array
    directions: Array
    quantiles: tuple[float, ...]
    profiles: tuple[LikelihoodProfile, ...]


class _LowerFoundError(Exception):
    """The profile came below the minimum; ``x`` is where."""

    def __init__(self, x: Array) -> None:
        self.x = x


def estimate(
    residuals: Residuals,
    low: Array,
    high: Array,
    *,
    known: bool,
    profiles: bool = True,
    report: Report = lambda text, fraction: None,
) -> LeastSquaresEstimate:
    """Minimise squared residuals from the origin and from eight starts around it, and tell the uncertainty."""
    count = low.size
    # a sequence that fills the cube evenly: powers of the root of g^(d + 1) = g + 1
    root = 2.0
    for _ in range(50):
        root = (1.0 + root) ** (1.0 / (count + 1))
    points = np.outer(np.arange(1, _OTHER_STARTS + 1), root ** -np.arange(1.0, count + 1)) % 1.0
    around = np.clip(_SPREAD * (2.0 * points - 1.0), low, high) if count else np.zeros((0, 0))
    # following a profile takes about as many searches as there are parameters
    searches = 1 + len(around)
    each = count
    total = searches + count * each * profiles

    def searched(number: int, start: Array) -> Minimum | None:
        report(f"search {number + 1} of {searches}", number / total)
        return minimise(residuals, start, low, high)

    def followed(k: int) -> LikelihoodProfile:
        report(f"profile {k + 1} of {count}", (searches + k * each) / total)
        return _profile(
            residuals, best, k, low, high, scale, quantiles, math.sqrt(covariance[k, k])
        )

    minima = tuple(searched(number, x) for number, x in enumerate((np.zeros(count), *around)))
    best = min((one for one in minima if one is not None), key=lambda one: one.chi2)
    while True:
        if not best.converged:
            raise ConvergenceError(
                f"the fit did not converge: the sum of squares {best.chi2:.6g} still falls; fit fewer parameters, or "
                "start nearer"
            )
        freedom = best.residuals.size - count
        scale = 1.0 if known else max(math.sqrt(best.chi2 / freedom), _ROUNDING)
        covariance, spread, directions = _uncertainty(best.jacobian, scale)
        quantiles = _quantiles(freedom, known=known)
        try:
            curves = tuple(followed(k) for k in range(count if profiles else 0))
        except _LowerFoundError as lower:
            better = minimise(residuals, lower.x, low, high)
            assert better is not None  # the profile has been there
            best = better
            continue
        return LeastSquaresEstimate(
            best=best,
            others=minima,
            freedom=freedom,
            scale=scale,
            covariance=covariance,
            spread=spread,
            directions=directions,
            quantiles=quantiles,
            profiles=curves,
        )


def minimise(residuals: Residuals, start: Array, low: Array, high: Array) -> Minimum | None:
    """Return where a search ends, or None if the law has no value at its start."""
    from scipy.optimize import least_squares

    first = residuals(start)
    if not np.all(np.isfinite(first)):
        return None
    if start.size == 0:
        jacobian = np.zeros((first.size, 0))
        chi2 = float(first @ first)
        return Minimum(
            start=start, x=start, chi2=chi2, residuals=first, jacobian=jacobian, converged=True
        )
    search = least_squares(
        residuals,
        start,
        jac=partial(_jacobian, residuals),
        bounds=(low, high),
        method="dogbox",  # trf creeps towards a bound
        x_scale="jac",
        ftol=1e-12,
        xtol=1e-10,
        gtol=1e-12,
        max_nfev=_EVALUATIONS,
    )
    return Minimum(
        start=start,
        x=search.x,
        chi2=2.0 * float(search.cost),
        residuals=search.fun,
        jacobian=np.asarray(search.jac),
        converged=search.status > 0,
    )


def _jacobian(residuals: Residuals, x: Array) -> Array:
    """Central differences; one-sided at the edge of where the law has a value."""
    columns = []
    for k in range(x.size):
        step = np.zeros_like(x)
        step[k] = _STEP
        above = residuals(x + step)
        below = residuals(x - step)
        here = None if np.all(np.isfinite(above)) and np.all(np.isfinite(below)) else residuals(x)
        if here is None:
            columns.append((above - below) / (2 * _STEP))
        else:
            columns.append(np.where(np.isfinite(above), above - here, here - below) / _STEP)
    return np.nan_to_num(np.column_stack(columns))


def _uncertainty(jacobian: Array, scale: float) -> tuple[Array, Array, Array]:
    """Covariance, standard deviations along the principal directions (ascending) and these."""
    _, values, directions = np.linalg.svd(jacobian, full_matrices=False)
    seen = values > _RANK * values.max(initial=0.0)
    spread = np.full(values.size, np.inf)
    spread[seen] = scale / values[seen]
    part = directions[seen] * spread[seen, None]
    covariance = part.T @ part
    blind = np.any(np.abs(directions[~seen]) > 1e-4, axis=0)
    covariance[blind, :] = covariance[:, blind] = np.nan
    return covariance, spread, directions


def _quantiles(freedom: int, *, known: bool) -> tuple[float, ...]:
    """Quantiles of chi2 with one degree of freedom, or of F(1, n - p) where the variance is estimated."""
    from scipy.special import ndtri, stdtrit

    upper = [(1.0 + level) / 2.0 for level in LEVELS]
    return tuple(float(ndtri(p) if known else stdtrit(freedom, p)) ** 2 for p in upper)


def _held(minimum: Minimum, low: Array, high: Array, scale: float) -> Indices:
    """Parameters at a bound, beyond which chi2 would fall by more than a tenth of a variance for each unit of x."""
    fall = np.abs(minimum.jacobian.T @ minimum.residuals) * 2 / scale**2
    at_bound = (minimum.x - low < 1e-6) | (high - minimum.x < 1e-6)
    return np.flatnonzero(at_bound & (fall > 0.1))


def _crossing(rise: Callable[[float], float], quantile: float, near: float, far: float) -> float:
    """Where the rise passes a quantile."""
    from scipy.optimize import brentq

    return float(
        brentq(lambda value: rise(value) - quantile, near, far, xtol=1e-6 * abs(far - near))
    )


def _profile(
    residuals: Residuals,
    best: Minimum,
    k: int,
    low: Array,
    high: Array,
    scale: float,
    quantiles: tuple[float, ...],
    error: float,
) -> LikelihoodProfile:
    """Follow parameter k to both sides, until chi2 has risen by the largest quantile or the search ends."""
    rest = np.delete(best.x, k)
    at = {float(best.x[k]): rest}  # the others, where they were fitted last
    bounded = dict[float, Stop]()  # where chi2 rises only because the search of others ends

    def rise(value: float) -> float:
        """Rise of chi2 over the variance; infinite where the law has no value."""
        near = at[min(at, key=lambda known: abs(known - value))]
        lowest = minimise(
            lambda x: residuals(np.insert(x, k, value)), near, np.delete(low, k), np.delete(high, k)
        )
        if lowest is None:
            return math.inf
        risen = (lowest.chi2 - best.chi2) / scale**2
        if risen < -1e-3:
            raise _LowerFoundError(np.insert(lowest.x, k, value))
        at[value] = lowest.x
        held = _held(lowest, np.delete(low, k), np.delete(high, k), scale)
        if held.size:
            bounded[value] = tuple(int(j) for j in held + (held >= k))
        return max(risen, 0.0)

    limits = np.full((len(quantiles), 2), np.nan)
    ends = []
    stops = list[Stop]()
    sides = []
    for side, (sign, bound) in enumerate(((-1.0, low[k]), (1.0, high[k]))):
        inside = float(best.x[k])
        last = 0.0
        stop: Stop = ()
        step = min(math.sqrt(quantiles[-1]) * error / 2, 0.25) if error > 0.0 else 0.05
        least = 1e-3 * step
        # the parts of the walk, between which chi2 rises through a quantile
        walk = [(inside, 0.0)]
        while last < quantiles[-1] and inside != bound and step > least:
            outside = float(np.clip(inside + sign * step, low[k], high[k]))
            risen = rise(outside)
            if math.isinf(risen) or outside in bounded:
                step = step / 4
                stop = bounded.get(outside)
                continue
            inside = outside
            last = risen
            step = 1.5 * step
            walk.append((inside, last))
        for level, quantile in enumerate(quantiles):
            for (near, before), (far, after) in pairwise(walk):
                if before < quantile <= after:
                    limits[level, side] = _crossing(rise, quantile, near, far)
                    break
        ends.append(inside)
        stops.append(() if inside == bound or last >= quantiles[-1] else stop)
        # drawn a little beyond the limit, and to a tenth or ten times where there is none
        shown = limits[-1, side]
        reach = 1.2 * abs(shown - best.x[k]) if np.isfinite(shown) else math.log(10.0)
        edge = float(best.x[k]) + sign * min(reach, abs(inside - best.x[k]))
        x = np.linspace(best.x[k], edge, PROFILE_POINTS + 1)[1:]
        sides.append(np.column_stack((x, [rise(float(value)) for value in x])))
    curve = np.concatenate((sides[0][::-1], [[best.x[k], 0.0]], sides[1]))
    return LikelihoodProfile(
        x=curve[:, 0],
        rise=curve[:, 1],
        limits=limits,
        ends=(ends[0], ends[1]),
        stops=(stops[0], stops[1]),
    )
