"""Figure of a ranking: the error of each law with its interval, and on every condition."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from rollslip.results.style import MM, MODEL_COLOURS, TWO_COLUMNS, Sheet
from rollslip_campaigns.validation.ranking_findings import better

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

__all__ = ["figures"]


def figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Draw the figure; give name, caption and figure."""
    if np.isfinite(dataset["error"].to_numpy()).any():
        caption = (
            "Error of each law on conditions that it was not fitted to, over the uncertainty of the data: every "
            "condition, their geometric mean and its 95 % interval. Open: cannot be determined from the first."
        )
        yield "ranking", caption, _errors(dataset)


def _errors(dataset: "xr.Dataset") -> "Figure":
    from matplotlib.ticker import LogLocator, NullFormatter

    names = [str(name) for name in dataset["law"].to_numpy()]
    sheet = Sheet((TWO_COLUMNS[0], (22 + 8 * len(names)) * MM))
    axes = sheet.axes
    worse, _ = better(dataset, 0)
    for k, name in enumerate(names):
        one = dataset.isel(law=k)
        colour = MODEL_COLOURS[k % len(MODEL_COLOURS)]
        each = one["condition_error"].to_numpy()
        axes.plot(each, np.full(each.size, k + 0.25), "|", color=colour, markersize=5, alpha=0.6)
        low, high, error = (float(one[n]) for n in ("error_low", "error_high", "error"))
        if np.isfinite(low):
            axes.plot([low, high], [k, k], color=colour, linewidth=1.4)
        face = colour if k == 0 or name in worse else "white"
        axes.plot(error, k, "o", color=colour, markerfacecolor=face, markersize=5)
    axes.axvline(1.0, color="0.6", linewidth=0.7, zorder=0)
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_ylim(len(names) - 0.4, -0.6)
    parameters = dataset["parameters"].to_numpy()
    axes.set_yticks(range(len(names)), [f"{name}, {int(n)} fitted" for name, n in zip(names, parameters, strict=True)])
    return sheet.done("Error over the uncertainty of the data [–]")
