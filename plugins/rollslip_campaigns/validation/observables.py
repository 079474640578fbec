"""Compute a measured quantity by models: as a variable of a study, or as a property of the oil.

- Points are computed as those of a sweep: by the same reading, assembly and study as ``rollslip run``, and a point that
  fails raises nothing.
- Where the slip of a state is outside the range of its study, there is no value but a reason. A state beyond the end of
  the range, such as skidding, means that the quantity is larger than all values in the range; its value is infinite.
"""

import json
import math
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import assemble
from rollslip.bearing.resolution import Resolution
from rollslip.errors import RollslipError, SceneError, did_you_mean, nearest
from rollslip.results.text import Status
from rollslip.scene.changes import evolve
from rollslip.scene.values import Scene
from rollslip.search import Array
from rollslip.structure import raise_problem_if
from rollslip.studies.answers import Measurable
from rollslip.studies.measured import measurables
from rollslip.studies.study import Study, study_class
from rollslip.units import quantity as in_unit
from rollslip_campaigns.sweep.definition import Resolutions, SweepWork, combination_name
from rollslip_campaigns.sweep.journal import Row as PointRow
from rollslip_campaigns.sweep.point import compute, unpack_values
from rollslip_campaigns.sweep.sweep import resolution_at
from rollslip_campaigns.validation.residuals import Value
from rollslip_kernels.slices import Conditions

__all__ = ["observe"]

#: Reductions over a dimension that may be named instead of one of its coordinates.
EXTREMES: Final[Mapping[object, Callable[[Array], Any]]] = {"smallest": np.min, "largest": np.max}
#: Quantity of the oil of a scene.
_OF_OIL: Final = "pressure-viscosity"
#: Variable that says which steady slips are stable.
_STABLE: Final = "stable"
#: Number of points from which on all have the resolution of a plan of the first one. They are samples around it: for
#: the torque of wingertszahn-2023 values stay within 2e-9 and take 0.6 of the time. Chosen: a plan takes as long as a
#: few points.
_PLANNED_FROM: Final = 16


def _measurable(quantity: str, scene: Scene) -> tuple[type[Study], Measurable]:
    """Return the study that gives a quantity, and its variable with the reading of it."""
    name, separator, variable = quantity.partition("/")
    if not separator:
        known = measurables()
        raise_problem_if(
            quantity not in known, f"no study that is installed gives the quantity {quantity!r}"
        )
        return known[quantity]
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
    """Return the values of a quantity by the models of a scene.

    Parameters
    ----------
    scene : Scene
        The scene.
    quantity : str
        A quantity that studies declare as measured, or "study/variable".
    at : mapping
        Coordinate, or "smallest" or "largest", by dimension of the variable.
    points : sequence of mapping
        Changes of the scene at each point.

    Returns
    -------
    list of Value
        One for each point; infinite beyond the range of the study, NaN with a reason where there is none.
    """
    if quantity == _OF_OIL:
        return [_pressure_viscosity(scene, changes, at) for changes in points]
    study, measurable = _measurable(quantity, scene)
    status = study.outputs[measurable.variable].status
    outputs = [measurable.variable, status]
    if measurable.steady_index is not None:
        outputs.append(_STABLE)
    chosen = dict[str, Resolution]()
    if len(points) >= _PLANNED_FROM:
        resolution = resolution_at(scene, study.name, points[0])
        chosen = {} if resolution is None else {combination_name([]): resolution}
    work = SweepWork(
        scene=scene,
        study=study.name,
        outputs=tuple(dict.fromkeys(filter(None, outputs))),
        packages=("rollslip",),
        resolutions=Resolutions(chosen=chosen),
    )
    rows = compute(work, [(k, changes) for k, changes in enumerate(points)]).rows
    return [_value(measurable, status, at, row) for row in sorted(rows, key=lambda row: row.number)]


def _pressure_viscosity(
    scene: Scene, changes: Mapping[str, object], at: Mapping[str, object]
) -> Value:
    """Return ln(eta/eta0)/p [1/Pa] of the oil of a changed scene at its temperature; at no pressure the limit of it."""
    start = time.perf_counter()
    pressure = in_unit(at["pressure"], "Pa") if "pressure" in at else 0.0
    try:
        changed = evolve(scene, changes, si=True)
        oil = assemble(changed).lubricant
        state = oil.at(changed.operation.temperature)
        value = state.pressure_viscosity
        if pressure > 0.0:
            conditions = Conditions(**attrs.asdict(state))
            viscosity, _ = oil.pressure_viscosity_law.at(conditions, pressure)
            value = math.log(float(viscosity) / state.viscosity) / pressure
    except RollslipError as error:
        return Value(math.nan, str(error).splitlines()[0], time.perf_counter() - start)
    return Value(value, "", time.perf_counter() - start)


def _value(
    measurable: Measurable, status: str | None, at: Mapping[str, object], row: PointRow
) -> Value:
    """Return the value in the row of a computed point."""
    if row.status != "ok":
        return Value(math.nan, f"{row.status}: {row.message}", row.seconds)
    layout = json.loads(row.layout)
    arrays = unpack_values(layout, row.numbers, row.texts)
    names: dict[str, Sequence[object]] = {
        name: about["values"] for name, about in layout["coords"].items()
    }
    dims: dict[str, Sequence[str]] = {
        name: about["dims"] for name, about in layout["variables"].items()
    }
    if measurable.steady_index is not None:
        lasting = np.flatnonzero(arrays[_STABLE] == 1.0)
        value = (
            float(arrays[measurable.variable][lasting[measurable.steady_index]])
            if lasting.size
            else math.nan
        )
    else:
        value = _single(
            measurable.variable, arrays[measurable.variable], dims[measurable.variable], names, at
        )
    if math.isfinite(value):
        return Value(value, "", row.seconds)
    reason = ""
    if status in arrays and arrays[status].size:
        statuses = arrays[status]
        dim = dims[status][0] if statuses.ndim == 1 else ""
        reason = str(
            statuses[list(names[dim]).index(at[dim])]
            if dim in at and at[dim] not in EXTREMES
            else statuses.ravel()[0]
        )
    if measurable.below_status and Status.of(reason) is measurable.below_status:
        return Value(-math.inf, reason, row.seconds)
    return Value(math.inf if measurable.missing_is_above else math.nan, reason, row.seconds)


def _single(
    variable: str,
    values: Array,
    dims: Sequence[str],
    names: Mapping[str, Sequence[object]],
    at: Mapping[str, object],
) -> float:
    """Return one value of a variable, at coordinates of its dimensions, or the smallest or largest along some."""
    index: list[Any] = []
    extreme: Callable[[Array], Any] | None = None
    for k, dim in enumerate(dims):
        coordinate = at.get(dim)
        if coordinate in EXTREMES:
            index.append(slice(None))
            extreme = EXTREMES[coordinate]
        elif dim in at:
            known = list(names.get(dim, range(values.shape[k])))
            raise_problem_if(
                coordinate not in known,
                f"{variable} has no {dim} {coordinate!r}; it has {', '.join(map(str, known))}",
            )
            index.append(known.index(coordinate))
        elif values.shape[k] == 1:
            index.append(0)
        else:
            raise SceneError(
                [
                    f"{variable} has {values.shape[k]} values along {dim}; say which by at = {{ {dim} = ... }}"
                ]
            )
    selected = np.asarray(values[tuple(index)])
    finite = selected[np.isfinite(selected)]
    if extreme is None:
        return float(selected)
    return float(extreme(finite)) if finite.size else math.nan
