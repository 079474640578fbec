"""Models are held against data sets: bands, verdicts and chi-square by known numbers, statements, and predictions."""

import itertools
import math
from types import SimpleNamespace

import attrs
import numpy as np
import pytest

from rollslip import evolve, load_scene, open_result, validate
from rollslip.catalogue.registry import get_model
from rollslip.cli.main import main
from rollslip.errors import DomainError, PluginError, SceneError
from rollslip.results.dataset import save
from rollslip.results.report import write_report
from rollslip.structure import FrozenTable
from rollslip_campaigns.measurement.values import Row, Series, Statement, Step
from rollslip_campaigns.sweep.sweep import resolution_at
from rollslip_campaigns.validation import ValidationSettings, observables
from rollslip_campaigns.validation import validate as way
from rollslip_campaigns.validation.observables import observe
from rollslip_campaigns.validation.predictions import form, read_predictions
from rollslip_campaigns.validation.residuals import Value, check_statement, compare_series
from rollslip_campaigns.validation.validate import run_validation
from synthetic_traction import exact, synthetic


def series_of(*rows):
    made = tuple(
        Row(
            changes=FrozenTable({"operation.radial_load": f"{k} N"}),
            measured=m,
            uncertainty=u,
            line=k,
        )
        for k, (m, u) in enumerate(rows, 1)
    )
    return Series(
        name="of nobody", quantity="cage-slip", unit="1", rows=made, about_uncertainty="made up"
    )


def values_of(*numbers):
    return [Value(number, "", 0.01) for number in numbers]


OF = ("nobody", "of nobody", "none")


def test_chi_square_is_that_of_both_uncertainties_and_of_what_rows_share():
    """Two rows with errors of their own 0.1 and a shared one of 0.2: by hand, with the inverse of a 2 x 2 matrix."""
    shared = 0.2 * np.array([-1.0, 1.0] * 50)
    samples = np.column_stack([1.0 + shared, 2.0 + shared])
    variance = np.var(shared, ddof=1)
    _, group = compare_series(
        OF, series_of((1.1, 0.1), (2.3, 0.1)), values_of(1.0, 2.0), samples, ""
    )
    a = 0.01 + variance
    b = variance
    by_hand = (a * (0.1**2 + 0.3**2) - 2 * b * 0.1 * 0.3) / (a**2 - b**2)
    assert group["chi2"] == pytest.approx(by_hand, rel=1e-12)
    assert group["freedom"] == 2
    assert group["probability"] == pytest.approx(
        math.exp(-by_hand / 2), rel=1e-9
    )  # of two degrees of freedom


@pytest.mark.parametrize(
    ("measured", "verdict"),
    [(1.0, "inside"), (1.45, "inside"), (1.53, "outside"), (0.47, "outside")],
)
def test_a_value_is_inside_within_two_deviations_of_both_together(measured, verdict):
    """0.2 and 0.15 make 0.25: 1.96 of it is 0.49."""
    from scipy.special import ndtri

    samples = 1.0 + 0.2 * ndtri((np.arange(400) + 0.5) / 400)
    [row], _ = compare_series(OF, series_of((measured, 0.15)), values_of(1.0), samples[:, None], "")
    assert row["row_verdict"] == verdict
    assert row["ratio"] == pytest.approx(1.0 / measured)
    assert row["calculated_low"] == pytest.approx(1.0 - 1.96 * 0.2, rel=0.01)
    assert row["calculated_high"] == pytest.approx(1.0 + 1.96 * 0.2, rel=0.01)
    for ratio in (row["ratio_low"], row["ratio_high"]):  # Fieller: K - r M is normal
        assert abs(1.0 - ratio * measured) / math.hypot(0.2, 0.15 * ratio) == pytest.approx(
            1.96, rel=0.03
        )


def test_values_beyond_the_range_are_larger_than_all_in_it():
    samples = np.array([0.5] * 50 + [math.inf] * 50)[:, None]
    [row], group = compare_series(
        OF, series_of((0.8, 0.01)), [Value(math.inf, "friction still rises", 0.0)], samples, ""
    )
    assert row["row_verdict"] == "inside"
    assert (row["calculated_low"], row["calculated_high"]) == (0.5, math.inf)
    assert math.isnan(group["chi2"])
    assert "beyond the range" in group["chi2_status"]


def test_values_that_are_not_known_leave_the_verdict_open():
    samples = np.array([0.5] * 90 + [math.nan] * 10)[:, None]
    [row], _ = compare_series(OF, series_of((0.5, 0.01)), values_of(0.5), samples, "")
    assert row["row_verdict"] == "cannot be determined"
    assert row["row_status"] == "10% of the samples have no value"
    few = np.array([0.5] * 98 + [math.nan] * 2)[:, None]  # up to 2.5 %, which the band leaves out
    assert (
        compare_series(OF, series_of((0.5, 0.01)), values_of(0.5), few, "")[0][0]["row_verdict"]
        == "inside"
    )


def test_too_few_samples_give_no_chi_square():
    _, group = compare_series(
        OF, series_of((1.0, 0.1), (2.0, 0.1)), values_of(1.0, 2.0), np.ones((8, 2)), ""
    )
    assert math.isnan(group["chi2"])
    assert "too few" in group["chi2_status"]


@pytest.mark.parametrize(
    ("expect", "values", "verdict"),
    [
        ("rises", (1.0, 2.0, 3.0), "held"),
        ("rises", (1.0, 1.01), "not held"),  # less than the 2 % that count
        ("rises", (1.0, math.inf), "held"),
        ("rises", (math.inf, math.inf), "cannot be determined"),
        ("falls", (3.0, 2.0), "held"),
        ("falls", (3.0, math.nan), "cannot be determined"),
        ("below", (0.1, 0.4), "held"),
        ("below", (0.1, 0.6), "not held"),
        ("above", (0.6, math.inf), "held"),
        ("none", (math.inf,), "held"),
        ("none", (0.3,), "not held"),
    ],
)
def test_a_statement_holds_or_not_as_its_values_go(expect, values, verdict):
    said = Statement(
        quantity="cage-slip", unit="1", text="", by_whom="", expect=expect, by=0.02,
        limit=0.5 if expect in ("below", "above") else None, steps=(Step(text=""),) * len(values),
    )  # fmt: skip
    assert check_statement(said, np.array(values)) == verdict


@pytest.fixture(scope="module")
def found():
    """The seed paper's data set, its first series and all statements, under its own models and another law."""
    sound = get_model("measurement", "klebanov-2022")
    return validate(
        [attrs.evolve(sound, series=sound.series[3:])], samples=24, traction="eyring-thermal"
    )


def test_the_calibrated_oil_gives_the_published_pair_and_another_law_does_not(found):
    verdicts = {
        model: list(found.row_verdict.to_numpy()[found.row_models.to_numpy() == model])
        for model in ("as stated", "eyring-thermal")
    }
    assert verdicts == {"as stated": ["inside"] * 2, "eyring-thermal": ["outside"] * 2}
    own = found.isel(row=np.flatnonzero(found.row_models == "as stated"))
    assert own.calculated.to_numpy() == pytest.approx(
        [0.1117, 0.5002], abs=2e-4
    )  # README of rollslip-klebanov
    assert found.attrs["evaluations"] == 4 * (1 + 24)
    assert (own.ratio_low < own.ratio).all()
    assert (own.ratio < own.ratio_high).all()


def test_a_validation_is_stored_and_reported(found, tmp_path):
    save(found, tmp_path / "validation.nc")
    assert open_result(tmp_path / "validation.nc").attrs["study"] == "validation"
    write_report({"validation": found}, {"validation": []}, tmp_path / "report.html")
    assert "calibrated oil" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_predictions_of_another_program_stand_beside_models(tmp_path):
    sound = get_model("measurement", "klebanov-2022")
    lines = form(sound).replace("program: NAME", "program: another").splitlines()
    filled = [
        f"{line[:-1]}0.105,0.004" if line.endswith(",,") and "epicyclic" in line else line
        for line in lines
    ]
    path = tmp_path / "another.csv"
    path.write_text(
        "\n".join(filled[:6]), encoding="utf-8"
    )  # the head, and the first row of the first series
    read = read_predictions(path, sound)
    empty = attrs.evolve(sound, statements=())
    plan = ValidationSettings([empty], predictions=[read], samples=0).plan()
    plan = attrs.evolve(plan, combinations=())
    made = run_validation(plan)
    assert list(made.row_models.to_numpy()) == ["another", "another"]
    assert list(made.row_verdict.to_numpy()) == [
        "inside",
        "cannot be determined",
    ]  # 11 % and 50 % measured


@pytest.mark.parametrize(
    ("there", "instead", "said"),
    [
        ("0.105", "nan", "predicted: a number is expected"),
        ("critical slip, epicyclic rollers", "critical slip of nobody", "has no row of line"),
        (",1,0.105", ",mm,0.105", "unit: 'mm'"),
        ("0.004", "-1", "uncertainty: a number from 0 on"),
        ("predicted", "guess", "missing columns: predicted"),
        ("parameters: 0", "parameters: few", "parameters: a whole number"),
    ],
)
def test_broken_predictions_are_refused(there, instead, said, tmp_path):
    sound = get_model("measurement", "klebanov-2022")
    lines = form(sound).splitlines()
    text = "\n".join([*lines[:5], f"{lines[5][:-1]}0.105,0.004"])
    assert there in text
    path = tmp_path / "p.csv"
    path.write_text(text.replace(there, instead), encoding="utf-8")
    with pytest.raises(SceneError, match=said):
        read_predictions(path, sound)


def test_the_variable_of_any_study_can_be_measured_and_a_wrong_one_is_named():
    [series, *_] = get_model("measurement", "klebanov-2022").series
    [value] = observe(series.scene, "effective-friction/skidding_slip", {}, [{}])
    assert 0.0 < value.value < 1.0
    with pytest.raises(
        SceneError, match="has no variable 'skidding_slipp'; did you mean 'skidding_slip'"
    ):
        observe(series.scene, "effective-friction/skidding_slipp", {}, [{}])
    with pytest.raises(SceneError, match="has 2 values along ring"):
        observe(series.scene, "critical-slip", {}, [{}])


@pytest.mark.slow
def test_many_points_have_the_resolution_of_a_plan_of_the_first_one(monkeypatch):
    scene = evolve(load_scene("1032930-70C"), {"study.steady-slip.pockets": "set"})
    points = [{"operation.radial_load": load} for load in (1000.0, 1100.0)]
    alone = [value.value for value in observe(scene, "steady-slip/drag_reserve", {}, points)]
    planned = []

    def plan_of(scene, study, changes):
        planned.append(changes)
        return resolution_at(scene, study, changes)

    monkeypatch.setattr(observables, "_PLANNED_FROM", 2)
    monkeypatch.setattr(observables, "resolution_at", plan_of)
    together = [value.value for value in observe(scene, "steady-slip/drag_reserve", {}, points)]
    assert planned == points[:1]
    assert together == pytest.approx(alone, rel=scene.accuracy.tolerance)


def test_a_film_is_held_against_one_at_the_same_place_alone():
    series = get_model("measurement", "film-limits").series[0]
    right, other = (
        way.nominal_values(series, way.Combination("", one))[0]
        for one in ({}, {"film": "dowson-toyoda"})
    )
    assert (right.reason, right.value) == ("", pytest.approx(series.rows[0].measured, rel=1e-3))
    assert other.reason == "dowson-toyoda gives the central film, measured was the minimum"


def test_samples_of_an_oil_beyond_its_models_are_counted_and_rows_share_the_time(monkeypatch):
    [series] = synthetic(exact("carreau", 2), 0.01, seed=1, count=2).series
    clock = SimpleNamespace(
        perf_counter=itertools.count().__next__
    )  # one second from one look to the next
    monkeypatch.setattr(way, "time", clock)
    assert way.nominal_values(series, way.AS_STATED)[0].seconds == pytest.approx(
        1 / len(series.rows)
    )

    def contacts(problem, oil, column, law):
        if oil is None:
            raise DomainError("beyond")
        return np.ones(len(series.rows))

    monkeypatch.setattr(way, "_sample_oils", lambda *_: ([None, "known"], ""))
    monkeypatch.setattr(way, "_contact_column", contacts)
    plan = ValidationSettings("klebanov-2022", samples=2).plan()
    _, samples, note = way._contact_values(series, way.AS_STATED, plan)
    assert np.isnan(samples).all(axis=1).tolist() == [True, False]
    assert note == "1 of 2 samples of the oil lie outside the domain of a model"
    with pytest.raises(SceneError, match="a band needs 2 at least"):
        ValidationSettings("klebanov-2022", samples=1).plan()


def test_names_that_nobody_offers_are_refused_before_anything_runs():
    with pytest.raises(PluginError, match="muraki"):
        ValidationSettings("klebanov-2022", traction="murak").plan()
    with pytest.raises(PluginError, match="klebanov-2022"):
        ValidationSettings("klebanov-2023").plan()


def test_the_command_writes_a_form_and_a_folder(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as leave:
        main(["validate", "klebanov-2022", "--form", "form.csv"])
    assert leave.value.code == 0
    filled = (tmp_path / "form.csv").read_text(encoding="utf-8")
    assert filled.count("klebanov-2022,") == 8
    with pytest.raises(SystemExit) as leave:
        main(["validate", "klebanov-2022", "--form", "form.csv"])
    assert leave.value.code != 0
    assert "form.csv: exists, perhaps with numbers in it" in capsys.readouterr().err
    assert (tmp_path / "form.csv").read_text(encoding="utf-8") == filled
    with pytest.raises(SystemExit) as leave:
        main(["validate", "klebanov-2022", "--samples", "0", "--no-plots", "--json"])
    assert leave.value.code == 0
    assert '"klebanov-2022-validation"' in capsys.readouterr().out
    assert [path.name for path in (tmp_path / "klebanov-2022-validation").glob("*.nc")] == [
        "validation.nc"
    ]
