"""All keys of a scene: found by any part of their name, and shown with what can be pasted."""

import tomllib

import pytest
from click.shell_completion import BashComplete

from rollslip import load_scene
from rollslip.bearing.assembly import assemble
from rollslip.cli.main import cli
from rollslip.errors import SceneError
from rollslip.planning.keys import example, keys, keys_of
from rollslip.scene.changes import parse_set
from rollslip.studies.quantities import quantities
from rollslip.studies.study import settings
from rollslip.units import quantity

SCENE = load_scene("1032930-70C")


def test_every_value_that_can_vary_is_a_key():
    varied = quantities(assemble(SCENE), settings(SCENE))
    known = {row.key for row in keys(models=True)}
    # the models in a model are shown by `rollslip models NAME`
    missing = [
        key
        for key in varied
        if key not in known and key.count(".") < 3 and not key.startswith("models.traction")
    ]
    assert missing == []


def test_examples_can_be_pasted():
    rows = [row for row in keys() if row.key.count("*") == 0]
    assert len(rows) > 100
    for row in rows:
        table = tomllib.loads(f"value = {example(row)}")
        key, value = parse_set(f"{row.key}={example(row).strip(chr(34))}")
        assert key == row.key
        if row.unit and row.type in ("quantity", "number"):
            quantity(table["value"], row.unit)  # of its own unit, or it raises
            assert quantity(value, row.unit) == quantity(table["value"], row.unit)


@pytest.mark.parametrize(
    ("word", "first"),
    [
        ("operation.radial_load", "operation.radial_load"),
        ("radial_load", "operation.radial_load"),
        ("cage", "cage.make"),
        ("oil", "lubricant"),
        ("dynamics", "study.dynamics.level"),
        ("study.dynamics", "study.dynamics.level"),
        ("models.film", "models.film"),
    ],
)
def test_a_word_finds_its_keys(word, first):
    assert keys_of(word)[0].key == first


def test_a_word_that_no_key_has_gets_the_nearest():
    with pytest.raises(
        SceneError, match=r"no key of a scene is called 'radial_laod'; did you mean 'radial_load'"
    ):
        keys_of("radial_laod")


def completed(*arguments, word):
    return [
        item.value
        for item in BashComplete(cli, {}, "rollslip", "_ROLLSLIP_COMPLETE").get_completions(
            [*arguments], word
        )
    ]


def test_shells_complete_scenes_keys_and_names(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "pump.toml").write_text("")
    (tmp_path / "notes.txt").write_text("")
    assert completed("run", word="") == [
        "1032930-30C",
        "1032930-50C",
        "1032930-70C",
        "gearbox",
        "turbine",
        "pump.toml",
    ]
    assert completed("run", "pump.toml", "--set", word="operation.rad") == [
        "operation.radial_load="
    ]
    assert completed("schema", word="cage.land_r") == ["cage.land_radius"]
    assert completed("new", "a.toml", "--bearing", word="NU2326") == ["NU2326E"]
    assert completed("new", "a.toml", "--oil", word="iso-vg-3") == ["iso-vg-32", "iso-vg-320"]
    assert completed("models", word="mura") == ["muraki"]
    assert completed("run", "pump.toml", "--study", word="st") == ["steady-slip"]
