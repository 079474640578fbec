"""Sentences that several studies say alike, and numbers as people read them."""

import json

import pytest

import rollslip
from rollslip.results.text import (
    Status,
    collect_warnings,
    confidence,
    format_rounded_up,
    two_digits,
)

SCENE = rollslip.evolve(
    rollslip.load_scene("1032930-70C"), {"accuracy.slices": 9, "accuracy.tolerance": 1e-2}
)


@pytest.fixture(scope="module")
def results():
    return {name: rollslip.run(SCENE, name) for name in ("effective-friction", "friction-curve")}


@pytest.mark.parametrize("status", Status)
def test_a_status_is_found_in_its_text_whatever_follows(status):
    assert Status.of(status) is status
    assert Status.of(f"{status}, however the rest is worded: found") is status


def test_confidence_is_the_error_of_an_approximation_and_the_quality_of_the_data(results):
    dataset = results["effective-friction"]
    off = json.loads(dataset.attrs["validity"])["approximation"]["rms"]
    first, last = confidence(results.values()).split("; ")
    assert (
        first == f"'muraki' is {100 * off:.2g} % (rms) off 'maxwell-eyring', which it approximates"
    )
    assert last == "data quality of the oil B and C (A printed to D estimated)"
    assert confidence([dataset.assign_attrs(validity="")]) == last


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (0.0, "0"),
        (9.96, "10"),
        (0.0995, "0.10"),
        (0.99999, "1.0"),
        (22040.0, "22000"),
        (-0.0151, "-0.015"),
    ],
)
def test_numbers_have_two_digits_and_no_exponent(value, said):
    assert two_digits(value) == said


@pytest.mark.parametrize(
    ("load", "unit", "said"),
    [
        (1223.4, "kN", "1.3 kN"),
        (1300.0, "kN", "1.3 kN"),
        (96.2, "N", "97 N"),
        (996.0, "N", "1000 N"),
        (772.3, "N", "780 N"),
    ],
)
def test_a_load_is_rounded_to_one_that_is_no_less(load, unit, said):
    assert format_rounded_up(load, unit) == said


def test_warnings_of_a_result_without_a_record_are_all_told(results):
    old = results["effective-friction"].assign_attrs(
        warnings='["mind the load", "and the oil"]', validity=""
    )
    assert collect_warnings([old, old]) == (["mind the load", "and the oil"], [])


def test_an_answer_tells_bounds_of_laws_itself_and_all_other_warnings_stay(results):
    dataset = results["effective-friction"]
    told, more = collect_warnings([dataset])
    more_warnings = json.dumps([*json.loads(dataset.attrs["warnings"]), "mind the load"])
    assert told
    assert more
    others, none = collect_warnings([dataset.assign_attrs(warnings=more_warnings)], laws=False)
    assert none == []
    assert others[-1] == "mind the load"
    bounds = {one["text"] for one in json.loads(dataset.attrs["validity"])["messages"]}
    assert bounds & {*told}
    assert not bounds & {*others}
