"""Mean pressure in the film of a contact, by Hertz or for a light contact; viscosity and traction depend on it."""

from types import MappingProxyType
from typing import ClassVar, Final

import attrs
import numpy as np

from rollslip.bearing.regimes import LIGHT, moes_groups
from rollslip.models import POSITIVE, PressureModel, Tabled, Validity
from rollslip.references import Reference
from rollslip.search import Array
from rollslip_kernels.slices import Slices
from rollslip_kernels.stages import contact as compiled
from rollslip_plugins.bibliography import (
    DOWSON_HIGGINSON_1966,
    JOHNSON_1985,
    MARTIN_1916,
    MOES_1992,
)
from rollslip_plugins.contact import HertzLine
from rollslip_plugins.symbols import explained

#: Coefficients of i = POWER[0] + POWER[1] L + POWER[2] L^2, fitted to numerical solutions up to L = MAX_FITTED_L.
POWER: Final = (0.651, -0.02, -0.0027)
#: Largest L of that fit; from the first of `LUBRICANTS` on r is tabulated.
MAX_FITTED_L: Final = 10.0
#: M of the columns of the table.
LOADS: Final = (0.3, 0.5, 0.6, 0.7, 0.85, 1.0, 1.25, 1.5, 2.0)
#: L of the rows of the table.
LUBRICANTS: Final = (12.0, 15.0, 18.0, 21.0, 25.0)
#: r of numerical solutions. Values above 1 are those of the spike of Barus's law and are cut. Those at M = 2 beyond
#: L = 15, where no solution was found, continue the row: r is 1 there.
SOLVED: Final = (
    (0.151, 0.250, 0.300, 0.350, 0.429, 0.514, 0.683, 0.857, 1.00),
    (0.152, 0.254, 0.308, 0.365, 0.461, 0.589, 0.883, 1.03, 1.13),
    (0.153, 0.259, 0.318, 0.384, 0.521, 0.780, 1.06, 1.18, 1.25),
    (0.154, 0.265, 0.331, 0.414, 0.682, 0.975, 1.21, 1.30, 1.36),
    (0.155, 0.275, 0.357, 0.519, 0.927, 1.19, 1.38, 1.44, 1.46),
)
#: w h/(eta0 u R) of a rigid contact full of oil, by Moes's film. Where a layer of oil makes h smaller, the film begins
#: nearer to the middle of the contact and ends there, too.
FULL_RIGID: Final = 6.0
#: Exponent of the width over that ratio: without flow to the sides width over sqrt(2 R h) is its fourth root.
STARVED_WIDTH: Final = 0.75
#: Largest M of a rigid contact: r = M/2.
RIGID: Final = 0.1
#: log2(M/2) of the nodes of the interpolation.
KNOTS: Final = np.log2(0.5 * np.array((RIGID, *LOADS)))
#: log2(2 r/M) at these nodes, a row for each of `LUBRICANTS`.
RISE: Final = np.column_stack((np.zeros(len(LUBRICANTS)), np.log2(SOLVED) - KNOTS[1:]))
#: M is taken between this and its inverse, so that no logarithm is infinite.
_SMALLEST_M: Final = 1e-250


@attrs.frozen
@explained
class Hertz(PressureModel):
    """The pressure of the dry contact: the film has that of Hertz, p = w/(2 b).

    Symbols:

    - p: mean pressure [Pa]
    - b, w, R, E'

    Range: M = W/sqrt(2 U) from 2 on, where the film is thin beside the deformation of the steel. In a chain it is no
    stage: what the contact model fills stays.

    Examples
    --------
    Hertz with w = pi 2.5e4 N/m: b = sqrt(8 pi 2.5e4 0.01/(pi 2e11)) = 0.1 mm, p = w/(2 b).

    >>> from rollslip import Conditions, Slices
    >>> slices = Slices(1, Conditions(radius=0.01, modulus=2e11), load=78539.816340)
    >>> Hertz().evaluate(slices)
    >>> f"{slices.half_width[0]:.6e} {slices.pressure[0]:.6e}"
    '1.000000e-04 3.926991e+08'
    """

    name: ClassVar[str] = "hertz"
    equation: ClassVar[str] = "p = w/(2 b), b = sqrt(8 w R/(pi E'))"
    references: ClassVar[tuple[Reference, ...]] = (JOHNSON_1985,)
    reads = frozenset({"load", "radius", "modulus"})
    domain = MappingProxyType(dict.fromkeys(sorted(reads), POSITIVE))
    of_contact: ClassVar[bool] = True
    validity: ClassVar[tuple[Validity, ...]] = (
        Validity(
            code="W10",
            quantity="load_parameter",
            low=LIGHT,
            consequence="the pressure in the film is far from Hertz's, on which traction is based: its mean by load is "
            "at most {error} lower",
            error=Tabled(((0.1, 95.0), (0.2, 90.0), (0.5, 76.0), (1.0, 58.0), (2.0, 36.0))),
            remedy="models.pressure = 'light-contact'",
            replacement="light-contact",
            source="the isoviscous contact, the worst of L = 0 to 15, by reynolds-line (docs/scripts/validity.py)",
        ),
    )

    evaluate = HertzLine.evaluate
    kernel = HertzLine.kernel


@attrs.frozen
@explained
class LightContact(PressureModel):
    """Hertz's mean pressure times r(M, L), of a film that carries the load over more than Hertz's width: b over r.

    r is the mean by load int p^2 dx/int p dx of a numerically solved line contact over Hertz's 8/(3 pi) p_H. Up to
    L = 10 it is r = [1 + (M/2)^(-1/i)]^(-i), i = 0.651 - 0.02 L - 0.0027 L^2. From L = 12 on log(2 r/M) is
    interpolated in log(M) and L between values of solutions, and r is 1 where they are above 1, which is a spike of
    Barus's law; between the two log(r) is linear in L, and beyond L = 25 r is that of 25. The film thickness and the
    load stay.

    Symbols:

    - p: mean pressure in the film [Pa]
    - b: half width over which it carries the load, w/(2 p) [m]
    - b_H: half width after Hertz, sqrt(8 w R/(pi E')) [m]
    - p_H: largest Hertz pressure [Pa]
    - r: pressure over Hertz's: M/2 in a rigid contact, M to 0, and 1 in a heavy one [1]
    - i: how slowly one becomes the other [1]
    - M: Moes load parameter w/(E' R)/sqrt(2 U) [1]
    - L: Moes lubricant parameter alpha E' (2 U)^(1/4) [1]
    - U, w, R, E', h, eta0, u, alpha

    Range: steady, isothermal, fully flooded line contacts of Barus's oil. Against numerical solutions at M from 0.05
    to 10 and L from 0 to 25 the fit is 3.3 % low to 3.8 % high, the interpolation 1.7 % low to 3.4 % high. Roelands's
    oil has another r at L = 10: the same at M = 0.5, 2 to 5 % less at 1, 7 to 15 % less at 1.5 to 2. A light contact
    whose film is thinner than its load asks for, by a layer of oil or by a law of elastic films, carries it over less:
    b_H/r [w h/(6 eta0 u R)]^(3/4), where that ratio is below 1. Its friction 2 b eta0 V/h is 16 to 50 % above that of
    a rigid contact without flow to the sides. Viscosity, traction, the heat of the film, its partition and damage read
    this pressure and width; the film, the stiffness of the contact and hysteresis rest on the load and Hertz's width.

    Examples
    --------
    M = 2e-5/sqrt(2 1e-10) = sqrt(2), of an oil that pressure does not thicken, where i = 0.651:
    r = (1 + 2^(0.5/0.651))^(-0.651) = 0.52345, and Hertz's mean pressure is sqrt(pi 2e11 4e4/0.32) = 280.25 MPa.

    >>> from rollslip import Conditions, Slices
    >>> oil = Conditions(radius=0.01, modulus=2e11, viscosity=0.01, pressure_viscosity=0.0)
    >>> slices = Slices(1, oil, load=4e4, rolling_speed=20.0, film_thickness=1e-6)
    >>> LightContact().evaluate(slices)
    >>> f"{slices.pressure[0] / 1e6:.2f} MPa"
    '146.70 MPa'
    """

    name: ClassVar[str] = "light-contact"
    equation: ClassVar[str] = (
        "p = w/(2 b), b = max[b_H, b_H/r f], f = min[1, w h/(6 eta0 u R)]^(3/4), r = [1 + (M/2)^(-1/i)]^(-i), "
        "i = 0.651 - 0.02 L - 0.0027 L^2; a table from L = 12"
    )
    reads = PressureModel.reads | {"film_thickness"}
    domain = MappingProxyType({**PressureModel.domain, "film_thickness": POSITIVE})
    references: ClassVar[tuple[Reference, ...]] = (
        MOES_1992,
        DOWSON_HIGGINSON_1966,
        MARTIN_1916,
        JOHNSON_1985,
    )
    validity: ClassVar[tuple[Validity, ...]] = (
        Validity(
            code="W17",
            quantity="load_parameter",
            low=LIGHT,
            consequence="the mean pressure replaces that of the film: traction differs by {error} from the full "
            "solution",
            error=Tabled(((0.2, 19.0), (0.5, 5.0), (1.0, 25.0))),
            remedy="no built-in model is closer; models.pressure = 'hertz' differs more, and shows the effect",
            source="Eyring's stress over numerical pressures (M = 0.2), the exact field over them at M = 0.5 and 1, "
            "L = 8.5 to 12, slips of 0.2 to 60 %",
        ),
    )

    def evaluate(self, slices: Slices) -> None:
        """Fill half width and mean pressure."""
        Hertz().evaluate(slices)
        M, L = moes_groups(slices)
        r = pressure_ratio(M, np.asarray(L))
        c = slices.conditions
        rigid = FULL_RIGID * c.viscosity * c.radius * slices.rolling_speed
        full = np.minimum(slices.load * slices.film_thickness / rigid, 1.0)
        widening = np.maximum(full**STARVED_WIDTH / r, 1.0)
        slices.half_width[...] *= widening
        slices.pressure[...] /= widening

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.light_contact(POWER, MAX_FITTED_L, KNOTS, LUBRICANTS, RISE)


def pressure_ratio(M: Array, L: Array) -> Array:
    """Return the mean pressure in the film relative to Hertz's.

    Parameters
    ----------
    M, L : ndarray
        Moes's load and lubricant parameters [1], of one shape.
    """
    x = np.log2(0.5 * np.clip(M, _SMALLEST_M, 1 / _SMALLEST_M))
    of_fit = np.minimum(L, MAX_FITTED_L)
    i = POWER[0] + of_fit * (POWER[1] + of_fit * POWER[2])
    fitted = np.minimum(x, 0.0) - i * np.log1p(np.exp2(-np.abs(x) / i)) / np.log(2)
    uncut = np.array([x + np.interp(x, KNOTS, row) for row in RISE])
    k = np.clip(np.searchsorted(LUBRICANTS, L, side="right") - 1, 0, len(LUBRICANTS) - 2)
    low = np.take(LUBRICANTS, k)
    part = np.clip((L - low) / (np.take(LUBRICANTS, k + 1) - low), 0.0, 1.0)
    below, above = (np.take_along_axis(uncut, at[None], axis=0)[0] for at in (k, k + 1))
    tabled = np.minimum(below + part * (above - below), 0.0)
    fraction = np.clip((L - MAX_FITTED_L) / (LUBRICANTS[0] - MAX_FITTED_L), 0.0, 1.0)
    return np.asarray(np.exp2(fitted + fraction * (tabled - fitted)))
