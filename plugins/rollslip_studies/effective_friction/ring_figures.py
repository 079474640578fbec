"""Figure of the raceways as forms and loads leave them, with the forces of the rollers.

It is drawn of the scene of a result, so that sweeps and older results have it; without its files there is none.
"""

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rollslip.errors import RollslipError
from rollslip.planning.loads import load_distribution
from rollslip.results.style import RING_COLOURS, SINGLE_COLUMN, Sheet
from rollslip.results.words import two_digits
from rollslip.scene.reading import from_raw
from rollslip.units import format_quantity

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

__all__ = ["ring_figure"]

#: Length of the largest force, in radii of the outer raceway, and of the largest shape, in diameters of a roller.
_FORCE: Final = 0.4
_SHAPE: Final = 0.5


def _place(radius: Any, angle: Any) -> tuple[Any, Any]:
    """Return x and y; the line of load points down."""
    return radius * np.sin(angle), -radius * np.cos(angle)


def ring_figure(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Draw the raceways where they are not round circles; give name, caption and figure."""
    try:
        scene = from_raw(json.loads(dataset.attrs["scene_resolved"]), "")
        loads = load_distribution(scene).isel(instant=0)
    except (KeyError, RollslipError):  # a result of before, or a file that has gone
        return
    shape = loads["raceway_shape"]
    if not shape.any():
        return
    bearing = scene.bearing
    times = _SHAPE * scene.bearing.roller_diameter / float(abs(shape).max())
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
        (x, y) = _place(pitch, angle)
        (dx, dy) = _place(0.5 * bearing.roller_diameter, turn)
        axes.plot(x + dx, y + dy, color="0.8", linewidth=0.5)
    largest = float(loads["normal_force"].max())
    for ring, sign in (("inner", -1.0), ("outer", 1.0)):
        own = shape.sel(ring=ring).to_numpy()
        radius = radii[ring]
        colour = RING_COLOURS[ring]
        axes.plot(*_place(radius, turn), color="0.6", linewidth=0.6, linestyle="dotted")
        axes.plot(*_place(radius + times * own, turn), color=colour)
        force = loads["normal_force"].sel(ring=ring).to_numpy()
        long = _FORCE * radii["outer"] * force / (largest or 1.0)
        begin = radius + times * np.interp(psi, turn, own, period=2.0 * np.pi)
        for angle, start, far in zip(psi, begin, long, strict=True):
            axes.plot(
                *_place(np.array([start, start + sign * far]), angle), color=colour, linewidth=2.0
            )
        said = f"{1e6 * own.min():.3g} to {1e6 * own.max():.3g} µm, bars to {force.max():.3g} N"
        sheet.key(f"{ring} raceway, {said}", color=colour)
    sheet.key("round, without load", color="0.6", linewidth=0.6, linestyle="dotted")
    if scene.operation.radial_load > 0.0:
        axes.annotate(
            "",
            _place(0.3 * pitch, 0.0),
            (0.0, 0.0),
            arrowprops={"arrowstyle": "-|>", "color": "black"},
        )
        axes.annotate(
            format_quantity(scene.operation.radial_load, "N", 3), (0.04 * pitch, -0.15 * pitch)
        )
    axes.set_aspect("equal")
    axes.set_axis_off()
    caption = f"Raceways as forms and loads leave them, {two_digits(times)} times as large, and forces of the rollers."
    yield f"{dataset.attrs['study']}-rings", caption, sheet.done()
