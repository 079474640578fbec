"""The motion of a bearing along a history of its operation: ring speeds, load, its direction and temperatures.

The rates of the motion are interpolated between *stations*, bearings at fixed operations (`interpolated_rates`). The
compiled system `Varying` evaluates the history as piecewise cubics of time and blends the rates of the stations.

`varying_motion` builds such a motion:

1. Refuse histories that no level describes: rings at one speed, a turning load on tilted or shaped rings.
2. Choose the axes of the interpolation: each load or temperature that varies, the difference of the ring speeds where
   friction is effective, or one path through all temperatures.
3. Fix the values that do not vary, and choose the tolerance of the tables of a station.
4. Build the stations at both ends of all axes, so that a bearing that cannot be assembled is refused before a run.
5. Pass the time functions, the axes and the stations to the compiled system.
"""

import math
from collections.abc import Mapping
from functools import cached_property
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.drags import taken_from_scene
from rollslip.bearing.raceway import RINGS, Array
from rollslip.catalogue.registry import structure_model
from rollslip.errors import DomainError, RollslipError, SceneError
from rollslip.fields import FieldError
from rollslip.rings import Rings
from rollslip.structure import Location
from rollslip_kernels.motion.system import System
from rollslip_kernels.motion.varying import MAX_AXES, Varying
from rollslip_studies.dynamics.history.interpolated_rates import (
    MIN_SPEED_FRACTION,
    Axis,
    PathAxis,
    Stations,
    bearing_resolution,
    with_operation,
)
from rollslip_studies.dynamics.history.settings import History
from rollslip_studies.dynamics.history.time_functions import Course, constant
from rollslip_studies.dynamics.levels.moving_bearing import MovingBearing
from rollslip_studies.dynamics.levels.planar import PlanarSettings
from rollslip_studies.dynamics.levels.raceway_friction import FrictionSettings

#: Epicyclic cage speed, relative to its largest value in the history, below which no slip is reported: slip is relative
#: to that speed. Doubling it reports slips over a shorter time of a run-up. Chosen.
MIN_EPICYCLIC_FRACTION: Final = 0.05
#: Speed, relative to its typical magnitude, below which a part is at rest. Doubling it stops the integration of a
#: motion that coasts down a little earlier. Chosen; far below any speed that a result shows.
_REST_SPEED: Final = 1e-4
#: Number of times after the rings stop at which the motion is checked for rest. Halving it integrates bearings at rest
#: longer, in steps below a microsecond; doubling it interrupts the integrator more often. Chosen.
_REST_CHECKS: Final = 25
#: First of these times, relative to the time that the rings are at rest; the others follow in a geometric series.
#: Doubling it delays the first check. Chosen.
_FIRST_REST_CHECK: Final = 1e-3
#: Number of evenly spaced times at which the cost of a motion is sampled, and the maximum number of breaks that are
#: added to them. Doubling it doubles the cost of an estimate and finds shorter peaks of speed. Chosen.
_SAMPLES: Final = 9
#: Fraction of the requested tolerance that loads and tables of a station may use. The interpolation between stations
#: takes another (`interpolated_rates`). Doubling it makes tables coarser and lets their errors look like interpolation
#: errors. Chosen.
_TABLE_FRACTION: Final = 0.3
#: Fraction of that tolerance for effective friction between its nodes. The number of nodes differs from station to
#: station, and the errors are relative to the largest friction, which at low speed is ten times that at most slips.
#: Doubling it makes these tables coarser. Chosen.
_BETWEEN_NODES: Final = 0.1
#: Number of times at which extreme speeds of the rings are sampled, in addition to the nodes of the time functions.
#: Halving it may miss the peak of a short sine. Chosen; the evaluation is vectorised and costs less than a millisecond.
_SPEED_SAMPLES: Final = 1001


@attrs.frozen(eq=False, kw_only=True)
class VaryingMotion(MovingBearing):
    """The motion of a bearing along a history."""

    history: History  # the operation over time
    stations: Stations  # bearings between which the rates are interpolated
    base: MovingBearing  # the station at the upper ends of all axes

    @property
    def names(self) -> tuple[Mapping[str, str], Mapping[str, str], Mapping[str, str]]:
        """Unknowns of the head, of each roller and of the ledger, in order -> their unit."""
        return self.base.names

    @cached_property
    def breaks(self) -> tuple[float, ...]:
        """Times of jumps and kinks of the history, and times at which the motion is checked for rest [s]."""
        of_history = self.history.breaks
        end = self.history.end
        last = max(of_history, default=end)
        if not self.history.rings_rest(last, end):
            return of_history
        return *of_history, *(
            last + (end - last) * np.geomspace(_FIRST_REST_CHECK, 1.0, _REST_CHECKS)[:-1]
        ).tolist()

    def at_rest(self, t: float, end: float, y: Array) -> bool:
        """Return whether the bearing is at rest in a state, and stays at rest until a later time [s].

        It is where rings and cage are at rest, and each roller is at rest too or is not accelerated by that time. A
        stiff contact at rest would make an integrator take steps of less than a microsecond.

        Parameters
        ----------
        t, end : float
            Time of the state, and the later time [s].
        y : ndarray, shape (n,)
            The state, in the units of `units`.
        """
        if self.stations.level != "cage-set" or not self.history.rings_rest(t, end):
            return False
        state = self.split(y)
        scale = self.split(self.system.scale)
        resting = np.abs(state["roller_spin"]) <= _REST_SPEED * scale["roller_spin"]
        if not (resting.any() and abs(state["cage_speed"]) <= _REST_SPEED * scale["cage_speed"]):
            return False
        change = (end - t) * np.abs(self.split(self.system(t, y))["roller_spin"])
        return bool((resting | (change <= _REST_SPEED * scale["roller_spin"])).all())

    @property
    def tables(self) -> dict[str, str]:
        """Attributes of a result with sizes and errors of the tables of one of the stations."""
        return self.base.tables

    @property
    def evaluation_method(self) -> str:
        """How friction is evaluated, and which other tables there are, in words."""
        return self.base.evaluation_method

    @property
    def tolerances(self) -> tuple[Array, Array]:
        """Absolute and relative tolerances of the unknowns: those under the largest load."""
        return self.base.tolerances

    def epicyclic_speeds(self, t: Array) -> tuple[Array, Array]:
        """Return the epicyclic speeds of cage and rollers at times [rad/s]; NaN where slip has no value."""
        cage, roller = epicyclic_speeds(self.assembly, self.history, t)
        slow = np.abs(cage) <= _min_epicyclic_speed(self.assembly, self.history)
        return np.where(slow, np.nan, cage), np.where(slow, np.nan, roller)

    def ring_speeds(self, t: Array) -> Array:
        """Return the speeds of inner and outer ring at times [rad/s], (2, m); positive in the sense of rolling."""
        operation = self.history.at(t)
        return np.array(
            [self.direction * operation["inner_speed"], self.direction * operation["outer_speed"]]
        )

    def initial(self, cage_slip: float = 0.0, roller_slip: float = 0.0) -> Array:
        """Return the state with these slips at the operation at the start of the history."""
        return self._state(0.0, cage_slip, roller_slip)

    def sample_states(self) -> tuple[Array, Array]:
        """Return times [s], (m,), at breaks of the history and evenly over it, and states without slip, (m, n)."""
        breaks = np.array(self.breaks)
        times = np.union1d(
            np.linspace(0.0, self.history.end, _SAMPLES), breaks[:: 1 + breaks.size // _SAMPLES]
        )
        return times, np.array([self._state(float(t)) for t in times])

    def _state(self, t: float, cage_slip: float = 0.0, roller_slip: float = 0.0) -> Array:
        """Return the state with these slips at the operation at a time [s]."""
        operation = {name: float(value) for name, value in self.history.at(t).items()}
        cage_speed, roller_speed = (
            float(speed[0])
            for speed in epicyclic_speeds(self.assembly, self.history, np.full(1, t))
        )
        cage_speed = (1.0 - cage_slip) * cage_speed
        roller_speed = (1.0 - roller_slip) * roller_speed
        if (operation["inner_speed"], operation["outer_speed"]) == self.stations.speeds:
            speeds = self.base.assembly.kinematics.surface_speeds(cage_slip, roller_slip)
            cage_speed = float(speeds.cage_speed)
            roller_speed = float(speeds.roller_speed)
        return self.base.state_at(
            cage_speed,
            roller_speed,
            operation["radial_load"],
            self.direction * operation["load_direction"],
        )

    def state_at(
        self, cage_speed: float, roller_speed: float, load: float, direction: float
    ) -> Array:
        """Return the state with these speeds [rad/s] under a load [N] in a direction [rad]."""
        return self.base.state_at(cage_speed, roller_speed, load, direction)

    def energy(self, y: Array) -> Array:
        """Return the kinetic energy of cage and rollers, and the elastic energy of the pockets [J], (...)."""
        return self.base.energy(y)

    def angular_momentum(self, y: Array) -> Array:
        """Return the angular momentum of cage and rollers about the axis of the bearing [N m s], (...)."""
        return self.base.angular_momentum(y)

    def error(self, refusal: Any) -> RollslipError:
        """Return the error for the ``reason`` of a ``RefusedError``, by the station that refused the state."""
        refusing_system = self.system.owner.refused_by
        return next(
            motion
            for motion in self.stations.motions.values()
            if motion.system.owner is refusing_system
        ).error(refusal)


def epicyclic_speeds(assembly: Assembly, history: History, t: Array) -> tuple[Array, Array]:
    """Return the epicyclic speeds of cage and rollers at times [rad/s], in the sense in which rolling is positive."""
    k = assembly.kinematics
    operation = history.at(t)
    inner = k.inner_radius
    outer = k.outer_radius
    cage = (
        k.direction
        * (inner * operation["inner_speed"] + outer * operation["outer_speed"])
        / (inner + outer)
    )
    difference = k.direction * (operation["inner_speed"] - operation["outer_speed"])
    return cage, inner * outer / (inner + outer) * difference / k.roller_radius


def _min_epicyclic_speed(assembly: Assembly, history: History) -> float:
    """Return the epicyclic cage speed [rad/s] below which slip has no value; see `MIN_EPICYCLIC_FRACTION`."""
    times = np.concatenate(
        (
            np.linspace(0.0, history.end, _SPEED_SAMPLES),
            *[course.starts for name, course in history.courses.items() if name.endswith("_speed")],
        )
    )
    cage, _ = epicyclic_speeds(assembly, history, times[times <= history.end])
    return MIN_EPICYCLIC_FRACTION * float(np.abs(cage).max())


def varying_motion(
    assembly: Assembly,
    friction: FrictionSettings,
    history: History,
    *,
    level: str,
    planar: PlanarSettings | None = None,
    limit: Course | None = None,
) -> VaryingMotion:
    """Build the motion of a bearing along a history.

    Parameters
    ----------
    assembly : Assembly
        The bearing as the scene states it.
    friction : FrictionSettings
        Friction of the raceways.
    history : History
        The operation over time.
    level : str
        "cage-set", "pocket" or "planar".
    planar : PlanarSettings, optional
        Masses, damping and gravity of level planar; None at the other levels.
    limit : Course, optional
        Slip over time that is watched, for example that of skidding; none by default.

    Raises
    ------
    DomainError
        If the level or the friction does not describe this history.
    SceneError
        If a ring of the scene may not turn.
    """
    speeds = _fastest_speeds(assembly, history)
    spans = history.spans
    top_speeds = max(map(abs, spans["inner_speed"])), max(map(abs, spans["outer_speed"]))
    _check_rings(assembly, history, top_speeds, planar is not None)
    # Only the rates of plane motion follow the load of the moment, so that the load needs no axis. Effective friction
    # is an average over the loads, and a drag may take the load of its scene.
    of_scene = set[str]().union(*map(taken_from_scene, assembly.cage.named))
    load_in_rates = planar is not None and not (
        friction.name == "effective" or "radial_load" in of_scene
    )
    axes = _interpolation_axes(friction, history, speeds, load_in_rates)
    fixed = {name: spans[name][0] for name in history.conditions if name not in history.varies}
    if load_in_rates:
        fixed["radial_load"] = spans["radial_load"][1]
    stations = Stations(
        assembly=_with_fixed_values(assembly, fixed),
        speeds=speeds,
        top_speeds=top_speeds,
        axes=axes,
        friction=_station_friction(assembly, friction, history, axes, planar),
        level=level,
        planar=planar,
        tolerance=assembly.scene.accuracy.of("cage_speed"),
        speeds_vary=bool({"inner_speed", "outer_speed"} & {*history.varies}),
    )
    base = stations.motion(tuple(axis.high for axis in axes))
    # a bearing that cannot be assembled at the lower ends is refused here, before a run
    stations.motion(tuple(axis.low for axis in axes))
    k = assembly.kinematics
    axis_numbers = {axis.name: k for k, axis in enumerate(axes)}
    varying = Varying(
        [(course.starts, course.powers) for course in _courses(history, axes, limit, k.direction)],
        [(axis.low, axis.high) for axis in axes],
        stations.interpolation_cell,
        speed_axis=axis_numbers.get("speed", -1),
        root_axis=axis_numbers.get("radial_load", -1),
        cage_speed=list(base.names[0]).index("cage_speed"),
        inner_fraction=k.inner_radius / (k.inner_radius + k.outer_radius),
        still=_min_epicyclic_speed(assembly, history),
        autonomous=not (history.varies or assembly.cage.drags.in_time),
        scale=base.system.scale,
    )
    return VaryingMotion(
        assembly=assembly,
        friction=base.friction,
        system=System(varying.system(base.system.frequencies[1])),
        history=history,
        stations=stations,
        base=base,
    )


def _interpolation_axes(
    friction: FrictionSettings,
    history: History,
    speeds: tuple[float, float],
    load_in_rates: bool,
) -> tuple[Axis, ...]:
    """Return the axes between whose nodes rates are interpolated; refuse more than the compiled system has."""
    axes = [
        Axis.of(name, *history.spans[name])
        for name in history.conditions
        if name in history.varies and not (load_in_rates and name == "radial_load")
    ]
    if friction.name == "effective" and {"inner_speed", "outer_speed"} & {*history.varies}:
        if not history.speeds_in_proportion():
            raise DomainError(
                "effective friction follows speeds that change in proportion, or of one ring alone; both change "
                "differently here: conventional friction takes that"
            )
        top = abs(speeds[0] - speeds[1])
        axes.append(Axis("speed", MIN_SPEED_FRACTION * top, top))
    if history.path is not None:
        axes.append(PathAxis(history.path.name, 0.0, 1.0, history.path))
    if len(axes) > MAX_AXES:
        over = ", ".join(axis.name.replace("_", " ") for axis in axes)
        raise DomainError(
            f"tables over {over} are more than {MAX_AXES} at once; keep some of them the same, or let "
            "operation.temperature stand for the parts"
        )
    return tuple(axes)


def _station_friction(
    assembly: Assembly,
    friction: FrictionSettings,
    history: History,
    axes: tuple[Axis, ...],
    planar: PlanarSettings | None,
) -> FrictionSettings:
    """Return the friction of each station: with finer tables, since interpolation cannot reduce their errors."""
    of_station = attrs.evolve(friction, critical_slip=float("nan"))
    if axes:
        of_station = attrs.evolve(
            of_station,
            tolerance=min(
                friction.table_tolerance(assembly),
                _TABLE_FRACTION * assembly.scene.accuracy.of("cage_speed"),
            ),
            between_nodes=_BETWEEN_NODES,
        )
    if "radial_load" in history.varies and (planar is not None or friction.name == "conventional"):
        of_station = attrs.evolve(
            of_station,
            fully_loaded=_with_fixed_values(
                assembly, {"radial_load": history.spans["radial_load"][1]}
            ),
        )
    return of_station


def _courses(
    history: History, axes: tuple[Axis, ...], limit: Course | None, direction: int
) -> list[Course]:
    """Return the time functions in the order of `Varying`: speeds, load direction, load, watched slip, axes."""
    courses = [
        history.courses[name].scaled(direction)
        for name in ("inner_speed", "outer_speed", "load_direction")
    ]
    courses.append(history.courses["radial_load"])
    courses.append(constant(float("nan")) if limit is None else limit)
    for axis in axes:
        course = (
            axis.path.coordinate if isinstance(axis, PathAxis) else history.courses.get(axis.name)
        )
        # the axis of speed has no time function: the rates know the speeds
        courses.append(constant(0.0) if course is None else course)
    return courses


def _has_direction(rings: Rings) -> bool:
    """Return whether a ring has a direction: by a form, forces on it, stops or shapes of several waves."""
    return bool(rings.waves or rings.tables) or any(
        ring.stops is not None
        or np.any(ring.pushes)
        or np.any(np.count_nonzero(ring.harmonics, axis=1) > 1)
        for ring in (rings.inner, rings.outer)
    )


def _check_rings(
    assembly: Assembly, history: History, top_speeds: tuple[float, float], planar: bool
) -> None:
    """Refuse rings with a direction of their own where they turn, or where the load turns round them; and a tilt."""
    turns = "load_direction" in history.prescribed
    tilt = assembly.scene.operation.misalignment
    if turns and tilt != 0.0:
        raise DomainError(
            f"the load turns, and operation.misalignment, {tilt:g} rad, is about the line of a load that does not; "
            "make it 0, or leave load_direction out"
        )
    for ring, speed in zip(RINGS, top_speeds, strict=True):
        if speed != 0.0:
            _check_turning_ring(assembly, ring, planar)
    rings = assembly.rings
    if turns and not planar and rings is not None and _has_direction(rings):
        raise DomainError(
            "the load turns, and rings or raceways that are not alike all round stand; choose level 'planar', or leave "
            "load_direction out"
        )


def _check_turning_ring(assembly: Assembly, ring: str, planar: bool) -> None:
    """Refuse a ring that turns at some time and whose form or model stands in the line of load."""
    bearing = assembly.scene.bearing
    raceway = getattr(bearing, f"{ring}_raceway")
    choice = getattr(assembly.scene.models, f"{ring}_ring")
    if raceway is not None and raceway.form and not planar:
        raise DomainError(
            f"the {ring} ring turns along the history, with the form of its raceway; choose level 'planar', which "
            f"follows that, keep {ring}_speed at 0, or leave the form out"
        )
    if choice is not None:
        location = Location(assembly.scene.origins, ("models", f"{ring}_ring"))
        try:
            structure_model(
                "ring", {"model": choice.name, **choice.parameters}, location, []
            ).shapes(bearing, ring, True)
        except FieldError as error:
            raise SceneError([location.at(error.field).message(error.reason)]) from None


def _with_fixed_values(assembly: Assembly, values: Mapping[str, float]) -> Assembly:
    """Return the bearing at the values [N, K] that do not vary, cached so that it is assembled once."""
    return assembly.cached(
        "fixed values",
        (bearing_resolution(assembly), *values.items()),
        lambda: with_operation(assembly, values),
    )


def _fastest_speeds(assembly: Assembly, history: History) -> tuple[float, float]:
    """Return the speeds of both rings where their difference is largest [rad/s], in the direction of the scene."""
    inner = history.courses["inner_speed"]
    outer = history.courses["outer_speed"]
    times = np.unique(
        np.concatenate((np.linspace(0.0, history.end, _SPEED_SAMPLES), inner.starts, outer.starts))
    )
    times = times[(times >= 0.0) & (times <= history.end)]
    w_i = inner.at(times)
    w_o = outer.at(times)
    k = int(np.argmax(np.abs(w_i - w_o)))
    difference = float(w_i[k] - w_o[k])
    if difference == 0.0:
        raise DomainError("nothing rolls at any time: the history keeps both rings at one speed")
    sense = math.copysign(1.0, difference * assembly.kinematics.direction)
    return sense * float(w_i[k]), sense * float(w_o[k])
