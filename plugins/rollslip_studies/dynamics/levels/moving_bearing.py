"""The interface of a bearing in motion at any level: names of the unknowns, tolerances, ledger and errors.

A compiled system gives the rates dy/dt of a bearing; an integrator marches them over time. The state y is [head |
unknowns of each roller | ledger]. The ledger integrates work and impulse, so that the balances of energy and angular
momentum can be checked.
"""

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

#: Friction coefficient with which the typical force of a roller on its pocket is estimated. Doubling it doubles the
#: absolute tolerance of the position in the pocket. Chosen: about the largest traction of a lubricated contact.
_TYPICAL_FRICTION: Final = 0.05
#: Factor of the squeeze film force of a cylinder on a flat wall per length, 3 sqrt(2) pi eta (r/h)^1.5 dh/dt (Reynolds
#: equation without side leakage).
_SQUEEZE_FACTOR: Final = 3.0 * math.sqrt(2.0) * math.pi
#: Typical magnitude [J, m] of unknowns without error control: so large that their errors never limit a step.
_UNCONTROLLED: Final = 1e15
#: Level -> number of unknowns of the head and of each roller, for rigid and round rings.
_UNKNOWNS: Final = {"cage-set": (2, 1), "pocket": (2, 3), "planar": (10, 5)}


def unknowns(level: str, assembly: Assembly) -> int:
    """Return the number of unknowns of a level, without those of the ledger.

    There are two more for each shape of a flexible ring, and one for each ring whose form turns.

    Parameters
    ----------
    level : str
        "cage-set", "pocket" or "planar".
    assembly : Assembly
        The bearing.
    """
    head, roller = _UNKNOWNS[level]
    rings = assembly.rings
    if level == "planar" and rings is not None:
        head += 2 * rings.parity.size + len({ring for periods, ring in rings.turns if periods})
    return head + roller * assembly.scene.bearing.rollers


def check_moves(assembly: Assembly, level: str) -> None:
    """Refuse a bearing that only a steady study describes, or another level.

    Parameters
    ----------
    assembly : Assembly
        The bearing.
    level : str
        "cage-set", "pocket" or "planar".

    Raises
    ------
    SceneError
        With the location of the setting that the level does not describe.
    """
    operation = assembly.scene.operation
    for is_refused, table, key, advice in (
        (
            assembly.scene.bearing.contact_angle is not None,
            "bearing",
            "contact_angle",
            "know no tapered bearing; take the study of steady slips",
        ),
        (
            assembly.scene.models.neighbour_friction is not None,
            "models",
            "separator",
            "need a cage; for a full complement take the study of steady slips",
        ),
        (
            bool(operation.axial_load),
            "operation",
            "axial_load",
            "know no ribs that carry it; take the study of steady slips, or leave it out",
        ),
        (
            operation.carrier is not None,
            "operation",
            "carrier",
            "know no carrier; take the study of steady slips",
        ),
        (
            operation.gravity_direction is not None
            and assembly.weight_fraction > assembly.scene.accuracy.tolerance
            and level != "planar",
            "operation",
            "gravity_direction",
            "take the weight of rollers at level 'planar' only; choose that",
        ),
    ):
        if is_refused:
            where = Location(assembly.scene.origins, (table, key))
            raise SceneError([where.message(f"motions in time {advice}")])


@attrs.frozen(eq=False, kw_only=True)
class MovingBearing(abc.ABC):
    """The motion of one bearing; it belongs to one thread."""

    assembly: Assembly  # the bearing, with its resistance to rolling
    friction: RacewayFriction  # friction of inner and outer raceway
    #: Rates, Jacobian and watched values: cage slip minus the critical one, film parameter minus its limit, and at
    #: level planar the largest approach at the inner ring, which is negative where no roller carries the ring. The
    #: owner of the system, the compiled motion, counts ``contacts_evaluated``.
    system: System

    @property
    @abc.abstractmethod
    def names(self) -> tuple[Mapping[str, str], Mapping[str, str], Mapping[str, str]]:
        """Unknowns of the head, of each roller and of the ledger, in order -> their unit."""

    @abc.abstractmethod
    def initial(self, cage_slip: float = 0.0, roller_slip: float = 0.0) -> Array:
        """Return the state (n,) with these slips: 0 epicyclic, 1 at rest, 2 backwards.

        Parameters
        ----------
        cage_slip, roller_slip : float
            Slip of the cage, and of the rollers about their own axes [1].
        """

    @abc.abstractmethod
    def state_at(
        self, cage_speed: float, roller_speed: float, load: float, direction: float
    ) -> Array:
        """Return the state (n,) with these speeds, and all else at rest.

        Parameters
        ----------
        cage_speed, roller_speed : float
            Speeds of the cage, and of rollers relative to it [rad/s].
        load, direction : float
            Radial load [N] and its direction [rad], at levels whose states depend on them.
        """

    def sample_states(self) -> tuple[Array, Array]:
        """Return times [s], (m,), and states (m, n) by which the cost of a motion is estimated before it is run."""
        return np.zeros(1), self.initial()[None]

    @abc.abstractmethod
    def energy(self, y: Array) -> Array:
        """Return the energy of states (..., n) [J], (...)."""

    @abc.abstractmethod
    def angular_momentum(self, y: Array) -> Array:
        """Return the angular momentum about the axis of the bearing [N m s], (...)."""

    @property
    def direction(self) -> int:
        """1 or -1: factor from speeds of the motion to those of the scene."""
        return self.assembly.kinematics.direction

    @property
    def breaks(self) -> tuple[float, ...]:
        """Times at which the rates have a kink or jump [s]."""
        return ()

    def at_rest(self, t: float, end: float, y: Array) -> bool:
        """Return whether the bearing is at rest in a state, and stays at rest until a later time [s].

        Parameters
        ----------
        t, end : float
            Time of the state, and the later time [s].
        y : ndarray, shape (n,)
            The state.
        """
        return False

    def epicyclic_speeds(self, t: Array) -> tuple[Array, Array]:
        """Return the speeds of cage and rollers without slip at times [rad/s], to which slips are relative."""
        k = self.assembly.kinematics
        return np.full(t.size, k.epicyclic_cage_speed), np.full(t.size, k.epicyclic_roller_speed)

    def ring_speeds(self, t: Array) -> Array:
        """Return the speeds of inner and outer ring at times [rad/s], (2, m); positive in the sense of rolling."""
        k = self.assembly.kinematics
        return np.outer([k.direction * k.inner_speed, k.direction * k.outer_speed], np.ones(t.size))

    @property
    def tables(self) -> dict[str, str]:
        """Attributes of a result with sizes and errors of the tables that the motion uses."""
        return {
            **table_records(self.friction.tables),
            **table_records(self.friction.friction_tables, "friction_tables"),
        }

    @property
    def evaluation_method(self) -> str:
        """How friction is evaluated, and which other tables there are, in words."""
        texts = (FRICTION[self.friction.settings.name], self.friction.evaluation_method)
        return ", ".join(filter(None, texts))

    @property
    def units(self) -> dict[str, str]:
        """Names of the unknowns and their units, in the order of y; those of a roller once for all rollers."""
        head, roller, ledger = self.names
        return {**head, **roller, **ledger}

    @property
    def spin_inertia(self) -> float:
        """Moment of inertia J = m r^2/2 of a roller about its own axis [kg m2]."""
        return 0.5 * self.assembly.roller_mass * self.assembly.kinematics.roller_radius**2

    @property
    def tolerances(self) -> tuple[Array, Array]:
        """Absolute and relative tolerances of the unknowns, for a relative tolerance of 1.

        They are the typical magnitudes of the unknowns and 1, except for the position in a pocket: the force there
        depends on the depth of the contact, some tenths of a micrometre, and not on the clearance, some tenths of a
        millimetre, that is part of the position. The tolerance of a position is therefore the depth under a traction
        of 0.05 times the mean force of a roller, or the centrifugal force if that is larger.
        """
        absolute = self.system.scale
        relative = np.ones(self.system.n)
        if "pocket_position" in self.names[1]:
            a = self.assembly
            column = list(self.names[1]).index("pocket_position")
            force = max(
                a.scene.operation.radial_load / a.scene.bearing.rollers, a.centrifugal_force
            )
            depth = _TYPICAL_FRICTION * force / a.cage.pocket_stiffness
            half_clearance = 0.5 * a.cage.pocket_clearance
            if 0.0 < depth < half_clearance:
                self.parts(absolute)[1][:, column] = depth
                self.parts(relative)[1][:, column] = depth / half_clearance
        return absolute, relative

    def parts(self, y: Array) -> tuple[Array, Array, Array]:
        """Return head (..., H), rollers (..., Z, B) and ledger (..., L) of states y (..., n), as views."""
        y = np.asarray(y)
        head, roller, _ = map(len, self.names)
        rollers = self.assembly.scene.bearing.rollers
        ledger = head + rollers * roller
        return (
            y[..., :head],
            y[..., head:ledger].reshape(*y.shape[:-1], rollers, roller),
            y[..., ledger:],
        )

    def split(self, y: Array) -> dict[str, Array]:
        """Return the unknowns of states (..., n) by name, as views: (...), and (..., Z) for those of rollers."""
        return {
            name: part[..., k]
            for names, part in zip(self.names, self.parts(y), strict=True)
            for k, name in enumerate(names)
        }

    def works(self, y: Array) -> dict[str, Array]:
        """Return the entries of the ledger that are work done on the motion [J], by name; losses are negative."""
        recorded = self.split(y)
        return {
            name: sense * recorded[name]
            for name in self.names[2]
            if (sense := name.startswith("work_") - name.startswith("lost_"))
        }

    def sliding_work_and_distance(self, y: Array) -> tuple[Array, Array]:
        """Return the sliding work [J] and distance [m] of each roller on inner and outer ring, both (..., 2, Z).

        They are integrated together with the ledger, whose losses at the rings are the sums of the works, in a motion
        that was built with ``per_roller``.
        """
        values = self.parts(y)[2][..., len(self.names[2]) :]
        of_rollers = np.moveaxis(values.reshape(*values.shape[:-1], -1, 2, 2), -3, -1)
        return of_rollers[..., 0, :, :], of_rollers[..., 1, :, :]

    def impulse(self, y: Array) -> Array:
        """Return the angular impulse on the motion by the ledger [N m s], (...)."""
        recorded = self.split(y)
        return np.asarray(
            sum(recorded[name] for name in self.names[2] if name.startswith("impulse_"))
        )

    def energy_residual(self, y: Array) -> Array:
        """Return the change of energy minus that of the ledger [J], (m,), for states (m, n) since the first one."""
        residual = self.energy(y) - sum(self.works(y).values())
        return np.asarray(residual - residual[0])

    def momentum_residual(self, y: Array) -> Array:
        """Return the change of angular momentum minus that of the ledger [N m s], (m,), for states (m, n)."""
        residual = self.angular_momentum(y) - self.impulse(y)
        return np.asarray(residual - residual[0])

    def outputs(self, t: Array, y: Array) -> dict[str, Array]:
        """Return forces, speeds and film parameter of all contacts at stored states; see `Carried.outputs`.

        Parameters
        ----------
        t : ndarray, shape (m,)
            Times [s].
        y : ndarray, shape (m, n)
            States at these times.

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
        """Return the error for the ``reason`` of a ``RefusedError``: the refusing part and the value it refused."""
        part, value = refusal
        if part == "drag":
            return DomainError(
                "the drags give a torque that is not finite; check what drives the cage"
            )
        ring = RINGS.index(part)
        error = self.assembly.raceways[ring].chain.error(value, self.friction.slices[ring])
        error.add_note(f"in a contact with the {part} ring")
        return error


def uncontrolled_scale(assembly: Assembly, per_roller: bool) -> Array:
    """Return the typical magnitudes of sliding work and distance of each roller, (4 Z,); empty without ``per_roller``.

    They are so large that they limit no step: the ledger contains their sums.
    """
    return np.full(4 * assembly.scene.bearing.rollers if per_roller else 0, _UNCONTROLLED)


def pocket_contact(assembly: Assembly) -> dict[str, float]:
    """Return the parameters of the contact of a roller and the walls of its pocket, for the compiled systems."""
    cage = assembly.cage
    film = 0.0
    if cage.pocket_contact == "film":
        film = (
            _SQUEEZE_FACTOR
            * assembly.lubricant.at(assembly.scene.operation.temperature).viscosity
            * assembly.scene.bearing.roller_length
            * assembly.kinematics.roller_radius**1.5
        )
    friction = cage.drags.pocket_friction
    return {
        "half_clearance": 0.5 * cage.pocket_clearance,
        "stiffness": cage.pocket_stiffness,
        "damping": cage.pocket_damping,
        "friction": 0.0 if friction is None else friction.coefficient,
        "film": film,
        "roughness": assembly.inner.conditions.roughness,
    }
