"""An interrupt at any moment of any command ends it with 130 and one sentence, and changes nothing else."""

import random
import signal
import subprocess
import sys
import time

import pytest

pytestmark = pytest.mark.faults

PROGRAM = "from rollslip.cli import main; print('begun', flush=True); main()"
COMMANDS = {
    "run": ["run", "1032930-70C", "--report", "--out", "o"],
    "motion": ["run", "1032930-50C", "--study", "dynamics", "--out", "o"],
    "plan": ["plan", "1032930-50C", "--study", "dynamics"],
    "compare": ["compare", "1032930-70C", "--traction", "muraki", "--traction", "maxwell-eyring", "--out", "o"],
    "pareto": ["pareto", "1032930-70C", "--out", "o"],
    "uncertainty": ["uncertainty", "1032930-70C", "--samples", "512", "--out", "o"],
    "processes": ["sweep", "run", "1032930-70C", "--over", "operation.radial_load=500:5000:400", "--out", "o",
                  "--engine", "processes"],
}  # fmt: skip
KEEPING = ("motion", "pareto", "uncertainty", "processes")


@pytest.mark.parametrize("moment", range(4))
@pytest.mark.parametrize("name", COMMANDS)
def test_an_interrupt_at_any_moment_is_heard(name, moment, tmp_path):
    seconds = random.Random(f"{name} {moment}").uniform(0.0, 1.5)
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *COMMANDS[name]],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout.readline() == "begun\n"
    time.sleep(seconds)
    process.send_signal(signal.SIGINT)
    try:
        out, err = process.communicate(timeout=20)
    except subprocess.TimeoutExpired:  # points of a sweep that run are finished, unless it is interrupted again
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
    if "written to" in out or (name == "plan" and out):  # it came after the end
        return
    assert process.returncode == 130, f"{process.returncode}\n{out}\n{err}"
    assert "interrupted" in err + out
    assert "Traceback" not in err
    kept = {"o.unfinished", "o"}.intersection(path.name for path in tmp_path.iterdir())
    assert [path.name for path in tmp_path.iterdir()] == sorted(kept)
    assert bool(kept) <= (name in KEEPING)  # what it has computed, to go on with
