"""Rings that yield: an annulus with its housing or shaft, a thin ring in its seat, and any by a compliance matrix.

- Shapes are Fourier terms of the raceway's radial displacement; n = 1 is where a ring stands, and is none of them
  unless a seat holds it.
- Masses are those of the static displacement (Rayleigh): they count in plane motion alone.
- Beyond some n a shape counts again what the law of contact holds: that begins where lobes are as short as the pitch.
"""

import functools
import math
from typing import Any, ClassVar, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.datasets import Bearing, Mounting
from rollslip.fields import FieldError, at_least, field, in_range, non_negative, parameter, positive
from rollslip.files import named_text
from rollslip.references import Reference
from rollslip.rings import RingModel, RingShapes, Stops
from rollslip_plugins.bibliography import BARBER_1978, TIMOSHENKO_1956, TIMOSHENKO_GOODIER_1970

Floats = NDArray[np.float64]

#: Where a shaft is solid or a housing thick: radius over that of the seat beyond which nothing changes.
_FAR: Final = 1e3
#: Radius over that of the raceway beyond which a housing's mass is not counted, see `mass_of_annulus`.
_HEAVY: Final = 2.0
#: Shear: 1/(5/6) of a rectangular section.
_SHEAR: Final = 1.2
#: Stops round a seat with clearance.
_STOPS: Final = 72
#: Compliance, of the largest, below which a shape of a matrix is left out, or not positive where it is negative.
_STIFF: Final = 1e-6


Layers = tuple[tuple[float, float, float, float], ...]


def _rows(n: int, r: Any, modulus: float, nu: float) -> tuple[list[list[Any]], list[list[Any]]]:
    """Stresses and displacements on circles, radial and along them, of each power."""
    if n == 0:  # s = A + B/r^2, E u = (1 - nu) A r - (1 + nu) B/r
        return [[1.0, r**-2]], [[(1.0 - nu) * r / modulus, -(1.0 + nu) / r / modulus]]
    powers = (n, n + 2, -n, 2 - n)
    stress = [
        [(p - n * n) * r ** (p - 2) for p in powers],
        [n * (p - 1) * r ** (p - 2) for p in powers],
    ]
    radial = [((p - n * n) / (p - 1) - nu * p) * r ** (p - 1) / modulus for p in powers]
    along = [
        (p * (p - 1) + nu * n * n - (p - n * n) / (p - 1)) * r ** (p - 1) / (n * modulus)
        for p in powers
    ]
    return stress, [radial, along]


def _annulus(n: int, layers: Layers) -> Floats:
    """Coefficients of the powers in each layer under a unit load, lengths in the first radius, moduli in the first."""
    R = layers[0][0]
    E0 = layers[0][2]
    many = 2 if n == 0 else 4
    each = 1 if n == 0 else 2
    faces = len(layers)
    A = np.zeros((many * faces, many * faces))
    load = np.zeros(many * faces)
    at = 0
    for k, (near, far, modulus, nu) in enumerate(layers):
        own = slice(many * k, many * (k + 1))
        for r, first, last in ((near / R, k == 0, False), (far / R, False, k == faces - 1)):
            stress, moved = _rows(n, r, modulus / E0, nu)
            if first or last:
                A[at : at + each, own] = stress
                load[at] = -1.0 if first else 0.0
                at += each
            else:  # what leaves a layer enters the next
                A[at : at + 2 * each, own] = np.array(stress + moved) * (
                    1.0 if r == far / R else -1.0
                )
                at += 2 * each * (r == near / R)
    scale = np.abs(A).max(axis=0)
    return np.asarray((np.linalg.solve(A / scale, load) / scale).reshape(faces, many))


def compliance_of_annulus(n: int, layers: Layers, width: float) -> float:
    """Return radial displacement [m2/N] of an annulus per load of the arc, both cos(n psi) on one face.

    Layers (near radius, far radius, E, nu) do not part; the first is loaded at its near one
    radius, and others follow outwards or inwards. Plane stress; n = 0 is Lame's, others Michell's
    (Airy's function r^p cos(n psi), p = n, n + 2, -n, 2 - n).
    """
    radial = np.array(_rows(n, 1.0, 1.0, layers[0][3])[1][0]) @ _annulus(n, layers)[0]
    outward = 1.0 if layers[0][1] > layers[0][0] else -1.0
    return float(outward * radial * layers[0][0] / (layers[0][2] * width))


@functools.cache
def _gauss() -> tuple[Floats, Floats]:
    return np.polynomial.legendre.leggauss(48)


@functools.lru_cache(
    maxsize=1024
)  # ten times the compliance's time, and asked for at every point of a sweep
def mass_of_annulus(n: int, layers: Layers, width: float, densities: tuple[float, ...]) -> float:
    """Return what an annulus weighs [kg] in its displacement under a load cos(n psi), 1 on the loaded face.

    int rho (u^2 + v^2) dV over u^2 there. Nothing counts beyond twice the loaded radius: a thick housing yields with
    1/r for n = 0 and 2, by which its mass would have no bound, while waves leave with what is stored so far out (D).
    """
    R = layers[0][0]
    E0 = layers[0][2]
    found = 0.0
    node, weight = _gauss()
    coefficients = _annulus(n, layers)
    for (near, far, modulus, nu), density, own in zip(layers, densities, coefficients, strict=True):
        low = np.log(min(near / R, _HEAVY))
        high = np.log(min(far / R, _HEAVY))
        r = np.exp(0.5 * (low + high) + 0.5 * (high - low) * node)
        squares = sum((own @ np.array(row)) ** 2 for row in _rows(n, r, modulus / E0, nu)[1])
        found += density * 0.5 * abs(high - low) * float(weight @ (r * r * squares))
    face = np.array(_rows(n, 1.0, 1.0, layers[0][3])[1][0]) @ coefficients[0]
    return (math.pi if n else 2.0 * math.pi) * width * R * R * found / float(face) ** 2


def modal(
    radius: float, stiffness: dict[int, float], mass: dict[int, float] | None = None, **more: Any
) -> RingShapes:
    """Return shapes cos n psi and sin n psi of a load per arc and displacement k_n [N/m2], and their masses [kg].

    K_0 = 2 pi R k_0, K_n = pi R k_n.
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


def numbers(bearing: Bearing, highest: int | None) -> list[int]:
    """Return n of the shapes but 1: up to that which is asked for, or half the rollers."""
    return [
        n
        for n in range((max(2, bearing.rollers // 2) if highest is None else highest) + 1)
        if n != 1
    ]


def _size(doc: str, **more: Any) -> Any:
    return parameter(
        default=None, unit="m", doc=doc, validator=attrs.validators.optional(positive), usual=(1e-3, 5),
        possible=(1e-5, 100), **more,
    )  # fmt: skip


def _modulus(of: str) -> Any:
    return parameter(
        default=None, unit="Pa", doc=f"Young's modulus of {of}, by default that of bearing.mounting, or of the rings",
        validator=attrs.validators.optional(positive), usual=(1e9, 500e9), possible=(1e3, 2e12),
    )  # fmt: skip


def _damping() -> Any:
    return parameter(
        default=0.02, unit="1",
        doc="damping of the shapes in plane motion, of the critical one: 0.001 of bare steel to 0.05 in seats (D)",
        validator=in_range(0, 1), usual=(0, 0.2),
    )  # fmt: skip


def _highest() -> Any:
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
    yields: ClassVar[bool] = False
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
        default=None, unit="m", doc="bore of the shaft of an inner ring; by default that of bearing.mounting, or solid",
        validator=attrs.validators.optional(non_negative), usual=(0, 5), possible=(0, 100),
    )  # fmt: skip
    width: float | None = _size(
        "width of ring and seat; by default that of the catalogue, or 1.8 times the rollers (D)"
    )
    modulus: float | None = _modulus("housing or shaft")
    poisson_ratio: float | None = parameter(
        default=None, unit="1", doc="Poisson's ratio of housing or shaft, by default as the modulus",
        validator=attrs.validators.optional(in_range(0, 0.5)),
    )  # fmt: skip
    density: float | None = parameter(
        default=None, unit="kg/m3", doc="density of housing or shaft, by default as the modulus",
        validator=attrs.validators.optional(positive), usual=(1000, 9000), possible=(1e-12, 25e3),
    )  # fmt: skip
    damping_ratio: float = _damping()
    harmonics: int | None = _highest()

    def layers(self, bearing: Bearing, ring: str) -> tuple[tuple[float, float, float, float], ...]:
        """Return near and far radius [m], E [Pa] and nu of the ring and of what it sits on, if that is anything."""
        steel = bearing.material_of(ring)
        mounting = bearing.mounting or Mounting()
        d, D = bearing.boundaries
        if ring == "outer":
            if self.bore is not None:
                raise FieldError(
                    "bore", "is that of a shaft, of the inner ring; give 'outside' of the housing"
                )
            raceway = bearing.outer_raceway_diameter
            seat = D
            other = mounting.housing_material or steel
            beyond = self.outside or mounting.housing_outside_diameter or _FAR * D
            if beyond < D * (1.0 - 1e-9):
                raise FieldError(
                    "outside", f"must be at least the ring's own, {D:.4g} m, not {beyond:.4g} m"
                )
        else:
            if self.outside is not None:
                raise FieldError(
                    "outside", "is that of a housing, of the outer ring; give 'bore' of the shaft"
                )
            raceway = bearing.inner_raceway_diameter
            seat = d
            other = mounting.shaft_material or steel
            beyond = mounting.shaft_bore if self.bore is None else self.bore
            if beyond > d * (1.0 + 1e-9):
                raise FieldError(
                    "bore", f"must be at most the ring's own, {d:.4g} m, not {beyond:.4g} m"
                )
            beyond = max(beyond, d / _FAR)
        own = (raceway / 2.0, seat / 2.0, steel.elastic_modulus, steel.poisson_ratio)
        if abs(beyond - seat) <= 1e-9 * seat:
            return (own,)
        nu = other.poisson_ratio if self.poisson_ratio is None else self.poisson_ratio
        return own, (seat / 2.0, beyond / 2.0, self.modulus or other.elastic_modulus, nu)

    def shapes(self, bearing: Bearing, ring: str, turns: bool) -> RingShapes:
        """Return cosines and sines of the numbers n."""
        layers = self.layers(bearing, ring)
        width = self.width or bearing.width
        m = bearing.mounting or Mounting()
        own = bearing.material_of(ring)
        other = (m.housing_material if ring == "outer" else m.shaft_material) or own
        densities = (own.density, self.density or other.density)[: len(layers)]
        k = {
            n: 1.0 / compliance_of_annulus(n, layers, width)
            for n in numbers(bearing, self.harmonics)
        }
        mass = {n: mass_of_annulus(n, layers, width, densities) for n in k}
        seat = {"outside": m.housing_outside_diameter, "bore": m.shaft_bore,
                "modulus": other.elastic_modulus, "poisson_ratio": other.poisson_ratio}  # fmt: skip
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
    """Return load of the arc per radial displacement of a thin free ring [N/m2], n = 0 or from 2 on."""
    if n == 0:
        return modulus * area / radius**2
    soft = inertia / (area * radius**2) * (2.0 * (1.0 + nu) * _SHEAR * n * n - 1.0)
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
        default=None, doc="moment of inertia of the section; by default width times thickness^3/12",
        validator=attrs.validators.optional(positive), unit="m4", possible=(1e-20, 1.0),
    )  # fmt: skip
    seat_stiffness: float = parameter(
        default=0.0, unit="Pa", doc="load of the arc per displacement of the seat", validator=non_negative,
        usual=(0, 1e12), possible=(0, 1e15),
    )  # fmt: skip
    fit_clearance: float | None = parameter(
        default=None, unit="m", doc="play of the ring in its seat, of diameters; by default they do not part",
        validator=attrs.validators.optional(non_negative), usual=(0, 3e-4), possible=(0, 1e-2),
    )  # fmt: skip
    forces: tuple[ToothForce, ...] = parameter(default=(), doc="forces of teeth on the rim")
    damping_ratio: float = _damping()
    harmonics: int | None = _highest()

    def shapes(self, bearing: Bearing, ring: str, turns: bool) -> RingShapes:
        """Return cosines and sines of the numbers n; with a seat n = 1 is among them."""
        d, D = bearing.boundaries
        raceway, seat = (
            (bearing.outer_raceway_diameter, D)
            if ring == "outer"
            else (bearing.inner_raceway_diameter, d)
        )
        h = self.thickness or abs(raceway - seat) / 2.0
        width = self.width or bearing.width
        R = raceway / 2.0 + (0.5 if ring == "outer" else -0.5) * h
        if h / 2.0 >= R:
            raise FieldError(
                "thickness", f"{h:.4g} m leaves no bore of a raceway of {raceway:.4g} m"
            )
        area = width * h
        inertia = self.section_inertia or width * h**3 / 12.0
        steel = bearing.material_of(ring)
        loose = self.fit_clearance is not None
        if loose and not self.seat_stiffness > 0.0:
            raise FieldError(
                "seat_stiffness",
                "must be above 0 with a fit_clearance: nothing else stops the ring",
            )
        support = 0.0 if loose else self.seat_stiffness
        chosen = numbers(bearing, self.harmonics)
        k = {
            n: support
            + beam_stiffness(n, R, area, inertia, steel.elastic_modulus, steel.poisson_ratio)
            for n in chosen
        }
        if self.seat_stiffness > 0.0:
            k = {n: k[n] if n != 1 else support for n in sorted((*k, 1))}
        pushes = sum(
            (self._push(list(k), one, R, ring) for one in self.forces),
            np.zeros(sum(2 if n else 1 for n in k)),
        )
        stops = None
        if self.fit_clearance is not None:
            angles = 2.0 * math.pi / _STOPS * np.arange(_STOPS, dtype=float)
            stops = Stops(
                angles, self.seat_stiffness * R * 2.0 * math.pi / _STOPS, 0.5 * self.fit_clearance
            )
        around = math.pi * steel.density * area * R
        mass = {n: around * (1.0 + 1.0 / (n * n) if n else 2.0) for n in k}
        return modal(R, k, mass, pushes=pushes, stops=stops, damping_ratio=self.damping_ratio)

    @staticmethod
    def _push(numbers: list[int], force: ToothForce, radius: float, ring: str) -> Floats:
        """Work of a force on each shape; v' = -w, and a section turns by (v - w')/R."""
        found = list[float]()
        W = force.radial * (1.0 if ring == "outer" else -1.0)
        T = force.tangential
        arm = force.arm
        for n in numbers:
            c = math.cos(n * force.angle)
            s = math.sin(n * force.angle)
            for w, v, slope in (
                ((c, -s / n, -n * s), (s, c / n, n * c)) if n else ((1.0, 0.0, 0.0),)
            ):
                found.append(W * w + T * (v + arm * (v - slope) / radius))
        return np.array(found)


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
        default=None, unit="kg", doc="mass that moves with the ring, even all round, for plane motion",
        validator=attrs.validators.optional(positive), usual=(1e-3, 1e4), possible=(1e-9, 1e9),
    )  # fmt: skip
    damping_ratio: float = _damping()

    def matrix(self) -> Floats:
        """Return the matrix, made symmetric."""
        rows = [
            line.split(",")
            for line in named_text(self.file).splitlines()
            if line.strip() and line.strip()[0] != "#"
        ]
        try:
            C = np.array([[float(cell) for cell in row] for row in rows])
        except ValueError as error:
            raise FieldError(
                "file", f"{self.file}: rows of N numbers are expected, N times: {error}"
            ) from None
        if C.ndim != 2 or C.shape[0] != C.shape[1] or len(C) < 8:
            raise FieldError(
                "file", f"{self.file}: a square matrix of 8 rows or more is expected, not {C.shape}"
            )
        largest = np.abs(C).max()
        if not 0.0 < largest < math.inf or np.abs(C - C.T).max() > 1e-3 * largest:
            raise FieldError(
                "file",
                f"{self.file}: must be finite and symmetric, for work to be the same both ways (Maxwell)",
            )
        return np.asarray(0.5 * (C + C.T))

    def shapes(self, bearing: Bearing, ring: str, turns: bool) -> RingShapes:
        """Return the eigenvectors of what Fourier terms leave of the matrix."""
        if turns:
            raise FieldError(
                "model",
                "a matrix stands in the line of load, but this ring turns: take 'annulus' or 'thin'",
            )
        C = self.matrix()
        N = len(C)
        values = np.linalg.eigvalsh(C)
        if values[0] < -_STIFF * values[-1]:
            raise FieldError(
                "file",
                f"{self.file}: is not positive: forces would draw work from the ring (eigenvalue {values[0]:.3g} of "
                f"{values[-1]:.3g} m/N); check signs, and that w and F both point away from the rollers",
            )
        highest = min((N - 1) // 2, max(2, bearing.rollers // 2))
        angles = 2.0 * math.pi / N * np.arange(N)
        waves = [
            (n, phase) for n in range(highest + 1) for phase in ((1.0, -1.0j) if n else (1.0,))
        ]
        basis = np.array([np.real(phase * np.exp(1j * n * angles)) for n, phase in waves]).T
        size = np.sqrt((basis**2).sum(axis=0))
        weight = size  # by what shapes are orthogonal: each other, or their masses
        if self.mass is not None:
            weight = np.sqrt([self.mass * (0.5 + 0.5 / n**2 if n else 1.0) for n, _ in waves])
        part = basis * (weight / size**2)
        values, vectors = np.linalg.eigh(part.T @ C @ part)
        kept = values > _STIFF * values[-1]
        harmonics = np.zeros((kept.sum(), highest + 1), complex)
        for (n, phase), row, norm in zip(waves, vectors[:, kept], weight, strict=True):
            harmonics[:, n] += phase * row / norm
        if self.mass is None:
            return RingShapes(harmonics, 1.0 / values[kept])
        largest = np.abs(harmonics).max(axis=1)  # an amplitude of 1 m, not of 1 m kg^0.5
        return RingShapes(
            harmonics / largest[:, None], 1.0 / (values[kept] * largest**2), mass=largest**-2,
            damping_ratio=self.damping_ratio,
        )  # fmt: skip
