"""What carries an axial load: ribs of cylindrical bearings, and the angles of tapered ones.

Tapered rollers: axis of the bearing z, radius R. The axis of a roller is inclined by the middle angle, that of both
raceways by the half angle of the roller less and more::

    inner = middle - half      outer = middle + half

Cones with a common apex roll on each other without sliding. With radius r of the roller and R_m of the pitch circle,
both at the middle of the roller, its apex lies R_m / sin(middle) away along its axis, so that tan(half) =
(r / R_m) sin(middle).

References: T. A. Harris, M. N. Kotzalas, Essential Concepts of Bearing Technology.
"""

import math
from typing import Final, Self

import attrs

from rollslip.fields import field, positive, refuse_if

__all__ = ["CYLINDRICAL", "RIB_ANGLE", "RIB_HEIGHT", "ContactAngles", "Ribs", "raceway_diameters"]

#: Angle by which ribs are open [rad] where none is stated (D). Half and twice the value change the slip of an NJ 2312
#: under 1.5 kN and 0.3 kN of axial load, with films on its ribs, by 4 and 2 % of it.
RIB_ANGLE: Final = math.radians(0.5)
#: Height of the contacts with ribs over the diameter of the rollers (D): with it the friction torque of SKF's term for
#: axial load is met in an NJ 2312. Heights of 0.08 and 0.13 change that slip by 11 and 18 % of it.
RIB_HEIGHT: Final = 0.10


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


@attrs.frozen(kw_only=True)
class Ribs:
    """Ribs on opposite sides of both rings, between which rollers carry an axial load: types NJ and NUP."""

    height: float = field(
        unit="m",
        doc="height of the contacts of the rollers' ends above the raceways",
        validator=positive,
        usual=(2e-4, 1e-2),
        possible=(1e-6, 1),
    )
    opening_angle: float | None = field(
        default=None,
        unit="rad",
        doc="angle by which a rib is open, so that rollers touch it at one point; by default 0.5 deg (D)",
        validator=attrs.validators.optional(positive),
        usual=(1.7e-3, 3.5e-2),
        possible=(1e-5, 0.2),
    )
    end_radius: float | None = field(
        default=None,
        unit="m",
        doc="radius of the rollers' ends where they touch, in place of the angle",
        validator=attrs.validators.optional(positive),
        usual=(0.05, 20),
        possible=(1e-4, 1e4),
    )

    def __attrs_post_init__(self) -> None:
        refuse_if(
            self.opening_angle is not None and self.end_radius is not None,
            "end_radius",
            "opening_angle says the same; leave one of them out",
        )

    @property
    def angle(self) -> float:
        """Angle by which a rib is open [rad]."""
        return RIB_ANGLE if self.opening_angle is None else self.opening_angle
