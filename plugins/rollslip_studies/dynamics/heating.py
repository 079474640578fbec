"""Solve for the temperatures that follow from the losses of a motion, and for the motion at these temperatures.

Temperatures change within seconds to hours and a motion within milliseconds, and tables over the temperatures of all
parts would be too large. Therefore both problems are solved in turn, each over the whole time (waveform relaxation):

1. Start with constant temperatures, those of the scene.
2. Integrate the motion along the temperatures of this pass. Its energy ledger has the losses over time, by place.
3. Solve the thermal model with these losses. The power is constant between two samples; the model is linearised there
   and solved by the matrix exponential (exponential Euler method): exactly if it is linear, as a thermal network is.
   All heat is stored or carried away, whatever the model.
4. Stop if no temperature differs from those of step 2 by more than its tolerance.
5. Choose the temperatures of the next pass by Anderson acceleration over all passes (D. G. Anderson, J. ACM 12,
   1965, 547-560). Plain passes oscillate, because heat thins the oil and so reduces the losses.
6. If a motion fails, for example because the losses of cold oil lead to temperatures outside of its data, halve the
   step from the last temperatures at which it did not, and repeat from step 2.

A motion without losses is the isothermal motion, bit by bit.

Source of waveform relaxation: E. Lelarasmee, A. E. Ruehli, A. L. Sangiovanni-Vincentelli, IEEE Trans. CAD 1, 1982,
131-145; of the exponential Euler method: M. Hochbruck, A. Ostermann, Acta Numerica 19, 2010, 209-286.
"""

import itertools
import json
import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from typing import Any, ClassVar, Final, Protocol

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import RINGS, Array
from rollslip.errors import ConvergenceError, DomainError, SceneError
from rollslip.studies.answers import Part
from rollslip.studies.thermal_balance.model import ThermalModel, from_bearing, thermal_model
from rollslip.studies.timing import processor_time
from rollslip_studies.dynamics.choice import MotionStudy
from rollslip_studies.dynamics.history.settings import TEMPERATURES, History
from rollslip_studies.dynamics.history.temperature_path import CLEARANCE, ThermalPath, with_changes
from rollslip_studies.dynamics.history.time_functions import constant
from rollslip_studies.dynamics.history_findings import HEAT
from rollslip_studies.dynamics.levels.moving_bearing import MovingBearing
from rollslip_studies.dynamics.termination import with_cause
from rollslip_studies.motion.losses import named_losses, power_balance
from rollslip_studies.motion.time_integration import Trajectory
from rollslip_studies.motion.torque_balance import TorqueBalance

# Settings of the passes through motion and thermal model.

#: Evenly spread samples of losses and temperatures, beside the breaks of a history. Halved, the power is constant
#: over a 128th of the duration, and temperatures that change faster are smoothed. Chosen.
_SAMPLES: Final = 257
#: Upper bound of the relative change of speeds per kelvin; the tolerance of temperatures is that of the cage speed
#: over it. Viscosities of oils change by 2 to 9 % per kelvin. Doubled, temperatures
#: have half the error, usually by one more pass.
_RELATIVE_CHANGE_PER_KELVIN: Final = 0.1
#: Largest number of passes. Doubled, a motion that does not converge takes twice as long to fail. Chosen: plans
#: expect 4 passes.
_MAX_PASSES: Final = 25
#: Halvings of a step to temperatures at which the motion fails. Doubled, steps down to a 4096th are tried. Chosen.
_MAX_HALVINGS: Final = 6

# What a plan expects of a run with temperatures that follow from losses.
#
# The time of a run is passes times (slowdown times the time of a motion, and bearings times that of assembling one).

#: Passes. Doubled, the estimated time doubles. Chosen; the reason was not recorded.
_TYPICAL_PASSES: Final = 4
#: Bearings that are assembled for the maps of a pass. Chosen, likewise.
_TYPICAL_BEARINGS: Final = 30
#: Time of the rates interpolated between bearings over that of one bearing. Chosen, likewise.
_SLOWDOWN: Final = 5

#: Roller positions of the torque balance that gives the inner ring's fraction of the heat of rolling resistance, where
#: the resolution names none. Doubled, the balance takes twice as long. Chosen: the fraction is near a half.
_ROLLING_POSITIONS = 4
#: Cage slips at which that fraction is computed, linear between them. Chosen: dense at the small slips of most motions.
_ROLLING_SLIPS = (0.0, 0.05, 0.15, 0.3, 0.6, 0.9)


class HistoryStudy(MotionStudy, Protocol):
    """What the heating of a bearing requires of a study that integrates motions along a history."""

    name: ClassVar[str]

    def course(self, assembly: Assembly) -> History | None:
        """Return how the operation goes over time by the scene; None where it does not change."""

    def moving_along(self, history: History | None, assembly: Assembly) -> MovingBearing:
        """Return the bearing in motion along a history."""


@attrs.frozen(eq=False, kw_only=True)
class Heating:
    """Temperatures that follow from the losses of a motion, and those at which the motion was computed."""

    assembly: Assembly  # the bearing at the temperatures of the start
    #: Its operation with the temperatures at which the motion was computed; None if nothing changes.
    history: History | None
    model: ThermalModel  # with all data of the bearing
    times: Array  # [s], (m,)
    temperatures: Array  # of the nodes, by the losses of the motion [K], (m, n)
    heat: Mapping[str, Array]  # place -> heat generated since the start [J], (m,)
    carried: Array  # heat carried away since the start [J], (m,)
    passes: int  # number of motions that were computed
    change: (
        float  # largest difference of `temperatures` to those at which the motion was computed [K]
    )


def temperature_variables(
    heating: Heating | None, times: Array
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return variables and attributes of a result about temperatures.

    Parameters
    ----------
    heating : Heating or None
        The temperatures; None where they are given, and values are NaN.
    times : ndarray
        Stored times [s], (m,). Single values are those up to the last one.
    """
    if heating is None:
        return {}, dict.fromkeys(HEAT, math.nan) | {
            "thermal_status": "no model lets temperatures follow from losses"
        }
    model = heating.model
    history = heating.history
    k = int(np.searchsorted(heating.times, times[-1], side="right")) - 1
    until = heating.temperatures[: k + 1]
    rows = [np.interp(times, heating.times, node) for node in heating.temperatures.T]
    variables = {"course_temperature": np.array(rows).T}
    if history is not None and history.path is not None and history.path.unit == "m":
        variables["radial_clearance"] = history.path.courses[CLEARANCE].at(times)
    values = (
        float(until.max()),
        sum(float(heat[k]) for heat in heating.heat.values()),
        float(model.capacities() @ (until[-1] - until[0])),
        float(heating.carried[k]),
    )
    passes = "one pass" if heating.passes == 1 else f"{heating.passes} passes"
    return variables, {
        **dict(zip(HEAT, values, strict=True)),
        "hottest_node": model.nodes[int(np.argmax(until.max(axis=0)))],
        "thermal": model.name,
        "thermal_model": repr(model),
        "taken_from_bearing": json.dumps(from_bearing(heating.assembly.scene, model)),
        "thermal_passes": heating.passes,
        "thermal_status": f"found in {passes}; the last one moved no temperature by more than {heating.change:.2g} K",
    }


def model_of(assembly: Assembly) -> ThermalModel | None:
    """Return the thermal model of a scene, with the data of its bearing; None where temperatures are given."""
    named = thermal_model(assembly.scene)
    return named.of(assembly) if named is not None and named.nodes else None


def temperature_tolerance(assembly: Assembly) -> float:
    """Return the largest change of a temperature in the last pass [K]."""
    return assembly.scene.accuracy.of("cage_speed") / _RELATIVE_CHANGE_PER_KELVIN


def solve_temperatures(
    study: HistoryStudy, assembly: Assembly, progress: Callable[[str, float], None] | None = None
) -> Heating | None:
    """Return the temperatures that the losses of a motion lead to; None where temperatures are given.

    Parameters
    ----------
    study : HistoryStudy
        The study.
    assembly : Assembly
        The bearing of the scene.
    progress : callable, optional
        Takes a text and the fraction of the work that is done.

    Raises
    ------
    SceneError
        If a history gives temperatures as well.
    ConvergenceError
        If a motion fails, or the temperatures do not converge.
    """
    model = model_of(assembly)
    if model is None:
        return None
    start = model.start(assembly.scene)
    bearing = with_changes(assembly, model.changes(start, assembly.scene))
    given = study.course(bearing)
    if given is not None and (fixed := [name for name in given.prescribed if name in TEMPERATURES]):
        raise SceneError(
            [
                f"study.{study.name}.history gives {', '.join(fixed)}, and models.thermal = {model.name!r} lets "
                "temperatures follow from losses; leave one of both out"
            ]
        )
    times = np.linspace(0.0, study.duration, _SAMPLES)
    if given is not None:
        times = np.union1d(times, given.breaks)
    rolling = _inner_rolling_fractions(bearing)
    tolerance = temperature_tolerance(assembly)
    current = np.tile(start, (times.size, 1))
    guesses = list[Array]()
    changes = list[Array]()
    halvings = 0
    for count in range(1, _MAX_PASSES + 1):
        history = _history(study, assembly, bearing, model, given, times, current, tolerance)
        if progress is not None:
            progress(
                f"temperatures, pass {count}", (count - 1) / max(_TYPICAL_PASSES + 1, count + 1)
            )
        try:
            moving, found = _motion(study, bearing, history, times, count)
        except ConvergenceError:
            halvings += 1
            if not guesses or halvings > _MAX_HALVINGS:
                raise
            current = 0.5 * (guesses[-1] + current)
            continue
        heat = _heat_by_place(moving, found, rolling)
        for place, joules in _external_heat(bearing, history, times, moving.ring_speeds(times)):
            heat[place] = heat.get(place, 0.0) + joules
        temperatures, carried = _temperatures(model, start, times, heat)
        change = temperatures - current
        max_change = float(np.abs(change).max())
        if max_change <= tolerance:
            return Heating(
                assembly=bearing,
                history=history,
                model=model,
                times=times,
                temperatures=temperatures,
                heat=heat,
                carried=carried,
                passes=count,
                change=max_change,
            )
        guesses.append(current)
        changes.append(change)
        current = _anderson_step(guesses, changes)
    raise ConvergenceError(
        f"temperatures do not converge: after {_MAX_PASSES} passes through the motion they still change by "
        f"{max_change:.3g} K, more than {tolerance:.2g} K; shorten study.{study.name}.duration, raise "
        "accuracy.tolerance, or give temperatures with --set models.thermal=given"
    )


def _anderson_step(guesses: list[Array], changes: list[Array]) -> Array:
    """Return the temperatures of the next pass by Anderson acceleration, from earlier ones and their changes."""
    new = guesses[-1] + changes[-1]
    if len(guesses) < 2:
        return new
    residuals = np.array([(b - a).ravel() for a, b in itertools.pairwise(changes)]).T
    steps = np.array([(b - a).ravel() for a, b in itertools.pairwise(guesses)]).T + residuals
    weights = np.linalg.lstsq(residuals, changes[-1].ravel(), rcond=1e-6)[0]
    return np.asarray(new - (steps @ weights).reshape(new.shape))


def _history(
    study: HistoryStudy,
    original: Assembly,
    assembly: Assembly,
    model: ThermalModel,
    given: History | None,
    times: Array,
    temperatures: Array,
    error: float,
) -> History | None:
    """Return the operation with temperatures of the nodes (m, n) [K]; as it is given if these are constant.

    Changes refer to the original bearing of the scene, so that none counts twice.
    """
    if not np.ptp(temperatures, axis=0).any():
        return given
    rows = [model.changes(row, original.scene) for row in temperatures]
    path = ThermalPath.from_samples(
        times, {key: np.array([row[key] for row in rows]) for key in rows[0]}, error
    )
    courses = {key.removeprefix("operation."): course for key, course in path.courses.items()}
    known: dict[str, Any] = {name: courses[name] for name in TEMPERATURES if name in courses}
    if given is None:
        names = ("inner_speed", "outer_speed", "radial_load")
        constants = {name: constant(getattr(assembly.scene.operation, name)) for name in names}
        constants["load_direction"] = constant(0.0)
        given = History(courses=constants, prescribed=(), end=study.duration)
    return attrs.evolve(
        given, courses={**given.courses, **known}, prescribed=(*given.prescribed, *known), path=path
    )


def _motion(
    study: HistoryStudy, assembly: Assembly, history: History | None, times: Array, count: int
) -> tuple[MovingBearing, Trajectory]:
    """Return the motion along a history in the pass of a number; a failure is a ConvergenceError."""
    try:
        moving = study.moving_along(history, assembly)
        found = with_cause(study.trial_motion(moving, times, study.relative_tolerance), moving)
    except (SceneError, DomainError) as error:
        raise _motion_error(count, str(error)) from error
    if found.outcome != "finished":
        raise _motion_error(count, found.message) from found.error
    return moving, found


def _motion_error(count: int, message: str) -> ConvergenceError:
    """Return the error of a motion that fails in the pass of a number."""
    origin = "of the start" if count == 1 else f"after pass {count - 1}"
    return ConvergenceError(
        f"temperatures over the motion are not known: at the temperatures {origin} it fails: {message}; run it "
        "at given temperatures with --set models.thermal=given, or cool the bearing more"
    )


def _heat_by_place(
    moving: MovingBearing, found: Trajectory, rolling: tuple[Array, Array]
) -> dict[str, Array]:
    """Return place -> heat generated since the start [J], (m,), from the energy ledger of a motion.

    A torque T on the cage generates the heat -int T (w_c - w_b) dt, where the body b bears its reaction; the ledger has
    int T w_c dt and int T dt, and w_b is that in the middle of an interval. ``rolling`` has cage slips, and the inner
    ring's fraction of the heat of rolling resistance at these.
    """
    state = moving.split(found.y)
    t = found.t
    with np.errstate(divide="ignore", invalid="ignore"):  # the epicyclic speed of the cage may be 0
        slip = np.nan_to_num(1.0 - state["cage_speed"] / moving.epicyclic_speeds(t)[0])
    fraction = np.interp(0.5 * (slip[1:] + slip[:-1]), *rolling)
    inner_rolling = _cumulative(fraction * np.diff(state["lost_rolling"]))
    heat = {
        f"{ring} contact": state[f"lost_{ring}"] + resisted + 0.5 * state.get("lost_damping", 0.0)
        for ring, resisted in zip(
            RINGS, (inner_rolling, state["lost_rolling"] - inner_rolling), strict=True
        )
    }
    heat["pocket"] = state["lost_pockets"]
    cage = moving.assembly.cage
    torques = cage.drags.torques
    if "lost_land" in state:  # the force on the land is a part of the motion, in place of a torque
        heat[_place(cage.guidance)] = state["lost_land"]
        torques = tuple(torque for torque in torques if torque.against not in RINGS)
    work = np.diff(state["work_drag"])
    impulse = np.diff(state["impulse_drag"])
    speeds = moving.ring_speeds(t)
    for torque, fraction in zip(
        torques, _torque_fractions(moving, torques, t, state["cage_speed"], speeds), strict=True
    ):
        place = _place(torque.against)
        middle = 0.0
        if torque.against in RINGS:
            speed = speeds[RINGS.index(torque.against)]
            middle = 0.5 * (speed[1:] + speed[:-1])
        heat[place] = heat.get(place, 0.0) + _cumulative(fraction * (middle * impulse - work))
    return heat


def _external_heat(
    assembly: Assembly, history: History | None, times: Array, ring_speeds: Array
) -> Iterator[tuple[str, Array]]:
    """Yield place and heat since the start [J], (m,), of each loss beside the rollers that a scene names.

    The powers are those of the operation at the times (m,), between which they are linear.
    """
    if not (named := named_losses(assembly.scene)):
        return
    from rollslip.studies.steady_slip.loss import lost_power  # only such scenes need it
    from rollslip.studies.steady_slip.torque import Duty

    courses = {} if history is None else history.at(times)
    courses["speed"] = np.abs(ring_speeds[0] - ring_speeds[1])
    duties = [
        Duty.of(assembly, **{name: float(values[k]) for name, values in courses.items()})
        for k in range(times.size)
    ]
    for _, model in named:
        power = np.array([lost_power(model, duty) for duty in duties])
        yield model.place, _cumulative(0.5 * (power[1:] + power[:-1]) * np.diff(times))


def _place(against: str) -> str:
    """Return where a torque on the cage makes heat, by what bears its reaction: the land of a ring, or the oil."""
    return f"{against} land" if against in RINGS else "oil"


def _cumulative(increments: Array) -> Array:
    """Return the sums of increments up to each sample, (m + 1,), from 0 on."""
    return np.concatenate(([0.0], np.cumsum(increments)))


def _torque_fractions(
    moving: MovingBearing, torques: Any, times: Array, cage: Array, rings: Array
) -> list[Any]:
    """Return the fraction of the torque on the cage that each drag has in every interval, at constant temperature."""
    if len(torques) < 2:
        return [1.0] * len(torques)
    sign = moving.direction
    samples = [*zip(times, cage, *rings, strict=True)]
    values = np.array(
        [
            [
                torque.torque(
                    sign * cage_speed,
                    sign * inner,
                    sign * outer,
                    *([t] if torque.varies_in_time else ()),
                )
                for t, cage_speed, inner, outer in samples
            ]
            for torque in torques
        ]
    )
    values = 0.5 * (values[:, 1:] + values[:, :-1])
    total = values.sum(axis=0)
    return list(
        np.divide(values, total, out=np.full(values.shape, 1.0 / len(torques)), where=total != 0.0)
    )


def _inner_rolling_fractions(assembly: Assembly) -> tuple[Array, Array]:
    """Return cage slips, and the fraction of the heat of rolling resistance at the inner ring there."""
    if assembly.cage.drags.resistance is None:
        return np.zeros(1), np.full(1, 0.5)
    resisted = assembly.with_resistance()
    balance = TorqueBalance(
        resisted,
        resisted.cage.drags,
        n_positions=assembly.resolution.n_positions or _ROLLING_POSITIONS,
    )
    fractions = dict[float, float]()
    for slip in _ROLLING_SLIPS:
        with suppress(DomainError, ConvergenceError):  # the motion may never have this slip
            losses = power_balance(balance, balance.orbit(slip)).losses
            inner, outer = (
                sum(
                    loss.power
                    for loss in losses
                    if loss.place == f"{ring} contact" and "sliding" not in loss.source
                )
                for ring in RINGS
            )
            fractions[slip] = inner / (inner + outer) if inner + outer > 0.0 else 0.5
    return np.array([*fractions] or [0.0]), np.array([*fractions.values()] or [0.5])


def _temperatures(
    model: ThermalModel, start: Array, times: Array, heat: Mapping[str, Array]
) -> tuple[Array, Array]:
    """Return temperatures of the nodes [K], (m, n), and heat carried away since the start [J], (m,), by heat by place.

    One step of the exponential Euler method between two times: with the rates f of temperatures and carried heat, and
    their Jacobian J, the step is h phi_1(h J) f, where phi_1 is a block of the exponential of an augmented matrix.
    """
    from scipy.linalg import expm

    capacities = model.capacities()
    n = start.size
    rows = [start]
    carried = [0.0]
    for k, duration in enumerate(np.diff(times)):
        current = rows[-1]
        power = {
            place: float(joules[k + 1] - joules[k]) / duration for place, joules in heat.items()
        }
        rates = _rates(model, current, power, capacities)
        augmented = np.zeros((2 * n + 2, 2 * n + 2))
        for j, unit in enumerate(np.eye(n)):  # difference quotients over 1 K
            warmer = _rates(model, current + unit, power, capacities)
            augmented[: n + 1, j] = duration * (warmer - rates)
        augmented[: n + 1, n + 1 :] = duration * np.eye(n + 1)
        step = expm(augmented)[: n + 1, n + 1 :] @ rates
        rows.append(current + step[:n])
        carried.append(carried[-1] + float(step[n]))
    return np.array(rows), np.array(carried)


def _rates(
    model: ThermalModel, temperatures: Array, power: Mapping[str, float], capacities: Array
) -> Array:
    """Return the rates of the temperatures [K/s] and the heat flow out of the bearing [W], (n + 1,)."""
    return np.append(
        model.inflows(temperatures, power) / capacities,
        sum(model.carried_away(temperatures).values()),
    )


def plan_parts(study: HistoryStudy, assembly: Assembly, costs: dict[str, float]) -> list[Part]:
    """Return the line of the plan about temperatures that follow from losses; nothing where they are given.

    Parameters
    ----------
    study : HistoryStudy
        The study.
    assembly : Assembly
        The bearing.
    costs : dict of str to float
        Processor times [s] by name, of which that of the temperatures is removed.
    """
    model = model_of(assembly)
    if model is None:
        return []
    return [
        Part(
            part="temperatures",
            choice=f"{model.name}: {', '.join(model.nodes)}",
            resolution="passes through the motion until they change by at most "
            f"{temperature_tolerance(assembly):.2g} K",
            reason="models.thermal names it; all else is chosen at the temperatures that it starts from",
            study=study.name,
            seconds=costs.pop("temperatures", None),
        )
    ]


def heating_cost(
    study: HistoryStudy, assembly: Assembly, motion_seconds: float
) -> dict[str, float]:
    """Return the processor time [s] of the passes, by name, from that of a motion and of assembling one more bearing.

    Parameters
    ----------
    study : HistoryStudy
        The study.
    assembly : Assembly
        The bearing.
    motion_seconds : float
        Processor time of one motion at constant temperatures [s].
    """
    model = model_of(assembly)
    if model is None:
        return {}
    # another bearing, by 1 K, whose parts are not cached
    warmer = with_changes(
        assembly, model.changes(model.start(assembly.scene) + 1.0, assembly.scene)
    )
    seconds = processor_time(lambda: study.moving_along(study.course(warmer), warmer), 1)
    return {
        "temperatures": _TYPICAL_PASSES * (_SLOWDOWN * motion_seconds + _TYPICAL_BEARINGS * seconds)
    }
