"""Figures of scattering data: drag reserve, steady slip and its margin, sensitivities, and convergence.

Style, sizes and files are those of `rollslip.results.style`. The margin is drawn as empirical distribution functions,
not as densities: every sample is in the figure, no width of bins changes the picture, and where both curves overlap
there is no margin.
"""

import textwrap
from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from rollslip.results.dataset import xr
from rollslip.results.style import (
    DASHES,
    MM,
    MODEL_COLOURS,
    TWO_COLUMNS,
    Sheet,
    plain_decades,
)
from rollslip.results.text import short_label
from rollslip_campaigns.uncertainty.findings import (
    RESERVE,
    SKIDDING,
    STEADY,
    describe_margin,
    describe_quantity,
)

__all__ = ["uncertainty_figures"]


def uncertainty_figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Draw the figures; yield name, caption and figure of each."""
    if RESERVE in dataset["quantity"].to_numpy():
        yield (
            "uncertainty-reserve",
            f"Drag reserve: {describe_quantity(dataset, RESERVE)}.",
            _reserve(dataset),
        )
    sentence = describe_quantity(dataset, SKIDDING)
    if "margin" in dataset:
        sentence = describe_margin(dataset)
    yield "uncertainty", f"Margin of cage slip: {sentence}.", _margin(dataset)
    if np.isfinite(dataset["rank_correlation"].to_numpy()).any():
        yield (
            "uncertainty-ranks",
            "Rank correlations of each uncertain quantity with what is acted on, the strongest first.",
            _ranks(dataset),
        )
    if dataset.sizes.get("indexed"):
        yield (
            "uncertainty-indices",
            "Sobol indices: fractions of the variance due to each uncertain quantity, with 95 % intervals.",
            _indices(dataset),
        )
    if np.isfinite(dataset["batch_allowable"].to_numpy()).sum() > 1:
        yield (
            "uncertainty-convergence",
            "Allowable slip by the number of samples, with its 95 % interval.",
            _convergence(dataset),
        )


def _reserve(dataset: "xr.Dataset") -> "Figure":
    """Empirical distribution of the drag reserve, its reported quantile, and the limit below which the cage skids."""
    sheet = Sheet()
    axes = sheet.axes
    reserves = dataset.sel(quantity=RESERVE)
    p = float(dataset.attrs["probability"])
    n = int(reserves["samples"])
    unknown = int(reserves["unknown"])
    known = np.sort(reserves["value"].to_numpy()[:n])[: n - unknown]  # NaN is sorted last
    drawn = np.isfinite(known) & (known > 0.0)
    if drawn.any():
        shown = known[drawn]
        below = np.arange(1, known.size + 1)[drawn] / n
        axes.plot(
            shown,
            100 * below,
            color=MODEL_COLOURS[0],
            drawstyle="steps-post",
            label=f"drag reserve: fraction of {n} samples below",
        )
        if unknown:
            axes.fill_between(
                shown,
                100 * below,
                100 * (below + unknown / n),
                step="post",
                color=MODEL_COLOURS[0],
                alpha=0.25,
                linewidth=0,
            )
        plain_decades(axes.xaxis)
    lower_bound = float(reserves["quantile_value"].sel(probability=round(1.0 - p, 12)))
    if np.isfinite(lower_bound):
        axes.axvline(
            lower_bound,
            color="black",
            linewidth=0.9,
            label=f"at least, with probability {p:g}: {lower_bound:.3g}",
        )
    axes.axvline(1.0, color=MODEL_COLOURS[1], linestyle=DASHES[1], label="below 1 the cage skids")
    axes.set_ylim(0.0, 103.0)
    sheet.handles = axes.get_legend_handles_labels()[0]
    return sheet.done(
        "Limit drag torque over the drags of the scene [–]", "Fraction of samples [%]"
    )


def _ranks(dataset: "xr.Dataset") -> "Figure":
    """Rank correlations as bars, a panel for each result; inputs are in the order of their largest correlation."""
    known = dataset["rank_correlation"].transpose("acted", "input").dropna("acted", how="all")
    ranks = known.to_numpy()
    order = np.argsort(np.nan_to_num(np.abs(ranks)).max(axis=0))

    def draw_bars(axes: Any, positions: Any, k: int) -> None:
        axes.barh(positions, np.nan_to_num(ranks[k][order]), 0.6, color=MODEL_COLOURS[0])
        axes.set_xlim(-1.0, 1.0)

    return _draw_input_panels(
        dataset, order, 6, known["acted"].to_numpy(), "Rank correlation [–]", draw_bars
    ).figure


def _draw_input_panels(
    dataset: "xr.Dataset", order: Any, row_height: float, names: Any, label: str, draw_bars: Any
) -> Sheet:
    """Draw a panel for each name with a row for each input, of a height [mm]; `draw_bars` draws into one panel."""
    keys = [short_label(str(key)) for key in dataset["input"].to_numpy()[order]]
    positions = np.arange(order.size)
    sheet = Sheet(
        (TWO_COLUMNS[0], (24 + row_height * len(keys)) * MM),
        1,
        len(names),
        sharex=True,
        sharey=True,
        squeeze=False,
    )
    for k, (axes, name) in enumerate(zip(sheet.axes[0], names, strict=True)):
        draw_bars(axes, positions, k)
        axes.set(
            title=textwrap.fill(str(name), 72 // len(names)),
            yticks=positions,
            yticklabels=keys,
            xlabel=label,
        )
        axes.tick_params(axis="y", length=0)
        axes.axvline(0.0, color="black", linewidth=0.6)
        axes.spines["left"].set_visible(False)
    return sheet


def _margin(dataset: "xr.Dataset") -> "Figure":
    """Empirical distributions of the steady slip and of the slip at which skidding begins, with the allowable slip."""
    sheet = Sheet()
    axes = sheet.axes
    shown: dict[str, tuple[str, str, Any]] = {SKIDDING: ("below", MODEL_COLOURS[0], DASHES[0])}
    if "margin" in dataset:
        shown = {STEADY: ("above", MODEL_COLOURS[1], DASHES[1])} | shown
    limits = list[float]()
    for name, (side, colour, dashes) in shown.items():
        slips = dataset.sel(quantity=name)
        n = int(slips["samples"])
        values = slips["value"].to_numpy()[:n]
        known = np.sort(values[np.isfinite(values)])
        unknown = int(slips["unknown"])
        if not known.size:
            where = "beyond the range, or failed"
            if n in (unknown, int(slips["beyond"])):
                where = "failed" if unknown else "beyond the range or without end"
            axes.plot([], [], color=colour, label=f"{name}: all {n} samples {where}")
            continue
        known = np.append(known[0], known)  # the curve starts at a fraction of zero
        limits += [float(known[0]), float(known[-1])]
        below = np.arange(known.size) / n
        lower, upper = (
            (below, below + unknown / n)
            if side == "below"
            else (1 - below - unknown / n, 1 - below)
        )
        axes.plot(
            100 * known,
            100 * (lower if side == "below" else upper),
            drawstyle="steps-post",
            color=colour,
            linestyle=dashes,
            label=f"{name}: fraction of {n} samples {side}",
        )
        if unknown:
            axes.fill_between(
                100 * known,
                100 * lower,
                100 * upper,
                step="post",
                color=colour,
                alpha=0.25,
                linewidth=0,
            )
    allowed, low, high = (float(dataset[f"allowable{end}"]) for end in ("_slip", "_low", "_high"))
    if np.isfinite(allowed):
        finite = np.isfinite([low, high]).all()
        label = f"allowable at {float(dataset.attrs['probability']):g}: {100 * allowed:.3g} %"
        label += f" ({100 * low:.3g} to {100 * high:.3g})" if finite else ""
        axes.axvline(100 * allowed, color="black", linewidth=0.9, label=label)
        if finite:
            axes.axvspan(100 * low, 100 * high, color="0.8", linewidth=0, zorder=0)
    if (acceptable := dataset.attrs.get("acceptable_slip", "")) != "":
        axes.axvline(
            100 * float(acceptable),
            color="0.4",
            linewidth=0.9,
            linestyle=DASHES[2],
            label=f"acceptable: {100 * float(acceptable):.3g} %",
        )
    if limits and min(limits) > 0.0:
        plain_decades(axes.xaxis)
        axes.set_xlim(100 * min(limits) / 1.5, min(100.0, 150 * max(limits)))
    if not limits:  # the default axis from 0 to 1 % would suggest that only this part is empty
        axes.set_xlim(0.0, 100.0)
    axes.set_ylim(0.0, 103.0)
    sheet.handles = axes.get_legend_handles_labels()[0]
    return sheet.done("Cage slip [%]", "Fraction of samples [%]")


def _indices(dataset: "xr.Dataset") -> "Figure":
    """Sobol indices as bars with their intervals, a panel for each result."""
    names = dataset["indexed"].to_numpy()
    order = np.argsort(dataset["total_order"].sel(indexed=names[0]).to_numpy())

    def draw_bars(axes: Any, positions: Any, k: int) -> None:
        result = dataset.sel(indexed=names[k])
        for shift, order_name, colour in (
            (0.19, "first_order", "0.65"),
            (-0.19, "total_order", MODEL_COLOURS[0]),
        ):
            value, low, high = (
                result[f"{order_name}{suffix}"].to_numpy()[order]
                for suffix in ("", "_low", "_high")
            )
            axes.barh(
                positions + shift,
                value,
                0.36,
                color=colour,
                label=order_name.replace("_", " "),
                error_kw={"elinewidth": 0.7},
                xerr=[np.maximum(value - low, 0.0), np.maximum(high - value, 0.0)],
            )

    sheet = _draw_input_panels(dataset, order, 9, names, "Fraction [–]", draw_bars)
    handles = sheet.axes[0][0].get_legend_handles_labels()[0]
    sheet.figure.legend(handles=handles, loc="outside lower left", ncols=2)
    return sheet.figure


def _convergence(dataset: "xr.Dataset") -> "Figure":
    """Allowable slip with its interval over the number of samples; open markers where a bound is infinite."""
    sheet = Sheet()
    axes = sheet.axes
    known = dataset.isel(batch=np.isfinite(dataset["batch_allowable"].to_numpy()))
    count, value, low, high = (
        known[f"batch_{name}"].to_numpy() for name in ("samples", "allowable", "low", "high")
    )
    finite = np.isfinite(low) & np.isfinite(high)
    axes.set_xscale("log", base=2)
    axes.errorbar(
        count[finite],
        100 * value[finite],
        yerr=100 * np.array([(value - low)[finite], (high - value)[finite]]),
        color=MODEL_COLOURS[0],
        marker="o",
        markersize=3.5,
        capsize=2,
        elinewidth=0.8,
    )
    if (~finite).any():
        axes.plot(
            count[~finite],
            100 * value[~finite],
            color=MODEL_COLOURS[0],
            marker="o",
            markersize=3.5,
            mfc="white",
            ls="",
        )
    axes.set_xticks(count, list(map(str, count)))
    axes.minorticks_off()
    return sheet.done("Samples", f"Allowable slip at {float(dataset.attrs['probability']):g} [%]")
