"""Choose level of detail, friction, integrator and step tolerance of a motion, where a scene leaves them open.

The choices trade time against errors of the cage slip and the cage speed. Each has an a priori estimate from trial
motions with few slices (a hundredth of the time of many), or a rule:

1. Slips are compared, not speeds: where the slip is 1 %, speeds that differ by 3e-4 mean slips that differ by 3 %.
   Below `SMALLEST_SLIP` the difference is relative to that slip.
2. Level: integrate levels cage-set and pocket over three orbits of the cage. Take cage-set if the mean slips over each
   orbit differ by at most 0.2 of the tolerance. Impacts in the pockets are chaotic: instantaneous speeds do not
   converge with the steps, means over orbits do.
3. Friction: take conventional friction where a table of it serves, since it costs seconds. Else integrate the motion
   at level cage-set with both frictions over all of its duration. Take effective friction if the cage slips differ by
   at most 0.3 of the tolerance, and by at most 5 %, and if the motion with conventional friction takes longer than some
   seconds.
4. Take conventional friction all the same where the cage is near skidding. The limit drags of the two frictions differ
   by 2.7 % (median) and up to 23 % over 62 random bearings (docs/trust/skidding.rst): near the limit one of the cages
   skids and the other does not, however well their speeds agreed until then.
5. Integrator: no trial. The strongest damping, from the eigenvalues of the Jacobian of the speeds by the speeds, says
   whether the motion is stiff: whether damping or accuracy (the contacts to be resolved) limits an explicit step. A
   stiff motion takes the integrator of the study, which is implicit; others an explicit one (`_Trials.integrator`).
6. Step tolerance: two motions of 5 ms, at the usual tolerance and at a thousandth of it, give the error of the cage
   speed at the end of that time (the difference from a reference solution).
7. Errors of later intervals add to it while those of earlier ones decay, since the drive of the cage pulls it back. The
   factor for the whole motion is the integral of that decay over time, from two cages with different speeds at the
   start (`error_accumulation`).
8. The error is taken to be proportional to the tolerance; scale the tolerance so that 0.2 of the requested one is used.
9. Where rollers hit their pockets, motions with different steps diverge, as neighbouring motions of any chaotic system
   do, until the play in the pockets bounds their difference. Twice the largest divergence of motions with other
   tolerances within an orbit of the cage is reported as error, too; no tolerance removes it.
10. Along a history, later times are sampled as well, from states without slip: a motion that is smooth at one speed may
   have impacts, or be stiff, at another. Contacts are damped most while the rings rest.
11. What cannot be estimated, because a trial motion fails, is taken with all detail (`FALLBACKS`), and with the step
   tolerance of the reference resolution; its error is then infinite.

Only explicit methods that resolve contacts are taken at levels with contacts: others get the cage speed right and may
miss a third of the impact force (docs/trust/dynamics.rst).

Sources: stiffness and the stability of explicit methods, E. Hairer and G. Wanner, Solving Ordinary Differential
Equations II, chapter IV; the transport of local errors to the end of a motion, E. Hairer, S. P. Norsett and G. Wanner,
Solving Ordinary Differential Equations I, chapter II.
"""

import itertools
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from functools import cached_property
from typing import Any, Final, Protocol

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import Array
from rollslip.bearing.resolution import reference_resolution
from rollslip.errors import ConvergenceError, RollslipError
from rollslip.models import IntegratorModel
from rollslip.results.text import SMALLEST_SLIP, duration
from rollslip_studies.dynamics.levels.moving_bearing import MovingBearing
from rollslip_studies.motion.time_integration import Trajectory
from rollslip_studies.motion.torque_balance import describe_near_skidding

#: Settings that a plan chooses -> the most detailed choice that needs no further data from a scene; None where that is
#: the choice of the study.
FALLBACKS: Final = {"level": "pocket", "friction": "conventional", "integrator": None}

# Fractions of the tolerances of cage slip and cage speed that the simplifications of a motion may use.
#
# They add up to 0.7 of the tolerance of the slip and of the speed. Slices and tables take fractions of the tolerance of
# friction (`dynamics.study`: a quarter and a fifth), which changes slip and speed in turn. If all of these were used,
# and had the same sign, they would be 1.15 times the tolerance; what a plan sums up of them is its estimated error.

#: Effective in place of conventional friction. Doubled, effective friction is chosen more often, and the errors
#: together may exceed the tolerance. Chosen; the largest, since this choice saves the largest part of the time.
_FRICTION_FRACTION: Final = 0.3
#: Level cage-set in place of pocket. Doubled, cage-set is chosen for looser pockets, and the errors together may exceed
#: the tolerance. Chosen: in the bearings of docs/trust/dynamics.rst play makes slips below 2 % 1.3 to 8 times as
#: large, so that cage-set is for tight pockets, large slips and loose tolerances.
_LEVEL_FRACTION: Final = 0.2
#: Steps in time. Doubled, steps grow by 15 % (order 5) to 40 % (leapfrog). Chosen.
_STEPS_FRACTION: Final = 0.2

# Limits of effective friction, whatever the tolerance.

#: Difference of the cage slips, relative to the slip, up to which effective friction is chosen. It counts for
#: tolerances above a sixth. Doubled, effective friction is chosen there where it adds a tenth to a small slip; halved,
#: it counts for tolerances of 8 %. Chosen.
_MAX_FRICTION_DIFFERENCE: Final = 0.05
#: Processor time [s] of a motion up to which conventional friction is taken, however close effective friction is.
#: Halved, motions that take 5 s become less exact to save some seconds; doubled, users wait for up to 20 s for what
#: effective friction gives within the tolerance. Chosen: some seconds.
_MAX_CONVENTIONAL_SECONDS: Final = 10.0

# Resolution of trial motions, and how long they are compared.

#: Slices of a roller. Doubled, trial motions with conventional friction take twice as long. Chosen: few enough that
#: a trial costs a hundredth of the run; tests/studies/test_dynamics_choice.py checks that the difference of the
#: frictions is within 25 % of that with 25 slices.
_TRIAL_SLICES: Final = 12
#: Relative error of tables of loads and friction. Halved, tables take longer to build. Chosen: the usual tolerance;
#: its error is common to the motions that are compared.
_TRIAL_TABLE_TOLERANCE: Final = 1e-3
#: Step tolerance over the tolerance of the cage speed. Doubled, trials are faster, and the errors of their steps
#: may add up to the differences that are to be found (0.2 and 0.3 of the tolerance). Chosen.
_TRIAL_TOLERANCE_RATIO: Final = 0.1
#: Largest step tolerance, whatever the scene requests. Chosen; it counts from a requested tolerance of 1e-2 on.
_MAX_TRIAL_TOLERANCE: Final = 1e-3
#: Orbits of the cage over which levels are compared. Doubled, the trial at level pocket takes twice as long and
#: sees slower drifts of the mean. Chosen: the first orbit contains the start.
_TRIAL_ORBITS: Final = 3
#: Samples of an orbit for its mean speed, and of the whole duration for the comparison of frictions. They protect the
#: mean from aliasing: oscillations of the cage with more than 32 periods an orbit are not resolved. Doubled, those
#: twice as fast are. It must exceed the last of `_TRIAL_CHECKS`. Chosen; samples cost nothing beside the steps.
_TRIAL_SAMPLES: Final = 64
#: Samples, of `_TRIAL_SAMPLES`, after which frictions are compared before the trial goes on: at 1/16, 1/8, 1/4 and 1/2.
#: Each check may save the rest of the trial, and costs one restart of the integrator.
_TRIAL_CHECKS: Final = (4, 8, 16, 32)

# Limits of the rule that chooses the integrator, from 144 cases of 24 random bearings (docs/trust/plan.rst).

#: Damping [1/s] up to which rk45 is taken for motions without contacts. Up to there it takes fewer evaluations of
#: the rates than rodas5p, or at most 1.6 times as many. Doubled, rk45 is also taken where its stability limits the
#: step, 3.3 over the damping.
_MAX_SMOOTH_DAMPING: Final = 1e4
#: Step tolerance below which rk45 is taken in place of leapfrog where contacts are resolved: from there on its
#: order of 5 makes up for 6 evaluations a step. Doubled, leapfrog is given up where it still takes fewer
#: evaluations. Measured on the same bearings.
_LEAPFROG_TOLERANCE: Final = 3e-8
#: Step that resolves a contact times the frequency of the contact [rad]: that of leapfrog (CONTACT in
#: kernels/rollslip_kernels/motion/leapfrog.pyx). Doubled, an impact (half a period) is resolved by 8
#: steps in place of 16.
_CONTACT_STEP: Final = 0.2
#: Damping times that step from which on a motion is stiff. The shipped bearing has 0.003 at level pocket and 0.03
#: at planar, heavy loads 0.4, films in the pockets 1.9 (docs/trust/dynamics.rst). Doubled, it exceeds the 0.3 up to
#: which leapfrog extrapolates speeds with held friction; 0.25 leaves a fifth for the damping to grow along the
#: motion.
_MAX_DAMPING_PER_STEP: Final = 0.25

# Two cages with different speeds, which show how fast an error of the cage speed decays.

#: Difference of their slips at the start. Doubled, the decay may no longer be that of a small error. Chosen: large
#: against the errors of the steps, small against the slips of the start and of skidding.
_SLIP_DIFFERENCE: Final = 1e-2
#: Step tolerance over that difference. Doubled, the decay can be followed down to 2e-5 of the difference
#: only. Chosen; at level cage-set steps are cheap.
_DECAY_TOLERANCE_RATIO: Final = 1e-5
#: Longest time that is integrated [s]; later the difference is taken to stay as large as in its last quarter.
#: Doubled, long motions of which errors decay slowly get larger steps, and the trial takes longer. Chosen.
_MAX_DECAY_DURATION: Final = 10.0
#: Samples of the decay, for its integral by the trapezoidal rule. Halved, a decay within a sample counts too much.
#: Chosen.
_DECAY_SAMPLES: Final = 256

# Motions with different step tolerances: how large the error of a tolerance is, and how far motions diverge.

#: Duration [s] of the motion that gives the error of steps. Doubled, the trial takes twice as long and averages
#: over more impacts. Chosen: more than a hundred steps at level pocket (typically 4e-5 s), less than an orbit.
_STEP_TRIAL_DURATION: Final = 5e-3
#: Usual step tolerance: that of the trial, the largest that is chosen, and the default of the study. Larger steps
#: are not known to be right where a contact opens; at this one leapfrog takes its largest step, and the force on
#: pockets is within 1 % (docs/trust/dynamics.rst).
USUAL_TOLERANCE: Final = 1e-5
#: Tolerance of the reference solution over the usual one. Doubled, the reference takes 13 % fewer steps (order 5).
#: Chosen: the error of the reference is then negligible against that of the trial.
_REFERENCE_RATIO: Final = 1e-3
#: Divisors of the tolerance of the motions whose divergence is measured. Two, since one pair may stay close by
#: chance; near 1, since what is sought is the effect of chance and not the error. Chosen.
_REFINEMENTS: Final = (4.0, 16.0)
#: Pieces of an orbit of the cage after each of which the work is checked. Doubled, a trial stops sooner after the
#: limit of evaluations, and restarts the integrators more often. Chosen.
_DIVERGENCE_PIECES: Final = 8
#: Samples of a piece at which speeds are compared. Halved, the largest difference may be missed. Chosen.
_DIVERGENCE_SAMPLES: Final = 16
#: Evaluations of the rates after which no further piece begins: some seconds. Doubled, more of the orbit is seen,
#: and a plan may take twice as long. Chosen.
_MAX_EVALUATIONS: Final = 200_000
#: Factor from the largest divergence of the trial motions to the reported error, because other motions may diverge
#: more. Halved, the reported error is less than the true one in 9 of the 60 scenes of
#: tools/references/motions_by_scipy.csv at levels pocket and planar; with 2 only in some of the five whose reference
#: solutions diverge themselves (by 0.7 to 1.7 times the error). Doubled, all reported errors double.
_SAFETY_FACTOR: Final = 2.0
#: Samples of a history for the largest speeds without slip. Halved, a short peak may be missed. Chosen.
_SPEED_SAMPLES: Final = 256


class MotionStudy(Protocol):
    """What the choice of a motion, and the estimate of its cost, require of a study that integrates motions."""

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
        """Duration of the motion [s]."""

    def with_settings(self, **settings: Any) -> "MotionStudy":
        """Return the study with other settings."""

    @property
    def points(self) -> int:
        """Number of stored times."""

    @property
    def relative_tolerance(self) -> float:
        """Step tolerance, relative to the magnitude of an unknown."""

    def moving(self, assembly: Assembly) -> MovingBearing:
        """Return the system of equations of motion of a bearing."""

    def trial_motion(
        self,
        moving: MovingBearing,
        times: Array,
        tolerance: float,
        before: Trajectory | None = None,
    ) -> Trajectory:
        """Return the motion at some times [s] with a step tolerance, from its start or from the end of another."""

    def method(self, assembly: Assembly) -> IntegratorModel:
        """Return the integrator."""

    def cost(self, assembly: Assembly) -> Mapping[str, float]:
        """Return processor times [s] by name, that of the motion among them."""


@attrs.frozen(kw_only=True)
class MotionChoice:
    """Choices of friction, level and integrator by setting."""

    #: Setting -> choice.
    settings: Mapping[str, Any] = attrs.field(factory=dict)
    #: Setting -> reason of the choice, for the plan.
    reasons: Mapping[str, str] = attrs.field(factory=dict)
    #: Setting -> result -> estimated error of a simpler choice; nothing for choices without loss.
    errors: Mapping[str, Mapping[str, float]] = attrs.field(factory=dict)


@attrs.frozen
class Choice:
    """Choice of one setting."""

    #: Value of the setting.
    value: Any
    #: Reason, for the plan.
    reason: str
    #: Estimated errors of cage speed and cage slip; nothing for a choice without loss.
    errors: Mapping[str, float] = attrs.field(factory=dict)


def with_coarse_slices(assembly: Assembly) -> Assembly:
    """Return a bearing with the resolution of trial motions; all of them share its loads and tables."""
    resolution = assembly.resolution
    return assembly.at(
        attrs.evolve(
            resolution,
            slices=min(_TRIAL_SLICES, resolution.slices),
            quadrature="equal",
            table_tolerance=_TRIAL_TABLE_TOLERANCE,
        )
    )


def error_accumulation(study: MotionStudy, coarse: Assembly, short_duration: float) -> float:
    """Return the error of the cage speed over a whole motion, relative to the error over a short time.

    Each interval adds an error, and the drive of the cage lets it decay. With g(t) the fraction of an error that is
    left after the time t, the errors of all intervals add up to the integral of g over the duration. The difference of
    two cages with different speeds at the start, at level cage-set, shows g. Where their speeds do not approach each
    other, the integral is the duration.

    Parameters
    ----------
    study : MotionStudy
        The study, without a history.
    coarse : Assembly
        The bearing with the resolution of trial motions.
    short_duration : float
        The short time [s].

    Returns
    -------
    float
        The factor, from 1 to the duration over the short time; the latter if the trial motion fails.
    """
    end = min(study.duration, _MAX_DECAY_DURATION)
    times = np.linspace(0.0, end, _DECAY_SAMPLES + 1)
    cage_set = study.with_settings(
        level="cage-set", friction="constant" if study.friction == "constant" else "effective"
    )
    moving = cage_set.moving(coarse)
    tolerance = _DECAY_TOLERANCE_RATIO * _SLIP_DIFFERENCE
    speeds = []
    for slip in (study.cage_slip, study.cage_slip + _SLIP_DIFFERENCE):
        motion = cage_set.with_settings(cage_slip=slip).trial_motion(moving, times, tolerance)
        if motion.outcome != "finished":
            return study.duration / short_duration
        speeds.append(np.asarray(moving.split(motion.y)["cage_speed"]))
    decay = np.abs(speeds[1] - speeds[0]) / abs(speeds[1][0] - speeds[0][0])
    later = (study.duration - end) * float(decay[-_DECAY_SAMPLES // 4 :].max())
    integral = min(study.duration, float(np.trapezoid(decay, times)) + later)
    return max(1.0, integral / short_duration)


def choose_motion(study: MotionStudy, assembly: Assembly, named: Collection[str]) -> MotionChoice:
    """Choose those of friction, level and integrator that a scene does not name.

    Parameters
    ----------
    study : MotionStudy
        The study, with the choices that the scene names.
    assembly : Assembly
        The bearing.
    named : collection of str
        Settings that are not to be chosen.
    """
    unnamed = [name for name in FALLBACKS if name not in named]
    if not unnamed:
        return MotionChoice()
    if assembly.scene.accuracy.exact:
        exact = {name: value for name in unnamed if (value := FALLBACKS[name]) is not None}
        return MotionChoice(
            settings=exact, reasons=dict.fromkeys(exact, "an exact result is requested")
        )
    study = study.with_settings(film_limit=0.0)  # an event, which does not change the motion
    trials = _Trials(assembly)
    choosers: dict[str, Callable[[MotionStudy], Choice]] = {
        "level": trials.level,
        "friction": trials.friction,
        "integrator": trials.integrator,
    }
    settings = dict[str, Any]()
    reasons = dict[str, str]()
    errors = dict[str, Mapping[str, float]]()
    for name in unnamed:
        try:
            choice = choosers[name](study.with_settings(**settings))
        except RollslipError as error:
            choice = Choice(
                FALLBACKS[name] or getattr(study, name),
                f"the error of a simpler choice cannot be estimated: {error}",
            )
        settings[name] = choice.value
        reasons[name] = choice.reason
        if choice.errors:
            errors[name] = choice.errors
    return MotionChoice(settings=settings, reasons=reasons, errors=errors)


@attrs.frozen(eq=False)
class _Trials:
    """Trial motions of a bearing; a method for each setting of `FALLBACKS`."""

    assembly: Assembly
    _systems: dict[tuple[str, str], MovingBearing] = attrs.field(factory=dict, init=False)

    @cached_property
    def coarse(self) -> Assembly:
        """The bearing with the resolution of trial motions."""
        return with_coarse_slices(self.assembly)

    @property
    def slip_tolerance(self) -> float:
        """Tolerance of the cage slip."""
        return self.assembly.scene.accuracy.of("cage_slip")

    def moving(self, study: MotionStudy) -> MovingBearing:
        """Return the equations of motion, cached by friction and level."""
        if (key := (study.friction, study.level)) not in self._systems:
            self._systems[key] = study.moving(self.coarse)
        return self._systems[key]

    def cage_speeds(
        self, study: MotionStudy, times: Array, before: Trajectory | None = None
    ) -> tuple[Array, Trajectory]:
        """Return cage speeds at some times, relative to the epicyclic one, and the motion that has them."""
        moving = self.moving(study)
        requested = self.assembly.scene.accuracy.of("cage_speed")
        tolerance = min(_TRIAL_TOLERANCE_RATIO * requested, _MAX_TRIAL_TOLERANCE)
        motion = study.trial_motion(moving, times, tolerance, before)
        if motion.outcome != "finished":
            raise ConvergenceError(
                f"{study.friction} friction at level {study.level}: {motion.message}"
            )
        speeds = moving.split(motion.y)["cage_speed"] / self.coarse.kinematics.epicyclic_cage_speed
        return np.asarray(speeds), motion

    def level(self, study: MotionStudy) -> Choice:
        """Choose cage-set if play in the pockets does not change the mean slip of the cage in any orbit."""
        speed = abs(self.coarse.kinematics.epicyclic_cage_speed)
        orbits = int(min(study.duration * speed / (2.0 * math.pi), _TRIAL_ORBITS))
        end = orbits * 2.0 * math.pi / speed if orbits else study.duration
        times = np.linspace(0.0, end, max(orbits, 1) * _TRIAL_SAMPLES + 1)
        friction = "constant" if study.friction == "constant" else "effective"
        cage_set, pocket = (
            1.0
            - self.cage_speeds(study.with_settings(friction=friction, level=level), times)[0][1:]
            for level in ("cage-set", "pocket")
        )
        means = [slip.reshape(-1, _TRIAL_SAMPLES).mean(axis=1) for slip in (cage_set, pocket)]
        errors = _slip_errors(*means)
        allowed = _LEVEL_FRACTION * self.slip_tolerance
        change = (
            "play in the pockets changes the mean slip of the cage by up to "
            f"{100.0 * errors['cage_slip']:.2g} % of it (and lets it oscillate by {np.ptp(pocket - cage_set):.1e})"
        )
        limit = (
            f"the {100.0 * allowed:.2g} % allowed for leaving it out; planar is taken only if the scene names it, with "
            "its masses"
        )
        if errors["cage_slip"] <= allowed:
            return Choice("cage-set", f"{change}, less than {limit}", errors)
        return Choice("pocket", f"{change}, more than {limit}")

    def friction(self, study: MotionStudy) -> Choice:
        """Choose effective friction if it saves time, gives the same cage slip, and the cage is not near skidding.

        The trial ends as soon as the difference of the cage slips exceeds what is allowed.
        """
        conventional = study.with_settings(friction="conventional")
        if not conventional.moving(self.assembly).friction.uses_slices:
            return Choice(
                "conventional", "a table of it takes hardly longer than effective friction"
            )
        allowed = min(_FRICTION_FRACTION * self.slip_tolerance, _MAX_FRICTION_DIFFERENCE)
        conventional_motion = effective_motion = None
        errors = dict[str, float]()
        max_slip = 0.0
        times = np.linspace(0.0, study.duration, _TRIAL_SAMPLES + 1)[1:]
        for interval in np.split(times, _TRIAL_CHECKS):
            # both motions go on from where they ended in the interval before
            conventional_speed, conventional_motion = self.cage_speeds(
                conventional.with_settings(level="cage-set"), interval, conventional_motion
            )
            effective_speed, effective_motion = self.cage_speeds(
                study.with_settings(friction="effective", level="cage-set"),
                interval,
                effective_motion,
            )
            later = _slip_errors(1.0 - conventional_speed, 1.0 - effective_speed)
            errors = {name: max(error, errors.get(name, 0.0)) for name, error in later.items()}
            max_slip = max(max_slip, 1.0 - float(conventional_speed.min()))
            if errors["cage_slip"] > allowed:
                break
        after = "" if interval[-1] == study.duration else f" after {interval[-1]:.2g} s already"
        difference = (
            "with few slices the two frictions give cage slips that differ by up to "
            f"{100.0 * errors['cage_slip']:.2g} % of the slip{after}"
        )
        if errors["cage_slip"] > allowed:
            return Choice(
                "conventional",
                f"{difference}, more than the {100.0 * allowed:.2g} % allowed for effective friction",
            )
        if reason_near_skidding := describe_near_skidding(self.coarse, max_slip):
            return Choice("conventional", f"{difference}, but {reason_near_skidding}")
        seconds = conventional.cost(self.assembly)["motion"]
        if seconds <= _MAX_CONVENTIONAL_SECONDS:
            return Choice(
                "conventional", f"{difference}, but conventional friction takes seconds only"
            )
        return Choice(
            "effective",
            f"{difference}, less than the {100.0 * allowed:.2g} % allowed for that, and conventional friction takes "
            f"{duration(seconds)}",
            errors,
        )

    def integrator(self, study: MotionStudy) -> Choice:
        """Choose the integrator by the strongest damping at the start and in sampled states without slip.

        - Without contacts (level cage-set): rk45 up to a limit of the damping, beyond it the implicit one of the study.
        - Films in the pockets, or stiff in all sampled states: the implicit one.
        - Stiff in some of the states: rk45, whose steps follow the error; they are short, for a short time.
        - Not stiff: leapfrog, which resolves contacts; rk45 for a tight step tolerance.

        The step tolerance is that of the scene, or the usual one: the planned one follows from the integrator, and is
        not known yet. The shipped bearing gets 2.5e-7 at an accuracy of 1e-5, which is above the limit of this rule.
        """
        moving = self.moving(study)
        implicit = study.method(self.assembly).name
        times, states = moving.sample_states()
        without_slip = [_damping(moving, t, y) for t, y in zip(times.tolist(), states, strict=True)]
        strongest = max(
            *without_slip,
            _damping(moving, 0.0, np.asarray(moving.initial(study.cage_slip, study.roller_slip))),
        )
        damping = f"speeds are damped by up to {strongest:.2g}/s"
        contact = moving.system.frequencies[0]
        if not contact and strongest > _MAX_SMOOTH_DAMPING:
            return Choice(
                implicit,
                f"{damping}, more than the {_MAX_SMOOTH_DAMPING:g}/s up to which an explicit method takes fewer rates",
            )
        if not contact:
            return Choice(
                "rk45", f"{damping}, which does not limit the steps of an explicit method"
            )
        if self.assembly.cage.pocket_contact == "film":
            return Choice(
                implicit,
                "the motion is stiff: films in the pockets are stiff when they are squeezed",
            )
        # in each sampled state the strongest damping is at least this
        smallest = min(without_slip)
        step = _CONTACT_STEP / contact
        if smallest * step > _MAX_DAMPING_PER_STEP:
            return Choice(
                implicit,
                f"the motion is stiff: its strongest damping is {smallest:.2g}/s at least, {smallest * step:.2g} in a "
                f"step of {step:.2g} s that resolves its contacts, more than the {_MAX_DAMPING_PER_STEP:g} of explicit "
                "steps",
            )
        if strongest * step > _MAX_DAMPING_PER_STEP:
            return Choice(
                "rk45",
                f"{damping}, but only for a short time, in which explicit steps follow their error",
            )
        oscillates = f"the motion oscillates, at up to {max(moving.system.frequencies):.2g} rad/s, and {damping}"
        if study.relative_tolerance < _LEAPFROG_TOLERANCE:
            return Choice(
                "rk45", f"{oscillates}: explicit steps of a high order are better at this tolerance"
            )
        return Choice(
            "leapfrog", f"{oscillates}: explicit steps that resolve contacts are sufficient"
        )


def _slip_errors(slip: Array, other: Array) -> dict[str, float]:
    """Return the largest difference of two cage slips, as error of the cage speed and of the slip."""
    difference = np.abs(other - slip)
    largest = np.maximum(np.maximum(np.abs(slip), np.abs(other)), SMALLEST_SLIP)
    return {
        "cage_speed": float(difference.max()),
        "cage_slip": float((difference / largest).max()),
    }


def _damping(moving: MovingBearing, t: float, y: Array) -> float:
    """Return the strongest damping [1/s] at a state: minus the least real part of the eigenvalues, speeds by speeds.

    An oscillation decays at half of the damping of its speed.
    """
    speeds = ~moving.system.places
    try:
        jacobian = moving.system.jacobian(t, y)
    except Exception as fault:  # of a third-party drag or friction: the run reports which
        raise ConvergenceError(f"the rates fail at t = {t:.3g} s: {fault}") from fault
    return max(0.0, float(-np.linalg.eigvals(jacobian[np.ix_(speeds, speeds)]).real.min()))


def step_tolerance(
    study: MotionStudy, assembly: Assembly, estimates_decay: bool
) -> tuple[float, float]:
    """Return the step tolerance, and the error of the speeds with it, relative to the largest speeds without slip.

    If a trial motion fails, the tolerance is that of the reference resolution, and the error is infinite.

    Parameters
    ----------
    study : MotionStudy
        The study, with its choices.
    assembly : Assembly
        The bearing with the resolution of the run.
    estimates_decay : bool
        Whether the decay of errors of the cage speed is estimated; else errors add up over all of the duration.
    """
    coarse = with_coarse_slices(assembly)
    moving = study.moving(assembly)
    if moving.friction.uses_slices:
        moving = study.moving(coarse)
    trial_duration = min(_STEP_TRIAL_DURATION, study.duration)
    # a motion at level cage-set takes no longer than the trial that shows how its errors decay
    accumulation = study.duration / trial_duration
    if estimates_decay:
        accumulation = error_accumulation(study, coarse, trial_duration)
    cage_errors = _divergence(
        study, moving, (USUAL_TOLERANCE, _REFERENCE_RATIO * USUAL_TOLERANCE), [trial_duration]
    )[:, 0, -1]
    error = float(np.nan_to_num(cage_errors, nan=np.inf, posinf=np.inf).max()) * accumulation
    allowed = _STEPS_FRACTION * assembly.scene.accuracy.of("cage_speed")
    lowest = reference_resolution(assembly.scene).integrator_tolerance or 0.0
    tolerance = USUAL_TOLERANCE
    if error > allowed:  # it is proportional to the tolerance
        tolerance = max(USUAL_TOLERANCE * allowed / error, lowest)
    step_error = error * tolerance / USUAL_TOLERANCE
    if study.level == "cage-set":
        return tolerance, step_error
    return tolerance, max(step_error, _orbit_divergence(study, moving, tolerance))


def _divergence(
    study: MotionStudy, moving: MovingBearing, tolerances: Sequence[float], ends: Sequence[float]
) -> Array:
    """Return how far motions with smaller step tolerances diverge from a first one, at some times.

    All start from the same state: that of the motion, and along a history also from states without slip in its middle
    and late.

    Parameters
    ----------
    study : MotionStudy
        The study.
    moving : MovingBearing
        The equations of motion.
    tolerances : sequence of float
        Step tolerance of the first motion, and of the others.
    ends : sequence of float
        Ends of the pieces [s], each with as many samples; the rest is left out after too many evaluations.

    Returns
    -------
    ndarray
        Largest differences of speeds of cage and rollers, relative to the largest without slip, (starts, 2, samples of
        all pieces); NaN at times that were left out, infinite after a motion failed: two that were not compared do not
        agree.
    """
    max_speeds = np.array(_max_speeds(moving))[:, None]
    starts = _starting_points(study, moving, tolerances[0], ends[-1])
    differences = np.full((len(starts), 2, len(ends), _DIVERGENCE_SAMPLES), np.nan)
    for start_differences, start in zip(differences, starts, strict=True):
        motions = [start] * len(tolerances)
        evaluations = 0
        for k, (first_time, last_time) in enumerate(itertools.pairwise((0.0, *ends))):
            times = start.last_t + np.linspace(first_time, last_time, _DIVERGENCE_SAMPLES + 1)[1:]
            motions = [
                study.trial_motion(moving, times, tolerance, motion)
                for tolerance, motion in zip(tolerances, motions, strict=True)
            ]
            evaluations += sum(motion.evaluations for motion in motions)
            count = min(motion.t.size for motion in motions)
            first, *others = (moving.split(motion.y[:count]) for motion in motions)
            for other in others:
                cage, spin = (
                    np.abs(other[name] - first[name]) for name in ("cage_speed", "roller_spin")
                )
                piece = start_differences[:, k, :count]
                # of both finer motions the larger difference; the piece is NaN before the first
                piece[:] = np.fmax(piece, np.stack((cage, spin.max(axis=-1))) / max_speeds)
            if count < _DIVERGENCE_SAMPLES:
                start_differences[:, k, count:] = np.inf
            if evaluations > _MAX_EVALUATIONS or count < _DIVERGENCE_SAMPLES:
                break
    return differences.reshape(len(starts), 2, -1)


def _starting_points(
    study: MotionStudy, moving: MovingBearing, tolerance: float, span: float
) -> list[Trajectory]:
    """Return motions of no duration: at the start, and of a history also in its middle and a span [s] before its end.

    Without slip at the later times.
    """
    start = study.trial_motion(moving, np.zeros(1), tolerance)
    times, states = moving.sample_states()
    later = np.flatnonzero((times > 0.0) & (times + span <= times[-1])).tolist()
    sampled = {later[len(later) // 2], later[-1]} if later else set()
    return [
        start,
        *(attrs.evolve(start, last_t=float(times[k]), last_y=states[k]) for k in sampled),
    ]


def _max_speeds(moving: MovingBearing) -> tuple[float, ...]:
    """Return the largest speeds of cage and rollers without slip [rad/s]."""
    sampled, _ = moving.sample_states()
    return tuple(
        float(np.nanmax(np.abs(speeds)))
        for speeds in moving.epicyclic_speeds(
            np.union1d(sampled, np.linspace(0.0, sampled[-1], _SPEED_SAMPLES + 1))
        )
    )


def _orbit_divergence(study: MotionStudy, moving: MovingBearing, tolerance: float) -> float:
    """Return the largest divergence within an orbit of the cage that a step tolerance leads to, with its safety factor.

    If motions of that tolerance take too many evaluations for an orbit, motions of the usual tolerance are added.
    """
    span = min(study.duration, 2.0 * math.pi / _max_speeds(moving)[0])
    ends = [span * k / _DIVERGENCE_PIECES for k in range(1, _DIVERGENCE_PIECES + 1)]
    largest = 0.0
    for own in dict.fromkeys((tolerance, USUAL_TOLERANCE)):
        finer = [own / divisor for divisor in _REFINEMENTS]
        differences = _divergence(study, moving, (own, *finer), ends)
        largest = max(largest, _SAFETY_FACTOR * float(np.nanmax(differences, initial=0.0)))
        if not np.isnan(differences).any():
            break
    return largest
