"""Film of an inlet that is neither isothermal nor fully flooded: another film model, thinned by factors.

The formulas of the film take oil of the inlet's temperature, and enough of it. Shear warms the oil that the inlet turns
back, the more the faster it runs, and a starved inlet begins nearer to the contact.
"""

import math
from typing import Any, ClassVar, Final

import attrs
import numpy as np
from numpy.typing import ArrayLike

from rollslip.bearing.approach import limited_by_layer
from rollslip.bearing.chain import stage
from rollslip.errors import DomainError
from rollslip.fields import choice_of, parameter, positive, refuse_if, within_possible
from rollslip.models import (
    FINITE,
    NON_NEGATIVE,
    POSITIVE,
    Domain,
    FilmModel,
    Validity,
    common_domain,
    evaluate_arrays,
    from_scene,
    submodel,
)
from rollslip.references import Reference
from rollslip.scene.supply import PLENTY
from rollslip.search import Array
from rollslip_kernels.slices import Slices
from rollslip_kernels.stages import film as compiled
from rollslip_plugins.bibliography import (
    CHEVALIER_1998,
    GUPTA_1992,
    MURCH_1975,
    WILSON_1983,
    ZHOU_1991,
)
from rollslip_plugins.film.formulas import Moes

#: Members that each law reads, in the order of the laws in the kernel.
LAWS: Final[dict[str, Domain]] = {
    "none": {},
    "murch-wilson": {
        "rolling_speed": POSITIVE,
        "viscosity": POSITIVE,
        "thermoviscosity": NON_NEGATIVE,
        "conductivity": POSITIVE,
    },
}
#: Validity of both laws of the reduction.
MILD_HEATING: Final = Validity(
    code="W06",
    quantity="thermal_load",
    high=10.0,
    consequence="in pure rolling the film is 15 % too thick at most, with sliding of a fifth up to 89 %",
    remedy="less speed or a thinner oil; no built-in law of the inlet is valid there",
    source="Wilson and Sheu (1983), whose thermal Reynolds equation ends there",
)
LAWS["gupta"] = {
    **LAWS["murch-wilson"],
    "sliding_speed": FINITE,
    "pressure": POSITIVE,
    "modulus": POSITIVE,
}


def oil_before_contact() -> Any:
    """Declare the layer of oil before a contact, which is taken from the scene where it is not set."""
    return from_scene(
        "oil_layer",
        validator=within_possible,
        doc="oil on both surfaces together before the contact",
        usual=(1e-8, 1e-3),
        possible=(1e-12, PLENTY),
        keywords={"plenty": PLENTY},
    )


def stated_layer(oil_layer: float) -> float:
    """Return a layer of oil on the surfaces [m], `PLENTY` where it is not given (NaN)."""
    return PLENTY if math.isnan(oil_layer) else oil_layer


def thermal_load(s: Slices) -> Array:
    """Return the thermal load Lt = eta0 beta0 u^2/K_f of slices."""
    c = s.conditions
    return np.asarray(
        c.viscosity * c.thermoviscosity / c.conductivity * (s.rolling_speed * s.rolling_speed)
    )


def heated_inlet(load: Array) -> Array:
    """Return Murch and Wilson's factor C_T = 3.94/(3.94 + Lt^0.62) of a heated inlet, of film and of resistance."""
    return np.asarray(3.94 / (3.94 + load**0.62))


@attrs.frozen(kw_only=True)
class InletCorrection(FilmModel):
    """A film thinned by shear heating of its inlet, h = C_T h_film, and by want of oil before it.

    Laws of the reduction (``thermal``):

    - ``murch-wilson``: C_T = 3.94/(3.94 + Lt^0.62), for pure rolling; as Wilson and Sheu print it, 0.254 = 1/3.94.
    - ``gupta``: C_T = [1 - 13.2 (p_H/E') Lt^0.42]/[1 + 0.213 (1 + 2.23 S^0.83) Lt^0.64], as Zhou and Hoeprich print it
      after Zhu and Cheng. That its E' is ours follows from their G = alpha E' = 3745 for steel (B).

    Where the surfaces bring a layer of oil ``oil_layer`` h_oil to the inlet and no more, Chevalier and others take
    h = h_ff h_oil/(h_ff^g + h_oil^g)^(1/g) with h_ff = C_T h_film (the form is recalled, C; both limits are exact):
    speed and viscosity starve a contact that the same layer floods at less of them. A contact lets through the oil
    that comes, and no more than a flooded inlet takes; without flow to the sides h is the smaller one of both, which is
    g to infinity. For round contacts, whose oil flows round them, g is 2 to 5; 4 meets Reynolds' equation of crowned
    rollers with 7 to 9 %.

    Symbols:

    - h: film thickness [m]
    - h_ff: that of a fully flooded inlet [m]
    - h_film: that of the model (``film``) of an isothermal, fully flooded inlet [m]
    - C_T: reduction by shear heating [1]
    - h_oil: thickness of the oil on both surfaces together before the contact (``oil_layer``), which the supply of oil
      gives; plenty outside of a scene [m]
    - g: exponent of the flow to the sides (``layer_exponent``) [1]
    - Lt: thermal load eta0 beta0 u^2/K_f, which does not matter below 0.1 [1]
    - eta0: viscosity at ambient pressure [Pa s]
    - beta0: its fall with temperature -dln(eta0)/dT [1/K]
    - u: mean of the two surface speeds [m/s]
    - K_f: conductivity of the oil [W/(m K)]
    - S: slide-roll ratio |V|/u [1]
    - V: sliding speed [m/s]
    - p_H: largest Hertz pressure, 4/pi times the mean [Pa]
    - E': equivalent modulus 2/sum((1 - nu^2)/E) [Pa]

    Range: heavily loaded contacts, with an inlet of Grubin's kind. Against a numerical one with the thermal Reynolds
    equation that Wilson and Sheu print, in pure rolling with Lt from 0.1 to 10, ``murch-wilson`` is 4 % low to 8 %
    high, ``gupta`` without its pressure 2 % low to 15 % high. Sliding heats more than either predicts: at S = 0.2 both
    are within 9 % up to Lt = 1, but 89 and 57 % high at Lt = 10. At high pressure and thermal load ``gupta`` turns
    negative and is refused; the range it was fitted in, and numbers of its own source, were not at hand. Far beyond
    Lt = 10 the film gets thinner with speed. A layer is taken at the density of the film: at 1 GPa oil is a fifth
    denser, and the film that much thinner. With g = 4 the film is 16 % below that without flow to the sides where
    h_oil = h_ff, and within 2 % where one is more than twice the other.

    Raises
    ------
    FieldError
        If the film is one whose inlet is corrected already.

    Examples
    --------
    A thermal load of 0.01 0.04 20^2/0.16 = 1 leaves 3.94/4.94 = 0.797571 of the film.

    >>> state = {"load_per_length": 2e5, "rolling_speed": 20.0, "radius": 0.01, "modulus": 2e11, "viscosity": 0.01}
    >>> oil = {"pressure_viscosity": 2e-8}
    >>> thin = InletCorrection().film_thickness(**state, **oil, thermoviscosity=0.04, conductivity=0.16)
    >>> f"{thin / Moes().film_thickness(**state, **oil):.6f}"
    '0.797571'
    """

    name: ClassVar[str] = "inlet-correction"
    equation: ClassVar[str] = (
        "h = h_ff h_oil/(h_ff^g + h_oil^g)^(1/g), h_ff = C_T h_film; murch-wilson: C_T = 3.94/(3.94 + Lt^0.62); "
        "gupta: C_T = [1 - 13.2 (p_H/E') Lt^0.42]/[1 + 0.213 (1 + 2.23 S^0.83) Lt^0.64]"
    )
    references: ClassVar[tuple[Reference, ...]] = (
        MURCH_1975,
        WILSON_1983,
        GUPTA_1992,
        ZHOU_1991,
        CHEVALIER_1998,
    )

    film: FilmModel = submodel(
        "film", factory=Moes, doc="film model of an isothermal, fully flooded inlet"
    )
    thermal: str = parameter(
        default="murch-wilson",
        validator=choice_of(*LAWS),
        doc="reduction by shear heating of the inlet: 'none', 'murch-wilson' or 'gupta'",
    )
    oil_layer: float = oil_before_contact()
    layer_exponent: float = parameter(
        default=FilmModel.layer_exponent,
        unit="1",
        validator=positive,
        doc="exponent of a thin layer: the larger, the less of it flows to the sides",
        usual=(2, 10),
        possible=(1, 10),
    )

    def __attrs_post_init__(self) -> None:
        refuse_if(
            self.film.inlet_heating or self.film.oil_layer < PLENTY,
            "film",
            f"the inlet of {self.film.name!r} is corrected already; give the film inside it",
        )

    @property
    def reads(self) -> frozenset[str]:  # type: ignore[override]
        """What the film reads, and what the correction does."""
        return self.film.reads | LAWS[self.thermal].keys()

    @property
    def writes(self) -> frozenset[str]:  # type: ignore[override]
        """What the film writes."""
        return self.film.writes

    @property
    def domain(self) -> Domain:  # type: ignore[override]
        """Where both the film and the correction are defined."""
        return common_domain(self.film.domain, LAWS[self.thermal])

    @property
    def location(self) -> str:  # type: ignore[override]
        """Which film thickness it returns."""
        return self.film.location

    @property
    def at_any_load(self) -> bool:  # type: ignore[override]
        """Whether the film gives one at any load."""
        return self.film.at_any_load

    @property
    def regime(self) -> str:  # type: ignore[override]
        """Film regime it holds in."""
        return self.film.regime

    @property
    def validity(self) -> tuple[Validity, ...]:  # type: ignore[override]
        """That of the reduction; the film speaks for itself, but for the heat."""
        return (MILD_HEATING,) if self.inlet_heating else ()

    @property
    def covers(self) -> frozenset[str]:  # type: ignore[override]
        """The heat of the inlet, if it is taken."""
        return frozenset({"thermal_load"} if self.inlet_heating else ())

    @property
    def inlet_heating(self) -> str:
        """Law of the reduction by heat; empty if there is none."""
        return "" if self.thermal == "none" else self.thermal

    @property
    def isothermal(self) -> FilmModel:
        """The film of a cold inlet, which is starved as much."""
        return attrs.evolve(self, thermal="none") if self.oil_layer < PLENTY else self.film

    @property
    def flooded(self) -> FilmModel:
        """The film of an inlet with oil in plenty, which is heated as much."""
        return attrs.evolve(self, oil_layer=PLENTY) if self.inlet_heating else self.film

    def evaluate(self, slices: Slices) -> None:
        """Fill the film thickness, and what else the film fills."""
        self.film.evaluate(slices)
        film = slices.film_thickness
        film *= self._thermal_factor(slices)
        if self.oil_layer < PLENTY:
            film[...] = limited_by_layer(film, self.oil_layer, self.layer_exponent)

    def _thermal_factor(self, s: Slices) -> Array:
        """Return the reduction C_T of slices by shear heating."""
        if self.thermal == "none":
            return np.ones(())
        c = s.conditions
        load = thermal_load(s)
        if self.thermal == "murch-wilson":
            factor = heated_inlet(load)
        else:
            stress = 4 / math.pi * s.pressure / c.modulus
            slide = np.abs(s.sliding_speed) / s.rolling_speed
            heated = 1 + 0.213 * (1 + 2.23 * slide**0.83) * load**0.64
            factor = np.asarray((1 - 13.2 * stress * load**0.42) / heated)
        if not np.all(factor > 0):
            at = np.broadcast_to(load, factor.shape)[~(factor > 0)][0]
            raise DomainError(
                f"{self.name}: {self.thermal!r} gives no film at a thermal load of {at:g} and this pressure; "
                "choose thermal = 'murch-wilson', which is positive everywhere, or lower speed or load"
            )
        return factor

    def film_thickness(
        self,
        load_per_length: "ArrayLike",
        rolling_speed: "ArrayLike",
        radius: "ArrayLike",
        modulus: "ArrayLike",
        viscosity: "ArrayLike",
        pressure_viscosity: "ArrayLike",
        **members: "ArrayLike",
    ) -> Array:
        """Return the film thickness [m]; arguments broadcast.

        Parameters
        ----------
        load_per_length, rolling_speed, radius, modulus, viscosity, pressure_viscosity : array_like
            As of every film model.
        **members : array_like
            What the correction reads besides: ``thermoviscosity`` [1/K] and ``conductivity`` [W/(m K)] for a thermal
            one, ``pressure`` (mean) [Pa] and ``sliding_speed`` [m/s] for Gupta's.
        """
        given = {
            "load": load_per_length,
            "rolling_speed": rolling_speed,
            "radius": radius,
            "modulus": modulus,
            "viscosity": viscosity,
            "pressure_viscosity": pressure_viscosity,
        } | members
        if differing := sorted(self.reads ^ given.keys()):
            raise DomainError(
                f"{self.name}: film_thickness() takes {', '.join(sorted(self.reads))} here; "
                f"missing or too many are {', '.join(differing)}"
            )
        return evaluate_arrays(self, "film_thickness", **given)

    def kernel(self) -> object:
        """Return the compiled form, with the film's compiled form or a call of its NumPy form."""
        return compiled.inlet(
            stage(self.film),
            list(LAWS).index(self.thermal),
            stated_layer(self.oil_layer),
            self.layer_exponent,
        )
