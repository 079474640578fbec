"""Flexible rings and raceways out of round in plane motion, as the compiled system takes them.

- The shapes of a ring become generalised coordinates of the motion, with the stiffness and the forces that they have in
  the equilibrium, their masses and their damping. Without speeds and damping the motion is the equilibrium.
- Shapes are fixed in the frame of the outer ring. For a ring that turns through them this is right up to (n w/w_n)^2,
  by which the inertia of the passing material softens a shape of n waves and natural frequency w_n; a hoop, n = 0, is
  not affected. A ring that turns faster than a tenth of the frequency is refused.
- A form is a periodic cubic spline, so that the corners of a table are rounded over a cell. The form of a ring that
  turns, at some time of a history, turns with it: its angle is a coordinate whose rate is the speed of the ring.
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

#: Largest frequency of the waves in which a turning ring passes through a shape, relative to the natural frequency.
#: Doubling it allows an error of 4 % of the stiffness of a shape instead of 1 %.
_MAX_FREQUENCY_RATIO: Final = 0.1
#: Number of spline cells for a lobe of a form: its error is 1e-7 of the amplitude; doubling it divides that by 16.
_CELLS_PER_LOBE = 128
#: Number of spline cells for a row of a table of a form: corners are rounded over an eighth of the distance of rows.
#: Doubling it halves that. Chosen.
_CELLS_PER_ROW = 8
#: Minimum number of spline cells of a form. Chosen: 8 kB.
_MIN_CELLS = 256
#: Maximum number of spline cells of a form. It bounds the memory at 2 MB; tables with more rows are smoothed. Chosen.
_MAX_CELLS = 65536


def rotated(rings: Rings, angle: float) -> Rings:
    """Return rings in a frame that is rotated by an angle, with forms as they are at the start.

    Parameters
    ----------
    rings : Rings
        Shapes and forms of both rings.
    angle : float
        Angle of the frame [rad].
    """

    def rotated_shapes(ring: RingShapes) -> RingShapes:
        return attrs.evolve(
            ring, harmonics=ring.harmonics * np.exp(1j * angle * np.arange(ring.harmonics.shape[1]))
        )

    waves = tuple((lobes, amplitude, phase - angle) for lobes, amplitude, phase in rings.waves)
    tables = tuple((angles - angle, heights) for angles, heights in rings.tables)
    at_rest = tuple((0, ring) for _, ring in rings.turns)
    return Rings(
        rotated_shapes(rings.inner), rotated_shapes(rings.outer), waves, tables, turns=at_rest
    )


@attrs.frozen(eq=False)
class BentRings:
    """Rings of a bearing in plane motion that are flexible or out of round, in the sense of positive speeds."""

    rings: Rings  # shapes of both rings, with forms as they are at the start
    #: Form of each raceway: coefficients of cubics on equal cells of the angle, (cells, 4); None without a form.
    forms: tuple[Array | None, Array | None]
    turns: tuple[bool, bool]  # whether the form turns with its ring

    @property
    def ring_shapes(self) -> tuple[RingShapes, RingShapes]:
        """Shapes of inner and outer ring."""
        return self.rings.inner, self.rings.outer

    @property
    def names(self) -> Mapping[str, str]:
        """Unknowns in the head -> their unit: amplitudes of shapes, inner ring first, their rates, angles of forms."""
        shapes = [
            f"{ring}_ring_{_shape_name(row, k)}"
            for ring, shapes_of_ring in zip(RINGS, self.ring_shapes, strict=True)
            for k, row in enumerate(shapes_of_ring.harmonics)
        ]
        return (
            dict.fromkeys(shapes, "m")
            | dict.fromkeys([f"{name}_speed" for name in shapes], "m/s")
            | dict.fromkeys([f"{ring}_form_angle" for ring in compress(RINGS, self.turns)], "rad")
        )

    @property
    def shapes(self) -> int:
        """Number of shapes of both rings."""
        return self.rings.parity.size

    @property
    def system_arguments(self) -> list[tuple[Any, Array | None, bool]]:
        """Shapes, form, and whether the form turns, of both rings, as the compiled system takes them."""
        return [
            (
                (ring.harmonics, _mass(ring), ring.stiffness, _damping(ring), ring.pushes),
                form,
                turns,
            )
            for ring, form, turns in zip(self.ring_shapes, self.forms, self.turns, strict=True)
        ]

    def shift(self, psi: Array, deflection: Array) -> Array:
        """Return the radial displacement of the outer raceway from its circle at the start [m], (..., Z).

        Parameters
        ----------
        psi : ndarray, shape (..., Z)
            Angles of the rollers [rad].
        deflection : ndarray, shape (shapes,)
            Amplitudes of the shapes of both rings [m].
        """
        return np.asarray(
            self.rings.outer.at(psi) @ deflection[self.rings.inner.stiffness.size :]
            - self.rings.with_single_form(2).form(psi)
        )

    def energy(self, shapes: Array, speeds: Array) -> Array:
        """Return kinetic and elastic energy of the shapes minus the work of the forces on them [J], (...).

        Parameters
        ----------
        shapes, speeds : ndarray, shape (..., shapes)
            Amplitudes of the shapes of both rings [m] and their rates [m/s].
        """
        energy = np.zeros(np.shape(shapes)[:-1])
        for ring, start in zip(self.ring_shapes, (0, self.rings.inner.stiffness.size), strict=True):
            q = shapes[..., start : start + ring.stiffness.size]
            v = speeds[..., start : start + ring.stiffness.size]
            energy = (
                energy + 0.5 * ((v * v) @ _mass(ring) + (q * q) @ ring.stiffness) - q @ ring.pushes
            )
        return energy

    def square_frequency(self, contact: tuple[float, float], rollers: int) -> float:
        """Return an upper bound of the contribution of the shapes to the largest squared natural frequency [1/s2].

        The matrix of stiffnesses over masses is positive definite, so that its largest eigenvalue is at most the sum of
        those of its blocks.

        Parameters
        ----------
        contact : tuple of two floats
            Stiffness of a contact on inner and outer ring [N/m].
        rollers : int
            Number of rollers.
        """
        psi = 2.0 * np.pi * np.arange(rollers) / rollers
        bound = 0.0
        for ring, stiffness in zip(self.ring_shapes, contact, strict=True):
            if ring.stiffness.size:
                B = ring.at(psi)
                root = np.sqrt(_mass(ring))
                K = stiffness * B.T @ B + np.diag(ring.stiffness)
                bound += float(np.linalg.eigvalsh(K / np.multiply.outer(root, root))[-1])
        return bound


def bent_rings(assembly: Assembly, speeds: tuple[float, float] | None = None) -> BentRings | None:
    """Return the rings of a bearing; None where both are rigid and round.

    Parameters
    ----------
    assembly : Assembly
        The bearing.
    speeds : tuple of two floats, optional
        Largest speeds of inner and outer ring [rad/s]; by default those of the scene.

    Raises
    ------
    DomainError
        If a ring has no masses, a seat with clearance, or turns too fast through its shapes.
    """
    if assembly.rings is None:
        return None
    operation = assembly.scene.operation
    inner_speed, outer_speed = speeds or (operation.inner_speed, operation.outer_speed)
    _check_ring(RINGS[0], assembly.rings.inner, abs(inner_speed))
    _check_ring(RINGS[1], assembly.rings.outer, abs(outer_speed))
    rings = rotated(assembly.rings, 0.0)
    inner = _spline(rings.with_single_form(1))
    outer = _spline(rings.with_single_form(2))
    return BentRings(
        rings,
        (inner, outer),
        (inner is not None and inner_speed != 0, outer is not None and outer_speed != 0),
    )


def _check_ring(ring: str, shapes: RingShapes, speed: float) -> None:
    """Refuse shapes that plane motion does not describe at a speed [rad/s]."""
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
    ratio = float((waves * speed / np.sqrt(shapes.stiffness / _mass(shapes))).max())
    if ratio > _MAX_FREQUENCY_RATIO:
        raise DomainError(
            f"the {ring} ring turns through its own shapes at {ratio:.2g} of their natural frequency, and plane motion "
            f"has that up to {_MAX_FREQUENCY_RATIO:g}; give models.{ring}_ring harmonics = 0, so that it widens "
            "but does not bend, or choose level 'pocket'"
        )


def _shape_name(row: Any, number: int) -> str:
    """Return the name of a shape: cos_2 or sin_3 by its wave, or its number where it has several waves."""
    waves = np.flatnonzero(row)
    # a sine has the opposite sign in the mirror image
    if waves.size != 1 or row[waves[0]] not in (1.0, -1.0j, 1.0j):
        return f"shape_{number}"
    return f"{'cos' if row[waves[0]] == 1.0 else 'sin'}_{waves[0]}"


def _mass(ring: RingShapes) -> Array:
    """Return the mass of each shape [kg]; none without shapes."""
    return np.zeros(0) if ring.mass is None else ring.mass


def _damping(ring: RingShapes) -> Array:
    """Return the damping of each shape [N s/m]."""
    return 2.0 * ring.damping_ratio * np.sqrt(ring.stiffness * _mass(ring))


def _spline(rings: Rings) -> Array | None:
    """Return the form of a raceway as cubics on equal cells of the angle, (cells, 4) [m]; None without a form."""
    from scipy.interpolate import CubicSpline

    if not (rings.waves or rings.tables):
        return None
    required = [
        *(_CELLS_PER_LOBE * lobes for lobes, _, _ in rings.waves),
        *(_CELLS_PER_ROW * angles.size for angles, _ in rings.tables),
    ]
    cells = min(max(_MIN_CELLS, *required), _MAX_CELLS)
    nodes = np.arange(cells + 1, dtype=float)
    heights = rings.form(2.0 * math.pi / cells * nodes)
    heights[-1] = heights[0]
    return np.ascontiguousarray(CubicSpline(nodes, heights, bc_type="periodic").c[::-1].T)
