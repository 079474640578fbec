"""Write the table torque_speed.csv: which loss rises faster with speed than the terms of SKF's formula.

Three bearings in a bath of 20 mm2/s at 0.03 of the static rating, as ``torque_bench`` writes them. Rolling resistance
is divided into that of loaded rollers and of rollers that centrifugal force alone presses on the outer ring, whose
inner contact has less than 2 % of the largest force.
"""

import math

import numpy as np
from output import write_table
from torque_bench import scene

from rollslip.bearing.assembly import assemble
from rollslip.studies.steady_slip.torque import Duty
from rollslip_plugins.torque import Skf
from rollslip_studies.motion.losses import power_balance
from rollslip_studies.steady_slip.study import SteadySlip

BEARINGS = ("NU210", "NU2216", "NU1012")
#: n d_m [mm/min].
SPEEDS = (1e5, 2e5, 3.5e5, 4.6e5, 6e5, 7.5e5)
#: Speeds between which exponents of speed are taken.
FIRST, LAST = 3.5e5, 6e5
#: Fraction of the largest force on the inner ring from which a roller is loaded.
LOADED = 0.02


def torques(bearing):
    """Torque [N m] in all, of rolling of loaded and of other rollers, and churning, at the steady slip."""
    balance, motions, _ = SteadySlip(pockets="set").steady(bearing)
    orbit = balance.orbit(max(motions[0].slip, 1e-5))
    losses = {loss.source: loss.power for loss in power_balance(balance, orbit).losses}
    resistances = balance.forces(orbit)[1]
    speeds = bearing.kinematics.surface_speeds(orbit.cage_slip, orbit.roller_slip)
    power = np.abs(resistances) * np.abs([speeds.inner_rolling, speeds.outer_rolling])
    is_loaded = orbit.force[0] > LOADED * orbit.force[0].max()
    loaded = float(power[:, is_loaded].sum() / power.sum())
    rolling = sum(loss for name, loss in losses.items() if "rolling-resistance" in name)
    turns = bearing.scene.operation.inner_speed
    parts = (sum(losses.values()), loaded * rolling, (1.0 - loaded) * rolling, losses["churning"])
    return np.array(parts) / turns


def rows():
    """Yield the rows of the table."""
    for name in BEARINGS:
        found = {}
        for n_dm in SPEEDS:
            bearing = assemble(scene(name, n_dm, 1, 1, "bath"))
            terms = Skf().terms(Duty.of(bearing))
            whole, loaded, others, churning = torques(bearing)
            found[n_dm] = (loaded, others, loaded + others, terms["rolling"], churning)
            ratios = (
                whole / sum(terms.values()),
                (loaded + others) / terms["rolling"],
                loaded / terms["rolling"],
                others / terms["rolling"],
                churning / terms["oil drag"],
            )
            yield [name, f"{n_dm:g}", *(f"{ratio:.2f}" for ratio in ratios)]
        exponents = np.log(np.divide(found[LAST], found[FIRST])) / math.log(LAST / FIRST)
        loaded, others, rolling, skf, churning = (f"{value:.2f}" for value in exponents)
        yield [
            name,
            "exponent of speed",
            "",
            f"{rolling} (SKF {skf})",
            loaded,
            others,
            churning,
        ]


write_table(
    "torque_speed",
    [
        "bearing",
        "n d_m [mm/min]",
        "torque over SKF's",
        "rolling over SKF's",
        "of loaded rollers",
        "of other rollers",
        "churning over SKF's drag",
    ],
    list(rows()),
)
