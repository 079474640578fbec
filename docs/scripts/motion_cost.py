"""Write motion_cost.csv and motion_estimates.csv of docs/trust/time_of_a_run.rst: what motions in time cost.

``python docs/scripts/motion_cost.py BEFORE`` takes the folder of a clone of an earlier version, built in place.
Commands are run by both in turn, in fresh processes, and so are plan and run without imports; the least time of the
processor counts, user and system. ``python docs/scripts/motion_cost.py`` holds estimates of this version against what
the run then took, at all levels and with both frictions, for bearings of different size.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from output import write_table
from versions import surroundings

from rollslip import evolve, load_scene
from rollslip.planning.execution import execute
from rollslip.planning.plan import plan

HERE = Path(__file__).parents[2]
ROUNDS = 2
#: What is typed after ``run`` -> how it is told.
COMMANDS = {
    ("1032930-50C",): "50 degC as shipped: cage-set, conventional, 4 s",
    ("1032930-50C", "friction=effective"): "the same, effective friction",
    (
        "1032930-50C",
        "level=pocket",
        "friction=effective",
        "duration=0.3 s",
    ): "pocket, effective, 0.3 s",
}
#: Level and friction -> duration [s] of the motions that are foreseen.
MOTIONS = {
    ("cage-set", "effective"): 4.0,
    ("cage-set", "conventional"): 1.0,
    ("pocket", "effective"): 0.3,
    ("pocket", "conventional"): 0.03,
    ("planar", "effective"): 0.02,
    ("planar", "conventional"): 0.01,
}
#: Bearings of our own: size, speed and load unlike those of the shipped one.
SMALL = {
    "bearing.rollers": 14, "bearing.roller_diameter": "12 mm", "bearing.roller_length": "12 mm",
    "bearing.inner_raceway_diameter": "60 mm", "bearing.outer_raceway_diameter": "84 mm",
    "bearing.radial_clearance": "20 um", "lubricant": {"name": "iso-vg-68"}, "cage.land_radius": "38 mm",
    "cage.mass": "0.1 kg", "cage.inertia": "1.3e-4 kg m2", "operation.inner_speed": "3000 rpm",
    "operation.radial_load": "3 kN",
}  # fmt: skip
LARGE = {
    "bearing.rollers": 22, "bearing.roller_diameter": "40 mm", "bearing.roller_length": "40 mm",
    "bearing.inner_raceway_diameter": "300 mm", "bearing.outer_raceway_diameter": "380 mm",
    "bearing.radial_clearance": "60 um", "lubricant": {"name": "iso-vg-150"}, "cage.land_radius": "176 mm",
    "cage.mass": "8 kg", "cage.inertia": "0.23 kg m2", "operation.inner_speed": "1000 rpm",
    "operation.radial_load": "60 kN",
}  # fmt: skip
BEARINGS = {
    "1032930-50C": ("1032930-50C", {}),
    "1032930-70C": ("1032930-70C", {}),
    "1032930-30C": ("1032930-30C", {}),
    "14 rollers of 12 mm": ("1032930-50C", SMALL),
    "22 rollers of 40 mm": ("1032930-50C", LARGE),
}


#: Plan and run in a process that has imported what any run does.
PLAN_AND_RUN = """
import sys, time
from rollslip import evolve, load_scene
from rollslip.scene.changes import parse_set
from rollslip.planning.execution import execute
from rollslip.planning.plan import plan
execute(plan(sys.argv[1], "effective-friction"), "effective-friction")
scene = evolve(load_scene(sys.argv[1]), dict(parse_set(change) for change in sys.argv[2:]))
begin = time.process_time()
execute(plan(scene, "dynamics"), "dynamics")
print(time.process_time() - begin)
"""


def seconds(root, words, folder):
    """Return the time of the processor [s] of a command in the version of a folder, and of plan and run in it."""
    settings = [f"study.dynamics.{word}" for word in words[1:]]
    typed = [words[0], "--study", "dynamics", "--no-plots", "--overwrite", "--out", folder]
    typed += [part for setting in settings for part in ("--set", setting)]
    before = os.times()
    subprocess.run(
        [sys.executable, "-c", "from rollslip.cli.main import main; main()", "run", *typed],
        **surroundings(root),
    )
    after = os.times()
    whole = (
        after.children_user + after.children_system - before.children_user - before.children_system
    )
    told = subprocess.run(
        [sys.executable, "-c", PLAN_AND_RUN, words[0], *settings], text=True, **surroundings(root)
    )
    return whole, float(told.stdout.splitlines()[-1])


def commands(earlier):
    """Return rows of what commands take in both versions."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for words, what in COMMANDS.items():
            row = [what]
            times = [
                [seconds(root, words, f"{folder}/out") for root in (earlier, HERE)]
                for _ in range(ROUNDS)
            ]
            for part in (0, 1):
                before, now = (min(pair[version][part] for pair in times) for version in (0, 1))
                row += [f"{before:.2f}", f"{now:.2f}", f"{before / now:.1f}"]
            rows.append(row)
            print(*rows[-1], sep=", ", flush=True)
    return rows


def estimates():
    """Return rows of what was foreseen, and what was spent."""
    rows = []
    for name, (scene, changes) in BEARINGS.items():
        for (level, friction), duration in MOTIONS.items():
            settings = {"level": level, "friction": friction, "duration": duration}
            settings |= {"planar.inner_ring_mass": 5.0} if level == "planar" else {}
            changed = changes | {f"study.dynamics.{key}": value for key, value in settings.items()}
            begin = time.process_time()
            made = plan(evolve(load_scene(scene), changed, si=True), "dynamics")
            planning = time.process_time() - begin
            found = execute(made, "dynamics")
            cost = json.loads(found.attrs["cost"])
            cost_sentences = cost["estimated"]
            spent = cost["actual"]
            numbers = (
                f"{planning:.2f}",
                f"{cost_sentences:.3f}",
                f"{spent:.3f}",
                f"{cost_sentences / spent:.2f}",
            )
            rows.append((name, level, friction, f"{duration:g}", *numbers))
            print(
                *rows[-1], found.attrs["outcome"], found.attrs["integrator"], sep=", ", flush=True
            )
    return rows


if __name__ == "__main__":
    if len(sys.argv) > 1:
        named = (
            "command",
            "before [s]",
            "now [s]",
            "times as fast",
            "its plan and run",
            "now",
            "times as fast there",
        )
        write_table("motion_cost", named, commands(Path(sys.argv[1]).resolve()))
    else:
        named = (
            "bearing",
            "level",
            "friction",
            "motion [s]",
            "planning [s]",
            "foreseen [s]",
            "spent [s]",
            "ratio",
        )
        write_table("motion_estimates", named, estimates())
