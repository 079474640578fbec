"""Bearing, rollers and cage in plane motion: parameters and tables of the compiled `rollslip_kernels.motion.planar`.

- The loads follow from the motion, by the deflection law of the contact model. So the clearance and the mass of the
  inner ring matter, and there is no load map.
- Along a history the systems read the current load and its direction; tables reach as far as its largest load requires.
- Rollers do not tilt, so that the force of a roller follows from its gap alone. It is tabulated over the root of the
  gap, over which it is smooth except for a kink where each slice first touches. The error is measured against all
  slices half-way between nodes. Beyond the table, and where friction evaluates slices, forces come from the slices.
- A symmetric profile does not tilt rollers; any other one is refused.
- The film of a land carries and drags at once. A drag law that describes this film is omitted, so that it does not
  count twice.
- Flexible rings and raceways out of round are those of `bent_rings`.
- The start is the equilibrium of the bearing at the initial cage speed, so that rollers have no radial acceleration
  except for friction, gravity and m w^2 rho, which are small against the contact forces.
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
from rollslip_studies.dynamics.levels.bent_rings import BentRings, bent_rings, rotated
from rollslip_studies.dynamics.levels.load_map import resistances
from rollslip_studies.dynamics.levels.moving_bearing import (
    MovingBearing,
    pocket_contact,
    uncontrolled_scale,
)
from rollslip_studies.dynamics.levels.raceway_friction import (
    DEFLECTION_FORCE_FACTOR,
    FrictionSettings,
    raceway_friction,
    usual_force,
)
from rollslip_studies.motion.effective_table import table_records

#: Factor from the typical deflection of a contact to the typical magnitude of radial motion of rollers, to which their
#: tolerances, and those of the shapes of rings, are relative. With 1 there are 1.6 to 1.9 times as many steps; see
#: `_scale` for the measurement.
_SWING_FACTOR: Final = 30.0
#: Number of cells of the table of rolling resistance over sqrt(Q), over which it is nearly linear. With half as many
#: the error of interpolation is four times as large. Chosen.
_RESISTANCE_CELLS: Final = 64
#: Largest force of tables of flexible rings, relative to the largest force at rest. Beyond it forces come from the
#: slices. Chosen: a margin for the motion.
_REST_FORCE_FACTOR: Final = 2.0
#: Error of the table of forces, relative to a force or to a light one. Sixteen times as much halves the cells, since
#: the error is of fourth order away from kinks. Chosen: forces are better known than the deflection law that gives
#: them.
_FORCE_ERROR = 3e-5
#: Lower bound of the force that this error is relative to, over the usual force of a roller. Halved, the cells beside
#: first contact, where a force rises from zero, decide their number. Chosen.
_LIGHT_FORCE = 1e-2
#: Number of cells of a table of forces at first; it is doubled until the error is small. Chosen; doubled, a table that
#: needs no more takes twice the time.
_FIRST_CELLS = 512
#: Maximum number of cells of a table of forces: 2 MB. More are needed only where a law or profile has a jump; doubled,
#: it takes twice as long until forces come from the slices instead.
_MAX_CELLS = 65536
#: Approaches of a roller and a raceway [m] at which their force is evaluated to find that of a given force, a hundred a
#: decade. Between two of them a power p = 10/9 is interpolated to p (p - 1) h^2/8 = 8e-6 with h = ln(10)/100; half as
#: many err by four times as much, twice as many by a quarter. Chosen: any contact is between 1 nm and 1 mm.
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
#: What guides a cage, in the numbers of the compiled system.
_GUIDANCES: Final = ("roller", "inner", "outer")


@attrs.frozen(kw_only=True)
class PlanarSettings:
    """Parameters of plane motion in addition to those of the bearing and its cage."""

    inner_ring_mass: float = field(
        unit="kg",
        doc="mass that moves with the inner ring: the ring and its part of the shaft",
        validator=positive,
        usual=(1e-3, 1e5),
        possible=(1e-9, 1e15),  # up to a ring that practically does not move
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
    """Force of a roller on a raceway over its gap, the approach since contact: cubic on equal cells of its root."""

    deepest: float  # largest gap [m]
    coefficients: Array  # (cells, 4): coefficients of the powers of the fraction of a cell [N]
    #: Largest error against all slices half-way between nodes, relative to the force or to a light force [1].
    error: float
    light: float  # lower bound of the force that the error is relative to [N]

    @property
    def record(self) -> dict[str, float]:
        """Size and error by name, as results store them."""
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
    contacts: tuple[Slices, ...]  # work arrays of the deflection law, of inner and outer raceway
    planar: Planar  # the compiled system; it counts ``deflections_evaluated``
    #: Tables of the forces of a roller on both raceways; none where they come from the slices.
    forces: tuple[ForceTable, ...] = ()
    #: Flexible rings and forms; None if both rings are rigid and round.
    bent: BentRings | None = None

    @property
    def tables(self) -> dict[str, str]:
        """Attributes of a result with sizes and errors of the tables that the motion uses."""
        return {**super().tables, **table_records(self.forces, "force_tables")}

    @property
    def evaluation_method(self) -> str:
        """How friction is evaluated, and how the forces of rollers are, in words."""
        of_friction = super().evaluation_method
        if not self.forces:
            return f"{of_friction}; forces of rollers from every slice"
        cells = max(len(table.coefficients) for table in self.forces)
        error = max(table.error for table in self.forces)
        deepest = 1e6 * min(table.deepest for table in self.forces)
        return (
            f"{of_friction}; forces of rollers from a table of {cells} cells over the root of the gap, within "
            f"{error:.1e} of every slice, and from the slices at gaps above {deepest:.2g} um"
        )

    @property
    def names(self) -> tuple[Mapping[str, str], Mapping[str, str], Mapping[str, str]]:
        """Unknowns of the head, of each roller and of the ledger, in order -> their unit."""
        return HEAD if self.bent is None else {**HEAD, **self.bent.names}, ROLLER, LEDGER

    def initial(self, cage_slip: float = 0.0, roller_slip: float = 0.0) -> Array:
        """Return the state at t = 0: equilibrium at these slips, cage centred, rollers in the middle of the pockets."""
        speeds = self.assembly.kinematics.surface_speeds(cage_slip, roller_slip)
        return self.state_at(
            float(speeds.cage_speed),
            float(speeds.roller_speed),
            self.assembly.scene.operation.radial_load,
        )

    def state_at(
        self, cage_speed: float, roller_speed: float, load: float, direction: float = 0.0
    ) -> Array:
        """Return the state with these speeds [rad/s] in equilibrium under a load [N] in a direction [rad]."""
        k = self.assembly.kinematics
        # the load and the weight of the ring together pull along one line
        weight = self.settings.inner_ring_mass * self.settings.gravity
        down = self.settings.gravity_direction or 0.0
        x = load * math.cos(direction) + weight * math.cos(down)
        y = load * math.sin(direction) + weight * math.sin(down) * k.direction
        line = math.atan2(y, x)
        psi = angular_positions(self.assembly.scene.bearing.rollers, 1)
        force = self.assembly.roller_mass * k.orbit_radius * (cage_speed * cage_speed)
        case = attrs.evolve(
            self.assembly.load_case(1, force),
            psi=psi - line,
            radial_load=math.hypot(x, y),
            rings=None if self.bent is None else rotated(self.bent.rings, line),
            body_force=(0.0, 0.0),
        )
        equilibrium = solve_equilibrium(case, self.assembly.raceways)
        state = np.zeros(self.system.n)
        head, rollers, _ = self.parts(state)
        along, across = equilibrium.displacement[0]
        head[:2] = (
            along * math.cos(line) - across * math.sin(line),
            along * math.sin(line) + across * math.cos(line),
        )
        head[8] = cage_speed
        rollers[:, 1] = cage_speed
        rollers[:, 2] = roller_speed - cage_speed
        rollers[:, 3] = equilibrium.roller_shift[0]
        if self.bent is not None:
            deflection = equilibrium.deflection[0]
            head[len(HEAD) : len(HEAD) + deflection.size] = deflection
            rollers[:, 3] += self.bent.shift(psi[0], deflection)
        return state

    def energy(self, y: Array) -> Array:
        """Return the kinetic energy plus the elastic energy of flexible rings [J], (...).

        The elastic energy of contacts is the elastic work of the ledger with the opposite sign.
        """
        u = self.split(y)
        cage = self.assembly.cage
        radius = self.assembly.kinematics.orbit_radius + u["radial_position"]
        of_rollers = (
            self.assembly.roller_mass
            * (u["radial_speed"] ** 2 + (radius * u["orbital_speed"]) ** 2)
            + self.spin_inertia * u["roller_spin"] ** 2
        )
        ring = self.settings.inner_ring_mass * (u["inner_ring_vx"] ** 2 + u["inner_ring_vy"] ** 2)
        of_cage = (
            cage.mass * (u["cage_vx"] ** 2 + u["cage_vy"] ** 2)
            + cage.inertia * u["cage_speed"] ** 2
        )
        across = u["cage_vy"] * np.cos(u["cage_angle"]) - u["cage_vx"] * np.sin(u["cage_angle"])
        energy = (
            0.5 * (of_rollers.sum(axis=-1) + ring + of_cage)
            + cage.unbalance * u["cage_speed"] * across
        )
        if self.bent is not None:
            shapes = self.parts(y)[0][..., len(HEAD) : len(HEAD) + 2 * self.bent.shapes]
            energy = energy + self.bent.energy(*np.split(shapes, 2, axis=-1))
        return np.asarray(energy)

    def angular_momentum(self, y: Array) -> Array:
        """Return the angular momentum about the axis of the outer ring [N m s], (...)."""
        u = self.split(y)
        cage = self.assembly.cage
        w = u["cage_speed"]
        radius = self.assembly.kinematics.orbit_radius + u["radial_position"]
        of_rollers = (
            self.assembly.roller_mass * radius**2 * u["orbital_speed"]
            - self.spin_inertia * u["roller_spin"]
        )
        c = np.cos(u["cage_angle"])
        s = np.sin(u["cage_angle"])
        return np.asarray(
            of_rollers.sum(axis=-1)
            + self.settings.inner_ring_mass
            * (u["inner_ring_x"] * u["inner_ring_vy"] - u["inner_ring_y"] * u["inner_ring_vx"])
            + (
                cage.mass * (u["cage_x"] * u["cage_vy"] - u["cage_y"] * u["cage_vx"])
                + cage.inertia * w
            )
            + cage.unbalance
            * (c * u["cage_vy"] - s * u["cage_vx"] + w * (u["cage_x"] * c + u["cage_y"] * s))
        )

    def error(self, refusal: Any) -> RollslipError:
        """Return the error for the ``reason`` of a ``RefusedError``: the refusing part and the value it refused."""
        part, value = refusal
        if part in ("inner ring", "cage", "shape of a ring"):
            return DomainError(
                f"the {part} is displaced by {value[0]:.3g} m, beyond what small displacements describe (a tenth of "
                f"the roller's radius, {value[1]:.3g} m); check what holds it: load, clearances and stiffnesses"
            )
        ring, _, deflection = part.partition(" ")
        if not deflection:
            return super().error(refusal)
        number = RINGS.index(ring)
        error = self.assembly.raceways[number].deflection.error(value, self.contacts[number])
        error.add_note(f"in a contact with the {ring} ring")
        return error


def planar_motion(
    assembly: Assembly,
    settings: PlanarSettings,
    friction: FrictionSettings,
    top_speeds: tuple[float, float] | None = None,
    *,
    per_roller: bool = False,
) -> PlanarMotion:
    """Build the plane motion of a bearing whose scene has a cage.

    Parameters
    ----------
    assembly : Assembly
        The bearing. A drag of its cage that describes the film of the land is omitted: the motion has the land itself.
    settings : PlanarSettings
        Masses, damping and gravity.
    friction : FrictionSettings
        Friction of the raceways, the values that are watched, and whether forces may come from a table.
    top_speeds : tuple of two floats, optional
        Largest speeds of inner and outer ring [rad/s]; by default those of the scene.
    per_roller : bool
        Whether `MovingBearing.sliding_work_and_distance` is integrated.

    Raises
    ------
    SceneError
        If the cage is wrong.
    DomainError
        If the scene tilts rollers or rings, or has rings that plane motion does not describe.
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
    gravity_direction = settings.gravity_direction
    if gravity_direction is None:
        gravity_direction = o.gravity_direction or 0.0
        settings = attrs.evolve(settings, gravity_direction=gravity_direction)
    fully_loaded = a if friction.fully_loaded is None else friction.fully_loaded
    largest_force = _largest_force(fully_loaded, bent)
    forces: tuple[ForceTable, ...] = ()
    if friction.tabulated and not of_raceways.uses_slices:
        forces = _force_tables(a, largest_force)
    planar = Planar(
        of_raceways.capsules,
        [raceway.deflection.kernel for raceway in a.raceways],
        contacts,
        a.drop,
        a.widths,
        _drag_capsules(cage),
        b.rollers,
        np.append(_scale(fully_loaded, cage, bent), uncontrolled_scale(a, per_roller)),
        each=per_roller,
        forces=[(table.deepest, table.coefficients) for table in forces],
        resistances=None if friction.name == "conventional" else _resistances(a, largest_force),
        rings=None if bent is None else bent.system_arguments,
        critical_slip=friction.critical_slip,
        film_limit=friction.watched_film,
        inner_radius=k.inner_radius,
        outer_radius=k.outer_radius,
        roller_radius=k.roller_radius,
        orbit_radius=k.orbit_radius,
        half_clearance=a.carrying_clearance / 2,
        inner_speed=direction * k.inner_speed,
        outer_speed=direction * k.outer_speed,
        roller_mass=a.roller_mass,
        roller_inertia=a.roller_mass * k.roller_radius**2 / 2,
        ring_mass=settings.inner_ring_mass,
        cage_mass=cage.mass,
        cage_inertia=cage.inertia,
        unbalance=cage.unbalance,
        gravity_x=settings.gravity * math.cos(gravity_direction),
        gravity_y=settings.gravity * math.sin(gravity_direction) * direction,
        damping=settings.contact_damping,
        load=o.radial_load,
        direction=direction,
        epicyclic_speed=k.epicyclic_cage_speed,
        radial_play=math.inf
        if cage.pocket_radial_clearance is None
        else cage.pocket_radial_clearance / 2,
        pocket=pocket_contact(a),
        land=_land(a, settings),
    )
    return PlanarMotion(
        assembly=a,
        settings=settings,
        friction=of_raceways,
        contacts=contacts,
        planar=planar,
        system=System(planar.system(_swing_frequency(fully_loaded, settings, bent))),
        forces=forces,
        bent=bent,
    )


def _largest_force(a: Assembly, bent: BentRings | None) -> float:
    """Return the largest force of a roller that tables serve [N].

    Forms and forces on rings press rollers far beyond their fraction of the load.
    """
    largest = DEFLECTION_FORCE_FACTOR * usual_force(a)
    if bent is not None:
        largest = max(largest, _REST_FORCE_FACTOR * float(a.load_distribution(1).outer_force.max()))
    return largest


def _drag_capsules(cage: Cage) -> list[object]:
    """Return the compiled drags of a cage, without those that describe the film of a land that guides it."""
    torques = zip(cage.drags.torques, cage.drags.capsules(), strict=True)
    guided_by_land = cage.guidance != _GUIDANCES[0]
    return [capsule for model, capsule in torques if not (guided_by_land and _is_land_drag(model))]


def _is_land_drag(model: DragModel) -> bool:
    """Return whether a drag describes the film of the land: whether it takes the clearance of the land."""
    return any(f.metadata.get("from_scene") == "land_clearance" for f in attrs.fields(type(model)))  # type: ignore[arg-type]


def _land(a: Assembly, settings: PlanarSettings) -> dict[str, float]:
    """Return the parameters of the land for the compiled system; without a land they are not used.

    Its short journal bearing film has R eta L^3/c^3 against squeeze, 2 pi eta L R^3/c against shear, and is no thinner
    than the roughness.
    """
    cage = a.cage
    oil = a.lubricant.at(a.scene.operation.temperature).viscosity
    radius = cage.land_radius or 1.0
    width = cage.land_width or 1.0
    clearance = cage.land_clearance or 1.0
    return {
        "guidance": _GUIDANCES.index(cage.guidance),
        "radius": radius,
        "clearance": clearance,
        "film": radius * oil * (width / clearance) ** 3,
        "shear": 2 * math.pi * oil * width * radius**3 / clearance,
        "floor": min(a.inner.conditions.roughness / clearance, 0.5),
        "stiffness": settings.land_stiffness,
        "damping": settings.land_damping,
        "friction": settings.land_friction,
    }


def _force_tables(a: Assembly, largest_force: float) -> tuple[ForceTable, ...]:
    """Return the tables of both raceways, or none: a law in Python may depend on more than the gap."""
    if any(raceway.deflection.is_single_threaded for raceway in a.raceways):
        return ()
    tables = [force_table(a, raceway, largest_force) for raceway in a.raceways]
    return tuple(table for table in tables if table is not None) if None not in tables else ()


def force_table(a: Assembly, raceway: Raceway, largest_force: float) -> ForceTable | None:
    """Return the force of a roller by its gap, cached for a bearing; None if no table has a small error.

    The table is a piecewise cubic Hermite interpolant over the root of the gap. Its cells are halved until the error
    half-way between nodes is within 3e-5 of the force or of a light one, up to 65536 cells.

    Parameters
    ----------
    a : Assembly
        The bearing.
    raceway : Raceway
        The raceway, with its deflection law.
    largest_force : float
        Force up to which the table reaches [N].
    """
    key = (
        largest_force,
        raceway.conditions,
        raceway.deflection.models,
        a.drop.tobytes(),
        a.widths.tobytes(),
    )
    return a.cached("force by gap", key, lambda: _build_force_table(a, raceway, largest_force))


def _build_force_table(a: Assembly, raceway: Raceway, largest_force: float) -> ForceTable | None:
    """Return the table of `force_table`, by halving all cells until its error is small."""
    drop = a.drop - a.drop.min()
    light = _LIGHT_FORCE * largest_force / DEFLECTION_FORCE_FACTOR

    def forces(root: Array) -> Array:
        """Return the force [N] and its derivative with respect to the root of the gap [N/m^0.5], (2, m)."""
        load, stiffness = a.deflect((root**2)[:, None] - drop, raceway.ring)
        return np.stack((load @ a.widths, stiffness @ a.widths * 2.0 * root))

    beyond = int(np.searchsorted(forces(np.sqrt(_APPROACHES))[0], largest_force))
    deepest = float(_APPROACHES[min(beyond, _APPROACHES.size - 1)])
    cells = _FIRST_CELLS
    root = np.linspace(0.0, math.sqrt(deepest), cells + 1)
    known = forces(root)
    while True:
        step = root[1]
        half_way = forces(root[:-1] + 0.5 * step)
        slopes = known[1] * step
        left = known[0][:-1]
        right = known[0][1:]
        left_slope = slopes[:-1]
        right_slope = slopes[1:]
        error = float(
            (
                np.abs(0.5 * (left + right) + 0.125 * (left_slope - right_slope) - half_way[0])
                / np.maximum(half_way[0], light)
            ).max()
        )
        if error <= _FORCE_ERROR:
            break
        if 2 * cells > _MAX_CELLS:  # a profile or law with a jump
            return None
        merged = np.empty((2, 2 * cells + 1))
        merged[:, ::2] = known
        merged[:, 1::2] = half_way
        cells = 2 * cells
        known = merged
        root = np.linspace(0.0, math.sqrt(deepest), cells + 1)
    rise = right - left
    return ForceTable(
        deepest=deepest,
        coefficients=np.stack(
            (
                left,
                left_slope,
                3.0 * rise - 2.0 * left_slope - right_slope,
                left_slope + right_slope - 2.0 * rise,
            ),
            axis=1,
        ),
        error=error,
        light=light,
    )


def _resistances(a: Assembly, largest_force: float) -> list[tuple[float, Array]] | None:
    """Return tables of the rolling resistance of a contact on both raceways; None if the laws have none."""
    if not a.inner.chain.resists:
        return None
    return [_resistance_table(a, raceway, largest_force) for raceway in a.raceways]


def _resistance_table(a: Assembly, raceway: Raceway, largest_force: float) -> tuple[float, Array]:
    """Return a step of sqrt(Q) [N^0.5], over which rolling resistance is nearly linear, and the resistances [N].

    They are those at epicyclic speed.
    """
    load, _ = a.deflect(_APPROACHES[:, None] - (a.drop - a.drop.min()), raceway.ring)
    force = load @ a.widths
    load = load[force <= largest_force]
    force = force[force <= largest_force]
    root = np.linspace(0.0, math.sqrt(force[-1]), _RESISTANCE_CELLS + 1)
    rolling = float(a.kinematics.surface_speeds(0.0, 0.0).inner_rolling)
    known = np.concatenate(([0.0], resistances(raceway, load, a.widths, rolling)))
    return float(root[1]), np.interp(root, np.concatenate(([0.0], np.sqrt(force))), known)


def _swing_frequency(a: Assembly, settings: PlanarSettings, bent: BentRings | None) -> float:
    """Return an upper bound of the angular frequency of a roller between the rings [rad/s].

    The whole load is on one roller. The square of the frequency is the stiffness of both contacts over the mass of the
    roller, plus the stiffness of half as many contacts as there are rollers over the mass of the inner ring, which
    oscillates against them. The stiffness increases only slowly with the load.
    """
    force = (
        a.scene.operation.radial_load
        + settings.inner_ring_mass * settings.gravity
        + a.centrifugal_force
    )
    stiffness = []
    for ring in RINGS:
        load, slope = a.deflect(_APPROACHES[:, None] - (a.drop - a.drop.min()), ring)
        stiffness.append(float(np.interp(force, load @ a.widths, slope @ a.widths)))
    inner, outer = stiffness
    others = 0.5 * a.scene.bearing.rollers * inner / settings.inner_ring_mass
    if bent is not None:
        others += bent.square_frequency((inner, outer), a.scene.bearing.rollers)
    return math.sqrt((inner + outer) / a.roller_mass + others)


def _scale(a: Assembly, cage: Cage, bent: BentRings | None) -> Array:
    """Return typical magnitudes of the unknowns: deflections, their speeds, epicyclic speeds, and their energies.

    Between its raceways a roller oscillates at some 20 kHz with small amplitude and hardly any damping. A tolerance
    relative to its deflection would set the step of the whole motion. With `_SWING_FACTOR` times the deflection there
    are 1.6 to 1.9 times fewer steps, and speeds and positions of cage, rollers and pockets have the same error. Normal
    forces have an error of 0.4 to 1.6 per mille of the largest at a tolerance of 1e-5, instead of 0.03 to 0.7 (18 runs
    of the 1032930, 5 ms with all guidances, against a tolerance of 1e-10).
    """
    b = a.scene.bearing
    k = a.kinematics
    force = max(a.scene.operation.radial_load / b.rollers, a.centrifugal_force, 1.0)
    samples = np.geomspace(1e-9, 1e-3, 121)
    length = float(np.interp(force / b.roller_length, a.deflect(samples, "outer")[0], samples))
    speed = length * math.sqrt(force / (length * a.roller_mass))
    orbit = max(abs(k.epicyclic_cage_speed), 1.0)
    clearance = max(cage.pocket_clearance / 2, length)
    head = [length, length, speed, speed, clearance, clearance, speed, speed, orbit, 1.0]
    roller = [
        clearance,
        orbit,
        k.epicyclic_roller_speed,
        _SWING_FACTOR * length,
        _SWING_FACTOR * speed,
    ]
    energy = 0.5 * (cage.inertia + b.rollers * a.roller_mass * k.orbit_radius**2) * orbit**2
    of_rings = {"m": _SWING_FACTOR * length, "m/s": _SWING_FACTOR * speed, "rad": 1.0}
    if bent is not None:
        head += [of_rings[unit] for unit in bent.names.values()]
    return np.array(
        [
            *head,
            *roller * b.rollers,
            *[energy if unit == "J" else 2.0 * energy / orbit for unit in LEDGER.values()],
        ]
    )
