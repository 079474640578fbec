"""Figures of error against cost: for each result the numerical choices with their front, and beside them the models.

Style, sizes and files are those of `rollslip.results.style`. What is dominated is grey; what is not, and the plan's
choice, has a number, which the legend explains, since names would cover the points. Models all have one. Bars reach
from the fastest round to the slowest. Errors below what is known are drawn at the edge of what is shaded.
"""

import itertools
import json
import math
import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rollslip.results.style import MM, MODEL_COLOURS, TWO_COLUMNS, Sheet, lay_out
from rollslip.search import Array
from rollslip_campaigns.pareto.findings import FINEST, NUMBERS, PLANNED, studies, taking_part

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["front_figures"]

_GREY: Final = "0.62"
_COLOURS: Final = {
    "numerical": MODEL_COLOURS[0],
    "modelling": MODEL_COLOURS[1],
    "film": MODEL_COLOURS[2],
}
#: Directions in which a number may stand from its point, the best first, and distances [pt] that are tried.
_DIRECTIONS: Final = ((1, 1), (1, -1), (-1, 1), (-1, -1), (1, 0), (-1, 0), (0, 1), (0, -1))
_DISTANCES: Final = (3, 6, 10, 16, 24, 36)
#: Distance [pt] from which on a line leads to the point.
_LEADER: Final = 10
#: Columns of the legend.
_COLUMNS: Final = 3


def front_figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Draw the figures; give name, caption and figure of each result that has an error."""
    several = len(json.loads(dataset.attrs["studies"])) > 1
    for study, one in studies(dataset):
        for j, name in enumerate(one["result"].values):
            part = one.isel(result=j)
            if np.isnan(part["error"].to_numpy()[part["label"].to_numpy() == FINEST]).any():
                continue
            slug = re.sub(
                r"[^a-z0-9]+", "-", (f"{study} {name}" if several else str(name)).lower()
            ).strip("-")
            caption = f"{study}, {name}: error against processor time; the line is the front that no choice passes."
            yield f"pareto-{slug}", caption, _figure(part, str(name))


def _figure(part: "xr.Dataset", name: str) -> "Figure":
    shown = {
        number: kinds
        for kinds, (number, _) in NUMBERS.items()
        if taking_part(part, *kinds).size > 1
    }
    sheet = Sheet(
        (TWO_COLUMNS[0], 78 * MM), 1, len(shown), squeeze=False, width_ratios=[3, 2][: len(shown)]
    )
    panels = sheet.axes[0]
    labels: list[tuple[Axes, list[tuple[str, float, float]]]] = []
    for axes, (number, kinds) in zip(panels, shown.items(), strict=True):
        numbered = _panel(axes, part, number, kinds, len(sheet.handles))
        sheet.handles += [handle for handle, *_ in numbered]
        labels.append(
            (
                axes,
                [(str(handle.get_label()).partition("  ")[0], x, y) for handle, x, y in numbered],
            )
        )
    panels[0].set_title(f"{name}: numerical choices" if "error" in shown else f"{name}: models")
    if len(shown) == 2:
        panels[1].set_title("models")
    if sum(len(points) for _, points in labels) < sum(len(axes.containers) for axes in panels):
        sheet.key("dominated", color=_GREY, marker="o", markersize=3.8, linestyle="none")
    figure = sheet.done(
        columns=_COLUMNS, loc="outside lower left", handlelength=1.0, columnspacing=1.2
    )
    lay_out(figure)  # it depends on the place of the axes what a number covers
    for axes, points in labels:
        _write_numbers(axes, points)
    return figure


def _panel(
    axes: "Axes", part: "xr.Dataset", number: str, kinds: Sequence[str], first: int
) -> "list[tuple[Artist, float, float]]":
    """Draw one panel; return what the legend says of each numbered point, and where it is."""
    from matplotlib.lines import Line2D
    from matplotlib.ticker import LogLocator, NullFormatter

    floor = float(part["floor"])
    rows = taking_part(part, *kinds)
    time, low, high = (
        1e3 * part[name].to_numpy() for name in ("seconds", "seconds_low", "seconds_high")
    )
    values = part[number].to_numpy()
    labels = part["label"].to_numpy()
    on_front = part[dict(NUMBERS.values())[number]].to_numpy() == 1
    rows = rows[np.isfinite(values[rows]) & np.isfinite(time[rows])]
    if (
        above := values[rows][values[rows] > floor]
    ).size:  # many decades down to rounding would be empty
        floor = max(floor, 0.1 * float(above.min()))
    drawn = np.maximum(values, floor)
    chosen = rows[on_front[rows]]
    axes.loglog()
    axes.set_autoscale_on(False)  # of a single value it would make nothing
    # cheaper than the next one nothing is known to be more exact, hence steps
    axes.plot(
        np.repeat(time[chosen], 2)[1:],
        np.repeat(drawn[chosen], 2)[:-1],
        color=_COLOURS[kinds[0]],
        linewidth=1.1,
        zorder=2,
    )
    numbered: list[tuple[Artist, float, float]] = []
    for k in rows:
        kind = str(part["kind"].values[k])
        planned = labels[k] == PLANNED
        emphasised = on_front[k] or planned or kind == "film"
        colour = _COLOURS[kind if kind in kinds else kinds[0]] if emphasised else _GREY
        style: dict[str, Any] = {
            "marker": "D" if planned else "s" if kind == "film" else "o",
            "markersize": 5 if planned else 3.8,
            "markerfacecolor": "white" if planned and not on_front[k] else colour,
            "markeredgecolor": "black" if planned else colour,
            "markeredgewidth": 0.9,
            "linestyle": "none",
        }
        spread = [[time[k] - low[k]], [high[k] - time[k]]]
        axes.errorbar(
            time[k],
            drawn[k],
            xerr=spread,
            ecolor=colour,
            elinewidth=0.6,
            zorder=3 + emphasised,
            **style,
        )
        if emphasised or number == "difference":
            text = f"{first + len(numbered) + 1}  {labels[k]}"
            numbered.append((Line2D([], [], label=text, **style), time[k], drawn[k]))
    everything = drawn[rows]
    least = float(everything.min(initial=1.0))
    most = float(everything.max(initial=0.0))
    bottom = 10 ** np.floor(np.log10(min(least, floor) if least < 3 * floor else least) - 0.15)
    axes.set_ylim(bottom, 10 ** np.ceil(np.log10(most) + 0.05))
    least = float(low[rows].min(initial=np.inf))
    most = float(high[rows].max(initial=0.0))
    room = max(1.33, 2.5 * math.sqrt(least / most))  # for two marks of the axis at least
    axes.set_xlim(least / room, most * room)
    if floor > bottom:
        axes.axhspan(bottom, floor, color="0.93", linewidth=0.0, zorder=0)
    for axis in (axes.xaxis, axes.yaxis):
        decades = float(np.ptp(np.log10(axis.get_view_interval())))
        axis.set_major_locator(LogLocator(subs=(1, 2, 5) if decades < 2.0 else (1,), numticks=99))
        axis.set_minor_locator(
            LogLocator(subs=tuple(range(2, 10)) if decades < 4.0 else (1,), numticks=99)
        )
        axis.set_minor_formatter(NullFormatter())
    axes.xaxis.set_major_formatter("{x:g}")
    axes.set(xlabel="Processor time of the study [ms]", ylabel=f"Relative {number} [–]")
    return numbered


def _write_numbers(axes: "Axes", points: Sequence[tuple[str, float, float]]) -> None:
    """Write each number beside its point, where it covers no other number and least of points and lines."""
    from matplotlib.collections import LineCollection

    lines = [np.asarray(line.get_xydata(), dtype=float) for line in axes.lines]
    lines += [
        segment
        for bars in axes.collections
        if isinstance(bars, LineCollection)
        for segment in bars.get_segments()
    ]
    corners = [axes.transData.transform(line) for line in lines if len(line)]
    along = np.linspace(0.0, 1.0, 20)[:, None]
    pixels = [corner for line in corners for corner in line]
    pixels += [
        place
        for line in corners
        for a, b in itertools.pairwise(line)
        for place in a + along * (b - a)
    ]
    covered = np.array(pixels)
    taken = list[Any]()
    markers = np.array([line[0] for line in corners if len(line) == 1])
    points_per_pixel = 72.0 / axes.figure.dpi
    for text, x, y in points:
        own = axes.transData.transform((x, y))
        label = axes.annotate(
            text,
            (x, y),
            (0, 0),
            textcoords="offset points",
            fontsize=6.5,
            ha="center",
            va="center",
            zorder=6,
        )
        size = np.array(label.get_window_extent().size)

        def middle(place: tuple[float, tuple[int, int]], size: Array = size) -> Array:
            """From the point to the middle of the number, in pixels."""
            return np.array(place[1]) * (place[0] / points_per_pixel + 0.5 * size)

        def cost(
            place: tuple[float, tuple[int, int]], size: Array = size, own: Array = own
        ) -> tuple[int, int, float]:
            at = own + middle(place, size)
            low = at - 0.5 * size - 1.0
            high = at + 0.5 * size + 1.0
            words = sum(bool(np.all((low < end) & (begin < high))) for begin, end in taken)
            beyond = not (np.all(low > axes.bbox.min) and np.all(high < axes.bbox.max))
            inside = int(np.count_nonzero(np.all((low < covered) & (covered < high), axis=1)))
            # next to another point it would be read as that point's
            near = np.hypot(*(markers - at).T).min() < np.hypot(*(own - at)) - 1.0
            return words + beyond, inside + 10 * int(near and place[0] < _LEADER), place[0]

        best = min(
            ((distance, towards) for distance in _DISTANCES for towards in _DIRECTIONS), key=cost
        )
        offset = middle(best)
        label.set_position(tuple(points_per_pixel * offset))
        taken.append((own + offset - 0.5 * size, own + offset + 0.5 * size))
        if best[0] >= _LEADER:
            axes.annotate(
                "", (x, y), tuple(points_per_pixel * (offset - 0.5 * size * np.array(best[1]))),
                textcoords="offset points",
                arrowprops={"arrowstyle": "-", "linewidth": 0.4, "color": "0.5", "shrinkA": 0.0, "shrinkB": 2.0},
            )  # fmt: skip
