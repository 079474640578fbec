"""Films that conduct their heat to warm surfaces, exactly across the film: a Newtonian and an Eyring fluid.

- The shear stress tau is the same all over the film, so that the energy equation K_f T'' = -tau dV/dz with a viscosity
  that falls as exp(-beta T) is Bratu's problem, with the solution T(z) - T_s = (2/beta) ln[cosh(a)/cosh(2 a z/h)], z
  from the middle. The sliding speed, tau/eta integrated over the film, then gives sinh(a) = sqrt(Na/8) and the stress
  tau = (eta_s V/h) a/(sinh(a) cosh(a)), with the Nahme number Na = beta eta_s V^2/K_f.
- An Eyring fluid is the same with its effective viscosity tau/g = eta tau/(tau0 sinh(tau/tau0)), which the one stress
  makes the same all over the film but for its temperature.
- The surfaces take half of the heat tau V each and share one flash temperature, as in the laws that are heated by
  their mean stress; h/(12 K_f) in those is the first term of the solution above for little heat.
"""

from types import MappingProxyType
from typing import ClassVar

import attrs
import numpy as np

from rollslip.models import POSITIVE
from rollslip.references import Reference
from rollslip.search import Array
from rollslip_kernels.slices import Slices
from rollslip_kernels.stages import thermal_couette as compiled
from rollslip_plugins.bibliography import CROOK_1961, JOHNSON_GREENWOOD_1980, NAHME_1940
from rollslip_plugins.symbols import explained
from rollslip_plugins.traction.heating import (
    HEATED,
    NO_EFFECT,
    HeatedFilm,
    flash_factor,
    newtonian_bound,
    softened,
)


@attrs.frozen(kw_only=True)
@explained
class NewtonianThermal(HeatedFilm):
    """Newtonian film with exact conduction across it after Crook, between surfaces at their flash temperature.

    tau = (eta_s V/h) asinh(x)/(x sqrt(1 + x^2)), x^2 = Na/8, Na = beta eta_s V^2/K_f, eta_s = eta exp(-beta T_s),
    T_s = flash sqrt(b/(pi u))/sqrt(K rho c) tau V, mu = tau/p. Between cold surfaces the stress has its maximum where
    beta tau^2 h^2/(4 eta K_f) = 0.8785, the critical value of Frank-Kamenetskii's problem of a slab.

    Symbols:

    - mu: traction coefficient, with the sign of V [1]
    - x: root of an eighth of the Nahme number [1]
    - eta_s: viscosity at the temperature of the surfaces [Pa s]
    - T_s: temperature of both surfaces above the inlet [K]
    - eta, beta, p, V, u, h, b, flash, K_f, K

    Range: steady conduction across the film only, a viscosity exponential in temperature. Without shear thinning the
    stress at high pressure is one that no oil bears.

    Examples
    --------
    Between cold surfaces, eta V/h = 1 MPa at 10 MPa and Na = 8: mu = 0.1 asinh(1)/sqrt(2) = 0.0623225.

    >>> from rollslip import Conditions, Slices
    >>> slices = Slices(1, Conditions(effusivity=1e30, conductivity=0.005), pressure=1e7, half_width=1e-4,
    ...                 film_thickness=1e-6, rolling_speed=1.0, sliding_speed=1.0, film_viscosity=1.0,
    ...                 film_thermoviscosity=0.04)
    >>> NewtonianThermal().evaluate(slices)
    >>> f"{slices.friction[0]:.7f}"
    '0.0623225'
    """

    name: ClassVar[str] = "newtonian-thermal"
    equation: ClassVar[str] = (
        "mu = eta_s V/(h p) asinh(x)/(x sqrt(1 + x^2)), x^2 = beta eta_s V^2/(8 K_f), eta_s = eta exp(-beta T_s), "
        "T_s = flash sqrt(b/(pi u))/sqrt(K rho c) mu p V"
    )
    references: ClassVar[tuple[Reference, ...]] = (CROOK_1961, NAHME_1940)
    expected_failures = MappingProxyType(
        {
            "check_friction_coefficient_is_below_unity": "a Newtonian oil whose viscosity does not fall with "
            "temperature bears any stress"
        }
    )

    flash: float = flash_factor()

    def fraction(self, newtonian: Array, surfaces: Array, across: Array, slices: Slices) -> Array:
        """Return t of the film without thinning."""
        return couette(np.zeros_like(newtonian), surfaces, across)

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.newtonian_thermal(self.flash)


@attrs.frozen(kw_only=True)
@explained
class EyringThermal(HeatedFilm):
    """Eyring film with exact conduction across it after Johnson and Greenwood, between surfaces at flash temperature.

    As ``newtonian-thermal`` with eta_e = eta exp(-beta T_s) (tau/tau0)/sinh(tau/tau0) in place of eta_s: the stress is
    uniform across the film, so that the fluid flows as a Newtonian one of that effective viscosity. Limits:
    ``newtonian-thermal`` for tau0 -> infinity; without heat tau = tau0 asinh(eta V/(tau0 h)).

    Symbols:

    - mu: traction coefficient, with the sign of V [1]
    - tau: shear stress mu p [Pa]
    - tau0: Eyring stress [Pa]
    - x: root of an eighth of the Nahme number of eta_e [1]
    - eta_e: effective viscosity at the temperature of the surfaces [Pa s]
    - T_s: temperature of both surfaces above the inlet [K]
    - eta, beta, p, V, u, h, b, flash, K_f, K

    Range: no elasticity; steady conduction across the film only, a viscosity exponential in temperature. The numbers of
    the source were not at hand; it is checked against the energy equation.

    Examples
    --------
    Cold, with eta V/h = tau0 = 1 MPa at 10 MPa: mu = 0.1 asinh(1) = 0.0881374.

    >>> from rollslip import Conditions, Slices
    >>> slices = Slices(1, Conditions(effusivity=13e3, conductivity=0.14, eyring_stress=1e6), pressure=1e7,
    ...                 half_width=1e-4, film_thickness=1e-6, rolling_speed=1.0, sliding_speed=1.0,
    ...                 film_viscosity=1.0, film_thermoviscosity=0.0)
    >>> EyringThermal().evaluate(slices)
    >>> f"{slices.friction[0]:.7f}"
    '0.0881374'
    """

    name: ClassVar[str] = "eyring-thermal"
    equation: ClassVar[str] = (
        "mu = eta_e V/(h p) asinh(x)/(x sqrt(1 + x^2)), x^2 = beta eta_e V^2/(8 K_f), tau = mu p, "
        "eta_e = eta exp(-beta T_s) (tau/tau0)/sinh(tau/tau0), T_s = flash sqrt(b/(pi u))/sqrt(K rho c) tau V"
    )
    references: ClassVar[tuple[Reference, ...]] = (
        JOHNSON_GREENWOOD_1980,
        *NewtonianThermal.references,
    )
    reads = HeatedFilm.reads | {"eyring_stress"}
    domain = MappingProxyType({**HEATED, "eyring_stress": POSITIVE})

    flash: float = flash_factor()

    def fraction(self, newtonian: Array, surfaces: Array, across: Array, slices: Slices) -> Array:
        """Return t of the film with Eyring's thinning."""
        return couette(newtonian / slices.conditions.eyring_stress, surfaces, across)

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.eyring_thermal(self.flash)


def couette(strain: Array, surfaces: Array, across: Array) -> Array:
    """Return t = e asinh(x)/(x sqrt(1 + x^2)), x^2 = e Na/8, e = exp(-surfaces t) S/sinh S, S = strain t."""

    def law(fraction: Array) -> tuple[Array, Array]:
        stress = np.maximum(strain * fraction, NO_EFFECT)
        drop = -np.expm1(-2 * stress)
        thinned = np.exp(-surfaces * fraction - stress) * (2 * stress / drop)
        fall = surfaces * fraction + stress * (2 - drop) / drop - 1  # of ln(thinned): S coth S - 1
        value, rise = conducted(across / 8 * thinned)
        return thinned * value, fall * (1 + rise)

    bound = np.minimum(newtonian_bound(surfaces), conducted(across / 8)[0])
    return softened(
        law,
        np.minimum(
            bound, np.arcsinh(np.maximum(strain, NO_EFFECT)) / np.maximum(strain, NO_EFFECT)
        ),
    )


def conducted(square: Array) -> tuple[Array, Array]:
    """Return G = asinh(x)/(x sqrt(1 + x^2)) of x^2 and dlnG/dln(x^2), from 0 to -1."""
    x = np.sqrt(np.maximum(square, NO_EFFECT**2))
    c = np.hypot(1.0, x)
    ratio = np.arcsinh(x) / x
    return ratio / c, (1 / (c * ratio) - 1 - (x / c) ** 2) / 2
