"""Steady slip of a cage whose rollers have play in their pockets.

In a torque balance every roller orbits at the speed of the cage. A real roller leaves the unloaded zone at the bar
behind it and crosses the play c of its pocket before it drives the cage. At a constant cage speed w_c every roller
repeats the same motion in every turn of the cage::

    J s' = G - M,  m R_m^2 w' = H - R_m P,  x' = R_m (w - w_c),  psi = w_c t + x/R_m,  |x| <= c/2

with the spin s, the orbital speed w, the position x in the pocket, the torques G and H of the raceways on the spin and
along the orbit, the force P of the roller on its pocket and its friction M there. Over a turn the momentum of a roller
does not change, so that the mean of R_m P is that of H. The drags T and the rollers balance where T + Z <H - M> = 0.

1. Solve loads over the angle at every slip, and tabulate friction over force and speeds, as motions in time do.
2. March a roller round the orbit, at many slips at once, until its motion repeats. Bars do not rebound: a film of oil
   damps them.
3. Search the smallest slip, from above zero, at which the balance changes its sign. Where rollers drive the cage there,
   as those do that a turning outer ring carries along, search ahead of pure rolling.

Without play the result is that of rollers that are set in the cage. Under axial load rollers tilt, and tables over the
force of a roller err by some per cent. The difference of a march without play from the torque of rollers set in the
cage, on all slices, is added at some slips, and interpolated between these.
"""

import copy
import math
from contextlib import suppress
from functools import cached_property
from typing import Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import Array
from rollslip.errors import ConvergenceError, DomainError
from rollslip.results.text import SMALLEST_SLIP, SWITCHED_OFF, Status
from rollslip.search import illinois_root
from rollslip_kernels.motion import pocket as compiled
from rollslip_studies.dynamics.levels.raceway_friction import FrictionSettings, raceway_friction
from rollslip_studies.motion.loading_branch import SEARCH
from rollslip_studies.motion.orbit_loads import orbit_loads
from rollslip_studies.motion.spins import assembly_rib_friction
from rollslip_studies.motion.torque_balance import TorqueBalance

# Effects of other values were measured on the slips of the bearings in tests/studies/test_pockets.py.

#: Number of steps of a turn of the cage. Half as many change slips by up to 1.4e-3, twice as many by up to 6e-4, the
#: order of the method, for twice the time; chosen, below the tolerance of results.
STEPS: Final = 2000
#: Change of the mean torque from one turn of the cage to the next, relative to it, at which a motion is periodic. Ten
#: times the value changes slips by up to 2.1e-5, a tenth of it by up to 2.3e-6; chosen.
PERIODIC: Final = 1e-6
#: Largest number of turns of the cage. Half and twice as many change nothing, ten a slip by 1.7 %: fast rollers without
#: rolling resistance need many, most others two or three.
_MAX_TURNS: Final = 200
#: Error of the table of friction, relative to the largest friction. Twice as much changes slips of twelve bearings by
#: up to 1.0e-2, four fifths of it by up to 1.3e-3, and cannot be reached in one of them; chosen.
FRICTION_TOLERANCE: Final = 5e-3
#: The same, one after the other, where that cannot be reached, as with few slices under heavy load. The last one
#: changes slips of nine bearings by up to 1.0e-3, and those without play by up to 3 %; three times it by up to 2.1 %.
_COARSE_TOLERANCES: Final = (1e-2, 3e-2)
#: Smallest number of positions of the orbit at which loads are solved; between them they are linear. Half as many
#: change slips by up to 1.5e-3, twice as many by up to 5.4e-4; chosen.
_MIN_POSITIONS: Final = 360
#: Number of slips that are marched together in the search for the bracket of the slip; chosen, so that most brackets
#: are among the first of them.
_BATCH: Final = 8
#: Ratio of a slip of the search to the one before. With 1.25 and 2 slips change by up to 3e-5; chosen.
_RATIO: Final = 1.5
#: First slip of the search, relative to that of rollers set in the cage, which is the lower one in all bearings so far.
#: Half of it changes slips by up to 4e-6; chosen.
_FIRST_SLIP: Final = 0.5
#: Fraction of the largest force on the inner ring from which a roller counts as loaded in `relative_play`. Half or
#: twice as much changes that by up to 6 % in the scenes of docs/scripts/play.py; chosen.
_LOADED: Final = 0.01
#: Relative play below which it is left out of a slip. At three quarters of it the play changes slips of eight scenes
#: by up to 0.6 %, at one and a half times by up to 1.4 %; chosen, below the tolerance of results.
NEGLIGIBLE_PLAY: Final = 0.01
#: Status of a slip that is the same without play. At the large slips at which contacts leave the tables of friction it
#: is, too.
NO_CHANGE: Final = "the play changes the slip by less than 1 %"
#: Slips at which the effect of the tilt of rollers under axial load on their torques is computed; it is linear between
#: them. Twice as many change slips of an NJ 2312 with play by up to 4e-3; chosen, because the effect itself is some per
#: cent of a torque. At a single slip it is computed there, whatever was computed before.
_CORRECTED_SLIPS: Final = np.concatenate(([-0.05, 0.0], np.geomspace(1e-4, 0.6, 12)))
#: Tolerance of the slip, relative to it. Ten times the value changes slips by up to 3.4e-4, a tenth of it by
#: less than 1e-6; chosen.
_SLIP_TOLERANCE: Final = 1e-4


@attrs.frozen(eq=False)
class PocketMotions:
    """Steady motions of a roller through the play of its pocket at n cage slips; NaN where they leave the tables."""

    torque: Array  #: Mean torque of all rollers on the cage [N m], positive where it drives, (n,): Z <H - M>.
    push: Array  #: The same by the forces on the bars [N m], (n,): Z <R_m P - M>.
    driving: Array  #: Fraction of the turn in which a roller drives the cage, (n,).
    crossing: Array  #: Fraction in which it crosses the play, (n,).
    pushed: Array  #: Fraction in which the cage pushes it, (n,).
    is_periodic: (
        Array  #: Whether the motion repeats within the largest number of turns, 1 or 0, (n,).
    )


@attrs.frozen(eq=False)
class PocketOrbit:
    """One turn of the steady motion of a roller at one cage slip, in n steps; NaN where it leaves the tables."""

    angle: Array  #: Of the roller from the line of load at the end of each step, 0 to 2 pi [rad], (n,).
    position: Array  #: At the end of each step, over half of the play: 1 at the bar that it drives, -1 behind, (n,).
    torque: Array  #: On the bars [N m], positive where it drives, R_m P, mean of each step with its impacts, (n,).


class Pockets:
    """Rollers of a bearing with play in their pockets.

    Parameters
    ----------
    assembly : Assembly
        The bearing, with its resistance to rolling.
    play : float, optional
        Full play along the orbit [m]; by default that of the cage.
    tolerance : float
        Error of the table of friction.
    steps : int
        Steps of a turn of the cage.
    periodic : float
        Change of the mean torque from one turn to the next, relative to it, at which a motion is periodic.
    fully_loaded : Assembly, optional
        The bearing under its largest load, which has the tables of friction; by default the bearing itself.

    Attributes
    ----------
    reason : str
        Why friction has no tables, without which there is no march; empty if it has.
    """

    def __init__(
        self,
        assembly: Assembly,
        play: float | None = None,
        *,
        tolerance: float = FRICTION_TOLERANCE,
        steps: int = STEPS,
        periodic: float = PERIODIC,
        fully_loaded: Assembly | None = None,
    ) -> None:
        settings = FrictionSettings(
            name="conventional",
            tolerance=tolerance,
            min_slices=1,
            fully_loaded=fully_loaded,
            n_loads=SEARCH.n_loads,
        )
        friction = raceway_friction(assembly, settings)
        self.assembly = assembly
        self.play = assembly.cage.pocket_clearance if play is None else play
        self.reason = "" if friction.friction_tables else friction.evaluation_method
        self._raceways = friction.capsules
        self._steps = steps
        self._periodic = periodic

    def with_play(self, play: float) -> "Pockets":
        """Return the same rollers, with their tables of friction, with another play [m]."""
        other = copy.copy(self)
        other.play = play
        return other

    def march(self, slips: Array) -> PocketMotions:
        """Return the steady motions of a roller at cage slips, (n,)."""
        means, is_periodic = self._march(slips)
        drive, friction, push, driving, crossing, pushed = means.T
        sense = self._sense * self.assembly.scene.bearing.rollers
        return PocketMotions(
            torque=sense * (drive - friction),
            push=sense * (push - friction),
            driving=driving,
            crossing=crossing,
            pushed=pushed,
            is_periodic=is_periodic,
        )

    def orbit(self, slip: float) -> PocketOrbit:
        """Return the last turn of the steady motion of a roller at a cage slip.

        Parameters
        ----------
        slip : float
            Cage slip.
        """
        record = np.full((self._steps, len(compiled.RECORDED)), np.nan)
        means, _ = self._march(np.array([slip]), record)
        if np.isnan(means).any():
            record[:] = np.nan
        turn, position, torque = record.T
        return PocketOrbit(
            angle=2.0 * np.pi * (turn % 1.0),
            position=self._sense * position,
            torque=self._sense * torque,
        )

    def _march(self, slips: Array, record: Array | None = None) -> tuple[Array, Array]:
        """Return what compiled code finds at cage slips, with the sign of speeds."""
        speeds = self.assembly.kinematics.epicyclic_cage_speed * (1.0 - slips)
        forces, rib_forces = self._forces(speeds)
        ribs = assembly_rib_friction(self.assembly)
        return compiled.march(
            self._bearing,
            *self._raceways,
            speeds,
            forces,
            self.play,
            self._steps,
            _MAX_TURNS,
            self._periodic,
            record,
            None if ribs is None else ribs.pocket_arguments(slips, rib_forces),
        )

    def _forces(self, speeds: Array) -> tuple[Array, Array]:
        """Return forces over one orbit at cage speeds [N]: of both rings (n, 2, steps + 1), of ribs (n, steps + 1)."""
        n_positions = math.ceil(_MIN_POSITIONS / self.assembly.scene.bearing.rollers)
        *rings, rib = orbit_loads(self.assembly, n_positions, speeds)

        def over_orbit(force: Array) -> Array:
            force = force.swapaxes(1, 2).reshape(speeds.size, -1)
            return np.append(force, force[:, :1], axis=1)

        forces = [over_orbit(load @ widths) for load, widths in rings]
        return np.stack(forces, axis=1), over_orbit(rib)

    @property
    def _sense(self) -> float:
        """Sign of the speed of the cage."""
        return math.copysign(1.0, self.assembly.kinematics.epicyclic_cage_speed)

    @property
    def _bearing(self) -> dict[str, float]:
        """Geometry, speeds and inertias as compiled code takes them."""
        k = self.assembly.kinematics
        mass = self.assembly.roller_mass
        friction = self.assembly.cage.drags.pocket_friction
        return {
            "inner_radius": k.inner_radius,
            "outer_radius": k.outer_radius,
            "roller_radius": k.roller_radius,
            "orbit_radius": k.orbit_radius,
            "inner_speed": k.direction * k.inner_speed,
            "outer_speed": k.direction * k.outer_speed,
            "spin_inertia": 0.5 * mass * k.roller_radius**2,
            "orbital_inertia": mass * k.orbit_radius**2,
            "pocket_friction": 0.0 if friction is None else friction.coefficient,
        }


@attrs.frozen
class SlipWithPlay:
    """The smallest steady slip of a cage whose rollers have play, and what a roller does in a turn of the cage."""

    status: str  #: `Status.FOUND`, or why there is no slip.
    slip: float = math.nan  #: Cage slip.
    driving: float = math.nan  #: Fraction of the turn in which a roller drives the cage.
    crossing: float = math.nan  #: Fraction in which it crosses the play of its pocket.
    pushed: float = math.nan  #: Fraction in which the cage pushes it.


class BalanceWithPlay:
    """Torques of rollers with play in their pockets, and of drags, on the cage of one bearing against its slip.

    Parameters
    ----------
    balance : TorqueBalance
        Of the same rollers, set in the cage.
    pockets : Pockets
        The rollers with play.
    """

    def __init__(self, balance: TorqueBalance, pockets: Pockets) -> None:
        self.balance = balance
        self.pockets = pockets
        self.drag = balance.drag

    def torques(self, cage_slips: Array, without: Array | None = None) -> Array:
        """Return the torques on the cage at several slips [N m], (n,).

        They are those of rollers set in the cage where a march leaves the tables, which happens at large slips, where
        the play changes a torque by less than 1 %, and where it does not repeat. They are NaN where a law has no value.

        Parameters
        ----------
        cage_slips : ndarray
            Cage slips, (n,).
        without : ndarray, optional
            Torques of rollers set in the cage [N m], (n,); by default they are computed where they are needed.
        """
        motions = self.pockets.march(cage_slips)
        torques = motions.torque
        is_known = np.isfinite(torques) & (motions.is_periodic == 1.0)
        if self.balance.assembly.ribs is not None:
            if cage_slips.size == 1:
                slips, corrections = self._tilt_corrections(cage_slips)
            else:
                slips, corrections = self._tilt_correction
            torques = torques + np.interp(cage_slips, slips, corrections)
        if is_known.all():
            return torques
        if without is None:
            without = np.full(cage_slips.shape, np.nan)
            without[~is_known] = self._torques_without(cage_slips[~is_known])
        return np.where(is_known, torques, without)

    @cached_property
    def _tilt_correction(self) -> tuple[Array, Array]:
        """Slips, and the corrections of torques there [N m]."""
        return self._tilt_corrections(_CORRECTED_SLIPS)

    def _tilt_corrections(self, slips: Array) -> tuple[Array, Array]:
        """Slips, and what the tilt of rollers under axial load adds to torques by tables of friction there [N m]."""
        without = self.pockets.with_play(0.0).march(slips)
        corrections = self._torques_without(slips, reduced=True) - without.torque
        is_known = np.isfinite(corrections) & (without.is_periodic == 1.0)
        if not is_known.any():
            return np.zeros(1), np.zeros(1)
        return slips[is_known], corrections[is_known]

    def _torques_without(self, cage_slips: Array, *, reduced: bool = False) -> Array:
        """Torques of rollers set in the cage at several slips [N m], (n,); NaN where a law has no value.

        Few loads stand for all slices where they are ``reduced``, as they do in the tables of friction.
        """
        with suppress(DomainError, ConvergenceError):
            return self.balance.torques(cage_slips, reduced=reduced)
        return np.full(cage_slips.shape, np.nan)

    def excess(self, cage_slips: Array) -> Array:
        """Return the torques of the rollers in excess of the drags at several slips [N m], (n,); NaN as above.

        Parameters
        ----------
        cage_slips : ndarray
            Cage slips, (n,).
        """
        return self.torques(cage_slips) + [self.drag(slip) for slip in cage_slips.tolist()]


def reason_without_play(balance: TorqueBalance) -> str:
    """Return why the play of the pockets has no meaning for a torque balance, or is not computed; empty if it is.

    Parameters
    ----------
    balance : TorqueBalance
        Of the bearing.
    """
    scene = balance.assembly.scene
    if scene.models.neighbour_friction is not None:
        return "a full complement has no cage and no pockets"
    if scene.bearing.contact_angle is not None:
        return "rollers with play in the pockets of a tapered bearing are not modelled"
    if balance.assembly.cage.pocket_clearance == 0.0:
        return "the pockets have no play, cage.pocket_clearance is 0"
    if not balance.inertia:
        return "rollers without inertia do not run ahead of the cage, inertia is false"
    if balance.rolls_freely:
        return f"{SWITCHED_OFF}, so no roller needs to drive the cage"
    if any(balance.assembly.body_force):
        return "forces of gravity or of a carrier on rollers in their pockets are left out"
    return ""


def balance_with_play(
    balance: TorqueBalance, fully_loaded: Assembly | None = None
) -> tuple[BalanceWithPlay | None, str]:
    """Return the torque balance of rollers with the play of their pockets, or None and why there is none.

    Parameters
    ----------
    balance : TorqueBalance
        Of the bearing.
    fully_loaded : Assembly, optional
        The bearing under its largest load; see `Pockets`.
    """
    if reason := reason_without_play(balance):
        return None, reason
    try:
        for tolerance in (FRICTION_TOLERANCE, *_COARSE_TOLERANCES):
            pockets = Pockets(balance.assembly, tolerance=tolerance, fully_loaded=fully_loaded)
            if not pockets.reason:
                return BalanceWithPlay(balance, pockets), ""
    except ConvergenceError as error:
        return None, f"{Status.NOT_KNOWN}: {error}"
    _, _, reason = pockets.reason.rpartition(": ")
    return None, f"{Status.NOT_KNOWN}: {reason}, so that a march has no table of friction"


def relative_play(balance: TorqueBalance, slip: float) -> float:
    """Return the play over the distance by which a roller runs ahead of a slower cage while it is loaded.

    Parameters
    ----------
    balance : TorqueBalance
        Of the bearing.
    slip : float
        Cage slip, above 0.
    """
    force = balance.contacts(slip)[0].contacts.carried
    loaded = 2.0 * math.pi * float((force > _LOADED * force.max()).mean())
    way = slip * balance.assembly.kinematics.orbit_radius * loaded
    return balance.assembly.cage.pocket_clearance / way


def steady_slip_with_play(with_play: BalanceWithPlay, slip: float, max_slip: float) -> SlipWithPlay:
    """Return the smallest steady slip of a cage whose rollers have play in their pockets.

    It is the first one, from a small one on, at which the excess torque no longer moves the cage on. Where rollers
    drive the cage there it runs ahead of pure rolling, and its slip is negative.

    Parameters
    ----------
    with_play : BalanceWithPlay
        Of the bearing.
    slip : float
        Smallest steady slip with rollers that are set in the cage; NaN without one.
    max_slip : float
        Largest cage slip of the search, below 1.
    """
    if math.isnan(slip):
        return SlipWithPlay("rollers that are set in the cage have no steady slip")
    first_slip = _FIRST_SLIP * max(slip, SEARCH.slip_floor)
    sense = 1.0

    def torques_at(magnitudes: Array) -> Array:
        return sense * with_play.excess(sense * magnitudes)

    ratios = np.array([_RATIO**n for n in range(_BATCH)])
    slips = np.minimum(first_slip * ratios, max_slip)
    torques = torques_at(slips)
    if torques[0] >= 0.0:
        sense = -1.0
        slips = _FIRST_SLIP * SEARCH.slip_floor * ratios
        torques = torques_at(slips)
        if torques[0] >= 0.0:
            reason = f"with play it is less than {100.0 * first_slip:.3g} %"
            is_small = first_slip < SMALLEST_SLIP
            return SlipWithPlay(reason if is_small else f"{Status.NOT_KNOWN}: {reason}")
    while not (torques >= 0.0).any():
        if np.isnan(torques[-1]):
            return SlipWithPlay(f"{Status.NOT_KNOWN}: a law has no value below {slips[-1]:.3g}")
        if slips[-1] == max_slip:
            return SlipWithPlay(f"{Status.NO_STEADY_SLIP} up to {max_slip:.3g}")
        slips = np.minimum(slips[-1] * ratios, max_slip)
        torques = torques_at(slips)
    upper = int(np.argmax(torques >= 0.0))
    log = illinois_root(
        lambda log: float(torques_at(np.array([math.exp(log)]))[0]),
        *np.log(slips[upper - 1 : upper + 1]).tolist(),
        *torques[upper - 1 : upper + 1].tolist(),
        tolerance=_SLIP_TOLERANCE,
    )
    root = sense * math.exp(log)
    motion = with_play.pockets.march(np.array([root]))
    if np.isnan(motion.torque[0]):
        if sense < 0.0 or relative_play(with_play.balance, root) >= NEGLIGIBLE_PLAY:
            return SlipWithPlay(f"{Status.NOT_KNOWN}: contacts leave the tables of friction")
        return SlipWithPlay(NO_CHANGE)
    if not motion.is_periodic[0]:
        return SlipWithPlay(
            f"{Status.NOT_KNOWN}: the motion of a roller does not repeat within {_MAX_TURNS} turns of the cage"
        )
    return SlipWithPlay(
        Status.FOUND,
        root,
        float(motion.driving[0]),
        float(motion.crossing[0]),
        float(motion.pushed[0]),
    )
