"""Figure of the losses at steady slips, by source."""

import numpy as np
from matplotlib.figure import Figure

from rollslip.results.dataset import xr
from rollslip.results.style import ROW, TWO_COLUMNS, Sheet, axis_label, light_to_dark


def losses_figure(dataset: "xr.Dataset") -> "Figure":
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
