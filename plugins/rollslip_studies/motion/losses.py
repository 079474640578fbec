"""Power losses by friction at a constant cage speed, by source, and the power of the rings that supplies them.

- In the frame of the cage, with V the sliding and u the entrainment speeds of the contacts, the losses of a roller
  are F_i V_i + F_o V_o by sliding, the same of ribs under axial load, 2 (F_Ri u_i + F_Ro u_o) by rolling resistance
  and M w_r in its pocket, or at its neighbours. A drag on the cage loses -T (w_c - w_b) against the body b that bears
  its reaction: a ring, or what does not move. Losses beside the rollers, of seals for example, brake the rings
  against each other.
- The rings supply Z <R_i (F_i + F_Ri)> w_i and Z <R_o (F_o - F_Ro)> w_o, and the torques on the cage from their lands.
  With the torques of `rollslip_studies.motion.torque_balance`, identically::

      power of the rings = sum of the losses + w_c (excess torque on the cage) + Z <w_r G>

  At a steady slip the second term is the rounding of its root. The third is the work on the rollers' spin: zero where
  they have no inertia, else the discretisation error in position of a periodic motion.
- Each sum has products that are computed separately, so that the identity tests every sign and lever here.
"""

from collections import Counter
from typing import TYPE_CHECKING

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.drags import TotalResistance
from rollslip.bearing.raceway import RINGS, Array, LoadedContacts
from rollslip.models import ResistanceModel
from rollslip.scene.values import Scene
from rollslip_kernels.slices import COLUMNS, Slices
from rollslip_studies.motion.torque_balance import Orbit, TorqueBalance

if TYPE_CHECKING:
    from rollslip.studies.steady_slip.loss import LossModel

__all__ = ["Loss", "PowerBalance", "named_losses", "power_balance"]


@attrs.frozen
class Loss:
    """Power that is lost to friction."""

    source: str  # "sliding, inner raceway", or the name of a drag or of a loss beside the rollers
    #: Where its heat arises: "inner contact", "outer contact" or "pocket"; for a torque on the cage "inner land",
    #: "outer land", or "oil" where a body that does not move bears the reaction.
    place: str
    power: float  # [W]; negative where a drag supplies power, as no built-in drag does


@attrs.frozen(kw_only=True)
class PowerBalance:
    """Losses of a bearing and the power that supplies them."""

    losses: tuple[Loss, ...]  # by source, in one order for all states of a scene
    #: Torque that drives inner and outer ring [N m], positive in the sense in which the inner ring turns relative to
    #: the outer one. It holds a ring that stands.
    torques: tuple[float, float]
    #: Power that inner and outer ring supply [W]; negative where a ring receives power.
    rings: tuple[float, float]
    #: Power that accelerates cage and rollers [W]: at a steady slip, rounding and the discretisation error in
    #: position.
    stored: float
    #: Torque of the losses beside the rollers [N m], a part of `friction_torque`; 0 where the scene names none.
    external_torque: float = 0.0

    @property
    def total(self) -> float:
        """Sum of the losses [W]."""
        return sum(loss.power for loss in self.losses)

    @property
    def friction_torque(self) -> float:
        """Torque of the ring that supplies most power [N m]: all losses over its speed where the other ring stands."""
        return abs(self.torques[0 if self.rings[0] >= self.rings[1] else 1])

    def heat(self, place: str) -> float:
        """Sum of the losses at a place [W]."""
        return sum(loss.power for loss in self.losses if loss.place == place)


def power_balance(balance: TorqueBalance, orbit: Orbit) -> PowerBalance:
    """Return the losses of a bearing in a motion of its rollers, means over the orbit.

    Parameters
    ----------
    balance : TorqueBalance
        Of the bearing.
    orbit : Orbit
        The motion.
    """
    k = balance.assembly.kinematics
    rollers = balance.assembly.scene.bearing.rollers
    speeds = k.surface_speeds(orbit.cage_slip, orbit.roller_slip)
    traction, resistance, on_cage = balance.forces(orbit)
    sliding = np.array([speeds.inner_sliding, speeds.outer_sliding])
    rolling = np.array([speeds.inner_rolling, speeds.outer_rolling])
    spin = speeds.roller_speed
    ring_torques = np.array(
        [
            k.inner_radius * (traction[0] + resistance[0]),
            k.outer_radius * (traction[1] - resistance[1]),
        ]
    )
    torque_by_rings = k.roller_radius * (
        traction[0] - resistance[0] - traction[1] - resistance[1]
    )  # G + M
    ribs = balance.assembly.ribs
    rib_friction, rib_sliding = balance.rib_forces(orbit)
    if ribs is not None:
        ring_torques += np.array(ribs.ring_radii)[:, None] * rib_friction
        torque_by_rings += ribs.spin_radius * (rib_friction[0] - rib_friction[1])
    spin_torque = on_cage - ring_torques.sum(axis=0)  # G
    pocket = torque_by_rings - spin_torque  # M

    def all_rollers(power: Array) -> float:
        return rollers * float(power.mean())

    losses = [
        Loss(f"sliding, {ring} raceway", f"{ring} contact", all_rollers(traction[i] * sliding[i]))
        for i, ring in enumerate(RINGS)
    ]
    losses += [
        Loss(f"sliding, {RINGS[i]} rib", f"{RINGS[i]} contact", all_rollers(force * rib_sliding[i]))
        for i, force in enumerate(rib_friction)
        if ribs is not None and ribs.sides[i]
    ]
    if balance.drags.resistance is not None:
        rolled = [all_rollers(2.0 * resistance[i] * rolling[i]) for i in range(len(RINGS))]
        losses += _rolling_losses(balance, orbit, balance.drags.resistance, rolled)
    if balance.drags.pocket_friction is not None:
        losses.append(
            Loss(balance.drags.pocket_friction.name, "pocket", all_rollers(pocket * spin))
        )
    if balance.assembly.scene.models.neighbour_friction is not None:
        losses.append(Loss("rubbing of neighbours", "pocket", all_rollers(pocket * spin)))
    torques = [all_rollers(torque) for torque in ring_torques]  # on inner and outer ring
    ring_speeds = [k.direction * k.inner_speed, k.direction * k.outer_speed]
    cage_speed = balance.cage_speed(orbit.cage_slip)
    drag = 0.0
    for model in balance.drags.torques:
        torque = k.direction * model.torque(k.direction * cage_speed, k.inner_speed, k.outer_speed)
        drag += torque
        if model.against in RINGS:
            ring = RINGS.index(model.against)
            torques[ring] += torque
            place = f"{RINGS[ring]} land"
            speed = ring_speeds[ring]
        else:
            place = "oil"
            speed = 0.0
        losses.append(Loss(model.name, place, -torque * (cage_speed - speed)))
    external_torque = 0.0
    if external := _external_losses(balance.assembly):
        losses += external
        relative_speed = abs(k.inner_speed - k.outer_speed)
        external_torque = sum(loss.power for loss in external) / relative_speed
        torques[0] += external_torque
        torques[1] -= external_torque
    stored = cage_speed * (all_rollers(on_cage) + drag) + all_rollers(spin * spin_torque)
    rings = torques[0] * ring_speeds[0], torques[1] * ring_speeds[1]
    return PowerBalance(
        losses=_number_sources(losses),
        torques=(torques[0], torques[1]),
        rings=rings,
        stored=stored,
        external_torque=external_torque,
    )


def named_losses(scene: Scene) -> tuple[tuple[str, "LossModel"], ...]:
    """Return the models of losses beside the rollers that a scene names, each with the name of its kind."""
    if not scene.models.loss:
        return ()
    from rollslip.studies.steady_slip.loss import loss_models  # only such scenes need it

    return tuple(("loss", model) for model in loss_models(scene))


def _external_losses(assembly: Assembly) -> list[Loss]:
    """Return the losses beside the rollers that a scene names."""
    if not (named := named_losses(assembly.scene)):
        return []
    from rollslip.studies.steady_slip.loss import lost_power  # only such scenes need it
    from rollslip.studies.steady_slip.torque import Duty

    duty = Duty.of(assembly)
    return [Loss(model.name, model.place, lost_power(model, duty)) for _, model in named]


def _rolling_losses(
    balance: TorqueBalance, orbit: Orbit, resistance: ResistanceModel, power: list[float]
) -> list[Loss]:
    """Losses by rolling resistance, split in proportion to the power of its terms on the slices."""
    terms = resistance.terms if isinstance(resistance, TotalResistance) else (resistance,)
    losses = []
    for ring, contacts, total in zip(RINGS, balance.evaluate_contacts(orbit), power, strict=True):
        fractions = np.array([_power_of_term(term, contacts) for term in terms])
        fractions = fractions / (fractions.sum() or 1.0)
        losses += [
            Loss(f"{term.name}, {ring} raceway", f"{ring} contact", total * float(fraction))
            for term, fraction in zip(terms, fractions, strict=True)
        ]
    return losses


def _power_of_term(term: ResistanceModel, contacts: LoadedContacts) -> float:
    """Half the power [W] of one term on the evaluated slices of a ring."""
    if contacts.force.size == 0:
        return 0.0
    slices = contacts.slices
    columns = {name: getattr(slices, name) for name in COLUMNS if hasattr(slices, name)}
    own = np.empty_like(slices.resistance)
    term.evaluate(Slices.of_columns(slices.conditions, columns | {"resistance": own}))
    return float((own * contacts.width * slices.rolling_speed).sum())


def _number_sources(losses: list[Loss]) -> tuple[Loss, ...]:
    """Return the losses with a number behind a source that occurs before."""
    counts = Counter[str]()
    numbered = []
    for loss in losses:
        counts[loss.source] += 1
        if counts[loss.source] > 1:
            loss = attrs.evolve(loss, source=f"{loss.source} {counts[loss.source]}")
        numbered.append(loss)
    return tuple(numbered)
