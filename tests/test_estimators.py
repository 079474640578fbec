"""Estimators of uncertainty against what is known without them."""

import math

import numpy as np
import pytest
from scipy import stats

from rollslip.estimators import indices, quantile, share
from rollslip.sampling import probabilities


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
        whole, found = quantile(values, 0.05), quantile(lost, 0.05)
        assert found.low <= whole.low
        assert found.high >= whole.high
    none = quantile(np.full(9, np.nan), 0.5)
    assert (none.low, none.high) == (-math.inf, math.inf)


def test_samples_beyond_a_range_keep_their_side():
    values = np.r_[np.linspace(0.0, 1.0, 600), np.full(400, np.inf)]
    assert quantile(values, 0.3).high < 1.0
    assert quantile(values, 0.9).value == math.inf


def test_probabilities_have_the_interval_of_clopper_and_pearson():
    found = share(190, 0, 200)
    assert found.low == pytest.approx(stats.beta.ppf(0.025, 190, 11), rel=1e-12)
    assert found.high == pytest.approx(stats.beta.ppf(0.975, 191, 10), rel=1e-12)
    lost = share(180, 10, 200)  # of 190 true ones ten are not known
    assert lost.low < found.low
    assert lost.high == found.high


def test_the_margin_of_two_normals_is_the_analytic_one():
    # P(X < Y) = Phi((m_y - m_x)/sqrt(s_x^2 + s_y^2))
    z = stats.norm.ppf(probabilities("sobol", 4096, 2, 3))
    operating, critical = 0.05 + 0.01 * z[:, 0], 0.10 + 0.02 * z[:, 1]
    exact = stats.norm.cdf(0.05 / math.hypot(0.01, 0.02))
    found = share(int((operating < critical).sum()), 0, 4096)
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
    v1, v2, v13 = 0.5 * (1 + 0.1 * math.pi**4 / 5) ** 2, 49 / 8, 0.01 * math.pi**8 * (1 / 18 - 1 / 50)
    v = v1 + v2 + v13
    return [v1 / v, v2 / v, 0.0], [(v1 + v13) / v, v2 / v, v13 / v]


def _g_indices(a=(0.0, 1.0, 4.5, 9.0)):
    parts = np.array([1 / 3 / (1 + one) ** 2 for one in a])
    v = np.prod(1 + parts) - 1
    return parts / v, [part * np.prod(np.delete(1 + parts, k)) / v for k, part in enumerate(parts)]


@pytest.mark.parametrize(("law", "d", "exact"), [(_ishigami, 3, _ishigami_indices()), (_g_function, 4, _g_indices())])
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


@pytest.mark.parametrize("p", [0.05, 0.5])
def test_intervals_hold_for_samples_of_a_sobol_sequence_and_are_rather_too_wide(p):
    exact = math.exp(math.hypot(0.3, 0.2) * stats.norm.ppf(p))
    found = []
    for seed in range(60):
        z = stats.norm.ppf(probabilities("sobol", 512, 2, seed))
        found.append(quantile(np.exp(z @ [0.3, 0.2]), p))
    assert sum(one.low <= exact <= one.high for one in found) >= 57  # 95 % of them
    assert 1.96 * np.std([one.value for one in found]) < np.mean([one.half_width for one in found])
