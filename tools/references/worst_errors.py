"""Search the slices on which compiled laws are farthest from 50 digits, and write them to worst_errors.csv.

    python tools/references/worst_errors.py

- Slices are drawn from ranges that hold what bearings have and more (`worst_slices.RANGES`), then some thousandths
  around those found worst. The law in 50 digits (`fifty_digits`) gets the very floats that the stage got.
- Each instruction set has its own worst slice; those that fuse multiply-adds give the same bits. A row has the error of
  its set at its slice, relative to the exact value. That a search finds nothing worse is no proof that there is none.
- What bits are possible at the input decides too: Barus's exponent is alpha p times its rounding, whoever computes it.

Some minutes; tests/kernels/test_worst_errors.py computes the rows anew.
"""

import csv
import json
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "support"))

from rollslip_kernels.stages import simd
from worst_slices import by_set, drawn, error_of, laws, near

#: Slices drawn first, of laws whose 50 digits are dear, and how often and how many are drawn around the worst.
FIRST = 2000
DEAR = 400
ROUNDS = 4
AROUND = 100
KEPT = 3
DEAR_LAWS = ("lambda-blend", "maxwell-eyring")


def main():
    """Search, and write the table."""
    random = np.random.default_rng(20261123)
    worst = {}
    requested = {
        law: [drawn(law, random) for _ in range(DEAR if law in DEAR_LAWS else FIRST)]
        for law in laws()
    }
    for k in range(ROUNDS + 1):
        for name in simd.available():
            for law, filled in by_set(name, requested).items():
                known = worst.setdefault((law, name), [])
                for members, got in zip(requested[law], filled, strict=True):
                    if got is not None:
                        error, column = error_of(law, members, got)
                        known.append((error, column, members))
                known.sort(key=lambda one: one[0], reverse=True)
                del known[KEPT:]
        if k < ROUNDS:
            requested = {law: [] for law in laws()}
            for (law, _), known in worst.items():
                few = AROUND // (len(known) * (4 if law in DEAR_LAWS else 1))
                requested[law] += [
                    near(members, random) for *_, members in known for _ in range(few)
                ]
    with Path(__file__).with_suffix(".csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("law", "set", "error", "column", "members"))
        for (law, name), [(error, column, members), *_] in sorted(worst.items()):
            writer.writerow((law, name, f"{error:.3e}", column, json.dumps(members)))
            print(law, name, f"{error:.1e}", column)


if __name__ == "__main__":
    main()
