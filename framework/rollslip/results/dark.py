"""Figures of a page on a dark ground: every colour keeps its hue and stands out from the ground.

Lightness is turned round between the ground and the ink of a report in its dark form, in Oklab (Ottosson 2020,
https://bottosson.github.io/posts/oklab), whose lightness is close to what people see. So what is darker than its
neighbour on white is lighter than it here, and what reads in grey reads here.
"""

import re
from functools import cache
from typing import Any, Final

import numpy as np

__all__ = ["GROUND", "INK", "adapting", "on_dark"]

#: What white and black become.
GROUND: Final = "#15181c"
INK: Final = "#e6e9ec"

#: Linear sRGB -> responses of the cones, and their cube roots -> Oklab.
_CONES: Final = np.array(
    [
        [0.4122214708, 0.5363325363, 0.0514459929],
        [0.2119034982, 0.6806995451, 0.1073969566],
        [0.0883024619, 0.2817188376, 0.6299787005],
    ]
)
_OKLAB: Final = np.array(
    [
        [0.2104542553, 0.7936177850, -0.0040720468],
        [1.9779984951, -2.4285922050, 0.4505937099],
        [0.0259040371, 0.7827717662, -0.8086757660],
    ]
)
#: Exponent of darkness on white: below one, what is pale there, an orange for instance, is no dark brown here.
_LIFT: Final = 0.7
_COLOUR: Final = re.compile(r"#[0-9a-f]{6}\b")


def _oklab(colour: str) -> Any:
    encoded = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255.0
    linear = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    return _OKLAB @ np.cbrt(_CONES @ linear)


@cache
def on_dark(colour: str) -> str:
    """Return what a colour "#rrggbb" is on a dark ground.

    Examples
    --------
    >>> on_dark("#ffffff"), on_dark("#000000")
    ('#15181c', '#e6e9ec')
    """
    lightness, *tone = _oklab(colour)
    ground, ink = _oklab(GROUND), _oklab(INK)
    # the faint tone of ground and ink comes with them, so that greys lie between the two
    turned = ground + max(0.0, 1.0 - lightness) ** _LIFT * (ink - ground) + np.array([0.0, *tone])
    linear = np.linalg.solve(_CONES, np.linalg.solve(_OKLAB, turned) ** 3).clip(0.0, 1.0)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return "#" + "".join(f"{round(255.0 * part):02x}" for part in encoded)


def adapting(svgs: list[str]) -> tuple[list[str], str]:
    """Return drawings whose colours follow the page that they stand in, and the style sheet that it needs.

    On paper, and on a screen that is set to light, they are as they were.
    """
    # black is left out in a drawing wherever it is the default
    found = sorted({"#000000"}.union(*(_COLOUR.findall(svg) for svg in svgs)))
    light, dark = (
        "".join(f"--x{colour[1:]}:{shown(colour)};" for colour in found) for shown in (lambda colour: colour, on_dark)
    )
    sheet = f":root{{{light}}}\n@media screen and (prefers-color-scheme: dark){{:root{{{dark}}}}}\n"
    return [_COLOUR.sub(lambda colour: f"var(--x{colour[0][1:]})", svg) for svg in svgs], sheet
