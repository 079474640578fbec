"""Read and format quantities with a unit: "15 mm" for a length is 0.015, and 0.015 m is formatted as "15 mm".

Decisions:

- The table is closed: a short list of symbols, each with its usual prefixes, combined as "W/(m K)" or "mm2/s".
  "J/kg K" is refused because it is ambiguous.
- A field declares its SI unit, and the dimension of a quantity has to agree. The angle counts as a dimension, so that
  1/s is not accepted for rad/s.
- Conversion uses fractions and rounds once: "15 mm" is the same float as 0.015.
- A field in K is an absolute temperature. Only such a field accepts degC, C, degF and F: an offset has no meaning in a
  product.
- Catalogues give speeds in revolutions as 1/min, min-1 or Hz. These are revolutions in a field of rad/s, and only
  there. 1/s is refused, because some users mean revolutions and some radians.
- Two factors that data sheets print without a space, "Nm" or "W/mK", are accepted where the field has the dimension of
  their product, and only there: elsewhere mK are millikelvins.
- Nothing is guessed: a decimal comma, a missing unit or an unknown one is an error that shows what to write.
- A number in a file or from Python is in SI units. A number without unit on a command line is refused, because users
  who type 3000 for a speed mean rpm (`typed`).
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

#: Standard acceleration of free fall [m/s2], by definition (CGPM 1901).
GRAVITY: Final = 9.80665
#: Weight of a kilogram [N].
_KILOGRAM = Fraction(str(GRAVITY))
#: Weight of a pound [N].
_POUND = Fraction("0.45359237") * _KILOGRAM

#: Symbol -> size in SI units, dimension, prefixes in use.
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

#: Other spellings of rotational speeds -> unit that they mean in a field of rad/s.
_TURNS = {
    **dict.fromkeys(("1/min", "min-1", "r/min", "rev/min", "U/min", "RPM"), "rpm"),
    **dict.fromkeys(("Hz", "r/s", "rev/s"), "turns"),
}
_ATOMS["turns"] = (2 * Fraction(math.pi), (0, 0, -1, 0, 1))

#: SI unit -> quantity, an example, and the units for users (small to large).
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

#: Smallest number that users write before a unit: for a smaller one no other unit is proposed. Chosen.
_WRITTEN_MIN = 1e-3
#: Numbers below this one are printed without an exponent. Chosen; it changes texts only.
_WRITTEN_MAX = 1e6
#: SI unit, or unit that was given -> units in which the same number was likely meant, the most likely first.
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

#: Largest number of characters of a value in a message; the rest is cut off.
_LONGEST = 80
#: Largest number of characters of a unit that is tried with a space between any two of them. Units are shorter; the
#: time grows with the length.
_LONGEST_UNIT = 12
#: Largest number of factors above or below the slash of a unit: exact fractions of thousands of them take minutes.
_MAX_FACTORS = 8
_CELSIUS_ZERO = Fraction("273.15")
#: Unit of a temperature scale -> size of a degree and zero of the scale [K].
_OFFSETS = {
    **dict.fromkeys(("degC", "C"), (Fraction(1), _CELSIUS_ZERO)),
    **dict.fromkeys(("degF", "F"), (Fraction(5, 9), Fraction("459.67") * Fraction(5, 9))),
}
#: A number in a text: decimal, with an exponent of up to three digits.
NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?", re.ASCII)
_DECIMAL_COMMA = re.compile(r"([+-]?\d*),(\d+)([^\d,][^,]*)?", re.ASCII)
_FACTOR = re.compile(r"([A-Za-z%]+)(-?[1-4])?")
_SPELLINGS = str.maketrans("µμ⁻¹²³·⋅*", "uu-123   ", "^") | {ord("°"): "deg", ord("℃"): "degC"}
_TOGETHER = re.compile(r"(?<=[A-Za-z0-9])(?=[A-Za-z])")
_POINT = re.compile(r"(?<=[A-Za-z0-9])\.(?=[A-Za-z])")


@lru_cache
def _unit(text: str) -> tuple[Fraction, Dimension]:
    """Return size in SI units and dimension of a unit."""
    numerator, slash, denominator = _POINT.sub(" ", text.translate(_SPELLINGS)).partition("/")
    denominator = denominator.strip()
    if denominator.startswith("(") and denominator.endswith(")"):
        denominator = denominator[1:-1]
    elif " " in denominator:
        raise UnitError(f"{as_written(text)} is ambiguous without parentheses")
    (size, dimension) = _product(numerator, text)
    (divisor, divisor_dimension) = _product(denominator if slash else "1", text)
    return size / divisor, tuple(a - b for a, b in zip(dimension, divisor_dimension, strict=True))


def _unit_in(text: str, unit: str) -> tuple[Fraction, Dimension]:
    """Return size and dimension of a unit in a field: 1/min is a speed in rad/s, and factors may lack their space."""
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
        if " " in below and "(" not in below:
            below = f"({below})"
        with contextlib.suppress(UnitError):
            if (found := _unit(above + slash + below))[1] == expected:
                return found
    return known or _unit(text)


def _product(text: str, unit: str) -> tuple[Fraction, Dimension]:
    """Return size and dimension of a product of symbols; ``unit`` is the whole unit, for messages."""
    size, dimension = _ATOMS["1"]
    factors = text.split() or [""]
    if factors == ["1"]:
        return size, dimension
    if len(factors) > _MAX_FACTORS:
        raise UnitError(f"{as_written(unit)} is not a unit, it has {len(factors)} factors")
    for factor in factors:
        match = _FACTOR.fullmatch(factor)
        if match is None or match[1] not in _ATOMS or match[1] == "turns":
            similar = [atom for atom in _ATOMS if atom.casefold() == factor.casefold()]
            hint = f" (did you mean {' or '.join(map(repr, similar))}?)" if similar else ""
            raise UnitError(f"{as_written(unit)} is not a unit that is known here{hint}")
        atom_size, exponents = _ATOMS[match[1]]
        power = int(match[2] or 1)
        size *= atom_size**power
        dimension = tuple(a + power * b for a, b in zip(dimension, exponents, strict=True))
    return size, dimension


def _listed_unit(dimension: Dimension) -> str | None:
    """Return the SI unit of a dimension in `_QUANTITIES`; None if it is not listed."""
    return next((unit for unit in _QUANTITIES if _unit(unit)[1] == dimension), None)


def as_written(value: object) -> str:
    """Return a value as a scene has it, shortened to one line of a message.

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
    if isinstance(value, int) and value.bit_length() > 256:
        # Python refuses to print some thousand digits
        return "a whole number of more than 77 digits"
    text = repr(value) if isinstance(value, str) else str(value)
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."


def expect_results(function: str, *arguments: object) -> None:
    """Raise `RollslipError` where an argument of a function is not a result."""
    if wrong := [as_written(value) for value in arguments if not hasattr(value, "data_vars")]:
        raise RollslipError(
            f"{function}: a result is expected, as rollslip.run gives, not {wrong[0]}; {function}(run({wrong[0]}))"
        )


@lru_cache
def check_unit(unit: str) -> str:
    """Return the unit of a field; raise `UnitError` if it is not an SI unit."""
    if _unit(unit)[0] != 1:
        raise UnitError(
            f"{unit!r} is not an SI unit: a field declares the unit in which its value is kept"
        )
    return unit


def expectation(unit: str, number: str = "") -> str:
    """Return the text on the expected value of a field: "a length is expected, such as '15 mm'".

    Parameters
    ----------
    unit : str
        SI unit of the field.
    number : str
        Number of the example; by default a typical one.
    """
    known = unit if unit in _QUANTITIES else _listed_unit(_unit(check_unit(unit))[1])
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
        A number in SI units, or a text "NUMBER UNIT".
    unit
        The SI unit of the field: "m", "Pa s", "W/(m K)"; "1" for a plain number; "K" for an absolute temperature.

    Returns
    -------
    float
        The value in `unit`, correctly rounded.

    Raises
    ------
    UnitError
        If the value is not such a quantity; the message states the value, what is expected, and an example.

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
    """A whole number of a command line, without a unit."""


class _TypedNumber(float):
    """Any other number of a command line, without a unit."""


class TypedRange(str):
    """A range of a command line, "LOW:HIGH": its ends need units where a quantity has one."""


def typed(value: object) -> Any:
    """Return a value of a command line, marked so that `quantity` refuses its numbers where a unit is required.

    Zero is accepted, because it is the same in every unit except those of temperature. Plain numbers and counts are
    accepted too.

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
    return list(map(typed, value)) if isinstance(value, list | tuple) else value


def check_typed(text: str, ends: Sequence[str], unit: str) -> None:
    """Raise `UnitError` where both ends of a range of a command line have no unit; `evenly` refuses one.

    Parameters
    ----------
    text : str
        The text; only a `TypedRange` is checked.
    ends : sequence of str
        Its ends.
    unit : str
        SI unit of the quantity.
    """
    if isinstance(text, TypedRange) and unit != "1" and all(map(NUMBER.fullmatch, ends)):
        raise UnitError(no_unit(ends[0], unit))


def no_unit(number: str, unit: str) -> str:
    """Return the message on a number without a unit, with usual units and the value in SI units.

    Parameters
    ----------
    number : str
        The number as it was typed.
    unit : str
        SI unit of the quantity.
    """
    expected = expectation(unit).partition(",")[0]
    try:
        float(number)
    except ValueError:  # it is shortened
        return f"{number} has no unit, here {expectation(unit)}"
    formatted = format_quantity(float(number), unit)
    plain = f"{number} {unit}"
    size = "" if formatted == plain else f", which is {formatted}"
    usual = f"{number} {_QUANTITIES.get(unit, ('', plain))[1].partition(' ')[2]}"
    degrees = [f"{number} deg"] if unit == "rad" else []
    choices = " or ".join(map(repr, dict.fromkeys((usual, *degrees, plain))))
    return f"{number} has no unit, here {expected}: write {choices}{size}"


def evenly(low: str, high: str, count: int, unit: str) -> tuple[float, ...]:
    """Return quantities at equal distances between two, both included; each is correctly rounded.

    So the middle one of "60 degC", "80 degC" is the same float as "70 degC".

    Parameters
    ----------
    low, high : str
        The ends; a text without a unit is in SI units.
    count : int
        Number of quantities.
    unit : str
        SI unit of the quantity.

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
    bare = [NUMBER.fullmatch(end) is not None for end in ends]
    if bare[0] != bare[1] and unit != "1":
        without, other = ends if bare[0] else reversed(ends)
        raise UnitError(
            f"{as_written(without)} has no unit, the other end has one; write it at both ends, "
            f"such as {without} {NUMBER.sub('', other, count=1).strip()}"
        )
    for end, plain in zip(ends, bare, strict=True):
        quantity(float(end) if plain else end, unit)  # raises for values that no field accepts
    first, last = (
        Fraction(end) if plain else _from_text(end, unit)
        for end, plain in zip(ends, bare, strict=True)
    )
    return tuple(float(first + (last - first) * k / max(count - 1, 1)) for k in range(count))


@lru_cache
def _from_text(text: str, unit: str) -> Fraction:
    """Return the exact SI value of a text with a unit."""
    stripped = text.strip()
    if "," in stripped:
        raise UnitError(
            f"{as_written(text)}: a decimal comma is not read; {_without_comma(stripped, unit)}"
        )
    number = NUMBER.match(stripped)
    try:
        value = Fraction(number[0]) if number else None
        float(value or 0)  # raises where the number exceeds all floats
    except ValueError:  # more digits than Python reads
        value = None
    if number is None or value is None:
        raise UnitError(f"{as_written(text)} is not a number with a unit, here {expectation(unit)}")
    if not (symbol := stripped[number.end() :].strip()):
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
        known = _listed_unit(dimension)
        name = (
            f"a quantity in {' '.join(symbol.split())}" if known is None else _QUANTITIES[known][0]
        )
        raise UnitError(f"{as_written(text)} is {name}, here {expectation(unit)}")
    return value * size


def _without_comma(text: str, unit: str) -> str:
    """Return the advice on a number with a decimal comma."""
    number = _DECIMAL_COMMA.fullmatch(text)
    if number is None or len(text) > _LONGEST:
        return f"here {expectation(unit)}"
    whole, digits, rest = number.groups(default="")
    choices = [f"{whole}.{digits}{rest}"]
    if len(digits) == 3 and whole.strip(
        "+-0"
    ):  # likely thousands; zeros go, since 3.000 would be read as thousands
        choices = [f"{whole}{digits}{rest}", f"{whole}.{digits}".rstrip("0").rstrip(".") + rest]
    return f"write {' or '.join(map(repr, choices[: 1 if rest.startswith('.') else 2]))}"


def unit_given(value: object, unit: str) -> str:
    """Return the unit in which a quantity was given.

    Parameters
    ----------
    value : object
        A number in SI units, or a text with a unit.
    unit : str
        SI unit of the quantity, the result for a number.

    Examples
    --------
    >>> unit_given("20 deg", "rad"), unit_given(0.35, "rad")
    ('deg', 'rad')
    """
    if not isinstance(value, str):
        return unit
    number = NUMBER.match(value.strip())
    return (" ".join(value.strip()[number.end() :].split()) if number else "") or unit


def format_quantity(value: float, unit: str, digits: int = 6, given: str | None = None) -> str:
    """Return an SI value as text: with the prefix that suits its size, temperatures in degC, speeds in rpm.

    Parameters
    ----------
    value
        The value in `unit`.
    unit
        Its SI unit, as in `quantity`.
    digits
        Significant digits.
    given
        Unit of the text, in which the user gave the value, see `unit_given`.

    Examples
    --------
    >>> format_quantity(0.015, "m"), format_quantity(343.15, "K"), format_quantity(667.17, "rad/s")
    ('15 mm', '70 degC', '6371 rpm')
    """
    if given is not None and given != "1":
        size, zero = _scale(given, unit)
        symbol = given.translate(_SPELLINGS) if zero else given
        number = float((Fraction(value) - zero) / size) if math.isfinite(value) else value
        return f"{_shown(number, digits)} {symbol}"
    if unit == "1":
        return f"{value:.{digits}g}"
    if unit == "K":
        return f"{_shown(value - float(_CELSIUS_ZERO), digits)} degC"
    smallest, *larger = _QUANTITIES.get(unit, ("", "", (unit,)))[2]
    shown = next(
        (name for name in reversed(larger) if (abs(value) or 1.0) >= float(_unit(name)[0])),
        smallest,
    )
    return f"{_shown(value / float(_unit(shown)[0]), digits)} {shown}"


def _shown(number: float, digits: int) -> str:
    """Return a rounded number without an exponent up to a million: 22040, where Python would write 2.204e+04."""
    text = f"{number:.{digits}g}"
    return f"{float(text):.0f}" if "e+0" in text and abs(number) < _WRITTEN_MAX else text


def shown_unit(value: float, unit: str) -> str:
    """Return the unit of `format_quantity` for an SI value; "" for a plain number.

    Parameters
    ----------
    value : float
        The value in `unit`.
    unit : str
        Its SI unit.

    Examples
    --------
    >>> shown_unit(4e6, "Pa"), shown_unit(343.15, "K")
    ('MPa', 'degC')
    """
    return format_quantity(value, unit).partition(" ")[2]


def converted(values: Any, unit: str, given: str) -> Any:
    """Return SI values in another unit; temperatures are relative to the zero of their scale.

    Parameters
    ----------
    values : float or array
        Values in `unit`.
    unit : str
        Their SI unit.
    given : str
        The other unit; values are returned as they are if it is empty.

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
    """Return size and zero of a unit in which a quantity was given, in the SI unit of its field."""
    spelled = given.translate(_SPELLINGS)
    if unit == "K" and spelled in _OFFSETS:
        return _OFFSETS[spelled]
    return _unit_in(given, unit)[0], Fraction(0)


def likely(value: float, given: str, unit: str, usual: Callable[[float], bool]) -> str | None:
    """Return the same number with another unit, with which it is a usual value; None if there is no such unit.

    Parameters
    ----------
    value : float
        The value in `unit`.
    given : str
        Unit in which the user gave it.
    unit : str
        Its SI unit.
    usual : callable
        Whether an SI value is usual.

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
