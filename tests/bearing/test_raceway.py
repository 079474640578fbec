"""Few loads that stand for all slices of a raceway."""

import numpy as np
import pytest

from rollslip.bearing.raceway import gauss_rule, load_rule

pytestmark = pytest.mark.quick


def test_a_gauss_rule_is_exact_for_polynomials_in_the_root_of_the_load():
    rng = np.random.default_rng(3)
    load, force = rng.uniform(1.0, 9.0, 500), rng.uniform(0.0, 1.0, 500)
    nodes, shares = gauss_rule(load, force, 6).T
    assert ((nodes > load.min()) & (nodes < load.max()) & (shares > 0.0)).all()
    for power in range(12):
        want = (force * load ** (power / 2)).sum() / force.sum()
        assert shares @ nodes ** (power / 2) == pytest.approx(want, rel=1e-12)
    want = (force * load**6).sum() / force.sum()
    assert abs(shares @ nodes**6 / want - 1.0) > 1e-9  # degree 12 is beyond it


def test_few_loads_stand_for_all_only_where_they_are_right():
    load = np.geomspace(1.0, 100.0, 3000)

    def of(law):
        return load_rule(load, load, lambda rule: np.array([law(rule[:, 0]) @ rule[:, 1]]), 1e-6)

    assert of(lambda w: 1.0 / (1.0 + w)).shape[0] <= 32
    kinked = of(lambda w: np.where(w > 30.0, 1.0, 0.0))
    assert kinked.shape == (3000, 2)
    np.testing.assert_allclose(kinked[:, 1], load / load.sum())
    assert load_rule(load[:5], load[:5], lambda rule: rule[:, 0], 1e-6).shape == (5, 2)
