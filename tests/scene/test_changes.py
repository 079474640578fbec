"""Changing scenes by dotted keys."""

import contextlib
import json

import attrs
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rollslip.bearing.assembly import assemble
from rollslip.errors import PluginError, RollslipError, SceneError
from rollslip.planning.provenance import describe_scene
from rollslip.scene import FrozenTable, ModelChoice, Scene, resolved, scene_hash
from rollslip.scene.changes import SHORT, evolve, parse_set
from rollslip.scene.reading import load_scene, parse_scene
from rollslip.scene.schema import schema
from rollslip.structure import structure
from rollslip.studies.quantities import quantities
from scene_samples import SCENE, scene_with

pytestmark = pytest.mark.quick


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
        si=True,
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
    warm = evolve(
        scene, {"operation.temperature": "80 degC", "bearing.outer_raceway_diameter": "195.05 mm"}
    )
    assert warm.operation.roller_temperature == 353.15
    assert warm.bearing.radial_clearance == 50e-6


def test_a_bare_name_becomes_a_table_when_a_parameter_is_set() -> None:
    scene = parse_scene(scene_with("[models.traction]", 'model = "constant"'), "scene.toml")
    film = evolve(scene, {"models.film": "regime", "models.film.thermal": True}).models.film
    assert film == ModelChoice(name="regime", parameters=FrozenTable({"thermal": True}))
    traction = evolve(scene, {"models.traction.friction": 0.1}, si=True).models.traction
    assert traction == ModelChoice(name="constant", parameters=FrozenTable({"friction": 0.1}))


@pytest.mark.parametrize(("word", "key"), SHORT.items(), ids=SHORT)
def test_a_person_s_word_stands_for_its_key(word: str, key: str) -> None:
    base = load_scene("gearbox")
    known = quantities(assemble(base), {})
    value: object = "iso-vg-68" if word == "oil" else known[key].value
    changed = evolve(base, {key: value if known[key].unit is None else value * 1.5}, si=True)  # type: ignore[operator]
    assert changed == evolve(
        base, {word: value if known[key].unit is None else value * 1.5}, si=True
    )  # type: ignore[operator]
    assert known[word] is known[key] is known.get(word)
    assert word in known


def test_the_title_of_a_result_follows_what_was_changed() -> None:
    scene = parse_scene(SCENE, "scene.toml")
    changed = evolve(
        scene,
        {"operation.temperature": "60 degC", "accuracy.slices": 5, "models.film.model": "moes"},
    )
    said = f"{scene.title}; changed: operation.temperature = 60 degC, models.film.model = moes"
    assert [describe_scene(one)["title"] for one in (scene, changed)] == [scene.title, said]
    assert describe_scene(changed, scene)["title"] == scene.title
    assert describe_scene(evolve(changed, {"title": "mine"}))["title"] == "mine"


def test_changes_add_up() -> None:
    scene = parse_scene(SCENE, "scene.toml")
    both = evolve(scene, {"operation.radial_load": 1, "title": "x"}, si=True)
    assert evolve(evolve(scene, {"operation.radial_load": 1}, si=True), {"title": "x"}) == both
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
            si=True,
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


@pytest.mark.parametrize(
    "key", ["", " ", ".", "a..b", "a b", "a=1", 'a."b', '"\\q"', "a\nb", "[a]", "ä"]
)
def test_what_is_no_key_is_reported(key: str) -> None:
    with pytest.raises(SceneError, match="is not a key"):
        evolve(parse_scene(SCENE, "scene.toml"), {key: 1}, si=True)


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        (
            "operation.axial_load",
            "1 N",
            "operation.axial_load: nothing in this bearing carries 1 N along its axis: types NU, N, RNU",
        ),
        (
            "operation.thrust_load",
            "1 N",
            "operation.thrust_load: unknown key, write axial_load",
        ),
        (
            "operation.radial_load",
            [1, 2],
            "such as '3415 N'; give the resultant of components, or one value: sweep takes",
        ),
        (
            "bearing.name",
            6312,
            "bearing.name: no bearing is called '6312': this is a deep groove ball bearing",
        ),
        ("bearing.name", True, "bearing.name: a text is expected, not true"),
    ],
)
def test_what_was_meant_otherwise_gets_advice(key: str, value: object, said: str) -> None:
    with pytest.raises(RollslipError) as caught:
        evolve(parse_scene(SCENE, "scene.toml"), {key: value}, si=True)
    assert said in str(caught.value)


@pytest.mark.parametrize(
    "key", ["title.x", "bearing.rollers.x", "study.effective-friction.slip.x", "lubricant.name.x"]
)
def test_a_key_below_a_value_is_reported(key: str) -> None:
    with pytest.raises(
        SceneError, match=f"changes: '{key}' does not exist: '{key.split('.')[-2]}' is not a table"
    ):
        evolve(parse_scene(SCENE, "scene.toml"), {key: 1}, si=True)


def test_keys_may_be_quoted() -> None:
    changed = evolve(
        parse_scene(SCENE, "scene.toml"), {'study."my study".x': 1, "study.'a.b'.x": 2}, si=True
    )
    assert changed.study["my study"] == {"x": 1}
    assert changed.study["a.b"] == {"x": 2}


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner, max_size=3)
    ),
    max_leaves=5,
)
scene_keys = st.sampled_from(
    [row.key.replace("*", "x") for row in schema()] + ["bearing", "models", "study", "x"]
)


@pytest.mark.slow
@given(st.dictionaries(scene_keys, json_values, max_size=3))
def test_any_change_gives_a_scene_or_a_scene_error(changes: dict[str, object]) -> None:
    scene = parse_scene(SCENE, "scene.toml")
    with contextlib.suppress(SceneError, PluginError):  # named data may not exist
        changed = evolve(scene, changes, si=True)
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


def test_a_parameter_of_one_of_several_models_is_set_by_its_name() -> None:
    several = evolve(
        load_scene("1032930-70C"),
        {"models.torque": ["skf", {"model": "constant-coefficient", "coefficient": 0.002}]},
    )
    changed = evolve(
        several,
        {"models.torque.skf.series": "22", "models.torque.constant-coefficient.coefficient": 0.003},
    )
    assert [(one.name, dict(one.parameters)) for one in changed.models.torque] == [
        ("skf", {"series": "22"}),
        ("constant-coefficient", {"coefficient": 0.003}),
    ]
    assert several.models.torque[1].parameters["coefficient"] == 0.002
    alone = evolve(
        load_scene("1032930-70C"),
        {"models.damage": "power-density", "models.damage.power-density.allowed": "5 MW/m2"},
    )
    (one,) = alone.models.damage
    assert (one.name, dict(one.parameters)) == ("power-density", {"allowed": "5 MW/m2"})


@pytest.mark.parametrize(
    ("key", "sentence"),
    [
        (
            "models.torque.palmgren.load_factor",
            "'torque' names skf, constant-coefficient, not 'palmgren'",
        ),
        ("models.torque.skf", "'torque' is a list; add a parameter of one, or set all of the list"),
        ("models.damage.power-density.allowed", "'damage' names nothing, not 'power-density'"),
        ("models.torque.skf.series.x", "'series' is not a table"),
    ],
)
def test_a_key_that_leads_to_none_of_several_models_is_refused(key: str, sentence: str) -> None:
    several = evolve(
        load_scene("1032930-70C"),
        {"models.torque": [{"model": "skf", "series": "22"}, "constant-coefficient"]},
    )
    with pytest.raises(SceneError) as error:
        evolve(several, {key: 1}, si=True)
    assert f"changes: '{key}' does not exist: {sentence}" in str(error.value)


def test_a_fault_of_one_of_several_models_names_the_change() -> None:
    several = evolve(load_scene("1032930-70C"), {"models.torque": ["skf", "constant-coefficient"]})
    with pytest.raises(
        SceneError, match=r"changes: models.torque\[1\].coefficient: must be at least 0, not -1"
    ):
        assemble(evolve(several, {"models.torque.constant-coefficient.coefficient": -1}))


def test_parameters_of_several_models_can_be_swept() -> None:
    several = evolve(
        load_scene("1032930-70C"),
        {"models.torque": ["skf", "constant-coefficient"], "models.damage": ["film-parameter"]},
    )
    known = quantities(assemble(several), {})
    assert known["models.torque.constant-coefficient.coefficient"].unit == "1"
    assert known["models.torque.skf.drag"].value == "later"
    assert "models.damage.film-parameter.allowed" in known


@pytest.mark.parametrize(("word", "shape"), [("logarithmic", "iso16281"), ("straight", "none")])
def test_a_profile_is_taken_by_the_name_that_answers_have_for_it(word, shape):
    scene = load_scene("gearbox")
    assert evolve(scene, {"bearing.profile": word}).bearing.profile.shape == shape
    assert evolve(scene, {"bearing.profile.shape": word}).bearing.profile.shape == shape


def test_a_parameter_of_a_model_within_a_model_is_set_where_that_has_a_bare_name():
    scene = evolve(load_scene("gearbox"), {"models.traction.hydrodynamic.flash": 0.9})
    within = scene.models.traction.parameters["hydrodynamic"]
    assert dict(within) == {"model": "maxwell-eyring-local", "flash": 0.9}
