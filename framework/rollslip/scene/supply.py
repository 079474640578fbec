"""How oil gets to a bearing: how much of it the rollers plough through, and by how much it starves their inlets.

- The kinds of supply are one table, `SUPPLIES`; what a scene states of its own takes the place of what follows from it.
- What SKF prints is in mm, mm2/s and 1/min, and stays so in the formulas; arguments and results are SI.
- All of it is known to a factor: how much oil a bearing holds is measured in few bearings, and in none of these.
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
#: phi = SLOPE H/(D - d); meets SKF's bath drag within -30 to +35 % for nine of ten up to H = DEEPEST d_m (B).
SLOPE: Final = 0.40
DEEPEST: Final = 0.3
#: Jets: speed n d_m [mm/min] from which air carries oil off, and the share that is left at last (C).
_FAST = 5e5
_FAST_FRACTION = 0.03
#: SKF's K_rs of a low bath and of a jet, and of grease and of oil with air [1] (A).
_LOW = 3e-8
_LEAN = 6e-8
#: SKF's K_Z of cylindrical roller bearings with a cage [1] (A).
_KZ = 5.1


class Supply(NamedTuple):
    """What a kind of supply makes of the oil in a bearing."""

    words: str  # what it is
    level: float  # oil level that is assumed, over the diameter of a roller; 0 where there is none
    times: float  # how many times the oil of such a bath the rollers plough through
    fraction: float  # share phi of oil in the volume between the rings where there is no level
    starvation: float  # SKF's replenishment constant K_rs
    land: float  # share of the land of a ring-guided cage that oil fills
    source: str  # what the numbers rest on, with their grades


_SKF = "SKF, general catalogue 6000 (2006), friction: K_rs (A)"
#: Kind of supply -> what it makes of the oil.
SUPPLIES: Final[Mapping[str, Supply]] = MappingProxyType(
    {
        "bath": Supply(
            "an oil bath, by default up to the middle of the lowest roller", 0.5, 1.0, 0.0, 0.0, 1.0,
            f"the level from SKF's later bath drag (C); {_SKF} of a low bath, 0 of one that reaches the middle (B)",
        ),
        "splash": Supply(
            "oil that gears throw", 0.25, 1.0, 0.0, _LOW, 1.0,
            f"half of what a bath holds (D); {_SKF} of a low bath",
        ),
        "circulating": Supply(
            "oil that is pumped through", 0.5, 2.0, 0.0, _LOW, 1.0,
            f"SKF: twice the drag of a bath up to the middle of the lowest roller (A); {_SKF} of a jet",
        ),
        "jet": Supply(
            "a jet of oil", 0.5, 2.0, 0.0, _LOW, 1.0,
            f"as circulating (A), above 5e5 mm/min less, down to 3 % (C, 1 to 5 % are told); {_SKF} of a jet",
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
        doc="share phi of oil in the volume between the rings; by default that of supply and level",
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
                only = " or ".join(repr(kind) for kind in kinds)
                raise FieldError(name, f"only read for supply = {only}, not for {self.supply!r}")


class OilSupply(NamedTuple):
    """What the supply of a bearing comes to."""

    oil_fraction: float  # share phi of oil in the volume between the rings [1]
    starvation: float  # factor phi_rs of film and rolling resistance [1]
    land: float  # share of the land of the cage that oil fills [1]
    starvation_constant: float  # K_rs that it comes from [1]

    @classmethod
    def from_lubrication(
        cls,
        lubrication: Lubrication,
        boundaries: tuple[float, float],
        roller_diameter: float,
        speed: float,
        viscosity: float,
    ) -> "Supplied":
        """Return that of a bearing.

        phi = 0.40 H/(D - d) [1 + (2.6e5 nu/(n d_m^2))^1.38] of a bath, 2 times that at H = D_w/2 where oil is pumped,
        phi_rs = exp(-K_rs nu n (d + D) sqrt(K_Z/(2 (D - d)))), in mm, mm2/s and 1/min, with K_Z = 5.1.

        Examples
        --------
        A bath up to the middle of rollers of 10 mm, D - d = 40 mm: 0.40 5/40 = 0.05. A low one is starved by
        exp(-3e-8 20 3000 140 sqrt(5.1/80)) = 0.938355.

        >>> rings, n = (0.05, 0.09), 314.159265
        >>> f"{Supplied.of(Lubrication(), rings, 0.01, n, 1e-9).oil_fraction:.6f}"
        '0.050000'
        >>> f"{Supplied.of(Lubrication(oil_level=0.002), rings, 0.01, n, 20e-6).starvation:.6f}"
        '0.938355'
        """
        kind = SUPPLIES[lubrication.supply]
        (d, D) = (1e3 * one for one in boundaries)
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
            math.exp(-min(exponent, _MOST)),
            kind.land,
            K_rs,
        )


#: Exponent beyond which no oil is left in the inlets; a film of nothing has no friction.
_MOST: Final = 30.0
