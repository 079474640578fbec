"""Write docs/tables/misprint_limit.csv: what Eq. (8) gives as printed and corrected; the build draws misprint.svg."""

import math

import numpy as np
from muraki_error_map import as_printed, with_logarithm
from output import BLACK, BLUE, GREEN, ORANGE, figure, save_figure, write_table

from rollslip_kernels.stages.stress import maxwell_eyring, muraki

SIGMA = 10.0
HEATING = 0.1


def limit_table():
    """The limit of vanishing elasticity at one point."""
    limit = math.log(2 * SIGMA) / (1 + HEATING * SIGMA)
    rows = []
    for deborah in (1e-1, 1e-2, 1e-3, 1e-4):
        point = (SIGMA, deborah, HEATING)
        values = (
            with_logarithm(*point),
            as_printed(*point),
            float(muraki(*point)),
            float(maxwell_eyring(*point)),
        )
        rows.append((f"{deborah:g}", *(f"{value:.5g}" for value in values), f"{limit:.5g}"))
    header = (
        "D",
        "corrected, ln(2 sigma)",
        "as printed",
        "corrected, asinh(sigma)",
        "exact",
        "ln(2 sigma)/(1 + Phi sigma)",
    )
    write_table("misprint_limit", header, rows)


def plot():
    """Draw misprint.svg."""
    made, (left, right) = figure(2)
    sigma = np.geomspace(0.03, 100, 200)
    deborah = 1e-3
    left.plot(sigma, maxwell_eyring(sigma, deborah, HEATING), color=BLACK, label="exact")
    left.plot(sigma, muraki(sigma, deborah, HEATING), "--", color=BLUE, label="corrected, asinh(σ)")
    logarithm = [with_logarithm(s, deborah, HEATING) for s in sigma]
    left.plot(sigma, logarithm, "-.", color=ORANGE, label="corrected, ln(2σ)")
    left.axhline(0, color="0.7", linewidth=0.6)
    left.set(
        xscale="log",
        xlabel="σ",
        ylabel="S",
        ylim=(-1.5, 2),
        title=f"D = {deborah:g}, Φ = {HEATING:g}",
    )
    left.legend(loc="lower right")
    d = np.geomspace(1e-4, 10, 200)
    right.plot(d, maxwell_eyring(SIGMA, d, HEATING), color=BLACK, label="exact")
    right.plot(d, muraki(SIGMA, d, HEATING), "--", color=BLUE, label="corrected, asinh(σ)")
    right.plot(d, [as_printed(SIGMA, x, HEATING) for x in d], ":", color=GREEN, label="as printed")
    right.set(
        xscale="log", yscale="log", xlabel="D", ylabel="S", title=f"σ = {SIGMA:g}, Φ = {HEATING:g}"
    )
    right.legend(loc="upper right")
    save_figure(made, "misprint")


if __name__ == "__main__":
    limit_table()
