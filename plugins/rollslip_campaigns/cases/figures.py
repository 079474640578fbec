"""The figure of a table of load cases: the cases over speed and load, coloured by verdict, with areas by time.

Style, sizes and files are those of `rollslip.results.style`.
"""

from collections.abc import Iterator
from typing import Any, Final

import numpy as np
from matplotlib.figure import Figure

from rollslip.results.answer import COLOURS
from rollslip.results.curve_figures import mark_measured, measured_values
from rollslip.results.dataset import xr
from rollslip.results.style import Sheet, unit_label
from rollslip.results.text import capitalise, short_label
from rollslip.results.verdict import Verdict
from rollslip.units import converted, shown_unit

__all__ = ["case_figures", "draw_cases"]

#: Area of the circle of the longest case [points^2]; others are in proportion. Chosen: a tenth of a figure's width.
_LARGEST_AREA: Final = 300.0
#: Smallest area [points^2], of cases that take hardly any time. Chosen: a circle that is still seen.
_SMALLEST_AREA: Final = 8.0
#: Quantities of the axes, if they vary: those over which engineers read a duty.
_PREFERRED: Final = ("operation.inner_speed", "operation.radial_load")
#: Variable that may be along an axis -> the measured quantity.
_MEASURED: Final = {"slip": "cage_slip", "friction_torque": "friction_torque"}


def case_figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Draw the figure if any case has a result; yield its name, caption and figure."""
    if (dataset["status"] == "ok").any():
        yield (
            "cases",
            "Load cases by verdict; areas grow with the time that a case takes.",
            draw_cases(dataset),
        )


def draw_cases(dataset: "xr.Dataset") -> "Figure":
    """Draw a circle for each case over two of the quantities that vary, or over the slip where one varies."""
    varied = [c for c in dataset.coords.values() if "key" in c.attrs and c.dtype.kind == "f"]
    varied.sort(key=lambda c: c.attrs["key"] not in _PREFERRED)
    candidates = [*varied, dataset["slip"], dataset["friction_torque"]]
    x = candidates[0]
    y = candidates[1]
    if y.attrs.get("key") == _PREFERRED[0]:
        x, y = y, x
    sheet = Sheet()
    x_values, x_label = _shown(x)
    y_values, y_label = _shown(y)
    fractions = dataset["time_fraction"].to_numpy()
    areas = np.maximum(_LARGEST_AREA * fractions / fractions.max(), _SMALLEST_AREA)
    verdicts = dataset["verdict"].to_numpy().astype(str)
    for verdict in Verdict:
        chosen = verdicts == str(verdict)
        if chosen.any():
            colour = COLOURS[verdict][1]
            sheet.axes.scatter(
                x_values[chosen], y_values[chosen], s=areas[chosen], color=colour, alpha=0.7,
                edgecolor="black", linewidth=0.4,
            )  # fmt: skip
            sheet.key(str(verdict), marker="o", linestyle="none", color=colour)
    _mark_measured(sheet, dataset, x, y)
    return sheet.done(x_label, y_label, columns=len(sheet.handles))


def _mark_measured(sheet: Sheet, dataset: "xr.Dataset", *axes: "xr.DataArray") -> None:
    """Mark the measured points whose table has the quantities of both axes; an output has bars."""
    quantity = next((_MEASURED[str(axis.name)] for axis in axes if axis.name in _MEASURED), "")
    rows = measured_values(dataset, quantity)
    columns = list[Any]()
    errors = list[Any]()
    for axis in axes:
        unit = str(axis.attrs["units"])
        key = str(axis.attrs.get("key", ""))
        sigma = None
        if axis.name in _MEASURED:
            values = [row["measured"] for row in rows]
            sigma = converted(
                np.array([row["standard_uncertainty"] for row in rows]), unit, _unit(axis)
            )
        elif rows and key in rows[0]["conditions"]:
            values = [row["conditions"][key][0] for row in rows]
        else:
            return
        columns.append(converted(np.array(values), unit, _unit(axis)))
        errors.append(sigma)
    mark_measured(sheet, *columns, *errors)


def _unit(values: "xr.DataArray") -> str:
    """Return the usual unit of values."""
    if values.name == "slip":
        return "%"
    unit = str(values.attrs["units"])
    return shown_unit(float(np.nanmax(np.abs(values.to_numpy()))), unit) or unit


def _shown(values: "xr.DataArray") -> tuple[Any, str]:
    """Return values in the usual unit, and the label of their axis."""
    shown = _unit(values)
    name = short_label(str(values.attrs.get("key", values.name))).replace("_", " ")
    numbers = converted(values.to_numpy(), str(values.attrs["units"]), shown)
    return numbers, f"{capitalise(name)} [{unit_label(shown)}]"
