"""Line contact after Hertz, with the deflection laws of Palmgren, ISO/TS 16281 and Lundberg."""

from types import MappingProxyType
from typing import ClassVar

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.errors import DomainError
from rollslip.fields import parameter, positive
from rollslip.hookspecs import hookimpl
from rollslip.models import FINITE, POSITIVE, ContactModel, SliceModel
from rollslip_kernels.slices import Slices
from rollslip_kernels.stages import contact as compiled

HARRIS = "Harris T.A., Kotzalas M.N. Essential Concepts of Bearing Technology, 5th ed. CRC Press, 2006."
JOHNSON = "Johnson K.L. Contact Mechanics. Cambridge University Press, 1985."
ISO16281 = (
    "ISO/TS 16281:2008 Rolling bearings: methods for calculating the modified reference rating life "
    "for universally loaded bearings."
)
MPA = 1e6  # Pa, the unit of the published coefficients, N/mm2


@attrs.frozen
class PowerDeflection(SliceModel):
    """Deflection Q = k l^(8/9) delta^(10/9) of one line contact; the powers make k a pressure, published in N/mm2."""

    name: ClassVar[str] = "power-deflection"
    equation: ClassVar[str] = "w = k l^(8/9) delta^(10/9)/l"
    references: ClassVar[tuple[str, ...]] = (HARRIS,)
    reads = frozenset({"approach", "length"})
    writes = frozenset({"load", "stiffness"})
    domain = MappingProxyType({"approach": FINITE, "length": POSITIVE})

    coefficient: float = parameter(unit="Pa", validator=positive, doc="coefficient k, fitted to steel on steel")

    def evaluate(self, slices: Slices) -> None:
        """Fill load and stiffness from the approach; surfaces apart carry nothing."""
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

    delta = (4 w/(pi E')) [1/2 + ln(2 l/b)], b the Hertz half width; 1/2 + ln 4 = 1.8863 is the constant that is
    published as 1.8864 with ln(l/(2 b)). Solved for w by Newton's method.
    """

    name: ClassVar[str] = "lundberg-deflection"
    equation: ClassVar[str] = "delta = 4 w/(pi E') (1/2 + ln(2 l/b))"
    references: ClassVar[tuple[str, ...]] = ("Lundberg G. Elastische Berührung zweier Halbräume. Forsch. 10, 1939.",)
    reads = frozenset({"approach", "length", "radius", "modulus"})
    writes = frozenset({"load", "stiffness"})
    domain = MappingProxyType({"approach": FINITE, "length": POSITIVE, "radius": POSITIVE, "modulus": POSITIVE})

    def evaluate(self, slices: Slices) -> None:
        """Fill load and stiffness from the approach; surfaces apart carry nothing."""
        c = slices.conditions
        compliance = 4 / (np.pi * c.modulus)
        k = 0.5 + np.log(2 * c.length) - 0.5 * np.log(8 * c.radius / (np.pi * c.modulus))
        touching = slices.approach > 0
        a = k - 0.5 * np.log(slices.approach[touching] / compliance)
        wide = a < 0.5 + 0.5 * np.log(2)
        if np.any(wide):
            at = int(np.flatnonzero(touching)[np.argmax(wide)])
            raise DomainError(f"{self.name}: slice {at} is outside its domain: the contact is wider than it is long")
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


class _HertzLine(ContactModel):
    """Half width and mean pressure of an elastic line contact (Hertz 1881)."""

    equation: ClassVar[str] = "b = sqrt(8 w R/(pi E')), p = w/(2 b)"

    def evaluate(self, slices: Slices) -> None:
        """Fill half width and mean pressure."""
        c = slices.conditions
        slices.half_width[...] = np.sqrt(8 * c.radius / (np.pi * c.modulus) * slices.load)
        slices.pressure[...] = slices.load / (2 * slices.half_width)

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.hertz_line()


@attrs.frozen
class Palmgren(_HertzLine):
    """Hertz line contact with Palmgren's deflection delta[mm] = 3.84e-5 Q^0.9/l^0.8 of each steel contact.

    Range: steel on steel, fitted to crowned rollers (grade B).
    """

    name: ClassVar[str] = "palmgren"
    references: ClassVar[tuple[str, ...]] = (HARRIS, JOHNSON)

    def deflection(self) -> SliceModel:
        """Return the stage approach -> load, stiffness."""
        return PowerDeflection((1 / 3.84e-5) ** (10 / 9) * MPA)


@attrs.frozen
class Iso16281(_HertzLine):
    """Hertz line contact with the stiffness of ISO/TS 16281, c_L = 35948 l^(8/9) for both contacts in series.

    One contact is 2^(10/9) as stiff as the pair. Range: steel on steel.
    """

    name: ClassVar[str] = "iso16281"
    references: ClassVar[tuple[str, ...]] = (ISO16281, JOHNSON)

    def deflection(self) -> SliceModel:
        """Return the stage approach -> load, stiffness."""
        return PowerDeflection(35948 * 2 ** (10 / 9) * MPA)


@attrs.frozen
class Lundberg(_HertzLine):
    """Hertz line contact with Lundberg's deflection of a contact of finite length, any elastic material."""

    name: ClassVar[str] = "lundberg"
    references: ClassVar[tuple[str, ...]] = (*LundbergDeflection.references, JOHNSON)

    def deflection(self) -> SliceModel:
        """Return the stage approach -> load, stiffness."""
        return LundbergDeflection()


@hookimpl
def contact_models() -> list[type[ContactModel]]:
    """Offer the contact models of this module."""
    return [Palmgren, Iso16281, Lundberg]
