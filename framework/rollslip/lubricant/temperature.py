"""Laws of a property of an oil over temperature: formulas and tables, each with its derivative.

- A temperature law is a formula, not an oil: Walther's describes MIL-L-7808 and Santotrac 50, Andrade's MIL-L-23699 and
  SAE 30.
- Every law has its analytic derivative: beta0 and gamma are derivatives, and they are part of the exponent of film
  heating, where a difference quotient would lose digits.
- The laws use ``math`` and not NumPy, because an oil is evaluated once per inlet temperature, not for each slice.
"""

import math
from bisect import bisect_right
from itertools import pairwise
from typing import Protocol

from attrs import frozen

__all__ = [
    "Andrade",
    "Constant",
    "Exponential",
    "Hyperbola",
    "PowerOfViscosity",
    "Product",
    "SmoothTable",
    "Table",
    "TemperatureLaw",
    "Vogel",
    "Walther",
    "WuKlausDuda",
]


class TemperatureLaw(Protocol):
    """A property of an oil as a function of temperature."""

    def __call__(self, T: float) -> float:
        """Property at the temperature `T` [K]."""

    def derivative(self, T: float) -> float:
        """Slope of the property, its unit per kelvin, at the temperature `T` [K]."""


@frozen
class Constant:
    """A property that does not depend on temperature."""

    value: float  #: The property, SI.

    def __call__(self, T: float) -> float:
        """Property at the temperature `T` [K]."""
        return self.value

    def derivative(self, T: float) -> float:
        """Zero, at any temperature `T` [K]."""
        return 0.0


@frozen
class Table:
    """Linear interpolation between tabulated values; outside the table the property has its end value.

    Raises
    ------
    ValueError
        The temperatures do not rise, or their number differs from that of the values.
    """

    temperatures: tuple[float, ...]  #: Rising temperatures [K], two or more.
    values: tuple[float, ...]  #: The property at each, SI.

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
        """Slope of the segment that contains `T` [K], of the upper one at a node; zero outside the table."""
        return (
            self._slope(self._segment(T))
            if self.temperatures[0] <= T < self.temperatures[-1]
            else 0.0
        )

    def _segment(self, T: float) -> int:
        return min(max(bisect_right(self.temperatures, T) - 1, 0), len(self.temperatures) - 2)

    def _slope(self, i: int) -> float:
        return (self.values[i + 1] - self.values[i]) / (
            self.temperatures[i + 1] - self.temperatures[i]
        )


@frozen
class SmoothTable:
    """Positive tabulated values with a smooth curve between them, which is monotone where the values are.

    ln(value) is a piecewise cubic in T (cubic Hermite interpolation) with the slopes of Fritsch and Butland: between
    rising or falling values it does not oscillate, and its slope, from which beta0 and gamma follow, is continuous. Two
    values are joined by an exponential. Outside the table the curve is an exponential with the slope at its end.

    Error against the law behind the values, for MIL-PRF-7808 at 30, 40, 50, 70 and 100 degC: viscosity 0.32 %, alpha
    0.08 %, beta0 1.9 % and gamma 1.5 % from 40 to 70 degC, 5 and 3.5 % towards the ends
    (``tests/lubricant/test_tables.py``).

    References
    ----------
    Fritsch F.N., Butland J. A method for constructing local monotone piecewise cubic interpolants. SIAM J. Sci. Stat.
    Comput. 5, 1984, 300-304.
    """

    temperatures: tuple[float, ...]  #: Rising temperatures [K], two or more.
    values: tuple[float, ...]  #: The property at each, positive, SI.

    def __attrs_post_init__(self) -> None:
        Table(self.temperatures, self.values)  # its rules hold here too
        if not all(0.0 < value < math.inf for value in self.values):
            raise ValueError("the values of a smooth table must be positive")

    def __call__(self, T: float) -> float:
        """Property at the temperature `T` [K]."""
        return math.exp(self._log(T)[0])

    def derivative(self, T: float) -> float:
        """Slope of the property at the temperature `T` [K]."""
        log, slope = self._log(T)
        return math.exp(log) * slope

    def _log(self, T: float) -> tuple[float, float]:
        """ln(value) and its slope."""
        x = self.temperatures
        for end in (0, -1):
            beyond = T - x[end]
            if beyond * (0.5 + end) < 0.0:  # below the first, above the last
                slope = self._slope(end % len(x))
                return math.log(self.values[end]) + slope * beyond, slope
        i = min(bisect_right(x, T) - 1, len(x) - 2)
        width = x[i + 1] - x[i]
        t = (T - x[i]) / width
        secant = self._secant(i)
        first = self._slope(i) - secant
        last = self._slope(i + 1) - secant
        bend = t * (1.0 - t) * (first * (1.0 - t) - last * t)
        slope = secant + first * (1.0 - t) * (1.0 - 3.0 * t) + last * t * (3.0 * t - 2.0)
        return math.log(self.values[i]) + width * (secant * t + bend), slope

    def _secant(self, i: int) -> float:
        return math.log(self.values[i + 1] / self.values[i]) / (
            self.temperatures[i + 1] - self.temperatures[i]
        )

    def _slope(self, i: int) -> float:
        """Slope of ln(value) at a node: a weighted harmonic mean of both secants, of three points at an end."""
        last = len(self.values) - 1
        if last == 1:
            return self._secant(0)
        if 0 < i < last:
            left = self._secant(i - 1)
            right = self._secant(i)
            if left * right <= 0.0:
                return 0.0
            below = self.temperatures[i] - self.temperatures[i - 1]
            above = self.temperatures[i + 1] - self.temperatures[i]
            return (
                3.0
                * (below + above)
                / ((2.0 * above + below) / left + (above + 2.0 * below) / right)
            )
        near, far = (0, 1) if i == 0 else (last - 1, last - 2)
        width, next_width = (self.temperatures[k + 1] - self.temperatures[k] for k in (near, far))
        secant = self._secant(near)
        slope = secant + (secant - self._secant(far)) * width / (width + next_width)
        if slope * secant <= 0.0:
            return 0.0
        return math.copysign(min(abs(slope), 3.0 * abs(secant)), secant)


@frozen
class Product:
    """Product of two laws, as dynamic viscosity is of kinematic viscosity and density."""

    first: TemperatureLaw  #: First factor.
    second: TemperatureLaw  #: Second factor.

    def __call__(self, T: float) -> float:
        """Product at the temperature `T` [K]."""
        return self.first(T) * self.second(T)

    def derivative(self, T: float) -> float:
        """Slope of the product at the temperature `T` [K]."""
        return self.first.derivative(T) * self.second(T) + self.first(T) * self.second.derivative(T)


@frozen
class Walther:
    """Viscosity after Walther (1931), the double-exponential law of ASTM D341.

    log10 log10(nu + c) = A - B log10 T,  eta = k nu,

    where nu is the kinematic viscosity in mm2/s and k = 1e-6 m2/s times the density; fits made straight to the dynamic
    viscosity carry their own k. Constants published in natural logarithms, ln ln(nu + c) = a - B ln T, are the same
    law with A = (a - ln ln 10) / ln 10. ASTM D341 takes c = 0.7, for nu above 2 mm2/s.

    References
    ----------
    ASTM D341, Standard Practice for Viscosity-Temperature Equations and Charts for Liquid Petroleum or Hydrocarbon
    Products.
    """

    intercept: float  #: A [-].
    slope: float  #: B [-].
    constant: float  #: c [-], in mm2/s where k comes from a density.
    scale: float  #: k [Pa s].

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
    """

    limit: float  #: A [Pa s], approached at high temperature.
    slope: float  #: B [K].
    pole: float  #: C [K], where the viscosity would grow without bound.

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
    """

    reference_viscosity: float  #: eta_ref [Pa s].
    reference_temperature: float  #: T_ref [K].
    slope: float  #: b [K].
    curvature: float = 0.0  #: c [K2]; zero is Andrade's own law.

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
    """Pressure-viscosity coefficient as a hyperbola, alpha = a + b / (T - c), T > c."""

    limit: float  #: a [1/Pa], approached at high temperature.
    slope: float  #: b [K/Pa].
    pole: float  #: c [K].

    def __call__(self, T: float) -> float:
        """Pressure-viscosity coefficient [1/Pa] at the temperature `T` [K]."""
        return self.limit + self.slope / (T - self.pole)

    def derivative(self, T: float) -> float:
        """Slope of the coefficient [1/(Pa K)] at the temperature `T` [K]."""
        return -self.slope / (T - self.pole) ** 2


@frozen
class Exponential:
    """Pressure-viscosity coefficient as an exponential, alpha = alpha_ref exp(-k (T - T_ref))."""

    reference_value: float  #: alpha_ref [1/Pa].
    reference_temperature: float  #: T_ref [K].
    rate: float  #: k [1/K].

    def __call__(self, T: float) -> float:
        """Pressure-viscosity coefficient [1/Pa] at the temperature `T` [K]."""
        return self.reference_value * math.exp(-self.rate * (T - self.reference_temperature))

    def derivative(self, T: float) -> float:
        """Slope of the coefficient [1/(Pa K)] at the temperature `T` [K]."""
        return -self.rate * self(T)


@frozen
class PowerOfViscosity:
    """Pressure-viscosity coefficient tied to the viscosity, alpha = k eta^m with eta in Pa s."""

    viscosity: TemperatureLaw  #: eta(T).
    factor: float  #: k [1/Pa], alpha at 1 Pa s.
    exponent: float  #: m [-].

    def __call__(self, T: float) -> float:
        """Pressure-viscosity coefficient [1/Pa] at the temperature `T` [K]."""
        return self.factor * math.pow(self.viscosity(T), self.exponent)

    def derivative(self, T: float) -> float:
        """Slope of the coefficient [1/(Pa K)] at the temperature `T` [K]."""
        return self.exponent * self(T) * self.viscosity.derivative(T) / self.viscosity(T)


@frozen
class WuKlausDuda:
    """Pressure-viscosity coefficient of an oil from its kinematic viscosity, after Wu, Klaus and Duda.

    alpha = (0.1657 + 0.2332 log10 nu) m,  alpha in 1e-8/Pa, nu in mm2/s,

    where m is the slope of Walther's law of ASTM D341. Range: nu above 0.2 mm2/s, where alpha is positive. Against FVA
    3 as measured it is 4 to 12 % low (one oil); correlations of this sort differ by 25 % among themselves.

    References
    ----------
    Wu C.S., Klaus E.E., Duda J.L. Development of a method for the prediction of pressure-viscosity coefficients of
    lubricating oils based on free-volume theory. J. Tribol. 111, 1989, 121-128.
    """

    kinematic: Walther  #: Kinematic viscosity nu(T) [m2/s]: its scale is 1e-6.

    def __call__(self, T: float) -> float:
        """Pressure-viscosity coefficient [1/Pa] at the temperature `T` [K]."""
        return 1e-8 * self.kinematic.slope * (0.1657 + 0.2332 * math.log10(1e6 * self.kinematic(T)))

    def derivative(self, T: float) -> float:
        """Slope of the coefficient [1/(Pa K)] at the temperature `T` [K]."""
        relative = self.kinematic.derivative(T) / self.kinematic(T)
        return 1e-8 * self.kinematic.slope * 0.2332 / math.log(10.0) * relative
