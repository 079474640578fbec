"""Bearing, rollers and cage in plane motion: what the compiled system of `rollslip_kernels.motion.planar` is made of.

- The loads follow from the motion, by the deflection law of the contact model. So the clearance and the mass of the
  inner ring matter, and a map of loads does not exist.
- Along a history the systems read load and direction of the moment; tables reach as far as its largest load asks.
- Rollers do not tilt, so that the force of one follows from its gap alone: it is tabulated over the root of the gap,
  over which it is smooth but for a bend where each slice first touches. The error is that against all slices half-way
  between nodes. Deeper than the table goes, and where friction looks at slices, forces come from the slices.
- A profile that is the same to both ends tilts none, and anything else is refused.
- A land's film carries and drags at once: a drag that describes it in another way is left out, not added.
- Rings that yield and raceways out of round are those of `bent_rings`.
- The start is the equilibrium of the bearing at the cage speed it starts with, so that rollers are at rest along the
  radius but for what friction, gravity and m w^2 rho leave, which is small against the contact forces.
"""

import math
from collections.abc import Mapping
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.cage import Cage
from rollslip.bearing.equilibrium import angular_positions, solve_equilibrium
from rollslip.bearing.raceway import RINGS, Array, Raceway
from rollslip.errors import DomainError, RollslipError
from rollslip.fields import field, non_negative, positive
from rollslip.models import DragModel
from rollslip_kernels.motion.planar import LEDGER_UNITS, Planar
from rollslip_kernels.motion.system import System
from rollslip_kernels.slices import Slices
from rollslip_studies.dynamics.levels.bent_rings import BentRings, bent_rings, turned
from rollslip_studies.dynamics.levels.load_map import resistances
from rollslip_studies.dynamics.levels.moving_bearing import (
    MovingBearing,
    pocket_contact,
    ungoverned,
)
from rollslip_studies.dynamics.levels.raceway_friction import (
    DEEP,
    FrictionSettings,
    raceway_friction,
    usual_force,
)
from rollslip_studies.motion.effective_table import table_records

_SWING: Final = (
    30.0  # deflections by which the motion of rollers along the radius is measured, see _scale
)
_CELLS: Final = 64  # of the table of rolling resistance over sqrt(Q)
_PRESSED: Final = (
    2.0  # times the largest force at rest up to which tables of rings that yield reach, at least
)
#: Error of the table of forces, relative to a force or to this share of the usual one, and its first and most cells.
_FORCE_ERROR = 3e-5
_LIGHT = 1e-2
_FIRST_CELLS = 512
_MAX_CELLS = 65536
#: Approaches of a roller and a raceway [m] at which their force is evaluated to find that of a given force.
_APPROACHES: Final = np.geomspace(1e-9, 1e-3, 601)

#: Unknowns of the head, of each roller and of the ledger, in order -> their unit.
HEAD: Final = {
    "inner_ring_x": "m",
    "inner_ring_y": "m",
    "inner_ring_vx": "m/s",
    "inner_ring_vy": "m/s",
    "cage_x": "m",
    "cage_y": "m",
    "cage_vx": "m/s",
    "cage_vy": "m/s",
    "cage_speed": "rad/s",
    "cage_angle": "rad",
}
ROLLER: Final = {
    "pocket_position": "m",
    "orbital_speed": "rad/s",
    "roller_spin": "rad/s",
    "radial_position": "m",
    "radial_speed": "m/s",
}
LEDGER: Final = LEDGER_UNITS


@attrs.frozen(kw_only=True)
class PlanarSettings:
    """What plane motion needs beyond the bearing and its cage."""

    inner_ring_mass: float = field(
        unit="kg",
        doc="mass that moves with the inner ring: the ring and its share of the shaft",
        validator=positive,
        usual=(1e-3, 1e5),
        possible=(1e-9, 1e15),  # one that nothing moves too
    )
    contact_damping: float = field(
        default=0.3,
        unit="s/m",
        doc="damping c of rollers and rings, w(d) (1 + c dd/dt), d the approach; 0.1 to 0.5 for steel (C)",
        validator=non_negative,
        usual=(0, 20),
        possible=(0, 1e9),
    )
    gravity: float = field(
        default=9.80665,
        unit="m/s2",
        doc="gravity",
        validator=non_negative,
        usual=(0, 200),
        possible=(0, 1e6),
    )
    gravity_direction: float | None = field(
        default=None,
        unit="rad",
        doc="direction of gravity, from that of the radial load; by default operation.gravity_direction, or along it",
        usual=(-6.2832, 6.2832),
        possible=(-1e3, 1e3),
    )
    land_stiffness: float = field(
        default=1e8,
        unit="N/m",
        doc="stiffness of cage and land where they touch (D)",
        validator=positive,
        usual=(1e5, 1e10),
        possible=(1e-3, 1e15),
    )
    land_damping: float = field(
        default=0.3,
        unit="s/m",
        doc="damping of cage and land where they touch (D)",
        validator=non_negative,
        usual=(0, 20),
        possible=(0, 1e9),
    )
    land_friction: float = field(
        default=0.1,
        unit="1",
        doc="friction coefficient of cage and land where they touch (D)",
        validator=non_negative,
    )


@attrs.frozen(eq=False, kw_only=True)
class ForceTable:
    """Force of a roller on a raceway by its gap, the approach from first touch on: cubic on cells equal in its root."""

    deepest: float  # largest gap [m]
    coefficients: Array  # (cells, 4): of the powers of the place in a cell, 0 to 1 [N]
    #: Largest error against all slices, half-way between nodes, relative to the force or to a light one [1].
    error: float
    #: Force below which the error is relative to it: a hundredth of a roller's share of load and centrifugal force [N].
    light: float

    @property
    def record(self) -> dict[str, float]:
        """Size and error by name, as results keep them."""
        return {
            "cells": len(self.coefficients),
            "deepest": self.deepest,
            "error": self.error,
            "light": self.light,
        }


@attrs.frozen(eq=False, kw_only=True)
class PlanarMotion(MovingBearing):
    """The plane motion of a bearing."""

    settings: PlanarSettings  # masses, damping and gravity
    contacts: tuple[
        Slices, ...
    ]  # tables of inner and outer raceway that the deflection law works in
    planar: Planar  # the compiled system; ``deflections_evaluated`` counts
    #: Forces of a roller on both raceways by its gap; none where they come from the slices.
    forces: tuple[ForceTable, ...] = ()
    bent: BentRings | None = None  # rings that are not rigid and round

    @property
    def tables(self) -> dict[str, str]:
        """Attributes of a result that say how right the tables are that the motion rests on."""
        return {**super().tables, **table_records(self.forces, "force_tables")}

    @property
    def way(self) -> str:
        """How friction is evaluated, and where the forces of rollers come from, in words."""
        if not self.forces:
            return f"{super().way}; forces of rollers from every slice"
        cells = max(len(t.coefficients) for t in self.forces)
        most = max(table.error for table in self.forces)
        deepest = 1e6 * min(table.deepest for table in self.forces)
        return (
            f"{super().way}; forces of rollers from a table of {cells} cells over the root of the gap, within "
            f"{most:.1e} of every slice, and from the slices at gaps above {deepest:.2g} um"
        )

    @property
    def names(self) -> tuple[Mapping[str, str], Mapping[str, str], Mapping[str, str]]:
        """Unknowns of the head, of each roller and of the ledger, in order -> their unit."""
        return HEAD if self.bent is None else {**HEAD, **self.bent.names}, ROLLER, LEDGER

    def initial(self, cage_slip: float = 0.0, roller_slip: float = 0.0) -> Array:
        """Return the state at t = 0: equilibrium at these slips, cage centred, rollers in mid-pocket."""
        speeds = self.assembly.kinematics.surface_speeds(cage_slip, roller_slip)
        load = self.assembly.scene.operation.radial_load
        return self.state_at(float(speeds.cage_speed), float(speeds.roller_speed), load)

    def state_at(
        self, cage_speed: float, roller_speed: float, load: float, direction: float = 0.0
    ) -> Array:
        """Return the state with these speeds [rad/s] in equilibrium under a load, as `initial` does."""
        k = self.assembly.kinematics
        b = self.assembly.scene.bearing
        # the load and the weight of the ring together pull along one line
        weight = self.settings.inner_ring_mass * self.settings.gravity
        down = self.settings.gravity_direction or 0.0
        x = load * math.cos(direction) + weight * math.cos(down)
        y = load * math.sin(direction) + weight * math.sin(down) * k.direction
        line = math.atan2(y, x)
        psi = angular_positions(b.rollers, 1)
        force = self.assembly.roller_mass * k.orbit_radius * (cage_speed * cage_speed)
        case = attrs.evolve(
            self.assembly.load_case(1, force),
            psi=psi - line,
            radial_load=math.hypot(x, y),
            rings=None if self.bent is None else turned(self.bent.rings, line),
            body_force=(0.0, 0.0),
        )
        held = solve_equilibrium(case, self.assembly.raceways)
        state = np.zeros(self.system.n)
        head, rollers, _ = self.parts(state)
        along, across = held.displacement[0]
        head[:2] = (
            along * math.cos(line) - across * math.sin(line),
            along * math.sin(line) + across * math.cos(line),
        )
        head[8] = cage_speed
        rollers[:, 1] = cage_speed
        rollers[:, 2] = roller_speed - cage_speed
        rollers[:, 3] = held.roller_shift[0]
        if self.bent is not None:
            shapes = held.deflection.shape[1]
            head[len(HEAD) : len(HEAD) + shapes] = held.deflection[0]
            rollers[:, 3] += self.bent.shift(psi[0], held.deflection[0])
        return state

    def energy(self, y: Array) -> Array:
        """Return the kinetic energy [J], (...), and what rings that yield store.

        What contacts store is the elastic work of the ledger, negative.
        """
        u = self.split(y)
        m = self.assembly.roller_mass
        inertia = self.spin_inertia
        cage = self.assembly.cage
        radius = self.assembly.kinematics.orbit_radius + u["radial_position"]
        moving = (
            m * (u["radial_speed"] ** 2 + (radius * u["orbital_speed"]) ** 2)
            + inertia * u["roller_spin"] ** 2
        )
        ring = self.settings.inner_ring_mass * (u["inner_ring_vx"] ** 2 + u["inner_ring_vy"] ** 2)
        held = (
            cage.mass * (u["cage_vx"] ** 2 + u["cage_vy"] ** 2)
            + cage.inertia * u["cage_speed"] ** 2
        )
        across = u["cage_vy"] * np.cos(u["cage_angle"]) - u["cage_vx"] * np.sin(u["cage_angle"])
        found = (
            0.5 * (moving.sum(axis=-1) + ring + held) + cage.unbalance * u["cage_speed"] * across
        )
        if self.bent is not None:
            shapes = self.parts(y)[0][..., len(HEAD) : len(HEAD) + 2 * self.bent.shapes]
            found = found + self.bent.energy(*np.split(shapes, 2, axis=-1))
        return np.asarray(found)

    def angular_momentum(self, y: Array) -> Array:
        """Return the angular momentum about the axis of the outer ring [N m s], (...)."""
        u = self.split(y)
        cage = self.assembly.cage
        w = u["cage_speed"]
        radius = self.assembly.kinematics.orbit_radius + u["radial_position"]
        moving = (
            self.assembly.roller_mass * radius**2 * u["orbital_speed"]
            - self.spin_inertia * u["roller_spin"]
        )
        ring = u["inner_ring_x"] * u["inner_ring_vy"] - u["inner_ring_y"] * u["inner_ring_vx"]
        held = (
            cage.mass * (u["cage_x"] * u["cage_vy"] - u["cage_y"] * u["cage_vx"]) + cage.inertia * w
        )
        c = np.cos(u["cage_angle"])
        s = np.sin(u["cage_angle"])
        swing = c * u["cage_vy"] - s * u["cage_vx"] + w * (u["cage_x"] * c + u["cage_y"] * s)
        return np.asarray(
            moving.sum(axis=-1)
            + self.settings.inner_ring_mass * ring
            + held
            + cage.unbalance * swing
        )

    def error(self, refusal: Any) -> RollslipError:
        """Return the error that says in words what was refused: the ``reason`` of a ``RefusedError``."""
        who, what = refusal
        if who in ("inner ring", "cage", "shape of a ring"):
            return DomainError(
                f"the {who} is displaced by {what[0]:.3g} m, beyond what small displacements describe (a tenth of the "
                f"roller's radius, {what[1]:.3g} m); check what holds it: load, clearances and stiffnesses"
            )
        ring, _, deflection = who.partition(" ")
        if not deflection:
            return super().error(refusal)
        at = RINGS.index(ring)
        error = self.assembly.raceways[at].deflection.error(what, self.contacts[at])
        error.add_note(f"in a contact with the {ring} ring")
        return error


def planar_motion(
    assembly: Assembly,
    settings: PlanarSettings,
    friction: FrictionSettings,
    top_speeds: tuple[float, float] | None = None,
    *,
    each: bool = False,
) -> PlanarMotion:
    """Build the plane motion of a bearing whose scene has a cage.

    Parameters
    ----------
    assembly : Assembly
        The bearing. A drag of its cage that describes the film of the land is left out: the land itself is here.
    settings : PlanarSettings
        Masses, damping and gravity.
    friction : FrictionSettings
        Which friction, what is watched, and whether forces may come from a table.
    top_speeds : tuple of two floats, optional
        Largest speeds of inner and outer ring [rad/s], if they are not those of the scene.
    each : bool
        Whether `MovingBearing.of_each` is known.

    Raises
    ------
    SceneError
        If the cage is wrong.
    DomainError
        If the scene tilts rollers or rings, or has rings of which plane motion knows nothing.
    ConvergenceError
        If tables do not reach the tolerance.
    """
    a = assembly.with_resistance()
    k = a.kinematics
    b = a.scene.bearing
    o = a.scene.operation
    cage = a.cage
    if o.misalignment != 0.0:
        raise DomainError(
            f"plane motion knows no tilt, and operation.misalignment is {o.misalignment:g} rad; make it 0 or choose "
            "level 'pocket'"
        )
    bent = bent_rings(a, top_speeds)
    if not np.allclose(a.drop, a.drop[::-1], rtol=1e-9, atol=1e-15):
        raise DomainError(
            "plane motion knows no tilt, and a roller whose profile differs to its two ends tilts; "
            "make bearing.profile the same to both, or choose level 'pocket'"
        )
    of_raceways = raceway_friction(a, friction)
    contacts = tuple(Slices(b.rollers * a.slices, raceway.conditions) for raceway in a.raceways)
    direction = k.direction
    down = settings.gravity_direction
    down = (o.gravity_direction or 0.0) if down is None else down
    settings = attrs.evolve(settings, gravity_direction=down)
    oil = a.lubricant.at(o.temperature).viscosity
    roughness = a.inner.conditions.roughness
    guidance = ("roller", "inner", "outer").index(cage.guidance)
    torques = zip(cage.drags.torques, cage.drags.capsules(), strict=True)
    heaviest = a if friction.like is None else friction.like
    most = DEEP * usual_force(heaviest)
    if (
        bent is not None
    ):  # forms and what pushes on rings press rollers far beyond their share of the load
        most = max(most, _PRESSED * float(heaviest.load_distribution(1).outer_force.max()))
    forces = _force_tables(a, most) if friction.tabulated and not of_raceways.by_slices else ()
    planar = Planar(
        of_raceways.capsules,
        [raceway.deflection.kernel for raceway in a.raceways],
        contacts,
        a.drop,
        a.widths,
        [capsule for model, capsule in torques if not (guidance and _of_land(model))],
        b.rollers,
        guidance,
        np.append(_scale(heaviest, cage, bent), ungoverned(a, each)),
        each=each,
        forces=[(table.deepest, table.coefficients) for table in forces],
        resistances=None if friction.name == "conventional" else _resistances(a, most),
        rings=None if bent is None else bent.given,
        critical_slip=friction.critical_slip,
        film_limit=friction.watched_film,
        inner_radius=k.inner_radius,
        outer_radius=k.outer_radius,
        roller_radius=k.roller_radius,
        orbit_radius=k.orbit_radius,
        half_clearance=b.radial_clearance / 2,
        inner_speed=direction * k.inner_speed,
        outer_speed=direction * k.outer_speed,
        roller_mass=a.roller_mass,
        roller_inertia=a.roller_mass * k.roller_radius**2 / 2,
        ring_mass=settings.inner_ring_mass,
        cage_mass=cage.mass,
        cage_inertia=cage.inertia,
        unbalance=cage.unbalance,
        gravity_x=settings.gravity * math.cos(down),
        gravity_y=settings.gravity * math.sin(down) * direction,
        damping=settings.contact_damping,
        load=o.radial_load,
        direction=direction,
        epicyclic_speed=k.epicyclic_cage_speed,
        pocket_radial_half_clearance=math.inf
        if cage.pocket_radial_clearance is None
        else cage.pocket_radial_clearance / 2,
        **{f"pocket_{name}": value for name, value in pocket_contact(a).items()},
        **_land(cage, settings, oil, roughness),
    )
    return PlanarMotion(
        assembly=a,
        settings=settings,
        friction=of_raceways,
        contacts=contacts,
        planar=planar,
        system=System(planar.system(_swing_frequency(heaviest, settings, bent))),
        forces=forces,
        bent=bent,
    )


def _of_land(model: DragModel) -> bool:
    """A drag that takes the clearance of the land describes its film."""
    return any(f.metadata.get("from_scene") == "land_clearance" for f in attrs.fields(type(model)))  # type: ignore[arg-type]


def _land(cage: Cage, settings: PlanarSettings, oil: float, roughness: float) -> dict[str, float]:
    """The land: R eta L^3/c^3 against squeeze, 2 pi eta L R^3/c against shear, its film no thinner than roughness."""
    # without a land these are not used
    radius, width, clearance = (
        x or 1.0 for x in (cage.land_radius, cage.land_width, cage.land_clearance)
    )
    return {
        "land_radius": radius,
        "land_clearance": clearance,
        "land_film": radius * oil * (width / clearance) ** 3,
        "land_shear": 2 * math.pi * oil * width * radius**3 / clearance,
        "land_floor": min(roughness / clearance, 0.5),
        "land_stiffness": settings.land_stiffness,
        "land_damping": settings.land_damping,
        "land_friction": settings.land_friction,
    }


def _force_tables(a: Assembly, most: float) -> tuple[ForceTable, ...]:
    """Tables of both raceways, or none: a law in Python may depend on more than the gap."""
    if any(raceway.deflection.alone for raceway in a.raceways):
        return ()
    tables = [force_table(a, raceway, most) for raceway in a.raceways]
    return tuple(table for table in tables if table is not None) if None not in tables else ()


def force_table(a: Assembly, raceway: Raceway, most: float) -> ForceTable | None:
    """Return the force of a roller by its gap, up to a force; made once for a bearing.

    Cells are halved until the force half-way between nodes is right to 3e-5 of it or of a light one; None if that takes
    more than 65536.
    """
    key = most, raceway.conditions, raceway.deflection.models, a.drop.tobytes(), a.widths.tobytes()
    return a.cached("force by gap", key, lambda: _force_table(a, raceway, most))


def _force_table(a: Assembly, raceway: Raceway, most: float) -> ForceTable | None:
    drop = a.drop - a.drop.min()
    light = _LIGHT * most / DEEP

    def forces(root: Array) -> Array:
        """Force and its derivative by the root of the gap, (2, m)."""
        load, stiffness = a.deflect((root**2)[:, None] - drop, raceway.ring)
        return np.stack((load @ a.widths, stiffness @ a.widths * 2.0 * root))

    beyond = int(np.searchsorted(forces(np.sqrt(_APPROACHES))[0], most))
    deepest = float(_APPROACHES[min(beyond, _APPROACHES.size - 1)])
    cells = _FIRST_CELLS
    root = np.linspace(0.0, math.sqrt(deepest), cells + 1)
    known = forces(root)
    while True:
        step = root[1]
        half_way = forces(root[:-1] + 0.5 * step)
        (force, after), (slope, ahead) = (
            (row[:-1], row[1:]) for row in (known[0], known[1] * step)
        )
        wrong = 0.5 * (force + after) + 0.125 * (slope - ahead) - half_way[0]
        error = float((np.abs(wrong) / np.maximum(half_way[0], light)).max())
        if error <= _FORCE_ERROR:
            break
        if 2 * cells > _MAX_CELLS:  # a profile or law with a jump
            return None
        both = np.empty((2, 2 * cells + 1))
        both[:, ::2] = known
        both[:, 1::2] = half_way
        cells = 2 * cells
        known = both
        root = np.linspace(0.0, math.sqrt(deepest), cells + 1)
    rise = after - force
    powers = np.stack(
        (force, slope, 3.0 * rise - 2.0 * slope - ahead, slope + ahead - 2.0 * rise), axis=1
    )
    return ForceTable(deepest=deepest, coefficients=powers, error=error, light=light)


def _resistances(a: Assembly, most: float) -> list[tuple[float, Array]] | None:
    """Rolling resistance of a contact at epicyclic speed, at equal steps of sqrt(Q), by which it is nearly linear."""
    return (
        [_resistance(a, raceway, most) for raceway in a.raceways] if a.inner.chain.resists else None
    )


def _resistance(a: Assembly, raceway: Raceway, most: float) -> tuple[float, Array]:
    load, _ = a.deflect(_APPROACHES[:, None] - (a.drop - a.drop.min()), raceway.ring)
    force = load @ a.widths
    load = load[force <= most]
    force = force[force <= most]
    rolling = float(a.kinematics.surface_speeds(0.0, 0.0).inner_rolling)
    root = np.linspace(0.0, math.sqrt(force[-1]), _CELLS + 1)
    known = np.concatenate(([0.0], resistances(raceway, load, a.widths, rolling)))
    return float(root[1]), np.interp(root, np.concatenate(([0.0], np.sqrt(force))), known)


def _swing_frequency(a: Assembly, settings: PlanarSettings, bent: BentRings | None) -> float:
    """Angular frequency of a roller between the rings [rad/s], at most: with the whole load on one.

    Its square is the stiffness of both contacts over the roller's mass, and that of half as many contacts as there are
    rollers over the mass of the inner ring, which swings against them. The stiffness rises but slowly with the load.
    """
    weight = settings.inner_ring_mass * settings.gravity
    most = a.scene.operation.radial_load + weight + a.centrifugal_force
    stiffness = []
    for ring in RINGS:
        load, slope = a.deflect(_APPROACHES[:, None] - (a.drop - a.drop.min()), ring)
        stiffness.append(float(np.interp(most, load @ a.widths, slope @ a.widths)))
    inner, outer = stiffness
    others = 0.5 * a.scene.bearing.rollers * inner / settings.inner_ring_mass
    if bent is not None:
        others += bent.square_frequency((inner, outer), a.scene.bearing.rollers)
    return math.sqrt((inner + outer) / a.roller_mass + others)


def _scale(a: Assembly, cage: Cage, bent: BentRings | None) -> Array:
    """Typical magnitudes: deflections, what they are passed through in, the epicyclic speeds and their energies.

    Between its raceways a roller swings at some 20 kHz, hardly damped, by little: held to a tolerance of its own
    deflection that would set the step of all else. With `_SWING` of it there are 1.6 to 1.9 times fewer steps, and
    speeds and places of cage, rollers and pockets have the same error. Normal forces err by 0.4 to 1.6 per mille of
    the largest at a tolerance of 1e-5, where it was 0.03 to 0.7 (18 runs of the 1032930, 5 ms with all guidances,
    against a tolerance of 1e-10).
    """
    b = a.scene.bearing
    k = a.kinematics
    force = max(a.scene.operation.radial_load / b.rollers, a.centrifugal_force, 1.0)
    samples = np.geomspace(1e-9, 1e-3, 121)
    length = float(np.interp(force / b.roller_length, a.deflect(samples, "outer")[0], samples))
    speed = length * math.sqrt(force / (length * a.roller_mass))
    orbit = max(abs(k.epicyclic_cage_speed), 1.0)
    spin = k.epicyclic_roller_speed
    play = max(cage.pocket_clearance / 2, length)
    head = [length, length, speed, speed, play, play, speed, speed, orbit, 1.0]
    roller = [play, orbit, spin, _SWING * length, _SWING * speed]
    energy = 0.5 * (cage.inertia + b.rollers * a.roller_mass * k.orbit_radius**2) * orbit**2
    ledger = [energy if unit == "J" else 2.0 * energy / orbit for unit in LEDGER.values()]
    of_rings = {"m": _SWING * length, "m/s": _SWING * speed, "rad": 1.0}
    head += [of_rings[unit] for unit in ({} if bent is None else bent.names).values()]
    return np.array([*head, *roller * b.rollers, *ledger])
