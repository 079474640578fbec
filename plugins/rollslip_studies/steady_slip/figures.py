"""Figures of study steady-slip: torques over cage slip, the orbit of a roller, and slips through folds.

Style, sizes and files are those of `rollslip.results.style`. Unstable slips are dashed, so that figures are readable in
grey.
"""

import json
import math
from collections.abc import Iterator, Mapping
from typing import Any, Final, TypeAlias

import attrs
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rollslip.bearing.assembly import assemble
from rollslip.errors import RollslipError
from rollslip.results.accounts import account_of
from rollslip.results.curve_figures import mark_measured, measured_values
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
    plain_decades,
    unit_label,
)
from rollslip.results.text import format_slip_band, percent, stated_load, two_digits
from rollslip.results.verdict import SKIDDING_SLIP
from rollslip.scene.reading import from_raw
from rollslip.search import Array
from rollslip.units import converted, shown_unit
from rollslip_studies.effective_friction.ring_figures import ring_figure
from rollslip_studies.motion.pockets import relative_play
from rollslip_studies.motion.torque_balance import torque_balance
from rollslip_studies.steady_slip.evaluated import without_play
from rollslip_studies.steady_slip.findings import has_steady, varied
from rollslip_studies.steady_slip.friction_torque.figures import losses_figure
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

#: Difference of two curves, over the largest value, below which they are drawn once: about the width of a line.
#: Doubled, the forces on both rings of a fast bearing would become one curve. Chosen.
_COINCIDENT: Final = 0.02
#: Height of the figure of the torques over the drag at the steady slip. Doubled, the operating point lies near the axis
#: where the rollers carry far more than the drag. Chosen.
_DRAGS: Final = 3.0
#: Ratio of the largest torque to this height from which the window is used. Chosen: below it the whole shows the same.
_ZOOMED: Final = 1.5
#: Corners of an inset, in fractions of the axes: left, bottom, width, height. Chosen by eye.
_CORNERS: Final = ((0.58, 0.58, 0.4, 0.38), (0.58, 0.11, 0.4, 0.34), (0.12, 0.58, 0.4, 0.38))
#: Width of the labels of an inset, in fractions of the axes. Chosen by eye.
_INSET_LABELS: Final = 0.1
# Slip over load. The curve is for the eye: exact are the slip of the run and the minimum load. Runs at nine other
# loads of three scenes of the catalogue, 0.4 to 4 times the load of the scene, have 0.5 to 2 times its slips.

#: Loads of the curve. Doubled, they take twice the time, 0.3 s for 13 rollers. Chosen by eye.
_LOADS: Final = 11
#: Factor by which the loads go beyond those that are marked, so that the letters of the verdicts have room. Chosen by
#: eye.
_BEYOND: Final = 1.8
#: Slices of a roller, at most. Twice as many changed slips of three scenes of the catalogue by up to 7 %, which the
#: shift through the results of the run takes away in part.
_SLICES: Final = 12
#: Smallest and largest slip and the number of slips between which the torque is interpolated. Chosen: smaller slips are
#: below the axis.
_SLIPS: Final = (1e-4, 0.9, 20)
#: Bounds of a slip that has log-odds: a cage that skids has the larger one. Chosen, far beyond the axis.
_SHIFTED_SLIPS: Final = (1e-6, 0.999)
#: Lower end of the axis of slips [%]. Chosen: a smaller slip is printed as below 0.1 %.
_LOWEST_SLIP: Final = 0.1
#: Verdict -> its colour, pale enough for lines and letters on it, from the smallest slips on.
_ZONES: Final = {"OK": "#e3f1e4", "SLIPS": "#fdf0d2", "SKIDS": "#f9dedb"}
#: Slips [%], torques [N m], label and style of a curve.
_TorqueCurve: TypeAlias = tuple[Array, Array, str, dict[str, Any]]

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
        yield from _load_figure(dataset)
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
                losses_figure(dataset),
            )
    for name in varied(dataset):
        if name in dataset:
            caption = (
                f"Steady cage slip against {name.replace('_', ' ')}, {friction}; dashed "
                "are unstable slips."
            )
            yield f"steady-slip-{name.replace('_', '-')}", caption, _branches(dataset, name)


def _torques(dataset: "xr.Dataset") -> "Figure":
    """Draw driving torque and drag torque over cage slip near the operating point, and the whole range in an inset."""
    sheet = Sheet()
    axes = sheet.axes
    curves = _torque_curves(dataset)
    for slip, torque, label, style in curves:
        sheet.line(slip, torque, label, **style)
    rows = {row.key: row for row in account_of(dataset).answer(dataset).rows}
    _mark_steady(sheet, dataset, rows["cage_slip"].band)
    measured, sigma, _ = _measured_slips(dataset, "")
    drag = np.interp(measured, 100 * dataset["cage_slip"], dataset["drag_torque"])
    mark_measured(sheet, measured, drag, x_error=sigma)
    acceptable = 100 * float(dataset.attrs.get("acceptable_slip", np.nan))
    if not np.isnan(acceptable):
        axes.axvline(acceptable, **_LIMIT)
        sheet.key(f"acceptable slip, {acceptable:.3g} %", **_LIMIT)
    whole = axes
    if window := _window(dataset, curves, rows["cage_slip"].band):
        right, bottom, top = window
        axes.set_xlim(0.0, right)
        axes.set_ylim(bottom, top)
        whole = axes.inset_axes(_free_corner(curves, window))
        for slip, torque, _, style in curves:
            whole.plot(slip, torque, **{**style, "linewidth": 0.7})
        across = [0.0, right, right, 0.0, 0.0]
        whole.plot(across, [bottom, bottom, top, top, bottom], color="0.35", linewidth=0.6)
        whole.tick_params(labelsize=6.5, length=2.0, pad=1.5)
        whole.locator_params(nbins=3)
    largest = float(dataset["limit_drag"])
    if not np.isnan(largest):
        label = f"limit drag torque, {two_digits(largest)} N m"
        style = {"axes": whole, "marker": "^", "markersize": 4}
        sheet.mark(100 * float(dataset["skidding_slip"]), largest, label, **style)
    values = np.concatenate([torque for _, torque, *_ in curves] + [[0.0]])
    whole.set_xlim(0.0, curves[0][0][-1])
    whole.set_ylim(values.min(), values.max() + 0.08 * np.ptp(values))
    return sheet.done(
        axis_label(dataset["cage_slip"], r"$S_\mathrm{c}$", "%"), "Torque on the cage [N m]"
    )


def _torque_curves(dataset: "xr.Dataset") -> list[_TorqueCurve]:
    """Return the curves of the torques: that of the rollers first, the drag last."""
    from scipy.interpolate import PchipInterpolator

    slip = dataset["cage_slip"].to_numpy()
    fine = np.linspace(0.0, slip[-1], 400)
    driving = PchipInterpolator(slip, dataset["driving_torque"].to_numpy())(fine)
    colour = MODEL_COLOURS[0]
    curves: list[_TorqueCurve] = [
        (100 * fine, driving, "driving torque of the rollers", {"color": colour})
    ]
    if "driving_torque_without_play" in dataset:
        torque = dataset["driving_torque_without_play"].to_numpy()
        style = {"color": colour, "linewidth": 0.8, "linestyle": DASHES[1]}
        curves.append((100 * slip, torque, "without play in the pockets", style))
    style = {"color": MODEL_COLOURS[1], "linewidth": 1.0, "linestyle": DASHES[3]}
    curves.append((100 * slip, dataset["drag_torque"].to_numpy(), "drag torque", style))
    return curves


def _mark_steady(sheet: Sheet, dataset: "xr.Dataset", band: tuple[float, float] | None) -> None:
    """Mark stable and unstable steady slips, with the band of the stable ones."""
    if not has_steady(dataset):
        return
    for stable, style, label in (
        (1, MARKER, "steady slip"),
        (0, _OPEN, "unstable steady slip"),
    ):
        chosen = dataset["stable"].to_numpy() == stable
        if not chosen.any():
            continue
        slips = dataset["steady_slip"].to_numpy()[chosen]
        torque = dataset["torque"].to_numpy()[chosen]
        label = f"{label}, {', '.join(map(percent, slips))}"
        if stable and band:
            label += f"; where data scatter {format_slip_band(*band)}"
            sheet.axes.plot(
                100 * np.minimum(band, 10.0),  # an end beyond the axis has no tick
                [torque[0]] * 2,
                color="black",
                linewidth=0.9,
                marker="|",
                markersize=5,
                zorder=3,
            )
        sheet.mark(100 * slips, torque, label, zorder=4, **style)


def _measured_slips(dataset: "xr.Dataset", name: str) -> tuple[Array, Array, Array]:
    """Return measured cage slips and their standard uncertainties [%], and values of an operating condition [SI].

    All other conditions are those of the scene; with an empty name all are.
    """
    key = f"operation.{name}"
    rows = measured_values(dataset, "cage_slip", [key] * bool(name))
    here = math.nan
    if rows:
        here = json.loads(dataset.attrs["scene_resolved"])["operation"].get(name, here)
    return (
        np.array([100.0 * row["measured"] for row in rows]),
        np.array([100.0 * row["standard_uncertainty"] for row in rows]),
        np.array([row["conditions"].get(key, [here])[0] for row in rows], dtype=float),
    )


def _window(
    dataset: "xr.Dataset", curves: list[_TorqueCurve], band: tuple[float, float] | None
) -> tuple[float, float, float] | None:
    """Return largest slip [%] and smallest and largest torque near the operating point; None for the whole range."""
    stable = dataset["stable"].to_numpy() == 1
    slip, driving, *_ = curves[0]
    top = _DRAGS * float(dataset["torque"].to_numpy()[stable][0]) if stable.any() else 0.0
    if not 0.0 < _ZOOMED * top < driving.max():
        return None
    ends = [float(dataset.attrs.get("acceptable_slip", 0.0)), *(band or ())]
    right = max(
        float(slip[np.argmax(driving >= top)]), *(110 * end for end in ends if end < math.inf)
    )
    right = min(right, float(slip[-1]))
    return right, max(min(float(driving.min()), 0.0), -top), top


def _free_corner(
    curves: list[_TorqueCurve], window: tuple[float, float, float]
) -> tuple[float, float, float, float]:
    """Return the corner of the window in which an inset covers the least of the curves, in fractions of the axes."""
    right, bottom, top = window
    fine = np.linspace(0.0, right, 200)
    heights = [
        (np.interp(fine, slip, torque) - bottom) / (top - bottom) for slip, torque, *_ in curves
    ]

    def covered(corner: tuple[float, float, float, float]) -> int:
        left, low, width, height = corner
        within = (fine / right > left - _INSET_LABELS) & (fine / right < left + width)
        return sum(
            int(np.count_nonzero(within & (y > low - _INSET_LABELS) & (y < low + height)))
            for y in heights
        )

    return min(_CORNERS, key=covered)


def _load_figure(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Yield name, caption and figure of the slip over the load; nothing where it is followed or not known."""
    if "makers_minimum_load" not in dataset or "radial_load" in varied(dataset):
        return
    try:
        load, slip = _slip_over_load(dataset)
    except (KeyError, RollslipError):  # an older result, or one of a package that is not installed
        return
    caption = (
        "Steady cage slip over the load with minimum loads, estimated through slip and minimum load of the run; "
        "at other loads within a factor of 2. Colours are verdicts by the slip alone."
    )
    yield "steady-slip-load", caption, _over_load(dataset, load, slip)


def _slip_over_load(dataset: "xr.Dataset") -> tuple[Array, Array]:
    """Return loads [N] and the slip at each, nearly 1 where the cage skids.

    The slip of rollers set in the cage is where the torque of few slices, at one position of the rollers, first exceeds
    the drag. What play in the pockets adds to it is that of the run, over the part of the orbit in which a roller is
    loaded.
    """
    scene = from_raw(json.loads(dataset.attrs["scene_resolved"]), "")
    known = _known_slips(dataset, scene.operation.load)
    of_set_rollers = _known_slips(without_play(dataset), scene.operation.load)
    marks = [*known, *of_set_rollers, *catalogue_loads(dataset).values()]
    loads = np.unique([*np.geomspace(min(marks) / _BEYOND, _BEYOND * max(marks), _LOADS), *marks])
    assembly = assemble(scene)
    assembly = assembly.at(
        attrs.evolve(assembly.resolution, slices=min(assembly.slices, _SLICES), quadrature="graded")
    )
    shared = torque_balance(assembly, n_positions=1, inertia=False)
    slips = np.geomspace(*_SLIPS)
    drags = np.array([shared.drag(slip) for slip in slips.tolist()])
    found = np.ones(loads.size)
    play = np.ones(loads.size)
    for k, load in enumerate(loads.tolist()):
        balance = torque_balance(
            assembly.at_load(load), n_positions=1, inertia=False, similar=shared
        )
        play[k] = relative_play(balance, _SLIPS[0])
        excess = balance.torques(slips) + drags
        if (excess >= 0.0).any():
            after = max(int(np.argmax(excess >= 0.0)), 1)
            around = slice(after - 1, after + 1)
            found[k] = np.exp(np.interp(0.0, excess[around], np.log(slips[around])))
    set_slips = _shifted(loads, found, of_set_rollers)
    here = scene.operation.load
    added = known[here] - of_set_rollers[here]
    if added > 0.0:
        set_slips = set_slips + added * play / play[np.searchsorted(loads, here)]
    return loads, _shifted(loads, set_slips, known)


def _known_slips(dataset: "xr.Dataset", load: float) -> dict[float, float]:
    """Return the slips of a result by load [N]: that of the scene, and the acceptable one at the minimum load."""
    minimum = float(dataset["minimum_load"])
    known = {minimum: float(dataset.attrs["acceptable_slip"])} if minimum > 0.0 else {}
    return known | {load: float(dataset["steady_slip"].to_numpy()[0])}


def _shifted(loads: Array, slips: Array, known: Mapping[float, float]) -> Array:
    """Return slips that are moved along the logarithm of the load [N], so that they are those known at some loads.

    A slip that falls with load is more sensitive to the load than the model is wrong by a factor of it.
    """
    log = np.log(loads)
    odds = np.log(np.clip(slips, *_SHIFTED_SLIPS) / (1.0 - np.clip(slips, *_SHIFTED_SLIPS)))
    at = np.array(sorted(known))
    right = np.clip([known[load] for load in at.tolist()], *_SHIFTED_SLIPS)
    model_log = np.interp(-np.log(right / (1.0 - right)), -odds, log)
    shift = np.interp(log, np.log(at), model_log - np.log(at))
    return np.asarray(1.0 / (1.0 + np.exp(-np.interp(log + shift, log, odds))))


def _over_load(dataset: "xr.Dataset", load: Array, slip: Array) -> "Figure":
    """Draw slip over load with the minimum loads, on the colours of the verdicts."""
    sheet = Sheet()
    axes = sheet.axes
    unit = shown_unit(float(load[-1]), "N")
    shown = converted(load, "N", unit)
    acceptable = 100 * float(dataset.attrs["acceptable_slip"])
    edges = [_LOWEST_SLIP, min(acceptable, 100 * SKIDDING_SLIP), 100 * SKIDDING_SLIP, 100.0]
    for low, high, (verdict, colour) in zip(edges[:-1], edges[1:], _ZONES.items(), strict=True):
        axes.axhspan(low, high, color=colour, linewidth=0.0, zorder=0)
        axes.text(
            0.99,
            math.sqrt(low * high),
            verdict,
            transform=axes.get_yaxis_transform(),
            ha="right",
            va="center",
            color="0.25",
        )
    sheet.line(shown, np.minimum(100 * slip, 100.0), "steady slip", color=MODEL_COLOURS[0])
    operation = json.loads(dataset.attrs["scene_resolved"])["operation"]
    here = stated_load(operation)
    slip_here = 100 * float(dataset["steady_slip"].to_numpy()[0])
    sheet.mark(converted(here, "N", unit), max(slip_here, _LOWEST_SLIP), "the scene", **MARKER)
    measured, sigma, loads = _measured_slips(dataset, "radial_load")
    mark_measured(sheet, converted(loads, "N", unit), measured, y_error=sigma)
    ends = [*shown[[0, -1]], *converted(loads, "N", unit)]
    plain_decades(axes.xaxis)
    plain_decades(axes.yaxis)
    axes.set_xlim(min(ends), max(ends))
    axes.set_ylim(_LOWEST_SLIP, 100.0)
    _mark_minimum_load(sheet, dataset, unit)
    label = f"Radial load {_SYMBOLS['radial_load']}"
    if operation["radial_load"] == 0.0 < here:
        label = "Axial load"
    return sheet.done(
        f"{label} [{unit}]",
        axis_label(dataset["cage_slip"], r"$S_\mathrm{c}$", "%"),
    )


def _mark_minimum_load(sheet: Sheet, dataset: "xr.Dataset", unit: str) -> None:
    """Draw the minimum load with its band, and those of catalogues, across an axis of loads."""
    rows = account_of(dataset).answer(dataset).rows
    row = next((row for row in rows if row.key == "minimum_load"), None)
    if row is not None and np.isfinite(row.value):
        band = ""
        if row.band:
            low, high = converted(np.array(row.band), "N", unit)
            band = f", {two_digits(low)} to {two_digits(high)} where data scatter:"
            sheet.axes.axvspan(low, high, color="0.5", alpha=0.2, linewidth=0.0, zorder=0)
        mark_loads(sheet, {f"minimum load{band}": row.value}, unit, color="black")
    mark_loads(sheet, catalogue_loads(dataset), unit)


def _set_turn(axes: Axes) -> None:
    """Set the abscissa of axes to a turn."""
    axes.set_xlabel("Position from the line of load [°]")
    axes.set_xlim(-180.0, 180.0)
    axes.set_xticks(range(-180, 181, 90))


def _orbit(dataset: "xr.Dataset") -> "Figure":
    """Draw normal forces and roller slip over the orbit at each steady slip; curves that coincide are drawn once.

    Forces of ribs that carry an axial load are among them.
    """
    sheet = Sheet(TWO_COLUMNS, 1, 2)
    forces, slips = sheet.axes
    angle = np.degrees(dataset["angle"].to_numpy())
    centred = np.argsort((angle + 180.0) % 360.0)
    shown = (angle[centred] + 180.0) % 360.0 - 180.0
    drawn = list[Array]()
    largest = float(dataset["normal_force"].max())
    for k in range(dataset.sizes["steady"]):
        state = dataset.isel(steady=k)
        style: dict[str, Any] = {"linestyle": "solid" if int(state["stable"]) else "dashed"}
        cage = 100 * float(state["steady_slip"])
        label = f"cage slip {cage:.3g} %, {str(state['stability'].item()).partition(':')[0]}"
        roller_slip = 100 * state["roller_slip"].to_numpy()[centred]
        sheet.line(shown, roller_slip, label, slips, color="black", **style)
        for ring, force in zip(
            state["ring"].to_numpy(), state["normal_force"].to_numpy(), strict=True
        ):
            if all(np.abs(force - other).max() > _COINCIDENT * largest for other in drawn):
                drawn.append(force)
                sheet.line(
                    shown,
                    force[centred],
                    f"{ring} ring",
                    forces,
                    color=RING_COLOURS[str(ring)],
                    **style,
                )
    if len(drawn) == 1:
        sheet.handles[1].set_label("inner and outer ring")
    if "rib_force" in dataset:  # at all steady slips nearly the same
        rib_force = dataset["rib_force"].isel(steady=0).to_numpy()
        sheet.line(shown, rib_force[centred], "each rib", forces, color=MODEL_COLOURS[2])
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
    measured, sigma, at = _measured_slips(dataset, name)
    si = str(dataset[name].attrs["units"])
    shown = shown_unit(float(np.nanmax(np.abs(dataset[name]))), si)
    mark_measured(sheet, converted(at, si, shown), measured, y_error=sigma)
    axes.set_ylim(bottom=0.0)
    if name == "radial_load" and "makers_minimum_load" in dataset:
        acceptable = 100 * float(dataset.attrs["acceptable_slip"])
        axes.axhline(acceptable, **_LIMIT)
        sheet.key(f"acceptable slip, {acceptable:.3g} %", **_LIMIT)
        _mark_minimum_load(sheet, dataset, unit)
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
