"""Measured points beside a result: read with all faults, calculated at their conditions, compared and drawn."""

import json
import math

import numpy as np
import pandas
import pytest
import xarray as xr
from click.testing import CliRunner

import rollslip
from coarse import SET_COARSE
from rollslip.bearing.assembly import assemble
from rollslip.cli.main import cli
from rollslip.errors import ConvergenceError, SceneError
from rollslip.planning import execution
from rollslip.planning.execution import read_measured
from rollslip.results.accounts import answer, describe_measured, measured_rows
from rollslip.results.text import two_digits
from rollslip.studies import measured
from rollslip.studies.measured import compare_points
from rollslip_studies.steady_slip.study import SteadySlip
from scattered import SCATTERED

HEAD = "radial_load [kN], cage_slip [%], cage_slip_uncertainty [%]"
LOAD = SCATTERED.operation.radial_load


def written(folder, *lines, name="slip.csv"):
    path = folder / name
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


def points_of(table):
    return read_measured(table, assemble(SCATTERED))


def records_of(result):
    return json.loads(result.attrs["measured"])


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    table = written(
        tmp_path_factory.mktemp("measured"),
        f"{HEAD}, friction_torque [N m], friction_torque_uncertainty [N m]",
        f"{LOAD / 1e3}, 2, 0.5, 0.5, 0.1",
        "10, 90, 0.5, 0.5, 0.1",
    )
    return rollslip.run(SCATTERED, "steady-slip", measured=table)


@pytest.mark.slow
def test_values_are_calculated_at_the_conditions_of_their_rows(found):
    other = rollslip.run(
        rollslip.evolve(SCATTERED, {"operation.radial_load": 1e4}, si=True), "steady-slip"
    )
    own, _, slip, torque = records_of(found)
    assert own["calculated"] == found["steady_slip"][0].item()
    assert own["differing"] == []
    assert slip["differing"] == ["operation.radial_load"]
    assert slip["conditions"] == {"operation.radial_load": [1e4, "N"]}
    assert slip["calculated"] == pytest.approx(float(other["steady_slip"][0]), rel=1e-9)
    assert torque["calculated"] == pytest.approx(float(other["friction_torque"][0]), rel=1e-9)
    assert slip["measured"] == pytest.approx(0.9)
    assert slip["standard_uncertainty"] == pytest.approx(0.005)


@pytest.mark.slow
def test_the_normalised_error_has_both_expanded_uncertainties(found):
    """ISO 13528 with a coverage factor of 2; ends of the band are 1.645 standard deviations off."""
    _, _, slip, torque = records_of(found)
    of_band = (slip["high"] - slip["calculated"]) / 1.645
    expected = (0.9 - slip["calculated"]) / (2.0 * math.hypot(0.005, of_band))
    assert slip["normalised_error"] == pytest.approx(expected, rel=1e-9)
    side = "high" if torque["calculated"] < 0.5 else "low"
    of_band = (torque[side] - torque["calculated"]) / 1.645
    expected = abs(torque["calculated"] - 0.5) / (2.0 * math.hypot(0.1, of_band))
    assert torque["normalised_error"] == pytest.approx(expected, rel=1e-9)


@pytest.mark.slow
def test_the_answer_has_a_row_on_them(found):
    row = found.answer["measured"]
    errors = [record["normalised_error"] for record in records_of(found)]
    assert row.value == max(errors) > 1.0
    assert row.text == f"{sum(error <= 1.0 for error in errors)} of 4 agree"
    assert "without a band" not in row.note
    bare = [record | {"low": None, "high": None} for record in records_of(found)]
    (row,) = measured_rows(xr.Dataset(attrs={"measured": json.dumps(bare)}))
    assert "cage slip and friction torque without a band" in row.note
    assert list(found.answer.as_dict()["rows"])[1] == "measured"


@pytest.mark.slow
def test_each_point_is_a_sentence_of_the_report_and_of_the_details(found, tmp_path):
    sentences = describe_measured(found)
    assert len(sentences) == 4
    slip = sentences[2]
    assert slip.startswith("cage slip measured 90 % ± 1.0 % at radial load 10 kN calculated ")
    assert slip.endswith(
        f": normalised error {two_digits(records_of(found)[2]['normalised_error'])}"
    )
    assert sentences[3].startswith("friction torque measured 500 mN m ± 200 mN m at ")
    rollslip.report(found, out=tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert f"C{slip[1:]}" in page
    unknown = describe_measured(beside(found, None))
    assert unknown[0].endswith(": normalised error its band has no end")


def test_they_stand_in_the_figures_whose_axes_they_fit(found):
    figures = found.figures
    labels = {
        name: [text.get_text() for legend in figure.legends for text in legend.get_texts()]
        for name, figure in figures.items()
    }
    marked = {name for name, texts in labels.items() if "measured, 95 %" in texts}
    assert marked == {"steady-slip", "steady-slip-load", "steady-slip-measured"}
    [over_load] = figures["steady-slip-load"].axes
    [bars] = over_load.containers
    np.testing.assert_allclose(bars.lines[0].get_xydata(), [[LOAD / 1e3, 2.0], [10.0, 90.0]])
    slips, torques = figures["steady-slip-measured"].axes
    assert slips.get_xlabel() == "Radial load [kN]"
    assert torques.get_ylabel().startswith("Friction torque [")


def test_a_frame_and_a_workbook_are_the_same_points(tmp_path):
    names = [name.strip() for name in HEAD.split(",")]
    frame = pandas.DataFrame([[1.0, 2.0, 0.5]], columns=names)
    frame.to_excel(tmp_path / "slip.xlsx", index=False)
    as_printed = written(
        tmp_path, HEAD.replace("cage_slip", "cage slip"), "1, 2, 0.5", name="a.csv"
    )
    as_keys = written(tmp_path, HEAD, "1, 2, 0.5")
    for table in (frame, tmp_path / "slip.xlsx", as_keys, as_printed):
        [value] = points_of(table).values
        assert (value.value, value.uncertainty) == pytest.approx((0.02, 0.005))
        assert value.conditions == {"operation.radial_load": 1000.0}


def test_any_single_output_of_a_study_may_be_measured(tmp_path):
    name = "steady-slip/limit_drag"
    points = points_of(written(tmp_path, f"{name} [mN m], {name}_uncertainty [mN m]", "200, 10"))
    assert points.units[name] == "N m"
    assert [value.value for value in points.values] == pytest.approx([0.2])


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (["radial_load [kN], cage_slip [%]", "1, 2"], "cage_slip: its standard uncertainty is missing"),
        (["radial_load [kN], cage_slip_uncertainty [%]", "1, 2"], "has no column 'cage_slip'"),
        (["radial_load, cage_slip [%], cage_slip_uncertainty [%]", "1, 2, 1"],
         r"slip.csv:1: operation.radial_load: the unit is missing"),
        (["cage_speed, cage_speed_uncertainty [rpm]", "1, 2"], r"slip.csv:1: cage_speed: the unit is missing"),
        ([HEAD, "1, x, 1"], r"slip.csv:2: cage_slip: 'x' is not a number alone"),
        ([HEAD, "1, 2, 0"], r"slip.csv:2: cage_slip_uncertainty: must be above 0"),
        ([HEAD, "1, 2, -1"], r"slip.csv:2: cage_slip_uncertainty: '-1' is below zero"),
        ([HEAD, "-1, 2, 1"], r"slip.csv:2: operation.radial_load: must be"),
        ([f"{HEAD}, cage_slip [%]", "1, 2, 1, 2"], "cage_slip stands there twice"),
        (["cage_slp [%], cage_slip_uncertainty [%]", "1, 2"], "'cage_slp': is not a known column; did you mean"),
        (["slip [%], cage_slip_uncertainty [%]", "1, 2"], "did you mean 'cage_slip'"),
        (["radial_lod [kN], cage_slip [%]", "1, 2"], "did you mean 'operation.radial_load'"),
        (["radial_load [kN]", "1"], "no column has a measured value; there are .*cage_slip"),
    ],
)  # fmt: skip
def test_a_wrong_table_is_refused_before_anything_runs(tmp_path, lines, message):
    with pytest.raises(SceneError, match=message):
        rollslip.run(SCATTERED, "steady-slip", measured=written(tmp_path, *lines))


def test_conditions_that_are_no_bearing_are_refused_with_their_place(tmp_path):
    head = "bearing.rollers, cage_slip [%], cage_slip_uncertainty [%]"
    with pytest.raises(SceneError, match=r"slip.csv:3: .*rollers"):
        points_of(written(tmp_path, head, "28, 2, 1", "90, 2, 1"))


def test_a_name_that_is_not_known_is_refused_with_its_place(tmp_path):
    head = "models.film, cage_slip [%], cage_slip_uncertainty [%]"
    with pytest.raises(SceneError, match=r"slip.csv:3: .*no film is called 'moe'"):
        points_of(written(tmp_path, head, "moes, 2, 1", "moe, 2, 1"))


def test_a_point_that_cannot_be_calculated_says_why(tmp_path):
    points = points_of(written(tmp_path, HEAD, "1, 2, 0.5"))

    def fail(scene, study):
        raise ConvergenceError("no orbit")

    [record] = compare_points(points, SCATTERED, fail)
    assert (record["status"], record["calculated"]) == ("no orbit", None)
    assert record["normalised_error"] is None


def test_a_condition_is_that_of_the_scene_by_its_value_or_by_its_name():
    assert measured._is_same(300.0, 300)
    assert not measured._is_same(300.0, "300")
    assert measured._is_same("moes", "moes")


def beside(found, *errors, alternatives=("",)):
    """A result with points of some normalised errors."""
    first = records_of(found)[0]
    records = [
        first | {"alternative": name, "normalised_error": error}
        for name, error in zip(alternatives * len(errors), errors, strict=False)
    ]
    return found.complete()["steady-slip"].assign_attrs(measured=json.dumps(records))


def test_a_point_that_cannot_be_compared_is_counted(found):
    row = answer(beside(found, 0.5, None))["measured"]
    assert row.text == "1 of 1 agree"
    assert row.note.endswith("1 cannot be compared")
    row = answer(beside(found, None))["measured"]
    assert row.text == "not compared"
    assert math.isnan(row.value)


def test_of_alternatives_the_closest_one_is_named(found):
    row = answer(beside(found, 3.0, 0.5, alternatives=("a", "b")))["measured"]
    assert row.text == "b closest, 1 of 1 agree"
    assert row.value == 0.5
    assert row.note.endswith("a up to 3.0")


def test_an_open_band_decides_nothing(found):
    open_band = found.complete()["steady-slip"].copy()
    band = json.loads(open_band.attrs["band"])
    band["steady_slip"]["high"] = None
    open_band.attrs["band"] = json.dumps(band)
    points = points_of(
        pandas.DataFrame({"cage_slip [%]": [90.0, 0.01], "cage_slip_uncertainty [%]": [0.5, 0.01]})
    )
    above, below = compare_points(points, SCATTERED, lambda *_: open_band)
    assert above["normalised_error"] is None
    assert np.isfinite(below["normalised_error"])


@pytest.mark.slow
def test_the_command_reads_the_table_first_and_stores_the_comparison(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    written(tmp_path, HEAD, "3, 2, 0.5")
    written(tmp_path, HEAD, "x, 2, 0.5", name="bad.csv")
    base = [
        "run",
        "1032930-70C",
        "--study",
        "steady-slip",
        *SET_COARSE,
        "--no-plots",
        "--out",
        "out",
    ]
    with pytest.raises(SceneError, match=r"bad.csv:2"):
        CliRunner().invoke(cli, [*base, "--measured", "bad.csv"], catch_exceptions=False)
    assert not (tmp_path / "out").exists()
    done = CliRunner().invoke(cli, [*base, "--measured", "slip.csv", "--json"])
    assert done.exit_code == 0, done.output
    row = json.loads(done.stdout)["answer"]["rows"]["measured"]
    [record] = records_of(rollslip.open_result(tmp_path / "out" / "steady-slip.nc"))
    assert row["value"] == record["normalised_error"]


@pytest.mark.slow
def test_an_interrupted_comparison_keeps_the_results(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    written(tmp_path, HEAD, "3, 2, 0.5")

    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(execution, "with_measured", interrupt)
    monkeypatch.setattr(SteadySlip, "with_bands", lambda study, scene, dataset: dataset)
    arguments = ["--study", "steady-slip", *SET_COARSE, "--no-plots", "--out", "out"]
    done = CliRunner().invoke(cli, ["run", "1032930-70C", *arguments, "--measured", "slip.csv"])
    assert done.exit_code == 0, done.output
    assert "measured points are not compared" in done.stderr
    assert "measured" not in rollslip.open_result(tmp_path / "out" / "steady-slip.nc").attrs


def test_the_progress_names_each_point(found, tmp_path):
    points = points_of(written(tmp_path, HEAD, "1, 2, 0.5", "2, 2, 0.5"))
    said = []
    compare_points(
        points,
        SCATTERED,
        lambda *_: found.complete()["steady-slip"],
        "a",
        lambda text, fraction: said.append((text, fraction)),
    )
    place = tmp_path / "slip.csv"
    assert said == [(f"a {place}:2", 0.0), (f"a {place}:3", 0.5)]
