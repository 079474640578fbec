"""rollslip's conformance kit on the model, and numbers that do not come from its code."""

from typing import Any

import mpmath
import numpy as np
import pytest
from rollslip import Chain, Conditions, Slices
from rollslip.fields import FieldError
from rollslip.testing import Conformance

from rollslip_carreau.traction import Carreau

OIL = Conditions(viscosity=0.012, pressure_viscosity=1.6e-8)
SPEEDS = np.array([0.0, 1e-9, 1e-4, 1e-2, 0.3, -0.3, 3.0, 40.0])


class TestCarreau(Conformance):
    models = [Carreau(), Carreau(critical_stress=3e6, exponent=0.2), Carreau(exponent=0.0)]


class TestCarreauAlmostNewtonian(Conformance):
    models = [Carreau(exponent=0.8), Carreau(exponent=1.0)]
    expected_failures = {
        "check_friction_is_below_one_in_a_bearing": "without limiting stress and heating a film that hardly thins is "
        "too stiff at high pressure; the README says so"
    }


def friction(model: Carreau, speeds: Any = SPEEDS, pressure: float = 6e8) -> Any:
    slices = Slices(np.size(speeds), OIL, pressure=pressure, film_thickness=4e-7, sliding_speed=speeds)
    Chain(model)(slices)
    return slices.friction


@pytest.mark.parametrize("exponent", [0.0, 0.2, 0.45, 1.0])
def test_it_is_the_effective_viscosity_times_the_rate(exponent: float) -> None:
    """With the law as it is published, an effective viscosity, in 40 digits."""
    model = Carreau(critical_stress=5e6, exponent=exponent)
    with mpmath.workdps(40):
        eta = mpmath.mpf("0.012") * mpmath.exp(mpmath.mpf("1.6e-8") * 600_000_000)
        expected = []
        for speed in SPEEDS:
            rate = mpmath.mpf(float(speed)) / mpmath.mpf("4e-7")
            effective = eta * (1 + (eta * rate / 5_000_000) ** 2) ** ((mpmath.mpf(exponent) - 1) / 2)
            expected.append(float(effective * rate / 600_000_000))
    np.testing.assert_allclose(friction(model), expected, rtol=5e-15)


def test_slow_films_are_newtonian_and_fast_ones_follow_a_power_law() -> None:
    model = Carreau(critical_stress=5e6, exponent=0.4)
    eta = 0.012 * np.exp(9.6)
    slow = np.array([1e-10, 1e-9])
    np.testing.assert_allclose(friction(model, slow), eta * slow / 4e-7 / 6e8, rtol=1e-9)
    fast = np.array([1e3, 1e4])
    stress = 5e6 * (eta * fast / 4e-7 / 5e6) ** 0.4
    np.testing.assert_allclose(friction(model, fast), stress / 6e8, rtol=1e-6)
    np.testing.assert_allclose(np.diff(np.log(friction(model, fast))) / np.log(10.0), 0.4, rtol=1e-6)


def test_an_exponent_above_one_is_refused() -> None:
    with pytest.raises(FieldError, match="exponent: must be from .* to 1, not 1.2"):
        Carreau(exponent=1.2)
