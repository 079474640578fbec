"""Resistance of a loaded contact to rolling: of the oil in the inlet, and of steel that is not quite elastic."""

from types import MappingProxyType
from typing import ClassVar, Final

import attrs
import numpy as np

from rollslip.fields import parameter
from rollslip.hookspecs import hookimpl
from rollslip.models import NON_NEGATIVE, POSITIVE, Drag, ResistanceModel, Validity
from rollslip.references import Reference
from rollslip_kernels.slices import Slices
from rollslip_kernels.stages import drag as compiled
from rollslip_plugins.bibliography import GOKSEM_1978, GREENWOOD_1961, JOHNSON_1985, MARTIN_1916

#: F = RIGID sqrt(eta u w): int h dp/2 of the half-open parabolic gap that Reynolds's condition ends.
RIGID: Final = 2.0796226511
#: F = ELASTIC (R/alpha) (G U)^0.658 W^0.0126
ELASTIC: Final = 4.318


def _compared(quantity: str, low: float, high: float) -> Validity:
    """Return the range in which the law was held against a numerical solution."""
    return Validity(
        quantity=quantity,
        low=low,
        high=high,
        consequence="the resistance was held against no solution; inside it is 0 to 36 % low",
        remedy="none in the box; take it for an estimate",
        source="a numerical solution, isothermal, Barus: tests/references/rolling_resistance.py",
    )


@attrs.frozen
class RollingResistance(ResistanceModel):
    """Resistance of the oil's pressure to rolling, between the rigid and the elastic limit.

    F = (a^-5 + b^-5)^(-1/5), a = 2.0796 sqrt(eta0 u w), b = 4.318 (R/alpha) (G U)^0.658 W^0.0126. a is exact for a
    rigid, isoviscous contact; b is Goksem and Hargreaves's fit for an elastic one, without heating and starvation.

    Symbols:

    - F: force on each surface for a unit of length, int h dp/2 over the film [N/m]
    - a, b: its rigid and its elastic limit [N/m]
    - eta0: viscosity at ambient pressure [Pa s]
    - u: mean of the two surface speeds [m/s]
    - w: load per length [N/m]
    - R: equivalent radius [m]
    - alpha: pressure-viscosity coefficient [1/Pa]
    - G: material parameter alpha E' [1]
    - U: speed parameter eta0 u/(E' R) [1]
    - W: load parameter w/(E' R) [1]
    - E': equivalent modulus 2/sum((1 - nu^2)/E) [Pa]

    Range: against a numerical solution (isothermal, Barus) -36 to 0 % at M = W/sqrt(2 U) from 0.2 to 20 and
    L = G (2 U)^(1/4) from 5 to 15, of which -15 to 0 % up to M = 1 and L = 10. b counts the inlet alone, which the law
    meets to -23 to +15 %; the exit, where the pressure falls through a film that narrows, adds up to half as much.

    Examples
    --------
    An oil that pressure does not thicken leaves a alone: 2.0796226511 sqrt(0.01 20 2e5) = 2.0796226511 200.

    >>> from rollslip import Conditions, Slices
    >>> oil = Conditions(radius=0.01, modulus=2e11, viscosity=0.01, pressure_viscosity=0.0)
    >>> slices = Slices(1, oil, load=2e5, rolling_speed=20.0)
    >>> RollingResistance().evaluate(slices)
    >>> f"{slices.resistance[0]:.5f}"
    '415.92453'
    """

    name: ClassVar[str] = "rolling-resistance"
    equation: ClassVar[str] = (
        "F = (a^-5 + b^-5)^(-1/5), a = 2.0796 sqrt(eta0 u w), b = 4.318 (R/alpha) (G U)^0.658 W^0.0126"
    )
    references: ClassVar[tuple[Reference, ...]] = (GOKSEM_1978, MARTIN_1916)
    validity: ClassVar[tuple[Validity, ...]] = (
        _compared("load_parameter", 0.2, 20.0),
        _compared("lubricant_parameter", 5.0, 15.0),
    )
    reads = frozenset({"load", "rolling_speed", "radius", "modulus", "viscosity", "pressure_viscosity"})
    domain = MappingProxyType({**dict.fromkeys(sorted(reads), POSITIVE), "pressure_viscosity": NON_NEGATIVE})

    def evaluate(self, slices: Slices) -> None:
        """Fill the resistance."""
        c, s = slices.conditions, slices
        flow = c.viscosity * s.rolling_speed
        a = RIGID * np.sqrt(flow * s.load)
        W = s.load / (c.modulus * c.radius)
        x = a * c.pressure_viscosity**0.342 / (ELASTIC * c.radius * (flow / c.radius) ** 0.658 * W**0.0126)
        large = np.maximum(x, 1.0)
        small = np.minimum(x, 1.0 / large)
        s.resistance[...] = a / large * (1.0 + small**5) ** -0.2

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.rolling_resistance(RIGID, ELASTIC)


@attrs.frozen(kw_only=True)
class Hysteresis(ResistanceModel):
    """Resistance of steel that gives back a little less work than it takes: F = k w b/(3 pi R).

    Rolling by a unit of length the front half of the contact takes up the work int_0^b p (x/R) dx = 2 w b/(3 pi R), of
    which the share k is lost; the two surfaces resist with half of that each.

    Symbols:

    - F: force on each surface for a unit of length [N/m]
    - k: share of the work that is lost (``loss``) [1]
    - w: load per length [N/m]
    - b: half width after Hertz, sqrt(8 w R/(pi E')), whatever the pressure in the film [m]
    - R: equivalent radius [m]
    - E': equivalent modulus 2/sum((1 - nu^2)/E) [Pa]

    Range: Hertz's pressure. A film that spreads a light load deforms the steel less, by some share of r of
    ``light-contact``: there the law is high. k is a property of a cycle of stress, and grows with its amplitude. k = 0.01 is an estimate
    for hard steel under pressures that leave it elastic (D).

    Examples
    --------
    With w = pi 2.5e4 N/m Hertz's b is sqrt(8 pi 2.5e4 0.01/(pi 2e11)) = 0.1 mm: 0.01 pi 2.5e4 1e-4/(3 pi 0.01) = 2.5/3.

    >>> from rollslip import Conditions, Slices
    >>> slices = Slices(1, Conditions(radius=0.01, modulus=2e11), load=78539.816340)
    >>> Hysteresis().evaluate(slices)
    >>> f"{slices.resistance[0]:.6f}"
    '0.833333'
    """

    name: ClassVar[str] = "hysteresis"
    equation: ClassVar[str] = "F = k w b/(3 pi R), b = sqrt(8 w R/(pi E'))"
    references: ClassVar[tuple[Reference, ...]] = (JOHNSON_1985.at("chapter 9"), GREENWOOD_1961)
    reads = frozenset({"load", "radius", "modulus"})
    domain = MappingProxyType(dict.fromkeys(sorted(reads), POSITIVE))

    loss: float = parameter(
        default=0.01, unit="1", doc="share k of the work that is lost", usual=(0, 0.1), possible=(0, 1)
    )

    def evaluate(self, slices: Slices) -> None:
        """Fill the resistance."""
        c = slices.conditions
        half_width = np.sqrt(8 * c.radius / (np.pi * c.modulus) * slices.load)
        slices.resistance[...] = self.loss / (3 * np.pi * c.radius) * slices.load * half_width

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.hysteresis(self.loss)


@hookimpl
def drag_models() -> list[type[Drag]]:
    """Offer the resistances of this module."""
    return [RollingResistance, Hysteresis]
