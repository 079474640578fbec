"""Hydrodynamic traction of an Eyring fluid: Muraki's closed form, the exact Maxwell-Eyring stress, no elasticity."""

import abc
import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import ClassVar

import attrs
import numpy as np
from numpy.typing import ArrayLike

from rollslip.lubricant.pressure import slope_of_oil
from rollslip.models import POSITIVE, Domain, Tabled, TractionModel, Validity
from rollslip.references import KLEBANOV, Reference
from rollslip.search import Array
from rollslip_kernels.slices import Slices
from rollslip_kernels.stages import traction as compiled
from rollslip_plugins.bibliography import (
    EYRING_1936,
    JOHNSON_TEVAARWERK_1977,
    MURAKI_1987,
    MURAKI_1992,
)
from rollslip_plugins.symbols import explained
from rollslip_plugins.traction.heating import (
    HEATED,
    MEAN_PRESSURE,
    NO_ASPERITIES,
    SLOW_SLIDING,
    flash_factor,
)
from rollslip_plugins.traction.stress import eyring_stress, maxwell_eyring_stress, muraki_stress

#: Remedy for a law that approximates the exact one.
EXACT = "traction 'maxwell-eyring', the exact law"
#: Description of the parameter for the rise of the Eyring stress with pressure.
RISE_OF_STRESS = "dtau0/dp of the oil"
#: Description of the parameter for the rise of the shear modulus with pressure.
RISE_OF_MODULUS = "dGamma/dp of the oil"


def _risen(value: float, slope: float, slices: Slices) -> Array:
    """Return a property of the oil at the mean pressure of slices, which is not read if the slope is zero."""
    return np.asarray(value + slope * slices.pressure if slope else value)


class EyringGroups(TractionModel, abc.ABC):
    """Traction of an Eyring oil, with the groups that say what it depends on: sigma, D and Phi at the mean pressure.

    sigma = eta V/(tau0 h), D = eta u/(Gamma b), Phi = beta zeta tau0^2 h/eta, with eta and beta = -dln(eta)/dT at the
    mean pressure after the oil's law, zeta = flash sqrt(b/(pi u))/sqrt(K rho c) + h/(12 K_f). tau0 and Gamma are those
    at the mean pressure, where the oil has slopes of them.
    """

    regimes: ClassVar[Mapping[str, tuple[str, str]]] = MappingProxyType(
        {
            "strain rate": ("strain_rate", "sigma"),
            "heating": ("softening", "Phi sigma S"),
            "elasticity": ("deborah", "D"),
        }
    )
    shapes = MappingProxyType({"cold": "rises", "heated": "one maximum"})
    flash: float
    eyring_stress_slope: float = 0.0
    shear_modulus_slope: float = 0.0

    def eyring_stress(self, slices: Slices) -> Array:
        """Return tau0 of slices [Pa], that at ambient pressure and its rise to the mean pressure."""
        return _risen(slices.conditions.eyring_stress, self.eyring_stress_slope, slices)

    def shear_modulus(self, slices: Slices) -> Array:
        """Return Gamma of slices [Pa], that at ambient pressure and its rise to the mean pressure."""
        return _risen(slices.conditions.shear_modulus, self.shear_modulus_slope, slices)

    def oil(self, slices: Slices) -> tuple[Array, Array]:
        """Return viscosity [Pa s] and its fall with temperature [1/K] at the mean pressure."""
        return slices.film_viscosity, slices.film_thermoviscosity

    def groups(self, slices: Slices) -> Mapping[str, Array]:
        """Return sigma, D and Phi of slices, by the names that `dimensionless_stress` has for them."""
        c = slices.conditions
        s = slices
        eta, beta = self.oil(s)
        tau0 = self.eyring_stress(s)
        zeta = (
            self.flash / (c.effusivity * np.sqrt(np.pi)) * np.sqrt(s.half_width / s.rolling_speed)
        )
        zeta = zeta + s.film_thickness / (12 * c.conductivity)
        # a product, since a power of Python's floats raises where it overflows
        phi = beta * zeta * (tau0 * tau0) * s.film_thickness / eta
        return {
            "strain_rate": eta * s.sliding_speed / (tau0 * s.film_thickness),
            "deborah": eta * s.rolling_speed / (self.shear_modulus(s) * s.half_width),
            "heating": phi,
        }

    def quantities(self, slices: Slices) -> Mapping[str, Array]:
        """Return sigma, D, Phi, and softening = Phi sigma S: by how much the heat of its friction lowers ln(eta)."""
        found = self.groups(slices)
        stress = slices.friction * slices.pressure / self.eyring_stress(slices)
        return {**found, "softening": np.abs(found["heating"] * found["strain_rate"] * stress)}


class _EyringFluid(EyringGroups):
    """Traction mu = tau0 S/p of a stress law S(sigma, D, Phi) at the mean pressure."""

    domain: Domain = MappingProxyType(
        {**HEATED, "eyring_stress": POSITIVE, "shear_modulus": POSITIVE}
    )
    reads = frozenset(domain)
    validity: ClassVar[tuple[Validity, ...]] = (NO_ASPERITIES, MEAN_PRESSURE, SLOW_SLIDING)

    @abc.abstractmethod
    def dimensionless_stress(
        self, strain_rate: ArrayLike, deborah: ArrayLike, heating: ArrayLike
    ) -> Array:
        """Return the mean shear stress over tau0, S(sigma, D, Phi); arguments broadcast."""

    def evaluate(self, slices: Slices) -> None:
        """Fill the traction coefficient."""
        slices.friction[...] = (
            self.eyring_stress(slices)
            / slices.pressure
            * self.dimensionless_stress(**self.groups(slices))
        )


@attrs.frozen(kw_only=True)
@explained
class Muraki(_EyringFluid):
    """Closed form of Muraki: linear elastic ramp, then an Eyring plateau with mean-stress heating.

    With L = asinh(sigma), a = 1 + Phi sigma: (D Phi/4) y^2 - a y + L = 0 and S = y - D y^2/(4 sigma), and
    S = sigma/D where the ramp does not finish (y > 2 sigma/D). It is Eq. (8) of Klebanov et al. but for a misprint in
    its denominator, D^2 for D, and for asinh(sigma), in whose place ln(2 sigma) is negative below sigma = 1/2.

    Symbols:

    - mu: traction coefficient, with the sign of V [1]
    - S: mean shear stress over tau0 [1]
    - sigma
    - D: Deborah number eta u/(Gamma b) [1]
    - Phi
    - y: plateau of the stress over tau0 [1]
    - zeta, tau0
    - Gamma: shear modulus of the oil, with its rise to p (``shear_modulus_slope``) [Pa]
    - eta, beta, p, V, u, h, b, flash, K_f, K

    Range: sigma exp(-Phi sigma S) >> 1. For Phi <= 1 heated films come out 3 % low at Phi sigma = 0.03, 8 % at 0.1 and
    14 to 41 % beyond 0.3; for Phi > 1 the form has no Newtonian limit, and its largest S is 36, 57, 84 and 95 % low at
    Phi = 3, 10, 100 and 1000. Without heat it is up to 3 % high for D <= 0.1, up to 36 % for D of 1 to 10.

    Examples
    --------
    Without elasticity the form is asinh(sigma)/(1 + Phi sigma): asinh(10)/2 = 2.998223/2.

    >>> f"{Muraki().dimensionless_stress(10.0, 0.0, 0.1):.6f}"
    '1.499111'
    """

    name: ClassVar[str] = "muraki"
    equation: ClassVar[str] = (
        "mu = tau0 S/p, S = y - D y^2/(4 sigma), (D Phi/4) y^2 - (1 + Phi sigma) y + asinh(sigma) = 0"
    )
    references: ClassVar[tuple[Reference, ...]] = (KLEBANOV, MURAKI_1987, MURAKI_1992)
    solved_by: ClassVar[str | None] = "maxwell-eyring"
    validity: ClassVar[tuple[Validity, ...]] = (
        *_EyringFluid.validity,
        Validity(
            code="W14",
            quantity="deborah",
            quantity_name="Deborah number D",
            high=0.1,
            consequence="its linear ramp gives at most {error} too much friction without heat",
            error=Tabled(
                (
                    (0.1, 2.6),
                    (0.3, 8.8),
                    (1.0, 32.1),
                    (2.0, 36.0),
                    (3.0, 25.6),
                    (10.0, 12.0),
                    (30.0, 7.0),
                )
            ),
            remedy=EXACT,
            replacement="maxwell-eyring",
            source="maxwell-eyring at sigma 1e-3 to 1e4 (docs/scripts/validity.py)",
        ),
        Validity(
            code="W15",
            quantity="film_heating",
            quantity_name="heating of a Newtonian film Phi sigma",
            high=0.03,
            consequence="it gives at most {error} too little friction in a heated film for Phi <= 1",
            error=Tabled(
                (
                    (0.03, 2.8),
                    (0.1, 8.2),
                    (0.3, 16.7),
                    (1.0, 19.8),
                    (3.0, 17.2),
                    (10.0, 19.1),
                    (100.0, 27.5),
                    (1e6, 40.6),
                )
            ),
            remedy=EXACT,
            replacement="maxwell-eyring",
            source="maxwell-eyring at Phi 1e-4 to 1, D 0 to 0.1 (docs/scripts/validity.py)",
        ),
        Validity(
            code="W16",
            quantity="heating",
            quantity_name="heating Phi",
            high=1.0,
            consequence="it has no Newtonian limit: its largest friction is {error} too low",
            error=Tabled(((1.0, 18.2), (3.0, 36.2), (10.0, 57.3), (100.0, 84.3), (1000.0, 94.8))),
            remedy=EXACT,
            replacement="maxwell-eyring",
            source="maxwell-eyring at D = 0 (docs/scripts/validity.py)",
        ),
    )
    flash: float = flash_factor()
    eyring_stress_slope: float = slope_of_oil(RISE_OF_STRESS)
    shear_modulus_slope: float = slope_of_oil(RISE_OF_MODULUS)

    def quantities(self, slices: Slices) -> Mapping[str, Array]:
        """Return those of its fluid, and film_heating = Phi sigma, by which the stress of a Newtonian film falls."""
        found = super().quantities(slices)
        return {**found, "film_heating": np.abs(found["heating"] * found["strain_rate"])}

    def dimensionless_stress(
        self, strain_rate: ArrayLike, deborah: ArrayLike, heating: ArrayLike
    ) -> Array:
        """Return S of the closed form."""
        return muraki_stress(strain_rate, deborah, heating)

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.muraki(self.flash, self.eyring_stress_slope, self.shear_modulus_slope)


@attrs.frozen(kw_only=True)
@explained
class MaxwellEyring(_EyringFluid):
    """Exact solution of the Maxwell-Eyring equation with mean-stress heating, which the closed forms approximate.

    D dS/dX + exp(Phi sigma Sbar) sinh S = sigma, X in [0, 2], S(0) = 0, Sbar the mean of S; solved to 1e-13
    by Halley's method on its closed form in dilogarithms, which is of first order in D where the entry layer is thin.

    Symbols:

    - mu: traction coefficient, with the sign of V [1]
    - S: local shear stress over tau0; its mean Sbar makes mu [1]
    - sigma
    - D: Deborah number eta u/(Gamma b) [1]
    - Phi
    - X: place along the contact over b, from 0 to 2 [1]
    - tau: local shear stress [Pa]
    - zeta, tau0
    - Gamma: shear modulus of the oil, with its rise to p (``shear_modulus_slope``) [Pa]
    - eta, beta, p, V, u, h, b, flash, K_f, K

    Range: any sigma, D and Phi; heating by the mean stress instead of the local one costs 0 to 4.5 %.

    Examples
    --------
    0.55129615215295 in fifty digits (tools/references/maxwell_eyring.py).

    >>> f"{MaxwellEyring().dimensionless_stress(1.0, 1.0, 0.0):.12f}"
    '0.551296152153'
    """

    name: ClassVar[str] = "maxwell-eyring"
    equation: ClassVar[str] = (
        "mu = tau0 S/p, S = mean of S(X) with D dS/dX + exp(Phi sigma S) sinh S(X) = sigma"
    )
    references: ClassVar[tuple[Reference, ...]] = (JOHNSON_TEVAARWERK_1977, KLEBANOV)
    closed_form: ClassVar[str | None] = "muraki"
    flash: float = flash_factor()
    eyring_stress_slope: float = slope_of_oil(RISE_OF_STRESS)
    shear_modulus_slope: float = slope_of_oil(RISE_OF_MODULUS)

    def dimensionless_stress(
        self, strain_rate: ArrayLike, deborah: ArrayLike, heating: ArrayLike
    ) -> Array:
        """Return S of the exact solution."""
        return maxwell_eyring_stress(strain_rate, deborah, heating)

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.maxwell_eyring(
            self.flash, self.eyring_stress_slope, self.shear_modulus_slope
        )


def _elastic_stress_ratio(deborah: float) -> float:
    """Return a small stress relative to that without elasticity: 1 - (1 - e^-x)/x at x = 2/D."""
    x = 2.0 / deborah
    return 0.5 * x * (1.0 - x / 3.0 * (1.0 - 0.25 * x)) if x < 1e-3 else 1.0 + math.expm1(-x) / x


@attrs.frozen(kw_only=True)
@explained
class Eyring(_EyringFluid):
    """Eyring stress with mean-stress heating and without elasticity: S = asinh(sigma exp(-Phi sigma S)).

    The exact limit D -> 0 of ``maxwell-eyring``; it needs no shear modulus.

    Symbols:

    - mu: traction coefficient, with the sign of V [1]
    - S: mean shear stress over tau0 [1]
    - sigma, Phi, zeta, tau0, eta, beta, p, V, u, h, b, flash, K_f, K

    Range: D = eta u/(Gamma b) << 1; in an elastic oil it is too high, by 1/[1 - (D/2) (1 - exp(-2/D))] at small sigma.

    Examples
    --------
    At Phi = sigma = 1 the equation is exp(2 S) = 3: S = ln(3)/2 = 0.549306.

    >>> f"{Eyring().dimensionless_stress(1.0, 0.0, 1.0):.6f}"
    '0.549306'
    """

    name: ClassVar[str] = "eyring"
    equation: ClassVar[str] = "mu = tau0 S/p, S = asinh(sigma exp(-Phi sigma S))"
    references: ClassVar[tuple[Reference, ...]] = (EYRING_1936, KLEBANOV)
    solved_by: ClassVar[str | None] = "maxwell-eyring"
    validity: ClassVar[tuple[Validity, ...]] = (
        *_EyringFluid.validity,
        Validity(
            code="W18",
            quantity="deborah",
            quantity_name="Deborah number D",
            high=0.05,
            consequence="without elasticity it gives at most {error} too much friction, most at small sigma",
            error=lambda deborah: 100.0 / _elastic_stress_ratio(deborah) - 100.0,
            remedy=EXACT,
            replacement="maxwell-eyring",
            source="small signal of maxwell-eyring, S = sigma [1 - (D/2) (1 - exp(-2/D))]",
        ),
    )
    reads = _EyringFluid.reads - {"shear_modulus"}
    domain = MappingProxyType(
        {k: v for k, v in _EyringFluid.domain.items() if k != "shear_modulus"}
    )
    flash: float = flash_factor()
    eyring_stress_slope: float = slope_of_oil(RISE_OF_STRESS)

    def dimensionless_stress(
        self, strain_rate: ArrayLike, deborah: ArrayLike, heating: ArrayLike
    ) -> Array:
        """Return S; the Deborah number is accepted and has no effect."""
        return eyring_stress(strain_rate, deborah, heating)

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.eyring(self.flash, self.eyring_stress_slope)
