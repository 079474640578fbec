"""What models give for what was measured: a quantity as a variable of a study, or as a column of a rig's contacts.

- Points are computed as those of a sweep: by the same reading, assembly and study as ``rollslip run``, and none raises.
- Where a slip is not inside the range of its study there is no value but a reason. Of a slip that comes at the end, of
  running away for example, that means that it is larger than all in the range, and it counts so: as infinite.
"""

import json
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

import numpy as np

from rollslip.catalogue.discovery import available, get_class
from rollslip.errors import SceneError, did_you_mean, nearest
from rollslip.results.words import Status
from rollslip.scene.values import Scene
from rollslip.search import Array
from rollslip.studies.answers import Measurable
from rollslip.studies.study import Study, study_class
from rollslip_campaigns.sweep.definition import SweepWork
from rollslip_campaigns.sweep.journal import Row as PointRow
from rollslip_campaigns.sweep.point import compute, unpacked
from rollslip_campaigns.validation.residuals import Value

__all__ = ["observe"]

#: What may be said of a dimension in place of one of its names.
EXTREMES: Final[Mapping[object, Callable[[Array], Any]]] = {"smallest": np.min, "largest": np.max}
#: Tells which steady slips last.
_LASTS: Final = "stable"


def _found(quantity: str, scene: Scene) -> tuple[type[Study], Measurable]:
    """Return the study that gives a quantity of a bearing, and how."""
    name, of_study, variable = quantity.partition("/")
    if not of_study:
        for one in available("study"):
            study: type[Study] = get_class("study", one)
            if quantity in study.measured:
                return study, study.measured[quantity]
        raise SceneError([f"no study that is installed gives the quantity {quantity!r}"])
    study = study_class(name, scene)
    if variable not in study.outputs:
        hint = did_you_mean(
            nearest(variable, study.outputs, count=1), f"it has {', '.join(study.outputs)}"
        )
        raise SceneError([f"study {name!r} has no variable {variable!r}; {hint}"])
    return study, Measurable(variable=variable)


def observe(
    scene: Scene, quantity: str, at: Mapping[str, object], points: Sequence[Mapping[str, object]]
) -> list[Value]:
    """Return what the models of a scene give for a quantity at points, each some changes of the scene."""
    study, one = _found(quantity, scene)
    status = study.outputs[one.variable].status
    outputs = (
        one.variable,
        *([status] if status else []),
        *([_LASTS] if one.lasting is not None else []),
    )
    work = SweepWork(
        scene=scene, study=study.name, outputs=tuple(dict.fromkeys(outputs)), packages=("rollslip",)
    )
    rows = compute(work, [(k, changes) for k, changes in enumerate(points)]).rows
    return [_value(one, status, at, row) for row in sorted(rows, key=lambda row: row.number)]


def _value(one: Measurable, status: str | None, at: Mapping[str, object], row: PointRow) -> Value:
    if row.status != "ok":
        return Value(math.nan, f"{row.status}: {row.message}", row.seconds)
    layout = json.loads(row.layout)
    arrays = unpacked(layout, row.numbers, row.texts)
    names: dict[str, Sequence[object]] = {
        name: about["values"] for name, about in layout["coords"].items()
    }
    dims: dict[str, Sequence[str]] = {
        name: about["dims"] for name, about in layout["variables"].items()
    }
    if one.lasting is not None:
        lasting = np.flatnonzero(arrays[_LASTS] == 1.0)
        value = float(arrays[one.variable][lasting[one.lasting]]) if lasting.size else math.nan
    else:
        value = _single(one.variable, arrays[one.variable], dims[one.variable], names, at)
    if math.isfinite(value):
        return Value(value, "", row.seconds)
    why = ""
    if status in arrays and arrays[status].size:
        said = arrays[status]
        of = dims[status][0] if said.ndim == 1 else ""
        why = str(
            said[list(names[of]).index(at[of])]
            if of in at and at[of] not in EXTREMES
            else said.ravel()[0]
        )
    if one.below and Status.of(why) is one.below:
        return Value(-math.inf, why, row.seconds)
    return Value(math.inf if one.beyond else math.nan, why, row.seconds)


def _single(
    variable: str,
    values: Array,
    dims: Sequence[str],
    names: Mapping[str, Sequence[object]],
    at: Mapping[str, object],
) -> float:
    """Take one value of a variable, at names of its dimensions, or the smallest or largest along some."""
    index: list[Any] = []
    extreme: Callable[[Array], Any] | None = None
    for k, dim in enumerate(dims):
        wanted = at.get(dim)
        if wanted in EXTREMES:
            index.append(slice(None))
            extreme = EXTREMES[wanted]
        elif dim in at:
            known = list(names.get(dim, range(values.shape[k])))
            if wanted not in known:
                raise SceneError(
                    [f"{variable} has no {dim} {wanted!r}; it has {', '.join(map(str, known))}"]
                )
            index.append(known.index(wanted))
        elif values.shape[k] == 1:
            index.append(0)
        else:
            reason = f"{variable} has {values.shape[k]} values along {dim}; say which by at = {{ {dim} = ... }}"
            raise SceneError([reason])
    left = np.asarray(values[tuple(index)])
    known_values = left[np.isfinite(left)]
    if extreme is None:
        return float(left)
    return float(extreme(known_values)) if known_values.size else math.nan
