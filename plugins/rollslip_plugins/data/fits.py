"""Fits of ISO 286 for shafts and housings of bearings of tolerance class Normal (ISO 492), as tables of the standards.

- All numbers are those of the standards' tables, in micrometres. Up to 250 mm, and to 400 mm of N and P, they were held
  against tables that makers print (A); the rest is recalled (B). ``tools/references/iso_286.csv`` has what was
  read.
- The deviations of holes follow from those of shafts by the standard's rule: with the opposite sign, and of K, M, N, P
  and R enlarged by Delta = IT(n) - IT(n-1) between 3 and 500 mm.
- The formulas behind the grades, i = 0.45 D^(1/3) + 0.001 D with 7, 10, 16 and 25 i, are rounded in the standard by
  rules of its own; a test holds the tables against them.
"""

from collections.abc import Mapping
from functools import cached_property
from typing import Final

from rollslip.datasets import Family, FitData
from rollslip_plugins.bibliography import ISO_286, ISO_492

#: Steps of the nominal diameter, up to [mm].
_STEPS: Final = (3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500, 630, 800, 1000)
#: Grade -> tolerance of each step [um] (ISO 286-1, table 1).
GRADES: Final[Mapping[int, tuple[int, ...]]] = {
    4: (3, 4, 4, 5, 6, 7, 8, 10, 12, 14, 16, 18, 20, 22, 25, 28),
    5: (4, 5, 6, 8, 9, 11, 13, 15, 18, 20, 23, 25, 27, 32, 36, 40),
    6: (6, 8, 9, 11, 13, 16, 19, 22, 25, 29, 32, 36, 40, 44, 50, 56),
    7: (10, 12, 15, 18, 21, 25, 30, 35, 40, 46, 52, 57, 63, 70, 80, 90),
    8: (14, 18, 22, 27, 33, 39, 46, 54, 63, 72, 81, 89, 97, 110, 125, 140),
}
#: Letter -> lower deviation of a shaft, of f, g and h the upper one, of each step [um] (ISO 286-1, tables 4 and 5).
_SHAFTS: Final[Mapping[str, tuple[int, ...]]] = {
    "f": (-6, -10, -13, -16, -20, -25, -30, -36, -43, -50, -56, -62, -68, -76, -80, -86),
    "g": (-2, -4, -5, -6, -7, -9, -10, -12, -14, -15, -17, -18, -20, -22, -24, -26),
    "h": (0,) * len(_STEPS),
    "k": (0, 1, 1, 1, 2, 2, 2, 3, 3, 4, 4, 4, 5, 0, 0, 0),
    "m": (2, 4, 6, 7, 8, 9, 11, 13, 15, 17, 20, 21, 23, 26, 30, 34),
    "n": (4, 8, 10, 12, 15, 17, 20, 23, 27, 31, 34, 37, 40, 44, 50, 56),
    "p": (6, 12, 15, 18, 22, 26, 32, 37, 43, 50, 56, 62, 68, 78, 88, 100),
}
#: Steps of r, and its lower deviation in them.
_R_STEPS: Final = (
    3, 6, 10, 18, 30, 50, 65, 80, 100, 120, 140, 160, 180, 200, 225, 250, 280, 315, 355, 400, 450, 500, 560, 630, 710,
    800, 900, 1000,
)  # fmt: skip
_R: Final = (
    10, 15, 19, 23, 28, 34, 41, 43, 51, 54, 63, 65, 68, 77, 80, 84, 94, 98, 108, 114, 126, 132, 150, 155, 175, 185, 210,
    220,
)  # fmt: skip
#: Shafts j5 and j6, and j7: lower deviation up to 500 mm.
_J_SHAFTS: Final[Mapping[int, tuple[int, ...]]] = {
    **dict.fromkeys((5, 6), (-2, -2, -2, -3, -4, -5, -7, -9, -11, -13, -16, -18, -20)),
    7: (-4, -4, -5, -6, -8, -10, -12, -15, -18, -21, -26, -28, -32),
}
#: Holes J6, J7 and J8: upper deviation up to 500 mm.
_J_HOLES: Final[Mapping[int, tuple[int, ...]]] = {
    6: (2, 5, 5, 6, 8, 10, 13, 16, 18, 22, 25, 29, 33),
    7: (4, 6, 8, 10, 12, 14, 18, 22, 26, 30, 36, 39, 43),
    8: (6, 10, 12, 15, 20, 24, 28, 34, 41, 47, 55, 60, 66),
}
#: Lower deviation of the mean bore and of the mean outside diameter of a bearing [um]; the upper one is 0 (ISO 492).
_BORE: Final = (
    (10, 8), (18, 8), (30, 10), (50, 12), (80, 15), (120, 20), (180, 25), (250, 30), (315, 35), (400, 40), (500, 45),
    (630, 50), (800, 75), (1000, 100),
)  # fmt: skip
_OUTSIDE: Final = (
    (18, 8), (30, 9), (50, 11), (80, 13), (120, 15), (150, 18), (180, 25), (250, 30), (315, 35), (400, 40), (500, 45),
    (630, 50), (800, 75), (1000, 100),
)  # fmt: skip
_SHAFT_GRADES: Final = {"f": (6, 7), **dict.fromkeys("ghkmnpr", (5, 6, 7)), "j": (5, 6, 7), "js": (5, 6, 7)}
_HOLE_GRADES: Final = {
    "F": (7, 8), **dict.fromkeys("GHKMN", (6, 7)), "H": (6, 7, 8), "J": (6, 7, 8), "JS": (6, 7), "P": (6, 7),
    "R": (6, 7),
}  # fmt: skip


def _step(diameter: float, steps: tuple[int, ...] = _STEPS) -> int:
    return next(k for k, up_to in enumerate(steps) if diameter <= up_to)


def _shaft(letter: str, diameter: float) -> int:
    return _R[_step(diameter, _R_STEPS)] if letter == "r" else _SHAFTS[letter][_step(diameter)]


def deviations(name: str, diameter: float) -> tuple[float, float] | None:
    """Return lower and upper deviation [um] of a tolerance class such as "m5" or "K7"; None where there is none.

    Examples
    --------
    >>> deviations("m5", 80), deviations("K7", 90)
    ((11, 24), (-25, 10))
    """
    letter, grade = name[:-1], int(name[-1])
    step, small = _step(diameter), letter.lower()
    width = GRADES[grade][step]
    if small == "js":
        return -width / 2, width / 2
    if small == "j":
        known = (_J_SHAFTS if letter == "j" else _J_HOLES)[grade]
        if step >= len(known):
            return None
        return (known[step], known[step] + width) if letter == "j" else (known[step] - width, known[step])
    end = _shaft(small, diameter)
    if letter == small:  # f, g and h lie below their deviation, all others above
        return (end - width, end) if small in "fgh" else (end, end + width)
    if small in "fgh":
        return -end, width - end
    more = width - GRADES[grade - 1][step] if 3 < diameter <= 500 else 0
    upper = -end + more
    if name == "M6" and 250 < diameter <= 315:
        upper = -9  # an exception of the standard
    return upper - width, upper


class Iso286(Family):
    """Tolerance classes of shafts and housings with bearings of class Normal, such as m5 and H7."""

    name = "iso-286"
    description = "fits of ISO 286 with bearings of class Normal (ISO 492), such as m5 of a shaft and H7 of a housing"

    @cached_property
    def names(self) -> tuple[str, ...]:
        """All fits, shafts first."""
        return tuple(f"{letter}{n}" for of in (_SHAFT_GRADES, _HOLE_GRADES) for letter, ns in of.items() for n in ns)

    def called(self, written: str) -> str | None:
        """Return the name; capital and small letters are different fits."""
        plain = written.replace(" ", "")
        return plain if plain in self.names else None

    def __getitem__(self, name: str) -> FitData:
        """Return a fit by its name."""
        shaft = name[0].islower()
        bearing = _BORE if shaft else _OUTSIDE
        ends = sorted({*_STEPS, *(_R_STEPS if name[0] in "rR" else ()), *(up_to for up_to, _ in bearing)})
        limits = []
        for end in ends:
            if (found := deviations(name, end)) is None:
                break
            ring = next(-low for up_to, low in bearing if end <= up_to)
            limits.append((1e-3 * end, *(round(1e-6 * one, 12) for one in (*found, ring, 0.0))))
        part, of = ("shaft", "inner") if shaft else ("housing", "outer")
        return FitData(
            name=name,
            description=f"{part} {name} with a bearing of class Normal, up to {ends[len(limits) - 1]} mm",
            source="ISO 286 for the seat, ISO 492 class Normal for the bearing: tables that makers print (A), else (B)",
            validity="Solid or thick seats of even roughness; what flattening leaves of it is the scene's.",
            references=(ISO_286, ISO_492),
            ring=of,
            limits=tuple(limits),
        )


FITS: Final = Iso286()
