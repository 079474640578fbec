"""Write routes.csv and routes_summary.csv of docs/trust/play.rst: random bearings by steady-slip and in time.

Bearings, oils, speeds, loads, temperatures and supplies of ``rollslip new`` are drawn at random. Both studies have
their defaults. Rows are those of bearings that neither study refuses. A quarter of an hour of one core for 60 bearings;
another number may be given as an argument.
"""

import random
import sys
from collections import Counter
from pathlib import Path

import numpy as np

import rollslip
from rollslip.errors import RollslipError

sys.path.insert(0, str(Path(__file__).parent))
from output import write_table

SEED = 3
COUNT = 60
BEARINGS = (
    "NU205", "NU208", "NU210", "NU216", "NU220", "NU230", "NU310", "NU316", "NU2210", "NU2216", "NU2312", "NU2320",
    "NU1012", "NU1020", "NJ306", "NJ312", "N208", "N316", "NUP210", "NU248", "NU2330", "NU1036",
)  # fmt: skip
OILS = ("iso-vg-32", "iso-vg-68", "iso-vg-150", "iso-vg-320", "mil-prf-23699")
SUPPLIES = ("bath", "splash", "circulating", "jet", "mist")
TEMPERATURES = (40, 60, 80, 100)
#: Loads of a bore of 50 mm; they grow with its square [kN].
LOADS = (0.3, 1.0, 3.0, 10.0)
#: Logarithms of the smallest and the largest product of speed and mean diameter [mm/min].
SPEED_FACTORS = (4.3, 5.8)
#: Ratio of mean diameter and bore of a usual bearing.
MEAN_DIAMETER = 1.4
#: Slip below which both are the same [1].
SMALLEST = 1e-3
#: Upper ends of classes of slips [1].
CLASSES = (0.01, 0.05, 1.0)


def drawn(rng):
    """What a random scene is, in words and as arguments of `rollslip.new`."""
    bearing = rng.choice(BEARINGS)
    oil = rng.choice(OILS)
    bore = 5 * int(bearing[-2:])
    speed = 10.0 ** rng.uniform(*SPEED_FACTORS) / (MEAN_DIAMETER * bore)
    load = rng.choice(LOADS) * (bore / 50.0) ** 2
    temperature = rng.choice(TEMPERATURES)
    supply = rng.choice(SUPPLIES)
    values = {
        "oil": oil,
        "speed": f"{speed:.0f} rpm",
        "load": f"{load:.2f} kN",
        "temperature": f"{temperature} degC",
        "supply": supply,
    }
    return bearing, values


def answered(scene, study):
    """Slip and verdict of a study."""
    answer = rollslip.answer(rollslip.run(scene, study))
    return answer["cage_slip"].value, str(answer.verdict)


def percent(slip):
    """A slip in per cent with two digits."""
    return f"{100.0 * slip:.2g}" if abs(slip) >= SMALLEST else "below 0.1"


def summary(found):
    """How far the slips of both studies agree, by the size of the slip, and how many verdicts differ."""
    low = 0.0
    for high in CLASSES:
        rows = [(one, other) for one, other, *_ in found if low <= max(one, other) < high]
        ratios = np.array([one / other for one, other in rows if min(one, other) >= SMALLEST])
        name = f"{100.0 * low:g} to {100.0 * high:g} %"
        within = np.count_nonzero(np.abs(ratios - 1.0) <= 0.1)
        spread = f"{np.min(ratios):.2f} to {np.max(ratios):.2f}"
        yield [name, len(rows), f"{np.median(ratios):.2f}", spread, f"{within} of {ratios.size}"]
        low = high


def main(count=COUNT):
    """Draw and run the bearings, and write both tables."""
    rng = random.Random(SEED)
    rows = []
    found = []
    for k in range(int(count)):
        bearing, values = drawn(rng)
        what = f"{bearing}; {'; '.join(values.values())}"
        try:
            scene = rollslip.new(bearing, **values)
            slip, verdict = answered(scene, "steady-slip")
            in_time, verdict_in_time = answered(scene, "dynamics")
        except RollslipError as error:
            print(k, what, error)
            continue
        rows.append([k, what, percent(slip), verdict, percent(in_time), verdict_in_time])
        print(*rows[-1], sep=" | ", flush=True)
        if np.isfinite(slip) and np.isfinite(in_time):
            found.append((slip, in_time, verdict, verdict_in_time))
    write_table(
        "routes",
        [
            "bearing",
            "what",
            "steady-slip [%]",
            "its verdict",
            "dynamics [%]",
            "its verdict in time",
        ],
        rows,
    )
    write_table(
        "routes_summary",
        ["slip", "bearings", "steady-slip over dynamics, median", "range", "within 10 %"],
        summary(found),
    )
    print(Counter(tuple(row[3::2]) for row in rows))


if __name__ == "__main__":
    main(*sys.argv[1:])
