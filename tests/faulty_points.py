"""A traction model whose parameter says what goes wrong, installed as a package so that other processes have it.

Beside it the fastest scene that there is to sweep, and the command line in a process of its own.
"""

import os
import subprocess
import sys
from pathlib import Path

from packages import install

MODEL = """\
import os, signal, sys, time
import attrs
from rollslip.errors import ConvergenceError, DomainError
from rollslip.fields import parameter
from rollslip.hookspecs import hookimpl
from rollslip.models import FINITE, POSITIVE, TractionModel

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
        curve = slices.sliding_speed.size > 1  # and not the search of its maximum
        end = time.monotonic() + (self.seconds if curve else 0.0)
        while time.monotonic() < end:
            time.sleep(0.002)
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
        [sys.executable, "-c", "from rollslip.cli import main; main()", "sweep", *map(str, arguments)],
        cwd=folder,
        env=environment(folder),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        **options,
    )


def sweep(folder: Path, *arguments: object, code: int = 0, **options) -> subprocess.CompletedProcess:
    """Run ``rollslip sweep`` to its end."""
    process = started(folder, *arguments, **options)
    out, err = process.communicate(timeout=120)
    assert process.returncode == code, f"{process.returncode}\n{out}\n{err}"
    assert "Traceback" not in err, err
    return subprocess.CompletedProcess(arguments, code, out, err)
