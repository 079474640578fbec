"""Report the results of scattering data: drag reserve, slips and loads as sentences, tables and plain values."""

import json
import math
import shlex
from collections.abc import Mapping
from typing import Any, ClassVar, Final

import numpy as np

from rollslip.results.account import Account, SpreadsheetRows, Table
from rollslip.results.answer import Answer, Row
from rollslip.results.curves import or_none
from rollslip.results.dataset import UNITS, rows_along, xr
from rollslip.results.table import in_shown_unit
from rollslip.results.text import (
    Status,
    format_force,
    format_plain,
    format_slip_band,
    percent,
    short_label,
    two_digits,
)
from rollslip.units import format_quantity

__all__ = ["UncertaintyAccount", "describe_margin", "describe_quantity"]

#: Names of the quantities, values of the coordinate "quantity"; users act on the first three.
RESERVE: Final = "drag reserve"
STEADY: Final = "steady slip"
LOAD: Final = "minimum load"
#: Quantity of which the allowable slip is a quantile.
SKIDDING: Final = "slip at which skidding begins"
DRAG: Final = "limit drag torque"
#: Quantity -> its SI unit, where it has one.
QUANTITY_UNITS: Final = {LOAD: "N", DRAG: "N m"}
#: Quantity -> text of an infinite value, where it is not a slip.
_INFINITE: Final = {RESERVE: "without limit", LOAD: "more than any", DRAG: "beyond the range"}
#: Quantities that are to be small: their bound is an upper one. Every other quantity is to be at least its bound.
_UPPER: Final = (STEADY, LOAD)
#: Quantity -> sentence on its bound.
_SENTENCES: Final = {
    RESERVE: "the rollers carry at least {bound} the drag of the scene",
    STEADY: "the cage slips by up to {bound}",
    LOAD: "the slip is acceptable from a radial load of {bound} on",
    SKIDDING: "the cage does not skid up to a slip of {bound}",
}
#: Prefix of the column heads in the sheet of inputs.
RANKED: Final = "rank correlation with "
#: Rank (`rollslip.results.answer.Row.rank`) of a band that comes from samples: of several results about one quantity
#: the answer shows the one with the highest rank. Only the order of ranks matters.
_ANSWER_RANK: Final = 3
#: Rank correlation of skidding slip and limit drag below which a caveat is added to the allowable slip: closer to zero
#: adds it for weak correlations, -0.6 only for strong ones. Chosen: of 64 samples -0.3 is significant.
_CAVEAT_CORRELATION: Final = -0.3


#: Ratio of a median to the value of the run from which both are told apart. Chosen: a change of the second digit.
_DIFFERS: Final = 1.1
#: Size of a rank correlation with the slip above which a quantity is listed as deciding. Chosen: twice the standard
#: error of 128 independent samples.
_MIN_RANK: Final = 0.18
#: Number of quantities that are listed as deciding. Chosen: what fits in a line.
_MAX_DECIDING: Final = 3
#: Sentence where Sobol indices were requested and no result has any.
_NO_INDICES = (
    "no Sobol indices: the result varies in no sample, for example because all lie beyond the range, or fewer than "
    "four rows of the design have all their points"
)


class UncertaintyAccount(Account):
    """Report of the campaign ``uncertainty``."""

    units: ClassVar[Mapping[str, str]] = {"probability": "1", "reserve_is_a_lower_bound_in": "1"}
    figures_function = ".figures:uncertainty_figures"

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return slip, reserve and load of the samples; for a scene without a cage, where skidding would begin."""
        quantities = dataset["quantity"].to_numpy()
        p = float(dataset.attrs["probability"])
        if RESERVE not in quantities:
            return Answer(summary=_describe_skidding_onset(dataset), assumed=_scatter_note(dataset))
        low, slip, high = (_quantile(dataset, STEADY, q)[0] for q in (0.05, 0.5, 0.95))
        lower_reserve = _quantile(dataset, RESERVE, round(1.0 - p, 12))[0]
        skids = float(dataset["skidding"])
        reserve = _quantile(dataset, RESERVE, 0.5)[0]
        nominal_reserve = _nominal_note(dataset, RESERVE, reserve)
        rows = [
            Row(
                key="cage_slip",
                label="cage slip",
                value=slip,
                band=(low, high),
                rank=_ANSWER_RANK,
                tolerance=math.inf,
                text=percent(slip) if math.isfinite(slip) else "skidding",
                note=f"{format_slip_band(low, high)}; median of {int(dataset['samples'].sel(quantity=STEADY))} samples"
                f"{_nominal_note(dataset, STEADY, slip)}"
                + ", without play"
                * _has_unknown_play(dataset),
            )
            if not math.isnan(slip)
            else Row(
                key="cage_slip",
                label="cage slip",
                text="not found",
                note=describe_quantity(dataset, STEADY),
            ),
            Row(
                key="drag_reserve",
                label="reserve to skidding",
                value=lower_reserve,
                band=(lower_reserve, math.inf),
                rank=_ANSWER_RANK,
                tolerance=math.inf,
                text="not found"
                if math.isnan(lower_reserve)
                else f"at least {two_digits(lower_reserve)}",
                note=f"with probability {p:g}; {percent(skids) if skids > 0.0 else 'none'} of the samples skid"
                + f"; median {two_digits(reserve)}{nominal_reserve}" * bool(nominal_reserve),
            ),
        ]
        if LOAD in quantities and math.isfinite(load := _quantile(dataset, LOAD, p)[0]):
            below = f"for a slip below {format_plain(100.0 * float(dataset.attrs['acceptable_slip']))} %"
            rows.append(
                Row(
                    key="minimum_load",
                    label="minimum load",
                    value=load,
                    unit="N",
                    text=format_force(load, load),
                    note=f"{below}, with probability {p:g}",
                    tolerance=math.inf,
                )
            )
        deciding = _deciding_inputs(dataset)
        if deciding:
            (key, rank), *others = deciding
            texts = [f"{short_label(key)} (rank correlation)"]
            texts += [f"{short_label(other)} {weight:+.2f}" for other, weight in others]
            rows.append(
                Row(
                    key="deciding_inputs",
                    label="decides the slip",
                    text=f"{rank:+.2f}",
                    note=", ".join(texts),
                )
            )
        return Answer(
            summary=_summarise_slip(dataset),
            rows=tuple(rows),
            assumed=_scatter_note(dataset),
            next=tuple(_next_steps(dataset, deciding)),
        )

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Return sentences by topic; the quantities that users act on come first. `sheets` has every quantity."""
        quantities = list(map(str, dataset["quantity"].to_numpy()))
        topics = dict[str, list[str]]()
        if RESERVE in quantities:
            topics |= {
                RESERVE: [describe_quantity(dataset, RESERVE), *_describe_lower_bounds(dataset)],
                STEADY: [describe_quantity(dataset, STEADY), *_describe_acceptable(dataset)],
            }
        if LOAD in quantities:
            topics[LOAD] = [describe_quantity(dataset, LOAD)]
        topics |= {
            "skidding": [_describe_skidding_onset(dataset)],
            "allowable slip": [describe_quantity(dataset, SKIDDING), *_caveat(dataset)],
        }
        if "margin" in dataset:
            topics["margin"] = [describe_margin(dataset)]
        if scatter := dataset.attrs.get("scatter", ""):
            topics["scatter"] = [
                f"the scene has no table [uncertainty]; the scatter is that of its data and models: {scatter}"
            ]
        closure = dataset.attrs.get("curves_with")
        if closure and "critical slip" in quantities:
            topics["critical slip"] = [f"slips at largest traction are {closure}"]
        if "indexed" in dataset.coords:
            topics["indices"] = [
                _describe_indices(dataset.sel(indexed=name))
                for name in dataset["indexed"].to_numpy()
            ] or [_NO_INDICES]
        return topics

    @staticmethod
    def sheets(dataset: "xr.Dataset") -> dict[str, SpreadsheetRows]:
        """Return a row for each quantity, with its median, its band and its bound, and a row for each input.

        The bound holds with the requested probability: slip and load are at most their bound, every other quantity is
        at least its bound. Inputs are ordered by the size of their rank correlation with the first quantity.
        """
        p = float(dataset.attrs["probability"])
        units = json.loads(dataset["quantity"].attrs.get(UNITS, "{}"))
        head = [
            "quantity",
            "unit",
            "median",
            "5 %",
            "95 %",
            "bound",
            f"with probability {p:g}",
            "95 % interval from",
            "95 % interval to",
            "samples",
            "beyond the range",
            "without a value",
        ]
        rows = list[list[Any]]()
        for name in map(str, dataset["quantity"].to_numpy()):
            is_upper = name in _UPPER
            values = (
                *(_quantile(dataset, name, fraction)[0] for fraction in (0.5, 0.05, 0.95)),
                *_quantile(dataset, name, p if is_upper else round(1.0 - p, 12)),
            )
            unit, shown = in_shown_unit(name, values, units.get(name, "1"))
            counts = [
                int(dataset[variable].sel(quantity=name))
                for variable in ("samples", "beyond", "unknown")
            ]
            rows.append(
                [name, unit, *shown[:3], "at most" if is_upper else "at least", *shown[3:], *counts]
            )
        ranks = dataset["rank_correlation"]
        order = np.argsort(-np.abs(np.nan_to_num(ranks.to_numpy()[:, 0])), kind="stable")
        return {
            "": (head, rows),
            "-inputs": (
                ["input", *(f"{RANKED}{name}" for name in dataset["acted"].values)],
                [
                    [str(ranks["input"][k].item()), *map(or_none, ranks[k].to_numpy())]
                    for k in order
                ],
            ),
        }

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return a table of the quantities, those that users act on first, and a table of the inputs."""

        def format_band(*values: float | None) -> str:
            return " to ".join("-" if value is None else two_digits(value) for value in values)

        (head, rows), (inputs, ranks) = self.sheets(dataset).values()
        shown = [
            [
                f"{name} [{unit}]" if unit else name,
                format_band(median),
                format_band(low, high),
                f"{side} {format_band(bound)}",
                format_band(*interval),
            ]
            for name, unit, median, low, high, side, bound, *interval, _, _, _ in rows
            if any(value is not None for value in (median, low, high, bound, *interval))
        ]
        return [
            Table(
                "quantities, - where one is beyond its range or not known",
                ("quantity", "median", "5 to 95 %", head[6], "95 % interval of that"),
                shown,
            ),
            Table(
                "what decides, by rank correlation with",
                tuple(name.removeprefix(RANKED) for name in inputs),
                [
                    [name, *("-" if rank is None else f"{rank:+.2f}" for rank in row)]
                    for name, *row in ranks
                ],
            ),
        ]

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the results as plain values; None (null in JSON) where the samples give no value or bound."""
        units = json.loads(dataset["quantity"].attrs.get(UNITS, "{}"))
        inputs = dataset["input"].to_numpy().tolist()
        quantities = {
            row["quantity"]: {
                "unit": units.get(row["quantity"], "1"),
                "samples": row["samples"],
                "known": row["known"],
                "beyond_the_range": row["beyond"],
                "unknown": row["unknown"],
                "quantiles": [
                    {"probability": quantile["probability"]}
                    | {
                        key: or_none(quantile[f"quantile_{key}"])
                        for key in ("value", "low", "high")
                    }
                    for quantile in rows_along(dataset.isel(quantity=k), "probability")
                ],
            }
            for k, row in enumerate(rows_along(dataset, "quantity"))
        }
        results: dict[str, Any] = {
            "probability": float(dataset.attrs["probability"]),
            "allowable_slip": _bounds_of(dataset, "allowable", "_slip")
            | {"status": describe_quantity(dataset, SKIDDING)},
            "margin": _bounds_of(dataset, "margin") if "margin" in dataset else None,
            "skidding": _bounds_of(dataset, "skidding") if "skidding" in dataset else None,
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
            results["indices"] = {
                str(name): {
                    key: {
                        order: _bounds_of(dataset.sel(indexed=name, input=key), order)
                        for order in ("first_order", "total_order")
                    }
                    for key in inputs
                }
                for name in dataset["indexed"].to_numpy()
            }
        return results


def _summarise_slip(dataset: "xr.Dataset") -> str:
    """Return the slip below which 95 % of the samples are, or how many skid where these are more than 5 %."""
    counts = dataset.sel(quantity=STEADY)
    slip = _quantile(dataset, STEADY, 0.95)[0]
    if math.isfinite(slip):
        return f"95 % of the samples slip less than {percent(slip).removeprefix('below ')}"
    if math.isnan(slip):
        return f"none of {int(counts['samples'])} samples has a steady slip"
    return f"the cage skids in {int(counts['beyond'])} of {int(counts['samples'])} samples"


def _scatter_note(dataset: "xr.Dataset") -> tuple[str, ...]:
    """Return what is sampled, and why no more samples were computed."""
    stop = str(dataset.attrs.get("stop", ""))
    inputs = f"scatter of {dataset.sizes['input']} data"
    inputs += " as their sources and models declare it" * bool(dataset.attrs.get("scatter", ""))
    return tuple(filter(None, (inputs, stop)))


def _deciding_inputs(dataset: "xr.Dataset") -> list[tuple[str, float]]:
    """Return the uncertain quantities with the largest rank correlations with the steady slip, the largest first."""
    ranks = dataset["rank_correlation"].sel(acted=STEADY)
    known = [
        (str(key), float(rank))
        for key, rank in zip(dataset["input"].to_numpy(), ranks.to_numpy(), strict=True)
        if abs(rank) > _MIN_RANK
    ]
    return sorted(known, key=lambda item: -abs(item[1]))[:_MAX_DECIDING]


def _next_steps(dataset: "xr.Dataset", deciding: list[tuple[str, float]]) -> list[str]:
    """Return the command with more samples where an interval needs them, and that without the deciding scatter."""
    steps = []
    if dataset.attrs.get("more_samples"):
        steps.append(
            f"rollslip uncertainty {{scene}} --samples {int(dataset.attrs['more_samples'])}"
        )
    if deciding:
        key, _ = deciding[0]
        unit = json.loads(dataset["input"].attrs.get(UNITS, "{}")).get(key, "1")
        median = float(np.median(dataset["input_value"].sel(input=key)))
        value = "1" if key.endswith("factor") else format_quantity(median, unit, 3)
        steps.append(f"rollslip uncertainty {{scene}} --set {key}={shlex.quote(value)}")
    return steps


def _nominal_note(dataset: "xr.Dataset", name: str, median: float) -> str:
    """Return the value of a quantity at the values of the scene, that of `rollslip run`; empty near the median."""
    nominal = json.loads(dataset.attrs.get("nominal", "{}")).get(name)
    if (
        nominal is None
        or not 0.0 < median < math.inf
        or max(nominal, median) <= _DIFFERS * min(nominal, median)
    ):
        return ""
    return f", {_format_value(name, nominal)} at the values of the scene"


def _bounds_of(dataset: "xr.Dataset", name: str, suffix: str = "") -> dict[str, float | None]:
    """An estimate and its bounds, from three variables, of which that of the value has a suffix."""
    return {
        "value": or_none(dataset[f"{name}{suffix}"]),
        "low": or_none(dataset[f"{name}_low"]),
        "high": or_none(dataset[f"{name}_high"]),
    }


def _quantile(dataset: "xr.Dataset", name: str, probability: float) -> tuple[float, float, float]:
    """A quantile of a quantity, and the bounds of its interval."""
    quantile = dataset.sel(quantity=name, probability=probability)
    value, low, high = (float(quantile[f"quantile_{key}"]) for key in ("value", "low", "high"))
    return value, low, high


def _describe_band(dataset: "xr.Dataset", name: str) -> str:
    """Median and 5 to 95 % band of a quantity."""
    low, median, high = (
        _format_value(name, _quantile(dataset, name, p)[0]) for p in (0.05, 0.5, 0.95)
    )
    return f"median {median}, 5 to 95 %: {low} to {high}"


def describe_quantity(dataset: "xr.Dataset", name: str) -> str:
    """Return a sentence on a quantity: its bound with the requested probability, the interval of that, and its band.

    Parameters
    ----------
    dataset : xarray.Dataset
        Result of the campaign.
    name : str
        A quantity of `_SENTENCES`.
    """
    p = float(dataset.attrs["probability"])
    n = int(dataset["samples"].sel(quantity=name))
    value, low, high = _quantile(dataset, name, p if name in _UPPER else round(1.0 - p, 12))
    if math.isnan(value):
        return f"the {name} is not known: none of {n} samples has one"
    bound, first, last = (_format_value(name, number) for number in (value, low, high))
    interval = f"95 % interval: {first} to {last}, {n} samples"
    if low == -math.inf:
        interval = (
            f"{n} samples are too few for a confidence limit, which takes {dataset.attrs['min_samples']} and "
            "more where all points have a result"
        )
    elif high == math.inf:
        interval = f"95 % interval: from {first} on, {n} samples"
    hint = ""
    if name == SKIDDING and value == math.inf:
        hint = dataset.attrs.get("search_range_hint", "")
    return (
        f"{_SENTENCES[name].format(bound=bound)}, with probability {p:g} ({interval}); "
        f"{_describe_band(dataset, name)}{hint}"
    )


def _describe_lower_bounds(dataset: "xr.Dataset") -> list[str]:
    """Return sentences on reserves that are lower bounds, and on samples that skid; none where there are none."""
    n = int(dataset["samples"].sel(quantity=RESERVE))
    sentences = []
    if bounded := int(dataset["bounded"]):
        sentences.append(
            f"in {bounded} of {n} samples there is no skidding in the range, and the reserve is a lower bound"
        )
    fraction, low, high = (
        _format_percent(float(dataset[f"skidding{suffix}"])) for suffix in ("", "_low", "_high")
    )
    if float(dataset["skidding"]) > 0.0:
        sentences.append(f"in {fraction} of the samples the cage skids ({low} to {high})")
    return sentences


def _describe_acceptable(dataset: "xr.Dataset") -> list[str]:
    """Return a sentence on the samples that pass the acceptable slip; none where no slip is acceptable or known."""
    slips = dataset["value"].sel(quantity=STEADY).to_numpy()
    known = slips[~np.isnan(slips)]
    if not known.size or dataset.attrs.get("acceptable_slip", "") == "":
        return []
    acceptable = float(dataset.attrs["acceptable_slip"])
    above = _format_percent(float(np.mean(np.abs(known) > acceptable)))
    return [f"the acceptable {_format_percent(acceptable)} is passed in {above} of the samples"]


def _has_unknown_play(dataset: "xr.Dataset") -> bool:
    """Whether rollers have play in their pockets, the effect of which on the slip is not known."""
    return str(dataset.attrs.get("play_status", "")).startswith(Status.NOT_KNOWN)


def _caveat(dataset: "xr.Dataset") -> list[str]:
    """Warning where a small skidding slip comes with a large limit drag, so that the slip cannot rank oils."""
    rho = float(dataset["strength_correlation"]) if "strength_correlation" in dataset else math.nan
    if not rho < _CAVEAT_CORRELATION:
        return []
    return [
        "do not rank oils by this slip: where skidding begins at a small slip the limit drag torque is "
        f"large (rank correlation of slip and drag there {rho:.2f}); use the reserve"
    ]


def _describe_skidding_onset(dataset: "xr.Dataset") -> str:
    """Return a sentence on the onset of skidding: slip and limit drag torque, medians with their bands."""
    low, median, high = (_quantile(dataset, SKIDDING, p)[0] for p in (0.05, 0.5, 0.95))
    if math.isnan(median):
        return "no sample says where skidding begins"
    if math.isinf(median):
        counts = dataset.sel(quantity=SKIDDING)
        return (
            f"no skidding was found in {int(counts['beyond'])} of {int(counts['samples'])} samples up to the end of "
            "the range"
        )
    low_drag, median_drag, high_drag = (
        _format_value(DRAG, _quantile(dataset, DRAG, p)[0]) for p in (0.05, 0.5, 0.95)
    )
    return (
        f"skidding begins at a cage slip of {_format_percent(median)}, limit drag torque {median_drag} "
        f"(medians; 5 to 95 %: {_format_percent(low)} to {_format_percent(high)}, {low_drag} to {high_drag})"
    )


def describe_margin(dataset: "xr.Dataset") -> str:
    """Return the probability that the steady slip is below that at which skidding begins, in a sentence."""
    value, low, high = (float(dataset[f"margin{suffix}"]) for suffix in ("", "_low", "_high"))
    n = int(dataset["samples"].sel(quantity="steady slip"))
    if math.isnan(value):
        return f"none of {n} samples has both a steady slip and one at which skidding begins"
    return (
        f"the cage runs below the slip at which skidding begins with probability {value:.4g} "
        f"(95 % interval: {low:.4g} to {high:.4g}, {n} samples)"
    )


def _describe_indices(indices: "xr.Dataset") -> str:
    """Sentence with the total Sobol indices of one result, the largest first."""
    inputs = rows_along(indices, "input")
    parts = [
        "{input} {total_order:.2f} ({total_order_low:.2f} to {total_order_high:.2f})".format(
            **inputs[k]
        )
        for k in np.argsort(-indices["total_order"].to_numpy())
    ]
    beyond = int(indices["indexed_beyond"])
    additions = f"; {beyond} samples beyond the range count as at its end" if beyond else ""
    used = int(indices["indexed_rows"])
    requested = int(indices["indexed_requested"])
    if used < requested:
        additions += (
            f"; made of {used} of {requested} rows, the largest power of two of those without a gap"
        )
    return f"fraction of the variance of {indices['indexed'].item()}, total Sobol index: {', '.join(parts)}{additions}"


def _format_value(name: str, value: float) -> str:
    """Text of a value of a quantity, of slips in percent."""
    if name in (STEADY, SKIDDING):
        return _format_percent(value)
    if not math.isfinite(value):
        return _INFINITE[name]
    return (
        f"{value:.3g} times" if name == RESERVE else format_quantity(value, QUANTITY_UNITS[name], 3)
    )


def _format_percent(fraction: float) -> str:
    return f"{100 * fraction:.3g} %" if math.isfinite(fraction) else "more than the range"


ACCOUNT: Final = UncertaintyAccount("uncertainty")
