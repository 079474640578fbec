"""Estimators of uncertainty against what is known without them."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import optimize, stats

from rollslip_campaigns.sweep.sampling import REPLICATES, probabilities
from rollslip_campaigns.uncertainty.estimators import (
    Estimate,
    fraction,
    indices,
    min_samples,
    quantile,
)


@pytest.mark.parametrize("n", [40, 500, 1777])
@pytest.mark.parametrize("p", [0.01, 0.1, 0.5, 0.99])
def test_intervals_of_quantiles_are_those_of_scipy(n, p):
    values = np.random.default_rng(n).gamma(2.0, size=n)
    reference = stats.quantile_test(values, p=p).confidence_interval(0.95)
    found = quantile(values, p)
    for ours, theirs in ((found.low, reference.low), (found.high, reference.high)):
        assert ours == theirs or (math.isinf(ours) and math.isnan(theirs))
    assert found.value == np.quantile(values, p, method="inverted_cdf")


def test_intervals_hold_what_unknown_samples_would_have_given():
    values = np.random.default_rng(1).normal(size=1000)
    for kind in (np.argsort(values)[:15], np.argsort(values)[-15:], np.arange(0, 1000, 70)):
        lost = values.copy()
        lost[kind] = np.nan
        whole = quantile(values, 0.05)
        found = quantile(lost, 0.05)
        assert found.low <= whole.low
        assert found.high >= whole.high
    none = quantile(np.full(9, np.nan), 0.5)
    assert (none.low, none.high) == (-math.inf, math.inf)


def test_samples_beyond_a_range_keep_their_side():
    values = np.r_[np.linspace(0.0, 1.0, 600), np.full(400, np.inf)]
    assert quantile(values, 0.3).high < 1.0
    assert quantile(values, 0.9).value == math.inf


def test_probabilities_have_the_interval_of_clopper_and_pearson():
    found = fraction(190, 0, 200)
    assert found.low == pytest.approx(stats.beta.ppf(0.025, 190, 11), rel=1e-12)
    assert found.high == pytest.approx(stats.beta.ppf(0.975, 191, 10), rel=1e-12)
    lost = fraction(180, 10, 200)  # of 190 true ones ten are not known
    assert lost.low < found.low
    assert lost.high == found.high


def test_the_margin_of_two_normals_is_the_analytic_one():
    # P(X < Y) = Phi((m_y - m_x)/sqrt(s_x^2 + s_y^2))
    z = stats.norm.ppf(probabilities("sobol", 4096, 2, 3))
    operating = 0.05 + 0.01 * z[:, 0]
    critical = 0.10 + 0.02 * z[:, 1]
    exact = stats.norm.cdf(0.05 / math.hypot(0.01, 0.02))
    found = fraction(int((operating < critical).sum()), 0, 4096)
    assert found.low < exact < found.high
    assert found.value == pytest.approx(exact, abs=2e-3)
    allowed = quantile(critical, 0.01)
    assert allowed.low < 0.10 + 0.02 * stats.norm.ppf(0.01) < allowed.high


def _ishigami(u):
    x = math.pi * (2.0 * u - 1.0)
    return np.sin(x[:, 0]) + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])


def _g_function(u, a=(0.0, 1.0, 4.5, 9.0)):
    a = np.array(a)
    return np.prod((np.abs(4.0 * u[:, : a.size] - 2.0) + a) / (1.0 + a), axis=1)


def _ishigami_indices():
    v1 = 0.5 * (1 + 0.1 * math.pi**4 / 5) ** 2
    v2 = 49 / 8
    v13 = 0.01 * math.pi**8 * (1 / 18 - 1 / 50)
    v = v1 + v2 + v13
    return [v1 / v, v2 / v, 0.0], [(v1 + v13) / v, v2 / v, v13 / v]


def _g_indices(a=(0.0, 1.0, 4.5, 9.0)):
    parts = np.array([1 / 3 / (1 + one) ** 2 for one in a])
    v = np.prod(1 + parts) - 1
    return parts / v, [part * np.prod(np.delete(1 + parts, k)) / v for k, part in enumerate(parts)]


@pytest.mark.parametrize(
    ("law", "d", "exact"), [(_ishigami, 3, _ishigami_indices()), (_g_function, 4, _g_indices())]
)
def test_sobol_indices_are_the_analytic_ones(law, d, exact):
    values = law(probabilities("saltelli", 4096, d, 11)).reshape(-1, d + 2)
    found = indices(values[:, 0], values[:, 1], values[:, 2:].T, seed=0)
    assert found.used == 4096
    for ours, theirs in ((found.first, exact[0]), (found.total, exact[1])):
        assert ours[0] == pytest.approx(theirs, abs=0.02)
        assert np.all(ours[1] <= ours[0])
        assert np.all(ours[0] <= ours[2])
        assert np.all((ours[1] - 0.01 <= theirs) & (theirs <= ours[2] + 0.01))


def test_rows_with_unknown_results_are_not_used_and_nothing_is_made_of_a_constant():
    values = _ishigami(probabilities("saltelli", 64, 3, 11)).reshape(-1, 5)
    values[5, 2] = np.nan
    assert indices(values[:, 0], values[:, 1], values[:, 2:].T, seed=0).used == 32
    flat = np.ones((64, 5))
    assert indices(flat[:, 0], flat[:, 1], flat[:, 2:].T, seed=0) is None


def test_one_input_makes_all_of_the_variance():
    values = probabilities("saltelli", 256, 1, 11).reshape(-1, 3)
    found = indices(values[:, 0], values[:, 1], values[:, 2:].T, seed=0)
    assert found.first[0] == pytest.approx([1.0], abs=0.02)
    assert found.total[0] == pytest.approx([1.0], abs=0.02)


def _lognormal(u):
    return np.exp(stats.norm.ppf(u) @ [0.3, 0.2])


def _jump(u):
    """x + 3 where y > 0, with independent normal x and y that are turned by 45 degrees."""
    z = stats.norm.ppf(u)
    return (z[:, 0] - z[:, 1]) / math.sqrt(2.0) + 3.0 * (z[:, 0] + z[:, 1] > 0.0)


def _lognormal_fraction(x):
    return stats.norm.cdf(math.log(x) / math.hypot(0.3, 0.2))


def _jump_fraction(x):
    return 0.5 * (stats.norm.cdf(x) + stats.norm.cdf(x - 3.0))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "distribution"), [(_lognormal, _lognormal_fraction), (_jump, _jump_fraction)]
)
def test_intervals_of_replicates_hold_and_are_narrower_than_order_statistics(law, distribution):
    # of 150 intervals that hold with 95 % fewer than 135 do with a probability of 0.4 %
    several = [law(probabilities("replicated-sobol", 256, 2, seed)) for seed in range(150)]
    single = [law(probabilities("sobol", 256, 2, seed)) for seed in range(150)]
    for p in (0.05, 0.5):
        exact = optimize.brentq(
            lambda x, p=p: distribution(x) - p, 0.01 if law is _lognormal else -9.0, 9.0
        )
        found = [quantile(values, p, replicates=REPLICATES) for values in several]
        plain = [quantile(values, p) for values in single]
        assert sum(one.low <= exact <= one.high for one in found) >= 135
        assert np.median([one.half_width for one in found]) < 0.75 * np.median(
            [one.half_width for one in plain]
        )


@pytest.mark.parametrize("p", [0.01, 0.05, 0.1, 0.5, 0.95, 0.99])
def test_the_interval_of_replicates_is_where_students_t_does_not_reject(p):
    values = stats.norm.ppf(probabilities("replicated-sobol", 1024, 2, 5)).sum(axis=1)
    found = quantile(values, p, replicates=REPLICATES)

    def rejects(x):
        fractions = (values.reshape(-1, REPLICATES) <= x).mean(axis=0)
        part = 128 * p % 1.0
        error = math.sqrt(max(fractions.var(ddof=1), part * (1 - part) / 128**2) / REPLICATES)
        return abs(fractions.mean() - p) > stats.t.ppf(0.975, REPLICATES - 1) * error

    between = np.sort(values)
    between = 0.5 * (between[1:] + between[:-1])
    held = between[[not rejects(x) for x in between]]
    assert found.low < held[0] < held[-1] < found.high
    outside = between[(between < found.low) | (between > found.high)]
    assert all(rejects(x) for x in outside)


def test_replicates_with_samples_too_few_in_a_tail_do_not_tell_its_end():
    values = probabilities("replicated-sobol", 256, 1, 0)[:, 0]
    assert quantile(values, 0.01, replicates=REPLICATES).low == -math.inf
    assert quantile(values, 0.99, replicates=REPLICATES).high == math.inf
    # one sample of each: all are independent
    assert quantile(values[:8], 0.5, replicates=REPLICATES) == quantile(values[:8], 0.5)


def test_replicates_of_one_value_have_no_width_and_those_beyond_a_range_keep_their_side():
    assert quantile(np.ones(64), 0.5, replicates=REPLICATES) == Estimate(1.0, 1.0, 1.0)
    values = probabilities("replicated-sobol", 512, 2, 3).sum(axis=1)
    beyond = np.where(values > 1.1, np.inf, values)  # at 0.595
    assert quantile(beyond, 0.3, replicates=REPLICATES) == quantile(
        values, 0.3, replicates=REPLICATES
    )
    assert quantile(beyond, 0.59, replicates=REPLICATES).high == math.inf
    assert quantile(beyond, 0.9, replicates=REPLICATES).low == math.inf


@pytest.mark.parametrize("p", [0.01, 0.05, 0.1, 0.3, 0.9, 0.99])
@pytest.mark.parametrize("confidence", [0.95, 0.975])
def test_from_the_fewest_samples_on_an_interval_has_two_ends(p, confidence):
    n = min_samples(p, REPLICATES, confidence)
    low = p < 0.5
    for count, told in ((n, True), (n - REPLICATES, False)):
        values = np.sort(probabilities("replicated-sobol", count, 1, 0)[:, 0])
        found = quantile(values, p, replicates=REPLICATES, confidence=confidence)
        assert math.isfinite(found.low if low else found.high) is told


@given(
    seed=st.integers(0, 999),
    lost=st.lists(st.integers(0, 127), min_size=1, max_size=12),
    others=st.lists(
        st.floats(-3.0, 3.0) | st.sampled_from([-math.inf, math.inf]), min_size=12, max_size=12
    ),
    p=st.sampled_from([0.05, 0.3, 0.5, 0.9]),
)
def test_intervals_of_replicates_hold_what_unknown_samples_would_have_given(seed, lost, others, p):
    values = stats.norm.ppf(probabilities("replicated-sobol", 128, 1, seed))[:, 0]
    gaps = values.copy()
    whole = values.copy()
    gaps[lost] = np.nan
    whole[lost] = others[: len(lost)]
    found, exact = (quantile(one, p, replicates=REPLICATES) for one in (gaps, whole))
    assert found.low <= exact.low
    assert exact.high <= found.high


@pytest.mark.parametrize("p", [0.3, 0.5])
@pytest.mark.parametrize("filled", [-9.0, 9.0])
def test_unknown_samples_of_one_replicate_widen_the_interval_by_all_that_they_may(p, filled):
    """All unknown samples in the one replicate that differs, so that they may move the spread the most."""
    values = np.repeat(np.linspace(0.0, 1.0, 100), REPLICATES)
    values[::REPLICATES] -= 0.4
    values[::REPLICATES][-10:] = np.nan
    found = quantile(values, p, replicates=REPLICATES)
    exact = quantile(np.where(np.isnan(values), filled, values), p, replicates=REPLICATES)
    assert found.low <= exact.low
    assert exact.high <= found.high


def test_intervals_of_indices_have_the_confidence_asked_for():
    """Resampled indices are nearly normal: intervals of 68.27 and 95 % are 1 and 1.96 standard deviations wide."""
    values = _g_function(probabilities("saltelli", 1024, 4, 11)).reshape(-1, 6)
    wide, narrow = (
        indices(values[:, 0], values[:, 1], values[:, 2:].T, 0, confidence)
        for confidence in (0.95, 0.6827)
    )
    ratio = (wide.total[2] - wide.total[1]) / (narrow.total[2] - narrow.total[1])
    assert ratio == pytest.approx(np.full(4, 1.96), rel=0.15)
