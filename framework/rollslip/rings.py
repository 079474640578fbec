"""Flexible rings and raceways that are out of round: the data of a model of kind ``ring``, and the gaps of the rollers.

- A model provides data: shapes as Fourier sums, each with a stiffness, the forces on them, and one-sided stops. It does
  not solve anything: the framework solves the equilibrium of all rollers and both rings as one convex problem.
- The form of a raceway is geometry of the bearing, with any model. It is at rest, or turns with its ring. Over a long
  time its angle is independent of the position of the rollers within their pitch, so that a mean is one over both. The
  roller positions are therefore a rank-1 lattice in both phases, (m/M, k m/M mod 1), with k such that the waves which
  the lattice cannot distinguish from constants are short (`_step`).
"""

import abc
from functools import cache
from itertools import compress
from typing import ClassVar

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.geometry.bearing import Bearing
from rollslip.references import CitedModel
from rollslip.search import Array

__all__ = ["RingModel", "RingShapes", "Rings", "Stops"]

#: Highest number of waves of a form that is taken into account in the choice of a lattice. Doubling it takes four times
#: as long and distinguishes lattices by waves which hardly change loads. Chosen.
_HIGHEST = 60
#: Limit of the lattice steps k that are tried, the odd numbers below it. Doubling it takes twice as long, once for each
#: number of positions; it matters for more than 257 positions only. Chosen.
_STEPS = 257


@attrs.frozen(eq=False)
class Stops:
    """A seat with clearance: springs around a ring that act on it only where it has closed the gap."""

    #: Angles of the springs from the line of load [rad], (s,).
    angles: Array
    #: Stiffness of each spring [N/m].
    stiffness: float
    #: Deflection of the ring at which a spring starts to act [m].
    gap: float


@attrs.frozen(eq=False)
class RingShapes:
    """Shapes in which the raceway of a ring deforms, away from the rollers.

    Raises
    ------
    ValueError
        A stiffness is not positive although there are no stops, or the shapes of arrays do not agree.
    """

    #: Coefficients c of B(psi) = Re sum c_n exp(i n psi) of each shape, (m, N + 1): 1 is a cosine, -i a sine.
    harmonics: NDArray[np.complex128] = attrs.field(factory=lambda: np.zeros((0, 1), complex))
    #: Stiffness of each shape [N/m], (m,): K q = sum Q B(psi) in equilibrium. Zero where only stops resist it.
    stiffness: Array = attrs.field(factory=lambda: np.zeros(0))
    #: Forces on the shapes other than those of the rollers [N], (m,).
    pushes: Array = attrs.field(
        default=attrs.Factory(lambda shapes: np.zeros(shapes.stiffness.size), takes_self=True)
    )
    #: A seat with clearance.
    stops: Stops | None = None
    #: Mass of each shape [kg], (m,), in the kinetic energy sum M (dq/dt)^2/2. None where it is unknown; plane motion
    #: needs it.
    mass: Array | None = None
    #: Fraction of critical damping of all shapes [1].
    damping_ratio: float = 0.0
    #: Keys of the model that describe another seat than ``bearing.mounting``.
    departs: tuple[str, ...] = ()

    def __attrs_post_init__(self) -> None:
        m = self.stiffness.size
        if self.harmonics.ndim != 2 or not self.harmonics.shape[0] == m == self.pushes.size:
            raise ValueError(
                f"{self.harmonics.shape[0]} shapes, {m} stiffnesses and {self.pushes.size} pushes"
            )
        if self.mass is not None and not (self.mass.shape == (m,) and np.all(self.mass > 0.0)):
            raise ValueError(f"{m} shapes need as many masses above 0 kg, not {self.mass}")
        minimum = 0.0 if self.stops else np.finfo(float).tiny
        if not (np.all(self.stiffness >= minimum) and np.all(np.isfinite(self.stiffness))):
            raise ValueError(
                f"a ring has a shape of stiffness {self.stiffness.min():g} N/m: nothing holds it; it must be above 0"
            )

    def at(self, psi: Array) -> Array:
        """Return the values B of the shapes at angles [rad], (..., m)."""
        waves = np.exp(1j * np.multiply.outer(psi, np.arange(self.harmonics.shape[1])))
        return np.real(waves @ self.harmonics.T)

    @property
    def parity(self) -> Array:
        """1 for shapes that are even about the line of load, -1 for odd ones, 0 for others, (m,)."""
        is_even, is_odd = (
            np.all(part == 0.0, axis=1) for part in (self.harmonics.imag, self.harmonics.real)
        )
        return np.where(is_even, 1.0, np.where(is_odd, -1.0, 0.0))

    @property
    def symmetric(self) -> bool:
        """Whether the ring, with all forces and stops, is symmetric about the line of load."""
        parity = self.parity
        angles = np.zeros(1) if self.stops is None else self.stops.angles
        distances = np.abs(np.exp(1j * np.subtract.outer(angles, -angles)) - 1.0)
        has_images = distances.min(axis=1).max() < 1e-9
        return bool(np.all(parity != 0.0) and not np.any(self.pushes[parity < 0.0]) and has_images)


class RingModel(CitedModel):
    """Model of the flexibility of a ring in its seat; its parameters are its attrs fields."""

    #: Whether the ring deforms in the equilibrium; the widening of a rigid ring is part of the clearance of the scene.
    is_flexible: ClassVar[bool] = True

    @abc.abstractmethod
    def shapes(self, bearing: Bearing, ring: str, turns: bool) -> RingShapes:
        """Return the shapes of a ring.

        Parameters
        ----------
        bearing : Bearing
            The bearing.
        ring : str
            "inner" or "outer".
        turns : bool
            Whether the ring turns relative to the load.

        Raises
        ------
        FieldError
            If a parameter does not fit the bearing; its reason names what to change.
        """


def _lattice(n_positions: int, rollers: int, periods: int, ring: int) -> Array:
    """Return the angle of a form with some periods per turn at M roller positions [rad], (M,)."""
    step = _step(n_positions, round(rollers / periods)) ** ring % n_positions
    return np.asarray(
        2.0 * np.pi / periods * (np.arange(n_positions) * step % n_positions / n_positions)
    )


@cache
def _step(n_positions: int, rollers: int) -> int:
    """Return the step k of the rank-1 lattice for a number of rollers in a period of a form.

    The loads are a Fourier series of the angle of the form against the load, with waves s of its period, and against
    the rollers, with waves n of their pitch: exp(2 pi i (n x + (s - n Z) y)) of the phases x and y. A lattice cannot
    distinguish waves with n + k (s - n Z) = 0 mod M from a constant (aliasing). The k with the largest minimum of
    10 n + |s| over these waves is returned.
    """
    n, s = (
        grid.ravel()[_HIGHEST + 1 :] for grid in np.mgrid[: _HIGHEST // 5, -_HIGHEST : _HIGHEST + 1]
    )

    def lowest_aliased_order(k: int) -> float:
        is_aliased = (n + k * (s - n * rollers)) % n_positions == 0
        return float((10 * n + np.abs(s))[is_aliased].min(initial=10 * _HIGHEST))

    return max(range(1, min(n_positions, _STEPS), 2), key=lowest_aliased_order, default=1)


@attrs.frozen(eq=False)
class Rings:
    """Both rings and the forms of their raceways."""

    inner: RingShapes
    outer: RingShapes
    #: Waves of both forms: number of lobes, amplitude [m], angle [rad].
    waves: tuple[tuple[int, float, float], ...] = ()
    #: Tables of both forms: angles [rad] and heights [m], (n,) each.
    tables: tuple[tuple[Array, Array], ...] = ()
    #: Estimated relative error of friction by the shapes that were left out [1].
    left: float = 0.0
    #: Periods per turn of each wave and table, 0 at rest, and 1 for the inner ring, 2 for the outer one; empty if all
    #: are at rest.
    turns: tuple[tuple[int, int], ...] = ()

    @property
    def flexible_rings(self) -> dict[str, RingShapes]:
        """The shapes of the flexible rings, by "inner" and "outer"."""
        return {
            ring: shapes
            for ring, shapes in (("inner", self.inner), ("outer", self.outer))
            if shapes.stiffness.size
        }

    @property
    def parity(self) -> Array:
        """Parity of all shapes, those of the inner ring first, (m,)."""
        return np.concatenate((self.inner.parity, self.outer.parity))

    def form(self, psi: Array) -> Array:
        """Return the sum of the heights of both raceways towards a roller [m] at angles [rad].

        Forms that turn do so from one roller position to the next, for angles of all positions of a pitch, (M, Z).
        """
        form = np.zeros(psi.shape)
        turned: list[Array] = [np.zeros(1)] * (len(self.waves) + len(self.tables))
        if self.turning and psi.ndim == 2:
            M, Z = psi.shape
            turned = [
                _lattice(M, Z, periods, ring)[:, None] if periods else turned[0]
                for periods, ring in self.turns
            ]
        for (lobes, amplitude, angle), turn in zip(self.waves, turned, strict=False):
            form += amplitude * np.cos(lobes * (psi - angle - turn))
        for (angles, heights), turn in zip(self.tables, turned[len(self.waves) :], strict=True):
            form += np.interp(psi - turn, angles, heights, period=2.0 * np.pi)
        return form

    def with_single_form(self, ring: int) -> "Rings":
        """Return the rings with the form of a single one, 1 for the inner and 2 for the outer ring, at rest."""
        own = [number == ring for _, number in self.turns]
        waves = tuple(compress(self.waves, own))
        tables = tuple(compress(self.tables, own[len(self.waves) :]))
        return attrs.evolve(self, waves=waves, tables=tables, turns=())

    @property
    def image(self) -> "Rings":
        """The mirror image of the rings about the line of load."""

        def mirror(ring: RingShapes) -> RingShapes:
            stops = (
                None if ring.stops is None else attrs.evolve(ring.stops, angles=-ring.stops.angles)
            )
            return attrs.evolve(ring, harmonics=ring.harmonics.conj(), stops=stops)

        waves = tuple((lobes, amplitude, -angle) for lobes, amplitude, angle in self.waves)
        tables = tuple((-angles, heights) for angles, heights in self.tables)
        return attrs.evolve(
            self, inner=mirror(self.inner), outer=mirror(self.outer), waves=waves, tables=tables
        )

    @property
    def turning(self) -> bool:
        """Whether a form turns relative to the load."""
        return any(periods for periods, _ in self.turns)

    def mirrored(self, psi: Array) -> bool:
        """Whether gaps and shapes at these angles [rad] are symmetric about the line of load."""
        if self.turning:
            return False
        form = self.form(psi)
        image = self.form(-psi)
        is_even = bool(
            np.all(np.abs(form - image) <= 1e-12 * max(np.abs(form).max(initial=0.0), 1e-12))
        )
        return is_even and self.inner.symmetric and self.outer.symmetric

    def directions(self, psi: Array) -> Array:
        """Return the gap that each unknown of the rings closes at angles [rad]: cos, sin and -B, (..., 2 + m)."""
        along = np.cos(psi)[..., None], np.sin(psi)[..., None]
        return np.concatenate((*along, -self.inner.at(psi), -self.outer.at(psi)), axis=-1)

    def reach(self, load: float) -> float:
        """Return an upper estimate of the deflection of the rings under a load [N] [m], as the scale of steps."""
        deflection = 0.0
        for ring in (self.inner, self.outer):
            is_elastic = ring.stiffness > 0.0
            forces = (np.abs(ring.pushes) + load)[is_elastic]
            deflection += float((forces / ring.stiffness[is_elastic]).max(initial=0.0))
            deflection += 0.0 if ring.stops is None else abs(ring.stops.gap)
        return deflection

    def stops(self) -> Array:
        """Return the values of the shapes at all stops by unknown of the rings, stiffness and gap, (s, 2 + m + 2)."""
        m = self.parity.size
        rows = [np.zeros((0, self.parity.size + 4))]
        for first, ring in ((2, self.inner), (2 + self.inner.stiffness.size, self.outer)):
            if ring.stops is not None:
                row = np.zeros((ring.stops.angles.size, m + 4))
                row[:, first : first + ring.stiffness.size] = ring.at(ring.stops.angles)
                row[:, m + 2 :] = ring.stops.stiffness, ring.stops.gap
                rows.append(row)
        return np.concatenate(rows)
