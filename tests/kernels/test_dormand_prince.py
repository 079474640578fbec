"""Dormand and Prince's method, compiled: its figures against SciPy's RK45, its order, and that it steps as it should.

What it shares with Rodas5P, from events to failures, is held by test_rosenbrock.py.
"""

import math

import numpy as np
import pytest
from scipy.integrate import RK45, solve_ivp
from scipy.special import ellipj

from rollslip_kernels.motion.rosenbrock import DormandPrince, explicit_tableau
from rollslip_kernels.motion.system import python_system

pytestmark = pytest.mark.quick


def test_its_figures_are_those_of_the_library():
    figures = explicit_tableau()
    # without the last stage, which SciPy takes for the rates at the end; its error has the other sign
    np.testing.assert_allclose(figures["a"][:6, :5], RK45.A, rtol=1e-15)
    np.testing.assert_allclose(figures["a"][6, :6], RK45.B, rtol=1e-15)
    np.testing.assert_allclose(figures["c"][:6], RK45.C, rtol=1e-15)
    np.testing.assert_allclose(figures["e"], -RK45.E, rtol=1e-14)
    np.testing.assert_allclose(figures["d"], RK45.P[:, 3], rtol=1e-14)
    np.testing.assert_allclose(figures["a"].sum(axis=1), figures["c"], rtol=0, atol=1e-14)


def pendulum(t):
    """Amplitude 2 asin 0.8 from its lowest point, in Jacobi's elliptic functions."""
    sn, cn, _, _ = ellipj(t, 0.64)
    return np.array([2 * np.arcsin(0.8 * sn), 1.6 * cn])


def chirp(t):
    """A turning whose speed is 2 t: rates with time in them."""
    return np.array([np.sin(t * t), np.cos(t * t)])


PROBLEMS = {
    "pendulum": (lambda t, y: np.array([y[1], -np.sin(y[0])]), pendulum, 5.0, 80),
    "chirp": (lambda t, y: 2 * t * np.array([y[1], -y[0]]), chirp, 2.0, 64),
}


def with_fixed_steps(rates, exact, end, steps):
    solver = DormandPrince(
        python_system(rates, 2), 0.0, exact(0.0), end, 1e3, 1e3, end / steps, end / steps
    )
    between = 0.0
    while solver.status == "running":
        before = solver.t
        solver.step()
        inside = np.linspace(before, solver.t, 7)[1:-1]
        between = max(between, *(np.max(np.abs(solver.interpolate(t) - exact(t))) for t in inside))
    assert (solver.steps, solver.jacobians) == (steps, 0)
    return np.max(np.abs(solver.y - exact(end))), between


@pytest.mark.parametrize("problem", PROBLEMS)
def test_it_converges_with_order_five_at_the_steps_and_between_them(problem):
    rates, exact, end, steps = PROBLEMS[problem]
    (coarse, coarse_between), (fine, fine_between) = (
        with_fixed_steps(rates, exact, end, n * steps) for n in (1, 2)
    )
    assert 4.5 < math.log2(coarse / fine) < 5.7
    assert 4.5 < math.log2(coarse_between / fine_between) < 5.5


def test_its_output_is_that_of_the_library_step_by_step():
    """The same step from the same state, and the same polynomial in it."""
    rates, exact, _, _ = PROBLEMS["chirp"]
    ours = DormandPrince(python_system(rates, 2), 0.3, exact(0.3), 1.0, 1e3, 1e3, 0.2, 0.2)
    theirs = RK45(rates, 0.3, exact(0.3), 1.0, rtol=1e3, atol=1e3, max_step=0.2, first_step=0.2)
    for _ in range(3):
        ours.step()
        theirs.step()
        dense = theirs.dense_output()
        for t in np.linspace(theirs.t_old, theirs.t, 5):
            np.testing.assert_allclose(ours.interpolate(t), dense(t), rtol=0, atol=1e-14)


@pytest.mark.parametrize("problem", PROBLEMS)
def test_the_error_follows_the_tolerance_at_six_evaluations_a_step(problem):
    rates, exact, end, _ = PROBLEMS[problem]
    for rtol in (1e-4, 1e-7, 1e-10):
        solver = DormandPrince(python_system(rates, 2), 0.0, exact(0.0), end, rtol, rtol)
        assert solver.advance() == ("finished", 0)
        assert np.max(np.abs(solver.y - exact(end))) < 200 * rtol
        # three more for the first step, where it is found
        assert solver.evaluations <= 6 * (solver.steps + solver.rejected) + 3
        theirs = solve_ivp(rates, (0.0, end), exact(0.0), rtol=rtol, atol=rtol)
        assert solver.steps < 1.5 * theirs.t.size


def test_it_goes_on_bit_by_bit_from_its_state_and_meets_events():
    def made():
        watched = {"watch": lambda t, y: [y[0] - 0.5], "watched": 1}
        return DormandPrince(
            python_system(lambda t, y: [y[1], -y[0]], 2, autonomous=True, **watched),
            0.0,
            [0.0, 1.0],
            4.0,
            1e-9,
            1e-9,
        )

    whole = made()
    resumed = made()
    assert whole.advance()[0] == "event"
    assert (whole.t, whole.rising) == (pytest.approx(np.pi / 6, abs=1e-7), True)
    resumed.state = whole.state
    for solver in (whole, resumed):
        assert solver.advance()[0] == "event"
        assert (solver.t, solver.rising) == (pytest.approx(5 * np.pi / 6, abs=1e-7), False)
        assert solver.advance() == ("finished", 0)
    assert np.array_equal(whole.y, resumed.y)


def test_rates_that_stop_being_finite_end_with_a_reason():
    solver = DormandPrince(python_system(lambda t, y: y * y, 1), 0.0, [1.0], 2.0, 1e-8, 1e-8)
    assert solver.advance()[0] == "failed"
    assert solver.t == pytest.approx(1.0, abs=1e-6)
    assert "became too small" in solver.message or "not finite" in solver.message
