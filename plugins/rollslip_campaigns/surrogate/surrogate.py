"""Tabulate a bearing over temperature, load and speeds until random operations are within a tolerance.

Tables are interpolated by tensor products of cubic Lagrange polynomials over uniform nodes (module tables). The nodes
are refined axis by axis, and the error is measured at independent random operations:

1. A point is study raceway-friction at one temperature and load. It costs some hundredths of a second and has more
   nodes over speeds and slide-roll ratios than a table needs.
2. Compute the random operations: temperatures and loads of a Latin hypercube, with all speeds and slide-roll ratios.
3. Start with four nodes of temperature and four of load. Interpolate half-way between nodes of one axis, at both ends
   and in the middle of the other axis, and compute points there.
4. If the difference exceeds a fraction of the tolerance, halve the distance of the nodes of this axis; repeat.
5. Choose the coarsest nodes within a point (cage ratio, rolling speed, slide-roll ratio) whose interpolation on all
   nodes leaves less than the same fraction; refine rolling speeds also for the drags of the cage.
6. Interpolate the resulting tables at the random operations. If the largest error exceeds the tolerance, halve the
   fraction and go on at step 3; after four attempts fail.
7. The error of the file is the largest error at the random operations.
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

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.engine import cores
from rollslip.errors import ConvergenceError, SceneError
from rollslip.results.dataset import about, save, xr
from rollslip.results.text import duration
from rollslip.scene.changes import Quantity, describe_unknown_key, evolve
from rollslip.scene.values import Scene
from rollslip.search import Array
from rollslip.structure import raise_problem_if, raise_problems
from rollslip.studies.study import settings
from rollslip.units import UnitError, check_typed, evenly, format_quantity, quantity
from rollslip_campaigns.surrogate import SurrogateSettings
from rollslip_campaigns.surrogate.drags import CAGE_NODES, OPERATION_KEYS, tabulate_drags
from rollslip_campaigns.surrogate.stiffness import stiffness
from rollslip_campaigns.surrogate.tables import (
    CAGE_SMALL,
    Axis,
    Tables,
    bearing_variables,
    weights,
)
from rollslip_campaigns.sweep.definition import Sweep
from rollslip_campaigns.sweep.folder import Points
from rollslip_campaigns.sweep.journal import FAILED, records
from rollslip_campaigns.sweep.point import row_values
from rollslip_campaigns.sweep.result import origin_of_points
from rollslip_campaigns.sweep.run import Progress, requested_engine
from rollslip_campaigns.sweep.sampling import read_fraction, read_overs
from rollslip_campaigns.sweep.sweep import plan_sweep
from rollslip_studies.raceway_friction.study import (
    ROLLING_NODES,
    SLIDE_ROLL_SCALE,
    RacewayFriction,
)
from rollslip_studies.variation.quantities import quantities

__all__ = ["RESULT", "SurrogatePlan", "plan_surrogate", "run_surrogate"]

#: File of the result in the folder of a surrogate.
RESULT: Final = "surrogate.nc"

#: Nodes of the finest rows of temperature and load, uniform in temperature and in the logarithm of load; three
#: intervals of 16 and one. Doubling the intervals allows smaller tolerances and changes no coarser table.
_ROW_NODES: Final = 49
#: Distances of the nodes in these rows, coarse to fine. Each is half the previous one, so that points are reused;
#: the first leaves four nodes, which a cubic needs.
_ROW_STRIDES: Final = (16, 8, 4, 2, 1)
#: The same for the nodes of a point: cage ratio, rolling speed, slide-roll ratio. Each number of intervals of
#: raceway-friction (8, 48, 64) is a multiple of the largest stride. A larger stride makes smaller files.
_POINT_STRIDES: Final = ((4, 2), (8, 4, 2), (4, 2))
#: Fraction of the tolerance that one axis may use at first. A smaller one computes more points at once, a larger
#: one fails at the random operations more often. Chosen: several axes seldom err most at the same operation.
_FIRST_FRACTION: Final = 0.8
#: Factor of the fraction after an attempt that fails at the random operations. Chosen; a smaller factor ends
#: earlier, with finer tables than needed.
_TIGHTENING: Final = 0.5
#: Attempts before the tolerance counts as unattainable: fractions from 0.8 to 0.1 with the values above. Doubling
#: it asks an axis for less than 1 % of the tolerance.
_MAX_ATTEMPTS: Final = 4

#: Time for drags, steady states and stiffness after the nodes, over that of the nodes, in a limited time: 0.16 for
#: gearbox on two processors. Half of it would make tables late by that.
_TIME_AFTER: Final = 0.2

#: Smallest and largest load over that of the scene, where no range is named. Wider ranges need more nodes; chosen.
_LOAD_FACTORS: Final = (0.4, 2.5)
#: The same for the speed of a ring: a run-up without its first part. Chosen.
_SPEED_FACTORS: Final = (0.15, 1.2)
#: Kelvins below and above the temperature of the scene, where no range is named. Chosen.
_TEMPERATURE_CHANGE: Final = 20.0
#: Smallest rolling speed over the smallest one at the epicyclic cage speed: slip changes the rolling speed by at
#: most (R_o - R_i)/(2 R_o), see study raceway-friction. Halving it stretches the logarithmic axis.
_LOWER_FACTOR: Final = 0.7
#: Largest rolling speed over the largest epicyclic one. A cage at rest has about twice the epicyclic one; chosen
#: below it, because beyond the tables the last value is used. Doubling it stretches the logarithmic axis.
_UPPER_FACTOR: Final = 1.6
#: Smallest rolling speed over the largest one, also where rings reverse. Halving it stretches the logarithmic axis
#: by 15 %, so that more nodes are needed.
_MIN_FRACTION: Final = 0.01
#: Speeds of each ring at which rolling speed and ratio are evaluated; both are extreme at the ends of ranges
#: except where rings reverse. Doubling it changes nothing for rings that do not reverse.
_RING_SPEEDS: Final = 9
#: Smallest ratio over the largest one: without cage speed no centrifugal force acts, so that smaller ratios hardly
#: change the contact forces. Halving it stretches the logarithmic axis. Chosen.
_MIN_RATIO: Final = 0.05
#: Largest ratio; it is unbounded where both rings turn alike and nothing rolls. Doubling it stretches the
#: logarithmic axis of bearings with both rings in motion. Chosen.
_MAX_RATIO: Final = 50.0
#: Shaft speeds at which steady states and stiffness are tabulated. Doubling it doubles their time and rows in a CSV
#: file, and changes no motion; chosen.
_SHAFT_NODES = 9
#: Relative error of drags above which they are not a sum of terms in ring leads and the square of the cage speed, but
#: depend on speeds otherwise, so that no finer table helps. Halving it would blame the form where nodes are too coarse.
_MAX_FORM_ERROR: Final = 0.1
#: SI units of the quantities in `OPERATION_KEYS`, in their order.
_UNITS: Final = ("K", "N", "rad/s", "rad/s")
#: Number of trailing axes of each table, of (cage ratio, rolling speed, slide-roll ratio).
_TABLE_AXES: Final = {
    "mean_friction": 3,
    "largest_friction": 2,
    "ring_resistance": 2,
    "ring_force": 2,
}


@attrs.frozen(eq=False, kw_only=True)
class SurrogatePlan:
    """Operations that a surrogate tabulates and checks.

    Attributes
    ----------
    scene : Scene
        The scene without tables of campaigns.
    sweep : Sweep
        All temperatures and loads that may be computed: the finest rows.
    random : Sweep
        Random temperatures and loads, for the measured error.
    ranges : mapping
        Lower and upper bound of each of the four quantities, in SI units.
    error : float
        Largest relative error that is allowed.
    seconds : float or None
        Time for the tables [s], which may then have a larger error; None for as long as the error takes.
    """

    scene: "Scene"
    sweep: Sweep
    random: Sweep
    ranges: Mapping[str, tuple[float, float]]
    error: float
    seconds: float | None = None

    @property
    def unusual(self) -> tuple[str, ...]:
        """Warnings about unusual values of the scene."""
        return self.sweep.unusual

    @property
    def messages(self) -> list[str]:
        """Lines that describe the ranges and the allowed error."""
        return [
            self.sweep.headline,
            *(
                f"  {key}: "
                + " to ".join(dict.fromkeys(format_quantity(end, unit, 4) for end in ends))
                for (key, ends), unit in zip(self.ranges.items(), _UNITS, strict=True)
            ),
            f"  until random operations are within {100 * self.error:.3g} %"
            + (f", or {duration(self.seconds)} are over" if self.seconds else ""),
        ]


def _axes(ranges: Mapping[str, tuple[float, float]]) -> dict[str, Axis]:
    """Return the finest rows of temperature and load; a row has one node where both bounds are the same."""
    axes = {}
    for key, name, logarithmic in zip(
        OPERATION_KEYS, ("temperature", "radial_load"), (False, True), strict=False
    ):
        low, high = ranges[key]
        space = np.geomspace if logarithmic else np.linspace
        row = space(low, high, _ROW_NODES)
        axes[name] = Axis(row if high > low else row[:1], logarithmic)
    return axes


def plan_surrogate(requested: "SurrogateSettings") -> SurrogatePlan:
    """Check the ranges, the error and the drags of the cage, and lay out the points."""
    base = attrs.evolve(requested.base_scene, sweep=None, uncertainty=None)
    assembly = assemble(base)
    if (pocket := assembly.cage.drags.pocket_friction) is not None:
        raise SceneError(
            [
                f"cage.drag: {pocket.name}: one mean roller has no force in its pocket, so that its friction there "
                "cannot be tabulated; leave it out, or go through time at level pocket",
            ]
        )
    ranges = _ranges(base, requested.over)
    error = read_fraction(requested.error)
    raise_problem_if(
        not 1e-4 <= error <= 0.2,
        f"error: a fraction from 0.0001 to 0.2 is expected, such as 0.01 or '1 %', not {requested.error}",
    )
    slow, fast, min_ratio, max_ratio = _speed_bounds(assembly, ranges)
    study = f"study.{RacewayFriction.name}"
    scene = evolve(
        base,
        {
            f"{study}.slowest": slow,
            f"{study}.fastest": fast,
            f"{study}.smallest_ratio": min_ratio,
            f"{study}.largest_ratio": max_ratio,
        },
        si=True,
    )
    # drags that the finest tables do not reproduce are refused
    deviation = _drag_error(scene, ranges, np.geomspace(slow, fast, ROLLING_NODES))
    names = f"cage.drag: {', '.join(model.name for model in assembly.cage.drags.torques)}: "
    raise_problem_if(
        deviation > _MAX_FORM_ERROR,
        f"{names}their torque is not a sum of terms in the leads of the rings and in the speed of the cage, so "
        "that it cannot be tabulated",
    )
    raise_problem_if(
        deviation > error,
        f"{names}their error between the speeds of the finest table is {100 * deviation:.2g} %; allow a larger "
        "error, or narrow the ranges of speeds",
    )
    options = {
        "study": RacewayFriction.name,
        "output": list(RacewayFriction.outputs),
        "engine": requested.engine,
        "time_limit": requested.time_limit,
    }
    rows = dict[str, object]()
    spans = dict[str, object]()
    for key, axis in zip(OPERATION_KEYS, _axes(ranges).values(), strict=False):
        rows[key] = axis.nodes.tolist()
        if axis.nodes.size > 1:
            low, high = ranges[key]
            spans[key] = f"{low!r}:{high!r}{':log' if axis.logarithmic else ''}"
    sweep = plan_sweep(scene, rows, **options)
    requested_engine(sweep)
    sampling = {"samples": requested.checks, "seed": 1, "sampling": "latin-hypercube"}
    random = plan_sweep(
        scene,
        spans or {OPERATION_KEYS[1]: rows[OPERATION_KEYS[1]]},
        **options | (sampling if spans else {}),
    )
    return SurrogatePlan(
        scene=base,
        sweep=attrs.evolve(sweep, given=requested.base_scene),
        random=attrs.evolve(random, given=requested.base_scene),
        ranges=ranges,
        error=error,
        seconds=None if requested.within is None else quantity(requested.within, "s"),
    )


def _ranges(scene: "Scene", over: object) -> dict[str, tuple[float, float]]:
    """Return the bounds of all four quantities: those requested, or the default ones about the scene."""
    known = quantities(assemble(scene), settings(scene, RacewayFriction.name))
    operation = scene.operation
    low_load, high_load = _LOAD_FACTORS
    ranges = {
        OPERATION_KEYS[0]: (
            operation.temperature - _TEMPERATURE_CHANGE,
            operation.temperature + _TEMPERATURE_CHANGE,
        ),
        OPERATION_KEYS[1]: (low_load * operation.radial_load, high_load * operation.radial_load),
        OPERATION_KEYS[2]: _default_speeds(operation.inner_speed),
        OPERATION_KEYS[3]: _default_speeds(operation.outer_speed),
    }
    problems = list[str]()
    for key, text in read_overs(over or {}).items():
        name = next(
            (full for full in OPERATION_KEYS if key in (full, full.partition(".")[2])), None
        )
        if name is None:
            choices = f"there are: {', '.join(OPERATION_KEYS)}"
            problems.append(
                f"{key}: {choices if key in known else describe_unknown_key(key, known)}"
            )
            continue
        # a list of one value is a quantity that does not vary
        if isinstance(text, list) and len(text) == 1:
            text = text[0]
        try:
            ranges[name] = _read_range(name, text, known[name])
        except (UnitError, ValueError) as error:
            problems.append(f"{name}: {error}")
    raise_problems(problems)
    return ranges


def _read_range(name: str, text: object, quantity: Quantity) -> tuple[float, float]:
    """Return the bounds in a text "LOW:HIGH" with units, or of one value; raise where a bound is not allowed."""
    unit = str(quantity.unit)
    parts = [part.strip() for part in str(text).split(":")]
    if len(parts) > 2:
        raise ValueError(f"{text!r} is not a range; write LOW:HIGH, with units")
    check_typed(str(text), parts, unit)
    ends = evenly(parts[0], parts[-1], 2, unit)
    low = float(ends[0])
    high = float(ends[-1])
    if low > high or (name == OPERATION_KEYS[1] and not low > 0.0):
        raise ValueError(
            f"{text!r}: the lower end must be {'above 0 and ' * (name == OPERATION_KEYS[1])}below the upper one"
        )
    for end in (low, high):
        quantity.read(end)
    return low, high


def _default_speeds(speed: float) -> tuple[float, float]:
    """Return the default bounds of a ring's speed, the lower one first also where it turns backwards."""
    low, high = sorted(factor * speed for factor in _SPEED_FACTORS)
    return low, high


def _speed_bounds(
    assembly: Assembly, ranges: Mapping[str, tuple[float, float]]
) -> tuple[float, float, float, float]:
    """Return the smallest and largest rolling speed u [m/s] of tables, and those of the ratio R_o w/u."""
    Ri = assembly.kinematics.inner_radius
    Ro = assembly.kinematics.outer_radius
    inner, outer = np.meshgrid(
        *(np.linspace(*ranges[key], _RING_SPEEDS) for key in OPERATION_KEYS[2:])
    )
    u = Ri * Ro / (Ri + Ro) * (inner - outer)
    raise_problem_if(
        not u.any(),
        "operation.inner_speed: nothing rolls at any speed of the ranges; give other ranges",
    )
    fast = _UPPER_FACTOR * float(np.abs(u).max())
    slow = _MIN_FRACTION * fast
    if not u.min() < 0.0 < u.max():
        slow = max(_LOWER_FACTOR * float(np.abs(u).min()), slow)
    if not outer.any():
        return slow, fast, 1.0, 1.0
    rho = np.abs(Ri * inner + Ro * outer)[u != 0.0] / (Ri + Ro) * Ro / np.abs(u[u != 0.0])
    upper = min(float(rho.max()), _MAX_RATIO)
    lower = max(float(rho.min()), _MIN_RATIO * upper)
    return slow, fast, lower, upper if upper > lower else 2.0 * lower


# Points ---------------------------------------------------------------------------------------------------------------


@attrs.define(eq=False)
class _Nodes:
    """Results of computed points, by the number of the point in the sweep of all nodes."""

    plan: SurrogatePlan
    points: Points
    results: dict[int, dict[str, Array]] = attrs.field(factory=dict)

    def count(self, levels: Sequence[int]) -> int:
        """Return the number of nodes of temperature and load at levels of refinement."""
        axes = _axes(self.plan.ranges).values()
        return math.prod(len(_row(axis, level)) for axis, level in zip(axes, levels, strict=True))

    def tables(self, temperatures: Sequence[int], loads: Sequence[int]) -> dict[str, Array]:
        """Return the tables at indices of the finest rows of temperature and load: (temperature, load, ...)."""
        stride = self.plan.sweep.design.shape[1]
        numbers = np.array([[t * stride + w for w in loads] for t in temperatures])
        _compute_points(self.points, self.results, numbers.ravel().tolist())
        return {
            name: np.array([[self.results[int(n)][name] for n in row] for row in numbers])
            for name in (*_TABLE_AXES, "cage_ratio", "rolling_speed", "slide_roll")
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

    Errors of friction are relative to the largest friction over the slide-roll ratio, those of other tables to
    themselves.
    """
    worst = np.zeros(len(reference["mean_friction"]))
    for name in _TABLE_AXES:
        size = np.abs(reference[name])
        if name == "mean_friction":
            size = size.max(axis=-1, keepdims=True)
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
    for name, count in _TABLE_AXES.items():
        table = tables[name]
        for axis, stride in enumerate(strides[:count], start=table.ndim - count):
            if (nodes := table.shape[axis]) > 1:
                matrix = weights(nodes, np.arange((nodes - 1) * stride + 1) / stride)
                table = _apply_along(table, axis, matrix)
        fine[name] = table
    return fine


def _choose_point_strides(tables: Mapping[str, Array], allowed: float) -> list[int]:
    """Return the coarsest strides within a point, each with an error up to `allowed` if the other axes are fine."""
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
        If a point fails, or the finest tables leave more than the allowed error.
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
    axes = _axes(plan.ranges)
    operations = _random_operations(plan)
    seconds_each = (time.monotonic() - start) / design.size
    attempts = (
        _levels_in_time(nodes, start, seconds_each) if plan.seconds else _levels_by_error(nodes)
    )
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
            name: np.einsum("pt,pw,tw...->p...", t, w, tables[name], optimize=True)
            for name in _TABLE_AXES
        }
        errors = _max_errors(_interpolate_all_nodes(interpolated, strides), reference)
        print_line(
            f"{len(rows[0])} temperatures and {len(rows[1])} loads: the error at random operations is "
            f"{100 * errors.max():.2g} % at most"
        )
        if errors.max() <= plan.error:
            break
    if errors.max() > plan.error and not plan.seconds:
        raise ConvergenceError(
            f"the error of the finest tables at random operations is {100 * errors.max():.2g} %, more than "
            f"{100 * plan.error:.3g} %; allow a larger --error, or narrow the ranges"
        )
    dataset = _dataset(plan, axes, rows, strides, {**fine, **tables}, operations, errors)
    save(dataset, folder / RESULT)
    return dataset


def _random_operations(plan: SurrogatePlan) -> dict[str, Array]:
    """Return temperatures [K] and loads [N] of the random operations."""
    design = plan.random.design
    changes: list[Mapping[str, Any]] = [*map(design.changes, range(design.size))]
    return {
        key.partition(".")[2]: np.array(
            [float(change.get(key, plan.ranges[key][0])) for change in changes]
        )
        for key in OPERATION_KEYS[:2]
    }


def _choose_strides(plan: SurrogatePlan, fine: Mapping[str, Array], allowed: float) -> list[int]:
    """Return strides of the nodes of a point with which tables and drags are within an allowed error."""
    strides = _choose_point_strides(fine, allowed)
    rolling = fine["rolling_speed"][0, 0]
    while (
        strides[1] > 1
        and _drag_error(plan.sweep.scene, plan.ranges, rolling[:: strides[1]]) > allowed
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
    fraction = _FIRST_FRACTION
    for _ in range(_MAX_ATTEMPTS):
        allowed = fraction * nodes.plan.error
        levels = _refine_rows(nodes, levels, allowed)
        yield levels, allowed
        fraction *= _TIGHTENING


def _levels_in_time(
    nodes: _Nodes, start: float, seconds: float
) -> Iterator[tuple[Sequence[int], float]]:
    """Yield levels of both rows, loads refined first, as long as their nodes end in the time of the plan.

    Parameters
    ----------
    nodes : _Nodes
        The nodes, of which those of the levels before are known.
    start : float
        Clock at the start [s].
    seconds : float
        Time of a node [s].
    """
    end = start + (nodes.plan.seconds or math.inf)
    for attempt in range(2 * len(_ROW_STRIDES) - 1):
        levels = attempt // 2, (attempt + 1) // 2
        missing = nodes.count(levels) - len(nodes.results)
        if attempt and time.monotonic() + (1.0 + _TIME_AFTER) * missing * seconds > end:
            return
        yield levels, _FIRST_FRACTION * nodes.plan.error


def _drag_error(scene: "Scene", ranges: Mapping[str, tuple[float, float]], rolling: Array) -> float:
    """Return the relative error of the drags, tabulated over some rolling speeds [m/s]."""
    return tabulate_drags(scene, np.array(ranges[OPERATION_KEYS[0]]), ranges, rolling)[2]


def _row(axis: Axis, level: int) -> list[int]:
    """Return the indices of the nodes of temperature or load at a level of refinement."""
    return list(range(0, axis.nodes.size, _ROW_STRIDES[level]))


def _refine_rows(nodes: _Nodes, levels: Sequence[int], allowed: float) -> list[int]:
    """Return the levels of both rows at which interpolation half-way between nodes is within `allowed`.

    Along the other row, the error is measured at both ends and in the middle.
    """
    axes = [*_axes(nodes.plan.ranges).values()]
    last = _ROW_NODES - 1
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
                {name: np.moveaxis(reference[name], k, 0) for name in _TABLE_AXES},
            )
            if errors.max() <= allowed:
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
    axes: Mapping[str, Axis],
    rows: Sequence[Sequence[int]],
    strides: Sequence[int],
    tables: Mapping[str, Array],
    operations: Mapping[str, Array],
    errors: Array,
) -> "xr.Dataset":
    """Return the result: tables, numbers of the bearing, ranges, errors at random operations, and steady states."""
    scene = plan.sweep.scene
    T, W = (axes[name].nodes[row] for name, row in zip(axes, rows, strict=True))
    nodes = {
        name: tables[name][0, 0][::stride]
        for name, stride in zip(("cage_ratio", "rolling_speed", "slide_roll"), strides, strict=True)
    }
    drags, max_cage_speed, _ = tabulate_drags(scene, T, plan.ranges, nodes["rolling_speed"])
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
    for name, unit, over, text in _DRAG_VARIABLES:
        variables[f"drag_{name}"] = (over, drags[name], about(unit, text))
    variables |= bearing_variables(scene)
    variables |= {
        f"{key.partition('.')[2]}_range": ("end", np.array(ends), about(unit, f"ends of {key}"))
        for (key, ends), unit in zip(plan.ranges.items(), _UNITS, strict=True)
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
    step = math.asinh(max_cage_speed / CAGE_SMALL) / (CAGE_NODES - 1)
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
    outer = plan.sweep.scene.operation.outer_speed
    T = result["temperature"].to_numpy()
    W = result["radial_load"].to_numpy()
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
        cage_speed = bearing.kinematics.epicyclic_cage_speed
        for w, load in enumerate(W.tolist()):
            springs[t, w, k] = stiffness(
                bearing.at_load(load), cage_speed * (1.0 - float(slips[t, w, k]))
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
