"""The time limit of a run: a study is ended, and compiled code that hears no interrupt too; other results are kept."""

import subprocess
import sys
import threading

import pytest
from click.testing import CliRunner

from coarse import SET_COARSE
from rollslip.cli.main import cli
from rollslip.cli.time_limit import TimeLimit
from rollslip.errors import ConvergenceError
from rollslip.planning import execution

#: Sleeps in C without giving the lock of the interpreter away, as a kernel may that never ends.
DEAF = """
import ctypes
from rollslip.cli import time_limit
time_limit._GRACE_PERIOD = 0.2
with time_limit.TimeLimit("0.1 s").watch():
    ctypes.PyDLL(None).sleep(60)
"""


def test_python_that_never_ends_is_interrupted():
    limit = TimeLimit("0.05 s")

    def never_end():
        with limit.watch():
            while True:
                pass

    with pytest.raises(ConvergenceError, match=r"took longer than 0\.05 s; raise --time-limit"):
        never_end()
    assert limit.is_reached


@pytest.mark.skipif(sys.platform == "win32", reason="it has no sleep() in its C library")
def test_compiled_code_that_never_ends_is_ended_with_a_sentence():
    done = subprocess.run(
        [sys.executable, "-c", DEAF], capture_output=True, text=True, timeout=30, check=False
    )
    assert done.returncode == -9
    assert (
        done.stderr
        == "ended, because it did not stop: took longer than 0.1 s; raise --time-limit\n"
    )


@pytest.mark.parametrize("given", [None, "1 min"])
def test_within_the_limit_nothing_happens_and_an_interrupt_is_one(given):
    limit = TimeLimit(given)
    with pytest.raises(KeyboardInterrupt), limit.watch():
        raise KeyboardInterrupt
    assert not limit.is_reached


def test_a_study_that_takes_too_long_fails_and_the_others_are_kept(tmp_path, monkeypatch):
    execute = execution.execute

    def endless(plan, name, **given):
        if name == "steady-slip":
            (timer,) = (t for t in threading.enumerate() if isinstance(t, threading.Timer))
            timer.function()  # now, and not when the time is over
            while True:
                pass
        return execute(plan, name, **given)

    monkeypatch.setattr(execution, "execute", endless)
    folder = tmp_path / "o"
    requested = ["run", "gearbox", "--no-plots", "--out", str(folder), *SET_COARSE]
    done = CliRunner().invoke(cli, [*requested, "--time-limit", "4 min"])
    assert isinstance(done.exception, ConvergenceError)
    assert str(done.exception).endswith("is stored: took longer than 240 s; raise --time-limit")
    assert sorted(file.name for file in folder.glob("*.nc")) == ["effective-friction.nc"]


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ("60", "--time-limit: '60' has no unit, here a time is expected, such as '60 s'"),
        ("5 kg", "--time-limit: '5 kg' is a mass, here a time is expected, such as '0.2 s'"),
    ],
)
def test_a_limit_is_a_time(given, told):
    done = CliRunner().invoke(cli, ["run", "gearbox", "--time-limit", given])
    assert told == str(done.exception)
