"""The dimensionless stress laws: exact values, limits, bounds and shape, compiled and NumPy alike."""

from pathlib import Path

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fifty_digits import maxwell_eyring_stress as fifty_digits
from rollslip_kernels.stages import stress as compiled
from rollslip_plugins.traction import stress as readable
from strategies import decades, or_zero

MURAKI = (compiled.muraki, readable.muraki_stress)
EYRING = (compiled.eyring, readable.eyring_stress)
MAXWELL_EYRING = (compiled.maxwell_eyring, readable.maxwell_eyring_stress)
LAWS = MURAKI + EYRING + MAXWELL_EYRING
EXACT = EYRING + MAXWELL_EYRING
PAIRS = (MURAKI, EYRING, MAXWELL_EYRING)

#: Zero, the smallest number, both sides of where squares vanish or overflow, and nearly the largest.
EXTREME_SIGMA = [
    0.0,
    5e-324,
    1e-310,
    1e-151,
    1e-150,
    1e-100,
    1e-8,
    1.0,
    1e8,
    1e100,
    1e154,
    1e155,
    1e300,
]
#: From no elasticity by vanishing products to a film that only stretches.
EXTREME_DEBORAH = [0.0, 5e-324, 1e-300, 1e-6, 1.0, 1e8]
#: From no heating by vanishing products to a film whose stress heating decides.
EXTREME_HEATING = [0.0, 5e-324, 1e-300, 1.0, 1e6]

ROUNDING = 1e-13  # what an inequality of theory may lose in double precision


def name(law):
    return law.__name__


sigmas = decades(-8, 8)
deborahs = or_zero(decades(-6, 6))
heatings = or_zero(decades(-6, 3))


@pytest.fixture(scope="module")
def reference():
    path = Path(__file__).parents[2] / "tools" / "references" / "maxwell_eyring.csv"
    return np.loadtxt(path, delimiter=",", skiprows=1, unpack=True)


@pytest.mark.parametrize("law", MAXWELL_EYRING, ids=name)
def test_maxwell_eyring_agrees_with_quadrature_in_fifty_digits(law, reference):
    sigma, deborah, heating, stress = reference
    assert len(sigma) > 400
    np.testing.assert_allclose(law(sigma, deborah, heating), stress, rtol=1e-13, atol=0)


@pytest.mark.parametrize("law", MAXWELL_EYRING, ids=name)
@pytest.mark.parametrize(
    ("sigma", "deborah", "heating", "stress"),
    [
        (1e-8, 1e-6, 0, 9.999995e-9),
        (0.001, 1, 0, 5.6766762422317e-4),
        (0.1, 0.001, 1, 0.09880691101488),
        (1, 1, 0, 0.55129615215295),
        (2, 10, 0.1, 0.18676138807730),
        (10, 10, 0, 0.92543981547863),
        (100, 0.01, 0.01, 2.6515335792481),
        (1000, 10, 0.001, 3.7787533695629),
        (1e6, 1, 1, 2.4435004404828e-5),
        (1e8, 1e6, 1000, 4.0058769161982e-10),
    ],
)
def test_maxwell_eyring_takes_known_values(law, sigma, deborah, heating, stress):
    assert law(sigma, deborah, heating) == pytest.approx(stress, rel=1e-13)


@pytest.mark.parametrize("law", MAXWELL_EYRING, ids=name)
@pytest.mark.parametrize(
    ("sigma", "deborah"), [(2.50062e17, 1e16), (3.71118e16, 1.34279e15), (3.52e13, 1.38e12)]
)
@pytest.mark.parametrize("heating", [0.0, 1e-20])
def test_maxwell_eyring_far_beyond_its_range_where_little_of_an_oil_has_relaxed(
    law, sigma, deborah, heating
):
    """P = 50 to 55 relaxation lengths with B up to 5e17: B exp(-P) counts where exp(-P) is nothing beside 1."""
    expected = float(fifty_digits(sigma, deborah, heating))
    assert law(sigma, deborah, heating) == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize("law", MAXWELL_EYRING, ids=name)
@pytest.mark.parametrize("cut", [0.25, 1.0, 50.0])
def test_maxwell_eyring_is_seamless_where_the_method_changes(law, cut):
    sigma = np.logspace(-8, 8, 200)
    deborah = 2 * np.hypot(1, sigma) / cut  # P = cut
    below, above = (law(sigma, deborah * (1 + shift), 0) for shift in (1e-14, -1e-14))
    np.testing.assert_allclose(below, above, rtol=5e-14)


@pytest.mark.parametrize("law", MAXWELL_EYRING, ids=name)
def test_without_elasticity_maxwell_eyring_is_eyring(law):
    sigma, heating = np.meshgrid(np.logspace(-8, 8, 60), [0, 1e-3, 0.1, 1, 30, 1e3])
    np.testing.assert_allclose(
        law(sigma, 0, heating), readable.eyring_stress(sigma, 0, heating), rtol=5e-15
    )
    np.testing.assert_allclose(
        law(sigma, 1e-20, heating), readable.eyring_stress(sigma, 0, heating), rtol=5e-15
    )


# Entry layer ---------------------------------------------------------------------------------------------------------

#: Ranges of sigma, D, Phi in decades: beyond D = max(1, sigma)/20 the general law takes over.
CLOUDS = {
    "all": ((-8, 8), (-6, 4), (-12, 3)),
    "thin layer": ((-9, 8), (-8, -1.31), (-6, 3)),
    "elastic and hot": ((-1, 4), (0, 4), (-4, 2)),
    "order 1": ((-1, 1), (-1, 1), (-1, 1)),
    "bearing": ((-2, 1.2), (-4, -2.5), (-1, 0.1)),
}
# sigma, D, Phi on either side of that limit
INSIDE = (1.0, 0.01, 1.0)
#: The same strain rate and heating, with a Deborah number beyond it.
OUTSIDE = (1.0, 1.0, 1.0)


def log_random(cloud, n, seed=1):
    rng = np.random.default_rng(seed)
    return [10 ** rng.uniform(*decade, n) for decade in CLOUDS[cloud]]


@pytest.mark.parametrize("cloud", CLOUDS)
def test_maxwell_eyring_agrees_with_numpy_and_fifty_digits_all_over(cloud):
    groups = log_random(cloud, 4_000)
    found = compiled.maxwell_eyring(*groups)
    for i in range(40):
        with mpmath.workdps(50):
            assert abs(found[i] / fifty_digits(*(float(group[i]) for group in groups)) - 1) < 1e-13
    np.testing.assert_allclose(found, readable.maxwell_eyring_stress(*groups), rtol=1e-13, atol=0)


@pytest.mark.parametrize("shift", [-1e-12, 0.0, 1e-12])
def test_maxwell_eyring_keeps_its_accuracy_on_the_edges_of_the_thin_layer(shift):
    sigma, heating, places = np.meshgrid(
        [*np.logspace(-9, 8, 69), 1e-300, 1e-12, 1.9e5],
        [0.0, 1e-300, 1e-6, 1e-3, 0.1, 1.0, 30.0, 1e3],
        [0.0, 1e-6, 1.0],
    )
    deborah = np.minimum(np.maximum(1, sigma) / 20, 1e4) * places
    groups = sigma * (1 + shift), deborah * (1 + shift), heating * (1 + shift)
    numpy = readable.maxwell_eyring_stress(*groups)
    np.testing.assert_allclose(compiled.maxwell_eyring(*groups), numpy, rtol=5e-14, atol=0)
    eyring = readable.eyring_stress(groups[0], 0, groups[2])
    np.testing.assert_allclose(compiled.eyring(groups[0], 0, groups[2]), eyring, rtol=5e-15, atol=0)


@pytest.mark.parametrize("place", [0, 7, 100, 255])
def test_neighbours_of_another_method_change_no_bit(place):
    """Blocks of one film outside of the thin layer, of one inside, and with a NaN or no slip in one place."""
    alone = {groups: compiled.maxwell_eyring(*groups) for groups in (INSIDE, OUTSIDE)}
    for many, one in (
        (INSIDE, OUTSIDE),
        (OUTSIDE, INSIDE),
        (INSIDE, (np.nan, 0.01, 1.0)),
        (INSIDE, (0.0, 0.01, 1.0)),
    ):
        groups = [np.full(256, value) for value in many]
        for group, value in zip(groups, one, strict=True):
            group[place] = value
        found = compiled.maxwell_eyring(*groups)
        np.testing.assert_array_equal(found[place], alone.get(one, one[0]))
        np.testing.assert_array_equal(np.delete(found, place), alone[many])


# Theory --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("law", EYRING, ids=name)
@given(sigma=sigmas, heating=heatings)
def test_eyring_solves_its_equation(law, sigma, heating):
    with mpmath.workdps(40):
        stress = mpmath.mpf(float(law(sigma, 0, heating)))
        y = heating * mpmath.mpf(sigma) * stress
        residual = mpmath.log(mpmath.sinh(stress) / sigma) + y
        slope = stress * mpmath.coth(stress) + y  # d(residual)/d(log S)
        assert abs(residual / slope) < 1e-14


@pytest.mark.parametrize("law", EXACT, ids=name)
def test_small_signal_is_linear_viscoelastic(law):
    deborah = np.array([1e-6, 1e-3, 0.1, 1, 3, 10])
    gain = 1 + 0.5 * deborah * np.expm1(-2 / deborah) if law in MAXWELL_EYRING else 1.0
    np.testing.assert_allclose(law(1e-9, deborah, 1.0) / 1e-9, gain, rtol=1e-13)


@pytest.mark.parametrize("law", LAWS, ids=name)
def test_cold_inelastic_stress_is_asinh(law):
    sigma = np.logspace(-12, 12, 100)
    np.testing.assert_allclose(law(sigma, 0, 0), np.arcsinh(sigma), rtol=1e-15)
    np.testing.assert_allclose(law(sigma, 1e-20, 1e-40), np.arcsinh(sigma), rtol=2e-15)


@pytest.mark.parametrize("law", MURAKI, ids=name)
def test_muraki_tends_to_the_heated_plateau_for_vanishing_elasticity(law):
    """The limit that the printed Eq. (8) of Klebanov et al. (2022) misses."""
    sigma, heating = np.meshgrid(np.logspace(5, 8, 10), [0, 1e-6, 1e-3, 1])
    expected = np.log(2 * sigma) / (1 + heating * sigma)
    np.testing.assert_allclose(law(sigma, 1e-12, heating), expected, rtol=3e-11)


@pytest.mark.parametrize("law", MURAKI, ids=name)
def test_muraki_is_continuous_where_the_ramp_fills_the_contact(law):
    sigma, heating = np.meshgrid(np.logspace(-8, 8, 80), [0, 1e-6, 1e-3, 0.1, 1, 1e3, 1e6])
    switch = sigma * (2 + heating * sigma) / np.arcsinh(sigma)
    for shift in (-1e-13, -1e-15, 0, 1e-15, 1e-13):
        deborah = switch * (1 + shift)
        np.testing.assert_allclose(law(sigma, deborah, heating), sigma / deborah, rtol=1e-12)


@pytest.mark.parametrize("law", MURAKI, ids=name)
@given(sigma=decades(-12, 12), deborah=or_zero(decades(-20, 8)), heating=or_zero(decades(-20, 6)))
def test_muraki_agrees_with_its_quadratic_in_many_digits(law, sigma, deborah, heating):
    with mpmath.workdps(120):
        s, d, phi = (mpmath.mpf(x) for x in (sigma, deborah, heating))
        a = 1 + phi * s
        plateau = mpmath.asinh(s)
        root = a**2 - d * phi * plateau
        if root < 0:
            y = mpmath.inf
        elif d * phi == 0:
            y = plateau / a
        else:
            y = (a - mpmath.sqrt(root)) / (d * phi / 2)
        expected = s / d if y * d > 2 * s else y - d * y**2 / (4 * s)
        assert abs(law(sigma, deborah, heating) / expected - 1) < 1e-14


@pytest.mark.parametrize("law", LAWS, ids=name)
def test_laws_are_odd_and_finite_to_the_extremes(law):
    sigma, deborah, heating = np.meshgrid(EXTREME_SIGMA, EXTREME_DEBORAH, EXTREME_HEATING)
    stress = law(sigma, deborah, heating)
    assert np.all(np.isfinite(stress))
    assert np.all(stress >= 0)
    assert np.all(stress[sigma == 0] == 0)
    assert np.all(law(-sigma, deborah, heating) == -stress)
    assert np.all(stress[sigma > 1e-290] > 0)


@pytest.mark.parametrize("law", LAWS, ids=name)
def test_nan_is_passed_on(law):
    assert np.isnan(law(np.nan, 1, 1))
    assert np.isnan(law(1, 1, np.nan))
    assert np.isnan(law(1, np.nan, 1)) == (law not in EYRING)


@pytest.mark.parametrize("law", LAWS, ids=name)
def test_arguments_broadcast(law):
    stress = law([[1.0], [2.0]], [0.0, 0.1, 1.0], 0.1)
    assert stress.shape == (2, 3)
    assert stress.dtype == np.float64
    assert stress[1, 2] == law(2, 1, 0.1)
    assert np.ndim(law(1, 1, 1)) == 0
    assert law([], 1, 1).shape == (0,)
    strided = np.arange(12.0).reshape(3, 4)[:, ::2]
    np.testing.assert_array_equal(law(strided, 0.1, 0.1), law(strided.copy(), 0.1, 0.1))


@pytest.mark.parametrize(("law", "reference_law"), PAIRS, ids=lambda law: law.__name__)
@given(
    sigma=or_zero(decades(-320, 300)) | sigmas,
    deborah=or_zero(decades(-300, 8)) | deborahs,
    heating=or_zero(decades(-300, 6)) | heatings,
)
def test_compiled_laws_agree_with_numpy(law, reference_law, sigma, deborah, heating):
    # Below 1e-300 results are denormal and have few digits.
    np.testing.assert_allclose(
        law(sigma, deborah, heating),
        reference_law(sigma, deborah, heating),
        rtol=1e-13,
        atol=1e-313,
    )


@pytest.mark.parametrize("law", LAWS, ids=name)
@given(sigma=sigmas, deborah=deborahs, heating=heatings)
def test_stress_stays_within_viscous_plastic_and_elastic_bounds(law, sigma, deborah, heating):
    stress = law(sigma, deborah, heating)
    bound = min(sigma, np.arcsinh(sigma))
    if deborah and law not in EYRING:
        bound = min(bound, sigma / deborah)
    assert 0 < stress <= bound * (1 + ROUNDING)


@pytest.mark.parametrize("law", LAWS, ids=name)
@given(sigma=sigmas, deborah=deborahs, heating=heatings, factor=st.floats(1, 100))
def test_stress_falls_with_elasticity_and_heating(law, sigma, deborah, heating, factor):
    stress = law(sigma, deborah, heating) * (1 + ROUNDING)
    assert law(sigma, deborah * factor, heating) <= stress
    assert law(sigma, deborah, heating * factor) <= stress


@pytest.mark.parametrize("law", LAWS, ids=name)
@given(sigma=sigmas, deborah=deborahs, factor=st.floats(1, 100))
def test_cold_stress_rises_with_strain_rate(law, sigma, deborah, factor):
    assert law(sigma * factor, deborah, 0) >= law(sigma, deborah, 0) * (1 - ROUNDING)


@pytest.mark.parametrize("law", LAWS, ids=name)
@given(deborah=deborahs, heating=heatings)
def test_heated_stress_has_at_most_one_maximum(law, deborah, heating):
    stress = law(np.logspace(-8, 8, 300), deborah, heating)
    change = np.diff(stress) / stress[1:]
    signs = np.sign(change[np.abs(change) > ROUNDING])
    assert np.all(np.diff(signs) <= 0)  # rising, then falling
