"""Figure of rating lives: damage along the roller by ring, and the largest loads there."""

from collections.abc import Iterator

import numpy as np
from matplotlib.figure import Figure

from rollslip.bearing.raceway import RINGS
from rollslip.results.dataset import xr
from rollslip.results.style import DASHES, RING_COLOURS, ROW, SINGLE_COLUMN, Sheet
from rollslip_studies.rating_life.findings import split_models

__all__ = ["life_figures"]


def life_figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Draw the figure of each model that knows where damage arises; yield name, caption and figure."""
    for life in split_models(dataset):
        if np.isfinite(life["damage"]).all():
            yield (
                f"life-{life['life_model'].item()}",
                f"Damage along the roller by {life['life_basis'].item()}, and the largest load over the orbit.",
                _along(life),
            )


def _along(life: "xr.Dataset") -> "Figure":
    """Draw damage and load along the roller, a line for each ring."""
    sheet = Sheet(SINGLE_COLUMN, 2, 1, sharex=True)
    for k, ring in enumerate(RINGS):
        at = life.sel(ring=ring)
        style = {"color": RING_COLOURS[ring], "linestyle": DASHES[k], "drawstyle": "steps-mid"}
        fraction = f"{ring} ring, {100.0 * float(at['ring_damage']):.3g} % of the damage"
        sheet.line(1e3 * at["position"], 1e-3 * at["damage"], fraction, sheet.axes[0], **style)
        sheet.axes[1].plot(1e3 * at["position"], 1e-3 * at["largest_line_load"], **style)
    for axes, label in zip(sheet.axes, ("Damage\n[1/mm]", "Largest load\n[N/mm]"), strict=True):
        axes.set_ylabel(label)
        axes.set_ylim(bottom=0.0)
    sheet.axes[1].set_xlabel("Position along the roller [mm]")
    return sheet.done(height=1.5 * SINGLE_COLUMN[1] + 2 * ROW)
