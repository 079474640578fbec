"""Figures of damage: each measure over the orbit of the rollers, and across the contacts where it is worst."""

from collections.abc import Iterator
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rollslip.bearing.raceway import RINGS
from rollslip.results.dataset import xr
from rollslip.results.style import DASHES, RING_COLOURS, ROW, SINGLE_COLUMN, Sheet, unit_label
from rollslip.units import converted, shown_unit
from rollslip_studies.surface_damage.findings import (
    RISE,
    format_value,
    measures,
    rings_beyond_limit,
)

__all__ = ["damage_figures", "over_time"]

#: Upper end of the axis over the worst value of the better ring, for measures of which small values are the worst.
#: Doubled, the worst values are in the lower eighth of the axis. Chosen by eye.
_MAX_RATIO: Final = 4.0
#: Limit over the largest value up to which a limit is drawn that is not exceeded. Doubled, curves fill a sixth of the
#: axis. Chosen by eye.
_MAX_LIMIT_RATIO: Final = 3.0


def damage_figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Draw the figures; yield name, caption and figure of each."""
    if known := _with_values(dataset):
        yield (
            "damage-along",
            f"Worst value on a roller over its orbit at a cage slip of {100.0 * float(dataset['slip']):.3g} %; "
            "dashed are limits.",
            _along(known),
        )
    if inside := [measure for measure in known if np.isfinite(measure["across"]).any()]:
        places = dataset["place"].to_numpy()
        yield (
            "damage-across",
            "Values across the contacts where they are worst, from the inlet at -1 to the outlet at 1.",
            _panels(inside, "across", places, r"Place across the contact $x/b$ [–]"),
        )


def _with_values(dataset: "xr.Dataset") -> "list[xr.Dataset]":
    """Return the measures that have a value on a ring."""
    return [measure for measure in measures(dataset) if np.isfinite(measure["worst"]).any()]


def _along(known: "list[xr.Dataset]") -> "Figure":
    """Draw the worst value of each measure on a roller over its orbit."""
    angle = (np.degrees(known[0]["angle"].to_numpy()) + 180.0) % 360.0 - 180.0
    centred = np.argsort(angle)
    rotated = [measure.isel(angle=centred) for measure in known]
    figure = _panels(
        rotated, "along", angle[centred], "Position from the line of load [°]", with_limit=True
    )
    figure.axes[-1].set_xlim(-180.0, 180.0)
    figure.axes[-1].set_xticks(range(-180, 181, 90))
    return figure


def over_time(dataset: "xr.Dataset") -> "Figure":
    """Draw the worst value of each measure over the time of a motion, by ring."""
    time = dataset["measured_time"].to_numpy()
    return _panels(_with_values(dataset), "worst_over_time", time, "Time [s]", with_limit=True)


def _panels(
    known: "list[xr.Dataset]",
    name: str,
    x: "np.ndarray[Any, Any]",
    label: str,
    with_limit: bool = False,
) -> "Figure":
    """Draw a variable of each measure in a panel, with the limit of the measure if it is near or exceeded."""
    sheet = Sheet(SINGLE_COLUMN, len(known), 1, sharex=True, squeeze=False)
    for measure, axes in zip(known, sheet.axes[:, 0], strict=True):
        rows = measure[name].to_numpy()
        convert = _draw(axes, measure, x, rows)
        limit = float(measure["limit"])
        is_near = abs(limit) < _MAX_LIMIT_RATIO * np.nanmax(np.abs(rows))
        if with_limit and np.isfinite(limit) and (is_near or rings_beyond_limit(measure)):
            axes.axhline(convert(limit), color="black", linewidth=0.8, linestyle="dashed")
    sheet.axes[-1, 0].set_xlim(x[0], x[-1] if x.size > 1 else x[0] + 1.0)
    sheet.axes[-1, 0].set_xlabel(label)
    return sheet.done(height=len(known) * (0.75 * SINGLE_COLUMN[1] + 2 * ROW) + ROW)


def _draw(
    axes: "Axes", measure: "xr.Dataset", x: "np.ndarray[Any, Any]", rows: "np.ndarray[Any, Any]"
) -> Any:
    """Draw a row for each ring in the usual unit of the measure; return the function that converts values to that."""
    unit = str(measure["unit"].item())
    is_rise = unit == RISE
    is_largest = measure["sense"].item() == "largest"
    shown = "K" if is_rise else shown_unit(float(np.nanmax(np.abs(rows))), unit)

    def convert(values: Any) -> Any:
        return values if is_rise or not shown else converted(values, unit, shown)

    extreme = np.nanmax if is_largest else np.nanmin
    for ring, row in zip(map(str, measure["ring"].to_numpy()), rows, strict=True):
        if np.isfinite(row).any():
            value = format_value(float(extreme(row)), unit)
            axes.plot(
                x,
                convert(row),
                color=RING_COLOURS[ring],
                linestyle=DASHES[RINGS.index(ring)],
                label=f"{ring} ring, {value}".replace("degC", "°C").replace("m2", "m²"),
            )
    if not is_largest:  # large values, of contacts that hardly touch, would hide the worst
        axes.set_ylim(0.0, _MAX_RATIO * convert(float(np.nanmax(np.nanmin(rows, axis=1)))))
    meaning = str(measure["meaning"].item())
    axes.set_ylabel(f"{meaning[:1].upper()}{meaning[1:]}\n[{unit_label(shown) if shown else '–'}]")
    # above a power of ten at the axis
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=1.0)
    return convert
