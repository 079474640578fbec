"""Figures of motions in time: speeds, maps over orbit and time, the energy ledger, the tracks of the centres.

Style, sizes and files are those of `rollslip.results.style`. Everything reads in grey: motions that are compared differ
in dashes, maps in lightness.
"""

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.results.style import (
    DASHES,
    MARKER,
    MM,
    MODEL_COLOURS,
    TWO_COLUMNS,
    Sheet,
    light_to_dark,
    save_figures,
    seamless,
)
from rollslip.search import Array
from rollslip_studies.dynamics import history_findings
from rollslip_studies.dynamics.findings import (
    common_times,
    describe_differences,
    ledger,
    relative_difference,
    skidding_passages,
    skidding_slip,
    turnover,
    unslipped_cage_speed,
    unslipped_roller_speed,
)
from rollslip_studies.dynamics.history.figures import phase, slip_along
from rollslip_studies.surface_damage.figures import over_time
from rollslip_studies.thermal_balance.figures import course

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["motion_figures", "plot_together"]

#: Speeds are shown to people in revolutions per minute.
_RPM = 30.0 / math.pi
#: With fewer stored instants an orbit, the curve of a single roller would not be what it did; with more orbits, it
#: would run together on paper.
_INSTANTS = 6.0
_ORBITS = 40.0
#: Cells of a map along time at most; along the orbit it has one for each roller, within limits.
_TIMES = 60
_POSITIONS = (12, 48)
#: Pieces of one shade of a track that darkens in time.
_PIECES: Final = 30
#: Share of the largest slip from which on a slip of running away beyond it is worth the room on the axis.
_NEAR = 0.5
#: Film parameter over the smallest from which on thicker films look the same: without load it grows beyond all bounds.
_THICK = 3.0
_QUIET: Final[Mapping[str, Any]] = {"color": "0.45", "linewidth": 0.8, "zorder": 1}


def motion_figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Draw the figures of a motion; give name, caption and figure of each.

    The names hold the friction, so that motions of one run do not overwrite each other's figures.
    """
    name = f"dynamics-{dataset.attrs['friction']}"
    which = f"level {dataset.attrs['level']}, {dataset.attrs['friction']} friction"
    yield name, f"Speed of cage and rollers against time, {which}.", _speeds(dataset)
    caption = (
        f"Contacts with the inner ring over orbit and time, {which}; 0 is the line of load, and blank is where no "
        "roller was loaded or the value is not known; pocket forces are the largest."
    )
    yield f"{name}-orbit", caption, _orbit(dataset)
    if "measure" in dataset.dims and np.isfinite(dataset["worst"]).any():
        caption = f"Worst value of each measure of damage over the contacts at a moment, {which}; dashed are limits."
        yield f"{name}-damage", caption, over_time(dataset)
    if history_findings.has_heating(dataset):
        caption = f"Bulk temperatures that the losses of the motion lead to, {which}."
        yield f"{name}-temperatures", caption, course(dataset)
    if history_findings.has_history(dataset):
        caption = (
            f"Cage slip along the history, {which}, with the slip at which skidding begins and that at largest "
            "traction of the bearing held at the operation of each moment; a curve is missing where it is not known."
        )
        yield f"{name}-history", caption, slip_along(dataset)
        caption = (
            f"Cage slip against that at which skidding begins at that moment, {which}: beyond the diagonal the cage "
            "skids. Numbers are times in seconds; a moment at which either is not known is left out."
        )
        yield f"{name}-phase", caption, phase(dataset)
    yield f"{name}-energy", f"Energy ledger since the start, {which}.", _energy(dataset)
    if "ring_displacement" in dataset:
        caption = f"Tracks of the centres of inner ring and cage, {which}; colours tell the time, a circle is the end."
        yield f"{name}-centres", caption, _centres(dataset)


def plot_together(datasets: "Mapping[str, xr.Dataset]", folder: Path) -> list[Path]:
    """Draw motions of one bearing together: speed of cage and roller against time, and their differences.

    Parameters
    ----------
    datasets : mapping of str to xarray.Dataset
        Two results of dynamics or more, by what the legend shall call them; the others are held against the first.
    folder : Path
        Where the file goes; it is made if it does not exist.

    Returns
    -------
    list of Path
        The one file, "dynamics-together.svg".
    """

    def drawn() -> "Iterator[tuple[str, str, Figure]]":
        caption = f"Speed of cage and roller against time: {', '.join(datasets)}."
        yield "dynamics-together", caption, _together(datasets)

    return save_figures(
        drawn(),
        " ".join(f"{text[:1].upper()}{text[1:]}." for text in describe_differences(datasets)),
        folder,
    )


# Figures ------------------------------------------------------------------------------------------------------------


def _speeds(dataset: "xr.Dataset") -> "Figure":
    from matplotlib.patches import Patch

    sheet = _sheet(1)
    cage, roller = sheet.axes
    time = _time(dataset)
    speed = _RPM * dataset["cage_speed"].to_numpy()
    _line(sheet, cage, time, speed, label="cage", color=MODEL_COLOURS[0])
    history = history_findings.has_history(dataset)
    unslipped = math.nan if history else _RPM * unslipped_cage_speed(dataset)
    if history:
        without = _RPM * dataset["epicyclic_cage_speed"].to_numpy()
        _line(sheet, cage, time, without, label="without slip", linestyle="dotted", **_QUIET)
    largest = float(dataset["cage_slip"].max())
    away = skidding_slip(dataset)
    if not math.isnan(unslipped):
        for axes, level in ((cage, unslipped), (roller, _RPM * unslipped_roller_speed(dataset))):
            if not math.isnan(level):
                axes.axhline(level, linestyle="dotted", **_QUIET)
        sheet.key("without slip", linestyle="dotted", **_QUIET)
        _slip_axis(cage, unslipped)
        if largest > _NEAR * away:
            cage.axhline((1.0 - away) * unslipped, linestyle=DASHES[1], **_QUIET)
            sheet.key(f"skidding begins, {100 * away:.3g} %", linestyle=DASHES[1], **_QUIET)
    passages = skidding_passages(dataset)
    for moment, rising in passages:
        cage.plot(
            _scale(dataset) * moment,
            np.interp(_scale(dataset) * moment, time, speed),
            **_passage(rising),
        )
    for rising, words in ((True, "rising"), (False, "falling")):
        if any(one is rising for _, one in passages):
            sheet.key(f"passed while {words}", linestyle="none", **_passage(rising))
    if others := _other_events(dataset):
        cage.vlines(
            others, 0.0, 0.03, transform=cage.get_xaxis_transform(), color="0.3", linewidth=0.6
        )
        sheet.key("events (at the foot)", linestyle="none", marker="|", color="0.3", markersize=5)

    speeds = _RPM * dataset["roller_speed"].to_numpy()
    if dataset.sizes["roller"] > 1:
        tint: dict[str, Any] = {"color": MODEL_COLOURS[1], "alpha": 0.25, "linewidth": 0.0}
        if time.size > 1:
            roller.fill_between(time, speeds.min(axis=1), speeds.max(axis=1), **tint)
        else:
            roller.vlines(
                time, speeds.min(), speeds.max(), color=MODEL_COLOURS[1], alpha=0.25, linewidth=4.0
            )
        sheet.handles.append(Patch(label="range of all rollers", **tint))
    curve, label = _shown_roller(dataset)
    _line(sheet, roller, time, curve, label=label, color=MODEL_COLOURS[1], linewidth=0.8)

    cage.set_ylabel("Cage speed [rpm]")
    roller.set_ylabel("Roller speed, relative to the cage [rpm]")
    for axes in (cage, roller):
        _time_axis(axes, dataset)
    return _done(sheet)


def _together(datasets: "Mapping[str, xr.Dataset]") -> "Figure":
    sheet = _sheet(2, height_ratios=(3, 1), sharex="col")
    panels = sheet.axes
    (first, reference), *_ = datasets.items()
    longest = max(datasets.values(), key=lambda one: float(one["time"][-1]))
    scale = _scale(longest)
    single = all(_resolved(dataset) for dataset in datasets.values())
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
    title = f"differences are from {first}, over its largest speed"
    return _done(sheet, height=TWO_COLUMNS[1] + 25 * MM, title=title)


def _orbit(dataset: "xr.Dataset") -> "Figure":
    inner = dataset.sel(ring="inner")
    sliding, force, film = (
        inner[name].to_numpy() for name in ("sliding_speed", "normal_force", "film_parameter")
    )
    loaded = force > 0.0
    power = inner["traction_force"].to_numpy() * sliding
    status = f"film parameter: {dataset['film_parameter'].attrs['film_status']}"
    nothing = "no roller is loaded"
    rows = [
        (
            "Sliding speed [m/s]",
            _Cells.of(dataset, np.where(loaded, sliding, np.nan), np.mean),
            nothing,
        ),
        ("Normal force [N]", _Cells.of(dataset, np.where(loaded, force, np.nan), np.mean), nothing),
        (
            "Sliding power [W]",
            _Cells.of(dataset, np.where(loaded, np.abs(power), np.nan), np.mean),
            nothing,
        ),
        ("Smallest Λ [–]", _Cells.of(dataset, film, np.min), status if loaded.any() else nothing),
    ]
    if "pocket_force" in dataset:
        pocket = np.abs(dataset["pocket_force"].to_numpy())
        cells = _Cells.of(dataset, np.where(pocket > 0.0, pocket, np.nan), np.max)
        rows.append(("Pocket force [N]", cells, "no roller touches the cage"))
    size = (TWO_COLUMNS[0], (32 * len(rows) + 8) * MM)
    sheet = Sheet(size, len(rows), 1, sharex=True, sharey=True, squeeze=False)
    panels = sheet.axes[:, 0]
    for axes, (label, cells, otherwise) in zip(panels, rows, strict=True):
        axes.set_xlim(cells.edges[0], cells.edges[-1])
        axes.set_ylim(-180.0, 180.0)
        axes.set_yticks((-180, -90, 0, 90, 180))
        axes.set_ylabel("Orbit position [°]")
        if np.isfinite(cells.values).any():
            _draw_cells(sheet.figure, axes, cells, label, _THICK if "Λ" in label else math.inf)
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
    sheet = Sheet(
        (TWO_COLUMNS[0], TWO_COLUMNS[1] + 20 * MM), 2, 1, sharex=True, height_ratios=(3, 1)
    )
    works, residuals = sheet.axes
    time = _time(dataset)
    energy = dataset["energy"].to_numpy()
    for k, (name, work) in enumerate(ledger(dataset).items()):
        # an entry that went round the colours comes with other dashes
        dashes = DASHES[(k + k // len(MODEL_COLOURS)) % len(DASHES)]
        _line(
            sheet,
            works,
            time,
            work,
            label=name,
            color=MODEL_COLOURS[k % len(MODEL_COLOURS)],
            linestyle=dashes,
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

    sheet = _sheet(1)
    panels = sheet.axes
    time = _time(dataset)
    colours = light_to_dark()
    pieces = np.array_split(np.arange(time.size), min(time.size, _PIECES))
    edges = np.unique(np.append(time[[piece[0] for piece in pieces]], time[-1]))
    shades = colours(np.linspace(0.0, 1.0, len(pieces)))
    for axes, name, title in zip(panels, ("cage", "ring"), ("cage", "inner ring"), strict=True):
        along, across = (
            1e6 * dataset[f"{name}_displacement"].sel(direction=way).to_numpy()
            for way in ("along", "across")
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
        shade_of = ScalarMappable(BoundaryNorm(edges, colours.N), colours)
        bar = sheet.figure.colorbar(shade_of, ax=panels, aspect=30, pad=0.01)
        bar.set_label(f"Time [{_time_unit(dataset)}]")
        bar.set_ticks(edges[:: -(-edges.size // 6)].tolist())
        bar.ax.yaxis.set_major_formatter("{x:.3g}")
        bar.minorticks_off()
        seamless(bar)
    return sheet.done()


# Maps over orbit and time -------------------------------------------------------------------------------------------


@attrs.frozen(eq=False)
class _Cells:
    """A value over time and orbital position: edges of the cells in time, and values, NaN where there are none."""

    edges: Array
    values: Array

    @classmethod
    def of(cls, dataset: "xr.Dataset", values: Array, summary: Any) -> "_Cells":
        """Sum up values (time, roller) in cells of a few instants and a few degrees; NaN does not count."""
        time = _time(dataset)
        groups = np.array_split(np.arange(time.size), min(time.size, _TIMES))
        begins, ends = (time[[group[k] for group in groups]] for k in (0, -1))
        edges = np.concatenate((time[:1], 0.5 * (ends[:-1] + begins[1:]), time[-1:]))
        if time.size == 1:
            edges = time[0] + np.array([-0.5, 0.5])
        count = int(np.clip(dataset.sizes["roller"], *_POSITIONS))
        # the middle of a cell is the line of load
        place = (
            np.floor(dataset["orbit_angle"].to_numpy() * count / (2.0 * math.pi) + 0.5).astype(int)
            % count
        )
        found = np.full((len(groups), count), np.nan)
        for i, group in enumerate(groups):
            here = place[group].ravel()
            what = values[group].ravel()
            for j in np.unique(here[np.isfinite(what)]):
                found[i, j] = summary(what[(here == j) & np.isfinite(what)])
        return cls(edges, found)

    def rectangles(self, chosen: NDArray[np.bool_]) -> Array:
        """Corners of rectangles that cover the chosen cells, shape (rectangles, 5, 2), neighbours in time as one."""
        count = chosen.shape[1]
        corners = []
        for j in range(count):
            steps = np.diff(np.concatenate(([0], chosen[:, j].astype(int), [0])))
            low, high = (360.0 * (j + side) / count for side in (-0.5, 0.5))
            # what lies beyond +180 degrees is drawn from -180 on; the axes cut the cell that has both
            turns = [0.0, -360.0] if low < 180.0 < high else [-360.0] if low >= 180.0 else [0.0]
            for begin, end in zip(
                np.flatnonzero(steps == 1), np.flatnonzero(steps == -1), strict=True
            ):
                a = self.edges[begin]
                b = self.edges[end]
                corners += [
                    [(a, low + t), (b, low + t), (b, high + t), (a, high + t), (a, low + t)]
                    for t in turns
                ]
        return np.array(corners)


def _draw_cells(figure: "Figure", axes: "Axes", cells: _Cells, label: str, most: float) -> None:
    """Fill the cells, those of a colour as one path: a figure without bitmaps stays small.

    Values of more than `most` times the smallest have the colour of the largest.
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import BoundaryNorm
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline
    from matplotlib.ticker import MaxNLocator

    low = float(np.nanmin(cells.values))
    high = float(np.nanmax(cells.values))
    beyond = high > most * low > 0.0
    high = most * low if beyond else high
    if high - low <= 1e-9 * max(abs(low), abs(high)):  # the same everywhere, but for rounding
        low = low - 0.05 * (abs(low) or 1.0)
        high = high + 0.05 * (abs(high) or 1.0)
    levels = np.asarray(MaxNLocator(16).tick_values(low, high))
    colours = light_to_dark()
    scale = ScalarMappable(BoundaryNorm(levels, colours.N), colours)
    classes = np.where(np.isfinite(cells.values), np.digitize(cells.values, levels[1:-1]), -1)
    for k, colour in enumerate(scale.to_rgba(0.5 * (levels[:-1] + levels[1:]))):
        if np.any(classes == k):
            outline = Outline.make_compound_path_from_polys(cells.rectangles(classes == k))
            axes.add_patch(PathPatch(outline, facecolor=colour, edgecolor=colour, linewidth=0.2))
    bar = figure.colorbar(
        scale, ax=axes, aspect=14, pad=0.015, extend="max" if beyond else "neither"
    )
    bar.set_label(label)
    bar.locator = MaxNLocator(5)
    bar.minorticks_off()
    seamless(bar)


# What they share ----------------------------------------------------------------------------------------------------


def _sheet(rows: int, **options: Any) -> Sheet:
    sheet = Sheet(TWO_COLUMNS, rows, 2, **options)
    sheet.figure.get_layout_engine().set(wspace=0.04)  # type: ignore  # the slip axis has labels there
    return sheet


def _scale(dataset: "xr.Dataset") -> float:
    """What seconds are multiplied with: short motions are shown in milliseconds."""
    return 1e3 if 0.0 < float(dataset["time"][-1]) < 0.05 else 1.0


def _time_unit(dataset: "xr.Dataset") -> str:
    return "ms" if _scale(dataset) > 1.0 else "s"


def _time(dataset: "xr.Dataset") -> Array:
    return np.asarray(_scale(dataset) * dataset["time"].to_numpy())


def _time_axis(axes: "Axes", dataset: "xr.Dataset", *, limits: bool = True) -> None:
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
    """Marker of a passage of the slip of running away, full while slip rises."""
    face = MODEL_COLOURS[1] if rising else "white"
    return {
        "marker": "o",
        "markersize": 5,
        "color": face,
        "markeredgecolor": MODEL_COLOURS[1],
        "zorder": 4,
    }


def _other_events(dataset: "xr.Dataset") -> list[float]:
    """Times of the events besides passing the slip of running away, those that would coincide on paper only once."""
    away = [moment for moment, _ in skidding_passages(dataset)]
    times = np.setdiff1d(dataset["event_time"].to_numpy(), away)
    apart = max(float(dataset["time"][-1]), 1e-300) / 300.0
    return [
        float(moment) for moment in _scale(dataset) * apart * np.unique(np.round(times / apart))
    ]


def _resolved(dataset: "xr.Dataset") -> bool:
    """Whether what a roller does within an orbit is stored, and can be seen."""
    time = dataset["time"].to_numpy()
    speed = np.abs(dataset["cage_speed"].to_numpy())
    orbits = float(np.trapezoid(speed, time)) / (2.0 * math.pi)
    return bool(time.size > _INSTANTS * orbits and orbits < _ORBITS)


def _shown_roller(dataset: "xr.Dataset", single: bool | None = None) -> tuple[Array, str]:
    """Spin of a roller in rpm and whose it is: the first roller's, or the mean where it would not be seen."""
    speeds = _RPM * dataset["roller_speed"].to_numpy()
    if _resolved(dataset) if single is None else single:
        return speeds[:, 0], f"roller {dataset['roller'].to_numpy()[0]}"
    return speeds.mean(axis=1), "the mean of all rollers"


def _slip_axis(axes: "Axes", unslipped: float) -> None:
    """Show the cage slip that belongs to a cage speed at the right."""

    def slip(speed: Any) -> Array:
        return np.asarray(100.0 * (1.0 - np.asarray(speed) / unslipped))

    def speed(slip: Any) -> Array:
        return np.asarray((1.0 - np.asarray(slip) / 100.0) * unslipped)

    right = axes.secondary_yaxis("right", functions=(slip, speed))
    right.set_ylabel(r"Cage slip $S_\mathrm{c}$ [%]")


def _done(sheet: Sheet, **options: Any) -> "Figure":
    count = len(sheet.handles)
    return sheet.done(
        columns=-(-count // -(-count // 5)), **options
    )  # five at most, and rows of like length
