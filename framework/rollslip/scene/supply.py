"""Oil supply of a bearing: the oil content of its interior, and the starvation of its inlets.

- The kinds of supply are one table, `SUPPLIES`; values that a scene states replace those of the table.
- SKF's formulas are in mm, mm2/s and 1/min and are evaluated in these units; arguments and results are SI.
- All results are accurate to a factor only: the oil content was measured in few bearings, and in none of these.

Source: SKF, general catalogue 6000 (2006), friction: kinematic replenishment and starvation, and the drag of a bath.
"""

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Final, NamedTuple

import attrs
from attrs.validators import optional

from rollslip.fields import FieldError, Scatter, choice_of, field, non_negative, positive

__all__ = ["DENSITY", "SUPPLIES", "Lubrication", "OilSupply", "Supply"]

#: Density of an oil that gives none [kg/m3]; mineral oils have 850 to 900, esters up to 1000 (D).
DENSITY: Final = 870.0
#: Slope of the oil content over the level, phi = SLOPE H/(D - d) [1]. Doubling it doubles the churning of a bath. It is
#: fitted to SKF's bath drag, which it meets within -30 to +35 % for nine of ten bearings up to H = DEEPEST d_m (B).
SLOPE: Final = 0.40
#: Largest oil level over the pitch diameter to which `SLOPE` was fitted [1]; a higher level is reported as unusual.
DEEPEST: Final = 0.3
#: Speed n d_m of a jet-lubricated bearing from which air displaces oil [mm/min] (C). Doubling it leaves 16 times as
#: much oil in a faster bearing, whose content falls with the fourth power of the speed.
_FAST = 5e5
#: Oil content of a jet-lubricated bearing at the highest speeds [1]; measurements give 0.01 to 0.05 (C). Doubling it
#: doubles the churning there.
_FAST_FRACTION = 0.03
#: SKF's replenishment constant K_rs of a low bath and of a jet [1] (A). Doubling it squares the starvation factor.
_LOW = 3e-8
#: SKF's replenishment constant K_rs of grease and of oil with air [1] (A). Doubling it squares the starvation factor.
_LEAN = 6e-8
#: SKF's geometry constant K_Z of cylindrical roller bearings with a cage [1] (A). Starvation grows with its square root
#: in the exponent.
_KZ = 5.1
#: Limit of the exponent of starvation [1]: exp(-30) is a film without any friction. Halving it would show at high
#: speeds, doubling it changes nothing but the risk of an underflow.
_MAX_EXPONENT: Final = 30.0


class Supply(NamedTuple):
    """Oil content and starvation of a kind of supply."""

    #: Description, for texts.
    description: str
    #: Assumed oil level over the roller diameter [1]; 0 where there is no level.
    level: float
    #: Oil content over that of a bath with this level [1].
    times: float
    #: Oil content phi of the volume between the rings where there is no level [1].
    fraction: float
    #: SKF's replenishment constant K_rs [1].
    starvation: float
    #: Fraction of the land of a ring-guided cage that oil fills [1].
    land: float
    #: Source of the numbers, with their grades.
    source: str


_SKF = "SKF, general catalogue 6000 (2006), friction: K_rs (A)"
#: Kind of supply -> its oil content and starvation.
SUPPLIES: Final[Mapping[str, Supply]] = MappingProxyType(
    {
        "bath": Supply(
            "an oil bath, by default up to the middle of the lowest roller", 0.5, 1.0, 0.0, 0.0, 1.0,
            f"the level from SKF's later bath drag (C); {_SKF} of a low bath, 0 of one that reaches the middle (B)",
        ),
        "splash": Supply(
            "oil that gears throw", 0.25, 1.0, 0.0, _LOW, 1.0,
            f"half the level of a bath (D); {_SKF} of a low bath",
        ),
        "circulating": Supply(
            "oil that is pumped through", 0.5, 2.0, 0.0, _LOW, 1.0,
            f"SKF: twice the drag of a bath up to the middle of the lowest roller (A); {_SKF} of a jet",
        ),
        "jet": Supply(
            "a jet of oil", 0.5, 2.0, 0.0, _LOW, 1.0,
            f"as circulating (A), above 5e5 mm/min less, down to 3 % (C, 1 to 5 % are reported); {_SKF} of a jet",
        ),
        "mist": Supply(
            "oil with air, or drops", 0.0, 1.0, 0.01, _LEAN, 0.25,
            f"1 % of the volume, a quarter of the land (D); {_SKF}",
        ),
        "grease": Supply(
            "grease that is run in, with the viscosity of its base oil", 0.0, 1.0, 0.0, _LEAN, 0.0,
            f"no oil between rollers and on the land (D); {_SKF}",
        ),
    }
)  # fmt: skip
_WITH_LEVEL = tuple(name for name, kind in SUPPLIES.items() if kind.level and kind.times == 1.0)
_WITH_FLOW = ("splash", "circulating", "jet")


@attrs.frozen(kw_only=True)
class Lubrication:
    """How oil gets to the bearing."""

    supply: str = field(
        default="bath", doc="kind of supply", validator=choice_of(*SUPPLIES), bare=True
    )
    oil_level: float | None = field(
        default=None,
        unit="m",
        doc="level H of a bath at rest above the lowest point of the outer raceway; by default the middle of the "
        "lowest roller, of splash half of that (D)",
        validator=optional(non_negative),
        usual=(0, 0.5),
        possible=(0, 30),
    )
    oil_flow: float | None = field(
        default=None,
        unit="m3/s",
        doc="flow of oil through the bearing; it carries off heat where models.thermal has an oil_inlet_temperature, "
        "and nothing else is made of it",
        validator=optional(positive),
        usual=(1e-9, 0.01),
        possible=(1e-15, 10),
    )
    oil_fraction: float | None = field(
        default=None,
        unit="1",
        doc="volume fraction phi of oil between the rings; by default that of supply and level",
        validator=optional(non_negative),
        usual=(0, 0.5),
        possible=(0, 1),
    )
    starvation_constant: float | None = field(
        default=None,
        unit="1",
        doc="SKF's replenishment constant K_rs; by default that of the supply, 0 for inlets full of oil",
        validator=optional(non_negative),
        usual=(0, 2e-7),
        possible=(0, 1),
        scatter=Scatter(
            distribution="lognormal",
            parameters={"deviation_of_ln": 0.5},
            grade="(D)",
            source="SKF prints two values of K_rs, a factor of 2 apart, for all that is not a full bath",
        ),
    )

    def __attrs_post_init__(self) -> None:
        for name, kinds in (("oil_level", _WITH_LEVEL), ("oil_flow", _WITH_FLOW)):
            if getattr(self, name) is not None and self.supply not in kinds:
                only = " or ".join(map(repr, kinds))
                raise FieldError(name, f"only read for supply = {only}, not for {self.supply!r}")


class OilSupply(NamedTuple):
    """Oil content and starvation of a bearing in operation."""

    #: Oil content phi of the volume between the rings [1].
    oil_fraction: float
    #: Starvation factor phi_rs of film and rolling resistance [1].
    starvation: float
    #: Fraction of the land of the cage that oil fills [1].
    land: float
    #: Replenishment constant K_rs from which the starvation follows [1].
    starvation_constant: float

    @classmethod
    def from_lubrication(
        cls,
        lubrication: Lubrication,
        boundaries: tuple[float, float],
        roller_diameter: float,
        speed: float,
        viscosity: float,
    ) -> "OilSupply":
        """Return oil content and starvation of a bearing.

        phi = 0.40 H/(D - d) [1 + (2.6e5 nu/(n d_m^2))^1.38] of a bath, 2 times that at H = D_w/2 where oil is pumped,
        phi_rs = exp(-K_rs nu n (d + D) sqrt(K_Z/(2 (D - d)))), in mm, mm2/s and 1/min, with K_Z = 5.1.

        Parameters
        ----------
        lubrication : Lubrication
            Kind of supply, and values that replace those of the kind.
        boundaries : (float, float)
            Bore d and outside diameter D of the bearing [m].
        roller_diameter : float
            Roller diameter D_w [m].
        speed : float
            Speed of the inner relative to the outer ring [rad/s].
        viscosity : float
            Kinematic viscosity of the oil at the operating temperature [m2/s].

        Examples
        --------
        A bath up to the middle of rollers of 10 mm, D - d = 40 mm: 0.40 5/40 = 0.05. A low one is starved by
        exp(-3e-8 20 3000 140 sqrt(5.1/80)) = 0.938355.

        >>> rings, n = (0.05, 0.09), 314.159265
        >>> f"{OilSupply.from_lubrication(Lubrication(), rings, 0.01, n, 1e-9).oil_fraction:.6f}"
        '0.050000'
        >>> f"{OilSupply.from_lubrication(Lubrication(oil_level=0.002), rings, 0.01, n, 20e-6).starvation:.6f}"
        '0.938355'
        """
        kind = SUPPLIES[lubrication.supply]
        d = 1e3 * boundaries[0]
        D = 1e3 * boundaries[1]
        n = abs(speed) * 30.0 / math.pi
        nu = 1e6 * viscosity
        mean = 0.5 * (d + D)
        level = (
            kind.level * roller_diameter if lubrication.oil_level is None else lubrication.oil_level
        )
        phi = kind.fraction + kind.times * SLOPE * 1e3 * level / (D - d)
        if level > 0.0:
            phi *= 1.0 + (2.6e5 * nu / (n * mean**2)) ** 1.38
        if lubrication.supply == "jet":
            phi = min(phi, max(phi * (_FAST / (n * mean)) ** 4, _FAST_FRACTION))
        K_rs = kind.starvation
        if lubrication.supply == "bath" and level < 0.5 * roller_diameter:
            K_rs = _LOW
        if lubrication.starvation_constant is not None:
            K_rs = lubrication.starvation_constant
        exponent = K_rs * nu * n * (d + D) * math.sqrt(_KZ / (2.0 * (D - d)))
        stated = lubrication.oil_fraction
        return cls(
            min(phi, 1.0) if stated is None else stated,
            math.exp(-min(exponent, _MAX_EXPONENT)),
            kind.land,
            K_rs,
        )
