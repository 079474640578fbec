"""Two whole bearings at levels pocket and planar over 20 ms, and what an independent program has of the same.

For tests/motion/test_whole_bearing.py and docs/scripts/whole_bearing.py; tools/references/whole_bearing_exudyn.py
has the same numbers again.
"""

import functools

import numpy as np

from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip_kernels.motion.rosenbrock import DormandPrince
from rollslip_studies.dynamics.levels.cage_and_rollers import carried_motion
from rollslip_studies.dynamics.levels.planar import PlanarSettings, planar_motion
from rollslip_studies.dynamics.levels.raceway_friction import FrictionSettings
from tabled import REFERENCES, rows_of

SCENE = load_scene("1032930-50C")
#: A small bearing of nine rollers, with a small clearance, at 8000 1/min.
NINE = {
    "bearing.rollers": 9,
    "bearing.roller_diameter": "10 mm",
    "bearing.roller_length": "10 mm",
    "bearing.inner_raceway_diameter": "40 mm",
    "bearing.outer_raceway_diameter": "60.01 mm",
    "bearing.radial_clearance": "10 um",
    "bearing.profile": "none",
    "operation.inner_speed": "8000 rpm",
    "operation.radial_load": "600 N",
    "cage": {
        "mass": "0.08 kg",
        "inertia": "5.2e-5 kg m2",
        "pocket_clearance": "0.2 mm",
        "pocket_radial_clearance": "0.3 mm",
        "pocket_stiffness": "5e7 N/m",
        "pocket_damping": "0.3 s/m",
        "pocket_contact": "metal",
        "drag": [
            {"model": "constant-torque", "size": "0.05 N m", "transition": "0.001 rad/s"},
            {"model": "pocket-friction", "coefficient": 0.08},
        ],
    },
}
LOADS = 1e-4  # fraction of the loads that may be at the wrong place at level pocket
SAMPLE = 1e-5  # s between stored times
#: Rollers of the reference, evenly spaced among those of the bearing.
SHOWN = 9


def bearing(name):
    """The assembly of a bearing, its friction, and the mass of its inner ring."""
    if name == "nine":
        friction = FrictionSettings(
            name="constant", coefficient=0.02, transition=0.5, tolerance=LOADS
        )
        return assemble(evolve(SCENE, NINE, si=True)), friction, 0.5
    return (
        assemble(evolve(SCENE, {"accuracy.slices": 5})),
        FrictionSettings(name="conventional", tolerance=LOADS),
        3.0,
    )


@functools.cache
def motion(name, level, seed=None):
    """What rollslip finds, by the names of the reference, every 10 us.

    With a seed rollers start a little off the middle of their pockets: by the share of the play that the model leaves
    out at level planar, and by a millionth of the play at level pocket.
    """
    assembly, friction, mass = bearing(name)
    if level == "planar":
        moving = planar_motion(assembly, PlanarSettings(inner_ring_mass=mass), friction)
        fraction = left_out(name)
    else:
        moving = carried_motion(assembly, friction, level=level)
        fraction = 1e-6
    system = moving.system
    t = np.linspace(0.0, 20e-3, 2001)
    start = moving.initial()
    if seed is not None:
        place = moving.split(start)["pocket_position"]
        place += (
            fraction
            * assembly.cage.pocket_clearance
            * np.random.default_rng(seed).uniform(-1.0, 1.0, place.size)
        )
    y = np.empty((t.size, system.n))
    # steps of a thirtieth of an impact; ten times finer tolerances change what is compared by up to 5e-5
    solver = DormandPrince(system.capsule, 0.0, start, t[-1], 1e-9, 1e-9 * system.scale, 2e-6)
    assert solver.advance(t_out=t, y_out=y) == ("finished", t.size), solver.message
    names = {"pocket_position": "position", "roller_spin": "spin"}
    return {
        names.get(key, key): values for key, values in moving.split(y).items()
    } | moving.outputs(t, y)


def left_out(name):
    """Play of the pockets over the radius of the orbit: what displacements that count as small leave out."""
    assembly = bearing(name)[0]
    return assembly.cage.pocket_clearance / assembly.kinematics.orbit_radius


@functools.cache
def reference(name, level):
    """Columns of the reference, (rows,) or by roller (rows, shown)."""
    every = rows_of(REFERENCES / "whole_bearing_exudyn.csv")
    of_both = [row for row in every if (row["bearing"], row["level"]) == (name, level)]
    columns = {}
    for key in of_both[0]:
        if key in ("bearing", "level") or not of_both[0][key]:
            continue
        values = np.array([float(row[key]) for row in of_both])
        kind, _, number = key.rpartition("_")
        if number.isdigit():
            columns.setdefault(kind, []).append(values)
        else:
            columns[key] = values
    return {
        key: np.array(values).T if isinstance(values, list) else values
        for key, values in columns.items()
    }


def compared(name, level):
    """Times of the reference, and by name the largest difference at each and what it is measured by."""
    ours = motion(name, level)
    theirs = reference(name, level)
    at = np.round(theirs["t"] / SAMPLE).astype(int)
    differences = {}
    for key, values in theirs.items():
        if key in ("t", "mean_square"):
            continue
        kind = key.removesuffix("_mean")
        mine = ours[kind][at]
        if key != kind:
            mine = mine.mean(axis=1)
        elif values.ndim == 2:
            mine = mine[:, np.arange(SHOWN) * mine.shape[1] // SHOWN]
        off = np.abs(mine - values)
        # angles and speeds turn on at large: what counts is by how much they change
        size = (
            np.abs(ours[kind]).max()
            if "speed" not in kind and kind != "spin"
            else np.ptp(ours[kind])
        )
        differences[key] = (off.max(axis=1) if off.ndim == 2 else off) / size
    return theirs["t"], differences


def on_the_whole(name, level, seed=None):
    """Root mean square of the pockets' forces [N], and mean loss of the cage's speed over the second half [rad/s]."""
    ours = motion(name, level, seed)
    rows = np.round(reference(name, level)["t"] / SAMPLE).astype(int)
    speed = ours["cage_speed"]
    return np.sqrt(np.mean(ours["pocket_force"][1:] ** 2)), speed[0] - speed[
        rows[rows.size // 2 :]
    ].mean()


def their_whole(name, level):
    """The same of the reference."""
    theirs = reference(name, level)
    speed = theirs["cage_speed"]
    return np.sqrt(theirs["mean_square"][1:].mean()), speed[0] - speed[speed.size // 2 :].mean()
