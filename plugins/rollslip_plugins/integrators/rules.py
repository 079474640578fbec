"""The rules of integrators: order, accuracy, direction and report of failures, on problems with known solutions."""

import inspect
import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np

from rollslip.models import IntegratorModel
from rollslip.search import Array
from rollslip.testing.rules import Inapplicable, refuse_unless, rule

#: Matrix of a rotation that decays with exp(-t/2).
_ROTATION = np.array([[-0.5, 1.0], [-1.0, -0.5]])
#: Maximum number of evaluations before a solver counts as hanging. Chosen: some seconds; solvers need some thousands.
_MAX_CALLS = 100_000
#: Error that counts as rounding [1]: solutions are of the size of one, and some hundred steps add up.
_ROUNDING = 1e-12
#: Right side of a problem, and its solution as a function of time.
_Problem = tuple[Callable[[float, Array], Array], Callable[[Any], Array]]


def _decay() -> _Problem:
    """Return a decaying rotation: it is linear, so that iterations of implicit methods are exact."""
    return lambda t, y: _ROTATION @ y, lambda t: np.exp(-t / 2) * np.array([np.cos(t), -np.sin(t)])


def _smooth() -> _Problem:
    """Return a problem with the solutions exp(sin t) and 1/(1 + t^2): time in the right side, and a nonlinear one."""
    return (
        lambda t, y: np.array([y[0] * np.cos(t), -2 * y[1] ** 2 * t]),
        lambda t: np.array([np.exp(np.sin(t)), 1 / (1 + t * t)]),
    )


def _solved(
    model: IntegratorModel, problem: _Problem, start: float, end: float, rtol: float
) -> Any:
    """Return the solution of a problem between two times; refuse a solver that fails."""
    from scipy.integrate import solve_ivp

    right, exact = problem
    solution = solve_ivp(
        right,
        (start, end),
        exact(start),
        method=model.solver(),
        rtol=rtol,
        atol=rtol,
        dense_output=True,
    )
    refuse_unless(
        solution.success,
        f"it fails from t = {start:g} to {end:g} at rtol = {rtol:g}: {solution.message}",
    )
    return solution


def _error_at_most(error: float, rtol: float, what: str) -> None:
    """Refuse an error above a thousand tolerances: these are of a step, and errors of steps add up."""
    refuse_unless(
        error <= 1e3 * rtol, f"{what}: the error is {error:.2g} at rtol = atol = {rtol:g}"
    )


@rule(IntegratorModel)
def check_is_a_solver_of_scipys_kind(model: IntegratorModel) -> None:
    """``solver()`` returns a class of `scipy.integrate.OdeSolver`, the same each time."""
    from scipy.integrate import OdeSolver

    cls = model.solver()
    refuse_unless(
        inspect.isclass(cls) and issubclass(cls, OdeSolver),
        f"solver() must return a class of OdeSolver, not {cls!r}",
    )
    refuse_unless(model.solver() is cls, "solver() returns another class each time")


@rule(IntegratorModel)
def check_converges_with_its_order(model: IntegratorModel) -> None:
    """Halving a fixed step divides the error by 2^order; ``order`` is a class attribute, None for variable order.

    Measured with SciPy 1.17 on a decaying rotation: RK23 3.00, RK45 5.07, DOP853 7.99, Radau 5.00.
    """
    if (order := getattr(model, "order", None)) is None:
        raise Inapplicable("its order is not fixed")
    right, exact = _decay()
    errors = []
    for steps in (4, 8, 16, 32, 64, 128):
        h = 4.0 / steps
        # tolerances so wide that every step is taken, at its largest size
        solver = model.solver()(
            right, 0.0, exact(0.0), 4.0, first_step=h, max_step=h, rtol=1e3, atol=1e3
        )
        for _ in range(2 * steps):
            if solver.status == "running":
                solver.step()
        refuse_unless(
            solver.status == "finished",
            f"{steps} steps of {h:g} do not reach the end: {solver.status}",
        )
        errors.append(float(np.max(np.abs(solver.y - exact(4.0)))))
    pairs = [(a, b) for a, b in pairwise(errors) if b > _ROUNDING]
    refuse_unless(pairs, f"the errors {errors} leave nothing to measure an order from")
    found = math.log2(pairs[-1][0] / pairs[-1][1])
    refuse_unless(
        abs(found - order) < 0.5,
        f"it converges with order {found:.2f}, its order is given as {order}",
    )


@rule(IntegratorModel)
def check_error_falls_with_the_tolerance(model: IntegratorModel) -> None:
    """The error at the steps is within the tolerance, forwards in time."""
    errors = []
    for rtol in (1e-4, 1e-6, 1e-8):
        solution = _solved(model, _smooth(), 0.0, 2.0, rtol)
        errors.append(float(np.max(np.abs(solution.y - _smooth()[1](solution.t)))))
        _error_at_most(errors[-1], rtol, "forwards")
    refuse_unless(
        errors[-1] <= max(errors[0] / 100, _ROUNDING),
        f"the errors {errors} do not fall with rtol = 1e-4, 1e-6, 1e-8",
    )


@rule(IntegratorModel)
def check_is_as_accurate_between_its_steps(model: IntegratorModel) -> None:
    """The error of the dense output is within the tolerance; events and figures use it."""
    t = np.linspace(0.0, 2.0, 201)
    for rtol in (1e-4, 1e-8):
        solution = _solved(model, _smooth(), 0.0, 2.0, rtol)
        _error_at_most(
            float(np.max(np.abs(solution.sol(t) - _smooth()[1](t)))), rtol, "between the steps"
        )


@rule(IntegratorModel)
def check_runs_backwards_in_time(model: IntegratorModel) -> None:
    """An end before the start is an interval like any other."""
    for rtol in (1e-4, 1e-8):
        solution = _solved(model, _smooth(), 2.0, 0.0, rtol)
        _error_at_most(float(np.max(np.abs(solution.y[:, -1] - 1.0))), rtol, "backwards")


@rule(IntegratorModel)
def check_follows_an_angle_over_many_turns(model: IntegratorModel) -> None:
    """Angles of cage and rollers grow without end: y' = (5 + 3 cos y)/4, tan(y/2) = 2 tan(t/2), over ten turns."""

    def angle(t: Any) -> Array:
        turns = np.floor(t / (2.0 * np.pi) + 0.5)
        return np.array([2.0 * np.pi * turns + 2.0 * np.arctan(2.0 * np.tan(t / 2.0))])

    end = 20.0 * np.pi + 1.0
    for rtol in (1e-4, 1e-8):
        solution = _solved(
            model, (lambda t, y: (5.0 + 3.0 * np.cos(y)) / 4.0, angle), 0.0, end, rtol
        )
        error = float(np.max(np.abs(solution.y[:, -1] - angle(end))))
        _error_at_most(error / end, rtol, "after ten turns of an angle")


@rule(IntegratorModel)
def check_adapts_its_steps(model: IntegratorModel) -> None:
    """Steps are short where the solution turns quickly, here arctan(50 (t - 5)) at t = 5, and long elsewhere."""
    problem: _Problem = (
        lambda t, y: np.array([50.0 / (1.0 + (50.0 * (t - 5.0)) ** 2)]),
        lambda t: np.array([np.arctan(50.0 * (t - 5.0))]),
    )
    solution = _solved(model, problem, 0.0, 10.0, 1e-6)
    steps = np.diff(solution.t)[1:-1]  # the first is a guess and the last is cut to the end
    refuse_unless(
        np.max(steps) >= 10 * np.min(steps),
        f"its steps are {np.min(steps):.2g} to {np.max(steps):.2g} long over a bend that needs them 10 times apart",
    )


@rule(IntegratorModel)
def check_reports_a_failure(model: IntegratorModel) -> None:
    """With y' = y^2 from 1, infinite at t = 1, the solver ends there with the status "failed" and a message."""
    calls = 0

    def right(t: float, y: Array) -> Array:
        nonlocal calls
        calls += 1
        with np.errstate(over="ignore"):
            return y * y

    solver = model.solver()(right, 0.0, np.array([1.0]), 2.0, rtol=1e-6, atol=1e-9)
    message = None
    steps = 0
    with np.errstate(all="ignore"):
        while solver.status == "running" and steps < _MAX_CALLS // 5 and calls < _MAX_CALLS:
            message = solver.step()
            steps += 1
    refuse_unless(
        solver.status != "running",
        f"after {steps} steps and {calls} calls it still stands at t = {solver.t:.6g}",
    )
    refuse_unless(
        solver.status == "failed" and message,
        f"it ends with the status {solver.status!r} and the message {message!r} at t = {solver.t:.6g}",
    )
