"""Forces on rollers in one direction, a carrier's and gravity: sums of forces, statics by hand, and another solver."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq, root

import without_bands
from rollslip import Chain, Conditions, Slices, evolve, get_model, load_scene, plan
from rollslip.bearing.assembly import assemble
from rollslip.bearing.equilibrium import LoadCase, angular_positions, solve_equilibrium, solve_pitch
from rollslip.errors import SceneError
from rollslip_studies.dynamics.levels.planar import PlanarSettings, planar_motion
from rollslip_studies.dynamics.levels.raceway_friction import FrictionSettings
from rollslip_studies.dynamics.study import Dynamics
from rollslip_studies.effective_friction.raceways import LoadedRaceways
from rollslip_studies.motion.orbit_loads import solve_orbits
from rollslip_studies.motion.torque_balance import torque_balance
from rollslip_studies.motion.train import Train
from rollslip_studies.steady_slip.minimum_load import rollers_weight

pytestmark = pytest.mark.quick

SCENE = load_scene("1032930-50C")
LAW = SimpleNamespace(
    conditions=Conditions(length=0.014),
    deflection=Chain(get_model("contact", "iso16281").deflection()),
)


def case(rollers=14, n_positions=1, **values):
    given = {"radial_clearance": 2e-5, "radial_load": 3000.0, **values}
    return LoadCase(angular_positions(rollers, n_positions), 0.014, [0.0], **given)


def planet(**changes):
    """A bearing whose inner ring stands on the pin of a carrier and whose outer one turns against it."""
    carrier = {"speed": "400 rpm", "radius": "0.3 m", **changes}
    return evolve(SCENE, {"operation.inner_speed": "0 rpm", "operation.outer_speed": "-3000 rpm",
                          "operation.carrier": carrier, "operation.radial_load": "8 kN"}, si=True)  # fmt: skip


@given(
    st.integers(5, 21), st.floats(0.0, 500.0), st.floats(0.0, 300.0), st.floats(-math.pi, math.pi),
    st.floats(-1e-5, 5e-5), st.floats(10.0, 2e4),
)  # fmt: skip
@settings(max_examples=60, deadline=None)
def test_forces_of_all_rollers_add_up(Z, centrifugal, body, angle, clearance, load):
    b = body * math.cos(angle), body * math.sin(angle)
    one = case(
        Z,
        1,
        body_force=b,
        centrifugal_force=centrifugal,
        radial_clearance=clearance,
        radial_load=load,
    )
    s = solve_equilibrium(one, (LAW, LAW))
    e = np.stack((np.cos(s.psi), np.sin(s.psi)))
    size = max(load, centrifugal + body, s.inner_force.max())
    # each roller, the inner ring, and the outer one, which bears half of all body forces besides: Z/2 of e e^T is 1
    assert (
        np.abs(s.outer_force - s.inner_force - centrifugal - b @ e.reshape(2, -1)).max()
        < 1e-9 * size
    )
    assert (s.inner_force * e).sum(axis=(1, 2)) == pytest.approx([load, 0.0], abs=1e-9 * size)
    outer = np.array([load, 0.0]) + 0.5 * Z * np.array(b)
    assert (s.outer_force * e).sum(axis=(1, 2)) == pytest.approx(outer, abs=1e-9 * Z * size)


def test_rollers_at_rest_on_a_race_bear_what_points_at_it():
    # without load a roller stands on the outer ring with F_c + b cos psi; where that is below zero it lies on the inner
    s = solve_equilibrium(
        case(radial_load=0.0, centrifugal_force=50.0, body_force=(30.0, 40.0)), (LAW, LAW)
    )
    assert s.inner_force == pytest.approx(0.0, abs=1e-12)
    assert s.outer_force == pytest.approx(
        50.0 + 30.0 * np.cos(s.psi) + 40.0 * np.sin(s.psi), abs=1e-10
    )
    # a heavy ring under few light rollers: those above it lie on it, those below it carry it
    s = solve_equilibrium(
        case(radial_load=4000.0, body_force=(2.0, 0.0), radial_clearance=2e-4), (LAW, LAW)
    )
    above = np.cos(s.psi) < -1e-9
    assert s.inner_force[above] == pytest.approx(-2.0 * np.cos(s.psi[above]), abs=1e-9)
    assert s.outer_force[above] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("body", [(25.0, 0.0), (-60.0, 35.0)])
def test_another_solver_finds_the_same_loads(body):
    """Each roller by a bracket, where the ring is held; the ring by the hybrid method of MINPACK."""
    G = 1e-5
    F = 2000.0
    centrifugal = 20.0
    one = case(9, radial_clearance=G, radial_load=F, centrifugal_force=centrifugal, body_force=body)
    law = get_model("contact", "iso16281").deflection()
    psi = one.psi[0]
    outwards = centrifugal + body[0] * np.cos(psi) + body[1] * np.sin(psi)

    def force(approach):
        slices = Slices(1, Conditions(length=0.014), approach=np.array([approach]))
        law.evaluate(slices)
        return 0.014 * float(slices.load[0]) if approach > 0.0 else 0.0

    def inner(x):
        gaps = 1e-5 * (x[0] * np.cos(psi) + x[1] * np.sin(psi)) - G / 2
        at = [
            brentq(
                lambda y, gap=gap, f=f: force(gap - y) - force(y) + f,
                -1e-3,
                1e-3,
                xtol=1e-17,
                rtol=1e-15,
            )
            for gap, f in zip(gaps, outwards, strict=True)
        ]
        return np.array([force(gap - y) for gap, y in zip(gaps, at, strict=True)])

    found = root(
        lambda x: np.array([F - inner(x) @ np.cos(psi), inner(x) @ np.sin(psi)]),
        [2.0, 0.1],
        tol=1e-12,
    )
    solved = solve_equilibrium(one, (LAW, LAW))
    assert solved.inner_force[0] == pytest.approx(inner(found.x), abs=1e-6 * F)
    assert solved.displacement[0] == pytest.approx(1e-5 * found.x, abs=1e-11)


def test_over_a_pitch_half_is_solved_only_if_the_other_mirrors_it():
    for body in ((40.0, 0.0), (40.0, 25.0)):
        one = case(11, 4, body_force=body, centrifugal_force=60.0)
        every = solve_equilibrium(one, (LAW, LAW))
        pitch = solve_pitch(one, (LAW, LAW))
        assert pitch.outer_force == pytest.approx(every.outer_force, rel=1e-9, abs=1e-7)
        inner, *_ = solve_orbits(one, (LAW, LAW), np.array([60.0, 30.0]))
        assert inner.shape[1] == (3 if body[1] == 0.0 else 4)
        assert inner[0, :3] == pytest.approx(every.inner_load[:3], rel=1e-8, abs=1e-4)


def test_a_planet_feels_its_carrier():
    scene = planet()
    a = assemble(scene)
    b = scene.bearing
    w = 400.0 * math.pi / 30.0
    mass = 7800.0 * math.pi / 4.0 * 0.015**2 * 0.015
    k = a.kinematics
    # outwards is across the load, and seen in a mirror, since the outer ring turns backwards as the inner one forwards
    assert math.hypot(*a.body_force) == pytest.approx(mass * w**2 * 0.3, rel=1e-9)
    assert a.body_force[1] == pytest.approx(k.direction * mass * w**2 * 0.3, rel=1e-9)
    # with all that Coriolis adds the force off the axis of the bearing is that of the absolute speed of the orbit
    cage = k.direction * k.epicyclic_cage_speed + w
    assert a.centrifugal_force == pytest.approx(mass * k.orbit_radius * cage**2, rel=1e-9)
    alone = evolve(scene, {"operation.carrier": {"speed": "1 rpm", "radius": "1 mm"}})
    assert assemble(alone).centrifugal_force > 1.5 * a.centrifugal_force
    loads = a.load_distribution(2)
    e = np.stack((np.cos(loads.psi), np.sin(loads.psi)))
    b_outer = (loads.outer_force * e).sum(axis=2)
    assert b_outer[1] == pytest.approx(0.5 * b.rollers * a.body_force[1], rel=1e-6)


def test_a_planet_in_a_mirror_is_the_same():
    one = planet(radius="1 m", direction="50 deg")
    other = evolve(one, {"operation.outer_speed": "3000 rpm", "operation.carrier.speed": "-400 rpm",
                         "operation.carrier.direction": "-50 deg"})  # fmt: skip
    assert (assemble(one).kinematics.direction, assemble(other).kinematics.direction) == (1, -1)
    orbits = [torque_balance(assemble(scene), 2).orbit(0.02) for scene in (one, other)]
    assert orbits[0].force == pytest.approx(orbits[1].force, rel=1e-9)
    assert orbits[0].torque == pytest.approx(orbits[1].torque, rel=1e-9)


def test_friction_counts_every_roller_where_a_carrier_leaves_no_mirror():
    a = assemble(planet(radius="1.2 m"))
    loads = a.load_distribution(4)
    raceways = LoadedRaceways(a, loads, "epicyclic")
    assert raceways.outer.total == pytest.approx(loads.outer_force.sum(), rel=1e-9)
    assert raceways.inner.total == pytest.approx(loads.inner_force.sum(), rel=1e-9)
    friction = raceways.per_roller(np.array([0.01]))[:, :, 0]
    assert np.array_equal(np.isnan(friction[0]), loads.inner_force[0] == 0.0)


def test_over_an_orbit_unloaded_rollers_feel_where_the_carrier_points():
    balance = torque_balance(assemble(planet(radius="1.2 m")), 2)
    orbit = balance.orbit(0.02)
    a = balance.assembly
    psi = (
        2.0
        * math.pi
        / orbit.roller_slip.size
        * np.arange(orbit.roller_slip.size)
        * balance.motions.sense
    )
    b = a.body_force
    free = orbit.force[0] == 0.0
    outwards = (
        a.centrifugal_force_at(balance.cage_speed(0.02)) + b[0] * np.cos(psi) + b[1] * np.sin(psi)
    )
    assert orbit.force[1][free] == pytest.approx(
        np.maximum(outwards, 0.0)[free], rel=1e-9, abs=1e-9
    )
    assert np.any(free & (outwards > 0.0))
    assert (outwards < 0.0).any()
    assert np.all(
        orbit.force[0][outwards < 0.0] >= -outwards[outwards < 0.0] * (1.0 - 1e-9)
    )  # on the inner ring


def test_a_full_complement_pushes_against_the_carrier():
    """Of rollers that nothing else drives N is a sine above its least of zero, of a chain that hangs."""
    Z = 12
    pull = 9.0
    psi = 2.0 * math.pi / Z * np.arange(Z)
    behind, ahead = Train(Z, 0.01, 0.5, 0.1).pushes((pull * np.cos(psi))[None])
    # c (a_k - b_k) = pull cos psi_k: the sum is pull sin/(2 c sin(pi/Z)) at the half steps
    want = pull / (2.0 * 0.5 * math.sin(math.pi / Z)) * np.sin(psi - math.pi / Z)
    assert behind[0] == pytest.approx(want - want.min(), abs=1e-9)
    assert ahead[0] == pytest.approx(np.roll(behind[0], -1), abs=1e-12)


def test_motions_in_time_and_friction_in_pockets_refuse_a_carrier():
    a = assemble(planet())
    with pytest.raises(SceneError, match="motions in time know no carrier"):
        Dynamics(duration=1e-3).moving(a)
    with pytest.raises(SceneError, match="friction in pockets"):
        torque_balance(assemble(evolve(planet(), {"cage.drag": ["pocket-friction"]})), 1).torque(
            0.1
        )


@pytest.mark.parametrize(
    ("carrier", "says"),
    [
        ({"speed": "400 rpm"}, "radius"),
        ({"speed": "400 rpm", "radius": "0 m"}, "above 0"),
        ({"radius": "1 m"}, "speed"),
    ],
)
def test_half_a_carrier_is_refused(carrier, says):
    with pytest.raises(SceneError, match=says):
        evolve(SCENE, {"operation.carrier": carrier}, si=True)


# Gravity -------------------------------------------------------------------------------------------------------------


def slow(**changes):
    return evolve(
        SCENE,
        {"operation.inner_speed": "20 rpm", "operation.radial_load": "30 N", **changes},
        si=True,
    )


def test_rollers_lie_where_their_weight_puts_them():
    weight = 9.80665 * 7800.0 * math.pi / 4.0 * 0.015**2 * 0.015
    a = assemble(slow(**{"operation.gravity_direction": "0 deg"}))
    assert a.body_force == pytest.approx((weight, 0.0), rel=1e-9)
    s = a.load_distribution(4)
    held = a.centrifugal_force + weight * np.cos(s.psi)
    lying = held < 0.0
    standing = (s.inner_force == 0.0) & (held > 0.0)
    assert lying.any()
    assert standing.any()
    assert s.inner_force[lying & (np.cos(s.psi) < -0.5)] == pytest.approx(
        -held[lying & (np.cos(s.psi) < -0.5)], rel=1e-6
    )
    assert s.outer_force[standing] == pytest.approx(held[standing], rel=1e-6)
    outer = (s.outer_force * np.cos(s.psi)).sum(axis=1)
    assert outer == pytest.approx(30.0 + 14.0 * weight, rel=1e-9)  # half of 28 rollers


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
def test_weight_is_left_out_where_it_moves_nothing_beyond_the_tolerance(tolerance):
    given = {
        "operation.gravity_direction": "30 deg",
        "operation.inner_speed": "6371 rpm",
        "accuracy.tolerance": tolerance,
    }
    light = assemble(evolve(SCENE, {**given, "operation.radial_load": "3 kN"}, si=True))
    assert light.weight_fraction < tolerance
    assert light.body_force == (0.0, 0.0)
    exact = assemble(
        evolve(
            SCENE, {**given, "operation.radial_load": "3 kN", "accuracy.tolerance": 1e-6}, si=True
        )
    )
    assert exact.body_force[1] > 0.0
    one, other = (of.load_distribution(2).inner_force.sum(axis=1) for of in (light, exact))
    assert one == pytest.approx(other, rel=tolerance)


def parts(scene):
    return {part.part: part for part in plan(scene, "effective-friction").parts}


def test_the_plan_says_what_weight_leaves():
    left = parts(slow())["gravity of rollers"]
    assert not left.included
    assert "operation.gravity_direction would take it in" in left.reason
    taken = parts(slow(**{"operation.gravity_direction": "15 deg"}))["gravity of rollers"]
    assert taken.included
    assert "15 deg from the line of load" in taken.choice
    fast = evolve(SCENE, {"operation.gravity_direction": "0 deg", "accuracy.tolerance": 1e-2})
    assert "below the tolerance" in parts(fast)["gravity of rollers"].reason
    assert "gravity of rollers" not in parts(evolve(SCENE, {"accuracy.tolerance": 1e-2}))
    assert parts(planet())["carrier"].included


def test_weight_is_refused_where_it_turns_or_moves_in_time():
    with pytest.raises(SceneError, match="turns round where a carrier does"):
        evolve(planet(), {"operation.gravity_direction": "0 deg"})
    with pytest.raises(SceneError, match="the weight of rollers at level 'planar' only"):
        Dynamics(duration=1e-3).moving(assemble(slow(**{"operation.gravity_direction": "0 deg"})))


def test_a_run_says_what_weight_leaves_out():
    few = {
        "study.effective-friction": {
            "points": 5,
            "map_points": 0,
            "skidding_range": 0.0,
            "closure": "epicyclic",
        },
        "accuracy.slices": 3,
        "accuracy.tolerance": 0.05,
    }
    scene = slow(**few)
    fraction = f"{100.0 * assemble(scene).weight_fraction:.2g} % of the mean contact load"
    assert without_bands.run(scene, "effective-friction").attrs["warnings"].count(fraction) == 1
    for other in (
        slow(**few, **{"operation.gravity_direction": "0 deg"}),
        evolve(SCENE, few, si=True),
    ):
        assert (
            "weight of the rollers"
            not in without_bands.run(other, "effective-friction").attrs["warnings"]
        )


@pytest.mark.slow
def test_plane_motion_takes_the_direction_of_the_operation_unless_it_has_its_own():
    friction = FrictionSettings(name="constant", coefficient=0.05, transition=0.1)

    def rates(direction, **own):
        given = {} if direction is None else {"operation.gravity_direction": direction}
        assembly = assemble(
            evolve(SCENE, {"accuracy.tolerance": 1e-2, "accuracy.slices": 5, **given}, si=True)
        )
        planar = planar_motion(assembly, PlanarSettings(inner_ring_mass=3.0, **own), friction)
        return planar.system(0.0, planar.initial())

    assert np.array_equal(rates("70 deg"), rates(None, gravity_direction=math.radians(70.0)))
    assert np.array_equal(rates(None), rates("0 deg"))
    assert np.array_equal(rates("70 deg", gravity_direction=0.0), rates(None))
    assert not np.array_equal(rates("70 deg"), rates(None))
    given = {
        "level": "planar",
        "duration": "1 ms",
        "friction": "effective",
        "integrator": "rk45",
        "relative_tolerance": 1e-5,
        "planar": {"inner_ring_mass": "3 kg"},
    }
    scene = slow(**{"study.dynamics": given})
    assert Dynamics.from_scene(scene).with_weight
    assert "gravity of rollers" not in {part.part for part in plan(scene, "dynamics").parts}
    Dynamics.from_scene(scene).moving(
        assemble(evolve(scene, {"operation.gravity_direction": "90 deg"}))
    )


def test_a_minimum_load_knows_the_weight_that_the_scene_states():
    assert rollers_weight(assemble(slow())) == pytest.approx(
        28.0 * 9.80665 * 7800.0 * math.pi / 4.0 * 0.015**3
    )
    assert rollers_weight(assemble(slow(**{"operation.gravity_direction": "0 deg"}))) == 0.0
