"""The verdict that stands before all else: where the cage runs away, how it runs, and how far to trust that."""

import json
import re

import pytest

import rollslip
from rollslip.results.words import runs_away, verdict

SCENE = rollslip.evolve(rollslip.load_scene("1032930-70C"), {"accuracy.slices": 9, "accuracy.tolerance": 1e-2})


@pytest.fixture(scope="module")
def results():
    steady = rollslip.evolve(SCENE, {"study.steady-slip.acceptable_slip": 0.05, "study.steady-slip.points": 8})
    studies = ["effective-friction", "steady-slip", "friction-curve"]
    return {name: rollslip.run(steady, name) for name in studies}


def test_a_verdict_is_three_lines(results):
    first, runs, trust = verdict(results.values())
    away = results["effective-friction"]
    assert first == runs_away(float(away.runaway_slip), float(away.runaway_drag), "found")
    slip, reserve = float(results["steady-slip"].steady_slip[0]), float(results["steady-slip"].largest_drag)
    reserve /= float(results["steady-slip"].torque[0])
    assert runs.startswith(f"with the drags of the scene the cage runs at a slip of {100 * slip:.3g} %")
    assert f"could carry {reserve:.3g} times the drag" in runs
    assert re.search(r"a radial load of at least \S+ k?N keeps the slip below 5 %; makers ask for NTN", runs)
    off = json.loads(away.attrs["validity"])["approximation"]["rms"]
    assert trust.startswith(f"how far to trust it: 'muraki' is {100 * off:.2g} % (rms) off 'maxwell-eyring'")
    assert trust.endswith("oil data of grades B and C")


def test_what_is_not_known_is_left_out(results):
    assert verdict([results["friction-curve"]]) == []
    first, trust = verdict([results["effective-friction"]])
    assert first.startswith("the cage runs away at")
    assert trust.startswith("how far to trust it")


def test_a_law_within_what_it_was_made_for_is_not_named(results):
    dataset = results["effective-friction"]
    judged = json.loads(dataset.attrs["validity"])
    judged |= {"approximation": None, "bounds": [one | {"share_outside": 0.004} for one in judged["bounds"]]}
    within = dataset.assign_attrs(validity=json.dumps(judged))
    assert verdict([within])[1] == "how far to trust it: oil data of grades B and C"


def test_a_cage_that_does_not_run_away_has_the_reason_for_its_headline(results):
    dataset = results["effective-friction"]
    lost = dataset.assign(runaway_slip=float("nan"), runaway_drag=float("nan"), runaway_status=((), "it is so"))
    assert verdict([lost])[0] == "it is so"
