"""Contact temperatures at which gears scuff, by two standards: from a test of the oil on gears, and from its kind."""

import math
from statistics import NormalDist
from typing import ClassVar, Final, Self

import attrs

from rollslip.bearing.assembly import Assembly
from rollslip.errors import DomainError, SceneError
from rollslip.fields import choice_of, in_range, parameter, positive
from rollslip.lubricant import Lubricant
from rollslip.references import Reference
from rollslip.structure import Location
from rollslip_plugins.bibliography import AGMA_925, BLOK_1937, ISO_13989
from rollslip_plugins.damage.flash import BulkAndFlash

__all__ = ["ScuffingAgma", "ScuffingIso"]

#: 0 degC in K.
_CELSIUS: Final = 273.15
#: Kind of oil -> its factor in X_L, equation 27 (B).
_KINDS: Final = {
    "mineral": 1.0,
    "polyalphaolefin": 0.8,
    "polyglycol": 0.7,
    "water-soluble polyglycol": 0.6,
    "phosphate ester": 1.3,
    "traction fluid": 1.5,
}
#: Kind of base oil of a data set -> kind of the standard; it has no esters of engines.
_OF_BASE: Final = {"mineral": "mineral", "pao": "polyalphaolefin", "pag": "polyglycol"}
#: Advice for an oil of which a standard has no kind.
_NO_KIND: Final = "name one of its kinds as the model's oil to judge by it all the same"
#: Mineral oil -> addend of its mean scuffing temperature [degC] (C).
_MINERAL: Final = {"mineral": 63.0, "mineral, antiscuff additives": 118.0}
#: Factor of the logarithm of the viscosity in the mean scuffing temperature of mineral oils [degC] (C).
_VISCOSITY_FACTOR: Final = 33.0
#: Specification of an oil of aircraft -> mean scuffing temperature on steel AISI 9310 [degC] (C).
_AIRCRAFT: Final = {"MIL-PRF-7808": 205.0, "MIL-PRF-23699": 220.0}
#: Standard deviation of scuffing temperatures over their mean, both in degC (C).
_SCATTER: Final = 0.15


@attrs.frozen(kw_only=True)
class ScuffingIso(BulkAndFlash):
    """Contact temperature, compared with that at which the oil scuffs a gear, after ISO/TR 13989-1 (ISO/TS 6336-20).

    T = (m_1 T_1 + m_2 T_2)/(m_1 + m_2) + dT,   T_S = 80 degC + (0.85 + 1.4 X_W) X_L S^2 K,
    X_L = k (eta/1 mPa s)^-0.05

    Blok's temperature of oil and steel, from a test that data sheets of gear oils print: the load stage of FZG's
    test A/8.3/90 (ISO 14635-1) at which the oil scuffs. Other variants of the test count their stages otherwise.

    Symbols:

    - T: temperature of the surfaces, as of ``contact-temperature`` [K]
    - T_S: scuffing temperature [K]
    - S: load stage (``fzg_stage``); there is no limit without it [-]
    - X_W: structural factor (``structural_factor``): 1 for through-hardened steel, and for case-hardened steel with 10
      to 20 % austenite; 1.5 nitrided [-]
    - X_L, k: factor of the oil and that of its kind (``oil``), by default of the scene's oil; mineral, which is told,
      where that does not say what it is made of [-]
    - eta: viscosity of the oil (``viscosity``), by default at ``operation.temperature`` [Pa s]

    Range: gears of steel with oils of the kinds listed; esters of aircraft engines are not among them. The bulk
    temperature is that of rings and rollers here; the standard's estimate of it is one of gears. That oils with
    antiscuff additives bear more in contacts shorter than 18 us is left out, which is on the safe side.

    Examples
    --------
    A mineral oil without additives that scuffs at stage 6, with 20 mPa s, and one with additives at stage 12.

    >>> [round(ScuffingIso(fzg_stage=stage, viscosity=0.02).limit[0] - 273.15) for stage in (6, 12)]
    [150, 359]
    """

    name: ClassVar[str] = "scuffing-iso"
    equation: ClassVar[str] = "T_S = 80 + (0.85 + 1.4 X_W) X_L S^2"
    references: ClassVar[tuple[Reference, ...]] = (ISO_13989, BLOK_1937)
    measure: ClassVar[str] = "contact temperature (ISO)"
    scope: ClassVar[str] = (
        "the limit is one of gears, from which the standard advises to stay some 50 K away; bearings also smear where "
        "a roller is accelerated, at contact temperatures far below it"
    )

    fzg_stage: int | None = parameter(
        default=None,
        doc="load stage of FZG's test A/8.3/90 at which the oil scuffs, of its data sheet",
        validator=attrs.validators.optional(in_range(1, 14)),
    )
    oil: str = parameter(
        default="",
        doc="kind of the oil; empty for that of the scene's oil",
        validator=choice_of("", *_KINDS),
    )
    taken: str = attrs.field(default="", repr=False, metadata={"key": None})
    structural_factor: float = parameter(
        default=1.0,
        unit="1",
        doc="structural factor X_W of the steel",
        validator=positive,
        usual=(0.45, 1.5),
        possible=(0.1, 5),
    )
    viscosity: float | None = parameter(
        default=None,
        unit="Pa s",
        doc="viscosity of the oil; by default that at operation.temperature",
        validator=attrs.validators.optional(positive),
        usual=(1e-3, 1),
        possible=(1e-6, 1e3),
    )

    def of(self, assembly: "Assembly") -> Self:
        """Return the measure with the viscosity of the scene's oil."""
        if self.fzg_stage is None:
            raise SceneError(
                [
                    Location(assembly.scene.origins, ("models", "damage")).message(
                        f"{self.name} needs fzg_stage, the load stage of FZG's test A/8.3/90 at which the oil scuffs: "
                        "take it from the oil's data sheet, as in { model = 'scuffing-iso', fzg_stage = 12 }"
                    )
                ]
            )
        viscosity = assembly.lubricant.at(assembly.scene.operation.temperature).viscosity
        known = self if self.viscosity is not None else attrs.evolve(self, viscosity=viscosity)
        if self.oil:
            return known
        return attrs.evolve(
            known,
            oil=_OF_BASE.get(assembly.lubricant.base_oil or "mineral", ""),
            taken=_taken(assembly.lubricant),
        )

    @property
    def limit(self) -> tuple[float, str] | None:
        """The scuffing temperature."""
        if self.fzg_stage is None or self.viscosity is None:
            return None
        if not self.oil and self.taken:
            return (
                math.nan,
                f"ISO/TR 13989-1 has no factor of the kind of this oil, {self.taken}; {_NO_KIND}",
            )
        factor = _KINDS[self.oil or "mineral"] * (1e3 * self.viscosity) ** -0.05
        rise = (0.85 + 1.4 * self.structural_factor) * factor * self.fzg_stage**2
        source = f"ISO/TR 13989-1 (2000), gears, FZG load stage {self.fzg_stage}, {self.taken or self.oil} (B)"
        return _CELSIUS + 80.0 + rise, source.replace(", (", " (")


@attrs.frozen(kw_only=True)
class ScuffingAgma(BulkAndFlash):
    """Contact temperature, compared with that at which a fraction of gears scuff in an oil of its kind, after AGMA 925.

    T = (m_1 T_1 + m_2 T_2)/(m_1 + m_2) + dT,   T_S = T_m (1 + 0.15 z(P)),
    T_m = 63 + 33 ln(nu_40)  or  118 + 33 ln(nu_40), 205, 220  [degC]

    Symbols:

    - T: temperature of the surfaces, as of ``contact-temperature`` [K]
    - T_S: temperature at which the fraction P (``risk``) of gears scuff, counted in degC; z is the quantile of the
      normal distribution [degC]
    - T_m: mean scuffing temperature, of mineral oils without and with antiscuff additives, of MIL-PRF-7808 and of
      MIL-PRF-23699, the last two on steel AISI 9310 (``oil``); by default that of the scene's oil, which is taken for a
      mineral one without additives where it does not say what it is made of [degC]
    - nu_40: kinematic viscosity at 40 degC (``viscosity_40``), by default that of the scene's oil [mm2/s]

    The standard calls a risk below 10 % low and above 30 % high. All numbers are recalled (C).

    Range: spur and helical gears of case-hardened steel.

    Examples
    --------
    A mineral oil of ISO VG 68: half of the gears scuff at 202 degC, one in ten at 163 degC.

    >>> [round(ScuffingAgma(viscosity_40=68e-6, risk=risk).limit[0] - 273.15) for risk in (0.5, 0.1)]
    [202, 163]
    """

    name: ClassVar[str] = "scuffing-agma"
    equation: ClassVar[str] = "T_S = (63 + 33 ln nu_40) (1 + 0.15 z(P))"
    references: ClassVar[tuple[Reference, ...]] = (AGMA_925, BLOK_1937)
    measure: ClassVar[str] = "contact temperature (AGMA)"
    scope: ClassVar[str] = (
        "the limit is one of gears, for a whole kind of oils; bearings also smear where a roller is accelerated, at "
        "contact temperatures far below it"
    )

    oil: str = parameter(
        default="",
        doc="kind of the oil, or its specification; empty for that of the scene's oil",
        validator=choice_of("", *_MINERAL, *_AIRCRAFT),
    )
    taken: str = attrs.field(default="", repr=False, metadata={"key": None})
    viscosity_40: float | None = parameter(
        default=None,
        unit="m2/s",
        doc="kinematic viscosity of a mineral oil at 40 degC; by default that of the scene's oil",
        validator=attrs.validators.optional(positive),
        usual=(5e-6, 1e-3),
        possible=(1e-6, 0.1),
    )
    risk: float = parameter(
        default=0.1,
        unit="1",
        doc="fraction of gears that scuff at the limit",
        validator=in_range(0.0, 1.0, open=True),
        usual=(0.001, 0.9),
        possible=(0, 1),
    )

    def of(self, assembly: "Assembly") -> Self:
        """Return the measure with the viscosity of the scene's oil."""
        oil = assembly.lubricant
        T = _CELSIUS + 40.0
        if not self.oil and not self.taken:
            kind = oil.name.upper()
            if kind not in _AIRCRAFT:
                kind = "mineral" if oil.base_oil in (None, "mineral") else ""
            return attrs.evolve(self, oil=kind, taken=_taken(oil)).of(assembly)
        if self.viscosity_40 is not None or self.oil not in _MINERAL:
            return self
        try:
            if oil.density is None:
                raise DomainError(
                    "the density of the oil is not known; give lubricant.density, such as '870 kg/m3'"
                )
            return attrs.evolve(self, viscosity_40=oil.at(T).viscosity / oil.density(T))
        except DomainError as error:
            where = Location(assembly.scene.origins, ("models", "damage"))
            message = (
                f"{self.name} needs the kinematic viscosity of the oil at 40 degC: "
                f"{error}; or give its viscosity_40"
            )
            raise SceneError([where.message(message)]) from error

    @property
    def limit(self) -> tuple[float, str] | None:
        """The scuffing temperature at the risk that is taken."""
        if not self.oil and self.taken:
            return (
                math.nan,
                f"AGMA 925 has no scuffing temperature of the kind of this oil, {self.taken}; {_NO_KIND}",
            )
        if self.oil in _AIRCRAFT:
            mean = _AIRCRAFT[self.oil]
        elif self.viscosity_40 is None:
            return None
        else:
            mean = _MINERAL[self.oil or "mineral"] + _VISCOSITY_FACTOR * math.log(
                1e6 * self.viscosity_40
            )
        source = f"AGMA 925, {100 * self.risk:.3g} % of gears scuff with oil {self.oil or 'mineral'!r}, recalled (C)"
        if self.taken and self.oil not in _AIRCRAFT:
            source += f", {self.taken}"
        return _CELSIUS + mean * (1.0 + _SCATTER * NormalDist().inv_cdf(self.risk)), source


def _taken(oil: "Lubricant") -> str:
    """Return what is known of the kind of an oil, in words."""
    if oil.base_oil is None:
        return f"mineral as ASSUMED: {oil.name!r} does not say its base oil; give the model's oil"
    return f"{oil.base_oil} as {oil.name!r} is"
