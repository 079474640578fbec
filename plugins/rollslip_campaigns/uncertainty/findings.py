"""What scattering data do to reserve, slips and loads, in sentences and plain values."""

import json
import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np

from rollslip.results.account import Account, Sheet, Table
from rollslip.results.answer import Answer, Row
from rollslip.results.curves import or_none
from rollslip.results.dataset import UNITS, rows_along
from rollslip.results.table import in_people_s_unit
from rollslip.results.words import format_force, format_plain, format_slip_band, percent, two_digits
from rollslip.units import format_quantity

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["UncertaintyAccount", "allowable", "failed", "margin", "reserve"]

#: What people act on, and what margin and allowable slip are of.
RESERVE: Final = "drag reserve"
STEADY: Final = "steady slip"
LOAD: Final = "minimum load"
#: How heads of columns of inputs begin.
RANKED: Final = "rank correlation with "
SKIDDING: Final = "slip at which skidding begins"
DRAG: Final = "limit drag torque"
#: How well samples know a band: best.
_KNOWN: Final = 3
#: Rank correlation of slip and drag of running away below which the caveat is told.
_AGAINST: Final = -0.3


_NO_INDICES = (
    "no Sobol indices: what was asked for varies in no sample, as where all lie beyond the range, or fewer than four "
    "rows of the design have all their points"
)


def failed(dataset: "xr.Dataset") -> int:
    """Return how many points have no result."""
    points = json.loads(dataset.attrs["points"])
    return sum(
        count for counts in points.values() for status, count in counts.items() if status != "ok"
    )


class UncertaintyAccount(Account):
    """How slips of scattering data are told."""

    units: ClassVar[Mapping[str, str]] = {"probability": "1", "reserve_is_a_lower_bound_in": "1"}
    drawn = ".figures:uncertainty_figures"

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return slip, reserve and load of the samples; of a scene without a cage, where it would run away."""
        every = dataset["quantity"].to_numpy()
        p = float(dataset.attrs["probability"])
        if RESERVE not in every:
            return Answer(
                rows=(
                    Row(
                        key="skidding",
                        label="limit drag torque",
                        text="",
                        note=_describe_skidding(dataset),
                    ),
                )
            )
        low, slip, high = (_quantile(dataset, STEADY, q)[0] for q in (0.05, 0.5, 0.95))
        sure = _quantile(dataset, RESERVE, round(1.0 - p, 12))[0]
        n = int(dataset["samples"].sel(quantity=STEADY))
        skids = float(dataset["skidding"])
        rows = [
            Row(key="cage_slip", label="cage slip", value=slip, band=(low, high), known=_KNOWN, within=math.inf,
                text=percent(slip) if math.isfinite(slip) else "skidding",
                note=f"{format_slip_band(low, high)}; median of {n} samples")
            if not math.isnan(slip)
            else Row(key="cage_slip", label="cage slip", text="not found", note=_steady(dataset)),
            Row(key="drag_reserve", label="reserve to skidding", value=sure, band=(sure, math.inf), known=_KNOWN,
                within=math.inf, text="not found" if math.isnan(sure) else f"at least {two_digits(sure)}",
                note=f"with probability {p:g}; {percent(skids) if skids > 0.0 else 'none'} of the samples skid"),
        ]  # fmt: skip
        if LOAD in every and math.isfinite(load := _quantile(dataset, LOAD, p)[0]):
            below = f"for a slip below {format_plain(100.0 * float(dataset.attrs['acceptable_slip']))} %"
            rows.append(Row(key="minimum_load", label="minimum load", value=load, unit="N", text=format_force(load, load),
                            note=f"{below}, with probability {p:g}", within=math.inf))  # fmt: skip
        return Answer(rows=tuple(rows))

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Return what was found, by what it is about, what people act on first; `sheets` has every quantity."""
        every = list(map(str, dataset["quantity"].to_numpy()))
        found = dict[str, list[str]]()
        if RESERVE in every:
            found |= {RESERVE: [reserve(dataset)], STEADY: [_steady(dataset)]}
        if LOAD in every:
            found[LOAD] = [_load(dataset)]
        found |= {
            "skidding": [_describe_skidding(dataset)],
            "allowable slip": [allowable(dataset), *_caveat(dataset)],
        }
        if "margin" in dataset:
            found["margin"] = [margin(dataset)]
        if rests_on := dataset.attrs.get("curves_with"):
            found["critical slip"] = [f"slips at largest traction are {rests_on}"]
        if "indexed" in dataset.coords:
            of = dataset["indexed"].to_numpy()
            found["indices"] = [_shares(dataset.sel(indexed=name)) for name in of] or [_NO_INDICES]
        return found

    @staticmethod
    def sheets(dataset: "xr.Dataset") -> dict[str, Sheet]:
        """Return a row for each quantity, with its median, its band and what is sure, and one for each input.

        Sure is what slip and load do not pass, and all else does, with the probability that was asked for. Inputs are
        in the order of how much they decide about the first quantity, by rank correlation.
        """
        p = float(dataset.attrs["probability"])
        units = json.loads(dataset["quantity"].attrs.get(UNITS, "{}"))
        head = ["quantity", "unit", "median", "5 %", "95 %", "bound", f"with probability {p:g}", "95 % interval from",
                "95 % interval to", "samples", "beyond the range", "without a value"]  # fmt: skip
        rows = list[list[Any]]()
        for name in map(str, dataset["quantity"].to_numpy()):
            most = name in (STEADY, LOAD)
            sure = _quantile(dataset, name, p if most else round(1.0 - p, 12))
            values = (
                *(_quantile(dataset, name, fraction)[0] for fraction in (0.5, 0.05, 0.95)),
                *sure,
            )
            unit, shown = in_people_s_unit(name, values, units.get(name, "1"))
            counts = [
                int(dataset[word].sel(quantity=name)) for word in ("samples", "beyond", "unknown")
            ]
            rows.append(
                [name, unit, *shown[:3], "at most" if most else "at least", *shown[3:], *counts]
            )
        ranks = dataset["rank_correlation"]
        order = np.argsort(-np.abs(np.nan_to_num(ranks.to_numpy()[:, 0])), kind="stable")
        of = [[str(ranks["input"][k].item()), *map(or_none, ranks[k].to_numpy())] for k in order]
        return {
            "": (head, rows),
            "-inputs": (["input", *(f"{RANKED}{name}" for name in dataset["acted"].values)], of),
        }

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return a row for each quantity, those that people act on first, and one for each input."""

        def told(*values: float | None) -> str:
            return " to ".join("-" if value is None else two_digits(value) for value in values)

        (head, rows), (inputs, ranks) = self.sheets(dataset).values()
        shown = [
            [
                f"{name} [{unit}]" if unit else name,
                told(middle),
                told(low, high),
                f"{sure} {told(bound)}",
                told(*ends),
            ]
            for name, unit, middle, low, high, sure, bound, *ends, _, _, _ in rows
            if any(value is not None for value in (middle, low, high, bound, *ends))
        ]
        decides = [
            [name, *("-" if rank is None else f"{rank:+.2f}" for rank in of)] for name, *of in ranks
        ]
        of = [name.removeprefix(RANKED) for name in inputs]
        return [
            Table(
                "quantities, - where one is beyond its range or not known",
                ("quantity", "median", "5 to 95 %", head[6], "95 % interval of that"),
                shown,
            ),
            Table("what decides, by rank correlation with", tuple(of), decides),
        ]

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return what was found as plain values; what the samples cannot tell is null."""
        units = json.loads(dataset["quantity"].attrs.get(UNITS, "{}"))
        inputs = dataset["input"].to_numpy().tolist()
        quantities = {
            one["quantity"]: {
                "unit": units.get(one["quantity"], "1"),
                "samples": one["samples"],
                "known": one["known"],
                "beyond_the_range": one["beyond"],
                "unknown": one["unknown"],
                "quantiles": [
                    {"probability": row["probability"]}
                    | {end: or_none(row[f"quantile_{end}"]) for end in ("value", "low", "high")}
                    for row in rows_along(dataset.isel(quantity=k), "probability")
                ],
            }
            for k, one in enumerate(rows_along(dataset, "quantity"))
        }
        found: dict[str, Any] = {
            "probability": float(dataset.attrs["probability"]),
            "allowable_slip": _ends(dataset, "allowable", "_slip") | {"status": allowable(dataset)},
            "margin": _ends(dataset, "margin") if "margin" in dataset else None,
            "skidding": _ends(dataset, "skidding") if "skidding" in dataset else None,
            "reserve_is_a_lower_bound_in": int(dataset["bounded"])
            if "bounded" in dataset
            else None,
            "rank_correlation": {
                str(name): dict(zip(inputs, map(or_none, ranks), strict=True))
                for name, ranks in zip(
                    dataset["acted"].values, dataset["rank_correlation"].values.T, strict=True
                )
            },
            "points": json.loads(dataset.attrs["points"]),
            "quantities": quantities,
        }
        if "indexed" in dataset.coords:
            found["indices"] = {
                str(name): {
                    key: {
                        order: _ends(dataset.sel(indexed=name, input=key), order)
                        for order in ("first_order", "total_order")
                    }
                    for key in inputs
                }
                for name in dataset["indexed"].to_numpy()
            }
        return found


def _ends(dataset: "xr.Dataset", name: str, suffix: str = "") -> dict[str, float | None]:
    names = {"value": f"{name}{suffix}", "low": f"{name}_low", "high": f"{name}_high"}
    return {what: or_none(dataset[variable]) for what, variable in names.items()}


def _quantile(dataset: "xr.Dataset", name: str, probability: float) -> tuple[float, float, float]:
    """A quantile of what people act on, and the ends of its interval."""
    one = dataset.sel(quantity=name, probability=probability)
    value, low, high = (float(one[f"quantile_{end}"]) for end in ("value", "low", "high"))
    return value, low, high


def _told(dataset: "xr.Dataset", name: str, shown: Callable[[float], str]) -> str:
    """Median and band of what people act on, in words."""
    low, middle, high = (_quantile(dataset, name, p)[0] for p in (0.05, 0.5, 0.95))
    return f"median {shown(middle)}, 5 to 95 %: {shown(low)} to {shown(high)}"


def _interval(
    dataset: "xr.Dataset", low: float, high: float, shown: Callable[[float], str], name: str
) -> str:
    n = int(dataset["samples"].sel(quantity=name))
    if math.isinf(low) and low < 0.0:
        return f"{n} samples are too few to tell how much less it may be"
    if math.isinf(high) and name != RESERVE and not math.isinf(low):
        return f"95 % interval: from {shown(low)} on, {n} samples"
    return f"95 % interval: {shown(low)} to {shown(high)}, {n} samples"


def reserve(dataset: "xr.Dataset") -> str:
    """Say how many times the drags of the scene the rollers carry at least, and how many samples skid."""
    p = float(dataset.attrs["probability"])
    n = int(dataset["samples"].sel(quantity=RESERVE))
    value, low, high = _quantile(dataset, RESERVE, round(1.0 - p, 12))
    if math.isnan(value):
        return f"the drag reserve is not known: none of {n} samples has one"
    said = (
        f"the rollers carry at least {_times(value)} the drag of the scene, with probability {p:g}"
    )
    said += (
        f" ({_interval(dataset, low, high, _times, RESERVE)}); {_told(dataset, RESERVE, _times)}"
    )
    bounded = int(dataset["bounded"])
    if bounded:
        said += f"; in {bounded} of {n} samples there is no skidding in the range, and the reserve is a lower bound"
    skids, least, most = (float(dataset[f"skidding{end}"]) for end in ("", "_low", "_high"))
    if not skids > 0.0:
        return said
    return f"{said}; in {_percent(skids)} of the samples the cage skids ({_percent(least)} to {_percent(most)})"


def _steady(dataset: "xr.Dataset") -> str:
    """Say how much the cage slips, and below what it stays."""
    p = float(dataset.attrs["probability"])
    value, low, high = _quantile(dataset, STEADY, p)
    if math.isnan(value):
        return "the steady slip is not known: no sample has one"
    ends = _interval(dataset, low, high, _percent, STEADY)
    most = f"below {_percent(value)}" if math.isfinite(value) else "not below any in the range"
    said = f"the cage slips by {_told(dataset, STEADY, _percent)}; {most} with probability {p:g} ({ends})"
    acceptable = dataset.attrs.get("acceptable_slip", "")
    if acceptable == "":
        return said
    slips = dataset["value"].sel(quantity=STEADY).to_numpy()
    above = float(np.mean(np.abs(slips[~np.isnan(slips)]) > float(acceptable)))
    return f"{said}; the acceptable {_percent(float(acceptable))} is passed in {_percent(above)} of the samples"


def _load(dataset: "xr.Dataset") -> str:
    """Say which radial load keeps the slip acceptable."""
    p = float(dataset.attrs["probability"])
    value, low, high = _quantile(dataset, LOAD, p)
    if math.isnan(value):
        return "the minimum load is not known: no sample has one"
    slip = _percent(float(dataset.attrs["acceptable_slip"]))
    ends = _interval(dataset, low, high, _force, LOAD)
    return (
        f"a radial load of {_force(value)} keeps the slip below {slip} with probability {p:g} ({ends}); "
        f"{_told(dataset, LOAD, _force)}"
    )


def _caveat(dataset: "xr.Dataset") -> list[str]:
    rho = float(dataset["strength_correlation"]) if "strength_correlation" in dataset else math.nan
    if not rho < _AGAINST:
        return []
    return [
        "this slip ranks oils the wrong way round: where skidding begins at a small slip the limit drag torque is "
        f"large (rank correlation of slip and drag there {rho:.2f}); use the reserve"
    ]


def _describe_skidding(dataset: "xr.Dataset") -> str:
    """Say where the cage runs away: slip and drag, medians with their spread."""
    low, middle, high = (_quantile(dataset, SKIDDING, p)[0] for p in (0.05, 0.5, 0.95))
    if math.isnan(middle):
        return "no sample says where skidding begins"
    if math.isinf(middle):
        beyond = int(dataset["beyond"].sel(quantity=SKIDDING))
        n = int(dataset["samples"].sel(quantity=SKIDDING))
        return f"no skidding was found in {beyond} of {n} samples up to the end of the range"
    least, mean, most = (_torque(_quantile(dataset, DRAG, p)[0]) for p in (0.05, 0.5, 0.95))
    return (
        f"skidding begins at a cage slip of {_percent(middle)}, limit drag torque {mean} "
        f"(medians; 5 to 95 %: {_percent(low)} to {_percent(high)}, {least} to {most})"
    )


def allowable(dataset: "xr.Dataset") -> str:
    """Say up to which slip a cage does not skid, with the probability that was asked for."""
    value, low, high = (float(dataset[f"allowable{end}"]) for end in ("_slip", "_low", "_high"))
    p = float(dataset.attrs["probability"])
    n = int(dataset["samples"].sel(quantity=SKIDDING))
    if math.isnan(value):
        return f"the allowable slip is not known: none of {n} samples says where skidding begins"
    few = (
        f"{n} samples are too few to tell how much less it may be, which takes {dataset.attrs['min_samples']} and "
        "more where all points have a result"
    )
    if value == math.inf:
        end = (
            f", {_percent(float(dataset.attrs['slip_range']))}"
            if "slip_range" in dataset.attrs
            else ""
        )
        what = f"the allowable slip lies beyond the range of slips{end}: so does the {SKIDDING} with probability {p:g}"
        sure = "beyond the range too" if low == math.inf else f"from {_percent(low)} on"
        sure = f"; {few}" if low == -math.inf else f" (95 % interval: {sure}, {n} samples)"
        return f"{what}{sure}{dataset.attrs.get('search_range_hint', '')}"
    what = f"a cage that slips by at most {_percent(value)} does not skid, with probability {p:g}"
    if low == -math.inf:
        return f"{what}; {few}"
    # a high end is infinite where samples beyond the range say so: failed ones leave the low end unknown first
    return f"{what} (95 % interval of this slip: {_percent(low)} to {_percent(high)}, {n} samples)"


def margin(dataset: "xr.Dataset") -> str:
    """Return the probability that the steady slip is below that at which skidding begins, in a sentence."""
    value, low, high = (float(dataset[f"margin{end}"]) for end in ("", "_low", "_high"))
    n = int(dataset["samples"].sel(quantity="steady slip"))
    if math.isnan(value):
        return f"none of {n} samples has both a steady slip and one at which skidding begins"
    return (
        f"the cage runs below the slip at which skidding begins with probability {value:.4g} "
        f"(95 % interval: {low:.4g} to {high:.4g}, {n} samples)"
    )


def _shares(one: "xr.Dataset") -> str:
    inputs = rows_along(one, "input")
    parts = [
        "{input} {total_order:.2f} ({total_order_low:.2f} to {total_order_high:.2f})".format(
            **inputs[k]
        )
        for k in np.argsort(-one["total_order"].to_numpy())
    ]
    beyond = int(one["indexed_beyond"])
    said = f"; {beyond} samples beyond the range count as at its end" if beyond else ""
    used = int(one["indexed_rows"])
    requested = int(one["indexed_requested"])
    if used < requested:
        said += (
            f"; made of {used} of {requested} rows, the largest power of two of those without a gap"
        )
    return f"share of the variance of {one['indexed'].item()}, total Sobol index: {', '.join(parts)}{said}"


def _torque(value: float) -> str:
    return format_quantity(value, "N m", 3) if math.isfinite(value) else "beyond the range"


def _times(value: float) -> str:
    return f"{value:.3g} times" if math.isfinite(value) else "without limit"


def _force(value: float) -> str:
    return format_quantity(value, "N", 3) if math.isfinite(value) else "more than any"


def _percent(fraction: float) -> str:
    return f"{100 * fraction:.3g} %" if math.isfinite(fraction) else "more than the range"


ACCOUNT: Final = UncertaintyAccount("uncertainty")
