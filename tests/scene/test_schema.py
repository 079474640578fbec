"""The schema of scenes."""

import pytest

import rollslip
from rollslip.scene.schema import schema

pytestmark = pytest.mark.quick


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
        "from 50 GPa to 500 GPa",
        "from 1 MPa to 2000 GPa",
        "quantity",
    )
    assert rows["models.traction"].default == "lambda-blend"
    assert rows["surface.roller_roughness"].default == "0.1 um"
    assert {
        "models.traction.*",
        "lubricant.*",
        "cage.*",
        "study.*",
        "accuracy.slices",
        "title",
    } <= rows.keys()
    assert all(row.doc and not row.doc.endswith(".") for row in schema())
    assert not {"source", "text", "raw", "origins"} & rows.keys()


def test_a_scene_and_a_plan_are_told_in_one_line():
    scene = rollslip.load_scene("1032930-30C")
    assert repr(scene) == "Scene '1032930-30C': 28 rollers on 165 mm, 3.415 kN, 6371 rpm, 30 degC"
    assert repr(rollslip.plan(scene, "friction-curve")).startswith(
        "Plan of '1032930-30C': friction-curve; "
    )
