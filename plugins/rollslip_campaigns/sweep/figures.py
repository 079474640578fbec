"""Figures of sweeps: every single result over one quantity or two, for several models, and against scattering data.

Style, sizes and files are those of `rollslip.results.style`. A map has one panel for each model and one scale of
colours for all; where there is no value in the range it is hatched. Models on samples of uncertain data are told by
quantiles: if the scatter within a model is wider than the distance between them, better data tell more than better
models. Quantities have the unit in which the sweep was asked for.
"""

import json
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, Final

import numpy as np

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
from rollslip.results.words import in_percent, short_label
from rollslip.search import Array
from rollslip.units import UnitError, converted, shown_unit
from rollslip_campaigns.sweep.findings import axes as axes_of
from rollslip_campaigns.sweep.findings import by_name, named_dims, resting
from rollslip_studies.steady_slip.figures import catalogue_loads, mark_loads

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

__all__ = ["models_apart", "sweep_figures"]

#: What is drawn of samples, and first of all: on the inner ring, on which film heating lets friction fall first.
_RESULT: Final = "critical_cage_slip"
_PANELS: Final = 4
_HATCHED: Final = "hatched where there is none in the range, or its point failed"
#: Figures of one kind at most: of more outputs nobody would look at all.
_FIGURES: Final = 6
_QUANTILES: Final = (0.05, 0.25, 0.5, 0.75, 0.95)


def sweep_figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Draw the figures; give name, caption and figure of those for which the sweep has the points."""
    key_of = axes_of(dataset)
    keys = list(key_of)
    numbers = [key for key in keys if dataset[key].dtype.kind in "fi" and dataset.sizes[key] > 1]
    choices = [key for key in keys if dataset[key].dtype.kind not in "fi"]
    if any(key not in (*numbers, *choices) for key in keys) or len(choices) > 1:
        return
    if "sample" in dataset.dims:
        if choices and not numbers and _RESULT in dataset and "ring" in dataset[_RESULT].dims:
            values = dataset[_RESULT].sel(ring="inner")
            yield "sweep-models", models_apart(dataset), _models(values, choices[0])
        return
    few = all(dataset.sizes[key] <= _PANELS for key in choices)
    for name, values in _results(dataset, keys, curves=len(numbers) == 1 and not choices)[
        :_FIGURES
    ]:
        ending = "" if name == _RESULT else f"-{name.replace('_', '-').replace(' ', '-')}"
        whose = ""
        panels = choices
        if "ring" in values.dims and (choices or len(numbers) == 2):
            if choices or name in dataset:
                values = values.sel(ring="inner")
                whose = " of the inner ring"
            else:  # what has several names may be worse on either ring
                panels = ["ring"]
        said = f"{_name(values)}{whose}{resting(dataset) if name.startswith('critical_') else ''} over "
        if len(numbers) == 2 and few:
            if "steady" in values.dims:
                values = values.isel(steady=0)
                said = said.replace(" over ", ", the smallest, over ")
            caption = (
                f"{said}{' and '.join(short_label(key_of[key]) for key in numbers)}; {_HATCHED}."
            )
            yield (
                f"sweep-map{ending}",
                caption,
                _map(values, numbers, panels, [_given(dataset, key) for key in numbers]),
            )
        elif len(numbers) == 1 and values.notnull().any([*{*values.dims} - {numbers[0]}]).sum() > 1:
            caption = f"{said}{short_label(key_of[numbers[0]])}{f', by {short_label(key_of[choices[0]])}' if choices else ''}."
            loads = {}
            if key_of[numbers[0]] == "operation.radial_load" and in_percent(name, "1"):
                least = (
                    {"minimum load": float(dataset["minimum_load"].median())}
                    if "minimum_load" in dataset
                    else {}
                )
                loads = least | catalogue_loads(dataset)
            yield f"sweep-line{ending}", caption, _line(values, numbers[0], choices, loads)


def _results(
    dataset: "xr.Dataset", keys: Sequence[str], *, curves: bool
) -> "list[tuple[str, xr.DataArray]]":
    """Outputs that have one number for a point, for each name or for each steady slip, and a value anywhere.

    One that has names beside the rings is taken apart by them, unless they are curves of one figure.
    """
    found = []
    for name, values in dataset.data_vars.items():
        if values.dtype.kind != "f" or name == "seconds":
            continue
        inner = {str(dim) for dim in values.dims} - set(keys)
        categories = [*named_dims(values, [*keys, "ring"])]
        if (
            len(categories) == 1
            and inner <= {*categories, "ring"}
            and not (curves and inner == {*categories})
        ):
            found += [(f"{name}-{one}", piece) for one, piece in by_name(values, categories[0])]
        elif (
            inner <= {"ring"}
            or inner == {"steady"}
            or (len(categories) == 1 and inner == {*categories})
        ):
            found.append((str(name), values))
    known = [(name, values) for name, values in found if np.isfinite(values.to_numpy()).any()]
    return sorted(known, key=lambda one: one[0] != _RESULT)


def models_apart(dataset: "xr.Dataset") -> str:
    """Say how far models are apart, and how far data that scatter move one of them."""
    ((name, key),) = axes_of(dataset).items()
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
        f"Cage slip at largest traction of the inner ring{resting(dataset)} for {len(quantiles)} choices of "
        f"{short_label(key)}: median, middle half, and 5 to 95 % of the samples (100 % where they lie beyond the range, or "
        f"their point failed): {spread}, {scatter}."
    )


def _quantiles(values: "xr.DataArray", key: str) -> Array:
    """Quantiles of every choice, (n, 5); a critical slip that is not in the range lies beyond it."""
    rows = values.transpose(key, "sample").to_numpy()
    filled = np.where(np.isnan(rows), np.inf, rows)
    return np.quantile(filled, _QUANTILES, axis=1, method="inverted_cdf").T


def _models(values: "xr.DataArray", key: str) -> "Figure":
    names = values[key].to_numpy()
    quantiles = 100 * np.minimum(_quantiles(values, key), 1.0)
    sheet = Sheet((SINGLE_COLUMN[0], (22 + 7 * len(names)) * MM))
    axes = sheet.axes
    for k, (low, first, middle, third, high) in enumerate(quantiles):
        place = len(names) - 1 - k
        axes.plot([low, high], [place, place], color=MODEL_COLOURS[0], linewidth=1.0, zorder=1)
        axes.barh(
            place, third - first, 0.5, left=first, color=MODEL_COLOURS[0], alpha=0.45, zorder=2
        )
        axes.plot(
            middle, place, marker="|", markersize=11, markeredgewidth=1.6, color="black", zorder=3
        )
    axes.set(
        yticks=np.arange(len(names))[::-1],
        yticklabels=list(map(str, names)),
        ylim=(-0.6, len(names) - 0.4),
    )
    axes.tick_params(axis="y", length=0)
    return sheet.done("Cage slip at largest traction [%]")


def _given(dataset: "xr.Dataset", key: str) -> float:
    """Return what the scene has of a quantity that was varied; NaN where it has none."""
    value: Any = json.loads(dataset.attrs.get("scene_resolved", "{}"))
    for part in str(dataset[key].attrs.get("key", key)).split("."):
        value = value.get(part) if isinstance(value, dict) else None
    return float(value) if isinstance(value, int | float) else np.nan


def _line(
    values: "xr.DataArray", key: str, choices: Sequence[str], loads: Mapping[str, float]
) -> "Figure":
    """Curves over one quantity: for each choice, else for each ring; steady slips, which may be several, as points.

    Of slips over the radial load ``loads`` are drawn, too.
    """
    sheet = Sheet()
    axes = sheet.axes
    (x, across) = _axis(values[key])
    (read, unit) = _shown(values)
    over = choices[0] if choices else next(iter(named_dims(values, [key])), None)
    named = (
        [(str(one), values.sel({over: one})) for one in values[over].to_numpy()]
        if over
        else [("", values)]
    )
    missing = np.zeros(x.size, dtype=bool)
    for k, (name, piece) in enumerate(named):
        label = f"{name} ring" if over == "ring" else name
        style: dict[str, Any] = {
            "color": MODEL_COLOURS[k % len(MODEL_COLOURS)],
            "linestyle": DASHES[k % len(DASHES)],
        }
        if over == "ring":
            style = {"color": RING_COLOURS[name], "linestyle": DASHES[k % 2]}
        if piece.sizes.get("steady", 1) > 1:  # which of them go together is not known
            style["linestyle"] = "none"
        y = read(piece.transpose(key, ...).to_numpy())
        shown = axes.plot(x, y, marker="o", markersize=3, **style)
        if label:
            shown[0].set_label(label)
        missing |= ~np.isfinite(y.reshape(x.size, -1)).any(axis=1)
    if missing.any():
        foot: dict[str, Any] = {
            "transform": axes.get_xaxis_transform(),
            "clip_on": False,
            "zorder": 5,
        }
        words = "no value in the range, or the point failed"
        axes.plot(
            x[missing], np.zeros(missing.sum()), "x", color="0.3", markersize=4, label=words, **foot
        )
    if _by_factors(x):
        plain_decades(axes.xaxis)
    sheet.handles += axes.get_legend_handles_labels()[0]
    mark_loads(sheet, loads, _units(values[key])[1] if loads else "")
    return sheet.done(across, _named(values, unit))


def _map(
    values: "xr.DataArray", numbers: Sequence[str], choices: Sequence[str], given: Sequence[float]
) -> "Figure":
    """Draw a map, or one for each choice, with the point of the scene itself where that is in its range."""
    pieces = [
        (str(name), values.sel({key: name})) for key in choices for name in values[key].to_numpy()
    ]
    pieces = pieces or [("", values)]
    sheet = Sheet(
        ((32 + 46 * len(pieces)) * MM, 58 * MM), 1, len(pieces), sharey=True, squeeze=False
    )
    panels = sheet.axes[0]
    read, unit = _shown(values)
    known = read(values.to_numpy())
    known = known[np.isfinite(known)]
    colours = against_zero(float(known.min(initial=np.inf)), float(known.max(initial=-np.inf)))
    mesh: Any = None
    marks = list[Any]()
    for axes, (name, piece) in zip(panels, pieces, strict=True):
        axes.set_facecolor("0.9")
        (x, across) = _axis(piece[numbers[0]])
        (y, up) = _axis(piece[numbers[1]])
        shown = read(piece.transpose(numbers[1], numbers[0]).to_numpy())
        mesh = axes.pcolormesh(x, y, shown, shading="nearest", **colours)
        mesh.set(edgecolor="face", linewidth=0.2)
        axes.patch.set(hatch="////", edgecolor="0.7")  # seen where there is no value
        for axis, places in ((axes.xaxis, x), (axes.yaxis, y)):
            if _by_factors(places):
                plain_decades(axis)
        point = [
            float(converted(one, *_units(piece[key])))
            for one, key in zip(given, numbers, strict=True)
        ]
        if all(at.min() <= one <= at.max() for one, at in zip(point, (x, y), strict=True)):
            marks = axes.plot(
                *point,
                color="black",
                linestyle="none",
                label="operating point of the scene",
                **MARKER,
            )
        if x.min() >= 0.0:  # cells reach half a step beyond the first value
            axes.set_xlim(left=max(0.0, axes.get_xlim()[0]))
        if y.min() >= 0.0:
            axes.set_ylim(bottom=max(0.0, axes.get_ylim()[0]))
        axes.set(title=f"{name} ring" if choices == ["ring"] else name, xlabel=across)
        if axes is panels[0]:
            axes.set_ylabel(up)
    seamless(sheet.figure.colorbar(mesh, ax=list(panels), label=_named(values, unit)))
    sheet.handles += marks
    return sheet.done()


def _by_factors(values: Array) -> bool:
    """Whether values are spread by a factor, and not evenly."""
    if values.size < 3 or values.min() <= 0.0:
        return False
    return bool(
        np.ptp(np.diff(np.log(values))) < 1e-6 and np.ptp(np.diff(values)) > 1e-6 * np.ptp(values)
    )


def _units(coordinate: "xr.DataArray") -> tuple[str, str]:
    """Return the unit of what was varied, and that in which it was asked for, else that which people read."""
    unit = str(coordinate.attrs["units"])
    read = shown_unit(float(np.abs(coordinate.to_numpy()).max()), unit)
    return unit, str(coordinate.attrs.get("written_in", "")) or read


def _axis(coordinate: "xr.DataArray") -> tuple[Array, str]:
    """Values of what was varied and the label of their axis, in the unit in which they were asked for."""
    values = coordinate.to_numpy()
    (unit, given) = _units(coordinate)
    name = short_label(str(coordinate.attrs.get("key", coordinate.name)))
    return converted(values, unit, given), f"{name[0].upper()}{name[1:]} [{unit_label(given)}]"


def _name(values: "xr.DataArray") -> str:
    name = (
        "cage slip at largest traction"
        if values.name == _RESULT
        else str(values.attrs["long_name"])
    )
    return f"{name[:1].upper()}{name[1:]}"


def _named(values: "xr.DataArray", unit: str) -> str:
    """Name and unit of a result, on lines that are no longer than an axis."""
    return textwrap.fill(f"{_name(values)} [{unit}]".replace("N m]", "N\u00a0m]"), 36)


def _shown(values: "xr.DataArray") -> tuple[Callable[[Array], Array], str]:
    """What reads results in the unit that they are shown in, and that: slips in percent, others as people do."""
    unit = str(values.attrs.get("units", "1"))
    if in_percent(str(values.name), unit):
        return partial(np.multiply, 100.0), "%"
    if unit == "1":
        return np.asarray, "–"
    try:
        given = shown_unit(float(np.nanmax(np.abs(values.to_numpy()))), unit)
        return partial(converted, unit=unit, given=given), unit_label(given)
    except UnitError:  # a unit for which there is no other way to write it
        return np.asarray, unit_label(unit.partition(",")[0])
