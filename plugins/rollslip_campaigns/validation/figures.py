"""The atlas of a validation: calculated over measured of all series, each series by itself, and the statements."""

import math
from collections.abc import Iterator, Mapping
from itertools import cycle
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rollslip.results.dataset import rows_along
from rollslip.results.style import MM, MODEL_COLOURS, ROW, TWO_COLUMNS, Sheet, unit_label
from rollslip.units import converted, shown_unit
from rollslip_campaigns.validation.findings import UNDETERMINED, models_of, together

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

__all__ = ["figures"]

_MARKS: Final = "osD^vP*X"
#: Ends of the axis of ratios: beyond them a mark says that there is more.
_LEAST = 1e-2
_MOST = 1e2


def figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Draw the figures; give name, caption and figure of each."""
    if dataset.sizes["row"]:
        caption = "Calculated over measured, with the 95 % band of both uncertainties; at the edge, beyond the range."
        yield "validation", caption, _ratios(dataset)
        for k, (data_set, series) in enumerate(together(dataset, "data_set", "series"), 1):
            mask = (dataset["row_data_set"].to_numpy() == data_set) & (
                dataset["row_series"].to_numpy() == series
            )
            one = dataset.isel(row=np.flatnonzero(mask))
            caption = f"{data_set}: {series}. Bands of 95 %; open where nothing can be told."
            yield f"validation-{data_set}-{k}", caption, _series(one)
    if dataset.sizes["statement"]:
        caption = "Which statements hold under which models: filled, they hold; crossed, they do not; open, not told."
        yield "validation-statements", caption, _statements(dataset)


def _colours(dataset: "xr.Dataset") -> Mapping[str, tuple[str, str]]:
    styles = zip(models_of(dataset), cycle(MODEL_COLOURS), cycle(_MARKS), strict=False)
    return {name: (colour, mark) for name, colour, mark in styles}


def _sheet(rows: int, models: int) -> Sheet:
    return Sheet((TWO_COLUMNS[0], max((18 + 3.4 * rows) * MM + ROW * (1 + models // 3), 45 * MM)))


def _ratios(dataset: "xr.Dataset") -> "Figure":
    """One line a row of a data set, one mark a model."""
    keys = together(dataset, "data_set", "series", "condition")
    colours = _colours(dataset)
    sheet = _sheet(len(keys) * max(1, len(colours) // 2), len(colours))
    axes = sheet.axes
    step = 0.7 / max(len(colours), 1)
    for one in rows_along(dataset, "row"):
        key = one["row_data_set"], one["row_series"], one["row_condition"]
        place = keys.index(key) + step * (
            list(colours).index(one["row_models"]) - (len(colours) - 1) / 2
        )
        colour, mark = colours[one["row_models"]]
        ratio, low, high = np.clip(
            [one[name] for name in ("ratio", "ratio_low", "ratio_high")], _LEAST, _MOST
        )
        if not math.isnan(low):
            axes.plot([low, high], [place, place], color=colour, linewidth=1.0)
        if not math.isnan(ratio):
            face = "white" if one["row_verdict"] == UNDETERMINED else colour
            edge = ">" if ratio >= _MOST else "<" if ratio <= _LEAST else mark
            axes.plot(ratio, place, edge, color=colour, markerfacecolor=face, markersize=4)
    axes.axvline(1.0, color="0.6", linewidth=0.7, zorder=0)
    plain_log(axes.xaxis)
    axes.set(ylim=(len(keys) - 0.4, -0.6), xlabel="Calculated over measured [–]")
    axes.set_yticks(range(len(keys)), [f"{series}: {condition}" for _, series, condition in keys])
    return _done(sheet, colours)


def plain_log(axis: Any) -> None:
    """Make an axis logarithmic, with the plain numbers 1, 2, 5, 10 ... where Matplotlib finds room for them."""
    from matplotlib.ticker import LogLocator, NullFormatter

    axis.axes.set(**{f"{axis.axis_name}scale": "log"})
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(lambda value, _: f"{value:g}")
    axis.set_minor_formatter(NullFormatter())


def _series(dataset: "xr.Dataset") -> "Figure":
    """Measured and calculated values of a series, one place a condition."""
    colours = _colours(dataset)
    rows = rows_along(dataset, "row")
    conditions = list(dict.fromkeys(one["row_condition"] for one in rows))
    sheet = Sheet((TWO_COLUMNS[0], 70 * MM + ROW * (1 + len(colours) // 3)))
    sheet.key("measured, 95 %", color="0.2", marker="_")
    axes = sheet.axes
    unit = rows[0]["row_unit"]
    quantity = rows[0]["row_quantity"]
    every = np.abs(dataset["measured"].to_numpy())
    of = "%" if unit == "1" and "slip" in quantity else shown_unit(float(np.median(every)), unit)
    factor = 100.0 if of == "%" else converted(1.0, unit, of)
    logarithmic = bool(every.min() > 0.0 and every.max() > 20.0 * every.min())
    step = 0.6 / (len(colours) + 1)
    largest = 0.0
    for k, condition in enumerate(conditions):
        mine = [one for one in rows if one["row_condition"] == condition]
        measured = factor * mine[0]["measured"]
        error = 1.96 * factor * mine[0]["uncertainty"]
        axes.errorbar(
            k - 0.3, measured, error, color="0.2", marker="_", markersize=8, elinewidth=1.2
        )
        largest = max(largest, measured + error)
        for one in mine:
            colour, mark = colours[one["row_models"]]
            place = k - 0.3 + step * (1 + list(colours).index(one["row_models"]))
            value, low, high = (
                factor * one[name] for name in ("calculated", "calculated_low", "calculated_high")
            )
            known = [end for end in (low, high) if math.isfinite(end)]
            if math.isfinite(low):
                largest = max(largest, *known)
                axes.vlines(place, low, high if math.isfinite(high) else 1e30, color=colour)
            if math.isfinite(value):
                face = "white" if one["row_verdict"] == UNDETERMINED else colour
                axes.plot(place, value, mark, color=colour, markerfacecolor=face, markersize=4.5)
                largest = max(largest, value)
    if logarithmic:
        plain_log(axes.yaxis)
    else:
        axes.set_ylim(0.0, 1.1 * largest)
    axes.set_xlim(-0.6, len(conditions) - 0.4)
    if len(conditions) <= 6:
        axes.set_xticks(
            range(len(conditions)), [condition.replace(", ", "\n") for condition in conditions]
        )
    else:
        axes.set_xlabel("Row of the data set")
    name = (quantity.partition("/")[2] or quantity).replace("-", " ").replace("_", " ")
    axes.set_ylabel(f"{name.capitalize()} [{of if of == '%' else unit_label(of)}]")
    return _done(sheet, colours)


def _statements(dataset: "xr.Dataset") -> "Figure":
    """A mark for every statement and model."""
    rows = rows_along(dataset, "statement")
    says, models = (
        list(dict.fromkeys(one[f"statement_{name}"] for one in rows)) for name in ("text", "models")
    )
    sheet = _sheet(len(says) + 3, 0)
    axes = sheet.axes
    marks = {"held": ("o", "#0072B2", "#0072B2"), "not held": ("X", "#D55E00", "#D55E00"),
             "cannot be determined": ("o", "white", "0.4")}  # fmt: skip
    for one in rows:
        mark, face, edge = marks[one["statement_verdict"]]
        place = models.index(one["statement_models"]), says.index(one["statement_text"])
        axes.plot(*place, mark, markerfacecolor=face, markeredgecolor=edge, markersize=6)
    axes.set_xticks(range(len(models)), models, rotation=20 if len(models) > 3 else 0)
    axes.set_yticks(range(len(says)), says)
    axes.set(xlim=(-0.5, len(models) - 0.5), ylim=(len(says) - 0.5, -0.5))
    axes.xaxis.tick_top()
    axes.grid(visible=True, color="0.92")
    axes.set_axisbelow(True)
    return sheet.done()


def _done(sheet: Sheet, colours: Mapping[str, tuple[str, str]]) -> "Figure":
    """Explain the models in a legend, for which the sheet has room."""
    for name, (colour, mark) in colours.items():
        sheet.key(name, color=colour, marker=mark, linestyle="solid", markersize=4)
    sheet.figure.legend(handles=sheet.handles, loc="outside upper left", ncols=3)
    return sheet.figure
