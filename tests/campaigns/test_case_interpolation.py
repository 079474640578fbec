"""Values between computed cases: exact on powers, computed where kinds change, and an error that is checked."""

import json

import numpy as np
import pytest

import rollslip
from rollslip.errors import SceneError
from rollslip.results.accounts import answer
from rollslip_campaigns.cases import CaseSettings, interpolation
from rollslip_campaigns.cases.cases import plan_cases
from rollslip_campaigns.cases.interpolation import interpolate_cases
from scattered import PLAIN

LOADS = np.random.default_rng(0).uniform(1e3, 2e4, 3000)
SPEEDS = np.random.default_rng(1).uniform(500.0, 3000.0, 3000)
COLUMNS = np.stack([LOADS, SPEEDS], axis=1)


def computed_by(values, requested):
    """Return a function that computes cases, and records how many it was asked for."""

    def compute(numbers):
        requested.append(len(numbers))
        table = np.full(values.shape, np.nan)
        table[numbers] = values[numbers]
        return table

    return compute


def found_of(values, tolerance=0.01, floors=None, columns=COLUMNS):
    requested = []
    floors = np.zeros(values.shape[1]) if floors is None else np.array(floors)
    found = interpolate_cases(columns, computed_by(values, requested), tolerance, floors)
    assert requested[-1] == found.is_computed.sum()
    return found


def test_powers_of_the_columns_are_exact_from_the_fewest_cases():
    """A thin-plate spline has all linear functions, and the logarithm of a power is one."""
    values = np.stack([LOADS**-1.5 * SPEEDS**0.7, -(LOADS**0.2)], axis=1)
    found = found_of(values)
    assert found.is_computed.sum() == 2 * interpolation._FIRST_NODES + interpolation._CHECKS
    assert found.values == pytest.approx(values, rel=1e-9)
    assert found.error < 1e-9


@pytest.mark.slow
def test_the_stated_error_is_that_of_other_cases_and_keeps_the_tolerance():
    values = np.stack(
        [1e-2 + 5.0 * np.exp(-LOADS / 4e3) * SPEEDS**0.5, LOADS + 10.0 * SPEEDS], axis=1
    )
    for tolerance in (0.2, 0.02):
        found = found_of(values, tolerance)
        errors = np.abs(found.values / values - 1.0).max(axis=1)
        assert found.error <= tolerance
        assert np.quantile(errors[~found.is_computed], 0.9) <= found.error
        assert (errors[found.is_computed] == 0.0).all()
    assert found.is_computed.mean() < 0.25  # or interpolation would hardly be worth its while


def test_cases_between_kinds_of_results_are_computed():
    """Above a speed that rises with the load there is no slip: a value is infinite, another is missing."""
    slips = 1e3 / LOADS
    skids = SPEEDS > 1000.0 + 0.1 * LOADS
    values = np.stack([np.where(skids, np.nan, slips), np.where(skids, np.inf, LOADS)], axis=1)
    found = found_of(values)
    assert np.array_equal(np.isnan(found.values[:, 0]), skids)
    assert np.array_equal(np.isinf(found.values[:, 1]), skids)
    assert np.allclose(found.values[~skids], values[~skids], rtol=0.01)


def test_differences_below_the_floor_of_a_value_do_not_count():
    noise = 1.0 + np.random.default_rng(2).uniform(-1.0, 1.0, LOADS.size)
    values = np.stack([1e-6 * noise, LOADS], axis=1)
    assert found_of(values, floors=[1e-3, 0.0]).is_computed.sum() < 100
    assert found_of(values[:500], columns=COLUMNS[:500]).is_computed.all()


def test_columns_that_are_equal_or_move_together_are_one_direction():
    columns = np.stack([LOADS, LOADS**2, np.full(LOADS.size, 3.0)], axis=1)
    values = LOADS[:, None] ** -0.5
    assert found_of(values, columns=columns).values == pytest.approx(values, rel=1e-9)


def test_words_and_gaps_come_from_the_nearest_computed_case():
    found = found_of(LOADS[:, None])
    assert found.is_computed[found.nearest].all()
    own = np.flatnonzero(found.is_computed)
    assert np.array_equal(found.nearest[own], own)


def duty(folder, *head):
    """Write 24 cases over two loads and speeds, which the scene carries without a jump."""
    loads = np.geomspace(4.0, 12.0, 6)
    rows = [f"{load:.4f},{speed}" for load in loads for speed in (3000, 3500, 4000, 4500)]
    path = folder / "duty.csv"
    path.write_text("\n".join([",".join(head), *rows]), encoding="utf-8")
    return path


@pytest.mark.slow
def test_the_command_computes_some_cases_and_says_how_exact_the_others_are(tmp_path, monkeypatch):
    monkeypatch.setattr(interpolation, "_FIRST_NODES", 6)
    monkeypatch.setattr(interpolation, "_CHECKS", 3)
    table = duty(tmp_path, "radial_load [kN]", "inner_speed [rpm]")
    found = rollslip.cases(PLAIN, table, interpolate="20 %", engine="serial")
    methods = found["method"].to_numpy().tolist()
    assert 12 <= methods.count("computed") < 24
    assert set(methods) == {"computed", "interpolated"}
    assert (found["status"] == "ok").all()
    assert found["verdict"].to_numpy().tolist().count("") == 0
    assert found.attrs["interpolation_error"] <= 0.2
    assert json.loads(found.attrs["counts"])["ok"] == 24
    assert "pending" not in found.attrs["warnings"]
    guessed = np.flatnonzero(found["method"].to_numpy() == "interpolated")
    head, *rows = table.read_text(encoding="utf-8").splitlines()
    table.write_text("\n".join([head, *(rows[k] for k in guessed)]), encoding="utf-8")
    whole = rollslip.cases(PLAIN, table, engine="serial")
    torques = found["friction_torque"][guessed]
    np.testing.assert_allclose(torques, whole["friction_torque"], rtol=0.2)
    slips = whole["slip"].to_numpy()
    assert (np.abs(found["slip"][guessed] - slips) <= 0.2 * np.maximum(slips, 1e-2)).all()
    count = guessed.size
    assert f"{count} of 24 cases are interpolated: 3 drawn at random" in str(answer(found))


@pytest.mark.parametrize("given", ["0", "2", "five", -0.1])
def test_a_wrong_error_is_refused(tmp_path, given):
    table = duty(tmp_path, "radial_load [kN]", "inner_speed [rpm]")
    with pytest.raises(
        SceneError, match=r"interpolate: a fraction such as 0\.05 or '5 %' is expected"
    ):
        plan_cases(CaseSettings(PLAIN, table, interpolate=given))


def test_names_are_not_interpolated(tmp_path):
    path = tmp_path / "duty.csv"
    path.write_text("radial_load [kN],lubricant.name\n5,iso-vg-68\n6,iso-vg-220", encoding="utf-8")
    with pytest.raises(SceneError, match=r"has names in lubricant\.name, between which nothing"):
        plan_cases(CaseSettings(PLAIN, path, interpolate="5 %"))
