"""Figure of study friction-curve: friction of one contact over slip, a curve for each normal force."""

from collections.abc import Iterator

import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure

from rollslip.results.curve_figures import draw_curve, finish, new_figure
from rollslip.results.curves import curves
from rollslip.results.dataset import xr
from rollslip.results.style import axis_label, light_to_dark
from rollslip.units import format_quantity
from rollslip_studies.raceway_friction.film_figures import film_limits, film_text, shade_film

__all__ = ["figures"]


def figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Yield name, caption and figure."""
    attributes = dataset.attrs
    at = format_quantity(attributes["rolling_speed"], "m/s", 3)
    caption = f"Friction of one contact with the {attributes['ring']} ring, entrainment speed {at}."
    yield "friction-curve", caption, _friction_curve(dataset)


def _friction_curve(dataset: "xr.Dataset") -> "Figure":
    """Draw friction over the slide-roll ratio, dark curves for large forces."""
    figure, axes = new_figure()
    shown = curves(dataset.sortby("normal_force"))
    limits = film_limits(dataset)
    tints = shade_film(axes, shown, limits)
    lines: list[Artist] = [
        draw_curve(axes, curve, colour, f"{curve.name}: {film_text(curve, limits)}, {curve.regime}")
        for curve, colour in zip(
            shown, light_to_dark()(np.linspace(1.0, 0.0, len(shown))[::-1]), strict=True
        )
    ]
    axes.set_xlabel(axis_label(dataset["slip"], r"$V/u$", "%", name="slide–roll ratio"))
    axes.set_ylabel(axis_label(dataset["friction"], r"$\mu$", "–"))
    finish(figure, axes, shown, lines + tints)
    return figure
