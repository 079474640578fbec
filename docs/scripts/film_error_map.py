"""Compare every film formula with the solved line contact, and show what the solver itself is worth.

Tables: film_error.csv (error over load and lubricant parameter), film_error_ranges.csv (its extremes), and of the
solver reynolds_line_limits.csv, reynolds_line_halving.csv, reynolds_line_spike.csv and reynolds_line_oil.csv.
Each build of the docs draws film_error.svg, from the table, and film_error_pressure.svg.

Each formula is compared with the film of the same place.  A contact is given by M, L and G: most formulas are similar
in Moes's groups and do not know G, two feel it in powers of some hundredths; it is that of the oil of the shipped
scenes at 50 degC.  Takes two minutes.
"""

import itertools
import math

import numpy as np
from matplotlib.figure import Figure
from output import BLACK, BLUE, GREEN, ORANGE, PURPLE, figure, read_table, save_figure, write_table

from rollslip import get_model
from rollslip_plugins.data.lubricants import mil_prf_7808
from rollslip_plugins.film import line_contact as solver
from rollslip_plugins.film.line_contact import LOCATIONS, solve_line_contact
from rollslip_plugins.film.reynolds_line import ReynoldsLine
from rollslip_plugins.pressure_viscosity import Barus, Roelands

LOADS = (0.1, 0.2, 0.5, 1.0, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0)
OILS = (0.0, 2.5, 5.0, 8.0, 10.0, 12.0, 15.0)
#: The bearing of the paper.
PAPER = ((0.5, 3.0), (8.0, 15.0))
ACCURACY = 1e-4

RADIUS = 0.006875
MODULUS = 2.2857e11
ALPHA = 10.74e-9
FORMULAS = {
    "martin": get_model("film", "martin"),
    "blok": get_model("film", "blok"),
    "herrebrugh": get_model("film", "herrebrugh"),
    "dowson-higginson": get_model("film", "dowson-higginson"),
    "dowson-1968": get_model("film", "dowson-1968"),
    "pan-hamrock, minimum": get_model("film", "pan-hamrock"),
    "regime": get_model("film", "regime"),
    "dowson-toyoda": get_model("film", "dowson-toyoda"),
    "pan-hamrock, central": get_model("film", "pan-hamrock", thickness="central"),
    "moes": get_model("film", "moes"),
}


def location(name):
    """Where the film of a formula is."""
    model = FORMULAS[name]
    return getattr(model, "thickness", model.location)


def formula(name, M, L):
    """H of a formula, nan where it has none."""
    model = FORMULAS[name]
    alpha = ALPHA if L > 0 else 0.0
    if alpha < model.domain["pressure_viscosity"][0]:
        return math.nan
    speeds = (L / (ALPHA * MODULUS)) ** 4 if L > 0 else 1e-11
    speed = speeds / 2 * MODULUS * RADIUS / 0.01
    load = M * math.sqrt(speeds) * MODULUS * RADIUS
    return float(model.film_thickness(load, speed, RADIUS, MODULUS, 0.01, alpha)) / (
        RADIUS * math.sqrt(speeds)
    )


def percent(value, digits=1):
    """An error in percent as text; blank where there is no formula."""
    return "" if math.isnan(value) else f"{round(100 * value, digits) + 0.0:.{digits}f}"


# Formulas ------------------------------------------------------------------------------------------------------------


def errors():
    """Relative error of every formula, (M, L) -> formula -> error; and the films."""
    films = {
        (M, L): solve_line_contact(M, L, accuracy=ACCURACY).thickness for M in LOADS for L in OILS
    }
    return films, {
        (M, L): {name: formula(name, M, L) / film[location(name)] - 1 for name in FORMULAS}
        for (M, L), film in films.items()
    }


def error_tables(films, error):
    rows = [
        (
            f"{L:g}",
            f"{M:g}",
            *(f"{films[M, L][place]:.4g}" for place in LOCATIONS),
            *map(percent, error[M, L].values()),
        )
        for L, M in itertools.product(OILS, LOADS)
    ]
    write_table("film_error", ("L", "M", "H_minimum", "H_central", "H_dp/dx_=_0", *FORMULAS), rows)

    def extremes(name, region):
        found = [
            error[point][name]
            for point in error
            if region(*point) and not math.isnan(error[point][name])
        ]
        return f"{percent(min(found), 0)} to {percent(max(found), 0)}"

    (light, heavy), (thin, thick) = PAPER
    regions = {
        "all of the map": lambda M, L: True,
        "M 0.5 to 3, L 8 to 15": lambda M, L: light <= M <= heavy and thin <= L <= thick,
        "M 5 to 200, L 5 to 15": lambda M, L: M >= 5 and L >= 5,
        "M 0.1 to 0.5": lambda M, L: M <= 0.5,
        "L 0, M 5 to 200": lambda M, L: L == 0 and M >= 5,
    }
    header = ("formula", "film", *regions)
    rows = []
    for name in FORMULAS:
        cells = []
        for region in regions.values():
            known = any(region(*point) and not math.isnan(error[point][name]) for point in error)
            cells.append(extremes(name, region) if known else "")
        rows.append((name, location(name), *cells))
    write_table("film_error_ranges", header, rows)


def error_figure():
    """Draw film_error.svg from film_error.csv."""
    error = {
        (float(row["M"]), float(row["L"])): {
            name: float(row[name] or "nan") / 100 for name in FORMULAS
        }
        for row in read_table("film_error")
    }
    made = Figure(figsize=(8.75, 4.6), layout="constrained")
    axes = made.subplots(2, 5, sharex=True, sharey=True)
    x = np.arange(len(LOADS))
    y = np.arange(len(OILS))
    for axis, name in zip(axes.flat, FORMULAS, strict=True):
        value = 100 * np.array([[error[M, L][name] for M in LOADS] for L in OILS])
        image = axis.imshow(
            value, "RdBu", vmin=-50, vmax=50, aspect="auto", origin="lower", interpolation="none"
        )
        axis.contour(x, y, value, levels=[-10, 10], colors=BLACK, linewidths=0.7)
        axis.set_title(f"{name}\n({location(name)})", fontsize=6.5)
        axis.set_xticks(x[::3], [f"{M:g}" for M in LOADS[::3]])
        axis.set_yticks(y, [f"{L:g}" for L in OILS])
    for axis in axes[-1]:
        axis.set_xlabel("M")
    for row in axes:
        row[0].set_ylabel("L")
    made.colorbar(image, ax=axes, label="error of the formula, %", extend="both", shrink=0.8)
    save_figure(made, "film_error")


# Solver --------------------------------------------------------------------------------------------------------------


def limits_table():
    rows = []

    def row(what, found, known, source):
        rows.append(
            (what, f"{found:.6g}", f"{known:.6g}", f"{100 * (found / known - 1):+.2g}", source)
        )

    light = solve_line_contact(1e-6, 0.0, accuracy=1e-6)
    closed = "closed form"
    row(
        "rigid, isoviscous: 2 H M, minimum (Martin)",
        2e-6 * light.thickness["minimum"],
        4.894968495,
        closed,
    )
    row("rigid, isoviscous: H M, dp/dx = 0", 1e-6 * light.thickness["dp/dx = 0"], 3.0, closed)
    for gV, hhat in (
        (5.62040476, 6.681369413),
        (9.683087826, 8.120822605),
        (14.69914773, 10.06600379),
    ):
        M = 1e-4
        contact = solve_line_contact(M, gV / math.sqrt(2) / M**1.5, accuracy=1e-6)
        row(
            f"rigid, Barus: 2 H M at g_V = {gV:.4g}",
            2 * M * contact.thickness["minimum"],
            hhat,
            closed,
        )
    for L in (0.0, 15.0):
        contact = solve_line_contact(200.0, L, accuracy=ACCURACY)
        middle = float(np.interp(0.0, contact.x, contact.pressure))
        row(
            f"heavy: P in the middle, M = 200, L = {L:g}",
            middle,
            math.sqrt(200 / (2 * math.pi)),
            "Hertz",
        )
    for M in (20.0, 200.0):
        film = solve_line_contact(M, 0.0, accuracy=ACCURACY).thickness
        row(
            f"soft: H M^0.2, minimum, M = {M:g}",
            film["minimum"] * M**0.2,
            3.10 / 2**0.6,
            "fit, Herrebrugh",
        )
        row(f"soft: H M^0.2, dp/dx = 0, M = {M:g}", film["dp/dx = 0"] * M**0.2, 2.621, "fit, Moes")
    write_table(
        "reynolds_line_limits", ("quantity", "solved", "known", "difference_%", "from"), rows
    )


def halving_table():
    """What halving all elements again and again changes, for one and the same problem."""
    rows = []
    for M, L in ((0.5, 0.0), (20.0, 0.0), (0.5, 15.0), (2.0, 8.0), (20.0, 15.0)):
        law = (lambda P, L=L: L * P) if L > 0 else None
        problem = solver._Problem(M, law, None, fraction=1.0, floor=5e-5)
        state = solver._along_the_path(problem, 24)
        films = []
        for _ in range(4):
            films.append(np.array(list(solver._films(state).values())))
            state = solver._solved(state.bisected(), problem, 1e-8)
        change = np.abs(np.diff(films, axis=0)) / films[-1]
        for k, name in enumerate(LOCATIONS):
            rows.append((f"{M:g}", f"{L:g}", name, *(f"{value:.1e}" for value in change[:, k])))
    header = ("M", "L", "film", "24 to 48 elements", "48 to 96", "96 to 192")
    write_table("reynolds_line_halving", header, rows)


def spike_table():
    """Height of the pressure spike and film against the floor of the fluidity."""
    rows = []
    for L in (8.0, 9.0, 9.2, 9.4, 10.0, 12.0):
        contacts = [
            solve_line_contact(2.0, L, accuracy=accuracy) for accuracy in (2e-3, 2e-4, 2e-5)
        ]
        hertz = math.sqrt(2.0 / (2 * math.pi))
        rows.append(
            (
                f"{L:g}",
                *(f"{np.max(contact.pressure) / hertz:.2f}" for contact in contacts),
                *(f"{contact.thickness['dp/dx = 0']:.5f}" for contact in contacts),
            )
        )
    floors = ("1e-4", "1e-5", "1e-6")
    header = ("L", *(f"spike/Hertz, floor {f}" for f in floors), *(f"H, floor {f}" for f in floors))
    write_table("reynolds_line_spike", header, rows)


def oil_table():
    """Film of the paper's inner contact with the oil's laws; micrometres."""
    rows = []
    for temperature, force in itertools.product((30.0, 50.0, 70.0), (100.0, 300.0, 518.0)):
        oil = mil_prf_7808.at(273.15 + temperature)
        given = (force / 0.015, 29.8, RADIUS, MODULUS, oil.viscosity, oil.pressure_viscosity)
        speeds = 2 * oil.viscosity * 29.8 / (MODULUS * RADIUS)
        M = given[0] / (MODULUS * RADIUS) / math.sqrt(speeds)
        L = oil.pressure_viscosity * MODULUS * speeds**0.25
        films = [
            ReynoldsLine(thickness="dp/dx = 0", law=law, compressible=compressible).film_thickness(
                *given
            )
            for law, compressible in ((Barus(), False), (Roelands(), False), (Roelands(), True))
        ]
        moes = FORMULAS["moes"].film_thickness(*given)
        rows.append(
            (
                f"{temperature:g}",
                f"{force:g}",
                f"{M:.2f}",
                f"{L:.1f}",
                *(f"{1e6 * h:.3f}" for h in (*films, moes)),
            )
        )
    header = ("degC", "force_N", "M", "L", "Barus", "Roelands", "Roelands, compressible", "moes")
    write_table("reynolds_line_oil", header, rows)


def plot():
    """Draw film_error.svg and film_error_pressure.svg."""
    error_figure()
    pressure_figure()


def pressure_figure():
    """Draw film_error_pressure.svg."""
    made, (left, middle, right) = figure(3, width=2.6, height=2.6)
    for axis, M, oils in (
        (left, 0.5, (0.0, 15.0)),
        (middle, 2.0, (0.0, 9.0)),
        (right, 20.0, (0.0, 5.0, 15.0)),
    ):
        width = math.sqrt(8 * M / math.pi)
        hertz = math.sqrt(M / (2 * math.pi))
        film = axis.twinx()
        film.spines["right"].set_visible(True)
        for L, color in zip(oils, (BLUE, ORANGE, GREEN), strict=False):
            contact = solve_line_contact(M, L, accuracy=1e-3)
            axis.plot(contact.x / width, contact.pressure / hertz, color=color, label=f"L = {L:g}")
            film.plot(
                contact.x / width,
                contact.film / contact.thickness["minimum"],
                ":",
                color=color,
                linewidth=0.9,
            )
        x = np.linspace(-1, 1, 101)
        axis.plot(x, np.sqrt(1 - x**2), color=PURPLE, linewidth=0.7)
        axis.set(
            xlim=(-4, 2.5) if M < 1 else (-2.5, 1.8),
            ylim=(0, 2.2),
            xlabel="x/b",
            title=f"M = {M:g}",
        )
        film.set_ylim(0, 6)
        axis.legend(loc="upper left")
    left.set_ylabel("pressure over Hertz's largest")
    film.set_ylabel("film over its minimum (dotted)")
    save_figure(made, "film_error_pressure")


if __name__ == "__main__":
    films, error = errors()
    error_tables(films, error)
    limits_table()
    halving_table()
    spike_table()
    oil_table()
