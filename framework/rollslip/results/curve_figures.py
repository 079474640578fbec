"""Figures that several studies share: of friction curves, also for studies without their own, and of measured points.

- Figures are readable in grey: curves differ in lightness, and only the thermal branch is dashed.
- Texts are above the curves, in space that is reserved for them.
"""

import json
import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rollslip.results.curves import Curve, Curves, curve_names, curves, percent
from rollslip.results.style import (
    MARKER,
    MM,
    MODEL_COLOURS,
    ROW,
    SINGLE_COLUMN,
    Sheet,
    axis_label,
    lay_out,
    light_to_dark,
    unit_label,
)
from rollslip.results.text import capitalise
from rollslip.search import Array
from rollslip.units import converted, shown_unit

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.text import Annotation, Text

__all__ = [
    "annotate_point",
    "draw_curve",
    "finish",
    "mark_measured",
    "measured_figure",
    "measured_values",
    "new_figure",
    "plain_curves",
]


#: Positions of a label, the best first: offset from its point [pt], alignment. Chosen: close ones first, above before
#: below.
_LABEL_POSITIONS: Final = tuple(
    (x, y, alignment)
    for y in (5, -5, 13, -13)
    for x, alignment in ((0, "center"), (4, "left"), (-4, "right"), (13, "left"), (-13, "right"))
)

#: Letters of a line of the legend, at most, in a figure of one column. With 20 more it is cut at the edge.
_LEGEND_LETTERS: Final = 56


def plain_curves(dataset: "xr.Dataset") -> "Figure":
    """Draw the curves of a dataset over slip, those of small numbers lighter."""
    names = Curves.from_dataset(dataset)
    assert names is not None
    figure, axes = new_figure()
    shown = curves(dataset)
    lines = [
        draw_curve(axes, curve, colour, curve.name)
        for curve, colour in zip(
            shown, light_to_dark()(np.linspace(1.0, 0.0, len(shown))[::-1]), strict=True
        )
    ]
    axes.set_xlabel(axis_label(dataset[names.slip], "", "%"))
    axes.set_ylabel(axis_label(dataset[names.variable], "", "–"))
    finish(figure, axes, shown, lines)
    return figure


def over_slip(dataset: "xr.Dataset", name: str) -> "Figure":
    """Draw a variable of the points of all curves over slip, those of small numbers lighter."""
    curves = Curves.from_dataset(dataset)
    sheet = Sheet()
    assert curves is not None
    labels = curve_names(dataset)
    for k, label in enumerate(labels):
        colour = light_to_dark()(1.0 - k / max(len(labels) - 1, 1))
        sheet.line(100.0 * dataset[curves.slip], dataset[name][k], label, color=colour)
    return sheet.done(
        axis_label(dataset[curves.slip], "", "%"),
        axis_label(dataset[name], "", dataset[name].attrs["units"]),
    )


# Shared by studies ----------------------------------------------------------------------------------------------------


def new_figure() -> "tuple[Figure, Axes]":
    """Return a figure of one column with one panel."""
    sheet = Sheet()
    return sheet.figure, sheet.axes


def draw_curve(
    axes: "Axes", curve: Curve, colour: Any, label: str, *, width: float = 1.4, tinted: bool = False
) -> "Line2D":
    """Draw a curve with its thermal branch dashed; return the line for the legend.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        The panel.
    curve : Curve
        The curve.
    colour : colour of Matplotlib
        Its colour.
    label : str
        Its label in the legend.
    width : float
        Width of the line [pt].
    tinted : bool
        Whether the area below the thermal branch is tinted.
    """
    x, y, start, end = curve.branches()
    x = 100 * x
    (line,) = axes.plot(x[: start + 1], y[: start + 1], color=colour, linewidth=width, label=label)
    if curve.has_critical:
        thermal = slice(start, end + 1)
        if tinted:
            axes.fill_between(x[thermal], 0.0, y[thermal], color=colour, alpha=0.15, linewidth=0.0)
        axes.plot(x[thermal], y[thermal], color=colour, linewidth=width, linestyle="dashed")
        axes.plot(x[end:], y[end:], color=colour, linewidth=width)
        axes.vlines(x[start], 0.0, y[start], color=colour, linewidth=0.7, linestyle="dotted")
        axes.plot(x[start], y[start], color=colour, **MARKER)
    return line


def annotate_point(axes: "Axes", text: str, point: tuple[float, float]) -> "Annotation":
    """Write a text above a point.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        The panel.
    text : str
        The text.
    point : tuple of float
        The point, in data coordinates.
    """
    return axes.annotate(
        text,
        point,
        (0, 5),
        textcoords="offset points",
        horizontalalignment="center",
        bbox={"boxstyle": "square,pad=0.1", "facecolor": "white", "alpha": 0.7, "linewidth": 0.0},
    )


def finish(
    figure: "Figure",
    axes: "Axes",
    shown: Sequence[Curve],
    handles: "Sequence[Artist]",
    others: Array | None = None,
) -> None:
    """Set the ranges of a figure, with space for texts above the curves, and write texts and legend.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        The figure.
    axes : matplotlib.axes.Axes
        Its panel.
    shown : sequence of Curve
        The curves in it.
    handles : sequence of Artist
        Items of the legend.
    others : array, shape (k, n), optional
        Further rows of friction in the panel, at the same slips.
    """
    from matplotlib.lines import Line2D

    rows = np.vstack([curve.friction for curve in shown] + ([] if others is None else [others]))
    finite = rows[np.isfinite(rows)]
    low = finite.min(initial=0.0)
    high = finite.max(initial=0.0)
    # a curve of rounding noise is a zero line, not a range below zero
    if low >= -1e-6 * high:
        low = 0.0
    if high <= low:
        high = low + 1.0
    critical = [curve for curve in shown if curve.has_critical]
    notes = _notes(shown, 66 if others is None else 58)
    room = 0.05 + 0.07 * len(notes.splitlines()) + 0.08 * bool(critical)
    axes.set_ylim(low, low + (high - low) / (1.0 - room))
    axes.set_xlim(100 * shown[0].slip[0], 100 * shown[0].slip[-1])
    written = axes.text(
        0.015, 0.985, notes, transform=axes.transAxes, va="top", fontsize=6.5, color="0.25"
    )
    written.set_in_layout(False)
    if critical:
        assumption = critical[0].assumption
        label = "slip at largest traction; friction falls beyond it"
        if assumption:
            label = f"slip at largest traction {assumption}; friction falls beyond it"
        label = textwrap.fill(label, _LEGEND_LETTERS)
        handles = [
            *handles,
            Line2D([], [], color="0.35", linestyle="dashed", label=label, **MARKER),
        ]
    figure.legend(handles=handles, loc="outside upper left")
    rows_of_legend = sum(1 + str(handle.get_label()).count("\n") for handle in handles)
    figure.set_figheight(SINGLE_COLUMN[1] + ROW * rows_of_legend)
    lay_out(figure)  # the position of the axes decides what a label covers
    _write_critical(axes, critical, rows, written)


def _write_critical(axes: "Axes", critical: Sequence[Curve], rows: Array, written: "Text") -> None:
    """Write the critical slips beside their maxima, each where it covers the least of curves and other texts."""
    taken = [written.get_window_extent()]
    for curve in critical:
        dense = np.linspace(curve.slip[0], curve.slip[-1], 1000)
        points = [np.column_stack((100 * dense, np.interp(dense, curve.slip, row))) for row in rows]
        pixels = axes.transData.transform(np.concatenate(points))
        label = annotate_point(
            axes, percent(curve.critical_slip), (100 * curve.critical_slip, curve.critical_friction)
        )

        def covered(
            position: tuple[float, float, str], label: "Annotation" = label, pixels: Array = pixels
        ) -> int:
            label.set_position(position[:2])
            label.set(
                horizontalalignment=position[2],
                verticalalignment="bottom" if position[1] > 0 else "top",
            )
            box = label.get_window_extent()
            inside = np.all((box.min < pixels) & (pixels < box.max), axis=1)
            overlaps = sum(box.overlaps(other) for other in taken)
            is_outside = not axes.bbox.x0 < box.x0 < box.x1 < axes.bbox.x1
            return int(np.count_nonzero(inside)) + pixels.size * (overlaps + is_outside)

        covered(min(_LABEL_POSITIONS, key=covered))
        taken.append(label.get_window_extent())


def _notes(shown: Sequence[Curve], width: int) -> str:
    """Return the statuses of curves without a critical slip, without advice, each once for all its curves."""
    without: dict[str, list[str]] = {}
    for curve in shown:
        if not curve.has_critical:
            without.setdefault(curve.status.partition(",")[0], []).append(curve.name)
    return "\n".join(
        textwrap.fill(
            status if len(names) == len(shown) else f"{', '.join(names)}: {status}", width
        )
        for status, names in without.items()
    )


# Measured points ------------------------------------------------------------------------------------------------------

#: Style of a measured value, as in figures of data sets.
_MEASURED: Final[dict[str, Any]] = {
    "color": "black",
    "marker": "D",
    "markersize": 3.5,
    "linestyle": "none",
    "elinewidth": 0.9,
    "capsize": 2.0,
    "zorder": 5,
}
#: Half of an error bar over the standard uncertainty: 95 % of a normal error.
_BAR: Final = 1.96


def measured_values(
    dataset: "xr.Dataset", quantity: str = "", keys: Sequence[str] | None = None
) -> list[dict[str, Any]]:
    """Return the measured values of a quantity beside a result.

    Parameters
    ----------
    dataset : xarray.Dataset
        The result.
    quantity : str
        Name of the quantity, "cage_slip"; empty for all.
    keys : sequence of str, optional
        Keys in which the conditions may differ from the scene; by default all.
    """
    records: list[dict[str, Any]] = json.loads(dataset.attrs.get("measured", "[]"))
    first = records[0]["alternative"] if records else ""
    return [
        record
        for record in records
        if record["quantity"] == (quantity or record["quantity"])
        and (keys is None or set(record["differing"]) <= set(keys))
        and record["alternative"] == first
    ]


def mark_measured(sheet: Sheet, x: Any, y: Any, x_error: Any = None, y_error: Any = None) -> None:
    """Mark measured points in a figure, with bars of 95 %; nothing where there are none.

    Parameters
    ----------
    sheet : Sheet
        The figure.
    x, y : array
        The points, in the units of the axes.
    x_error, y_error : array, optional
        Standard uncertainties along the axes.
    """
    if not len(x):
        return
    bars = [None if error is None else _BAR * np.asarray(error) for error in (x_error, y_error)]
    drawn = sheet.axes.errorbar(x, y, bars[1], bars[0], label="measured, 95 %", **_MEASURED)
    sheet.handles.append(drawn)


def measured_figure(dataset: "xr.Dataset") -> "Figure":
    """Draw measured values beside a result and those calculated at their conditions, a panel for each quantity."""
    records: list[dict[str, Any]] = json.loads(dataset.attrs["measured"])
    quantities = list(dict.fromkeys(record["quantity"] for record in records))
    sheet = Sheet(
        (SINGLE_COLUMN[0], 8 * MM + 50 * MM * len(quantities)), len(quantities), squeeze=False
    )
    panels = sheet.axes[:, 0]
    for axes, quantity in zip(panels, quantities, strict=True):
        of_quantity = [record for record in records if record["quantity"] == quantity]
        sheet.axes = axes
        is_first = axes is panels[0]
        shown = sheet.handles
        sheet.handles = shown if is_first else []
        _draw_measured(sheet, quantity, of_quantity)
        sheet.handles = shown
    return sheet.done()


def _draw_measured(sheet: Sheet, quantity: str, records: Sequence[dict[str, Any]]) -> None:
    """Draw the measured and calculated values of a quantity over what varies, or over the rows of the table."""
    axes = sheet.axes
    alternatives = list(dict.fromkeys(record["alternative"] for record in records))
    rows = [record for record in records if record["alternative"] == alternatives[0]]
    x, label = _abscissa(rows)
    values = np.array([row["measured"] for row in rows])
    unit = rows[0]["unit"]
    shown = "%" if "slip" in quantity else shown_unit(float(np.abs(values).max()), unit) or unit
    sigma = converted(np.array([row["standard_uncertainty"] for row in rows]), unit, shown)
    mark_measured(sheet, x, converted(values, unit, shown), y_error=sigma)
    for k, name in enumerate(alternatives):
        own = [record for record in records if record["alternative"] == name]
        calculated, low, high = (
            converted(np.array([np.nan if r[n] is None else r[n] for r in own]), unit, shown)
            for n in ("calculated", "low", "high")
        )
        colour = MODEL_COLOURS[k % len(MODEL_COLOURS)]
        axes.vlines(x, low, high, color=colour, linewidth=3.0, alpha=0.35)
        has_band = bool(np.isfinite(low).any())
        text = f"calculated{', 5 to 95 % where data scatter' * has_band}"
        style: dict[str, Any] = {"color": colour, "linestyle": "none", "zorder": 6, **MARKER}
        sheet.line(x, calculated, f"{name}, {text}" if name else text, **style)
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    axes.set_xlabel(label)
    axes.set_ylabel(f"{_named(quantity)} [{shown if shown == '%' else unit_label(shown)}]")


def _abscissa(rows: Sequence[dict[str, Any]]) -> tuple[Any, str]:
    """Return where rows stand along an axis, and its label: what varies alone, or the number of the row."""
    varied = [
        key
        for key, (_, unit) in rows[0]["conditions"].items()
        if unit and len({row["conditions"][key][0] for row in rows}) > 1
    ]
    if len(varied) != 1:
        return np.arange(1, len(rows) + 1), "Row of the table"
    values = np.array([row["conditions"][varied[0]][0] for row in rows])
    unit = rows[0]["conditions"][varied[0]][1]
    shown = shown_unit(float(np.abs(values).max()), unit) or unit
    return converted(values, unit, shown), f"{_named(varied[0])} [{unit_label(shown)}]"


def _named(key: str) -> str:
    """Return the name of a key or of a quantity for an axis."""
    return capitalise(key.rpartition(".")[2].rpartition("/")[2].replace("_", " "))
