"""Write waiting.csv of docs/trust/time_of_a_run.rst: what users wait for, in this version and in an earlier one.

``python docs/scripts/waiting.py BEFORE`` takes the folder of a clone of the earlier version, built in place. Each job
is done in fresh processes of both versions in turn, twice; the least time of the processor counts, user and system.
"""

import json
import sys
from pathlib import Path

from output import write_table
from versions import measured

HERE = Path(__file__).parents[2]
#: Job -> how it is told.
JOBS = {
    "curve": "curve of 101 cage slips, free rollers, 70 degC",
    "free-roller": "study effective-friction, free rollers, 70 degC",
    "epicyclic": "the same with epicyclic rollers",
    "critical": "sample of slip at which skidding begins and critical slip, 70 degC",
    "steady": "sample of steady slip, 70 degC",
    "motion": "plan and run of study dynamics, 50 degC",
}
_SAMPLES = 32
_ROUNDS = 2


def job(name):
    """Return the processor's time [s] of one job, in this process."""
    import time

    import attrs

    from rollslip import evolve, load_scene
    from rollslip.bearing.assembly import assemble
    from rollslip.bearing.critical import slip_grid
    from rollslip.planning.execution import execute
    from rollslip.planning.plan import plan
    from rollslip_campaigns.sweep.point import compute
    from rollslip_campaigns.sweep.sweep import plan_sweep
    from rollslip_campaigns.uncertainty import UncertaintySettings
    from rollslip_studies.effective_friction.study import EffectiveFriction

    def took(function, *given):
        begin = time.process_time()
        function(*given)
        return time.process_time() - begin

    if name in ("curve", "free-roller", "epicyclic"):
        changes = {
            "closure": "free-roller" if name == "curve" else name,
            "skidding_range": 0.0,
            "map_points": 0,
        }
        scene = evolve(
            load_scene("1032930-70C"),
            {f"study.effective-friction.{key}": value for key, value in changes.items()},
            si=True,
        )
        assembly = assemble(scene)
        study = EffectiveFriction.from_scene(scene)
        slip = slip_grid(0.4, 101)
        if name != "curve":
            study.run(assembly)  # what is imported and made once
            return min(took(study.run, attrs.evolve(assembly, load_cache={})) for _ in range(3))
        return min(took(lambda: study.loaded(assembly, 4).curve(slip)) for _ in range(3))
    if name in ("critical", "steady"):
        own = UncertaintySettings("1032930-70C", samples=1024).plan().critical
        steady = {
            "samples": 1024,
            "sampling": "replicated-sobol",
            "study": "steady-slip",
            "output": ["steady_slip"],
        }
        sweep = own if name == "critical" else plan_sweep(own.given, **steady)
        points = [(number, sweep.design.changes(number)) for number in range(_SAMPLES)]
        compute(sweep.work, points[:1])
        return took(compute, sweep.work, points) / _SAMPLES
    scene = load_scene("1032930-50C")
    plan(scene, study="effective-friction")  # what is imported once
    return took(lambda: execute(plan(scene, study="dynamics"), "dynamics"))


if __name__ == "__main__":
    if sys.argv[1] == "--job":
        print(json.dumps(job(sys.argv[2])))
    else:
        earlier = Path(sys.argv[1]).resolve()
        rows = []
        for name, what in JOBS.items():
            times = [
                [measured(__file__, root, name) for root in (earlier, HERE)] for _ in range(_ROUNDS)
            ]
            before, after = (min(column) for column in zip(*times, strict=True))
            rows.append(
                (
                    what,
                    *(f"{float(f'{1e3 * one:.3g}'):g}" for one in (before, after)),
                    f"{before / after:.1f}",
                )
            )
            print(*rows[-1], sep=", ", flush=True)
        write_table("waiting", ("what", "before [ms]", "now [ms]", "times as fast"), rows)
