"""Film thickness in the four regimes of a lubricated line contact, and the regime of a contact.

h/R = c U^u G^g W^w in each, mean entrainment speed, minimum film. Elasticity thickens the isoviscous film and thins
the piezoviscous one, and the thicker of the two mechanisms holds (Johnson 1970): h = max(max(IR, IE), min(VR, VE)).
The boundaries are where two of them meet, with g_V = W^1.5 G/U^0.5 and g_E = W/U^0.5: g_V = 5.035 (IR/VR),
g_E = 1.770 (IR/IE), g_V = 38.97 g_E^0.4737 (VR/VE) and g_V = 1.337 g_E^1.3704 (IE/VE).
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from rollslip.models.validity import FILM_REGIMES
from rollslip.search import Array
from rollslip_kernels.slices import Slices


class PowerLaw(NamedTuple):
    """Film thickness h = R c U^u G^g W^w."""

    c: float
    u: float
    g: float
    w: float

    def __call__(self, U: ArrayLike, G: ArrayLike, W: ArrayLike) -> Array:
        """Return h/R."""
        return np.asarray(self.c * np.power(U, self.u) * np.power(G, self.g) * np.power(W, self.w))


MARTIN: Final = PowerLaw(4.89497, 1.0, 0.0, -1.0)
BLOK: Final = PowerLaw(1.66630, 2 / 3, 2 / 3, 0.0)
HERREBRUGH: Final = PowerLaw(3.10, 0.6, 0.0, -0.2)
DOWSON_1968: Final = PowerLaw(2.65, 0.70, 0.54, -0.13)

#: Code in the column ``regime`` -> name.
NAMES: Final = tuple(FILM_REGIMES)
#: Below this Moes load parameter M the pressure in the film is far from Hertz's.
LIGHT: Final = 2.0
LONG_NAMES: Final = FILM_REGIMES


def groups(slices: Slices) -> tuple[Array, Any, Array]:
    """Return the speed, material and load parameter U = eta0 u/(E'R), G = alpha E', W = w/(E'R)."""
    c = slices.conditions
    return (
        c.viscosity * slices.rolling_speed / (c.modulus * c.radius),
        c.pressure_viscosity * c.modulus,
        slices.load / (c.modulus * c.radius),
    )


def moes_groups(slices: Slices) -> tuple[Array, Array]:
    """Return the load and lubricant parameter M = W/sqrt(2 U), L = G (2 U)^(1/4)."""
    U, G, W = groups(slices)
    return W / np.sqrt(2 * U), G * (2 * U) ** 0.25


def film_by_regime(U: ArrayLike, G: ArrayLike, W: ArrayLike) -> tuple[Array, Array]:
    """Return h/R by the formula of the regime, and the regime's code: 0 IR, 1 VR, 2 IE, 3 VE."""
    ir, vr, ie, ve = (law(U, G, W) for law in (MARTIN, BLOK, HERREBRUGH, DOWSON_1968))
    isoviscous = np.maximum(ir, ie)
    piezoviscous = np.minimum(vr, ve)
    code = np.where(
        piezoviscous > isoviscous, np.where(ve < vr, 3.0, 1.0), np.where(ie > ir, 2.0, 0.0)
    )
    return np.maximum(isoviscous, piezoviscous), code


def regime_limits(U: ArrayLike, G: ArrayLike) -> tuple[Array, Array, Array]:
    """Return the loads W beyond which a contact is elastic if isoviscous, is piezoviscous, is elastic if piezoviscous.

    These are the boundaries between the regimes of `film_by_regime`: of two power laws the one that falls less with W
    is the larger one beyond the load where both are equal. NaN or infinite where the two laws are nowhere equal, for an
    oil whose viscosity does not rise with pressure.
    """

    def load_at_crossing(larger: PowerLaw, smaller: PowerLaw) -> Array:
        return np.asarray(
            (smaller(U, G, 1.0) / larger(U, G, 1.0)) ** (1.0 / (larger.w - smaller.w))
        )

    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        piezoviscous = [
            load_at_crossing(thick, thin)
            for thick in (BLOK, DOWSON_1968)
            for thin in (MARTIN, HERREBRUGH)
        ]
        return (
            load_at_crossing(HERREBRUGH, MARTIN),
            np.maximum.reduce(piezoviscous),
            load_at_crossing(BLOK, DOWSON_1968),
        )


class Quantity(NamedTuple):
    """A dimensionless quantity of evaluated slices, in which laws state their range of validity."""

    symbol: str
    meaning: str
    of: Callable[[Slices], Array]


def _thermal_load(slices: Slices) -> Array:
    c = slices.conditions
    return np.asarray(c.viscosity * c.thermoviscosity * slices.rolling_speed**2 / c.conductivity)


def _viscous(slices: Slices) -> Array:
    U, G, W = groups(slices)
    return np.asarray(W**1.5 * G / np.sqrt(U))


#: Quantities in which every law may state its validity, apart from its own ones and the members of the slices.
QUANTITIES: Final[Mapping[str, Quantity]] = MappingProxyType(
    {
        "load_parameter": Quantity(
            "M", "Moes load parameter W/sqrt(2 U)", lambda s: moes_groups(s)[0]
        ),
        "lubricant_parameter": Quantity(
            "L", "Moes lubricant parameter G (2 U)^(1/4)", lambda s: moes_groups(s)[1]
        ),
        "viscous_parameter": Quantity("g_V", "W^1.5 G/U^0.5 of the film regimes", _viscous),
        "film_regime": Quantity(
            "",
            "film regime after Johnson, in the order of FILM_REGIMES",
            lambda s: film_by_regime(*groups(s))[1],
        ),
        "film_parameter": Quantity(
            "Lambda",
            "film over composite roughness",
            lambda s: s.film_thickness / s.conditions.roughness,
        ),
        "pressure_exponent": Quantity(
            "ln(eta/eta0)",
            "logarithm of the viscosity under pressure over that at ambient pressure, alpha p after Barus",
            lambda s: np.log(s.film_viscosity / s.conditions.viscosity),
        ),
        "width_ratio": Quantity(
            "b/R", "half width over radius", lambda s: s.half_width / s.conditions.radius
        ),
        "slide_roll_ratio": Quantity(
            "|V|/u",
            "sliding over rolling speed",
            lambda s: np.abs(s.sliding_speed) / s.rolling_speed,
        ),
        "thermal_load": Quantity("Lt", "heating of the inlet eta0 beta0 u^2/K_f", _thermal_load),
    }
)
