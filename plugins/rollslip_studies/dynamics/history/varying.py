"""The motion of a bearing whose operation varies: `Varying` with its stations, and what studies ask of any motion."""

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
    Axis,
    Stations,
    of_bearing,
    operated,
)
from rollslip_studies.dynamics.history.settings import History
from rollslip_studies.dynamics.history.temperature_path import ThermalPath
from rollslip_studies.dynamics.history.time_functions import Course, constant
from rollslip_studies.dynamics.levels.moving_bearing import MovingBearing
from rollslip_studies.dynamics.levels.planar import PlanarSettings
from rollslip_studies.dynamics.levels.raceway_friction import FrictionSettings

#: Share of the largest epicyclic speed of the cage below which no slip is told: it would refer to next to nothing.
STILL: Final = 0.05
#: Speeds over their typical ones below which a motion rests, at how many times it is looked for that, and the first of
#: them in the time that the rings rest.
_REST: Final = 1e-4
_STOPS = 25
_SOON = 1e-3
#: Evenly spread instants of a history at which it is looked how fast a motion moves, and at most as many breaks.
_LOOKS: Final = 9
#: Share of the tolerance that loads and tables of a station may take.
_TABLES: Final = 0.3
#: Share of that between nodes of effective friction: how many there are differs from station to station, and the errors
#: are relative to the largest friction, which at low speed is ten times that of most slips.
_BETWEEN_NODES: Final = 0.1


@attrs.frozen
class PathAxis(Axis):
    """Places on a path through temperatures."""

    path: ThermalPath

    @property
    def unit(self) -> str:
        """SI unit of the value: K only where loads stay, since bearings that differ by kelvins share theirs."""
        return self.path.unit

    def value(self, place: float) -> float:
        """Return what tells a place [K, m]."""
        return self.path.value(place)


@attrs.frozen(eq=False, kw_only=True)
class PathStations(Stations):
    """Stations of which the last axis is a path."""

    def bearing(self, place: tuple[float, ...]) -> Assembly:
        """Return the bearing at a place on the axes."""
        known = self._bearings
        axis = self.axes[-1]
        if place not in known:
            assert isinstance(axis, PathAxis)
            here = axis.path.bearing(self.assembly, place[-1])
            same = {of.name: getattr(self, of.name) for of in attrs.fields(Stations) if of.init}
            known[place] = Stations(**(same | {"assembly": here, "axes": self.axes[:-1]})).bearing(
                place[:-1]
            )
        return known[place]


@attrs.frozen(eq=False, kw_only=True)
class VaryingMotion(MovingBearing):
    """The motion of a bearing along a history."""

    history: History  # how the operation goes over time
    stations: Stations  # bearings between which its rates are interpolated
    base: MovingBearing  # one of them

    @property
    def names(self) -> tuple[Mapping[str, str], Mapping[str, str], Mapping[str, str]]:
        """Unknowns of the head, of each roller and of the ledger, in order -> their unit."""
        return self.base.names

    @cached_property
    def breaks(self) -> tuple[float, ...]:
        """Times of jumps and kinks of the history, and those at which it is looked whether it came to rest [s]."""
        known = self.history.breaks
        end = self.history.end
        last = max(known, default=end)
        if not self.history.rings_rest(last, end):
            return known
        return *known, *(last + (end - last) * np.geomspace(_SOON, 1.0, _STOPS)[:-1]).tolist()

    def at_rest(self, t: float, end: float, y: Array) -> bool:
        """Return whether the bearing rests in a state, and does so up to a later time [s].

        So it does where rings and cage stand, and each roller stands too or is free. A stiff contact at rest makes an
        integrator take one step of less than a microsecond after the other.
        """
        if self.stations.level != "cage-set" or not self.history.rings_rest(t, end):
            return False
        now = self.split(y)
        scale = self.split(self.system.scale)
        spins = np.abs(now["roller_spin"]) <= _REST * scale["roller_spin"]
        if not (spins.any() and abs(now["cage_speed"]) <= _REST * scale["cage_speed"]):
            return False
        lost = (end - t) * np.abs(self.split(self.system(t, y))["roller_spin"])
        return bool((spins | (lost <= _REST * scale["roller_spin"])).all())

    @property
    def tables(self) -> dict[str, str]:
        """Attributes of a result that say how right the tables of one of the bearings are."""
        return self.base.tables

    @property
    def way(self) -> str:
        """How friction is evaluated, and what else there is a table of, in words."""
        return self.base.way

    @property
    def tolerances(self) -> tuple[Array, Array]:
        """Absolute and relative tolerances of the unknowns, those under the largest load."""
        return self.base.tolerances

    def unslipped(self, t: Array) -> tuple[Array, Array]:
        """Return the epicyclic speeds of cage and rollers at times [rad/s]; of the cage NaN where it is too slow."""
        cage, roller = epicyclic(self.assembly, self.history, t)
        slow = np.abs(cage) <= STILL * _fastest(self.assembly, self.history)
        return np.where(slow, np.nan, cage), np.where(slow, np.nan, roller)

    def ring_speeds(self, t: Array) -> Array:
        """Return the speeds of inner and outer ring at times [rad/s], in the sense of the cage's, (2, m)."""
        now = self.history.at(t)
        return np.array([self.direction * now["inner_speed"], self.direction * now["outer_speed"]])

    def initial(self, cage_slip: float = 0.0, roller_slip: float = 0.0) -> Array:
        """Return the state with these slips at the operation that the history begins with."""
        return self._state(0.0, cage_slip, roller_slip)

    def looks(self) -> tuple[Array, Array]:
        """Return instants of the history and states without slip there: where it breaks, and evenly over it."""
        breaks = np.array(self.breaks)
        even = np.linspace(0.0, self.history.end, _LOOKS)
        times = np.union1d(even, breaks[:: 1 + breaks.size // _LOOKS])
        return times, np.array([self._state(float(t)) for t in times])

    def _state(self, t: float, cage_slip: float = 0.0, roller_slip: float = 0.0) -> Array:
        now = {name: float(value) for name, value in self.history.at(t).items()}
        cage, roller = (
            float(one[0]) for one in epicyclic(self.assembly, self.history, np.full(1, t))
        )
        speed = (1.0 - cage_slip) * cage
        spin = (1.0 - roller_slip) * roller
        if (now["inner_speed"], now["outer_speed"]) == self.stations.speeds:
            speeds = self.base.assembly.kinematics.surface_speeds(cage_slip, roller_slip)
            speed = float(speeds.cage_speed)
            spin = float(speeds.roller_speed)
        return self.base.state_at(
            speed, spin, now["radial_load"], self.direction * now["load_direction"]
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
        """Return the error that says in words what was refused: the ``reason`` of a ``RefusedError``."""
        by = self.system.owner.refused_by
        return next(
            motion for motion in self.stations.motions.values() if motion.system.owner is by
        ).error(refusal)


def epicyclic(assembly: Assembly, history: History, t: Array) -> tuple[Array, Array]:
    """Return the epicyclic speeds of cage and rollers at times [rad/s], in the sense in which rolling is positive."""
    k = assembly.kinematics
    now = history.at(t)
    inner = k.inner_radius
    outer = k.outer_radius
    cage = k.direction * (inner * now["inner_speed"] + outer * now["outer_speed"]) / (inner + outer)
    apart = k.direction * (now["inner_speed"] - now["outer_speed"])
    return cage, inner * outer / (inner + outer) * apart / k.roller_radius


def _fastest(assembly: Assembly, history: History) -> float:
    """Largest epicyclic speed of the cage [rad/s]: at an instant of a thousand, a break or a node of a table."""
    ends = [course.begin for name, course in history.courses.items() if name.endswith("_speed")]
    times = np.concatenate((np.linspace(0.0, history.end, 1001), *ends))
    return float(np.abs(epicyclic(assembly, history, times[times <= history.end])[0]).max())


def varying_motion(
    assembly: Assembly,
    friction: FrictionSettings,
    history: History,
    *,
    level: str,
    planar: PlanarSettings | None = None,
    limit: Course | None = None,
) -> VaryingMotion:
    """Build the motion of a bearing along a history."""
    k = assembly.kinematics
    spans = history.spans
    speeds = _fastest_speeds(assembly, history)
    if "load_direction" in history.given and (tilt := assembly.scene.operation.misalignment) != 0.0:
        raise DomainError(
            f"the load turns, and operation.misalignment, {tilt:g} rad, is about the line of a load that does not; "
            "make it 0, or leave load_direction out"
        )
    top = max(map(abs, spans["inner_speed"])), max(map(abs, spans["outer_speed"]))
    _refuse_turning(assembly, top, planar is not None)
    if (
        "load_direction" in history.given
        and planar is None
        and assembly.rings is not None
        and _stands(assembly.rings)
    ):
        raise DomainError(
            "the load turns, and rings or raceways that are not alike all round stand; choose level 'planar', or leave "
            "load_direction out"
        )
    taken = set[str]().union(*(taken_from_scene(model) for model in assembly.cage.named))
    # effective friction is an average over the loads, and a drag may take the load of its scene
    read = planar is not None and not (friction.name == "effective" or "radial_load" in taken)
    mapped = [name for name in history.conditions if not (read and name == "radial_load")]
    axes = [Axis.of(name, *spans[name]) for name in mapped if name in history.varies]
    if friction.name == "effective" and {"inner_speed", "outer_speed"} & {*history.varies}:
        if not history.speeds_in_proportion():
            raise DomainError(
                "effective friction follows speeds that change in proportion, or of one ring alone; both change "
                "differently here: conventional friction takes that"
            )
        axes.append(Axis("speed", 0.0, abs(speeds[0] - speeds[1])))
    if (path := history.path) is not None:
        axes.append(PathAxis(path.name, 0.0, 1.0, path))
    if len(axes) > MAX_AXES:
        over = ", ".join(axis.name.replace("_", " ") for axis in axes)
        raise DomainError(
            f"tables over {over} are more than {MAX_AXES} at once; keep some of them the same, or let "
            "operation.temperature stand for the parts"
        )
    held = {name: spans[name][0] for name in history.conditions if name not in history.varies}
    if read:
        held["radial_load"] = spans["radial_load"][1]
    steady = _held(assembly, held)
    requested = assembly.scene.accuracy.of("cage_speed")
    plain = attrs.evolve(friction, critical_slip=float("nan"))
    if axes:  # tables differ by their errors, of which interpolation can make nothing better
        plain = attrs.evolve(
            plain,
            tolerance=min(friction.table_tolerance(assembly), _TABLES * requested),
            between_nodes=_BETWEEN_NODES,
        )
    if "radial_load" in history.varies and (planar is not None or friction.name == "conventional"):
        plain = attrs.evolve(plain, like=_held(assembly, {"radial_load": spans["radial_load"][1]}))
    stations = (Stations if path is None else PathStations)(
        assembly=steady,
        speeds=speeds,
        top_speeds=top,
        axes=tuple(axes),
        friction=plain,
        level=level,
        planar=planar,
        tolerance=requested,
        speeds_vary=bool({"inner_speed", "outer_speed"} & {*history.varies}),
    )
    base = stations.motion(tuple(axis.high for axis in axes))
    stations.motion(
        tuple(axis.roots[0] for axis in axes)
    )  # what cannot be put together is told before a run
    courses = [
        history.courses[name].scaled(k.direction)
        for name in ("inner_speed", "outer_speed", "load_direction")
    ]
    courses.append(history.courses["radial_load"])
    courses.append(constant(float("nan")) if limit is None else limit)
    for axis in axes:
        of_axis = axis.path.along if isinstance(axis, PathAxis) else history.courses.get(axis.name)
        courses.append(
            constant(0.0) if of_axis is None else of_axis
        )  # of a speed, which the rates know
    names = [axis.name for axis in axes]
    varying = Varying(
        [(course.begin, course.powers) for course in courses],
        [(axis.roots[0], axis.high) for axis in axes],
        stations.around,
        speed_axis=names.index("speed") if "speed" in names else -1,
        root_axis=names.index("radial_load") if "radial_load" in names else -1,
        cage_speed=list(base.names[0]).index("cage_speed"),
        inner_fraction=k.inner_radius / (k.inner_radius + k.outer_radius),
        still=STILL * _fastest(assembly, history),
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


def _stands(rings: Rings) -> bool:
    """Whether rings have a direction of their own, by a form, what pushes on them, stops or shapes of several waves."""
    return bool(rings.waves or rings.tables) or any(
        ring.stops is not None
        or np.any(ring.pushes)
        or np.any(np.count_nonzero(ring.harmonics, axis=1) > 1)
        for ring in (rings.inner, rings.outer)
    )


def _refuse_turning(assembly: Assembly, top_speeds: tuple[float, float], planar: bool) -> None:
    """Refuse what stands in the line of load and turns at some time."""
    b = assembly.scene.bearing
    models = assembly.scene.models
    for ring, speed in zip(RINGS, top_speeds, strict=True):
        if speed == 0.0:
            continue
        raceway = getattr(b, f"{ring}_raceway")
        choice = getattr(models, f"{ring}_ring")
        if raceway is not None and raceway.form and not planar:
            raise DomainError(
                f"the {ring} ring turns along the history, with the form of its raceway; choose level 'planar', which "
                f"follows that, keep {ring}_speed at 0, or leave the form out"
            )
        if choice is not None:
            at = Location(assembly.scene.origins, ("models", f"{ring}_ring"))
            try:
                structure_model("ring", {"model": choice.name, **choice.parameters}, at, []).shapes(
                    b, ring, True
                )
            except FieldError as error:
                raise SceneError([at.at(error.field).message(error.reason)]) from None


def _held(assembly: Assembly, values: Mapping[str, float]) -> Assembly:
    """The bearing at the values that stay the same, put together once."""
    return assembly.cached(
        "held", (of_bearing(assembly), *values.items()), lambda: operated(assembly, values)
    )


def _fastest_speeds(assembly: Assembly, history: History) -> tuple[float, float]:
    """Speeds of the rings where they turn fastest against each other, in the direction of the scene."""
    inner = history.courses["inner_speed"]
    outer = history.courses["outer_speed"]
    times = np.unique(
        np.concatenate((np.linspace(0.0, history.end, 1001), inner.begin, outer.begin))
    )
    times = times[(times >= 0.0) & (times <= history.end)]
    w_i = inner.at(times)
    w_o = outer.at(times)
    k = int(np.argmax(np.abs(w_i - w_o)))
    apart = float(w_i[k] - w_o[k])
    if apart == 0.0:
        raise DomainError("nothing rolls at any time: the history keeps both rings at one speed")
    sense = 1.0 if (apart > 0.0) == (assembly.kinematics.direction > 0) else -1.0
    return sense * float(w_i[k]), sense * float(w_o[k])
