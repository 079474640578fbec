"""Laws of viscosity under pressure, and of the pressure in a film, that each break one rule of the contract."""

from types import MappingProxyType

import attrs
import numpy as np

from broken_models import SOURCE, listing
from rollslip.fields import parameter, positive
from rollslip.lubricant.pressure import PressureViscosity, factor_of_oil
from rollslip.models import FINITE, NON_NEGATIVE, POSITIVE, PressureModel
from rollslip_kernels.chain import python_stage

BROKEN = []
breaks = listing(BROKEN)


@attrs.frozen(kw_only=True)
class Power(PressureViscosity):
    """A power law, eta = eta0 (1 + alpha p/n)^(c n)."""

    name = "sound-pressure-viscosity"
    equation = "eta = eta0 (1 + alpha p/n)^(c n)"
    references = SOURCE
    reads = frozenset(
        {
            "pressure",
            "viscosity",
            "pressure_viscosity",
            "thermoviscosity",
            "pressure_thermoviscosity",
        }
    )
    domain = MappingProxyType(
        {
            "pressure": NON_NEGATIVE,
            "viscosity": POSITIVE,
            "pressure_viscosity": NON_NEGATIVE,
            "thermoviscosity": NON_NEGATIVE,
            "pressure_thermoviscosity": FINITE,
        }
    )
    power: float = parameter(default=16.0, unit="1", validator=positive, doc="power n")
    factor: float = factor_of_oil()

    def at(self, conditions, pressure):
        c = conditions
        p = np.asarray(pressure, dtype=float)
        rise = c.pressure_viscosity * p / self.power
        fall = c.thermoviscosity + self.factor * c.pressure_thermoviscosity * p / (1.0 + rise)
        return c.viscosity * np.exp(self.exponent(rise)), fall

    def exponent(self, rise):
        return self.factor * self.power * np.log1p(rise)


@attrs.frozen
class Squeezed(PressureModel):
    """Hertz's pressure in a film, written anew."""

    name = "sound-pressure"
    equation = "p = w/(2 b), b = sqrt(8 w R/(pi E'))"
    references = SOURCE

    def evaluate(self, slices):
        c = slices.conditions
        slices.half_width[...] = np.sqrt(8 * c.radius / (np.pi * c.modulus) * slices.load)
        slices.pressure[...] = self.pressure(slices, c)

    def pressure(self, s, c):
        return s.load / (2 * s.half_width)


SOUND = [Power(), Squeezed()]


@breaks("check_viscosity_does_not_fall_with_pressure")
class Thins(Power):
    """An oil that thins under pressure."""

    def exponent(self, rise):
        return -super().exponent(rise)


@breaks("check_without_pressure_the_oil_is_as_it_was")
class Thicker(Power):
    """An oil that is a thousandth thicker without pressure."""

    def exponent(self, rise):
        return super().exponent(rise) + 1e-3


@breaks("check_values_at_pressures_are_those_of_the_stage")
class Apart(Power):
    """A stage that is a millionth above what the law says at pressures."""

    def evaluate(self, slices):
        super().evaluate(slices)
        slices.film_viscosity[...] *= 1.0 + 1e-6


@breaks("check_log_kernel_gives_the_logarithm")
class Decimal(Power):
    """A law whose logarithm is the decimal one."""

    def log_kernel(self):
        return python_stage(self.decimal, self.writes)

    def decimal(self, slices):
        self.evaluate(slices)
        slices.film_viscosity[...] = np.log10(slices.film_viscosity)


@breaks("check_uses_the_pressure_factor_of_an_oil")
class Deaf(Power):
    """A law that takes a factor of the oil and makes nothing of it."""

    def exponent(self, rise):
        return self.power * np.log1p(rise)


@breaks("check_fall_with_temperature_is_the_derivative_of_the_viscosity")
class Warmed(Power):
    """A law whose fall with temperature has gamma with the wrong sign."""

    def at(self, conditions, pressure):
        viscosity, fall = super().at(conditions, pressure)
        return viscosity, 2.0 * conditions.thermoviscosity - fall


@breaks("check_slope_without_pressure_is_alpha")
class Doubled(Power):
    """A law that rises twice as fast as the oil says."""

    def at(self, conditions, pressure):
        twice = attrs.evolve(
            conditions,
            pressure_viscosity=2.0 * conditions.pressure_viscosity,
            pressure_thermoviscosity=2.0 * conditions.pressure_thermoviscosity,
        )
        return super().at(twice, pressure)


@breaks("check_pressure_does_not_fall_with_the_load")
class Relieved(Squeezed):
    """A pressure that falls where the load is large."""

    def pressure(self, s, c):
        most = 1e-3 * c.modulus
        return np.minimum(super().pressure(s, c), most * most / super().pressure(s, c))
