"""Draw the figure of a ranking: the error of each law with its interval, and on each condition."""

from collections.abc import Iterator

import numpy as np
from matplotlib.figure import Figure

from rollslip.results.dataset import rows_along, xr
from rollslip.results.style import MM, MODEL_COLOURS, TWO_COLUMNS, Sheet, plain_decades
from rollslip_campaigns.validation.ranking_findings import better

__all__ = ["figures"]


def figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Yield name, caption and figure, if a law has an error."""
    if np.isfinite(dataset["error"].to_numpy()).any():
        caption = (
            "Error of each law on conditions that it was not fitted to, over the uncertainty of the data: every "
            "condition, their geometric mean and its 95 % interval. Open: cannot be determined from the first."
        )
        yield "ranking", caption, _errors(dataset)


def _errors(dataset: "xr.Dataset") -> "Figure":
    """Return a figure of the errors of all laws."""
    laws = rows_along(dataset, "law")
    sheet = Sheet((TWO_COLUMNS[0], (22 + 8 * len(laws)) * MM))
    axes = sheet.axes
    worse, _ = better(dataset, 0)
    for k, (law, errors) in enumerate(
        zip(laws, dataset["condition_error"].to_numpy(), strict=True)
    ):
        colour = MODEL_COLOURS[k % len(MODEL_COLOURS)]
        axes.plot(
            errors, np.full(errors.size, k + 0.25), "|", color=colour, markersize=5, alpha=0.6
        )
        if np.isfinite(law["error_low"]):
            axes.plot([law["error_low"], law["error_high"]], [k, k], color=colour, linewidth=1.4)
        face = colour if k == 0 or law["law"] in worse else "white"
        axes.plot(law["error"], k, "o", color=colour, markerfacecolor=face, markersize=5)
    axes.axvline(1.0, color="0.6", linewidth=0.7, zorder=0)
    plain_decades(axes.xaxis)
    axes.set_ylim(len(laws) - 0.4, -0.6)
    axes.set_yticks(range(len(laws)), [f"{law['law']}, {law['parameters']} fitted" for law in laws])
    return sheet.done("Error over the uncertainty of the data [–]")
