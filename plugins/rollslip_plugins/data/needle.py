"""Needle roller bearings by their designation: boundary dimensions exact, the inside estimated.

- "NK 20/16" has a machined ring and no inner one, "NKI 20/16" one of each, "HK 2016" is a drawn cup. Without an inner
  ring rollers run on the shaft: its material is ``bearing.inner_raceway.material``, its roughness that of the surface.
- Bore or circle under the rollers, outside diameter and width are those that makers list (recalled, C); those of drawn
  cups are in ISO 3245. Rollers stand in a cage.
- Without an inner ring the clearance is what the shaft leaves of the circle under the rollers, F6 of machined rings, F7
  of cups that are pressed in (C), with a shaft h5 (ISO 286). A drawn cup takes the shape of the housing.
- The inside is estimated (D): the diameter of a needle is a fraction of the section, rounded to one of ISO 3096; the
  distance on the pitch circle is larger by a fixed fraction, for the cage; the length is a fraction of the width. The
  fractions give the static ratings of NK 20/16 (25.5 kN), NK 40/20 (57 kN) and HK 2016 (20.1 kN), which are recalled
  (C), by ISO 76 to 10 %.
"""

import math
import re
from functools import cached_property
from typing import Final, NamedTuple

from rollslip.datasets import BearingData, Family, OwnCage, Scatter
from rollslip.geometry.bearing import Bearing, Catalogue, Mounting
from rollslip.geometry.surfaces import Profile, Raceway
from rollslip_plugins.bibliography import ISO_76, ISO_286, ISO_3096, ISO_3245, ISO_5753
from rollslip_plugins.data import PROFILE_DEPTH
from rollslip_plugins.data.cylindrical import clearance
from rollslip_plugins.data.designations import packed

#: Circle under the rollers or bore, outside diameter, widths [mm] (C).
_SIZES: Final = {
    "NK": """10 17 12 16, 12 19 12 16, 14 22 16 20, 15 23 16 20, 16 24 16 20, 17 25 16 20, 18 26 16 20, 19 27 16 20,
        20 28 16 20, 21 29 16 20, 22 30 16 20, 24 32 16 20, 25 33 16 20, 26 34 16 20, 28 37 20 30, 29 38 20 30,
        30 40 20 30, 32 42 20 30, 35 45 20 30, 37 47 20 30, 38 48 20 30, 40 50 20 30, 42 52 20 30, 43 53 20 30,
        45 55 20 30, 47 57 20 30, 50 62 25 35, 55 68 25 35, 60 72 25 35, 65 78 25 35, 70 85 25 35, 75 92 25 35,
        80 95 25 35, 85 105 25 35, 90 110 25 35, 95 115 26 36, 100 120 26 36""",
    "NKI": """10 22 16 20, 12 24 16 20, 15 27 16 20, 17 29 16 20, 20 32 16 20, 22 34 16 20, 25 38 20 30, 28 42 20 30,
        30 45 20 30, 32 47 20 30, 35 50 20 30, 38 53 20 30, 40 55 20 30, 42 57 20 30, 45 62 25 35, 50 68 25 35,
        55 72 25 35""",
    "HK": """8 12 8 10, 10 14 10 12 15, 12 18 12 16, 14 20 12 16, 15 21 12 16 22, 16 22 12 16 22, 18 24 12 16,
        20 26 10 12 16 20 30, 22 28 10 12 16 20, 25 32 12 16 20 26 38, 28 35 16 20, 30 37 12 16 20 26 38,
        35 42 12 16 20, 40 47 12 16 20, 45 52 12 16 20, 50 58 20 25, 55 63 20 28, 60 68 12 20 30""",
}
#: Diameters of needles [mm] (ISO 3096).
_NEEDLES: Final = (1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0)


class _Rule(NamedTuple):
    """How the inside of a bearing follows from its boundary dimensions."""

    #: Diameter of a needle over half of outside diameter less circle under the rollers.
    needle: float
    spacing: float  # from one needle to the next, over its diameter
    length: float  # of a needle over the width
    grade: int  # of the circle under the rollers, a tolerance F


#: Kind of bearing -> rule (D), from recalled static ratings.
_RULES: Final = {"NK": _Rule(0.62, 1.35, 0.75, 6), "HK": _Rule(0.67, 1.45, 0.68, 7)}
#: Fundamental deviation F and tolerances IT5, IT6, IT7 [um] up to a diameter [mm], ISO 286-1.
_LIMITS: Final = (
    (10, 13, 6, 9, 15), (18, 16, 8, 11, 18), (30, 20, 9, 13, 21), (50, 25, 11, 16, 25), (80, 30, 13, 19, 30),
    (120, 36, 15, 22, 35),
)  # fmt: skip
#: Relative standard deviation of rollers times length (D).
_SCATTER: Final = 0.15


class _Size(NamedTuple):
    """Kind and boundary dimensions of a bearing [mm]."""

    kind: str
    bore: int
    outside: int
    width: int


class NeedleBearings(Family):
    """Needle roller bearings NK and NKI with machined rings, and drawn cups HK."""

    name = "needle-roller"
    description = (
        "needle roller bearings, such as NK20/16, NKI20/16 or HK2016; the inside is estimated (D)"
    )

    @cached_property
    def _sizes(self) -> dict[str, _Size]:
        """Designation -> boundary dimensions."""
        sizes = dict[str, _Size]()
        for kind, text in _SIZES.items():
            for bore, outside, *widths in (map(int, line.split()) for line in text.split(",")):
                for width in widths:
                    name = f"HK{bore:02}{width:02}" if kind == "HK" else f"{kind}{bore}/{width}"
                    sizes[name] = _Size(kind, bore, outside, width)
        return sizes

    @cached_property
    def _packed(self) -> dict[str, str]:
        """Designation without separators -> designation."""
        return {packed(name): name for name in self._sizes}

    @property
    def names(self) -> tuple[str, ...]:
        """All designations."""
        return tuple(self._sizes)

    def canonical_name(self, written: str) -> str | None:
        """Return the designation of the catalogue for another spelling: "NK20/16" for "INA NK20/16-XL"."""
        return self._packed.get(re.sub(r"(T[NV])?(XL|B)?$", "", packed(written)))

    def cage(self, written: str) -> OwnCage | None:
        """Return the cage, guided by the rollers: of polyamide by TN or TV, else of sheet steel."""
        if self.canonical_name(written) is None:
            return None
        plastic = re.search(r"T[NV](?=(?:XL|B)?$)", packed(written))
        return OwnCage("polyamide", "roller", plastic[0]) if plastic else OwnCage("steel", "roller")

    def __getitem__(self, name: str) -> BearingData:
        """Return a bearing by its designation."""
        return _bearing(name, self._sizes[name])


def _bearing(name: str, size: _Size) -> BearingData:
    """Return the data of a bearing by its boundary dimensions."""
    kind, bore, outside, width = size
    under = bore if kind != "NKI" else NKI_CIRCLES[bore]
    rule = _RULES["HK" if kind == "HK" else "NK"]
    estimate = rule.needle * (outside - under) / 2.0
    diameter = min(_NEEDLES, key=lambda standard: abs(standard - estimate))
    rollers = math.floor(math.pi * (under + diameter) / (rule.spacing * diameter))
    length = round(rule.length * width, 1)
    if kind == "NKI":
        low, high = clearance(bore, "CN")
        source = f"clearance: middle of group CN of ISO 5753-1, {low:g} to {high:g} um"
    else:
        _, low, h5, *circle = next(row for row in _LIMITS if under <= row[0])
        high = low + circle[rule.grade - 6] + h5
        source = (
            f"clearance: circle under the rollers F{rule.grade}, shaft h5, {low:g} to {high:g} um"
        )
    of = "" if kind == "NKI" else ", on the shaft"
    return BearingData(
        name=name,
        description=(
            f"{'Drawn cup needle' if kind == 'HK' else 'Needle'} roller bearing {name}, {bore} x {outside} x {width} "
            f"mm; estimated (D): {rollers} rollers of {diameter:g} x {length:g} mm{of}"
        ),
        source=(
            "Boundary dimensions: makers' lists (C). Inner geometry: estimated (D), needles by fractions of section "
            "and width that give three recalled static ratings; rollers times length are known to about "
            f"{_SCATTER:.0%}; "
            f"{source}. Profile: that of ISO/TS 16281 for rollers of unknown profile (D)."
        ),
        validity="Before mounting: a scene says what fits, speed and temperature leave of the clearance.",
        references=(ISO_3245, ISO_3096, ISO_5753, ISO_286, ISO_76),
        bearing=Bearing(
            rollers=rollers,
            roller_diameter=round(1e-3 * diameter, 7),
            roller_length=round(1e-3 * length, 7),
            inner_raceway_diameter=round(1e-3 * under, 7),
            outer_raceway_diameter=round(1e-3 * (under + 2.0 * diameter), 7),
            radial_clearance=round(0.5e-6 * (low + high), 9),
            mounting=Mounting(initial_tolerance=round(1e-6 * (high - low), 9)),
            inner_raceway=None if kind == "NKI" else Raceway(without_ring=True),
            outer_raceway=Raceway(without_ring=True) if kind == "HK" else None,
            profile=Profile(shape="iso16281"),
            catalogue=Catalogue(
                bore=round(1e-3 * bore, 7) if kind == "NKI" else None,
                outside_diameter=round(1e-3 * outside, 7),
                width=round(1e-3 * width, 7),
            ),
        ),
        grades={
            **dict.fromkeys(
                ("rollers", "roller_diameter", "roller_length", "outer_raceway_diameter"), "D"
            ),
            "inner_raceway_diameter": "C",
            "radial_clearance": "C",
            "profile": "D",
        },
        scatter=(
            Scatter(
                quantity="roller_length",
                distribution="normal",
                parameters={"scatter": _SCATTER},
                grade="(D)",
                source="rollers times length, of which three recalled static ratings are all that is known",
            ),
            PROFILE_DEPTH,
        ),
    )


#: Bore of an inner ring -> circle under the rollers [mm] (C).
NKI_CIRCLES: Final = {
    10: 14, 12: 16, 15: 19, 17: 21, 20: 24, 22: 26, 25: 29, 28: 32, 30: 35, 32: 37, 35: 40, 38: 43, 40: 45, 42: 47,
    45: 50, 50: 55, 55: 60,
}  # fmt: skip
CATALOGUE: Final = NeedleBearings()
