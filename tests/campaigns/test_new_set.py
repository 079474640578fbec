"""A data set is written from a table of measured points and a scene, completely or not at all."""

import math
import shutil
from importlib.resources import files
from pathlib import Path

import numpy as np
import pandas
import pytest
from click.testing import CliRunner

import rollslip
from rollslip.cli.main import cli
from rollslip.errors import OutputError, SceneError
from rollslip.lubricant.base_oil import BASE_OILS
from rollslip.scene.changes import evolve
from rollslip.structure import scene_hash
from rollslip_campaigns.measurement import load_measurement
from rollslip_campaigns.validation.new_set import write_data_set
from rollslip_campaigns.validation.observables import observe

HEAD = "radial_load [kN], temperature [degC], models.film, cage_slip [%], cage_slip_uncertainty [%]"
SETS = Path(str(files("rollslip_campaigns.measurement.sets")))
DOCS = Path(__file__).parents[2] / "docs"


def written(folder, *lines, name="slip.csv"):
    path = folder / name
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


def test_a_table_and_a_scene_become_a_data_set(tmp_path):
    name = "steady-slip/limit_drag"
    table = written(
        tmp_path,
        f"{HEAD}, {name} [mN m], {name}_uncertainty [mN m]",
        "0.3, 70, moes, 0.3, 0.1, 200, 10",
        "2, 50, dowson-1968, 0.7, 0.1, 300, 10",
    )
    folder = write_data_set(str(tmp_path / "my-rig"), table, "1032930-70C")
    made = load_measurement(folder)
    assert (made.name, made.measured, made.is_form) == ("my-rig", True, False)
    slip, drag = made.series
    assert (slip.quantity, slip.unit) == ("cage-slip", "1")
    assert (drag.quantity, drag.unit) == (name, "N m")
    assert [row.measured for row in slip.rows] == pytest.approx([0.003, 0.007], rel=1e-12)
    assert [row.uncertainty for row in drag.rows] == pytest.approx([0.01, 0.01], rel=1e-12)
    assert dict(slip.rows[1].changes) == {
        "operation.radial_load": "2 kN",
        "operation.temperature": "50 degC",
        "models.film": "dowson-1968",
    }
    assert scene_hash(slip.scene) == scene_hash(rollslip.load_scene("1032930-70C"))


@pytest.mark.parametrize(
    ("name", "lines", "message"),
    [
        ("my-rig", (HEAD, "1, 70, moes, x, 0.1"), "slip.csv:2: cage_slip: 'x' is not a number alone"),
        ("My_Rig", (HEAD, "1, 70, moes, 2, 0.1"), "'My_Rig' is not made of small letters"),
        ("my-rig", (HEAD, *["1, 70, moes, 2, 0.1"] * 2), "the conditions of line 2 once more"),
    ],
)  # fmt: skip
def test_nothing_is_written_where_anything_is_wrong(tmp_path, name, lines, message):
    with pytest.raises(SceneError, match=message):
        write_data_set(str(tmp_path / name), written(tmp_path, *lines), "1032930-70C")
    assert [path.name for path in tmp_path.iterdir()] == ["slip.csv"]


def test_a_folder_that_is_there_is_left_as_it_is(tmp_path):
    table = written(tmp_path, HEAD, "1, 70, moes, 2, 0.1")
    with pytest.raises(OutputError, match="is left as it is"):
        write_data_set(str(tmp_path), table, "1032930-70C")


def test_the_command_writes_it_and_says_what_it_lacks(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    written(tmp_path, HEAD, "1, 70, moes, 2, 0.1")
    done = CliRunner().invoke(
        cli, ["validate", "new", "my-rig", "--from", "slip.csv", "--scene", "1032930-70C"]
    )
    assert done.exit_code == 0, done.output
    assert done.stdout.endswith("rollslip validate my-rig\n")
    assert load_measurement("my-rig").series[0].rows
    for arguments in (["new"], ["new", "other", "--from", "slip.csv"], ["my-rig", "--scene", "x"]):
        with pytest.raises(SceneError, match="new: name the data set, the table and the scene"):
            CliRunner().invoke(cli, ["validate", *arguments], catch_exceptions=False)


def test_a_measured_coefficient_of_an_oil_is_compared_with_that_of_its_law():
    """At no pressure the slope of the law, at 200 MPa ln(eta/eta0)/p of it."""
    [series] = load_measurement(SETS / "manjunath-2023").series
    assert series.at == {"pressure": "200 MPa"}
    points = [dict(row.changes) for row in series.rows]
    values = observe(series.scene, series.quantity, series.at, points)
    for value, row in zip(values, series.rows, strict=True):
        T = 273.15 + float(str(row.changes["operation.temperature"]).removesuffix(" degC"))
        oil = rollslip.get_model("lubricant", "fva-3").at(T)
        k = np.log(oil.viscosity) + 9.67  # Roelands (1966), as PHYSICS has it
        z = oil.pressure_viscosity / (5.1e-9 * k)
        expected = k * ((1.0 + 5.1e-9 * 2e8) ** z - 1.0) / 2e8
        assert value.value == pytest.approx(expected, rel=1e-6)
    [slope, _] = observe(series.scene, series.quantity, {}, points)
    assert slope.value == rollslip.get_model("lubricant", "fva-3").at(298.15).pressure_viscosity
    [failed] = observe(series.scene, series.quantity, {}, [{"operation.temperature": "900 degC"}])
    assert np.isnan(failed.value)
    assert failed.reason


def test_estimates_of_own_mineral_oils_are_below_measured_coefficients_and_fall_too_fast():
    """Table 2.3 of Stachowiak and Batchelor against the estimate of an own oil of its viscosities."""
    [series] = load_measurement(SETS / "stachowiak-batchelor-2001").series
    assert len(series.rows) == 38
    oils = {row.changes["lubricant.description"] for row in series.rows}
    assert len(oils) == 13
    values = observe(series.scene, series.quantity, {}, [dict(row.changes) for row in series.rows])
    ratio = np.array([v.value / r.measured for v, r in zip(values, series.rows, strict=True)])
    at = np.array([str(row.changes["operation.temperature"]) for row in series.rows])
    means = [ratio[at == f"{T} degC"].mean() for T in (30, 60, 100)]
    np.testing.assert_allclose(means, [0.933, 0.895, 0.859], atol=1e-3)
    assert (ratio.mean(), ratio.std(ddof=1)) == pytest.approx((0.895, 0.074), abs=1e-3)
    # what the scatter of the estimate states as its source
    within = np.abs(1.0 / ratio - 1.0) <= BASE_OILS["mineral"].alpha_scatter
    assert within.sum() == 35
    assert (1.0 / ratio.max(), 1.0 / ratio.min()) == pytest.approx((0.95, 1.31), abs=0.005)


def test_rows_of_the_printed_resistance_are_the_printed_numbers():
    """2 F R over W = w/(E' R) and U = eta u/(E' R), Table 1 of Zhou and Hoeprich (1991)."""
    series, _ = load_measurement(SETS / "zhou-hoeprich-1991").series
    radius = series.rig.rig.radius
    modulus = series.rig.rig.modulus
    assert modulus == pytest.approx(2.34e11, rel=1e-4)
    scale = modulus * radius
    load = [row.changes["load_per_length"] / scale for row in series.rows]
    speed = [0.05 * row.changes["rolling_speed"] / scale for row in series.rows]
    printed = [2.0 * radius * row.measured for row in series.rows]
    np.testing.assert_allclose(load, 1e-4 * np.array([1, 1.5, 2, 2.5, 3, 2, 2, 2, 2, 2]), rtol=1e-4)
    np.testing.assert_allclose(speed, 1e-11 * np.array([*[35] * 5, 1, 3, 10, 60, 100]), rtol=1e-4)
    np.testing.assert_allclose(
        printed,
        [0.5485, 0.6135, 0.66, 0.7031, 0.6933, 0.0623, 0.1455, 0.3172, 0.8781, 1.129],
        rtol=1e-4,
    )


def test_the_fit_of_the_authors_meets_their_solutions():
    """Their fit is within -8 and 16 % of their ten solutions (docs/tables/printed_resistance.csv)."""
    found = rollslip.validate(SETS / "zhou-hoeprich-1991", samples=0)
    fit = found.ratio.values[found.row_series.values == "rolling resistance, their fit"]
    assert (fit.min(), fit.max()) == pytest.approx((0.925, 1.16), abs=0.005)
    assert rollslip.answer(found).summary.startswith("calculated over what others computed: ")


def test_the_first_line_of_a_validation_says_how_near_measured_values_are():
    found = rollslip.validate([SETS / "manjunath-2023", SETS / "zhou-hoeprich-1991"], samples=0)
    summary = rollslip.answer(found).summary
    assert summary.startswith(
        "calculated over measured: pressure viscosity 0.98 (0.96 to 0.99); 2 of 2 inside both "
        "uncertainties; over what others computed: "
    )
    body = rollslip.answer(found).table[1:]
    assert [cells[2] for cells in body] == [*["outside"] * 7, "inside"]
    assert body[-1][0] == "temperature 25 degC"  # what was measured before what was computed


@pytest.mark.slow
@pytest.mark.parametrize(
    "rows", [slice(2, None, 4), pytest.param(slice(None), marks=pytest.mark.soak)]
)
def test_the_torque_that_was_measured_is_met_as_the_page_says(rows, tmp_path):
    """Ratios of docs/trust/torque.rst, computed by docs/scripts/measured_torque.py on 101 slices without slip."""
    folder = shutil.copytree(SETS / "wingertszahn-2023", tmp_path / "set")
    for name in ("axial.csv", "combined.csv"):
        head, *points = (folder / name).read_text(encoding="utf-8").splitlines()
        (folder / name).write_text("\n".join([head, *points[rows]]), encoding="utf-8")
    printed = pandas.read_csv(DOCS / "tables" / "measured_torque.csv")["default"]
    found = rollslip.validate(folder, samples=0)
    np.testing.assert_allclose(found.ratio, [*printed[:4][rows], *printed[4:][rows]], atol=0.015)


def test_rollers_of_the_measured_bearing_carry_its_loads():
    axial, combined = load_measurement(SETS / "wingertszahn-2023").series
    forces = rollslip.load_distribution(axial.scene).normal_force.sel(ring="outer")
    each = 6000.0 / (16 * math.sin(math.radians(15.64)))
    np.testing.assert_allclose(forces, each, rtol=1e-9)
    both = rollslip.load_distribution(evolve(combined.scene, combined.rows[0].changes, si=True))
    largest = float(both.normal_force.sel(ring="outer").max())
    # a model of all contacts and the rib, tools/references/tapered_row.csv, has 2275.5 N
    assert largest == pytest.approx(2275.5, rel=0.02)
