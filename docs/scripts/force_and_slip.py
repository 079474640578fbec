"""Write force_and_slip.csv and first_impacts.csv of docs/trust/dynamics.rst: pocket forces and slip by leapfrog.

Starts differ by a cage slip below a thousandth; leapfrog at the tolerance that plans take and ``rk45`` at 1e-7 are
given the same ones. Compared are the root of the mean square of the force over all rollers, starts, and instants after
the first sixth, and the mean slip of the cage over these instants, start by start, in which the swings of the cage
cancel. 1032930-50C; level pocket over 0.3 s, planar over 0.1 s with 5 kg of inner ring. The other table is one start
over the first 8 ms, before motions part, against DOP853 of SciPy at 1e-10 of the scales that compiled integrators take.

``python docs/scripts/force_and_slip.py [PLANAR [POCKET]]``, numbers of starts, 160 and 300 by default: some seven
minutes of the processor; 0 leaves the lines of a level as they are. 2000 starts of level pocket take forty.
"""

import csv
import sys

import numpy as np
from output import DOCS, write_table
from scipy.integrate import solve_ivp

from rollslip import evolve, load_scene
from rollslip.planning.plan import plan
from rollslip_studies.dynamics.levels.planar import PlanarSettings

INSTANT = 2e-5
QUIET = 1 / 6
SPANS = {"pocket": 0.3, "planar": 0.1}
CASES = (("planar", "effective"), ("planar", "conventional"), ("pocket", "conventional"))
#: Integrator and relative tolerance; the first is what the other is held against.
WAYS = (("rk45", 1e-7), ("leapfrog", 1e-5))
NAMED = (
    "level",
    "friction",
    "starts",
    "rms force [N]",
    "rk45, 1e-7 [N]",
    "off",
    "mean slip",
    "slip off",
    "one pair",
)


def moving(level, friction):
    """Return the study, what moves, and the bearing."""
    settings = {
        "level": "pocket",
        "friction": friction,
        "integrator": "rodas5p",
        "duration": SPANS[level],
    }
    scene = evolve(
        load_scene("1032930-50C"),
        {f"study.dynamics.{name}": value for name, value in settings.items()},
        si=True,
    )
    made = plan(scene, "dynamics")
    study = made.studies["dynamics"].with_settings(
        level=level, planar=PlanarSettings(inner_ring_mass=5.0)
    )
    return study, study.moving(made.assemblies["dynamics"]), made.assemblies["dynamics"]


def runs(level, friction, starts):
    """Return mean squares of the force [N2] and mean slips, each (ways, starts)."""
    study, motion, assembly = moving(level, friction)
    forces = moving(level, "effective")[
        1
    ]  # the same of the same state, without the film of every slice
    times = np.arange(0.0, SPANS[level], INSTANT)
    squares, slips = np.empty((2, len(WAYS), starts))
    for k, slip in enumerate((1e-3 * np.random.default_rng(1).uniform(size=starts)).tolist()):
        for way, (name, tolerance) in enumerate(WAYS):
            found = study.with_settings(integrator=name, cage_slip=slip).trial_motion(
                motion, times, tolerance
            )
            assert found.outcome == "finished", found.message
            quiet = found.t > QUIET * SPANS[level]
            squares[way, k] = np.mean(
                forces.outputs(found.t[quiet], found.y[quiet])["pocket_force"] ** 2
            )
            speed = motion.split(found.y)["cage_speed"][quiet].mean()
            slips[way, k] = 1.0 - speed / assembly.kinematics.epicyclic_cage_speed
    return squares, slips


def first_impacts():
    """Hold integrators against DOP853 while motions are the same."""
    rows = []
    times = np.arange(0.0, 8e-3, INSTANT)
    start = 5e-4
    for level, friction in CASES:
        study, motion, assembly = moving(level, friction)
        forces = moving(level, "effective")[1]

        def told(y, motion=motion, forces=forces, assembly=assembly):
            slip = (
                1.0
                - motion.split(y)["cage_speed"].mean() / assembly.kinematics.epicyclic_cage_speed
            )
            return np.array([np.sqrt(np.mean(forces.outputs(times, y)["pocket_force"] ** 2)), slip])

        exact = solve_ivp(
            lambda t, y, motion=motion: motion.system(t, y), (0.0, times[-1]), motion.initial(start), method="DOP853",
            rtol=1e-10, atol=1e-10 * motion.tolerances[0], max_step=1e-5, first_step=1e-7, t_eval=times,
        )  # fmt: skip
        reference = told(exact.y.T)
        for name, tolerance in (WAYS[0], WAYS[1], ("leapfrog", 1e-7)):
            found = study.with_settings(integrator=name, cage_slip=start).trial_motion(
                motion, times, tolerance
            )
            off = told(found.y) / reference - 1.0
            rows.append(
                (level, friction, f"{name}, {tolerance:.0e}", *(f"{part:+.1e}" for part in off))
            )
            print(*rows[-1], sep=", ", flush=True)
    write_table(
        "first_impacts",
        ("level", "friction", "integrator, tolerance", "rms force", "mean slip"),
        rows,
    )


def main(counts):
    """Measure, and keep the lines of what is left out."""
    table = DOCS / "tables" / "force_and_slip.csv"
    before = list(csv.reader(table.open()))[1:] if table.exists() else []
    rows = []
    for level, friction in CASES:
        starts = counts[level]
        if not starts:
            rows += [row for row in before if row[:2] == [level, friction]]
            continue
        squares, slips = runs(level, friction, starts)
        root = np.sqrt(squares.mean(axis=1))
        fraction = squares.std(axis=1, ddof=1) / np.sqrt(starts) / (2.0 * root**2)
        apart = (slips[1] - slips[0]) / slips[0].mean()
        rows.append(
            (
                level,
                friction,
                str(starts),
                *(f"{root[way]:.4g} +- {root[way] * fraction[way]:.1g}" for way in (1, 0)),
                f"{root[1] / root[0] - 1.0:+.2%} +- {np.hypot(*fraction):.2%}",
                f"{slips[1].mean():.5f}",
                f"{apart.mean():+.3%} +- {apart.std(ddof=1) / np.sqrt(starts):.3%}",
                f"{apart.std(ddof=1):.2%}",
            )
        )
        print(*rows[-1], sep=", ", flush=True)
    write_table("force_and_slip", NAMED, rows)


if __name__ == "__main__":
    given = [int(word) for word in sys.argv[1:]]
    first_impacts()
    main(dict(zip(("planar", "pocket"), [*given, *(160, 300)[len(given) :]], strict=True)))
