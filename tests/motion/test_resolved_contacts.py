"""What bearings tell of what moves fast in them, and integrators that step over none of it."""

import functools
import math

import attrs
import numpy as np
import pytest

from rollslip import evolve, get_model, load_scene
from rollslip.bearing.assembly import assemble
from rollslip_kernels.motion.leapfrog import Leapfrog
from rollslip_kernels.motion.rosenbrock import DormandPrince
from rollslip_studies.dynamics.levels.cage_and_rollers import carried_motion
from rollslip_studies.dynamics.levels.planar import PlanarSettings, planar_motion
from rollslip_studies.dynamics.levels.raceway_friction import FrictionSettings
from rollslip_studies.motion.time_integration import InitialValueProblem, integrate

#: Few slices and a coarse tolerance: frequencies are compared with those of the same rates.
SCENE = {"accuracy.slices": 5, "accuracy.tolerance": 2e-2}
FRICTION = FrictionSettings(name="constant", coefficient=0.01, transition=0.5)
LEVELS = [
    "cage-set",
    "pocket",
    "planar",
    "planar, guided by its rollers",
    "planar, on the inner ring",
]


@functools.cache
def motion(level, film="metal", mass=5.0, drag=None):
    guidance = "roller" if "rollers" in level else "inner" if "inner" in level else "outer"
    changes = {"cage.guidance": guidance, "cage.pocket_contact": film}
    if guidance == "roller":
        held = {
            "mass": 0.4,
            "inertia": 3.3e-3,
            "guidance": guidance,
            "pocket_radial_clearance": 1e-4,
            "drag": [],
        }
        changes = {"cage": held | {"pocket_contact": film}}
    if drag and guidance == "roller":
        changes["cage"]["drag"] = [drag]
    elif drag:
        changes["cage.drag"] = [drag]
    assembly = assemble(evolve(load_scene("1032930-50C"), SCENE | changes, si=True))
    if level.startswith("planar"):
        return planar_motion(assembly, PlanarSettings(inner_ring_mass=mass), FRICTION)
    return carried_motion(assembly, FRICTION, level=level)


def moved(moving, seed=1, speed=0.02):
    """From its start, rollers with speeds in their pockets, cage and ring with some, too [m/s]."""
    rng = np.random.default_rng(seed)
    y = moving.initial()
    of = moving.split(y)
    if "orbital_speed" in of:
        of["orbital_speed"][:] += (
            rng.normal(0.0, speed, 28) / moving.assembly.kinematics.orbit_radius
        )
    for name in ("inner_ring_vx", "cage_vx", "cage_vy"):
        if name in of:
            of[name][...] = rng.normal(0.0, speed)
    return y


def pressed(moving, roller=7, depth=1e-6):
    y = moving.initial()
    moving.split(y)["pocket_position"][roller] = moving.assembly.cage.pocket_clearance / 2 + depth
    return y


def swings(moving, y):
    return np.abs(np.linalg.eigvals(moving.system.jacobian(0.0, y)).imag)


@pytest.mark.parametrize("level", LEVELS[1:4])
def test_the_frequency_of_a_contact_is_that_of_a_roller_on_its_bar(level):
    """An eigenvalue of the rates, which there is only while the bar is touched."""
    moving = motion(level)
    told = moving.system.frequencies[0]
    assert np.abs(swings(moving, pressed(moving)) / told - 1.0).min() < 0.01
    assert np.abs(swings(moving, moving.initial()) / told - 1.0).min() > 0.1


def test_a_land_that_is_stiffer_than_the_bars_tells_its_frequency():
    moving = motion(LEVELS[4])
    stiff = attrs.evolve(moving.settings, land_stiffness=1e12)
    other = planar_motion(moving.assembly, stiff, FRICTION)
    cage = 1.0 / moving.assembly.cage.mass + 1.0 / stiff.inner_ring_mass
    assert other.system.frequencies[0] == pytest.approx(math.sqrt(1e12 * cage), rel=1e-12)
    assert moving.system.frequencies[0] < 6e4


@pytest.mark.parametrize("mass", [5.0, 0.05])
def test_the_frequency_between_the_rings_is_one_that_no_roller_passes(mass):
    """Also where the inner ring is as light as its rollers; nor is it more than half as much again."""
    moving = motion("planar", mass=mass)
    fastest = swings(moving, moving.initial()).max()
    assert fastest < moving.system.frequencies[1] < 1.5 * fastest * (1.0 if mass == 5.0 else 2.0)
    assert motion("pocket").system.frequencies[1] == 0.0


@pytest.mark.parametrize("level", LEVELS)
def test_places_are_what_speeds_alone_move(level):
    moving = motion(level)
    places = moving.system.places
    names = moving.units
    found = {name for name, at in moving.split(places).items() if np.all(at)}
    assert found == {
        name for name in names if name in moving.split(places) and names[name] in ("m", "rad")
    }
    assert not any(np.any(at) for name, at in moving.split(places).items() if name not in found)
    y = moved(moving)
    rates = moving.system.rates(0.0, y)
    rng = np.random.default_rng(2)
    elsewhere = y + np.where(places, 1e-6 * rng.normal(size=y.size), 0.0)
    assert np.array_equal(moving.system.rates(0.0, elsewhere)[places], rates[places])


@pytest.mark.parametrize("level", LEVELS[1:])
def test_a_step_of_leapfrog_moves_places_by_the_speeds_at_both_ends(level):
    moving = motion(level)
    y = moved(moving)
    places = moving.system.places
    solver = Leapfrog(moving.system.capsule, 0.0, y, 1.0, 1e-5)
    solver.step()
    before, after = (moving.system.rates(0.0, state)[places] for state in (y, solver.y))
    contact, swing = moving.system.frequencies
    h = 1.4 / swing if swing else 0.2 / contact
    assert solver.t == pytest.approx(h, rel=1e-15)
    np.testing.assert_allclose(
        (solver.y - y)[places], 0.5 * h * (before + after), rtol=1e-9, atol=1e-17
    )


@pytest.mark.parametrize("level", LEVELS[1:])
@pytest.mark.parametrize("seed", range(4))
def test_the_time_to_the_next_contact_is_when_a_force_sets_in(level, seed):
    moving = motion(level)
    y = moved(moving, seed)
    soonest = moving.system.until_contact(0.0, y)
    places = moving.system.places
    assert 1e-4 < soonest < 0.05
    moving.split(places)["cage_angle"][...] = False  # at the present angles, too
    at = [
        y + np.where(places, part * soonest * moving.system.rates(0.0, y), 0.0)
        for part in (0.99, 1.01)
    ]
    touched = [np.count_nonzero(forces(moving, state)) for state in at]
    assert touched[0] == 0
    assert touched[1] > 0
    assert moving.system.until_contact(0.0, at[1]) == 0.0


def forces(moving, y):
    found = moving.outputs(np.zeros(1), y[None])
    return np.concatenate(
        [found[name].ravel() for name in ("pocket_force", "pocket_radial_force") if name in found]
    )


def test_nothing_that_parts_is_waited_for():
    moving = motion("pocket")
    assert moving.system.until_contact(0.0, moving.initial()) == math.inf
    assert motion("cage-set").system.frequencies == (0.0, 0.0)


@functools.cache
def impacts(name, tolerance, told=True, level="pocket"):
    """Root of the mean square of the pocket forces over the first impacts of rollers at some 20 mm/s."""
    moving = motion(level)
    absolute, relative = moving.tolerances if told else (moving.system.scale, None)
    times = np.linspace(0.0, 8e-3, 8001)
    found = integrate(
        InitialValueProblem(
            rates=moving.system if told else lambda t, y: moving.system(t, y),
            y=moved(moving, 3), atol=tolerance * absolute, relative=relative,
        ),
        get_model("integrator", name), times, rtol=tolerance,
    )  # fmt: skip
    assert found.outcome == "finished", found.message
    force = moving.outputs(found.t, found.y)["pocket_force"]
    assert np.count_nonzero(np.abs(force).max(axis=0)) > 10
    return math.sqrt(np.mean(force**2))


@pytest.mark.parametrize("name", ["rk45", "leapfrog", "rodas5p"])
def test_impacts_are_resolved_at_the_usual_tolerance(name):
    """The first ones, before the motions part."""
    assert impacts(name, 1e-5) == pytest.approx(impacts("rodas5p", 1e-9), rel=0.01)


@pytest.mark.parametrize("level", LEVELS[2:])
def test_impacts_in_parts_of_a_step_are_resolved_too(level):
    """Against the explicit method of order 5, whose steps shrink with the tolerance."""
    assert impacts("leapfrog", 1e-5, level=level) == pytest.approx(
        impacts("rk45", 1e-9, level=level), rel=0.01
    )


def test_an_explicit_method_that_is_told_of_no_contact_is_wrong_about_impacts():
    """SciPy's form of rk45, which is held to the clearance."""
    assert abs(impacts("rk45", 1e-5, False) / impacts("rodas5p", 1e-9) - 1.0) > 0.05


def test_no_step_of_an_explicit_method_goes_on_over_a_contact():
    """Whatever the tolerance: up to it, and through it in eighths of its half swing."""
    moving = motion("pocket")
    solver = DormandPrince(
        moving.system.capsule, 0.0, moved(moving, 3), 8e-3, 1e3, 1e3, first_step=1e-6
    )
    resolved = 0.4 / moving.system.frequencies[0]
    within = 0
    free = 0
    while solver.status == "running":
        before = solver.t
        until = moving.system.until_contact(solver.t, solver.y)
        solver.step()
        assert solver.t - before <= max(resolved, until) * (1.0 + 1e-9)
        within = within + (until == 0.0)
        free = free + (solver.t - before > 2.0 * resolved)
    assert within > 30
    assert free > 10


def test_a_place_in_a_pocket_is_held_to_the_depth_of_its_contact():
    moving = motion("pocket")
    absolute, relative = (moving.split(part) for part in moving.tolerances)
    a = moving.assembly
    depth = 0.05 * a.centrifugal_force / 5e7  # which is more than a share of the load here
    assert np.all(absolute["pocket_position"] == pytest.approx(depth))
    assert np.all(relative["pocket_position"] == pytest.approx(depth / 1e-4))
    assert 1e-7 < depth < 3e-7
    scale = moving.split(moving.system.scale)
    for name in scale.keys() - {"pocket_position"}:
        assert np.array_equal(absolute[name], scale[name])
        assert np.all(relative[name] == 1.0)


@pytest.mark.parametrize("name", ["leapfrog", "rk45"])
@pytest.mark.parametrize("level", ["pocket", "planar"])
def test_a_motion_with_impacts_goes_on_bit_by_bit_from_what_was_kept(level, name, monkeypatch):
    moving = motion(level)
    end = 6e-3
    absolute, relative = moving.tolerances
    times = np.linspace(0.0, end, 61)
    kept = []

    def run(y, t=0.0, done=0, **options):
        problem = InitialValueProblem(
            rates=moving.system,
            y=y,
            t=t,
            atol=1e-5 * absolute,
            relative=relative,
            watch=moving.system.watch,
        )
        return integrate(problem, get_model("integrator", name), times[done:], rtol=1e-5, **options)

    monkeypatch.setattr("rollslip_studies.motion.time_integration._FIRST_STEPS", 100)
    whole = run(moved(moving, 3), save=lambda number, part: kept.append(part), save_interval=-1.0)
    assert whole.outcome == "finished"
    assert np.abs(moving.outputs(whole.t, whole.y)["pocket_force"]).max() > 1.0
    before = functools.reduce(lambda one, other: one.join(other), kept[:3])
    assert 0.0 < before.last_t < end
    options = {"first_step": before.last_step, "state": before.last_state}
    rest = run(before.last_y, before.last_t, before.t.size, **options)
    again = before.join(rest)
    assert np.array_equal(again.y, whole.y)
    assert (again.steps, again.events) == (whole.steps, whole.events)


def rubbing(level, seed=2):
    """Bars are pressed along the orbit and, where rollers guide, along the radius; a land is met, all with speeds."""
    moving = motion(level, drag="pocket-friction")
    rng = np.random.default_rng(seed)
    y = moved(moving, seed, 0.1)
    cage = moving.assembly.cage
    of = moving.split(y)
    of["pocket_position"][[3, 11]] = cage.pocket_clearance / 2 + rng.uniform(2e-6, 4e-6, 2)
    of["pocket_position"][20] = -cage.pocket_clearance / 2 - 3e-6
    if cage.guidance == "roller":
        of["cage_x"][...] = 6e-5
    else:
        of["cage_y"][...] = -cage.land_clearance - 3e-6
    return moving, y


@pytest.mark.parametrize("level", LEVELS[2:])
def test_what_touches_and_all_else_are_the_whole(level):
    """Kicks over a time in which nothing moves, and rates without what touches."""
    moving, y = rubbing(level)
    h = 1e-10
    speeds = ~moving.system.places
    kicks = (moving.system.go(0.0, h, 1, y) - y)[speeds] / h
    rest, whole = (
        moving.system.linearised_rates(0.0, y, 0.0, y, separate_contacts=separate)[speeds]
        for separate in (True, False)
    )
    size = np.abs(whole).max()
    assert np.abs(kicks).max() > 1e-2 * size
    np.testing.assert_allclose(kicks + rest, whole, rtol=1e-4, atol=1e-6 * size)


@pytest.mark.parametrize("level", LEVELS[2:])
def test_halving_the_parts_quarters_the_error_of_a_bar(level):
    """With its damping and friction, over a sixth of a contact."""
    moving, y = rubbing(level)
    fine, coarse, half = (moving.system.go(0.0, 1e-5, parts, y) for parts in (4096, 32, 64))
    for name in ("orbital_speed", "roller_spin", "cage_speed", "lost_pockets", "work_cage_elastic"):
        fine_of, coarse_of, half_of = (moving.split(state)[name] for state in (fine, coarse, half))
        ratio = np.abs(coarse_of - fine_of).max() / np.abs(half_of - fine_of).max()
        assert 3.3 < ratio < 4.8, name


def test_nothing_touched_is_a_drift():
    moving = motion("planar")
    y = moved(moving)
    then = moving.system.go(0.0, 4e-6, 2, y)
    assert np.array_equal(then[~moving.system.places], y[~moving.system.places])
    np.testing.assert_allclose(then - y, 4e-6 * np.where(moving.system.places, moving.system.rates(0.0, y), 0.0),
                               rtol=1e-9, atol=1e-17)  # fmt: skip
    assert motion("pocket").system.go(0.0, 1e-6, 1, moved(motion("pocket"))) is None


def test_two_rates_are_given_up_where_damping_asks_for_shorter_steps():
    """Contacts that damp by 0.43 in the longer step, 0.21 in the shorter; it also goes on bit by bit from there."""
    damped = attrs.evolve(motion("planar").settings, contact_damping=2.0)
    moving = planar_motion(motion("planar").assembly, damped, FRICTION)
    contact, swing = moving.system.frequencies
    whole, first, rest = (
        Leapfrog(moving.system.capsule, 0.0, moved(moving), 1e-3, 1e-5) for _ in range(3)
    )
    first.advance(max_steps=77)
    assert first.t == pytest.approx(77 * min(0.2 / contact, 0.8 / swing), rel=1e-12)
    assert 0.3 * swing / 1.4 < first.damping < 0.3 * contact / 0.2
    rest.state = first.state
    assert (whole.advance()[0], rest.advance()[0]) == ("finished", "finished")
    assert np.array_equal(whole.y, rest.y)


@pytest.mark.parametrize("level", ["pocket", "planar"])
def test_a_film_in_the_pockets_damps_more_than_leapfrog_bears(level):
    moving = motion(level, film="film")
    y = moved(moving)
    moving.split(y)["pocket_position"][:] = 0.99e-4
    solver = Leapfrog(moving.system.capsule, 0.0, y, 1.0, 1e-5)
    assert solver.advance()[0] == "failed"
    assert "more than the" in solver.message
    assert solver.message.endswith("rodas5p is made for it")
