"""What a law was made for: bounds of quantities, each with what it costs to leave it, and those that laws share."""

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import attrs

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["FILM_REGIMES", "ISOTHERMAL", "SMOOTH", "Tabled", "Validity", "in_regime"]


@attrs.frozen(kw_only=True)
class Validity:
    """One thing that a law was made for: a bound of a quantity, and what it costs to leave it.

    Outside of it there is a number and a warning (`rollslip.studies.validity`), outside of the domain an error.

    Examples
    --------
    >>> thin = Validity(quantity="film_parameter", low=3.0, consequence="roughness changes the film by {error}",
    ...                 error=lambda value: 30.0 / value, remedy="measure", source="an example")
    >>> thin.bound, thin.consequence_at(3.0, 1.5)
    ('>= 3', 'roughness changes the film by 10 to 20 %')
    """

    #: What is bounded: one of the law's own `SliceModel.quantities`, one that all laws know
    #: (`rollslip.bearing.regimes.QUANTITIES`), or a member of the slices, in SI units.
    quantity: str
    #: low, high: Least and largest value that the law was made for.
    low: float = -math.inf
    high: float = math.inf
    called: str = (
        ""  #: What the quantity is called in sentences, by default its name and its symbol.
    )
    made_for: str = (
        ""  #: The bound in words, where a number says little: "the rigid-isoviscous regime".
    )
    consequence: str  #: What is so outside, a clause; ``{error}`` in it stands for per cent.
    #: Per cent, not negative, at a value of the quantity outside; None where nobody knows it.
    error: Callable[[float], float] | None = None
    remedy: str  #: What to take or to do instead.
    source: str  #: What bound and consequence rest on.
    #: The law to evaluate in its place, with a dot the parameter that it is then; empty where that takes minutes.
    instead: str = ""
    #: Short and the same for ever, such as "W11": by it a note is looked up (``rollslip explain``) and left out.
    code: str = ""
    #: Whether nearly every bearing leaves it: while its error is not known it is counted, and no warning of its own.
    common: bool = False

    @property
    def bound(self) -> str:
        """The bound, in words or as in ">= 2 and <= 5"."""
        if self.made_for:
            return self.made_for
        ends = (
            f">= {self.low:.3g}" if self.low > -math.inf else "",
            f"<= {self.high:.3g}" if self.high < math.inf else "",
        )
        return " and ".join(filter(None, ends))

    def excess(self, values: "NDArray[Any]") -> "NDArray[Any]":
        """Return how far values lie outside, 0 inside; NaN for what is not known."""
        import numpy as np

        return np.maximum(np.maximum(self.low - values, values - self.high), 0.0)

    def consequence_at(self, *values: float) -> str:
        """Return the consequence, with the error that it has at values outside, from the least to the largest."""
        if self.error is None:
            return self.consequence
        errors = [self.error(value) for value in values]
        ends = min(errors), max(errors)
        low, high = (
            f"{end:.1g}" if 0.0 < end < 1.0 or end >= 1e4 else f"{end:.0f}" for end in ends
        )
        return self.consequence.replace(
            "{error}", f"{high} %" if low == high else f"{low} to {high} %"
        )

    @property
    def told(self) -> str:
        """The consequence from the bound to three times beyond it, for tables of the catalogue."""
        edge, beyond = (self.high, 3.0) if self.high < math.inf else (self.low, 1.0 / 3.0)
        text = self.consequence_at(edge, edge * beyond)
        return text if self.error is None else f"{text} (at {edge:.3g} to {edge * beyond:.3g})"


@attrs.frozen
class Tabled:
    """Per cent over a quantity by points that rise, (value, per cent), linear in its logarithm; beyond them the ends.

    >>> Tabled(((0.1, 90.0), (10.0, 10.0)))(1.0)
    50.0
    """

    points: tuple[tuple[float, float], ...]

    def __call__(self, value: float) -> float:
        """Return the per cent at a value."""
        import numpy as np

        at, percent = zip(*self.points, strict=True)
        return float(np.interp(math.log(value), np.log(at), percent)) if value > 0.0 else percent[0]


#: Film regime -> what it is called. Its number, 0 to 3, is its place here.
FILM_REGIMES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "IR": "rigid-isoviscous",
        "VR": "rigid-piezoviscous",
        "IE": "elastic-isoviscous",
        "VE": "elastic-piezoviscous",
    }
)
#: Validities that film models share: no heat in the inlet, and no roughness.
ISOTHERMAL: Final = Validity(
    code="W01",
    quantity="thermal_load",
    high=0.1,
    consequence="shear heats the inlet and the film is {error} too thick",
    error=lambda load: 100.0 * load**0.62 / 3.94,
    remedy="film 'inlet-correction' with thermal = 'murch-wilson'",
    instead="inlet-correction.film",
    source="Murch and Wilson (1975), C_T = 3.94/(3.94 + Lt^0.62), for pure rolling (B)",
)
SMOOTH: Final = Validity(
    code="W02",
    quantity="film_parameter",
    low=3.0,
    consequence="roughness, of which the film knows nothing, changes it",
    remedy="none in the box; smoother surfaces or a thicker oil avoid it",
    source="Patir and Cheng (1978), by whom roughness matters below Lambda of about 3 (B)",
    common=True,
)


def in_regime(name: str, elsewhere: tuple[float, float] | None) -> tuple[Validity, ...]:
    """Return the validity of a film that holds in a regime, and is off by per cent in others; nothing for "all"."""
    if name not in FILM_REGIMES:
        return ()
    code = float(list(FILM_REGIMES).index(name))
    off = "may be far off"
    source = "what regime a contact is in: Johnson (1970), the law's own word for the rest"
    if elsewhere is not None:
        low = math.floor(elsewhere[0])
        high = math.ceil(elsewhere[1])
        off = f"is off by {low:+d} to {high:+d} % there, over M of 0.1 to 200 and L of 0 to 15"
        source = "reynolds-line: docs/scripts/film_error_map.py"
    return (
        Validity(
            code="W09",
            quantity="film_regime",
            low=code,
            high=code,
            made_for=f"the {FILM_REGIMES[name]} regime",
            consequence=f"its film {off}",
            remedy=(remedy := "film 'moes', which covers all regimes"),
            instead=remedy.split("'")[1],
            source=source,
        ),
    )
