"""An oil: its laws of temperature and pressure, its other data, and its properties at one temperature.

A property that an oil lacks is ``None`` in `Lubricant` and nan in `OilState`: a model that reads it cannot be used with
the oil.
"""

import math
from collections.abc import Callable, Collection, Iterable, Mapping
from types import MappingProxyType
from typing import Any, Final

from attrs import NOTHING, Attribute, Factory, frozen
from attrs import field as attrib
from attrs.validators import optional

from rollslip.errors import DomainError
from rollslip.fields import (
    FieldError,
    Scatter,
    Span,
    choice_of,
    field,
    non_negative,
    positive,
    refuse_if,
)
from rollslip.lubricant.base_oil import BASE_OILS
from rollslip.lubricant.pressure import ALPHAS, PressureViscosity, default_law
from rollslip.lubricant.temperature import TemperatureLaw
from rollslip.references import Citation
from rollslip.structure import FrozenTable
from rollslip.toml import as_table
from rollslip.units import format_quantity

__all__ = ["GRADES", "Lubricant", "OilState", "Scatter", "legend", "scatter_of"]

#: Grades of data quality: letter -> meaning.
GRADES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "A": "printed in a source that was read",
        "B": "from a standard reference, or computed from printed values by a published formula",
        "C": "second-hand or recalled, with doubt",
        "D": "an estimate",
    }
)

#: Slope with temperature -> property that it is the slope of.
SLOPES: Final[Mapping[str, str]] = MappingProxyType(
    {"thermoviscosity": "viscosity", "pressure_thermoviscosity": "pressure_viscosity"}
)
_NO_GRADES: Final[Any] = FrozenTable()
#: Relative difference between a stated slope and that of its law from which a result has a note [1]. Doubling it hides
#: some notes. Chosen: papers print slopes with two digits.
_SLOPE_TOLERANCE: Final = 0.01
#: Temperature difference at which a note states the effect of a slope that is not that of its law [K]. It changes the
#: text only. Chosen as the temperature rise of a typical contact.
_NOTE_DISTANCE: Final = 10.0


def legend(grades: Iterable[str]) -> str:
    """Return the meaning of some letters of `GRADES` as text."""
    return "; ".join(f"({grade}) {GRADES[grade]}" for grade in sorted(set(grades)))


@frozen(kw_only=True)
class OilState:
    """Properties of an oil at one temperature; nan where the oil lacks one."""

    temperature: float  #: T [K].
    viscosity: float  #: Dynamic viscosity at ambient pressure, eta0 [Pa s].
    pressure_viscosity: float  #: Pressure-viscosity coefficient alpha [1/Pa].
    thermoviscosity: float  #: beta0 = -d(ln eta0)/dT [1/K].
    pressure_thermoviscosity: float  #: gamma = -d(alpha)/dT [1/(Pa K)].
    conductivity: float  #: Thermal conductivity K_f [W/(m K)].
    eyring_stress: float  #: tau0 [Pa].
    shear_modulus: float  #: Gamma [Pa].


def positive_field(
    unit: str,
    doc: str,
    default: object = NOTHING,
    usual: Span | None = None,
    possible: Span | None = None,
) -> Any:
    """Declare a field of a positive quantity; a field whose default is None is optional."""
    validator = positive if default is not None else optional(positive)
    return field(
        unit=unit, doc=doc, default=default, validator=validator, usual=usual, possible=possible
    )


def _positive_or_law(instance: object, attribute: "Attribute[Any]", value: object) -> None:
    if isinstance(value, int | float):
        positive(instance, attribute, value)


def _known_grades(instance: object, attribute: "Attribute[Any]", value: Mapping[str, str]) -> None:
    if unknown := sorted(set(value.values()) - GRADES.keys()):
        raise FieldError(
            "grades",
            f"there is no data quality {', '.join(unknown)}; there are {', '.join(GRADES)}",
        )


@frozen(kw_only=True)
class Lubricant:
    """An oil: its temperature laws, its shear properties, and where each of them comes from.

    The factors are for calibration and for the scatter of the data: three multiply eta0, alpha and gamma. gamma is a
    slope of alpha, so that `pressure_viscosity_factor` *and* `pressure_thermoviscosity_factor` multiply it. The fourth
    factor multiplies ln(eta/eta0): it changes the viscosity in a contact, and not the alpha of film formulas.

    Raises
    ------
    ValueError
        A value is not positive, the range is empty, the viscosity rises over it, or a grade does not exist.
    """

    #: Name in scenes.
    name: str
    #: Description, in a sentence.
    description: str
    #: Dynamic viscosity at ambient pressure, eta0(T) [Pa s].
    viscosity: TemperatureLaw
    #: Pressure-viscosity coefficient alpha(T) [1/Pa].
    pressure_viscosity: TemperatureLaw | None = None
    #: beta0(T) [1/K], where it is not the slope of `viscosity`, as in lists of constants.
    thermoviscosity: Callable[[float], float] | None = None
    #: gamma(T) [1/(Pa K)], where it is not the slope of `pressure_viscosity`.
    pressure_thermoviscosity: Callable[[float], float] | None = None
    #: Definition of `pressure_viscosity`: "tangent", the slope of ln(eta) at zero pressure, or "film", alpha* =
    #: 1/integral(eta0/eta dp). Film formulas use it as it is; a law computes its own constants from it.
    pressure_viscosity_kind: str = field(
        doc="which alpha it is, by its tangent or for films",
        default="tangent",
        validator=choice_of(*ALPHAS),
    )
    #: Law of viscosity under pressure, by default Roelands's; a law that determines alpha replaces
    #: `pressure_viscosity`.
    pressure_viscosity_law: PressureViscosity = Factory(default_law)
    #: Kind of base oil: mineral, pao, ester or pag.
    base_oil: str | None = field(
        doc="kind of base oil", default=None, validator=optional(choice_of(*BASE_OILS))
    )
    conductivity: TemperatureLaw | None = None  #: Thermal conductivity K_f(T) [W/(m K)].
    density: TemperatureLaw | None = None  #: Density rho(T) [kg/m3], which drags read.
    #: Eyring stress tau0 or tau0(T) [Pa].
    eyring_stress: float | TemperatureLaw | None = field(
        unit="Pa", doc="Eyring stress", default=None, validator=_positive_or_law
    )
    #: Shear modulus Gamma or Gamma(T) [Pa].
    shear_modulus: float | TemperatureLaw | None = field(
        unit="Pa", doc="shear modulus", default=None, validator=_positive_or_law
    )
    #: dtau0/dp [1]: tau0 is the stress at ambient pressure, and a slice has that at its mean pressure.
    eyring_stress_slope: float = field(
        unit="1", doc="rise of the Eyring stress with pressure", default=0.0, validator=non_negative
    )
    #: dGamma/dp [1]: Gamma is the modulus at ambient pressure, and a slice has that at its mean pressure.
    shear_modulus_slope: float = field(
        unit="1", doc="rise of the shear modulus with pressure", default=0.0, validator=non_negative
    )
    #: Lowest temperature of the data [K].
    minimum_temperature: float = positive_field("K", "lowest temperature at which the data hold")
    #: Highest temperature of the data [K].
    maximum_temperature: float = positive_field("K", "highest temperature at which the data hold")
    #: Source of each datum, with its grade where it is not a published value.
    source: str
    #: Citations, see `rollslip.references`.
    references: tuple[Citation, ...] = ()
    #: Factor on eta0 [1].
    viscosity_factor: float = positive_field("1", "factor on the viscosity", 1.0)
    #: Factor on alpha [1].
    pressure_viscosity_factor: float = positive_field(
        "1", "factor on the pressure-viscosity coefficient", 1.0
    )
    #: Factor on gamma [1].
    pressure_thermoviscosity_factor: float = positive_field(
        "1", "factor on the slope of that coefficient", 1.0
    )
    #: Factor on ln(eta/eta0) under pressure [1].
    pressure_exponent_factor: float = positive_field(
        "1", "factor on ln(eta/eta0) under pressure", 1.0
    )
    #: Uncertainty of its data, for ``rollslip uncertainty`` where the scene states none.
    scatter: tuple[Scatter, ...] = ()
    #: Property -> letter of `GRADES`.
    grades: Mapping[str, str] = attrib(
        default=_NO_GRADES,
        converter=FrozenTable,
        validator=_known_grades,
        metadata={"doc": "data quality of each property"},
    )
    #: Other names; capitals, spaces and hyphens do not count in names of data.
    synonyms: tuple[str, ...] = ()
    #: Constants for laws, as defaults of their parameters: a mapping for each law by name, and other keys for all laws
    #: that have the parameter; numbers in SI units, or texts with a unit.
    models: Mapping[str, Any] = attrib(
        default=FrozenTable(), converter=FrozenTable, metadata={"doc": "constants for laws, by law"}
    )

    def __attrs_post_init__(self) -> None:
        low = self.minimum_temperature
        high = self.maximum_temperature
        if low >= high:
            raise FieldError(
                "minimum_temperature", f"{_celsius(low)} is not below the maximum, {_celsius(high)}"
            )
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
        law = self.pressure_viscosity_law.of_oil(
            self.pressure_viscosity_kind, self.pressure_exponent_factor
        )
        object.__setattr__(self, "pressure_viscosity_law", law)
        factors = (self.pressure_viscosity_factor, self.pressure_thermoviscosity_factor)
        refuse_if(
            factors != (1.0, 1.0) and not math.isnan(law.coefficient(low)),
            "pressure_viscosity_law",
            (
                f"{law.name!r} fixes alpha itself, so factors on it have no effect; leave out "
                "pressure_viscosity_factor and pressure_thermoviscosity_factor"
            ),
        )

    def constants_for(self, law: str, known: Collection[str]) -> dict[str, object]:
        """Return the constants of the oil for a law.

        Parameters
        ----------
        law : str
            Name of the law.
        known : collection of str
            Names of its parameters.

        Returns
        -------
        dict
            Values by parameter; those in the table of the law replace those for all laws.
        """
        shared = {
            key: value
            for key, value in self.models.items()
            if key in known and not isinstance(value, Mapping)
        }
        return {**shared, **as_table(self.models.get(law))}

    @property
    def slopes(self) -> dict[str, float]:
        """Slopes with pressure [1], by the names of the fields of models."""
        return {
            "eyring_stress_slope": self.eyring_stress_slope,
            "shear_modulus_slope": self.shear_modulus_slope,
        }

    def at(self, temperature: float) -> OilState:
        """Return the properties at a temperature [K]; raise `DomainError` outside the range of the data."""
        if not self.minimum_temperature <= temperature <= self.maximum_temperature:
            raise DomainError(
                f"{self.name} at {_celsius(temperature)}: its data hold from {_celsius(self.minimum_temperature)} to "
                f"{_celsius(self.maximum_temperature)}; change the temperature, choose another oil, or widen "
                f"lubricant.minimum_temperature or lubricant.maximum_temperature if its laws are valid there"
            )
        alpha = self.pressure_viscosity_law.coefficient(temperature)
        beta0, gamma = self.falls(temperature)
        if math.isnan(alpha):
            alpha = _value(self.pressure_viscosity, temperature)
        else:
            gamma = math.nan
        return OilState(
            temperature=temperature,
            viscosity=self.viscosity_factor * self.viscosity(temperature),
            pressure_viscosity=self.pressure_viscosity_factor * alpha,
            thermoviscosity=beta0,
            pressure_thermoviscosity=self.pressure_thermoviscosity_factor
            * self.pressure_viscosity_factor
            * gamma,
            conductivity=_value(self.conductivity, temperature),
            eyring_stress=_value(self.eyring_stress, temperature),
            shear_modulus=_value(self.shear_modulus, temperature),
        )

    def notes(self, temperature: float) -> list[str]:
        """Return notes where beta0 or gamma is not the slope of its property at a temperature [K].

        Papers list both as constants, which are consistent at one temperature only. That is allowed, and the note
        states its effect.
        """
        alpha, alpha_fall = _evaluate(self.pressure_viscosity, temperature)
        eta0, eta0_fall = _evaluate(self.viscosity, temperature)
        beta0, gamma = self.falls(temperature)
        notes = []
        for key, stated, own, unit, size in (
            ("thermoviscosity", beta0, eta0_fall / eta0, "1/K", 1.0),
            ("pressure_thermoviscosity", gamma, alpha_fall, "1/(Pa K)", alpha),
        ):
            # the comparison is false with nan, where the oil lacks the property
            if not abs(stated - own) > _SLOPE_TOLERANCE * max(abs(stated), abs(own)):
                continue
            of = SLOPES[key]
            slope = f"falls by {format_quantity(own, unit, 3)}"
            if own == 0.0:
                slope = "is the same at every temperature"
            effect = abs(stated - own) * _NOTE_DISTANCE / size
            notes.append(
                f"lubricant.{key} is {format_quantity(stated, unit, 3)} at {_celsius(temperature)}, but "
                f"lubricant.{of} {slope}: they fit together at one temperature only, {_NOTE_DISTANCE:g} K from it {of} "
                f"would differ by {effect:.0%}; to have both, give lubricant.{of} as a table over temperature and "
                f"leave out {key}"
            )
        return notes

    def falls(self, T: float) -> tuple[float, float]:
        """Return beta0 [1/K] and gamma [1/(Pa K)] at any temperature `T` [K], without the factors of the oil."""
        eta0, eta0_fall = _evaluate(self.viscosity, T)
        _, alpha_fall = _evaluate(self.pressure_viscosity, T)
        return (
            eta0_fall / eta0 if self.thermoviscosity is None else self.thermoviscosity(T),
            alpha_fall
            if self.pressure_thermoviscosity is None
            else self.pressure_thermoviscosity(T),
        )


def scatter_of(
    viscosity: float,
    grade: str,
    source: str,
    pressure_viscosity: float,
    pressure_viscosity_source: str,
    exponent: float,
) -> tuple[Scatter, ...]:
    """Return the scatter of an oil: of eta0, alpha, the viscosity under pressure, and its shear properties.

    Parameters
    ----------
    viscosity : float
        Relative half width of eta0 [1].
    grade : str
        Letter of `GRADES`, in parentheses, of that width.
    source : str
        Source of that width.
    pressure_viscosity : float
        Relative half width of alpha [1].
    pressure_viscosity_source : str
        Source of that width.
    exponent : float
        Standard deviation of ln(eta/eta0), relative [1]. A width or deviation of 0 is left out.
    """
    rows: list[tuple[str, str, dict[str, object], str, str]] = [
        ("viscosity_factor", "uniform", {"scatter": viscosity}, grade, source),
        ("pressure_viscosity_factor", "uniform", {"scatter": pressure_viscosity}, "(C)", pressure_viscosity_source),
        (
            "pressure_exponent_factor", "lognormal", {"scatter": round(exponent, 3)}, "(C)",
            "laws of pressure against measured viscosities at 0.3 to 0.6 GPa: a factor of 1.6 in mineral oils, of 2.2 "
            "where nothing was measured, one standard deviation",
        ),
        ("eyring_stress", "log-uniform", {"low": "1 MPa", "high": "10 MPa"}, "(D)",
         "range of published traction curves"),
        ("shear_modulus", "log-uniform", {"low": "0.05 GPa", "high": "1 GPa"}, "(C)",
         "range of published values of fluid films"),
    ]  # fmt: skip
    return tuple(
        Scatter(
            quantity=quantity, distribution=shape, parameters=parameters, grade=letter, source=why
        )
        for quantity, shape, parameters, letter, why in rows
        if parameters.get("scatter", 1.0)
    )


def _value(law: float | TemperatureLaw | None, T: float) -> float:
    """Return the value of a law or a constant; nan for a property that the oil lacks."""
    if law is None:
        return math.nan
    return float(law) if isinstance(law, int | float) else law(T)


def _evaluate(law: TemperatureLaw | None, T: float) -> tuple[float, float]:
    """Return the value of a law and its fall per kelvin; nan for a law that the oil lacks."""
    # 0.0 - x, not -x: a constant law falls by 0, not by -0.
    return (math.nan, math.nan) if law is None else (law(T), 0.0 - law.derivative(T))


def _celsius(T: float) -> str:
    return format_quantity(T, "K")
