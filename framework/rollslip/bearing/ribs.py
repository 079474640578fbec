"""Ribs that carry an axial load: the pair of contacts of a roller, and their speeds.

An inner and an outer rib, on opposite sides of a roller, carry the same axial force Q of the roller, and push it by a
couple. Its axial displacement drops out: in series both ribs are one contact of Hertz, a sphere on a plane each. Its
approach is ``s = z - 2 rho phi``, with the axial displacement z of the inner ring, the tilt phi of the roller, and the
distance rho of the contacts from the roller's axis. `rollslip.bearing.equilibrium` has the equilibrium.
"""

import math
from typing import Final

import attrs
import numpy as np

from rollslip.bearing.kinematics import Kinematics
from rollslip.geometry.axial import RIB_HEIGHT
from rollslip.geometry.bearing import Bearing
from rollslip.search import Array

__all__ = ["RibPair", "tapered_rib"]

#: Radius of the ends of tapered rollers over the distance from their large end to the apex (D): less than 1, so that
#: ends touch the rib inside of its edges. Friction of the film goes with the logarithm of it.
_END_RADIUS: Final = 0.9


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
    #: Speeds at the contacts over those at the radii above, and friction at these over that of the contacts [1].
    scale: float = 1.0
    #: Whether the inner and the outer ring have such a rib.
    sides: tuple[bool, bool] = (True, True)
    #: Height of the contacts above the raceway, as far as which oil beside them is sheared [m].
    contact_height: float = attrs.field(
        default=attrs.Factory(lambda pair: pair.height, takes_self=True)
    )

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


def tapered_rib(bearing: Bearing, kinematics: Kinematics, moduli: tuple[float, float]) -> RibPair:
    """Return the rib of the inner ring at the large end of tapered rollers.

    The contact is at the height h above the raceway there, at the distances rho = r + l/2 sin(half) - h from the axis
    of the roller and R = R_i + l/2 sin(inner) + h cos(middle) from that of the bearing. A friction c F at the distances
    rho/c and R/c has the torques and the power of F at rho and R; c = (R + rho)/(R_i + r) makes these the distances of
    a rib of the height r - rho/c above the middle of the raceway, as cylindrical rollers have it.

    Parameters
    ----------
    bearing : Bearing
        The tapered bearing. Without `ribs` the height is that of cylindrical rollers and the radius of the ends 0.9 of
        the distance to the apex.
    kinematics : Kinematics
        Of the bearing.
    moduli : tuple of float
        Equivalent moduli E' of a roller and inner and outer ring [Pa].
    """
    angles = bearing.angles
    ribs = bearing.ribs
    half_length = 0.5 * bearing.roller_length
    height = RIB_HEIGHT * bearing.roller_diameter if ribs is None else ribs.height
    large = kinematics.roller_radius + half_length * math.sin(angles.half)
    end_radius = None if ribs is None else ribs.end_radius
    if end_radius is None:
        end_radius = _END_RADIUS * large / math.sin(angles.half)
    spin_radius = large - height
    ring_radius = (
        kinematics.inner_radius
        + half_length * math.sin(angles.inner)
        + height * math.cos(angles.middle)
    )
    scale = (ring_radius + spin_radius) / (kinematics.inner_radius + kinematics.roller_radius)
    shift = kinematics.roller_radius - spin_radius / scale
    return RibPair(
        shift,
        end_radius,
        spin_radius / scale,
        (ring_radius / scale, kinematics.outer_radius - shift),
        moduli,
        scale,
        (True, False),
        height,
    )
