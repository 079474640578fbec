"""Plan the operations that a surrogate tabulates: ranges of temperature, load and speeds, and their finest nodes.

Ranges that are not requested lie about the scene. The smallest and largest rolling speed, and the ratio R_o w/u, follow
from the speeds of both rings. Drags that the finest tables do not reproduce are refused.
"""

from collections.abc import Mapping
from typing import Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.errors import SceneError
from rollslip.results.text import duration
from rollslip.scene.changes import Quantity, describe_unknown_key, evolve
from rollslip.scene.values import Scene
from rollslip.search import Array
from rollslip.structure import raise_problem_if, raise_problems
from rollslip.studies.quantities import quantities
from rollslip.studies.study import settings
from rollslip.units import UnitError, check_typed, evenly, format_quantity, quantity
from rollslip_campaigns.surrogate import SurrogateSettings
from rollslip_campaigns.surrogate.drags import OPERATION_KEYS, drag_errors, tabulate_drags
from rollslip_campaigns.surrogate.tables import (
    Axis,
)
from rollslip_campaigns.sweep.definition import Sweep
from rollslip_campaigns.sweep.run import requested_engine
from rollslip_campaigns.sweep.sampling import Design, read_fraction, read_overs
from rollslip_campaigns.sweep.sweep import plan_sweep
from rollslip_studies.raceway_friction.study import (
    ROLLING_NODES,
    RacewayFriction,
)

__all__ = ["UNITS", "SurrogatePlan", "drag_error", "plan_surrogate", "row_axes"]

#: Nodes of the finest axes of temperature and load, uniform in temperature and in the logarithm of load: three times
#: the largest of the strides of module surrogate, and one. Doubling the intervals, with a stride of 32 before the
#: others, allows smaller tolerances and changes no coarser table.
ROW_NODES: Final = 49
#: Smallest and largest load over that of the scene, where no range is named. Wider ranges need more nodes; chosen.
_LOAD_FACTORS: Final = (0.4, 2.5)
#: The same for the speed of a ring: a run-up without its first part, and a fifth of overspeed. Chosen; wider ranges
#: need more nodes of rolling speed.
_SPEED_FACTORS: Final = (0.15, 1.2)
#: Kelvins below and above the temperature of the scene, where no range is named. Chosen: viscosities change by about a
#: factor of four over the range. Doubling it needs more nodes of temperature.
_TEMPERATURE_CHANGE: Final = 20.0
#: Smallest rolling speed over the smallest one at the epicyclic cage speed: slip changes the rolling speed by at
#: most (R_o - R_i)/(2 R_o), see study raceway-friction, which is below 0.3 where R_i exceeds 0.4 R_o. Halving it
#: stretches the logarithmic axis; above 1 steady states would lie outside of it.
_LOWER_FACTOR: Final = 0.7
#: Largest rolling speed over the largest epicyclic one. A cage at rest has about twice the epicyclic one; chosen
#: below it, because beyond the tables the last value is used. Doubling it stretches the logarithmic axis.
_UPPER_FACTOR: Final = 1.6
#: Smallest rolling speed over the largest one, also where rings reverse. Halving it stretches the logarithmic axis
#: by 15 %, so that more nodes are needed; doubling it lets slower rings use the friction at 2 % of the largest speed.
#: Chosen.
_MIN_FRACTION: Final = 0.01
#: Speeds of each ring at which rolling speed and ratio are evaluated; both are extreme at the ends of ranges
#: except where rings reverse: there more of them find a rolling speed nearer to zero, which `_MIN_FRACTION` bounds.
#: Chosen; doubling it changes nothing for rings that do not reverse.
_RING_SPEEDS: Final = 9
#: Smallest ratio of tables, over the largest one or over 1, that of an outer ring at rest. Below it the centrifugal
#: force, 0.25 % of that at 1, hardly changes contact forces. Half the value makes their mean error 1.8 times as large
#: where rings of gearbox, turbine and 1032930-70C turn against each other, because nodes lie farther apart; twice the
#: value changes it by 0.9 to 1.9 times. Chosen.
_MIN_CAGE_RATIO: Final = 0.05
#: Largest ratio of tables; it has no bound where both rings turn alike and nothing rolls. There the mean error of
#: contact forces is 0.2 % in gearbox, 1.7 % in turbine and 1.0 % in 1032930-70C. Half the value makes it 1.8 times as
#: large, because more ratios lie beyond the tables; twice the value makes it 0.85, 1.05 and 0.5 times as large, because
#: nodes lie farther apart, too. Chosen.
_MAX_CAGE_RATIO: Final = 50.0
#: SI units of the quantities in `OPERATION_KEYS`, in their order.
UNITS: Final = ("K", "N", "rad/s", "rad/s")


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
    rolling : ndarray of float, (n,)
        Rolling speeds of the finest tables [m/s].
    error : float
        Largest relative error that is allowed.
    seconds : float or None
        Time for the tables [s], which may then have a larger error; None for as long as the error takes.
    """

    scene: "Scene"
    sweep: Sweep
    random: Sweep
    ranges: Mapping[str, tuple[float, float]]
    rolling: Array
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
                for (key, ends), unit in zip(self.ranges.items(), UNITS, strict=True)
            ),
            f"  until random operations are within {100 * self.error:.3g} %"
            + (f", or {duration(self.seconds)} are over" if self.seconds else ""),
        ]


@attrs.frozen(eq=False)
class _WithAxialLoad(Design):
    """Points that have an axial load in the ratio of a scene to their radial load."""

    scene: Scene = attrs.field(kw_only=True)

    def changes(self, number: int) -> dict[str, object]:
        """Return the values that the point of a number changes in the scene, by key."""
        changes = super().changes(number)
        operation = self.scene.operation.with_load(float(str(changes[OPERATION_KEYS[1]])))
        return {**changes, "operation.axial_load": operation.axial_load}


def _with_axial_load(sweep: Sweep, given: Scene) -> Sweep:
    """Return a sweep of a given scene whose points have an axial load in its ratio to the radial load, if any."""
    design = sweep.design
    if given.operation.axial_load:
        design = _WithAxialLoad(design.axes, design.sampled, design.samples, scene=given)
    return attrs.evolve(
        sweep,
        design=design,
        given=given,
        # values were checked with another axial load than points have
        unusual=tuple(text for text in sweep.unusual if "operation.axial_load" not in text),
    )


def _holding_loads(
    assembly: Assembly, ends: tuple[float, float], cage_speed: float, *, is_default: bool
) -> tuple[float, float]:
    """Return the ends of the radial load [N] if they hold the rings of a tapered bearing together, or raise.

    The lower end rises where it is the default one.
    """
    scene = assembly.scene
    if scene.bearing.contact_angle is None:
        return ends
    low, high = ends
    k = assembly.kinematics
    inner_speed = cage_speed * (k.inner_radius + k.outer_radius) / k.inner_radius
    operation = attrs.evolve(scene.operation, inner_speed=inner_speed, outer_speed=0.0)
    fast = attrs.evolve(assembly, scene=attrs.evolve(scene, operation=operation))
    smallest = fast.at_load(low).scene.operation.radial_load
    raise_problem_if(
        smallest > (high if is_default else low),
        f"{OPERATION_KEYS[1]}: {format_quantity(low, 'N')}, with the axial load in its ratio, does not hold the rings "
        f"of a tapered bearing together at the largest speed of the tables, {format_quantity(smallest, 'N', 4)} does; "
        "raise the lower end, or narrow the ranges of speeds",
    )
    return smallest, high


def row_axes(ranges: Mapping[str, tuple[float, float]]) -> dict[str, Axis]:
    """Return the finest axes of temperature and load; an axis has one node where both bounds are the same."""
    axes = {}
    for key, name, logarithmic in zip(
        OPERATION_KEYS[:2], ("temperature", "radial_load"), (False, True), strict=True
    ):
        low, high = ranges[key]
        space = np.geomspace if logarithmic else np.linspace
        row = space(low, high, ROW_NODES)
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
    if base.models.loss:
        raise SceneError(
            [
                "models.loss: tables hold the friction of rollers and cage alone; leave it out, --set models.loss=[], "
                "and add these losses to the torque of the tables",
            ]
        )
    raise_problem_if(
        not base.operation.radial_load,
        "operation.radial_load: tables range over it, and hold the axial load in its ratio to it; state a radial load, "
        "or compute steady slips with sweep",
    )
    ranges = _ranges(base, requested.over)
    error = read_fraction(requested.error)
    raise_problem_if(
        not 1e-4 <= error <= 0.2,
        f"error: a fraction from 0.0001 to 0.2 is expected, such as 0.01 or '1 %', not {requested.error}",
    )
    slow, fast, min_ratio, max_ratio = _speed_bounds(assembly, ranges)
    cage_speed = max_ratio * fast / assembly.kinematics.outer_radius
    ranges[OPERATION_KEYS[1]] = _holding_loads(
        assembly,
        ranges[OPERATION_KEYS[1]],
        cage_speed,
        is_default=not any("radial_load" in key for key in read_overs(requested.over or {})),
    )
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
    rolling = np.geomspace(slow, fast, ROLLING_NODES)
    deviation = drag_error(scene, ranges, rolling)
    names = f"cage.drag: {', '.join(model.name for model in assembly.cage.drags.torques)}: "
    raise_problem_if(
        deviation > error,
        f"{names}the finest table, a sum of terms in the leads of the rings and in the speed of the cage, errs by "
        f"{100 * deviation:.2g} %; allow a larger error, narrow the ranges of speeds, or leave them out",
    )
    options = {
        "study": RacewayFriction.name,
        "output": list(RacewayFriction.outputs),
        "engine": requested.engine,
        "time_limit": requested.time_limit,
    }
    rows = dict[str, object]()
    spans = dict[str, object]()
    for key, axis in zip(OPERATION_KEYS[:2], row_axes(ranges).values(), strict=True):
        rows[key] = axis.nodes.tolist()
        if axis.nodes.size > 1:
            low, high = ranges[key]
            spans[key] = f"{low!r}:{high!r}{':log' if axis.logarithmic else ''}"
    if base.operation.axial_load:
        # values are checked one by one, with the axial load of the largest radial load
        operation = base.operation.with_load(ranges[OPERATION_KEYS[1]][1])
        scene = evolve(scene, {"operation.axial_load": operation.axial_load}, si=True)
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
        sweep=_with_axial_load(sweep, requested.base_scene),
        random=_with_axial_load(random, requested.base_scene),
        ranges=ranges,
        rolling=rolling,
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
    upper = min(float(rho.max()), _MAX_CAGE_RATIO)
    lower = max(float(rho.min()), _MIN_CAGE_RATIO * min(upper, 1.0))
    return slow, fast, lower, upper if upper > lower else 2.0 * lower


def drag_error(scene: Scene, ranges: Mapping[str, tuple[float, float]], rolling: Array) -> float:
    """Return the relative error of the drags at the ends of the temperatures, tabulated over rolling speeds [m/s].

    Parameters
    ----------
    scene : Scene
        The scene whose cage has the drags.
    ranges : mapping
        Lower and upper bound of temperature and speeds of both rings, by `OPERATION_KEYS`.
    rolling : ndarray of float, (n,)
        Nodes of the rolling speed [m/s], even in its logarithm.
    """
    ends = np.unique(ranges[OPERATION_KEYS[0]])
    tables = tabulate_drags(scene, ends, ranges, rolling)
    return float(drag_errors(scene, ends, tables).max())
