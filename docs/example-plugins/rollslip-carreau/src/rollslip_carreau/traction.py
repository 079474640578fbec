"""Traction of a shear-thinning film after Carreau, in NumPy only."""

from types import MappingProxyType
from typing import ClassVar

import attrs
import numpy as np
from rollslip import Slices
from rollslip.fields import in_range, parameter, positive
from rollslip.hookspecs import hookimpl
from rollslip.models import FINITE, NON_NEGATIVE, POSITIVE, TractionModel


@attrs.frozen(kw_only=True)
class Carreau(TractionModel):
    """Shear thinning after Carreau in Bair's form, with a critical stress in place of a relaxation time.

    mu = tau/p,  tau = eta g [1 + (eta g/G)^2]^((n - 1)/2),  g = V/h,  eta = eta0 exp(alpha p)

    g shear rate [1/s], V sliding speed [m/s], h film thickness [m], p mean Hertz pressure [Pa], eta0 viscosity at
    ambient pressure [Pa s], alpha pressure-viscosity coefficient [1/Pa], G critical stress at which thinning begins
    [Pa], n exponent of the thinning [1].

    Limits: Newtonian, tau = eta g, for eta g << G; a power law, tau = G (eta g/G)^n, for eta g >> G. The stress of
    n > 0 grows without bound: there is no limiting stress. n = 1 is Newtonian, n = 0 tends to tau = G.

    Range: isothermal, a film of constant thickness; the viscosity after Barus, too steep above some 0.5 GPa. G is some
    3 to 10 MPa and n some 0.3 to 0.7 for base oils; the defaults are not those of a named oil (D).
    """

    name: ClassVar[str] = "carreau"
    equation: ClassVar[str] = "mu = eta g/p [1 + (eta g/G)^2]^((n - 1)/2), g = V/h, eta = eta0 exp(alpha p)"
    references: ClassVar[tuple[str, ...]] = (
        "Carreau P.J. Rheological equations from molecular network theories. Trans. Soc. Rheol. 16, 1972, 99-127.",
        "Bair S. High-Pressure Rheology for Quantitative Elastohydrodynamics, 2nd ed. Elsevier, 2019.",
    )
    reads = frozenset({"pressure", "film_thickness", "sliding_speed", "viscosity", "pressure_viscosity"})
    domain = MappingProxyType(
        {
            "pressure": POSITIVE,
            "film_thickness": POSITIVE,
            "sliding_speed": FINITE,
            "viscosity": POSITIVE,
            "pressure_viscosity": NON_NEGATIVE,
        }
    )

    critical_stress: float = parameter(default=6e6, unit="Pa", validator=positive, doc="critical stress G")
    exponent: float = parameter(default=0.45, unit="1", validator=in_range(0.0, 1.0), doc="exponent n of the thinning")

    def evaluate(self, slices: Slices) -> None:
        """Fill the traction coefficient."""
        c = slices.conditions
        eta = c.viscosity * np.exp(c.pressure_viscosity * slices.pressure)
        strain = eta * slices.sliding_speed / (slices.film_thickness * self.critical_stress)
        thinning = np.hypot(1.0, strain) ** (self.exponent - 1.0)  # hypot: the square would overflow first
        slices.friction[...] = self.critical_stress / slices.pressure * strain * thinning


@hookimpl
def traction_models() -> list[type[TractionModel]]:
    """Offer the model."""
    return [Carreau]
