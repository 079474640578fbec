"""Figures of steady slip: driving torque and drag over cage slip, the rollers' orbit, slips through their fold.

Style, sizes and files are those of `rollslip.results.style`. Everything reads in grey: what the cage does not hold is
dashed.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from rollslip.results.sheet import Sheet
from rollslip.results.style import (
    DASHES,
    MARKER,
    MODEL_COLOURS,
    RING_COLOURS,
    ROW,
    TWO_COLUMNS,
    axis_label,
    light_to_dark,
    unit_label,
)
from rollslip.units import converted, shown_unit
from rollslip_studies.steady_slip.findings import has_steady, varied

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

__all__ = ["steady_figures"]

Array = NDArray[np.float64]

_SYMBOLS: Final = {"inner_speed": r"$n_\mathrm{i}$", "temperature": r"$\vartheta$", "radial_load": r"$F_\mathrm{r}$"}
_OPEN: dict[str, Any] = {"marker": "o", "markersize": 4, "markerfacecolor": "white", "markeredgewidth": 0.9}


def steady_figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Draw the figures; give name, caption and figure of each."""
    which = f"{dataset.attrs['friction']} friction"
    yield (
        "steady-slip",
        f"Torque with which the rollers drive the cage and drag over cage slip, {which}.",
        _torques(dataset),
    )
    if has_steady(dataset):
        caption = f"Normal force and roller slip over the orbit at the steady cage slips, {which}."
        yield "steady-slip-orbit", caption, _orbit(dataset)
        if "loss" in dataset and float(np.abs(dataset["loss"]).max()) > 0.0:
            yield "steady-slip-losses", "Power lost to friction at the steady cage slips, by source.", _losses(dataset)
    for name in varied(dataset):
        if name in dataset:
            caption = (
                f"Steady cage slip against {name.replace('_', ' ')}, {which}; dashed is what the cage does not hold."
            )
            yield f"steady-slip-{name.replace('_', '-')}", caption, _branches(dataset, name)


def _torques(dataset: "xr.Dataset") -> "Figure":
    from scipy.interpolate import PchipInterpolator

    sheet = Sheet()
    axes = sheet.axes
    slip, driving = dataset["cage_slip"].to_numpy(), dataset["driving_torque"].to_numpy()
    fine = np.linspace(0.0, slip[-1], 400)
    drag = dataset["drag_torque"].to_numpy()
    curve = PchipInterpolator(slip, driving)(fine)
    sheet.line(100 * fine, curve, "the rollers drive", color=MODEL_COLOURS[0])
    sheet.line(100 * slip, drag, "the drags resist", color=MODEL_COLOURS[1], linewidth=1.0, linestyle=DASHES[3])
    largest = float(dataset["largest_drag"])
    if not np.isnan(largest):
        place = 100 * float(dataset["largest_drag_slip"]), largest
        sheet.mark(*place, f"largest drag, {largest:.3g} N m", marker="^", markersize=4)
    for stable, style, words in ((1, MARKER, "steady slip"), (0, _OPEN, "steady slip that is not held")):
        if has_steady(dataset) and (chosen := dataset["stable"].to_numpy() == stable).any():
            at = 100 * dataset["steady_slip"].to_numpy()[chosen]
            of = ", ".join(f"{value:.3g} %" for value in at)
            torque = dataset["torque"].to_numpy()[chosen]
            sheet.mark(at, torque, f"{words}, {of}", zorder=4, **style)
    axes.set_xlim(0.0, 100 * slip[-1])
    axes.set_ylim(min(0.0, float(driving.min())), 1.08 * max(driving.max(), min(drag.max(), 2.0 * driving.max())))
    return sheet.done(axis_label(dataset["cage_slip"], r"$S_\mathrm{c}$", "%"), "Torque on the cage [N m]")


def _losses(dataset: "xr.Dataset") -> "Figure":
    sheet = Sheet(TWO_COLUMNS)
    axes = sheet.axes
    power, sources = dataset["loss"].to_numpy(), [str(source) for source in dataset["source"].to_numpy()]
    place, begin = np.arange(power.shape[1]), np.zeros(power.shape[1])
    tints = light_to_dark()(np.linspace(1.0, 0.0, len(sources)))
    for source, tint, lost in zip(sources, tints, power, strict=True):
        bars = axes.barh(
            place, lost, left=begin, height=0.6, color=tint, edgecolor="white", linewidth=0.4,
            label=f"{source}, {', '.join(f'{value:.3g}' for value in lost)} W",
        )  # fmt: skip
        sheet.handles.append(bars[0])
        bars[0].set_label(bars.get_label())
        begin = begin + lost
    slips, held = dataset["steady_slip"].to_numpy(), dataset["stable"].to_numpy()
    states = [f"{100 * slip:.3g} %, {'held' if kept else 'not held'}" for slip, kept in zip(slips, held, strict=True)]
    axes.set_yticks(place, states)
    axes.invert_yaxis()
    words = axis_label(dataset["loss"], "$P$", "W"), axis_label(dataset["steady_slip"], r"$S_\mathrm{c}$", "%")
    return sheet.done(*words, columns=2, height=0.5 * TWO_COLUMNS[1] + 2 * ROW * power.shape[1])


def _orbit(dataset: "xr.Dataset") -> "Figure":
    sheet = Sheet(TWO_COLUMNS, 1, 2)
    forces, slips = sheet.axes
    angle = np.degrees(dataset["angle"].to_numpy())
    centred = np.argsort((angle + 180.0) % 360.0)
    shown = (angle[centred] + 180.0) % 360.0 - 180.0
    for k in range(dataset.sizes["steady"]):
        one = dataset.isel(steady=k)
        style: dict[str, Any] = {"linestyle": "solid" if int(one["stable"]) else "dashed"}
        for ring in one["ring"].to_numpy():
            force = one["normal_force"].sel(ring=ring).to_numpy()[centred]
            forces.plot(shown, force, color=RING_COLOURS[str(ring)], **style)
        roller, cage = 100 * one["roller_slip"].to_numpy()[centred], 100 * float(one["steady_slip"])
        slips.plot(shown, roller, color="black", **style)
        words = f"cage slip {cage:.3g} %, {str(one['stability'].item()).partition(':')[0]}"
        sheet.key(words, color="black", **style)
    for ring, colour in RING_COLOURS.items():
        sheet.key(f"{ring} ring", color=colour)
    for axes in (forces, slips):
        axes.set_xlabel("Position from the line of load [°]")
        axes.set_xlim(-180.0, 180.0)
        axes.set_xticks(range(-180, 181, 90))
    forces.set_ylim(bottom=0.0)
    forces.set_ylabel(axis_label(dataset["normal_force"], "$Q$", "N"))
    slips.set_ylabel(axis_label(dataset["roller_slip"], r"$S_\mathrm{r}$", "%"))
    return sheet.done(columns=2, height=TWO_COLUMNS[1] - ROW)


def _branches(dataset: "xr.Dataset", name: str) -> "Figure":
    sheet = Sheet()
    axes = sheet.axes
    value, unit, symbol = _for_people(dataset, name)
    slip, branch = 100 * dataset[f"{name}_slip"].to_numpy(), dataset[f"{name}_branch"].to_numpy()
    stable, fold = dataset[f"{name}_stable"].to_numpy() == 1, dataset[f"{name}_fold"].to_numpy() == 1
    for number in np.unique(branch):
        for kind, style in ((stable | fold, "solid"), (~stable, "dashed")):  # a fold belongs to both
            axes.plot(value, np.where(kind & (branch == number), slip, np.nan), color=MODEL_COLOURS[0], linestyle=style)
    kinds: Any = (("steady slip", "solid", stable), ("steady slip that is not held", "dashed", ~stable))
    for words, style, of_kind in kinds:
        if of_kind.any():
            sheet.key(words, color=MODEL_COLOURS[0], linestyle=style)
    if fold.any():
        words = ", ".join(f"{at:.4g} {unit}" for at in value[fold])
        sheet.mark(value[fold], slip[fold], f"fold, {words}", zorder=4, **MARKER)
    axes.set_ylim(bottom=0.0)
    return sheet.done(
        axis_label(dataset[name], symbol, unit), axis_label(dataset[f"{name}_slip"], r"$S_\mathrm{c}$", "%")
    )


def _for_people(dataset: "xr.Dataset", name: str) -> tuple[Array, str, str]:
    """Values of what was varied in the unit that people use, the unit, and the symbol."""
    values, unit = dataset[name].to_numpy(), str(dataset[name].attrs["units"])
    shown = shown_unit(float(np.nanmax(np.abs(values))), unit)
    return converted(values, unit, shown), unit_label(shown), _SYMBOLS[name]
