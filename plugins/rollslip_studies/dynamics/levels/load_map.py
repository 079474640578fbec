"""Quasi-static loads of a roller as a function of where it is and how fast it is carried round.

- Equal rollers that a cage carries at its spacing are all loaded alike, each at its own place: instants of one pitch
  and Z rollers are Z instants positions of one roller over the whole orbit.
- The loads depend on the speed through centrifugal force only, and on that nearly linearly; on position they are
  smooth but for the places where slices touch and part.
- So: cubic Hermite over position, periodic, its slopes of fourth order and limited to what cannot turn negative; linear
  over centrifugal force. Where no node is loaded nothing is. Positions are added where the forces, measured half-way
  between them against the equilibrium, are off by more than the tolerance.
- Over the centrifugal force intervals are halved until they are right half-way, and only those that somebody asks for:
  a motion of the cage passes through few of the dozens that a map of all speeds has. Which they are does not depend on
  who asked for others before. Cubics in place of straight lines do not save any: slices touch and part within most of
  them.
- The error is the share of a ring's load that is at the wrong place, the sum of |dQ| over the orbit relative to that of
  Q: it bounds what friction is off by. The largest error of one force, where a contact parts, is mostly 2 to 8 times
  that.
"""

import itertools
import logging
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
from rollslip_studies.motion.spins import check_repeats

_log = logging.getLogger(__name__)

_FIRST_POSITIONS = 2
_MAX_POSITIONS = 256
_MAX_FORCES = 1025
#: Up to how many halvings between forces a map is measured between positions: it errs there alike at forces alike.
_MEASURED = 2
#: Times the tolerance that the share of the load at the wrong place along a roller may be between forces, where its
#: sum is right: friction feels less of it. Under little but centrifugal force a contact is linear in that, and its
#: slices are not.
_ALONG = 4.0
#: Equilibria that a map keeps: what is read of it is tables, and few intervals are looked at at a time.
_KEPT = 24


@attrs.frozen(eq=False)
class LoadMap:
    """Loads over orbital position and centrifugal force, worked out where they are asked for."""

    orbits: "Orbits"  # the equilibria that it is made of
    widths: Array  # what turns loads into forces: widths of the slices [m], 1 in a map of forces, shape (n,)
    #: What the map holds of the loads of a node, (2, K, n); by default these.
    channels_of: Callable[[Array], Array] | None = None
    _tables: dict[float, Array] = attrs.field(factory=dict, init=False, repr=False)

    @property
    def top(self) -> float:
        """Largest centrifugal force of a roller [N], at least 0."""
        return self.orbits.roots[-1]

    @property
    def positions(self) -> int:
        """Nodes over the orbit."""
        return self.orbits.positions

    @property
    def slices(self) -> int:
        """Slices along a roller, 1 in a map of forces."""
        return self.widths.size

    @property
    def error(self) -> float:
        """Largest share of the load of a ring at the wrong place, of what was asked for so far.

        Half-way between positions and between forces.
        """
        return self.orbits.over_position + self.orbits.over_force

    def interval(self, centrifugal: float) -> tuple[float, float]:
        """Return the nodes of centrifugal force [N] between which loads are linear at one from 0 to the top."""
        return self.orbits.interval(centrifugal)

    def loads(self, centrifugal: float) -> Array:
        """Return the loads at a node of centrifugal force [N], at equal steps of position from the line of load.

        (channels, K, n): loads per length on inner and outer ring [N/m]; in a map of forces [N], n = 1, followed by the
        rolling resistances on both [N] if there are any.
        """
        loads = self.orbits.at(centrifugal)
        return loads if self.channels_of is None else self.channels_of(loads)

    def table(self, centrifugal: float) -> Array:
        """Return loads and slopes at a node as the compiled motion reads them: (K + 1, 2, channels, n).

        The first position stands there twice.
        """
        if centrifugal not in self._tables:
            loads = self.loads(centrifugal)
            channels, positions, slices = loads.shape
            table = np.empty((positions + 1, 2, channels, slices))
            table[:-1, 0], table[:-1, 1] = loads.swapaxes(0, 1), _slopes(loads).swapaxes(0, 1)
            table[-1] = table[0]
            self._tables[centrifugal] = table
        return self._tables[centrifugal]

    def cell(self, centrifugal: float) -> tuple[float, float, Array, Array]:
        """Return the interval of a centrifugal force [N] and the tables at its ends, as `Carried` asks for them."""
        low, high = self.interval(centrifugal)
        return low, high, self.table(low), self.table(high)

    def at(self, psi: Array, centrifugal: float) -> Array:
        """Loads at positions [rad], (m,), and a centrifugal force [N] up to the top: (channels, m, n)."""
        place = np.asarray(psi) / (2.0 * np.pi) % 1.0 * self.positions
        k = np.minimum(place.astype(int), self.positions - 1)
        x = (place - k)[:, None, None]
        low, high, below, above = self.cell(centrifugal)
        f = (centrifugal - low) / (high - low)
        table = (1.0 - f) * below + f * above
        (a, slope_a), (b, slope_b) = (table[i].swapaxes(0, 1) for i in (k, k + 1))
        load = (
            a
            + x * x * (3.0 - 2.0 * x) * (b - a)
            + x * (1.0 - x) * ((1.0 - x) * slope_a - x * slope_b)
        )
        return np.asarray(np.maximum(load, 0.0).swapaxes(0, 1))

    def forces(self, resistance: Callable[[Array, int], Array] | None = None) -> "LoadMap":
        """Return the map of forces; ``resistance`` gives, of loads (m, n) on a ring (0, 1), the resistances (m,)."""

        def forces_of(loads: Array) -> Array:
            forces = (loads @ self.widths)[..., None]
            if resistance is None:
                return forces
            return np.concatenate(
                (forces, [resistance(loads[ring], ring)[:, None] for ring in range(len(RINGS))])
            )

        return LoadMap(self.orbits, np.ones(1), forces_of)


def fastest(kinematics: Kinematics) -> float:
    """Return the largest speed that a cage can be expected to have [rad/s]: that of a ring, or its epicyclic one."""
    speeds = kinematics.epicyclic_cage_speed, kinematics.inner_speed, kinematics.outer_speed
    return max(abs(speed) for speed in speeds)


def build_load_map(
    assembly: Assembly, tolerance: float, top_speed: float | None = None, least: float = 0.0
) -> LoadMap:
    """Build the map of a bearing.

    Parameters
    ----------
    assembly : Assembly
        The bearing.
    tolerance : float
        Largest share of the load of a ring that may be at the wrong place.
    top_speed : float, optional
        Cage speed up to which the map goes [rad/s]; by default that of the faster ring.
    least : float
        Mean force of a roller on a ring [N] that errors are relative to at least: of a ring that carries next to
        nothing the place of what it carries does not matter.

    Raises
    ------
    ConvergenceError
        If the tolerance is not reached with the most nodes, or the bearing finds no equilibrium.
    """
    sides = ((raceway.deflection, raceway.conditions) for raceway in assembly.raceways)
    key = (assembly.slices, assembly.resolution.quadrature, tolerance, top_speed, least, *sides)
    return assembly.cached(
        "loads over the orbit", key, lambda: _built(assembly, tolerance, top_speed, least)
    )


def _built(assembly: Assembly, tolerance: float, top_speed: float | None, least: float) -> LoadMap:
    check_repeats(assembly)
    per_square = assembly.roller_mass * assembly.kinematics.orbit_radius
    top = per_square * (fastest(assembly.kinematics) if top_speed is None else top_speed) ** 2
    roots = tuple(sorted({0.0, min(assembly.centrifugal_force, top), top}))
    n_positions = _FIRST_POSITIONS
    known = dict[float, LoadDistribution]()
    while n_positions <= _MAX_POSITIONS:
        orbits = Orbits(assembly, per_square, n_positions, roots, 0.5 * tolerance, least)
        known = orbits.measured(known)
        if orbits.over_position <= orbits.tolerance:
            return LoadMap(orbits, assembly.widths)
        n_positions *= 2
    raise ConvergenceError(
        f"{_MAX_POSITIONS} positions a pitch leave {orbits.over_position:.1e} of the load at the wrong place; "
        f"its table may leave {tolerance:.1e}; {COARSER_TABLES}"
    )


class Orbits:
    """Equilibria by centrifugal force at the positions of a map."""

    def __init__(
        self,
        assembly: Assembly,  # the bearing
        # Centrifugal force of a roller over the square of the speed that it is carried round with [N s2].
        per_square: float,
        n_positions: int,  # instants of a pitch
        roots: tuple[
            float, ...
        ],  # centrifugal forces [N] between which intervals are halved, ascending from 0
        # Largest share of the load at the wrong place, half-way between positions and half-way between forces.
        tolerance: float,
        least: float,  # mean force of a roller on a ring [N] that this is a share of at least
    ) -> None:
        self.assembly = assembly
        self.per_square = per_square
        self.n_positions = n_positions
        self.roots = roots
        self.tolerance = tolerance
        self.least = least
        self.positions = n_positions * assembly.scene.bearing.rollers
        self.solved: dict[float, Array] = {}
        #: whether intervals that were looked at are right half-way
        self.right: dict[tuple[float, float], bool] = {}
        #: largest share of the load at the wrong place half-way between positions, and between forces
        self.over_position = 0.0
        self.over_force = 0.0

    def at(self, force: float) -> Array:
        """Loads of one roller over its orbit at a centrifugal force, (2, K, n)."""
        if force not in self.solved:
            if len(self.right) > 2 * _MAX_FORCES:
                raise ConvergenceError(
                    f"{_MAX_FORCES} centrifugal forces leave more than {self.tolerance:.1e} of the load at the wrong "
                    f"place near {force:g} N; {COARSER_TABLES}"
                )
            found = self._orbit(
                self.assembly.load_distribution(self.n_positions, self._speed(force))
            )
            while len(self.solved) >= _KEPT:
                del self.solved[next(iter(self.solved))]
            self.solved[force] = found
        return self.solved[force]

    def interval(self, force: float) -> tuple[float, float]:
        """Return the interval that holds a centrifugal force, right half-way."""
        low, high = next(pair for pair in itertools.pairwise(self.roots) if force <= pair[1])
        while not self._is_right(low, high):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if force <= middle else (middle, high)
        return low, high

    def measured(self, known: Mapping[float, LoadDistribution]) -> dict[float, LoadDistribution]:
        """Measure the map between its positions, at the roots and where their intervals are halved first."""
        distributions = dict[float, LoadDistribution]()

        def measure(force: float) -> bool:
            found = self.assembly.load_distribution(
                2 * self.n_positions, self._speed(force), known.get(force)
            )
            distributions[force], orbit = found, self._orbit(found)
            true = orbit[:, 1::2]
            orbit = orbit[:, ::2]
            slopes = _slopes(orbit)
            half_way = 0.5 * (orbit + np.roll(orbit, -1, axis=1)) + 0.125 * (
                slopes - np.roll(slopes, -1, axis=1)
            )
            self.solved[force] = orbit
            self.over_position = max(self.over_position, self._misplaced(half_way, true))
            return self.over_position <= self.tolerance

        pairs = list(itertools.pairwise(self.roots))
        enough = all(measure(force) for force in self.roots)
        for _ in range(_MEASURED):
            enough = enough and all(measure(0.5 * (low + high)) for low, high in pairs)
            if not enough:
                break
            halved = [
                (low, 0.5 * (low + high), high)
                for low, high in pairs
                if not self._is_right(low, high)
            ]
            pairs = [pair for nodes in halved for pair in itertools.pairwise(nodes)]
        return distributions

    def _speed(self, force: float) -> float:
        return math.sqrt(force / self.per_square)

    def _orbit(self, found: LoadDistribution) -> Array:
        rings = (
            load.swapaxes(0, 1).reshape(-1, self.assembly.slices)
            for load in (found.inner_load, found.outer_load)
        )
        return np.stack(tuple(rings))

    def _is_right(self, low: float, high: float) -> bool:
        """Whether loads are linear between two forces, half-way between them."""
        if (low, high) in self.right:
            return self.right[low, high]
        off = 0.5 * (self.at(low) + self.at(high))
        true = self.at(0.5 * (low + high))
        off -= true
        error = self._fraction(np.abs(off @ self.assembly.widths), true)
        if error <= self.tolerance:
            error = max(error, self._fraction(np.abs(off) @ self.assembly.widths, true) / _ALONG)
        self.right[low, high] = error <= self.tolerance
        if self.right[low, high]:
            self.over_force = max(self.over_force, error)
        return self.right[low, high]

    def _misplaced(self, interpolated: Array, true: Array) -> float:
        """Share of the load of a ring that is at the wrong place, the larger of both rings; loads (2, m, n)."""
        return self._fraction(np.abs((interpolated - true) @ self.assembly.widths), true)

    def _fraction(self, off: Array, true: Array) -> float:
        """Share of the load of a ring that forces (2, m) are, the larger of both rings."""
        whole = np.maximum((true @ self.assembly.widths).sum(axis=1), self.least * true.shape[1])
        return float((off.sum(axis=1) / np.where(whole > 0.0, whole, 1.0)).max())


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
    return np.asarray(
        np.bincount(owner, slices.resistance * widths[slice_number], load.shape[0]), dtype=float
    )
