"""Stiffness of a bearing against small displacements of its inner ring, from the Jacobian of its equilibrium.

- A roller between rigid rings is two springs in series: force and moment of a contact change by K_i or K_o times its
  approach and tilt (dr, dphi), sums over slices of w dQ/dr (1, x, x^2). The roller itself moves by (K_i + K_o)^-1 K_i
  e, where the ring moves by e = (1, 0), and what is left to the ring is k = e K_i (e - (K_i + K_o)^-1 K_i e).
- The ring has K = sum of k (cos^2, cos sin; cos sin, sin^2) over its loaded rollers, along the load and across it, mean
  over the instants of a roller pitch. Centrifugal forces are held: they go with the cage's speed alone.
"""

import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import RINGS, Array

__all__ = ["N_POSITIONS", "stiffness"]

#: Instants of a roller pitch.
N_POSITIONS = 8


def stiffness(
    assembly: Assembly, cage_speed: float | None = None, n_positions: int = N_POSITIONS
) -> Array:
    """Return the stiffness [N/m], (2, 2), along and across the load of the scene; NaN where rings yield.

    The cage's speed [rad/s] is by default the epicyclic one.
    """
    case = assembly.load_case(n_positions)
    if case.rings is not None:
        return np.full((2, 2), np.nan)
    found = assembly.load_distribution(n_positions, cage_speed)
    x = found.position
    psi = found.psi[..., None]
    ring = found.displacement[:, None, None]
    tilt = found.roller_tilt[..., None] * x
    outer = found.roller_shift[..., None] + tilt - assembly.drop
    inner = ring[..., 0] * np.cos(psi) + ring[..., 1] * np.sin(psi) - 0.5 * case.radial_clearance
    inner = inner + case.misalignment * x * np.cos(psi) - outer - 2.0 * assembly.drop
    springs = []
    for name, approach, load in zip(
        RINGS, (inner, outer), (found.inner_load, found.outer_load), strict=True
    ):
        each = np.where(load > 0.0, assembly.deflect(approach, name)[1], 0.0) * assembly.widths
        springs.append(
            np.moveaxis(
                np.array([[each.sum(-1), each @ x], [each @ x, each @ x**2]]), (0, 1), (-2, -1)
            )
        )
    pressed = found.inner_force > 0.0
    Ki, Ko = (of[pressed] for of in springs)
    follows = np.linalg.solve(_held(Ki + Ko), Ki[..., :1])
    k = np.zeros(found.inner_force.shape)
    k[pressed] = Ki[:, 0, 0] - (Ki[:, :1] @ follows)[:, 0, 0]
    c = np.cos(found.psi)
    s = np.sin(found.psi)
    return np.asarray(
        np.array([[k * c * c, k * c * s], [k * c * s, k * s * s]]).sum(axis=-1).mean(axis=-1)
    )


def _held(K: Array) -> Array:
    """Return springs of which one slice alone, that tells of no tilt, does not leave it free."""
    turned = np.zeros((2, 2))
    turned[1, 1] = 1.0
    return np.asarray(K + turned * (K[:, 1, 1] == 0.0)[:, None, None] * K[:, :1, :1])
