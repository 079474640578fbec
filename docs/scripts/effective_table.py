"""Write the tables of docs/trust/dynamics.rst on the tables of effective friction.

- effective_table.csv: for the shipped scenes with 15 slices, nodes and stated errors of the curve of either raceway,
  and the error at 300 random sliding speeds against all slices, none gathered into classes;
- effective_table_cost.csv: time of a contact in one call of 2800, arguments copied and rolling resistance included,
  against SciPy and NumPy on the same nodes, whose mapping and force are NumPy's.

Times are those of one core of a machine that others used, too; all take turns, and the fastest counts.
"""

import math
import time

import numpy as np
from output import write_table
from scipy.interpolate import CubicHermiteSpline, PchipInterpolator

from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip_kernels.motion import raceway as compiled
from rollslip_studies.motion.effective_table import effective_table

SCENES = ("1032930-30C", "1032930-50C", "1032930-70C")
TOLERANCES = (1e-2, 1e-3, 1e-5)
CONTACTS = 2800
TURNS = 300


def curves():
    """Yield scene, ring, tolerance, table, loads and rolling speed."""
    for name in SCENES:
        assembly = assemble(evolve(load_scene(name), {"accuracy.slices": 15}))
        loads = assembly.load_distribution(4)
        rolling = float(assembly.kinematics.surface_speeds(0.0, 0.0).inner_rolling)
        for raceway, load in zip(
            assembly.raceways, (loads.inner_load, loads.outer_load), strict=True
        ):
            flat = load.reshape(-1, 15)
            for tolerance in TOLERANCES:
                yield (
                    name,
                    raceway,
                    tolerance,
                    effective_table(assembly, raceway, flat, tolerance),
                    flat,
                    rolling,
                )


def errors():
    """Stated and measured errors."""
    rows = []
    rng = np.random.default_rng(0)
    for name, raceway, tolerance, table, load, rolling in curves():
        loaded = load[load > 0.0]
        V = rolling * np.concatenate(
            (rng.uniform(-2.0, 2.0, 100), 10.0 ** rng.uniform(-5.0, 0.9, 200))
        )
        true = (
            np.array([raceway.evaluate(loaded, rolling, one).friction @ loaded for one in V])
            / loaded.sum()
        )
        found = compiled.friction(table.raceway(V.size), 0.0, 1.0, V, rolling, 0.0)[0]
        measured = np.abs(found - true).max() / np.abs(true).max()
        stated = table.error, measured, table.slope_error, table.critical_error
        cells = *(f"{value:.0e}" for value in stated), f"{table.critical_speed:.2f}"
        rows.append((name, raceway.ring, f"{tolerance:.0e}", table.nodes.shape[0], *cells))
    header = (
        "scene,ring,tolerance,nodes,stated_error,error_at_random_speeds,"
        "error_of_the_slope,error_of_the_critical_speed"
    )
    write_table("effective_table", [*header.split(","), "critical_sliding_speed_m_s"], rows)


def cost():
    """Time of a contact."""
    _, _, _, table, _, rolling = next(curves())
    x = np.linspace(*table.limits, table.nodes.shape[0])
    rng = np.random.default_rng(0)
    V = rng.normal(0.0, 5.0, CONTACTS)
    force = rng.uniform(10.0, 100.0, CONTACTS)
    speeds = np.full(CONTACTS, rolling)
    nothing = np.zeros(CONTACTS)

    def mapped(friction):
        def forces():
            return force * friction(np.clip(V / (np.abs(V) + table.sliding_scale), *table.limits))

        return forces

    def called(raceway):
        return lambda: compiled.friction(raceway, 0.0, force, V, speeds, nothing)

    values, slopes = table.nodes.T
    ways = {
        "compiled, this table": called(table.raceway(CONTACTS)),
        "compiled, constant friction": called(compiled.constant(CONTACTS, 0.01, 1.0)),
        "scipy CubicHermiteSpline": mapped(CubicHermiteSpline(x, values, slopes / (x[1] - x[0]))),
        "scipy PchipInterpolator": mapped(PchipInterpolator(x, values)),
        "numpy interp": mapped(lambda v: np.interp(v, x, values)),
    }
    best = dict.fromkeys(ways, math.inf)
    for _ in range(TURNS):
        for name, way in ways.items():
            begin = time.perf_counter()
            way()
            best[name] = min(best[name], time.perf_counter() - begin)
    header = "way", "nanoseconds_a_contact"
    write_table(
        "effective_table_cost",
        header,
        [(name, f"{1e9 * t / CONTACTS:.1f}") for name, t in best.items()],
    )


if __name__ == "__main__":
    errors()
    cost()
