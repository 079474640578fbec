"""How finely sweeps compute their points, and what of a study they compute."""

import json
from types import SimpleNamespace

import attrs
import numpy as np
import pytest
import xarray as xr

from rollslip import run, sweep
from rollslip.bearing.assembly import assemble
from rollslip.bearing.resolution import reference_resolution
from rollslip.scene.changes import evolve
from rollslip.scene.reading import load_scene
from rollslip.studies.outputs import evaluate, named_outputs
from rollslip.studies.study import settings
from rollslip_campaigns.sweep.point import compute, unpack_values
from rollslip_campaigns.sweep.result import deviations_from_run
from rollslip_campaigns.sweep.sampling import probabilities
from rollslip_campaigns.sweep.sweep import plan_sweep
from rollslip_studies.steady_slip.study import SteadySlip

OVER = {"lubricant.pressure_viscosity_factor": "0.75:1.25"}


class TestTheResolutionOfASweep:
    """It is chosen once, before the first point, and belongs to what the sweep is."""

    @pytest.mark.slow
    def test_points_keep_the_error_that_the_scene_states_with_fewer_slices(self):
        made = plan_sweep(
            "1032930-70C", OVER, samples=128, output=["critical_cage_slip", "critical_friction"]
        )
        (chosen,) = made.resolutions.chosen.values()
        assert chosen.slices < 801
        assert chosen.n_positions < 128
        for number in (90,):
            changes = made.design.changes(number)
            (row,) = compute(made.work, [(number, changes)]).rows
            found = unpack_values(json.loads(row.layout), row.numbers, row.texts)
            scene = evolve(load_scene("1032930-70C"), changes, si=True)
            study = settings(scene, "effective-friction")["effective-friction"]
            exact, *_ = evaluate(study, assemble(scene, reference_resolution(scene)), made.outputs)
            for name in ("critical_cage_slip", "critical_friction"):
                assert found[name][0] == pytest.approx(
                    exact[name][1][0], rel=scene.accuracy.tolerance
                )

    def test_other_laws_have_their_own(self):
        over = OVER | {"models.film": ["moes", "dowson-1968"]}
        made = plan_sweep("1032930-70C", over, samples=128)
        assert list(made.resolutions.chosen) == ['["moes"]', '["dowson-1968"]']
        assert made.facts["resolutions"] == made.resolutions.facts

    def test_few_points_are_computed_as_stated(self):
        assert not plan_sweep("1032930-70C", OVER, samples=16).resolutions.chosen

    def test_the_resolution_counts_in_what_a_sweep_is(self):
        made = plan_sweep("1032930-70C", OVER, samples=128)
        assert attrs.evolve(made, resolutions=type(made.resolutions)()).hash != made.hash


def test_a_point_that_a_run_contradicts_is_told_of(tmp_path, monkeypatch):
    over = {"operation.radial_load": ["0.9 kN", "1 kN", "1.1 kN"]}
    of = {"study": "effective-friction", "output": ["critical_friction"]}
    found = sweep("1032930-70C", over, out=tmp_path / "sweep", engine="serial", **of)
    assert "off a run" not in found.attrs["warnings"]
    own = run(
        evolve(load_scene("1032930-70C"), {"operation.radial_load": "1 kN"}), "effective-friction"
    )
    np.testing.assert_allclose(found["critical_friction"][1], own["critical_friction"], rtol=1e-3)
    wrong = found.copy(deep=True)
    wrong["critical_friction"][1] *= 1.03
    (said,) = deviations_from_run(plan_sweep("1032930-70C", over, **of), wrong)
    assert said.startswith(
        "at operation.radial_load = 1 kN critical_friction is 3.0e-02 off a run of the scene, more than"
    )
    assert "the others of 3 points were not run so" in said

    def broken(*_):
        raise ZeroDivisionError("a law of somebody")

    monkeypatch.setattr("rollslip_campaigns.sweep.result.compute", broken)
    (said,) = deviations_from_run(plan_sweep("1032930-70C", over, **of), found)
    assert said.startswith(
        "how far points are off could not be checked at operation.radial_load = 1 kN"
    )
    assert "a law of somebody" in said


def test_motions_in_time_are_not_made_again():
    assert (
        deviations_from_run(
            SimpleNamespace(study="dynamics"), xr.Dataset({"status": ("point", ["ok"])})
        )
        == []
    )


@pytest.mark.slow
def test_lean_steady_slips_are_those_of_a_run():
    scene = load_scene("1032930-70C")
    study = settings(scene, "steady-slip")["steady-slip"]
    found, _ = study.partial_result(assemble(scene), frozenset({"steady_slip", "status"}))
    whole = study.completed(assemble(scene), study.run(assemble(scene)))
    # each to the 1e-8 to which both ways look for a slip
    np.testing.assert_allclose(found["steady_slip"][1], whole.steady_slip, rtol=2e-8)
    assert found["status"][1] == whole.status.item()


def test_samples_after_saltelli_exchange_one_dimension_at_a_time_and_begin_alike():
    few = probabilities("saltelli", 8, 3, 5)
    many = probabilities("saltelli", 16, 3, 5)
    assert np.array_equal(many[:40], few)
    blocks = many.reshape(16, 5, 3)
    for k in range(3):
        assert np.array_equal(
            np.delete(blocks[:, 2 + k], k, axis=1), np.delete(blocks[:, 0], k, axis=1)
        )
        assert np.array_equal(blocks[:, 2 + k, k], blocks[:, 1, k])


def test_the_words_of_an_answer_are_taken_for_its_outputs():
    requested = ("cage_slip", "minimum_load", "limit_drag_torque")
    assert set(named_outputs(SteadySlip, requested)) >= {
        "steady_slip",
        "minimum_load",
        "limit_drag",
    }
