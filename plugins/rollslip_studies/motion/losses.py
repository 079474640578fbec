"""What a bearing loses to friction at a constant cage speed, by source, and the power of the rings that pays for it.

- In the frame of the cage, with V the sliding and u the entrainment speeds of the contacts, the losses of a roller are
  F_i V_i + F_o V_o by sliding, 2 (F_Ri u_i + F_Ro u_o) by resistance to rolling and M w_r in its pocket, or at its
  neighbours; a drag on the cage loses -T (w_c - w_b) against the body b that bears its reaction: a ring, or what stands
  still.
- The rings put in Z <R_i (F_i + F_Ri)> w_i and Z <R_o (F_o - F_Ro)> w_o, and what drives the cage from their lands.
  With the torques of `rollslip_studies.motion.torque_balance`, identically::

      power of the rings = sum of the losses + w_c (excess torque on the cage) + Z <w_r G>

  At a steady slip the second term is the rounding of its root. The third is the work on the rollers' spin: none where
  they have no inertia, else what the positions of the orbit leave of a motion that repeats.
- Each sum is of products that are formed one by one, so the identity tells of every sign and lever here.
"""

import attrs
import numpy as np

from rollslip.bearing.drags import TotalResistance
from rollslip.bearing.raceway import RINGS, Array, LoadedContacts
from rollslip.models import ResistanceModel
from rollslip_kernels.slices import COLUMNS, Slices
from rollslip_studies.motion.torque_balance import Orbit, TorqueBalance

__all__ = ["Loss", "PowerBalance", "power_balance"]


@attrs.frozen
class Loss:
    """Power that is lost to friction."""

    source: str  # what loses it: "sliding, inner raceway", or the name of a drag
    #: Where its heat is made: "inner contact", "outer contact", "pocket"; of a torque on the cage "inner land", "outer
    #: land", or "oil" where what stands still bears the reaction.
    place: str
    power: float  # [W]; below zero where a drag puts power in, as nothing of the box does


@attrs.frozen(kw_only=True)
class PowerBalance:
    """Losses of a bearing and what pays for them."""

    losses: tuple[Loss, ...]  # by source, in one order for all states of a scene
    rings: tuple[
        float, float
    ]  # power that inner and outer ring put in [W]; below zero where a ring gives power off
    #: Power that speeds up cage and rollers [W]: none at a steady slip, but for rounding and positions of the orbit.
    stored: float

    @property
    def total(self) -> float:
        """Sum of the losses [W]."""
        return sum(loss.power for loss in self.losses)

    def heat(self, place: str) -> float:
        """Sum of the losses at a place [W]."""
        return sum(loss.power for loss in self.losses if loss.place == place)


def power_balance(balance: TorqueBalance, orbit: Orbit) -> PowerBalance:
    """Return the losses of a bearing in a motion of its rollers, means over the orbit."""
    k = balance.assembly.kinematics
    rollers = balance.assembly.scene.bearing.rollers
    speeds = k.surface_speeds(orbit.cage_slip, orbit.roller_slip)
    traction, resistance, on_cage = balance.forces(orbit)
    sliding = np.array([speeds.inner_sliding, speeds.outer_sliding])
    rolling = np.array([speeds.inner_rolling, speeds.outer_rolling])
    cage = balance.cage_speed(orbit.cage_slip)
    spin = speeds.roller_speed
    levers = np.array(
        [
            k.inner_radius * (traction[0] + resistance[0]),
            k.outer_radius * (traction[1] - resistance[1]),
        ]
    )
    turns = on_cage - levers.sum(axis=0)  # G
    pocket = (
        k.roller_radius * (traction[0] - resistance[0] - traction[1] - resistance[1]) - turns
    )  # M

    def all_rollers(power: Array) -> float:
        return rollers * float(power.mean())

    slid = [all_rollers(traction[i] * sliding[i]) for i in range(len(RINGS))]
    losses = [
        Loss(f"sliding, {ring} raceway", f"{ring} contact", power)
        for ring, power in zip(RINGS, slid, strict=True)
    ]
    if balance.drags.resistance is not None:
        rolled = [all_rollers(2.0 * resistance[i] * rolling[i]) for i in range(len(RINGS))]
        losses += _rolling(balance, orbit, balance.drags.resistance, rolled)
    if balance.drags.pocket_friction is not None:
        losses.append(
            Loss(balance.drags.pocket_friction.name, "pocket", all_rollers(pocket * spin))
        )
    if balance.assembly.scene.models.neighbour_friction is not None:
        losses.append(Loss("rubbing of neighbours", "pocket", all_rollers(pocket * spin)))
    put_in = [all_rollers(lever) for lever in levers]
    ring_speeds = [k.direction * k.inner_speed, k.direction * k.outer_speed]
    drag = 0.0
    for model in balance.drags.torques:
        torque = k.direction * model.torque(k.direction * cage, k.inner_speed, k.outer_speed)
        drag += torque
        ring = RINGS.index(model.against) if model.against in RINGS else None
        place = "oil" if ring is None else f"{RINGS[ring]} land"
        losses.append(
            Loss(model.name, place, -torque * (cage - (0.0 if ring is None else ring_speeds[ring])))
        )
        if ring is not None:
            put_in[ring] += torque
    inner, outer = (torque * speed for torque, speed in zip(put_in, ring_speeds, strict=True))
    stored = cage * (all_rollers(on_cage) + drag) + all_rollers(spin * turns)
    return PowerBalance(losses=_told_apart(losses), rings=(inner, outer), stored=stored)


def _rolling(
    balance: TorqueBalance, orbit: Orbit, resistance: ResistanceModel, power: list[float]
) -> list[Loss]:
    """Losses by resistance to rolling, split in the proportion in which its terms resist on the slices."""
    terms = resistance.terms if isinstance(resistance, TotalResistance) else (resistance,)
    losses = []
    for ring, of, whole in zip(RINGS, balance.evaluate_contacts(orbit), power, strict=True):
        fractions = np.array([_power_of(term, of) for term in terms])
        fractions = fractions / (fractions.sum() or 1.0)
        losses += [
            Loss(f"{term.name}, {ring} raceway", f"{ring} contact", whole * float(fraction))
            for term, fraction in zip(terms, fractions, strict=True)
        ]
    return losses


def _power_of(term: ResistanceModel, contacts: LoadedContacts) -> float:
    """Half the power [W] that one term takes on the evaluated slices of a ring."""
    if contacts.force.size == 0:
        return 0.0
    slices = contacts.slices
    columns = {name: getattr(slices, name) for name in COLUMNS if hasattr(slices, name)}
    own = np.empty_like(slices.resistance)
    term.evaluate(Slices.of_columns(slices.conditions, columns | {"resistance": own}))
    return float((own * contacts.width * slices.rolling_speed).sum())


def _told_apart(losses: list[Loss]) -> tuple[Loss, ...]:
    """Return the losses with a number behind a source that was there before."""
    seen = dict[str, int]()
    told = []
    for loss in losses:
        seen[loss.source] = count = seen.get(loss.source, 0) + 1
        told.append(loss if count == 1 else attrs.evolve(loss, source=f"{loss.source} {count}"))
    return tuple(told)
