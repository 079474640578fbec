"""Figures of a thermal balance: the excess heat over temperature with its zeros, and temperatures over time."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from rollslip.results.dataset import xr
from rollslip.results.style import DASHES, MARKER, MODEL_COLOURS, Sheet
from rollslip_studies.thermal_balance.findings import solved

__all__ = ["course", "thermal_figures"]

#: Style of a marker of an unstable balance: an open circle.
_OPEN: dict[str, Any] = {
    "marker": "o",
    "markersize": 4,
    "markerfacecolor": "white",
    "markeredgewidth": 0.9,
}
#: 0 degC in K.
_ZERO = 273.15
#: Longest time [s] that is shown in seconds; longer ones are shown in minutes.
_MAX_SECONDS = 120.0


def thermal_figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Draw the figures; yield name, caption and figure of each."""
    if solved(dataset) and np.isfinite(dataset["excess_heat"]).any():
        node = dataset["node"].to_numpy()[0]
        yield (
            "thermal-balance",
            f"Heat that the {node} gains over its temperature while the other parts follow; balances where it is zero.",
            _excess(dataset),
        )
    if "course_temperature" in dataset:
        yield (
            "thermal-course",
            "Bulk temperatures over time, from those of the scene.",
            course(dataset),
        )


def _excess(dataset: "xr.Dataset") -> "Figure":
    """Draw the excess heat over the temperature of the leading node, with its balances and the limit."""
    sheet = Sheet()
    axes = sheet.axes
    node = str(dataset["node"].to_numpy()[0])
    sheet.line(
        dataset["leading_temperature"].to_numpy() - _ZERO,
        dataset["excess_heat"].to_numpy(),
        "losses less what is carried away",
        color=MODEL_COLOURS[0],
    )
    axes.axhline(0.0, color="black", linewidth=0.6)
    for stable, style, label in (
        (1, MARKER, "stable balance"),
        (0, _OPEN, "unstable balance"),
    ):
        chosen = (dataset["stable"].to_numpy() == stable) & np.isfinite(
            dataset["steady_slip"].to_numpy()
        )
        if chosen.any():
            celsius = dataset["temperature"].to_numpy()[0][chosen] - _ZERO
            values = ", ".join(f"{value:.3g} °C" for value in celsius)
            sheet.mark(celsius, 0.0 * celsius, f"{label}, {values}", zorder=4, **style)
    limit = float(dataset["limit_temperature"]) - _ZERO
    if np.isfinite(limit):
        sheet.mark(
            limit,
            -float(dataset["heat_margin"]),
            f"limit, {limit:.3g} °C",
            marker="v",
            markersize=4,
        )
    return sheet.done(f"Temperature of the {node} [°C]", "Excess heat [W]")


def course(dataset: "xr.Dataset") -> "Figure":
    """Draw the temperatures of the nodes over time."""
    sheet = Sheet()
    time = dataset["time"].to_numpy()
    unit, second = ("min", 60.0) if time[-1] > _MAX_SECONDS else ("s", 1.0)
    time = time / second
    for k, node in enumerate(dataset["node"].to_numpy()):
        values = dataset["course_temperature"].to_numpy()[:, k] - _ZERO
        sheet.line(
            time,
            values,
            f"{node}, {values[-1]:.3g} °C at the end",
            color=MODEL_COLOURS[k % len(MODEL_COLOURS)],
            linestyle=DASHES[k % len(DASHES)],
        )
    sheet.axes.set_xlim(0.0, time[-1] or 1.0)
    return sheet.done(f"Time [{unit}]", "Temperature [°C]")
