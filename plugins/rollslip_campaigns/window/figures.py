"""The figure of a window of loads: both limits over the quantity that varies, and the operation of the scene.

Style, sizes and files are those of `rollslip.results.style`.
"""

from collections.abc import Iterator
from typing import Final

import numpy as np
from matplotlib.figure import Figure

from rollslip.results.dataset import xr
from rollslip.results.style import DASHES, MODEL_COLOURS, Sheet, plain_decades, unit_label
from rollslip.results.text import capitalise, short_label
from rollslip.units import converted, shown_unit

__all__ = ["draw_window", "window_figures"]

#: Load -> colour of its curve and of its band.
_COLOURS: Final = {"minimum_load": MODEL_COLOURS[1], "largest_load": MODEL_COLOURS[0]}


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
    """Draw both limits with their bands, the range that is safe with these, and the operation of the scene."""
    sheet = Sheet()
    axes = sheet.axes
    varied = dataset["varied"]
    unit = str(varied.attrs["units"])
    shown = shown_unit(float(np.abs(varied).max()), unit) or unit
    x = converted(varied.to_numpy(), unit, shown)
    minimum = dataset["minimum_load"].to_numpy() / 1e3
    lowest = dataset.get("minimum_load_high", dataset["minimum_load"]).to_numpy() / 1e3
    highest = dataset.get("largest_load_low", dataset["largest_load"]).to_numpy() / 1e3
    is_safe = lowest < highest
    axes.fill_between(
        x, lowest, highest, where=is_safe, color=MODEL_COLOURS[2], alpha=0.15, linewidth=0.0
    )
    for name, colour in _COLOURS.items():
        if f"{name}_low" in dataset:
            low, high = (dataset[f"{name}_{side}"].to_numpy() / 1e3 for side in ("low", "high"))
            axes.fill_between(x, low, high, color=colour, alpha=0.25, linewidth=0.0)
    sheet.line(
        x, minimum, "minimum load, slip", color=_COLOURS["minimum_load"], marker="o", markersize=3
    )
    for k, name in enumerate(dataset["life_model"].to_numpy().astype(str)):
        loads = dataset["life_load"].to_numpy()[k] / 1e3
        sheet.line(x, loads, f"life, {name}", color=_COLOURS["largest_load"], linestyle=DASHES[k])
    sheet.handles.append(
        axes.axhline(
            float(dataset["static_limit"]) / 1e3, label="static rating", color="0.4", linestyle=DASHES[2],
            linewidth=0.9,
        )
    )  # fmt: skip
    if (own := int(dataset["own_point"])) >= 0:
        sheet.mark(x[own], float(dataset["radial_load"]) / 1e3, "this operation", marker="x")
    if "minimum_load_low" in dataset:
        sheet.key("5 to 95 % where data scatter", color="0.5", alpha=0.3, linewidth=6)
    axes.set_yscale("log")
    plain_decades(axes.yaxis)
    label = capitalise(short_label(str(varied.attrs["key"])))
    return sheet.done(f"{label} [{unit_label(shown)}]", "Radial load [kN]", columns=2)
