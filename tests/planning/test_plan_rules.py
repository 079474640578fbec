"""A plan keeps the error that a scene states; whatever it leaves out changes nothing, or is taken back in."""

import itertools
import json
import math

import attrs
import numpy as np
import pytest

import rollslip
from plan_scenes import STUDY, TRACTIONS, judge, pick, points, scene
from rollslip import Conditions, Slices, evolve, get_model, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.bearing.resolution import BoundBrokenError, Resolution, reference_resolution
from rollslip.cli.console import changed
from rollslip.errors import SceneError
from rollslip.planning.execution import execute
from rollslip.planning.plan import plan
from rollslip.planning.verification import verify
from rollslip.studies.bounds import (
    BoundaryFriction,
    ErrorBound,
    ExactLaw,
    Extremes,
    InletHeating,
    LightContacts,
    sample_errors,
)
from rollslip.studies.discretisation.choice import Probe, coarse_assembly
from rollslip_studies.effective_friction.study import EffectiveFriction

BASE = evolve(
    load_scene("1032930-70C"),
    {
        "accuracy.slices": "auto",
        "study.effective-friction": {
            "points": 11,
            "map_points": 0,
            "max_cage_slip": 0.9,
            "closure": "epicyclic",
            "skidding_range": 0.0,
        },
    },
)
#: Films so thick that asperities do not touch.
SMOOTH = {
    f"surface.{part}_roughness": "10 nm" for part in ("inner_raceway", "outer_raceway", "roller")
}
#: Held against this where the tolerance is at least 1e-3: it differs by up to 4e-5 from 301 slices at 32 positions.
FINE = Resolution(slices=151, n_positions=20)


def cheap(x):
    """Whether a scene is quickly computed, and its tolerance at least 1e-3."""
    traction = str(pick(TRACTIONS, x[10]))
    return x[12] < 1 / 3 and x[8] < 15 / 16 and "maxwell" not in traction


@pytest.mark.slow
@pytest.mark.parametrize(
    "k", [*range(2), *(pytest.param(k, marks=pytest.mark.soak) for k in range(2, 12))]
)
def test_a_plan_keeps_the_error_that_a_scene_states(k):
    x = [x for x in points(128) if cheap(x)][k]
    verdict = judge(scene(x), FINE)
    assert not verdict.refused
    assert verdict.kept, (verdict.tolerance, verdict.actual, verdict.resolution)


@pytest.mark.soak
@pytest.mark.parametrize("k", range(200))
def test_a_plan_keeps_its_word_against_the_finest(k):
    verdict = judge(scene(points(200)[k]))
    if verdict.refused:
        pytest.skip(verdict.refused)
    assert verdict.kept, (verdict.tolerance, verdict.actual, verdict.resolution)


@pytest.mark.quick
def test_a_smaller_tolerance_takes_more_slices_and_instants():
    chosen = [
        plan(evolve(BASE, {"accuracy.tolerance": t}), STUDY).choices[STUDY]
        for t in (1e-2, 1e-3, 1e-4)
    ]
    for coarse, fine in itertools.pairwise(chosen):
        assert fine.resolution.slices > 2 * coarse.resolution.slices
        assert fine.resolution.n_positions > coarse.resolution.n_positions
        assert fine.total["critical_slip"] < coarse.total["critical_slip"]
    for one, tolerance in zip(chosen, (1e-2, 1e-3, 1e-4), strict=True):
        assert max(one.total.values()) <= tolerance


@pytest.mark.quick
def test_a_tolerance_of_a_result_is_its_own():
    strict = plan(evolve(BASE, {"accuracy.critical_slip": 1e-5}), STUDY).choices[STUDY]
    assert strict.resolution.slices > plan(BASE, STUDY).choices[STUDY].resolution.slices
    assert strict.total["critical_slip"] <= 1e-5


@pytest.mark.quick
def test_exact_is_the_finest_of_everything():
    made = plan(evolve(BASE, {"accuracy.tolerance": "exact"}), STUDY)
    assert made.choices[STUDY].resolution == reference_resolution(BASE)
    assert made.choices[STUDY].left_out == ()


@pytest.mark.quick
def test_fixed_slices_stay():
    made = plan(evolve(BASE, {"accuracy.slices": 33}), STUDY)
    assert made.assemblies[STUDY].slices == 33
    (row,) = (part for part in made.parts if part.part == "slices")
    assert "accuracy.slices fixes" in row.reason
    coarse = execute(
        plan(evolve(BASE, {"accuracy.slices": 5, "accuracy.tolerance": 1e-4}), STUDY), STUDY
    )
    assert "raise accuracy.slices" in " ".join(json.loads(coarse.attrs["warnings"]))


@pytest.mark.quick
def test_one_slice_serves_where_the_load_is_even():
    straight = evolve(BASE, {"bearing.profile": "none"})
    study = EffectiveFriction(points=11, map_points=0)
    one = study.run(assemble(straight, Resolution(slices=9, n_positions=2)))
    circular = evolve(
        BASE, {"bearing.profile": {"shape": "circular", "radius": 1e7}}, si=True
    )  # a drop of 3e-12 m
    nine = study.run(assemble(circular, Resolution(slices=9, n_positions=2)))
    assert (one.attrs["slices"], nine.attrs["slices"]) == (1, 9)
    np.testing.assert_allclose(nine.effective_friction, one.effective_friction, rtol=1e-5)


@pytest.mark.quick
def test_unloaded_contacts_take_no_part():
    """The mean by force over all slices is that over the loaded ones: the others weigh nothing."""
    assembly = assemble(BASE, Resolution(slices=9, n_positions=2))
    raceways = EffectiveFriction(closure="epicyclic", map_points=0).loaded(assembly, 2)
    slip = np.array([0.1, 0.5])
    speeds = assembly.kinematics.surface_speeds(slip, 0.0)
    load = raceways.distribution.inner_load.ravel()
    assert 0 < np.count_nonzero(load) < load.size
    force = (raceways.distribution.inner_load * assembly.widths).ravel()
    for k, found in enumerate(raceways.curve(slip)[0]):
        least = np.where(load > 0.0, load, load[load > 0.0].min())
        friction = assembly.inner.evaluate(
            least, speeds.inner_rolling[k], speeds.inner_sliding[k]
        ).friction
        assert found == pytest.approx(friction @ force / force.sum(), rel=1e-12)


@pytest.mark.quick
def test_boundary_friction_is_left_out_of_full_films_without_a_trace():
    made = plan(evolve(BASE, SMOOTH, si=True), STUDY)
    assert not made.choices[STUDY].resolution.boundary
    assert made.assemblies[STUDY].traction.name == "muraki"
    result = execute(made, STUDY)
    whole = made.at(STUDY, attrs.evolve(made.choices[STUDY].resolution, boundary=True))
    assert whole.assemblies[STUDY].traction.name == "lambda-blend"
    assert np.array_equal(result.effective_friction, execute(whole, STUDY).effective_friction)
    assert json.loads(result.attrs["reinstated"]) == []


@pytest.mark.quick
def test_boundary_friction_is_taken_back_in_where_a_film_is_thin():
    """A plan that leaves it out of the rough bearing breaks its bound; the result is that of one that did not."""
    honest = plan(evolve(BASE, {"surface.inner_raceway_roughness": "0.6 um"}), STUDY)
    assert honest.choices[STUDY].resolution.boundary
    left_out = (BoundaryFriction(1.5),)
    chosen = attrs.evolve(honest.choices[STUDY], left_out=left_out)
    wrong = attrs.evolve(honest, choices={STUDY: chosen}).at(
        STUDY, attrs.evolve(chosen.resolution, boundary=False)
    )
    result = execute(wrong, STUDY)
    unguarded = execute(honest, STUDY)
    assert np.array_equal(result.effective_friction, unguarded.effective_friction)
    (said,) = json.loads(result.attrs["reinstated"])
    assert "boundary friction was left out, but a film parameter of" in said
    assert json.loads(result.attrs["resolution"])["boundary"]


@pytest.mark.quick
def test_a_closed_form_serves_only_within_its_bounds():
    traction = {"model": "maxwell-eyring"}
    stiff = {
        "models.traction": traction,
        "lubricant.shear_modulus": "1 GPa",
        "lubricant.eyring_stress": "10 MPa",
    }
    named = evolve(
        BASE,
        stiff | {"study.effective-friction.max_cage_slip": 1e-4, "accuracy.tolerance": 2e-2},
        si=True,
    )
    made = plan(named, STUDY)
    resolution = made.choices[STUDY].resolution
    if resolution.traction == "named":
        pytest.fail(
            f"the closed form should serve at this little slip: {made.choices[STUDY].errors}"
        )
    result = execute(made, STUDY)
    exact = execute(made.at(STUDY, attrs.evolve(resolution, traction="named")), STUDY)
    scale = np.abs(exact.effective_friction).max("cage_slip")
    assert (
        float((np.abs(result.effective_friction - exact.effective_friction) / scale).max()) <= 2e-3
    )
    assert plan(evolve(BASE, stiff, si=True), STUDY).choices[STUDY].resolution.traction == "named"
    law = get_model("traction", "maxwell-eyring")
    most = {"strain_rate": 1e-9, "deborah": 1.0, "heating": 1e9}
    tight = attrs.evolve(made.choices[STUDY], left_out=(ExactLaw(law, most),))
    again = execute(attrs.evolve(made, choices={STUDY: tight}).at(STUDY, resolution), STUDY)
    assert np.array_equal(again.effective_friction, exact.effective_friction)
    assert "a strain rate of" in json.loads(again.attrs["reinstated"])[0]


@pytest.mark.parametrize("flash", [0.97, 1.001])
def test_a_law_says_the_groups_in_which_its_closed_form_departs_from_it(flash):
    """sigma = 2.5, D = 0.02, Phi = 0.1 of round numbers by hand, but for the flash temperature of the surfaces."""
    conditions = Conditions(
        eyring_stress=4e6, shear_modulus=5e5, effusivity=13000.0, conductivity=0.12, roughness=1e-7
    )
    slices = Slices(
        2,
        conditions,
        film_viscosity=1.0,
        film_thermoviscosity=np.array([0.04, 0.02]),
        film_thickness=1e-6,
        half_width=1e-4,
        rolling_speed=np.array([1.0, 0.5]),
        sliding_speed=np.array([0.5, -10.0]),
    )
    law = get_model("traction", "maxwell-eyring", flash=flash)
    extremes = Extremes(law)
    extremes(slices)
    zeta = flash * math.sqrt(1e-4 / math.pi) / 13000.0 + 1e-6 / (12 * 0.12)
    assert extremes.groups == pytest.approx(
        {"strain_rate": 2.5, "deborah": 0.02, "heating": 0.04 * zeta * 1.6e7}
    )
    assert Extremes(get_model("traction", "muraki")).groups == {}
    ExactLaw(law, extremes.groups)(slices)
    with pytest.raises(
        BoundBrokenError,
        match=r"'maxwell-eyring' was left out, but a deborah of 0\.02 is above 0\.019",
    ):
        ExactLaw(law, extremes.groups | {"deborah": 0.019})(slices)


@pytest.mark.quick
def test_a_bound_is_watched_at_every_evaluation():
    bound = BoundaryFriction(1.5)
    watched = assemble(BASE, Resolution(slices=5)).with_bounds(bound)
    with pytest.raises(BoundBrokenError, match=r"is below 1\.5; it was reinstated") as caught:
        watched.inner.evaluate(np.full(3, 1e5), 1.0, 0.1)
    assert caught.value.bound is bound
    watched.inner.evaluate(np.full(3, 1e3), 60.0, 0.1)
    assert watched.at(Resolution(slices=9)).inner.chain.bounds == (bound,)


@pytest.mark.slow
def test_a_result_says_what_was_estimated_and_found():
    made = plan(BASE, STUDY)
    result = execute(made, STUDY)
    rows = {row["result"]: row for row in json.loads(result.attrs["accuracy"])}
    assert rows.keys() == {"friction", "critical_slip", "film parameter"}
    assert all(
        row["how"] == "a posteriori" and row["found"] <= row["tolerance"] for row in rows.values()
    )
    verified = verify(made, STUDY, result)
    for row in json.loads(verified.attrs["accuracy"]):
        assert row["how"] == "against the finest"
        assert (
            row["result"] == "film parameter"
            or row["found"] <= row["estimated"] <= row["tolerance"]
        )
    assert verified.drop_attrs().identical(result.drop_attrs())
    assert set(json.loads(result.attrs["cost"])) == {"estimated", "actual"}


def test_a_broken_word_is_told_and_so_is_a_critical_slip_that_only_one_of_both_results_has():
    """The error of that slip is no number, so that it would be left out among those that are."""
    coarse = plan(BASE, STUDY).at(STUDY, Resolution(slices=5, n_positions=1))
    result = execute(coarse, STUDY, fixed_resolution=True)
    result["critical_cage_slip"][:] = np.nan
    texts = json.loads(verify(coarse, STUDY, result).attrs["warnings"])
    broken = "more than the tolerance of 0.001; run with a smaller accuracy."
    assert any(text.startswith("friction errs by") and broken in text for text in texts)
    one = "critical slip has a value either here or in the finer result, but not in both"
    assert any(text.startswith(one) for text in texts)


@pytest.mark.quick
def test_only_what_changes_is_shown():
    assert changed(plan(BASE, STUDY), plan(BASE, STUDY)) == []
    other = plan(evolve(BASE, {"bearing.profile": "none", "models.film": "dowson-1968"}), STUDY)
    parts = {one.part: (one, two) for one, two in changed(plan(BASE, STUDY), other) if one and two}
    assert {"film", "slices"} <= parts.keys()
    assert "contact" not in parts
    assert parts["film"][1].choice.startswith("dowson-1968")


@pytest.mark.quick
def test_what_cannot_be_estimated_is_left_to_the_run():
    """No roller is loaded on the inner ring: the plan is printed, the run says why there is no result."""
    idle = evolve(BASE, {"operation.radial_load": 0.0, "bearing.radial_clearance": "50 um"})
    made = plan(idle, STUDY)
    assert "no roller is loaded" in made.choices[STUDY].failed
    with pytest.raises(rollslip.errors.SceneError, match="no roller is loaded"):
        execute(made, STUDY)


def test_a_bound_is_that_of_the_largest_error():
    bound = ErrorBound.from_samples(
        (2, 4, 8), [(np.array([[size]]), np.zeros(0)) for size in (1.01, 1.005, 1.0)]
    )
    assert bound.constants["friction"] == pytest.approx(
        max(4e-2 / (1 - 1 / 16), 8e-2 / (1 - 1 / 4))
    )
    assert bound.required_points({"friction": 1e-4}) == pytest.approx(
        (bound.constants["friction"] / 1e-4) ** 0.5
    )
    one = (np.array([[1.0, 2.0]]), np.array([0.1]))
    two = (np.array([[1.0, 2.2]]), np.array([np.nan]))
    assert sample_errors(one, one) == {"friction": 0.0, "critical_slip": 0.0}
    assert sample_errors(two, one) == {"friction": pytest.approx(0.1), "critical_slip": np.inf}


@pytest.mark.soak
def test_a_followed_branch_is_watched_too():
    """Slips followed to where the bearing is so hot that its films are thin: what was left out is taken back in."""
    cool = evolve(
        BASE,
        {
            "bearing.profile": "none",
            "study.steady-slip": {
                "points": 6,
                "max_cage_slip": 0.3,
                "temperature": ["70 degC", "110 degC"],
            },
            **{
                f"surface.{part}_roughness": "0.19 um"
                for part in ("inner_raceway", "outer_raceway", "roller")
            },
        },
        si=True,
    )
    made = plan(cool, "steady-slip")
    assert not made.choices["steady-slip"].resolution.boundary
    result = execute(made, "steady-slip")
    assert "boundary friction was left out" in json.loads(result.attrs["reinstated"])[0]
    assert json.loads(result.attrs["resolution"])["boundary"]


#: Slow, heavy and cold: films of the dry contact's pressure, and inlets that hardly warm.
HEAVY = evolve(
    BASE,
    SMOOTH
    | {
        "operation.inner_speed": "40 rpm",
        "operation.radial_load": "60 kN",
        "models.pressure": "light-contact",
        "models.film": {"model": "inlet-correction", "thermal": "murch-wilson"},
        "models.traction": {"model": "muraki"},
        "bearing.profile": "none",
        "study.effective-friction.max_cage_slip": 0.5,
    },
    si=True,
)
PARTS = {
    "inlet_heating": ("thermal inlet shear", InletHeating),
    "light_contacts": ("pressure", LightContacts),
}


def kept(made):
    return {name for name in PARTS if getattr(made.choices[STUDY].resolution, name)}


@pytest.mark.parametrize("tolerance", [1e-2, 3e-2])
@pytest.mark.parametrize(
    ("speed", "load"), [("40 rpm", "60 kN"), ("400 rpm", "20 kN"), ("4000 rpm", "3 kN")]
)
def test_what_moves_no_value_by_a_fifth_of_the_tolerance_is_left_out(speed, load, tolerance):
    changes = {
        "accuracy.tolerance": tolerance,
        "operation.inner_speed": speed,
        "operation.radial_load": load,
    }
    heavy = evolve(HEAVY, changes, si=True)
    made = plan(heavy, STUDY)
    result = execute(made, STUDY)
    whole = made.at(
        STUDY,
        attrs.evolve(made.choices[STUDY].resolution, inlet_heating=True, light_contacts=True),
    )
    for name, (part, bound) in PARTS.items():
        without = attrs.evolve(whole.choices[STUDY].resolution, **{name: False})
        own = execute(whole, STUDY).effective_friction.to_numpy()
        less = execute(whole.at(STUDY, without), STUDY).effective_friction.to_numpy()
        moved = float(np.abs(less[own != 0.0] / own[own != 0.0] - 1.0).max())
        lines = [one for one in made.parts if one.part == part and one.study == STUDY]
        if name in kept(made):
            assert moved > 0.03 * tolerance, "it should have been left out"
            assert not lines
        else:
            assert moved <= 0.2 * tolerance
            assert not lines[0].included
            assert any(isinstance(one, bound) for one in made.choices[STUDY].left_out)
    assert json.loads(result.attrs["reinstated"]) == []
    if speed == "40 rpm":
        assert not kept(made), "of a slow and heavy bearing neither is needed"
    if speed == "4000 rpm":
        assert kept(made) == {*PARTS}, "of a fast one both"


@pytest.mark.parametrize(("name", "bound", "said"), [
    ("inlet_heating", InletHeating(1e-9), "the heat of the inlet was left out, but a thermal load of"),
    ("light_contacts", LightContacts(1e9), "the pressure of light contacts was left out, but a mean load parameter of"),
])  # fmt: skip
def test_what_was_left_out_is_taken_back_in_beyond_its_bound(name, bound, said):
    fast = evolve(HEAVY, {"operation.inner_speed": "2000 rpm"})
    honest = plan(fast, STUDY)
    chosen = attrs.evolve(honest.choices[STUDY], left_out=(bound,))
    less = attrs.evolve(chosen.resolution, **{name: False})
    wrong = attrs.evolve(honest, choices={STUDY: chosen}).at(STUDY, less)
    result = execute(wrong, STUDY)
    assert np.array_equal(result.effective_friction, execute(honest, STUDY).effective_friction)
    (told,) = json.loads(result.attrs["reinstated"])
    assert said in told


def test_a_bound_leaves_room_for_the_slips_of_a_run_and_not_for_half_as_much_again():
    """Beyond what the probe of a plan meets: other slips need a little, and the error grows by as much."""
    made = plan(evolve(HEAVY, {"accuracy.tolerance": 3e-2}), STUDY)
    coarse = coarse_assembly(made.assembly)
    met = Extremes(coarse.traction.full_film)
    Probe(made.studies[STUDY], coarse).sample(coarse.with_bounds(met), 1)
    bounds = {type(bound): bound for bound in made.choices[STUDY].left_out}
    assert 1.0 < bounds[InletHeating].max_thermal_load / met.hottest < 1.5
    assert 1.0 < met.lightest / bounds[LightContacts].min_mean_load < 1.5


def test_models_that_are_compared_keep_all_their_parts():
    heavy = evolve(HEAVY, {"accuracy.tolerance": 0.09})
    assert kept(plan(heavy, STUDY, cheaper_laws=False)) == {*PARTS}


def test_mistakes_of_studies_oil_and_cage_are_told_at_once():
    wrong = {
        "study.steady-slip.poins": 3,
        "study.dyn": {},
        "lubricant": "nope",
        "cage.mas": 3,
        "models.film": "mos",
    }
    with pytest.raises(SceneError) as caught:
        plan(evolve(load_scene("gearbox"), wrong, si=True))
    told = " ".join(caught.value.problems)
    parts = (
        "steady-slip.poins",
        "study.dyn:",
        "no lubricant is called 'nope'",
        "cage.mas",
        "no film is called 'mos'",
    )
    assert [told.count(part) for part in parts] == [1] * len(parts)
