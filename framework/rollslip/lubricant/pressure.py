"""How the oil's viscosity follows pressure: a stage of the oil's own, between film and traction.

- The law belongs to the oil, not to the models: a scene that changes its oil changes the law with it, and every
  traction model, ours or a stranger's, reads the same two columns whatever the law.
- A law says how viscosity *rises* with pressure. eta0 and beta0 at ambient pressure are the oil's, at any law, so that
  laws differ only where pressure comes in.
- Barus and Roelands take alpha and gamma of the oil; a free-volume law brings constants of its own.
"""

import abc
import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, ClassVar, Final

import attrs
import numpy as np
from numpy.typing import ArrayLike, NDArray

from rollslip.errors import DomainError
from rollslip.fields import field, non_negative, positive
from rollslip.models import FINITE, NON_NEGATIVE, POSITIVE, SliceModel, Validity
from rollslip.references import BARUS, EHRET, ROELANDS, YASUTOMI, Reference
from rollslip.units import format_quantity
from rollslip_kernels.slices import Conditions, Slices
from rollslip_kernels.stages import viscosity as compiled

Array = NDArray[np.float64]
NO_SLOPES: Final[Mapping[str, float]] = MappingProxyType({})

#: Where all isotherms, and all isobars, of Roelands's law meet: 6.315e-5 Pa s is exp(-9.67).
POLE_VISCOSITY: Final = math.exp(-9.67)
POLE_PRESSURE: Final = 1 / 5.1e-9


class PressureViscosity(SliceModel):
    """Viscosity at the pressure of a slice and the inlet temperature, and its fall with temperature there."""

    writes = frozenset({"film_viscosity", "film_thermoviscosity"})

    @abc.abstractmethod
    def at(self, conditions: Conditions, pressure: ArrayLike) -> tuple[Array, Array]:
        """Return viscosity [Pa s] and its fall -dln(eta)/dT [1/K] at pressures [Pa] of any shape.

        Raises
        ------
        DomainError
            If the law has no value at a pressure.
        """

    def coefficient(self, temperature: float) -> float:
        """Return dln(eta)/dp at ambient pressure [1/Pa] if the law itself fixes it, else nan: it is the oil's alpha."""
        return math.nan

    def evaluate(self, slices: Slices) -> None:
        """Fill viscosity and its fall with temperature."""
        slices.film_viscosity[...], slices.film_thermoviscosity[...] = self.at(slices.conditions, slices.pressure)


def _above_roelands(pressure: float) -> float:
    """Per cent by which Barus is above Roelands, for MIL-L-7808 at 50 degC: 8.58 mPa s and alpha = 10.74 /GPa."""
    k, rise = math.log(8.58e-3 / POLE_VISCOSITY), 10.74e-9 * pressure
    roelands = k * math.expm1(10.74e-9 * POLE_PRESSURE / k * math.log1p(pressure / POLE_PRESSURE))
    return 100.0 * math.expm1(min(rise - roelands, 700.0))


@attrs.frozen
class Barus(PressureViscosity):
    """Barus's law: eta = eta0 exp(alpha p), -dln(eta)/dT = beta0 + gamma p.

    Range: some 0.1 GPa; beyond it is too steep for most oils (at 0.4 GPa four times Roelands).
    """

    validity: ClassVar[tuple[Validity, ...]] = (
        Validity(
            quantity="pressure",
            high=0.1e9,
            consequence="the viscosity is {error} above Roelands's (for 8.6 mPa s and an alpha of 10.7 /GPa)",
            error=_above_roelands,
            remedy="lubricant.pressure_viscosity_law = 'roelands', or 'yasutomi' with constants of the oil",
            source="Barus against Roelands at the same alpha; the range is that of most oils (grade C)",
        ),
    )
    name: ClassVar[str] = "barus"
    equation: ClassVar[str] = "eta = eta0 exp(alpha p)"
    references: ClassVar[tuple[Reference, ...]] = (BARUS,)
    reads = frozenset({"pressure", "viscosity", "pressure_viscosity", "thermoviscosity", "pressure_thermoviscosity"})
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
        c, p = conditions, np.asarray(pressure, dtype=float)
        return (
            c.viscosity * np.exp(c.pressure_viscosity * p),
            c.thermoviscosity + c.pressure_thermoviscosity * p,
        )

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.barus()


@attrs.frozen
class Roelands(PressureViscosity):
    """Roelands's law: eta = eta0 exp{k [(1 + p/p0)^z - 1]}, k = ln(eta0/eta_inf), z = alpha p0/k.

    eta_inf = 6.315e-5 Pa s and p0 = 1/5.1e-9 Pa. With eta0 and alpha both functions of temperature,
    -dln(eta)/dT = (1 + p/p0)^z {beta0 + p0 ln(1 + p/p0) [gamma - alpha beta0/k]}, which starts as beta0 + gamma p.

    Range: eta0 above eta_inf; to about 0.5 GPa for many oils. With a constant alpha (gamma = 0) the fall with
    temperature turns negative at several GPa, which no traction model accepts.
    """

    name: ClassVar[str] = "roelands"
    equation: ClassVar[str] = "eta = eta0 exp{k [(1 + p/p0)^z - 1]}, k = ln(eta0/6.315e-5), z = alpha p0/k"
    references: ClassVar[tuple[Reference, ...]] = (ROELANDS,)
    reads = Barus.reads
    domain = MappingProxyType({**Barus.domain, "viscosity": (math.nextafter(POLE_VISCOSITY, 1.0), FINITE[1])})

    def at(self, conditions: Conditions, pressure: ArrayLike) -> tuple[Array, Array]:
        """Return viscosity and its fall with temperature."""
        c = conditions
        k = np.log(c.viscosity / POLE_VISCOSITY)
        x = np.log1p(np.asarray(pressure, dtype=float) / POLE_PRESSURE)
        y = np.expm1(c.pressure_viscosity * POLE_PRESSURE / k * x)
        bend = POLE_PRESSURE * (c.pressure_thermoviscosity - c.pressure_viscosity * c.thermoviscosity / k)
        return c.viscosity * np.exp(k * y), (1 + y) * (c.thermoviscosity + bend * x)

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.roelands(POLE_VISCOSITY, POLE_PRESSURE)


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
    equation: ClassVar[str] = "log10(eta/eta_g) = -C1 x/(C2 + x), x = (T - Tg0 - A1 ln(1 + A2 p)) (1 - B1 ln(1 + B2 p))"
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
        unit="1/Pa", validator=positive, doc="A2, its pressure", usual=(1e-11, 1e-7), possible=(1e-14, 1e-3)
    )
    b1: float = field(
        unit="1", validator=non_negative, doc="B1, fall of the free volume's expansion", usual=(0, 1), possible=(0, 1e3)
    )
    b2: float = field(
        unit="1/Pa", validator=positive, doc="B2, its pressure", usual=(1e-11, 1e-7), possible=(1e-14, 1e-3)
    )
    c1: float = field(unit="1", validator=positive, doc="C1 of the WLF equation", usual=(5, 50), possible=(0.01, 1e4))
    c2: float = field(unit="K", validator=positive, doc="C2 of the WLF equation")

    def at(self, conditions: Conditions, pressure: ArrayLike) -> tuple[Array, Array]:
        """Return viscosity and its fall with temperature."""
        c, p = conditions, np.asarray(pressure, dtype=float)
        x0 = c.temperature - self.glass_temperature
        share = 1 - self.b1 * np.log1p(self.b2 * p)
        x = (x0 - self.a1 * np.log1p(self.a2 * p)) * share
        glass = ~((share > 0) & (x >= 0) & (x0 > 0))
        if np.any(glass):
            at = int(np.flatnonzero(glass)[0])
            raise DomainError(
                f"{self.name}: slice {at} is outside its domain: at {format_quantity(np.ravel(p)[at], 'Pa')} and "
                f"{format_quantity(c.temperature, 'K')} the oil is a glass"
            )
        k = np.log(10) * self.c1 * self.c2
        return (
            c.viscosity * np.exp(k * (x0 - x) / ((self.c2 + x0) * (self.c2 + x))),
            c.thermoviscosity + k * (share / (self.c2 + x) ** 2 - 1 / (self.c2 + x0) ** 2),
        )

    def coefficient(self, temperature: float) -> float:
        """Return alpha = ln(10) C1 C2 [A1 A2 + B1 B2 (T - Tg0)]/(C2 + T - Tg0)^2."""
        x0 = temperature - self.glass_temperature
        slope = self.a1 * self.a2 + self.b1 * self.b2 * x0
        return math.log(10) * self.c1 * self.c2 * slope / (self.c2 + x0) ** 2

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.yasutomi(self.glass_temperature, self.a1, self.a2, self.b1, self.b2, self.c1, self.c2)


def from_oil() -> Any:
    """Declare the part of a model that is the oil's law: not a key of a scene, put in when the bearing is assembled."""
    return attrs.field(
        factory=Barus, kw_only=True, metadata={"key": None, "unit": None, "doc": "the law of the oil", "from_oil": True}
    )


def slope_of_oil(doc: str) -> Any:
    """Declare a slope with pressure [1] that is the oil's: no key of a scene, put in when the bearing is assembled."""
    said = {"key": None, "unit": "1", "doc": doc, "slope_of_oil": True}
    return attrs.field(default=0.0, kw_only=True, validator=non_negative, metadata=said)


def with_law(model: Any, law: PressureViscosity, slopes: Mapping[str, float] = NO_SLOPES) -> Any:
    """Return a model with the oil's law and slopes with pressure in it, and in its children, where they ask for them.

    Parameters
    ----------
    model : SliceModel
        The model.
    law : PressureViscosity
        How viscosity rises with pressure.
    slopes : mapping of str to float
        By the name that models have for them, such as ``eyring_stress_slope``; what is not given stays.
    """
    changes: dict[str, Any] = {}
    for attribute in attrs.fields(type(model)):
        value = getattr(model, attribute.name)
        if attribute.metadata.get("from_oil"):
            changes[attribute.name] = law
        elif attribute.metadata.get("slope_of_oil") and slopes.get(attribute.name, value) != value:
            changes[attribute.name] = slopes[attribute.name]
        elif isinstance(value, SliceModel) and (changed := with_law(value, law, slopes)) is not value:
            changes[attribute.name] = changed
    return attrs.evolve(model, **changes) if changes else model


def without_slope(model: Any, name: str) -> list[str]:
    """Return the names of a model and its children that read a property of the oil but not its slope with pressure."""
    fields = getattr(type(model), "__attrs_attrs__", ())
    children = [getattr(model, a.name) for a in fields if "kind" in a.metadata]
    if children:  # it reads what they read
        return [one for child in children for one in without_slope(child, name)]
    takes = any(a.name == f"{name}_slope" and a.metadata.get("slope_of_oil") for a in fields)
    return [] if takes or name not in model.reads else [model.name]
