"""Balance of the torques on a cage that runs at a constant speed, without integration over time.

- One revolution of the cage is much shorter than its transient. At a steady slip its speed is therefore constant, and
  every roller repeats the same motion once per orbit. The spin of one roller over one orbit remains, periodic::

      J |w_c| ds/dtheta = G,   G = r (F_i - F_Ri) - r (F_o + F_Ro) - M
      T = Z <G + R_i (F_i + F_Ri) + R_o (F_o - F_Ro)>,   M = mu_p |P| r,   R_m P = G + M + R_i (...) + R_o (...)

  Under axial load the friction of ribs, at the height h above the raceways, adds (r - h) (F_fi - F_fo) to G, and
  (R_i + h) F_fi + (R_o - h) F_fo to the torques on the rings and so to T.

  with s the absolute spin, theta the position in the sense of the orbit, F = mu Q the tractions, F_R the rolling
  resistances (against rolling on both surfaces), M the friction of the roller in its pocket under the force P that
  moves it along the orbit, and < > the mean over the orbit. T drives the cage.
- Of several periodic motions the one of the loading branch is taken, in which rollers are while the drag is raised
  from zero: `motion.spins` finds motions, `motion.loading_branch` their order. Torques at several slips follow the
  branch from one of these slips to the next, so that at slips with several motions they are those of the slips that are
  requested together. They do not depend on earlier calls.
- The loads are solved again at every slip, because centrifugal forces are proportional to the square of the cage speed.
"""

import contextlib
import math
import time
from functools import cached_property
from typing import Final, Protocol

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.drags import Drags
from rollslip.bearing.raceway import Array, LoadedContacts, Raceway
from rollslip.errors import ConvergenceError, DomainError
from rollslip.results.text import SMALLEST_SLIP, Status
from rollslip.results.verdict import SKIDDING_SLIP
from rollslip.units import format_quantity
from rollslip_studies.motion.effective_table import EffectiveTable, effective_table
from rollslip_studies.motion.loading_branch import (
    SEARCH,
    LoadingBranch,
    SteadyMotion,
    find_loading_branch,
)
from rollslip_studies.motion.spins import (
    ConventionalFriction,
    Motion,
    Motions,
    logit_slip,
    slip_from_logit,
)

# The time of a loading branch is estimated from that of some of its slips.

#: Number of slips whose time is measured, from the smallest of the branch on. Doubling it doubles the time of the
#: estimate, and `_COST_WHOLE` had to be halved; chosen, so that these take about a tenth of the search.
_COST_SLIPS: Final = 6
#: Ratio of the time of the whole search, with its maxima, to that of the measured slips: 5 to 20, and 9 in the median,
#: of 34 random bearings; 10 to 107, by the contacts evaluated, of five without a cage. The estimate is in proportion.
_COST_WHOLE: Final = 10.0

#: Smallest number of positions of an orbit on which rollers are followed. Doubling it doubles the time; chosen,
#: because the change by four times as many positions is part of stated errors, 1.4e-3 in the median of 79 bearings.
_MIN_ORBIT_POSITIONS: Final = 56
#: Largest number of positions of an orbit: a larger request is cut to the next number of roller positions within a
#: pitch that makes as many. Doubling it doubles the time of such a request and changes no other; chosen, nine times
#: the minimum.
_MAX_ORBIT_POSITIONS: Final = 512
#: Slips, relative to the end of a loading branch, at which validity ranges of laws are checked. Twice as many would
#: double the time of that; chosen, denser at small slips, where friction rises.
_CHECKED_SLIPS: Final = (0.0, 0.02, 0.15, 0.5, 1.0)
#: Fraction of the limit drag below which a cage is far from skidding, whatever the error of effective friction: with
#: the largest error e, 23 % (docs/tables/skidding_effective_summary.csv), both frictions have to be compared from
#: 1 - 2 e on, 54 %. Half the value compares them more often; twice the value never below the limit drag.
_FAR: Final = 0.5
#: Tolerance of effective friction curves in a torque balance, over that of other tables. Twice the value changes
#: torques of two bearings at slips below 0.1 % by up to 1.9e-2, above the tolerance 1e-2 of other tables; a tenth of it
#: takes up to 1.5 times the time of a branch. Chosen, so that the errors, up to 4e-3, are below that tolerance.
_CURVE_TOLERANCE_FRACTION: Final = 0.1
#: Slip from which on the cage hardly turns, so that no larger range is proposed. Chosen, just below `RANGE`.
_NEARLY_STILL: Final = 0.94
#: Largest slip of a loading branch unless a larger range is requested: there the cage nearly stands still. Chosen;
#: with twice the distance from 1, a slip of 0.9, limit drags at larger slips would be missed.
RANGE: Final = 0.95
#: Slip over a likely one up to which a loading branch is searched first. Twice as much searches three more steps of the
#: grid; half as much searches the whole range more often. Chosen.
_LIKELY_RANGE: Final = 3.0


class CageTorques(Protocol):
    """Torques of rollers and of drags on a cage against its slip."""

    def torques(self, cage_slips: Array) -> Array:
        """Return the torques of the rollers at several cage slips [N m], (n,), positive where they drive."""

    def drag(self, cage_slip: float) -> float:
        """Return the torque of all drags at a cage slip [N m], negative where it resists."""


@attrs.frozen(eq=False, kw_only=True)
class Orbit:
    """Motion and forces of one roller over an orbit at a steady cage slip, and the torque of all on the cage."""

    cage_slip: float  # S_c [-]
    torque: float  # mean torque of all rollers on the cage [N m], positive where it drives the cage in its sense
    roller_slip: Array  # S_r at the positions of the orbit, in its sense, (K,)
    force: Array  # normal force of inner and outer contact [N], (2, K)
    traction: Array  # of inner and outer contact [N], (2, K), positive where it drives
    #: Floquet's multiplier of the spin: the motion is stable if it is below 1 in size. Whether a steady slip is stable
    #: is decided by it and by the slope of the excess torque: `steady_slip.slip_drag.describe_stability`.
    multiplier: float
    #: Moments by which neighbours brake the spin, without a cage [N m], (K,).
    brakes: Array | None = None


class TorqueBalance:
    """Torques of rollers and drag on the cage of one bearing against its slip."""

    def __init__(
        self,
        assembly: Assembly,  # the bearing
        # Resistances of the cage and in the pockets; rolling resistance is a stage of the chains of the bearing.
        drags: Drags,
        *,
        n_positions: int,  # roller positions within a pitch; the orbit has Z times as many
        # Friction curves of inner and outer raceway in place of the whole chain; `effective_curves`.
        effective: tuple[EffectiveTable, EffectiveTable] | None = None,
        # False for rollers without inertia of their spin, whose contacts balance at every position.
        inertia: bool = True,
        # The balance of a similar bearing, whose rollers slip about as much without cage slip.
        similar: "TorqueBalance | None" = None,
    ) -> None:
        self.assembly = assembly
        self.drags = drags
        self.n_positions = n_positions
        self._similar = similar
        self.effective = effective
        self.inertia = inertia
        self._orbits: dict[float, Orbit] = {}
        self._branches: dict[float, LoadingBranch] = {}

    @cached_property
    def motions(self) -> Motions:
        """Motions of the rollers on all slices, their loads solved at every slip."""
        friction = self.drags.pocket_friction
        return Motions(
            self.assembly,
            self.n_positions,
            pocket=0.0 if friction is None else friction.coefficient,
            rubbing=self.assembly.scene.models.neighbour_friction or 0.0,
            effective=self.effective,
            inertia=self.inertia,
            similar=None if self._similar is None else self._similar.motions,
        )

    @cached_property
    def _reduced_motions(self) -> Motions:
        """Motions by a few loads of a roller, which stand for its slices."""
        return self.motions.with_resolution(self.n_positions, SEARCH.n_loads)

    def loading_branch(self, max_slip: float = RANGE) -> LoadingBranch:
        """Return the loading branch up to a largest cage slip; see `find_loading_branch`."""
        if max_slip not in self._branches:
            self._branches[max_slip] = find_loading_branch(
                self._reduced_motions, max_slip, self.motions
            )
        return self._branches[max_slip]

    def steady_motions(
        self, max_slip: float, likely_slip: float
    ) -> tuple[LoadingBranch, list[SteadyMotion]]:
        """Return the loading branch, as far as it was searched, and its steady motions with the drags.

        Parameters
        ----------
        max_slip : float
            Largest cage slip.
        likely_slip : float
            Slip of a similar bearing: the branch is searched up to a multiple of it, and beyond that only if it has no
            stable motion there.
        """
        near = min(_LIKELY_RANGE * max(abs(likely_slip), SMALLEST_SLIP), max_slip)
        branch = self.loading_branch(near)
        motions = branch.find_steady_motions(self.drag)
        if near < max_slip and not any(motion.slope > 0.0 for motion in motions):
            branch = self.loading_branch(max_slip)
            motions = branch.find_steady_motions(self.drag)
        return branch, motions

    def branch_torques(self, slips: Array) -> Array:
        """Return the torques of the loading branch at slips of `branch_slips` [N m]; NaN beyond its end or without it.

        Parameters
        ----------
        slips : ndarray
            Cage slips from zero, ascending to the end of the range, (n,).
        """
        torques = np.full(slips.size, np.nan)
        with contextlib.suppress(DomainError, ConvergenceError):
            branch_slips, branch_torques = self.loading_branch(float(slips[-1])).torque_curve
            torques = np.interp(slips, branch_slips, branch_torques, right=np.nan)
            torques[:1] = self.torques_from_zero(slips[:1])
        return torques

    def torques_from_zero(self, slips: Array) -> Array:
        """Return the torques on the cage at ascending slips [N m], by a few loads of a roller like the loading branch.

        Parameters
        ----------
        slips : ndarray
            Cage slips, (n,).
        """
        torques = np.zeros(slips.size)
        if (braked := (slips != 0.0) | self.motions.resists).any():
            torques[braked] = self.torques(slips[braked], reduced=True)
        return torques

    def seconds(self, max_slip: float = RANGE) -> float:
        """Return an estimate of the processor time [s] of the loading branch up to a cage slip.

        It is the measured time of loads and contacts, and a multiple of that of the motions at some slips. Where a law
        has no value at one of these the branch ends early, so that the time is that of half the range. It is halved as
        long as it contains the smallest slip of the search.
        """
        start = time.process_time()
        motions = self._reduced_motions
        loaded = time.process_time()
        logits = np.linspace(logit_slip(SEARCH.smallest_slip), logit_slip(max_slip), _COST_SLIPS)
        try:
            motions.find(np.array([slip_from_logit(logit) for logit in logits.tolist()]))
        except DomainError:
            if max_slip < SEARCH.smallest_slip:
                raise
            return self.seconds(0.5 * max_slip)
        return loaded - start + _COST_WHOLE * (time.process_time() - loaded)

    def has_several_motions(self, slip: float) -> bool:
        """Whether rollers have several motions at a cage slip, or none that converges, so that the branch decides."""
        with contextlib.suppress(DomainError):
            return not (
                self.rolls_freely or _is_unique(self._reduced_motions.find(np.array([slip]))[0])
            )
        return False

    @property
    def rolls_freely(self) -> bool:
        """Whether nothing resists: neither a torque on the cage nor rolling resistance, so that it has no slip."""
        resists = self.assembly.inner.chain.resists or self.assembly.ribs is not None
        return not self.drags.torques and not resists

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
        sense = 1.0 if k.epicyclic_cage_speed > 0.0 else -1.0
        return sense * k.direction * torque

    def torque(self, cage_slip: float) -> float:
        """Mean torque of all rollers on the cage [N m], positive where it drives."""
        return float(self.torques(np.array([cage_slip]))[0])

    def excess(self, cage_slip: float) -> float:
        """Torque of the rollers in excess of the drags [N m], which accelerates the cage: zero at a steady slip."""
        return self.torque(cage_slip) + self.drag(cage_slip)

    def orbit(self, cage_slip: float) -> Orbit:
        """Return the motion of the rollers at a steady cage slip, on the loading branch where they have several."""
        if cage_slip not in self._orbits:
            (motion,) = self._find_on_branch(self.motions, np.array([cage_slip]))
            self._orbits[cage_slip] = self.orbit_from_motion(motion)
        return self._orbits[cage_slip]

    def torques(self, cage_slips: Array, *, reduced: bool = False) -> Array:
        """Return the torques on the cage at several slips [N m], (n,), on the loading branch through these alone.

        Parameters
        ----------
        cage_slips : ndarray
            Cage slips, (n,).
        reduced : bool
            By a few loads of a roller, as the loading branch is searched, instead of all slices.
        """
        motions = self._reduced_motions if reduced else self.motions
        torques = np.empty(cage_slips.size)
        order = np.argsort(cage_slips)
        found = self._find_on_branch(motions, cage_slips[order])
        torques[order] = [motion.torque for motion in found]
        return torques

    def _find_on_branch(self, motions: Motions, slips: Array) -> list[Motion]:
        """The motions of the loading branch at ascending slips, (n,).

        Where rollers have several motions they are marched from the motion at the previous one of these slips, and at
        the first slip from the motion of the branch below.
        """
        found = list[Motion]()
        for slip, candidates in zip(slips.tolist(), motions.find(slips), strict=True):
            if not _is_unique(candidates):
                starts = found[-1:] or [self.loading_branch(max(RANGE, slip)).motion_below(slip)]
                candidates = motions.find_from([slip], starts[0])
            found.append(candidates[0])
        return found

    def orbit_from_motion(self, motion: Motion) -> Orbit:
        """Return a motion that was found on all slices, such as that of a steady slip, with its forces."""
        contacts = self.contacts(motion.slip)
        tractions, _ = self._forces(motion.slip, motion.roller_slip, contacts)
        return Orbit(
            cage_slip=motion.slip,
            torque=motion.torque,
            roller_slip=motion.roller_slip,
            force=np.array([ring.contacts.carried for ring in contacts]),
            traction=self.motions.sense * tractions,
            multiplier=motion.multiplier,
            brakes=motion.brakes,
        )

    def contacts(self, cage_slip: float) -> tuple[ConventionalFriction, ConventionalFriction]:
        """Contacts of both raceways, their positions ordered in the sense of the orbit."""
        return self.motions.contacts(np.array([cage_slip]))

    def evaluate_contacts(self, orbit: Orbit) -> tuple[LoadedContacts, LoadedContacts]:
        """Return the loaded contacts of both raceways, evaluated in the motion of the rollers."""
        contacts = self.contacts(orbit.cage_slip)
        speeds = self.assembly.kinematics.surface_speeds(orbit.cage_slip, orbit.roller_slip)
        contacts[0](speeds.inner_rolling, speeds.inner_sliding)
        contacts[1](speeds.outer_rolling, speeds.outer_sliding)
        return contacts[0].contacts, contacts[1].contacts

    def forces(self, orbit: Orbit) -> tuple[Array, Array, Array]:
        """Return tractions and resistances of both contacts [N], (2, K), and torques on the cage [N m], (K,).

        They have the signs of the kinematics, whatever the sense of the orbit. Torques follow from forces alone: of the
        compiled spins only radii, pockets and brakes by neighbours are used, and no contact is evaluated.
        """
        tractions, resistances = self._forces(
            orbit.cage_slip, orbit.roller_slip, self.contacts(orbit.cage_slip)
        )
        kernel = self.motions.spins(np.array([orbit.cage_slip]), brakes=orbit.brakes).kernel
        return tractions, resistances, kernel.on_cage(orbit.roller_slip, tractions, resistances)

    def rib_forces(self, orbit: Orbit) -> tuple[Array, Array]:
        """Return friction [N] and sliding speeds [m/s] of both ribs, (2, K); empty without axial load.

        Parameters
        ----------
        orbit : Orbit
            The motion of the rollers.
        """
        if (ribs := self.motions.ribs) is None:
            return np.zeros((0, 0)), np.zeros((0, 0))
        self.contacts(orbit.cage_slip)
        kernel = self.motions.spins(np.array([orbit.cage_slip])).kernel
        speeds = ribs.sliding_speeds(orbit.cage_slip, orbit.roller_slip)
        return kernel.rib_forces(orbit.roller_slip), speeds

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


def _positions_within_pitch(assembly: Assembly, positions: int) -> int:
    """Roller positions within a pitch that make at least so many of the orbit."""
    return -(-positions // assembly.scene.bearing.rollers)


def minimum_positions(assembly: Assembly) -> int:
    """Return the smallest number of roller positions within a pitch: 56 positions of the orbit."""
    return _positions_within_pitch(assembly, _MIN_ORBIT_POSITIONS)


def torque_balance(
    assembly: Assembly,
    n_positions: int,
    *,
    effective: bool = False,
    inertia: bool = True,
    similar: TorqueBalance | None = None,
) -> TorqueBalance:
    """Return the torque balance of a bearing, with all resistances of its rollers, on 56 to 512 positions.

    Few positions suffice for a maximum of the torque, whose error is estimated by four times as many. Means over a
    pitch may need more.

    Parameters
    ----------
    assembly : Assembly
        The bearing.
    n_positions : int
        Roller positions within a pitch.
    effective : bool
        By effective friction instead of the whole chain.
    inertia : bool
        With the inertia of the spin.
    similar : TorqueBalance, optional
        Of a similar bearing, whose rollers slip about as much without cage slip.
    """
    drags = assembly.cage.drags
    assembly = assembly.with_resistance()
    n_positions = min(
        max(n_positions, minimum_positions(assembly)),
        _positions_within_pitch(assembly, _MAX_ORBIT_POSITIONS),
    )
    return TorqueBalance(
        assembly,
        drags,
        n_positions=n_positions,
        effective=effective_curves(assembly, n_positions) if effective else None,
        inertia=inertia,
        similar=similar,
    )


def evaluate_on_branch(assembly: Assembly, end: float, *, inertia: bool = True) -> None:
    """Evaluate the contacts of rollers at some slips of the loading branch, so that validity ranges are checked.

    The search for the branch is compiled and checks none.

    Parameters
    ----------
    assembly : Assembly
        The bearing, whose chains are observed.
    end : float
        Largest cage slip.
    inertia : bool
        With the inertia of the spin.
    """
    balance = torque_balance(assembly, 1, inertia=inertia)
    for fraction in _CHECKED_SLIPS:
        try:
            balance.evaluate_contacts(balance.orbit(fraction * end))
        except (DomainError, ConvergenceError):  # at the end of the range, which a run reports
            return


@attrs.frozen
class SkiddingOnset:
    """The cage slip at which skidding starts, and the drag there."""

    slip: float  # NaN where ``status`` says why
    drag: float  # [N m], NaN likewise
    status: str  # begins with a member of `Status`
    #: Slip to which the cage jumps, NaN if none in the range carries the drag.
    slip_after: float = math.nan
    error: float = math.nan  # of the drag, relative
    max_torque: float = math.nan  # largest torque of the loading branch [N m]
    max_torque_slip: float = math.nan  # its slip


@attrs.frozen
class SteadyOperation:
    """The smallest cage slip at which rollers carry the drags of a scene."""

    slip: float  # NaN where ``status`` says why
    drag: float  # torque that they carry [N m], NaN likewise
    status: str  # begins with a member of `Status`


def _is_unique(motions: list[Motion]) -> bool:
    """Whether rollers reach one motion from rolling on either ring."""
    return len(motions) == 1 and motions[0].converged


def skidding_onset(balance: TorqueBalance, max_slip: float, range_key: str) -> SkiddingOnset:
    """Return where skidding starts on the loading branch.

    Parameters
    ----------
    balance : TorqueBalance
        Of the bearing.
    max_slip : float
        Largest cage slip.
    range_key : str
        Key of a scene which sets the largest slip, for the message where the cage does not skid.
    """
    try:
        branch = balance.loading_branch(max_slip)
    except (DomainError, ConvergenceError) as error:
        return SkiddingOnset(
            math.nan, math.nan, f"{Status.NOT_KNOWN} where skidding begins: {error}"
        )
    slip, torque = branch.maximum
    if (jump := branch.skidding_jump) is None:
        status = describe_no_skidding(branch, range_key)
        return SkiddingOnset(math.nan, math.nan, status, max_torque=torque, max_torque_slip=slip)
    return SkiddingOnset(
        jump.slip, jump.drag, Status.FOUND, jump.slip_after, jump.error, torque, slip
    )


def describe_no_skidding(branch: LoadingBranch, range_key: str) -> str:
    """Return why a cage skids nowhere in the range, and how to extend the range.

    Parameters
    ----------
    branch : LoadingBranch
        Without a jump to skidding.
    range_key : str
        Key of a scene which sets the largest slip.
    """
    slip, torque = branch.maximum
    if not torque > 0.0:
        return f"{Status.NOT_DRIVEN} at any slip up to {branch.end:.4g}: more resists their rolling"
    if branch.refusal:
        further = f"beyond, {branch.refusal}"
    elif branch.end > _NEARLY_STILL:
        further = "there the cage nearly stands still"
    else:
        further = f"raise {range_key} to look further"
    where = "where" if slip == branch.end else f"and at {slip:.3g}"
    return (
        f"no skidding up to a slip of {branch.end:.4g}, {where} the rollers carry the "
        f"largest torque, {format_quantity(torque, 'N m', 3)}; {further}"
    )


def running(balance: TorqueBalance, max_slip: float = RANGE) -> SteadyOperation:
    """Return the smallest cage slip at which the rollers of a bearing carry the drags of its scene.

    Without any drag it is zero, and it is negative where the cage is driven beyond its epicyclic speed.

    Parameters
    ----------
    balance : TorqueBalance
        Of the bearing.
    max_slip : float
        Largest cage slip.
    """
    if balance.rolls_freely:
        return SteadyOperation(0.0, 0.0, Status.FOUND)
    try:
        branch = balance.loading_branch(max_slip)
        steady = next(iter(branch.find_steady_motions(balance.drag)), None)
    except (DomainError, ConvergenceError) as error:
        return SteadyOperation(
            math.nan, math.nan, f"{Status.NOT_KNOWN} at which slip the cage runs: {error}"
        )
    if steady is not None:
        return SteadyOperation(steady.slip, steady.torque, Status.FOUND)
    if branch.torque_without_slip + balance.drag(0.0) > 0.0:
        return SteadyOperation(
            math.nan, math.nan, f"{Status.DRIVEN}: it runs at more than twice its epicyclic speed"
        )
    slip, torque = branch.maximum
    return SteadyOperation(
        math.nan,
        math.nan,
        f"{Status.NO_STEADY_SLIP} up to {branch.end:.4g}: where the rollers carry most, "
        f"{format_quantity(torque, 'N m', 3)} at a slip of {slip:.3g}, the drags of the scene are "
        f"{format_quantity(-balance.drag(slip), 'N m', 3)}",
    )


@attrs.frozen
class Reserve:
    """Drag reserve to skidding: the factor on the drags of a scene at which the cage skids; below 1 it does."""

    factor: float  # NaN where the status is another one than `Status.FOUND`, `AT_LEAST` or `SKIDS`
    status: str  # begins with a member of `Status`
    slip: float = math.nan  # slip at which torque over drags is largest, NaN without one


def reserve(
    balance: TorqueBalance,
    onset: SkiddingOnset,
    operation: SteadyOperation,
    max_slip: float = RANGE,
) -> Reserve:
    """Return the drag reserve to skidding: the largest torque of the rollers over the drags at the same slip.

    It is the factor on all drags at which the cage skids: at the onset of skidding, or at `SKIDDING_SLIP`, whatever
    comes first on the loading branch. Status and factor are

    - `AT_LEAST` and infinite, where the cage is driven, or runs below `SKIDDING_SLIP` without a drag;
    - those of what is unknown and NaN, where the slip of the cage or the branch is;
    - `FOUND` and at least 1, where the cage runs before skidding, or `AT_LEAST` where the branch ends before that;
    - `SKIDS` and at most 1 elsewhere.

    Parameters
    ----------
    balance : TorqueBalance
        Of the bearing.
    onset : SkiddingOnset
        Of the same bearing.
    operation : SteadyOperation
        Where the cage runs.
    max_slip : float
        Largest cage slip.
    """
    is_found = operation.status == Status.FOUND
    if operation.status.startswith(Status.DRIVEN):
        return Reserve(math.inf, f"{Status.AT_LEAST}: {operation.status}")
    if not (is_found or operation.status.startswith(Status.NO_STEADY_SLIP)):
        return Reserve(math.nan, operation.status)
    is_driven = operation.slip < 0.0
    drag = -balance.drag(0.0) if is_driven else operation.drag
    if is_found and not drag > 0.0 and not operation.slip > SKIDDING_SLIP:
        where = " without slip" if is_driven else ""
        return Reserve(math.inf, f"{Status.AT_LEAST}: no torque drags the cage{where}")
    try:
        slips, torques = balance.loading_branch(max_slip).torque_curve
    except (DomainError, ConvergenceError):
        return Reserve(math.nan, onset.status)
    limit = SKIDDING_SLIP if math.isnan(onset.slip) else min(SKIDDING_SLIP, onset.slip)
    factor, slip = largest_ratio(balance, slips, torques, limit)
    if onset.slip <= limit:  # an end of the branch is no slip of a smooth curve
        factor, slip = max((factor, slip), (_ratio(balance, onset.slip, onset.drag), onset.slip))
    if not (is_found and operation.slip <= limit):
        status = (
            f"{Status.SKIDS}: its drags, or the rolling resistance, are more than the rollers carry"
        )
        return Reserve(min(factor, 1.0), status, slip)
    if slips[-1] < limit:
        status = f"{Status.AT_LEAST}: no skidding up to a slip of {slips[-1]:.4g}"
        return Reserve(max(factor, 1.0), status, slip)
    return Reserve(max(factor, 1.0), Status.FOUND, slip)


def largest_ratio(
    balance: CageTorques, slips: Array, torques: Array, limit: float
) -> tuple[float, float]:
    """Return the largest ratio of torque and drags, and its slip; 0 where none is positive.

    Beside the points of a curve the ratio is evaluated at the limit, and at the vertex of the parabola through the
    largest one and its neighbours, in the logarithm of the slip.

    Parameters
    ----------
    balance : CageTorques
        Torques at other slips, and drags.
    slips, torques : ndarray of float, (n,)
        A curve by ascending slips, with torques [N m].
    limit : float
        Largest slip that counts.
    """
    end = min(limit, float(slips[-1]))
    inside = (slips > 0.0) & (slips < end)
    points = [*zip(slips[inside].tolist(), torques[inside].tolist(), strict=True), (end, math.nan)]
    ratios = [(_ratio(balance, slip, torque), slip) for slip, torque in points]
    at = ratios.index(max(ratios))
    nearest = np.array(ratios[max(at - 1, 0) : at + 2])
    if len(nearest) == 3:  # the middle one is the largest
        bend, slope, _ = np.polyfit(np.log(nearest[:, 1] / nearest[1, 1]), nearest[:, 0], 2)
        vertex = nearest[1, 1] * math.exp(-0.5 * slope / bend) if bend < 0.0 else end
        ratios.append((_ratio(balance, vertex), vertex))
    return max(ratios)


def acceptable_reserve(balance: CageTorques, slip: float) -> tuple[float, str]:
    """Return the torque of the rollers over the drag at a slip [-], and its status; NaN where nothing drags the cage.

    Parameters
    ----------
    balance : CageTorques
        Torque balance of the bearing.
    slip : float
        Acceptable cage slip [-].
    """
    drag = -balance.drag(slip)
    if not drag > 0.0:
        return math.nan, f"nothing drags the cage at a slip of {slip:g}"
    try:
        return float(balance.torques(np.array([slip]))[0]) / drag, Status.FOUND
    except (DomainError, ConvergenceError) as error:
        return math.nan, str(error)


def _ratio(balance: CageTorques, slip: float, torque: float = math.nan) -> float:
    """Return the ratio of torque and drags at a slip, 0 where nothing drives or drags; a torque of NaN is evaluated."""
    if math.isnan(torque):
        with contextlib.suppress(DomainError, ConvergenceError):
            torque = float(balance.torques(np.array([slip]))[0])
    drag = -balance.drag(slip)
    return torque / drag if torque > 0.0 and drag > 0.0 else 0.0


def describe_near_skidding(assembly: Assembly, slip: float) -> str:
    """Return a warning on effective friction where a cage is near skidding; empty where it is far from it.

    The relative error of effective friction is that of its limit drag. The cage is near skidding where the drag that it
    carries at the slip is less than twice that error below the smaller limit drag of both frictions; where only one of
    them lets it skid, at any drag. Where the drag is less than half the limit drag, effective friction is not
    evaluated: its error is at most 23 % (docs/tables/skidding_effective_summary.csv).

    Parameters
    ----------
    assembly : Assembly
        The bearing.
    slip : float
        Cage slip.
    """
    balance = torque_balance(assembly, 1)
    conventional = skidding_onset(balance, RANGE, "")
    carried = balance.torque(slip) if slip > 0.0 else 0.0
    if slip < conventional.slip and carried < _FAR * conventional.drag:
        return ""
    effective = skidding_onset(torque_balance(assembly, 1, effective=True), RANGE, "")
    onsets = [onset for onset in (conventional, effective) if not math.isnan(onset.slip)]
    if not onsets:
        return ""
    error = abs(effective.drag / conventional.drag - 1.0) if len(onsets) == 2 else math.inf
    first = min(onsets, key=lambda onset: onset.drag)
    if slip < first.slip and carried < (1.0 - min(2.0 * error, 1.0)) * first.drag:
        return ""
    where = (
        f"with a cage slip of {100.0 * slip:.3g} % the cage is near skidding, which begins at "
        f"{100.0 * onsets[0].slip:.3g} %"
    )
    if len(onsets) < 2:
        return f"{where}, and it does so by one of both frictions alone"
    return f"{where}, where effective friction errs by {100.0 * error:.2g} % of the drag"


def effective_curves(assembly: Assembly, n_positions: int) -> tuple[EffectiveTable, EffectiveTable]:
    """Return the effective friction curves of both raceways, with the loads at epicyclic speed.

    Parameters
    ----------
    assembly : Assembly
        The bearing.
    n_positions : int
        Roller positions within a pitch.
    """
    loads = assembly.load_distribution(n_positions)
    tolerance = _CURVE_TOLERANCE_FRACTION * assembly.resolution.table_tolerance

    def tabulate(raceway: Raceway, load: Array) -> EffectiveTable:
        return effective_table(assembly, raceway, load.reshape(-1, load.shape[2]), tolerance)

    return tabulate(assembly.inner, loads.inner_load), tabulate(assembly.outer, loads.outer_load)
