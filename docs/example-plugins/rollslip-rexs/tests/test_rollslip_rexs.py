"""A REXS file written by hand is read to the number, what it lacks is told, and a scene goes there and back."""

import contextlib
import math
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from random import Random

import pytest
import xarray as xr
from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.errors import PluginError, SceneError
from rollslip.scene import Scene, scene_hash
from rollslip.scene.interchange import read_foreign, write_foreign
from rollslip.studies.quantities import quantities
from rollslip.studies.tables import FurtherColumn, KeyTable, read_table

#: As gearbox programs write it: one load case more than is used, a shaft that nobody needs.
FILE = """<?xml version="1.0" encoding="UTF-8" standalone="no"?>
<model applicationId="Gear Program" applicationVersion="1" date="2026-01-01T00:00:00+00:00" version="1.6">
  <relations>
    <relation id="1" type="assembly"><ref id="7" role="assembly"/><ref id="3" role="part"/></relation>
    <relation id="2" type="ordered_assembly" order="1"><ref id="3" role="assembly"/><ref id="4" role="part"/></relation>
    <relation id="3" type="ordered_assembly" order="1"><ref id="4" role="assembly"/><ref id="5" role="part"/></relation>
    <relation id="4" type="reference"><ref id="3" role="origin"/><ref id="6" role="referenced"/></relation>
  </relations>
  <components>
    <component id="3" name="NU 210" type="rolling_bearing_with_detailed_geometry">
      <attribute id="bearing_type" unit="none">radial_roller_bearing</attribute>
      <attribute id="inner_diameter" unit="mm">50.0</attribute>
      <attribute id="outer_diameter" unit="mm">90.0</attribute>
      <attribute id="width" unit="mm">20.0</attribute>
      <attribute id="operating_radial_bearing_clearance" unit="mum">25.0</attribute>
      <attribute id="temperature_lubricant" unit="C">60.0</attribute>
      <attribute id="support_vector" unit="mm"><array><c>1.0</c><c>0.0</c><c>0.0</c></array></attribute>
      <attribute id="speed_inner_ring" unit="1 / min">100.0</attribute>
    </component>
    <component id="4" name="" type="rolling_bearing_row">
      <attribute id="number_of_rolling_elements" unit="none">16</attribute>
    </component>
    <component id="5" name="" type="rolling_element">
      <attribute id="diameter_of_rolling_element" unit="mm">11.0</attribute>
      <attribute id="length_of_rolling_element" unit="mm">12.0</attribute>
    </component>
    <component id="6" name="oil" type="lubricant">
      <attribute id="viscosity_at_40_degree_celsius" unit="mm^2 / s">64.0</attribute>
      <attribute id="viscosity_at_100_degree_celsius" unit="mm^2 / s">8.5</attribute>
      <attribute id="density_at_15_degree_celsius" unit="kg / dm^3">0.875</attribute>
    </component>
    <component id="7" name="Shaft" type="shaft"/>
  </components>
  <load_spectrum id="1">
    <load_case id="1"><component id="3" type="rolling_bearing_with_detailed_geometry">
      <attribute id="speed_inner_ring" unit="1 / min">1500.0</attribute>
      <attribute id="radial_force_in_v" unit="kN">3.0</attribute>
      <attribute id="radial_force_in_w" unit="kN">-4.0</attribute>
    </component></load_case>
    <load_case id="2"/>
  </load_spectrum>
</model>
"""


def put(folder: Path, text: str) -> tuple[Scene, tuple[str, ...]]:
    (folder / "a.rexs").write_text(text, encoding="utf-8")
    return read_foreign(folder / "a.rexs")


def test_a_file_is_read_to_the_number(tmp_path: Path) -> None:
    scene, notes = put(tmp_path, FILE)
    bearing = scene.bearing
    operation = scene.operation
    assert scene.title == "NU 210 of Gear Program"
    assert (bearing.rollers, bearing.roller_diameter, bearing.roller_length) == (16, 0.011, 0.012)
    # (50 + 90) / 2 = 70 mm, less and more the roller
    assert (bearing.inner_raceway_diameter, bearing.outer_raceway_diameter) == pytest.approx((0.059, 0.081), rel=1e-14)
    assert bearing.radial_clearance == pytest.approx(25e-6, rel=1e-14)
    assert operation.inner_speed == pytest.approx(1500 * 2 * math.pi / 60, rel=1e-14)
    assert operation.radial_load == pytest.approx(5000.0, rel=1e-14)
    assert operation.temperature == 333.15
    oil = assemble(scene).lubricant
    for celsius, nu in ((40, 64e-6), (100, 8.5e-6)):
        assert oil.at(celsius + 273.15).viscosity == pytest.approx(nu * 875.0, rel=1e-9)
    assert len(set(notes)) == len(notes)


def test_what_is_missing_and_not_used_is_told_attribute_by_attribute(tmp_path: Path) -> None:
    _, notes = put(tmp_path, FILE)
    bearing = "rolling_bearing_with_detailed_geometry 3"
    for told in (
        "rolling_bearing_row, reference_diameter_rolling_bearing: missing; the mean of bore and outer diameter",
        f"{bearing}, speed_outer_ring: missing; a ring at rest is taken",
        "material, elastic_modulus: missing; that of bearing steel is taken",
        f"{bearing}, width: not used",
        f"{bearing}, support_vector: not used",
        "lubricant 6: pressure viscosity, conductivity, Eyring stress and shear modulus are those of iso-vg-68",
        "load_spectrum: the scene is load case 1 of 2; 'rollslip cases' takes all",
        "shaft: 1 not used",
        "surface: REXS has no roughness",
    ):
        assert sum(note.startswith(told) for note in notes) == 1, told
    pitch = '"reference_diameter_rolling_bearing" unit="mm">70.5</attribute><attribute id='
    given = FILE.replace('"number_of_rolling_elements"', f'{pitch}"number_of_rolling_elements"')
    scene, notes = put(tmp_path, given)
    assert scene.bearing.inner_raceway_diameter == pytest.approx(0.0595, rel=1e-14)
    assert f"{bearing}, inner_diameter: not used" in notes


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ("<model", "<scene", "no XML"),
        ('version="1.6"', 'version="3.0"', "version '3.0' is not read, only 1.0 to 2.0"),
        ("<model", "<!DOCTYPE model><model", "has a DOCTYPE"),
        ("radial_roller_bearing", "radial_grooved_ball_bearing", "there are: 3 'NU 210' (radial_grooved_ball_bearing)"),
        ('id="number_of_rolling_elements"', 'id="count"', "rolling_bearing_row 4, number_of_rolling_elements: missing"),
        (">16<", ">16.5<", "number_of_rolling_elements: 16.5 is no whole number"),
        (">11.0<", ">nan<", "rolling_element 5, diameter_of_rolling_element: 'nan' is not a finite number"),
        (">0.875<", ">1e308<", "density_at_15_degree_celsius: '1e308' is not a finite number"),  # g of a kilogram
        ('unit="mm">11.0', 'unit="furlong">11.0', "unit 'furlong' is not read; there are: mm, mum"),
        ('id="radial_force_in_w"', 'id="force"', "radial_force_in_w: missing, but needed for operation.radial_load"),
        ('role="assembly"/><ref id="5"', 'role="assembly"/><ref id="9"', "no rolling_element belongs to the bearing"),
        ('<ref id="3" role="origin"/>', "", None),  # the one oil of a file is taken
        (">64.0<", ">-64.0<", "-64 is no viscosity"),
        ('<component id="4" name=""', '<component id="3" name=""', "its id is missing or that of another"),
        (
            '<load_case id="1"><component id="3"',
            '<load_case id="1"><component id="8"',
            "load case 1 is of component '8'",
        ),
        ('id="width" unit="mm">20.0', 'id="number_of_bearing_rows" unit="none">2', "has 2 rows of rollers"),
    ],
)
def test_a_bad_file_is_refused_in_words(before: str, after: str, said: str | None, tmp_path: Path) -> None:
    assert before in FILE
    if said is None:
        assert put(tmp_path, FILE.replace(before, after))
        return
    with pytest.raises(SceneError, match=re.escape(said)) as error:
        put(tmp_path, FILE.replace(before, after, 1))
    assert all(problem.startswith(str(tmp_path / "a.rexs")) for problem in error.value.problems)


def test_any_file_is_read_or_refused_in_words(tmp_path: Path) -> None:
    """Numbers, lines, ids and units of a file changed, by fixed seeds."""
    numbers = ["nan", "inf", "1e400", "1e308", "1e-320", "-1", "0", "", "1,5", "16.5", "9" * 400]
    units = ["mm", "N", "kN", "C", "1 / min", "", "none", "mum", "furlong", "mm^2 / s"]
    ids = ["3", "4", "5", "6", "7", "", "-1", "bearing_type", "inner_diameter"]
    read = 0
    for seed in range(200):
        text = FILE
        random = Random(seed)
        for _ in range(random.choice((1, 2, 4))):
            before, after, choices = random.choice(
                [
                    (r">[-\d.]+<", ">{}<", numbers),
                    (r'unit="[^"]*"', 'unit="{}"', units),
                    (r' id="[^"]*"', ' id="{}"', ids),
                ]
            )
            at = random.choice([*re.finditer(before, text)])
            text = text[: at.start()] + after.format(random.choice(choices)) + text[at.end() :]
            lines = text.split("\n")
            lines.insert(random.randrange(len(lines)), lines.pop(random.randrange(2, len(lines))))
            text = "\n".join(lines) if random.random() < 0.3 else text
        with contextlib.suppress(SceneError, PluginError):
            put(tmp_path, text)
            read += 1
    assert 20 < read < 180


def test_what_is_no_rexs_at_all_is_refused(tmp_path: Path) -> None:
    for text, said in (('{"model": 1}', "no XML"), ("<html/>", "its root is 'html'"), ("", "no XML")):
        with pytest.raises(SceneError, match=said):
            put(tmp_path, text)


def steady(scene: Scene, **changes: object) -> xr.Dataset:
    """A result as study steady-slip gives it: two slips, of which the second lasts."""
    loss = xr.DataArray([[1.0, 4.0], [2.0, 8.0]], dims=("source", "steady"))
    made = xr.Dataset(
        {
            "stable": ("steady", [False, True]),
            "cage_speed": ("steady", [1.0, 10.0 * math.pi]),
            "friction_torque": ("steady", [0.1, 0.25]),
            "loss": loss,
            "status": "found",
        },
        attrs={"study": "steady-slip", "scene_hash": scene_hash(scene)},
    )
    return made.assign(changes) if changes else made


def test_a_scene_goes_there_and_back_with_its_results(tmp_path: Path) -> None:
    scene = evolve(load_scene("1032930-50C"), {"bearing.profile": "none", "bearing.radial_clearance": "17 um"})
    notes = write_foreign(scene, tmp_path / "b.rexs", steady(scene))
    assert "cage: has no place in REXS" in notes
    root = ElementTree.parse(tmp_path / "b.rexs").getroot()
    assert len(root.findall("components/component[@type='rolling_element']")) == scene.bearing.rollers
    written = {one.get("id"): (one.get("unit"), one.text) for one in root.iter("attribute")}
    # 10 pi rad/s = 300 rpm; 4 + 8 W
    assert written["speed_rolling_element_set"] == ("1 / min", "300")
    assert written["total_frictional_torque"] == ("N m", "0.25")
    assert written["total_frictional_power_loss"] == ("W", "12")
    back, told = read_foreign(tmp_path / "b.rexs")
    assert any("speed_rolling_element_set: a result, computed anew" in note for note in told)
    for one, other in ((scene.bearing, back.bearing), (scene.operation, back.operation)):
        for name in ("rollers", "roller_diameter", "roller_length", "inner_raceway_diameter", "outer_raceway_diameter",
                     "radial_clearance", "inner_speed", "outer_speed", "radial_load", "temperature"):  # fmt: skip
            if hasattr(one, name):
                assert getattr(other, name) == pytest.approx(getattr(one, name), rel=1e-12, abs=1e-18), name
    assert back.bearing.material == scene.bearing.material


def test_a_result_without_a_slip_that_lasts_is_not_written(tmp_path: Path) -> None:
    scene = load_scene("1032930-50C")
    none = steady(scene, stable=("steady", [False, False]), status="no steady slip")
    notes = write_foreign(scene, tmp_path / "b.rexs", none)
    assert "the result has no slip that lasts (no steady slip): nothing of it is written" in notes
    assert "speed_rolling_element_set" not in (tmp_path / "b.rexs").read_text(encoding="utf-8")
    lost = steady(scene, friction_torque=("steady", [0.1, math.nan]))
    assert "total_frictional_torque: the result has no value; not written" in write_foreign(
        scene, tmp_path / "c.rexs", lost
    )
    other = lost.assign_attrs(study="friction-curve")
    assert any(
        "only that of steady-slip has a place" in note for note in write_foreign(scene, tmp_path / "d.rexs", other)
    )


#: As most files have it: the designation of a bearing, and nothing of what is inside.
NAMED = (
    FILE.replace("rolling_bearing_with_detailed_geometry", "rolling_bearing_with_catalog_geometry")
    .replace(
        '<attribute id="bearing_type" unit="none">radial_roller_bearing</attribute>',
        '<attribute id="catalogue_designation" unit="none">NU 2210 ECP/C3</attribute>',
    )
    .replace('<attribute id="number_of_rolling_elements" unit="none">16</attribute>', "")
    .replace('<attribute id="diameter_of_rolling_element" unit="mm">11.0</attribute>', "")
    .replace('<attribute id="length_of_rolling_element" unit="mm">12.0</attribute>', "")
    .replace('<attribute id="operating_radial_bearing_clearance" unit="mum">25.0</attribute>', "")
)


def test_a_designation_is_looked_up(tmp_path: Path) -> None:
    scene, notes = put(tmp_path, NAMED)
    stated = ("inner_speed", "outer_speed", "radial_load", "temperature")
    operation = {name: getattr(scene.operation, name) for name in stated}
    same = evolve(load_scene("1032930-50C"), {"bearing": {"name": "NU 2210 ECP/C3"}, "operation": operation}, si=True)
    assert scene.bearing == same.bearing
    assert scene.bearing.mounted is not None
    assert scene.bearing.mounting.initial_clearance == pytest.approx(65e-6)  # C3 over 40 to 50 mm: 50 to 80 um
    assert 20e-6 < scene.bearing.radial_clearance < 65e-6  # the seats take from it
    assert scene.cage is not None
    assert (scene.cage["make"], scene.cage["guidance"]) == ("polyamide", "roller")
    (told,) = (note for note in notes if "catalogue_designation" in note)
    assert "gives rollers, roller_diameter, roller_length, radial_clearance, raceways where the file does not" in told
    assert assemble(scene).cage.make == "polyamide"


def test_what_a_file_says_beside_a_designation_counts(tmp_path: Path) -> None:
    row = '<attribute id="number_of_rolling_elements" unit="none">16</attribute>'
    element = '<attribute id="diameter_of_rolling_element" unit="mm">11.5</attribute>'
    text = NAMED.replace('type="rolling_bearing_row">', f'type="rolling_bearing_row">{row}')
    text = text.replace('type="rolling_element">', f'type="rolling_element">{element}')
    scene, _ = put(tmp_path, text)
    other = evolve(load_scene("1032930-50C"), {"bearing": {"name": "NU 2210"}}).bearing
    assert (scene.bearing.rollers, scene.bearing.roller_diameter) == (16, 0.0115)
    pitch = other.inner_raceway_diameter + other.outer_raceway_diameter
    assert scene.bearing.inner_raceway_diameter + scene.bearing.outer_raceway_diameter == pytest.approx(pitch)
    assert scene.bearing.outer_raceway_diameter - scene.bearing.inner_raceway_diameter == pytest.approx(0.023)
    assert scene.bearing.roller_length == other.roller_length


@pytest.mark.parametrize(
    ("designation", "said"),
    [
        ("6210-2RS", "this is a deep groove ball bearing"),
        ("NU 999", "no bearing is called 'NU 999'"),
        ("NU 2232 ECM", "of another bearing"),
    ],
)
def test_a_designation_of_another_bearing_is_refused(designation: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=re.escape(said)):
        put(tmp_path, NAMED.replace("NU 2210 ECP/C3", designation))


# Load cases ---------------------------------------------------------------------------------------------------------

CASE = """
    <load_case id="{id}">
      <component id="7" type="shaft"><attribute id="load_duration_fraction" unit="%">{share}</attribute></component>
      <component id="3" type="rolling_bearing_with_detailed_geometry">
        <attribute id="speed_inner_ring" unit="1 / min">{speed}</attribute>
        <attribute id="radial_force_in_v" unit="kN">{load}</attribute>
        <attribute id="radial_force_in_w" unit="kN">0.0</attribute>
      </component>
    </load_case>"""


def spectrum(*cases: tuple[int, float, float, float]) -> str:
    """The file with a load spectrum: a main model, and in each load case by the ids of components what varies alone.

    So https://spec.rexs.info/1.6/en/root-load-spectrum.html has it. ``load_duration_fraction`` in per cent and
    ``load_duration`` in h are in the list of attributes of the versions 1.0 to 1.6; example files of the standard have
    the former in components of the load cases.
    """
    text = "".join(CASE.format(id=id, share=share, speed=speed, load=load) for id, share, speed, load in cases)
    before, rest = FILE.split('<load_spectrum id="1">')
    return f'{before}<load_spectrum id="1">{text}\n  </load_spectrum>{rest.partition("</load_spectrum>")[2]}'


THREE = spectrum((1, 20.0, 1500.0, 4.0), (2, 70.0, 900.0, 8.0), (5, 10.0, -300.0, 0.5))


def cases(folder: Path, text: str) -> KeyTable:
    (folder / "a.rexs").write_text(text, encoding="utf-8")
    known = quantities(assemble(load_scene("1032930-50C")), {})
    return read_table(folder / "a.rexs", known, {"share": FurtherColumn("1", 0.0), "time": FurtherColumn("s", 0.0)})


def test_load_cases_are_a_table_of_numbers(tmp_path: Path) -> None:
    found = cases(tmp_path, THREE).values
    assert found["share"] == pytest.approx([0.2, 0.7, 0.1], rel=1e-14)
    rpm = 2.0 * math.pi / 60.0
    assert found["operation.inner_speed"] == pytest.approx([1500 * rpm, 900 * rpm, -300 * rpm], rel=1e-14)
    assert found["operation.radial_load"] == pytest.approx([4000.0, 8000.0, 500.0], rel=1e-14)
    assert found["operation.temperature"] == pytest.approx([333.15] * 3, rel=1e-14)  # the 60 degC of the main model
    assert "operation.outer_speed" not in found
    scene, notes = put(tmp_path, THREE)
    assert scene.operation.radial_load == 4000.0
    assert "load_spectrum: the scene is load case 1 of 3; 'rollslip cases' takes all" in notes


def test_hours_and_temperatures_of_the_casing_count_too(tmp_path: Path) -> None:
    text = THREE.replace("load_duration_fraction", "load_duration").replace('unit="%"', 'unit="h"')
    text = text.replace('<attribute id="temperature_lubricant" unit="C">60.0</attribute>', "")
    text = text.replace('id="7" name="Shaft" type="shaft"', 'id="7" name="Case" type="gear_casing"')
    casing = '<attribute id="temperature_lubricant" unit="C">72</attribute>'
    text = text.replace('type="shaft">', f'type="gear_casing">{casing}')
    outer = '<attribute id="speed_outer_ring" unit="1 / min">60.0</attribute>'
    text = text.replace(">8.0<", f'>8.0</attribute>{outer}<attribute id="width" unit="mm">1<')
    found = cases(tmp_path, text).values
    assert found["time"] == pytest.approx([20 * 3600.0, 70 * 3600.0, 10 * 3600.0], rel=1e-14)
    assert found["operation.temperature"] == pytest.approx([345.15] * 3, rel=1e-14)
    assert found["operation.outer_speed"] == pytest.approx([0.0, 2.0 * math.pi, 0.0], rel=1e-14)
    _, notes = put(tmp_path, text)
    assert any("temperature_lubricant: missing; that of gear_casing 7 is taken" in note for note in notes)


OF_BEARING = "rolling_bearing_with_detailed_geometry 3, "


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ("load_case", "case", "has no table of load cases; give one as a file .csv or .xlsx"),
        ('load_case id="5"', 'load_case id="2"', "load case 2: its id is missing or that of another"),
        ('load_case id="5"', "load_case", "load case without id: its id is missing or that of another"),
        ('"kN">8.0', '"kip">8.0', f"load case 2: {OF_BEARING}radial_force_in_v: unit 'kip' is not read"),
        ('"kN">0.5', '"kN">half', f"load case 5: {OF_BEARING}radial_force_in_v: 'half' is not a finite number"),
        (
            'radial_force_in_v" unit="kN">8.0',
            'force" unit="kN">8.0',
            f"load case 2: {OF_BEARING}radial_force_in_v: mis",
        ),
        ('load_duration_fraction" unit="%">70', 'time" unit="%">70', "load case 2: has no load_duration_fraction, whi"),
        ('unit="%">70.0', 'unit="%">-70.0', "load case 2: share: '-70.0' is below zero"),
        ('"1 / min">900', '"rad / s">900', "load case 2: inner_speed is in rad/s, and in rpm in load case 1; use one"),
        (
            '"1 / min">900.0<',
            '"1 / min">900.0</attribute><attribute id="speed_inner_ring" unit="1 / min">800<',
            f"load case 2: {OF_BEARING}speed_inner_ring: '900.0 and 800' is not a finite number",
        ),
        (
            '<component id="3" type="rolling_bearing_with_detailed_geometry">',
            '<component id="7" type="shaft">',
            "load case 1: component 7 stands there twice",
        ),
    ],
)
def test_bad_load_cases_are_refused_in_words(before: str, after: str, message: str, tmp_path: Path) -> None:
    assert before in THREE
    with pytest.raises(SceneError, match=re.escape(message)) as error:
        cases(tmp_path, THREE.replace(before, after))
    assert all(problem.startswith(str(tmp_path / "a.rexs")) for problem in error.value.problems)
