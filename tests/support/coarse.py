"""Scenes that cost little: for tests of what is said, drawn and kept of results, and not of how right they are.

Results may have an error of 5 %, the oil is not squeezed between approaching surfaces, and rollers have no play in
their pockets: friction tables of rollers with play take longer than all else.
"""

from rollslip import evolve, load_scene

#: Changes of a scene.
COARSE = {
    "accuracy.tolerance": 0.05,
    "models.approach": "dry",
    "study.steady-slip.pockets": "set",
}
#: The same on the command line.
SET_COARSE = tuple(word for key, value in COARSE.items() for word in ("--set", f"{key}={value}"))


def coarse(name, changes=None):
    """Return a scene by its name, with changes."""
    return evolve(load_scene(name), COARSE | (changes or {}), si=True)
