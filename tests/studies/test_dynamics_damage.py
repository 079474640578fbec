"""Measures of damage along a motion: against the ledger and a steady slip, what is told, and what has no value."""

import attrs
import numpy as np
import pytest

import rollslip
from rollslip.bearing.assembly import assemble
from rollslip.bearing.raceway import RINGS
from rollslip.results.accounts import account_of, answer
from rollslip_studies.dynamics import over_time
from rollslip_studies.dynamics.figures import motion_figures
from rollslip_studies.dynamics.study import Dynamics
from rollslip_studies.surface_damage import over_motion

EVERY = [
    "power-density",
    "pass-energy",
    "film-parameter",
    "flash-temperature",
    "contact-temperature",
]
SCENE = rollslip.evolve(
    rollslip.load_scene("1032930-70C"),
    {
        "accuracy.slices": 4,
        "accuracy.tolerance": 0.01,
        "models.damage": EVERY,
        "study.effective-friction.skidding_range": 0,
        "study.dynamics": {
            "duration": "0.4 s",
            "points": 9,
            "friction": "conventional",
            "level": "cage-set",
        },
    },
)


@pytest.fixture(scope="module")
def bearing():
    return assemble(SCENE)


@pytest.fixture(scope="module")
def motion(bearing):
    return Dynamics.from_scene(SCENE).run(bearing)


def test_heat_on_all_slices_is_that_of_the_tractions_of_the_motion(bearing, motion):
    """The sum of mu w V over evaluated slices against force times sliding, which the compiled motion stored."""
    for i in range(len(RINGS)):
        now = motion.isel(time=-1, ring=i)
        contacts, _, column = over_motion._contacts(bearing, now, i)
        power = float((contacts.friction_power * bearing.widths[column]).sum())
        stored = float(np.abs(now["traction_force"] * now["sliding_speed"]).sum())
        assert power == pytest.approx(stored, rel=1e-3)


def test_speeds_of_the_slices_are_those_of_the_kinematics(bearing, motion):
    last = motion.isel(time=-1)
    speeds = bearing.kinematics.surface_speeds(
        float(last["cage_slip"]), last["roller_slip"].to_numpy()
    )
    for i, rolling in enumerate((speeds.inner_rolling, speeds.outer_rolling)):
        contacts, owner, _ = over_motion._contacts(bearing, last.isel(ring=i), i)
        assert contacts.slices.rolling_speed == pytest.approx(np.asarray(rolling)[owner], rel=1e-12)


def test_the_worst_of_all_is_the_worst_of_its_instant(motion):
    for k, name in enumerate(EVERY):
        rows = motion["worst_over_time"][k].to_numpy()
        extreme = np.nanmin(rows, axis=1) if name == "film-parameter" else np.nanmax(rows, axis=1)
        assert motion["worst"][k].to_numpy().tolist() == extreme.tolist()
        for i in range(len(RINGS)):
            at = (
                motion["measured_time"].to_numpy().tolist().index(float(motion["worst_time"][k, i]))
            )
            assert rows[i, at] == extreme[i]


def test_the_verdict_says_what_is_beyond_its_limit_and_when(motion):
    told = account_of(motion).topics(motion)
    assert (
        "along the motion the sliding power density is at most" in told["sliding power density"][0]
    )
    assert "at t = " in told["sliding power density"][0]
    assert told["damage"] == [
        "the worst values were found at all stored instants; between instants they may be worse"
    ]
    assert "beyond" not in " ".join(row.note for row in answer(motion).rows)
    limited = motion.assign(limit=motion["limit"].copy(data=[1e3, *motion["limit"].to_numpy()[1:]]))
    row = answer(limited)["power-density"]
    assert row.note.startswith("beyond its limit on the inner")
    assert row.note.endswith("ring, 1 kW/m2")
    assert row.value == float(limited.worst[0].max())


def test_a_measure_without_a_value_at_some_instants_says_so(motion, bearing):
    stuck = motion.assign(
        roller_speed=motion["roller_speed"] * 0.0
    )  # rollers that stand while they slide
    found, _ = over_motion.over_motion(bearing, stuck, lambda _: bearing)
    k = EVERY.index("pass-energy")
    assert "no pass ends" in found["worst_status"][k, 0]


def test_the_worst_is_found_between_instants_of_even_steps(motion, bearing, monkeypatch):
    spike = motion.copy(deep=True)
    spike["sliding_speed"][:, 5] *= 3.0
    spike["traction_force"][:, 5] *= 2.0
    whole, _ = over_motion.over_motion(bearing, spike, lambda _: bearing)
    monkeypatch.setattr(over_motion, "_MAX_POINTS", 3)
    found, more = over_motion.over_motion(bearing, spike, lambda _: bearing)
    heated = [
        k
        for k, name in enumerate(EVERY)
        if name in ("power-density", "pass-energy", "flash-temperature")
    ]
    assert found["worst_time"][heated] == pytest.approx(float(spike["time"][5]))
    assert found["worst"].tolist() == whole["worst"].tolist()
    assert more["measured_time"][1].size < 9


def test_what_slices_leave_of_the_worst_is_told(motion):
    fine = assemble(rollslip.evolve(SCENE, {"accuracy.slices": 16}))
    found, _ = over_motion.over_motion(fine, motion.isel(time=[-1]), lambda _: fine)
    few = assemble(SCENE)
    told, _ = over_motion.over_motion(few, motion.isel(time=[-1]), lambda _: few)
    for k, i in np.ndindex(told["worst"].shape):
        off = abs(told["worst"][k, i] / found["worst"][k, i] - 1.0)
        said = told["worst_status"][k, i].partition("its slices leave about ")[2]
        assert said == (f"{100.0 * off:.2g} %" if off > 0.01 else "")
    assert "its slices leave about" in " ".join(told["worst_status"].ravel())


def test_forces_are_spread_along_tilted_rollers_as_the_motion_has_them():
    """Heat on all slices against what the motion stored, whose loads along a roller come from a table over the orbit;
    as along aligned rollers it would be 3 and 13 % off."""
    changes = {"operation.misalignment": "1 mrad", "accuracy.slices": 9, "study.dynamics.points": 3}
    drop = {"radial_load": {"shape": "ramp", "to": "3000 N", "within": "0.2 s"}}
    scene = rollslip.evolve(SCENE, changes | {"study.dynamics.history": drop}, si=True)
    bearing = assemble(scene)
    motion = Dynamics.from_scene(scene).run(bearing)
    for k in (1, 2):
        at = over_time.bearing_at(bearing, motion, k)
        now = motion.isel(time=k)
        for i in range(len(RINGS)):
            ring = now.isel(ring=i)
            stored = float(np.abs(ring["traction_force"] * ring["sliding_speed"]).sum())
            contacts, _, column = over_motion._contacts(
                at, ring, i, over_motion._tilted_loads(at, now)
            )
            assert float((contacts.friction_power * at.widths[column]).sum()) == pytest.approx(
                stored, rel=1e-3
            )


def test_the_roller_in_the_line_of_the_load_is_pressed_most_wherever_that_turns(bearing, motion):
    tilted = assemble(rollslip.evolve(SCENE, {"operation.misalignment": "1 mrad"}))
    now = motion.isel(time=-1)
    for j in (0, 3, 11):
        loads = over_motion._tilted_loads(
            tilted, now.assign(load_direction=float(now["orbit_angle"][j]))
        )
        assert (loads @ tilted.widths).argmax(axis=1).tolist() == [j, j]


def test_rollers_of_which_no_half_is_like_the_other_tilt(bearing, motion):
    now = motion.isel(time=-1)
    halves = (slice(None, 2), slice(2, None))
    assert over_motion._tilted_loads(bearing, now) is None
    lopsided = attrs.evolve(bearing, drop=bearing.drop + np.linspace(0.0, 2e-6, bearing.drop.size))
    left, right = (over_motion._tilted_loads(lopsided, now)[:, :, half].sum() for half in halves)
    assert left > 1.01 * right


def test_a_force_is_spread_whole_and_in_proportion(bearing):
    along = np.linspace(1.0, 3.0, bearing.widths.size)
    load = over_motion._distribute(bearing, 0, 500.0, along)
    assert load @ bearing.widths == pytest.approx(500.0, rel=1e-12)
    assert load / along == pytest.approx(np.full(along.size, load[0]), rel=1e-12)


@pytest.mark.soak
def test_a_settled_motion_has_the_damage_of_its_steady_slip():
    long = rollslip.evolve(SCENE, {"study.dynamics.duration": "3 s", "study.dynamics.points": 201})
    motion = Dynamics.from_scene(long).run(assemble(long))
    at = {"study.surface-damage.cage_slip": float(motion["cage_slip"][-1])}
    steady = rollslip.run(rollslip.evolve(long, at, si=True), "surface-damage")["worst"].to_numpy()
    late = motion["worst_over_time"].to_numpy()[:, :, -20:]
    late = np.where(
        np.array(EVERY)[:, None] == "film-parameter", late.min(axis=2), late.max(axis=2)
    )
    assert late == pytest.approx(steady, rel=0.01)
    assert any(name.endswith("-damage") for name, _, _ in motion_figures(motion))


@pytest.mark.soak
def test_warm_instants_are_measured_at_their_temperatures():
    warm = rollslip.evolve(
        SCENE,
        {
            "study.dynamics.history": {
                "temperature": {"shape": "ramp", "to": "110 degC", "within": "0.4 s"}
            }
        },
    )
    found = (
        Dynamics.from_scene(warm)
        .run(assemble(warm))
        .sel(measure="contact-temperature")["worst_over_time"]
        .to_numpy()
    )
    assert found[0, -1] - found[0, 0] == pytest.approx(40.0, abs=0.5)
