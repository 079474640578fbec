"""Lubricants: what an oil is, how its properties follow temperature, and how a scene's own oil is made.

The design, and why:

- A temperature law is a *form*, not an oil: Walther serves MIL-L-7808 and Santotrac 50, Andrade MIL-L-23699 and SAE 30.
- Every law brings its analytic derivative: the thermoviscosity beta0 and gamma are derivatives, and they stand in
  the exponent of the film heating, where a difference quotient would cost digits.
- What an oil lacks is ``None`` in `Lubricant` and nan in `OilState`: a model that reads it cannot be bound to the oil.
- Plain ``math``: an oil is evaluated once per inlet temperature, never inside a loop over slices.
"""

import math
from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Any, Protocol

from attrs import NOTHING, Factory, asdict, evolve, fields_dict, frozen
from attrs import field as attrib
from attrs.validators import optional

from rollslip.errors import DomainError, SceneError
from rollslip.fields import FieldError, field, one_of, positive
from rollslip.lubricant.pressure import Barus, PressureViscosity, Roelands, Yasutomi
from rollslip.structure import FrozenTable, Where, structure
from rollslip.units import format_quantity

_MARGIN = 20.0  # K, by which the validity of a fitted law reaches beyond its points
_LOWEST_POLE = -1000.0  # K; with C below it Vogel's law is an exponential in T, and A and B lose their digits


class TemperatureLaw(Protocol):
    """A property of an oil as a function of temperature."""

    def __call__(self, T: float) -> float:
        """Property at the temperature `T` [K]."""

    def derivative(self, T: float) -> float:
        """Slope of the property, its unit per kelvin, at the temperature `T` [K]."""


@frozen
class Constant:
    """A property that does not depend on temperature.

    Parameters
    ----------
    value : float
        The property, SI.
    """

    value: float

    def __call__(self, T: float) -> float:
        """Property at the temperature `T` [K]."""
        return self.value

    def derivative(self, T: float) -> float:
        """Zero, at any temperature `T` [K]."""
        return 0.0


@frozen
class Table:
    """Linear interpolation between tabulated values; beyond the table its end value holds.

    Parameters
    ----------
    temperatures : tuple of float
        Rising temperatures [K], two or more.
    values : tuple of float
        The property at each, SI.

    Raises
    ------
    ValueError
        The temperatures do not rise, or their number differs from that of the values.
    """

    temperatures: tuple[float, ...]
    values: tuple[float, ...]

    def __attrs_post_init__(self) -> None:
        if not len(self.temperatures) == len(self.values) >= 2:
            raise ValueError("a table needs two or more temperatures and one value for each")
        if any(low >= high for low, high in pairwise(self.temperatures)):
            raise ValueError("the temperatures of a table must rise")

    def __call__(self, T: float) -> float:
        """Property at the temperature `T` [K]."""
        i = self._segment(T)
        T = min(max(T, self.temperatures[0]), self.temperatures[-1])
        return self.values[i] + self._slope(i) * (T - self.temperatures[i])

    def derivative(self, T: float) -> float:
        """Slope of the segment that holds `T` [K], of the upper one at a node; zero beyond the table."""
        return self._slope(self._segment(T)) if self.temperatures[0] <= T < self.temperatures[-1] else 0.0

    def _segment(self, T: float) -> int:
        return min(max(bisect_right(self.temperatures, T) - 1, 0), len(self.temperatures) - 2)

    def _slope(self, i: int) -> float:
        return (self.values[i + 1] - self.values[i]) / (self.temperatures[i + 1] - self.temperatures[i])


@frozen
class Walther:
    """Viscosity after Walther (1931), the double-exponential law of ASTM D341.

    log10 log10(nu + c) = A - B log10 T,  eta = k nu,

    where nu is the kinematic viscosity in mm2/s and k = 1e-6 m2/s times the density; fits made straight to the dynamic
    viscosity carry their own k. Constants published in natural logarithms, ln ln(nu + c) = a - B ln T, are the same
    law with A = (a - ln ln 10) / ln 10. ASTM D341 takes c = 0.7, for nu above 2 mm2/s.

    Parameters
    ----------
    intercept : float
        A [-].
    slope : float
        B [-].
    constant : float
        c [-], in mm2/s where k comes from a density.
    scale : float
        k [Pa s].

    References
    ----------
    ASTM D341, Standard Practice for Viscosity-Temperature Equations and Charts for Liquid Petroleum or Hydrocarbon
    Products.
    """

    intercept: float
    slope: float
    constant: float
    scale: float

    def __call__(self, T: float) -> float:
        """Dynamic viscosity [Pa s] at the temperature `T` [K]."""
        return self.scale * (math.pow(10.0, self._log(T)) - self.constant)

    def derivative(self, T: float) -> float:
        """Slope of the dynamic viscosity [Pa s/K] at the temperature `T` [K]."""
        log = self._log(T)
        return -self.scale * math.pow(10.0, log) * math.log(10.0) * log * self.slope / T

    def _log(self, T: float) -> float:
        """log10(nu + c)."""
        return math.pow(10.0, self.intercept - self.slope * math.log10(T))


@frozen
class Vogel:
    """Viscosity after Vogel (1921), Fulcher and Tammann.

    eta = A exp(B / (T - C)),  T > C.

    Parameters
    ----------
    limit : float
        A [Pa s], approached at high temperature.
    slope : float
        B [K].
    pole : float
        C [K], where the viscosity would grow without bound.
    """

    limit: float
    slope: float
    pole: float

    def __call__(self, T: float) -> float:
        """Dynamic viscosity [Pa s] at the temperature `T` [K]."""
        return self.limit * math.exp(self.slope / (T - self.pole))

    def derivative(self, T: float) -> float:
        """Slope of the dynamic viscosity [Pa s/K] at the temperature `T` [K]."""
        return -self(T) * self.slope / (T - self.pole) ** 2


@frozen
class Andrade:
    """Viscosity after Andrade (1930), with an optional quadratic term.

    eta = eta_ref exp(b d + c d^2),  d = 1/T - 1/T_ref.

    Parameters
    ----------
    reference_viscosity : float
        eta_ref [Pa s].
    reference_temperature : float
        T_ref [K].
    slope : float
        b [K].
    curvature : float
        c [K2]; zero is Andrade's own law.
    """

    reference_viscosity: float
    reference_temperature: float
    slope: float
    curvature: float = 0.0

    def __call__(self, T: float) -> float:
        """Dynamic viscosity [Pa s] at the temperature `T` [K]."""
        d = self._distance(T)
        return self.reference_viscosity * math.exp((self.slope + self.curvature * d) * d)

    def derivative(self, T: float) -> float:
        """Slope of the dynamic viscosity [Pa s/K] at the temperature `T` [K]."""
        return -self(T) * (self.slope + 2.0 * self.curvature * self._distance(T)) / T**2

    def _distance(self, T: float) -> float:
        return (self.reference_temperature - T) / (self.reference_temperature * T)


@frozen
class Hyperbola:
    """Pressure-viscosity coefficient as a hyperbola, alpha = a + b / (T - c), T > c.

    Parameters
    ----------
    limit : float
        a [1/Pa], approached at high temperature.
    slope : float
        b [K/Pa].
    pole : float
        c [K].
    """

    limit: float
    slope: float
    pole: float

    def __call__(self, T: float) -> float:
        """Pressure-viscosity coefficient [1/Pa] at the temperature `T` [K]."""
        return self.limit + self.slope / (T - self.pole)

    def derivative(self, T: float) -> float:
        """Slope of the coefficient [1/(Pa K)] at the temperature `T` [K]."""
        return -self.slope / (T - self.pole) ** 2


@frozen
class Exponential:
    """Pressure-viscosity coefficient as an exponential, alpha = alpha_ref exp(-k (T - T_ref)).

    Parameters
    ----------
    reference_value : float
        alpha_ref [1/Pa].
    reference_temperature : float
        T_ref [K].
    rate : float
        k [1/K].
    """

    reference_value: float
    reference_temperature: float
    rate: float

    def __call__(self, T: float) -> float:
        """Pressure-viscosity coefficient [1/Pa] at the temperature `T` [K]."""
        return self.reference_value * math.exp(-self.rate * (T - self.reference_temperature))

    def derivative(self, T: float) -> float:
        """Slope of the coefficient [1/(Pa K)] at the temperature `T` [K]."""
        return -self.rate * self(T)


@frozen
class PowerOfViscosity:
    """Pressure-viscosity coefficient tied to the viscosity, alpha = k eta^m with eta in Pa s.

    Parameters
    ----------
    viscosity : TemperatureLaw
        eta(T).
    factor : float
        k [1/Pa], alpha at 1 Pa s.
    exponent : float
        m [-].
    """

    viscosity: TemperatureLaw
    factor: float
    exponent: float

    def __call__(self, T: float) -> float:
        """Pressure-viscosity coefficient [1/Pa] at the temperature `T` [K]."""
        return self.factor * math.pow(self.viscosity(T), self.exponent)

    def derivative(self, T: float) -> float:
        """Slope of the coefficient [1/(Pa K)] at the temperature `T` [K]."""
        return self.exponent * self(T) * self.viscosity.derivative(T) / self.viscosity(T)


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


def _positive(unit: str, doc: str, default: object = NOTHING) -> Any:
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
    references : tuple of str
        Keys of the bibliography.
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
    eyring_stress: float | None = _positive("Pa", "Eyring stress", None)
    shear_modulus: float | None = _positive("Pa", "shear modulus", None)
    minimum_temperature: float = _positive("K", "lowest temperature at which the data hold")
    maximum_temperature: float = _positive("K", "highest temperature at which the data hold")
    source: str
    references: tuple[str, ...] = ()
    viscosity_factor: float = _positive("1", "factor on the viscosity", 1.0)
    pressure_viscosity_factor: float = _positive("1", "factor on the pressure-viscosity coefficient", 1.0)
    pressure_thermoviscosity_factor: float = _positive("1", "factor on the slope of that coefficient", 1.0)
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
                "narrow the range",
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


def fit_walther(
    temperatures: Sequence[float], viscosities: Sequence[float], density: float, constant: float = 0.7
) -> Walther:
    """Walther's law through measured kinematic viscosities.

    Exact through two points; through more, the straight line of least squares on the axes of ASTM D341,
    log10 log10(nu + c) against log10 T.

    Parameters
    ----------
    temperatures : sequence of float
        T [K], two or more, all different.
    viscosities : sequence of float
        Kinematic viscosity [m2/s] at each.
    density : float
        From kinematic to dynamic viscosity [kg/m3], taken as constant.
    constant : float
        c [mm2/s], 0.7 in ASTM D341.

    Returns
    -------
    Walther

    Raises
    ------
    ValueError
        Too few points, equal temperatures, a viscosity that is not positive, too small for the law (nu + c must exceed
        1 mm2/s) or does not fall with temperature.

    Examples
    --------
    >>> oil = fit_walther([313.15, 373.15], [32e-6, 5.4e-6], density=870.0)
    >>> round(oil(313.15) / 870.0 * 1e6, 9)
    32.0
    """
    T, nu = _ordered("walther", 2, temperatures, viscosities)
    if 1e6 * nu[-1] + constant <= 1.0:
        raise ValueError(
            f"Walther's law with the constant {constant:g} has no value for viscosities down to "
            f"{1e6 * nu[-1]:g} mm2/s, only above {1.0 - constant:g} mm2/s"
        )
    slope, intercept, _ = _line([math.log10(t) for t in T], [math.log10(math.log10(1e6 * v + constant)) for v in nu])
    return Walther(intercept, -slope, constant, 1e-6 * density)


def fit_vogel(temperatures: Sequence[float], viscosities: Sequence[float]) -> Vogel:
    """Vogel's law through measured dynamic viscosities.

    Exact through three points; through more, least squares in ln(eta), that is in relative error.

    Parameters
    ----------
    temperatures : sequence of float
        T [K], three or more, all different.
    viscosities : sequence of float
        Dynamic viscosity [Pa s] at each.

    Returns
    -------
    Vogel

    Raises
    ------
    ValueError
        Too few points, equal temperatures, a viscosity that is not positive or does not fall with temperature, or
        points that bend less than any liquid's do: their C would lie below -1000 K.

    Examples
    --------
    >>> oil = fit_vogel([313.15, 343.15, 373.15], [0.030, 0.0095, 0.0045])
    >>> round(oil(343.15), 9)
    0.0095
    """
    T, eta = _ordered("vogel", 3, temperatures, viscosities)
    log_eta = [math.log(v) for v in eta]
    pole = _pole(T, log_eta)
    if len(T) > 3:
        from scipy.optimize import least_squares

        # For a given C the law is a line in 1/(T - C), so C alone is searched, as ln(T_min - C) to keep it below T_min.
        def misfit(log_distance: Any) -> list[float]:
            return _line(_reciprocal(T, T[0] - math.exp(log_distance[0])), log_eta)[2]

        start = math.log(T[0] - min(max(pole, _LOWEST_POLE), T[0] - 2.0))
        bounds = (0.0, math.log(T[0] - 2.0 * _LOWEST_POLE))  # the lower one: C stays 1 K away from the points
        pole = T[0] - math.exp(least_squares(misfit, [start], bounds=bounds, xtol=1e-12, ftol=1e-12, gtol=1e-12).x[0])
    if pole < _LOWEST_POLE:
        raise ValueError("no Vogel law: the slope of ln(viscosity) hardly flattens with temperature; check the points")
    slope, intercept, _ = _line(_reciprocal(T, pole), log_eta)
    return Vogel(math.exp(intercept), slope, pole)


def _pole(T: list[float], log_eta: list[float]) -> float:
    """C of the Vogel law through the first, the middle and the last of the points; -inf if they do not bend as it."""
    (T1, T2, T3), (y1, y2, y3) = ((v[0], v[len(v) // 2], v[-1]) for v in (T, log_eta))
    bend = (y1 - y2) * (T3 - T2) / ((y2 - y3) * (T2 - T1))  # = (T3 - C)/(T1 - C)
    return T1 - (T3 - T1) / (bend - 1.0) if bend > 1.0 else -math.inf


def _reciprocal(T: list[float], pole: float) -> list[float]:
    return [1.0 / (t - pole) for t in T]


def _line(x: list[float], y: list[float]) -> tuple[float, float, list[float]]:
    """Slope, intercept and residuals of the straight line of least squares."""
    x_mean, y_mean = math.fsum(x) / len(x), math.fsum(y) / len(y)
    slope = math.fsum((a - x_mean) * (b - y_mean) for a, b in zip(x, y, strict=True)) / math.fsum(
        (a - x_mean) ** 2 for a in x
    )
    return slope, y_mean - slope * x_mean, [b - y_mean - slope * (a - x_mean) for a, b in zip(x, y, strict=True)]


def _ordered(
    law: str, fewest: int, temperatures: Sequence[float], viscosities: Sequence[float]
) -> tuple[list[float], list[float]]:
    """Points of a fit in the order of temperature, checked."""
    if len(temperatures) != len(viscosities):
        raise ValueError(f"{len(temperatures)} temperatures but {len(viscosities)} viscosities")
    if len(temperatures) < fewest:
        raise ValueError(f"the {law} law needs {fewest} or more points, got {len(temperatures)}")
    points = sorted((float(T), float(v)) for T, v in zip(temperatures, viscosities, strict=True))
    for T, v in points:
        if not (0.0 < T < math.inf and 0.0 < v < math.inf):
            raise ValueError(f"temperature and viscosity must be positive, got {v:g} at {T:g} K")
    for (T1, v1), (T2, v2) in pairwise(points):
        if T1 == T2:
            raise ValueError(f"two points at {_celsius(T1)}: give each temperature once")
        if v1 <= v2:
            raise ValueError(f"the viscosity does not fall from {_celsius(T1)} to {_celsius(T2)}")
    return [T for T, _ in points], [v for _, v in points]


@frozen(kw_only=True)
class OilPoint:
    """A measured viscosity of an own oil."""

    temperature: float = _positive("K", "temperature")
    viscosity: float | None = _positive("Pa s", "dynamic viscosity", None)
    kinematic_viscosity: float | None = _positive("m2/s", "kinematic viscosity", None)

    def __attrs_post_init__(self) -> None:
        if (self.viscosity is None) == (self.kinematic_viscosity is None):
            raise FieldError("viscosity", "give either viscosity or kinematic_viscosity")


@frozen(kw_only=True)
class OilTable:
    """The ``[lubricant]`` table of a scene as written: what it leaves out is None; see `lubricant_from_table`."""

    name: str | None = field(default=None, doc="a shipped oil, whose data the other keys override")
    description: str | None = field(default=None, doc="what the oil is")
    source: str | None = field(default=None, doc="where the data of this table come from")
    viscosity_law: str | None = field(
        default=None, doc="law through the points", validator=optional(one_of("walther", "vogel"))
    )
    points: tuple[OilPoint, ...] = field(default=(), doc="measured viscosities")
    density: float | None = _positive("kg/m3", "density, between kinematic and dynamic viscosity", None)
    pressure_viscosity: float | None = _positive("1/Pa", "pressure-viscosity coefficient, constant", None)
    pressure_viscosity_law: str | None = field(
        default=None,
        doc="how viscosity rises with pressure",
        validator=optional(one_of("barus", "roelands", "yasutomi")),
    )
    yasutomi: Yasutomi | None = field(default=None, doc="constants of Yasutomi's law")
    conductivity: float | None = _positive("W/(m K)", "thermal conductivity, constant", None)
    eyring_stress: float | None = _positive("Pa", "Eyring stress", None)
    shear_modulus: float | None = _positive("Pa", "shear modulus", None)
    minimum_temperature: float | None = _positive("K", "lowest temperature at which the data hold", None)
    maximum_temperature: float | None = _positive("K", "highest temperature at which the data hold", None)
    viscosity_factor: float | None = _positive("1", "factor on the viscosity", None)
    pressure_viscosity_factor: float | None = _positive("1", "factor on the pressure-viscosity coefficient", None)
    pressure_thermoviscosity_factor: float | None = _positive("1", "factor on the slope of that coefficient", None)

    def __attrs_post_init__(self) -> None:
        if self.name is None and not self.points:
            raise FieldError("name", "missing; name a shipped oil, or give viscosity_law and points of your own")
        if self.points and self.viscosity_law is None:
            raise FieldError("viscosity_law", "missing; the points need 'walther' or 'vogel'")
        if not self.points and (self.viscosity_law or self.density):
            raise FieldError("points", "missing; viscosity_law and density serve to fit them")
        kinematic = any(point.viscosity is None for point in self.points)
        if self.density is None and (kinematic or self.viscosity_law == "walther"):
            raise FieldError("density", "missing; it stands between kinematic and dynamic viscosity")
        if (self.yasutomi is None) == (self.pressure_viscosity_law == "yasutomi"):
            raise FieldError("yasutomi", "the constants and pressure_viscosity_law = 'yasutomi' need each other")
        if self.yasutomi is not None and self.pressure_viscosity is not None:
            raise FieldError("pressure_viscosity", "not with Yasutomi's law, which fixes it; leave it out")

    @property
    def law(self) -> PressureViscosity | None:
        """Law of viscosity with pressure, None if the table says nothing of it."""
        return self.yasutomi or {"barus": Barus(), "roelands": Roelands()}.get(self.pressure_viscosity_law or "")

    def fit(self) -> TemperatureLaw:
        """Viscosity law through the points."""
        T = [point.temperature for point in self.points]
        density = self.density or math.nan  # only read where it must be given
        eta = [point.viscosity or density * (point.kinematic_viscosity or math.nan) for point in self.points]
        return (
            fit_vogel(T, eta) if self.viscosity_law == "vogel" else fit_walther(T, [v / density for v in eta], density)
        )


_WHERE = Where({}, ("lubricant",))


def lubricant_from_table(
    data: Mapping[str, object], get_named: Callable[[str], Lubricant], where: Where = _WHERE
) -> Lubricant:
    """Make the oil that the ``[lubricant]`` table of a scene describes.

    With ``name`` every other key overrides that shipped oil; without it the table describes an own oil, and what it
    does not give, that oil lacks. ``viscosity_law`` goes through ``points``, each with a ``temperature`` and either a
    ``viscosity`` or a ``kinematic_viscosity``. The fit holds over the span of the points and 20 K beyond, within the
    range of the named oil, unless ``minimum_temperature`` or ``maximum_temperature`` say otherwise.
    ``pressure_viscosity`` is constant, so that gamma is zero. The factors are those of `Lubricant`.

    Parameters
    ----------
    data : mapping
        The table as written: numbers in SI, or strings with a unit; its keys are the fields of `OilTable`.
    get_named : callable
        Returns the shipped oil of a name; what it raises for an unknown one is passed on.
    where : Where
        Place of the table, for messages; with the origins of a scene they name file and line.

    Returns
    -------
    Lubricant
        Its `source` ends with the keys that the scene has set.

    Raises
    ------
    SceneError
        With the problems of the table, each as ``lubricant.KEY: sentence``.

    Examples
    --------
    >>> measured = [
    ...     {"temperature": "40 degC", "kinematic_viscosity": "14 mm2/s"},
    ...     {"temperature": "100 degC", "kinematic_viscosity": "3.4 mm2/s"},
    ... ]
    >>> own = {"viscosity_law": "walther", "density": "950 kg/m3", "points": measured}
    >>> round(lubricant_from_table(own, get_named={}.__getitem__).at(313.15).viscosity, 9)
    0.0133
    """
    problems: list[str] = []
    table = structure(OilTable, data, where, problems)
    if table is None:
        raise SceneError(problems)

    given = {key: value for key, value in asdict(table, recurse=False).items() if value not in (None, ())}
    changes = {key: value for key, value in given.items() if key in fields_dict(Lubricant)}
    if table.law is not None:
        changes["pressure_viscosity_law"] = table.law
    changes |= {key: Constant(given[key]) for key in ("pressure_viscosity", "conductivity") if key in given}
    base = None if table.name is None else get_named(table.name)
    set_here = ", ".join(key for key in given if key not in ("name", "description", "source"))
    origins = (base.source if base else None, table.source, set_here and f"Set by the scene: {set_here}.")
    changes["source"] = " ".join(filter(None, origins))
    try:
        if table.points:
            T = [point.temperature for point in table.points]
            low, high = (0.0, math.inf) if base is None else (base.minimum_temperature, base.maximum_temperature)
            changes = {
                "viscosity": table.fit(),
                "minimum_temperature": max(low, min(T) - _MARGIN),
                "maximum_temperature": min(high, max(T) + _MARGIN),
            } | changes
        return (
            Lubricant(**{"name": "own oil", "description": "", **changes}) if base is None else evolve(base, **changes)
        )
    except FieldError as error:
        raise SceneError([where.at(error.field).says(error.reason)]) from error
    except ValueError as error:  # from a fit
        raise SceneError([where.at("points").says(str(error))]) from error
