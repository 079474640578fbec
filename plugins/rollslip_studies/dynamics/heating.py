"""Temperatures that follow from the losses of a motion, by a thermal model, and the motion at these temperatures.

- Heat moves temperatures within seconds to hours, a motion moves within milliseconds, and tables over the temperatures
  of all parts would be too large. So the two are solved in turn, each over the whole time (waveform relaxation): the
  motion along temperatures that are known gives its losses over time, and these give the thermal model its temperatures
  over time. It is done when these no longer change. A pass starts from all before it (Anderson 1965, three of them),
  since what warms a bearing also thins its oil and lets it lose less, by which passes alone would swing.
- Losses are those of the motion's own ledger, which its integrator carries, by the place where they make heat. Between
  two instants the power is constant, and the thermal model is solved there by the matrix exponential of its linear
  part: exactly if it is linear, as a network is, and with all heat stored or carried away, whatever it is.
- A motion that nothing warms is the isothermal one, to the last bit.
"""

import itertools
import json
import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any, ClassVar, Final, Protocol

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import RINGS, Array
from rollslip.errors import ConvergenceError, DomainError, SceneError
from rollslip.studies.answers import Part
from rollslip.studies.thermal_balance.model import ThermalModel, from_bearing, thermal_model
from rollslip.studies.timing import timed
from rollslip_studies.dynamics.choice import MotionStudy
from rollslip_studies.dynamics.history.settings import TEMPERATURES, History
from rollslip_studies.dynamics.history.temperature_path import CLEARANCE, ThermalPath, with_changes
from rollslip_studies.dynamics.history.time_functions import constant
from rollslip_studies.dynamics.levels.moving_bearing import MovingBearing
from rollslip_studies.dynamics.termination import explained
from rollslip_studies.motion.losses import power_balance
from rollslip_studies.motion.time_integration import Trajectory
from rollslip_studies.motion.torque_balance import TorqueBalance

#: Single values of a motion that heats its bearing.
VALUES: Final = ("hottest_temperature", "heat_made", "heat_stored", "heat_carried_away")
#: Instants at which temperatures are known, beside the jumps and kinks of a history.
_INSTANTS: Final = 257
#: Relative change of rates with a kelvin, at most: viscosities of oils change by 2 to 9 % there.
_PER_KELVIN: Final = 0.1
#: Passes at most, and passes before from which one starts.
_MOST = 25
_BEFORE = 3
#: Halvings of the way to temperatures at which a motion fails: the losses of cold oil may lead beyond the data of it.
_HALVINGS: Final = 6
#: What a plan expects: passes, bearings put together for each, and by how much rates between them take longer.
_USUAL = 4
_BEARINGS = 30
_ALONG = 5
#: Step of temperature by which the thermal model is made linear, and to a bearing whose price is measured [K].
_STEP: Final = 1.0
#: Difference of two linear parts that is rounding.
_SAME: Final = 1e-9
#: Instants of an orbit, and cage slips, for what the rings share of the resistance to rolling.
_ORBIT = 4
_SLIPS = (0.0, 0.05, 0.15, 0.3, 0.6, 0.9)


class Warming(MotionStudy, Protocol):
    """A study that sets a bearing in motion along a history: what is asked of it here."""

    name: ClassVar[str]

    def course(self, assembly: Assembly) -> History | None:
        """Return how the operation goes over time by the scene; None where it does not change."""

    def moving_along(self, history: History | None, assembly: Assembly) -> MovingBearing:
        """Return the bearing in motion along a history."""


@attrs.frozen(eq=False, kw_only=True)
class Heating:
    """What a motion does to temperatures, and at which it was computed."""

    assembly: Assembly  # the bearing at the temperatures from which it starts
    #: Its operation with the temperatures at which the motion was computed; None if nothing changes.
    history: History | None
    model: ThermalModel  # with all that it takes from the bearing
    times: Array  # [s], (m,)
    temperatures: Array  # that the losses of the motion give the nodes [K], (m, n)
    heat: Mapping[str, Array]  # heat made since the start by place [J], (m,)
    carried: Array  # heat carried away since the start [J], (m,)
    passes: int  # motions that were computed
    change: (
        float  # largest difference of `temperatures` to those at which the motion was computed [K]
    )


def told(heating: Heating | None, times: Array) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return what is stored of temperatures at instants [s]: variables, and single values up to the last of them."""
    if heating is None:
        return {}, dict.fromkeys(VALUES, math.nan) | {
            "thermal_status": "no model lets temperatures follow from losses"
        }
    model = heating.model
    history = heating.history
    k = int(np.searchsorted(heating.times, times[-1], side="right")) - 1
    until = heating.temperatures[: k + 1]
    rows = [np.interp(times, heating.times, one) for one in heating.temperatures.T]
    variables = {"course_temperature": np.array(rows).T}
    if history is not None and history.path is not None and history.path.unit == "m":
        variables["radial_clearance"] = history.path.courses[CLEARANCE].at(times)
    values = (
        float(until.max()),
        sum(float(one[k]) for one in heating.heat.values()),
        float(model.capacities() @ (until[-1] - until[0])),
        float(heating.carried[k]),
    )
    return variables, {
        **dict(zip(VALUES, values, strict=True)),
        "hottest_node": model.nodes[int(np.argmax(until.max(axis=0)))],
        "thermal": model.name,
        "thermal_model": repr(model),
        "taken_from_bearing": json.dumps(from_bearing(heating.assembly.scene, model)),
        "thermal_passes": heating.passes,
        "thermal_status": "found in "
        + ("one pass" if heating.passes == 1 else f"{heating.passes} passes")
        + f"; the last one moved no temperature by more than {heating.change:.2g} K",
    }


def model_of(assembly: Assembly) -> ThermalModel | None:
    """Return the thermal model of a scene, with what it takes from its bearing; None where temperatures are given."""
    named = thermal_model(assembly.scene)
    return named.of(assembly) if named is not None and named.nodes else None


def allowed(assembly: Assembly) -> float:
    """Return what temperatures may still change in the last pass [K]."""
    return assembly.scene.accuracy.of("cage_speed") / _PER_KELVIN


def heated(
    study: Warming, assembly: Assembly, progress: Callable[[str, float], None] | None = None
) -> Heating | None:
    """Return the temperatures that a motion leads to; None where they are given."""
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
    times = np.linspace(0.0, study.duration, _INSTANTS)
    if given is not None:
        times = np.union1d(times, given.breaks)
    rolling = _rolling_shares(bearing)
    most = allowed(assembly)
    at = np.tile(start, (times.size, 1))
    tried = list[Array]()
    moved = list[Array]()
    halved = 0
    for count in range(1, _MOST + 1):
        history = _history(study, assembly, bearing, model, given, times, at, most)
        if progress is not None:
            progress(f"temperatures, pass {count}", (count - 1) / max(_USUAL + 1, count + 1))
        try:
            moving, found = _moved(study, bearing, history, times, count)
        except ConvergenceError:
            if not tried or (halved := halved + 1) > _HALVINGS:
                raise
            at = 0.5 * (tried[-1] + at)
            continue
        heat = _heat(moving, found, rolling)
        temperatures, carried = _temperatures(model, start, times, heat)
        step = temperatures - at
        if (change := float(np.abs(step).max())) <= most:
            return Heating(
                assembly=bearing, history=history, model=model, times=times, temperatures=temperatures, heat=heat,
                carried=carried, passes=count, change=change,
            )  # fmt: skip
        tried = [*tried[-_BEFORE:], at]
        moved = [*moved[-_BEFORE:], step]
        at = _accelerated(tried, moved)
    raise ConvergenceError(
        f"temperatures do not settle: after {_MOST} passes through the motion they still change by {change:.3g} K, "
        f"more than {most:.2g} K; shorten study.{study.name}.duration, raise accuracy.tolerance, or hold "
        "temperatures with --set models.thermal=given"
    )


def fraction(heating: Heating | None, done: float) -> float:
    """Return what of a run is done, with passes before it, where of its motion that share is."""
    before = 0 if heating is None else heating.passes
    return (before + done) / (before + 1)


def _accelerated(tried: list[Array], moved: list[Array]) -> Array:
    """Temperatures of the next pass by Anderson's acceleration, from those tried and how a pass moved each."""
    new = tried[-1] + moved[-1]
    if len(tried) < 2:
        return new
    steps = np.array([(b - a).ravel() for a, b in itertools.pairwise(moved)]).T
    ends = np.array([(b - a).ravel() for a, b in itertools.pairwise(tried)]).T + steps
    weights = np.linalg.lstsq(steps, moved[-1].ravel(), rcond=1e-6)[0]
    return np.asarray(new - (ends @ weights).reshape(new.shape))


def _history(
    study: Warming,
    written: Assembly,
    assembly: Assembly,
    model: ThermalModel,
    given: History | None,
    times: Array,
    at: Array,
    error: float,
) -> History | None:
    """The operation with temperatures of the nodes (m, n) at times; as it is given where they stay."""
    if not np.ptp(at, axis=0).any():
        return given
    rows = [
        model.changes(row, written.scene) for row in at
    ]  # of the scene as it is written: no change comes twice
    values = {key: np.array([row[key] for row in rows]) for key in rows[0]}
    path = ThermalPath.from_samples(times, values, error)
    own = {
        key.removeprefix("operation."): course
        for key, course in path.courses.items()
        if key != CLEARANCE
    }
    known: dict[str, Any] = {name: own[name] for name in TEMPERATURES if name in own}
    operation = assembly.scene.operation
    if given is None:
        named = ("inner_speed", "outer_speed", "radial_load")
        courses = {name: constant(getattr(operation, name)) for name in named} | {
            "load_direction": constant(0.0)
        }
        given = History(courses=courses, given=(), end=study.duration)
    return attrs.evolve(
        given, courses={**given.courses, **known}, prescribed=(*given.prescribed, *known), path=path
    )


def _moved(
    study: Warming, assembly: Assembly, history: History | None, times: Array, count: int
) -> tuple[MovingBearing, Trajectory]:
    """The motion along a history."""
    try:
        moving = study.moving_along(history, assembly)
        found = explained(study.trial_motion(moving, times, study.relative_tolerance), moving)
    except (SceneError, DomainError) as error:
        raise _failed(count, str(error)) from error
    if found.outcome != "finished":
        raise _failed(count, found.message) from found.error
    return moving, found


def _failed(count: int, message: str) -> ConvergenceError:
    at = (
        "the temperatures of the start"
        if count == 1
        else f"the temperatures after pass {count - 1}"
    )
    return ConvergenceError(
        f"temperatures over the motion are not known: at {at} it fails: {message}; look at it with temperatures held, "
        "by --set models.thermal=given, or cool the bearing more"
    )


def _heat(
    moving: MovingBearing, found: Trajectory, rolling: tuple[Array, Array]
) -> dict[str, Array]:
    """Heat made since the start by place [J], (m,), from the ledger.

    A torque T on the cage makes the heat -int T (w_c - w_b) dt with the body b that bears its reaction; the ledger has
    int T w_c dt and int T dt, and w_b is that of the middle of an interval.
    """
    of = moving.split(found.y)
    t = found.t
    with np.errstate(divide="ignore", invalid="ignore"):  # a cage whose epicyclic speed is none
        slip = np.nan_to_num(1.0 - of["cage_speed"] / moving.epicyclic_speeds(t)[0])
    inner = np.interp(0.5 * (slip[1:] + slip[:-1]), *rolling) * np.diff(of["lost_rolling"])
    rolled = np.concatenate(([0.0], np.cumsum(inner)))
    heat = {
        f"{ring} contact": of[f"lost_{ring}"] + resisted + 0.5 * of.get("lost_damping", 0.0)
        for ring, resisted in zip(RINGS, (rolled, of["lost_rolling"] - rolled), strict=True)
    }
    heat["pocket"] = of["lost_pockets"]
    cage = moving.assembly.cage
    torques = cage.drags.torques
    if "lost_land" in of:  # the land itself moves there, and no torque stands for it
        heat["oil" if cage.guidance not in RINGS else f"{cage.guidance} land"] = of["lost_land"]
        torques = tuple(torque for torque in torques if torque.against not in RINGS)
    work = np.diff(of["work_drag"])
    turned = np.diff(of["impulse_drag"])
    now = moving.ring_speeds(t)
    for torque, fraction in zip(
        torques, _shares(moving, torques, t, of["cage_speed"], now), strict=True
    ):
        against = torque.against
        place, body = (
            ("oil", 0.0) if against not in RINGS else (f"{against} land", now[RINGS.index(against)])
        )
        middle = body if isinstance(body, float) else 0.5 * (body[1:] + body[:-1])
        made = fraction * (middle * turned - work)
        heat[place] = heat.get(place, 0.0) + np.concatenate(([0.0], np.cumsum(made)))
    return heat


def _shares(
    moving: MovingBearing, torques: Any, times: Array, cage: Array, rings: Array
) -> list[Any]:
    """What of the torque on the cage each drag gives over every interval, at the temperatures of one station."""
    if len(torques) < 2:
        return [1.0] * len(torques)
    sign = moving.direction
    values = np.array(
        [
            [
                one.torque(sign * c, sign * i, sign * o, *([t] if one.varies_in_time else ()))
                for t, c, i, o in zip(times, cage, *rings, strict=True)
            ]
            for one in torques
        ]
    )
    values = 0.5 * (values[:, 1:] + values[:, :-1])
    whole = values.sum(axis=0)
    return list(
        np.divide(values, whole, out=np.full(values.shape, 1.0 / len(torques)), where=whole != 0.0)
    )


def _rolling_shares(assembly: Assembly) -> tuple[Array, Array]:
    """Cage slips, and what of the heat of resistance to rolling is made at the inner ring there."""
    if assembly.cage.drags.resistance is None:
        return np.zeros(1), np.full(1, 0.5)
    there = assembly.with_resistance()
    balance = TorqueBalance(
        there, there.cage.drags, n_positions=assembly.resolution.n_positions or _ORBIT
    )
    found = dict[float, float]()
    for slip in _SLIPS:
        with suppress(DomainError, ConvergenceError):  # a slip that the motion need not come to
            losses = power_balance(balance, balance.orbit(slip)).losses
            inner, outer = (
                sum(
                    one.power
                    for one in losses
                    if one.place == f"{ring} contact" and "sliding" not in one.source
                )
                for ring in RINGS
            )
            found[slip] = inner / (inner + outer) if inner + outer > 0.0 else 0.5
    return np.array([*found] or [0.0]), np.array([*found.values()] or [0.5])


def _temperatures(
    model: ThermalModel, start: Array, times: Array, heat: Mapping[str, Array]
) -> tuple[Array, Array]:
    """Temperatures of the nodes [K], (m, n), and heat carried away since the start [J], (m,), with heat by place."""
    from scipy.linalg import expm

    capacities = model.capacities()
    n = start.size
    rows = [start]
    carried = [0.0]
    known: tuple[Array, Array] | None = None
    for k, lasts in enumerate(np.diff(times)):
        T = rows[-1]
        power = {place: float(of[k + 1] - of[k]) / lasts for place, of in heat.items()}

        def flows(
            at: Array, power: Mapping[str, float] = power
        ) -> Array:  # into the nodes, and out of the bearing
            return np.append(
                model.inflows(at, power) / capacities, sum(model.carried_away(at).values())
            )

        now = flows(T)
        linear = np.zeros((2 * n + 2, 2 * n + 2))
        for j in range(n):
            linear[: n + 1, j] = lasts * (flows(T + _STEP * (np.arange(n) == j)) - now) / _STEP
        linear[: n + 1, n + 1 :] = lasts * np.eye(n + 1)
        if known is None or not np.allclose(
            linear, known[0], rtol=_SAME, atol=_SAME * float(np.abs(linear).max())
        ):
            known = linear, expm(linear)[: n + 1, n + 1 :]
        moved = known[1] @ now
        rows.append(T + moved[:n])
        carried.append(carried[-1] + float(moved[n]))
    return np.array(rows), np.array(carried)


def part(study: Warming, assembly: Assembly, costs: dict[str, float]) -> list[Part]:
    """Return the line of the plan about temperatures that follow from losses; none where they are given."""
    model = model_of(assembly)
    if model is None:
        return []
    return [
        Part(
            part="temperatures",
            choice=f"{model.name}: {', '.join(model.nodes)}",
            resolution=f"passes through the motion until they change by at most {allowed(assembly):.2g} K",
            reason="models.thermal names it; all else is chosen at the temperatures that it starts from",
            study=study.name,
            seconds=costs.pop("temperatures", None),
        )
    ]


def cost(study: Warming, assembly: Assembly, motion: float) -> dict[str, float]:
    """Return the time [s] that passes take, from that of a motion and of one more bearing at another temperature."""
    model = model_of(assembly)
    if model is None:
        return {}
    warmer = with_changes(
        assembly, model.changes(model.start(assembly.scene) + _STEP, assembly.scene)
    )
    one = timed(lambda: study.moving_along(study.course(warmer), warmer), 1)
    return {"temperatures": _USUAL * (_ALONG * motion + _BEARINGS * one)}
