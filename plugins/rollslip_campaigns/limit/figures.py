"""The figure of a search for a limit: the result over the varied quantity, the limit, and where it is kept.

Style, sizes and files are those of `rollslip.results.style`.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from rollslip.results.dataset import xr
from rollslip.results.style import DASHES, MODEL_COLOURS, Sheet, plain_decades, unit_label
from rollslip.results.text import capitalise, in_percent, short_label
from rollslip.units import converted, shown_unit
from rollslip_campaigns.limit.findings import describe_limit, satisfied_spans
from rollslip_studies.steady_slip.figures import catalogue_loads, mark_loads

__all__ = ["draw_limit", "limit_figures"]


def limit_figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Draw the figure if any point has a result; yield its name, caption and figure."""
    if np.isfinite(dataset["result"].to_numpy()).any():
        yield (
            "limit",
            f"{describe_limit(dataset)}; shaded is where it is kept.",
            draw_limit(dataset),
        )


def draw_limit(dataset: "xr.Dataset") -> "Figure":
    """Draw the result over the varied quantity, with the limit and the spans in which it is kept."""
    sheet = Sheet()
    axes = sheet.axes
    x, x_unit = _converted(dataset["searched"], dataset.attrs["searched_given"])
    y, y_unit = _converted(dataset["result"], dataset.attrs["limit_given"])
    limit = float(
        converted(float(dataset.attrs["limit"]), dataset["result"].attrs["units"], y_unit)
    )
    satisfied = dataset["keeps"].to_numpy() > 0.0
    known = np.isfinite(y)
    for low, high, *_ in satisfied_spans(dataset):
        bounds = converted(np.array([low, high]), dataset["searched"].attrs["units"], x_unit)
        axes.axvspan(*bounds, color=MODEL_COLOURS[2], alpha=0.15, linewidth=0.0)
    axes.plot(x[known], y[known], color="0.6", linewidth=0.8, zorder=2)
    for marked, face, label in (
        (satisfied & known, MODEL_COLOURS[0], "kept"),
        (~satisfied & known, "white", "not kept"),
    ):
        if marked.any():
            sheet.line(
                x[marked],
                y[marked],
                label,
                marker="o",
                linestyle="none",
                markersize=4,
                markerfacecolor=face,
                markeredgecolor=MODEL_COLOURS[0],
                zorder=3,
            )
    sheet.handles.append(
        axes.axhline(
            limit, label="limit", color=MODEL_COLOURS[1], linestyle=DASHES[1], linewidth=1.0
        )
    )
    if dataset.attrs["logarithmic"]:
        plain_decades(axes.xaxis)
    if dataset.attrs["searched_key"] == "operation.radial_load" and in_percent(
        dataset.attrs["output"], "1"
    ):
        mark_loads(sheet, catalogue_loads(dataset), x_unit)
    return sheet.done(
        f"{capitalise(short_label(dataset.attrs['searched_key']))} [{unit_label(x_unit)}]",
        f"{capitalise(dataset['result'].attrs['long_name'])} [{unit_label(y_unit)}]",
        columns=3 if len(sheet.handles) <= 3 else 1,
    )


def _converted(values: "xr.DataArray", given: str) -> tuple[Any, str]:
    """Values in the given unit, or else in the usual one, and that unit."""
    unit = str(values.attrs["units"])
    numbers = values.to_numpy()
    shown = given or shown_unit(float(np.nanmax(np.abs(numbers))), unit) or unit
    return converted(numbers, unit, shown), shown
