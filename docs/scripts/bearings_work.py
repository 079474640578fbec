"""Write docs/tables/bearings_work.csv and its figure: work and precision over eight bearings.

The bearings differ in size from 26 to 323 mm, in speed from 10 to 10,000 rpm, and in regime from a boundary film under
heavy load to a thick film under nearly none. Each is run, in study ``effective-friction`` with a tolerance of 1e-3, by
``rollslip pareto`` with all choices of slices, points and positions: its front, what the plan chose, and the cheapest
choice that would have kept the tolerance in friction and in both critical slips.

Numbers of rollers and raceways are from makers' catalogues, where lengths and numbers are not printed estimated from
their static ratings by ISO 76; 1032930 is the shipped one; the aircraft bearing is the one of Harris's skidding rig,
from memory. Speeds, loads, oils and roughness are made up, as typical of the machine that is named. Every bearing that
is done is kept in build/bearings; remove it to measure anew. Times are those of one core of a machine that others used,
too.
"""

import numpy as np
from output import BLACK, BLUE, DOCS, GREEN, ORANGE, PURPLE, figure, save_figure, write_table

from rollslip import evolve, load_scene, run
from rollslip_campaigns.pareto import ParetoSettings
from rollslip_campaigns.pareto.findings import rows_of_kinds, studies
from rollslip_campaigns.pareto.pareto import run_family

KEPT = DOCS.parent / "build" / "bearings"
TOLERANCE = 1e-3
ROUNDS = 3
#: Machine -> bearing, rollers, their diameter and length, inner raceway [mm]; rpm, load [N], degC, oil, roughness of
#: raceways and rollers [um], closure, film.
BEARINGS = {
    "electric motor": (
        "NU204 E",
        11,
        7.5,
        8.0,
        26.5,
        3000,
        200,
        70,
        "iso-vg-68",
        0.1,
        "epicyclic",
        "moes",
    ),
    "gearbox": (
        "NU210 E",
        17,
        11.0,
        11.0,
        59.5,
        3000,
        15e3,
        80,
        "iso-vg-150",
        0.2,
        "epicyclic",
        "moes",
    ),
    "gas turbine": (
        "1032930",
        28,
        15.0,
        15.0,
        165.0,
        6371,
        1037,
        50,
        "mil-prf-7808",
        0.12,
        "outer-rolling",
        "moes",
    ),
    "spindle": (
        "NU1030",
        25,
        18.0,
        16.4,
        169.5,
        3000,
        2e3,
        40,
        "iso-vg-32",
        0.08,
        "free-roller",
        "dowson-toyoda",
    ),
    "wind gearbox": (
        "NU2316 E",
        13,
        25.0,
        37.5,
        101.0,
        1500,
        3e3,
        65,
        "iso-vg-320",
        0.15,
        "free-roller",
        "moes",
    ),
    "mill": (
        "NU240 E",
        19,
        40.0,
        36.9,
        243.0,
        60,
        250e3,
        60,
        "iso-vg-320",
        0.3,
        "epicyclic",
        "dowson-1968",
    ),
    "crane": (
        "NU2326 E",
        14,
        40.0,
        61.9,
        167.0,
        10,
        400e3,
        80,
        "iso-vg-220",
        0.3,
        "outer-rolling",
        "regime",
    ),
    "aircraft": (
        "skid rig",
        36,
        14.0,
        20.0,
        169.0,
        10e3,
        900,
        100,
        "mil-prf-23699",
        0.06,
        "outer-rolling",
        "regime",
    ),
}
PARTS = "inner_raceway_roughness", "outer_raceway_roughness", "roller_roughness"
AXES = "slices", "quadrature", "n_positions"
#: Machine -> colour and line.
LINES = dict(
    zip(BEARINGS, [(c, s) for s in ("-", "--") for c in (BLUE, ORANGE, GREEN, PURPLE)], strict=True)
)


def scene(machine):
    """The scene of a bearing."""
    _, rollers, diameter, length, inner, speed, load, temperature, oil, rough, closure, film = (
        BEARINGS[machine]
    )
    return evolve(
        load_scene("1032930-70C"),
        {
            "bearing.rollers": rollers,
            "bearing.roller_diameter": f"{diameter} mm",
            "bearing.roller_length": f"{length} mm",
            "bearing.inner_raceway_diameter": f"{inner} mm",
            "bearing.outer_raceway_diameter": f"{inner + 2 * diameter} mm",
            "bearing.profile": "iso16281",
            "operation": {
                "inner_speed": f"{speed} rpm",
                "outer_speed": "0 rpm",
                "radial_load": f"{load} N",
                "temperature": f"{temperature} degC",
            },
            "lubricant": {"name": oil, "eyring_stress": "4 MPa", "shear_modulus": "0.3 GPa"},
            "surface": dict.fromkeys(PARTS, f"{rough} um"),
            "models.film": film,
            "models.traction": {
                "model": "lambda-blend",
                "boundary": "kragelsky",
                "hydrodynamic": "muraki",
            },
            "accuracy": {"tolerance": TOLERANCE, "slices": "auto"},
            "study": {"effective-friction": {"closure": closure, "max_cage_slip": 0.6}},
        },
        si=True,
    )


def worst(choice):
    """The largest error of a choice, of friction and critical slips."""
    return float(np.nanmax(choice["error"].values))


def main():
    rows = []
    made, axes = figure(width=6.4, height=3.6)
    for machine in BEARINGS:
        family = ParetoSettings(
            scene(machine), study="effective-friction", choices=AXES, rounds=ROUNDS
        ).plan()
        dataset = run_family(family, KEPT / machine.replace(" ", "-"), lambda *_: None)
        ((_, one),) = studies(dataset)
        choices = [one.isel(choice=k) for k in rows_of_kinds(one, "numerical")]
        points = sorted(
            (float(choice["seconds"]), worst(choice), choice["label"].item()) for choice in choices
        )
        planned = next(point for point in points if point[2] == "as planned")
        cheapest = next(point for point in points if point[1] <= TOLERANCE)
        rows.append(
            (*what(machine), resolution(one), *cells(planned), cheapest[2], *cells(cheapest))
        )
        rows[-1] += (f"{planned[0] / cheapest[0]:.1f}",)
        print(*rows[-1], sep=" | ", flush=True)
        draw(axes, machine, points, planned)
    axes.axhline(TOLERANCE, color="0.6", linewidth=0.8)
    axes.set(
        xscale="log", yscale="log", xlabel="Time of the processor [ms]", ylabel="Largest error"
    )
    made.legend(*axes.get_legend_handles_labels(), loc="outside right center")
    save_figure(made, "bearings_work")
    shape = (
        "machine",
        "bearing",
        "n_dm [mm/min]",
        "load_[kN]",
        "film_parameter",
        "load_parameter",
        "closure",
    )
    planned = "planned", "planned: time_[ms]", "planned: error"
    cheapest = (
        "cheapest within 1e-3",
        "cheapest: time_[ms]",
        "cheapest: error",
        "planned over cheapest",
    )
    write_table("bearings_work", (*shape, *planned, *cheapest), rows)


def what(machine):
    """What a bearing is, and in which regime its contacts run without slip."""
    bearing, _, diameter, _, inner, speed, load, *_, closure, _ = BEARINGS[machine]
    found = run(scene(machine), "effective-friction").isel(cage_slip=0)
    ranges = (between(found[name].values) for name in ("film_parameter", "load_parameter"))
    return (
        machine,
        bearing,
        f"{speed * (inner + diameter):.1e}",
        f"{load / 1e3:g}",
        *ranges,
        closure,
    )


def between(values):
    """The range of values."""
    return f"{np.nanmin(values):.2g}–{np.nanmax(values):.2g}"


def resolution(one):
    """What the plan chose."""
    planned = one.sel(choice="as planned")
    kind = {"equal": "slices", "gauss": "Gauss points"}[planned["quadrature"].item()]
    n_positions = planned["n_positions"].item()
    return f"{planned['slices'].item()} {kind}, {n_positions} position{'s' * (n_positions != 1)}"


def cells(point):
    """Time [ms] and error as text."""
    return f"{1e3 * point[0]:.1f}", f"{point[1]:.1e}"


def draw(axes, machine, points, planned):
    """Draw the front of a bearing, and the plan's choice."""
    color, style = LINES[machine]
    front = []
    best = np.inf
    for seconds, error, _ in points:
        if 0.0 < error < best:
            best = error
            front.append((1e3 * seconds, error))
    axes.plot(*zip(*front, strict=True), style, color=color, label=machine)
    axes.plot(1e3 * planned[0], planned[1], "o", color=color, markeredgecolor=BLACK, markersize=5)


if __name__ == "__main__":
    main()
