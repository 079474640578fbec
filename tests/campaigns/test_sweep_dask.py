"""Sweeps on a real dask scheduler with two workers, over TCP on this computer, of which each is killed in turn."""

import os
import signal
import socket
import subprocess
import sys
from contextlib import contextmanager, suppress

import pytest

import full_disk
from faulty_points import (
    FACTORS,
    environment,
    gone_on_with,
    held_run,
    interrupt_once,
    interrupt_twice,
    kill_the_run,
    let_go,
    prepare,
    result,
    same,
    sweep,
    until,
)

pytestmark = pytest.mark.faults


class Cluster:
    """A scheduler and its workers, each in a process of its own."""

    def __init__(self, folder):
        import distributed  # noqa: F401  # who runs these tests wants it: pip install 'rollslip[cluster]'

        self.folder = folder
        self.processes = []
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.address = f"tcp://127.0.0.1:{self.port}"

    def _start(self, what, *arguments):
        process = subprocess.Popen(
            [
                sys.executable,
                "-m",
                f"distributed.cli.dask_{what}",
                *arguments,
                "--host",
                "127.0.0.1",
                "--no-dashboard",
            ],
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


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    """What the points give in this process."""
    folder = tmp_path_factory.mktemp("reference")
    prepare(folder)
    sweep(folder, "run", "scene.toml", *FACTORS, "--engine", "serial", "--out", "s")
    return result(folder / "s")


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    """A cluster that no test harms."""
    folder = tmp_path_factory.mktemp("cluster")
    prepare(folder)
    with running(folder) as (cluster, _, _):
        yield cluster.address


def grandchild(process):
    """The process in which a worker's nanny computes."""
    found = subprocess.run(
        ["pgrep", "-P", str(process.pid), "-f", "spawn_main"],
        capture_output=True,
        text=True,
        check=False,
    )
    return [int(line) for line in found.stdout.split()]


def patient(folder, address):
    """Let a scene ask for a scheduler, for which it waits shortly."""
    with open(folder / "scene.toml", "a", encoding="utf-8") as file:
        file.write(
            f'\n[sweep]\nengine = {{ model = "dask", scheduler = "{address}", patience = "2 s" }}\n'
        )


@pytest.mark.parametrize("fault", [kill_the_run, interrupt_once, interrupt_twice])
def test_a_run_that_is_cut_off_is_gone_on_with(fault, address, folder, reference):
    fault(folder, reference, "--scheduler", address)


def test_a_full_disk_ends_the_run_and_loses_nothing(address, tmp_path):
    if not full_disk.allowed(tmp_path):
        pytest.skip("no file system can be mounted here: unshare(1) is missing or not allowed")
    full_disk.on_a_disk(
        full_disk.the_journal_grows_until_the_disk_is_full, tmp_path, "--scheduler", address
    )


def test_killed_workers_cost_no_point(folder, reference):
    """Of one the process that computes is killed, the other one whole."""
    with running(folder) as (cluster, _, workers):
        process = held_run(folder, "--scheduler", cluster.address)
        until(lambda: bool(grandchild(workers[0])))
        os.kill(grandchild(workers[0])[0], signal.SIGKILL)
        os.killpg(workers[1].pid, signal.SIGKILL)
        let_go(folder)
        out, err = process.communicate(timeout=120)
        assert process.returncode == 0, out + err
    same(result(folder / "s"), reference)


def test_a_scheduler_that_is_killed_and_started_again_costs_no_point(folder, reference):
    with running(folder) as (cluster, scheduler, _):
        process = held_run(folder, "--scheduler", cluster.address)
        os.killpg(scheduler.pid, signal.SIGKILL)
        scheduler.wait()
        let_go(folder)
        cluster.scheduler()
        cluster.worker()
        cluster.worker()
        out, err = process.communicate(timeout=180)
        assert process.returncode == 0, out + err
    same(result(folder / "s"), reference)


def test_a_scheduler_that_is_killed_for_good_ends_the_run_and_another_engine_goes_on(
    folder, reference
):
    with running(folder) as (cluster, scheduler, workers):
        patient(folder, cluster.address)
        process = held_run(folder)
        for one in (scheduler, *workers):
            os.killpg(one.pid, signal.SIGKILL)
        _, err = process.communicate(timeout=60)
    assert process.returncode == 2, err
    assert f"the dask scheduler {cluster.address} cannot be reached" in err
    assert "what was done is stored; go on with: rollslip sweep resume s" in err
    gone_on_with(folder, reference, "--engine", "serial")


def test_a_point_that_kills_workers_is_found(folder):
    over = [
        "--over", "models.traction.fault=none,kill", "--over", "models.traction.factor=0.1,0.2", "--output", "friction",
    ]  # fmt: skip
    with running(folder) as (cluster, _, _):
        sweep(
            folder, "run", "scene.toml", *over, "--scheduler", cluster.address, "--out", "s", code=4
        )
    assert result(folder / "s")["status"].values.tolist() == [["ok"] * 2, ["crashed"] * 2]


def test_a_scheduler_that_is_not_there_is_said(folder):
    patient(folder, "tcp://127.0.0.1:1")
    done = sweep(folder, "run", "scene.toml", *FACTORS, "--out", "s", code=2)
    assert "the dask scheduler tcp://127.0.0.1:1 cannot be reached" in done.stderr
    assert "go on with: rollslip sweep resume s" in done.stderr
