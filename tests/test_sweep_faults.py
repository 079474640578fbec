"""Sweeps to which the worst happens: processes are killed for good, disks are full, people press Ctrl-C.

Whatever it is, the sweep can be gone on with, and in the end gives the bits of one that nothing has happened to.
"""

import json
import os
import signal
import time

import numpy as np
import pytest

import rollslip
from faulty_points import prepare, started, sweep
from rollslip.journal import journals, sessions, states
from rollslip.sweep_folder import status

FACTORS = ["--over", "models.traction.factor=0.01:0.08:8", "--output", "friction"]
SLOW = ["--set", "models.traction.seconds=0.2"]
LOADS = ["run", "1032930-70C", "--over", "operation.radial_load=1 kN:2 kN:3"]


@pytest.fixture
def folder(tmp_path):
    prepare(tmp_path)
    return tmp_path


def result(folder, name="s"):
    return rollslip.open_result(folder / name / "sweep.nc")


def serial(folder, *arguments):
    """What the sweep gives where nothing happens."""
    sweep(folder, "run", "scene.toml", *arguments, "--engine", "serial", "--out", "serial")
    return result(folder, "serial")


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    """What the eight points give where nothing happens."""
    folder = tmp_path_factory.mktemp("reference")
    prepare(folder)
    return serial(folder, *FACTORS)


def same(one, other):
    assert (one["status"] == "ok").all()
    assert np.isfinite(one["friction"]).all()
    assert np.array_equal(one["friction"], other["friction"])
    assert one.sizes == other.sizes


def until(holds, seconds=60.0):
    """Wait until something holds; for so long at most."""
    end = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < end, "it did not come to it"
        time.sleep(0.02)


def points(folder, name="s"):
    """Number of rows that are safe in the journals."""
    return sum(one.rows for one in sessions(folder / name)) if journals(folder / name) else 0


def children(process):
    """Processes of the group that a sweep leads, without itself."""
    found = []
    for entry in os.listdir("/proc"):
        try:
            with open(f"/proc/{entry}/stat", encoding="utf-8") as file:
                _, _, fields = file.read().rpartition(")")
            if entry.isdecimal() and int(fields.split()[2]) == process.pid and int(entry) != process.pid:
                found.append(int(entry))
        except (OSError, ValueError, IndexError):
            continue
    return found


def workers(process):
    """The processes that compute; the tracker of resources is none."""
    found = []
    for number in children(process):
        try:
            with open(f"/proc/{number}/cmdline", "rb") as file:
                if b"spawn_main" in file.read():
                    found.append(number)
        except OSError:
            continue
    return found


def test_a_killed_run_is_gone_on_with(folder, reference):
    process = started(folder, "run", "scene.toml", *FACTORS, *SLOW, "--engine", "threads", "--workers", 2, "--out", "s")
    until(lambda: points(folder) >= 1)
    process.kill()
    process.communicate()
    assert status(folder / "s").writers[0]["ended"] == ""
    before = states(folder / "s", 8)
    assert 1 <= 8 - before.count(0) < 8
    said = json.loads(sweep(folder, "resume", "s", "--json", "--engine", "threads").stdout)
    assert said["run"]["computed"] == before.count(0)
    same(result(folder), reference)


def test_a_point_that_kills_its_process_is_the_only_one_lost(folder):
    over = ["--over", "models.traction.fault=none,kill,error", "--output", "friction"]
    done = sweep(folder, "run", "scene.toml", *over, "--engine", "processes", "--workers", 2, "--out", "s", code=4)
    assert "some points have no result; see: rollslip sweep status s" in done.stderr
    found = result(folder)
    assert found["status"].values.tolist() == ["ok", "crashed", "crashed"]
    assert "its process died" in str(found["message"].values[1])
    assert "ZeroDivisionError: one over nothing; raised by evaluate()" in str(found["message"].values[2])
    assert sorted(number for number, *_ in status(folder / "s").errors) == [1, 2]  # in the order in which they ended


def test_ctrl_c_finishes_what_runs_and_a_later_run_the_rest(folder, reference):
    process = started(folder, "run", "scene.toml", *FACTORS, *SLOW, "--engine", "serial", "--out", "s")
    until(lambda: points(folder) >= 1)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "go on with: rollslip sweep resume s" in err
    assert "Traceback" not in err
    assert sessions(folder / "s")[0].about["ended"] == "interrupted"
    assert 0 < points(folder) < 8
    sweep(folder, "resume", "s", "--engine", "serial")
    assert len(sessions(folder / "s")) == 2
    same(result(folder), reference)


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["serial", "threads", "processes"])
def test_ctrl_c_twice_ends_at_once(engine, folder):
    long = ["--set", "models.traction.seconds=1000"]
    process = started(folder, "run", "scene.toml", *FACTORS, *long, "--engine", engine, "--out", "s")
    until(lambda: bool(journals(folder / "s")) and bool(sessions(folder / "s")))
    time.sleep(5.0)  # for the processes to begin
    process.send_signal(signal.SIGINT)
    time.sleep(1.0)
    assert process.poll() is None
    began = time.monotonic()
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert time.monotonic() - began < 20.0
    assert process.returncode == 130
    assert "interrupted at once; what was done is kept; go on with: rollslip sweep resume s" in err
    assert "Traceback" not in err
    until(lambda: not children(process))


@pytest.mark.slow
def test_a_worker_that_somebody_kills_costs_no_point(folder):
    process = started(
        folder, "run", "scene.toml", "--over", "models.traction.factor=0.01:0.3:30", "--output", "friction", *SLOW,
        "--engine", "processes", "--workers", 2, "--out", "s",
    )  # fmt: skip
    for least in (2, 8):
        until(lambda least=least: points(folder) >= least and len(workers(process)) >= 2)
        os.kill(workers(process)[0], signal.SIGKILL)
    out, err = process.communicate(timeout=120)
    assert process.returncode == 0, out + err
    same(result(folder), serial(folder, "--over", "models.traction.factor=0.01:0.3:30", "--output", "friction"))


@pytest.mark.slow
def test_workers_end_with_a_killed_run(folder, reference):
    process = started(folder, "run", "scene.toml", *FACTORS, *SLOW, "--engine", "processes", "--out", "s")
    until(lambda: points(folder) >= 1)
    assert workers(process)
    process.kill()
    process.wait()
    until(lambda: not workers(process), 15.0)
    process.communicate()
    sweep(folder, "resume", "s", "--engine", "processes")
    same(result(folder), reference)


@pytest.mark.slow
def test_points_that_take_too_long_are_timed_out_and_can_have_more_time(folder, reference):
    faults = ["--over", "models.traction.fault=none,hang,stuck", "--output", "friction"]
    sweep(folder, "run", "scene.toml", *faults, "--engine", "processes", "--time-limit", "2 s", "--out", "s", code=4)
    found = result(folder)
    assert found["status"].values.tolist() == ["ok", "timed-out", "timed-out"]
    assert "took longer than the time limit of 2 s" in str(found["message"].values[1])
    sweep(
        folder,
        "run",
        "scene.toml",
        *FACTORS,
        *SLOW,
        "--engine",
        "serial",
        "--time-limit",
        "50 ms",
        "--out",
        "t",
        code=4,
    )
    assert set(result(folder, "t")["status"].values) == {"timed-out"}
    sweep(folder, "retry", "t", "--failed", "--time-limit", "60 s", "--engine", "serial")
    same(result(folder, "t"), reference)


@pytest.mark.slow
def test_every_end_of_a_point_has_its_status_on_every_engine(folder):
    over = ["--over", "models.traction.fault=none,domain,converge,error,exit", "--output", "friction"]
    wanted = ["ok", "outside-domain", "not-converged", "crashed", "crashed"]
    for engine in ("serial", "threads", "processes"):
        sweep(folder, "run", "scene.toml", *over, "--engine", engine, "--out", engine, code=4)
        assert result(folder, engine)["status"].values.tolist() == wanted


@pytest.mark.slow
def test_a_full_disk_ends_the_run_and_loses_nothing(folder):
    """The kernel refuses the journal more than so many bytes, as a full disk would."""
    import resource

    def limited():
        resource.setrlimit(resource.RLIMIT_FSIZE, (48 * 1024, 48 * 1024))

    over = ["--over", "models.traction.factor=0.01:0.3:200", "--output", "friction", "--output", "film_thickness"]
    over += ["--set", "study.friction-curve.points=40"]
    done = sweep(folder, "run", "scene.toml", *over, "--engine", "serial", "--out", "s", code=2, preexec_fn=limited)
    assert "journal-000000.sqlite: cannot be written (" in done.stderr
    assert "free space on the disk" in done.stderr
    assert "what was done is kept; go on with: rollslip sweep resume s" in done.stderr
    kept = 200 - states(folder / "s", 200).count(0)
    assert 0 < kept < 200
    said = json.loads(sweep(folder, "resume", "s", "--engine", "serial", "--json").stdout)
    assert said["run"]["computed"] == 200 - kept
    same(result(folder), serial(folder, *over))


@pytest.mark.slow
def test_a_batch_system_that_ends_the_job_is_taken_for_ctrl_c(folder, reference):
    process = started(
        folder, "run", "scene.toml", *FACTORS, *SLOW, "--shard", "1/2", "--engine", "serial", "--out", "s"
    )
    until(lambda: points(folder, "s/shard-1-of-2") >= 1)
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=60)
    assert process.returncode == 130
    sweep(folder, "run", "scene.toml", *FACTORS, *SLOW, "--shard", "2/2", "--engine", "serial", "--out", "s")
    sweep(folder, "merge", "s", code=4)
    sweep(folder, "resume", "s", "--engine", "threads")
    same(result(folder), reference)


@pytest.mark.slow
def test_a_run_that_died_in_its_own_process_is_gone_on_with_in_others(folder):
    over = [
        "--over",
        "models.traction.fault=none,kill",
        "--over",
        "models.traction.factor=0.01:0.04:4",
        "--output",
        "friction",
    ]
    process = started(folder, "run", "scene.toml", *over, "--engine", "threads", "--out", "s")
    process.communicate(timeout=60)
    assert process.returncode == -signal.SIGKILL
    done = sweep(folder, "resume", "s", code=4)
    assert "engine processes: an earlier run died in its own process" in done.stdout
    assert result(folder)["status"].values.tolist() == [["ok"] * 4, ["crashed"] * 4]


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (["run", "1032930-70C", "--over", "operation.radial_load=500:5000"], 2, "has no count"),
        ([*LOADS, "--engine", "thread"], 5, "no engine is called 'thread'; did you mean 'threads'"),
        ([*LOADS, "--engine", "serial", "--workers", "2"], 2, "of engines threads and processes"),
        ([*LOADS, "--workers", "2"], 2, "--workers needs an --engine"),
        ([*LOADS, "--engine", "threads", "--scheduler", "tcp://x"], 2, "is of engine dask"),
        ([*LOADS, "--engine", "dask"], 2, "engine.scheduler: missing, but required"),
        ([*LOADS, "--shard", "0/3"], 2, "write I/N with I from 1 to N"),
        (["retry", "s"], 2, "--failed, or --status"),
        (["resume", "nowhere"], 2, "nowhere: holds no sweep"),
        (["status", "nowhere"], 2, "nowhere: holds no sweep"),
        (["merge", "nowhere"], 2, "--out says where the pieces are put together"),
    ],
)  # fmt: skip
def test_what_does_not_go_together_is_refused(arguments, code, said, tmp_path, monkeypatch, capsys):
    from rollslip.cli import main

    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as left:
        main(["sweep", *arguments])
    assert left.value.code == code
    assert said in capsys.readouterr().err
    assert not list(tmp_path.glob("**/journal-*"))
