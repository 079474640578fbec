"""Study rating-life: lives of a whole bearing over load, clearance and tilt, what it says, and the largest load."""

import math

import attrs
import numpy as np
import pytest

import rollslip
from rollslip.bearing.assembly import assemble
from rollslip.catalogue.registry import get_model
from rollslip.errors import PluginError, SceneError
from rollslip.results.accounts import account_of
from rollslip.results.text import format_hours
from rollslip.scene.changes import evolve
from rollslip.scene.reading import load_scene
from rollslip.studies.rating_life.largest_load import HOURS, STATIC_SAFETY, largest_load
from rollslip.studies.rating_life.model import LifeDuty, fatigue_load_limit
from rollslip_studies.rating_life.study import RatingLife

GEARBOX = load_scene("gearbox")
LOADED = {"operation.radial_load": "40 kN"}


def lives(changes=None, scene=GEARBOX):
    """The result of a bearing, without a plan."""
    assembly = assemble(evolve(scene, LOADED | (changes or {})))
    study = RatingLife.from_scene(assembly.scene)
    return study.run(assembly.at(study.choose_resolution(assembly).resolution))


def reference_life(**changes):
    return float(lives({name.replace("__", "."): value for name, value in changes.items()}).life[1])


def test_the_life_by_iso_281_is_that_of_rating_load_and_speed():
    result = lives({"bearing.catalogue.dynamic_rating": "260 kN"})
    assert float(result.life[0]) == pytest.approx(1e6 * 6.5 ** (10 / 3), rel=1e-12)
    # 1500 revolutions a minute
    assert float(result.life_time[0]) == pytest.approx(1e6 * 6.5 ** (10 / 3) * 60 / 1500, rel=1e-12)
    assert float(result.load_ratio[0]) == pytest.approx(6.5, rel=1e-12)
    assert result.rating_source.item() == "the catalogue"


def test_revolutions_are_those_of_the_rings_relative_to_each_other():
    one = lives({"operation.inner_speed": "1500 rpm"})
    both = lives({"operation.inner_speed": "1000 rpm", "operation.outer_speed": "-500 rpm"})
    assert float(one.life_time[0]) == pytest.approx(float(both.life_time[0]), rel=1e-12)


def test_more_load_shortens_both_lives():
    found = [lives({"operation.radial_load": load}).life for load in ("20 kN", "40 kN", "80 kN")]
    assert np.all(np.diff(found, axis=0) < 0.0)


def test_more_clearance_and_preload_shorten_the_reference_life():
    clearances = ("-60 um", "-10 um", "0 um", "30 um", "100 um")
    tight, little, none, normal, loose = (reference_life(bearing__radial_clearance=c) for c in clearances)  # fmt: skip
    assert loose < normal < none < little
    assert tight < little


def test_more_tilt_shortens_the_reference_life_alone():
    tilts = ("0 mrad", "0.5 mrad", "1 mrad", "2 mrad", "-2 mrad")
    results = [lives({"operation.misalignment": tilt}) for tilt in tilts]
    found = [float(result.life[1]) for result in results]
    assert found[0] > found[1] > found[2] > found[3]
    assert found[3] == pytest.approx(found[4], rel=1e-6)
    assert len({float(result.life[0]) for result in results}) == 1


def test_a_straight_roller_lasts_longer_without_edge_stress_than_a_profiled_one():
    profiled = {"models.life": [{"model": "iso16281", "edge_stress": False}]}
    straight = profiled | {"bearing.profile.shape": "none"}
    assert float(lives(straight).life[0]) > float(lives(profiled).life[0])


def test_the_ring_that_turns_relative_to_the_load_follows_from_the_scene():
    for speeds, turning in (
        ({}, (True, False)),
        ({"operation.inner_speed": "0 rpm", "operation.outer_speed": "1500 rpm"}, (False, True)),
        ({"operation.outer_speed": "-100 rpm"}, (True, True)),
    ):
        assert LifeDuty.of(assemble(evolve(GEARBOX, speeds))).turning == turning


@pytest.mark.parametrize("tilt", ["0 mrad", "1 mrad"])
def test_in_the_range_of_the_edge_factor_slices_of_the_standard_lead_to_the_same_life(tilt):
    """A profiled roller under 0.15 C0: 41 equal slices, with the factor as it is written, against the integral."""
    assembly = assemble(evolve(GEARBOX, LOADED | {"operation.misalignment": tilt}))
    equal = attrs.evolve(assembly.resolution, slices=41, quadrature="equal", n_positions=4)
    duty = LifeDuty.of(assembly.at(equal))
    place = np.abs(2 * np.arange(1, 42) - 42) / 80
    factor = 1.0 - 0.01 / np.log(1.985 * np.maximum(place, 1e-12))
    as_written = get_model("life", "iso16281", edge_stress=False).rate(
        attrs.evolve(duty, load=duty.load * factor)
    )
    own = lives({"operation.misalignment": tilt}).life[1]
    assert as_written.revolutions == pytest.approx(float(own), rel=0.01)


@pytest.mark.parametrize(
    "changes",
    [{}, {"operation.misalignment": "1 mrad"}, {"bearing.radial_clearance": "-10 um"}],
)
def test_few_slices_and_positions_are_enough(changes):
    assembly = assemble(evolve(GEARBOX, LOADED | changes))
    many = attrs.evolve(assembly.resolution, slices=600, n_positions=16)
    study = RatingLife()
    fine = study.run(assembly.at(many))
    own = lives(changes)
    assert float(own.life[1]) == pytest.approx(float(fine.life[1]), rel=2e-3)
    assert float(own.modified_life_time[1]) == pytest.approx(float(fine.modified_life_time[1]), rel=5e-3)  # fmt: skip
    errors = study.value_errors(assembly.at(many), own)
    assert errors["rating life, ISO/TS 16281"] == pytest.approx(
        abs(float(own.life[1] / fine.life[1]) - 1.0), rel=1e-9
    )
    assert errors["rating life, ISO 281"] == 0.0


def test_damage_along_the_roller_adds_up():
    result = lives({"operation.misalignment": "1 mrad"})
    x = result.position.to_numpy()
    weights = 0.5 * GEARBOX.bearing.roller_length * np.polynomial.legendre.leggauss(x.size)[1]
    assert float((result.damage[1] * weights).sum()) == pytest.approx(1.0, rel=1e-12)
    assert float(result.ring_damage[1].sum()) == pytest.approx(1.0, rel=1e-12)
    assert np.isnan(result.damage[0]).all()
    assert "does not say" in str(result.damage_status[0, 0].item())
    # the tilt shifts damage and loads to the same end
    inner = result.damage[1, 0].to_numpy()
    load = result.largest_line_load[0].to_numpy()
    assert (inner[x > 0].sum() - inner[x < 0].sum()) * (load[x > 0].sum() - load[x < 0].sum()) > 0.0


# Lubrication ----------------------------------------------------------------------------------------------------------


def test_cleaner_and_thicker_oil_lengthens_the_modified_life():
    for key, values in (
        ("study.rating-life.contamination_factor", (0.1, 0.5, 1.0)),
        ("operation.temperature", ("110 degC", "80 degC", "60 degC")),
    ):
        found = [lives({key: value}).modified_life_time.to_numpy() for value in values]
        assert np.all(np.diff(found, axis=0) > 0.0)


def test_the_modification_takes_kappa_and_the_fatigue_load_limit_of_the_bearing():
    result = lives()
    kappa = float(result.viscosity_ratio)
    limit = fatigue_load_limit(GEARBOX.bearing)
    ratio = 0.5 * limit / 4e4
    expected = 0.1 * (1.0 - (1.5859 - 1.2348 / kappa**0.071739) * ratio**0.4) ** -9.185
    assert 1.0 < kappa < 4.0
    assert float(result.modification_factor[0]) == pytest.approx(expected, rel=1e-12)
    assert float(result.fatigue_load_limit) == pytest.approx(limit, rel=1e-12)


def test_without_density_or_below_the_smallest_kappa_a_life_is_not_modified():
    thin = lives({"operation.inner_speed": "1 rpm"})
    assert np.isnan(thin.modified_life_time).all()
    assert "below 0.1" in str(thin.modified_status[0].item())
    assert np.isfinite(thin.life).all()


# The largest load -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("tilt", ["0 mrad", "1 mrad"])
def test_the_largest_load_has_the_life_asked_for(tilt):
    changes = {"study.rating-life.hours": 2e4, "operation.misalignment": tilt}
    loads = lives(changes).largest_load.to_numpy()
    for k in (0, 1):
        there = lives(
            {"operation.radial_load": f"{float(loads[k])!r} N", "operation.misalignment": tilt}
        )
        assert float(there.life_time[k]) / 3600.0 == pytest.approx(2e4, rel=1e-5)


def test_without_hours_no_load_is_searched():
    result = lives()
    assert np.isnan(result.largest_load).all()
    assert str(result.load_status[0].item()) == "study.rating-life.hours is not given"


# What is said ---------------------------------------------------------------------------------------------------------


def test_the_answer_opens_with_its_number():
    result = rollslip.run(
        evolve(GEARBOX, LOADED | {"study.rating-life.hours": 20000}), "rating-life"
    )
    lines = str(rollslip.answer(result)).split("\n")
    assert lines[0] == "rating life 3,300 h (ISO/TS 16281: 8,100 h), C/P 5.5"
    assert len(lines) <= 15
    assert any("largest load" in line for line in lines)
    assert any("contamination factor e_C 0.5" in line for line in lines)


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"operation.radial_load": "200 kN"}, "above 0.5 C0 raceways yield"),
        ({"operation.radial_load": "1 kN"}, "below 0.02 C rollers may slide"),
        ({"operation.misalignment": "1.5 mrad"}, "the tilt is above 4'"),
        ({"bearing.profile.shape": "none"}, "straight rollers have more edge stress"),
        ({"models.separator": "none"}, "rollers of a full complement rub on each other"),
    ],
)
def test_where_the_standards_do_not_hold_is_said(changes, text):
    assert text not in str(lives().life_limits.item())
    result = lives(changes)
    assert text in str(result.life_limits.item())
    account = account_of(result)
    assert any(text in fault for fault in account.answer(result).faults)
    assert any(text in sentence for sentence in account.topics(result)["limits"])


def test_without_radial_load_iso_281_has_no_life_and_rollers_press_on_the_outer_ring():
    result = lives({"operation.radial_load": "0 N"})
    assert np.isnan(result.life[0])
    assert "no radial load" in str(result.life_status[0].item())
    assert float(result.ring_damage[1].sel(ring="outer")) == 1.0
    account = account_of(result)
    assert account.answer(result).summary.startswith("no rating life: ISO 281 has no finite life")
    assert account.topics(result)["rating life"][0] == (
        "life, ISO 281: not found, has no finite life: there is no radial load"
    )


def test_hours_have_two_digits():
    assert format_hours(3600.0 * 34210.0) == "34,000 h"
    assert format_hours(3600.0 * 0.123) == "0.12 h"
    assert format_hours(math.nan) == "not found"
    assert format_hours(3600.0 * 1.1e6) == "above 1,000,000 h"
    assert format_hours(math.inf) == "above 1,000,000 h"


def test_a_contamination_factor_that_a_scene_states_is_not_assumed():
    stated = rollslip.run(
        evolve(GEARBOX, {"study.rating-life.contamination_factor": 0.3}), "rating-life"
    )
    assert stated.answer.assumed == ()
    assert rollslip.run(GEARBOX, "rating-life").answer.assumed == ("contamination factor e_C 0.5",)


def test_a_plan_has_loads_and_models_and_no_friction():
    planned = rollslip.plan(GEARBOX, "rating-life")
    named = [part.part for part in planned.parts]
    assert named.count("life") == 2
    assert "boundary friction" not in named


def test_wrong_settings_are_refused():
    for key, value in (("contamination_factor", 1.5), ("hours", -1.0)):
        with pytest.raises(SceneError, match=key):
            rollslip.run(evolve(GEARBOX, {f"study.rating-life.{key}": value}), "rating-life")
    with pytest.raises(PluginError, match="iso999"):
        assemble(evolve(GEARBOX, {"models.life": ["iso999"]}))
    with pytest.raises(SceneError, match=r"models\.life: Length"):
        lives({"models.life": []})


def test_its_figure_has_damage_and_load_of_both_rings():
    [(name, caption, figure)] = account_of(result := lives()).figures(result)
    assert name == "life-iso16281"
    assert "ISO/TS 16281" in caption
    assert [axes.get_ylabel().split("\n")[0] for axes in figure.axes] == ["Damage", "Largest load"]
    assert [len(axes.lines) for axes in figure.axes] == [2, 2]


def test_the_largest_load_is_that_of_the_study_or_of_the_static_rating():
    scene = load_scene("gearbox")
    changes = {"study.rating-life.hours": HOURS, "models.life": ["iso281"]}
    by_study = rollslip.run(evolve(scene, changes, si=True), "rating-life")
    assert largest_load(scene) == {
        "largest_load": pytest.approx(float(by_study.largest_load[0]), rel=1e-6),
        "largest_load_limit": "20,000 h by ISO 281",
    }
    slow = evolve(scene, {"operation.inner_speed": 1e-3}, si=True)
    assert largest_load(slow) == {
        "largest_load": scene.bearing.static_rating / STATIC_SAFETY,
        "largest_load_limit": "static rating over 1.5",
    }
