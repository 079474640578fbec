"""Alternatives of one scene: each is told as a run of it, and a winner only where data that scatter leave one."""

import json
import math

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

import rollslip
from coarse import coarse
from rollslip.cli.main import cli
from rollslip.errors import SceneError
from rollslip.results.accounts import account_of
from rollslip_campaigns.comparison import ComparisonSettings
from rollslip_campaigns.comparison.alternatives import ratio_band
from without_bands import run

SCENE = coarse(
    "gearbox",
    {"accuracy.slices": 3, "models.traction": "muraki", "cage.drag": ["churning"]},
)


@pytest.fixture(scope="module")
def oils():
    return rollslip.compare(SCENE, oil="iso-vg-68, iso-vg-220, nope")


@pytest.mark.soak
@pytest.mark.parametrize("oil", ["iso-vg-68", "iso-vg-220"])
def test_each_is_told_as_its_run_tells_it(oils, oil):
    alone = rollslip.run(rollslip.evolve(SCENE, {"lubricant": oil}, si=True), "steady-slip")
    rows = {row.key: row for row in rollslip.answer(alone).rows}
    one = oils.sel(alternative=oil)
    assert float(one.cage_slip) == rows["cage_slip"].value
    assert (float(one.cage_slip_low), float(one.cage_slip_high)) == rows["cage_slip"].band
    assert float(one.minimum_load) == rows["minimum_load"].value
    assert json.loads(oils.attrs["rows"])[oil]["friction_torque"] == rows["friction_torque"].text


@pytest.mark.slow
def test_the_better_stands_first_and_what_failed_last(oils):
    assert oils.alternative.values.tolist() == ["iso-vg-220", "iso-vg-68", "nope"]
    assert oils.status.values.tolist() == ["done", "done", "failed"]
    assert "no lubricant is called 'nope'" in str(oils.message.values[-1])
    assert np.diff(oils.cage_slip.values[:2]) > 0.0
    said = account_of(oils).sentences(oils)
    assert said[0].endswith("within the scatter of the data no clear winner over iso-vg-68")
    assert said[1].startswith("nope: ")
    assert account_of(oils).answer(oils).faults == (
        "nope: lubricant.name: no lubricant is called 'nope'",
    )


def test_what_cannot_run_is_named_before_the_others_run():
    planned = ComparisonSettings(SCENE, oil="iso-vg-68, iso-vg-220, nope").plan()
    [warning] = planned.unusual
    assert warning.startswith("nope is left out: lubricant.name: no lubricant is called 'nope'; ")
    assert "'rollslip models lubricant' lists them" in warning


@pytest.mark.slow
@pytest.mark.usefixtures("no_bands")
def test_models_of_rings_are_alternatives_too():
    tight = rollslip.evolve(
        SCENE, {"bearing.radial_clearance": "-5 um", "accuracy.tolerance": 5e-2}
    )
    found = rollslip.compare(tight, outer_ring="rigid, annulus, rubber")
    assert sorted(found.alternative.values[:2]) == ["annulus", "rigid"]
    assert json.loads(found.attrs["differ"]) == ["models.outer_ring"]
    assert "rubber" in str(found.message.values[-1])
    alone = run(rollslip.evolve(tight, {"models.outer_ring": "annulus"}), "steady-slip")
    assert float(found.cage_slip.sel(alternative="annulus")) == float(alone.steady_slip[0])
    assert float(found.cage_slip.sel(alternative="rigid")) != float(alone.steady_slip[0])


def _with_band(slip, **moved):
    rows = [
        {"key": key.replace("_", ".", 1), "values": [slip * end for end in ends]}
        for key, ends in moved.items()
    ]
    return xr.Dataset(
        {"steady_slip": ("steady", [slip])},
        attrs={"band": json.dumps({"steady_slip": {"changes": rows}})},
    )


def test_what_moves_both_alike_does_not_blur_their_ratio():
    """Two slips that a shared quantity halves and doubles: their ratio stays; one of each blurs it by the root."""
    one = _with_band(0.04, cage_drag=(0.5, 2.0), lubricant_alpha=(0.5, 2.0))
    other = _with_band(0.02, cage_drag=(0.5, 2.0), lubricant_alpha=(0.5, 2.0))
    assert ratio_band(one, other) == pytest.approx((2.0, 2.0))
    blurred = math.exp(math.sqrt(2.0) * math.log(2.0))
    assert ratio_band(one, other, own=("lubricant.",)) == pytest.approx(
        (2.0 / blurred, 2.0 * blurred)
    )
    assert ratio_band(one, one) == (1.0, 1.0)
    assert np.isnan(
        ratio_band(one, _with_band(-0.3, cage_drag=(0.5, 2.0)))
    ).all()  # of a cage that is driven
    assert np.isnan(ratio_band(one, xr.Dataset({"steady_slip": ("steady", [0.02])}))).all()


@pytest.mark.parametrize(
    ("slip", "ratio", "said"),
    [
        ((0.02, 0.03), (1.2, 1.9), "it slips less, with 95 % confidence, than B"),
        ((0.02, 0.03), (0.8, 1.9), "within the scatter of the data no clear winner over B"),
        ((0.02, 0.03), (1.04, 1.9), "within the scatter of the data no clear winner over B"),
        ((0.02, 0.02), (1.0, 1.0), "it slips as much as B"),
        ((1e-4, 9e-4), (0.1, 90.0), "it slips less than 0.1 %, as does B"),
        ((0.4, 0.5), (math.nan, math.nan), "it slips less, with unknown certainty, than B"),
        ((-0.4, 0.5), (math.nan, math.nan), "it slips less, with unknown certainty, than B"),
    ],
)
def test_a_winner_is_told_only_where_data_that_scatter_leave_one(slip, ratio, said):
    told = xr.Dataset(
        {
            "cage_slip": ("alternative", list(slip)),
            "ratio_low": ("alternative", [1.0, ratio[0]]),
            "ratio_high": ("alternative", [1.0, ratio[1]]),
            "status": ("alternative", ["done", "done"]),
            "message": ("alternative", ["", ""]),
        },
        {"alternative": ["A", "B"]},
        {"study": "alternatives"},
    )
    (sentence,) = account_of(told).sentences(told)
    assert sentence == f"A first: {said}"


@pytest.mark.parametrize(
    ("requested", "said"),
    [
        ({"oil": "iso-vg-68"}, "oil: name two at least"),
        ({"oil": "nope, nada"}, "no lubricant is called 'nope'"),
        (
            {"cage": ["brass", "steel"], "film": "moes"},
            "film: laws are compared by their curves, --cage by the answer",
        ),
    ],
)
def test_what_cannot_be_compared_is_refused(requested, said):
    with pytest.raises(SceneError, match=said):
        rollslip.compare("gearbox", **requested)


@pytest.mark.soak
def test_the_command_prints_a_table_and_json_has_its_numbers(tmp_path):
    requested = ["compare", "turbine", "--cage", "brass,polyamide", "--out", str(tmp_path / "out")]
    told = CliRunner().invoke(cli, requested)
    assert told.exit_code == 0, told.output
    assert "verdict" in told.output
    again = CliRunner().invoke(cli, [*requested, "--overwrite", "--json"])
    rows = json.loads(again.stdout)["alternatives"]
    assert {row["alternative"] for row in rows} == {"brass", "polyamide"}
    assert all(row["cage_slip"] > 0.0 and row["status"] == "done" for row in rows)


def test_a_name_that_there_is_not_is_a_mistake_as_any_other():
    for option, value in (("--oil", "iso-vg-68,nope"), ("--clearance-class", "CN,C9")):
        done = CliRunner().invoke(cli, ["compare", "gearbox", option, value])
        assert isinstance(done.exception, SceneError), done.output


@pytest.mark.slow
def test_measured_points_stand_beside_each_alternative(tmp_path):
    table = tmp_path / "slip.csv"
    table.write_text("cage_slip [%], cage_slip_uncertainty [%]\n2, 0.1\n", encoding="utf-8")
    found = rollslip.compare(SCENE, oil="iso-vg-68, iso-vg-220", measured=table)
    records = json.loads(found.attrs["measured"])
    assert [record["alternative"] for record in records] == found.alternative.values.tolist()
    assert [record["calculated"] for record in records] == found.cage_slip.values.tolist()
    row = rollslip.answer(found)["measured"]
    closest = min(records, key=lambda record: record["normalised_error"])
    assert row.text == f"{closest['alternative']} closest, 1 of 1 agree"
    figures = rollslip.plot(found)
    assert list(figures) == ["compare", "alternatives-measured"]
    labels = [text.get_text() for text in figures["compare"].legends[0].get_texts()]
    assert "measured, 2 %, and 95 %" in labels
