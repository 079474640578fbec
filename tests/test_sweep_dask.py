"""Sweeps on a real dask scheduler with two workers, over TCP on this computer, of which each is killed in turn."""

import os
import signal
import socket
import subprocess
import sys
import time
from contextlib import contextmanager, suppress

import numpy as np
import pytest

import rollslip
from faulty_points import environment, prepare, started, sweep
from rollslip.journal import journals, sessions

pytest.importorskip("distributed", reason="dask.distributed is not installed: pip install 'rollslip[cluster]'")
pytestmark = pytest.mark.slow

FACTORS = ["--over", "models.traction.factor=0.01:0.4:40", "--output", "friction"]
SLOW = ["--set", "models.traction.seconds=0.3"]


class Cluster:
    """A scheduler and its workers, each in a process of its own."""

    def __init__(self, folder):
        self.folder, self.processes = folder, []
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.address = f"tcp://127.0.0.1:{self.port}"

    def _start(self, what, *arguments):
        process = subprocess.Popen(
            [sys.executable, "-m", f"distributed.cli.dask_{what}", *arguments, "--host", "127.0.0.1", "--no-dashboard"],
            cwd=self.folder,
            env=environment(self.folder),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        self.processes.append(process)
        return process

    def scheduler(self):
        process = self._start("scheduler", "--port", str(self.port))
        until(self._listens)
        return process

    def _listens(self):
        with socket.socket() as probe:
            return probe.connect_ex(("127.0.0.1", self.port)) == 0

    def worker(self):
        return self._start("worker", self.address, "--nthreads", "1", "--nworkers", "1")

    def end(self):
        for process in self.processes:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()


@contextmanager
def running(folder):
    cluster = Cluster(folder)
    try:
        first = cluster.scheduler()
        yield cluster, first, [cluster.worker(), cluster.worker()]
    finally:
        cluster.end()


@pytest.fixture
def folder(tmp_path):
    prepare(tmp_path)
    return tmp_path


def until(holds, seconds=90.0):
    end = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < end, "it did not come to it"
        time.sleep(0.05)


def points(folder):
    return sum(one.rows for one in sessions(folder / "s")) if journals(folder / "s") else 0


def grandchild(process):
    """The process in which a worker's nanny computes."""
    found = subprocess.run(
        ["pgrep", "-P", str(process.pid), "-f", "spawn_main"], capture_output=True, text=True, check=False
    )
    return [int(line) for line in found.stdout.split()]


def same_as_serial(folder):
    sweep(folder, "run", "scene.toml", *FACTORS, "--engine", "serial", "--out", "serial")
    one, other = (rollslip.open_result(folder / name / "sweep.nc") for name in ("s", "serial"))
    assert (one["status"] == "ok").all()
    assert np.isfinite(one["friction"]).all()
    assert np.array_equal(one["friction"], other["friction"])


def test_a_killed_worker_costs_no_point(folder):
    with running(folder) as (cluster, _, workers):
        process = started(folder, "run", "scene.toml", *FACTORS, *SLOW, "--scheduler", cluster.address, "--out", "s")
        until(lambda: points(folder) >= 4)
        until(lambda: bool(grandchild(workers[0])))
        os.kill(grandchild(workers[0])[0], signal.SIGKILL)
        os.killpg(workers[1].pid, signal.SIGKILL)
        out, err = process.communicate(timeout=120)
        assert process.returncode == 0, out + err
    same_as_serial(folder)


def test_a_scheduler_that_is_killed_and_started_again_costs_no_point(folder):
    with running(folder) as (cluster, scheduler, _):
        process = started(folder, "run", "scene.toml", *FACTORS, *SLOW, "--scheduler", cluster.address, "--out", "s")
        until(lambda: points(folder) >= 4)
        os.killpg(scheduler.pid, signal.SIGKILL)
        scheduler.wait()
        cluster.scheduler()
        cluster.worker()
        cluster.worker()
        out, err = process.communicate(timeout=180)
        assert process.returncode == 0, out + err
    same_as_serial(folder)


def test_a_killed_client_is_gone_on_with(folder):
    with running(folder) as (cluster, _, _):
        process = started(folder, "run", "scene.toml", *FACTORS, *SLOW, "--scheduler", cluster.address, "--out", "s")
        until(lambda: points(folder) >= 4)
        process.kill()
        process.communicate()
        assert 4 <= points(folder) < 40
        sweep(folder, "resume", "s", "--scheduler", cluster.address)
        assert len(sessions(folder / "s")) == 2
    same_as_serial(folder)


def test_a_point_that_kills_workers_is_found(folder):
    over = [
        "--over",
        "models.traction.fault=none,kill",
        "--over",
        "models.traction.factor=0.1,0.2",
        "--output",
        "friction",
    ]
    with running(folder) as (cluster, _, _):
        sweep(folder, "run", "scene.toml", *over, "--scheduler", cluster.address, "--out", "s", code=4)
    assert rollslip.open_result(folder / "s" / "sweep.nc")["status"].values.tolist() == [["ok"] * 2, ["crashed"] * 2]


def test_a_scheduler_that_is_not_there_is_said(folder):
    table = '\n[sweep]\nengine = { model = "dask", scheduler = "tcp://127.0.0.1:1", patience = "2 s" }\n'
    with open(folder / "scene.toml", "a", encoding="utf-8") as file:
        file.write(table)
    done = sweep(folder, "run", "scene.toml", *FACTORS, "--out", "s", code=2)
    assert "the dask scheduler tcp://127.0.0.1:1 cannot be reached" in done.stderr
    assert "go on with: rollslip sweep resume s" in done.stderr
