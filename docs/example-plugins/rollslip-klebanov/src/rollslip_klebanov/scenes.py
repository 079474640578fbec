"""Scenes of the paper's figures, and the sets of what the paper does not print."""

import tomllib
from importlib.resources import as_file, files
from typing import Any, Final

from rollslip import evolve, load_scene
from rollslip.scene import Scene

_FIGURES: Final = files("rollslip_klebanov") / "figures"

#: Name of a set -> its note, its critical slips at 70 and 50 degC as texts, and its changes of a scene.
SETS: Final[dict[str, dict[str, Any]]] = tomllib.loads((_FIGURES / "sets.toml").read_text(encoding="utf-8"))


def figure_scene(figure: str, of_set: str = "handbook") -> Scene:
    """Return the scene of a figure, "fig-1", "fig-2" or "fig-3", with one of the `SETS`.

    Raises
    ------
    SceneError, PluginError
        As `rollslip.load_scene`; there is no such figure, or rollslip does not read the scene.
    KeyError
        If there is no such set.
    """
    with as_file(_FIGURES / f"{figure}.toml") as path:
        scene = load_scene(path)
    changes = SETS[of_set]["changes"]
    if "study.effective-friction.closure" in changes and figure == "fig-1":  # which has one contact and no cage
        changes = {key: value for key, value in changes.items() if not key.startswith("study.")}
    return evolve(scene, changes, si=True) if changes else scene
