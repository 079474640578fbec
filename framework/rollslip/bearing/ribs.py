"""Ribs that carry an axial load: the pair of contacts of a roller, and their speeds.

An inner and an outer rib, on opposite sides of a roller, carry the same axial force Q of the roller, and push it by a
couple. Its axial displacement drops out: in series both ribs are one contact of Hertz, a sphere on a plane each. Its
approach is ``s = z - 2 rho phi``, with the axial displacement z of the inner ring, the tilt phi of the roller, and the
distance rho of the contacts from the roller's axis. `rollslip.bearing.equilibrium` has the equilibrium.
"""

import math

import attrs
import numpy as np

from rollslip.bearing.kinematics import Kinematics
from rollslip.search import Array

__all__ = ["RibPair"]


@attrs.frozen
class RibPair:
    """The contacts of a roller with the ribs of both rings."""

    #: Height h of the contacts above the raceways [m].
    height: float
    #: Radius R_s of the roller's ends where they touch [m].
    end_radius: float
    #: Distance rho of the contacts from the roller's axis [m].
    spin_radius: float
    #: Distances of the contacts from the axis of the bearing [m], inner and outer rib.
    ring_radii: tuple[float, float]
    #: Equivalent moduli E' of a roller and either ring [Pa].
    moduli: tuple[float, float]

    @property
    def compliance(self) -> float:
        """Approach of both ribs of a roller over the force to the power 2/3 [m/N^(2/3)].

        A sphere of the radius R_s on a plane has the force Q = (2/3) E' sqrt(R_s) a^(3/2) at an approach a (Hertz).
        """
        return math.fsum(
            (2.0 / 3.0 * modulus * math.sqrt(self.end_radius)) ** (-2.0 / 3.0)
            for modulus in self.moduli
        )

    def contact_radius(self, force: Array, ring: int) -> Array:
        """Return the radius of the contact circle with the rib of a ring at normal forces [m].

        Parameters
        ----------
        force : ndarray
            Normal forces [N].
        ring : int
            0 for the inner ring, 1 for the outer one.
        """
        return np.asarray(np.cbrt(1.5 * force * self.end_radius / self.moduli[ring]))

    def leads(self, kinematics: Kinematics, cage_slips: Array) -> tuple[Array, Array]:
        """Return the sliding speeds of both ribs without roller slip [m/s], (n,) each.

        They are those of the raceways and h [(w_i - w_c) + w_r] on the inner rib, h [(w_c - w_o) - w_r] on the outer
        one, positive where the rib pushes the roller forward along its orbit.

        Parameters
        ----------
        kinematics : Kinematics
            Of the bearing.
        cage_slips : ndarray
            Cage slips, (n,).
        """
        k = kinematics
        inner, outer = k.leads(cage_slips)
        cage = k.epicyclic_cage_speed * (1.0 - cage_slips)
        spin = k.epicyclic_roller_speed
        return (
            inner + self.height * (k.direction * k.inner_speed - cage + spin),
            outer + self.height * (cage - k.direction * k.outer_speed - spin),
        )
