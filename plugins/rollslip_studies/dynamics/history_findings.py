"""Results of a motion along a history, from its dataset alone: margin to skidding, sliding distance, frictional work.

- Slips are known while the rings turn. Times at which the rings are nearly at rest have none, and do not count here.
- Distances and works are integrated with the motion, for each roller; the works add up to those of the energy ledger.
- Durations are sums over the stored times, with linear interpolation of passages between them.
"""

import json
import math
from collections.abc import Callable, Mapping
from typing import Any, Final

import numpy as np

from rollslip.results.answer import Row
from rollslip.results.curves import json_value
from rollslip.results.dataset import xr
from rollslip.results.text import describe_estimated, percent
from rollslip.search import Array
from rollslip.units import format_quantity

#: Values of the operation that are printed in another unit than their kind usually is -> that unit.
_PRINTED_UNITS: Final = {"load_direction": "deg"}
#: Negative slip from which on a sentence says that the cage runs ahead of its epicyclic speed. Doubled, twice that slip
#: is not mentioned. Chosen: the usual tolerance of the cage speed.
_MIN_NEGATIVE_SLIP: Final = 1e-3
#: Step of a value, relative to its range, from which on it changes: below it is rounding.
_MIN_CHANGE: Final = 1e-9
#: Attributes of a result about temperatures that follow from losses.
HEAT: Final = ("hottest_temperature", "heat_made", "heat_stored", "heat_carried_away")
#: Ring -> entry of the energy ledger with the loss by sliding there.
_WORK: Final = {"inner": "lost_inner", "outer": "lost_outer"}


def has_history(dataset: "xr.Dataset") -> bool:
    """Return whether the operation of a motion changes over time."""
    return "history" in dataset.attrs


def largest_slip(dataset: "xr.Dataset") -> tuple[float, float]:
    """Return the largest cage slip and its time [s]; NaN if no slip is known."""
    return _slip_at(dataset, np.nanargmax)


def smallest_slip(dataset: "xr.Dataset") -> tuple[float, float]:
    """Return the smallest cage slip, negative if the cage runs ahead, and its time [s]; NaN if no slip is known."""
    return _slip_at(dataset, np.nanargmin)


def _slip_at(dataset: "xr.Dataset", find_index: Callable[[Array], Any]) -> tuple[float, float]:
    """Return the cage slip at an index that a function finds, and its time [s]; NaN if no slip is known."""
    slip = dataset["cage_slip"].to_numpy()
    if not np.isfinite(slip).any():
        return math.nan, math.nan
    k = int(find_index(slip))
    return float(slip[k]), float(dataset["time"][k])


def smallest_margin(dataset: "xr.Dataset") -> tuple[float, float, float]:
    """Return the least difference of skidding slip and cage slip, its time [s], and the skidding slip then; or NaN."""
    margin = (dataset["skidding_slip_along"] - dataset["cage_slip"]).to_numpy()
    if not np.isfinite(margin).any():
        return math.nan, math.nan, math.nan
    k = int(np.nanargmin(margin))
    return float(margin[k]), float(dataset["time"][k]), float(dataset["skidding_slip_along"][k])


def time_beyond(dataset: "xr.Dataset") -> float:
    """Return how long the cage slip exceeded the skidding slip of the moment [s]; NaN if that is never known."""
    excess = (dataset["cage_slip"] - dataset["skidding_slip_along"]).to_numpy()
    if not np.isfinite(excess).any():
        return math.nan
    start = excess[:-1]
    end = excess[1:]
    with np.errstate(invalid="ignore", divide="ignore"):
        crossing = np.maximum(start, end) / np.abs(end - start)
        fraction = np.where(start * end < 0.0, crossing, (start + end) > 0.0)
    known = np.isfinite(start) & np.isfinite(end)
    return float(np.sum(np.where(known, fraction, 0.0) * np.diff(dataset["time"].to_numpy())))


def sliding_distance(dataset: "xr.Dataset") -> dict[str, Array]:
    """Return ring -> sliding distance of each roller [m], (rollers,): the time integral of |V|."""
    return {
        str(ring): dataset["roller_sliding_distance"].sel(ring=ring).to_numpy()
        for ring in dataset["ring"].to_numpy()
    }


def frictional_work(dataset: "xr.Dataset") -> dict[str, float]:
    """Return ring -> work of sliding [J], from the energy ledger."""
    names = list(map(str, dataset["work"].to_numpy()))
    return {
        ring: -float(dataset["work_done"][names.index(name), -1])
        for ring, name in _WORK.items()
        if name in names
    }


def has_heating(dataset: "xr.Dataset") -> bool:
    """Return whether the temperatures of a motion follow from its losses."""
    return "thermal" in dataset.attrs


def heat_record(dataset: "xr.Dataset") -> dict[str, Any]:
    """Return the single values of temperatures that follow from losses; nothing where they are given."""
    if not has_heating(dataset):
        return {}
    last = dataset["course_temperature"].to_numpy()[-1].tolist()
    return {
        **{name: float(dataset.attrs[name]) for name in HEAT},
        **{
            name: str(dataset.attrs[name]) for name in ("thermal", "hottest_node", "thermal_status")
        },
        "final_temperatures": dict(zip(map(str, dataset["node"].to_numpy()), last, strict=True)),
    }


def describe_heating(dataset: "xr.Dataset") -> list[str]:
    """Describe the temperatures that follow from losses, and the heat."""
    a = dataset.attrs
    rows = dataset["course_temperature"].to_numpy()
    ends = ", ".join(
        f"{node} from {format_quantity(float(first), 'K', 4)} to {format_quantity(float(last), 'K', 4)}"
        for node, first, last in zip(
            list(map(str, dataset["node"].to_numpy())), rows[0], rows[-1], strict=True
        )
    )
    made, stored, carried = (format_quantity(abs(float(a[name])), "J", 4) for name in HEAT[1:])
    warmed = "warmed the parts" if float(a["heat_stored"]) >= 0.0 else "came out of the parts"
    direction = (
        "left the bearing" if float(a["heat_carried_away"]) >= 0.0 else "came into the bearing"
    )
    duration = float(dataset["time"][-1])
    sentences = [
        f"temperatures follow from the losses by the model {a['thermal']} in {duration:.4g} s: {ends}",
        f"losses made {made} of heat, {stored} {warmed}, and {carried} {direction}",
        f"the highest temperature is {format_quantity(float(a['hottest_temperature']), 'K', 4)}, of the "
        f"{a['hottest_node']}; they were {a['thermal_status']}",
    ]
    if estimated := describe_estimated(dataset):
        sentences.append(f"{estimated}, 'rollslip models {a['thermal']}' says how")
    if "radial_clearance" in dataset:
        first, last = (
            format_quantity(float(dataset["radial_clearance"][k]), "m", 3) for k in (0, -1)
        )
        sentences.append(f"the radial clearance goes with them from {first} to {last}")
    return sentences


def without_nan(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return values with None in place of numbers that are not finite."""
    return {key: json_value(value) for key, value in values.items()}


def record(dataset: "xr.Dataset") -> dict[str, Any]:
    """Return the single values of a history; nothing of a motion without one."""
    return without_nan(single_values(dataset)) if has_history(dataset) else {}


def single_values(dataset: "xr.Dataset") -> dict[str, Any]:
    """Return the single values of a history; NaN where a value is not known."""
    max_slip, max_time = largest_slip(dataset)
    min_slip, min_time = smallest_slip(dataset)
    margin, margin_time, _ = smallest_margin(dataset)
    return {
        "history": json.loads(dataset.attrs["history"]),
        "largest_cage_slip_time": max_time,
        "smallest_cage_slip": min_slip,
        "smallest_cage_slip_time": min_time,
        "smallest_margin_to_skidding": margin,
        "smallest_margin_time": margin_time,
        "time_beyond_skidding": time_beyond(dataset),
        **{
            f"sliding_distance_{ring}": float(distance.mean())
            for ring, distance in sliding_distance(dataset).items()
        },
        **{f"frictional_work_{ring}": work for ring, work in frictional_work(dataset).items()},
        "largest_cage_slip": max_slip,
    }


def with_history_topics(
    dataset: "xr.Dataset", topics: dict[str, list[str]]
) -> dict[str, list[str]]:
    """Return topic -> sentences, with those of heating and history, which replace some on a constant operation.

    Parameters
    ----------
    dataset : xarray.Dataset
        The result.
    topics : dict of str to list of str
        Topics of a motion with constant operation.
    """
    first, *others = topics
    heating = {"temperatures": describe_heating(dataset)} if has_heating(dataset) else {}
    replaced = topics | heating
    if has_history(dataset):
        replaced |= {
            "history": describe_history(dataset),
            "skidding": [
                f"at the operation of the scene: {topics['skidding'][0]}",
                *describe_margin(dataset),
            ],
            "largest slip": describe_slips(dataset),
        }
    order = (first, "history", *heating, *others)
    return {name: replaced[name] for name in order if replaced.get(name)}


def describe_history(dataset: "xr.Dataset") -> list[str]:
    """Describe how each value of the operation changed, and the sliding of the rollers."""
    sentences = []
    varies = json.loads(dataset.attrs["history_varies"])
    for name in json.loads(dataset.attrs["history"]):
        values = dataset[name].to_numpy()
        label = name.replace("_", " ")
        low, high, first, last = (
            format_quantity(float(value), dataset[name].attrs["units"], 4, _PRINTED_UNITS.get(name))
            for value in (values.min(), values.max(), values[0], values[-1])
        )
        if name not in varies:
            sentences.append(f"{label} stays at {first}")
            continue
        text = f"{label} goes from {first} to {last} "
        text += _describe_change_times(dataset["time"].to_numpy(), values)
        if {first, last} != {low, high}:
            text += f", with {low} at least and {high} at most"
        sentences.append(text)
    works = frictional_work(dataset)
    for ring, distance in sliding_distance(dataset).items():
        mean, largest = (
            format_quantity(float(value), "m", 3) for value in (distance.mean(), distance.max())
        )
        work = format_quantity(works[ring], "J", 3) if ring in works else "work that is not known"
        sentences.append(
            f"a roller slid {mean} on the {ring} ring on average, {largest} at most; friction took {work} there"
        )
    return sentences


def _describe_change_times(t: Array, values: Array) -> str:
    """Describe when stored values change."""
    steps = np.flatnonzero(np.abs(np.diff(values)) > _MIN_CHANGE * np.ptp(values))
    if not steps.size:
        return f"at t = {t[-1]:.3g} s"
    start = float(t[steps[0]])
    end = float(t[steps[-1] + 1])
    return f"at t = {end:.3g} s" if steps.size == 1 else f"between t = {start:.3g} and {end:.3g} s"


def describe_slips(dataset: "xr.Dataset") -> list[str]:
    """Describe at how many times the slip is known, if not at all, and the smallest slip if the cage runs ahead."""
    sentences = []
    known = int(np.isfinite(dataset["cage_slip"].to_numpy()).sum())
    if 0 < known < dataset.sizes["time"]:
        status = dataset.attrs["slip_status"]
        sentences.append(f"cage slip {status}: at {known} of {dataset.sizes['time']} instants")
    slip, time = smallest_slip(dataset)
    if slip < -_MIN_NEGATIVE_SLIP:
        sentences.append(
            f"the cage runs ahead by up to {-100 * slip:.3g} % of its speed without slip, at t = {time:.3g} s"
        )
    return sentences


def row(dataset: "xr.Dataset") -> Row:
    """Return the row of the largest slip."""
    slip, time = largest_slip(dataset)
    text = percent(slip)
    note = f"at t = {time:.3g} s, of an operation that varies"
    if math.isnan(slip):
        text = "not found"
        note = "the rings are nearly at rest"
    return Row(key="largest_cage_slip", label="largest cage slip", value=slip, text=text, note=note)


def describe_margin(dataset: "xr.Dataset") -> list[str]:
    """Describe the smallest margin to skidding, at the operation of each moment."""
    margin, time, limit = smallest_margin(dataset)
    if math.isnan(margin):
        return [
            f"along the way it is not known where skidding begins: {dataset.attrs['history_status']}"
        ]
    where = f"{100 * limit:.3g} % at the operation of that moment"
    known = int(
        np.isfinite((dataset["skidding_slip_along"] - dataset["cage_slip"]).to_numpy()).sum()
    )
    if known < dataset.sizes["time"]:
        where += f"; both slips are known at {known} of {dataset.sizes['time']} instants"
    if margin > 0.0:
        return [
            f"along the way cage slip stays below that at which skidding begins, nearest at t = {time:.3g} s: "
            f"{100 * (limit - margin):.3g} % where it is {where}"
        ]
    return [
        f"along the way the cage is beyond the slip at which skidding begins for {time_beyond(dataset):.3g} s, "
        f"furthest at t = {time:.3g} s: {100 * (limit - margin):.3g} % where it is {where}"
    ]
