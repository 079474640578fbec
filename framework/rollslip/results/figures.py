"""Figures of the studies for publication: friction of a contact, effective friction, single rollers, the map.

- Style, sizes and files are those of `rollslip.results.style`; the figures of motion in time are in
  `rollslip.studies.dynamics.figures` and `rollslip.studies.steady_slip.figures`, those of error against cost in
  `rollslip.campaigns.pareto.figures`.
- Everything reads in grey: curves differ in lightness, and dashed is only ever the thermal branch, but where models are
  compared: there dashes tell them apart.
- What is said in words stands above the curves, in room that is kept free for it, never on them.
"""

import json
import math
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.bearing.regimes import LONG_NAMES, NAMES
from rollslip.campaigns.comparison.findings import CURVES, curve_names, findings, members
from rollslip.campaigns.fit.findings import parameter_rows
from rollslip.campaigns.pareto import findings as front_findings
from rollslip.campaigns.pareto.figures import front_figures
from rollslip.campaigns.sweep import findings as sweep_findings
from rollslip.campaigns.sweep.figures import sweep_figures
from rollslip.campaigns.uncertainty import findings as uncertainty_findings
from rollslip.campaigns.uncertainty.figures import uncertainty_figures
from rollslip.results.style import (
    DASHES,
    MARKER,
    MM,
    MODEL_COLOURS,
    ONE_COLUMN,
    RING_COLOURS,
    ROW,
    SEQUENTIAL,
    TWO_COLUMNS,
    axis_label,
    light_to_dark,
    plain_ticks,
    save_figures,
)
from rollslip.studies.dynamics import findings as motion_findings
from rollslip.studies.dynamics.figures import motion_figures
from rollslip.studies.steady_slip import findings as steady_findings
from rollslip.studies.steady_slip.figures import steady_figures
from rollslip.units import format_quantity, quantity

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.text import Annotation, Text

__all__ = ["Curve", "curves", "percent", "plot"]

Array = NDArray[np.float64]

#: Background where the thinnest film is no longer full.
FILM_TINTS: Final = {"mixed": "0.93", "boundary": "0.84"}

_OPEN: Final[Mapping[str, Any]] = {"marker": "o", "markersize": 3, "markerfacecolor": "white", "markeredgewidth": 0.8}
#: Where a label may stand, the best first: offset in points from what it belongs to, alignment.
_PLACES: Final = tuple(
    (x, y, aligned)
    for y in (5, -5, 13, -13)
    for x, aligned in ((0, "center"), (4, "left"), (-4, "right"), (13, "left"), (-13, "right"))
)
#: Relative difference beyond which small ones would not be seen on a linear axis.
_SPREAD = 0.1


@attrs.frozen(eq=False, kw_only=True)
class Curve:
    """One friction curve of a dataset, with what was found of its critical slip.

    Attributes
    ----------
    name : str
        "300 N" or "inner ring".
    of, against : str
        What is plotted against what: "friction coefficient", "slide-roll ratio".
    slip, friction, film_parameter : ndarray
        Shape (n,).
    critical_slip, critical_friction : float
        NaN if there is none; `status` says why.
    regime : str
        Film regime in words, empty if it is not a matter of one contact.
    """

    name: str
    of: str
    against: str
    slip: Array
    friction: Array
    film_parameter: Array
    critical_slip: float
    critical_friction: float
    status: str
    regime: str = ""

    @property
    def has_critical(self) -> bool:
        """Whether the largest friction lies inside the range."""
        return not np.isnan(self.critical_slip)

    def branches(self) -> tuple[Array, Array, int, int]:
        """Return the curve through its maximum, and where in it the thermal branch begins and ends.

        The branch ends where friction is least again: with a thin film it may rise once more.
        """
        if not self.has_critical:
            last = self.slip.size - 1
            return self.slip, self.friction, last, last
        begin = int(np.searchsorted(self.slip, self.critical_slip))
        after = int(np.searchsorted(self.slip, self.critical_slip, side="right"))
        x = np.concatenate((self.slip[:begin], [self.critical_slip], self.slip[after:]))
        y = np.concatenate((self.friction[:begin], [self.critical_friction], self.friction[after:]))
        return x, y, begin, begin + int(np.nanargmin(y[begin:]))

    def finding(self) -> str:
        """Say in a sentence what was found of the critical slip."""
        quantity = "slip" if self.against != "cage slip" else self.against
        if self.has_critical:
            return (
                f"{self.name}: critical {quantity} {percent(self.critical_slip)}, where the {self.of} is largest, "
                f"{_digits(self.critical_friction, 3)}."
            )
        finite = np.flatnonzero(np.isfinite(self.friction))
        sentence = f"{self.name}: {self.status}."
        if finite.size and np.any(self.friction > 0.0):
            best = finite[np.argmax(self.friction[finite])]
            sentence += f" In this range the {self.of} reaches {_digits(self.friction[best], 3)}."
        return sentence


def percent(share: float) -> str:
    """Show a share in percent, with three digits."""
    return f"{_digits(100 * share, 3)} %"


def _digits(value: float, count: int) -> str:
    return f"{value:#.{count}g}".removesuffix(".")


def curves(dataset: "xr.Dataset") -> list[Curve]:
    """Return the friction curves of a dataset, none if its study has no such curves.

    Parameters
    ----------
    dataset : xarray.Dataset
        Result of friction-curve or effective-friction.
    """
    study = dataset.attrs.get("study")
    if study == "comparison":
        named = ((label, curve) for label, one in members(dataset) for curve in curves(one))
        return [attrs.evolve(curve, name=f"{label}, {curve.name}") for label, curve in named]
    if study == "friction-curve":
        dimension, variable, critical, against = "normal_force", "friction", "critical_slip", "slip"
    elif study == "effective-friction":
        dimension, variable, critical, against = "ring", "effective_friction", "critical_cage_slip", "cage_slip"
    else:
        return []
    found = []
    for position, key in enumerate(dataset[dimension].values):
        one = dataset.isel({dimension: position})
        found.append(
            Curve(
                name=f"{key} ring" if dimension == "ring" else format_quantity(float(key), "N"),
                of=dataset[variable].attrs["long_name"],
                against="cage slip" if dimension == "ring" else "slide-roll ratio",
                slip=one[against].to_numpy(),
                friction=one[variable].to_numpy(),
                film_parameter=one["film_parameter"].to_numpy(),
                critical_slip=float(one[critical]),
                critical_friction=float(one["critical_friction"]),
                status=str(one["critical_status"].item()),
                regime=_regime(one["regime"].to_numpy()) if dimension == "normal_force" else "",
            )
        )
    return found


def _regime(codes: NDArray[Any]) -> str:
    names = [NAMES[code] for code in np.unique(codes).astype(int)]
    return LONG_NAMES[names[0]] if len(names) == 1 else ", ".join(names)


def plot(dataset: "xr.Dataset", folder: Path) -> list[Path]:
    """Draw the figures of a dataset as SVG files.

    Parameters
    ----------
    dataset : xarray.Dataset
        Result of a study.
    folder : Path
        Where the files go; it is made if it does not exist.

    Returns
    -------
    list of Path
        The files, named after the study: the curves and, if the dataset has them, the single rollers ("-rollers") and
        the map ("-map"). Empty for a study without figures.
    """
    return save_figures(_figures(dataset), _findings(dataset), folder)


def _figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Name, caption and figure of all that the dataset has something to show for."""
    study, attributes = dataset.attrs.get("study"), dataset.attrs
    if study == "friction-curve":
        at = format_quantity(attributes["rolling_speed"], "m/s", 3)
        caption = f"Friction of one contact with the {attributes['ring']} ring, entrainment speed {at}."
        yield study, caption, _friction_curve(dataset)
    elif study == "effective-friction":
        closure = f"closure {attributes['closure']}"
        caption = f"Effective friction of both raceways against cage slip, {closure}."
        yield study, caption, _effective_friction(dataset)
        if "roller_friction" in dataset:
            caption = f"Friction of single rollers and effective friction on the inner ring, {closure}."
            yield f"{study}-rollers", caption, _rollers(dataset)
        if "friction_map" in dataset:
            caption = f"Effective friction over cage slip and roller slip; the line is the {closure}."
            yield f"{study}-map", caption, _map(dataset)
    elif study == "comparison":
        names = curve_names(dataset)
        for position, name in enumerate(names):
            caption = f"{name}: combinations of models against {attributes['reference']}."
            yield (
                study if len(names) == 1 else f"{study}-{name.replace(' ', '-')}",
                caption,
                _comparison(dataset, position),
            )
    elif study == "dynamics":
        yield from motion_figures(dataset)
    elif study == "steady-slip":
        yield from steady_figures(dataset)
    elif study == "pareto":
        yield from front_figures(dataset)
    elif study == "sweep":
        yield from sweep_figures(dataset)
    elif study == "uncertainty":
        yield from uncertainty_figures(dataset)
    elif study == "fit":
        name = Path(attributes["source"]).name
        held = _held(dataset)[0]
        yield study, f"Friction measured ({name}) and fitted{held and ', ' + held}.", _fit(dataset)
        yield (
            f"{study}-residuals",
            "Residuals over their standard deviation; the band is two of it.",
            _residuals(dataset),
        )
        if dataset.sizes["fitted_parameter"]:
            caption = "Rise of chi2 over the variance with one parameter held, the others fitted anew."
            yield f"{study}-profiles", caption, _profiles(dataset)


def _findings(dataset: "xr.Dataset") -> str:
    """Say in sentences what a dataset has found."""
    if dataset.attrs.get("study") == "comparison":
        return ". ".join(findings(dataset)) + "."
    if dataset.attrs.get("study") == "dynamics":
        return motion_findings.paragraph(dataset)
    if dataset.attrs.get("study") == "steady-slip":
        return steady_findings.paragraph(dataset)
    if dataset.attrs.get("study") == "pareto":
        return front_findings.paragraph(dataset)
    if dataset.attrs.get("study") == "sweep":
        return ". ".join(sweep_findings.sentences(dataset)) + "."
    if dataset.attrs.get("study") == "uncertainty":
        return uncertainty_findings.paragraph(dataset)
    if dataset.attrs.get("study") == "fit":
        rows = parameter_rows(dataset)
        return " ".join(f"{name}: {value}, 95 %: {limits}; {status}." for name, value, _, _, limits, status in rows)
    return " ".join(curve.finding() for curve in curves(dataset))


# Figures ------------------------------------------------------------------------------------------------------------


def _friction_curve(dataset: "xr.Dataset") -> "Figure":
    figure, axes = _new()
    shown, limits = curves(dataset.sortby("normal_force")), _film_limits(dataset)
    tints = _shade_film(axes, shown, limits)
    lines: list[Artist] = [
        _draw(axes, curve, colour, f"{curve.name}: {_film(curve, limits)}, {curve.regime}")
        for curve, colour in zip(shown, light_to_dark()(np.linspace(1.0, 0.0, len(shown))[::-1]), strict=True)
    ]
    axes.set_xlabel(axis_label(dataset["slip"], r"$V/u$", "%", name="slide–roll ratio"))
    axes.set_ylabel(axis_label(dataset["friction"], r"$\mu$", "–"))
    _finish(figure, axes, shown, lines + tints)
    return figure


def _effective_friction(dataset: "xr.Dataset") -> "Figure":
    figure, axes = _new()
    shown, limits = curves(dataset), _film_limits(dataset)
    tints = _shade_film(axes, shown, limits)
    lines: list[Artist] = [
        _draw(axes, curve, RING_COLOURS[ring], f"{curve.name}: smallest {_film(curve, limits)}", tinted=True)
        for ring, curve in zip(dataset["ring"].values, shown, strict=True)
    ]
    axes.set_xlabel(axis_label(dataset["cage_slip"], r"$S_\mathrm{c}$", "%"))
    axes.set_ylabel(axis_label(dataset["effective_friction"], r"$\mu_\mathrm{e}$", "–"))
    _finish(figure, axes, shown, lines + tints)
    return figure


def _rollers(dataset: "xr.Dataset") -> "Figure":
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.lines import Line2D

    figure, axes = _new()
    inner = dataset.sel(ring="inner")
    forces, friction = inner["normal_force"].to_numpy(), inner["roller_friction"].to_numpy()
    loaded = np.flatnonzero(forces > 0.0)
    scale = ScalarMappable(Normalize(0.0, forces.max()), light_to_dark())
    slip = 100 * inner["cage_slip"].to_numpy()
    for roller in loaded[np.argsort(forces[loaded], kind="stable")]:
        axes.plot(slip, friction[roller], color=scale.to_rgba(forces[roller]), linewidth=0.8)
    effective = [curve for curve in curves(dataset) if curve.name == "inner ring"]
    lines: list[Artist] = [
        _draw(axes, curve, "black", r"inner ring, effective: $\mu_\mathrm{e}$", width=2.0) for curve in effective
    ]
    lines.append(Line2D([], [], color=light_to_dark()(1.0), linewidth=0.8, label="its single rollers"))
    bar = figure.colorbar(scale, ax=axes, aspect=30, pad=0.03)
    bar.set_label(axis_label(dataset["normal_force"], "$Q$", "N", name="normal force"))
    bar.outline.set_visible(False)
    bar.solids.set_edgecolor("face")  # type: ignore[union-attr]  # no seams, as in the map
    axes.set_xlabel(axis_label(dataset["cage_slip"], r"$S_\mathrm{c}$", "%"))
    axes.set_ylabel(axis_label(dataset["roller_friction"], r"$\mu$", "–", name="friction coefficient"))
    _finish(figure, axes, effective, lines, others=friction[loaded])
    return figure


def _map(dataset: "xr.Dataset") -> "Figure":
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patheffects import withStroke
    from matplotlib.ticker import MaxNLocator

    figure = Figure(figsize=TWO_COLUMNS, layout="constrained")
    surface = np.ma.masked_invalid(dataset["friction_map"].to_numpy())
    cage, roller = 100 * dataset["map_cage_slip"].to_numpy(), 100 * dataset["map_roller_slip"].to_numpy()
    levels = MaxNLocator(20).tick_values(surface.min(), surface.max())
    rolling = np.isclose(levels, 0.0, atol=1e-6 * np.ptp(levels))
    outlined: dict[str, Any] = {"color": "white", "path_effects": [withStroke(linewidth=2.8, foreground="black")]}
    panels = figure.subplots(1, dataset.sizes["ring"], sharey=True, squeeze=False)[0]
    plain_ticks(*panels)
    for axes, curve, ring, values in zip(panels, curves(dataset), dataset["ring"].values, surface, strict=True):
        filled = axes.contourf(cage, roller, values.T, levels, cmap=SEQUENTIAL)
        filled.set_edgecolor("face")  # some viewers show seams between the areas without it
        axes.contour(cage, roller, values.T, levels, colors="black", linewidths=0.25 + rolling, linestyles="solid")
        line = 100 * dataset["roller_slip"].sel(ring=ring).to_numpy()
        axes.plot(100 * curve.slip, line, **outlined)
        if curve.has_critical:
            place = 100 * curve.critical_slip, float(np.interp(curve.critical_slip, curve.slip, line))
            axes.plot(*place, marker="o", markersize=5, color="white", markeredgecolor="black")
            _write(axes, percent(curve.critical_slip), place)
        axes.set_title(curve.name)
        axes.set_xlabel(axis_label(dataset["map_cage_slip"], r"$S_\mathrm{c}$", "%"))
        axes.set_xlim(cage[0], cage[-1])
        axes.set_ylim(roller[0], roller[-1])
    panels[0].set_ylabel(axis_label(dataset["map_roller_slip"], r"$S_\mathrm{r}$", "%"))
    bar = figure.colorbar(filled, ax=list(panels), aspect=30, pad=0.02)
    bar.set_label(axis_label(dataset["friction_map"], r"$\mu_\mathrm{e}$", "–"))
    handles = [
        Line2D([], [], label=f"closure {dataset.attrs['closure']}", **outlined),
        Line2D([], [], color="black", linewidth=1.25, label="pure rolling, no friction"),
    ]
    if any(curve.has_critical for curve in curves(dataset)):
        handles.append(
            Line2D([], [], color="white", markeredgecolor="black", marker="o", markersize=5, label="critical cage slip")
        )
    figure.legend(handles=handles, loc="outside upper left", ncols=3)
    return figure


def _comparison(dataset: "xr.Dataset", position: int) -> "Figure":
    """Curves of all combinations with their critical slips, their differences, and difference against cost."""
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.ticker import LogLocator, NullFormatter

    figure = Figure(layout="constrained")
    layout: list[Any] = [["curves", "costs"], ["differences", "costs"]]
    panels = figure.subplot_mosaic(layout, width_ratios=(3, 2), height_ratios=(3, 2))
    variable, dimension, slip, _ = CURVES[dataset.attrs["compared"]]
    one = dataset.isel({dimension: position})
    reference = dataset.attrs["reference"]
    difference, error, cost = (one[name].to_numpy() for name in ("difference", "rms_error", "cost"))
    handles: list[Line2D] = []
    for k, ((label, member), style) in enumerate(zip(members(dataset), _styles(dataset), strict=True)):
        curve, name = curves(member)[position], f"{k + 1}  {label}"
        if np.isnan(curve.friction).all():
            handles.append(Line2D([], [], linestyle="none", label=f"{name}: failed"))
            continue
        x, y, begin, _ = curve.branches()
        handles += panels["curves"].plot(100 * x, y, label=name + ": reference" * (label == reference), **style)
        if curve.has_critical:
            panels["curves"].plot(100 * x[begin], y[begin], color=style["color"], zorder=4, **MARKER)
        panels["differences"].plot(100 * curve.slip, 100 * difference[k], **style)
        if label == reference:
            panels["costs"].axvline(cost[k], color="black", linewidth=1.0, zorder=0)
        elif error[k] > 0.0:
            place = cost[k], 100 * error[k]
            panels["costs"].plot(*place, marker="o", markersize=5, color=style["color"])
            panels["costs"].annotate(
                f"{k + 1}", place, (5, (0, 6, -6)[k % 3]), textcoords="offset points", va="center_baseline", zorder=5
            )
    cage = dimension == "ring"
    panels["curves"].set_ylabel(axis_label(dataset[variable], r"$\mu_\mathrm{e}$" if cage else r"$\mu$", "–"))
    panels["curves"].set_ylim(min(0.0, np.nanmin(one[variable])))
    panels["curves"].tick_params(labelbottom=False)
    if np.nanmax(abs(difference), initial=0.0) > _SPREAD:
        panels["differences"].set_yscale("symlog", linthresh=1.0)
        panels["differences"].yaxis.set_major_formatter("{x:g}")
    panels["differences"].set_ylabel("Relative difference [%]")
    against = {"symbol": r"$S_\mathrm{c}$"} if cage else {"symbol": "$V/u$", "name": "slide–roll ratio"}
    panels["differences"].set_xlabel(axis_label(dataset[slip], unit="%", **against))
    for name in ("curves", "differences"):
        panels[name].set_xlim(0.0, 100 * float(one[slip][-1]))
    shown = np.log10(100 * error[error > 0.0])
    panels["costs"].loglog()
    panels["costs"].set_xlim(0.8, 1.3 * max(2.0, np.nanmax(cost)))
    panels["costs"].set_ylim(10 ** np.floor(shown.min(initial=1.0)), 10 ** np.ceil(shown.max(initial=0.0)))
    for axis in (panels["costs"].xaxis, panels["costs"].yaxis):
        decades = np.ptp(np.log10(axis.get_view_interval()))
        axis.set_major_locator(LogLocator(subs=(1, 2, 5) if decades < 2.5 else (1,)))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter(NullFormatter())
    panels["costs"].set_xlabel("Time for a slice over that of the fastest [–]")
    panels["costs"].set_ylabel("Relative difference, root mean square [%]")
    columns = max(1, min(4, int(140 / (6 + max(len(str(handle.get_label())) for handle in handles)))))
    figure.legend(handles=handles, loc="outside upper left", ncols=columns)
    figure.set_size_inches(TWO_COLUMNS[0], 100 * MM + ROW * -(-len(handles) // columns))
    return figure


def _styles(dataset: "xr.Dataset") -> list[dict[str, Any]]:
    """Colour and dashes of each combination: the kind with most models gives colours, the others dashes."""
    kinds = [dataset[kind].to_numpy().tolist() for kind in ("contact", "film", "traction")]
    main = max(kinds, key=lambda names: len(set(names)))
    others = list(zip(*(names for names in kinds if names is not main), strict=True))
    colours, dashes = list(dict.fromkeys(main)), list(dict.fromkeys(others))
    styles = []
    for label, name, rest in zip(dataset["combination"].to_numpy(), main, others, strict=True):
        colour = colours.index(name)
        dash = dashes.index(rest) if len(dashes) > 1 else colour
        styles.append(
            {"color": "black", "linewidth": 2.2, "zorder": 1}
            if label == dataset.attrs["reference"]
            else {
                "color": MODEL_COLOURS[colour % len(MODEL_COLOURS)],
                "linestyle": DASHES[dash % len(DASHES)],
                "linewidth": 1.1,
            }
        )
    return styles


def _held(dataset: "xr.Dataset") -> tuple[str, list[str]]:
    """What a rig held at all operating points, and what was different at each."""
    columns = {"point_temperature": "K", "point_pressure": "Pa", "point_speed": "m/s"}
    texts = {name: [format_quantity(float(v), unit, 3) for v in dataset[name]] for name, unit in columns.items()}
    common = [said[0] for said in texts.values() if len(set(said)) == 1]
    different = [said for said in texts.values() if len(set(said)) > 1]
    return ", ".join(common), [", ".join(row) for row in zip(*different, strict=True)]


def _fit(dataset: "xr.Dataset") -> "Figure":
    from matplotlib.lines import Line2D

    figure, axes = _new()
    handles: list[Artist] = []
    slip, friction = dataset["slide_roll_ratio"].to_numpy(), dataset["friction"].to_numpy()
    known = dataset.attrs["uncertainties"] == "given"
    for point, colour, label in _points(dataset):
        rows = dataset["operating_point"].to_numpy() == point
        error = dataset["uncertainty"].to_numpy()[rows] if known else None
        axes.errorbar(
            100 * slip[rows], friction[rows], error, color=colour, linestyle="none", elinewidth=0.6, **_OPEN
        )  # fmt: skip
        one = dataset.isel(point=point)
        (line,) = axes.plot(100 * one["curve_slip"], one["curve_friction"], color=colour, linewidth=1.0, label=label)
        if label:
            handles.append(line)
    many = "" if handles or dataset.sizes["point"] == 1 else f"{dataset.sizes['point']} operating points"
    words = ", ".join(filter(None, ("measured", many, _held(dataset)[0])))
    handles.append(Line2D([], [], color="0.3", linestyle="none", label=words, **_OPEN))
    axes.axhline(0.0, color="0.6", linewidth=0.5, zorder=0)
    axes.set_xlabel(axis_label(dataset["slide_roll_ratio"], "$V/u$", "%", name="slide–roll ratio"))
    axes.set_ylabel(axis_label(dataset["friction"], r"$\mu$", "–"))
    figure.legend(handles=handles, loc="outside upper left")
    figure.set_figheight(ONE_COLUMN[1] + ROW * len(handles))
    return figure


def _residuals(dataset: "xr.Dataset") -> "Figure":
    figure, axes = _new()
    slip = dataset["slide_roll_ratio"].to_numpy()
    residual = (dataset["residual"] / dataset["uncertainty"]).to_numpy()
    axes.axhspan(-2.0, 2.0, color="0.93", linewidth=0.0, zorder=0)
    axes.axhline(0.0, color="0.6", linewidth=0.5, zorder=0)
    handles = []
    for point, colour, label in _points(dataset):
        rows = dataset["operating_point"].to_numpy() == point
        (line,) = axes.plot(100 * slip[rows], residual[rows], color=colour, linestyle="none", label=label, **_OPEN)
        if label:
            handles.append(line)
    axes.set_ylim(*(np.array([-1.1, 1.1]) * max(3.0, np.abs(residual).max())))
    axes.set_xlabel(axis_label(dataset["slide_roll_ratio"], "$V/u$", "%", name="slide–roll ratio"))
    axes.set_ylabel("Residual / standard deviation [–]")
    if handles:
        figure.legend(handles=handles, loc="outside upper left")
    figure.set_figheight(ONE_COLUMN[1] + ROW * len(handles))
    return figure


def _points(dataset: "xr.Dataset") -> Iterator[tuple[int, Any, str]]:
    """Number, colour and label of each operating point; no labels where they would fill the page."""
    count, labels = dataset.sizes["point"], _held(dataset)[1]
    for point, colour in enumerate(light_to_dark()(np.linspace(1.0, 0.0, count)[::-1])):
        yield point, colour, labels[point] if 1 < count <= 12 else ""


def _profiles(dataset: "xr.Dataset") -> "Figure":
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    names = dataset["fitted_parameter"].values
    columns = min(names.size, 3)
    rows = -(-names.size // columns)
    size = ONE_COLUMN if columns == 1 else TWO_COLUMNS
    figure = Figure(figsize=(size[0], 58 * MM * rows + 2 * ROW), layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False, sharey=True).ravel()
    limits = dataset["rise_limit"].to_numpy()
    for axes, name in zip(panels, names, strict=False):
        one = dataset.sel(parameter=name)
        # people's unit, taken from how the value is shown to them
        SI, best = one["unit"].item(), float(one["value"])
        unit = format_quantity(best, SI).partition(" ")[2]
        held = one["profile_value"].to_numpy() / (quantity(f"1 {unit}", SI) if unit else 1.0)
        best *= held[held.size // 2] / best if best else 1.0
        for limit, level in zip(limits, dataset["level"].values, strict=True):
            axes.axhline(limit, color="0.6", linewidth=0.6, zorder=0)
            axes.text(0.5, limit, f"{level:.0%}", transform=axes.get_yaxis_transform(), va="bottom", ha="center")
        error = math.sqrt(float(one["covariance"].sel(with_parameter=name)))
        if math.isfinite(error):
            change = np.log(held / best) if held.min() > 0.0 < best else held - best
            axes.plot(held, (change / error) ** 2, color=RING_COLOURS["outer"], linewidth=1.0)
        axes.plot(held, one["profile_rise"], color=RING_COLOURS["inner"])
        axes.plot(best, 0.0, color=RING_COLOURS["inner"], clip_on=False, **MARKER)
        if held.min() > 0.0 and held.max() > 5.0 * held.min():
            axes.set_xscale("log")
        axes.set_ylim(0.0, 1.6 * limits[-1])
        axes.set_xlabel(f"{name} [{unit or '–'}]")
    for axes in panels[names.size :]:
        axes.set_visible(False)
    panels[0].set_ylabel(r"Rise of $\chi^2$ over the variance [–]")
    handles = [
        Line2D([], [], color=RING_COLOURS["inner"], label="profile likelihood, the others fitted anew"),
        Line2D([], [], color=RING_COLOURS["outer"], linewidth=1.0, label="covariance: the law taken for linear"),
    ]
    figure.legend(handles=handles, loc="outside upper left", ncols=columns)
    return figure


# What they share ----------------------------------------------------------------------------------------------------


def _new() -> "tuple[Figure, Axes]":
    from matplotlib.figure import Figure

    figure = Figure(figsize=ONE_COLUMN, layout="constrained")
    axes = figure.subplots()
    plain_ticks(axes)
    return figure, axes


def _film_limits(dataset: "xr.Dataset") -> dict[str, float]:
    """Film parameters up to which a film is mixed or boundary, as far as the scene gives them."""
    traction = json.loads(dataset.attrs.get("scene_resolved", "{}")).get("models", {}).get("traction", {})
    keys = {"mixed": "hydrodynamic_limit", "boundary": "boundary_limit"}
    return {film: quantity(traction[key], "1") for film, key in keys.items() if key in traction}


def _film(curve: Curve, limits: Mapping[str, float]) -> str:
    """Film parameter of a curve and, if it is one all along, the kind of film."""
    finite = curve.film_parameter[np.isfinite(curve.film_parameter)]
    if not finite.size:
        return r"$\Lambda$ unknown"
    ends = (finite.min(), finite.max())
    low, high = (_digits(end, 2) for end in ends)
    kinds = {_kind(end, limits) for end in ends}
    kind = f" ({kinds.pop()})" if limits and len(kinds) == 1 else ""
    return rf"$\Lambda$ = {low if low == high else f'{low} to {high}'}{kind}"


def _kind(film_parameter: float, limits: Mapping[str, float]) -> str:
    below = [film for film, limit in limits.items() if film_parameter < limit]
    return f"{min(below, key=limits.__getitem__)} film" if below else "full film"


def _shade_film(axes: "Axes", shown: Sequence[Curve], limits: Mapping[str, float]) -> "list[Artist]":
    """Shade the slips at which the thinnest film is not full; return what goes into the legend."""
    from matplotlib.patches import Patch

    thinnest = np.min([curve.film_parameter for curve in shown], axis=0)
    handles: list[Artist] = []
    for film, limit in sorted(limits.items(), key=lambda item: -item[1]):
        below = thinnest < limit
        if np.any(below):
            axes.fill_between(
                100 * shown[0].slip,
                0.0,
                1.0,
                where=below.tolist(),
                transform=axes.get_xaxis_transform(),
                color=FILM_TINTS[film],
                linewidth=0.0,
                zorder=0,
            )
            label = rf"{film} film: smallest $\Lambda$ < {limit:g}"
            handles.append(Patch(facecolor=FILM_TINTS[film], label=label))
    return handles


def _draw(axes: "Axes", curve: Curve, colour: Any, label: str, *, width: float = 1.4, tinted: bool = False) -> "Line2D":
    """Draw a curve, its thermal branch dashed and on request tinted down to zero; return what the legend shows."""
    x, y, begin, end = curve.branches()
    x = 100 * x
    (line,) = axes.plot(x[: begin + 1], y[: begin + 1], color=colour, linewidth=width, label=label)
    if curve.has_critical:
        thermal = slice(begin, end + 1)
        if tinted:
            axes.fill_between(x[thermal], 0.0, y[thermal], color=colour, alpha=0.15, linewidth=0.0)
        axes.plot(x[thermal], y[thermal], color=colour, linewidth=width, linestyle="dashed")
        axes.plot(x[end:], y[end:], color=colour, linewidth=width)
        axes.vlines(x[begin], 0.0, y[begin], color=colour, linewidth=0.7, linestyle="dotted")
        axes.plot(x[begin], y[begin], color=colour, **MARKER)
    return line


def _write(axes: "Axes", text: str, place: tuple[float, float]) -> "Annotation":
    return axes.annotate(
        text,
        place,
        (0, 5),
        textcoords="offset points",
        horizontalalignment="center",
        bbox={"boxstyle": "square,pad=0.1", "facecolor": "white", "alpha": 0.7, "linewidth": 0.0},
    )


def _finish(
    figure: "Figure",
    axes: "Axes",
    shown: Sequence[Curve],
    handles: "Sequence[Artist]",
    others: Array | None = None,
) -> None:
    """Set the ranges, with room above the curves for what has to be said in words, and say it."""
    from matplotlib.lines import Line2D

    rows = np.vstack([curve.friction for curve in shown] + ([] if others is None else [others]))
    finite = rows[np.isfinite(rows)]
    low, high = finite.min(initial=0.0), finite.max(initial=0.0)
    # a curve of rounding noise is a zero line, not a range below zero
    low = low if low < -1e-6 * high else 0.0
    high = high if high > low else low + 1.0
    critical = [curve for curve in shown if curve.has_critical]
    notes = _notes(shown, 66 if others is None else 58)
    room = 0.05 + 0.07 * len(notes.splitlines()) + 0.08 * bool(critical)
    axes.set_ylim(low, low + (high - low) / (1.0 - room))
    axes.set_xlim(100 * shown[0].slip[0], 100 * shown[0].slip[-1])
    written = axes.text(0.015, 0.985, notes, transform=axes.transAxes, va="top", fontsize=6.5, color="0.25")
    written.set_in_layout(False)
    if critical:
        words = "critical slip; beyond it the thermal branch"
        handles = [*handles, Line2D([], [], color="0.35", linestyle="dashed", label=words, **MARKER)]
    figure.legend(handles=handles, loc="outside upper left")
    figure.set_figheight(ONE_COLUMN[1] + ROW * len(handles))
    figure.draw_without_rendering()  # places the axes, on which it depends what a label covers
    _write_critical(axes, critical, rows, written)


def _write_critical(axes: "Axes", critical: Sequence[Curve], rows: Array, written: "Text") -> None:
    """Write the critical slips beside their maxima, each where it covers least of curves and of other words."""
    taken = [written.get_window_extent()]
    for curve in critical:
        dense = np.linspace(curve.slip[0], curve.slip[-1], 1000)
        points = [np.column_stack((100 * dense, np.interp(dense, curve.slip, row))) for row in rows]
        pixels = axes.transData.transform(np.concatenate(points))
        label = _write(axes, percent(curve.critical_slip), (100 * curve.critical_slip, curve.critical_friction))

        def covered(place: tuple[float, float, str], label: "Annotation" = label, pixels: Array = pixels) -> int:
            label.set_position(place[:2])
            label.set(horizontalalignment=place[2], verticalalignment="bottom" if place[1] > 0 else "top")
            box = label.get_window_extent()
            inside = np.all((box.min < pixels) & (pixels < box.max), axis=1)
            words = sum(box.overlaps(other) for other in taken)
            beyond = not axes.bbox.x0 < box.x0 < box.x1 < axes.bbox.x1
            return int(np.count_nonzero(inside)) + pixels.size * (words + beyond)

        covered(min(_PLACES, key=covered))
        taken.append(label.get_window_extent())


def _notes(shown: Sequence[Curve], width: int) -> str:
    """What was found instead of a critical slip; the status without its advice, once for all curves it is true of."""
    without: dict[str, list[str]] = {}
    for curve in shown:
        if not curve.has_critical:
            without.setdefault(curve.status.partition(",")[0], []).append(curve.name)
    return "\n".join(
        textwrap.fill(status if len(names) == len(shown) else f"{', '.join(names)}: {status}", width)
        for status, names in without.items()
    )
