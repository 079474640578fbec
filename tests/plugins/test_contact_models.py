"""Line contact: Hertz, and the deflection laws against their sources, mpmath and the half space itself."""

import mpmath
import numpy as np
import pytest
from hypothesis import given
from scipy.integrate import dblquad, quad

from rollslip import Chain, Conditions, Slices
from rollslip.errors import DomainError
from rollslip_plugins.contact import Iso16281, Lundberg, Palmgren
from strategies import NumpyForm, decades, evaluated, forms, law_of

MODELS = [Palmgren(), Iso16281(), Lundberg()]
DEFLECTIONS = [model.deflection() for model in MODELS]
POWER = DEFLECTIONS[:2]
LUNDBERG = DEFLECTIONS[2]

every_contact = pytest.mark.parametrize("model", forms(MODELS))
every_deflection = pytest.mark.parametrize("model", forms(DEFLECTIONS))
power = pytest.mark.parametrize("model", forms(POWER))
lundberg = pytest.mark.parametrize("model", forms([LUNDBERG]))

# A dozen roundings of 1.1e-16, and powers and logarithms right to two ulp.
ROUNDING = 5e-15
#: Reduced modulus of two bodies of bearing steel [Pa], 208 GPa over 1 - 0.3^2.
STEEL = 2.2857e11


def deflected(model, approach, length=0.015, radius=0.006875, modulus=STEEL):
    return evaluated(
        model, Conditions(length=length, radius=radius, modulus=modulus), approach=approach
    )


# Hertz ---------------------------------------------------------------------------------------------------------------


@every_contact
@given(load=decades(-3, 8), radius=decades(-4, 1), modulus=decades(6, 12))
def test_hertz_line_contact(model, load, radius, modulus):
    """b = sqrt(8 w R/(pi E')), and the semi-elliptic pressure over the width 2 b carries the load.

    Its maximum is 2 w/(pi b), its mean w/(2 b) = pi/4 of that. Curvature: p_max = E' b/(4 R).
    """
    slices = evaluated(model, Conditions(radius=radius, modulus=modulus), load=load)
    b = slices.half_width[0]
    mean = slices.pressure[0]
    with mpmath.workdps(40):
        expected = float(mpmath.sqrt(8 * mpmath.mpf(load) * radius / (mpmath.pi * modulus)))
    assert b == pytest.approx(expected, rel=ROUNDING)
    highest = 2 * load / (np.pi * b)
    assert mean == pytest.approx(np.pi / 4 * highest, rel=ROUNDING)
    assert highest == pytest.approx(modulus * b / (4 * radius), rel=ROUNDING)
    # Gauss-Chebyshev quadrature of the second kind is exact for the semi-ellipse
    at = np.cos(np.pi * np.arange(1, 10) / 10)
    weight = np.pi / 10 * np.sin(np.pi * np.arange(1, 10) / 10)
    carried = b * np.sum(weight * highest * np.sqrt(1 - at**2))
    assert carried == pytest.approx(load, rel=10 * ROUNDING)
    assert carried / (2 * b) == pytest.approx(mean, rel=10 * ROUNDING)


# Power laws ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("form", [lambda model: model, NumpyForm], ids=["compiled", "numpy"])
@given(force=decades(-2, 6), length=decades(-3, -0.5))
def test_palmgren_deflection_is_the_published_number(form, force, length):
    """delta[mm] = 3.84e-5 Q^0.9/l^0.8, Q in N, l in mm, one contact."""
    approach = 1e-3 * 3.84e-5 * force**0.9 / (1e3 * length) ** 0.8
    slices = deflected(form(POWER[0]), approach, length=length)
    assert slices.load[0] * length == pytest.approx(force, rel=2 * ROUNDING)


@pytest.mark.parametrize("form", [lambda model: model, NumpyForm], ids=["compiled", "numpy"])
@given(both=decades(-9, -3), length=decades(-3, -0.5))
def test_iso_stiffness_is_that_of_two_contacts_in_series(form, both, length):
    """Q = 35948 l^(8/9) delta^(10/9) in N and mm, where the roller's two contacts share the approach delta."""
    force = 35948 * (1e3 * length) ** (8 / 9) * (1e3 * both) ** (10 / 9)
    slices = deflected(form(POWER[1]), both / 2, length=length)
    assert slices.load[0] * length == pytest.approx(force, rel=ROUNDING)


def test_palmgren_and_iso_agree_to_a_few_percent():
    """Palmgren's pair is 37310 l^(8/9), ISO/TS 16281 says 35948 l^(8/9): one law, 3.6 % apart at any load."""
    palmgren, iso = (deflected(model, [1e-6, 1e-5]).load for model in POWER)
    np.testing.assert_allclose(iso / palmgren, 35948 / 37310, rtol=2e-5)


# All deflections -----------------------------------------------------------------------------------------------------


@every_deflection
@given(approach=decades(-12, -4.5), factor=decades(0.001, 1), length=decades(-2.5, -0.5))
def test_load_and_stiffness_rise_with_the_approach(model, approach, factor, length):
    """More approach, more width: a line contact is progressive."""
    slices = deflected(model, [approach, approach * factor], length=length)
    assert slices.load[1] > slices.load[0] * factor > 0  # more than in proportion
    assert slices.stiffness[1] > slices.stiffness[0] > 0


@every_deflection
@given(approach=decades(-9, -4.5), length=decades(-2.5, -0.5))
def test_stiffness_is_the_derivative_of_the_load(model, approach, length):
    """By a difference of fourth order over +-h, +-2 h, h = 1e-3 of the approach.

    Its truncation error is h^4/30 of the fifth derivative, relative (1e-3)^4/30 times the constants of a power 10/9
    (below 1): 1e-13; its rounding error 1.5 eps/h = 4e-13. Lundberg's law is as smooth away from its limit.
    """
    h = 1e-3 * approach
    load = deflected(model, approach + h * np.array([-2, -1, 1, 2]), length=length).load
    slope = (load[0] - 8 * load[1] + 8 * load[2] - load[3]) / (12 * h)
    assert deflected(model, approach, length=length).stiffness[0] == pytest.approx(slope, rel=5e-12)


# Lundberg ------------------------------------------------------------------------------------------------------------


@lundberg
@given(load=decades(0, 7), length=decades(-2.5, -0.5), radius=decades(-3, -1))
def test_lundberg_inverts_its_explicit_equation(model, load, length, radius):
    """delta = 4 w/(pi E') [1/2 + ln(2 l/b)], b = sqrt(8 w R/(pi E')), in forty digits, from w to delta and back."""
    with mpmath.workdps(40):
        compliance = 4 / (mpmath.pi * STEEL)
        bracket = mpmath.mpf(1) / 2 + mpmath.log(
            2 * length / mpmath.sqrt(2 * compliance * load * radius)
        )
        approach = float(compliance * load * bracket)
        slope = compliance * (bracket - mpmath.mpf(1) / 2)  # d(delta)/dw
        # the approach is rounded to a double, which the load takes over times dlnw/dlndelta = g/(g - 1/2)
        condition = float(bracket / (bracket - mpmath.mpf(1) / 2))
    if bracket < 1:  # too close to the end of the domain to be well conditioned
        return
    slices = deflected(model, approach, length, radius)
    assert slices.load[0] == pytest.approx(load, rel=ROUNDING * condition)
    assert slices.stiffness[0] == pytest.approx(float(1 / slope), rel=ROUNDING * condition**2)


@lundberg
def test_lundberg_ends_where_the_contact_is_twice_as_wide_as_long(model):
    """The bracket 1/2 + ln(2 l/b) falls to 1/2 at b = 2 l: there ddelta/dw = 0, and no load fits more approach."""
    length = 1e-3
    radius = 0.01
    modulus = 1e8
    compliance = 4 / (np.pi * modulus)
    end = compliance * 0.5 * (2 * length) ** 2 / (2 * compliance * radius)  # delta of w at b = 2 l
    slices = deflected(model, [0.999 * end], length, radius, modulus)
    half_width = np.sqrt(2 * compliance * slices.load[0] * radius)
    assert 0.9 * length < half_width < 2 * length
    with pytest.raises(DomainError, match=r"^lundberg-deflection: slice 1 is outside its domain"):
        deflected(model, [0.999 * end, 1.001 * end, 2 * end], length, radius, modulus)


def displacement(b, length):
    """Approach in units of 2 w/(pi E'): the half space under a semi-elliptic strip 2 b x l, at its middle.

    Boussinesq: u = (1 - nu^2)/(pi E) int p/r dA for each body, together 2/(pi E') int p/r dA. Along the strip the
    integral of 1/r is 2 asinh(l/(2 x)); across, x = b sin(angle) makes the semi-ellipse smooth.
    """
    across = quad(
        lambda angle: np.cos(angle) ** 2 * 2 * np.arcsinh(length / (2 * b * np.sin(angle))),
        0,
        np.pi / 2,
        epsabs=0,
        epsrel=1e-12,
        limit=200,
    )
    return 4 / np.pi * across[0]


@lundberg
@pytest.mark.parametrize("slenderness", [3.0, 10.0, 30.0, 100.0, 300.0])
def test_lundberg_is_the_half_space_under_a_long_strip(model, slenderness):
    """int p/r dA/w = 2 [1/2 + ln 4 + ln(l/(2 b))] + b^2/(2 l^2) - ..., so 1/2 + ln 4 = 1.8863, asymptotically.

    asinh(1/z) = ln(2/z) + z^2/4 - 3 z^4/32 + ..., z = 2 x/l, alternating; the mean of x^2 over a semi-ellipse is
    b^2/4, that of x^4 b^4/8. So Lundberg's bracket is low by b^2/(4 l^2), less at most 3/16 (b/l)^4.
    """
    length = 0.015
    radius = 0.006875
    b = length / slenderness
    load = np.pi * STEEL * b**2 / (8 * radius)
    approach = 2 * load / (np.pi * STEEL) * displacement(b, length)
    bracket = displacement(b, length) / 2
    low = (b / length) ** 2 / 4
    # quadrature gives 1e-12 of the bracket
    assert bracket - (0.5 + np.log(4) + np.log(length / (2 * b))) <= low + 1e-11
    assert (
        bracket - (0.5 + np.log(4) + np.log(length / (2 * b)))
        >= low - 3 / 16 * (b / length) ** 4 - 1e-11
    )
    # the code, at the approach of the half space: the load is high by the error of the bracket, through g/(g - 1/2)
    expected = load * (1 + low / (bracket - 0.5))
    assert deflected(model, approach, length, radius).load[0] == pytest.approx(
        expected, rel=(b / length) ** 4 + 1e-10
    )


def test_the_potential_along_the_strip_is_its_double_integral():
    """The inner integral above, 2 asinh(l/(2 x)), is not taken on trust: a plain double quadrature of 1/r."""
    b = 1.0
    length = 6.0
    quarter = dblquad(
        lambda y, angle: np.cos(angle) ** 2 / np.hypot(b * np.sin(angle), y),
        0,
        np.pi / 2,
        0,
        length / 2,
        epsabs=1e-6,
        epsrel=1e-6,
    )
    assert 4 / np.pi * 2 * quarter[0] == pytest.approx(displacement(b, length), rel=1e-5)


@every_contact
def test_deflection_leads_into_hertz(model):
    """The stages of a contact model fit together: approach, load, half width, pressure."""
    law = law_of(model)
    slices = Slices(
        2, Conditions(length=0.015, radius=0.006875, modulus=STEEL), approach=[1e-6, 5e-6]
    )
    form = NumpyForm if model is not law else lambda each: each
    Chain(form(law.deflection()), model)(slices)
    np.testing.assert_allclose(slices.pressure * 2 * slices.half_width, slices.load, rtol=ROUNDING)
