"""Flexible rings: an annulus with its housing or shaft, a thin ring in its seat, and any ring by a compliance matrix.

- Shapes are Fourier terms of the radial displacement of the raceway. The term n = 1 is the position of a ring, which is
  not a shape unless a seat holds the ring.
- Masses are those of the static displacement (Rayleigh's method): they count in plane motion alone.
- From some n on a shape repeats the deflection of the contact law: where its lobes are as short as the roller pitch.
"""

import functools
import math
from typing import Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.fields import (
    FieldError,
    at_least,
    field,
    in_range,
    non_negative,
    parameter,
    positive,
    refuse_if,
)
from rollslip.files import named_text
from rollslip.geometry.bearing import Bearing, Mounting
from rollslip.references import Reference
from rollslip.rings import RingModel, RingShapes, Stops
from rollslip.search import Array
from rollslip_plugins.bibliography import BARBER_1978, TIMOSHENKO_1956, TIMOSHENKO_GOODIER_1970

#: Ratio of radii that stands for a solid shaft or an unbounded housing: the compliance changes by 1e-6 at most with a
#: larger one.
_UNBOUNDED_RATIO: Final = 1e3
#: Ratio of a radius to that of the raceway beyond which mass does not count, see `mass_of_annulus`. Doubling it adds
#: mass of a thick housing that is not accelerated at the frequencies of interest (D).
_MASS_RATIO: Final = 2.0
#: Shear factor of a rectangular section: 1/(5/6) (Timoshenko).
_SHEAR_FACTOR: Final = 1.2
#: Number of springs round a seat with clearance. Halving it makes the support uneven between shapes of high n. Chosen.
_STOPS: Final = 72
#: Compliance of a shape, relative to the largest, below which the shape of a matrix is omitted; a negative compliance
#: beyond it is refused. Chosen: above the rounding of printed matrices.
_MIN_COMPLIANCE: Final = 1e-6
#: Number of Gauss-Legendre nodes of the mass of an annulus: powers up to n = 50 are integrated to 1e-10.
_GAUSS_NODES: Final = 48
#: Minimum number of rows of a compliance matrix: with fewer, n = 2 has hardly four points for a wave. Chosen.
_MIN_ROWS: Final = 8
#: Largest asymmetry of a compliance matrix, relative to its largest entry. Chosen: four printed digits.
_MAX_ASYMMETRY: Final = 1e-3

#: Near radius [m], far radius [m], Young's modulus [Pa] and Poisson's ratio of each layer of an annulus.
Layers = tuple[tuple[float, float, float, float], ...]


def _rows(n: int, r: Any, modulus: float, nu: float) -> tuple[list[list[Any]], list[list[Any]]]:
    """Return stresses and displacements on a circle of radius r, radial and tangential, for each power of r."""
    if n == 0:  # s = A + B/r^2, E u = (1 - nu) A r - (1 + nu) B/r
        return [[1.0, r**-2]], [[(1.0 - nu) * r / modulus, -(1.0 + nu) / r / modulus]]
    powers = (n, n + 2, -n, 2 - n)
    stress = [
        [(p - n * n) * r ** (p - 2) for p in powers],
        [n * (p - 1) * r ** (p - 2) for p in powers],
    ]
    return stress, [
        [((p - n * n) / (p - 1) - nu * p) * r ** (p - 1) / modulus for p in powers],
        [
            (p * (p - 1) + nu * n * n - (p - n * n) / (p - 1)) * r ** (p - 1) / (n * modulus)
            for p in powers
        ],
    ]


def _annulus(n: int, layers: Layers) -> Array:
    """Return the coefficients of the powers in each layer under a unit load, (layers, powers).

    Lengths are relative to the loaded radius, moduli to that of the first layer. The linear system has the boundary
    conditions on both free faces, and equal stresses and displacements of both layers on each face between them.
    """
    R = layers[0][0]
    E0 = layers[0][2]
    powers = 2 if n == 0 else 4
    conditions = 1 if n == 0 else 2
    faces = len(layers)
    A = np.zeros((powers * faces, powers * faces))
    load = np.zeros(powers * faces)
    row = 0
    for k, (near, far, modulus, nu) in enumerate(layers):
        columns = slice(powers * k, powers * (k + 1))
        for r, first, last in ((near / R, k == 0, False), (far / R, False, k == faces - 1)):
            stress, displacement = _rows(n, r, modulus / E0, nu)
            if first or last:
                A[row : row + conditions, columns] = stress
                load[row] = -1.0 if first else 0.0
                row += conditions
            else:
                sign = 1.0 if r == far / R else -1.0
                A[row : row + 2 * conditions, columns] = np.array(stress + displacement) * sign
                row += 2 * conditions * (r == near / R)
    scale = np.abs(A).max(axis=0)
    return np.asarray((np.linalg.solve(A / scale, load) / scale).reshape(faces, powers))


def compliance_of_annulus(n: int, layers: Layers, width: float) -> float:
    """Return the radial displacement of an annulus per load of the arc [m2/N], both cos(n psi) on one face.

    Plane stress: n = 0 is Lame's solution, others are Michell's (Airy's function r^p cos(n psi), p = n, n + 2, -n,
    2 - n).

    Parameters
    ----------
    n : int
        Number of waves.
    layers : tuple of tuples
        Near radius [m], far radius [m], Young's modulus [Pa] and Poisson's ratio of each layer. The first one is loaded
        at its near radius; others follow outwards or inwards without a gap.
    width : float
        Width of the annulus [m].
    """
    radial = np.array(_rows(n, 1.0, 1.0, layers[0][3])[1][0]) @ _annulus(n, layers)[0]
    outward = 1.0 if layers[0][1] > layers[0][0] else -1.0
    return float(outward * radial * layers[0][0] / (layers[0][2] * width))


@functools.cache
def _gauss() -> tuple[Array, Array]:
    """Return nodes and weights of Gauss-Legendre quadrature from -1 to 1."""
    return np.polynomial.legendre.leggauss(_GAUSS_NODES)


# cached, since it takes ten times as long as the compliance and is needed at every point of a sweep
@functools.lru_cache(maxsize=1024)
def mass_of_annulus(n: int, layers: Layers, width: float, densities: tuple[float, ...]) -> float:
    """Return the mass of an annulus in its displacement under a load cos(n psi) [kg], 1 on the loaded face.

    It is int rho (u^2 + v^2) dV over u^2 on that face. Mass beyond twice the loaded radius does not count: the
    displacement of a thick housing decreases as 1/r for n = 0 and 2, so that its mass would have no bound, while waves
    carry away the energy so far out (D).

    Parameters
    ----------
    n, layers, width
        As in `compliance_of_annulus`.
    densities : tuple of float
        Density of each layer [kg/m3].
    """
    R = layers[0][0]
    E0 = layers[0][2]
    integral = 0.0
    node, weight = _gauss()
    coefficients = _annulus(n, layers)
    for (near, far, modulus, nu), density, row in zip(layers, densities, coefficients, strict=True):
        low = np.log(min(near / R, _MASS_RATIO))
        high = np.log(min(far / R, _MASS_RATIO))
        r = np.exp(0.5 * (low + high) + 0.5 * (high - low) * node)
        displacements = _rows(n, r, modulus / E0, nu)[1]
        squares = sum((row @ np.array(displacement)) ** 2 for displacement in displacements)
        integral += density * 0.5 * abs(high - low) * float(weight @ (r * r * squares))
    face = np.array(_rows(n, 1.0, 1.0, layers[0][3])[1][0]) @ coefficients[0]
    return (math.pi if n else 2.0 * math.pi) * width * R * R * integral / float(face) ** 2


def modal(
    radius: float, stiffness: dict[int, float], mass: dict[int, float] | None = None, **more: Any
) -> RingShapes:
    """Return the shapes cos n psi and sin n psi of a ring, with the stiffnesses K_0 = 2 pi R k_0, K_n = pi R k_n.

    Parameters
    ----------
    radius : float
        Radius R of the raceway or the middle of the ring [m].
    stiffness : dict
        Load of the arc per displacement k_n [N/m2] by n.
    mass : dict, optional
        Mass of each shape [kg] by n; without it there is no plane motion.
    **more
        Other fields of `RingShapes`.
    """
    rows = list[list[complex]]()
    modal_stiffness = list[float]()
    for n, k in stiffness.items():
        for phase in (1.0, -1.0j) if n else (1.0,):
            rows.append([phase if i == n else 0.0 for i in range(max(stiffness) + 1)])
            modal_stiffness.append(math.pi * radius * k * (1.0 if n else 2.0))
    if mass is not None:
        more["mass"] = np.array([mass[n] for n in stiffness for _ in ((1, -1) if n else (1,))])
    return RingShapes(np.array(rows, complex), np.array(modal_stiffness), **more)


def wave_numbers(bearing: Bearing, highest: int | None) -> list[int]:
    """Return the numbers n of the shapes, without 1.

    Parameters
    ----------
    bearing : Bearing
        The bearing.
    highest : int or None
        Highest number; None for half the rollers.
    """
    if highest is None:
        highest = max(2, bearing.rollers // 2)
    return [n for n in range(highest + 1) if n != 1]


def _size(doc: str, **more: Any) -> Any:
    """Return an optional parameter for a length."""
    return parameter(
        default=None,
        unit="m",
        doc=doc,
        validator=attrs.validators.optional(positive),
        usual=(1e-3, 5),
        possible=(1e-5, 100),
        **more,
    )


def _damping() -> Any:
    """Return the parameter for the damping ratio."""
    return parameter(
        default=0.02,
        unit="1",
        doc="damping of the shapes in plane motion, of the critical one: 0.001 of bare steel to 0.05 in seats (D)",
        validator=in_range(0, 1),
        usual=(0, 0.2),
    )


def _highest() -> Any:
    """Return the parameter for the highest number of waves."""
    return parameter(
        default=None,
        doc="highest n of a shape, by default half the rollers; what accuracy.tolerance can do without is left out",
        validator=attrs.validators.optional(at_least(0)),
        usual=(0, 20),
        possible=(0, 100),
    )


@attrs.frozen(kw_only=True)
class Rigid(RingModel):
    """A ring that keeps its shape.

    w = 0.

    Symbols:

    - w: displacement of the raceway [m]

    Range: play, or a load that bends the ring by less than the contacts yield; a preload is too large with it.

    Examples
    --------
    >>> Rigid().shapes(None, "outer", False).stiffness.size
    0
    """

    name: ClassVar[str] = "rigid"
    is_flexible: ClassVar[bool] = False
    equation: ClassVar[str] = "w = 0"
    references: ClassVar[tuple[Reference, ...]] = (
        Reference(kind="remark", title="No law: the ring keeps its shape."),
    )

    def shapes(self, bearing: Bearing, ring: str, turns: bool) -> RingShapes:
        """Return none."""
        return RingShapes()


@attrs.frozen(kw_only=True)
class Annulus(RingModel):
    """A ring and its housing or shaft that do not part: an annulus of two layers in plane stress.

    w_n = c_n p_n, phi = sum c r^p cos(n psi), p = n, n + 2, -n, 2 - n (n = 0: Lame).

    Symbols:

    - w_n, p_n: displacement of the raceway [m] and load per arc [N/m], both cos(n psi)
    - c_n: compliance by Airy's function phi of both layers [m2/N]; E, nu of the ring are those of the bearing,
      those of housing or shaft ``modulus`` and ``poisson_ratio``
    - n: up to ``harmonics``; n = 1 is where the ring stands
    - mass of a shape: int rho (u^2 + v^2) dV of its displacement, 1 at the raceway, out to twice its radius (D)
    - outer ring: raceway, seat D, outside of the housing (``outside``); inner ring: raceway, bore d, bore of the shaft
      (``bore``); both ``width`` wide; state them in ``bearing.mounting`` where fits leave less of the clearance by them

    Range: any thickness, a tight seat, one temperature. Ribs stiffen a thin ring in bending and are not in it; load is
    even across the width.

    Examples
    --------
    >>> Annulus(harmonics=0).name
    'annulus'
    """

    name: ClassVar[str] = "annulus"
    equation: ClassVar[str] = "w_n = c_n p_n, phi = sum c r^p cos(n psi), p = n, n + 2, -n, 2 - n"
    references: ClassVar[tuple[Reference, ...]] = (TIMOSHENKO_GOODIER_1970,)

    outside: float | None = _size(
        "outside diameter of the housing of an outer ring; by default that of bearing.mounting, or thick"
    )
    bore: float | None = parameter(
        default=None,
        unit="m",
        doc="bore of the shaft of an inner ring; by default that of bearing.mounting, or solid",
        validator=attrs.validators.optional(non_negative),
        usual=(0, 5),
        possible=(0, 100),
    )
    width: float | None = _size(
        "width of ring and seat; by default that of the catalogue, or 1.8 times the rollers (D)"
    )
    modulus: float | None = parameter(
        default=None,
        unit="Pa",
        doc="Young's modulus of housing or shaft, by default that of bearing.mounting, or of the rings",
        validator=attrs.validators.optional(positive),
        usual=(1e9, 500e9),
        possible=(1e3, 2e12),
    )
    poisson_ratio: float | None = parameter(
        default=None,
        unit="1",
        doc="Poisson's ratio of housing or shaft, by default as the modulus",
        validator=attrs.validators.optional(in_range(0, 0.5)),
    )
    density: float | None = parameter(
        default=None,
        unit="kg/m3",
        doc="density of housing or shaft, by default as the modulus",
        validator=attrs.validators.optional(positive),
        usual=(1000, 9000),
        possible=(1e-12, 25e3),
    )
    damping_ratio: float = _damping()
    harmonics: int | None = _highest()

    def layers(self, bearing: Bearing, ring: str) -> tuple[tuple[float, float, float, float], ...]:
        """Return near and far radius [m], E [Pa] and nu of the ring and of its housing or shaft, if there is one.

        Parameters
        ----------
        bearing : Bearing
            The bearing.
        ring : str
            "inner" or "outer".
        """
        steel = bearing.material_of(ring)
        mounting = bearing.mounting or Mounting()
        d, D = bearing.boundaries
        if ring == "outer":
            refuse_if(
                self.bore is not None,
                "bore",
                "is that of a shaft, of the inner ring; give 'outside' of the housing",
            )
            raceway = bearing.outer_raceway_diameter
            seat = D
            other = mounting.housing_material or steel
            beyond = self.outside or mounting.housing_outside_diameter or _UNBOUNDED_RATIO * D
            refuse_if(
                beyond < D * (1.0 - 1e-9),
                "outside",
                f"must be at least the ring's own, {D:.4g} m, not {beyond:.4g} m",
            )
        else:
            refuse_if(
                self.outside is not None,
                "outside",
                "is that of a housing, of the outer ring; give 'bore' of the shaft",
            )
            raceway = bearing.inner_raceway_diameter
            seat = d
            other = mounting.shaft_material or steel
            beyond = mounting.shaft_bore if self.bore is None else self.bore
            refuse_if(
                beyond > d * (1.0 + 1e-9),
                "bore",
                f"must be at most the ring's own, {d:.4g} m, not {beyond:.4g} m",
            )
            beyond = max(beyond, d / _UNBOUNDED_RATIO)
        own = (raceway / 2.0, seat / 2.0, steel.elastic_modulus, steel.poisson_ratio)
        if abs(beyond - seat) <= 1e-9 * seat:
            return (own,)
        nu = other.poisson_ratio if self.poisson_ratio is None else self.poisson_ratio
        return own, (seat / 2.0, beyond / 2.0, self.modulus or other.elastic_modulus, nu)

    def shapes(self, bearing: Bearing, ring: str, turns: bool) -> RingShapes:
        """Return a cosine and a sine for each number n; see `RingModel.shapes`."""
        layers = self.layers(bearing, ring)
        width = self.width or bearing.width
        m = bearing.mounting or Mounting()
        own = bearing.material_of(ring)
        other = (m.housing_material if ring == "outer" else m.shaft_material) or own
        densities = (own.density, self.density or other.density)[: len(layers)]
        k = {
            n: 1.0 / compliance_of_annulus(n, layers, width)
            for n in wave_numbers(bearing, self.harmonics)
        }
        mass = {n: mass_of_annulus(n, layers, width, densities) for n in k}
        seat = {
            "outside": m.housing_outside_diameter,
            "bore": m.shaft_bore,
            "modulus": other.elastic_modulus,
            "poisson_ratio": other.poisson_ratio,
        }
        departs = tuple(key for key, of in seat.items() if getattr(self, key) not in (None, of))
        return modal(layers[0][0], k, mass, damping_ratio=self.damping_ratio, departs=departs)


@attrs.frozen(kw_only=True)
class ToothForce:
    """A force on the rim of a planet."""

    angle: float = field(unit="rad", doc="where it acts, from the line of load")
    radial: float = field(default=0.0, unit="N", doc="outwards")
    tangential: float = field(default=0.0, unit="N", doc="towards larger angles")
    arm: float = field(default=0.0, unit="m", doc="how far outside the middle of the rim it acts")


def beam_stiffness(
    n: int, radius: float, area: float, inertia: float, modulus: float, nu: float
) -> float:
    """Return the load of the arc per radial displacement of a thin free ring [N/m2].

    Parameters
    ----------
    n : int
        Number of waves, 0 or from 2 on.
    radius : float
        Radius of the middle of the section [m].
    area, inertia : float
        Area [m2] and moment of inertia [m4] of the section.
    modulus, nu : float
        Young's modulus [Pa] and Poisson's ratio.
    """
    if n == 0:
        return modulus * area / radius**2
    soft = inertia / (area * radius**2) * (2.0 * (1.0 + nu) * _SHEAR_FACTOR * n * n - 1.0)
    return modulus * inertia * (n * n - 1) ** 2 / radius**4 / (1.0 + soft)


@attrs.frozen(kw_only=True)
class Thin(RingModel):
    """A thin ring, free, on an elastic seat, or in one with clearance; the rim of a planet.

    k_n = E I (n^2 - 1)^2/R^4/(1 + I/(A R^2) (2.4 (1 + nu) n^2 - 1)) + k_s, k_0 = E A/R^2 + k_s.

    Symbols:

    - k_n: load of the arc per displacement [N/m2], both cos(n psi); n up to ``harmonics``
    - R, A, I: radius of the middle [m], area [m2] and moment of inertia [m4] of the section: ``width`` by
      ``thickness``, or ``section_inertia`` where ribs stiffen it
    - E, nu: of the bearing's material
    - k_s: ``seat_stiffness``; with ``fit_clearance`` its springs push only where half of that is closed
    - mass of a shape: 2 pi rho A R of n = 0, pi rho A R (1 + 1/n^2) of others, which do not stretch; rho of the
      bearing's material
    - ``forces``: forces of teeth W outwards and T along the rim at the arm a push the shapes cos n psi by
      W cos - T (sin/n) - (T a/R)(sin/n - n sin)

    Range: thickness up to a tenth of R: 2 % of n = 8 there, 1 to 28 % at 0.3 R. A housing is no such seat: ``annulus``.

    Examples
    --------
    >>> Thin(thickness=0.01).name
    'thin'
    """

    name: ClassVar[str] = "thin"
    equation: ClassVar[str] = (
        "k_n = E I (n^2 - 1)^2/R^4/(1 + I/(A R^2) (2.4 (1 + nu) n^2 - 1)) + k_s"
    )
    references: ClassVar[tuple[Reference, ...]] = (TIMOSHENKO_1956, BARBER_1978)

    thickness: float | None = _size("radial thickness; by default from the raceway to the seat")
    width: float | None = _size(
        "width; by default that of the catalogue, or 1.8 times the rollers (D)"
    )
    section_inertia: float | None = parameter(
        default=None,
        doc="moment of inertia of the section; by default width times thickness^3/12",
        validator=attrs.validators.optional(positive),
        unit="m4",
        possible=(1e-20, 1.0),
    )
    seat_stiffness: float = parameter(
        default=0.0,
        unit="Pa",
        doc="load of the arc per displacement of the seat",
        validator=non_negative,
        usual=(0, 1e12),
        possible=(0, 1e15),
    )
    fit_clearance: float | None = parameter(
        default=None,
        unit="m",
        doc="play of the ring in its seat, of diameters; by default they do not part",
        validator=attrs.validators.optional(non_negative),
        usual=(0, 3e-4),
        possible=(0, 1e-2),
    )
    forces: tuple[ToothForce, ...] = parameter(default=(), doc="forces of teeth on the rim")
    damping_ratio: float = _damping()
    harmonics: int | None = _highest()

    def shapes(self, bearing: Bearing, ring: str, turns: bool) -> RingShapes:
        """Return a cosine and a sine for each number n, with a seat also n = 1; see `RingModel.shapes`."""
        R, width, h = self._section(bearing, ring)
        area = width * h
        inertia = self.section_inertia or width * h**3 / 12.0
        steel = bearing.material_of(ring)
        stops = self._stops(R)
        support = self.seat_stiffness if stops is None else 0.0
        k = {
            n: support
            + beam_stiffness(n, R, area, inertia, steel.elastic_modulus, steel.poisson_ratio)
            for n in wave_numbers(bearing, self.harmonics)
        }
        if self.seat_stiffness > 0.0:
            k = {n: k[n] if n != 1 else support for n in sorted((*k, 1))}
        pushes = sum(
            (self._push(list(k), force, R, ring) for force in self.forces),
            np.zeros(sum(2 if n else 1 for n in k)),
        )
        half_mass = math.pi * steel.density * area * R
        mass = {n: half_mass * (1.0 + 1.0 / (n * n) if n else 2.0) for n in k}
        return modal(R, k, mass, pushes=pushes, stops=stops, damping_ratio=self.damping_ratio)

    def _section(self, bearing: Bearing, ring: str) -> tuple[float, float, float]:
        """Return the radius of the middle, the width and the thickness of the section [m]."""
        d, D = bearing.boundaries
        if ring == "outer":
            raceway = bearing.outer_raceway_diameter
            h = self.thickness or abs(raceway - D) / 2.0
            R = raceway / 2.0 + 0.5 * h
        else:
            raceway = bearing.inner_raceway_diameter
            h = self.thickness or abs(raceway - d) / 2.0
            R = raceway / 2.0 - 0.5 * h
        refuse_if(
            h / 2.0 >= R, "thickness", f"{h:.4g} m leaves no bore of a raceway of {raceway:.4g} m"
        )
        return R, self.width or bearing.width, h

    def _stops(self, radius: float) -> Stops | None:
        """Return the springs of a seat with clearance; None for a seat without one."""
        if self.fit_clearance is None:
            return None
        refuse_if(
            not self.seat_stiffness > 0.0,
            "seat_stiffness",
            "must be above 0 with a fit_clearance: nothing else stops the ring",
        )
        return Stops(
            2.0 * math.pi / _STOPS * np.arange(_STOPS, dtype=float),
            self.seat_stiffness * radius * 2.0 * math.pi / _STOPS,
            0.5 * self.fit_clearance,
        )

    @staticmethod
    def _push(numbers: list[int], force: ToothForce, radius: float, ring: str) -> Array:
        """Return the generalised force on each shape; v' = -w, and a section turns by (v - w')/R."""
        generalised = list[float]()
        W = force.radial * (1.0 if ring == "outer" else -1.0)
        for n in numbers:
            c = math.cos(n * force.angle)
            s = math.sin(n * force.angle)
            for w, v, slope in (
                ((c, -s / n, -n * s), (s, c / n, n * c)) if n else ((1.0, 0.0, 0.0),)
            ):
                generalised.append(
                    W * w + force.tangential * (v + force.arm * (v - slope) / radius)
                )
        return np.array(generalised)


@attrs.frozen(kw_only=True)
class Compliance(RingModel):
    """Any ring by its compliance matrix, as a finite-element program gives it.

    w_i = sum C_ij F_j.

    Symbols:

    - w_i: displacement of the raceway at N equal angles from the line of load, away from the rollers [m]
    - F_j: forces of rollers there, away from them [N]
    - C_ij: compliance [m/N], the rows of ``file``; between the angles it is interpolated by Fourier terms up to half
      the rollers
    - ``mass``: m, of a shape with the Fourier terms c_n: m sum |c_n|^2 (1 + 1/n^2)/2, and m c_0^2 of n = 0; without it
      there is no plane motion

    Range: linear, and standing in the line of load. How the ring moves as a whole must be held by its housing, or taken
    out of the matrix.

    Examples
    --------
    >>> Compliance(file="/rings/planet.csv").name
    'compliance'
    """

    name: ClassVar[str] = "compliance"
    equation: ClassVar[str] = "w_i = sum C_ij F_j"
    references: ClassVar[tuple[Reference, ...]] = (
        Reference(kind="remark", title="The finite-element model that gave the matrix."),
    )

    file: str = parameter(
        doc="full path of a CSV file: N rows of N numbers [m/N] at equal angles, the first in the line of load"
    )
    mass: float | None = parameter(
        default=None,
        unit="kg",
        doc="mass that moves with the ring, even all round, for plane motion",
        validator=attrs.validators.optional(positive),
        usual=(1e-3, 1e4),
        possible=(1e-9, 1e9),
    )
    damping_ratio: float = _damping()

    def matrix(self) -> Array:
        """Return the symmetric part of the matrix of the file [m/N], (N, N)."""
        rows = [
            line.split(",")
            for line in named_text(self.file).splitlines()
            if line.strip() and line.strip()[0] != "#"
        ]
        try:
            C = np.array([list(map(float, row)) for row in rows])
        except ValueError as error:
            raise FieldError(
                "file", f"{self.file}: rows of N numbers are expected, N times: {error}"
            ) from None
        refuse_if(
            C.ndim != 2 or C.shape[0] != C.shape[1] or len(C) < _MIN_ROWS,
            "file",
            f"{self.file}: a square matrix of 8 rows or more is expected, not {C.shape}",
        )
        largest = np.abs(C).max()
        refuse_if(
            not 0.0 < largest < math.inf or np.abs(C - C.T).max() > _MAX_ASYMMETRY * largest,
            "file",
            f"{self.file}: must be finite and symmetric, for work to be the same both ways (Maxwell)",
        )
        return np.asarray(0.5 * (C + C.T))

    def shapes(self, bearing: Bearing, ring: str, turns: bool) -> RingShapes:
        """Return the eigenvectors of the matrix in a basis of Fourier terms; see `RingModel.shapes`."""
        refuse_if(
            turns,
            "model",
            "a matrix stands in the line of load, but this ring turns: take 'annulus' or 'thin'",
        )
        C = self.matrix()
        N = len(C)
        values = np.linalg.eigvalsh(C)
        refuse_if(
            values[0] < -_MIN_COMPLIANCE * values[-1],
            "file",
            (
                f"{self.file}: is not positive: forces would draw work from the ring (eigenvalue {values[0]:.3g} of "
                f"{values[-1]:.3g} m/N); check signs, and that w and F both point away from the rollers"
            ),
        )
        highest = min((N - 1) // 2, max(2, bearing.rollers // 2))
        angles = 2.0 * math.pi / N * np.arange(N)
        waves = [
            (n, phase) for n in range(highest + 1) for phase in ((1.0, -1.0j) if n else (1.0,))
        ]
        basis = np.array([np.real(phase * np.exp(1j * n * angles)) for n, phase in waves]).T
        size = np.sqrt((basis**2).sum(axis=0))
        weight = size  # shapes are orthogonal with respect to these weights, or to their masses
        if self.mass is not None:
            weight = np.sqrt([self.mass * (0.5 + 0.5 / n**2 if n else 1.0) for n, _ in waves])
        part = basis * (weight / size**2)
        values, vectors = np.linalg.eigh(part.T @ C @ part)
        flexible = values > _MIN_COMPLIANCE * values[-1]
        harmonics = np.zeros((flexible.sum(), highest + 1), complex)
        for (n, phase), row, norm in zip(waves, vectors[:, flexible], weight, strict=True):
            harmonics[:, n] += phase * row / norm
        if self.mass is None:
            return RingShapes(harmonics, 1.0 / values[flexible])
        largest = np.abs(harmonics).max(axis=1)  # an amplitude of 1 m, not of 1 m kg^0.5
        return RingShapes(
            harmonics / largest[:, None],
            1.0 / (values[flexible] * largest**2),
            mass=largest**-2,
            damping_ratio=self.damping_ratio,
        )
