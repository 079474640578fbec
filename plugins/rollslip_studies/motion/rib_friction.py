"""Friction of ribs under axial load, as curves over the sliding speed for the compiled spins of rollers.

The friction of a rib depends on its load, on its sliding speed, and, by the film, on the speed of its surface, which
follows from the cage slip. It is tabulated once for a bearing: over the cage slip, over the logarithm of the load, and
over asinh(V/V_s), so that steps are even near V = 0 and in proportion to V beyond. The table has the coefficient of
friction, which has no error where a law is in proportion to the load. Between cage slips and loads it is interpolated
by cubics through four points, and compiled code interpolates between sliding speeds by cubics of Hermite.
"""

from typing import Final

import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import Array
from rollslip.errors import DomainError
from rollslip.models import RibContact

#: Speed V_s from which on steps of the sliding speed are in proportion to it [m/s]. Half and twice the value change
#: torques of an NJ 2312 by less than 1e-5; chosen, a quarter of the speed over which built-in laws change their sign.
_LINEAR_SPEED: Final = 2.5e-3
#: Steps of the sliding speed. Twice as many change torques of an NJ 2312 by less than 1e-5; chosen.
_SPEED_STEPS: Final = 96
#: Largest sliding speed over the sum of the surface speeds of both ribs. Beyond it friction is constant. Doubling it
#: makes steps a few per cent longer; chosen, more than rollers reach on their way to a balance.
_SPEED_RANGE: Final = 4.0
#: Cage slips of the table, from -1 to 1. Twice as many change torques of an NJ 2312 by less than 1e-5; chosen.
_CAGE_SLIPS: Final = np.linspace(-1.0, 1.0, 11)
#: Smallest load of the table over the axial load; below it the coefficient is constant. Half and twice the value change
#: torques by less than 1e-6; chosen, because such loads have no effect on a roller.
_SMALLEST_LOAD: Final = 1e-6
#: Steps of the logarithm of the load. Twice as many change torques of an NJ 2312 by less than 1e-5; chosen.
_LOAD_STEPS: Final = 36
#: Lower bound of the rolling speed in the film [m/s], as of raceways: `spins.MIN_FILM_SPEED`.
_MIN_FILM_SPEED: Final = 1e-3


def _cubic_weights(at: Array, n: int) -> tuple[np.ndarray, Array]:
    """Return the first of four grid points and their weights (m, 4) for abscissae in steps of a grid of n points."""
    first = np.clip(np.floor(at).astype(np.intp) - 1, 0, n - 4)
    t = (at - first)[:, None] - np.arange(4.0)
    weights = np.stack(
        (
            t[:, 1] * t[:, 2] * t[:, 3] / -6.0,
            t[:, 0] * t[:, 2] * t[:, 3] / 2.0,
            t[:, 0] * t[:, 1] * t[:, 3] / -2.0,
            t[:, 0] * t[:, 1] * t[:, 2] / 6.0,
        ),
        axis=1,
    )
    return first, weights


class RibFriction:
    """Friction of the ribs of one bearing under axial load.

    Parameters
    ----------
    assembly : Assembly
        The bearing, with ribs that carry an axial load.
    """

    def __init__(self, assembly: Assembly) -> None:
        pair = assembly.ribs
        assert pair is not None
        assert assembly.rib is not None
        self.pair = pair
        self._kinematics = assembly.kinematics
        self._law = assembly.rib
        self._conditions = assembly.rib_conditions
        load = assembly.scene.operation.axial_load or 0.0
        self._log_loads = np.linspace(
            np.log(_SMALLEST_LOAD * load), np.log(1.1 * load), _LOAD_STEPS + 1
        )
        speeds = self._surface_speeds(np.array([-1.0, 1.0]))
        largest = _SPEED_RANGE * float(np.abs(speeds).max(axis=1).sum())
        #: Largest abscissa asinh(V/V_s) of the curves.
        self.limit = float(np.arcsinh(largest / _LINEAR_SPEED))
        self._tables = [self._table(ring) for ring in range(2)]

    @property
    def linear_speed(self) -> float:
        """Speed V_s of the abscissa [m/s]."""
        return _LINEAR_SPEED

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
        step = 2.0 * self.limit / _SPEED_STEPS
        # two more on each side, for slopes of fourth order
        abscissa = step * (np.arange(_SPEED_STEPS + 5) - 2.0) - self.limit
        sliding = _LINEAR_SPEED * np.sinh(abscissa)
        surface = self._surface_speeds(_CAGE_SLIPS)[ring]
        half = 0.5 if ring else -0.5
        rolling = np.hypot(surface[:, None, None] + half * sliding, _MIN_FILM_SPEED)
        loads = np.exp(self._log_loads)[None, :, None]
        shape = np.broadcast_shapes(rolling.shape, loads.shape)
        contact = RibContact(
            conditions=self._conditions[ring],
            load=np.broadcast_to(loads, shape).ravel(),
            rolling_speed=np.broadcast_to(rolling, shape).ravel(),
            sliding_speed=np.broadcast_to(sliding, shape).ravel(),
        )
        force = np.asarray(self._law.friction(contact), dtype=float)
        if force.shape != contact.load.shape or not np.isfinite(force).all():
            raise DomainError(
                f"models.rib: {self._law.name!r} gives no finite force of each of {contact.load.size} contacts with a "
                "rib; state lubricant values that it needs, or choose another law, such as constant"
            )
        values = force.reshape(shape) / loads
        slopes = (
            8.0 * (values[..., 3:-1] - values[..., 1:-3]) - values[..., 4:] + values[..., :-4]
        ) / 12.0
        return np.stack((values[..., 2:-2], slopes), axis=-1)

    def curves(self, slips: Array, loads: Array) -> Array:
        """Return friction [N] and its slope per step of the abscissa at the nodes, (2, n K, nodes, 2).

        Parameters
        ----------
        slips : ndarray
            Cage slips, (n,).
        loads : ndarray
            Forces of the ribs at the positions of the orbit of each cage slip [N], (n K,).
        """
        n_slips = _CAGE_SLIPS.size
        first, weights = _cubic_weights((slips + 1.0) / 2.0 * (n_slips - 1), n_slips)
        logs = np.log(np.maximum(loads, np.exp(self._log_loads[0])))
        steps = (logs - self._log_loads[0]) / (self._log_loads[1] - self._log_loads[0])
        first_load, load_weights = _cubic_weights(steps, self._log_loads.size)
        load_weights = load_weights * loads[:, None]
        rows = np.repeat(np.arange(slips.size), loads.size // slips.size)
        curves = np.zeros((2, loads.size, _SPEED_STEPS + 1, 2))
        for ring, table in enumerate(self._tables):
            at_slips = sum(weights[:, k, None, None, None] * table[first + k] for k in range(4))
            for k in range(4):
                curves[ring] += load_weights[:, k, None, None] * at_slips[rows, first_load + k]
        return curves

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
