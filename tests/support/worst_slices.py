"""Slices on which compiled laws are farthest from 50 digits: where they are drawn, and what each instruction set gives.

``python worst_slices.py`` reads a law's slices as JSON, {law: [members, ...]}, and prints what the active set fills for
each, null where it refuses; with ``--times`` it prints the seconds a slice of each law instead.
"""

import json
import math
import os
import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
from mpmath import mp, mpf

from fifty_digits import LAWS, exact
from hard_cases import BASE, REFUSALS, answer, subjects
from rollslip import Chain, Conditions, Slices
from rollslip_kernels.slices import COLUMNS, CONDITIONS

HERE = Path(__file__).parent
#: Members of a slice -> least and largest value, between which all orders are as likely: those of bearings, and beyond.
RANGES = {
    "length": (5e-3, 0.1), "radius": (1e-3, 0.05), "modulus": (1.8e11, 2.6e11), "roughness": (1e-8, 1e-6),
    "effusivity": (5e3, 2e4), "temperature": (303.0, 423.0), "viscosity": (1e-3, 1.0),
    "pressure_viscosity": (5e-9, 3e-8), "thermoviscosity": (0.01, 0.1), "pressure_thermoviscosity": (1e-11, 2e-10),
    "conductivity": (0.1, 0.2), "eyring_stress": (1e6, 2e7), "shear_modulus": (1e7, 1e9), "approach": (1e-8, 1e-4),
    "rolling_speed": (0.1, 100.0), "sliding_speed": (1e-12, 100.0), "load": (1e2, 1e6), "half_width": (1e-5, 5e-4),
    "pressure": (1e7, 3e9), "film_thickness": (1e-8, 1e-5), "film_viscosity": (1e-3, 1e6),
    "film_thermoviscosity": (0.01, 0.1),
}  # fmt: skip


@cache
def laws():
    """Law -> its subject, of all that are compiled and known in 50 digits."""
    return {
        one.name: one for one in subjects() if one.name in LAWS and one.model.kernel() is not None
    }


def drawn(law, random):
    """Return the members of a slice that a law reads."""
    return {
        name: float(math.exp(random.uniform(*map(math.log, RANGES[name]))))
        if name in RANGES
        else BASE[name]
        for name in sorted(laws()[law].reads)
    }


def near(members, random):
    """Return a slice some thousandths away from another, within the ranges."""
    moved = {name: value * (1.0 + 1e-3 * random.normal()) for name, value in members.items()}
    return {
        name: float(np.clip(value, *RANGES[name])) if name in RANGES else value
        for name, value in moved.items()
    }


def error_of(law, members, got):
    """Return the largest relative error of what was filled, and of which column; the regime has to be the very one."""
    expected = exact(law, laws()[law].model, members)
    worst = (0.0, "")
    for column, value in got.items():
        with mp.workdps(50):
            error = float(
                abs(mpf(value) - expected[column])
                / max(abs(expected[column]), mpf(sys.float_info.min))
            )
        worst = max(worst, (math.inf if column == "regime" and error else error, column))
    return worst


def by_set(name, requested, *options):
    """Return what an instruction set gives for {law: [members, ...]}, in a process of its own."""
    path = os.pathsep.join(filter(None, (str(HERE), os.environ.get("PYTHONPATH"))))
    done = subprocess.run(
        [sys.executable, __file__, *options],
        input=json.dumps(requested),
        env=os.environ | {"ROLLSLIP_SIMD": name, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(done.stdout)


def _filled(law, rows):
    """What a law fills for each slice alone."""
    chain = laws()[law].forms[0]
    for row in rows:
        try:
            yield answer(chain, row)
        except REFUSALS:
            yield None


def _bound(law, rows, n):
    """A call of a law on so many slices: those given, over and over, with the conditions of the first."""
    model = laws()[law].model
    columns = {}
    for name in model.reads & COLUMNS.keys():
        columns[name] = np.resize([row[name] for row in rows], n)
    conditions = Conditions(**{name: rows[0][name] for name in model.reads & CONDITIONS.keys()})
    return Chain(model).bind(Slices(n, conditions, **columns))


def main():
    """Answer what is asked on the standard input."""
    requested = json.loads(sys.stdin.read())
    if "--times" not in sys.argv:
        print(json.dumps({law: list(_filled(law, rows)) for law, rows in requested.items()}))
        return
    sys.path.insert(0, str(HERE.parents[1] / "tools" / "benchmarks"))
    from timing import interleaved

    n = 1024
    calls = {}
    for law, rows in requested.items():
        calls[law] = _bound(law, rows, n)
        calls[law]()
    print(json.dumps({law: float(np.median(t)) / n for law, t in interleaved(calls, 21).items()}))


if __name__ == "__main__":
    main()
