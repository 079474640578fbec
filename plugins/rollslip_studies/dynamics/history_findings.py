"""What a motion along a history says: slip against that of running away, sliding and frictional work, from the dataset.

- Slips are known while the rings turn; where they all but stand an instant has none, and takes no part here.
- Distances and work are integrals that the motion takes at every step, roller by roller; works sum to the ledger's.
- Spans of time are sums over the stored instants, with passages on straight lines between them.
"""

import json
import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rollslip.results.answer import Row
from rollslip.results.words import describe_estimated, percent
from rollslip.search import Array
from rollslip.units import format_quantity

if TYPE_CHECKING:
    import xarray as xr


#: Units in which what varies is told, where they are not those of its kind.
_TOLD_IN: Final = {"load_direction": "deg"}
#: From which share of its speed without slip on it is told that a cage runs ahead.
_AHEAD: Final = 1e-3
#: Share of a film that starvation may leave untold.
_KNOWN: Final = 0.01
_HEAT: Final = ("hottest_temperature", "heat_made", "heat_stored", "heat_carried_away")
_WORK: Final = {"inner": "lost_inner", "outer": "lost_outer"}


def along(dataset: "xr.Dataset") -> bool:
    """Whether a motion went along a history."""
    return "history" in dataset.attrs


def largest(dataset: "xr.Dataset") -> tuple[float, float]:
    """Largest cage slip and its time [s]; NaN where no slip is known."""
    return _slip_at(dataset, np.nanargmax)


def least(dataset: "xr.Dataset") -> tuple[float, float]:
    """Least cage slip, negative where the cage runs ahead, and its time [s]; NaN where no slip is known."""
    return _slip_at(dataset, np.nanargmin)


def _slip_at(dataset: "xr.Dataset", where: Callable[[Array], Any]) -> tuple[float, float]:
    slip = dataset["cage_slip"].to_numpy()
    if not np.isfinite(slip).any():
        return math.nan, math.nan
    k = int(where(slip))
    return float(slip[k]), float(dataset["time"][k])


def nearest(dataset: "xr.Dataset") -> tuple[float, float, float]:
    """Least margin of slip below that of running away, its time [s], and the slip of running away then; or NaN."""
    margin = (dataset["skidding_slip_along"] - dataset["cage_slip"]).to_numpy()
    if not np.isfinite(margin).any():
        return math.nan, math.nan, math.nan
    k = int(np.nanargmin(margin))
    return float(margin[k]), float(dataset["time"][k]), float(dataset["skidding_slip_along"][k])


def time_beyond(dataset: "xr.Dataset") -> float:
    """Time that the cage spent beyond the slip of running away of the moment [s]; NaN where that is never known."""
    margin = (dataset["cage_slip"] - dataset["skidding_slip_along"]).to_numpy()
    if not np.isfinite(margin).any():
        return math.nan
    t = dataset["time"].to_numpy()
    one = margin[:-1]
    other = margin[1:]
    with np.errstate(invalid="ignore", divide="ignore"):
        fraction = np.where(
            one * other < 0.0, np.maximum(one, other) / np.abs(other - one), (one + other) > 0.0
        )
    known = np.isfinite(one) & np.isfinite(other)
    return float(np.sum(np.where(known, fraction, 0.0) * np.diff(t)))


def sliding_distance(dataset: "xr.Dataset") -> dict[str, Array]:
    """Distance [m] that each roller slid on each ring: the time integral of |V|."""
    distances = dataset["roller_sliding_distance"]
    return {str(ring): distances.sel(ring=ring).to_numpy() for ring in dataset["ring"].to_numpy()}


def frictional_work(dataset: "xr.Dataset") -> dict[str, float]:
    """Work [J] that sliding took at each ring, of the ledger."""
    names = [str(name) for name in dataset["work"].to_numpy()]
    return {
        ring: -float(dataset["work_done"][names.index(name), -1])
        for ring, name in _WORK.items()
        if name in names
    }


def heats(dataset: "xr.Dataset") -> bool:
    """Whether temperatures of a motion follow from its losses."""
    return "thermal" in dataset.attrs


def heat_record(dataset: "xr.Dataset") -> dict[str, Any]:
    """Return the single values of temperatures that follow from losses; nothing where they are given."""
    if not heats(dataset):
        return {}
    last = dataset["course_temperature"].to_numpy()[-1].tolist()
    return {
        **{name: float(dataset.attrs[name]) for name in _HEAT},
        **{
            name: str(dataset.attrs[name]) for name in ("thermal", "hottest_node", "thermal_status")
        },
        "final_temperatures": dict(zip(map(str, dataset["node"].to_numpy()), last, strict=True)),
    }


def format_energy(joules: float) -> str:
    """Return an energy as people read it."""
    return f"{joules:.4g} J" if abs(joules) < 1e3 else f"{1e-3 * joules:.4g} kJ"


def format_heat(dataset: "xr.Dataset") -> list[str]:
    """Say what the losses did to the temperatures."""
    a = dataset.attrs
    nodes = [str(node) for node in dataset["node"].to_numpy()]
    rows = dataset["course_temperature"].to_numpy()
    ends = ", ".join(
        f"{node} from {format_quantity(float(first), 'K', 4)} to {format_quantity(float(last), 'K', 4)}"
        for node, first, last in zip(nodes, rows[0], rows[-1], strict=True)
    )
    made, stored, carried = (format_energy(abs(float(a[name]))) for name in _HEAT[1:])
    warmed = "warmed the parts" if float(a["heat_stored"]) >= 0.0 else "came out of the parts"
    left = "left the bearing" if float(a["heat_carried_away"]) >= 0.0 else "came into the bearing"
    lasted = float(dataset["time"][-1])
    said = [
        f"temperatures follow from the losses by the model {a['thermal']} in {lasted:.4g} s: {ends}",
        f"losses made {made} of heat, {stored} {warmed}, and {carried} {left}",
        f"the highest temperature is {format_quantity(float(a['hottest_temperature']), 'K', 4)}, of the "
        f"{a['hottest_node']}; they were {a['thermal_status']}",
    ]
    if guessed := describe_estimated(dataset):
        said.append(f"{guessed}, 'rollslip models {a['thermal']}' says how")
    if "radial_clearance" in dataset:
        first, last = (
            format_quantity(float(dataset["radial_clearance"][k]), "m", 3) for k in (0, -1)
        )
        said.append(f"the radial clearance goes with them from {first} to {last}")
    return said


def without_nan(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return values with None in place of numbers that are not finite."""
    return {
        key: None if isinstance(v, float) and not math.isfinite(v) else v
        for key, v in values.items()
    }


def record(dataset: "xr.Dataset") -> dict[str, Any]:
    """Return the single values of a history; nothing of a motion without one."""
    return without_nan(single_values(dataset)) if along(dataset) else {}


def single_values(dataset: "xr.Dataset") -> dict[str, Any]:
    """Return the single values of a history; NaN where one is not known."""
    slip, when = largest(dataset)
    ahead, then = least(dataset)
    margin, near, _ = nearest(dataset)
    return {
        "history": json.loads(dataset.attrs["history"]),
        "largest_cage_slip_time": when,
        "smallest_cage_slip": ahead,
        "smallest_cage_slip_time": then,
        "smallest_margin_to_skidding": margin,
        "smallest_margin_time": near,
        "time_beyond_skidding": time_beyond(dataset),
        **{
            f"sliding_distance_{ring}": float(d.mean())
            for ring, d in sliding_distance(dataset).items()
        },
        **{f"frictional_work_{ring}": work for ring, work in frictional_work(dataset).items()},
        "largest_cage_slip": slip,
    }


def told(dataset: "xr.Dataset", topics: dict[str, list[str]]) -> dict[str, list[str]]:
    """Return what is told of a motion, with what a history says in place of what holds for a steady operation."""
    first, *others = topics
    warm = {"temperatures": format_heat(dataset)} if heats(dataset) else {}
    if not along(dataset):
        return {first: topics[first], **warm, **{name: topics[name] for name in others}}
    own = warm | {
        "history": sentences(dataset),
        "skidding": [
            f"at the operation of the scene: {topics['skidding'][0]}",
            *skidding_sentences(dataset),
        ],
        "largest slip": [format_largest(dataset)],
    }
    return {
        name: own.get(name, topics.get(name, [])) for name in (first, "history", *warm, *others)
    }


def sentences(dataset: "xr.Dataset") -> list[str]:
    """Say how the operation went, and what sliding it brought."""
    said = []
    t = dataset["time"].to_numpy()
    varies = json.loads(dataset.attrs["history_varies"])
    for name in json.loads(dataset.attrs["history"]):
        values = dataset[name].to_numpy()
        what = name.replace("_", " ")
        low, high, first, last = (
            format_quantity(float(value), dataset[name].attrs["units"], 4, _TOLD_IN.get(name))
            for value in (values.min(), values.max(), values[0], values[-1])
        )
        if name not in varies:
            said.append(f"{what} stays at {first}")
        else:
            more = (
                "" if {first, last} == {low, high} else f", with {low} at least and {high} at most"
            )
            said.append(f"{what} goes from {first} to {last} {_when(t, values)}{more}")
    held, least = json.loads(dataset.attrs.get("starvation", "[1, 1]"))
    if abs(least - held) > _KNOWN * least:
        said.append(
            f"starvation is that of the largest speed throughout, a factor of {held:.3g} on the film; at the lowest "
            f"speed it would be {least:.3g}"
        )
    distances = sliding_distance(dataset)
    works = frictional_work(dataset)
    for ring, distance in distances.items():
        far, most = (
            format_quantity(float(value), "m", 3) for value in (distance.mean(), distance.max())
        )
        work = format_quantity(works[ring], "J", 3) if ring in works else "work that is not known"
        said.append(
            f"a roller slid {far} on the {ring} ring on average, {most} at most; friction took {work} there"
        )
    return said


def _when(t: Array, values: Array) -> str:
    """Say when what is stored changes."""
    steps = np.flatnonzero(np.abs(np.diff(values)) > 1e-9 * np.ptp(values))
    if not steps.size:
        return f"at t = {t[-1]:.3g} s"
    begin = float(t[steps[0]])
    end = float(t[steps[-1] + 1])
    return f"at t = {end:.3g} s" if steps.size == 1 else f"between t = {begin:.3g} and {end:.3g} s"


def format_largest(dataset: "xr.Dataset") -> str:
    """Say the largest slip and when."""
    slip, when = largest(dataset)
    if math.isnan(slip):
        return "no slip is known at any instant: the rings all but stand"
    known = int(np.isfinite(dataset["cage_slip"].to_numpy()).sum())
    said = f"largest cage slip {100 * slip:.3g} % at t = {when:.3g} s"
    if known < dataset.sizes["time"]:
        said += f", {dataset.attrs['slip_status']}: at {known} of {dataset.sizes['time']} instants"
    ahead, then = least(dataset)
    if ahead < -_AHEAD:
        said += f"; the cage runs ahead by up to {-100 * ahead:.3g} % of its speed without slip, at t = {then:.3g} s"
    return said


def row(dataset: "xr.Dataset") -> Row:
    """Return the row of the largest slip."""
    slip, when = largest(dataset)
    known = "" if math.isnan(slip) else f"at t = {when:.3g} s, of an operation that varies"
    return Row(key="largest_cage_slip", label="largest cage slip", value=slip, note=known or "the rings all but stand",
               text=percent(slip) if known else "not found")  # fmt: skip


def skidding_sentences(dataset: "xr.Dataset") -> list[str]:
    """Say how near the cage came to running away, at the operation of each moment."""
    margin, when, limit = nearest(dataset)
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
            f"along the way cage slip stays below that at which skidding begins, nearest at t = {when:.3g} s: "
            f"{100 * (limit - margin):.3g} % where it is {where}"
        ]
    return [
        f"along the way the cage is beyond the slip at which skidding begins for {time_beyond(dataset):.3g} s, "
        f"furthest at t = {when:.3g} s: {100 * (limit - margin):.3g} % where it is {where}"
    ]
