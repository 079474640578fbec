"""Figures of scattering data: the margin between steady and critical slip, what makes the scatter, and convergence.

Style, sizes and files are those of `rollslip.results.style`. The margin is drawn as shares of samples, not as
densities: every sample is in the picture, no width of bins decides what is seen, and where both curves overlap there is
no margin.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from rollslip.campaigns.uncertainty.findings import RUNAWAY, sentences
from rollslip.results.style import DASHES, MM, MODEL_COLOURS, ONE_COLUMN, ROW, plain_decades

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["uncertainty_figures"]


def uncertainty_figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Draw the figures; give name, caption and figure."""
    yield "uncertainty", f"Margin of cage slip: {sentences(dataset)[1]}.", _margin(dataset)
    if dataset.sizes.get("indexed"):
        caption = "Sobol indices: shares of the variance that each uncertain quantity makes, with 95 % intervals."
        yield "uncertainty-indices", caption, _indices(dataset)
    if np.isfinite(dataset["batch_allowable"].to_numpy()).sum() > 1:
        caption = "Allowable slip by the number of samples, with its 95 % interval."
        yield "uncertainty-convergence", caption, _convergence(dataset)


def _new() -> "tuple[Figure, Axes]":
    from matplotlib.figure import Figure

    figure = Figure(figsize=ONE_COLUMN, layout="constrained")
    return figure, figure.subplots()


def _margin(dataset: "xr.Dataset") -> "Figure":
    figure, axes = _new()
    shown: dict[str, tuple[str, str, Any]] = {RUNAWAY: ("below", MODEL_COLOURS[0], DASHES[0])}
    if "margin" in dataset:
        shown = {"steady slip": ("above", MODEL_COLOURS[1], DASHES[1])} | shown
    ends = list[float]()
    for name, (side, colour, dashes) in shown.items():
        one = dataset.sel(quantity=name)
        n = int(one["samples"])
        values = one["value"].to_numpy()[:n]
        known, unknown = np.sort(values[np.isfinite(values)]), int(one["unknown"])
        if not known.size:
            where = "beyond the range, or failed"
            if n in (unknown, int(one["beyond"])):
                where = "failed" if unknown else "beyond the range or without end"
            axes.plot([], [], color=colour, label=f"{name}: all {n} samples {where}")
            continue
        known = np.append(known[0], known)  # from no sample on
        ends += [float(known[0]), float(known[-1])]
        below = np.arange(known.size) / n
        least, most = (below, below + unknown / n) if side == "below" else (1 - below - unknown / n, 1 - below)
        label = f"{name}: share of {n} samples {side}"
        shares: dict[str, Any] = {"drawstyle": "steps-post", "color": colour, "linestyle": dashes, "label": label}
        axes.plot(100 * known, 100 * (least if side == "below" else most), **shares)
        if unknown:
            axes.fill_between(100 * known, 100 * least, 100 * most, step="post", color=colour, alpha=0.25, linewidth=0)
    allowed, low, high = (float(dataset[f"allowable{end}"]) for end in ("_slip", "_low", "_high"))
    if np.isfinite(allowed):
        p = float(dataset.attrs["probability"])
        told = np.isfinite([low, high]).all()
        label = f"allowable at {p:g}: {100 * allowed:.3g} %"
        label += f" ({100 * low:.3g} to {100 * high:.3g})" if told else ""
        axes.axvline(100 * allowed, color="black", linewidth=0.9, label=label)
        if told:
            axes.axvspan(100 * low, 100 * high, color="0.8", linewidth=0, zorder=0)
    if ends and min(ends) > 0.0:
        axes.set_xscale("log")
        axes.set_xlim(100 * min(ends) / 1.5, min(100.0, 150 * max(ends)))
        plain_decades(axes.xaxis)
    if not ends:  # an axis from 0 to 1 % would say that there is nothing there alone
        axes.set_xlim(0.0, 100.0)
    axes.set_ylim(0.0, 103.0)
    axes.set_xlabel("Cage slip [%]")
    axes.set_ylabel("Share of samples [%]")
    handles, _ = axes.get_legend_handles_labels()
    figure.legend(handles=handles, loc="outside upper left", ncols=1)
    figure.set_size_inches(ONE_COLUMN[0], ONE_COLUMN[1] + ROW * len(handles))
    return figure


def _indices(dataset: "xr.Dataset") -> "Figure":
    from matplotlib.figure import Figure

    names = dataset["indexed"].to_numpy()
    order = np.argsort(dataset["total_order"].sel(indexed=names[0]).to_numpy())
    keys = [str(key).replace("lubricant.", "").replace("_", " ") for key in dataset["input"].to_numpy()[order]]
    figure = Figure(figsize=(2 * ONE_COLUMN[0], (24 + 9 * len(keys)) * MM), layout="constrained")
    panels = figure.subplots(1, len(names), sharex=True, sharey=True, squeeze=False)[0]
    for axes, name in zip(panels, names, strict=True):
        one = dataset.sel(indexed=name)
        for shift, which, colour in ((0.19, "first_order", "0.65"), (-0.19, "total_order", MODEL_COLOURS[0])):
            value, low, high = (one[f"{which}{end}"].to_numpy()[order] for end in ("", "_low", "_high"))
            bars: dict[str, Any] = {"xerr": [np.maximum(value - low, 0.0), np.maximum(high - value, 0.0)]}
            axes.barh(
                np.arange(len(keys)) + shift, value, 0.36, color=colour, label=which.replace("_", " "),
                error_kw={"elinewidth": 0.7}, **bars,
            )  # fmt: skip
        axes.set_title(str(name))
        axes.set_yticks(np.arange(len(keys)), keys)
        axes.tick_params(axis="y", length=0)
        axes.axvline(0.0, color="black", linewidth=0.6)
        axes.spines["left"].set_visible(False)
        axes.set_xlabel("Share of the variance [–]")
    figure.legend(handles=panels[0].get_legend_handles_labels()[0], loc="outside lower left", ncols=2)
    return figure


def _convergence(dataset: "xr.Dataset") -> "Figure":
    figure, axes = _new()
    known = dataset.isel(batch=np.isfinite(dataset["batch_allowable"].to_numpy()))
    count, value, low, high = (known[f"batch_{name}"].to_numpy() for name in ("samples", "allowable", "low", "high"))
    told = np.isfinite(low) & np.isfinite(high)
    axes.set_xscale("log", base=2)
    axes.errorbar(
        count[told], 100 * value[told], yerr=100 * np.array([(value - low)[told], (high - value)[told]]),
        color=MODEL_COLOURS[0], marker="o", markersize=3.5, capsize=2, elinewidth=0.8,
    )  # fmt: skip
    if (~told).any():
        axes.plot(
            count[~told], 100 * value[~told], color=MODEL_COLOURS[0], marker="o", markersize=3.5, mfc="white", ls=""
        )
    axes.set_xticks(count, [str(one) for one in count])
    axes.minorticks_off()
    axes.set_xlabel("Samples")
    axes.set_ylabel(f"Allowable slip at {float(dataset.attrs['probability']):g} [%]")
    return figure
