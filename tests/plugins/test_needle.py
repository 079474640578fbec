"""The catalogue of needle roller bearings: names, sizes, what is estimated, and the shaft that rollers run on."""

import pytest

from rollslip.bearing.assembly import assemble
from rollslip.catalogue.discovery import find
from rollslip.errors import SceneError, UnknownNameError
from rollslip.planning.new_scene import new
from rollslip.planning.plausibility import implausible
from rollslip.scene.changes import evolve
from rollslip_plugins.data.cylindrical import CATALOGUE as CYLINDRICAL
from rollslip_plugins.data.needle import CATALOGUE
from without_bands import run


def test_every_name_is_a_bearing_of_needles_three_to_eleven_diameters_long():
    assert len(CATALOGUE.names) > 150
    for name in CATALOGUE.names:
        b = CATALOGUE[name].bearing
        assert CATALOGUE.canonical_name(name) == name
        assert CYLINDRICAL.canonical_name(name) is None
        assert 3.0 < b.roller_length / b.roller_diameter < 11.0
        assert b.outer_raceway_diameter < b.catalogue.outside_diameter
        assert b.roller_length < b.catalogue.width
        assert (b.inner_raceway is None) == name.startswith("NKI")
        assert (b.outer_raceway is None) == (not name.startswith("HK"))


@pytest.mark.parametrize(
    ("written", "name"),
    [("NK 20/16", "NK20/16"), ("INA NK20/16-XL", "NK20/16"), ("NKI 25/20", "NKI25/20"), ("HK 2016", "HK2016"),
     ("SKF HK 0810", "HK0810")],
)  # fmt: skip
def test_designations_of_makers_are_understood(written, name):
    assert CATALOGUE.canonical_name(written) == name
    assert find("bearing", written).name == name
    assert CATALOGUE.cage(written).make == "steel"


@pytest.mark.parametrize("written", ["NK 20/17", "HK2016-2RS", "NKIS 30", "BK 1612", "RNA4905"])
def test_others_are_refused_by_what_they_are(written):
    with pytest.raises(UnknownNameError, match="this is a needle roller bearing"):
        find("bearing", written)


@pytest.mark.parametrize(
    ("name", "rating"), [("NK20/16", 25.5e3), ("NK40/20", 57e3), ("HK2016", 20.1e3)]
)
def test_static_ratings_that_shares_were_made_of_come_out(name, rating):
    """ISO 76: C0 = 44 (1 - D/d_m) Z L D, in N and mm."""
    b = CATALOGUE[name].bearing
    pitch = 0.5 * (b.inner_raceway_diameter + b.outer_raceway_diameter)
    found = (
        44e6 * (1.0 - b.roller_diameter / pitch) * b.rollers * b.roller_length * b.roller_diameter
    )
    assert found == pytest.approx(rating, rel=0.1)


def test_a_shaft_h5_leaves_a_machined_ring_its_clearance():
    # ISO 286: F6 of 20 mm is 20 to 33 um, h5 is -9 to 0
    b = CATALOGUE["NK20/16"].bearing
    assert (b.radial_clearance, b.mounting.initial_tolerance) == pytest.approx((31e-6, 22e-6))


def test_a_new_scene_runs_on_its_shaft_and_refuses_a_fit_there():
    scene = new("NK 20/16", speed="3000 rpm", load="500 N")
    assert scene.bearing.mounted.clearance == pytest.approx(
        31e-6 - 12e-6 * 5.0 * (20e-3 + 2 * 2.5e-3), abs=3e-8
    )
    assert implausible(scene) == []
    assert "# shaft_fit" in scene.text
    rough = {"surface.name": "ground", "surface.inner_raceway_roughness": "0.4 um",
             "bearing.inner_raceway.material.elastic_modulus": "120 GPa", "models.contact": "lundberg"}  # fmt: skip
    soft = assemble(evolve(scene, rough, si=True))
    hard = assemble(scene)
    assert soft.inner.conditions.modulus < 0.8 * hard.inner.conditions.modulus
    assert soft.inner.conditions.roughness > 1.5 * hard.inner.conditions.roughness
    assert soft.outer.conditions == hard.outer.conditions
    with pytest.raises(SceneError, match="no ring sits there"):
        evolve(scene, {"bearing.mounting.shaft_fit": "k5"})
    cup = new("HK 2016", speed="3000 rpm", load="500 N")
    assert cup.bearing.mounted.clearance < cup.bearing.mounting.initial_clearance


@pytest.mark.parametrize(
    ("law", "warned"), [("palmgren", True), ("iso16281", True), ("lundberg", False)]
)
def test_deflections_of_steel_are_told_where_the_shaft_is_none(law, warned):
    few = {"study.effective-friction.points": 5, "study.effective-friction.map_points": 0,
           "study.effective-friction.skidding_range": 0.0, "models.contact": law}  # fmt: skip
    steel = evolve(new("NK 20/16", speed="3000 rpm", load="500 N"), few, si=True)
    bronze = evolve(steel, {"bearing.inner_raceway.material.elastic_modulus": "110 GPa"})
    told = [str(run(scene, "effective-friction").attrs["warnings"]) for scene in (steel, bronze)]
    assert ["deflections are those of steel" in one for one in told] == [False, warned]


def test_a_cage_of_polyamide_is_read():
    for written, make in (
        ("NK20/16TN", "polyamide"),
        ("HK2016-TV-XL", "polyamide"),
        ("NK20/16-XL", "steel"),
    ):
        assert CATALOGUE.cage(written).make == make
