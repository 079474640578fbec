"""rollslip's conformance kit on the model, and numbers that do not come from its code."""

import math

import numpy as np
import pytest
from rollslip import Chain, Conditions, Slices, get_model
from rollslip.testing import Conformance

from rollslip_local_limit.traction import LocalLimit

OIL = Conditions(viscosity=0.02, pressure_viscosity=2e-8, thermoviscosity=0.03, pressure_thermoviscosity=1e-10)
BARUS = get_model("pressure-viscosity", "barus")


class TestLocalLimit(Conformance):
    models = [LocalLimit(), LocalLimit(limit=0.03), LocalLimit(law=BARUS)]


def friction(count: int, speed: float, pressure: float, limit: float = 0.08) -> np.ndarray:
    slices = Slices(count, OIL, pressure=pressure, film_thickness=1e-6, sliding_speed=speed)
    Chain(LocalLimit(law=BARUS, limit=limit))(slices)
    return slices.friction


@pytest.mark.parametrize("count", [1, 127, 128, 129, 300])
def test_slow_slides_have_the_mean_viscosity_of_hertzs_contact(count: int) -> None:
    """The mean of eta0 exp(alpha p) over an ellipse of pressures, by the midpoint rule on 20,000 points."""
    pressure = 1e8
    x = (np.arange(20000) + 0.5) / 20000
    local = 4.0 / math.pi * pressure * np.sqrt(1.0 - x**2)
    mean = float(np.mean(0.02 * np.exp(2e-8 * local)))
    np.testing.assert_allclose(friction(count, 1e-6, pressure), mean * 1e-6 / 1e-6 / pressure, rtol=1e-3)


def test_fast_slides_have_the_limit_whatever_the_oil() -> None:
    np.testing.assert_allclose(friction(3, 1e6, 5e8, 0.05), 0.05, rtol=1e-5)
    np.testing.assert_allclose(friction(3, -1e6, 5e8, 0.05), -0.05, rtol=1e-5)
    np.testing.assert_array_equal(friction(3, 0.0, 5e8), 0.0)
