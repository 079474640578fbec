"""Rollers without a cage: their pushes by hand and in the limits, and what their rubbing takes from a bearing."""

import itertools
import math
import sys

import attrs
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from rollslip.bearing.assembly import assemble
from rollslip.errors import SceneError
from rollslip.scene.changes import evolve
from rollslip.scene.reading import load_scene
from rollslip_studies.dynamics.study import Dynamics
from rollslip_studies.motion import spins
from rollslip_studies.motion.losses import power_balance
from rollslip_studies.motion.torque_balance import torque_balance
from rollslip_studies.motion.train import Train, slower_by_play
from rollslip_studies.steady_slip.study import SteadySlip
from tabled import REFERENCES, rows_of

sys.path.insert(0, str(REFERENCES))
import full_complement

PAPER = load_scene("1032930-50C")


def apart(scene, **separator):
    """Return a scene without a table of its cage, and what is between its rollers."""
    raw = {key: value for key, value in scene.raw.items() if key != "cage"}
    return evolve(
        attrs.evolve(scene, raw=type(scene.raw)(raw), cage=None),
        {"models.separator": separator},
        si=True,
    )


#: With a roller of 15 mm on a pitch circle of 180 mm there is room for 37.
NONE = evolve(apart(PAPER, model="none"), {"bearing.rollers": 37})


def without_friction(scene):
    return evolve(scene, {"models.separator.coefficient": 0.0})


# Pushes of a train ---------------------------------------------------------------------------------------------------


def test_forces_of_a_train_of_four_are_those_by_hand():
    # one roller is driven by 3 N m, the others take 1 N m each: on a lever of 0.5 m the one behind it is not pushed,
    # it pushes with 6 N, and each of the next takes 2 N of that
    behind, ahead = Train(4, 0.1, 0.5, 0.1).pushes(np.array([[-1.0, 3.0, -1.0, -1.0]]))
    assert behind[0] == pytest.approx([2.0, 0.0, 6.0, 4.0], abs=1e-12)
    assert ahead[0] == pytest.approx([0.0, 6.0, 4.0, 2.0], abs=1e-12)


@given(arrays(float, (2, 21), elements=st.floats(-100.0, 100.0)))
@settings(max_examples=60, deadline=None)
def test_a_train_is_in_balance_with_a_gap_and_knows_no_first_roller(torque):
    train = Train(7, 0.1, 0.5, 0.1)
    behind, ahead = train.pushes(torque)
    of_phase = torque.reshape(2, 7, 3)
    even = (of_phase - of_phase.mean(axis=1, keepdims=True)).reshape(2, 21)
    assert train.lever * (ahead - behind) == pytest.approx(even, abs=1e-10)
    assert behind.reshape(2, 7, 3).min(axis=1) == pytest.approx(0.0, abs=1e-10)
    assert train.pushes(np.roll(torque, 3, axis=1))[0] == pytest.approx(
        np.roll(behind, 3, axis=1), abs=1e-10
    )


def test_where_rubbing_takes_traction_forces_grow_as_in_a_belt():
    # c (a - b) = -y - f (a + b): towards the driven roller each force is (c + f)/(c - f) times the one ahead of it, and
    # y/(c - f) more
    f = 0.05
    c = 0.5
    torque = np.array([[6.0, -1.0, -1.0, -1.0, -1.0]])
    falls = np.array([[0.0, f, f, f, f]])
    behind, ahead = Train(5, 0.1, c, 0.1).pushes(torque, falls)
    fraction = (c * (ahead - behind) + falls * (ahead + behind) - torque)[
        0
    ]  # of what the set carries, of each roller
    assert fraction == pytest.approx(fraction[0], abs=1e-12)
    y = 1.0 - fraction[0]
    expected = 0.0
    for k in (4, 3, 2, 1):
        assert ahead[0, k] == pytest.approx(expected, abs=1e-12)
        expected = ((c + f) * expected + y) / (c - f)
        assert behind[0, k] == pytest.approx(expected)


# A bearing -----------------------------------------------------------------------------------------------------------


def test_without_friction_neighbours_do_what_a_cage_without_friction_does():
    bearing = without_friction(NONE)
    caged = evolve(apart(PAPER, model="cage"), {"bearing.rollers": 37})
    one, two = (torque_balance(assemble(scene), 2) for scene in (bearing, caged))
    for slip in (0.0, 0.02, 0.3):
        assert one.torque(slip) == two.torque(slip)


@pytest.mark.parametrize("slip", [0.005, 0.05, 0.4])
def test_what_the_rings_put_in_is_lost_at_neighbours_too(slip):
    balance = torque_balance(assemble(NONE), 2, inertia=False)
    found = power_balance(balance, balance.orbit(slip))
    lost = {loss.source: loss.power for loss in found.losses}
    assert sum(found.rings) == pytest.approx(found.total + found.stored, rel=1e-9)
    assert 0.0 < lost["rubbing of neighbours"] < found.total


def test_brakes_are_those_of_the_pushes_of_the_motion_itself():
    balance = torque_balance(assemble(NONE), 2, inertia=False)
    orbit = balance.orbit(0.05)
    bearing = balance.assembly
    k = bearing.kinematics
    rollers = bearing.scene.bearing.rollers
    lever = k.orbit_radius * np.cos(np.pi / rollers)
    train = Train(rollers, k.roller_radius, lever, balance.motions.rubbing)
    _, _, on_cage = balance.forces(orbit)
    forces = sum(train.pushes(on_cage[None]))[0]
    assert orbit.brakes == pytest.approx(
        train.coefficient * train.radius * forces, rel=2e-4, abs=1e-6 * forces.max()
    )


#: The last of ten random bearings of which `rollslip_studies.motion.spins` states what half and twice its constants do.
ALTERNATING = {
    "models.separator.coefficient": 0.194,
    "operation.radial_load": 1066.6,
    "operation.inner_speed": 110.17,
    "operation.temperature": 318.78,
    "bearing.rollers": 36,
}
#: Cage slips, even in their logit; at the last ones the spin alternates between balances.
CAGE_SLIPS = 1.0 / (1.0 + np.exp(-np.linspace(-9.0, 3.0, 25)))


def torques_without_a_cage():
    """Return torques at `CAGE_SLIPS` at five loads that differ by 1e-7: by rounding each alternates in its own way."""
    loads = ALTERNATING["operation.radial_load"] * (1.0 + 1e-7 * np.arange(5))
    scenes = [
        evolve(NONE, ALTERNATING | {"operation.radial_load": load}, si=True) for load in loads
    ]
    motions = [torque_balance(assemble(scene), 2).motions.find(CAGE_SLIPS) for scene in scenes]
    return np.array([[pair[0].torque for pair in row] for row in motions])


@pytest.mark.slow
def test_a_spin_that_alternates_is_averaged_for_as_long_as_its_torque_needs(monkeypatch):
    # half of _MAX_STALLED_STEPS and of _STALL_RATIO leave 0.7 % and 3 % in place of 0.4 %; twice of them take 257 and
    # 285 iterations in place of 230
    numbers = []
    step = spins.Motions._find_brake_step

    def counted_step(self, slips, *rest):
        numbers.append(slips.size)
        return step(self, slips, *rest)

    monkeypatch.setattr(spins.Motions, "_find_brake_step", counted_step)
    found = torques_without_a_cage()
    assert sum(numbers) / len(found) < 244
    monkeypatch.setattr(spins, "_MAX_STALLED_STEPS", 200)
    monkeypatch.setattr(spins, "_MAX_MOMENT_ITERATIONS", 600)
    errors = (found - torques_without_a_cage()) / np.abs(found).max()
    assert np.sqrt(np.mean(errors**2)) < 0.0055


@pytest.mark.parametrize(("error", "converged"), [(0.007, True), (0.014, False)])
def test_a_motion_of_which_neighbours_leave_more_than_a_hundredth_has_not_converged(
    error, converged, monkeypatch
):
    motions = torque_balance(assemble(NONE), 2).motions
    brakes, _ = motions._find_brakes(np.array([0.05]), None)
    monkeypatch.setattr(
        spins.Motions, "_find_brakes", lambda self, slips, starts: (brakes, np.array([error]))
    )
    ((motion,),) = motions.find(np.array([0.05]))
    assert (motion.error, motion.converged) == (error, converged)


def test_more_friction_at_neighbours_lets_rollers_carry_less():
    most = [
        torque_balance(
            assemble(evolve(NONE, {"models.separator.coefficient": mu})), 1, inertia=False
        ).torque(0.1)
        for mu in (0.0, 0.02, 0.05, 0.1)
    ]
    assert all(one > other for one, other in itertools.pairwise(most))


# What is refused -----------------------------------------------------------------------------------------------------


def test_what_is_stated_of_a_cage_that_is_not_there_is_refused():
    with pytest.raises(SceneError, match=r"cage\.mass: rollers without a cage have none"):
        _ = assemble(evolve(NONE, {"cage.mass": "0.4 kg"})).cage
    with pytest.raises(SceneError, match="pocket-friction is that of a cage"):
        _ = assemble(evolve(NONE, {"cage.drag": ["pocket-friction"]})).cage


@pytest.mark.parametrize(
    ("separator", "told"),
    [
        (
            {"model": "cage", "coefficient": 0.1},
            r"coefficient: only read for model = 'none', not for 'cage'",
        ),
        ({"model": "none", "coefficient": -0.1}, r"coefficient: must be at least 0, not -0\.1"),
        ({"model": "spring"}, r"models\.separator\.model: .*cage.*none.*not 'spring'"),
    ],
)
def test_neighbours_only_brake_and_only_where_no_cage_is_between_them(separator, told):
    with pytest.raises(SceneError, match=told):
        apart(PAPER, **separator)


@pytest.mark.parametrize("level", ["cage-set", "pocket", "planar"])
def test_a_motion_in_time_without_a_cage_is_refused(level):
    with pytest.raises(
        SceneError, match="need a cage; for a full complement take the study of steady slips"
    ):
        Dynamics(level=level).moving(assemble(NONE))


@pytest.mark.soak
def test_a_coefficient_may_be_set_where_only_the_name_says_that_there_is_no_cage():
    bare = apart(PAPER, model="none")
    bare = evolve(bare, {"models.separator": "none"})
    assert (
        assemble(
            evolve(bare, {"models.separator.coefficient": 0.05})
        ).scene.models.neighbour_friction
        == 0.05
    )
    study = SteadySlip(acceptable_slip=None)
    assert study.partial_result(assemble(bare), frozenset({"steady_slip"})) is not None
    assert math.isclose(assemble(bare).scene.models.neighbour_friction, 0.1)


# In time -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("angle", "inertia"), [("90 deg", False), ("200 deg", True)])
def test_neighbours_bear_what_a_carrier_pulls_along_the_orbit(angle, inertia):
    scene = evolve(
        NONE,
        {"operation.carrier": {"speed": "300 rpm", "radius": "0.5 m", "direction": angle}},
        si=True,
    )
    a = assemble(scene)
    mu = 0.1
    balance = torque_balance(a, 1, inertia=inertia)
    (along, across) = a.body_force
    k = balance.assembly.kinematics
    orbit = balance.orbit(0.01)
    psi = 2.0 * math.pi / 74 * np.arange(74)  # every other position is that of one instant
    pull = k.orbit_radius * (across * np.cos(psi) - along * np.sin(psi))
    given = (balance.forces(orbit)[2] + pull)[::2]
    # c (N ahead - N behind) is what is given beyond an equal share; the least is zero; M = mu r (N ahead + N behind)
    ahead = np.cumsum(given - given.mean()) / (k.orbit_radius * math.cos(math.pi / 37))
    ahead -= ahead.min()
    brakes = mu * k.roller_radius * (ahead + np.roll(ahead, 1))
    assert orbit.brakes[::2] == pytest.approx(brakes, abs=1e-3 * brakes.max())
    still = torque_balance(assemble(NONE), 1, inertia=False).orbit(0.01).brakes[::2]
    assert abs(brakes - still).max() > 0.2 * still.max()


def test_slips_are_those_of_rollers_integrated_in_time():
    """Of tools/references/full_complement.py, led to rigid neighbours; the shares are those of the page."""
    without = {}
    for row in rows_of(REFERENCES / "full_complement.csv"):
        (slip, unsure) = full_complement.stiff(row)
        steady = float(row["steady"])
        if float(row["play"]) > 0.0:
            assert abs(slip - steady - float(row["by_play"])) <= unsure + 0.07 * slip
            continue
        case = row["bearing"], float(row["friction"]), float(row["torque"])
        known = full_complement.steady(*case)
        without[case] = slip, known
        assert known == pytest.approx(steady, rel=1e-4)
        assert abs(slip - known) <= unsure <= 0.005 * slip
    assert {name for name, *_ in without} == {"NCF2210V", "NCF3010V"}
    for name, friction, torque in without:  # what friction adds
        if torque == 0.5 and friction > 0.0:
            (slip, known) = without[name, friction, torque]
            (least, bare) = without[name, 0.0, torque]
            assert slip - least == pytest.approx(known - bare, rel=5e-3)


def test_play_slows_a_train_by_itself_over_the_loaded_zone():
    # 2 mm on an orbit of 100 mm, of which a quarter is loaded: 2 over 50 pi
    inner = np.array([3.0, 0.0, 0.0, 0.0])
    assert slower_by_play(2e-3, inner, 0.1) == pytest.approx(2.0 / (50.0 * math.pi))
    assert math.isnan(slower_by_play(2e-3, 0.0 * inner, 0.1))
