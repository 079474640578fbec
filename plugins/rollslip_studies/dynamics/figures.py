"""Figures of motions: speeds, maps over orbit and time, the energy ledger, the tracks of the centres.

Style, sizes and files are those of `rollslip.results.style`. Everything reads in grey: motions that are compared differ
in dashes, maps in lightness.
"""

import math
from collections.abc import Iterator, Mapping
from typing import Any, Final

import attrs
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from rollslip.results.dataset import xr
from rollslip.results.style import (
    DASHES,
    MARKER,
    MM,
    MODEL_COLOURS,
    TWO_COLUMNS,
    Sheet,
    light_to_dark,
    seamless,
)
from rollslip.results.text import capitalise
from rollslip.search import Array
from rollslip_studies.dynamics import history_findings
from rollslip_studies.dynamics.findings import (
    common_times,
    describe_differences,
    ledger,
    median_epicyclic_speed,
    relative_difference,
    skidding_passages,
    skidding_slip,
    turnover,
)
from rollslip_studies.dynamics.history.figures import phase, slip_along
from rollslip_studies.surface_damage.figures import over_time
from rollslip_studies.thermal_balance.figures import course

__all__ = ["motion_figures", "motions_together"]

#: Revolutions per minute in a radian per second: speeds are shown in rpm.
_RPM = 30.0 / math.pi
#: Least number of stored times an orbit for the curve of a single roller, else that of the mean is drawn. Halved, the
#: curve would alias. Chosen.
_MIN_TIMES_PER_ORBIT = 6.0
#: Largest number of orbits for the curve of a single roller. Doubled, the lines merge on paper. Chosen.
_MAX_ORBITS = 40.0
#: Largest number of cells of a map along time. Doubled, files are twice as large. Chosen by eye.
_MAX_TIME_CELLS = 60
#: Least and largest number of cells of a map along the orbit; between, one for each roller. Chosen by eye.
_ORBIT_CELLS = (12, 48)
#: Pieces of one shade of a track that gets darker with time. Doubled, files are larger, and shades differ less. Chosen
#: by eye.
_TRACK_PIECES: Final = 30
#: Least ratio of the largest slip to the skidding slip for which the latter is drawn. Halved, half of the axis may be
#: empty or more. Chosen by eye.
_MIN_SLIP_RATIO = 0.5
#: Film parameter over the smallest one from which on cells have the same colour: unloaded contacts have large values,
#: which would hide the differences of the small ones. Chosen by eye.
_MAX_FILM_RATIO = 3.0
#: Difference of two curves, over the range of values, below which they are drawn once: the width of a line.
_COINCIDENT: Final = 0.01
#: Relative range of values below which a map has a range of 10 % of its value: below it is rounding.
_ROUNDING = 1e-9
#: Largest number of marks of events along the axis of time. Doubled, marks overlap on paper. Chosen by eye.
_MAX_EVENT_MARKS = 300.0
#: Duration below which times are shown in ms [s]. Chosen.
_MAX_MILLISECONDS = 0.05
#: Style of lines that are for orientation.
_QUIET: Final[Mapping[str, Any]] = {"color": "0.45", "linewidth": 0.8, "zorder": 1}


def motion_figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Draw the figures of a motion; yield name, caption and figure of each.

    The names contain the friction, so that motions of one run do not overwrite each other's figures.
    """
    name = f"dynamics-{dataset.attrs['friction']}"
    motion = f"level {dataset.attrs['level']}, {dataset.attrs['friction']} friction"
    yield name, f"Speed of cage and rollers against time, {motion}.", _speeds(dataset)
    yield (
        f"{name}-orbit",
        f"Contacts with the inner ring over orbit and time, {motion}; 0 is the line of load, and blank is where no "
        "roller was loaded or the value is not known; pocket forces are the largest.",
        _orbit(dataset),
    )
    if "measure" in dataset.dims and np.isfinite(dataset["worst"]).any():
        yield (
            f"{name}-damage",
            f"Worst value of each measure of damage over the contacts at a moment, {motion}; dashed are limits.",
            over_time(dataset),
        )
    if history_findings.has_heating(dataset):
        yield (
            f"{name}-temperatures",
            f"Bulk temperatures that the losses of the motion lead to, {motion}.",
            course(dataset),
        )
    if history_findings.has_history(dataset):
        yield (
            f"{name}-history",
            f"Cage slip along the history, {motion}, with the slip at which skidding begins and that at largest "
            "traction of a steady state at the operation of each moment; a curve is missing where it is not known.",
            slip_along(dataset),
        )
        yield (
            f"{name}-phase",
            f"Cage slip against that at which skidding begins at that moment, {motion}: beyond the diagonal the cage "
            "skids. Numbers are times in seconds; a moment at which either is not known is left out.",
            phase(dataset),
        )
    yield f"{name}-energy", f"Energy ledger since the start, {motion}.", _energy(dataset)
    if "ring_displacement" in dataset:
        yield (
            f"{name}-centres",
            f"Tracks of the centres of inner ring and cage, {motion}; colours show the time, a circle is the end.",
            _centres(dataset),
        )


def motions_together(datasets: "Mapping[str, xr.Dataset]") -> "Iterator[tuple[str, str, Figure]]":
    """Yield the figure of several motions of one bearing: speeds of cage and roller over time, and their differences.

    Parameters
    ----------
    datasets : mapping of str to xarray.Dataset
        Two or more results of dynamics, by their names in the legend; the others are compared with the first.
    """
    differences = " ".join(f"{capitalise(text)}." for text in describe_differences(datasets))
    caption = f"Speed of cage and roller against time: {', '.join(datasets)}. {differences}"
    yield "dynamics-together", caption, _together(datasets)


# Figures ------------------------------------------------------------------------------------------------------------


def _speeds(dataset: "xr.Dataset") -> "Figure":
    """Draw the speeds of cage and rollers over time, with their levels without slip, and events."""
    sheet = Sheet(TWO_COLUMNS, 1, 2)
    cage, roller = sheet.axes
    time = _time(dataset)
    speed = _RPM * dataset["cage_speed"].to_numpy()
    _line(sheet, cage, time, speed, label="cage", color=MODEL_COLOURS[0])
    if history_findings.has_history(dataset):
        _line(
            sheet,
            cage,
            time,
            _RPM * dataset["epicyclic_cage_speed"].to_numpy(),
            label="without slip",
            linestyle="dotted",
            **_QUIET,
        )
    else:
        _draw_levels(sheet, dataset)
    passages = skidding_passages(dataset)
    for passage_time, rising in passages:
        shown_time = _scale(dataset) * passage_time
        cage.plot(shown_time, np.interp(shown_time, time, speed), **_passage(rising))
    for rising, label in ((True, "rising"), (False, "falling")):
        if rising in [passage_rising for _, passage_rising in passages]:
            sheet.key(f"passed while {label}", linestyle="none", **_passage(rising))
    if others := _other_events(dataset):
        cage.vlines(
            others, 0.0, 0.03, transform=cage.get_xaxis_transform(), color="0.3", linewidth=0.6
        )
        sheet.key("events (at the foot)", linestyle="none", marker="|", color="0.3", markersize=5)
    _draw_roller_speeds(sheet, dataset)
    _draw_orbit_means(sheet, dataset)
    cage.set_ylabel("Cage speed [rpm]")
    roller.set_ylabel("Roller speed, relative to the cage [rpm]")
    for axes in (cage, roller):
        _time_axis(axes, dataset)
    return _done(sheet)


def _draw_levels(sheet: Sheet, dataset: "xr.Dataset") -> None:
    """Draw the speeds without slip, and the cage speed at which skidding begins."""
    cage, roller = sheet.axes
    epicyclic = _RPM * median_epicyclic_speed(dataset, "cage")
    if math.isnan(epicyclic):
        return
    for axes, speed in (
        (cage, epicyclic),
        (roller, _RPM * median_epicyclic_speed(dataset, "roller")),
    ):
        if not math.isnan(speed):
            axes.axhline(speed, linestyle="dotted", **_QUIET)
    sheet.key("without slip", linestyle="dotted", **_QUIET)
    limit = skidding_slip(dataset)
    if float(dataset["cage_slip"].max()) > _MIN_SLIP_RATIO * limit:
        cage.axhline((1.0 - limit) * epicyclic, linestyle=DASHES[1], **_QUIET)
        sheet.key(f"skidding begins, {100 * limit:.3g} %", linestyle=DASHES[1], **_QUIET)


def _draw_roller_speeds(sheet: Sheet, dataset: "xr.Dataset") -> None:
    """Draw the range of the speeds of all rollers, and the curve of one roller or of the mean."""
    from matplotlib.patches import Patch

    roller = sheet.axes[1]
    time = _time(dataset)
    speeds = _RPM * dataset["roller_speed"].to_numpy()
    if dataset.sizes["roller"] > 1:
        tint: dict[str, Any] = {"color": MODEL_COLOURS[1], "alpha": 0.25, "linewidth": 0.0}
        if time.size > 1:
            roller.fill_between(time, speeds.min(axis=1), speeds.max(axis=1), **tint)
        else:
            roller.vlines(time, speeds.min(), speeds.max(), **(tint | {"linewidth": 4.0}))
        sheet.handles.append(Patch(label="range of all rollers", **tint))
    curve, label = _shown_roller(dataset)
    _line(sheet, roller, time, curve, label=label, color=MODEL_COLOURS[1], linewidth=0.8)


def _draw_orbit_means(sheet: Sheet, dataset: "xr.Dataset") -> None:
    """Draw the means over an orbit of the speeds of cage and rollers, where the motion is longer than an orbit."""
    time = dataset["time"].to_numpy()
    orbit = 2.0 * math.pi / max(float(np.abs(dataset["cage_speed"]).mean()), 1e-300)
    middle = time[(time >= time[0] + 0.5 * orbit) & (time <= time[-1] - 0.5 * orbit)]
    if middle.size < 2:
        return
    style: dict[str, Any] = {"color": "black", "linewidth": 1.1, "linestyle": DASHES[1]}
    cage = dataset["cage_speed"].to_numpy()
    drawn = False
    for axes, speed, shown in (
        (sheet.axes[0], cage, cage),
        (
            sheet.axes[1],
            dataset["roller_speed"].mean("roller").to_numpy(),
            _shown_roller(dataset)[0] / _RPM,
        ),
    ):
        turned = np.append(0.0, np.cumsum(0.5 * np.diff(time) * (speed[1:] + speed[:-1])))
        ends = [np.interp(middle + side * orbit, time, turned) for side in (-0.5, 0.5)]
        mean = (ends[1] - ends[0]) / orbit
        # a mean that coincides with the curve is not drawn again
        if np.abs(mean - np.interp(middle, time, shown)).max() > _COINCIDENT * np.ptp(shown):
            axes.plot(_scale(dataset) * middle, _RPM * mean, **style)
            drawn = True
    if drawn:
        sheet.key("mean over an orbit", **style)


def _together(datasets: "Mapping[str, xr.Dataset]") -> "Figure":
    """Draw the speeds of several motions, and their differences from the first."""
    sheet = Sheet(TWO_COLUMNS, 2, 2, height_ratios=(3, 1), sharex="col")
    panels = sheet.axes
    (first, reference), *_ = datasets.items()
    longest = max(datasets.values(), key=lambda dataset: float(dataset["time"][-1]))
    scale = _scale(longest)
    single = all(map(_resolved, datasets.values()))
    for k, (name, dataset) in enumerate(datasets.items()):
        # the reference is wide and light, so that what lies upon it is seen
        style: dict[str, Any] = {
            "color": MODEL_COLOURS[k % len(MODEL_COLOURS)] if k else MODEL_COLOURS[-1],
            "linestyle": DASHES[k % len(DASHES)],
            "linewidth": 1.1 if k else 2.4,
        }
        time = scale * dataset["time"].to_numpy()
        _line(
            sheet, panels[0, 0], time, _RPM * dataset["cage_speed"].to_numpy(), label=name, **style
        )
        curve, shown = _shown_roller(dataset, single)
        _line(sheet, panels[0, 1], time, curve, **style)
        if dataset is not reference:
            for axes, variable in zip(panels[1], ("cage_speed", "roller_speed"), strict=True):
                gap = 100 * relative_difference(reference, dataset, variable)
                _line(sheet, axes, scale * common_times(reference, dataset), gap, **style)
    panels[0, 0].set_ylabel("Cage speed [rpm]")
    panels[0, 1].set_ylabel(f"Speed of {shown} [rpm]")
    panels[1, 0].set_ylabel("Difference [%]")
    panels[1, 1].set_ylabel("Difference of\nthe mean [%]")
    for axes in panels[1]:
        axes.axhline(0.0, **_QUIET)
        _time_axis(axes, longest)
    return _done(
        sheet,
        height=TWO_COLUMNS[1] + 25 * MM,
        title=f"differences are from {first}, over its largest speed",
    )


def _orbit(dataset: "xr.Dataset") -> "Figure":
    """Draw maps of the contacts with the inner ring over orbit and time."""
    inner = dataset.sel(ring="inner")
    sliding, force, film = (
        inner[name].to_numpy() for name in ("sliding_speed", "normal_force", "film_parameter")
    )
    loaded = force > 0.0
    power = np.abs(inner["traction_force"].to_numpy() * sliding)
    status = f"film parameter: {dataset['film_parameter'].attrs['film_status']}"
    nothing = "no roller is loaded"
    rows = [
        (
            "Sliding speed [m/s]",
            _Cells.summarise(dataset, np.where(loaded, sliding, np.nan), np.mean),
            nothing,
        ),
        (
            "Normal force [N]",
            _Cells.summarise(dataset, np.where(loaded, force, np.nan), np.mean),
            nothing,
        ),
        (
            "Sliding power [W]",
            _Cells.summarise(dataset, np.where(loaded, power, np.nan), np.mean),
            nothing,
        ),
        (
            "Smallest Λ [–]",
            _Cells.summarise(dataset, film, np.min),
            status if loaded.any() else nothing,
        ),
    ]
    if "pocket_force" in dataset:
        pocket = np.abs(dataset["pocket_force"].to_numpy())
        cells = _Cells.summarise(dataset, np.where(pocket > 0.0, pocket, np.nan), np.max)
        rows.append(("Pocket force [N]", cells, "no roller touches the cage"))
    sheet = Sheet(
        (TWO_COLUMNS[0], (32 * len(rows) + 8) * MM),
        len(rows),
        1,
        sharex=True,
        squeeze=False,
    )
    panels = sheet.axes[:, 0]
    for axes, (label, cells, otherwise) in zip(panels, rows, strict=True):
        axes.set_xlim(cells.edges[0], cells.edges[-1])
        half = cells.half_width or 180.0
        axes.set_ylim(-half, half)
        axes.set_yticks(
            [tick for tick in range(-180, 181, 90 if half > 90.0 else 30) if abs(tick) <= half]
        )
        axes.set_ylabel("Orbit position [°]")
        if np.isfinite(cells.values).any():
            _draw_cells(
                sheet.figure, axes, cells, label, _MAX_FILM_RATIO if "Λ" in label else math.inf
            )
        else:
            axes.text(
                0.5,
                0.5,
                otherwise,
                transform=axes.transAxes,
                ha="center",
                va="center",
                color="0.25",
            )
            axes.set_title(label)
    _time_axis(panels[-1], dataset, limits=False)
    return sheet.done()


def _energy(dataset: "xr.Dataset") -> "Figure":
    """Draw the works of the energy ledger, and its residual."""
    sheet = Sheet(
        (TWO_COLUMNS[0], TWO_COLUMNS[1] + 20 * MM), 2, 1, sharex=True, height_ratios=(3, 1)
    )
    works, residuals = sheet.axes
    time = _time(dataset)
    energy = dataset["energy"].to_numpy()
    for k, (name, work) in enumerate(ledger(dataset).items()):
        # entries of the same colour have different dashes
        _line(
            sheet,
            works,
            time,
            work,
            label=name,
            color=MODEL_COLOURS[k % len(MODEL_COLOURS)],
            linestyle=DASHES[(k + k // len(MODEL_COLOURS)) % len(DASHES)],
        )
    _line(
        sheet,
        works,
        time,
        energy - energy[0],
        label="kept in the motion",
        color="black",
        linewidth=2.0,
    )
    works.axhline(0.0, **_QUIET)
    works.set_ylabel("Energy since the start [J]")
    size = turnover(dataset)
    residual = np.abs(dataset["energy_residual"].to_numpy()) / (size or 1.0)
    if np.any(residual > 0.0):
        _line(
            sheet,
            residuals,
            time,
            np.where(residual > 0.0, residual, np.nan),
            color="black",
            linewidth=0.8,
        )
        residuals.set_yscale("log")
    else:
        residuals.set_yticks(())
        residuals.text(
            0.5,
            0.5,
            "no residual",
            transform=residuals.transAxes,
            ha="center",
            va="center",
            color="0.25",
        )
    residuals.set_ylabel("Residual over\nturnover [–]" if size > 0.0 else "Residual [J]")
    _time_axis(residuals, dataset)
    return _done(sheet)


def _centres(dataset: "xr.Dataset") -> "Figure":
    """Draw the orbits of the centres of cage and inner ring, each to its own scale, from light to dark in time."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import BoundaryNorm

    sheet = Sheet(TWO_COLUMNS, 1, 2)
    panels = sheet.axes
    time = _time(dataset)
    colours = light_to_dark()
    pieces = np.array_split(np.arange(time.size), min(time.size, _TRACK_PIECES))
    edges = np.unique(np.append(time[[piece[0] for piece in pieces]], time[-1]))
    shades = colours(np.linspace(0.0, 1.0, len(pieces)))
    for axes, name, title in zip(panels, ("cage", "ring"), ("cage", "inner ring"), strict=True):
        along, across = (
            1e6 * dataset[f"{name}_displacement"].sel(direction=direction).to_numpy()
            for direction in ("along", "across")
        )
        for piece, shade in zip(pieces, shades, strict=True):
            part = np.arange(max(piece[0] - 1, 0), piece[-1] + 1)
            axes.plot(across[part], along[part], linewidth=0.8, color=shade)
        axes.plot(across[-1], along[-1], color=shades[-1], **{**MARKER, "markersize": 6})
        axes.set_aspect("equal", adjustable="datalim")
        axes.set_title(title)
        axes.set_xlabel("Across the load [µm]")
        axes.set_ylabel("Along the load [µm]")
    if edges.size > 1:
        bar = sheet.figure.colorbar(
            ScalarMappable(BoundaryNorm(edges, colours.N), colours), ax=panels, aspect=30, pad=0.01
        )
        bar.set_label(f"Time [{_time_unit(dataset)}]")
        bar.set_ticks(edges[:: -(-edges.size // 6)].tolist())
        bar.ax.yaxis.set_major_formatter("{x:.3g}")
        bar.minorticks_off()
        seamless(bar)
    return sheet.done()


# Maps over orbit and time -------------------------------------------------------------------------------------------


@attrs.frozen(eq=False)
class _Cells:
    """Map of a value over time and orbital position: edges of the cells in time, and values, NaN where unknown."""

    edges: Array
    values: Array

    @classmethod
    def summarise(cls, dataset: "xr.Dataset", values: Array, summary: Any) -> "_Cells":
        """Return the map of a summary, such as the mean, of the values (time, roller) in each cell, without NaN."""
        time = _time(dataset)
        groups = np.array_split(np.arange(time.size), min(time.size, _MAX_TIME_CELLS))
        starts, ends = (time[[group[k] for group in groups]] for k in (0, -1))
        edges = np.concatenate((time[:1], 0.5 * (ends[:-1] + starts[1:]), time[-1:]))
        if time.size == 1:
            edges = time[0] + np.array([-0.5, 0.5])
        count = int(np.clip(dataset.sizes["roller"], *_ORBIT_CELLS))
        # the middle of a cell is the line of load
        turns = dataset["orbit_angle"].to_numpy() * count / (2.0 * math.pi)
        cell = np.floor(turns + 0.5).astype(int) % count
        found = np.full((len(groups), count), np.nan)
        for i, group in enumerate(groups):
            known = np.isfinite(values[group])
            cells = cell[group][known]
            known_values = values[group][known]
            for j in np.unique(cells):
                found[i, j] = summary(known_values[cells == j])
        return cls(edges, found)

    @property
    def half_width(self) -> float:
        """Angle on both sides of the line of load within which all known values lie [°]; 0 without values."""
        count = self.values.shape[1]
        cells = np.flatnonzero(np.isfinite(self.values).any(axis=0))
        farthest = (np.minimum(cells, count - cells) + 0.5).max(initial=0.0)
        return float(min(180.0, 360.0 / count * farthest))

    def rectangles(self, chosen: NDArray[np.bool_]) -> Array:
        """Return corners of rectangles that cover the chosen cells, (rectangles, 5, 2), neighbours in time as one."""
        count = chosen.shape[1]
        corners = []
        for j in range(count):
            steps = np.diff(np.concatenate(([0], chosen[:, j].astype(int), [0])))
            low, high = (360.0 * (j + side) / count for side in (-0.5, 0.5))
            # angles beyond +180 degrees are drawn from -180 on; the axes cut the cell that contains 180 degrees
            shifts = [0.0] if low < 180.0 else []
            if high > 180.0:
                shifts.append(-360.0)
            for start, end in zip(
                np.flatnonzero(steps == 1), np.flatnonzero(steps == -1), strict=True
            ):
                left = self.edges[start]
                right = self.edges[end]
                for shift in shifts:
                    bottom = low + shift
                    top = high + shift
                    corners.append(
                        [(left, bottom), (right, bottom), (right, top), (left, top), (left, bottom)]
                    )
        return np.array(corners)


def _draw_cells(
    figure: "Figure", axes: "Axes", cells: _Cells, label: str, max_ratio: float
) -> None:
    """Fill the cells, those of one colour as one path, since figures without bitmaps are small.

    Values of more than ``max_ratio`` times the smallest have the colour of the largest.
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import BoundaryNorm
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline
    from matplotlib.ticker import MaxNLocator

    low = float(np.nanmin(cells.values))
    high = float(np.nanmax(cells.values))
    is_cut = high > max_ratio * low > 0.0
    if is_cut:
        high = max_ratio * low
    if high - low <= _ROUNDING * max(abs(low), abs(high)):
        low = low - 0.05 * (abs(low) or 1.0)
        high = high + 0.05 * (abs(high) or 1.0)
    levels = np.asarray(MaxNLocator(16).tick_values(low, high))
    colours = light_to_dark()
    scale = ScalarMappable(BoundaryNorm(levels, colours.N), colours)
    classes = np.where(np.isfinite(cells.values), np.digitize(cells.values, levels[1:-1]), -1)
    for k, colour in enumerate(scale.to_rgba(0.5 * (levels[:-1] + levels[1:]))):
        if np.any(classes == k):
            axes.add_patch(
                PathPatch(
                    Outline.make_compound_path_from_polys(cells.rectangles(classes == k)),
                    facecolor=colour,
                    edgecolor=colour,
                    linewidth=0.2,
                )
            )
    bar = figure.colorbar(
        scale, ax=axes, aspect=14, pad=0.015, extend="max" if is_cut else "neither"
    )
    bar.set_label(label)
    bar.locator = MaxNLocator(5)
    bar.minorticks_off()
    seamless(bar)


# Shared by the figures ------------------------------------------------------------------------------------------------


def _scale(dataset: "xr.Dataset") -> float:
    """Return the factor of times in seconds: short motions are shown in milliseconds."""
    return 1e3 if 0.0 < float(dataset["time"][-1]) < _MAX_MILLISECONDS else 1.0


def _time_unit(dataset: "xr.Dataset") -> str:
    """Return the unit in which times are shown."""
    return "ms" if _scale(dataset) > 1.0 else "s"


def _time(dataset: "xr.Dataset") -> Array:
    """Return the stored times in the unit in which they are shown."""
    return np.asarray(_scale(dataset) * dataset["time"].to_numpy())


def _time_axis(axes: "Axes", dataset: "xr.Dataset", *, limits: bool = True) -> None:
    """Label the axis of time and set its limits."""
    axes.set_xlabel(f"Time [{_time_unit(dataset)}]")
    time = _time(dataset)
    if time.size == 1:
        axes.set_xticks(time)
    elif limits:
        axes.set_xlim(time[0], time[-1])


def _line(sheet: Sheet, axes: "Axes", x: Array, y: Array, **style: Any) -> None:
    """Draw a curve, or its only point; the legend shows those with a label."""
    lines = axes.plot(x, y, **(MARKER if x.size == 1 else {}), **style)
    sheet.handles += lines if "label" in style else []


def _passage(rising: bool) -> dict[str, Any]:
    """Return the style of the marker of a passage of the skidding slip, filled while slip rises."""
    return {
        "marker": "o",
        "markersize": 5,
        "color": MODEL_COLOURS[1] if rising else "white",
        "markeredgecolor": MODEL_COLOURS[1],
        "zorder": 4,
    }


def _other_events(dataset: "xr.Dataset") -> list[float]:
    """Return times of events that are not passages of the skidding slip; times that coincide on paper count once."""
    passages = [time for time, _ in skidding_passages(dataset)]
    times = np.setdiff1d(dataset["event_time"].to_numpy(), passages)
    distance = max(float(dataset["time"][-1]), 1e-300) / _MAX_EVENT_MARKS
    return list(map(float, _scale(dataset) * distance * np.unique(np.round(times / distance))))


def _resolved(dataset: "xr.Dataset") -> bool:
    """Return whether the motion of a roller within an orbit is stored, and can be seen."""
    time = dataset["time"].to_numpy()
    orbits = float(np.trapezoid(np.abs(dataset["cage_speed"].to_numpy()), time)) / (2.0 * math.pi)
    return bool(time.size > _MIN_TIMES_PER_ORBIT * orbits and orbits < _MAX_ORBITS)


def _shown_roller(dataset: "xr.Dataset", single: bool | None = None) -> tuple[Array, str]:
    """Return a spin [rpm] and its name: that of the first roller, or the mean where a single one cannot be seen."""
    speeds = _RPM * dataset["roller_speed"].to_numpy()
    if _resolved(dataset) if single is None else single:
        return speeds[:, 0], f"roller {dataset['roller'].to_numpy()[0]}"
    return speeds.mean(axis=1), "the mean of all rollers"


def _done(sheet: Sheet, **options: Any) -> "Figure":
    """Return the figure, with a legend of rows of similar length, five entries at most."""
    count = len(sheet.handles)
    return sheet.done(columns=-(-count // -(-count // 5)), **options)
