"""Make traction_field.csv: traction of a line contact by the method of lines, in SI units.

Run as ``python traction_field.py``; it takes some minutes and needs NumPy and SciPy only.

- Film and one of the two equal solids are cut into finite volumes across, the film evenly over half its thickness, the
  solid ever more coarsely down to a depth that no heat reaches. The differential equations that are left go along the
  contact with SciPy's BDF in phi, x = -b cos(phi). Nothing is shared with the model under test: no convolution integral
  for the surface, no modes, no cells with frozen viscosity, no exact relaxation of the stress.
- Every case is solved on three grids; finite volumes are of second order, so two of them are extrapolated. ``error`` is
  the relative difference of the two extrapolations, and what a hundredfold tolerance of the solver changes.
"""

import csv
import itertools
import math
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

RESULTS = ("friction", "error", "middle_temperature", "surface_temperature")
OIL = {
    "viscosity": 0.01634,
    "pressure_viscosity": 1.302e-8,
    "thermoviscosity": 0.0366,
    "pressure_thermoviscosity": 1.4e-10,
    "conductivity": 0.145,
    "heat_capacity": 1.8e6,
    "eyring_stress": 4e6,
    "shear_modulus": 3e8,
    "effusivity": 13000.0,
}
CONTACT = {
    "half_width": 5.14e-5,
    "pressure": 3.36e8,
    "film_thickness": 1.465e-6,
    "rolling_speed": 29.8,
    "sliding_speed": 3.0,
}
#: Changes of a fast roller bearing's contact at 30 degC.
CASES = (
    {"sliding_speed": 0.3},
    {},
    {"sliding_speed": 12.0},
    {"sliding_speed": 60.0},
    # a film that conducts at once, one that hardly conducts, one whose surfaces are hotter than itself
    {"film_thickness": 1e-7, "rolling_speed": 5.0, "half_width": 2e-4},
    {"film_thickness": 4e-6, "half_width": 3e-5},
    {"film_thickness": 5e-8, "sliding_speed": 1.0, "effusivity": 3000.0, "viscosity": 2e-3},
    # heavy load: elastic, and steep in pressure
    {"pressure": 8e8, "film_thickness": 6e-7, "half_width": 1.2e-4, "sliding_speed": 0.5},
    {
        "pressure": 8e8,
        "film_thickness": 6e-7,
        "half_width": 1.2e-4,
        "sliding_speed": 0.02,
        "shear_modulus": 5e7,
    },
    {
        "pressure": 1.2e9,
        "film_thickness": 4e-7,
        "half_width": 1.8e-4,
        "viscosity": 4e-3,
        "sliding_speed": 2.0,
    },
    # grease-like, Newtonian
    {"eyring_stress": 1e8, "pressure": 1e8, "sliding_speed": 10.0},
)


def solve(case, film_cells, solid_cells, tolerance):
    """Return friction, and the largest rise [K] in the middle of the film and of the surface."""
    c = {**OIL, **CONTACT, **case}
    u = c["rolling_speed"]
    h = c["film_thickness"]
    b = c["half_width"]
    dz = h / 2 / film_cells
    # depth in units of sqrt(diffusivity b/u): q = E sqrt(u/b) dtheta/ddepth
    edges = 14.0 * np.sinh(7.0 * np.arange(solid_cells + 1) / solid_cells) / math.sinh(7.0)
    width = np.diff(edges)
    effusion = c["effusivity"] * math.sqrt(u / b)
    to_wall = c["conductivity"] / (dz / 2)
    into_solid = effusion / (width[0] / 2)

    def slopes(phi, state):
        tau = state[0]
        film = state[1 : 1 + film_cells]
        solid = state[1 + film_cells : -1]
        p = 4 / math.pi * c["pressure"] * math.sin(phi)
        beta = c["thermoviscosity"] + c["pressure_thermoviscosity"] * p
        eta = c["viscosity"] * np.exp(c["pressure_viscosity"] * p - beta * film)
        viscous = c["eyring_stress"] / eta * math.sinh(tau / c["eyring_stress"])
        wall = (to_wall * film[-1] + into_solid * solid[0]) / (to_wall + into_solid)
        flux = np.concatenate(
            [[0.0], c["conductivity"] * np.diff(film) / dz, [to_wall * (wall - film[-1])]]
        )
        down = np.concatenate(
            [
                [into_solid * (wall - solid[0])],
                -effusion * np.diff(solid) / np.diff((edges[1:] + edges[:-1]) / 2),
                [0.0],
            ]
        )
        along = np.concatenate(
            [
                [c["shear_modulus"] / u * (c["sliding_speed"] / h - np.mean(viscous))],
                (np.diff(flux) / dz + tau * viscous) / (c["heat_capacity"] * u),
                -np.diff(down) / (effusion * width * b),
                [tau],
            ]
        )
        return b * math.sin(phi) * along

    scale = np.concatenate(
        [[c["eyring_stress"]], np.full(film_cells + solid_cells, 10.0), [c["eyring_stress"] * b]]
    )
    done = solve_ivp(
        slopes,
        (0, math.pi),
        np.zeros(scale.size),
        method="BDF",
        rtol=tolerance,
        atol=tolerance * scale * 1e-3,
    )
    if not done.success:
        raise RuntimeError(done.message)
    film = done.y[1 : 1 + film_cells]
    solid = done.y[1 + film_cells : -1]
    wall = (to_wall * film[-1] + into_solid * solid[0]) / (to_wall + into_solid)
    middle = (9 * film[0] - film[1]) / 8  # even about the middle
    return np.array([done.y[-1, -1] / (2 * b * c["pressure"]), middle.max(), wall.max()])


def main():
    with Path(__file__).with_suffix(".csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow((*OIL, *CONTACT, *RESULTS))
        for case in CASES:
            grids = [solve(case, n, n, 1e-8) for n in (32, 64, 128)]
            coarse, fine = (b + (b - a) / 3 for a, b in itertools.pairwise(grids))
            rough = solve(case, 32, 32, 1e-6)
            error = abs(fine[0] / coarse[0] - 1) + abs(rough[0] / grids[0][0] - 1)
            values = {**OIL, **CONTACT, **case}.values()
            row = (f"{fine[0]:.9g}", f"{error:.1e}", f"{fine[1]:.6g}", f"{fine[2]:.6g}")
            table.writerow((*(f"{value:g}" for value in values), *row))
            print(case, *row)


if __name__ == "__main__":
    main()
