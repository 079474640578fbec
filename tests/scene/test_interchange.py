"""Scenes go to files of parameters and back without a change, and what is wrong in such a file is said."""

import json

import attrs
import pytest
import xarray as xr

from rollslip import evolve, load_scene
from rollslip.cli.main import main
from rollslip.errors import SceneError
from rollslip.scene import formats, scene_hash
from rollslip.scene.formats import Read, SceneFormat, Written
from rollslip.scene.interchange import (
    from_parameters,
    parameter_schema,
    read_foreign,
    to_parameters,
    write_foreign,
)
from rollslip.scene.schema import schema

pytestmark = pytest.mark.quick

#: What a scene is changed by before it is exchanged: a long decimal, an unusual unit, tables, texts like numbers.
CHANGES = {
    "as shipped": {},
    "odd numbers": {
        "bearing.roller_diameter": 0.1 * 0.15000000000000002,
        "operation.temperature": "301.7 degF",
    },
    "a table of a profile": {
        "bearing.profile": {"shape": "table", "position": ["-7 mm", "7 mm"], "drop": [1e-5, 1e-5]}
    },
    "texts like numbers": {
        "title": "70 degC",
        "lubricant.eyring_stress": "5.30 MPa",
        "lubricant.shear_modulus": "3e8 Pa",
    },
    "scatter": {
        "uncertainty.lubricant.viscosity_factor": {"distribution": "uniform", "scatter": 0.1}
    },
}


@pytest.mark.parametrize("name", ["1032930-30C", "1032930-50C", "1032930-70C"])
@pytest.mark.parametrize("changes", CHANGES.values(), ids=CHANGES)
def test_there_and_back_is_the_same_scene(name, changes):
    scene = evolve(load_scene(name), changes, si=True)
    back = from_parameters(json.loads(json.dumps(to_parameters(scene), allow_nan=False)))
    assert back == scene
    assert scene_hash(back) == scene_hash(scene)
    assert to_parameters(back) == to_parameters(scene)


@pytest.mark.parametrize(
    "rings", [{}, {"operation.inner_ring_temperature": "75 degC"}], ids=["as mounted", "warm ring"]
)
def test_a_clearance_that_follows_from_its_mounting_still_does(rings):
    scene = evolve(load_scene("gearbox"), rings, si=True)
    assert scene.bearing.mounted is not None
    fitted = {"bearing.mounting.shaft_fit": "m6"}
    assert evolve(from_parameters(to_parameters(scene)), fitted, si=True) == evolve(
        scene, fitted, si=True
    )
    stated = to_parameters(scene)
    stated["parameters"]["bearing"]["radial_clearance"]["value"] *= 2.0
    assert from_parameters(stated).bearing.radial_clearance == 2.0 * scene.bearing.radial_clearance


def test_every_number_of_a_key_with_a_unit_has_it():
    told = to_parameters(load_scene("1032930-70C"))["parameters"]
    for row in schema():
        at = told
        for part in row.key.split("."):
            at = at.get(part, {}) if isinstance(at, dict) else {}
        if row.unit and at != {}:
            assert set(at) == {"value", "unit"}, row.key
            assert at["unit"] == row.unit


def test_other_units_are_read():
    document = to_parameters(load_scene("1032930-70C"))
    document["parameters"]["bearing"]["roller_diameter"] = {"value": 15, "unit": "mm"}
    document["parameters"]["operation"]["inner_speed"] = {"value": 6371, "unit": "rpm"}
    assert from_parameters(document).bearing.roller_diameter == 0.015


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda d: d.update(version=2), "version: 2 is not read, only 1"),
        (lambda d: d.update(format="bpx"), "no file of parameters"),
        (lambda d: d.update(colour="red"), "'colour': unknown key"),
        (
            lambda d: d["parameters"]["bearing"].update(rollers=None),
            "bearing.rollers: has no value",
        ),
        (
            lambda d: d["parameters"]["bearing"].update(
                roller_diameter={"value": "15", "unit": "mm"}
            ),
            "a finite number, or a list",
        ),
        (  # as JSON makes of 1e999
            lambda d: d["parameters"]["lubricant"].update(
                density={"value": float("inf"), "unit": "kg/m3"}
            ),
            "lubricant.density: a finite number, or a list",
        ),
        (
            lambda d: d["parameters"]["bearing"].update(rollers=float("inf")),
            "bearing.rollers: inf is not a finite number",
        ),
        (
            lambda d: d["parameters"]["bearing"].update(
                roller_diameter={"value": 15, "unit": "kg"}
            ),
            "roller_diameter",
        ),
        (lambda d: d["parameters"]["bearing"].update(rolers=28), "did you mean 'rollers'"),
        (
            lambda d: d["parameters"]["bearing"].pop("rollers"),
            "bearing.rollers: missing, but required",
        ),
    ],
)
def test_what_is_wrong_is_said(change, said):
    document = json.loads(json.dumps(to_parameters(load_scene("1032930-70C"))))
    change(document)
    with pytest.raises(SceneError, match=said.replace("(", r"\(")):
        from_parameters(document)


@pytest.mark.parametrize("text", ["{", '{"format": NaN}', "[" * 100_000])
def test_what_is_no_json_is_refused(text, tmp_path):
    (tmp_path / "p.json").write_text(text, encoding="utf-8")
    with pytest.raises(SceneError, match="not valid JSON"):
        read_foreign(tmp_path / "p.json")


@attrs.frozen
class Lines(SceneFormat):
    """A format of a stranger: the parameters, and a line of what was calculated."""

    endings = (".lines",)

    def read(self, content, source):
        return Read(json.loads(content.partition(b"\n")[0]), ("line 2: not used",))

    def write(self, document, result):
        return Written(
            f"{json.dumps(document)}\n{result.attrs['study']}", ("accuracy: has no place",)
        )


def test_a_format_of_a_package_carries_a_scene_and_a_result_there_and_back(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.setattr(formats, "available", lambda kind: {"lines": None})
    monkeypatch.setattr(formats, "get_class", lambda kind, name: Lines(name))
    scene = load_scene("1032930-70C")
    file = tmp_path / "b.LINES"
    result = xr.Dataset(attrs={"study": "steady-slip", "scene_hash": scene_hash(scene)})
    assert write_foreign(scene, file, result) == ("accuracy: has no place",)
    assert file.read_text(encoding="utf-8").endswith("\nsteady-slip")
    back, notes = read_foreign(file)
    assert back == scene
    assert notes == ("line 2: not used",)
    with pytest.raises(SystemExit) as leave:
        main(["info", str(file)])
    assert leave.value.code == 0
    assert "note: line 2: not used\n" in capsys.readouterr().err
    other = result.assign_attrs(scene_hash="0" * 64)
    with pytest.raises(
        SceneError, match=r"the result is of another scene, 000000000000, not of .*; run this one"
    ):
        write_foreign(scene, file, other)
    with pytest.raises(
        SceneError, match=r"p\.igs: no installed format has this ending; there are: \.lines$"
    ):
        write_foreign(scene, tmp_path / "p.igs")


def test_what_json_cannot_hold_is_told(tmp_path):
    scene = load_scene("1032930-70C")
    [note] = write_foreign(
        scene, tmp_path / "b.json", xr.Dataset(attrs={"scene_hash": scene_hash(scene)})
    )
    assert note == "the result: this format holds parameters alone; not written"
    assert read_foreign(tmp_path / "b.json") == (scene, ())


def test_the_schema_has_every_key_with_its_unit():
    made = parameter_schema()["properties"]["parameters"]["properties"]
    diameter = made["bearing"]["properties"]["roller_diameter"]
    assert diameter["properties"]["unit"]["examples"] == ["m"]
    assert "rollers" in made["bearing"]["required"]
    for row in schema():
        at = {"properties": made}
        for part in row.key.split("."):
            assert part == "*" or part in at["properties"], row.key
            at = at["properties"].get(part, {}) if part != "*" else {}


def test_a_command_reads_what_another_wrote(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    written = ["export", "1032930-70C", "--out", "b.json"]
    for arguments in (
        written,
        [*written, "--overwrite"],
        ["info", "b.json"],
        ["export", "--schema"],
    ):
        with pytest.raises(SystemExit) as leave:
            main(arguments)
        assert leave.value.code == 0
    assert "radial clearance" in capsys.readouterr().out
    for arguments in (
        written,
        ["export"],
        ["export", "b.json", "--result", "r.nc"],
        ["export", "b.json", "--schema"],
    ):
        with pytest.raises(SystemExit) as leave:
            main(arguments)
        assert leave.value.code == 2
