"""How finely the points of a sweep are computed: chosen once for all of them, before the first one.

- A point that nobody planned takes 101 slices and doubles its instants, and pays for an estimate of its error every
  time. A plan of its own would cost several points. So the plan's choice (`rollslip.studies.estimates`) is made for
  the scene and for some points of the sweep that lie far apart, and the finest of these serves all.
- It belongs to what the sweep is: it follows from scene and design alone, so that engine, order, pieces and resumption
  do not change a bit, and it is stored, compared and told like they are.
- Laws are left as they are named. Which cheaper one serves depends on the point, and what is left out under a bound
  would have to be watched in every one of them.
- Other laws and other accuracies have other needs: every combination of axes of choices and settings has its own.
- Only of studies that say so (`Study.shares_resolution`): steady slips cost more at the plan's choice than by doubling,
  since the plan halves what it may err and drags decide what that means; motions in time choose steps one by one.
"""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from rollslip.bearing.assembly import assemble
from rollslip.bearing.raceway import Array
from rollslip.bearing.resolution import Resolution
from rollslip.campaigns.sweep.point import Resolutions, name_of
from rollslip.campaigns.sweep.sampling import Axis, Design
from rollslip.errors import RollslipError
from rollslip.planning.plan import estimate
from rollslip.scene.changes import evolve
from rollslip.scene.values import Scene
from rollslip.studies.study import study_class

__all__ = ["chosen_resolutions"]

#: Points besides the scene itself for which a choice is made; a choice costs about six points.
_SPREAD: Final = 8
#: Points of a combination from which on that is worth it.
_WORTH: Final = 100
#: Points among which those far apart are looked for.
_CANDIDATES: Final = 512


def chosen_resolutions(scene: Scene, study: str, design: Design) -> Resolutions:
    """Choose the resolutions of a sweep.

    Parameters
    ----------
    scene : Scene
        The scene that the points change.
    study : str
        Their study.
    design : Design
        The points.
    """
    deciding = [k for k, axis in enumerate(design.axes) if _decides(axis)]
    combinations = np.stack(np.unravel_index(np.arange(design.size), design.shape), axis=-1)[:, deciding]
    if not study_class(study).shares_resolution:
        return Resolutions()
    resolutions = dict[str, Resolution]()
    for places in np.unique(combinations, axis=0):
        numbers = np.flatnonzero((combinations == places).all(axis=1))
        if numbers.size < _WORTH:
            continue
        values = {
            design.axes[k].key: design.axes[k].values[int(place)] for k, place in zip(deciding, places, strict=True)
        }
        points = [values, *(design.changes(int(number)) for number in _far_apart(design, numbers))]
        chosen = [one for one in (_choice(scene, study, changes) for changes in points) if one is not None]
        if chosen:
            resolutions[name_of(list(values.values()))] = _finest(chosen)
    return Resolutions(deciding=tuple(design.axes[k].key for k in deciding), chosen=resolutions)


def _decides(axis: Axis) -> bool:
    number = axis.quantity.unit is not None or axis.quantity.whole
    return not number or axis.key.startswith(("accuracy.", "study."))


def _choice(scene: Scene, study: str, changes: Mapping[str, object]) -> Resolution | None:
    """Return the plan's choice at a point, None if it has none: the point will say why."""
    try:
        at = evolve(scene, changes) if changes else scene
        estimated = estimate(study_class(study).of(at), assemble(at))
    except RollslipError:
        return None
    return None if estimated.failed else estimated.resolution


def _finest(chosen: Sequence[Resolution]) -> Resolution:
    """Return the finest of some resolutions, part by part, with the laws as they are named."""
    most = max(chosen, key=lambda resolution: resolution.slices)
    return Resolution(
        slices=most.slices,
        quadrature=most.quadrature,
        instants=max(resolution.instants or 1 for resolution in chosen),
        table_tolerance=min(resolution.table_tolerance for resolution in chosen),
    )


def _far_apart(design: Design, numbers: "np.ndarray[tuple[int], np.dtype[np.int64]]") -> list[int]:
    """Numbers of some points, each as far as can be from those before it, in shares of the ranges of their values."""
    some = numbers[np.unique(np.linspace(0, numbers.size - 1, _CANDIDATES).astype(int))]
    rows = [[v for v in design.changes(int(number)).values() if isinstance(v, int | float)] for number in some]
    values: Array = np.array(rows, dtype=float)
    width = np.ptp(values, axis=0)
    values = (values - values.min(axis=0)) / np.where(width > 0.0, width, 1.0)
    taken, distance = list[int](), np.linalg.norm(values - 0.5, axis=1)
    for _ in range(min(_SPREAD, some.size)):
        k = int(np.argmax(distance))
        apart = np.linalg.norm(values - values[k], axis=1)
        distance = np.minimum(distance, apart) if taken else apart
        taken.append(k)
    return [int(some[k]) for k in taken]
