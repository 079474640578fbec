"""The driver of integrators: known solutions, events, breaks, interrupts, failures, with every integrator there is."""

import importlib.util
import math

import attrs
import numpy as np
import pytest
from scipy.integrate import RK45, OdeSolver, Radau

from rollslip.catalogue.registry import get_model
from rollslip.errors import DomainError
from rollslip.models import IntegratorModel
from rollslip_kernels.motion.rosenbrock import Rosenbrock
from rollslip_kernels.motion.system import System, python_system
from rollslip_studies.motion import time_integration
from rollslip_studies.motion.time_integration import (
    Event,
    InitialValueProblem,
    Trajectory,
    integrate,
)

SCIPY = ("rk23", "rk45", "dop853", "radau", "bdf", "lsoda")
#: Name of an integrator, and whether it is given a compiled system.
WAYS = [*((name, False) for name in (*SCIPY, "rodas5p")), ("rodas5p", True), ("leapfrog", True)]
if importlib.util.find_spec("sksundae") is not None:
    WAYS.append(("cvode", False))
EVERY = pytest.mark.parametrize(("name", "compiled"), WAYS)
#: Error of a run at rtol = 1e-8 in tolerances: 0.3 to 1.1 for methods of high order, 21 to 38 for these.
ERROR = {"rk23": 1e2, "lsoda": 1e2, "bdf": 1e2, "cvode": 1e2, "leapfrog": 1e2}


def problem(rates, y, compiled=False, watch=None, watched=0, tolerance=1e-8, **options):
    """The same problem for integrators that are stepped, and for those that take a system."""
    y = np.array(y, dtype=float)
    if compiled:
        rates = System(python_system(rates, y.size, watch=watch, watched=watched))
        watch = rates.watch if watched else None
    return InitialValueProblem(
        rates=rates, y=y, atol=np.full(y.size, tolerance), watch=watch, **options
    )


def run(name, problem, times, tolerance=1e-8, **options):
    return integrate(problem, get_model("integrator", name), times, rtol=tolerance, **options)


def oscillator(t, y):
    """Solution cos t, sin t, and a stiff part that follows cos t."""
    return np.array([-y[1], y[0], -50.0 * (y[2] - math.cos(t)) - math.sin(t)])


def exact(t):
    return np.stack((np.cos(t), np.sin(t), np.cos(t)), axis=-1)


#: The exact solution at t = 0.
START = [1.0, 0.0, 1.0]


def falling(t, y):
    return -y


# What is stored -----------------------------------------------------------------------------------------------------


@EVERY
def test_stored_instants_are_right_to_tolerance(name, compiled):
    times = np.sort(np.r_[0.0, np.random.default_rng(3).uniform(0.0, 3.0, 40), 3.0])
    found = run(name, problem(oscillator, START, compiled), times)
    assert (found.outcome, found.message, found.error) == ("finished", "", None)
    assert np.array_equal(found.t, times)
    assert np.array_equal(found.y[0], START)
    assert found.last_t == 3.0
    assert np.array_equal(found.last_y, found.y[-1])
    assert np.abs(found.y - exact(times)).max() < ERROR.get(name, 10) * 1e-8
    assert found.steps > 0
    assert found.evaluations >= found.steps
    assert found.wall_time > 0.0


@EVERY
def test_an_instant_is_stored_once_wherever_it_lies(name, compiled):
    """Instants closer together than any step, the start twice over, and one instant alone."""
    times = np.r_[0.0, 1.0 + 1e-9 * np.arange(5), 1.5]
    found = run(name, problem(oscillator, START, compiled), times)
    assert np.array_equal(found.t, times)
    assert np.abs(found.y - exact(times)).max() < ERROR.get(name, 10) * 1e-8
    alone = run(name, problem(oscillator, START, compiled), np.array([0.7]))
    assert alone.t.tolist() == [0.7]
    assert run(name, problem(oscillator, START, compiled), np.array([0.0])).t.tolist() == [0.0]
    nothing = run(name, problem(oscillator, START, compiled), np.empty(0))
    assert nothing.outcome == "finished"
    assert nothing.y.shape == (0, 3)


@EVERY
def test_tolerance_governs_the_error(name, compiled):
    """A tolerance a thousand times smaller brings the error down at least twenty times."""
    times = np.linspace(0.0, 3.0, 11)
    errors = [
        np.abs(
            run(name, problem(oscillator, START, compiled, tolerance=tol), times, tol).y
            - exact(times)
        ).max()
        for tol in (1e-5, 1e-8)
    ]
    assert errors[1] < errors[0] / 20.0


def test_a_compiled_run_goes_on_bit_by_bit_from_any_state_it_has_kept(monkeypatch):
    monkeypatch.setattr(time_integration, "_FIRST_STEPS", 1)
    monkeypatch.setattr(time_integration, "_MAX_CALL_TIME", 0.0)
    times = np.linspace(0.0, 3.0, 23)
    breaks = (1.0, 1.9)

    def watch(t, y):
        return np.array([y[0], y[1] - 0.5])

    def made(**start):
        return problem(oscillator, start.pop("y", START), True, watch, 2, breaks=breaks, **start)

    kept = []
    whole = run(
        "rodas5p", made(), times, save=lambda number, part: kept.append(part), save_interval=-1.0
    )
    assert len(kept) > 40
    before = None
    for part in kept:
        before = part if before is None else before.join(part)
        later = run(
            "rodas5p", made(y=before.last_y, t=before.last_t), times[before.t.size :],
            first_step=before.last_step, state=before.last_state,
        )  # fmt: skip
        again = before.join(later)
        assert np.array_equal(again.y, whole.y)
        assert again.events == whole.events
        assert (again.steps, again.rejected) == (whole.steps, whole.rejected)


def test_compiled_and_stepped_paths_agree():
    """The same method takes the same steps either way."""
    times = np.linspace(0.0, 3.0, 31)

    def watch(t, y):
        return [y[1] - 0.5]

    def given(compiled):
        return problem(oscillator, START, compiled, watch=watch, watched=1)

    stepped = run("rodas5p", given(False), times)
    compiled = run("rodas5p", given(True), times)
    assert np.abs(stepped.y - compiled.y).max() < 1e-7  # their differences have other widths
    for one, other in zip(stepped.events, compiled.events, strict=True):
        assert (one.watched, one.rising) == (other.watched, other.rising)
        assert one.time == pytest.approx(other.time, abs=1e-7)


# Events -------------------------------------------------------------------------------------------------------------

#: Watched: sin t - 1/2 and cos t.
PASSAGES = [(math.pi / 6, 0, True), (math.pi / 2, 1, False), (5 * math.pi / 6, 0, False)]


def two_passages(t, y):
    return [y[1] - 0.5, y[0]]


@EVERY
def test_events_are_located(name, compiled):
    found = run(
        name,
        problem(oscillator, START, compiled, watch=two_passages, watched=2),
        np.linspace(0.0, 3.0, 4),
    )
    assert [(e.watched, e.rising) for e in found.events] == [passage[1:] for passage in PASSAGES]
    for event, (time, *_) in zip(found.events, PASSAGES, strict=True):
        assert event.time == pytest.approx(time, abs=ERROR.get(name, 10) * 1e-8)


def test_a_run_bears_any_number_of_events():
    """Each ends the steps that a compiled solver takes at once; there were once 64 of them at most."""
    given = problem(
        oscillator, START, True, watch=lambda t, y: [math.cos(20.0 * math.pi * t)], watched=1
    )
    found = run("rodas5p", given, np.linspace(0.0, 5.001, 2), tolerance=1e-9)
    assert found.outcome == "finished", found.message
    assert [event.time for event in found.events] == pytest.approx(
        (np.arange(100) + 0.5) / 20.0, abs=1e-9
    )


@EVERY
def test_an_event_in_time_is_located_to_rounding(name, compiled):
    """Where the watched value is known without error, so is its zero."""
    given = problem(oscillator, START, compiled, watch=lambda t, y: [t - 1.2345678], watched=1)
    found = run(name, given, np.linspace(0.0, 2.0, 3))
    assert [e.time for e in found.events] == [pytest.approx(1.2345678, rel=1e-13)]


@EVERY
def test_a_run_stops_at_its_event(name, compiled):
    """At the first rise of what is to stop it; the last state stored is that of the event."""
    given = problem(oscillator, START, compiled, watch=lambda t, y: [y[0], -y[0]], watched=2)
    found = run(name, given, np.linspace(0.0, 3.0, 7), stop=frozenset({1}))
    assert found.outcome == "stopped"
    assert "stopped at t = 1.5708" in found.message
    last = next(e for e in found.events if e.watched == 1)
    assert last.time == pytest.approx(math.pi / 2, abs=ERROR.get(name, 10) * 1e-8)
    assert found.t.tolist() == [0.0, 0.5, 1.0, 1.5, last.time]
    assert found.last_t == last.time
    assert np.array_equal(found.y[-1], found.last_y)
    assert abs(found.y[-1, 0]) < 1e-12
    assert all(e.time <= last.time for e in found.events)


@EVERY
def test_a_fall_does_not_stop(name, compiled):
    given = problem(oscillator, START, compiled, watch=lambda t, y: [y[0]], watched=1)
    found = run(name, given, np.linspace(0.0, 3.0, 4), stop=frozenset({0}))
    assert found.outcome == "finished"
    assert [e.rising for e in found.events] == [False]


@EVERY
def test_an_event_at_a_stored_instant_stores_it_once(name, compiled):
    given = problem(oscillator, START, compiled, watch=lambda t, y: [t - 1.0], watched=1)
    found = run(name, given, np.linspace(0.0, 3.0, 7), stop=frozenset({0}))
    assert found.outcome == "stopped"
    assert found.t[-1] == found.events[0].time == pytest.approx(1.0, rel=1e-13)
    assert found.t[:2].tolist() == [0.0, 0.5]
    assert found.t.size == (3 if found.t[-1] <= 1.0 else 4)
    assert np.all(np.diff(found.t) > 0.0)


@EVERY
def test_neither_zero_nor_nan_is_a_side(name, compiled):
    """A value that starts at zero passes nothing, one that is not known cannot be passed, a touch is no passage."""

    def watch(t, y):
        return [math.sin(t) if t > 0.0 else 0.0, math.nan, abs(t - 1.0) if t < 1.5 else 1.0]

    found = run(
        name, problem(oscillator, START, compiled, watch=watch, watched=3), np.linspace(0.0, 3.0, 4)
    )
    assert found.events == ()


# Breaks -------------------------------------------------------------------------------------------------------------


@EVERY
def test_no_step_passes_over_a_break(name, compiled):
    """Rates that jump at 1 to another sign: each side is asked on its own, and the solution is exact to tolerance."""
    requested = []
    jumps = [0.0]

    def rates(t, y):
        requested.append(t)
        if len(requested) > 1 and (requested[-2] < 1.0) != (t < 1.0):
            jumps.append(t)
        return np.array([1.0 if t < 1.0 else -1.0])

    times = np.array([0.0, 0.5, 1.0, 1.5, 2.0])
    found = run(name, problem(rates, [0.0], compiled, breaks=(1.0, 0.0, 2.0, 5.0)), times)
    assert np.abs(found.y[:, 0] - [0.0, 0.5, 1.0, 0.5, 0.0]).max() < ERROR.get(name, 10) * 1e-8
    assert len(jumps) == 2, "the rates were asked for beyond the break, or before it again"
    assert len(requested) < 400


@EVERY
def test_breaks_and_events_belong_to_one_run(name, compiled):
    """An event after a break is found, an event at it once, and the work of both sides is counted."""
    given = problem(
        lambda t, y: np.array([1.0 if t < 1.0 else -1.0]),
        [0.0],
        compiled,
        watch=lambda t, y: [y[0] - 0.5, t - 1.0],
        watched=2,
        breaks=(1.0,),
    )
    found = run(name, given, np.linspace(0.0, 2.0, 3))
    assert [(e.watched, e.rising) for e in found.events] == [(0, True), (1, True), (0, False)]
    assert [e.time for e in found.events] == [
        pytest.approx(time, abs=1e-6) for time in (0.5, 1.0, 1.5)
    ]
    assert found.steps >= 2


# Interrupts ---------------------------------------------------------------------------------------------------------


def raising_after(calls, error, rates=oscillator):
    """Rates that raise once, after so many calls."""
    count = 0

    def counted(t, y):
        nonlocal count
        count += 1
        if count == calls:
            raise error
        return rates(t, y)

    return counted


@EVERY
def test_an_interrupted_run_goes_on_to_the_same_end(name, compiled):
    times = np.linspace(0.0, 3.0, 61)
    parts = []
    given = problem(
        raising_after(60, KeyboardInterrupt()), START, compiled, watch=two_passages, watched=2
    )
    found = run(name, given, times, save=lambda number, part: parts.append((number, part)))
    assert found.outcome == "interrupted"
    assert f"interrupted at t = {found.last_t:.6g} s" == found.message
    assert 0 < found.t.size < 61
    assert found.t[-1] <= found.last_t
    assert np.all(np.isfinite(found.y))
    assert [number for number, _ in parts] == [0]
    assert np.array_equal(parts[0][1].y, found.y)

    rest = problem(
        oscillator, found.last_y, compiled, watch=two_passages, watched=2, t=found.last_t
    )
    whole = found.join(run(name, rest, times[found.t.size :], first_step=found.last_step))
    assert whole.outcome == "finished"
    assert np.array_equal(whole.t, times)
    assert np.abs(whole.y - exact(times)).max() < ERROR.get(name, 10) * 1e-8
    assert [(e.watched, e.rising) for e in whole.events] == [passage[1:] for passage in PASSAGES]
    assert whole.evaluations > found.evaluations


@EVERY
def test_parts_together_are_the_whole(name, compiled):
    """Kept after every pause, they hold every instant, event and step once."""
    parts = []
    given = problem(oscillator, START, compiled, watch=two_passages, watched=2)
    found = run(
        name,
        given,
        np.linspace(0.0, 3.0, 61),
        save=lambda n, part: parts.append((n, part)),
        save_interval=0.0,
    )
    assert found.outcome == "finished"
    assert [number for number, _ in parts] == list(range(len(parts)))
    assert len(parts) > 1
    whole = parts[0][1]
    for _, part in parts[1:]:
        whole = whole.join(part)
    assert np.array_equal(whole.t, found.t[: whole.t.size])
    assert np.array_equal(whole.y, found.y[: whole.t.size])
    assert whole.events == found.events[: len(whole.events)]
    assert whole.steps <= found.steps
    assert whole.last_t == parts[-1][1].last_t


@EVERY
def test_what_an_interrupted_writer_left_is_written_again(name, compiled):
    """An interrupt while a part is written: the number comes again, with all that the part was to hold."""
    calls = []
    files = {}

    def save(number, part):
        files[number] = part
        calls.append(number)
        if len(calls) == 1:
            raise KeyboardInterrupt

    given = problem(oscillator, START, compiled, watch=two_passages, watched=2)
    found = run(name, given, np.linspace(0.0, 3.0, 61), save=save, save_interval=0.0)
    assert found.outcome == "interrupted"
    assert calls == [0, 0]
    assert np.array_equal(files[0].t, found.t)
    assert files[0].steps == found.steps


class Interrupted(Rosenbrock):
    """A compiled solver that is interrupted when it comes back from its work, before anybody has its answer."""

    def advance(self, *given, **options):
        super().advance(*given, **options)
        raise KeyboardInterrupt


@pytest.mark.parametrize("stop", [frozenset(), frozenset({0})])
def test_an_interrupt_loses_no_event(stop):
    class Model:
        name = "interrupted"

        def compiled(self):
            return Interrupted

    given = problem(oscillator, START, True, watch=two_passages, watched=2)
    found = integrate(given, Model(), np.linspace(0.0, 3.0, 31), rtol=1e-8, stop=stop)
    assert found.outcome == ("stopped" if stop else "interrupted")
    (event,) = found.events
    assert (event.watched, event.rising) == (0, True)
    assert event.time == found.last_t == pytest.approx(math.pi / 6, abs=1e-6)
    stored = np.append(np.arange(6) * 0.1, event.time) if stop else np.arange(6) * 0.1
    assert np.allclose(found.t, stored, rtol=1e-12)
    assert np.abs(found.y - exact(found.t)).max() < 1e-6


@pytest.mark.parametrize("calls", range(2, 40))
def test_an_interrupt_while_watching_loses_no_instant(calls):
    """Wherever it comes: all instants up to the last state are there, and right."""
    given = problem(
        oscillator,
        START,
        True,
        watch=raising_after(calls, KeyboardInterrupt(), two_passages),
        watched=2,
    )
    found = run("rodas5p", given, np.linspace(0.0, 3.0, 301))
    assert found.outcome == "interrupted"
    assert found.t.size == 0 or np.abs(found.y - exact(found.t)).max() < 1e-6
    assert (
        found.t.size == np.searchsorted(np.linspace(0.0, 3.0, 301), found.last_t, side="right")
        or calls == 2
    )


# Failures -----------------------------------------------------------------------------------------------------------


@EVERY
def test_what_a_failing_model_left_is_kept(name, compiled):
    error = DomainError("mine: no friction there")
    times = np.linspace(0.0, 3.0, 61)
    found = run(name, problem(raising_after(60, error), START, compiled), times)
    assert found.outcome == "failed"
    assert found.error is error
    assert found.message == f"DomainError at t = {found.last_t:.6g} s: mine: no friction there"
    assert 0 < found.t.size < 61
    assert np.abs(found.y - exact(found.t)).max() < ERROR.get(name, 10) * 1e-8


@EVERY
def test_a_model_that_fails_at_once_leaves_the_start(name, compiled):
    found = run(
        name,
        problem(raising_after(1, RuntimeError("no")), START, compiled),
        np.linspace(0.0, 1.0, 3),
    )
    assert found.outcome == "failed"
    assert found.t.tolist() == [0.0]
    assert np.array_equal(found.last_y, START)


@pytest.mark.filterwarnings(
    "ignore::UserWarning", "ignore:overflow", "ignore:invalid", "ignore:divide"
)
@EVERY
def test_a_solution_that_becomes_infinite_ends_in_words(name, compiled):
    """y' = y^2 from 1 on has a pole at t = 1."""
    found = run(name, problem(lambda t, y: y * y, [1.0], compiled), np.linspace(0.0, 2.0, 21))
    assert found.outcome == "failed"
    assert len(found.message) > 20
    assert found.last_t == pytest.approx(1.0, abs=1e-3)
    assert np.array_equal(found.t, np.linspace(0.0, 2.0, 21)[: found.t.size])
    assert found.t.size >= 10
    assert np.allclose(found.y[:9, 0], 1.0 / (1.0 - found.t[:9]), rtol=1e-4)


@pytest.mark.filterwarnings("ignore::UserWarning", "ignore:overflow", "ignore:invalid")
@EVERY
@pytest.mark.parametrize("since", [-1.0, 0.5], ids=["from the start", "later"])
def test_rates_that_are_no_numbers_end_in_words(name, compiled, since):
    def rates(t, y):
        return np.full(1, math.nan) if t >= since else -y

    found = run(name, problem(rates, [1.0], compiled), np.linspace(0.0, 1.0, 11))
    assert found.outcome == "failed"
    assert len(found.message) > 20
    assert np.all(np.isfinite(found.y))
    # leapfrog asks for the middle of a step, and may come as far as where there are none
    assert found.t.size == (1 if since < 0.0 else 6 if name == "leapfrog" else 5)
    assert np.allclose(found.y[:, 0], np.exp(-found.t), atol=1e-5)


def test_settings_that_a_solver_refuses_end_in_words():
    given = attrs.evolve(problem(falling, [1.0], True), atol=np.array([-1.0]))
    found = run("rodas5p", given, np.linspace(0.0, 1.0, 3))
    assert found.outcome == "failed"
    assert "atol not negative" in found.message
    assert found.t.tolist() == [0.0]


class Wandering(OdeSolver):
    """A stranger's solver: exact steps of a tenth, whose dense output misses the ends of its step."""

    def __init__(self, fun, t0, y0, t_bound, rtol=1e-3, atol=1e-6, first_step=None):
        super().__init__(fun, t0, y0, t_bound, vectorized=False)

    def _step_impl(self):
        t = min(self.t + 0.1, self.t_bound)
        self.y = self.y * math.exp(self.t - t)
        self.t = t
        return True, None

    def _dense_output_impl(self):
        return lambda t: np.exp(-np.atleast_1d(t)) * (1.0 + 1e-3 * math.sin(97.0 * self.t))


@pytest.mark.parametrize("limit", np.exp(-np.arange(1, 10) / 10.0))
@pytest.mark.parametrize("shift", [-1e-5, 0.0, 1e-5])
def test_an_event_at_the_edge_of_a_step_is_found(limit, shift):
    """Even if the dense output puts it just outside: it lies in that step then, at its edge."""

    class Model:
        name = "wandering"

        def compiled(self):
            return None

        def solver(self):
            return Wandering

    given = problem(falling, [1.0], watch=lambda t, y: [y[0] - limit - shift], watched=1)
    found = integrate(given, Model(), np.linspace(0.0, 2.0, 3), rtol=1e-3)
    assert [(e.watched, e.rising) for e in found.events] == [(0, False)]
    assert found.events[0].time == pytest.approx(-math.log(limit), abs=2e-3)
    assert isinstance(found.events[0], Event)


@pytest.mark.parametrize(("rejected", "both"), [(2, 3), (-1, -1)])
def test_a_run_that_went_on_has_the_work_of_both_parts(rejected, both):
    first, later = (
        Trajectory(
            t=np.array([t]), y=np.array([[t]]), events=(), outcome="finished", message="", error=None, last_t=t,
            last_y=np.array([t]), last_step=0.1, steps=3, rejected=no, evaluations=10, jacobians=4, wall_time=2.0,
        )
        for t, no in ((1.0, 1), (2.0, rejected))
    )  # fmt: skip
    whole = first.join(later)
    assert (whole.steps, whole.rejected, whole.evaluations, whole.jacobians, whole.wall_time) == (
        6,
        both,
        20,
        8,
        4.0,
    )
    assert (whole.t.tolist(), whole.y.tolist(), whole.last_t) == ([1.0, 2.0], [[1.0], [2.0]], 2.0)


def test_what_would_come_later_in_the_step_that_stops_is_no_event():
    problem = InitialValueProblem(
        rates=lambda t, y: np.ones(1),
        y=np.zeros(1),
        atol=np.ones(1),
        watch=lambda t, y: y - np.array([0.2, 0.6]),
    )
    found = integrate(
        problem,
        get_model("integrator", "rk45"),
        np.array([0.0, 1.0]),
        rtol=1e-3,
        stop=frozenset({0}),
        first_step=0.9,
    )
    assert [(event.watched, event.time) for event in found.events] == [(0, pytest.approx(0.2))]
    assert (found.outcome, found.t.tolist()) == ("stopped", [0.0, pytest.approx(0.2)])


class _PassesOptionsOn(Radau):
    def __init__(self, fun, t0, y0, t_bound, **options):
        super().__init__(fun, t0, y0, t_bound, **options)


@pytest.mark.parametrize(
    ("solver", "expected"), [(Radau, True), (_PassesOptionsOn, True), (RK45, False)]
)
def test_a_solver_gets_the_jacobian_that_its_base_class_takes(solver, expected):
    given = []

    class Recording(solver):
        def __init__(self, fun, t0, y0, t_bound, **options):
            given.append("jac" in options)
            super().__init__(fun, t0, y0, t_bound, **options)

    class Offered(IntegratorModel):
        """A solver of SciPy, or one derived from it."""

        name = "offered"

        def solver(self):
            return Recording

    decay = problem(lambda t, y: -y, [1.0], jacobian=lambda t, y: -np.eye(1))
    found = integrate(decay, Offered(), np.array([0.0, 1.0]), rtol=1e-8)
    assert given == [expected]
    np.testing.assert_allclose(found.last_y, np.exp(-1.0), rtol=1e-6)
