"""Laws of viscosity under pressure: Barus's, Roelands's, and the free-volume law of Yasutomi, Bair and Winer.

Barus and Roelands take alpha and gamma of the oil; a free-volume law brings constants of its own. The oil says which
alpha it gives, the slope of ln(eta) at no pressure ("tangent") or alpha* = 1/integral(eta0/eta dp) of films ("film").
"""

import math
from collections.abc import Mapping
from functools import lru_cache
from types import MappingProxyType
from typing import ClassVar, Final

import attrs
import numpy as np
from numpy.typing import ArrayLike

from rollslip.errors import DomainError
from rollslip.fields import field, non_negative, positive
from rollslip.lubricant.pressure import PressureViscosity, alpha_of_oil, factor_of_oil
from rollslip.models import FINITE, NON_NEGATIVE, POSITIVE, Validity
from rollslip.references import BARUS, EHRET, ROELANDS, YASUTOMI, Reference
from rollslip.search import Array
from rollslip.units import format_quantity
from rollslip_kernels.slices import Conditions
from rollslip_kernels.stages import viscosity as compiled

#: Viscosity at which all isotherms of Roelands's law meet [Pa s]: 6.315e-5 (Roelands 1966).
POLE_VISCOSITY: Final = math.exp(-9.67)
#: Negative of the pressure at which all isotherms of Roelands's law meet [Pa]: 0.196 GPa (Roelands 1966).
POLE_PRESSURE: Final = 1 / 5.1e-9


def _above_roelands(pressure: float) -> float:
    """Return the excess of Barus's viscosity over Roelands's [%], for MIL-L-7808 at 50 degC: 8.58 mPa s, 10.74 /GPa."""
    k = math.log(8.58e-3 / POLE_VISCOSITY)
    rise = 10.74e-9 * pressure
    roelands = k * math.expm1(10.74e-9 * POLE_PRESSURE / k * math.log1p(pressure / POLE_PRESSURE))
    return 100.0 * math.expm1(min(rise - roelands, 700.0))


@attrs.frozen
class Barus(PressureViscosity):
    """Barus's law: eta = eta0 exp(alpha p), -dln(eta)/dT = beta0 + gamma p.

    alpha is the slope of ln(eta) at no pressure and alpha* of films alike: 1/integral(exp(-alpha p) dp) = alpha.

    Range: some 0.1 GPa; beyond it is too steep for most oils (at 0.4 GPa four times Roelands).
    """

    validity: ClassVar[tuple[Validity, ...]] = (
        Validity(
            code="W20",
            quantity="pressure",
            high=0.1e9,
            consequence="the viscosity is {error} above Roelands's (for 8.6 mPa s and an alpha of 10.7 /GPa)",
            error=_above_roelands,
            remedy="lubricant.pressure_viscosity_law = 'roelands', or 'yasutomi' with constants of the oil",
            replacement="roelands",
            source="Barus against Roelands at the same alpha; the range is that of most oils (C)",
        ),
    )
    factor: float = factor_of_oil()
    name: ClassVar[str] = "barus"
    equation: ClassVar[str] = "eta = eta0 exp(f alpha p)"
    references: ClassVar[tuple[Reference, ...]] = (BARUS,)
    reads = frozenset(
        {
            "pressure",
            "viscosity",
            "pressure_viscosity",
            "thermoviscosity",
            "pressure_thermoviscosity",
        }
    )
    domain = MappingProxyType(
        {
            "pressure": NON_NEGATIVE,
            "viscosity": POSITIVE,
            "pressure_viscosity": NON_NEGATIVE,
            "thermoviscosity": NON_NEGATIVE,
            "pressure_thermoviscosity": FINITE,
        }
    )

    def at(self, conditions: Conditions, pressure: ArrayLike) -> tuple[Array, Array]:
        """Return viscosity and its fall with temperature."""
        c = conditions
        p = np.asarray(pressure, dtype=float)
        return (
            c.viscosity * np.exp(self.factor * c.pressure_viscosity * p),
            c.thermoviscosity + self.factor * c.pressure_thermoviscosity * p,
        )

    def caution(self) -> str:
        """Say that it is too steep."""
        times = 1.0 + _above_roelands(0.4e9) / 100.0
        return (
            "viscosity under pressure follows Barus's law, as the scene names it: too steep above 0.1 GPa, so slip is "
            f"too small; at 0.4 GPa it gives an oil of 8.6 mPa s {times:.1f} times what the default, Roelands's, does"
        )

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.barus(self.factor)

    def log_kernel(self) -> object:
        """Return the compiled form of the logarithm."""
        return compiled.barus(self.factor, True)


def _gamma(s: Array, k: Array) -> tuple[Array, Array]:
    """Return G(s, k) = exp(k) k^-s Gamma(s, k), with the incomplete gamma function, and its slope over s.

    Legendre's continued fraction of 400 terms for s in (0, 1], from its end forwards, then the recurrence
    G(s + 1) = (s G(s) + 1)/k.
    """
    whole = np.ceil(s) - 1.0
    part = s - whole
    value = k + 801.0 - part
    slope = np.full_like(s, -1.0)
    for n in range(400, 0, -1):
        over = n * (n - part) / value
        slope = -1.0 + (n + over * slope) / value
        value = k + 2.0 * n - 1.0 - part - over
    slope = -slope / value**2
    value = 1.0 / value
    for turn in range(int(np.max(whole, initial=0.0))):
        left = turn < whole
        at = part + turn
        slope = np.where(left, (value + at * slope) / k, slope)
        value = np.where(left, (at * value + 1.0) / k, value)
    return value, slope


@lru_cache(maxsize=64)  # one oil at one temperature is evaluated at many pressures
def _exponent_of_film(alpha_p0: float, log_ratio: float) -> tuple[Array, Array, Array]:
    """Return z of Roelands's law for alpha* p0 and k = ln(eta0/eta_inf), and its slopes over both.

    1/alpha* = integral of exp(-k ((1 + p/p0)^z - 1)) dp = p0 G(1/z, k)/z, whose root is found by Newton's method on
    logarithms.
    """
    of = np.asarray(alpha_p0)
    k = np.asarray(log_ratio)
    z = (of + 1.0) / k
    for _ in range(60):
        if not np.all(z > 5e-3):  # G overflows
            break
        g, slope = _gamma(1.0 / z, k)
        bend = 1.0 + slope / (g * z)
        change = (np.log(z / g) - np.log(of)) / bend
        z = z * np.exp(-np.clip(change, -1.0, 1.0))
        if np.all(np.abs(change) < 1e-13 * (1.0 + k)):
            return z, z / (of * bend), z / bend * (1.0 - 1.0 / (z * k) - 1.0 / (k * g))
    raise DomainError(
        "roelands: slice 0 is outside its domain: no exponent z gives alpha* of the film"
    )


@attrs.frozen
class Roelands(PressureViscosity):
    """Roelands's law: eta = eta0 exp{k [(1 + p/p0)^z - 1]}, k = ln(eta0/eta_inf), z = alpha p0/k.

    eta_inf = 6.315e-5 Pa s and p0 = 1/5.1e-9 Pa. With eta0 and alpha both functions of temperature,
    -dln(eta)/dT = (1 + p/p0)^z {beta0 + p0 ln(1 + p/p0) [gamma - alpha beta0/k]}, which starts as beta0 + gamma p.

    This z is that of an alpha which is the slope of ln(eta) at no pressure. Of an oil that gives alpha* of films z is
    the root of alpha* p0 exp(k) k^(-1/z) Gamma(1/z, k) = z, with the incomplete gamma function: then
    1/integral(eta0/eta dp) is alpha*, and the slope at no pressure is larger.

    Range: eta0 above eta_inf; to about 0.5 GPa for many oils. With a constant alpha (gamma = 0) the fall with
    temperature turns negative at several GPa, which no traction model accepts.
    """

    validity: ClassVar[tuple[Validity, ...]] = (
        Validity(
            code="W21",
            quantity="pressure",
            high=0.6e9,
            consequence="near 40 degC viscosity rises faster than exponentially, and laws that take alpha alone fall "
            "behind: of one mineral oil this law gives 0.6 of it at 0.7 GPa, of another less",
            remedy="lubricant.pressure_viscosity_law = 'yasutomi' with constants of the oil; at 100 degC the law holds",
            source="Shell T9 by the improved Yasutomi law (C), and 53 measured points of another oil to 0.76 GPa (A)",
        ),
    )
    name: ClassVar[str] = "roelands"
    equation: ClassVar[str] = (
        "eta = eta0 exp{f k [(1 + p/p0)^z - 1]}, k = ln(eta0/6.315e-5), z = alpha p0/k"
    )
    references: ClassVar[tuple[Reference, ...]] = (ROELANDS,)
    reads = Barus.reads
    expected_failures: ClassVar[Mapping[str, str]] = MappingProxyType(
        {
            "check_does_not_know_metre_kilogram_second_and_kelvin": "eta_inf and p0 are numbers of the law with units"
        }
    )
    domain = MappingProxyType(
        {**Barus.domain, "viscosity": (math.nextafter(POLE_VISCOSITY, 1.0), FINITE[1])}
    )
    alpha: str = alpha_of_oil()
    factor: float = factor_of_oil()

    def at(self, conditions: Conditions, pressure: ArrayLike) -> tuple[Array, Array]:
        """Return viscosity and its fall with temperature."""
        c = conditions
        k = np.log(c.viscosity / POLE_VISCOSITY)
        x = np.log1p(np.asarray(pressure, dtype=float) / POLE_PRESSURE)
        z = c.pressure_viscosity * POLE_PRESSURE / k
        bend = POLE_PRESSURE * (
            c.pressure_thermoviscosity - c.pressure_viscosity * c.thermoviscosity / k
        )
        if self.alpha == "film" and np.all(np.asarray(c.pressure_viscosity) > 0.0):
            z, over_a, over_k = _exponent_of_film(c.pressure_viscosity * POLE_PRESSURE, k)
            bend = k * (
                over_a * c.pressure_thermoviscosity * POLE_PRESSURE + over_k * c.thermoviscosity
            )
        y = np.expm1(z * x)
        fraction = self.factor
        return (
            c.viscosity * np.exp(fraction * k * y),
            (1 - fraction) * c.thermoviscosity
            + fraction * ((1 + y) * (c.thermoviscosity + bend * x)),
        )

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.roelands(POLE_VISCOSITY, POLE_PRESSURE, self.factor, self.alpha == "film")

    def log_kernel(self) -> object:
        """Return the compiled form of the logarithm."""
        film = self.alpha == "film"
        return compiled.roelands(POLE_VISCOSITY, POLE_PRESSURE, self.factor, film, True)


@attrs.frozen(kw_only=True)
class Yasutomi(PressureViscosity):
    """Free-volume law of Yasutomi, Bair and Winer: the WLF equation with a glass temperature that rises with pressure.

    log10(eta/eta_g) = -C1 x/(C2 + x), x = (T - Tg) F, Tg = Tg0 + A1 ln(1 + A2 p), F = 1 - B1 ln(1 + B2 p);
    here its ratio to the value at ambient pressure, times eta0 of the oil. The law fixes the initial slope of
    ln(eta), so an oil that gives no alpha takes it from here.

    Range: from the glass transition (T = Tg) upwards; below it, and where F is not positive, it has no value.
    Constants are an oil's own. Ehret, Dowson and Taylor (1998) give for the polyphenyl ether 5P4E Tg0 = -28.2 degC,
    A1 = 134.2 K, A2 = 1.929 1/GPa, B1 = 4.815, B2 = 0.160 1/GPa, C1 = 16.01, C2 = 20.69 K with eta_g = 1e12 Pa s
    (grade C: known to us from a program that cites them).
    """

    name: ClassVar[str] = "yasutomi"
    equation: ClassVar[str] = (
        "log10(eta/eta_g) = -C1 x/(C2 + x), x = (T - Tg0 - A1 ln(1 + A2 p)) (1 - B1 ln(1 + B2 p))"
    )
    references: ClassVar[tuple[Reference, ...]] = (YASUTOMI, EHRET)
    reads = frozenset({"pressure", "temperature", "viscosity", "thermoviscosity"})
    domain = MappingProxyType(
        {
            "pressure": NON_NEGATIVE,
            "temperature": POSITIVE,
            "viscosity": POSITIVE,
            "thermoviscosity": NON_NEGATIVE,
        }
    )

    glass_temperature: float = field(
        unit="K",
        validator=positive,
        doc="Tg0, glass temperature at ambient pressure",
        usual=(130, 330),
        possible=(1, 1e3),
    )
    a1: float = field(unit="K", validator=non_negative, doc="A1, rise of the glass temperature")
    a2: float = field(
        unit="1/Pa",
        validator=positive,
        doc="A2, its pressure",
        usual=(1e-11, 1e-7),
        possible=(1e-14, 1e-3),
    )
    b1: float = field(
        unit="1",
        validator=non_negative,
        doc="B1, fall of the free volume's expansion",
        usual=(0, 1),
        possible=(0, 1e3),
    )
    b2: float = field(
        unit="1/Pa",
        validator=positive,
        doc="B2, its pressure",
        usual=(1e-11, 1e-7),
        possible=(1e-14, 1e-3),
    )
    c1: float = field(
        unit="1",
        validator=positive,
        doc="C1 of the WLF equation",
        usual=(5, 50),
        possible=(0.01, 1e4),
    )
    c2: float = field(unit="K", validator=positive, doc="C2 of the WLF equation")
    factor: float = factor_of_oil()

    def at(self, conditions: Conditions, pressure: ArrayLike) -> tuple[Array, Array]:
        """Return viscosity and its fall with temperature."""
        c = conditions
        p = np.asarray(pressure, dtype=float)
        # whose square may overflow without a word
        x0 = np.float64(c.temperature) - self.glass_temperature
        fraction = 1 - self.b1 * np.log1p(self.b2 * p)
        x = (x0 - self.a1 * np.log1p(self.a2 * p)) * fraction
        glass = ~((fraction > 0) & (x >= 0) & (x0 > 0))
        if np.any(glass):
            at = int(np.flatnonzero(glass)[0])
            raise DomainError(
                f"{self.name}: slice {at} is outside its domain: at {format_quantity(np.ravel(p)[at], 'Pa')} and "
                f"{format_quantity(c.temperature, 'K')} the oil is a glass"
            )
        k = self.factor * np.log(10) * self.c1 * self.c2
        return (
            c.viscosity * np.exp(k * (x0 - x) / ((self.c2 + x0) * (self.c2 + x))),
            c.thermoviscosity + k * (fraction / (self.c2 + x) ** 2 - 1 / (self.c2 + x0) ** 2),
        )

    def coefficient(self, temperature: float) -> float:
        """Return alpha = ln(10) C1 C2 [A1 A2 + B1 B2 (T - Tg0)]/(C2 + T - Tg0)^2."""
        x0 = temperature - self.glass_temperature
        slope = self.a1 * self.a2 + self.b1 * self.b2 * x0
        return math.log(10) * self.c1 * self.c2 * slope / (self.c2 + x0) ** 2

    def kernel(self) -> object:
        """Return the compiled form."""
        return self._compiled(logarithm=False)

    def log_kernel(self) -> object:
        """Return the compiled form of the logarithm."""
        return self._compiled(logarithm=True)

    def _compiled(self, *, logarithm: bool) -> object:
        return compiled.yasutomi(
            self.glass_temperature,
            self.a1,
            self.a2,
            self.b1,
            self.b2,
            self.c1,
            self.c2,
            self.factor,
            logarithm,
        )
