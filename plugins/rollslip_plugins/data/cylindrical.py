"""Cylindrical roller bearings of standard size by their designation: boundary dimensions exact, the inside estimated.

- Bore, outside diameter and width are boundary dimensions of ISO 15, the clearance groups those of ISO 5753-1.
- No standard gives the inside, and makers differ. It is estimated (D) by rules of each series, `RULES`: diameter
  and pitch circle of the rollers over those of the bearing; the pitch between two rollers, which is a fraction of their
  diameter and a bar that gets no thinner than its fixed part; and the length, a fraction of the width less what two
  ribs and two chamfers take of any bearing. The rules were read off 156 bearings of one maker, whose raceways are
  printed and whose rollers follow from the static rating by ISO 76, the lengths off the printed ratings of two makers;
  ``docs/scripts/bearing_catalogue.py`` holds them against these, and ``docs/tables/bearing_catalogue.csv`` has the
  errors. The diameter is rounded to one of GOST 22696, above 50 mm to one of the steps that would follow.
- Types NU, NJ, NUP and N of a series differ in their ribs alone, and have the same rollers here. NJ and NUP have ribs
  on opposite sides of both rings; their contacts with rollers are estimated (D): `rollslip.geometry.axial.RIB_HEIGHT`.
- A name without a letter behind the number means the reinforced type E where there is one: that is what makers have
  listed for decades. The old type has names that end in ``-old``. In series 10 makers list both today, and a name means
  what it says: NU1010 has rollers as long as thick, NU1010E longer ones on the same raceways.
"""

import math
from collections.abc import Mapping
from functools import cached_property
from typing import Final, NamedTuple

from rollslip.datasets import BearingData, Family, OwnCage, Scatter
from rollslip.geometry.axial import RIB_ANGLE, RIB_HEIGHT, Ribs
from rollslip.geometry.bearing import Bearing, Catalogue, Mounting
from rollslip.geometry.surfaces import Profile
from rollslip_plugins.bibliography import GOST_22696, ISO_15, ISO_76, ISO_5753
from rollslip_plugins.data import PROFILE_DEPTH, RIB_SCATTER
from rollslip_plugins.data.designations import other_bearing, read_designation

#: Series of diameters -> bore, outside diameter, and the widths of its series of widths [mm] (ISO 15).
_SIZES: Final = {
    "0": (
        ("10",),
        """25 47 12, 30 55 13, 35 62 14, 40 68 15, 45 75 16, 50 80 16, 55 90 18, 60 95 18, 65 100 18, 70 110 20,
        75 115 20, 80 125 22, 85 130 22, 90 140 24, 95 145 24, 100 150 24, 105 160 26, 110 170 28, 120 180 28,
        130 200 33, 140 210 33, 150 225 35, 160 240 38, 170 260 42, 180 280 46, 190 290 46, 200 310 51, 220 340 56,
        240 360 56, 260 400 65, 280 420 65, 300 460 74, 320 480 74, 340 520 82, 360 540 82, 380 560 82, 400 600 90,
        420 620 90, 440 650 94, 460 680 100, 480 700 100""",
    ),
    "2": (
        ("2", "22"),
        """15 35 11 14, 17 40 12 16, 20 47 14 18, 25 52 15 18, 30 62 16 20, 35 72 17 23, 40 80 18 23, 45 85 19 23,
        50 90 20 23, 55 100 21 25, 60 110 22 28, 65 120 23 31, 70 125 24 31, 75 130 25 31, 80 140 26 33, 85 150 28 36,
        90 160 30 40, 95 170 32 43, 100 180 34 46, 105 190 36 50, 110 200 38 53, 120 215 40 58, 130 230 40 64,
        140 250 42 68, 150 270 45 73, 160 290 48 80, 170 310 52 86, 180 320 52 86, 190 340 55 92, 200 360 58 98,
        220 400 65 108, 240 440 72 120, 260 480 80 130, 280 500 80 130, 300 540 85 140, 320 580 92 150""",
    ),
    "3": (
        ("3", "23"),
        """17 47 14 19, 20 52 15 21, 25 62 17 24, 30 72 19 27, 35 80 21 31, 40 90 23 33, 45 100 25 36, 50 110 27 40,
        55 120 29 43, 60 130 31 46, 65 140 33 48, 70 150 35 51, 75 160 37 55, 80 170 39 58, 85 180 41 60, 90 190 43 64,
        95 200 45 67, 100 215 47 73, 105 225 49 77, 110 240 50 80, 120 260 55 86, 130 280 58 93, 140 300 62 102,
        150 320 65 108, 160 340 68 114, 170 360 72 120, 180 380 75 126, 190 400 78 132, 200 420 80 138,
        220 460 88 145, 240 500 95 155, 260 540 102 165, 280 580 108 175""",
    ),
    "4": (
        ("4",),
        """25 80 21, 30 90 23, 35 100 25, 40 110 27, 45 120 29, 50 130 31, 55 140 33, 60 150 35, 65 160 37, 70 180 42,
        75 190 45, 80 200 48, 85 210 52, 90 225 54, 95 240 55, 100 250 58, 105 260 60, 110 280 65, 120 310 72,
        130 340 78, 140 360 82, 150 380 85""",
    ),
}


class Rule(NamedTuple):
    """How the inside of a series follows from bore d, outside diameter Da and width B."""

    diameter: float  # of a roller over Da - d
    pitch: float  # pitch diameter over (d + Da)/2
    #: spacing, bar: From one roller to the next on the pitch circle: spacing times D, and a bar [mm].
    spacing: float
    bar: float
    #: length, ends: Effective length of a roller: length times B, less the ends [mm]; length is not a number for
    #: rollers as long as thick, less the chamfers.
    length: float
    ends: float
    #: Relative standard deviation of rollers times length, about zero, of the bearings that the rule was read off.
    scatter: float
    bores: tuple[float, float]  # from which to which bore [mm] makers list them
    minimum_load: float  # k_r of the minimum load of SKF
    #: Bore [mm] of large bearings, and the diameter of their rollers over Da - d.
    large: tuple[float, float] = (math.inf, 0.0)


#: Series of widths and diameters, E for the reinforced type -> rule.
RULES: Final[Mapping[str, Rule]] = {
    "2E": Rule(0.275, 1.010, 1.17, 0.7, 0.68, 2.0, 0.05, (15, 320), 0.15, (140, 0.25)),
    "22E": Rule(0.275, 1.010, 1.17, 0.7, 0.70, 2.0, 0.05, (17, 320), 0.20, (140, 0.25)),
    "3E": Rule(0.274, 1.012, 1.17, 0.7, 0.68, 2.0, 0.04, (17, 280), 0.15, (180, 0.255)),
    "23E": Rule(0.274, 1.012, 1.17, 0.7, 0.69, 2.0, 0.04, (20, 280), 0.25, (180, 0.255)),
    "10E": Rule(0.242, 1.000, 1.19, 1.8, 0.62, 0.9, 0.065, (25, 260), 0.10),
    "2": Rule(0.245, 1.000, 1.42, 0.3, math.nan, 0.0, 0.04, (20, 160), 0.15),
    "3": Rule(0.249, 1.003, 1.28, 2.0, math.nan, 0.0, 0.035, (20, 100), 0.15),
    "4": Rule(0.240, 0.997, 1.28, 1.7, 0.675, 3.6, 0.055, (25, 150), 0.15),
    "10": Rule(0.242, 1.000, 1.19, 1.8, math.nan, 0.0, 0.035, (25, 480), 0.10, (280, 0.25)),
}
#: Series of which a name without a letter does not mean type E.
_LITERAL_SERIES: Final = ("10", "4")
#: Diameters of standard rollers [mm]; above 50 mm none are standard, and steps like those below are taken.
_ROLLERS: Final = (
    *(5.5, 6, 6.5, 7, 7.5, *range(8, 27), 28, 30, 32, 34, 36, 38, 40, 42, 45, 48, 50),
    *(52, 54, 56, 58, 60, 62, 65, 68, 70, 72, 75, 78, 80),
)
#: Chamfers of both ends together [mm], from the diameter of a roller [mm] on.
_CHAMFERS: Final = ((30, 3.0), (25, 2.4), (19, 2.0), (15, 1.6), (0, 1.0))
#: Radial clearance before mounting [um]: up to which bore [mm], groups C2, CN, C3, C4, C5, from and to. ISO 5753-1:
#: C2 to C4 up to 200 mm checked against two printed tables (B), all else recalled (C).
_CLEARANCES: Final = (
    (24, (0, 25), (20, 45), (35, 60), (50, 75), (65, 90)),
    (30, (0, 25), (20, 45), (35, 60), (50, 75), (70, 95)),
    (40, (5, 30), (25, 50), (45, 70), (60, 85), (80, 105)),
    (50, (5, 35), (30, 60), (50, 80), (70, 100), (95, 125)),
    (65, (10, 40), (40, 70), (60, 90), (80, 110), (110, 140)),
    (80, (10, 45), (40, 75), (65, 100), (90, 125), (130, 165)),
    (100, (15, 50), (50, 85), (75, 110), (105, 140), (155, 190)),
    (120, (15, 55), (50, 90), (85, 125), (125, 165), (180, 220)),
    (140, (15, 60), (60, 105), (100, 145), (145, 190), (200, 245)),
    (160, (20, 70), (70, 120), (115, 165), (165, 215), (225, 275)),
    (180, (25, 75), (75, 125), (120, 170), (170, 220), (250, 300)),
    (200, (35, 90), (90, 145), (140, 195), (195, 250), (275, 330)),
    (225, (45, 105), (105, 165), (160, 220), (220, 280), (305, 365)),
    (250, (45, 110), (110, 175), (170, 235), (235, 300), (330, 395)),
    (280, (55, 125), (125, 195), (190, 260), (260, 330), (370, 440)),
    (315, (55, 130), (130, 205), (200, 275), (275, 350), (410, 485)),
    (355, (65, 145), (145, 225), (225, 305), (305, 385), (455, 535)),
    (400, (100, 190), (190, 280), (280, 370), (370, 460), (510, 600)),
    (450, (110, 210), (210, 310), (310, 410), (410, 510), (565, 665)),
    (500, (110, 220), (220, 330), (330, 440), (440, 550), (625, 735)),
)
#: Groups of clearance, in the order of the columns of `_CLEARANCES`.
_GROUPS: Final = ("C2", "CN", "C3", "C4", "C5")
#: Letter after a group -> first and last fraction of its range: lower half, middle, upper half (SKF; C).
_PARTS: Final = {"": (0.0, 1.0), "L": (0.0, 0.5), "M": (0.25, 0.75), "H": (0.5, 1.0)}
#: Types of series 22 and 23.
_TYPES: Final = dict.fromkeys(("22E", "23E"), ("NU", "NJ", "NUP"))
#: Types of all other series.
_ALL: Final = ("NU", "NJ", "NUP", "N")
#: Types with ribs on opposite sides of both rings.
_RIBBED: Final = ("NJ", "NUP")
#: Bore [mm] up to which a cage without letters is of polyamide: up to it a maker's designations of type E say polyamide
#: on the rollers (TVP3), above it brass on them (M6); brass on them in series 4 (M), brass on the outer ring in 10
#: (MPA); NKE, general catalogue (A). Others do likewise, up to 100 to 130 mm.
_POLYAMIDE: Final = 130


class Inside(NamedTuple):
    """What is estimated of the inside of a bearing [mm]."""

    rollers: int
    diameter: float
    length: float
    pitch: float


def nearest_roller(diameter: float) -> float:
    """Return the diameter of the standard roller that is nearest [mm]."""
    return float(min(_ROLLERS, key=lambda standard: abs(standard - diameter)))


def boundaries(series: str) -> list[tuple[int, int, int]]:
    """Return bore, outside diameter and width of a dimension series [mm], ISO 15."""
    widths, text = next(sizes for sizes in _SIZES.values() if series in sizes[0])
    return [
        (size[0], size[1], size[2 + widths.index(series)])
        for size in (tuple(map(int, line.split())) for line in text.split(","))
    ]


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
    fraction = rule.large[1] if bore >= rule.large[0] else rule.diameter
    diameter = nearest_roller(fraction * (outside - bore))
    pitch = round(rule.pitch * (bore + outside)) / 2
    rollers = math.floor(math.pi * pitch / (rule.spacing * diameter + rule.bar) + 0.5)
    chamfers = next(both for smallest, both in _CHAMFERS if diameter >= smallest)
    length = diameter - chamfers if math.isnan(rule.length) else rule.length * width - rule.ends
    return Inside(rollers, diameter, round(length, 1), pitch)


class _Size(NamedTuple):
    """Series and boundary dimensions of a bearing [mm]."""

    series: str
    bore: int
    outside: int
    width: int


def clearance(bore: float, group: str) -> tuple[float, float]:
    """Return the bounds of the radial clearance before mounting [um], ISO 5753-1.

    Parameters
    ----------
    bore : float
        Bore [mm].
    group : str
        Group of clearance, "CN" or "C3L" for example.
    """
    ranges = next(ranges for largest, *ranges in _CLEARANCES if bore <= largest)
    low, high = ranges[_GROUPS.index(group[:2])]
    first, last = _PARTS[group[2:]]
    return low + first * (high - low), low + last * (high - low)


def _sizes() -> dict[tuple[str, str], _Size]:
    """Return the boundary dimensions of all sizes with a rule, by series and code of the bore."""
    sizes = {}
    for widths, text in _SIZES.values():
        for line in text.split(","):
            bore, outside, *each = map(int, line.split())
            for name, width in zip(widths, each, strict=True):
                for series in (f"{name}E", name):
                    if series in RULES and RULES[series].bores[0] <= bore <= RULES[series].bores[1]:
                        code = {15: "02", 17: "03"}.get(bore, f"{bore // 5:02}")
                        sizes[series, code] = _Size(series, bore, outside, width)
    return sizes


class CylindricalRollerBearings(Family):
    """Bearings of types NU, NJ, NUP and N in series 10, 2, 22, 3, 23 and 4."""

    name = "cylindrical-roller"
    description = (
        "cylindrical roller bearings of standard size, such as NU2210E; the inside is estimated (D)"
    )

    @cached_property
    def _sizes(self) -> dict[tuple[str, str], _Size]:
        """Boundary dimensions of all sizes, by series and code of the bore."""
        return _sizes()

    @property
    def names(self) -> tuple[str, ...]:
        """All designations, of normal clearance."""
        return tuple(
            _name(kind, series, code, "CN")
            for series, code in self._sizes
            for kind in _TYPES.get(series, _ALL)
        )

    def canonical_name(self, written: str) -> str | None:
        """Return the designation of the catalogue for another spelling: "NU2210E-C3" for "NU 2210 ECP/C3"."""
        if (read := read_designation(written)) is None:
            return None
        plain = read.old or (read.series in _LITERAL_SERIES and not read.reinforced)
        series = read.series if plain else f"{read.series}E"
        sized = (series, read.code) in self._sizes and not (
            read.old and read.series in _LITERAL_SERIES
        )
        if not sized or read.type not in _TYPES.get(series, _ALL):
            return None
        return _name(read.type, series, read.code, read.group or "CN")

    def cage(self, written: str) -> OwnCage | None:
        """Return the cage of a bearing, by its letters or by what makers put into it; see `OwnCage`."""
        read = read_designation(written)
        name = self.canonical_name(written)
        if read is None or name is None:
            return None
        if read.cage is not None:
            return read.cage
        series, code, _ = self._read(name)
        if series.startswith("10"):
            return OwnCage("brass", "inner" if read.type == "N" else "outer")
        small = series.endswith("E") and self._sizes[series, code].bore <= _POLYAMIDE
        return OwnCage("polyamide" if small else "brass", "roller")

    def clearance_class(self, written: str) -> str | None:
        """Return the group of clearance of a designation: "C3" of "NU 2210 ECP/C3"; None without one."""
        read = read_designation(written)
        return None if read is None else read.group

    def ignored(self, written: str) -> str:
        """Return the letters of a designation that have no effect: "P6 S1"; empty without any."""
        read = read_designation(written)
        return "" if read is None else read.ignored

    def other(self, written: str) -> str | None:
        """Return what a designation is of that is none of these."""
        return other_bearing(written)

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


def _name(kind: str, series: str, code: str, group: str) -> str:
    """Return the designation of a bearing."""
    number = series.removesuffix("E")
    design = "" if number in _LITERAL_SERIES else "-old"
    if series != number:
        design = "E"
    return f"{kind}{number}{code}{design}{'' if group == 'CN' else f'-{group}'}"


def _bearing(name: str, size: _Size, group: str) -> BearingData:
    """Return the data of a bearing by its boundary dimensions and the rule of its series."""
    inside = estimated(*size)
    rule = RULES[size.series]
    low, high = clearance(size.bore, group)
    shown = "x".join(f" {value:g} " for value in (size.bore, size.outside, size.width)).strip()
    return BearingData(
        name=name,
        description=(
            f"Cylindrical roller bearing {name}, {shown} mm; estimated (D): {inside.rollers} rollers of "
            f"{inside.diameter:g} x {inside.length:g} mm on {inside.pitch:g} mm"
        ),
        source=(
            "Boundary dimensions: ISO 15. Inner geometry: estimated (D) by rules of the series, read off bearings of "
            f"two makers: rollers times length scatter by {rule.scatter:.1%} there, their number is right within 1, in "
            "series 10 within 2. Makers differ by 1 or 2 rollers; ask yours, and write what differs beside the "
            f"name. Clearance: middle of group {group} of ISO 5753-1, {low:g} to {high:g} um. Profile: that of "
            "ISO/TS 16281 for rollers of unknown profile (D). Factor of the minimum load: SKF (A)."
        ),
        validity="Before mounting: a scene says what fits, speed and temperature leave of the clearance.",
        references=(ISO_15, ISO_5753, GOST_22696, ISO_76),
        bearing=Bearing(
            rollers=inside.rollers,
            roller_diameter=round(1e-3 * inside.diameter, 7),
            roller_length=round(1e-3 * inside.length, 7),
            inner_raceway_diameter=round(1e-3 * (inside.pitch - inside.diameter), 7),
            outer_raceway_diameter=round(1e-3 * (inside.pitch + inside.diameter), 7),
            radial_clearance=round(0.5e-6 * (low + high), 9),
            clearance_class=group,
            mounting=Mounting(
                initial_tolerance=round(1e-6 * (high - low), 9),
            ),
            ribs=_ribs(name, 1e-3 * inside.diameter),
            profile=Profile(shape="iso16281"),
            catalogue=Catalogue(
                series=size.series.removesuffix("E"),
                bore=round(1e-3 * size.bore, 7),
                outside_diameter=round(1e-3 * size.outside, 7),
                width=round(1e-3 * size.width, 7),
                minimum_load_factor=rule.minimum_load,
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
                ),
                "D",
            ),
            "radial_clearance": "C" if size.bore > 200 or "C5" in group or len(group) > 2 else "B",
            "profile": "D",
            **({"ribs": "D"} if name.startswith(_RIBBED) else {}),
        },
        scatter=(
            Scatter(
                quantity="roller_length",
                distribution="normal",
                parameters={"scatter": rule.scatter},
                grade="(D)",
                source="rollers times length of bearings of two makers against the rule of it; the number of rollers "
                "and their diameter stay as they are",
            ),
            PROFILE_DEPTH,
            *(RIB_SCATTER if name.startswith(_RIBBED) else ()),
        ),
    )


def _ribs(name: str, diameter: float) -> Ribs | None:
    """Return the ribs of a bearing with rollers of a diameter [m]; None for types without."""
    if not name.startswith(_RIBBED):
        return None
    return Ribs(height=round(RIB_HEIGHT * diameter, 7), opening_angle=RIB_ANGLE)


CATALOGUE: Final = CylindricalRollerBearings()
