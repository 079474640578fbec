"""Write sample_cost.csv of docs/howto/uncertainty.rst: what a sample of the critical slip takes, and where it goes.

Each step is done for the same samples of the paper's bearing at 70 degC, as `rollslip_campaigns.sweep.point` does it,
what is evaluated together for as many at a time; then all of them at once. Time of the processor, least of three
rounds; a few seconds.
"""

import time

import attrs
import numpy as np
from output import write_table

from rollslip.bearing.assembly import assemble
from rollslip.bearing.critical import slip_grid
from rollslip.scene.changes import evolve
from rollslip.studies.outputs import named_outputs
from rollslip.studies.study import settings, study_class
from rollslip_campaigns.sweep.point import _BATCH_SIZE, _Task, compute
from rollslip_campaigns.uncertainty import UncertaintySettings
from rollslip_studies.effective_friction.raceways import (
    are_confirmed,
    evaluate_together,
    find_critical_together,
)

SCENE = "1032930-70C"
SAMPLES = 320
OUTPUTS = ("critical_cage_slip", "critical_friction")


def together(cases):
    """Samples that are evaluated together, all of them in turn."""
    return [cases[k : k + _BATCH_SIZE] for k in range(0, len(cases), _BATCH_SIZE)]


def least(step, inputs):
    """Least time [ms] of a step for one sample, and what it gives for each, or for some of them together."""
    times = []
    for _ in range(3):
        begin = time.process_time()
        found = [step(*given) for given in inputs]
        times.append((time.process_time() - begin) / SAMPLES)
    return 1e3 * min(times), found


if __name__ == "__main__":
    sweep = UncertaintySettings(SCENE, samples=SAMPLES).plan().critical
    work = sweep.work
    points = [(number, sweep.design.changes(number)) for number in range(SAMPLES)]
    work = attrs.evolve(work, outputs=named_outputs(study_class(sweep.study), OUTPUTS))
    task = _Task(work)
    resolution = work.resolutions.lookup({})
    study = settings(sweep.scene, sweep.study)[sweep.study]
    slip = slip_grid(study.max_cage_slip, study.points)
    compute(work, points)  # whatever is made once
    rows = []

    def step(name, function, inputs):
        took, found = least(function, inputs)
        rows.append([name, took])
        return found

    like = assemble(work.scene, resolution)
    scenes = step(
        "scene changed and checked", lambda _, changes: evolve(work.scene, changes, si=True), points
    )
    step(
        "key of the point",
        lambda scene: task.key(scene, resolution),
        [(scene,) for scene in scenes],
    )
    bearings = step(
        "oil and conditions of its bearing",
        lambda one: assemble(one, resolution, like=like),
        [(s,) for s in scenes],
    )

    raceways = step(
        "tables of slices and of few loads",
        lambda one: study.loaded(one, resolution.n_positions).with_reduced_loads(),
        [(b,) for b in bearings],
    )
    curves = step(
        "friction at 101 slips",
        lambda some: evaluate_together([(few, few.speeds(slip)) for few in some]),
        [(some,) for some in together(raceways)],
    )
    frictions = [friction for some in curves for friction, _ in some]
    found = step(
        "maximum",
        lambda some: find_critical_together([(few, slip, friction) for few, friction in some]),
        [(some,) for some in together([*zip(raceways, frictions, strict=True)])],
    )
    maxima = [both for some in found for both in some]
    held = [
        (few, [slip[-1:] if np.isnan(c.slip) else np.array([c.slip, slip[-1]]) for c in both])
        for few, both in zip(raceways, maxima, strict=True)
    ]
    step(
        "held against all slices",
        lambda some: are_confirmed(some, [1e-5] * len(some)),
        [(s,) for s in together(held)],
    )
    whole = min(least(lambda: compute(work, points), [()])[0] for _ in range(3))
    rows.append(["all of it", whole])
    write_table(
        "sample_cost",
        ("step", "time [ms]", "share [%]"),
        [(n, f"{t:.2f}", f"{100 * t / whole:.0f}") for n, t in rows],
    )
