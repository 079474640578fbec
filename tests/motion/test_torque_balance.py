"""What is made of a balance of torques: reserves and their words, positions, and curves of effective friction."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.results.text import Status
from rollslip_studies.motion.effective_table import EffectiveTable
from rollslip_studies.motion.spins import Motions
from rollslip_studies.motion.torque_balance import (
    Running,
    SkiddingOnset,
    describe_no_skidding,
    reserve,
    torque_balance,
)

pytestmark = pytest.mark.quick


def balance(drag, **branch):
    return SimpleNamespace(drag=drag, loading_branch=lambda max_slip: SimpleNamespace(**branch))


def test_a_reserve_is_the_drag_of_running_away_over_that_of_the_scene():
    away = SkiddingOnset(0.2, 3.0, "found")
    runs = Running(0.1, 1.5, Status.FOUND)
    assert reserve(balance(None), away, runs).factor == 2.0
    without = SkiddingOnset(math.nan, math.nan, "no skidding", max_torque=3.0, max_torque_slip=0.95)
    for at_rest, factor in (
        (-2.0, 1.5),
        (-1.0, 3.0),
        (-6.0, 1.0),
    ):  # drags that fall with slip do not count for more
        found = reserve(
            balance(lambda _, of=at_rest: of, end=0.95), without, Running(0.1, 1.0, Status.FOUND)
        )
        assert (found.factor, found.status.startswith(Status.AT_LEAST)) == (factor, True)


def test_drags_that_nothing_carries_leave_what_is_carried_at_the_best_slip():
    branch = {"curve": ([0.1, 0.5, 0.9], [1.0, 2.0, -1.0])}
    found = reserve(
        balance(lambda _: -4.0, **branch),
        SkiddingOnset(math.nan, math.nan, ""),
        Running(math.nan, 0.0, Status.NO_STEADY_SLIP),
    )
    assert (found.factor, found.status.startswith(Status.SKIDS)) == (0.5, True)


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


@pytest.mark.parametrize("driven", ["inner", "outer"])
def test_tractions_are_positive_where_they_drive_whichever_ring_turns(driven):
    speeds = {
        f"operation.{ring}_speed": "2000 rpm" if ring == driven else "0 rpm"
        for ring in ("inner", "outer")
    }
    one = torque_balance(
        assemble(evolve(load_scene("1032930-50C"), {"accuracy.slices": 4, **speeds})), 2
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


def test_rollers_that_rub_at_neighbours_slip_without_the_cage():
    assembly = assemble(load_scene("1032930-50C"))
    assert [Motions(assembly, 2, rubbing=rubs).resists for rubs in (0.0, 0.05)] == [False, True]


@pytest.mark.parametrize(
    ("effective", "speed"), [(False, "0.05 rpm"), (False, "1500 rpm"), (True, "1500 rpm")]
)
def test_resistance_to_rolling_is_that_of_python_also_where_hardly_anything_rolls(effective, speed):
    scene = evolve(load_scene("gearbox"), {"operation.inner_speed": speed})
    slow = torque_balance(assemble(scene), 2, inertia=False, effective=effective)
    assert slow.assembly.inner.chain.resists
    orbit = slow.orbit(0.1)
    count = slow.assembly.scene.bearing.rollers
    assert orbit.torque == pytest.approx(
        count * slow.forces(orbit)[2].mean() * slow.motions.sense, rel=1e-6
    )


def test_effective_friction_is_held_beyond_its_table():
    x = np.linspace(-0.9, 0.9, 7)
    table = EffectiveTable(np.stack((x, np.full(7, 0.3)), axis=1), (-0.9, 0.9), 2.0, 0.0)
    assert table.friction(np.array([-1e9, -18.0, 2.0, 18.0, 1e9])) == pytest.approx(
        [-0.9, -0.9, 0.5, 0.9, 0.9]
    )
