"""Figures of sweeps: results over one quantity or two, for several models, and for samples of uncertain data.

Style, sizes and files are those of `rollslip.results.style`. A map has one panel for each model and one colour scale
for all; it is hatched where there is no value. Models on samples are compared by quantiles: where the scatter within a
model is wider than the distance between models, better data would help more than better models. Quantities have the
unit in which the sweep was requested.
"""

import json
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any, Final

import numpy as np
from matplotlib.figure import Figure

from rollslip.results.dataset import xr
from rollslip.results.style import (
    DASHES,
    MARKER,
    MM,
    MODEL_COLOURS,
    RING_COLOURS,
    SINGLE_COLUMN,
    Sheet,
    against_zero,
    plain_decades,
    seamless,
    unit_label,
)
from rollslip.results.text import in_percent, short_label
from rollslip.search import Array
from rollslip.toml import as_table
from rollslip.units import UnitError, converted, shown_unit
from rollslip_campaigns.sweep.findings import (
    axis_keys,
    closure_note,
    named_dims,
    split_by_name,
)
from rollslip_studies.steady_slip.figures import catalogue_loads, mark_loads

__all__ = ["axis_label", "axis_values", "describe_models", "display_of", "sweep_figures"]

#: Result that is drawn for samples, and before all others: on the inner ring, where heating of the film reduces
#: friction at smaller slips.
_RESULT: Final = "critical_cage_slip"
#: Maximum number of panels of a map; more would be too narrow to read on a page.
_MAX_PANELS: Final = 4
#: Maximum number of figures for the results of a sweep. More of them slow down a report; chosen.
_MAX_FIGURES: Final = 6
#: Probabilities of the quantiles by which models are compared: median, middle half and 90 % band.
_QUANTILES: Final = (0.05, 0.25, 0.5, 0.75, 0.95)


def sweep_figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Draw the figures for which the sweep has the points; yield name, caption and figure of each."""
    keys = list(axis_keys(dataset))
    numbers = [key for key in keys if dataset[key].dtype.kind in "fi" and dataset.sizes[key] > 1]
    choices = [key for key in keys if dataset[key].dtype.kind not in "fi"]
    if any(key not in (*numbers, *choices) for key in keys) or len(choices) > 1:
        return
    if "sample" in dataset.dims:
        if choices and not numbers and _RESULT in dataset and "ring" in dataset[_RESULT].dims:
            values = dataset[_RESULT].sel(ring="inner")
            yield "sweep-models", describe_models(dataset), _models(values, choices[0])
        return
    results = _results(dataset, keys, curves=len(numbers) == 1 and not choices)
    for name, values in results[:_MAX_FIGURES]:
        panels = choices
        ring = ""
        if "ring" in values.dims and (choices or len(numbers) == 2):
            if choices or name in dataset:
                values = values.sel(ring="inner")
                ring = " of the inner ring"
            else:  # a result with several names may be worse on either ring
                panels = ["ring"]
        title = f"{_name(values)}{ring}{closure_note(dataset, name)}"
        suffix = "" if name == _RESULT else f"-{name.replace('_', '-').replace(' ', '-')}"
        if len(numbers) == 2 and all(dataset.sizes[key] <= _MAX_PANELS for key in choices):
            caption, figure = _map_of_result(dataset, values, title, numbers, panels)
            yield f"sweep-map{suffix}", caption, figure
        elif len(numbers) == 1 and values.notnull().any([*{*values.dims} - {numbers[0]}]).sum() > 1:
            caption, figure = _line_of_result(dataset, name, values, title, numbers[0], choices)
            yield f"sweep-line{suffix}", caption, figure


def _map_of_result(
    dataset: "xr.Dataset",
    values: "xr.DataArray",
    title: str,
    numbers: Sequence[str],
    panels: Sequence[str],
) -> "tuple[str, Figure]":
    """Caption and map of a result over two quantities."""
    if "steady" in values.dims:
        values = values.isel(steady=0)
        title += ", the smallest,"
    key_of = axis_keys(dataset)
    axes_text = " and ".join(short_label(key_of[key]) for key in numbers)
    figure = _map(values, numbers, panels, [_value_in_scene(dataset, key) for key in numbers])
    return (
        f"{title} over {axes_text}; hatched where there is none in the range, or its point failed.",
        figure,
    )


def _line_of_result(
    dataset: "xr.Dataset",
    name: str,
    values: "xr.DataArray",
    title: str,
    number: str,
    choices: Sequence[str],
) -> "tuple[str, Figure]":
    """Caption and curves of a result over one quantity."""
    key_of = axis_keys(dataset)
    by_choice = f", by {short_label(key_of[choices[0]])}" if choices else ""
    loads = dict[str, float]()
    if key_of[number] == "operation.radial_load" and in_percent(name, "1"):
        if "minimum_load" in dataset:
            loads["minimum load"] = float(dataset["minimum_load"].median())
        loads |= catalogue_loads(dataset)
    return (
        f"{title} over {short_label(key_of[number])}{by_choice}.",
        _line(values, number, choices, loads),
    )


def _results(
    dataset: "xr.Dataset", keys: Sequence[str], *, curves: bool
) -> "list[tuple[str, xr.DataArray]]":
    """Outputs with one number for each point, name or steady slip, and with at least one finite value.

    An output with names besides the rings is split into one result for each name, unless they are curves of one figure.
    """
    results = []
    for name, values in dataset.data_vars.items():
        if values.dtype.kind != "f" or name == "seconds":
            continue
        if str(name).endswith(("_error", "_low", "_high")):  # of another output
            continue
        inner = set(map(str, values.dims)) - set(keys)
        categories = [*named_dims(values, [*keys, "ring"])]
        if (
            len(categories) == 1
            and inner <= {*categories, "ring"}
            and not (curves and inner == {*categories})
        ):
            results += [
                (f"{name}-{label}", piece) for label, piece in split_by_name(values, categories[0])
            ]
        elif (
            inner <= {"ring"}
            or inner == {"steady"}
            or (len(categories) == 1 and inner == {*categories})
        ):
            results.append((str(name), values))
    return sorted(
        ((name, values) for name, values in results if np.isfinite(values.to_numpy()).any()),
        key=lambda pair: pair[0] != _RESULT,
    )


def describe_models(dataset: "xr.Dataset") -> str:
    """Return a sentence on the difference between models and on the scatter of each model by uncertain data."""
    ((name, key),) = axis_keys(dataset).items()
    quantiles = _quantiles(dataset[_RESULT].sel(ring="inner"), name)
    medians = quantiles[:, 2]
    beyond = np.isinf(medians)
    known = np.isfinite(quantiles[:, [1, 3]]).all(axis=1)
    if beyond.any():
        spread = f"the medians of {beyond.sum()} are not known"
    else:
        spread = f"the medians are up to {100 * np.ptp(medians):.2g} percentage points apart"
    if known.all():
        scatter = f"the middle half of one is up to {100 * (quantiles[:, 3] - quantiles[:, 1]).max():.2g} wide"
    else:
        scatter = f"the middle half of {(~known).sum()} ends beyond the range"
    return (
        f"Cage slip at largest traction of the inner ring{closure_note(dataset, _RESULT)} for {len(quantiles)} choices "
        f"of {short_label(key)}: median, middle half, and 5 to 95 % of the samples (100 % where they lie beyond the "
        f"range, or their point failed): {spread}, {scatter}."
    )


def _quantiles(values: "xr.DataArray", key: str) -> Array:
    """Quantiles of each choice, (n, 5); a critical slip that is not in the range counts as infinite."""
    rows: Array = values.transpose(key, "sample").fillna(np.inf).to_numpy()
    return np.quantile(rows, _QUANTILES, axis=1, method="inverted_cdf").T


def _models(values: "xr.DataArray", key: str) -> "Figure":
    """Box plot of a slip for each choice: median, middle half, 5 to 95 %."""
    names = values[key].to_numpy()
    quantiles = 100 * np.minimum(_quantiles(values, key), 1.0)
    sheet = Sheet((SINGLE_COLUMN[0], (22 + 7 * len(names)) * MM))
    axes = sheet.axes
    for k, (low, first, median, third, high) in enumerate(quantiles):
        row = len(names) - 1 - k
        axes.plot([low, high], [row, row], color=MODEL_COLOURS[0], linewidth=1.0, zorder=1)
        axes.barh(row, third - first, 0.5, left=first, color=MODEL_COLOURS[0], alpha=0.45, zorder=2)
        axes.plot(
            median, row, marker="|", markersize=11, markeredgewidth=1.6, color="black", zorder=3
        )
    axes.set(
        yticks=np.arange(len(names))[::-1],
        yticklabels=list(map(str, names)),
        ylim=(-0.6, len(names) - 0.4),
    )
    axes.tick_params(axis="y", length=0)
    return sheet.done("Cage slip at largest traction [%]")


def _value_in_scene(dataset: "xr.Dataset", key: str) -> float:
    """Return the value of a varied quantity in the scene itself; NaN where the scene has no number for it."""
    value: Any = json.loads(dataset.attrs.get("scene_resolved", "{}"))
    for part in str(dataset[key].attrs.get("key", key)).split("."):
        value = as_table(value).get(part)
    return float(value) if isinstance(value, int | float) else np.nan


def _line(
    values: "xr.DataArray", key: str, choices: Sequence[str], loads: Mapping[str, float]
) -> "Figure":
    """Curves over one quantity, one for each choice or else for each name, with radial loads as vertical lines.

    Steady slips, of which a point may have several, are drawn as points.
    """
    sheet = Sheet()
    axes = sheet.axes
    (x, x_label) = axis_values(values[key])
    (read, unit) = display_of(values)
    dim = choices[0] if choices else next(iter(named_dims(values, [key])), None)
    pieces = (
        [(str(name), values.sel({dim: name})) for name in values[dim].to_numpy()]
        if dim
        else [("", values)]
    )
    missing = np.zeros(x.size, dtype=bool)
    for k, (name, piece) in enumerate(pieces):
        label = f"{name} ring" if dim == "ring" else name
        style: dict[str, Any] = {
            "color": MODEL_COLOURS[k % len(MODEL_COLOURS)],
            "linestyle": DASHES[k % len(DASHES)],
        }
        if dim == "ring":
            style = {"color": RING_COLOURS[name], "linestyle": DASHES[k % 2]}
        if piece.sizes.get("steady", 1) > 1:  # which steady slips belong to one branch is not known
            style["linestyle"] = "none"
        y = read(piece.transpose(key, ...).to_numpy())
        shown = axes.plot(x, y, marker="o", markersize=3, **style)
        if label:
            shown[0].set_label(label)
        missing |= ~np.isfinite(y.reshape(x.size, -1)).any(axis=1)
    if missing.any():
        axes.plot(
            x[missing],
            np.zeros(missing.sum()),
            "x",
            color="0.3",
            markersize=4,
            label="no value in the range, or the point failed",
            transform=axes.get_xaxis_transform(),
            clip_on=False,
            zorder=5,
        )
    if _is_logarithmic(x):
        plain_decades(axes.xaxis)
    sheet.handles += axes.get_legend_handles_labels()[0]
    mark_loads(sheet, loads, _units(values[key])[1] if loads else "")
    return sheet.done(x_label, axis_label(values, unit))


def _map(
    values: "xr.DataArray",
    numbers: Sequence[str],
    choices: Sequence[str],
    scene_values: Sequence[float],
) -> "Figure":
    """Map of a result, a panel for each choice, with a mark at the values of the scene where they are in the range."""
    pieces = [
        (str(name), values.sel({key: name})) for key in choices for name in values[key].to_numpy()
    ] or [("", values)]
    sheet = Sheet(
        ((32 + 46 * len(pieces)) * MM, 58 * MM), 1, len(pieces), sharey=True, squeeze=False
    )
    panels = sheet.axes[0]
    read, unit = display_of(values)
    finite = read(values.to_numpy())
    finite = finite[np.isfinite(finite)]
    colours = against_zero(float(finite.min(initial=np.inf)), float(finite.max(initial=-np.inf)))
    mesh: Any = None
    marks = list[Any]()
    for axes, (name, piece) in zip(panels, pieces, strict=True):
        axes.set_facecolor("0.9")
        (x, x_label) = axis_values(piece[numbers[0]])
        (y, y_label) = axis_values(piece[numbers[1]])
        mesh = axes.pcolormesh(
            x,
            y,
            read(piece.transpose(numbers[1], numbers[0]).to_numpy()),
            shading="nearest",
            **colours,
        )
        mesh.set(edgecolor="face", linewidth=0.2)
        axes.patch.set(hatch="////", edgecolor="0.7")  # visible where there is no value
        for axis, coordinates in ((axes.xaxis, x), (axes.yaxis, y)):
            if _is_logarithmic(coordinates):
                plain_decades(axis)
        point = [
            float(converted(value, *_units(piece[key])))
            for value, key in zip(scene_values, numbers, strict=True)
        ]
        if all(
            values_on_axis.min() <= value <= values_on_axis.max()
            for value, values_on_axis in zip(point, (x, y), strict=True)
        ):
            marks = axes.plot(
                *point,
                color="black",
                linestyle="none",
                label="operating point of the scene",
                **MARKER,
            )
        if x.min() >= 0.0:  # cells extend half a step beyond the first value
            axes.set_xlim(left=max(0.0, axes.get_xlim()[0]))
        if y.min() >= 0.0:
            axes.set_ylim(bottom=max(0.0, axes.get_ylim()[0]))
        axes.set(title=f"{name} ring" if choices == ["ring"] else name, xlabel=x_label)
        if axes is panels[0]:
            axes.set_ylabel(y_label)
    seamless(sheet.figure.colorbar(mesh, ax=list(panels), label=axis_label(values, unit)))
    sheet.handles += marks
    return sheet.done()


def _is_logarithmic(values: Array) -> bool:
    """Whether values form a geometric progression, and not an arithmetic one."""
    if values.size < 3 or values.min() <= 0.0:
        return False
    return bool(
        np.ptp(np.diff(np.log(values))) < 1e-6 and np.ptp(np.diff(values)) > 1e-6 * np.ptp(values)
    )


def _units(coordinate: "xr.DataArray") -> tuple[str, str]:
    """Return the unit of a coordinate, and the unit for display: that of the request, else the usual one."""
    unit = str(coordinate.attrs["units"])
    return unit, str(coordinate.attrs.get("written_in", "")) or shown_unit(
        float(np.abs(coordinate.to_numpy()).max()), unit
    )


def axis_values(coordinate: "xr.DataArray") -> tuple[Array, str]:
    """Return values and label of an axis, in the unit for display."""
    (unit, given) = _units(coordinate)
    name = short_label(str(coordinate.attrs.get("key", coordinate.name)))
    return (
        converted(coordinate.to_numpy(), unit, given),
        f"{name[0].upper()}{name[1:]} [{unit_label(given)}]",
    )


def _name(values: "xr.DataArray") -> str:
    """Name of a result, with a capital."""
    if values.name == _RESULT:
        return "Cage slip at largest traction"
    name = str(values.attrs["long_name"])
    return f"{name[:1].upper()}{name[1:]}"


def axis_label(values: "xr.DataArray", unit: str) -> str:
    """Return name and unit of a result, in lines that are not longer than an axis.

    Parameters
    ----------
    values : xarray.DataArray
        The result.
    unit : str
        The unit for display.
    """
    return textwrap.fill(f"{_name(values)} [{unit}]".replace("N m]", "N\u00a0m]"), 36)


def display_of(values: "xr.DataArray") -> tuple[Callable[[Array], Array], str]:
    """Return a function that converts a result to the unit for display, and that unit: percent for slips."""
    unit = str(values.attrs.get("units", "1"))
    if in_percent(str(values.name), unit):
        return partial(np.multiply, 100.0), "%"
    if unit == "1":
        return np.asarray, "–"
    try:
        shown_in = shown_unit(float(np.nanmax(np.abs(values.to_numpy()))), unit)
        return partial(converted, unit=unit, given=shown_in), unit_label(shown_in)
    except UnitError:  # a unit for which there is no other way to write it
        return np.asarray, unit_label(unit.partition(",")[0])
