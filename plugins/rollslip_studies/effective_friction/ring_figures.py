"""Figure of the shape of the raceways under their forms and loads, with the forces of the rollers.

It is computed from the scene of a result, so that results of sweeps and older results have it, too. Without the files
of the scene there is no figure.
"""

import json
from collections.abc import Iterator
from typing import Any, Final

import numpy as np
from matplotlib.figure import Figure

from rollslip.errors import RollslipError
from rollslip.planning.loads import load_distribution
from rollslip.results.dataset import xr
from rollslip.results.style import RING_COLOURS, SINGLE_COLUMN, Sheet
from rollslip.results.text import two_digits
from rollslip.scene.reading import from_raw
from rollslip.units import format_quantity

__all__ = ["ring_figure"]

#: Length of the bar of the largest force, in radii of the outer raceway. Twice as long bars reach the centre; chosen.
_FORCE_LENGTH: Final = 0.4
#: Largest drawn deviation from a circle, in diameters of a roller. Twice as much lets raceways cross; chosen.
_SHAPE_SIZE: Final = 0.5


def _position(radius: Any, angle: Any) -> tuple[Any, Any]:
    """Return x and y of polar coordinates; the line of load points down."""
    return radius * np.sin(angle), -radius * np.cos(angle)


def ring_figure(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Yield name, caption and figure of the raceways where they are not circles."""
    try:
        scene = from_raw(json.loads(dataset.attrs["scene_resolved"]), "")
        loads = load_distribution(scene).isel(instant=0)
    except (KeyError, RollslipError):  # an older result, or a missing file
        return
    shape = loads["raceway_shape"]
    if not shape.any():
        return
    bearing = scene.bearing
    magnification = _SHAPE_SIZE * scene.bearing.roller_diameter / float(abs(shape).max())
    radii = {
        "inner": bearing.inner_raceway_diameter / 2.0,
        "outer": bearing.outer_raceway_diameter / 2.0,
    }
    sheet = Sheet((SINGLE_COLUMN[0], SINGLE_COLUMN[0]))
    axes = sheet.axes
    turn = shape["orbit_angle"].to_numpy()
    psi = loads["angle"].to_numpy()

    pitch = 0.5 * (radii["inner"] + radii["outer"])
    for angle in psi:
        (x, y) = _position(pitch, angle)
        (dx, dy) = _position(0.5 * bearing.roller_diameter, turn)
        axes.plot(x + dx, y + dy, color="0.8", linewidth=0.5)
    largest = float(loads["normal_force"].max())
    for ring, sign in (("inner", -1.0), ("outer", 1.0)):
        own = shape.sel(ring=ring).to_numpy()
        radius = radii[ring]
        colour = RING_COLOURS[ring]
        axes.plot(*_position(radius, turn), color="0.6", linewidth=0.6, linestyle="dotted")
        axes.plot(*_position(radius + magnification * own, turn), color=colour)
        force = loads["normal_force"].sel(ring=ring).to_numpy()
        length = _FORCE_LENGTH * radii["outer"] * force / (largest or 1.0)
        base = radius + magnification * np.interp(psi, turn, own, period=2.0 * np.pi)
        for angle, start, height in zip(psi, base, length, strict=True):
            axes.plot(
                *_position(np.array([start, start + sign * height]), angle),
                color=colour,
                linewidth=2.0,
            )
        sheet.key(
            f"{ring} raceway, {1e6 * own.min():.3g} to {1e6 * own.max():.3g} µm, bars to {force.max():.3g} N",
            color=colour,
        )
    sheet.key("round, without load", color="0.6", linewidth=0.6, linestyle="dotted")
    if scene.operation.radial_load > 0.0:
        axes.annotate(
            "",
            _position(0.3 * pitch, 0.0),
            (0.0, 0.0),
            arrowprops={"arrowstyle": "-|>", "color": "black"},
        )
        axes.annotate(
            format_quantity(scene.operation.radial_load, "N", 3), (0.04 * pitch, -0.15 * pitch)
        )
    axes.set_aspect("equal")
    axes.set_axis_off()
    caption = (
        f"Raceways as forms and loads leave them, {two_digits(magnification)} times as large, "
        "and forces of the rollers."
    )
    yield f"{dataset.attrs['study']}-rings", caption, sheet.done()
