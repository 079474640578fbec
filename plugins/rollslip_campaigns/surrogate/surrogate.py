"""Makes the tables of a surrogate: points of a sweep over temperature and load, refined until random ones are right.

- A point is study raceway-friction at one temperature and load. It costs some hundredths of a second and has more nodes
  over speeds and slide-roll ratios than are kept: how many are needed is seen against those that are left out.
- Temperature and load are rows of many even nodes, of which few are computed at first and then every second one
  between, along the one that errs more, held against nodes half-way. All of it is in the journal of one sweep, so that
  the same command goes on.
- At last random temperatures and loads are computed, of all speeds and ratios each. If one is off by more than asked
  for, nodes are added until all are right. The error of the file is the largest of these.
- How much oil the bearing gets, of which starvation and churning follow, goes with the speeds of its rings: tables over
  rolling speed have that of rings between which it rolls so without slip.
"""

import json
import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.errors import ConvergenceError, SceneError
from rollslip.results.dataset import about, save
from rollslip.scene.changes import evolve, unknown
from rollslip.search import Array
from rollslip.studies.study import settings
from rollslip.units import UnitError, check_typed, evenly, format_quantity
from rollslip_campaigns.surrogate.stiffness import stiffness
from rollslip_campaigns.surrogate.tables import CAGE_SMALL, Axis, Tables, weights
from rollslip_campaigns.sweep.definition import Sweep
from rollslip_campaigns.sweep.folder import Points
from rollslip_campaigns.sweep.journal import FAILED, records
from rollslip_campaigns.sweep.point import values_of
from rollslip_campaigns.sweep.result import origin_of_points
from rollslip_campaigns.sweep.run import Progress, requested_engine
from rollslip_campaigns.sweep.sampling import read_fraction, read_overs
from rollslip_campaigns.sweep.sweep import plan_sweep
from rollslip_studies.raceway_friction.study import (
    ROLLING,
    SMALL,
    RacewayFriction,
    at_rolling_speed,
)
from rollslip_studies.variation.quantities import quantities

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.scene.values import Scene
    from rollslip_campaigns.surrogate import SurrogateSettings

__all__ = ["RESULT", "Surrogate", "plan_surrogate", "run_surrogate"]

RESULT: Final = "surrogate.nc"
#: Nodes of the rows of temperature and load, and strides from the first one on.
_ROW = 49
_STRIDES = (16, 8, 4, 2, 1)
#: Strides of the nodes of a point: cage ratio, rolling speed, slide-roll ratio, coarse to fine.
_WITHIN: Final = ((4, 2), (8, 4, 2), (4, 2))
#: Share of the error for one axis at first, and by how much less it is where random operations are off.
_FRACTION = 0.8
_TIGHTER = 0.5
_TIMES = 4
#: Ranges where none are named: factors of a load and of a speed, and kelvins about a temperature.
_LOADS = (0.4, 2.5)
_SPEEDS = (0.15, 1.2)
_KELVINS = 20.0
#: Rolling speeds over those of the rings at the epicyclic speed: a cage at rest has about twice that.
_SLOWER = 0.7
_FASTER = 1.6
_SLOWEST = 0.01
#: Speeds of a ring at which ratios are looked at, and bounds of these: without a cage speed no roller is pressed.
_LOOKED_AT = 9
_MIN_RATIO = 0.05
_MAX_RATIO = 50.0
#: Cage speeds and shaft speeds of the tables over them.
_CAGE = 65
_SHAFT = 9
#: Error of drags that tell of another dependence than that on leads and squares, and what rounding leaves of one.
_NO_SUM: Final = 0.1
_NOTHING: Final = 1e-10
_KEYS: Final = (
    "operation.temperature",
    "operation.radial_load",
    "operation.inner_speed",
    "operation.outer_speed",
)
_OUTPUTS: Final = tuple(RacewayFriction.outputs)
#: Table -> how many of cage ratio, rolling speed and slide-roll ratio it is over.
_LAST: Final = {"mean_friction": 3, "largest_friction": 2, "ring_resistance": 2, "ring_force": 2}
_TABLES: Final = tuple(_LAST)


@attrs.frozen(eq=False, kw_only=True)
class Surrogate:
    """What is tabulated.

    Attributes
    ----------
    scene : Scene
        The scene without tables of campaigns.
    sweep : Sweep
        All temperatures and loads that may be computed.
    random : Sweep
        Random ones.
    ranges : mapping
        Ends of every quantity, in SI units.
    error : float
        What the tables may leave.
    """

    scene: "Scene"
    sweep: Sweep
    random: Sweep
    ranges: Mapping[str, tuple[float, float]]
    error: float

    @property
    def unusual(self) -> tuple[str, ...]:
        """What is unusual of the values."""
        return self.sweep.unusual

    @property
    def told(self) -> list[str]:
        """What is tabulated, in words."""
        units = dict(zip(_KEYS, ("K", "N", "rad/s", "rad/s"), strict=True))
        spans = (
            f"  {key}: "
            + " to ".join(dict.fromkeys(format_quantity(end, units[key], 4) for end in ends))
            for key, ends in self.ranges.items()
        )
        return [
            self.sweep.headline,
            *spans,
            f"  until random operations are within {100 * self.error:.3g} %",
        ]

    @property
    def axes(self) -> dict[str, Axis]:
        """The rows of temperature and load."""
        return _axes(self.ranges)


def _axes(ranges: Mapping[str, tuple[float, float]]) -> dict[str, Axis]:
    """Return the rows of temperature and load; one node where both ends are the same."""
    found = {}
    for key, name, logarithmic in zip(
        _KEYS, ("temperature", "radial_load"), (False, True), strict=False
    ):
        low, high = ranges[key]
        row = (np.geomspace if logarithmic else np.linspace)(low, high, _ROW)
        found[name] = Axis(row if high > low else row[:1], logarithmic)
    return found


def plan_surrogate(requested: "SurrogateSettings") -> Surrogate:
    """Check the ranges and lay out the points."""
    base = attrs.evolve(requested.given, sweep=None, uncertainty=None)
    assembly = assemble(base)
    if (pocket := assembly.cage.drags.pocket_friction) is not None:
        raise SceneError(
            [f"cage.drag: {pocket.name}: one mean roller has no force in its pocket, so that its friction there cannot "
             "be tabulated; leave it out, or go through time at level pocket"]
        )  # fmt: skip
    ranges = _ranges(base, requested.over)
    error = read_fraction(requested.error)
    if not 1e-4 <= error <= 0.2:
        raise SceneError(
            [
                f"error: a share from 0.0001 to 0.2 is expected, such as 0.01 or '1 %', not {requested.error}"
            ]
        )
    slow, fast, least, most = _speeds(assembly, ranges)
    of_study = f"study.{RacewayFriction.name}"
    told = {f"{of_study}.slowest": slow, f"{of_study}.fastest": fast, f"{of_study}.smallest_ratio": least,
            f"{of_study}.largest_ratio": most}  # fmt: skip
    scene = evolve(base, told)
    rolling = np.geomspace(slow, fast, ROLLING)
    off = _drags(scene, np.array(ranges[_KEYS[0]]), ranges, rolling)[2]
    names = f"cage.drag: {', '.join(model.name for model in assembly.cage.drags.torques)}: "
    if off > _NO_SUM:
        raise SceneError(
            [f"{names}what they do is no sum of what goes with the lead of a ring and what goes with the cage's speed, "
             "so that it cannot be tabulated"]
        )  # fmt: skip
    if off > error:
        raise SceneError(
            [f"{names}between the most speeds of a table they are off by {100 * off:.2g} %; allow a larger error, or "
             "narrow the ranges of speeds"]
        )  # fmt: skip
    how = {"study": RacewayFriction.name, "output": list(_OUTPUTS), "engine": requested.engine,
           "time_limit": requested.time_limit}  # fmt: skip
    rows = dict[str, object]()
    spans = dict[str, object]()
    for key, axis in zip(_KEYS, _axes(ranges).values(), strict=False):
        rows[key] = axis.nodes.tolist()
        if axis.nodes.size > 1:
            low, high = ranges[key]
            spans[key] = f"{low!r}:{high!r}{':log' if axis.logarithmic else ''}"
    sweep = plan_sweep(scene, rows, **how)
    requested_engine(sweep)
    random = plan_sweep(
        scene, spans or {_KEYS[1]: rows[_KEYS[1]]},
        **how | ({"samples": requested.checks, "seed": 1, "sampling": "latin-hypercube"} if spans else {}),
    )  # fmt: skip
    sweep, random = (attrs.evolve(one, given=requested.given) for one in (sweep, random))
    return Surrogate(scene=base, sweep=sweep, random=random, ranges=ranges, error=error)


def _ranges(scene: "Scene", over: object) -> dict[str, tuple[float, float]]:
    """Return the ends of all four quantities."""
    known = quantities(assemble(scene), settings(scene, RacewayFriction.name))
    o = scene.operation
    found = {
        _KEYS[0]: (o.temperature - _KELVINS, o.temperature + _KELVINS),
        _KEYS[1]: (_LOADS[0] * o.radial_load, _LOADS[1] * o.radial_load),
        **{
            key: _around(value)
            for key, value in zip(_KEYS[2:], (o.inner_speed, o.outer_speed), strict=True)
        },
    }
    problems = list[str]()
    for key, text in read_overs(over or {}).items():
        name = next((full for full in _KEYS if key in (full, full.partition(".")[2])), None)
        if name is None:
            there = f"there are: {', '.join(_KEYS)}"
            problems.append(f"{key}: {there if key in known else unknown(key, known)}")
            continue
        text = (
            text[0] if isinstance(text, list) and len(text) == 1 else text
        )  # one value, where nothing varies
        unit = str(known[name].unit)
        parts = [part.strip() for part in str(text).split(":")]
        try:
            if len(parts) > 2:
                raise ValueError(f"{text!r} is no range; write LOW:HIGH, with units")
            check_typed(str(text), parts, unit)
            ends = evenly(parts[0], parts[-1], 2, unit)
            low = float(ends[0])
            high = float(ends[-1])
            if low > high or (name == _KEYS[1] and not low > 0.0):
                raise ValueError(
                    f"{text!r}: the first end must be {'above 0 and ' * (name == _KEYS[1])}below the second"
                )
            for end in (low, high):
                known[name].read(end)
            found[name] = low, high
        except (UnitError, ValueError) as error:
            problems.append(f"{name}: {error}")
    if problems:
        raise SceneError(problems)
    return found


def _around(speed: float) -> tuple[float, float]:
    low, high = sorted(factor * speed for factor in _SPEEDS)
    return low, high


def _speeds(
    assembly: Assembly, ranges: Mapping[str, tuple[float, float]]
) -> tuple[float, float, float, float]:
    """Return the ends of the rolling speeds [m/s], and those of R_o w/u without slip."""
    Ri = assembly.kinematics.inner_radius
    Ro = assembly.kinematics.outer_radius
    inner, outer = np.meshgrid(*(np.linspace(*ranges[key], _LOOKED_AT) for key in _KEYS[2:]))
    u = Ri * Ro / (Ri + Ro) * (inner - outer)
    if not u.any():
        raise SceneError(
            ["operation.inner_speed: nothing rolls at any speed of the ranges; give other ones"]
        )
    fast = _FASTER * float(np.abs(u).max())
    slow = (
        _SLOWEST * fast
        if u.min() < 0.0 < u.max()
        else max(_SLOWER * float(np.abs(u).min()), _SLOWEST * fast)
    )
    if not outer.any():
        return slow, fast, 1.0, 1.0
    rho = np.abs(Ri * inner + Ro * outer)[u != 0.0] / (Ri + Ro) * Ro / np.abs(u[u != 0.0])
    most = min(float(rho.max()), _MAX_RATIO)
    least = max(float(rho.min()), _MIN_RATIO * most)
    return slow, fast, least, most if most > least else 2.0 * least


# The points -----------------------------------------------------------------------------------------------------------


@attrs.define(eq=False)
class _Nodes:
    """What points have given, by number of temperature and load in their rows."""

    made: Surrogate
    points: Points
    known: dict[int, dict[str, Array]] = attrs.field(factory=dict)

    def at(self, temperatures: Sequence[int], loads: Sequence[int]) -> dict[str, Array]:
        """Return tables at numbers of both rows: (temperature, load, ...)."""
        numbers = np.array([[self._number(t, w) for w in loads] for t in temperatures])
        _computed(self.points, self.known, numbers.ravel().tolist())
        return {
            name: np.array([[self.known[int(n)][name] for n in row] for row in numbers])
            for name in (*_TABLES, "cage_ratio", "rolling_speed", "slide_roll")
        }

    def _number(self, t: int, w: int) -> int:
        return t * self.made.sweep.design.shape[1] + w


def _computed(points: Points, known: dict[int, dict[str, Array]], numbers: Sequence[int]) -> None:
    """Compute some points, those that failed once more, and add what they have given."""
    requested = [number for number in numbers if number not in known]
    if not requested:
        return
    points.compute(requested, again=FAILED)
    failed = dict[int, str]()
    for row in records(points.folder):
        if row.status == "ok":
            if row.number not in known:
                known[row.number] = values_of(row)
            failed.pop(row.number, None)
        elif row.number not in known:
            failed[row.number] = row.message
    if lost := [number for number in requested if number not in known]:
        raise ConvergenceError(
            f"{len(lost)} of {len(requested)} operations failed, the first: "
            f"{failed.get(lost[0], 'it was not computed')}; "
            "narrow the ranges"
        )


# Between the nodes ----------------------------------------------------------------------------------------------------


def _along(table: Array, axis: int, matrix: Array) -> Array:
    return np.moveaxis(np.tensordot(matrix, table, axes=(1, axis)), 0, axis)


def _errors(found: Mapping[str, Array], true: Mapping[str, Array]) -> Array:
    """Largest error of each row of the first axis: of friction relative to the largest, of the others to themselves."""
    worst = np.zeros(len(true["mean_friction"]))
    for name in _TABLES:
        size = np.abs(true[name])
        if name == "mean_friction":
            size = size.max(axis=-1, keepdims=True)
        off = np.abs(found[name] - true[name]) / np.where(size > 0.0, size, np.inf)
        worst = np.maximum(worst, off.reshape(len(worst), -1).max(axis=1))
    return worst


def _thin(tables: Mapping[str, Array], strides: Sequence[int]) -> dict[str, Array]:
    """Return every so many nodes of cage ratio, rolling speed and slide-roll ratio, the last axes of a table."""
    every: list[Any] = [slice(None, None, stride) for stride in strides]
    return {name: tables[name][(..., *every[:count])] for name, count in _LAST.items()}


def _thick(tables: Mapping[str, Array], strides: Sequence[int]) -> dict[str, Array]:
    """Return thin tables on all nodes."""
    found = {}
    for name, count in _LAST.items():
        table = tables[name]
        for axis, stride in enumerate(strides[:count], start=table.ndim - count):
            if (nodes := table.shape[axis]) > 1:
                table = _along(
                    table, axis, weights(nodes, np.arange((nodes - 1) * stride + 1) / stride)
                )
        found[name] = table
    return found


def _strides_within(tables: Mapping[str, Array], allowed: float) -> list[int]:
    """Return the coarsest strides within a point that leave so much of each axis alone."""
    flat = {name: tables[name].reshape(-1, *tables[name].shape[2:]) for name in _TABLES}
    chosen = [options[-1] for options in _WITHIN]
    for k, options in enumerate(_WITHIN):
        for stride in options:
            alone = [stride if j == k else 1 for j in range(len(_WITHIN))]
            if _errors(_thick(_thin(flat, alone), alone), flat).max() <= allowed:
                chosen[k] = stride
                break
    return chosen


def run_surrogate(
    made: Surrogate,
    folder: Path,
    *,
    said: Callable[[str], None] = lambda text: None,
    report: Callable[[Progress], None] = lambda progress: None,
) -> "xr.Dataset":
    """Compute the tables, or what is left of them, in a folder, and write the result there."""
    nodes = _Nodes(made, Points.of(made.sweep, folder / "nodes", said, report))
    places = Points.of(made.random, folder / "random", said, report)
    true = dict[int, dict[str, Array]]()
    _computed(places, true, range(made.random.design.size))
    random = {name: np.array([true[k][name] for k in sorted(true)]) for name in _TABLES}
    axes = made.axes
    at = _random_places(made)
    level = [0, 0]
    fraction = _FRACTION
    for _ in range(_TIMES):
        level = _refined(nodes, level, fraction * made.error)
        rows = [_row(axis, k) for axis, k in zip(axes.values(), level, strict=True)]
        whole = nodes.at(*rows)
        strides = _strides_within(whole, fraction * made.error)
        while strides[1] > 1 and _drags(
            made.sweep.scene, np.array(made.ranges[_KEYS[0]]), made.ranges, whole["rolling_speed"][0, 0][:: strides[1]]
        )[2] > fraction * made.error:  # fmt: skip
            strides[1] //= 2
        tables = _thin(whole, strides)
        errors = _errors(_thick(_interpolated(tables, axes, rows, at), strides), random)
        said(f"{len(rows[0])} temperatures and {len(rows[1])} loads: random operations are off by "
             f"{100 * errors.max():.2g} % at most")  # fmt: skip
        if errors.max() <= made.error:
            break
        fraction *= _TIGHTER
    else:
        raise ConvergenceError(
            f"the most nodes leave {100 * errors.max():.2g} % at random operations, more than the "
            f"{100 * made.error:.3g} % asked for; allow a larger --error, or narrow the ranges"
        )
    dataset = _dataset(made, axes, rows, strides, {**whole, **tables}, at, errors)
    save(dataset, folder / RESULT)
    return dataset


def _row(axis: Axis, level: int) -> list[int]:
    return [0] if axis.nodes.size == 1 else list(range(0, _ROW, _STRIDES[level]))


def _refined(nodes: _Nodes, level: Sequence[int], allowed: float) -> list[int]:
    """Return how fine both rows have to be, each held against nodes half-way, at three places of the other."""
    axes = [*nodes.made.axes.values()]
    found = [*level]
    for k in (0, 1):
        other = [0] if axes[1 - k].nodes.size == 1 else [0, _ROW // 2, _ROW - 1]
        while axes[k].nodes.size > 1 and found[k] < len(_STRIDES) - 1:
            row = _row(axes[k], found[k])
            half = [(a + b) // 2 for a, b in pairwise(row)]
            known, true = (
                nodes.at(*((some, other) if k == 0 else (other, some))) for some in (row, half)
            )
            between = weights(len(row), np.arange(0.5, len(half)))
            guessed = {name: _along(known[name], k, between) for name in _TABLES}
            if (
                _errors(
                    *({n: np.moveaxis(of[n], k, 0) for n in _TABLES} for of in (guessed, true))
                ).max()
                <= allowed
            ):
                break
            found[k] += 1
    return found


def _random_places(made: Surrogate) -> dict[str, Array]:
    """Return temperatures and loads of the random operations."""
    changes: list[Mapping[str, Any]] = [
        made.random.design.changes(k) for k in range(made.random.design.size)
    ]
    return {
        key.partition(".")[2]: np.array(
            [float(one.get(key, made.ranges[key][0])) for one in changes]
        )
        for key in _KEYS[:2]
    }


def _interpolated(
    tables: Mapping[str, Array],
    axes: Mapping[str, Axis],
    rows: Sequence[Sequence[int]],
    at: Mapping[str, Array],
) -> dict[str, Array]:
    """Return tables (temperature, load, ...) at places, (place, ...)."""
    t, w = (Axis(axes[name].nodes[row], axes[name].logarithmic).weights(at[name])
            for name, row in zip(axes, rows, strict=True))  # fmt: skip
    return {
        name: np.einsum("pt,pw,tw...->p...", t, w, tables[name], optimize=True) for name in _TABLES
    }


# What it comes to -----------------------------------------------------------------------------------------------------


def _drags(
    scene: "Scene", temperatures: Array, ranges: Mapping[str, tuple[float, float]], rolling: Array
) -> tuple[dict[str, Array], float, float]:
    """Return what the drags of the cage do, the cage speed up to which what is left goes, and the largest error.

    Over temperature, what goes with the cage's square over rolling speeds too, what is left over cage speeds. The error
    is that of cages between the speeds of their rings, relative to all drags there, or at the largest speeds.
    """
    rng = np.random.default_rng(1)
    most = max(abs(speed) for key in _KEYS[2:] for speed in ranges[key])
    step = math.asinh(most / CAGE_SMALL) / (_CAGE - 1)
    cages = CAGE_SMALL * np.sinh(step * np.arange(_CAGE))
    found: dict[str, list[Any]] = {name: [] for name in ("inner", "outer", "cage", "rest")}
    axis = Axis(rolling, True)
    worst = 0.0
    for temperature in temperatures.tolist():
        bearing = assemble(evolve(scene, {_KEYS[0]: temperature}))
        drags = bearing.cage.drags
        k = bearing.kinematics

        def lead(of: int, drags: Any = drags) -> float:
            speeds = [0.5 * most] * 3
            before = drags.torque(*speeds)
            speeds[of] += most
            return float((drags.torque(*speeds) - before) / most)

        inner = lead(1)
        outer = lead(2)

        def left(w: float, drags: Any = drags, leads: float = inner + outer) -> float:
            return float(drags.torque(w, 0.0, 0.0)) + leads * w

        def square(drags: Any, left: Callable[[float, Any], float] = left) -> float:
            return (
                -8.0
                * (left(most, drags) - 2.0 * left(0.75 * most, drags) + left(0.5 * most, drags))
                / most**2
            )

        size = abs(left(most)) + (abs(inner) + abs(outer)) * most
        own = square(drags)
        own = own if abs(own) * most**2 > _NOTHING * size else 0.0
        squares = np.array(
            [square(at_rolling_speed(bearing, u).cage.drags) for u in rolling.tolist()]
        )
        rest = np.array([left(w) + own * w * w for w in cages.tolist()])
        rest[np.abs(rest) <= _NOTHING * size] = 0.0
        for name, value in (("inner", inner), ("outer", outer), ("cage", squares), ("rest", rest)):
            found[name].append(value)
        for _ in range(20):
            more = rng.uniform(-most, most)
            u = float(np.exp(rng.uniform(*np.log(rolling[[0, -1]]))))
            wi = more + u * (1.0 / k.inner_radius + 1.0 / k.outer_radius)
            wo = more
            w = float(rng.uniform(wo, wi))
            true = at_rolling_speed(bearing, u).cage.drags.torque(w, wi, wo)
            x = math.asinh(abs(w) / CAGE_SMALL) / step
            told = (
                inner * (wi - w)
                + outer * (wo - w)
                - float((axis.weights(u) @ squares)[0]) * abs(w) * w
            )
            told += math.copysign(1.0, w) * float((weights(_CAGE, np.array([x])) @ rest)[0])
            worst = max(worst, abs(told - true) / max(size, abs(true), 1e-300))
    return {name: np.array(values) for name, values in found.items()}, float(cages[-1]), worst


def _dataset(
    made: Surrogate,
    axes: Mapping[str, Axis],
    rows: Sequence[Sequence[int]],
    strides: Sequence[int],
    tables: Mapping[str, Array],
    at: Mapping[str, Array],
    errors: Array,
) -> "xr.Dataset":
    import xarray as xr

    scene = made.sweep.scene
    assembly = assemble(scene)
    k = assembly.kinematics
    o = scene.operation
    Z = scene.bearing.rollers
    m = assembly.roller_mass
    T, W = (axes[name].nodes[row] for name, row in zip(axes, rows, strict=True))
    nodes = {name: tables[name][0, 0][::stride] for name, stride in
             zip(("cage_ratio", "rolling_speed", "slide_roll"), strides, strict=True)}  # fmt: skip
    drags, cage_top, _ = _drags(scene, T, made.ranges, nodes["rolling_speed"])
    dims = ("ring", "temperature", "radial_load", "cage_ratio", "rolling_speed", "slide_roll")
    outputs = RacewayFriction.outputs
    variables: dict[str, Any] = {
        name: (dims[: 3 + last], np.moveaxis(tables[name], 2, 0), about(outputs[name].unit, outputs[name].meaning))
        for name, last in _LAST.items()
    }  # fmt: skip
    for name, unit, text in (
        ("inner", "N m s", "torque of drags on the cage over the lead of the inner ring"),
        ("outer", "N m s", "torque of drags on the cage over the lead of the outer ring"),
        ("cage", "N m s2", "torque of drags against the cage over the square of its speed"),
    ):
        over = ("temperature", "rolling_speed")[: drags[name].ndim]
        variables[f"drag_{name}"] = (over, drags[name], about(unit, text))
    variables["drag_rest"] = (
        ("temperature", "cage_speed"), drags["rest"], about("N m", "what is left of the drags, along the cage's speed")
    )  # fmt: skip
    for name, value, unit, text in (
        ("inner_radius", k.inner_radius, "m", "radius of the inner raceway"),
        ("outer_radius", k.outer_radius, "m", "radius of the outer raceway"),
        ("roller_radius", k.roller_radius, "m", "radius of a roller"),
        ("orbit_radius", k.orbit_radius, "m", "radius of the orbit"),
        ("roller_mass", m, "kg", "mass of a roller"),
        (
            "orbital_inertia",
            assembly.cage.inertia + Z * m * k.orbit_radius**2,
            "kg m2",
            "of cage and rollers",
        ),
        (
            "spin_inertia",
            Z * 0.5 * m * k.roller_radius**2,
            "kg m2",
            "of all rollers about themselves",
        ),
        ("first_load", o.radial_load, "N", "radial load of the scene"),
        ("first_temperature", o.temperature, "K", "temperature of the scene"),
        ("first_inner_speed", o.inner_speed, "rad/s", "speed of the inner ring of the scene"),
        ("first_outer_speed", o.outer_speed, "rad/s", "speed of the outer ring of the scene"),
    ):
        variables[name] = ((), float(value), about(unit, text))
    for key, unit in zip(_KEYS, ("K", "N", "rad/s", "rad/s"), strict=True):
        name = key.partition(".")[2]
        variables[f"{name}_range"] = (
            "end",
            np.array(made.ranges[key]),
            about(unit, f"ends of {key}"),
        )
    variables |= {
        "operation_error": ("operation", errors, about("1", "largest error at a random operation")),
        **{f"operation_{name}": ("operation", value, about(unit, f"{name.replace('_', ' ')} there"))
           for (name, value), unit in zip(at.items(), ("K", "N"), strict=True)},
    }  # fmt: skip
    units = {"temperature": "K", "radial_load": "N", "cage_ratio": "1", "rolling_speed": "m/s",
             "slide_roll": "1", "cage_speed": "rad/s"}  # fmt: skip
    step = math.asinh(cage_top / CAGE_SMALL) / (_CAGE - 1)
    values = {
        "temperature": T,
        "radial_load": W,
        **nodes,
        "cage_speed": CAGE_SMALL * np.sinh(step * np.arange(_CAGE)),
    }
    coords: dict[str, Any] = {
        name: (name, value, about(units[name], name.replace("_", " ")))
        for name, value in values.items()
    }
    coords["ring"] = ("ring", ["inner", "outer"], about("1", "raceway"))
    found = xr.Dataset(
        variables,
        coords=coords,
        attrs=origin_of_points(attrs.evolve(made.sweep, scene=made.scene), [], [], study="surrogate") | {
            "error": float(errors.max()),
            "median_error": float(np.median(errors)),
            "error_requested": made.error,
            "sliding_small": SMALL,
            "nodes": json.dumps([len(row) for row in rows] + [len(one) for one in nodes.values()]),
        },
    )  # fmt: skip
    return _with_steady(found, made)


def _with_steady(found: "xr.Dataset", made: Surrogate) -> "xr.Dataset":
    """Return tables with what a bearing that runs at constant speeds does, over temperature, load and shaft speed."""
    low, high = made.ranges[_KEYS[2]]
    speeds = np.linspace(low, high, _SHAFT) if high > low else np.array([low])
    tables = Tables.of(found)
    outer = made.sweep.scene.operation.outer_speed
    T = found["temperature"].to_numpy()
    W = found["radial_load"].to_numpy()
    rows = np.array(
        [
            [np.stack(attrs.astuple(tables.at(t, w).steady(speeds, outer)), axis=-1) for w in W]
            for t in T
        ]
    )
    dims = ("temperature", "radial_load", "inner_speed")
    told = (
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
    made_of = {
        name: (dims, rows[..., k], about(unit, text)) for k, (name, unit, text) in enumerate(told)
    }
    springs = _springs(made, T, W, speeds, rows[..., 0])
    for name, at in (("along", (0, 0)), ("across", (1, 1)), ("oblique to", (0, 1))):
        made_of[f"stiffness_{name.split()[0]}"] = (
            dims,
            springs[..., *at],
            about("N/m", f"stiffness {name} the load"),
        )
    speed = {"inner_speed": ("inner_speed", speeds, about("rad/s", "speed of the inner ring"))}
    return found.assign(made_of).assign_coords(speed)


def _springs(
    made: Surrogate, temperatures: Array, loads: Array, speeds: Array, slips: Array
) -> Array:
    """Return stiffnesses [N/m] at the slips at which the bearing runs, at none where it does not, (T, W, n, 2, 2)."""
    found = np.empty((*slips.shape, 2, 2))
    for t, k in np.ndindex(len(temperatures), len(speeds)):
        at = {_KEYS[0]: float(temperatures[t]), _KEYS[2]: float(speeds[k])}
        bearing = assemble(evolve(made.scene, at))
        for w, load in enumerate(loads.tolist()):
            slip = 0.0 if np.isnan(slips[t, w, k]) else float(slips[t, w, k])
            found[t, w, k] = stiffness(
                bearing.at_load(load), bearing.kinematics.epicyclic_cage_speed * (1.0 - slip)
            )
    return found
