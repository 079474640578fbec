"""Estimate the processor time of a motion before its run: evaluations of the rates times the time of one.

1. Integrate the start of the motion over intervals of which each doubles the time, up to some thousand evaluations or
   0.3 s: impacts begin late, and a start is abrupt.
2. Extrapolate the evaluations per second of motion, constant from the last interval on. This is 0.6 to 2.2 times the
   evaluations of 27 motions of shipped scenes, and 0.8 to 1.2 times those of 25 of them.
3. A start from rest is the stiffest part of a motion, and extrapolates to far too many. Where many evaluations remain,
   integrate short motions from later times of a history, from states without slip, and interpolate the evaluations per
   second between them by a power of the time. Take the smaller of both numbers.
4. Measure the time of an evaluation by repeating the last interval. Conventional friction evaluated slice by slice is
   integrated with few slices, since the number of slices hardly changes the steps; the additional time of an evaluation
   with all slices is measured directly.
5. Measure the time of a stored point, whose films are those of all slices.
6. Loads and tables are built as the run needs them, and cached: the run pays only for looking them up.
"""

import math
import time
from functools import partial
from typing import Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import Array
from rollslip.studies.timing import processor_time
from rollslip_studies.dynamics.choice import MotionStudy, with_coarse_slices
from rollslip_studies.dynamics.levels.moving_bearing import MovingBearing
from rollslip_studies.motion.time_integration import Trajectory

#: Evaluations of the rates after which the trial motion ends. Doubled, plans take longer where an evaluation takes less
#: than 15 us (else `_TRIAL_SECONDS` ends the trial), and later times of a history are sampled for longer motions only.
#: Chosen.
_TRIAL_EVALUATIONS: Final = 20_000
#: Processor time [s] after which the trial motion ends. Doubled, plans take longer, and estimates see more of the
#: motion. Chosen: a delay that is hardly noticed.
_TRIAL_SECONDS: Final = 0.3
#: First interval of a trial motion [s]. Doubled, the trial may end after fewer intervals than the extrapolation needs.
#: Chosen: a few steps at level pocket, 4e-5 s each.
_FIRST_INTERVAL: Final = 3e-4
#: Evaluations of a short motion from a later time of a history. Halved, the first steps, which the integrator still has
#: to choose, weigh more. Chosen: some ten steps.
_LATER_EVALUATIONS: Final = 200
#: Stored points whose time is measured together. Halved, the time of a call counts twice as much in that of a point.
#: Chosen: ten, so that it hardly counts.
_TIMED_POINTS: Final = 10


def costs_of(study: MotionStudy, assembly: Assembly) -> dict[str, float]:
    """Return the processor time [s] of the tables and the motion of a study, by name.

    Parameters
    ----------
    study : MotionStudy
        The study, with its choices.
    assembly : Assembly
        The bearing with the resolution of the run.
    """
    tables = processor_time(partial(study.moving, assembly))
    moving = study.moving(assembly)
    sliced = study.friction == "conventional" and moving.friction.uses_slices
    trial = study.moving(with_coarse_slices(assembly)) if sliced else moving
    evaluations, seconds, last = _estimate_evaluations(study, trial)
    point_seconds = seconds
    if last.outcome != "failed":  # else the run reports the error
        if sliced:
            whole, coarse = (
                processor_time(partial(bearing.system, last.last_t, last.last_y))
                for bearing in (moving, trial)
            )
            seconds += max(whole - coarse, 0.0)
        times = np.full(_TIMED_POINTS, last.last_t)
        states = np.tile(last.last_y, (_TIMED_POINTS, 1))
        point_seconds = processor_time(partial(moving.outputs, times, states)) / _TIMED_POINTS
    return {"tables": tables, "motion": seconds * evaluations + point_seconds * study.points}


def _estimate_evaluations(
    study: MotionStudy, moving: MovingBearing
) -> tuple[float, float, Trajectory]:
    """Return the evaluations of the rates in the whole motion, the time [s] of one, and the last trial motion."""
    ends = [0.0]
    counts = [0]
    before = None
    found = None
    start = time.process_time()
    while (
        ends[-1] < study.duration
        and sum(counts) < _TRIAL_EVALUATIONS
        and time.process_time() - start < _TRIAL_SECONDS
    ):
        ends.append(min(max(2.0 * ends[-1], _FIRST_INTERVAL), study.duration))
        before = found
        found = study.trial_motion(moving, np.array(ends[-1:]), study.relative_tolerance, found)
        counts.append(found.evaluations)
        if found.outcome != "finished":
            break
    # repeat the last interval, now that its loads are cached
    assert found is not None
    seconds = processor_time(
        partial(study.trial_motion, moving, np.array(ends[-1:]), study.relative_tolerance, before),
        1,
    )
    rate = counts[-1] / (ends[-1] - ends[-2])
    remaining = rate * (study.duration - ends[-1])
    if found.outcome == "finished" and remaining > _TRIAL_EVALUATIONS:
        remaining = min(remaining, _sample_history(study, moving, found, rate))
    return sum(counts) + remaining, seconds / max(counts[-1], 1), found


def _sample_history(
    study: MotionStudy, moving: MovingBearing, last: Trajectory, rate: float
) -> float:
    """Return the remaining evaluations after a trial motion, by short motions from later times of a history.

    Between two sampled times the evaluations per second of motion follow a power of the time. ``rate`` has those at the
    end of the trial motion; infinity where there are no later times, or a motion fails.
    """
    from scipy.special import boxcox

    times, states = moving.sample_states()
    remaining = 0.0
    before = last.last_t
    for t, y in zip(times.tolist(), states, strict=True):
        if not before < t < study.duration:
            continue
        later = _rate_at(study, moving, last, t, y)
        if math.isinf(later):
            return math.inf
        power = 1.0 + math.log(later / rate) / math.log(t / before)
        # Box and Cox's transformation is the integral of a power of the time
        remaining += before * rate * float(boxcox(t / before, power))
        before = t
        rate = later
    return remaining + rate * (study.duration - before) if before > last.last_t else math.inf


def _rate_at(
    study: MotionStudy, moving: MovingBearing, last: Trajectory, t: float, y: Array
) -> float:
    """Return the evaluations per second of a motion that starts at a time [s] from a state; infinity if it fails."""
    start = attrs.evolve(last, last_t=t, last_y=y, last_step=0.0, last_state=np.zeros(0))
    span = _FIRST_INTERVAL
    evaluations = 0
    while evaluations < _LATER_EVALUATIONS and t + span < study.duration:
        span *= 2.0
        found = study.trial_motion(
            moving, np.array([min(t + span, study.duration)]), study.relative_tolerance, start
        )
        evaluations = found.evaluations
        if found.outcome != "finished":
            return math.inf
    return max(evaluations, 1) / min(span, study.duration - t)
