"""Interpolate the rates of a bearing over its operation, between *stations*: bearings in motion at fixed operations.

The method is piecewise cubic Lagrange interpolation on a tensor grid, refined by bisection of its intervals.

- The axes are those of radial load and temperatures that vary and, where friction is effective, the difference of the
  ring speeds: effective friction is tabulated at one speed, conventional friction knows all of them. At level planar
  the rates take the load, and it is an axis of effective friction alone.
- The coordinate of the load is its square root: the width of a contact is proportional to that, and its traction too as
  the load goes to zero.
- The nodes of an interval are its ends and thirds. An interval is halved until its cubic agrees with the rates of
  bearings assembled at a sixth, a half and five sixths of it, to the tolerance: at several cage slips, in the mean over
  a pitch, and with each other axis at both of its ends. So the intervals do not depend on the path of a motion.
- Only stations around operations that a motion reaches are assembled.
"""

import itertools
import math
from collections.abc import Mapping, Sequence
from functools import cached_property, partial
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly, conditions_read
from rollslip.bearing.raceway import Array
from rollslip.bearing.resolution import Resolution
from rollslip.errors import ConvergenceError
from rollslip.units import format_quantity
from rollslip_studies.dynamics.history.temperature_path import ThermalPath, with_changes
from rollslip_studies.dynamics.levels.cage_and_rollers import carried_motion
from rollslip_studies.dynamics.levels.load_map import build_load_map
from rollslip_studies.dynamics.levels.moving_bearing import MovingBearing
from rollslip_studies.dynamics.levels.planar import PlanarSettings, planar_motion
from rollslip_studies.dynamics.levels.raceway_friction import FrictionSettings

#: Roller slip at which rates are compared, relative to the slip that rolls on the outer ring. Below 1, so that both
#: contacts slide; at 1 the outer one rolls. Chosen.
_ROLLER_SLIP_FRACTION: Final = 0.9
#: Roller slip at which rates are compared where the cage slip is zero [1]: both contacts slide there, too. Chosen.
_ROLLER_SLIP_AT_REST: Final = 0.1
#: Cage slips at which rates are compared. Each one costs its evaluations at every check of an interval. Chosen to cover
#: small slips, those at the largest traction, and skidding.
_SLIPS: Final = (0.003, 0.03, 0.1, 0.3, 0.7)
#: Ring speeds at which rates are compared where they vary, relative to the largest. Chosen: full speed and slow films.
_SPEEDS: Final = (1.0, 0.3)
#: Cage angles at which rates are compared, relative to a pitch. Several, because at one angle rollers enter and leave
#: the loaded zone in pairs.
_PITCH_FRACTIONS: Final = (0.0, 0.25, 0.5, 0.75)
#: Lower end of the axis of speed, relative to its upper end; below it, the tables there are used. Chosen.
MIN_SPEED_FRACTION: Final = 1.0 / 64.0
#: Maximum number of halvings of an interval. Each one more adds stations at a sharp kink before `ConvergenceError`.
#: Chosen: 1/512 of an axis.
_MAX_HALVINGS: Final = 9
#: Nodes of an interval, in sixths of it: thirds and ends, which are nodes of its halves or their ends.
_NODE_SIXTHS: Final = (0, 2, 4, 6)
#: Points at which the cubic of an interval is checked, in sixths of it: about those of its largest error, and the
#: middle, which is farthest from all nodes where there is a kink. They are nodes of the halves, so no station is lost.
_CHECK_SIXTHS: Final = (1, 3, 5)
#: Sixths of the smallest interval on an axis: nodes are counted in them, so that they are integers.
_SIXTHS: Final = 6 * 2**_MAX_HALVINGS
#: Lower bound of the rates that errors are relative to, as a fraction of the rates at the upper ends of all axes. Near
#: zero load there is hardly any rate to be relative to, and drags move the cage. Halving it adds stations there.
#: Chosen.
_MIN_RATE_FRACTION: Final = 0.05
#: Lower end of the axis of load, relative to its upper end: without any load there is no contact. Chosen; any value far
#: below the tolerance gives the same rates.
_MIN_LOAD_FRACTION: Final = 1e-9
#: Fraction of the tolerance that is left to the error at the checked points. Tables take another one, and where a slice
#: loses contact between the points the rates have a kink, at which the error of a cubic is two to three times as large.
_ERROR_FRACTION: Final = 0.4
#: Cage speed below which slip has no meaning, relative to the difference of the ring speeds: rings that turn against
#: each other at the same surface speed, up to rounding. Half and twice the value change nothing: speeds as they are
#: stated differ by far more. Chosen between these and the rounding of speeds, 1e-16.
_ROUNDING: Final = 1e-9
#: Entries of the ledger whose rates are compared, in addition to the spins of the rollers.
_COMPARED: Final = (
    "impulse_inner",
    "impulse_outer",
    "impulse_rings",
    "impulse_drag",
    "lost_rolling",
    "lost_land",
)

#: A coordinate on each axis.
Point = tuple[float, ...]


@attrs.frozen
class Axis:
    """A variable of the operation and its range; the coordinate of the radial load is its square root.

    Attributes
    ----------
    name : str
        "radial_load", a temperature or "speed", the difference of the ring speeds.
    low, high : float
        Ends of the axis as coordinates [N^0.5, K, rad/s].
    """

    name: str
    low: float
    high: float

    @classmethod
    def of(cls, name: str, low: float, high: float) -> "Axis":
        """Return the axis of a value of the operation between two values; a load of zero is replaced by a tiny one.

        Parameters
        ----------
        name : str
            Name of the value.
        low, high : float
            Its bounds [N, K, rad/s].
        """
        if name != "radial_load":
            return cls(name, low, high)
        return cls(name, math.sqrt(max(low, _MIN_LOAD_FRACTION * high)), math.sqrt(high))

    @property
    def unit(self) -> str:
        """SI unit of the value."""
        if self.name == "radial_load":
            return "N"
        return "K" if self.name.endswith("temperature") else "rad/s"

    def value(self, coordinate: float) -> float:
        """Return the value of the operation at a coordinate [N, K, rad/s]."""
        return coordinate * coordinate if self.name == "radial_load" else coordinate

    def coordinate(self, node: int) -> float:
        """Return the coordinate of a node, of which there are `_SIXTHS` between the ends, which are exact."""
        fraction = node / _SIXTHS
        return (1.0 - fraction) * self.low + fraction * self.high


@attrs.frozen
class PathAxis(Axis):
    """Coordinates along a path through temperatures."""

    path: ThermalPath

    @property
    def unit(self) -> str:
        """SI unit of the value: K where the clearance is constant, so that all stations share one load map; else m."""
        return self.path.unit

    def value(self, coordinate: float) -> float:
        """Return the first temperature [K], or the clearance [m], at a coordinate of the path."""
        return self.path.value(coordinate)


@attrs.frozen(eq=False, kw_only=True)
class Stations:
    """Bearings in motion by their coordinates on the axes."""

    assembly: Assembly  # the bearing as the scene states it
    #: Speeds of inner and outer ring where their difference is largest [rad/s].
    speeds: tuple[float, float]
    #: Largest speeds of inner and outer ring [rad/s]; loads are computed up to either.
    top_speeds: tuple[float, float]
    axes: tuple[Axis, ...]  # variables of the interpolation
    friction: FrictionSettings  # friction of the raceways
    level: str  # "cage-set", "pocket" or "planar"
    planar: PlanarSettings | None  # masses, damping and gravity of level planar
    #: Largest error of the rates between nodes, over all axes, relative to the largest rates.
    tolerance: float
    speeds_vary: bool  # whether the ring speeds vary
    #: Stations assembled so far, by their points.
    motions: dict[Point, MovingBearing] = attrs.field(factory=dict, init=False, repr=False)
    #: Errors of the checked intervals, by axis and ends. All motions of the bearing through this operation share them.
    _errors: dict[tuple[int, int, int], float] = attrs.field(factory=dict, init=False, repr=False)

    def __attrs_post_init__(self) -> None:
        friction = self.friction
        key = (
            bearing_resolution(self.assembly),
            self.speeds,
            self.top_speeds,
            self.axes,
            self.level,
            self.planar,
            self.tolerance,
            self.speeds_vary,
            friction.name,
            friction.coefficient,
            friction.transition,
            friction.tolerance,
        )
        object.__setattr__(
            self, "_errors", self.assembly.cached("errors between stations", key, dict)
        )

    @property
    def error(self) -> float:
        """Largest error of the rates between nodes, of the intervals within the tolerance."""
        return max(
            [error for error in self._errors.values() if error <= self._axis_tolerance], default=0.0
        )

    @property
    def _axis_tolerance(self) -> float:
        """Largest error of the rates along one axis, since the errors of several axes add up."""
        return _ERROR_FRACTION * self.tolerance / max(len(self.axes), 1)

    def interpolation_cell(self, point: Point) -> tuple[list[Point], list[Any]]:
        """Return the nodes around a point, by axis, and the compiled systems at all their combinations.

        `Varying` calls this where a motion leaves its cell. Of the combinations, the first axis changes fastest.
        """
        nodes = [
            tuple(self.axes[axis].coordinate(node) for node in _nodes(*self._interval(axis, value)))
            for axis, value in enumerate(point)
        ]
        return nodes, [
            self.motion(tuple(reversed(corner))).system.owner
            for corner in itertools.product(*reversed(nodes))
        ]

    def _interval(self, number: int, value: float) -> tuple[int, int]:
        """Return the nodes of an axis around a coordinate, between which a cubic is within the tolerance."""
        axis = self.axes[number]
        low = 0
        high = _SIXTHS
        for _ in range(_MAX_HALVINGS):
            if self._interpolation_error(number, low, high) <= self._axis_tolerance:
                return low, high
            middle = (low + high) // 2
            low, high = (low, middle) if value <= axis.coordinate(middle) else (middle, high)
        if self._interpolation_error(number, low, high) <= self._axis_tolerance:
            return low, high
        smallest = attrs.evolve(axis, low=axis.coordinate(low), high=axis.coordinate(high))
        raise ConvergenceError(
            f"between {describe_range(smallest)} rates are still off by "
            f"{self._interpolation_error(number, low, high):.1e}, more than {self._axis_tolerance:.1e}; "
            "raise accuracy.tolerance"
        )

    def _interpolation_error(self, axis: int, low: int, high: int) -> float:
        """Return the error of the rates between two nodes of an axis, with the others at each of their ends."""
        if (axis, low, high) not in self._errors:
            self._errors[axis, low, high] = max(
                self._error_at(axis, low, high, rest)
                for rest in itertools.product(
                    *[(a.low, a.high) for k, a in enumerate(self.axes) if k != axis]
                )
            )
        return self._errors[axis, low, high]

    def _error_at(self, axis: int, low: int, high: int, rest: Point) -> float:
        """Return the error of the rates between two nodes of an axis, with the others at coordinates ``rest``."""

        def station(node: int) -> MovingBearing:
            return self.motion((*rest[:axis], self.axes[axis].coordinate(node), *rest[axis:]))

        largest = 0.0
        for sixths in _CHECK_SIXTHS:
            checked = station(_between(low, high, sixths))
            at_nodes = [self._rates(station(node), checked) for node in _nodes(low, high)]
            cubic = sum(
                weight * rates for weight, rates in zip(_weights(sixths), at_nodes, strict=True)
            )
            error = relative_error(
                np.asarray(cubic),
                self._rates(checked, checked),
                _MIN_RATE_FRACTION * self._largest_rates,
                self._rollers,
            )
            largest = max(largest, error)
        return largest

    def _rates(self, motion: MovingBearing, reference: MovingBearing) -> Array:
        """Return the rates of a station at the sampled states of a reference; see `sampled_rates`."""
        return sampled_rates(motion, reference, _SPEEDS if self.speeds_vary else _SPEEDS[:1])

    @cached_property
    def _largest_rates(self) -> Array:
        """Rates at the upper ends of all axes, as `relative_error` takes them."""
        top = self.motion(tuple(axis.high for axis in self.axes))
        return largest_rates(self._rates(top, top), self._rollers)

    @property
    def _reference_force(self) -> float:
        """Lower bound of the mean force of a roller [N] that errors of loads are relative to, as for rates."""
        return (
            _MIN_RATE_FRACTION
            * max(
                (axis.value(axis.high) for axis in self.axes if axis.name == "radial_load"),
                default=0.0,
            )
            / self._rollers
        )

    @property
    def _rollers(self) -> int:
        """Number of rollers."""
        return self.assembly.scene.bearing.rollers

    def motion(self, point: Point) -> MovingBearing:
        """Return the bearing in motion at a point of the axes, assembled once."""
        if point not in self.motions:
            self.motions[point] = self._assembled_motion(point)
        return self.motions[point]

    @property
    def _bearings(self) -> dict[Point, Assembly]:
        """Bearings by their coordinates; all motions of the bearing through this operation share them."""
        return self.assembly.cached(
            "stations", (bearing_resolution(self.assembly), self.axes, self.speeds), dict
        )

    @property
    def bearings(self) -> int:
        """Number of bearings that were assembled, by all motions through this operation."""
        return len(self._bearings)

    def bearing(self, point: Point) -> Assembly:
        """Return the bearing at a point of the axes; the bearing of the scene where the point is its operation."""
        cached = self._bearings
        if point not in cached:
            assembly = self.assembly
            values = dict[str, float]()
            for axis, coordinate in zip(self.axes, point, strict=True):
                if isinstance(axis, PathAxis):
                    assembly = axis.path.bearing(assembly, coordinate)
                else:
                    values[axis.name] = axis.value(coordinate)
            speed = values.pop("speed", None)
            fraction = 1.0 if speed is None else speed / abs(self.speeds[0] - self.speeds[1])
            values |= {
                "inner_speed": fraction * self.speeds[0],
                "outer_speed": fraction * self.speeds[1],
            }
            cached[point] = with_operation(assembly, values)
        return cached[point]

    def _assembled_motion(self, point: Point) -> MovingBearing:
        """Return the bearing in motion at a point of the axes; at the levels with a cage its loads are shared."""
        bearing = self.bearing(point)
        if self.planar is not None:
            return planar_motion(
                bearing, self.planar, self.friction, self.top_speeds, per_roller=True
            )
        tolerance = self.friction.table_tolerance(bearing)
        # loads depend on temperatures only through the clearance and what the deflection law reads
        read = {
            name for raceway in bearing.raceways for name in conditions_read(raceway.deflection)
        }
        key = (
            bearing_resolution(self.assembly),
            self.axes,
            self.speeds,
            self.top_speeds,
            tolerance,
            *(value for axis, value in zip(self.axes, point, strict=True) if axis.unit != "K"),
            bearing.scene.bearing.radial_clearance,
            *(
                getattr(raceway.conditions, name)
                for raceway in bearing.raceways
                for name in sorted(read)
            ),
        )
        build = partial(
            build_load_map, bearing, tolerance, max(self.top_speeds), self._reference_force
        )
        return carried_motion(
            bearing,
            self.friction,
            level=self.level,
            loads=self.assembly.cached("loads of stations", key, build),
            per_roller=True,
        )


def _between(low: int, high: int, sixths: int) -> int:
    """Return the node at a number of sixths of an interval."""
    return low + sixths * (high - low) // 6


def _nodes(low: int, high: int) -> list[int]:
    """Return the four nodes of an interval."""
    return [_between(low, high, sixths) for sixths in _NODE_SIXTHS]


def _weights(sixths: int) -> list[float]:
    """Return the Lagrange weights of the four nodes of an interval at a point in it, given in sixths."""
    return [
        math.prod((sixths - other) / (own - other) for other in _NODE_SIXTHS if other != own)
        for own in _NODE_SIXTHS
    ]


def bearing_resolution(assembly: Assembly) -> Resolution:
    """Return the resolution of a bearing without fields of its motion alone, so that its motions share stations."""
    return attrs.evolve(
        assembly.resolution, friction=None, level=None, integrator=None, integrator_tolerance=None
    )


def with_operation(assembly: Assembly, values: Mapping[str, float]) -> Assembly:
    """Return a bearing at other values of its operation; itself where they are its own.

    Parameters
    ----------
    assembly : Assembly
        The bearing.
    values : mapping
        Values by their name in the operation [rad/s, N, K].
    """
    # the temperature of a part is changed even to its own value, since it may have that by following another one
    return with_changes(assembly, {f"operation.{name}": value for name, value in values.items()})


def sampled_rates(
    motion: MovingBearing, reference: MovingBearing, speed_fractions: Sequence[float] = _SPEEDS[:1]
) -> Array:
    """Return the rates of a bearing at sampled slips and cage angles of a reference, (slips, angles, rates).

    The rates are those of the spins of its rollers and of the ledger.

    Parameters
    ----------
    motion : MovingBearing
        The bearing whose rates are evaluated.
    reference : MovingBearing
        The bearing whose ring speeds and states they are evaluated at.
    speed_fractions : sequence of float
        Ring speeds, relative to those of the reference. Friction that is tabulated at one speed is sampled at 1 alone.
    """
    k = reference.assembly.kinematics
    rollers = reference.assembly.scene.bearing.rollers
    speeds = motion.system.owner.operation[:2]
    own_speeds = speeds.copy()
    rows = list[list[Array]]()
    compared = [name for name in _COMPARED if name in reference.names[2]]
    # without an epicyclic cage speed there is no other slip than 0
    difference = abs(k.inner_speed - k.outer_speed)
    slips = _SLIPS if abs(k.epicyclic_cage_speed) > _ROUNDING * difference else (0.0,)
    fractions = speed_fractions if motion.friction.settings.name == "conventional" else (1.0,)
    for fraction, slip in itertools.product(fractions, slips):
        speeds[:] = fraction * k.direction * np.array([k.inner_speed, k.outer_speed])
        roller_slip = _ROLLER_SLIP_AT_REST
        if slip:
            roller_slip = _ROLLER_SLIP_FRACTION * float(k.roller_slip_outer_rolling(slip))
        y = reference.initial(slip, roller_slip)
        views = reference.split(y)
        for name, values in views.items():
            if reference.units[name] == "rad/s":
                values *= fraction
        rows.append([])
        for pitch_fraction in _PITCH_FRACTIONS:
            views["cage_angle"][...] = 2.0 * np.pi / rollers * pitch_fraction
            rates = motion.split(motion.system(0.0, y))
            rows[-1].append(
                np.concatenate((rates["roller_spin"], [rates[name] for name in compared]))
            )
    speeds[:] = own_speeds
    return np.array(rows)


def largest_rates(rates: Array, rollers: int) -> Array:
    """Return the largest rates over the slips, (1 + entries,): the sum of all spins, and each entry of the ledger.

    Parameters
    ----------
    rates : ndarray, shape (slips, angles, rates)
        Rates as `sampled_rates` returns them; their magnitudes are averaged over the angles.
    rollers : int
        Number of rollers, whose spins come first.
    """
    mean = np.abs(rates).mean(axis=1)
    return np.concatenate(([mean[:, :rollers].sum(axis=1).max()], mean[:, rollers:].max(axis=0)))


def relative_error(rates: Array, true: Array, smallest: Array, rollers: int) -> float:
    """Return the largest error of rates, relative to the largest true rate of the same kind.

    Parameters
    ----------
    rates, true : ndarray, shape (slips, angles, rates)
        Interpolated and true rates.
    smallest : ndarray, shape (1 + entries,)
        Lower bounds of the rates that errors are relative to, as `largest_rates` returns them.
    rollers : int
        Number of rollers.
    """
    size = np.maximum(largest_rates(true, rollers), smallest)
    return float(
        np.divide(
            largest_rates(rates - true, rollers), size, out=np.zeros(size.size), where=size > 0.0
        ).max()
    )


def describe_range(axis: Axis) -> str:
    """Return the variable of an axis and its bounds in words."""
    low, high = (format_quantity(axis.value(end), axis.unit) for end in (axis.low, axis.high))
    return f"{axis.name.replace('_', ' ')} {low} to {high}"
