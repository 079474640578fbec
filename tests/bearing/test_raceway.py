"""Few loads that stand for all slices of a raceway."""

import numpy as np
import pytest

from rollslip import load_scene
from rollslip.bearing.assembly import assemble
from rollslip.bearing.raceway import LoadedContacts, gauss_rule, load_rule
from rollslip_kernels.gauss import rules

pytestmark = pytest.mark.quick


def test_a_gauss_rule_is_exact_for_polynomials_in_the_root_of_the_load():
    rng = np.random.default_rng(3)
    load = rng.uniform(1.0, 9.0, 500)
    force = rng.uniform(0.0, 1.0, 500)
    nodes, fractions = gauss_rule(load, force, 6).T
    assert ((nodes > load.min()) & (nodes < load.max()) & (fractions > 0.0)).all()
    for power in range(12):
        want = (force * load ** (power / 2)).sum() / force.sum()
        assert fractions @ nodes ** (power / 2) == pytest.approx(want, rel=1e-12)
    want = (force * load**6).sum() / force.sum()
    assert abs(fractions @ nodes**6 / want - 1.0) > 1e-9  # degree 12 is beyond it


def test_few_loads_stand_for_all_only_where_they_are_right():
    load = np.geomspace(1.0, 100.0, 3000)

    def of(law):
        return load_rule(load, load, lambda rule: np.array([law(rule[:, 0]) @ rule[:, 1]]), 1e-6)

    assert of(lambda w: 1.0 / (1.0 + w)).shape[0] <= 32
    kinked = of(lambda w: np.where(w > 30.0, 1.0, 0.0))
    assert kinked.shape == (3000, 2)
    np.testing.assert_allclose(kinked[:, 1], load / load.sum())
    assert load_rule(load[:5], load[:5], lambda rule: rule[:, 0], 1e-6).shape == (5, 2)


def test_rules_of_rows_are_those_of_each_alone_and_weigh_nothing_that_is_not_there():
    rng = np.random.default_rng(5)
    load = rng.uniform(1.0, 9.0, (4, 40))
    weight = rng.uniform(0.1, 1.0, (4, 40))
    load[1, 25:] = weight[1, 25:] = 0.0  # not loaded
    load[2] = 3.0  # one load
    weight[3] = load[3] = 0.0  # none
    nodes, weights = rules(load.ravel(), weight.ravel(), 40 * np.arange(5), 6)
    np.testing.assert_allclose(weights.sum(axis=1), weight.sum(axis=1), rtol=1e-13)
    for k in (0, 1):
        some = weight[k] > 0.0
        alone, fraction = gauss_rule(load[k][some], weight[k][some], 6).T
        np.testing.assert_allclose(nodes[k], alone, rtol=1e-11)
        np.testing.assert_allclose(weights[k], fraction * weight[k].sum(), rtol=1e-10)
    assert weights[2] @ nodes[2] == pytest.approx(weight[2].sum() * 3.0, rel=1e-13)
    assert not weights[3].any()


@pytest.mark.parametrize("whole", [False, True])
def test_few_loads_of_a_roller_carry_its_force_and_have_its_friction(whole):
    """Friction of all slices is what is held against; 89 of them, of which half are evaluated."""
    assembly = assemble(load_scene("1032930-70C"))
    loads = assembly.load_distribution(1).inner_load[0]
    contacts = LoadedContacts(assembly.inner, loads, assembly.widths, 1.0)
    few = contacts.reduced(24 if whole else 8, whole=whole).on(assembly.inner)
    assert few.force.size < contacts.force.size / 3
    assert few.total == pytest.approx(contacts.total, rel=1e-13)
    for u, V in ((25.0, 0.2), (20.0, 3.0), (12.0, 15.0)):
        all_of, some = (of.per_roller(of.friction(u, V) * of.force) for of in (contacts, few))
        if whole:
            all_of = all_of.sum()
            some = some.sum()
        np.testing.assert_allclose(some, all_of, rtol=2e-7)


def test_loads_that_differ_by_rounding_alone_leave_no_node_without_load():
    """Rollers either side of the load have one load but for rounding: the rule is these loads with all their force."""
    few = np.array([2e3, 3e3, 5e3])
    forces = np.array([1.0, 2.0, 4.0])
    load = np.concatenate([few, few * (1.0 + 2.0**-52), few * (1.0 - 2.0**-52)])
    assert np.unique(load).size == 9
    rule = gauss_rule(load, np.tile(forces, 3), 8)
    assert rule[:, 0] == pytest.approx(few, rel=1e-9)
    assert rule[:, 1] == pytest.approx(forces / forces.sum(), rel=1e-9)
