"""Friction of both raceways by the name that a study gives it: what the compiled systems of the dynamics work with.

- Without tilt the loads of a roller's slices follow from its force. So conventional friction of a roller is tabulated
  over force, sliding and rolling speed: the same law, not an average. The error is that against all slices at random
  contacts; nodes are added along the axis that errs most until it is within the tolerance of tables.
- The chain stays for all else: tilted rollers, laws in Python, a table that does not get there, contacts outside it,
  and film parameters. `RacewayFriction.way` says which it is.
"""

import logging
import math
from collections.abc import Sequence
from functools import partial
from typing import Final, TypeVar

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import Array, Raceway
from rollslip.errors import RollslipError
from rollslip_kernels.motion import raceway as compiled
from rollslip_kernels.slices import Slices
from rollslip_studies.dynamics.levels.load_map import LoadMap, build_load_map
from rollslip_studies.motion.effective_table import EffectiveTable, effective_table

_log = logging.getLogger(__name__)

T = TypeVar("T")

#: Friction by name -> what it is.
FRICTION: Final = {
    "effective": "the effective friction of the raceways, tabulated once",
    "conventional": "the friction of every loaded slice",
    "constant": "one coefficient",
}

_SLICED: Final = "at every step"
#: Times the usual force of a roller, its share of load and its centrifugal force, up to which deflection is tabulated,
#: from which on friction is, and below which its error is that of a light contact; and the largest force of the bearing
#: at its epicyclic speed, up to which friction is.
DEEP = 10.0
_LEAST = 1e-6
_LIGHT = 1e-2
_HEAVY = 1.5
#: Rolling speeds over the epicyclic one, and the largest sliding speed over it, of a table of friction.
_SPEEDS = (0.4, 1.6)
_REACH = 2.5
#: The rolling speed over the epicyclic one that stands for u_s: friction turns where it is slow.
_SLOW: Final = 0.5
#: Nodes of rolling speed, of force and on either side of no sliding at first, and the most of all together.
_FIRST_NODES = (5, 17, 24)
_MAX_NODES = 300_000
#: What more nodes have to leave of the error at most, and how often in a row they may fail to before there is no table.
_GAIN = 0.9
_VAIN = 4
#: Slices below which the chain costs no more than a table.
_FEW: Final = 13
#: Instants over which effective friction is a mean where forms turn: over sixteen times as many it differs by < 1e-4.
_TURNS: Final = 64
#: Random contacts at which a table is held against the slices.
_PROBES: Final = 600
#: Sliding speeds over the rolling speed among which that is chosen over which friction rises, by so many nodes.
_SCALES: Final = np.geomspace(1e-3, 1.0, 13)
_RISE: Final = 64


@attrs.frozen(kw_only=True)
class FrictionSettings:
    """Which friction the contacts of a moving bearing have, and which of its values are watched.

    Parameters
    ----------
    name : str
        One of `FRICTION`.
    tabulated : bool
        Whether what follows from a roller's force may come from tables; if not, from the slices at every evaluation.
    effective_over : str
        What effective friction is tabulated over: "sliding-speed", or "slips" for sliding and rolling speed.
    coefficient, transition : float
        Constant friction: mu_0, and the sliding speed V_s [m/s] in mu_0 V/sqrt(V^2 + V_s^2).
    tolerance : float, optional
        Error of loads and tables, by default that of the resolution.
    critical_slip, film_limit : float
        Cage slip and film parameter that are watched; NaN for none. Only conventional friction knows the film.
    between_nodes : float
        Share, up to 1, of what tables of effective friction may leave between their nodes that is aimed at.
    like : Assembly, optional
        The bearing under its largest load: tables of conventional friction are made for its forces and kept with it, so
        that bearings that differ by their load alone share them, and so are those of plane motion. By default the
        bearing itself.
    """

    name: str
    tabulated: bool = True
    effective_over: str = "sliding-speed"
    coefficient: float = math.nan
    transition: float = math.nan
    tolerance: float | None = None
    critical_slip: float = math.nan
    film_limit: float = math.nan
    between_nodes: float = 1.0
    like: Assembly | None = None

    @property
    def watched_film(self) -> float:
        """Film parameter that is watched, NaN where friction knows no film."""
        return self.film_limit if self.name == "conventional" else math.nan

    def table_tolerance(self, assembly: Assembly) -> float:
        """Error of loads and tables of a bearing."""
        return assembly.resolution.table_tolerance if self.tolerance is None else self.tolerance


@attrs.frozen(eq=False, kw_only=True)
class _Grid:
    """Nodes of a table of friction: of rolling speed, of force, and on either side of no sliding."""

    sliding_scale: float  # V_s [m/s] of V/(|V| + V_s)
    sliding_end: float  # its last node
    root_scale: float = 1.0  # r_s [N^0.5] of r/(r + r_s), r = sqrt(Q)
    root_ends: tuple[float, float] = (0.0, 0.5)  # its first and last node
    speed_scale: float = 1.0  # u_s [m/s] of u/(u + u_s)
    speed_ends: tuple[float, float] = (0.0, 0.5)  # its first and last node
    nodes: tuple[int, int, int] = _FIRST_NODES

    def speed(self, fraction: Array) -> Array:
        """Rolling speed at shares 0 to 1 of its nodes."""
        at = _between(self.speed_ends, fraction)
        return np.asarray(self.speed_scale * at / (1.0 - at))

    def force(self, fraction: Array) -> Array:
        """Force at them."""
        at = _between(self.root_ends, fraction)
        return np.asarray((self.root_scale * at / (1.0 - at)) ** 2)

    def sliding(self, fraction: Array) -> Array:
        """Sliding speed at them, from -1 to 1."""
        at = self.sliding_end * fraction
        return np.asarray(at * self.sliding_scale / (1.0 - np.abs(at)))


def _between(ends: tuple[float, float], fraction: Array) -> Array:
    low, high = ends
    return low + (high - low) * fraction


@attrs.frozen(eq=False, kw_only=True)
class FrictionTable(_Grid):
    """Conventional friction of a roller over force, sliding and rolling speed, as `compiled.with_table` takes it."""

    #: F/sqrt(Q) [N^0.5] and, if there is any, the same of the rolling resistance, over rolling speed, force and sliding
    #: speed.
    values: Array
    #: Largest error at random contacts: of traction relative to the largest friction coefficient times the force, or a
    #: light one, of rolling resistance relative to the largest [1].
    error: float

    def of(self, raceway: object) -> object:
        """Return a compiled conventional raceway with this table."""
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
        """Size and error by name, as results keep them."""
        speeds = [self.speed_scale * end / (1.0 - end) for end in self.speed_ends]
        return {"nodes": list(self.values.shape[1:]), "error": self.error, "rolling_speed": speeds}


@attrs.frozen(eq=False)
class RacewayFriction:
    """Friction of inner and outer raceway."""

    settings: FrictionSettings  # which friction it is
    capsules: tuple[object, object]  # of `rollslip_kernels.motion.raceway`
    slices: tuple[Slices, ...] = ()  # tables that conventional friction works in
    tables: tuple[EffectiveTable, ...] = ()  # what effective friction is taken from
    #: What conventional friction is taken from without tilt; none where it comes from the slices.
    by_force: tuple[FrictionTable, ...] = ()
    way: str = ""  # which way conventional friction is evaluated, in words

    @property
    def by_slices(self) -> bool:
        """Whether friction looks at the slices of a roller at every evaluation."""
        return self.settings.name == "conventional" and not self.by_force


def usual_force(assembly: Assembly) -> float:
    """Return a roller's share of the load, and its centrifugal force [N]; at least 0.1 N."""
    fraction = assembly.scene.operation.radial_load / assembly.scene.bearing.rollers
    return fraction + assembly.centrifugal_force + 0.1


def _forces(assembly: Assembly) -> tuple[float, float]:
    """Return the usual force of a roller, and the largest that tables of its friction serve [N]."""
    usual = usual_force(assembly)
    at_rest = assembly.load_distribution(1)
    heaviest = max(
        float((load @ assembly.widths).max()) for load in (at_rest.inner_load, at_rest.outer_load)
    )
    return usual, max(_HEAVY * heaviest, usual)


def tilts(assembly: Assembly) -> bool:
    """Return whether rollers or rings tilt: by the scene, or by a profile that differs to its two ends."""
    drop = assembly.drop
    return assembly.scene.operation.misalignment != 0.0 or not np.allclose(
        drop, drop[::-1], rtol=1e-9, atol=1e-15
    )


def raceway_friction(
    assembly: Assembly, settings: FrictionSettings, loads: LoadMap | None = None
) -> RacewayFriction:
    """Return the friction of both raceways."""
    rollers = assembly.scene.bearing.rollers
    if settings.name == "constant":
        inner, outer = (
            compiled.constant(rollers, settings.coefficient, settings.transition)
            for _ in assembly.raceways
        )
        return RacewayFriction(settings, (inner, outer))
    if settings.name == "conventional":
        slices = tuple(
            Slices(rollers * assembly.slices, raceway.conditions) for raceway in assembly.raceways
        )
        for table in slices if assembly.inner.chain.placed else ():
            table.places()  # which the motion fills
        inner, outer = (
            compiled.conventional(
                *(r.chain.kernel, table, rollers, assembly.widths, r.chain.resists),
                *(assembly.position, assembly.across(r.ring)),
            )
            for r, table in zip(assembly.raceways, slices, strict=True)
        )
        tables, way = _by_force(assembly, settings) if settings.tabulated else ((), _SLICED)
        if tables:
            inner, outer = (
                table.of(raceway) for table, raceway in zip(tables, (inner, outer), strict=True)
            )
        return RacewayFriction(settings, (inner, outer), slices=slices, by_force=tables, way=way)
    tolerance = settings.table_tolerance(assembly)
    if loads is None and assembly.rings is not None and assembly.rings.turning:  # in plane motion
        of = (
            assembly.slices,
            assembly.resolution.quadrature,
            *(raceway.deflection for raceway in assembly.raceways),
        )
        held = assembly.cached("loads over turns", of, partial(assembly.load_distribution, _TURNS))
        effective = tuple(
            _table(assembly, ring, load.reshape(-1, assembly.slices), held, settings)
            for ring, load in enumerate((held.inner_load, held.outer_load))
        )
    else:
        loads = build_load_map(assembly, tolerance) if loads is None else loads
        of_orbit = loads.loads(min(assembly.centrifugal_force, loads.top))
        effective = tuple(
            _table(assembly, ring, of_orbit[ring], loads.orbits, settings) for ring in (0, 1)
        )
    inner, outer = (table.raceway(rollers) for table in effective)
    return RacewayFriction(settings, (inner, outer), tables=effective)


def _table(
    assembly: Assembly, ring: int, load: Array, loads: object, settings: FrictionSettings
) -> EffectiveTable:
    """Return the effective friction of a ring at the epicyclic speed, made once for a bearing and its loads."""
    raceway = assembly.raceways[ring]
    of = (
        settings.table_tolerance(assembly),
        settings.effective_over == "slips",
        settings.between_nodes,
    )
    key = ring, loads, raceway.conditions, raceway.chain.models, raceway.chain.bounds, *of
    return assembly.cached(
        "effective friction", key, lambda: effective_table(assembly, raceway, load, *of)
    )


def _by_force(
    assembly: Assembly, settings: FrictionSettings
) -> tuple[tuple[FrictionTable, ...], str]:
    """Tables of both raceways, or none, and which way that is in words; made once for a bearing."""
    if tilts(assembly):
        return (
            (),
            f"{_SLICED}: rollers tilt, so that the loads along one do not follow from its force",
        )
    if assembly.slices < _FEW:
        return (), f"{_SLICED}: {assembly.slices} slices cost no more than a table of them"
    if assembly.inner.chain.placed:
        return (), f"{_SLICED}: a law reads where slices are"
    if any(raceway.chain.alone for raceway in assembly.raceways):
        return (), f"{_SLICED}: a law runs in Python, and may depend on more than a table knows"
    tolerance = settings.table_tolerance(assembly)
    tables = list[FrictionTable]()
    like = assembly if settings.like is None else settings.like
    forces = _forces(like)
    for raceway in assembly.raceways:
        key = (
            *(raceway.conditions, raceway.chain.models, raceway.chain.bounds, tolerance),
            *(assembly.drop.tobytes(), assembly.widths.tobytes(), *forces),
        )
        table = like.cached(
            "friction by force", key, partial(_friction_table, assembly, raceway, tolerance, forces)
        )
        if isinstance(table, str):
            return (), f"{_SLICED}: {table}"
        tables.append(table)
    most = max(table.error for table in tables)
    return tuple(
        tables
    ), f"from a table over force and both speeds, within {most:.1e} of it, at every step outside it"


def _friction_table(
    assembly: Assembly, raceway: Raceway, tolerance: float, forces: tuple[float, float]
) -> FrictionTable | str:
    """The table of a raceway, or why there is none."""
    law = _OfRoller(assembly, raceway)
    (usual, most) = forces
    speed = abs(float(assembly.kinematics.surface_speeds(0.0, 0.0).inner_rolling))
    if not speed > 0.0:
        return "nothing rolls at the epicyclic speed"
    root_scale = math.sqrt(usual)
    first = math.sqrt(_LEAST * usual)
    last = math.sqrt(most)
    roots = (first / (first + root_scale), last / (last + root_scale))
    slow, fast = _SPEEDS
    speeds = (slow / (slow + _SLOW), fast / (fast + _SLOW))
    nodes = [*_FIRST_NODES]
    values = None
    axis = 0
    least = math.inf
    vain = 0
    try:
        scale = law.scale((usual, last**2), speed)
        while True:
            of_speed, of_root, of_sliding = nodes
            at = _Grid(
                sliding_scale=scale,
                sliding_end=_REACH * speed / (_REACH * speed + scale),
                root_scale=root_scale,
                root_ends=roots,
                speed_scale=_SLOW * speed,
                speed_ends=speeds,
                nodes=(of_speed, of_root, of_sliding),
            )
            values = law.on(at, values, axis)
            if (error := law.error(at, values, usual)) <= tolerance:
                break
            least, vain = (error, 0) if error < _GAIN * least else (least, vain + 1)
            errors = [law.error(at, values, usual, axis) for axis in range(3)]
            axis = int(np.argmax(errors))
            nodes[axis] = 2 * nodes[axis] - (axis < 2)
            if nodes[0] * nodes[1] * (2 * nodes[2] + 1) > _MAX_NODES or vain == _VAIN:
                return (
                    f"a table of it on the {raceway.ring} ring would err by {error:.1e}, more than the {tolerance:.1e} "
                    "that tables may leave"
                )
    except (
        RollslipError
    ) as refused:  # where the motion need never go: if it does, that is told there
        return f"a law of the {raceway.ring} ring ends where a table of it would have to reach ({refused})"
    return FrictionTable(**attrs.asdict(at, recurse=False), values=values, error=error)


class _OfRoller:
    """What the chain of a raceway makes of a roller, by its force: F and the rolling resistance over sqrt(Q)."""

    def __init__(self, assembly: Assembly, raceway: Raceway) -> None:
        self.assembly = assembly
        self.raceway = raceway
        self.drop, self.at = np.unique(assembly.drop - assembly.drop.min(), return_inverse=True)
        self.widths = np.bincount(self.at, assembly.widths)
        self.gaps = np.geomspace(1e-12, 1e-3, 901)
        self.forces = self._loads(self.gaps) @ self.widths
        self.at_random: Array | None = None

    def _loads(self, gap: Array) -> Array:
        return self.assembly.deflect(gap[:, None] - self.drop, self.raceway.ring)[0]

    def loads(self, force: Array) -> Array:
        """Loads per length of the slices at forces [N], (m, n)."""
        force, place = np.unique(force, return_inverse=True)
        known = self.forces > 0.0
        gap = np.exp(np.interp(np.log(force), np.log(self.forces[known]), np.log(self.gaps[known])))
        for _ in range(
            3
        ):  # F goes nearly with the gap to the power of 10/9 and what the profile adds
            load, stiffness = self.assembly.deflect(gap[:, None] - self.drop, self.raceway.ring)
            found = load @ self.widths
            slope = stiffness @ self.widths
            gap = gap + (force - found) / slope
        return self._loads(gap)[place]

    def _each(self, load: Array, sliding: Array, rolling: Array) -> Array:
        """F and the rolling resistance over sqrt(Q), (1 or 2, m), of loads (m, n) at speeds (m,)."""
        loaded = load > 0.0
        count = np.count_nonzero(loaded, axis=1)  # every roller has some: its force is above zero
        film = np.hypot(rolling, compiled.REST_SPEED)
        done = self.raceway.evaluate(
            load[loaded], np.repeat(film, count), np.repeat(sliding, count)
        )
        widths = np.broadcast_to(self.widths, load.shape)[loaded]
        first = np.cumsum(count) - count
        parts = [done.friction * done.load] + (
            [done.resistance] if self.raceway.chain.resists else []
        )
        return np.array([np.add.reduceat(part * widths, first) for part in parts]) / np.sqrt(
            load @ self.widths
        )

    def scale(self, forces: tuple[float, ...], speed: float) -> float:
        """The speed V_s over which friction of usual and of heavy contacts, slow and fast, is best taken."""
        fraction = np.linspace(-1.0, 1.0, 2 * _RISE + 1)
        both = np.sort(np.concatenate((fraction, fraction[:-1] + 0.5 / _RISE)))
        contacts = [(force, factor) for force in forces for factor in _SPEEDS]
        loads = self.loads(np.array([force for force, _ in contacts])).repeat(both.size, axis=0)
        rolling = np.array([factor for _, factor in contacts]).repeat(both.size) * speed
        best = math.inf
        chosen = speed
        for scale in (_SCALES * speed).tolist():
            at = _Grid(sliding_scale=scale, sliding_end=_REACH * speed / (_REACH * speed + scale))
            sliding = np.tile(at.sliding(both), len(contacts))
            error = 0.0
            for values in self._each(loads, sliding, rolling)[0].reshape(len(contacts), -1):
                found = _interpolated(values[::2], [_places(both[1::2], _RISE)])
                error = max(error, float(np.abs(found - values[1::2]).max() / np.abs(values).max()))
            if error < best:
                best = error
                chosen = scale
        return chosen

    def on(self, at: _Grid, known: Array | None = None, axis: int = 0) -> Array:
        """Values on all nodes, (1 or 2, speeds, roots, slidings); every other one along an axis may be known."""
        speeds, roots, half = at.nodes
        fractions = [
            np.linspace(0.0, 1.0, speeds),
            np.linspace(0.0, 1.0, roots),
            np.linspace(-1.0, 1.0, 2 * half + 1),
        ]
        if known is not None:
            fractions[axis] = fractions[axis][1::2]
        V, u = (
            grid.ravel() for grid in np.meshgrid(at.sliding(fractions[2]), at.speed(fractions[0]))
        )
        rows = []
        for load in self.loads(at.force(fractions[1])):
            values = self._each(np.broadcast_to(load, (V.size, load.size)), V, u)
            rows.append(values.reshape(-1, fractions[0].size, fractions[2].size))
        values = np.stack(rows, axis=2)
        if known is None:
            return values
        between = np.moveaxis(np.empty((len(values), speeds, roots, 2 * half + 1)), axis + 1, 0)
        between[::2] = np.moveaxis(known, axis + 1, 0)
        between[1::2] = np.moveaxis(values, axis + 1, 0)
        return np.moveaxis(between, 0, axis + 1)

    def error(self, at: _Grid, values: Array, usual: float, axis: int | None = None) -> float:
        """Largest error at random contacts, or half-way between nodes of one axis and on nodes of the others."""
        fractions = np.random.default_rng(1).uniform(size=(3, _PROBES))
        fractions[2] = 2.0 * fractions[2] - 1.0
        if axis is not None:
            for k, nodes in enumerate(at.nodes):
                cells = nodes - (k < 2)
                off = 0.5 if k == axis else 0.0
                fractions[k] = (
                    np.clip(np.floor(fractions[k] * cells), -cells if k == 2 else 0, cells - 1)
                    + off
                ) / cells
        force = at.force(fractions[1])
        sliding = at.sliding(fractions[2])
        speed = at.speed(fractions[0])
        true = self.at_random if axis is None else None
        if true is None:
            true = self._each(self.loads(force), sliding, speed)
            self.at_random = (
                true if axis is None else self.at_random
            )  # the same contacts however many nodes there are
        places = [
            _whole(fractions[0], at.nodes[0]),
            _whole(fractions[1], at.nodes[1]),
            _places(fractions[2], at.nodes[2]),
        ]
        found = np.array([_interpolated(part, places) for part in values])
        wrong = np.abs(found - true) * np.sqrt(force)
        size = np.maximum(force, _LIGHT * usual)
        coefficient = np.abs(true[0]) * np.sqrt(force) / size
        errors = [wrong[0] / (float(coefficient.max()) * size)]
        if len(wrong) > 1:
            errors.append(wrong[1] / float((np.abs(true[1]) * np.sqrt(force)).max()))
        return float(np.max(errors))


def _whole(fraction: Array, nodes: int) -> tuple[Array, Array]:
    """First of the four nodes about a place, and the place from it on."""
    place = fraction * (nodes - 1)
    first = np.clip(np.floor(place).astype(int) - 1, 0, nodes - 4)
    return first, place - first


def _places(fraction: Array, half: int) -> tuple[Array, Array]:
    """The same over the sliding speed, where no four nodes reach across zero."""
    place = half * (fraction + 1.0)
    low = np.where(fraction >= 0.0, half, 0)
    first = np.clip(np.floor(place).astype(int) - 1, low, low + half - 3)
    return first, place - first


def _interpolated(values: Array, places: Sequence[tuple[Array, Array]]) -> Array:
    """Cubic between four nodes along every axis, as friction_table.h has it."""
    new = len(places) * (np.newaxis,)
    found = values[
        tuple(
            (first + np.arange(4)[:, np.newaxis])[(*new[:axis], slice(None), *new[axis + 1 :])]
            for axis, (first, _) in enumerate(places)
        )
    ]
    for _, t in places:
        weights = [
            np.prod([(t - k) / (node - k) for k in range(4) if k != node], axis=0)
            for node in range(4)
        ]
        found = np.einsum("nm,n...m->...m", weights, found)
    return np.asarray(found)
