"""What cannot be paid is refused at once, and what takes long is told before it is spent."""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.cli.main import cli
from rollslip.errors import SceneError
from rollslip.planning.lines import LONG_RUN, cost_sentences, format_time
from rollslip.planning.plan import plan, require_memory
from rollslip.results.text import duration
from rollslip.studies.study import settings
from rollslip_campaigns.sweep.sweep import plan_sweep
from tabled import TABLES, rows_of

DOCS = Path(__file__).parents[2] / "docs"
SCENE = "1032930-70C"
#: Study -> setting and number, so many points that their result exceeds the memory of any machine.
DEAR = {
    "effective-friction": ("points", 10**10),
    "friction-curve": ("points", 10**10),
    "steady-slip": ("points", 10**11),
    "dynamics": ("points", 10**11),
}


@pytest.mark.parametrize(("study", "setting"), DEAR.items(), ids=[*DEAR])
def test_a_result_that_no_memory_holds_is_refused_before_anything_runs(study, setting):
    name, number = setting
    scene = evolve(load_scene("1032930-50C"), {f"study.{study}.{name}": number}, si=True)
    with pytest.raises(
        SceneError, match=rf"study\.{study}\.{name} = 1e\+1[01] needs at least .* GB of memory"
    ):
        plan(scene, study)


def test_of_map_and_curve_the_one_that_asks_for_most_is_named():
    """8 numbers of 8 bytes for each of 1e6 cage slips and 2e6 - 1 roller slips."""
    scene = evolve(load_scene(SCENE), {"study.effective-friction.map_points": 10**6})
    with pytest.raises(
        SceneError, match=r"effective-friction\.map_points = 1e\+06 needs at least 1\.3e\+05 GB"
    ):
        plan(scene)


def test_memory_is_counted_in_bytes_and_enough_of_it_is_no_fault(monkeypatch):
    """10 numbers of 8 bytes for each of a thousand points of one curve."""
    scene = evolve(
        load_scene(SCENE), {"study.friction-curve": {"points": 1000, "normal_force": ["300 N"]}}
    )
    studies = settings(scene, "friction-curve")
    assembly = assemble(scene)
    monkeypatch.setattr("rollslip.planning.plan._memory", lambda: 80_000.0)
    require_memory(studies, assembly)
    monkeypatch.setattr("rollslip.planning.plan._memory", lambda: 79_999.0)
    with pytest.raises(
        SceneError, match=r"needs at least 8e-05 GB of memory, and this machine has 8e-05 GB"
    ):
        require_memory(studies, assembly)


def test_a_sweep_over_points_that_no_memory_holds_is_refused():
    with pytest.raises(SceneError, match=r"effective-friction\.points = 1e\+10 needs"):
        plan_sweep(load_scene(SCENE), over={"study.effective-friction.points": [101, 10**10]})


def test_nine_of_ten_runs_take_half_to_three_times_what_was_foreseen():
    """What `duration_range` says rests on the times of docs/scripts/plan_times.py."""
    rows = rows_of(TABLES / "plan_times.csv")
    assert len(rows) == 300
    once = [
        float(row["spent [s]"]) / float(row["told [s]"]) for row in rows if row["run again"] == "no"
    ]
    again = [
        float(row["spent [s]"]) / float(row["told [s]"])
        for row in rows
        if row["run again"] == "yes"
    ]
    assert len(once) >= 180
    assert sum(0.5 <= ratio <= 3.0 for ratio in once) >= 0.9 * len(once)
    assert np.median(again) > np.median(once)  # "longer if the check of a result requires more"


def test_what_takes_long_is_told_in_words():
    scene = load_scene(SCENE)
    assert cost_sentences(assemble(scene), {}, 0.5 * LONG_RUN, 0) == []
    (told,) = cost_sentences(assemble(scene), {}, 7200.0, 10**6)
    assert told.startswith("this will take 1 h 0 min to 6 h 0 min; Ctrl-C")
    (by_slices,) = cost_sentences(
        assemble(scene), {}, 0.0, 10**11
    )  # 20 ns each, whatever was estimated from small parts
    assert "this will take 16 min 40 s to 1 h 40 min;" in by_slices


def test_only_what_runs_again_may_take_longer_than_a_plan_tells():
    assembly = assemble(scene := load_scene(SCENE))
    longer = "0.5 to 3 s, longer if the check of a result requires more"
    for name, told in (("effective-friction", longer), ("dynamics", "0.5 to 3 s")):
        assert format_time(1.0, settings(scene, name).values(), assembly) == told
    exact = assemble(evolve(scene, {"accuracy.tolerance": "exact"}))
    assert format_time(1.0, settings(scene, "effective-friction").values(), exact) == "0.5 to 3 s"


def test_a_tolerance_that_nothing_reaches_is_told():
    scene = evolve(load_scene(SCENE), {"accuracy.tolerance": 1e-12})
    (told,) = cost_sentences(assemble(scene), {}, 0.0, 0)
    assert told.startswith(
        "accuracy.tolerance = 1e-12 is less than the finest of everything leaves"
    )
    assert (
        cost_sentences(assemble(evolve(scene, {"accuracy.tolerance": "exact"})), {}, 0.0, 0) == []
    )
    said = CliRunner().invoke(
        cli, ["plan", SCENE, "--study", "friction-curve", "--set", "accuracy.tolerance=1e-12"]
    )
    assert told in said.stdout


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.3, "0.3 s"),
        (59.0, "59 s"),
        (200.0, "3 min 20 s"),
        (7500.0, "2 h 5 min"),
        (1e6, "11 days"),
    ],
)
def test_a_time_reads_as_somebody_would_say_it(seconds, text):
    assert duration(seconds) == text
