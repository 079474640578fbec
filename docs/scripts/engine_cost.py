"""Measure what the engines of sweeps cost a point, and how time and memory grow with the points.

Every engine computes the same sweeps, each in a fresh process: of a point that computes nothing, of the cheapest point
that there is (a friction curve of five slips at five slices) and of an effective friction. Processes and dask have two
workers, dask a scheduler besides, over TCP on 127.0.0.1. Three tables are written:

- docs/tables/engine_throughput.csv: points a second for 100 points and more, with the start of the engine;
- docs/tables/engine_memory.csv: memory of the process that runs the sweep (resident set, from /proc, so on Linux only;
  without workers) before the run, its peak in the run, and its peak while the dataset is put together and written;
- docs/tables/engine_cost.csv: start of the engine and overhead of a point. The sweeps of the fewest and of the most
  points, n and N, take t and T: a point takes p = (T - t)/(N - n) and the start t - n p. The point itself, measured
  without a sweep, is taken off: from p times the workers (by the clock: with what they wait), and from the time of the
  processor of all processes (user and system: hardly dependent on what else the machine does). What the process of the
  sweep has of the latter says how many workers it can feed.

``python docs/scripts/engine_cost.py [NOTHING [CURVE [EFFECTIVE]]]``: largest number of points of each kind, by default
1000000, 100000 and 10000. Half an hour of two cores that have nothing else to do.
"""

import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager, suppress
from pathlib import Path

WORKERS = 2
KINDS = {"nothing": 1_000_000, "friction curve": 100_000, "effective friction": 10_000}
ENGINES = ("serial", "threads", "processes", "dask")
COARSE = {"accuracy.slices": 5, "study.friction-curve.points": 5}


def nothing(work, points):
    """Compute points that are one number: what is left is the engine."""
    from rollslip_campaigns.sweep.definition import installed_versions
    from rollslip_campaigns.sweep.journal import Row
    from rollslip_campaigns.sweep.point import TaskResult

    about = {
        "dims": (),
        "shape": (),
        "text": False,
        "attrs": {"units": "1", "long_name": "nothing"},
    }
    layout = json.dumps({"variables": {"critical_friction": about}, "coords": {}})
    rows = (Row(number, "", "ok", "", 0.0, layout, bytes(8)) for number, _ in points)
    return TaskResult(tuple(rows), installed_versions(work.packages))


def memory():
    """Return the resident set of this process and its peak since `forget_peak` [MB]."""
    lines = dict(line.split(":", 1) for line in Path("/proc/self/status").read_text().splitlines())
    return tuple(int(lines[name].split()[0]) / 1024 for name in ("VmRSS", "VmHWM"))


def forget_peak():
    Path("/proc/self/clear_refs").write_text("5")


def planned(kind, points):
    """Return a sweep of a kind of points, over loads and temperatures."""
    import rollslip
    from rollslip_campaigns.sweep import run as sweep_run
    from rollslip_campaigns.sweep.sweep import plan_sweep

    scene = rollslip.load_scene("1032930-70C")
    study = "effective-friction"
    if kind != "effective friction":
        scene = rollslip.evolve(scene, COARSE)
        study = "friction-curve"
    if kind == "nothing":
        sweep_run.compute = nothing
    loads = min(1000, points // 10)
    over = {
        "operation.temperature": f"60 degC:80 degC:{points // loads}",
        "operation.radial_load": f"1000:5000:{loads}",
    }
    return plan_sweep(scene, over, study=study, output=["critical_friction"])


def point_itself(kind):
    """Return the time of the processor of a point without a sweep [s]."""
    from rollslip_campaigns.sweep import run as sweep_run

    made = planned(kind, 1000)
    points = [(number, made.design.changes(number)) for number in range(1000)]
    sweep_run.compute(made.work, points[:20])
    before = time.process_time()
    sweep_run.compute(made.work, points)
    return (time.process_time() - before) / len(points)


def one_sweep(kind, name, points, address):
    """Run a sweep in this process; return what it took."""
    import rollslip
    from rollslip_campaigns.sweep import run as sweep_run
    from rollslip_campaigns.sweep.folder import create_folder, write_result

    made = planned(kind, points)
    parameters = {"dask": {"scheduler": address}, "serial": {}}.get(name, {"count": WORKERS})
    engine = rollslip.get_model("engine", name, **parameters)
    with tempfile.TemporaryDirectory() as folder:
        kept = create_folder(made, Path(folder))
        forget_peak()
        before, _ = memory()
        clock = time.perf_counter()
        own = time.process_time()
        all_ = sum(os.times()[:4])
        settled = sweep_run.run_sweep(made, kept, engine=engine)
        clock = time.perf_counter() - clock
        own = time.process_time() - own
        all_ = sum(os.times()[:4]) - all_
        _, run = memory()
        forget_peak()
        collecting = time.perf_counter()
        write_result(made, kept)
        collecting = time.perf_counter() - collecting
        _, collected = memory()
    assert settled.progress.counts == {"ok": points}, settled.progress.counts
    return {
        "seconds": clock,
        "own": own,
        "processor": all_,
        "collecting": collecting,
        "memory": (before, run, collected),
    }


def in_fresh_process(function, *arguments):
    """Call a function of this module in a process of its own."""
    code = f"import json, sys, engine_cost; print(json.dumps(engine_cost.{function}(*json.loads(sys.argv[1]))))"
    command = [sys.executable, "-c", code, json.dumps(arguments)]
    return json.loads(subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout)


def processor_of(groups):
    """Return the time of the processor of the processes of some groups, user and system [s]."""
    ticks = 0
    for path in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):  # it has just ended
            fields = path.read_text().rpartition(")")[2].split()
            if int(fields[2]) in groups:
                ticks += int(fields[11]) + int(fields[12])
    return ticks / os.sysconf("SC_CLK_TCK")


@contextmanager
def cluster():
    """Start a dask scheduler with workers of one thread each; give its address and groups of processes."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    address = f"tcp://127.0.0.1:{port}"
    started = []

    def start(what, *arguments):
        command = [
            sys.executable,
            "-m",
            f"distributed.cli.dask_{what}",
            *arguments,
            "--host",
            "127.0.0.1",
        ]
        silent = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        started.append(
            subprocess.Popen([*command, "--no-dashboard"], start_new_session=True, **silent)
        )

    try:
        start("scheduler", "--port", str(port))
        for _ in range(WORKERS):
            start("worker", address, "--nthreads", "1", "--nworkers", "1")
        from distributed import Client

        with Client(address, timeout=60) as client:
            client.wait_for_workers(WORKERS, timeout=60)
        yield address, [process.pid for process in started]
    finally:
        for process in started:
            os.killpg(process.pid, signal.SIGTERM)
        for process in started:
            process.wait()


def main(largest):
    """Measure all engines and write the tables."""
    from output import write_table

    throughput = []
    memories = []
    cost = []
    os.environ["PYTHONPATH"] = os.pathsep.join(
        filter(None, (str(Path(__file__).parent), os.environ.get("PYTHONPATH")))
    )
    with cluster() as (address, groups):
        for kind, most in largest.items():
            sizes = [size for size in (10**k for k in range(2, 8)) if size <= most]
            point = in_fresh_process("point_itself", kind)
            in_fresh_process(
                "one_sweep", kind, "dask", 100, address
            )  # its workers import what they need
            runs = {}
            for name in ENGINES:
                for size in sizes:
                    before = processor_of(groups) if name == "dask" else 0.0
                    run = runs[name, size] = in_fresh_process(
                        "one_sweep", kind, name, size, address
                    )
                    run["processor"] += processor_of(groups) - before if name == "dask" else 0.0
                    print(kind, name, size, run, f"load {os.getloadavg()[0]:.1f}", flush=True)
                cost.append((kind, name, *cost_of(name, point, sizes[0], sizes[-1], runs)))
                print(*cost[-1], sep=", ", flush=True)
            for size in sizes:
                all_ = [runs[name, size] for name in ENGINES]
                throughput.append((kind, size, *(f"{size / run['seconds']:.3g}" for run in all_)))
                memories.append(
                    (kind, size, *(" / ".join(f"{m:.0f}" for m in run["memory"]) for run in all_))
                )
    write_table(
        "engine_throughput", ("point", "points", *(f"{name} [1/s]" for name in ENGINES)), throughput
    )
    write_table(
        "engine_memory", ("point", "points", *(f"{name} [MB]" for name in ENGINES)), memories
    )
    write_table(
        "engine_cost",
        ("point", "engine", "point itself [ms]", "time per point [ms]", "overhead by the clock [ms]",
         "overhead of the processor [ms]", "of it the sweep's process [ms]", "start [s]"),
        cost,
    )  # fmt: skip


def cost_of(name, point, fewest, most, runs):
    """Return what a point takes and what of it is the engine's [ms], and the start of the engine [s]."""
    few = runs[name, fewest]
    many = runs[name, most]
    slope = {of: (many[of] - few[of]) / (most - fewest) for of in ("seconds", "processor", "own")}
    taken = (
        point,
        slope["seconds"],
        slope["seconds"] * (1 if name == "serial" else WORKERS) - point,
        slope["processor"] - point,
        slope["own"] - (point if name in ("serial", "threads") else 0.0),
    )
    start = max(0.0, few["seconds"] - fewest * slope["seconds"])
    return (*(f"{1e3 * seconds:.3f}" for seconds in taken), f"{start:.2g}")


if __name__ == "__main__":
    main(
        dict(
            zip(
                KINDS,
                (*map(int, sys.argv[1:]), *list(KINDS.values())[len(sys.argv) - 1 :]),
                strict=True,
            )
        )
    )
