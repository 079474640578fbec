"""Traction of a film with a limiting shear stress after Bair and Winer."""

from types import MappingProxyType
from typing import ClassVar

import attrs
import numpy as np
from rollslip import Slices
from rollslip.fields import parameter, positive
from rollslip.hookspecs import hookimpl
from rollslip.models import FINITE, NON_NEGATIVE, POSITIVE, TractionModel

from rollslip_limiting_shear import _kernel


@attrs.frozen(kw_only=True)
class LimitingShear(TractionModel):
    """Smooth passage from Newtonian shear to a limiting stress in proportion to the pressure, after Bair and Winer.

    mu = sign(V) lambda [1 - exp(-eta |g|/tau_L)],  tau_L = lambda p,  g = V/h,  eta = eta0 exp(alpha p)

    which is their flow law g = -(tau_L/eta) ln(1 - tau/tau_L) solved for the stress, without its elastic term. g shear
    rate [1/s], V sliding speed [m/s], h film thickness [m], p mean Hertz pressure [Pa], eta0 viscosity at ambient
    pressure [Pa s], alpha pressure-viscosity coefficient [1/Pa], tau_L limiting stress [Pa], lambda its ratio to the
    pressure [1].

    Range: isothermal, inelastic, a film of constant thickness; lambda is some 0.03 to 0.12, of the oil and its
    temperature, and the default not that of a named oil (D).
    """

    name: ClassVar[str] = "limiting-shear"
    equation: ClassVar[str] = "mu = sign(V) lambda [1 - exp(-eta |V|/(h lambda p))], eta = eta0 exp(alpha p)"
    references: ClassVar[tuple[str, ...]] = (
        "Bair S., Winer W.O. A rheological model for elastohydrodynamic contacts based on primary laboratory data. "
        "J. Lubr. Technol. 101, 1979, 258-265.",
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

    limit: float = parameter(default=0.08, unit="1", validator=positive, doc="limiting stress over pressure lambda")

    def evaluate(self, slices: Slices) -> None:
        """Fill the traction coefficient."""
        c = slices.conditions
        eta = c.viscosity * np.exp(c.pressure_viscosity * slices.pressure)
        strain = eta * slices.sliding_speed / (slices.film_thickness * self.limit * slices.pressure)
        slices.friction[...] = -np.copysign(self.limit, strain) * np.expm1(-np.abs(strain))

    def kernel(self) -> object:
        """Return the compiled form."""
        return _kernel.capsule(self.limit)


@hookimpl
def traction_models() -> list[type[TractionModel]]:
    """Offer the model."""
    return [LimitingShear]
