"""Write rolling_resistance.csv, rolling_resistance_map.csv: forces int h dp/2 with which films resist rolling.

With Moes's groups F = R E' Us^(3/4) f, and f = int H dP/2.

- rolling_resistance.csv: Barus's law, by the finite volumes of reynolds_line.py; nothing of rollslip goes in. From the
  inlet's edge outwards, where P = 8/|X|^3 and H = X^2/2, the integral is 6/|X|. Written are values extrapolated from
  600 and 1200 cells for second order, and as uncertainty the relative change by the extrapolation. The first row, with
  M = 0, is f/sqrt(M) of a rigid, isoviscous contact, by quadrature in 30 digits: F = sqrt(2) f/sqrt(M) sqrt(eta u w).
  Takes three minutes.
- rolling_resistance_map.csv: the oil of a bearing (Roelands with alpha = 20/GPa and 30 mPa s, the density of Dowson and
  Higginson, E' = 227 GPa), by the finite elements of rollslip's reynolds-line, which the other table checks. The inlet
  begins at ``inlet``, |x|/(R Us^(1/4)), without pressure there; infinite is flooded. ``uncertainty`` is the larger one
  of two relative differences: to f on elements of twice the size, and to -int P X dX/2, which is f as well. Takes a
  minute.
"""

import csv
import importlib.util
import math
from pathlib import Path

import attrs
import mpmath
import numpy as np
from numpy.polynomial import legendre

from rollslip_plugins.film import line_contact
from rollslip_plugins.film.elements import DEGREE, Elements

HERE = Path(__file__).parent
CASES = [(0.5, 0.0), (0.5, 10.0), (1.0, 5.0), (2.0, 8.0), (5.0, 3.0), (20.0, 2.0)]

#: Parameters M and L of the map.
LOADS = (0.1, 0.2, 0.5, 1, 2, 3.5, 5, 10, 20, 50, 100, 200)
OILS = (0, 1, 2, 3.5, 5, 7.5, 10, 12.5, 15, 20)
#: Parameters of the contacts whose inlet is shortened, and where it begins then, in sqrt(8 M/pi + 4.9/M + 2.1 L^(2/3)).
SHORT_LOADS = (0.1, 0.5, 2, 10, 50, 200)
SHORT_OILS = (0, 5, 10, 15)
REACHES = (8, 6, 4, 3, 2.5, 2)
ELEMENTS = (40, 64, 100)


def other(name):
    spec = importlib.util.spec_from_file_location(name, HERE / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


# By finite volumes, and of a rigid contact ---------------------------------------------------------------------------

REYNOLDS = other("reynolds_line")


def force(M, L, cells):
    """Return f; the continuation to the solution is that of reynolds_line.py."""
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


# By finite elements, the oil of a bearing ----------------------------------------------------------------------------

FLOODED = (line_contact._residual, line_contact._jacobian)


def short_residual(grid, unknowns, problem):
    """Return residuals of a film without pressure before its inlet: no tail, and no load of it."""
    residual, film = FLOODED[0](grid, unknowns, problem)
    residual[-2] = unknowns[-3] / problem.M
    residual[-1] = grid.load @ unknowns[:-2] / problem.M - 1
    return residual, film


def short_jacobian(grid, unknowns, problem):
    """Return their derivatives."""
    matrix = FLOODED[1](grid, unknowns, problem)
    matrix[-2:, -1] = 0.0
    return matrix


def use(residual, jacobian):
    """Let the solver of rollslip solve other equations."""
    line_contact._residual = residual
    line_contact._jacobian = jacobian


def contact(M, L):
    """Return the problem of a contact; the pressure in Pa is L P/alpha."""
    if L == 0:
        return line_contact._Problem(M, None, None, fraction=1.0, floor=2.5e-5)
    alpha = 20e-9
    pole = 1.96e8
    rise = math.log(0.03) + 9.67
    z = alpha * pole / rise

    def log_viscosity(pressure):
        return rise * ((1 + L * pressure / alpha / pole) ** z - 1)

    def density(pressure):
        p = L * pressure / alpha
        return 1 + 0.6e-9 * p / (1 + 1.7e-9 * p)

    return line_contact._Problem(M, log_viscosity, density, fraction=1.0, floor=2.5e-5)


def shortened(state, problem, inlet, elements):
    """Return the solution whose inlet begins at ``inlet``, from one that begins a little earlier."""
    grid = state.grid
    end = inlet + state.unknowns[-1]
    mesh = Elements(np.append(grid.edges[grid.edges < 0.999 * end], end))
    pressure = grid.interpolated(state.unknowns[:-2], mesh.y)
    pressure -= pressure[-1] * mesh.y / end
    start = attrs.evolve(state, grid=mesh, unknowns=np.append(pressure, state.unknowns[-2:]))
    near = line_contact._solved(start, problem, 1e-3)
    return line_contact._solved(near.adapted(problem, elements), problem, 1e-5)


def forces(state, tail):
    """Return int (H - Hm) dP/2 and -int P X dX/2, and where the inlet begins; a tail is P = 8/|X|^3 before it."""
    grid = state.grid
    unknowns = state.unknowns
    x, weights = legendre.leggauss(8)
    of_values = np.linalg.inv(
        legendre.legvander(np.append(-1.0, radau(grid)), DEGREE)
    )  # to coefficients
    gap = grid.deformation @ unknowns[:-2] + grid.y * (grid.y / 2 - unknowns[-1])
    gap = np.append(0.0, gap)[grid.of_element] @ of_values.T @ legendre.legvander(x, DEGREE).T
    coefficients = grid.coefficients(unknowns[:-2])
    slope = legendre.legder(coefficients, axis=1) @ legendre.legvander(x, DEGREE - 1).T
    pressure = coefficients @ legendre.legvander(x, DEGREE).T
    at = unknowns[-1] - (grid.middle[:, None] + grid.half[:, None] * x)
    inlet = grid.edges[-1] - unknowns[-1]
    by_film = -np.sum(weights * gap * slope) / 2  # y runs upstream
    by_moment = -np.sum(weights * grid.half[:, None] * pressure * at) / 2
    if tail:
        by_film += 6 / inlet - 4 * unknowns[-2] / inlet**3
        by_moment += 4 / inlet
    return by_film, by_moment, inlet


def radau(grid):
    """Return the nodes of an element on [-1, 1], without the first."""
    return (grid.y[:DEGREE] - grid.middle[0]) / grid.half[0]


def row(state, problem, tail):
    """Return inlet, f and its uncertainty."""
    coarse = forces(state, tail)[0]
    fine = line_contact._solved(state.bisected(), problem, 1e-8)
    value, moment, inlet = forces(fine, tail)
    differences = (abs(coarse / value - 1), abs(moment / value - 1))
    return (math.inf if tail else inlet), value, max(differences)


def rows(M, L, elements):
    """Return the rows of a contact, flooded and with shortened inlets."""
    problem = contact(M, L)
    use(*FLOODED)
    state = line_contact._along_the_path(problem, elements)
    found = [row(state, problem, True)]
    if M in SHORT_LOADS and L in SHORT_OILS:
        scale = math.sqrt(8 * M / math.pi + 4.9 / M + 2.1 * L ** (2 / 3))
        inlet = forces(state, True)[2]
        use(short_residual, short_jacobian)
        for reach in REACHES:
            while inlet > 1.0001 * reach * scale:
                inlet = max((0.7 if inlet > 12 * scale else 0.9) * inlet, reach * scale)
                state = shortened(state, problem, inlet, elements)
            found.append(row(state, problem, False))
    return found


def solved_map():
    for L in OILS:
        for M in LOADS:
            for elements in ELEMENTS:
                try:
                    found = rows(M, L, elements)
                except line_contact._Stuck:
                    continue
                break
            else:
                print(f"not solved: M = {M:g}, L = {L:g}")
                continue
            for inlet, value, uncertainty in found:
                yield f"{M:g}", f"{L:g}", f"{inlet:.7g}", f"{value:.6g}", f"{uncertainty:.1g}"


def write(name, head, rows):
    with (HERE / name).open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(head)
        table.writerows(rows)


def by_finite_volumes():
    yield 0, 0, mpmath.nstr(rigid(), 17), 0
    for M, L in CASES:
        middle, fine = (force(M, L, cells) for cells in (600, 1200))
        value = fine + (fine - middle) / 3
        yield f"{M:g}", f"{L:g}", f"{value:.7g}", f"{math.fabs(fine / value - 1):.2g}"


if __name__ == "__main__":
    write("rolling_resistance_map.csv", ("M", "L", "inlet", "force", "uncertainty"), solved_map())
    write("rolling_resistance.csv", ("M", "L", "force", "uncertainty"), by_finite_volumes())
