"""Temperatures as states of a motion: conservation, limits of capacity and time, solutions by hand, and refusals."""

import json
import math

import attrs
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import rollslip
from rollslip.bearing.assembly import assemble
from rollslip.catalogue.registry import get_model
from rollslip.errors import ConvergenceError, SceneError
from rollslip.results.accounts import account_of
from rollslip.results.style import save_figures
from rollslip.studies.answers import RunContext
from rollslip_studies.dynamics import heating
from rollslip_studies.dynamics.figures import motion_figures
from rollslip_studies.dynamics.history.temperature_path import ThermalPath
from rollslip_studies.dynamics.study import Dynamics
from rollslip_studies.motion import time_integration
from rollslip_studies.motion.checkpoints import Checkpoints

LINKS = ("oil_inner_ring", "oil_rollers", "oil_outer_ring")
CUT = dict.fromkeys(
    ("inner_ring_rollers", "outer_ring_rollers", "inner_ring_shaft", "outer_ring_housing", "shaft_ambient",
     "housing_ambient"), 0.0,
)  # fmt: skip
PARTS = ("oil", "inner_ring", "rollers", "outer_ring")
SCENE = rollslip.evolve(
    rollslip.load_scene("1032930-70C"),
    {
        "accuracy.slices": 4,
        "accuracy.tolerance": 0.01,
        "study.effective-friction.skidding_range": 0,
        "study.dynamics": {
            "duration": "1 s",
            "points": 41,
            "friction": "effective",
            "level": "cage-set",
        },
        "study.thermal-balance": {"points": 9, "highest_temperature": "100 degC"},
    },
)


def scene(capacity, changes=None, **parameters):
    """The bearing of the paper in a flow of oil, whose parts have one capacity [J/K]."""
    network = {
        "model": "network", "oil_flow": "5 g/s", **CUT, **dict.fromkeys(LINKS, 20.0),
        **{f"{part}_capacity": capacity for part in PARTS},
    }  # fmt: skip
    return rollslip.evolve(
        SCENE, {"models.thermal": network | parameters, **(changes or {})}, si=True
    )


def ran(of):
    return Dynamics.from_scene(of).run(assemble(of))


def heated(of):
    return heating.solve_temperatures(Dynamics.from_scene(of), assemble(of))


def test_parts_of_endless_capacity_leave_the_bits_of_the_motion_at_given_temperatures():
    without = ran(rollslip.evolve(SCENE, {"models.thermal": "given"}))
    endless = ran(scene(1e12))
    for name in without.data_vars:
        assert np.array_equal(
            without[name], endless[name], equal_nan=without[name].dtype.kind == "f"
        ), name
    assert endless.attrs["thermal_passes"] == 1
    assert math.isnan(without.attrs["heat_made"])


def test_heat_is_stored_or_carried_away_to_rounding_and_is_what_the_ledger_lost():
    result = ran(scene(2.0, {"study.dynamics.duration": "0.1 s"}))
    made, stored, carried = (
        result.attrs[f"heat_{of}"] for of in ("made", "stored", "carried_away")
    )
    assert made == pytest.approx(stored + carried, rel=1e-12)
    works = dict(
        zip(result["work"].to_numpy().tolist(), result["work_done"].to_numpy()[:, -1], strict=True)
    )
    lost = (
        -sum(work for name, work in works.items() if name.startswith("lost_")) - works["work_drag"]
    )
    assert made == pytest.approx(lost, rel=1e-9)  # the drag of the scene is against a ring at rest
    said = account_of(result).topics(result)["temperatures"]
    assert "outer ring from 70 degC to 71" in said[0]
    assert account_of(result).record(result)["final_temperatures"]["oil"] == pytest.approx(
        float(result["course_temperature"][-1, 0])
    )


@pytest.mark.soak
def test_after_a_long_time_temperatures_are_those_of_the_thermal_balance(tmp_path):
    long = scene(2.0, {"study.dynamics.duration": "12 s"})
    result = ran(long)
    balance = rollslip.run(long, "thermal-balance")
    settled = result["course_temperature"].to_numpy()[-1]
    steady = balance["temperature"].to_numpy()[:, 0]
    assert np.abs(settled - steady).max() < 0.05  # of 8 K
    assert result.attrs["steady_cage_slip"] == pytest.approx(
        float(balance["steady_slip"][0]), rel=0.01
    )
    names = [name for name, _, _ in motion_figures(result)]
    assert any(name.endswith("-temperatures") for name in names)
    save_figures(motion_figures(result), "", tmp_path)


@pytest.mark.soak
def test_heat_of_rolling_and_of_a_land_on_a_turning_ring_is_made_where_the_balance_has_it():
    """Places by the ledger against those by `rollslip_studies.motion.losses`, at a slip of 26 %."""
    changes = {
        "operation.outer_speed": "-1000 rpm",
        "cage.drag": ["petroff-land", "rolling-resistance"],
        "study.dynamics.friction": "conventional",
        "study.dynamics.duration": "4 s",
    }
    of = scene(2.0, changes, oil_flow="30 g/s")
    result = ran(of)
    balance = rollslip.run(of, "thermal-balance")
    settled = result["course_temperature"].to_numpy()[-1]
    steady = balance["temperature"].to_numpy()[:, 0]
    assert np.abs(settled - steady).max() < 0.1  # of rises up to 53 K
    assert float(result["cage_slip"][-1]) == pytest.approx(
        float(balance["steady_slip"][0]), rel=0.005
    )


@pytest.mark.soak
def test_a_run_that_was_interrupted_goes_on_with_the_same_bits(tmp_path, monkeypatch):
    bearing = assemble(scene(2.0, {"study.dynamics.duration": "0.3 s"}))
    study = Dynamics.from_scene(bearing.scene)
    store = Checkpoints(tmp_path, "of the scene", "dynamics")
    looks = []
    whole = study.run(bearing)

    def interrupted(run):
        if run.save is not None:  # not in the passes, which are gone through again
            looks.append(run.t)
            if len(looks) == 4:
                raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(time_integration, "_FIRST_STEPS", 4)
        patched.setattr(time_integration._Run, "_save_if_due", interrupted)
        first = study.run(bearing, RunContext(store=store))
    assert first.attrs["outcome"] == "interrupted"
    assert 0.0 < looks[-1] < 0.25
    assert first.attrs["heat_made"] == pytest.approx(
        first.attrs["heat_stored"] + first.attrs["heat_carried_away"], rel=1e-9
    )
    rest = study.run(assemble(bearing.scene), RunContext(store=store))
    assert rest.attrs["outcome"] == "finished"
    for name in ("cage_speed", "course_temperature", "work_done"):
        assert np.array_equal(rest[name], whole[name]), name


@pytest.mark.soak
@pytest.mark.parametrize("level", ["pocket", "planar"])
def test_levels_that_resolve_contacts_conserve_heat_too(level):
    within = {
        "study.dynamics.level": level,
        "study.dynamics.integrator": "leapfrog",
        "study.dynamics.duration": "0.03 s",
        "study.dynamics.planar": {"inner_ring_mass": "5 kg"},
        "cage.drag": ["petroff-land", "rolling-resistance"],
    }
    result = ran(scene(2.0, within))
    works = dict(
        zip(result["work"].to_numpy().tolist(), result["work_done"].to_numpy()[:, -1], strict=True)
    )
    lost = (
        -sum(work for name, work in works.items() if name.startswith("lost_")) - works["work_drag"]
    )
    assert result.attrs["heat_made"] == pytest.approx(lost, rel=1e-9)
    assert lost == pytest.approx(
        result.attrs["heat_stored"] + result.attrs["heat_carried_away"], rel=1e-12
    )


@pytest.mark.soak
def test_temperatures_follow_along_a_history():
    """Half the time under another load: each half stores and loses what it does, and the wider contacts lose more."""
    step = {
        "study.dynamics.history": {"radial_load": {"shape": "step", "to": "5 kN", "at": "0.5 s"}}
    }
    result = ran(scene(2.0, step))
    without = ran(scene(2.0))
    assert json.loads(result.attrs["history"])[:2] == ["radial_load", "temperature"]
    assert result.attrs["heat_made"] == pytest.approx(
        result.attrs["heat_stored"] + result.attrs["heat_carried_away"], rel=1e-12
    )
    warm, other = (one["course_temperature"].to_numpy() for one in (result, without))
    k = int(np.searchsorted(result["time"].to_numpy(), 0.45))
    assert (
        np.abs(warm[:k] - other[:k]).max() < 0.02
    )  # no effect before its cause, but for where tables have nodes
    assert not np.array_equal(warm[-1], other[-1])


@pytest.mark.soak
def test_the_clearance_goes_with_the_temperatures_of_parts_that_expand():
    result = ran(scene(2.0, expansion="12e-6 1/K"))
    expansion = 12e-6
    b = SCENE.bearing
    _, inner, rollers, outer = (
        result["course_temperature"].to_numpy()[-1] - SCENE.operation.temperature
    ).tolist()
    grown = expansion * (
        b.outer_raceway_diameter * outer
        - b.inner_raceway_diameter * inner
        - 2.0 * b.roller_diameter * rollers
    )
    allowed = heating.temperature_tolerance(assemble(SCENE))  # of the last pass
    clearance = float(result["radial_clearance"][-1]) - b.radial_clearance
    assert clearance == pytest.approx(
        grown, abs=2.0 * expansion * b.outer_raceway_diameter * allowed
    )
    assert grown > 1e-6


@pytest.mark.soak
def test_a_finer_motion_has_the_same_temperatures_by_both_frictions():
    """Against the course of the thermal balance too, which takes the slip at every temperature as steady."""
    found = {
        friction: heated(
            scene(2.0, {"study.dynamics.friction": friction, "accuracy.tolerance": tolerance})
        )
        for friction, tolerance in (("effective", 0.01), ("conventional", 1e-3))
    }
    rough, fine = (one.temperatures[-1] for one in found.values())
    assert np.abs(rough - fine).max() < 0.03
    of = rollslip.evolve(
        scene(2.0),
        {"study.thermal-balance.duration": "1 s", "study.thermal-balance.course_points": 5},
    )
    course = rollslip.run(of, "thermal-balance")["course_temperature"].to_numpy()[-1]
    assert np.abs(course - fine).max() < 0.1


def test_temperatures_of_given_powers_are_those_of_another_integration():
    model = get_model(
        "thermal", "network", oil_flow=0.01, oil_inlet_temperature=320.0, ambient_temperature=290.0, oil_capacity=5.0,
        inner_ring_capacity=40.0, shaft_capacity=90.0, shaft_ambient=5.0, oil_inner_ring=8.0, inner_ring_shaft=30.0,
        **dict.fromkeys(("oil_rollers", "oil_outer_ring", "inner_ring_rollers", "outer_ring_rollers",
                         "outer_ring_housing", "housing_ambient"), 0.0),
    )  # fmt: skip
    times = np.concatenate((np.linspace(0.0, 1.0, 9), [1.5, 4.0]))
    power = {"oil": 150.0, "inner land": 80.0}
    start = np.array([310.0, 300.0, 295.0])
    rows, carried = heating._temperatures(
        model, start, times, {place: p * times for place, p in power.items()}
    )

    def rates(t, T):
        return np.append(
            model.inflows(T[:3], power) / model.capacities(),
            sum(model.carried_away(T[:3]).values()),
        )

    other = solve_ivp(
        rates,
        (0.0, 4.0),
        np.append(start, 0.0),
        method="DOP853",
        rtol=1e-12,
        atol=1e-10,
        t_eval=times,
    )
    assert rows == pytest.approx(other.y[:3].T, abs=1e-8)
    assert carried == pytest.approx(other.y[3], abs=1e-6)


def test_a_path_passes_every_temperature_at_its_time_and_never_turns_back():
    times = np.linspace(0.0, 10.0, 41)
    values = {
        "operation.temperature": 340.0 + 20.0 * np.exp(-times / 0.5),
        "operation.roller_temperature": 330.0 + 5.0 * np.sin(times),
    }
    path = ThermalPath.from_samples(times, values, 0.1)
    places = path.coordinate.at(np.linspace(0.0, 10.0, 2001))
    assert (np.diff(places) > 0.0).all()
    assert (places[0], places[-1]) == (0.0, pytest.approx(1.0, abs=1e-15))
    for t in (0.0, 0.3, 5.1, 10.0):
        assert path.time(float(path.coordinate.at(t))) == pytest.approx(t, abs=1e-9)
    key = "operation.roller_temperature"
    assert path.courses[key].at(times) == pytest.approx(values[key])
    assert (
        float(path.coordinate.at(0.5)) > 0.1
    )  # a twentieth of the time, but one in which the oil moves by 13 K
    assert path.unit == "K"
    assert attrs.evolve(path, name="radial_clearance").unit == "m"


def test_temperatures_that_are_given_and_follow_are_refused():
    both = scene(
        2.0,
        {
            "study.dynamics.history": {
                "temperature": {"shape": "ramp", "to": "80 degC", "within": "1 s"}
            }
        },
    )
    with pytest.raises(SceneError, match=r"gives temperature.*leave one of both out"):
        heated(both)


def test_temperatures_beyond_the_data_of_the_oil_are_refused_in_words(monkeypatch):
    monkeypatch.setattr(heating, "_MAX_HALVINGS", 1)
    hot = scene(2.0, oil_inlet_temperature="900 degC")
    with pytest.raises(
        ConvergenceError, match=r"after pass \d it fails: .*temperature.*models.thermal=given"
    ):
        heated(hot)


@pytest.mark.soak
def test_losses_of_cold_oil_that_lead_beyond_its_data_are_approached_by_halves():
    many = {
        "cage.drag": [
            "petroff-land",
            "rolling-resistance",
            {"model": "churning", "density": "930 kg/m3"},
        ]
    }
    result = ran(scene(2.0, many, oil_flow="30 g/s"))
    assert result.attrs["heat_made"] == pytest.approx(
        result.attrs["heat_stored"] + result.attrs["heat_carried_away"], rel=1e-12
    )
    assert (
        273.15 + 110.0 < result.attrs["hottest_temperature"] < 273.15 + 200.0
    )  # where the data of the oil end


def test_passes_that_do_not_settle_are_refused_in_words(monkeypatch):
    monkeypatch.setattr(heating, "_MAX_PASSES", 1)
    with pytest.raises(ConvergenceError, match=r"after 1 passes .* they still change by"):
        heated(scene(2.0))


def test_the_plan_says_what_temperatures_cost_and_what_they_rest_on():
    parts = {part.part: part for part in rollslip.plan(scene(2.0), "dynamics").parts}
    assert "until they change by at most 0.1 K" in parts["temperatures"].resolution
    assert parts["temperatures"].seconds > 0.0
    assert parts["thermal"].included
