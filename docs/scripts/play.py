"""Write the tables play.csv, play_answers.csv and play_trends.csv of docs/trust/play.rst: answers by law and by play.

The two shipped scenes with defaults and ten of ``rollslip new``, with bores of 25 to 320 mm and speeds of 600 to
14,000 rpm: friction at the mean or at the local pressure, rollers set in the cage or with play, contacts that touch dry
with the resistance of the inlet alone. Beside them is the mean slip of motions in time with oil films in the pockets,
over the second to the fourth quarter. Trends are those of scene gearbox with all defaults. A quarter of an hour of one
core; names of scenes as arguments make their rows anew, and `gearbox` also the trends.
"""

import json
import sys
from pathlib import Path

import numpy as np

import rollslip
from rollslip.planning.new_scene import new

sys.path.insert(0, str(Path(__file__).parent))
from output import read_table, write_table

#: Name -> bearing, oil, speed, load, temperature.
SCENES = {
    "NU 205": ("NU205", "iso-vg-32", "9000 rpm", "300 N", "70 degC"),
    "NU 310": ("NU310", "iso-vg-100", "2000 rpm", "1.2 kN", "80 degC"),
    "NU 422": ("NU422", "iso-vg-220", "600 rpm", "3 kN", "50 degC"),
    "NU 1012": ("NU1012", "iso-vg-32", "8000 rpm", "800 N", "80 degC"),
    "NU 1012 fast": ("NU1012", "iso-vg-32", "14000 rpm", "1 kN", "90 degC"),
    "NU 2210": ("NU2210", "iso-vg-68", "3000 rpm", "1.5 kN", "70 degC"),
    "NU 2216": ("NU2216", "iso-vg-68", "4500 rpm", "3 kN", "75 degC"),
    "NU 2220": ("NU2220", "iso-vg-150", "1800 rpm", "4 kN", "70 degC"),
    "NU 236": ("NU236", "iso-vg-220", "1000 rpm", "12 kN", "60 degC"),
    "NU 1064": ("NU1064", "iso-vg-320", "600 rpm", "15 kN", "60 degC"),
}
#: Column -> what is changed.
CASES = {
    "mean_set": ("maxwell-eyring", "set"),
    "local_set": ("maxwell-eyring-local", "set"),
    "mean_play": ("maxwell-eyring", "play"),
    "local_play": ("maxwell-eyring-local", "play"),
}
#: Duration of a motion in time [s] where 40 turns of the inner ring are not enough. It begins at the slip without play.
DURATIONS = {"turbine": 0.4}
#: Motion in time beside them.
MOTION = {
    "study.dynamics.level": "pocket",
    "study.dynamics.friction": "conventional",
    "cage.pocket_contact": "film",
    "study.dynamics.points": 2001,
}


def scenes():
    """Yield name and scene."""
    for name in ("gearbox", "turbine"):
        yield name, rollslip.load_scene(name)
    for name, (bearing, oil, speed, load, temperature) in SCENES.items():
        yield name, new(bearing, oil=oil, speed=speed, load=load, temperature=temperature)


def with_dry_contacts(scene):
    """Return a scene whose rollers touch dry, with the resistance of the inlet alone."""
    drags = rollslip.plan(scene, "steady-slip").assembly.cage.drags
    names = [drag.name.replace("rolling-resistance", "goksem-hargreaves") for drag in drags]
    return rollslip.evolve(scene, {"models.approach": "dry", "cage.drag": names}, si=True)


def row(name, scene):
    """Return the row of a scene."""
    values = {"scene": name}
    scene = with_dry_contacts(scene)
    for case, (law, pockets) in CASES.items():
        changed = rollslip.evolve(
            scene,
            {"models.traction.hydrodynamic": law, "study.steady-slip.pockets": pockets},
            si=True,
        )
        found = rollslip.run(changed, "steady-slip")
        values[f"slip_{case}"] = 100.0 * float(found.steady_slip[0])
        values[f"load_{case}"] = float(found.minimum_load)
        values[f"reserve_{case}"] = float(found.acceptable_reserve)
        values[f"torque_{case}"] = float(found.friction_torque[0])
    band = json.loads(found.attrs["band"])["steady_slip"]
    values["low"] = 100.0 * band["low"]
    values["high"] = 100.0 * (np.inf if band["high"] is None else band["high"])
    motion = MOTION | {
        "study.dynamics.duration": DURATIONS.get(
            name, 40.0 * 2.0 * np.pi / abs(scene.operation.inner_speed)
        )
    }
    if name in DURATIONS:
        without = float(found.slip_without_play)
        motion |= {"study.dynamics.cage_slip": without, "study.dynamics.roller_slip": without}
    moved = rollslip.run(rollslip.evolve(scene, motion, si=True), "dynamics")
    slips = 100.0 * moved.cage_slip.to_numpy()
    values["motion"] = float(slips[slips.size // 4 :].mean())
    values["motion_drift"] = float(slips[slips.size // 2 :].mean()) / values["motion"] - 1.0
    return values


#: Name of a quantity of scene gearbox -> its key, and values.
TRENDS = {
    "radial load": ("operation.radial_load", ("0.75 kN", "1.5 kN", "3 kN", "6 kN", "12 kN")),
    "speed": ("operation.inner_speed", ("375 rpm", "750 rpm", "1500 rpm", "3000 rpm", "4500 rpm")),
    "temperature": (
        "operation.temperature",
        ("40 degC", "60 degC", "80 degC", "100 degC", "120 degC"),
    ),
    "oil": (
        "lubricant.name",
        ("iso-vg-32", "iso-vg-68", "iso-vg-100", "iso-vg-220", "iso-vg-320"),
    ),
    "radial clearance": (
        "bearing.radial_clearance",
        ("-10 um", "0 um", "33 um", "60 um", "90 um"),
    ),
    "play of a pocket": (
        "cage.pocket_clearance",
        ("30 um", "120 um", "240 um", "475 um", "950 um"),
    ),
}


def trends():
    """Write the table of slips with play, and without, over one quantity at a time."""
    gearbox = rollslip.load_scene("gearbox")
    rows = []
    for name, (key, values) in TRENDS.items():
        cells = []
        for value in values:
            found = rollslip.run(rollslip.evolve(gearbox, {key: value}, si=True), "steady-slip")
            slips = (found.steady_slip[0], found.slip_without_play)
            cells.append("{} ({}) %".format(*(f"{100.0 * float(slip):.2g}" for slip in slips)))
        rows.append([f"{name}: {', '.join(values)}", *cells])
    write_table("play_trends", ["gearbox", *"12345"], rows)


def percent(value):
    """Return per cent with three digits."""
    return f"{float(value):.3g} %"


def write_rows(name, header, rows):
    """Write a table with new rows in place of those of the same scenes, in the order of the scenes."""
    new = {old[header[0]]: list(old.values()) for old in read_table(name)}
    new |= {row[0]: row for row in rows}
    write_table(name, header, new.values())


def tables(rows):
    """Write both tables from rows."""
    slips = [
        [
            row["scene"],
            *(percent(row[f"slip_{case}"]) for case in CASES),
            f"{float(row['low']):.2g} to {float(row['high']):.2g} %".replace("inf %", "skidding"),
            percent(row["motion"]),
        ]
        for row in rows
    ]
    names = ("mean pressure, set", "local, set", "mean pressure, play", "local, play")
    write_rows("play", ["slip of", *names, "5 to 95 %", "motion in time"], slips)
    answers = [
        [
            row["scene"],
            *(f"{float(row[f'load_{case}']):.3g} N" for case in CASES),
            *(f"{float(row[f'reserve_{case}']):.2g}" for case in CASES),
            *(f"{float(row[f'torque_{case}']):.3g} N m" for case in ("mean_set", "local_set")),
        ]
        for row in rows
    ]
    header = [
        "scene",
        *(f"load, {name}" for name in names),
        *(f"reserve, {name}" for name in names),
    ]
    write_rows("play_answers", [*header, "torque, mean pressure", "torque, local"], answers)


def main(names):
    """Write the tables; with names of scenes, their rows anew."""
    found = dict(scenes())
    made = []
    for name in names or found:
        made.append(row(name, found[name]))
        print(made[-1], flush=True)
    tables(made)
    if not names or "gearbox" in names:
        trends()


if __name__ == "__main__":
    main(sys.argv[1:])
