"""What a motion will cost, from its beginning.

- The motion is gone through for some thousands of steps, in stretches of which each is as long as all before: impacts
  begin late, and a beginning is abrupt. The rest is taken to go on as the last stretch.
- Conventional friction is tried with few slices. Its evaluations are those of many slices; what these cost more is
  measured apart.
- Loads and tables are built for it as the run will need them, and kept: of them the run pays what finding them costs.
"""

import time
from functools import partial
from typing import Final

import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.motion.moving_bearing import MovingBearing
from rollslip.motion.time_integration import Trajectory
from rollslip.studies.dynamics.choice import Movable, with_few_slices
from rollslip.studies.timing import timed

#: Evaluations of the rates that a look takes, its time of the processor [s] at most, and its first stretch [s].
_ENOUGH: Final = 20_000
_LOOK, _FIRST = 0.3, 3e-4
#: Evaluations that tell what one costs.
_CALLS: Final = 10


def costs_of(study: Movable, assembly: Assembly) -> dict[str, float]:
    """Return the time [s] that the tables and the motion of a study will take."""
    study.moving(assembly)
    moving = study.moving(assembly)
    tables = timed(partial(study.moving, assembly), 1)
    tried = study.moving(with_few_slices(assembly)) if study.friction == "conventional" else moving
    evaluations, each, last = _foreseen(study, tried)
    if tried is not moving and last.outcome != "failed":  # a fault is for the run to tell
        each += _evaluation(moving, last) - _evaluation(tried, last)
    return {"tables": tables, "motion": each * (evaluations + study.points)}


def _foreseen(study: Movable, moving: MovingBearing) -> tuple[float, float, Trajectory]:
    """Evaluations of the rates in the whole motion, the time [s] of each, and where the look at it ended."""
    ends, counts = [0.0], [0]
    before, found = None, None
    begin = time.process_time()
    while ends[-1] < study.duration and sum(counts) < _ENOUGH and time.process_time() - begin < _LOOK:
        ends.append(min(max(2.0 * ends[-1], _FIRST), study.duration))
        before, found = found, study.tried(moving, np.array(ends[-1:]), study.relative_tolerance, found)
        counts.append(found.evaluations)
        if found.outcome != "finished":
            break
    # again, now that the loads there are known
    assert found is not None
    seconds = timed(partial(study.tried, moving, np.array(ends[-1:]), study.relative_tolerance, before), 1)
    pace = counts[-1] / (ends[-1] - ends[-2])
    return sum(counts) + pace * (study.duration - ends[-1]), seconds / max(counts[-1], 1), found


def _evaluation(moving: MovingBearing, at: Trajectory) -> float:
    """Time [s] of an evaluation of the rates, once the loads there are known."""
    moving.system(at.last_t, at.last_y)
    begin = time.process_time()
    for _ in range(_CALLS):
        moving.system(at.last_t, at.last_y)
    return (time.process_time() - begin) / _CALLS
