"""The figure of a search for a limit: the result over what is searched, the limit, and where it is kept.

Style, sizes and files are those of `rollslip.results.style`.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from rollslip.results.style import DASHES, MODEL_COLOURS, Sheet, plain_decades, unit_label
from rollslip.results.words import in_percent, short_label
from rollslip.units import converted, shown_unit
from rollslip_campaigns.limit.findings import headline, satisfied_spans
from rollslip_studies.steady_slip.figures import catalogue_loads, mark_loads

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

__all__ = ["limit_figures", "over_searched"]


def limit_figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Draw the figure; give name, caption and figure, if any point has a result."""
    if np.isfinite(dataset["result"].to_numpy()).any():
        yield "limit", f"{headline(dataset)}; shaded is where it is kept.", over_searched(dataset)


def over_searched(dataset: "xr.Dataset") -> "Figure":
    """Draw the result over what is searched."""
    sheet = Sheet()
    axes = sheet.axes
    x, of_x = _shown(dataset["searched"], dataset.attrs["searched_given"])
    y, of_y = _shown(dataset["result"], dataset.attrs["limit_given"])
    limit = float(converted(float(dataset.attrs["limit"]), dataset["result"].attrs["units"], of_y))
    keeps = dataset["keeps"].to_numpy() > 0.0
    known = np.isfinite(y)
    for low, high, *_ in satisfied_spans(dataset):
        ends = converted(np.array([low, high]), dataset["searched"].attrs["units"], of_x)
        axes.axvspan(*ends, color=MODEL_COLOURS[2], alpha=0.15, linewidth=0.0)
    axes.plot(x[known], y[known], color="0.6", linewidth=0.8, zorder=2)
    for which, face, label in ((keeps, MODEL_COLOURS[0], "kept"), (~keeps, "white", "not kept")):
        if (which & known).any():
            style: dict[str, Any] = {
                "markerfacecolor": face,
                "markeredgecolor": MODEL_COLOURS[0],
                "zorder": 3,
            }
            sheet.line(
                x[which & known],
                y[which & known],
                label,
                marker="o",
                linestyle="none",
                markersize=4,
                **style,
            )
    line: dict[str, Any] = {"color": MODEL_COLOURS[1], "linestyle": DASHES[1], "linewidth": 1.0}
    sheet.handles.append(axes.axhline(limit, label="limit", **line))
    if dataset.attrs["logarithmic"]:
        plain_decades(axes.xaxis)
    if dataset.attrs["searched_key"] == "operation.radial_load" and in_percent(
        dataset.attrs["output"], "1"
    ):
        mark_loads(sheet, catalogue_loads(dataset), of_x)
    return sheet.done(
        f"{_name(short_label(dataset.attrs['searched_key']))} [{unit_label(of_x)}]",
        f"{_name(dataset['result'].attrs['long_name'])} [{unit_label(of_y)}]",
        columns=3 if len(sheet.handles) <= 3 else 1,
    )


def _shown(values: "xr.DataArray", given: str) -> tuple[Any, str]:
    """Values in the unit that people read, and that unit."""
    unit = str(values.attrs["units"])
    numbers = values.to_numpy()
    shown = given or shown_unit(float(np.nanmax(np.abs(numbers))), unit) or unit
    return converted(numbers, unit, shown), shown


def _name(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}"
