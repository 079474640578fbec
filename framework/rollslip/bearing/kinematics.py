"""Kinematics of a roller bearing: sliding and rolling speeds of its contacts at given slips.

Tapered rollers whose cones have a common apex roll as cylindrical ones of the radii at their middle: the radius of a
raceway over that of the roller is the same all along it.
"""

import math
from functools import cached_property

import attrs
import numpy as np
from attrs.validators import and_, gt, lt
from numpy.typing import ArrayLike

from rollslip.errors import DomainError
from rollslip.search import Array
from rollslip.units import format_quantity


@attrs.frozen(eq=False)
class SurfaceSpeeds:
    """Sliding and rolling speeds of both contacts; arrays of one shape, that of the slips they belong to."""

    inner_sliding: Array  #: Sliding speed [m/s], positive where the contact pushes the roller forward along its orbit.
    inner_rolling: Array  #: Entrainment speed, the mean of the two surfaces' speeds [m/s].
    outer_sliding: Array
    outer_rolling: Array
    cage_speed: Array  #: Angular speed of the cage [rad/s].
    roller_speed: Array  #: Spin of the roller relative to the cage [rad/s].


_length = and_(gt(0.0), lt(math.inf))
_speed = and_(gt(-math.inf), lt(math.inf))


@attrs.frozen
class Kinematics:
    """Kinematics of a cylindrical or tapered roller bearing whose rings turn at constant speeds.

    Both contacts roll without sliding at the epicyclic speeds (Harris & Kotzalas)::

        w_ce = (R_i w_i + R_o w_o) / (R_i + R_o)
        r w_re = R_i (w_i - w_ce) = R_o (w_ce - w_o) = R_i R_o (w_i - w_o) / (R_i + R_o)

    This holds at any clearance: R_o - R_i need not equal 2 r. Slips are relative to these speeds: cage slip
    S_c = 1 - w_c / w_ce, roller slip S_r = 1 - w_r / w_re, with w_r the spin relative to the cage.

    A bearing in which w_i < w_o would have negative rolling speeds. It is described by its mirror image, in which both
    rings turn the other way (w_i and w_o negated), so that rolling speeds are positive; slips are the same in both.
    The fields keep the speeds as given; every speed that is returned is the mirror image's, and `direction` = -1
    times it the real one.

    Examples
    --------
    >>> bearing = Kinematics(0.0825, 0.0975, 0.0075, inner_speed=667.2, outer_speed=0.0)
    >>> round(bearing.epicyclic_cage_speed, 2)
    305.8
    """

    inner_radius: float = attrs.field(validator=_length)  #: Raceway radius R_i [m].
    outer_radius: float = attrs.field(validator=_length)  #: Raceway radius R_o [m].
    roller_radius: float = attrs.field(validator=_length)  #: Roller radius r [m].
    inner_speed: float = attrs.field(validator=_speed)  #: Angular speed of the ring w_i [rad/s].
    outer_speed: float = attrs.field(validator=_speed)  #: Angular speed of the ring w_o [rad/s].
    #: Cosines of the half angle of a roller and of the contact angles of inner and outer raceway [1]: curvatures of
    #: cones over those of cylinders. Radii of tapered rollers and their raceways are those at their middle.
    cosines: tuple[float, float, float] = (1.0, 1.0, 1.0)

    def __attrs_post_init__(self) -> None:
        if self.outer_radius <= max(self.inner_radius, self.roller_radius):
            raise ValueError(
                f"the outer raceway's radius is {format_quantity(self.outer_radius, 'm')}: it must exceed that of the "
                f"inner raceway, {format_quantity(self.inner_radius, 'm')}, and of the roller, "
                f"{format_quantity(self.roller_radius, 'm')}"
            )
        if self.inner_speed == self.outer_speed:
            raise DomainError(
                f"nothing rolls: both rings turn at {format_quantity(self.inner_speed, 'rad/s')}"
            )

    @property
    def direction(self) -> int:
        """1 for the bearing as given, -1 if its mirror image is described."""
        return 1 if self.inner_speed > self.outer_speed else -1

    @cached_property
    def epicyclic_cage_speed(self) -> float:
        """Cage speed w_ce at which both contacts can roll without sliding [rad/s]."""
        return (
            self.direction
            * (self.inner_radius * self.inner_speed + self.outer_radius * self.outer_speed)
            / (self.inner_radius + self.outer_radius)
        )

    @cached_property
    def epicyclic_roller_speed(self) -> float:
        """Spin w_re of the roller relative to the cage at which both contacts roll without sliding [rad/s]."""
        return (
            self.inner_radius
            * self.outer_radius
            / (self.inner_radius + self.outer_radius)
            * abs(self.inner_speed - self.outer_speed)
            / self.roller_radius
        )

    @cached_property
    def inner_equivalent_radius(self) -> float:
        """Equivalent radius of roller and inner raceway, 1/R = cos(half)/r + cos(inner)/R_i [m]."""
        return 1.0 / (self.cosines[0] / self.roller_radius + self.cosines[1] / self.inner_radius)

    @cached_property
    def outer_equivalent_radius(self) -> float:
        """Equivalent radius of roller and outer raceway, 1/R = cos(half)/r - cos(outer)/R_o [m]."""
        return 1.0 / (self.cosines[0] / self.roller_radius - self.cosines[2] / self.outer_radius)

    @cached_property
    def orbit_radius(self) -> float:
        """Radius of the rollers' orbit, R_m = (R_i + R_o) / 2 [m]."""
        return 0.5 * (self.inner_radius + self.outer_radius)

    def surface_speeds(self, cage_slip: ArrayLike, roller_slip: ArrayLike) -> SurfaceSpeeds:
        """Sliding and rolling speeds of both contacts at given slips.

        With w_c, w_r the speeds of cage and roller::

            V_i = R_i (w_i - w_c) - r w_r      u_i = [R_i (w_i - w_c) + r w_r] / 2
            V_o = r w_r - R_o (w_c - w_o)      u_o = [R_o (w_c - w_o) + r w_r] / 2

        evaluated in the slips, so that sliding speeds vanish exactly with them. V_i + V_o = (R_i + R_o)(w_ce - w_c).

        Parameters
        ----------
        cage_slip, roller_slip : array_like
            Slips S_c and S_r [1], which broadcast to one shape.

        Raises
        ------
        DomainError
            If there is a cage slip although the epicyclic cage speed is zero, with rings that counter-rotate.
        """
        Sc = np.asarray(cage_slip, dtype=float)
        Sr = np.asarray(roller_slip, dtype=float)
        if Sc.shape != Sr.shape:
            Sc, Sr = np.broadcast_arrays(Sc, Sr)
        u = self.roller_radius * self.epicyclic_roller_speed
        cage_lag = self._lag(Sc)
        inner = self.inner_radius * cage_lag
        outer = self.outer_radius * cage_lag
        spin = u * Sr
        return SurfaceSpeeds(
            inner_sliding=inner + spin,
            inner_rolling=u + 0.5 * (inner - spin),
            outer_sliding=outer - spin,
            outer_rolling=u - 0.5 * (outer + spin),
            cage_speed=self.epicyclic_cage_speed - cage_lag,
            roller_speed=self.epicyclic_roller_speed * (1.0 - Sr),
        )

    def leads(self, cage_slip: ArrayLike) -> tuple[Array, Array]:
        """Sliding speeds V_i and V_o without roller slip [m/s], as `surface_speeds` has them."""
        lag = self._lag(np.asarray(cage_slip, dtype=float))
        return self.inner_radius * lag, self.outer_radius * lag

    def _lag(self, cage_slip: Array) -> Array:
        """Return the difference of the epicyclic and the actual cage speed [rad/s]; 0 without slip at any speed."""
        return self._slip_reference() * cage_slip if np.any(cage_slip) else np.zeros_like(cage_slip)

    def roller_slip_outer_rolling(self, cage_slip: ArrayLike) -> Array:
        """Roller slip at which the outer contact rolls without sliding, V_o = 0: S_r = R_o w_ce S_c / (r w_re)."""
        return (
            self.outer_radius
            * self._slip_reference()
            / (self.roller_radius * self.epicyclic_roller_speed)
            * np.asarray(cage_slip, dtype=float)
        )

    def _slip_reference(self) -> float:
        """Return the epicyclic cage speed [rad/s]; raise where it is zero but for rounding."""
        speed = self.epicyclic_cage_speed
        # bound of the rounding error of the sum: a smaller speed has no significant digit
        rounding = (
            4.0
            * math.ulp(1.0)
            * (
                abs(self.inner_radius * self.inner_speed)
                + abs(self.outer_radius * self.outer_speed)
            )
            / (self.inner_radius + self.outer_radius)
        )
        if abs(speed) <= rounding:
            raise DomainError(
                "the epicyclic cage speed is zero: cage slip, which is relative to it, has no meaning; change "
                "operation.inner_speed or operation.outer_speed"
            )
        return speed
