"""Integrate an initial-value problem over time: stored times, located events, and the state where it ends early.

1. Divide the time at the breaks of the rates. Each interval ends a rounding before its break, so that its rates are
   never evaluated on the other side.
2. In an interval, a compiled integrator advances many steps in one call. Any other ``scipy.integrate.OdeSolver`` is
   stepped here. Both leave the same `Trajectory`.
3. After each step, store the states at the requested times by the dense output of the step.
4. An event is a change of sign of a watched value. It is located on the dense output by Brent's method. Steps go on
   unless it ends the run.
5. Save what was computed every few seconds, if requested.

An interrupt, a model that fails during the run, and a solver that gives up all end the trajectory with an outcome and a
message. Nothing that was computed is lost, and the run can continue from the last state.
"""

import inspect
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

#: Number of steps without progress after which a solver counts as stalled. SciPy's LSODA stalls before a
#: singularity; doubling it takes as many useless steps more. Chosen.
_MAX_STALLED_STEPS: Final = 100
#: Progress of a step, relative to the larger of the time reached and the time left, below which the solver stalls.
#: Doubling it has no effect
#: on steps that resolve anything; chosen, above the rounding of time.
_MIN_PROGRESS: Final = 1e-12
#: Number of steps of the first call of a compiled solver, between two checks of the clock. Later calls take up to
#: twice as many as the previous one while that took less than `_MAX_CALL_TIME`. Doubling it delays an interrupt by
#: as many steps; chosen.
_FIRST_STEPS: Final = 1000
#: Processing time of a call [s] below which the next one takes more steps. Doubling it doubles the delay of an
#: interrupt and of the progress that is shown; chosen, not noticed by people.
_MAX_CALL_TIME: Final = 2e-2
#: Number of evaluations in a row without finite numbers after which an integration fails, because SciPy's explicit
#: methods would halve their step for ever. Doubling it takes longer to fail; chosen, more than a step of any
#: method.
_MAX_WITHOUT_NUMBERS: Final = 200
#: Relative distance before a break at which an interval ends. Half of it lets rounding evaluate the rates beyond
#: the break; twice as much changes the solution by rounding. Twenty times the rounding of a number.
_BREAK_GAP: Final = 4e-15
#: Smallest relative tolerance of an unknown. Below it, rounding governs the step; a hundred times the rounding, as
#: in SciPy's solvers.
_MIN_TOLERANCE: Final = 2.3e-14
#: Index of the first sign of a watched value in the state of a compiled solver, as kernels lay it out.
_FIRST_SIGN: Final = 4
#: Relative precision of the time of an event. Doubling it doubles the error; chosen, near rounding.
_EVENT_PRECISION: Final = 1e-14
#: Smallest time [s] to which that precision is relative, for events near zero. Doubling it doubles their error; chosen,
#: less than a step of any bearing.
_EVENT_TIME: Final = 1e-6


@attrs.frozen
class Event:
    """A watched value that changed its sign."""

    time: float
    watched: int  # number of the watched value
    rising: bool


@attrs.frozen(eq=False)
class Trajectory:
    """States over time, and how the integration ended.

    Attributes
    ----------
    t : ndarray
        Stored times [s], (m,); the last is that of the event that stopped it.
    y : ndarray
        States, (m, n).
    events : tuple of Event
        In order of time.
    outcome : str
        "finished", "stopped" (at an event), "interrupted" or "failed".
    message : str
        Why it did not reach the end; empty if it did.
    error : BaseException or None
        What a model raised.
    last_t, last_y, last_step
        Time, state and step size from which it can continue; the step size is 0 if none is known.
    steps, rejected, evaluations, jacobians : int
        Numbers of each; rejected is -1 where the solver does not count them.
    wall_time : float
        Elapsed time [s].
    last_state : ndarray
        State of a compiled solver at ``last_t``, on which its next steps depend; empty if it is not known.
    processor_time : float
        Processor time of the integration alone [s].
    diagnostics : mapping
        Numbers that the solver reports on its work, by name.
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
    diagnostics: Mapping[str, float] = attrs.field(factory=dict)

    def join(self, later: "Trajectory") -> "Trajectory":
        """Return this trajectory joined with a later one that continues it."""
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
    """The problem y' = rates(t, y) with an initial state.

    Parameters
    ----------
    rates : callable
        (t, y) -> dy/dt, or a compiled `System`, with which compiled solvers run without Python.
    y : ndarray
        State at ``t``.
    t : float
        Initial time [s].
    atol : ndarray
        Absolute tolerance of every unknown.
    relative : ndarray, optional
        Relative tolerance of every unknown over that of the run, by default 1. Compiled solvers use it; those of SciPy
        have one tolerance for all.
    jacobian : callable, optional
        (t, y) -> df/dy, for implicit solvers of SciPy.
    watch : callable, optional
        (t, y) -> watched values.
    breaks : sequence of float
        Times at which the rates are not smooth, or jump to their later values; no step crosses one.
    at_rest : callable, optional
        (t, end, y) -> whether the state is constant until the next break; evaluated at breaks.
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
    save: Callable[[int, Trajectory], None] | None = None,
    save_interval: float = 10.0,
) -> Trajectory:
    """Integrate to the last of ``times`` and store the states at these.

    Parameters
    ----------
    problem : InitialValueProblem
        The problem.
    integrator : IntegratorModel
        The method.
    times : ndarray
        Times to store [s], ascending, none before the initial time.
    rtol : float
        Relative tolerance of the solver.
    stop : frozenset of int
        Numbers of watched values whose rise through zero ends the run.
    first_step : float
        First step size [s]; 0 leaves it to the solver.
    state : ndarray, optional
        ``last_state`` of a run that this one continues: a compiled solver then takes the same steps as without a stop.
    save : callable, optional
        Called with a number and the trajectory since the previous call, at intervals and when the run is interrupted,
        to show progress and write long runs. A call which an interrupt ended early is repeated with the same number
        and a longer trajectory.
    save_interval : float
        Time between these calls [s].
    """
    integration = _Run(
        problem,
        integrator,
        np.asarray(times, dtype=float),
        rtol,
        stop,
        first_step,
        save,
        save_interval,
    )
    if state is not None:
        integration.state = state
    return integration.run()


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
        save: Callable[[int, Trajectory], None] | None,
        save_interval: float,
    ) -> None:
        self.problem = problem
        self.integrator = integrator
        self.times = times
        self.rtol = rtol
        self.stop = stop
        self.save = save
        self.save_interval = save_interval
        self.t = problem.t
        self.y = np.array(problem.y, dtype=float)
        self.h = first_step
        self.state: Floats = np.zeros(0)  # of a compiled solver at t
        self.diagnostics: Mapping[str, float] = {}
        self.stored = np.full((times.size, self.y.size), np.nan)
        self.count = 0  # times stored
        self.events: list[Event] = []
        self.work: Counts = np.zeros(4, dtype=int)  # steps, rejected, evaluations, jacobians
        #: time and state at the event that stops the run, between the stored times
        self.stop_state: tuple[float, Floats] | None = None
        self.signs: Floats = np.zeros(0)  # of the watched values
        self.n_parts = 0  # saved
        self.start = self.saved = self._measure_progress()  # at the start, and in the saved parts

    def _measure_progress(self) -> tuple[int, int, Counts, float, float]:
        """Numbers of stored times and events, the work so far, and the clocks of elapsed and processor time [s]."""
        return self.count, len(self.events), self.work, time.perf_counter(), time.process_time()

    def run(self) -> Trajectory:
        """Integrate to the last time, and return the trajectory whatever ends it."""
        outcome: Outcome = "finished"
        message = ""
        raised = None
        try:
            if self.problem.watch is not None:
                self.signs = np.sign(np.nan_to_num(self.problem.watch(self.t, self.y)))
            self._store_reached()
            last = float(self.times[-1]) if self.times.size else self.t
            for end in sorted(b for b in {*self.problem.breaks, last} if self.t < b <= last):
                gap = _BREAK_GAP * max(abs(end), end - self.t) if end < last else 0.0
                if message := self._integrate_to(end, end - gap):
                    outcome = "stopped" if self.stop_state is not None else "failed"
                    break
        except KeyboardInterrupt:
            outcome = "interrupted"
            message = f"interrupted at t = {self.t:.6g} s"
        except Exception as error:
            outcome = "failed"
            raised = error
            message = f"{type(error).__name__} at t = {self.t:.6g} s: {error}"
        if outcome == "interrupted" and self.stop_state is not None:  # it had stopped already
            outcome = "stopped"
            message = f"stopped at t = {self.t:.6g} s"
        steps, rejected, evaluations, _ = self.work
        _log.debug(
            "%s %s at t = %g s: %d steps, %d rejected, %d evaluations of the rates",
            self.integrator.name, message or outcome, self.t, steps, rejected, evaluations,
        )  # fmt: skip
        if self.save is not None and outcome == "interrupted":
            self.save(self.n_parts, self._trajectory_since(self.saved, outcome, message, None))
        return self._trajectory_since(self.start, outcome, message, raised)

    def _trajectory_since(
        self,
        progress: tuple[int, int, Counts, float, float],
        outcome: Outcome,
        message: str,
        raised: BaseException | None,
    ) -> Trajectory:
        count, events, work, wall, processor = progress
        t = self.times[count : self.count]
        y = self.stored[count : self.count]
        if self.stop_state is not None and not (t.size and t[-1] == self.stop_state[0]):
            t = np.append(t, self.stop_state[0])
            y = np.vstack((y, self.stop_state[1]))
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
            wall_time=time.perf_counter() - wall,
            last_state=self.state,
            processor_time=time.process_time() - processor,
            diagnostics=self.diagnostics,
        )

    def _integrate_to(self, end: float, bound: float) -> str:
        """Integrate to the end of an interval in which the rates are smooth, by a solver that ends at ``bound``.

        Return the message why it was not reached, empty if it was.
        """
        if self.problem.at_rest is not None and self.problem.at_rest(self.t, end, self.y):
            reached = int(np.searchsorted(self.times, end, side="right"))
            self.stored[self.count : reached] = self.y
            self.t = end
            self.count = reached
            return ""
        options: dict[str, Any] = {"rtol": self.rtol, "atol": self.problem.atol}
        if 0.0 < self.h < bound - self.t:
            options["first_step"] = self.h
        compiled = self.integrator.compiled()
        if compiled is not None and isinstance(self.problem.rates, System):
            if self.problem.relative is not None:
                options["rtol"] = np.maximum(self.rtol * self.problem.relative, _MIN_TOLERANCE)
            solver = compiled(self.problem.rates.capsule, self.t, self.y, bound, **options)
            self._restore(solver)
            message = self._advance_compiled(solver, bound)
        else:
            stepped = self.integrator.solver()
            if self.problem.jacobian is not None and _takes_jacobian(stepped):
                options["jac"] = self.problem.jacobian
            rates = _Rates(self.problem.rates)
            message = self._step_solver(stepped(rates, self.t, self.y, bound, **options), rates)
        if not message:
            self.t = end
            self._store_reached()
        return message

    # Many steps at once -----------------------------------------------------------------------------------------------

    def _restore(self, solver: Any) -> None:
        """Set the state of a compiled solver to that of the previous one, or else the signs of watched values in it."""
        state = solver.state
        signs = slice(_FIRST_SIGN, _FIRST_SIGN + self.signs.size)
        if state.shape == self.state.shape and self.state[0] == self.t:
            state = self.state
            self.signs = self.state[signs].copy()
        else:  # at a break, just before which the watched values may have changed their signs
            state[signs] = self.signs
        solver.state = state

    def _advance_compiled(self, solver: Any, end: float) -> str:
        """Advance a compiled solver to the end of an interval; return why it was not reached."""
        before = self.work
        max_steps = _FIRST_STEPS
        while True:
            start = time.perf_counter()
            reached = int(np.searchsorted(self.times, end, side="right"))
            reason = "raised"
            try:
                reason, _ = solver.advance(
                    end,
                    self.times[self.count : reached],
                    self.stored[self.count : reached],
                    max_steps=max_steps,
                )
            finally:  # a model may have raised, or an interrupt have come before its results were taken
                self._store_until(solver.t, solver.y, solver.interpolate)
                self.t = float(solver.t)
                self.y = solver.y
                self.h = float(solver.h)
                self.work = before + np.array(
                    [solver.steps, solver.rejected, solver.evaluations, solver.jacobians]
                )
                self.state = solver.state
                self.diagnostics = getattr(solver, "diagnostics", {})
                signs = self.state[_FIRST_SIGN : _FIRST_SIGN + self.signs.size]
                changes = self._find_sign_changes(signs)
                self.events += [Event(self.t, k, rising) for k, rising in changes]
                stopped = any(rising and k in self.stop for k, rising in changes)
                if stopped:
                    self.stop_state = self.t, self.y
            if stopped:
                return f"stopped at t = {self.t:.6g} s"
            if reason == "failed":
                return str(solver.message)
            if reason in ("stop", "finished"):
                return ""
            self._save_if_due()
            if reason == "steps":  # an event may come after any number of them
                is_quick = time.perf_counter() - start < _MAX_CALL_TIME
                max_steps = 2 * max_steps if is_quick else max(max_steps // 2, _FIRST_STEPS)

    # Step by step -----------------------------------------------------------------------------------------------------

    def _step_solver(self, solver: Any, rates: "_Rates") -> str:
        """Step a solver of SciPy to its end; return why it was not reached."""
        before = self.work
        stalled = 0
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
            reference = max(abs(self.t), solver.t_bound - solver.t)
            stalled = stalled + 1 if solver.t - self.t <= _MIN_PROGRESS * reference else 0
            if stalled > _MAX_STALLED_STEPS:
                return f"the solver stands still at t = {self.t:.6g} s: its steps are lost in the rounding of time"
            if not np.all(np.isfinite(solver.y)):
                return f"the solution is not finite after t = {self.t:.6g} s"
            if self._finish_step(solver):
                return f"stopped at t = {self.t:.6g} s"
            self._save_if_due()
        return ""

    def _finish_step(self, solver: Any) -> bool:
        """Store the last step of a solver up to the first event that ends the run; return whether there is one."""
        watch = self.problem.watch
        dense = solver.dense_output()
        changes = [] if watch is None else self._find_sign_changes(watch(solver.t, solver.y))
        events = [Event(self._locate(dense, solver, k, rising), k, rising) for k, rising in changes]
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
            self.stop_state = t, y
        return final is not None

    def _locate(self, dense: Any, solver: Any, k: int, rising: bool) -> float:
        """Time at which a watched value changed its sign in the last step of a solver."""
        from scipy.optimize import brentq

        watch = self.problem.watch
        start = self.t
        end = float(solver.t)
        assert watch is not None

        def signed_value(t: float) -> float:
            return float(watch(t, dense(t))[k]) * (1.0 if rising else -1.0)

        # the dense output of a multistep method deviates from the states at the ends of its step by rounding and more
        if signed_value(start) >= 0.0:
            return start
        if signed_value(end) <= 0.0:
            return end
        return float(
            brentq(
                signed_value,
                start,
                end,
                xtol=_EVENT_PRECISION * max(abs(end), _EVENT_TIME),
                rtol=1e-15,
            )
        )

    def _find_sign_changes(self, values: Floats) -> list[tuple[int, bool]]:
        """Numbers of the watched values that changed their sign, and whether they rose; zero and NaN have no sign."""
        signs = np.sign(np.nan_to_num(values))
        changes = [(int(k), bool(signs[k] > 0.0)) for k in np.flatnonzero(signs * self.signs < 0.0)]
        self.signs = np.where(signs == 0.0, self.signs, signs)
        return changes

    # Storing ----------------------------------------------------------------------------------------------------------

    def _store_reached(self) -> None:
        """Store the present state at the requested times that have been reached."""
        while self.count < self.times.size and self.times[self.count] <= self.t:
            self.stored[self.count] = self.y
            self.count += 1

    def _store_until(self, t: float, y: Floats, dense: Callable[[float], Floats]) -> None:
        """Store the states of a step that ends with y at t, where the solver did not store them."""
        end = int(np.searchsorted(self.times, t, side="right"))
        for k in range(self.count, end):
            if np.isnan(self.stored[k, 0]):
                self.stored[k] = y if self.times[k] == t else dense(self.times[k])
        self.count = max(self.count, end)

    def _save_if_due(self) -> None:
        """Save the trajectory since the previous part, if the interval has passed."""
        *_, wall, _ = self.saved
        if self.save is not None and time.perf_counter() - wall > self.save_interval:
            self.save(self.n_parts, self._trajectory_since(self.saved, "interrupted", "", None))
            self.n_parts = self.n_parts + 1
            self.saved = self._measure_progress()


def _takes_jacobian(solver: type[Any]) -> bool:
    """Whether a solver takes a Jacobian ``jac``, itself or as an option that it passes on to its base class."""
    for base in solver.__mro__:
        if (constructor := vars(base).get("__init__")) is not None:
            parameters = inspect.signature(constructor).parameters
            if "jac" in parameters:
                return True
            if not any(p.kind is inspect.Parameter.VAR_KEYWORD for p in parameters.values()):
                return False
    return False


class _Rates:
    """Rates for a solver: they record what they raise, and raise where they have no finite number for long.

    Outside their domain they are NaN, so that solvers try a shorter step.
    """

    def __init__(self, rates: Callable[[float, Floats], Floats]) -> None:
        self.rates = rates
        self.n_without_numbers = 0
        self.raised: BaseException | None = None

    def __call__(self, t: float, y: Floats) -> Floats:
        try:
            rates = np.full(np.shape(y), np.nan)
            if np.all(np.isfinite(y)):
                with suppress(RefusedError):
                    rates = self.rates(t, y)
            self.n_without_numbers = 0 if np.all(np.isfinite(rates)) else self.n_without_numbers + 1
            if self.n_without_numbers > _MAX_WITHOUT_NUMBERS:
                raise ArithmeticError("the rates are not finite there, or a little after it")
        except BaseException as error:
            self.raised = error
            raise
        return rates
