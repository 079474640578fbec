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
from collections.abc import Callable

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.kinematics import Kinematics
from rollslip.bearing.raceway import RINGS, Array, Raceway
from rollslip.bearing.resolution import COARSER_TABLES
from rollslip.errors import ConvergenceError

_FIRST_INSTANTS, _MOST_INSTANTS = 2, 256
_MOST_FORCES = 1025


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
        both = np.stack((self.loads, _slopes(self.loads))).transpose(1, 3, 0, 2, 4)
        return np.concatenate((both, both[:, :1]), axis=1)

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
    per_square = assembly.roller_mass * assembly.kinematics.orbit_radius
    top = per_square * (fastest(assembly.kinematics) if top_speed is None else top_speed) ** 2
    instants = _FIRST_INSTANTS
    while instants <= _MOST_INSTANTS:
        orbits = _Orbits(assembly, per_square, instants)
        load_map = orbits.refined({0.0, min(assembly.centrifugal_force, top), top}, 0.5 * tolerance)
        if load_map is not None:
            return load_map
        instants *= 2
    raise ConvergenceError(
        f"{_MOST_INSTANTS} positions a pitch leave {orbits.over_position:.1e} of the load at the wrong place; "
        f"its table may leave {tolerance:.1e}; {COARSER_TABLES}"
    )


class _Orbits:
    """Equilibria by centrifugal force, at twice as many positions as the map will have: the others measure it."""

    def __init__(self, assembly: Assembly, per_square: float, instants: int) -> None:
        self.assembly, self.per_square, self.instants = assembly, per_square, instants
        self.solved: dict[float, Array] = {}
        #: largest share of the load at the wrong place half-way between positions
        self.over_position = 0.0

    def at(self, force: float) -> Array:
        """Loads of one roller over its orbit, (2, Z 2 instants, n)."""
        if force not in self.solved:
            assembly = self.assembly
            loads = assembly.load_distribution(2 * self.instants, math.sqrt(force / self.per_square))
            rows = (load.swapaxes(0, 1).reshape(-1, assembly.slices) for load in (loads.inner_load, loads.outer_load))
            self.solved[force] = np.stack(tuple(rows))
            nodes, between = self.solved[force][:, ::2], self.solved[force][:, 1::2]
            slopes = _slopes(nodes)
            half_way = 0.5 * (nodes + np.roll(nodes, -1, axis=1)) + 0.125 * (slopes - np.roll(slopes, -1, axis=1))
            self.over_position = max(self.over_position, self.misplaced(half_way, between))
        return self.solved[force]

    def misplaced(self, interpolated: Array, true: Array) -> float:
        """Share of the load of a ring that is at the wrong place, the larger of both rings; loads (2, m, n)."""
        widths = self.assembly.widths
        off, whole = np.abs((interpolated - true) @ widths).sum(axis=1), (true @ widths).sum(axis=1)
        return float((off / np.where(whole > 0.0, whole, 1.0)).max())

    def refined(self, nodes: set[float], tolerance: float) -> LoadMap | None:
        """Map with enough centrifugal forces; None if its positions are too few."""
        pairs, over_force = list(itertools.pairwise(sorted(nodes))), 0.0
        while pairs:
            low, high = pairs.pop()
            middle = 0.5 * (low + high)
            error = self.misplaced(0.5 * (self.at(low) + self.at(high)), self.at(middle))
            if self.over_position > tolerance:
                return None
            if error <= tolerance:
                over_force = max(over_force, error)
                continue
            nodes.add(middle)
            pairs += [(low, middle), (middle, high)]
            if len(nodes) > _MOST_FORCES:
                raise ConvergenceError(
                    f"{_MOST_FORCES} centrifugal forces leave {error:.1e} of the load at the wrong place between "
                    f"{low:g} and {high:g} N; its table may leave {2.0 * tolerance:.1e}; {COARSER_TABLES}"
                )
        loads = np.stack([self.at(force)[:, ::2] for force in sorted(nodes)])
        return LoadMap(np.array(sorted(nodes)), loads, self.assembly.widths, self.over_position + over_force)


def _slopes(loads: Array) -> Array:
    """Derivatives over position, the last axis but one, times its step, limited so that nothing turns negative.

    With |slope| <= 3 load at its ends, all Bernstein coefficients of a cell are positive or zero.
    """

    def ahead(k: int) -> Array:
        return np.roll(loads, -k, axis=-2)

    slope = (8.0 * (ahead(1) - ahead(-1)) - (ahead(2) - ahead(-2))) / 12.0
    return np.clip(slope, -3.0 * loads, 3.0 * loads)


def resistances(raceway: Raceway, load: Array, widths: Array, rolling_speed: float) -> Array:
    """Rolling resistance [N] of contacts with loads per length [N/m], (m, n), that roll without sliding: (m,)."""
    owner, slice_number = np.nonzero(load > 0.0)
    slices = raceway.evaluate(load[owner, slice_number], rolling_speed, 0.0)
    return np.asarray(np.bincount(owner, slices.resistance * widths[slice_number], load.shape[0]), dtype=float)
