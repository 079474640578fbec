"""Write rolling_resistance.csv: the force int h dp/2 with which a film resists rolling, from solutions of its own.

With Moes's groups and F = R E' Us^(3/4) f, f = int H dP/2, the pressures are those of the finite volumes of
reynolds_line.py; nothing of rollslip goes in. From the inlet's edge outwards, where P = 8/|X|^3 and H = X^2/2, the
integral is 6/|X|. Written are values extrapolated from 600 and 1200 cells for second order, and as uncertainty the
relative change by the extrapolation. The first row, with M = 0, is f/sqrt(M) of a rigid, isoviscous contact, by
quadrature in 30 digits: F = sqrt(2) f/sqrt(M) sqrt(eta u w). Takes three minutes.
"""

import csv
import importlib.util
import math
from pathlib import Path

import mpmath
import numpy as np

HERE = Path(__file__).parent
CASES = [(0.5, 0.0), (0.5, 10.0), (1.0, 5.0), (2.0, 8.0), (5.0, 3.0), (20.0, 2.0)]


def other(name):
    spec = importlib.util.spec_from_file_location(name, HERE / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


REYNOLDS = other("reynolds_line")


def force(M, L, cells):
    """Return f; the way to the solution is that of reynolds_line.py."""
    kept = {}
    inner = REYNOLDS.newton

    def newton(mesh, unknowns, *at):
        kept["mesh"], kept["unknowns"] = mesh, inner(mesh, unknowns, *at)
        return kept["unknowns"]

    REYNOLDS.newton = newton
    try:
        REYNOLDS.solve(M, L, cells)
    finally:
        REYNOLDS.newton = inner
    mesh = kept["mesh"]
    P = kept["unknowns"][:-1]
    H = REYNOLDS.equations(mesh, kept["unknowns"], M, L)[2]
    at_edges = (1 - mesh.left) * H[:-1] + mesh.left * H[1:]
    return at_edges @ np.diff(P) / 2 + 6 / abs(mesh.x[0])


def rigid():
    """Return f/sqrt(M) with h = h0 (1 + t^2) and p' = 12 eta u (h - hm)/h^3, p = p' = 0 at the exit t = c."""
    mp = mpmath.mp
    mp.dps = 30
    parts = [-mp.inf, -3, -1, 0]

    def slope(t, c):
        return (t * t - c * c) / (1 + t * t) ** 3

    c = mp.findroot(lambda c: mp.quad(lambda t: slope(t, c), [*parts, c]), 0.475)
    load = -mp.quad(lambda t: t * slope(t, c), [*parts, c])  # w = 24 (eta u R/h0) load
    resistance = mp.quad(
        lambda t: (1 + t * t) * slope(t, c), [*parts, c]
    )  # F = 6 sqrt(2) eta u sqrt(R/h0) resistance
    return 6 * mp.sqrt(2) * resistance / mp.sqrt(24 * load) / mp.sqrt(2)


if __name__ == "__main__":
    with (HERE / "rolling_resistance.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(("M", "L", "force", "uncertainty"))
        table.writerow((0, 0, mpmath.nstr(rigid(), 17), 0))
        for M, L in CASES:
            middle, fine = (force(M, L, cells) for cells in (600, 1200))
            value = fine + (fine - middle) / 3
            table.writerow(
                (f"{M:g}", f"{L:g}", f"{value:.7g}", f"{math.fabs(fine / value - 1):.2g}")
            )
            file.flush()
