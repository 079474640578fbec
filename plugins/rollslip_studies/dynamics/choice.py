"""Chooses friction, level, integrator and tolerance of a step of cage and rollers in motion, where a scene leaves them.

- The motion itself is gone through with few slices and loose steps, once in either way. That costs a hundredth of what
  it does with many, and its difference is the error of the simpler way, with all that averages out or adds up.
- Rollers that hit their pockets let the cage swing without moving its mean, and how they do so is chaotic: no tolerance
  makes two integrators agree on it. The levels are therefore held against each other by means over orbits of the cage.
- Integrators are chosen by rule, from the frequencies that a motion tells and its damping, the eigenvalues of its
  Jacobian, where it begins. What swings and is hardly damped is for explicit methods, what is damped within a step that
  resolves its contacts for the one that a study takes by default.
- Effective friction has another largest drag than conventional friction, by 2.7 % in the middle and up to 23 % over 62
  random bearings (docs/trust/skidding.rst). Near it the one cage runs away where the other does not, whatever their
  speeds were until then: there it is not chosen.
- Where rollers hit their pockets only explicit methods that resolve contacts serve: another that is right about the
  cage's speed may miss a third of the impacts' force (docs/trust/dynamics.rst).
- What is stiff for a while only, as a start from rest, is for an explicit method whose steps follow their error.
- Along a history it is looked at several instants. Where rings rest contacts are damped most: there, if not all the
  way, the motion is stiff, and an explicit method whose steps follow its error takes short ones for a short time.
- What cannot be estimated is taken as finely as there is.
- Errors of steps over a short time go with their tolerance, in proportion at most, and add up or fade. Where rollers
  hit their pockets hardly a tolerance keeps motions together: they come apart as far as play lets them swing, and each
  by chance. How far motions of other tolerances do so in an orbit of the cage tells what to expect.
- For steps a history is gone through as it is: what moves nothing at one speed may hit its pockets in a run-up.
"""

import itertools
import math
from collections.abc import Collection, Mapping, Sequence
from functools import cached_property
from typing import Any, Final, Protocol

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import Array
from rollslip.bearing.resolution import reference_resolution
from rollslip.errors import ConvergenceError, RollslipError
from rollslip.models import IntegratorModel
from rollslip_studies.dynamics.levels.moving_bearing import MovingBearing
from rollslip_studies.motion.time_integration import Trajectory
from rollslip_studies.motion.torque_balance import near_skidding

#: What a plan chooses -> the finest of it that needs nothing more from a scene.
OPEN: Final = {"friction": "conventional", "level": "pocket", "integrator": None}
#: Slices and error of tables, with which motions are tried.
_FEW = 12
_TABLE = 1e-3
#: Shares of the tolerance of the cage speed that the simpler friction and the simpler level may take.
_FRACTION: Final = {"friction": 0.3, "level": 0.2}
#: Error of their steps, relative to the tolerance of the cage speed, and the largest one.
_STEP = 0.1
_LOOSEST = 1e-3
#: Orbits of the cage over which levels are compared, and instants of each.
_ORBITS = 3
_INSTANTS = 64
#: Instants after which frictions are compared before their motions go on.
_LOOKS: Final = (4, 8, 16, 32)
#: Damping [1/s] up to which rk45 takes fewer evaluations of smooth motions than rodas5p, or 1.6 times as many at most,
#: and error of a step from which on leapfrog takes fewer than rk45 where contacts are resolved: 24 random bearings.
_SMOOTH = 1e4
_LEAPS = 3e-8
#: A step resolves a contact by this part of a radian; what is damped by more than the other part in it is stiff. An
#: explicit method bears a fifth more.
_RESOLVED = 0.2
_STIFF = 0.25
#: Slip by which two cages begin apart to see how errors of the cage speed fade, error of a step relative to it, the
#: time [s] over which that is seen at most, and its instants.
_APART = 1e-2
_EXACT = 1e-5
_FADING = 10.0
_SEEN = 256
#: Share of the tolerance of the cage speed that steps may take, and the time [s] of a short motion.
_OF_STEPS = 0.2
_SHORT = 5e-3
#: A usual tolerance of a step.
_USUAL: Final = 1e-5
#: Pieces of an orbit, and instants of each, in which it is looked how far steps let motions come apart, how much finer
#: others are, evaluations of the rates after which there is no further piece, and how many times as far apart as those
#: that were tried others may be, by the scenes of tools/references/motions_by_scipy.csv.
_PIECES = 8
_PIECE = 16
_FINER = (4.0, 16.0)
_MOST = 200_000
_OTHERS = 2.0


class Movable(Protocol):
    """A study that sets a bearing in motion: what is asked of it here."""

    @property
    def friction(self) -> str:
        """Friction of the raceways."""

    @property
    def cage_slip(self) -> float:
        """Slip of the cage at the start."""

    @property
    def roller_slip(self) -> float:
        """Slip of the rollers at the start."""

    @property
    def level(self) -> str:
        """Level of detail."""

    @property
    def duration(self) -> float:
        """Time to go through [s]."""

    def with_settings(self, **settings: Any) -> "Movable":
        """Return the study with other settings."""

    @property
    def points(self) -> int:
        """Instants stored."""

    @property
    def relative_tolerance(self) -> float:
        """Error of a step."""

    def moving(self, assembly: Assembly) -> MovingBearing:
        """Return the bearing in motion."""

    def tried(
        self,
        moving: MovingBearing,
        times: Array,
        tolerance: float,
        before: Trajectory | None = None,
    ) -> Trajectory:
        """Return the motion at some times [s] and a relative tolerance, from its start or from what was before."""

    def method(self, assembly: Assembly) -> IntegratorModel:
        """Return the integrator."""


@attrs.frozen(kw_only=True)
class MotionChoice:
    """What was chosen of friction, level and integrator, with reasons and the errors that the simpler ones leave."""

    settings: Mapping[str, Any] = attrs.field(factory=dict)
    reasons: Mapping[str, str] = attrs.field(factory=dict)
    errors: Mapping[str, Mapping[str, float]] = attrs.field(factory=dict)


def with_coarse_slices(assembly: Assembly) -> Assembly:
    """Return a bearing as motions of it are tried, so that all of them share its loads and tables."""
    resolution = assembly.resolution
    slices = min(_FEW, resolution.slices)
    return assembly.at(
        attrs.evolve(resolution, slices=slices, quadrature="equal", table_tolerance=_TABLE)
    )


def adds_up(study: Movable, few: Assembly, span: float) -> float:
    """Return how many times the error of the cage speed over a short time adds up over a whole motion.

    Every stretch adds an error, and what drives the cage lets it fade: with g(t) what is left at t of a difference at
    the start, all of them add up to the integral of g over that time. Two cages that begin apart show g, at level
    cage-set; where they come no nearer to each other, errors add up over all of the duration.

    Parameters
    ----------
    study : Movable
        The study, without a history.
    few : Assembly
        The bearing with few slices.
    span : float
        The short time [s].
    """
    seen = min(study.duration, _FADING)
    times = np.linspace(0.0, seen, _SEEN + 1)
    alone = study.with_settings(
        level="cage-set", friction="constant" if study.friction == "constant" else "effective"
    )
    moving = alone.moving(few)
    ends = []
    for slip in (study.cage_slip, study.cage_slip + _APART):
        found = alone.with_settings(cage_slip=slip).tried(moving, times, _EXACT * _APART)
        if found.outcome != "finished":
            return study.duration / span
        ends.append(np.asarray(moving.split(found.y)["cage_speed"]))
    left = np.abs(ends[1] - ends[0]) / abs(ends[1][0] - ends[0][0])
    longer = (study.duration - seen) * float(left[-_SEEN // 4 :].max())
    return max(1.0, min(study.duration, float(np.trapezoid(left, times)) + longer) / span)


def choose_motion(study: Movable, assembly: Assembly, named: Collection[str]) -> MotionChoice:
    """Choose what a scene does not name of friction, level and integrator."""
    unnamed = [name for name in OPEN if name not in named]
    if not unnamed:
        return MotionChoice()
    if assembly.scene.accuracy.exact:
        exact = {name: of for name in unnamed if (of := OPEN[name]) is not None}
        return MotionChoice(
            settings=exact, reasons=dict.fromkeys(exact, "an exact result is asked for")
        )
    study = study.with_settings(film_limit=0.0)  # an event, which moves nothing
    trials = _Trials(assembly)
    settings = dict[str, Any]()
    reasons = dict[str, str]()
    errors = dict[str, Mapping[str, float]]()
    for name in unnamed:
        try:
            choice, reasons[name], left = getattr(trials, name)(study.with_settings(**settings))
        except RollslipError as error:
            choice = OPEN[name] or getattr(study, name)
            reasons[name] = f"there is no estimate of what a simpler one would leave: {error}"
            left = None
        settings[name] = choice
        if left is not None:
            errors[name] = {"cage_speed": left}
    return MotionChoice(settings=settings, reasons=reasons, errors=errors)


@attrs.frozen(eq=False)
class _Trials:
    """Motions of a bearing with few slices."""

    assembly: Assembly
    _made: dict[tuple[str, str], MovingBearing] = attrs.field(factory=dict, init=False)

    @cached_property
    def few(self) -> Assembly:
        return with_coarse_slices(self.assembly)

    @property
    def requested(self) -> float:
        """Tolerance of the cage speed."""
        return self.assembly.scene.accuracy.of("cage_speed")

    def moving(self, study: Movable) -> MovingBearing:
        """The bearing in motion, by friction and level made once."""
        if (key := (study.friction, study.level)) not in self._made:
            self._made[key] = study.moving(self.few)
        return self._made[key]

    def speeds(
        self, study: Movable, times: Array, tolerance: float, before: Trajectory | None = None
    ) -> tuple[Array, Trajectory]:
        """Cage speed at some times, relative to the epicyclic one, and the motion, from its start or from before."""
        moving = self.moving(study)
        found = study.tried(moving, times, tolerance, before)
        if found.outcome != "finished":
            raise ConvergenceError(
                f"{study.friction} friction at level {study.level}: {found.message}"
            )
        return np.asarray(
            moving.split(found.y)["cage_speed"] / self.few.kinematics.epicyclic_cage_speed
        ), found

    def friction(self, study: Movable) -> tuple[str, str, float | None]:
        """Effective friction where it moves the cage as conventional friction does, over all of the time."""
        times = np.linspace(0.0, study.duration, _INSTANTS + 1)[1:]
        tolerance = min(_STEP * self.requested, _LOOSEST)
        allowed = _FRACTION["friction"] * self.requested
        conventional, effective = (
            study.with_settings(friction=friction, level="cage-set")
            for friction in ("conventional", "effective")
        )
        ours = theirs = None
        off = slowest = 0.0
        for part in np.split(times, _LOOKS):
            one, ours = self.speeds(conventional, part, tolerance, ours)
            other, theirs = self.speeds(effective, part, tolerance, theirs)
            off = max(off, float(np.abs(one - other).max()))
            slowest = max(slowest, 1.0 - float(one.min()))
            if off > allowed:
                break
        after = "" if part[-1] == times[-1] else f" after {part[-1]:.2g} s already"
        found = f"with few slices the two frictions give cage speeds that differ by up to {off:.1e}{after}"
        if off <= allowed:
            if near := near_skidding(self.few, slowest):
                return "conventional", f"{found}, but {near}", None
            return "effective", f"{found}, less than the {allowed:.1e} that it may take", off
        return (
            "conventional",
            f"{found}, more than the {allowed:.1e} that effective friction may take",
            None,
        )

    def level(self, study: Movable) -> tuple[str, str, float | None]:
        """Cage-set where play in the pockets does not move the mean speed of the cage, orbit by orbit."""
        speed = abs(self.few.kinematics.epicyclic_cage_speed)
        orbits = int(min(study.duration * speed / (2.0 * math.pi), _ORBITS))
        span = orbits * 2.0 * math.pi / speed if orbits else study.duration
        times = np.linspace(0.0, span, max(orbits, 1) * _INSTANTS + 1)
        friction = "constant" if study.friction == "constant" else "effective"
        tolerance = min(_STEP * self.requested, _LOOSEST)
        alone, within = (
            self.speeds(study.with_settings(friction=friction, level=level), times, tolerance)[0]
            for level in ("cage-set", "pocket")
        )
        off = within - alone
        means = np.abs(off[1:].reshape(-1, _INSTANTS).mean(axis=1))
        moved = float(means.max())
        allowed = _FRACTION["level"] * self.requested
        found = (
            f"play in the pockets moves the mean speed of the cage by up to {moved:.1e} (and lets it "
            f"swing by {np.ptp(off):.1e})"
        )
        other = "; planar only where the scene names it, with the masses it needs"
        if moved <= allowed:
            return (
                "cage-set",
                f"{found}, less than the {allowed:.1e} that leaving it out may take{other}",
                moved,
            )
        return (
            "pocket",
            f"{found}, more than the {allowed:.1e} that leaving it out may take{other}",
            None,
        )

    def integrator(self, study: Movable) -> tuple[str, str, float | None]:
        """Leapfrog where contacts are to be resolved, rk45 where nothing swings, and the default where it is stiff."""
        moving = self.moving(study)
        name = study.method(self.assembly).name
        contact = moving.system.frequencies[0]
        (times, states) = moving.sample_states()
        without_slip = [_damping(moving, t, y) for t, y in zip(times.tolist(), states, strict=True)]
        begin = _damping(
            moving, 0.0, np.asarray(moving.initial(study.cage_slip, study.roller_slip))
        )
        mildest = min(without_slip)
        most = max(*without_slip, begin)
        damped = f"speeds are damped by up to {most:.2g}/s"
        if not contact:
            if most > _SMOOTH:
                return (
                    name,
                    f"{damped}, more than the {_SMOOTH:g}/s up to which an explicit method takes fewer rates",
                    None,
                )
            return "rk45", f"{damped}, which does not bind an explicit method", None
        if self.assembly.cage.pocket_contact == "film":
            return (
                name,
                "the motion is stiff: films in the pockets are, once they are pressed",
                None,
            )
        if stiff := _stiff(contact, mildest):
            return name, stiff, None
        if _stiff(contact, most):
            return (
                "rk45",
                f"{damped}, but for a while only: explicit steps are held to their error there",
                None,
            )
        swings = (
            f"the motion swings, at up to {max(moving.system.frequencies):.2g} rad/s, and {damped}"
        )
        if study.relative_tolerance < _LEAPS:
            return (
                "rk45",
                f"{swings}: explicit steps of a high order serve for errors of that size",
                None,
            )
        return "leapfrog", f"{swings}: explicit steps that resolve contacts serve", None


def step_tolerance(study: Movable, assembly: Assembly, fades: bool) -> tuple[float, float]:
    """Return the tolerance of a step, and the error of the speeds that it leaves, relative to the largest.

    Parameters
    ----------
    study : Movable
        The study, with its choices.
    assembly : Assembly
        The bearing as it is to run.
    fades : bool
        Whether it is looked at how errors of the cage speed fade; else they add up over all of the duration.
    """
    few = with_coarse_slices(assembly)
    moving = study.moving(assembly)
    if moving.friction.by_slices:
        moving = study.moving(few)
    span = min(_SHORT, study.duration)
    # a motion at level cage-set takes no longer than a look at how its errors fade
    times = adds_up(study, few, span) if fades else study.duration / span
    off = _come_apart(study, moving, (_USUAL, 1e-3 * _USUAL), [span])[0]
    error = float(off[~np.isnan(off)][-1:].sum()) * times
    fraction = _OF_STEPS * assembly.scene.accuracy.of("cage_speed")
    # nobody has seen a step of more than the typical tolerance do well where a contact opens
    least = reference_resolution(assembly.scene).integrator_tolerance or 0.0
    tolerance = min(max(_USUAL * fraction / max(error, 1e-300), least), _USUAL)
    left = error * tolerance / _USUAL
    return tolerance, left if study.level == "cage-set" else max(
        left, _swings_apart(study, moving, tolerance)
    )


def _come_apart(
    study: Movable, moving: MovingBearing, tolerances: Sequence[float], spans: Sequence[float]
) -> Array:
    """Return how far motions with finer steps come apart from one at some times [s], (cage and rollers, m).

    They begin with the motion, along a history in its middle and late, without slip, too: the largest of these counts.

    Parameters
    ----------
    study : Movable
        The study.
    moving : MovingBearing
        The bearing in motion.
    tolerances : sequence of float
        Tolerance of a step of the one, and of the others.
    spans : sequence of float
        Ends of pieces [s], each with as many of the times; more are not gone through once enough rates were evaluated.

    Returns
    -------
    ndarray
        Differences of speeds, relative to the largest without slip; NaN at times that were not reached.
    """
    looks, states = moving.sample_states()
    most = np.array(_fastest(moving))[:, None]
    still = study.tried(moving, np.zeros(1), tolerances[0])
    later = np.flatnonzero((looks > 0.0) & (looks + spans[-1] <= looks[-1])).tolist()
    few = {later[len(later) // 2], later[-1]} if later else ()
    off = np.full((2, len(spans), _PIECE), np.nan)
    for begin in (
        still,
        *(attrs.evolve(still, last_t=float(looks[k]), last_y=states[k]) for k in few),
    ):
        motions = [begin] * len(tolerances)
        work = 0
        for k, (start, end) in enumerate(itertools.pairwise((0.0, *spans))):
            times = begin.last_t + np.linspace(start, end, _PIECE + 1)[1:]
            motions = [
                study.tried(moving, times, *one) for one in zip(tolerances, motions, strict=True)
            ]
            work += sum(found.evaluations for found in motions)
            count = min(found.t.size for found in motions)
            first, *others = (moving.split(found.y[:count]) for found in motions)
            for other in others:
                cage, spin = (
                    np.abs(other[name] - first[name]) for name in ("cage_speed", "roller_spin")
                )
                here = off[:, k, :count]
                here[:] = np.fmax(here, np.stack((cage, spin.max(axis=-1))) / most)
            if work > _MOST or count < _PIECE:
                break
    return off.reshape(2, -1)


def _fastest(moving: MovingBearing) -> tuple[float, ...]:
    """Largest speeds of cage and rollers without slip [rad/s]."""
    looks, _ = moving.sample_states()
    times = np.union1d(looks, np.linspace(0.0, looks[-1], _SEEN + 1))
    return tuple(float(np.nanmax(np.abs(speeds))) for speeds in moving.epicyclic_speeds(times))


def _swings_apart(study: Movable, moving: MovingBearing, tolerance: float) -> float:
    """Return how far steps of a tolerance let motions come apart in an orbit of the cage, and others as these."""
    span = min(study.duration, 2.0 * math.pi / _fastest(moving)[0])
    ends = [span * k / _PIECES for k in range(1, _PIECES + 1)]
    most = 0.0
    for own in dict.fromkeys((tolerance, _USUAL)):  # looser steps show more of an orbit
        off = _come_apart(study, moving, (own, *(own / finer for finer in _FINER)), ends)
        most = max(most, _OTHERS * float(np.nanmax(off, initial=0.0)))
        if not np.isnan(off).any():
            break
    return most


def _damping(moving: MovingBearing, t: float, y: Array) -> float:
    """Strongest damping [1/s] of speeds by speeds at a state, twice the decay of what it lets swing."""
    speeds = ~moving.system.places
    try:
        jacobian = moving.system.jacobian(t, y)
    except Exception as fault:  # of somebody's drag or friction: the run tells whose
        raise ConvergenceError(f"the rates fail at t = {t:.3g} s: {fault}") from fault
    return max(0.0, float(-np.linalg.eigvals(jacobian[np.ix_(speeds, speeds)]).real.min()))


def _stiff(contact: float, damping: float) -> str:
    """Why a motion with contacts of a frequency is stiff; empty if it is not."""
    step = _RESOLVED / contact
    if damping * step <= _STIFF:
        return ""
    return (
        f"the motion is stiff: its strongest damping, {damping:.2g}/s, takes {damping * step:.2g} in a step of "
        f"{step:.2g} s that resolves its contacts, more than the {_STIFF:g} up to which explicit ones serve"
    )
