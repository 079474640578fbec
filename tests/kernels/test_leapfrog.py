"""Leapfrog, compiled: its order, that what swings goes on swinging, where it ends, and that it goes on bit by bit.

With systems that tell places and a frequency its step is fixed; that of others is held by the conformance kit and by
tests/motion/test_time_integration.py. Bearings are in tests/motion/test_resolved_contacts.py.
"""

import math

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.special import ellipj

from rollslip_kernels.motion.leapfrog import Leapfrog
from rollslip_kernels.motion.rosenbrock import DormandPrince
from rollslip_kernels.motion.system import python_system

pytestmark = pytest.mark.quick

PLACES = [True, False]


def pendulum(t):
    """Amplitude 2 asin 0.8 from its lowest point, in Jacobi's elliptic functions."""
    sn, cn, _, _ = ellipj(t, 0.64)
    return np.array([2 * np.arcsin(0.8 * sn), 1.6 * cn])


#: Two places that gyroscopic forces and damping couple, D = 0.5 and 0.1.
TURNING = np.block(
    [[np.zeros((2, 2)), np.eye(2)], [-np.diag([1.0, 4.0]), np.array([[-0.5, 0.8], [-0.8, -0.1]])]]
)  # fmt: skip


def turning(t):
    return expm(TURNING * t) @ [1.0, 0.0, 0.0, -1.0]


def pushed(t):
    """At rest until sin 3 t pushes a mass on a spring of frequency 1."""
    return np.array(
        [0.375 * math.sin(t) - 0.125 * math.sin(3 * t), 0.375 * (math.cos(t) - math.cos(3 * t))]
    )


PROBLEMS = {
    "pendulum": (lambda t, y: [y[1], -math.sin(y[0])], pendulum, PLACES, 5.0),
    "turning": (lambda t, y: TURNING @ y, turning, [True, True, False, False], 4.0),
    "pushed": (lambda t, y: [y[1], -y[0] + math.sin(3 * t)], pushed, PLACES, 4.0),
}


def in_steps_of(h, rates, y, places, end, **options):
    """The frequency that is told makes the step."""
    system = python_system(rates, len(y), places=places, swing_frequency=0.8 / h, **options)
    return Leapfrog(system, 0.0, y, end, 1e-5)


@pytest.mark.parametrize("problem", PROBLEMS)
def test_it_is_of_order_two_at_its_steps_and_between_them(problem):
    rates, exact, places, end = PROBLEMS[problem]
    errors = []
    for steps in (100, 200):
        solver = in_steps_of(end / steps, rates, exact(0.0), places, end)
        between = 0.0
        while solver.status == "running":
            before = solver.t
            solver.step()
            inside = np.linspace(before, solver.t, 6)[1:-1]
            between = max(
                between, *(np.abs(solver.interpolate(t) - exact(t)).max() for t in inside)
            )
        assert solver.steps == steps
        errors.append((np.abs(solver.y - exact(end)).max(), between))
    (coarse, coarse_between), (fine, fine_between) = errors
    assert 1.8 < math.log2(coarse / fine) < 2.2
    assert 1.8 < math.log2(coarse_between / fine_between) < 2.2
    assert fine < 1e-3


@pytest.mark.parametrize("problem", PROBLEMS)
def test_within_a_step_it_is_as_near_as_at_its_end(problem):
    """One step errs by the third power of its size: so is what lies between its ends, in places and speeds."""
    rates, exact, places, _ = PROBLEMS[problem]
    errors = []
    for h in (0.04, 0.02):
        solver = in_steps_of(h, rates, exact(0.7), places, 1.0)
        solver.restart(0.7, exact(0.7))
        solver.step()
        inside = 0.7 + h * np.array([0.2, 0.5, 0.8])
        errors.append(np.max([np.abs(solver.interpolate(t) - exact(t)) for t in inside], axis=0))
    assert np.all(np.log2(errors[0] / errors[1]) > 2.6)


def test_it_goes_back_in_time_as_well():
    rates, exact, places, end = PROBLEMS["pendulum"]
    system = python_system(rates, 2, places=places, swing_frequency=80.0)
    back = Leapfrog(system, end, exact(end), 0.0, 1e-5)
    assert back.advance(max_steps=1000)[0] == "finished"
    assert (back.t, back.y) == (0.0, pytest.approx(exact(0.0), abs=1e-3))


def test_without_a_frequency_its_steps_go_with_the_root_of_the_tolerance():
    rates, exact, places, end = PROBLEMS["pendulum"]
    steps = []
    for tolerance in (1e-4, 1e-6):
        solver = Leapfrog(
            python_system(rates, 2, places=places), 0.0, exact(0.0), end, tolerance, tolerance
        )
        solver.advance()
        steps.append(solver.steps)
    assert steps[1] / steps[0] == pytest.approx(10.0, rel=0.2)


def test_one_evaluation_a_step_and_no_loss_over_a_thousand_swings():
    """A method of order 5 with as long steps, of six evaluations, has lost a quarter of the energy by then."""

    def rates(t, y):
        return [y[1], -y[0]]

    end = 6400.0
    h = 0.8
    solver = in_steps_of(h, rates, [0.0, 1.0], PLACES, end)
    assert solver.advance()[0] == "finished"
    # all but the start, and what the damping is looked at by, all 2048 steps
    assert solver.evaluations <= 1.01 * solver.steps
    # of an oscillator it keeps q^2 + (1 - h^2/4) v^2
    assert solver.y[0] ** 2 + (1.0 - h * h / 4) * solver.y[1] ** 2 == pytest.approx(
        1.0 - h * h / 4, abs=1e-9
    )
    other = DormandPrince(
        python_system(rates, 2), 0.0, [0.0, 1.0], end, 1e3, 1e3, max_step=h, first_step=h
    )
    other.advance()
    assert other.y @ other.y < 0.75


def test_the_step_goes_by_the_frequency_and_the_root_of_the_tolerance():
    system = python_system(lambda t, y: [y[1], -25 * y[0]], 2, places=PLACES, swing_frequency=5.0)
    steps = {
        rtol: Leapfrog(system, 0.0, [1.0, 0.0], 1.0, rtol).h for rtol in (1e-2, 1e-5, 1e-7, 1e-9)
    }
    assert steps == {
        1e-2: 0.16,
        1e-5: 0.16,
        1e-7: pytest.approx(0.016),
        1e-9: pytest.approx(0.0016),
    }
    # the loosest of all unknowns counts, and no step is longer than allowed
    assert Leapfrog(system, 0.0, [1.0, 0.0], 1.0, [1e-11, 1e-7]).h == pytest.approx(0.016)
    assert Leapfrog(system, 0.0, [1.0, 0.0], 1.0, 1e-5, max_step=0.01).h == 0.01


@pytest.mark.parametrize(("damping", "ends"), [(2.9, "finished"), (3.1, "failed")])
def test_it_ends_in_words_where_damping_is_too_strong_for_its_step(damping, ends):
    """D h = 0.3 with h = 0.1; the stiffness, which is none, does not count."""
    solver = in_steps_of(
        0.1, lambda t, y: [y[1], -5 * y[0] - damping * y[1]], [1.0, 0.0], PLACES, 3.0
    )
    assert solver.advance()[0] == ends
    assert solver.damping == pytest.approx(damping, rel=1e-6)
    if ends == "failed":
        assert solver.t == 0.0
        assert solver.message == (
            "leapfrog takes steps of 0.1 s, and the motion is damped at 3.1/s at t = 0, more than the 3/s that they "
            "bear; rodas5p is made for it"
        )


def test_damping_is_looked_at_again_along_the_way():
    """It sets in after 1200 steps, and is seen at the next look."""
    solver = in_steps_of(
        0.01, lambda t, y: [y[1], -y[0] - (40.0 if t > 12.0 else 0.0) * y[1]], [1, 0], PLACES, 30.0
    )
    assert solver.advance()[0] == "failed"
    assert solver.t == pytest.approx(2048 * 0.01)


def test_the_strongest_damping_is_found_among_rollers_and_head():
    """Of a matrix that couples them, its largest eigenvalue by the library."""
    random = np.random.default_rng(5)
    root = random.normal(size=(9, 9))
    matrix = root @ root.T
    solver = Leapfrog(
        python_system(lambda t, y: -matrix @ y, 9, places=np.zeros(9, bool), swing_frequency=1e6),
        0.0, random.normal(size=9), 1e-6, 1e-5,
    )  # fmt: skip
    solver.step()
    assert solver.damping == pytest.approx(np.linalg.eigvalsh(matrix).max(), rel=0.02)


def swing(h=0.01, end=7.0):
    return in_steps_of(
        h,
        lambda t, y: [y[1], -y[0]],
        [1.0, 0.0],
        PLACES,
        end,
        watch=lambda t, y: [y[0] - 0.5],
        watched=1,
    )


def test_events_are_located_between_steps():
    solver = swing()
    found = []
    while solver.advance()[0] == "event":
        found.append((solver.t, solver.rising))
        assert solver.y[0] == pytest.approx(0.5, abs=1e-12)
    expected = [(math.pi / 3, False), (5 * math.pi / 3, True)]
    assert [rising for _, rising in found] == [rising for _, rising in expected]
    # order 2: what h^2/24 of the time amounts to
    assert [t for t, _ in found] == [pytest.approx(t, abs=3e-5) for t, _ in expected]


@pytest.mark.parametrize("steps", [1, 7, 150])
def test_it_goes_on_bit_by_bit_from_its_state(steps):
    whole = swing()
    first = swing()
    rest = swing()
    first.advance(max_steps=steps)
    rest.state = first.state
    times = np.sort(
        np.append(np.linspace(first.t, 7.0, 23), first.t + 0.003)
    )  # one in the next step
    states = []
    for solver in (whole, rest):
        ahead = times[times >= solver.t]
        y = np.full((ahead.size, 2), np.nan)
        done = 0
        while solver.status == "running":
            done += solver.advance(t_out=ahead[done:], y_out=y[done:])[1]
        states.append(y)
    assert np.array_equal(whole.y, rest.y)
    assert np.array_equal(*states)
    assert np.isfinite(states[0]).all()


def test_a_stop_is_met_exactly():
    solver = swing()
    assert solver.advance(0.123)[0] == "stop"
    assert solver.t == 0.123
    assert solver.y == pytest.approx([math.cos(0.123), -math.sin(0.123)], abs=1e-5)
    solver.advance(0.2)
    assert solver.t == 0.2
    assert solver.y == pytest.approx([math.cos(0.2), -math.sin(0.2)], abs=1e-5)


def test_what_it_cannot_take_is_refused():
    with pytest.raises(ValueError, match="a state of this system is 12 finite numbers"):
        swing().state = np.zeros(9)
    with pytest.raises(ValueError, match="places are 2 truths"):
        python_system(lambda t, y: y, 2, places=[True])

    def raises(t, y):
        raise OSError("gone")

    with pytest.raises(OSError, match="gone"):
        in_steps_of(0.1, raises, [1.0, 0.0], PLACES, 1.0).advance()
    away = in_steps_of(
        0.1, lambda t, y: [y[1], math.nan if t > 0.5 else 0.0], [0.0, 1.0], PLACES, 1.0
    )
    assert away.advance()[0] == "failed"
    assert away.t == pytest.approx(0.5)
    assert "not finite" in away.message
