"""What a scene states is held against what is usual and what is possible."""

import math
from typing import ClassVar

import attrs
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.bearing.cage import Cage
from rollslip.catalogue.discovery import add, get_class
from rollslip.catalogue.registry import available, find
from rollslip.errors import SceneError
from rollslip.fields import FieldError, Span, parameter
from rollslip.geometry.bearing import Catalogue
from rollslip.lubricant.table import OilPoint, OilTable, OverTemperature
from rollslip.lubricant.temperature import Constant, Product
from rollslip.planning.plausibility import implausible, implausible_in_sweep
from rollslip.scene.reading import from_raw, parse_scene, shipped_scenes
from rollslip.scene.relations import RELATIONS
from rollslip.scene.values import Scene
from rollslip.structure import FrozenTable, types_of
from rollslip.studies.quantities import quantities
from rollslip.studies.study import study_class
from rollslip_plugins.traction.shear_thinning import Carreau
from rollslip_studies.dynamics.levels.planar import PlanarSettings
from scene_samples import line_of, scene_with

pytestmark = pytest.mark.quick

SCENE = load_scene("1032930-70C")

# What was meant, and what a scene says of it: slips that somebody has made.
SLIPS = [
    ("surface.roller_roughness", "0.16 mm", "0.16 mm is unusual", "did you mean '0.16 um'?"),
    (
        "operation.inner_speed",
        6371,
        "6371 rad/s = 60838.6 rpm is unusual",
        "did you mean '6371 rpm'?",
    ),
    ("operation.inner_speed", "60000 r/min", "60000 r/min is unusual", "57295.8 r/min is usual)"),
    ("operation.misalignment", "5 deg", "5 deg is unusual", "did you mean '5 arcmin'?"),
    ("operation.temperature", "343 degC", "343 degC is unusual", "did you mean '343 K'?"),
    ("operation.radial_load", "1 MN", "1 MN is 7.94 GPa of pressure", "at most 5 GPa is usual"),
    (
        "operation.inner_speed",
        "25000 rpm",
        "25000 rpm is 4.5e+06 mm/min of speed times",
        "at most 1.5e+06 mm/min is usual",
    ),
    (
        "bearing.material.elastic_modulus",
        "208 MPa",
        "208 MPa is unusual",
        "did you mean '208 GPa'?",
    ),
    ("bearing.material.density", 7.8, "7.8 kg/m3 is unusual", "did you mean '7.8 g/cm3'?"),
    (
        "bearing.radial_clearance",
        "1 mm",
        "1 mm is 6.67 % of the roller diameter",
        "did you mean '1 um'?",
    ),
    ("bearing.radial_clearance", "5 mm", "5 mm is unusual", "did you mean '5 um'?"),
    (
        "bearing.radial_clearance",
        "-0.2 mm",
        "-0.2 mm is -1.33 % of the roller",
        "-0.5 % to 4 % is usual",
    ),
    (
        "bearing.outer_raceway_diameter",
        "205 mm",
        "205 mm is 66.7 % of the roller diameter off",
        "-5 % to 5 %",
    ),
    ("bearing.rollers", 8, "8 is 21.2 % of the pitch circle", "30 % to 101 % is usual"),
    ("bearing.roller_length", "200 mm", "200 mm is 1.33e+03 % of the roller diameter", "is usual"),
    ("lubricant.viscosity", 5.2, "5.2 Pa s is unusual", "did you mean '5.2 mPa s'?"),
    ("lubricant.eyring_stress", "4 kPa", "4 kPa is unusual", "did you mean '4 MPa'?"),
    ("cage.mass", 400, "400 kg is unusual", "did you mean '400 g'?"),
    (
        "study.friction-curve.normal_force",
        ["300 N", "3 MN"],
        "3 MN is unusual",
        "did you mean '3 kN'?",
    ),
    ("accuracy.slices", 5000, "5000 is unusual", "(from 3 to 1001 is usual)"),
]
# The same of parameters of laws, with the key of each.
LAWS = [
    (
        "models.traction",
        {"model": "carreau", "critical_stress": "6.9 kPa"},
        "6.9 kPa is unusual",
        "'6.9 MPa'?",
    ),
    (
        "models.traction",
        {"model": "limiting-shear", "limit": 8},
        "8 is unusual",
        "(from 0.01 to 0.2 is usual)",
    ),
    (
        "models.traction.boundary",
        {"model": "kragelsky", "limit": 5},
        "limit: 5 is unusual",
        "did you mean '5 %'?",
    ),
    (
        "models.film",
        {"model": "inlet-correction", "oil_layer": "5 mm"},
        "5 mm is unusual",
        "did you mean '5 um'?",
    ),
    (
        "cage.drag",
        [{"model": "constant-torque", "size": "5 kN m"}],
        "5 kN m is unusual",
        "(from 0 to 1 kN m is usual)",
    ),
    (
        "cage.drag",
        [{"model": "petroff-land", "radius": "83 m", "ring": "inner"}],
        "83 m",
        "did you mean '83 mm'?",
    ),
]
#: Key of a law or its parameter, value, what the refusal says of it.
IMPOSSIBLE_LAWS = [
    (
        "models.traction",
        {"model": "carreau", "critical_stress": 0.5},
        "must be from 1 Pa to 1000 GPa, not 0.5 Pa",
    ),
    ("models.traction.exponent", 6e6, "must be from 0 to 1000, not 6e+06"),
    (
        "models.film",
        {"model": "inlet-correction", "layer_exponent": 15},
        "must be from 1 to 10, not 15",
    ),
    (
        "cage.drag",
        [{"model": "petroff-land", "width": 20}],
        "must be from 1 um to 10 m, not 20 m; did",
    ),
]


@pytest.mark.parametrize(("key", "value", "shown", "meant"), SLIPS, ids=lambda one: str(one)[:30])
def test_a_slip_is_told_with_its_value_and_what_was_meant(
    key: str, value: object, shown: str, meant: str
) -> None:
    [told] = [
        one
        for one in implausible(evolve(SCENE, {key: value}, si=True))
        if "runs preloaded" not in one
    ]
    place, _, sentence = told.partition(f"changes: {key}")
    assert place == ""
    assert shown in sentence
    assert meant in sentence


@pytest.mark.parametrize(("key", "value", "shown", "meant"), LAWS, ids=lambda one: str(one)[:60])
def test_a_slip_in_a_parameter_of_a_law_is_told_likewise(
    key: str, value: object, shown: str, meant: str
) -> None:
    [told] = implausible(evolve(SCENE, {key: value}, si=True))
    assert told.startswith(f"changes: {key}")
    assert shown in told
    assert meant in told


@pytest.mark.parametrize(("key", "value", "said"), IMPOSSIBLE_LAWS, ids=lambda one: str(one)[:60])
def test_an_impossible_parameter_of_a_law_is_refused(key: str, value: object, said: str) -> None:
    with pytest.raises(SceneError) as caught:
        _ = assemble(
            evolve(SCENE, {"cage.mass": "400 g", "cage.inertia": "33 kg cm2", key: value}, si=True)
        ).cage
    [problem] = caught.value.problems
    assert said in problem


#: Key, value, what the refusal says of it.
IMPOSSIBLE = [
    (
        "surface.roller_roughness",
        0.16,
        "must be from 0.0001 um to 1 mm, not 0.16 m = 160 mm; did you mean '0.16 um'?",
    ),
    (
        "bearing.material.elastic_modulus",
        208,
        "must be from 1 MPa to 2000 GPa, not 208 Pa; did you mean '208 GPa'?",
    ),
    (
        "bearing.radial_clearance",
        "14 mm",
        "14 mm is 93.3 % of the roller diameter, -5 % to 50 % is possible; did you mean '14 um'?",
    ),
    (
        "bearing.radial_clearance",
        "-1 mm",
        "-1 mm is -6.67 % of the roller diameter, -5 % to 50 % is possible; did you mean '-1 um'?",
    ),
    (
        "operation.temperature",
        70,
        "must be from -150 degC to 1000 degC, not 70 K = -203.15 degC; did you mean '70 degC'?",
    ),
    (
        "operation.radial_load",
        "1e9 N",
        "1e+09 N = 1e+06 kN is 251 GPa of pressure in the most loaded contact, after Hertz, at most 20 GPa is possible",
    ),
]


@pytest.mark.parametrize(("key", "value", "said"), IMPOSSIBLE, ids=lambda one: str(one)[:30])
def test_what_is_impossible_is_one_error_that_says_what_was_meant(
    key: str, value: object, said: str
) -> None:
    with pytest.raises(SceneError) as caught:
        evolve(SCENE, {key: value}, si=True)
    assert caught.value.problems == [f"changes: {key}: {said}"]


def test_both_name_file_and_line() -> None:
    unusual = parse_scene(scene_with(inner_speed="inner_speed = 6371"), "scene.toml")
    [told] = implausible(unusual)
    assert told.startswith(
        f"scene.toml:{line_of('inner_speed')}: operation.inner_speed: 6371 rad/s"
    )
    with pytest.raises(
        SceneError, match=rf"scene.toml:{line_of('radial_load')}: operation.radial_load: 1e\+09 N"
    ):
        parse_scene(scene_with(radial_load="radial_load = 1e9"), "scene.toml")


def test_values_of_tables_lists_and_models_are_judged_where_they_stand() -> None:
    over = {"temperature": ["40 degC", "400 degC"], "value": ["12 1/MPa", "8 1/GPa"]}
    found = implausible(evolve(SCENE, {"lubricant.pressure_viscosity": over}, si=True))
    assert [told.partition(" is unusual")[0] for told in found] == [
        "changes: lubricant.pressure_viscosity.temperature[1]: 400 degC",
        "changes: lubricant.pressure_viscosity.value[0]: 12 1/MPa",
    ]


@pytest.mark.parametrize("name", shipped_scenes())
def test_shipped_scenes_are_usual(name: str) -> None:
    assert implausible(load_scene(name)) == []


def test_a_load_below_the_weight_of_the_rollers_is_told() -> None:
    mass = 28 * 7800 * math.pi / 4 * 0.015**3
    for load, many in ((0.9 * 9.81 * mass, 1), (1.1 * 9.81 * mass, 0), (0.0, 0)):
        told = " ".join(implausible(evolve(SCENE, {"operation.radial_load": load}, si=True)))
        left = "of the weight of the rollers, which is left out without operation.gravity_direction, at least 100 %"
        assert told.count(f"{left} is usual") == many
    heavy = {"operation.radial_load": 0.5 * 9.81 * mass, "operation.gravity_direction": 0.0}
    assert "weight of the rollers" not in " ".join(implausible(evolve(SCENE, heavy, si=True)))


#: Classes of the tables of a scene.
TABLES = [
    Scene,
    OilTable,
    OilPoint,
    OverTemperature,
    Cage,
    PlanarSettings,
    *map(study_class, available("study")),
]


def fields_with_a_unit(cls: type, prefix: str = "") -> "list[tuple[str, attrs.Attribute[object]]]":
    found = []
    for attribute in attrs.fields(cls):
        key = attribute.metadata.get("key", attribute.name)
        kind = types_of(cls)[attribute.name]
        if key is not None and attrs.has(kind) and kind is not FrozenTable:
            found += fields_with_a_unit(kind, f"{prefix}{key}.")
        elif key is not None and attribute.metadata.get("unit") not in (None, "1"):
            found.append((f"{prefix}{key}", attribute))
    return found


FIELDS = [
    pytest.param(a, id=f"{cls.__name__}.{key}")
    for cls in TABLES
    for key, a in fields_with_a_unit(cls)
]
#: Their values are those of another key, which is judged.
ELSEWHERE = {"SteadySlip.radial_load", "SteadySlip.inner_speed", "SteadySlip.temperature"}


@pytest.mark.parametrize("attribute", [one for one in FIELDS if one.id not in ELSEWHERE])
def test_every_quantity_says_what_is_usual_and_what_is_possible(
    attribute: "attrs.Attribute[object]",
) -> None:
    usual: Span = attribute.metadata["usual"]
    possible: Span = attribute.metadata["possible"]
    assert possible[0] <= usual[0] < usual[1] <= possible[1]
    if isinstance(attribute.default, float):
        assert usual[0] <= attribute.default <= usual[1]


LAW_KINDS = ("contact", "film", "traction", "drag", "integrator", "engine")


def laws_of_the_box() -> "list[tuple[str, type]]":
    offered = [(kind, name) for kind in LAW_KINDS for name in available(kind)]
    return [
        (f"{kind} {name}", get_class(kind, name))
        for kind, name in offered
        if find(kind, name).package == "rollslip"
    ]


PARAMETERS = [
    pytest.param(a, id=f"{law}: {a.name}")
    for law, cls in laws_of_the_box()
    for a in attrs.fields(cls)
    if a.metadata.get("key", a.name) is not None and a.metadata.get("unit") is not None
]


@pytest.mark.parametrize("attribute", PARAMETERS)
def test_every_parameter_of_the_box_says_what_is_usual_and_what_is_possible(
    attribute: "attrs.Attribute[float]",
) -> None:
    usual: Span = attribute.metadata["usual"]
    possible: Span = attribute.metadata["possible"]
    assert possible[0] <= usual[0] < usual[1] <= possible[1]
    if attribute.default is not None and not math.isnan(attribute.default):
        assert usual[0] <= attribute.default <= usual[1]
    assert attribute.validator is not None
    for value in usual:
        if not (value == 0 == possible[0]):  # which some laws have no value at
            attribute.validator(None, attribute, value)
    for value in {possible[0] - abs(possible[0]) / 2 - 1e-9, 1.5 * possible[1]} - {math.inf}:
        with pytest.raises(FieldError):
            attribute.validator(None, attribute, value)


def test_a_law_of_a_stranger_without_ranges_goes_on_working(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("rollslip.catalogue.discovery._registered", {})

    @attrs.frozen(kw_only=True)
    class Strange(Carreau):
        name: ClassVar[str] = "strange"
        anything: float = parameter(default=1.0, unit="1", doc="whatever it is")

    add("traction", Strange)
    scene = evolve(SCENE, {"models.traction": {"model": "strange", "anything": -1e30}}, si=True)
    assert implausible(scene) == []
    assert assemble(scene).traction == Strange(anything=-1e30)


def test_an_oil_of_a_package_with_a_wrong_unit_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rollslip.catalogue.discovery._registered", {})
    sound = get_class("lubricant", "iso-vg-68")
    thick = attrs.evolve(
        sound, name="thick", viscosity=Product(sound.viscosity, Constant(1000.0)), synonyms=()
    )
    add("lubricant", thick)
    scene = evolve(SCENE, {"lubricant": {"name": "thick"}}, si=True)
    (message,) = (text for text in implausible(scene) if "of 'thick'" in text)
    assert message.startswith("changes: lubricant.name: viscosity of 'thick': at 100 degC 7.")
    assert "is unusual (from 0.5 mPa s to 3 Pa s is usual)" in message
    own = {"name": "thick", "viscosity": 0.06, "thermoviscosity": 0.04}
    messages = implausible(evolve(SCENE, {"lubricant": own}, si=True))
    assert not any("of 'thick'" in text for text in messages)


# Values that a key takes one after the other -------------------------------------------------------------------------

# key, values, and what is said of them; how a sweep reads and tells them is tests/campaigns/test_sweep.py's
ALONG = [
    (
        "surface.roller_roughness",
        ["0.1 um", "0.16 mm", "0.2 mm"],
        ["surface.roller_roughness, 2 of 3 values, the first: 0.16 mm is unusual (from 5e-06 mm to 0.003 mm is usual); "
         "did you mean '0.16 um'?"],
    ),
    (
        "bearing.roller_diameter",
        ["15 mm", "14.9 mm", "14 mm"],
        ["bearing.outer_raceway_diameter, at 1 of 3 values of bearing.roller_diameter: 195 mm is 14.3 % of the roller "
         "diameter off what inner raceway, rollers and clearance take, -5 % to 5 % is usual"],
    ),
    (
        "models.traction",
        ["muraki", {"model": "carreau", "critical_stress": "6.9 kPa"}],
        ["models.traction.critical_stress, 1 of 2 values: 6.9 kPa is unusual (from 10 kPa to 100000 kPa is usual); did "
         "you mean '6.9 MPa'?"],
    ),
    (
        "operation.radial_load",
        ["1 kN", "1 MN"],
        ["operation.radial_load, 1 of 2 values: 1 MN is 7.94 GPa of pressure in the most loaded contact, after Hertz, "
         "at most 5 GPa is usual; did you mean '1 kN'?"],
    ),
    ("accuracy.slices", [5000], ["accuracy.slices: 5000 is unusual (from 3 to 1001 is usual)"]),
    ("operation.temperature", ["40 degC", "90 degC"], []),
]  # fmt: skip


@pytest.mark.parametrize(("key", "values", "said"), ALONG, ids=lambda one: str(one)[:30])
def test_what_is_unusual_of_many_values_is_said_once(
    key: str, values: list[object], said: list[str]
) -> None:
    assembly = assemble(SCENE)
    assert implausible_in_sweep(SCENE, quantities(assembly, {})[key], values) == said


def test_what_a_scene_says_by_itself_is_not_said_again_of_its_values() -> None:
    few = evolve(SCENE, {"bearing.rollers": 8})
    assert len(implausible(few)) == 1
    known = quantities(assemble(few), {})
    assert implausible_in_sweep(few, known["bearing.roller_length"], ["15 mm", "16 mm"]) == []
    [told] = implausible_in_sweep(few, known["bearing.rollers"], [8, 28])
    assert told.startswith("bearing.rollers, 1 of 2 values: 8 is 21.2 % of the pitch circle")


def test_relations_blame_a_key_of_the_scene_and_say_what_they_rest_on() -> None:
    listed = evolve(
        SCENE,
        {
            "bearing.catalogue.minimum_load_factor": 0.1,
            "lubrication.oil_level": "5 mm",
            "bearing.ribs.height": "1 mm",
            "operation.axial_load": "100 N",
        },
        si=True,
    )
    for relation in RELATIONS:
        assert math.isfinite(relation.evaluate(listed))
        assert relation.field in attrs.fields_dict(type(getattr(SCENE, relation.table)))
        assert relation.source


@given(
    diameter=st.floats(3e-3, 0.09),
    slender=st.floats(0.05, 0.28),
    fill=st.floats(0.6, 0.95),
    length=st.floats(0.8, 2.5),
    clearance=st.floats(-0.002, 0.02),
    load=st.floats(1e-3, 0.5),
    speed=st.floats(1e4, 1e6),
    temperature=st.floats(-20.0, 150.0),
    roughness=st.floats(0.01, 0.6),
)
def test_bearings_like_those_of_catalogues_are_usual(
    diameter: float,
    slender: float,
    fill: float,
    length: float,
    clearance: float,
    load: float,
    speed: float,
    temperature: float,
    roughness: float,
) -> None:
    """Loads up to half the static rating 44 (1 - D/d_m) Z l D [N, mm] of ISO 76, speeds up to n d_m = 1e6 mm/min.

    No catalogue allows the smallest bearings more than some 40,000 rpm, whatever n d_m says.
    """
    pitch = diameter / slender
    rollers = max(int(fill * math.pi / math.asin(slender)), 7)
    rating = 44e6 * (1 - slender) * rollers * length * diameter**2
    oil = {"name": "mil-prf-7808"}
    bearing = {
        "rollers": min(rollers, math.floor(math.pi / math.asin(slender))),
        "roller_diameter": diameter,
        "roller_length": length * diameter,
        "inner_raceway_diameter": pitch - diameter,
        "outer_raceway_diameter": pitch + diameter + clearance * diameter / 2,
        "radial_clearance": clearance * diameter,
    }
    operation = {
        "inner_speed": f"{min(speed / (1e3 * pitch), 5e4)} rpm",
        "radial_load": load * rating,
        "temperature": f"{temperature} degC",
        "misalignment": "3 arcmin",
    }
    surface = dict.fromkeys(("inner_raceway_roughness", "roller_roughness"), f"{roughness} um")
    raw = {"bearing": bearing, "lubricant": oil, "operation": operation, "surface": surface}
    said = implausible(from_raw(raw, "catalogue"))
    assert all("runs preloaded" in one for one in said)
    assert len(said) <= (clearance < 0.0)


def test_what_values_amount_to_is_that_by_hand():
    def amounts(words):
        return next(one for one in RELATIONS if words in one.meaning).evaluate(scene)

    made = evolve(load_scene("1032930-70C"), {"operation.outer_speed": "-500 rpm"})
    given = Catalogue(minimum_load_factor=0.2, reference_speed=800.0)
    scene = attrs.evolve(made, bearing=attrs.evolve(made.bearing, catalogue=given))
    b = scene.bearing
    o = scene.operation
    assert amounts("surface speed of the inner") == pytest.approx(
        o.inner_speed * b.inner_raceway_diameter / 2
    )
    load = 5.0 * o.radial_load / (b.rollers * b.roller_length)
    half_width = 2.0 * load / (math.pi * amounts("after Hertz"))
    assert amounts("half width") == pytest.approx(
        scene.surface.inner_raceway_roughness / half_width
    )
    pitch = (b.inner_raceway_diameter + b.outer_raceway_diameter) / 2
    faster = (o.inner_speed - o.outer_speed) / 800.0
    least = 1e3 * 0.2 * (6.0 + 4.0 * faster) * (pitch / 0.1) ** 2
    assert amounts("SKF's catalogue minimum load") == pytest.approx(o.radial_load / least)


def test_short_rollers_are_usual_and_a_number_without_a_unit_is_doubted_before_one_with_it():
    made = load_scene("1032930-70C")
    short = evolve(made, {"bearing.roller_length": 0.5 * made.bearing.roller_diameter}, si=True)
    assert not any("bearing.roller_length" in one for one in implausible(short))
    for speed, doubted in (
        (600.0, True),
        ("5730 rpm", False),
        (300.0, False),
    ):  # n d_m is 1e6 and 5e5 mm/min
        operation = {**made.raw["operation"], "inner_speed": speed}
        told = implausible(from_raw({**made.raw, "operation": operation}, "s.toml"))
        assert any("(n d_m)" in one for one in told) == doubted
