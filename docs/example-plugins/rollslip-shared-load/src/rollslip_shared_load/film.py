"""Film of a load that oil and asperities share, which is known when both are: an iteration within one evaluation."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, ClassVar, Final

import attrs
import numpy as np
from numpy.typing import NDArray
from rollslip import Slices
from rollslip.errors import ConvergenceError, DomainError
from rollslip.fields import FieldError, in_range, parameter, positive
from rollslip.hookspecs import hookimpl
from rollslip.models import NON_NEGATIVE, POSITIVE, FilmModel, submodel

Array = NDArray[np.float64]
#: Least share of the film: below it there is none to speak of, and Reynolds' equation is not the law.
LEAST: Final = 1e-6
#: What may be left of the equation, as a share of the load; its slope is 1 at least, so the share is as good.
LEFT: Final = 1e-14
#: Relative width between the two ends at which they are one number, however steep the equation.
WIDTH: Final = 1e-15


@attrs.frozen(kw_only=True)
class SharedLoad(FilmModel):
    """Film of the load that asperities leave to it, after Johnson, Greenwood and Poon.

    f + p_a(h)/p = 1,  h = film(f w, f E')

    f share of the film [1], w load per length [N/m], p mean pressure [Pa], E' modulus [Pa], p_a pressure of asperities
    at the film [Pa]: (16 sqrt(2) pi/15) (sigma beta eta)^2 sqrt(sigma/beta) (E'/2) F(h/sigma), after Greenwood and
    Tripp, sigma composite roughness [m], F(x) = 4.4086e-5 (4 - x)^6.804 below 4, else 0 (grade C).

    Both bend the surfaces, with f p of it from the film: so the film is that of a body of modulus f E' under f p.
    The equation falls in f wherever a film thins under load, so that it has one root. Secants and halvings by turns
    hold it between two ends.

    Range: shares of the film above 1e-6; films that read load, speed, radius, modulus and oil alone.
    """

    name: ClassVar[str] = "shared-load"
    equation: ClassVar[str] = "f + p_a(h)/p = 1, h = film(f w, f E')"
    references: ClassVar[tuple[str, ...]] = (
        "Johnson K.L., Greenwood J.A., Poon S.Y. A simple theory of asperity contact in elastohydrodynamic "
        "lubrication. Wear 19, 1972, 91-108.",
        "Greenwood J.A., Tripp J.H. The contact of two nominally flat rough surfaces. Proc. Inst. Mech. Eng. 185, "
        "1970, 625-633.",
    )
    expected_failures: ClassVar[Mapping[str, str]] = MappingProxyType(
        {"check_python_runs_once_for_all_slices": "it evaluates a film until the shares of all slices are known"}
    )
    outputs: ClassVar[Mapping[str, tuple[str, str]]] = MappingProxyType(
        {
            "asperity_fraction": ("1", "share of the load that asperities carry"),
            "film_left": ("1", "film of the load that they leave, over the film, less one"),
        }
    )
    reads = FilmModel.reads | {"pressure", "roughness"}
    domain = MappingProxyType({**FilmModel.domain, "pressure": POSITIVE, "roughness": NON_NEGATIVE})

    film: FilmModel = submodel("film", default="moes", doc="film between smooth surfaces")
    roughness_parameter: float = parameter(default=0.05, unit="1", validator=positive, doc="sigma beta eta")
    slope_parameter: float = parameter(default=1e-3, unit="1", validator=in_range(0.0, 1.0), doc="sigma/beta")
    steps: int = parameter(default=120, unit="1", validator=positive, doc="most steps of the iteration")

    def __attrs_post_init__(self) -> None:
        if more := self.film.reads - FilmModel.reads:
            raise FieldError("film", f"must read no more than load, speed, body and oil, not {', '.join(sorted(more))}")

    @property
    def location(self) -> str:  # type: ignore[override]
        """That of the film within it."""
        return self.film.location

    @property
    def regime(self) -> str:  # type: ignore[override]
        """That of the film within it."""
        return self.film.regime

    def evaluate(self, slices: Slices) -> None:
        """Fill the film thickness."""
        slices.film_thickness[...] = self.film_of(slices, self.share_of_film(slices))

    def film_of(self, slices: Slices, fraction: Array) -> Array:
        """Return the film of a share of the load."""
        c = slices.conditions
        load = fraction * slices.load
        modulus = fraction * c.modulus
        return self.film.film_thickness(
            load, slices.rolling_speed, c.radius, modulus, c.viscosity, c.pressure_viscosity
        )

    def asperity_fraction(self, slices: Slices, film: Array) -> Array:
        """Return the share of the load that asperities carry at a film."""
        shape = 16 * np.sqrt(2) * np.pi / 15 / 2 * self.roughness_parameter**2 * np.sqrt(self.slope_parameter)
        with np.errstate(divide="ignore"):
            near = np.maximum(4.0 - film / slices.conditions.roughness, 0.0)
        return np.asarray(shape * slices.conditions.modulus / slices.pressure * 4.4086e-5 * near**6.804)

    def share_of_film(self, slices: Slices) -> Array:
        """Return the share of the load that is left to the film.

        Each slice stops by itself, so that its share does not depend on who is evaluated with it.
        """

        def left(fraction: Array) -> Array:
            return 1.0 - fraction - self.asperity_fraction(slices, self.film_of(slices, fraction))

        low = np.full(len(slices), LEAST)
        high = np.ones(len(slices))
        below = left(low)
        above = left(high)
        if np.any(bare := ~(below > 0.0)):
            i = int(np.argmax(bare))
            raise DomainError(f"{self.name}: slice {i}: asperities carry the whole load; there is no film")
        fraction = high.copy()
        rest = above.copy()
        for step in range(self.steps):
            open_ = (np.abs(rest) > LEFT) & (high - low > WIDTH * high)
            if not np.any(open_):
                return fraction
            secant = high - above * (high - low) / (above - below)
            fraction = np.where(open_, 0.5 * (low + high) if step % 2 else np.clip(secant, low, high), fraction)
            rest = np.where(open_, left(fraction), rest)
            up = rest > 0.0
            low = np.where(up, fraction, low)
            below = np.where(up, rest, below)
            high = np.where(up, high, fraction)
            above = np.where(up, above, rest)
        i = int(np.argmax(np.abs(rest)))
        raise ConvergenceError(
            f"{self.name}: slice {i}: the share of the film has not converged: after {self.steps} steps it lies "
            f"between {low[i]:.6g} and {high[i]:.6g}, and {abs(rest[i]):.2g} of the load is left; allow more steps"
        )

    def quantities(self, slices: Slices) -> Mapping[str, NDArray[Any]]:
        """Return the share of asperities at the film, and how far the film is from that of the load they leave."""
        fraction = self.asperity_fraction(slices, slices.film_thickness)
        left = self.film_of(slices, np.maximum(1.0 - fraction, LEAST))
        return {"asperity_fraction": fraction, "film_left": left / slices.film_thickness - 1.0}


@hookimpl
def film_models() -> list[type[FilmModel]]:
    """Offer the model."""
    return [SharedLoad]
