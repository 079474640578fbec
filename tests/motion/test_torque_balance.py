"""What is made of a balance of torques: reserves and their words, positions, and curves of effective friction."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import loading_branch_scenes as scenes
from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.results.text import Status
from rollslip_studies.motion import torque_balance as module
from rollslip_studies.motion.effective_table import EffectiveTable
from rollslip_studies.motion.spins import Motions
from rollslip_studies.motion.torque_balance import (
    RANGE,
    SkiddingOnset,
    SteadyOperation,
    TorqueBalance,
    describe_no_skidding,
    evaluate_on_branch,
    reserve,
    torque_balance,
)

pytestmark = pytest.mark.quick


def balance(drag, carried, end=0.95, points=60):
    """The torques of a bearing: drags, and what rollers carry, as functions of the slip."""
    slips = np.geomspace(1e-4, end, points)
    branch = SimpleNamespace(torque_curve=(slips, np.array([*map(carried, slips)])))
    return SimpleNamespace(
        drag=drag,
        torques=lambda slips: np.array([*map(carried, slips)]),
        loading_branch=lambda max_slip: branch,
    )


NO_ONSET = SkiddingOnset(math.nan, math.nan, "no skidding")


@pytest.mark.parametrize(
    ("onset", "drag", "expected"),
    [
        (SkiddingOnset(0.1, 3.0, "found"), lambda _: -1.5, 2.0),  # at the onset
        (NO_ONSET, lambda _: -1.5, 4.0),  # at a slip of 20 %, not at the largest torque beyond
        (NO_ONSET, lambda slip: -1.5 * (1.0 - slip), 5.0),  # drags that fall with slip
        (
            NO_ONSET,
            lambda slip: -30.0 * slip,
            3.0e-3 / 3.0e-3,
        ),  # drags as large as the torque everywhere
    ],
)
def test_a_reserve_is_the_largest_torque_over_the_drag_at_the_same_slip(onset, drag, expected):
    found = reserve(
        balance(drag, lambda slip: 30.0 * slip), onset, SteadyOperation(0.05, 1.5, Status.FOUND)
    )
    assert found.factor == pytest.approx(expected, rel=1e-9)
    assert found.status == Status.FOUND


def test_a_smooth_maximum_between_the_points_of_a_curve_is_found():
    def carried(slip):
        return 3.0 - math.log(slip / 0.0512) ** 2

    found = reserve(
        balance(lambda _: -1.5, carried, points=12),
        NO_ONSET,
        SteadyOperation(0.01, 0.1, Status.FOUND),
    )
    assert (found.factor, found.slip) == pytest.approx((2.0, 0.0512), rel=1e-9)


@given(
    acceptable=st.floats(0.01, 0.15),
    peak=st.floats(0.02, 0.9),
    fall=st.floats(-0.9, 0.9),
    onset=st.floats(0.16, 0.95),
)
def test_the_reserve_to_skidding_is_not_below_that_to_a_slip_before_the_onset(
    acceptable, peak, fall, onset
):
    def carried(slip):
        return 4.0 * slip / peak / (1.0 + (slip / peak) ** 2)

    def drag(slip):
        return -(1.0 - fall * slip)

    away = SkiddingOnset(onset, carried(onset), "found")
    found = reserve(balance(drag, carried), away, SteadyOperation(1e-4, -drag(1e-4), Status.FOUND))
    assert found.factor >= max(carried(acceptable) / -drag(acceptable), 1.0) * (1.0 - 1e-4)


@pytest.mark.parametrize("slip", [0.21, math.nan])
def test_drags_that_nothing_carries_leave_what_is_carried_at_the_best_slip(slip):
    status = Status.NO_STEADY_SLIP if math.isnan(slip) else Status.FOUND
    found = reserve(
        balance(lambda _: -4.0, lambda slip: 10.0 * slip),
        NO_ONSET,
        SteadyOperation(slip, 4.0, status),
    )
    assert found.factor == pytest.approx(0.5)
    assert found.status.startswith(Status.SKIDS)


def test_a_cage_that_rolling_resistance_alone_lets_skid_has_no_drag_at_the_onset():
    found = reserve(
        balance(lambda _: 0.0, lambda slip: 10.0 * slip),
        SkiddingOnset(0.1, 1.0, "found"),
        SteadyOperation(0.3, 0.0, Status.FOUND),
    )
    assert found.factor == 0.0
    assert found.status.startswith(Status.SKIDS)


def test_rollers_that_nothing_resists_have_one_motion_without_a_search(monkeypatch):
    drags = SimpleNamespace(pocket_friction=None, torques=())
    one = TorqueBalance(assemble(load_scene("1032930-50C")), drags, n_positions=2)
    monkeypatch.delattr(Motions, "find")
    # they roll without a torque at no slip
    assert (one.has_several_motions(0.3), *one.torques_from_zero(np.zeros(1))) == (False, 0.0)


def test_a_cage_beyond_the_slip_of_skidding_has_a_reserve_of_1_at_most():
    found = reserve(
        balance(lambda _: -1.0, lambda slip: 10.0 * slip),
        NO_ONSET,
        SteadyOperation(0.21, 1.0, Status.FOUND),
    )
    assert found.factor == 1.0
    assert found.status.startswith(Status.SKIDS)


@pytest.mark.parametrize(
    ("slip", "factor", "begins"), [(0.19, math.inf, Status.AT_LEAST), (0.21, 0.0, Status.SKIDS)]
)
def test_a_cage_that_skids_without_a_drag_has_no_reserve(slip, factor, begins):
    """Rolling resistance alone brakes it."""
    found = reserve(
        balance(lambda _: 0.0, lambda slip: slip - 0.2),
        NO_ONSET,
        SteadyOperation(slip, 0.0, Status.FOUND),
    )
    assert (found.factor, Status.of(found.status)) == (factor, begins)


@pytest.mark.parametrize(
    ("end", "told"),
    [(0.95, "there the cage nearly stands still"), (0.9, "raise KEY to look further")],
)
def test_a_cage_that_nearly_stands_still_is_not_looked_at_further(end, told):
    said = describe_no_skidding(SimpleNamespace(maximum=(end, 1.5), end=end, refusal=""), "KEY")
    assert (
        said
        == f"no skidding up to a slip of {end:g}, where the rollers carry the largest torque, 1.5 N m; {told}"
    )


def test_rollers_are_followed_on_56_to_512_positions():
    assembly = assemble(load_scene("1032930-50C"))  # 28 rollers
    assert [
        torque_balance(assembly, requested).motions.positions for requested in (1, 7, 1000)
    ] == [
        56,
        196,
        532,
    ]


@pytest.mark.parametrize("number", [1, 20])
def test_the_time_of_a_loading_branch_is_estimated_within_a_factor_of_two(number, monkeypatch):
    """By a clock that counts the positions of orbits at which motions are found: without and with a jump."""
    counts = []
    find = Motions.find

    def counted(motions, slips, starts=None):
        counts.append(slips.size * motions.positions)
        return find(motions, slips, starts)

    monkeypatch.setattr(Motions, "find", counted)
    clock = SimpleNamespace(process_time=lambda: float(sum(counts)))
    monkeypatch.setattr(module, "time", clock)
    one = scenes.balance(scenes.free(number))
    estimate = one.seconds()
    counts.clear()
    assert one.loading_branch().maximum_error < 0.03
    assert 0.5 < estimate / sum(counts) < 2.0


@pytest.mark.parametrize("driven", ["inner", "outer"])
def test_tractions_are_positive_where_they_drive_whichever_ring_turns(driven):
    speeds = {
        f"operation.{ring}_speed": "2000 rpm" if ring == driven else "0 rpm"
        for ring in ("inner", "outer")
    }
    one = torque_balance(
        assemble(evolve(load_scene("1032930-50C"), {"accuracy.slices": 4, **speeds}, si=True)), 2
    )
    assert one.motions.sense == (1.0 if driven == "inner" else -1.0)
    orbit = one.orbit(0.1)
    assert orbit.torque > 0.0
    assert (orbit.traction.sum(axis=1) > 0.0).all()


def test_contacts_are_evaluated_in_the_motion_and_counted_once():
    one = torque_balance(assemble(evolve(load_scene("1032930-50C"), {"accuracy.slices": 4})), 2)
    orbit = one.orbit(0.1)
    for contacts, traction in zip(one.evaluate_contacts(orbit), orbit.traction, strict=True):
        found = contacts.per_roller(contacts.slices.friction * contacts.force)
        assert one.motions.sense * found == pytest.approx(traction)
    # it is that of both rings
    chain = one.assembly.inner.chain.kernel
    spins = one.motions.spins(np.array([0.1]))
    before = chain.evaluated
    for _ in range(3):
        spins.kernel.torques(np.zeros(one.motions.positions))
        spins.check("")
    assert chain.evaluated - before == sum(spins.kernel.evaluated)


def test_ranges_of_laws_are_checked_from_pure_rolling_to_the_end_and_before_the_largest_torque(
    monkeypatch,
):
    one = scenes.balance(scenes.free(20))
    slips = []
    orbit = TorqueBalance.orbit
    monkeypatch.setattr(
        TorqueBalance, "orbit", lambda self, slip: (slips.append(slip), orbit(self, slip))[1]
    )
    evaluate_on_branch(one.assembly, RANGE)
    assert slips[0] == 0.0
    assert slips[-1] == RANGE
    assert 0.0 < slips[1] < one.loading_branch().jumps[0].slip


def test_rollers_that_rub_at_neighbours_slip_without_the_cage():
    assembly = assemble(load_scene("1032930-50C"))
    assert [Motions(assembly, 2, rubbing=rubs).resists for rubs in (0.0, 0.05)] == [False, True]


@pytest.mark.parametrize(
    ("effective", "speed"), [(False, "0.05 rpm"), (False, "1500 rpm"), (True, "1500 rpm")]
)
def test_resistance_to_rolling_is_that_of_python_also_where_hardly_anything_rolls(effective, speed):
    scene = evolve(load_scene("gearbox"), {"operation.inner_speed": speed}, si=True)
    slow = torque_balance(assemble(scene), 2, inertia=False, effective=effective)
    assert slow.assembly.inner.chain.resists
    orbit = slow.orbit(0.1)
    count = slow.assembly.scene.bearing.rollers
    assert orbit.torque == pytest.approx(
        count * slow.forces(orbit)[2].mean() * slow.motions.sense, rel=1e-6
    )


def test_curves_of_effective_friction_change_torques_by_less_than_the_tolerance_of_tables(
    monkeypatch,
):
    """With twice the tolerance of curves the torque of this bearing changes by 1.9e-2."""
    assembly = scenes.balance(scenes.catalogue(0), slices=20).assembly
    slips = np.array([4.8e-4])  # where curves are steepest
    torques = torque_balance(assembly, 2, effective=True).torques(slips)
    monkeypatch.setattr(module, "_CURVE_TOLERANCE_FRACTION", 0.01)
    fine = torque_balance(assembly, 2, effective=True).torques(slips)
    assert torques == pytest.approx(fine, rel=assembly.resolution.table_tolerance)


def test_effective_friction_is_held_beyond_its_table():
    x = np.linspace(-0.9, 0.9, 7)
    table = EffectiveTable(np.stack((x, np.full(7, 0.3)), axis=1), (-0.9, 0.9), 2.0, 0.0)
    assert table.friction(np.array([-1e9, -18.0, 2.0, 18.0, 1e9])) == pytest.approx(
        [-0.9, -0.9, 0.5, 0.9, 0.9]
    )
