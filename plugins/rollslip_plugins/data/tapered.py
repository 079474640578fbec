"""Single-row tapered roller bearings of metric series by their designation: boundaries recalled, the inside estimated.

- Bore, outside diameter, widths T, B, C and the factor e are those of ISO 355 as makers print them (recalled, C). Of 27
  bearings up to a bore of 35 mm dimensions and the class of the angle are those that a maker prints
  (``tools/references/tapered_ratings.csv``). The contact angle, that of the outer raceway, follows from e = 1.5
  tan(angle); e has two digits, so that the angle is right to 0.2 deg.
- Makers do not print the inside, and it is estimated (D). Rollers have a diameter at their middle of a quarter of the
  difference of both boundary diameters, on a pitch circle of 0.99 of the mean of these, with a spacing of 1.22
  diameters; their length is a fraction of the width B of the inner ring by series, read off printed static ratings by
  ISO 76, which come out 0.91 to 1.15 times as large, 0.99 in the mean with a standard deviation of 5 %. The 32216 of
  Wingertszahn and others (2023) has 16 rollers of 17 x 20.7 mm on 108.5 mm, here 17 of 15.6 x 24.8 mm on 108.9 mm.
- "SKF 32216 J2/Q", "FAG 32216-A", "HR 32216 J", "4T-32216" are one bearing. Letters that change the contact angle (B,
  C, D) are not known here, and inch series are refused by their name.
"""

import math
import re
from functools import cached_property
from typing import Final, NamedTuple

from rollslip.datasets import BearingData, Family, OwnCage, Scatter
from rollslip.geometry.axial import ContactAngles, raceway_diameters
from rollslip.geometry.bearing import Bearing, Catalogue
from rollslip.geometry.surfaces import Profile
from rollslip_plugins.bibliography import ISO_76, ISO_355
from rollslip_plugins.data import PROFILE_DEPTH
from rollslip_plugins.data.designations import packed

__all__ = ["CATALOGUE", "TaperedRollerBearings"]


class _Size(NamedTuple):
    """Boundary dimensions of a bearing [mm] and its factor e."""

    bore: float
    outside: float
    assembled_width: float  # T
    width: float  # B, of the inner ring
    outer_width: float  # C, of the outer ring
    axial_factor: float  # e


#: Series -> bore, outside diameter, widths T, B, C [mm] and factor e (ISO 355; C).
_SIZES: Final = {
    "302": """17 40 13.25 12 11 .35, 20 47 15.25 14 12 .35, 25 52 16.25 15 13 .37, 30 62 17.25 16 14 .37,
        35 72 18.25 17 15 .37, 40 80 19.75 18 16 .37, 45 85 20.75 19 16 .40, 50 90 21.75 20 17 .42,
        55 100 22.75 21 18 .40, 60 110 23.75 22 19 .40, 65 120 24.75 23 20 .40, 70 125 26.25 24 21 .42,
        75 130 27.25 25 22 .43, 80 140 28.25 26 22 .42, 85 150 30.5 28 24 .42, 90 160 32.5 30 26 .42,
        95 170 34.5 32 27 .42, 100 180 37 34 29 .42, 110 200 41 38 32 .42, 120 215 43.5 40 34 .43""",
    "303": """17 47 15.25 14 12 .28, 20 52 16.25 15 13 .30, 25 62 18.25 17 15 .30, 30 72 20.75 19 16 .31,
        35 80 22.75 21 18 .31, 40 90 25.25 23 20 .35, 45 100 27.25 25 22 .35, 50 110 29.25 27 23 .35,
        55 120 31.5 29 25 .35, 60 130 33.5 31 26 .35, 65 140 36 33 28 .35, 70 150 38 35 30 .35, 75 160 40 37 31 .35,
        80 170 42.5 39 33 .35, 85 180 44.5 41 34 .35, 90 190 46.5 43 36 .35, 95 200 49.5 45 38 .35,
        100 215 51.5 47 39 .35, 110 240 54.5 50 42 .35, 120 260 59.5 55 46 .35""",
    "313": """25 62 18.25 17 13 .83, 30 72 20.75 19 14 .83, 35 80 22.75 21 15 .83, 40 90 25.25 23 17 .83,
        45 100 27.25 25 18 .83, 50 110 29.25 27 19 .83, 55 120 31.5 29 21 .83, 60 130 33.5 31 22 .83,
        65 140 36 33 23 .83, 70 150 38 35 25 .83, 75 160 40 37 26 .83, 80 170 42.5 39 27 .83,
        85 180 44.5 41 28 .83, 90 190 46.5 43 30 .83, 95 200 49.5 45 32 .83, 100 215 56.5 51 35 .83""",
    "320": """20 42 15 15 12 .37, 25 47 15 15 11.5 .43, 30 55 17 17 13 .43, 35 62 18 18 14 .45, 40 68 19 19 14.5 .38,
        45 75 20 20 15.5 .39, 50 80 20 20 15.5 .42, 55 90 23 23 17.5 .41, 60 95 23 23 17.5 .43, 65 100 23 23 17.5 .46,
        70 110 25 25 19 .43, 75 115 25 25 19 .46, 80 125 29 29 22 .42, 85 130 29 29 22 .44, 90 140 32 32 24 .42,
        95 145 32 32 24 .44, 100 150 32 32 24 .46, 105 160 35 35 26 .44, 110 170 38 38 29 .43, 120 180 38 38 29 .46,
        130 200 45 45 34 .43, 140 210 45 45 34 .46, 150 225 48 48 36 .46""",
    "322": """30 62 21.25 20 17 .37, 35 72 24.25 23 19 .37, 40 80 24.75 23 19 .37, 45 85 24.75 23 19 .40,
        50 90 24.75 23 19 .42, 55 100 26.75 25 21 .40, 60 110 29.75 28 24 .40, 65 120 32.75 31 27 .40,
        70 125 33.25 31 27 .42, 75 130 33.25 31 27 .43, 80 140 35.25 33 28 .42, 85 150 38.5 36 30 .42,
        90 160 42.5 40 34 .42, 95 170 45.5 43 37 .42, 100 180 49 46 39 .42, 110 200 56 53 46 .42,
        120 215 61.5 58 50 .43""",
    "323": """20 52 22.25 21 18 .30, 25 62 25.25 24 20 .30, 30 72 28.75 27 23 .31, 35 80 32.75 31 25 .31,
        40 90 35.25 33 27 .35, 45 100 38.25 36 30 .35, 50 110 42.25 40 33 .35, 55 120 45.5 43 35 .35,
        60 130 48.5 46 37 .35, 65 140 51 48 39 .35, 70 150 54 51 42 .35, 75 160 58 55 45 .35, 80 170 61.5 58 48 .35,
        85 180 63.5 60 49 .35, 90 190 67.5 64 53 .35, 95 200 71.5 67 55 .35, 100 215 77.5 73 60 .35""",
    "330": """25 47 17 17 14 .29, 30 55 20 20 16 .29, 35 62 21 21 17 .31, 40 68 22 22 18 .28, 45 75 24 24 19 .29,
        50 80 24 24 19 .32, 55 90 27 27 21 .31, 60 95 27 27 21 .33, 65 100 27 27 21 .35, 70 110 31 31 25.5 .28,
        75 115 31 31 25.5 .30, 80 125 36 36 29.5 .28, 85 130 36 36 29.5 .29, 90 140 39 39 32.5 .27,
        95 145 39 39 32.5 .28, 100 150 39 39 32.5 .29""",
    "331": """40 75 26 26 20.5 .36, 45 80 26 26 20.5 .38, 50 85 26 26 20 .41, 55 95 30 30 23 .37, 60 100 30 30 23 .40,
        65 110 34 34 26.5 .39, 70 120 37 37 29 .38, 75 125 37 37 29 .40, 80 130 37 37 29 .42, 85 140 41 41 32 .41,
        90 150 45 45 35 .40""",
    "332": """25 52 22 22 18 .35, 30 62 25 25 19.5 .34, 35 72 28 28 22 .35, 40 80 32 32 25 .36, 45 85 32 32 25 .39,
        50 90 32 32 24.5 .41, 55 100 35 35 27 .40, 60 110 38 38 29 .40, 65 120 41 41 32 .39, 70 125 41 41 32 .41,
        75 130 41 41 31 .43, 80 140 46 46 35 .43, 85 150 49 49 37 .42, 90 160 55 55 42 .42, 95 170 58 58 44 .41,
        100 180 63 63 48 .40""",
}
#: Series -> effective length of the rollers over the width B (D), the mean over the printed static ratings of each
#: series by ISO 76. Series 331 has none, and takes that of 330 and 332.
_LENGTHS: Final = {
    "302": 0.71, "303": 0.76, "313": 0.76, "320": 0.72, "322": 0.75, "323": 0.76, "330": 0.75, "331": 0.76, "332": 0.80,
}  # fmt: skip
#: Diameter of a roller at its middle over the difference of outside diameter and bore (D): dynamic over static ratings
#: are met within 5 % by 0.24 to 0.28; the 32216 of Wingertszahn and others (2023) has 0.28.
_DIAMETER = 0.26
#: Pitch diameter at the middle of the rollers over the mean of bore and outside diameter (D); 0.986 in that 32216.
_PITCH = 0.99
#: From one roller to the next on the pitch circle, over the diameter (D); it is 1.25 in that 32216, in which fewer
#: rollers than makers print ratings for are counted.
_SPACING = 1.22
#: Relative standard deviation of rollers times length (D): 0.05 of one maker's static ratings about the fractions
#: above, and more as makers differ.
_SCATTER = 0.08
#: Pattern of a packed designation; letters behind the number state cage, precision and quality alone.
_WRITTEN: Final = re.compile(
    r"(?:HR|4T|ET|E|T)?(?P<series>302|303|313|320|322|323|330|331|332)(?P<code>\d\d)X?(?P<tail>(?:J2?|Q|A|XL|U|P[0456]X?|VQ?)*)"
)


class TaperedRollerBearings(Family):
    """Bearings of the metric series 302, 303, 313, 320, 322, 323, 330, 331 and 332."""

    name = "tapered-roller"
    description = "single-row tapered roller bearings of metric series, such as 32216; the inside is estimated (D)"

    @cached_property
    def _sizes(self) -> dict[tuple[str, str], _Size]:
        """Boundary dimensions of every size, by series and code of the bore."""
        sizes = {}
        for series, text in _SIZES.items():
            for line in text.split(","):
                size = _Size(*map(float, line.split()))
                code = "03" if size.bore == 17 else f"{round(size.bore) // 5:02}"
                sizes[series, code] = size
        return sizes

    @property
    def names(self) -> tuple[str, ...]:
        """All designations."""
        return tuple(_name(series, code) for series, code in self._sizes)

    def _read(self, written: str) -> tuple[str, str] | None:
        """Return series and code of the bore; None of another bearing."""
        if (match := _WRITTEN.fullmatch(packed(written))) is None:
            return None
        key = match["series"], match["code"]
        return key if key in self._sizes else None

    def canonical_name(self, written: str) -> str | None:
        """Return the designation of the catalogue for another spelling: "32216" for "SKF 32216 J2/Q"."""
        read = self._read(written)
        return read and _name(*read)

    def cage(self, written: str) -> OwnCage | None:
        """Return the usual cage, of pressed steel on the rollers."""
        return None if self._read(written) is None else OwnCage("steel", "roller")

    def ignored(self, written: str) -> str:
        """Return the letters behind a designation, which have no effect; empty without any."""
        match = _WRITTEN.fullmatch(packed(written))
        return "" if match is None or self._read(written) is None else match["tail"]

    def __getitem__(self, name: str) -> BearingData:
        """Return a bearing by its designation."""
        if (read := self._read(name)) is None:
            raise KeyError(name)
        return _bearing(name, read[0], self._sizes[read])


def _name(series: str, code: str) -> str:
    """Return the designation of a bearing, with the X of series 320 where makers print it."""
    return f"{series}{code}{'X' * (series == '320')}"


def _bearing(name: str, series: str, size: _Size) -> BearingData:
    """Return the data of a bearing by its boundary dimensions."""
    angle = math.atan(size.axial_factor / 1.5)
    diameter = round(_DIAMETER * (size.outside - size.bore), 1)
    pitch = round(_PITCH * (size.bore + size.outside) / 2.0, 1)
    rollers = math.floor(math.pi * pitch / (_SPACING * diameter))
    length = round(_LENGTHS[series] * size.width, 1)
    angles = ContactAngles.with_common_apex(angle, diameter / pitch)
    inner, outer = raceway_diameters(pitch, diameter, angles)
    shown = f"{size.bore:g} x {size.outside:g} x {size.assembled_width:g}"
    return BearingData(
        name=name,
        description=(
            f"Tapered roller bearing {name}, {shown} mm, e = {size.axial_factor:.2f}; estimated (D): {rollers} rollers "
            f"of {diameter:g} x {length:g} mm on {pitch:g} mm"
        ),
        source=(
            "Boundary dimensions and e: ISO 355 as makers print them, recalled (C). Inner geometry: estimated (D), the "
            f"length by printed static ratings: rollers times length are known to about {_SCATTER:.0%}. Makers differ "
            "by 1 or 2 rollers; ask yours, and write what differs beside the name. Contact angle of the outer raceway: "
            "e = 1.5 tan(angle). Profile: that of ISO/TS 16281 for rollers of unknown profile (D)."
        ),
        validity="Under an axial load, which presses the rings together.",
        references=(ISO_355, ISO_76),
        bearing=Bearing(
            rollers=rollers,
            roller_diameter=round(1e-3 * diameter, 7),
            roller_length=round(1e-3 * length, 7),
            inner_raceway_diameter=round(1e-3 * inner, 7),
            outer_raceway_diameter=round(1e-3 * outer, 7),
            contact_angle=angle,
            stated_pitch_diameter=round(1e-3 * pitch, 7),
            profile=Profile(shape="iso16281"),
            catalogue=Catalogue(
                series=series,
                bore=round(1e-3 * size.bore, 7),
                outside_diameter=round(1e-3 * size.outside, 7),
                width=round(1e-3 * size.assembled_width, 7),
            ),
        ),
        grades={
            **dict.fromkeys(
                (
                    "rollers",
                    "roller_diameter",
                    "roller_length",
                    "inner_raceway_diameter",
                    "outer_raceway_diameter",
                    "pitch_diameter",
                ),
                "D",
            ),
            "contact_angle": "C",
            "profile": "D",
        },
        scatter=(
            Scatter(
                quantity="roller_length",
                distribution="normal",
                parameters={"scatter": _SCATTER},
                grade="(D)",
                source="rollers times length of one maker's printed static ratings against the rule of the series",
            ),
            PROFILE_DEPTH,
        ),
    )


CATALOGUE: Final = TaperedRollerBearings()
