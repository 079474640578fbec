"""Traction of a shear-thinning film after Cross, in NumPy only."""

from types import MappingProxyType
from typing import ClassVar

import attrs
import numpy as np
from rollslip import Slices
from rollslip.fields import in_range, parameter, positive
from rollslip.hookspecs import hookimpl
from rollslip.models import FINITE, POSITIVE, TractionModel


@attrs.frozen(kw_only=True)
class Cross(TractionModel):
    """Shear thinning after Cross, with a critical stress in place of a relaxation time.

    mu = tau/p,  tau = eta g/(1 + |eta g/G|^m),  g = V/h

    g shear rate [1/s], V sliding speed [m/s], h film thickness [m], p mean Hertz pressure [Pa], eta viscosity of the
    oil at that pressure [Pa s], G stress at which the viscosity has halved [Pa], m exponent of the thinning [1].

    Limits: Newtonian, tau = eta g, for eta g << G; a power law, tau = G (eta g/G)^(1 - m), for eta g >> G, which is
    the limit G for m = 1 and else grows without bound.

    Range: isothermal, a film of constant thickness. The defaults are not those of a named oil (D).
    """

    name: ClassVar[str] = "cross"
    equation: ClassVar[str] = "mu = eta g/(p (1 + |eta g/G|^m)), g = V/h"
    references: ClassVar[tuple[str, ...]] = (
        "Cross M.M. Rheology of non-Newtonian fluids: a new flow equation for pseudoplastic systems. "
        "J. Colloid Sci. 20, 1965, 417-437.",
    )
    reads = frozenset({"pressure", "film_thickness", "sliding_speed", "film_viscosity"})
    domain = MappingProxyType(
        {
            "pressure": POSITIVE,
            "film_thickness": POSITIVE,
            "sliding_speed": FINITE,
            "film_viscosity": POSITIVE,
        }
    )

    critical_stress: float = parameter(default=6e6, unit="Pa", validator=positive, doc="critical stress G")
    exponent: float = parameter(default=0.8, unit="1", validator=in_range(0.0, 1.0), doc="exponent m of the thinning")

    def evaluate(self, slices: Slices) -> None:
        """Fill the traction coefficient."""
        strain = slices.film_viscosity * slices.sliding_speed / (slices.film_thickness * self.critical_stress)
        thinning = 1.0 + np.abs(strain) ** self.exponent
        slices.friction[...] = self.critical_stress / slices.pressure * strain / thinning


@hookimpl
def traction_models() -> list[type[TractionModel]]:
    """Offer the model."""
    return [Cross]
