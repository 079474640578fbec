"""The atlas of a validation: calculated over measured of all series, each series by itself, and the statements."""

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rollslip.results.style import MM, MODEL_COLOURS, ROW, TWO_COLUMNS, Sheet, unit_label
from rollslip.units import converted, shown_unit
from rollslip_campaigns.validation.findings import together

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

__all__ = ["figures"]

_MARKS: Final = "osD^vP*X"
#: Ends of the axis of ratios: beyond them a mark says that there is more.
_LEAST, _MOST = 1e-2, 1e2


def figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Draw the figures; give name, caption and figure of each."""
    if dataset.sizes["row"]:
        caption = "Calculated over measured, with the 95 % band of both uncertainties; at the edge, beyond the range."
        yield "validation", caption, _ratios(dataset)
        for k, (data_set, series) in enumerate(together(dataset, "data_set", "series"), 1):
            mask = (dataset["row_data_set"].to_numpy() == data_set) & (dataset["row_series"].to_numpy() == series)
            one = dataset.isel(row=np.flatnonzero(mask))
            caption = f"{data_set}: {series}. Bands of 95 %; open where nothing can be told."
            yield f"validation-{data_set}-{k}", caption, _series(one)
    if dataset.sizes["statement"]:
        caption = "Which statements hold under which models: filled, they hold; crossed, they do not; open, not told."
        yield "validation-statements", caption, _statements(dataset)


def _colours(dataset: "xr.Dataset") -> Mapping[str, tuple[str, str]]:
    models = dict.fromkeys(
        [*map(str, dataset["row_models"].to_numpy()), *map(str, dataset["statement_models"].to_numpy())]
    )
    return {name: (MODEL_COLOURS[k % len(MODEL_COLOURS)], _MARKS[k % len(_MARKS)]) for k, name in enumerate(models)}


def _sheet(rows: int, models: int) -> Sheet:
    return Sheet((TWO_COLUMNS[0], max((18 + 3.4 * rows) * MM + ROW * (1 + models // 3), 45 * MM)))


def _ratios(dataset: "xr.Dataset") -> "Figure":
    """One line a row of a data set, one mark a model."""
    keys = together(dataset, "data_set", "series", "condition")
    colours = _colours(dataset)
    sheet = _sheet(len(keys) * max(1, len(colours) // 2), len(colours))
    axes = sheet.axes
    step = 0.7 / max(len(colours), 1)
    for k in range(dataset.sizes["row"]):
        one = dataset.isel(row=k)
        key = tuple(str(one[f"row_{name}"].item()) for name in ("data_set", "series", "condition"))
        model = str(one["row_models"].item())
        place = keys.index(key) + step * (list(colours).index(model) - (len(colours) - 1) / 2)
        colour, mark = colours[model]
        ratio, low, high = (_within(float(one[name])) for name in ("ratio", "ratio_low", "ratio_high"))
        if not math.isnan(low):
            axes.plot([low, high], [place, place], color=colour, linewidth=1.0)
        if not math.isnan(ratio):
            face = "white" if str(one["row_verdict"].item()) == "cannot be determined" else colour
            edge = ">" if ratio >= _MOST else "<" if ratio <= _LEAST else mark
            axes.plot(ratio, place, edge, color=colour, markerfacecolor=face, markersize=4)
    axes.axvline(1.0, color="0.6", linewidth=0.7, zorder=0)
    axes.set_xscale("log")
    _plain_log(axes.xaxis)
    axes.set_ylim(len(keys) - 0.4, -0.6)
    axes.set_yticks(range(len(keys)), [f"{series}: {condition}" for _, series, condition in keys])
    axes.set_xlabel("Calculated over measured [–]")
    return _done(sheet, colours)


def _plain_log(axis: Any) -> None:
    from matplotlib.ticker import LogLocator, NullFormatter

    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(lambda value, _: f"{value:g}")
    axis.set_minor_formatter(NullFormatter())


def _within(ratio: float) -> float:
    return ratio if math.isnan(ratio) else min(max(ratio, _LEAST), _MOST)


def _series(dataset: "xr.Dataset") -> "Figure":
    """Measured and calculated values of a series, one place a condition."""
    colours = _colours(dataset)
    conditions = list(dict.fromkeys(map(str, dataset["row_condition"].to_numpy())))
    sheet = Sheet((TWO_COLUMNS[0], 70 * MM + ROW * (1 + len(colours) // 3)))
    sheet.key("measured, 95 %", color="0.2", marker="_")
    axes = sheet.axes
    unit = str(dataset["row_unit"].to_numpy()[0])
    quantity = str(dataset["row_quantity"].to_numpy()[0])
    every = np.abs(dataset["measured"].to_numpy())
    of = "%" if unit == "1" and "slip" in quantity else shown_unit(float(np.median(every)), unit)
    factor = 100.0 if of == "%" else converted(1.0, unit, of)
    logarithmic = bool(every.min() > 0.0 and every.max() > 20.0 * every.min())
    step = 0.6 / (len(colours) + 1)
    largest = 0.0
    for k, condition in enumerate(conditions):
        rows = np.flatnonzero(dataset["row_condition"].to_numpy() == condition)
        one = dataset.isel(row=int(rows[0]))
        measured, error = factor * float(one["measured"]), 1.96 * factor * float(one["uncertainty"])
        axes.errorbar(k - 0.3, measured, error, color="0.2", marker="_", markersize=8, elinewidth=1.2)
        largest = max(largest, measured + error)
        for row in rows:
            one = dataset.isel(row=int(row))
            name = str(one["row_models"].item())
            colour, mark = colours[name]
            place = k - 0.3 + step * (1 + list(colours).index(name))
            values = {n: factor * float(one[n]) for n in ("calculated", "calculated_low", "calculated_high")}
            if math.isfinite(values["calculated_low"]):
                top = values["calculated_high"] if math.isfinite(values["calculated_high"]) else np.inf
                largest = max(largest, values["calculated_low"], top if math.isfinite(top) else 0.0)
                axes.vlines(place, values["calculated_low"], top if math.isfinite(top) else 1e30, color=colour)
            if math.isfinite(values["calculated"]):
                face = "white" if str(one["row_verdict"].item()) == "cannot be determined" else colour
                axes.plot(place, values["calculated"], mark, color=colour, markerfacecolor=face, markersize=4.5)
                largest = max(largest, values["calculated"])
    if logarithmic:
        axes.set_yscale("log")
        _plain_log(axes.yaxis)
    else:
        axes.set_ylim(0.0, 1.1 * largest)
    axes.set_xlim(-0.6, len(conditions) - 0.4)
    if len(conditions) <= 6:
        axes.set_xticks(range(len(conditions)), [condition.replace(", ", "\n") for condition in conditions])
    else:
        axes.set_xlabel("Row of the data set")
    name = (quantity.partition("/")[2] or quantity).replace("-", " ").replace("_", " ")
    axes.set_ylabel(f"{name.capitalize()} [{of if of == '%' else unit_label(of)}]")
    return _done(sheet, colours)


def _statements(dataset: "xr.Dataset") -> "Figure":
    """A mark for every statement and model."""
    says = list(dict.fromkeys(map(str, dataset["statement_says"].to_numpy())))
    models = list(dict.fromkeys(map(str, dataset["statement_models"].to_numpy())))
    sheet = _sheet(len(says) + 3, 0)
    axes = sheet.axes
    marks = {"held": ("o", "#0072B2", "#0072B2"), "not held": ("X", "#D55E00", "#D55E00"),
             "cannot be determined": ("o", "white", "0.4")}  # fmt: skip
    for k in range(dataset.sizes["statement"]):
        one = dataset.isel(statement=k)
        mark, face, edge = marks[str(one["statement_verdict"].item())]
        place = models.index(str(one["statement_models"].item())), says.index(str(one["statement_says"].item()))
        axes.plot(*place, mark, markerfacecolor=face, markeredgecolor=edge, markersize=6)
    axes.set_xticks(range(len(models)), models, rotation=20 if len(models) > 3 else 0)
    axes.set_yticks(range(len(says)), says)
    axes.set_xlim(-0.5, len(models) - 0.5)
    axes.set_ylim(len(says) - 0.5, -0.5)
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
