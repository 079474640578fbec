"""Tabulate a bearing over temperature, load and speeds until random operations are within a tolerance.

Method: tensor products of cubic Lagrange polynomials over uniform nodes (module tables), refined axis by axis by the
error half-way between nodes, and hold-out validation at random operations.

1. A point is study raceway-friction at one temperature and load. It costs some hundredths of a second and has more
   nodes over speeds and slide-roll ratios than a table needs.
2. Compute the random operations: temperatures and loads of a Latin hypercube, with all speeds and slide-roll ratios.
3. Start with four nodes of temperature and four of load. Interpolate half-way between nodes of one axis, at both ends
   and in the middle of the other axis, and compute points there; interpolate the drags of the cage half-way between
   temperatures, too.
4. If the difference exceeds a fraction of the tolerance, halve the distance of the nodes of this axis; repeat.
5. Choose the coarsest nodes within a point (cage ratio, rolling speed, slide-roll ratio) whose interpolation on all
   nodes leaves less than the same fraction; refine rolling speeds also for the drags of the cage.
6. Interpolate the resulting tables at the random operations, and the drags at their temperatures and random speeds. If
   the largest error exceeds the tolerance, halve the fraction and go on at step 4 with the nodes so far; after four
   attempts fail. In a limited time, halve the distance of loads and of temperatures in turn instead, as long as the
   nodes end in time; the error is stated, whatever it is.
7. The error of the file is the largest error at the random operations, of friction, resistance, force or drags.
8. Add the steady states over temperature, load and shaft speed, and the stiffness at each.

All points are in the journals of two sweeps, so that the same command continues after an interruption. The supply of
oil, which churning depends on, depends on the speeds of the rings: at a rolling speed the tables have the
supply of rings between which a roller rolls at this speed without slip.
"""

import json
import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import assemble
from rollslip.engine import cores
from rollslip.errors import ConvergenceError
from rollslip.results.dataset import about, save, xr
from rollslip.results.text import duration
from rollslip.scene.changes import evolve
from rollslip.search import Array
from rollslip_campaigns.surrogate.drags import (
    CAGE_NODES,
    OPERATION_KEYS,
    DragTables,
    drag_errors,
    tabulate_drags,
)
from rollslip_campaigns.surrogate.plan import ROW_NODES, UNITS, SurrogatePlan, drag_error, row_axes
from rollslip_campaigns.surrogate.stiffness import stiffness
from rollslip_campaigns.surrogate.tables import (
    CAGE_SMALL,
    Axis,
    Tables,
    bearing_variables,
    weights,
)
from rollslip_campaigns.sweep.folder import Points
from rollslip_campaigns.sweep.journal import FAILED, records
from rollslip_campaigns.sweep.point import row_values
from rollslip_campaigns.sweep.result import origin_of_points
from rollslip_campaigns.sweep.run import Progress
from rollslip_studies.raceway_friction.study import (
    SLIDE_ROLL_SCALE,
    RacewayFriction,
)

__all__ = ["RESULT", "run_surrogate"]

#: File of the result in the folder of a surrogate.
RESULT: Final = "surrogate.nc"

#: Distances of the nodes on the axes of temperature and load, coarse to fine. Each is half the previous one, so that
#: points are reused; the first leaves four of `ROW_NODES`, which a cubic needs. Without the first one tables have at
#: least seven nodes on an axis, and the coarsest takes three times the points.
_ROW_STRIDES: Final = (16, 8, 4, 2, 1)
#: The same for the nodes of a point: cage ratio, rolling speed, slide-roll ratio. Each number of intervals of
#: raceway-friction (8, 48, 64) is a multiple of the largest stride. The finest stride is 2, since with 1 nothing would
#: be left to compare with; drags alone may require 1. A larger first one makes smaller files where it keeps the error.
_POINT_STRIDES: Final = ((4, 2), (8, 4, 2), (4, 2))
#: Fractions of the tolerance that one axis may use, attempt by attempt. Smaller ones compute more points at once,
#: larger ones fail at the random operations more often. Chosen: several axes seldom err most at the same operation.
_FRACTIONS: Final = (0.8, 0.4, 0.2, 0.1)

#: Time for drags, steady states and stiffness after the nodes, over that of the nodes, in a limited time: 0.16 for
#: gearbox on two processors, and a margin. Half of it would make tables late by 6 % of their time, twice as much leaves
#: a fifth of the time unused.
_TIME_AFTER: Final = 0.2

#: Shaft speeds at which steady states and stiffness are tabulated. Doubling it doubles their time and rows in a CSV
#: file, and changes no motion; chosen.
_SHAFT_NODES = 9
#: Number of trailing axes of each table, of (cage ratio, rolling speed, slide-roll ratio); of ribs the last one is
#: their sliding speed, with one node without axial load.
_TABLE_AXES: Final = {
    "mean_friction": 3,
    "largest_friction": 2,
    "ring_resistance": 2,
    "ring_force": 2,
    "rib_friction": 3,
}


# Points ---------------------------------------------------------------------------------------------------------------


@attrs.define(eq=False)
class _Nodes:
    """Results of computed points, by the number of the point in the sweep of all nodes."""

    plan: SurrogatePlan
    points: Points
    results: dict[int, dict[str, Array]] = attrs.field(factory=dict)

    def count(self, levels: Sequence[int]) -> int:
        """Return the number of nodes of temperature and load at levels of refinement."""
        axes = row_axes(self.plan.ranges).values()
        return math.prod(len(_row(axis, level)) for axis, level in zip(axes, levels, strict=True))

    def seconds(self) -> float:
        """Return the mean time of a node [s] while all processors compute nodes, in this call or an earlier one."""
        return float(np.mean([row.seconds for row in records(self.points.folder)])) / cores()

    def tables(self, temperatures: Sequence[int], loads: Sequence[int]) -> dict[str, Array]:
        """Return the tables at indices of the finest rows of temperature and load: (temperature, load, ...)."""
        numbers = np.add.outer(np.multiply(temperatures, self.plan.sweep.design.shape[1]), loads)
        _compute_points(self.points, self.results, numbers.ravel().tolist())
        return {
            name: np.array([[self.results[int(n)][name] for n in row] for row in numbers])
            for name in self.plan.sweep.outputs
        }


def _compute_points(
    points: Points, results: dict[int, dict[str, Array]], numbers: Sequence[int]
) -> None:
    """Compute those points that have no result yet, and add their results; raise if any fails again."""
    requested = [number for number in numbers if number not in results]
    if not requested:
        return
    points.compute(requested, retry_statuses=FAILED)
    messages = dict[int, str]()
    for row in records(points.folder):
        messages[row.number] = row.message
        if row.status == "ok" and row.number not in results:
            results[row.number] = row_values(row)
    if missing := [number for number in requested if number not in results]:
        raise ConvergenceError(
            f"{len(missing)} of {len(requested)} operations failed, the first: "
            f"{messages.get(missing[0], 'it was not computed')}; "
            "narrow the ranges"
        )


# Interpolation and refinement -----------------------------------------------------------------------------------------


def _apply_along(table: Array, axis: int, matrix: Array) -> Array:
    """Return the table multiplied by a matrix of interpolation weights (new nodes, nodes) along one axis."""
    return np.moveaxis(np.tensordot(matrix, table, axes=(1, axis)), 0, axis)


def _max_errors(tables: Mapping[str, Array], reference: Mapping[str, Array]) -> Array:
    """Return the largest relative error in each row of the first axis.

    Errors of friction are relative to the largest friction over the slide-roll ratio, also of ribs to that of
    raceways, those of other tables to themselves.
    """
    worst = np.zeros(len(reference["mean_friction"]))
    largest = reference["mean_friction"].max(axis=-1)
    sizes = {**reference, "mean_friction": largest[..., None]}
    sizes["rib_friction"] = (largest * reference["ring_force"])[..., None]
    for name in _TABLE_AXES:
        size = np.abs(sizes[name])
        errors = np.abs(tables[name] - reference[name]) / np.where(size > 0.0, size, np.inf)
        worst = np.maximum(worst, errors.reshape(len(worst), -1).max(axis=1))
    return worst


def _coarsen(tables: Mapping[str, Array], strides: Sequence[int]) -> dict[str, Array]:
    """Return each n-th node of cage ratio, rolling speed and slide-roll ratio, the last axes of a table."""
    slices: list[Any] = [slice(None, None, stride) for stride in strides]
    return {name: tables[name][(..., *slices[:count])] for name, count in _TABLE_AXES.items()}


def _interpolate_all_nodes(tables: Mapping[str, Array], strides: Sequence[int]) -> dict[str, Array]:
    """Return coarsened tables, interpolated on all nodes."""
    fine = {}
    for name, table in tables.items():
        count = _TABLE_AXES[name]
        for axis, stride in enumerate(strides[:count], start=table.ndim - count):
            if (nodes := table.shape[axis]) > 1:
                matrix = weights(nodes, np.arange((nodes - 1) * stride + 1) / stride)
                table = _apply_along(table, axis, matrix)
        fine[name] = table
    return fine


def _choose_point_strides(tables: Mapping[str, Array], allowed: float) -> list[int]:
    """Return the coarsest strides within a point, each with an error up to `allowed` if the other axes are fine.

    It is the finest where none has so small an error; the random operations tell by how much it is exceeded.
    """
    flat = {name: tables[name].reshape(-1, *tables[name].shape[2:]) for name in _TABLE_AXES}
    chosen = [options[-1] for options in _POINT_STRIDES]
    for k, options in enumerate(_POINT_STRIDES):
        for stride in options:
            single = [stride if j == k else 1 for j in range(len(chosen))]
            interpolated = _interpolate_all_nodes(_coarsen(flat, single), single)
            if _max_errors(interpolated, flat).max() <= allowed:
                chosen[k] = stride
                break
    return chosen


def run_surrogate(
    plan: SurrogatePlan,
    folder: Path,
    *,
    print_line: Callable[[str], None] = lambda text: None,
    report: Callable[[Progress], None] = lambda progress: None,
) -> "xr.Dataset":
    """Compute the tables, or the points that are missing, in a folder, and write the result there.

    Parameters
    ----------
    plan : SurrogatePlan
        Operations, ranges and allowed error.
    folder : Path
        Folder of the journals and of the result; points that it holds are not computed again.
    print_line : callable
        Is called with a line of text after each attempt.
    report : callable
        Is called with the progress of each sweep.

    Returns
    -------
    xarray.Dataset
        Tables over temperature, radial load and speeds, with the measured errors. Steady states are NaN where the
        rollers do not carry the drags.

    Raises
    ------
    ConvergenceError
        If a point fails, or, without a limit of time, the finest tables leave more than the allowed error.
    """
    nodes = _Nodes(plan, Points.in_folder(plan.sweep, folder / "nodes", print_line, report))
    design = plan.random.design
    results = dict[int, dict[str, Array]]()
    random_points = Points.in_folder(plan.random, folder / "random", print_line, report)
    start = time.monotonic()
    if plan.seconds:
        _compute_points(random_points, results, [0])
        print_line(_describe_cost(nodes, design.size, time.monotonic() - start))
    _compute_points(random_points, results, range(design.size))
    reference = {
        name: np.array([results[k][name] for k in sorted(results)]) for name in _TABLE_AXES
    }
    axes = row_axes(plan.ranges)
    changes: list[Mapping[str, Any]] = [*map(design.changes, range(design.size))]
    operations = {
        key.partition(".")[2]: np.array(
            [float(change.get(key, plan.ranges[key][0])) for change in changes]
        )
        for key in OPERATION_KEYS[:2]
    }
    attempts = _levels_in_time(nodes, start) if plan.seconds else _levels_by_error(nodes)
    for levels, allowed in attempts:
        rows = [_row(axis, level) for axis, level in zip(axes.values(), levels, strict=True)]
        fine = nodes.tables(*rows)
        strides = _choose_strides(plan, fine, allowed)
        tables = _coarsen(fine, strides)
        t, w = (
            Axis(axes[name].nodes[row], axes[name].logarithmic).weights(operations[name])
            for name, row in zip(axes, rows, strict=True)
        )
        interpolated = {
            name: np.einsum("pt,pw,tw...->p...", t, w, table, optimize=True)
            for name, table in tables.items()
        }
        errors = _max_errors(_interpolate_all_nodes(interpolated, strides), reference)
        drags = tabulate_drags(
            plan.sweep.scene,
            axes["temperature"].nodes[rows[0]],
            plan.ranges,
            plan.rolling[:: strides[1]],
        )
        temperatures, inverse = np.unique(operations["temperature"], return_inverse=True)
        errors = np.maximum(errors, drag_errors(plan.sweep.scene, temperatures, drags)[inverse])
        print_line(
            f"{len(rows[0])} temperatures and {len(rows[1])} loads: the error at random operations is "
            f"{100 * errors.max():.2g} % at most"
        )
        if errors.max() <= plan.error:
            break
    if errors.max() > plan.error and plan.seconds:
        print_line(f"more time makes it smaller: --within '{4.0 * plan.seconds:.0f} s'")
    elif errors.max() > plan.error:
        raise ConvergenceError(
            f"the error of the finest tables at random operations is {100 * errors.max():.2g} %, more than "
            f"{100 * plan.error:.3g} %; allow a larger --error, or narrow the ranges"
        )
    dataset = _dataset(plan, rows, strides, {**fine, **tables}, drags, operations, errors)
    save(dataset, folder / RESULT)
    return dataset


def _choose_strides(plan: SurrogatePlan, fine: Mapping[str, Array], allowed: float) -> list[int]:
    """Return strides of the nodes of a point with which tables and drags are within an allowed error."""
    strides = _choose_point_strides(fine, allowed)
    while (
        strides[1] > 1
        and drag_error(plan.sweep.scene, plan.ranges, plan.rolling[:: strides[1]]) > allowed
    ):
        strides[1] //= 2
    return strides


def _describe_cost(nodes: _Nodes, checks: int, seconds: float) -> str:
    """Return a sentence on the time of the coarsest tables, from that of one operation [s]."""
    count = nodes.count((0, 0)) + checks
    whole = (1.0 + _TIME_AFTER) * count * seconds / cores()
    return (
        f"{count} operations of {seconds:.2g} s each on {cores()} processors take about "
        f"{duration(whole)}, more nodes at most {duration(max(nodes.plan.seconds or 0.0, whole))}"
    )


def _levels_by_error(nodes: _Nodes) -> Iterator[tuple[Sequence[int], float]]:
    """Yield levels of both rows and the error that each axis may have, ever finer."""
    levels = [0, 0]
    for fraction in _FRACTIONS:
        allowed = fraction * nodes.plan.error
        levels = _refine_rows(nodes, levels, allowed)
        yield levels, allowed


def _levels_in_time(nodes: _Nodes, start: float) -> Iterator[tuple[Sequence[int], float]]:
    """Yield levels of both rows, loads refined first, as long as their nodes end in the time of the plan.

    Parameters
    ----------
    nodes : _Nodes
        The nodes, of which those of the levels before are known.
    start : float
        Clock at the start [s].
    """
    end = start + (nodes.plan.seconds or math.inf)
    for attempt in range(2 * len(_ROW_STRIDES) - 1):  # one axis is refined in each, loads first
        levels = attempt // 2, (attempt + 1) // 2
        missing = nodes.count(levels) - len(nodes.results)
        if attempt and time.monotonic() + (1.0 + _TIME_AFTER) * missing * nodes.seconds() > end:
            return
        yield levels, _FRACTIONS[0] * nodes.plan.error


def _row(axis: Axis, level: int) -> list[int]:
    """Return the indices of the nodes of temperature or load at a level of refinement."""
    return list(range(0, axis.nodes.size, _ROW_STRIDES[level]))


def _refine_rows(nodes: _Nodes, levels: Sequence[int], allowed: float) -> list[int]:
    """Return the levels of both rows at which interpolation half-way between nodes is within `allowed`.

    Along the other row, the error is measured at both ends and in the middle.
    """
    plan = nodes.plan
    axes = [*row_axes(plan.ranges).values()]
    last = ROW_NODES - 1
    levels = [*levels]
    for k in (0, 1):
        other = [0] if axes[1 - k].nodes.size == 1 else [0, last // 2, last]
        while axes[k].nodes.size > 1 and levels[k] < len(_ROW_STRIDES) - 1:
            row = _row(axes[k], levels[k])
            midpoints = [(a + b) // 2 for a, b in pairwise(row)]
            coarse = nodes.tables(*((row, other) if k == 0 else (other, row)))
            reference = nodes.tables(*((midpoints, other) if k == 0 else (other, midpoints)))
            between = weights(len(row), np.arange(0.5, len(midpoints)))
            errors = _max_errors(
                {
                    name: np.moveaxis(_apply_along(coarse[name], k, between), k, 0)
                    for name in _TABLE_AXES
                },
                {name: np.moveaxis(table, k, 0) for name, table in reference.items()},
            )
            error = errors.max()
            if k == 0:
                T = axes[0].nodes
                drags = tabulate_drags(plan.sweep.scene, T[row], plan.ranges, plan.rolling)
                error = max(error, drag_errors(plan.sweep.scene, T[midpoints], drags).max())
            if error <= allowed:
                break
            levels[k] += 1
    return levels


# The dataset ----------------------------------------------------------------------------------------------------------

#: Name, unit, dimensions and meaning of the drags on the cage.
_DRAG_VARIABLES: Final = (
    (
        "inner",
        "N m s",
        ("temperature",),
        "torque of drags on the cage over the lead of the inner ring",
    ),
    (
        "outer",
        "N m s",
        ("temperature",),
        "torque of drags on the cage over the lead of the outer ring",
    ),
    (
        "cage",
        "N m s2",
        ("temperature", "rolling_speed"),
        "torque of drags against the cage over the square of its speed",
    ),
    (
        "rest",
        "N m",
        ("temperature", "cage_speed"),
        "what is left of the drags, along the cage's speed",
    ),
)


def _dataset(
    plan: SurrogatePlan,
    rows: Sequence[Sequence[int]],
    strides: Sequence[int],
    tables: Mapping[str, Array],
    drags: DragTables,
    operations: Mapping[str, Array],
    errors: Array,
) -> "xr.Dataset":
    """Return the result: tables, numbers of the bearing, ranges, errors at random operations, and steady states."""
    axes = row_axes(plan.ranges)
    T, W = (axes[name].nodes[row] for name, row in zip(axes, rows, strict=True))
    nodes = {
        name: tables[name][0, 0][::stride]
        for name, stride in zip(("cage_ratio", "rolling_speed", "slide_roll"), strides, strict=True)
    }
    dims = ("ring", "temperature", "radial_load", "cage_ratio", "rolling_speed", "slide_roll")
    outputs = RacewayFriction.outputs
    variables: dict[str, Any] = {
        name: (
            dims[: 3 + count],
            np.moveaxis(tables[name], 2, 0),
            about(outputs[name].unit, outputs[name].meaning),
        )
        for name, count in _TABLE_AXES.items()
    }
    variables["rib_friction"] = ((*dims[:5], "rib_sliding"), *variables["rib_friction"][1:])
    for name, unit, over, text in _DRAG_VARIABLES:
        variables[f"drag_{name}"] = (over, drags.terms[name], about(unit, text))
    variables |= bearing_variables(plan.scene)
    variables |= {
        f"{key.partition('.')[2]}_range": ("end", np.array(ends), about(unit, f"ends of {key}"))
        for (key, ends), unit in zip(plan.ranges.items(), UNITS, strict=True)
    }
    variables["operation_error"] = (
        "operation",
        errors,
        about("1", "largest error at a random operation"),
    )
    for (name, value), unit in zip(operations.items(), ("K", "N"), strict=True):
        variables[f"operation_{name}"] = (
            "operation",
            value,
            about(unit, f"{name.replace('_', ' ')} there"),
        )
    step = math.asinh(drags.cage_top / CAGE_SMALL) / (CAGE_NODES - 1)
    coords: dict[str, Any] = {
        name: (name, value, about(unit, name.replace("_", " ")))
        for name, value, unit in (
            ("temperature", T, "K"),
            ("radial_load", W, "N"),
            ("cage_ratio", nodes["cage_ratio"], "1"),
            ("rolling_speed", nodes["rolling_speed"], "m/s"),
            ("slide_roll", nodes["slide_roll"], "1"),
            ("cage_speed", CAGE_SMALL * np.sinh(step * np.arange(CAGE_NODES)), "rad/s"),
        )
    }
    sliding = tables["rib_sliding"][0, 0][:: strides[2]]
    coords["rib_sliding"] = ("rib_sliding", sliding, about("m/s", "sliding speed of ribs"))
    coords["ring"] = ("ring", ["inner", "outer"], about("1", "raceway"))
    result = xr.Dataset(
        variables,
        coords=coords,
        attrs=origin_of_points(
            attrs.evolve(plan.sweep, scene=plan.scene), [], {}, study="surrogate"
        )
        | {
            "error": float(errors.max()),
            "median_error": float(np.median(errors)),
            "error_requested": plan.error,
            "sliding_small": SLIDE_ROLL_SCALE,
            "nodes": json.dumps(list(map(len, rows)) + list(map(len, nodes.values()))),
        },
    )
    return _with_steady_states(result, plan)


#: Name, unit and meaning of the variables of a steady state, in the order of the fields of `SteadyState`.
_STEADY_VARIABLES: Final = (
    ("steady_cage_slip", "1", "cage slip at which the drags are carried"),
    ("friction_torque", "N m", "torque that drives the inner ring there"),
    ("outer_torque", "N m", "torque that drives the outer ring there"),
    ("power_loss", "W", "losses there"),
    (
        "drag_reserve",
        "1",
        "largest torque of the rollers on the cage over its drag, 1e6 at most; below 1 it skids",
    ),
)


def _with_steady_states(result: "xr.Dataset", plan: SurrogatePlan) -> "xr.Dataset":
    """Return the result with steady states and stiffness over temperature, load and shaft speed."""
    low, high = plan.ranges[OPERATION_KEYS[2]]
    speeds = np.linspace(low, high, _SHAFT_NODES) if high > low else np.array([low])
    tables = Tables.from_dataset(result)
    T = result["temperature"].to_numpy()
    W = result["radial_load"].to_numpy()
    outer = plan.scene.operation.outer_speed
    states = np.array(
        [
            [
                np.stack(
                    attrs.astuple(tables.interpolate(t, w).steady_state(speeds, outer)), axis=-1
                )
                for w in W
            ]
            for t in T
        ]
    )
    dims = ("temperature", "radial_load", "inner_speed")
    variables = {
        name: (dims, states[..., k], about(unit, text))
        for k, (name, unit, text) in enumerate(_STEADY_VARIABLES)
    }
    # stiffness at the steady slip, at no slip where there is none
    slips = np.nan_to_num(states[..., 0])
    springs = np.empty((*slips.shape, 2, 2))
    for t, k in np.ndindex(len(T), len(speeds)):
        bearing = assemble(
            evolve(
                plan.scene,
                {OPERATION_KEYS[0]: float(T[t]), OPERATION_KEYS[2]: float(speeds[k])},
                si=True,
            )
        )
        for w, load in enumerate(W.tolist()):
            springs[t, w, k] = stiffness(
                bearing.at_load(load),
                bearing.kinematics.epicyclic_cage_speed * (1.0 - float(slips[t, w, k])),
            )
    for name, entry in (("along", (0, 0)), ("across", (1, 1)), ("oblique to", (0, 1))):
        variables[f"stiffness_{name.split()[0]}"] = (
            dims,
            springs[..., *entry],
            about("N/m", f"stiffness {name} the load"),
        )
    return result.assign(variables).assign_coords(
        inner_speed=("inner_speed", speeds, about("rad/s", "speed of the inner ring"))
    )
