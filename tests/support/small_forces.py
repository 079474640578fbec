"""Stiffness of a bearing by small forces on its ring, for which equilibria are solved anew: no Jacobian is asked."""

import attrs
import numpy as np

from rollslip.bearing.equilibrium import solve_equilibrium


def by_differences(assembly, speed, n_positions):
    """Inverse of what the ring yields to forces along and across its load, which turn the load a little."""
    case = attrs.evolve(
        assembly.load_case(n_positions), centrifugal_force=assembly.centrifugal_force_at(speed)
    )
    F = case.radial_load

    def displaced(along, across):
        angle = np.arctan2(across, F + along)
        turned = attrs.evolve(case, radial_load=np.hypot(F + along, across), psi=case.psi - angle)
        x, y = solve_equilibrium(turned, assembly.raceways).displacement.T
        return np.array(
            [x * np.cos(angle) - y * np.sin(angle), x * np.sin(angle) + y * np.cos(angle)]
        )

    step = 1e-4 * F
    yields = [(displaced(*(step * e)) - displaced(*(-step * e))) / (2.0 * step) for e in np.eye(2)]
    return np.linalg.inv(np.moveaxis(np.array(yields), -1, 0)).mean(axis=0)
