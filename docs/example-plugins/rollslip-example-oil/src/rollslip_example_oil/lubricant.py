"""A mineral oil of the grade ISO VG 46, as an example, with a pressure-viscosity law of its own."""

import math

import attrs
from rollslip.hookspecs import hookimpl
from rollslip.lubricant import Constant, Lubricant, TemperatureLaw, fit_walther


@attrs.frozen
class Wooster:
    """Pressure-viscosity coefficient of mineral oils after Wooster, from their viscosity.

    alpha = (0.6 + 0.965 log10 eta) 1e-8,  eta in mPa s, alpha in 1/Pa

    Range: mineral oils at moderate temperatures; for eta above 0.24 mPa s, where alpha is positive.

    Parameters
    ----------
    viscosity : TemperatureLaw
        Dynamic viscosity eta0(T) [Pa s].

    References
    ----------
    Stachowiak G.W., Batchelor A.W. Engineering Tribology. Butterworth-Heinemann.
    """

    viscosity: TemperatureLaw

    def __call__(self, T: float) -> float:
        """Pressure-viscosity coefficient [1/Pa] at the temperature `T` [K]."""
        return (0.6 + 0.965 * math.log10(1e3 * self.viscosity(T))) * 1e-8

    def derivative(self, T: float) -> float:
        """Slope of the coefficient [1/(Pa K)] at the temperature `T` [K]."""
        return 0.965e-8 / math.log(10.0) * self.viscosity.derivative(T) / self.viscosity(T)


_DENSITY = 875.0  # kg/m3
_VISCOSITY = fit_walther([313.15, 373.15], [46e-6, 6.8e-6], density=_DENSITY)

EXAMPLE_OIL = Lubricant(
    name="example-oil",
    description="Mineral oil of the grade ISO VG 46; an example, not a product",
    viscosity=_VISCOSITY,
    pressure_viscosity=Wooster(_VISCOSITY),
    conductivity=Constant(0.13),
    eyring_stress=5e6,
    shear_modulus=0.3e9,
    minimum_temperature=273.15,
    maximum_temperature=393.15,
    source=(
        "Walther's law through kinematic viscosities of 46 mm2/s at 40 degC, middle of the grade in ISO 3448, and "
        "6.8 mm2/s at 100 degC, of a viscosity index near 100 (C); density 875 kg/m3 (C), constant. Pressure-viscosity "
        "coefficient after Wooster (B). Conductivity 0.13 W/(m K) (C), Eyring stress 5 MPa (D), shear modulus 0.3 GPa "
        "(D)."
    ),
    references=(
        "ASTM D341, Viscosity-Temperature Equations and Charts for Liquid Petroleum or Hydrocarbon Products.",
        "ISO 3448, Industrial liquid lubricants: ISO viscosity classification.",
        "Stachowiak G.W., Batchelor A.W. Engineering Tribology. Butterworth-Heinemann.",
    ),
)


@hookimpl
def lubricants() -> list[Lubricant]:
    """Offer the oil."""
    return [EXAMPLE_OIL]
