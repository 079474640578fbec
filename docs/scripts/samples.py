"""Write samples.csv of docs/trust/time_of_a_run.rst: what samples take, in this version and in an earlier one.

``python docs/scripts/samples.py BEFORE`` takes the folder of a clone of the earlier version, built in place. Each job
is done in fresh processes of both versions in turn, the command once and all others twice; the least time of the
processor counts, user and system, of the process and all that it starts. Some five minutes of it.
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from output import write_table
from versions import measured

HERE = Path(__file__).parents[2]
SCENE = "1032930-70C"
OIL = {
    "lubricant.viscosity_factor": "0.9:1.1",
    "lubricant.pressure_viscosity_factor": "0.75:1.25",
    "lubricant.eyring_stress": "1 MPa:10 MPa:log",
}
#: Job -> what it is, study, outputs, changes of the scene and points; or a command.
POINTS = {
    "critical": (
        "critical slip, epicyclic rollers", "effective-friction", ["critical_cage_slip"], {}, 1024
    ),
    "free": (
        "critical slip, free rollers",
        "effective-friction",
        ["critical_cage_slip"],
        {"study.effective-friction.closure": "free-roller"},
        256,
    ),
    "skidding": (
        "where skidding begins and critical slip", "effective-friction", ["skidding_slip",
        "critical_cage_slip"], {}, 512
    ),
    "steady": ("steady slip", "steady-slip", ["steady_slip"], {}, 256),
    "contact": ("friction curves of two forces, their critical slips", "friction-curve", ["critical_slip"], {}, 1024),
}  # fmt: skip
COMMAND = ("uncertainty", SCENE, "--samples", "1024")
_ROUNDS = 2


def job(name):
    """Return the processor's time [s] of one job, in this process and all that it starts."""
    from rollslip import evolve, load_scene
    from rollslip_campaigns.sweep.point import compute
    from rollslip_campaigns.sweep.sweep import plan_sweep

    begin = os.times()
    if name == "command":
        with tempfile.TemporaryDirectory() as folder:
            command = [
                sys.executable,
                "-c",
                "from rollslip.cli import main; main()",
                *COMMAND,
                "--out",
                f"{folder}/u",
            ]
            subprocess.run(command, check=True, capture_output=True)
        points = 1
    else:
        _, study, outputs, changes, points = POINTS[name]
        sweep = plan_sweep(
            evolve(load_scene(SCENE), changes, si=True),
            OIL,
            samples=points,
            study=study,
            output=outputs,
        )
        work = sweep.work
        compute(work, [(0, sweep.design.changes(0))])  # what is imported once
        begin = os.times()
        rows = compute(
            work, [(number, sweep.design.changes(number)) for number in range(points)]
        ).rows
        assert {row.status for row in rows} == {"ok"}
    return (sum(os.times()[:4]) - sum(begin[:4])) / points


def main(before):
    """Measure both versions and write the table."""
    rows = []
    for name in (*POINTS, "command"):
        rounds = 1 if name == "command" else _ROUNDS
        times = [
            (measured(__file__, before, name), measured(__file__, HERE, name))
            for _ in range(rounds)
        ]
        old, new = (min(column) for column in zip(*times, strict=True))
        if name == "command":
            said = f"rollslip {' '.join(COMMAND)}", f"{old:.1f} s", f"{new:.1f} s"
        else:
            said = f"sample: {POINTS[name][0]}", f"{1e3 * old:.2f} ms", f"{1e3 * new:.2f} ms"
        rows.append((*said, f"{old / new:.1f}"))
        print(*rows[-1], flush=True)
    write_table("samples", ("what", "before", "now", "times as fast"), rows)


if __name__ == "__main__":
    if sys.argv[1] == "--job":
        print(json.dumps(job(sys.argv[2])))
    else:
        main(Path(sys.argv[1]).resolve())
