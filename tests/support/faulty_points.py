"""A traction model whose parameter says what goes wrong, installed as a package so that other processes have it.

Beside it the fastest scene that there is to sweep, the command line in a process of its own, and what every fault has
in common: points that wait while a file is there, so that nothing has to be timed, and bits that must be the same.
"""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import rollslip
from packages import install
from rollslip_campaigns.sweep.journal import journal_files, sessions

MODEL = """\
import os, signal, sys, time
from pathlib import Path
import attrs
from rollslip.errors import ConvergenceError, DomainError
from rollslip.fields import parameter
from rollslip.hookspecs import hookimpl
from rollslip.models import FINITE, POSITIVE, TractionModel

def held(path, factor):
    try:
        return bool(path) and factor > float(Path(path).read_text())
    except OSError:
        return False

@attrs.frozen(kw_only=True)
class Faulty(TractionModel):
    \"\"\"Friction that grows with slip, and what goes wrong.\"\"\"
    name = "faulty"
    equation = "mu = f V/u"
    references = ()
    reads = frozenset({"rolling_speed", "sliding_speed"})
    domain = {"rolling_speed": POSITIVE, "sliding_speed": FINITE}
    factor: float = parameter(default=0.05, unit="1", doc="friction at pure sliding")
    fault: str = parameter(default="none", doc="what goes wrong")
    seconds: float = parameter(default=0.0, unit="s", doc="how long it takes")
    hold: str = parameter(default="", doc="file with the factor above which points wait, as long as it is there")

    def evaluate(self, slices):
        fault = self.fault.partition(" ")[0]
        if fault == "kill":
            os.kill(os.getpid(), signal.SIGKILL)
        elif fault == "exit":
            sys.exit(3)
        elif fault == "abort":
            os._exit(0)
        elif fault == "domain":
            raise DomainError("no law goes there")
        elif fault == "converge":
            raise ConvergenceError("it went to and fro")
        elif fault == "error":
            raise ZeroDivisionError("one over nothing")
        elif fault == "hang":
            while True:
                time.sleep(0.01)
        elif fault == "stuck":
            time.sleep(1e6)
        begins = not slices.sliding_speed.all()  # no slip is computed once a point
        end = time.monotonic() + (self.seconds if begins else 0.0)
        while time.monotonic() < end:
            time.sleep(0.002)
        while held(self.hold, self.factor):
            time.sleep(0.01)
        slices.friction[...] = self.factor * slices.sliding_speed / slices.rolling_speed

@hookimpl
def traction_models():
    return [Faulty]
"""

SCENE = """\
title = "Nothing but what a sweep needs"
bearing = { rollers = 12, roller_diameter = "10 mm", roller_length = "10 mm", inner_raceway_diameter = "60 mm", \
outer_raceway_diameter = "80 mm" }
lubricant = "sae-30"
operation = { inner_speed = "3000 rpm", radial_load = "1 kN", temperature = "60 degC" }
[models.traction]
model = "faulty"
[study.friction-curve]
points = 5
"""


def prepare(folder: Path) -> Path:
    """Install the model beside a scene; return the scene."""
    install(folder / "site", "rollslip-faulty", MODEL, name="faulty", module="faulty_law")
    (folder / "scene.toml").write_text(SCENE)
    return folder / "scene.toml"


def environment(folder: Path, **more: str) -> dict[str, str]:
    """Return the environment in which the model is found."""
    path = os.pathsep.join(filter(None, [str(folder / "site"), os.environ.get("PYTHONPATH")]))
    return {**os.environ, "PYTHONPATH": path, "PYTHONDONTWRITEBYTECODE": "1", **more}


def started(folder: Path, *arguments: object, **options) -> subprocess.Popen:
    """Start ``rollslip sweep`` in a process group of its own."""
    return subprocess.Popen(
        [
            sys.executable,
            "-c",
            "from rollslip.cli import main; main()",
            "sweep",
            *map(str, arguments),
        ],
        cwd=folder,
        env=environment(folder),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        **options,
    )


def sweep(
    folder: Path, *arguments: object, code: int = 0, **options
) -> subprocess.CompletedProcess:
    """Run ``rollslip sweep`` to its end."""
    process = started(folder, *arguments, **options)
    out, err = process.communicate(timeout=120)
    assert process.returncode == code, f"{process.returncode}\n{out}\n{err}"
    assert "Traceback" not in err, err
    return subprocess.CompletedProcess(arguments, code, out, err)


# What every fault has in common ---------------------------------------------------------------------------------------

#: Of points of a sweep: the first one is done and others are left when a fault comes.
COUNT = 12
#: Points of a sweep; each has one factor of its own.
FACTORS = ["--over", f"models.traction.factor=0.01:{COUNT / 100}:{COUNT}", "--output", "friction"]


def hold(folder: Path) -> list[str]:
    """Let all points but the first one wait; return what the sweep is told for that."""
    (folder / "hold").write_text("0.01")
    return ["--set", f"models.traction.hold={folder / 'hold'}"]


def let_go(folder: Path) -> None:
    """Let the points that wait go on."""
    (folder / "hold").unlink()


def until(holds, seconds: float = 90.0) -> None:
    """Wait until something holds; for so long at most."""
    end = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < end, "it did not come to it"
        time.sleep(0.02)


def points(folder: Path) -> int:
    """Return the number of rows that are safe in the journals."""
    return sum(one.rows for one in sessions(folder)) if journal_files(folder) else 0


def result(folder: Path):
    """Return what a sweep has given."""
    return rollslip.open_result(folder / "sweep.nc")


def same(one, other) -> None:
    """Check that two sweeps have given the same bits, and all of them."""
    assert (one["status"] == "ok").all()
    assert np.isfinite(one["friction"]).all()
    assert np.array_equal(one["friction"], other["friction"])
    assert one.sizes == other.sizes


def processes_of(leader: subprocess.Popen, *, computing: bool = False) -> list[int]:
    """Return the other processes of a group; the tracker of resources, for one, computes nothing."""
    found = []
    for entry in filter(str.isdecimal, os.listdir("/proc")):
        try:
            state, _, group = Path(f"/proc/{entry}/stat").read_text().rpartition(")")[2].split()[:3]
            if int(group) != leader.pid or int(entry) == leader.pid or state == "Z":
                continue
            if not computing or b"spawn_main" in Path(f"/proc/{entry}/cmdline").read_bytes():
                found.append(int(entry))
        except (OSError, ValueError, IndexError):
            continue
    return found


def held_run(folder: Path, *engine: object) -> subprocess.Popen:
    """Start a sweep, and return when some of its points are done and the others wait."""
    process = started(
        folder, "run", "scene.toml", *FACTORS, *hold(folder), *engine, "--no-plots", "--out", "s"
    )
    until(lambda: points(folder / "s") >= 1 or process.poll() is not None)
    return process


def pressed(process: subprocess.Popen) -> None:
    """Press Ctrl-C: every process of the group is told."""
    os.killpg(process.pid, signal.SIGINT)


def gone_on_with(folder: Path, reference, *engine: object) -> None:
    """Go on with a sweep that was cut off, and check that it computes what is left and gives the same bits."""
    (folder / "hold").unlink(missing_ok=True)
    before = points(folder / "s")
    assert 1 <= before < COUNT
    sweep(folder, "resume", "s", "--no-plots", *engine)
    assert points(folder / "s") == COUNT
    assert len(sessions(folder / "s")) == 2
    same(result(folder / "s"), reference)


def kill_the_run(folder: Path, reference, *engine: object) -> None:
    """kill -9 of the run."""
    process = held_run(folder, *engine)
    process.kill()
    process.communicate()
    until(lambda: not processes_of(process), 15.0)  # workers end with it
    gone_on_with(folder, reference, *engine)


def interrupt_once(folder: Path, reference, *engine: object, press=pressed) -> None:
    """Ctrl-C: what is being computed is finished."""
    process = held_run(folder, *engine)
    before = points(folder / "s")
    press(process)
    time.sleep(0.5)
    assert process.poll() is None
    let_go(folder)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130, err
    assert "go on with: rollslip sweep resume s" in err
    assert "Traceback" not in err
    assert sessions(folder / "s")[0].about["ended"] == "interrupted"
    assert points(folder / "s") > before
    until(lambda: not processes_of(process), 15.0)
    gone_on_with(folder, reference, *engine)


def interrupt_twice(folder: Path, reference, *engine: object) -> None:
    """Ctrl-C twice: what is being computed is given up."""
    process = held_run(folder, *engine)
    pressed(process)
    time.sleep(0.5)
    assert process.poll() is None
    pressed(process)
    _, err = process.communicate(timeout=20)
    assert process.returncode == 130, err
    assert (
        "interrupted at once; what was done is stored; go on with: rollslip sweep resume s" in err
    )
    assert "Traceback" not in err
    until(lambda: not processes_of(process), 15.0)
    gone_on_with(folder, reference, *engine)
