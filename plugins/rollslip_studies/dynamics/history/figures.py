"""Figures of a motion along a history: slip over time with its limits and the operation, and the phase diagram."""

import json
import math
from typing import Any, Final

import numpy as np
from matplotlib.figure import Figure

from rollslip.results.dataset import xr
from rollslip.results.style import (
    DASHES,
    MARKER,
    MM,
    MODEL_COLOURS,
    SINGLE_COLUMN,
    TWO_COLUMNS,
    Sheet,
)
from rollslip_studies.dynamics.history_findings import smallest_margin

#: Value that varies -> label of its axis, and factor and offset from its SI unit.
_PANELS: Final[dict[str, tuple[str, float, float]]] = {
    "inner_speed": ("Inner ring\n[rpm]", 30.0 / math.pi, 0.0),
    "outer_speed": ("Outer ring\n[rpm]", 30.0 / math.pi, 0.0),
    "radial_load": ("Radial\nload [N]", 1.0, 0.0),
    "load_direction": ("Direction\nof load [°]", 180.0 / math.pi, 0.0),
    "temperature": ("Temperature\n[°C]", 1.0, -273.15),
    "inner_ring_temperature": ("Inner ring\n[°C]", 1.0, -273.15),
    "roller_temperature": ("Rollers\n[°C]", 1.0, -273.15),
    "outer_ring_temperature": ("Outer ring\n[°C]", 1.0, -273.15),
}
#: Upper end of the axis of slip, relative to the largest slip. Chosen for the legend.
_HEADROOM: Final = 1.3
#: Maximum factor by which the axis is extended so that the slip at which skidding begins is visible. Doubling it
#: compresses the curve of the slip. Chosen.
_MAX_EXTENSION: Final = 4.0
#: Number of times that label the curve of the phase diagram, evenly over its length. Chosen.
_TIME_LABELS: Final = 12


def slip_along(dataset: "xr.Dataset") -> "Figure":
    """Draw slip over time with critical slip and slip at which skidding begins, above the values that vary."""
    varying = json.loads(dataset.attrs["history"])
    sheet = Sheet(
        (TWO_COLUMNS[0], (52 + 26 * len(varying)) * MM),
        1 + len(varying),
        1,
        squeeze=False,
        sharex=True,
        height_ratios=(2.2, *[1.0] * len(varying)),
    )
    axes, *below = sheet.axes[:, 0]
    t = dataset["time"].to_numpy()
    slip, skidding_slip, critical = (
        100.0 * dataset[name].to_numpy()
        for name in ("cage_slip", "skidding_slip_along", "critical_slip_along")
    )
    top = _HEADROOM * float(np.nanmax(slip)) if np.isfinite(slip).any() else 100.0
    limit = 100.0 * smallest_margin(dataset)[2]  # where the slip is nearest to skidding
    if math.isfinite(limit):
        top = max(top, min(_HEADROOM * limit, _MAX_EXTENSION * top))
    sheet.line(t, slip, "cage slip", axes, color=MODEL_COLOURS[0])
    # what lies above the panel is in no legend
    if (skidding_slip < top).any():
        tint: dict[str, Any] = {"color": MODEL_COLOURS[1], "alpha": 0.25, "linewidth": 0.0}
        sheet.handles.append(
            axes.fill_between(t, skidding_slip, max(top, 105.0), label="skids", **tint)
        )
        sheet.line(
            t,
            skidding_slip,
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
    axes.set_ylim(1.1 * float(np.nanmin(slip, initial=0.0)), top)
    axes.set_ylabel("Cage slip [%]")
    for panel, name in zip(below, varying, strict=True):
        label, factor, offset = _PANELS[name]
        panel.plot(t, factor * dataset[name].to_numpy() + offset, color="0.2")
        panel.set_ylabel(label)
        panel.margins(y=0.12)
    (below[-1] if below else axes).set_xlabel("Time [s]")
    axes.set_xlim(t[0], t[-1] if t.size > 1 else t[0] + 1.0)
    return sheet.done(columns=2)


def phase(dataset: "xr.Dataset") -> "Figure":
    """Draw the phase diagram: slip against the slip at which skidding begins, with times along the curve."""
    sheet = Sheet((SINGLE_COLUMN[0], SINGLE_COLUMN[0]))
    figure = sheet.figure
    axes = sheet.axes
    t = dataset["time"].to_numpy()
    slip, skidding_slip = (
        100.0 * dataset[name].to_numpy() for name in ("cage_slip", "skidding_slip_along")
    )
    known = np.isfinite(slip) & np.isfinite(skidding_slip)
    axes.set_xlabel("Slip at which skidding begins [%]")
    axes.set_ylabel("Cage slip [%]")
    if not known.any():
        text = "at no moment both slips are known"
        axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", va="center", color="0.25")
        return figure
    left, right = _axis_limits(skidding_slip[known])
    low, high = _axis_limits(slip[known])
    low = min(low, 0.0)
    high = max(high, 1.2 * left)
    ends = np.array([left, right])
    axes.fill_between(
        ends, ends, max(high, right), color=MODEL_COLOURS[1], alpha=0.25, linewidth=0.0
    )
    axes.plot(ends, ends, color=MODEL_COLOURS[1], linestyle=DASHES[1])
    axes.plot(
        np.where(known, skidding_slip, np.nan),
        np.where(known, slip, np.nan),
        color=MODEL_COLOURS[0],
    )
    axes.set_xlim(left, right)
    axes.set_ylim(low, high)
    axes.text(0.02, 0.98, "skids", transform=axes.transAxes, ha="left", va="top", color="0.25")
    points = np.stack(((skidding_slip - left) / (right - left), (slip - low) / (high - low)))
    arc_length = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(points[:, known])))))
    labels = np.searchsorted(arc_length, np.linspace(0.0, arc_length[-1], _TIME_LABELS))
    for k in np.flatnonzero(known)[np.unique(np.minimum(labels, arc_length.size - 1))]:
        axes.plot(skidding_slip[k], slip[k], color=MODEL_COLOURS[0], **MARKER)
        axes.annotate(
            f"{t[k]:.2g}",
            (skidding_slip[k], slip[k]),
            (4, 2),
            textcoords="offset points",
            fontsize=6,
        )
    return figure


def _axis_limits(values: Any) -> tuple[float, float]:
    """Return the limits of an axis, with margins around the values."""
    smallest = float(values.min())
    largest = float(values.max())
    margin = max(0.08 * (largest - smallest), 0.02 * abs(largest), 0.1)
    return smallest - margin, largest + margin
