"""Every compiled law on millions of inputs by each instruction set: how far apart they are; instruction_sets.csv.

    python tools/references/instruction_sets.py [INPUTS [ARM64]]

Typical slices are varied over decades in load, approach, speeds and film, a block of 256 at a time, the same bits on
every machine; a block that a law refuses by one set has to be refused by all. The sets run in processes of their own.
It takes some minutes. ARM64 is where ``instruction_sets.py ARM64 INPUTS`` has written, of fewer inputs, on such a
processor, or under emulation: the table was made with rollslip cross-compiled by GCC 12 and run by QEMU 7.2.
"""

import csv
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

SUPPORT = Path(__file__).parents[2] / "tests" / "support"
BLOCK = 256
SEED = 35
HEADER = ["law", "inputs", "refused", "sets", "v3 and v4", "baseline apart", "arm64 and v3"]


def fill(path, inputs):
    """Write what the set of this process makes of all laws, and which blocks it refuses."""
    from fuzz import stages
    from rollslip import Chain
    from rollslip.errors import DomainError
    from rollslip_kernels.slices import COLUMNS

    single, *_ = stages.stages()
    for k, model in enumerate(single):
        rng = np.random.default_rng(SEED)
        slices = stages.table(stages.typical(BLOCK))
        before = stages.table(stages.typical(BLOCK))
        for column in (
            getattr(of, name) for of in (slices, before) for name in COLUMNS if hasattr(of, name)
        ):
            column[:] = column.astype(
                np.float32
            )  # NumPy's powers differ by a last digit from machine to machine
        varied = sorted(
            model.reads & {"load", "approach", "rolling_speed", "sliding_speed", "film_thickness"}
        )
        chain = Chain(model)
        found = []
        refused = []
        for block in range(-(-inputs // BLOCK)):
            for column in varied:
                getattr(slices, column)[:] = getattr(before, column) * np.ldexp(
                    rng.uniform(1.0, 2.0, BLOCK), rng.integers(-6, 6, BLOCK)
                )
            for column in model.writes:
                getattr(slices, column)[:] = np.nan
            try:
                chain(slices)
            except DomainError:
                refused.append(block)
            else:
                found.append([getattr(slices, column).copy() for column in sorted(model.writes)])
        np.savez(f"{path}-{k}.npz", found=np.array(found), refused=np.array(refused, int))


def apart(one, other):
    """Largest relative difference, infinite where only one has a number; 0 for the same bits."""
    if one.tobytes() == other.tobytes():
        return 0.0
    with np.errstate(all="ignore"):
        off = np.abs(one - other) / np.abs(other)
    off[(one == other) | (np.isnan(one) & np.isnan(other))] = 0.0
    return float(np.where(np.isnan(off), np.inf, off).max(initial=0.0))


def same_bits(one, other):
    """Say whether two sets gave the same bits, and refused the same."""
    return (
        "the same bits" if all(one[of].tobytes() == other[of].tobytes() for of in one) else "differ"
    )


def main(inputs=2_000_000, arm64=""):
    """Write the table."""
    sys.path.insert(0, str(SUPPORT))
    from fuzz import stages
    from rollslip_kernels.stages import simd

    single, *_ = stages.stages()
    with (
        tempfile.TemporaryDirectory() as folder,
        Path(__file__).with_suffix(".csv").open("w", newline="") as file,
    ):
        for name in simd.available():
            command = [sys.executable, __file__, str(Path(folder, name)), str(inputs)]
            subprocess.run(command, env=os.environ | {"ROLLSLIP_SIMD": name}, check=True)
        table = csv.writer(file, lineterminator="\n")
        table.writerow(HEADER)
        for k, model in enumerate(single):
            filled = {
                name: dict(np.load(Path(folder, f"{name}-{k}.npz"))) for name in simd.available()
            }
            baseline = filled["baseline"]
            widest = filled[simd.available()[-1]]
            v3 = filled.get("v3", widest)
            elsewhere = "not tried"
            first = dict(np.load(f"{arm64}-{k}.npz")) if arm64 else {}
            if first:
                part = len(first["found"])
                elsewhere = f"{apart(first['found'], v3['found'][:part]):.1e} in {BLOCK * part}"
            agree = np.array_equal(baseline["refused"], widest["refused"])
            off = apart(baseline["found"], widest["found"]) if agree else np.inf
            refused = BLOCK * widest["refused"].size
            table.writerow(
                [
                    model.name,
                    inputs,
                    refused,
                    len(filled),
                    same_bits(v3, widest),
                    f"{off:.1e}",
                    elsewhere,
                ]
            )


if __name__ == "__main__":
    if len(sys.argv) == 3 and not sys.argv[1].isdigit():
        sys.path.insert(0, str(SUPPORT))
        fill(sys.argv[1], int(sys.argv[2]))
    else:
        main(*map(int, sys.argv[1:2]), *sys.argv[2:])
