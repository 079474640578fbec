"""Reads and writes quantities with a unit: "15 mm" for a length gives 0.015, and 0.015 m is shown as "15 mm".

Decisions:

- The table is closed: a short list of symbols, each with the few prefixes in use, combined as "W/(m K)" or "mm2/s".
  "J/kg K" is not read because it is ambiguous.
- A field declares its SI unit, and the dimension of what was written has to agree. The angle counts as a dimension of
  its own, so that 1/s never passes for rad/s.
- Conversion is done with fractions and rounded once: "15 mm" is the same float as 0.015.
- A field in K is an absolute temperature. Only there are degC, C, degF and F read: an offset has no meaning in a
  product.
- Catalogues give speeds as 1/min, min-1 or Hz and mean turns. So these are turns in a field of rad/s, and only there;
  1/s stays refused, which some take for turns and some for radians.
- Two factors that data sheets print together, "Nm" or "W/mK", are read where the field has the dimension of their
  product, and only there: in others mK are millikelvins.
- Nothing is guessed: a decimal comma, a missing unit or an unknown one is an error that shows what to write.
- A number in a file or from Python is in SI units. One that is typed on a command line without a unit is none: who
  types 3000 for a speed means rpm (`typed`).
"""

import contextlib
import math
import re
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from numbers import Real
from typing import Any, Final, TypeAlias

from rollslip.errors import RollslipError

__all__ = [
    "GRAVITY",
    "TypedRange",
    "UnitError",
    "as_written",
    "check_typed",
    "check_unit",
    "converted",
    "evenly",
    "expect_results",
    "expectation",
    "format_quantity",
    "likely",
    "no_unit",
    "quantity",
    "shown_unit",
    "typed",
    "unit_given",
]


class UnitError(RollslipError, ValueError):
    """A value is not a quantity of the dimension that is expected."""


Dimension: TypeAlias = tuple[int, ...]
"""Exponents of metre, kilogram, second, kelvin and radian."""

_PREFIXES = {
    "": Fraction(1),
    "n": Fraction(1, 10**9),
    "u": Fraction(1, 10**6),
    "m": Fraction(1, 10**3),
    "c": Fraction(1, 10**2),
    "d": Fraction(1, 10),
    "k": Fraction(10**3),
    "M": Fraction(10**6),
    "G": Fraction(10**9),
}

#: Standard acceleration of free fall [m/s2].
GRAVITY: Final = 9.80665
#: A kilogram and a pound by that, all by definition [N].
_KILOGRAM = Fraction(str(GRAVITY))
_POUND = Fraction("0.45359237") * _KILOGRAM

# symbol: size in SI units, dimension, prefixes in use
_SYMBOLS: dict[str, tuple[Fraction, Dimension, str]] = {
    "1": (Fraction(1), (0, 0, 0, 0, 0), ""),
    "%": (Fraction(1, 100), (0, 0, 0, 0, 0), ""),
    "m": (Fraction(1), (1, 0, 0, 0, 0), "numcdk"),
    **dict.fromkeys("lL", (Fraction(1, 1000), (3, 0, 0, 0, 0), "m")),
    "g": (Fraction(1, 1000), (0, 1, 0, 0, 0), "mk"),
    "s": (Fraction(1), (0, 0, 1, 0, 0), "num"),
    "min": (Fraction(60), (0, 0, 1, 0, 0), ""),
    "h": (Fraction(3600), (0, 0, 1, 0, 0), ""),
    "K": (Fraction(1), (0, 0, 0, 1, 0), "m"),
    "rad": (Fraction(1), (0, 0, 0, 0, 1), "um"),
    "deg": (Fraction(math.pi) / 180, (0, 0, 0, 0, 1), ""),
    "arcmin": (Fraction(math.pi) / 10800, (0, 0, 0, 0, 1), ""),
    "rpm": (Fraction(math.pi) / 30, (0, 0, -1, 0, 1), ""),
    "N": (Fraction(1), (1, 1, -2, 0, 0), "mkM"),
    **dict.fromkeys(("in", "inch"), (Fraction(254, 10**4), (1, 0, 0, 0, 0), "")),
    "mil": (Fraction(254, 10**7), (1, 0, 0, 0, 0), ""),
    "micron": (Fraction(1, 10**6), (1, 0, 0, 0, 0), ""),
    "kgf": (_KILOGRAM, (1, 1, -2, 0, 0), ""),
    "lbf": (_POUND, (1, 1, -2, 0, 0), ""),
    "psi": (_POUND / Fraction(254, 10**4) ** 2, (-1, 1, -2, 0, 0), ""),
    "ksi": (1000 * _POUND / Fraction(254, 10**4) ** 2, (-1, 1, -2, 0, 0), ""),
    "Hz": (Fraction(1), (0, 0, -1, 0, 0), "kM"),
    "Pa": (Fraction(1), (-1, 1, -2, 0, 0), "mkMG"),
    "bar": (Fraction(10**5), (-1, 1, -2, 0, 0), ""),
    "J": (Fraction(1), (2, 1, -2, 0, 0), "mk"),
    "W": (Fraction(1), (2, 1, -3, 0, 0), "mkM"),
    "P": (Fraction(1, 10), (-1, 1, -1, 0, 0), "c"),
    "St": (Fraction(1, 10**4), (2, 0, -1, 0, 0), "c"),
}

_ATOMS: dict[str, tuple[Fraction, Dimension]] = {
    prefix + symbol: (_PREFIXES[prefix] * size, dimension)
    for symbol, (size, dimension, prefixes) in _SYMBOLS.items()
    for prefix in ("", *prefixes)
}

#: How rotational speeds are written besides, and what they mean in a field of rad/s.
_TURNS = {
    **dict.fromkeys(("1/min", "min-1", "r/min", "rev/min", "U/min", "RPM"), "rpm"),
    **dict.fromkeys(("Hz", "r/s", "rev/s"), "turns"),
}
_ATOMS["turns"] = (2 * Fraction(math.pi), (0, 0, -1, 0, 1))

# SI unit: what it measures, an example, the units in which people read it (small to large)
_QUANTITIES: dict[str, tuple[str, str, tuple[str, ...]]] = {
    "1": ("a plain number", "0.1", ()),
    "m": ("a length", "15 mm", ("um", "mm", "m")),
    "m2": ("an area", "2 mm2", ("mm2", "m2")),
    "m3": ("a volume", "2 cm3", ("cm3", "m3")),
    "m3/s": ("a flow", "0.5 l/min", ("ml/min", "l/min", "m3/s")),
    "m/s": ("a speed", "30 m/s", ("mm/s", "m/s")),
    "m/s2": ("an acceleration", "9.81 m/s2", ("m/s2",)),
    "m2/s": ("a kinematic viscosity", "3.2 mm2/s", ("mm2/s",)),
    "rad": ("an angle", "0.5 mrad", ("urad", "mrad", "rad")),
    "rad/s": ("a rotational speed", "6371 rpm", ("rpm",)),
    "s": ("a time", "0.2 s", ("us", "ms", "s")),
    "1/s": ("a rate", "1000 1/s", ("1/s",)),
    "kg": ("a mass", "20 g", ("g", "kg")),
    "kg m": ("an unbalance", "20 g mm", ("g mm", "kg m")),
    "kg m2": ("a moment of inertia", "0.003 kg m2", ("kg m2",)),
    "kg/m3": ("a density", "7800 kg/m3", ("kg/m3",)),
    "N": ("a force", "3415 N", ("mN", "N", "kN")),
    "N m": ("a torque", "0.2 N m", ("mN m", "N m")),
    "N/m": ("a force per length", "20 N/mm", ("N/m", "N/mm")),
    "s/m": ("a damping by speed", "0.3 s/m", ("s/m",)),
    "N s/m": ("a damping", "50 N s/m", ("N s/m",)),
    "Pa": ("a pressure", "4 MPa", ("Pa", "kPa", "MPa", "GPa")),
    "Pa s": ("a dynamic viscosity", "5.2 mPa s", ("mPa s", "Pa s")),
    "1/Pa": ("a pressure coefficient", "12 1/GPa", ("1/GPa",)),
    "1/K": ("a temperature coefficient", "0.02 1/K", ("1/K",)),
    "1/(Pa K)": ("a pressure-temperature coefficient", "0.07 1/(GPa K)", ("1/(GPa K)",)),
    "K": ("a temperature", "70 degC", ("degC",)),
    "K/1": ("a difference of temperatures", "5 K", ("K",)),
    "W": ("a power", "50 W", ("mW", "W", "kW")),
    "W/m2": ("a power per area", "20 MW/m2", ("W/m2", "kW/m2", "MW/m2")),
    "J/m2": ("an energy per area", "2 kJ/m2", ("J/m2", "kJ/m2")),
    "W/K": ("a thermal conductance", "10 W/K", ("W/K",)),
    "J/K": ("a heat capacity", "400 J/K", ("J/K", "kJ/K")),
    "kg/s": ("a mass flow", "15 g/s", ("g/s", "kg/s")),
    "J/(kg K)": ("a specific heat", "470 J/(kg K)", ("J/(kg K)",)),
    "J/(m3 K)": ("a heat capacity per volume", "3.7e6 J/(m3 K)", ("J/(m3 K)",)),
    "W/(m K)": ("a thermal conductivity", "46 W/(m K)", ("W/(m K)",)),
}

#: The least number that people write before a unit, and the largest without an exponent.
_WRITTEN_MIN = 1e-3
_WRITTEN_MAX = 1e6
#: SI unit, or one that was given -> units in which the same number is likely meant, the likeliest first.
_MEANT: Mapping[str, tuple[str, ...]] = {
    "1": ("%",),
    "m": ("um", "mm", "m"),
    "m2/s": ("mm2/s",),
    "rad": ("mrad", "arcmin", "deg"),
    "deg": ("arcmin", "mrad"),
    "rad/s": ("rpm", "rad/s"),
    "s": ("ms", "us", "s"),
    "kg": ("g", "kg"),
    "kg m": ("g mm",),
    "kg m2": ("g m2", "kg mm2", "g mm2"),
    "kg/m3": ("kg/m3", "g/cm3"),
    "N": ("N", "kN"),
    "N/m": ("N/mm", "N/um"),
    "Pa": ("MPa", "GPa", "kPa", "Pa"),
    "Pa s": ("mPa s", "Pa s"),
    "1/Pa": ("1/GPa", "1/MPa"),
    "1/(Pa K)": ("1/(GPa K)",),
    "K": ("degC", "K", "degF"),
    "J/(kg K)": ("J/(kg K)", "kJ/(kg K)"),
    "W/(m K)": ("W/(m K)", "mW/(m K)"),
}

_LONGEST = 80  # characters of a value that a message repeats
_LONGEST_UNIT = 12  # characters of one whose factors may stand together
_MAX_FACTORS = 8  # above or below the line; exact fractions of thousands take minutes
_CELSIUS_ZERO = Fraction("273.15")
#: Scales of temperature: size of a degree, and their zero [K].
_OFFSETS = {
    **dict.fromkeys(("degC", "C"), (Fraction(1), _CELSIUS_ZERO)),
    **dict.fromkeys(("degF", "F"), (Fraction(5, 9), Fraction("459.67") * Fraction(5, 9))),
}
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?", re.ASCII)
_DECIMAL_COMMA = re.compile(r"([+-]?\d*),(\d+)([^\d,][^,]*)?", re.ASCII)
_FACTOR = re.compile(r"([A-Za-z%]+)(-?[1-4])?")
_SPELLINGS = str.maketrans("µμ⁻¹²³·⋅*", "uu-123   ", "^") | {ord("°"): "deg", ord("℃"): "degC"}
_TOGETHER = re.compile(r"(?<=[A-Za-z0-9])(?=[A-Za-z])")
_POINT = re.compile(r"(?<=[A-Za-z0-9])\.(?=[A-Za-z])")


@lru_cache
def _unit(text: str) -> tuple[Fraction, Dimension]:
    """Size in SI units and dimension of a unit."""
    above, slash, below = _POINT.sub(" ", text.translate(_SPELLINGS)).partition("/")
    below = below.strip()
    if below.startswith("(") and below.endswith(")"):
        below = below[1:-1]
    elif " " in below:
        raise UnitError(f"{as_written(text)} is ambiguous without parentheses")
    (top, dimension) = _product(above, text)
    (bottom, divisor) = _product(below if slash else "1", text)
    return top / bottom, tuple(a - b for a, b in zip(dimension, divisor, strict=True))


def _unit_in(text: str, unit: str) -> tuple[Fraction, Dimension]:
    """Size and dimension of a unit in a field: turns are those of speeds, and factors may stand together."""
    spelled = text.translate(_SPELLINGS)
    if unit == "rad/s" and spelled in _TURNS:
        return _ATOMS[_TURNS[spelled]]
    known = None
    expected = _unit(unit)[1]
    with contextlib.suppress(UnitError):
        if (known := _unit(text))[1] == expected:
            return known
    for gap in _TOGETHER.finditer(spelled) if len(spelled) <= _LONGEST_UNIT else ():
        above, slash, below = f"{spelled[: gap.start()]} {spelled[gap.start() :]}".partition("/")
        below = f"({below})" if " " in below and "(" not in below else below
        with contextlib.suppress(UnitError):
            if (found := _unit(above + slash + below))[1] == expected:
                return found
    return known or _unit(text)


def _product(factors: str, unit: str) -> tuple[Fraction, Dimension]:
    size, dimension = _ATOMS["1"]
    words = factors.split() or [""]
    if words == ["1"]:
        return size, dimension
    if len(words) > _MAX_FACTORS:
        raise UnitError(f"{as_written(unit)} is not a unit, it has {len(words)} factors")
    for word in words:
        factor = _FACTOR.fullmatch(word)
        if factor is None or factor[1] not in _ATOMS or factor[1] == "turns":
            other = [atom for atom in _ATOMS if atom.casefold() == word.casefold()]
            hint = f" (did you mean {' or '.join(map(repr, other))}?)" if other else ""
            raise UnitError(f"{as_written(unit)} is not a unit that is known here{hint}")
        one, exponents = _ATOMS[factor[1]]
        power = int(factor[2] or 1)
        size *= one**power
        dimension = tuple(a + power * b for a, b in zip(dimension, exponents, strict=True))
    return size, dimension


def _known_as(dimension: Dimension) -> str | None:
    """SI unit under which a dimension is listed."""
    return next((unit for unit in _QUANTITIES if _unit(unit)[1] == dimension), None)


def as_written(value: object) -> str:
    """Show a value the way a scene writes it, short enough for one line of a message.

    Examples
    --------
    >>> as_written(True), as_written("15 mm"), as_written([1, 2])
    ('true', "'15 mm'", 'a list')
    """
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, Mapping):
        return "a table"
    if isinstance(value, list | tuple):
        return "a list"
    if (
        isinstance(value, int) and value.bit_length() > 256
    ):  # beyond some thousand digits Python writes none
        return "a whole number of more than 77 digits"
    text = repr(value) if isinstance(value, str) else str(value)
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."


def expect_results(asks: str, *given: object) -> None:
    """Refuse, for the function that asks, what is no result."""
    if bad := [as_written(one) for one in given if not hasattr(one, "data_vars")]:
        raise RollslipError(
            f"{asks}: a result is expected, as rollslip.run gives, not {bad[0]}; {asks}(run({bad[0]}))"
        )


@lru_cache
def check_unit(unit: str) -> str:
    """Return the unit of a field, if it is one of the table and without a factor: that of SI."""
    if _unit(unit)[0] != 1:
        raise UnitError(
            f"{unit!r} is not an SI unit: a field declares the unit in which its value is kept"
        )
    return unit


def expectation(unit: str, number: str = "") -> str:
    """Say what a field with this SI unit expects, of a number if given: "a length is expected, such as '15 mm'"."""
    known = unit if unit in _QUANTITIES else _known_as(_unit(check_unit(unit))[1])
    if known is None:
        return f"a quantity in {unit} is expected, such as '1 {unit}'"
    name, example, _ = _QUANTITIES[known]
    if number and known != "1":
        example = f"{number} {example.partition(' ')[2]}"
    degrees = f" or '{number} deg'" if number and known == "rad" else ""
    return f"{name} is expected, such as {example if known == '1' else repr(example)}{degrees}"


def quantity(value: object, unit: str) -> float:
    """Return the SI value of a number or of a string with a unit.

    Parameters
    ----------
    value
        A number, which is taken to be in SI units already, or a string "NUMBER UNIT".
    unit
        The SI unit of the field: "m", "Pa s", "W/(m K)"; "1" for a plain number; "K" for an absolute temperature.

    Returns
    -------
    float
        The value in `unit`, correctly rounded.

    Raises
    ------
    UnitError
        In one sentence: what came, what is expected and an example.

    Examples
    --------
    >>> quantity("15 mm", "m"), quantity("5.2 mPa s", "Pa s"), quantity("70 degC", "K"), quantity(3415, "N")
    (0.015, 0.0052, 343.15, 3415.0)
    """
    check_unit(unit)
    if isinstance(value, bool) or not isinstance(value, Real | str):
        raise UnitError(f"{as_written(value)} is not a quantity, here {expectation(unit)}")
    if isinstance(value, _TypedWhole | _TypedNumber) and unit != "1" and (value or unit == "K"):
        raise UnitError(no_unit(as_written(value), unit))
    try:
        result = float(_from_text(value, unit)) if isinstance(value, str) else float(value)
    except OverflowError:
        result = math.inf
    if not math.isfinite(result):
        raise UnitError(f"{as_written(value)} is not a finite number, here {expectation(unit)}")
    if unit == "K" and result < 0:
        raise UnitError(f"{as_written(value)} is below absolute zero, here {expectation(unit)}")
    return result


class _TypedWhole(int):
    """A whole number as it was typed, without a unit."""


class _TypedNumber(float):
    """Any other number as it was typed, without a unit."""


class TypedRange(str):
    """A range, "LOW:HIGH", as it was typed on a command line: its ends need units where a quantity has one."""


def typed(value: object) -> Any:
    """Return what was typed on a command line such that no number of it is taken for a quantity in SI units.

    Zero, which is the same in every unit but those of temperature, is. Plain numbers and counts stay what they are.

    Examples
    --------
    >>> quantity(typed(0.05), "1"), quantity(typed("15 mm"), "m"), typed(21) + 1
    (0.05, 0.015, 22)
    >>> quantity(typed(200), "N")
    Traceback (most recent call last):
    ...
    rollslip.units.UnitError: 200 has no unit, here a force is expected: write '200 N'
    """
    if isinstance(value, bool | str):
        return value
    if isinstance(value, int):
        return _TypedWhole(value)
    if isinstance(value, float):
        return _TypedNumber(value)
    if isinstance(value, Mapping):
        return {key: typed(inner) for key, inner in value.items()}
    return [typed(inner) for inner in value] if isinstance(value, list | tuple) else value


def check_typed(text: str, ends: Sequence[str], unit: str) -> None:
    """Refuse ends of a typed range that have no unit; of any other text nothing."""
    for end in ends if isinstance(text, TypedRange) and unit != "1" else ():
        if _NUMBER.fullmatch(end.strip()):
            raise UnitError(no_unit(end.strip(), unit))


def no_unit(number: str, unit: str) -> str:
    """Say that a number has no unit, which ones there are, and what it would be in SI units."""
    what = expectation(unit).partition(",")[0]
    try:
        float(number)
    except ValueError:  # too long to be written out
        return f"{number} has no unit, here {expectation(unit)}"
    told = format_quantity(float(number), unit)
    plain = f"{number} {unit}"
    size = "" if told == plain else f", which is {told}"
    usual = f"{number} {_QUANTITIES.get(unit, ('', plain))[1].partition(' ')[2]}"
    degrees = [f"{number} deg"] if unit == "rad" else []
    either = " or ".join(map(repr, dict.fromkeys((usual, *degrees, plain))))
    return f"{number} has no unit, here {what}: write {either}{size}"


def evenly(low: str, high: str, count: int, unit: str) -> tuple[float, ...]:
    """Return quantities spread evenly between two, both included; each is correctly rounded.

    So the middle one of "60 degC", "80 degC" is the same float as "70 degC". A text without a unit is taken to be in
    SI units.

    Raises
    ------
    UnitError
        If an end cannot be read, or one of them has a unit and the other has none.

    Examples
    --------
    >>> evenly("0.5 kN", "1.5 kN", 3, "N"), evenly("0.1", "0.3", 3, "N")
    ((500.0, 1000.0, 1500.0), (0.1, 0.2, 0.3))
    """
    ends = [text.strip() for text in (low, high)]
    bare = [_NUMBER.fullmatch(end) is not None for end in ends]
    if bare[0] != bare[1] and unit != "1":
        without = ends[0] if bare[0] else ends[1]
        raise UnitError(
            f"{as_written(without)} has no unit, the other end has one; write it at both ends"
        )
    for end, plain in zip(ends, bare, strict=True):
        quantity(float(end) if plain else end, unit)  # refuses what no field can hold
    first, last = (
        Fraction(end) if plain else _from_text(end, unit)
        for end, plain in zip(ends, bare, strict=True)
    )
    return tuple(float(first + (last - first) * k / max(count - 1, 1)) for k in range(count))


@lru_cache
def _from_text(text: str, unit: str) -> Fraction:
    stripped = text.strip()
    if "," in stripped:
        raise UnitError(
            f"{as_written(text)}: a decimal comma is not read; {_without_comma(stripped, unit)}"
        )
    number = _NUMBER.match(stripped)
    try:
        value = Fraction(number[0]) if number else None
        float(value or 0)  # beyond all floats it cannot be told in its own unit either
    except ValueError:  # more digits than Python reads
        value = None
    if number is None or value is None:
        raise UnitError(f"{as_written(text)} is not a number with a unit, here {expectation(unit)}")
    symbol = stripped[number.end() :].strip()
    if not symbol:
        if unit == "1":
            return value
        raise UnitError(f"{as_written(text)} has no unit, here {expectation(unit, number[0])}")
    spelled = symbol.translate(_SPELLINGS)
    if spelled in _OFFSETS:
        size, zero = _OFFSETS[spelled]
        if unit == "K":
            return value * size + zero
        symbol = "K"
    try:
        size, dimension = _unit_in(symbol, unit)
    except UnitError as error:
        raise UnitError(f"{as_written(text)}: {error}; here {expectation(unit)}") from None
    if dimension != _unit(unit)[1]:
        known = _known_as(dimension)
        name = (
            f"a quantity in {' '.join(symbol.split())}" if known is None else _QUANTITIES[known][0]
        )
        raise UnitError(f"{as_written(text)} is {name}, here {expectation(unit)}")
    return value * size


def _without_comma(text: str, unit: str) -> str:
    number = _DECIMAL_COMMA.fullmatch(text)
    if number is None or len(text) > _LONGEST:
        return f"here {expectation(unit)}"
    whole, digits, rest = number.groups(default="")
    # Three digits may as well be thousands: show both.
    thousands = f" or '{whole}{digits}{rest}'" if len(digits) == 3 else ""
    return f"write '{whole}.{digits}{rest}'{thousands}"


def unit_given(value: object, unit: str) -> str:
    """Return the unit in which a quantity was given: that of its text, the SI unit of a number.

    Examples
    --------
    >>> unit_given("20 deg", "rad"), unit_given(0.35, "rad")
    ('deg', 'rad')
    """
    if not isinstance(value, str):
        return unit
    number = _NUMBER.match(value.strip())
    return (" ".join(value.strip()[number.end() :].split()) if number else "") or unit


def format_quantity(value: float, unit: str, digits: int = 6, given: str | None = None) -> str:
    """Show an SI value to people: with the prefix that suits its size, temperatures in degC, speeds in rpm.

    Parameters
    ----------
    value
        The value in `unit`.
    unit
        Its SI unit, as in `quantity`.
    digits
        Significant digits.
    given
        The unit in which a person gave it, see `unit_given`, to be told in that.

    Examples
    --------
    >>> format_quantity(0.015, "m"), format_quantity(343.15, "K"), format_quantity(667.17, "rad/s")
    ('15 mm', '70 degC', '6371 rpm')
    """
    if given is not None and given != "1":
        size, zero = _scale(given, unit)
        told = given.translate(_SPELLINGS) if zero else given
        number = float((Fraction(value) - zero) / size) if math.isfinite(value) else value
        return f"{_shown(number, digits)} {told}"
    if unit == "1":
        return f"{value:.{digits}g}"
    if unit == "K":
        return f"{_shown(value - float(_CELSIUS_ZERO), digits)} degC"
    smallest, *larger = _QUANTITIES.get(unit, ("", "", (unit,)))[2]
    shown = next(
        (one for one in reversed(larger) if (abs(value) or 1.0) >= float(_unit(one)[0])), smallest
    )
    return f"{_shown(value / float(_unit(shown)[0]), digits)} {shown}"


def _shown(number: float, digits: int) -> str:
    """A rounded number as people write it before a unit: 22040, where Python would write 2.204e+04."""
    text = f"{number:.{digits}g}"
    return f"{float(text):.0f}" if "e+0" in text and abs(number) < _WRITTEN_MAX else text


def shown_unit(value: float, unit: str) -> str:
    """Return the unit in which `format_quantity` shows an SI value; "" for a plain number.

    Examples
    --------
    >>> shown_unit(4e6, "Pa"), shown_unit(343.15, "K")
    ('MPa', 'degC')
    """
    return format_quantity(value, unit).partition(" ")[2]


def converted(values: Any, unit: str, given: str) -> Any:
    """Return SI values, one or an array, in another unit; a temperature counts from the zero of its scale.

    Examples
    --------
    >>> converted(343.15, "K", "degC"), round(converted(667.17, "rad/s", "rpm"))
    (70.0, 6371)
    """
    if not given or given == unit:
        return values
    size, zero = _scale(given, unit)
    return (values - float(zero)) / float(size)


def _scale(given: str, unit: str) -> tuple[Fraction, Fraction]:
    """Size of a unit in which a quantity was given, and its zero, in the SI unit of its field."""
    spelled = given.translate(_SPELLINGS)
    if unit == "K" and spelled in _OFFSETS:
        return _OFFSETS[spelled]
    return _unit_in(given, unit)[0], Fraction(0)


def likely(value: float, given: str, unit: str, usual: Callable[[float], bool]) -> str | None:
    """Return the same number with another unit that makes it a usual value; None if no unit does.

    Examples
    --------
    >>> likely(0.16, "m", "m", lambda roughness: roughness < 3e-6)
    '0.16 um'
    """
    if not math.isfinite(value):
        return None
    size, zero = _scale(given, unit)
    number = f"{float((Fraction(value) - zero) / size):.12g}"
    if abs(float(number)) < _WRITTEN_MIN:
        return None
    meanings = _MEANT.get(given) or sorted(
        _MEANT.get(unit, ()), key=lambda other: abs(math.log(float(_scale(other, unit)[0] / size)))
    )
    for meant in meanings:
        text = f"{number} {meant}"
        with contextlib.suppress(OverflowError):  # 1e308 kN
            if meant != given and usual(float(_from_text(text, unit))):
                return text
    return None
