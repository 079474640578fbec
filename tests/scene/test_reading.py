"""Reading scenes: strict values, and all faults at once with their lines."""

import copy
import json
import math
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import attrs
import pytest

from rollslip.errors import SceneError, UnknownNameError, nearest
from rollslip.fields import FieldError
from rollslip.planning.plan import plan
from rollslip.scene import Bearing, ModelChoice, Operation, Profile, Scene, resolved, scene_hash
from rollslip.scene.changes import evolve
from rollslip.scene.reading import load_scene, parse_scene, shipped_scenes
from rollslip.structure import structure
from scene_samples import LINES, SCENE, line_of, problems_of, scene_with

pytestmark = pytest.mark.quick

# A scene as a value -------------------------------------------------------------------------------------------------


def test_a_scene_is_read_in_si_with_all_defaults() -> None:
    scene = parse_scene(SCENE, "scene.toml")
    assert scene.title == "1032930 at 70 degC"
    assert scene.bearing.rollers == 28
    assert scene.bearing.roller_diameter == 0.015
    assert scene.bearing.profile == Profile(shape="none")
    assert scene.bearing.material.elastic_modulus == 208e9
    assert scene.surface.roller_roughness == 0.1e-6
    assert scene.lubricant.name == "mil-prf-7808"
    assert scene.lubricant.data == {"eyring_stress": "4 MPa"}
    assert scene.operation.inner_speed == pytest.approx(667.1696)
    assert scene.operation.outer_speed == 0.0
    assert scene.operation.roller_temperature == scene.operation.temperature == 343.15
    assert scene.models.contact == ModelChoice(name="palmgren")
    assert scene.models.traction.name == "lambda-blend"
    assert list(scene.study) == ["effective-friction", "friction-curve"]
    assert scene.study["effective-friction"]["slip"] == ("0 %", "30 %")
    assert scene.cage is None
    assert (scene.accuracy.tolerance, scene.accuracy.slices) == (1e-3, None)
    assert (scene.source, scene.text) == ("scene.toml", SCENE)


def test_a_nominal_clearance_of_zero_is_zero() -> None:
    clearance = parse_scene(SCENE, "scene.toml").bearing.radial_clearance
    assert clearance == 0
    assert math.copysign(1, clearance) == 1


def test_comments_order_and_units_do_not_change_a_scene() -> None:
    scene = parse_scene(SCENE, "scene.toml")
    same = parse_scene("# other text\n" + SCENE.replace('"15 mm"', "0.015"), "other.toml")
    assert same == scene
    assert hash(same) == hash(scene)
    assert scene_hash(same) == scene_hash(scene)
    assert scene_hash(evolve(scene, {"operation.radial_load": 1}, si=True)) != scene_hash(scene)


def test_a_scene_is_immutable_and_can_be_copied_and_sent() -> None:
    scene = parse_scene(SCENE, "scene.toml")
    for name in ("title", "bearing", "raw"):
        with pytest.raises(attrs.exceptions.FrozenInstanceError):
            setattr(scene, name, None)
    with pytest.raises(TypeError):
        scene.study["x"] = {}  # type: ignore[index]
    assert pickle.loads(pickle.dumps(scene)) == copy.deepcopy(scene) == attrs.evolve(scene) == scene
    assert pickle.loads(pickle.dumps(scene)).origins == scene.origins


def test_the_resolved_scene_reads_as_the_same_scene() -> None:
    scene = parse_scene(scene_with("[cage]", "mass = 0.4"), "scene.toml")
    table = json.loads(json.dumps(resolved(scene)))
    problems: list[str] = []
    assert structure(Scene, table, "", problems) == scene
    assert problems == []


@pytest.mark.parametrize(
    ("written", "profile"),
    [
        ('profile = "iso16281"', Profile(shape="iso16281")),
        ('profile = { shape = "circular", radius = "5 m" }', Profile(shape="circular", radius=5.0)),
        (
            'profile = { shape = "table", position = ["-7 mm", 0, 0.007], drop = ["5 um", 0, "5 um"] }',
            Profile(shape="table", position=(-0.007, 0.0, 0.007), drop=(5e-6, 0.0, 5e-6)),
        ),
    ],
)
def test_a_profile_is_a_name_or_a_table(written: str, profile: Profile) -> None:
    text = SCENE.replace("rollers = 28", f"rollers = 28\n{written}")
    assert parse_scene(text, "scene.toml").bearing.profile == profile


def test_a_model_is_a_name_or_a_table_with_parameters() -> None:
    text = scene_with(film='film = { model = "moes", thermal = true, nested = { a = [1, 2] } }')
    film = parse_scene(text, "scene.toml").models.film
    assert film.name == "moes"
    assert film.parameters == {"thermal": True, "nested": {"a": (1, 2)}}
    assert hash(film) == hash(copy.deepcopy(film))


def test_scene_classes_check_themselves_in_python_too() -> None:
    bearing = parse_scene(SCENE, "").bearing
    with pytest.raises(FieldError, match="rollers: 40 rollers"):
        attrs.evolve(bearing, rollers=40)
    with pytest.raises(FieldError, match="nothing rolls"):
        Operation(inner_speed=5.0, outer_speed=5.0, radial_load=0.0, temperature=300.0)
    with pytest.raises(TypeError):
        Bearing(28)  # type: ignore[call-arg]


# Faults -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("key", "written", "message"),
    [
        ("rollers", "rollers = 12.9", "bearing.rollers: a whole number is expected, not 12.9"),
        ("rollers", "rollers = true", "bearing.rollers: a whole number is expected, not true"),
        ("rollers", 'rollers = "12"', "bearing.rollers: a whole number is expected, not '12'"),
        ("rollers", "rollers = 2", "bearing.rollers: must be at least 3, not 2"),
        (
            "rollers",
            "rollers = 40",
            "bearing.rollers: 40 rollers of 15 mm do not fit on a pitch circle of 180 mm",
        ),
        (
            "roller_diameter",
            "roller_diameter = true",
            "bearing.roller_diameter: true is not a quantity",
        ),
        (
            "roller_diameter",
            "roller_diameter = nan",
            "bearing.roller_diameter: nan is not a finite number",
        ),
        ("roller_diameter", 'roller_diameter = "15"', "bearing.roller_diameter: '15' has no unit"),
        (
            "roller_diameter",
            'roller_diameter = "1,5 mm"',
            "bearing.roller_diameter: '1,5 mm': a decimal comma",
        ),
        (
            "roller_diameter",
            'roller_diameter = "15 kg"',
            "bearing.roller_diameter: '15 kg' is a mass",
        ),
        (
            "roller_diameter",
            'roller_diameter = "-15 mm"',
            "bearing.roller_diameter: must be above 0, not -15 mm",
        ),
        (
            "roller_diameter",
            "roller_diameter = [1]",
            "bearing.roller_diameter: a list is not a quantity",
        ),
        (
            "roller_diameter",
            "roller_diameter = 1979-05-27",
            "bearing.roller_diameter: 1979-05-27 is not a quantity",
        ),
        (
            "roller_diameter",
            'roller_diameter = "30 mm"',
            "bearing.roller_diameter: rollers of 30 mm do not fit",
        ),
        (
            "outer_raceway_diameter",
            "outer_raceway_diameter = 0.1",
            "bearing.outer_raceway_diameter: 100 mm must be",
        ),
        (
            "radial_load",
            'radial_load = "-1 N"',
            "operation.radial_load: must be at least 0, not -1 N",
        ),
        (
            "inner_speed",
            "inner_speed = 0",
            "operation.inner_speed: both rings turn at 0 rpm, so nothing rolls",
        ),
        (
            "temperature",
            'temperature = "-300 degC"',
            "operation.temperature: '-300 degC' is below absolute zero",
        ),
        ("temperature", 'temperature = "70 R"', "operation.temperature: '70 R': 'R' is not a unit"),
        ("title", "title = 5", "title: a text is expected, not 5"),
        ("name", "name = 5", "lubricant.name: a text is expected, not 5"),
        ("eyring_stress", "eyring_stress = inf", "lubricant.eyring_stress: inf cannot be used"),
        (
            "eyring_stress",
            "eyring_stress = 1979-05-27",
            "lubricant.eyring_stress: 1979-05-27 cannot be used",
        ),
        ("film", "film = 5", "models.film: a table or a name is expected, not 5"),
        (
            "film",
            "film = { x = 5 }",
            "models.film.model: missing, but required (name of the model)",
        ),
        ("film", "flim = 5", "models.flim: unknown key, did you mean 'film'?"),
        ("slip", "slip = [1, [nan]]", "study.effective-friction.slip[1][0]: nan cannot be used"),
    ],
)
def test_a_wrong_value_is_reported_with_its_line(key: str, written: str, message: str) -> None:
    [problem] = problems_of(scene_with(**{key: written}))
    assert problem.startswith(f"scene.toml:{line_of(key)}: {message}")
    assert "\n" not in problem


@pytest.mark.parametrize(
    ("key", "written", "said"),
    [
        ("radial_load", '"-0.5 kN"', "must be at least 0, not -0.5 kN"),
        ("radial_load", '"-500 N"', "must be at least 0, not -500 N"),
        ("radial_load", "-3", "must be at least 0, not -3 N"),
        ("misalignment", '"20 deg"', "must be from -5.72958 deg to 5.72958 deg, not 20 deg"),
        ("misalignment", '"200 mrad"', "must be from -100 mrad to 100 mrad, not 200 mrad"),
        (
            "misalignment",
            "0.2",
            "must be from -100 mrad to 100 mrad, not 0.2 rad = 200 mrad; did you mean '0.2 mrad'?",
        ),
        ("temperature", '"0 K"', "must be above 0, not 0 K"),
        ("temperature", '"-273.15 °C"', "must be above 0, not -273.15 degC"),
    ],
)
def test_a_value_is_told_in_the_unit_in_which_it_was_given(
    key: str, written: str, said: str
) -> None:
    text = (
        scene_with(**{key: f"{key} = {written}"})
        if key in SCENE
        else scene_with(temperature=(f'temperature = "70 degC"\n{key} = {written}'))
    )
    [problem] = problems_of(text)
    assert problem.endswith(f"operation.{key}: {said}")


def test_rings_that_turn_alike_are_told_in_rpm() -> None:
    [problem] = problems_of(
        scene_with(temperature='temperature = "70 degC"\nouter_speed = "6371 rpm"')
    )
    assert "both rings turn at 6371 rpm" in problem


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (
            ["[accuracy]", "tolerance = 0"],
            "accuracy.tolerance: must be between 0 and 1, without the ends, not 0",
        ),
        (["[accuracy]", "slices = 2"], "accuracy.slices: must be at least 3, not 2"),
        (["[plugins]", 'require = "x"'], "plugins.require: a list is expected, not 'x'"),
        (["[plugins]", "require = [1]"], "plugins.require[0]: a text is expected, not 1"),
        (
            ["[bearing.profile]", 'shape = "curved"'],
            "bearing.profile.shape: must be one of 'none', 'iso16281'",
        ),
        (
            ["[bearing.profile]", "radius = 1"],
            "bearing.profile.radius: only read for shape = 'circular', not for",
        ),
        (
            ["[bearing.profile]", "drop = [1e-5]"],
            "bearing.profile.drop: only read for shape = 'table', not for 'none'",
        ),
        (
            ["[bearing.material]", "poisson_ratio = 0.6"],
            "bearing.material.poisson_ratio: must be from 0 to 0.5, not",
        ),
        (
            ["[bearing.material]", "hardness = 60"],
            "bearing.material.hardness: unknown key; known are density, elas",
        ),
        (["[moodels]"], "moodels: unknown key, did you mean 'models'?"),
    ],
)
def test_a_fault_in_an_optional_table_is_reported_with_its_line(
    lines: list[str], message: str
) -> None:
    [problem] = problems_of(scene_with(*lines))
    assert problem.startswith(f"scene.toml:{len(LINES) + len(lines)}: {message}")


@pytest.mark.parametrize(
    ("written", "message"),
    [
        (
            '{ shape = "circular" }',
            "bearing.profile.radius: missing, but required for shape = 'circular'",
        ),
        ('{ shape = "table" }', "bearing.profile.position: a table needs at least 2 places, not 0"),
        (
            '{ shape = "table", position = [0, 1], drop = [0] }',
            "bearing.profile.drop: needs one value for each of 2",
        ),
        (
            '{ shape = "table", position = [1, 0], drop = [0, 0] }',
            "bearing.profile.position: must ascend",
        ),
        (
            '{ shape = "table", position = [0, 0], drop = [0, 0] }',
            "bearing.profile.position: must ascend",
        ),
        (
            '{ shape = "table", position = [0, 1], drop = [0, -1] }',
            "bearing.profile.drop: must be at least 0, not -1",
        ),
        (
            '{ shape = "table", position = [0, "1 kg"], drop = [0, 0] }',
            "bearing.profile.position[1]: '1 kg' is a mass",
        ),
    ],
)
def test_a_profile_is_complete(written: str, message: str) -> None:
    [problem] = problems_of(SCENE.replace("rollers = 28", f"rollers = 28\nprofile = {written}"))
    assert problem.startswith(f"scene.toml:5: {message}")


def test_the_number_of_rollers_that_fit_is_named() -> None:
    [problem] = problems_of(scene_with(rollers="rollers = 40"))
    assert problem.endswith("at most 37 do")
    assert parse_scene(scene_with(rollers="rollers = 37"), "").bearing.rollers == 37
    assert 38 * math.asin(15 / 180) >= math.pi > 37 * math.asin(15 / 180)


def test_a_clearance_is_smaller_than_a_roller() -> None:
    text = SCENE.replace("rollers = 28", 'rollers = 28\nradial_clearance = "20 mm"')
    assert problems_of(text) == [
        "scene.toml:5: bearing.radial_clearance: must be less than the roller diameter, 15 mm, not 20 mm"
    ]


def test_all_faults_come_at_once_in_the_order_of_the_file() -> None:
    text = scene_with(
        rollers="rolers = 28",
        roller_length='roller_length = "15"',
        inner_raceway_diameter='inner_raceway_diameter = "165 kg"',
        radial_load="radial_load = -1",
        temperature="temperature = true",
        film="flim = 1",
    )
    assert [problem.split(": ")[:2] for problem in problems_of(text)] == [
        ["scene.toml:4", "bearing.rolers"],
        ["scene.toml:6", "bearing.roller_length"],
        ["scene.toml:7", "bearing.inner_raceway_diameter"],
        ["scene.toml:3", "bearing.rollers"],
        ["scene.toml:16", "operation.radial_load"],
        ["scene.toml:17", "operation.temperature"],
        ["scene.toml:20", "models.flim"],
    ]


def test_names_that_are_looked_up_later_are_told_with_the_faults_of_values() -> None:
    text = (
        scene_with(rollers="rolers = 28", film='film = "mos"\ntorque = ["skf", "ksf"]')
        + "[study.dynamic]"
    )
    found = [problem.split("; ")[0].partition(": ")[2] for problem in problems_of(text)]
    wrong = (
        ("models.film", "film", "mos"),
        ("models.torque[1]", "torque", "ksf"),
        ("study.dynamic", "study", "dynamic"),
    )
    assert found[2:] == [f"{key}: no {kind} is called {name!r}" for key, kind, name in wrong]


def test_an_empty_scene_lists_what_is_required() -> None:
    problems = problems_of("")
    assert [problem.split(" (")[0] for problem in problems] == [
        f"scene.toml: {name}: missing, but required"
        for name in ("bearing", "lubricant", "operation")
    ]


def test_a_missing_key_says_what_is_expected() -> None:
    assert problems_of(scene_with(radial_load="")) == [
        "scene.toml:14: operation.radial_load: missing, but required (radial load); "
        "a force is expected, such as '3415 N'"
    ]


@pytest.mark.parametrize(
    "table", ["bearing", "lubricant", "study", "cage", "models", "plugins", "study.dynamics"]
)
def test_a_table_is_a_table(table: str) -> None:
    problems = problems_of(f"{table} = 1\n")
    assert any(
        p.startswith(f"scene.toml:1: {table}: a table") and p.endswith("is expected, not 1")
        for p in problems
    )


# Files --------------------------------------------------------------------------------------------------------------


def test_a_file_is_read_by_its_path(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_bytes(b"\xef\xbb\xbf" + SCENE.replace("\n", "\r\n").encode())
    scene = load_scene(path)
    assert scene == load_scene(str(path)) == parse_scene(SCENE, "")
    assert scene.source == str(path)
    path.write_text(scene_with(rollers="rollers = 1").replace("\n", "\r\n"), encoding="utf-8")
    with pytest.raises(SceneError, match=r"scene\.toml:4: bearing\.rollers"):
        load_scene(path)


def test_a_file_without_suffix_is_read_if_it_exists(tmp_path: Path) -> None:
    path = tmp_path / "scene"
    path.write_text(SCENE, encoding="utf-8")
    assert load_scene(str(path)) == parse_scene(SCENE, "")


def test_a_file_that_cannot_be_read_is_a_scene_error(tmp_path: Path) -> None:
    latin = tmp_path / "latin.toml"
    latin.write_bytes(b"a = 1\nb = '\xe4'\n")
    directory = tmp_path / "directory.toml"
    directory.mkdir()
    cases: list[tuple[Any, str]] = [
        (latin, f"{latin}:2: not UTF-8 text; save the file in the encoding UTF-8"),
        (directory, f"{directory}: is a directory; a scene is a .toml file"),
        (str(tmp_path), f"{tmp_path}: is a directory; a scene is a .toml file"),
        *(
            (tmp_path / f"none{ending}", "is not a scene but ")
            for ending in (".nc", ".CSV", ".json", ".rexs", ".zip")
        ),
        (
            tmp_path / "none.toml",
            f"{tmp_path / 'none.toml'}: there is no such file; 'rollslip new FILE.toml' writes one",
        ),
        (str(latin / "x.toml"), "cannot be read: "),
        ("nul\0.toml", "cannot be read: "),
        ("x" * 5000 + ".toml", "cannot be read: "),
    ]
    for name, message in cases:
        with pytest.raises(SceneError) as caught:
            load_scene(name)
        assert message in str(caught.value)


@pytest.mark.parametrize("name", ["no-such-scene", "", "."])
def test_an_unknown_name_gets_the_nearest_shipped_ones(name: str, tmp_path: Path) -> None:
    with pytest.raises(SceneError) as caught:
        load_scene(name)
    [problem] = caught.value.problems
    if name != ".":
        assert all(known in problem for known in nearest(name, shipped_scenes(), cutoff=0.0))
        assert "ends in .toml" in problem


def test_shipped_scenes_are_read_by_name() -> None:
    for name in shipped_scenes():
        scene = load_scene(name)
        assert scene.source == name
        assert structure(Scene, resolved(scene), "", []) == scene


def test_reading_a_scene_imports_nothing_heavy() -> None:
    heavy = ("numpy", "scipy", "xarray", "matplotlib", "cattrs", "rich", "click", "pluggy")
    code = f"import sys, rollslip.scene.reading; sys.exit(any(name in sys.modules for name in {heavy}))"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_an_example_is_a_usual_value_of_the_field():
    with pytest.raises(
        SceneError, match=r"roller_roughness: '3 N' is a force, .* expected, such as '0\.1 um'"
    ):
        evolve(load_scene("1032930-70C"), {"surface.roller_roughness": "3 N"})


@pytest.mark.parametrize(
    ("name", "said"), [("anulus", "'anulus'; did you mean 'annulus'?"), ("annulus", None)]
)
def test_the_model_of_a_ring_is_looked_for_among_rings(name, said):
    with pytest.raises(SceneError) as error:
        evolve(
            load_scene("1032930-70C"), {"models.outer_ring": name, "operation.inner_speed": "fast"}
        )
    assert "no kind" not in str(error.value)
    assert (f"no ring is called {said}" in str(error.value)) == (said is not None)


@pytest.mark.parametrize("key", ["damage", "torque", "loss", "life"])
def test_an_unknown_name_in_a_list_of_models_is_reported_once(key: str) -> None:
    scene = evolve(load_scene("gearbox"), {f"models.{key}": ["nobodys"]})
    with pytest.raises(UnknownNameError) as refused:
        plan(scene)
    assert str(refused.value).count("nobodys") == 1
    assert f"models.{key}[0]: no {key} is called 'nobodys'" in str(refused.value)
