"""A resolution holds every numerical choice, and a study runs exactly the one it is given."""

import attrs
import numpy as np
import pytest
from scipy.integrate import quad

from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.bearing.resolution import Resolution, as_stated, reference_resolution
from rollslip.errors import SceneError
from rollslip.fields import FieldError
from rollslip_studies.dynamics.levels.load_map import build_load_map
from rollslip_studies.dynamics.study import Dynamics
from rollslip_studies.effective_friction.study import EffectiveFriction
from rollslip_studies.friction_curve.study import FrictionCurve
from rollslip_studies.steady_slip.study import SteadySlip

pytestmark = pytest.mark.quick

SCENE = evolve(load_scene("1032930-70C"), {"accuracy.slices": 15})
STUDY = EffectiveFriction(max_cage_slip=0.95, points=21, map_points=0)
TILTED = evolve(SCENE, {"bearing.profile": "none", "operation.misalignment": "0.05 mrad"})


@pytest.mark.parametrize("quadrature", ["equal", "gauss", "graded"])
def test_slices_are_a_quadrature_along_the_roller(quadrature):
    position, widths = Resolution(slices=24, quadrature=quadrature).slicing(0.015)
    assert np.all(np.diff(position) > 0.0)
    np.testing.assert_array_equal(position, -position[::-1])
    # the error of midpoints at the ends goes with the square of the width there, 1.47 times as much of graded ones
    rough = 2e-3 * widths[0] ** 2 * (24 / 0.015) ** 2
    for f, allowed in ((lambda x: 1.0 + 0.0 * x, 1e-14), (lambda x: np.exp(300.0 * x), rough)):
        whole = quad(f, -0.0075, 0.0075, epsabs=0.0, epsrel=1e-13)[0]
        assert f(position) @ widths == pytest.approx(
            whole, rel=1e-14 if quadrature == "gauss" else allowed
        )


@pytest.mark.parametrize("scene", [SCENE, TILTED], ids=["profile", "tilt"])
def test_both_quadratures_go_to_the_same_loads_and_friction(scene):
    def found(slices, quadrature):
        resolution = Resolution(slices=slices, quadrature=quadrature, n_positions=1)
        assembly = assemble(scene, resolution)
        force = assembly.load_distribution(1).inner_force[0]
        return np.append(force / force.max(), STUDY.run(assembly).effective_friction[0] / 5e-3)

    equal = found(801, "equal")
    gauss = found(120, "gauss")
    assert np.abs(equal - gauss).max() < 3e-4  # both err by about 2 over the square of their number
    assert np.abs(found(24, "gauss") - equal).max() < 3e-3


def test_a_study_runs_exactly_the_resolution_it_is_given():
    resolution = Resolution(slices=9, quadrature="gauss", n_positions=3)
    for study, scene in ((STUDY, SCENE), (SteadySlip(points=8), SCENE)):
        result = study.run(assemble(scene, resolution))
        assert (result.attrs["slices"], result.attrs["n_positions"]) == (9, 3)
        assert "positions_error" not in result.attrs
    moved = STUDY.run(assemble(SCENE, Resolution(slices=9, quadrature="gauss")))
    assert moved.attrs["n_positions"] > 3
    assert moved.attrs["positions_error"] <= 1e-3


def test_what_nobody_planned_is_as_the_scene_states():
    assert assemble(SCENE).resolution == as_stated(SCENE) == Resolution(slices=15)
    best = reference_resolution(SCENE)
    assert best.slices == 15  # it is part of what the scene asks for
    assert best.n_positions == 128
    assert best.table_tolerance < 1e-6


def test_dynamics_takes_friction_level_and_integrator_from_a_resolution():
    study = Dynamics(duration=1e-3, points=3)
    resolution = Resolution(
        slices=5,
        n_positions=2,
        friction="conventional",
        level="pocket",
        integrator="rk45",
        integrator_tolerance=1e-4,
    )
    attributes = study.run(assemble(SCENE, resolution)).attrs
    taken = [attributes[name] for name in ("friction", "level", "integrator", "relative_tolerance")]
    assert taken == ["conventional", "pocket", "rk45", 1e-4]
    assert study.with_resolution(Resolution()) == study


def test_gauss_slices_carry_the_forces_of_a_motion():
    """Forces of the compiled motion are those of the equilibrium, whatever the widths of the slices."""
    assembly = assemble(SCENE, Resolution(slices=11, quadrature="gauss", table_tolerance=1e-3))
    loads = build_load_map(assembly, 1e-3)
    study = Dynamics(friction="conventional", duration=1e-4, points=2)
    forces = study.run(assembly).normal_force[:, 0]
    found = assembly.load_distribution(1, assembly.kinematics.epicyclic_cage_speed)
    for ring, force in zip(
        forces.to_numpy(), (found.inner_force[0], found.outer_force[0]), strict=True
    ):
        np.testing.assert_allclose(np.nan_to_num(ring), force, atol=2 * loads.error * force.sum())


def test_stages_run_in_numpy_where_a_resolution_says_so():
    few = attrs.evolve(STUDY, points=5, skidding_range=0.0)
    fast, plain = (
        few.run(assemble(SCENE, Resolution(slices=3, n_positions=1, compiled=c)))
        for c in (True, False)
    )
    np.testing.assert_allclose(plain.effective_friction, fast.effective_friction, rtol=1e-10)
    assert assemble(SCENE, Resolution(compiled=False)).inner.chain.block == 0


def test_leaving_boundary_friction_out_changes_nothing_in_a_full_film():
    """Above the limit of the blend its share is exactly zero; below it there is a difference."""
    rough = evolve(
        SCENE,
        {f"surface.{part}_roughness": "0.4 um" for part in ("inner_raceway", "roller")},
        si=True,
    )
    for scene, same in ((SCENE, True), (rough, False)):
        with_it, without = (
            FrictionCurve(normal_force=(300.0,), points=31).run(
                assemble(scene, Resolution(slices=7, boundary=b))
            )
            for b in (True, False)
        )
        assert (float(with_it.film_parameter.min()) >= 1.5) == same
        assert np.array_equal(with_it.friction, without.friction) == same
    assert assemble(SCENE, Resolution(boundary=False)).traction.name == "muraki"


def test_another_law_of_the_full_film_takes_its_place():
    assembly = assemble(SCENE, Resolution(traction="eyring"))
    assert (assembly.traction.name, assembly.traction.hydrodynamic.name) == (
        "lambda-blend",
        "eyring",
    )


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"slices": 0}, "slices: must be from 1 to 20000, not 0"),
        ({"n_positions": 0}, "n_positions: must be at least 1, not 0"),
        ({"quadrature": "simpson"}, "quadrature: must be one of"),
        ({"table_tolerance": 0.0}, "table_tolerance: must be between 0 and 1"),
    ],
)
def test_what_a_resolution_cannot_be_is_said(wrong, message):
    with pytest.raises(FieldError, match=message):
        Resolution(**wrong)


def test_a_resolution_is_a_value():
    assert hash(Resolution(slices=7)) == hash(Resolution(slices=7))
    with pytest.raises(attrs.exceptions.FrozenInstanceError):
        Resolution().slices = 3


def test_a_map_takes_more_slices_than_a_table_holds():
    """More loaded slices than are evaluated at a time, for fewer speeds than parts of them."""
    study = EffectiveFriction(points=5, map_points=2, max_cage_slip=0.3, skidding_range=0.0)
    fine = study.run(assemble(SCENE, Resolution(slices=2001, n_positions=8)))
    coarse = study.run(assemble(SCENE, Resolution(slices=301, n_positions=8)))
    np.testing.assert_allclose(fine.friction_map, coarse.friction_map, rtol=1e-3, atol=1e-6)


@pytest.mark.parametrize(("key", "word"), [("tolerance", "exact"), ("slices", "auto")])
def test_a_word_that_is_not_known_is_answered_with_the_one_that_is(key, word):
    with pytest.raises(SceneError, match=f"accuracy.{key}: .*'exakt'.*; or write '{word}'"):
        evolve(load_scene("1032930-70C"), {f"accuracy.{key}": "exakt"}, si=True)


def test_the_finest_of_some_takes_each_number_from_the_one_that_has_it_finest():
    fine = Resolution(
        slices=41,
        quadrature="gauss",
        n_positions=2,
        table_tolerance=1e-3,
        integrator="bdf",
        friction="a",
    )
    coarse = Resolution(
        slices=11, n_positions=8, table_tolerance=1e-4, integrator="bdf", integrator_tolerance=1e-5
    )
    found = Resolution.maximum_of([coarse, fine], ("integrator", "friction"))
    assert found == Resolution(
        slices=41,
        quadrature="gauss",
        n_positions=8,
        table_tolerance=1e-4,
        integrator="bdf",
        integrator_tolerance=1e-5,
    )
    assert Resolution.maximum_of([fine]).integrator is None
    assert Resolution.maximum_of([Resolution()]).n_positions == 1
