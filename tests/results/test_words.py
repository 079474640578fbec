"""The verdict that stands before all else: where the cage runs away, how it runs, and how far to trust that."""

import json
import math
import re

import pytest

import rollslip
from rollslip.cli import console
from rollslip.results.account import account_of, told_elsewhere
from rollslip.results.words import runs_at, runs_away, verdict, warned

RUNS = "with the drags of the scene the cage runs at a slip of"
SCENE = rollslip.evolve(rollslip.load_scene("1032930-70C"), {"accuracy.slices": 9, "accuracy.tolerance": 1e-2})


@pytest.fixture(scope="module")
def results():
    steady = rollslip.evolve(SCENE, {"study.steady-slip.acceptable_slip": 0.05, "study.steady-slip.points": 8})
    studies = ["effective-friction", "steady-slip", "friction-curve"]
    return {name: rollslip.run(steady, name) for name in studies}


def test_a_verdict_is_six_lines_where_no_drag_is_of_rolling_a_law_has_a_caution_and_the_scene_a_note(results):
    first, runs, bound, caution, note, trust = verdict(results.values())
    assert bound == "no rolling resistance among the drags: slip and friction torque are lower bounds"
    whole = [dataset.drop_attrs().assign_attrs(dataset.attrs | {"bound_below": 0}) for dataset in results.values()]
    assert verdict(whole) == [first, runs, caution, note, trust]
    assert note == SCENE.note != ""
    assert caution.startswith(
        "viscosity under pressure follows Barus's law, as the scene names it: too steep above 0.1 GPa"
    )
    away, steady = results["effective-friction"], results["steady-slip"]
    assert first == runs_away(float(steady.largest_drag_slip), float(steady.largest_drag), "found")
    slip, reserve = float(results["steady-slip"].steady_slip[0]), float(results["steady-slip"].largest_drag)
    reserve /= float(results["steady-slip"].torque[0])
    assert runs.startswith(f"with the drags of the scene the cage runs at a slip of {100 * slip:.3g} %")
    assert f"could carry {reserve:.3g} times the drag" in runs
    assert re.search(r"a radial load of at least \S+ k?N keeps the slip below 5 %; makers ask for .*\(NTN\)", runs)
    off = json.loads(away.attrs["validity"])["approximation"]["rms"]
    assert trust.startswith(f"how far to trust it: 'muraki' is {100 * off:.2g} % (rms) off 'maxwell-eyring'")
    assert trust.endswith(
        "oil data of grades B and C; not told here: how probably scatter of the data makes the cage run away (rollslip "
        "uncertainty SCENE)"
    )


def test_without_a_study_of_it_the_balance_of_effective_friction_says_how_the_cage_runs(results):
    """Of the same balance of torques; the load that a slip takes is the other study's."""
    assert verdict([results["friction-curve"]]) == verdict(results.values())[3:5]  # caution and note alone
    first, runs, bound, *_, trust = verdict([results["effective-friction"]])
    assert bound == verdict(results.values())[2]  # the drags are those of the scene
    assert first.startswith("the cage runs away at")
    assert trust.startswith("how far to trust it")
    steady = verdict(results.values())[1]
    assert runs == steady.split(";")[0]
    assert "(--study steady-slip --set study.steady-slip.acceptable_slip=0.05)" in trust


def test_what_is_not_known_is_left_out(results):
    old = results["effective-friction"].drop_vars(["steady_cage_slip", "steady_drag", "steady_status"])
    assert verdict([old]) == [line for n, line in enumerate(verdict([results["effective-friction"]])) if n != 1]


def test_a_probability_stands_beside_how_the_cage_runs(results, monkeypatch):
    plain = verdict(results.values())
    steady = account_of(results["steady-slip"])
    monkeypatch.setattr(type(steady), "chance", lambda self, dataset: "it does so with probability 1")
    told = verdict(results.values())
    assert told[0] == plain[0]
    assert told[1] == f"{plain[1]}; it does so with probability 1"
    assert told[2] == plain[2]


@pytest.mark.parametrize(
    ("slip", "reserve", "status", "said"),
    [
        (
            0.1,
            4.0,
            "found",
            f"{RUNS} 10 %, and could carry 4 times the drag",
        ),
        (
            0.1,
            4.0,
            "at least: up to a slip of 0.95 the cage does not run away",
            f"{RUNS} 10 %, and could carry at least 4 times the drag",
        ),
        (
            0.1,
            math.inf,
            "at least: no torque drags the cage",
            f"{RUNS} 10 %",
        ),
        (
            0.1,
            1.0,
            "at least: up to a slip of 0.95 the cage does not run away",
            f"{RUNS} 10 %",
        ),
        (
            0.0,
            math.inf,
            "found",
            "every drag is switched off by cage.drag = [], as in no bearing, so the cage runs without slip",
        ),
        (
            0.5,
            0.9,
            "the cage skids: its drags are more than the rollers carry",
            f"{RUNS} 50 %, beyond that of running away: there its drag "
            "falls with slip faster than what the rollers carry",
        ),
    ],
)
def test_how_a_cage_runs_is_told_with_what_it_could_carry(slip, reserve, status, said):
    assert runs_at(slip, 0.4, reserve, status) == said
    assert runs_at(slip, math.nan, math.nan, "not known").startswith(said.split(",")[0])


def test_a_number_that_two_results_know_is_told_once_by_the_one_that_knows_it_best(results):
    both = [results["effective-friction"], results["steady-slip"]]
    assert verdict(both)[0] == account_of(both[1]).headline(both[1])
    known = account_of(both[0]).known_better(both[0])
    assert len(known) == 2
    assert told_elsewhere(both) == {*known}
    assert not told_elsewhere(both[:1])
    shown = console.findings(both[0], [*verdict(both), *told_elsewhere(both)])
    assert [line for line in console.findings(both[0]) if line not in shown] == known


def test_a_law_within_what_it_was_made_for_is_not_named(results):
    dataset = results["effective-friction"]
    judged = json.loads(dataset.attrs["validity"])
    judged |= {"approximation": None, "bounds": [one | {"share_outside": 0.004} for one in judged["bounds"]]}
    within = dataset.assign_attrs(validity=json.dumps(judged))
    assert verdict([within])[-1].startswith("how far to trust it: oil data of grades B and C; not told here: ")


def test_a_cage_that_does_not_run_away_has_the_reason_for_its_headline(results):
    dataset = results["effective-friction"]
    lost = dataset.assign(runaway_slip=float("nan"), runaway_drag=float("nan"), runaway_status=((), "it is so"))
    assert verdict([lost])[0] == "it is so"


def test_warnings_of_a_result_without_a_record_are_all_told(results):
    old = results["effective-friction"].assign_attrs(warnings='["mind the load", "and the oil"]', validity="")
    assert warned([old, old]) == (["mind the load", "and the oil"], [])
