"""Rings that yield and raceways out of round: what a model of kind ``ring`` hands over, and what rollers feel of it.

- A model hands over data: shapes as Fourier sums, each with a stiffness, what pushes on them, and one-sided stops. It
  solves nothing: the equilibrium stays one convex problem of all rollers and both rings, the framework's.
- The form of a raceway is geometry, of the bearing, and goes with every model. It stands in the line of load, or turns
  with its ring. How far it has turned is independent of where rollers are in their pitch, if one waits for long. So a
  mean is one over both, and instants of a pitch are a lattice of rank 1 in both, (m/M, k m/M mod 1), whose k is such
  that all waves that it takes for constants are short (`_step`).
"""

import abc
from collections.abc import Mapping
from functools import cache
from itertools import compress
from types import MappingProxyType
from typing import ClassVar

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.datasets import Bearing
from rollslip.references import Citation

__all__ = ["RingModel", "RingShapes", "Rings", "Stops"]

Floats = NDArray[np.float64]
# waves that are looked at, and steps that are tried
_HIGHEST = 60
_STEPS = 257


@attrs.frozen(eq=False)
class Stops:
    """A seat with clearance: springs round a ring that press on it only where it has closed the gap."""

    angles: Floats  #: Where they are [rad], from the line of load, (s,).
    stiffness: float  #: Of each [N/m].
    gap: float  #: By how much the ring yields before one presses [m].


def _none(shapes: "RingShapes") -> Floats:
    return np.zeros(shapes.stiffness.size)


@attrs.frozen(eq=False)
class RingShapes:
    """Shapes in which the raceway of a ring yields, away from the rollers.

    Raises
    ------
    ValueError
        A stiffness is not positive though nothing else holds its shape, or arrays do not fit each other.
    """

    #: c of B(psi) = Re sum c_n exp(i n psi) for each shape, complex, (m, N + 1): 1 is a cosine, -i a sine.
    harmonics: NDArray[np.complex128] = attrs.field(factory=lambda: np.zeros((0, 1), complex))
    #: Of each shape [N/m], (m,): K q = sum Q B(psi) at rest. Zero where stops alone hold it.
    stiffness: Floats = attrs.field(factory=lambda: np.zeros(0))
    #: Loads on the shapes beside those of the rollers [N], (m,).
    pushes: Floats = attrs.field(default=attrs.Factory(_none, takes_self=True))
    stops: Stops | None = None  #: A seat with clearance.
    #: Of each shape [kg], (m,): kinetic energy sum M (dq/dt)^2/2. None where nobody knows; plane motion needs it.
    mass: Floats | None = None
    damping_ratio: float = 0.0  #: Of critical damping, the same for all shapes [1].
    departs: tuple[
        str, ...
    ] = ()  #: Keys of the model by which its seat is not that of ``bearing.mounting``.

    def __attrs_post_init__(self) -> None:
        m = self.stiffness.size
        if self.harmonics.ndim != 2 or not self.harmonics.shape[0] == m == self.pushes.size:
            raise ValueError(
                f"{self.harmonics.shape[0]} shapes, {m} stiffnesses and {self.pushes.size} pushes"
            )
        if self.mass is not None and not (self.mass.shape == (m,) and np.all(self.mass > 0.0)):
            raise ValueError(f"{m} shapes need as many masses above 0 kg, not {self.mass}")
        least = 0.0 if self.stops else np.finfo(float).tiny
        if not (np.all(self.stiffness >= least) and np.all(np.isfinite(self.stiffness))):
            raise ValueError(
                f"a ring has a shape of stiffness {self.stiffness.min():g} N/m: nothing holds it; it must be above 0"
            )

    def at(self, psi: Floats) -> Floats:
        """Return B at angles [rad], (..., m)."""
        waves = np.exp(1j * np.multiply.outer(psi, np.arange(self.harmonics.shape[1])))
        return np.real(waves @ self.harmonics.T)

    @property
    def parity(self) -> Floats:
        """1 for shapes that are their mirror image in the line of load, -1 for odd ones, 0 for others, (m,)."""
        even, odd = (
            np.all(part == 0.0, axis=1) for part in (self.harmonics.imag, self.harmonics.real)
        )
        return np.where(even, 1.0, np.where(odd, -1.0, 0.0))

    @property
    def symmetric(self) -> bool:
        """Whether the ring with all that acts on it mirrors itself in the line of load."""
        parity = self.parity
        at = np.zeros(1) if self.stops is None else self.stops.angles
        mirrored = np.abs(np.exp(1j * np.subtract.outer(at, -at)) - 1.0).min(axis=1).max() < 1e-9
        return bool(np.all(parity != 0.0) and not np.any(self.pushes[parity < 0.0]) and mirrored)


class RingModel(abc.ABC):
    """How a ring yields in its seat; its parameters are its attrs fields."""

    name: ClassVar[str]
    equation: ClassVar[str]
    references: ClassVar[tuple[Citation, ...]]
    #: Whether the ring changes its shape in the equilibrium; a rigid one widens with the clearance of the scene.
    yields: ClassVar[bool] = True
    #: Rule of the conformance kit that the model breaks for a reason -> that reason.
    expected_failures: ClassVar[Mapping[str, str]] = MappingProxyType({})

    @abc.abstractmethod
    def shapes(self, bearing: Bearing, ring: str, turns: bool) -> RingShapes:
        """Return the shapes of the "inner" or "outer" ring of a bearing, which ``turns`` against the load or stands.

        A parameter that does not fit the bearing is a `FieldError`, whose reason names what to change.
        """


def _lattice(n_positions: int, rollers: int, periods: int, ring: int) -> Floats:
    """Return by how much a form of some periods a turn has turned at M instants [rad], (M,)."""
    step = _step(n_positions, round(rollers / periods)) ** ring % n_positions
    return np.asarray(
        2.0 * np.pi / periods * (np.arange(n_positions) * step % n_positions / n_positions)
    )


@cache
def _step(n_positions: int, rollers: int) -> int:
    """Return k of the lattice for so many rollers in a period of a form.

    What loads depend on are places of the form against the load, waves s of its period, and against rollers, waves n of
    their pitch: exp(2 pi i (n x + (s - n Z) y)) of the phases x, y. The lattice takes those for constants for which n +
    k (s - n Z) is 0 mod M. The k is the one whose least 10 n + |s| of these is largest.
    """
    n, s = (
        of.ravel()[_HIGHEST + 1 :] for of in np.mgrid[: _HIGHEST // 5, -_HIGHEST : _HIGHEST + 1]
    )

    def least(k: int) -> float:
        taken = (n + k * (s - n * rollers)) % n_positions == 0
        return float((10 * n + np.abs(s))[taken].min(initial=10 * _HIGHEST))

    return max(range(1, min(n_positions, _STEPS), 2), key=least, default=1)


@attrs.frozen(eq=False)
class Rings:
    """Both rings and the forms of their raceways."""

    inner: RingShapes
    outer: RingShapes
    #: Forms of both raceways: number of waves, amplitude [m], angle [rad], and tables of angles [rad] and heights [m].
    waves: tuple[tuple[int, float, float], ...] = ()
    tables: tuple[tuple[Floats, Floats], ...] = ()
    left: float = (
        0.0  #: Relative error of friction that shapes which were left out are estimated to leave.
    )
    #: Of each of these how many periods a turn of its ring has, 0 if it stands, and 1 for the inner ring, 2 for the
    #: outer one; where they are empty all stand.
    turns: tuple[tuple[int, int], ...] = ()

    @property
    def yielding(self) -> dict[str, RingShapes]:
        """The rings that have shapes, by "inner" and "outer"."""
        return {
            ring: one
            for ring, one in (("inner", self.inner), ("outer", self.outer))
            if one.stiffness.size
        }

    @property
    def parity(self) -> Floats:
        """That of all shapes, those of the inner ring first."""
        return np.concatenate((self.inner.parity, self.outer.parity))

    def form(self, psi: Floats) -> Floats:
        """Return how far both raceways stand out of round towards a roller [m], at angles [rad].

        Forms that turn do so from one instant to the next of those of a whole pitch, (M, Z).
        """
        form = np.zeros(psi.shape)
        turned: list[Floats] = [np.zeros(1)] * (len(self.waves) + len(self.tables))
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

    def formed(self, ring: int) -> "Rings":
        """Return them with the form of one ring alone, 1 for the inner one, 2 for the outer one, as it stands."""
        own = [number == ring for _, number in self.turns]
        waves = tuple(compress(self.waves, own))
        tables = tuple(compress(self.tables, own[len(self.waves) :]))
        return attrs.evolve(self, waves=waves, tables=tables, turns=())

    @property
    def image(self) -> "Rings":
        """The same rings in a mirror along the line of load."""

        def seen(ring: RingShapes) -> RingShapes:
            stops = (
                None if ring.stops is None else attrs.evolve(ring.stops, angles=-ring.stops.angles)
            )
            return attrs.evolve(ring, harmonics=ring.harmonics.conj(), stops=stops)

        waves = tuple((lobes, amplitude, -angle) for lobes, amplitude, angle in self.waves)
        tables = tuple((-angles, heights) for angles, heights in self.tables)
        return attrs.evolve(
            self, inner=seen(self.inner), outer=seen(self.outer), waves=waves, tables=tables
        )

    @property
    def turning(self) -> bool:
        """Whether a form turns against the load."""
        return any(periods for periods, _ in self.turns)

    def mirrored(self, psi: Floats) -> bool:
        """Whether what rollers at these angles feel mirrors itself in the line of load."""
        if self.turning:
            return False
        here = self.form(psi)
        there = self.form(-psi)
        same = bool(
            np.all(np.abs(here - there) <= 1e-12 * max(np.abs(here).max(initial=0.0), 1e-12))
        )
        return same and self.inner.symmetric and self.outer.symmetric

    def directions(self, psi: Floats) -> Floats:
        """Return what gap each unknown of the rings closes at angles [rad]: cos, sin and -B, (..., 2 + m)."""
        along = np.cos(psi)[..., None], np.sin(psi)[..., None]
        return np.concatenate((*along, -self.inner.at(psi), -self.outer.at(psi)), axis=-1)

    def reach(self, load: float) -> float:
        """Return how far rings may yield under a load [N] and what pushes on them [m], to measure steps by."""
        far = 0.0
        for ring in (self.inner, self.outer):
            held = ring.stiffness > 0.0
            far += float(
                ((np.abs(ring.pushes) + load)[held] / ring.stiffness[held]).max(initial=0.0)
            )
            far += 0.0 if ring.stops is None else abs(ring.stops.gap)
        return far

    def stops(self) -> Floats:
        """Return shapes, stiffness and gap of all stops, by unknowns of the rings, (s, 2 + m + 2)."""
        m = self.parity.size
        rows = [np.zeros((0, self.parity.size + 4))]
        for first, ring in ((2, self.inner), (2 + self.inner.stiffness.size, self.outer)):
            if ring.stops is not None:
                row = np.zeros((ring.stops.angles.size, m + 4))
                row[:, first : first + ring.stiffness.size] = ring.at(ring.stops.angles)
                row[:, m + 2 :] = ring.stops.stiffness, ring.stops.gap
                rows.append(row)
        return np.concatenate(rows)
