"""Figure of a motion along a history: slip within the band of safety, and what the operation did."""

import json
import math
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rollslip.results.style import DASHES, MM, MODEL_COLOURS, ROW, TWO_COLUMNS
from rollslip.studies.dynamics.history_findings import nearest

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure

#: What varies -> label, and how its SI value is shown.
_SHOWN: Final[dict[str, tuple[str, float, float]]] = {
    "inner_speed": ("Inner ring\n[rpm]", 30.0 / math.pi, 0.0),
    "outer_speed": ("Outer ring\n[rpm]", 30.0 / math.pi, 0.0),
    "radial_load": ("Radial\nload [N]", 1.0, 0.0),
    "temperature": ("Temperature\n[°C]", 1.0, -273.15),
}
#: Room on the axis above the largest slip, and how far it goes at most for a slip of running away beyond.
_ROOM, _FAR = 1.3, 4.0


def slip_along(dataset: "xr.Dataset") -> "Figure":
    """Draw slip over time with critical slip and slip of running away, above what the operation does."""
    from matplotlib.figure import Figure

    given = json.loads(dataset.attrs["history"])
    figure = Figure(figsize=(TWO_COLUMNS[0], (52 + 26 * len(given)) * MM), layout="constrained")
    axes, *below = figure.subplots(1 + len(given), 1, sharex=True, height_ratios=(2.2, *[1.0] * len(given)))
    t = dataset["time"].to_numpy()
    slip, away, critical = (
        100.0 * dataset[name].to_numpy() for name in ("cage_slip", "runaway_slip_along", "critical_slip_along")
    )
    handles: list[Artist] = []
    top = _ROOM * float(np.nanmax(slip)) if np.isfinite(slip).any() else 100.0
    limit = 100.0 * nearest(dataset)[2]  # where the cage comes nearest to it
    if math.isfinite(limit):
        top = max(top, min(_ROOM * limit, _FAR * top))
    handles += axes.plot(t, slip, color=MODEL_COLOURS[0], label="cage slip")
    # what lies above the panel is in no legend
    if (away < top).any():
        tint: dict[str, Any] = {"color": MODEL_COLOURS[1], "alpha": 0.25, "linewidth": 0.0}
        handles.append(axes.fill_between(t, away, max(top, 105.0), label="runs away", **tint))
        handles += axes.plot(t, away, color=MODEL_COLOURS[1], linestyle=DASHES[1], label="slip of running away")
    if (critical < top).any():
        handles += axes.plot(
            t, critical, color="0.35", linestyle="dotted", label="critical slip of the inner ring's curve"
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
    figure.legend(handles=handles, loc="outside upper left", ncols=2)
    figure.set_figheight(figure.get_figheight() + ROW * -(-len(handles) // 2))
    return figure
