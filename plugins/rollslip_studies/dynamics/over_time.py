"""Motions with an operation that changes over time: onset of skidding at each moment, choices of a plan, stored values.

- Skidding slip, limit drag and critical slip are properties of a steady state. Along a history they are those of a
  steady state at the operation of the moment (quasi-steady): computed on a grid of operations, and interpolated
  multilinearly between its points.
- Slips refer to the epicyclic speed. While the rings are nearly at rest there is none, and slips are NaN.
"""

import itertools
import json
import math
import time
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.critical import Critical, slip_grid
from rollslip.bearing.raceway import Array
from rollslip.errors import ConvergenceError, RollslipError
from rollslip.results.dataset import xr
from rollslip.results.text import Status
from rollslip.studies.answers import Part, ResolutionChoice
from rollslip.studies.discretisation.choice import choose_slices_and_positions
from rollslip_studies.dynamics import history_findings
from rollslip_studies.dynamics.history.interpolated_rates import describe_range, with_operation
from rollslip_studies.dynamics.history.settings import TEMPERATURES, History
from rollslip_studies.dynamics.history.temperature_path import CLEARANCE, with_changes
from rollslip_studies.dynamics.history.time_functions import Course, table
from rollslip_studies.dynamics.history.varying import (
    MIN_EPICYCLIC_FRACTION,
    VaryingMotion,
    epicyclic_speeds,
)
from rollslip_studies.dynamics.levels.moving_bearing import MovingBearing
from rollslip_studies.dynamics.outputs import OUTPUTS
from rollslip_studies.dynamics.termination import MeanSlip
from rollslip_studies.effective_friction.raceways import LoadedRaceways
from rollslip_studies.effective_friction.study import EffectiveFriction
from rollslip_studies.motion.torque_balance import (
    Reserve,
    SkiddingOnset,
    SteadyOperation,
    TorqueBalance,
    reserve,
)

#: Number of varying conditions -> steady operations along the axis of each; 81 at most are computed. Doubled, the
#: onset of skidding takes two times (one condition) to 16 times (four) as long. Chosen.
_GRID_POINTS: Final = {0: 1, 1: 9, 2: 5, 3: 4, 4: 3}
#: Evenly spread times between which the watched slip is linear. Halved, a passage of the skidding slip may be reported
#: up to a thousandth of the duration off. Chosen.
_LIMIT_TIMES: Final = 2001
#: Evenly spread times at which a plan evaluates the maps along a history. Halved, a map that only a short peak requires
#: may be missed in the estimate of the cost. Chosen.
_PLAN_TIMES = 257
#: Bearings along an axis of speed from which on conventional friction is taken, because tables of effective friction at
#: all of them would take far longer than they save. Doubled, plans and runs of long run-ups take up to twice as long.
#: Chosen.
_MAX_BEARINGS = 100
#: Roller positions within a pitch for the skidding slip of a motion. Doubled, each operation takes twice as long, and
#: the slip changes by less than matters for an event.
N_POSITIONS: Final = 4


def fixed_settings(
    history: History | None, named: Sequence[str], level: str
) -> tuple[dict[str, Any], list[str]]:
    """Return settings that a history fixes, and the names of those that are not to be chosen: the fixed and the named.

    Parameters
    ----------
    history : History or None
        The history.
    named : sequence of str
        Settings that the scene names.
    level : str
        Level of detail of the study.
    """
    if history is None:
        return {}, [*named]
    settings: dict[str, Any] = {"level": "cage-set"}
    if {"inner_speed", "outer_speed"} & {*history.varies}:
        settings["friction"] = "conventional"
    settings = {name: value for name, value in settings.items() if name not in named}
    has_contacts = level != "cage-set" and "level" in named  # they limit the step all the time
    return settings, [*named, *settings, *([] if has_contacts else ["integrator"])]


def reasons_of_history(
    history: History | None, settings: Mapping[str, Any], level: str, named: Collection[str]
) -> dict[str, str]:
    """Return the reasons why a history fixes settings, by their names.

    Parameters
    ----------
    history : History or None
        The history.
    settings : mapping of str to any
        The settings that it fixes, as of `fixed_settings`.
    level : str
        Level of detail of the study.
    named : collection of str
        Settings that the scene names.
    """
    if history is None:
        return {}
    texts = {
        "integrator": "the default: how fast a motion decays changes along a history, and is fastest where rings rest",
        "level": "a history is taken at this level",
        "friction": "the speeds of the rings change: effective friction is tabulated at one speed, and many tables "
        "would take longer than they save",
    }
    names = [*settings]
    if settings.get("level", level) == "cage-set" and "integrator" not in named:
        names.insert(0, "integrator")
    return {name: texts[name] for name in names}


@attrs.frozen(eq=False)
class SkiddingCourse:
    """Onset of skidding over time, of a bearing in a steady state at the operation of each moment."""

    skidding_slip: Array  #: Cage slip at which skidding begins, (m,), NaN where it is not known.
    limit_drag: Array  #: Limit drag torque [N m], (m,), NaN likewise.
    critical_slip: (
        Array  #: Cage slip at the largest friction of the inner ring, (m,), NaN likewise.
    )
    status: str  #: What the values are based on, or why none is known.


def skidding_along(
    study: EffectiveFriction, assembly: Assembly, history: History, times: Array
) -> SkiddingCourse:
    """Return the onset of skidding at the operation of each moment.

    Multilinear interpolation between steady operations on a grid over the varying conditions, of which only those next
    to the history are computed.

    Parameters
    ----------
    study : EffectiveFriction
        Settings of the effective friction.
    assembly : Assembly
        The bearing.
    history : History
        The operation over time.
    times : ndarray
        Times [s], (m,).

    Returns
    -------
    SkiddingCourse
        NaN while the rings are (nearly) at rest, and everywhere if the ratio of their speeds varies.
    """
    if not history.speeds_in_proportion():
        unknown = np.full(times.size, np.nan)
        return SkiddingCourse(
            unknown,
            unknown,
            unknown,
            "the slip at which skidding begins along the way is not computed because the ratio of the speeds of the "
            "rings changes",
        )
    operation = history.at(times)
    speed = np.abs(operation["inner_speed"] - operation["outer_speed"])
    is_turning = speed > MIN_EPICYCLIC_FRACTION * speed.max(initial=0.0)
    spans: dict[str, tuple[float, float]] = history.spans | {
        "speed": (MIN_EPICYCLIC_FRACTION * speed.max(), speed.max())
    }
    coordinates = operation | {"speed": speed}
    names: list[str] = [name for name in history.conditions if name in history.varies]
    if {"inner_speed", "outer_speed"} & {*history.varies}:
        names.append("speed")
    if (path := history.path) is not None:
        names.append(path.name)
        spans[path.name] = (0.0, 1.0)
        coordinates[path.name] = path.coordinate.at(times)
    axes = {name: _axis(*spans[name], _GRID_POINTS[len(names)]) for name in names}
    fastest = int(np.argmax(speed))
    key = (
        repr(study),
        assembly.resolution,
        path,
        *((name, spans[name]) for name in history.conditions),
        float(speed.max()),
        *names,
        *(float(end) for axis in axes.values() for end in axis[[0, -1]]),
    )
    grid = _OperationGrid(
        study=study,
        assembly=assembly,
        path=path,
        axes=axes,
        constant={name: spans[name][0] for name in history.conditions if name not in names},
        max_speed=float(speed[fastest]),
        speed_ratios={
            name: float(operation[name][fastest]) / (speed[fastest] or 1.0)
            for name in ("inner_speed", "outer_speed")
        },
        onsets=assembly.cached("skidding along a history", key, dict),
        problems=assembly.cached("statuses of skidding along a history", key, set),
    )
    result = grid.interpolate([coordinates[name] for name in names], is_turning)
    return SkiddingCourse(result[0], result[1], result[2], grid.describe())


@attrs.frozen(eq=False, kw_only=True)
class _OperationGrid:
    """Grid of steady operations that contains a history, and the onset of skidding at the points that were needed."""

    study: EffectiveFriction
    assembly: Assembly
    path: Any  # through temperatures that follow from losses; None without
    axes: Mapping[str, Array]  # varying condition -> its values on the grid
    constant: Mapping[str, float]  # value of each other condition
    max_speed: float  # largest difference of the speeds of the rings [rad/s]
    speed_ratios: Mapping[str, float]  # speed of each ring over that difference
    #: Indices of a point -> skidding slip, limit drag [N m] and critical slip; cached with the bearing.
    onsets: dict[tuple[int, ...], tuple[float, float, float]]
    problems: set[str]  # statuses of the points at which no onset was found; cached likewise

    def onset(self, point: tuple[int, ...]) -> tuple[float, float, float]:
        """Return skidding slip, limit drag [N m] and critical slip at a point of the grid, NaN where a law fails."""
        if point not in self.onsets:
            try:
                self.onsets[point] = self._compute(point)
            except RollslipError as error:
                self.problems.add(str(error))
                self.onsets[point] = math.nan, math.nan, math.nan
        return self.onsets[point]

    def _compute(self, point: tuple[int, ...]) -> tuple[float, float, float]:
        """Compute the onset of skidding at a point."""
        conditions = {
            name: float(axis[k]) for (name, axis), k in zip(self.axes.items(), point, strict=True)
        }
        speed = conditions.pop("speed", self.max_speed)
        speeds = {name: float(ratio * speed) for name, ratio in self.speed_ratios.items()}
        operation = {**self.constant, **conditions, **speeds}
        bearing = self.assembly
        if self.path is not None:
            bearing = self.path.bearing(bearing, operation.pop(self.path.name))
        raceways = self.study.loaded(
            with_operation(bearing, operation), self.assembly.resolution.n_positions or N_POSITIONS
        )
        onset, _ = onset_of(self.study, raceways)
        critical = critical_of(self.study, raceways)
        if onset.status != Status.FOUND:
            self.problems.add(onset.status)
        return onset.slip, onset.drag, critical.slip

    def interpolate(self, coordinates: Sequence[Array], is_turning: Any) -> Array:
        """Return skidding slip, limit drag [N m] and critical slip, (3, m), multilinear between the points.

        Parameters
        ----------
        coordinates : sequence of ndarray
            Values of the condition of each axis, (m,) each.
        is_turning : ndarray
            Where the rings turn, (m,); elsewhere the result is NaN.
        """
        cells = list[Any]()
        fractions = list[Array]()
        for value, axis in zip(coordinates, self.axes.values(), strict=True):
            k = np.clip(np.searchsorted(axis, value, side="right") - 1, 0, axis.size - 2)
            cells.append(k)
            fractions.append(np.clip((value - axis[k]) / (axis[k + 1] - axis[k]), 0.0, 1.0))
        result = np.zeros((3, is_turning.size))
        for corner in itertools.product((0, 1), repeat=len(cells)):
            weight = np.ones(is_turning.size)
            for upper, fraction in zip(corner, fractions, strict=True):
                weight = weight * (fraction if upper else 1.0 - fraction)
            points = np.stack(
                [cell + upper for upper, cell in zip(corner, cells, strict=True)]
                or [np.zeros(is_turning.size, int)]
            )
            used = (weight > 0.0) & is_turning
            for point in set(map(tuple, points[:, used].T.tolist())):
                here = used & (points == np.array(point)[:, None]).all(axis=0)
                result[:, here] += weight[here] * np.array(self.onset(point[: len(cells)]))[:, None]
        result[:, ~is_turning] = np.nan
        return result

    def describe(self) -> str:
        """Describe what interpolated values are based on."""
        text = (
            "of steady states at the operation of the moment, interpolated between "
            f"{len(self.onsets)} operations"
        )
        return f"{text}; at some of them: {min(self.problems)}" if self.problems else text


def _axis(low: float, high: float, count: int) -> Array:
    """Return the values of an axis, in geometric progression where they are above 0, else evenly spread."""
    if low > 0.0:
        return np.geomspace(low, high, count)
    return np.linspace(low, high, count)


def watched_slip(
    study: EffectiveFriction, assembly: Assembly, history: History | None
) -> Course | None:
    """Return the skidding slip over time, of which passages are events; None where none is known, or nothing changes.

    Parameters
    ----------
    study : EffectiveFriction
        Settings of the effective friction.
    assembly : Assembly
        The bearing.
    history : History or None
        The operation over time.
    """
    if history is None:
        return None
    breaks = np.array(history.breaks)
    before = breaks - 1e-9 * history.end  # the values to the left of a jump
    times = np.unique(
        np.concatenate((np.linspace(0.0, history.end, _LIMIT_TIMES), before[before > 0.0], breaks))
    )
    slip = skidding_along(study, assembly, history, times).skidding_slip
    return None if np.isnan(slip).all() else attrs.evolve(table(times, slip), breaks=())


def onset_of(
    study: EffectiveFriction, raceways: LoadedRaceways
) -> tuple[SkiddingOnset, TorqueBalance | None]:
    """Return the onset of skidding and its torque balance; NaN with a reason and None where it is not computed."""
    if study.skidding_range:
        balance = study.torque_balance(raceways.assembly, raceways.distribution.psi.shape[0])
        return study.skidding_onset(balance), balance
    rings = raceways.assembly.rings
    reason = f"study.{study.name}.skidding_range is 0"
    if rings and rings.turning:
        reason = "a form turns with its ring"
    status = f"the onset of skidding was not computed: {reason}"
    return SkiddingOnset(math.nan, math.nan, status), None


def reserve_of(
    study: EffectiveFriction, onset: SkiddingOnset, balance: TorqueBalance | None, slip: float
) -> Reserve:
    """Return the drag reserve to skidding of a cage that runs at a steady slip; NaN with a reason without one.

    Parameters
    ----------
    study : EffectiveFriction
        Settings of the search for skidding.
    onset : SkiddingOnset
        The onset of skidding.
    balance : TorqueBalance or None
        The torque balance of that onset.
    slip : float
        Steady cage slip of the motion; NaN where it is not steady.
    """
    if math.isnan(slip) or balance is None:
        return Reserve(math.nan, "no slip is steady" if math.isnan(slip) else onset.status)
    return reserve(
        balance,
        onset,
        SteadyOperation(slip, -balance.drag(slip), Status.FOUND),
        study.skidding_range,
    )


def critical_of(study: EffectiveFriction, raceways: LoadedRaceways) -> Critical:
    """Return the cage slip of the largest effective friction on the inner ring."""
    slip = slip_grid(study.max_cage_slip, study.points)
    return raceways.critical(slip, raceways.curve(slip))[0]


def choose_over_history(
    study: EffectiveFriction, assembly: Assembly, history: History | None, fraction: float
) -> ResolutionChoice:
    """Choose slices and roller positions for the operation of the scene, and both extremes of load and temperature.

    Parameters
    ----------
    study : EffectiveFriction
        Settings of the effective friction.
    assembly : Assembly
        The bearing.
    history : History or None
        The operation over time.
    fraction : float
        Fraction of the tolerances that slices and roller positions may use.
    """
    estimated, *_ = choose_slices_and_positions(study, assembly, fraction)
    if history is None:
        return estimated
    for end in (0, 1):
        with suppress(RollslipError):  # the run reports which bearing cannot be assembled
            other, *_ = choose_slices_and_positions(
                study,
                with_operation(
                    assembly, {name: history.spans[name][end] for name in history.conditions}
                ),
                fraction,
            )
            if (other.resolution.slices or 0) > (estimated.resolution.slices or 0):
                estimated = other
    return estimated


def history_variables(
    study: EffectiveFriction, moving: Any, times: Array, states: Array
) -> tuple[dict[str, Array], dict[str, Any]]:
    """Return variables and attributes of a result about its history; nothing of a motion without one.

    Parameters
    ----------
    study : EffectiveFriction
        Settings of the effective friction.
    moving : MovingBearing
        The equations of motion.
    times : ndarray
        Stored times [s], (m,).
    states : ndarray
        Stored states, (m, n).
    """
    if not isinstance(moving, VaryingMotion):
        return {}, {}
    history = moving.history
    skidding = skidding_along(study, moving.assembly, history, times)
    operation = history.at(times)
    works, distances = moving.sliding_work_and_distance(states[-1])
    variables = {name: operation[name] for name in history.prescribed} | {
        "epicyclic_cage_speed": moving.direction
        * epicyclic_speeds(moving.assembly, history, times)[0],
        "skidding_slip_along": skidding.skidding_slip,
        "limit_drag_along": skidding.limit_drag,
        "critical_slip_along": skidding.critical_slip,
        "roller_sliding_distance": distances,
        "roller_frictional_work": works,
    }
    return variables, {
        "history": json.dumps(history.prescribed),
        "history_status": skidding.status,
        "history_sha256": history.sha256,
        "history_varies": json.dumps(history.varies),
        "history_stations": len(moving.system.owner.stations),
        "history_error": moving.stations.error,
        "slip_status": "known while the cage's epicyclic speed is more than "
        f"{100 * MIN_EPICYCLIC_FRACTION:g} % of its largest, to which slips refer",
    }


def plan_parts(
    history: History | None,
    make_moving: Callable[[], MovingBearing],
    study: str,
    costs: dict[str, float],
) -> list[Part]:
    """Return the line of the plan about a history: what changes, and what its maps cost; nothing without a history.

    Parameters
    ----------
    history : History or None
        The operation over time.
    make_moving : callable
        Returns the equations of motion along the history.
    study : str
        Name of the study.
    costs : dict of str to float
        Processor times [s] by name, of which that of the history is removed.
    """
    if history is None:
        return []
    moving = make_moving()
    assert isinstance(moving, VaryingMotion)
    stations = moving.stations
    axes = "maps over " + "; ".join(map(describe_range, stations.axes))
    return [
        Part(
            part="history",
            choice=", ".join(history.prescribed).replace("_", " "),
            resolution=f"{axes}; {stations.bearings} bearings assembled for them"
            if stations.axes
            else "nothing to be mapped: rates know the speeds of the rings",
            reason="the scene gives it; maps are refined along the motion until they are accurate between their nodes",
            study=study,
            errors={"cage_speed": stations.error} if stations.error else {},
            seconds=costs.pop("history", None),
        )
    ]


def history_cost(
    history: History | None, make_moving: Callable[[], MovingBearing], study: EffectiveFriction
) -> dict[str, float]:
    """Return the processor time [s] of maps and skidding slips along a history in a run, by name.

    Both are computed here and cached, so that the run pays for the second use only, which is measured.

    Parameters
    ----------
    history : History or None
        The operation over time.
    make_moving : callable
        Returns the equations of motion along the history.
    study : EffectiveFriction
        Settings of the effective friction.
    """
    if history is None:
        return {}
    times = np.linspace(0.0, history.end, _PLAN_TIMES)
    for _ in range(2):
        start = time.process_time()
        _build_maps(history, make_moving())
        skidding_along(study, make_moving().assembly, history, times)
    return {"history": time.process_time() - start}


def tabulation_problem(
    history: History | None, friction: str, make_moving: Callable[[], MovingBearing]
) -> str:
    """Return why effective friction cannot be tabulated along a history of speeds; empty if it can, or need not.

    Parameters
    ----------
    history : History or None
        The operation over time.
    friction : str
        Friction of the raceways.
    make_moving : callable
        Returns the equations of motion along the history.
    """
    if (
        history is None
        or friction != "effective"
        or not {"inner_speed", "outer_speed"} & {*history.varies}
    ):
        return ""
    try:
        _build_maps(history, make_moving(), _MAX_BEARINGS)
    except ConvergenceError as refused:
        return f"effective friction cannot be tabulated along the history, as {refused}"
    return ""


def _build_maps(history: History, moving: MovingBearing, max_bearings: float = math.inf) -> None:
    """Evaluate the rates along a history, which builds the maps that they need.

    ``max_bearings`` counts for one axis, four times as many for each further one; more are a ConvergenceError.
    """
    assert isinstance(moving, VaryingMotion)
    y = moving.initial()
    max_bearings = max_bearings * 4 ** max(len(moving.stations.axes) - 1, 0)
    for t in np.linspace(0.0, history.end, _PLAN_TIMES):
        moving.system(float(t), y)
        if moving.stations.bearings > max_bearings:
            raise ConvergenceError(
                f"more than {max_bearings:g} bearings would have to be assembled for it"
            )


def with_single_values(dataset: "xr.Dataset") -> "xr.Dataset":
    """Return a result with the single values of its history as attributes, which campaigns store; NaN without one."""
    if not history_findings.has_history(dataset):
        unknown = dict.fromkeys(
            (name for name, output in OUTPUTS.items() if output.status == "history_status"),
            math.nan,
        )
        return dataset.assign_attrs(
            unknown | {"history_status": "the operation does not change: there is no history"}
        )
    values = history_findings.single_values(dataset)
    return dataset.assign_attrs(
        {key: value for key, value in values.items() if not isinstance(value, list)}
    )


def steady_slip_along(moving: Any, times: Array, steady: MeanSlip) -> MeanSlip:
    """Return a steady slip; NaN with a reason if the operation changed in the last three eighths of a run.

    Parameters
    ----------
    moving : MovingBearing
        The equations of motion.
    times : ndarray
        Stored times [s], (m,).
    steady : MeanSlip
        Steady slip at the end of the motion, for an operation that does not change (`steady_slip_of`).
    """
    if reason := moving.assembly.cage.drags.in_time:
        return MeanSlip(reason)
    if not isinstance(moving, VaryingMotion):
        return steady
    if math.isnan(moving.epicyclic_speeds(times)[0][-1]):
        return MeanSlip("the rings are nearly at rest at the end")
    operation: Mapping[str, Array] = moving.history.at(
        times[times >= times[-1] - 0.375 * (times[-1] - times[0])]
    )
    path = moving.history.path
    errors = {} if path is None else dict.fromkeys(TEMPERATURES, path.error)
    changing = [
        name for name, values in operation.items() if np.ptp(values) > errors.get(name, 0.0)
    ]
    if not changing:
        return steady
    return MeanSlip(
        f"the operation changes until the end ({', '.join(changing).replace('_', ' ')})"
    )


def final_bearing(assembly: Assembly, dataset: "xr.Dataset") -> Assembly | None:
    """Return the bearing at the operation at the end of a result; None if nothing rolls then.

    Parameters
    ----------
    assembly : Assembly
        The bearing of the scene.
    dataset : xarray.Dataset
        The result.
    """
    if not history_findings.has_history(dataset):
        return assembly
    operation = {
        name: getattr(assembly.scene.operation, name) for name in ("inner_speed", "outer_speed")
    }
    operation |= {name: float(dataset[name][-1]) for name in json.loads(dataset.attrs["history"])}
    operation.pop(
        "load_direction", None
    )  # it turns the loads with the rollers, and changes no contact
    if "radial_clearance" in dataset:
        assembly = with_changes(assembly, {CLEARANCE: float(dataset["radial_clearance"][-1])})
    if operation["inner_speed"] == operation["outer_speed"]:
        return None
    return with_operation(assembly, operation)


def bearing_at(assembly: Assembly, dataset: "xr.Dataset", index: int) -> Assembly:
    """Return the bearing with the temperatures at a stored time of a result.

    Parameters
    ----------
    assembly : Assembly
        The bearing of the scene.
    dataset : xarray.Dataset
        The result.
    index : int
        Index of the stored time.
    """
    temperatures = {
        name: float(dataset[name][index])
        for name in json.loads(dataset.attrs.get("history", "[]"))
        if name in TEMPERATURES
    }
    return with_operation(assembly, temperatures)
