"""Write the table sensitivities.csv and the figure: what decides steady slip and reserve of drag, one at a time.

Three scenes as ``rollslip new`` writes them. What scatters by default is put to where 5 and 95 % of it lie below,
everything else staying; then what somebody may choose or state is changed. Slip and reserve are those of one way up
over cage slips up to 95 %, at 56 positions of the orbit or more; a reserve without a fold is the torque at the end of
the range over the drag, so a lower bound. Two minutes.
"""

import math

import attrs
import numpy as np
from output import BLUE, GREEN, ORANGE, figure, read_table, save_figure, write_table

from rollslip import evolve
from rollslip.bearing.assembly import assemble
from rollslip.errors import RollslipError
from rollslip.planning.new_scene import ASSUMED, new_scene
from rollslip.results.style import plain_decades
from rollslip.scene.reading import parse_scene
from rollslip.structure import Location
from rollslip.studies.quantities import quantities
from rollslip_studies.motion.torque_balance import reserve, running, skidding_onset, torque_balance
from rollslip_studies.variation.distributions import read_uncertainty
from rollslip_studies.variation.scatter import with_scatter

#: Bearing, oil, speed and load of each scene, at 70 degC.
SCENES = {
    "NU 205 C3": ("iso-vg-32", "12000 rpm", "200 N"),
    "NU 2216": ("iso-vg-68", "4500 rpm", "1.5 kN"),
    "NU 422": ("iso-vg-220", "600 rpm", "2 kN"),
}
LAST = 0.95
SHOWN = 14
NO_HEAT = {"models.film.thermal": "none", "cage.drag.rolling-resistance.inlet_heating": "none"}
#: What is chosen or stated in place of a default; those in pairs are the two sides of one.
CHOICES = {
    "rolling resistance off": {"cage.drag": ["hysteresis", "churning"]},
    "flooded inlet": {"cage.drag.rolling-resistance.reach": "flooded"},
    "hysteresis off": {"cage.drag.hysteresis.factor": 0.0},
    "churning off": {"cage.drag.churning.factor": 0.0},
    "heat of the inlets off": NO_HEAT,
    "heat of the film's inlet off": {"models.film.thermal": "none"},
    "pressure of light contacts off": {"models.pressure": "hertz"},
    "pressure law Barus": {"lubricant.pressure_viscosity_law": "barus"},
    "alpha is the film's": {"lubricant.pressure_viscosity_kind": "film"},
    "traction by Muraki": {"models.traction.hydrodynamic": "muraki"},
    "inertia of the spin off": {},
    "profile straight": {"bearing.profile": "none"},
    "surfaces superfinished": {"surface": {"name": "superfinished"}},
    "cage of brass on the outer ring": {"cage.make": "brass", "cage.guidance": "outer"},
    "cage of steel sheet": {"cage.make": "steel"},
    **{
        f"supply {kind}": {"lubrication.supply": kind}
        for kind in ("splash", "circulating", "jet", "mist", "grease")
    },
    **{f"clearance {kind}": {"bearing.clearance_class": kind} for kind in ("C2", "CN", "C3", "C4")},
    "shaft h6": {"bearing.mounting.shaft_fit": "h6"},
    "shaft n6": {"bearing.mounting.shaft_fit": "n6"},
    "housing K7": {"bearing.mounting.housing_fit": "K7"},
    "inner ring not warmer": {"bearing.mounting.temperature_difference": 0.0},
    "inner ring 10 K warmer": {"bearing.mounting.temperature_difference": 10.0},
    "stated: 60 degC": {"operation.temperature": "60 degC"},
    "stated: 80 degC": {"operation.temperature": "80 degC"},
    "stated: load / 1.25": {"operation.radial_load": 1.0 / 1.25},
    "stated: load x 1.25": {"operation.radial_load": 1.25},
}


def scene(name):
    """A scene as it is written, with friction at the mean pressure."""
    oil, speed, load = SCENES[name]
    requested = {
        "bearing": name,
        "oil": oil,
        "speed": speed,
        "load": load,
        "temperature": "70 degC",
        "cage": "polyamide",
    }
    written = parse_scene(new_scene(name, **(ASSUMED | requested)), name)
    return evolve(written, {"models.traction.hydrodynamic": "maxwell-eyring"})


def found(one, inertia=True):
    """Steady slip, infinite where the cage skids, and reserve of drag."""
    balance = torque_balance(assemble(one), 1, inertia=inertia)
    away = skidding_onset(balance, LAST, "")
    runs = running(balance, LAST)
    held = reserve(balance, away, runs, LAST)
    slip = math.inf if held.status.startswith("the cage skids") else runs.slip
    return slip, held.factor, not math.isnan(away.slip)


def ends(one):
    """What scatters, at 5 and 95 %, by key, and its grade."""
    problems = []
    given, said = with_scatter(one)
    table = read_uncertainty(
        given.uncertainty, Location({}), quantities(assemble(one), {}), problems
    )
    if problems:
        raise ValueError(problems)
    grades = {text.partition(" ")[0]: text.partition("(")[2][:1] for text in said}
    at = np.array([0.05, 0.95])
    return {
        key: (grades[key], distribution.quantile(at))
        for key, distribution in table.distributions.items()
    }


@attrs.frozen
class Moved:
    """What a scene comes to with something changed, over what it comes to as it is."""

    scene: str
    what: str
    kind: str
    slips: tuple
    reserves: tuple
    slip: float
    reserve: float

    @property
    def decides(self):
        """Largest change of the logarithm of the slip."""
        return max(
            abs(math.log(one / self.slip)) if math.isfinite(one) else math.inf for one in self.slips
        )


def changed(one, changes):
    """A scene with changes; loads are factors."""
    changes = dict(changes)
    if "operation.radial_load" in changes:
        changes["operation.radial_load"] *= one.operation.radial_load
    return evolve(one, changes, si=True)


def moved(name):
    """All changes of a scene."""
    one = scene(name)
    slip, held, folds = found(one)
    print(f"{name}: slip {slip:.4f}, reserve {held:.3g}, fold: {folds}", flush=True)
    for key, (grade, both) in ends(one).items():
        each = [found(evolve(one, {key: float(end)}, si=True)) for end in both]
        yield Moved(
            name,
            key,
            f"scatter ({grade})",
            *zip(*(pair[:2] for pair in each), strict=True),
            slip,
            held,
        )
    for what, changes in CHOICES.items():
        try:
            pair = found(changed(one, changes), inertia=what != "inertia of the spin off")[:2]
        except RollslipError as error:
            print(f"{name}: {what}: {error}")
            continue
        kind = "stated" if what.startswith("stated") else "choice"
        yield Moved(name, what, kind, pair[:1], pair[1:], slip, held)


def cells(some):
    """A row of the table: one change, in all scenes."""

    def shown(values, scale, endless):
        return " to ".join(endless if math.isinf(v) else f"{scale * v:.3g}" for v in values)

    for one in some:
        yield shown(one.slips, 100.0, "skids")
    for one in some:
        yield shown(one.reserves, 1.0, "no drag on the cage")


def ranked(rows):
    """Changes by the mean of the logarithms of what they make of the slips, the largest first, and these means."""
    by = {}
    for one in rows:
        by.setdefault(one.what, []).append(one)
    whole = [some for some in by.values() if len(some) == len(SCENES)]
    each = [(math.exp(sum(one.decides for one in some) / len(some)), some) for some in whole]
    return sorted(each, key=lambda one: -one[0])


def slips_of(cell):
    """Slips [%] of a cell of the table; a cage that skids has the end of the range."""
    return [100.0 * LAST if text == "skids" else float(text) for text in cell.split(" to ")]


def shown_name(what):
    """Name of a row of the figure: the last part of a key, or a choice in words."""
    name = what.removeprefix("stated: ")
    if " " in name:
        return name
    *_, before, last = name.split(".")
    return (
        f"{before} factor"
        if last == "factor"
        else last.replace("_", " ").replace("eyring", "Eyring")
    )


def draw():
    """Draw a bar for each of what decides most, from the table."""
    as_is, *rows = read_table("sensitivities")
    made, axes = figure(len(SCENES), height=3.6, width=3.2)
    colours = {"scatter": BLUE, "choice": ORANGE, "stated": GREEN}
    for ax, name in zip(axes, SCENES, strict=True):
        column = f"slip of {name} [%]"
        here = float(as_is[column])
        first = sorted(
            rows, key=lambda row: -max(abs(math.log(x / here)) for x in slips_of(row[column]))
        )
        first = first[:SHOWN][::-1]
        for k, row in enumerate(first):
            sides = [*slips_of(row[column]), here]
            ax.barh(
                k,
                max(sides) - min(sides),
                left=min(sides),
                height=0.7,
                color=colours[row["kind"].split()[0]],
            )
        ax.axvline(here, color="black", lw=0.8)
        ax.set_yticks(range(len(first)), [shown_name(row["what"]) for row in first])
        ax.tick_params(axis="y", labelsize=6.0, length=0)
        plain_decades(ax.xaxis)
        ax.set_xlim(left=0.8 * ax.get_xlim()[0])
        ax.set_title(name)
        ax.set_xlabel("steady cage slip [%]")
    save_figure(made, "sensitivities")


def firsts(rows):
    """A change of each scene, for what the scene comes to as it is."""
    return [next(one for one in rows if one.scene == name) for name in SCENES]


def main():
    """Write table and figure."""
    rows = []
    for name in SCENES:
        rows += sorted(moved(name), key=lambda one: -one.decides)
    head = [
        "what",
        "kind",
        "slip times",
        *(f"slip of {name} [%]" for name in SCENES),
        *(f"reserve of {name}" for name in SCENES),
    ]
    as_is = [
        "as it is",
        "",
        "1",
        *(f"{100 * one.slip:.3g}" for one in firsts(rows)),
        *(f"{one.reserve:.3g}" for one in firsts(rows)),
    ]
    told = [
        [some[0].what, some[0].kind, f"{mean:.3g}", *cells(some)] for mean, some in ranked(rows)
    ]
    write_table("sensitivities", head, [as_is, *told])
    draw()


if __name__ == "__main__":
    main()
