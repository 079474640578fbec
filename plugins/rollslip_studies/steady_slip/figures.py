"""Figures of study steady-slip: torques over cage slip, the orbit of a roller, losses, and slips through folds.

Style, sizes and files are those of `rollslip.results.style`. Unstable slips are dashed, so that figures are readable in
grey.
"""

import json
from collections.abc import Iterator, Mapping
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rollslip.errors import RollslipError
from rollslip.results.accounts import account_of
from rollslip.results.dataset import xr
from rollslip.results.style import (
    DASHES,
    MARKER,
    MODEL_COLOURS,
    RING_COLOURS,
    ROW,
    TWO_COLUMNS,
    Sheet,
    axis_label,
    light_to_dark,
    unit_label,
)
from rollslip.results.text import format_slip_band, percent, two_digits
from rollslip.scene.reading import from_raw
from rollslip.search import Array
from rollslip.units import converted, shown_unit
from rollslip_studies.effective_friction.ring_figures import ring_figure
from rollslip_studies.steady_slip.findings import has_steady, varied
from rollslip_studies.steady_slip.minimum_load import RULES, minimum_loads_of_makers

__all__ = ["catalogue_loads", "mark_loads", "steady_figures"]


#: Symbols of the operating conditions over which slips are followed.
_SYMBOLS: Final = {
    "inner_speed": r"$n_\mathrm{i}$",
    "temperature": r"$\vartheta$",
    "radial_load": r"$F_\mathrm{r}$",
}
#: Style of a limit, such as the acceptable slip.
_LIMIT: Final[dict[str, Any]] = {"color": "0.35", "linewidth": 0.8, "linestyle": DASHES[2]}
#: Style of the mark of an unstable slip.
_OPEN: Final[dict[str, Any]] = {
    "marker": "o",
    "markersize": 4,
    "markerfacecolor": "white",
    "markeredgewidth": 0.9,
}

#: What a roller does -> style. The crossing is dashed, so that the figure is readable in grey.
_STYLES: Final[dict[str, dict[str, Any]]] = {
    "drives the cage": {"color": MODEL_COLOURS[0]},
    "crosses the play": {"color": MODEL_COLOURS[1], "linestyle": "dashed"},
    "is pushed by the cage": {"color": "0.45"},
}
#: Variables of the fractions of a turn, in the same order.
_FRACTIONS: Final = ("driving_fraction", "crossing_fraction", "pushed_fraction")
#: Style of the mark of an impact.
_MEETS: Final[dict[str, Any]] = {"marker": "x", "markersize": 4}


def steady_figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Yield name, caption and figure of each figure."""
    friction = f"{dataset.attrs['friction']} friction"
    yield (
        "steady-slip",
        f"Driving torque of the rollers and drag torque over cage slip, {friction}.",
        _torques(dataset),
    )
    if has_steady(dataset):
        caption = (
            f"Normal force and roller slip over the orbit at the steady cage slips, {friction}."
        )
        yield "steady-slip-orbit", caption, _orbit(dataset)
        yield from _pocket_figure(dataset)
        yield from ring_figure(dataset)
        # one bar would only repeat a sentence
        if (
            dataset.sizes["steady"] > 1
            and "loss" in dataset
            and float(np.abs(dataset["loss"]).max()) > 0.0
        ):
            yield (
                "steady-slip-losses",
                "Power lost to friction at the steady cage slips, by source.",
                _losses(dataset),
            )
    for name in varied(dataset):
        if name in dataset:
            caption = (
                f"Steady cage slip against {name.replace('_', ' ')}, {friction}; dashed "
                "are unstable slips."
            )
            yield f"steady-slip-{name.replace('_', '-')}", caption, _branches(dataset, name)


def _torques(dataset: "xr.Dataset") -> "Figure":
    """Draw driving torque and drag torque over cage slip, with steady slips and the limit drag torque."""
    from scipy.interpolate import PchipInterpolator

    sheet = Sheet()
    axes = sheet.axes
    slip = dataset["cage_slip"].to_numpy()
    driving = dataset["driving_torque"].to_numpy()
    fine = np.linspace(0.0, slip[-1], 400)
    drag = dataset["drag_torque"].to_numpy()
    curve = PchipInterpolator(slip, driving)(fine)
    sheet.line(100 * fine, curve, "driving torque of the rollers", color=MODEL_COLOURS[0])
    if "driving_torque_without_play" in dataset:
        sheet.line(
            100 * slip,
            dataset["driving_torque_without_play"].to_numpy(),
            "without play in the pockets",
            color=MODEL_COLOURS[0],
            linewidth=0.8,
            linestyle=DASHES[1],
        )
    sheet.line(
        100 * slip, drag, "drag torque", color=MODEL_COLOURS[1], linewidth=1.0, linestyle=DASHES[3]
    )
    rows = {row.key: row for row in account_of(dataset).answer(dataset).rows}
    largest = float(dataset["limit_drag"])
    if not np.isnan(largest):
        sheet.mark(
            100 * float(dataset["skidding_slip"]),
            largest,
            f"limit drag torque, {two_digits(largest)} N m",
            marker="^",
            markersize=4,
        )
    for stable, style, label in (
        (1, MARKER, "steady slip"),
        (0, _OPEN, "unstable steady slip"),
    ):
        if has_steady(dataset) and (chosen := dataset["stable"].to_numpy() == stable).any():
            at = 100 * dataset["steady_slip"].to_numpy()[chosen]
            torque = dataset["torque"].to_numpy()[chosen]
            label = f"{label}, {', '.join(percent(0.01 * value) for value in at)}"
            if stable and (band := rows["cage_slip"].band):
                label += f"; where data scatter {format_slip_band(*band)}"
                axes.plot(
                    100 * np.minimum(band, 10.0),  # an end beyond the axis has no tick
                    [torque[0]] * 2,
                    color="black",
                    linewidth=0.9,
                    marker="|",
                    markersize=5,
                    zorder=3,
                )
            sheet.mark(at, torque, label, zorder=4, clip_on=False, **style)
    if "minimum_load" in rows:
        acceptable = 100 * float(dataset.attrs["acceptable_slip"])
        minimum = rows["minimum_load"]
        axes.axvline(acceptable, **_LIMIT)
        label = f"minimum load {minimum.text}, {minimum.note}"
        if not np.isfinite(minimum.value):
            label = f"acceptable slip, {acceptable:.3g} %; {label}"
        sheet.key(label, **_LIMIT)
    values = np.concatenate([curve, drag, [0.0]])
    low = values.min()
    high = values.max()
    axes.set_xlim(0.0, 100 * slip[-1])
    axes.set_ylim(low, high + 0.08 * (high - low))
    return sheet.done(
        axis_label(dataset["cage_slip"], r"$S_\mathrm{c}$", "%"), "Torque on the cage [N m]"
    )


def _losses(dataset: "xr.Dataset") -> "Figure":
    """Draw the losses at each steady slip as stacked bars, by source."""
    sheet = Sheet(TWO_COLUMNS)
    axes = sheet.axes
    power = dataset["loss"].to_numpy()
    sources = list(map(str, dataset["source"].to_numpy()))
    rows = np.arange(power.shape[1])
    left = np.zeros(power.shape[1])
    tints = light_to_dark()(np.linspace(1.0, 0.0, len(sources)))
    for source, tint, lost in zip(sources, tints, power, strict=True):
        bars = axes.barh(
            rows,
            lost,
            left=left,
            height=0.6,
            color=tint,
            edgecolor="white",
            linewidth=0.4,
            label=f"{source}, {', '.join(f'{value:.3g}' for value in lost)} W",
        )
        sheet.handles.append(bars[0])
        bars[0].set_label(bars.get_label())
        left = left + lost
    axes.set_yticks(
        rows,
        [
            f"{100 * slip:.3g} %, {'stable' if stable else 'unstable'}"
            for slip, stable in zip(
                dataset["steady_slip"].to_numpy(), dataset["stable"].to_numpy(), strict=True
            )
        ],
    )
    axes.invert_yaxis()
    return sheet.done(
        axis_label(dataset["loss"], "$P$", "W"),
        axis_label(dataset["steady_slip"], r"$S_\mathrm{c}$", "%"),
        columns=2,
        height=0.5 * TWO_COLUMNS[1] + 2 * ROW * power.shape[1],
    )


def _set_turn(axes: Axes) -> None:
    """Set the abscissa of axes to a turn."""
    axes.set_xlabel("Position from the line of load [°]")
    axes.set_xlim(-180.0, 180.0)
    axes.set_xticks(range(-180, 181, 90))


def _orbit(dataset: "xr.Dataset") -> "Figure":
    """Draw normal forces and roller slip over the orbit at each steady slip."""
    sheet = Sheet(TWO_COLUMNS, 1, 2)
    forces, slips = sheet.axes
    angle = np.degrees(dataset["angle"].to_numpy())
    centred = np.argsort((angle + 180.0) % 360.0)
    shown = (angle[centred] + 180.0) % 360.0 - 180.0
    for k in range(dataset.sizes["steady"]):
        state = dataset.isel(steady=k)
        style: dict[str, Any] = {"linestyle": "solid" if int(state["stable"]) else "dashed"}
        for ring in state["ring"].to_numpy():
            force = state["normal_force"].sel(ring=ring).to_numpy()[centred]
            forces.plot(shown, force, color=RING_COLOURS[str(ring)], **style)
        cage = 100 * float(state["steady_slip"])
        slips.plot(shown, 100 * state["roller_slip"].to_numpy()[centred], color="black", **style)
        label = f"cage slip {cage:.3g} %, {str(state['stability'].item()).partition(':')[0]}"
        sheet.key(label, color="black", **style)
    for ring, colour in RING_COLOURS.items():
        sheet.key(f"{ring} ring", color=colour)
    for axes in (forces, slips):
        _set_turn(axes)
    forces.set_ylim(bottom=0.0)
    forces.set_ylabel(axis_label(dataset["normal_force"], "$Q$", "N"))
    slips.set_ylabel(axis_label(dataset["roller_slip"], r"$S_\mathrm{r}$", "%"))
    return sheet.done(columns=2, height=TWO_COLUMNS[1] - ROW)


def _branches(dataset: "xr.Dataset", name: str) -> "Figure":
    """Draw steady slips over an operating condition, with folds, and over the load with minimum loads."""
    sheet = Sheet()
    axes = sheet.axes
    value, unit, symbol = _in_shown_unit(dataset, name)
    slip = 100 * dataset[f"{name}_slip"].to_numpy()
    branch = dataset[f"{name}_branch"].to_numpy()
    stable = dataset[f"{name}_stable"].to_numpy() == 1
    fold = dataset[f"{name}_fold"].to_numpy() == 1
    for number in np.unique(branch):
        for shown, style in ((stable | fold, "solid"), (~stable, "dashed")):  # folds are in both
            axes.plot(
                value,
                np.where(shown & (branch == number), slip, np.nan),
                color=MODEL_COLOURS[0],
                linestyle=style,
            )
    for label, style, chosen in (
        ("steady slip", "solid", stable),
        ("unstable steady slip", "dashed", ~stable),
    ):
        if chosen.any():
            sheet.key(label, color=MODEL_COLOURS[0], linestyle=style)
    if fold.any():
        values = ", ".join(f"{at:.4g} {unit}" for at in value[fold])
        sheet.mark(value[fold], slip[fold], f"fold, {values}", zorder=4, **MARKER)
    axes.set_ylim(bottom=0.0)
    if name == "radial_load" and "makers_minimum_load" in dataset:
        acceptable = 100 * float(dataset.attrs["acceptable_slip"])
        axes.axhline(acceptable, **_LIMIT)
        sheet.key(f"acceptable slip, {acceptable:.3g} %", **_LIMIT)
        row = next(
            (row for row in account_of(dataset).answer(dataset).rows if row.key == "minimum_load"),
            None,
        )
        if row is not None and np.isfinite(row.value):
            band = ""
            if row.band:
                low, high = converted(np.array(row.band), "N", unit)
                band = f", {two_digits(low)} to {two_digits(high)} where data scatter:"
                axes.axvspan(low, high, color="0.9", linewidth=0.0, zorder=0)
            mark_loads(sheet, {f"minimum load{band}": row.value}, unit, color="black")
        mark_loads(sheet, catalogue_loads(dataset), unit)
    return sheet.done(
        axis_label(dataset[name], symbol, unit),
        axis_label(dataset[f"{name}_slip"], r"$S_\mathrm{c}$", "%"),
    )


def catalogue_loads(dataset: "xr.Dataset") -> dict[str, float]:
    """Return the minimum loads of catalogues [N] for the bearing of a result by label, the smallest first.

    They are evaluated from the scene of the result, so that results of sweeps have them, too.
    """
    try:
        loads, _ = minimum_loads_of_makers(
            from_raw(json.loads(dataset.attrs["scene_resolved"]), "")
        )
    except (KeyError, RollslipError):  # an older result
        return {}
    pairs = sorted(
        (float(load), maker) for maker, load in zip(RULES, loads, strict=True) if load > 0.0
    )
    return {f"catalogue minimum load, {maker}": load for load, maker in pairs}


def mark_loads(sheet: Sheet, loads: Mapping[str, float], unit: str, **style: Any) -> None:
    """Draw loads as lines across an axis of loads; for a load beyond the axis there is a text in the legend only.

    Parameters
    ----------
    sheet : Sheet
        The figure.
    loads : mapping
        Loads [N] by label.
    unit : str
        Unit of the axis.
    **style
        Style of the lines.
    """
    low, high = sheet.axes.get_xlim()
    for k, (label, load) in enumerate(loads.items(), 1):
        at = float(converted(load, "N", unit))
        line: dict[str, Any] = {
            "color": "0.45",
            "linewidth": 0.8,
            "linestyle": DASHES[k % len(DASHES)],
            **style,
        }
        if low <= at <= high:
            sheet.axes.axvline(at, **line)
            sheet.key(f"{label} {two_digits(at)} {unit}", **line)
        else:
            sheet.key(f"{label} {two_digits(at)} {unit}, beyond the axis", linestyle="none")
    sheet.axes.set_xlim(low, high)


def _in_shown_unit(dataset: "xr.Dataset", name: str) -> tuple[Array, str, str]:
    """Return values of an operating condition in the unit that people read, that unit, and the symbol."""
    values = dataset[name].to_numpy()
    unit = str(dataset[name].attrs["units"])
    shown = shown_unit(float(np.nanmax(np.abs(values))), unit)
    return converted(values, unit, shown), unit_label(shown), _SYMBOLS[name]


def _pocket_figure(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Yield name, caption and figure of a turn of a roller with play in its pocket; nothing if there is none.

    Parameters
    ----------
    dataset : xarray.Dataset
        With ``pocket_position`` over half of the play, 1 at the bar that the roller drives, and ``pocket_force`` on the
        bars [N], both over ``pocket_angle`` [rad], and with the fractions of the turn.
    """
    if "pocket_position" in dataset and np.isfinite(dataset["pocket_position"]).all():
        yield (
            "steady-slip-pocket",
            "Position of a roller in its pocket, and its force on the bars, over a turn at the steady cage slip with "
            "play in the pockets.",
            _pocket(dataset),
        )


def _pocket(dataset: "xr.Dataset") -> "Figure":
    """Draw position and force over the angle, with marks at impacts, whose mean force depends on the step."""
    sheet = Sheet(TWO_COLUMNS, 1, 2)
    positions, forces = sheet.axes
    came = dataset["pocket_position"] != dataset["pocket_position"].roll(pocket_angle=1)
    turn = dataset.assign(
        impact=came & (np.abs(dataset["pocket_position"]) >= 1.0),
        shown=(np.degrees(dataset["pocket_angle"]) + 180.0) % 360.0 - 180.0,
    ).sortby("shown")
    shown = turn["shown"].to_numpy()
    position = turn["pocket_position"].to_numpy()
    impact = turn["impact"].to_numpy()
    force = np.where(impact, np.nan, turn["pocket_force"].to_numpy())
    at = (position >= 1.0, np.abs(position) < 1.0, position <= -1.0)
    for chosen, (label, style), fraction in zip(at, _STYLES.items(), _FRACTIONS, strict=True):
        # lines of the position reach to the next part
        joined = chosen | np.roll(chosen, 1) | np.roll(chosen, -1)
        positions.plot(shown, np.where(joined, position, np.nan), **style)
        forces.plot(shown, np.where(chosen, force, np.nan), **style)
        sheet.key(f"{label}, {percent(float(dataset[fraction]))} of the turn", **style)
    if impact.any():
        sheet.mark(shown[impact], position[impact], "meets a bar", axes=positions, **_MEETS)
        forces.plot(shown[impact], 0.0 * shown[impact], color="black", linestyle="none", **_MEETS)
    for axes in (positions, forces):
        _set_turn(axes)
    positions.set_yticks([-1.0, 0.0, 1.0])
    positions.set_ylabel(axis_label(dataset["pocket_position"], "$2x/c$", unit_label("")))
    forces.set_ylabel(axis_label(dataset["pocket_force"], "$P$", "N"))
    return sheet.done(columns=2, height=TWO_COLUMNS[1] - ROW)
