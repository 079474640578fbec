"""Write the table and the figure of docs/trust/dynamics.rst on the cost of a step against the number of rollers.

The bearing 1032930 grows with its rollers, which stay as they are, as do their loads and surface speeds. Every step of
Rodas5P is the same work: as many evaluations of the rates as the arrow shape of the Jacobian needs, and its solution.

Times are those of one core of a machine that others used, too; the fastest of several turns counts.
"""

import math
import time

import numpy as np
from output import BLUE, GREEN, ORANGE, PURPLE, figure, save_figure, write_table

from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.bearing.load_map import build_load_map
from rollslip.motion.carried import carried_motion
from rollslip.motion.raceway_friction import FrictionSettings
from rollslip_kernels.motion.rosenbrock import Rosenbrock

SCENE = evolve(load_scene("1032930-50C"), {"accuracy.slices": 15})
ROLLERS = (10, 20, 50, 100, 200, 500, 1000)
CASES = {
    ("cage-set", "effective"): BLUE,
    ("cage-set", "conventional"): ORANGE,
    ("pocket", "effective"): GREEN,
    ("pocket", "conventional"): PURPLE,
}
STEPS, TURNS = 20, 5


def bearing(rollers):
    """The bearing with another number of rollers of the same size, as fast at their surfaces."""
    b, grown = SCENE.bearing, rollers / SCENE.bearing.rollers
    orbit = (b.inner_raceway_diameter + b.outer_raceway_diameter) / 2 * grown
    diameters = {"inner": orbit - b.roller_diameter, "outer": orbit + b.roller_diameter}
    speed = SCENE.operation.inner_speed * b.inner_raceway_diameter / diameters["inner"]
    changes = {f"bearing.{ring}_raceway_diameter": diameter for ring, diameter in diameters.items()}
    changes |= {"bearing.rollers": rollers, "operation.inner_speed": speed}
    drag = {"model": "constant-torque", "size": 0.4 * grown}
    changes["cage"] = {"mass": 0.4 * grown, "inertia": 3.3e-3 * grown**3, "drag": [drag]}
    return assemble(evolve(SCENE, changes))


def main():
    """Measure."""
    loads = build_load_map(assemble(SCENE), SCENE.accuracy.tolerance)
    rows, (made, axis) = [], figure(1, width=4.6)
    for (level, friction), colour in CASES.items():
        times = []
        for rollers in ROLLERS:
            moving = carried_motion(bearing(rollers), FrictionSettings(name=friction), level=level, loads=loads)
            system, best = moving.system, math.inf
            start = moving.initial(cage_slip=0.02)
            for _ in range(TURNS):
                solver = Rosenbrock(system.capsule, 0.0, start, 1.0, 1e-5, 1e-5 * system.scale, 1e-5, 1e-5)
                solver.advance(max_steps=STEPS)
                evaluations, steps = solver.evaluations, solver.steps + solver.rejected
                begin = time.perf_counter()
                solver.advance(max_steps=STEPS)
                taken = solver.steps + solver.rejected - steps
                best = min(best, (time.perf_counter() - begin) / taken)
            times.append(best)
            each = (solver.evaluations - evaluations) / taken
            us = 1e6 * best
            rows.append((level, friction, rollers, system.n, f"{each:.3g}", f"{us:.3g}", f"{us / rollers:.3g}"))
        slope = np.polyfit(np.log(ROLLERS[2:]), np.log(times[2:]), 1)[0]
        print(level, friction, "power", slope)
        axis.loglog(ROLLERS, 1e6 * np.array(times), "o-", color=colour, markersize=3, label=f"{level}, {friction}")
    header = "level,friction,rollers,unknowns,evaluations_a_step,microseconds_a_step,microseconds_a_step_and_roller"
    write_table("rollers_cost", header.split(","), rows)
    axis.set(xlabel="rollers", ylabel="time of a step [µs]")
    made.legend(loc="outside right upper")
    save_figure(made, "rollers_cost")


if __name__ == "__main__":
    main()
