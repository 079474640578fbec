"""Points of a sweep that are planned as runs: their values, errors and bands are those of single runs."""

import json
import math

import numpy as np
import pytest

import rollslip
from coarse import coarse
from rollslip.planning.execution import compute
from rollslip.planning.plan import plan
from rollslip.results.figures import Result
from rollslip_campaigns.sweep.sweep import open_sweep, plan_sweep

SCENE = coarse(
    "gearbox",
    {
        "models.traction": "muraki",
        "study.effective-friction.max_cage_slip": 0.1,
    },
)
LOADS = {"operation.radial_load": ["1 kN", "3 kN"]}


def swept(study, output, **options):
    return rollslip.sweep(SCENE, LOADS, study=study, output=output, engine="serial", **options)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("study", "outputs", "keys"),
    [
        ("steady-slip", ["steady_slip", "drag_reserve"], ["cage slip", "reserve to skidding"]),
        ("effective-friction", ["effective_friction"], ["friction"]),
    ],
)
def test_values_and_errors_of_a_point_are_those_of_a_run(study, outputs, keys):
    points = swept(study, outputs, errors=True)
    assert (points.error_status == "found").all()
    for k, load in enumerate(LOADS["operation.radial_load"]):
        scene = rollslip.evolve(SCENE, {"operation.radial_load": load})
        alone = compute(plan(scene, study), study)
        for name, key in zip(outputs, keys, strict=True):
            point = points[name].isel(radial_load=k)
            np.testing.assert_array_equal(point, alone.dataset[name])
            error = float(points[f"{name}_error"][k])
            assert error == alone.error.total[key]
            assert 0.0 <= error < 0.05  # the tolerance of the scene


@pytest.mark.slow
def test_bands_of_a_point_are_those_of_a_run():
    points = swept("steady-slip", ["steady_slip"], bands=True)
    scene = rollslip.evolve(SCENE, {"operation.radial_load": "3 kN"})
    result = rollslip.run(scene, "steady-slip")
    assert isinstance(result, Result)
    assert result.answer.rows
    band = json.loads(result.attrs["band"])["steady_slip"]
    high = math.inf if band["high"] is None else band["high"]
    assert float(points.steady_slip_low[1]) == band["low"]
    assert float(points.steady_slip_high[1]) == high
    assert band["low"] < float(points.steady_slip[1, 0]) < high
    assert "steady_slip_error" in points


def test_a_sweep_with_errors_is_another_one_and_is_gone_on_with(tmp_path):
    plain = plan_sweep(SCENE, LOADS, study="friction-curve")
    tables = [{"errors": True}, {"bands": True}, {"errors": True, "bands": True}]
    sweeps = [plan_sweep(SCENE, LOADS, study="friction-curve", **table) for table in tables]
    assert "accuracy of each point" not in plain.facts
    assert len({plain.hash, sweeps[0].hash, sweeps[1].hash}) == 3
    assert sweeps[1].hash == sweeps[2].hash
    assert all(sweep.errors for sweep in sweeps)
    swept("friction-curve", ["critical_friction"], errors=True, out=tmp_path / "points")
    assert open_sweep(tmp_path / "points").errors
    stated = rollslip.evolve(SCENE, {"sweep.errors": True})
    assert plan_sweep(stated, LOADS, study="friction-curve").hash == sweeps[0].hash
