"""What every study of the box says of itself holds for what it returns."""

import re
from typing import ClassVar

import attrs
import numpy as np
import pytest
import xarray as xr

from rollslip import available, evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.bearing.resolution import reference_resolution
from rollslip.errors import ConvergenceError, SceneError
from rollslip.results.curves import Curves, curve_labels
from rollslip.scene.values import Accuracy
from rollslip.studies.discretisation.choice import COARSE_SLICES, choose_by_doubling
from rollslip.studies.study import AXES, Study, settings, study_class
from rollslip_studies.steady_slip.outputs import AXIAL_OUTPUTS
from rollslip_studies.surface_damage.over_motion import OVER_MOTION
from without_bands import run

SCENE = evolve(load_scene("1032930-70C"), {"accuracy.tolerance": 0.05, "accuracy.slices": 5})
#: Few points for every study, and what its optional outputs need.
SHORT = {
    "study.effective-friction.points": 5,
    "study.effective-friction.map_points": 3,
    "study.effective-friction.per_roller": True,
    "study.friction-curve.points": 5,
    "study.steady-slip.acceptable_slip": 0.05,
    "study.dynamics.duration": "0.1 ms",
    "study.dynamics.points": 3,
    "study.dynamics.level": "planar",
    "study.dynamics.friction": "effective",
    "study.dynamics.integrator": "rodas5p",
    "study.dynamics.relative_tolerance": 1e-4,
    "study.dynamics.planar.inner_ring_mass": "5 kg",
    "study.steady-slip.points": 6,
    "study.steady-slip.pockets": "play",
}
#: Outputs that need other settings than those above; those of a history stand in test_dynamics_history.py.
ELSEWHERE = {
    "effective-friction": {"driving_torque", "drag_torque"},  # on demand alone, in sweeps
    "thermal-balance": {"course_temperature", "course_slip", "course_status"},
    "dynamics": {"inner_speed", "outer_speed", "radial_load", "load_direction", "temperature",
                 "inner_ring_temperature", "roller_temperature", "outer_ring_temperature", "epicyclic_cage_speed",
                 "roller_sliding_distance", "roller_frictional_work", "course_temperature", "radial_clearance",
                 "skidding_slip_along", "limit_drag_along", "critical_slip_along", "largest_cage_slip",
                 "largest_cage_slip_time", "smallest_cage_slip", "smallest_cage_slip_time",
                 "smallest_margin_to_skidding", "smallest_margin_time", "time_beyond_skidding",
                 "sliding_distance_inner", "sliding_distance_outer", "frictional_work_inner", "frictional_work_outer",
                 "ring_deflection", "form_angle", *OVER_MOTION},
    "steady-slip": {
        f"{name}{rest}" for name in ("radial_load", "inner_speed", "temperature") for rest in (
        "", "_slip", "_stable", "_fold", "_branch", "_limit", "_limit_slip", "_limit_status")} | {"external_torque"}
        | {*AXIAL_OUTPUTS},  # with an axial load alone: test_axial_load.py
}  # fmt: skip


def test_the_studies_of_the_box_are_offered_like_those_of_others():
    assert {name: offer.package for name, offer in available("study").items()} == dict.fromkeys(
        (
            "dynamics",
            "effective-friction",
            "friction-curve",
            "rating-life",
            "raceway-friction",
            "steady-slip",
            "surface-damage",
            "thermal-balance",
        ),
        "rollslip",
    )


@pytest.mark.parametrize("name", available("study"))
def test_what_a_study_says_of_itself_fits_together(name):
    cls = study_class(name)
    assert cls.name == name
    assert set(cls.controlled_outputs.values()) <= set(cls.outputs)
    assert (
        set(cls.controlled_outputs)
        <= {"friction", "critical_slip", "cage_speed"}
        <= set(dir(Accuracy))
    )
    assert cls.affected_by <= set(AXES)
    assert {output.status for output in cls.outputs.values()} - {""} <= set(cls.outputs)
    assert any(output.default for output in cls.outputs.values())


@pytest.mark.parametrize("name", available("study"))
def test_a_result_has_the_outputs_that_are_declared(name):
    result = run(evolve(SCENE, SHORT), name)
    cls = study_class(name)
    for variable in result.data_vars:
        output = cls.outputs[variable]
        assert result[variable].dims == tuple(output.dims.split())
        assert result[variable].attrs["units"] == output.unit
        assert result[variable].attrs["long_name"].startswith(output.meaning)
    single = {name for name, output in cls.outputs.items() if output.attribute}
    assert single - ELSEWHERE.get(name, set()) <= set(result.attrs)
    assert {*map(str, result.data_vars)} == cls.outputs.keys() - single - ELSEWHERE.get(name, set())
    assert result.attrs["study"] == name
    assert Curves.from_dataset(result) == cls.curves_of


def test_an_unknown_study_is_answered_with_the_nearest():
    with pytest.raises(
        SceneError, match=r"^study.dynamic: no study is called 'dynamic'; did you mean 'dynamics'"
    ):
        settings(SCENE, "dynamic")


class _Unsettled:
    """A study whose friction falls with all slices, and that has a critical slip with the most of them only."""

    controlled_outputs: ClassVar = {"friction": "friction", "critical_slip": "critical"}
    affected_by = frozenset({"slices"})

    def run(self, assembly):
        most = assembly.slices == reference_resolution(assembly.scene).slices
        return xr.Dataset(
            {"friction": 1.0 + 1.0 / assembly.slices, "critical": 0.5 if most else np.nan}
        )


def test_what_no_doubling_settles_says_what_moves_and_which_keys_to_raise():
    scene = evolve(
        load_scene("1032930-70C"), {"accuracy.friction": 1e-9, "accuracy.slices": "auto"}, si=True
    )
    with pytest.raises(ConvergenceError) as refused:
        choose_by_doubling(
            _Unsettled().run, _Unsettled.controlled_outputs, _Unsettled.affected_by, assemble(scene)
        )
    assert re.fullmatch(
        r"the last doubling up to \d+ slices still changes friction by \S+ and whether critical slip has a value; "
        "raise accuracy.friction and accuracy.critical_slip",
        str(refused.value),
    )


def test_unknowns_and_cost_go_with_rollers_and_slices(monkeypatch):
    scene = load_scene("1032930-50C")  # 28 rollers
    [one] = settings(scene, "effective-friction").values()
    fine = assemble(evolve(scene, {"accuracy.slices": 40}))
    coarse = fine.at(attrs.evolve(fine.resolution, slices=1))
    assert (one.degrees_of_freedom(fine), one.degrees_of_freedom(coarse)) == (2 + 2 * 28, 2 + 28)
    # 2 s for each position, and 5 s for what they share
    monkeypatch.setattr(
        "rollslip.studies.study.processor_time",
        lambda work: 5.0 + 2.0 * work.args[0].resolution.n_positions,
    )
    at = fine.at(attrs.evolve(fine.resolution, n_positions=6))
    slices = 40 / min(40, COARSE_SLICES)
    assert Study.cost(one, at) == {"run": pytest.approx((5.0 + 6 * 2.0) * slices)}
    [curve] = settings(scene, "friction-curve").values()
    assert "n_positions" not in curve.affected_by
    assert Study.cost(curve, at) == {"run": pytest.approx((5.0 + 2.0) * slices)}


def test_curves_are_told_apart_by_their_values_and_studies_are_those_of_the_scene():
    [curves] = {study_class("friction-curve").curves_of}
    forces = xr.Dataset(coords={curves.over: (curves.over, [300.0, 1500.0], {"units": "N"})})
    assert curve_labels(forces, curves) == [" at 300 N", " at 1.5 kN"]
    scene = evolve(load_scene("gearbox"), {"study": {"friction-curve": {}, "steady-slip": {}}})
    assert list(settings(scene)) == ["friction-curve", "steady-slip"]
