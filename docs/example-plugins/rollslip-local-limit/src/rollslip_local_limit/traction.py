"""Traction at the local pressure, Newtonian up to a limiting shear stress."""

from typing import ClassVar

import attrs
import numpy as np
from rollslip import Slices
from rollslip.bearing.chain import stage
from rollslip.fields import parameter, positive
from rollslip.hookspecs import hookimpl
from rollslip.lubricant.pressure import PressureViscosity, from_oil
from rollslip.models import FINITE, POSITIVE, Domain, TractionModel, common_domain

from rollslip_local_limit import _kernel

#: Pressures over the largest one, and weights, of the mean over Hertz's contact by Gauss's rule.
POINTS = np.array([0.231152, 0.639971, 0.954497])
WEIGHTS = np.array([0.085301, 0.341456, 0.573243])
#: What the law reads besides what the oil's law does, with ranges.
FILM = {"pressure": POSITIVE, "film_thickness": POSITIVE, "sliding_speed": FINITE}


@attrs.frozen(kw_only=True)
class LocalLimit(TractionModel):
    """Newtonian shear up to a limit in proportion to the pressure, at three pressures of the contact.

    mu = sign(V) sum of w_i min(eta_i |V|/h, lambda p_i)/p,  p_i = (4/pi) c_i p

    V sliding speed [m/s], h film thickness [m], p mean Hertz pressure [Pa], eta_i viscosity at p_i by the oil's law
    [Pa s], lambda limiting stress over pressure [1], c_i and w_i points and weights of Gauss's rule [1].

    Range: isothermal, inelastic, a film of constant thickness; the default of lambda is not that of a named oil (D).
    """

    name: ClassVar[str] = "local-limit"
    equation: ClassVar[str] = "mu = sign(V) mean of min(eta(p) |V|/h, lambda p)/p"
    references: ClassVar[tuple[str, ...]] = (
        "Smith F.W. Lubricant behavior in concentrated contact: some rheological problems. ASLE Trans. 3, 1960, 18-25.",
    )

    law: PressureViscosity = from_oil()
    limit: float = parameter(default=0.08, unit="1", validator=positive, doc="limiting stress over pressure lambda")

    @property
    def reads(self) -> frozenset[str]:
        """Contact, film, and what the oil's law reads."""
        return frozenset(FILM) | self.law.reads

    @property
    def domain(self) -> Domain:
        """Where this law and that of the oil are defined."""
        return common_domain(FILM, self.law.domain)

    def evaluate(self, slices: Slices) -> None:
        """Fill the traction coefficient."""
        s = slices
        pressure = 4.0 / np.pi * POINTS[:, None] * s.pressure
        viscosity, _ = self.law.at(s.conditions, pressure)
        # beyond 1e30 the limit decides, and infinity times no speed is not a number
        newtonian = np.minimum(viscosity, 1e30) * np.abs(s.sliding_speed) / s.film_thickness
        stress = WEIGHTS @ np.minimum(newtonian, self.limit * pressure)
        s.friction[...] = np.sign(s.sliding_speed) * stress / s.pressure

    def kernel(self) -> object:
        """Return the compiled form, with that of the oil's law."""
        return _kernel.capsule(stage(self.law), self.limit)


@hookimpl
def traction_models() -> list[type[TractionModel]]:
    """Offer the model."""
    return [LocalLimit]
