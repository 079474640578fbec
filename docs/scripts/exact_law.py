"""Write docs/tables/exact_law.csv: error and time of the laws of an Eyring fluid, by range and instruction set.

- Groups are log-random over each range: the paper's bearing, all of order 1, and far beyond both.
- The error is the worst one against the exact Maxwell-Eyring stress in double precision; that of the exact stress is
  against fifty digits (tests/support/fifty_digits.py), over 40 films.
- Times are per slice, the least of many turns that the laws take one after another in one process: of the law alone,
  and as the stage of a chain, with groups and checks of the input.  What counts is the ratio to `muraki`.
"""

import json
import math
import os
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np
from mpmath import mp
from output import write_table

from rollslip import Chain, Conditions, Slices
from rollslip_kernels.stages import simd, stress
from rollslip_plugins.traction.eyring import Eyring, MaxwellEyring, Muraki

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "support"))

from fifty_digits import maxwell_eyring_stress as exact_stress

RANGES = {
    "bearing": ((1e-2, 15.0), (1e-4, 3e-3), (0.1, 1.2)),
    "order 1": ((0.1, 10.0), (0.1, 10.0), (0.1, 10.0)),
    "all": ((1e-8, 1e8), (1e-6, 1e4), (1e-6, 1e3)),
}
LAWS = {
    "muraki": (stress.muraki, Muraki()),
    "eyring": (stress.eyring, Eyring()),
    "maxwell-eyring": (stress.maxwell_eyring, MaxwellEyring()),
}
SLICES = 8192
FILMS = 400_000
TURNS = 60


def log_random(limits, n):
    """Groups sigma, D and Phi."""
    rng = np.random.default_rng(1)
    return [np.exp(rng.uniform(*np.log(pair), n)) for pair in limits]


def table_of(sigma, deborah, heating):
    """Slices of these groups, with tau0 = Gamma = eta = u = h = p = 1."""
    half_width = 1 / deborah
    rise = Muraki().flash * np.sqrt(half_width / math.pi) + 1 / 12e9
    ones = dict.fromkeys(("rolling_speed", "film_thickness", "film_viscosity", "pressure"), 1.0)
    conditions = Conditions(effusivity=1.0, conductivity=1e9, eyring_stress=1.0, shear_modulus=1.0)
    columns = {
        "sliding_speed": sigma,
        "half_width": half_width,
        "film_thermoviscosity": heating / rise,
    }
    return Slices(len(sigma), conditions, **ones, **columns)


def least_times(calls):
    """Least time of each call, in seconds."""
    best = dict.fromkeys(calls, math.inf)
    for _ in range(TURNS):
        for name, call in calls.items():
            begin = time.perf_counter()
            call()
            best[name] = min(best[name], time.perf_counter() - begin)
    return best


def measured():
    """Return range -> law -> time of law and of stage on the active instruction set."""
    found = {}
    for name, limits in RANGES.items():
        groups = log_random(limits, SLICES)
        slices = table_of(*groups)
        law = least_times({key: partial(law, *groups) for key, (law, _) in LAWS.items()})
        stage = least_times(
            {key: partial(Chain(model), slices) for key, (_, model) in LAWS.items()}
        )
        found[name] = {key: (law[key], stage[key]) for key in LAWS}
    return found


def worst_errors():
    """Return (range, law) -> worst relative error."""
    found = {}
    for name, limits in RANGES.items():
        groups = log_random(limits, FILMS)
        exact = stress.maxwell_eyring(*groups)
        for key, (law, _) in LAWS.items():
            found[name, key] = float(np.max(np.abs(law(*groups) / exact - 1)))
        with mp.workdps(50):
            found[name, "maxwell-eyring"] = max(
                float(abs(exact[i] / exact_stress(*(float(group[i]) for group in groups)) - 1))
                for i in range(40)
            )
    return found


def main():
    """Measure, each instruction set in a process of its own, and write the table."""
    errors = worst_errors()
    rows = []
    for name in simd.available():
        command = [sys.executable, __file__, name]
        environment = os.environ | {"ROLLSLIP_SIMD": name}
        times = json.loads(
            subprocess.run(command, env=environment, check=True, stdout=subprocess.PIPE).stdout
        )
        for group, laws in times.items():
            law_base, stage_base = laws["muraki"]
            for key, (law, stage) in laws.items():
                ratios = f"{law / law_base:.2f}", f"{stage / stage_base:.2f}"
                rows.append(
                    (
                        name,
                        group,
                        key,
                        f"{errors[group, key]:.1e}",
                        f"{1e9 * law / SLICES:.1f}",
                        *ratios,
                    )
                )
    write_table(
        "exact_law",
        ("instructions", "range", "law", "worst_error", "ns_a_slice", "ratio", "stage_ratio"),
        rows,
    )


if __name__ == "__main__":
    if len(sys.argv) > 1:
        print(json.dumps(measured()))
    else:
        main()
