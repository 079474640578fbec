"""Write the tables measured_torque.csv and printed_resistance.csv of docs/trust/oil_supply.rst.

They hold laws of the rolling resistance against a measured friction torque, and against printed solutions of a contact.

A tapered roller bearing 32216 under 6 kN axial load in half a bath of FVA 3 (Wingertszahn and others, Lubricants 11
(2023) 369, CC BY 4.0; torques read from figure 5 with 4 to 8 % by a third party, geometry and profile of its tables).
All rollers carry the same, so that a cylindrical row of rollers 17 x 22.7 mm on raceways of 91.5 and 125.5 mm with
1.55 kN a roller stands for it. Ribs, cage and churning are left out.

The printed solutions are those of table 1 of Zhou and Hoeprich, J. Tribol. 113 (1991) 590.
"""

import math
import sys
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

from rollslip import Chain, Conditions, Slices, get_model
from rollslip.bearing.approach import film_deflection

sys.path.insert(0, str(Path(__file__).parent))
from output import write_table

INNER = 0.04575
OUTER = 0.06275
ROLLER = 0.0085
LENGTH = 0.0227
ROLLERS = 16
FORCE = 1550.0
#: Length over which the printed profile holds [m]; beyond it the roller is rounded off.
PROFILE_LENGTH = 0.0207
SLICES = 400
#: Speed [1/min], viscosity of FVA 3 at 50 and 42 degC [Pa s] and measured torque [N m].
MEASURED = ((500, 0.0524, 1.30), (2000, 0.0524, 2.95), (4000, 0.0524, 3.75), (500, 0.074, 1.70))
#: Layer of oil of a bath [m].
LAYER = 5e-6
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


def profiles():
    """Return the drop [m] of half a roller by profile."""
    x = (np.arange(SLICES) + 0.5) / SLICES * LENGTH / 2
    inside = np.minimum(2 * x / PROFILE_LENGTH, 1 - 1e-6)
    rounded = np.where(2 * x > PROFILE_LENGTH, 1e-3, 0.0)
    return {
        "straight": np.zeros(SLICES),
        "ISO/TS 16281": -0.35e-3 * 2 * ROLLER * np.log1p(-((2 * x / LENGTH) ** 2)),
        "printed": -0.5e-3 * 2 * ROLLER * np.log1p(-(inside**2)) + rounded,
    }


def torque(drag, drop, has_film, speed, viscosity):
    """Return the torque [N m] of the rolling resistance of all rollers on both raceways."""
    shaft = speed * math.pi / 30
    rolling = shaft * INNER * OUTER / (INNER + OUTER)
    power = 0.0
    for curvature in (1 / ROLLER + 1 / INNER, 1 / ROLLER - 1 / OUTER):
        oil = Conditions(
            radius=1 / curvature,
            modulus=2.08e11 / 0.91,
            viscosity=viscosity,
            pressure_viscosity=2.1e-8,
            length=LENGTH,
            thermoviscosity=0.045,
            conductivity=0.135,
        )
        contact = get_model("contact", "palmgren")
        law = contact.deflection()
        if has_film:
            film = get_model("film", "inlet-correction", oil_layer=LAYER)
            law, _ = film_deflection(contact, film, oil, rolling, LAYER)
        chain = Chain(law)

        def load_at(approach, chain=chain, oil=oil):
            slices = Slices(SLICES, oil, approach=approach - drop)
            chain(slices)
            return slices.load.copy()

        approach = brentq(lambda a, of=load_at: of(a).mean() * LENGTH - FORCE, 1e-9, 1e-3)
        load = load_at(approach)
        slices = Slices(np.count_nonzero(load), oil, load=load[load > 0.0], rolling_speed=rolling)
        Chain(drag)(slices)
        power += ROLLERS * 2 * rolling * slices.resistance.sum() * LENGTH / SLICES
    return power / shaft


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


def main():
    """Write the ratios of law and measurement."""
    cases = {
        "rolling-resistance, reach 3": (get_model("drag", "rolling-resistance"), True),
        "flooded": (get_model("drag", "rolling-resistance", reach="flooded"), True),
        "goksem-hargreaves, dry": (get_model("drag", "goksem-hargreaves"), False),
        "zhou-hoeprich, dry": (get_model("drag", "zhou-hoeprich"), False),
    }
    rows = []
    for profile, drop in profiles().items():
        for name, (drag, has_film) in cases.items():
            ratios = [
                torque(drag, drop, has_film, speed, viscosity) / measured
                for speed, viscosity, measured in MEASURED
            ]
            rows.append([profile, name, *(f"{ratio:.2f}" for ratio in ratios)])
    heads = [f"{speed} rpm, {'50' if eta < 0.06 else '42'} °C" for speed, eta, _ in MEASURED]
    write_table("measured_torque", ["profile", "law over measurement", *heads], rows)
    write_printed()


if __name__ == "__main__":
    main()
