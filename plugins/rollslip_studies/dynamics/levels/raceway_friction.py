"""Friction of both raceways in a bearing in motion: effective, conventional or constant.

Without tilt the loads of the slices of a roller follow from its force. So conventional friction of a roller is
tabulated over force, sliding and rolling speed: the same law, not an average. `_build_friction_table` does that:

1. Choose the scale V_s of the sliding speed over which friction of light and heavy contacts is interpolated best.
2. Evaluate the chain of laws at the nodes: equal steps of u/(u + u_s), r/(r + r_s) with r = sqrt(Q), V/(V + V_s).
   Values at negative sliding speeds follow, since laws are odd in V.
3. Compare a piecewise cubic interpolation with the sum over all slices at random contacts.
4. If the error exceeds the tolerance, find the axis with the largest error half-way between its nodes, and double the
   nodes of that axis.
5. Stop without a table if several refinements in a row do not reduce the error, or the table becomes too large.

All other cases evaluate the chain of laws for every slice: tilted rollers, laws in Python, tables that do not reach the
tolerance, contacts outside a table, and film parameters. `RacewayFriction.evaluation_method` states the reason.
"""

import math
from collections.abc import Sequence
from functools import partial
from typing import Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import Array, Raceway
from rollslip.errors import RollslipError
from rollslip_kernels.gauss import row_rules
from rollslip_kernels.motion import raceway as compiled
from rollslip_kernels.slices import Slices
from rollslip_studies.dynamics.levels.load_map import LoadMap, build_load_map
from rollslip_studies.motion.effective_table import EffectiveTable, effective_table

#: Friction by name -> what it is.
FRICTION: Final = {
    "effective": "the effective friction of the raceways, tabulated once",
    "conventional": "the friction of every loaded slice",
    "constant": "one coefficient",
}

#: How friction is evaluated without a table, in words.
_AT_EVERY_STEP: Final = "at every step"
#: Force, relative to the usual force of a roller (its fraction of the load plus its centrifugal force), up to which
#: deflection is tabulated. Doubling it makes tables less dense; beyond it forces come from the slices. Chosen.
DEFLECTION_FORCE_FACTOR = 10.0
#: Force, relative to the usual one, from which on friction is tabulated. Below it the chain of laws is evaluated:
#: rollers pass such forces only where they enter and leave the loaded zone. At 1e-3 motions of 'gearbox' and of an
#: NU 310 take as long, at 1e-4 that of the NU 310 takes 1.5 times as long, for more nodes. Chosen.
_MIN_FORCE = 1e-2
#: Lower bound of the force that the error of friction is relative to, over the usual one. Halving it requires smaller
#: absolute errors of light contacts, whose friction hardly counts. Chosen.
_LIGHT_FORCE = 1e-2
#: Force, relative to the largest one at the epicyclic cage speed, up to which friction is tabulated. Doubling it leaves
#: fewer contacts to the chain of laws and makes the table less dense. Chosen.
_MAX_FORCE = 1.5
#: Smallest and largest rolling speed of a table, relative to the epicyclic one. A wider range needs more nodes; outside
#: it the chain of laws is evaluated. Chosen.
_ROLLING_SPEEDS = (0.4, 1.6)
#: Largest sliding speed of a table, relative to the epicyclic rolling speed. Rollers at rest slide at less than
#: twice that speed. Chosen.
_MAX_SLIDING = 2.5
#: Scale u_s of the coordinate u/(u + u_s), relative to the epicyclic rolling speed. Smaller scales concentrate nodes at
#: slow rolling, where friction changes most. Chosen.
_ROLLING_SCALE: Final = 0.5
#: Initial number of nodes of rolling speed, of force, and of sliding speed on each side of zero. Axes are doubled where
#: needed, so that twice as many save refinements and make tables of loose tolerances larger. Chosen.
_FIRST_NODES = (5, 17, 24)
#: Maximum number of nodes of a table in all: 19 MB, built in 2 s. Friction at the local pressure has kinks over force,
#: at which an error halves as nodes double. With a quarter of them four of six bearings evaluate slices at every step
#: at a tolerance of 1 %, which takes 5 to 10 times as long; doubled, short motions lose the time of building.
_MAX_NODES = 2_400_000
#: Ratio of the error after a refinement to the smallest one before, above which the refinement failed. Chosen: a cubic
#: of a smooth function would gain a factor of 16, at a kink a factor of 2.
_GAIN = 0.9
#: Number of refinements in a row that may fail before there is no table. One per axis, and one more. Doubling it costs
#: time where a law has a jump.
_MAX_FAILED_REFINEMENTS = 4
#: Number of slices below which the chain of laws takes no longer than a table.
_MIN_SLICES: Final = 13
#: Number of roller positions over which effective friction is averaged where forms of rings turn. With sixteen times as
#: many, it changes by less than 1e-4.
_TURNING_POSITIONS: Final = 64
#: Number of random contacts at which a table is compared with the slices. Doubling it doubles the time of a comparison
#: and finds slightly larger errors. Chosen.
_PROBES: Final = 600
#: Number of forces whose contacts are evaluated together. With one, nodes take 1.2 times as long; with 32, 1.05 times.
_FORCES: Final = 8
#: Candidates for the scale V_s of the sliding speed, relative to the rolling speed. Chosen: a step of a factor of 1.8.
_SLIDING_SCALES: Final = np.geomspace(1e-3, 1.0, 13)
#: Number of nodes from zero sliding on with which the candidates are compared. Chosen.
_SCALE_NODES: Final = 64
#: Gaps [m] between which the force of a roller is interpolated as a start of Newton's method. Chosen: any contact is
#: between 1 pm and 1 cm. They count from where a film begins to carry, up to 1 mm before the bodies touch: with an end
#: at 1 mm loads at a layer of that thickness were far too small.
_GAPS: Final = np.geomspace(1e-12, 1e-2, 1001)
#: Largest number of Newton steps for the gap of a force, kept between two of these gaps. Chosen: the force of dry
#: bodies is nearly a power of the gap, so that three reach rounding; where a film yields, some halve the interval.
_MAX_NEWTON_STEPS: Final = 30
#: Step of the gap, relative to it, with which the search ends. Chosen: rounding of some operations.
_GAP_ROUNDING: Final = 1e-14


@attrs.frozen(kw_only=True)
class FrictionSettings:
    """Friction of the contacts of a bearing in motion, and the values that are watched.

    Parameters
    ----------
    name : str
        One of `FRICTION`.
    tabulated : bool
        Whether quantities that follow from the force of a roller may come from tables; if not, they come from the
        slices at every evaluation.
    coefficient, transition : float
        Constant friction: mu_0, and the sliding speed V_s [m/s] in mu_0 V/sqrt(V^2 + V_s^2).
    tolerance : float, optional
        Error of loads and tables; by default that of the resolution.
    critical_slip, film_limit : float
        Cage slip and film parameter that are watched; NaN for none. Only conventional friction has a film parameter.
    between_nodes : float
        Target of the error of tables of effective friction between their nodes, as a fraction of the allowed error.
    min_slices : int
        Number of slices from which on conventional friction comes from a table. By default that where a table is faster
        than the chain of laws.
    fully_loaded : Assembly, optional
        The bearing under its largest load. Tables of conventional friction and of plane motion are built for its forces
        and cached with it, so that bearings that differ by their load alone share them. By default the bearing itself.
    n_loads : int
        Loads of a Gauss rule that stand for the slices of a roller at the nodes of tables of conventional friction, 0
        for all slices. The error of a table is measured by all slices in either case.
    """

    name: str
    tabulated: bool = True
    coefficient: float = math.nan
    transition: float = math.nan
    tolerance: float | None = None
    critical_slip: float = math.nan
    film_limit: float = math.nan
    between_nodes: float = 1.0
    min_slices: int = _MIN_SLICES
    fully_loaded: Assembly | None = None
    n_loads: int = 0

    @property
    def watched_film(self) -> float:
        """Film parameter that is watched; NaN where friction has none."""
        return self.film_limit if self.name == "conventional" else math.nan

    def table_tolerance(self, assembly: Assembly) -> float:
        """Return the error that loads and tables of a bearing may have, relative."""
        return assembly.resolution.table_tolerance if self.tolerance is None else self.tolerance


@attrs.frozen(eq=False, kw_only=True)
class _Grid:
    """Coordinates and nodes of a table of friction: rolling speed, force, and sliding speed of both signs."""

    sliding_scale: float  # V_s [m/s] of V/(|V| + V_s)
    sliding_end: float  # last node of that coordinate
    root_scale: float = 1.0  # r_s [N^0.5] of r/(r + r_s), r = sqrt(Q)
    root_ends: tuple[float, float] = (0.0, 0.5)  # first and last node of that coordinate
    speed_scale: float = 1.0  # u_s [m/s] of u/(u + u_s)
    speed_ends: tuple[float, float] = (0.0, 0.5)  # first and last node of that coordinate
    #: Number of nodes: speed, root, sliding on each side of zero.
    nodes: tuple[int, int, int] = _FIRST_NODES

    def speed(self, fraction: Array) -> Array:
        """Return the rolling speed [m/s] at fractions 0 to 1 of its axis."""
        x = _between(self.speed_ends, fraction)
        return np.asarray(self.speed_scale * x / (1.0 - x))

    def force(self, fraction: Array) -> Array:
        """Return the force [N] at fractions 0 to 1 of its axis."""
        x = _between(self.root_ends, fraction)
        return np.asarray((self.root_scale * x / (1.0 - x)) ** 2)

    def sliding(self, fraction: Array) -> Array:
        """Return the sliding speed [m/s] at fractions -1 to 1 of its axis."""
        x = self.sliding_end * fraction
        return np.asarray(x * self.sliding_scale / (1.0 - np.abs(x)))


def _between(ends: tuple[float, float], fraction: Array) -> Array:
    """Return the coordinate at a fraction between its first and last node."""
    low, high = ends
    return low + (high - low) * fraction


@attrs.frozen(eq=False, kw_only=True)
class FrictionTable(_Grid):
    """Conventional friction of a roller over force, sliding and rolling speed, as `compiled.with_table` takes it."""

    #: F/sqrt(Q) [N^0.5] and, if there is any, rolling resistance over sqrt(Q); over rolling speed, force, sliding
    #: speed.
    values: Array
    #: Largest error at random contacts [1]: of traction relative to the largest friction coefficient times the force
    #: (or a light force), of rolling resistance relative to its largest value.
    error: float

    def tabulated(self, raceway: object) -> object:
        """Return a compiled conventional raceway that reads this table."""
        return compiled.with_table(
            raceway,
            self.values,
            self.sliding_scale,
            self.sliding_end,
            self.root_scale,
            self.root_ends,
            self.speed_scale,
            self.speed_ends,
        )

    @property
    def record(self) -> dict[str, object]:
        """Size and error by name, as results store them."""
        speeds = [self.speed_scale * end / (1.0 - end) for end in self.speed_ends]
        return {"nodes": list(self.values.shape[1:]), "error": self.error, "rolling_speed": speeds}


@attrs.frozen(eq=False)
class RacewayFriction:
    """Friction of inner and outer raceway."""

    settings: FrictionSettings  # kind of friction
    capsules: tuple[object, object]  # compiled raceways of `rollslip_kernels.motion.raceway`
    slices: tuple[Slices, ...] = ()  # work arrays of conventional friction
    tables: tuple[EffectiveTable, ...] = ()  # tables of effective friction
    #: Tables of conventional friction without tilt; none where it comes from the slices.
    friction_tables: tuple[FrictionTable, ...] = ()
    evaluation_method: str = ""  # how conventional friction is evaluated, in words

    @property
    def uses_slices(self) -> bool:
        """Whether every evaluation of friction evaluates the slices of a roller."""
        return self.settings.name == "conventional" and not self.friction_tables


def usual_force(assembly: Assembly) -> float:
    """Return the usual force of a roller [N]: its fraction of the load plus its centrifugal force plus 0.1 N."""
    return (
        assembly.scene.operation.radial_load / assembly.scene.bearing.rollers
        + assembly.centrifugal_force
        + 0.1
    )


def _forces(assembly: Assembly) -> tuple[float, float]:
    """Return the usual force of a roller, and the largest force of tables of its friction [N]."""
    usual = usual_force(assembly)
    at_rest = assembly.load_distribution(1)
    heaviest = max(
        float((load @ assembly.widths).max()) for load in (at_rest.inner_load, at_rest.outer_load)
    )
    return usual, max(_MAX_FORCE * heaviest, usual)


def tilts(assembly: Assembly) -> bool:
    """Return whether rollers or rings tilt: by misalignment, or by a profile that is not symmetric."""
    drop = assembly.drop
    return assembly.scene.operation.misalignment != 0.0 or not np.allclose(
        drop, drop[::-1], rtol=1e-9, atol=1e-15
    )


def raceway_friction(
    assembly: Assembly, settings: FrictionSettings, loads: LoadMap | None = None
) -> RacewayFriction:
    """Return the friction of both raceways.

    Parameters
    ----------
    assembly : Assembly
        The bearing, with its resistance to rolling.
    settings : FrictionSettings
        Kind of friction.
    loads : LoadMap, optional
        Loads over which effective friction is averaged; by default they are computed where they are needed.
    """
    rollers = assembly.scene.bearing.rollers
    if settings.name == "constant":
        inner, outer = (
            compiled.constant(rollers, settings.coefficient, settings.transition)
            for _ in assembly.raceways
        )
        return RacewayFriction(settings, (inner, outer))
    if settings.name == "conventional":
        return _conventional_friction(assembly, settings)
    effective = _effective_tables(assembly, settings, loads)
    inner, outer = (table.raceway(rollers) for table in effective)
    return RacewayFriction(settings, (inner, outer), tables=effective)


def _conventional_friction(assembly: Assembly, settings: FrictionSettings) -> RacewayFriction:
    """Return friction by the chain of laws, from tables over force and both speeds where these are possible."""
    rollers = assembly.scene.bearing.rollers
    slices = tuple(
        Slices(rollers * assembly.slices, raceway.conditions) for raceway in assembly.raceways
    )
    if assembly.inner.chain.placed:
        for table in slices:
            table.places()  # allocates the columns of positions that the motion fills
    inner, outer = (
        compiled.conventional(
            raceway.chain.kernel,
            table,
            rollers,
            assembly.widths,
            raceway.chain.resists,
            assembly.position,
            assembly.max_transverse_speed(raceway.ring),
        )
        for raceway, table in zip(assembly.raceways, slices, strict=True)
    )
    tables: tuple[FrictionTable, ...] = ()
    method = _AT_EVERY_STEP
    if settings.tabulated:
        tables, method = _friction_tables(assembly, settings)
    if tables:
        inner, outer = (
            table.tabulated(raceway) for table, raceway in zip(tables, (inner, outer), strict=True)
        )
    return RacewayFriction(
        settings, (inner, outer), slices=slices, friction_tables=tables, evaluation_method=method
    )


def _effective_tables(
    assembly: Assembly, settings: FrictionSettings, loads: LoadMap | None
) -> tuple[EffectiveTable, ...]:
    """Return the tables of effective friction of both raceways, averaged over the loads of an orbit."""
    if loads is None and assembly.rings is not None and assembly.rings.turning:
        key = (
            assembly.slices,
            assembly.resolution.quadrature,
            *(raceway.deflection for raceway in assembly.raceways),
        )
        distribution = assembly.cached(
            "loads over turns", key, partial(assembly.load_distribution, _TURNING_POSITIONS)
        )
        return tuple(
            _effective_table(
                assembly, ring, load.reshape(-1, assembly.slices), distribution, settings
            )
            for ring, load in enumerate((distribution.inner_load, distribution.outer_load))
        )
    if loads is None:
        loads = build_load_map(assembly, settings.table_tolerance(assembly))
    of_orbit = loads.loads(min(assembly.centrifugal_force, loads.top))
    return tuple(
        _effective_table(assembly, ring, of_orbit[ring], loads.orbits, settings) for ring in (0, 1)
    )


def _effective_table(
    assembly: Assembly, ring: int, load: Array, loads: object, settings: FrictionSettings
) -> EffectiveTable:
    """Return the effective friction of a ring at the epicyclic speed, cached for a bearing and its loads."""
    raceway = assembly.raceways[ring]
    options = settings.table_tolerance(assembly), settings.between_nodes
    key = ring, loads, raceway.conditions, raceway.chain.models, raceway.chain.bounds, *options
    return assembly.cached(
        "effective friction", key, lambda: effective_table(assembly, raceway, load, *options)
    )


def _reason_against_table(assembly: Assembly, min_slices: int) -> str:
    """Return why conventional friction of a bearing is not tabulated; empty if it may be."""
    if tilts(assembly):
        return "rollers tilt, so that the loads along one do not follow from its force"
    if assembly.slices < min_slices:
        return f"{assembly.slices} slices cost no more than a table of them"
    if assembly.inner.chain.placed:
        return "a law reads where slices are"
    if any(raceway.chain.is_single_threaded for raceway in assembly.raceways):
        return "a law has no compiled form, and may depend on more than a table knows"
    return ""


def _friction_tables(
    assembly: Assembly, settings: FrictionSettings
) -> tuple[tuple[FrictionTable, ...], str]:
    """Return the tables of both raceways, or none, and how friction is evaluated in words; cached for a bearing."""
    if reason := _reason_against_table(assembly, settings.min_slices):
        return (), f"{_AT_EVERY_STEP}: {reason}"
    tolerance = settings.table_tolerance(assembly)
    tables = list[FrictionTable]()
    fully_loaded = assembly if settings.fully_loaded is None else settings.fully_loaded
    forces = _forces(fully_loaded)
    for raceway in assembly.raceways:
        key = (
            raceway.conditions,
            raceway.chain.models,
            raceway.chain.bounds,
            tolerance,
            settings.n_loads,
            assembly.drop.tobytes(),
            assembly.widths.tobytes(),
            *forces,
        )
        build = partial(
            _build_friction_table, assembly, raceway, tolerance, forces, settings.n_loads
        )
        table = fully_loaded.cached("friction by force", key, build)
        if isinstance(table, str):
            return (), f"{_AT_EVERY_STEP}: {table}"
        tables.append(table)
    error = max(table.error for table in tables)
    return (
        tuple(tables),
        f"from a table over force and both speeds, within {error:.1e} of it, at every step outside it",
    )


def _build_friction_table(
    assembly: Assembly,
    raceway: Raceway,
    tolerance: float,
    forces: tuple[float, float],
    n_loads: int,
) -> FrictionTable | str:
    """Return the table of a raceway, or the reason why there is none."""
    law = _RollerFriction(assembly, raceway, n_loads)
    usual, largest = forces
    speed = abs(float(assembly.kinematics.surface_speeds(0.0, 0.0).inner_rolling))
    if not speed > 0.0:
        return "nothing rolls at the epicyclic speed"
    root_scale = math.sqrt(usual)
    first = math.sqrt(_MIN_FORCE * usual)
    last = math.sqrt(largest)
    slow, fast = _ROLLING_SPEEDS
    nodes = [*_FIRST_NODES]
    values = None
    axis = 0
    smallest_error = math.inf
    failed_refinements = 0
    try:
        scale = law.best_sliding_scale((usual, last**2), speed)
        while True:
            grid = _Grid(
                sliding_scale=scale,
                sliding_end=_MAX_SLIDING * speed / (_MAX_SLIDING * speed + scale),
                root_scale=root_scale,
                root_ends=(first / (first + root_scale), last / (last + root_scale)),
                speed_scale=_ROLLING_SCALE * speed,
                speed_ends=(slow / (slow + _ROLLING_SCALE), fast / (fast + _ROLLING_SCALE)),
                nodes=(nodes[0], nodes[1], nodes[2]),
            )
            values = law.values_at_nodes(grid, values, axis)
            error = law.error(grid, values, usual)
            if error <= tolerance:
                break
            failed_refinements += 1
            if error < _GAIN * smallest_error:
                smallest_error = error
                failed_refinements = 0
            axis = int(np.argmax([law.error(grid, values, usual, axis) for axis in range(3)]))
            nodes[axis] = 2 * nodes[axis] - (axis < 2)
            if (
                nodes[0] * nodes[1] * (2 * nodes[2] + 1) > _MAX_NODES
                or failed_refinements == _MAX_FAILED_REFINEMENTS
            ):
                return (
                    f"a table of it on the {raceway.ring} ring would err by {error:.1e}, more than the {tolerance:.1e} "
                    "that tables may leave"
                )
    except RollslipError as refusal:
        # the motion may never reach such a contact; if it does, the law refuses it there
        return f"a law of the {raceway.ring} ring ends where a table of it would have to reach ({refusal})"
    return FrictionTable(
        **attrs.asdict(grid, recurse=False), values=_of_both_senses(values), error=error
    )


class _RollerFriction:
    """Friction of a roller by its force, from the chain of laws of a raceway: F and rolling resistance over sqrt(Q)."""

    def __init__(self, assembly: Assembly, raceway: Raceway, n_loads: int) -> None:
        self.assembly = assembly
        self.raceway = raceway
        self.n_loads = n_loads
        # slices of equal drop have equal loads: they are evaluated once, with the sum of their widths
        self.drop, same_drop = np.unique(assembly.drop - assembly.drop.min(), return_inverse=True)
        self.widths = np.asarray(np.bincount(same_drop, assembly.widths), dtype=float)
        self.forces = self._loads(_GAPS) @ self.widths
        self.at_random: Array | None = None  # true values at the random contacts

    def _loads(self, gap: Array) -> Array:
        """Return the loads per length of the slices at gaps [m], (m, n)."""
        return self.assembly.deflect(gap[:, None] - self.drop, self.raceway.ring)[0]

    def loads(self, force: Array) -> Array:
        """Return the loads per length of the slices at forces [N], (m, n), by Newton's method for the gap."""
        force, index = np.unique(force, return_inverse=True)
        above = np.clip(np.searchsorted(self.forces, force), 1, _GAPS.size - 1)
        low = _GAPS[above - 1]
        high = _GAPS[above]
        gap = 0.5 * (low + high)
        for _ in range(_MAX_NEWTON_STEPS):
            load, stiffness = self.assembly.deflect(gap[:, None] - self.drop, self.raceway.ring)
            lacking = force - load @ self.widths
            low = np.where(lacking > 0.0, gap, low)
            high = np.where(lacking > 0.0, high, gap)
            step = lacking / np.maximum(stiffness @ self.widths, np.finfo(float).tiny)
            if np.all(np.abs(step) <= _GAP_ROUNDING * gap):
                break
            inside = (gap + step >= low) & (gap + step <= high)
            gap = np.where(inside, gap + step, 0.5 * (low + high))
        return self._loads(gap)[index]

    def _reduced_loads(self, force: Array) -> tuple[Array, Array]:
        """Return the loads per length that stand for the slices at forces [N], and their widths [m], (m, n) each."""
        loads = self.loads(force)
        if not self.n_loads:
            return loads, np.broadcast_to(self.widths, loads.shape)
        return row_rules(np.ascontiguousarray(loads), self.widths, self.n_loads)

    def _of_loads(self, load: Array, widths: Array, sliding: Array, rolling: Array) -> Array:
        """Return F and the rolling resistance over sqrt(Q), (1 or 2, m), of loads (m, n) at speeds (m,)."""
        loaded = load > 0.0
        count = np.count_nonzero(loaded, axis=1)  # above zero for each roller, as its force is
        slices = self.raceway.evaluate(
            load[loaded],
            np.repeat(np.hypot(rolling, compiled.REST_SPEED), count),
            np.repeat(sliding, count),
        )
        first = np.cumsum(count) - count
        parts = [slices.friction * slices.load]
        if self.raceway.chain.resists:
            parts.append(slices.resistance)
        loaded_widths = np.broadcast_to(widths, load.shape)[loaded]
        sums = np.array([np.add.reduceat(part * loaded_widths, first) for part in parts])
        return np.asarray(sums / np.sqrt((load * widths).sum(axis=1)))

    def best_sliding_scale(self, forces: tuple[float, ...], speed: float) -> float:
        """Return the scale V_s [m/s] with the smallest interpolation error at forces [N], slow and fast rolling."""
        nodes_and_middles = np.linspace(0.0, 1.0, 2 * _SCALE_NODES + 1)
        size = nodes_and_middles.size
        contacts = [(force, factor) for force in forces for factor in _ROLLING_SPEEDS]
        loads, widths = (
            values.repeat(size, axis=0)
            for values in self._reduced_loads(np.array([force for force, _ in contacts]))
        )
        rolling = np.array([factor for _, factor in contacts]).repeat(size) * speed
        smallest_error = math.inf
        best = speed
        for scale in (_SLIDING_SCALES * speed).tolist():
            grid = _Grid(
                sliding_scale=scale,
                sliding_end=_MAX_SLIDING * speed / (_MAX_SLIDING * speed + scale),
            )
            sliding = np.tile(grid.sliding(nodes_and_middles), len(contacts))
            error = 0.0
            for values in self._of_loads(loads, widths, sliding, rolling)[0].reshape(
                len(contacts), -1
            ):
                difference = np.abs(
                    _interpolated(values[::2], [_cells(nodes_and_middles[1::2], _SCALE_NODES + 1)])
                    - values[1::2]
                )
                error = max(error, float(difference.max() / np.abs(values).max()))
            if error < smallest_error:
                smallest_error = error
                best = scale
        return best

    def values_at_nodes(self, grid: _Grid, known: Array | None = None, axis: int = 0) -> Array:
        """Return the values at the nodes from zero sliding on, (1 or 2, speeds, roots, slidings).

        ``known`` are every other of an axis.
        """
        speeds, roots, half = grid.nodes
        fractions = [np.linspace(0.0, 1.0, nodes) for nodes in (speeds, roots, half + 1)]
        if known is not None:
            fractions[axis] = fractions[axis][1::2]
        V, u = (
            mesh.ravel()
            for mesh in np.meshgrid(grid.sliding(fractions[2]), grid.speed(fractions[0]))
        )
        rows = []
        loads, widths = self._reduced_loads(grid.force(fractions[1]))
        for first in range(0, len(loads), _FORCES):
            part = slice(first, first + _FORCES)
            values = self._of_loads(
                loads[part].repeat(V.size, axis=0),
                widths[part].repeat(V.size, axis=0),
                np.tile(V, len(loads[part])),
                np.tile(u, len(loads[part])),
            )
            rows.append(values.reshape(len(values), -1, fractions[0].size, fractions[2].size))
        values = np.concatenate(rows, axis=1).swapaxes(1, 2)
        if known is None:
            return values
        merged = np.moveaxis(np.empty((len(values), speeds, roots, half + 1)), axis + 1, 0)
        merged[::2] = np.moveaxis(known, axis + 1, 0)
        merged[1::2] = np.moveaxis(values, axis + 1, 0)
        return np.moveaxis(merged, 0, axis + 1)

    def error(self, grid: _Grid, values: Array, usual: float, axis: int | None = None) -> float:
        """Return the largest error of an interpolation, relative to the largest friction coefficient times the force.

        It is measured at random contacts or, with an axis, half-way between its nodes and on nodes of the others.
        """
        fractions = np.random.default_rng(1).uniform(size=(3, _PROBES))
        fractions[2] = 2.0 * fractions[2] - 1.0
        if axis is not None:
            for k, nodes in enumerate(grid.nodes):
                cells = nodes - (k < 2)
                fractions[k] = (
                    np.clip(np.floor(fractions[k] * cells), -cells if k == 2 else 0, cells - 1)
                    + (0.5 if k == axis else 0.0)
                ) / cells
        force = grid.force(fractions[1])
        true = self.at_random if axis is None else None
        if true is None:
            loads, widths = (
                (self.loads(force), self.widths) if axis is None else self._reduced_loads(force)
            )
            true = self._of_loads(
                loads, widths, grid.sliding(fractions[2]), grid.speed(fractions[0])
            )
            if axis is None:  # the random contacts do not depend on the number of nodes
                self.at_random = true
        cells_of_probes = [*map(_cells, np.abs(fractions), values.shape[1:])]
        interpolated = np.array([_interpolated(part, cells_of_probes) for part in values])
        interpolated[0] *= np.sign(fractions[2])
        difference = np.abs(interpolated - true) * np.sqrt(force)
        reference = np.maximum(force, _LIGHT_FORCE * usual)
        coefficient = np.abs(true[0]) * np.sqrt(force) / reference
        errors = [difference[0] / (float(coefficient.max()) * reference)]
        if len(difference) > 1:
            errors.append(difference[1] / float((np.abs(true[1]) * np.sqrt(force)).max()))
        return float(np.max(errors))


def _of_both_senses(values: Array) -> Array:
    """Return values at sliding speeds of both signs from those above zero: friction is odd, rolling resistance even.

    If laws of others are neither, the error at random contacts of both signs shows it.
    """
    signs = np.array([-1.0, 1.0])[: len(values), None, None, None]
    return np.concatenate((signs * values[..., :0:-1], values), axis=-1)


def _cells(fraction: Array, nodes: int) -> tuple[Array, Array]:
    """Return the index of the first of four nodes about a fraction of an axis, and the distance from it in cells.

    No four nodes reach across zero sliding.
    """
    index = fraction * (nodes - 1)
    first = np.clip(np.floor(index).astype(int) - 1, 0, nodes - 4)
    return first, index - first


def _interpolated(values: Array, cells: Sequence[tuple[Array, Array]]) -> Array:
    """Return the cubic Lagrange interpolation between four nodes along every axis, as friction_table.h computes it."""
    new = len(cells) * (np.newaxis,)
    result = values[
        tuple(
            (first + np.arange(4)[:, np.newaxis])[(*new[:axis], slice(None), *new[axis + 1 :])]
            for axis, (first, _) in enumerate(cells)
        )
    ]
    for _, t in cells:
        weights = [
            np.prod([(t - k) / (node - k) for k in range(4) if k != node], axis=0)
            for node in range(4)
        ]
        result = np.einsum("nm,n...m->...m", weights, result)
    return np.asarray(result)
