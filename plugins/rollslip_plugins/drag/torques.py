"""Torques on the cage: of one size, of the oil between cage and land, of rollers that plough through oil; pockets."""

import math
from functools import cached_property
from typing import Any, ClassVar

import attrs

from rollslip.bearing.cage import Cage
from rollslip.fields import Ranges, choice_of, non_negative, parameter, positive, within_possible
from rollslip.geometry.bearing import Bearing
from rollslip.lubricant.table import OilTable
from rollslip.models import DragModel, PocketFriction, from_scene
from rollslip.references import Reference
from rollslip.scene.supply import Lubrication
from rollslip_kernels.stages import drag as compiled
from rollslip_plugins.bibliography import HARRIS_2007, PARKER_1984, PETROFF_1883
from rollslip_plugins.drag.factor import scattering_factor


def _ranges(cls: Any, key: str) -> Ranges:
    """Return what is usual, and what is possible, of a key of the scene."""
    metadata = attrs.fields_dict(cls)[key].metadata
    return {"usual": metadata["usual"], "possible": metadata["possible"]}


@attrs.frozen(kw_only=True)
class ConstantTorque(DragModel):
    """Torque of one size against the motion of the cage: T = -T0 w_c/sqrt(w_c^2 + w_s^2).

    It stands for all drags of the cage when their sum is known, for example by a measurement.

    Symbols:

    - T: torque on the cage [N m]
    - T0: its size (``size``); 0.1 N m is an estimate for a bearing of 180 mm pitch diameter (D) [N m]
    - w_c: speed of the cage [rad/s]
    - w_s: speed below which the torque fades towards rest (``transition``) [rad/s]

    Range: a cage that turns; at 10 w_s the torque is 0.5 % below T0.

    Examples
    --------
    At 3 rad/s of a transition of 4 rad/s it is 3/5 of its size.

    >>> round(ConstantTorque(size=0.1, transition=4.0).torque(3.0, 10.0, 0.0), 12)
    -0.06
    """

    name: ClassVar[str] = "constant-torque"
    equation: ClassVar[str] = "T = -T0 w_c/sqrt(w_c^2 + w_s^2)"
    references: ClassVar[tuple[Reference, ...]] = (
        Reference(
            kind="remark",
            title="No law: a number that is given, made smooth where the cage stands.",
        ),
    )

    size: float = parameter(
        default=0.1,
        unit="N m",
        validator=non_negative,
        doc="size T0 of the torque",
        usual=(0, 1e3),
        possible=(0, 1e9),
    )
    transition: float = parameter(
        default=1.0,
        unit="rad/s",
        validator=positive,
        doc="speed w_s below which the torque fades towards rest",
        usual=(1e-3, 100),
        possible=(0, 1e6),
    )

    def torque(self, cage_speed: float, inner_speed: float, outer_speed: float) -> float:
        """Return the torque on the cage [N m]; speeds in rad/s."""
        return (
            -self.size
            * cage_speed
            / math.sqrt(cage_speed * cage_speed + self.transition * self.transition)
        )

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.constant_torque(self.size, self.transition)


@attrs.frozen(kw_only=True)
class PetroffLand(DragModel):
    """Torque of the oil between the cage and the land that guides it, after Petroff.

    T = f 2 pi eta W R^3 (w_ring - w_c)/c. The inner ring drives the cage, the outer one brakes it. Derived: shear
    stress eta R (w_ring - w_c)/c on the area 2 pi R W at the lever R.

    Symbols:

    - T: torque on the cage [N m]
    - f: factor for calibration and scatter (``factor``), 1 by default [1]
    - eta: viscosity of the oil (``viscosity``) [Pa s]
    - W: width of all rails together (``width``) [m]
    - R: radius of the land (``radius``) [m]
    - c: radial clearance of the land (``clearance``) [m]
    - w_ring: speed of the guiding ring (``ring``) [rad/s]
    - w_c: speed of the cage [rad/s]

    Range: laminar flow in a full, concentric gap, c << R; an oil at the temperature of the scene, while the gap of a
    fast bearing is hotter, and the torque less. A starved land has a smaller width.

    Raises
    ------
    DomainError
        If a value is left to a scene and there is none.

    Examples
    --------
    2 pi 0.01 0.01 0.1^3 100/1e-4 = 0.2 pi.

    >>> land = PetroffLand(ring="inner", viscosity=0.01, radius=0.1, width=0.01, clearance=1e-4)
    >>> f"{land.torque(300.0, 400.0, 0.0):.6f}"
    '0.628319'
    """

    name: ClassVar[str] = "petroff-land"
    equation: ClassVar[str] = "T = f 2 pi eta W R^3 (w_ring - w_c)/c"
    references: ClassVar[tuple[Reference, ...]] = (PETROFF_1883, HARRIS_2007)

    ring: str = from_scene(
        "guiding_ring", validator=choice_of("inner", "outer"), doc="ring whose land guides the cage"
    )
    viscosity: float = from_scene(
        "viscosity",
        validator=within_possible,
        doc="viscosity eta of the oil on the land",
        **_ranges(OilTable, "viscosity"),
    )
    radius: float = from_scene(
        "land_radius",
        validator=within_possible,
        doc="radius R of the land",
        **_ranges(Cage, "land_radius"),
    )
    width: float = from_scene(
        "land_width",
        validator=within_possible,
        doc="width W of the land, all rails together",
        **_ranges(Cage, "land_width"),
    )
    clearance: float = from_scene(
        "land_clearance",
        validator=within_possible,
        doc="radial clearance c of cage and land",
        **_ranges(Cage, "land_clearance"),
    )
    factor: float = scattering_factor(
        0.7,
        "a land is starved or full, eccentric, hotter than the oil, and its clearance is an estimate: 0.12 to 0.4 % of "
        "the radius",
    )

    @property
    def against(self) -> str:  # type: ignore[override]
        """The guiding ring."""
        return self.ring

    @cached_property
    def damping(self) -> float:
        """Torque for each rad/s between ring and cage [N m s]."""
        self.check_given()
        return self.factor * (
            2
            * math.pi
            * self.viscosity
            * self.width
            / self.clearance
            * (self.radius * self.radius * self.radius)
        )

    def torque(self, cage_speed: float, inner_speed: float, outer_speed: float) -> float:
        """Return the torque on the cage [N m]; speeds in rad/s."""
        return self.damping * ((inner_speed if self.ring == "inner" else outer_speed) - cage_speed)

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.petroff_land(self.damping, self.ring == "inner")


@attrs.frozen(kw_only=True)
class Churning(DragModel):
    """Torque of rollers that plough through a mist of oil: each meets F = C_D rho_eff l D (w_c R_m)^2/2 at R_m.

    T = -f Z R_m F sign(w_c), rho_eff = phi rho. The rollers' mass of air is left out.

    Symbols:

    - T: torque on the cage [N m]
    - f: factor for calibration and scatter (``factor``), 1 by default [1]
    - Z: number of rollers (``rollers``) [1]
    - l: length of a roller (``roller_length``) [m]
    - D: diameter of a roller (``roller_diameter``) [m]
    - R_m: radius of the orbit (``orbit_radius``) [m]
    - w_c: speed of the cage [rad/s]
    - rho: density of the oil (``density``) [kg/m3]
    - phi: its fraction of the volume between the rings (``oil_fraction``) [1]
    - C_D: drag coefficient of a roller (``coefficient``) [1]

    Range: turbulent wakes; the mist itself stands still, as it does in a housing at rest. An outer ring that turns
    takes oil along, by how much was not measured: in the sense of the cage the torque is less. C_D is about 1 for a
    long cylinder alone (Re from 1e3 to 1e5) and less in the wake of the next; the default of 0.5 is an estimate (D).
    phi follows from the supply of oil, with which the torque of a bath is that of SKF's later bath drag (C):
    `rollslip.scene.supply`. The torque is in proportion to both: it is known to a factor of two.

    Raises
    ------
    DomainError
        If a value is left to a scene and there is none.

    Examples
    --------
    10 rollers of 10 x 10 mm on 0.1 m at 100 rad/s in 0.5 0.02 1000 kg/m3 = 10 kg/m3: 10 10 1e-4 0.1^3 1e4/2 N m.

    >>> rollers = {"rollers": 10, "roller_diameter": 0.01, "roller_length": 0.01, "orbit_radius": 0.1}
    >>> mist = Churning(density=1000.0, oil_fraction=0.02, **rollers)
    >>> round(mist.torque(100.0, 200.0, 0.0), 12)
    -0.05
    """

    name: ClassVar[str] = "churning"
    equation: ClassVar[str] = "T = -f Z R_m C_D phi rho l D |w_c R_m| w_c R_m/2"
    references: ClassVar[tuple[Reference, ...]] = (HARRIS_2007, PARKER_1984)

    coefficient: float = parameter(
        default=0.5,
        unit="1",
        validator=non_negative,
        doc="drag coefficient C_D of a roller",
        usual=(0, 3),
        possible=(0, 1e3),
    )
    oil_fraction: float = from_scene(
        "oil_fraction",
        validator=within_possible,
        doc="fraction phi of oil in the volume between the rings",
        **_ranges(Lubrication, "oil_fraction"),
    )
    density: float = from_scene(
        "density",
        validator=within_possible,
        doc="density rho of the oil",
        **_ranges(OilTable, "density"),
    )
    rollers: float = from_scene(
        "rollers",
        validator=within_possible,
        doc="number Z of rollers",
        **_ranges(Bearing, "rollers"),
    )
    roller_diameter: float = from_scene(
        "roller_diameter",
        validator=within_possible,
        doc="diameter D of a roller",
        **_ranges(Bearing, "roller_diameter"),
    )
    roller_length: float = from_scene(
        "roller_length",
        validator=within_possible,
        doc="length l of a roller",
        **_ranges(Bearing, "roller_length"),
    )
    orbit_radius: float = from_scene(
        "orbit_radius",
        validator=within_possible,
        doc="radius R_m of the rollers' orbit",
        usual=(2e-3, 2),
        possible=(5e-5, 25),
    )
    factor: float = scattering_factor(
        0.65,
        "fraction of oil times drag coefficient: editions of one maker's formula of a bath differ by 3.6",
    )

    @property
    def damping(self) -> float:
        """Torque for the square of the cage's speed [N m s2]."""
        self.check_given()
        area = self.rollers * self.roller_length * self.roller_diameter
        mist = self.factor * self.coefficient * self.oil_fraction * self.density
        return mist * area * (self.orbit_radius * self.orbit_radius * self.orbit_radius) / 2

    def torque(self, cage_speed: float, inner_speed: float, outer_speed: float) -> float:
        """Return the torque on the cage [N m]; speeds in rad/s."""
        return -self.damping * abs(cage_speed) * cage_speed

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.churning(self.damping)


@attrs.frozen(kw_only=True)
class CoulombPocket(PocketFriction):
    """Friction of a roller in its pocket in proportion to the force there: M = mu_p |P| r against the spin.

    Symbols:

    - M: moment on the roller [N m]
    - mu_p: friction coefficient (``coefficient``); 0.1 is that of oiled metal without a film (D) [1]
    - P: normal force between roller and cage [N]
    - r: radius of the roller [m]

    Range: a pocket without a film of oil, which would lower mu_p by far.

    Examples
    --------
    A force of 50 N on a roller of 15 mm: 0.1 50 0.0075 N m.

    >>> round(CoulombPocket().coefficient * 50.0 * 0.0075, 12)
    0.0375
    """

    name: ClassVar[str] = "pocket-friction"
    equation: ClassVar[str] = "M = mu_p |P| r"
    references: ClassVar[tuple[Reference, ...]] = (HARRIS_2007,)

    coefficient: float = parameter(
        default=0.1, unit="1", doc="friction coefficient mu_p", usual=(0, 0.3), possible=(0, 1)
    )
