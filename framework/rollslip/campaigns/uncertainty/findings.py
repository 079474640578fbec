"""What scattering data do to slips, in sentences and plain values."""

import json
import math
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rollslip.units import format_quantity

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["failed", "headline", "margin", "record", "sentences", "topics"]

#: What margin and allowable slip are of.
RUNAWAY: Final = "slip of running away"


_NO_INDICES = (
    "no Sobol indices: what was asked for varies in no sample, as where all lie beyond the range, or fewer than four "
    "rows of the design have all their points"
)


def failed(dataset: "xr.Dataset") -> int:
    """Return how many points have no result."""
    points = json.loads(dataset.attrs["points"])
    return sum(count for counts in points.values() for status, count in counts.items() if status != "ok")


def sentences(dataset: "xr.Dataset") -> list[str]:
    """Return what was found, line by line: allowable slip, margin, distributions, indices."""
    return [line for lines in topics(dataset).values() for line in lines]


def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
    """Return what was found, by what it is about."""
    found = {"running away": [headline(dataset)], "allowable slip": [_allowable(dataset)]}
    if "margin" in dataset:
        found["margin"] = [margin(dataset)]
    found["distributions"] = [_distribution(dataset.sel(quantity=name)) for name in dataset["quantity"].to_numpy()]
    if "indexed" in dataset.coords:
        of = dataset["indexed"].to_numpy()
        found["indices"] = [_shares(dataset.sel(indexed=name)) for name in of] or [_NO_INDICES]
    return found


def record(dataset: "xr.Dataset") -> dict[str, Any]:
    """Return what was found as plain values; what the samples cannot tell is null."""
    quantities = {
        str(name): {
            "samples": int(one["samples"]),
            "known": int(one["known"]),
            "beyond_the_range": int(one["beyond"]),
            "unknown": int(one["unknown"]),
            "quantiles": [
                {
                    "probability": float(p),
                    "value": _plain(one["quantile_value"].to_numpy()[k]),
                    "low": _plain(one["quantile_low"].to_numpy()[k]),
                    "high": _plain(one["quantile_high"].to_numpy()[k]),
                }
                for k, p in enumerate(one["probability"].to_numpy())
            ],
        }
        for name, one in ((name, dataset.sel(quantity=name)) for name in dataset["quantity"].to_numpy())
    }
    found: dict[str, Any] = {
        "probability": float(dataset.attrs["probability"]),
        "allowable_slip": _ends(dataset, "allowable", "_slip") | {"status": _allowable(dataset)},
        "margin": _ends(dataset, "margin") if "margin" in dataset else None,
        "points": json.loads(dataset.attrs["points"]),
        "quantities": quantities,
    }
    if "indexed" in dataset.coords:
        found["indices"] = {
            str(name): {
                str(key): {order: _ends(one.sel(input=key), order) for order in ("first_order", "total_order")}
                for key in dataset["input"].to_numpy()
            }
            for name, one in ((name, dataset.sel(indexed=name)) for name in dataset["indexed"].to_numpy())
        }
    return found


def _ends(dataset: "xr.Dataset", name: str, suffix: str = "") -> dict[str, float | None]:
    names = {"value": f"{name}{suffix}", "low": f"{name}_low", "high": f"{name}_high"}
    return {what: _plain(dataset[variable]) for what, variable in names.items()}


def _plain(value: Any) -> float | None:
    return float(value) if math.isfinite(value) else None


def headline(dataset: "xr.Dataset") -> str:
    """Say where the cage runs away: slip and drag, medians with their spread."""
    slip = dataset["quantile_value"].sel(quantity=RUNAWAY)
    drag = dataset["quantile_value"].sel(quantity="drag of running away")
    low, middle, high = (float(slip.sel(probability=p)) for p in (0.05, 0.5, 0.95))
    if math.isnan(middle):
        return "no sample says where the cage runs away"
    if math.isinf(middle):
        beyond, n = int(dataset["beyond"].sel(quantity=RUNAWAY)), int(dataset["samples"].sel(quantity=RUNAWAY))
        return f"the cage was not found to run away in {beyond} of {n} samples up to the end of the range"
    least, mean, most = (_torque(float(drag.sel(probability=p))) for p in (0.05, 0.5, 0.95))
    return (
        f"the cage runs away at {_percent(middle)} cage slip, at a drag of {mean} "
        f"(medians; 5 to 95 %: {_percent(low)} to {_percent(high)}, {least} to {most})"
    )


def _allowable(dataset: "xr.Dataset") -> str:
    value, low, high = (float(dataset[f"allowable{end}"]) for end in ("_slip", "_low", "_high"))
    p, n = float(dataset.attrs["probability"]), int(dataset["samples"].sel(quantity=RUNAWAY))
    if math.isnan(value):
        return f"the allowable slip is not known: none of {n} samples says where the cage runs away"
    few = (
        f"{n} samples are too few to tell how much less it may be, which takes {dataset.attrs['fewest_samples']} and "
        "more where all points have a result"
    )
    if value == math.inf:
        end = f", {_percent(float(dataset.attrs['slip_range']))}" if "slip_range" in dataset.attrs else ""
        what = f"the allowable slip lies beyond the range of slips{end}: so does the {RUNAWAY} with probability {p:g}"
        sure = "beyond the range too" if low == math.inf else f"from {_percent(low)} on"
        sure = f"; {few}" if low == -math.inf else f" (95 % interval: {sure}, {n} samples)"
        return f"{what}{sure}{dataset.attrs.get('look_further', '')}"
    what = f"a cage that slips by at most {_percent(value)} does not run away, with probability {p:g}"
    if low == -math.inf:
        return f"{what}; {few}"
    # a high end is infinite where samples beyond the range say so: failed ones leave the low end unknown first
    return f"{what} (95 % interval of this slip: {_percent(low)} to {_percent(high)}, {n} samples)"


def margin(dataset: "xr.Dataset") -> str:
    """Return the probability that the steady slip is below that of running away, in a sentence."""
    value, low, high = (float(dataset[f"margin{end}"]) for end in ("", "_low", "_high"))
    n = int(dataset["samples"].sel(quantity="steady slip"))
    if math.isnan(value):
        return f"none of {n} samples tells both the steady slip and that of running away"
    return (
        f"the cage runs below the slip at which it runs away with probability {value:.4g} "
        f"(95 % interval: {low:.4g} to {high:.4g}, {n} samples)"
    )


def _distribution(one: "xr.Dataset") -> str:
    counts = {word: int(one[word]) for word in ("beyond", "unknown")}
    words = {"beyond": "beyond the range or without end", "unknown": "without a value"}
    said = "".join(f", {count} {words[word]}" for word, count in counts.items() if count)
    name = str(one["quantity"].item())
    shown_as = name + (f" {one.attrs['curves_with']}" if name.startswith("critical slip") else "")
    if not int(one["known"]):
        return f"{shown_as}: no values{said}"
    shown = _percent if "slip" in name else _torque if "drag" in name else lambda value: f"{value:.4g}"
    low, middle, high = (one["quantile_value"].sel(probability=p).item() for p in (0.05, 0.5, 0.95))
    of = " of those with one" if counts["unknown"] else ""  # the others may lie anywhere
    spread = f"median{of} {shown(middle)}, 5 to 95 %: {shown(low)} to {shown(high)}"
    return f"{shown_as}: {spread}; {int(one['known'])} values{said}"


def _shares(one: "xr.Dataset") -> str:
    order = np.argsort(-one["total_order"].to_numpy())
    parts = [
        f"{one['input'].to_numpy()[k]} {one['total_order'].to_numpy()[k]:.2f} "
        f"({one['total_order_low'].to_numpy()[k]:.2f} to {one['total_order_high'].to_numpy()[k]:.2f})"
        for k in order
    ]
    beyond = int(one["indexed_beyond"])
    said = f"; {beyond} samples beyond the range count as at its end" if beyond else ""
    used, asked = int(one["indexed_rows"]), int(one["indexed_asked"])
    if used < asked:
        said += f"; made of {used} of {asked} rows, the largest power of two of those without a gap"
    return f"share of the variance of {one['indexed'].item()}, total Sobol index: {', '.join(parts)}{said}"


def _torque(value: float) -> str:
    return format_quantity(value, "N m", 3) if math.isfinite(value) else "beyond the range"


def _percent(share: float) -> str:
    return f"{100 * share:.3g} %" if math.isfinite(share) else "more than the range"
