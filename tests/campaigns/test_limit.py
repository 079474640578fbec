"""The search for a limit: held against closed forms and other searches, told where it is kept, gone on with."""

import json
import math
import re

import attrs
import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

import promise_scenes
import rollslip
import without_bands
from coarse import coarse
from rollslip.catalogue.discovery import get_class
from rollslip.cli.main import cli
from rollslip.errors import OutputError, SceneError
from rollslip.results.accounts import account_of
from rollslip.results.table import sheet
from rollslip.studies.bounds import JOINT_ORDER
from rollslip_campaigns.limit import LimitSettings, findings
from rollslip_campaigns.limit.limit import RESULT, run_limit, status_of_worst
from rollslip_campaigns.limit.search import Requirement, brackets, next_indices, read_requirement
from rollslip_campaigns.sweep import SweepSettings
from rollslip_campaigns.sweep.definition import Resolutions, combination_name
from rollslip_campaigns.sweep.folder import open_or_create
from rollslip_campaigns.sweep.journal import FAILED, records
from rollslip_campaigns.sweep.point import compute
from rollslip_campaigns.sweep.run import run_sweep

#: The half width of a contact under a force falls with the length of the roller.
CURVE = {"study": "friction-curve", "within": 0.01}
LENGTHS = {"bearing.roller_length": "5 mm:40 mm:5"}


def searched(results, spacing, failed=()):
    """All places that a search computes of a row of results that are kept from 0 on, some first."""
    known = {k: results[k] for k in range(0, len(results), spacing) if k not in failed}
    while places := next_indices(known, failed, spacing):
        assert not {*places} & known.keys(), "a place was asked for twice"
        known |= {k: results[k] for k in places}
    return known


@given(
    power=st.integers(0, 7),
    steps=st.lists(st.floats(0.0, 1.0), min_size=8, max_size=8),
    bend=st.floats(0.05, 20.0),
    shift=st.floats(-0.1, 1.1),
    falls=st.booleans(),
)
def test_a_passage_is_narrowed_to_two_neighbours_in_few_points(power, steps, bend, shift, falls):
    spacing = 2**power
    x = np.linspace(0.0, 1.0, 8 * spacing + 1)
    course = np.interp(
        x, np.linspace(0.0, 1.0, 9), np.concatenate(([0.0], np.cumsum(steps)))
    ) / max(sum(steps), 1e-9)
    results = (course**bend - shift) * (-1.0 if falls else 1.0)
    known = searched(results.tolist(), spacing)
    kept = results >= 0.0
    true = [(k, k + 1) for k in range(results.size - 1) if kept[k] != kept[k + 1]]
    assert brackets(known) == true
    assert len(known) - 9 <= len(true) * 2 * power


def test_every_passage_between_the_first_values_is_found_and_a_failed_point_leaves_its_own_open():
    x = np.linspace(0.0, 1.0, 257)
    results = np.cos(9.0 * x)  # passes zero three times
    known = searched(results.tolist(), 32)
    assert [round(x[a], 2) for a, _ in brackets(known)] == [
        round((k + 0.5) * math.pi / 9.0, 2) for k in range(3)
    ]
    (a, b), *_ = brackets(known)
    open_ = searched(results.tolist(), 32, failed={32})
    assert brackets(open_)[0] == (0, 64)
    assert brackets(open_)[1:] == brackets(known)[1:]
    assert a > 32
    assert b < 64


def test_what_has_no_value_is_not_kept_and_is_told_from_what_is():
    known = searched([1.0] * 20 + [math.nan] * 13, 16)
    assert brackets(known) == [(19, 20)]
    of_two = Requirement("slip", "1", "<=", 0.1, "%")
    assert of_two.slack(of_two.worst([math.nan, 0.02, 0.12])) == pytest.approx(-0.02)
    assert math.isnan(of_two.worst([math.nan]))
    assert attrs.evolve(of_two, sense=">=").worst([0.02, 0.12]) == 0.02


def test_a_limit_is_that_of_another_search_over_single_runs():
    found = rollslip.limit("1032930-70C", LENGTHS, "half_width >= 60 um", **CURVE)
    results = dict(zip(found.searched.values.tolist(), found.result.values.tolist(), strict=True))
    assert (min(results), max(results)) == (0.005, 0.04)
    (kept,) = found.edge_kept.values
    (beyond,) = found.edge_passed.values
    assert results[beyond] < 60e-6 <= results[kept]
    assert 1.0 < beyond / kept < 1.01 + 1e-9
    head, rows = sheet(found)
    assert head[:3] == ["bearing.roller_length [mm]", "half_width [um]", "kept"]
    np.testing.assert_allclose(
        [row[:2] for row in rows], [[1e3 * x, 1e6 * y] for x, y in results.items()], rtol=1e-11
    )
    assert [row[2] for row in rows] == ["yes" if y >= 60e-6 else "no" for y in results.values()]
    (printed,) = account_of(found).tables(found)
    assert printed.head == tuple(head[:3])
    assert [row[2] for row in printed.rows] == [row[2] for row in rows]
    scene = rollslip.load_scene("1032930-70C")

    def excess(length):
        result = rollslip.run(
            rollslip.evolve(scene, {"bearing.roller_length": length}, si=True), "friction-curve"
        )
        return float(result.half_width.min()) - 60e-6

    assert kept <= brentq(excess, 0.9 * kept, 1.1 * beyond, rtol=1e-5) < beyond


@pytest.mark.parametrize("study", ["steady-slip", "effective-friction"])
def test_a_limit_is_asked_for_in_a_person_s_words(study):
    requested = read_requirement("slip < 5%", get_class("study", study))
    assert (requested.sense, requested.limit) == ("<=", 0.05)
    assert (
        requested.output
        == {"steady-slip": "steady_slip", "effective-friction": "steady_cage_slip"}[study]
    )


@pytest.mark.parametrize("keep", ["slip < 5", "slip < 500 %", "slip < -5 %"])
def test_a_slip_beyond_none_and_all_is_refused(keep):
    with pytest.raises(SceneError, match="a slip from 0 to 100 % is expected"):
        read_requirement(keep, get_class("study", "steady-slip"))


def test_a_cage_that_runs_ahead_slips_as_much():
    requested = read_requirement("slip < 5 %", get_class("study", "steady-slip"))
    assert requested.slack(-0.34) < 0.0 < requested.slack(-0.01)
    assert requested.worst([0.02, -0.34]) == -0.34


def test_a_word_searches_what_its_key_does():
    words = ({"load": "0.5 kN:2 kN:3"}, "slip < 5 %")
    keys = ({"operation.radial_load": "0.5 kN:2 kN:3"}, "steady_cage_slip <= 5 %")
    scene = coarse("1032930-70C", {"accuracy.slices": 3, "models.traction": "muraki"})
    one, two = (
        LimitSettings(scene, *requested, study="effective-friction", within=0.2).plan()
        for requested in (words, keys)
    )
    assert one.sweep.hash == two.sweep.hash
    assert ([*one.axis.values], one.requirement) == ([*two.axis.values], two.requirement)


@pytest.fixture(scope="module")
def bearing():
    """A law of traction that costs little: most limits below are of widths, for which it does not matter."""
    return rollslip.evolve(rollslip.load_scene("1032930-70C"), {"models.traction": "muraki"})


@pytest.mark.parametrize("max_slip", [0.3, 2.0])
def test_what_a_study_says_of_each_of_several_values_is_told_of_the_one_that_counts(
    bearing, max_slip
):
    scene = rollslip.evolve(bearing, {"study.friction-curve.max_slip": max_slip})
    loads = {"operation.radial_load": "2 kN:6 kN:3"}
    found = rollslip.limit(
        scene, loads, "critical_friction <= 0.02", study="friction-curve", within=0.5
    )
    alone = rollslip.run(
        rollslip.evolve(scene, {"operation.radial_load": "2 kN"}), "friction-curve"
    )
    assert alone.critical_status.size > 1
    assert (
        found.result_status[0]
        == alone.critical_status[np.argmax(np.nan_to_num(alone.critical_friction.values))]
    )
    values = np.array([math.nan, 0.02, 0.12])
    words = np.array(["still rises", "found", "found at the end"])
    most = Requirement("slip", "1", "<=", 0.1, "%")
    assert status_of_worst(most, values, words) == "found at the end"
    assert status_of_worst(attrs.evolve(most, sense=">="), values, words) == "found"
    assert status_of_worst(most, np.full(3, math.nan), words[[0, 0, 1]]) == "still rises; found"


@pytest.mark.parametrize(
    ("keep", "said", "edges"),
    [
        (
            "half_width >= 1 um",
            "half width of at least 1 um at every roller length from 5 mm to 40 mm; nearest",
            0,
        ),
        (
            "half_width <= 1 um",
            "half width up to 1 um at no roller length from 5 mm to 40 mm; nearest",
            0,
        ),
        (
            "half_width >= 60 um",
            "maximum roller length 18.3 mm for half width of at least 60 um; at",
            1,
        ),
        ("half_width <= 60 um", "minimum roller length 31.1 mm for half width up to 60 um; at", 1),
    ],
)
def test_it_is_said_where_a_limit_is_kept(bearing, keep, said, edges):
    found = rollslip.limit(bearing, LENGTHS, keep, **CURVE)
    text = findings.describe_limit(found)
    assert text.startswith(said)
    assert found.sizes["edge"] == edges
    told = findings.LimitAccount.record(found)
    assert json.loads(json.dumps(told, allow_nan=False)) == told
    assert told["one_way"]
    assert len(told["kept"]) == (0 if "at no" in said else 1)
    assert account_of(found).sentences(found)[1].startswith("half_width is monotonic over")


@pytest.mark.slow
def test_a_search_goes_on_where_it_was_stopped_and_gives_the_same(bearing, tmp_path):
    made = LimitSettings(bearing, LENGTHS, "half_width >= 60 um", **CURVE).plan()
    whole = run_limit(made, tmp_path / "whole")
    (tmp_path / "part").mkdir()
    run_sweep(
        attrs.evolve(made.sweep, selected=made.first[:3]),
        open_or_create(made.sweep, tmp_path / "part"),
    )
    again = run_limit(made, tmp_path / "part")
    assert again.drop_vars("seconds").identical(
        whole.drop_vars("seconds").assign_attrs(again.attrs)
    )
    assert sum(1 for _ in records(tmp_path / "part")) == whole.sizes["point"], (
        "a point was computed twice"
    )
    assert rollslip.open_result(tmp_path / "part" / RESULT).attrs["study"] == "limit"
    other = LimitSettings(
        bearing, LENGTHS, "half_width >= 60 um", study="friction-curve", within=0.02
    ).plan()
    with pytest.raises(OutputError, match="holds points of another scene"):
        run_limit(other, tmp_path / "part")


def test_points_that_fail_are_told_and_tried_again(bearing, tmp_path, monkeypatch):
    made = LimitSettings(bearing, LENGTHS, "half_width >= 60 um", **CURVE).plan()
    from rollslip_campaigns.sweep import point

    true = point.evaluate
    lost = made.axis.values[made.first[1]]

    def fails(study, assembly, names):
        if assembly.scene.bearing.roller_length == lost:
            raise RuntimeError("no oil today")
        return true(study, assembly, names)

    monkeypatch.setattr(point, "evaluate", fails)
    monkeypatch.setattr(point, "evaluate_together", lambda cases, names: None)
    found = run_limit(attrs.evolve(made, sweep=attrs.evolve(made.sweep, table=attrs.evolve(
        made.sweep.table, engine="serial"))), tmp_path)  # fmt: skip
    assert (found.status.values != "ok").sum() == 1
    assert set(found.status.values) - {"ok"} <= {*FAILED}
    text = " ".join(account_of(found).sentences(found))
    assert "1 of " in text
    assert "points failed, which says nothing of the limit there" in text
    assert "no oil today" in text
    monkeypatch.undo()
    assert (run_limit(made, tmp_path).status.values == "ok").all()


@pytest.mark.parametrize(
    ("over", "keep", "options", "said"),
    [
        (LENGTHS, "half_width == 1 um", {}, "is not a limit; write OUTPUT<=VALUE"),
        (LENGTHS, "half_widht <= 1 um", {}, "did you mean 'half_width'"),
        (LENGTHS, "half_width <= 1 N", {}, "is a force, here a length is expected"),
        (LENGTHS, "critical_status <= 1", {}, "critical_status is a text, so it has no limit"),
        (
            LENGTHS,
            "half_width <= 1 um",
            {"within": 0.9},
            "a fraction from 1e-06 to 0.5 is expected",
        ),
        ({}, "half_width <= 1 um", {}, "one quantity is searched over, not 0"),
        (
            {"operation.radial_lod": "1:2"},
            "half_width <= 1 um",
            {},
            "did you mean 'operation.radial_load'",
        ),
        (
            {"bearing.rollers": "9:20"},
            "half_width <= 1 um",
            {},
            "is not a quantity with continuous values",
        ),
        (
            {"operation.radial_load": "2 kN"},
            "half_width <= 1 um",
            {},
            "is not a range; write LOW:HIGH",
        ),
        (
            {"operation.radial_load": "2 kN:1 kN"},
            "half_width <= 1 um",
            {},
            "the first end must be below the second",
        ),
        (
            {"operation.radial_load": "1 kN:2 kN:2"},
            "half_width <= 1 um",
            {},
            "is not a number of values from 3 to 999",
        ),
        (
            {"operation.radial_load": "1 kN:2 kN"},
            "half_width <= 1 um",
            {"within": 1e-6},
            "are more than 100000",
        ),
    ],
)
def test_what_cannot_be_searched_is_refused_before_anything_runs(
    bearing, over, keep, options, said
):
    with pytest.raises(SceneError, match=said.replace("(", r"\(")):
        LimitSettings(bearing, over, keep, study="friction-curve", **options).plan()


def test_a_history_that_the_scene_does_not_have_is_told():
    scene = rollslip.load_scene("1032930-50C")
    over = {"study.dynamics.history.radial_load.to": "1 kN:2 kN"}
    with pytest.raises(
        SceneError, match=r"the scene has nothing in study\.dynamics\.history\.radial_load"
    ):
        LimitSettings(scene, over, "largest_cage_slip <= 5 %", study="dynamics").plan()


def test_one_quantity_has_one_unit_in_one_answer(tmp_path, monkeypatch):
    """That in which its range or its limit was given: N beside kN was told where values pass 1 kN."""
    monkeypatch.chdir(tmp_path)
    requested = [
        "limit",
        "1032930-70C",
        "--study",
        "friction-curve",
        "--set",
        "accuracy.tolerance=0.01",
    ]
    load = [
        *requested,
        "--over",
        "operation.radial_load=500N:5kN:5",
        "--keep",
        "half_width >= 0.1 mm",
        "--out",
        "load",
        "-v",
    ]
    told = CliRunner().invoke(cli, load, catch_exceptions=False).output
    assert "operation.radial_load from 500 N to 5000 N" in told
    assert "operation.radial_load [N]" in told
    assert "half_width [mm]" in told
    assert re.search(r"operation.radial_load = [\d.]+ N,", told), told
    assert not re.search(r"\bkN\b|\d um", told)


def test_a_limit_that_is_passed_by_a_jump_is_told_with_what_the_study_says_of_both_sides(bearing):
    smooth = rollslip.limit(bearing, LENGTHS, "half_width >= 60 um", **CURVE)
    assert "jump" not in findings.LimitAccount.topics(smooth)
    assert "jump" not in findings.LimitAccount.topics(
        rollslip.limit(bearing, LENGTHS, "half_width >= 60 um", **CURVE | {"within": 0.3})
    )
    kept = float(smooth.edge_kept[0])
    passed = float(smooth.edge_passed[0])
    beyond = smooth["searched"] >= passed
    words = np.where(beyond, "at least: no skidding", "found")
    jumped = smooth.assign(result=smooth["result"] + 1e-4 * beyond, result_status=("point", words))
    (said,) = findings.LimitAccount.topics(jumped)["jump"]
    at = [f"{1e3 * x:.4g} mm, where half_width is" for x in (kept, passed)]
    assert said.startswith(f"the result jumps across the limit between {at[0]} 60.")
    assert re.search(rf"um, and {at[1]} 15\d\.\d um \(at least: no skidding\)$", said)
    assert said in account_of(jumped).sentences(jumped)


@pytest.mark.slow
def test_a_limit_of_damage_is_in_the_unit_of_its_measure(bearing):
    scene = rollslip.evolve(bearing, {"accuracy.slices": 5, "study.surface-damage.cage_slip": 0.1})
    loads = {"operation.radial_load": "2 kN:8 kN:3"}

    def limit(keep, *models, within=0.01):
        one = rollslip.evolve(scene, {"models.damage": list(models)}, si=True)
        return rollslip.limit(one, loads, keep, study="surface-damage", within=within)

    found = limit("worst <= 12 MW/m2", "power-density")
    kept, passed = (
        without_bands.run(
            rollslip.evolve(
                scene,
                {"models.damage": ["power-density"], "operation.radial_load": float(at[0])},
                si=True,
            ),
            "surface-damage",
        ).worst.max()
        for at in (found.edge_kept, found.edge_passed)
    )
    assert kept < 12e6 * 1.01
    assert 12e6 * 0.99 < passed < 1.03 * kept
    heated = limit("worst <= 1.2 K", "flash-temperature", within=0.3)
    assert re.search(
        r"^maximum radial load \S+ kN for worst up to 1.2 K; largest load 11 kN, 20,000 h by ISO 281; at",
        findings.describe_limit(heated),
    )
    for models, named in (
        ((), "none"),
        (("power-density", "pass-energy"), "power-density, pass-energy"),
    ):
        with pytest.raises(
            SceneError,
            match=f"one measure of damage, and models.damage names {named}; name the one",
        ):
            limit("worst <= 1 MW/m2", *models)


@pytest.mark.slow
def test_all_points_are_as_fine_as_single_runs_need_and_what_stays_off_is_told():
    """Eight slices, which torques need, are too few for the worst value of a crowned roller; a run takes more.

    What is told is how far off it is, or as much more as an order of `JOINT_ORDER` in place of the second makes it.
    """
    own = {
        "accuracy.tolerance": 1e-3,
        "models.damage": "power-density",
        "study.surface-damage.cage_slip": 0.1,
    }
    scene = rollslip.evolve(
        promise_scenes.scene(41, 350), {**own, "cage.drag": ["churning"]}, si=True
    )
    load = scene.operation.radial_load
    over = {"operation.radial_load": f"{0.8 * load} N:{1.2 * load} N:3"}
    kept = float(without_bands.run(scene, "surface-damage").worst.max())

    def limit(**changes):
        one = rollslip.evolve(scene, changes, si=True)
        return rollslip.limit(
            one, over, f"worst <= {kept} W/m2", study="surface-damage", within=2e-3
        )

    fine = limit()
    few = limit(**{"accuracy.slices": 8})
    at = [0.5 * float(one.edge_kept[0] + one.edge_passed[0]) / load for one in (fine, few)]
    assert abs(at[0] - 1.0) < 3e-3 < 5e-3 < at[1] - 1.0
    (chosen,) = json.loads(fine.attrs["resolutions"]).values()
    assert chosen["slices"] > 2 * 8
    assert not any(text.startswith("worst") for text in json.loads(fine.attrs["warnings"]))

    def worst(fraction, **changes):
        one = rollslip.evolve(scene, {"operation.radial_load": fraction * load, **changes}, si=True)
        return float(without_bands.run(one, "surface-damage").worst.max())

    # on 301 slices: a run may itself be 1e-3 off
    off = max(
        abs(
            worst(fraction, **{"accuracy.slices": 8}) / worst(fraction, **{"accuracy.slices": 301})
            - 1.0
        )
        for fraction in (0.8, 1.0, 1.2)
    )
    said = json.loads(few.attrs["warnings"])[0]
    words = "with the scene's own operation.radial_load or at an end of its range, more than the tolerance of 0.001"
    told = re.match(
        rf"worst sliding power density errs by about (\S+) {words}: the limit errs accordingly",
        said,
    )
    assert 1e-3 < off <= float(told[1]) <= off / (1.0 - 2.0**-JOINT_ORDER)


@pytest.mark.slow
def test_the_command_tells_the_plan_the_limit_and_where_its_files_are(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    requested = ["limit", "1032930-70C", "--study", "friction-curve", "--over", "bearing.roller_length=5 mm:40 mm:5",
             "--keep", "half_width>=60 um"]  # fmt: skip
    told = CliRunner().invoke(cli, [*requested, "--report", "-v"], catch_exceptions=False)
    assert told.exit_code == 0, told.output
    assert told.stdout.startswith("maximum roller length 18.3 mm for half width of at least 60 um")
    assert "5 values, then up to" in told.output
    assert "where it is passed once" in told.output
    assert (
        "shaded is where it is kept" in (tmp_path / "1032930-70C-limit" / "report.html").read_text()
    )
    found = json.loads(
        CliRunner().invoke(cli, [*requested, "--json", "--out", "1032930-70C-limit"]).stdout
    )
    assert found["edges"][0]["kept"] < found["edges"][0]["passed"]
    lone = CliRunner().invoke(cli, [*requested[:5], "operation.radial_load=2 kN", *requested[6:]])
    assert "operation.radial_load: '2 kN' is not a range; write LOW:HIGH" in str(lone.exception)
    bare = CliRunner().invoke(cli, [*requested[:5], "load", *requested[6:]])
    assert "over: 'load' has no values; write KEY=LOW:HIGH, such as" in str(bare.exception)


# Along histories ------------------------------------------------------------------------------------------------------


def moving(history, slices=7, **more):
    return rollslip.evolve(
        rollslip.load_scene("1032930-50C"),
        {
            "accuracy.slices": slices,
            "operation.radial_load": "3000 N",
            "study.dynamics.friction": "conventional",
            "study.dynamics.duration": "1 s",
            "study.dynamics.history": history,
            **more,
        },
        si=True,
    )


RUN_UP = {"inner_speed": {"shape": "run-up", "from": "1000 rpm", "within": "0.3 s"}}
DROP = {"radial_load": {"shape": "step", "to": "600 N", "at": "0.1 s"}}
CASES = {
    "run-up": (RUN_UP, "inner_speed.within", "0.3 s:1 s:3", "largest_cage_slip <= 20 %", 0.02, {}),
    "load drop": (DROP, "radial_load.to", "300 N:1500 N:3", "largest_cage_slip <= 8 %", 0.02, {}),
    "load drop, pocket": (
        DROP, "radial_load.to", "300 N:1500 N:3", "largest_cage_slip <= 1.8 %", 0.05,
        {"study.dynamics.level": "pocket", "study.dynamics.duration": "0.2 s"},
    ),
    "load drop, planar": (
        DROP, "radial_load.to", "300 N:1500 N:3", "largest_cage_slip <= 2.1 %", 0.05,
        {"study.dynamics.level": "planar", "study.dynamics.duration": "0.15 s",
         "study.dynamics.planar": {"inner_ring_mass": "5 kg"}},
    ),
}  # fmt: skip


@pytest.mark.soak
@pytest.mark.parametrize("case", CASES)
def test_a_limit_along_a_history_is_that_of_another_search_over_single_runs(case):
    history, name, span, keep, within, more = CASES[case]
    key = f"study.dynamics.history.{name}"
    scene = moving(history, **more)
    found = rollslip.limit(scene, {key: span}, keep, study="dynamics", within=within)
    assert (found.status.values == "ok").all()
    (kept,) = found.edge_kept.values
    (beyond,) = found.edge_passed.values
    limit = float(found.attrs["limit"])

    def excess(value):
        result = rollslip.run(rollslip.evolve(scene, {key: value}, si=True), "dynamics")
        return float(np.nanmax(result.cage_slip)) - limit

    low, high = sorted((kept, beyond))
    exact = brentq(excess, low / (1.0 + within), high * (1.0 + within), rtol=1e-3 * within)
    assert low <= exact * (1.0 + 1e-3 * within)
    assert exact <= high * (1.0 + 1e-3 * within)
    assert high / low < 1.0 + 1.01 * within


@pytest.mark.slow
def test_a_motion_is_searched_as_the_plan_chooses_it():
    scene = moving(
        DROP,
        slices=3,
        **{"study.dynamics.level": "pocket", "study.dynamics.duration": "2 ms"},
    )
    over = {"study.dynamics.history.radial_load.to": "1 kN:2 kN:3"}
    made = LimitSettings(scene, over, "largest_cage_slip <= 5 %", study="dynamics").plan()
    (chosen,) = made.sweep.resolutions.chosen.values()
    assert (
        chosen.integrator
        == rollslip.plan(scene, "dynamics").choices["dynamics"].resolution.integrator
    )
    assert chosen.integrator != "rodas5p", "what a motion takes that nobody planned"
    assert 0.0 < made.point_seconds < 60.0
    other = Resolutions(chosen={combination_name([]): attrs.evolve(chosen, integrator="no-such")})
    work = attrs.evolve(made.sweep, resolutions=other).work
    (row,) = compute(work, ((0, made.sweep.design.changes(0)),)).rows
    assert "no-such" in row.message


@pytest.mark.parametrize("over", ["text", 5, [5], None])
def test_what_does_not_say_what_moves_is_one_sentence_in_python(over):
    for ask in (
        lambda: rollslip.limit("1032930-70C", over, "half_width >= 60 um"),
        lambda: _swept(over),
    ):
        with pytest.raises(
            SceneError, match=r"^over: what varies is expected, a mapping such as \{.*\}, or texts"
        ):
            ask()


def _swept(over):
    return rollslip.sweep(
        "1032930-70C", 0 if over is None else over
    )  # which none is a sweep of the scene's own table


@pytest.mark.parametrize(("name", "wrong"), [("keep", None), ("keep", 5), ("study", 3)])
def test_a_setting_of_another_type_is_one_sentence(name, wrong):
    with pytest.raises(
        SceneError,
        match=rf"^{name}: a (text|number) is expected, not {wrong!r}; rollslip limit --help",
    ):
        rollslip.limit(
            **{"scene": "1032930-70C", "over": LENGTHS, "keep": "half_width >= 60 um"}
            | {name: wrong}
        )


def test_what_moves_may_be_said_as_on_the_command_line():
    over = {"bearing.roller_length": "5 mm:40 mm:5"}
    one, other = (LimitSettings("1032930-70C", given, "half_width >= 60 um", **CURVE).plan() for given in (
        over, "bearing.roller_length=5 mm:40 mm:5"))  # fmt: skip
    assert one.sweep.hash == other.sweep.hash


def test_of_several_studies_the_first_that_has_the_output_is_searched():
    scene = coarse("1032930-70C", {"accuracy.slices": 3, "models.traction": "muraki"})
    assert [*scene.study].index("effective-friction") < [*scene.study].index("friction-curve")
    assert (
        LimitSettings(scene, LENGTHS, "half_width >= 60 um").plan().sweep.study == "friction-curve"
    )
    assert (
        LimitSettings(scene, LENGTHS, "skidding_slip <= 5 %").plan().sweep.study
        == "effective-friction"
    )
    with pytest.raises(SceneError, match="study 'effective-friction' has no 'width'"):
        LimitSettings(scene, LENGTHS, "width <= 5 %").plan()
    loads = {"operation.radial_load": ["1 kN", "2 kN"]}
    assert SweepSettings(scene, loads, output="half_width").plan().study == "friction-curve"
    made = SweepSettings(scene, loads).plan()
    assert made.study == "effective-friction"


def test_a_slip_is_asked_of_the_study_of_the_cage_and_a_share_may_be_percent():
    scene = coarse("gearbox", {"accuracy.slices": 3, "models.traction": "muraki"})
    made = LimitSettings(scene, over="load=1 kN:3 kN:3", keep="slip<5%", within="5 %").plan()
    assert (made.requirement.output, made.within) == ("steady_slip", 0.05)
    for wrong in ("5 kN", None, [0.1], 0.6):
        with pytest.raises(
            SceneError, match=rf"such as 0.01 or '1 %', not {re.escape(str(wrong))}"
        ):
            LimitSettings(
                scene, LENGTHS, "half_width >= 60 um", study="friction-curve", within=wrong
            ).plan()
