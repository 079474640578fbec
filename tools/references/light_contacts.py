"""Write light_contacts.csv: the mean pressure in the film of a line contact over Hertz's, from solutions of its own.

r = (int p^2 dx/int p dx)/(8/(3 pi) p_H), with the pressures of the finite volumes of reynolds_line.py; nothing of
rollslip goes in. In Moes's groups p_H = sqrt(M/(2 pi)). Written are values extrapolated from 400 and 800 cells for
second order, and as uncertainty the relative change by the extrapolation. The first row, with M = 0, is r/M of a rigid,
isoviscous contact, by quadrature in 30 digits. Takes four minutes.
"""

import csv
import importlib.util
import math
from pathlib import Path

import mpmath

HERE = Path(__file__).parent
CASES = [
    (0.1, 0.0), (0.3, 0.0), (1.0, 0.0), (3.0, 0.0), (10.0, 0.0), (0.3, 5.0), (0.7, 5.0), (1.5, 5.0), (3.0, 5.0),
    (0.5, 8.5), (1.0, 8.5), (0.3, 10.0), (0.7, 10.0), (1.0, 10.0),
]  # fmt: skip


def reynolds():
    spec = importlib.util.spec_from_file_location("reynolds_line", HERE / "reynolds_line.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


REYNOLDS = reynolds()


def ratio(M, L, cells):
    """Return r; the way to the solution is that of reynolds_line.py."""
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
    P = kept["unknowns"][:-1]
    size = kept["mesh"].size
    edge = abs(kept["mesh"].x[0] - size[0] / 2)  # beyond it P = 8/|X|^3
    mean = (size @ P**2 + 64 / (5 * edge**5)) / (size @ P + 4 / edge**2)
    return mean / (8 / (3 * math.pi) * math.sqrt(M / (2 * math.pi)))


def rigid():
    """Return r/M with h = h0 (1 + t^2), x = sqrt(2 R h0) t, p' = 12 eta u (h - hm)/h^3, p = p' = 0 at t = c."""
    mp = mpmath.mp
    mp.dps = 30
    parts = [-mp.inf, -3, -1, 0]

    def slope(t, c):
        return (t * t - c * c) / (1 + t * t) ** 3

    c = mp.findroot(lambda c: mp.quad(lambda t: slope(t, c), [*parts, c]), 0.475)

    def flat(g):  # int slope dt from -inf to tan(g), t = tan g: (sin^2 - c^2 cos^2) cos^2 dg
        whole = (g + mp.pi / 2) / 8 - mp.sin(4 * g) / 32
        fourth = 3 * (g + mp.pi / 2) / 8 + mp.sin(2 * g) / 4 + mp.sin(4 * g) / 32
        return whole - c * c * fourth

    ends = [-mp.pi / 2, -1, 0, mp.atan(c)]
    first, second = (mp.quad(lambda g, k=k: flat(g) ** k / mp.cos(g) ** 2, ends) for k in (1, 2))
    # with eta u = R = E' = h0 = 1: length, scale of the pressure, load, mean pressure by load, and Hertz's
    length = mp.sqrt(2)
    scale = 12 * mp.sqrt(2)
    load = scale * length * first
    mean = scale * second / first
    hertz = 8 / (3 * mp.pi) * mp.sqrt(load / (2 * mp.pi))
    return mean / hertz / (load / mp.sqrt(2))


if __name__ == "__main__":
    with (HERE / "light_contacts.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(("M", "L", "ratio", "uncertainty"))
        table.writerow((0, 0, mpmath.nstr(rigid(), 17), 0))
        for M, L in CASES:
            middle, fine = (ratio(M, L, cells) for cells in (400, 800))
            value = fine + (fine - middle) / 3
            table.writerow(
                (f"{M:g}", f"{L:g}", f"{value:.6g}", f"{math.fabs(fine / value - 1):.2g}")
            )
            file.flush()
