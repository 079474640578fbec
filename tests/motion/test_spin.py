"""Compiled spin of rollers: against solutions by hand, and what comes of errors."""

import numpy as np
import pytest
from scipy.optimize import brentq

from rollslip_kernels.motion.spin import Spin

pytestmark = pytest.mark.quick
#: Radii of raceways, roller and orbit [m].
RADII = INNER, OUTER, RADIUS, ORBIT = 0.08, 0.1, 0.01, 0.09
#: Rolling speed by which slips become speeds [m/s].
ROLLING = 30.0
#: Roller positions of an orbit, each with its own rise and zero of traction.
POSITIONS = 41
RNG = np.random.default_rng(3)
RISES = RNG.uniform(50.0, 300.0, POSITIONS)
AT = RNG.uniform(-0.02, 0.03, POSITIONS)


def linear(slip):
    """Tractions whose difference rises with the roller slip through zero, each at its own place."""
    pull = RISES * (slip - AT)
    return np.stack((pull, np.zeros_like(pull))), np.zeros((2, POSITIONS))


def wavy(slip):
    """Three balances for most: 0.6 x - sin(8 x) / 8 less something has falling parts between rising ones."""
    pull = 0.6 * slip - np.sin(8.0 * slip) / 8.0 - AT
    return np.stack((pull, np.zeros_like(pull))), np.zeros((2, POSITIONS))


def test_an_orbit_of_linear_torques_is_the_solution_of_its_linear_system():
    inertia = 0.7
    slopes = RADIUS * RISES
    change = 1.5 * np.eye(POSITIONS) - 2.0 * np.eye(POSITIONS, k=-1) + 0.5 * np.eye(POSITIONS, k=-2)
    change[0, -1] = -2.0
    change[0, -2] = 0.5
    change[1, -1] = 0.5
    expected = np.linalg.solve(inertia * change + np.diag(slopes), slopes * AT)
    slip, multiplier, left, ended = Spin(POSITIONS, linear, RADII, ROLLING).find_periodic(
        np.zeros(POSITIONS), inertia
    )
    assert not ended
    # differences over 1e-7 leave 1e-8 of a slope, so that the last step ends at 1e-9 of the slips
    np.testing.assert_allclose(slip, expected, rtol=0, atol=1e-14)
    assert np.log(multiplier) == pytest.approx(-slopes.sum() / inertia, rel=1e-5)
    assert left < 1e-7


def test_torques_balance_where_each_rises_through_zero():
    place, lost, ended = Spin(POSITIONS, wavy, RADII, ROLLING).find_balances(
        np.full(POSITIONS, -1.0), np.full(POSITIONS, 1.0)
    )
    assert not ended
    assert not lost.any()
    torque = wavy(place)[0][0]
    rise = 0.6 - np.cos(8.0 * place)
    np.testing.assert_allclose(torque, 0.0, atol=1e-14)
    assert np.all(rise > 0.0)
    k = 7
    low = place[k] - 0.01
    high = place[k] + 0.01
    at = brentq(lambda x: wavy(np.full(POSITIONS, x))[0][0][k], low, high, xtol=1e-15)
    assert place[k] == pytest.approx(at, abs=1e-13)


def test_a_place_given_twice_is_kept_and_one_without_balance_is_told():
    low = np.full(POSITIONS, 0.5)
    high = np.full(POSITIONS, 1.0)
    low[1:] = high[1:]
    unknown = np.full((2, POSITIONS), np.nan)
    place, lost, ended = Spin(
        POSITIONS, lambda _: (unknown, unknown), RADII, ROLLING
    ).find_balances(low, high)
    assert ended == "lost"
    assert lost.tolist() == [True] + [False] * (POSITIONS - 1)
    np.testing.assert_array_equal(place[1:], 1.0)


def test_errors_of_forces_come_back_as_they_are():
    def fails(slip):
        raise ZeroDivisionError("of a law")

    with pytest.raises(ZeroDivisionError, match="of a law"):
        Spin(POSITIONS, fails, RADII, ROLLING).torques(np.zeros(POSITIONS))


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda spin: spin.torques(np.zeros(3)), "3 values for 41 positions"),
        (
            lambda spin: spin.set_leads(np.zeros(41), np.zeros(4)),
            "41 and 4 speeds for 41 positions",
        ),
        (lambda spin: spin.find_balances(np.zeros(41), np.zeros(2)), "2 values for 41 positions"),
    ],
)
def test_sizes_that_do_not_fit_are_refused(call, told):
    with pytest.raises(ValueError, match=told):
        call(Spin(POSITIONS, linear, RADII, ROLLING))


def test_friction_of_a_pocket_is_against_the_spin():
    forces = np.full((2, POSITIONS), 100.0), np.zeros((2, POSITIONS))
    slip = np.zeros(POSITIONS)
    free, held = (
        Spin(POSITIONS, lambda _: forces, RADII, ROLLING, 0.0, pocket).torques(slip)[0]
        for pocket in (0.0, 0.2)
    )
    along = INNER * 100.0 + OUTER * 100.0
    np.testing.assert_allclose(free, 0.0, atol=1e-15)
    np.testing.assert_allclose(
        held, -0.2 * RADIUS / ORBIT * along * ROLLING / np.hypot(ROLLING, 1e-2), rtol=1e-14
    )


def test_rows_that_do_not_exist_are_refused():
    one = Spin(POSITIONS, linear, RADII, ROLLING)
    with pytest.raises(ValueError, match="row 1 of 1 does not exist"):
        one.find_periodic_rows(
            np.array([1]), POSITIONS, np.ones(1), np.zeros((1, POSITIONS)), np.ones(1)
        )
