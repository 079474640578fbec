"""The benchmarks compare like with like: peers that are here do the same work, and one that does not is left out.

And faults that are planted to try the tests stand in the files of today.
"""

import ast
import random
from pathlib import Path

import numpy as np
import pytest

import bench_chain
import contacts
import plant

NUMPY = {"NumPy, textbook", "NumPy, in place"}


@pytest.mark.parametrize("film", contacts.FILMS)
def test_peers_in_numpy_and_ours_do_the_same_work(film):
    peers = bench_chain.Peers(only=NUMPY)
    errors = peers.check(film)
    assert set(peers.ready) == {bench_chain.OURS, *NUMPY}
    assert not peers.missing
    assert max(errors[bench_chain.OURS]) < 2e-14


@pytest.mark.parametrize("film", contacts.FILMS)
def test_the_reference_takes_every_branch(film):
    _, taken = contacts.reference(film)
    assert all(taken[name] >= 5 for name in contacts.BRANCHES[film])


def test_a_peer_that_does_other_work_or_fails_is_left_out_in_words():
    def other(film, given):
        call, friction = bench_chain.ours(film, given)
        return call, lambda: friction() * (1 + 1e-9)

    def failing(film, given):
        raise ValueError("no such film")

    def no_number(film, given):
        return lambda: 0.0, lambda: np.full(len(given.load), np.nan)

    peers = bench_chain.Peers(only=set())
    peers.ready |= {"other": other, "failing": failing, "no number": no_number}
    peers.check("moes")
    assert set(peers.ready) == {bench_chain.OURS}
    assert (
        "does other work: its friction errs by 1.0e-09, allowed is 1e-12" in peers.missing["other"]
    )
    assert peers.missing["failing"] == "fails: ValueError: no such film"
    assert "errs by inf" in peers.missing["no number"]


def test_a_peer_that_cannot_be_had_is_said_with_the_reason():
    peers = bench_chain.Peers(only={"Numba, SVML"})
    assert set(peers.ready) == {bench_chain.OURS}
    assert "Numba, SVML" in peers.missing


def test_faults_to_be_planted_stand_in_their_files_once_and_their_tests_are_there():
    for fault in plant.faults():
        plant.line_of(fault, (plant.TREE / fault.file).read_text(encoding="utf-8"))
        for test in (*fault.tests, *[fault.seen_by] * ("::" in fault.seen_by)):
            path, _, name = test.partition("[")[0].partition("::")
            text = (plant.TREE / path).read_text(encoding="utf-8")
            assert f"def {name}" in text or f"class {name}(" in text, (fault.file, test)


@pytest.mark.slow
def test_faults_drawn_at_random_are_other_code_in_one_place(monkeypatch):
    monkeypatch.syspath_prepend(str(Path(__file__).parents[1] / "tools"))
    import random_faults

    path = "framework/rollslip/units.py"
    text = (random_faults.TREE / path).read_text(encoding="utf-8")
    places = list(random_faults.places(path, text))
    faults = [random_faults.fault_of(place, text, ()) for place in places]
    for fault in random.Random(5).sample(faults, 50):
        assert text.count(fault.old) == 1
        changed = text.replace(fault.old, fault.new)
        assert ast.dump(ast.parse(changed)) != ast.dump(ast.parse(text)), fault.new
    assert {"min", "max", "<=", "<", "-", "or", "and", "any", "all"} & {
        place.new for place in places
    }
    assert "tests/top_level/test_units.py" in random_faults.tests_of(path, "named")
    assert random_faults.tests_of(path, "suite") == ()
