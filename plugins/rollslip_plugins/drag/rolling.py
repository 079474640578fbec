"""Rolling resistance of a loaded contact: by the pressure of the oil film, and by elastic hysteresis of steel."""

import abc
import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import ClassVar, Final

import attrs
import numpy as np

from rollslip.fields import Scatter, choice_of, parameter, positive
from rollslip.models import NON_NEGATIVE, POSITIVE, Domain, ResistanceModel, Validity
from rollslip.references import Reference
from rollslip.scene.supply import PLENTY
from rollslip.search import Array
from rollslip_kernels.slices import Slices
from rollslip_kernels.stages import drag as compiled
from rollslip_plugins.bibliography import (
    BIBOULET_2010,
    GOKSEM_1978,
    GREENWOOD_1961,
    JOHNSON_1985,
    MARTIN_1916,
    MURCH_1975,
    ZHOU_1991,
)
from rollslip_plugins.drag.factor import scattering_factor
from rollslip_plugins.film.corrections import (
    LAWS,
    heated_inlet,
    oil_before_contact,
    stated_layer,
    thermal_load,
)
from rollslip_plugins.symbols import explained

#: Factor of F = RIGID sqrt(eta u w): int h dp/2 of a parabolic gap that is open to the inlet, with Reynolds's condition
#: at the exit. Exact.
RIGID: Final = 2.0796226511
#: The same as f/sqrt(M), RIGID/sqrt(2).
RIGID_GROUP: Final = 1.4705152789
#: Elastic limit at L to infinity. Fitted, as the next five, to numerical solutions (rolling_resistance_map.csv).
ELASTIC: Final = 1.43
#: What the elastic limit has more at L = 0.
THIN_OIL: Final = 0.63
#: L at which half of that is left.
THIN_OIL_L: Final = 4.3
#: M from which on the elastic limit falls with load.
HEAVY_M: Final = 210.0
#: Exponent of that fall.
HEAVY_EXPONENT: Final = -0.17
#: Exponent p of (a^-p + e^-p)^(-1/p) between the limits.
BLEND: Final = 4.1
#: f of the oil before X is TAIL/X: H = X^2/2 and P = 8/X^3 there. Exact.
TAIL: Final = 6.0
#: 2 h M/(R Us^(1/2)) of the film h of a rigid contact, 4.895 for the exact solution.
RIGID_FILM: Final = 4.9
#: 2 h/(R Us^(1/2) L^(2/3)) of the film h of a rigid contact whose oil pressure thickens: 2 1.05 by Moes's form. Fitted.
THICK_FILM: Final = 2.1
#: Exponent of a thin layer in (1 + 2 rho^2)^-LAYER, fitted to two-dimensional solutions of rigid rollers.
LAYER: Final = 0.6
#: -ln of what is left of a rigid contact whose inlet begins at k = 1.
RIGID_INLET: Final = TAIL / (RIGID_GROUP * math.sqrt(RIGID_FILM))
#: Smallest M that is told from others, and the inverse of the largest. Beyond it no contact is; no product overflows.
MIN_LOAD: Final = 1e-250


_OIL: Final = ("load", "rolling_speed", "radius", "modulus", "viscosity")
_DOMAIN: Final[Domain] = MappingProxyType(
    {**dict.fromkeys(_OIL, POSITIVE), "pressure_viscosity": NON_NEGATIVE}
)
_HEATED: Final[Domain] = MappingProxyType({**LAWS["murch-wilson"], **_DOMAIN})
_LARGEST: Final = POSITIVE[1]


def _compared(quantity: str, high: float, inside: str, low: float = 0.0) -> Validity:
    """Return the range in which a law was compared with numerical solutions, and its errors ``inside``."""
    return Validity(
        code="W22",
        quantity=quantity,
        low=low,
        high=high,
        consequence=f"the resistance is not checked against a numerical solution; inside {inside}",
        remedy="no built-in model is checked there; take it for an estimate",
        source="numerical solutions, isothermal: tools/references/rolling_resistance.py",
    )


@attrs.frozen(kw_only=True)
class _FilmResistance(ResistanceModel):
    """A resistance of the film: isothermal, times a factor of a heated inlet, times a factor of calibration."""

    inlet_heating: str = parameter(
        default="murch-wilson",
        validator=choice_of("none", "murch-wilson"),
        doc="reduction by shear heating of the inlet: 'none' or 'murch-wilson'",
    )
    factor: float

    @property
    def expected_failures(self) -> Mapping[str, str]:  # type: ignore[override]
        """Say why the resistance may fall with load or speed."""
        reason = self._falls
        return {"check_resistance_does_not_fall_with_load_and_speed": reason} if reason else {}

    @property
    def _falls(self) -> str:
        """Why it falls; empty where it does not. A hot inlet: 0.658 = 1.24 Lt^0.62/(3.94 + Lt^0.62) at Lt = 11."""
        hot = "the heat of the inlet takes more from the film than speed adds, beyond Lt = 11"
        return "" if self.inlet_heating == "none" else hot

    @property
    def reads(self) -> frozenset[str]:  # type: ignore[override]
        """What both limits read, and what heat of the inlet does."""
        return frozenset(self.domain)

    @property
    def domain(self) -> Domain:  # type: ignore[override]
        """Where all of it is defined."""
        return _DOMAIN if self.inlet_heating == "none" else _HEATED

    def evaluate(self, slices: Slices) -> None:
        """Fill the resistance."""
        c = slices.conditions
        heated = self.inlet_heating != "none"
        factor = self.factor * heated_inlet(thermal_load(slices)) if heated else self.factor
        a = RIGID * np.sqrt(c.viscosity * slices.rolling_speed * slices.load)
        slices.resistance[...] = factor * a * self._over_rigid(slices)

    @abc.abstractmethod
    def _over_rigid(self, s: Slices) -> Array:
        """Return the resistance of a cold film over that of a rigid, isoviscous one."""


def _blend(x: Array, exponent: float) -> Array:
    """Return (1 + x^p)^(-1/p), without overflow."""
    large = np.maximum(x, 1.0)
    small = np.minimum(x, 1.0 / large)
    return np.asarray((1.0 + small**exponent) ** (-1.0 / exponent) / large)


@attrs.frozen(kw_only=True)
@explained
class RollingResistance(_FilmResistance):
    """Resistance of the whole film to rolling, from the rigid to the elastic limit, whose inlet begins at a distance.

    F = f C_T E' R Us^(3/4) f0 exp(-6/(f0 X_a)), f0 = (a^-4.1 + e^-4.1)^(-1/4.1), a = 1.4705 sqrt(M),
    e = [1.43 + 0.63/(1 + L/4.3)] (1 + M/210)^-0.17, X_a = k sqrt(8 M/pi + 4.9/M + 2.1 L^(2/3)). a is exact for a rigid,
    isoviscous contact; e is fitted to numerical solutions. The oil before X_a makes 6/X_a of f0 (exact far out), and
    the exponential is what is left where the inlet begins there. Heat thins the inlet as it thins the film.

    The inlet begins at the nearer one of two places, k = min(``reach``, k_layer): ``reach`` is set by the surroundings,
    k_layer = 1.8432/(0.6 ln(1 + 2 rho^2)) by a layer of oil, which makes the exponential (1 + 2 rho^2)^-0.6 in the
    rigid limit. Both describe the same want of oil and are not multiplied.

    Symbols:

    - F: force on each surface for a unit of length, int h dp/2 over the film [N/m]
    - f
    - f0: f of a flooded film, F/(E' R Us^(3/4)) [1]
    - a, e: rigid and elastic limit of f0 [1]
    - C_T: reduction by shear heating of the inlet (``inlet_heating``), 3.94/(3.94 + Lt^0.62) [1]
    - Lt: thermal load eta0 beta0 u^2/K_f [1]
    - beta0: fall of the viscosity with temperature -dln(eta0)/dT [1/K]
    - X_a: where the inlet begins, distance from the middle of the contact over R Us^(1/4) [1]
    - k: that distance over sqrt(b^2 + 2 R h), b after Hertz and h the film of a rigid contact [1]
    - rho: h over the layer (``oil_layer``), h = R Us^(1/2) (2.45/M + 1.05 L^(2/3)) [1]
    - Us: 2 eta0 u/(E' R) [1]
    - M: load parameter w/(E' R Us^(1/2)) [1]
    - L: lubricant parameter alpha E' Us^(1/4) [1]
    - K_f, eta0, u, w, R, alpha, E'

    Range: isothermal and flooded -3.3 to +2.0 % of numerical solutions (Roelands, density of Dowson and Higginson) for
    M from 0.1 to 200 and L from 1 to 20, rms 1.3 %; -6.6 to +5.3 % at L = 0. Below M = 0.1 it nears the exact rigid
    limit. An oil without density that follows Barus's law resists more: the law is 7 % low at L = 10, 20 % at L = 20.
    With an inlet from k = 3 on -2 to +7 %, at L = 0 up to +17 %. The layer is checked for rigid rollers alone, M < 1:
    -13 to +17 %, rms 9 %; below 2 um it starves loaded contacts by a law that is not checked for them. ``reach`` 3 is
    an estimate, with which torques of bearings are met best (D). Beyond Lt = 10 C_T is compared with nothing.

    Examples
    --------
    Light, flooded contacts are rigid: 2.0796226511 sqrt(0.01 20 2) = 1.315269. An inlet from k = 3 on leaves
    exp(-1.8432/3) = 0.54095 of that.

    >>> from rollslip import Conditions, Slices
    >>> oil = Conditions(radius=0.01, modulus=2e11, viscosity=0.01, pressure_viscosity=0.0)
    >>> slices = Slices(1, oil, load=2.0, rolling_speed=20.0)
    >>> flooded = RollingResistance(inlet_heating="none", reach=math.inf)
    >>> for drag in (flooded, RollingResistance(inlet_heating="none")):
    ...     drag.evaluate(slices)
    ...     f"{slices.resistance[0]:.4f}"
    '1.3153'
    '0.7115'
    """

    name: ClassVar[str] = "rolling-resistance"
    equation: ClassVar[str] = (
        "F = f C_T E' R Us^(3/4) f0 exp(-6/(f0 X_a)), f0 = (a^-4.1 + e^-4.1)^(-1/4.1), a = 1.4705 sqrt(M), "
        "e = [1.43 + 0.63/(1 + L/4.3)] (1 + M/210)^-0.17, X_a = k sqrt(8 M/pi + 4.9/M + 2.1 L^(2/3)), "
        "C_T = 3.94/(3.94 + Lt^0.62)"
    )
    references: ClassVar[tuple[Reference, ...]] = (
        BIBOULET_2010,
        ZHOU_1991,
        GOKSEM_1978,
        MARTIN_1916,
        MURCH_1975,
    )
    validity: ClassVar[tuple[Validity, ...]] = (
        _compared("load_parameter", 200.0, "it is 7 % low to 5 % high"),
        _compared("lubricant_parameter", 20.0, "it is 7 % low to 5 % high"),
    )

    reach: float = parameter(
        default=3.0,
        unit="1",
        validator=positive,
        doc="where the inlet begins, over sqrt(b^2 + 2 R h)",
        keywords={"flooded": math.inf},
        usual=(2, math.inf),
        possible=(0.01, math.inf),
        scatter=Scatter(
            distribution="log-uniform",
            parameters={"low": 2.0, "high": 6.0},
            grade="(D)",
            source="inlets of printed solutions begin at 2.5 to 5.5, and from 2 to flooded torques rise by 1.44",
        ),
    )
    oil_layer: float = oil_before_contact()
    factor: float = scattering_factor(
        0.2,
        "makers' own torques differ by 1.7 to 2.4 from each other, of which `reach` scatters a part; a deviation of ln "
        "0.2 is what is left",
    )

    @property
    def _falls(self) -> str:
        """Why it falls: the elastic limit falls with load, which the inlet's rise outweighs for a while."""
        load = "a flooded film resists less the heavier it is loaded from M = 10 on, one from k = 3 on from M = 70"
        heat = super()._falls
        return f"{load}; {heat}" if heat else load

    def _over_rigid(self, s: Slices) -> Array:
        """Return f0/a exp(-6/(f0 X_a)); M, alpha E' and Us are limited, so that no product of 0 and inf arises."""
        c = s.conditions
        stiffness = c.modulus * c.radius
        flow = 2.0 * c.viscosity * s.rolling_speed
        Us = np.minimum(flow / stiffness, _LARGEST)
        M = np.clip(s.load / np.sqrt(flow * stiffness), MIN_LOAD, 1.0 / MIN_LOAD)
        L_third = np.minimum(c.pressure_viscosity * c.modulus, 1e300) ** (1 / 3) * Us ** (1 / 12)
        e = ELASTIC + THIN_OIL / (1.0 + L_third**3 / THIN_OIL_L)
        e = e * (1.0 + M / HEAVY_M) ** HEAVY_EXPONENT
        blend = _blend(RIGID_GROUP * np.sqrt(M) / e, BLEND)
        thick = THICK_FILM * L_third**2
        wide = np.sqrt((8.0 / np.pi * M + thick) * M + RIGID_FILM)  # X_a/k sqrt(M)
        inlet = np.asarray(1.0 / self.reach)
        if (layer := stated_layer(self.oil_layer)) < PLENTY:
            film = c.radius * np.sqrt(Us) * (RIGID_FILM / M + thick) / 2
            rho = np.minimum(film / layer, 1e150)
            inlet = np.maximum(inlet, LAYER / RIGID_INLET * np.log1p(2.0 * rho * rho))
        return np.asarray(blend * np.exp(-TAIL / (RIGID_GROUP * blend * wide) * inlet))

    def kernel(self) -> object:
        """Return the compiled form."""
        heated = self.inlet_heating != "none"
        layer = stated_layer(self.oil_layer)
        return compiled.rolling_resistance(self.factor, self.reach, layer, heated)


@attrs.frozen(kw_only=True)
class _PowerResistance(_FilmResistance):
    """A resistance F = f C_T (a^-5 + b^-5)^(-1/5), a = 2.0796 sqrt(eta0 u w), b = COEFFICIENT (R/alpha) (G U)^q W^p."""

    #: COEFFICIENT, q and p of b.
    elastic: ClassVar[tuple[float, float, float]]

    factor: float = scattering_factor(
        0.30,
        "makers' own torques differ by 1.7 to 2.4 from each other, the whole film resists by up to 58 % more than the "
        "inlet, and what was left out of it adds about as much; a deviation of ln 0.25 to 0.3 is what is known",
    )

    def _over_rigid(self, s: Slices) -> Array:
        """Return (1 + (a/b)^5)^(-1/5)."""
        coefficient, q, p = self.elastic
        c = s.conditions
        flow = c.viscosity * s.rolling_speed
        W = s.load / (c.modulus * c.radius)
        b = coefficient * c.radius * (flow / c.radius) ** q * W**p
        a = RIGID * np.sqrt(flow * s.load)
        return _blend(a * c.pressure_viscosity ** (1.0 - q) / b, 5.0)

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.power_resistance(self.factor, *self.elastic, self.inlet_heating != "none")


@attrs.frozen(kw_only=True)
@explained
class GoksemHargreaves(_PowerResistance):
    """Resistance of the inlet to rolling, between the rigid and the elastic limit.

    F = f C_T (a^-5 + b^-5)^(-1/5), a = 2.0796 sqrt(eta0 u w), b = 4.318 (R/alpha) (G U)^0.658 W^0.0126. a is exact for
    a rigid, isoviscous contact; b is Goksem and Hargreaves's fit for the inlet of an elastic one. Heat thins the inlet
    as it thins the film: C_T = 3.94/(3.94 + Lt^0.62), which agrees with SKF's regression of tests within 4 % (C).

    Symbols:

    - F: force on each surface for a unit of length, int h dp/2 over the film [N/m]
    - f
    - a, b: its rigid and its elastic limit [N/m]
    - C_T: reduction by shear heating of the inlet (``inlet_heating``), that of film 'inlet-correction' [1]
    - Lt: thermal load eta0 beta0 u^2/K_f [1]
    - beta0: fall of the viscosity with temperature -dln(eta0)/dT [1/K]
    - K_f, eta0, u, w
    - M: load parameter W/sqrt(2 U) [1]
    - L: lubricant parameter G (2 U)^(1/4) [1]
    - R, alpha, G, U, W, E'

    Range: isothermal, against a numerical solution (Barus) -36 to 0 % at M from 0.2 to 20 and L from 5 to 15, of
    which -15 to 0 % up to M = 1 and L = 10. b counts the inlet alone, which the law meets to -23 to +15 %; the exit,
    where the pressure falls through a film that narrows, adds up to half as much. Beyond Lt = 10 C_T is compared with
    nothing.

    Examples
    --------
    An oil that pressure does not thicken leaves a alone: 2.0796226511 sqrt(0.01 20 2e5) = 2.0796226511 200.

    >>> from rollslip import Conditions, Slices
    >>> oil = Conditions(radius=0.01, modulus=2e11, viscosity=0.01, pressure_viscosity=0.0)
    >>> slices = Slices(1, oil, load=2e5, rolling_speed=20.0)
    >>> GoksemHargreaves(inlet_heating="none").evaluate(slices)
    >>> f"{slices.resistance[0]:.5f}"
    '415.92453'
    """

    name: ClassVar[str] = "goksem-hargreaves"
    equation: ClassVar[str] = (
        "F = f C_T (a^-5 + b^-5)^(-1/5), a = 2.0796 sqrt(eta0 u w), b = 4.318 (R/alpha) (G U)^0.658 W^0.0126, "
        "C_T = 3.94/(3.94 + Lt^0.62)"
    )
    references: ClassVar[tuple[Reference, ...]] = (GOKSEM_1978, MARTIN_1916, MURCH_1975)
    validity: ClassVar[tuple[Validity, ...]] = (
        _compared("load_parameter", 20.0, "it is 0 to 36 % low", 0.2),
        _compared("lubricant_parameter", 15.0, "it is 0 to 36 % low", 5.0),
    )
    elastic = (4.318, 0.658, 0.0126)


@attrs.frozen(kw_only=True)
@explained
class ZhouHoeprich(_PowerResistance):
    """Resistance of the film to rolling, between the rigid limit and a fit of Zhou and Hoeprich for tapered rollers.

    F = f C_T (a^-5 + b^-5)^(-1/5), a = 2.0796 sqrt(eta0 u w), b = 29.2 (R/alpha) (G U)^0.648 W^0.246. Flooded films do
    not rise with load like that. Solutions do whose inlet begins some half widths before the contact.

    Symbols:

    - F: force on each surface for a unit of length, int h dp/2 over the film [N/m]
    - f
    - a, b: its rigid and its elastic limit [N/m]
    - C_T: reduction by shear heating of the inlet (``inlet_heating``), 3.94/(3.94 + Lt^0.62) [1]
    - Lt: thermal load eta0 beta0 u^2/K_f [1]
    - beta0: fall of the viscosity with temperature -dln(eta0)/dT [1/K]
    - K_f, eta0, u, w, R, alpha, G, U, W, E'
    - M: load parameter W/sqrt(2 U) [1]
    - L: lubricant parameter G (2 U)^(1/4) [1]

    Range: -66 to +58 % of flooded numerical solutions with L from 1 to 20 and M from 0.1 to 200, G = 4540. Beyond
    Lt = 10 C_T is compared with nothing.

    Examples
    --------
    An oil that pressure does not thicken leaves a alone: 2.0796226511 sqrt(0.01 20 2e5) = 2.0796226511 200.

    >>> from rollslip import Conditions, Slices
    >>> oil = Conditions(radius=0.01, modulus=2e11, viscosity=0.01, pressure_viscosity=0.0)
    >>> slices = Slices(1, oil, load=2e5, rolling_speed=20.0)
    >>> ZhouHoeprich(inlet_heating="none").evaluate(slices)
    >>> f"{slices.resistance[0]:.5f}"
    '415.92453'
    """

    name: ClassVar[str] = "zhou-hoeprich"
    equation: ClassVar[str] = (
        "F = f C_T (a^-5 + b^-5)^(-1/5), a = 2.0796 sqrt(eta0 u w), b = 29.2 (R/alpha) (G U)^0.648 W^0.246, "
        "C_T = 3.94/(3.94 + Lt^0.62)"
    )
    references: ClassVar[tuple[Reference, ...]] = (ZHOU_1991, MARTIN_1916, MURCH_1975)
    validity: ClassVar[tuple[Validity, ...]] = (
        _compared("load_parameter", 200.0, "it is 66 % low to 58 % high", 0.1),
        _compared("lubricant_parameter", 20.0, "it is 66 % low to 58 % high", 1.0),
    )
    elastic = (29.2, 0.648, 0.246)


@attrs.frozen(kw_only=True)
class Hysteresis(ResistanceModel):
    """Resistance of steel that gives back a little less work than it takes: F = f k w b/(3 pi R).

    Rolling by a unit of length the front half of the contact takes up the work int_0^b p (x/R) dx = 2 w b/(3 pi R), of
    which the fraction k is lost; the two surfaces resist with half of that each.

    Symbols:

    - F: force on each surface for a unit of length [N/m]
    - f: factor for calibration and scatter (``factor``), 1 by default [1]
    - k: fraction of the work that is lost (``loss``) [1]
    - w: load per length [N/m]
    - b: half width after Hertz, sqrt(8 w R/(pi E')), whatever the pressure in the film [m]
    - R: equivalent radius [m]
    - E': equivalent modulus 2/sum((1 - nu^2)/E) [Pa]

    Range: Hertz's pressure. A film that spreads a light load deforms the steel less, by some fraction of r of ``light-
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
        doc="fraction k of the work that is lost",
        usual=(0, 0.1),
        possible=(0, 1),
    )
    factor: float = scattering_factor(
        0.7, "the fraction of the work that hard steel loses, 0.005 to 0.02 in what is published"
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
