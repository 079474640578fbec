"""Instructions per slice of the compiled stages, counted by valgrind: a measure of speed that no load disturbs.

Valgrind knows AVX2 but not AVX-512, so "v4" is not counted; it is made of the same source by the same compiler.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import rollslip_kernels
from report import Table

SETS = ("baseline", "v3")
N = 1024
COUNTED = Path(__file__).with_name("counted.py")


class CannotCountError(Exception):
    """Says why instructions cannot be counted here."""


def counts(name, slices=N):
    """Return stage -> instructions per slice, of an instruction set.

    Raises
    ------
    CannotCountError
        Without valgrind, or the set.
    """
    if shutil.which("valgrind") is None:
        raise CannotCountError("valgrind is not installed")
    folder = Path(rollslip_kernels.__file__).parents[1]
    with tempfile.TemporaryDirectory() as scratch:
        out = Path(scratch) / "callgrind"
        command = [
            "valgrind",
            "--tool=callgrind",
            f"--callgrind-out-file={out}",
            "--dump-before=getppid",
            "--",
        ]
        done = subprocess.run(
            [*command, sys.executable, "-I", "-S", str(COUNTED), str(folder), str(slices)],
            env=os.environ | {"ROLLSLIP_SIMD": name},
            capture_output=True,
            text=True,
            check=False,
        )
        if "names no instruction set" in done.stderr:
            raise CannotCountError(f"instruction set {name} does not run under valgrind here")
        if done.returncode:
            raise RuntimeError(done.stderr[-2000:])
        stages = done.stdout.split()
        _, none, *totals = [instructions(Path(f"{out}.{k}")) for k in range(1, len(stages) + 3)]
    return {stage: (total - none) / slices for stage, total in zip(stages, totals, strict=True)}


def instructions(dump):
    """Return the instructions of a dump of callgrind."""
    return int(re.search(r"^totals: (\d+)$", dump.read_text(encoding="utf-8"), re.MULTILINE)[1])


def run():
    """Return the table of counts."""
    try:
        found = {name: counts(name) for name in SETS}
    except CannotCountError as reason:
        return [
            Table(
                "benchmark_instructions",
                "Instructions per slice",
                ("stage", *SETS),
                [],
                [f"{reason}."],
            )
        ]
    rows = [(stage, *(f"{found[name][stage]:.1f}" for name in SETS)) for stage in found[SETS[0]]]
    return [
        Table(
            "benchmark_instructions", f"Instructions per slice, {N} slices", ("stage", *SETS), rows
        )
    ]
