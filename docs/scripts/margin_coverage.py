"""Write docs/tables/margin_coverage.csv: how often the 95 % interval of a quantile holds the quantile that is known.

- Each function of uniform variables has quantiles in closed form, or as a root of its distribution. Some are smooth,
  one jumps across a plane that is oblique to its variables, one has no mean.
- Every row is of 1000 seeds: the share of intervals that hold the quantile, for eight scramblings of a Sobol sequence
  (`rollslip_campaigns.uncertainty.estimators.quantile` with replicates) and, in brackets, for order statistics of as
  many samples of a single scrambling; and the ratio of the median widths. An interval with an end that its samples
  cannot tell has no width.
- The last row of each doubles the samples until the interval is as narrow as the median one of 1024 samples, with the
  confidence that ``--until`` takes since ending so favours intervals that are narrow by chance.

About four minutes of one core.
"""

import math

import numpy as np
from output import write_table
from scipy.optimize import brentq
from scipy.stats import cauchy, norm

from rollslip_campaigns.sweep.sampling import REPLICATES, probabilities
from rollslip_campaigns.uncertainty.estimators import quantile
from rollslip_campaigns.uncertainty.plan import STOPPING_CONFIDENCE

SEEDS = 1000
SAMPLES = (256, 512, 1024, 2048, 4096)
UNTIL = "until as 1024"
QUANTILES = (0.01, 0.05, 0.5)
SIZES = np.array([0.3, 0.2, 0.1, 0.05])
#: Correlation between all normal variables.
CORRELATED = np.linalg.cholesky(0.5 + 0.5 * np.eye(4))


def lognormal(u):
    return np.exp(norm.ppf(u) @ SIZES)


def lognormal_quantile(p):
    return math.exp(np.linalg.norm(SIZES) * norm.ppf(p))


def correlated(u):
    return np.exp(norm.ppf(u) @ CORRELATED.T @ SIZES)


def correlated_quantile(p):
    return math.exp(np.linalg.norm(CORRELATED.T @ SIZES) * norm.ppf(p))


def oblique_jump(u):
    """x + 3 where y > 0, with independent x and y that are turned by 45 degrees."""
    z = norm.ppf(u)
    return (z[:, 0] - z[:, 1]) / math.sqrt(2.0) + 3.0 * (z[:, 0] + z[:, 1] > 0.0)


def oblique_jump_quantile(p):
    return brentq(lambda x: 0.5 * (norm.cdf(x) + norm.cdf(x - 3.0)) - p, -10.0, 13.0)


CASES = {
    "square of one": (1, lambda u: u[:, 0] ** 2, lambda p: p**2),
    "log-normal product of four": (4, lognormal, lognormal_quantile),
    "the same, correlated": (4, correlated, correlated_quantile),
    "sum of eight normal": (
        8,
        lambda u: norm.ppf(u).sum(axis=1),
        lambda p: math.sqrt(8.0) * norm.ppf(p),
    ),
    "oblique jump of two": (2, oblique_jump, oblique_jump_quantile),
    "sum of two Cauchy": (
        2,
        lambda u: cauchy.ppf(u[:, :2]).sum(axis=1),
        lambda p: 2.0 * cauchy.ppf(p),
    ),
}


def told(estimates, exact):
    """Share of intervals that hold the quantile, and median of their half widths."""
    held = np.mean([one.low <= exact <= one.high for one in estimates])
    return 100.0 * held, float(np.median([one.half_width for one in estimates]))


def until(batches, half_width):
    """Return of every seed the first estimate that is as narrow, or the last one."""
    return [
        next((one for one in row if one.half_width <= half_width), row[-1])
        for row in zip(*batches, strict=True)
    ]


if __name__ == "__main__":
    rows = []
    for name, (d, law, exact) in CASES.items():
        several, single = (
            [law(probabilities(sampling, max(SAMPLES), d, seed)) for seed in range(SEEDS)]
            for sampling in ("replicated-sobol", "sobol")
        )
        table = {n: ([], []) for n in (*SAMPLES, UNTIL)}
        for p in QUANTILES:
            ours = [[quantile(v[:n], p, replicates=REPLICATES) for v in several] for n in SAMPLES]
            plain = [[quantile(v[:n], p) for v in single] for n in SAMPLES]
            wider = [
                [
                    quantile(v[:n], p, replicates=REPLICATES, confidence=STOPPING_CONFIDENCE)
                    for v in several
                ]
                for n in SAMPLES
            ]
            for found, batches in ((ours, wider), (plain, plain)):
                found.append(until(batches, told(batches[SAMPLES.index(1024)], exact(p))[1]))
            for (covered, ratios), one, other in zip(table.values(), ours, plain, strict=True):
                (held, width) = told(one, exact(p))
                (held_plain, width_plain) = told(other, exact(p))
                covered.append(f"{held:.1f} ({held_plain:.1f})")
                ratios.append(
                    f"{width / width_plain:.2f}" if np.isfinite(width / width_plain) else "–"
                )
        for n, (covered, ratios) in table.items():
            rows.append((name, n, *covered, *ratios))
            print(*rows[-1], sep=", ", flush=True)
    fractions = [f"{100 * p:g} %" for p in QUANTILES]
    write_table(
        "margin_coverage",
        (
            "function",
            "samples",
            *(f"held at {p} [%]" for p in fractions),
            *(f"width at {p}" for p in fractions),
        ),
        rows,
    )
