"""Write the tables torque_bench*.csv: the default friction torque of every catalogue bearing beside makers' formulas.

    python docs/scripts/torque_bench.py

Every bearing, as ``rollslip new`` writes its scene with a polyamide cage, at n d_m of 3.5e5, 4.6e5 and 6e5 mm/min: a
bath with three oils times three loads, each other kind of supply with three pairs of these. Below, at 5e4 to 2e5, the
bath alone is reported and not judged. The torque is the sum of the losses at the cage slip where the rollers carry the
drag, looked for by secants from 2 % on; where they carry it at no slip up to 90 %, or run away, it is that at 2 %. No
fold is looked for, and a pitch has two instants, which moves the torque by less than 1 %.

What it is held against is the geometric mean of ISO 15312's formula and of SKF's with the drag of the later catalogues,
both with series and boundary dimensions of the designation and with the kind of supply. Neither is a measured torque of
a bearing. About five minutes on two cores.
"""

import math
import sys
from concurrent.futures import ProcessPoolExecutor
from functools import cache

import numpy as np
from output import write_table

from rollslip import evolve
from rollslip.bearing.assembly import assemble
from rollslip.errors import RollslipError
from rollslip.motion.losses import power_balance
from rollslip.motion.torque_balance import TorqueBalance
from rollslip.planning.new_scene import new_scene
from rollslip.scene.reading import parse_scene
from rollslip.structure import Location, structure
from rollslip.studies.steady_slip.minimum_load import static_rating
from rollslip.studies.steady_slip.study import SteadySlip
from rollslip.studies.steady_slip.torque import Duty
from rollslip_plugins.data.cylindrical import CATALOGUE
from rollslip_plugins.torque import Palmgren, Skf

#: n d_m [mm/min] that are judged, and that are only reported.
SPEEDS, SLOW = (3.5e5, 4.6e5, 6e5), (5e4, 1e5, 2e5)
#: Oil and temperature, kinematic viscosities of about 9, 20 and 75 mm2/s.
OILS = (("iso-vg-32", "80 degC"), ("iso-vg-68", "70 degC"), ("iso-vg-220", "60 degC"))
#: Radial load over the static rating.
LOADS = (0.01, 0.03, 0.1)
SUPPLIES = ("bath", "splash", "circulating", "jet", "mist", "grease")
#: What is asked of the torque over that of the formulas: 99 of 100 between these, and the median between those.
WITHIN, MEDIAN = (0.5, 1.6), (0.75, 1.1)
#: Cage slip where secants begin, how close they come, and where they give up.
_FIRST, _CLOSE, _FARTHEST, _INSTANTS = 0.02, 0.02, 0.9, 2


def bearings():
    """Names of bearings with an inside of their own, one of each series and size: types differ in their ribs alone."""
    return [name for name in CATALOGUE.names if name.startswith("NU") and not name.startswith("NUP")]


@cache
def written(name, oil, temperature):
    """The scene that is written for a bearing."""
    asked = {"oil": oil, "speed": "3000 rpm", "load": "1 kN", "temperature": temperature, "cage": "polyamide"}
    return parse_scene(new_scene(name, bearing=name, **asked), name)


def scene(name, oil, temperature, n_dm, share, supply, drags=None):
    """A bearing at work; ``drags`` replace those of the scene."""
    one = written(name, oil, temperature)
    listed = one.bearing.catalogue
    speed = n_dm / (500.0 * (listed.bore + listed.outside_diameter)) * math.pi / 30.0
    changes = {"operation.inner_speed": speed, "operation.radial_load": share * static_rating(one.bearing)}
    if hasattr(one, "lubrication"):
        changes["lubrication.supply"] = supply
    if drags is not None:
        changes["cage.drag"] = drags
    return evolve(one, changes)


def torque(one):
    """Friction torque [N m] of a scene, and whether the rollers carry the drag at the slip that it is of."""
    made = assemble(one).with_resistance()
    settings = structure(SteadySlip, one.study["steady-slip"], Location({}), [])
    balance = TorqueBalance(made, made.cage.drags, instants=_INSTANTS, inertia=settings.inertia)

    def of(slip):
        return sum(loss.power for loss in power_balance(balance, balance.orbit(slip)).losses) / abs(
            one.operation.inner_speed - one.operation.outer_speed
        )

    low, high = 0.0, _FIRST
    try:
        below, above = balance.excess(1e-4), balance.excess(high)
        while above < 0.0 and high < _FARTHEST:  # the slip is larger
            low, below = high, above
            high = min(2.5 * high, _FARTHEST)
            above = balance.excess(high)
        if above < 0.0:
            return of(_FIRST), False
        while high - low > _CLOSE * high and abs(high - low) > 1e-3:
            at = low - below * (high - low) / (above - below)
            at = min(max(at, low + 0.1 * (high - low)), high - 0.1 * (high - low))
            excess = balance.excess(at)
            low, below, high, above = (low, below, at, excess) if excess > 0.0 else (at, excess, high, above)
        return of(0.5 * (low + high)), True
    except RollslipError:
        return of(_FIRST), False


def formulas(one, supply):
    """Torque [N m] by ISO 15312's formula and by SKF's."""
    import attrs

    duty = attrs.evolve(Duty.of(assemble(one)), supply=supply)
    return [sum(formula.terms(duty).values()) for formula in (Palmgren(), Skf())]


def states(name):
    """States of a bearing: n d_m, oil, load, supply, and whether it is judged."""
    pairs = [(oil, load) for oil in range(3) for load in range(3)]
    for n_dm in SPEEDS:
        yield from ((n_dm, oil, load, "bath") for oil, load in pairs)
        yield from ((n_dm, k, (k + of) % 3, supply) for of, supply in enumerate(SUPPLIES[1:]) for k in range(3))
    yield from ((n_dm, oil, oil, "bath") for n_dm in SLOW for oil in range(3))


def held(name, drags=None, only=None):
    """Rows of a bearing: series, bore, n d_m, oil, load, supply, torque over both formulas, and whether it is carried."""
    rows = []
    for n_dm, oil, load, supply in states(name) if only is None else only:
        one = scene(name, *OILS[oil], n_dm, LOADS[load], supply, drags)
        own, carried = torque(one)
        iso, skf = formulas(one, supply)
        listed = one.bearing.catalogue
        rows.append((listed.series, 1e3 * listed.bore, n_dm, oil, load, supply, own / iso, own / skf, carried))
    return rows


def shares(rows):
    """Torque over the geometric mean of the formulas."""
    return np.array([math.sqrt(row[6] * row[7]) for row in rows])


def told(rows):
    """Cells of some states: their number, median, what 1 and 99 of 100 are below, share within, and over each formula."""
    if not rows:
        return ["0", *[""] * 6]
    over = shares(rows)
    within = np.mean((over >= WITHIN[0]) & (over <= WITHIN[1]))
    quantiles = np.quantile(over, (0.5, 0.01, 0.99))
    each = [np.median([row[k] for row in rows]) for k in (6, 7)]
    return [
        str(len(rows)),
        *(f"{value:.2f}" for value in quantiles),
        f"{100 * within:.1f}",
        *(f"{m:.2f}" for m in each),
    ]


HEAD = ["states", "median", "1 of 100 below", "99 of 100 below", "within 0.5 to 1.6 [%]", "over ISO 15312", "over SKF"]


def groups(rows):
    """What is told apart: by, of, and which rows."""
    judged = [row for row in rows if row[2] in SPEEDS]
    yield "all", "all", judged
    for series in ("10", "2", "22", "3", "23", "4"):
        yield "series", series, [row for row in judged if row[0] == series]
    for low, high in ((0, 25), (25, 50), (50, 100), (100, 1e3)):
        yield (
            "bore [mm]",
            f"{low:g} to {high:g}" if high < 1e3 else f"over {low:g}",
            [row for row in judged if low < row[1] <= high],
        )
    for n_dm in SPEEDS:
        yield "n d_m [mm/min]", f"{n_dm:.2g}", [row for row in judged if row[2] == n_dm]
    for supply in SUPPLIES:
        yield "supply", supply, [row for row in judged if row[5] == supply]
    for k, (oil, temperature) in enumerate(OILS):
        yield "oil", f"{oil} at {temperature}", [row for row in judged if row[3] == k]
    for k, load in enumerate(LOADS):
        yield "load over C0", f"{load:g}", [row for row in judged if row[4] == k]
    for n_dm in SLOW:
        yield "n d_m [mm/min], not judged", f"{n_dm:.2g}", [row for row in rows if row[2] == n_dm]


def every(drags=None):
    """Rows of all bearings."""
    with ProcessPoolExecutor(2) as pool:
        return [row for rows in pool.map(held, bearings(), [drags] * len(bearings()), chunksize=4) for row in rows]


def main():
    """Write the table, and beside it what the drags of ``sys.argv`` give, such as those of an earlier version."""
    rows = every(drags=[word for word in sys.argv[1].split(",") if word] if sys.argv[1:] else None)
    table = [[by, of, *told(some)] for by, of, some in groups(rows)]
    table.append(["no steady slip, torque at 2 %", "all", str(sum(not row[8] for row in rows)), *[""] * 6])
    write_table("torque_bench" if not sys.argv[2:] else sys.argv[2], ["by", "of", *HEAD], table)


if __name__ == "__main__":
    main()
