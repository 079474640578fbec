"""The pressure in a film against numerical line contacts, its limits, and what rests on it in a bearing."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.optimize import brentq

from rollslip import Chain, Conditions, Slices, evolve, get_model, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.bearing.regimes import moes_groups
from rollslip.models import PressureModel
from rollslip.scene.reading import parse_scene
from rollslip.testing.samples import NumpyForm
from rollslip_plugins.film.line_contact import solve_line_contact
from rollslip_plugins.film_pressure import LOADS, LUBRICANTS, SOLVED, LightContact
from scene_samples import scene_with
from tabled import REFERENCES, numbers_of

#: Reduced radius [m] and modulus [Pa] of the contact, viscosity of the oil [Pa s].
STEEL = {"radius": 0.01, "modulus": 2e11, "viscosity": 0.01}
#: Rolling speed [m/s].
SPEED = 20.0
Us = 2 * 0.01 * SPEED / (2e11 * 0.01)


def filled(M, L, name="light-contact", compiled=True, film=1.0):
    """Slices at Moes's M, all with one L."""
    oil = Conditions(**STEEL, pressure_viscosity=L / Us**0.25 / 2e11)
    slices = Slices(
        len(M),
        oil,
        load=np.asarray(M) * np.sqrt(Us) * 2e9,
        rolling_speed=SPEED,
        film_thickness=film,
    )
    model = get_model("pressure", name)
    Chain(model)(slices) if compiled else model.evaluate(slices)
    np.testing.assert_allclose(moes_groups(slices)[0], M, rtol=1e-12)
    return slices


def ratio(M, L, compiled=True):
    hertz = np.sqrt(np.pi * 2e11 * np.asarray(M) * np.sqrt(Us) * 2e9 / 0.32)
    return filled(M, L, compiled=compiled).pressure / hertz


REFERENCE = numbers_of(REFERENCES / "light_contacts.csv")


def test_the_ratio_is_that_of_finite_volumes():
    assert len(REFERENCE) == 15
    for row in REFERENCE[1:]:
        assert row["uncertainty"] < 1e-3
        # the fit was made to 2 % (rms) and 4 % (worst) of other solutions
        assert ratio([row["M"]], row["L"])[0] == pytest.approx(row["ratio"], rel=0.04), row


@pytest.mark.parametrize(
    ("M", "L"), [(0.05, 10.0), (0.9, 11.0), (0.6, 13.0), (1.2, 13.0), (0.85, 16.5), (1.5, 20.0)]
)
def test_between_the_values_of_the_table_it_is_that_of_a_solution(M, L):
    contact = solve_line_contact(M, L)
    mean = np.trapezoid(contact.pressure**2, contact.x) / np.trapezoid(contact.pressure, contact.x)
    expected = min(
        mean / (8 / (3 * np.pi) * np.sqrt(M / (2 * np.pi))), 1.0
    )  # above it is Barus's spike
    assert ratio([M], L)[0] == pytest.approx(expected, rel=0.035)


def test_from_the_first_column_on_it_is_the_table_cut_at_one():
    for L, values in zip(LUBRICANTS, SOLVED, strict=True):
        np.testing.assert_allclose(ratio(LOADS, L), np.minimum(values, 1.0), rtol=1e-12)


@pytest.mark.parametrize("L", [0.0, 5.0, 10.0, 11.0, 14.0, 25.0, 60.0])
def test_it_ends_in_a_rigid_contact_and_in_hertz(L):
    M = np.array([1e-6, 1e-3])
    np.testing.assert_allclose(ratio(M, L), M / 2, rtol=1e-3)
    # exactly, a rigid, isoviscous film has a little more: the fit ends in M/2
    assert ratio([1e-6], 0.0)[0] / 1e-6 == pytest.approx(REFERENCE[0]["ratio"], rel=0.02)
    assert ratio([1e4], L)[0] == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize("compiled", [True, False])
def test_a_film_that_is_too_thin_for_its_load_is_narrow(compiled):
    """Where the gap is three times as wide as the film, no film carries load; contacts full of oil stay as they are."""
    M = np.geomspace(1e-9, 10.0, 41)
    film = 2e-7
    for L in (0.0, 15.0):
        slices = filled(M, L, compiled=compiled, film=film)
        free = filled(M, L)
        flat = np.sqrt(8 * slices.load * STEEL["radius"] / (np.pi * STEEL["modulus"]))
        gap = film + np.maximum(slices.half_width - flat, 0.0) ** 2 / (2 * STEEL["radius"])
        np.testing.assert_array_less(gap, 3 * film)
        assert np.all(slices.half_width >= flat * (1 - 1e-15))
        np.testing.assert_allclose(slices.half_width[-3:], free.half_width[-3:], rtol=1e-12)
        np.testing.assert_allclose(2 * slices.half_width * slices.pressure, slices.load, rtol=1e-14)


@pytest.mark.parametrize("U", [1e-13, 1e-10])
def test_a_rigid_film_is_thick_enough_for_its_width(U):
    """Moes's film, 3 R sqrt(2 U)/M in a rigid, isoviscous contact: its width is 1.3 sqrt(2 R h)."""
    oil = Conditions(**STEEL, pressure_viscosity=0.0)
    load = np.geomspace(1e-8, 1.0, 17) * np.sqrt(2 * U) * 2e9
    slices = Slices(17, oil, load=load, rolling_speed=U * 2e9 / 0.01)
    Chain(get_model("film", "moes"), get_model("pressure", "light-contact"))(slices)
    bound = np.sqrt(2 * 0.01 * slices.film_thickness)
    np.testing.assert_allclose(slices.half_width[:8] / bound[:8], 4 / np.sqrt(3 * np.pi), rtol=2e-3)
    assert np.all(slices.half_width < 2.0 * bound)


@given(st.floats(-3, 3), st.floats(0.0, 40.0), st.floats(1e-9, 0.5))
def test_it_rises_with_the_load_and_has_no_jump(exponent, L, step):
    M = 10.0**exponent
    before, after = ratio([M, M * (1 + step)], L)
    assert 0.0 < before <= after <= 1.0 + 2.0**-52  # one rounding
    # the largest slope of ln ratio over ln M is 2.99, at L = 25, of 81 L up to 40 and 1,200 M
    assert after / before <= (1 + step) ** 3, "steeper than the table"
    here = ratio([M], L)[0]
    there = ratio([M], L * (1 + 1e-9))[0]
    assert there == pytest.approx(here, rel=1e-6)


def test_slices_of_different_speed_are_as_those_of_one():
    """Where all have one speed the kernel takes its logarithm once."""
    oil = Conditions(**STEEL, pressure_viscosity=2e-8)
    model = get_model("pressure", "light-contact")
    load = np.geomspace(1e3, 1e6, 300)
    speed = np.linspace(1.0, 60.0, 300)
    together = Slices(300, oil, load=load, rolling_speed=speed, film_thickness=1e-6)
    Chain(model)(together)
    for k in (0, 7, 150, 299):
        alone = Slices(9, oil, load=load[k], rolling_speed=speed[k], film_thickness=1e-6)
        Chain(model)(alone)
        assert set(alone.pressure) == {together.pressure[k]}
        assert set(alone.half_width) == {together.half_width[k]}


# In a bearing ---------------------------------------------------------------------------------------------------------


def names(assembly):
    return [model.name for model in assembly.inner.chain.models]


def test_hertz_is_no_stage_and_a_light_contact_stands_between_film_and_viscosity():
    scene = load_scene("1032930-70C")
    hertz, light = (
        assemble(evolve(scene, {"models.pressure": name}, si=True))
        for name in ("hertz", "light-contact")
    )
    assert names(hertz) == ["palmgren", "moes", "barus", "lambda-blend"]
    assert names(light) == ["palmgren", "moes", "light-contact", "barus", "lambda-blend"]
    assert isinstance(hertz.pressure, PressureModel)
    load = np.geomspace(1e3, 1e5, 50)
    dry, wet = (one.inner.evaluate(load, 25.0, 0.5) for one in (hertz, light))
    np.testing.assert_array_equal(dry.film_thickness, wet.film_thickness)
    np.testing.assert_allclose(2 * wet.half_width * wet.pressure, load, rtol=1e-14)
    assert np.all(wet.pressure < dry.pressure)
    assert np.all(wet.film_viscosity < dry.film_viscosity)


def test_the_shipped_scenes_state_the_pressure_of_the_paper_and_new_ones_the_film_s():
    assert {
        load_scene(f"1032930-{name}").models.pressure.name for name in ("30C", "50C", "70C")
    } == {"hertz"}
    assert parse_scene(scene_with(), "scene.toml").models.pressure.name == "light-contact"


def test_hysteresis_rests_on_the_width_of_the_dry_contact():
    scene = load_scene("1032930-70C")
    found = []
    for name, chosen in itertools.product(("hertz", "light-contact"), ("hysteresis",)):
        there = assemble(
            evolve(scene, {"models.pressure": name, "cage.drag": [chosen]}, si=True)
        ).with_resistance()
        found.append(there.inner.evaluate(np.array([1e3, 1e4]), 25.0, 0.5).resistance)
    np.testing.assert_array_equal(*found)


# Want of oil ---------------------------------------------------------------------------------------------------------


def starved_film(exit_place):
    """Load w h0/(eta u R) and int h0 dx/(h sqrt(2 R h0)) of a rigid contact with a layer h0 (1 + c^2) and no side flow.

    The pressure is zero where the film begins, at -b, and ends, at c: int (x^2 - c^2)/(1 + x^2)^3 dx = 0.
    """
    c = exit_place

    def pressure(start):
        return quad(lambda x: (x * x - c * c) / (1 + x * x) ** 3, -start, c)[0]

    b = brentq(pressure, c * 1.0001, 1e3)
    load = -24 * quad(lambda x: x * (x * x - c * c) / (1 + x * x) ** 3, -b, c)[0]
    return load, math.atan(b) + math.atan(c)


@pytest.mark.parametrize("form", [lambda model: model, NumpyForm])
def test_the_friction_of_a_starved_film_vanishes_with_its_load(form):
    """2 b/h of the model over int dx/h of the solution."""
    oil = Conditions(radius=0.01, modulus=2e11, viscosity=0.01, pressure_viscosity=0.0)
    ratios = []
    for c in (0.05, 0.1, 0.2, 0.3, 0.4, 0.45, 0.47):
        load, shear = starved_film(c)
        h0 = 1e-5
        speed = 1.0
        slices = Slices(
            1,
            oil,
            load=load * 0.01 * speed * 0.01 / h0,
            rolling_speed=speed,
            film_thickness=h0 * (1 + c * c),
        )
        Chain(form(LightContact()))(slices)
        exact = shear * math.sqrt(2 * 0.01 * h0) / h0
        ratios.append(2 * slices.half_width[0] / slices.film_thickness[0] / exact)
    assert [min(ratios), max(ratios)] == pytest.approx([1.28, 1.50], abs=0.02)
