"""Whatever happens to a sweep, its result has the bits of one that nothing happens to, and counts what has failed.

The faults are drawn: tasks come back in any order, are computed twice, lost, lost with their worker or refused, and
Ctrl-C comes in between, once and twice. The processes that really die are in ``test_sweep_faults``.
"""

import contextlib
import functools
import json
import random
import signal
import sqlite3
import threading
from collections import Counter
from concurrent.futures import BrokenExecutor, Executor, Future
from contextlib import closing

import attrs
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rollslip
from rollslip.engine import Engine
from rollslip.errors import BusyError, EngineError, OutputError
from rollslip_campaigns.sweep.findings import SweepAccount
from rollslip_campaigns.sweep.folder import create_folder, read_status, write_result
from rollslip_campaigns.sweep.journal import (
    FAILED,
    STATUSES,
    Journal,
    Row,
    journal_files,
    only_writer,
    point_states,
    records,
    running,
)
from rollslip_campaigns.sweep.point import compute
from rollslip_campaigns.sweep.result import collect
from rollslip_campaigns.sweep.run import run_sweep
from rollslip_campaigns.sweep.sweep import open_sweep, plan_sweep, store_sweep

SCENE = rollslip.evolve(
    rollslip.load_scene("1032930-70C"), {"accuracy.slices": 5, "study.friction-curve.points": 5}
)
OVER = {
    "operation.radial_load": "500:5000:4",
    "models.traction.hydrodynamic": ["muraki", "eyring", "maxwell-eyring"],
}
#: Points of the sweep: four loads by three laws.
COUNT = 12

#: What can become of a task.
FATES = ("comes", "comes", "comes last", "comes twice", "lost", "dies", "refused", "Ctrl-C")


@attrs.frozen
class Fateful(Engine):
    """Computes in this thread, but for what is fated; when no fate is left, everything comes."""

    name = "fateful"
    fates: list = attrs.field(factory=list)
    seed: int = 0
    task_seconds: float = 0.0

    def executor(self):
        return _Fateful(self.fates, random.Random(self.seed))

    def workers(self, executor):
        return 3


class _Fateful(Executor):
    def __init__(self, fates, chance):
        self.fates = fates
        self.chance = chance
        self.late = []

    def submit(self, fn, /, *arguments):
        future = Future()
        fate = "comes"
        if fn is compute and self.fates:
            fate = self.fates.pop(0)
        if fate == "refused":
            raise RuntimeError("no more tasks")
        if fate == "Ctrl-C":
            signal.raise_signal(signal.SIGINT)
        if fate == "lost":
            future.set_exception(ConnectionError("gone"))
        elif fate == "dies":
            future.set_exception(BrokenExecutor("died"))
        elif fate == "comes last":
            timer = threading.Timer(
                self.chance.uniform(0.0, 0.02), lambda: future.set_result(fn(*arguments))
            )
            future.set_running_or_notify_cancel()
            timer.start()
        else:
            for _ in range(1 + (fate == "comes twice")):
                result = fn(*arguments)
            future.set_result(result)
        return future


@functools.cache
def planned():
    return planned_over(OVER)


def planned_over(over, **options):
    return plan_sweep(SCENE, over, study="friction-curve", output=["friction"], **options)


def same(one, other):
    """Whether two datasets hold the same bits, but for times."""
    return (
        one.drop_vars("seconds")
        .drop_attrs(deep=False)
        .identical(other.drop_vars("seconds").drop_attrs(deep=False))
    )


def counted(sweep, folder):
    """Check that everybody who counts points counts the same, and return that."""
    size = sweep.design.size
    dataset = collect(sweep, folder)
    told = read_status(folder, errors=1000)
    codes = point_states(folder, size)
    counts = Counter(STATUSES[code - 1] if code else "pending" for code in codes)
    assert Counter(dataset["status"].to_numpy().ravel().tolist()) == counts
    assert {
        name: count for name, count in json.loads(dataset.attrs["counts"]).items() if count
    } == dict(counts)
    assert told.counts == counts - Counter(pending=counts["pending"])
    assert told.total == size
    assert {number: of for number, of, _ in told.errors} == {
        number: STATUSES[code - 1] for number, code in enumerate(codes) if code > 1
    }
    assert len(read_status(folder, errors=1).errors) == min(1, len(told.errors))
    words = ", ".join(f"{counts[name]} {name}" for name in (*STATUSES, "pending") if counts[name])
    assert SweepAccount.topics(dataset)["points"] == [words]
    assert {
        name: count for name, count in SweepAccount.record(dataset)["counts"].items() if count
    } == dict(counts)
    left = [row["text"] for row in json.loads(dataset.attrs["validity"])["messages"]]
    warnings = [text for text in json.loads(dataset.attrs["warnings"]) if text not in left]
    assert bool(left) == (counts["ok"] > 0), "laws are judged where points have a result"
    assert bool(warnings) == (counts["ok"] < size)
    assert not warnings or warnings[0].startswith(
        f"{size - counts['ok']} of {size} points have no result: "
    )
    if "friction" in dataset:
        ranges = SweepAccount.record(dataset)["outputs"]["friction"]
        each = dataset["friction"].size // size
        assert ranges["missing"] == each * (size - counts["ok"])
        assert ranges["values"] == each * counts["ok"]
    return counts


@pytest.fixture(scope="module")
def serial(tmp_path_factory):
    folder = tmp_path_factory.mktemp("serial")
    sweep = planned()
    store_sweep(sweep, folder)
    run_sweep(sweep, folder, engine=rollslip.get_model("engine", "serial"))
    return collect(sweep, folder)


def survives(runs, seed, task_seconds, serial, folder):
    """Run a sweep again and again under what is fated; compare all that it gives meanwhile with the serial bits."""
    sweep = planned()
    store_sweep(sweep, folder)
    for fates in runs:
        with contextlib.suppress(EngineError, KeyboardInterrupt):
            settled = run_sweep(sweep, folder, engine=Fateful([*fates], seed, task_seconds))
            assert settled.interrupted or settled.progress.done == COUNT
        assert not running(folder)
        counted(sweep, folder)
        partial = collect(sweep, folder)
        done = (partial["status"] == "ok").to_numpy()
        if done.any():
            assert np.array_equal(
                partial["friction"].to_numpy()[done], serial["friction"].to_numpy()[done]
            )
            assert np.isnan(partial["friction"].to_numpy()[~done]).all()
    settled = run_sweep(open_sweep(folder), folder, engine=Fateful([], seed, task_seconds))
    assert settled.progress.done == COUNT
    assert set(settled.progress.counts) <= {
        "ok",
        "crashed",
    }  # one that dies alone too has killed its worker
    run_sweep(sweep, folder, engine=Fateful([], seed, task_seconds), retry_statuses=FAILED)
    assert counted(sweep, folder) == {"ok": COUNT}
    assert same(collect(sweep, folder), serial)


FATED = {
    "runs": st.lists(st.lists(st.sampled_from(FATES), max_size=COUNT), max_size=4),
    "seed": st.integers(0, 1000),
    "task_seconds": st.sampled_from([0.0, 0.005, 0.02, 10.0]),
}


@pytest.mark.slow
@settings(max_examples=3)
@given(**FATED)
def test_nothing_that_happens_changes_a_bit(runs, seed, task_seconds, serial, tmp_path_factory):
    survives(runs, seed, task_seconds, serial, tmp_path_factory.mktemp("fated"))


@pytest.mark.soak
@settings(max_examples=500)
@given(**FATED)
def test_nothing_that_happens_changes_a_bit_over_many_draws(
    runs, seed, task_seconds, serial, tmp_path_factory
):
    survives(runs, seed, task_seconds, serial, tmp_path_factory.mktemp("fated"))


# What failed is counted ----------------------------------------------------------------------------------------------


@settings(max_examples=7)
@given(
    journal_files=st.lists(
        st.lists(
            st.tuples(st.integers(0, COUNT - 1), st.sampled_from(STATUSES)), max_size=2 * COUNT
        ),
        max_size=3,
    )
)
def test_a_failed_point_is_counted_by_everybody_until_it_succeeds(journal_files, tmp_path_factory):
    folder = tmp_path_factory.mktemp("counted")
    sweep = planned()
    store_sweep(sweep, folder)
    rows = {
        row.number: row
        for row in compute(sweep.work, [(n, sweep.design.changes(n)) for n in range(COUNT)]).rows
    }
    wanted = dict.fromkeys(range(COUNT), "pending")
    for written in journal_files:
        journal = Journal(folder, {"engine": "serial", "sweep": sweep.hash})
        journal.write(
            [rows[n] if end == "ok" else Row(n, "", end, f"it {end}", 0.0) for n, end in written]
        )
        for number, ended in written:
            wanted[number] = "ok" if "ok" in (ended, wanted[number]) else ended
        journal.close("complete")
    assert counted(sweep, folder) == Counter(wanted.values())
    assert collect(sweep, folder)["status"].to_numpy().ravel().tolist() == [*wanted.values()]
    settled = run_sweep(sweep, folder, engine=Fateful())
    assert settled.progress.counts == counted(sweep, folder)
    assert (
        settled.progress.done - settled.progress.counts["ok"]
        == COUNT - settled.progress.counts["ok"]
    )
    assert settled.progress.computed == Counter(wanted.values())["pending"]


# Journals that were damaged, lost or put elsewhere -------------------------------------------------------------------


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """The folder of a sweep that is done."""
    sweep = planned()
    folder = create_folder(sweep, tmp_path_factory.mktemp("kept") / "s")
    run_sweep(sweep, folder, engine=rollslip.get_model("engine", "serial"))
    return folder


@pytest.mark.slow
@settings(max_examples=7)
@given(data=st.data())
def test_a_damaged_journal_is_refused_or_changes_no_bit(data, kept, serial, tmp_path_factory):
    content = bytearray((kept / "journal-000000.sqlite").read_bytes())
    damage = data.draw(st.sampled_from(["cut", "bit", "garbage", "zeros"]))
    place = data.draw(st.integers(0, len(content) - 1))
    if damage == "cut":
        del content[place:]
    elif damage == "bit":
        content[place] ^= 1 << data.draw(st.integers(0, 7))
    else:
        length = data.draw(st.sampled_from([16, 512, 4096]))
        new = bytes(length) if damage == "zeros" else random.Random(place).randbytes(length)
        content[place : place + length] = new[: len(content) - place]
    folder = tmp_path_factory.mktemp("damaged")
    (folder / "journal-000000.sqlite").write_bytes(content)
    (folder / "sweep.json").write_bytes((kept / "sweep.json").read_bytes())
    sweep = planned()
    said = ""
    try:
        read_status(folder)
        partial = collect(open_sweep(folder), folder)
    except OutputError as error:
        said = str(error)
        (folder / "journal-000000.sqlite").unlink()
    if said:
        assert "journal-000000.sqlite: is not a journal that can be read (" in said
        assert "move it away and resume" in said
    elif (done := (partial["status"] == "ok").to_numpy()).any():
        assert np.array_equal(
            partial["friction"].to_numpy()[done], serial["friction"].to_numpy()[done]
        )
    run_sweep(sweep, folder, engine=Fateful())
    assert same(collect(sweep, folder), serial)


@pytest.mark.parametrize(
    "change",
    [
        "number = number + 100",
        "key = key || 'x'",
        "status = 'failed'",
        "message = 'x'",
        "seconds = seconds + 1",
        "at = at + 1",
        "texts = texts || 'x'",
        "numbers = zeroblob(length(numbers))",
        "checksum = checksum + 1",
    ],
)
def test_every_value_of_a_row_is_under_its_checksum(change, kept, tmp_path):
    # written as SQLite writes it, so that nothing but the row itself can tell
    journal = tmp_path / "journal-000000.sqlite"
    journal.write_bytes((kept / journal.name).read_bytes())
    assert len(list(records(tmp_path))) == COUNT
    with closing(sqlite3.connect(journal)) as connection:
        assert connection.execute(f"update point set {change} where number = 3").rowcount == 1
        connection.commit()
    with pytest.raises(OutputError, match=r"the row of point (3|103) is damaged"):
        list(records(tmp_path))


def test_a_folder_that_has_lost_what_it_is_takes_its_journals_up_again(serial, tmp_path):
    sweep = planned()
    folder = create_folder(sweep, tmp_path / "s")
    run_sweep(sweep, folder, engine=Fateful())
    write_result(sweep, folder)
    (folder / "sweep.json").write_text("{")
    with pytest.raises(
        OutputError,
        match=r"cannot be read .*; remove it; the same command as before, with --out .*/s,",
    ):
        open_sweep(folder)
    (folder / "sweep.json").unlink()
    with pytest.raises(
        OutputError, match=r"there is no sweep\.json; the same command .* --out .*/s, makes"
    ):
        read_status(folder)
    with pytest.raises(
        OutputError, match=r"journal-000000.sqlite: is a journal of another sweep; move it away"
    ):
        create_folder(planned_over({"operation.radial_load": "1 kN"}), folder)
    assert create_folder(sweep, folder) == folder
    assert run_sweep(sweep, folder).why == "all points are done"
    assert same(write_result(sweep, folder), serial)
    assert len(journal_files(folder)) == 1


def test_a_journal_of_another_sweep_is_not_counted(kept, tmp_path):
    other = planned_over({"operation.radial_load": "500:5000:12"})
    folder = create_folder(other, tmp_path / "s")
    (folder / "journal-000000.sqlite").write_bytes((kept / "journal-000000.sqlite").read_bytes())
    for ask in (lambda: run_sweep(other, folder), lambda: collect(other, folder)):
        with pytest.raises(
            OutputError, match=r"journal-000000.sqlite: is a journal of another sweep; move it away"
        ):
            ask()


@pytest.mark.slow
def test_a_folder_has_one_writer_at_a_time(tmp_path):
    sweep = planned()
    folder = create_folder(sweep, tmp_path / "s")
    with only_writer(folder):
        assert running(folder)
        assert read_status(folder).running
        with pytest.raises(
            BusyError, match="s: is being computed; wait for it, or end it; how far it is: rol"
        ):
            run_sweep(sweep, folder)
    assert not running(folder)
    assert not journal_files(folder)
