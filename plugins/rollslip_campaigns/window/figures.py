"""The figure of a window of loads: both limits over the quantity that varies, and the operation of the scene.

Style, sizes and files are those of `rollslip.results.style`.
"""

from collections.abc import Iterator

import numpy as np
from matplotlib.figure import Figure

from rollslip.results.dataset import xr
from rollslip.results.style import DASHES, MODEL_COLOURS, Sheet, plain_decades, unit_label
from rollslip.results.text import capitalise, short_label
from rollslip.units import converted, shown_unit

__all__ = ["draw_window", "window_figures"]


def window_figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Draw the figure if any point has a limit; yield its name, caption and figure."""
    if np.isfinite(dataset["minimum_load"]).any() or np.isfinite(dataset["largest_load"]).any():
        yield (
            "window",
            f"Loads between which the bearing neither slips more than allowed nor lasts less than "
            f"{dataset.attrs['hours']:,.10g} h.",
            draw_window(dataset),
        )


def draw_window(dataset: "xr.Dataset") -> "Figure":
    """Draw both limits, the range between them, and the operation of the scene."""
    sheet = Sheet()
    axes = sheet.axes
    varied = dataset["varied"]
    unit = str(varied.attrs["units"])
    shown = shown_unit(float(np.abs(varied).max()), unit) or unit
    x = converted(varied.to_numpy(), unit, shown)
    minimum = dataset["minimum_load"].to_numpy() / 1e3
    largest = dataset["largest_load"].to_numpy() / 1e3
    axes.fill_between(
        x,
        minimum,
        largest,
        where=minimum < largest,
        color=MODEL_COLOURS[2],
        alpha=0.15,
        linewidth=0.0,
    )
    sheet.line(x, minimum, "minimum load, slip", color=MODEL_COLOURS[1], marker="o", markersize=3)
    for k, name in enumerate(dataset["life_model"].to_numpy().astype(str)):
        loads = dataset["life_load"].to_numpy()[k] / 1e3
        sheet.line(x, loads, f"life, {name}", color=MODEL_COLOURS[0], linestyle=DASHES[k])
    sheet.handles.append(
        axes.axhline(
            float(dataset["static_limit"]) / 1e3, label="static rating", color="0.4", linestyle=DASHES[2],
            linewidth=0.9,
        )
    )  # fmt: skip
    if (own := int(dataset["own_point"])) >= 0:
        sheet.mark(x[own], float(dataset["radial_load"]) / 1e3, "this operation", marker="x")
    axes.set_yscale("log")
    plain_decades(axes.yaxis)
    label = capitalise(short_label(str(varied.attrs["key"])))
    return sheet.done(f"{label} [{unit_label(shown)}]", "Radial load [kN]", columns=2)
