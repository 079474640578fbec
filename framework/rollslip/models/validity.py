"""Ranges of validity of laws: bounds of quantities, each with the consequence of exceeding it, and shared bounds."""

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import attrs

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    "FILM_REGIMES",
    "ISOTHERMAL",
    "MEAN_PRESSURE",
    "SMOOTH",
    "Tabled",
    "Validity",
    "in_regime",
]


@attrs.frozen(kw_only=True)
class Validity:
    """A bound of the validity of a law: range of a quantity, consequence of leaving it, and remedy.

    Outside the range a law still has a value, with a warning (`rollslip.studies.validity`); outside its domain there is
    an error.

    Examples
    --------
    >>> thin = Validity(quantity="film_parameter", low=3.0, consequence="roughness changes the film by {error}",
    ...                 error=lambda value: 30.0 / value, remedy="measure", source="an example")
    >>> thin.bound, thin.consequence_at(3.0, 1.5)
    ('>= 3', 'roughness changes the film by 10 to 20 %')
    """

    #: Name of the bounded quantity: one of the law's own `SliceModel.quantities`, one of all laws
    #: (`rollslip.bearing.regimes.QUANTITIES`), or a member of the slices, in SI units.
    quantity: str
    #: Lower limit of the range.
    low: float = -math.inf
    #: Upper limit of the range.
    high: float = math.inf
    #: Name of the quantity in sentences, by default its meaning and its symbol.
    quantity_name: str = ""
    #: The range as text, where a number is not informative: "the rigid-isoviscous regime".
    made_for: str = ""
    #: Consequence of leaving the range, a clause; ``{error}`` in it is replaced by a percentage.
    consequence: str
    #: Error in per cent, not negative, at a value outside the range; None where it is unknown.
    error: Callable[[float], float] | None = None
    #: Advice on another law or another value.
    remedy: str
    #: Source of range and consequence.
    source: str
    #: Law to evaluate in place of this one, with a dot the parameter that it is then; empty where it takes minutes.
    replacement: str = ""
    #: Short code that never changes, such as "W11", by which ``rollslip explain`` finds a warning, and users hide it.
    code: str = ""
    #: Whether nearly every bearing leaves the range: a bound of unknown error is then counted, without a warning.
    common: bool = False

    @property
    def bound(self) -> str:
        """The range as text, such as ">= 2 and <= 5"."""
        if self.made_for:
            return self.made_for
        return " and ".join(f"{inside} {limit:.3g}" for inside, _, limit in self.limits)

    @property
    def limits(self) -> tuple[tuple[str, str, float], ...]:
        """Of each finite limit the sign of values inside, the sign of those outside, and the limit."""
        both = ((">=", "<", self.low), ("<=", ">", self.high))
        return tuple(row for row in both if math.isfinite(row[2]))

    def excess(self, values: "NDArray[Any]") -> "NDArray[Any]":
        """Return the distance of values from the range, 0 inside; NaN for unknown values."""
        import numpy as np

        return np.maximum(np.maximum(self.low - values, values - self.high), 0.0)

    def consequence_at(self, *values: float) -> str:
        """Return the consequence, with the smallest and the largest error at values outside the range."""
        if self.error is None:
            return self.consequence
        errors = [self.error(value) for value in values]
        low, high = (
            f"{error:.1g}" if 0.0 < error < 1.0 or error >= 1e4 else f"{error:.0f}"
            for error in (min(errors), max(errors))
        )
        return self.consequence.replace(
            "{error}", f"{high} %" if low == high else f"{low} to {high} %"
        )

    @property
    def consequence_range(self) -> str:
        """The consequence from the limit to three times beyond it, for tables of the catalogue."""
        edge, beyond = (self.high, 3.0) if self.high < math.inf else (self.low, 1.0 / 3.0)
        text = self.consequence_at(edge, edge * beyond)
        return text if self.error is None else f"{text} (at {edge:.3g} to {edge * beyond:.3g})"


@attrs.frozen
class Tabled:
    """Error in per cent over a quantity, by points (value, per cent), linear in ln(value) and constant outside them.

    >>> round(Tabled(((0.1, 90.0), (10.0, 10.0)))(1.0), 6)
    50.0
    """

    points: tuple[tuple[float, float], ...]

    def __call__(self, value: float) -> float:
        """Return the error [%] at a value."""
        import numpy as np

        values, percent = zip(*self.points, strict=True)
        if not value > 0.0:
            return float(percent[0])
        return float(np.interp(math.log(value), np.log(values), percent))


#: Film regime -> its name. Its number, 0 to 3, is its index here.
FILM_REGIMES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "IR": "rigid-isoviscous",
        "VR": "rigid-piezoviscous",
        "IE": "elastic-isoviscous",
        "VE": "elastic-piezoviscous",
    }
)
#: Validity of film models without heating of the inlet.
ISOTHERMAL: Final = Validity(
    code="W01",
    quantity="thermal_load",
    high=0.1,
    consequence="shear heats the inlet and the film is {error} too thick",
    error=lambda load: 100.0 * load**0.62 / 3.94,
    remedy="film 'inlet-correction' with thermal = 'murch-wilson'",
    replacement="inlet-correction.film",
    source="Murch and Wilson (1975), C_T = 3.94/(3.94 + Lt^0.62), for pure rolling (B)",
)
#: Validity of film models without roughness.
SMOOTH: Final = Validity(
    code="W02",
    quantity="film_parameter",
    low=3.0,
    consequence="roughness, which the film model leaves out, changes it",
    remedy="no built-in model covers this; smoother surfaces or a thicker oil avoid it",
    source="Patir and Cheng (1978), by whom roughness matters below Lambda of about 3 (B)",
    common=True,
)
#: Validity of traction laws that take the viscosity at the mean pressure of a contact.
MEAN_PRESSURE: Final = Validity(
    code="W11",
    quantity="pressure_exponent",
    high=1.0,
    consequence="the viscosity at the mean pressure is too low: friction by at most {error} where the oil is Newtonian "
    "(sigma < 0.3) and inelastic, by 4 % and less at sigma > 10 up to an exponent of 6",
    error=Tabled(
        ((1.0, 3.5), (2.0, 12.2), (3.0, 23.1), (4.0, 34.5), (6.0, 54.9), (8.0, 70.3), (12.0, 88.0))
    ),
    remedy="the default law of the full film, which takes the pressures of the contact",
    source="mean of exp(alpha p) over Hertz's ellipse; at large sigma the field (docs/scripts/traction_field_error.py)",
)


def in_regime(name: str, error: tuple[float, float] | None) -> tuple[Validity, ...]:
    """Return the validity of a film formula of one regime; empty for a formula of all regimes.

    Parameters
    ----------
    name : str
        Regime of the formula, one of `FILM_REGIMES`, or "all".
    error : (float, float) or None
        Smallest and largest error in the other regimes [%]; None where it is unknown.
    """
    if name not in FILM_REGIMES:
        return ()
    code = float(list(FILM_REGIMES).index(name))
    deviation = "may be far off"
    source = "what regime a contact is in: Johnson (1970), the law's own word for the rest"
    if error is not None:
        low = math.floor(error[0])
        high = math.ceil(error[1])
        deviation = f"errs by {low:+d} to {high:+d} % there, over M of 0.1 to 200 and L of 0 to 15"
        source = "reynolds-line: docs/scripts/film_error_map.py"
    remedy = "film 'moes', which covers all regimes"
    return (
        Validity(
            code="W09",
            quantity="film_regime",
            low=code,
            high=code,
            made_for=f"the {FILM_REGIMES[name]} regime",
            consequence=f"its film {deviation}",
            remedy=remedy,
            replacement=remedy.split("'")[1],
            source=source,
        ),
    )
