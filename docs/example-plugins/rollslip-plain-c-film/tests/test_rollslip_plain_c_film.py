"""rollslip's conformance kit on the model, and numbers that do not come from its code."""

import mpmath
import numpy as np
import pytest
from rollslip import Chain, Conditions, Slices
from rollslip.testing import Conformance

from rollslip_plain_c_film.film import ErtelGrubin

RADIUS = 0.007
MODULUS = 2.28e11


class TestErtelGrubin(Conformance):
    models = [ErtelGrubin()]


def film(viscosity: float, pressure_viscosity: float, speed: float, load: float) -> float:
    steel = Conditions(radius=RADIUS, modulus=MODULUS, viscosity=viscosity, pressure_viscosity=pressure_viscosity)
    slices = Slices(1, steel, rolling_speed=speed, load=load)
    Chain(ErtelGrubin())(slices)
    return float(slices.film_thickness[0])


def test_the_power_law_in_forty_digits() -> None:
    with mpmath.workdps(40):
        u = mpmath.mpf("0.01") * 20 / (mpmath.mpf("2.28e11") * mpmath.mpf("0.007"))
        g = mpmath.mpf("1.5e-8") * mpmath.mpf("2.28e11")
        w = 30_000 / (mpmath.mpf("2.28e11") * mpmath.mpf("0.007"))
        expected = mpmath.mpf("0.007") * mpmath.mpf("1.95") * mpmath.root((g * u) ** 8 / w, 11)
        expected = float(expected)
    assert film(0.01, 1.5e-8, 20.0, 3e4) == pytest.approx(expected, rel=2e-15)


@pytest.mark.parametrize(
    ("viscosity", "pressure_viscosity", "speed", "load"),
    [(0.01, 2e-8, 10.0, 1e5), (0.01, 2e-8, 10.0, 3e4), (0.004, 1.2e-8, 5.0, 3e4), (0.02, 2e-8, 10.0, 1e5)],
)
def test_it_is_within_5_percent_of_grubins_integral(
    viscosity: float, pressure_viscosity: float, speed: float, load: float
) -> None:
    """1/alpha = 12 eta0 u times the integral of (h - h0)/h^3 over the inlet of Hertz's gap, solved for h0."""
    half_width = np.sqrt(8 * load * RADIUS / (np.pi * MODULUS))
    scale = half_width**2 / (2 * RADIUS)

    def inlet(ratio: mpmath.mpf) -> mpmath.mpf:
        def integrand(t: mpmath.mpf) -> mpmath.mpf:
            x = 1 + t * t  # the gap opens with the power 3/2
            root = mpmath.sqrt(x * x - 1)
            gap = x * root - mpmath.log(x + root)
            return gap / (gap + ratio) ** 3 * 2 * t

        return mpmath.quad(integrand, [0, 0.05, 0.2, 0.5, 1, 2, 5, 20, mpmath.inf])

    def excess(log_ratio: mpmath.mpf) -> mpmath.mpf:
        pressure = 12 * viscosity * speed * half_width / scale**2 * inlet(mpmath.exp(log_ratio))
        return mpmath.log(pressure_viscosity * pressure)

    ratio = mpmath.exp(mpmath.findroot(excess, (mpmath.log(0.05), mpmath.log(0.1)), tol=1e-10))
    assert 0.02 < ratio < 4  # h R/b^2 from 0.01 to 2
    assert film(viscosity, pressure_viscosity, speed, load) == pytest.approx(float(ratio) * scale, rel=0.05)
