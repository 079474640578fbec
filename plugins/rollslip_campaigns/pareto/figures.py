"""Draw errors over costs: for each result the numerical choices with their front, and beside them the models.

Style, sizes and files are those of `rollslip.results.style`. Dominated choices are grey. All others, the plan and all
models have a number that the legend explains, because names would cover the points. Bars extend from the fastest to the
slowest round. Errors below the floor are drawn at the edge of the shaded range.
"""

import itertools
import json
import math
import re
from collections.abc import Iterator, Sequence
from typing import Any, Final

import attrs
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rollslip.results.dataset import xr
from rollslip.results.style import MM, MODEL_COLOURS, TWO_COLUMNS, Sheet, lay_out
from rollslip.search import Array
from rollslip_campaigns.pareto.findings import NUMBERS, PLANNED, REFERENCE, rows_of_kinds, studies

__all__ = ["front_figures"]

#: Colour of dominated choices.
_GREY: Final = "0.62"
#: Colours by kind of choice.
_COLOURS: Final = {
    "numerical": MODEL_COLOURS[0],
    "modelling": MODEL_COLOURS[1],
    "film": MODEL_COLOURS[2],
}
#: Directions of a number from its point, the preferred one first.
_DIRECTIONS: Final = ((1, 1), (1, -1), (-1, 1), (-1, -1), (1, 0), (-1, 0), (0, 1), (0, -1))
#: Distances [pt] of a number from its point that are tried. Chosen by the size of the numbers, 6.5 pt.
_DISTANCES: Final = (3, 6, 10, 16, 24, 36)
#: Distance [pt] from which on a line connects number and point. Chosen; halving it draws lines beside most points.
_LEADER: Final = 10
#: Points on each segment of a line that a number should not cover. Doubling it doubles the time; chosen.
_LINE_POINTS: Final = 20
#: Cost of a number that is nearer to another point, in covered points of lines.
_AMBIGUITY_COST: Final = 10
#: Columns of the legend.
_COLUMNS: Final = 3


def front_figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Yield name, caption and figure of each result that has an error."""
    several = len(json.loads(dataset.attrs["studies"])) > 1
    for study, selected in studies(dataset):
        for j, name in enumerate(selected["result"].values):
            part = selected.isel(result=j)
            if np.isnan(part["error"].to_numpy()[part["label"].to_numpy() == REFERENCE]).any():
                continue
            text = f"{study} {name}" if several else str(name)
            yield (
                f"pareto-{re.sub(r'[^a-z0-9]+', '-', text.lower()).strip('-')}",
                f"{study}, {name}: error against processor time; the line is the front that no choice passes.",
                _figure(part, str(name)),
            )


def _figure(part: "xr.Dataset", name: str) -> "Figure":
    """Return the figure of a result: a panel of numerical choices, and one of models."""
    shown = {
        number: kinds
        for kinds, (number, _) in NUMBERS.items()
        if rows_of_kinds(part, *kinds).size > 1
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
    lay_out(figure)  # what a number covers depends on the final position of the axes
    for axes, points in labels:
        _write_numbers(axes, points)
    return figure


def _panel(
    axes: "Axes", part: "xr.Dataset", number: str, kinds: Sequence[str], first: int
) -> "list[tuple[Artist, float, float]]":
    """Draw one panel; return the entry of the legend and the position of each numbered point."""
    from matplotlib.lines import Line2D

    floor = float(part["floor"])
    rows = rows_of_kinds(part, *kinds)
    time, low, high = (
        1e3 * part[name].to_numpy() for name in ("seconds", "seconds_low", "seconds_high")
    )
    values = part[number].to_numpy()
    labels = part["label"].to_numpy()
    on_front = part[dict(NUMBERS.values())[number]].to_numpy() == 1
    rows = rows[np.isfinite(values[rows]) & np.isfinite(time[rows])]
    above = values[rows][values[rows] > floor]
    if above.size:  # many decades down to rounding would be empty
        floor = max(floor, 0.1 * float(above.min()))
    drawn = np.maximum(values, floor)
    chosen = rows[on_front[rows]]
    axes.loglog()
    axes.set_autoscale_on(False)  # a single value would have no range
    # between two points of the front no cheaper choice is more exact, hence steps
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
        planned = bool(labels[k] == PLANNED)
        emphasised = on_front[k] or planned or kind == "film"
        colour = _GREY
        if emphasised:
            colour = _COLOURS[kind if kind in kinds else kinds[0]]
        # a diamond for the plan, a square for a film, a circle for others
        style: dict[str, Any] = {
            "marker": "D" if planned else {"film": "s"}.get(kind, "o"),
            "markersize": 5 if planned else 3.8,
            "markerfacecolor": "white" if planned and not on_front[k] else colour,
            "markeredgecolor": "black" if planned else colour,
            "markeredgewidth": 0.9,
            "linestyle": "none",
        }
        axes.errorbar(
            time[k],
            drawn[k],
            xerr=[[time[k] - low[k]], [high[k] - time[k]]],
            ecolor=colour,
            elinewidth=0.6,
            zorder=3 + emphasised,
            **style,
        )
        if emphasised or number == "difference":
            text = f"{first + len(numbered) + 1}  {labels[k]}"
            numbered.append((Line2D([], [], label=text, **style), time[k], drawn[k]))
    _set_limits(axes, low[rows], high[rows], drawn[rows], floor)
    axes.set(xlabel="Processor time of the study [ms]", ylabel=f"Relative {number} [–]")
    return numbered


def _set_limits(axes: "Axes", low: Array, high: Array, drawn: Array, floor: float) -> None:
    """Set limits and marks of both logarithmic axes, and shade the errors below the floor."""
    from matplotlib.ticker import LogLocator, NullFormatter

    smallest = float(drawn.min(initial=1.0))
    largest = float(drawn.max(initial=0.0))
    if smallest < 3 * floor:
        smallest = min(smallest, floor)
    bottom = 10 ** np.floor(np.log10(smallest) - 0.15)
    axes.set_ylim(bottom, 10 ** np.ceil(np.log10(largest) + 0.05))
    fastest = float(low.min(initial=np.inf))
    slowest = float(high.max(initial=0.0))
    room = max(1.33, 2.5 * math.sqrt(fastest / slowest))  # for at least two marks of the axis
    axes.set_xlim(fastest / room, slowest * room)
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


@attrs.frozen(eq=False)
class _Obstacles:
    """What a number should not cover, in pixels: points of lines, points with markers, and other numbers."""

    axes: "Axes"
    lines: Array
    markers: Array
    numbers: list[tuple[Array, Array]] = attrs.field(factory=list)

    @classmethod
    def from_axes(cls, axes: "Axes") -> "_Obstacles":
        """Return the lines, error bars and markers of axes."""
        from matplotlib.collections import LineCollection

        lines = [np.asarray(line.get_xydata(), dtype=float) for line in axes.lines]
        for bars in axes.collections:
            if isinstance(bars, LineCollection):
                lines += bars.get_segments()
        corners = [axes.transData.transform(line) for line in lines if len(line)]
        steps = np.linspace(0.0, 1.0, _LINE_POINTS)[:, None]
        pixels = [corner for line in corners for corner in line]
        for line in corners:
            for a, b in itertools.pairwise(line):
                pixels += list(a + steps * (b - a))
        return cls(
            axes, np.array(pixels), np.array([line[0] for line in corners if len(line) == 1])
        )

    def cost(
        self, point: Array, centre: Array, size: Array, distance: float
    ) -> tuple[int, int, float]:
        """Return the cost of a number of some size at a centre: covered numbers, covered points, and distance."""
        low = centre - 0.5 * size - 1.0
        high = centre + 0.5 * size + 1.0
        overlaps = sum(bool(np.all((low < end) & (start < high))) for start, end in self.numbers)
        box = self.axes.bbox
        outside = not (np.all(low > box.min) and np.all(high < box.max))
        covered = int(np.count_nonzero(np.all((low < self.lines) & (self.lines < high), axis=1)))
        # a number next to another point would be read as that of the other point
        nearest = np.hypot(*(self.markers - centre).T).min()
        ambiguous = nearest < np.hypot(*(point - centre)) - 1.0 and distance < _LEADER
        return overlaps + outside, covered + _AMBIGUITY_COST * int(ambiguous), distance


def _write_numbers(axes: "Axes", points: Sequence[tuple[str, float, float]]) -> None:
    """Write each number beside its point, where it covers no other number and the fewest points and lines."""
    obstacles = _Obstacles.from_axes(axes)
    points_per_pixel = 72.0 / axes.figure.dpi
    for text, x, y in points:
        point = axes.transData.transform((x, y))
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
        positions = list(itertools.product(_DISTANCES, _DIRECTIONS))
        # vectors from the point to the centre of the number, in pixels
        offsets = [
            np.array(towards) * (distance / points_per_pixel + 0.5 * size)
            for distance, towards in positions
        ]
        costs = [
            obstacles.cost(point, point + offset, size, distance)
            for offset, (distance, _) in zip(offsets, positions, strict=True)
        ]
        best = costs.index(min(costs))
        offset = offsets[best]
        distance, towards = positions[best]
        label.set_position(tuple(points_per_pixel * offset))
        obstacles.numbers.append((point + offset - 0.5 * size, point + offset + 0.5 * size))
        if distance >= _LEADER:
            axes.annotate(
                "",
                (x, y),
                tuple(points_per_pixel * (offset - 0.5 * size * np.array(towards))),
                textcoords="offset points",
                arrowprops={
                    "arrowstyle": "-",
                    "linewidth": 0.4,
                    "color": "0.5",
                    "shrinkA": 0.0,
                    "shrinkB": 2.0,
                },
            )
