"""Figures of sweeps: critical slip over two quantities for several models, and models against the scatter of the data.

Style, sizes and files are those of `rollslip.results.style`. A map has one panel for each model and one scale of
colours for all; where there is no critical slip in the range it is hatched. Models on samples of uncertain data are
told by quantiles: if the scatter within a model is wider than the distance between them, better data tell more than
better models.
"""

import json
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from rollslip.campaigns.sweep.findings import resting
from rollslip.results.style import MM, MODEL_COLOURS, ONE_COLUMN, light_to_dark

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["models_apart", "sweep_figures"]

Array = NDArray[np.float64]
#: What is drawn: the inner ring, on which film heating lets friction fall first.
_RESULT: Final = "critical_cage_slip"
_PANELS: Final = 4
_QUANTILES: Final = (0.05, 0.25, 0.5, 0.75, 0.95)
#: Unit -> unit on an axis and its size.
_SHOWN: Final = {"rad/s": ("rpm", 30.0 / np.pi), "Pa": ("MPa", 1e-6)}


def sweep_figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Draw the figures; give name, caption and figure of those for which the sweep has the points."""
    if _RESULT not in dataset or "ring" not in dataset.dims:
        return
    keys = list(json.loads(dataset.attrs["axes"]))
    numbers = [key for key in keys if dataset[key].dtype.kind in "fi" and dataset.sizes[key] > 1]
    choices = [key for key in keys if dataset[key].dtype.kind not in "fi"]
    if any(key not in (*numbers, *choices) for key in keys) or len(choices) > 1:
        return
    values = dataset[_RESULT].sel(ring="inner")
    sampled = "sample" in dataset.dims
    if len(numbers) == 2 and not sampled and all(dataset.sizes[key] <= _PANELS for key in choices):
        caption = (
            f"Critical cage slip of the inner ring{resting(dataset)} over {numbers[0]} and {numbers[1]}; hatched where "
            "there is none in the range, or its point failed."
        )
        yield "sweep-map", caption, _map(values, numbers, choices)
    if sampled and choices and not numbers:
        yield "sweep-models", models_apart(dataset), _models(values, choices[0])


def models_apart(dataset: "xr.Dataset") -> str:
    """Say how far models are apart, and how far data that scatter move one of them."""
    (key,) = json.loads(dataset.attrs["axes"])
    quantiles = _quantiles(dataset[_RESULT].sel(ring="inner"), key)
    medians = quantiles[:, 2]
    beyond, known = np.isinf(medians), np.isfinite(quantiles[:, [1, 3]]).all(axis=1)
    if beyond.any():
        apart = f"the medians of {beyond.sum()} are not known"
    else:
        apart = f"the medians are up to {100 * np.ptp(medians):.2g} percentage points apart"
    if known.all():
        scatter = f"the middle half of one is up to {100 * (quantiles[:, 3] - quantiles[:, 1]).max():.2g} wide"
    else:
        scatter = f"the middle half of {(~known).sum()} ends beyond the range"
    return (
        f"Critical cage slip of the inner ring{resting(dataset)} for {len(quantiles)} choices of {key}: median, middle "
        "half, and 5 to 95 % of the samples (100 % where they lie beyond the range, or their point failed): "
        f"{apart}, {scatter}."
    )


def _quantiles(values: "xr.DataArray", key: str) -> Array:
    """Quantiles of every choice, (n, 5); a critical slip that is not in the range lies beyond it."""
    rows = values.transpose(key, "sample").to_numpy()
    filled = np.where(np.isnan(rows), np.inf, rows)
    return np.quantile(filled, _QUANTILES, axis=1, method="inverted_cdf").T


def _models(values: "xr.DataArray", key: str) -> "Figure":
    from matplotlib.figure import Figure

    names, quantiles = values[key].to_numpy(), 100 * np.minimum(_quantiles(values, key), 1.0)
    figure = Figure(figsize=(ONE_COLUMN[0], (22 + 7 * len(names)) * MM), layout="constrained")
    axes = figure.subplots()
    for k, (low, first, middle, third, high) in enumerate(quantiles):
        place = len(names) - 1 - k
        axes.plot([low, high], [place, place], color=MODEL_COLOURS[0], linewidth=1.0, zorder=1)
        axes.barh(place, third - first, 0.5, left=first, color=MODEL_COLOURS[0], alpha=0.45, zorder=2)
        axes.plot(middle, place, marker="|", markersize=11, markeredgewidth=1.6, color="black", zorder=3)
    axes.set_yticks(np.arange(len(names))[::-1], [str(name) for name in names])
    axes.set_ylim(-0.6, len(names) - 0.4)
    axes.tick_params(axis="y", length=0)
    axes.set_xlabel("Critical cage slip [%]")
    return figure


def _map(values: "xr.DataArray", numbers: Sequence[str], choices: Sequence[str]) -> "Figure":
    from matplotlib.figure import Figure

    pieces = [(str(name), values.sel({key: name})) for key in choices for name in values[key].to_numpy()]
    pieces = pieces or [("", values)]
    figure = Figure(figsize=((32 + 46 * len(pieces)) * MM, 58 * MM), layout="constrained")
    panels = figure.subplots(1, len(pieces), sharey=True, squeeze=False)[0]
    percent = 100 * values.to_numpy()
    known = percent[np.isfinite(percent)]
    limits: dict[str, Any] = {"vmin": known.min(), "vmax": known.max()} if known.size else {}
    mesh: Any = None
    for axes, (name, piece) in zip(panels, pieces, strict=True):
        axes.set_facecolor("0.9")
        (x, across), (y, up) = _axis(piece[numbers[0]]), _axis(piece[numbers[1]])
        slips = 100 * piece.transpose(numbers[1], numbers[0]).to_numpy()
        mesh = axes.pcolormesh(x, y, slips, cmap=light_to_dark(), shading="nearest", **limits)
        mesh.set_edgecolor("face")
        _hatch(axes)
        axes.set_title(name)
        axes.set_xlabel(across)
        if axes is panels[0]:
            axes.set_ylabel(up)
    bar = figure.colorbar(mesh, ax=list(panels), label="Critical cage slip [%]")
    bar.solids.set_edgecolor("face")  # type: ignore[union-attr]  # no seams
    return figure


def _hatch(axes: "Axes") -> None:
    """Hatch the background, which is seen where there is no value."""
    axes.patch.set_hatch("////")
    axes.patch.set_edgecolor("0.7")


def _axis(coordinate: "xr.DataArray") -> tuple[Array, str]:
    unit, size = _SHOWN.get(coordinate.attrs["units"], (coordinate.attrs["units"], 1.0))
    name = str(coordinate.name).rpartition(".")[2].replace("_", " ")
    return size * coordinate.to_numpy(), f"{name[0].upper()}{name[1:]} [{unit}]"
