"""Loads over the orbit: against the equilibrium where the map was not measured, and what they can never be."""

import itertools
import math

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.bearing.equilibrium import LoadCase, solve_equilibrium
from rollslip.errors import ConvergenceError
from rollslip_plugins.drag.rolling import RollingResistance
from rollslip_studies.dynamics.levels import load_map
from rollslip_studies.dynamics.levels.load_map import build_load_map, fastest, resistances

pytestmark = pytest.mark.quick

#: What bearing 1032930-50C is changed by: all that gives loads another course along the orbit.
SCENES = {
    "profiled": {"accuracy.slices": 15},
    "clearance": {"accuracy.slices": 7, "bearing.radial_clearance": "20 um"},
    "preload": {"bearing.profile": "none", "bearing.radial_clearance": "-3 um"},
    "misaligned": {"accuracy.slices": 15, "operation.misalignment": "1 mrad"},
    "outer ring turns": {
        "accuracy.slices": 7,
        "operation.inner_speed": "0 rpm",
        "operation.outer_speed": "5000 rpm",
    },
}
#: Of the map, as a fraction of the load that the rollers carry together.
TOLERANCE = 5e-3


def bearing(**changes):
    return assemble(evolve(load_scene("1032930-50C"), changes, si=True))


@pytest.fixture(scope="module", params=SCENES)
def mapped(request):
    assembly = bearing(**SCENES[request.param])
    return assembly, build_load_map(assembly, TOLERANCE)


def nodes_of(loads):
    """All nodes of centrifugal force, after asking for every interval."""
    nodes = [0.0]
    while nodes[-1] < loads.top:
        nodes.append(loads.interval(np.nextafter(nodes[-1], math.inf))[1])
    return nodes


def equilibrium(assembly, angle, force):
    """Loads (2, Z, n) with the first roller at an angle, without the map."""
    b = assembly.scene.bearing
    o = assembly.scene.operation
    case = LoadCase(
        angle + 2 * np.pi / b.rollers * np.arange(b.rollers)[None],
        b.roller_length,
        assembly.drop,
        radial_clearance=b.radial_clearance,
        radial_load=o.radial_load,
        misalignment=o.misalignment,
        centrifugal_force=force,
    )
    found = solve_equilibrium(case, assembly.raceways)
    return case.psi[0], np.stack((found.inner_load[0], found.outer_load[0]))


def test_forces_agree_with_the_equilibrium_anywhere(mapped):
    assembly, loads = mapped
    rng = np.random.default_rng(5)
    off = np.zeros(2)
    whole = np.zeros(2)
    wide = loads.widths
    for _ in range(60):
        force = loads.top * rng.uniform() ** 2
        psi, true = equilibrium(assembly, rng.uniform(0, 2 * np.pi), force)
        found = loads.at(psi, force)
        assert np.all(found >= 0.0)
        off += np.abs((found - true) @ wide).sum(axis=1)
        whole += (true @ wide).sum(axis=1)
        # of all rollers together, along the line of load and across it
        carried = (true[0] @ wide).sum()
        assert abs((found - true)[0] @ wide @ np.cos(psi)) < TOLERANCE * carried
        assert abs(found[0] @ wide @ np.sin(psi)) < TOLERANCE * carried
        balance = found[0] @ wide @ np.cos(psi)
        assert balance == pytest.approx(
            assembly.scene.operation.radial_load, abs=TOLERANCE * carried
        )
    assert np.all(off < TOLERANCE * whole)
    assert 0.0 < loads.error <= TOLERANCE


def test_the_error_is_what_is_measured_half_way(mapped):
    assembly, loads = mapped
    n_positions = loads.positions // assembly.scene.bearing.rollers
    pitch = 2 * np.pi / loads.positions

    def misplaced(force, shift):
        off = np.zeros(2)
        whole = np.zeros(2)
        for k in range(n_positions):
            psi, true = equilibrium(assembly, (k + shift) * pitch, force)
            off += np.abs((loads.at(psi, force) - true) @ loads.widths).sum(axis=1)
            whole += (true @ loads.widths).sum(axis=1)
        return (off / np.where(whole > 0.0, whole, 1.0)).max()

    nodes = nodes_of(loads)
    between_positions = max(misplaced(force, 0.5) for force in nodes)
    between_forces = max(
        misplaced(0.5 * (low + high), 0.0) for low, high in itertools.pairwise(nodes)
    )
    # looked for at forces between the nodes too, and over the forces at positions between the nodes: nearly the same
    assert loads.error == pytest.approx(between_positions + between_forces, rel=0.2)


def test_nodes_are_the_equilibrium(mapped):
    assembly, loads = mapped
    nodes = nodes_of(loads)
    for force in (0.0, nodes[len(nodes) // 2], loads.top):
        pitch = 2 * np.pi / loads.positions
        psi, true = equilibrium(assembly, 3 * pitch, force)
        np.testing.assert_allclose(loads.at(psi, force), true, rtol=0, atol=1e-7 * true.max())


def test_is_periodic_and_symmetric(mapped):
    _, loads = mapped
    psi = np.linspace(0.1, 6.1, 9)
    force = 0.37 * loads.top
    once = loads.at(psi, force)
    np.testing.assert_allclose(
        loads.at(psi + 200 * np.pi, force), once, rtol=1e-9, atol=1e-9 * once.max()
    )
    np.testing.assert_allclose(loads.at(-psi, force), once, rtol=1e-6, atol=1e-6 * once.max())
    np.testing.assert_array_equal(
        loads.at(np.array([0.0]), force), loads.at(np.array([2 * np.pi]), force)
    )


def test_is_a_cubic_between_positions_and_linear_between_forces():
    loads = build_load_map(bearing(**SCENES["profiled"]), 2e-2)
    low, high = loads.interval(0.37 * loads.top)
    values, slopes = loads.table(low).swapaxes(0, 1)
    nodes = 2 * np.pi / loads.positions * np.arange(loads.positions + 1)
    spline = CubicHermiteSpline(nodes, values, slopes / nodes[1])
    psi = np.random.default_rng(1).uniform(0, 2 * np.pi, 50)
    largest = values.max()
    at_force = loads.at(psi, low)
    np.testing.assert_allclose(at_force.swapaxes(0, 1), spline(psi), rtol=0, atol=1e-12 * largest)
    middle = loads.at(psi, 0.5 * (low + high))
    mean = 0.5 * (at_force + loads.at(psi, high))
    np.testing.assert_allclose(middle, mean, rtol=0, atol=1e-12 * largest)


def test_slopes_are_of_fourth_order_where_nothing_turns_negative():
    def off(nodes):
        psi = 2 * np.pi / nodes * np.arange(nodes)
        slopes = load_map._slopes((2.0 + np.cos(psi))[None, :, None])
        return np.abs(slopes[0, :, 0] * nodes / (2 * np.pi) + np.sin(psi)).max()

    assert math.log2(off(40) / off(80)) == pytest.approx(4.0, abs=0.1)


def test_what_is_unloaded_between_unloaded_positions_stays_so():
    loads = build_load_map(bearing(**SCENES["clearance"]), 2e-2)
    inner = loads.loads(loads.top)[0]
    empty = np.flatnonzero(
        np.all(inner == 0.0, axis=1) & np.all(np.roll(inner, -1, axis=0) == 0.0, axis=1)
    )
    assert empty.size > 10
    between = 2 * np.pi / loads.positions * (empty + 0.3)
    np.testing.assert_array_equal(loads.at(between, loads.top)[0], 0.0)


def test_without_load_only_centrifugal_forces_press():
    assembly = bearing(
        **{"accuracy.slices": 5, "operation.radial_load": "0 N", "bearing.radial_clearance": "5 um"}
    )
    loads = build_load_map(assembly, 1e-2).forces()
    for force in nodes_of(loads):
        inner, outer = loads.loads(force)
        np.testing.assert_array_equal(inner, 0.0)
        np.testing.assert_allclose(outer, force, rtol=1e-9)


def test_a_tighter_tolerance_costs_nodes_and_is_kept():
    assembly = bearing(**SCENES["profiled"])
    coarse, fine = (build_load_map(assembly, tolerance) for tolerance in (2e-2, 4e-3))
    few, many = (len(nodes_of(loads)) * loads.positions for loads in (coarse, fine))
    assert fine.error <= 4e-3 < coarse.error <= 2e-2
    assert many > 2 * few


def test_only_what_is_asked_for_is_worked_out_and_the_same_whoever_asked_before():
    loads, whole = (build_load_map(bearing(**SCENES["profiled"]), 1e-3) for _ in range(2))
    solved = len(loads.orbits.solved)
    nodes = nodes_of(whole)
    force = 0.37 * loads.top
    assert loads.interval(force) == next(
        pair for pair in itertools.pairwise(nodes) if force <= pair[1]
    )
    assert len(loads.orbits.solved) <= solved + math.log2(len(nodes)) + 1
    assert len(whole.orbits.accepted) > 2 * len(loads.orbits.accepted)
    again = len(loads.orbits.solved)
    psi = np.linspace(0.1, 6.1, 9)
    np.testing.assert_array_equal(loads.at(psi, force), whole.at(psi, force))
    assert len(loads.orbits.solved) == again


def test_goes_up_to_the_speed_asked_for():
    assembly = bearing(**SCENES["preload"])
    per_square = assembly.roller_mass * assembly.kinematics.orbit_radius
    assert fastest(assembly.kinematics) == assembly.kinematics.inner_speed
    default = build_load_map(assembly, 0.05)
    slow = build_load_map(assembly, 0.05, top_speed=100.0)
    assert default.top == pytest.approx(per_square * assembly.kinematics.inner_speed**2, rel=1e-12)
    assert slow.top == pytest.approx(per_square * 1e4, rel=1e-12)


def test_forces_and_resistances_follow_the_loads():
    assembly = bearing(**SCENES["clearance"])
    assembly = evolve_chain(assembly)
    loads = build_load_map(assembly, 2e-2)
    rolling = float(assembly.kinematics.surface_speeds(0.0, 0.0).inner_rolling)
    forces = loads.forces(
        lambda load, ring: resistances(assembly.raceways[ring], load, loads.widths, rolling)
    )
    force = assembly.centrifugal_force
    found = forces.loads(force)
    load = loads.loads(force)
    assert found.shape == (4, loads.positions, 1)
    np.testing.assert_allclose(found[:2, :, 0], load @ assembly.widths, rtol=1e-14)
    for ring, raceway in enumerate(assembly.raceways):
        for position in (0, 3, loads.positions // 2):
            one = load[ring, position]
            slices = raceway.evaluate(one[one > 0.0], rolling, 0.0) if np.any(one > 0.0) else None
            expected = 0.0 if slices is None else slices.resistance @ assembly.widths[one > 0.0]
            assert found[2 + ring, position, 0] == pytest.approx(expected, rel=1e-12)
    assert found[2:].max() > 0.0


def evolve_chain(assembly):
    changes = {"cage.mass": 0.4, "cage.inertia": 3.3e-3, "cage.drag": [RollingResistance.name]}
    return assemble(evolve(assembly.scene, changes, si=True)).with_resistance()


def test_an_unreachable_tolerance_is_refused_in_words(monkeypatch):
    assembly = bearing(**SCENES["clearance"])
    monkeypatch.setattr(load_map, "_MAX_FORCES", 3)
    loads = build_load_map(assembly, 2e-3)
    with pytest.raises(
        ConvergenceError, match=r"3 centrifugal forces leave more than 1.0e-03 .*; raise accuracy"
    ):
        nodes_of(loads)
    monkeypatch.setattr(load_map, "_MAX_POSITIONS", 3)
    with pytest.raises(
        ConvergenceError, match=r"at the wrong place.*table may leave 1.0e-04; raise accuracy"
    ):
        build_load_map(assembly, 1e-4)
