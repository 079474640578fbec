"""Film thickness of a lubricated line contact: the four asymptotic regimes, their fits and a composite.

- One convention: E' = 2/sum((1-nu^2)/E), w = Q/l, u the mean entrainment speed, U = eta0 u/(E'R), W = w/(E'R),
  G = alpha E'. Formulas published for the sum of speeds are converted, never mixed.
- All but two formulas are a power law of U, G, W; a class is its numbers, one evaluation and one loop serve them all.
- Each class states which thickness it returns and in which regime it is valid; outside it, the study warns.
"""

from types import MappingProxyType
from typing import ClassVar

import attrs
import numpy as np

from rollslip.bearing.regimes import (
    BLOK,
    DOWSON_1968,
    HERREBRUGH,
    MARTIN,
    PowerLaw,
    film_by_regime,
    groups,
)
from rollslip.fields import choice_of, parameter
from rollslip.models import POSITIVE, FilmModel, ReferenceValue, Validity
from rollslip.references import Reference
from rollslip_kernels.slices import Slices
from rollslip_kernels.stages import film as compiled
from rollslip_plugins.bibliography import (
    BLOK_1963,
    DOWSON_EHD_1968,
    DOWSON_HIGGINSON_1966,
    DOWSON_TOYODA_1979,
    HERREBRUGH_1968,
    JOHNSON_1970,
    MARTIN_1916,
    MOES_1992,
    PAN_1989,
    WEBER_1954,
)
from rollslip_plugins.symbols import explained

#: Domain of the piezoviscous fits: without pressure viscosity they would give no film.
PIEZOVISCOUS = MappingProxyType({**FilmModel.domain, "pressure_viscosity": POSITIVE})


def _mapped(off: str) -> tuple[Validity, ...]:
    """Return the ranges of M and L over which a film of all regimes was compared with ``reynolds-line``."""
    return tuple(
        Validity(
            code=code,
            quantity=quantity,
            high=high,
            consequence=f"its film is not checked against a numerical solution; inside it errs by {off}",
            remedy="film 'reynolds-line', where it finds a solution",
            source="reynolds-line: docs/scripts/film_error_map.py",
        )
        for code, quantity, high in (
            ("W04", "load_parameter", 200.0),
            ("W03", "lubricant_parameter", 15.0),
        )
    )


class _PowerLaw(FilmModel):
    """Film thickness h = R c U^u G^g W^w."""

    location: ClassVar[str] = "minimum"
    law: PowerLaw

    def evaluate(self, slices: Slices) -> None:
        """Fill the film thickness."""
        slices.film_thickness[...] = slices.conditions.radius * self.law(*groups(slices))

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.power(*self.law)


@attrs.frozen
@explained
class Martin(_PowerLaw):
    """Rigid, isoviscous minimum film after Martin: h = 4.89497 eta0 u R/w.

    Symbols:

    - h: minimum film thickness [m]
    - R, U, W, eta0, u, w, E'

    Range: exact for rigid surfaces, constant viscosity and Reynolds's condition at the exit; g_V = W^1.5 G/U^0.5 below
    5.035 and g_E = W/U^0.5 below 1.770.

    Examples
    --------
    By hand, with U = 1e-10, W = 1e-4 and R = 10 mm: h/R = 4.89497e-6.

    >>> f"{Martin().film_thickness(2e5, 20.0, 0.01, 2e11, 0.01, 2e-8):.4e}"
    '4.8950e-08'
    """

    name: ClassVar[str] = "martin"
    equation: ClassVar[str] = "h/R = 4.89497 U/W"
    references: ClassVar[tuple[Reference, ...]] = (MARTIN_1916,)
    regime: ClassVar[str] = "IR"
    other_regime_error: ClassVar[tuple[float, float] | None] = (-99.7, -31.2)
    law = MARTIN


@attrs.frozen
@explained
class Blok(_PowerLaw):
    """Rigid, piezoviscous minimum film after Weber and Saalfeld and Blok: h = 1.66630 R (G U)^(2/3).

    Symbols:

    - h: minimum film thickness [m]
    - R, U, G, W, eta0, u, w, E', alpha

    Range: limit of g_V = W^1.5 G/U^0.5 towards its largest value; a rigid contact with a Barus oil has no solution
    beyond g_V = 17.602.

    Examples
    --------
    By hand, with U = 1e-10, G = 4000, W = 1e-4 and R = 10 mm: h/R = 1.6663 (4e-7)^(2/3) = 9.0461e-5.

    >>> f"{Blok().film_thickness(2e5, 20.0, 0.01, 2e11, 0.01, 2e-8):.4e}"
    '9.0461e-07'
    """

    name: ClassVar[str] = "blok"
    equation: ClassVar[str] = "h/R = 1.66630 (G U)^(2/3)"
    references: ClassVar[tuple[Reference, ...]] = (WEBER_1954, BLOK_1963)
    regime: ClassVar[str] = "VR"
    other_regime_error: ClassVar[tuple[float, float] | None] = (-92.2, 62.4)
    domain = PIEZOVISCOUS
    law = BLOK

    @property
    def validity(self) -> tuple[Validity, ...]:  # type: ignore[override]
        """That of all films, and where a rigid contact has a solution."""
        return (
            *super().validity,
            Validity(
                code="W05",
                quantity="viscous_parameter",
                high=17.602,
                consequence="a rigid contact with a Barus oil has no film at all",
                remedy="film 'moes', which covers all regimes",
                replacement="moes",
                source="quadrature of the rigid contact (docs/trust/film_reference.rst)",
            ),
        )


@attrs.frozen
@explained
class Herrebrugh(_PowerLaw):
    """Elastic, isoviscous minimum film after Herrebrugh: h = 3.10 R U^0.6 W^-0.2.

    Symbols:

    - h: minimum film thickness [m]
    - R, U, W, eta0, u, w, E'

    Range: soft or heavily loaded surfaces and an oil that pressure does not thicken, g_E = W/U^0.5 above 1.770 and g_V
    below 1.337 g_E^1.3704.

    Examples
    --------
    By hand, with U = 1e-10, W = 1e-4 and R = 10 mm: h/R = 3.1e-6 10^0.8 = 1.9560e-5.

    >>> f"{Herrebrugh().film_thickness(2e5, 20.0, 0.01, 2e11, 0.01, 2e-8):.4e}"
    '1.9560e-07'
    """

    name: ClassVar[str] = "herrebrugh"
    equation: ClassVar[str] = "h/R = 3.10 U^0.6 W^-0.2"
    references: ClassVar[tuple[Reference, ...]] = (HERREBRUGH_1968,)
    regime: ClassVar[str] = "IE"
    other_regime_error: ClassVar[tuple[float, float] | None] = (-87.3, -33.2)
    law = HERREBRUGH


@attrs.frozen
@explained
class DowsonHigginson(_PowerLaw):
    """Elastic, piezoviscous minimum film after Dowson and Higginson: h = 1.6 R G^0.6 U^0.7 W^-0.13 (B).

    Symbols:

    - h: minimum film thickness [m]
    - R, U, G, W, eta0, u, w, E', alpha

    Range: elastic, piezoviscous films, g_V = W^1.5 G/U^0.5 above 38.97 g_E^0.4737 and 1.337 g_E^1.3704 with
    g_E = W/U^0.5; 40 to 76 % too thin for M = W/sqrt(2 U) <= 0.5.

    Examples
    --------
    By hand, with U = 1e-10, G = 4000, W = 1e-4 and R = 10 mm: h/R = 1.6 10^-6.48 4000^0.6 = 7.6799e-5.

    >>> f"{DowsonHigginson().film_thickness(2e5, 20.0, 0.01, 2e11, 0.01, 2e-8):.4e}"
    '7.6799e-07'
    """

    name: ClassVar[str] = "dowson-higginson"
    equation: ClassVar[str] = "h/R = 1.6 G^0.6 U^0.7 W^-0.13"
    references: ClassVar[tuple[Reference, ...]] = (DOWSON_HIGGINSON_1966,)
    regime: ClassVar[str] = "VE"
    other_regime_error: ClassVar[tuple[float, float] | None] = (-85.9, 2.5)
    domain = PIEZOVISCOUS
    law = PowerLaw(1.6, 0.7, 0.6, -0.13)


@attrs.frozen
@explained
class Dowson1968(_PowerLaw):
    """Elastic, piezoviscous minimum film after Dowson: h = 2.65 R U^0.7 G^0.54 W^-0.13.

    Symbols:

    - h: minimum film thickness [m]
    - R, U, G, W, eta0, u, w, E', alpha

    Range: elastic, piezoviscous films, g_V = W^1.5 G/U^0.5 above 38.97 g_E^0.4737 and 1.337 g_E^1.3704 with
    g_E = W/U^0.5; 40 to 76 % too thin for M = W/sqrt(2 U) <= 0.5.

    Examples
    --------
    By hand, with U = 1e-10, G = 4000, W = 1e-4 and R = 10 mm: h/R = 2.65 10^-6.48 4000^0.54 = 7.7332e-5.

    >>> f"{Dowson1968().film_thickness(2e5, 20.0, 0.01, 2e11, 0.01, 2e-8):.4e}"
    '7.7332e-07'
    """

    name: ClassVar[str] = "dowson-1968"
    on_fronts: ClassVar[bool] = True
    equation: ClassVar[str] = "h/R = 2.65 U^0.7 G^0.54 W^-0.13"
    references: ClassVar[tuple[Reference, ...]] = (DOWSON_EHD_1968,)
    regime: ClassVar[str] = "VE"
    other_regime_error: ClassVar[tuple[float, float] | None] = (-85.4, 6.3)
    domain = PIEZOVISCOUS
    law = DOWSON_1968


@attrs.frozen
@explained
class DowsonToyoda(_PowerLaw):
    """Elastic, piezoviscous central film after Dowson and Toyoda: h = 3.06 R U^0.69 G^0.56 W^-0.10.

    Symbols:

    - h: central film thickness [m]
    - R, U, G, W, eta0, u, w, E', alpha

    Range: elastic, piezoviscous films, g_V = W^1.5 G/U^0.5 above 38.97 g_E^0.4737 and 1.337 g_E^1.3704 with
    g_E = W/U^0.5; 40 to 76 % too thin for M = W/sqrt(2 U) <= 0.5.

    Examples
    --------
    By hand, with U = 1e-10, G = 4000, W = 1e-4 and R = 10 mm: h/R = 3.06 10^-6.5 4000^0.56 = 1.00664e-4.

    >>> f"{DowsonToyoda().film_thickness(2e5, 20.0, 0.01, 2e11, 0.01, 2e-8):.4e}"
    '1.0066e-06'
    """

    name: ClassVar[str] = "dowson-toyoda"
    equation: ClassVar[str] = "h/R = 3.06 U^0.69 G^0.56 W^-0.10"
    references: ClassVar[tuple[Reference, ...]] = (DOWSON_TOYODA_1979,)
    location: ClassVar[str] = "central"
    regime: ClassVar[str] = "VE"
    other_regime_error: ClassVar[tuple[float, float] | None] = (-83.9, 24.3)
    domain = PIEZOVISCOUS
    law = PowerLaw(3.06, 0.69, 0.56, -0.10)


@attrs.frozen(kw_only=True)
@explained
class PanHamrock(FilmModel):
    """Elastic, piezoviscous film after Pan and Hamrock, at the middle of the contact or at its minimum.

    Minimum h = 1.714 R W^-0.128 U^0.694 G^0.568, central h = 2.922 R W^-0.166 U^0.692 G^0.470 (B).

    Symbols:

    - h: minimum or central (``thickness``) film thickness [m]
    - R, U, G, W, eta0, u, w, E', alpha

    Range: elastic, piezoviscous films, g_V = W^1.5 G/U^0.5 above 38.97 g_E^0.4737 and 1.337 g_E^1.3704 with
    g_E = W/U^0.5; 40 to 76 % too thin for M = W/sqrt(2 U) <= 0.5.

    Examples
    --------
    By hand, with U = 1e-10, G = 4000, W = 1e-4 and R = 10 mm: h/R = 1.714 10^-6.428 4000^0.568 = 7.1118e-5 at
    the minimum, 2.922 10^-6.256 4000^0.470 = 7.9919e-5 at the middle.

    >>> f"{PanHamrock().film_thickness(2e5, 20.0, 0.01, 2e11, 0.01, 2e-8):.4e}"
    '7.1118e-07'
    >>> f"{PanHamrock(thickness='central').film_thickness(2e5, 20.0, 0.01, 2e11, 0.01, 2e-8):.4e}"
    '7.9919e-07'
    """

    name: ClassVar[str] = "pan-hamrock"
    on_fronts: ClassVar[bool] = True
    equation: ClassVar[str] = (
        "h/R = 1.714 W^-0.128 U^0.694 G^0.568 (minimum); 2.922 W^-0.166 U^0.692 G^0.470 (central)"
    )
    references: ClassVar[tuple[Reference, ...]] = (PAN_1989,)
    regime: ClassVar[str] = "VE"
    other_regime_error: ClassVar[tuple[float, float] | None] = (-86.5, 14.6)
    domain = PIEZOVISCOUS

    thickness: str = parameter(
        default="minimum",
        validator=choice_of("minimum", "central"),
        doc="which film thickness: 'minimum' or 'central'",
    )

    @property
    def location(self) -> str:  # type: ignore[override]
        """Which film thickness it returns, the chosen one."""
        return self.thickness

    @property
    def law(self) -> PowerLaw:
        """The numbers of the power law."""
        if self.thickness == "minimum":
            return PowerLaw(1.714, 0.694, 0.568, -0.128)
        return PowerLaw(2.922, 0.692, 0.470, -0.166)

    evaluate = _PowerLaw.evaluate
    kernel = _PowerLaw.kernel


@attrs.frozen
@explained
class Moes(FilmModel):
    """Composite film over all regimes after Moes, where dp/dx = 0.

    H = [(H_RI^(7/3) + H_EI^(7/3))^(3s/7) + (H_RP^(-7/2) + H_EP^(-7/2))^(-2s/7)]^(1/s),
    s = (7 + 8 exp(-2 H_EI/H_RI))/5, H_RI = 3/M, H_RP = 1.287 L^(2/3), H_EI = 2.621 M^-0.2,
    H_EP = 1.311 M^-0.125 L^0.75.

    Symbols:

    - H: film thickness h/(R Us^0.5) where dp/dx = 0 [1]
    - H_RI, H_EI: isoviscous asymptotes, rigid and elastic [1]
    - H_RP, H_EP: piezoviscous asymptotes, rigid and elastic [1]
    - s: exponent of the composite [1]
    - M: load parameter W/Us^0.5 [1]
    - L: lubricant parameter G Us^0.25 [1]
    - Us: speed parameter of the sum of speeds, 2 U [1]
    - R, U, G, W, eta0, u, w, E', alpha

    Range: all regimes. Against `reynolds-line` its error is mapped in
    the documentation; for M below 2 the pressure itself is far from that of Hertz.

    Examples
    --------
    At M = 7.0711, L = 15.0424 the asymptotes are 0.42426, 1.77243, 7.84254 and 7.84161 and s = 1.40038; composed in
    thirty digits H = 7.187242.

    >>> f"{Moes().film_thickness(2e5, 20.0, 0.01, 2e11, 0.01, 2e-8) / 0.01 / (2e-10) ** 0.5:.6f}"
    '7.187242'
    """

    name: ClassVar[str] = "moes"
    on_fronts: ClassVar[bool] = True
    equation: ClassVar[str] = (
        "H = [(H_RI^(7/3) + H_EI^(7/3))^(3s/7) + (H_RP^(-7/2) + H_EP^(-7/2))^(-2s/7)]^(1/s)"
    )
    references: ClassVar[tuple[Reference, ...]] = (MOES_1992,)
    reference_values: ClassVar[tuple[ReferenceValue, ...]] = (
        ReferenceValue(
            inputs={
                "load": 2e5,
                "rolling_speed": 20.0,
                "radius": 0.01,
                "modulus": 2e11,
                "viscosity": 0.01,
                "pressure_viscosity": 2e-8,
            },
            value=7.187242 * 0.01 * 2e-10**0.5,
            rtol=1e-6,
            source="H = 7.187242, the formula composed in thirty digits at M = 7.0711 and L = 15.0424",
        ),
    )
    location: ClassVar[str] = "dp/dx = 0"

    @property
    def validity(self) -> tuple[Validity, ...]:  # type: ignore[override]
        """The validity of all films, and the range in which it was compared with a numerical solution."""
        return (*super().validity, *_mapped("-6 to +5 %"))

    def evaluate(self, slices: Slices) -> None:
        """Fill the film thickness."""
        U, G, W = groups(slices)
        r = np.sqrt(2 * U)
        M = W / r
        L = G * np.sqrt(r)
        ri = 3 / M
        ei = 2.621 * M**-0.2
        ep = 1.311 * M**-0.125 * L**0.75
        ep_over_rp = 1.311 / 1.287 * L ** (1 / 12) * M**-0.125  # finite at L = 0, where both vanish
        isoviscous = (ri ** (7 / 3) + ei ** (7 / 3)) ** (3 / 7)
        piezoviscous = ep * (1 + ep_over_rp**3.5) ** (-2 / 7)
        s = (7 + 8 * np.exp(-2 * ei / ri)) / 5
        larger = np.maximum(isoviscous, piezoviscous)
        smaller = np.minimum(isoviscous, piezoviscous)
        slices.film_thickness[...] = (
            slices.conditions.radius * r * larger * (1 + (smaller / larger) ** s) ** (1 / s)
        )

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.moes()


@attrs.frozen
@explained
class Regime(FilmModel):
    """Minimum film by the formula of the regime that the contact is in, which it also reports.

    Elasticity thickens the isoviscous film and thins the piezoviscous one, and the thicker of the two mechanisms
    holds: h = max(max(Martin, Herrebrugh), min(Blok, Dowson 1968)). The boundaries are therefore where two formulas
    meet (see ``rollslip.bearing.regimes``), and the film is continuous across each.

    Symbols:

    - h: minimum film thickness [m]
    - h_IR: rigid, isoviscous film, 4.89497 R U/W [m]
    - h_VR: rigid, piezoviscous film, 1.66630 R (G U)^(2/3) [m]
    - h_IE: elastic, isoviscous film, 3.10 R U^0.6 W^-0.2 [m]
    - h_VE: elastic, piezoviscous film, 2.65 R U^0.7 G^0.54 W^-0.13 [m]
    - R, U, G, W, eta0, u, w, E', alpha

    Range: all regimes, each formula up to where it meets the next, without a transition between them.

    Examples
    --------
    Of the four films 0.0489, 0.9046, 0.1956 and 0.7733 um of their own examples the last holds.

    >>> f"{Regime().film_thickness(2e5, 20.0, 0.01, 2e11, 0.01, 2e-8):.4e}"
    '7.7332e-07'
    """

    name: ClassVar[str] = "regime"
    on_fronts: ClassVar[bool] = True
    equation: ClassVar[str] = "h = max(max(h_IR, h_IE), min(h_VR, h_VE))"
    references: ClassVar[tuple[Reference, ...]] = (
        JOHNSON_1970,
        *Martin.references,
        *Blok.references,
        *Herrebrugh.references,
        *Dowson1968.references,
    )
    location: ClassVar[str] = "minimum"
    writes = frozenset({"film_thickness", "regime"})

    @property
    def validity(self) -> tuple[Validity, ...]:  # type: ignore[override]
        """The validity of all films, and the range in which it was compared with a numerical solution."""
        return (*super().validity, *_mapped("-37 to +3 %"))

    def evaluate(self, slices: Slices) -> None:
        """Fill the film thickness and the regime (0 IR, 1 VR, 2 IE, 3 VE)."""
        ratio, slices.regime[...] = film_by_regime(*groups(slices))
        slices.film_thickness[...] = slices.conditions.radius * ratio

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.regime(MARTIN, BLOK, HERREBRUGH, DOWSON_1968)
