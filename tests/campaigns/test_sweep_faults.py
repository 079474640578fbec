"""Sweeps to which the worst happens: processes are killed for good, disks are full, people press Ctrl-C.

Whatever it is, the sweep can be gone on with, and in the end gives the bits of one that nothing has happened to.
"""

import asyncio
import json
import os
import signal
import time
from types import SimpleNamespace

import pytest

import full_disk
from faulty_points import (
    FACTORS,
    gone_on_with,
    held_run,
    interrupt_once,
    interrupt_twice,
    kill_the_run,
    points,
    prepare,
    pressed,
    processes_of,
    result,
    same,
    started,
    sweep,
    until,
)
from rollslip_campaigns.sweep.folder import read_status
from rollslip_campaigns.sweep.journal import journal_files, point_states
from rollslip_plugins import engines

SLOW = ["--set", "models.traction.seconds=0.2 s"]
LOADS = ["run", "1032930-70C", "--over", "operation.radial_load=1 kN:2 kN:3"]
#: One engine of each fault is in the default run.
faults = pytest.mark.faults


def others(*names):
    return [pytest.param(name, marks=faults) for name in names]


@pytest.fixture
def folder(tmp_path):
    prepare(tmp_path)
    return tmp_path


def serial(folder, *arguments):
    """What a sweep gives where nothing happens."""
    sweep(
        folder,
        "run",
        "scene.toml",
        *arguments,
        "--engine",
        "serial",
        "--no-plots",
        "--out",
        "serial",
    )
    return result(folder / "serial")


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    """What the points give where nothing happens."""
    folder = tmp_path_factory.mktemp("reference")
    prepare(folder)
    return serial(folder, *FACTORS)


# The run -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("engine", ["threads", *others("serial", "processes")])
def test_a_killed_run_is_gone_on_with(engine, folder, reference):
    kill_the_run(folder, reference, "--engine", engine)


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["serial", *others("threads", "processes")])
def test_ctrl_c_finishes_what_runs_and_a_later_run_the_rest(engine, folder, reference):
    interrupt_once(folder, reference, "--engine", engine)


@faults
@pytest.mark.parametrize("engine", ["serial", "threads", "processes"])
def test_ctrl_c_twice_ends_at_once(engine, folder, reference):
    interrupt_twice(folder, reference, "--engine", engine)


@faults
@pytest.mark.parametrize("seconds", [0.0, 0.1])
def test_ctrl_c_while_processes_start_is_not_taken_for_a_fault(seconds, folder):
    """It reaches workers that do not ignore it yet."""
    process = started(
        folder, "run", "scene.toml", *FACTORS, *SLOW, "--engine", "processes", "--out", "s"
    )
    until(lambda: bool(processes_of(process, computing=True)))
    time.sleep(seconds)
    pressed(process)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130, err
    assert err.startswith("interrupted: "), err


@faults
def test_a_batch_system_that_ends_the_job_is_taken_for_ctrl_c(folder, reference):
    process = started(
        folder, "run", "scene.toml", *FACTORS, *SLOW, "--engine", "serial", "--out", "s"
    )
    until(lambda: points(folder / "s") >= 1)
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=60)
    assert process.returncode == 130
    sweep(folder, "resume", "s", "--engine", "threads")
    same(result(folder / "s"), reference)


@faults
def test_a_folder_has_one_run_at_a_time(folder, reference):
    process = held_run(folder, "--engine", "serial")
    first = f"s: is being computed by process {process.pid} on "
    for command in (["resume", "s"], ["retry", "s", "--failed"]):
        done = sweep(folder, *command, code=2)
        assert done.stderr.startswith(first)
        assert "how far it is: rollslip sweep status s" in done.stderr
    assert "serial: 1 points, runs" in sweep(folder, "status", "s").stdout
    assert json.loads(sweep(folder, "status", "s", "--json").stdout)["running"]
    process.kill()
    process.communicate()
    assert "serial: 1 points, was killed" in sweep(folder, "status", "s").stdout
    assert len(journal_files(folder / "s")) == 1
    gone_on_with(folder, reference, "--engine", "serial")


# Workers -------------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_point_that_kills_its_process_is_the_only_one_lost(folder):
    over = ["--over", "models.traction.fault=none,kill,error", "--output", "friction"]
    done = sweep(
        folder,
        "run",
        "scene.toml",
        *over,
        "--no-plots",
        "--engine",
        "processes",
        "--workers",
        2,
        "--out",
        "s",
        code=4,
    )
    assert "some points have no result; see: rollslip sweep status s" in done.stderr
    found = result(folder / "s")
    assert found["status"].values.tolist() == ["ok", "crashed", "crashed"]
    assert "its process died" in str(found["message"].values[1])
    assert "ZeroDivisionError: one over nothing; raised by evaluate()" in str(
        found["message"].values[2]
    )
    assert sorted(number for number, *_ in read_status(folder / "s").errors) == [
        1,
        2,
    ]  # in the order in which they ended


@faults
def test_a_worker_that_somebody_kills_costs_no_point(folder):
    many = ["--over", "models.traction.factor=0.01:0.3:30", "--output", "friction"]
    slow = [
        "--set",
        "models.traction.seconds=0.1 s",
        "--engine",
        "processes",
        "--workers",
        2,
        "--out",
        "s",
    ]
    process = started(folder, "run", "scene.toml", *many, *slow)
    for least in (2, 8):
        until(
            lambda least=least: (
                points(folder / "s") >= least and len(processes_of(process, computing=True)) >= 2
            )
        )
        os.kill(processes_of(process, computing=True)[0], signal.SIGKILL)
    out, err = process.communicate(timeout=120)
    assert process.returncode == 0, out + err
    same(result(folder / "s"), serial(folder, *many))


@faults
def test_points_that_take_too_long_are_timed_out_and_can_have_more_time(folder, reference):
    # without a choice as well: what waits outside of Python never stops in this process
    for engine, fault in (([], "stuck"), (["--engine", "threads"], "hang")):
        over = ["--over", f"models.traction.fault=none,{fault}", "--output", "friction", *engine]
        sweep(folder, "run", "scene.toml", *over, "--time-limit", "1 s", "--out", fault, code=4)
        found = result(folder / fault)
        assert found["status"].values.tolist() == ["ok", "timed-out"]
        assert "took longer than the time limit of 1 s" in str(found["message"].values[1])
    limited = [*FACTORS, *SLOW, "--engine", "serial", "--time-limit", "50 ms", "--out", "t"]
    sweep(folder, "run", "scene.toml", *limited, code=4)
    assert set(result(folder / "t")["status"].values) == {"timed-out"}
    sweep(folder, "retry", "t", "--failed", "--time-limit", "60 s", "--engine", "serial")
    same(result(folder / "t"), reference)


@faults
@pytest.mark.parametrize("engine", ["serial", "threads", "processes"])
def test_every_end_of_a_point_has_its_status(engine, folder):
    over = [
        "--over",
        "models.traction.fault=none,domain,converge,error,exit",
        "--output",
        "friction",
    ]
    sweep(folder, "run", "scene.toml", *over, "--engine", engine, "--out", "s", code=4)
    found = result(folder / "s")
    assert found["status"].values.tolist() == [
        "ok",
        "outside-domain",
        "not-converged",
        "crashed",
        "crashed",
    ]


@faults
@pytest.mark.parametrize("engine", ["serial", "threads"])
def test_a_run_that_died_in_its_own_process_is_gone_on_with_in_others(engine, folder):
    over = [
        "--over", "models.traction.fault=none,kill", "--over", "models.traction.factor=0.01:0.04:4",
        "--output", "friction",
    ]  # fmt: skip
    process = started(folder, "run", "scene.toml", *over, "--engine", engine, "--out", "s")
    process.communicate(timeout=60)
    assert process.returncode == -signal.SIGKILL
    done = sweep(folder, "resume", "s", "-v", code=4)
    assert "engine processes: an earlier run died in its own process" in done.stderr
    assert result(folder / "s")["status"].values.tolist() == [["ok"] * 4, ["crashed"] * 4]


# Disks ---------------------------------------------------------------------------------------------------------------


@pytest.fixture
def own_disk(tmp_path):
    """A folder for a disk, where one can be had."""
    if not full_disk.allowed(tmp_path):
        pytest.skip("no file system can be mounted here: unshare(1) is missing or not allowed")
    return tmp_path


@faults
@pytest.mark.parametrize("engine", ["serial", "threads", "processes"])
def test_a_full_disk_ends_the_run_and_loses_nothing(engine, own_disk):
    full_disk.on_a_disk(
        full_disk.the_journal_grows_until_the_disk_is_full, own_disk, "--engine", engine
    )


@faults
@pytest.mark.parametrize(
    "scenario",
    [
        full_disk.the_disk_is_full_before_the_first_write,
        full_disk.the_disk_is_full_when_a_run_goes_on,
        full_disk.the_result_does_not_fit_on_the_disk,
        full_disk.the_disk_can_only_be_read,
    ],
)
def test_nothing_half_written_is_left_where(scenario, own_disk):
    full_disk.on_a_disk(scenario, own_disk, "--engine", "serial")


@faults
def test_a_journal_that_must_not_grow_ends_the_run_and_loses_nothing(folder):
    """The kernel refuses a file more than so many bytes, as a quota would."""
    import resource

    def limited():
        resource.setrlimit(resource.RLIMIT_FSIZE, (48 * 1024, 48 * 1024))

    many = full_disk.MANY
    done = sweep(
        folder,
        "run",
        "scene.toml",
        *many,
        "--engine",
        "serial",
        "--out",
        "s",
        code=2,
        preexec_fn=limited,
    )
    assert "journal-000000.sqlite: cannot be written (" in done.stderr
    assert "what was done is stored; go on with: rollslip sweep resume s" in done.stderr
    kept = 200 - point_states(folder / "s", 200).count(0)
    assert 0 < kept < 200
    said = json.loads(sweep(folder, "resume", "s", "--engine", "serial", "--json").stdout)
    assert said["run"]["computed"] == 200 - kept
    same(result(folder / "s"), serial(folder, *many))


# What people get wrong -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (["run", "1032930-70C", "--over", "operation.radial_load=500N:5000N"], 2, "has no count"),
        ([*LOADS, "--engine", "thread"], 2, "no engine is called 'thread'; did you mean 'threads'"),
        ([*LOADS, "--engine", "serial", "--workers", "2"], 2, "of engines threads and processes"),
        ([*LOADS, "--workers", "2"], 2, "--workers needs an --engine"),
        ([*LOADS, "--engine", "threads", "--scheduler", "tcp://x"], 2, "is of engine dask"),
        ([*LOADS, "--engine", "dask"], 2, "engine.scheduler: missing, but required"),
        (["retry", "s"], 2, "--failed, or --status"),
        (["resume", "nowhere"], 2, "nowhere: holds no sweep"),
        (["status", "nowhere"], 2, "nowhere: holds no sweep"),
        ([*LOADS, "--out", "file"], 2, "file: is not a folder; name another --out"),
        ([*LOADS, "--out", "file/deeper"], 2, "file/deeper: cannot be written (Not a directory); name another --out"),
        (["run", "1032930-70C", "--over", "operation.radial_load=1,5:3:4"], 2, "'1,5:3:4' has a comma; write decimals"),
    ],
)  # fmt: skip
def test_what_does_not_go_together_is_refused(arguments, code, said, tmp_path, monkeypatch, capsys):
    from rollslip.cli import main

    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").touch()
    with pytest.raises(SystemExit) as left:
        main(["sweep", *arguments])
    assert left.value.code == code
    assert said in capsys.readouterr().err
    assert not list(tmp_path.glob("**/journal-*"))


def test_a_folder_that_must_not_be_listed_is_said(tmp_path, monkeypatch, capsys):
    """Points there would not be found, and be computed again without end."""
    from rollslip.cli import main

    def refused(path="."):
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.chdir(tmp_path)
    (tmp_path / "s").mkdir()
    monkeypatch.setattr(os, "listdir", refused)
    with pytest.raises(SystemExit) as left:
        main(["sweep", *LOADS, "--set", "accuracy.slices=5", "--out", "s"])
    assert left.value.code == 2
    assert "s: cannot be " in (said := capsys.readouterr().err)
    assert "Permission denied" in said


@pytest.mark.parametrize(
    ("fetched", "ended"),
    [
        (OSError("closed while it was read"), "closed while it was read"),
        (asyncio.CancelledError(), "the scheduler was lost"),
        (None, "7"),
    ],
)
def test_a_task_of_dask_ends_whatever_becomes_of_its_result(fetched, ended):
    """The connection breaks while a result is on its way, or the scheduler forgets the task: no future stays open."""

    class Client:
        status = "running"
        loop = SimpleNamespace(add_callback=lambda function: asyncio.run(function()))

        def submit(self, fn, *arguments, pure):
            return SimpleNamespace(
                cancelled=lambda: isinstance(fetched, asyncio.CancelledError), cancel=lambda: None
            )

        async def gather(self, task, asynchronous):
            if fetched is not None:
                raise fetched
            return 7

    future = engines._ClientExecutor(Client()).submit(len, "")
    assert future.done()
    assert str(future.exception() or future.result()) == ended
