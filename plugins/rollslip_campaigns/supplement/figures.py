"""Figures of a supplement: an output over a quantity, a line for each choice of another one, with bands.

Bars are 5 and 95 % bounds by what scatters. A triangle is a lower bound: of a slip beyond the end of the range.
"""

import json
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from rollslip.results.dataset import xr
from rollslip.results.style import DASHES, MODEL_COLOURS, Sheet
from rollslip.results.text import short_label
from rollslip_campaigns.supplement.findings import BOUNDS
from rollslip_campaigns.sweep.figures import axis_label, axis_values, display_of
from rollslip_campaigns.sweep.findings import axis_keys

__all__ = ["supplement_figures"]


def supplement_figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Draw the figures that the supplement defines; yield name, caption and figure of each."""
    names = {key: name for name, key in axis_keys(dataset).items()}
    for figure in json.loads(dataset.attrs["supplement"])["figures"]:
        values = dataset[figure["y"]]
        what = str(values.attrs["long_name"])
        by = f", by {short_label(figure['lines'])}" if figure["lines"] else ""
        caption = f"{what[:1].upper()}{what[1:]} over {short_label(figure['x'])}{by}."
        yield (
            figure["name"],
            figure["caption"] or caption,
            _figure(dataset, figure, names[figure["x"]], names.get(figure["lines"])),
        )


def _figure(
    dataset: "xr.Dataset", figure: Mapping[str, Any], x_name: str, lines: str | None
) -> "Figure":
    """Draw one figure over a dimension, with a line for each value of another one, and for each ring."""
    sheet = Sheet()
    name = figure["y"]
    values = dataset[name]
    x, x_label = axis_values(dataset[x_name])
    read, unit = display_of(values)
    inner = [str(dim) for dim in values.dims if dim not in (x_name, lines)]
    stacked = [*([lines] if lines else []), *inner]
    for k, index in enumerate(np.ndindex(*(dataset.sizes[dim] for dim in stacked))):
        at = dict(zip(stacked, index, strict=True))
        labels = [str(dataset[dim][at[dim]].item()) for dim in stacked if dim in dataset.coords]
        style: dict[str, Any] = {
            "color": MODEL_COLOURS[k % len(MODEL_COLOURS)],
            "linestyle": DASHES[k % len(DASHES)],
        }
        y = read(values.isel(at).to_numpy())
        label = ", ".join(labels)
        sheet.line(x, y, label, marker="o", markersize=3, **style)
        colour = style["color"]
        own = {dim: at[dim] for dim in stacked if dim == lines}
        if f"{name}_low" in dataset:
            low = read(dataset[f"{name}_low"].isel(own).to_numpy())
            high = read(dataset[f"{name}_high"].isel(own).to_numpy())
            below = np.maximum(y - low, 0.0)
            # no bar where the cage skids within its band
            above = np.where(high < np.inf, np.maximum(high - y, 0.0), 0.0)
            sheet.axes.errorbar(
                x,
                y,
                [below, above],
                fmt="none",
                capsize=2,
                color=colour,
            )
        if (bound_name := BOUNDS.get(name)) in dataset:
            bound = read(dataset[bound_name].isel(at).to_numpy())
            beyond = np.isnan(y)
            sheet.axes.plot(x[beyond], bound[beyond], "^", markersize=4, color=colour)
    return sheet.done(x_label, axis_label(values, unit))
