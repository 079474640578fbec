"""Figures of study effective-friction: curves of both raceways, of single rollers, and the map over both slips."""

from collections.abc import Iterator
from typing import Any, Final

import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure

from rollslip.results.curve_figures import annotate_point, draw_curve, finish, new_figure
from rollslip.results.curves import curves, percent
from rollslip.results.dataset import xr
from rollslip.results.style import (
    DASHES,
    MARKER,
    RING_COLOURS,
    TWO_COLUMNS,
    against_zero,
    axis_label,
    light_to_dark,
    seamless,
)
from rollslip_studies.effective_friction.ring_figures import ring_figure
from rollslip_studies.raceway_friction.film_figures import film_limits, film_text, shade_film

__all__ = ["figures"]

#: Style of the mark of the slip at which the cage runs.
_POINT: Final[dict[str, Any]] = {
    **MARKER,
    "markersize": 6,
    "linestyle": "none",
    "label": "operating point",
}


def figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Yield name, caption and figure of each figure for which the dataset has variables."""
    name = "effective-friction"
    closure = f"roller speed: {dataset.attrs['closure']}"
    caption = f"Effective friction of both raceways against cage slip, {closure}."
    yield name, caption, _effective_friction(dataset)
    if "roller_friction" in dataset:
        caption = f"Friction of single rollers and effective friction on the inner ring, {closure}."
        yield f"{name}-rollers", caption, _rollers(dataset)
    if "friction_map" in dataset:
        caption = f"Effective friction over cage slip and roller slip; the line is the {closure}."
        yield f"{name}-map", caption, _map(dataset)
    if "operating_slip" not in dataset.attrs:  # else the study with the operating slip draws them
        yield from ring_figure(dataset)


def _effective_friction(dataset: "xr.Dataset") -> "Figure":
    """Draw the effective friction of both raceways over the cage slip."""
    figure, axes = new_figure()
    shown = curves(dataset)
    limits = film_limits(dataset)
    tints = shade_film(axes, shown, limits)
    lines: list[Artist] = [
        draw_curve(
            axes,
            curve,
            RING_COLOURS[ring],
            f"{curve.name}: smallest {film_text(curve, limits)}",
            tinted=True,
        )
        for ring, curve in zip(dataset["ring"].values, shown, strict=True)
    ]
    axes.set_xlabel(axis_label(dataset["cage_slip"], r"$S_\mathrm{c}$", "%"))
    axes.set_ylabel(axis_label(dataset["effective_friction"], r"$\mu_\mathrm{e}$", "–"))
    finish(figure, axes, shown, lines + tints)
    return figure


def _rollers(dataset: "xr.Dataset") -> "Figure":
    """Draw the friction of single rollers and the effective friction of the inner ring."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.lines import Line2D

    figure, axes = new_figure()
    inner = dataset.sel(ring="inner")
    forces = inner["normal_force"].to_numpy()
    friction = inner["roller_friction"].to_numpy()
    loaded = np.flatnonzero(forces > 0.0)
    scale = ScalarMappable(Normalize(0.0, forces.max()), light_to_dark())
    slip = 100 * inner["cage_slip"].to_numpy()
    for roller in loaded[np.argsort(forces[loaded], kind="stable")]:
        axes.plot(slip, friction[roller], color=scale.to_rgba(forces[roller]), linewidth=0.8)
    effective = [curve for curve in curves(dataset) if curve.name == "inner ring"]
    lines: list[Artist] = [
        *(
            draw_curve(axes, curve, "black", r"inner ring, effective: $\mu_\mathrm{e}$", width=2.0)
            for curve in effective
        ),
        Line2D([], [], color=light_to_dark()(1.0), linewidth=0.8, label="its single rollers"),
    ]
    bar = figure.colorbar(scale, ax=axes, aspect=30, pad=0.03)
    bar.set_label(axis_label(dataset["normal_force"], "$Q$", "N", name="normal force"))
    seamless(bar)
    axes.set_xlabel(axis_label(dataset["cage_slip"], r"$S_\mathrm{c}$", "%"))
    axes.set_ylabel(
        axis_label(dataset["roller_friction"], r"$\mu$", "–", name="friction coefficient")
    )
    finish(figure, axes, effective, lines, others=friction[loaded])
    return figure


def _map(dataset: "xr.Dataset") -> "Figure":
    """Draw contours of effective friction over cage slip and roller slip, with the curve of the closure."""
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.ticker import MaxNLocator

    figure = Figure(figsize=TWO_COLUMNS, layout="constrained")
    surface = np.ma.masked_invalid(dataset["friction_map"].to_numpy())
    cage = 100 * dataset["map_cage_slip"].to_numpy()
    roller = 100 * dataset["map_roller_slip"].to_numpy()
    levels = MaxNLocator(20).tick_values(surface.min(), surface.max())
    noise = 1e-6 * np.ptp(levels)
    colours = against_zero(float(levels[0]), float(levels[-1]))
    style: dict[str, Any] = {"color": "black", "linewidth": 1.6, "linestyle": DASHES[3]}
    panels = figure.subplots(1, dataset.sizes["ring"], sharey=True, squeeze=False)[0]
    # of this study, or of another one in a run
    operating_slip = float(
        dataset.attrs.get("operating_slip", dataset.get("steady_cage_slip", np.nan))
    )
    point = list[Line2D]()
    for axes, curve, ring, values in zip(
        panels, curves(dataset), dataset["ring"].values, surface, strict=True
    ):
        filled = axes.contourf(cage, roller, values.T, levels, **colours)
        filled.set_edgecolor("face")  # some viewers show seams between the areas without it
        axes.contour(
            cage,
            roller,
            values.T,
            levels,
            colors="black",
            linewidths=0.25 + np.isclose(levels, 0.0, atol=noise),
            linestyles=np.where(levels < -noise, "dashed", "solid").tolist(),
        )
        line = 100 * dataset["roller_slip"].sel(ring=ring).to_numpy()
        axes.plot(100 * curve.slip, line, **style)
        if curve.has_critical:
            point_at = (
                100 * curve.critical_slip,
                float(np.interp(curve.critical_slip, curve.slip, line)),
            )
            axes.plot(*point_at, marker="o", markersize=5, color="white", markeredgecolor="black")
            annotate_point(axes, percent(curve.critical_slip), point_at)
        if 100 * operating_slip <= cage[-1]:
            point = axes.plot(
                100 * operating_slip,
                float(np.interp(operating_slip, curve.slip, line)),
                color="black",
                **_POINT,
            )
        axes.set_title(curve.name)
        axes.set_xlabel(axis_label(dataset["map_cage_slip"], r"$S_\mathrm{c}$", "%"))
        axes.set_xlim(cage[0], cage[-1])
        axes.set_ylim(roller[0], roller[-1])
    panels[0].set_ylabel(axis_label(dataset["map_roller_slip"], r"$S_\mathrm{r}$", "%"))
    bar = figure.colorbar(filled, ax=list(panels), aspect=30, pad=0.02)
    bar.set_label(axis_label(dataset["friction_map"], r"$\mu_\mathrm{e}$", "–"))
    handles = [
        Line2D([], [], label=f"roller speed: {dataset.attrs['closure']}", **style),
        Line2D([], [], color="black", linewidth=1.25, label="pure rolling, no friction"),
    ]
    if float(surface.min()) < 0.0:
        handles.append(
            Line2D([], [], color="black", linewidth=0.5, linestyle="dashed", label="negative")
        )
    if any(curve.has_critical for curve in curves(dataset)):
        label = f"cage slip at largest traction {dataset.attrs.get('curves_with', '')}".rstrip()
        handles.append(
            Line2D(
                [],
                [],
                color="white",
                markeredgecolor="black",
                marker="o",
                markersize=5,
                label=label,
            )
        )
    figure.legend(handles=handles + point, loc="outside upper left", ncols=3)
    return figure
