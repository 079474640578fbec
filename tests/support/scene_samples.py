"""A scene that the tests of reading change line by line."""

import pytest

from rollslip.errors import SceneError
from rollslip.scene.reading import parse_scene

SCENE = """\
title = "1032930 at 70 degC"

[bearing]
rollers = 28
roller_diameter = "15 mm"
roller_length = "15 mm"
inner_raceway_diameter = "165 mm"
outer_raceway_diameter = "195 mm"

[lubricant]
name = "mil-prf-7808"
eyring_stress = "4 MPa"

[operation]
inner_speed = "6371 rpm"
radial_load = "3415 N"
temperature = "70 degC"

[models]
film = "moes"

[study.effective-friction]
slip = ["0 %", "30 %"]

[study.friction-curve]
"""
LINES = SCENE.splitlines()


def scene_with(*additions: str, **replaced: str) -> str:
    """Replace the lines of some keys, which keeps all line numbers, and add lines at the end."""
    lines = [
        next((new for key, new in replaced.items() if line.startswith(f"{key} ")), line)
        for line in LINES
    ]
    return "\n".join([*lines, *additions]) + "\n"


def problems_of(text: str) -> list[str]:
    with pytest.raises(SceneError) as caught:
        parse_scene(text, "scene.toml")
    return caught.value.problems


def line_of(key: str) -> int:
    return (
        next(number for number, line in enumerate(LINES, 1) if line.startswith(f"{key} "))
        if key
        else 0
    )
