"""What the compiled motions of all levels have in common: names of the unknowns, the ledger, and errors in words."""

import abc
import math
from collections.abc import Mapping
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import RINGS, Array
from rollslip.errors import DomainError, RollslipError, SceneError
from rollslip.structure import Location
from rollslip_kernels.motion.system import System
from rollslip_studies.dynamics.levels.raceway_friction import FRICTION, RacewayFriction
from rollslip_studies.motion.effective_table import table_records

#: Friction coefficient of the traction under which a roller is taken to lean on its pocket, where that is a measure.
_LEANING: Final = 0.05
#: Squeeze film of a cylinder and a flat wall, 3 sqrt(2) pi eta (r/h)^1.5 dh/dt per length.
_SQUEEZE: Final = 3.0 * math.sqrt(2.0) * math.pi
#: Magnitude [J, m] of unknowns that no step is held to.
_UNGOVERNED: Final = 1e15
#: Level -> number of unknowns of the head and of each roller, where rings are rigid and round.
_UNKNOWNS: Final = {"cage-set": (2, 1), "pocket": (2, 3), "planar": (10, 5)}


def unknowns(level: str, assembly: Assembly) -> int:
    """Return how many unknowns a level has, without those of the ledger.

    They are two more for each shape in which a ring yields, and one for each ring whose form turns.
    """
    (head, roller) = _UNKNOWNS[level]
    rings = assembly.rings
    if level == "planar" and rings is not None:
        head += 2 * rings.parity.size + len({ring for periods, ring in rings.turns if periods})
    return head + roller * assembly.scene.bearing.rollers


def check_moves(assembly: Assembly, level: str) -> None:
    """Refuse a bearing that is known at steady slips alone, or at another level."""
    operation = assembly.scene.operation
    heavy = assembly.weight_fraction > assembly.scene.accuracy.tolerance
    bare = assembly.scene.models.neighbour_friction is not None
    weighs = operation.gravity_direction is not None and heavy and level != "planar"
    for table, key, there, told in (
        (
            "models",
            "separator",
            bare,
            "need a cage; for a full complement take the study of steady slips",
        ),
        (
            "operation",
            "carrier",
            operation.carrier is not None,
            "know no carrier; take the study of steady slips",
        ),
        (
            "operation",
            "gravity_direction",
            weighs,
            "take the weight of rollers at level 'planar' only; choose that",
        ),
    ):
        if there:
            where = Location(assembly.scene.origins, (table, key))
            raise SceneError([where.message(f"motions in time {told}")])


@attrs.frozen(eq=False, kw_only=True)
class MovingBearing(abc.ABC):
    """The motion of one bearing; it belongs to one thread."""

    assembly: Assembly  # the bearing, with its resistance to rolling
    friction: RacewayFriction  # friction of inner and outer raceway
    #: Its rates, Jacobian and watched values: cage slip less the critical one, film parameter less its limit, and at
    #: level planar the largest approach at the inner ring, below zero where no roller carries it. Its owner, the
    #: compiled motion, counts ``contacts_evaluated``.
    system: System

    @property
    @abc.abstractmethod
    def names(self) -> tuple[Mapping[str, str], Mapping[str, str], Mapping[str, str]]:
        """Unknowns of the head, of each roller and of the ledger, in order -> their unit."""

    @abc.abstractmethod
    def initial(self, cage_slip: float = 0.0, roller_slip: float = 0.0) -> Array:
        """Return the state with these slips; 0 epicyclic, 1 at rest, 2 backwards."""

    @abc.abstractmethod
    def state_at(
        self, cage_speed: float, roller_speed: float, load: float, direction: float
    ) -> Array:
        """Return the state with these speeds of the cage and of rollers relative to it [rad/s], all else at rest.

        ``load`` [N] and its ``direction`` [rad] count where the motion knows them.
        """

    def looks(self) -> tuple[Array, Array]:
        """Return times and states that tell how fast it moves before it has moved, (m,) and (m, n)."""
        return np.zeros(1), self.initial()[None]

    @abc.abstractmethod
    def energy(self, y: Array) -> Array:
        """Return the energy of states (..., n) [J], (...)."""

    @abc.abstractmethod
    def angular_momentum(self, y: Array) -> Array:
        """Return the angular momentum about the axis of the bearing [N m s], (...)."""

    @property
    def direction(self) -> int:
        """1 or -1: times it, speeds are the real ones."""
        return self.assembly.kinematics.direction

    @property
    def breaks(self) -> tuple[float, ...]:
        """Times at which the rates have a kink or jump [s]."""
        return ()

    def at_rest(self, t: float, end: float, y: Array) -> bool:
        """Return whether the bearing rests in a state, and does so up to a later time [s]."""
        return False

    def unslipped(self, t: Array) -> tuple[Array, Array]:
        """Return the speeds of cage and rollers without slip at times [rad/s], to which slips refer."""
        k = self.assembly.kinematics
        return np.full(t.size, k.epicyclic_cage_speed), np.full(t.size, k.epicyclic_roller_speed)

    def ring_speeds(self, t: Array) -> Array:
        """Return the speeds of inner and outer ring at times [rad/s], in the sense of the cage's, (2, m)."""
        k = self.assembly.kinematics
        return np.outer([k.direction * k.inner_speed, k.direction * k.outer_speed], np.ones(t.size))

    @property
    def tables(self) -> dict[str, str]:
        """Attributes of a result that say how right the tables are that the motion rests on."""
        by_force = table_records(self.friction.by_force, "friction_tables")
        return {**table_records(self.friction.tables), **by_force}

    @property
    def way(self) -> str:
        """How friction is evaluated, and what else there is a table of, in words."""
        friction = self.friction
        said = FRICTION[friction.settings.name]
        return f"{said}, {friction.way}" if friction.way else said

    @property
    def units(self) -> dict[str, str]:
        """Names of the unknowns and their units, in the order of y; those of a roller stand for one each."""
        head, roller, ledger = self.names
        return {**head, **roller, **ledger}

    @property
    def spin_inertia(self) -> float:
        """Moment of inertia J = m r^2/2 of a roller about its own axis [kg m2]."""
        return 0.5 * self.assembly.roller_mass * self.assembly.kinematics.roller_radius**2

    @property
    def tolerances(self) -> tuple[Array, Array]:
        """Absolute and relative tolerances of the unknowns, for a relative tolerance of 1.

        They are the typical magnitudes of the unknowns and 1, but for a place in a pocket: the force there goes with
        the depth of the contact, some tenths of a micron, and not with the clearance of some tenths of a millimetre
        that it adds to. So of a place it is the depth under a traction of 0.05 of a roller's mean force, or of the
        centrifugal one if that is larger, whatever the place.
        """
        absolute = self.system.scale
        relative = np.ones(self.system.n)
        if "pocket_position" in self.names[1]:
            a = self.assembly
            at = list(self.names[1]).index("pocket_position")
            force = max(
                a.scene.operation.radial_load / a.scene.bearing.rollers, a.centrifugal_force
            )
            depth = _LEANING * force / a.cage.pocket_stiffness
            half = 0.5 * a.cage.pocket_clearance
            if 0.0 < depth < half:
                self.parts(absolute)[1][:, at] = depth
                self.parts(relative)[1][:, at] = depth / half
        return absolute, relative

    def parts(self, y: Array) -> tuple[Array, Array, Array]:
        """Return head (..., H), rollers (..., Z, B) and ledger (..., L) of states y (..., n), as views."""
        y = np.asarray(y)
        head, roller, _ = map(len, self.names)
        rollers = self.assembly.scene.bearing.rollers
        behind = head + rollers * roller  # of no states, too
        return (
            y[..., :head],
            y[..., head:behind].reshape(*y.shape[:-1], rollers, roller),
            y[..., behind:],
        )

    def split(self, y: Array) -> dict[str, Array]:
        """Return the unknowns of states (..., n) by name, (...) or, those of the rollers, (..., Z)."""
        unknowns: dict[str, Array] = {}
        for names, part in zip(self.names, self.parts(y), strict=True):
            unknowns |= {name: part[..., k] for k, name in enumerate(names)}
        return unknowns

    def works(self, y: Array) -> dict[str, Array]:
        """Return what the ledger recorded of work done on the motion [J], what it lost being negative, by name."""
        recorded = self.split(y)
        senses = {
            name: name.startswith("work_") - name.startswith("lost_") for name in self.names[2]
        }
        return {name: sense * recorded[name] for name, sense in senses.items() if sense}

    def of_each(self, y: Array) -> tuple[Array, Array]:
        """Return work [J] and distance [m] that each roller slid on inner and outer ring, (..., 2, Z) both.

        They are integrated beside the ledger, whose losses at the rings are the sums of the works; known to a motion
        that was made for it.
        """
        behind = self.parts(y)[2][..., len(self.names[2]) :]
        each = np.moveaxis(behind.reshape(*behind.shape[:-1], -1, 2, 2), -3, -1)
        return each[..., 0, :, :], each[..., 1, :, :]

    def impulse(self, y: Array) -> Array:
        """Return the angular momentum put in that the ledger recorded [N m s], (...)."""
        recorded = self.split(y)
        return np.asarray(
            sum(recorded[name] for name in self.names[2] if name.startswith("impulse_"))
        )

    def energy_residual(self, y: Array) -> Array:
        """Return what of the energy the ledger does not explain [J], for states (m, n) from the first on."""
        residual = self.energy(y) - sum(self.works(y).values())
        return np.asarray(residual - residual[0])

    def momentum_residual(self, y: Array) -> Array:
        """Return what of the angular momentum the ledger does not explain [N m s], for states (m, n)."""
        residual = self.angular_momentum(y) - self.impulse(y)
        return np.asarray(residual - residual[0])

    def outputs(self, t: Array, y: Array) -> dict[str, Array]:
        """Return forces, speeds and film parameter of all contacts at stored states, see `Carried.outputs`.

        Raises
        ------
        DomainError
            If a model refuses a state.
        """
        contacts: dict[str, Array] | None = self.system.owner.outputs(t, y)
        if contacts is None:
            raise self.error(self.system.refusal())
        return contacts

    def error(self, refusal: Any) -> RollslipError:
        """Return the error that says in words what was refused: the ``reason`` of a ``RefusedError``."""
        who, what = refusal
        if who == "drag":
            return DomainError(
                "the drags give a torque that is not finite; check what drives the cage"
            )
        ring = RINGS.index(who)
        error = self.assembly.raceways[ring].chain.error(what, self.friction.slices[ring])
        error.add_note(f"in a contact with the {who} ring")
        return error


def ungoverned(assembly: Assembly, each: bool) -> Array:
    """Return the magnitudes of what each roller does, so large that they set no step: the ledger's sums do."""
    return np.full(4 * assembly.scene.bearing.rollers if each else 0, _UNGOVERNED)


def pocket_contact(assembly: Assembly) -> dict[str, float]:
    """Return how a roller meets the walls of its pocket along the orbit, as the compiled systems take it."""
    cage = assembly.cage
    k = assembly.kinematics
    film = 0.0
    if cage.pocket_contact == "film":
        viscosity = assembly.lubricant.at(assembly.scene.operation.temperature).viscosity
        film = _SQUEEZE * viscosity * assembly.scene.bearing.roller_length * k.roller_radius**1.5
    return {
        "half_clearance": 0.5 * cage.pocket_clearance,
        "stiffness": cage.pocket_stiffness,
        "damping": cage.pocket_damping,
        "friction": 0.0
        if cage.drags.pocket_friction is None
        else cage.drags.pocket_friction.coefficient,
        "film": film,
        "roughness": assembly.inner.conditions.roughness,
    }
