"""Write growth.csv of docs/trust/time_of_a_run.rst: how time and memory grow with slices, positions, samples and cases.

Each size is computed in a fresh process. Time is that of the processor, of all threads and processes; memory is the
largest resident set (Linux). The exponent is that of the time between the last two sizes, less the time of the smallest
size, which has imports and all that does not grow. Rows of sweeps are computed from engine_throughput.csv and
engine_memory.csv, which ``docs/scripts/engine_cost.py`` writes. Ten minutes of one core.
"""

import csv
import json
import math
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from output import write_table

import rollslip
from rollslip.bearing.assembly import assemble
from rollslip.bearing.resolution import Resolution
from rollslip_studies.effective_friction.study import EffectiveFriction

TABLES = Path(__file__).parents[1] / "tables"
SCENE = rollslip.evolve(rollslip.load_scene("1032930-70C"), {"study.steady-slip.pockets": "set"})


def friction(slices, positions):
    """Compute the effective friction of all rollers at a resolution."""
    resolution = Resolution(slices=slices, n_positions=positions)
    EffectiveFriction.from_scene(SCENE).run(assemble(SCENE, resolution))


def samples(count):
    """Compute samples of the scattering data; most of them by torque curves."""
    with tempfile.TemporaryDirectory() as folder:
        rollslip.uncertainty(SCENE, samples=count, engine="serial", out=Path(folder) / "o")


def cases(count, interpolate):
    """Compute load cases that are drawn at random."""
    import pandas

    generator = np.random.default_rng(4)
    table = pandas.DataFrame(
        {
            "radial_load [kN]": generator.lognormal(1.0, 0.5, count),
            "inner_speed [rpm]": generator.uniform(3000.0, 7000.0, count),
        }
    )
    with tempfile.TemporaryDirectory() as folder:
        rollslip.cases(
            SCENE, table, interpolate=interpolate, engine="serial", out=Path(folder) / "o"
        )


#: What grows -> function of the size, and sizes.
WORK = {
    "effective friction, slices": (lambda n: friction(n, 4), (25, 400, 1600, 6400)),
    "effective friction, roller positions": (lambda n: friction(25, n), (4, 64, 256, 1024)),
    "samples of uncertainty": (samples, (512, 4096, 16_384)),
    "load cases, each computed": (lambda n: cases(n, None), (8, 64, 256)),
    "load cases, interpolated to 5 %": (lambda n: cases(n, "5 %"), (512, 4096, 16_384, 65_536)),
}


def measured(what, size):
    """Return processor time [s] and largest memory [MB] of one size, in a fresh process."""
    done = subprocess.run(
        [sys.executable, __file__, what, str(size)], capture_output=True, text=True, check=True
    )
    return json.loads(done.stdout.splitlines()[-1])


def exponent(sizes, seconds):
    """Return the exponent of the time between the last two sizes, less that of the first; NaN where nothing grows."""
    grown = [value - seconds[0] for value in seconds[-2:]]
    if not min(grown) > 0.0:
        return math.nan
    return math.log(grown[1] / grown[0]) / math.log(sizes[-1] / sizes[-2])


def sweeps():
    """Yield rows on points of sweeps, with two workers, from the tables of the engines."""
    tables = [
        [*csv.DictReader((TABLES / f"{name}.csv").read_text(encoding="utf-8").splitlines())]
        for name in ("engine_throughput", "engine_memory")
    ]
    for engine in ("processes", "dask"):
        pairs = [rows for rows in zip(*tables, strict=True) if rows[0]["point"] == "nothing"]
        sizes = [int(rate["points"]) for rate, _ in pairs]
        seconds = [int(rate["points"]) / float(rate[f"{engine} [1/s]"]) for rate, _ in pairs]
        peaks = [max(map(float, memory[f"{engine} [MB]"].split("/"))) for _, memory in pairs]
        yield row(f"points of a sweep, {engine}, by the clock", sizes, seconds, peaks)


def row(what, sizes, seconds, peaks):
    """Return a row of the table."""
    return [
        what,
        f"{sizes[0]} to {sizes[-1]}",
        f"{seconds[0]:.2g}",
        f"{seconds[-1]:.3g}",
        f"{exponent(sizes, seconds):.2f}",
        f"{peaks[0]:.0f}",
        f"{peaks[-1]:.0f}",
    ]


def main():
    """Measure one size, or all and write the table."""
    if len(sys.argv) > 1:
        work, _ = WORK[sys.argv[1]]
        start = time.process_time()
        work(int(sys.argv[2]))
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        print(json.dumps([time.process_time() - start, peak]))
        return
    rows = []
    for what, (_, sizes) in WORK.items():
        found = [measured(what, size) for size in sizes]
        print(what, found, flush=True)
        rows.append(row(what, sizes, *zip(*found, strict=True)))
    head = ["what", "range", "time at the first, s", "at the last, s", "exponent"]
    write_table("growth", [*head, "memory at the first, MB", "at the last, MB"], [*rows, *sweeps()])


if __name__ == "__main__":
    main()
