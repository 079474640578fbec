"""Films that thin under shear, heated by their mean stress: Carreau's fluid, and one with a limiting stress."""

from types import MappingProxyType
from typing import ClassVar

import attrs
import numpy as np

from rollslip.fields import parameter, positive
from rollslip.models import POSITIVE
from rollslip.references import Reference
from rollslip.search import Array
from rollslip_kernels.slices import Slices
from rollslip_kernels.stages import shear_thinning as compiled
from rollslip_plugins.bibliography import BAIR_2002, BAIR_2019, BAIR_WINER_1979, CARREAU_1972
from rollslip_plugins.symbols import explained
from rollslip_plugins.traction.heating import (
    HEATED,
    MAX_STEPS,
    NO_EFFECT,
    HeatedFilm,
    flash_factor,
    mean_softening,
    newtonian_bound,
    softened,
)

#: Euler's constant gamma.
EULER = np.euler_gamma
#: Nodes on (0, 1) of Gauss-Legendre quadrature, 12 of them. Half as many err by 3e-8, twice as many, as these do,
#: by rounding: up to 2e-15 at 4,000 random strains and durations.
NODES = (1 + np.polynomial.legendre.leggauss(12)[0]) / 2
#: Weights of these nodes.
WEIGHTS = np.polynomial.legendre.leggauss(12)[1] / 2


@attrs.frozen(kw_only=True)
@explained
class Carreau(HeatedFilm):
    """Shear thinning after Carreau in Bair's form, heated by the mean stress.

    tau = eta_N g [1 + (eta_N g/G)^2]^((n - 1)/2), g = V/h, eta_N = eta exp(-beta zeta tau V), mu = tau/p.
    Limits: Newtonian for eta_N g << G, a power law tau = G (eta_N g/G)^n beyond. For n > 0 nothing but heat limits the
    stress; n = 1 is Newtonian, n = 0 tends to tau = G.

    Symbols:

    - mu: traction coefficient, with the sign of V [1]
    - tau: shear stress [Pa]
    - g: shear rate V/h [1/s]
    - eta_N: viscosity of the heated film without thinning [Pa s]
    - G: stress at which thinning begins (``critical_stress``) [Pa]
    - n: exponent of the thinning (``exponent``) [1]
    - zeta, eta, beta, p, V, u, h, b, flash, K_f, K

    Range: that of the oil's flow curve; G and n are an oil's own. The defaults are those given for squalane at 40 degC,
    G = 6.9 MPa and n = 0.463 (grade C: recalled, the tables of the source were not at hand); no measured flow curve has
    been compared here.

    Examples
    --------
    A cold film with eta V/h = G = 1 MPa at 10 MPa and n = 1/2: mu = 0.1 2^(-1/4) = 0.0840896.

    >>> from rollslip import Conditions, Slices
    >>> slices = Slices(1, Conditions(effusivity=13e3, conductivity=0.14), pressure=1e7, half_width=1e-4,
    ...                 film_thickness=1e-6, rolling_speed=1.0, sliding_speed=1.0, film_viscosity=1.0,
    ...                 film_thermoviscosity=0.0)
    >>> Carreau(critical_stress=1e6, exponent=0.5).evaluate(slices)
    >>> f"{slices.friction[0]:.7f}"
    '0.0840896'
    """

    name: ClassVar[str] = "carreau"
    equation: ClassVar[str] = (
        "mu = eta_N g/p [1 + (eta_N g/G)^2]^((n - 1)/2), g = V/h, eta_N = eta exp(-beta zeta mu p V)"
    )
    references: ClassVar[tuple[Reference, ...]] = (CARREAU_1972, BAIR_2019, BAIR_2002)
    expected_failures = MappingProxyType(
        {
            "check_friction_coefficient_is_below_unity": "a power law has no limiting stress, and an oil whose "
            "viscosity does not fall with temperature is not softened by heat either"
        }
    )

    critical_stress: float = parameter(
        default=6.9e6,
        unit="Pa",
        validator=positive,
        doc="critical stress G",
        usual=(1e4, 1e8),
        possible=(1, 1e12),
    )
    exponent: float = parameter(
        default=0.463, unit="1", doc="exponent n of the thinning", usual=(0.2, 1), possible=(0, 1)
    )
    flash: float = flash_factor()

    def fraction(self, newtonian: Array, surfaces: Array, across: Array, slices: Slices) -> Array:
        """Return t = exp(-w t) [1 + (c exp(-w t))^2]^((n - 1)/2), c = eta V/(h G)."""
        n = self.exponent
        strain = newtonian / self.critical_stress
        softening = mean_softening(surfaces, across)

        def law(fraction: Array) -> tuple[Array, Array]:
            thinned = np.exp(-softening * fraction)
            x = strain * thinned
            c = np.hypot(1.0, x)  # the square would overflow first
            return thinned * c ** (n - 1), softening * fraction * (n + (1 - n) / c / c)

        cold = np.hypot(1.0, strain) ** (n - 1)
        return softened(law, np.minimum(newtonian_bound(softening), cold))

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.carreau(self.flash, self.critical_stress, self.exponent)


@attrs.frozen(kw_only=True)
@explained
class LimitingShear(HeatedFilm):
    """Maxwell fluid with a limiting stress in proportion to the pressure after Bair and Winer, heated by the mean.

    V/h = (1/Gamma) dtau/dt - (tau_L/eta_N) ln(1 - tau/tau_L), tau_L = lambda p, from tau = 0 at the entry over the
    transit 2 b/u at the mean pressure; mu = tau_m/p with the mean stress tau_m, whose heat softens the film to
    eta_N = eta exp(-beta zeta tau_m V). The equation has an exact solution in exponential integrals. Limits:
    tau_m = eta V/h for slow sliding and Gamma b >> eta u; elastic, tau_m = Gamma b V/(h u), for slow sliding and
    eta u >> Gamma b; tau_m = tau_L [1 - exp(-eta_N V/(h tau_L))] for Gamma b >> eta u; never above tau_L.

    Symbols:

    - mu: traction coefficient, with the sign of V [1]
    - tau: local shear stress [Pa]
    - tau_L: limiting stress [Pa]
    - lambda: limiting stress over pressure (``limit``) [1]
    - Gamma: shear modulus of the oil [Pa]
    - t: time since the entry into the contact [s]
    - eta_N: viscosity of the heated film [Pa s]
    - zeta, eta, beta, p, V, u, h, b, flash, K_f, K

    Range: lambda is some 0.05 to 0.1 for bearing oils and falls with temperature (C); the default 0.08 is not
    that of a named oil (D). The source's own tables were not at hand, and no measured curve has been compared.

    Examples
    --------
    A cold, stiff film with eta V/h = tau_L = 1 MPa at 10 MPa: mu = 0.1 (1 - 1/e) = 0.0632121.

    >>> from rollslip import Conditions, Slices
    >>> slices = Slices(1, Conditions(effusivity=13e3, conductivity=0.14, shear_modulus=1e18), pressure=1e7,
    ...                 half_width=1e-4, film_thickness=1e-6, rolling_speed=1.0, sliding_speed=1.0,
    ...                 film_viscosity=1.0, film_thermoviscosity=0.0)
    >>> LimitingShear(limit=0.1).evaluate(slices)
    >>> f"{slices.friction[0]:.7f}"
    '0.0632121'
    """

    name: ClassVar[str] = "limiting-shear"
    equation: ClassVar[str] = (
        "mu = mean(tau)/p, V/h = (1/Gamma) dtau/dt - (tau_L/eta_N) ln(1 - tau/tau_L), tau_L = lambda p, "
        "eta_N = eta exp(-beta zeta mu p V)"
    )
    references: ClassVar[tuple[Reference, ...]] = (BAIR_WINER_1979,)
    reads = HeatedFilm.reads | {"shear_modulus"}
    domain = MappingProxyType({**HEATED, "shear_modulus": POSITIVE})

    limit: float = parameter(
        default=0.08,
        unit="1",
        validator=positive,
        doc="limiting stress over pressure lambda",
        usual=(0.01, 0.2),
        possible=(0, 10),
    )
    flash: float = flash_factor()

    def fraction(self, newtonian: Array, surfaces: Array, across: Array, slices: Slices) -> Array:
        """Return t from the mean stress over the transit."""
        strain = np.maximum(newtonian / (self.limit * slices.pressure), NO_EFFECT)
        deborah = slices.film_viscosity * slices.rolling_speed
        deborah = deborah / (slices.conditions.shear_modulus * slices.half_width)
        softening = mean_softening(surfaces, across)

        def law(fraction: Array) -> tuple[Array, Array]:
            y = softening * fraction
            thinned = np.exp(-y)
            mean, fall = transit(strain * thinned, 2 / (deborah * thinned))
            return mean / strain, y * fall

        bound = np.minimum(newtonian_bound(softening), 1 / strain)
        return softened(law, np.minimum(bound, 1 / np.maximum(deborah, NO_EFFECT)))

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.limiting_shear(self.flash, self.limit)


def transit(strain: Array, duration: Array) -> tuple[Array, Array]:
    """Return the mean S of dS/dx = eps + ln(1 - S) over 0 <= x <= P, S(0) = 0, and its fall with heat.

    The fall is -dln(mean)/dy at eps = strain exp(-y), P = duration exp(y).

    With v from eps + ln(1 - S) = eps exp(-v): dx = g dv and S = 1 - g, g = exp(-eps (1 - exp(-v))). With r = eps
    exp(-v) at the end and N(x) = Ei(x) - gamma - ln x = sum of x^k/(k k!)::

        P = exp(-eps) [v + N(eps) - N(r)]
        mean = 1 - exp(-eps) - exp(-2 eps) [N(2 eps) - N(2 r) - N(eps) + N(r)]/P

    Both differences cancel while S is nearly eps x; there quadrature in v is exact.
    """
    # beyond, the ramp is lost in rounding
    eps, p = np.broadcast_arrays(strain, np.minimum(duration, 1e30))
    mean = np.empty(eps.shape)
    end = np.empty(eps.shape)
    early = (p < 2.0) & (eps * p < 0.5)
    mean[early], end[early] = _early(eps[early], p[early])
    mean[~early], end[~early] = _late(eps[~early], p[~early])
    # of the order of 1/eps, which eps rounds away
    fall = eps * (1 + end - 2 * mean) - end / p - end + mean
    return mean, np.where(eps < 1e8, np.clip(fall / mean, 0.0, 1.0), 0.0)


def _early(eps: Array, p: Array) -> tuple[Array, Array]:
    """Return mean and end of S by Gauss-Legendre quadrature in v."""
    v = p
    for _ in range(MAX_STEPS):
        step = v * (np.exp(eps[..., None] * np.expm1(-v[..., None] * NODES)) @ WEIGHTS) - p
        step /= np.exp(eps * np.expm1(-v))
        v = v - step
        if not np.any(np.abs(step) > 1e-9 * v):  # quadratic
            break
    stress = -np.expm1(eps[..., None] * np.expm1(-v[..., None] * NODES))
    return v * ((stress * (1 - stress)) @ WEIGHTS) / p, -np.expm1(eps * np.expm1(-v))


def _late(eps: Array, p: Array) -> tuple[Array, Array]:
    """Return mean and end of S in closed form."""
    decay = np.exp(-eps)
    gap = _scaled(eps) + decay * (EULER + np.log(eps)) - p  # exp(-eps) Ei(r)
    rising = gap > 2 * decay
    distance = np.empty(eps.shape)  # eps - r
    distance[rising] = _rising(eps[rising], gap[rising])
    distance[~rising] = _from_logarithm(eps[~rising], gap[~rising])
    r = eps - distance
    near = np.exp(-distance)
    missing = (
        _scaled(2 * eps) - near**2 * _scaled(2 * r) - decay * (_scaled(eps) - near * _scaled(r))
    )
    return -np.expm1(-eps) - missing / p, -np.expm1(-distance)


def _rising(eps: Array, gap: Array) -> Array:
    """Return eps - r > 0 from exp(-eps) Ei(r) = gap, r > 1: nearly linear in the logarithm."""
    at_eps = _scaled(eps) + np.exp(-eps) * (EULER + np.log(eps))
    distance = np.clip(np.log(at_eps / gap), 0.0, eps - 1)
    for _ in range(MAX_STEPS):
        r = eps - distance
        value = _scaled(r) + np.exp(-r) * (EULER + np.log(r))  # exp(-r) Ei(r)
        step = (np.log(value / gap) - distance) * r * value
        distance = np.clip(distance + step, 0.0, eps - 1)
        if not np.any(np.abs(step) > 1e-9):  # quadratic
            break
    return distance


def _from_logarithm(eps: Array, gap: Array) -> Array:
    """Return eps - r from exp(-eps) Ei(r) = gap, r <= 1, by v of r = eps exp(-v): v - N(r) = T, concave."""
    target = EULER + np.log(eps) - gap * np.exp(np.minimum(eps, 600.0))
    v = np.maximum(target, np.log(eps))
    for _ in range(MAX_STEPS):
        r = eps * np.exp(-v)
        step = (target - v) * np.exp(-r) + _scaled(r)
        v = v + step
        if not np.any(np.abs(step) > 1e-9):  # quadratic; NaN also ends
            break
    return -eps * np.expm1(-v)


def _scaled(x: Array) -> Array:
    """Return exp(-x) N(x) with N(x) = sum of x^k/(k k!), k >= 1; above 40 from the asymptotic series of Ei."""
    small = np.minimum(x, 40.0)
    term = np.ones_like(small)
    total = np.zeros_like(small)
    for k in range(1, 160):
        term *= small / k
        total += term / k
        # terms that are too small for a sum leave it as it is: looked at now and then
        if k % 8 == 0 and not (term > 1e-17 * total).any():
            break
    if not (x > 40.0).any():
        return np.exp(-small) * total
    large = np.maximum(x, 40.0)
    term = 1 / large
    tail = np.zeros_like(large)
    for k in range(1, 41):
        tail = tail + term
        term = term * k / large
    return np.where(x > 40.0, tail, np.exp(-small) * total)
