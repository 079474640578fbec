"""rollslip's conformance kit on the model, and numbers that do not come from its code."""

from typing import Any

import mpmath
import numpy as np
from rollslip import Chain, Slices
from rollslip.testing import Conformance

from rollslip_circular.traction import Circular

PRESSURE = 6e8
FILM = 4e-7
VISCOSITY = 180.0


class TestCircular(Conformance):
    models = [Circular(), Circular(limit=0.03)]


def friction(limit: float, speeds: Any) -> Any:
    contact = {"pressure": PRESSURE, "film_thickness": FILM, "film_viscosity": VISCOSITY}
    slices = Slices(np.size(speeds), **contact, sliding_speed=speeds)
    Chain(Circular(limit=limit))(slices)
    return slices.friction


def test_it_inverts_the_flow_law_of_lee_and_hamrock() -> None:
    """g = (tau/eta)/sqrt(1 - (tau/tau_L)^2) in 40 digits gives the sliding speed that belongs to a stress."""
    fractions = np.array([1e-12, 1e-6, 0.01, 0.5, 0.9, 0.999999])
    with mpmath.workdps(40):
        limiting = mpmath.mpf("0.07") * 600_000_000
        stresses = [limiting * mpmath.mpf(float(fraction)) for fraction in fractions]
        rates = [stress / 180 / mpmath.sqrt(1 - (stress / limiting) ** 2) for stress in stresses]
        speeds = np.array([float(rate * mpmath.mpf("4e-7")) for rate in rates])
    np.testing.assert_allclose(friction(0.07, speeds), 0.07 * fractions, rtol=2e-14)
    np.testing.assert_allclose(friction(0.07, -speeds), -0.07 * fractions, rtol=2e-14)


def test_it_begins_newtonian_and_ends_at_the_limit() -> None:
    slow = np.array([0.0, 1e-12])
    np.testing.assert_allclose(friction(0.07, slow), VISCOSITY * slow / FILM / PRESSURE, rtol=1e-8)
    np.testing.assert_array_equal(friction(0.07, [1e9, -1e9]), [0.07, -0.07])
