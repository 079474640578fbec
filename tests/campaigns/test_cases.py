"""Tables of load cases: read with all faults, computed as single runs are, and summed over time."""

import json
import math

import numpy as np
import pandas
import pytest
import xarray
from click.testing import CliRunner
from openpyxl import Workbook

import rollslip
from rollslip.cli.main import cli
from rollslip.errors import SceneError, UnknownNameError
from rollslip.results.accounts import account_of, answer
from rollslip.results.table import sheet
from rollslip.results.text import format_hours
from rollslip.scene.interchange import Json, read_foreign, write_foreign
from rollslip.studies.rating_life.largest_load import basic_life
from rollslip.studies.rating_life.model import dynamic_rating
from rollslip_campaigns.cases import CaseSettings
from rollslip_campaigns.cases.cases import _values, plan_cases
from rollslip_campaigns.cases.figures import draw_cases
from rollslip_campaigns.cases.findings import (
    life_of_spectrum,
    mean_over_time,
    time_by_verdict,
    worst_first,
)
from scattered import SCATTERED

HEAD = "radial_load [kN], operation.inner_speed [rpm], share [%]"
ROWS = ("5, 6000, 20", "10, 3000, 30", "20, 3000, 50")


def written(folder, *lines, name="duty.csv"):
    path = folder / name
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


def planned(table):
    return plan_cases(CaseSettings(SCATTERED, table))


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cases")
    return rollslip.cases(SCATTERED, written(folder, HEAD, *ROWS), engine="serial")


@pytest.mark.slow
def test_a_case_is_a_run_of_its_scene(found):
    loads = found["radial_load"].to_numpy()
    speeds = found["inner_speed"].to_numpy()
    np.testing.assert_allclose(loads, [5e3, 1e4, 2e4])
    np.testing.assert_allclose(speeds, np.pi / 30.0 * np.array([6000.0, 3000.0, 3000.0]))
    scene = rollslip.evolve(
        SCATTERED, {"operation.radial_load": loads[1], "operation.inner_speed": speeds[1]}, si=True
    )
    alone = rollslip.run(scene, "steady-slip")
    for name, output in (("slip", "steady_slip"), ("friction_torque", "friction_torque")):
        assert found[name][1].item() == pytest.approx(alone[output][0].item(), rel=0.02)
    assert found["heat"][1].item() == pytest.approx(alone["loss"][:, 0].sum().item(), rel=0.02)
    assert found["film_parameter"][1].item() == pytest.approx(
        alone["film_parameter"][:, 0].min().item(), rel=0.02
    )


def test_the_time_is_that_of_the_table(found):
    np.testing.assert_allclose(found["time_fraction"], [0.2, 0.3, 0.5], rtol=1e-12)
    times = time_by_verdict(found)
    assert sum(times.values()) == pytest.approx(1.0)
    torque = found["friction_torque"].to_numpy()
    expected = 0.2 * torque[0] + 0.3 * torque[1] + 0.5 * torque[2]
    assert mean_over_time(found, "friction_torque") == pytest.approx(expected, rel=1e-12)


def test_lives_of_the_cases_add_up_as_parts_of_the_damage(found):
    """By ISO 281, (C/F_r)^(10/3) million revolutions, of which each case uses its part of the time."""
    rating, _ = dynamic_rating(SCATTERED.bearing)
    rpm = np.array([6000.0, 3000.0, 3000.0])
    load = np.array([5e3, 1e4, 2e4])
    hours = 1e6 * (rating / load) ** (10.0 / 3.0) / (60.0 * rpm)
    np.testing.assert_allclose(found["life"], 3600.0 * hours, rtol=1e-12)
    damage = np.array([0.2, 0.3, 0.5]) / hours
    assert life_of_spectrum(found) == pytest.approx(3600.0 / damage.sum(), rel=1e-12)
    stated = f"rating life {format_hours(3600.0 / damage.sum())} by ISO 281"
    assert stated in " ".join(str(answer(found)).split())


def test_a_case_without_load_has_no_end_of_life_and_no_part_in_the_damage(found):
    idle = found.assign(life=("case", [np.inf, 3.6e6, 3.6e6]))
    assert life_of_spectrum(idle) == pytest.approx(3.6e6 / 0.8)
    still = rollslip.evolve(SCATTERED, {"operation.radial_load": 0.0}, si=True)
    assert basic_life(still) == math.inf


def test_a_case_without_a_value_does_not_count_in_a_mean(found):
    torque = found["friction_torque"].copy()
    torque[0] = np.nan
    mean = mean_over_time(found.assign(friction_torque=torque), "friction_torque")
    assert mean == pytest.approx(0.375 * float(torque[1]) + 0.625 * float(torque[2]), rel=1e-12)
    assert np.isnan(
        mean_over_time(found.assign(friction_torque=torque * np.nan), "friction_torque")
    )


def test_the_worst_case_stands_first_by_verdict_and_then_by_slip(found):
    data = found.assign(
        verdict=("case", ["OK", "SKIDS", "SKIDS"]), slip=("case", [0.5, 0.3, np.nan])
    )
    assert worst_first(data) == [2, 1, 0]
    said = answer(data).summary
    assert said.startswith("skids 80 %, is OK 20 % of the time; worst is case 3, no steady slip")


def test_the_rows_come_back_with_their_values(found):
    head, rows = sheet(found)
    assert head[:3] == ["case", "operation.radial_load [kN]", "operation.inner_speed [rpm]"]
    assert [row[1] for row in rows] == [5.0, 10.0, 20.0]
    assert len(account_of(found).tables(found)[0].rows) == 3


def test_circles_have_areas_in_proportion_to_time(found):
    areas = np.sort(np.concatenate([c.get_sizes() for c in draw_cases(found).axes[0].collections]))
    np.testing.assert_allclose(areas, 300.0 * np.array([0.4, 0.6, 1.0]))


def test_csv_workbooks_frames_and_data_sets_are_the_same_cases(tmp_path):
    rows = [[5.0, 6000.0, 0.2], [10.0, 3000.0, 0.8]]
    names = ["radial_load [kN]", "operation.inner_speed [rpm]", "share"]
    frame = pandas.DataFrame(rows, columns=names)
    book = Workbook()
    for row in (names, *rows):
        book.active.append(row)
    book.save(tmp_path / "duty.xlsx")
    text = [", ".join(map(str, row)) for row in (names, *rows)]
    of_units = {"units": "rpm"}
    labelled = xarray.Dataset(
        {
            "operation.inner_speed": ("load", [6000.0, 3000.0], of_units),
            "share": ("load", [0.2, 0.8]),
        },
        {"radial_load": ("load", [5.0, 10.0], {"units": "kN"})},
    )
    tables = (written(tmp_path, "# two cases", *text), tmp_path / "duty.xlsx", frame, labelled)
    for made in map(planned, tables):
        assert made.sweep.design.changes(1) == pytest.approx(
            {"operation.radial_load": 1e4, "operation.inner_speed": 100.0 * np.pi}
        )
        np.testing.assert_allclose(made.table.fractions, [0.2, 0.8])


def test_hours_are_parts_of_their_sum_and_a_table_without_times_has_equal_parts(tmp_path):
    hours = planned(written(tmp_path, "radial_load [kN], time [h]", "1, 6", "2, 2"))
    np.testing.assert_allclose(hours.table.fractions, [0.75, 0.25])
    equal = planned(written(tmp_path, "radial_load [kN]", "1", "2", "3", "4"))
    np.testing.assert_allclose(equal.table.fractions, 0.25)


def test_a_column_of_names_changes_the_scene(tmp_path):
    table = written(
        tmp_path, "radial_load [kN], models.film", "5, moes", "10, dowson-1968", "6, moes"
    )
    made = planned(table)
    assert made.sweep.design.changes(1) == {
        "operation.radial_load": 1e4,
        "models.film": "dowson-1968",
    }
    assert made.sweep.design.describe_point(1).endswith("models.film = dowson-1968")
    other = written(tmp_path, "radial_load [kN], models.film", "5, moes", "10, moes", "6, moes")
    assert planned(other).sweep.hash != made.sweep.hash


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (["radial_load", "5"], r"duty.csv:1: operation.radial_load: the unit is missing; write"),
        (["radial_load [rpm]", "5"], r"duty.csv:1: operation.radial_load: .*rpm"),
        (["radial_lod [N]", "5"], r"did you mean 'operation.radial_load'"),
        (["radial_load [N]", "x"], r"duty.csv:2: operation.radial_load: 'x' is not a number alone"),
        (["radial_load [N]", "-5"], r"duty.csv:2: operation.radial_load: must be"),
        (["radial_load [N], share [%]", "5, 0"], r"the shares of all cases are zero"),
        (["radial_load [N], share [%]", "5, -1"], r"duty.csv:2: share: '-1' is below zero"),
        (["radial_load [N], share, time [h]", "5, 1, 1"], r"give share or time, and not both"),
        (["radial_load [N], load [kN]", "5, 1"], r"operation.radial_load stands there twice"),
        (["radial_load [N]", "5, 6"], r"duty.csv:2: 2 values under 1 columns"),
        (["share [%]", "5"], r"no column has a key of the scene"),
        (["models.film [m]", "moes"], r"models.film: has no unit"),
        (["radial_load [N]"], r"a head and a row below it are expected"),
    ],
)  # fmt: skip
def test_a_wrong_table_is_refused_with_its_place(tmp_path, lines, message):
    with pytest.raises(SceneError, match=message):
        planned(written(tmp_path, *lines))


def test_more_cases_than_anybody_waits_for_are_refused_with_a_way_out(monkeypatch):
    monkeypatch.setattr("rollslip_campaigns.cases.cases._MAX_COMPUTED", 2)
    table = pandas.DataFrame({"radial_load [kN]": [1.0, 2.0, 3.0]})
    with pytest.raises(SceneError, match=r"table: 3 cases are more than .* --interpolate '5 %'"):
        planned(table)
    assert plan_cases(CaseSettings(SCATTERED, table, interpolate="5 %")).sweep.design.size == 3
    assert planned(table.iloc[:2]).sweep.design.size == 2


def test_all_faults_of_a_table_stand_in_one_error(tmp_path):
    with pytest.raises(SceneError) as raised:
        planned(written(tmp_path, "radial_load [N]", "x", "5", "y"))
    assert [problem.partition(": ")[0] for problem in raised.value.problems] == [
        f"{tmp_path / 'duty.csv'}:2", f"{tmp_path / 'duty.csv'}:4",
    ]  # fmt: skip


def test_whole_numbers_may_be_written_as_spreadsheets_do(tmp_path):
    made = planned(written(tmp_path, "bearing.rollers, radial_load [kN]", "26.0, 5", "28, 5"))
    assert made.sweep.design.changes(0)["bearing.rollers"] == 26
    with pytest.raises(SceneError, match=r"duty.csv:2: bearing.rollers: 'x' is not a number"):
        planned(written(tmp_path, "bearing.rollers", "x"))


def test_a_file_that_is_no_workbook_is_refused(tmp_path):
    with pytest.raises(SceneError, match=r"duty.xlsx: cannot be read: File is not a zip file"):
        planned(written(tmp_path, "hello", name="duty.xlsx"))


def test_a_name_that_is_not_known_is_refused(tmp_path):
    with pytest.raises(UnknownNameError, match=r"models.film: no film is called 'moe'"):
        planned(written(tmp_path, "models.film", "moe"))


def test_what_is_no_table_is_refused():
    with pytest.raises(
        SceneError, match=r"a pandas.DataFrame or an xarray.Dataset is expected, not 5"
    ):
        planned(5)


@pytest.mark.slow
def test_cases_that_are_done_are_not_computed_again(tmp_path):
    table = written(tmp_path, "radial_load [kN]", "10", "20")
    first, second = (
        rollslip.cases(SCATTERED, table, out=tmp_path / "kept", engine="serial") for _ in range(2)
    )
    np.testing.assert_array_equal(first["seconds"], second["seconds"])


def test_the_command_opens_with_the_time_and_the_worst_case(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    written(tmp_path, "radial_load [kN]", "10", "20")
    changes = ("accuracy.slices=3", "accuracy.tolerance=0.05", "study.steady-slip.pockets=set")
    settings = [word for change in changes for word in ("--set", change)]
    done = CliRunner().invoke(
        cli, ["cases", "1032930-70C", "duty.csv", *settings, "--engine", "serial", "--json"]
    )
    assert done.exit_code == 0, done.output
    record = json.loads(done.stdout)
    assert record["counts"]["ok"] == 2
    assert record["worst_case"] == 1
    assert sum(record["time_by_verdict"].values()) == pytest.approx(1.0)
    assert record["answer"]["summary"].partition("; ")[2].startswith("worst is case 1, slip")


@pytest.mark.slow
@pytest.mark.usefixtures("no_bands")
def test_measured_points_stand_beside_the_cases(tmp_path):
    points = written(
        tmp_path,
        "radial_load [kN], inner_speed [rpm], cage_slip [%], cage_slip_uncertainty [%]",
        "10, 3000, 2, 0.5",
        name="points.csv",
    )
    table = written(tmp_path, "radial_load [kN], inner_speed [rpm]", "10, 3000", "20, 6000")
    cases = rollslip.cases(SCATTERED, table, measured=points, engine="serial")
    [record] = json.loads(cases.attrs["measured"])
    assert record["calculated"] == pytest.approx(cases["slip"][0].item(), rel=0.02)
    assert "; measured points: " in answer(cases).summary
    [bars] = draw_cases(cases).axes[0].containers
    np.testing.assert_allclose(bars.lines[0].get_xydata(), [[3000.0, 10.0]])
    bad = written(tmp_path, "cage_slip [%]", "1", name="bad.csv")
    with pytest.raises(SceneError, match="its standard uncertainty is missing"):
        plan_cases(CaseSettings(SCATTERED, table, measured=bad))


def test_measured_slips_have_bars_along_an_axis_of_slips(found):
    record = {
        "alternative": "", "quantity": "cage_slip", "unit": "1", "differing": [],
        "conditions": {"operation.radial_load": [1e4, "N"]}, "measured": 0.02, "standard_uncertainty": 0.005,
    }  # fmt: skip
    over_load = found.drop_vars("inner_speed").assign_attrs(measured=json.dumps([record]))
    [bars] = draw_cases(over_load).axes[0].containers
    assert bars.lines[0].get_xydata()[0].tolist() == pytest.approx([10.0, 2.0])
    [[low, high]] = bars.lines[2][0].get_segments()
    assert high[1] - low[1] == pytest.approx(2.0 * 1.96 * 0.5)


def with_cases(folder, text):
    """A file of a scene with a table [cases]."""
    scene = rollslip.load_scene("1032930-70C").text
    return written(folder, f"{scene}\n[cases]\n{text}", name="my.toml")


def test_a_scene_names_its_table_beside_it(tmp_path):
    folder = tmp_path / "scene"
    folder.mkdir()
    written(folder, HEAD, *ROWS)
    written(folder, "cage_slip [%], cage_slip_uncertainty [%]", "2, 0.5", name="slip.csv")
    scene = with_cases(folder, 'table = "duty.csv"\nmeasured = "slip.csv"')
    planned = plan_cases(CaseSettings(scene))
    assert planned.sweep.design.size == 3
    assert planned.sweep.scene.cases is None
    assert len(planned.measured.values) == 1
    other = written(tmp_path, "radial_load [kN]", "1")
    assert plan_cases(CaseSettings(scene, other)).sweep.design.size == 1


def test_what_is_wrong_with_the_table_of_a_scene_is_said(tmp_path):
    with pytest.raises(SceneError, match=r"cases: name a table of load cases: .*\[cases\]"):
        plan_cases(CaseSettings("1032930-70C"))
    with pytest.raises(SceneError, match=r"my.toml:\d+: cases.tabel: unknown key, did you mean"):
        plan_cases(CaseSettings(with_cases(tmp_path, 'tabel = "duty.csv"')))
    with pytest.raises(SceneError, match=r"duty.csv: cannot be read: No such file"):
        plan_cases(CaseSettings(with_cases(tmp_path, 'table = "duty.csv"')))


def test_a_table_of_cases_changes_no_run(tmp_path):
    plain = rollslip.load_scene("1032930-70C")
    scene = rollslip.load_scene(
        written(tmp_path, f'{plain.text}\n[cases]\ntable = "d.csv"', name="s.toml")
    )
    assert scene.cases == {"table": "d.csv"}
    slip = [rollslip.run(each, "friction-curve").critical_slip.values for each in (plain, scene)]
    np.testing.assert_array_equal(*slip)


def test_a_file_of_another_program_may_have_load_cases(tmp_path, monkeypatch):
    """JSON has none; the format of a package may. Here JSON takes the place of one."""
    file = tmp_path / "gearbox.json"
    write_foreign(SCATTERED, file)
    for table in (None, file):
        with pytest.raises(
            SceneError, match=r"json: has no table of load cases; give one as a file \.csv or"
        ):
            plan_cases(CaseSettings(read_foreign(file)[0], table))
    rows = [
        ("head", ["radial_load [kN]", "time [h]"]),
        ("case 1", ["5", "30"]),
        ("case 2", ["8", "10"]),
    ]
    monkeypatch.setattr(Json, "load_cases", lambda self, content, source: rows)
    for scene, table in ((read_foreign(file)[0], None), (SCATTERED, file)):
        found = plan_cases(CaseSettings(scene, table)).table
        np.testing.assert_allclose(found.fractions, [0.75, 0.25])
        np.testing.assert_allclose(found.design.samples, [[5e3], [8e3]])
    rows[2][1][0] = "high"
    with pytest.raises(SceneError, match=r"case 2: .*radial_load: 'high' is not a number alone"):
        plan_cases(CaseSettings(SCATTERED, file))


def test_heat_is_that_of_all_sources_where_cases_have_others():
    """A case without axial load has no ribs; one that was not computed has no heat."""
    loss = [[[3.0, 1.0, np.nan]], [[3.0, 1.0, 0.5]], [[np.nan] * 3]]
    found = xarray.Dataset({"loss": (("case", "steady", "source_index"), loss)})
    assert _values(found)["heat"].to_numpy() == pytest.approx([4.0, 4.5, np.nan], nan_ok=True)
