"""Limits and balances of heat are those of brute force, tests/tools/references/brute_force.csv."""

import csv
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[1] / "tools/references"
TABLE = [one for one in csv.reader((FOLDER / "brute_force.csv").read_text("utf-8").splitlines()) if one[4]][1:]


def test_no_limit_and_no_temperature_is_missed():
    assert {one[7] for one in TABLE if one[0] != "damage"} <= {"kept", "within tolerance"}


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "k"), [("limit", 1), ("balance", 2), ("damage", 2)])
def test_a_scene_has_the_numbers_of_the_table(kind, k, monkeypatch):
    monkeypatch.syspath_prepend(FOLDER)
    import brute_force

    for again, stored in zip(brute_force.rows(kind, k), [o for o in TABLE if o[:2] == [kind, str(k)]], strict=True):
        assert [again[2], again[7]] == [stored[2], stored[7]]
        for one, other in zip(again[3].split(" to ") + again[4:5], stored[3].split(" to ") + stored[4:5], strict=True):
            assert float(one) == pytest.approx(float(other), rel=1e-4)
