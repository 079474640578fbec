"""Write case_interpolation.csv of docs/howto/cases.rst: how many of a table's load cases are computed, and how exactly.

Cases of the shipped bearing 1032930-70C are drawn at random: load, speed and temperature. Rollers are set in the cage;
with play a case takes 2.4 times as long.
"""

import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pandas

import rollslip

sys.path.insert(0, str(Path(__file__).parent))
from output import write_table

SCENE = rollslip.evolve(rollslip.load_scene("1032930-70C"), {"study.steady-slip.pockets": "set"})


def duty(count):
    """Return a table of load cases."""
    generator = np.random.default_rng(4)
    return pandas.DataFrame(
        {
            "radial_load [kN]": generator.lognormal(1.0, 0.5, count),
            "inner_speed [rpm]": generator.uniform(3000.0, 7000.0, count),
            "temperature [degC]": generator.uniform(50.0, 85.0, count),
        }
    )


def main():
    """Compute tables of two lengths, and write how."""
    rows = []
    for count in (1000, 10_000):
        with tempfile.TemporaryDirectory() as folder:
            start = time.process_time()
            found = rollslip.cases(
                SCENE, duty(count), interpolate="5 %", engine="serial", out=Path(folder) / "cases"
            )
            seconds = time.process_time() - start
        computed = count - found.attrs["interpolated_cases"]
        error = f"{100.0 * found.attrs['interpolation_error']:.2g} %"
        rows.append([count, computed, found.attrs["checked_cases"], error, f"{seconds:.0f}"])
    head = ["cases", "computed", "of these checked", "largest error of these", "processor time, s"]
    write_table("case_interpolation", head, rows)


if __name__ == "__main__":
    main()
