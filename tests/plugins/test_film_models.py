"""Every film model: sign and slope, limits, regimes, and each formula against its other form."""

import attrs
import mpmath
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rollslip.bearing.regimes import LONG_NAMES, NAMES, film_by_regime, moes_groups
from rollslip.errors import DomainError
from rollslip_plugins.film.formulas import (
    Blok,
    Dowson1968,
    DowsonHigginson,
    DowsonToyoda,
    Herrebrugh,
    Martin,
    Moes,
    PanHamrock,
    Regime,
)
from strategies import Contact, contacts, decades, forms, law_of, or_zero

MODELS = [
    Martin(),
    Blok(),
    Herrebrugh(),
    DowsonHigginson(),
    Dowson1968(),
    DowsonToyoda(),
    PanHamrock(),
    PanHamrock(thickness="central"),
    Moes(),
    Regime(),
]
every_model = pytest.mark.parametrize("model", forms(MODELS))

# pow and exp are right to an ulp or two, and an exponent of at most 3.5 multiplies the relative error of its argument:
# some twenty operations give at most 50 units of 1.1e-16.
ROUNDING = 1e-14


# Sign, slope, scale --------------------------------------------------------------------------------------------------


@every_model
@given(contact=contacts(), factor=decades(0, 2))
def test_film_is_positive_falls_with_load_and_rises_with_speed_and_viscosity(
    model, contact, factor
):
    """Rigid-piezoviscous films do not feel the load; the composite does not rise with it either, over the range."""

    def film(**changes):
        return attrs.evolve(contact, **changes).film(model)[0]

    h = contact.film(model)[0]
    assert 0 < h < np.inf
    assert film(load=contact.load * factor) <= h * (1 + ROUNDING)
    assert film(rolling_speed=contact.rolling_speed * factor) >= h * (1 - ROUNDING)
    assert film(viscosity=contact.viscosity * factor) >= h * (1 - ROUNDING)
    assert film(pressure_viscosity=contact.pressure_viscosity * factor) >= h * (1 - ROUNDING)


by_name = pytest.mark.parametrize(
    "model", [pytest.param(m, id=f"{i}-{m.name}") for i, m in enumerate(MODELS)]
)
any_oil = contacts(pressure_viscosity=or_zero(decades(-10, -7)))


def in_domain(model, contact):
    """Piezoviscous fits give no film without pressure viscosity, and say so instead."""
    return contact.pressure_viscosity >= model.domain["pressure_viscosity"][0]


# Each formula in its other form --------------------------------------------------------------------------------------


def hhat(law, contact):
    """h/R from hhat = h w/(eta0 u R) in g_V = W^1.5 G/U^0.5 and g_E = W/U^0.5, in forty digits.

    h/R = c U^u G^g W^w has this form only if u = 1 - g/2 - (1 + w - 3/2 g)/2, as similarity demands of an exact film
    (Johnson 1970). The four asymptotes have it; the other fits miss it by a few hundredths and are taken as printed.
    """
    with mpmath.workdps(40):
        U, G, W = (mpmath.mpf(group) for group in contact.groups)
        gV = W ** mpmath.mpf(1.5) * G / mpmath.sqrt(U)
        gE = W / mpmath.sqrt(U)
        forms = {
            "martin": lambda: mpmath.mpf("4.89497"),
            "blok": lambda: mpmath.mpf("1.66630") * gV ** (mpmath.mpf(2) / 3),
            "herrebrugh": lambda: mpmath.mpf("3.10") * gE ** mpmath.mpf("0.8"),
            "dowson-1968": lambda: (
                mpmath.mpf("2.65") * gV ** mpmath.mpf("0.54") * gE ** mpmath.mpf("0.06")
            ),
        }
        return float(forms[law.name]() * U / W)


@pytest.mark.parametrize("model", forms([Martin(), Blok(), Herrebrugh(), Dowson1968()]))
@given(contact=contacts())
def test_film_agrees_with_its_form_in_johnsons_groups(model, contact):
    expected = contact.radius * hhat(law_of(model), contact)
    np.testing.assert_allclose(contact.film(model), expected, rtol=ROUNDING)


PRINTED = {  # c, U, G, W; mean entrainment
    ("dowson-higginson", None): (1.6, 0.70, 0.60, -0.13),
    ("dowson-1968", None): (2.65, 0.70, 0.54, -0.13),
    ("dowson-toyoda", None): (3.06, 0.69, 0.56, -0.10),
    ("pan-hamrock", "minimum"): (1.714, 0.694, 0.568, -0.128),
    ("pan-hamrock", "central"): (2.922, 0.692, 0.470, -0.166),
}


@pytest.mark.parametrize("model", forms(MODELS[3:8]))
@given(contact=contacts())
def test_elastic_piezoviscous_films_are_the_printed_power_laws(model, contact):
    """By logarithms: ln(h/R) = ln c + u ln U + g ln G + w ln W."""
    law = law_of(model)
    c, *powers = PRINTED[law.name, getattr(law, "thickness", None)]
    terms = np.array(powers) * np.log(contact.groups)
    expected = contact.radius * c * np.exp(np.sum(terms))
    # the sum of logarithms has an absolute error of eps times its terms, up to 60
    np.testing.assert_allclose(
        contact.film(model), expected, rtol=2e-16 * np.sum(np.abs(terms)) + ROUNDING
    )


def moes(contact):
    """h/R after Moes as printed, in M, L and H of the sum of speeds, in forty digits; and its four asymptotes."""
    with mpmath.workdps(40):
        number = mpmath.mpf
        speeds = (
            2
            * number(contact.viscosity)
            * contact.rolling_speed
            / (number(contact.modulus) * contact.radius)
        )
        M = number(contact.load) / (number(contact.modulus) * contact.radius) / mpmath.sqrt(speeds)
        L = number(contact.pressure_viscosity) * contact.modulus * speeds ** number("0.25")
        ri = 3 / M
        ei = number("2.621") * M ** number("-0.2")
        rp = number("1.287") * L ** (number(2) / 3)
        ep = number("1.311") * M ** number("-0.125") * L ** number("0.75")
        s = (7 + 8 * mpmath.exp(-2 * ei / ri)) / 5
        isoviscous = (ri ** (number(7) / 3) + ei ** (number(7) / 3)) ** (3 * s / 7)
        piezoviscous = (rp ** number(-3.5) + ep ** number(-3.5)) ** (-2 * s / 7) if L else 0
        scale = mpmath.sqrt(speeds) * contact.radius
        film = (isoviscous + piezoviscous) ** (1 / s)
        return float(film * scale), {
            k: float(v * scale) for k, v in {"IR": ri, "VR": rp, "IE": ei, "VE": ep}.items()
        }


MOES = forms([Moes()])


@pytest.mark.parametrize("model", MOES)
@given(contact=any_oil)
def test_moes_agrees_with_its_printed_form_in_forty_digits(model, contact):
    np.testing.assert_allclose(contact.film(model), moes(contact)[0], rtol=ROUNDING)


def contact_of(M, L):
    """A contact with Moes's load and lubricant parameter."""
    modulus = 2.2857e11
    radius = 0.006875
    speed = 10.0
    viscosity = 0.01
    speeds = 2 * viscosity * speed / (modulus * radius)
    return Contact(
        load=M * np.sqrt(speeds) * modulus * radius,
        rolling_speed=speed,
        radius=radius,
        modulus=modulus,
        viscosity=viscosity,
        pressure_viscosity=L / speeds**0.25 / modulus,
    )


@pytest.mark.parametrize("model", MOES)
@pytest.mark.parametrize(
    ("regime", "M", "L"), [("IR", 1e-4, 0.0), ("IE", 1e6, 0.0), ("VR", 1e2, 1e12), ("VE", 1e6, 1e3)]
)
def test_moes_tends_to_each_asymptote(model, regime, M, L):
    """The blend adds at most the ratio of the next asymptote to a power of 7/5 or more; far out it is below 1 %."""
    contact = contact_of(M, L)
    film, asymptotes = moes(contact)
    assert contact.film(model)[0] == pytest.approx(asymptotes[regime], rel=0.01)
    assert film == pytest.approx(asymptotes[regime], rel=0.01)


@pytest.mark.parametrize("model", MOES)
@pytest.mark.parametrize(
    ("isoviscous", "M"),
    [("IR", 1e-6), ("IR", 1e-3), ("IE", 1e3), ("IE", 1e9)],
    ids=lambda value: str(value),
)
def test_moes_without_pressure_viscosity_is_isoviscous(model, isoviscous, M):
    """At alpha = 0 the piezoviscous films vanish: what stays is the 7/3 mean of the rigid and the elastic one."""
    contact = contact_of(M, 0.0)
    asymptotes = moes(contact)[1]
    expected = (asymptotes["IR"] ** (7 / 3) + asymptotes["IE"] ** (7 / 3)) ** (3 / 7)
    np.testing.assert_allclose(contact.film(model), expected, rtol=ROUNDING)
    assert asymptotes[isoviscous] == max(asymptotes.values())
    # no jump towards a very small alpha, where the film is thicker by a term of L^(2 s/3)
    np.testing.assert_allclose(contact_of(M, 1e-30).film(model), expected, rtol=1e-12)


# Regimes -------------------------------------------------------------------------------------------------------------

REGIME = forms([Regime()])
EDGES = {  # from, to: coefficient and exponent of g_V = c g_E^e as printed, and g_E along the edge
    ("IR", "VR"): ("5.035", 0.0, np.linspace(0.02, 1.7, 8)),
    ("VR", "VE"): ("38.97", 0.4737, np.linspace(0.5, 40, 8)),
    ("IE", "VE"): ("1.337", 1.3704, np.linspace(45, 1000, 8)),
    # not printed, for Johnson's map draws the other three: where Blok meets Herrebrugh between their triple points
    ("IE", "VR"): ("2.538", 1.2, np.linspace(1.8, 40, 8)),
}


def contact_in(gV, gE, speed=10.0):
    """A contact with Johnson's groups."""
    modulus = 2.2857e11
    radius = 0.006875
    viscosity = 0.01
    U = viscosity * speed / (modulus * radius)
    W = gE * np.sqrt(U)
    return Contact(
        load=W * modulus * radius,
        rolling_speed=speed,
        radius=radius,
        modulus=modulus,
        viscosity=viscosity,
        pressure_viscosity=gV * np.sqrt(U) / W**1.5 / modulus,
    )


def reported(model, contact):
    return NAMES[int(contact.slices(model).regime[0])]


def edge(model, at, low, high):
    """Where, between low and high, the reported regime changes; both sides to the last bit."""
    below = reported(model, at(low))
    while True:
        middle = 0.5 * (low + high)
        if middle in (low, high):
            return low, high, below, reported(model, at(high))
        low, high = (middle, high) if reported(model, at(middle)) == below else (low, middle)


@pytest.mark.parametrize("model", REGIME)
@pytest.mark.parametrize("names", EDGES, ids="/".join)
def test_regimes_meet_at_the_published_numbers(model, names):
    """The coefficient, and for g_E = 1 nothing but it, to half a unit of its last printed digit.

    The printed exponents are rounded to 5e-5, which over g_E up to 1000 is 3.5e-4 of the coefficient: added.
    """
    printed, power, along = EDGES[names]
    digit = 0.5 * 10.0 ** -len(printed.partition(".")[2])
    for gE in along:
        near = float(printed) * gE**power
        low, high, below, above = edge(
            model, lambda gV, gE=gE: contact_in(gV, gE), 0.98 * near, 1.02 * near
        )
        assert (below, above) == names
        rounded = abs(np.log(gE)) * 5e-5 * float(printed) if power not in (0.0, 1.2) else 0.0
        assert high / gE**power == pytest.approx(float(printed), abs=digit + rounded)
        # continuous: at the switch the two formulas are equal, so a last bit of g_V moves h by last bits only
        np.testing.assert_allclose(
            contact_in(low, gE).film(model), contact_in(high, gE).film(model), rtol=4 * ROUNDING
        )


@pytest.mark.parametrize("model", REGIME)
@pytest.mark.parametrize("gV", [0.1, 1.0, 4.0])
def test_rigid_meets_elastic_isoviscous_at_the_published_number(model, gV):
    low, high, below, above = edge(model, lambda gE: contact_in(gV, gE), 1.7, 1.85)
    assert (below, above) == ("IR", "IE")
    assert round(high, 3) == 1.770
    np.testing.assert_allclose(
        contact_in(gV, low).film(model), contact_in(gV, high).film(model), rtol=4 * ROUNDING
    )


@pytest.mark.parametrize("model", REGIME)
@given(gV=decades(-2, 6), gE=decades(-2, 4), angle=st.floats(0, 6.28))
def test_regime_film_has_no_jump(model, gV, gE, angle):
    """A small step in any direction changes the film by the step times at most the steepest exponent in use."""
    step = 1e-9
    here = contact_in(gV, gE)
    there = contact_in(gV * (1 + step * np.cos(angle)), gE * (1 + step * np.sin(angle)))
    change = np.log(there.film(model)[0] / here.film(model)[0])
    # h/R in gV and gE at given U: exponents of at most 2/3 and 1, see Martin, 4.89497 U/W
    assert abs(change) <= step * (2 / 3 * abs(np.cos(angle)) + abs(np.sin(angle))) + 4 * ROUNDING


@pytest.mark.parametrize("model", REGIME)
@pytest.mark.parametrize(
    ("name", "gV", "gE", "law"),
    [
        ("IR", 0.5, 0.5, Martin()),
        ("VR", 20.0, 0.5, Blok()),
        ("IE", 10.0, 30.0, Herrebrugh()),
        ("VE", 1e4, 30.0, Dowson1968()),
    ],
)
def test_regime_reports_what_it_used(model, name, gV, gE, law):
    contact = contact_in(gV, gE)
    assert reported(model, contact) == name == law.regime
    np.testing.assert_allclose(contact.film(model), contact.film(law), rtol=ROUNDING)
    ratio, code = film_by_regime(*contact.groups)
    assert (NAMES[int(code)], name in LONG_NAMES) == (name, True)
    np.testing.assert_allclose(ratio * contact.radius, contact.film(law), rtol=ROUNDING)


def test_moes_groups_are_those_of_the_sum_of_speeds():
    contact = contact_of(1.5, 10.0)
    M, L = moes_groups(contact.slices(Moes()))
    assert (M[0], float(np.ravel(L)[0])) == (pytest.approx(1.5), pytest.approx(10.0))


# Array in, array out -------------------------------------------------------------------------------------------------


@every_model
@given(contact=any_oil)
def test_film_thickness_is_the_chains(model, contact):
    assume(in_domain(law_of(model), contact))
    film = law_of(model).film_thickness(*attrs.astuple(contact))
    assert np.shape(film) == ()
    np.testing.assert_allclose(film, contact.film(model)[0], rtol=1e-12)


@by_name
def test_film_thickness_broadcasts_conditions_too(model):
    load = np.full((2, 1, 1), 1e4)
    speed = [[1.0], [3.0], [10.0]]
    radius = [0.007, 0.01]
    modulus = 2.3e11
    film = model.film_thickness(load, speed, radius, modulus, [0.01, 0.02], 1e-8)
    assert film.shape == (2, 3, 2)
    one = model.film_thickness(1e4, 3.0, 0.01, modulus, 0.02, 1e-8)
    np.testing.assert_allclose(film[1, 1, 1], one, rtol=ROUNDING)
    assert model.film_thickness([], 3.0, 0.01, modulus, 0.02, 1e-8).shape == (0,)


def test_bad_values_in_arrays_are_shown():
    with pytest.raises(DomainError) as error:
        Moes().film_thickness([1e4, -2.5, 0.0], 3.0, 0.01, 2e11, 0.02, 1e-8)
    assert str(error.value) == "moes: load = -2.5 N/m is outside its domain (> 0)"
