"""Mixed friction: a boundary and a hydrodynamic traction model, blended by the load that asperities carry.

- All blends are mu = f mu_bd + (1 - f) mu_hd; they differ only in the fraction f, a function of the film parameter
  Lambda = h/(1.25 sqrt(Ra1^2 + Ra2^2)) and, for one of them, of the pressure.
- The fraction 1 - f of the film is computed separately, as accurately as f: the coefficient of a very thin film may be
  far above that of the boundary, so that the rounding of 1 - f would determine its contribution.
- A model is evaluated only on the slices whose fraction needs it. An exponential never becomes zero, so a fraction
  below 2^-53 of the one without a film, half a unit in the last place, counts as zero.
- Lambda is film over composite rms roughness in all of the sources; 1.25 Ra is the rms height of a Gaussian surface.
"""

import abc
import math
from types import MappingProxyType
from typing import ClassVar, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.bearing.chain import stage
from rollslip.fields import in_range, non_negative, parameter, positive, refuse_if
from rollslip.models import POSITIVE, Domain, TractionModel, Validity, common_domain, submodel
from rollslip.references import Reference
from rollslip.search import Array
from rollslip_kernels.slices import COLUMNS, Slices
from rollslip_kernels.stages import blend as compiled
from rollslip_plugins.bibliography import (
    AIHARA_1987,
    GREENWOOD_TRIPP_1970,
    GUPTA_1984,
    SAKAGUCHI_2003,
    WINGERTSZAHN_2023,
    ZHOU_1991,
)
from rollslip_plugins.symbols import explained
from rollslip_plugins.traction.boundary import Kragelsky
from rollslip_plugins.traction.local import MaxwellEyringLocal


@attrs.frozen(kw_only=True)
class _Blend(TractionModel, abc.ABC):
    """Two traction models and the fraction of the first."""

    #: What the fraction reads.
    fraction_domain: ClassVar[Domain] = MappingProxyType(
        {"film_thickness": POSITIVE, "roughness": POSITIVE}
    )
    covers: ClassVar[frozenset[str]] = frozenset({"film_parameter"})
    # each of the two laws may have a maximum of its own
    shapes = MappingProxyType({"cold": "any", "heated": "any"})

    boundary: TractionModel = submodel(
        "traction", factory=Kragelsky, doc="traction model of boundary friction"
    )
    hydrodynamic: TractionModel = submodel(
        "traction", factory=MaxwellEyringLocal, doc="traction model of the full film"
    )

    @property
    def reads(self) -> frozenset[str]:  # type: ignore[override]
        """What the children read, and what makes the fraction."""
        return self.boundary.reads | self.hydrodynamic.reads | self.fraction_domain.keys()

    @property
    def domain(self) -> Domain:  # type: ignore[override]
        """Where both children and the fraction are defined."""
        return common_domain(self.fraction_domain, self.boundary.domain, self.hydrodynamic.domain)

    @property
    def tolerance(self) -> float:  # type: ignore[override]
        """Relative difference that the children allow between their compiled and NumPy forms."""
        return max(self.boundary.tolerance, self.hydrodynamic.tolerance)

    @property
    def full_film(self) -> TractionModel:
        """Law of the full film alone."""
        return self.hydrodynamic

    def with_full_film(self, law: TractionModel) -> TractionModel:
        """Return the same blend with another law of the full film."""
        return attrs.evolve(self, hydrodynamic=law)

    @abc.abstractmethod
    def fractions(self, slices: Slices) -> tuple[Array, Array]:
        """Return the fractions of boundary and of film friction in each slice, from 0 to 1, which add to 1."""

    def evaluate(self, slices: Slices) -> None:
        """Fill the traction coefficient; each child sees only the slices that need it."""
        fraction, rest = self.fractions(slices)
        boundary = _where(self.boundary, slices, fraction > 0)
        hydrodynamic = _where(self.hydrodynamic, slices, rest > 0)
        slices.friction[...] = boundary * fraction + hydrodynamic * rest


@attrs.frozen(kw_only=True)
class _BetweenLimits(_Blend):
    """A fraction that falls from 1 to 0 between two film parameters, by a power of the distance to the second."""

    boundary_limit: float = parameter(
        default=0.01,
        unit="1",
        validator=non_negative,
        doc="Lambda_bd: boundary friction alone up to here",
        usual=(0, 1),
        possible=(0, 1e3),
    )
    hydrodynamic_limit: float = parameter(
        default=1.5,
        unit="1",
        validator=positive,
        doc="Lambda_hd: full film from here on",
        usual=(0.5, 5),
        possible=(0, 1e3),
    )

    def __attrs_post_init__(self) -> None:
        refuse_if(
            not self.hydrodynamic_limit > self.boundary_limit,
            "hydrodynamic_limit",
            f"must be above boundary_limit = {self.boundary_limit:g}, not {self.hydrodynamic_limit:g}",
        )

    @property
    def power(self) -> float:
        """Power of the distance."""
        return 1.0

    @property
    def full_film_from(self) -> float:
        """Film parameter from which on no boundary friction takes part."""
        return self.hydrodynamic_limit

    @property
    def boundary_up_to(self) -> float:
        """Film parameter up to which there is boundary friction alone."""
        return self.boundary_limit

    def fractions(self, slices: Slices) -> tuple[Array, Array]:
        """Return the fractions of boundary and of film friction in each slice."""
        film_parameter = slices.film_thickness / slices.conditions.roughness
        band = self.hydrodynamic_limit - self.boundary_limit
        x = np.clip((self.hydrodynamic_limit - film_parameter) / band, 0.0, 1.0)
        y = np.clip((film_parameter - self.boundary_limit) / band, 0.0, 1.0)
        with np.errstate(divide="ignore"):  # log(0) of a full film
            log = np.where(y < 0.5, np.log1p(-np.minimum(y, 0.5)), np.log(x))
        return x**self.power, -np.expm1(self.power * log)

    def kernel(self) -> object:
        """Return the compiled form, with each child's compiled form or a call of its NumPy form."""
        return compiled.power(
            stage(self.boundary),
            stage(self.hydrodynamic),
            self.boundary_limit,
            self.hydrodynamic_limit,
            self.power,
        )


@attrs.frozen(kw_only=True)
@explained
class LambdaBlend(_BetweenLimits):
    """Blend by the film parameter Lambda after Sakaguchi and Ueno.

    mu = mu_bd below Lambda_bd, mu_hd from Lambda_hd on, and between them
    mu_hd + (mu_bd - mu_hd) ((Lambda - Lambda_hd)/(Lambda_bd - Lambda_hd))^m. A child is evaluated only on the slices
    that need it.

    Symbols:

    - mu, mu_bd, mu_hd, Lambda
    - Lambda_bd: boundary friction alone up to here (``boundary_limit``) [1]
    - Lambda_hd: full film from here on (``hydrodynamic_limit``) [1]
    - m: power of the blend (``exponent``) [1]

    Range: the limits 0.01 and 1.5 are of grade C; no range of a fit was at hand.

    Raises
    ------
    FieldError
        If the limits are not in order.

    Examples
    --------
    Half way between the limits the fraction is 2^-6: 0.02 + 0.08/64 = 0.02125.

    >>> from rollslip import Conditions, Slices
    >>> from rollslip_plugins.traction.boundary import Constant
    >>> between = Slices(1, Conditions(roughness=1e-6), film_thickness=0.755e-6, rolling_speed=1.0, sliding_speed=1.0)
    >>> rough, smooth = Constant(coefficient=0.1), Constant(coefficient=0.02)
    >>> LambdaBlend(boundary=rough, hydrodynamic=smooth).evaluate(between)
    >>> f"{between.friction[0]:.7f}"
    '0.0212500'
    """

    name: ClassVar[str] = "lambda-blend"
    equation: ClassVar[str] = (
        "mu = mu_hd + (mu_bd - mu_hd) ((Lambda - Lambda_hd)/(Lambda_bd - Lambda_hd))^m"
    )
    references: ClassVar[tuple[Reference, ...]] = (SAKAGUCHI_2003,)

    exponent: float = parameter(
        default=6.0,
        unit="1",
        validator=positive,
        doc="power m of the blend",
        usual=(0.5, 12),
        possible=(0, 1e3),
    )

    @property
    def power(self) -> float:
        """Power m."""
        return self.exponent


@attrs.frozen(kw_only=True)
@explained
class LinearBlend(_BetweenLimits):
    """Straight line over the film parameter between two limits, the plainest of all blends.

    mu = mu_bd below Lambda_bd, mu_hd from Lambda_hd on, and between them
    mu_hd + (mu_bd - mu_hd) (Lambda_hd - Lambda)/(Lambda_hd - Lambda_bd): the blend of Sakaguchi and Ueno with m = 1.
    The limits are those of ``lambda-blend``, so that the two differ in the form alone.

    Symbols:

    - mu, mu_bd, mu_hd, Lambda
    - Lambda_bd: boundary friction alone up to here (``boundary_limit``) [1]
    - Lambda_hd: full film from here on (``hydrodynamic_limit``) [1]

    Range: none is claimed. Programs of bearing dynamics interpolate so for want of a law (grade C, from recall of
    Gupta's book; no number of his to test against is at hand).

    Raises
    ------
    FieldError
        If the limits are not in order.

    Examples
    --------
    Half way between the limits: (0.1 + 0.02)/2.

    >>> from rollslip import Conditions, Slices
    >>> from rollslip_plugins.traction.boundary import Constant
    >>> between = Slices(1, Conditions(roughness=1e-6), film_thickness=0.755e-6, rolling_speed=1.0, sliding_speed=1.0)
    >>> rough, smooth = Constant(coefficient=0.1), Constant(coefficient=0.02)
    >>> LinearBlend(boundary=rough, hydrodynamic=smooth).evaluate(between)
    >>> f"{between.friction[0]:.7f}"
    '0.0600000'
    """

    name: ClassVar[str] = "linear-blend"
    equation: ClassVar[str] = (
        "mu = mu_hd + (mu_bd - mu_hd) (Lambda_hd - Lambda)/(Lambda_hd - Lambda_bd)"
    )
    references: ClassVar[tuple[Reference, ...]] = (GUPTA_1984,)


@attrs.frozen(kw_only=True)
@explained
class ZhouHoeprich(_Blend):
    """Asperities carry the fraction exp(-B Lambda^C) of the load, the film the rest, after Zhou and Hoeprich.

    mu = fraction mu_bd + (1 - fraction) mu_hd. Zhou and Hoeprich, and Aihara, take the central film; and they add the
    whole friction of the film to that of the asperities, where here the film's is in proportion to its fraction of the
    load, as Wingertszahn et al. have it.

    Symbols:

    - mu, mu_bd, mu_hd
    - fraction: part of the load that asperities carry [1]
    - Lambda
    - B: factor of the exponent, of the profiles of the two surfaces (``factor``) [1]
    - C: power of Lambda, likewise (``exponent``) [1]

    Range: that of the fit of B and C; the fraction does not know the pressure. Zhou and Hoeprich plot a ground and a
    finely finished pair and print no constants. Defaults are Aihara's B = 1.8, C = 1.2, fitted to Patir and Cheng's
    solution of a partial elastohydrodynamic contact with lengthwise roughness below 0.4 GPa; after it the film carries
    "almost all" from Lambda = 2 on (here 98.4 %). For the raceway of a ground tapered roller bearing Wingertszahn
    et al. (2023) give B = 2.32, C = 0.97.

    Examples
    --------
    At Lambda = 1 the fraction is exp(-1.8) = 0.1652989: 0.02 + 0.08 0.1652989 = 0.0332239.

    >>> from rollslip import Conditions, Slices
    >>> from rollslip_plugins.traction.boundary import Constant
    >>> between = Slices(1, Conditions(roughness=1e-6), film_thickness=1e-6, rolling_speed=1.0, sliding_speed=1.0)
    >>> rough, smooth = Constant(coefficient=0.1), Constant(coefficient=0.02)
    >>> ZhouHoeprich(boundary=rough, hydrodynamic=smooth).evaluate(between)
    >>> f"{between.friction[0]:.7f}"
    '0.0332239'
    """

    name: ClassVar[str] = "zhou-hoeprich"
    equation: ClassVar[str] = (
        "mu = fraction mu_bd + (1 - fraction) mu_hd, fraction = exp(-B Lambda^C)"
    )
    references: ClassVar[tuple[Reference, ...]] = (ZHOU_1991, AIHARA_1987, WINGERTSZAHN_2023)
    validity: ClassVar[tuple[Validity, ...]] = (
        Validity(
            code="W19",
            quantity="pressure",
            high=0.4e9,
            consequence="the asperities' fraction, which does not know the pressure, is outside the fit of B and C",
            remedy="B and C of the surfaces at hand, or traction 'greenwood-tripp', which knows the pressure",
            source="Aihara (1987): fitted below 0.4 GPa",
        ),
    )

    factor: float = parameter(
        default=1.8,
        unit="1",
        validator=positive,
        doc="B of the asperities' fraction of the load",
        usual=(0.5, 6),
        possible=(0, 1e3),
    )
    exponent: float = parameter(
        default=1.2,
        unit="1",
        validator=positive,
        doc="C of the asperities' fraction of the load",
        usual=(0.3, 4),
        possible=(0, 1e3),
    )

    @property
    def full_film_from(self) -> float:
        """Film parameter from which on the fraction is below 2^-53, which counts as none."""
        with np.errstate(over="ignore"):  # small constants put it beyond the largest float
            return float(np.divide(53 * math.log(2), self.factor) ** (1 / self.exponent))

    def fractions(self, slices: Slices) -> tuple[Array, Array]:
        """Return the fractions of boundary and of film friction in each slice."""
        film_parameter = slices.film_thickness / slices.conditions.roughness
        power = -self.factor * film_parameter**self.exponent
        mixed = film_parameter < self.full_film_from
        return np.where(mixed, np.exp(power), 0.0), np.where(mixed, -np.expm1(power), 1.0)

    def kernel(self) -> object:
        """Return the compiled form, with each child's compiled form or a call of its NumPy form."""
        return compiled.exponential(
            stage(self.boundary),
            stage(self.hydrodynamic),
            self.full_film_from,
            self.factor,
            self.exponent,
        )


#: Separation at which F_5/2 is 2^-53 of its value at zero.
REACH: Final = 7.7723104337051744
#: Chebyshev coefficients of ln[F_5/2(x) exp(x^2/2)] in 2 x/REACH - 1, after tools/references/greenwood_tripp.py.
SERIES: Final = (
    -4.332877676360168, -3.153691250538355, 0.5636860629144674, -0.10990650728988603, 0.019383784429685365,
    -0.0026594991476540145, 0.00015471702312757488, 5.4475209642094594e-05, -2.3720366764896174e-05,
    5.018164073425828e-06, -4.25400780710619e-07, -1.347998421292047e-07, 7.204912320157584e-08,
    -1.7482695329470896e-08, 1.8272064389520041e-09, 4.4368641410982416e-10, -2.8105774033384216e-10,
    7.496375497157078e-11, -9.269256288634367e-12, -1.5588377890304124e-12, 1.214827986072986e-12,
    -3.528000323323606e-13, 5.031415141976617e-14, 5.268062064143024e-15, -5.5336185712066476e-15,
    1.7550073959061085e-15,
)  # fmt: skip


def asperity_integral(separation: Array) -> Array:
    """Return F_5/2(x), the integral of (s - x)^(5/2) over the standard normal distribution beyond x, x >= 0.

    To 1e-14, and 0 from x = 7.77 on. The usual fit 4.4086e-5 (4 - x)^6.804 is 11 % low at 0, 4 % at 1, 9 % at 2 and
    74 % at 3.
    """
    x = np.minimum(separation, REACH)
    value = np.exp(np.polynomial.chebyshev.chebval(2 * x / REACH - 1, SERIES) - x * x / 2)
    return np.where(x < REACH, value, 0.0)


@attrs.frozen(kw_only=True)
@explained
class GreenwoodTripp(_Blend):
    """Asperities carry their pressure over the mean pressure, after Greenwood and Tripp; the film carries the rest.

    mu = fraction mu_bd + (1 - fraction) mu_hd, fraction = p_a/p and at most 1, with
    p_a = (16 sqrt(2) pi/15) (sigma beta eta)^2 sqrt(sigma/beta) (E'/2) F_5/2(Lambda). Greenwood and Tripp's modulus is
    1/[(1-nu1^2)/E1 + (1-nu2^2)/E2], half of E'.

    Symbols:

    - mu, mu_bd, mu_hd
    - fraction: part of the load that asperities carry [1]
    - Lambda, p, E'
    - sigma: composite rms roughness; sigma beta eta is one parameter (``roughness_parameter``) [m]
    - beta: radius of the tips; sigma/beta is the other one (``slope_parameter``) [m]
    - eta: number of tips per area [1/m2]
    - F_5: F_5/2, integral of (s - Lambda)^(5/2) over the standard normal distribution beyond Lambda [1]

    Range: elastic asperities of Gaussian height on flat surfaces whose mean planes are the film apart. Without a film
    they carry what their number and height allow, 26 MPa between steel surfaces with the defaults: far less than a
    heavily loaded contact, so that friction does not become that of the boundary alone. sigma beta eta is 0.03 to 0.05
    and sigma/beta 1e-4 to 1e-2 for engineering surfaces (C); defaults are the upper end of the first and the
    middle of the second on a logarithmic scale (D).

    Examples
    --------
    F_5/2(1) = 0.0805623 by quadrature in thirty digits (0.08056 in the published table), so the fraction at
    E'/p = 2000/3 is 0.01006108: 0.02 + 0.08 0.01006108 = 0.0208049.

    >>> from rollslip import Conditions, Slices
    >>> from rollslip_plugins.traction.boundary import Constant
    >>> between = Slices(1, Conditions(roughness=1e-6, modulus=2e11), pressure=3e8, film_thickness=1e-6,
    ...                  rolling_speed=1.0, sliding_speed=1.0)
    >>> rough, smooth = Constant(coefficient=0.1), Constant(coefficient=0.02)
    >>> GreenwoodTripp(boundary=rough, hydrodynamic=smooth).evaluate(between)
    >>> f"{between.friction[0]:.7f}"
    '0.0208049'
    """

    name: ClassVar[str] = "greenwood-tripp"
    equation: ClassVar[str] = (
        "mu = fraction mu_bd + (1 - fraction) mu_hd, "
        "fraction = (16 sqrt(2) pi/15) (sigma beta eta)^2 sqrt(sigma/beta) (E'/2) F_5/2(Lambda)/p <= 1"
    )
    references: ClassVar[tuple[Reference, ...]] = (GREENWOOD_TRIPP_1970,)
    fraction_domain: ClassVar[Domain] = MappingProxyType(
        {**_Blend.fraction_domain, "pressure": POSITIVE, "modulus": POSITIVE}
    )

    roughness_parameter: float = parameter(
        default=0.05,
        unit="1",
        validator=positive,
        doc="sigma beta eta: roughness, radius and density of tips",
        usual=(0.01, 0.1),
        possible=(0, 10),
    )
    slope_parameter: float = parameter(
        default=1e-3,
        unit="1",
        validator=in_range(0.0, 1.0, open=True),
        doc="sigma/beta: roughness over tip radius",
        usual=(1e-4, 0.1),
        possible=(0, 1),
    )

    @property
    def coefficient(self) -> float:
        """p_a over E' F_5/2."""
        shape = (
            self.roughness_parameter * self.roughness_parameter * math.sqrt(self.slope_parameter)
        )
        return 16 * math.sqrt(2) * math.pi / 15 / 2 * shape

    @property
    def full_film_from(self) -> float:
        """Film parameter from which on F_5/2 is below 2^-53 of its value at zero, which counts as none."""
        return REACH

    def fractions(self, slices: Slices) -> tuple[Array, Array]:
        """Return the fractions of boundary and of film friction in each slice."""
        touching = asperity_integral(slices.film_thickness / slices.conditions.roughness)
        fraction = np.minimum(
            self.coefficient * slices.conditions.modulus / slices.pressure * touching, 1.0
        )
        # whatever the pressure, which may make the quotient infinite
        fraction = np.where(touching > 0, fraction, 0.0)
        return fraction, 1.0 - fraction

    def kernel(self) -> object:
        """Return the compiled form, with each child's compiled form or a call of its NumPy form."""
        return compiled.greenwood_tripp(
            stage(self.boundary), stage(self.hydrodynamic), REACH, self.coefficient, SERIES
        )


def _where(model: TractionModel, slices: Slices, needed: NDArray[np.bool_]) -> Array:
    """Return the friction of the needed slices by a model, 0 elsewhere."""
    result = np.zeros(needed.shape)
    if np.any(needed):
        # a view of a user's arrays may lack columns
        part = Slices.of_columns(
            slices.conditions,
            {name: getattr(slices, name)[needed] for name in COLUMNS if hasattr(slices, name)},
        )
        model.evaluate(part)
        result[needed] = part.friction
    return result
