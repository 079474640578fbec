"""Rollers without a cage: the forces between neighbours, and the moments by which their friction brakes the spin.

- At a steady slip all rollers orbit at one speed. The torque Y_k that drives or brakes roller k along its orbit, apart
  from its neighbours, is therefore balanced by two forces: it pushes the roller ahead with a_k = N_(k+1/2), and is
  pushed from behind with b_k = N_(k-1/2). These act along the chord, with the lever c = R_m cos(pi/Z)::

      c (a_k - b_k) = G_k + R_i (F_i + F_Ri) + R_o (F_o - F_Ro) - D,   M_k = mu r (a_k + b_k)

  D is the torque that the rollers carry, divided by their number: drags act on the rollers themselves. Neighbours spin
  in the same sense, so that they slide at the sum of their surface speeds. Friction acts along the radius through their
  contact, without a lever about the axis of the bearing. So M enters the torque as friction in a pocket enters that on
  a cage.
- The train has play, so that the smallest force is zero. That determines all others. The gap, between drag and drive,
  follows from that, and is fixed to the load, not to the rollers.
- With play, loaded rollers run ahead at the speed at which they roll, and the others wait. As many rollers pass each
  position, so that their distance is proportional to their speed; the play is the sum of the additional distances. If
  that sum is over the whole loaded zone, the train is slower by the play over the length of the zone, whatever drags
  it: `slower_by_play`. With little play the rollers catch up within the zone, and it is slower by less.
- M depends on forces that accumulate over many rollers, which the spin of one roller does not contain. So motions and
  forces are found by fixed-point iteration, from no friction on. Where rollers only roll on the outer ring, M takes
  traction that the train has to supply: forces grow from one roller to the next by about 2 mu R_o/c, as in a belt on a
  pulley. The steps include that growth, because they would need as many iterations as rollers otherwise.
"""

import math

import attrs
import numpy as np

from rollslip.bearing.equilibrium import is_loaded
from rollslip.bearing.raceway import Array


@attrs.frozen
class Train:
    """The rollers of a bearing that push each other."""

    rollers: int  # their number
    radius: float  # of a roller, r [m]
    lever: float  # of the forces between neighbours, along the orbit, c = R_m cos(pi/Z) [m]
    coefficient: float  # of friction of neighbours, mu [1]

    def pushes(self, torque: Array, falls: Array | float = 0.0) -> tuple[Array, Array]:
        """Return the forces [N] by which rollers are pushed from behind, and push the roller ahead, (n, K) each.

        Parameters
        ----------
        torque : ndarray
            Torques of rollers along the orbit [N m], in its sense at K positions, (n, K).
        falls : ndarray or float
            By how much a torque decreases with the sum of both forces [m], (n, K).
        """
        shape = torque.shape[0], self.rollers, torque.shape[1] // self.rollers
        torque_by_roller = torque.reshape(shape)
        falls = np.broadcast_to(falls, torque.shape).reshape(shape)
        passed_on = (self.lever - falls) / (self.lever + falls)
        per_torque = 1.0 / (self.lever + falls)
        # a = passed_on b + per_torque (Y - D), round the train. The force behind each roller is the sum of that with no
        # force behind the first roller and D = 0, multiples of that by one newton there, and of that by D = 1
        pushed, added, taken = (np.zeros((shape[0], self.rollers + 1, shape[2])) for _ in range(3))
        added[:, 0] = 1.0
        for k in range(self.rollers):
            pushed[:, k + 1] = (
                passed_on[:, k] * pushed[:, k] + per_torque[:, k] * torque_by_roller[:, k]
            )
            added[:, k + 1] = passed_on[:, k] * added[:, k]
            taken[:, k + 1] = passed_on[:, k] * taken[:, k] + per_torque[:, k]
        relative = taken / taken[:, -1:]  # D is such that the last roller pushes the first one
        pushed = pushed - relative * pushed[:, -1:]
        added = added - relative * (added[:, -1:] - 1.0)
        behind = (pushed + added * np.max(-pushed / added, axis=1, keepdims=True))[:, :-1]
        return behind.reshape(torque.shape), np.roll(behind, -1, axis=1).reshape(torque.shape)


def slower_by_play(play: float, inner: Array, orbit: float) -> float:
    """Return an upper estimate of the slip by which the play of a train slows it; NaN without a loaded zone.

    Parameters
    ----------
    play : float
        Play of the train [m].
    inner : ndarray
        Loads of the inner ring [N] at equidistant positions of the orbit, (K,).
    orbit : float
        Radius of the orbit [m].
    """
    zone = 2.0 * math.pi * orbit * float(np.mean(is_loaded(inner)))
    return play / zone if zone > 0.0 else math.nan
