"""Maxima and balances at slips that samples share: against the long way, and where there is no short one."""

import numpy as np
import pytest

from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.bearing.resolution import Resolution
from rollslip.motion import lattice, runaway
from rollslip.motion.continuation import crossing
from rollslip.motion.lattice import Torques, balanced, highest, maximum, place_of, slip_of

SCENE = load_scene("1032930-70C")
#: Oils whose torque has a smooth maximum, at slips from 25 to 65 %.
OILS = [
    {},
    {"lubricant.pressure_viscosity_factor": 0.95, "lubricant.eyring_stress": "3 MPa"},
    {"lubricant.pressure_viscosity_factor": 1.2, "lubricant.eyring_stress": "9 MPa"},
    {"lubricant.viscosity_factor": 0.9, "lubricant.shear_modulus": "60 MPa"},
]


def rolling(changes, slices=41):
    """Balance of the rollers of a bearing with more slices than few loads."""
    bearing = assemble(evolve(SCENE, changes), Resolution(slices=slices, quadrature="gauss", instants=2))
    return runaway.rollers(bearing, 2)


@pytest.mark.quick
@pytest.mark.parametrize("slip", [1e-4, 0.01, 0.3, 0.5, 0.9])
def test_places_are_those_of_slips(slip):
    assert slip_of(place_of(slip)) == pytest.approx(slip, rel=1e-13)
    assert slip_of(0) == 0.5


@pytest.mark.parametrize("changes", OILS)
def test_few_loads_give_the_torque_of_all_slices(changes):
    balance = rolling(changes)
    for slip in map(slip_of, (-60, -20, 0)):
        few, all_of = balance.by_few_loads(slip), balance.orbit(slip)
        assert few.torque == pytest.approx(all_of.torque, rel=1e-6)
        assert balance.missed(few) <= 1e-6
        assert few.force == pytest.approx(all_of.force, rel=1e-12)
        np.testing.assert_allclose(few.roller_slip, all_of.roller_slip, rtol=1e-4)


@pytest.mark.parametrize("changes", OILS)
def test_a_maximum_is_that_of_the_long_way(changes):
    balance = rolling(changes)
    torques = Torques(balance, 0.95)
    slip, drag = maximum(torques, highest(torques, 0.4), 2e-3, 1e-5)
    long = runaway._climbed(balance.torque, 0.4, 0.95)
    assert slip == pytest.approx(long[0], rel=2e-3)
    assert drag == pytest.approx(long[1], rel=3e-6)
    assert drag == pytest.approx(balance.torque(slip), rel=3e-6)


@pytest.mark.parametrize("changes", OILS)
@pytest.mark.parametrize("share", [0.05, 0.6])
def test_a_balance_is_that_of_secants_on_the_torque_of_all_slices(changes, share):
    balance = rolling(changes)
    drag = share * balance.torque(0.1)
    at = balanced(Torques(balance, 0.9), 0.08 * share, lambda slip: -drag * (1.0 + slip), 1e-5)
    excess, start = lambda slip: balance.torque(slip) - drag * (1.0 + slip), at * 1.02
    slope = (excess(start) - excess(at)) / (start - at)
    assert at == pytest.approx(crossing(excess, start, slope, 0.9, 1e-9)[0], rel=1e-6)


def test_a_corner_is_no_maximum_of_a_polynomial_and_the_highest_torque_is_found():
    """Rollers that change their motion at once: more torque than at any slip beside, each gone on to from above."""
    changes = {
        "lubricant.pressure_viscosity_factor": 0.9155,
        "lubricant.viscosity_factor": 1.004,
        "lubricant.eyring_stress": "9.5 MPa",
    }
    balance = rolling(changes)
    torques = Torques(balance, 0.95)
    best = highest(torques, 0.95)
    slip, drag = maximum(torques, best, 2e-3, 1e-5)
    fresh = rolling(changes)
    beside = [fresh.torque(at) for at in np.linspace(0.93, 0.75, 37)]
    assert drag >= max(beside) * (1.0 - 1e-4)
    assert 0.75 < slip < 0.93
    assert not torques.alike(best - 2, best - 1, best, best + 1)


def test_where_few_loads_miss_all_slices_there_is_no_short_way(monkeypatch):
    balance = rolling({})
    torques = Torques(balance, 0.95)
    best = highest(torques, 0.4)
    monkeypatch.setattr(lattice.TorqueBalance, "missed", lambda *given: 2e-5)
    assert maximum(torques, best, 2e-3, 1e-5) is None
    assert balanced(torques, 0.01, lambda slip: -0.3, 1e-5) is None
    assert runaway._shared(balance, 0.4, 0.95) is None


def test_bounds_are_looked_at_on_all_slices():
    looked = []
    bearing = assemble(SCENE, Resolution(slices=21, instants=2)).with_bounds(lambda slices: looked.append(len(slices)))
    balance = runaway.rollers(bearing, 2)
    assert runaway._shared(balance, 0.4, 0.95) is None
    assert not looked
    balance.torque(0.3)
    assert looked


def test_the_end_of_the_range_has_no_maximum():
    torques = Torques(rolling({}), 0.2)
    assert highest(torques, 0.15) is None
