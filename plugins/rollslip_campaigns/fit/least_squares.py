"""Nonlinear least squares in bounds with uncertainty: multiple starts, covariance, and profile likelihood.

1. Minimise the sum of squares from the origin and from eight starts around it, which are the points of an additive
   recurrence (a low-discrepancy sequence), by the trust-region method "dogbox" of `scipy.optimize.least_squares`.
2. Take the lowest minimum. Its Jacobian gives the covariance, which is exact for a linear law, and the principal
   directions by a singular value decomposition.
3. For each parameter, walk from the minimum to both sides, with all others fitted anew, until chi2 has risen by the
   95 % quantile (profile likelihood). Steps grow by half, and shrink to a quarter where the walk is stopped.
4. Find the limits by Brent's method between the points of the walk where chi2 passes the quantiles.
5. If a profile comes below the minimum, minimise from there and go on at step 2.

- Coordinates are such that 1 is a large step (`rollslip_campaigns.fit.problem` takes the logarithm over the start). The
  search is bounded, so that a parameter which does not change the residuals cannot diverge.
- A side has no limit where chi2 does not rise, and an unknown limit where another parameter meets its bound or the law
  has no value.
- A residual function returns NaN where the law has no value; the search turns back there.
- Nothing in this module depends on oils.
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
#: Receives progress: a text, and the fraction that is done.
Report: TypeAlias = Callable[[str, float], None]
#: Why a side of a profile has no limit: see `LikelihoodProfile.stops`.
Stop: TypeAlias = tuple[int, ...] | None

#: Levels of confidence of the intervals: one standard deviation of a normal distribution, and 95 %.
LEVELS: Final = (math.erf(math.sqrt(0.5)), 0.95)
#: Points of a profile on either side of the estimate; for drawing only. Each costs a search; chosen.
PROFILE_POINTS: Final = 15

#: Step of the central differences of the Jacobian, in coordinates of order 1. The error of truncation, step^2, and
#: that of rounding, 1e-16/step, are then both about 1e-11; doubling it makes truncation four times larger.
_JACOBIAN_STEP: Final = 1e-5
#: Evaluations of the residuals by one search; far more than a search that converges needs. Doubling it delays the
#: error of one that does not.
_MAX_EVALUATIONS: Final = 200
#: Starts around the origin. Doubling it finds more of the other minima in twice the time; chosen.
_OTHER_STARTS: Final = 8
#: Half width of the cube of these starts: a factor of 5 in a logarithmic parameter. Chosen; a larger one starts
#: where laws have no value.
_START_SPREAD: Final = math.log(5.0)

#: Singular values of the Jacobian below this fraction of the largest are rounding: differences have errors of
#: 1e-11. Doubling it changes nothing except for nearly degenerate parameters.
_RANK_TOLERANCE: Final = 1e-9
#: Smallest standard deviation of a residual, where data fit exactly: rounding of friction over its size. Doubling
#: it doubles the intervals of exact data.
_MIN_SCALE: Final = 1e-9
#: Part of a parameter in an undetermined direction above which the parameter has no covariance. Chosen; smaller
#: parts are rounding of directions.
_MIN_PART: Final = 1e-4
#: Distance from a bound, in coordinates of order 1, below which a parameter is at this bound. Chosen; searches end
#: within 1e-10. Doubling it changes nothing.
_BOUND_DISTANCE: Final = 1e-6
#: Fall of chi2, in variances per unit of x beyond a bound, above which the bound is active. Chosen: far below the
#: quantiles, so that an active bound does not change a limit unnoticed. Doubling it reports fewer bounds.
_BOUND_SLOPE: Final = 0.1

#: Largest first step, in coordinates of order 1; the first step is half the way to the limit of the largest
#: quantile by the covariance, if that is shorter. Doubling it saves searches and misses rises in between. Chosen: a
#: quarter of the size of a coordinate.
_MAX_STEP: Final = 0.25
#: First step of a parameter without a covariance. Doubling it saves one search a side; chosen.
_UNKNOWN_STEP: Final = 0.05
#: Factor of a step after the previous one. Doubling it reaches flat ends sooner, with a coarser walk.
_GROWTH: Final = 1.5
#: Divisor of a step after a point without a value, or with another parameter at a bound. Doubling it ends the walk
#: in fewer searches, further from the stop. Chosen.
_SHRINKAGE: Final = 4.0
#: Fraction of the first step at which shrinking stops: after five quarters. Doubling it reports the end of the
#: walk up to twice as far from the stop.
_MIN_STEP: Final = 1e-3
#: Fall of chi2 below the minimum, in variances, that counts as a lower minimum rather than as the tolerance of a
#: search. Doubling it changes nothing for separate minima. Chosen.
_LOWER_MINIMUM: Final = 1e-3
#: Tolerance of a limit, as a fraction of the step of the walk; far below four printed digits. Doubling it saves a
#: fraction of a search.
_CROSSING_TOLERANCE: Final = 1e-6
#: Extent of the drawn curve over the distance of the limit, for figures only. Chosen.
_REACH: Final = 1.2
#: Extent of the drawn curve where there is no limit: a factor of ten in a logarithmic parameter. For figures only.
#: Chosen.
_OPEN_REACH: Final = math.log(10.0)


@attrs.frozen(eq=False, kw_only=True)
class Minimum:
    """The end of a search: its start, ``x``, chi2, residuals (n,) and their Jacobian (n, parameters)."""

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
        Lowest and highest x of the walk.
    stops : tuple
        Why each side ended there without a limit: the other parameters whose bounds were active, none where x itself
        met its bound; None where the law has no value beyond.
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
        Ends of the searches, that from the origin first; None where the law has no value at the start.
    freedom : int
        Degrees of freedom.
    scale : float
        Standard deviation of a residual: 1 if it is known, otherwise estimated.
    covariance : ndarray
        Covariance of x, (parameters, parameters); NaN for parameters without one.
    spread, directions : ndarray
        Standard deviations along the principal directions of the Jacobian, ascending, and these directions, shape
        (direction, parameter); infinite where the data do not determine a direction.
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


class _LowerMinimumError(Exception):
    """A profile came below the minimum, at ``x``."""

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
    """Return the lowest minimum of squared residuals from nine starts, with its uncertainty.

    Parameters
    ----------
    residuals : callable
        Residuals (n,) at coordinates (parameters,); NaN where the law has no value.
    low, high : array
        Bounds of the coordinates, (parameters,).
    known : bool
        Whether the standard deviation of a residual is 1; otherwise it is estimated.
    profiles : bool
        Whether profiles are followed.
    report : callable
        Receives the progress.

    Raises
    ------
    ConvergenceError
        If the search from the best start does not converge.
    """
    count = low.size
    starts = _starts(low, high)
    # a profile takes about as many searches as there are parameters
    total = len(starts) + count * count * profiles
    minima = list[Minimum | None]()
    for number, start in enumerate(starts):
        report(f"search {number + 1} of {len(starts)}", number / total)
        minima.append(minimise(residuals, start, low, high))
    best = min(
        (minimum for minimum in minima if minimum is not None), key=lambda minimum: minimum.chi2
    )
    while True:
        if not best.converged:
            raise ConvergenceError(
                f"the fit did not converge: the sum of squares {best.chi2:.6g} still falls; fit fewer parameters, or "
                "start nearer"
            )
        freedom = best.residuals.size - count
        scale = 1.0 if known else max(math.sqrt(best.chi2 / freedom), _MIN_SCALE)
        covariance, spread, directions = _uncertainty(best.jacobian, scale)
        quantiles = _quantiles(freedom, known=known)
        curves = list[LikelihoodProfile]()
        try:
            for k in range(count if profiles else 0):
                report(f"profile {k + 1} of {count}", (len(starts) + k * count) / total)
                curves.append(
                    _ProfileWalk(residuals, best, k, low, high, scale).profile(
                        quantiles, math.sqrt(covariance[k, k])
                    )
                )
        except _LowerMinimumError as lower:
            minimum = minimise(residuals, lower.x, low, high)
            assert minimum is not None  # the law has a value there
            best = minimum
            continue
        return LeastSquaresEstimate(
            best=best,
            others=tuple(minima),
            freedom=freedom,
            scale=scale,
            covariance=covariance,
            spread=spread,
            directions=directions,
            quantiles=quantiles,
            profiles=tuple(curves),
        )


def _starts(low: Array, high: Array) -> list[Array]:
    """Return the origin and the starts around it, by an additive recurrence that fills the cube evenly."""
    count = low.size
    if not count:
        return [np.zeros(0)]
    root = 2.0  # of g^(d + 1) = g + 1, by fixed-point iteration to rounding
    for _ in range(50):
        root = (1.0 + root) ** (1.0 / (count + 1))
    points = np.outer(np.arange(1, _OTHER_STARTS + 1), root ** -np.arange(1.0, count + 1)) % 1.0
    return [np.zeros(count), *np.clip(_START_SPREAD * (2.0 * points - 1.0), low, high)]


def minimise(residuals: Residuals, start: Array, low: Array, high: Array) -> Minimum | None:
    """Return the end of a search from a start in bounds, or None if the law has no value at its start."""
    from scipy.optimize import least_squares

    first = residuals(start)
    if not np.all(np.isfinite(first)):
        return None
    if start.size == 0:
        return Minimum(
            start=start,
            x=start,
            chi2=float(first @ first),
            residuals=first,
            jacobian=np.zeros((first.size, 0)),
            converged=True,
        )
    search = least_squares(
        residuals,
        start,
        jac=partial(_jacobian, residuals),
        bounds=(low, high),
        method="dogbox",  # trf creeps towards a bound
        x_scale="jac",
        # close to rounding: profiles compare values of chi2 that differ by 1e-3 of the variance
        ftol=1e-12,
        xtol=1e-10,
        gtol=1e-12,
        max_nfev=_MAX_EVALUATIONS,
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
    """Return the Jacobian by central differences; one-sided where the law has no value on one side."""
    columns = []
    for k in range(x.size):
        step = np.zeros_like(x)
        step[k] = _JACOBIAN_STEP
        above = residuals(x + step)
        below = residuals(x - step)
        if np.all(np.isfinite(above)) and np.all(np.isfinite(below)):
            columns.append((above - below) / (2 * _JACOBIAN_STEP))
        else:
            here = residuals(x)
            columns.append(
                np.where(np.isfinite(above), above - here, here - below) / _JACOBIAN_STEP
            )
    return np.nan_to_num(np.column_stack(columns))


def _uncertainty(jacobian: Array, scale: float) -> tuple[Array, Array, Array]:
    """Return the covariance, the standard deviations along the principal directions (ascending), and these."""
    _, values, directions = np.linalg.svd(jacobian, full_matrices=False)
    determined = values > _RANK_TOLERANCE * values.max(initial=0.0)
    spread = np.full(values.size, np.inf)
    spread[determined] = scale / values[determined]
    part = directions[determined] * spread[determined, None]
    covariance = part.T @ part
    undetermined = np.any(np.abs(directions[~determined]) > _MIN_PART, axis=0)
    covariance[undetermined, :] = covariance[:, undetermined] = np.nan
    return covariance, spread, directions


def _quantiles(freedom: int, *, known: bool) -> tuple[float, ...]:
    """Return the quantiles of chi2 with one degree of freedom, or of F(1, n - p) where the variance is estimated."""
    from scipy.special import ndtri, stdtrit

    upper = [(1.0 + level) / 2.0 for level in LEVELS]
    return tuple(float(ndtri(p) if known else stdtrit(freedom, p)) ** 2 for p in upper)


@attrs.define(eq=False)
class _ProfileWalk:
    """Walk along the profile of parameter k of a minimum."""

    residuals: Residuals
    best: Minimum
    k: int
    low: Array
    high: Array
    scale: float
    #: The other parameters by the value of k at which they were fitted: starts of the next searches.
    others: dict[float, Array] = attrs.field(factory=dict, init=False)
    #: Values of k at which chi2 rises only because the others meet their bounds.
    bounded: dict[float, Stop] = attrs.field(factory=dict, init=False)

    def rise(self, value: float) -> float:
        """Return the rise of chi2 over the variance at a value of k; infinite where the law has no value."""
        k = self.k
        start = self.others[min(self.others, key=lambda fitted: abs(fitted - value))]
        low = np.delete(self.low, k)
        high = np.delete(self.high, k)
        minimum = minimise(lambda x: self.residuals(np.insert(x, k, value)), start, low, high)
        if minimum is None:
            return math.inf
        rise = (minimum.chi2 - self.best.chi2) / self.scale**2
        if rise < -_LOWER_MINIMUM:
            raise _LowerMinimumError(np.insert(minimum.x, k, value))
        self.others[value] = minimum.x
        # parameters at a bound beyond which chi2 would fall
        slope = np.abs(minimum.jacobian.T @ minimum.residuals) * 2 / self.scale**2
        at_bound = (minimum.x - low < _BOUND_DISTANCE) | (high - minimum.x < _BOUND_DISTANCE)
        active = np.flatnonzero(at_bound & (slope > _BOUND_SLOPE))
        if active.size:
            self.bounded[value] = tuple(map(int, active + (active >= k)))
        return max(rise, 0.0)

    def profile(self, quantiles: tuple[float, ...], error: float) -> LikelihoodProfile:
        """Return the profile, from a walk to both sides; `error` is the standard error of k, or NaN."""
        k = self.k
        best = self.best.x[k]
        self.others[float(best)] = np.delete(self.best.x, k)
        limits = np.full((len(quantiles), 2), np.nan)
        ends = list[float]()
        stops = list[Stop]()
        sides = []
        for side, (sign, bound) in enumerate(((-1.0, self.low[k]), (1.0, self.high[k]))):
            walk, stop = self._walk(sign, bound, quantiles[-1], error)
            end, last = walk[-1]
            for level, quantile in enumerate(quantiles):
                limits[level, side] = self._limit(walk, quantile)
            ends.append(end)
            stops.append(() if end == bound or last >= quantiles[-1] else stop)
            limit = limits[-1, side]
            reach = _REACH * abs(limit - best) if np.isfinite(limit) else _OPEN_REACH
            extent = sign * min(reach, abs(end - best))
            x = np.linspace(best, float(best) + extent, PROFILE_POINTS + 1)[1:]
            sides.append(np.column_stack((x, [self.rise(float(value)) for value in x])))
        curve = np.concatenate((sides[0][::-1], [[best, 0.0]], sides[1]))
        return LikelihoodProfile(
            x=curve[:, 0],
            rise=curve[:, 1],
            limits=limits,
            ends=(ends[0], ends[1]),
            stops=(stops[0], stops[1]),
        )

    def _walk(
        self, sign: float, bound: float, quantile: float, error: float
    ) -> tuple[list[tuple[float, float]], Stop]:
        """Return the points (value, rise) of one side, and what stopped the last step that was refused."""
        value = float(self.best.x[self.k])
        rise = 0.0
        stop: Stop = ()
        step = min(math.sqrt(quantile) * error / 2, _MAX_STEP) if error > 0.0 else _UNKNOWN_STEP
        smallest = _MIN_STEP * step
        walk = [(value, 0.0)]
        while rise < quantile and value != bound and step > smallest:
            trial = float(np.clip(value + sign * step, self.low[self.k], self.high[self.k]))
            trial_rise = self.rise(trial)
            if math.isinf(trial_rise) or trial in self.bounded:
                step = step / _SHRINKAGE
                stop = self.bounded.get(trial)
                continue
            value = trial
            rise = trial_rise
            step = _GROWTH * step
            walk.append((value, rise))
        return walk, stop

    def _limit(self, walk: list[tuple[float, float]], quantile: float) -> float:
        """Return where the rise first passes a quantile, by Brent's method; NaN where it does not."""
        from scipy.optimize import brentq

        for (near, before), (far, after) in pairwise(walk):
            if before < quantile <= after:
                return float(
                    brentq(
                        lambda value: self.rise(value) - quantile,
                        near,
                        far,
                        xtol=_CROSSING_TOLERANCE * abs(far - near),
                    )
                )
        return math.nan
