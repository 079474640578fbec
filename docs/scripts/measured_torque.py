"""Write measured_torque.csv of docs/trust/torque.rst and printed_resistance.csv of docs/trust/oil_supply.rst.

They hold laws of the rolling resistance against a measured friction torque, and against printed solutions of a contact.

A tapered roller bearing 32216 under axial and combined load in half a bath of FVA 3 is the data set wingertszahn-2023
(Wingertszahn and others, Lubricants 11 (2023) 369, CC BY 4.0; torques read from figures 5 and 6 with 4 to 8 % by a
third party, geometry and profile of its tables). The cage slips by less than 0.1 %: losses are those at no slip.

The printed solutions are those of table 1 of Zhou and Hoeprich, J. Tribol. 113 (1991) 590.
"""

import sys
from importlib.resources import files
from pathlib import Path

import numpy as np

from rollslip import Chain, Conditions, Slices, evolve, get_model
from rollslip.bearing.assembly import assemble
from rollslip.bearing.resolution import Resolution
from rollslip_campaigns.measurement.reading import load_measurement
from rollslip_studies.motion.losses import power_balance
from rollslip_studies.motion.torque_balance import TorqueBalance

sys.path.insert(0, str(Path(__file__).parent))
from output import write_table

SET = Path(str(files("rollslip_campaigns.measurement.sets"))) / "wingertszahn-2023"
#: Drags of a bath and profile by column. The first column is what a run has by default.
CASES = {
    "default": {},
    "without churning and hysteresis": {"cage.drag": ["rolling-resistance"]},
    "flooded": {"cage.drag": [{"model": "rolling-resistance", "reach": "flooded"}]},
    "goksem-hargreaves": {"cage.drag": ["goksem-hargreaves"]},
    "zhou-hoeprich": {"cage.drag": ["zhou-hoeprich"]},
    "default, straight rollers": {"bearing.profile.shape": "none"},
    "default, 14 deg": {"bearing.contact_angle": "14 deg"},
}
#: Slices and roller positions; twice as many change no ratio in its second digit behind the point.
RESOLUTION = Resolution(slices=101, n_positions=4)
#: Zhou and Hoeprich: radius [m], modulus [Pa], pressure-viscosity coefficient [1/Pa]; the viscosity cancels.
PRINTED_RADIUS = 3.09e-3
PRINTED_MODULUS = 2.34e11
PRINTED_PRESSURE_VISCOSITY = 16e-9
PRINTED_VISCOSITY = 0.05
#: Load w/(E' R) over 1e-4, speed eta0 u/(E' R) over 1e-11, and the printed 2 F R [N m/m].
PRINTED = (
    (1.0, 35, 0.5485),
    (1.5, 35, 0.6135),
    (2.0, 35, 0.6600),
    (2.5, 35, 0.7031),
    (3.0, 35, 0.6933),
    (2.0, 1, 0.0623),
    (2.0, 3, 0.1455),
    (2.0, 10, 0.3172),
    (2.0, 60, 0.8781),
    (2.0, 100, 1.129),
)


def torque(scene):
    """Return the friction torque [N m], the losses over the speed, of a bearing whose cage does not slip."""
    assembly = assemble(scene, RESOLUTION).with_resistance()
    balance = TorqueBalance(assembly, assembly.cage.drags, n_positions=RESOLUTION.n_positions)
    power = power_balance(balance, balance.orbit(0.0)).total
    return power / scene.operation.inner_speed


def printed_resistance(drag, load, speed):
    """Return 2 F R [N m/m] of a law for a line of the printed table."""
    scale = PRINTED_MODULUS * PRINTED_RADIUS
    oil = Conditions(
        radius=PRINTED_RADIUS,
        modulus=PRINTED_MODULUS,
        viscosity=PRINTED_VISCOSITY,
        pressure_viscosity=PRINTED_PRESSURE_VISCOSITY,
        length=0.01,
    )
    slices = Slices(
        1,
        oil,
        load=load * 1e-4 * scale,
        rolling_speed=speed * 1e-11 * scale / PRINTED_VISCOSITY,
    )
    Chain(drag)(slices)
    return 2 * slices.resistance[0] * PRINTED_RADIUS


def write_printed():
    """Write the ratios of law and printed solution."""
    laws = {
        "rolling-resistance, flooded": get_model(
            "drag", "rolling-resistance", inlet_heating="none", reach="flooded"
        ),
        "reach 3": get_model("drag", "rolling-resistance", inlet_heating="none"),
        "goksem-hargreaves": get_model("drag", "goksem-hargreaves", inlet_heating="none"),
        "zhou-hoeprich": get_model("drag", "zhou-hoeprich", inlet_heating="none"),
    }
    rows = [
        [
            load,
            speed,
            printed,
            *(f"{printed_resistance(law, load, speed) / printed:.2f}" for law in laws.values()),
        ]
        for load, speed, printed in PRINTED
    ]
    write_table("printed_resistance", ["1e4 W", "1e11 U", "2 F R, N m/m", *laws], rows)


def write_measured():
    """Write the ratios of calculated and measured torques."""
    rows = []
    for series in load_measurement(SET).series:
        for row in series.rows:
            scene = evolve(series.scene, row.changes, si=True)
            o = scene.operation
            ratios = [torque(evolve(scene, changes)) / row.measured for changes in CASES.values()]
            loads = f"{o.radial_load / 1e3:g} and {o.axial_load / 1e3:g}"
            speed = round(o.inner_speed * 30 / np.pi)
            temperature = round(o.temperature - 273.15)
            rows.append([loads, speed, temperature, row.measured, *(f"{x:.2f}" for x in ratios)])
            print(*rows[-1], sep=" | ", flush=True)
    heads = ["radial and axial load, kN", "rpm", "°C", "measured, N m", *CASES]
    write_table("measured_torque", heads, rows)


def main():
    """Write both tables."""
    write_measured()
    write_printed()


if __name__ == "__main__":
    main()
