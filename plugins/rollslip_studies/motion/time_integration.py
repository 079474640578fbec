"""Carry an initial-value problem through time: stored instants, located events, and what is kept when it ends early.

- Any ``scipy.integrate.OdeSolver`` serves and is stepped here. An integrator that takes compiled systems goes through
  many steps at once without Python. Both leave the same `Trajectory`.
- What was computed is never lost: an interrupt, a model that fails in mid-run, and a solver that gives up all end the
  trajectory with an outcome in words, and the last state is there to go on from.
- An event is a change of sign of a watched value. It is located on the dense output of the step it lies in.
- Up to a break of the rates and from it on are two problems: the first ends a rounding before it, so that its rates
  are never asked for on the other side.
"""

import logging
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any, Final, Literal

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.models import IntegratorModel
from rollslip_kernels.motion.system import RefusedError, System

_log = logging.getLogger(__name__)

Floats = NDArray[np.float64]
Counts = NDArray[np.int_]
Outcome = Literal["finished", "stopped", "interrupted", "failed"]

#: Steps without progress after which a solver is taken to stand still (SciPy's LSODA does before a singularity).
_STILL: Final = 100
#: Steps of a compiled solver between two looks at the clock: at first, and at most twice as many as before while they
#: take less than this time [s].
_MANY: Final = 1000
_QUICK: Final = 2e-2
#: Evaluations in a row without a number after which there will be none (SciPy's explicit methods then go on for ever).
_NO_NUMBERS: Final = 200
#: What is left out before a break, relative: more than rounding moves the last time that a step asks for.
_BEFORE: Final = 4e-15
#: Least relative tolerance of an unknown: what is below is governed by rounding.
_LEAST: Final = 2.3e-14
#: Relative precision of an event in time.
_EVENT: Final = 1e-14


@attrs.frozen
class Event:
    """A watched value that changed its sign."""

    time: float
    #: number of the watched value
    watched: int
    rising: bool


@attrs.frozen(eq=False)
class Trajectory:
    """What was computed.

    Attributes
    ----------
    t : ndarray
        Stored instants [s], shape (m,); the state at an event that stopped it is the last.
    y : ndarray
        States, shape (m, n).
    events : tuple of Event
        In order of time.
    outcome : str
        "finished", "stopped" (at an event), "interrupted" or "failed".
    message : str
        Why it did not reach the end, in words; empty if it did.
    error : BaseException or None
        What a model raised.
    last_t, last_y, last_step
        Where it can be gone on from, and the step size it had there; 0 if none is known.
    steps, rejected, evaluations, jacobians : int
        Work done; rejected is -1 where the solver does not tell.
    wall_time : float
        [s].
    last_state : ndarray
        All that the next steps of a compiled solver depend on at ``last_t``; empty if it is not known.
    processor_time : float
        Time of the processor that the integration alone took [s].
    told : mapping
        What the solver tells of itself.
    """

    t: Floats
    y: Floats
    events: tuple[Event, ...]
    outcome: Outcome
    message: str
    error: BaseException | None
    last_t: float
    last_y: Floats
    last_step: float
    steps: int
    rejected: int
    evaluations: int
    jacobians: int
    wall_time: float
    last_state: Floats = attrs.field(factory=lambda: np.zeros(0))
    processor_time: float = 0.0
    told: Mapping[str, float] = attrs.field(factory=dict)

    def then(self, later: "Trajectory") -> "Trajectory":
        """Return this trajectory with a later one that went on from it."""
        return attrs.evolve(
            later,
            t=np.concatenate((self.t, later.t)),
            y=np.concatenate((self.y, later.y)),
            events=self.events + later.events,
            steps=self.steps + later.steps,
            rejected=-1
            if min(self.rejected, later.rejected) < 0
            else self.rejected + later.rejected,
            evaluations=self.evaluations + later.evaluations,
            jacobians=self.jacobians + later.jacobians,
            wall_time=self.wall_time + later.wall_time,
            processor_time=self.processor_time + later.processor_time,
        )


@attrs.frozen(eq=False, kw_only=True)
class InitialValueProblem:
    """y' = rates(t, y) from a state on.

    Parameters
    ----------
    rates : callable
        (t, y) -> dy/dt, or a compiled `System`, which solvers that can take one run without Python.
    y : ndarray
        State at ``t``.
    t : float
        [s].
    atol : ndarray
        Absolute tolerance of every unknown.
    relative : ndarray, optional
        Relative tolerance of every unknown over that of the run, by default 1. Compiled solvers take it; those of SciPy
        have one for all.
    jacobian : callable, optional
        (t, y) -> df/dy, for implicit solvers of SciPy.
    watch : callable, optional
        (t, y) -> watched values.
    breaks : sequence of float
        Times at which the rates are not smooth, or jump to what they are from then on; no step passes over one.
    at_rest : callable, optional
        (t, end, y) -> whether the state stays as it is until the next break; asked at breaks.
    """

    rates: Any
    y: Floats
    t: float = 0.0
    atol: Floats
    relative: Floats | None = None
    jacobian: Callable[[float, Floats], Floats] | None = None
    watch: Callable[[float, Floats], Floats] | None = None
    breaks: tuple[float, ...] = ()
    at_rest: Callable[[float, float, Floats], bool] | None = None


def integrate(
    problem: InitialValueProblem,
    integrator: IntegratorModel,
    times: Floats,
    *,
    rtol: float,
    stop: frozenset[int] = frozenset(),
    first_step: float = 0.0,
    state: Floats | None = None,
    keep: Callable[[int, Trajectory], None] | None = None,
    every: float = 10.0,
) -> Trajectory:
    """Integrate to the last of ``times``, which are the instants stored.

    Parameters
    ----------
    problem : InitialValueProblem
        What is integrated.
    integrator : IntegratorModel
        What steps through it.
    times : ndarray
        Instants to store, ascending, none before the problem's t.
    rtol : float
        Relative tolerance of the solver.
    stop : frozenset of int
        Watched values whose rising through zero ends the run.
    first_step : float
        Step size to begin with; 0 leaves it to the solver.
    state : ndarray, optional
        ``last_state`` of a run that this one goes on from: a compiled solver then takes the steps that it would have.
    keep : callable, optional
        Given what was computed since it was last called, every so many seconds and when the run is interrupted, with
        a number; a progress bar and the writing of long runs hang on it. A call that an interrupt cut short is
        repeated with the same number and more.
    every : float
        Those seconds.
    """
    run = _Run(
        problem, integrator, np.asarray(times, dtype=float), rtol, stop, first_step, keep, every
    )
    if state is not None:
        run.state = state
    return run.to_the_end()


class _Run:
    """The state of one integration."""

    def __init__(
        self,
        problem: InitialValueProblem,
        integrator: IntegratorModel,
        times: Floats,
        rtol: float,
        stop: frozenset[int],
        first_step: float,
        keep: Callable[[int, Trajectory], None] | None,
        every: float,
    ) -> None:
        self.problem = problem
        self.integrator = integrator
        self.times = times
        self.rtol = rtol
        self.stop = stop
        self.keep = keep
        self.every = every
        self.t = problem.t
        self.y = np.array(problem.y, dtype=float)
        self.h = first_step
        self.state: Floats = np.zeros(0)  # of a compiled solver at t
        self.told: Mapping[str, float] = {}
        self.stored = np.full((times.size, self.y.size), np.nan)
        self.count = 0  # instants stored
        self.events: list[Event] = []
        self.work: Counts = np.zeros(4, dtype=int)  # steps, rejected, evaluations, jacobians
        self.extra: tuple[float, Floats] | None = (
            None  # state at the event that stops, between the instants
        )
        self.begin = self.clock = time.perf_counter()
        self.worked = self.looked = time.process_time()
        self.sides: Floats = np.zeros(0)  # of zero on which the watched values are
        self.parts = 0  # kept, and what they hold: instants, events, work
        self.kept = (0, 0, self.work)

    def to_the_end(self) -> Trajectory:
        outcome: Outcome = "finished"
        message = ""
        raised = None
        try:
            if self.problem.watch is not None:
                self.sides = np.sign(np.nan_to_num(self.problem.watch(self.t, self.y)))
            self._store_reached()
            last = float(self.times[-1]) if self.times.size else self.t
            for end in sorted(b for b in {*self.problem.breaks, last} if self.t < b <= last):
                message = self._stretch(
                    end, end - _BEFORE * max(abs(end), end - self.t) if end < last else end
                )
                if message:
                    outcome = "stopped" if self.extra is not None else "failed"
                    break
        except KeyboardInterrupt:
            outcome = "interrupted"
            message = f"interrupted at t = {self.t:.6g} s"
        except Exception as error:
            outcome = "failed"
            raised = error
            message = f"{type(error).__name__} at t = {self.t:.6g} s: {error}"
        if outcome == "interrupted" and self.extra is not None:  # where it was to stop anyhow
            outcome = "stopped"
            message = f"stopped at t = {self.t:.6g} s"
        steps, rejected, evaluations, _ = self.work
        _log.debug(
            "%s %s at t = %g s: %d steps, %d rejected, %d evaluations of the rates",
            self.integrator.name, message or outcome, self.t, steps, rejected, evaluations,
        )  # fmt: skip
        if self.keep is not None and outcome == "interrupted":
            self.keep(self.parts, self._since(*self.kept, outcome, message, None))
        return self._since(0, 0, np.zeros(4, dtype=int), outcome, message, raised)

    def _since(
        self,
        count: int,
        events: int,
        work: Counts,
        outcome: Outcome,
        message: str,
        raised: BaseException | None,
    ) -> Trajectory:
        t = self.times[count : self.count]
        y = self.stored[count : self.count]
        if self.extra is not None and not (t.size and t[-1] == self.extra[0]):
            t = np.append(t, self.extra[0])
            y = np.vstack((y, self.extra[1]))
        work = self.work - work
        return Trajectory(
            t=t,
            y=y,
            events=tuple(self.events[events:]),
            outcome=outcome,
            message=message,
            error=raised,
            last_t=self.t,
            last_y=self.y,
            last_step=self.h,
            steps=int(work[0]),
            rejected=int(work[1]) if self.work[1] >= 0 else -1,
            evaluations=int(work[2]),
            jacobians=int(work[3]),
            wall_time=time.perf_counter() - (self.begin if count == 0 else self.clock),
            last_state=self.state,
            processor_time=time.process_time() - (self.worked if count == 0 else self.looked),
            told=self.told,
        )

    def _stretch(self, end: float, bound: float) -> str:
        """Go to a time up to which the rates are smooth, by a solver that ends there or just before it.

        Return why it was not reached.
        """
        if self.problem.at_rest is not None and self.problem.at_rest(self.t, end, self.y):
            upto = int(np.searchsorted(self.times, end, side="right"))
            self.stored[self.count : upto] = self.y
            self.t = end
            self.count = upto
            return ""
        options: dict[str, Any] = {"rtol": self.rtol, "atol": self.problem.atol}
        if 0.0 < self.h < bound - self.t:
            options["first_step"] = self.h
        compiled = self.integrator.compiled()
        if compiled is not None and isinstance(self.problem.rates, System):
            if self.problem.relative is not None:
                options["rtol"] = np.maximum(self.rtol * self.problem.relative, _LEAST)
            solver = compiled(self.problem.rates.capsule, self.t, self.y, bound, **options)
            state = solver.state
            if state.shape == self.state.shape and self.state[0] == self.t:
                state = self.state
                self.sides = self.state[4 : 4 + self.sides.size].copy()
            else:
                state[4 : 4 + self.sides.size] = (
                    self.sides
                )  # which it may have left just before a break
            solver.state = state
            message = self._advanced(solver, bound)
        else:
            stepped = self.integrator.solver()
            if self.problem.jacobian is not None and _takes_jacobian(stepped):
                options["jac"] = self.problem.jacobian
            rates = _Rates(self.problem.rates)
            message = self._stepped(stepped(rates, self.t, self.y, bound, **options), rates)
        if not message:
            self.t = end
            self._store_reached()
        return message

    # Many steps at once -----------------------------------------------------------------------------------------------

    def _advanced(self, solver: Any, end: float) -> str:
        before = self.work
        many = _MANY
        while True:
            begin = time.perf_counter()
            upto = int(np.searchsorted(self.times, end, side="right"))
            reason = "raised"
            try:
                reason, _ = solver.advance(
                    end,
                    self.times[self.count : upto],
                    self.stored[self.count : upto],
                    max_steps=many,
                )
            finally:  # a model may have raised, or an interrupt have come before its results were taken
                self._store_until(solver.t, solver.y, solver.interpolate)
                self.t = float(solver.t)
                self.y = solver.y
                self.h = float(solver.h)
                self.work = before + np.array(
                    [solver.steps, solver.rejected, solver.evaluations, solver.jacobians]
                )
                self.state, self.told = solver.state, getattr(solver, "told", {})
                passed = self._changed_sides(self.state[4 : 4 + self.sides.size])
                self.events += [Event(self.t, k, rising) for k, rising in passed]
                stopped = any(rising and k in self.stop for k, rising in passed)
                if stopped:
                    self.extra = self.t, self.y
            if stopped:
                return f"stopped at t = {self.t:.6g} s"
            if reason == "failed":
                return str(solver.message)
            if reason in ("stop", "finished"):
                return ""
            self._pause()
            if reason == "steps":  # an event may come after any number of them
                many = 2 * many if time.perf_counter() - begin < _QUICK else max(many // 2, _MANY)

    # Step by step -----------------------------------------------------------------------------------------------------

    def _stepped(self, solver: Any, rates: "_Rates") -> str:
        before = self.work
        still = 0
        steps = 0
        while solver.status == "running":
            try:
                message = solver.step()
            finally:
                steps += 1
                self.work = np.array(
                    [before[0] + steps, -1, before[2] + solver.nfev, before[3] + solver.njev]
                )
            if rates.raised is not None:
                raise rates.raised
            if solver.status == "failed":
                return (
                    f"the solver gave up at t = {self.t:.6g} s: {message or 'it does not say why'}"
                )
            still = (
                still + 1
                if solver.t - self.t <= 1e-12 * max(abs(self.t), solver.t_bound - solver.t)
                else 0
            )
            if still > _STILL:
                return f"the solver stands still at t = {self.t:.6g} s: its steps are lost in the rounding of time"
            if not np.all(np.isfinite(solver.y)):
                return f"the solution is not finite after t = {self.t:.6g} s"
            if self._stopped_in_step(solver):
                return f"stopped at t = {self.t:.6g} s"
            self._pause()
        return ""

    def _stopped_in_step(self, solver: Any) -> bool:
        """Take the last step of a solver, up to the first event that ends the run, and tell whether there is one."""
        watch = self.problem.watch
        dense = solver.dense_output()
        passed = [] if watch is None else self._changed_sides(watch(solver.t, solver.y))
        events = [Event(self._locate(dense, solver, k, rising), k, rising) for k, rising in passed]
        events.sort(key=lambda event: event.time)
        final = next(
            (event for event in events if event.rising and event.watched in self.stop), None
        )
        t = float(solver.t) if final is None else final.time
        y = np.array(solver.y if final is None else dense(t))
        self._store_until(t, y, dense)
        self.t = t
        self.y = y
        self.h = float(solver.step_size or 0.0)
        self.events += [event for event in events if event.time <= t]
        if final is not None:
            self.extra = t, y
        return final is not None

    def _locate(self, dense: Any, solver: Any, k: int, rising: bool) -> float:
        """Time at which a watched value changed sides in the last step of a solver."""
        from scipy.optimize import brentq

        watch = self.problem.watch
        start = self.t
        end = float(solver.t)
        assert watch is not None

        def beyond(t: float) -> float:
            return float(watch(t, dense(t))[k]) * (1.0 if rising else -1.0)

        # the dense output of a multistep method misses the states at the ends of its step a little
        if beyond(start) >= 0.0:
            return start
        if beyond(end) <= 0.0:
            return end
        return float(brentq(beyond, start, end, xtol=_EVENT * max(abs(end), 1e-6), rtol=1e-15))

    def _changed_sides(self, values: Floats) -> list[tuple[int, bool]]:
        """Which watched values have changed their sign, and whether they rose; neither zero nor NaN has one."""
        now = np.sign(np.nan_to_num(values))
        passed = [(int(k), bool(now[k] > 0.0)) for k in np.flatnonzero(now * self.sides < 0.0)]
        self.sides = np.where(now == 0.0, self.sides, now)
        return passed

    # Storing ----------------------------------------------------------------------------------------------------------

    def _store_reached(self) -> None:
        """Store the state at the instants that have been reached."""
        while self.count < self.times.size and self.times[self.count] <= self.t:
            self.stored[self.count] = self.y
            self.count += 1

    def _store_until(self, t: float, y: Floats, dense: Callable[[float], Floats]) -> None:
        """Store the states of a step that ends with y at t, where they are not yet."""
        end = int(np.searchsorted(self.times, t, side="right"))
        for k in range(self.count, end):
            if np.isnan(self.stored[k, 0]):
                self.stored[k] = y if self.times[k] == t else dense(self.times[k])
        self.count = max(self.count, end)

    def _pause(self) -> None:
        if self.keep is not None and time.perf_counter() - self.clock > self.every:
            self.keep(self.parts, self._since(*self.kept, "interrupted", "", None))
            self.parts = self.parts + 1
            self.kept = (self.count, len(self.events), self.work)
            self.clock = time.perf_counter()
            self.looked = time.process_time()


class _Rates:
    """Rates as a solver is given them: what they raise comes out, whatever it does with it, and no numbers end.

    Where a trial step leaves what the rates are defined on they are NaN, at which solvers try a shorter step.
    """

    def __init__(self, rates: Callable[[float, Floats], Floats]) -> None:
        self.rates = rates
        self.without = 0
        self.raised: BaseException | None = None

    def __call__(self, t: float, y: Floats) -> Floats:
        try:
            rates = self._defined(t, y)
            self.without = 0 if np.all(np.isfinite(rates)) else self.without + 1
            if self.without > _NO_NUMBERS:
                raise ArithmeticError("the rates are not finite there, or a little after it")
        except BaseException as error:
            self.raised = error
            raise
        return rates

    def _defined(self, t: float, y: Floats) -> Floats:
        if np.all(np.isfinite(y)):
            with suppress(RefusedError):
                return self.rates(t, y)
        return np.full(np.shape(y), np.nan)


def _takes_jacobian(solver: type[Any]) -> bool:
    import inspect

    return "jac" in inspect.signature(solver.__init__).parameters
