"""The oils: reference numbers, derivatives, fits, ranges, and what a scene may write."""

import math
import subprocess
import sys
from itertools import pairwise

import numpy as np
import pytest
from attrs import asdict, evolve
from hypothesis import given
from hypothesis import strategies as st

from rollslip.catalogue.registry import available, get_class
from rollslip.errors import DomainError, SceneError
from rollslip.lubricant import (
    Andrade,
    Constant,
    Exponential,
    Hyperbola,
    Lubricant,
    PowerOfViscosity,
    Table,
    Vogel,
    Walther,
    fit_vogel,
    fit_walther,
    lubricant_from_table,
)
from rollslip.structure import Location
from tabled import REFERENCES, rows_of

pytestmark = pytest.mark.quick

OILS = {name: get_class("lubricant", name) for name in available("lubricant")}
every_oil = pytest.mark.parametrize("oil", OILS.values(), ids=OILS)

LAWS = [
    Constant(2.0),
    Table((300.0, 320.0, 350.0), (0.15, 0.14, 0.12)),
    Walther(intercept=9.5, slope=3.7, constant=0.8, scale=9e-4),
    Vogel(limit=5e-5, slope=900.0, pole=170.0),
    Andrade(reference_viscosity=0.03, reference_temperature=311.0, slope=3600.0, curvature=8e5),
    Hyperbola(limit=8e-10, slope=1.1e-6, pole=215.0),
    Exponential(reference_value=4e-8, reference_temperature=278.0, rate=0.008),
    PowerOfViscosity(Vogel(limit=5e-5, slope=900.0, pole=170.0), factor=2.5e-8, exponent=0.16),
]


# Reference numbers


REFERENCE = rows_of(REFERENCES / "viscosity.csv")


@pytest.mark.parametrize("oil", dict.fromkeys(row["oil"] for row in REFERENCE))
def test_oils_agree_with_fifty_digit_arithmetic(oil):
    for row in (row for row in REFERENCE if row["oil"] == oil):
        state = asdict(OILS[oil].at(float(row["temperature"])))
        for column in (
            "viscosity",
            "pressure_viscosity",
            "thermoviscosity",
            "pressure_thermoviscosity",
        ):
            assert state[column] == pytest.approx(float(row[column]), rel=1e-13, abs=0.0), (
                column,
                row,
            )


# The collection of formulas behind these oils prints 16.35 mPa s at 30 degC; its own formula gives 16.3446.
# degC: eta [mPa s], alpha [1/GPa], beta0 [1/K], gamma [1e-10/(Pa K)], K_f [W/(m K)], each rounded as printed
MIL_L_7808 = {
    30: ("16.34", "13.02", "0.0366", "1.40", "0.145"),
    40: ("11.60", "11.77", "0.0321", "1.13", "0.144"),
    50: ("8.58", "10.74", "0.0284", "0.93", "0.1425"),
    70: ("5.17", "9.18", "0.0227", "0.66", "0.1386"),
    100: ("2.87", "7.57", "0.0171", "0.43", "0.1338"),
}


@pytest.mark.parametrize("celsius", MIL_L_7808)
def test_mil_prf_7808_gives_its_printed_table(celsius):
    state = OILS["mil-prf-7808"].at(celsius + 273.15)
    values = (
        1e3 * state.viscosity,
        1e9 * state.pressure_viscosity,
        state.thermoviscosity,
        1e10 * state.pressure_thermoviscosity,
        state.conductivity,
    )
    for value, printed in zip(values, MIL_L_7808[celsius], strict=True):
        assert f"{value:.{len(printed.split('.')[1])}f}" == printed


# Laws


@pytest.mark.parametrize("law", LAWS, ids=lambda law: type(law).__name__)
@pytest.mark.parametrize("T", [305.0, 333.0, 345.0])
def test_derivative_is_the_slope(law, T):
    step = 1e-2
    difference = (8 * (law(T + step) - law(T - step)) - (law(T + 2 * step) - law(T - 2 * step))) / (
        12 * step
    )
    assert law.derivative(T) == pytest.approx(difference, rel=1e-9)


def test_table_holds_its_nodes_and_its_ends():
    law = Table((300.0, 320.0, 350.0), (0.15, 0.14, 0.12))
    assert [law(T) for T in law.temperatures] == pytest.approx(law.values, rel=1e-15)
    assert law(310.0) == pytest.approx(0.145)
    assert (law(200.0), law(500.0)) == (0.15, pytest.approx(0.12))
    assert (law.derivative(200.0), law.derivative(350.0), law.derivative(500.0)) == (0.0, 0.0, 0.0)
    assert law.derivative(320.0) == pytest.approx(-0.02 / 30)


@pytest.mark.parametrize(
    ("temperatures", "values", "message"),
    [
        ((300.0,), (0.1,), "two or more"),
        ((300.0, 310.0), (0.1,), "one value for each"),
        ((300.0, 300.0), (0.1, 0.2), "must rise"),
    ],
)
def test_table_refuses_what_is_not_a_table(temperatures, values, message):
    with pytest.raises(ValueError, match=message):
        Table(temperatures, values)


# Oils


@every_oil
def test_viscosity_and_its_pressure_coefficient_fall_over_the_range(oil):
    low = oil.minimum_temperature
    high = oil.maximum_temperature
    states = [oil.at(low + (high - low) * i / 100) for i in range(101)]
    assert all(cold.viscosity > warm.viscosity > 0.0 for cold, warm in pairwise(states))
    assert all(
        cold.pressure_viscosity >= warm.pressure_viscosity > 0.0 for cold, warm in pairwise(states)
    )
    assert all(
        state.thermoviscosity > 0.0 and state.pressure_thermoviscosity >= 0.0 for state in states
    )


@every_oil
def test_an_oil_says_where_its_data_come_from(oil):
    assert oil.description
    assert oil.references
    for grade in ("(C)", "(D)"):
        assert grade in oil.source


def test_what_an_oil_lacks_is_nan():
    bare = Lubricant(
        name="bare",
        description="",
        viscosity=Constant(0.01),
        minimum_temperature=300.0,
        maximum_temperature=400.0,
        source="",
    ).at(350.0)
    lacking = {key for key, value in asdict(bare).items() if math.isnan(value)}
    assert lacking == {
        "pressure_viscosity",
        "pressure_thermoviscosity",
        "conductivity",
        "eyring_stress",
        "shear_modulus",
    }
    assert bare.thermoviscosity == 0.0


def test_the_range_error_names_oil_temperature_range_and_remedy():
    with pytest.raises(DomainError) as caught:
        OILS["mil-prf-7808"].at(523.15)
    for part in ("mil-prf-7808", "250 degC", "0 degC to 200 degC", "lubricant.maximum_temperature"):
        assert part in str(caught.value)


def test_factors_multiply_viscosity_alpha_and_gamma():
    oil = OILS["mil-prf-7808"]
    scaled = evolve(
        oil,
        viscosity_factor=1.1,
        pressure_viscosity_factor=1.25,
        pressure_thermoviscosity_factor=0.8,
    ).at(323.15)
    plain = oil.at(323.15)
    assert scaled.viscosity == pytest.approx(1.1 * plain.viscosity)
    assert scaled.thermoviscosity == plain.thermoviscosity
    assert scaled.pressure_viscosity == pytest.approx(1.25 * plain.pressure_viscosity)
    assert scaled.pressure_thermoviscosity == pytest.approx(
        1.25 * 0.8 * plain.pressure_thermoviscosity
    )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"viscosity_factor": 0.0}, "viscosity_factor"),
        ({"eyring_stress": -1.0}, "eyring_stress"),
        ({"minimum_temperature": 480.0}, "not below"),
        ({"viscosity": Vogel(5e-5, 900.0, 280.0)}, "does not fall"),
        ({"viscosity": Vogel(5e-5, 900.0, 273.15)}, "does not fall"),
    ],
)
def test_an_impossible_oil_is_refused(change, message):
    with pytest.raises(ValueError, match=message):
        evolve(OILS["mil-prf-7808"], **change)


# Fits

kelvin = st.floats(250.0, 450.0)
gap = st.floats(10.0, 60.0)
drop = st.floats(1.2, 5.0)


@given(T=kelvin, step=gap, nu=st.floats(1e-6, 5e-4), ratio=drop)
def test_walther_passes_through_two_points(T, step, nu, ratio):
    T = [T, T + step]
    nu = [ratio * nu, nu]
    law = fit_walther(T, nu, density=900.0)
    assert [law(t) / 900.0 for t in T] == pytest.approx(nu, rel=1e-12)


@given(
    T=kelvin,
    step=gap,
    other=gap,
    eta=st.floats(1e-3, 1.0),
    slope=st.floats(300.0, 2000.0),
    pole=st.floats(0, 200),
)
def test_vogel_passes_through_three_points(T, step, other, eta, slope, pole):
    truth = Vogel(eta / math.exp(slope / (T - pole)), slope, pole)
    T = [T + step, T, T + step + other]  # in any order
    points = [truth(t) for t in T]
    law = fit_vogel(T, points)
    assert [law(t) for t in T] == pytest.approx(points, rel=1e-12)


def test_vogel_finds_its_own_constants():
    truth = Vogel(5e-5, 900.0, 170.0)
    for count in (3, 4, 9):
        T = [290.0 + 15.0 * i for i in range(count)]
        law = fit_vogel(T, [truth(t) for t in T])
        assert asdict(law) == pytest.approx(asdict(truth), rel=1e-7)


@given(st.lists(st.floats(-0.02, 0.02), min_size=7, max_size=7))
def test_fits_through_more_points_are_least_squares(noise):
    truth = Vogel(5e-5, 900.0, 170.0)
    T = [290.0 + 15.0 * i for i in range(7)]
    eta = [truth(t) * (1.0 + e) for t, e in zip(T, noise, strict=True)]
    law = fit_vogel(T, eta)

    def misfit(law):
        return sum(math.log(law(t) / v) ** 2 for t, v in zip(T, eta, strict=True))

    assert misfit(law) <= misfit(truth) + 1e-15
    for name in ("limit", "slope", "pole"):
        for change in (1.0 - 1e-4, 1.0 + 1e-4):
            assert misfit(law) <= misfit(evolve(law, **{name: change * getattr(law, name)})) + 1e-12


def test_walther_through_more_points_recovers_its_law():
    truth = Walther(9.5, 3.7, 0.7, 9e-4)
    T = [290.0 + 15.0 * i for i in range(7)]
    assert asdict(fit_walther(T, [truth(t) / 900.0 for t in T], 900.0)) == pytest.approx(
        asdict(truth), rel=1e-12
    )


@pytest.mark.parametrize(
    ("temperatures", "viscosities", "message"),
    [
        ([300.0, 320.0], [0.02, 0.01], "3 or more points, got 2"),
        ([300.0, 320.0, 340.0], [0.02, 0.01], "3 temperatures but 2 viscosities"),
        ([300.0, 320.0, 300.0], [0.02, 0.01, 0.005], "two points at 26.85 degC"),
        ([300.0, 320.0, 340.0], [0.02, 0.01, 0.01], "does not fall from 46.85 degC to 66.85 degC"),
        ([300.0, 320.0, 340.0], [0.02, 0.01, 0.0], "must be positive, got 0 at 340 K"),
        ([300.0, 320.0, 340.0], [0.04, 0.02, 0.01], "hardly flattens"),
        ([300.0, 320.0, 340.0], [0.04, 0.03, 0.01], "hardly flattens"),
        ([300.0, 320.0, 340.0, 360.0], [0.08, 0.04, 0.02, 0.01], "hardly flattens"),
        ([300.0, 320.0, 340.0, 360.0], [0.08, 0.07, 0.05, 0.01], "hardly flattens"),
    ],
)
def test_points_that_no_vogel_law_fits_are_refused(temperatures, viscosities, message):
    with pytest.raises(ValueError, match=message):
        fit_vogel(temperatures, viscosities)


@pytest.mark.parametrize(
    ("temperatures", "viscosities", "message"),
    [
        ([300.0], [2e-5], "2 or more points, got 1"),
        ([300.0, 300.0], [2e-5, 1e-5], "two points at"),
        ([300.0, 320.0], [2e-5, -1e-5], "must be positive"),
        ([300.0, 320.0], [2e-6, 0.2e-6], "down to 0.2 mm2/s, only above 0.3 mm2/s"),
    ],
)
def test_points_that_no_walther_law_fits_are_refused(temperatures, viscosities, message):
    with pytest.raises(ValueError, match=message):
        fit_walther(temperatures, viscosities, 900.0)


# The [lubricant] table of a scene

MEASURED = [
    {"temperature": "40 degC", "viscosity": "12 mPa s"},
    {"temperature": "70 degC", "viscosity": "5.2 mPa s"},
    {"temperature": "100 degC", "viscosity": "2.9 mPa s"},
]
KINEMATIC = [
    {"temperature": "40 degC", "kinematic_viscosity": "14 mm2/s"},
    {"temperature": "100 degC", "kinematic_viscosity": "3.2 mm2/s"},
]


def read(**table):
    return lubricant_from_table(table, OILS.__getitem__)


def test_a_name_alone_is_the_shipped_oil():
    assert read(name="mil-prf-7808") == OILS["mil-prf-7808"]


def test_other_keys_override_the_shipped_oil():
    oil = read(
        name="sae-30",
        eyring_stress="6 MPa",
        shear_modulus=0.5e9,
        pressure_viscosity="12 1/GPa",
        conductivity="0.14 W/(m K)",
        minimum_temperature="20 degC",
        pressure_viscosity_factor=1.1,
        description="as delivered",
        source="Our rig.",
    )
    state = oil.at(330.0)
    assert (oil.name, oil.description) == ("sae-30", "as delivered")
    assert (state.eyring_stress, state.shear_modulus, state.conductivity) == (6e6, 0.5e9, 0.14)
    assert state.pressure_viscosity == pytest.approx(1.1 * 12e-9)
    # the slope is that of the shipped oil, with the factor on the coefficient
    slope = OILS["sae-30"].at(330.0).pressure_thermoviscosity
    assert state.pressure_thermoviscosity == pytest.approx(1.1 * slope)
    assert oil.minimum_temperature == pytest.approx(293.15)
    assert oil.maximum_temperature == OILS["sae-30"].maximum_temperature
    assert oil.source.startswith(OILS["sae-30"].source)
    assert "Our rig. Set by the scene: " in oil.source
    assert "eyring_stress" in oil.source


def test_an_own_oil_passes_through_its_points_and_lacks_the_rest():
    oil = read(viscosity_law="vogel", points=MEASURED)
    assert [oil.at(c + 273.15).viscosity for c in (40, 70, 100)] == pytest.approx(
        [12e-3, 5.2e-3, 2.9e-3]
    )
    assert (oil.minimum_temperature, oil.maximum_temperature) == pytest.approx((293.15, 393.15))
    assert math.isnan(oil.at(330.0).pressure_viscosity)


@pytest.mark.parametrize("law", ["walther", "vogel"])
def test_density_stands_between_kinematic_and_dynamic_viscosity(law):
    middle = {"temperature": "70 degC", "viscosity": "5.7 mPa s"}
    oil = read(viscosity_law=law, points=[KINEMATIC[0], middle, KINEMATIC[1]], density="950 kg/m3")
    assert oil.at(313.15).viscosity == pytest.approx(950 * 14e-6, rel=2e-2)
    if law == "vogel":
        assert oil.at(343.15).viscosity == pytest.approx(5.7e-3)


def test_a_range_given_replaces_that_of_the_points():
    oil = read(
        viscosity_law="vogel",
        points=MEASURED,
        minimum_temperature="30 degC",
        maximum_temperature="150 degC",
    )
    assert (oil.minimum_temperature, oil.maximum_temperature) == pytest.approx((303.15, 423.15))


def test_points_with_a_name_replace_the_viscosity_within_the_range_of_both():
    named = evolve(OILS["mil-prf-7808"], minimum_temperature=300.0)
    oil = lubricant_from_table(
        {"name": "x", "viscosity_law": "vogel", "points": MEASURED}, {"x": named}.__getitem__
    )
    assert oil.viscosity == fit_vogel([313.15, 343.15, 373.15], [12e-3, 5.2e-3, 2.9e-3])
    assert oil.pressure_viscosity == named.pressure_viscosity
    assert (oil.minimum_temperature, oil.maximum_temperature) == pytest.approx((300.0, 393.15))


@pytest.mark.parametrize(
    ("table", "expected"),
    [
        ({}, ["lubricant.name: missing"]),
        ({"eyring_stress": "4 MPa"}, ["lubricant.name: missing"]),
        ({"name": 7808}, ["lubricant.name: "]),
        ({"name": "sae-30", "eyring_stres": 1.0}, ["lubricant.eyring_stres: unknown"]),
        ({"name": "sae-30", "eyring_stress": "4 mm"}, ["lubricant.eyring_stress: "]),
        (
            {"name": "sae-30", "eyring_stress": "-4 MPa", "viscosity_factor": 0},
            ["lubricant.eyring_", "lubricant.visc"],
        ),
        (
            {"name": "sae-30", "minimum_temperature": "300 degC"},
            ["lubricant.minimum_temperature: 300 degC is not"],
        ),
        ({"name": "sae-30", "viscosity_law": "vogel"}, ["lubricant.points: missing"]),
        ({"viscosity_law": "vogel"}, ["lubricant.name: missing"]),
        ({"points": MEASURED}, ["lubricant.viscosity_law: missing"]),
        (
            {"viscosity": "5 mPa s"},
            ["lubricant.thermoviscosity: missing; one viscosity does not say how it falls"],
        ),
        (
            {"name": "sae-30", "viscosity": 0.0},
            ["lubricant.viscosity: must be above 0, not 0 Pa s"],
        ),
        ({"name": "sae-30", "viscosity": "5 mPa"}, ["lubricant.viscosity: '5 mPa' is a pressure"]),
        (
            {"name": "sae-30", "thermoviscosity": "-0.02 1/K"},
            ["lubricant.thermoviscosity: must be at least 0"],
        ),
        (
            {"viscosity": 0.005, "viscosity_law": "vogel", "points": MEASURED},
            ["lubricant.viscosity: not beside points"],
        ),
        (
            {
                "name": "sae-30",
                "conductivity": {"temperature": ["40 degC"], "value": ["0.14 W/(m K)"]},
            },
            ["lubricant.conductivity.temperature: a table needs two or more temperatures, not 1"],
        ),
        (
            {"name": "sae-30", "conductivity": {"temperature": [300.0, 350.0], "value": [0.14]}},
            ["lubricant.conductivity.value: needs one value for each of 2, not 1"],
        ),
        (
            {
                "name": "sae-30",
                "conductivity": {"temperature": [350.0, 300.0], "value": [0.14, 0.13]},
            },
            ["lubricant.conductivity.temperature: must rise"],
        ),
        (
            {
                "name": "sae-30",
                "conductivity": {"temperature": [300.0, 350.0], "value": [0.14, "0.13 W"]},
            },
            [
                "lubricant.conductivity.value[1]: '0.13 W' is a power, here a thermal conductivity is expected"
            ],
        ),
        (
            {
                "name": "sae-30",
                "conductivity": {"temperature": [300.0, 350.0], "value": [0.14, -0.13]},
            },
            ["lubricant.conductivity: must be above 0, not -0.13 W/(m K)"],
        ),
        (
            {
                "name": "sae-30",
                "conductivity": {"temperature": [300.0, 350.0], "values": [0.14, 0.13]},
            },
            [
                "lubricant.conductivity.values: unknown key, did you mean 'value'?",
                "lubricant.conductivity.value: miss",
            ],
        ),
        (
            {
                "name": "sae-30",
                "conductivity": {"temperature": [600.0, 650.0], "value": [0.14, 0.13]},
            },
            [
                "lubricant.conductivity: has no temperatures in common with the rest of the oil's data"
            ],
        ),
        ({"viscosity_law": "reynolds", "points": MEASURED}, ["lubricant.viscosity_law: "]),
        ({"viscosity_law": "walther", "points": MEASURED}, ["lubricant.density: missing"]),
        ({"viscosity_law": "vogel", "points": KINEMATIC}, ["lubricant.density: missing"]),
        (
            {"viscosity_law": "vogel", "points": MEASURED[:2]},
            ["lubricant.points: the vogel law needs 3 or more"],
        ),
        (
            {"viscosity_law": "vogel", "points": [{"temperature": 300.0}]},
            ["lubricant.points[0].viscosity: give either"],
        ),
        (
            {"viscosity_law": "vogel", "points": [MEASURED[0] | KINEMATIC[0]]},
            ["lubricant.points[0].viscosity: give either"],
        ),
        (
            {
                "viscosity_law": "vogel",
                "points": [*MEASURED, {"temperature": "90 mm", "viscosity": "3 mPa s"}],
            },
            ["lubricant.points[3].temperature: "],
        ),
    ],
)
def test_a_table_with_faults_names_each(table, expected):
    with pytest.raises(SceneError) as caught:
        read(**table)
    assert len(caught.value.problems) == len(expected)
    for problem, start in zip(caught.value.problems, expected, strict=True):
        assert problem.startswith(start)


def test_problems_carry_the_place_in_the_scene():
    where = Location({("lubricant", "eyring_stress"): "scene.toml:8"}, ("lubricant",))
    with pytest.raises(SceneError) as caught:
        lubricant_from_table({"name": "sae-30", "eyring_stress": "4"}, OILS.__getitem__, where)
    assert caught.value.problems[0].startswith("scene.toml:8: lubricant.eyring_stress: ")


def test_an_unknown_name_is_left_to_the_catalogue():
    with pytest.raises(KeyError):
        read(name="castor")


def test_oils_need_no_scipy_to_be_described():
    code = "import sys, rollslip.lubricant; sys.exit('scipy' in sys.modules)"
    assert (
        subprocess.run(
            [sys.executable, "-c", code], check=False, env={"PYTHONPATH": ":".join(sys.path)}
        ).returncode
        == 0
    )


@pytest.mark.parametrize("name", sorted(OILS))
def test_no_built_in_oil_thickens_with_heat_where_bearings_run(name):
    """Up to 2 GPa, and the temperature to which oils of bearings go; or heat would take no part in their friction."""
    oil = OILS[name]
    for temperature in np.linspace(max(oil.minimum_temperature, 283.15), 393.15, 7):
        state = oil.at(float(temperature))
        _, fall = oil.pressure_viscosity_law.at(state, np.linspace(0.0, 2e9, 50))
        assert (fall > 0.0).all(), temperature
