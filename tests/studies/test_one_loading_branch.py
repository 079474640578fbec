"""What studies say of slip, drag and reserve is of one way up: at one resolution no digit differs between them."""

import math
import re

import attrs
import numpy as np
import pytest

import loading_branch_scenes as scenes
from rollslip import evolve, load_scene, plan
from rollslip.bearing.assembly import assemble
from rollslip.errors import ConvergenceError, DomainError
from rollslip.results.accounts import account_of
from rollslip.results.text import Status
from rollslip.results.verdict import SKIDDING_SLIP
from rollslip_studies.dynamics.over_time import onset_of
from rollslip_studies.effective_friction.study import EffectiveFriction
from rollslip_studies.motion.spins import Motions
from rollslip_studies.motion.torque_balance import RANGE, torque_balance
from rollslip_studies.steady_slip.study import SteadySlip
from rollslip_studies.thermal_balance.study import ThermalBalance

#: With two folds; a jump that is none of running away; a fold beside motions from above; none, and much slip of rollers
#: at rest; none without resistance to rolling; a fold and a drag beyond it.
HARD = {
    "two motions": scenes.free(5),
    "a jump from which the slip does not double": scenes.catalogue(17),
    "a fold with rolling resistance": scenes.catalogue(1),
    "no fold with rolling resistance": scenes.catalogue(3),
    "no fold": scenes.catalogue(10, resists=False),
    "skids": evolve(
        scenes.free(6), {"cage.drag": [{"model": "constant-torque", "size": "1 kN m"}]}
    ),
}


def few(scene, n_positions=1):
    """Few slices; so few instants that every study takes the least on which rollers are followed.

    Heat does not act on a bearing whose temperatures are given: its network is not asked.
    """
    made = assemble(evolve(scene, {"models.thermal": "given"}))
    slices = min(8, made.slices)
    return made.at(
        attrs.evolve(made.resolution, slices=slices, quadrature="equal", n_positions=n_positions)
    )


@pytest.mark.parametrize("name", HARD)
def test_all_studies_say_the_same_of_one_bearing(name):
    whole = _asked_alike(few(HARD[name]))
    skids = name == "skids" or float(whole.steady_slip[0]) > SKIDDING_SLIP
    assert Status.of(whole.reserve_status.item()) is (Status.SKIDS if skids else Status.FOUND)


@pytest.mark.soak
@pytest.mark.parametrize("number", range(60))
def test_all_studies_say_the_same_of_random_bearings(number):
    bearing = few((scenes.free, scenes.catalogue)[number % 2](1000 + number))
    try:
        torque_balance(bearing, 1).loading_branch()
    except DomainError as error:
        for study in (SteadySlip(), EffectiveFriction()):
            with pytest.raises(DomainError, match=re.escape(str(error)[:20])):
                study.run(bearing)
        pytest.skip(f"a law has no value: {error}")
    _asked_alike(bearing)


def _asked_alike(bearing):
    """Ask all studies of one bearing, and return what steady-slip says."""
    quick = EffectiveFriction(points=5, map_points=0, closure="epicyclic")
    simple = quick.run(bearing)
    whole = SteadySlip().run(bearing)
    heat = ThermalBalance().run(bearing)
    away, _ = onset_of(quick, quick.loaded(bearing, 1))

    def same(*values):
        np.testing.assert_array_equal(values, np.full(len(values), values[0]))

    same(*(float(one) for one in (simple.skidding_slip, whole.skidding_slip, away.slip)))
    same(*(float(one) for one in (simple.limit_drag, whole.limit_drag, away.drag)))
    same(*(float(one) for one in (simple.steady_cage_slip, whole.steady_slip[0], heat.given_slip)))
    same(float(simple.steady_drag), float(whole.torque[0]))
    same(float(simple.drag_reserve), float(whole.drag_reserve))
    same(simple.reserve_status.item(), whole.reserve_status.item())
    some, _ = SteadySlip(pockets="set").partial_result(
        bearing, frozenset({"steady_slip", "status"})
    )
    same(float(some["steady_slip"][1][0]), float(whole.steady_slip[0]))
    (at_once, _), *_ = EffectiveFriction.run_batch(
        [(quick, bearing)], frozenset({"limit_drag", "drag_reserve"})
    )
    same(float(at_once["limit_drag"][1]), float(whole.limit_drag))
    if whole.reserve_status.item() == Status.FOUND:
        assert float(whole.drag_reserve) >= 1.0
    return whole


@pytest.mark.parametrize("name", ["no fold with rolling resistance", "no fold"])
def test_the_least_load_of_its_own_slip_is_the_load_of_a_bearing(name):
    bearing = few(HARD[name])
    (steady, *_) = SteadySlip().steady(bearing)[1]
    load = bearing.scene.operation.radial_load
    found, _ = SteadySlip(acceptable_slip=steady.slip, pockets="set").partial_result(
        bearing, frozenset({"minimum_load"})
    )
    assert found["minimum_load"][1] == pytest.approx(load, rel=2e-4)  # it is found to 1e-4


def test_the_least_load_of_a_slip_that_the_cage_on_its_loading_branch_jumps_over_is_that_with_less_of_which_it_jumps():
    """Between the jump and where it leads to, though the rollers of a cage from above would hold it there."""
    bearing = few(HARD["two motions"])
    jump = torque_balance(bearing, 1).loading_branch().jumps[0]
    slip = math.sqrt(jump.slip * jump.slip_after)
    found, _ = SteadySlip(acceptable_slip=slip, pockets="set").partial_result(
        bearing, frozenset({"minimum_load"})
    )
    load = found["minimum_load"][1]
    status = found["minimum_load_status"][1]
    at = float(status.removeprefix(f"{Status.FOUND_AT_SKIDDING} ").removesuffix(" on"))
    assert at < 0.9 * slip
    more, less = (
        SteadySlip().steady(bearing.at_load(fraction * load))[1][0].slip
        for fraction in (1.003, 0.997)
    )
    assert more < 1.05 * at < slip < less


def test_the_slip_that_a_larger_drag_takes_the_cage_to_has_a_status_of_its_own():
    jumps, ends, none = (
        SteadySlip().run(few(scene))
        for scene in (scenes.catalogue(19), HARD["skids"], HARD["no fold"])
    )
    assert (jumps.jump_slip_status.item(), float(jumps.jump_slip) > 0.0) == ("found", True)
    assert ends.skidding_status.item() == "found"
    assert ends.jump_slip_status.item() == "a larger drag is carried by no slip up to 0.95"
    assert np.isnan(ends.jump_slip)
    assert none.jump_slip_status.item() == none.skidding_status.item()


def test_a_jump_to_a_slip_that_is_none_of_skidding_is_reported_from_and_to():
    result = SteadySlip().run(few(HARD["two motions"]))
    jump = torque_balance(few(HARD["two motions"]), 1).loading_branch().jumps[0]
    assert np.isnan(result.limit_drag)
    found = float(result.first_maximum_slip), float(result.first_jump_slip)
    assert found == pytest.approx((jump.slip, jump.slip_after))
    (said,) = account_of(result).topics(result)["limit drag torque"]
    assert said.endswith(f"a larger drag takes the cage to {100.0 * jump.slip_after:.3g} %")


@pytest.mark.parametrize("error", [DomainError, ConvergenceError])
def test_a_steady_slip_survives_a_failure_at_the_far_end_of_its_curve(error, monkeypatch):
    known = SteadySlip().run(few(HARD["no fold"]))
    plain = Motions.find

    def refusing(self, slips, starts=None):
        if np.any(slips > 0.5):
            raise error("no value there")
        return plain(self, slips, starts)

    monkeypatch.setattr(Motions, "find", refusing)
    found = SteadySlip().run(few(HARD["no fold"]))
    assert float(known.cage_slip[-1]) == 0.9
    assert 0.4 < float(found.cage_slip[-1]) <= 0.5
    assert float(found.steady_slip[0]) == pytest.approx(float(known.steady_slip[0]), rel=1e-9)
    assert found.status.item() == "found"
    assert "no value there" in found.skidding_status.item()
    quick = EffectiveFriction(points=5, map_points=0, closure="epicyclic")
    assert float(quick.run(few(HARD["no fold"])).steady_cage_slip) == float(found.steady_slip[0])


def test_more_slips_of_a_curve_change_nothing_that_is_said_of_it():
    bearing = few(HARD["two motions"])
    plain, dense = (SteadySlip(points=points).run(bearing) for points in (25, 150))
    assert dense.sizes["cage_slip"] > 150 > plain.sizes["cage_slip"]
    for name in ("steady_slip", "limit_drag", "skidding_slip", "largest_torque", "drag_reserve"):
        np.testing.assert_array_equal(dense[name], plain[name])
    assert RANGE > float(plain.cage_slip[-1]) == 0.9


@pytest.mark.parametrize("study", ["effective-friction", "steady-slip"])
def test_what_is_left_out_under_a_bound_may_be_so_on_the_whole_loading_branch(study):
    """Of a bearing whose film is full at all slips of the curves, and mixed where its cage all but stands."""
    made = plan(load_scene("gearbox"), study)
    balance = torque_balance(made.assemblies[study], 1)
    for slip in (0.001, 0.1, 0.6, RANGE):
        thinnest = [
            of.slices.film_thickness.min() for of in balance.evaluate_contacts(balance.orbit(slip))
        ]  # or a bound breaks
    limit = balance.assembly.traction.full_film_from
    assert min(thinnest) < limit * balance.assembly.inner.conditions.roughness
    assert made.choices[study].resolution.boundary


def test_a_plan_of_both_has_the_loading_branch_once():
    """At resolutions of their own they would differ by what these leave."""
    both = plan(load_scene("gearbox"))
    alone = plan(load_scene("gearbox"), "effective-friction")
    assert (
        both.studies["effective-friction"].skidding_range
        == 0.0
        < alone.studies["effective-friction"].skidding_range
    )
    assert (
        both.studies["effective-friction"].map_points
        == alone.studies["effective-friction"].map_points
    )
    assert "steady-slip" in both.studies
