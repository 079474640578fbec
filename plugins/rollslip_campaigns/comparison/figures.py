"""Draw the figures of a comparison: curves, differences and costs of models; slips of alternatives.

Dashes distinguish models here, besides colours; elsewhere a dashed line is the thermal branch only.
"""

from collections.abc import Iterator
from itertools import cycle
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from rollslip.results.curve_figures import measured_values
from rollslip.results.curves import curve_names, curves
from rollslip.results.dataset import xr
from rollslip.results.style import (
    DASHES,
    MARKER,
    MM,
    MODEL_COLOURS,
    SINGLE_COLUMN,
    TWO_COLUMNS,
    Sheet,
    axis_label,
    plain_decades,
)
from rollslip.search import Array
from rollslip_campaigns.comparison.findings import captioned, curves_of, members

__all__ = ["figures", "side_by_side"]

#: Largest relative difference [1] on a linear axis; beyond it the axis is symmetric-logarithmic, so that small
#: differences stay visible. Doubling it makes differences below 1 % hard to read. Chosen.
_MAX_LINEAR_SPREAD = 0.1
#: Difference [%] up to which a symmetric-logarithmic axis is linear; doubling it stretches the linear part. Chosen.
_LINEAR_RANGE = 1.0


def figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Yield name, caption and figure of each curve."""
    names = curve_names(dataset)
    for position, name in enumerate(names):
        caption = f"{captioned(dataset, name)}: combinations of models against {dataset.attrs['reference']}."
        slug = "" if len(names) == 1 else f"-{name.replace(' ', '-')}"
        yield f"comparison{slug}", caption, _comparison(dataset, position)


def side_by_side(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Yield name, caption and figure of the slips of alternatives, if any is known."""
    if np.isfinite(dataset["cage_slip"].to_numpy()).any():
        caption = "Steady cage slip of each alternative, best first, with its 5 to 95 % where data scatter."
        yield "compare", caption, _slips(dataset)


def _slips(dataset: "xr.Dataset") -> "Figure":
    """Return a figure of the slips of alternatives with their bands, and of the acceptable slip."""
    names = dataset["alternative"].to_numpy()
    slip = 100 * dataset["cage_slip"].to_numpy()
    ends = 100 * np.array([dataset[f"cage_slip_{end}"].to_numpy() for end in ("low", "high")])
    sheet = Sheet((SINGLE_COLUMN[0], (18 + 7 * len(names)) * MM))
    axes = sheet.axes
    place = np.arange(len(names))[::-1]
    axes.hlines(place, ends[0], np.minimum(ends[1], 100.0), color=MODEL_COLOURS[0], linewidth=1.4)
    sheet.line(
        slip,
        place,
        "cage slip, 5 to 95 % where data scatter",
        color=MODEL_COLOURS[0],
        linestyle="none",
        **MARKER,
    )
    for row in measured_values(dataset, "cage_slip", ()):
        at = 100.0 * row["measured"]
        sigma = 100.0 * row["standard_uncertainty"]
        axes.axvspan(at - 2.0 * sigma, at + 2.0 * sigma, color="0.5", alpha=0.25, linewidth=0.0)
        axes.axvline(at, color="black", linewidth=0.9)
        sheet.key(f"measured, {at:.3g} %, and 95 %", color="black", linewidth=0.9)
    if acceptable := float(dataset.attrs.get("acceptable_slip", 0.0)):
        style: dict[str, Any] = {"color": "0.35", "linewidth": 0.8, "linestyle": DASHES[2]}
        axes.axvline(100 * acceptable, **style)
        sheet.key(f"acceptable, {100 * acceptable:.3g} %", **style)
    axes.set_yticks(
        place,
        [
            f"{name}  {verdict or 'failed'}"
            for name, verdict in zip(names, dataset["verdict"].to_numpy(), strict=True)
        ],
    )
    axes.set_ylim(-0.6, len(names) - 0.4)
    axes.tick_params(axis="y", length=0)
    axes.set_xlim(left=min(0.0, axes.get_xlim()[0]) if np.nanmin(slip) < 0.0 else 0.0)
    return sheet.done("Cage slip [%]")


def _comparison(dataset: "xr.Dataset", position: int) -> "Figure":
    """Return a figure of all curves with their critical slips, their differences, and the differences over costs."""
    of = curves_of(dataset)
    selected = dataset.isel({of.over: position})
    suffixes = {dataset.attrs["reference"]: ": reference"}
    difference, error, cost = (
        selected[name].to_numpy() for name in ("difference", "rms_error", "cost")
    )
    has_costs = np.count_nonzero(error > 0.0) > 1  # one point needs no panel
    layout = [["curves", "costs"], ["differences", "costs"]]
    widths = {"width_ratios": (3, 2)}
    if not has_costs:
        layout = [["curves"], ["differences"]]
        widths = {}
    sheet = Sheet(
        ((TWO_COLUMNS if has_costs else SINGLE_COLUMN)[0], 100 * MM),
        layout,
        height_ratios=(3, 2),
        **widths,
    )
    panels = sheet.axes
    for k, ((label, member), style) in enumerate(
        zip(members(dataset), _styles(dataset), strict=True)
    ):
        curve = curves(member)[position]
        name = f"{k + 1}  {label}"
        if np.isnan(curve.friction).all():
            sheet.key(f"{name}: failed", linestyle="none")
            continue
        x, y, critical, _ = curve.branches()
        sheet.line(100 * x, y, name + suffixes.get(label, ""), panels["curves"], **style)
        if curve.has_critical:
            panels["curves"].plot(
                100 * x[critical], y[critical], color=style["color"], zorder=4, **MARKER
            )
        panels["differences"].plot(100 * curve.slip, 100 * difference[k], **style)
    cage = of.over == "ring"
    friction = axis_label(dataset[of.variable], r"$\mu_\mathrm{e}$" if cage else r"$\mu$", "–")
    panels["curves"].set(ylabel=friction, ylim=(min(0.0, np.nanmin(selected[of.variable])), None))
    panels["curves"].tick_params(labelbottom=False)
    spread = np.nanmax(abs(difference), initial=0.0) > _MAX_LINEAR_SPREAD
    if spread:
        panels["differences"].set_yscale("symlog", linthresh=_LINEAR_RANGE)
        panels["differences"].yaxis.set_major_formatter("{x:g}")
    beyond = f",\nlog beyond ±{_LINEAR_RANGE:g} %" if spread else ""
    symbol = {"symbol": "$V/u$", "name": "slide–roll ratio"}
    if cage:
        symbol = {"symbol": r"$S_\mathrm{c}$"}
    slip = axis_label(dataset[of.slip], unit="%", **symbol)
    panels["differences"].set(xlabel=slip, ylabel=f"Difference [%]{beyond}")
    for name in ("curves", "differences"):
        panels[name].set_xlim(0.0, 100 * float(selected[of.slip][-1]))
    if has_costs:
        _draw_costs(panels["costs"], error, cost, [style["color"] for style in _styles(dataset)])
    longest = max(len(str(handle.get_label())) for handle in sheet.handles)
    return sheet.done(columns=max(1, min(4, int(140 / (6 + longest)))))


def _draw_costs(axes: Any, error: Array, cost: Array, colours: list[Any]) -> None:
    """Draw errors over costs with the numbers of the combinations; the reference is a line."""
    for k, place in enumerate(zip(cost, 100 * error, strict=True)):
        if place[1] > 0.0:
            axes.plot(*place, marker="o", markersize=5, color=colours[k])
            axes.annotate(
                f"{k + 1}",
                place,
                (5, (0, 6, -6)[k % 3]),
                textcoords="offset points",
                va="center_baseline",
                zorder=5,
            )
        elif place[1] == 0.0:
            axes.axvline(place[0], color="black", linewidth=1.0, zorder=0)
    shown = np.log10(100 * error[error > 0.0])
    for axis in (axes.xaxis, axes.yaxis):
        plain_decades(axis)
    axes.set(
        xlim=(0.8, 1.3 * max(2.0, np.nanmax(cost))),
        ylim=(10 ** np.floor(shown.min(initial=1.0)), 10 ** np.ceil(shown.max(initial=0.0))),
        xlabel="Time for a slice over that of the fastest [–]",
        ylabel="Relative difference, root mean square [%]",
    )


def _styles(dataset: "xr.Dataset") -> list[dict[str, Any]]:
    """Return colour and dashes of each combination: the kind with most models gives colours, the others dashes."""
    kinds = [dataset[kind].to_numpy().tolist() for kind in ("contact", "film", "traction")]
    main = max(kinds, key=lambda names: len(set(names)))
    others = list(zip(*(names for names in kinds if names is not main), strict=True))
    if len(set(others)) == 1:
        others = [(name,) for name in main]
    colours, dashes = (
        dict(zip(dict.fromkeys(names), cycle(styles), strict=False))
        for names, styles in ((main, MODEL_COLOURS), (others, DASHES))
    )
    return [
        {"color": "black", "linewidth": 2.2, "zorder": 1}
        if label == dataset.attrs["reference"]
        else {"color": colours[name], "linestyle": dashes[rest], "linewidth": 1.1}
        for label, name, rest in zip(dataset["combination"].to_numpy(), main, others, strict=True)
    ]
