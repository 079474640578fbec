"""Traction of a film with a limiting shear stress after Lee and Hamrock."""

from types import MappingProxyType
from typing import ClassVar

import attrs
import numpy as np
from rollslip import Slices
from rollslip.fields import parameter, positive
from rollslip.hookspecs import hookimpl
from rollslip.models import FINITE, POSITIVE, TractionModel

from rollslip_circular import _kernel


@attrs.frozen(kw_only=True)
class Circular(TractionModel):
    """Smooth passage from Newtonian shear to a limiting stress in proportion to the pressure, after Lee and Hamrock.

    mu = lambda x/sqrt(1 + x^2),  x = eta V/(h tau_L),  tau_L = lambda p

    which is their flow law g = (tau/eta) [1 - (tau/tau_L)^2]^(-1/2), g = V/h, solved for the stress: tau/tau_L
    and tau/(eta g) lie on a circle. V sliding speed [m/s], h film thickness [m], p mean Hertz pressure [Pa], eta
    viscosity of the oil at that pressure [Pa s], tau_L limiting stress [Pa], lambda its ratio to the pressure [1].

    Range: isothermal, inelastic, a film of constant thickness; lambda is some 0.03 to 0.12, of the oil and its
    temperature, and the default not that of a named oil (D).
    """

    name: ClassVar[str] = "circular"
    equation: ClassVar[str] = "mu = lambda x/sqrt(1 + x^2), x = eta V/(h lambda p)"
    references: ClassVar[tuple[str, ...]] = (
        "Lee R.-T., Hamrock B.J. A circular non-Newtonian fluid model: Part I - used in elastohydrodynamic "
        "lubrication. J. Tribol. 112, 1990, 486-496.",
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

    limit: float = parameter(default=0.08, unit="1", validator=positive, doc="limiting stress over pressure lambda")

    def evaluate(self, slices: Slices) -> None:
        """Fill the traction coefficient."""
        strain = slices.film_viscosity * slices.sliding_speed / (slices.film_thickness * self.limit * slices.pressure)
        slices.friction[...] = self.limit * (strain / np.hypot(1.0, strain))

    def kernel(self) -> object:
        """Return the compiled form."""
        return _kernel.capsule(self.limit)


@hookimpl
def traction_models() -> list[type[TractionModel]]:
    """Offer the model."""
    return [Circular]
