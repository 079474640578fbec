"""Friction that is held between its evaluations: what it is there, how it goes off, solved for, and told."""

import functools
import math

import attrs
import numpy as np
import pytest

from rollslip import evolve, get_model, load_scene
from rollslip.bearing.assembly import assemble
from rollslip_kernels.motion.leapfrog import Leapfrog
from rollslip_studies.dynamics.levels.cage_and_rollers import carried_motion
from rollslip_studies.dynamics.levels.planar import PlanarSettings, planar_motion
from rollslip_studies.dynamics.levels.raceway_friction import FrictionSettings
from rollslip_studies.motion.time_integration import InitialValueProblem, integrate

CONSTANT = FrictionSettings(name="constant", coefficient=0.05, transition=0.05)
#: Slices, drags and friction: the coefficient, the curve, the table, and the chain of all slices, with resistances.
CASES = {
    "constant": (5, (), CONSTANT),
    "curve": (5, ("rolling-resistance",), FrictionSettings(name="effective")),
    "table": (15, ("rolling-resistance",), FrictionSettings(name="conventional")),
    "chain": (5, ("rolling-resistance",), FrictionSettings(name="conventional")),
}
LEVELS = ["pocket", "planar"]
ALL = [*LEVELS, "planar, bent"]
#: An outer ring that yields, out of round.
BENT = {
    "models.outer_ring": {"model": "annulus", "outside": "230 mm", "harmonics": 3},
    "bearing.outer_raceway.form": [{"lobes": 2, "amplitude": "5 um", "angle": "30 deg"}],
    "bearing.catalogue": {"bore": 0.15, "outside_diameter": 0.21, "width": 0.028},
}


@functools.cache
def motion(level, case, load=1037.0):
    slices, drags, friction = CASES[case] if isinstance(case, str) else (5, (), case)
    changes = {"accuracy.slices": slices, "accuracy.tolerance": 2e-2, "operation.radial_load": load}
    changes |= BENT if "bent" in level else {}
    assembly = assemble(
        evolve(
            load_scene("1032930-50C"), changes | {"cage.drag": ["petroff-land", *drags]}, si=True
        )
    )
    if level.startswith("planar"):
        return planar_motion(assembly, PlanarSettings(inner_ring_mass=5.0), friction)
    return carried_motion(assembly, friction, level="pocket")


@functools.cache
def sliding(level, case):
    """A state with slip of cage and rollers, off the middles, in which rollers slide at all speeds."""
    moving = motion(level, case)
    rng = np.random.default_rng(4)
    y = moving.initial(0.02, 0.03)
    of = moving.split(y)
    of["roller_spin"][:] *= 1.0 + rng.normal(0.0, 2e-3, 28)
    of["pocket_position"][:] = rng.normal(0.0, 2e-5, 28)
    return y


@functools.cache
def gone(level, case, times):
    moving = motion(level, case)
    problem = InitialValueProblem(
        rates=moving.system, y=sliding(level, case), atol=1e-9 * moving.system.scale
    )
    return integrate(problem, get_model("integrator", "rk45"), np.array(times), rtol=1e-9).y


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("level", ALL)
def test_where_it_is_evaluated_all_rates_are_those_of_every_law(level, case):
    moving = motion(level, case)
    y = sliding(level, case)
    rates = moving.system.rates(0.0, y)
    held = moving.system.linearised_rates(0.0, y, 0.0, y)
    np.testing.assert_allclose(held, rates, rtol=1e-9, atol=1e-11 * np.abs(rates).max())


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("level", LEVELS)
def test_it_goes_off_with_the_square_of_the_time(level, case):
    """Along the motion itself, by what the spins of the rollers feel: nearly, but for bends of tables and, of slices,
    whose coefficient is taken to stay when their force changes."""
    times = (1e-5, 2e-5)
    moving = motion(level, case)
    y = sliding(level, case)
    off = []
    size = 0.0
    for t, state in zip(times, gone(level, case, times), strict=True):
        exact, held = (moving.split(r)["roller_spin"] for r in
                       (moving.system.rates(t, state), moving.system.linearised_rates(0.0, y, t, state)))  # fmt: skip
        off.append(np.abs(held - exact).mean())
        size = np.abs(exact).mean()
    assert off[1] / off[0] > (3.0 if case == "constant" else 1.7)
    assert off[0] < (2e-3 if case == "chain" else 6e-4) * size


@pytest.mark.parametrize("case", ["constant", "table"])
@pytest.mark.parametrize("level", ALL)
def test_solved_for_it_is_that_of_the_middle_of_the_step(level, case):
    """Rates at extrapolated speeds, which it changes to those that it brings about itself."""
    moving = motion(level, case)
    y = sliding(level, case)
    # D half is 0.1 and more
    kicked = ~moving.system.places
    half = 5e-4
    before = moving.system.rates(0.0, y) * 0.5
    found = moving.system.linearised_rates(0.0, y, 0.0, y, half, before)
    of_rollers = np.zeros(y.size, bool)
    for name in ("roller_spin", "orbital_speed"):
        moving.split(of_rollers)[name][...] = True
    middle = y + np.where(of_rollers & kicked, half * (found - before), 0.0)
    again = moving.system.linearised_rates(0.0, y, 0.0, middle)
    explicit = moving.system.linearised_rates(0.0, y, 0.0, y)
    for name in ("roller_spin", "orbital_speed", "lost_inner", "lost_outer", "work_rings"):
        one, other, without = (moving.split(r)[name] for r in (found, again, explicit))
        scale = np.abs(other).max()
        np.testing.assert_allclose(
            one, other, rtol=0.0, atol=1e-3 * np.abs(other - without).max() + 1e-9 * scale
        )
        assert np.abs(other - without).max() > 1e-4 * scale


STEEP = attrs.evolve(CONSTANT, transition=5e-3)


@pytest.mark.parametrize("level", ALL)
def test_it_resumes_bit_by_bit_also_where_nothing_touches(level):
    moving = motion(level, "curve")
    clear = []
    for steps in (3, 10, 40, 200, 700, 1500):
        whole, first, rest = (
            Leapfrog(moving.system.capsule, 0.0, moving.initial(0.002), 0.01, 1e-5)
            for _ in range(3)
        )
        first.advance(max_steps=steps)
        state = first.state
        clear.append(bool(state[-(first.y.size + 2)]))
        rest.state = state
        for solver in (whole, rest):
            while solver.status == "running":
                solver.advance()
        assert np.array_equal(whole.y, rest.y), steps
    assert any(clear), "nowhere was a way clear, so nothing was tried"


@pytest.mark.parametrize("level", LEVELS)
def test_leapfrog_goes_on_where_friction_is_too_steep_for_its_step(level):
    """The energy closes, the slip is that of Rodas5P, and it goes on bit by bit."""
    moving = motion(level, STEEP)
    absolute, relative = moving.tolerances
    ends = []
    for name, tolerance in (("leapfrog", 1e-5), ("rodas5p", 1e-6)):
        problem = InitialValueProblem(
            rates=moving.system,
            y=moving.initial(0.002),
            atol=tolerance * absolute,
            relative=relative,
        )
        found = integrate(
            problem, get_model("integrator", name), np.array([0.0, 1e-3, 2e-3]), rtol=tolerance
        )
        assert found.outcome == "finished"
        residual = moving.energy_residual(found.y)[-1]
        turned = sum(abs(w[-1]) for w in moving.works(found.y).values())
        assert abs(residual) < 3e-5 * turned
        ends.append(moving.split(found.y)["cage_speed"][-1])
    assert ends[0] == pytest.approx(ends[1], rel=5e-5)
    whole, first, rest = (
        Leapfrog(moving.system.capsule, 0.0, moving.initial(0.002), 1e-3, 1e-5) for _ in range(3)
    )
    first.advance(max_steps=77)
    rest.state = first.state
    assert (whole.advance()[0], rest.advance()[0]) == ("finished", "finished")
    assert np.array_equal(whole.y, rest.y)


@pytest.mark.parametrize("level", LEVELS)
def test_beyond_that_it_ends_in_words(level):
    solver = Leapfrog(motion(level, attrs.evolve(CONSTANT, transition=5e-4)).system.capsule, 0.0,
                      motion(level, "constant").initial(0.002), 1e-2, 1e-5)  # fmt: skip
    assert solver.advance()[0] == "failed"
    assert "rodas5p is made for it" in solver.message


def test_it_is_renewed_where_it_is_off_by_what_is_allowed():
    """At a tenth of the tolerance it errs by a tenth, in a third of the time."""
    moving = motion("pocket", "curve")
    told = []
    for tolerance in (1e-5, 1e-6):
        solver = Leapfrog(moving.system.capsule, 0.0, sliding("pocket", "curve"), 0.01, tolerance)
        assert solver.diagnostics == {}
        assert solver.advance()[0] == "finished"
        told.append(solver.diagnostics)
        assert solver.diagnostics["friction_held"] * solver.renewals == pytest.approx(
            0.01, rel=0.05
        )  # but for the last one
    assert told[0]["friction_off"] == pytest.approx(1e-3, rel=0.5)
    assert told[1]["friction_off"] == pytest.approx(1e-4, rel=0.5)
    assert 2.0 < told[0]["friction_held"] / told[1]["friction_held"] < 5.0
    assert told[0]["friction_most_off"] >= told[0]["friction_off"]


@pytest.mark.parametrize("seed", range(3))
def test_a_flight_ends_where_a_roller_meets_a_bar(seed):
    """With constant rates: the place there is that of first touch, and none is nearer."""
    moving = motion("pocket", "constant")
    rng = np.random.default_rng(seed)
    y = moving.initial(0.02)
    moving.split(y)["orbital_speed"][:] += rng.normal(0.0, 0.3, 28)
    rates = moving.system.rates(0.0, y)
    time = moving.system.flight(0.0, y, rates, 1.0)
    assert 0.0 < time < 1.0
    assert moving.system.flight(0.0, y, rates, 0.5 * time) == 0.5 * time
    orbit = moving.assembly.kinematics.orbit_radius
    cage = moving.assembly.cage
    place = moving.split(y)["pocket_position"]
    closing, pulled = (
        moving.split(x)["orbital_speed"] - moving.split(x)["cage_speed"] for x in (y, rates)
    )
    then = place + orbit * (closing * time + 0.5 * pulled * time**2)
    touch = 0.5 * cage.pocket_clearance - 0.02 / cage.pocket_stiffness
    assert np.abs(then).max() == pytest.approx(touch, rel=1e-12)
    moving.split(y)["pocket_position"][3] = touch
    assert moving.system.flight(0.0, y, rates, 1.0) == 0.0


def test_systems_that_hold_nothing_say_so():
    moving = carried_motion(motion("pocket", "constant").assembly, CONSTANT, level="cage-set")
    y = moving.initial()
    assert moving.system.linearised_rates(0.0, y, 0.0, y) is None
    assert moving.system.flight(0.0, y, moving.system.rates(0.0, y), math.inf) == 0.0
