"""What samples tell of a distribution, with what they do not know: quantiles, probabilities and Sobol indices.

- Samples may be unknown (NaN), because their point failed, or beyond a range (infinite), which says on which side they
  are. Nothing is left out: an unknown sample counts as the worst for one end of an interval and as the best for the
  other, so that an interval holds whatever the failed points would have given.
- Quantiles are order statistics, with the interval between two of them that holds whatever the distribution is
  (binomial); probabilities have the interval of Clopper and Pearson. Both are those of independent samples: samples of
  a Sobol sequence lie more evenly, so that these intervals are rather too wide.
- Sobol indices are Saltelli's estimators as SciPy has them; their intervals are a percentile bootstrap over the rows
  of the design, with a seed.
"""

import math
from typing import Any, Final

import attrs
import numpy as np
from numpy.typing import NDArray

__all__ = ["Estimate", "Indices", "indices", "quantile", "share"]

Array = NDArray[np.float64]

#: Resamplings of the bootstrap.
_RESAMPLES: Final = 999


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


def quantile(values: Array, probability: float, confidence: float = 0.95) -> Estimate:
    """Return a quantile, and the order statistics between which it lies with a confidence.

    Parameters
    ----------
    values : ndarray
        Samples, (n,): NaN where unknown, infinite where beyond a range.
    probability : float
        Share of the distribution below the quantile.
    confidence : float
        Of the interval; the value itself is that of the known samples, NaN if there are none.

    Notes
    -----
    With the number of samples below the quantile binomial, X_(l) and X_(u) enclose it if P(B < l) and P(B >= u) are
    each at most (1 - confidence)/2; Conover, Practical Nonparametric Statistics, 3rd ed., 1999, section 3.2.
    """
    from scipy.stats import binom

    known = np.sort(values[~np.isnan(values)])
    n, unknown = values.size, values.size - known.size
    if not known.size:
        return Estimate(math.nan, -math.inf, math.inf)
    tail = 0.5 * (1.0 - confidence)
    low = int(binom.ppf(tail, n, probability)) - unknown  # the unknown ones may lie below all others
    high = int(binom.isf(tail, n, probability)) + 1
    return Estimate(
        float(known[max(math.ceil(probability * known.size - 1e-9), 1) - 1]),
        float(known[low - 1]) if low >= 1 else -math.inf,
        float(known[high - 1]) if high <= known.size else math.inf,
    )


def share(true: int, unknown: int, n: int, confidence: float = 0.95) -> Estimate:
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
    """Return Sobol indices of a result after Saltelli's design.

    Parameters
    ----------
    a, b : ndarray
        Results of both samples, (n,).
    ab : ndarray
        Results of the first sample with one input after the other from the second, (d, n).
    seed : int
        Seed of the bootstrap.
    confidence : float
        Of the intervals.

    Returns
    -------
    Indices or None
        Of the first power of two of rows that are whole, as SciPy needs it; None if fewer than four are, or if the
        result does not vary.
    """
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
            mixed = np.repeat(mixed, 2, axis=0)  # of one input SciPy makes a scalar, on which it fails
        func: Any = {"f_A": a[some][None], "f_B": b[some][None], "f_AB": mixed}
        found = sobol_indices(func=func, n=some.size)
        return np.array([found.first_order, found.total_order])[:, : len(ab)]

    rng, tail = np.random.default_rng(seed), 50.0 * (1.0 - confidence)
    again = np.array([of(rows[rng.integers(rows.size, size=rows.size)]) for _ in range(_RESAMPLES)])
    low, high = np.percentile(again, (tail, 100.0 - tail), axis=0)
    found = np.stack([of(rows), low, high], axis=1)
    return Indices(found[0], found[1], rows.size)
