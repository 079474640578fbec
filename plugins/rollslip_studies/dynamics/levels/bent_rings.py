"""Rings that yield and raceways out of round in plane motion, as the compiled system takes them.

- Shapes become coordinates of the motion, with the stiffness and the pushes that the equilibrium has of them, their
  masses and their damping. Without speeds and damping the equilibrium is what is left.
- Shapes stand in the frame of the outer ring. Of a ring that turns through them that is right up to (n w/w_n)^2, by
  which the inertia of the material that passes softens a shape of n waves and natural frequency w_n; a hoop, n = 0, is
  not concerned. Beyond a tenth of the frequency it is refused.
- A form is a periodic cubic spline: where a table has corners it is rounded over a cell. That of a ring that turns, at
  some time of a history, goes round with it: its angle is a coordinate, whose rate is the speed of the ring.
"""

import math
from collections.abc import Mapping
from itertools import compress
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import RINGS, Array
from rollslip.errors import DomainError
from rollslip.rings import Rings, RingShapes

_FASTEST: Final = (
    0.1  # of a natural frequency, that of the waves in which a turning ring passes through a shape
)
#: Cells of a form for each lobe, by which a spline is right to 1e-7, for each row of a table, and least and most.
_PER_LOBE = 128
_PER_ROW = 8
_LEAST = 256
_MOST = 65536


def turned(rings: Rings, by: float) -> Rings:
    """Return rings, with forms as they are at the start, seen from a line that is turned by an angle [rad]."""

    def seen(ring: RingShapes) -> RingShapes:
        return attrs.evolve(
            ring, harmonics=ring.harmonics * np.exp(1j * by * np.arange(ring.harmonics.shape[1]))
        )

    waves = tuple((lobes, amplitude, angle - by) for lobes, amplitude, angle in rings.waves)
    tables = tuple((angles - by, heights) for angles, heights in rings.tables)
    standing = tuple((0, ring) for _, ring in rings.turns)
    return Rings(seen(rings.inner), seen(rings.outer), waves, tables, turns=standing)


@attrs.frozen(eq=False)
class BentRings:
    """Rings of a bearing in plane motion that yield or are out of round, in the sense of positive speeds."""

    rings: Rings  # with forms as they are at the start
    forms: tuple[
        Array | None, Array | None
    ]  # of either raceway, cubic on equal cells of the angle, (cells, 4)
    turns: tuple[bool, bool]  # whether that goes round with its ring

    @property
    def of_both(self) -> tuple[RingShapes, RingShapes]:
        """Shapes of inner and outer ring."""
        return self.rings.inner, self.rings.outer

    @property
    def names(self) -> Mapping[str, str]:
        """Unknowns in the head -> their unit: amplitudes of shapes, inner ring first, rates, and angles of forms."""
        shapes = [
            f"{ring}_ring_{_called(row, k)}"
            for ring, one in zip(RINGS, self.of_both, strict=True)
            for k, row in enumerate(one.harmonics)
        ]
        angles = [f"{ring}_form_angle" for ring in compress(RINGS, self.turns)]
        speeds = [f"{name}_speed" for name in shapes]
        return (
            dict.fromkeys(shapes, "m") | dict.fromkeys(speeds, "m/s") | dict.fromkeys(angles, "rad")
        )

    @property
    def shapes(self) -> int:
        """How many shapes both rings have."""
        return self.rings.parity.size

    @property
    def given(self) -> list[tuple[Any, Array | None, bool]]:
        """What the compiled system takes of both."""
        return [
            (
                (ring.harmonics, _mass(ring), ring.stiffness, _damping(ring), ring.pushes),
                form,
                turns,
            )
            for ring, form, turns in zip(self.of_both, self.forms, self.turns, strict=True)
        ]

    def shift(self, psi: Array, deflection: Array) -> Array:
        """Return how far the outer raceway stands off its circle at the start [m], (..., Z), by all amplitudes."""
        outer = self.rings.outer.at(psi) @ deflection[self.rings.inner.stiffness.size :]
        return np.asarray(outer - self.rings.formed(2).form(psi))

    def energy(self, shapes: Array, speeds: Array) -> Array:
        """Return kinetic and elastic energy of the shapes less the work of what pushes on them [J], (...)."""
        found = np.zeros(np.shape(shapes)[:-1])
        for ring, at in zip(self.of_both, (0, self.rings.inner.stiffness.size), strict=True):
            q = shapes[..., at : at + ring.stiffness.size]
            v = speeds[..., at : at + ring.stiffness.size]
            found = (
                found + 0.5 * ((v * v) @ _mass(ring) + (q * q) @ ring.stiffness) - q @ ring.pushes
            )
        return found

    def square_frequency(self, contact: tuple[float, float], rollers: int) -> float:
        """Return what shapes add to the largest square of a frequency [1/s2] at most, by contacts' stiffnesses [N/m].

        The matrix of all stiffnesses over masses is positive, so that its largest eigenvalue is at most the sum of
        those of its blocks.
        """
        psi = 2.0 * np.pi * np.arange(rollers) / rollers
        found = 0.0
        for ring, stiffness in zip(self.of_both, contact, strict=True):
            if ring.stiffness.size:
                B = ring.at(psi)
                root = np.sqrt(_mass(ring))
                K = stiffness * B.T @ B + np.diag(ring.stiffness)
                found += float(np.linalg.eigvalsh(K / np.multiply.outer(root, root))[-1])
        return found


def bent_rings(a: Assembly, speeds: tuple[float, float] | None = None) -> BentRings | None:
    """Return the rings of a bearing, which turn at most at speeds [rad/s]; None where both are rigid and round.

    Raises
    ------
    DomainError
        A ring has no masses, a seat with clearance, or turns too fast through shapes of its own.
    """
    if a.rings is None:
        return None
    o = a.scene.operation
    of_inner, of_outer = speeds or (o.inner_speed, o.outer_speed)
    _refuse(RINGS[0], a.rings.inner, abs(of_inner))
    _refuse(RINGS[1], a.rings.outer, abs(of_outer))
    rings = turned(a.rings, 0.0)
    inner = _spline(rings.formed(1))
    outer = _spline(rings.formed(2))
    return BentRings(
        rings,
        (inner, outer),
        (inner is not None and of_inner != 0, outer is not None and of_outer != 0),
    )


def _refuse(ring: str, shapes: RingShapes, speed: float) -> None:
    if shapes.stops is not None:
        raise DomainError(
            f"plane motion knows no seat with clearance; leave out models.{ring}_ring.fit_clearance, or choose level "
            "'pocket'"
        )
    if shapes.stiffness.size and shapes.mass is None:
        raise DomainError(
            f"plane motion needs the masses of the shapes of models.{ring}_ring, and its model gives none; give 'mass' "
            "to 'compliance', take 'annulus' or 'thin', or choose level 'pocket'"
        )
    if not shapes.stiffness.size:
        return
    waves = np.array([np.flatnonzero(row).max(initial=0) for row in shapes.harmonics])
    fast = float((waves * speed / np.sqrt(shapes.stiffness / _mass(shapes))).max())
    if fast > _FASTEST:
        raise DomainError(
            f"the {ring} ring turns through its own shapes at {fast:.2g} of their natural frequency, and plane motion "
            f"has that up to {_FASTEST:g}; give models.{ring}_ring harmonics = 0, so that it widens but does not bend, "
            "or choose level 'pocket'"
        )


def _called(row: Any, number: int) -> str:
    """A shape by its wave, cos_2 or sin_3, or by its number where it has several."""
    waves = np.flatnonzero(row)
    if waves.size != 1 or row[waves[0]] not in (
        1.0,
        -1.0j,
        1.0j,
    ):  # of the mirror image a sine has another sign
        return f"shape_{number}"
    return f"{'cos' if row[waves[0]] == 1.0 else 'sin'}_{waves[0]}"


def _mass(ring: RingShapes) -> Array:
    return np.zeros(0) if ring.mass is None else ring.mass


def _damping(ring: RingShapes) -> Array:
    """Damping of each shape [N s/m]."""
    return 2.0 * ring.damping_ratio * np.sqrt(ring.stiffness * _mass(ring))


def _spline(rings: Rings) -> Array | None:
    from scipy.interpolate import CubicSpline  # only a form needs it

    if not (rings.waves or rings.tables):
        return None
    most = max((_PER_LOBE * lobes for lobes, _, _ in rings.waves), default=0)
    most = max([most, *(_PER_ROW * angles.size for angles, _ in rings.tables)])
    cells = min(max(most, _LEAST), _MOST)
    nodes = np.arange(cells + 1, dtype=float)
    heights = rings.form(2.0 * math.pi / cells * nodes)
    heights[-1] = heights[0]
    return np.ascontiguousarray(CubicSpline(nodes, heights, bc_type="periodic").c[::-1].T)
