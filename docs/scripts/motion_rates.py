"""Write motion_rates.csv of docs/trust/time_of_a_run.rst: how fast motions are gone through, before and after.

``python docs/scripts/motion_rates.py BEFORE`` takes the folder of a clone of an earlier version, built in place. Scene
1032930-50C as planned, inner ring of 5 kg, from a start without slip. Both versions go through every motion in turn,
the loads there known; the least time of the processor counts, that of the integration alone. It takes some two minutes.
"""

import json
import sys
import time
from pathlib import Path

import numpy as np
from output import write_table
from versions import measured

from rollslip import evolve, load_scene
from rollslip.planning.plan import plan

HERE = Path(__file__).parents[2]
ROUNDS = 2
#: Level, friction, integrator and its tolerance -> time gone through [s].
MOTIONS = {
    ("cage-set", "conventional", "rodas5p", 1e-5): 0.1,
    ("cage-set", "conventional", "rk45", 1e-5): 0.1,
    ("pocket", "effective", "rodas5p", 1e-5): 0.05,
    ("pocket", "effective", "rk45", 1e-7): 0.05,
    ("pocket", "conventional", "rodas5p", 1e-5): 0.01,
    ("pocket", "conventional", "rk45", 1e-7): 0.01,
    ("planar", "effective", "rodas5p", 1e-5): 0.01,
    ("planar", "effective", "rk45", 1e-5): 0.01,
    ("planar", "conventional", "rodas5p", 1e-5): 0.003,
    ("planar", "conventional", "rk45", 1e-5): 0.003,
}
#: Repetitions, and the time of the processor [s] after which there are enough of them.
MOST, ENOUGH = 20, 2.0


def job(number):
    """Return the least time [s] of a motion, and its evaluations of the rates."""
    (level, friction, integrator, tolerance), span = list(MOTIONS.items())[number]
    settings = {"level": level, "friction": friction, "integrator": integrator, "duration": span}
    if level == "planar":
        settings["planar.inner_ring_mass"] = "5 kg"
    scene = evolve(load_scene("1032930-50C"), {f"study.dynamics.{name}": value for name, value in settings.items()})
    made = plan(scene, "dynamics")
    study, moving = made.studies["dynamics"], made.studies["dynamics"].moving(made.assemblies["dynamics"])
    seconds, found = [], None
    while len(seconds) < MOST and sum(seconds) < ENOUGH:
        found = study.tried(moving, np.array([0.0, span]), tolerance)  # the first finds the loads
        begin = time.process_time()
        found = study.tried(moving, np.array([0.0, span]), tolerance)
        seconds.append(time.process_time() - begin)
    assert found.outcome == "finished", found.message
    return {"seconds": min(seconds), "evaluations": found.evaluations}


def main(before):
    """Measure both."""
    rows = []
    for number, ((level, friction, integrator, tolerance), span) in enumerate(MOTIONS.items()):
        both = [{"seconds": np.inf}, {"seconds": np.inf}]
        for _ in range(ROUNDS):
            for k, root in enumerate((before, HERE)):
                both[k] = min(both[k], measured(__file__, root, str(number)), key=lambda one: one["seconds"])
        speeds = [f"{span / one['seconds']:.2g}" for one in both]
        each = [f"{1e6 * one['seconds'] / one['evaluations']:.3g}" for one in both]
        rows.append((level, friction, f"{integrator}, {tolerance:.0e}", *speeds, *each))
        print(*rows[-1], sep=", ", flush=True)
    named = ("level", "friction", "integrator, tolerance", "before", "now", "evaluation before [us]", "now [us]")
    write_table("motion_rates", named, rows)


if __name__ == "__main__":
    if sys.argv[1] == "--job":
        print(json.dumps(job(int(sys.argv[2]))))
    else:
        main(Path(sys.argv[1]).resolve())
