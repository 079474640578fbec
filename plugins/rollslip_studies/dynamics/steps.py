"""Chooses the tolerance of a step, and estimates what steps leave of the speeds of cage and rollers.

- Errors of the cage speed over a short time go with the tolerance, in proportion at most, and add up or fade.
- Where rollers hit their pockets hardly a tolerance keeps motions together: they come apart as far as play lets them
  swing, and each by chance. How far motions of other tolerances do so in an orbit of the cage tells what to expect.
- A history is gone through as it is: what moves nothing at one speed may hit its pockets in a run-up.
"""

import itertools
import math
from collections.abc import Sequence
from typing import Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import Array
from rollslip.bearing.resolution import finest
from rollslip_studies.dynamics.choice import Movable, adds_up, with_few_slices
from rollslip_studies.dynamics.levels.moving_bearing import MovingBearing

#: Share of the tolerance of the cage speed that steps may take, and the time [s] of a short motion.
_SHARE, _SHORT = 0.2, 5e-3
#: Instants of a history at which it is looked for its largest speed.
_LOOKS: Final = 257
#: A usual tolerance of a step.
_USUAL: Final = 1e-5
#: Pieces of an orbit, and instants of each, in which it is looked how far steps let motions come apart, how much finer
#: others are, evaluations of the rates after which there is no further piece, and how many times as far apart as those
#: that were tried others may be, by the scenes of tests/tools/references/motions_by_scipy.csv.
_PIECES, _PIECE, _FINER, _MOST, _OTHERS = 8, 16, (4.0, 16.0), 200_000, 2.0


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
    few, moving = with_few_slices(assembly), study.moving(assembly)
    if moving.friction.by_slices:
        moving = study.moving(few)
    span = min(_SHORT, study.duration)
    # a motion at level cage-set takes no longer than a look at how its errors fade
    times = adds_up(study, few, span) if fades else study.duration / span
    off = _come_apart(study, moving, (_USUAL, 1e-3 * _USUAL), [span])[0]
    error = float(off[~np.isnan(off)][-1:].sum()) * times
    share = _SHARE * assembly.scene.accuracy.of("cage_speed")
    # nobody has seen a step of more than the typical tolerance do well where a contact opens
    least = finest(assembly.scene).integrator_tolerance or 0.0
    tolerance = min(max(_USUAL * share / max(error, 1e-300), least), _USUAL)
    left = error * tolerance / _USUAL
    return tolerance, left if study.level == "cage-set" else max(left, _swings_apart(study, moving, tolerance))


def _come_apart(study: Movable, moving: MovingBearing, tolerances: Sequence[float], spans: Sequence[float]) -> Array:
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
    looks, states = moving.looks()
    most = np.array(_fastest(moving))[:, None]
    still = study.tried(moving, np.zeros(1), tolerances[0])
    later = np.flatnonzero((looks > 0.0) & (looks + spans[-1] <= looks[-1])).tolist()
    few = {later[len(later) // 2], later[-1]} if later else ()
    off = np.full((2, len(spans), _PIECE), np.nan)
    for begin in (still, *(attrs.evolve(still, last_t=float(looks[k]), last_y=states[k]) for k in few)):
        motions, work = [begin] * len(tolerances), 0
        for k, (start, end) in enumerate(itertools.pairwise((0.0, *spans))):
            times = begin.last_t + np.linspace(start, end, _PIECE + 1)[1:]
            motions = [study.tried(moving, times, *one) for one in zip(tolerances, motions, strict=True)]
            work += sum(found.evaluations for found in motions)
            count = min(found.t.size for found in motions)
            first, *others = (moving.split(found.y[:count]) for found in motions)
            for other in others:
                cage, spin = (np.abs(other[name] - first[name]) for name in ("cage_speed", "roller_spin"))
                here = off[:, k, :count]
                here[:] = np.fmax(here, np.stack((cage, spin.max(axis=-1))) / most)
            if work > _MOST or count < _PIECE:
                break
    return off.reshape(2, -1)


def _fastest(moving: MovingBearing) -> tuple[float, ...]:
    """Largest speeds of cage and rollers without slip [rad/s]."""
    looks, _ = moving.looks()
    times = np.union1d(looks, np.linspace(0.0, looks[-1], _LOOKS))
    return tuple(float(np.nanmax(np.abs(speeds))) for speeds in moving.unslipped(times))


def _swings_apart(study: Movable, moving: MovingBearing, tolerance: float) -> float:
    """Return how far steps of a tolerance let motions come apart in an orbit of the cage, and others as these."""
    span = min(study.duration, 2.0 * math.pi / _fastest(moving)[0])
    ends, most = [span * k / _PIECES for k in range(1, _PIECES + 1)], 0.0
    for own in dict.fromkeys((tolerance, _USUAL)):  # looser steps show more of an orbit
        off = _come_apart(study, moving, (own, *(own / finer for finer in _FINER)), ends)
        most = max(most, _OTHERS * float(np.nanmax(off, initial=0.0)))
        if not np.isnan(off).any():
            break
    return most
