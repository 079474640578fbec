"""Write the tables torque_bench*.csv: the default friction torque of every catalogue bearing beside makers' formulas.

Every bearing, as ``rollslip new`` writes its scene with a polyamide cage, at n d_m of 3.5e5, 4.6e5 and 6e5 mm/min: a
bath with three oils times three loads, each other kind of supply with three pairs of these. Below, at 5e4 to 2e5, the
bath alone is reported and not judged. Beside it stands churning by 2 % of oil alone, what new scenes had before.

The torque is the sum of the losses at the cage slip where the rollers carry the drag, looked for to a twentieth of it,
and at 2 % where that is more: the formulas know no slip, and rollers that skid resist less. What the steady slip
itself gives stands in the last rows. No fold is looked for, a pitch has two instants and a roller 21 slices: of nine
states the torque is within 2.1 % of that of the whole study. Where no motion with inertia of the spin is found the
state is taken without it.

What it is held against is the geometric mean of ISO 15312's formula and of SKF's with the drag of later catalogues,
both with series and boundary dimensions of the designation and the kind of supply. Neither is a measured torque of a
bearing. About five minutes on two cores.
"""

import math
from concurrent.futures import ProcessPoolExecutor
from functools import cache, partial

import attrs
import numpy as np
from output import write_table

from rollslip import evolve
from rollslip.bearing.assembly import assemble
from rollslip.errors import ConvergenceError
from rollslip.planning.new_scene import ASSUMED, new_scene
from rollslip.scene.reading import parse_scene
from rollslip.structure import Location, structure
from rollslip.studies.steady_slip.torque import Duty
from rollslip_plugins.data.cylindrical import CATALOGUE
from rollslip_plugins.torque import Palmgren, Skf
from rollslip_studies.motion.losses import power_balance
from rollslip_studies.motion.torque_balance import TorqueBalance
from rollslip_studies.steady_slip.study import SteadySlip

#: n d_m [mm/min] that are judged, and that are only reported.
SPEEDS = (3.5e5, 4.6e5, 6e5)
SLOW = (5e4, 1e5, 2e5)
#: Oil and temperature: kinematic viscosities of about 9, 20 and 75 mm2/s.
OILS = (("iso-vg-32", "80 degC"), ("iso-vg-68", "70 degC"), ("iso-vg-220", "60 degC"))
#: Radial load over the static rating.
LOADS = (0.01, 0.03, 0.1)
SUPPLIES = ("bath", "splash", "circulating", "jet", "mist", "grease")
#: Dimension series; bearings of the older design without E are apart, because they have less roller in the same size.
SERIES = ("10", "2", "2 old", "22", "3", "3 old", "23", "4")
#: Upper ends of groups of bores [mm].
BORES = (25, 50, 100, 1000)
#: What is asked of the torque over the formulas: this share between these, and the median between those.
WITHIN = (0.5, 1.6)
FRACTION = 0.99
MEDIAN = (0.75, 1.1)
#: What new scenes had before: of drags, and of the film.
BEFORE = {"cage.drag": [{"model": "churning", "oil_fraction": 0.02}], "models.film": "moes"}
#: Least cage slip that is told from none, where the search begins, how close it comes, and where it gives up.
_LEAST = 1e-4
_FIRST = 0.02
_CLOSE = 0.05
_FARTHEST = 0.9
_INSTANTS = 2
_SLICES = 21


@attrs.frozen
class Held:
    """A state of a bearing: what it is, and its torque over that by ISO 15312's formula and by SKF's.

    ``skidding`` is what the torque at the steady slip is of the one that is told, nan where there is no such slip.
    """

    series: str
    bore: float
    n_dm: float
    oil: int
    load: int
    supply: str
    over_iso: float
    over_skf: float
    skidding: float

    @property
    def over(self):
        """Torque over the geometric mean of both."""
        return math.sqrt(self.over_iso * self.over_skf)

    @property
    def judged(self):
        """Whether the state counts for the verdict."""
        return self.n_dm in SPEEDS


def bearings():
    """Names of bearings, one of each series and size: types differ in their ribs alone."""
    return [
        name for name in CATALOGUE.names if name.startswith("NU") and not name.startswith("NUP")
    ]


def states():
    """States of a bearing: n d_m, oil, load and supply."""
    for n_dm in SPEEDS:
        yield from ((n_dm, oil, load, "bath") for oil in range(3) for load in range(3))
        yield from (
            (n_dm, k, (k + of) % 3, supply)
            for of, supply in enumerate(SUPPLIES[1:])
            for k in range(3)
        )
    yield from ((n_dm, k, k, "bath") for n_dm in SLOW for k in range(3))


@cache
def written(name, oil, temperature):
    """The scene that is written for a bearing."""
    requested = {
        "bearing": name,
        "oil": oil,
        "load": "1 kN",
        "temperature": temperature,
        "cage": "polyamide",
    }
    return evolve(
        parse_scene(new_scene(name, **(ASSUMED | requested)), name), {"accuracy.slices": _SLICES}
    )


def scene(name, n_dm, oil, load, supply, **changes):
    """A bearing at work, by numbers of oil and load."""
    one = written(name, *OILS[oil])
    listed = one.bearing.catalogue
    speed = n_dm / (500.0 * (listed.bore + listed.outside_diameter)) * math.pi / 30.0
    at_work = {
        "operation.inner_speed": speed,
        "operation.radial_load": LOADS[load] * one.bearing.static_rating,
    }
    return evolve(one, at_work | {"lubrication.supply": supply} | changes, si=True)


def torque(made):
    """Friction torque [N m] of a bearing at its steady slip or at 2 % if that is less, and at the steady slip."""
    settings = structure(SteadySlip, made.scene.study["steady-slip"], Location({}), [])
    resisting = made.with_resistance()
    balance = TorqueBalance(
        resisting, made.cage.drags, n_positions=_INSTANTS, inertia=settings.inertia
    )
    try:
        return _at_slips(made, balance)
    except (
        ConvergenceError
    ):  # of a motion that repeats; without inertia of the spin contacts balance at every position
        return _at_slips(made, balance.with_inertia(False))


def _at_slips(made, balance):
    """Return both torques by one balance."""
    turns = abs(made.scene.operation.inner_speed - made.scene.operation.outer_speed)

    def at(slip):
        return (
            sum(loss.power for loss in power_balance(balance, balance.orbit(slip)).losses) / turns
        )

    low = _LEAST
    below = balance.excess(_LEAST)
    high = _FIRST
    above = balance.excess(_FIRST)
    if below >= 0.0:
        return (at(_LEAST),) * 2
    while above < 0.0 and high < _FARTHEST:
        low = high
        below = above
        high = min(2.5 * high, _FARTHEST)
        above = balance.excess(high)
    if above < 0.0:
        return at(_FIRST), math.nan
    while high - low > max(_CLOSE * high, _LEAST):
        fraction = min(max(below / (below - above), 0.1), 0.9)
        middle = low + fraction * (high - low)
        excess = balance.excess(middle)
        low, below, high, above = (
            (low, below, middle, excess) if excess > 0.0 else (middle, excess, high, above)
        )
    steady = at(0.5 * (low + high))
    return steady if high <= _FIRST else at(_FIRST), steady


def held(name, only=None, **changes):
    """States of a bearing, by default all."""
    found = []
    for state in states() if only is None else only:
        made = assemble(scene(name, *state, **changes))
        own, steady = torque(made)
        duty = Duty.of(made)
        iso, skf = (sum(formula.terms(duty).values()) for formula in (Palmgren(), Skf()))
        series = f"{duty.series} old" if name.endswith("-old") else duty.series
        found.append(Held(series, 1e3 * duty.bore, *state, own / iso, own / skf, steady / own))
    return found


def verdict(found):
    """Share of the judged states that is within what is asked, and the median."""
    over = np.array([one.over for one in found if one.judged])
    return float(np.mean((over >= WITHIN[0]) & (over <= WITHIN[1]))), float(np.median(over))


def at_steady(one):
    """The state with the torque at its steady slip."""
    return attrs.evolve(
        one, over_iso=one.over_iso * one.skidding, over_skf=one.over_skf * one.skidding
    )


def told(found):
    """Cells of some states."""
    if not found:
        return [0, *[""] * 6]
    over = np.array([one.over for one in found])
    within = np.mean((over >= WITHIN[0]) & (over <= WITHIN[1]))
    each = (np.median([one.over_iso for one in found]), np.median([one.over_skf for one in found]))
    ends = np.quantile(over, (0.5, 0.01, 0.99))
    return [
        len(found),
        *(f"{value:.2f}" for value in ends),
        f"{100 * within:.1f}",
        *(f"{value:.2f}" for value in each),
    ]


HEAD = [
    "states",
    "median",
    "1 % below",
    "99 % below",
    "0.5 to 1.6 [%]",
    "over ISO 15312",
    "over SKF",
]


def groups(found):
    """What is told apart: by what, which, and the states."""
    judged = [one for one in found if one.judged]
    yield "all", "all", judged
    for series in SERIES:
        yield "series", series, [one for one in judged if one.series == series]
    for low, high in zip((0, *BORES), BORES, strict=False):
        named = f"over {low}" if high == BORES[-1] else f"{low} to {high}"
        yield "bore [mm]", named, [one for one in judged if low < one.bore <= high]
    for n_dm in SPEEDS:
        yield "n d_m [mm/min]", f"{n_dm:g}", [one for one in judged if one.n_dm == n_dm]
    for supply in SUPPLIES:
        yield "supply", supply, [one for one in judged if one.supply == supply]
    for k, (oil, temperature) in enumerate(OILS):
        yield "oil", f"{oil} at {temperature}", [one for one in judged if one.oil == k]
    for k, load in enumerate(LOADS):
        yield "load over C0r", f"{load:g}", [one for one in judged if one.load == k]
    for n_dm in SLOW:
        yield "not judged, n d_m [mm/min]", f"{n_dm:g}", [one for one in found if one.n_dm == n_dm]
    beyond = [one for one in judged if one.skidding != 1.0]
    yield "steady slip", "up to 2 %", [one for one in judged if one.skidding == 1.0]
    yield "steady slip", "beyond 2 %, torque at 2 %", beyond
    skids = [one for one in beyond if math.isfinite(one.skidding)]
    yield "steady slip", "beyond 2 %, torque there", [at_steady(one) for one in skids]
    yield (
        "steady slip",
        "none up to 90 %, torque at 2 %",
        [one for one in beyond if math.isnan(one.skidding)],
    )


def by_series_and_speed(found, before):
    """Rows of medians and 1 to 99 % by series, over speed, today and before."""

    def cell(some, series, n_dm):
        over = [
            one.over
            for one in some
            if one.series == series and one.n_dm == n_dm and one.supply == "bath"
        ]
        return "{:.2g} ({:.2g} to {:.2g})".format(*np.quantile(over, (0.5, 0.01, 0.99)))

    for series in SERIES:
        for what, some in (("before", before), ("now", found)):
            yield [series, what, *(cell(some, series, n_dm) for n_dm in (*SLOW, *SPEEDS))]


def main():
    """Write the tables."""
    bath = [state for state in states() if state[3] == "bath"]
    with ProcessPoolExecutor(2) as pool:
        found = [one for some in pool.map(held, bearings(), chunksize=4) for one in some]
        churning = partial(held, only=bath, **BEFORE)
        before = [one for some in pool.map(churning, bearings(), chunksize=4) for one in some]
    write_table(
        "torque_bench",
        ["by", "of", *HEAD],
        [[by, of, *told(some)] for by, of, some in groups(found)],
    )
    head = ["series", "drags", *(f"n d_m {n_dm:g}" for n_dm in (*SLOW, *SPEEDS))]
    write_table("torque_bench_series", head, by_series_and_speed(found, before))
    fraction, median = verdict(found)
    print(f"within {WITHIN[0]} to {WITHIN[1]}: {fraction:.1%}, median {median:.2f}")


if __name__ == "__main__":
    main()
