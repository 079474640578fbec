"""What a study will cost at a resolution: each part measured in small on this machine, times how often it is done.

- Times are of the processor, which other work on the machine changes less than those of the clock.
- What grows with the instants is measured at one and at a few of them and goes on along a line; what grows with the
  points of a curve or a map, likewise.
"""

import time
from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING, Final

import attrs
import numpy as np

from rollslip.bearing.critical import slip_grid
from rollslip.motion.torque_balance import TorqueBalance
from rollslip.studies.dynamics.study import Dynamics
from rollslip.studies.effective_friction.study import EffectiveFriction
from rollslip.studies.friction_curve.study import FrictionCurve
from rollslip.studies.steady_slip.study import SteadySlip

if TYPE_CHECKING:
    from rollslip.bearing.assembly import Assembly

#: Few instants, and few points of curves and maps, on which costs are measured.
_INSTANTS: Final = (1, 3)
#: Slices from which on costs go with their number.
_MANY: Final = 128
_POINTS: Final = (5, 33)
_MAP: Final = (3, 6)
#: Evaluations in the search for the critical slips of both rings, each of one ring.
_SEARCH: Final = 40
#: Motions of the rollers that a steady slip takes beside twice the points of its curve, and those of a followed branch.
_ORBITS, _BRANCH = 40, 350
#: Time [s] over which the cost of a motion is measured, at most.
_SHORT: Final = 5e-3
#: Slices with which it is measured.
_FEW: Final = 12


def seconds(study: object, assembly: "Assembly") -> Mapping[str, float]:
    """Return the time [s] that each part of a study takes at the resolution of its bearing.

    Raises
    ------
    RollslipError
        If a part cannot be computed.
    """
    if isinstance(study, EffectiveFriction):
        return _effective_friction(study, assembly)
    if isinstance(study, FrictionCurve):
        times = [_timed(partial(attrs.evolve(study, points=n).run, assembly)) for n in _POINTS]
        return {"friction": _onwards(_POINTS, times, study.points)}
    if isinstance(study, SteadySlip):
        return _steady_slip(study, assembly)
    return _dynamics(study, assembly) if isinstance(study, Dynamics) else {}


def _timed(work: Callable[[], object], times: int = 2) -> float:
    """Least time of the processor."""
    found = []
    for _ in range(times):
        begin = time.process_time()
        work()
        found.append(time.process_time() - begin)
    return min(found)


def _onwards(at: tuple[float, float], found: list[float], wanted: float) -> float:
    """Value on the line through two, which does not fall."""
    slope = max((found[1] - found[0]) / (at[1] - at[0]), 0.0)
    return max(found[0] + slope * (wanted - at[0]), min(found))


def _effective_friction(study: EffectiveFriction, assembly: "Assembly") -> Mapping[str, float]:
    instants = assembly.resolution.instants or _INSTANTS[-1]
    slip = slip_grid(study.max_cage_slip, _POINTS[0])[1:]
    resolution = assembly.resolution
    some = assembly.at(attrs.evolve(resolution, slices=min(resolution.slices, _MANY)))
    parts: dict[str, list[float]] = {"load distribution": [], "friction": [], "film regimes": []}
    for m in _INSTANTS:
        anew = attrs.evolve(some, known_loads={})
        parts["load distribution"].append(_timed(partial(anew.load_distribution, m), 1))
        raceways = study.loaded(anew, m)
        speeds = raceways.speeds(slip)
        one, regimes = (_timed(partial(work, speeds)) / slip.size for work in (raceways.evaluated, raceways.regimes))
        closure = _timed(partial(raceways.speeds, slip), 1) / slip.size  # a free roller's spin is a root to be found
        parts["friction"].append(one * (study.points + _SEARCH / 2) + closure * (2 * study.points + _SEARCH / 4))
        parts["film regimes"].append(regimes * study.points)
    more = assembly.slices / some.slices
    found = {part: more * _onwards(_INSTANTS, times, instants) for part, times in parts.items()}
    if study.map_points:
        sizes = [(_MAP[0] * (2 * _MAP[0] - 1)), (_MAP[1] * (2 * _MAP[1] - 1))]
        times = [_timed(partial(raceways.map, study.max_cage_slip, n), 1) for n in _MAP]
        whole = study.map_points * max(2 * study.map_points - 1, 1)
        found["map"] = _onwards((sizes[0], sizes[1]), times, whole)
    return found


def _steady_slip(study: SteadySlip, assembly: "Assembly") -> Mapping[str, float]:
    bearing, instants = assembly.resisting(), assembly.resolution.instants or 2
    slip = 0.3 * study.max_cage_slip

    def orbit() -> object:
        return TorqueBalance(bearing, bearing.cage.drags, instants=instants, inertia=study.inertia).orbit(slip)

    followed = sum(bool(getattr(study, name)) for name in ("radial_load", "inner_speed", "temperature"))
    return {"orbits": _timed(orbit, 1) * (2 * study.points + _ORBITS + _BRANCH * followed)}


def _dynamics(study: Dynamics, assembly: "Assembly") -> Mapping[str, float]:
    """Cost of the tables, and of a short part of the motion times what is left of it, from few slices."""
    resolution = assembly.resolution
    few = assembly.at(attrs.evolve(resolution, slices=min(_FEW, resolution.slices), quadrature="equal"))
    more = assembly.slices / few.slices
    begin = time.process_time()
    moving = study.moving(few)
    tables, span = time.process_time() - begin, min(_SHORT, study.duration)
    # the beginning is the most abrupt: what goes on is taken from its second half
    begins, half = (
        _timed(partial(study.tried, moving, np.array([0.0, share * span]), study.relative_tolerance), 1)
        for share in (1.0, 0.5)
    )
    whole = begins + 2.0 * max(begins - half, 0.0) * (study.duration / span - 1.0)
    return {"tables": tables * more, "motion": whole * (more if study.friction == "conventional" else 1.0)}
