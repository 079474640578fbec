"""Units: exact conversion, errors that say what to write, and what people are shown."""

import contextlib
import math
import pickle
import subprocess
import sys
from decimal import Decimal

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rollslip.errors import RollslipError
from rollslip.units import (
    UnitError,
    as_written,
    check_unit,
    evenly,
    expectation,
    format_quantity,
    likely,
    quantity,
    unit_given,
)

pytestmark = pytest.mark.quick

SI_UNITS = (
    *(
        "1",
        "m",
        "m2",
        "m3",
        "m/s",
        "m/s2",
        "m2/s",
        "rad",
        "rad/s",
        "s",
        "1/s",
        "kg",
        "kg m2",
        "kg/m3",
        "N",
        "N m",
    ),
    *(
        "N/m",
        "N s/m",
        "Pa",
        "N/m2",
        "Pa s",
        "1/Pa",
        "1/K",
        "1/(Pa K)",
        "K",
        "W",
        "W/K",
        "J/K",
        "kg/s",
        "J/(kg K)",
        "W/(m K)",
    ),
)

finite = st.floats(allow_nan=False, allow_infinity=False)
decimals = st.decimals(
    allow_nan=False, allow_infinity=False, min_value=-(10**9), max_value=10**9, places=6
)


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("15 mm", "m", 0.015),
        ("15mm", "m", 0.015),
        ("  15   mm ", "m", 0.015),
        ("+1.5e1 mm", "m", 0.015),
        (".5 m", "m", 0.5),
        ("5. m", "m", 5.0),
        ("0.16 um", "m", 0.16e-6),
        ("0.16 µm", "m", 0.16e-6),
        ("3 cm", "m", 0.03),
        ("70 degC", "K", 343.15),
        ("70 °C", "K", 343.15),
        ("-273.15 degC", "K", 0.0),
        ("343.15 K", "K", 343.15),
        ("5.2 mPa s", "Pa s", 0.0052),
        ("5.2 cP", "Pa s", 0.0052),
        ("4 MPa", "Pa", 4e6),
        ("4 N/mm2", "Pa", 4e6),
        ("4 N/mm²", "Pa", 4e6),
        ("4 N/mm^2", "N/m2", 4e6),
        ("208 GPa", "Pa", 208e9),
        ("1 bar", "Pa", 1e5),
        ("12 1/GPa", "1/Pa", 12e-9),
        ("0.5 mrad", "rad", 0.5e-3),
        ("180 deg", "rad", math.pi),
        ("3.2 mm2/s", "m2/s", 3.2e-6),
        ("3.2 cSt", "m2/s", 3.2e-6),
        ("0.1386 W/(m K)", "W/(m K)", 0.1386),
        ("0.47 kJ/(kg K)", "J/(kg K)", 470.0),
        ("0.07 1/(GPa K)", "1/(Pa K)", 0.07e-9),
        ("20.7 g", "kg", 0.0207),
        ("3415 N", "N", 3415.0),
        ("20 N/mm", "N/m", 20e3),
        ("50 N s/m", "N s/m", 50.0),
        ("0.2 N m", "N m", 0.2),
        ("0.2 N·m", "N m", 0.2),
        ("2 min", "s", 120.0),
        ("60 rpm", "rad/s", 2 * math.pi),
        ("10 %", "1", 0.1),
        ("0.1", "1", 0.1),
        # as catalogues and people write them; inch, pound and standard gravity are exact by definition (NIST SP 811)
        ("60 1/min", "rad/s", 2 * math.pi),
        ("60 min-1", "rad/s", 2 * math.pi),
        ("60 min⁻¹", "rad/s", 2 * math.pi),
        ("60 r/min", "rad/s", 2 * math.pi),
        ("60 RPM", "rad/s", 2 * math.pi),
        ("1 Hz", "rad/s", 2 * math.pi),
        ("5 Hz", "1/s", 5.0),
        ("5 s-1", "1/s", 5.0),
        ("70 C", "K", 343.15),
        ("158 degF", "K", 343.15),
        ("158 °F", "K", 343.15),
        ("1 in", "m", 0.0254),
        ("0.16 micron", "m", 0.16e-6),
        ("1 lbf", "N", 4.4482216152605),
        ("2 Nm", "N m", 2.0),
        ("5 mPa.s", "Pa s", 0.005),
        ("5 mPas", "Pa s", 0.005),
        ("46 W/mK", "W/(m K)", 46.0),
        ("0.5 W/mK", "W/K", 500.0),  # here millikelvins
        ("0.47 kJ/kgK", "J/(kg K)", 470.0),
        ("0.87 kg/L", "kg/m3", 870.0),
        ("0.87 kg/dm3", "kg/m3", 870.0),
        ("1 ksi", "Pa", 4.4482216152605e3 / 0.0254**2),
        ("2 mil", "m", 50.8e-6),
        ("0.5 inch", "m", 12.7e-3),
        ("1 psi", "Pa", float("6894.75729316836133672")),
        ("3.2e-6 m2 s-1", "m2/s", 3.2e-6),
        ("46 W m-1 K-1", "W/(m K)", 46.0),
        (15, "m", 15.0),
        (0.015, "m", 0.015),
    ],
)
def test_quantity_is_read_in_si(text: object, unit: str, value: float) -> None:
    read = quantity(text, unit)
    assert type(read) is float
    assert read == value


def test_rpm_is_two_pi_per_minute() -> None:
    assert quantity("6371 rpm", "rad/s") == pytest.approx(6371 * 2 * math.pi / 60, rel=1e-15)


@pytest.mark.parametrize(
    ("value", "unit", "message"),
    [
        ("1,5 mm", "m", "'1,5 mm': a decimal comma is not read; write '1.5 mm'"),
        ("1,500 mm", "m", "'1,500 mm': a decimal comma is not read; write '1500 mm' or '1.5 mm'"),
        (
            "3,000 rpm",
            "rad/s",
            "'3,000 rpm': a decimal comma is not read; write '3000 rpm' or '3 rpm'",
        ),
        ("3,000.5 rpm", "rad/s", "; write '3000.5 rpm'"),
        ("0,500 mm", "m", "; write '0.500 mm'"),
        (
            "1,000,5 mm",
            "m",
            "'1,000,5 mm': a decimal comma is not read; here a length is expected, such as '15 mm'",
        ),
        (
            "1.000,5 mm",
            "m",
            "'1.000,5 mm': a decimal comma is not read; here a length is expected, such as '15 mm'",
        ),
        ("15 kg", "m", "'15 kg' is a mass, here a length is expected, such as '15 mm'"),
        ("70 degC", "m", "'70 degC' is a temperature, here a length is expected, such as '15 mm'"),
        (
            "100 1/s",
            "rad/s",
            "'100 1/s' is a rate, here a rotational speed is expected, such as '6371 rpm'",
        ),
        (
            "15 m K",
            "m",
            "'15 m K' is a quantity in m K, here a length is expected, such as '15 mm'",
        ),
        ("15", "m", "'15' has no unit, here a length is expected, such as '15 mm'"),
        (
            "15 foot",
            "m",
            "'15 foot': 'foot' is not a unit that is known here; here a length is expected",
        ),
        ("15 MM", "m", "'15 MM': 'MM' is not a unit that is known here"),
        ("15 mm/", "m", "'mm/' is not a unit that is known here"),
        (
            "70 R",
            "K",
            "'R' is not a unit that is known here; here a temperature is expected, such as '70 degC'",
        ),
        (
            "2 KN",
            "N",
            "'KN' is not a unit that is known here (did you mean 'kN'?); here a force is expected",
        ),
        (
            "1500",
            "rad/s",
            "'1500' has no unit, here a rotational speed is expected, such as '1500 rpm'",
        ),
        ("70 degF", "m", "'70 degF' is a temperature, here a length is expected"),
        (
            "5 12 kN",
            "N",
            "'12 kN' is not a unit that is known here; here a force is expected, such as '3415 N'",
        ),
        ("5 1 kN", "N", "'1 kN' is not a unit that is known here"),
        ("5 12/s", "1/s", "'12/s' is not a unit that is known here"),
        ("5 Hz", "m", "'5 Hz' is a rate, here a length is expected"),
        ("5 turns", "rad/s", "'turns' is not a unit that is known here"),
        ("1 1/degC", "1/K", "'1/degC' is not a unit that is known here"),
        (
            "46 W/m K",
            "W/(m K)",
            "'W/m K' is ambiguous without parentheses; here a thermal conductivity is expected",
        ),
        ("mm", "m", "'mm' is not a number with a unit, here a length is expected, such as '15 mm'"),
        ("", "m", "'' is not a number with a unit"),
        ("nan mm", "m", "'nan mm' is not a number with a unit"),
        (
            "abc",
            "1",
            "'abc' is not a number with a unit, here a plain number is expected, such as 0.1",
        ),
        ("1" * 5000 + " m", "m", "is not a number with a unit"),
        ("1e999 m", "m", "'1e999 m' is not a finite number"),
        ("1e310 um", "m", "'1e310 um' is not a finite number"),
        ("1e1000000000 m", "m", "is not a unit that is known here"),
        (math.nan, "m", "nan is not a finite number, here a length is expected, such as '15 mm'"),
        (-math.inf, "m", "-inf is not a finite number"),
        (10**400, "m", "is not a finite number"),
        (True, "m", "true is not a quantity, here a length is expected, such as '15 mm'"),
        (False, "1", "false is not a quantity, here a plain number is expected, such as 0.1"),
        (None, "m", "None is not a quantity"),
        ([15], "m", "a list is not a quantity"),
        ({"value": 15}, "m", "a table is not a quantity"),
        ("-274 degC", "K", "'-274 degC' is below absolute zero, here a temperature is expected"),
        (-1, "K", "-1 is below absolute zero"),
    ],
)
def test_what_is_no_quantity_is_an_error_that_says_what_to_write(
    value: object, unit: str, message: str
) -> None:
    with pytest.raises(UnitError) as caught:
        quantity(value, unit)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 250
    assert isinstance(caught.value, ValueError)
    assert isinstance(caught.value, RollslipError)


@given(decimals)
def test_conversion_rounds_once(x: Decimal) -> None:
    text = f"{x:f}"
    assert quantity(f"{text} mm", "m") == float(f"{text}e-3")
    assert quantity(f"{text} um", "m") == float(f"{text}e-6")
    assert quantity(f"{text} GPa", "Pa") == float(f"{text}e9")
    assert quantity(f"{text} 1/GPa", "1/Pa") == float(f"{text}e-9")
    assert quantity(f"{text} %", "1") == float(f"{text}e-2")


@given(finite)
def test_a_written_float_is_read_as_the_same_float(x: float) -> None:
    assert quantity(f"{x!r} m", "m") == x
    assert quantity(x, "m") == x


@given(
    st.sampled_from(SI_UNITS), st.floats(1e-12, 1e12), st.sampled_from([-1, 1]), st.integers(6, 17)
)
def test_what_is_shown_can_be_read_again(unit: str, size: float, sign: int, digits: int) -> None:
    if unit == "K":
        assume(size > 1e-3)  # less may be rounded to below absolute zero
        shown = format_quantity(size, unit, 17)
        assert quantity(shown, unit) == pytest.approx(size, rel=1e-12, abs=1e-12)
        return
    value = sign * size
    shown = format_quantity(value, unit, digits)
    assert quantity(shown, unit) == pytest.approx(value, rel=max(10.0 ** (1 - digits), 1e-12))


@pytest.mark.parametrize(
    ("value", "unit", "shown"),
    [
        (0.015, "m", "15 mm"),
        (0.16e-6, "m", "0.16 um"),
        (0.0, "m", "0 m"),
        (-0.015, "m", "-15 mm"),
        (4e6, "Pa", "4 MPa"),
        (343.15, "K", "70 degC"),
        (667.17, "rad/s", "6371 rpm"),
        (0.0052, "Pa s", "5.2 mPa s"),
        (12e-9, "1/Pa", "12 1/GPa"),
        (0.1, "1", "0.1"),
        (3.0, "kg/s", "3 kg/s"),
        (math.inf, "m", "inf m"),
        (123456.0, "kg", "123456 kg"),
        (1.234567e9, "N", "1.23457e+06 kN"),
    ],
)
def test_people_are_shown_the_unit_in_use(value: float, unit: str, shown: str) -> None:
    assert format_quantity(value, unit) == shown


@pytest.mark.parametrize(
    ("given", "unit", "said_in", "shown"),
    [
        ("0.5 kN", "N", "kN", "0.5 kN"),
        ("20 deg", "rad", "deg", "20 deg"),
        ("667 rad/s", "rad/s", "rad/s", "667 rad/s"),
        ("5 W/(m  K)", "W/(m K)", "W/(m K)", "5 W/(m K)"),
        ("343 K", "K", "K", "343 K"),
        ("70 °C", "K", "°C", "70 degC"),
        ("5 %", "1", "%", "5 %"),
        ("0.05", "1", "1", "0.05"),
        ("70 C", "K", "C", "70 C"),
        ("158 degF", "K", "degF", "158 degF"),
        ("5 Nm", "N m", "Nm", "5 Nm"),
        ("22040.001 N", "N", "N", "22040 N"),
        ("6371 min-1", "rad/s", "min-1", "6371 min-1"),
        ("4 arcmin", "rad", "arcmin", "4 arcmin"),
        (0.015, "m", "m", "0.015 m"),
        (343.15, "K", "K", "343.15 K"),
    ],
)
def test_a_quantity_is_told_in_the_unit_in_which_it_was_given(
    given, unit: str, said_in: str, shown: str
) -> None:
    assert unit_given(given, unit) == said_in
    assert format_quantity(quantity(given, unit), unit, given=said_in) == shown


@pytest.mark.parametrize(
    ("given", "unit", "usual", "meant"),
    [
        (0.16, "m", (5e-9, 3e-6), "0.16 um"),
        ("14 mm", "m", (-1e-4, 1e-3), "14 um"),
        (6371, "rad/s", (-6e3, 6e3), "6371 rpm"),
        ("5 deg", "rad", (-5e-3, 5e-3), "5 arcmin"),
        (70, "K", (213.0, 523.0), "70 degC"),
        ("343 degC", "K", (213.0, 523.0), "343 K"),
        (7.8, "kg/m3", (2500, 9000), "7.8 g/cm3"),
        ("160 N", "N", (1e4, 1e6), "160 kN"),
        (1e308, "N", (0, 1e7), None),  # in kN beyond all floats
        ("1e-7 m", "m", (-1e-9, 1e-9), None),  # nobody writes 1e-7 um
        (5.0, "1", (10.0, 20.0), None),
    ],
)
def test_what_was_likely_meant_is_the_same_number_with_another_unit(
    given, unit: str, usual, meant
) -> None:
    low, high = usual
    value = quantity(given, unit)
    said_in = unit_given(given, unit)
    assert likely(value, said_in, unit, lambda other: low <= other <= high) == meant


@pytest.mark.parametrize("unit", SI_UNITS)
def test_every_example_is_what_it_is_an_example_of(unit: str) -> None:
    sentence = expectation(unit)
    example = sentence.rpartition("such as ")[2].strip("'")
    assert quantity(example, unit) >= 0


@pytest.mark.parametrize("unit", ["mm", "furlong", "%", "W/m K", ""])
def test_a_field_declares_an_si_unit(unit: str) -> None:
    with pytest.raises(UnitError):
        check_unit(unit)


@given(st.text(max_size=30), st.sampled_from(SI_UNITS))
def test_any_text_is_a_quantity_or_a_unit_error(text: str, unit: str) -> None:
    with contextlib.suppress(UnitError):
        assert math.isfinite(quantity(text, unit))


def test_long_values_are_cut_in_messages() -> None:
    assert len(as_written("x" * 10_000)) == 80


def test_errors_survive_a_process_boundary() -> None:
    error = pickle.loads(pickle.dumps(UnitError("a")))
    assert str(error) == "a"


def test_importing_units_is_cheap() -> None:
    heavy = "numpy", "scipy", "attrs", "json", "pint"
    code = f"import sys, rollslip.units; sys.exit(any(name in sys.modules for name in {heavy}))"
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.parametrize(
    ("low", "high", "bare"), [("500", "5 kN", "500"), ("0.5 kN", "5000", "5000")]
)
def test_both_ends_of_a_grid_have_a_unit_or_none(low, high, bare):
    with pytest.raises(
        UnitError,
        match=f"'{bare}' has no unit, the other end has one; write it at both ends, such as {bare} kN",
    ):
        evenly(low, high, 3, "N")


@pytest.mark.parametrize(
    ("low", "high", "values"),
    [
        ("0.5 kN", "1.5 kN", (500.0, 1000.0, 1500.0)),
        ("1 kN", "1300 N", (1000.0, 1100.0, 1200.0, 1300.0)),
        ("2", "1", (2.0, 1.0)),
        ("1 kN", "2 kN", (1000.0,)),
    ],
)
def test_even_values_begin_and_end_at_the_ends(low, high, values):
    assert evenly(low, high, len(values), "N") == values
