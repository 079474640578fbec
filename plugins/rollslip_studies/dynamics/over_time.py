"""A motion through an operation that changes: where the cage would run away at each moment, and what is stored of it.

- The slip of running away and the critical slip belong to a steady bearing. Along a history they are those of the
  bearing held at the operation of the moment: worked out on a grid of operations, and multilinear between.
- Where the rings all but stand slips refer to nothing. Such instants have none.
"""

import itertools
import json
import math
import time
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.cage import scene_values
from rollslip.bearing.critical import Critical, slip_grid
from rollslip.bearing.drags import taken_from_scene
from rollslip.bearing.raceway import Array
from rollslip.errors import ConvergenceError, RollslipError
from rollslip.structure import Location
from rollslip.studies.answers import Part, ResolutionChoice
from rollslip.studies.error_estimate import slices_and_positions
from rollslip_studies.dynamics import history_findings
from rollslip_studies.dynamics.history.interpolated_rates import describe_range, with_operation
from rollslip_studies.dynamics.history.settings import TEMPERATURES, History, HistorySettings
from rollslip_studies.dynamics.history.temperature_path import CLEARANCE, with_changes
from rollslip_studies.dynamics.history.time_functions import Course, table
from rollslip_studies.dynamics.history.varying import (
    MIN_EPICYCLIC_FRACTION,
    VaryingMotion,
    epicyclic_speeds,
)
from rollslip_studies.dynamics.levels.moving_bearing import MovingBearing
from rollslip_studies.dynamics.outputs import OUTPUTS
from rollslip_studies.effective_friction.raceways import LoadedRaceways
from rollslip_studies.effective_friction.study import EffectiveFriction
from rollslip_studies.motion.torque_balance import SkiddingOnset

if TYPE_CHECKING:
    import xarray as xr

#: Operations along each axis, by the number of axes.
_GRID: Final = {0: 1, 1: 9, 2: 5, 3: 4, 4: 3}
#: Instants between which the slip that is watched goes on a straight line.
_INSTANTS: Final = 2001
#: Instants at which a plan looks at the maps along a history, and bearings over an axis of speed from which on
#: conventional friction takes far less time than effective friction.
_LOOKS = 257
_MAX_BEARINGS = 100
#: Least value over the largest from which on steps of a grid are equal; below, they are in proportion.
_EVEN: Final = 0.5
#: Instants of a pitch for the slip of running away; more move it by less than an event is worth.
N_POSITIONS: Final = 4


def history_of(
    settings: HistorySettings | None, assembly: Assembly, duration: float, table_of: str
) -> History | None:
    """Return the history of a run; None where nothing is to change."""
    if settings is None:
        return None
    where = Location(assembly.scene.origins, (*table_of.split("."), "history"))
    return assembly.cached(
        "history", (settings, duration), lambda: settings.history(assembly.scene, duration, where)
    )


def left_open(
    history: History | None, named: Sequence[str], level: str
) -> tuple[dict[str, Any], list[str]]:
    """Return what a history leaves no choice of, and the settings that are not to be chosen: those and the named."""
    if history is None:
        return {}, [*named]
    settings: dict[str, Any] = {"level": "cage-set"}
    if {"inner_speed", "outer_speed"} & {*history.varies}:
        settings["friction"] = "conventional"
    settings = {name: value for name, value in settings.items() if name not in named}
    within = level != "cage-set" and "level" in named  # contacts, which set the step all the way
    return settings, [*named, *settings, *([] if within else ["integrator"])]


def reasons(
    history: History | None, settings: Mapping[str, Any], level: str, given: Collection[str]
) -> dict[str, str]:
    """Say why a history leaves no choice."""
    if history is None:
        return {}
    known = {
        "integrator": "the default: how fast a motion decays changes along a history, and is fastest where rings rest",
        "level": "a history is taken at this level",
        "friction": "the speeds of the rings change: effective friction is tabulated at one speed, and many tables "
        "would take longer than they save",
    }
    fixed = settings.get("level", level) == "cage-set"
    return {
        name: known[name] for name in (*({"integrator"} - {*given} if fixed else ()), *settings)
    }


@attrs.frozen(eq=False)
class Along:
    """Slips and drag at which the cage would run away at some instants, NaN where that is not known."""

    #: skidding_slip, limit_drag, critical_slip: At the instants; drag [N m].
    skidding_slip: Array
    limit_drag: Array
    critical_slip: Array
    status: str  # what they rest on, or why none is known


def along(study: EffectiveFriction, assembly: Assembly, history: History, times: Array) -> Along:
    """Return where the cage would run away, held at the operation of each instant."""
    nothing = np.full(times.size, np.nan)
    if not history.speeds_in_proportion():
        said = (
            "not worked out where the speeds of both rings change, not in proportion to each other"
        )
        return Along(
            nothing, nothing, nothing, f"the slip at which skidding begins along the way is {said}"
        )
    now = history.at(times)
    spans = history.spans
    values = list[Array]()
    grids = list[Array]()
    names: list[str] = [name for name in history.conditions if name in history.varies]
    apart = np.abs(now["inner_speed"] - now["outer_speed"])
    fast = apart > MIN_EPICYCLIC_FRACTION * apart.max(initial=0.0)
    if {"inner_speed", "outer_speed"} & {*history.varies}:
        names.append("speed")
    spans = spans | {"speed": (MIN_EPICYCLIC_FRACTION * apart.max(), apart.max())}
    now = now | {"speed": apart}
    if (path := history.path) is not None:
        names.append(path.name)
        spans[path.name], now[path.name] = (0.0, 1.0), path.coordinate.at(times)
    for name in names:
        low, high = spans[name]
        values.append(now[name])
        grids.append(_grid(low, high, _GRID[len(names)]))
    ends = (*((name, spans[name]) for name in history.conditions), float(apart.max()))
    key = (
        repr(study),
        assembly.resolution,
        path,
        ends,
        *names,
        *(float(one) for grid in grids for one in grid[[0, -1]]),
    )
    found: dict[tuple[int, ...], tuple[float, float, float]] = assembly.cached(
        "held along", key, dict
    )
    statuses: set[str] = assembly.cached("statuses along", key, set)
    top = int(np.argmax(apart))
    speeds = {
        name: float(now[name][top]) / (apart[top] or 1.0) for name in ("inner_speed", "outer_speed")
    }

    held = {name: spans[name][0] for name in history.conditions if name not in names}

    def at(place: tuple[int, ...]) -> tuple[float, float, float]:
        if place not in found:
            here = {name: float(grid[k]) for name, grid, k in zip(names, grids, place, strict=True)}
            speed = here.pop("speed", float(apart[top]))
            there = (
                held | here | {name: float(fraction * speed) for name, fraction in speeds.items()}
            )
            try:
                bearing = assembly if path is None else path.bearing(assembly, there.pop(path.name))
                raceways = study.loaded(
                    with_operation(bearing, there), assembly.resolution.n_positions or N_POSITIONS
                )
                away = away_of(study, raceways)
                critical = critical_of(study, raceways)
            except RollslipError as error:
                statuses.add(str(error))
                found[place] = math.nan, math.nan, math.nan
            else:
                statuses.update([] if away.status == "found" else [away.status])
                found[place] = away.slip, away.drag, critical.slip
        return found[place]

    cells = list[Any]()
    fractions = list[Array]()
    for value, grid in zip(values, grids, strict=True):
        k = np.clip(np.searchsorted(grid, value, side="right") - 1, 0, grid.size - 2)
        cells.append(k)
        fractions.append(np.clip((value - grid[k]) / (grid[k + 1] - grid[k]), 0.0, 1.0))
    result = np.zeros((3, times.size))
    for corner in itertools.product((0, 1), repeat=len(names)):
        weight = np.ones(times.size)
        for bit, fraction in zip(corner, fractions, strict=True):
            weight = weight * (fraction if bit else 1.0 - fraction)
        places = np.stack(
            [cell + bit for bit, cell in zip(corner, cells, strict=True)]
            or [np.zeros(times.size, int)]
        )
        used = (weight > 0.0) & fast
        for place in {tuple(row) for row in places[:, used].T.tolist()}:
            here = used & (places == np.array(place)[:, None]).all(axis=0)
            result[:, here] += weight[here] * np.array(at(place[: len(names)]))[:, None]
    result[:, ~fast] = np.nan
    said = f"of the bearing held at the operation of the moment, between {len(found)} operations that were worked out"
    more = f"; at some of them: {min(statuses)}" if statuses else ""
    return Along(result[0], result[1], result[2], said + more)


def _grid(low: float, high: float, count: int) -> Array:
    if 0.0 < low < _EVEN * high:
        return np.geomspace(low, high, count)
    return np.linspace(low, high, count)


def limit_of(
    study: EffectiveFriction, assembly: Assembly, history: History | None
) -> Course | None:
    """Return the slip of running away as a course to be watched; None where none is known, or nothing changes."""
    if history is None:
        return None
    breaks = np.array(history.breaks)
    before = breaks - 1e-9 * history.end
    times = np.unique(
        np.concatenate((np.linspace(0.0, history.end, _INSTANTS), before[before > 0.0], breaks))
    )
    slip = along(study, assembly, history, times).skidding_slip
    return None if np.isnan(slip).all() else attrs.evolve(table(times, slip), breaks=())


def away_of(study: EffectiveFriction, raceways: LoadedRaceways) -> SkiddingOnset:
    """Where the cage runs away."""
    rings = raceways.assembly.rings
    away = study.skidding_onset(raceways.assembly, raceways.distribution.psi.shape[0])
    why = (
        "a form turns with its ring"
        if rings and rings.turning
        else f"study.{study.name}.skidding_range is 0"
    )
    return (
        SkiddingOnset(math.nan, math.nan, f"it was not looked where skidding begins: {why}")
        if away is None
        else away
    )


def critical_of(study: EffectiveFriction, raceways: LoadedRaceways) -> Critical:
    """Cage slip of the largest effective friction on the inner ring."""
    slip = slip_grid(study.max_cage_slip, study.points)
    return raceways.critical(slip, raceways.curve(slip))[0]


def at_the_ends(
    study: EffectiveFriction, assembly: Assembly, history: History | None, fraction: float
) -> ResolutionChoice:
    """Slices and instants as the operation needs them, and the least and the largest load and temperature."""
    estimated, *_ = slices_and_positions(study, assembly, fraction)
    if history is None:
        return estimated
    for end in (0, 1):
        spans = {name: history.spans[name][end] for name in history.conditions}
        try:
            other, *_ = slices_and_positions(study, with_operation(assembly, spans), fraction)
        except RollslipError:  # the motion tells what cannot be put together
            continue
        if (other.resolution.slices or 0) > (estimated.resolution.slices or 0):
            estimated = other
    return estimated


def with_history(
    study: EffectiveFriction, moving: Any, times: Array, states: Array
) -> tuple[dict[str, Array], dict[str, Any]]:
    """Return what is stored of a history at instants: variables, and attributes; nothing of a motion without one."""
    if not isinstance(moving, VaryingMotion):
        return {}, {}
    history = moving.history
    way = along(study, moving.assembly, history, times)
    now = history.at(times)
    stations = moving.stations
    works, distances = moving.sliding_work_and_distance(states[-1])
    variables = {name: now[name] for name in history.prescribed} | {
        "epicyclic_cage_speed": moving.direction * epicyclic_speeds(moving.assembly, history, times)[0],
        "skidding_slip_along": way.skidding_slip,
        "limit_drag_along": way.limit_drag,
        "critical_slip_along": way.critical_slip,
        "roller_sliding_distance": distances,
        "roller_frictional_work": works,
    }
    return variables, {
        "history": json.dumps(history.prescribed),
        "history_status": way.status,
        "history_sha256": history.sha256,
        "history_varies": json.dumps(history.varies),
        "history_stations": len(moving.system.owner.stations),
        "history_error": stations.error,
        "slip_status": "known while the cage's epicyclic speed is more than "
        f"{100 * MIN_EPICYCLIC_FRACTION:g} % of its largest, to which slips refer",
        "starvation": json.dumps(_starvation(moving, now)),
    }


def _starvation(moving: VaryingMotion, now: Mapping[str, Array]) -> list[float]:
    """Factors C_S by which the motion starves its inlets, and by which the least speed would; 1 where none does.

    They are of one speed, the largest, unless friction is tabulated over speeds.
    """
    at = moving.base.assembly
    apart = np.abs(now["inner_speed"] - now["outer_speed"])
    starved = any(
        "starvation" in taken_from_scene(model) for model in (*at.models.values(), *at.cage.named)
    )
    if not (starved and moving.stations.speeds_vary) or "speed" in [
        axis.name for axis in moving.stations.axes
    ]:
        return [1.0, 1.0]
    slow = int(np.argmin(np.where(apart > 0.0, apart, np.inf)))
    least = with_operation(at, {name: float(now[name][slow]) for name in ("inner_speed", "outer_speed")})
    return [
        float(str(scene_values(one.scene, one.kinematics, one.lubricant)["starvation"]))
        for one in (at, least)
    ]


def parts(
    history: History | None, make: Callable[[], MovingBearing], study: str, costs: dict[str, float]
) -> list[Part]:
    """Return the line of the plan about a history: what changes, and what its maps cost."""
    if history is None:
        return []
    moving = make()
    assert isinstance(moving, VaryingMotion)
    stations = moving.stations
    axes = "maps over " + "; ".join(map(describe_range, stations.axes))
    return [
        Part(
            part="history",
            choice=", ".join(history.prescribed).replace("_", " "),
            resolution=f"{axes}; {stations.bearings} bearings put together for them"
            if stations.axes
            else "nothing to be mapped: rates know the speeds of the rings",
            reason="the scene gives it; a map has nodes where the motion comes through, until it is right between them",
            study=study,
            errors={"cage_speed": stations.error} if stations.error else {},
            seconds=costs.pop("history", None),
        )
    ]


def cost(
    history: History | None, make: Callable[[], MovingBearing], study: EffectiveFriction
) -> dict[str, float]:
    """Return the time [s] that maps along a history, and the slips of running away along it, take in a run.

    They are made for it, and kept: of them the run pays what finding them costs.
    """
    if history is None:
        return {}
    times = np.linspace(0.0, history.end, _LOOKS)
    _through(history, make())
    along(study, make().assembly, history, times)
    begin = time.process_time()
    _through(history, make())
    along(study, make().assembly, history, times)
    return {"history": time.process_time() - begin}


def without_tables(
    history: History | None, friction: str, make: Callable[[], MovingBearing]
) -> str:
    """Return why effective friction cannot be tabulated along a history of speeds; empty if it can, or need not."""
    if (
        history is None
        or friction != "effective"
        or not {"inner_speed", "outer_speed"} & {*history.varies}
    ):
        return ""
    try:
        _through(history, make(), _MAX_BEARINGS)
    except ConvergenceError as refused:
        return f"effective friction cannot be tabulated along the history, as {refused}"
    return ""


def _through(history: History, moving: MovingBearing, most: float = math.inf) -> None:
    """Put together what a motion asks for along a history, up to so many bearings an axis of speed."""
    assert isinstance(moving, VaryingMotion)
    y = moving.initial()
    most = most * 4 ** max(len(moving.stations.axes) - 1, 0)
    for t in np.linspace(0.0, history.end, _LOOKS):
        moving.system(float(t), y)
        if moving.stations.bearings > most:
            raise ConvergenceError(
                f"more than {most:g} bearings would have to be put together for it"
            )


def told(dataset: "xr.Dataset") -> "xr.Dataset":
    """Return a result with what is asked of a history as single values, which campaigns keep; none without one."""
    if not history_findings.along(dataset):
        none = dict.fromkeys(
            (name for name, output in OUTPUTS.items() if output.status == "history_status"),
            math.nan,
        )
        return dataset.assign_attrs(
            none | {"history_status": "the operation does not change: there is no history"}
        )
    values = history_findings.single_values(dataset)
    return dataset.assign_attrs(
        {key: value for key, value in values.items() if not isinstance(value, list)}
    )


def settled(moving: Any, times: Array, status: tuple[float, str]) -> tuple[float, str]:
    """Return a steady slip and its status; none where the operation changed in the last three eighths of a run."""
    if why := moving.assembly.cage.drags.in_time:
        return math.nan, why
    if not isinstance(moving, VaryingMotion):
        return status
    if math.isnan(moving.epicyclic_speeds(times)[0][-1]):
        return math.nan, "the rings all but stand at the end"
    last = times[times >= times[-1] - 0.375 * (times[-1] - times[0])]
    now: Mapping[str, Array] = moving.history.at(last)
    path = moving.history.path
    known_to = {} if path is None else dict.fromkeys(TEMPERATURES, path.error)
    changing = [name for name, values in now.items() if np.ptp(values) > known_to.get(name, 0.0)]
    if not changing:
        return status
    return (
        math.nan,
        f"the operation changes until the end ({', '.join(changing).replace('_', ' ')})",
    )


def at_the_end(assembly: Assembly, dataset: "xr.Dataset") -> Assembly | None:
    """Return the bearing at the operation of the last instant of a result; None where nothing rolls then."""
    if not history_findings.along(dataset):
        return assembly
    operation = assembly.scene.operation
    now = {name: getattr(operation, name) for name in ("inner_speed", "outer_speed")}
    now |= {name: float(dataset[name][-1]) for name in json.loads(dataset.attrs["history"])}
    now.pop("load_direction", None)  # turns what it loads, and changes no contact at rest
    if "radial_clearance" in dataset:
        assembly = with_changes(assembly, {CLEARANCE: float(dataset["radial_clearance"][-1])})
    if now["inner_speed"] == now["outer_speed"]:
        return None
    return with_operation(assembly, now)


def at_instant(assembly: Assembly, dataset: "xr.Dataset", instant: int) -> Assembly:
    """Return the bearing at the temperatures of a stored instant of a result, by its number, its inlets fed as then."""
    given = {
        name: float(dataset[name][instant])
        for name in json.loads(dataset.attrs.get("history", "[]"))
    }
    at = {name: value for name, value in given.items() if name in TEMPERATURES}
    speeds = {
        name: given.get(name, getattr(assembly.scene.operation, name))
        for name in ("inner_speed", "outer_speed")
    }
    if speeds["inner_speed"] != speeds["outer_speed"] and any(
        "starvation" in taken_from_scene(model) for model in assembly.models.values()
    ):
        at |= speeds
    return with_operation(assembly, at)
