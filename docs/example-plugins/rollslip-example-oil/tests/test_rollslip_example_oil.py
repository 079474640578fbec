"""rollslip's conformance kit on the oil, and numbers that do not come from its code."""

import mpmath
import pytest
from rollslip.testing import Conformance

from rollslip_example_oil.lubricant import EXAMPLE_OIL


class TestExampleOil(Conformance):
    models = [EXAMPLE_OIL]


def viscosity(T: mpmath.mpf) -> mpmath.mpf:
    """Viscosity [Pa s] by the line through both points on the axes of ASTM D341."""
    rows = [(mpmath.mpf("313.15"), mpmath.mpf(46)), (mpmath.mpf("373.15"), mpmath.mpf("6.8"))]
    (x1, y1), (x2, y2) = [(mpmath.log10(t), mpmath.log10(mpmath.log10(nu + mpmath.mpf("0.7")))) for t, nu in rows]
    y = y1 + (mpmath.log10(T) - x1) * (y2 - y1) / (x2 - x1)
    return 875 * (mpmath.power(10, mpmath.power(10, y)) - mpmath.mpf("0.7")) / 1_000_000


def coefficient(T: mpmath.mpf) -> mpmath.mpf:
    """Pressure-viscosity coefficient [1/Pa] as it is published, with the viscosity in centipoise."""
    return (mpmath.mpf("0.6") + mpmath.mpf("0.965") * mpmath.log10(1000 * viscosity(T))) / 10**8


@pytest.mark.parametrize("celsius", [0.0, 40.0, 70.0, 100.0, 119.0])
def test_it_follows_its_laws(celsius: float) -> None:
    state = EXAMPLE_OIL.at(celsius + 273.15)
    with mpmath.workdps(40):
        T = mpmath.mpf(celsius + 273.15)
        eta = viscosity(T)
        alpha = coefficient(T)
        beta = -mpmath.diff(viscosity, T) / eta
        gamma = -mpmath.diff(coefficient, T)
    assert state.viscosity == pytest.approx(float(eta), rel=1e-11)
    assert state.pressure_viscosity == pytest.approx(float(alpha), rel=1e-12)
    assert state.thermoviscosity == pytest.approx(float(beta), rel=1e-11)
    assert state.pressure_thermoviscosity == pytest.approx(float(gamma), rel=1e-11)
    assert state.conductivity == 0.13
