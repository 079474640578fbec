"""An oil: its laws of temperature and pressure, its other data, and what they give at one temperature.

What an oil lacks is ``None`` in `Lubricant` and nan in `OilState`: a model that reads it cannot be bound to the oil.
"""

import math
from collections.abc import Mapping
from typing import Any

from attrs import NOTHING, Factory, frozen
from attrs import field as attrib
from attrs.validators import optional

from rollslip.errors import DomainError
from rollslip.fields import FieldError, field, positive
from rollslip.lubricant.pressure import Barus, PressureViscosity
from rollslip.lubricant.temperature import TemperatureLaw
from rollslip.references import Citation
from rollslip.structure import FrozenTable
from rollslip.units import format_quantity

__all__ = ["Lubricant", "OilState", "Scatter"]


@frozen(kw_only=True)
class OilState:
    """An oil at one temperature; what the oil lacks is nan, and no model that reads it may be bound to it.

    Parameters
    ----------
    temperature : float
        T [K].
    viscosity : float
        Dynamic viscosity at ambient pressure, eta0 [Pa s].
    pressure_viscosity : float
        Pressure-viscosity coefficient alpha [1/Pa].
    thermoviscosity : float
        beta0 = -d(ln eta0)/dT [1/K].
    pressure_thermoviscosity : float
        gamma = -d(alpha)/dT [1/(Pa K)].
    conductivity : float
        Thermal conductivity K_f [W/(m K)].
    eyring_stress : float
        tau0 [Pa].
    shear_modulus : float
        Gamma [Pa].
    """

    temperature: float
    viscosity: float
    pressure_viscosity: float
    thermoviscosity: float
    pressure_thermoviscosity: float
    conductivity: float
    eyring_stress: float
    shear_modulus: float


def positive_field(unit: str, doc: str, default: object = NOTHING) -> Any:
    """Declare a field of a positive quantity; one whose default is None may be left out."""
    return field(unit=unit, doc=doc, default=default, validator=positive if default is not None else optional(positive))


@frozen(kw_only=True)
class Scatter:
    """How uncertain a datum of an oil is, and who says so.

    Parameters
    ----------
    quantity : str
        Key of the table ``[lubricant]`` of a scene that scatters.
    distribution : str
        Name of its distribution, as in the table ``[uncertainty]`` of a scene.
    parameters : mapping
        Its parameters there, with units; a centre that is left out is the value of the scene.
    grade : str
        "(B)" for a standard reference, "(C)" with doubt, "(D)" an estimate.
    source : str
        Where it comes from, in a sentence.
    """

    quantity: str
    distribution: str
    parameters: Mapping[str, object] = attrib(converter=FrozenTable)
    grade: str
    source: str


@frozen(kw_only=True)
class Lubricant:
    """An oil: its temperature laws, its shear properties, and where each of them comes from.

    The three factors are for calibration and for the scatter of the data: they multiply eta0, alpha and gamma. alpha
    carries its slope with it, so gamma takes `pressure_viscosity_factor` *and* `pressure_thermoviscosity_factor`.

    Parameters
    ----------
    name : str
        As scenes call it.
    description : str
        What it is, in a sentence.
    viscosity : TemperatureLaw
        Dynamic viscosity at ambient pressure, eta0(T) [Pa s].
    pressure_viscosity : TemperatureLaw, optional
        Pressure-viscosity coefficient alpha(T) [1/Pa].
    pressure_viscosity_law : PressureViscosity
        How viscosity rises with pressure; one that fixes alpha itself overrules `pressure_viscosity`.
    conductivity : TemperatureLaw, optional
        Thermal conductivity K_f(T) [W/(m K)].
    eyring_stress : float, optional
        tau0 [Pa].
    shear_modulus : float, optional
        Gamma [Pa].
    minimum_temperature, maximum_temperature : float
        Range in which the data hold [K].
    source : str
        Origin of each datum, with its grade where it is not a published value.
    references : tuple of Reference or str
        One citation each, see `rollslip.references`.
    viscosity_factor, pressure_viscosity_factor, pressure_thermoviscosity_factor : float
        Factors on eta0, alpha and gamma [-].
    scatter : tuple of Scatter
        How uncertain its data are: what ``rollslip uncertainty`` takes where the scene states nothing.

    Raises
    ------
    ValueError
        A value is not positive, the range is empty, or the viscosity rises over it.
    """

    name: str
    description: str
    viscosity: TemperatureLaw
    pressure_viscosity: TemperatureLaw | None = None
    pressure_viscosity_law: PressureViscosity = Factory(Barus)
    conductivity: TemperatureLaw | None = None
    eyring_stress: float | None = positive_field("Pa", "Eyring stress", None)
    shear_modulus: float | None = positive_field("Pa", "shear modulus", None)
    minimum_temperature: float = positive_field("K", "lowest temperature at which the data hold")
    maximum_temperature: float = positive_field("K", "highest temperature at which the data hold")
    source: str
    references: tuple[Citation, ...] = ()
    viscosity_factor: float = positive_field("1", "factor on the viscosity", 1.0)
    pressure_viscosity_factor: float = positive_field("1", "factor on the pressure-viscosity coefficient", 1.0)
    pressure_thermoviscosity_factor: float = positive_field("1", "factor on the slope of that coefficient", 1.0)
    scatter: tuple[Scatter, ...] = ()

    def __attrs_post_init__(self) -> None:
        low, high = self.minimum_temperature, self.maximum_temperature
        if low >= high:
            raise FieldError("minimum_temperature", f"{_celsius(low)} is not below the maximum, {_celsius(high)}")
        try:
            falls = self.viscosity(low) >= self.viscosity(high) > 0.0
        except ArithmeticError:  # a pole of the law
            falls = False
        if not falls:
            raise FieldError(
                "minimum_temperature",
                f"the viscosity does not fall from {_celsius(low)} to {_celsius(high)} after {self.viscosity}; "
                "narrow the range from lubricant.minimum_temperature to lubricant.maximum_temperature",
            )
        factors = (self.pressure_viscosity_factor, self.pressure_thermoviscosity_factor)
        if factors != (1.0, 1.0) and not math.isnan(self.pressure_viscosity_law.coefficient(low)):
            raise FieldError(
                "pressure_viscosity_law",
                f"{self.pressure_viscosity_law.name!r} fixes alpha itself, so factors on it have no effect; leave out "
                "pressure_viscosity_factor and pressure_thermoviscosity_factor",
            )

    def at(self, temperature: float) -> OilState:
        """Properties at a temperature.

        Parameters
        ----------
        temperature : float
            T [K].

        Returns
        -------
        OilState
            nan where the oil has no data.

        Raises
        ------
        DomainError
            The temperature is outside the range in which the oil's data hold.
        """
        if not self.minimum_temperature <= temperature <= self.maximum_temperature:
            raise DomainError(
                f"{self.name} at {_celsius(temperature)}: its data hold from {_celsius(self.minimum_temperature)} to "
                f"{_celsius(self.maximum_temperature)}; change the temperature, choose another oil, or widen "
                f"lubricant.minimum_temperature or lubricant.maximum_temperature if you can vouch for its laws there"
            )
        eta0, eta0_fall = _evaluate(self.viscosity, temperature)
        alpha, alpha_fall = self.pressure_viscosity_law.coefficient(temperature), math.nan
        if math.isnan(alpha):
            alpha, alpha_fall = _evaluate(self.pressure_viscosity, temperature)
        conductivity, _ = _evaluate(self.conductivity, temperature)
        return OilState(
            temperature=temperature,
            viscosity=self.viscosity_factor * eta0,
            pressure_viscosity=self.pressure_viscosity_factor * alpha,
            thermoviscosity=eta0_fall / eta0,
            pressure_thermoviscosity=(
                self.pressure_thermoviscosity_factor * self.pressure_viscosity_factor * alpha_fall
            ),
            conductivity=conductivity,
            eyring_stress=math.nan if self.eyring_stress is None else self.eyring_stress,
            shear_modulus=math.nan if self.shear_modulus is None else self.shear_modulus,
        )


def _evaluate(law: TemperatureLaw | None, T: float) -> tuple[float, float]:
    """Value of a law and its fall per kelvin; nan for a law the oil lacks."""
    # 0.0 - x, not -x: a constant law falls by 0, not by -0.
    return (math.nan, math.nan) if law is None else (law(T), 0.0 - law.derivative(T))


def _celsius(T: float) -> str:
    return format_quantity(T, "K")
