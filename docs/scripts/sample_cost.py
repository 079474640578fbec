"""Write sample_cost.csv of docs/start/uncertainty.rst: what a sample of the critical slip takes, and where it goes.

Each step is done for the same samples of the paper's bearing at 70 degC, as `rollslip.campaigns.sweep.point` does it;
then all of them at once. Time of the processor, least of three rounds; half a minute.
"""

import time

import attrs
import numpy as np
from output import write_table

from rollslip.bearing.assembly import assemble
from rollslip.bearing.critical import slip_grid
from rollslip.campaigns.sweep.point import _key, compute
from rollslip.campaigns.uncertainty.margin import plan_margin
from rollslip.scene.changes import evolve
from rollslip.studies.outputs import named_outputs
from rollslip.studies.raceways import evaluated_together
from rollslip.studies.study import settings, study_class

SCENE, SAMPLES = "1032930-70C", 320
OUTPUTS = ("critical_cage_slip", "critical_friction")


def least(step, inputs):
    """Least time [ms] of a step for one sample, and what it gives for each."""
    times = []
    for _ in range(3):
        begin = time.process_time()
        found = [step(*given) for given in inputs]
        times.append((time.process_time() - begin) / len(inputs))
    return 1e3 * min(times), found


if __name__ == "__main__":
    sweep = plan_margin(SCENE, samples=SAMPLES, steady=0).critical
    work, points = sweep.work, [(number, sweep.design.changes(number)) for number in range(SAMPLES)]
    work = attrs.evolve(work, outputs=named_outputs(study_class(sweep.study), OUTPUTS))
    resolution = work.resolutions.of({})
    study = settings(sweep.scene, sweep.study)[sweep.study]
    slip = slip_grid(study.max_cage_slip, study.points)
    compute(work, points)  # whatever is made once
    rows = []

    def step(name, function, inputs):
        took, found = least(function, inputs)
        rows.append([name, took])
        return found

    like = assemble(work.scene, resolution)
    scenes = step("scene changed and checked", lambda _, changes: evolve(work.scene, changes), points)
    step("key of the point", lambda scene: _key(work, scene, resolution), [(scene,) for scene in scenes])
    bearings = step(
        "oil and conditions of its bearing", lambda one: assemble(one, resolution, like=like), [(s,) for s in scenes]
    )
    raceways = step(
        "tables of slices and of few loads",
        lambda one: study.loaded(one, resolution.instants).by_few_loads(),
        [(b,) for b in bearings],
    )
    curves = step(
        "friction at 101 slips", lambda one: evaluated_together([(one, one.speeds(slip))])[0], [(r,) for r in raceways]
    )
    found = step("maximum", lambda one, curve: one.critical(slip, curve[0]), list(zip(raceways, curves, strict=True)))
    probes = [np.array([slip[-1], *(c.slip for c in both if c.slip == c.slip)]) for both in found]
    step("held against all slices", lambda one, at: one.agrees(at, 1e-5), list(zip(raceways, probes, strict=True)))
    whole = min(least(lambda: compute(work, points), [()])[0] for _ in range(3)) / SAMPLES
    rows.append(["all of it", whole])
    write_table(
        "sample_cost", ("step", "time [ms]", "share [%]"), [(n, f"{t:.2f}", f"{100 * t / whole:.0f}") for n, t in rows]
    )
