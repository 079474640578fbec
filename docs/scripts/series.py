"""Add rows to docs/tables/series.csv: what users wait for, version by version, by the clock and by the processor.

Instructions are counted and gate (tests/kernels/test_instructions.py); this is beside them, gates nothing, and shows
what no count of a stage sees. Commands of the shipped scenes are run in fresh processes, bytecode compiled before.
Machines differ and are used by others, so a fixed work of NumPy and Python is timed beside each command, and a row says
how many times as long as the least of these the command took by the processor: that ratio is what to compare between
rows of other days.

``python docs/scripts/series.py [ROUNDS [FOLDER ...]]``, 5 rounds by default: medians of this version and of those in
folders of clones, built in place, which take turns. A version is its commit; its rows are replaced. The Python that
runs it must have the program's libraries but not the program, whose models other versions would find beside their own.
"""

import csv
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from output import DOCS, write_table
from versions import surroundings

HERE = DOCS.parent
HEADER = "date", "commit", "command", "clock [s]", "processor [s]", "over the fixed work"
COMMANDS = (
    "run 1032930-70C --no-plots",
    "run 1032930-70C --report",
    "run 1032930-50C --study dynamics --no-plots",
    "uncertainty 1032930-70C --samples 64",
    "sweep run 1032930-70C --over operation.radial_load=500N:5000N:64 --study friction-curve --engine serial",
)


def fixed_work():
    """Time of the processor [s] of some work of NumPy and Python that no version of the program changes."""
    begin = time.process_time()
    x = np.linspace(0.1, 2.0, 1000)
    total = 0.0
    for _ in range(2000):
        total += float(np.sum(np.exp(-x) * np.arcsinh(x) + np.log1p(x * x)))
    for k in range(500_000):
        total += k % 7
    assert total > 0.0
    return time.process_time() - begin


def once(root, command, folder):
    """Clock and processor [s] of a command, and the processor time of the fixed work beside it."""
    unit = fixed_work()
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    begin = time.perf_counter()
    call = [
        sys.executable,
        "-c",
        "from rollslip.cli import main; main()",
        *command.split(),
        "--out",
        folder,
    ]
    subprocess.run(call, **surroundings(root))
    clock = time.perf_counter() - begin
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return clock, processor, unit


def git(root, *arguments):
    """What git says of a folder."""
    return subprocess.run(
        ["git", "-C", root, *arguments], capture_output=True, text=True, check=True
    ).stdout.strip()


def main(rounds=5, *folders):
    roots = [HERE, *(Path(folder).resolve() for folder in folders)]
    measured = {(root, command): [] for root in roots for command in COMMANDS}
    for k in range(int(rounds) + 1):
        for root, command in measured:
            with tempfile.TemporaryDirectory() as folder:
                found = once(root, command, os.path.join(folder, "o"))
            if k:  # the first round compiles bytecode
                measured[root, command].append(found)
    path = DOCS / "tables" / "series.csv"
    rows = list(csv.reader(path.open(encoding="utf-8")))[1:] if path.exists() else []
    versions = {root: git(root, "log", "-1", "--format=%cs %h").split() for root in roots}
    rows = [row for row in rows if row[1] not in {commit for _, commit in versions.values()}]
    unit = min(unit for times in measured.values() for *_, unit in times)
    for (root, command), times in measured.items():
        clock, processor, _ = (statistics.median(of) for of in zip(*times, strict=True))
        rows.append(
            [
                *versions[root],
                command,
                f"{clock:.2f}",
                f"{processor:.2f}",
                f"{processor / unit:.1f}",
            ]
        )
        print(*rows[-1], sep=" | ", flush=True)
    rows.sort(key=lambda row: (COMMANDS.index(row[2]), row[0]))
    write_table("series", HEADER, rows)


if __name__ == "__main__":
    main(*sys.argv[1:])
