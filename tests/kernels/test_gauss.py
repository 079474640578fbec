"""Gauss rules against the closed form of equal weights, another form of the recurrence, and many digits."""

import mpmath
import numpy as np
import pytest

from rollslip_kernels.gauss import legendre, row_rules, rules

pytestmark = pytest.mark.quick


@pytest.mark.parametrize("count", [1, 2, 8, 24])
def test_equal_weights_at_equal_steps_have_the_rule_of_gram_s_polynomials(count):
    """Their recurrence is known: alpha = (N - 1)/2, beta_k = k^2 (N^2 - k^2)/(4 (4 k^2 - 1))."""
    points = 101
    k = np.arange(1, count)
    beside = np.sqrt(k**2 * (points**2 - k**2) / (4.0 * (4.0 * k**2 - 1.0)))
    jacobi = np.diag(np.full(count, (points - 1) / 2.0)) + np.diag(beside, 1) + np.diag(beside, -1)
    want, vectors = np.linalg.eigh(jacobi)
    nodes, weights = rules(
        np.arange(points) ** 2.0, np.full(points, 3.0), np.array([0, points]), count
    )
    np.testing.assert_allclose(np.sqrt(nodes[0]), want, rtol=0, atol=1e-13 * points)
    np.testing.assert_allclose(
        weights[0], 3.0 * points * vectors[0] ** 2, rtol=0, atol=1e-13 * points * 3.0
    )


def by_numpy(load, weight, count):
    """Lanczos' recurrence, orthogonal to all before twice, of one row; its matrix by LAPACK."""
    x = np.sqrt(load)
    vector = np.sqrt(weight / weight.sum())
    basis = np.zeros((count, load.size))
    jacobi = np.zeros((count, count))
    for k in range(count):
        basis[k] = vector
        vector = x * vector
        jacobi[k, k] = basis[k] @ vector
        for _ in range(2):
            vector = vector - (basis[: k + 1] @ vector) @ basis[: k + 1]
        if k + 1 < count:
            jacobi[k, k + 1] = jacobi[k + 1, k] = norm = np.linalg.norm(vector)
            vector = vector / norm
    nodes, vectors = np.linalg.eigh(jacobi)
    return nodes, vectors[0] ** 2 * weight.sum()


@pytest.mark.parametrize(("points", "count"), [(13, 8), (31, 8), (400, 4), (400, 64)])
def test_rules_of_loads_as_of_a_roller_are_those_of_numpy(points, count):
    """Loads that end between slices, as of a crowned roller; some rows have no more of them than nodes."""
    rng = np.random.default_rng(11)
    load = (
        np.maximum(1.0 - rng.uniform(0.3, 1.2, (30, 1)) * np.linspace(0.0, 1.0, points) ** 2, 0.0)
        ** (10 / 9)
        * 1e5
    )
    weight = np.where(load > 0.0, rng.uniform(0.5, 1.5, load.shape), 0.0)
    nodes, weights = rules(load.ravel(), weight.ravel(), points * np.arange(31), count)
    assert (np.diff(nodes, axis=1)[:, -1] > 0.0).all()
    for row, width, x, w in zip(load, weight, np.sqrt(nodes), weights, strict=True):
        if np.count_nonzero(width) <= count:  # itself
            np.testing.assert_allclose(w.sum(), width.sum(), rtol=1e-13)
            continue
        want, fractions = by_numpy(row[width > 0.0], width[width > 0.0], count)
        np.testing.assert_allclose(x, want, rtol=0, atol=1e-13 * want.max())
        np.testing.assert_allclose(w, fractions, rtol=0, atol=1e-11 * width.sum())


@pytest.mark.parametrize(("slices", "count"), [(12, 8), (77, 8), (40, 4)])
@pytest.mark.parametrize("tilt", [0.0, 0.3])
def test_rules_of_whole_rows_are_those_of_their_loaded_slices(slices, count, tilt):
    """Some rows twice, some without load, and such as mirror themselves where they are not tilted."""
    rng = np.random.default_rng(3)
    x = np.linspace(-1.0, 1.0, slices)
    load = np.maximum(1.0 - rng.uniform(0.3, 1.2, (20, 1)) * x**2 + tilt * x, 0.0) ** (10 / 9) * 1e5
    load = 0.5 * (load + load[:, ::-1]) if tilt == 0.0 else load
    load[[4, 9]] = load[[3, 8]] * (1.0 + 2e-16)
    load[7] = 0.0
    width = 1.0 - 0.3 * x**2
    width = 0.5 * (width + width[::-1])
    some = load > 0.0
    begin = np.append(0, np.cumsum(some.sum(axis=1)))
    want = rules(load[some], np.broadcast_to(width, load.shape)[some], begin, count)
    for found, expected in zip(row_rules(load, width, count), want, strict=True):
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11 * expected.max())


@pytest.mark.parametrize("n", [1, 2, 5, 48, 801])
def test_the_rule_of_gauss_and_legendre_has_the_roots_and_weights_of_many_digits(n):
    nodes, weights = legendre(n)
    assert nodes.size == weights.size == n
    np.testing.assert_array_equal(nodes, -nodes[::-1])
    assert (np.diff(nodes) > 0.0).all()
    with mpmath.workdps(40):
        for k in {0, n // 5, n // 2}:
            x = mpmath.mpf(float(nodes[k]))
            for _ in range(
                3
            ):  # Newton's rule from the node; P' by the recurrence of the polynomials
                before = mpmath.mpf(1)
                now = x
                for j in range(2, n + 1):
                    before, now = now, ((2 * j - 1) * x * now - (j - 1) * before) / j
                slope = n * (before - x * now) / (1 - x * x)
                x -= now / slope
            assert abs(float(x - mpmath.mpf(float(nodes[k])))) <= 2e-16
            assert weights[k] == pytest.approx(float(2 / ((1 - x * x) * slope**2)), rel=1e-12)
