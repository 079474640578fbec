"""Motion of cage and rollers at the levels cage-set and pocket: the compiled system of a bearing, and its parameters.

- All speeds are in the sense in which rolling speeds are positive (``Kinematics``); times ``direction`` they are those
  of the scene.
- The unknowns: y = [cage angle, cage speed | spin (, orbital speed, position in the pocket) of each roller | ledger].
- The ledger integrates work and impulse with the same rates as the motion, so that its residuals measure the error of
  the integrator alone.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import Array
from rollslip.errors import DomainError, RollslipError
from rollslip.units import format_quantity
from rollslip_kernels.motion.carried import LEDGER, Carried
from rollslip_kernels.motion.system import System
from rollslip_studies.dynamics.levels.load_map import LoadMap, build_load_map, resistances
from rollslip_studies.dynamics.levels.moving_bearing import (
    MovingBearing,
    pocket_contact,
    uncontrolled_scale,
)
from rollslip_studies.dynamics.levels.raceway_friction import FrictionSettings, raceway_friction

#: Level -> unknowns of each roller and their unit.
_ROLLER_UNKNOWNS: Final = {
    "cage-set": {"roller_spin": "rad/s"},
    "pocket": {"roller_spin": "rad/s", "orbital_speed": "rad/s", "pocket_position": "m"},
}
#: Unknowns of the head and their unit.
_HEAD: Final = {"cage_angle": "rad", "cage_speed": "rad/s"}


@attrs.frozen(eq=False, kw_only=True)
class CarriedMotion(MovingBearing):
    """The motion of a bearing whose rollers orbit with the cage.

    Attributes
    ----------
    level : str
        "cage-set" or "pocket".
    loads : LoadMap
        Loads per slice, or forces, over the orbit.
    carried : Carried
        The compiled system.
    """

    level: str
    loads: LoadMap
    carried: Carried

    @property
    def names(self) -> tuple[Mapping[str, str], Mapping[str, str], Mapping[str, str]]:
        """Unknowns of the head, of each roller and of the ledger, in order -> their unit."""
        return _HEAD, _ROLLER_UNKNOWNS[self.level], LEDGER

    def initial(self, cage_slip: float = 0.0, roller_slip: float = 0.0) -> Array:
        """Return the state with these slips, rollers in the middle of their pockets; 0 epicyclic, 1 at rest.

        Raises
        ------
        DomainError
            If there is a cage slip and the epicyclic cage speed, to which it refers, is zero.
        """
        speeds = self.assembly.kinematics.surface_speeds(cage_slip, roller_slip)
        return self.state_at(float(speeds.cage_speed), float(speeds.roller_speed))

    def state_at(
        self, cage_speed: float, roller_speed: float, load: float = 0.0, direction: float = 0.0
    ) -> Array:
        """Return the state with these speeds [rad/s], rollers in the middle of their pockets whatever the load."""
        block = [roller_speed - cage_speed, cage_speed, 0.0][: len(_ROLLER_UNKNOWNS[self.level])]
        moving = [0.0, cage_speed, *block * self.assembly.scene.bearing.rollers]
        return np.array([*moving, *[0.0] * (self.system.n - len(moving))])

    def energy(self, y: Array) -> Array:
        """Return the kinetic energy of cage and rollers, and the elastic energy of the pockets [J], (...)."""
        u = self.split(y)
        orbital = u.get("orbital_speed", u["cage_speed"][..., None] + 0.0 * u["roller_spin"])
        energy = 0.5 * self.assembly.cage.inertia * u["cage_speed"] ** 2
        energy = energy + 0.5 * self.orbital_inertia * (orbital**2).sum(axis=-1)
        energy = energy + 0.5 * self.spin_inertia * (u["roller_spin"] ** 2).sum(axis=-1)
        if self.level == "pocket":
            energy = energy + self.carried.stored_energy(u["pocket_position"]).sum(axis=-1)
        return np.asarray(energy)

    def angular_momentum(self, y: Array) -> Array:
        """Return the angular momentum of cage and rollers about the axis of the bearing [N m s], (...)."""
        u = self.split(y)
        orbital = u.get("orbital_speed", u["cage_speed"][..., None] + 0.0 * u["roller_spin"])
        momentum = self.assembly.cage.inertia * u[
            "cage_speed"
        ] + self.orbital_inertia * orbital.sum(axis=-1)
        return np.asarray(momentum - self.spin_inertia * u["roller_spin"].sum(axis=-1))

    @property
    def orbital_inertia(self) -> float:
        """Moment of inertia m R_m^2 of a roller about the axis of the bearing [kg m2]."""
        return self.assembly.roller_mass * self.assembly.kinematics.orbit_radius**2

    def error(self, refusal: Any) -> RollslipError:
        """Return the error for the ``reason`` of a ``RefusedError``: the refusing part and the value it refused."""
        part, value = refusal
        if part == "loads":
            a = self.assembly
            top = math.sqrt(self.loads.top / (a.roller_mass * a.kinematics.orbit_radius))
            return DomainError(
                f"roller {value} is carried round faster than {format_quantity(top, 'rad/s', 4)}, up to which its "
                "loads were worked out; check what drives the cage"
            )
        return super().error(refusal)


def carried_motion(
    assembly: Assembly,
    friction: FrictionSettings,
    *,
    level: str,
    loads: LoadMap | None = None,
    torques: Sequence[object] | None = None,
    per_roller: bool = False,
) -> CarriedMotion:
    """Build the motion of a bearing whose scene has a cage.

    Where rolling stops or reverses, films are those of an entrainment speed sqrt(u^2 + u_0^2), u_0 = 1 mm/s. At level
    cage-set only the friction of the pocket counts, under the force that keeps a roller in its steady orbit.

    Parameters
    ----------
    assembly : Assembly
        The bearing.
    friction : FrictionSettings
        Friction of the raceways, and the values that are watched.
    level : str
        "cage-set" (rollers at the cage's spacing) or "pocket" (within their pockets).
    loads : LoadMap, optional
        Loads per slice that were built before.
    torques : sequence of capsules, optional
        Drags ``rs_drag``, by default those of the scene.
    per_roller : bool
        Whether `MovingBearing.sliding_work_and_distance` is integrated.

    Raises
    ------
    SceneError
        If the cage is wrong.
    ConvergenceError
        If loads or tables do not reach the tolerance.
    DomainError
        If a law has no value at a speed over which effective friction is tabulated.
    ValueError
        If the coefficient of constant friction is negative or its sliding speed not positive.
    """
    assembly = assembly.with_resistance()
    if loads is None:
        loads = build_load_map(assembly, friction.table_tolerance(assembly))
    k = assembly.kinematics
    cage = assembly.cage
    of_raceways = raceway_friction(assembly, friction, loads)
    if friction.name != "conventional":
        loads = loads.forces(_resistance(assembly))
    bearing = {
        "rollers": assembly.scene.bearing.rollers,
        "direction": k.direction,
        "inner_radius": k.inner_radius,
        "outer_radius": k.outer_radius,
        "radius": k.roller_radius,
        "orbit": k.orbit_radius,
        "inner_speed": k.direction * k.inner_speed,
        "outer_speed": k.direction * k.outer_speed,
        "mass": assembly.roller_mass,
        "spin_inertia": 0.5 * assembly.roller_mass * k.roller_radius**2,
        "cage_inertia": cage.inertia,
        "epicyclic_speed": k.epicyclic_cage_speed,
    }
    carried = Carried(
        level == "pocket",
        bearing,
        (loads.top, loads.widths, loads.cell),
        *of_raceways.capsules,
        cage.drags.capsules() if torques is None else torques,
        pocket_contact(assembly),
        np.append(_scale(assembly, level), uncontrolled_scale(assembly, per_roller)),
        friction.critical_slip,
        friction.watched_film,
        per_roller,
    )
    return CarriedMotion(
        assembly=assembly,
        level=level,
        friction=of_raceways,
        loads=loads,
        carried=carried,
        system=System(carried.system()),
    )


def _resistance(assembly: Assembly) -> Any:
    """Return the rolling resistance of contacts without sliding, as a function of loads and ring; None without any."""
    if not assembly.inner.chain.resists:
        return None
    rolling = float(assembly.kinematics.surface_speeds(0.0, 0.0).inner_rolling)
    return lambda load, ring: resistances(assembly.raceways[ring], load, assembly.widths, rolling)


def _scale(assembly: Assembly, level: str) -> Array:
    """Return the typical magnitudes of the unknowns, to which tolerances are relative."""
    k = assembly.kinematics
    spin = k.epicyclic_roller_speed
    orbital = k.roller_radius / k.orbit_radius * spin
    block = [spin, orbital, max(assembly.cage.pocket_clearance, 1e-6)][
        : len(_ROLLER_UNKNOWNS[level])
    ]
    return np.array([1.0, orbital, *block * assembly.scene.bearing.rollers, *[1.0] * len(LEDGER)])
