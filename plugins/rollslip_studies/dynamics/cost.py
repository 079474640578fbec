"""What a motion will cost, from its beginning.

- The motion is gone through for some thousands of steps, in stretches of which each is as long as all before: impacts
  begin late, and a beginning is abrupt. The rest is taken to go on as the last stretch, or, where that took clearly
  fewer evaluations a second than the one before, to take fewer yet with every doubling of the time.
- A start from rest is the stiffest part of a motion, and tells nothing of the rest of it: where much is to come, later
  instants of a history are looked at too, from states without slip.
- Conventional friction that asks for slices is tried with few. Its evaluations are those of many slices; what these
  cost more is measured apart. So is what the stored instants cost, whose films are those of all slices.
- Loads and tables are built for it as the run will need them, and kept: of them the run pays what finding them costs.
"""

import math
import time
from functools import partial
from typing import Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.studies.timing import timed
from rollslip_studies.dynamics.choice import MotionStudy, with_coarse_slices
from rollslip_studies.dynamics.levels.moving_bearing import MovingBearing
from rollslip_studies.motion.time_integration import Trajectory

#: Evaluations of the rates that a look takes, its time of the processor [s] at most, and its first stretch [s].
_ENOUGH: Final = 20_000
_LOOK = 0.3
_FIRST = 3e-4
#: Evaluations that a look at a later instant of a history takes.
_FEW: Final = 200
#: Evaluations that tell what one costs, and the time [s] from which that is told well.
_CALLS: Final = 10
_SHORT: Final = 0.01
#: Evaluations a second over those of the stretch before: up to the first they fall, at least to the other.
_FALLS = 0.8
_FASTEST = 0.5


def costs_of(study: MotionStudy, assembly: Assembly) -> dict[str, float]:
    """Return the time [s] that the tables and the motion of a study will take."""
    study.moving(assembly)
    moving = study.moving(assembly)
    tables = timed(partial(study.moving, assembly), 1)
    sliced = study.friction == "conventional" and moving.friction.by_slices
    tried = study.moving(with_coarse_slices(assembly)) if sliced else moving
    evaluations, each, last = _foreseen(study, tried)
    stored = each
    if last.outcome != "failed":  # a fault is for the run to tell
        if sliced:
            each += max(_evaluation(moving, last) - _evaluation(tried, last), 0.0)
        stored = _stored(moving, last, study.points)
    return {"tables": tables, "motion": each * evaluations + stored * study.points}


def _foreseen(study: MotionStudy, moving: MovingBearing) -> tuple[float, float, Trajectory]:
    """Evaluations of the rates in the whole motion, the time [s] of each, and where the look at it ended."""
    ends = [0.0]
    counts = [0]
    before = None
    found = None
    begin = time.process_time()
    while (
        ends[-1] < study.duration and sum(counts) < _ENOUGH and time.process_time() - begin < _LOOK
    ):
        ends.append(min(max(2.0 * ends[-1], _FIRST), study.duration))
        before = found
        found = study.trial_motion(moving, np.array(ends[-1:]), study.relative_tolerance, found)
        counts.append(found.evaluations)
        if found.outcome != "finished":
            break
    # again, now that the loads there are known
    assert found is not None
    seconds = timed(
        partial(study.trial_motion, moving, np.array(ends[-1:]), study.relative_tolerance, before),
        1,
    )
    ahead = _ahead(ends, counts, study.duration)
    if found.outcome == "finished" and ahead > _ENOUGH:
        ahead = min(ahead, _on_the_way(study, moving, found, counts[-1] / (ends[-1] - ends[-2])))
    return sum(counts) + ahead, seconds / max(counts[-1], 1), found


def _on_the_way(study: MotionStudy, moving: MovingBearing, at: Trajectory, pace: float) -> float:
    """Evaluations to come by those of short motions from later instants of a history, a power of time between."""
    times, states = moving.sample_states()
    ahead = 0.0
    before = at.last_t
    for t, y in zip(times.tolist(), states, strict=True):
        if not before < t < study.duration:
            continue
        begin = attrs.evolve(at, last_t=t, last_y=y, last_step=0.0, last_state=np.zeros(0))
        span = _FIRST
        evaluations = 0
        while evaluations < _FEW and t + span < study.duration:
            span *= 2.0
            tried = study.trial_motion(
                moving, np.array([min(t + span, study.duration)]), study.relative_tolerance, begin
            )
            evaluations = tried.evaluations
            if tried.outcome != "finished":
                return math.inf
        here = max(evaluations, 1) / min(span, study.duration - t)
        power = 1.0 + math.log(here / pace) / math.log(t / before)
        ahead += (
            before
            * pace
            * (math.log(t / before) if power == 0.0 else ((t / before) ** power - 1.0) / power)
        )
        before = t
        pace = here
    return ahead + pace * (study.duration - before) if before > at.last_t else math.inf


def _ahead(ends: list[float], counts: list[int], duration: float) -> float:
    """Evaluations of the rates to come, by those of the stretches up to some times [s]."""
    paces = [
        count / (end - start) for count, start, end in zip(counts[1:], ends, ends[1:], strict=False)
    ]
    at = ends[-1]
    pace = paces[-1]
    ratio = paces[-1] / max(paces[-2], 1e-300) if len(paces) > 1 else 1.0
    falls = max(ratio, _FASTEST) if ratio < _FALLS else 1.0
    ahead = 0.0
    while at < duration:
        to = min(2.0 * at, duration)
        pace *= falls
        ahead += pace * (to - at)
        at = to
    return ahead


def _stored(moving: MovingBearing, at: Trajectory, points: int) -> float:
    """Time [s] of what goes with a stored instant, of which more cost less each."""
    count = 1
    seconds = 0.0
    while count < points and seconds < _SHORT:
        enough = math.ceil(2.0 * _SHORT / max(seconds, 1e-9) * count) if seconds else _CALLS
        count = min(_CALLS * count, enough, points)
        states = np.array([at.last_y] * count)
        times = np.full(count, at.last_t)
        begin = time.process_time()
        moving.outputs(times, states)
        seconds = time.process_time() - begin
    return seconds / count


def _evaluation(moving: MovingBearing, at: Trajectory) -> float:
    """Time [s] of an evaluation of the rates, once the loads there are known."""
    moving.system(at.last_t, at.last_y)
    begin = time.process_time()
    for _ in range(_CALLS):
        moving.system(at.last_t, at.last_y)
    return (time.process_time() - begin) / _CALLS
