"""Write the tables and the figure of docs/trust/dynamics.rst on the integrators.

- rodas5p_order.csv: error of Rodas5P with fixed steps that are halved, on three problems whose solutions are known and
  on the bearing;
- work_precision.csv, work_precision.svg: error against work of every integrator that is installed, at the levels
  cage-set and pocket of the scene 1032930-50C with effective friction, from a cage without slip; the error is that
  against Radau at 1e-12, and nothing is known below what Rodas5P at 1e-13 is away from it.

An error is the largest of any unknown at the end that is not only recorded, over its typical magnitude. Times are those
of one core of a machine that others used, too. Where a solver fails, its point is missing.
"""

import itertools
import math

import numpy as np
from output import BLACK, BLUE, GREEN, ORANGE, PURPLE, figure, save_figure, write_table
from scipy.special import ellipj

from rollslip import available, evolve, get_model, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.errors import PluginError
from rollslip_kernels.motion.rosenbrock import Rosenbrock
from rollslip_kernels.motion.system import python_system
from rollslip_studies.dynamics.levels.cage_and_rollers import carried_motion
from rollslip_studies.dynamics.levels.raceway_friction import FrictionSettings
from rollslip_studies.motion.time_integration import InitialValueProblem, integrate

SCENE = evolve(load_scene("1032930-50C"), {"accuracy.slices": 15})
DURATION = {"cage-set": 0.05, "pocket": 0.01}
#: SciPy's guess of a first step is too long for some of its methods at level pocket.
FIRST_STEP = 1e-7
#: Of a motion or a problem, for the order.
STEPS = (8, 16, 32, 64)
TOLERANCES = 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10
SHOWN = 1e-4, 1e-6, 1e-8
#: What is not waited for: a solver that took so long [s] is not asked for more.
PATIENCE = 6.0
STYLES = {
    "rodas5p": (BLUE, "-", "o"),
    "cvode": (ORANGE, "-", "s"),
    "bdf": (GREEN, "-", "^"),
    "radau": (PURPLE, "-", "v"),
    "lsoda": (BLACK, "-", "D"),
    "leapfrog": (BLACK, ":", "x"),
    "rk23": ("0.6", "--", "<"),
    "rk45": ("0.4", "--", ">"),
    "dop853": ("0.2", "--", "d"),
}


# Order ----------------------------------------------------------------------------------------------------------------


def kaps(eps=1.0):
    """Kaps's problem: u = exp(-2 t), v = exp(-t)."""

    def rates(t, y):
        u, v = y
        return [-(2 + 1 / eps) * u + v * v / eps, u - v - v * v]

    return rates, lambda t: np.array([math.exp(-2 * t), math.exp(-t)]), 1.0


def prothero_robinson(rate=1.0):
    """Prothero and Robinson's problem, y = cos t."""

    def rates(t, y):
        return [-rate * (y[0] - math.cos(t)) - math.sin(t)]

    return rates, lambda t: np.array([math.cos(t)]), 4.0


def pendulum(k=0.8):
    """A pendulum, y'' = -sin y, by elliptic functions; k is the sine of half its amplitude."""

    def solution(t):
        sn, cn, _, _ = ellipj(t, k * k)
        return np.array([2 * math.asin(k * sn), 2 * k * cn])

    return lambda t, y: [y[1], -math.sin(y[0])], solution, 2.0


def order():
    """Halve the steps."""
    rows = []
    problems = {"Kaps": kaps(), "Prothero-Robinson": prothero_robinson(), "pendulum": pendulum()}
    for name, (rates, solution, end) in problems.items():
        start = solution(0.0)
        last = solution(end)
        capsule = python_system(rates, start.size)
        errors = [np.abs(fixed_steps(capsule, start, end, count) - last).max() for count in STEPS]
        rows += halvings(name, errors)
    even = {"bearing.radial_clearance": "-10 um", "operation.radial_load": "0 N"}
    for name, changes, end, slip in (
        ("cage-set, even load", even, 0.02, 0.5),
        ("cage-set, as shipped", {}, 0.002, 0.05),
    ):
        moving = carried_motion(
            assemble(evolve(SCENE, changes, si=True)),
            FrictionSettings(name="conventional"),
            level="cage-set",
        )
        capsule = moving.system.capsule
        start = moving.initial(cage_slip=slip, roller_slip=slip)
        known = fixed_steps(capsule, start, end, 2048)
        errors = [
            distance(moving, fixed_steps(capsule, start, end, count), known) for count in STEPS
        ]
        rows += halvings(name, errors)
    header = "problem", *(f"error_with_{count}_steps" for count in STEPS), "order_of_the_halvings"
    write_table("rodas5p_order", header, rows)


def fixed_steps(capsule, start, end, count):
    """Return the state after equal steps."""
    h = end / count
    solver = Rosenbrock(capsule, 0.0, start, end, 1e6, 1e6, h, h)
    solver.advance(end)
    assert (solver.status, solver.steps) == ("finished", count), solver.message
    return solver.y


def halvings(name, errors):
    """A row of errors and of the order between them."""
    orders = (f"{math.log2(a / b):.1f}" for a, b in itertools.pairwise(errors))
    return [(name, *(f"{error:.1e}" for error in errors), ", ".join(orders))]


# Work and precision ---------------------------------------------------------------------------------------------------


def distance(moving, y, known):
    """Largest difference of the unknowns that are not only recorded, over their typical magnitudes."""
    system = moving.system
    moved = slice(0, system.n - system.ledger)
    return float((np.abs(y - known) / system.scale)[moved].max())


def solve(moving, name, tolerance, end):
    """Return a trajectory and the evaluations of the rates."""
    system = moving.system
    problem = InitialValueProblem(
        rates=system,
        y=moving.initial(),
        atol=tolerance * system.scale,
        jacobian=system.jacobian,
    )
    before = system.evaluations
    times = np.array([0.0, end])
    found = integrate(
        problem, get_model("integrator", name), times, rtol=tolerance, first_step=FIRST_STEP
    )
    evaluations = system.evaluations - before
    compiled = (
        get_model("integrator", name).compiled() is not None
    )  # it does not count them in the system
    return found, evaluations + found.evaluations if compiled else evaluations


def installed():
    """Integrators, ours first, whose solver can be had."""
    names = []
    for name in STYLES:
        if name not in available("integrator"):
            continue
        try:
            get_model("integrator", name).solver()
        except PluginError as error:
            print(f"{name} is left out: {error}")
            continue
        names.append(name)
    return names


def work_precision():
    """Error against work."""
    rows = []
    (made, axes) = figure(4, width=2.3, height=2.9)
    for (level, end), (left, right) in zip(DURATION.items(), (axes[:2], axes[2:]), strict=True):
        moving = carried_motion(assemble(SCENE), FrictionSettings(name="effective"), level=level)
        known = solve(moving, "radau", 1e-12, end)[0].last_y
        apart = distance(moving, solve(moving, "rodas5p", 1e-13, end)[0].last_y, known)
        for name in installed():
            if name == "leapfrog" and not moving.system.frequencies[0]:
                continue  # it is for what swings in contacts
            points = []
            for tolerance in TOLERANCES:
                found, evaluations = solve(moving, name, tolerance, end)
                if found.outcome != "finished":
                    print(f"{level}, {name}, {tolerance:.0e}: {found.outcome}, {found.message}")
                    continue
                error = max(distance(moving, found.last_y, known), apart)
                points.append((error, evaluations, 1e3 * found.wall_time))
                if tolerance in SHOWN:
                    cells = (
                        f"{tolerance:.0e}",
                        f"{error:.0e}",
                        evaluations,
                        found.steps,
                        f"{points[-1][-1]:.3g}",
                    )
                    rows.append((level, name, *cells))
                if found.wall_time > PATIENCE:
                    break
            if points:
                colour, line, marker = STYLES[name]
                style = {
                    "color": colour,
                    "linestyle": line,
                    "marker": marker,
                    "markersize": 3,
                    "linewidth": 1,
                }
                errors, evaluations, milliseconds = zip(*points, strict=True)
                left.loglog(errors, evaluations, label=name, **style)
                right.loglog(errors, milliseconds, **style)
        left.set(title=f"{level}: evaluations of the rates", xlabel="error")
        right.set(title=f"{level}: time [ms]", xlabel="error")
        left.invert_xaxis()
        right.invert_xaxis()
    drawn = {
        label: line
        for axis in axes
        for line, label in zip(*axis.get_legend_handles_labels(), strict=True)
    }
    made.legend(drawn.values(), drawn, loc="outside right upper")
    save_figure(made, "work_precision")
    header = "level,integrator,tolerance,error,evaluations_of_the_rates,steps,milliseconds"
    write_table("work_precision", header.split(","), rows)


if __name__ == "__main__":
    order()
    work_precision()
