"""The catalogue of full complement bearings: names, sizes, what is estimated, and that they have no cage."""

import math

import pytest

from rollslip.bearing.assembly import assemble
from rollslip.bearing.cage import train_play
from rollslip.catalogue.discovery import find
from rollslip.datasets import BearingData
from rollslip.errors import SceneError, UnknownNameError
from rollslip.planning.new_scene import new
from rollslip.planning.plausibility import implausible
from rollslip.scene.changes import evolve
from rollslip_plugins.data.cylindrical import CATALOGUE as CAGED
from rollslip_plugins.data.full_complement import CATALOGUE


def test_every_name_is_a_bearing_with_a_full_complement():
    assert len(CATALOGUE.names) > 100
    for name in CATALOGUE.names:
        data = CATALOGUE[name]
        assert isinstance(data, BearingData)
        assert CATALOGUE.canonical_name(name) == name
        assert CAGED.canonical_name(name) is None
        b = data.bearing
        # a gap of 0.2 % of a diameter between all, along the orbit
        assert train_play(b) == pytest.approx(0.002 * b.roller_diameter * b.rollers, rel=0.05)
        assert b.outer_raceway_diameter < b.catalogue.outside_diameter
        assert b.inner_raceway_diameter > b.catalogue.bore
        assert b.roller_length < b.catalogue.width


@pytest.mark.parametrize(
    ("written", "name"),
    [
        ("NCF 2210 V", "NCF2210V"),
        ("SKF NCF 3010 CV/C3", "NCF3010V-C3"),
        ("SL182210", "NCF2210V"),
        ("INA SL183010-XL-C3", "NCF3010V-C3"),
        ("SL182922-A", "NCF2922V"),
        ("NJG 2310 VH", "NJG2310VH"),
        ("SL192310", "NJG2310VH"),
    ],
)
def test_designations_of_makers_are_understood(written, name):
    assert CATALOGUE.canonical_name(written) == name
    assert find("bearing", written).name == name
    assert CATALOGUE.cage(written).make == ""


@pytest.mark.parametrize(
    "written", ["NCF 2299 V", "SL045010", "NCF2210", "NNCF5010V", "SL182210-XYZ"]
)
def test_others_are_refused(written):
    assert CATALOGUE.canonical_name(written) is None
    with pytest.raises(UnknownNameError):
        find("bearing", written)


@pytest.mark.parametrize(("name", "rating"), [("NCF2922V", 204e3), ("NCF3010V", 93e3)])
def test_static_ratings_that_lengths_were_made_of_come_out(name, rating):
    """ISO 76: C0 = 44 (1 - D/d_m) Z L D, in N and mm."""
    b = CATALOGUE[name].bearing
    pitch = 0.5 * (b.inner_raceway_diameter + b.outer_raceway_diameter)
    found = (
        44e6 * (1.0 - b.roller_diameter / pitch) * b.rollers * b.roller_length * b.roller_diameter
    )
    assert math.isclose(found, rating, rel_tol=0.05)


def test_a_new_scene_of_one_has_no_cage_and_its_friction_may_be_set():
    scene = new("SL182210", speed="600 rpm", load="3 kN")
    assert assemble(scene).scene.models.neighbour_friction == 0.1
    assert scene.bearing.rollers == CATALOGUE["NCF2210V"].bearing.rollers
    assert implausible(scene) == []
    with pytest.raises(SceneError, match="is a full complement bearing, which has none"):
        new("NCF 2210 V", cage="brass")


def test_another_name_brings_a_cage_and_takes_it_away():
    caged = new("NU2210E")
    without = new("NCF2210V")
    assert (
        assemble(evolve(caged, {"bearing.name": "NCF2210V"})).scene.models.neighbour_friction == 0.1
    )
    assert (
        assemble(evolve(without, {"bearing.name": "NU2210E"})).scene.models.neighbour_friction
        is None
    )


def test_with_a_roller_missing_the_play_is_told():
    scene = new("SL182210", speed="600 rpm", load="3 kN")
    told = implausible(evolve(scene, {"bearing.rollers": 18}))
    assert any("room for more of them" in one for one in told)
