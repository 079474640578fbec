"""Stiffness of a bearing against small displacements of its inner ring: the Jacobian of its static equilibrium.

- A roller between rigid rings is two springs in series. Force and moment of a contact change by K_i or K_o times its
  approach and tilt (dr, dphi), where K is a sum over slices of w dQ/dr (1, x; x, x^2). If the ring moves by
  e = (1, 0), the roller moves by (K_i + K_o)^-1 K_i e, and the stiffness of the pair is
  k = e K_i (e - (K_i + K_o)^-1 K_i e).
- The ring has K = sum of k (cos^2, cos sin; cos sin, sin^2) over its loaded rollers, along the load and across it,
  averaged over the roller positions within one pitch. Centrifugal forces are constant, because they depend on the speed
  of the cage only.
"""

import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import RINGS, Array

__all__ = ["N_POSITIONS", "stiffness"]

#: Roller positions within one pitch. Stiffness varies over a pitch, because rollers enter and leave the load zone;
#: doubling it doubles the time. Chosen; test_surrogate_stiffness compares the mean with differences of small forces.
N_POSITIONS = 8


def stiffness(
    assembly: Assembly, cage_speed: float | None = None, n_positions: int = N_POSITIONS
) -> Array:
    """Return the stiffness of the inner ring [N/m], (2, 2): along the load of the scene and across it.

    Parameters
    ----------
    assembly : Assembly
        Bearing, at its operation.
    cage_speed : float, optional
        Speed of the cage [rad/s], on which centrifugal forces depend; by default the epicyclic one.
    n_positions : int
        Roller positions within one pitch over which the stiffness is averaged.

    Returns
    -------
    array
        Stiffness; NaN where rings are flexible, and under axial load, which ribs or inclined contacts bear.
    """
    case = assembly.load_case(n_positions)
    if case.rings is not None or case.axial_load:
        return np.full((2, 2), np.nan)
    loads = assembly.load_distribution(n_positions, cage_speed)
    x = loads.position
    psi = loads.psi[..., None]
    ring = loads.displacement[:, None, None]
    tilt = loads.roller_tilt[..., None] * x
    outer = loads.roller_shift[..., None] + tilt - assembly.drop
    inner = ring[..., 0] * np.cos(psi) + ring[..., 1] * np.sin(psi) - 0.5 * case.radial_clearance
    inner = inner + case.misalignment * x * np.cos(psi) - outer - 2.0 * assembly.drop
    springs = []
    for name, approach, load in zip(
        RINGS, (inner, outer), (loads.inner_load, loads.outer_load), strict=True
    ):
        spring = np.where(load > 0.0, assembly.deflect(approach, name)[1], 0.0) * assembly.widths
        springs.append(
            np.moveaxis(
                np.array([[spring.sum(-1), spring @ x], [spring @ x, spring @ x**2]]),
                (0, 1),
                (-2, -1),
            )
        )
    pressed = loads.inner_force > 0.0
    Ki, Ko = (matrix[pressed] for matrix in springs)
    K = Ki + Ko
    # one slice alone at the centre has no stiffness against tilt
    K = K + np.diag([0.0, 1.0]) * (K[:, 1, 1] == 0.0)[:, None, None] * K[:, :1, :1]
    motion = np.linalg.solve(K, Ki[..., :1])
    k = np.zeros(loads.inner_force.shape)
    k[pressed] = Ki[:, 0, 0] - (Ki[:, :1] @ motion)[:, 0, 0]
    c = np.cos(loads.psi)
    s = np.sin(loads.psi)
    return np.asarray(
        np.array([[k * c * c, k * c * s], [k * c * s, k * s * s]]).sum(axis=-1).mean(axis=-1)
    )
