"""Draw the atlas of a validation: calculated over measured values of all series, each series, and the statements."""

import math
from collections.abc import Iterator, Mapping
from itertools import cycle
from typing import Any, Final

import numpy as np
from matplotlib.figure import Figure

from rollslip.results.dataset import rows_along, xr
from rollslip.results.style import (
    MM,
    MODEL_COLOURS,
    ROW,
    TWO_COLUMNS,
    Sheet,
    plain_decades,
    unit_label,
)
from rollslip.units import converted, shown_unit
from rollslip_campaigns.validation.findings import UNDETERMINED, models_of, unique_texts

__all__ = ["figures"]

#: Markers of models.
_MARKS: Final = "osD^vP*X"
#: Lower end of the axis of ratios; an arrow marks ratios below it. A smaller one makes deviations of a few per cent
#: harder to read; chosen.
_MIN_RATIO = 1e-2
#: Upper end of the axis of ratios; an arrow marks ratios above it. Chosen: as far from 1 as the lower end.
_MAX_RATIO = 1e2
#: Ratio of the largest to the smallest measured value above which the axis of a series is logarithmic.
#: Doubled, values of a fortieth of the largest stand at the foot of a linear axis. Chosen: at a twentieth of the height
#: a mark is still apart from zero.
_LOG_AXIS_RATIO = 20.0
#: Number of conditions up to which their labels fit below the axis. Chosen.
_MAX_LABELS = 6
#: Upper end of a line whose band is unbounded: far beyond any axis.
_UNBOUNDED = 1e30


def figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Yield name, caption and figure of each figure."""
    if dataset.sizes["row"]:
        caption = "Calculated over measured, with the 95 % band of both uncertainties; at the edge, beyond the range."
        yield "validation", caption, _ratios(dataset)
        for k, (data_set, series) in enumerate(unique_texts(dataset, "data_set", "series"), 1):
            mask = (dataset["row_data_set"].to_numpy() == data_set) & (
                dataset["row_series"].to_numpy() == series
            )
            selected = dataset.isel(row=np.flatnonzero(mask))
            caption = f"{data_set}: {series}. Bands of 95 %; open where it cannot be determined."
            yield f"validation-{data_set}-{k}", caption, _series(selected)
    # of one combination of models a sentence counts the statements that hold
    if np.unique(dataset["statement_models"]).size > 1:
        caption = (
            "Which statements hold under which models: filled, they hold; crossed, they do not; open, it cannot be "
            "determined."
        )
        yield "validation-statements", caption, _statements(dataset)


def _colours(dataset: "xr.Dataset") -> Mapping[str, tuple[str, str]]:
    """Return colour and marker of each combination of models."""
    return dict(
        zip(
            models_of(dataset),
            zip(cycle(MODEL_COLOURS), cycle(_MARKS), strict=False),
            strict=False,
        )
    )


def _sheet(rows: int, models: int) -> Sheet:
    """Return a sheet with room for some rows and a legend of models."""
    return Sheet((TWO_COLUMNS[0], max((18 + 3.4 * rows) * MM + ROW * (1 + models // 3), 45 * MM)))


def _ratios(dataset: "xr.Dataset") -> "Figure":
    """Return a figure of ratios: a line for each row of a data set, a marker for each combination of models."""
    keys = unique_texts(dataset, "data_set", "series", "condition")
    colours = _colours(dataset)
    sheet = _sheet(len(keys) * max(1, len(colours) // 2), len(colours))
    axes = sheet.axes
    step = 0.7 / max(len(colours), 1)
    for row in rows_along(dataset, "row"):
        key = (row["row_data_set"], row["row_series"], row["row_condition"])
        position = keys.index(key) + step * (
            list(colours).index(row["row_models"]) - (len(colours) - 1) / 2
        )
        colour, mark = colours[row["row_models"]]
        ratio, low, high = np.clip(
            [row[name] for name in ("ratio", "ratio_low", "ratio_high")], _MIN_RATIO, _MAX_RATIO
        )
        if not math.isnan(low):
            axes.plot([low, high], [position, position], color=colour, linewidth=1.0)
        if not math.isnan(ratio):
            face = "white" if row["row_verdict"] == UNDETERMINED else colour
            if ratio >= _MAX_RATIO:
                mark = ">"
            elif ratio <= _MIN_RATIO:
                mark = "<"
            axes.plot(ratio, position, mark, color=colour, markerfacecolor=face, markersize=4)
    axes.axvline(1.0, color="0.6", linewidth=0.7, zorder=0)
    plain_decades(axes.xaxis)
    axes.set(ylim=(len(keys) - 0.4, -0.6), xlabel="Calculated over measured [–]")
    axes.set_yticks(
        range(len(keys)), [f"{series}: {unit_label(condition)}" for _, series, condition in keys]
    )
    return _finish(sheet, colours)


def _series(dataset: "xr.Dataset") -> "Figure":
    """Return a figure of measured and calculated values of a series, over its conditions."""
    colours = _colours(dataset)
    rows = rows_along(dataset, "row")
    conditions = list(dict.fromkeys(row["row_condition"] for row in rows))
    sheet = Sheet((TWO_COLUMNS[0], 70 * MM + ROW * (1 + len(colours) // 3)))
    sheet.key("measured, 95 %", color="0.2", marker="_")
    axes = sheet.axes
    quantity = rows[0]["row_quantity"]
    values = np.abs(dataset["measured"].to_numpy())
    unit, factor = _axis_unit(rows[0]["row_unit"], quantity, float(np.median(values)))
    largest = 0.0
    for k, condition in enumerate(conditions):
        same = [row for row in rows if row["row_condition"] == condition]
        measured = factor * same[0]["measured"]
        error = 1.96 * factor * same[0]["uncertainty"]
        axes.errorbar(
            k - 0.3, measured, error, color="0.2", marker="_", markersize=8, elinewidth=1.2
        )
        largest = max(largest, measured + error, *_draw_models(axes, k, same, colours, factor))
    if values.min() > 0.0 and values.max() > _LOG_AXIS_RATIO * values.min():
        plain_decades(axes.yaxis)
    else:
        axes.set_ylim(0.0, 1.1 * largest)
    axes.set_xlim(-0.6, len(conditions) - 0.4)
    if len(conditions) <= _MAX_LABELS:
        axes.set_xticks(
            range(len(conditions)),
            [unit_label(condition).replace(", ", "\n") for condition in conditions],
        )
    else:
        axes.set_xlabel("Row of the data set")
    name = (quantity.partition("/")[2] or quantity).replace("-", " ").replace("_", " ")
    axes.set_ylabel(f"{name.capitalize()} [{unit if unit == '%' else unit_label(unit)}]")
    return _finish(sheet, colours)


def _axis_unit(unit: str, quantity: str, size: float) -> tuple[str, float]:
    """Return a readable unit for values of some size, and the factor from the SI unit; slips are in percent."""
    if unit == "1" and "slip" in quantity:
        return "%", 100.0
    readable = shown_unit(size, unit)
    return readable, 100.0 if readable == "%" else converted(1.0, unit, readable)


def _draw_models(
    axes: Any,
    k: int,
    rows: list[dict[str, Any]],
    colours: Mapping[str, tuple[str, str]],
    factor: float,
) -> list[float]:
    """Draw the calculated values of condition k with their bands; return the finite values."""
    step = 0.6 / (len(colours) + 1)
    finite = list[float]()
    for row in rows:
        colour, mark = colours[row["row_models"]]
        position = k - 0.3 + step * (1 + list(colours).index(row["row_models"]))
        value, low, high = (
            factor * row[name] for name in ("calculated", "calculated_low", "calculated_high")
        )
        if math.isfinite(low):
            finite += [end for end in (low, high) if math.isfinite(end)]
            axes.vlines(position, low, high if math.isfinite(high) else _UNBOUNDED, color=colour)
        if math.isfinite(value):
            face = "white" if row["row_verdict"] == UNDETERMINED else colour
            axes.plot(position, value, mark, color=colour, markerfacecolor=face, markersize=4.5)
            finite.append(value)
    return finite


def _statements(dataset: "xr.Dataset") -> "Figure":
    """Return a figure with a marker for each statement and combination of models."""
    rows = rows_along(dataset, "statement")
    texts, models = (
        list(dict.fromkeys(row[f"statement_{name}"] for row in rows)) for name in ("text", "models")
    )
    sheet = _sheet(len(texts) + 3, 0)
    axes = sheet.axes
    marks = {"held": ("o", "#0072B2", "#0072B2"), "not held": ("X", "#D55E00", "#D55E00"),
             "cannot be determined": ("o", "white", "0.4")}  # fmt: skip
    for row in rows:
        mark, face, edge = marks[row["statement_verdict"]]
        position = models.index(row["statement_models"]), texts.index(row["statement_text"])
        axes.plot(*position, mark, markerfacecolor=face, markeredgecolor=edge, markersize=6)
    axes.set_xticks(range(len(models)), models, rotation=20 if len(models) > 3 else 0)
    axes.set_yticks(range(len(texts)), texts)
    axes.set(xlim=(-0.5, len(models) - 0.5), ylim=(len(texts) - 0.5, -0.5))
    axes.xaxis.tick_top()
    axes.grid(visible=True, color="0.92")
    axes.set_axisbelow(True)
    return sheet.done()


def _finish(sheet: Sheet, colours: Mapping[str, tuple[str, str]]) -> "Figure":
    """Add a legend of the models, for which the sheet has room, and return the figure."""
    for name, (colour, mark) in colours.items():
        sheet.key(name, color=colour, marker=mark, linestyle="solid", markersize=4)
    sheet.figure.legend(handles=sheet.handles, loc="outside upper left", ncols=3)
    return sheet.figure
