"""Courses of an operation over time, how they are read, and the maps between which a bearing is followed along them."""

import math

import numpy as np
import pytest

import rollslip
from rollslip.bearing.assembly import assemble
from rollslip.errors import DomainError, SceneError
from rollslip.structure import Location, structure
from rollslip_kernels.motion.system import System
from rollslip_kernels.motion.varying import Varying
from rollslip_studies.dynamics.history.interpolated_rates import (
    Axis,
    largest_rates,
    relative_error,
    sampled_rates,
)
from rollslip_studies.dynamics.history.settings import HistorySettings
from rollslip_studies.dynamics.history.time_functions import Course, constant, table
from rollslip_studies.dynamics.history.varying import varying_motion
from rollslip_studies.dynamics.levels.cage_and_rollers import carried_motion
from rollslip_studies.dynamics.levels.raceway_friction import FrictionSettings

SCENE = rollslip.evolve(rollslip.load_scene("1032930-50C"), {"accuracy.slices": 5})
SPEED = SCENE.operation.inner_speed
WHERE = ("study", "dynamics", "history")


def history(raw, end=1.0, scene=SCENE):
    problems = []
    settings = structure(HistorySettings, raw, Location({}, WHERE), problems)
    if problems:
        raise SceneError(problems)
    return settings.history(scene, end, Location({}, WHERE))


def course(name, end=1.0, **raw):
    return history({name: raw}, end).courses[name]


def friction(name="conventional"):
    return FrictionSettings(name=name, coefficient=0.05, transition=0.05)


# Shapes ---------------------------------------------------------------------------------------------------------------


@pytest.mark.quick
def test_shapes_are_what_their_names_say():
    t = np.linspace(0.0, 1.0, 2001)
    sine = course("radial_load", shape="sine", amplitude="300 N", period="0.13 s", phase="1 rad")
    assert (
        np.abs(sine.at(t) - (1037.0 + 300.0 * np.sin(2 * np.pi * t / 0.13 + 1.0))).max()
        < 3e-9 * 600.0
    )
    coast = course(
        "inner_speed", shape="coast-down", time_constant="0.1 s", at="0.2 s", to="100 rpm"
    )
    end = 100.0 * math.pi / 30.0
    decay = end + (SPEED - end) * np.exp(-np.maximum(t - 0.2, 0.0) / 0.1)
    assert np.abs(coast.at(t) - decay).max() < 3e-9 * SPEED
    up = course("inner_speed", shape="run-up", within="0.5 s")
    x = np.minimum(t / 0.5, 1.0)
    assert np.abs(up.at(t) - SPEED * x * x * (3.0 - 2.0 * x)).max() < 1e-12 * SPEED
    stop = course("inner_speed", shape="emergency-stop", within="0.25 s", at="0.5 s")
    assert np.abs(stop.at(t) - SPEED * np.clip((0.75 - t) / 0.25, 0.0, 1.0)).max() < 1e-12 * SPEED
    assert stop.breaks == (0.5, 0.75)
    ramp = course("temperature", shape="ramp", **{"from": "20 degC"}, to="60 degC", within="1 s")
    assert ramp.at(np.array([0.0, 0.5, 2.0])).tolist() == pytest.approx(
        [293.15, 313.15, 333.15], abs=1e-12
    )


@pytest.mark.quick
def test_a_jump_has_the_later_value_and_is_a_break():
    step = course("radial_load", shape="step", to="300 N", at="0.5 s")
    assert step.at([0.0, np.nextafter(0.5, 0.0), 0.5, 9.0]).tolist() == [
        1037.0,
        1037.0,
        300.0,
        300.0,
    ]
    assert step.breaks == (0.5,)
    twice = {"time": ["0 s", "1 s", "1 s", "2 s"], "value": ["1 kN", "2 kN", "500 N", "500 N"]}
    of_table = course("radial_load", end=2.0, **twice)
    assert of_table.at([0.5, 1.0, 1.5]).tolist() == [1500.0, 500.0, 500.0]
    assert 1.0 in of_table.breaks


@pytest.mark.quick
def test_the_span_of_a_course_is_found_between_its_nodes_and_not_beyond_the_run():
    inside = Course(np.array([0.0, 1.0]), np.array([[0.0, 1.0, -1.0, 0.0], [0.0, 0.0, 0.0, 0.0]]))
    assert inside.span(1.0) == pytest.approx((0.0, 0.25))
    assert inside.span(0.25) == pytest.approx((0.0, 0.1875))
    assert constant(3.0).span(1.0) == (3.0, 3.0)
    assert table(np.array([-1.0, 1.0, 3.0]), np.array([0.0, 2.0, 9.0])).span(1.0) == pytest.approx(
        (1.0, 2.0)
    )


@pytest.mark.quick
def test_of_very_many_kinks_the_sharpest_are_breaks():
    t = np.linspace(0.0, 1.0, 100_001)
    zigzag = 500.0 + np.where(np.arange(t.size) % 2, 1.0, 0.0)
    zigzag[50_000] += 400.0
    of_many = table(t, zigzag)
    assert len(of_many.breaks) == 1000
    assert t[50_000] in of_many.breaks


@pytest.mark.quick
def test_a_load_may_fall_to_nothing_whatever_the_rounding():
    for within in ("0.2 s", "0.3 s", "0.7 s"):
        ramp = history(
            {"radial_load": {"shape": "ramp", "to": "0 N", "at": "0.1 s", "within": within}}
        )
        assert abs(ramp.spans["radial_load"][0]) < 1e-12


# What is refused ------------------------------------------------------------------------------------------------------


@pytest.mark.quick
@pytest.mark.parametrize(
    ("raw", "said"),
    [
        ({}, "nothing changes"),
        ({"radial_load": {"shape": "steps"}}, "radial_load.shape: must be one of 'table', 'ramp'"),
        ({"radial_load": {"shape": "step", "to": "3 N"}}, "radial_load.at: missing, but required for shape = 'step'"),
        ({"radial_load": {"shape": "step", "to": "3 rpm", "at": "1 s"}}, "radial_load.to: "),
        ({"radial_load": {"shape": "step", "to": "3 N", "at": "1 s", "period": "1 s"}}, "period: is not a parameter"),
        ({"radial_load": {"shape": "ramp", "to": "-3 N", "within": "1 s"}}, "to: must be at least 0, not -3 N"),
        ({"radial_load": {"shape": "ramp", "to": float("nan"), "within": "1 s"}}, "radial_load.to: "),
        ({"radial_load": {"shape": "sine", "amplitude": "2 kN", "period": "1 s"}}, "goes down to -963 N"),
        ({"radial_load": {"shape": "run-up", "within": "1 s"}}, "is one of speeds; there are table, ramp, step, sine"),
        ({"radial_laod": {"shape": "step"}}, "unknown key, did you mean 'radial_load'"),
        ({"temperature": {"time": ["0 s", "1 s"], "value": ["20 degC"]}}, "needs one value for each of 2 times"),
        ({"temperature": {"time": ["0 s", "2 s", "1 s"], "value": ["300 K"] * 3}}, "1 s comes after 2 s"),
        ({"temperature": {"time": ["0 s", "1 s", "1 s", "1 s"], "value": ["300 K"] * 4}}, "stands there three times"),
        ({"radial_load": {"time": ["0 s", "0.5 s"], "value": ["1 N", "2 N"]}}, "the history ends at 0.5 s, before"),
        ({"radial_load": {"time": ["0.1 s", "5 s"], "value": ["1 N", "2 N"]}}, "the history begins at 0.1 s"),
        ({"inner_speed": {"shape": "sine", "amplitude": "1 rpm", "period": "1 us"}}, "more than 10,000"),
        ({"file": "no-such.csv"}, "no-such.csv: cannot be read"),
    ],
)  # fmt: skip
def test_a_fault_is_told_with_its_place(raw, said):
    with pytest.raises(SceneError, match=r"study\.dynamics\.history") as caught:
        history(raw)
    assert said in str(caught.value)


HEAD = "time [s], radial_load [N], temperature [degC]\n"


@pytest.mark.quick
@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "no data"),
        (HEAD, "no data"),
        ("time [s], radial_load\n0, 1\n2, 1\n", ":1: radial_load: has no unit"),
        ("time [s], radial_load [rpm]\n0, 1\n2, 1\n", ":1: radial_load: "),
        ("time [s], load [N]\n0, 1\n2, 1\n", ":1: 'load': unknown column"),
        ("radial_load [N]\n1\n1\n", ":1: time: missing"),
        ("time [s]\n0\n1\n", "a column of inner_speed"),
        (HEAD + "0, 1, 20\n1, nan, 20\n2, 1, 20\n", ":3: radial_load: "),
        (HEAD + "0, 1, 20\n1, -4, 20\n2, 1, 20\n", ":3: radial_load: must be at least 0"),
        (HEAD + "0, 1, 20\n2, 1, 20\n1, 1, 20\n", ":4: time: 1 s comes after 2 s"),
        (
            HEAD + "0, 1, 20\n0.5, 1, 20\n",
            ":3: the history ends at 0.5 s, before the run does at 1 s",
        ),
        (HEAD + "0, 1\n", ":2: 2 values under 3 columns"),
    ],
)
@pytest.mark.parametrize("long", [False, True])
def test_a_fault_of_a_file_is_told_with_its_line(tmp_path, text, said, long):
    path = tmp_path / "measured.csv"
    if (
        long and text.count("\n") > 1
    ):  # behind so many rows that are right that the file is read the quick way
        head, rows = text.split("\n", 1)
        before = [f"{-3 + k * 1e-3}" + ", 1" * head.count(",") for k in range(3000)]
        text = "\n".join((head, *before, rows))
        said = said if not (number := said[1:].split(":")[0]).isdigit() or number == "1" else (
            f":{int(number) + 3000}:{said[2:].partition(':')[2]}"
        )  # fmt: skip
    path.write_text(text)
    with pytest.raises(SceneError) as caught:
        history({"file": str(path)})
    assert said in str(caught.value)


@pytest.mark.soak
def test_a_million_points_are_read_as_the_slow_way_reads_them(tmp_path):
    t = np.linspace(0.0, 1.0, 1_000_001)
    rows = [f"{a:.7f}, {b:.2f}" for a, b in zip(t, 5900.0 + 300.0 * np.sin(9.0 * t), strict=True)]
    path = tmp_path / "measured.csv"
    path.write_text("time [s], inner_speed [rpm]\n" + "\n".join(rows) + "\n")
    of_all = history({"file": str(path)})
    assert of_all.courses["inner_speed"].starts.size == t.size
    few = tmp_path / "few.csv"
    few.write_text("time [s], inner_speed [rpm]\n" + "\n".join(rows[::100_000]) + "\n")
    at = t[::100_000]
    slowly = history({"file": str(few)}).courses["inner_speed"].at(at)
    assert of_all.courses["inner_speed"].at(at) == pytest.approx(slowly, rel=1e-15, abs=0.0)


# Maps -----------------------------------------------------------------------------------------------------------------


@pytest.mark.quick
def test_the_compiled_courses_are_those_of_the_settings():
    of_speed = history(
        {"inner_speed": {"shape": "coast-down", "time_constant": "0.1 s", "at": "0.3 s"}}
    )
    moving = varying_motion(assemble(SCENE), friction(), of_speed, level="cage-set")
    t = np.random.default_rng(1).uniform(-0.1, 2.0, 300)  # not in order
    inner, outer, direction, load, limit = moving.system.owner.values(t)
    assert np.array_equal(inner, of_speed.courses["inner_speed"].at(t))
    assert not outer.any()
    assert not direction.any()
    assert np.all(load == SCENE.operation.radial_load)
    assert np.isnan(limit).all()


@pytest.mark.parametrize(
    "name", ["conventional", pytest.param("effective", marks=pytest.mark.soak)]
)
@pytest.mark.parametrize(
    ("raw", "key", "unit"),
    [
        ({"radial_load": {"shape": "ramp", "to": "600 N", "within": "1 s"}}, "radial_load", "N"),
        pytest.param(
            {"temperature": {"shape": "ramp", "to": "30 degC", "within": "1 s"}}, "temperature", "K",
            marks=pytest.mark.soak,
        ),
        ({"roller_temperature": {"shape": "ramp", "to": "40 degC", "within": "1 s"}}, "roller_temperature", "K"),
    ],
)  # fmt: skip
def test_between_nodes_rates_are_those_of_a_bearing_put_together_there(name, raw, key, unit):
    way = history(raw)
    bearing = assemble(SCENE)
    moving = varying_motion(bearing, friction(name), way, level="cage-set")
    worst = 0.0
    for t in np.random.default_rng(7).uniform(0.0, 1.0, 6):
        value = float(way.courses[key].at(t))
        there = assemble(
            rollslip.evolve(SCENE, {f"operation.{key}": f"{value!r} {unit}"}, si=True),
            bearing.resolution,
        )
        direct = carried_motion(there, moving.stations.friction, level="cage-set", per_roller=True)
        rows = [[one.split(one.system(t, y)) for one in (moving, direct)] for y in states(direct)]
        for entry in ("impulse_inner", "impulse_outer", "impulse_drag"):
            blended, true = (np.array([float(row[k][entry]) for row in rows]) for k in (0, 1))
            worst = max(worst, np.abs(blended - true).max() / np.abs(true).max())
    assert worst <= SCENE.accuracy.tolerance
    assert worst > 1e-9  # none of them is a node


def states(motion):
    k = motion.assembly.kinematics
    return [
        motion.initial(slip, 0.9 * float(k.roller_slip_outer_rolling(slip)))
        for slip in (0.01, 0.07, 0.4)
    ]


@pytest.mark.quick
def test_a_bearing_rests_where_rings_cage_and_rollers_stand_or_spin_freely():
    way = history({"inner_speed": {"shape": "emergency-stop", "at": "0.1 s", "within": "0.4 s"}})
    moving = varying_motion(assemble(SCENE), friction(), way, level="cage-set")
    assert way.rings_rest(0.5, 1.0)
    assert not way.rings_rest(0.499, 1.0)
    assert moving.breaks[:2] == (0.1, 0.5)
    still = moving.state_at(0.0, 0.0, 1037.0, 0.0)
    assert moving.at_rest(0.5, 0.6, still)
    assert not moving.at_rest(0.4, 0.45, still)
    turning = still.copy()
    spinning = still.copy()
    free = still.copy()
    moving.split(turning)["cage_speed"][...] = 1.0
    assert not moving.at_rest(0.5, 0.6, turning)
    moving.split(spinning)["roller_spin"][0] = 100.0  # in the line of load
    assert not moving.at_rest(0.5, 0.6, spinning)
    moving.split(free)["roller_spin"][14] = 100.0  # opposite
    assert moving.at_rest(0.5, 0.6, free)


@pytest.mark.slow
def test_two_axes_are_followed_together():
    way = history(
        {
            "radial_load": {"shape": "ramp", "to": "900 N", "within": "1 s"},
            "temperature": {"shape": "ramp", "to": "45 degC", "within": "1 s"},
        }
    )
    bearing = assemble(SCENE)
    moving = varying_motion(bearing, friction(), way, level="cage-set")
    now = {name: float(value) for name, value in way.at(0.37).items()}
    changes = {
        "operation.radial_load": f"{now['radial_load']!r} N",
        "operation.temperature": f"{now['temperature']} K",
    }
    there = assemble(rollslip.evolve(SCENE, changes, si=True), bearing.resolution)
    direct = carried_motion(there, moving.stations.friction, level="cage-set", per_roller=True)
    for y in states(direct):
        assert (
            np.abs(moving.system(0.37, y) - direct.system(0.37, y))[1]
            < 1e-3 * np.abs(direct.system(0.37, y))[1]
        )


def test_a_part_with_a_course_of_its_own_does_not_follow_the_temperature():
    ramp = {"shape": "ramp", "within": "1 s"}
    way = history(
        {
            "temperature": ramp | {"to": "45 degC"},
            "inner_ring_temperature": ramp | {"to": "60 degC"},
        }
    )
    bearing = assemble(SCENE)
    moving = varying_motion(bearing, friction(), way, level="cage-set")
    now = {
        f"operation.{name}": f"{float(way.courses[name].at(0.6))!r} K" for name in way.prescribed
    }
    assert len(now) == 2
    there = assemble(rollslip.evolve(SCENE, now, si=True), bearing.resolution)
    assert there.scene.operation.roller_temperature == there.scene.operation.temperature
    direct = carried_motion(there, moving.stations.friction, level="cage-set", per_roller=True)
    for y in states(direct):
        assert (
            np.abs(moving.system(0.6, y) - direct.system(0.6, y))[1]
            < 1e-3 * np.abs(direct.system(0.6, y))[1]
        )


@pytest.mark.quick
def test_tables_over_more_than_three_values_are_refused():
    ramp = {"shape": "ramp", "to": "45 degC", "within": "1 s"}
    parts = ("inner_ring_temperature", "roller_temperature", "outer_ring_temperature")
    way = history({"temperature": ramp} | dict.fromkeys(parts, ramp))
    with pytest.raises(
        DomainError, match=r"inner ring temperature, .* are more than 3 at once; keep some of them"
    ):
        varying_motion(assemble(SCENE), friction(), way, level="cage-set")


def test_a_cubic_that_is_too_coarse_is_seen():
    bearing = assemble(SCENE)
    colder = history({"temperature": {"shape": "ramp", "to": "30 degC", "within": "1 s"}})
    moving = varying_motion(bearing, friction(), colder, level="cage-set")
    stations = moving.stations
    low, high, middle = (stations.motion((value,)) for value in (303.15, 323.15, 313.15))
    straight = 0.5 * (sampled_rates(low, middle) + sampled_rates(high, middle))
    true = sampled_rates(middle, middle)
    assert (
        relative_error(straight, true, largest_rates(true, 28), 28) > 0.02
    )  # a viscosity that halves is no straight line
    assert relative_error(true, true, largest_rates(true, 28), 28) == 0.0


@pytest.mark.quick
def test_at_an_operation_that_does_not_change_the_rates_have_the_bits_of_the_steady_bearing():
    bearing = assemble(SCENE)
    still = history({"radial_load": {"shape": "step", "to": "1037 N", "at": "0.5 s"}})
    assert not still.varies
    assert not still.breaks
    for name in ("conventional", "effective", "constant"):
        moving = varying_motion(bearing, friction(name), still, level="cage-set")
        steady = carried_motion(bearing, friction(name), level="cage-set", per_roller=True)
        for y in states(steady):
            assert np.array_equal(moving.system(0.3, y), steady.system(0.3, y))
        assert np.array_equal(moving.initial(0.1, 0.2), steady.initial(0.1, 0.2))


@pytest.mark.quick
def test_effective_friction_refuses_speeds_that_change_differently():
    both = history(
        {
            "inner_speed": {"shape": "ramp", "to": "3000 rpm", "within": "1 s"},
            "outer_speed": {"shape": "ramp", "to": "1000 rpm", "within": "1 s"},
        }
    )
    with pytest.raises(DomainError, match="conventional friction takes that"):
        varying_motion(assemble(SCENE), friction("effective"), both, level="cage-set")
    moving = varying_motion(assemble(SCENE), friction(), both, level="cage-set")
    assert np.isfinite(moving.system(0.5, moving.initial())).all()


@pytest.mark.quick
def test_rings_that_never_turn_against_each_other_are_refused():
    with pytest.raises(DomainError, match="nothing rolls at any time"):
        varying_motion(
            assemble(SCENE), friction(), history({"inner_speed": {"shape": "step", "from": "0 rpm", "to": "0 rpm",
                                                                  "at": "1 s"}}), level="cage-set"
        )  # fmt: skip


@pytest.mark.quick
def test_no_load_is_the_limit_of_hardly_any():
    assert Axis.of("radial_load", 0.0, 900.0).low == pytest.approx(math.sqrt(9e-7))
    assert Axis.of("radial_load", 100.0, 900.0) == Axis("radial_load", 10.0, 30.0)


@pytest.mark.quick
def test_a_file_is_looked_for_beside_the_scene(tmp_path, monkeypatch):
    (tmp_path / "scenes").mkdir()
    (tmp_path / "scenes" / "stand.csv").write_text("time [min], radial_load [kN]\n0, 1\n1, 2\n")
    path = tmp_path / "scenes" / "own.toml"
    path.write_text(SCENE.text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    beside = history({"file": "stand.csv"}, scene=rollslip.load_scene(path))
    assert beside.courses["radial_load"].at([0.0, 30.0]).tolist() == [1000.0, 1500.0]
    assert beside.prescribed == ("radial_load",)
    with pytest.raises(SceneError, match="cannot be read"):
        history(
            {"file": "stand.csv"}
        )  # a shipped scene has no folder: the file is looked for where one works


# What the compiled system makes of it ---------------------------------------------------------------------------------

BOTH = {"inner_speed": {"shape": "ramp", "to": "-3000 rpm", "within": "1 s"},
        "outer_speed": {"shape": "ramp", "to": "500 rpm", "within": "1 s"}}  # fmt: skip


def test_a_watched_slip_is_that_of_both_rings_whichever_way_they_turn():
    way = history(BOTH)
    moving = varying_motion(assemble(SCENE), friction(), way, level="cage-set", limit=constant(0.3))
    k = moving.assembly.kinematics
    y = moving.initial(0.05, 0.05)
    cage = float(moving.split(y)["cage_speed"])
    for t in (0.1, 0.4, 0.9):
        inner, outer = (k.direction * float(way.courses[name].at(t)) for name in BOTH)
        free = (k.inner_radius * inner + k.outer_radius * outer) / (k.inner_radius + k.outer_radius)
        lag = free - cage if free > 0.0 else cage - free
        assert moving.system.watch(t, y)[0] == pytest.approx(lag - 0.3 * abs(free))


def test_speeds_of_both_rings_reach_the_rates():
    way = history(BOTH)
    moving = varying_motion(assemble(SCENE), friction(), way, level="cage-set")
    speeds = {f"operation.{name}": f"{float(way.courses[name].at(0.2))!r} rad/s" for name in BOTH}
    there = assemble(rollslip.evolve(SCENE, speeds, si=True))
    direct = carried_motion(there, moving.stations.friction, level="cage-set", per_roller=True)
    y = direct.initial(0.05, 0.06)
    np.testing.assert_allclose(moving.system(0.2, y), direct.system(0.2, y), rtol=2e-3, atol=0.1)


def test_between_nodes_outputs_are_those_of_a_bearing_put_together_there():
    way = history({"radial_load": {"shape": "ramp", "to": "600 N", "within": "1 s"}})
    moving = varying_motion(assemble(SCENE), friction(), way, level="cage-set")
    load = float(way.courses["radial_load"].at(0.37))
    there = assemble(
        rollslip.evolve(SCENE, {"operation.radial_load": f"{load!r} N"}), moving.assembly.resolution
    )
    direct = carried_motion(there, moving.stations.friction, level="cage-set", per_roller=True)
    y = direct.initial(0.05, 0.06)
    blended, true = (one.system.owner.outputs([0.37], [y]) for one in (moving, direct))
    assert "film_parameter" in true
    for name, values in true.items():
        np.testing.assert_allclose(
            blended[name], values, rtol=0.05, atol=0.01 * np.nanmax(np.abs(values)), err_msg=name
        )


def test_what_is_beyond_the_range_of_an_axis_is_held_at_its_end():
    one = carried_motion(assemble(SCENE), friction(), level="cage-set")
    k = one.assembly.kinematics
    o = SCENE.operation
    values = (
        o.inner_speed,
        o.outer_speed,
        0.0,
        o.radial_load,
        math.nan,
        2.0,
    )  # of an axis from 0 to 1
    system = Varying(
        [(c.starts, c.powers) for c in map(constant, values)], [(0.0, 1.0)],
        lambda place: ([[0.0, 0.3, 0.6, 1.0]], [one.system.owner] * 4), cage_speed=0,
        inner_fraction=k.inner_radius / (k.inner_radius + k.outer_radius), scale=one.system.scale,
    )  # fmt: skip
    y = one.initial(0.05, 0.06)
    assert System(system.system())(0.0, y) == pytest.approx(one.system(0.0, y))
