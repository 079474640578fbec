"""rollslip's conformance kit on the model, and numbers that do not come from its code."""

from typing import Any

import mpmath
import numpy as np
from rollslip import Chain, Conditions, Slices
from rollslip.testing import Conformance

from rollslip_limiting_shear.traction import LimitingShear

OIL = Conditions(viscosity=0.012, pressure_viscosity=1.6e-8)
PRESSURE, FILM = 6e8, 4e-7


class TestLimitingShear(Conformance):
    models = [LimitingShear(), LimitingShear(limit=0.03)]


def friction(limit: float, speeds: Any) -> Any:
    slices = Slices(np.size(speeds), OIL, pressure=PRESSURE, film_thickness=FILM, sliding_speed=speeds)
    Chain(LimitingShear(limit=limit))(slices)
    return slices.friction


def test_it_inverts_the_flow_law_of_bair_and_winer() -> None:
    """g = -(tau_L/eta) ln(1 - tau/tau_L) in 40 digits gives the sliding speed that belongs to a stress."""
    shares = np.array([1e-12, 1e-6, 0.01, 0.5, 0.9, 0.999999])
    with mpmath.workdps(40):
        limiting = mpmath.mpf("0.07") * 600_000_000
        eta = mpmath.mpf("0.012") * mpmath.exp(mpmath.mpf("1.6e-8") * 600_000_000)
        rates = [-limiting / eta * mpmath.log(1 - mpmath.mpf(float(share))) for share in shares]
        speeds = np.array([float(rate * mpmath.mpf("4e-7")) for rate in rates])
    np.testing.assert_allclose(friction(0.07, speeds), 0.07 * shares, rtol=2e-14)
    np.testing.assert_allclose(friction(0.07, -speeds), -0.07 * shares, rtol=2e-14)


def test_it_begins_newtonian_and_ends_at_the_limit() -> None:
    slow = np.array([0.0, 1e-12])
    newtonian = 0.012 * np.exp(9.6) * slow / FILM / PRESSURE
    np.testing.assert_allclose(friction(0.07, slow), newtonian, rtol=1e-8)
    np.testing.assert_array_equal(friction(0.07, [50.0, -50.0]), [0.07, -0.07])
