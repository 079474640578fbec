"""Chooses friction, level of detail and integrator of cage and rollers in motion, where a scene leaves them open.

- The motion itself is gone through with few slices and loose steps, once in either way. That costs a hundredth of what
  it does with many, and its difference is the error of the simpler way, with all that averages out or adds up.
- Rollers that hit their pockets let the cage swing without moving its mean, and how they do so is chaotic: no tolerance
  makes two integrators agree on it. The levels are therefore held against each other by means over orbits of the cage.
- Integrators are chosen by the spectrum of the motion: the eigenvalues of its Jacobian along the way, and the
  frequencies that it tells. What swings and is hardly damped is for explicit methods, what is damped within a step that
  resolves its contacts for the one that a study takes by default. Among explicit ones, of which only those are tried
  that step without Python, evaluations of the rates decide. Nothing is timed: the same scene has the same integrator.
- Effective friction has another largest drag than conventional friction, by 2.7 % in the middle and up to 23 % over 62
  random bearings (docs/trust/runaway.rst). Near it the one cage runs away where the other does not, whatever their
  speeds were until then: there it is not chosen.
- Where rollers hit their pockets only explicit methods that resolve contacts are tried: another that is right about
  the cage's speed may miss a third of the impacts' force (docs/trust/dynamics.rst).
- What is stiff for a while only, as a start from rest, may still be cheaper with steps that follow their error: both go
  through it until the implicit method has taken clearly more.
- Along a history it is looked at several instants. Where rings rest contacts are damped most: there, if not all the
  way, the motion is stiff, and an explicit method whose steps follow its error takes short ones for a short time.
- What cannot be estimated is taken as finely as there is.
"""

import math
from collections.abc import Collection, Mapping
from functools import cached_property
from typing import Any, Final, Protocol

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import Array
from rollslip.catalogue.registry import available, get_model
from rollslip.errors import ConvergenceError, RollslipError
from rollslip.models import IntegratorModel
from rollslip.motion.moving_bearing import MovingBearing
from rollslip.motion.time_integration import Trajectory
from rollslip.motion.torque_balance import near_running_away

#: What a plan chooses -> the finest of it that needs nothing more from a scene.
OPEN: Final = {"friction": "conventional", "level": "pocket", "integrator": None}
#: Slices and error of tables, with which motions are tried.
_FEW, _TABLE = 12, 1e-3
#: Shares of the tolerance of the cage speed that the simpler friction and the simpler level may take.
_SHARE: Final = {"friction": 0.3, "level": 0.2}
#: Error of their steps, relative to the tolerance of the cage speed, and the largest one.
_STEP, _LOOSEST = 0.1, 1e-3
#: Orbits of the cage over which levels are compared, and instants of each.
_ORBITS, _INSTANTS = 3, 64
#: Instants after which frictions are compared before their motions go on.
_LOOKS: Final = (4, 8, 16, 32)
#: Time [s] over which integrators are tried, instants of it at which the spectrum is taken, and at most as many steps
#: that resolve contacts.
_SHORT, _SPECTRA, _STEPS = 5e-2, 16, 12_000
#: Least evaluations of an explicit method in a step of an implicit one, and in the time in which the fastest part of
#: the motion decays: the real axis belongs to the stability of the usual ones up to about half their evaluations.
_PER_STEP, _PER_DECAY = 3, 1.0
#: By how much fewer evaluations make up for the default's larger stability.
_CHEAPER = 2.0
#: A step resolves a contact by this part of a radian; what is damped by more than the other part in it is stiff. An
#: explicit method bears a fifth more.
_RESOLVED, _STIFF = 0.2, 0.25
#: Slip by which two cages begin apart to see how errors of the cage speed fade, error of a step relative to it, the
#: time [s] over which that is seen at most, and its instants.
_APART, _EXACT, _FADING, _SEEN = 1e-2, 1e-5, 10.0, 256


class Movable(Protocol):
    """A study that sets a bearing in motion: what is asked of it here."""

    @property
    def friction(self) -> str:
        """Friction of the raceways."""
        ...

    @property
    def cage_slip(self) -> float:
        """Slip of the cage at the start."""
        ...

    @property
    def level(self) -> str:
        """Level of detail."""
        ...

    @property
    def duration(self) -> float:
        """Time to go through [s]."""
        ...

    def evolved(self, **settings: Any) -> "Movable":
        """Return the study with other settings."""
        ...

    @property
    def points(self) -> int:
        """Instants stored."""
        ...

    @property
    def relative_tolerance(self) -> float:
        """Error of a step."""
        ...

    def moving(self, assembly: Assembly) -> MovingBearing:
        """Return the bearing in motion."""
        ...

    def tried(
        self, moving: MovingBearing, times: Array, tolerance: float, before: Trajectory | None = None
    ) -> Trajectory:
        """Return the motion at some times [s] and a relative tolerance, from its start or from what was before."""
        ...

    def method(self, assembly: Assembly) -> IntegratorModel:
        """Return the integrator."""
        ...


@attrs.frozen(kw_only=True)
class MotionChoice:
    """What was chosen of friction, level and integrator, with reasons and the errors that the simpler ones leave."""

    settings: Mapping[str, Any] = attrs.field(factory=dict)
    reasons: Mapping[str, str] = attrs.field(factory=dict)
    errors: Mapping[str, Mapping[str, float]] = attrs.field(factory=dict)


def with_few_slices(assembly: Assembly) -> Assembly:
    """Return a bearing as motions of it are tried, so that all of them share its loads and tables."""
    resolution = assembly.resolution
    slices = min(_FEW, resolution.slices)
    return assembly.at(attrs.evolve(resolution, slices=slices, quadrature="equal", table_tolerance=_TABLE))


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
    alone = study.evolved(level="cage-set", friction="constant" if study.friction == "constant" else "effective")
    moving, ends = alone.moving(few), []
    for slip in (study.cage_slip, study.cage_slip + _APART):
        found = alone.evolved(cage_slip=slip).tried(moving, times, _EXACT * _APART)
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
        finest = {name: finest for name in unnamed if (finest := OPEN[name]) is not None}
        return MotionChoice(settings=finest, reasons=dict.fromkeys(finest, "an exact result is asked for"))
    study = study.evolved(film_limit=0.0)  # an event, which moves nothing
    trials, settings = _Trials(assembly), dict[str, Any]()
    reasons, errors = dict[str, str](), dict[str, Mapping[str, float]]()
    for name in unnamed:
        try:
            choice, reasons[name], left = getattr(trials, name)(study.evolved(**settings))
        except RollslipError as error:
            choice = OPEN[name] or getattr(study, name)
            reasons[name], left = f"there is no estimate of what a simpler one would leave: {error}", None
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
        return with_few_slices(self.assembly)

    @property
    def asked(self) -> float:
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
        found = _finished(study, study.tried(moving, times, tolerance, before))
        return np.asarray(moving.split(found.y)["cage_speed"] / self.few.kinematics.epicyclic_cage_speed), found

    def friction(self, study: Movable) -> tuple[str, str, float | None]:
        """Effective friction where it moves the cage as conventional friction does, over all of the time."""
        times = np.linspace(0.0, study.duration, _INSTANTS + 1)[1:]
        tolerance, allowed = min(_STEP * self.asked, _LOOSEST), _SHARE["friction"] * self.asked
        conventional, effective = (
            study.evolved(friction=friction, level="cage-set") for friction in ("conventional", "effective")
        )
        ours = theirs = None
        off = slowest = 0.0
        for part in np.split(times, _LOOKS):
            one, ours = self.speeds(conventional, part, tolerance, ours)
            other, theirs = self.speeds(effective, part, tolerance, theirs)
            off, slowest = max(off, float(np.abs(one - other).max())), max(slowest, 1.0 - float(one.min()))
            if off > allowed:
                break
        after = "" if part[-1] == times[-1] else f" after {part[-1]:.2g} s already"
        found = f"with few slices the two frictions give cage speeds that differ by up to {off:.1e}{after}"
        if off <= allowed:
            if near := near_running_away(self.few, slowest):
                return "conventional", f"{found}, but {near.text}", None
            return "effective", f"{found}, less than the {allowed:.1e} that it may take", off
        return "conventional", f"{found}, more than the {allowed:.1e} that effective friction may take", None

    def level(self, study: Movable) -> tuple[str, str, float | None]:
        """Cage-set where play in the pockets does not move the mean speed of the cage, orbit by orbit."""
        speed = abs(self.few.kinematics.epicyclic_cage_speed)
        orbits = int(min(study.duration * speed / (2.0 * math.pi), _ORBITS))
        span = orbits * 2.0 * math.pi / speed if orbits else study.duration
        times = np.linspace(0.0, span, max(orbits, 1) * _INSTANTS + 1)
        friction = "constant" if study.friction == "constant" else "effective"
        tolerance = min(_STEP * self.asked, _LOOSEST)
        alone, within = (
            self.speeds(study.evolved(friction=friction, level=level), times, tolerance)[0]
            for level in ("cage-set", "pocket")
        )
        off = within - alone
        means = np.abs(off[1:].reshape(-1, _INSTANTS).mean(axis=1))
        moved, allowed = float(means.max()), _SHARE["level"] * self.asked
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
        return "pocket", f"{found}, more than the {allowed:.1e} that leaving it out may take{other}", None

    def integrator(self, study: Movable) -> tuple[str, str, float | None]:
        """An explicit one where the motion is not stiff, else the one that the study takes by default."""
        moving, method = self.moving(study), study.method(self.assembly)
        name, order = method.name, method.order or 0
        contact, looks = moving.system.frequencies[0], list(zip(*moving.looks(), strict=True))
        each = [_spectrum(moving, np.array([t]), y[None]) for t, y in looks]
        found = max(frequency for frequency, _ in each), max(damping for _, damping in each)
        at_times = False  # stiff, of a history
        span = min(_SHORT, study.duration, _STEPS * _RESOLVED / contact if contact else math.inf)
        if contact:
            mildest = min(damping for _, damping in each)
            if stiff := _stiff(contact, mildest):
                return name, stiff, None
            at_times = bool(_stiff(contact, found[1]))
            own, least = math.inf, 0.0
        else:
            default = self._gone(study, moving, span)
            found = _spectrum(moving, default.t, default.y)
            own, least = default.evaluations, max(_PER_STEP * default.steps, _PER_DECAY * found[1] * span)
        decays = f"the motion decays at up to {found[1]:.2g}/s"
        costs = f"{name} takes {own} evaluations of the rates in the first {span:.2g} s"
        if _CHEAPER * least >= own:
            return name, f"{decays}, for which explicit integrators take at least {least:.0f}, and {costs}", None
        tried, failed = dict[str, Trajectory](), ""
        for other in available("integrator"):
            model = get_model("integrator", other)
            # of smooth motions, so that the same tolerance is about the same error, none of a lower order
            higher = (model.order or 0) >= order
            serves = model.resolves_contacts and (higher or not at_times) if contact else higher
            if model.explicit and serves and model.compiled() is not None:
                try:
                    tried[other] = self._gone(study.evolved(integrator=other), moving, span)
                except ConvergenceError as error:
                    failed = str(error)
        best = min(tried, key=lambda other: tried[other].evaluations, default=None)
        if best is None:
            return name, f"no explicit integrator goes through the first {span:.2g} s: {failed}", None
        told = ", ".join(f"{other} {one.evaluations}" for other, one in tried.items())
        if not contact:
            if _CHEAPER * tried[best].evaluations >= own:
                return name, f"{decays}, and {costs}, explicit integrators more than half of it: {told}", None
            return best, f"{decays}, which does not bind an explicit integrator: {costs}, against {told}", None
        if at_times:
            return (
                best,
                f"the motion is damped by {mildest:.2g} to {found[1]:.2g}/s along the way: explicit steps that resolve "
                f"contacts serve, and are held to tolerance where it is stiff; evaluations of the rates in the first "
                f"{span:.2g} s: {told}",
                None,
            )
        fastest, damping = _spectrum(moving, tried[best].t, tried[best].y)
        if stiff := _stiff(contact, damping):
            if (get_model("integrator", best).order or 0) < order:
                return name, stiff, None
            few = tried[best].evaluations
            own, at = self._until(study.evolved(integrator=name), moving, span, _CHEAPER * few)
            if own <= _CHEAPER * few:
                return name, stiff, None
            return (
                best,
                f"{stiff}; but {name} takes {own} evaluations of the rates in {at:.2g} s, {best} {few} in {span:.2g} s",
                None,
            )
        return (
            best,
            f"the motion swings, at up to {max(fastest, *moving.system.frequencies):.2g} rad/s, and is hardly damped, "
            f"by {damping:.2g}/s at most: explicit steps that resolve contacts serve, and evaluations of the "
            f"rates in the first {span:.2g} s decide among them: {told}{_held(tried[best])}",
            None,
        )

    def _until(self, study: Movable, moving: MovingBearing, span: float, most: float) -> tuple[int, float]:
        """Evaluations of the rates until there are more than the most, or the span [s] ends; and when that was [s]."""
        count, at, found = 0, 0.0, None
        while at < span and count <= most:
            at = min(max(2.0 * at, span / _SPECTRA), span)
            found = _finished(study, study.tried(moving, np.array([at]), study.relative_tolerance, found))
            count += found.evaluations
        return count, at

    def _gone(self, study: Movable, moving: MovingBearing, span: float) -> Trajectory:
        times = np.linspace(0.0, span, _SPECTRA + 1)
        return _finished(study, study.tried(moving, times, study.relative_tolerance))


def _spectrum(moving: MovingBearing, t: Array, y: Array) -> tuple[float, float]:
    """Fastest angular frequency [rad/s] and strongest damping [1/s] at some states.

    The damping is that of speeds by speeds, twice the decay of what it lets swing.
    """
    fastest = damping = 0.0
    speeds = ~moving.system.places
    for at, state in zip(t.tolist(), y, strict=True):
        try:
            jacobian = moving.system.jacobian(at, state)
        except Exception as fault:  # of somebody's drag or friction: the run tells whose
            raise ConvergenceError(f"the rates fail at t = {at:.3g} s: {fault}") from fault
        fastest = max(fastest, float(np.abs(np.linalg.eigvals(jacobian).imag).max()))
        damping = max(damping, float(-np.linalg.eigvals(jacobian[np.ix_(speeds, speeds)]).real.min()))
    return fastest, damping


def _stiff(contact: float, damping: float) -> str:
    """Why a motion with contacts of a frequency is stiff; empty if it is not."""
    step = _RESOLVED / contact
    if damping * step <= _STIFF:
        return ""
    return (
        f"the motion is stiff: its strongest damping, {damping:.2g}/s, takes {damping * step:.2g} in a step of "
        f"{step:.2g} s that resolves its contacts, more than the {_STIFF:g} up to which explicit ones are tried"
    )


def _held(found: Trajectory) -> str:
    """How long friction was held where it was not evaluated every time."""
    if not (told := found.told):
        return ""
    held, off = told["friction_held"], told["friction_off"]
    return f"; friction is evaluated every {held:.1g} s there, and off by {off:.0e} of it when it is again"


def _finished(study: Movable, found: Trajectory) -> Trajectory:
    if found.outcome != "finished":
        raise ConvergenceError(f"{study.friction} friction at level {study.level}: {found.message}")
    return found
