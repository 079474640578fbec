"""Scenes whose data scatter, on few slices and slips: what is tested is what is made of the points."""

import attrs

import rollslip
from rollslip.scene import FrozenTable
from rollslip.scene.reading import load_scene

DRAGS = ["petroff-land", "churning", "rolling-resistance", "hysteresis"]
SCATTERED = rollslip.evolve(
    load_scene("1032930-70C"),
    {
        "accuracy.slices": 3,
        "accuracy.tolerance": 0.02,
        "models.approach": "dry",
        "study.effective-friction.points": 9,
        "study.steady-slip.pockets": "set",
        "cage.drag": DRAGS,
    },
)

#: The same with a law of traction and a drag that cost little.
PLAIN = rollslip.evolve(SCATTERED, {"models.traction": "muraki", "cage.drag": DRAGS[:1]})


def uncertain(scene, **table):
    """A scene with a table [uncertainty]."""
    raw = {**scene.raw, "uncertainty": table}
    return attrs.evolve(scene, uncertainty=FrozenTable(table), raw=FrozenTable(raw))


def constant(size):
    """A cage that a torque of one size [N m] drags."""
    return rollslip.evolve(
        SCATTERED, {"cage.drag": [{"model": "constant-torque", "size": f"{size} N m"}]}
    )
