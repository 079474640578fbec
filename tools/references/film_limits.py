"""Write the tables of the data set film-limits: films of line contacts in their limits, as thicknesses of three rigs.

What goes in is not rollslip's: closed forms and quadrature for rigid contacts and finite volumes for elastic ones
(`reynolds_line.py` beside this file, whose tables are read), and two published formulas. What this script adds is the
conditions at which a rig has the groups of a row: speed and load from M and L, with h = H R sqrt(2 eta u/(E' R)).
"""

import csv
import math
from pathlib import Path

HERE = Path(__file__).parent
DATA = HERE.parents[1] / "plugins" / "rollslip_campaigns" / "measurement" / "sets" / "film-limits"
RADIUS = 0.01
STEEL = 210e9 / (1 - 0.3**2)
STIFF = 2e12 / (1 - 0.3**2)
#: Viscosity [Pa s] and pressure-viscosity coefficient [1/Pa] of the oils in the rig files.
OIL = (0.01, 20e-9)
THICK = (1.0, 50e-9)
WATER = (0.01, 1e-12)
COLUMNS = ("rolling_speed [m/s]", "temperature [degC]", "load_per_length [N/m]", "film_thickness [um]",
           "film_thickness_uncertainty [um]")  # fmt: skip


def contact(m, sum_speed, film, viscosity, modulus):
    """Speed, load and film of a rig at M, U_s and H."""
    speed = sum_speed * modulus * RADIUS / (2 * viscosity)
    return speed, m * math.sqrt(sum_speed) * modulus * RADIUS, film * RADIUS * math.sqrt(sum_speed)


def rows_of(table):
    with (HERE / table).open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def written(name, note, rows):
    lines = [f"# {note}", "# Written by tools/references/film_limits.py.", ", ".join(COLUMNS)]
    lines += [
        ", ".join(f"{value:.8g}" for value in (u, 40.0, w, 1e6 * h, 1e6 * h * error))
        for u, w, h, error in rows
    ]
    (DATA / f"{name}.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")


def main():
    """Write all tables."""
    martin = []
    for m, sum_speed in ((0.02, 1e-9), (0.01, 1e-9), (0.02, 1e-10)):  # 2 H M = 4.89497
        martin.append(
            (*contact(m, sum_speed, 4.89497 / (2 * m), WATER[0], STEEL), 0.0012)
        )  # 2.45 with both speeds
    written(
        "rigid-isoviscous",
        "2 H M = 4.89497, in print 2.45 with the sum of speeds; that last digit is its error.",
        martin,
    )
    barus = []
    for row in rows_of("reynolds_line_rigid.csv"):
        g_v = float(row["gV"])
        film = float(row["hhat_minimum"])
        if not 3.0 < g_v < 15.0:
            continue
        g_e = 0.1  # nearly rigid
        u = (g_v / (g_e**1.5 * THICK[1] * STIFF)) ** 4
        m = g_e / math.sqrt(2)
        barus.append((*contact(m, 2 * u, film / (2 * m), THICK[0], STIFF), 0.02))
    written(
        "rigid-piezoviscous",
        "Closed form and quadrature, rigid; 2 % for what is left of elasticity.",
        barus,
    )
    soft, hard = ({place: [] for place in ("minimum", "zero_gradient")} for _ in range(2))
    for row in rows_of("reynolds_line.csv"):
        m = float(row["M"])
        lubricant = float(row["L"])
        oil, into = (WATER, soft) if lubricant == 0.0 else (OIL, hard)
        sum_speed = 1e-11 if lubricant == 0.0 else (lubricant / (oil[1] * STEEL)) ** 4
        for place in into:
            error = max(float(row[f"{place}_uncertainty"]), 1e-3)  # what solvers are held to
            film = contact(m, sum_speed, float(row[place]), oil[0], STEEL)
            into[place].append((*film, error))
    for place, rows in soft.items():
        written(
            f"elastic-isoviscous-{place}".replace("_", "-"),
            "Finite volumes, elastic, constant viscosity.",
            rows,
        )
    for place, rows in hard.items():
        written(
            f"elastic-piezoviscous-{place}".replace("_", "-"),
            "Finite volumes, elastic, Barus.",
            rows,
        )
    herrebrugh = [
        (*contact(m, 1e-11, 2.04524 * m**-0.2, WATER[0], STEEL), 0.03) for m in (20.0, 50.0, 100.0)
    ]
    written(
        "published-herrebrugh",
        "H M^0.2 = 2.04524 of the fit 3.10 g_E^0.8; 3 % for the fit.",
        herrebrugh,
    )


if __name__ == "__main__":
    main()
