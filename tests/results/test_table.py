"""Tables for a spreadsheet: every number is the one of the result, in the unit of its column."""

import csv

import numpy as np
import openpyxl
import pytest
import xarray as xr
from click.testing import CliRunner

import rollslip
from coarse import SET_COARSE, coarse
from rollslip.cli.main import cli
from rollslip.results.accounts import answer
from rollslip.results.table import save_tables, sheet
from rollslip.units import quantity


@pytest.fixture(scope="module")
def swept():
    over = {"speed": ["500 rpm", "1500 rpm"], "temperature": ["60 degC", "80 degC"]}
    return rollslip.sweep(
        coarse("1032930-70C"),
        over,
        study="steady-slip",
        output=["slip", "limit_drag", "effective_friction"],
    )


@pytest.mark.slow
def test_a_run_has_the_rows_of_its_answer():
    scene = coarse("gearbox", {"accuracy.slices": 3, "models.traction": "muraki"})
    result = rollslip.run(scene, "steady-slip")
    head, rows = sheet(result)
    of_run = answer(result)
    cells = {label: (value, text) for label, value, *_, text, _ in rows}
    assert cells["verdict"] == (None, of_run.verdict)
    assert cells["bearing"] == (None, of_run.case[0])
    assert cells["Lambda"][0] == pytest.approx(float(result.film_parameter.min()), rel=1e-11)
    assert cells["kappa"][0] == pytest.approx(float(result.viscosity_ratio), rel=1e-11)
    assert [text for label, *_, text, _ in rows if label == "assumed"] == list(of_run.assumed)
    assert [label for label, *_ in rows if label.startswith("note ")] == [
        f"note {note.code}" for note in of_run.notes
    ]
    assert of_run.assumed
    assert of_run.notes
    by_label = {label: tuple(cells) for label, *cells in rows}
    for row in of_run.rows:
        if row.parts:
            continue
        value, unit, low, high, text, remark = by_label[row.label]
        assert (text, remark) == (row.text, row.note)
        scale = 0.01 if unit == "%" else 1.0 if unit == "" else quantity(f"1 {unit}", row.unit)
        assert (
            value is None
            if np.isnan(row.value)
            else value * scale == pytest.approx(row.value, rel=1e-11)
        )
        for end, of in zip((low, high), row.band or (np.nan, np.nan), strict=True):
            assert (
                end is None if not np.isfinite(of) else end * scale == pytest.approx(of, rel=1e-11)
            )
    assert head == ["quantity", "value", "unit", "low", "high", "in words", "remark"]


@pytest.mark.slow
def test_many_points_have_a_row_each_in_people_s_units(swept):
    head, rows = sheet(swept)
    assert head[:2] == ["operation.inner_speed [rpm]", "operation.temperature [degC]"]
    assert [row[:2] for row in rows] == [[n, t] for n in (500.0, 1500.0) for t in (60.0, 80.0)]
    slip = [row[head.index("steady_slip [%]")] for row in rows]
    np.testing.assert_allclose(slip, 100.0 * swept["steady_slip"].to_numpy().ravel(), rtol=1e-11)
    assert {"effective_friction inner", "effective_friction outer"} <= set(head)
    assert {row[head.index("status")] for row in rows} == {"ok"}


@pytest.mark.slow
def test_in_python_a_table_is_one_of_pandas(swept):
    made = rollslip.table(swept)
    (head, rows) = sheet(swept)
    assert list(made.columns) == head
    assert made["steady_slip [%]"].to_list() == [row[head.index("steady_slip [%]")] for row in rows]


def test_what_is_not_known_is_an_empty_cell_and_a_curve_stays_in_its_file():
    status = xr.DataArray(["ok", "failed"], dims="point")
    value = xr.DataArray([0.25, np.nan], dims="point", attrs={"units": "m"})
    curve = xr.DataArray(np.ones((2, 50)), dims=("point", "x"))
    assert sheet(xr.Dataset({"status": status, "value": value, "curve": curve})) == (
        ["status", "value [mm]"],
        [["ok", 250.0], ["failed", None]],
    )


@pytest.mark.slow
def test_the_command_writes_tables_and_no_plots_unless_asked(tmp_path):
    done = CliRunner().invoke(
        cli,
        [
            "run",
            "1032930-70C",
            "--study",
            "steady-slip",
            *SET_COARSE,
            "--set",
            "models.traction=muraki",
            "--format",
            "csv,xlsx",
            "--format",
            "csv",
            "--out",
            f"{tmp_path}/out",
        ],
    )
    assert done.exit_code == 0, done.output
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {"answer.csv", "answer.xlsx", "steady-slip.nc", "manifest.json"}
    with (tmp_path / "out" / "answer.csv").open(newline="", encoding="utf-8") as file:
        told = list(csv.reader(file))
    sheet = openpyxl.load_workbook(tmp_path / "out" / "answer.xlsx").active
    for row, cells in zip(told, sheet.iter_rows(values_only=True), strict=True):
        for text, cell in zip(row, cells, strict=True):
            assert (
                (float(text) == cell) if isinstance(cell, int | float) else (text == (cell or ""))
            )


def test_a_text_is_no_formula_and_no_control_character_in_a_cell(tmp_path):
    texts = ["=1+1", "@x", "-5 %", "+-", "a\0b"]
    shown = ["'=1+1", "'@x", "-5 %", "'+-", "a\\x00b"]
    points = xr.Dataset({"status": ("p", texts)}, attrs={"study": "none"})
    save_tables({"t": points}, tmp_path, ["csv", "xlsx"])
    rows = list(csv.reader((tmp_path / "t.csv").read_text(encoding="utf-8").splitlines()))
    assert [row[0] for row in rows[1:]] == shown
    book = openpyxl.load_workbook(tmp_path / "t.xlsx").active
    assert [cell.value for cell in book["A"]][1:] == shown
