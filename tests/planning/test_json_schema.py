"""The JSON Schema of scenes: held by its own metaschema, and against all scenes in the box."""

import tomllib
from importlib import resources

import jsonschema
import pytest

from rollslip.planning.json_schema import json_schema
from rollslip.planning.keys import keys
from rollslip.planning.new_scene import ASSUMED, new_scene

SCENES = sorted(
    one.name
    for one in resources.files("rollslip_plugins.scenes").iterdir()
    if one.name.endswith(".toml")
)


@pytest.fixture(scope="module")
def checked():
    jsonschema.Draft7Validator.check_schema(json_schema())
    return jsonschema.Draft7Validator(json_schema())


@pytest.mark.parametrize("name", SCENES)
def test_scenes_in_the_box_are_valid(checked, name):
    text = (resources.files("rollslip_plugins.scenes") / name).read_text(encoding="utf-8")
    assert list(checked.iter_errors(tomllib.loads(text))) == []


def test_a_new_scene_is_valid_and_names_the_schema(checked):
    text = new_scene("new.toml", load="2 kN", **ASSUMED)
    assert text.startswith("#:schema ./rollslip.schema.json\n")
    assert list(checked.iter_errors(tomllib.loads(text))) == []


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"bearing": {"roler_length": 1.0}}, "'roler_length' was unexpected"),
        ({"bearing": {"rollers": "13"}}, "'13' is not of type 'integer'"),
        ({"models": {"film": "moess"}}, "'moess' is not"),
        ({"study": {"dynamics": {"level": "plane"}}}, "'plane' is not one of"),
        ({"operations": {}}, "'operations' was unexpected"),
    ],
)
def test_what_is_wrong_is_marked(checked, wrong, said):
    assert any(said in error.message for error in checked.iter_errors(wrong))


def test_every_key_has_a_place_with_its_meaning(checked):
    for row in keys():
        at = checked.schema
        for name in row.key.removesuffix(".*").removesuffix("*").split("."):
            tables = [at, *at.get("anyOf", ())]
            at = next(
                (of["properties"][name] for of in tables if name in of.get("properties", {})), None
            )
            if at is None:
                break
        assert at is not None or row.key.startswith(("sweep.", "uncertainty.")), row.key
