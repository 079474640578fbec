"""Figure of study steady-slip: a turn of a roller that has play in its pocket.

Style, sizes and files are those of `rollslip.results.style`.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rollslip.results.dataset import xr
from rollslip.results.style import MODEL_COLOURS, ROW, TWO_COLUMNS, Sheet, axis_label, unit_label
from rollslip.results.text import percent

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["pocket_figure"]

#: What a roller does -> style. The crossing is dashed, so that the figure is readable in grey.
_STYLES: Final[dict[str, dict[str, Any]]] = {
    "drives the cage": {"color": MODEL_COLOURS[0]},
    "crosses the play": {"color": MODEL_COLOURS[1], "linestyle": "dashed"},
    "is pushed by the cage": {"color": "0.45"},
}
#: Variables of the fractions of a turn, in the same order.
_FRACTIONS: Final = ("driving_fraction", "crossing_fraction", "pushed_fraction")
#: Style of the mark of an impact.
_MEETS: Final[dict[str, Any]] = {"marker": "x", "markersize": 4}


def pocket_figure(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Yield name, caption and figure of a turn of a roller with play in its pocket; nothing if there is none.

    Parameters
    ----------
    dataset : xarray.Dataset
        With ``pocket_position`` over half of the play, 1 at the bar that the roller drives, and ``pocket_force`` on the
        bars [N], both over ``pocket_angle`` [rad], and with the fractions of the turn.
    """
    if "pocket_position" in dataset and np.isfinite(dataset["pocket_position"]).all():
        yield (
            "steady-slip-pocket",
            "Position of a roller in its pocket, and its force on the bars, over a turn at the steady cage slip with "
            "play in the pockets.",
            _pocket(dataset),
        )


def _pocket(dataset: "xr.Dataset") -> "Figure":
    """Draw position and force over the angle, with marks at impacts, whose mean force depends on the step."""
    sheet = Sheet(TWO_COLUMNS, 1, 2)
    positions, forces = sheet.axes
    came = dataset["pocket_position"] != dataset["pocket_position"].roll(pocket_angle=1)
    turn = dataset.assign(
        impact=came & (np.abs(dataset["pocket_position"]) >= 1.0),
        shown=(np.degrees(dataset["pocket_angle"]) + 180.0) % 360.0 - 180.0,
    ).sortby("shown")
    shown = turn["shown"].to_numpy()
    position = turn["pocket_position"].to_numpy()
    impact = turn["impact"].to_numpy()
    force = np.where(impact, np.nan, turn["pocket_force"].to_numpy())
    at = (position >= 1.0, np.abs(position) < 1.0, position <= -1.0)
    for chosen, (label, style), fraction in zip(at, _STYLES.items(), _FRACTIONS, strict=True):
        # lines of the position reach to the next part
        joined = chosen | np.roll(chosen, 1) | np.roll(chosen, -1)
        positions.plot(shown, np.where(joined, position, np.nan), **style)
        forces.plot(shown, np.where(chosen, force, np.nan), **style)
        sheet.key(f"{label}, {percent(float(dataset[fraction]))} of the turn", **style)
    if impact.any():
        sheet.mark(shown[impact], position[impact], "meets a bar", axes=positions, **_MEETS)
        forces.plot(shown[impact], 0.0 * shown[impact], color="black", linestyle="none", **_MEETS)
    for axes in (positions, forces):
        axes.set_xlabel("Position from the line of load [°]")
        axes.set_xlim(-180.0, 180.0)
        axes.set_xticks(range(-180, 181, 90))
    positions.set_yticks([-1.0, 0.0, 1.0])
    positions.set_ylabel(axis_label(dataset["pocket_position"], "$2x/c$", unit_label("")))
    forces.set_ylabel(axis_label(dataset["pocket_force"], "$P$", "N"))
    return sheet.done(columns=2, height=TWO_COLUMNS[1] - ROW)
