"""Write starved_line.csv: rigid, isoviscous line contacts that find a layer of oil, by integrals of Reynolds' equation.

    dp/dx = 12 eta u (h - h_oil)/h^3,   h = h0 + x^2/(2 R),   p = 0 where the film begins, p = dp/dx = 0 where it ends

Without flow to the sides all of the layer h_oil passes, so that dp/dx = 0 where h = h_oil. With xi = x/sqrt(2 R h0) the
film ends at xi = c, 1 + c^2 = h_oil/h0, and begins at xi = -b, which the pressure at both ends decides. The load is
24 (eta u R/h0) A with A = int xi (c^2 - xi^2)/(1 + xi^2)^3 dxi. ``starvation`` is the flow that a flooded contact with
the same load takes, 6 eta u R/w, over the layer, and ``exit`` is c^2. The first row is flooded, b to infinity.
"""

import csv
import math
from pathlib import Path

from scipy.integrate import quad
from scipy.optimize import brentq

#: Beginnings b of the film.
BEGINNINGS = (1e4, 30.0, 10.0, 5.0, 3.0, 2.0, 1.5, 1.0, 0.7, 0.5, 0.3, 0.1, 0.03)


def integral(b, c, power):
    """Return int xi^power (c^2 - xi^2)/(1 + xi^2)^3 dxi from -b to c, over t = arctan(xi)."""

    def integrand(t):
        xi = math.tan(t)
        return xi**power * (c * c - xi * xi) * math.cos(t) ** 4

    return quad(
        integrand,
        -math.atan(b),
        math.atan(c),
        epsabs=1e-14 * min(b, 1.0) ** 3,
        epsrel=1e-9,
        limit=200,
    )[0]


def starved(b):
    """Return starvation and c^2 of a film that begins at -b."""
    unit = min(b, 1.0)
    # the pressure at c is this integral, but for a factor
    c = brentq(lambda c: integral(b, c, 0) / unit**3, 0.3 * unit, 0.8 * unit)
    return 0.25 / (integral(b, c, 1) * (1.0 + c * c)), c * c


if __name__ == "__main__":
    with Path(__file__).with_suffix(".csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(("starvation", "exit"))
        for b in BEGINNINGS:
            table.writerow(f"{value:.6g}" for value in starved(b))
