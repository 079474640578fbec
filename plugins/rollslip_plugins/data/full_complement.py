"""Full complement cylindrical roller bearings of one row by their designation: boundaries exact, the inside estimated.

- "NCF 2210 V", "NCF3010CV" and Schaeffler's "SL183010" are one bearing each, as are "NJG 2310 VH" and "SL192310".
- Bore, outside diameter and width are boundary dimensions of ISO 15, series 29, 30, 22 and 23 (recalled, C), the groups
  of clearance those of ISO 5753-1.
- The inside is estimated (D). Diameter and pitch circle of the rollers are about those of bearings with a cage of the
  same diameter series, in series 29 those of the paper's bearing. Rollers fill the pitch circle, which is made such
  that 0.2 % of a diameter is left between two, as for needles without a cage (C). Their length is such that ISO 76
  gives the static ratings of NCF 2922 CV (204 kN) and NCF 3010 CV (93 kN), which are recalled (C): rollers are shorter
  than with a cage, as ribs and a snap ring hold them. No printed table was at hand: rollers times length are known to
  about 15 %.
"""

import math
import re
from functools import cached_property
from typing import Final

from rollslip.datasets import BearingData, Family, OwnCage, Scatter
from rollslip.geometry.bearing import Bearing, Catalogue, Mounting
from rollslip.geometry.surfaces import Profile
from rollslip_plugins.bibliography import GOST_22696, ISO_15, ISO_76, ISO_5753
from rollslip_plugins.data import PROFILE_DEPTH
from rollslip_plugins.data.cylindrical import RULES, boundaries, clearance, nearest_roller
from rollslip_plugins.data.designations import packed

#: Bore, outside diameter, width [mm] of series 30 and 29 (ISO 15; C).
_SIZES: Final = {
    "30": """20 42 16, 25 47 16, 30 55 19, 35 62 20, 40 68 21, 45 75 23, 50 80 23, 55 90 26, 60 95 26, 65 100 26,
        70 110 30, 75 115 30, 80 125 34, 85 130 34, 90 140 37, 95 145 37, 100 150 37, 110 170 45, 120 180 46,
        130 200 52, 140 210 53, 150 225 56, 160 240 60, 170 260 67, 180 280 74, 190 290 75, 200 310 82,
        220 340 90, 240 360 92, 260 400 104, 280 420 106, 300 460 118""",
    "29": """60 85 16, 65 90 16, 70 100 19, 75 105 19, 80 110 19, 85 120 22, 90 125 22, 95 130 22, 100 140 24,
        110 150 24, 120 165 27, 130 180 30, 140 190 30, 150 210 36, 160 220 36, 170 230 36, 180 250 42, 190 260 42,
        200 280 48, 220 300 48, 240 320 48, 260 360 60, 280 380 60, 300 420 72""",
}
#: Series -> type and its letters behind, bores that makers list [mm] (C), diameter over D - d and pitch over d_m.
_SERIES: Final = {
    "29": ("NCF", "V", (60, 300), 0.25, 1.0),
    "30": ("NCF", "V", (20, 300), RULES["10E"].diameter, RULES["10E"].pitch),
    "22": ("NCF", "V", (20, 200), RULES["22E"].diameter, RULES["22E"].pitch),
    "23": ("NJG", "VH", (25, 130), RULES["23E"].diameter, RULES["23E"].pitch),
}
#: Length of a roller over the width of the bearing, before `_ENDS`; from two recalled static ratings (D).
_LENGTH = 0.6
#: Length that ribs and snap ring take from it [mm] (D), as `_LENGTH`.
_ENDS = 1.6
#: Gap between two rollers over their diameter, as for needles without a cage (C).
_GAP = 0.002
#: Relative standard deviation of rollers times length (D).
_SCATTER = 0.15
#: Pattern of a packed designation.
_WRITTEN: Final = re.compile(
    r"(?:NCF(?P<ncf>29|30|22)(?P<ncf_code>\d\d)C?V|NJG(?P<njg>23)(?P<njg_code>\d\d)C?VH|SL18(?P<sl>29|30|22)"
    r"(?P<sl_code>\d\d)|SL19(?P<sh>23)(?P<sh_code>\d\d))(?:XL|[ABE])?(?:BR)?(?P<group>C[2345N])?(?:BR)?"
)


class FullComplementBearings(Family):
    """Bearings NCF in series 29, 30 and 22, and NJG in series 23."""

    name = "full-complement"
    description = (
        "full complement cylindrical roller bearings, such as NCF2210V or "
        "SL182210; the inside is estimated (D)"
    )

    @cached_property
    def _sizes(self) -> dict[tuple[str, str], tuple[int, int, int]]:
        """Series and code of the bore of every size, and what it is [mm]."""
        listed = {
            series: [list(map(int, row.split())) for row in text.split(",")]
            for series, text in _SIZES.items()
        }
        listed |= {series: list(map(list, boundaries(series))) for series in ("22", "23")}
        return {
            (series, f"{size[0] // 5:02}"): (size[0], size[1], size[2])
            for series, (_, _, (first, last), _, _) in _SERIES.items()
            for size in listed[series]
            if first <= size[0] <= last
        }

    @property
    def names(self) -> tuple[str, ...]:
        """All designations, of normal clearance."""
        return tuple(_name(series, code, "CN") for series, code in self._sizes)

    def _read(self, written: str) -> tuple[str, str, str | None] | None:
        """Return series, code of the bore and, if it is given, the group of clearance."""
        if (match := _WRITTEN.fullmatch(packed(written))) is None:
            return None
        prefix = next(name for name in ("ncf", "njg", "sl", "sh") if match[name])
        series = match[prefix]
        code = match[f"{prefix}_code"]
        return (series, code, match["group"]) if (series, code) in self._sizes else None

    def canonical_name(self, written: str) -> str | None:
        """Return the designation of the catalogue for another spelling: "NCF2210V-C3" for "SL182210-C3"."""
        read = self._read(written)
        return read and _name(read[0], read[1], read[2] or "CN")

    def cage(self, written: str) -> OwnCage | None:
        """Return that there is none."""
        return None if self._read(written) is None else OwnCage("", "roller", "V")

    def clearance_class(self, written: str) -> str | None:
        """Return the group of clearance of a designation; None without one."""
        read = self._read(written)
        return read and read[2]

    def __getitem__(self, name: str) -> BearingData:
        """Return a bearing by its designation."""
        if (read := self._read(name)) is None:
            raise KeyError(name)
        series = read[0]
        return _bearing(name, series, *self._sizes[series, read[1]], read[2] or "CN")


def _name(series: str, code: str, group: str) -> str:
    """Return the designation of a bearing."""
    kind, behind, *_ = _SERIES[series]
    return f"{kind}{series}{code}{behind}{'' if group == 'CN' else f'-{group}'}"


def _bearing(
    name: str, series: str, bore: int, outside: int, width: int, group: str
) -> BearingData:
    """Return the data of a bearing by its boundary dimensions [mm]."""
    *_, fraction, of_mean = _SERIES[series]
    diameter = nearest_roller(fraction * (outside - bore))
    spacing = (1.0 + _GAP) * diameter
    rollers = round(math.pi / math.asin(2.0 * spacing / (of_mean * (bore + outside))))
    pitch = round(spacing / math.sin(math.pi / rollers), 3)
    length = round(_LENGTH * width - _ENDS, 1)
    low, high = clearance(bore, group)
    return BearingData(
        name=name,
        description=(
            f"Full complement cylindrical roller bearing {name}, {bore} x {outside} x {width} mm; estimated (D): "
            f"{rollers} rollers of {diameter:g} x {length:g} mm on {pitch:g} mm"
        ),
        source=(
            "Boundary dimensions: ISO 15 (C). Inner geometry: estimated (D), diameter and pitch circle as with a cage, "
            "as many rollers as fill it, their length from recalled static ratings (C): rollers times length "
            f"are known to about {_SCATTER:.0%}. Write what you know beside the name. Clearance: middle of group "
            f"{group} of ISO 5753-1, {low:g} to {high:g} um. Profile: that of ISO/TS 16281 for rollers of unknown "
            "profile (D)."
        ),
        validity="Before mounting: a scene says what fits, speed and temperature leave of the clearance.",
        references=(ISO_15, ISO_5753, GOST_22696, ISO_76),
        bearing=Bearing(
            rollers=rollers,
            roller_diameter=round(1e-3 * diameter, 7),
            roller_length=round(1e-3 * length, 7),
            inner_raceway_diameter=round(1e-3 * (pitch - diameter), 7),
            outer_raceway_diameter=round(1e-3 * (pitch + diameter), 7),
            radial_clearance=round(0.5e-6 * (low + high), 9),
            clearance_class=group,
            mounting=Mounting(initial_tolerance=round(1e-6 * (high - low), 9)),
            profile=Profile(shape="iso16281"),
            catalogue=Catalogue(
                series=f"{series}V",  # makers' factors of bearings with a cage are not theirs
                bore=round(1e-3 * bore, 7),
                outside_diameter=round(1e-3 * outside, 7),
                width=round(1e-3 * width, 7),
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
            "radial_clearance": "C" if bore > 200 or group == "C5" else "B",
            "profile": "D",
        },
        scatter=(
            Scatter(
                quantity="roller_length",
                distribution="normal",
                parameters={"scatter": _SCATTER},
                grade="(D)",
                source="rollers times length, of which two recalled static ratings are all that is known",
            ),
            PROFILE_DEPTH,
        ),
    )


CATALOGUE: Final = FullComplementBearings()
