"""Write the table default_torque.csv: friction torque by default over ISO 15312's formula.

NU bearings of the catalogue at the reference conditions of ISO 15312: oil of 12 mm2/s at 70 degC, a twentieth of
the static rating, and the speed at which the formula's torque is what 16 kW/m2 of the seats carry off, less above
0.05 m2. Cages are guided by rollers; a land would add to it. The formula is Palmgren's, of tests in oil baths, and not
a measurement of these bearings. Beside it how it changes away from there, and by kind of supply. Each torque is that
of the steady slip with inertia. 21 slices for a roller change it by up to 0.3 % in four states. Three minutes of
one core.
"""

import itertools
import math
import re
from functools import cache

import numpy as np
from output import write_table
from scipy.optimize import brentq

from rollslip import evolve
from rollslip.bearing.assembly import assemble
from rollslip.planning.new_scene import ASSUMED, new_scene
from rollslip.scene.reading import parse_scene
from rollslip_plugins.data.cylindrical import CATALOGUE
from rollslip_plugins.thermal import Given
from rollslip_studies.steady_slip.study import SteadySlip
from rollslip_studies.thermal_balance.balance import Heated

#: Series -> factors f_0r and f_1r of ISO 15312 for an oil bath (B).
FACTORS = {
    "10": (2, 2e-4),
    "2": (2, 3e-4),
    "22": (3, 4e-4),
    "3": (2, 3.5e-4),
    "23": (4, 4e-4),
    "4": (2, 4e-4),
}
#: One in so many designations of the catalogue is computed.
STEP = 5
#: Of a roller.
SLICES = 21
#: Kinds of supply beside a bath to the middle of the lowest roller -> kind, and oil level [m].
SUPPLIES = {
    "a bath of 2 mm": ("bath", 0.002),
    "jet": ("jet", None),
    "mist": ("mist", None),
    "grease": ("grease", None),
}
FLUX = 1.6e4
AREA = 0.05
LESS = -0.34
REQUESTED = {
    "oil": "iso-vg-32",
    "speed": "3000 rpm",
    "load": "2 kN",
    "temperature": "70 degC",
    "cage": "polyamide",
}


def by_formula(series, mean, nu, rpm, load):
    """ISO 15312's torque [N m], in mm, mm2/s, 1/min and N."""
    f_0, f_1 = FACTORS[series]
    return 1e-3 * (f_0 * 1e-7 * max(nu * rpm, 2000.0) ** (2 / 3) * mean**3 + f_1 * load * mean)


@cache
def scene(name):
    """A bearing as ``rollslip new`` writes it, with a twentieth of its static rating."""
    requested = ASSUMED | REQUESTED | {"bearing": name, "supply": "bath"}
    made = parse_scene(new_scene(name, **requested), name)
    own = {"operation.radial_load": 0.05 * made.bearing.static_rating, "accuracy.slices": SLICES}
    return evolve(made, own, si=True)


@cache
def torque(name, rpm, nu, supply=("bath", None)):
    """Friction torque [N m] at a speed [1/min], in an oil of a viscosity [mm2/s], by supply; nan where it skids."""
    one = scene(name)
    oil = assemble(one).lubricant
    changes = {
        "operation.inner_speed": rpm * math.pi / 30.0,
        "lubricant.viscosity_factor": nu * 1e-6 * oil.density(343.15) / oil.at(343.15).viscosity,
        "lubrication.supply": supply[0],
    }
    if supply[1] is not None:
        changes["lubrication.oil_level"] = supply[1]
    bearing = assemble(evolve(one, changes, si=True))
    power = Heated(bearing, Given(), SteadySlip()).given().power
    return math.nan if power is None else power.total / (rpm * math.pi / 30.0)


def reference_speed(series, bore, outside, width, load):
    """Speed [1/min] at which ISO's formula makes as much heat as the seats carry off."""
    area = math.pi * 1e-6 * width * (bore + outside)
    carried = FLUX * (area if area <= AREA else area * (area / AREA) ** LESS)
    mean = 0.5 * (bore + outside)

    def excess(rpm):
        return by_formula(series, mean, 12.0, rpm, load) * rpm * math.pi / 30.0 - carried

    return brentq(excess, 10.0, 1e6)


def spread(values):
    """Median, and from where to where nine of ten lie."""
    low, middle, high = np.nanquantile(values, [0.05, 0.5, 0.95])
    return f"{middle:.2f} ({low:.2f} to {high:.2f})"


def sizes():
    """Name, series, bore, outside diameter and width [mm] of the bearings."""
    for name in CATALOGUE.names[::STEP]:
        series = CATALOGUE.series(name).removesuffix("E")
        is_nu = name.startswith("NU") and not name.startswith("NUP")
        if is_nu and not name.endswith("-old") and series in FACTORS:
            size = re.search(r"(\d+) x (\d+) x (\d+) mm", CATALOGUE[name].description)
            yield name, series, *map(int, size.groups())


def main():
    """Write the table."""
    ratios = {series: [] for series in FACTORS}
    bearings = []
    for name, series, bore, outside, width in sizes():
        load = scene(name).operation.radial_load
        rpm = reference_speed(series, bore, outside, width, load)
        mean = 0.5 * (bore + outside)
        ratios[series].append(torque(name, rpm, 12.0) / by_formula(series, mean, 12.0, rpm, load))
        bearings.append((name, series, mean, load))
    rows = [[f"series {series}", len(found), spread(found)] for series, found in ratios.items()]
    every = list(itertools.chain(*ratios.values()))
    rows.append(["all, at the reference conditions", len(every), spread(every)])
    some = bearings[:: max(len(bearings) // 8, 1)]
    for n_dm in (5e4, 1e5, 2e5, 3.5e5, 5e5, 7.5e5):
        found = [
            torque(name, n_dm / mean, nu) / by_formula(series, mean, nu, n_dm / mean, load)
            for (name, series, mean, load), nu in itertools.product(some, (8.0, 100.0))
        ]
        label = f"n d_m = {n_dm:g} mm/min, oil of 8 and 100 mm2/s"
        rows.append([label, np.isfinite(found).sum(), spread(found)])
    for label, supply in SUPPLIES.items():
        found = [
            torque(name, n_dm / mean, nu, supply) / torque(name, n_dm / mean, nu)
            for (name, _, mean, _), nu, n_dm in itertools.product(
                some[::3], (12.0, 40.0), (2e5, 4.6e5)
            )
        ]
        rows.append([f"{label}, over the bath", len(found), spread(found)])
    write_table("default_torque", ["bearings", "points", "median (5 to 95 %)"], rows)


if __name__ == "__main__":
    main()
