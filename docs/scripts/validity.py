"""Write docs/tables/validity_pressure.csv and validity_muraki.csv: what it costs to leave what laws were made for.

- ``validity_pressure``: the pressure in the film against Hertz's, mean by load int p^2 dx / int p dx, in per cent, of
  line contacts solved numerically over Moes's M and L.
- ``validity_muraki``: the largest errors of the closed form against the exact law, in per cent, over one of its groups.
"""

import math

import numpy as np
from output import write_table

from rollslip_kernels.stages.stress import maxwell_eyring, muraki
from rollslip_plugins.film.line_contact import solve_line_contact

LOADS = (0.1, 0.2, 0.5, 1.0, 2.0)
LUBRICANTS = (0.0, 5.0, 8.0, 10.0, 12.0, 15.0)
DEBORAH = (0.1, 0.3, 1.0, 2.0, 3.0, 10.0, 30.0)
FILM_HEATING = (0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 100.0, 1e6)
HEATING = (1.0, 3.0, 10.0, 100.0, 1000.0)


def pressure(M, L):
    """Return by how many per cent the mean pressure by load is above Hertz's, 8/(3 pi) of the largest."""
    contact = solve_line_contact(M, L)
    hertz = 8 / (3 * math.pi) * math.sqrt(M / (2 * math.pi))
    mean = np.trapezoid(contact.pressure**2, contact.x) / np.trapezoid(contact.pressure, contact.x)
    return 100 * (mean / hertz - 1)


def off(*groups):
    """Return by how many per cent muraki is above the exact law at sigma, D, Phi."""
    return 100 * (float(muraki(*groups)) / float(maxwell_eyring(*groups)) - 1)


def elastic(D):
    """Return the error of largest size without heat."""
    return max((off(sigma, D, 0.0) for sigma in np.logspace(-3, 4, 71)), key=abs)


def heated(product):
    """Return the lowest error at a heating of a Newtonian film Phi sigma, for Phi from 1e-4 to 1 and D to 0.1."""
    return min(
        off(product / phi, D, phi) for phi in np.logspace(-4, 0, 41) for D in (0.0, 1e-3, 0.1)
    )


def largest(phi):
    """Return the error of the largest stress over sigma."""
    of = [
        max(float(law(sigma, 0.0, phi)) for sigma in np.logspace(-3, 4, 2001))
        for law in (muraki, maxwell_eyring)
    ]
    return 100 * (of[0] / of[1] - 1)


def main():
    """Write the tables."""
    table = [(f"{M:g}", *(f"{pressure(M, L):.0f}" for L in LUBRICANTS)) for M in LOADS]
    write_table("validity_pressure", ("M", *(f"L = {L:g}" for L in LUBRICANTS)), table)
    groups = (
        ("D", DEBORAH, elastic),
        ("Phi sigma", FILM_HEATING, heated),
        ("Phi", HEATING, largest),
    )
    table = [
        (name, f"{value:g}", f"{error(value):.1f}")
        for name, values, error in groups
        for value in values
    ]
    write_table("validity_muraki", ("group", "value", "error %"), table)


if __name__ == "__main__":
    main()
