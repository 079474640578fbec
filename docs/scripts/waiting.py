"""Write waiting.csv of docs/trust/time_of_a_run.rst: what users wait for.

Commands run in fresh processes. Plan and run of a study, and samples of a sweep, run in this process, after one of
them that imports what they need. It is the time of the processor that counts, user and system, the least of two.
Two minutes of one core.
"""

import os
import subprocess
import sys
import tempfile
import time

from output import write_table

from rollslip import evolve, load_scene
from rollslip.planning.execution import execute
from rollslip.planning.plan import plan
from rollslip_campaigns.sweep.point import compute
from rollslip_campaigns.sweep.sweep import plan_sweep
from rollslip_campaigns.uncertainty import UncertaintySettings

PAPER = "1032930-70C"
COMMANDS = (
    f"run {PAPER} --no-plots",
    "run gearbox --no-plots",
    "run turbine --no-plots",
)
#: Plan and run of a study -> scene, study, closure where the study has one.
STUDIES = {
    "study effective-friction, epicyclic rollers": (PAPER, "effective-friction", "epicyclic"),
    "study effective-friction, free rollers": (PAPER, "effective-friction", "free-roller"),
    "study dynamics, 50 degC": ("1032930-50C", "dynamics", None),
    "study steady-slip, gearbox": ("gearbox", "steady-slip", None),
}
OIL = {
    "lubricant.viscosity_factor": "0.9:1.1",
    "lubricant.pressure_viscosity_factor": "0.75:1.25",
    "lubricant.eyring_stress": "1 MPa:10 MPa:log",
}
FREE = {"study.effective-friction.closure": "free-roller"}
#: Sample of the oil -> study, outputs, changes of the scene, number of samples.
SAMPLES = {
    "critical slip, epicyclic rollers": ("effective-friction", ["critical_cage_slip"], {}, 256),
    "critical slip, free rollers": ("effective-friction", ["critical_cage_slip"], FREE, 64),
    "slip at which skidding begins, and critical slip": (
        "effective-friction",
        ["skidding_slip", "critical_cage_slip"],
        {},
        64,
    ),
    "steady slip": ("steady-slip", ["steady_slip"], {}, 64),
    "friction curves of two forces, critical slips": (
        "friction-curve",
        ["critical_slip"],
        {},
        256,
    ),
}
DEFAULT_SAMPLES = 8


def command_seconds(command):
    """Processor time [s] of a command in a process of its own, and of all that it starts."""
    program = "from rollslip.cli import main; main()"
    with tempfile.TemporaryDirectory() as folder:
        begin = os.times()
        called = subprocess.run(
            [sys.executable, "-c", program, *command.split(), "--out", f"{folder}/out"],
            capture_output=True,
            check=False,
        )
        end = os.times()
    assert not called.returncode, called.stderr.decode()
    return sum(end[2:4]) - sum(begin[2:4])


def study_seconds(name, study, closure):
    """Processor time [s] of plan and run of a study."""
    changes = {f"study.{study}.closure": closure} if closure else {}
    scene = evolve(load_scene(name), changes, si=True)
    begin = time.process_time()
    execute(plan(scene, study), study)
    return time.process_time() - begin


def sample_seconds(sweep, count):
    """Processor time [s] of a sample of a sweep, mean of several."""
    points = [(number, sweep.design.changes(number)) for number in range(count)]
    begin = time.process_time()
    rows = compute(sweep.work, points).rows
    assert {row.status for row in rows} == {"ok"}
    return (time.process_time() - begin) / count


def sweeps():
    """Name, sweep and number of samples."""
    for name, (study, outputs, changes, count) in SAMPLES.items():
        scene = evolve(load_scene(PAPER), changes, si=True)
        yield name, plan_sweep(scene, OIL, samples=count, study=study, output=outputs), count
    for scene in (PAPER, "gearbox"):
        settings = UncertaintySettings(scene, samples=DEFAULT_SAMPLES, loads=0)
        yield f"all that scatters by default, {scene}", settings.plan().critical, DEFAULT_SAMPLES


def rows():
    """Yield rows of the table."""
    for command in COMMANDS:
        least = min(command_seconds(command) for _ in range(2))
        yield f"rollslip {command}", f"{least:.1f} s"
    for what, case in STUDIES.items():
        study_seconds(*case)
        least = min(study_seconds(*case) for _ in range(2))
        yield what, f"{1e3 * least:.0f} ms"
    for what, sweep, count in sweeps():
        sample_seconds(sweep, 1)
        least = min(sample_seconds(sweep, count) for _ in range(2))
        yield f"sample: {what}", f"{1e3 * least:.3g} ms"


def main():
    """Write the table."""
    found = []
    for row in rows():
        print(*row, sep=": ", flush=True)
        found.append(row)
    write_table("waiting", ("what", "time of the processor"), found)


if __name__ == "__main__":
    main()
