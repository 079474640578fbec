"""Write sample_cost.csv of docs/start/uncertainty.rst: what a sample of the critical slip takes, and where it goes.

Each step is done for the same samples of the paper's bearing at 70 degC, as `rollslip.campaigns.sweep.point` does it;
then all of them at once, and 10,000 through ``rollslip uncertainty`` in a folder of its own. Least of three rounds;
about two minutes.
"""

import subprocess
import sys
import tempfile
import time

from output import write_table

from rollslip.bearing.assembly import assemble
from rollslip.bearing.critical import slip_grid
from rollslip.campaigns.sweep.point import _key, compute
from rollslip.campaigns.uncertainty.margin import plan_margin
from rollslip.scene.changes import evolve
from rollslip.studies.raceways import evaluated_together
from rollslip.studies.study import settings

SCENE, SAMPLES, MANY = "1032930-70C", 320, 10_000


def least(step, inputs):
    """Least time [ms] of a step for one sample, and what it gives for each."""
    times = []
    for _ in range(3):
        begin = time.perf_counter()
        found = [step(*given) for given in inputs]
        times.append((time.perf_counter() - begin) / len(inputs))
    return 1e3 * min(times), found


def loads(assembly):
    assembly.known_loads.clear()
    return assembly.load_distribution(assembly.resolution.instants)


if __name__ == "__main__":
    sweep = plan_margin(SCENE, samples=SAMPLES, steady=0).critical
    work, points = sweep.work, [(number, sweep.design.changes(number)) for number in range(SAMPLES)]
    resolution = work.resolutions.of({})
    study = settings(sweep.scene, sweep.study)[sweep.study]
    slip = slip_grid(study.max_cage_slip, study.points)
    compute(work, points)  # whatever is made once
    rows = []

    def step(name, function, inputs):
        took, found = least(function, inputs)
        rows.append([name, took])
        return found

    scenes = step("scene changed and checked", lambda _, changes: evolve(work.scene, changes), points)
    step("key of the point", lambda scene: _key(work, scene, resolution), [(scene,) for scene in scenes])
    bearings = step(
        "models, oil and profile put together", lambda one: assemble(one, resolution), [(s,) for s in scenes]
    )
    step("distribution of the load", loads, [(one,) for one in bearings])
    raceways = step(
        "tables of the slices", lambda one: study.loaded(one, resolution.instants), [(b,) for b in bearings]
    )
    curves = step(
        "friction at 101 slips", lambda one: evaluated_together([(one, one.speeds(slip))])[0], [(r,) for r in raceways]
    )
    step("maximum", lambda one, curve: one.critical(slip, curve[0]), list(zip(raceways, curves, strict=True)))
    whole = min(least(lambda: compute(work, points), [()])[0] for _ in range(3)) / SAMPLES
    rows.append(["all of it", whole])
    write_table(
        "sample_cost", ("step", "time [ms]", "share [%]"), [(n, f"{t:.2f}", f"{100 * t / whole:.0f}") for n, t in rows]
    )
    with tempfile.TemporaryDirectory() as folder:
        begin = time.perf_counter()
        command = [
            sys.executable,
            "-c",
            "from rollslip.cli import main; main()",
            "uncertainty",
            SCENE,
            "--samples",
            str(MANY),
            "--steady",
            "0",
        ]
        subprocess.run([*command, "--out", folder], check=True)
        print(f"{MANY} samples: {time.perf_counter() - begin:.1f} s")
