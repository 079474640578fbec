"""Reading scenes: strict values, all faults at once with their lines, changes, and the schema."""

import contextlib
import copy
import json
import math
import pickle
import subprocess
import sys
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import attrs
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rollslip.errors import PluginError, SceneError
from rollslip.fields import FieldError, at_least, in_range, non_negative, one_of, parameter, positive
from rollslip.scene import Bearing, FrozenTable, ModelChoice, Operation, Profile, Scene, resolved, scene_hash
from rollslip.scene.changes import evolve, parse_set
from rollslip.scene.reading import load_scene, parse_scene, shipped_scenes
from rollslip.scene.schema import schema
from rollslip.structure import Where, nearest, structure
from rollslip.toml import key_lines

SCENE = """\
title = "1032930 at 70 degC"

[bearing]
rollers = 28
roller_diameter = "15 mm"
roller_length = "15 mm"
inner_raceway_diameter = "165 mm"
outer_raceway_diameter = "195 mm"

[lubricant]
name = "mil-prf-7808"
eyring_stress = "4 MPa"

[operation]
inner_speed = "6371 rpm"
radial_load = "3415 N"
temperature = "70 degC"

[models]
film = "moes"

[study.effective-friction]
slip = ["0 %", "30 %"]

[study.curve]
"""
LINES = SCENE.splitlines()


def scene_with(*additions: str, **replaced: str) -> str:
    """Replace the lines of some keys, which keeps all line numbers, and add lines at the end."""
    lines = [next((new for key, new in replaced.items() if line.startswith(f"{key} ")), line) for line in LINES]
    return "\n".join([*lines, *additions]) + "\n"


def problems_of(text: str) -> list[str]:
    with pytest.raises(SceneError) as caught:
        parse_scene(text, "scene.toml")
    return caught.value.problems


def line_of(key: str) -> int:
    return next(number for number, line in enumerate(LINES, 1) if line.startswith(f"{key} ")) if key else 0


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
    assert list(scene.study) == ["effective-friction", "curve"]
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
    assert scene_hash(evolve(scene, {"operation.radial_load": 1})) != scene_hash(scene)


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


# Faults -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("key", "written", "message"),
    [
        ("rollers", "rollers = 12.9", "bearing.rollers: a whole number is expected, not 12.9"),
        ("rollers", "rollers = true", "bearing.rollers: a whole number is expected, not true"),
        ("rollers", 'rollers = "12"', "bearing.rollers: a whole number is expected, not '12'"),
        ("rollers", "rollers = 2", "bearing.rollers: must be at least 3, not 2"),
        ("rollers", "rollers = 40", "bearing.rollers: 40 rollers of 15 mm do not fit on a pitch circle of 180 mm"),
        ("roller_diameter", "roller_diameter = true", "bearing.roller_diameter: true is not a quantity"),
        ("roller_diameter", "roller_diameter = nan", "bearing.roller_diameter: nan is not a finite number"),
        ("roller_diameter", 'roller_diameter = "15"', "bearing.roller_diameter: '15' has no unit"),
        ("roller_diameter", 'roller_diameter = "1,5 mm"', "bearing.roller_diameter: '1,5 mm': a decimal comma"),
        ("roller_diameter", 'roller_diameter = "15 kg"', "bearing.roller_diameter: '15 kg' is a mass"),
        ("roller_diameter", 'roller_diameter = "-15 mm"', "bearing.roller_diameter: must be above 0, not -15 mm"),
        ("roller_diameter", "roller_diameter = [1]", "bearing.roller_diameter: a list is not a quantity"),
        ("roller_diameter", "roller_diameter = 1979-05-27", "bearing.roller_diameter: 1979-05-27 is not a quantity"),
        ("roller_diameter", 'roller_diameter = "30 mm"', "bearing.roller_diameter: rollers of 30 mm do not fit"),
        ("outer_raceway_diameter", "outer_raceway_diameter = 0.1", "bearing.outer_raceway_diameter: 100 mm must be"),
        ("radial_load", 'radial_load = "-1 N"', "operation.radial_load: must be at least 0, not -1 N"),
        ("inner_speed", "inner_speed = 0", "operation.inner_speed: both rings turn at 0 rpm, so nothing rolls"),
        ("temperature", 'temperature = "-300 degC"', "operation.temperature: '-300 degC' is below absolute zero"),
        ("temperature", 'temperature = "70 degF"', "operation.temperature: '70 degF': 'degF' is not a unit"),
        ("title", "title = 5", "title: a text is expected, not 5"),
        ("name", "name = 5", "lubricant.name: a text is expected, not 5"),
        ("eyring_stress", "eyring_stress = inf", "lubricant.eyring_stress: inf cannot be used"),
        ("eyring_stress", "eyring_stress = 1979-05-27", "lubricant.eyring_stress: 1979-05-27 cannot be used"),
        ("film", "film = 5", "models.film: a table or a name is expected, not 5"),
        ("film", "film = { x = 5 }", "models.film.model: missing, but required (name of the model)"),
        ("film", "flim = 5", "models.flim: unknown key, did you mean 'film'?"),
        ("slip", "slip = [1, [nan]]", "study.effective-friction.slip[1][0]: nan cannot be used"),
    ],
)
def test_a_wrong_value_is_reported_with_its_line(key: str, written: str, message: str) -> None:
    [problem] = problems_of(scene_with(**{key: written}))
    assert problem.startswith(f"scene.toml:{line_of(key)}: {message}")
    assert "\n" not in problem


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (["[accuracy]", "tolerance = 0"], "accuracy.tolerance: must be between 0 and 1, without the ends, not 0"),
        (["[accuracy]", "slices = 2"], "accuracy.slices: must be at least 3, not 2"),
        (["[plugins]", 'require = "x"'], "plugins.require: a list is expected, not 'x'"),
        (["[plugins]", "require = [1]"], "plugins.require[0]: a text is expected, not 1"),
        (["[bearing.profile]", 'shape = "curved"'], "bearing.profile.shape: must be one of 'none', 'iso16281'"),
        (["[bearing.profile]", "radius = 1"], "bearing.profile.radius: only read for shape = 'circular', not for"),
        (["[bearing.profile]", "drop = [1]"], "bearing.profile.drop: only read for shape = 'table', not for 'none'"),
        (["[bearing.material]", "poisson_ratio = 0.6"], "bearing.material.poisson_ratio: must be from 0 to 0.5, not"),
        (["[bearing.material]", "hardness = 60"], "bearing.material.hardness: unknown key; known are density, elas"),
        (["[moodels]"], "moodels: unknown key, did you mean 'models'?"),
    ],
)
def test_a_fault_in_an_optional_table_is_reported_with_its_line(lines: list[str], message: str) -> None:
    [problem] = problems_of(scene_with(*lines))
    assert problem.startswith(f"scene.toml:{len(LINES) + len(lines)}: {message}")


@pytest.mark.parametrize(
    ("written", "message"),
    [
        ('{ shape = "circular" }', "bearing.profile.radius: missing, but required for shape = 'circular'"),
        ('{ shape = "table" }', "bearing.profile.position: a table needs at least 2 places, not 0"),
        ('{ shape = "table", position = [0, 1], drop = [0] }', "bearing.profile.drop: needs one value for each of 2"),
        ('{ shape = "table", position = [1, 0], drop = [0, 0] }', "bearing.profile.position: must ascend"),
        ('{ shape = "table", position = [0, 1], drop = [0, -1] }', "bearing.profile.drop: must be at least 0, not -1"),
        ('{ shape = "table", position = [0, "1 kg"], drop = [0, 0] }', "bearing.profile.position[1]: '1 kg' is a mass"),
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


def test_an_empty_scene_lists_what_is_required() -> None:
    problems = problems_of("")
    assert [problem.split(" (")[0] for problem in problems] == [
        f"scene.toml: {name}: missing, but required" for name in ("bearing", "lubricant", "operation")
    ]


def test_a_missing_key_says_what_is_expected() -> None:
    assert problems_of(scene_with(radial_load="")) == [
        "scene.toml:14: operation.radial_load: missing, but required (radial load); "
        "a force is expected, such as '3415 N'"
    ]


@pytest.mark.parametrize("table", ["bearing", "lubricant", "study", "cage", "models", "plugins", "study.curve"])
def test_a_table_is_a_table(table: str) -> None:
    problems = problems_of(f"{table} = 1\n")
    assert any(p.startswith(f"scene.toml:1: {table}: a table") and p.endswith("is expected, not 1") for p in problems)


@pytest.mark.parametrize(
    ("text", "start", "end"),
    [
        ("a = 1\nb = \n", "scene.toml:2: not valid TOML: ", "(column 5)"),
        ("a = 15 mm\n", "scene.toml:1: not valid TOML: ", 'one with a unit in quotes, as "15 mm"'),
        ("[a]\nb = 1,5\n", "scene.toml:2: not valid TOML: ", 'one with a unit in quotes, as "15 mm"'),
        ("a = 1\nb = [1,\n", "scene.toml:3: not valid TOML: ", "(at the end of the file)"),
        ("a = 1e5\na = 1e5\nb = 1", "scene.toml:2: not valid TOML: ", ")"),
        ("a = " + "1" * 5000, "scene.toml: not valid TOML: ", ""),
        ("a = " + "[" * 100_000, "scene.toml", ""),
    ],
)
def test_a_syntax_error_has_its_line(text: str, start: str, end: str) -> None:
    [problem] = problems_of(text)
    assert problem.startswith(start)
    assert problem.endswith(end)


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
        (tmp_path / "none.toml", f"{tmp_path / 'none.toml'}: there is no such file"),
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


# Changes ------------------------------------------------------------------------------------------------------------


def test_evolve_changes_values_by_dotted_key() -> None:
    scene = parse_scene(SCENE, "scene.toml")
    changed = evolve(
        scene,
        {
            "operation.radial_load": "500 N",
            "lubricant.eyring_stress": "5 MPa",
            "models.film": "dowson-1968",
            "models.traction.hydrodynamic": "muraki",
            "study.effective-friction.closure": "free-roller",
            "bearing.profile.shape": "iso16281",
            "bearing.material.density": 7850,
            "surface.roller_roughness": "0.2 um",
        },
    )
    assert changed.operation.radial_load == 500
    assert changed.lubricant.name == "mil-prf-7808"
    assert changed.lubricant.data["eyring_stress"] == "5 MPa"
    assert changed.models.film.name == "dowson-1968"
    assert changed.models.traction == ModelChoice(
        name="lambda-blend", parameters=FrozenTable({"hydrodynamic": "muraki"})
    )
    assert changed.study["effective-friction"]["closure"] == "free-roller"
    assert changed.study["effective-friction"]["slip"] == ("0 %", "30 %")
    assert changed.bearing.profile.shape == "iso16281"
    assert changed.bearing.material.density == 7850
    assert changed.surface.roller_roughness == 0.2e-6
    assert (changed.source, changed.text) == (scene.source, scene.text)
    assert scene == parse_scene(SCENE, "scene.toml")


def test_evolve_lets_what_follows_from_a_value_follow() -> None:
    scene = parse_scene(SCENE, "scene.toml")
    warm = evolve(scene, {"operation.temperature": "80 degC", "bearing.outer_raceway_diameter": "195.05 mm"})
    assert warm.operation.roller_temperature == 353.15
    assert warm.bearing.radial_clearance == 50e-6


def test_a_bare_name_becomes_a_table_when_a_parameter_is_set() -> None:
    scene = parse_scene(scene_with("[models.traction]", 'model = "constant"'), "scene.toml")
    film = evolve(scene, {"models.film": "regime", "models.film.thermal": True}).models.film
    assert film == ModelChoice(name="regime", parameters=FrozenTable({"thermal": True}))
    traction = evolve(scene, {"models.traction.friction": 0.1}).models.traction
    assert traction == ModelChoice(name="constant", parameters=FrozenTable({"friction": 0.1}))


def test_changes_add_up() -> None:
    scene = parse_scene(SCENE, "scene.toml")
    both = evolve(scene, {"operation.radial_load": 1, "title": "x"})
    assert evolve(evolve(scene, {"operation.radial_load": 1}), {"title": "x"}) == both
    assert evolve(scene, {}) == scene


def test_a_scene_made_in_python_can_be_changed() -> None:
    scene = parse_scene(SCENE, "scene.toml")
    made = attrs.evolve(scene, raw=None, origins={})
    assert evolve(made, {"operation.radial_load": "1 N"}).operation.radial_load == 1


def test_faults_of_changes_are_marked_and_the_others_keep_their_lines() -> None:
    scene = parse_scene(SCENE, "scene.toml")
    with pytest.raises(SceneError) as caught:
        evolve(
            scene,
            {
                "operation.radial_lod": 1,
                "lubricant.name": 5,
                "bearing.rollers": 12.5,
                "bearing.profile": {"shape": "x"},
                "bearing.material": 5,
                "operation.temperature": None,
            },
        )
    assert sorted(problem.split("; ")[0] for problem in caught.value.problems) == [
        "changes: bearing.material: a table is expected, not 5",
        "changes: bearing.profile.shape: must be one of 'none', 'iso16281', 'circular', 'table', not 'x'",
        "changes: bearing.rollers: a whole number is expected, not 12.5",
        "changes: lubricant.name: a text is expected, not 5",
        "changes: operation.radial_lod: unknown key, did you mean 'radial_load'?",
        "changes: operation.temperature: None is not a quantity, here a temperature is expected, such as '70 degC'",
    ]
    assert scene.origins["bearing", "rollers"] == "scene.toml:4"


@pytest.mark.parametrize("key", ["", " ", ".", "a..b", "a b", "a=1", 'a."b', '"\\q"', "a\nb", "[a]", "ä"])
def test_what_is_no_key_is_reported(key: str) -> None:
    with pytest.raises(SceneError, match="is not a key"):
        evolve(parse_scene(SCENE, "scene.toml"), {key: 1})


@pytest.mark.parametrize("key", ["title.x", "bearing.rollers.x", "study.effective-friction.slip.x", "lubricant.name.x"])
def test_a_key_below_a_value_is_reported(key: str) -> None:
    with pytest.raises(SceneError, match=f"changes: '{key}' leads nowhere: '{key.split('.')[-2]}' is not a table"):
        evolve(parse_scene(SCENE, "scene.toml"), {key: 1})


def test_keys_may_be_quoted() -> None:
    changed = evolve(parse_scene(SCENE, "scene.toml"), {'study."my study".x': 1, "study.'a.b'.x": 2})
    assert changed.study["my study"] == {"x": 1}
    assert changed.study["a.b"] == {"x": 2}


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner, max_size=3),
    max_leaves=5,
)
scene_keys = st.sampled_from([row.key.replace("*", "x") for row in schema()] + ["bearing", "models", "study", "x"])


@given(st.dictionaries(scene_keys, json_values, max_size=3))
@settings(max_examples=200, deadline=None)
def test_any_change_gives_a_scene_or_a_scene_error(changes: dict[str, object]) -> None:
    scene = parse_scene(SCENE, "scene.toml")
    with contextlib.suppress(SceneError, PluginError):  # named data may not exist
        changed = evolve(scene, changes)
        assert structure(Scene, json.loads(json.dumps(resolved(changed))), "", []) == changed
        assert len(scene_hash(changed)) == 64


@pytest.mark.parametrize(
    ("text", "key", "value"),
    [
        ("operation.radial_load=500 N", "operation.radial_load", "500 N"),
        ("operation.radial_load = 500", "operation.radial_load", 500),
        ("operation.radial_load=5e2", "operation.radial_load", 500.0),
        ('operation.radial_load="500 N"', "operation.radial_load", "500 N"),
        ("models.film=moes", "models.film", "moes"),
        ("a=true", "a", True),
        ("a=[1, 2]", "a", [1, 2]),
        ("a={ x = 1 }", "a", {"x": 1}),
        ("a=1979-05-27", "a", "1979-05-27"),
        ("a=1,5 mm", "a", "1,5 mm"),
        ("a=1\nb = 2", "a", "1\nb = 2"),
        ("a=b=c", "a", "b=c"),
        ("a=", "a", ""),
    ],
)
def test_a_setting_of_the_command_line_is_toml_or_text(text: str, key: str, value: object) -> None:
    assert parse_set(text) == (key, value)


@pytest.mark.parametrize("text", ["operation.radial_load", "", "=5", " = 5"])
def test_a_setting_needs_key_and_value(text: str) -> None:
    with pytest.raises(SceneError, match="write KEY=VALUE"):
        parse_set(text)


# The reader for classes of plugins and studies ----------------------------------------------------------------------


@attrs.frozen(kw_only=True)
class Law:
    modulus: float = parameter(unit="Pa", doc="shear modulus", validator=positive)
    kind: str = parameter(default="a", doc="kind", validator=one_of("a", "b"))
    thermal: bool = parameter(default=True, doc="with heating")
    steps: int = parameter(default=5, doc="steps", validator=attrs.validators.ge(1))
    span: tuple[float, float] = parameter(default=(0.0, 1.0), unit="1", doc="range of slip")
    limit: float | None = parameter(default=None, unit="K", doc="limit", validator=attrs.validators.optional(positive))
    inner: ModelChoice = parameter(default=ModelChoice(name="x"), doc="another model")
    share: float = attrs.field(default=0.5, validator=attrs.validators.instance_of(float))
    _hidden: float = attrs.field(default=0.0, init=False)

    def __attrs_post_init__(self) -> None:
        if self.span[0] > self.span[1]:
            raise ValueError("the range runs backwards")


def test_a_class_is_made_from_raw_values() -> None:
    problems: list[str] = []
    raw = {"modulus": "300 MPa", "span": ["1 %", 0.3], "limit": "70 degC", "inner": "moes", "share": 1}
    law = structure(Law, raw, "law", problems)
    assert problems == []
    assert law == Law(modulus=3e8, span=(0.01, 0.3), limit=343.15, inner=ModelChoice(name="moes"), share=1.0)


@pytest.mark.parametrize(
    ("raw", "message"),
    [
        ({}, "law.modulus: missing, but required (shear modulus); a pressure is expected, such as '4 MPa'"),
        ({"modulus": 1, "kind": "c"}, "law.kind: must be one of 'a', 'b', not 'c'"),
        ({"modulus": 1, "thermal": 1}, "law.thermal: true or false is expected, not 1"),
        ({"modulus": 1, "thermal": "yes"}, "law.thermal: true or false is expected, not 'yes'"),
        ({"modulus": 1, "steps": 0}, "law.steps: 'steps' must be >= 1: 0"),
        ({"modulus": 1, "span": [1]}, "law.span: a list of 2 values is expected, not of 1"),
        ({"modulus": 1, "span": 5}, "law.span: a list is expected, not 5"),
        ({"modulus": 1, "span": [0, "x"]}, "law.span[1]: 'x' is not a number with a unit"),
        ({"modulus": 1, "span": [1, 0]}, "law: the range runs backwards"),
        ({"modulus": 1, "limit": 0}, "law.limit: must be above 0, not -273.15 degC"),
        ({"modulus": 1, "_hidden": 0}, "law._hidden: unknown key"),
        ({"modulus": 1, "moduls": 0}, "law.moduls: unknown key, did you mean 'modulus'?"),
        ({"modulus": 1, "a b": 0}, "law.'a b': unknown key"),
        (5, "law: a table is expected, not 5"),
        ("x", "law: a table is expected, not 'x'"),
    ],
)
def test_faults_of_a_class_are_collected(raw: object, message: str) -> None:
    problems = ["one before"]
    assert structure(Law, raw, "law", problems) is None
    assert len(problems) == 2
    assert problems[1].startswith(message)


def test_parameters_are_reported_with_the_line_in_the_scene() -> None:
    scene = parse_scene(scene_with("[models.traction]", 'model = "law"', 'modulus = "3 m"'), "scene.toml")
    problems: list[str] = []
    structure(Law, scene.models.traction.parameters, Where(scene.origins, ("models", "traction")), problems)
    assert problems[0].startswith(f"scene.toml:{len(LINES) + 3}: models.traction.modulus: '3 m' is a length")


def test_a_field_of_a_type_that_no_scene_holds_is_a_mistake_of_its_author() -> None:
    @attrs.frozen
    class Wrong:
        value: complex = parameter(doc="?", default=0j)

    with pytest.raises(TypeError, match="complex"):
        structure(Wrong, {"value": 1}, "wrong", [])


@pytest.mark.parametrize(
    ("validator", "value", "message"),
    [
        (positive, 0.0, "x: must be above 0, not 0 Pa"),
        (non_negative, -1e6, "x: must be at least 0, not -1 MPa"),
        (at_least(1e6), 0.0, "x: must be at least 1 MPa, not 0 Pa"),
        (in_range(0, 1e6), 2e6, "x: must be from 0 to 1 MPa, not 2 MPa"),
        (in_range(0, 1e6, open=True), 1e6, "x: must be between 0 and 1 MPa, without the ends, not 1 MPa"),
        (in_range(0, 1e6), math.nan, "x: must be from 0 to 1 MPa, not nan Pa"),
        (one_of(1, "two"), 3.0, "x: must be one of 1, 'two', not 3 Pa"),
    ],
)
def test_a_validator_says_what_came_and_what_is_allowed(validator: Any, value: float, message: str) -> None:
    cls = attrs.make_class("Any", {"x": parameter(doc="x", unit="Pa", validator=validator)}, frozen=True)
    with pytest.raises(FieldError) as caught:
        cls(value)
    assert str(caught.value) == message
    assert (caught.value.field, str(pickle.loads(pickle.dumps(caught.value)))) == ("x", message)


def test_scene_classes_check_themselves_in_python_too() -> None:
    bearing = parse_scene(SCENE, "").bearing
    with pytest.raises(FieldError, match="rollers: 40 rollers"):
        attrs.evolve(bearing, rollers=40)
    with pytest.raises(FieldError, match="nothing rolls"):
        Operation(inner_speed=5.0, outer_speed=5.0, radial_load=0.0, temperature=300.0)
    with pytest.raises(TypeError):
        Bearing(28)  # type: ignore[call-arg]


# The lines of keys --------------------------------------------------------------------------------------------------

TRICKY = '''\
# [not.a.table] = "x"
a = "# no comment" # a comment with "quotes
'b c' = 'x = "1"'
"d\\"e".f . g = """
[h]
i = 1 \\""" still
"""""
j = \'\'\'
k = 1
\'\'\'
l = [ # ]
  "]", \'[\', [1, 2],
  { m = 1, n = [ "}" ] },
]
o = ""
p = { q.r = 1, s = "}" }

[t] # [u]
v = 1979-05-27T07:32:00Z
[ w . "x y" ]
z = \'\'
[[aa]]
b = 1
[[aa.b-b]]
c = 1
[[ aa.b-b ]]
c = 1
[aa.b-b.d]
e = 1
[[aa]]
b = 1
[[aa.b-b]]
c = """a"""
[w]
last = -inf'''


def test_the_lines_of_a_tricky_document() -> None:
    expected = {
        ("a",): 2,
        ("b c",): 3,
        ('d"e',): 4,
        ('d"e', "f", "g"): 4,
        ("j",): 8,
        ("l",): 11,
        ("o",): 15,
        ("p",): 16,
        ("t",): 18,
        ("t", "v"): 19,
        ("w",): 34,
        ("w", "x y"): 20,
        ("w", "x y", "z"): 21,
        ("aa",): 22,
        ("aa", 0): 22,
        ("aa", 0, "b"): 23,
        ("aa", 0, "b-b"): 24,
        ("aa", 0, "b-b", 0, "c"): 25,
        ("aa", 0, "b-b", 1): 26,
        ("aa", 0, "b-b", 1, "c"): 27,
        ("aa", 0, "b-b", 1, "d"): 28,
        ("aa", 0, "b-b", 1, "d", "e"): 29,
        ("aa", 1): 30,
        ("aa", 1, "b"): 31,
        ("aa", 1, "b-b", 0, "c"): 33,
        ("w", "last"): 35,
    }
    tomllib.loads(TRICKY)
    for text in (TRICKY, TRICKY + "\n", TRICKY.replace("\n", "\r\n")):
        lines = key_lines(text)
        assert {path: lines.get(path) for path in expected} == expected


keys = st.sampled_from(["a", "b-c", "1", '"q.r"', "'s t'", '"u\\"#v"', "'[w]'"])
scalars = st.sampled_from(
    [
        "1",
        "-1.5e3",
        "true",
        '"x"',
        '"a # [b] \\" = 1"',
        "'# \"'",
        '"""\n[z]\na = 1\n"""',
        "'''\n'''",
        "nan",
        '""""x"""""',
    ]
)
values = st.recursive(
    scalars,
    lambda inner: st.one_of(
        st.lists(inner, max_size=3).map(lambda items: "[" + " , # ]\n".join([*items, ""]) + "]"),
        st.lists(st.tuples(keys, scalars), max_size=2, unique_by=lambda item: item[0]).map(
            lambda items: "{" + ", ".join(f"{key} = {value}" for key, value in items) + "}"
        ),
    ),
    max_leaves=4,
)
dotted = st.lists(keys, min_size=1, max_size=3).map(" . ".join)
statements = st.lists(
    st.one_of(
        st.tuples(dotted, values).map(lambda item: f"{item[0]} = {item[1]} # x = 1"),
        dotted.map(lambda key: f"[{key}]"),
        dotted.map(lambda key: f"[[ {key} ]] # ["),
        st.sampled_from(["", "# [a]", "  \t"]),
    ),
    max_size=12,
)


def valid_document(lines: list[str]) -> str:
    """Keep the statements that TOML allows after those before them."""
    text = ""
    for line in lines:
        try:
            tomllib.loads(text + line + "\n")
        except tomllib.TOMLDecodeError:
            continue
        text += line + "\n"
    return text


def leaves(value: object, path: tuple[str | int, ...] = ()) -> list[tuple[str | int, ...]]:
    if isinstance(value, Mapping) and value:
        return [leaf for key, inner in value.items() for leaf in leaves(inner, (*path, key))]
    return [path]


@given(statements)
@settings(deadline=None)
def test_every_key_has_the_line_where_it_appeared(lines: list[str]) -> None:
    """The line noted for a key is that of the statement with which the key enters the parsed document."""
    text = valid_document(lines)
    noted = key_lines(text)
    every: set[tuple[str | int, ...]] = set()
    for path in leaves(tomllib.loads(text)):
        longest = next((path[:n] for n in range(len(path), 0, -1) if path[:n] in noted), None)
        if path:
            assert longest is not None
            every.add(longest)
    documents = complete_documents(text)
    for path in every:
        line = noted[path]
        before, after = documents[line], documents[min(start for start in documents if start > line)]
        assert holds(after, path)
        # Later statements may open a table again; anything else enters once.
        assert not holds(before, path) or isinstance(lookup(before, path), dict | list)


def complete_documents(text: str) -> dict[int, dict[str, Any]]:
    """Map each line before which the document is complete, so that a statement can begin there, to that document."""
    lines = text.splitlines(keepends=True)
    documents = {}
    for number in range(len(lines) + 1):
        with contextlib.suppress(tomllib.TOMLDecodeError):
            documents[number + 1] = tomllib.loads("".join(lines[:number]))
    return documents


def lookup(document: Any, path: tuple[str | int, ...]) -> Any:
    for part in path:
        document = document[part]
    return document


def holds(document: Any, path: tuple[str | int, ...]) -> bool:
    try:
        lookup(document, path)
    except (LookupError, TypeError):
        return False
    return True


# Schema and cost ----------------------------------------------------------------------------------------------------


def test_the_schema_has_every_promised_key() -> None:
    rows = {row.key: row for row in schema()}
    assert len(rows) == len(schema())
    assert rows["bearing.rollers"].default == "required"
    assert rows["bearing.roller_diameter"].unit == "m"
    assert rows["bearing.radial_clearance"].default == "derived"
    assert rows["bearing.profile"].default == "none"
    assert rows["bearing.material.elastic_modulus"] == (
        "bearing.material.elastic_modulus",
        "Pa",
        "208 GPa",
        "Young's modulus",
    )
    assert rows["models.traction"].default == "lambda-blend"
    assert rows["surface.roller_roughness"].default == "0.1 um"
    assert {"models.traction.*", "lubricant.*", "cage.*", "study.*", "accuracy.slices", "title"} <= rows.keys()
    assert all(row.doc and not row.doc.endswith(".") for row in schema())
    assert not {"source", "text", "raw", "origins"} & rows.keys()


def test_reading_a_scene_imports_nothing_heavy() -> None:
    heavy = ("numpy", "scipy", "xarray", "matplotlib", "cattrs", "rich", "click", "pluggy")
    code = f"import sys, rollslip.scene.reading; sys.exit(any(name in sys.modules for name in {heavy}))"
    subprocess.run([sys.executable, "-c", code], check=True)
