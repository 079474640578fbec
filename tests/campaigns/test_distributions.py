"""Distributions of uncertain values against SciPy's, and what is refused of the table that states them."""

import math

import numpy as np
import pytest
import scipy.stats
from hypothesis import given
from hypothesis import strategies as st

import rollslip
from rollslip.bearing.assembly import assemble
from rollslip.structure import Location
from rollslip.studies.quantities import quantities
from rollslip.studies.study import settings
from rollslip_campaigns.sweep.sampling import probabilities
from rollslip_studies.variation.distributions import DISTRIBUTIONS, Uncertainty, read_uncertainty

pytestmark = pytest.mark.quick

SCENE = rollslip.load_scene("1032930-70C")
KNOWN = quantities(assemble(SCENE), settings(SCENE))
P = np.linspace(0.001, 0.999, 333)


def read(table):
    problems = []
    return read_uncertainty(table, Location({}, ("uncertainty",)), KNOWN, problems), problems


def of_load(**table):
    """The distribution of the radial load, 3415 N in the scene."""
    found, problems = read({"operation": {"radial_load": table}})
    assert not problems
    return found.distributions["operation.radial_load"]


LOGNORMAL = scipy.stats.lognorm(math.sqrt(math.log(1.09)), scale=3415.0)


@pytest.mark.parametrize(
    ("table", "theirs"),
    [
        ({"distribution": "normal", "mean": "3 kN", "deviation": 200}, scipy.stats.norm(3000.0, 200.0)),
        ({"distribution": "normal", "scatter": 0.1}, scipy.stats.norm(3415.0, 341.5)),
        ({"distribution": "lognormal", "scatter": 0.3}, LOGNORMAL),
        ({"distribution": "uniform", "low": "1 kN", "high": "2 kN"}, scipy.stats.uniform(1000.0, 1000.0)),
        ({"distribution": "uniform", "scatter": 0.2}, scipy.stats.uniform(2732.0, 1366.0)),
        ({"distribution": "log-uniform", "low": 100, "high": "10 kN"}, scipy.stats.loguniform(100.0, 1e4)),
        ({"distribution": "triangular", "low": 2415, "high": 5415}, scipy.stats.triang(1 / 3, 2415.0, 3000.0)),
        ({"distribution": "triangular", "low": 0, "mode": 0, "high": 2}, scipy.stats.triang(0.0, 0.0, 2.0)),
        ({"distribution": "normal", "scatter": 0.5, "at_least": 3000, "at_most": "4 kN"},
         scipy.stats.truncnorm((3000 - 3415) / 1707.5, (4000 - 3415) / 1707.5, 3415.0, 1707.5)),
    ],
)  # fmt: skip
def test_quantiles_are_those_of_scipy(table, theirs):
    np.testing.assert_allclose(of_load(**table).quantile(P), theirs.ppf(P), rtol=1e-12)


def test_scatter_is_the_standard_deviation_over_the_mean():
    assert LOGNORMAL.std() / LOGNORMAL.mean() == pytest.approx(0.3, rel=1e-12)
    assert LOGNORMAL.median() == pytest.approx(3415.0)


@pytest.mark.parametrize("name", DISTRIBUTIONS)
@given(low=st.floats(0.05, 0.5), width=st.floats(0.01, 0.4))
def test_a_truncated_distribution_keeps_its_ends_and_its_shape(name, low, width):
    own = {"triangular": {"low": 1000, "high": 9000}, "log-uniform": {"low": 1000, "high": 9000}}
    table = {"distribution": name, **own.get(name, {"scatter": 0.3})}
    whole = of_load(**table)
    ends = whole.quantile(np.array([low, low + width]))
    cut = of_load(**table, at_least=ends[0], at_most=ends[1])
    values = cut.quantile(P)
    assert (values >= ends[0]).all()
    assert (values <= ends[1]).all()
    np.testing.assert_allclose(values, whole.quantile(low + P * width), rtol=1e-9)


def test_correlated_values_have_the_rank_correlation_of_the_copula_and_their_own_distributions():
    rho = -0.7
    found, problems = read(
        {
            "operation": {
                "radial_load": {"distribution": "lognormal", "scatter": 0.4},
                "temperature": {"distribution": "uniform", "low": "60 degC", "high": "80 degC"},
                "inner_speed": {"distribution": "normal", "scatter": 0.1},
            },
            "correlation": [
                {"between": ["operation.temperature", "operation.radial_load"], "coefficient": rho}
            ],
        }
    )
    assert not problems
    drawn = probabilities("sobol", 2**14, 3, 1)
    load, temperature, speed = found.values(drawn).T
    # Spearman's rank correlation of a Gaussian copula, e.g. Kruskal, J. Am. Stat. Assoc. 53 (1958)
    assert scipy.stats.spearmanr(load, temperature)[0] == pytest.approx(
        6 / math.pi * math.asin(rho / 2), abs=2e-3
    )
    assert abs(scipy.stats.spearmanr(load, speed)[0]) < 2e-3
    assert scipy.stats.kstest(temperature, scipy.stats.uniform(333.15, 20.0).cdf).statistic < 2e-3
    assert np.array_equal(speed, found.distributions["operation.inner_speed"].quantile(drawn[:, 2]))
    assert np.array_equal(found.values(drawn[5:6])[0], found.values(drawn)[5]), (
        "one sample alone has the same bits"
    )


def test_nothing_uncertain_has_no_values():
    assert Uncertainty({}, np.empty((0, 0))).values(np.empty((3, 0))).shape == (3, 0)


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ({"operation": {"radial_laod": {"distribution": "normal", "scatter": 0.1}}},
         "uncertainty.operation.radial_laod: there is no single value of this key to vary; did you mean "
         "'operation.radial_load'?"),
        ({"operation": {"radial_load": {"distribution": "norml", "scatter": 0.1}}},
         "uncertainty.operation.radial_load.distribution: no distribution is called 'norml'; did you mean 'normal'?"),
        ({"operation": {"radial_load": {"distribution": "normal", "scater": 0.1}}},
         "scater: unknown key, did you mean 'scatter'?"),
        ({"operation": {"radial_load": {"distribution": "normal", "deviation": "5 mm"}}},
         "deviation: '5 mm' is a length"),
        ({"operation": {"radial_load": {"distribution": "normal", "deviation": "5"}}}, "deviation: '5' has no unit"),
        ({"operation": {"radial_load": {"distribution": "normal"}}}, "deviation: give either deviation or scatter"),
        ({"operation": {"radial_load": {"distribution": "lognormal"}}}, "scatter: missing, but required"),
        ({"operation": {"radial_load": {"distribution": "lognormal", "scatter": -0.1}}}, "scatter: must be above 0"),
        ({"operation": {"radial_load": {"distribution": "uniform", "low": 5}}}, "low: give low and high, or scatter"),
        ({"operation": {"radial_load": {"distribution": "uniform", "low": 5, "high": 4}}}, "high: must be above low"),
        ({"operation": {"radial_load": {"distribution": "triangular", "low": 5, "high": 6}}},
         "mode: low, mode and high must"),
        ({"operation": {"radial_load": {"distribution": "normal", "scatter": 1, "at_least": 9, "at_most": 8}}},
         "at_most: must be above at_least"),
        ({"operation": {"radial_load": {"distribution": "normal", "scatter": 1, "at_least": 9, "at_most": 9}}},
         "at_most: must be above at_least"),
        ({"operation": {"radial_load": {"distribution": "uniform", "low": 1, "high": 2, "at_least": 3}}},
         "at_least: leaves nothing of the distribution"),
        ({"operation": {"temperature": {"distribution": "normal", "deviation": "5 degC"}}},
         "a difference of temperatures is expected, such as '5 K'"),
        ({"operation": {"misalignment": {"distribution": "normal", "scatter": 0.1}}},
         "of a mean of 0 a relative scatter says"),
        ({"operation": {"radial_load": 5}}, "a table with distribution = 'NAME' is expected, not 5"),
        ({"bearing": {"rollers": {"distribution": "normal", "scatter": 0.1}}}, "is not a number with a unit"),
        ({"lubricant": {"pressure_viscosity": {"distribution": "normal", "scatter": 0.1}}},
         "mean: missing, and the scene has no value of its own"),
        ({"correlation": [{"between": ["a", "b"], "coefficient": 0.5}]}, "'a' has no distribution here"),
        ({"correlation": [{"between": ["a"], "coefficient": 0.5}]}, "two different keys are expected"),
        ({"correlation": [{"between": ["a", "b"], "coefficient": 1.0}]}, "must be between -1 and 1, without the ends"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_table_is_said(table, said):
    _, problems = read(table)
    assert any(said in problem for problem in problems), problems
    assert all(problem.startswith("uncertainty.") for problem in problems)


def test_correlations_that_cannot_be_are_refused():
    keys = ["operation.radial_load", "operation.inner_speed", "operation.temperature"]
    table = {
        "operation": {k.partition(".")[2]: {"distribution": "normal", "scatter": 0.1} for k in keys}
    }
    pairs = [(0, 1, 0.9), (1, 2, 0.9), (0, 2, -0.9)]
    table["correlation"] = [{"between": [keys[i], keys[j]], "coefficient": c} for i, j, c in pairs]
    assert "the matrix of the coefficients is not positive definite" in read(table)[1][0]
    table["correlation"] = 2 * table["correlation"][:1]
    assert "these two have a correlation already" in read(table)[1][0]
