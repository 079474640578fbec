"""Rival blends: the share that asperities carry, against quadrature and printed numbers; compiled and NumPy alike."""

import attrs
import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from foreign_stages import Stage
from rollslip import Chain, Conditions, Slices, evolve, get_model, load_scene, plan
from rollslip.errors import SceneError
from rollslip.fields import FieldError
from rollslip.testing import Conformance, Nonconformance
from rollslip.testing.checks import check_compiled_equals_numpy
from rollslip_plugins.traction.blend import (
    REACH,
    GreenwoodTripp,
    LambdaBlend,
    LinearBlend,
    ZhouHoeprich,
    asperity_integral,
)
from rollslip_plugins.traction.boundary import Constant, Kragelsky
from rollslip_plugins.traction.eyring import Eyring, MaxwellEyring, Muraki
from rollslip_plugins.traction.local import MaxwellEyringLocal
from strategies import NumpyForm, decades, evaluated, films, forms, law_of
from tabled import REFERENCES, numbers_of

WITH_INTEGRAL = numbers_of(REFERENCES / "greenwood_tripp.csv")
NOT_YET = {
    "boundary": Constant(coefficient=1.0),
    "hydrodynamic": Constant(coefficient=5e-324),
}  # friction is the share
ONLY_FILM = {
    "boundary": Constant(coefficient=5e-324),
    "hydrodynamic": Constant(coefficient=1.0),
}  # that of the film

#: With laws that read the groups which films are drawn with.
BLENDS = [
    LinearBlend(hydrodynamic=MaxwellEyring()),
    LinearBlend(
        boundary_limit=0.0,
        hydrodynamic_limit=3.0,
        boundary=Constant(),
        hydrodynamic=MaxwellEyring(),
    ),
    ZhouHoeprich(hydrodynamic=MaxwellEyring()),
    ZhouHoeprich(factor=2.32, exponent=0.97, hydrodynamic=Eyring()),
    GreenwoodTripp(hydrodynamic=MaxwellEyring()),
    GreenwoodTripp(
        roughness_parameter=0.03,
        slope_parameter=1e-2,
        hydrodynamic=ZhouHoeprich(boundary=Constant(), hydrodynamic=MaxwellEyring()),
    ),
]
every_blend = pytest.mark.parametrize("model", forms(BLENDS))
#: Relative: about a thousand times the epsilon of a double, by which a blend may leave the range of its two laws.
ROUNDING = 2e-13
#: Reduced modulus of two bodies of bearing steel [Pa]: 208 GPa over 1 - 0.3^2.
STEEL = 2.286e11


def describe_fraction(model, film_parameter, pressure=4e8, modulus=STEEL, children=NOT_YET):
    """Share of boundary friction, through the chain: the friction of a boundary of 1 and a film of nothing."""
    bare = attrs.evolve(law_of(model), **children)
    form = bare if law_of(model) is model else NumpyForm(bare)
    film_parameter, pressure = np.broadcast_arrays(
        np.atleast_1d(np.asarray(film_parameter, dtype=float)), pressure
    )
    slices = Slices(
        film_parameter.size,
        Conditions(roughness=2.0**-22, modulus=modulus),  # a power of two: the quotient is exact
        film_thickness=film_parameter * 2.0**-22,
        pressure=pressure,
        rolling_speed=1.0,
        sliding_speed=1.0,
    )
    Chain(form)(slices)
    return slices.friction.copy()


# The integral of Greenwood and Tripp ---------------------------------------------------------------------------------


def test_the_asperity_integral_is_that_of_the_definition():
    """Forty digits of the parabolic cylinder function and of the integral itself, see tools/references."""
    x = np.array([row["separation"] for row in WITH_INTEGRAL])
    np.testing.assert_allclose(
        asperity_integral(x), [row["integral"] for row in WITH_INTEGRAL], rtol=1e-14
    )


@given(x=st.floats(0.0, REACH, exclude_max=True))
def test_the_asperity_integral_anywhere(x):
    """F_5/2(x) = Gamma(7/2)/sqrt(2 pi) exp(-x^2/4) D_-7/2(x)."""
    with mpmath.workdps(30):
        x = mpmath.mpf(x)
        expected = (
            mpmath.gamma(3.5)
            / mpmath.sqrt(2 * mpmath.pi)
            * mpmath.exp(-x * x / 4)
            * mpmath.pcfd(-3.5, x)
        )
    # exp(-x^2/2) alone loses x^2/2 roundings
    np.testing.assert_allclose(
        asperity_integral(float(x)), float(expected), rtol=2.5e-15 + 1.2e-16 * float(x) ** 2
    )


def test_the_asperity_integral_is_the_table_of_greenwood_and_tripp():
    """Their table of F_5/2 has five decimals (0.61664 at 0, from recall; exactly it is 0.61663)."""
    table = {
        0.0: 0.61664,
        0.5: 0.24040,
        1.0: 0.08056,
        1.5: 0.02286,
        2.0: 0.00542,
        2.5: 0.00106,
        3.0: 0.00017,
    }
    np.testing.assert_allclose(
        asperity_integral(np.array(list(table))), list(table.values()), rtol=0, atol=6e-6
    )


def test_the_asperity_integral_ends_where_it_is_half_a_unit_in_the_last_place():
    ends = asperity_integral(np.array([np.nextafter(REACH, 0), REACH, 1e300, np.inf]))
    np.testing.assert_allclose(ends[0] / asperity_integral(np.zeros(1)), 2.0**-53, rtol=1e-13)
    assert np.all(ends[1:] == 0)


def test_what_is_said_of_the_usual_fit():
    """4.4086e-5 (4 - x)^6.804 of Patir and Cheng against the integral."""
    x = np.array([0.0, 1.0, 2.0, 3.0])
    error = 4.4086e-5 * (4 - x) ** 6.804 / asperity_integral(x) - 1
    assert error.round(2).tolist() == [-0.11, -0.04, -0.09, -0.74]


# The share -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("form", [lambda model: model, NumpyForm], ids=["compiled", "numpy"])
def test_greenwood_and_tripps_pressure_is_the_sum_of_hertzian_tips(form):
    """Summed over distances and heights of the tips by quadrature, with 1/sum((1-nu^2)/E): half of our E'."""
    for row in WITH_INTEGRAL:
        model = GreenwoodTripp(
            roughness_parameter=row["density"] * row["sigma"] * row["beta"],
            slope_parameter=row["sigma"] / row["beta"],
        )
        fraction = describe_fraction(
            form(model), row["separation"] or 1e-300, pressure=1e9, modulus=2 * row["modulus"]
        )
        np.testing.assert_allclose(fraction * 1e9, row["pressure"], rtol=1e-13, err_msg=str(row))


@pytest.mark.parametrize("form", [lambda model: model, NumpyForm], ids=["compiled", "numpy"])
def test_asperities_carry_no_more_than_the_load(form):
    """Without a film, 26 MPa between steel surfaces: all of a light load, little of a heavy one."""
    fraction = describe_fraction(
        form(GreenwoodTripp()), 1e-9, pressure=np.array([1.0, 2.64e7, 2.65e7, 1e9])
    )
    assert fraction[:2].tolist() == [1.0, 1.0]
    np.testing.assert_allclose(fraction[2:] * [2.65e7, 1e9], 26.41e6, rtol=1e-3)


@pytest.mark.parametrize("form", [lambda model: model, NumpyForm], ids=["compiled", "numpy"])
@given(film_parameter=decades(-6, 2), factor=decades(-1, 1), exponent=st.floats(0.3, 3.0))
def test_zhou_and_hoeprichs_share_is_as_printed(form, film_parameter, factor, exponent):
    """N_a/N = exp(-B Lambda^C), their Eq. (29), in thirty digits; below 2^-53 it is none."""
    with mpmath.workdps(30):
        power = mpmath.mpf(factor) * mpmath.mpf(film_parameter) ** mpmath.mpf(exponent)
        expected = float(mpmath.exp(-power))
    fraction = describe_fraction(
        form(ZhouHoeprich(factor=factor, exponent=exponent)), film_parameter
    )[0]
    if abs(float(power) - 53 * np.log(2)) > 1e-12:
        expected = expected if expected > 2.0**-53 else 0.0
        # the exponent is known to some roundings of its size
        np.testing.assert_allclose(
            fraction, expected, rtol=1e-15 * (2 + 4 * float(power)), atol=1e-323
        )


@pytest.mark.parametrize("form", [lambda model: model, NumpyForm], ids=["compiled", "numpy"])
@given(thickness=decades(-18, 0), factor=decades(-1, 1), exponent=st.floats(0.3, 3.0))
def test_what_zhou_and_hoeprich_leave_to_a_thin_film_keeps_its_digits(
    form, thickness, factor, exponent
):
    """1 - exp(-B Lambda^C) in sixty digits: the coefficient of the film may be far above that of the boundary."""
    with mpmath.workdps(60):
        power = mpmath.mpf(factor) * mpmath.mpf(thickness) ** mpmath.mpf(exponent)
        expected = float(-mpmath.expm1(-power))
    film = describe_fraction(
        form(ZhouHoeprich(factor=factor, exponent=exponent)), thickness, children=ONLY_FILM
    )[0]
    np.testing.assert_allclose(film, expected, rtol=2e-15, atol=1e-323)


@pytest.mark.parametrize("form", [lambda model: model, NumpyForm], ids=["compiled", "numpy"])
@pytest.mark.parametrize("exponent", [0.03, 1.0, 2.5, 3.0, 6.0, 7.0, 64.0, 100.0])
@pytest.mark.parametrize("limits", [(0.0, 3.0), (0.5, 1.5)])
@given(part=st.one_of(decades(-15, 0), decades(-15, 0).map(lambda part: 1 - part)))
def test_what_a_power_leaves_to_the_film_keeps_its_digits(form, exponent, limits, part):
    """1 - ((Lambda_hd - Lambda)/(Lambda_hd - Lambda_bd))^m in sixty digits, next to either limit."""
    low, high = limits
    film_parameter = (low + part * (high - low)) or 1e-30
    with mpmath.workdps(60):
        base = (high - mpmath.mpf(film_parameter)) / (mpmath.mpf(high) - mpmath.mpf(low))
        expected = float(1 - base ** mpmath.mpf(exponent)) if film_parameter < high else 1.0
    model = LambdaBlend(boundary_limit=low, hydrodynamic_limit=high, exponent=exponent)
    film = describe_fraction(form(model), film_parameter, children=ONLY_FILM)[0]
    # a power by squaring adds up the roundings of its factors
    np.testing.assert_allclose(film, expected, rtol=2e-15 + 5e-17 * exponent, atol=1e-323)


@pytest.mark.parametrize(
    "model", [LinearBlend(), LambdaBlend(exponent=0.03), LambdaBlend(exponent=7.0)]
)
@given(limit=st.sampled_from([0.01, 1.5]), ulps=st.integers(-9, 9), roughness=decades(-8, -5))
def test_both_forms_are_on_one_side_of_a_limit(model, limit, ulps, roughness):
    """A share may rise without bound at its limit: one rounding of the film parameter more is another share."""
    film = limit * roughness
    slices = [
        evaluated(
            form(attrs.evolve(model, **children)),
            Conditions(roughness=roughness),
            film_thickness=np.array([film + ulps * np.spacing(film)]),
            rolling_speed=1.0,
            sliding_speed=1.0,
        )
        for children in (NOT_YET, ONLY_FILM)
        for form in (lambda model: model, NumpyForm)
    ]
    compiled, numpy, compiled_film, numpy_film = (filled.friction for filled in slices)
    np.testing.assert_allclose(compiled, numpy, rtol=3e-15, atol=1e-323)
    np.testing.assert_allclose(compiled_film, numpy_film, rtol=3e-15, atol=1e-323)


@pytest.mark.parametrize("cls", [LinearBlend, LambdaBlend, ZhouHoeprich])
def test_the_kit_sees_what_a_difference_of_children_loses(cls):
    """mu_hd + (mu_bd - mu_hd) share rounds at the larger of the two, which may be a film of nearly no share."""

    class ByDifference(cls):
        def evaluate(self, slices):
            fraction, _ = self.fractions(slices)
            self.boundary.evaluate(slices)
            boundary = slices.friction.copy()
            self.hydrodynamic.evaluate(slices)
            slices.friction[...] = slices.friction + (boundary - slices.friction) * fraction

    # both forms of the film's law agree to rounding
    check_compiled_equals_numpy(cls(hydrodynamic=MaxwellEyring()))
    with pytest.raises(Nonconformance, match="compiled against NumPy: friction"):
        check_compiled_equals_numpy(ByDifference(hydrodynamic=MaxwellEyring()))


def test_zhou_and_hoeprichs_share_has_the_published_numbers():
    """Aihara: for Lambda over 2 almost all of the load is on the film. Wingertszahn et al.: B 2.32, C 0.97."""
    default = ZhouHoeprich()
    raceway = get_model("traction", "zhou-hoeprich", factor=2.32, exponent=0.97)
    assert describe_fraction(default, 2.0) == pytest.approx(0.016, abs=5e-4)
    assert describe_fraction(raceway, 1.0) == pytest.approx(np.exp(-2.32))
    assert default.full_film_from == pytest.approx(12.35, abs=0.01)


@pytest.mark.parametrize("form", [lambda model: model, NumpyForm], ids=["compiled", "numpy"])
def test_a_linear_blend_is_a_straight_line(form):
    fraction = describe_fraction(
        form(LinearBlend(boundary_limit=0.5, hydrodynamic_limit=2.5)),
        [1e-9, 0.5, 1.0, 2.0, 2.5, 9.0],
    )
    np.testing.assert_allclose(fraction, [1.0, 1.0, 0.75, 0.25, 0.0, 0.0], rtol=1e-15, atol=1e-323)


def test_a_linear_blend_is_the_power_blend_with_power_one():
    film_parameter = np.linspace(1e-3, 2.0, 401)
    np.testing.assert_array_equal(
        describe_fraction(LinearBlend(), film_parameter),
        describe_fraction(LambdaBlend(exponent=1.0), film_parameter),
    )


@every_blend
@given(start=decades(-6, 1.2), pressure=decades(5, 9.6), step=decades(-12, 0))
def test_the_share_falls_from_one_to_none_without_a_jump(model, start, pressure, step):
    thicker = start * (1 + step)
    fraction = describe_fraction(model, [start, thicker, 1e6], pressure)
    assert np.all((fraction >= 0) & (fraction <= 1))
    assert fraction[0] >= fraction[1] * (1 - 1e-14)
    assert fraction[2] <= 1e-300
    # -dshare/dln(Lambda) is at most C/e (exponential), Lambda_hd/band (line), and Lambda^2 + 7/2 (asperities): their
    # integral is exp(-Lambda^2/2) times the mean of exp(-Lambda t) over t^(5/2) exp(-t^2/2), where Lambda <t> <= 7/2
    assert fraction[0] - fraction[1] <= (min(thicker, REACH) ** 2 + 3.5) * np.log1p(step) + 1e-13


@pytest.mark.parametrize("model", forms(BLENDS[4:]))
@given(film_parameter=decades(-3, 0.8), pressure=decades(5, 9.6), factor=decades(0, 2))
def test_the_share_of_asperities_falls_with_pressure_alone(model, film_parameter, pressure, factor):
    """They carry what they carry: share times pressure is the same, unless it is all."""
    light, heavy = describe_fraction(model, film_parameter, np.array([pressure, pressure * factor]))
    assert heavy <= light
    if light < 1:
        np.testing.assert_allclose(heavy * factor, light, rtol=1e-14)


# The blend -----------------------------------------------------------------------------------------------------------


@every_blend
@given(film=films(), ratio=decades(-3, 1.2))
def test_a_blend_is_its_children_by_their_shares(model, film, ratio):
    """mu = share mu_bd + (1 - share) mu_hd, between the two; one of them alone where the share is 0 or 1."""
    law = law_of(model)
    film = film.with_(roughness=film.columns["film_thickness"] / ratio, modulus=STEEL)
    speed = np.concatenate([film.speed(np.logspace(-6, 6, 13)), [0.0]])
    children = [
        film.friction(child if model is law else NumpyForm(child), speed)
        for child in (law.boundary, law.hydrodynamic)
    ]
    friction = film.friction(model, speed)
    slices = film.slices(law, speed)
    fraction, rest = law.fractions(slices)
    larger = np.maximum(*children)
    expected = fraction * children[0] + rest * children[1]
    assert np.all(np.abs(fraction + rest - 1) <= 4e-16)
    # the share, a film parameter of two roundings to a power or in an exponent, is known to some roundings of its own
    assert np.all(np.abs(friction - expected) <= ROUNDING * larger + 1e-300)
    assert np.all(friction >= np.minimum(*children) - ROUNDING * larger)
    assert np.all(friction <= larger * (1 + ROUNDING) + 1e-300)
    if ratio >= law.full_film_from * (1 + 1e-12):
        assert np.all(fraction == 0)
        np.testing.assert_allclose(
            friction, children[1], rtol=0 if model is law else ROUNDING, atol=1e-300
        )
    if ratio <= law.full_film_from * (1 - 1e-12):
        assert np.all(fraction > 0)


@pytest.mark.parametrize("form", [lambda model: model, NumpyForm], ids=["compiled", "numpy"])
@pytest.mark.parametrize("n", [1, 257, 600])
def test_a_child_is_evaluated_only_where_it_is_needed(form, n):
    """Asperities carry nothing beyond the reach of their heights, and all of a light load without a film."""
    seen = {"boundary": [], "hydrodynamic": []}

    def child(which):
        def evaluate(part):
            seen[which] += part.load.tolist()
            part.friction[...] = 0.1

        return Stage(evaluate)

    kinds = np.arange(n) % 3
    slices = Slices(
        n,
        Conditions(roughness=1e-7, modulus=STEEL),
        load=np.arange(n),
        pressure=np.where(kinds, 4e8, 1e4),
    )
    slices.film_thickness[:] = 1e-7 * np.array([1e-3, 1.0, 8.0])[kinds]
    Chain(form(GreenwoodTripp(boundary=child("boundary"), hydrodynamic=child("hydrodynamic"))))(
        slices
    )
    assert seen["boundary"] == np.flatnonzero(kinds < 2).tolist()
    assert seen["hydrodynamic"] == np.flatnonzero(kinds > 0).tolist()


def test_a_blend_asks_for_the_pressure_only_if_its_share_does():
    bare = {"boundary": Kragelsky(), "hydrodynamic": Constant()}
    slip = {"rolling_speed", "sliding_speed", "film_thickness", "roughness"}
    assert LinearBlend(**bare).reads == ZhouHoeprich(**bare).reads == slip
    assert GreenwoodTripp(**bare).reads == slip | {"pressure", "modulus"}
    assert GreenwoodTripp().reads == MaxwellEyringLocal().reads | slip | {"modulus"}


# Parameters and scenes -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("cls", "parameters", "field"),
    [
        (LinearBlend, {"boundary_limit": 2.0}, "hydrodynamic_limit"),
        (ZhouHoeprich, {"factor": 0.0}, "factor"),
        (ZhouHoeprich, {"exponent": -1.0}, "exponent"),
        (GreenwoodTripp, {"roughness_parameter": 0.0}, "roughness_parameter"),
        (GreenwoodTripp, {"slope_parameter": 1.0}, "slope_parameter"),
    ],
)
def test_parameters_out_of_range_are_refused(cls, parameters, field):
    with pytest.raises(FieldError, match=f"^{field}: must be "):
        cls(**parameters)


@pytest.mark.parametrize("blend", [LambdaBlend, LinearBlend])
def test_a_blend_is_as_exact_as_its_less_exact_child(blend):
    @attrs.frozen(kw_only=True)
    class Rough(Muraki):
        tolerance = 1e-6

    for children in ({"hydrodynamic": Rough()}, {"boundary": Rough(), "hydrodynamic": Muraki()}):
        assert blend(**children).tolerance == 1e-6


def test_extreme_constants_keep_a_film_parameter():
    assert ZhouHoeprich(factor=1e-300, exponent=0.01).full_film_from == np.inf
    assert describe_fraction(ZhouHoeprich(factor=1e-300, exponent=0.01), 1e9) == pytest.approx(1.0)


@pytest.mark.parametrize("name", ["linear-blend", "zhou-hoeprich", "greenwood-tripp"])
def test_a_scene_takes_each_blend(name):
    scene = evolve(
        load_scene("1032930-70C"), {"models.traction": {"model": name, "hydrodynamic": "eyring"}}
    )
    rows = {part.part: part for part in plan(scene, "friction-curve").parts}
    assert rows["traction"].choice.startswith(name)
    assert rows["boundary friction"].included == (name != "linear-blend")
    with pytest.raises(SceneError, match=r"models\.traction\.exponents: unknown"):
        plan(evolve(scene, {"models.traction": {"model": name, "exponents": 2.0}}, si=True))


@pytest.mark.soak
class TestOtherParameters(Conformance):
    models = BLENDS[1::2]
