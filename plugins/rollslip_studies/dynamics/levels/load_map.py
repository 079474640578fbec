"""Tabulate the quasi-static loads of a roller over its position in the orbit and its orbital speed.

- Equal rollers at the spacing of a cage are all loaded alike, each at its own position: the equilibrium at ``n``
  positions of the cage within a pitch gives the loads of one roller at n Z positions of the orbit.
- The loads depend on the orbital speed through the centrifugal force alone, and nearly linearly. They are smooth in the
  position except where slices gain or lose contact.

The method:

1. Over position: periodic cubic Hermite interpolation with slopes of fourth order, limited so that no load becomes
   negative. Where no node is loaded, no load is.
2. Compare the forces half-way between positions with the equilibrium there. Double the positions until the error is
   within half the tolerance.
3. Over centrifugal force: linear interpolation. Halve an interval until the loads half-way in it are right within the
   other half of the tolerance. Cubics would not save nodes: slices gain or lose contact within most intervals.
4. Intervals are halved where a motion requests them: a motion passes through few of the dozens that a map of all speeds
   has. The intervals do not depend on earlier requests.

The error is the fraction of the load of a ring that is at the wrong position: the sum of |dQ| over the orbit relative
to that of Q. It bounds the error of friction. The largest error of one force, where a contact is lost, is mostly 2 to 8
times as large.
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
from rollslip_studies.motion.orbit_loads import check_repeats

#: Number of positions within a pitch at first. Doubling it saves the first comparison of most maps, and makes maps of
#: loose tolerances larger. Chosen.
_FIRST_POSITIONS = 2
#: Maximum number of positions within a pitch. Doubling it allows tighter tolerances, at twice the time and memory of
#: those maps. Chosen.
_MAX_POSITIONS = 256
#: Maximum number of centrifugal forces; twice as many intervals may be checked. As `_MAX_POSITIONS`. Chosen.
_MAX_FORCES = 1025
#: Number of halvings between the initial forces up to which the error between positions is measured. It is alike at
#: similar forces. Each one more costs up to twice as many equilibria at twice the positions. Chosen.
_MEASURED_HALVINGS = 2
#: Factor by which the error of the loads of slices may exceed the tolerance between forces, where the error of their
#: sum does not: friction depends less on the distribution along a roller. Under hardly any load except centrifugal
#: force, the force of a contact is linear in that, and the loads of its slices are not. Halving it adds forces. Chosen.
_SLICE_ERROR_FACTOR = 4.0
#: Maximum number of cached equilibria over an orbit. Motions read tables, and refine few intervals at a time. Doubling
#: it doubles the memory and rarely saves an equilibrium. Chosen.
_MAX_CACHED_ORBITS = 24


@attrs.frozen(eq=False)
class LoadMap:
    """Loads over orbital position and centrifugal force, computed where a motion requests them."""

    orbits: "Orbits"  # equilibria at the nodes
    #: Factors from loads to forces, (n,): widths of the slices [m]; 1 in a map of forces.
    widths: Array
    #: Function of the loads of a node, (2, K, n), that returns the tabulated values; by default the loads.
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
        """Largest fraction of the load of a ring at the wrong position, over all intervals requested so far.

        It is measured half-way between positions and half-way between forces.
        """
        return self.orbits.over_position + self.orbits.over_force

    def interval(self, centrifugal: float) -> tuple[float, float]:
        """Return the two nodes around a centrifugal force from 0 to the top, between which loads are linear [N]."""
        return self.orbits.interval(centrifugal)

    def loads(self, centrifugal: float) -> Array:
        """Return the loads at a node of centrifugal force [N], at equal steps of position from the line of load.

        They have the shape (channels, K, n): loads per length on inner and outer ring [N/m]. In a map of forces they
        are forces [N], n = 1, followed by the rolling resistances on both rings [N] if there are any.
        """
        loads = self.orbits.at(centrifugal)
        return loads if self.channels_of is None else self.channels_of(loads)

    def table(self, centrifugal: float) -> Array:
        """Return loads and slopes at a node as the compiled motion reads them, (K + 1, 2, channels, n).

        The last row repeats the first position.
        """
        if centrifugal not in self._tables:
            loads = self.loads(centrifugal)
            channels, positions, slices = loads.shape
            table = np.empty((positions + 1, 2, channels, slices))
            table[:-1, 0] = loads.swapaxes(0, 1)
            table[:-1, 1] = _slopes(loads).swapaxes(0, 1)
            table[-1] = table[0]
            self._tables[centrifugal] = table
        return self._tables[centrifugal]

    def cell(self, centrifugal: float) -> tuple[float, float, Array, Array]:
        """Return the ends of the interval of a centrifugal force [N], and the tables there, as `Carried` takes them."""
        low, high = self.interval(centrifugal)
        return low, high, self.table(low), self.table(high)

    def at(self, psi: Array, centrifugal: float) -> Array:
        """Return the loads at positions of a roller, (channels, m, n).

        Parameters
        ----------
        psi : ndarray, shape (m,)
            Positions from the line of load [rad].
        centrifugal : float
            Centrifugal force up to the top [N].
        """
        index = np.asarray(psi) / (2.0 * np.pi) % 1.0 * self.positions
        k = np.minimum(index.astype(int), self.positions - 1)
        x = (index - k)[:, None, None]
        low, high, below, above = self.cell(centrifugal)
        f = (centrifugal - low) / (high - low)
        table = (1.0 - f) * below + f * above
        (a, slope_a), (b, slope_b) = (table[i].swapaxes(0, 1) for i in (k, k + 1))
        return np.asarray(
            np.maximum(
                a
                + x * x * (3.0 - 2.0 * x) * (b - a)
                + x * (1.0 - x) * ((1.0 - x) * slope_a - x * slope_b),
                0.0,
            ).swapaxes(0, 1)
        )

    def forces(self, resistance: Callable[[Array, int], Array] | None = None) -> "LoadMap":
        """Return the map of forces; ``resistance`` gives rolling resistances (m,) of loads (m, n) on a ring (0, 1)."""

        def forces_of(loads: Array) -> Array:
            forces = (loads @ self.widths)[..., None]
            if resistance is None:
                return forces
            return np.concatenate(
                (forces, [resistance(loads[ring], ring)[:, None] for ring in range(len(RINGS))])
            )

        return LoadMap(self.orbits, np.ones(1), forces_of)


def fastest(kinematics: Kinematics) -> float:
    """Return the largest expected speed of a cage [rad/s]: that of a ring, or the epicyclic one."""
    speeds = kinematics.epicyclic_cage_speed, kinematics.inner_speed, kinematics.outer_speed
    return max(map(abs, speeds))


def build_load_map(
    assembly: Assembly,
    tolerance: float,
    top_speed: float | None = None,
    reference_force: float = 0.0,
) -> LoadMap:
    """Build the map of a bearing, once for each bearing and each set of arguments.

    Parameters
    ----------
    assembly : Assembly
        The bearing.
    tolerance : float
        Largest fraction of the load of a ring that may be at the wrong position.
    top_speed : float, optional
        Cage speed up to which the map goes [rad/s]; by default that of the faster ring.
    reference_force : float
        Lower bound of the mean force of a roller on a ring [N] that errors are relative to, for a ring that carries
        hardly any load.

    Raises
    ------
    ConvergenceError
        If the maximum number of nodes does not reach the tolerance, or the bearing has no equilibrium.
    """
    raceways = ((raceway.deflection, raceway.conditions) for raceway in assembly.raceways)
    key = (
        assembly.slices,
        assembly.resolution.quadrature,
        tolerance,
        top_speed,
        reference_force,
        *raceways,
    )
    return assembly.cached(
        "loads over the orbit",
        key,
        lambda: _build_load_map(assembly, tolerance, top_speed, reference_force),
    )


def _build_load_map(
    assembly: Assembly, tolerance: float, top_speed: float | None, reference_force: float
) -> LoadMap:
    """Double the positions within a pitch until the error between them is within half the tolerance."""
    check_repeats(assembly)
    force_per_square = assembly.roller_mass * assembly.kinematics.orbit_radius
    if top_speed is None:
        top_speed = fastest(assembly.kinematics)
    top = force_per_square * top_speed**2
    roots = tuple(sorted({0.0, min(assembly.centrifugal_force, top), top}))
    n_positions = _FIRST_POSITIONS
    known = dict[float, LoadDistribution]()
    while n_positions <= _MAX_POSITIONS:
        orbits = Orbits(
            assembly, force_per_square, n_positions, roots, 0.5 * tolerance, reference_force
        )
        known = orbits.measure_positions(known)
        if orbits.over_position <= orbits.tolerance:
            return LoadMap(orbits, assembly.widths)
        n_positions *= 2
    raise ConvergenceError(
        f"{_MAX_POSITIONS} positions a pitch leave {orbits.over_position:.1e} of the load at the wrong place; "
        f"its table may leave {tolerance:.1e}; {COARSER_TABLES}"
    )


class Orbits:
    """Equilibria over the orbit at the nodes of a map, by centrifugal force.

    Parameters
    ----------
    assembly : Assembly
        The bearing.
    force_per_square : float
        Centrifugal force of a roller over the square of its orbital speed [N s2].
    n_positions : int
        Number of positions within a pitch.
    roots : tuple of float
        Centrifugal forces [N] between which intervals are halved, ascending from 0.
    tolerance : float
        Largest fraction of the load at the wrong position, half-way between positions and half-way between forces.
    reference_force : float
        Lower bound of the mean force of a roller on a ring [N] that this fraction is relative to.

    Attributes
    ----------
    solved : dict
        Loads over the orbit, (2, K, n), by centrifugal force.
    accepted : dict
        Whether the loads half-way in an interval of forces are within the tolerance, by its ends.
    over_position, over_force : float
        Largest fraction of the load at the wrong position, half-way between positions and half-way between forces.
    """

    def __init__(
        self,
        assembly: Assembly,
        force_per_square: float,
        n_positions: int,
        roots: tuple[float, ...],
        tolerance: float,
        reference_force: float,
    ) -> None:
        self.assembly = assembly
        self.force_per_square = force_per_square
        self.n_positions = n_positions
        self.roots = roots
        self.tolerance = tolerance
        self.reference_force = reference_force
        self.positions = n_positions * assembly.scene.bearing.rollers
        self.solved: dict[float, Array] = {}
        self.accepted: dict[tuple[float, float], bool] = {}
        self.over_position = 0.0
        self.over_force = 0.0

    def at(self, force: float) -> Array:
        """Return the loads of one roller over its orbit at a centrifugal force [N], (2, K, n)."""
        if force not in self.solved:
            if len(self.accepted) > 2 * _MAX_FORCES:
                raise ConvergenceError(
                    f"{_MAX_FORCES} centrifugal forces leave more than {self.tolerance:.1e} of the load at the wrong "
                    f"place near {force:g} N; {COARSER_TABLES}"
                )
            orbit = self._orbit(
                self.assembly.load_distribution(self.n_positions, self._speed(force))
            )
            while len(self.solved) >= _MAX_CACHED_ORBITS:
                del self.solved[next(iter(self.solved))]
            self.solved[force] = orbit
        return self.solved[force]

    def interval(self, force: float) -> tuple[float, float]:
        """Return the ends of the interval around a centrifugal force [N], halved until it is within the tolerance."""
        low, high = next(pair for pair in itertools.pairwise(self.roots) if force <= pair[1])
        while not self._is_linear(low, high):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if force <= middle else (middle, high)
        return low, high

    def measure_positions(
        self, known: Mapping[float, LoadDistribution]
    ) -> dict[float, LoadDistribution]:
        """Measure the error half-way between positions, at the initial forces and those of the first halvings.

        Return the load distributions at twice the positions, by force; ``known`` are those of the coarser map, from
        which the equilibrium starts.
        """
        distributions = dict[float, LoadDistribution]()

        def measure(force: float) -> bool:
            distributions[force] = self.assembly.load_distribution(
                2 * self.n_positions, self._speed(force), known.get(force)
            )
            orbit = self._orbit(distributions[force])
            true = orbit[:, 1::2]
            orbit = orbit[:, ::2]
            slopes = _slopes(orbit)
            half_way = 0.5 * (orbit + np.roll(orbit, -1, axis=1)) + 0.125 * (
                slopes - np.roll(slopes, -1, axis=1)
            )
            self.solved[force] = orbit
            misplaced = np.abs((half_way - true) @ self.assembly.widths)
            self.over_position = max(self.over_position, self._fraction(misplaced, true))
            return self.over_position <= self.tolerance

        pairs = list(itertools.pairwise(self.roots))
        is_accurate = all(map(measure, self.roots))
        for _ in range(_MEASURED_HALVINGS):
            is_accurate = is_accurate and all(measure(0.5 * (low + high)) for low, high in pairs)
            if not is_accurate:
                break
            pairs = [
                pair
                for low, high in pairs
                if not self._is_linear(low, high)
                for pair in itertools.pairwise((low, 0.5 * (low + high), high))
            ]
        return distributions

    def _speed(self, force: float) -> float:
        """Return the orbital speed [rad/s] at a centrifugal force [N]."""
        return math.sqrt(force / self.force_per_square)

    def _orbit(self, distribution: LoadDistribution) -> Array:
        """Return the loads of one roller over its orbit, (2, K, n), from those of all rollers."""
        return np.stack(
            [
                load.swapaxes(0, 1).reshape(-1, self.assembly.slices)
                for load in (distribution.inner_load, distribution.outer_load)
            ]
        )

    def _is_linear(self, low: float, high: float) -> bool:
        """Return whether loads half-way between two forces are linear in the force, within the tolerance."""
        if (low, high) in self.accepted:
            return self.accepted[low, high]
        error_of_loads = 0.5 * (self.at(low) + self.at(high))
        true = self.at(0.5 * (low + high))
        error_of_loads -= true
        error = self._fraction(np.abs(error_of_loads @ self.assembly.widths), true)
        if error <= self.tolerance:
            error = max(
                error,
                self._fraction(np.abs(error_of_loads) @ self.assembly.widths, true)
                / _SLICE_ERROR_FACTOR,
            )
        self.accepted[low, high] = error <= self.tolerance
        if self.accepted[low, high]:
            self.over_force = max(self.over_force, error)
        return self.accepted[low, high]

    def _fraction(self, forces: Array, loads: Array) -> float:
        """Return the sum of forces (2, m) relative to the load of the ring, the larger of both; loads (2, m, n)."""
        whole = np.maximum(
            (loads @ self.assembly.widths).sum(axis=1), self.reference_force * loads.shape[1]
        )
        return float((forces.sum(axis=1) / np.where(whole > 0.0, whole, 1.0)).max())


def _slopes(loads: Array) -> Array:
    """Return derivatives over position, the last axis but one, times its step, limited so that loads are positive.

    They are central differences of fourth order. With |slope| <= 3 load at its ends, all Bernstein coefficients of the
    cubic of a cell are positive or zero.
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
    """Return the rolling resistance of contacts that roll without sliding [N], (m,).

    Parameters
    ----------
    raceway : Raceway
        The raceway, whose chain of laws gives the resistance.
    load : ndarray, shape (m, n)
        Loads per length of the slices [N/m].
    widths : ndarray, shape (n,)
        Widths of the slices [m].
    rolling_speed : float
        Mean surface speed of the contact [m/s].
    """
    contact, slice_number = np.nonzero(load > 0.0)
    slices = raceway.evaluate(load[contact, slice_number], rolling_speed, 0.0)
    return np.asarray(
        np.bincount(contact, slices.resistance * widths[slice_number], load.shape[0]), dtype=float
    )
