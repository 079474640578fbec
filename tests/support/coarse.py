"""Scenes at a tolerance of 5 %: for tests of what is said, drawn and kept of results, and not of how right they are."""

from rollslip import evolve, load_scene

#: Change of a scene: it allows results an error of 5 %.
COARSE = {"accuracy.tolerance": 0.05}
#: The same on the command line.
SET_COARSE = ("--set", "accuracy.tolerance=0.05")


def coarse(name, changes=None):
    """Return a scene by its name, with changes."""
    return evolve(load_scene(name), COARSE | (changes or {}), si=True)
