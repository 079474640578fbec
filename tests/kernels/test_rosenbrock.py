"""Rodas5P: its figures against the conditions they must meet, and its steps against solutions that are known."""

import itertools
import math
from functools import cache

import numpy as np
import pytest
from mpmath import mp, mpf
from scipy.integrate import solve_ivp
from scipy.special import ellipj

from rollslip import get_model
from rollslip_kernels.motion.rosenbrock import Rosenbrock, tableau
from rollslip_kernels.motion.system import RefusedError, System, python_system

#: Of Rodas5P; the last one is the error estimate.
STAGES = 8

# The figures ---------------------------------------------------------------------------------------------------------


@cache
def method():
    """alpha, beta, b, the embedded b and those of the continuous output, in 40 digits, from the figures in use.

    The figures are those of the transformed method (Hairer & Wanner II, IV.7.25): C = I/gamma - Gamma^-1,
    (a_ij) = alpha Gamma^-1, m = b Gamma^-1, with m = (a_8j, 1), and (a_8j, 0) for the embedded one.
    """
    with mp.workdps(40):
        figures = tableau()
        inverse = mp.eye(STAGES) / mpf(figures["gamma"]) - mp.matrix(figures["C"].tolist())
        gamma = mp.inverse(inverse)
        a = mp.matrix(figures["a"].tolist())
        alpha = a * gamma
        last = a[STAGES - 1, :]
        embedded = last * gamma
        full = last.copy()
        full[STAGES - 1] += 1
        dense = [mp.matrix([row]) * gamma for row in figures["h"].tolist()]
        return alpha, alpha + gamma, full * gamma, embedded, dense, gamma


@cache
def trees(order):
    """Rooted trees of an order, each the sorted tuple of the trees on its root."""
    if order == 1:
        return [()]
    found = set()
    for parts in partitions(order - 1, order - 1):
        for branches in itertools.product(*(trees(part) for part in parts)):
            found.add(tuple(sorted(branches)))
    return sorted(found)


def partitions(total, largest):
    if total == 0:
        yield ()
    for part in range(min(total, largest), 0, -1):
        for rest in partitions(total - part, part):
            yield (part, *rest)


def size(tree):
    return 1 + sum(map(size, tree))


def density(tree):
    return size(tree) * math.prod(map(density, tree))


def weights(tree):
    """Phi_i(t): a vertex with one son takes beta, one with several alpha (Hairer & Wanner II, IV.7)."""
    alpha, beta, *_ = method()
    product = mp.ones(STAGES, 1)
    for son in tree:
        factor = (beta if len(tree) == 1 else alpha) * weights(son)
        product = mp.matrix([x * y for x, y in zip(product, factor, strict=True)])
    return product


def misses(b, order, at=1):
    """Largest fault in the conditions of one order, sum b_i(x) Phi_i(t) = x^order/density(t)."""
    return max(
        abs((b * weights(tree))[0] - mpf(at) ** order / density(tree)) for tree in trees(order)
    )


def test_there_are_as_many_conditions_as_the_theory_counts():
    assert [len(trees(order)) for order in range(1, 7)] == [1, 1, 2, 4, 9, 20]


@pytest.mark.parametrize(("which", "order"), [("method", 5), ("embedded", 4)])
def test_the_conditions_of_order_are_met(which, order):
    """To the 16 digits that the figures are given with, and not by accident those of the next order."""
    b = method()[2 if which == "method" else 3]
    with mp.workdps(40):
        for upto in range(1, order + 1):
            assert misses(b, upto) < 1e-13
        assert misses(b, order + 1) > 1e-3


@pytest.mark.parametrize("x", ["0.1", "0.5", "0.9"])
def test_the_continuous_output_is_of_order_four(x):
    with mp.workdps(40):
        x = mpf(x)
        _, _, b, _, (k1, k2, k3), _ = method()
        along = x * (b + (1 - x) * (k1 + x * (k2 + x * k3)))
        for order in range(1, 5):
            assert misses(along, order, x) < 1e-13
        assert misses(along, 5, x) > 1e-5


def test_times_and_weights_of_the_time_derivative_are_sums_of_rows():
    """c_i = sum alpha_ij and d_i = sum gamma_ij: then time is an unknown like any other."""
    with mp.workdps(40):
        alpha, *_, gamma = method()
        for i in range(STAGES):
            assert abs(sum(alpha[i, :]) - mpf(float(tableau()["c"][i]))) < 1e-13
            assert abs(sum(gamma[i, :]) - mpf(float(tableau()["d"][i]))) < 1e-13


@pytest.mark.parametrize("which", [2, 3], ids=["method", "embedded"])
def test_it_is_l_stable(which):
    """R(z) = 1 + z b (1 - z beta)^-1 1: zero at infinity, at most 1 on the imaginary axis; poles at 1/gamma > 0."""
    with mp.workdps(40):
        _, beta, *rows = method()
        b = rows[which - 2]
        one = mp.ones(STAGES, 1)
        assert abs(1 - (b * mp.inverse(beta) * one)[0]) < 1e-13
        for y in [mpf(10) ** (mpf(k) / 8) for k in range(-16, 33)]:
            z = mp.mpc(0, y)
            assert abs(1 + z * (b * mp.inverse(mp.eye(STAGES) - z * beta) * one)[0]) <= 1 + mpf(
                "1e-13"
            )
        assert all(beta[i, j] == 0 for i in range(STAGES) for j in range(i + 1, STAGES))
        assert all(abs(beta[i, i] - tableau()["gamma"]) < 1e-15 for i in range(STAGES))


# Order of convergence ------------------------------------------------------------------------------------------------


def kaps(eps):
    """Kaps's problem: nonlinear and as stiff as 1/eps, with the solution (exp(-2 t), exp(-t)) whatever eps is."""
    return (
        lambda t, y: np.array([-(2 + 1 / eps) * y[0] + y[1] ** 2 / eps, y[0] - y[1] - y[1] ** 2]),
        lambda t, y: np.array([[-(2 + 1 / eps), 2 * y[1] / eps], [1, -1 - 2 * y[1]]]),
        lambda t: np.array([np.exp(-2 * t), np.exp(-t)]),
    )


def prothero_robinson(rate):
    """y' = rate (y - cos t) - sin t: linear, as stiff as the rate, forced, with the solution cos t."""
    return (
        lambda t, y: rate * (y - np.cos(t)) - np.sin(t),
        lambda t, y: np.array([[rate]]),
        lambda t: np.array([np.cos(t)]),
    )


def chirp():
    """A turning whose speed is 2 t: sin t^2 and cos t^2, linear with time in the coefficients."""
    return (
        lambda t, y: 2 * t * np.array([y[1], -y[0]]),
        None,
        lambda t: np.array([np.sin(t * t), np.cos(t * t)]),
    )


def pendulum():
    """Pendulum with amplitude 2 sin^-1 k from its lowest point, in Jacobi's elliptic functions; autonomous."""
    k = 0.8

    def exact(t):
        sn, cn, _, _ = ellipj(t, k * k)
        return np.array([2 * np.arcsin(k * sn), 2 * k * cn])

    return lambda t, y: np.array([y[1], -np.sin(y[0])]), None, exact


def with_fixed_steps(problem, end, steps):
    rates, jacobian, exact = problem
    h = end / steps
    system = python_system(rates, exact(0.0).size, jacobian=jacobian)
    # tolerances so wide that every step is taken, at its largest size
    solver = Rosenbrock(system, 0.0, exact(0.0), end, 1e3, 1e3, h, h)
    between = 0.0
    while solver.status == "running":
        before = solver.t
        solver.step()
        inside = np.linspace(before, solver.t, 7)[1:-1]
        between = max(between, *(np.max(np.abs(solver.interpolate(t) - exact(t))) for t in inside))
    assert solver.steps == steps
    return np.max(np.abs(solver.y - exact(end))), between


@pytest.mark.parametrize(
    ("problem", "end", "steps"),
    [
        (prothero_robinson(-1.0), 2.0, 8),
        (kaps(1.0), 1.0, 8),
        (chirp(), 2.0, 64),
        (pendulum(), 5.0, 80),
    ],
    ids=["prothero-robinson", "kaps", "chirp", "pendulum"],
)
def test_it_converges_with_order_five_at_the_steps_and_between_them(problem, end, steps):
    """Measured 4.9 to 5.0; between the steps the error of one step is of order five too."""
    (coarse, coarse_between), (fine, fine_between) = (
        with_fixed_steps(problem, end, n) for n in (steps, 2 * steps)
    )
    assert 4.7 < math.log2(coarse / fine) < 5.3
    assert 4.6 < math.log2(coarse_between / fine_between) < 5.4


@pytest.mark.parametrize(
    "problem", [prothero_robinson(-1e6), kaps(1e-6)], ids=["prothero-robinson", "kaps"]
)
def test_a_stiff_problem_costs_no_accuracy_at_large_steps(problem):
    """A step is up to 1e5 times the fast time; 16 steps leave 4e-12 and 3e-10, 1e-7 between them."""
    at_steps, between = with_fixed_steps(problem, 1.0, 16)
    assert at_steps < 1e-9
    assert between < 3e-7


def solved(problem, end, rtol, **more):
    rates, jacobian, exact = problem
    solver = Rosenbrock(
        python_system(rates, exact(0.0).size, jacobian=jacobian),
        0.0,
        exact(0.0),
        end,
        rtol,
        rtol,
        **more,
    )
    assert solver.advance() == ("finished", 0)
    return solver, np.max(np.abs(solver.y - exact(end)))


@pytest.mark.parametrize(
    ("problem", "end"),
    [(kaps(1e-4), 2.0), (chirp(), 4.0), (pendulum(), 20.0), (prothero_robinson(-1e3), 6.0)],
    ids=["kaps", "chirp", "pendulum", "prothero-robinson"],
)
def test_the_error_follows_the_tolerance_down_to_1e_12(problem, end):
    for rtol in (1e-4, 1e-6, 1e-8, 1e-10, 1e-12):
        solver, error = solved(problem, end, rtol)
        assert error < 200 * rtol + 5e-13
        assert solver.rejected <= 0.2 * solver.steps + 3


def test_every_unknown_has_its_own_tolerances_and_no_step_is_longer_than_allowed():
    """A fast turn with a wide tolerance beside a slow one with a tight one: the first may not set the steps."""
    turns = python_system(lambda t, y: [100 * y[1], -100 * y[0], y[3], -y[2]], 4, autonomous=True)
    y0 = [0.0, 1.0, 0.0, 1.0]
    tight = [1e3, 1e3, 1e-9, 1e-9]
    loose = Rosenbrock(turns, 0.0, y0, 3.0, tight, tight)
    loose.advance()
    np.testing.assert_allclose(loose.y[2:], [np.sin(3.0), np.cos(3.0)], atol=1e-7)
    both = Rosenbrock(turns, 0.0, y0, 3.0, 1e-9, 1e-9)
    both.advance()
    np.testing.assert_allclose(both.y[:2], [np.sin(300.0), np.cos(300.0)], atol=1e-5)
    assert both.steps > 10 * loose.steps
    short = Rosenbrock(turns, 0.0, y0, 3.0, tight, tight, 0.01)
    while short.status == "running":
        before = short.t
        short.step()
        assert short.t - before <= 0.01 * (1 + 2e-6)
    assert 300 <= short.steps <= 302  # the first is shorter


def test_a_tight_tolerance_costs_as_the_order_says():
    """1e4 in the tolerance is a factor 1e4^(1/5) = 6.3 in steps; one-sided differences would make it far more."""
    few, many = (solved(pendulum(), 20.0, rtol)[0].steps for rtol in (1e-7, 1e-11))
    assert 4.5 < many / few < 9


def test_it_runs_backwards():
    rates, _, exact = chirp()
    solver = Rosenbrock(python_system(rates, 2), 3.0, exact(3.0), -1.0, 1e-9, 1e-9)
    out = np.empty((3, 2))
    assert solver.advance(t_out=[2.0, 0.0, -1.0], y_out=out) == ("finished", 3)
    np.testing.assert_allclose(out, [exact(2.0), exact(0.0), exact(-1.0)], atol=1e-7)


# Arrow ---------------------------------------------------------------------------------------------------------------


def bearing(rollers):
    """A cage (speed) and rollers (angle, spin) coupled by friction, loaded as they pass, and the energy lost in it."""
    inertia = 5.0
    drag = 0.3

    def friction(head, own):
        load = np.maximum(np.cos(own[:, 0]), 0.0) ** 2
        sliding = 1.0 - own[:, 1] - head[0]
        return load * np.tanh(20.0 * sliding), sliding

    def head_rates(t, head):
        return [-drag * head[0] / inertia, 0.0]

    def roller_rates(t, head, own):
        force, sliding = friction(head, own)
        turning = np.full(len(own), head[0])
        return np.array([turning, force]).T, np.array([force / inertia, force * sliding]).T

    def whole(t, y):
        own = y[1:-1].reshape(-1, 2)
        force, sliding = friction(y[:1], own)
        rates = np.empty_like(y)
        rates[0] = (force.sum() - drag * y[0]) / inertia
        rates[1:-1:2] = y[0]
        rates[2:-1:2] = force
        rates[-1] = force @ sliding
        return rates

    y0 = np.zeros(2 + 2 * rollers)
    y0[1:-1:2] = 0.3 + 2 * np.pi * np.arange(rollers) / rollers
    capsule = python_system(
        head_rates,
        1,
        roller_rates=roller_rates,
        rollers=rollers,
        block=2,
        ledger=1,
        autonomous=True,
    )
    return capsule, whole, y0


def test_an_arrow_gives_what_the_dense_system_and_another_method_give():
    capsule, whole, y0 = bearing(6)
    arrow = Rosenbrock(capsule, 0.0, y0, 3.0, 1e-9, 1e-9)
    dense = Rosenbrock(python_system(whole, y0.size, autonomous=True), 0.0, y0, 3.0, 1e-9, 1e-9)
    assert arrow.advance() == dense.advance() == ("finished", 0)
    np.testing.assert_allclose(arrow.y, dense.y, rtol=0, atol=1e-8)
    other = solve_ivp(whole, (0.0, 3.0), y0, method="DOP853", rtol=1e-11, atol=1e-11)
    np.testing.assert_allclose(arrow.y, other.y[:, -1], rtol=0, atol=1e-7)


def test_the_work_of_a_step_is_the_same_number_of_evaluations_whatever_the_rollers():
    """Eight stages and H + B = 3 for the Jacobian; each evaluation is one call for all rollers at once."""
    for rollers in (10, 100, 1000):
        capsule, _, y0 = bearing(rollers)
        solver = Rosenbrock(capsule, 0.0, y0, 3.0, 1e-4, 1e-4)
        solver.advance(max_steps=20)
        tried = solver.steps + solver.rejected
        assert solver.steps == 20
        assert solver.factorisations == tried
        assert solver.jacobians == 20
        assert 20 * (8 + 3) <= solver.evaluations <= tried * 8 + 20 * 3 + 3


def test_a_ledger_closes_to_the_tolerance():
    """Energy of a driven, damped pendulum against the ledger of what drive and damper put in."""
    for rtol in (1e-5, 1e-8, 1e-11):
        system = python_system(
            lambda t, y: [
                y[1],
                -np.sin(y[0]) - 0.2 * y[1] + np.cos(t),
                y[1] * (np.cos(t) - 0.2 * y[1]),
            ],
            2,
            ledger=1,
        )
        solver = Rosenbrock(system, 0.0, [0.0, 1.0, 0.0], 20.0, rtol, rtol)
        solver.advance()
        angle, speed, work = solver.y
        assert abs(speed**2 / 2 - np.cos(angle) - (0.5 - 1.0) - work) < 50 * rtol


def test_the_norm_does_not_drown_one_unknown_in_a_thousand():
    """A fast oscillator among 999 unknowns at rest takes the steps it takes alone."""
    steps = []
    for idle in (1, 999):
        turning = python_system(
            lambda t, h: [h[1], -h[0]], 2, roller_rates=lambda t, h, r: (0 * r, np.zeros((len(r), 2))),
            rollers=idle, block=1, autonomous=True,
        )  # fmt: skip
        solver = Rosenbrock(turning, 0.0, np.r_[1.0, np.zeros(1 + idle)], 5.0, 1e-6, 1e-6)
        solver.advance()
        steps.append(solver.steps)
    assert steps[0] == steps[1]


# Going on ------------------------------------------------------------------------------------------------------------


def test_a_run_goes_on_bit_by_bit_from_its_state():
    capsule, _, y0 = bearing(5)
    whole = Rosenbrock(capsule, 0.0, y0, 2.0, 1e-7, 1e-7)
    whole.advance(max_steps=30)
    kept = whole.state
    assert kept.dtype == float
    resumed = Rosenbrock(capsule, 0.0, y0, 2.0, 1e-7, 1e-7)
    resumed.state = kept
    assert (resumed.t, resumed.h) == (whole.t, whole.h)
    assert np.array_equal(resumed.state, kept)
    for solver in (whole, resumed):
        assert solver.advance() == ("finished", 0)
    assert np.array_equal(resumed.y, whole.y)
    assert whole.steps == 30 + resumed.steps > 40


def test_steps_by_one_and_by_many_are_the_same():
    capsule, _, y0 = bearing(5)
    many, single = (Rosenbrock(capsule, 0.0, y0, 1.0, 1e-6, 1e-6) for _ in range(2))
    many.advance()
    while single.status == "running":
        assert single.step() in ("steps", "finished")
    assert np.array_equal(many.y, single.y)
    assert many.steps == single.steps
    assert many.advance() == ("finished", 0)


def test_wanted_times_are_filled_across_calls():
    rates, _, exact = chirp()
    times = np.linspace(0.0, 3.0, 301)
    out = np.full((301, 2), np.nan)
    solver = Rosenbrock(python_system(rates, 2), 0.0, exact(0.0), 3.0, 1e-9, 1e-9)
    at = 0
    reason = "steps"
    while reason == "steps":
        reason, filled = solver.advance(t_out=times[at:], y_out=out[at:], max_steps=7)
        at += filled
    assert (reason, at) == ("finished", 301)
    np.testing.assert_allclose(out, exact(times).T, atol=1e-7)
    assert np.array_equal(out[-1], solver.y)


def test_a_stop_is_met_exactly_and_does_not_shorten_the_steps_after_it():
    rates, _, exact = pendulum()
    solver = Rosenbrock(python_system(rates, 2, autonomous=True), 0.0, exact(0.0), 10.0, 1e-8, 1e-8)
    solver.advance(t_stop=5.0)
    before = solver.h
    assert solver.t == 5.0
    assert solver.advance(t_stop=np.nextafter(5.0, 6.0)) == ("stop", 0)
    assert solver.h == before
    assert solver.advance(t_stop=np.nextafter(5.0, 6.0)) == ("stop", 0)
    assert solver.advance() == ("finished", 0)
    np.testing.assert_allclose(solver.y, exact(10.0), atol=1e-6)


def test_rates_that_jump_are_integrated_from_stop_to_stop():
    """y' = 1 up to t = 1, then -2: with a stop there no step and no difference sees both sides."""
    requested = []

    def rates(t, y):
        requested.append(t)
        return [1.0 if solver_side == "left" else -2.0]

    solver = Rosenbrock(python_system(rates, 1), 0.0, [0.0], 2.0, 1e-8, 1e-8)
    solver_side = "left"
    solver.advance(t_stop=1.0)
    assert max(requested) <= 1.0
    assert solver.y[0] == pytest.approx(1.0, abs=1e-14)
    solver_side = "right"
    solver.restart(1.0, solver.y)
    assert solver.advance() == ("finished", 0)
    assert solver.y[0] == pytest.approx(-1.0, abs=1e-14)
    assert max(requested) <= 2.0


def test_no_rates_are_asked_for_outside_the_interval():
    for start, end in ((1.0, 3.0), (3.0, 1.0)):

        def rates(t, y):
            assert 1.0 <= t <= 3.0, f"{t:.17g}"
            return [np.sqrt((t - 1.0) * (3.0 - t)) - y[0]]

        for rtol in (1e-4, 1e-10):
            solver = Rosenbrock(python_system(rates, 1), start, [0.0], end, rtol, rtol)
            assert solver.advance() == ("finished", 0)


# Events --------------------------------------------------------------------------------------------------------------


def watching(rates, n, watch, watched, y0, end, rtol=1e-9, **more):
    return Rosenbrock(
        python_system(rates, n, watch=watch, watched=watched, **more), 0.0, y0, end, rtol, rtol
    )


def oscillator(watch, watched, end=10.0, rtol=1e-9):
    """sin t and cos t."""
    return watching(
        lambda t, y: [y[1], -y[0]], 2, watch, watched, [0.0, 1.0], end, rtol, autonomous=True
    )


def events_of(solver):
    found = []
    while (reason := solver.advance()[0]) == "event":
        found.append((solver.event, solver.rising, solver.t))
        assert len(found) < 100
    assert reason == "finished"
    return found


def test_every_change_of_sign_is_found_once_with_its_direction():
    """sin t - 1/2 and cos t, the first of them at 30 and 150 degrees."""
    found = events_of(oscillator(lambda t, y: [y[0] - 0.5, y[1]], 2))
    expected = sorted(
        [(0, True, np.pi / 6 + 2 * np.pi * k) for k in range(2)]
        + [(0, False, 5 * np.pi / 6 + 2 * np.pi * k) for k in range(2)]
        + [(1, k % 2 == 1, np.pi / 2 + np.pi * k) for k in range(3)],
        key=lambda event: event[2],
    )
    assert [event[:2] for event in found] == [event[:2] for event in expected]
    np.testing.assert_allclose(
        [event[2] for event in found], [event[2] for event in expected], atol=1e-7
    )


def test_the_error_of_an_event_is_that_of_the_continuous_output():
    """Halved steps move the time of an event by 2^-5 of its error: here where a pendulum falls through 0.7 rad."""
    errors = []
    for h in (0.2, 0.1, 0.05):
        system = python_system(
            lambda t, y: [y[1], -np.sin(y[0])],
            2,
            watch=lambda t, y: [y[0] - 0.7],
            watched=1,
            autonomous=True,
        )
        fixed = Rosenbrock(system, 0.0, [0.0, 1.6], 4.0, 1e3, 1e3, h, h)
        assert fixed.advance()[0] == fixed.advance()[0] == "event"
        assert not fixed.rising
        # from the elliptic integral of the first kind, k = 0.8: sin(y/2) = k sn(t, k), on its way back
        errors.append(abs(fixed.t - FALLS_AT))
    assert errors[-1] < 1e-7
    orders = [math.log2(a / b) for a, b in itertools.pairwise(errors)]
    assert np.mean(orders) == pytest.approx(5, abs=0.6)


with mp.workdps(30):
    #: Time at which the pendulum with k = 0.8 falls through 0.7 rad: 2 K - F(asin(sin(0.35)/k), k).
    FALLS_AT = float(
        2 * mp.ellipk(mpf("0.64"))
        - mp.ellipf(mp.asin(mp.sin(mpf("0.35")) / mpf("0.8")), mpf("0.64"))
    )


def test_the_state_at_an_event_is_on_the_continuous_output_and_past_the_change():
    solver = oscillator(lambda t, y: [y[0] - 0.5], 1)
    before = solver.t
    while solver.advance(max_steps=1)[0] != "event":
        before = solver.t
    value = solver.y[0] - 0.5
    assert 0 <= value < 4 * np.spacing(0.5), "located to rounding, on the far side"
    assert before < solver.t
    assert np.array_equal(solver.interpolate(solver.t), solver.y)
    np.testing.assert_allclose(
        solver.interpolate(np.nextafter(solver.t, 0.0)), solver.y, atol=1e-14
    )
    with pytest.raises(ValueError, match="is not within the last step"):
        solver.interpolate(solver.t + 1e-6)


def test_an_event_is_located_by_secants_and_not_by_halving():
    """On a line a secant meets the root at once; halving a step down to the rounding of t would take 52 evaluations."""
    times = []

    def line(t, y):
        times.append(t)
        return [y[0] - 0.4]

    solver = watching(lambda t, y: [1.0], 1, line, 1, [0.0], 1.0)
    assert solver.advance()[0] == "event"
    assert solver.t == pytest.approx(0.4, abs=1e-13)
    assert len(times) < 52


def test_two_values_that_change_together_are_reported_one_after_the_other():
    """sin t - 1/2, three times it, and its opposite: three events at the same time, and none twice."""
    found = events_of(
        oscillator(lambda t, y: [y[0] - 0.5, 3 * (y[0] - 0.5), 0.5 - y[0]], 3, end=2.0)
    )
    assert sorted((index, rising) for index, rising, _ in found) == [
        (0, True),
        (1, True),
        (2, False),
    ]
    np.testing.assert_allclose([t for *_, t in found], np.pi / 6, atol=1e-7)


def test_a_dip_between_the_ends_of_a_step_is_found():
    """y'' = 0 is solved in steps of any length; (t - 0.4)(t - 0.6) is negative only within the first."""
    solver = watching(
        lambda t, y: [1.0], 1, lambda t, y: [(y[0] - 0.4) * (y[0] - 0.6)], 1, [0.0], 1.0
    )
    solver.restart(0.0, [0.0], 1.0)
    found = events_of(solver)
    assert [(rising, round(t, 12)) for _, rising, t in found] == [(False, 0.4), (True, 0.6)]


def test_an_event_at_the_very_start_is_none_but_the_change_after_it_is():
    """sin t starts from zero: it has no sign there, and its first change is at pi."""
    found = events_of(oscillator(lambda t, y: [y[0]], 1, end=4.0))
    assert [(rising, pytest.approx(t, abs=1e-7)) for _, rising, t in found] == [(False, np.pi)]


def test_a_value_that_is_not_a_number_is_not_watched_there():
    """cos t, known beyond t = 1 only: its change at pi/2 is an event, its becoming known is none."""
    found = events_of(oscillator(lambda t, y: [y[1] if t > 1.0 else np.nan], 1, end=3.0))
    assert [(rising, pytest.approx(t, abs=1e-7)) for _, rising, t in found] == [(False, np.pi / 2)]


def test_outputs_before_an_event_are_written_and_those_after_it_left():
    solver = oscillator(lambda t, y: [y[0] - 0.5], 1, end=3.0)
    times = np.linspace(0.0, 3.0, 31)
    out = np.full((31, 2), np.nan)
    reason, filled = solver.advance(t_out=times, y_out=out)
    assert (reason, filled) == ("event", 6)  # 0, 0.1 .. 0.5 < pi/6
    assert np.all(np.isnan(out[6:]))
    reason, more = solver.advance(t_out=times[6:], y_out=out[6:])
    assert (reason, times[6 + more - 1] < 5 * np.pi / 6 < times[6 + more]) == ("event", True)
    reason, last = solver.advance(t_out=times[6 + more :], y_out=out[6 + more :])
    assert (reason, 6 + more + last) == ("finished", 31)
    np.testing.assert_allclose(out[:, 0], np.sin(times), atol=1e-7)


def test_a_run_goes_on_bit_by_bit_from_an_event():
    first, second = (oscillator(lambda t, y: [y[0] - 0.5], 1) for _ in range(2))
    first.advance()
    second.state = first.state
    assert events_of(first) == events_of(second)
    assert np.array_equal(first.y, second.y)


# What goes wrong -----------------------------------------------------------------------------------------------------


def failed(solver, *parts):
    assert solver.advance() == ("failed", 0)
    assert solver.status == "failed"
    for part in parts:
        assert part in solver.message
    assert np.all(np.isfinite(solver.y))
    assert solver.advance() == ("failed", 0), "and it stays so"


def test_a_solution_that_becomes_infinite_ends_with_a_reason():
    for rtol in (1e-3, 1e-6, 1e-9):
        calls = 0

        def rates(t, y):
            nonlocal calls
            calls += 1
            with np.errstate(over="ignore"):
                return y * y

        solver = Rosenbrock(python_system(rates, 1), 0.0, [1.0], 2.0, rtol, 1e-9)
        failed(
            solver, "the step size became too small at t = ", "the solution may be infinite there"
        )
        assert solver.t == pytest.approx(1.0, abs=20 * rtol)
        assert calls < 20_000


def test_rates_that_stop_being_finite_end_with_a_reason_at_the_last_good_state():
    with np.errstate(invalid="ignore", divide="ignore"):
        solver = Rosenbrock(
            python_system(lambda t, y: [np.log(1.0 - t) * 0 - 1], 1), 0.0, [3.0], 2.0
        )
        failed(solver, "the rates are not finite at t = 1, or a little after it")
    assert 0.999999999 < solver.t < 1.0
    assert solver.y[0] == pytest.approx(3.0 - solver.t, abs=1e-12)


def test_rates_that_are_not_finite_at_the_start_are_said_at_once():
    solver = Rosenbrock(python_system(lambda t, y: [np.inf], 1), 0.0, [1.0], 2.0)
    failed(solver, "the rates are not finite at t = 0")
    assert solver.evaluations == 1


def test_a_step_into_refused_ground_is_tried_again_smaller():
    """y' = -sqrt(y) from 1 touches zero at t = 2 with its whole step; below zero the rates are refused."""

    def rates(t, y):
        if y[0] < 0:
            raise RefusedError("below zero", reason="no load below zero")
        return [-np.sqrt(y[0])]

    system = python_system(rates, 1)
    solver = Rosenbrock(system, 0.0, [1.0], 1.9, 1e-8, 1e-10)
    assert solver.advance() == ("finished", 0)
    assert solver.y[0] == pytest.approx(0.05**2, abs=1e-8)
    beyond = Rosenbrock(system, 0.0, [1.0], 3.0, 1e-3, 1e-14)
    failed(beyond, "the rates are not defined at t = 1.999")
    steep = Rosenbrock(python_system(lambda t, y: rates(t, y - t), 1), 0.0, [1.0], 3.0, 1e-3, 1e-14)
    failed(steep, "the rates are not defined at t = ")
    assert System(steep.capsule).refusal() == "no load below zero"


def test_a_jump_in_the_rates_is_crossed():
    """A kink and a jump cost steps and no more: |y|' with a dry friction that turns at t = 1."""
    solver = Rosenbrock(
        python_system(lambda t, y: [np.sign(1.0 - t)], 1), 0.0, [0.0], 2.0, 1e-8, 1e-8
    )
    assert solver.advance() == ("finished", 0)
    assert solver.y[0] == pytest.approx(0.0, abs=1e-6)
    assert solver.rejected < 200


def test_an_error_in_the_rates_comes_out_as_it_is_and_what_was_reached_is_kept():
    class OwnError(Exception):
        pass

    mine = OwnError("no oil", 3)
    broken = True

    def rates(t, y):
        if broken and t > 1.0:
            raise mine
        return [np.cos(t)]

    solver = Rosenbrock(python_system(rates, 1), 0.0, [0.0], 2.0, 1e-8, 1e-8)
    out = np.full((3, 1), np.nan)
    with pytest.raises(OwnError) as raised:
        solver.advance(t_out=[0.1, 0.2, 1.5], y_out=out)
    assert raised.value is mine
    assert solver.status == "running"
    assert 0.5 < solver.t <= 1.0
    assert solver.y[0] == pytest.approx(np.sin(solver.t), abs=1e-7)
    np.testing.assert_allclose(out[:2, 0], np.sin([0.1, 0.2]), atol=1e-7)
    # and it can go on when the fault is mended
    broken = False
    assert solver.advance() == ("finished", 0)
    assert solver.y[0] == pytest.approx(np.sin(2.0), abs=1e-7)


@pytest.mark.parametrize("error", [KeyboardInterrupt, SystemExit])
def test_an_interrupt_in_the_rates_comes_out(error):
    def rates(t, y):
        raise error

    with pytest.raises(error):
        Rosenbrock(python_system(rates, 1), 0.0, [0.0], 2.0).advance()


def test_an_error_in_what_is_watched_comes_out():
    def watch(t, y):
        return [1.0 / (t <= 0.5)]

    solver = watching(lambda t, y: [1.0], 1, watch, 1, [0.0], 1.0)
    with pytest.raises(ZeroDivisionError):
        solver.advance()


def test_it_cannot_be_stepped_from_within_its_own_rates():
    def rates(t, y):
        solver.step()
        return y

    solver = Rosenbrock(python_system(rates, 1), 0.0, [1.0], 1.0)
    with pytest.raises(RuntimeError, match="this integrator is at work already"):
        solver.step()


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"y0": [1.0]}, r"the state must be 2 finite numbers, got \[1.0\]"),
        ({"y0": [1.0, np.nan]}, "the state must be 2 finite numbers"),
        ({"t_bound": np.inf}, "start and end must be finite, got 0 and inf"),
        ({"rtol": 1e-16}, "rtol must be at least 2.3e-14 and atol not negative"),
        ({"atol": -1.0}, "rtol must be at least 2.3e-14 and atol not negative"),
        ({"atol": np.nan}, "atol must be finite, got nan"),
        ({"max_step": 0.0}, "max_step must be above 0, got 0"),
        ({"first_step": 2.0}, "first_step must be above 0 and at most 1, got 2"),
        ({"first_step": 0.0}, "first_step must be above 0 and at most 1, got 0"),
    ],
)
def test_what_cannot_be_integrated_is_refused(change, sentence):
    given = {"t0": 0.0, "y0": [1.0, 2.0], "t_bound": 1.0, **change}
    with pytest.raises(ValueError, match=sentence):
        Rosenbrock(python_system(lambda t, y: y, 2), **given)


def test_what_cannot_be_asked_for_is_refused():
    solver = Rosenbrock(python_system(lambda t, y: -y, 1), 0.0, [1.0], 1.0)
    for t_stop in (-0.1, 1.1, np.nan):
        with pytest.raises(ValueError, match="t_stop must be between t = 0 and 1, got"):
            solver.advance(t_stop=t_stop)
    with pytest.raises(ValueError, match="t_out and y_out come together"):
        solver.advance(t_out=[0.5])
    with pytest.raises(ValueError, match=r"y_out must have the shape \(1, 1\), got \(2, 1\)"):
        solver.advance(t_out=[0.5], y_out=np.empty((2, 1)))
    for times in ([0.5, 0.4], [-0.1, 0.4], [0.1, np.nan]):
        with pytest.raises(
            ValueError, match="t_out must go on from t = 0 in the direction of integration"
        ):
            solver.advance(t_out=times, y_out=np.empty((2, 1)))
    with pytest.raises(ValueError, match="no step has been taken yet"):
        _ = solver.continuous
    with pytest.raises(ValueError, match="a state of this system is 5 finite numbers"):
        solver.state = np.ones(4)
    with pytest.raises(ValueError, match="t = 2 is beyond the end 1"):
        solver.restart(2.0, [1.0])
    with pytest.raises(ValueError, match="the system has no unknowns"):
        Rosenbrock(python_system(lambda t, y: y, 0), 0.0, [], 1.0)


# As a solver of SciPy's kind -----------------------------------------------------------------------------------------


def test_solve_ivp_takes_a_function_and_a_system():
    capsule, whole, y0 = bearing(6)
    system = System(capsule)
    method = get_model("integrator", "rodas5p").solver()
    options = {"method": method, "rtol": 1e-8, "atol": 1e-8, "dense_output": True}
    arrow = solve_ivp(system, (0.0, 3.0), y0, **options)
    dense = solve_ivp(whole, (0.0, 3.0), y0, **options)
    assert arrow.success
    assert dense.success
    times = np.linspace(0.0, 3.0, 50)
    np.testing.assert_allclose(arrow.sol(times), dense.sol(times), atol=1e-6)
    # steps tried cost 8 stages; those taken H + B or n central differences, and here two of time
    assert arrow.nlu - arrow.njev < 0.2 * arrow.nlu
    assert arrow.nfev <= 8 * arrow.nlu + 2 * 3 * arrow.njev + 3
    assert dense.nfev >= 7 * dense.nlu + (2 * y0.size + 2) * dense.njev
    # and SciPy's own solvers take the system and its Jacobian
    theirs = solve_ivp(
        system, (0.0, 3.0), y0, method="Radau", jac=system.jacobian, rtol=1e-8, atol=1e-8
    )
    np.testing.assert_allclose(theirs.y[:, -1], arrow.y[:, -1], atol=1e-5)
    with pytest.raises(ValueError, match="a System has its own Jacobian"):
        solve_ivp(system, (0.0, 3.0), y0, method=method, jac=system.jacobian)


@pytest.mark.parametrize("form", ["function", "array", "sparse"])
def test_solve_ivp_takes_a_jacobian(form):
    from scipy.sparse import csc_array

    matrix = np.array([[-1e4, 1e4], [0.0, -1.0]])
    jac = {"function": lambda t, y: matrix, "array": matrix, "sparse": csc_array(matrix)}[form]
    solution = solve_ivp(
        lambda t, y: matrix @ y,
        (0.0, 2.0),
        [0.0, 1.0],
        method=get_model("integrator", "rodas5p").solver(),
        jac=jac,
        rtol=1e-8,
    )
    slow = 1e4 / (1e4 - 1.0)
    np.testing.assert_allclose(solution.y[:, -1], np.exp(-2.0) * np.array([slow, 1.0]), rtol=1e-5)
    assert solution.njev == len(solution.t) - 1


def test_solve_ivp_finds_its_events_on_our_dense_output():
    def rates(t, y):
        return [y[1], -y[0]]

    solution = solve_ivp(
        rates, (0.0, 10.0), [0.0, 1.0], method=get_model("integrator", "rodas5p").solver(),
        events=lambda t, y: y[1], rtol=1e-9, atol=1e-9,
    )  # fmt: skip
    np.testing.assert_allclose(solution.t_events[0], np.pi * np.array([0.5, 1.5, 2.5]), atol=1e-7)


def test_unknowns_of_different_size_have_their_own_tolerances():
    """1e9 cos t and 1e-9 sin t; the magnitude for differences follows from atol/rtol."""
    solution = solve_ivp(
        lambda t, y: [-1e18 * y[1], 1e-18 * y[0]], (0.0, 3.0), [1e9, 0.0],
        method=get_model("integrator", "rodas5p").solver(), rtol=1e-8, atol=[1.0, 1e-18],
    )  # fmt: skip
    np.testing.assert_allclose(
        solution.y[:, -1], [1e9 * np.cos(3.0), 1e-9 * np.sin(3.0)], rtol=1e-6
    )
