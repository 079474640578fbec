"""Write elastic_gap.csv: the gap between half-spaces with a flooded film, over its film where dp/dx = 0.

The gap is what two elastic bodies are further apart than dry ones under the same load, whose pressure is Hertz's. At
x = 0 both yield by -4/(pi E') int ln|x| p dx, but for a constant, so that it is the film there and the difference of
both integrals. Pressure and film are those of reynolds-line, in the groups of Moes. Takes some seconds.
"""

import csv
import math
from pathlib import Path

import numpy as np

from rollslip_plugins.film.line_contact import solve_line_contact

#: M and L of the contacts.
CONTACTS = (
    (0.03, 5.0),
    (0.3, 10.0),
    (1.0, 10.0),
    (3.0, 10.0),
    (10.0, 10.0),
    (3.0, 0.0),
    (10.0, 0.0),
)


def gap(M, L):
    solved = solve_line_contact(M, L)
    before = -np.geomspace(1e-9, -solved.x[0], 200_001)[::-1]
    x = np.concatenate([before, np.geomspace(1e-9, solved.x[-1], 100_001)])
    logarithm = np.trapezoid(np.log(np.abs(x)) * np.interp(x, solved.x, solved.pressure), x)
    # the pressure falls with the third power before the first node
    logarithm += solved.pressure[0] * -solved.x[0] * (math.log(-solved.x[0]) / 2 + 1 / 4)
    hertz = M * (math.log(math.sqrt(8 * M / math.pi) / 2) - 0.5)
    wider = solved.thickness["central"] + 4 / math.pi * (logarithm - hertz)
    return wider / solved.thickness["dp/dx = 0"]


if __name__ == "__main__":
    with Path(__file__).with_suffix(".csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(("M", "L", "gap"))
        for M, L in CONTACTS:
            table.writerow((M, L, f"{gap(M, L):.4f}"))
