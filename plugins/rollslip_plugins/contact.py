"""Line contact after Hertz, with the deflection laws of Palmgren, ISO/TS 16281 and Lundberg."""

from types import MappingProxyType
from typing import ClassVar, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.errors import DomainError
from rollslip.fields import parameter, positive
from rollslip.models import FINITE, POSITIVE, ContactModel, SliceModel, Validity
from rollslip.references import Reference
from rollslip_kernels.slices import Slices
from rollslip_kernels.stages import contact as compiled
from rollslip_plugins.bibliography import (
    HARRIS_ESSENTIAL_2007,
    ISO_16281,
    JOHNSON_1985,
    LUNDBERG_1939,
)
from rollslip_plugins.symbols import explained

#: Pa in N/mm2, the unit of the published coefficients.
MPA = 1e6


@attrs.frozen
class PowerDeflection(SliceModel):
    """Deflection Q = k l^(8/9) delta^(10/9) of one line contact; the powers make k a pressure, published in N/mm2.

    Symbols:

    - w: load per length Q/l, 0 where the surfaces are apart [N/m]
    - k: coefficient of the deflection (``coefficient``) [Pa]
    - l: length of the contact [m]
    - delta: approach of the two bodies [m]

    Range: that of the coefficient, fitted to steel on steel.

    Examples
    --------
    With l = delta = 1 m all powers are 1.

    >>> from rollslip import Conditions, Slices
    >>> slices = Slices(1, Conditions(length=1.0), approach=1.0)
    >>> PowerDeflection(5.0).evaluate(slices)
    >>> float(slices.load[0]), float(slices.stiffness[0]) * 0.9
    (5.0, 5.0)
    """

    name: ClassVar[str] = "power-deflection"
    equation: ClassVar[str] = "w = k l^(8/9) delta^(10/9)/l"
    references: ClassVar[tuple[Reference, ...]] = (HARRIS_ESSENTIAL_2007,)
    reads = frozenset({"approach", "length"})
    writes = frozenset({"load", "stiffness"})
    domain = MappingProxyType({"approach": FINITE, "length": POSITIVE})

    coefficient: float = parameter(
        unit="Pa", validator=positive, doc="coefficient k, fitted to steel on steel"
    )

    def evaluate(self, slices: Slices) -> None:
        """Fill load and stiffness from the approach; surfaces without contact carry no load."""
        length = slices.conditions.length
        per_metre = self.coefficient * length ** (8 / 9) / length
        approach = np.maximum(slices.approach, 0.0)
        slices.load[...] = per_metre * approach ** (10 / 9)
        slices.stiffness[...] = per_metre * (10 / 9) * approach ** (1 / 9)

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.power_deflection(self.coefficient)


@attrs.frozen
class LundbergDeflection(SliceModel):
    """Deflection of two elastic half spaces under a semi-elliptic strip of finite length.

    delta = (4 w/(pi E')) [1/2 + ln(2 l/b)]; 1/2 + ln 4 = 1.8863 is the constant that is published as 1.8864 with
    ln(l/(2 b)). Solved for w by Newton's method.

    Symbols:

    - delta: approach of the two bodies [m]
    - w: load per length, 0 where the surfaces are apart [N/m]
    - E': equivalent modulus 2/sum((1 - nu^2)/E) [Pa]
    - l: length of the contact [m]
    - b: half width of the contact after Hertz [m]

    Range: b << l, elastic bodies large against b.

    Examples
    --------
    Load pi 2.5e4 N/m, b = 0.1 mm, l = 10 mm: delta = 5e-7 (1/2 + ln 200) m = 2.899158683 um.

    >>> from rollslip import Conditions, Slices
    >>> slices = Slices(1, Conditions(radius=0.01, modulus=2e11, length=0.01), approach=2.899158683e-6)
    >>> LundbergDeflection().evaluate(slices)
    >>> f"{slices.load[0]:.5e}"
    '7.85398e+04'
    """

    name: ClassVar[str] = "lundberg-deflection"
    equation: ClassVar[str] = "delta = 4 w/(pi E') (1/2 + ln(2 l/b))"
    references: ClassVar[tuple[Reference, ...]] = (LUNDBERG_1939,)
    reads = frozenset({"approach", "length", "radius", "modulus"})
    writes = frozenset({"load", "stiffness"})
    domain = MappingProxyType(
        {"approach": FINITE, "length": POSITIVE, "radius": POSITIVE, "modulus": POSITIVE}
    )

    def evaluate(self, slices: Slices) -> None:
        """Fill load and stiffness from the approach; surfaces without contact carry no load."""
        c = slices.conditions
        compliance = 4 / (np.pi * c.modulus)
        k = 0.5 + np.log(2 * c.length) - 0.5 * np.log(8 * c.radius / (np.pi * c.modulus))
        touching = slices.approach > 0
        a = k - 0.5 * np.log(slices.approach[touching] / compliance)
        wide = a < 0.5 + 0.5 * np.log(2)
        if np.any(wide):
            at = int(np.flatnonzero(touching)[np.argmax(wide)])
            raise DomainError(
                f"{self.name}: slice {at} is outside its domain: the contact is wider than it is long; lower the load, "
                "or choose another contact model"
            )
        g = _bracket(a)
        slices.load[...] = 0.0
        slices.stiffness[...] = 0.0
        slices.load[touching] = slices.approach[touching] / (compliance * g)
        slices.stiffness[touching] = 1 / (compliance * (g - 0.5))

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.lundberg_deflection()


def _bracket(a: NDArray[np.float64]) -> NDArray[np.float64]:
    """Solve g = a + ln(g)/2, g > 1/2: convex, so Newton's method from above falls to the root."""
    g = np.maximum(1.25 * a, 1.0)
    for _ in range(60):
        step = (g - a - 0.5 * np.log(g)) / (1 - 0.5 / g)
        g = g - step
        if np.all(np.abs(step) <= 1e-15 * g):
            break
    return g


class HertzLine(ContactModel):
    """Half width and mean pressure of an elastic line contact (Hertz 1881)."""

    equation: ClassVar[str] = "b = sqrt(8 w R/(pi E')), p = w/(2 b)"

    def evaluate(self: SliceModel, slices: Slices) -> None:
        """Fill half width and mean pressure."""
        c = slices.conditions
        slices.half_width[...] = np.sqrt(8 * c.radius / (np.pi * c.modulus) * slices.load)
        slices.pressure[...] = slices.load / (2 * slices.half_width)

    def kernel(self: SliceModel) -> object:
        """Return the compiled form."""
        return compiled.hertz_line()


#: Of laws of deflection that have the elasticity of steel in a number.
_OF_STEEL: Final = (
    Validity(
        code="W24",
        quantity="modulus",
        low=2.1e11,
        high=2.5e11,
        consequence="deflections are those of steel on steel, so loads of rollers are others",
        remedy="contact 'lundberg', which takes any elastic material",
        replacement="lundberg",
        source="E/(1 - nu^2) of bearing steels, 200 to 215 GPa at 0.25 to 0.3",
    ),
)


@attrs.frozen
@explained
class Palmgren(HertzLine):
    """Hertz line contact with Palmgren's deflection delta[mm] = 3.84e-5 Q^0.9/l^0.8 of each steel contact.

    Symbols:

    - b
    - p: mean pressure [Pa]
    - w, R, E'
    - delta: approach of the two bodies, in the stage of deflection [m]
    - Q: normal force, there in N [N]
    - l: length of the contact, there in mm [m]

    Range: steel on steel, fitted to crowned rollers (B).

    Examples
    --------
    Hertz with w = pi 2.5e4 N/m: b = sqrt(8 pi 2.5e4 0.01/(pi 2e11)) = 0.1 mm, p = w/(2 b).
    Palmgren with Q = 10 kN, l = 10 mm: delta = 3.84e-5 10^2.8 mm.

    >>> from rollslip import Conditions, Slices
    >>> steel = Conditions(radius=0.01, modulus=2e11, length=0.01)
    >>> slices = Slices(1, steel, load=78539.816340, approach=3.84e-8 * 10**2.8)
    >>> Palmgren().evaluate(slices)
    >>> f"{slices.half_width[0]:.6e} {slices.pressure[0]:.6e}"
    '1.000000e-04 3.926991e+08'
    >>> Palmgren().deflection().evaluate(slices)
    >>> f"{slices.load[0]:.6e}"
    '1.000000e+06'
    """

    name: ClassVar[str] = "palmgren"
    references: ClassVar[tuple[Reference, ...]] = (HARRIS_ESSENTIAL_2007, JOHNSON_1985)
    validity: ClassVar[tuple[Validity, ...]] = _OF_STEEL

    def deflection(self) -> SliceModel:
        """Return the stage approach -> load, stiffness."""
        return PowerDeflection((1 / 3.84e-5) ** (10 / 9) * MPA)


@attrs.frozen
@explained
class Iso16281(HertzLine):
    """Hertz line contact with the stiffness of ISO/TS 16281, c_L = 35948 l^(8/9) for both contacts in series.

    One contact is 2^(10/9) as stiff as the pair: Q = 35948 l^(8/9) (2 delta)^(10/9) in N and mm.

    Symbols:

    - b
    - p: mean pressure [Pa]
    - w, R, E'
    - delta: approach of the two bodies, in the stage of deflection [m]
    - Q: normal force, there in N [N]
    - l: length of the contact, there in mm [m]

    Range: steel on steel.

    Examples
    --------
    Hertz with w = pi 2.5e4 N/m: b = sqrt(8 pi 2.5e4 0.01/(pi 2e11)) = 0.1 mm, p = w/(2 b).
    ISO with l = 10 mm, delta = 0.01 mm of one contact: Q = 35948 10^(8/9) 0.02^(10/9) N = 3604.2854 N.

    >>> from rollslip import Conditions, Slices
    >>> steel = Conditions(radius=0.01, modulus=2e11, length=0.01)
    >>> slices = Slices(1, steel, load=78539.816340, approach=1e-5)
    >>> Iso16281().evaluate(slices)
    >>> f"{slices.half_width[0]:.6e} {slices.pressure[0]:.6e}"
    '1.000000e-04 3.926991e+08'
    >>> Iso16281().deflection().evaluate(slices)
    >>> f"{slices.load[0]:.6e}"
    '3.604285e+05'
    """

    name: ClassVar[str] = "iso16281"
    references: ClassVar[tuple[Reference, ...]] = (ISO_16281, JOHNSON_1985)
    validity: ClassVar[tuple[Validity, ...]] = _OF_STEEL

    def deflection(self) -> SliceModel:
        """Return the stage approach -> load, stiffness."""
        return PowerDeflection(35948 * 2 ** (10 / 9) * MPA)


@attrs.frozen
@explained
class Lundberg(HertzLine):
    """Hertz line contact with Lundberg's deflection of a contact of finite length, any elastic material.

    Symbols:

    - b
    - p: mean pressure [Pa]
    - w, R, E'
    - delta: approach of the two bodies, (4 w/(pi E')) [1/2 + ln(2 l/b)] in the stage of deflection [m]
    - l

    Range: b << l, elastic bodies large against b.

    Examples
    --------
    Hertz with w = pi 2.5e4 N/m: b = sqrt(8 pi 2.5e4 0.01/(pi 2e11)) = 0.1 mm, p = w/(2 b).
    Lundberg with l = 10 mm: delta = 5e-7 (1/2 + ln 200) m = 2.899158683 um.

    >>> from rollslip import Conditions, Slices
    >>> steel = Conditions(radius=0.01, modulus=2e11, length=0.01)
    >>> slices = Slices(1, steel, load=78539.816340, approach=2.899158683e-6)
    >>> Lundberg().evaluate(slices)
    >>> f"{slices.half_width[0]:.6e} {slices.pressure[0]:.6e}"
    '1.000000e-04 3.926991e+08'
    >>> Lundberg().deflection().evaluate(slices)
    >>> f"{slices.load[0]:.6e}"
    '7.853982e+04'
    """

    name: ClassVar[str] = "lundberg"
    references: ClassVar[tuple[Reference, ...]] = (*LundbergDeflection.references, JOHNSON_1985)

    def deflection(self) -> SliceModel:
        """Return the stage approach -> load, stiffness."""
        return LundbergDeflection()
