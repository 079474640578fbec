"""Windows of loads: both limits are those of single runs, and each does what it is named for."""

import re

import numpy as np
import pytest
from click.testing import CliRunner

import rollslip
from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.cli.main import cli
from rollslip.errors import SceneError
from rollslip.results.accounts import account_of, answer
from rollslip.results.table import sheet
from rollslip.studies.quantities import quantities
from rollslip_campaigns.window import WindowSettings
from rollslip_campaigns.window.figures import draw_window, window_figures
from rollslip_campaigns.window.findings import describe_window
from rollslip_campaigns.window.window import plan_window
from rollslip_studies.variation.scatter import read_scatter

#: Few slices, and rollers set in the cage: quick, and both limits with all that belongs to them.
SCENE = evolve(
    load_scene("gearbox"),
    {
        "accuracy.slices": 5,
        "accuracy.tolerance": 0.05,
        "study.steady-slip.pockets": "set",
    },
)
#: Life asked for [h]: of the size that makers tabulate.
HOURS = 10_000.0
#: Speeds besides that of the scene, 1500 rpm.
OVER = "operation.inner_speed=1000rpm:2000rpm:2"


@pytest.fixture(scope="module")
def found():
    return rollslip.window(SCENE, OVER, hours=HOURS, engine="serial")


def test_the_scene_is_among_the_points(found):
    speeds = np.array([1000.0, 1500.0, 2000.0]) * np.pi / 30.0
    np.testing.assert_allclose(found["varied"], speeds, rtol=1e-12)
    assert found["own_point"] == 1
    assert float(found["radial_load"]) == SCENE.operation.radial_load


def test_below_the_minimum_load_the_cage_slips_more_than_allowed(found):
    least = float(found["minimum_load"][1])
    slips = [
        float(
            rollslip.run(
                evolve(SCENE, {"operation.radial_load": factor * least}, si=True), "steady-slip"
            )["steady_slip"][0]
        )
        for factor in (0.97, 1.03)
    ]
    assert slips[0] > found.attrs["acceptable_slip"] > slips[1]


def test_at_the_largest_load_the_bearing_has_the_hours(found):
    at_limit = evolve(SCENE, {"operation.radial_load": float(found["largest_load"][1])}, si=True)
    lives = rollslip.run(at_limit, "rating-life")
    limiting = lives["life_time"].sel(life_model=str(found["limited_by"][1].item()))
    assert float(limiting) == pytest.approx(3600.0 * HOURS, rel=1e-5)
    assert float(lives["life_time"].min()) == float(limiting)


def test_a_short_life_leaves_the_static_rating():
    found = rollslip.window(SCENE, OVER, hours=1e-3, static_safety=2.0, engine="serial")
    np.testing.assert_allclose(found["largest_load"], SCENE.bearing.static_rating / 2.0)
    assert set(found["limited_by"].values.tolist()) == {"static rating"}


@pytest.mark.parametrize(
    ("load", "place"), [(1.0, "below"), (5e3, "inside"), (1e6, "above"), (np.nan, "not known")]
)
def test_it_says_where_the_load_lies(found, load, place):
    changed = found.assign(radial_load=load)
    if np.isnan(load):
        changed = found.assign(minimum_load=found["minimum_load"] * np.nan)
    assert place in describe_window(changed)


def test_a_minimum_above_the_largest_load_is_an_empty_window(found):
    text = describe_window(found.assign(minimum_load=2.0 * found["largest_load"]))
    assert "no load is safe" in text


def test_of_the_rings_the_faster_one_varies():
    turned = {"operation.inner_speed": "0 rpm", "operation.outer_speed": "1500 rpm"}
    made = plan_window(WindowSettings(evolve(SCENE, turned)))
    assert made.varied.key == "operation.outer_speed"
    assert made.values[-1] == pytest.approx(100.0 * np.pi)


def test_without_its_own_value_it_says_both_ends(found):
    text = describe_window(found.assign(own_point=-1))
    assert text.count("inner speed") == 2
    assert "1000 rpm" in text
    assert "2000 rpm" in text


def test_its_figure_has_both_limits_and_the_operation(found):
    drawn = draw_window(found)
    names = [handle.get_text() for handle in drawn.legends[0].get_texts()]
    assert names[0] == "minimum load, slip"
    assert names[-1] == "this operation"
    lines = {line.get_label(): line for line in drawn.axes[0].get_lines()}
    np.testing.assert_allclose(lines["minimum load, slip"].get_ydata(), found["minimum_load"] / 1e3)
    np.testing.assert_allclose(lines["this operation"].get_xdata(), [1500.0])
    assert not list(
        window_figures(
            found.assign(
                minimum_load=np.nan * found["varied"], largest_load=np.nan * found["varied"]
            )
        )
    )


def test_its_answer_table_and_record_have_every_point(found):
    assert len(answer(found).table) == 4
    head, rows = sheet(found)
    assert head[:3] == ["operation.inner_speed [rpm]", "minimum_load [kN]", "largest_load [kN]"]
    assert len(rows) == 3
    assert rows[0][1] == pytest.approx(1e-3 * float(found["minimum_load"][0]))
    record = account_of(found).record(found)
    assert [point["minimum_load"] for point in record["points"]] == found[
        "minimum_load"
    ].values.tolist()


@pytest.fixture(scope="module")
def with_bands():
    return rollslip.window(SCENE, OVER, hours=HOURS, engine="serial", bands=True)


@pytest.mark.slow
def test_the_band_of_the_minimum_load_is_that_of_a_run(found, with_bands):
    np.testing.assert_allclose(with_bands["minimum_load"], found["minimum_load"], rtol=0.01)
    row = answer(rollslip.run(SCENE, "steady-slip"))["minimum_load"]
    bounds = [with_bands[f"minimum_load_{side}"][1].item() for side in ("low", "high")]
    assert bounds == pytest.approx(row.band, rel=0.01)


@pytest.mark.slow
def test_the_band_of_the_largest_load_is_the_root_sum_of_squares_of_what_scatters(with_bands):
    """Of the bearing, as runs at quantiles of 5 and 95 % have it."""
    hours = evolve(SCENE, {"study.rating-life.hours": HOURS}, si=True)
    scatter = read_scatter(SCENE, quantities(assemble(SCENE), {})).distributions
    nominal = with_bands["largest_load"][1].item()
    logs = [
        [
            np.log(float(rollslip.run(evolve(hours, {key: end}, si=True), "rating-life").largest_load.min()) / nominal)
            for end in distribution.quantile(np.array([0.05, 0.95])).tolist()
        ]
        for key, distribution in scatter.items()
        if key.startswith("bearing.")
    ]  # fmt: skip
    assert len(logs) == 3
    for side, changes in (
        ("low", np.minimum(logs, 0.0).min(1)),
        ("high", np.maximum(logs, 0.0).max(1)),
    ):
        found = np.log(with_bands[f"largest_load_{side}"][1].item() / nominal)
        assert abs(found) == pytest.approx(np.linalg.norm(changes), rel=1e-3)
        assert abs(found) > 0.01


@pytest.mark.slow
@pytest.mark.parametrize(
    ("load", "place"),
    [
        ("minimum_load_high", "inside the window at"),
        ("minimum_load", "within the band of the minimum load"),
        ("largest_load", "within the band of the largest load"),
    ],
)
def test_it_says_in_which_band_the_load_lies(with_bands, load, place):
    text = describe_window(with_bands.assign(radial_load=with_bands[load][1]))
    assert place in text
    assert re.search(r": [\d.]+ k?N \([\d.]+ k?N to [\d.]+ k?N\) to [\d.]+ kN \(", text)


def test_bands_are_in_rows_record_and_figure(found, with_bands):
    head, _ = sheet(with_bands)
    assert [name.partition(" [")[0] for name in head[1:7]] == [
        f"{load}_load{side}" for load in ("minimum", "largest") for side in ("", "_low", "_high")
    ]
    point = account_of(with_bands).record(with_bands)["points"][0]
    assert point["largest_load_high"] == with_bands["largest_load_high"][0].item()
    for result, count in ((found, 1), (with_bands, 3)):
        assert len(draw_window(result).axes[0].collections) == count


@pytest.mark.parametrize(
    ("over", "settings", "said"),
    [
        ("operation.radial_load=1kN:2kN", {}, "a window finds this load"),
        ("lubricant.name=iso-vg-68:iso-vg-100", {}, "is not a quantity with continuous values"),
        ("operation.inner_sped=1rpm:2rpm", {}, "inner_speed"),
        ("operation.inner_speed=1000rpm", {}, "write LOW:HIGH or LOW:HIGH:COUNT"),
        (["temperature=40degC:60degC", OVER], {}, "over one quantity, not 2"),
        (OVER, {"hours": 0.0}, "hours: must be above 0, got 0"),
        (OVER, {"static_safety": -1.0}, "static_safety: must be above 0, got -1"),
    ],
)
def test_wrong_settings_are_one_error_before_anything_runs(over, settings, said):
    with pytest.raises(SceneError) as caught:
        rollslip.window(SCENE, over, **settings)
    assert said in str(caught.value)


def test_points_without_result_are_named_and_exit_by_four(tmp_path):
    folder = tmp_path / "o"
    done = CliRunner().invoke(
        cli,
        [
            "window", "gearbox", "--over", OVER, "--set", "accuracy.slices=5", "--no-plots", "--time-limit", "1 ms",
            "--engine", "serial", "--out", str(folder),
        ],
    )  # fmt: skip
    assert done.exit_code == 4, done.output
    assert (
        "1.5 kN is in a window that is not known at inner speed 1500 rpm: unknown to" in done.output
    )
    assert "3 timed-out" in done.output
    stored = rollslip.open_result(folder / "window.nc")
    assert np.isnan(stored["minimum_load"]).all()
    assert set(stored["status"].values.tolist()) == {"failed"}
