"""An interrupt at any moment of any command ends it with 130 and one sentence, and changes nothing else."""

import random
import shutil
import signal
import subprocess
import sys
import time
from contextlib import ExitStack
from importlib import import_module
from pathlib import Path

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
    "processes": ["sweep", "run", "1032930-70C", "--over", "operation.radial_load=500N:5000N:400", "--out", "o",
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
    except (
        subprocess.TimeoutExpired
    ):  # points of a sweep that run are finished, unless it is interrupted again
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


def test_a_compiled_function_that_cannot_raise_shows_no_interrupt(capsys):
    """What Cython does in one (SciPy's tables of Sobol' numbers have such): PyErr_PrintEx, which calls this hook."""
    with ExitStack() as stack:
        stack.callback(signal.signal, signal.SIGINT, signal.getsignal(signal.SIGINT))
        import_module("rollslip.cli.main")._handle_interrupts(stack)
        for error in (KeyboardInterrupt(), ValueError("of something else")):
            sys.excepthook(type(error), error, None)
    assert capsys.readouterr().err == "ValueError: of something else\n"


# Commands that take results or folders of others, and short ones ------------------------------------------------------

EXAMPLES = Path(__file__).parents[2] / "docs" / "examples"
SWEEP = [
    "sweep",
    "run",
    "1032930-70C",
    "--set",
    "accuracy.slices=7",
    "--over",
    "operation.radial_load=500N:5000N:40",
]
#: Command -> arguments, the longest time until it is interrupted [s], and what it may leave beside what was there.
OTHERS = {
    "fit": (
        [
            "fit",
            "twin-disc.csv",
            "--traction",
            "muraki",
            "--parameters",
            "eyring_stress",
            "--out",
            "o",
        ],
        2.0,
        "o",
    ),
    "report": (["report", "r/friction-curve.nc", "--out", "o"], 1.5, "o"),
    "resume": (["sweep", "resume", "part"], 1.0, ""),
    "retry": (["sweep", "retry", "part", "--failed"], 1.0, ""),
    "status": (["sweep", "status", "part"], 0.5, ""),
    "cite": (["cite", "1032930-70C"], 0.8, ""),
    "info": (["info", "1032930-70C"], 0.8, ""),
    "info of a result": (["info", "r/friction-curve.nc"], 0.8, ""),
    "models": (["models"], 0.5, ""),
    "schema": (["schema"], 0.5, ""),
    "doctor": (["doctor"], 2.0, ""),
    "list": (["plugins", "list"], 0.5, ""),
    "check": (["plugins", "check", "muraki"], 3.0, ""),
    "new": (["plugins", "new", "mine", "--kind", "traction"], 0.4, "mine"),
}


@pytest.fixture(scope="module")
def there(tmp_path_factory):
    """A stored result, a sweep with points to do, and data of a rig."""
    folder = tmp_path_factory.mktemp("there")
    for name in ("twin-disc.csv", "rig.toml"):
        shutil.copy(EXAMPLES / name, folder)
    shared = {"cwd": folder, "capture_output": True, "text": True, "check": True}
    call = [sys.executable, "-c", PROGRAM]
    subprocess.run(
        [*call, "run", "1032930-70C", "--study", "friction-curve", "--no-plots", "--out", "r"],
        **shared,
    )
    with subprocess.Popen(
        [*call, *SWEEP, "--out", "part", "--engine", "serial"], cwd=folder
    ) as process:
        while not list((folder / "part").glob("*.sqlite*")) and process.poll() is None:
            time.sleep(0.01)
        process.kill()
    assert (folder / "part" / "sweep.json").is_file()
    subprocess.run(
        [*call, "sweep", "status", "part"], **shared
    )  # whoever reads first rolls back what the kill left
    return folder


def contents(folder):
    """File -> content, without SQLite's rollback journals: it keeps one that a kill left before its first sync, and
    takes it away when it writes next."""
    files = (
        path for path in folder.rglob("*") if path.is_file() and not path.name.endswith("-journal")
    )
    return {path.relative_to(folder): path.read_bytes() for path in files}


@pytest.mark.parametrize("moment", range(3))
@pytest.mark.parametrize("name", OTHERS)
def test_an_interrupt_at_any_moment_of_another_command_is_heard(name, moment, there, tmp_path):
    arguments, longest, left = OTHERS[name]
    folder = tmp_path / "f"
    shutil.copytree(there, folder)
    before = contents(folder)
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *arguments],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout.readline() == "begun\n"
    time.sleep(random.Random(f"{name} {moment}").uniform(0.0, longest))
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert "Traceback" not in err + out
    assert process.returncode in (0, 130), f"{process.returncode}\n{out}\n{err}"
    now = contents(folder)
    if process.returncode == 130:
        assert "interrupted" in err + out
        left = ""
    added = {path.parts[0] for path in now.keys() - before.keys()}
    if name in ("resume", "retry"):  # the sweep, as far as it is done; a later one goes on
        assert added <= {"part"}
        assert not {
            path.name for path in now.keys() - before.keys() if path.name.endswith(".partial")
        }
    else:
        assert added <= {left}
        assert all(now[path] == content for path, content in before.items())
