"""Quasi-static loads of a roller as a function of where it is and how fast it is carried round.

- Equal rollers that a cage carries at its spacing are all loaded alike, each at its own place: instants of one pitch
  and Z rollers are Z instants positions of one roller over the whole orbit.
- The loads depend on the speed through centrifugal force only, and on that nearly linearly; on position they are
  smooth but for the places where slices touch and part.
- So: cubic Hermite over position, periodic, its slopes of fourth order and limited to what cannot turn negative; linear
  over centrifugal force. Where no node is loaded nothing is. Nodes are added where the forces, measured half-way
  between them against the equilibrium, are off by more than the tolerance.
- The error is the share of a ring's load that is at the wrong place, the sum of |dQ| over the orbit relative to that of
  Q: it bounds what friction is off by. The largest error of one force, where a contact parts, is mostly 2 to 8 times
  that.
"""

import itertools
import math
from collections.abc import Callable, Mapping

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.equilibrium import LoadDistribution
from rollslip.bearing.kinematics import Kinematics
from rollslip.bearing.raceway import RINGS, Array, Raceway
from rollslip.bearing.resolution import COARSER_TABLES
from rollslip.errors import ConvergenceError

_FIRST_INSTANTS, _MOST_INSTANTS = 2, 256
_MOST_FORCES = 1025
#: Up to how many halvings between forces a map is measured between positions: it errs there alike at forces alike.
_MEASURED = 2


@attrs.frozen(eq=False)
class LoadMap:
    """Loads over orbital position and centrifugal force.

    Attributes
    ----------
    centrifugal : ndarray
        Nodes of the centrifugal force of a roller [N], ascending from 0, shape (C,).
    loads : ndarray
        At equal steps of position from the line of load, shape (C, channels, K, n): loads per length on inner and
        outer ring [N/m]; in a map of forces [N], n = 1, followed by the rolling resistances on both [N] if there are
        any.
    widths : ndarray
        What turns loads into forces: widths of the slices [m], 1 in a map of forces, shape (n,).
    error : float
        Largest share of the load of a ring at the wrong place, half-way between positions and between forces.
    """

    centrifugal: Array
    loads: Array
    widths: Array
    error: float

    @property
    def positions(self) -> int:
        """Nodes over the orbit."""
        return int(self.loads.shape[2])

    @property
    def slices(self) -> int:
        """Slices along a roller, 1 in a map of forces."""
        return int(self.loads.shape[3])

    @property
    def table(self) -> Array:
        """Loads and slopes as the compiled motion reads them, (C, K + 1, 2, channels, n), the first position twice."""
        forces, channels, positions, slices = self.loads.shape
        table = np.empty((forces, positions + 1, 2, channels, slices))
        for one, loads in zip(table, self.loads, strict=True):  # each stays in the cache
            one[:-1, 0], one[:-1, 1] = loads.swapaxes(0, 1), _slopes(loads).swapaxes(0, 1)
        table[:, -1] = table[:, 0]
        return table

    def at(self, psi: Array, centrifugal: float) -> Array:
        """Loads at positions [rad], (m,), and a centrifugal force [N] up to the last node: (channels, m, n)."""
        place = np.asarray(psi) / (2.0 * np.pi) % 1.0 * self.positions
        k = np.minimum(place.astype(int), self.positions - 1)
        x = (place - k)[:, None, None]
        c = min(int(np.searchsorted(self.centrifugal, centrifugal, side="right")), self.centrifugal.size - 1) - 1
        f = (centrifugal - self.centrifugal[c]) / (self.centrifugal[c + 1] - self.centrifugal[c])
        table = (1.0 - f) * self.table[c] + f * self.table[c + 1]
        (a, slope_a), (b, slope_b) = (table[i].swapaxes(0, 1) for i in (k, k + 1))
        load = a + x * x * (3.0 - 2.0 * x) * (b - a) + x * (1.0 - x) * ((1.0 - x) * slope_a - x * slope_b)
        return np.asarray(np.maximum(load, 0.0).swapaxes(0, 1))

    def forces(self, resistance: Callable[[Array, int], Array] | None = None) -> "LoadMap":
        """Return the map of forces; ``resistance`` gives, of loads (m, n) on a ring (0, 1), the resistances (m,)."""
        forces = (self.loads @ self.widths)[..., None]
        if resistance is not None:
            rows = [[resistance(node[ring], ring)[:, None] for ring in range(len(RINGS))] for node in self.loads]
            forces = np.concatenate((forces, np.array(rows)), axis=1)
        return LoadMap(self.centrifugal, forces, np.ones(1), self.error)


def fastest(kinematics: Kinematics) -> float:
    """Return the largest speed that a cage can be expected to have [rad/s]: that of a ring, or its epicyclic one."""
    speeds = kinematics.epicyclic_cage_speed, kinematics.inner_speed, kinematics.outer_speed
    return max(abs(speed) for speed in speeds)


def build_load_map(assembly: Assembly, tolerance: float, top_speed: float | None = None) -> LoadMap:
    """Build the map of a bearing.

    Parameters
    ----------
    assembly : Assembly
        The bearing.
    tolerance : float
        Largest share of the load of a ring that may be at the wrong place.
    top_speed : float, optional
        Cage speed up to which the map goes [rad/s]; by default that of the faster ring.

    Raises
    ------
    ConvergenceError
        If the tolerance is not reached with the most nodes, or the bearing finds no equilibrium.
    """
    sides = ((raceway.deflection, raceway.conditions) for raceway in assembly.raceways)
    key = (assembly.slices, assembly.resolution.quadrature, tolerance, top_speed, *sides)
    known: LoadMap | None = assembly.known_maps.get(key)
    if known is None:
        known = assembly.known_maps[key] = _built(assembly, tolerance, top_speed)
    return known


def _built(assembly: Assembly, tolerance: float, top_speed: float | None) -> LoadMap:
    per_square = assembly.roller_mass * assembly.kinematics.orbit_radius
    top = per_square * (fastest(assembly.kinematics) if top_speed is None else top_speed) ** 2
    instants, known = _FIRST_INSTANTS, dict[float, LoadDistribution]()
    while instants <= _MOST_INSTANTS:
        orbits = _Orbits(assembly, per_square, instants, known)
        known = orbits.distributions
        load_map = orbits.refined({0.0, min(assembly.centrifugal_force, top), top}, 0.5 * tolerance)
        if load_map is not None:
            return load_map
        instants *= 2
    raise ConvergenceError(
        f"{_MOST_INSTANTS} positions a pitch leave {orbits.over_position:.1e} of the load at the wrong place; "
        f"its table may leave {tolerance:.1e}; {COARSER_TABLES}"
    )


class _Orbits:
    """Equilibria by centrifugal force at the positions of a map, and at some forces half-way between: they measure it.

    ``known`` are those of a map with half as many positions.
    """

    def __init__(
        self, assembly: Assembly, per_square: float, instants: int, known: Mapping[float, LoadDistribution]
    ) -> None:
        self.assembly, self.per_square, self.instants, self._known = assembly, per_square, instants, known
        self.distributions: dict[float, LoadDistribution] = {}
        self.solved: dict[float, Array] = {}
        #: largest share of the load at the wrong place half-way between positions
        self.over_position = 0.0

    def at(self, force: float, *, between: bool = False) -> Array:
        """Loads of one roller over its orbit, (2, Z instants, n); positions between are looked at too, if so asked."""
        if force in self.solved:
            return self.solved[force]
        assembly, speed = self.assembly, math.sqrt(force / self.per_square)
        if between:
            loads = assembly.load_distribution(2 * self.instants, speed, self._known.get(force))
            self.distributions[force] = loads
        else:
            loads = assembly.load_distribution(self.instants, speed)
        rings = (load.swapaxes(0, 1).reshape(-1, assembly.slices) for load in (loads.inner_load, loads.outer_load))
        orbit = np.stack(tuple(rings))
        if between:
            orbit, true = orbit[:, ::2], orbit[:, 1::2]
            slopes = _slopes(orbit)
            half_way = 0.5 * (orbit + np.roll(orbit, -1, axis=1)) + 0.125 * (slopes - np.roll(slopes, -1, axis=1))
            self.over_position = max(self.over_position, self.misplaced(half_way, true))
        self.solved[force] = orbit
        return orbit

    def misplaced(self, interpolated: Array, true: Array) -> float:
        """Share of the load of a ring that is at the wrong place, the larger of both rings; loads (2, m, n)."""
        widths = self.assembly.widths
        off, whole = np.abs((interpolated - true) @ widths).sum(axis=1), (true @ widths).sum(axis=1)
        return float((off / np.where(whole > 0.0, whole, 1.0)).max())

    def refined(self, nodes: set[float], tolerance: float) -> LoadMap | None:
        """Map with enough centrifugal forces; None if its positions are too few."""
        for force in nodes:
            self.at(force, between=True)
        pairs, over_force = [(*pair, 0) for pair in itertools.pairwise(sorted(nodes))], 0.0
        while pairs:
            low, high, halvings = pairs.pop()
            middle = 0.5 * (low + high)
            there = self.at(middle, between=halvings < _MEASURED)
            error = self.misplaced(0.5 * (self.at(low) + self.at(high)), there)
            if self.over_position > tolerance:
                return None
            if error <= tolerance:
                over_force = max(over_force, error)
                continue
            nodes.add(middle)
            pairs += [(low, middle, halvings + 1), (middle, high, halvings + 1)]
            if len(nodes) > _MOST_FORCES:
                raise ConvergenceError(
                    f"{_MOST_FORCES} centrifugal forces leave {error:.1e} of the load at the wrong place between "
                    f"{low:g} and {high:g} N; its table may leave {2.0 * tolerance:.1e}; {COARSER_TABLES}"
                )
        loads = np.stack([self.at(force) for force in sorted(nodes)])
        return LoadMap(np.array(sorted(nodes)), loads, self.assembly.widths, self.over_position + over_force)


def _slopes(loads: Array) -> Array:
    """Derivatives over position, the last axis but one, times its step, limited so that nothing turns negative.

    With |slope| <= 3 load at its ends, all Bernstein coefficients of a cell are positive or zero.
    """
    around = np.concatenate((loads[..., -2:, :], loads, loads[..., :2, :]), axis=-2)
    slope = around[..., 3:-1, :] - around[..., 1:-3, :]
    slope *= 8.0
    slope -= around[..., 4:, :] - around[..., :-4, :]
    slope /= 12.0
    limit = 3.0 * loads
    np.minimum(slope, limit, out=slope)
    np.negative(limit, out=limit)
    return np.maximum(slope, limit, out=slope)


def resistances(raceway: Raceway, load: Array, widths: Array, rolling_speed: float) -> Array:
    """Rolling resistance [N] of contacts with loads per length [N/m], (m, n), that roll without sliding: (m,)."""
    owner, slice_number = np.nonzero(load > 0.0)
    slices = raceway.evaluate(load[owner, slice_number], rolling_speed, 0.0)
    return np.asarray(np.bincount(owner, slices.resistance * widths[slice_number], load.shape[0]), dtype=float)
