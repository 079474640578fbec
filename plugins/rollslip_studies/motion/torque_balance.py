"""Balance of the torques on a cage that runs at a constant speed, without integrating in time.

- The cage is heavy beside its rollers and one revolution is much shorter than its transient, so at a steady slip its
  speed is constant and every roller does the same thing, once per orbit. What is left of the dynamics is the spin of
  one roller over one orbit, periodic::

      J |w_c| ds/dtheta = G,   G = r (F_i - F_Ri) - r (F_o + F_Ro) - M
      T = Z <G + R_i (F_i + F_Ri) + R_o (F_o - F_Ro)>,   M = mu_p |P| r,   R_m P = G + M + R_i (...) + R_o (...)

  with s the absolute spin, theta the position in the sense of the orbit, F = mu Q the tractions, F_R the rolling
  resistances (against rolling on both surfaces), M the friction of the roller in its pocket under the force P that
  carries it round, and < > the mean over the orbit. T drives the cage.
- Of the motions that repeat after an orbit it takes the one that rollers are in while the drag is raised slowly from
  none: `motion.spins` finds motions, `motion.loading_branch` their order. It does not depend on what was
  asked before.
- The loads are solved anew at every slip: centrifugal forces go with the square of the cage speed.
"""

import contextlib
import math
import time
from functools import cached_property
from typing import Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.drags import Drags
from rollslip.bearing.raceway import Array, LoadedContacts, Raceway
from rollslip.errors import ConvergenceError, DomainError
from rollslip.results.words import Status
from rollslip.units import format_quantity
from rollslip_studies.motion.effective_table import effective_table
from rollslip_studies.motion.loading_branch import LoadingBranch, find_loading_branch
from rollslip_studies.motion.spins import (
    ConventionalFriction,
    EffectiveCurve,
    Motion,
    Motions,
    logit_slip,
    slip_from_logit,
)

#: Loads that stand for the slices of a roller on the way up.
_FEW: Final = 8
#: Slips at which its time is measured, the place of the first, and how many times as long all of it takes, with maxima;
#: and without a cage, of which 5 bearings took 5 to 34 times that.
_SOME = 6
_LOW = -9.0
_ALL = 10.0
_RUBBED = 14.0
#: Range at which no law has a value.
_NOWHERE: Final = 1e-3
#: Positions of an orbit, at least and at most, on which rollers are followed.
_POSITIONS: Final = (56, 512)
#: Slips of a way up at which bounds of laws are looked at, relative to its end.
_LOOKED_AT: Final = (0.0, 0.02, 0.15, 0.5, 1.0)
#: Share of the largest drag below which a cage is far from running away, whatever effective friction is off.
_FAR: Final = 0.5
#: A slip at which the cage hardly turns.
_STANDS: Final = 0.94
#: Largest slip of a way up that nobody asks to go further: there the cage all but stands.
RANGE: Final = 0.95


@attrs.frozen(eq=False, kw_only=True)
class Orbit:
    """What one roller does over an orbit at a steady cage slip, and what all of them do to the cage."""

    cage_slip: float  # S_c [-]
    #: Mean torque of all rollers on the cage [N m], positive where it drives it on in the sense of its orbit.
    torque: float
    roller_slip: Array  # S_r at the positions of the orbit, in its sense, (K,)
    #: force, traction: Normal force and traction of inner and outer contact [N], (2, K); traction positive where it
    #: drives.
    force: Array
    traction: Array
    #: What an orbit leaves of a disturbance of the spin: the rollers hold this motion if it is below 1 in size.
    multiplier: float
    brakes: Array | None = (
        None  # moments by which neighbours brake its spin, without a cage [N m], (K,)
    )


class TorqueBalance:
    """Torques of rollers and drag on the cage of one bearing against its slip."""

    def __init__(
        self,
        assembly: Assembly,  # the bearing
        # What resists the cage, and rollers in their pockets; resistance to rolling is a stage of the bearing's
        # chains.
        drags: Drags,
        *,
        n_positions: int,  # instants of a roller pitch; the orbit has Z times as many positions
        # Friction curves of inner and outer raceway in place of the whole chain; `effective_curves`.
        effective: tuple[EffectiveCurve, EffectiveCurve] | None = None,
        # False for rollers without inertia of their spin, whose contacts balance at every position.
        inertia: bool = True,
        # That of a bearing nearly alike, whose rollers slip about as much without slip of the cage.
        beside: "TorqueBalance | None" = None,
    ) -> None:
        self.assembly = assembly
        self.drags = drags
        self.n_positions = n_positions
        self._beside = beside
        self.effective = effective
        self.inertia = inertia
        self._known: dict[float, Orbit] = {}
        self._ways: dict[tuple[float, int], LoadingBranch] = {}
        friction = drags.pocket_friction
        self._pocket = 0.0 if friction is None else friction.coefficient
        self._rubbing = assembly.scene.models.neighbour_friction or 0.0

    @cached_property
    def motions(self) -> Motions:
        """Motions of the rollers on all slices, their loads solved at every slip."""
        return Motions(
            self.assembly, self.n_positions, pocket=self._pocket, rubbing=self._rubbing, effective=self.effective,
            inertia=self.inertia, similar=None if self._beside is None else self._beside.motions,
        )  # fmt: skip

    @cached_property
    def _few(self) -> Motions:
        """The same by few loads of a roller."""
        return self.motions.with_resolution(self.n_positions, _FEW)

    def loading_branch(self, largest: float = RANGE, *, steps: int = 0) -> LoadingBranch:
        """Return the loading branch over cage slips up to the largest; see `loading_branch`."""
        key = largest, steps
        if key not in self._ways:
            self._ways[key] = find_loading_branch(self._few, largest, self.motions, steps=steps)
        return self._ways[key]

    def seconds(self, largest: float = RANGE) -> float:
        """Return about the time of the processor [s] that the way up takes, from that of some of its slips."""
        begin = time.process_time()
        few = self._few
        loaded = time.process_time()
        try:
            few.find(
                np.array(
                    [
                        slip_from_logit(place)
                        for place in np.linspace(_LOW, logit_slip(largest), _SOME).tolist()
                    ]
                )
            )
        except DomainError:  # at the end of the range a law has no value
            if largest < _NOWHERE:
                raise
            return self.seconds(0.5 * largest)
        return (
            loaded
            - begin
            + _ALL * (_RUBBED if self._rubbing else 1.0) * (time.process_time() - loaded)
        )

    def has_several(self, slip: float) -> bool:
        """Whether rollers have several motions at a cage slip, or none that settles, and the way up has to be known."""
        with contextlib.suppress(DomainError):
            return not self.rolls_freely and not _settled(self._few.find(np.array([slip]))[0])
        return False

    @property
    def rolls_freely(self) -> bool:
        """Whether nothing resists: no torque on the cage and no resistance to rolling."""
        return not self.drags.torques and not self.assembly.inner.chain.resists

    def with_inertia(self, inertia: bool) -> "TorqueBalance":
        """Return the same balance of rollers with or without inertia of their spin."""
        return TorqueBalance(
            self.assembly,
            self.drags,
            n_positions=self.n_positions,
            effective=self.effective,
            inertia=inertia,
        )

    def cage_speed(self, cage_slip: float) -> float:
        """Cage speed [rad/s] in the sense of the kinematics."""
        return self.assembly.kinematics.epicyclic_cage_speed * (1.0 - cage_slip)

    def drag(self, cage_slip: float) -> float:
        """Torque of all drags on the cage [N m], negative where it resists the orbit."""
        k = self.assembly.kinematics
        torque = self.drags.torque(
            k.direction * self.cage_speed(cage_slip), k.inner_speed, k.outer_speed
        )
        return self.motions.sense * k.direction * torque

    def torque(self, cage_slip: float) -> float:
        """Mean torque of all rollers on the cage [N m], positive where it drives."""
        return self.orbit(cage_slip).torque

    def excess(self, cage_slip: float) -> float:
        """Torque that is left over to speed the cage up [N m]: zero at a steady slip."""
        return self.torque(cage_slip) + self.drag(cage_slip)

    def orbit(self, cage_slip: float) -> Orbit:
        """Return the steady motion of the rollers at a cage slip, on the way up where they have several."""
        if cage_slip not in self._known:
            self._known[cage_slip] = self.orbit_of(self._on_way(cage_slip))
        return self._known[cage_slip]

    def torques(self, cage_slips: Array, *, few: bool = False) -> Array:
        """Return the torques on the cage at several slips [N m], (n,), on the way up through these alone.

        By few loads of a roller it is as exact as the way up is while it is searched.
        """
        motions = self._few if few else self.motions
        out = np.empty(cage_slips.size)
        order = np.argsort(cage_slips)
        below = None
        found = motions.find(cage_slips[order])
        for k, here in zip(order.tolist(), found, strict=True):
            if not _settled(here):
                known = below or self._below(float(cage_slips[k]))
                here = motions.find(cage_slips[k : k + 1], known.fraction[:1])[0]
            below = here[0]
            out[k] = below.torque
        return out

    def _below(self, slip: float) -> Motion:
        """The motion of the way up at the next slip below one."""
        return self.loading_branch(max(RANGE, slip)).motion_below(slip)

    def _on_way(self, slip: float) -> Motion:
        """The motion of the way up at a slip."""
        here = self.motions.find(np.array([slip]))[0]
        return (
            here[0]
            if _settled(here)
            else self.motions.find(np.array([slip]), self._below(slip).fraction[:1])[0][0]
        )

    def orbit_of(self, motion: Motion) -> Orbit:
        """Return a motion on all slices, such as that of a steady slip, with the forces in it."""
        contacts = self.contacts(motion.slip)
        tractions, _ = self._forces(motion.slip, motion.roller_slip, contacts)
        return Orbit(
            cage_slip=motion.slip,
            torque=motion.torque,
            roller_slip=motion.roller_slip,
            force=np.array([of_ring.contacts.carried for of_ring in contacts]),
            traction=self.motions.sense * tractions,
            multiplier=motion.multiplier,
            brakes=motion.brakes,
        )

    def contacts(self, cage_slip: float) -> tuple[ConventionalFriction, ConventionalFriction]:
        """Contacts of both raceways, their positions ordered in the sense of the orbit."""
        return self.motions.contacts(np.array([cage_slip]))

    def evaluated(self, orbit: Orbit) -> tuple[LoadedContacts, LoadedContacts]:
        """Return the loaded contacts of both raceways, evaluated in the motion of the rollers."""
        contacts = self.contacts(orbit.cage_slip)
        speeds = self.assembly.kinematics.surface_speeds(orbit.cage_slip, orbit.roller_slip)
        contacts[0](speeds.inner_rolling, speeds.inner_sliding)
        contacts[1](speeds.outer_rolling, speeds.outer_sliding)
        return contacts[0].contacts, contacts[1].contacts

    def forces(self, orbit: Orbit) -> tuple[Array, Array, Array]:
        """Return tractions and resistances of both contacts [N], (2, K), and torques on the cage [N m], (K,).

        They have the signs of the kinematics, whatever the sense of the orbit.
        """
        tractions, resistances = self._forces(
            orbit.cage_slip, orbit.roller_slip, self.contacts(orbit.cage_slip)
        )
        kernel = self.motions.spins(np.array([orbit.cage_slip]), brakes=orbit.brakes).kernel
        return tractions, resistances, kernel.on_cage(orbit.roller_slip, tractions, resistances)

    def _forces(
        self,
        cage_slip: float,
        roller_slip: Array,
        contacts: tuple[ConventionalFriction, ConventionalFriction],
    ) -> tuple[Array, Array]:
        """Tractions and resistances of both contacts [N], (2, K)."""
        speeds = self.assembly.kinematics.surface_speeds(cage_slip, roller_slip)
        inner, outer = self.motions.frictions(contacts)
        on_inner = inner(speeds.inner_rolling, speeds.inner_sliding)
        on_outer = outer(speeds.outer_rolling, speeds.outer_sliding)
        return np.stack([on_inner[0], on_outer[0]]), np.stack([on_inner[1], on_outer[1]])


def minimum_positions(assembly: Assembly) -> int:
    """Return the instants of a pitch on which rollers are followed at least: those of 56 positions."""
    return -(-_POSITIONS[0] // assembly.scene.bearing.rollers)


def rollers(
    assembly: Assembly,
    n_positions: int,
    *,
    effective: bool = False,
    inertia: bool = True,
    beside: TorqueBalance | None = None,
) -> TorqueBalance:
    """Return the balance of torques of a bearing, with all that resists its rollers, on 56 to 512 positions.

    What positions leave of a maximum is looked at by more of them; means over a pitch may need more of its instants.
    """
    drags = assembly.cage.drags
    assembly = assembly.with_resistance()
    n_positions = min(
        max(n_positions, minimum_positions(assembly)),
        -(-_POSITIONS[1] // assembly.scene.bearing.rollers),
    )
    curves = effective_curves(assembly, n_positions) if effective else None
    return TorqueBalance(
        assembly, drags, n_positions=n_positions, effective=curves, inertia=inertia, beside=beside
    )


def look_along(assembly: Assembly, end: float, *, inertia: bool = True) -> None:
    """Evaluate the contacts of rollers at some slips of the way up: what watches the chains of the bearing sees them.

    Its search is compiled and looks at no bound.
    """
    balance = rollers(assembly, 1, inertia=inertia)
    for fraction in _LOOKED_AT:
        try:
            balance.evaluated(balance.orbit(fraction * end))
        except (DomainError, ConvergenceError):  # where it ends; a run says so
            return


@attrs.frozen
class SkiddingOnset:
    """The cage slip at which a cage runs away, and the drag [N m] there: NaN where ``status`` says why.

    ``to`` is the slip to which it jumps, NaN if nothing in the range carries the drag; ``error`` is that of the drag,
    relative. ``most`` is the largest torque of the way [N m], at ``max_torque_slip``.
    """

    slip: float
    drag: float
    status: str
    slip_after: float = math.nan
    error: float = math.nan
    max_torque: float = math.nan
    max_torque_slip: float = math.nan


@attrs.frozen
class Running:
    """The least cage slip at which rollers carry the drags of a scene, and their torque [N m]; see ``status``."""

    slip: float
    drag: float
    status: str


def _settled(here: list[Motion]) -> bool:
    """Whether rollers that begin from either end come to one motion."""
    return len(here) == 1 and here[0].converged


def skidding_onset(balance: TorqueBalance, largest: float, allow: str) -> SkiddingOnset:
    """Say where the cage of a bearing runs away, up to the largest cage slip; ``allow`` is the key of that."""
    try:
        way = balance.loading_branch(largest)
    except (DomainError, ConvergenceError) as error:
        return SkiddingOnset(
            math.nan, math.nan, f"{Status.NOT_KNOWN} where skidding begins: {error}"
        )
    slip, torque = way.maximum
    if (jump := way.skidding_jump) is not None:
        return SkiddingOnset(
            jump.slip, jump.drag, Status.FOUND, jump.slip_after, jump.error, torque, slip
        )
    return SkiddingOnset(
        math.nan, math.nan, nowhere(way, allow), max_torque=torque, max_torque_slip=slip
    )


def nowhere(way: LoadingBranch, allow: str) -> str:
    """Say that a cage runs away nowhere in the range, and why, or what to type to look further."""
    slip, torque = way.maximum
    if not torque > 0.0:
        return f"{Status.NOT_DRIVEN} at any slip up to {way.end:.4g}: more resists their rolling"
    further = f"beyond, {way.refusal}" if way.refusal else f"raise {allow} to look further"
    if way.end > _STANDS and not way.refusal:
        further = "there it all but stands"
    where = "where" if slip == way.end else f"and at {slip:.3g}"
    carried = format_quantity(torque, "N m", 3)
    return (
        f"no skidding up to a slip of {way.end:.4g}, {where} the rollers carry the "
        f"largest drag, {carried}; {further}"
    )


def running(balance: TorqueBalance, largest: float = RANGE) -> Running:
    """Locate the least cage slip at which the rollers of a bearing carry the drags of its scene.

    Without any drag it is zero, and below where the cage is driven faster than its epicyclic speed.
    """
    if balance.rolls_freely:
        return Running(0.0, 0.0, Status.FOUND)
    try:
        way = balance.loading_branch(largest)
        steady = next(iter(way.find_steady_motions(balance.drag)), None)
    except (DomainError, ConvergenceError) as error:
        return Running(
            math.nan, math.nan, f"{Status.NOT_KNOWN} at which slip the cage runs: {error}"
        )
    if steady is not None:
        return Running(steady.slip, steady.torque, Status.FOUND)
    if way.torque_without_slip + balance.drag(0.0) > 0.0:
        return Running(
            math.nan, math.nan, f"{Status.DRIVEN}: it runs at more than twice its epicyclic speed"
        )
    slip, torque = way.maximum
    drag, carried = (format_quantity(one, "N m", 3) for one in (-balance.drag(slip), torque))
    return Running(
        math.nan,
        math.nan,
        f"{Status.NO_STEADY_SLIP} up to {way.end:.4g}: where the rollers carry most, {carried} at a slip of "
        f"{slip:.3g}, the drags of the scene are {drag}",
    )


@attrs.frozen
class Reserve:
    """Largest drag that the rollers carry over the drags of a scene; below 1 the cage skids.

    ``status`` begins with `Status.FOUND`, `AT_LEAST` or `SKIDS`; else it says why there is none, and the factor is NaN.
    """

    factor: float
    status: str


def reserve(
    balance: TorqueBalance, away: SkiddingOnset, runs: Running, largest: float = RANGE
) -> Reserve:
    """Return the reserve of drag: the drag with which the cage runs away over that of the scene where it runs.

    Where nothing runs away up to the end of the range, the most that the rollers carry is carried at least, and over
    the drags where the cage runs, or without slip where these are larger, it is a lower bound: drags that fall with
    slip, as churning does, would let a cage that has slowed down look safe. With a balance it is 1 at least: a cage
    that runs ahead has the drags without slip, by which it comes before it skids. Where the cage has no balance, or
    runs beyond the slip of running away, it is less than 1: the torque at the most favourable slip of the way over the
    drags there.
    """
    outcome = Status.of(runs.status)
    if outcome is Status.FOUND and not runs.slip > away.slip:  # NaN where there is no fold
        drag = -balance.drag(0.0) if runs.slip < 0.0 else runs.drag
        if not drag > 0.0:
            return Reserve(
                math.inf,
                f"{Status.AT_LEAST}: no torque drags the cage{' without slip' * (runs.slip < 0.0)}",
            )
        if not math.isnan(away.slip):
            return Reserve(away.drag / drag, Status.FOUND)
        if math.isnan(away.max_torque):
            return Reserve(math.nan, away.status)
        said = f"{Status.AT_LEAST}: no skidding up to a slip of {balance.loading_branch(largest).end:.4g}"
        return Reserve(max(away.max_torque / max(runs.drag, -balance.drag(0.0)), 1.0), said)
    if outcome is Status.DRIVEN:
        return Reserve(math.inf, f"{Status.AT_LEAST}: {runs.status}")
    if outcome not in (Status.FOUND, Status.NO_STEADY_SLIP):
        return Reserve(math.nan, runs.status)
    slips, torques = balance.loading_branch(largest).curve
    fractions = [torque / -balance.drag(slip) for slip, torque in zip(slips, torques, strict=True)
              if torque > 0.0 and balance.drag(slip) < 0.0]  # fmt: skip
    return Reserve(
        min(max(fractions, default=0.0), 1.0),
        f"{Status.SKIDS}: its drags are more than the rollers carry",
    )


def near_skidding(assembly: Assembly, slip: float) -> str:
    """Say what effective friction leaves unknown of a cage at a slip; empty where it is far from running away.

    Effective friction is off by some share of the largest drag. The cage is near where the drag that it carries at the
    slip is less than twice that share below the largest one by either friction. Where it is less than half of it,
    effective friction is not asked: it is off by 23 % at most (docs/tables/skidding_effective_summary.csv).
    """
    balance = rollers(assembly, 1)
    exact = skidding_onset(balance, RANGE, "")
    carried = balance.torque(slip) if slip > 0.0 else 0.0
    if slip < exact.slip and carried < _FAR * exact.drag:
        return ""
    simple = skidding_onset(rollers(assembly, 1, effective=True), RANGE, "")
    known = [one for one in (exact, simple) if not math.isnan(one.slip)]
    if not known:
        return ""
    off = abs(simple.drag / exact.drag - 1.0) if len(known) == 2 else math.inf
    least = min(known, key=lambda one: one.drag)
    if slip < least.slip and carried < (1.0 - 2.0 * min(off, 0.5)) * least.drag:
        return ""
    begins = f"{100.0 * known[0].slip:.3g} %"
    where = f"with a cage slip of {100.0 * slip:.3g} % the cage is near skidding, which begins at {begins}"
    if len(known) < 2:
        return f"{where}, and it does so by one of both frictions alone"
    return f"{where}, where effective friction is off by {100.0 * off:.2g} % of the drag"


def effective_curves(assembly: Assembly, n_positions: int) -> tuple[EffectiveCurve, EffectiveCurve]:
    """Return the effective friction curves of both raceways, with the loads at epicyclic speed."""
    loads = assembly.load_distribution(n_positions)
    tolerance = assembly.resolution.table_tolerance

    def of(raceway: Raceway, load: Array) -> EffectiveCurve:
        table = effective_table(
            assembly, raceway, load.reshape(-1, load.shape[2]), 0.1 * tolerance, slips=False
        )
        return EffectiveCurve(table.nodes, table.limits, table.sliding_scale)

    return of(assembly.inner, loads.inner_load), of(assembly.outer, loads.outer_load)
