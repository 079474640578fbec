"""Eq. (8) of the paper in the variants that its authors may have computed, in NumPy only."""

import math
from types import MappingProxyType
from typing import Any, ClassVar

import attrs
import numpy as np
from numpy.typing import NDArray
from rollslip import Slices
from rollslip.fields import choice_of, parameter, positive
from rollslip.hookspecs import hookimpl
from rollslip.lubricant.pressure import PressureViscosity, from_oil
from rollslip.models import FINITE, NON_NEGATIVE, POSITIVE, Domain, TractionModel

Array = NDArray[np.float64]

#: Largest over mean pressure of a line contact after Hertz.
_PEAK = 4.0 / math.pi
_CONTACT: Domain = MappingProxyType(
    {
        "pressure": POSITIVE,
        "half_width": POSITIVE,
        "film_thickness": POSITIVE,
        "rolling_speed": POSITIVE,
        "sliding_speed": FINITE,
        "film_viscosity": POSITIVE,
        "film_thermoviscosity": NON_NEGATIVE,
        "effusivity": POSITIVE,
        "conductivity": POSITIVE,
        "eyring_stress": POSITIVE,
        "shear_modulus": POSITIVE,
    }
)


def dimensionless_stress(strain_rate: Any, deborah: Any, heating: Any, growth: str) -> Array:
    """Return S(sigma, D, Phi), the mean shear stress over tau0; arguments broadcast, sigma of any sign.

    (D Phi/4) y^2 - (1 + Phi sigma) y + L = 0, S = y - D y^2/(4 sigma), S = sigma/D where the ramp does not finish

    with L = ln(2 sigma), zero where that is negative (``growth = "logarithm"``), or L = asinh(sigma) ("asinh").
    """
    sigma, d, phi = np.broadcast_arrays(np.abs(np.asarray(strain_rate, dtype=float)), deborah, heating)
    at_rest = sigma == 0.0
    s = np.where(at_rest, 1.0, sigma)
    plateau = np.arcsinh(s) if growth == "asinh" else np.maximum(np.log(2.0 * s), 0.0)
    a = 1.0 + phi * s
    elastic = d * plateau > s * (1.0 + a)  # y > 2 sigma/D
    root = a * np.sqrt(np.maximum(1.0 - (d / a) * (phi * plateau / a), 0.0))
    y = 2.0 * plateau / (a + root)
    stress = np.where(elastic, s / np.where(elastic, d, 1.0), y * (1.0 - (d / s) * y / 4.0))
    return np.asarray(np.copysign(np.where(at_rest, 0.0, stress), strain_rate))


@attrs.frozen(kw_only=True)
class Klebanov(TractionModel):
    """Eq. (8) of Klebanov et al. (2022) with the misprint of its denominator mended, and with ln(2 sigma) as printed.

    mu = tau0 S/p, S = y - D y^2/(4 sigma), (D Phi/4) y^2 - (1 + Phi sigma) y + L = 0

    sigma = eta V/(tau0 h), D = eta u/(Gamma b), Phi = beta zeta tau0^2 h/eta,
    zeta = flash sqrt(b/(pi u))/sqrt(K rho c) + h/(12 K_f)

    L = ln(2 sigma) is negative below sigma = 1/2, and with it the friction: there it is cut at zero (``growth =
    "logarithm"``), which is how a program survives that has the formula as it is printed. With ``growth = "asinh"``
    the law is ``muraki`` of rollslip. ``viscosity_at = "maximum"`` takes eta and beta at the largest pressure of the
    contact, 4/pi times the mean: the paper does not say which it takes.

    Symbols: mu traction coefficient [1], p mean Hertz pressure [Pa], V sliding and u mean rolling speed [m/s], h film
    thickness and b half width [m], tau0 Eyring stress and Gamma shear modulus of the oil [Pa], eta viscosity at the
    pressure [Pa s], beta its fall with temperature [1/K], K_f conductivity of the oil [W/(m K)]; K, rho, c
    conductivity, density and heat capacity of the steel.

    Range: for comparison with the paper: below sigma = 1/2 there is no friction, where a Newtonian film has tau0
    sigma/p, and heated films come out too low as with ``muraki``.

    References
    ----------
    Klebanov et al. (2022), Eq. (8); Muraki (1987, 1992), whom it follows.
    """

    name: ClassVar[str] = "klebanov-2022"
    equation: ClassVar[str] = (
        "mu = tau0 S/p, S = y - D y^2/(4 sigma), (D Phi/4) y^2 - (1 + Phi sigma) y + max(ln(2 sigma), 0) = 0"
    )
    references: ClassVar[tuple[str, ...]] = (
        "Klebanov I.M., Polyakov K.A., Petrov V.R., Pankratova N.A. Slip in roller bearings under hydrodynamic contact "
        "friction. J. Frict. Wear 43, 2022. doi:10.3103/S1068366622010068",
        "Muraki M. Tribol. Int. 20 (6), 1987, 347-354.",
        "Muraki M. J. Synth. Lubr. 9 (1), 1992, 29-43.",
    )

    growth: str = parameter(
        default="logarithm",
        validator=choice_of("logarithm", "asinh"),
        doc="how the stress grows with the strain rate: ln(2 sigma) cut at zero, or asinh(sigma)",
    )
    viscosity_at: str = parameter(
        default="mean",
        validator=choice_of("mean", "maximum"),
        doc="pressure of the contact at which viscosity and its fall with temperature are taken",
    )
    flash: float = parameter(default=0.97, unit="1", validator=positive, doc="factor of the mean flash temperature")
    law: PressureViscosity = from_oil()

    @property
    def reads(self) -> frozenset[str]:  # type: ignore[override]
        """Contact, film and oil; at the largest pressure also what the law of the oil reads."""
        return frozenset(self.domain)

    @property
    def domain(self) -> Domain:  # type: ignore[override]
        """Where the form, and at the largest pressure the law of the oil, are defined."""
        if self.viscosity_at == "mean":
            return _CONTACT
        return MappingProxyType({**self.law.domain, **_CONTACT})

    def evaluate(self, slices: Slices) -> None:
        """Fill the traction coefficient."""
        c = slices.conditions
        s = slices
        eta = s.film_viscosity
        beta = s.film_thermoviscosity
        if self.viscosity_at == "maximum":
            eta, beta = self.law.at(c, _PEAK * s.pressure)
        zeta = self.flash / (c.effusivity * math.sqrt(math.pi)) * np.sqrt(s.half_width / s.rolling_speed)
        zeta = zeta + s.film_thickness / (12.0 * c.conductivity)
        stress = dimensionless_stress(
            eta * s.sliding_speed / (c.eyring_stress * s.film_thickness),
            eta * s.rolling_speed / (c.shear_modulus * s.half_width),
            beta * zeta * (c.eyring_stress * c.eyring_stress) * s.film_thickness / eta,
            self.growth,
        )
        s.friction[...] = c.eyring_stress / s.pressure * stress


@hookimpl
def traction_models() -> list[type[TractionModel]]:
    """Offer the model."""
    return [Klebanov]
