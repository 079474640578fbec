"""Estimate quantiles, probabilities and Sobol indices from samples, each with a confidence interval.

- A sample may be unknown (NaN) because its point failed, or beyond a range (infinite, with the sign of the side).
  No sample is left out: an unknown sample counts as the smallest value for one bound of an interval and as the largest
  for the other, so that the interval is valid for any value that the failed point could have given.
- Quantiles are order statistics. For independent samples their interval lies between two order statistics and is valid
  for every distribution (binomial interval). For Sobol sequences, which are more even than independent samples, the
  interval comes from the differences between replicates, which are scrambled independently (randomized quasi-Monte
  Carlo).
- Probabilities have the interval of Clopper and Pearson. It assumes independent samples and is therefore too wide for
  Sobol sequences; the spread of replicates is of no use where the event occurs in all samples or in none.
- Sobol indices are Saltelli's estimators in `scipy.stats.sobol_indices`; their intervals are a percentile bootstrap
  over the rows of the design, with a seed.
"""

import math
from typing import Any, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.results.dataset import about
from rollslip.search import Array

__all__ = [
    "Estimate",
    "Indices",
    "estimate_variables",
    "fraction",
    "indices",
    "min_samples",
    "quantile",
    "rank_correlation",
]

#: Resamples of the bootstrap, with which the bounds of Sobol indices are percentiles. Twice as many need twice the time
#: and change the 2.5 % and 97.5 % percentiles by less than their own scatter. Chosen: the usual number of resamples for
#: a 95 % interval.
_RESAMPLES: Final = 999
#: Absolute tolerance of a comparison of a sum of fractions of samples with a probability. Twice the value changes
#: nothing: it lies between the rounding of such sums (1e-16) and the fraction of a single sample (6e-5 of 16384).
_ROUNDING: Final = 1e-12
#: Smallest number of samples from which a rank correlation is computed; below it, the correlation is NaN. A smaller
#: number would report correlations that are chance. Chosen: with 8 samples the standard error is 1/sqrt(7), about 0.4.
_MIN_RANKED: Final = 8


@attrs.frozen
class Estimate:
    """An estimate with the bounds of its confidence interval; a bound that the samples cannot give is infinite."""

    value: float
    low: float
    high: float

    @property
    def half_width(self) -> float:
        """Half of the width of the interval."""
        return 0.5 * (self.high - self.low)


def quantile(
    values: Array, probability: float, *, replicates: int = 1, confidence: float = 0.95
) -> Estimate:
    """Return a quantile of a distribution with its confidence interval.

    Parameters
    ----------
    values : ndarray of float, (n,)
        Samples; NaN where a sample is unknown, infinite where it is beyond a range. Sample k belongs to replicate
        k mod `replicates`.
    probability : float
        Probability of the quantile, above 0 and below 1.
    replicates : int
        Number of independently scrambled sequences among the samples; 1 if all samples are independent.
    confidence : float
        Confidence of the interval.

    Returns
    -------
    Estimate
        The quantile of the known samples, NaN if there is none, and its bounds, infinite where the samples are too few.

    Notes
    -----
    Of independent samples the number below the quantile is binomial: X_(l) and X_(u) enclose it if P(B < l) and
    P(B >= u) are each at most (1 - confidence)/2; Conover, Practical Nonparametric Statistics, 3rd ed., 1999, section
    3.2.

    Of R replicates, each has a fraction F_r(x) of its m samples up to x, with the distribution F(x) as expectation, and
    which are independent of each other. The interval consists of every x for which::

        |mean F_r(x) - p| <= t s(x) / sqrt(R),   s^2(x) = max(sum (F_r(x) - mean F_r(x))^2 / (R - 1), f (1 - f) / m^2)

    with Student's t of R - 1 degrees of freedom and f the fractional part of m p: the number of samples below the
    quantile is a whole number, which cannot vary less, however the samples of a replicate are correlated. Where each
    replicate has one sample only, all samples are independent.

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


def min_samples(probability: float, replicates: int, confidence: float = 0.95) -> int:
    """Return the smallest number of samples with which the interval of a quantile has two finite bounds.

    Below all samples mean and spread of the fractions F_r are zero, so that p m > t^2/(t^2 + R) is needed, with m
    samples in each of R replicates.

    Parameters
    ----------
    probability : float
        Probability of the quantile; p and 1 - p need the same number.
    replicates : int
        Number of replicates, 2 or more.
    confidence : float
        Confidence of the interval.
    """
    from scipy.stats import t

    square = float(t.isf(0.5 * (1.0 - confidence), replicates - 1)) ** 2
    return replicates * (
        math.floor(square / (square + replicates) / min(probability, 1.0 - probability)) + 1
    )


def _binomial(known: Array, n: int, probability: float, confidence: float) -> tuple[float, float]:
    """Binomial interval of a quantile: the order statistics that enclose it, of the known ones of n samples."""
    from scipy.stats import binom

    tail = 0.5 * (1.0 - confidence)
    # the unknown samples may lie below all others
    low_rank = int(binom.ppf(tail, n, probability)) - (n - known.size)
    high_rank = int(binom.isf(tail, n, probability)) + 1
    return (
        float(known[low_rank - 1]) if low_rank >= 1 else -math.inf,
        float(known[high_rank - 1]) if high_rank <= known.size else math.inf,
    )


def _replicated(
    values: Array, probability: float, replicates: int, confidence: float
) -> tuple[float, float]:
    """Interval of a quantile by Student's t over the fractions F_r(x) of independent replicates (see `quantile`)."""
    from scipy.stats import t

    distinct_values = np.unique(values[~np.isnan(values)])
    replicate_samples = [np.sort(values[k::replicates]) for k in range(replicates)]
    sample_counts = np.array([samples.size for samples in replicate_samples], dtype=float)
    # F_r below all values and up to each distinct value; NaN is sorted last
    cumulative_fractions = (
        np.array(
            [
                [0, *np.searchsorted(samples, distinct_values, side="right")]
                for samples in replicate_samples
            ]
        )
        / sample_counts[:, None]
    )
    unknown_fractions = (
        np.array([np.isnan(samples).sum() for samples in replicate_samples]) / sample_counts
    )
    # the second term bounds how much unknown samples can change the spread of the fractions
    spread = cumulative_fractions.std(axis=0, ddof=1) + np.linalg.norm(
        unknown_fractions
    ) / math.sqrt(replicates - 1)
    fractional_rank = np.mod(sample_counts * probability, 1.0)
    spread = np.maximum(
        spread, math.sqrt(np.mean(fractional_rank * (1.0 - fractional_rank) / sample_counts**2))
    )
    half_width = (
        float(t.isf(0.5 * (1.0 - confidence), replicates - 1)) / math.sqrt(replicates) * spread
    )
    mean = cumulative_fractions.mean(axis=0)
    bounds = np.concatenate(([-math.inf], distinct_values, [math.inf]))
    first_index = int(
        np.argmax(mean + unknown_fractions.mean() + half_width >= probability - _ROUNDING)
    )
    last_index = int(np.flatnonzero(mean - half_width <= probability + _ROUNDING)[-1])
    return float(bounds[first_index]), float(bounds[last_index + 1])


def fraction(true: int, unknown: int, n: int, confidence: float = 0.95) -> Estimate:
    """Return the probability of an event that occurs in some of n samples and is unknown in others.

    The interval is that of Clopper and Pearson (1934, doi:10.1093/biomet/26.4.404): for its lower bound the event does
    not occur in the unknown samples, for its upper bound it does.

    Parameters
    ----------
    true : int
        Number of samples in which the event occurs.
    unknown : int
        Number of samples of which it is unknown whether the event occurs.
    n : int
        Number of all samples.
    confidence : float
        Confidence of the interval.

    Returns
    -------
    Estimate
        The fraction among the known samples, NaN if there is none, with its bounds.
    """
    from scipy.stats import binomtest

    low = binomtest(true, n).proportion_ci(confidence, method="exact").low
    high = binomtest(true + unknown, n).proportion_ci(confidence, method="exact").high
    known = n - unknown
    return Estimate(true / known if known else math.nan, float(low), float(high))


def rank_correlation(first: Array, second: Array) -> float:
    """Spearman's rank correlation of two samples; NaN of too few samples, or where all of one are equal.

    Samples beyond a range are infinite and rank as the largest.

    Parameters
    ----------
    first, second : ndarray of float
        Samples; of the longer one the first ones are compared.
    """
    from scipy.stats import spearmanr

    size = min(first.size, second.size)
    known = ~np.isnan(first[:size]) & ~np.isnan(second[:size])
    a = first[:size][known]
    b = second[:size][known]
    if a.size < _MIN_RANKED or np.unique(a).size < 2 or np.unique(b).size < 2:
        return math.nan
    return float(spearmanr(a, b).statistic)


@attrs.frozen(eq=False)
class Indices:
    """Sobol indices of d inputs with their intervals.

    Attributes
    ----------
    first : ndarray of float, (3, d)
        First-order indices: estimates, lower bounds, upper bounds.
    total : ndarray of float, (3, d)
        Total indices: estimates, lower bounds, upper bounds.
    used : int
        Number of rows of the design from which they are estimated.
    """

    first: Array
    total: Array
    used: int


def indices(a: Array, b: Array, ab: Array, seed: int, confidence: float = 0.95) -> Indices | None:
    """Return the Sobol indices of a result that was computed on Saltelli's design.

    Parameters
    ----------
    a : ndarray of float, (n,)
        Results on the rows of the first sample matrix, A.
    b : ndarray of float, (n,)
        Results on the rows of the second, independent sample matrix, B.
    ab : ndarray of float, (d, n)
        Results on the rows of A whose column j is taken from B, for each of the d inputs j.
    seed : int
        Seed of the bootstrap.
    confidence : float
        Confidence of the intervals.

    Returns
    -------
    Indices or None
        None if fewer than four rows are finite, or if all results are equal.

    Notes
    -----
    A row of which a result is not finite is left out; the estimators need a power of two of rows.
    """
    from scipy.stats import sobol_indices

    complete_rows = np.flatnonzero(np.isfinite(a) & np.isfinite(b) & np.isfinite(ab).all(axis=0))
    if complete_rows.size < 4:
        return None
    rows = complete_rows[: 2 ** int(math.log2(complete_rows.size))]
    if np.ptp(np.concatenate((a[rows], b[rows]))) == 0.0:
        return None

    def estimate_indices(rows_of_resample: "NDArray[np.int64]") -> Array:
        mixed = ab[:, rows_of_resample][:, None]
        if len(ab) == 1:
            # SciPy reduces a single input to a scalar, on which it fails
            mixed = np.repeat(mixed, 2, axis=0)
        func: Any = {
            "f_A": a[rows_of_resample][None],
            "f_B": b[rows_of_resample][None],
            "f_AB": mixed,
        }
        estimates = sobol_indices(func=func, n=rows_of_resample.size)
        return np.array([estimates.first_order, estimates.total_order])[:, : len(ab)]

    rng = np.random.default_rng(seed)
    tail = 50.0 * (1.0 - confidence)
    resampled = np.array(
        [estimate_indices(rows[rng.integers(rows.size, size=rows.size)]) for _ in range(_RESAMPLES)]
    )
    low, high = np.percentile(resampled, (tail, 100.0 - tail), axis=0)
    estimates = np.stack([estimate_indices(rows), low, high], axis=1)
    return Indices(estimates[0], estimates[1], rows.size)


def estimate_variables(name: str, estimate: Estimate, doc: str) -> dict[str, Any]:
    """Return three scalar variables of an estimate: its value and both bounds.

    Parameters
    ----------
    name : str
        Name of the value; those of its bounds end in ``_low`` and ``_high``.
    estimate : Estimate
        The estimate.
    doc : str
        What the value is.
    """
    return {
        name: ((), estimate.value, about("1", doc)),
        f"{name}_low": ((), estimate.low, about("1", f"{doc}, low end of its 95 % interval")),
        f"{name}_high": ((), estimate.high, about("1", f"{doc}, high end of its 95 % interval")),
    }
