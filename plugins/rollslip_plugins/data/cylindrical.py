"""Cylindrical roller bearings of standard size by their designation: boundary dimensions exact, the inside estimated.

- Bore, outside diameter and width are boundary dimensions of ISO 15, the clearance groups those of ISO 5753-1.
- What is inside, no standard says, and makers differ. It is estimated (D) by rules of each series, `RULES`: diameter
  and pitch circle of the rollers over those of the bearing, the share of the pitch circle that they fill, and length
  over width. Their numbers were read off 156 bearings, whose raceways are printed and whose rollers follow from the
  static rating by ISO 76; ``docs/scripts/bearing_catalogue.py`` holds them against these, and
  ``docs/tables/bearing_catalogue.csv`` has the errors. The diameter is rounded to one of GOST 22696.
- Types NU, NJ, NUP and N of a series differ in their ribs alone, and have the same rollers here.
- A name without a letter behind the number means the reinforced type E where there is one: that is what makers have
  listed for decades. The old type has names that end in ``-old``.
"""

import math
import re
from collections.abc import Mapping
from functools import cached_property
from typing import Final, NamedTuple

from rollslip.datasets import Bearing, BearingData, Catalogue, Family, Profile, Scatter
from rollslip_plugins.bibliography import GOST_22696, ISO_15, ISO_76, ISO_5753

#: Series of diameters -> bore, outside diameter, and the widths of its series of widths [mm] (ISO 15).
_SIZES: Final = {
    "0": (
        ("10",),
        """25 47 12, 30 55 13, 35 62 14, 40 68 15, 45 75 16, 50 80 16, 55 90 18, 60 95 18, 65 100 18, 70 110 20,
        75 115 20, 80 125 22, 85 130 22, 90 140 24, 95 145 24, 100 150 24, 105 160 26, 110 170 28, 120 180 28,
        130 200 33, 140 210 33, 150 225 35, 160 240 38, 170 260 42, 180 280 46, 190 290 46, 200 310 51""",
    ),
    "2": (
        ("2", "22"),
        """20 47 14 18, 25 52 15 18, 30 62 16 20, 35 72 17 23, 40 80 18 23, 45 85 19 23,
        50 90 20 23, 55 100 21 25, 60 110 22 28, 65 120 23 31, 70 125 24 31, 75 130 25 31, 80 140 26 33, 85 150 28 36,
        90 160 30 40, 95 170 32 43, 100 180 34 46, 105 190 36 50, 110 200 38 53, 120 215 40 58, 130 230 40 64,
        140 250 42 68, 150 270 45 73, 160 290 48 80, 170 310 52 86, 180 320 52 86, 190 340 55 92, 200 360 58 98""",
    ),
    "3": (
        ("3", "23"),
        """20 52 15 21, 25 62 17 24, 30 72 19 27, 35 80 21 31, 40 90 23 33, 45 100 25 36, 50 110 27 40,
        55 120 29 43, 60 130 31 46, 65 140 33 48, 70 150 35 51, 75 160 37 55, 80 170 39 58, 85 180 41 60, 90 190 43 64,
        95 200 45 67, 100 215 47 73, 105 225 49 77, 110 240 50 80, 120 260 55 86, 130 280 58 93, 140 300 62 102,
        150 320 65 108, 160 340 68 114, 170 360 72 120""",
    ),
    "4": (
        ("4",),
        """25 80 21, 30 90 23, 35 100 25, 40 110 27, 45 120 29, 50 130 31, 55 140 33, 60 150 35, 65 160 37, 70 180 42,
        75 190 45, 80 200 48, 85 210 52, 90 225 54, 95 240 55, 100 250 58, 105 260 60, 110 280 65, 120 310 72,
        130 340 78""",
    ),
}


class Rule(NamedTuple):
    """How the inside of a series follows from bore d, outside diameter Da and width B.

    Attributes
    ----------
    diameter : float
        Of a roller over Da - d.
    pitch : float
        Pitch diameter over (d + Da)/2.
    spacing : float
        pi d_m/(Z D).
    length : float
        Effective length of a roller over B; not a number for rollers as long as thick, less the chamfers.
    scatter : float
        Relative standard deviation of rollers times length, about zero, of the bearings that the rule was read off.
    bores : tuple of float
        From which to which bore [mm] they are.
    minimum_load : float
        k_r of SKF's least load.
    """

    diameter: float
    pitch: float
    spacing: float
    length: float
    scatter: float
    bores: tuple[float, float]
    minimum_load: float


#: Series of widths and diameters, E for the reinforced type -> rule.
RULES: Final[Mapping[str, Rule]] = {
    "2E": Rule(0.275, 1.010, 1.21, 0.605, 0.07, (20, 200), 0.15),
    "22E": Rule(0.275, 1.010, 1.22, 0.633, 0.08, (20, 150), 0.20),
    "3E": Rule(0.274, 1.012, 1.21, 0.612, 0.055, (20, 170), 0.15),
    "23E": Rule(0.274, 1.012, 1.21, 0.640, 0.06, (20, 130), 0.25),
    "2": Rule(0.245, 1.000, 1.46, math.nan, 0.04, (20, 160), 0.15),
    "3": Rule(0.249, 1.003, 1.42, math.nan, 0.055, (20, 100), 0.15),
    "4": Rule(0.240, 0.997, 1.37, 0.563, 0.065, (25, 130), 0.15),
    "10": Rule(0.243, 1.000, 1.35, math.nan, 0.045, (25, 200), 0.10),
}
#: From this bore [mm] on rollers of series 2E and 22E are thinner: over Da - d.
_LARGE: Final = (140, 0.25)
#: Diameters of standard rollers [mm].
_ROLLERS: Final = (5.5, 6, 6.5, 7, 7.5, *range(8, 27), 28, 30, 32, 34, 36, 38, 40, 42, 45, 48, 50)
#: Chamfers of both ends together [mm], from the diameter of a roller [mm] on.
_CHAMFERS: Final = ((30, 3.0), (25, 2.4), (19, 2.0), (15, 1.6), (0, 1.0))
#: Radial clearance before mounting [um]: up to which bore [mm], groups C2, CN, C3 and C4, each from and to.
_CLEARANCES: Final = (
    (30, (0, 25), (20, 45), (35, 60), (50, 75)),
    (40, (5, 30), (25, 50), (45, 70), (60, 85)),
    (50, (5, 35), (30, 60), (50, 80), (70, 100)),
    (65, (10, 40), (40, 70), (60, 90), (80, 110)),
    (80, (10, 45), (40, 75), (65, 100), (90, 125)),
    (100, (15, 50), (50, 85), (75, 110), (105, 140)),
    (120, (15, 55), (50, 90), (85, 125), (125, 165)),
    (140, (15, 60), (60, 105), (100, 145), (145, 190)),
    (160, (20, 70), (70, 120), (115, 165), (165, 215)),
    (180, (25, 75), (75, 125), (120, 170), (170, 220)),
    (200, (35, 90), (90, 145), (140, 195), (195, 250)),
)
_GROUPS: Final = ("C2", "CN", "C3", "C4")
#: Types that are offered of each series.
_TYPES: Final = {
    **dict.fromkeys(("2E", "3E"), ("NU", "NJ", "NUP", "N")),
    **dict.fromkeys(("22E", "23E"), ("NU", "NJ", "NUP")),
    "10": ("NU", "N"),
}
#: Letter for a cage (SKF, Schaeffler, NSK; C) -> what it is of; without PEEK (PH) and what differs by maker (G).
_CAGES: Final = {
    **dict.fromkeys(("P", "TVP2", "TN9", "T"), "polyamide"),
    **dict.fromkeys(("J", "W"), "steel"),
    **dict.fromkeys(("M", "M1", "MA", "M1A", "MB", "ML", "MP"), "brass"),
}
_DESIGNATION: Final = re.compile(
    r"(?P<type>NUP|NU|NJ|N)(?P<series>10|22|23|2|3|4)(?P<code>\d\d)"
    r"(?P<design>OLD|E?C?(XL)?(?P<cage>PHA?|P|J|M1?A?|M[BLP]|TVP2|TN9|T|G15|G|W)?)(?P<group>C[N234])?"
)


class Inside(NamedTuple):
    """What is estimated of the inside of a bearing [mm]."""

    rollers: int
    diameter: float
    length: float
    pitch: float


def estimated(series: str, bore: float, outside: float, width: float) -> Inside:
    """Return the inside of a bearing by the rule of its series.

    Parameters
    ----------
    series : str
        A key of `RULES`.
    bore, outside, width : float
        Boundary dimensions [mm].
    """
    rule = RULES[series]
    share = _LARGE[1] if series in ("2E", "22E") and bore >= _LARGE[0] else rule.diameter
    diameter = min(_ROLLERS, key=lambda one: abs(one - share * (outside - bore)))
    pitch = round(rule.pitch * (bore + outside)) / 2
    rollers = math.floor(math.pi * pitch / (rule.spacing * diameter) + 0.5)
    chamfers = next(both for least, both in _CHAMFERS if diameter >= least)
    length = diameter - chamfers if math.isnan(rule.length) else rule.length * width
    return Inside(rollers, float(diameter), round(length, 1), pitch)


class _Size(NamedTuple):
    series: str
    bore: int
    outside: int
    width: int


def _sizes() -> dict[tuple[str, str], _Size]:
    """Return series and code of the bore of all sizes whose rule is known, and what they are."""
    found = {}
    for widths, text in _SIZES.values():
        for line in text.split(","):
            bore, outside, *each = map(int, line.split())
            for name, width in zip(widths, each, strict=True):
                for series in (f"{name}E", name):
                    if series in RULES and RULES[series].bores[0] <= bore <= RULES[series].bores[1]:
                        found[series, f"{bore // 5:02}"] = _Size(series, bore, outside, width)
    return found


class CylindricalRollerBearings(Family):
    """Bearings of types NU, NJ, NUP and N in series 10, 2, 22, 3, 23 and 4."""

    name = "cylindrical-roller"
    description = "cylindrical roller bearings of standard size, such as NU2210E; the inside is estimated (D)"

    @cached_property
    def _sizes(self) -> dict[tuple[str, str], _Size]:
        return _sizes()

    @property
    def names(self) -> tuple[str, ...]:
        """All designations, of normal clearance."""
        return tuple(
            _name(kind, series, code, "CN") for series, code in self._sizes for kind in _TYPES.get(series, ("NU", "NJ"))
        )

    def called(self, written: str) -> str | None:
        """Return the designation behind one that is written in another way: "NU 2210 ECP/C3" is "NU2210E-C3"."""
        read = _designation(written)
        if read is None:
            return None
        number, code, old = read["series"], read["code"], read["design"] == "OLD"
        plain = number in RULES and f"{number}E" not in RULES  # there is one type of the series alone
        series = number if old or plain else f"{number}E"
        if (series, code) not in self._sizes or (old and plain) or read["type"] not in _TYPES.get(series, ("NU", "NJ")):
            return None
        return _name(read["type"], series, code, read["group"] or "CN")

    def cage(self, written: str) -> str | None:
        """Return what the cage is of by the letters behind the number: of "NU 2210 ECP" polyamide; None without one."""
        read = _designation(written)
        return None if read is None else _CAGES.get(read["cage"] or "")

    def series(self, name: str) -> str:
        """Return the series of a designation, a key of `RULES`."""
        return self._read(name)[0]

    def _read(self, name: str) -> tuple[str, str, str]:
        """Return series, code of the bore and group of clearance of a name."""
        written, _, group = name.lstrip("NUJP").partition("-C")
        number = written.removesuffix("-old").removesuffix("E")
        series = f"{number[:-2]}{'E' * written.endswith('E')}"
        return series, number[-2:], f"C{group}" if group else "CN"

    def __getitem__(self, name: str) -> BearingData:
        """Return a bearing by its designation."""
        series, code, group = self._read(name)
        return _bearing(name, self._sizes[series, code], group)


def _designation(written: str) -> re.Match[str] | None:
    """Return the parts of a designation, however it is spelled; None if it is none."""
    return _DESIGNATION.fullmatch("".join(letter for letter in written.upper() if letter.isalnum()))


def _name(kind: str, series: str, code: str, group: str) -> str:
    number = series.removesuffix("E")
    design = "E" if series != number else "-old" if f"{series}E" in RULES else ""
    return f"{kind}{number}{code}{design}{'' if group == 'CN' else f'-{group}'}"


def _bearing(name: str, size: _Size, group: str) -> BearingData:
    inside = estimated(*size)
    rule = RULES[size.series]
    spans = next(spans for bore, *spans in _CLEARANCES if size.bore <= bore)
    low, high = spans[_GROUPS.index(group)]
    shown = "x".join(f" {value:g} " for value in (size.bore, size.outside, size.width)).strip()
    return BearingData(
        name=name,
        description=(
            f"Cylindrical roller bearing {name}, {shown} mm; estimated (D): {inside.rollers} rollers of "
            f"{inside.diameter:g} x {inside.length:g} mm on {inside.pitch:g} mm"
        ),
        source=(
            "Boundary dimensions: ISO 15. Inner geometry: estimated (D) by rules of the series, read off bearings of "
            f"one maker: rollers times length scatter by {rule.scatter:.1%} there, their number is right within 1, in "
            "series 10 within 2. Makers differ by 1 or 2 rollers; ask yours, and write what differs beside the "
            f"name. Clearance: middle of group {group} of ISO 5753-1, {low} to {high} um. Profile: that of "
            "ISO/TS 16281 for rollers of unknown profile (D). Factor of the least load: SKF (A)."
        ),
        validity="Before mounting: fits, speed and temperature change the clearance, a scene gives that in operation.",
        references=(ISO_15, ISO_5753, GOST_22696, ISO_76),
        bearing=Bearing(
            rollers=inside.rollers,
            roller_diameter=round(1e-3 * inside.diameter, 7),
            roller_length=round(1e-3 * inside.length, 7),
            inner_raceway_diameter=round(1e-3 * (inside.pitch - inside.diameter), 7),
            outer_raceway_diameter=round(1e-3 * (inside.pitch + inside.diameter), 7),
            radial_clearance=round(0.5e-6 * (low + high), 9),
            profile=Profile(shape="iso16281"),
            catalogue=Catalogue(minimum_load_factor=rule.minimum_load),
        ),
        grades={
            **dict.fromkeys(
                ("rollers", "roller_diameter", "roller_length", "inner_raceway_diameter", "outer_raceway_diameter"), "D"
            ),
            "radial_clearance": "B",
            "profile": "D",
        },
        scatter=(
            Scatter(
                quantity="roller_length",
                distribution="normal",
                parameters={"scatter": rule.scatter},
                grade="(D)",
                source="rollers times length of 15 to 27 bearings of one maker against the rule of it; the number of "
                "rollers and their diameter stay as they are",
            ),
            Scatter(
                quantity="radial_clearance",
                distribution="uniform",
                parameters={"low": f"{low} um", "high": f"{high} um"},
                grade="(B)",
                source=f"group {group} of ISO 5753-1, before mounting",
            ),
        ),
    )


CATALOGUE: Final = CylindricalRollerBearings()
