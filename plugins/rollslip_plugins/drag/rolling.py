"""Rolling resistance of a loaded contact: by the oil in the inlet, and by elastic hysteresis of steel."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import ClassVar, Final

import attrs
import numpy as np

from rollslip.fields import choice_of, parameter
from rollslip.models import NON_NEGATIVE, POSITIVE, Domain, ResistanceModel, Validity
from rollslip.references import Reference
from rollslip_kernels.slices import Slices
from rollslip_kernels.stages import drag as compiled
from rollslip_plugins.bibliography import (
    GOKSEM_1978,
    GREENWOOD_1961,
    JOHNSON_1985,
    MARTIN_1916,
    MURCH_1975,
)
from rollslip_plugins.drag.factor import scattering_factor
from rollslip_plugins.film.corrections import (
    LAWS,
    heated_inlet,
    thermal_load,
)
from rollslip_plugins.symbols import explained

#: Factor of F = RIGID sqrt(eta u w): int h dp/2 of a parabolic gap that is open to the inlet, with Reynolds's condition
#: at the exit.
RIGID: Final = 2.0796226511
#: Factor of F = ELASTIC (R/alpha) (G U)^0.658 W^0.0126 (Goksem and Hargreaves).
ELASTIC: Final = 4.318


_OIL: Final = ("load", "rolling_speed", "radius", "modulus", "viscosity")
_DOMAIN: Final[Domain] = MappingProxyType(
    {**dict.fromkeys(_OIL, POSITIVE), "pressure_viscosity": NON_NEGATIVE}
)
_HEATED: Final[Domain] = MappingProxyType({**LAWS["murch-wilson"], **_DOMAIN})
#: Coefficients of (WHOLE[0] L - WHOLE[1]) M^2/(1 + M^2): resistance of the film after the inlet over that of the inlet.
WHOLE: Final = (0.049, 0.16)


def _compared(quantity: str, low: float, high: float) -> Validity:
    """Return the range in which the law was compared with a numerical solution."""
    return Validity(
        code="W22",
        quantity=quantity,
        low=low,
        high=high,
        consequence="the resistance is not checked against a numerical solution; inside it is 0 to 36 % low",
        remedy="no built-in model is checked there; take it for an estimate",
        source="a numerical solution, isothermal, Barus: tools/references/rolling_resistance.py",
    )


@attrs.frozen(kw_only=True)
@explained
class RollingResistance(ResistanceModel):
    """Resistance of the oil's pressure to rolling, between the rigid and the elastic limit.

    F = f C_T C_S C_E (a^-5 + b^-5)^(-1/5), a = 2.0796 sqrt(eta0 u w), b = 4.318 (R/alpha) (G U)^0.658 W^0.0126. a is
    exact for a rigid, isoviscous contact; b is Goksem and Hargreaves's fit for an elastic one. C_E is 1 for the inlet
    alone; with ``extent = "film"`` it is 1 + (0.049 L - 0.16) M^2/(1 + M^2), a fit of numerical solutions. Heat and
    want of oil thin the inlet as they thin the film: C_T = 3.94/(3.94 + Lt^0.62), which agrees with SKF's regression of
    tests within 4 % (C).

    Symbols:

    - F: force on each surface for a unit of length, int h dp/2 over the film [N/m]
    - f
    - a, b: its rigid and its elastic limit [N/m]
    - C_T: reduction by shear heating of the inlet (``inlet_heating``), that of film 'inlet-correction' [1]
    - C_S: reduction by starvation (``starvation``), which the supply of oil gives; 1 outside of a scene [1]
    - C_E: what the film behind the inlet adds (``extent``) [1]
    - Lt: thermal load eta0 beta0 u^2/K_f [1]
    - beta0: fall of the viscosity with temperature -dln(eta0)/dT [1/K]
    - K_f, eta0, u, w
    - M: load parameter W/sqrt(2 U) [1]
    - L: lubricant parameter G (2 U)^(1/4) [1]
    - R, alpha, G, U, W, E'

    Range: isothermal, against a numerical solution (Barus) -36 to 0 % at M from 0.2 to 20 and L from 5 to 15, of
    which -15 to 0 % up to M = 1 and L = 10. b counts the inlet alone, which the law
    meets to -23 to +15 %; the exit, where the pressure falls through a film that narrows, adds up to half as much. With
    ``extent = "film"`` it meets the whole to -2 to +7 % for M up to 20 and L from 3.5 to 20; for smaller L it is too
    large, by 13 % at L = 2 and by far at 0. Torques of bearings speak for the inlet alone: real inlets are not that
    full. How far a bearing follows is known to a factor of 1.35 (a standard deviation, D). Beyond Lt = 10 C_T was held
    against nothing.

    Examples
    --------
    An oil that pressure does not thicken leaves a alone: 2.0796226511 sqrt(0.01 20 2e5) = 2.0796226511 200.

    >>> from rollslip import Conditions, Slices
    >>> oil = Conditions(radius=0.01, modulus=2e11, viscosity=0.01, pressure_viscosity=0.0)
    >>> slices = Slices(1, oil, load=2e5, rolling_speed=20.0)
    >>> RollingResistance(inlet_heating="none").evaluate(slices)
    >>> f"{slices.resistance[0]:.5f}"
    '415.92453'
    """

    name: ClassVar[str] = "rolling-resistance"
    equation: ClassVar[str] = (
        "F = f C_T C_S C_E (a^-5 + b^-5)^(-1/5), a = 2.0796 sqrt(eta0 u w), b = 4.318 (R/alpha) (G U)^0.658 W^0.0126, "
        "C_T = 3.94/(3.94 + Lt^0.62), C_E = 1 + (0.049 L - 0.16) M^2/(1 + M^2)"
    )
    references: ClassVar[tuple[Reference, ...]] = (GOKSEM_1978, MARTIN_1916, MURCH_1975)
    validity: ClassVar[tuple[Validity, ...]] = (
        _compared("load_parameter", 0.2, 20.0),
        _compared("lubricant_parameter", 5.0, 15.0),
    )

    inlet_heating: str = parameter(
        default="murch-wilson",
        validator=choice_of("none", "murch-wilson"),
        doc="reduction by shear heating of the inlet: 'none' or 'murch-wilson'",
    )
    extent: str = parameter(
        default="inlet",
        validator=choice_of("inlet", "film"),
        doc="what resists: the inlet alone, or the whole film",
    )

    factor: float = scattering_factor(
        0.30,
        "makers' own torques differ by 1.7 to 2.4 from each other, the whole film resists by up to 58 % more than the "
        "inlet, and what was left out of it adds about as much; a deviation of ln 0.25 to 0.3 is what is known",
    )

    @property
    def expected_failures(self) -> Mapping[str, str]:  # type: ignore[override]
        """A hot inlet resists less the faster it rolls, from Lt = 11 on: 0.658 = 1.24 Lt^0.62/(3.94 + Lt^0.62)."""
        hot = "the heat of the inlet takes more from the film than speed adds, beyond Lt = 11"
        return (
            {}
            if self.inlet_heating == "none"
            else {"check_resistance_does_not_fall_with_load_and_speed": hot}
        )

    @property
    def reads(self) -> frozenset[str]:  # type: ignore[override]
        """What the two limits read, and what heat of the inlet does."""
        return frozenset(self.domain)

    @property
    def domain(self) -> Domain:  # type: ignore[override]
        """Where all of it is defined."""
        return _DOMAIN if self.inlet_heating == "none" else _HEATED

    def evaluate(self, slices: Slices) -> None:
        """Fill the resistance."""
        c = slices.conditions
        s = slices
        flow = c.viscosity * s.rolling_speed
        a = RIGID * np.sqrt(flow * s.load)
        W = s.load / (c.modulus * c.radius)
        x = (
            a
            * c.pressure_viscosity**0.342
            / (ELASTIC * c.radius * (flow / c.radius) ** 0.658 * W**0.0126)
        )
        large = np.maximum(x, 1.0)
        small = np.minimum(x, 1.0 / large)
        factor = np.asarray(self.factor)
        if self.inlet_heating != "none":
            factor = factor * heated_inlet(thermal_load(s))
        if self.extent == "film":
            Us = 2.0 * flow / (c.modulus * c.radius)
            L = c.pressure_viscosity * c.modulus * Us**0.25
            M2 = W * W / Us
            factor = factor * (1.0 + (WHOLE[0] * L - WHOLE[1]) / (1.0 + 1.0 / M2))
        s.resistance[...] = factor * (a / large) * (1.0 + small**5) ** -0.2

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.rolling_resistance(
            RIGID,
            ELASTIC,
            self.factor,
            self.inlet_heating != "none",
            self.extent == "film",
        )


@attrs.frozen(kw_only=True)
class Hysteresis(ResistanceModel):
    """Resistance of steel that gives back a little less work than it takes: F = f k w b/(3 pi R).

    Rolling by a unit of length the front half of the contact takes up the work int_0^b p (x/R) dx = 2 w b/(3 pi R), of
    which the share k is lost; the two surfaces resist with half of that each.

    Symbols:

    - F: force on each surface for a unit of length [N/m]
    - f: factor for calibration and scatter (``factor``), 1 by default [1]
    - k: share of the work that is lost (``loss``) [1]
    - w: load per length [N/m]
    - b: half width after Hertz, sqrt(8 w R/(pi E')), whatever the pressure in the film [m]
    - R: equivalent radius [m]
    - E': equivalent modulus 2/sum((1 - nu^2)/E) [Pa]

    Range: Hertz's pressure. A film that spreads a light load deforms the steel less, by some share of r of ``light-
    contact``: there the law is high. k is a property of a cycle of stress, and grows with its amplitude. k = 0.01
    is an estimate for hard steel under pressures that leave it elastic (D).

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
    equation: ClassVar[str] = "F = f k w b/(3 pi R), b = sqrt(8 w R/(pi E'))"
    references: ClassVar[tuple[Reference, ...]] = (JOHNSON_1985.at("chapter 9"), GREENWOOD_1961)
    reads = frozenset({"load", "radius", "modulus"})
    domain = MappingProxyType(dict.fromkeys(sorted(reads), POSITIVE))

    loss: float = parameter(
        default=0.01,
        unit="1",
        doc="share k of the work that is lost",
        usual=(0, 0.1),
        possible=(0, 1),
    )
    factor: float = scattering_factor(
        0.7, "the share of the work that hard steel loses, 0.005 to 0.02 in what is published"
    )

    def evaluate(self, slices: Slices) -> None:
        """Fill the resistance."""
        c = slices.conditions
        half_width = np.sqrt(8 * c.radius / (np.pi * c.modulus) * slices.load)
        slices.resistance[...] = (
            self.factor * self.loss / (3 * np.pi * c.radius) * slices.load * half_width
        )

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.hysteresis(self.factor * self.loss)
