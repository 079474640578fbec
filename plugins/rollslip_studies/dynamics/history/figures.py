"""Figures of a motion along a history: slip in its band of safety, what the operation did, and the phase picture."""

import json
import math
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rollslip.results.style import (
    DASHES,
    MARKER,
    MM,
    MODEL_COLOURS,
    SINGLE_COLUMN,
    TWO_COLUMNS,
    Sheet,
)
from rollslip_studies.dynamics.history_findings import nearest

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

#: What varies -> label, and how its SI value is shown.
_SHOWN: Final[dict[str, tuple[str, float, float]]] = {
    "inner_speed": ("Inner ring\n[rpm]", 30.0 / math.pi, 0.0),
    "outer_speed": ("Outer ring\n[rpm]", 30.0 / math.pi, 0.0),
    "radial_load": ("Radial\nload [N]", 1.0, 0.0),
    "load_direction": ("Direction\nof load [°]", 180.0 / math.pi, 0.0),
    "temperature": ("Temperature\n[°C]", 1.0, -273.15),
    "inner_ring_temperature": ("Inner ring\n[°C]", 1.0, -273.15),
    "roller_temperature": ("Rollers\n[°C]", 1.0, -273.15),
    "outer_ring_temperature": ("Outer ring\n[°C]", 1.0, -273.15),
}
#: Room on the axis above the largest slip, and how far it goes at most for a slip of running away beyond.
_ROOM = 1.3
_FAR = 4.0
#: Times that are written along the way through the phase picture, evenly over its length.
_MARKS: Final = 12


def slip_along(dataset: "xr.Dataset") -> "Figure":
    """Draw slip over time with critical slip and slip of running away, above what the operation does."""
    given = json.loads(dataset.attrs["history"])
    size = TWO_COLUMNS[0], (52 + 26 * len(given)) * MM
    sheet = Sheet(
        size,
        1 + len(given),
        1,
        squeeze=False,
        sharex=True,
        height_ratios=(2.2, *[1.0] * len(given)),
    )
    axes, *below = sheet.axes[:, 0]
    t = dataset["time"].to_numpy()
    slip, away, critical = (
        100.0 * dataset[name].to_numpy()
        for name in ("cage_slip", "skidding_slip_along", "critical_slip_along")
    )
    top = _ROOM * float(np.nanmax(slip)) if np.isfinite(slip).any() else 100.0
    limit = 100.0 * nearest(dataset)[2]  # where the cage comes nearest to it
    if math.isfinite(limit):
        top = max(top, min(_ROOM * limit, _FAR * top))
    sheet.line(t, slip, "cage slip", axes, color=MODEL_COLOURS[0])
    # what lies above the panel is in no legend
    if (away < top).any():
        tint: dict[str, Any] = {"color": MODEL_COLOURS[1], "alpha": 0.25, "linewidth": 0.0}
        sheet.handles.append(axes.fill_between(t, away, max(top, 105.0), label="skids", **tint))
        sheet.line(
            t,
            away,
            "slip at which skidding begins",
            axes,
            color=MODEL_COLOURS[1],
            linestyle=DASHES[1],
        )
    if (critical < top).any():
        sheet.line(
            t,
            critical,
            "slip at largest traction, inner ring",
            axes,
            color="0.35",
            linestyle="dotted",
        )
    low = float(np.nanmin(slip)) if np.isfinite(slip).any() else 0.0
    axes.set_ylim(min(0.0, 1.1 * low), top)
    axes.set_ylabel("Cage slip [%]")
    for one, name in zip(below, given, strict=True):
        label, factor, offset = _SHOWN[name]
        one.plot(t, factor * dataset[name].to_numpy() + offset, color="0.2")
        one.set_ylabel(label)
        one.margins(y=0.12)
    (below[-1] if below else axes).set_xlabel("Time [s]")
    axes.set_xlim(t[0], t[-1] if t.size > 1 else t[0] + 1.0)
    return sheet.done(columns=2)


def phase(dataset: "xr.Dataset") -> "Figure":
    """Draw the way of slip through the plane of slip and slip of running away."""
    sheet = Sheet((SINGLE_COLUMN[0], SINGLE_COLUMN[0]))
    figure = sheet.figure
    axes = sheet.axes
    t = dataset["time"].to_numpy()
    slip, away = (100.0 * dataset[name].to_numpy() for name in ("cage_slip", "skidding_slip_along"))
    known = np.isfinite(slip) & np.isfinite(away)
    axes.set_xlabel("Slip at which skidding begins [%]")
    axes.set_ylabel("Cage slip [%]")
    if not known.any():
        said = "at no moment both slips are known"
        axes.text(0.5, 0.5, said, transform=axes.transAxes, ha="center", va="center", color="0.25")
        return figure
    (left, right), (low, high) = (_with_room(values[known]) for values in (away, slip))
    low = min(low, 0.0)
    high = max(high, 1.2 * left)
    ends = np.array([left, right])
    tint: dict[str, Any] = {"color": MODEL_COLOURS[1], "alpha": 0.25, "linewidth": 0.0}
    axes.fill_between(ends, ends, max(high, right), **tint)
    axes.plot(ends, ends, color=MODEL_COLOURS[1], linestyle=DASHES[1])
    axes.plot(np.where(known, away, np.nan), np.where(known, slip, np.nan), color=MODEL_COLOURS[0])
    axes.set_xlim(left, right)
    axes.set_ylim(low, high)
    axes.text(0.02, 0.98, "skids", transform=axes.transAxes, ha="left", va="top", color="0.25")
    places = np.stack(((away - left) / (right - left), (slip - low) / (high - low)))[:, known]
    way = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(places)))))
    marks = np.searchsorted(way, np.linspace(0.0, way[-1], _MARKS))
    for k in np.flatnonzero(known)[np.unique(np.minimum(marks, way.size - 1))]:
        axes.plot(away[k], slip[k], color=MODEL_COLOURS[0], **MARKER)
        axes.annotate(
            f"{t[k]:.2g}", (away[k], slip[k]), (4, 2), textcoords="offset points", fontsize=6
        )
    return figure


def _with_room(values: Any) -> tuple[float, float]:
    least = float(values.min())
    most = float(values.max())
    room = max(0.08 * (most - least), 0.02 * abs(most), 0.1)
    return least - room, most + room
