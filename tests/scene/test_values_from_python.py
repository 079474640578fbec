"""What Python gives in place of what a scene would hold: arrays, series, numbers of other libraries; and pickles."""

import decimal
import pickle

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import rollslip
from rollslip import evolve, load_scene, plan, plot, run, sweep
from rollslip.bearing.assembly import assemble
from rollslip.errors import RollslipError, SceneError

PAPER = load_scene("1032930-70C")
#: Two values [rad/s] that a range of Python, too, can give.
SPEEDS = [500.0, 600.0]


@pytest.mark.parametrize(
    "speeds",
    [
        np.array(SPEEDS),
        pd.Series(SPEEDS),
        pd.Index(SPEEDS),
        range(500, 700, 100),
        xr.DataArray(SPEEDS),
        xr.DataArray(np.array(SPEEDS) * 30.0 / np.pi, attrs={"units": "rpm"}),
    ],
    ids=lambda speeds: type(speeds).__name__,
)
def test_a_sweep_goes_over_whatever_holds_numbers(speeds):
    found = sweep(
        PAPER,
        over={"operation.inner_speed": speeds},
        study="friction-curve",
        output="critical_slip",
        engine="serial",
    )
    assert np.allclose(found.inner_speed, SPEEDS, rtol=1e-12)


@pytest.mark.parametrize(
    "load", [np.array(3000.0), np.float32(3000.0), decimal.Decimal(3000), xr.DataArray(3000.0)]
)
def test_a_number_of_another_library_is_a_number(load):
    assert evolve(PAPER, {"operation.radial_load": load}, si=True).operation.radial_load == 3000.0


@pytest.mark.parametrize("number", [3000, 3000.0, np.float64(3000.0), decimal.Decimal(3000)])
def test_a_number_without_a_unit_is_refused_unless_it_is_said_to_be_in_si_units(number):
    with pytest.raises(
        SceneError,
        match=r"radial_load: 3000(\.0)? has no unit, here a force is expected: write '3000",
    ):
        evolve(PAPER, {"operation": {"radial_load": number}})
    with_unit = xr.DataArray(float(number), attrs={"units": "N"})
    assert evolve(PAPER, {"operation.radial_load": with_unit}).operation.radial_load == 3000.0
    assert evolve(PAPER, {"operation.misalignment": 0}).operation.misalignment == 0.0


@pytest.mark.parametrize("rollers", [18, 18.0, np.int64(18), np.array(18)])
def test_a_whole_number_is_one_in_any_form(rollers):
    assert evolve(PAPER, {"bearing.rollers": rollers}).bearing.rollers == 18


def test_a_part_of_a_roller_is_refused():
    with pytest.raises(
        SceneError, match=r"bearing\.rollers: a whole number is expected, not 18\.5"
    ):
        evolve(PAPER, {"bearing.rollers": 18.5})


def test_a_scene_is_taken_by_its_name():
    assert evolve("1032930-70C", {"operation.radial_load": 3000.0}, si=True) == evolve(
        PAPER, {"operation.radial_load": 3000.0}, si=True
    )


def test_a_key_that_no_oil_has_is_refused_at_once():
    with pytest.raises(
        SceneError, match=r"'lubricant\.viscositty' is not a key, did you mean 'viscosity'\?"
    ):
        evolve(PAPER, {"lubricant.viscositty": 0.01}, si=True)


def test_a_scene_in_place_of_a_result_is_said():
    with pytest.raises(
        RollslipError, match=r"plot: a result is expected, .* plot\(run\('1032930-70C'\)\)"
    ):
        plot("1032930-70C")


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (
            lambda: evolve(PAPER, "operation.radial_load=3 kN"),
            "changes: values by key are expected",
        ),
        (lambda: evolve(PAPER, {"title": "a\0b"}), r"a text has the character U\+0000; remove it"),
        (lambda: evolve(PAPER, {5: 3000.0}, si=True), "changes: values by key are expected"),
        (lambda: load_scene({"bearing": {}}), "scene: a name or a path is expected, not a table"),
        (lambda: load_scene("NU 2316"), r"'NU 2316': is a bearing; .* rollslip\.new\('NU 2316'\)"),
        (lambda: rollslip.available(), "name a kind; there are: account, bearing, "),
        (lambda: plot({}), "plot: a result is expected, .* not a table"),
        (lambda: run(PAPER, ["steady-slip"]), "study: the name of one is expected, .* not a list"),
        (
            lambda: rollslip.answer("results"),
            r"answer: a result is expected, .* answer\(run\('results'\)\)",
        ),
        (lambda: rollslip.table(None), "table: a result is expected, .* not None"),
        (lambda: rollslip.info(5), "info: a result is expected, .* not 5"),
        (lambda: rollslip.report(None), "report: a result is expected, .* not None"),
    ],
)
def test_what_is_of_another_type_is_refused_in_words(call, said):
    with pytest.raises(RollslipError, match=said):
        call()


def test_what_was_made_of_a_scene_can_be_sent_elsewhere():
    there = pickle.loads(pickle.dumps(assemble(PAPER)))
    one, other = (
        of.inner.evaluate(np.array([2e4]), 10.0, 0.5).friction for of in (there, assemble(PAPER))
    )
    assert one == other
    quick = evolve(PAPER, {"study.friction-curve.points": 7, "accuracy.slices": 3})
    sent = pickle.loads(pickle.dumps(plan(quick, "friction-curve")))
    found = rollslip.planning.execution.execute(sent, "friction-curve")
    assert np.array_equal(found.friction, run(quick, "friction-curve").friction)


def test_a_command_without_a_function_is_named():
    with pytest.raises(AttributeError, match="'rollslip explain' is a command of the shell"):
        getattr(rollslip, "explain")  # noqa: B009
    assert not hasattr(rollslip, "nothing")
