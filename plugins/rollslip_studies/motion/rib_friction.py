"""Friction of ribs under axial load, as curves over the sliding speed for the compiled spins of rollers.

The friction of a rib depends on its load, on its sliding speed, and, by the film, on the speed of its surface, which
follows from the cage slip. It is tabulated once for a bearing: over the cage slip, over the logarithm of the load, and
over asinh(V/V_s), so that steps are even near V = 0 and in proportion to V beyond. The table has the coefficient of
friction, which has no error where a law is in proportion to the load. It is interpolated by cubics, through four points
between cage slips and loads, and of Hermite between sliding speeds. Compiled code does all but that of the cage slip.
"""

from functools import lru_cache
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rollslip.bearing.kinematics import Kinematics
from rollslip.bearing.ribs import RibPair
from rollslip.errors import DomainError
from rollslip.models import RibContact, RibModel
from rollslip.search import Array
from rollslip_kernels.slices import Conditions

__all__ = ["LINEAR_SPEED", "RibFriction", "rib_forces", "rib_friction"]

#: What compiled spins take of ribs: tables, first loads, weights, leads, linear speed, limit, height.
RibArguments: TypeAlias = tuple[Array, NDArray[np.intp], Array, Array, float, float, float]

#: Speed V_s from which on steps of the sliding speed are in proportion to it [m/s]. Half and twice the value change
#: slips of an NJ 2312 by up to 3e-4 of them; chosen, a quarter of the speed over which built-in laws change their sign.
LINEAR_SPEED: Final = 2.5e-3
#: Steps of the sliding speed. Torques of an NJ 2312 have an error of 1e-5 of the largest, 3e-4 with three quarters as
#: many, at which a tanh is no longer resolved; chosen.
_SPEED_STEPS: Final = 64
#: Largest sliding speed over the sum of the surface speeds of both ribs. Beyond it friction is constant. Half and
#: twice the value change slips of an NJ 2312 by up to 5e-4 of them; chosen, more than rollers reach on their way to a
#: balance.
_SPEED_RANGE: Final = 4.0
#: Cage slips of the table, from -1 to 1. Torques of an NJ 2312 have an error of 1e-5 of the largest, 3e-3 at a slip of
#: 40 % with seven slips; twice as many change nothing. Chosen.
_CAGE_SLIPS: Final = np.linspace(-1.0, 1.0, 11)
#: Smallest load of the table over the axial load; below it the coefficient is constant. Half and twice the value change
#: slips of an NJ 2312 by up to 5e-4 of them; chosen, because such loads have no effect on a roller.
_SMALLEST_LOAD: Final = 1e-6
#: Steps of the logarithm of the load. Torques of an NJ 2312 have an error of 3e-5 of the largest, 1e-4 with three
#: quarters as many, 8e-6 with half as many more; chosen.
_LOAD_STEPS: Final = 24
#: Lower bound of the rolling speed in the film [m/s], as of raceways: `spins.MIN_FILM_SPEED`.
_MIN_FILM_SPEED: Final = 1e-3


def _cubic_weights(at: Array, n: int) -> tuple[NDArray[np.intp], Array]:
    """Return the first of four of n grid points (m,), and their weights (m, 4), at abscissae in steps of the grid."""
    first = np.minimum(np.maximum(at.astype(np.intp) - 1, 0), n - 4)
    t = at - first
    weights = (
        (t - 1.0) * (t - 2.0) * (t - 3.0) / -6.0,
        t * (t - 2.0) * (t - 3.0) / 2.0,
        t * (t - 1.0) * (t - 3.0) / -2.0,
        t * (t - 1.0) * (t - 2.0) / 6.0,
    )
    return first, np.stack(weights, axis=1)


def rib_forces(
    law: RibModel,
    pair: RibPair,
    conditions: tuple[Conditions, Conditions],
    ring: int,
    given: tuple[Array, Array, Array],
) -> Array:
    """Return the friction of contacts with the rib of a ring [N], at the radii of the pair; 0 of a ring without one.

    Parameters
    ----------
    law, pair, conditions
        As in `RibFriction`.
    ring : int
        0 for the inner ring, 1 for the outer one.
    given : tuple of ndarray
        Loads [N], rolling and sliding speeds at the radii of the pair [m/s], which are broadcast.
    """
    load, rolling, sliding = np.broadcast_arrays(*given)
    contact = RibContact(
        conditions=conditions[ring],
        load=load.ravel(),
        rolling_speed=pair.scale * rolling.ravel(),
        sliding_speed=pair.scale * sliding.ravel(),
    )
    force = np.asarray(law.friction(contact), dtype=float)
    if force.shape != contact.load.shape or not np.isfinite(force).all():
        raise DomainError(
            f"models.rib: {law.name!r} gives no finite force of each of {contact.load.size} contacts with a rib; "
            "state lubricant values that it needs, or choose another law, such as constant"
        )
    return pair.sides[ring] * pair.scale * force.reshape(load.shape)


def rib_friction(
    law: RibModel,
    pair: RibPair,
    conditions: tuple[Conditions, Conditions],
    kinematics: Kinematics,
    load: float,
) -> "RibFriction":
    """Return the friction of the ribs of a bearing; bearings that differ in slices alone share a table.

    Parameters
    ----------
    law, pair, conditions, kinematics, load
        As in `RibFriction`.
    """
    given = law, pair, conditions, kinematics, load
    try:
        hash(given)
    except TypeError:  # a law with a parameter that is not hashable
        return RibFriction(*given)
    return _cached(*given)


class RibFriction:
    """Friction of the ribs of one bearing under axial load.

    Parameters
    ----------
    law : RibModel
        Friction of a rib.
    pair : RibPair
        Geometry of the ribs.
    conditions : tuple of Conditions
        Of the contacts with inner and outer rib.
    kinematics : Kinematics
        Of the bearing.
    load : float
        Axial load [N].
    """

    def __init__(
        self,
        law: RibModel,
        pair: RibPair,
        conditions: tuple[Conditions, Conditions],
        kinematics: Kinematics,
        load: float,
    ) -> None:
        self.pair = pair
        self._kinematics = kinematics
        self._law = law
        self._conditions = conditions
        self._log_loads = np.linspace(
            np.log(_SMALLEST_LOAD * load), np.log(1.1 * load), _LOAD_STEPS + 1
        )
        speeds = self._surface_speeds(np.array([-1.0, 1.0]))
        largest = _SPEED_RANGE * float(np.abs(speeds).max(axis=1).sum())
        #: largest abscissa asinh(V/V_s) of the curves
        self._limit = float(np.arcsinh(largest / LINEAR_SPEED))
        self._tables = np.stack([self._table(ring) for ring in range(2)])

    def _surface_speeds(self, slips: Array) -> Array:
        """Surface speeds of both ribs relative to the cage [m/s], (2, n)."""
        k = self._kinematics
        cage = k.epicyclic_cage_speed * (1.0 - slips)
        radii = self.pair.ring_radii
        return np.stack(
            (
                radii[0] * (k.direction * k.inner_speed - cage),
                radii[1] * (cage - k.direction * k.outer_speed),
            )
        )

    def _table(self, ring: int) -> Array:
        """Coefficients and their slopes over the abscissa, (cage slips, loads, speeds, 2)."""
        step = 2.0 * self._limit / _SPEED_STEPS
        # two more on each side, for slopes of fourth order
        abscissa = step * (np.arange(_SPEED_STEPS + 5) - 2.0) - self._limit
        sliding = LINEAR_SPEED * np.sinh(abscissa)
        surface = self._surface_speeds(_CAGE_SLIPS)[ring]
        half = 0.5 if ring else -0.5
        rolling = np.hypot(surface[:, None, None] + half * sliding, _MIN_FILM_SPEED)
        loads = np.exp(self._log_loads)[None, :, None]
        force = rib_forces(self._law, self.pair, self._conditions, ring, (loads, rolling, sliding))
        values = force / loads
        slopes = (
            8.0 * (values[..., 3:-1] - values[..., 1:-3]) - values[..., 4:] + values[..., :-4]
        ) / 12.0
        return np.stack((values[..., 2:-2], slopes), axis=-1)

    def tables(self, slips: Array) -> Array:
        """Return coefficients of friction, and slopes per step of the abscissa, (2, n, loads, speeds, 2).

        Parameters
        ----------
        slips : ndarray
            Cage slips, (n,).
        """
        n_slips = _CAGE_SLIPS.size
        first, weights = _cubic_weights((slips + 1.0) / 2.0 * (n_slips - 1), n_slips)
        at_slips = np.zeros((slips.size, n_slips))
        at_slips[np.arange(slips.size)[:, None], first[:, None] + np.arange(4)] = weights
        # without threads, unlike a product of matrices
        return np.asarray(np.einsum("sn,rn...->rs...", at_slips, self._tables))

    def pocket_arguments(
        self, slips: Array, loads: Array
    ) -> tuple[Array, Array, float, float, float, float, float]:
        """Return what compiled marches through the pockets take of the ribs.

        Parameters
        ----------
        slips : ndarray
            Cage slips, (n,).
        loads : ndarray
            Forces of the ribs over the orbit of each cage slip, both ends included [N], (n, m + 1).
        """
        smallest = float(self._log_loads[0])
        step = float(self._log_loads[1]) - smallest
        abscissa = (LINEAR_SPEED, self._limit)
        return self.tables(slips), loads, smallest, step, *abscissa, self.pair.height

    def arguments(self, slips: Array, loads: Array) -> RibArguments:
        """Return what compiled spins take of the ribs, at the positions of the orbit of each cage slip.

        Parameters
        ----------
        slips : ndarray
            Cage slips, (n,).
        loads : ndarray
            Forces of the ribs at the positions of the orbit of each cage slip [N], (n K,).
        """
        smallest = self._log_loads[0]
        logs = np.log(np.maximum(loads, np.exp(smallest)))
        first, weights = _cubic_weights(
            (logs - smallest) / (self._log_loads[1] - smallest), self._log_loads.size
        )
        leads = np.repeat(self.leads(slips), loads.size // slips.size, axis=1)
        return (
            self.tables(slips),
            first,
            weights * loads[:, None],
            leads,
            LINEAR_SPEED,
            self._limit,
            self.pair.height,
        )

    def leads(self, slips: Array) -> tuple[Array, Array]:
        """Return the sliding speeds of both ribs without roller slip [m/s], (n,) each."""
        return self.pair.leads(self._kinematics, slips)

    def sliding_speeds(self, slip: float, roller_slips: Array) -> Array:
        """Return the sliding speeds of both ribs at a cage slip [m/s], (2, K).

        Parameters
        ----------
        slip : float
            Cage slip.
        roller_slips : ndarray
            Roller slips, (K,).
        """
        inner, outer = self.leads(np.array([slip]))
        spin = self._kinematics.epicyclic_roller_speed * self.pair.spin_radius * roller_slips
        return np.stack((inner + spin, outer - spin))


#: Makes tables, and stores those of the last bearings: a run needs one bearing at several resolutions.
_cached = lru_cache(maxsize=8)(RibFriction)
