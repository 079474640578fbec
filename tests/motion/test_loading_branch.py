"""The loading branch of the rollers: against a plain march, motion in time, and what holds whatever the bearing."""

import functools
import math
from types import SimpleNamespace

import attrs
import numpy as np
import pytest
from hypothesis import given, reject, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

import loading_branch_scenes as scenes
from rollslip import evolve, load_scene
from rollslip.bearing import raceway
from rollslip.bearing.assembly import assemble
from rollslip.errors import DomainError, SceneError
from rollslip_kernels.motion.spin import Spin as Kernel
from rollslip_kernels.slices import Slices
from rollslip_studies.motion import loading_branch, spins
from rollslip_studies.motion.loading_branch import (
    SEARCH,
    Jump,
    _drop_doubtful,
    _estimate_excess_over_samples,
    _find_intervals,
    _find_maxima,
    _Maximum,
    _Search,
    _second_derivative,
    _slips_within,
    find_loading_branch,
)
from rollslip_studies.motion.spins import Motion, Motions, logit_slip, slip_from_logit
from rollslip_studies.motion.torque_balance import (
    RANGE,
    TorqueBalance,
    running,
    skidding_onset,
    torque_balance,
)
from tabled import REFERENCES, rows_of
from without_bands import run


def balance(
    name="1032930-50C", *, n_positions=2, inertia=True, effective=False, slices=6, **changes
):
    made = assemble(evolve(load_scene(name), changes, si=True))
    few = made.at(
        attrs.evolve(made.resolution, slices=slices, quadrature="equal", table_tolerance=1e-3)
    )
    return torque_balance(few, n_positions, inertia=inertia, effective=effective)


@functools.cache
def balance_of(kind, number):
    return scenes.balance(getattr(scenes, kind)(number))


def test_a_step_of_the_torque_is_rollers_that_come_to_roll_on_the_outer_ring_by_boundary_friction():
    slips = np.array([0.744, 0.748, 0.752])
    off = []
    steps = []
    for traction in ({}, {"models.traction": "muraki"}):
        one = balance(
            "1032930-70C",
            n_positions=1,
            inertia=False,
            **{"operation.temperature": "100 degC"},
            **traction,
        )
        motions = [found[0] for found in one.motions.find(slips, np.zeros(3))]
        off.append(
            [float(at - one.roller_slip.flat[0]) for at, one in zip(slips, motions, strict=True)]
        )
        steps.append(np.diff([motion.torque for motion in motions]) / motions[0].torque)
    assert (
        off[0][2] < 2e-3 < 0.02 < off[0][1]
    )  # rolling on the outer ring a roller slips as the cage
    assert steps[0][1] > 2.0 * steps[0][0]
    assert off[1][2] > 0.1
    assert steps[1][1] == pytest.approx(steps[1][0], rel=0.05)


@pytest.mark.parametrize("celsius", [70, 100])
def test_balances_do_not_depend_on_the_slips_that_were_asked_for_before(celsius):
    """Where boundary friction has several balances at some positions, of which rollers leave one where it ends."""
    one = balance(
        "1032930-70C", n_positions=2, inertia=False, **{"operation.temperature": f"{celsius} degC"}
    )
    fine = np.geomspace(1e-3, 0.9, 121)
    many = one.torques(fine)
    few = one.torques(fine[::20])
    assert few == pytest.approx(many[::20], rel=1e-9)


def test_a_motion_is_gone_on_with_where_rollers_that_come_from_afar_do_not_converge():
    """At 20 N and 4810 rpm rollers that begin with rolling on a ring hardly leave it in eight orbits."""
    scene = scenes.wide(100_156)
    made = assemble(scene)
    few = made.at(
        attrs.evolve(made.resolution, slices=40, quadrature="gauss", n_positions=3)
    ).with_resistance()
    one = TorqueBalance(few, few.cage.drags, n_positions=3)
    assert not any(motion.converged for motion in one.motions.find(np.array([0.77]))[0])
    branch = one.loading_branch()
    assert branch.end == RANGE
    assert branch.refusal == ""
    assert all(motion.converged and motion.is_continuous for motion in branch.motions[1:])
    (jump,) = branch.jumps
    below = max(
        (motion for motion in branch.motions if motion.slip < jump.slip),
        key=lambda motion: motion.slip,
    )
    again = one.motions.find(np.array([jump.slip]), below.normalised_slip[:1])[0][0]
    assert jump.error < 1e-3
    assert again.torque == pytest.approx(
        jump.drag, rel=1.01 * jump.error
    )  # of more positions than these
    slips = np.array([motion.slip for motion in branch.motions])
    known = [motion.torque for motion in branch.motions]
    assert any(
        len(each) == 1 and not each[0].converged for each in one.motions.find(slips)
    )  # Newton's method leaves one
    assert one.torques(slips) == pytest.approx(known, rel=2e-3)  # one question, one answer
    assert [one.torque(slip) for slip in slips[-14:].tolist()] == pytest.approx(
        known[-14:], rel=2e-3
    )


def test_a_branch_whose_end_does_not_converge_says_that_it_was_not_looked_at(monkeypatch):
    """It is no end of the range that another setting would raise."""
    at = Motions.find

    def settled(self, slips, starts=None):
        return [
            [attrs.evolve(one, converged=one.slip < 0.3) for one in each]
            for each in at(self, slips, starts)
        ]

    monkeypatch.setattr(Motions, "find", settled)
    one = balance()
    branch = one.loading_branch()
    assert 0.2 < branch.end < 0.3
    assert branch.refusal == "the search for the motion of the rollers does not converge"
    assert skidding_onset(one, RANGE, "KEY").status.endswith(f"; beyond, {branch.refusal}")
    assert "KEY" not in skidding_onset(one, RANGE, "KEY").status


def test_a_branch_that_ends_before_a_law_has_no_value_states_both():
    def torque(logit):
        if logit > 2.0:
            raise DomainError("the law has no value")
        return 1.0 + logit

    motions = Torques(torque, converges_to=0.5)
    branch = find_loading_branch(motions, 0.9, motions)
    assert branch.end < 0.5
    assert branch.refusal.startswith("the search for the motion of the rollers does not converge")
    assert branch.refusal.endswith("the law has no value")


# A plain march -------------------------------------------------------------------------------------------------------


def marched(one, slip, start):
    """What one roller comes to by implicit Euler: each balance by steps of 1/400 of the bracket and Brent's method."""
    motions = one.motions
    kernel = motions.spins(np.array([slip])).kernel
    K = motions.positions
    c = motions._inertia_torque * (1.0 - slip)
    (low, high) = motions._rolling_slips(np.array([slip]))[0]
    at = start
    orbit = np.empty(K)
    step = (high - low) / 400.0

    def left(x, before, p):
        slips = np.full(K, before)
        slips[p] = x
        return c * (x - before) + kernel.torques(slips)[0][p]

    for _ in range(12):
        begin = at
        for p in [*range(1, K), 0]:
            before = at
            rest = left(at, before, p)
            if rest != 0.0:
                sense = -math.copysign(1.0, rest)
                while left(at + sense * step, before, p) * rest > 0.0:
                    at += sense * step
                at = brentq(
                    left, *sorted((at, at + sense * step)), args=(before, p), xtol=1e-15, rtol=1e-13
                )
            orbit[p] = at
        if abs(at - begin) < 1e-3 * step:
            break
    return orbit


@pytest.mark.parametrize("drags", [["petroff-land"], ["rolling-resistance", "hysteresis"]])
@pytest.mark.parametrize("slip", [0.02, 0.6])
def test_rollers_are_sent_round_as_by_a_plain_march(drags, slip):
    one = balance("1032930-30C", slices=1, **{"cage.drag": drags, "operation.radial_load": "20 kN"})
    motions = one.motions
    slips = np.array([slip])
    ends = motions._march_starts(motions.spins(slips), slips)
    march = motions._march(slips, ends, motions.spins(slips))
    for walker in range(2):
        want = marched(one, slip, ends[0, walker])
        np.testing.assert_allclose(
            march.roller_slips[0, walker], want, atol=2e-3 * float(motions.slip_scale(slips)[0])
        )
    assert march.orbit_changes.max() < 1e-3, "of rolling on either ring, which are 1.8 units apart"


def test_a_march_ends_at_the_tolerance_by_which_it_counts_as_periodic(monkeypatch):
    """The kernel is given that one number: a march that may leave a tenth takes fewer evaluations, and leaves more."""
    motions = balance().motions
    slips = np.array([0.02])
    starts = motions._march_starts(motions.spins(slips), slips)[:, :1].repeat(2, axis=1)
    found = []
    for tolerance in (0.1, 1e-3):
        monkeypatch.setattr(spins, "_PERIODIC_TOLERANCE", tolerance)
        own = motions.spins(slips, motions._march_loads)
        change = motions._march(slips, starts, own).orbit_changes.max()
        found.append((sum(own.kernel.evaluated), change))
    (few, large), (many, small) = found
    assert few < 0.8 * many
    assert small < 0.5 * large < 0.05


def test_loads_of_a_march_start_newtons_method_with_less_work_and_change_no_torque(monkeypatch):
    """With two loads the limit drag torque changes by 8e-5, with eight a branch evaluates as many contacts."""
    found = []
    for loads in (spins._MARCH_LOADS, None):  # None for all of the search
        monkeypatch.setattr(spins, "_MARCH_LOADS", loads)
        balance = scenes.balance(scenes.free(20))
        (jump,) = balance.loading_branch().jumps
        found.append((balance.assembly.inner.chain.kernel.evaluated, jump.drag))
    assert found[0][0] < 0.8 * found[1][0]
    assert found[0][1] == pytest.approx(found[1][1], rel=1e-9)


def test_rows_are_sent_round_as_each_by_itself():
    motions = balance().motions
    slips = np.array([0.01, 0.3, 0.7])
    together = motions.find(slips)
    for slip, here in zip(slips, together, strict=True):
        alone = motions.find(np.array([slip]))[0]
        assert [one.torque for one in alone] == pytest.approx(
            [one.torque for one in here], rel=1e-9
        )


def test_rollers_that_have_no_room_in_a_table_are_evaluated_in_parts_to_the_last_bit(monkeypatch):
    """Where all load is at one position, and a table has room for that of one roller alone; and none with less."""
    one = scenes.balance(scenes.catalogue(4), positions=1)
    slips = np.array([0.01, 0.3])

    def found():
        motions = one.motions.with_resolution(1, 0)
        return motions.spins(slips), [
            (motion.torque, *motion.normalised_slip)
            for here in motions.find(slips)
            for motion in here
        ]

    _, whole = found()
    monkeypatch.setattr(raceway, "_BLOCK", 0)
    spins, in_parts = found()
    assert in_parts == whole
    rings = [(stage, Slices(int(np.diff(rest[3]).max()), table.conditions), *rest)
             for *_, (stage, table, *rest) in spins._gathered]  # fmt: skip
    parts = 2 * one.motions.positions, rings, (0.03, 0.04, 0.005, 0.035), 1.0
    assert len(Kernel(*parts).torques(np.zeros(parts[0]))[0]) == parts[0]
    rings[0] = (rings[0][0], Slices(len(rings[0][1]) - 1), *rings[0][2:])
    with pytest.raises(ValueError, match="by no more than the table"):
        Kernel(*parts)


def turned_by(scene, ring, sense):
    """The bearing with one ring that turns, at the speed of the scene."""
    speed = sense * scene.operation.inner_speed
    speeds = {f"operation.{name}_speed": 0.0 for name in ("inner", "outer")}
    return evolve(scene, speeds | {f"operation.{ring}_speed": speed}, si=True)


@pytest.mark.parametrize("sense", [1, -1])
def test_a_march_of_first_order_states_its_error_whichever_ring_turns(monkeypatch, sense):
    """It replaces Newton's method, as if that had found another motion, and a march of second order of one orbit."""
    monkeypatch.setattr(spins, "CONTINUES", -1.0)
    monkeypatch.setattr(spins, "_SECOND_ORDER_ORBITS", 1)
    errors = []
    for ring in ("inner", "outer"):
        motions = scenes.balance(turned_by(scenes.free(20), ring, sense)).motions
        assert motions.sense == (1.0 if ring == "inner" else -1.0)
        errors.append([here[0].error for here in motions.find(np.array([0.01, 0.1]), np.zeros(2))])
    inner, outer = errors
    assert min(outer) > 1e-3
    assert outer == pytest.approx(inner, rel=0.5)


def test_a_march_of_second_order_to_an_unstable_motion_does_not_count(monkeypatch):
    motions = scenes.balance(scenes.free(20)).motions
    slips = np.array([0.1])
    monkeypatch.setattr(spins, "CONTINUES", -1.0)
    assert motions.find(slips, np.zeros(1))[0][0].converged

    def unstable(self, spins, rows, *_):
        return np.ones(rows.size), np.full(rows.size, 1.5)

    monkeypatch.setattr(Motions, "_mean_torques", unstable)
    assert not motions.find(slips, np.zeros(1))[0][0].converged


# Of any bearing ------------------------------------------------------------------------------------------------------


@given(
    number=st.integers(0, 300),
    resists=st.booleans(),
    part=st.floats(0.0, 1.0),
    slip=st.floats(1e-3, 0.9),
)
@settings(max_examples=8, deadline=None)
def test_all_motions_lie_between_those_that_both_ends_lead_to(number, resists, part, slip):
    one = scenes.balance(scenes.catalogue(number, resists=resists))
    motions = one.motions
    slips = np.array([slip])
    found = motions.find(slips)[0]
    high = found[0].normalised_slip
    low = found[-1].normalised_slip
    low_end, high_end = (
        motions._march_starts(motions.spins(slips), slips)[0] / motions.slip_scale(slips)[0]
    )
    between = motions.find(slips, np.array([low_end + part * (high_end - low_end)]))[0][0]
    nearest = min(motions.distance(between.normalised_slip, one) for one in (high, low))
    if len(found) == 1:
        assert nearest < 0.02
    ends = np.minimum(low, high) - 0.1, np.maximum(low, high) + 0.1
    assert np.mean((between.normalised_slip > ends[0]) & (between.normalised_slip < ends[1])) > 0.9


@pytest.mark.slow
@given(number=st.integers(0, 10_000), order=st.permutations([0.003, 0.02, 0.15, 0.4, 0.7, 0.9]))
@settings(max_examples=6, deadline=None)
def test_the_order_of_questions_changes_no_bit(number, order):
    requested, untouched = (scenes.balance(scenes.free(number)) for _ in range(2))
    for slip in order:
        requested.torque(slip)
    branches = [one.loading_branch() for one in (requested, untouched)]
    assert [m.torque for m in branches[0].motions] == [m.torque for m in branches[1].motions]
    assert [attrs.astuple(jump)[1:2] for jump in branches[0].jumps] == [
        attrs.astuple(jump)[1:2] for jump in branches[1].jumps
    ]
    assert [requested.torque(slip) for slip in sorted(order)] == [
        untouched.torque(slip) for slip in sorted(order)
    ]


@given(number=st.integers(0, 10_000))
@settings(max_examples=6, deadline=None)
def test_more_than_the_drag_of_running_away_is_carried_by_no_slip_near(number):
    one = scenes.balance(scenes.free(number))
    branch = one.loading_branch()
    for jump in branch.jumps:
        known = max(jump.error, 1e-3)
        less, more = (
            branch.find_steady_motions(lambda _, drag=part * jump.drag: -drag)
            for part in (1.0 - 5.0 * known, 1.0 + 5.0 * known)
        )
        assert any(steady.slip < jump.slip and steady.slope > 0.0 for steady in less)
        beyond = jump.slip_after if jump.slip_after == jump.slip_after else RANGE
        assert not [
            steady for steady in more if steady.slip < 0.5 * (jump.slips_within(1e-3)[1] + beyond)
        ]


@pytest.mark.parametrize("fraction", [1e-3, 1e-2, 5e-2])
@pytest.mark.parametrize(
    ("kind", "number"), [("free", 20), ("free", 5), ("catalogue", 19), ("catalogue", 17)]
)
def test_slips_around_a_maximum_carry_all_but_a_share_of_it(kind, number, fraction):
    branch = balance_of(kind, number).loading_branch()
    assert branch.jumps
    for jump in branch.jumps:
        fraction = max(fraction, jump.error)
        low, high = jump.slips_within(fraction)
        below, above = (
            1.0 - motion.torque / jump.drag for motion in branch.interpolate([low, high])
        )
        assert abs(below - fraction) <= 0.2 * fraction + jump.error
        assert above <= 1.2 * fraction + jump.error  # less where the branch has a gap
        assert not high > jump.slip_after
        inner = [
            1.0 - motion.torque / jump.drag for motion in branch.motions if low < motion.slip < high
        ]
        assert max(inner, default=0.0) <= fraction + jump.error


def test_slips_around_a_parabola_go_with_its_place():
    places = np.linspace(-3.0, 1.0, 81)
    branch = [
        Motion(slip_from_logit(x), 2.0 - 2.0 * (x + 1.2) ** 2, np.zeros(1), 0.0, True)
        for x in places
    ]
    k = int(np.argmax([motion.torque for motion in branch]))
    found = [
        logit_slip(slip) for slip in _slips_within(branch, k, _Maximum(-1.2, 2.0, 0.0), -1.1, 0.01)
    ]
    assert found == pytest.approx([-1.2, -1.0], abs=1e-9)


@pytest.mark.parametrize(
    ("kind", "number"), [("free", 20), ("free", 5), ("catalogue", 17), ("catalogue", 19)]
)
def test_the_error_told_of_a_jump_holds_against_four_times_the_positions_and_tells_something(
    kind, number
):
    one = balance_of(kind, number)
    jumps = one.loading_branch().jumps
    dense = scenes.finer(one, 4).loading_branch().jumps
    assert len(jumps) == len(dense), "what positions alone bend down is no jump"
    for jump, finer in zip(jumps, dense, strict=True):
        assert jump.drag == pytest.approx(finer.drag, rel=jump.error + finer.error + 1e-6)
        assert jump.error < 0.03


@pytest.mark.parametrize("number", [10548, 10695, 10873])
def test_a_maximum_up_to_the_end_of_the_range_that_finer_positions_do_not_have_is_none(number):
    """Few positions alone let the torque fall by 3 to 7 % at the last slip, or at the one where it is least."""
    one = scenes.balance(scenes.catalogue(number))
    assert not scenes.finer(one, 4).loading_branch().jumps, "or the scene shows nothing"
    branch = one.loading_branch()
    assert branch.skidding_jump is None
    assert branch.maximum_error < 0.05


@pytest.mark.parametrize(
    ("kind", "number"), [("free", 1), ("free", 7), ("catalogue", 3), ("catalogue", 12)]
)
def test_the_error_told_of_the_most_that_is_carried_holds_against_four_times_the_positions(
    kind, number
):
    one = balance_of(kind, number)
    branch = one.loading_branch()
    dense = scenes.finer(one, 4).loading_branch()
    assert branch.maximum[1] == pytest.approx(dense.maximum[1], rel=branch.maximum_error + 1e-6)
    assert branch.maximum_error < 0.03


@given(number=st.integers(0, 10_000))
@settings(max_examples=3, deadline=None)
def test_a_bearing_that_turns_the_other_way_has_the_same_branch(number):
    scene = scenes.free(number)
    mirrored = evolve(scene, {"operation.inner_speed": -scene.operation.inner_speed}, si=True)
    try:
        branches = [scenes.balance(one).loading_branch() for one in (scene, mirrored)]
    except (
        DomainError
    ):  # a law has no value at any slip, such as a film of a lubricant outside its range
        reject()
    assert [m.torque for m in branches[0].motions] == pytest.approx(
        [m.torque for m in branches[1].motions], rel=1e-9
    )


@given(number=st.integers(0, 10_000), resists=st.sampled_from([None, True, False]))
@settings(max_examples=3, deadline=None)
def test_finer_slips_change_nothing_beyond_the_error_that_is_told(number, resists):
    one = scenes.balance(
        scenes.free(number) if resists is None else scenes.catalogue(number, resists=resists)
    )
    branch = one.loading_branch()
    dense = scenes.dense_branch(one)
    away, finer = (scenes.doubling_jump(found) for found in (branch, dense))
    assert (away is None) == (finer is None)
    if away is not None:
        known = away.error + finer.error + 1e-6  # exactness of a vertex
        assert away.drag == pytest.approx(finer.drag, rel=known)
    known = branch.maximum_error + dense.maximum_error + 1e-6
    assert branch.maximum[1] == pytest.approx(dense.maximum[1], rel=known)


@given(number=st.integers(0, 10_000))
@settings(max_examples=3, deadline=None)
def test_units_in_which_a_bearing_is_given_change_nothing(number):
    scene = scenes.free(number)
    o = scene.operation
    b = scene.bearing
    written = evolve(
        scene,
        {
            "operation.inner_speed": f"{o.inner_speed / math.tau!r} Hz",
            "operation.radial_load": f"{o.radial_load / 1e3!r} kN",
            "operation.temperature": f"{o.temperature - 273.15!r} degC",
            "bearing.roller_diameter": f"{b.roller_diameter / 25.4e-3!r} in",
            "bearing.roller_length": f"{b.roller_length * 1e3!r} mm",
            "bearing.radial_clearance": f"{b.radial_clearance * 1e9!r} nm",
        },
    )
    branches = [scenes.balance(one).loading_branch() for one in (scene, written)]
    assert [m.torque for m in branches[0].motions] == pytest.approx(
        [m.torque for m in branches[1].motions], rel=1e-7
    )
    assert [jump.drag for jump in branches[0].jumps] == pytest.approx(
        [jump.drag for jump in branches[1].jumps], rel=1e-7
    )


@pytest.mark.parametrize("number", [10040, 10110])
def test_whether_a_slip_doubles_is_told_as_by_many_slips(number):
    """It is 2.01 times as large in both; straight lines between the slips of the search told 1.97 and 1.99."""
    one = scenes.balance(scenes.free(number))
    away = scenes.doubling_jump(one.loading_branch(0.95))
    dense = scenes.doubling_jump(scenes.dense_branch(one))
    assert away is not None
    assert away.drag == pytest.approx(dense.drag, rel=away.error + dense.error + 1e-6)
    assert away.slip_after == pytest.approx(dense.slip_after, rel=1e-2)


@pytest.mark.parametrize(
    ("slip", "slip_after", "is_skidding"),
    [
        (0.05, 0.09, False),
        (0.05, 0.11, False),
        (0.05, 0.19, False),
        (0.15, 0.21, True),
        (0.15, math.nan, True),
        (0.3, 0.4, False),
        (0.3, 0.7, True),
    ],
)
def test_a_cage_skids_from_a_jump_on_that_leads_to_skidding_slips(slip, slip_after, is_skidding):
    """Where a jump leads decides, so that twice the slip before it is no edge."""
    jump = Jump(slip, 1.0, slip_after, 0.0, lambda fraction: [slip, slip])
    assert jump.is_skidding == is_skidding


@pytest.mark.parametrize("number", range(6))
def test_a_default_bearing_has_a_steady_slip_and_a_largest_drag_or_a_reserve(number):
    one = scenes.balance(scenes.catalogue(number))
    branch = one.loading_branch()
    steady = branch.find_steady_motions(one.drag)
    slip, most = branch.maximum
    assert (steady and steady[0].slope > 0.0) or most < -one.drag(slip)
    assert branch.skidding_jump is not None or slip == branch.end


@pytest.mark.parametrize("speed", ["0.5 rpm", "15000 rpm"])
@pytest.mark.parametrize("load", ["0 N", "200 N", "5 kN"])
@pytest.mark.parametrize("inertia", [True, False])
def test_slow_and_fast_bearings_of_any_load_have_a_branch(speed, load, inertia):
    changes = {
        "operation.inner_speed": speed,
        "operation.radial_load": load,
        "bearing.radial_clearance": "-2 um",
    }
    branch = balance(inertia=inertia, slices=1, **changes).loading_branch()
    assert branch.end == RANGE
    assert all(motion.converged for motion in branch.motions)


@pytest.mark.parametrize("number", [76, 299, 704])
def test_rollers_without_load_at_a_few_rpm_carry_next_to_nothing_or_it_is_not_known(number):
    """Of dry contacts: oil films reach across the clearance of 76, so that its rollers are pressed without load."""
    one = scenes.balance(evolve(scenes.wide(number), {"models.approach": "dry"}))
    away = skidding_onset(one, RANGE, "")
    runs = running(one, RANGE)
    assert (
        away.max_torque < 1e-15
        or "the search for the motion of the rollers did not converge at any cage slip"
        in away.status
    )
    assert math.isnan(runs.slip)


def test_pocket_friction_and_effective_friction_have_a_branch_and_both_rings_may_turn():
    plain = balance().loading_branch()
    pockets = balance(
        slices=1,
        **{"cage.drag": ["petroff-land", {"model": "pocket-friction", "coefficient": 0.1}]},
    ).loading_branch()
    simple = balance(effective=True).loading_branch()
    assert pockets.torque_without_slip <= 0.0
    assert simple.skidding_jump.drag == pytest.approx(plain.skidding_jump.drag, rel=0.1)
    driven = balance(slices=1, **{"operation.outer_speed": "-500 rpm"}).loading_branch()
    assert driven.end == RANGE


def curve(*torques, gaps=()):
    """Motions at places one apart; before some of them there is a gap."""
    return [
        Motion(
            slip_from_logit(float(k)), torque, np.zeros(1), 1.0, True, is_continuous=k not in gaps
        )
        for k, torque in enumerate(torques)
    ]


class Torques:
    """Motions of a bearing whose torque is a function of logit(S).

    None continues across the ``end`` of one, and they converge up to the slip ``converges_to``.
    """

    resists = False
    n_positions = 1
    find_from = Motions.find_from

    def __init__(self, torque, *, end=math.inf, fine=None, converges_to=1.0):
        self.torque = torque
        self.converges_to = converges_to
        self.end = end
        self.fine = fine or self
        self.count = 0

    def at_slip(self, slip):
        return self.torque(logit_slip(slip))

    def find(self, slips, starts=None):
        self.count += slips.size
        torques = [self.at_slip(slip) for slip in slips.tolist()]
        return [
            [Motion(slip, torque, np.zeros(1), 1.0, slip < self.converges_to)]
            for slip, torque in zip(slips.tolist(), torques, strict=True)
        ]

    def mark_continuity(self, below, motion):
        is_continuous = (below.logit_slip <= self.end) == (motion.logit_slip <= self.end)
        return attrs.evolve(motion, is_continuous=is_continuous)

    def distance(self, first, second):
        return 0.0

    def with_resolution(self, n_positions, n_loads):
        self.resolution = n_positions, n_loads
        return self.fine


def test_the_slope_of_a_steady_slip_balances_truncation_and_rounding():
    """Of S^3 with a rounding of 2e-12 in the worst sense; half and twice the step have errors of 1.4e-8 and 1.7e-8."""

    def torque(logit):
        slip = slip_from_logit(logit)
        return slip**3 * (1.0 + math.copysign(2e-12, slip - 0.3))

    motions = Torques(torque)
    (steady,) = find_loading_branch(motions, 0.9, motions).find_steady_motions(lambda _: -0.027)
    assert steady.slope == pytest.approx(3.0 * 0.3**2, rel=1.2e-8)


def test_the_slip_after_a_jump_is_found_to_a_thousandth_of_its_logit():
    """Where the torque rises in a step; with twice the tolerance it errs by 1.5e-3."""

    def torque(logit):
        return 2.0 + 0.01 * logit if logit > 1.0337 else math.exp(-((logit + 2.0) ** 2))

    motions = Torques(torque)
    jump, *_ = find_loading_branch(motions, 0.9, motions).jumps
    assert jump.drag == pytest.approx(1.0, rel=1e-6)
    assert logit_slip(jump.slip_after) == pytest.approx(1.0337, abs=1e-3)
    assert jump.slips_within(0.99999)[1] < jump.slip_after


def test_the_end_of_a_motion_is_found_on_finer_positions_by_two_passes():
    """There it is 0.018 beyond that of coarse ones: between two samples of the first pass, which are 0.025 apart."""

    def rising_to(end):
        return lambda logit: 2.0 + logit - end if logit <= end else 0.5 - 0.1 * logit

    fine = Torques(rising_to(-1.0 + 0.018))
    motions = Torques(rising_to(-1.0), end=-1.0, fine=fine)
    (jump,) = find_loading_branch(motions, 0.9, motions).jumps
    assert logit_slip(jump.slip) == pytest.approx(-1.0 + 0.018, abs=0.025 / 4.0 + SEARCH.gap_width)
    assert jump.drag == pytest.approx(2.0, rel=jump.error)
    assert jump.error < 0.02
    assert fine.count <= 2 * SEARCH.n_samples + 2


def test_a_maximum_that_finer_positions_have_far_beyond_is_followed():
    """By samples each twice as far: 0.7 in logit(S), of which half as many extensions reach 0.1."""

    def hill(top):
        return lambda logit: math.exp(-((logit - top) ** 2))

    motions = Torques(hill(-2.0), fine=Torques(hill(-1.3)))
    (jump,) = find_loading_branch(motions, 0.9, motions).jumps
    assert logit_slip(jump.slip) == pytest.approx(-1.3, abs=0.02)
    assert jump.drag == pytest.approx(1.0, rel=1e-3)


def test_a_maximum_where_no_torque_drives_on_finer_positions_has_an_unknown_error():
    motions = Torques(
        lambda logit: math.exp(-((logit + 2.0) ** 2)),
        fine=Torques(lambda logit: -((logit + 2.05) ** 2)),
    )
    (jump,) = find_loading_branch(motions, 0.9, motions).jumps
    assert jump.drag == pytest.approx(1.0, rel=1e-3)
    assert jump.error == math.inf


@pytest.mark.parametrize("extensions", [1, 3])
def test_samples_on_finer_positions_are_extended_as_often_as_is_allowed(extensions, monkeypatch):
    monkeypatch.setattr(loading_branch, "SEARCH", attrs.evolve(SEARCH, max_extensions=extensions))
    motions = Torques(lambda logit: 10.0 + logit)
    (start,) = motions.find(np.array([0.01]))[0]
    count = motions.count
    _Search(motions, motions)._find_fine_vertex(start, start.logit_slip, 0.1, end=math.inf)
    assert motions.count - count == 3 + extensions


class TwoMotions(Torques):
    """Motions from both rings at one slip, where a march from a start reaches another one, converged or not."""

    def __init__(self, is_converged, reached=1.0):
        super().__init__(lambda logit: 1.0)
        self.is_converged = is_converged
        self.reached = reached

    def find(self, slips, starts=None):
        found = super().find(slips)
        for here in found[-1:]:
            other = attrs.evolve(here[0], normalised_slip=np.full(1, 0.5))
            here.append(other)
            if starts is not None:
                here[:] = [
                    attrs.evolve(
                        other,
                        normalised_slip=np.full(1, self.reached),
                        converged=self.is_converged,
                    )
                ]
        return found

    def distance(self, first, second):
        return abs(first[0] - second[0])


@pytest.mark.parametrize("is_converged", [False, True])
def test_a_march_replaces_the_nearest_motion_only_if_it_converges(is_converged):
    motions = TwoMotions(is_converged)
    branch = _Search(motions, motions).follow([0.1, 0.2])
    assert branch[1].normalised_slip == (1.0 if is_converged else 0.0)
    assert branch[1].converged


@pytest.mark.parametrize(("distance", "is_other"), [(0.014, False), (0.028, True)])
def test_a_march_to_within_a_fiftieth_of_the_distance_of_both_rings_is_the_same_motion(
    distance, is_other
):
    motions = TwoMotions(is_converged=True, reached=distance)
    branch = _Search(motions, motions).follow([0.1, 0.2])
    assert branch[1].normalised_slip == (distance if is_other else 0.0)


@pytest.mark.parametrize(("distance", "is_continuous"), [(0.1, True), (0.2, False)])
def test_a_motion_continues_where_slips_change_fast_and_not_from_ring_to_ring(
    distance, is_continuous
):
    """A tenth of the distance of rolling on both rings is fast; a fifth of the load on the other ring is a gap."""
    below, motion = curve(1.0, 1.0)
    motions = SimpleNamespace(distance=lambda *_: distance)
    assert Motions.mark_continuity(motions, below, motion).is_continuous == is_continuous


@pytest.mark.parametrize(("error", "converged"), [(0.007, True), (0.014, False)])
def test_a_motion_of_first_order_counts_up_to_an_error_of_a_hundredth(
    error, converged, monkeypatch
):
    """Where it replaces Newton's method, as if that had found another motion."""
    monkeypatch.setattr(spins, "CONTINUES", -1.0)
    monkeypatch.setattr(
        Motions,
        "_march_second_order",
        lambda _, spins, slips, rows, marched, *__: (marched, 0.0, 1.0, error),
    )
    ((motion,),) = scenes.balance(scenes.free(20)).motions.find(np.array([0.1]), np.zeros(1))
    assert (motion.error, motion.converged) == (error, converged)


@pytest.mark.parametrize(("fall", "is_jump"), [(0.015, False), (0.03, True)])
def test_a_fall_of_a_hundredth_that_finer_positions_do_not_have_is_no_jump(fall, is_jump):
    """Finer positions check falls up to 2 %, within which coarse ones may differ from them."""

    def flattening(logit):
        return 1.0 + 0.005 * min(logit, -0.6) - 1e-4 * max(logit + 0.6, 0.0)

    def falling(logit):
        return flattening(logit) + 0.005 * max(logit, 0.0) - fall * math.exp(-((logit / 0.2) ** 2))

    motions = Torques(falling, fine=Torques(flattening))
    assert bool(find_loading_branch(motions, 0.9, motions).jumps) == is_jump


def beyond_the_end_of_an_interval(deviation):
    """A steady slip that few loads find just below a slip of the branch, by a torque that deviates from that of all."""
    full = Torques(lambda logit: slip_from_logit(logit) * (1.0 - deviation))
    branch = find_loading_branch(Torques(slip_from_logit), 0.9, full)
    end = branch.motions[20].slip
    drag = end * (1.0 - deviation / 3.0)
    (steady,) = branch.find_steady_motions(lambda _: -drag)
    return steady.slip / end, drag / (1.0 - deviation) / end


def test_a_steady_slip_beyond_an_interval_is_found_unless_the_torques_there_balance_to_a_millionth():
    """With twice the tolerance the imbalance of 1.5e-6 at the end would be accepted."""
    slip, balanced = beyond_the_end_of_an_interval(2.25e-6)
    assert slip == pytest.approx(balanced, abs=1e-9)


@pytest.mark.parametrize(("deviation", "is_found"), [(0.2, True), (0.375, False)])
def test_a_steady_slip_is_looked_for_up_to_a_quarter_beyond_an_interval(deviation, is_found):
    """It is 1.17 or 1.4 times the slip at the end."""
    slip, balanced = beyond_the_end_of_an_interval(deviation)
    assert slip == pytest.approx(balanced if is_found else 1.0, abs=1e-6)


def test_a_driven_cage_is_found_by_doubling_its_slip_from_a_small_one():
    """From 1e-5 on to 0.64 there are 17 slips, and then the root; from half of that there is one more."""
    motions = Torques(slip_from_logit)
    branch = find_loading_branch(motions, 0.9, motions)
    motions.at_slip = lambda slip: slip
    count = motions.count
    (steady,) = branch.find_steady_motions(lambda _: 0.6)
    assert steady.slip == pytest.approx(-0.6, rel=1e-9)
    assert motions.count - count == 17 + 1


def test_a_slip_of_twice_a_likely_one_is_found_without_a_search_of_five_times_that():
    motions = Torques(slip_from_logit)
    searched = SimpleNamespace(
        loading_branch=lambda end: find_loading_branch(motions, end, motions), drag=lambda _: -0.02
    )
    branch, (steady,) = TorqueBalance.steady_motions(searched, RANGE, 0.01)
    assert steady.slip == pytest.approx(0.02)
    assert branch.end < 5.0 * 0.01


def test_a_steady_slip_is_found_to_ten_digits():
    """Where the torque has a step; with twice the tolerance it errs by 1.6e-10."""

    def torque(logit):
        slip = slip_from_logit(logit)
        return slip + (slip > 0.31696)

    motions = Torques(torque)
    (steady,) = find_loading_branch(motions, 0.9, motions).find_steady_motions(lambda _: -0.81696)
    assert steady.slip == pytest.approx(0.31696, rel=1e-10)


def test_the_height_of_a_maximum_is_predicted_to_a_millionth():
    """Its second derivative is infinite, so that vertices approach it slowly; twice the tolerance leaves 1.9e-6."""

    def torque(logit):
        x = logit + 2.129
        return (
            1.0 - abs(x) ** 1.5 * (1.4 if x > 0.0 else 1.0) if abs(x) < 0.8 else 0.5 - 0.01 * abs(x)
        )

    motions = Torques(torque)
    (jump,) = find_loading_branch(motions, 0.9, motions).jumps
    assert jump.error < 1e-6


def test_the_gap_at_the_end_of_a_motion_is_bisected_nine_times():
    motions = Torques(lambda logit: 2.0 + logit if logit <= -1.0 else 0.5 - 0.1 * logit, end=-1.0)
    branch = find_loading_branch(motions, 0.9, motions).motions
    (k,) = (k for k in range(1, len(branch)) if not branch[k].is_continuous)
    assert branch[k].logit_slip - branch[k - 1].logit_slip <= 0.25 / 2.0**9


def test_finer_positions_may_shift_the_end_of_a_motion_by_a_tenth():
    """By 0.08 in logit(S), of which half of the width shows no end."""

    def rising_to(end):
        return lambda logit: 2.0 + logit - end if logit <= end else 0.5 - 0.1 * logit

    motions = Torques(rising_to(-1.0), end=-1.0, fine=Torques(rising_to(-0.92)))
    (jump,) = find_loading_branch(motions, 0.9, motions).jumps
    assert jump.error < 0.02


def test_eight_loads_stand_for_all_slices(monkeypatch):
    """To rounding; with four the limit drag torque of this bearing changes by 5e-6."""
    (jump,) = scenes.balance(scenes.free(20)).loading_branch().jumps
    monkeypatch.setattr(loading_branch, "SEARCH", attrs.evolve(SEARCH, n_loads=0))
    (whole,) = scenes.balance(scenes.free(20)).loading_branch().jumps
    assert jump.drag == pytest.approx(whole.drag, rel=1e-9)


def test_a_branch_starts_at_a_ten_thousandth_by_steps_of_a_quarter():
    motions = Torques(slip_from_logit)
    branch = find_loading_branch(motions, 0.5, motions).motions
    logits = [motion.logit_slip for motion in branch]
    assert branch[0].slip == pytest.approx(1e-4, rel=1e-9)
    assert 0.24 < np.diff(logits)[:-1].max() <= 0.25


@pytest.mark.parametrize(("fall", "intervals"), [(1.4e-3, []), (3e-3, [0, 1])])
def test_intervals_that_may_exceed_a_maximum_by_a_thousandth_are_bisected(fall, intervals):
    """By twice the parabola through it, whose height over the middle of an interval is an eighth of 2 fall."""
    branch = curve(1.0 - fall, 1.0, 1.0 - fall)
    assert _find_intervals(branch, 0.0) == intervals


@pytest.mark.parametrize(("width", "intervals"), [(1.5e-3, []), (3e-3, [0])])
def test_a_gap_is_bisected_down_to_where_the_torque_behind_it_may_exceed_by_a_thousandth(
    width, intervals
):
    """At half the rate of its excess per step: by 0.75 and 1.5 thousandths."""
    before, behind = (
        Motion(slip_from_logit(x), torque, np.zeros(1), 1.0, True, is_continuous=False)
        for x, torque in ((0.0, 0.0), (width, 1.0))
    )
    assert _find_intervals([before, behind], 0.0) == intervals


def test_a_maximum_has_nine_samples_on_four_times_the_positions():
    """A cusp, which no polynomial predicts."""
    motions = Torques(lambda logit: 1.0 - abs(logit + 0.3) ** 0.5)
    search = _Search(motions, motions)
    samples = [
        pair[0] for pair in motions.find(np.array([slip_from_logit(x) for x in (-1.0, -0.4, 1.0)]))
    ]
    search._find_vertex(search._fine_motions, samples)
    assert motions.count == 9
    assert motions.resolution == (4, 8)


@pytest.mark.slow
def test_a_steady_slip_beside_which_few_loads_of_a_roller_find_it_is_a_balance_on_all_slices():
    """By few loads the excess passes zero just above 4.70 %, a slip of the branch, and by all slices below it."""
    bearing = assemble(scenes.wide(100_600))
    bearing = bearing.at(attrs.evolve(bearing.resolution, slices=313, quadrature="gauss"))
    balance = torque_balance(bearing.at_load(1074.0), 21)
    branch = balance.loading_branch()
    slip, torque = next(pair for pair in zip(*branch.torque_curve, strict=True) if pair[0] > 0.046)
    assert torque + balance.drag(slip) < 0.0 < balance.excess(slip), "or the load shows nothing"
    steady = branch.find_steady_motions(balance.drag)[0]
    assert steady.motion.torque == pytest.approx(steady.torque, rel=1e-6)
    below, above = (balance.excess(part * steady.slip) for part in (1.0 - 1e-6, 1.0 + 1e-6))
    assert below < 0.0 < above


def test_maxima_of_a_branch_fall_behind_by_more_than_rounding_before_a_larger_one_comes():
    assert _find_maxima(curve(1.0, 3.0, 2.0, 4.0, 1.0)) == [1, 3]
    for fall, maxima in ((1.5e-3, []), (2.5e-3, [1])):
        assert _find_maxima(curve(1.0, 3.0, 3.0 * (1.0 - fall), 4.0)) == maxima
    assert _find_maxima(curve(-1.0, -3.0)) == []


def test_the_bend_of_a_parabola_is_its_second_derivative_and_none_is_told_at_a_gap():
    assert _second_derivative(curve(0.0, 3.0, 4.0), 1) == pytest.approx(2.0)
    assert (
        _second_derivative(curve(0.0, 3.0, 4.0, gaps=(2,)), 1)
        == _second_derivative(curve(0.0, 3.0, 4.0), 0)
        == 0.0
    )


def test_what_a_maximum_may_be_over_the_largest_value_is_by_the_slopes_beside_it():
    # 1 and 2 at both sides of it, one apart: by the slope of the left side on the right one 1, the other way 2, of 4
    assert _estimate_excess_over_samples([0.0, 1.0, 2.0], [3.0, 4.0, 2.0]) == pytest.approx(0.5)
    assert _estimate_excess_over_samples([0.0, 1.0, 2.0], [1.0, 2.0, 4.0]) == pytest.approx(
        1.0
    )  # still rises by 2: as far again, 2 * 2


def test_a_motion_stays_that_goes_on_either_way_and_a_single_one_between_gaps_does_not():
    branch = curve(
        1.0, 2.0, 3.0, 4.0, gaps=(1, 2)
    )  # the second by itself, the third begins one that goes on
    assert [one.torque for one in _drop_doubtful(branch)] == [1.0, 3.0, 4.0]


def test_a_place_is_that_of_its_slip():
    for slip in (1e-4, 0.3, 0.95):
        assert slip_from_logit(logit_slip(slip)) == pytest.approx(slip, rel=1e-14)


def test_a_study_says_that_without_load_nothing_drives_the_cage():
    with pytest.raises(SceneError, match="no roller is loaded on the inner ring with 0 N"):
        run(scenes.wide(299), "steady-slip")


# In time -------------------------------------------------------------------------------------------------------------

IN_TIME = [row for row in rows_of(REFERENCES / "loading_branch_in_time.csv") if row["agrees"]]


@pytest.fixture
def in_time(monkeypatch):
    """tools/references/loading_branch_in_time.py: cage and rollers against a drag that is raised."""
    monkeypatch.syspath_prepend(REFERENCES)
    return __import__("loading_branch_in_time")


@pytest.mark.soak
@pytest.mark.parametrize("row", IN_TIME, ids=[f"{row['kind']} {row['number']}" for row in IN_TIME])
def test_a_cage_runs_away_at_the_drag_at_which_it_does_in_time_or_at_none_if_it_does_not(
    row, in_time
):
    branch = in_time.of(row["kind"], int(row["number"]), row["resists"]).loading_branch()
    away = scenes.doubling_jump(branch)
    if not row["interval"]:
        assert away is None
        return
    known = in_time.ABOVE + away.error
    low = (1.0 - known) * float(row["held [N m]"])
    high = (1.0 + known) * float(row["runs away [N m]"])
    assert (low <= away.drag <= high) == (row["agrees"] == "1")


@pytest.mark.soak
@pytest.mark.parametrize(
    ("kind", "number"), [("catalogue", 1), ("wide", 1), ("wide", 12), ("wide", 35)]
)
def test_a_drag_a_thousandth_above_runs_away_in_time_and_a_hundredth_below_does_not(
    kind, number, in_time
):
    one = in_time.of(kind, number, 0)
    away = scenes.doubling_jump(one.loading_branch())
    told = in_time.InTime(one, (away.slip, away.drag))
    beyond = in_time.beyond_of(away)
    held, state, slip, _ = told.held(told.start(), in_time.BELOW * away.drag, beyond, begin=0.0)
    assert held
    assert slip < away.slip
    assert told.held(state, in_time.above(away) * away.drag, beyond)[0] is False


def test_the_finer_end_of_a_motion_is_the_last_slip_at_which_it_exists():
    """The torque rises up to its end at a logit of -2, which coarse positions have at -1.97."""
    end = -2.0

    def find_from(slips, _):
        return [
            SimpleNamespace(torque=3.0 + logit_slip(slip), converged=logit_slip(slip) <= end)
            for slip in slips
        ]

    search = SimpleNamespace(_fine_motions=SimpleNamespace(find_from=find_from))
    coarse = SimpleNamespace(logit_slip=-1.97)
    found = loading_branch._Search._find_fine_end(search, coarse)
    # two passes of nine slips, the second between the neighbours of the largest of the first
    width = 2.0 * 0.1 / 8.0 * 2.0 / 8.0
    assert end - width <= found.logit <= end
    assert found.torque == pytest.approx(3.0 + found.logit, rel=1e-12)
    assert found.error == pytest.approx(width / found.torque, rel=1e-6)
    nowhere = SimpleNamespace(logit_slip=-1.0)
    assert loading_branch._Search._find_fine_end(search, nowhere) is None
