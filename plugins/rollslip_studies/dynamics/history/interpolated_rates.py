"""Stations: bearings in motion at fixed operations, between which the rates of a varying one are interpolated.

- Axes are what varies of radial load and temperatures and, where friction is effective, how fast the rings turn against
  each other: effective friction is tabulated at one speed, conventional friction knows all of them. At level planar the
  rates know the load, and it is an axis of effective friction alone.
- Along an axis rates are cubics through the ends of an interval and its thirds. Intervals come from halving: one is
  right where the rates at a sixth, half and five sixths of it are those of a bearing put together there, to the
  tolerance, at some slips of the cage, in the mean over a pitch, and with the other axes at each of their ends. Which
  intervals there are does not depend on where a motion went before.
- The load counts by its root: the width of a contact goes with that, and its traction down to no load.
- Only stations around operations that a motion comes through are put together.
"""

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property, partial
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly, conditions_read
from rollslip.bearing.raceway import Array
from rollslip.bearing.resolution import Resolution
from rollslip.errors import ConvergenceError
from rollslip.units import format_quantity
from rollslip_studies.dynamics.history.temperature_path import changed
from rollslip_studies.dynamics.levels.cage_and_rollers import carried_motion
from rollslip_studies.dynamics.levels.load_map import build_load_map
from rollslip_studies.dynamics.levels.moving_bearing import MovingBearing
from rollslip_studies.dynamics.levels.planar import PlanarSettings, planar_motion
from rollslip_studies.dynamics.levels.raceway_friction import FrictionSettings

#: Cage slips at which rates are compared, with this share of the roller slip that rolls on the outer ring, so that both
#: contacts slide; shares of the largest speed, where that varies; and places of a roller in a pitch, between which it
#: meets and leaves the load: at one place alone, rollers do so in pairs.
_SPIN: Final = 0.9
_SLIPS: Final = (0.003, 0.03, 0.1, 0.3, 0.7)
_SPEEDS: Final = (1.0, 0.3)
_PLACES: Final = (0.0, 0.25, 0.5, 0.75)
#: Shares of the largest speed at which the halving of that axis begins; below the least, tables are those of it.
_FIRST_SPEEDS: Final = (1 / 64, 1 / 32, 1 / 16, 1 / 8, 1 / 4, 1 / 2, 1.0)
#: Halvings of an axis at most.
_DEEPEST: Final = 9
#: Nodes of an interval, and where its cubic is checked, in sixths of it: about where it errs most, and in the middle,
#: where a kink would be furthest from all nodes. They are nodes of its halves.
_SIXTHS: Final = (0, 2, 4, 6)
_CHECKED: Final = (1, 3, 5)
#: Sixths of the smallest interval in one between roots.
_FINEST: Final = 6 * 2**_DEEPEST
#: Share of the rates at the highest load, temperature and speed that errors are relative to at least: near no load
#: there is next to nothing to be relative to, and drags move the cage.
_LEAST: Final = 0.05
#: Least load, relative to the largest.
_HARDLY: Final = 1e-9
#: Share of the tolerance that is left to what is seen at the checked places: tables take another, and where a slice
#: parts between them the rates have a kink, at which a cubic errs two to three times as much.
_FRACTION: Final = 0.4
#: Entries of the ledger that rates are compared by, beside the spins of the rollers.
_COMPARED: Final = (
    "impulse_inner",
    "impulse_outer",
    "impulse_rings",
    "impulse_drag",
    "lost_rolling",
    "lost_land",
)

Place = tuple[float, ...]


@attrs.frozen
class Axis:
    """What varies, and from where to where: the root of "radial_load" [N^0.5], a temperature [K] or "speed" [rad/s]."""

    name: str
    low: float
    high: float

    @classmethod
    def of(cls, name: str, low: float, high: float) -> "Axis":
        """Return the axis of a value of the operation from one to another; no load is the limit of hardly any."""
        if name != "radial_load":
            return cls(name, low, high)
        return cls(name, math.sqrt(max(low, _HARDLY * high)), math.sqrt(high))

    @property
    def unit(self) -> str:
        """SI unit of the value."""
        return (
            "N"
            if self.name == "radial_load"
            else "K"
            if self.name.endswith("temperature")
            else "rad/s"
        )

    def value(self, place: float) -> float:
        """Return the value of the operation at a place [N, K, rad/s]."""
        return place * place if self.name == "radial_load" else place

    @property
    def roots(self) -> tuple[float, ...]:
        """Places between which it is halved."""
        if self.name == "speed":
            return tuple(fraction * self.high for fraction in _FIRST_SPEEDS)
        return self.low, self.high

    def place(self, node: int) -> float:
        """Return where one of the `_FINEST` nodes from root to root is, counted from the first."""
        root, sixths = divmod(node, _FINEST)
        if sixths == 0:
            return self.roots[root]
        low, high = self.roots[root : root + 2]
        return low + sixths * (high - low) / _FINEST


@attrs.frozen(eq=False, kw_only=True)
class Stations:
    """Bearings in motion by their place on the axes."""

    assembly: Assembly  # the bearing as the scene states it
    speeds: tuple[
        float, float
    ]  # speeds of inner and outer ring where they turn fastest against each other [rad/s]
    top_speeds: tuple[
        float, float
    ]  # largest speeds of inner and outer ring [rad/s]; loads are worked out up to either
    axes: tuple[Axis, ...]  # what varies
    friction: FrictionSettings  # friction of the raceways
    level: str  # level of the motion
    planar: PlanarSettings | None  # what level planar needs
    tolerance: (
        float  # largest error of the rates between nodes, over all axes, relative to their largest
    )
    speeds_vary: bool  # whether the rings turn slower at times
    _made: dict[Place, MovingBearing] = attrs.field(factory=dict, init=False, repr=False)
    #: Errors of the intervals that were looked at, by axis and ends: shared by all motions of the bearing through this
    #: operation.
    _errors: dict[tuple[int, int, int], float] = attrs.field(factory=dict, init=False, repr=False)

    def __attrs_post_init__(self) -> None:
        f = self.friction
        of = (
            self.speeds,
            self.top_speeds,
            self.axes,
            self.level,
            self.planar,
            self.tolerance,
            self.speeds_vary,
        )
        of_friction = f.name, f.effective_over, f.coefficient, f.transition, f.tolerance
        key = of_bearing(self.assembly), *of, of_friction
        object.__setattr__(
            self, "_errors", self.assembly.cached("errors between stations", key, dict)
        )

    @property
    def error(self) -> float:
        """Largest error of the rates between nodes, of the intervals that were found right."""
        right = [error for error in self._errors.values() if error <= self._allowed]
        return max(right, default=0.0)

    @property
    def _allowed(self) -> float:
        return _FRACTION * self.tolerance / max(len(self.axes), 1)

    @property
    def motions(self) -> Mapping[Place, MovingBearing]:
        """The stations so far."""
        return self._made

    def around(self, place: Place) -> tuple[list[Place], list[Any]]:
        """Return the nodes around a place, by axis, and the compiled systems there, as `Varying` asks for them."""
        nodes = [
            tuple(self.axes[axis].place(node) for node in _nodes(*self._interval(axis, value)))
            for axis, value in enumerate(place)
        ]
        corners = itertools.product(*reversed(nodes))  # the first axis changes fastest
        return nodes, [self.motion(tuple(reversed(corner))).system.owner for corner in corners]

    def _interval(self, axis: int, value: float) -> tuple[int, int]:
        """Return the interval of an axis in which a value lies, small enough for a cubic."""
        at = self.axes[axis]
        low = _FINEST * next(k for k, end in enumerate(at.roots[1:]) if value <= end)
        high = low + _FINEST
        for _ in range(_DEEPEST):
            if self._off(axis, low, high) <= self._allowed:
                return low, high
            middle = (low + high) // 2
            low, high = (low, middle) if value <= at.place(middle) else (middle, high)
        if self._off(axis, low, high) <= self._allowed:
            return low, high
        raise ConvergenceError(
            f"between {shown(attrs.evolve(at, low=at.place(low), high=at.place(high)))} rates are still off by "
            f"{self._off(axis, low, high):.1e}, more than {self._allowed:.1e}; raise accuracy.tolerance"
        )

    def _off(self, axis: int, low: int, high: int) -> float:
        """Error of the rates between two places of an axis, with the others at each of their ends."""
        if (axis, low, high) not in self._errors:
            others = [(a.roots[0], a.high) for k, a in enumerate(self.axes) if k != axis]
            self._errors[axis, low, high] = max(
                self._off_at(axis, low, high, rest) for rest in itertools.product(*others)
            )
        return self._errors[axis, low, high]

    def _off_at(self, axis: int, low: int, high: int, rest: Place) -> float:
        def there(node: int) -> MovingBearing:
            return self.motion((*rest[:axis], self.axes[axis].place(node), *rest[axis:]))

        found = 0.0
        for fraction in _CHECKED:
            true = there(_between(low, high, fraction))
            at_nodes = [self._rates(there(node), true) for node in _nodes(low, high)]
            cubic = sum(
                weight * rates for weight, rates in zip(_weights(fraction), at_nodes, strict=True)
            )
            error = off(
                np.asarray(cubic), self._rates(true, true), _LEAST * self._largest, self._rollers
            )
            found = max(found, error)
        return found

    def _rates(self, motion: MovingBearing, like: MovingBearing) -> Array:
        return rates_of(motion, like, _SPEEDS if self.speeds_vary else _SPEEDS[:1])

    @cached_property
    def _largest(self) -> Array:
        """Largest rates at the highest end of all axes, as `off` takes them."""
        top = self.motion(tuple(axis.high for axis in self.axes))
        return sizes_of(self._rates(top, top), self._rollers)

    @property
    def _least_force(self) -> float:
        """Mean force of a roller [N] that errors of loads are relative to at least, as those of rates are."""
        load = max(
            (axis.value(axis.high) for axis in self.axes if axis.name == "radial_load"), default=0.0
        )
        return _LEAST * load / self._rollers

    @property
    def _rollers(self) -> int:
        return self.assembly.scene.bearing.rollers

    def motion(self, place: Place) -> MovingBearing:
        """Return the bearing in motion at a place on the axes."""
        if place not in self._made:
            self._made[place] = self._put_together(place)
        return self._made[place]

    @property
    def _bearings(self) -> dict[Place, Assembly]:
        return self.assembly.cached(
            "stations", (of_bearing(self.assembly), self.axes, self.speeds), dict
        )

    @property
    def bearings(self) -> int:
        """How many bearings were put together, by all motions through this operation."""
        return len(self._bearings)

    def bearing(self, place: Place) -> Assembly:
        """Return the bearing at a place on the axes; the one that the scene states where that is there."""
        known = self._bearings
        if place not in known:
            values = {axis.name: axis.value(at) for axis, at in zip(self.axes, place, strict=True)}
            speed = values.pop("speed", None)
            fraction = 1.0 if speed is None else speed / abs(self.speeds[0] - self.speeds[1])
            values |= {
                "inner_speed": fraction * self.speeds[0],
                "outer_speed": fraction * self.speeds[1],
            }
            known[place] = operated(self.assembly, values)
        return known[place]

    def _put_together(self, place: Place) -> MovingBearing:
        bearing = self.bearing(place)
        if self.planar is not None:
            return planar_motion(bearing, self.planar, self.friction, self.top_speeds, each=True)
        read = {name for r in bearing.raceways for name in conditions_read(r.deflection)}
        key = (
            *(value for axis, value in zip(self.axes, place, strict=True) if axis.unit != "K"),
            bearing.scene.bearing.radial_clearance,  # which rings of other temperatures change
            *(
                getattr(raceway.conditions, name)
                for raceway in bearing.raceways
                for name in sorted(read)
            ),
        )
        tolerance = self.friction.table_tolerance(bearing)
        of = of_bearing(self.assembly), self.axes, self.speeds, self.top_speeds, tolerance
        made = partial(build_load_map, bearing, tolerance, max(self.top_speeds), self._least_force)
        loads = self.assembly.cached("loads of stations", (*of, key), made)
        return carried_motion(bearing, self.friction, level=self.level, loads=loads, each=True)


def _between(low: int, high: int, sixths: int) -> int:
    return low + sixths * (high - low) // 6


def _nodes(low: int, high: int) -> list[int]:
    return [_between(low, high, sixths) for sixths in _SIXTHS]


def _weights(sixths: int) -> list[float]:
    """Weights of the nodes of an interval at a place in it (Lagrange)."""
    return [
        math.prod((sixths - other) / (own - other) for other in _SIXTHS if other != own)
        for own in _SIXTHS
    ]


def of_bearing(assembly: Assembly) -> Resolution:
    """Return the resolution of a bearing without what its motions alone have of it, so that they share stations."""
    return attrs.evolve(
        assembly.resolution, friction=None, level=None, integrator=None, integrator_tolerance=None
    )


def operated(assembly: Assembly, values: Mapping[str, float]) -> Assembly:
    """Return a bearing at other values of its operation [rad/s, N, K]; itself where they are its own."""
    # a part is written also where it has its own value, since it may have that by following another
    return changed(assembly, {f"operation.{name}": value for name, value in values.items()})


def rates_of(
    motion: MovingBearing, like: MovingBearing, speed_shares: Sequence[float] = _SPEEDS[:1]
) -> Array:
    """Rates of a bearing at the speeds of another, some slips of its cage and places: (slips, places, rates).

    The rates are those of the spins of its rollers and of the ledger. Friction that is tabulated at one speed is looked
    at there only.
    """
    k = like.assembly.kinematics
    rollers = like.assembly.scene.bearing.rollers
    speeds = motion.system.owner.operation[:2]
    rows = list[list[Array]]()
    before = speeds.copy()
    compared = _compared(like)
    fractions = speed_shares if motion.friction.settings.name == "conventional" else (1.0,)
    for fraction, slip in itertools.product(fractions, _slips(like.assembly)):
        speeds[:] = fraction * k.direction * np.array([k.inner_speed, k.outer_speed])
        y = like.initial(slip, _SPIN * float(k.roller_slip_outer_rolling(slip)) if slip else 0.1)
        of_state = like.split(y)  # which are views
        for name, values in of_state.items():
            if like.units[name] == "rad/s":
                values *= fraction
        rows.append([])
        for place in _PLACES:
            of_state["cage_angle"][...] = 2.0 * np.pi / rollers * place
            of = motion.split(motion.system(0.0, y))
            rows[-1].append(np.concatenate((of["roller_spin"], [of[name] for name in compared])))
    speeds[:] = before
    return np.array(rows)


def _slips(assembly: Assembly) -> Iterable[float]:
    k = assembly.kinematics
    return (
        _SLIPS
        if abs(k.epicyclic_cage_speed) > 1e-9 * abs(k.inner_speed - k.outer_speed)
        else (0.0,)
    )


def _compared(motion: MovingBearing) -> list[str]:
    return [name for name in _COMPARED if name in motion.names[2]]


def sizes_of(rates: Array, rollers: int) -> Array:
    """Largest rates over the slips, the mean over places: of all spins, and of each entry of the ledger."""
    size = np.abs(rates).mean(axis=1)
    return np.concatenate(([size[:, :rollers].sum(axis=1).max()], size[:, rollers:].max(axis=0)))


def off(rates: Array, true: Array, least: Array, rollers: int) -> float:
    """Largest error of rates, relative to the largest of their sort, or to the least that counts if that is more."""
    error = sizes_of(rates - true, rollers)
    size = np.maximum(sizes_of(true, rollers), least)
    return float(np.divide(error, size, out=np.zeros(size.size), where=size > 0.0).max())


def shown(axis: Axis) -> str:
    """Say from what to what an axis goes."""
    low, high = (format_quantity(axis.value(end), axis.unit) for end in (axis.low, axis.high))
    return f"{axis.name.replace('_', ' ')} {low} to {high}"
