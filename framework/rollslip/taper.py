"""Geometry of tapered rollers: contact angles, the half angle of a roller, raceways at the middle of the rollers.

Axis of the bearing z, radius R. The axis of a roller is inclined by the middle angle, that of both raceways by the half
angle of the roller less and more::

    inner = middle - half      outer = middle + half

Cones with a common apex roll on each other without sliding. With radius r of the roller and R_m of the pitch circle,
both at the middle of the roller, its apex lies R_m / sin(middle) away along its axis, so that tan(half) =
(r / R_m) sin(middle).

References: T. A. Harris, M. N. Kotzalas, Essential Concepts of Bearing Technology.
"""

import math
from typing import Final, Self

import attrs

__all__ = ["CYLINDRICAL", "ContactAngles", "raceway_diameters"]


@attrs.frozen
class ContactAngles:
    """Angles of the contacts of tapered rollers; both are zero for cylindrical rollers."""

    outer: float  #: Contact angle of the outer raceway [rad], that of catalogues.
    half: float  #: Angle between axis and surface of a roller [rad].

    @classmethod
    def with_common_apex(cls, outer: float, ratio: float) -> Self:
        """Return the angles of cones with a common apex.

        Parameters
        ----------
        outer : float
            Contact angle of the outer raceway [rad].
        ratio : float
            Diameter of a roller over the pitch diameter [1], less than 1.
        """
        half = 0.0
        before = math.nan
        # the map contracts by about the ratio, down to the rounding, where two values may alternate
        for _ in range(200):
            if half == before:
                break
            before = half
            half = math.atan(ratio * math.sin(outer - half))
        return cls(outer, half)

    @property
    def middle(self) -> float:
        """Angle of the axis of a roller to that of the bearing [rad]."""
        return self.outer - self.half

    @property
    def inner(self) -> float:
        """Contact angle of the inner raceway [rad]."""
        return self.outer - 2.0 * self.half

    @property
    def cosines(self) -> tuple[float, float, float]:
        """Cosines of the half angle of a roller and of the contact angles of inner and outer raceway [1]."""
        return math.cos(self.half), math.cos(self.inner), math.cos(self.outer)


#: Angles of cylindrical rollers.
CYLINDRICAL: Final = ContactAngles(0.0, 0.0)


def raceway_diameters(pitch: float, diameter: float, angles: ContactAngles) -> tuple[float, float]:
    """Return the diameters of inner and outer raceway at the middle of the rollers, d_m -+ D cos(middle) [m].

    Parameters
    ----------
    pitch : float
        Pitch diameter d_m [m].
    diameter : float
        Diameter D of a roller at its middle [m].
    angles : ContactAngles
        Angles of the contacts.
    """
    across = diameter * math.cos(angles.middle)
    return pitch - across, pitch + across
