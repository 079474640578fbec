"""Write reynolds_line.csv and reynolds_line_rigid.csv: line contacts by two other ways than rollslip's solver.

- reynolds_line.csv: elastic contacts by finite volumes of second order on a fixed grid. Cavitation is the
  complementarity min(P, d(flux)) = 0, solved by a semismooth Newton method with the load balance as an equation; the
  pressure is constant over each cell, for which the half-space is exact. No film formula and nothing of rollslip goes
  in. Written are the values extrapolated from 600 and 1200 cells for second order, and as uncertainty the relative
  change by the extrapolation.
- reynolds_line_rigid.csv: rigid contacts with Barus's law. In the reduced pressure q = (1 - exp(-L P))/L they are
  isoviscous and known in closed form; only the load is left, by quadrature in 30 digits. The last row is the limit
  q = 1/L at the largest q, where the pressure is infinite and the load is not.

In Moes's groups, see rollslip_plugins/film/line_contact.py. Takes five minutes.
"""

import csv
import math
from pathlib import Path

import mpmath
import numpy as np
from scipy.optimize import brentq

HERE = Path(__file__).parent
CASES = [
    (0.5, 0.0),
    (5.0, 0.0),
    (20.0, 0.0),
    (0.5, 10.0),
    (1.0, 5.0),
    (2.0, 8.0),
    (5.0, 3.0),
    (20.0, 2.0),
]
CELLS = (600, 1200)


# Elastic -------------------------------------------------------------------------------------------------------------


def grid(M, cells):
    """Edges of cells: even near the contact, growing towards the inlet, and a piece beyond any exit."""
    half_width = math.sqrt(8 * M / math.pi)
    length = half_width + math.sqrt(2 * (3 / M + 2 * M**-0.2))  # of the film
    even = 2 * cells // 3
    near = np.linspace(-2.2 * length, 1.6 * length, even + 1)
    # a growth that starts at the even size
    step = near[1] - near[0]
    rest = cells - even
    far = 40 * length - 2.2 * length
    ratio = brentq(lambda r: step * r * (r**rest - 1) / (r - 1) - far, 1 + 1e-9, 1.5)
    return np.append(near[0] - np.cumsum(step * ratio ** np.arange(1, rest + 1))[::-1], near)


class Cells:
    def __init__(self, M, cells):
        edges = grid(M, cells)
        self.x = (edges[1:] + edges[:-1]) / 2
        self.size = np.diff(edges)
        distance = self.x[:, None] - edges
        with np.errstate(divide="ignore", invalid="ignore"):
            primitive = np.where(distance == 0, 0.0, distance * (np.log(np.abs(distance)) - 1))
        self.kernel = -4 / np.pi * (primitive[:, :-1] - primitive[:, 1:])
        # the film at an edge is the mean of its cells', of second order on an even grid and nearly so on a growing one
        self.gap = np.diff(self.x)
        self.left = (edges[1:-1] - self.x[:-1]) / self.gap


def equations(cells, unknowns, M, L):
    P = unknowns[:-1]
    H0 = unknowns[-1]
    H = H0 + cells.x**2 / 2 + cells.kernel @ P
    a = 1 - cells.left
    b = cells.left
    He = a * H[:-1] + b * H[1:]
    Pe = a * P[:-1] + b * P[1:]
    slope = np.diff(P) / cells.gap
    conductance = He**3 / 6 * np.exp(-L * Pe)
    flux = He - conductance * slope
    n = len(P)
    by_He = 1 - 3 * conductance / He * slope
    J = by_He[:, None] * (a[:, None] * cells.kernel[:-1] + b[:, None] * cells.kernel[1:])
    rows = np.arange(n - 1)
    J[rows, rows] += conductance * (1 / cells.gap + L * slope * a)
    J[rows, rows + 1] += conductance * (-1 / cells.gap + L * slope * b)
    balance = np.diff(flux)  # of the inner cells
    JB = np.empty((n + 1, n + 1))
    R = np.empty(n + 1)
    R[1 : n - 1] = balance
    JB[1 : n - 1, :n] = np.diff(J, axis=0)
    JB[1 : n - 1, n] = np.diff(by_He)
    # the smaller of pressure and outflow, both as pressures, is zero
    cavitated = 1 + np.flatnonzero(P[1:-1] < balance / np.abs(np.diag(JB)[1 : n - 1]))
    cavitated = np.append(cavitated, n - 1)
    R[cavitated] = P[cavitated]
    JB[cavitated] = np.eye(n + 1)[cavitated]
    R[0] = P[0] - 8 / np.abs(cells.x[0]) ** 3
    JB[0] = np.eye(n + 1)[0]
    R[n] = cells.size @ P + 4 / (cells.x[0] - cells.size[0] / 2) ** 2 - M
    JB[n] = np.append(cells.size, 0.0)
    return R, JB, H, flux


def newton(cells, unknowns, M, L):
    for _ in range(60):
        R, J, _H, _flux = equations(cells, unknowns, M, L)
        scale = np.abs(J).max(axis=1)
        step = np.linalg.solve(J / scale[:, None], -R / scale)
        largest = np.max(np.abs(step[:-1]))
        part = min(1.0, 0.5 / max(L * largest, 1e-30), 0.5 * np.max(unknowns[:-1]) / largest)
        unknowns = unknowns + part * step
        if part == 1.0 and largest < 1e-10 * np.max(unknowns[:-1]):
            return unknowns
    raise RuntimeError(f"no solution at M = {M}, L = {L}")


def solve(M, L, cells):
    """Return minimum, central and dp/dx = 0 film."""
    mesh = Cells(M, cells)
    # from a dry contact's pressure, smeared, at the load of a light contact
    first = min(M, 0.3)
    width = math.sqrt(6 / first)
    P = np.maximum(0.0, 1 - ((mesh.x + 0.3 * width) / width) ** 2)
    unknowns = np.append(P * first / (P @ mesh.size), 2.5 / first)
    steps = max(2, math.ceil(math.log(M / first) / 0.25) + 1)
    for load in np.geomspace(first, M, steps):
        unknowns = newton(mesh, unknowns, load, 0.0)
    for oil in np.linspace(0.0, L, max(2, math.ceil(2 * L)))[1:]:
        unknowns = newton(mesh, unknowns, M, oil)
    _, _, H, flux = equations(mesh, unknowns, M, L)
    P = unknowns[:-1]
    assert np.all(P >= -1e-12)
    k = int(np.argmin(np.where(P > 0, H, np.inf)))
    local = np.polyfit(mesh.x[k - 2 : k + 3] - mesh.x[k], H[k - 2 : k + 3], 4)
    bottom = [
        r.real
        for r in np.roots(np.polyder(local))
        if abs(r.imag) < 1e-12 and abs(r) <= mesh.size[k]
    ]
    middle = int(np.searchsorted(mesh.x, 0.0))
    central = np.polyval(
        np.polyfit(mesh.x[middle - 2 : middle + 3], H[middle - 2 : middle + 3], 4), 0.0
    )
    inside = np.flatnonzero(P > 0)
    return np.array([np.polyval(local, bottom[0]), central, np.median(flux[inside[5:-5]])])


def elastic():
    names = ("minimum", "central", "zero_gradient")
    with (HERE / "reynolds_line.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(("M", "L", *names, *(f"{name}_uncertainty" for name in names)))
        for M, L in CASES:
            middle, fine = (solve(M, L, cells) for cells in CELLS)
            value = fine + (fine - middle) / 3
            uncertainty = np.abs(fine / value - 1)
            table.writerow(
                (
                    f"{M:g}",
                    f"{L:g}",
                    *(f"{v:.8g}" for v in value),
                    *(f"{u:.2g}" for u in uncertainty),
                )
            )
            file.flush()


# Rigid ---------------------------------------------------------------------------------------------------------------


def rigid():
    mp = mpmath.mp
    mp.dps = 30

    def reduced(
        g, end
    ):  # q H0^2/(6 k), with X = k tan g and k = sqrt(2 H0), from q = 0 at the inlet
        def flat(g):
            return g / 2 + mp.sin(2 * g) / 4

        def bent(g):
            return 3 * g / 8 + mp.sin(2 * g) / 4 + mp.sin(4 * g) / 32

        return flat(g) - flat(-mp.pi / 2) - (bent(g) - bent(-mp.pi / 2)) / mp.cos(end) ** 2

    end = mp.findroot(lambda g: reduced(g, g), 0.4433)  # q = dq/dX = 0
    k = mp.sqrt(2)
    H0 = mp.one
    largest = 6 * k / H0**2 * reduced(-end, end)
    with (HERE / "reynolds_line_rigid.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(("share_of_limit", "gV", "hhat_minimum", "hhat_zero_gradient"))
        for fraction in ("1e-9", "0.1", "0.3", "0.5", "0.7", "0.8", "0.9", "0.97", "0.99", "1"):
            L = mp.mpf(fraction) / largest

            # the load is that of -(X + Xc) dP/dX, P' = q'/(1 - L q), whose integrand stays finite everywhere
            def density(g, L=L):
                slope = 6 * k / H0**2 * mp.cos(g) ** 2 * (1 - (mp.cos(g) / mp.cos(end)) ** 2)
                return (
                    -k
                    * (mp.tan(g) + mp.tan(end))
                    * slope
                    / (1 - L * 6 * k / H0**2 * reduced(g, end))
                )

            M = mp.quad(density, [-mp.pi / 2, -1, -end - 0.05, -end, -end + 0.05, 0, end])
            row = (mp.sqrt(2) * M**1.5 * L, 2 * H0 * M, 2 * H0 / mp.cos(end) ** 2 * M)
            table.writerow((fraction, *(mpmath.nstr(value, 10) for value in row)))


if __name__ == "__main__":
    rigid()
    elastic()
