"""Choices that a scene leaves open: which these are, what the alternatives make of the slip, and who pays for it."""

import json

import pytest

import rollslip
from rollslip.scene.changes import assumed_keys
from rollslip_studies.steady_slip import band
from rollslip_studies.variation.choices import open_choices

CASE = {"oil": "iso-vg-320", "speed": "400 rpm", "load": "1 kN", "temperature": "60 degC"}


def scene(bearing="NU 2316", changes=None, **given):
    return rollslip.evolve(rollslip.new(bearing, **CASE, **given), changes or {})


def labels(of):
    return [choice.label for choice in open_choices(of)]


EVERY = ["profile", "rollers", "supply", "surface", "cage", "clearance class", "fits"]


@pytest.mark.quick
@pytest.mark.parametrize(
    ("closed", "bearing", "given", "changes"),
    [
        ([], "NU 2316", {}, {}),
        (["profile"], "NU 2316", {"profile": "log"}, {}),
        (["profile"], "NU 2316", {}, {"bearing.profile": "none"}),
        (["profile"], "NU 2316", {}, {"bearing.profile": "iso16281"}),
        (["cage"], "NU 2316", {"cage": "brass"}, {}),
        (["cage"], "NU 2316 ECM", {}, {}),
        (["cage"], "NU 2316", {}, {"cage.mass": "200 g"}),
        (["cage"], "NCF 2216 V", {}, {}),
        (["supply"], "NU 2316", {"supply": "bath"}, {}),
        (["supply"], "NU 2316", {}, {"lubrication.supply": "bath"}),
        (["clearance class"], "NU 2316/C3", {}, {}),
        (["clearance class"], "NU 2316", {}, {"bearing.clearance_class": "CN"}),
        (["clearance class"], "NU 2316", {}, {"bearing.mounting.initial_clearance": "50 um"}),
        (["clearance class", "fits"], "NU 2316", {}, {"bearing.radial_clearance": "20 um"}),
        (["rollers"], "NU 2316", {}, {"bearing.rollers": 13}),
        (["surface"], "NU 2316", {}, {"surface.name": "ground"}),
        (["clearance class", "fits", "rollers"], "1032930", {}, {}),
    ],
)  # fmt: skip
def test_a_choice_is_open_unless_scene_designation_or_data_make_it(closed, bearing, given, changes):
    assert labels(scene(bearing, changes, **given)) == [one for one in EVERY if one not in closed]


@pytest.mark.quick
def test_one_fit_that_is_stated_leaves_the_other_open():
    changed = scene(changes={"bearing.mounting.shaft_fit": "n6"})
    (fits,) = (choice for choice in open_choices(changed) if choice.label == "fits")
    assert [*fits.alternatives] == ["N7 in the housing"]


@pytest.mark.quick
def test_every_alternative_differs_from_the_scene_and_has_a_grade_and_a_source():
    made = scene()
    for choice in open_choices(made):
        assert choice.grade in ("(B)", "(C)", "(D)")
        assert choice.source
        for name, changes in choice.alternatives.items():
            assert name != choice.present
            assert rollslip.evolve(made, changes, si=True) != made


@pytest.mark.quick
def test_values_that_rollslip_new_assumed_are_chosen_once_they_are_changed():
    made = rollslip.new("NU 2316", cage="steel")
    keys = {"lubricant.name", "operation.inner_speed", "operation.radial_load", "operation.temperature",
            "lubrication.supply", "bearing.profile"}  # fmt: skip
    assert {*assumed_keys(made)} == keys
    changed = rollslip.evolve(made, {"lubrication.supply": "bath", "lubricant": {"name": "fva-3"}})
    assert {*assumed_keys(changed)} == keys - {"lubrication.supply", "lubricant.name"}
    # the default scatter of an assumed profile is that of one which the scene does not state
    assert assumed_keys(rollslip.load_scene("gearbox")) == []


@pytest.mark.slow
def test_a_choice_that_makes_the_cage_skid_makes_the_verdict_unknown_and_comes_first(monkeypatch):
    """The example of a bearing that idles in a wind gearbox; slips of whole runs are beside it."""
    coarse = {"accuracy.slices": 21, "accuracy.tolerance": 0.05, "study.steady-slip.points": 9}
    made = scene(changes=coarse)
    evaluated = []
    monkeypatch.setattr(
        band, "open_choices", lambda one: evaluated.append(one) or open_choices(one)
    )
    result = rollslip.run(made, "steady-slip")
    assert not evaluated, "a run without its answer pays nothing"
    answer = result.answer
    assert len(evaluated) == 1
    assert (answer.verdict, answer.rule) == ("UNKNOWN", "V10")
    assert answer.assumed[0].startswith("profile logarithmic; none: slip 2")
    assert answer.assumed[0].endswith(" %, SKIDS")
    assert answer.assumed[1].startswith("cage polyamide; brass: slip 8.7 %, SLIPS")
    slips = {
        choice["label"]: choice["slips"]
        for choice in json.loads(result.complete()["steady-slip"].attrs["choices"])
    }
    for label, name, changes in (
        ("cage", "brass", {"cage.make": "brass"}),
        ("supply", "jet", {"lubrication.supply": "jet"}),
    ):
        planned = rollslip.plan(scene(changes=changes | coarse), "steady-slip")
        # the slip alone, which is that of a run
        variables, _ = planned.studies["steady-slip"].partial_result(
            planned.assemblies["steady-slip"], frozenset({"steady_slip"})
        )
        assert slips[label][name] == pytest.approx(variables["steady_slip"][1][0], rel=0.1)
