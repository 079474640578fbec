"""Oil supply of a bearing: the oil content of its interior, and the layer of oil that its contacts find.

- The kinds of supply are one table, `SUPPLIES`; values that a scene states replace those of the table.
- SKF's formulas are in mm, mm2/s and 1/min and are evaluated in these units; arguments and results are SI.
- All results are accurate to a factor only: the oil content was measured in few bearings, and in none of these.

Source: SKF, general catalogue 6000 (2006), friction: the drag of a bath.
"""

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Final, NamedTuple

import attrs
from attrs.validators import optional

from rollslip.fields import (
    FieldError,
    Scatter,
    choice_of,
    field,
    non_negative,
    positive,
    within_possible,
)

__all__ = ["DENSITY", "PLENTY", "PUMPED", "SUPPLIES", "Lubrication", "OilSupply", "Supply"]

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
#: Oil on both surfaces together that limits no film [m]. Doubling it changes nothing. Chosen: it exceeds all gaps.
PLENTY: Final = 1.0
#: Oil on both surfaces together before a contact where oil is plentiful [m] (D). Chosen: with 2 to 10 um rollers resist
#: as much as SKF's formula of the friction torque has it.
_PLENTIFUL_LAYER: Final = 5e-6
#: The same where oil is thrown [m] (D). Chosen: between the other two.
_THROWN_LAYER: Final = 3e-6
#: The same where oil is scarce [m] (D). Chosen: without supply a layer halves with each roller that passes, and ends at
#: the films that rollers bring from the loaded zone, 0.3 to 2 um.
_SCARCE_LAYER: Final = 1e-6


class Supply(NamedTuple):
    """Oil content and oil layer of a kind of supply."""

    #: Description, for texts.
    description: str
    #: Assumed oil level over the roller diameter [1]; 0 where there is no level.
    level: float
    #: Oil content over that of a bath with this level [1].
    times: float
    #: Oil content phi of the volume between the rings where there is no level [1].
    fraction: float
    #: Oil on both surfaces together before a contact [m].
    layer: float
    #: Fraction of the land of a ring-guided cage that oil fills [1].
    land: float
    #: Source of the numbers, with their grades.
    source: str


#: Kind of supply -> its oil content and oil layer.
SUPPLIES: Final[Mapping[str, Supply]] = MappingProxyType(
    {
        "bath": Supply(
            "an oil bath, by default up to the middle of the lowest roller", 0.5, 1.0, 0.0, _PLENTIFUL_LAYER, 1.0,
            "the level from SKF's later bath drag (C); the layer from friction torques (D)",
        ),
        "splash": Supply(
            "oil that gears throw", 0.25, 1.0, 0.0, _THROWN_LAYER, 1.0,
            "half the level of a bath (D); the layer between those of a bath and of mist (D)",
        ),
        "circulating": Supply(
            "oil that is pumped through", 0.5, 2.0, 0.0, _PLENTIFUL_LAYER, 1.0,
            "SKF: twice the drag of a bath up to the middle of the lowest roller (A); the layer of a bath (D)",
        ),
        "jet": Supply(
            "a jet of oil", 0.5, 2.0, 0.0, _PLENTIFUL_LAYER, 1.0,
            "as circulating (A), above 5e5 mm/min less, to 3 % (C, 1 to 5 % are reported); the layer of a bath (D)",
        ),
        "mist": Supply(
            "oil with air, or drops", 0.0, 1.0, 0.01, _SCARCE_LAYER, 0.25,
            "1 % of the volume, a quarter of the land (D); the layer of films from the loaded zone (D)",
        ),
        "grease": Supply(
            "grease that is run in, with the viscosity of its base oil", 0.0, 1.0, 0.0, _SCARCE_LAYER, 0.0,
            "no oil between rollers and on the land (D); the layer of films from the loaded zone (D)",
        ),
    }
)  # fmt: skip
_WITH_LEVEL = tuple(name for name, kind in SUPPLIES.items() if kind.level and kind.times == 1.0)
#: Kinds of supply whose oil is pumped through the bearing: by default models.thermal estimates its flow.
PUMPED: Final = ("circulating", "jet")
_WITH_FLOW = ("splash", *PUMPED)


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
        doc="flow of oil through the bearing, which carries off heat; by default models.thermal estimates that of "
        "pumped oil (D)",
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
    oil_layer: float | None = field(
        default=None,
        unit="m",
        doc="oil on both surfaces together before a contact; by default that of the supply",
        validator=optional(within_possible),
        keywords={"plenty": PLENTY},
        usual=(1e-7, 1e-3),
        possible=(1e-12, PLENTY),
        scatter=Scatter(
            distribution="lognormal",
            parameters={"deviation_of_ln": 1.0},
            grade="(D)",
            source="friction torques of bearings agree with 2 to 10 um; no layer was measured in these bearings",
        ),
    )

    def __attrs_post_init__(self) -> None:
        for name, kinds in (("oil_level", _WITH_LEVEL), ("oil_flow", _WITH_FLOW)):
            if getattr(self, name) is not None and self.supply not in kinds:
                only = " or ".join(map(repr, kinds))
                raise FieldError(name, f"only read for supply = {only}, not for {self.supply!r}")


class OilSupply(NamedTuple):
    """Oil content and oil layer of a bearing in operation."""

    #: Oil content phi of the volume between the rings [1].
    oil_fraction: float
    #: Oil on both surfaces together before a contact [m].
    oil_layer: float
    #: Fraction of the land of the cage that oil fills [1].
    land: float

    @classmethod
    def from_lubrication(
        cls,
        lubrication: Lubrication,
        boundaries: tuple[float, float],
        roller_diameter: float,
        speed: float,
        viscosity: float,
    ) -> "OilSupply":
        """Return oil content and oil layer of a bearing.

        phi = 0.40 H/(D - d) [1 + (2.6e5 nu/(n d_m^2))^1.38] of a bath, 2 times that at H = D_w/2 where oil is pumped,
        in mm, mm2/s and 1/min. A bath below the middle of the lowest roller has the layer of splash.

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
        A bath up to the middle of rollers of 10 mm, D - d = 40 mm: 0.40 5/40 = 0.05.

        >>> rings, n = (0.05, 0.09), 314.159265
        >>> f"{OilSupply.from_lubrication(Lubrication(), rings, 0.01, n, 1e-9).oil_fraction:.6f}"
        '0.050000'
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
        layer = kind.layer
        if lubrication.supply == "bath" and level < 0.5 * roller_diameter:
            layer = _THROWN_LAYER
        return cls(
            min(phi, 1.0) if lubrication.oil_fraction is None else lubrication.oil_fraction,
            layer if lubrication.oil_layer is None else lubrication.oil_layer,
            kind.land,
        )
