"""Write the tables and the figure of docs/trust/dynamics.rst on the cost of a step against rollers and slices.

The bearing 1032930 grows with its rollers, which stay as they are, as do their loads and surface speeds. Every step of
Rodas5P is the same work: as many evaluations of the rates as the arrow shape of the Jacobian needs, and its solution.

Times are those of the processor on a machine that others used, too; the fastest of several turns counts. Two minutes.
"""

import math
import time

import numpy as np
from output import BLACK, BLUE, GREEN, ORANGE, PURPLE, figure, read_table, save_figure, write_table

from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip_kernels.motion.rosenbrock import Rosenbrock
from rollslip_studies.dynamics.levels.cage_and_rollers import carried_motion
from rollslip_studies.dynamics.levels.load_map import build_load_map
from rollslip_studies.dynamics.levels.planar import PlanarSettings, planar_motion
from rollslip_studies.dynamics.levels.raceway_friction import FrictionSettings

SCENE = evolve(load_scene("1032930-50C"), {"accuracy.slices": 15})
ROLLERS = (10, 20, 50, 100, 200, 500, 1000)
SLICES = (5, 15, 45, 135)
RED = "#CC3311"
CASES = {
    ("cage-set", "effective"): BLUE,
    ("cage-set", "conventional"): ORANGE,
    ("pocket", "effective"): GREEN,
    ("pocket", "conventional"): PURPLE,
    ("planar", "effective"): BLACK,
    ("planar", "conventional"): RED,
}
STEPS = 20
TURNS = 5
TABLES = 1e-2  # error of effective friction, which its cost does not depend on


def bearing(rollers):
    """The bearing with another number of rollers of the same size and load, as fast at their surfaces."""
    b = SCENE.bearing
    grown = rollers / SCENE.bearing.rollers
    orbit = (b.inner_raceway_diameter + b.outer_raceway_diameter) / 2 * grown
    diameters = {"inner": orbit - b.roller_diameter, "outer": orbit + b.roller_diameter}
    speed = SCENE.operation.inner_speed * b.inner_raceway_diameter / diameters["inner"]
    changes = {f"bearing.{ring}_raceway_diameter": diameter for ring, diameter in diameters.items()}
    changes |= {"bearing.rollers": rollers, "operation.inner_speed": speed}
    changes["operation.radial_load"] = SCENE.operation.radial_load * grown
    drag = {"model": "constant-torque", "size": 0.4 * grown}
    changes["cage"] = {"mass": 0.4 * grown, "inertia": 3.3e-3 * grown**3, "drag": [drag]}
    return assemble(evolve(SCENE, changes, si=True))


def moving(level, friction, assembly, loads):
    """The compiled motion of a bearing."""
    if level == "planar":
        mass = 3.0 * assembly.scene.bearing.rollers / SCENE.bearing.rollers
        named = FrictionSettings(name=friction, tolerance=TABLES)
        return planar_motion(assembly, PlanarSettings(inner_ring_mass=mass), named)
    return carried_motion(assembly, FrictionSettings(name=friction), level=level, loads=loads)


def step(motion):
    """Evaluations and time [us] of a step."""
    system = motion.system
    best = math.inf
    start = motion.initial(cage_slip=0.02)
    for _ in range(TURNS):
        solver = Rosenbrock(system.capsule, 0.0, start, 1.0, 1e-5, 1e-5 * system.scale, 1e-5, 1e-5)
        solver.advance(max_steps=STEPS)
        evaluations = solver.evaluations
        steps = solver.steps + solver.rejected
        begin = time.process_time()
        solver.advance(max_steps=STEPS)
        taken = solver.steps + solver.rejected - steps
        best = min(best, (time.process_time() - begin) / taken)
    return (solver.evaluations - evaluations) / taken, 1e6 * best


def against_rollers():
    """Levels and frictions against the number of rollers."""
    loads = build_load_map(assemble(SCENE), SCENE.accuracy.tolerance)
    rows = []
    for level, friction in CASES:
        times = []
        for rollers in ROLLERS:
            motion = moving(level, friction, bearing(rollers), loads)
            each, us = step(motion)
            times.append(us)
            rows.append(
                (
                    level,
                    friction,
                    rollers,
                    motion.system.n,
                    f"{each:.3g}",
                    f"{us:.3g}",
                    f"{us / rollers:.3g}",
                )
            )
        slope = np.polyfit(np.log(ROLLERS[2:]), np.log(times[2:]), 1)[0]
        print(level, friction, "power", slope, flush=True)
    header = "level,friction,rollers,unknowns,evaluations_a_step,microseconds_a_step,microseconds_a_step_and_roller"
    write_table("rollers_cost", header.split(","), rows)


def plot():
    """Draw rollers_cost.svg from rollers_cost.csv."""
    rows = read_table("rollers_cost")
    (made, axis) = figure(1, width=4.6)
    for (level, friction), colour in CASES.items():
        points = [row for row in rows if (row["level"], row["friction"]) == (level, friction)]
        rollers, times = (
            [float(row[key]) for row in points] for key in ("rollers", "microseconds_a_step")
        )
        axis.loglog(rollers, times, "o-", color=colour, markersize=3, label=f"{level}, {friction}")
    axis.set(xlabel="rollers", ylabel="time of a step [µs]")
    made.legend(loc="outside right upper")
    save_figure(made, "rollers_cost")


def against_slices():
    """Conventional friction against slices; effective friction has none but for the deflection of level planar."""
    rows = []
    for level, friction in CASES:
        for slices in SLICES:
            assembly = assemble(evolve(SCENE, {"accuracy.slices": slices}))
            loads = (
                None if level == "planar" else build_load_map(assembly, SCENE.accuracy.tolerance)
            )
            each, us = step(moving(level, friction, assembly, loads))
            rows.append((level, friction, slices, f"{each:.3g}", f"{us:.3g}", f"{us / slices:.3g}"))
            print(*rows[-1], flush=True)
    header = (
        "level,friction,slices,evaluations_a_step,microseconds_a_step,microseconds_a_step_and_slice"
    )
    write_table("slices_cost", header.split(","), rows)


if __name__ == "__main__":
    against_rollers()
    against_slices()
