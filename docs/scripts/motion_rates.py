"""Write motion_rates.csv of docs/trust/time_of_a_run.rst: how fast motions are gone through, before and after.

``python docs/scripts/motion_rates.py BEFORE`` takes the folder of a clone of an earlier version, built in place. Scene
1032930-50C as planned, inner ring of 5 kg, from a start without slip. Both versions go through every motion in turn,
the loads there known, this one with its baseline of instructions, too; the least time of the processor counts, that of
the integration alone. It takes some five minutes.
"""

import contextlib
import json
import os
import sys
import time
from pathlib import Path

import numpy as np
from output import write_table
from versions import measured

from rollslip import evolve, load_scene
from rollslip.planning.plan import plan

HERE = Path(__file__).parents[2]
ROUNDS = 1
#: What the plan of either version chooses.
PLANNED = "as planned"
#: Level, friction, integrator and its tolerance -> time gone through [s].
MOTIONS = {
    ("cage-set", "conventional", PLANNED, 1e-5): 1.0,
    ("pocket", "effective", PLANNED, 1e-5): 0.2,
    ("pocket", "conventional", PLANNED, 1e-5): 0.2,
    ("planar", "effective", PLANNED, 1e-5): 0.02,
    ("planar", "conventional", PLANNED, 1e-5): 0.02,
}
#: Repetitions, and the time of the processor [s] after which there are enough of them.
MOST = 20
ENOUGH = 1.0


def job(number):
    """Return the least time [s] of a motion, and its evaluations of the rates."""
    (level, friction, integrator, tolerance), span = list(MOTIONS.items())[number]
    settings = {"level": level, "friction": friction, "duration": span}
    if integrator != PLANNED:
        settings["integrator"] = integrator
    if level == "planar":
        settings["planar.inner_ring_mass"] = "5 kg"
    scene = evolve(
        load_scene("1032930-50C"),
        {f"study.dynamics.{name}": value for name, value in settings.items()},
        si=True,
    )
    made = plan(scene, "dynamics")
    study = made.studies["dynamics"]
    moving = made.studies["dynamics"].moving(made.assemblies["dynamics"])
    seconds = []
    found = None
    while len(seconds) < MOST and sum(seconds) < ENOUGH:
        found = study.trial_motion(
            moving, np.array([0.0, span]), tolerance
        )  # the first finds the loads
        begin = time.process_time()
        found = study.trial_motion(moving, np.array([0.0, span]), tolerance)
        seconds.append(time.process_time() - begin)
    assert found.outcome == "finished", found.message
    took = {"seconds": min(seconds), "evaluations": found.evaluations}
    return took | {"integrator": study.method(made.assemblies["dynamics"]).name}


@contextlib.contextmanager
def forced(simd):
    """Have processes that are started take an instruction set; None leaves it to them."""
    if simd is not None:
        os.environ["ROLLSLIP_SIMD"] = simd
    try:
        yield
    finally:
        os.environ.pop("ROLLSLIP_SIMD", None)


def main(before):
    """Measure both."""
    rows = []
    for number, ((level, friction, integrator, tolerance), span) in enumerate(MOTIONS.items()):
        both = [{"seconds": np.inf}, {"seconds": np.inf}, {"seconds": np.inf}]
        for _ in range(ROUNDS):
            for k, (root, simd) in enumerate(((before, None), (HERE, None), (HERE, "baseline"))):
                with forced(simd):
                    both[k] = min(
                        both[k],
                        measured(__file__, root, str(number)),
                        key=lambda one: one["seconds"],
                    )
        names = list(dict.fromkeys(one["integrator"] for one in both))
        integrator = (
            integrator if integrator in names else f"{integrator}: {' and now '.join(names)}"
        )
        speeds = [f"{span / one['seconds']:.2g}" for one in both]
        each = [f"{1e6 * one['seconds'] / one['evaluations']:.3g}" for one in both[:2]]
        rows.append((level, friction, f"{integrator}, {tolerance:.0e}", *speeds, *each))
        print(*rows[-1], sep=", ", flush=True)
    named = (
        "level", "friction", "integrator, tolerance", "before", "now", "SSE2", "evaluation before [us]", "now [us]",
    )  # fmt: skip
    write_table("motion_rates", named, rows)


if __name__ == "__main__":
    if sys.argv[1] == "--job":
        print(json.dumps(job(int(sys.argv[2]))))
    else:
        main(Path(sys.argv[1]).resolve())
