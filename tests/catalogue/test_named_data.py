"""Bearings as data of plugins, and surfaces: a scene names a set and changes values of it."""

from pathlib import Path

import attrs
import pytest

import rollslip_plugins
from packages import install, python
from rollslip import evolve, load_scene, plan
from rollslip.catalogue import discovery
from rollslip.catalogue.registry import get_model
from rollslip.datasets import SURFACES, BearingData
from rollslip.errors import PluginError, SceneError
from rollslip.planning.provenance import citations
from rollslip.references import KLEBANOV
from rollslip.scene import Bearing, Material, Profile, Surface, resolved, scene_hash
from rollslip.scene.reading import parse_scene
from rollslip.scene.schema import schema
from rollslip_campaigns.sweep.sweep import plan_sweep
from rollslip_plugins.data.bearings import bearing_1032930

SHIPPED = load_scene("1032930-70C")
FILE = Path(rollslip_plugins.__file__).parent / "scenes" / "1032930-70C.toml"
CROWNED = BearingData(
    name="crowned",
    description="a bearing of a test",
    source="none",
    validity="nothing",
    references=("Nobody N. On crowned rollers. J. None 1, 2000.",),
    bearing=Bearing(
        rollers=20,
        roller_diameter=0.01,
        roller_length=0.012,
        inner_raceway_diameter=0.08,
        outer_raceway_diameter=0.1,
        radial_clearance=40e-6,
        profile=Profile(shape="circular", radius=5.0),
        material=Material(elastic_modulus=300e9, density=3200.0),
    ),
)
SMOOTH = Surface(inner_raceway_roughness=5e-8, outer_raceway_roughness=5e-8, roller_roughness=3e-8)


@pytest.fixture(autouse=True)
def named(monkeypatch):
    """The sets of this module under their names, and that of the box until its entry point is installed."""
    monkeypatch.setattr(discovery, "_registered", {})
    for kind, thing in [("bearing", CROWNED), ("bearing", bearing_1032930)]:
        discovery.add(kind, thing, replace=True)


def scene(bearing="", surface="", **tables):
    lines = [
        f"[bearing]\n{bearing}",
        f"[surface]\n{surface}",
        "[lubricant]\nname = 'mil-prf-7808'",
        "[operation]\ninner_speed = '1000 rpm'\nradial_load = '1 kN'\ntemperature = '70 degC'",
        *(f"[{name.replace('_', '.')}]\n{text}" for name, text in tables.items()),
    ]
    return parse_scene("\n".join(lines) + "\n", "scene.toml")


def test_the_bearing_in_the_box_is_that_of_the_shipped_scenes():
    for name in ("1032930-30C", "1032930-50C", "1032930-70C"):
        assert load_scene(name).bearing == bearing_1032930.bearing
    assert get_model("bearing", "1032930") is bearing_1032930
    assert bearing_1032930.source.endswith(".")
    assert bearing_1032930.validity.endswith(".")
    assert bearing_1032930.references


def test_a_name_stands_for_all_values():
    read = scene("name = 'crowned'", "name = 'superfinished'")
    assert read.bearing == CROWNED.bearing
    assert read.surface == SMOOTH
    assert scene("name = 'crowned'", "name = 'Super-Finished'").surface == SMOOTH
    assert scene("name = 'crowned'", "name = 'ground'").surface == Surface()
    assert read.raw["bearing"] == {"name": "crowned"}


@pytest.mark.slow
def test_what_a_scene_takes_by_its_name_is_cited():
    by_name = citations(plan(scene("name = 'crowned'")))
    assert {*CROWNED.references} <= set(by_name)
    assert not {*CROWNED.references} & set(citations(plan(scene("name = '1032930'"))))
    sweep = plan_sweep(scene("name = 'crowned'"), over={"operation.radial_load": [500.0, 1000.0]})
    assert {*CROWNED.references} <= set(sweep.citations)
    assert sweep.citations[0] == KLEBANOV


def test_a_scene_with_a_name_is_the_scene_with_its_values():
    written = SHIPPED.text.split("[bearing]")
    head = written[0]
    tail = "[surface]" + written[1].split("[surface]")[1]
    short = parse_scene(f"{head}[bearing]\nname = '1032930'\n\n{tail}", "short.toml")
    assert short == SHIPPED
    assert scene_hash(short) == scene_hash(SHIPPED)
    assert "name" not in resolved(short)["bearing"]


def test_other_keys_change_the_values():
    read = scene(
        "name = 'crowned'\nrollers = 18\nprofile = 'none'",
        "name = 'superfinished'\nroller_roughness = '0.5 um'",
    )
    assert read.bearing == attrs.evolve(CROWNED.bearing, rollers=18, profile=Profile())
    assert read.surface == attrs.evolve(SMOOTH, roller_roughness=5e-7)


def test_a_table_of_values_is_filled_and_a_choice_is_taken_whole():
    read = scene(
        "name = 'crowned'",
        bearing_material="density = '7000 kg/m3'",
        bearing_profile="shape = 'iso16281'",
    )
    assert read.bearing.material == attrs.evolve(CROWNED.bearing.material, density=7000.0)
    assert read.bearing.profile == Profile(shape="iso16281")


def test_a_clearance_that_follows_from_the_diameters_follows():
    assert (
        scene("name = '1032930'\nouter_raceway_diameter = '195.04 mm'").bearing.radial_clearance
        == 4e-5
    )
    assert (
        scene("name = 'crowned'\nouter_raceway_diameter = '100.1 mm'").bearing.radial_clearance
        == 4e-5
    )  # its own


def test_changes_start_from_the_name():
    read = scene("name = 'crowned'")
    changed = evolve(read, {"bearing.name": "1032930", "bearing.material.density": "7000 kg/m3"})
    assert changed.bearing == attrs.evolve(
        bearing_1032930.bearing, material=Material(density=7000.0)
    )
    changed = evolve(
        read, {"bearing.material.density": "7000 kg/m3", "surface.name": "superfinished"}
    )
    assert changed.bearing.material == attrs.evolve(CROWNED.bearing.material, density=7000.0)
    assert changed.surface == SMOOTH


def faults(error, read, *arguments, **tables):
    with pytest.raises(error) as caught:
        read(*arguments, **tables)
    return str(caught.value).splitlines()


def test_an_unknown_name_gets_the_nearest():
    hint = "('rollslip models bearing' lists them)"
    assert faults(PluginError, scene, "rollers = 20\nname = 'crown'") == [
        f"scene.toml:3: bearing.name: no bearing is called 'crown'; did you mean 'crowned'? {hint}"
    ]
    assert faults(PluginError, evolve, SHIPPED, {"surface.name": "rusty"}) == [
        "changes: surface.name: no surface is called 'rusty'; there are: ground, superfinished"
    ]


def test_faults_of_changed_values_have_their_lines():
    assert faults(
        SceneError,
        scene,
        "name = 'crowned'\nrollers = 60\nlength = 1",
        "name = 'ground'\nrougness = 1",
    ) == [
        "scene.toml:4: bearing.length: unknown key, did you mean 'roller_length'?",
        "scene.toml:7: surface.rougness: unknown key, did you mean 'roller_roughness'?",
    ]
    assert faults(SceneError, scene, "rollers = 60\nname = 'crowned'") == [
        "scene.toml:2: bearing.rollers: 60 rollers of 10 mm do not fit on a pitch circle of 90 mm: at most 28 do"
    ]


def test_a_name_is_a_text():
    assert "scene.toml:2: bearing.name: a text is expected, not 1032930" in faults(
        SceneError, scene, "name = 1032930"
    )


def test_a_name_that_gives_nothing_is_said():
    """As where a name is set in a scene that spells everything out: its values would stay, unnoticed."""
    assert faults(SceneError, evolve, SHIPPED, {"surface.name": "ground"}) == [
        "changes: surface.name: 'ground' gives nothing, every value is written out; leave out what it gives"
    ]


def test_named_data_take_no_parameters():
    with pytest.raises(
        PluginError, match="bearing takes no parameters here, got rollers; set them in"
    ):
        get_model("bearing", "crowned", rollers=20)


def test_the_schema_has_the_names():
    rows = {row.key: row for row in schema()}
    for kind, what in (
        ("bearing", "a bearing that a plugin offers"),
        ("surface", "ground or superfinished"),
    ):
        assert rows[f"{kind}.name"].doc == f"{what}, whose values the other keys change"
    assert [*SURFACES] == ["ground", "superfinished"]


# From packages -------------------------------------------------------------------------------------------------------

BEARINGS = """\
from rollslip.datasets import BearingData
from rollslip.hookspecs import hookimpl
from rollslip_plugins.data.bearings import bearing_1032930

@hookimpl
def bearings():
    bearing = bearing_1032930.bearing
    return [BearingData(name="NAME", description="d", source="s", validity="v", bearing=bearing)]
"""

READ = """
import sys
from rollslip.errors import PluginError
from rollslip.scene.changes import evolve
from rollslip.scene.reading import load_scene
scene = load_scene(%r)
print({"rollslip.catalogue.discovery", "pluggy"} & set(sys.modules))
raw = {"bearing": {"name": %r}}
try:
    print(evolve(scene, raw).bearing.rollers)
except PluginError as error:
    print(repr(str(error)))
"""


def test_a_package_offers_a_bearing_and_a_scene_without_a_name_loads_none(tmp_path):
    install(tmp_path, "rollslip-same", BEARINGS, kind="bearing", name="same")
    assert python(READ % (str(FILE), "same"), tmp_path, fresh=True) == [set(), 28]


SCENES = """\
from rollslip.datasets import SceneData
from rollslip.hookspecs import hookimpl

@hookimpl
def scenes():
    return [SceneData("NAME", "own_scenes")]
"""

RUN = """
from rollslip.errors import RollslipError
from rollslip.scene.reading import load_scene, shipped_scenes
print({"test-stand", "gearbox"} <= {*shipped_scenes()})
try:
    print(repr(load_scene("test-stand").title))
except RollslipError as error:
    print(repr(str(error)))
"""


@pytest.mark.slow
def test_a_package_ships_scenes(tmp_path):
    install(tmp_path, "rollslip-stand", SCENES, kind="scene", name="test-stand")
    (tmp_path / "own_scenes").mkdir()
    text = FILE.read_text(encoding="utf-8")
    (tmp_path / "own_scenes" / "test-stand.toml").write_text(
        text.replace('title = "', 'title = "Own ')
    )
    assert python(RUN, tmp_path) == [True, f"Own {SHIPPED.title}"]


def test_a_scene_whose_file_is_missing_is_the_packages_fault(tmp_path):
    install(tmp_path, "rollslip-stand", SCENES, kind="scene", name="test-stand")
    said = python(RUN, tmp_path)[1]
    assert said.startswith(
        "scene 'test-stand' of package rollslip-stand 1.0: its file cannot be read ("
    )
    assert said.endswith("repair or uninstall rollslip-stand")


def test_the_box_offers_a_bearing():
    """The bearing of the box is found through an entry point, like anybody's."""
    code = "from rollslip import get_model; print(get_model('bearing', '1032930').bearing.rollers)"
    assert python(code) == [28]


def test_data_of_the_wrong_kind_are_the_packages_fault(tmp_path):
    install(
        tmp_path,
        "rollslip-wrong",
        BEARINGS.replace("BearingData(", "dict("),
        kind="bearing",
        name="wrong",
    )
    thing = "type('T', (), {'name': 'NAME', '__repr__': lambda self: 'T()'})()"
    install(
        tmp_path,
        "rollslip-odd",
        BEARINGS.split("    return")[0] + f"    return [{thing}]\n",
        kind="bearing",
    )
    said = [python(READ % ("1032930-70C", name), tmp_path)[1] for name in ("wrong", "odd")]
    assert said == [
        "changes: bearing.name: bearing 'wrong' of package rollslip-wrong 1.0: its bearings() offers None, but its "
        "entry point promises 'wrong'",
        "changes: bearing.name: bearing 'odd' of package rollslip-odd 1.0 cannot be used, T() is not a BearingData; "
        "repair or uninstall rollslip-odd",
    ]
