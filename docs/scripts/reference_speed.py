"""Write the table reference_speed.csv of docs/theory/heat.rst: speeds at the reference conditions of ISO 15312.

There a bearing in a bath of oil of 12 mm2/s is at 70 degC in surroundings of 20 degC, carries a twentieth of its
static rating, and its seats let 16 kW/m2 through, less above 0.05 m2. The speed at which that is what it loses is
looked for by Palmgren's formula with the factors of the series, by SKF's, and by the losses of a steady slip with all
drags of the box (land, churning, rolling resistance). Clearance and inner geometry are those of the catalogue,
estimated (D). About a minute.
"""

import math

from output import write_table
from scipy.optimize import brentq

from rollslip import evolve, plan
from rollslip.planning.new_scene import new_scene
from rollslip.scene.reading import parse_scene
from rollslip.studies.steady_slip.minimum_load import static_rating
from rollslip.studies.steady_slip.study import SteadySlip
from rollslip.studies.steady_slip.torque import Duty
from rollslip.studies.thermal_balance.balance import Heated
from rollslip_plugins.thermal import Given
from rollslip_plugins.torque import Palmgren, Skf

#: Name -> series, bore, outside diameter and width [mm].
BEARINGS = {
    "NU1010": ("10", 50, 80, 16), "NU210": ("2", 50, 90, 20), "NU2210": ("22", 50, 90, 23), "NU310": ("3", 50, 110, 27),
    "NU2310": ("23", 50, 110, 40), "NU1020": ("10", 100, 150, 24), "NU220": ("2", 100, 180, 34),
    "NU320": ("3", 100, 215, 47),
}  # fmt: skip
#: Series -> factors f_0 and f_1 of ISO 15312 for an oil bath, recalled (C).
FACTORS = {"10": (2, 2e-4), "2": (2, 3e-4), "22": (3, 4e-4), "3": (2, 3.5e-4), "23": (4, 4e-4)}
FLUX, AREA, LESS = 1.6e4, 0.05, -0.34
DRAGS = ["petroff-land", "churning", "rolling-resistance"]


def scene(name):
    """The bearing at the reference conditions, at any speed, as ``rollslip new`` writes it."""
    asked = {"oil": "iso-vg-32", "speed": "3000 rpm", "load": "1 kN", "temperature": "70 degC", "cage": "brass"}
    written = parse_scene(new_scene(name, bearing=name, **asked), name)
    load = 0.05 * static_rating(written.bearing)
    return evolve(written, {"operation.radial_load": load, "cage.drag": DRAGS, "accuracy.tolerance": 0.01})


def lost(one, speed):
    """Power that the bearing loses at a steady slip [W]."""
    made = plan(evolve(one, {"operation.inner_speed": speed}), "steady-slip").assembly
    return Heated(made, Given(), SteadySlip()).given().power.total


def row(name, series, bore, outside, width):
    """Cells of a bearing."""
    one = scene(name)
    area = math.pi * 1e-6 * width * (bore + outside)
    carried = FLUX * (min(area, AREA) if area <= AREA else area * (area / AREA) ** LESS)
    made = plan(one, "steady-slip").assembly
    own = Duty.of(made)
    nu = own.kinematic_viscosity

    def by(formula):
        def excess(speed):
            duty = Duty(
                bore=1e-3 * bore,
                outside_diameter=1e-3 * outside,
                pitch_diameter=0.5e-3 * (bore + outside),
                radial_load=own.radial_load,
                speed=speed,
                viscosity=12e-6 * own.density,
                density=own.density,
            )
            return sum(formula.terms(duty).values()) * speed - carried

        return brentq(excess, 1.0, 1e4)

    f_0, f_1 = FACTORS[series]
    palmgren, skf = by(Palmgren(oil_factor=f_0, load_factor=f_1)), by(Skf(series=series))
    ours = brentq(lambda speed: lost(one, speed) - carried, 0.2 * palmgren, 4.0 * palmgren, xtol=1.0)
    rpm = [f"{speed * 30 / math.pi:.0f}" for speed in (palmgren, skf, ours)]
    return [name, f"{carried:.0f}", f"{own.radial_load:.0f}", f"{1e6 * nu:.1f}", *rpm, f"{ours / palmgren:.2f}"]


def main():
    """Write the table."""
    write_table(
        "reference_speed",
        ["bearing", "carried away [W]", "load [N]", "oil of the losses [mm2/s]", "Palmgren [1/min]", "SKF [1/min]",
         "losses here [1/min]", "over Palmgren"],
        [row(name, *rest) for name, rest in BEARINGS.items()],
    )  # fmt: skip


if __name__ == "__main__":
    main()
