"""Write the table reference_speed.csv of docs/theory/heat.rst: speeds at the reference conditions of ISO 15312.

There a bearing in a bath of oil of 12 mm2/s is at 70 degC in surroundings of 20 degC, carries a twentieth of its
static rating, and its seats let 16 kW/m2 through, less above 0.05 m2. The speed at which that is what it loses is
looked for by ISO 15312's formula, by SKF's with the drag of an oil bath, and by the losses of a steady slip of the
scene that ``rollslip new`` writes with a brass cage. Clearance and inside are those of the catalogue, estimated (D).
About a minute.
"""

import math

import attrs
from output import write_table
from scipy.optimize import brentq

from rollslip import evolve, plan
from rollslip.planning.new_scene import ASSUMED, new_scene
from rollslip.scene.reading import parse_scene
from rollslip.studies.steady_slip.torque import Duty
from rollslip_plugins.thermal import Given
from rollslip_plugins.torque import Palmgren, Skf
from rollslip_studies.steady_slip.study import SteadySlip
from rollslip_studies.thermal_balance.balance import Heated

BEARINGS = ("NU1010", "NU210", "NU2210", "NU310", "NU2310", "NU1020", "NU220", "NU320")
FLUX = 1.6e4
AREA = 0.05
LESS = -0.34


def scene(name):
    """The bearing at the reference conditions, at any speed, as ``rollslip new`` writes it."""
    requested = {
        "bearing": name,
        "oil": "iso-vg-32",
        "speed": "3000 rpm",
        "load": "1 kN",
        "cage": "brass",
    }
    written = parse_scene(new_scene(name, **(ASSUMED | requested)), name)
    load = 0.05 * written.bearing.static_rating
    return evolve(written, {"operation.radial_load": load, "accuracy.tolerance": 0.01}, si=True)


def lost(one, speed):
    """Power that the bearing loses at a steady slip [W]."""
    made = plan(evolve(one, {"operation.inner_speed": speed}, si=True), "steady-slip").assembly
    return Heated(made, Given(), SteadySlip()).given().power.total


def row(name):
    """Cells of a bearing."""
    one = scene(name)
    own = Duty.of(plan(one, "steady-slip").assembly)
    area = math.pi * own.width * (own.bore + own.outside_diameter)
    carried = FLUX * area * max(area / AREA, 1.0) ** LESS
    nu = own.kinematic_viscosity

    def by(formula):
        def excess(speed):
            duty = attrs.evolve(own, speed=speed, viscosity=12e-6 * own.density)
            return sum(formula.terms(duty).values()) * speed - carried

        return brentq(excess, 1.0, 1e4)

    palmgren = by(Palmgren())
    skf = by(Skf())
    ours = brentq(
        lambda speed: lost(one, speed) - carried, 0.2 * palmgren, 4.0 * palmgren, xtol=1.0
    )
    rpm = [f"{speed * 30 / math.pi:.0f}" for speed in (palmgren, skf, ours)]
    return [
        name,
        f"{carried:.0f}",
        f"{own.radial_load:.0f}",
        f"{1e6 * nu:.1f}",
        *rpm,
        f"{ours / palmgren:.2f}",
    ]


def main():
    """Write the table."""
    write_table(
        "reference_speed",
        ["bearing", "carried away [W]", "load [N]", "oil of the losses [mm2/s]", "ISO 15312 [1/min]", "SKF [1/min]",
         "losses here [1/min]", "over ISO 15312"],
        [row(name) for name in BEARINGS],
    )  # fmt: skip


if __name__ == "__main__":
    main()
