"""rollslip's conformance kit on the model, and numbers that do not come from its code."""

from typing import Any

import mpmath
import numpy as np
import pytest
from rollslip import Chain, Slices
from rollslip.fields import FieldError
from rollslip.testing import Conformance

from rollslip_cross.traction import Cross

SPEEDS = np.array([0.0, 1e-9, 1e-4, 1e-2, 0.3, -0.3, 3.0, 40.0])


class TestCross(Conformance):
    models = [Cross(), Cross(critical_stress=3e6, exponent=0.9), Cross(exponent=1.0)]


class TestCrossAlmostNewtonian(Conformance):
    models = [Cross(exponent=0.3), Cross(exponent=0.0)]
    expected_failures = {
        "check_friction_coefficient_is_below_unity": "without limiting stress and heating a film that hardly thins is "
        "too stiff at high pressure; the README says so"
    }


def friction(model: Cross, speeds: Any = SPEEDS) -> Any:
    contact = {"pressure": 6e8, "film_thickness": 4e-7, "film_viscosity": 180.0}
    slices = Slices(np.size(speeds), **contact, sliding_speed=speeds)
    Chain(model)(slices)
    return slices.friction


@pytest.mark.parametrize("exponent", [0.0, 0.3, 0.8, 1.0])
def test_it_is_the_effective_viscosity_times_the_rate(exponent: float) -> None:
    """With the law as it is published, an effective viscosity with a relaxation time, in 40 digits."""
    model = Cross(critical_stress=5e6, exponent=exponent)
    with mpmath.workdps(40):
        expected = []
        for speed in SPEEDS:
            rate = mpmath.mpf(float(speed)) / mpmath.mpf("4e-7")
            time = mpmath.mpf(180) / 5_000_000
            effective = 180 / (1 + (time * abs(rate)) ** mpmath.mpf(exponent))
            expected.append(float(effective * rate / 600_000_000))
    np.testing.assert_allclose(friction(model), expected, rtol=2e-14)


def test_slow_films_are_newtonian_and_fast_ones_follow_a_power_law() -> None:
    model = Cross(critical_stress=5e6, exponent=0.8)
    slow = np.array([1e-12, 1e-11])
    np.testing.assert_allclose(friction(model, slow), 180.0 * slow / 4e-7 / 6e8, rtol=1e-6)
    fast = np.array([1e6, 1e7])
    stress = 5e6 * (180.0 * fast / 4e-7 / 5e6) ** 0.2
    np.testing.assert_allclose(friction(model, fast), stress / 6e8, rtol=1e-5)
    halved = 5e6 * 4e-7 / 180.0
    np.testing.assert_allclose(friction(model, halved), 5e6 / 2 / 6e8, rtol=1e-14)


def test_an_exponent_above_one_is_refused() -> None:
    with pytest.raises(FieldError, match="exponent: must be from .* to 1, not 1.2"):
        Cross(exponent=1.2)
