"""Properties as constants and as tables over temperature: curves, slopes, what a named oil keeps, and what is noted."""

import math
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import PchipInterpolator

from rollslip import evolve, load_scene, plan, run
from rollslip.bearing.assembly import assemble
from rollslip.errors import DomainError, SceneError
from rollslip.lubricant import Constant, Lubricant, SmoothTable, lubricant_from_table
from rollslip_plugins.data.lubricants import mil_prf_7808, sae_30

pytestmark = pytest.mark.quick

NAMED = {"mil-prf-7808": mil_prf_7808, "sae-30": sae_30}
#: As the paper's author lists them: constants at the working temperature.
CONSTANTS = {
    "viscosity": "5.17 mPa s",
    "thermoviscosity": "0.0227 1/K",
    "pressure_viscosity": "17.5 1/GPa",
    "pressure_thermoviscosity": "0.28 1/(GPa K)",
    "conductivity": "0.14 W/(m K)",
    "eyring_stress": "5.3 MPa",
    "shear_modulus": "0.3 GPa",
}


def read(**table):
    return lubricant_from_table(table, NAMED.__getitem__)


def over(unit, **values):
    """A table over degC: ``_40="12"`` is a value at 40 degC."""
    return {
        "temperature": [f"{key[1:]} degC" for key in values],
        "value": [f"{value} {unit}" for value in values.values()],
    }


# Curves


@given(
    st.lists(st.tuples(st.floats(1.0, 60.0), st.floats(1e-3, 1e3)), min_size=2, max_size=7),
    st.floats(0.0, 1.0),
)
def test_a_smooth_table_is_the_monotone_cubic_of_its_logarithm(steps, fraction):
    T = tuple(250.0 + sum(step for step, _ in steps[: k + 1]) for k in range(len(steps)))
    table = SmoothTable(T, tuple(value for _, value in steps))
    at = T[0] + fraction * (T[-1] - T[0])
    other = PchipInterpolator(T, np.log([value for _, value in steps]))
    assert math.log(table(at)) == pytest.approx(float(other(at)), rel=1e-9, abs=1e-9)
    assert table.derivative(at) / table(at) == pytest.approx(
        float(other.derivative()(at)), rel=1e-7, abs=1e-9
    )


def test_a_smooth_table_goes_on_as_an_exponential():
    table = SmoothTable((300.0, 320.0, 350.0), (8.0, 4.0, 3.0))
    for end, away in ((300.0, -30.0), (350.0, 40.0)):
        rate = table.derivative(end) / table(end)
        assert table(end + away) == pytest.approx(table(end) * math.exp(rate * away), rel=1e-12)
        assert table.derivative(end + away) == pytest.approx(rate * table(end + away), rel=1e-12)


@pytest.mark.parametrize(
    ("temperatures", "values", "message"),
    [
        ((300.0,), (0.1,), "two or more"),
        ((300.0, 300.0), (0.1, 0.2), "must rise"),
        ((300.0, 310.0), (0.1, 0.0), "must be positive"),
        ((300.0, 310.0), (0.1, math.inf), "must be positive"),
    ],
)
def test_a_smooth_table_refuses_what_is_none(temperatures, values, message):
    with pytest.raises(ValueError, match=message):
        SmoothTable(temperatures, values)


# What SmoothTable says of its error: against the laws behind the table of MIL-L-7808 that papers print.
NODES = (303.15, 313.15, 323.15, 343.15, 373.15)


@pytest.mark.parametrize(
    ("law", "values", "slopes", "at_ends"),
    [("viscosity", 0.0032, 0.02, 0.05), ("pressure_viscosity", 0.0008, 0.015, 0.035)],
)
def test_five_values_of_an_oil_give_its_curve(law, values, slopes, at_ends):
    of = getattr(mil_prf_7808, law)

    def rate(curve, T):
        return curve.derivative(T) / (curve(T) if law == "viscosity" else 1.0)  # -beta0, -gamma

    table = SmoothTable(NODES, tuple(of(T) for T in NODES))
    T = np.linspace(NODES[0], NODES[-1], 281)
    value = max(abs(table(t) / of(t) - 1.0) for t in T)
    slope = [abs(rate(table, t) / rate(of, t) - 1.0) for t in T]
    inside = max(e for t, e in zip(T, slope, strict=True) if NODES[1] <= t <= NODES[-2])
    assert 0.9 * values < value <= values
    assert 0.9 * slopes < inside <= slopes
    assert 0.9 * at_ends < max(slope) <= at_ends


# Constants, alone


def test_constants_alone_are_an_oil():
    oil = read(**CONSTANTS)
    for T in (303.15, 343.15):  # whatever the temperature of the scene is
        state = oil.at(T)
        assert (state.viscosity, state.thermoviscosity) == (5.17e-3, 0.0227)
        assert (state.pressure_viscosity, state.pressure_thermoviscosity) == (17.5e-9, 2.8e-10)
        assert (state.conductivity, state.eyring_stress, state.shear_modulus) == (
            0.14,
            5.3e6,
            0.3e9,
        )


def test_constants_without_a_slope_of_alpha_have_none():
    left = {key: value for key, value in CONSTANTS.items() if key != "pressure_thermoviscosity"}
    assert read(**left).at(343.15).pressure_thermoviscosity == 0.0


# Over a named oil


def test_a_constant_replaces_the_value_alone():
    named = mil_prf_7808.at(343.15)
    oil = read(name="mil-prf-7808", viscosity="4 mPa s", pressure_viscosity="12 1/GPa")
    state = oil.at(343.15)
    assert (state.viscosity, state.pressure_viscosity) == (4e-3, 12e-9)
    assert (state.thermoviscosity, state.pressure_thermoviscosity) == (
        named.thermoviscosity,
        named.pressure_thermoviscosity,
    )
    assert (oil.minimum_temperature, oil.maximum_temperature) == (273.15, 473.15)


def test_a_slope_replaces_the_slope_alone():
    named = mil_prf_7808.at(343.15)
    state = read(
        name="mil-prf-7808", thermoviscosity=0.03, pressure_thermoviscosity="-0.1 1/(GPa K)"
    ).at(343.15)
    assert (state.viscosity, state.pressure_viscosity) == (
        named.viscosity,
        named.pressure_viscosity,
    )
    assert (state.thermoviscosity, state.pressure_thermoviscosity) == (0.03, -1e-10)


def test_factors_multiply_what_stands_there():
    factors = {
        "pressure_viscosity_factor": 1.1,
        "pressure_thermoviscosity_factor": 0.5,
        "viscosity_factor": 2.0,
    }
    oil = read(**CONSTANTS, **factors)
    state = oil.at(343.15)
    assert state.viscosity == pytest.approx(2 * 5.17e-3)
    assert state.pressure_viscosity == pytest.approx(1.1 * 17.5e-9)
    assert state.pressure_thermoviscosity == pytest.approx(1.1 * 0.5 * 2.8e-10)
    kept = read(
        name="mil-prf-7808", pressure_viscosity="12 1/GPa", pressure_viscosity_factor=1.1
    ).at(343.15)
    assert kept.pressure_thermoviscosity == pytest.approx(
        1.1 * mil_prf_7808.at(343.15).pressure_thermoviscosity
    )


# Tables


def test_tables_bring_their_slopes_and_their_range():
    oil = read(
        viscosity=over("mPa s", _30="16.34", _50="8.58", _70="5.17", _100="2.87"),
        pressure_viscosity=over("1/GPa", _40="11.77", _100="7.57"),
        conductivity=over("W/(m K)", _30="0.145", _100="0.1338"),
        eyring_stress=over("MPa", _40="6", _100="4"),
        shear_modulus=over("GPa", _40="0.4", _100="0.2"),
        density=over("kg/m3", _30="900", _100="850"),
    )
    assert (oil.minimum_temperature, oil.maximum_temperature) == (313.15, 373.15)
    state = oil.at(343.15)
    assert state.viscosity == pytest.approx(5.17e-3, rel=1e-12)
    assert state.pressure_viscosity == pytest.approx(
        math.sqrt(11.77e-9 * 7.57e-9), rel=1e-12
    )  # an exponential of two
    assert state.pressure_thermoviscosity == pytest.approx(
        state.pressure_viscosity * math.log(11.77 / 7.57) / 60.0
    )
    assert state.eyring_stress == pytest.approx(math.sqrt(24.0) * 1e6, rel=1e-12)
    assert state.shear_modulus == pytest.approx(math.sqrt(0.08) * 1e9, rel=1e-12)
    assert 0.02 < state.thermoviscosity < 0.03  # 0.0227 of the law behind the table
    with pytest.raises(
        DomainError, match=r"own oil at 30 degC: its data hold from 40 degC to 100 degC"
    ):
        oil.at(303.15)


def test_slopes_may_be_tables_too():
    oil = read(**CONSTANTS | {"pressure_thermoviscosity": over("1/(GPa K)", _40="0.3", _60="-0.1")})
    assert oil.at(323.15).pressure_thermoviscosity == pytest.approx(1e-10, rel=1e-9)


def test_points_take_a_density_over_temperature():
    points = [
        {"temperature": f"{c} degC", "kinematic_viscosity": f"{nu} mm2/s"}
        for c, nu in ((40, 14), (100, 3.4))
    ]
    oil = read(viscosity_law="walther", points=points, density=over("kg/m3", _40="900", _100="850"))
    assert oil.at(313.15).viscosity == pytest.approx(900 * 14e-6, rel=1e-12)
    assert oil.at(373.15).viscosity == pytest.approx(850 * 3.4e-6, rel=1e-12)


def test_a_table_over_a_named_oil_narrows_its_range():
    oil = read(name="sae-30", eyring_stress=over("MPa", _40="6", _100="4"))
    assert (oil.minimum_temperature, oil.maximum_temperature) == (313.15, 373.15)
    wider = read(
        name="sae-30", eyring_stress=over("MPa", _40="6", _100="4"), maximum_temperature="150 degC"
    )
    assert wider.at(423.15).eyring_stress == pytest.approx(
        4e6 * (4.0 / 6.0) ** (50.0 / 60.0), rel=1e-12
    )


# What is noted


def test_what_fits_together_is_not_noted():
    assert mil_prf_7808.notes(343.15) == []
    assert sae_30.notes(343.15) == []
    assert (
        read(
            name="sae-30", pressure_viscosity="17 1/GPa", pressure_thermoviscosity="0 1/(GPa K)"
        ).notes(343.15)
        == []
    )
    tables = {"pressure_viscosity": over("1/GPa", _40="11.77", _100="7.57")}
    assert read(name="mil-prf-7808", **tables).notes(343.15) == []


def test_constants_that_fit_at_one_temperature_only_are_noted():
    viscosity, alpha = read(**CONSTANTS).notes(343.15)
    assert viscosity == (
        "lubricant.thermoviscosity is 0.0227 1/K at 70 degC, but lubricant.viscosity is the same at every temperature: "
        "they fit together at one temperature only, 10 K from it viscosity would differ by 23%; to have both, give "
        "lubricant.viscosity as a table over temperature and leave out thermoviscosity"
    )
    assert alpha.startswith(
        "lubricant.pressure_thermoviscosity is 0.28 1/(GPa K) at 70 degC, but lubricant.pressure_v"
    )
    assert "pressure_viscosity would differ by 16%" in alpha  # 10 K 0.28/17.5


def test_a_slope_beside_a_law_is_noted_with_both_numbers():
    (note,) = read(name="mil-prf-7808", thermoviscosity=0.03).notes(343.15)
    assert (
        "thermoviscosity is 0.03 1/K at 70 degC, but lubricant.viscosity falls by 0.0227 1/K"
        in note
    )


def test_a_result_has_the_notes_and_runs():
    scene = evolve(
        load_scene("1032930-70C"), {"lubricant": CONSTANTS, "study.friction-curve.points": 5}
    )
    warnings = run(scene, "friction-curve").attrs["warnings"]
    assert "pressure_viscosity would differ by 16%" in warnings
    assert "would differ" not in run(load_scene("1032930-70C"), "friction-curve").attrs["warnings"]


def test_a_scene_reads_tables_and_says_the_place_of_a_fault():
    scene = evolve(
        load_scene("1032930-70C"),
        {"lubricant.eyring_stress": over("MPa", _60="6", _80="4")},
        si=True,
    )
    assert assemble(scene).inner.conditions.eyring_stress == pytest.approx(math.sqrt(24.0) * 1e6)
    with pytest.raises(SceneError) as caught:
        plan(evolve(scene, {"lubricant.eyring_stress.value": ["6 MPa", "4 mm"]}))
    assert caught.value.problems[0].startswith(
        "changes: lubricant.eyring_stress.value[1]: '4 mm' is a length"
    )


def test_an_oil_of_tables_and_constants_goes_to_other_processes():
    oil = read(
        name="mil-prf-7808", viscosity="4 mPa s", eyring_stress=over("MPa", _40="6", _100="4")
    )
    assert pickle.loads(pickle.dumps(oil)) == oil
    assert pickle.loads(pickle.dumps(oil)).at(343.15) == oil.at(343.15)


def test_an_oil_may_have_laws_of_its_shear_properties():
    oil = Lubricant(
        name="x", description="", viscosity=Constant(0.01), minimum_temperature=300.0, maximum_temperature=400.0,
        source="", eyring_stress=SmoothTable((300.0, 400.0), (8e6, 2e6)), shear_modulus=5e8,
    )  # fmt: skip
    assert (oil.at(350.0).eyring_stress, oil.at(350.0).shear_modulus) == (
        pytest.approx(4e6, rel=1e-12),
        5e8,
    )
