"""What samples tell of a distribution, with what they do not know: quantiles, probabilities and Sobol indices.

- Samples may be unknown (NaN), because their point failed, or beyond a range (infinite), which says on which side they
  are. Nothing is left out: an unknown sample counts as the worst for one end of an interval and as the best for the
  other, so that an interval holds whatever the failed points would have given.
- Quantiles are order statistics. Of independent samples their interval lies between two of them and holds whatever the
  distribution is (binomial). Samples of a Sobol sequence lie more evenly; how much is told by several scramblings.
- Probabilities have the interval of Clopper and Pearson, which is that of independent samples and rather too wide for
  others: the spread of replicates says nothing of a probability that was one in all of them.
- Sobol indices are Saltelli's estimators as SciPy has them; their intervals are a percentile bootstrap over the rows
  of the design, with a seed.
"""

import math
from typing import Any, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.search import Array

__all__ = ["Estimate", "Indices", "fewest", "fraction", "indices", "quantile"]

#: Resamplings of the bootstrap.
_RESAMPLES: Final = 999
#: What sums of shares may be off.
_ROUNDING: Final = 1e-12


@attrs.frozen
class Estimate:
    """A value with the ends of its interval; an end that the samples cannot tell is infinite."""

    value: float
    low: float
    high: float

    @property
    def half_width(self) -> float:
        """Half of the interval."""
        return 0.5 * (self.high - self.low)


def quantile(
    values: Array, probability: float, *, replicates: int = 1, confidence: float = 0.95
) -> Estimate:
    """Return a quantile, and the interval in which it lies with a confidence.

    Notes
    -----
    Of independent samples the number below the quantile is binomial: X_(l) and X_(u) enclose it if P(B < l) and
    P(B >= u) are each at most (1 - confidence)/2; Conover, Practical Nonparametric Statistics, 3rd ed., 1999, section
    3.2.

    Of R replicates, each has a share F_r(x) of its m samples up to x, whose expectation is the distribution F(x), and
    which are independent of each other. The interval holds every x for which::

        |mean F_r(x) - p| <= t s(x) / sqrt(R),   s^2(x) = max(sum (F_r(x) - mean F_r(x))^2 / (R - 1), f (1 - f) / m^2)

    with Student's t of R - 1 degrees and f the fraction of m p: no whole number of samples below the quantile varies
    less, however the samples of a replicate hang together. Where each replicate has one sample only, all samples are
    independent.

    References
    ----------
    Z. T. Kaplan, Y. Li, M. K. Nakayama, B. Tuffin, "Randomized quasi-Monte Carlo for quantile estimation", Proc. Winter
    Simulation Conference (2019): one quantile of all replicates instead of the mean of theirs, which is biased.
    C. A. Francisco, W. A. Fuller, "Quantile estimation with a complex survey design", Ann. Statist. 19 (1991) 454: the
    interval.
    P. L'Ecuyer, M. K. Nakayama, A. B. Owen, B. Tuffin, "Confidence intervals for randomized quasi-Monte Carlo
    estimators", Proc. Winter Simulation Conference (2023): Student's t of few replicates.
    """
    known = np.sort(values[~np.isnan(values)])
    if not known.size:
        return Estimate(math.nan, -math.inf, math.inf)
    value = float(known[max(math.ceil(probability * known.size - 1e-9), 1) - 1])
    if replicates == 1 or values.size < 2 * replicates:
        low, high = _binomial(known, values.size, probability, confidence)
    else:
        low, high = _replicated(values, probability, replicates, confidence)
    return Estimate(value, min(low, value), max(high, value))


def fewest(probability: float, replicates: int, confidence: float = 0.95) -> int:
    """Return from how many samples of replicates on a quantile towards either end has an interval with two ends.

    Below all samples mean and spread are zero, so that p m > t^2/(t^2 + R) is needed, with m samples of a replicate.
    """
    from scipy.stats import t

    square = float(t.isf(0.5 * (1.0 - confidence), replicates - 1)) ** 2
    return replicates * (
        math.floor(square / (square + replicates) / min(probability, 1.0 - probability)) + 1
    )


def _binomial(known: Array, n: int, probability: float, confidence: float) -> tuple[float, float]:
    """Order statistics of those known of n independent samples that enclose a quantile."""
    from scipy.stats import binom

    tail = 0.5 * (1.0 - confidence)
    # the unknown ones may lie below all others
    low = int(binom.ppf(tail, n, probability)) - (n - known.size)
    high = int(binom.isf(tail, n, probability)) + 1
    return float(known[low - 1]) if low >= 1 else -math.inf, float(
        known[high - 1]
    ) if high <= known.size else math.inf


def _replicated(
    values: Array, probability: float, replicates: int, confidence: float
) -> tuple[float, float]:
    """Ends of a quantile of independent sets of samples."""
    from scipy.stats import t

    places = np.unique(values[~np.isnan(values)])
    sets = [np.sort(values[k::replicates]) for k in range(replicates)]
    sizes = np.array([one.size for one in sets], dtype=float)
    # shares up to each place and, first, below all of them; NaN is sorted last
    least = (
        np.array([[0, *np.searchsorted(one, places, side="right")] for one in sets])
        / sizes[:, None]
    )
    unknown = np.array([np.isnan(one).sum() for one in sets]) / sizes
    # unknown samples move the shares, and so their spread, by no more than this
    spread = least.std(axis=0, ddof=1) + np.linalg.norm(unknown) / math.sqrt(replicates - 1)
    part = np.mod(sizes * probability, 1.0)
    spread = np.maximum(spread, math.sqrt(np.mean(part * (1.0 - part) / sizes**2)))
    wide = float(t.isf(0.5 * (1.0 - confidence), replicates - 1)) / math.sqrt(replicates) * spread
    mean = least.mean(axis=0)
    ends = np.concatenate(([-math.inf], places, [math.inf]))
    first = int(np.argmax(mean + unknown.mean() + wide >= probability - _ROUNDING))
    last = int(np.flatnonzero(mean - wide <= probability + _ROUNDING)[-1])
    return float(ends[first]), float(ends[last + 1])


def fraction(true: int, unknown: int, n: int, confidence: float = 0.95) -> Estimate:
    """Return the probability of what holds for some of n samples and is not known for others.

    The interval is that of Clopper and Pearson (1934, doi:10.1093/biomet/26.4.404): its low end counts the unknown
    samples as those for which it does not hold, its high end as those for which it does.
    """
    from scipy.stats import binomtest

    low = binomtest(true, n).proportion_ci(confidence, method="exact").low
    high = binomtest(true + unknown, n).proportion_ci(confidence, method="exact").high
    known = n - unknown
    return Estimate(true / known if known else math.nan, float(low), float(high))


@attrs.frozen(eq=False)
class Indices:
    """Sobol indices: first order and total of every input with the ends of their intervals, each (3, d).

    ``used`` is the number of rows of the design that they are made of.
    """

    first: Array
    total: Array
    used: int


def indices(a: Array, b: Array, ab: Array, seed: int, confidence: float = 0.95) -> Indices | None:
    """Return Sobol indices of a result after Saltelli's design."""
    from scipy.stats import sobol_indices

    whole = np.flatnonzero(np.isfinite(a) & np.isfinite(b) & np.isfinite(ab).all(axis=0))
    if whole.size < 4:
        return None
    rows = whole[: 2 ** int(math.log2(whole.size))]
    if np.ptp(np.concatenate((a[rows], b[rows]))) == 0.0:
        return None

    def of(some: "NDArray[np.int64]") -> Array:
        mixed = ab[:, some][:, None]
        if len(ab) == 1:
            mixed = np.repeat(
                mixed, 2, axis=0
            )  # of one input SciPy makes a scalar, on which it fails
        func: Any = {"f_A": a[some][None], "f_B": b[some][None], "f_AB": mixed}
        found = sobol_indices(func=func, n=some.size)
        return np.array([found.first_order, found.total_order])[:, : len(ab)]

    rng = np.random.default_rng(seed)
    tail = 50.0 * (1.0 - confidence)
    again = np.array([of(rows[rng.integers(rows.size, size=rows.size)]) for _ in range(_RESAMPLES)])
    low, high = np.percentile(again, (tail, 100.0 - tail), axis=0)
    found = np.stack([of(rows), low, high], axis=1)
    return Indices(found[0], found[1], rows.size)
