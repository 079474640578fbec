"""Clocks that somebody sets while a sweep is computed, or between two runs of it: hours forward, and hours back."""

import itertools
import re
import time

import numpy as np
import pytest

import rollslip
from rollslip_campaigns.sweep.command import sweep_standing
from rollslip_campaigns.sweep.folder import create_folder, read_status, write_result
from rollslip_campaigns.sweep.journal import Journal, Row, sessions
from rollslip_campaigns.sweep.run import run_sweep
from rollslip_campaigns.sweep.sweep import plan_sweep

SCENE = rollslip.evolve(
    rollslip.load_scene("1032930-70C"), {"accuracy.slices": 5, "study.friction-curve.points": 5}
)
OVER = {"operation.temperature": "60 degC:80 degC:6"}
#: By how much a clock is set [s]: far more than a run takes, so that no rounding of times hides it.
HOURS = 5 * 3600.0


def planned():
    return plan_sweep(SCENE, OVER, study="friction-curve", output=("friction",))


@pytest.fixture
def clock(monkeypatch):
    """The clock of the host, which a test sets by seconds; what is monotonic is not set with it."""
    true = time.time
    off = [0.0]
    monkeypatch.setattr(time, "time", lambda: true() + off[0])
    return off


@pytest.mark.parametrize("hours", [HOURS, -HOURS])
def test_a_clock_that_is_set_while_points_are_computed_loses_nothing(hours, clock, tmp_path):
    folder = create_folder(planned(), tmp_path / "s")
    told = []

    def report(progress):
        told.append(progress.seconds)
        clock[0] += hours

    run_sweep(planned(), folder, engine=rollslip.get_model("engine", "serial"), report=report)
    assert told == sorted(told)
    assert told[0] >= 0.0
    assert told[-1] < 60.0
    (session,) = sessions(folder)
    assert session.rows == 6
    assert 0.0 <= session.last - session.started < 60.0


@pytest.mark.slow
@pytest.mark.parametrize("hours", [HOURS, -HOURS])
def test_the_last_run_is_the_last_whatever_its_clock_says(hours, clock, tmp_path):
    """Two of six points in the first run and two in the second, each half a second after it begins."""
    sweep = planned()
    folder = create_folder(sweep, tmp_path / "s")
    numbers = itertools.count()
    for _ in range(2):
        journal = Journal(folder, {"engine": "serial", "sweep": sweep.hash})
        time.sleep(0.5)
        n = next(numbers), next(numbers)
        journal.write([Row(number, "", "crashed", f"point {number}", 0.2) for number in n])
        journal.close("interrupted")
        clock[0] += hours
    clock[0] -= hours
    found = read_status(folder, errors=3)
    assert [number for number, *_ in found.errors] == [1, 2, 3]
    assert found.left == pytest.approx(2 * 0.25, rel=0.5)
    assert 0.0 <= found.quiet < 60.0
    (pace,) = (line for line in sweep_standing(found) if "at the last pace" in line)
    assert re.search(r"pace (\d+ ms|\d\.\d+ s|under 1 s|1 s) left; .* ago$", pace), pace


@pytest.mark.parametrize("hours", [HOURS, -HOURS])
def test_a_sweep_is_gone_on_with_after_its_clock_was_set(hours, clock, tmp_path):
    """What failed before is computed again, and counts; what is known stays."""
    sweep = planned()
    reference = rollslip.sweep(SCENE, OVER, study="friction-curve", output=("friction",))
    folder = create_folder(sweep, tmp_path / "s")
    journal = Journal(folder, {"engine": "serial", "sweep": sweep.hash})
    journal.write([Row(0, "", "crashed", "a test", 0.2)])
    journal.close("interrupted")
    clock[0] += hours
    run_sweep(
        sweep, folder, engine=rollslip.get_model("engine", "serial"), retry_statuses=("crashed",)
    )
    assert read_status(folder).counts == {"ok": 6}
    assert read_status(folder).errors == []
    assert np.array_equal(write_result(sweep, folder)["friction"], reference["friction"])
