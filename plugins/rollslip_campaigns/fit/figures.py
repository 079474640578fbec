"""Draw the figures of a fit: friction measured and fitted, residuals, and the likelihood profile of each parameter."""

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.figure import Figure

from rollslip.results.dataset import xr
from rollslip.results.style import (
    MARKER,
    MM,
    RING_COLOURS,
    ROW,
    SINGLE_COLUMN,
    TWO_COLUMNS,
    Sheet,
    axis_label,
    light_to_dark,
    unit_label,
)
from rollslip.units import converted, format_quantity, shown_unit

__all__ = ["figures"]

#: Style of measured points: open circles.
_OPEN: Final[Mapping[str, Any]] = {
    "marker": "o",
    "markersize": 3,
    "markerfacecolor": "white",
    "markeredgewidth": 0.8,
}


def figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Yield name, caption and figure of each figure."""
    constant = _operating_points(dataset)[0]
    yield (
        "fit",
        f"Friction measured ({Path(dataset.attrs['source']).name}) and fitted{constant and ', ' + constant}.",
        _fit(dataset),
    )
    caption = "Residuals over their standard deviation; the band is two of it."
    yield "fit-residuals", caption, _residuals(dataset)
    if dataset.sizes["fitted_parameter"]:
        caption = "Rise of chi2 over the variance with one parameter fixed, the others fitted anew."
        yield "fit-profiles", caption, _profiles(dataset)


def _operating_points(dataset: "xr.Dataset") -> tuple[str, list[str]]:
    """Return what all operating points have in common, and the differences of each, as texts."""
    texts = [
        [format_quantity(float(v), unit, 3) for v in dataset[f"point_{name}"]]
        for name, unit in (("temperature", "K"), ("pressure", "Pa"), ("speed", "m/s"))
    ]
    common = [column[0] for column in texts if len(set(column)) == 1]
    different = [column for column in texts if len(set(column)) > 1]
    return ", ".join(common), list(map(", ".join, zip(*different, strict=True)))


def _fit(dataset: "xr.Dataset") -> "Figure":
    """Return a figure of measured friction with the fitted curve of each operating point."""
    sheet = Sheet()
    axes = sheet.axes
    slip = dataset["slide_roll_ratio"].to_numpy()
    friction = dataset["friction"].to_numpy()
    known = dataset.attrs["uncertainties"] == "given"
    for point, colour, label in _points(dataset):
        rows = dataset["operating_point"].to_numpy() == point
        axes.errorbar(
            100 * slip[rows],
            friction[rows],
            dataset["uncertainty"].to_numpy()[rows] if known else None,
            color=colour,
            linestyle="none",
            elinewidth=0.6,
            **_OPEN,
        )
        selected = dataset.isel(point=point)
        (line,) = axes.plot(
            100 * selected["curve_slip"],
            selected["curve_friction"],
            color=colour,
            linewidth=1.0,
            label=label,
        )
        if label:
            sheet.handles.append(line)
    count = ""
    if not sheet.handles and dataset.sizes["point"] > 1:
        count = f"{dataset.sizes['point']} operating points"
    label = ", ".join(filter(None, ("measured", count, _operating_points(dataset)[0])))
    sheet.key(label, color="0.3", linestyle="none", **_OPEN)
    axes.axhline(0.0, color="0.6", linewidth=0.5, zorder=0)
    return sheet.done(_slip_label(dataset), axis_label(dataset["friction"], r"$\mu$", "–"))


def _residuals(dataset: "xr.Dataset") -> "Figure":
    """Return a figure of the residuals over their standard deviation."""
    sheet = Sheet()
    axes = sheet.axes
    slip = dataset["slide_roll_ratio"].to_numpy()
    residual = (dataset["residual"] / dataset["uncertainty"]).to_numpy()
    axes.axhspan(-2.0, 2.0, color="0.93", linewidth=0.0, zorder=0)
    axes.axhline(0.0, color="0.6", linewidth=0.5, zorder=0)
    for point, colour, label in _points(dataset):
        rows = dataset["operating_point"].to_numpy() == point
        (line,) = axes.plot(
            100 * slip[rows], residual[rows], color=colour, linestyle="none", label=label, **_OPEN
        )
        if label:
            sheet.handles.append(line)
    axes.set_ylim(*(np.array([-1.1, 1.1]) * max(3.0, np.abs(residual).max())))
    return sheet.done(_slip_label(dataset), "Residual / standard deviation [–]")


def _slip_label(dataset: "xr.Dataset") -> str:
    """Return the label of the axis of the slide-roll ratio."""
    return axis_label(dataset["slide_roll_ratio"], "$V/u$", "%", name="slide–roll ratio")


def _points(dataset: "xr.Dataset") -> Iterator[tuple[int, Any, str]]:
    """Yield number, colour and label of each operating point; no labels where they would fill the page."""
    count = dataset.sizes["point"]
    labels = _operating_points(dataset)[1]
    for point, colour in enumerate(light_to_dark()(np.linspace(1.0, 0.0, count)[::-1])):
        yield point, colour, labels[point] if 1 < count <= 12 else ""


def _profiles(dataset: "xr.Dataset") -> "Figure":
    """Return a figure of the likelihood profile of each parameter, and of the parabola of its covariance."""
    names = dataset["fitted_parameter"].values
    columns = min(names.size, 3)
    rows = -(-names.size // columns)
    size = SINGLE_COLUMN if columns == 1 else TWO_COLUMNS
    sheet = Sheet(size, rows, columns, squeeze=False, sharey=True)
    panels = sheet.axes.ravel()
    limits = dataset["rise_limit"].to_numpy()
    linear = False
    for axes, name in zip(panels, names, strict=False):
        selected = dataset.sel(parameter=name)
        # the unit in which the value is printed
        SI = selected["unit"].item()
        best = float(selected["value"])
        unit = shown_unit(best, SI)
        values = converted(selected["profile_value"].to_numpy(), SI, unit)
        best = converted(best, SI, unit)
        for limit, level in zip(limits, dataset["level"].values, strict=True):
            axes.axhline(limit, color="0.6", linewidth=0.6, zorder=0)
            axes.text(
                0.5,
                limit,
                f"{level:.0%}",
                transform=axes.get_yaxis_transform(),
                va="bottom",
                ha="center",
            )
        error = math.sqrt(float(selected["covariance"].sel(with_parameter=name)))
        if math.isfinite(error):
            change = np.log(values / best) if values.min() > 0.0 < best else values - best
            axes.plot(values, (change / error) ** 2, color=RING_COLOURS["outer"], linewidth=1.0)
            linear = True
        axes.plot(values, selected["profile_rise"], color=RING_COLOURS["inner"])
        axes.plot(best, 0.0, color=RING_COLOURS["inner"], clip_on=False, **MARKER)
        if values.min() > 0.0 and values.max() > 5.0 * values.min():
            axes.set_xscale("log")
        axes.set_ylim(0.0, 1.6 * limits[-1])
        axes.set_xlabel(f"{name} [{unit_label(unit)}]")
    for axes in panels[names.size :]:
        axes.set_visible(False)
    panels[0].set_ylabel(r"Rise of $\chi^2$ over the variance [–]")
    sheet.key("profile likelihood, the others fitted anew", color=RING_COLOURS["inner"])
    if linear:
        sheet.key(
            "covariance: the law taken for linear", color=RING_COLOURS["outer"], linewidth=1.0
        )
    figure = sheet.done(columns=columns)
    figure.set_figheight(58 * MM * rows + 2 * ROW)
    return figure
