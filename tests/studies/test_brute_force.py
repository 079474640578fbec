"""Limits, balances of heat and worst values are those of brute force, tools/references/brute_force.csv."""

import csv
from collections import Counter

import pytest

from tabled import REFERENCES

#: Without scenes that are refused or take too long.
TABLE = [
    one
    for one in csv.reader((REFERENCES / "brute_force.csv").read_text("utf-8").splitlines())
    if one[4]
][1:]


def test_no_limit_no_temperature_and_no_worst_value_is_missed():
    """*Touched* is a limit at which the result turns back, of which the campaign says that it may be passed unseen."""
    found = Counter((one[0], one[7]) for one in TABLE)
    assert {verdict for _, verdict in found} <= {"kept", "within tolerance", "touched", "told"}
    assert found["limit", "kept"] >= 30
    scenes = Counter(kind for kind, _ in {(one[0], one[1]) for one in TABLE})
    assert scenes == {"limit": 50, "balance": 50, "damage": 50, "steady damage": 20}
    assert len({tuple(one[:2]) for one in TABLE if one[7] == "told"}) <= 2


@pytest.mark.soak
@pytest.mark.parametrize(("kind", "k"), [("limit", 8), ("balance", 2), ("damage", 41)])
def test_a_scene_has_the_numbers_of_the_table(kind, k, monkeypatch):
    monkeypatch.syspath_prepend(REFERENCES)
    import brute_force

    for again, stored in zip(
        brute_force.rows(kind, k), [o for o in TABLE if o[:2] == [kind, str(k)]], strict=True
    ):
        assert [again[2], again[7]] == [stored[2], stored[7]]
        for one, other in zip(
            again[3].split(" to ") + again[4:5], stored[3].split(" to ") + stored[4:5], strict=True
        ):
            assert float(one) == pytest.approx(float(other), rel=1e-4)
