"""Rollers without a cage: how hard neighbours push each other, and by what their rubbing brakes their spin.

- At a steady slip all rollers go round at one speed, so what drives or brakes a roller k along its orbit beside its
  neighbours, torque Y_k, goes into the difference of the forces by which it pushes the one ahead, a_k = N_(k+1/2), and
  is pushed from behind, b_k = N_(k-1/2). These act along the chord, with the lever c = R_m cos(pi/Z)::

      c (a_k - b_k) = G_k + R_i (F_i + F_Ri) + R_o (F_o - F_Ro) - D,   M_k = mu r (a_k + b_k)

  D is an equal share of the torque that the set carries: drags act on the rollers themselves. Neighbours spin the same
  way, so they slide at the sum of their surface speeds; friction acts along the radius through their contact, without
  a lever about the axis of the bearing. So M enters the torque as friction in a pocket enters that on a cage.
- The train has play, so somewhere nothing is pushed: the least force is zero. That fixes all others. Where the gap is,
  between drag and drive, follows from that, and moves round with the load, not with the rollers.
- Play lets loaded rollers run ahead, at the speed at which they roll, and all others wait for their turn: as many pass
  each place, so where they do rollers are the further apart the faster they are, and the play is what that takes. If
  that is all of the loaded zone, the train is slower by play over its length, whatever drags it: `slower_by_play`. With
  little play they catch up within the zone, and it is less.
- M depends on forces that have gathered over many rollers, which the spin of one does not know. So motions and forces
  are found in turn, from no friction on. Where rollers only roll on the outer ring, M there takes traction that the
  train has to give: forces grow from one to the next by about 2 mu R_o/c, as in a belt round a pulley, and steps
  foresee that, else they would need as many turns as rollers.
"""

import math

import attrs
import numpy as np

from rollslip.bearing.kinematics import Kinematics
from rollslip.bearing.raceway import Array


@attrs.frozen
class Train:
    """The rollers of a bearing that push each other."""

    rollers: int
    radius: float  # of a roller, r [m]
    lever: float  # of what rollers push with, along the orbit, c [m]
    coefficient: float  # of friction of neighbours, mu [1]

    @classmethod
    def of(cls, kinematics: Kinematics, rollers: int, coefficient: float) -> "Train":
        """Return that of a bearing."""
        lever = kinematics.orbit_radius * math.cos(math.pi / rollers)
        return cls(rollers, kinematics.roller_radius, lever, coefficient)

    def pushes(self, torque: Array, falls: Array | None = None) -> tuple[Array, Array]:
        """Return the forces [N] by which rollers are pushed from behind, and push the one ahead, (n, K) each.

        Of torques that rollers have along the orbit [N m], (n, K), in its sense at K positions, less ``falls`` [m]
        times the sum of both forces.
        """
        shape = torque.shape[0], self.rollers, torque.shape[1] // self.rollers
        given = torque.reshape(shape)
        falls = np.zeros(shape) if falls is None else falls.reshape(shape)
        kept = (self.lever - falls) / (self.lever + falls)
        fraction = 1.0 / (self.lever + falls)
        # a = kept b + share (Y - D), round the train: what stands behind each roller with none behind the first one and
        # D = 0, what one newton behind the first one adds, and what D = 1 takes
        pushed, added, taken = (np.zeros((shape[0], self.rollers + 1, shape[2])) for _ in range(3))
        added[:, 0] = 1.0
        for k in range(self.rollers):
            pushed[:, k + 1] = kept[:, k] * pushed[:, k] + fraction[:, k] * given[:, k]
            added[:, k + 1] = kept[:, k] * added[:, k]
            taken[:, k + 1] = kept[:, k] * taken[:, k] + fraction[:, k]
        whole = taken / taken[:, -1:]  # D is such that the last one pushes the first one
        pushed = pushed - whole * pushed[:, -1:]
        added = added - whole * (added[:, -1:] - 1.0)
        behind = (pushed + added * np.max(-pushed / added, axis=1, keepdims=True))[:, :-1]
        return behind.reshape(torque.shape), np.roll(behind, -1, axis=1).reshape(torque.shape)


def slower_by_play(play: float, inner: Array, orbit: float) -> float:
    """Return by about how much at most the play of a train [m] slows it, as a slip.

    Of loads of the inner ring [N] at positions all round, (K,), on an orbit of some radius [m].
    """
    zone = 2.0 * math.pi * orbit * float(np.mean(inner > 0.0))
    return play / zone if zone > 0.0 else math.nan
