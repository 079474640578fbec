"""Error against cost: fronts that are fronts, errors that are errors, runs that can be gone on with, words that fit."""

import json
import os
import re
import shlex
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree as ET
from types import MappingProxyType

import attrs
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import rollslip
from rollslip import evolve, load_scene, open_result, pareto, run
from rollslip.bearing.assembly import assemble
from rollslip.bearing.resolution import reference_resolution
from rollslip.catalogue import discovery
from rollslip.cli import main
from rollslip.errors import OutputError, PluginError, SceneError
from rollslip.models import FilmModel, TractionModel
from rollslip.results.accounts import account_of
from rollslip.results.dataset import save
from rollslip.results.report import write_report
from rollslip.results.style import STYLE
from rollslip.results.text import duration_range
from rollslip.studies.study import AXES
from rollslip_campaigns.pareto import ParetoSettings, candidates
from rollslip_campaigns.pareto import figures as front_figures
from rollslip_campaigns.pareto import pareto as fronts
from rollslip_campaigns.pareto.candidates import EXACT, HALF
from rollslip_campaigns.pareto.findings import (
    PLANNED,
    REFERENCE,
    ParetoAccount,
    records,
    results_of,
)
from rollslip_campaigns.pareto.pareto import front, run_family
from rollslip_campaigns.sweep import journal

findings = ParetoAccount.sentences

#: Few slices and slips: quick, and still both rings, a profile and a maximum.
SCENE = evolve(
    load_scene("1032930-30C"),
    {
        "accuracy.slices": 15,
        "bearing.rollers": 12,
        "study.effective-friction.points": 9,
        "study.friction-curve.points": 15,
        "lubricant.pressure_viscosity_factor": 1.3,
    },
)
QUICK = [
    "--set=accuracy.slices=15",
    "--set=study.friction-curve.points=15",
    "--study=friction-curve",
    "--rounds=2",
]


@pytest.fixture(autouse=True)
def _nothing_stays_registered(monkeypatch):
    monkeypatch.setattr(discovery, "_registered", {})


@pytest.fixture(autouse=True, scope="module")
def _one_run_a_turn():
    """What a time is worth is not tested here."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(fronts, "MIN_TURN", 0.0)
        yield


@attrs.frozen
class Refuses(FilmModel):
    """A film that is defined nowhere a bearing gets."""

    name = "refuses"
    equation = "h = nothing"
    references = ("nobody",)
    location = "minimum"
    domain = MappingProxyType({**FilmModel.domain, "load": (1e12, 1e13)})

    def evaluate(self, slices):
        slices.film_thickness[...] = 1e-6


@attrs.frozen
class Raises(TractionModel):
    """A traction model with a mistake in it."""

    name = "raises"
    equation = "mu = 1/0"
    references = ("nobody",)
    reads = frozenset({"sliding_speed"})
    domain = MappingProxyType({})

    def evaluate(self, slices):
        raise ZeroDivisionError("in somebody's model")


@attrs.frozen
class Rising(TractionModel):
    """A friction that only rises, so that there is no slip at largest traction."""

    name = "rising"
    equation = "mu = V/(10 u)"
    references = ("nobody",)
    reads = frozenset({"sliding_speed", "rolling_speed"})
    domain = MappingProxyType({})

    def evaluate(self, slices):
        slices.friction[...] = 0.1 * slices.sliding_speed / slices.rolling_speed


def answer(capsys, *arguments):
    """Exit code, standard output and errors of a command."""
    with pytest.raises(SystemExit) as leave:
        main(["pareto", *map(str, arguments)])
    captured = capsys.readouterr()
    return leave.value.code, captured.out, captured.err


@pytest.fixture(scope="module")
def effective():
    return pareto(
        SCENE, study="effective-friction", choices="slices,n_positions,traction,film", rounds=2
    )


@pytest.fixture(scope="module")
def contact():
    return pareto(SCENE, study="friction-curve", choices=AXES, rounds=2)


# The front ----------------------------------------------------------------------------------------------------------

NUMBERS = st.sampled_from([0.0, 1e-3, 1e-2, 0.5, 1.0, 2.0, np.inf, np.nan])


@given(st.integers(1, 12).flatmap(lambda n: arrays(float, (2, n), elements=NUMBERS)))
def test_nothing_dominates_a_point_of_the_front_and_something_every_other(points):
    cost, error = points
    on = front(cost, error)

    def dominates(a, b):
        return (cost[a] <= cost[b] and error[a] <= error[b]) and (
            cost[a] < cost[b] or error[a] < error[b]
        )

    known = [k for k in range(cost.size) if np.isfinite(cost[k]) and np.isfinite(error[k])]
    for k in range(cost.size):
        assert on[k] == (k in known and not any(dominates(other, k) for other in known))
    assert on.any() == bool(known)


def test_equal_points_are_both_on_the_front():
    assert front(np.array([1.0, 1.0, 2.0]), np.array([0.1, 0.1, 0.1])).tolist() == [
        True,
        True,
        False,
    ]


@pytest.mark.slow
def test_the_fronts_of_a_run_are_fronts_of_its_errors_and_medians(effective):
    for number, on_front, kinds in (
        ("error", "on_front", ["numerical"]),
        ("difference", "on_model_front", ["modelling"]),
    ):
        for j in range(effective.sizes["result"]):
            one = effective.isel(result=j)
            part = np.isin(one.kind, kinds) | (one.label == PLANNED).to_numpy()
            values = np.maximum(one[number].to_numpy()[part], float(one.floor))
            assert np.array_equal(
                one[on_front].to_numpy()[part], front(one.seconds.to_numpy()[part], values)
            )
            assert not one[on_front].to_numpy()[~part].any()


# The family ---------------------------------------------------------------------------------------------------------


def test_the_family_is_told_before_it_runs():
    family = ParetoSettings(SCENE, study="effective-friction", choices="slices,n_positions").plan()
    labels = [one.label for one in family.choices_of("effective-friction", "numerical")]
    # 2 numbers of slices below those stated, crossed with 3 of instants; both alone, and 7 numbers of instants
    assert len(labels) == len(set(labels)) == 1 + 2 * 3 + 2 + 7
    assert labels[0] == PLANNED
    assert [one.label for one in family.choices_of("effective-friction", "reference")] == [
        REFERENCE,
        HALF,
        EXACT,
    ]
    assert "the scene states 15 slices" in family.notes[0]
    assert len(family.notes) == 1
    assert family.choices[0].resolution == reference_resolution(SCENE)


def test_numpy_is_compared_only_where_it_is_named():
    settings = {"scene": SCENE, "study": "friction-curve"}
    default = ParetoSettings(**settings).plan()
    named = ParetoSettings(**settings, choices="compiled").plan()
    assert all(choice.resolution.compiled for choice in default.choices)
    assert "--choices compiled" in default.notes[0]
    assert not named.choices[-1].resolution.compiled
    assert named.notes == ()


@pytest.mark.parametrize("rounds", [1, 3])
def test_the_time_is_estimated_from_rounds_and_resolutions(rounds, monkeypatch):
    monkeypatch.setattr(candidates, "processor_time", lambda work: 2.0)
    family = ParetoSettings(
        SCENE, study="effective-friction", choices="n_positions", rounds=rounds
    ).plan()
    # slices are stated, so that roller positions alone change the time, of which a half is proportional to them
    planned = family.choices_of("effective-friction", "numerical")[0].resolution
    seconds = 0.0
    for choice in family.choices:
        assert choice.resolution.slices == planned.slices
        turn = 1.0 + choice.resolution.n_positions / planned.n_positions
        seconds += turn * (rounds if choice.kind == "numerical" else 1)
    *scope, time_sentence = family.cost_sentences
    assert f"this takes {duration_range(seconds)} of the processor" in time_sentence
    assert "numerical" in scope[0]


def test_slices_that_a_scene_leaves_open_go_on_and_gauss_takes_part():
    family = ParetoSettings(
        evolve(SCENE, {"accuracy.slices": "auto"}), study="friction-curve"
    ).plan()
    found = {
        (one.resolution.slices, one.resolution.quadrature)
        for one in family.choices_of("friction-curve", "numerical")
    }
    assert {(401, "equal"), (101, "gauss")} <= found
    assert not any("the scene states" in note for note in family.notes)


def test_one_slice_a_contact_leaves_no_slices_to_choose():
    family = ParetoSettings(
        evolve(SCENE, {"bearing.profile": "none"}), study="friction-curve", choices=AXES
    ).plan()
    assert [one.label for one in family.choices_of("friction-curve", "numerical")] == [
        PLANNED,
        "in NumPy",
    ]


def test_choices_are_of_what_acts_on_a_result():
    scene = evolve(load_scene("1032930-50C"), {"accuracy.slices": 15})
    family = ParetoSettings(scene).plan()
    assert list(family.studies) == list(scene.study)
    for study, axes in {
        "friction-curve": {"slices", "traction", "film"},
        "effective-friction": {"slices", "n_positions", "traction", "film"},
    }.items():
        planned = family.choices_of(study, "numerical")[0]
        varied = set()
        for one in family.choices_of(study, "numerical", "modelling", "film"):
            here = attrs.asdict(one.resolution)
            there = attrs.asdict(planned.resolution)
            varied |= {key for key in here if here[key] != there[key]} | (
                {"film"} if one.kind == "film" else set()
            )
        assert varied == axes
    moving = {one.label: one for one in family.choices_of("dynamics", "numerical", "modelling")}
    assert {"lsoda, steps to 1e-07", "effective friction"} <= set(moving)
    assert any(label.startswith("tables to ") for label in moving)
    assert moving["effective friction"].kind == "modelling"
    assert family.choices_of("dynamics", "reference")[-1].resolution.friction == "conventional"


@pytest.mark.soak  # plans cage and rollers in motion once for every axis
def test_everything_that_can_be_chosen_is_chosen_somewhere():
    scene = evolve(load_scene("1032930-50C"), {"accuracy.slices": "auto"})
    for axis in AXES:
        family = ParetoSettings(scene, choices=axis).plan()
        assert any(one.label != PLANNED and one.kind != "reference" for one in family.choices), axis


def test_the_exact_law_of_a_law_of_its_own_is_itself():
    scene = evolve(SCENE, {"models.traction": "constant"})
    family = ParetoSettings(scene, study="friction-curve", choices="slices").plan()
    assert [one.label for one in family.choices_of("friction-curve", "reference")] == [
        REFERENCE,
        HALF,
    ]


# Numbers ------------------------------------------------------------------------------------------------------------


def test_the_finest_has_no_error_and_the_exact_model_no_difference(effective, contact):
    for found in (effective, contact):
        one = found.isel(result=0)
        assert float(one.error.sel(choice=REFERENCE)) == 0.0
        assert float(one.difference.sel(choice=EXACT)) == 0.0
        assert max(float(one.error.sel(choice=HALF)), 1e-14) == float(
            one.floor
        )  # no less than rounding
        assert (found.status == "done").all()


def test_errors_are_those_of_runs_by_hand(effective):
    family = ParetoSettings(SCENE, study="effective-friction").plan()
    study = family.studies["effective-friction"]
    by_hand = {
        label: study.run(assemble(one.scene, one.resolution))
        for one in family.choices
        if (label := one.label)
        in (REFERENCE, EXACT, "5 slices, 2 positions", "eyring", "film regime")
    }

    def error(label, against):
        a, b = (by_hand[name].effective_friction for name in (label, against))
        return float((abs(a - b).max("cage_slip") / abs(b).max("cage_slip")).max())

    friction = effective.sel(result="friction")
    assert float(friction.error.sel(choice="5 slices, 2 positions")) == pytest.approx(
        error("5 slices, 2 positions", REFERENCE), rel=1e-12
    )
    for label, against in (("eyring", EXACT), ("film regime", REFERENCE), (REFERENCE, EXACT)):
        assert float(friction.difference.sel(choice=label)) == pytest.approx(
            error(label, against), rel=1e-12
        )
    critical = effective.sel(result="critical slip, inner ring")
    slips = [
        float(by_hand[name].critical_cage_slip.sel(ring="inner"))
        for name in ("5 slices, 2 positions", REFERENCE)
    ]
    assert float(critical.error.sel(choice="5 slices, 2 positions")) == pytest.approx(
        abs(slips[0] / slips[1] - 1)
    )


def test_the_plans_choice_is_what_a_run_computes(contact):
    scene = run(SCENE, "friction-curve")
    best = reference_resolution(SCENE)
    known = (
        ParetoSettings(SCENE, study="friction-curve")
        .plan()
        .studies["friction-curve"]
        .run(assemble(SCENE, best))
    )
    error = (
        abs(scene.friction - known.friction).max("slip") / abs(known.friction).max("slip")
    ).max()
    assert float(contact.error.sel(choice=PLANNED, result="friction")) == pytest.approx(
        float(error), abs=1e-15
    )


def test_numerical_and_modelling_choices_do_not_mix(contact):
    numerical = contact.kind == "numerical"
    models = contact.kind.isin(["modelling", "film"])
    assert contact.error.isel(result=0)[models].isnull().all()
    assert contact.error.isel(result=0)[numerical].notnull().all()
    assert contact.difference.isel(result=0)[models].notnull().all()
    assert not contact.on_front[models].any()
    assert not contact.on_model_front[(contact.kind == "film")].any()


def test_more_slices_have_less_error_and_the_same_law_in_numpy_the_same(effective, contact):
    error = effective.error.sel(result="friction")
    assert float(error.sel(choice="5 slices")) > float(error.sel(choice="11 slices"))
    friction = contact.error.sel(result="friction")
    np.testing.assert_allclose(
        friction.sel(choice="in NumPy"), friction.sel(choice=PLANNED), rtol=1e-6, atol=1e-12
    )


def test_times_are_of_all_rounds_and_evaluations_are_counted(contact):
    timed = contact.isel(choice=np.flatnonzero(contact.kind != "reference"))
    assert (timed.round_seconds > 0.0).all()
    np.testing.assert_allclose(timed.seconds, timed.round_seconds.median("round"))
    assert (timed.seconds_low <= timed.seconds).all()
    assert (timed.seconds <= timed.seconds_high).all()
    assert (contact.evaluations > 0).all()
    few, planned = (int(contact.evaluations.sel(choice=name)) for name in ("5 slices", PLANNED))
    assert few < planned
    assert int(contact.round_seconds.sel(choice=REFERENCE).notnull().sum()) == 1


def test_a_critical_slip_that_is_not_there_is_a_status():
    rollslip.register(Rising)
    found = pareto(SCENE, study="friction-curve", choices="traction", traction="rising", rounds=1)
    one = found.isel(result=1).sel(choice="rising")
    assert np.isnan(one.difference)
    assert re.match(
        r"none \(no slip at largest traction: .*\), where the finest has \d",
        one.difference_status.item(),
    )
    assert not one.on_model_front
    scene = evolve(SCENE, {"models.traction": {"model": "lambda-blend", "hydrodynamic": "rising"}})
    found = pareto(
        scene,
        study="friction-curve",
        choices="slices,traction",
        traction="maxwell-eyring",
        rounds=1,
    )
    one = found.isel(result=1)
    assert one.error_status.sel(choice="5 slices").item() == "none, as the finest"
    assert "where the finest has none" in one.difference_status.sel(choice="maxwell-eyring").item()
    assert "the finest finds none, so there is no error" in " ".join(findings(found))


def test_a_choice_that_fails_is_a_status_and_stops_no_other():
    rollslip.register(Refuses)
    rollslip.register(Raises)
    found = pareto(SCENE, study="friction-curve", choices="traction,film", traction="eyring,raises", film="refuses",
                   rounds=2)  # fmt: skip
    status = {label.item(): found.status.sel(choice=label).item() for label in found.choice}
    assert "outside its domain" in status["film refuses"]
    assert "in somebody's model" in status["raises"]
    assert {status[name] for name in (PLANNED, "eyring", REFERENCE)} == {"done"}
    assert found.difference.sel(choice=["raises", "film refuses"]).isnull().all()
    assert found.seconds.sel(choice="raises").isnull()
    assert any(
        warning.startswith("raises: failed") for warning in json.loads(found.attrs["warnings"])
    )
    assert [row[-1] for row in account_of(found).tables(found)[-1].rows if row[0] == "raises"] == [
        "failed"
    ]


def test_what_fails_without_the_finest_is_an_error():
    rollslip.register(Refuses)
    with pytest.raises(ArithmeticError, match="outside its domain"):
        pareto(evolve(SCENE, {"models.film": "refuses"}), study="friction-curve", choices="slices")


@pytest.mark.slow
def test_a_motion_and_a_steady_slip_have_errors_too():
    changes = {
        "accuracy.slices": 5,
        "bearing.rollers": 8,
        "study.steady-slip.points": 6,
        "accuracy.tolerance": 1e-2,
    }
    named = {
        "friction": "effective",
        "level": "cage-set",
        "integrator": "rodas5p",
    }  # rk45 takes the same steps at any tolerance; at level pocket nothing is touched in 2 ms
    changes |= {"study.dynamics": {"duration": "2 ms", "points": 5, **named}}
    changes |= {"study.effective-friction": {"points": 7, "skidding_range": 0}}
    changes |= {"cage.drag": ["constant-torque"]}
    scene = evolve(
        load_scene("1032930-50C"), changes | {"operation.misalignment": "0.01 mrad"}, si=True
    )
    found = pareto(scene, study="dynamics", choices="integrator_tolerance,friction", rounds=1)
    speed = found.sel(result="cage speed")
    assert float(speed.error.sel(choice="steps to 1e-03")) > float(
        speed.error.sel(choice="steps to 1e-07")
    )
    assert speed.kind.sel(choice="conventional friction") == "modelling"
    assert float(speed.difference.sel(choice="conventional friction")) < float(
        speed.difference.sel(choice=PLANNED)
    )


# Output -------------------------------------------------------------------------------------------------------------


def test_a_result_is_stored_without_loss_and_says_where_it_comes_from(contact, tmp_path):
    save(contact, tmp_path / "pareto.nc")
    assert open_result(tmp_path / "pareto.nc").identical(contact)
    assert all(
        {"units", "long_name"} <= set(variable.attrs) for variable in contact.variables.values()
    )
    names = {model["name"] for model in json.loads(contact.attrs["models"])}
    assert {"lambda-blend", "moes", "pan-hamrock"} <= names
    fields = {"slices", "quadrature", "n_positions", "traction", "boundary", "table_tolerance",
              "integrator", "integrator_tolerance", "friction", "level", "compiled"}  # fmt: skip
    assert fields <= set(contact.coords)
    assert contact.traction.sel(choice="eyring") == "eyring"
    assert contact.slices.sel(choice="5 slices") == 5


def test_results_of_several_studies_have_names_of_their_own(contact):
    found = pareto(
        evolve(SCENE, {"study.effective-friction.points": 7}), choices="slices", rounds=1
    )
    assert "friction-curve: friction" in found.result.values
    one = results_of(found, "friction-curve")
    assert one.sizes["result"] == contact.sizes["result"]
    same = one.error.sel(result="friction", choice="5 slices")
    assert float(same) == float(contact.error.sel(result="friction", choice="5 slices"))
    assert found.error.sel(
        result="friction-curve: friction", choice="effective-friction: 5 slices"
    ).isnull()
    assert len(records(found)) == found.sizes["choice"]


def test_nothing_is_called_faster_unless_all_its_rounds_are(contact):
    def summary(dataset):
        return ParetoAccount.answer(dataset).summary

    tolerant = contact.assign(tolerance=contact.tolerance + 1.0)
    equal = tolerant.copy()
    equal["seconds_low"] = equal["seconds_low"] * 0.0
    equal["seconds_high"] = equal["seconds_high"] * 0.0 + 1e3
    assert summary(equal).startswith("keep the plan: as planned")
    clear = tolerant.copy(deep=True)
    k = contact.choice.values.tolist().index("11 slices")
    for name in ("seconds", "seconds_low", "seconds_high"):
        clear[name][k] = 1e-6
    assert summary(clear).startswith("recommended: 11 slices")
    alone = clear.assign_attrs(rounds=1)
    assert summary(alone).startswith("keep the plan"), "of one round nothing is told of that"
    assert "in a single round: none is called faster than another" in " ".join(findings(alone))
    far = equal.assign(error=equal.error + 10.0)
    assert "no choice within the tolerance" in summary(far)
    allowed = f"the scene allows an error of {100 * SCENE.accuracy.tolerance:.2g} %"
    assert allowed in " ".join(findings(contact))


@pytest.fixture(scope="module")
def figures(effective):
    return drawn(effective)


def drawn(dataset):
    """Figures, with their style, by name."""
    from matplotlib import style

    with style.context(["default", dict(STYLE)]):
        return {name: figure for name, _, figure in front_figures.front_figures(dataset)}


@pytest.mark.slow
def test_figures_number_the_front_grey_the_rest_and_mark_the_plan(effective, figures):
    assert set(figures) == {
        "pareto-friction",
        "pareto-critical-slip-inner-ring",
        "pareto-critical-slip-outer-ring",
    }
    for name, result in (
        ("pareto-friction", "friction"),
        ("pareto-critical-slip-inner-ring", "critical slip, inner ring"),
    ):
        figure = figures[name]
        one = effective.sel(result=result)
        words = [text.get_text().partition("  ")[2] for text in figure.legends[0].get_texts()]
        expected = set(one.label.values[(one.on_front == 1).to_numpy()]) | {PLANNED}
        assert expected <= set(words)
        assert {"eyring", "maxwell-eyring", "film regime"} <= set(words)
        numerical, models = figure.axes
        grey = [bars for bars in numerical.containers if bars[0].get_color() == front_figures._GREY
                or bars[0].get_markerfacecolor() == front_figures._GREY]  # fmt: skip
        known = ((one.kind == "numerical") & one.error.notnull()).to_numpy()
        assert len(numerical.containers) == known.sum()
        assert (
            len(grey)
            == known.sum()
            - (known & ((one.on_front == 1) | (one.label == PLANNED)).to_numpy()).sum()
        )
        assert [text for text in words if text == PLANNED] == [PLANNED] * 2
        assert numerical.get_xscale() == numerical.get_yscale() == "log"
        assert "Relative difference" in models.get_ylabel()


@pytest.mark.slow
def test_numbers_in_figures_cover_no_other_number(figures):
    for figure in figures.values():
        for axes in figure.axes:
            boxes = [text.get_window_extent() for text in axes.texts if text.get_text()]
            assert boxes
            assert not any(a.overlaps(b) for k, a in enumerate(boxes) for b in boxes[:k])


def test_a_result_that_the_finest_does_not_find_has_no_figure():
    found = pareto(
        evolve(SCENE, {"models.traction": "constant"}),
        study="friction-curve",
        choices="slices",
        rounds=1,
    )
    assert set(drawn(found)) == {"pareto-friction"}


def test_a_report_shows_tables_and_figures(contact, tmp_path):
    from rollslip.results.figures import save_plots

    one = contact.isel(result=[0])
    figures = save_plots(one, tmp_path)
    write_report({"pareto": one}, {"pareto": figures}, tmp_path / "report.html")
    text = (tmp_path / "report.html").read_text()
    ET.fromstring(text.removeprefix("<!DOCTYPE html>\n"))
    assert "numerical choices: error against the finest of the same models" in text
    assert text.count("<figure") == len(figures) == 1


# Command line -------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_command_writes_data_figures_and_a_report(capsys, tmp_path):
    code, out, err = answer(
        capsys,
        "1032930-30C",
        *QUICK,
        "--choices=slices,traction",
        "--out",
        tmp_path / "o",
        "--report",
        "-v",
    )
    assert code == 0, err
    lines = out.splitlines()
    assert re.match(r"(recommended|keep the plan|no choice within)", lines[0])
    (size,) = [line for line in lines if "numerical and" in line]
    assert "3 numerical and 2 modelling choices and 0 films, 2 rounds each, against 3 ref" in size
    assert size.endswith("the finest with 15 slices")
    assert any("the scene states 15 slices" in line for line in lines)
    assert any(line.startswith(" 5 slices") for line in lines)
    assert {path.name for path in (tmp_path / "o").iterdir()} >= {
        "pareto.nc",
        "pareto-friction.svg",
        "report.html",
    }
    assert not (tmp_path / "o.unfinished").exists()
    with pytest.raises(SystemExit):
        main(["info", str(tmp_path / "o" / "pareto.nc")])
    assert capsys.readouterr().out.startswith(lines[0])
    with pytest.raises(SystemExit):
        main(["info", "-v", str(tmp_path / "o" / "pareto.nc")])
    assert "the scene allows an error of" in capsys.readouterr().out


def test_json_holds_every_choice_with_null_for_what_is_not(capsys, tmp_path):
    code, out, _ = answer(
        capsys,
        "1032930-30C",
        *QUICK,
        "--choices=slices,traction",
        "--out",
        tmp_path / "o",
        "--no-plots",
        "--json",
    )
    found = json.loads(out)
    assert code == 0
    assert found["files"] == ["pareto.nc"]
    eyring = next(one for one in found["choices"] if one["choice"] == "eyring")
    assert eyring["results"]["friction"]["error"] is None
    assert eyring["results"]["friction"]["difference"] > 0.0
    assert len(eyring["round_seconds"]) == 2
    assert found["floors"]["friction"] > 0.0


def test_a_failing_choice_leaves_four(capsys, tmp_path):
    rollslip.register(Raises)
    code, out, err = answer(
        capsys,
        "1032930-30C",
        *QUICK,
        "--choices=traction",
        "--traction=raises",
        "--out",
        tmp_path / "o",
        "--no-plots",
    )
    assert code == 4
    assert "warning: raises: failed" in err
    assert (tmp_path / "o" / "pareto.nc").exists()
    assert "failed" in out


@pytest.mark.parametrize(
    ("arguments", "message", "code"),
    [
        (
            ["--choices=slice"],
            "choices: nothing to choose is called 'slice'; did you mean 'slices'",
            2,
        ),
        (
            ["--choices=integrator", "--study=friction-curve"],
            "there is nothing to choose: friction-curve",
            2,
        ),
        (["--study=dynamic"], "no study is called 'dynamic'", 2),
        (["--study=dynamics", "--set=cage.drag=nothing"], "cage.drag", 2),
        (["--traction=murakki"], "murakki", 2),
        (["--film=moess"], "moess", 2),
        (["--rounds=0"], "rounds: must be at least 1, not 0", 2),
        (["--resume"], "--resume needs the --out of the run", 2),
    ],
)
def test_what_is_wrong_is_said_before_anything_runs(
    arguments, message, code, capsys, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    found, _, err = answer(capsys, "1032930-30C", *arguments)
    assert (found, list(tmp_path.iterdir())) == (code, [])
    assert message in err


def test_a_study_without_what_it_needs_has_no_results(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = "\n".join(line for line in load_scene("1032930-30C").text.splitlines())
    land = '[cage]\ndrag = ["petroff-land"]\n'  # and no ring that has one
    (tmp_path / "own.toml").write_text(
        re.sub(r"\[cage\].*?(?=\[operation\])", land, text, flags=re.S)
    )
    code, _, err = answer(capsys, "own.toml", "--study", "dynamics")
    assert code == 2
    assert "cage" in err


# Interrupted --------------------------------------------------------------------------------------------------------

#: A law that takes its time, so that a run can be killed within a turn.
PROGRAM = """
import os, time
import attrs
import rollslip
from rollslip_campaigns.pareto import pareto as fronts
from rollslip.cli import main

fronts.MIN_TURN = 0.0
whole = fronts._take_turn
def slow(family, choice, record):
    print(choice.label, flush=True)
    time.sleep(float(os.environ.get("PAUSE", "0")))
    whole(family, choice, record)
fronts._take_turn = slow
main()
"""


def start(*arguments, cwd, **environment):
    return subprocess.Popen(
        [
            sys.executable,
            "-c",
            PROGRAM,
            "pareto",
            "1032930-30C",
            *QUICK,
            "--no-plots",
            "--choices=slices",
            *arguments,
        ],
        cwd=cwd,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | environment,
    )


def of_choices(folder):
    """What a folder has of each choice, by number."""
    return {row.number: json.loads(row.texts) for row in journal.records(folder)}


def stopped(tmp_path, how):
    """Stop a run in its first round; return what it said."""
    process = start("--out", "o", cwd=tmp_path, PAUSE="0.1")
    deadline = time.monotonic() + 60.0
    while 3 not in of_choices(tmp_path / "o.unfinished"):
        assert time.monotonic() < deadline
        time.sleep(0.02)
    process.send_signal(how)
    return process, *process.communicate(timeout=60)


@pytest.mark.faults
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT], ids=["killed", "interrupted"])
def test_a_run_goes_on_where_it_was_stopped(how, tmp_path, capsys, monkeypatch):
    process, _, err = stopped(tmp_path, how)
    kept = of_choices(tmp_path / "o.unfinished")
    assert len(kept) >= 4
    assert not (tmp_path / "o").exists()
    if how == signal.SIGINT:
        assert process.returncode == 130
        assert "Traceback" not in err
        command = shlex.split(err.partition("continue with: ")[2])
        assert command[:3] == ["rollslip", "pareto", "1032930-30C"]
        assert command[-1] == "--resume"
    monkeypatch.chdir(tmp_path)
    turns = []
    take = fronts._take_turn
    monkeypatch.setattr(
        fronts, "_take_turn", lambda *given: (turns.append(given[1].label), take(*given))
    )
    code, _, err = answer(
        capsys, "1032930-30C", *QUICK, "--no-plots", "--choices=slices", "--out", "o", "--resume"
    )
    assert code == 0, err
    assert not {REFERENCE, HALF, EXACT} & set(turns)
    found = open_result(tmp_path / "o" / "pareto.nc")
    assert (found.status == "done").all()
    assert found.round_seconds.sel(choice=PLANNED).values[0] == kept[3]["seconds"][0]
    assert "interrupted and resumed" in found.attrs["warnings"]
    whole = pareto(
        evolve(load_scene("1032930-30C"), {"accuracy.slices": 15, "study.friction-curve.points": 15}),
        study="friction-curve", choices="slices", rounds=1,
    )  # fmt: skip
    np.testing.assert_array_equal(found.error, whole.error)
    assert not (tmp_path / "o.unfinished").exists()


def silent(*told):
    """Show nothing of how far a family is."""


def test_what_is_kept_of_another_scene_or_other_choices_is_refused(tmp_path):
    kept = tmp_path / "kept"
    run_family(
        ParetoSettings(SCENE, study="friction-curve", choices="slices", rounds=1).plan(),
        kept,
        silent,
    )
    other = evolve(SCENE, {"operation.radial_load": "3000 N"})
    for scene, choices in ((other, "slices"), (SCENE, "traction")):
        made = ParetoSettings(scene, study="friction-curve", choices=choices, rounds=1).plan()
        with pytest.raises(
            OutputError,
            match=r"kept: holds a run of another scene, or of other .* without --resume",
        ):
            run_family(made, kept, silent)
    next(kept.glob("journal-*")).write_text("{" * 999)
    with pytest.raises(
        OutputError,
        match=r"journal-000000.sqlite: is not a journal that can be read .*; move it away",
    ):
        run_family(
            ParetoSettings(SCENE, study="friction-curve", choices="slices", rounds=1).plan(),
            kept,
            silent,
        )


def test_what_cannot_be_kept_says_so(tmp_path):
    (tmp_path / "file").write_text("in the way")
    family = ParetoSettings(SCENE, study="friction-curve", choices="slices", rounds=1).plan()
    with pytest.raises(OutputError, match="file: cannot be written"):
        run_family(family, tmp_path / "file", silent)


def test_progress_is_told_with_the_time_that_is_left(tmp_path):
    told = []
    family = ParetoSettings(SCENE, study="friction-curve", choices="slices", rounds=2).plan()
    run_family(family, tmp_path, lambda *given: told.append(given))
    fractions = [fraction for _, fraction, _ in told]
    assert len(told) == 3 + 2 * 3
    assert fractions == sorted(fractions)
    assert fractions[0] == 0.0
    assert told[0][2] > 0.0
    assert 0.0 < told[-1][2] < told[-3][2]
    assert told[-1][0] == "friction-curve: 11 slices"


def test_names_of_models_are_choices_beside_those_that_are_narrowed_to():
    family = ParetoSettings(
        SCENE, study="friction-curve", choices="slices", traction="carreau"
    ).plan()
    assert [one.label for one in family.choices if one.kind == "modelling"] == ["carreau"]
    assert not family.choices_of("friction-curve", "film")


def test_errors_have_their_classes():
    with pytest.raises(SceneError, match="there are: slices, quadrature"):
        ParetoSettings(SCENE, choices="wheels").plan()
    with pytest.raises(PluginError, match="no traction"):
        ParetoSettings(SCENE, traction="nobody").plan()
