"""Film thickness after Ertel and Grubin."""

from types import MappingProxyType
from typing import ClassVar

import attrs
from rollslip import Slices
from rollslip.hookspecs import hookimpl
from rollslip.models import POSITIVE, FilmModel

from rollslip_plain_c_film import _kernel


@attrs.frozen
class ErtelGrubin(FilmModel):
    """Central film of an elastic, piezoviscous line contact after Ertel and Grubin.

    h/R = 1.95 (G U)^(8/11) W^(-1/11),  U = eta0 u/(E' R),  G = alpha E',  W = w/(E' R)

    u entrainment speed [m/s], w load per length [N/m], R equivalent radius [m], E' equivalent modulus [Pa], eta0
    viscosity at ambient pressure [Pa s], alpha pressure-viscosity coefficient [1/Pa]. It is the power law through
    Grubin's integral over the inlet of a Hertzian gap, in which the reduced pressure rises to 1/alpha.

    Range: within 5 % of that integral for h R/b^2 from 0.01 to 2, b the Hertz half width; the integral itself holds for
    heavy loads, where the pressure of the dry contact stands in the inlet.
    """

    name: ClassVar[str] = "ertel-grubin"
    equation: ClassVar[str] = "h/R = 1.95 (G U)^(8/11) W^(-1/11)"
    references: ClassVar[tuple[str, ...]] = (
        "Grubin A.N., Vinogradova I.E. Investigation of the contact of machine components. TsNIITMASh, Book 30, "
        "Moscow, 1949.",
        "Cameron A. The Principles of Lubrication. Longmans, 1966.",
    )
    location: ClassVar[str] = "central"
    regime: ClassVar[str] = "VE"
    # the film of an oil without pressure-viscosity would be nothing, not thin
    domain = MappingProxyType({**FilmModel.domain, "pressure_viscosity": POSITIVE})

    def evaluate(self, slices: Slices) -> None:
        """Fill the film thickness."""
        c = slices.conditions
        gu = c.pressure_viscosity * c.viscosity * slices.rolling_speed / c.radius
        w = slices.load / (c.modulus * c.radius)
        slices.film_thickness[...] = c.radius * 1.95 * gu ** (8 / 11) * w ** (-1 / 11)

    def kernel(self) -> object:
        """Return the compiled form."""
        return _kernel.capsule()


@hookimpl
def film_models() -> list[type[FilmModel]]:
    """Offer the model."""
    return [ErtelGrubin]
