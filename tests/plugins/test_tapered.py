"""The catalogue of tapered roller bearings: names, printed dimensions and ratings, and what is estimated."""

import csv
import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from rollslip.bearing.assembly import assemble
from rollslip.catalogue.discovery import find
from rollslip.errors import UnknownNameError
from rollslip.planning.new_scene import new
from rollslip.planning.plausibility import implausible
from rollslip.scene.changes import evolve
from rollslip.scene.relations import required_axial_load
from rollslip_plugins.data.cylindrical import CATALOGUE as CYLINDRICAL
from rollslip_plugins.data.tapered import CATALOGUE

#: First and last contact angle of the classes of ISO 355 [deg].
ANGLE_CLASSES = {
    "2": (10.0, 13 + 52 / 60),
    "3": (13 + 52 / 60, 15 + 59 / 60),
    "4": (15 + 59 / 60, 18 + 55 / 60),
    "7": (27.0, 30.0),
}


def printed() -> Iterator[dict[str, str]]:
    path = Path(__file__).parents[2] / "tools" / "references" / "tapered_ratings.csv"
    with path.open(newline="", encoding="utf-8") as file:
        yield from csv.DictReader(line for line in file if not line.startswith("#"))


def test_every_name_is_a_tapered_bearing() -> None:
    assert len(CATALOGUE.names) > 150
    for name in CATALOGUE.names:
        b = CATALOGUE[name].bearing
        assert CATALOGUE.canonical_name(name) == name
        assert CYLINDRICAL.canonical_name(name) is None
        assert 10 <= b.rollers <= 24
        half = 0.5 * b.roller_length
        # raceways at the ends of the rollers are between the bore and the outside diameter
        assert b.inner_raceway_diameter - 2 * half * math.sin(b.angles.inner) > b.catalogue.bore
        outside = b.outer_raceway_diameter + 2 * half * math.sin(b.angles.outer)
        assert outside < b.catalogue.outside_diameter
        assert b.roller_length * math.cos(b.angles.outer) < b.catalogue.width


def test_dimensions_are_those_that_are_printed() -> None:
    for row in printed():
        if (name := CATALOGUE.canonical_name(row["designation"])) is None:
            continue  # 30302, a bore that is not in the catalogue
        size = CATALOGUE._sizes[CATALOGUE._read(name)]
        assert size[:5] == tuple(
            float(row[key]) for key in ("d [mm]", "D [mm]", "T [mm]", "B [mm]", "C [mm]")
        )
        first, last = ANGLE_CLASSES[row["ISO 355 series"][0]]
        # e is printed with two digits
        assert first - 0.2 < math.degrees(CATALOGUE[name].bearing.contact_angle) < last + 0.2


def test_static_ratings_that_lengths_were_read_off_come_out() -> None:
    ratios = [
        CATALOGUE[name].bearing.static_rating / float(row["static [N]"])
        for row in printed()
        if (name := CATALOGUE.canonical_name(row["designation"]))
    ]
    assert len(ratios) == 27
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.01)
    assert np.std(ratios) < 0.05
    assert 0.9 < min(ratios) < max(ratios) < 1.16


@pytest.mark.parametrize(
    ("written", "name"),
    [
        ("32216", "32216"),
        ("SKF 32216 J2/Q", "32216"),
        ("FAG 32216-A", "32216"),
        ("HR 32216 J", "32216"),
        ("4T-32216", "32216"),
        ("32010 X/Q", "32010X"),
        ("30303", "30303"),
        ("33108", "33108"),
    ],
)
def test_designations_of_makers_are_understood(written: str, name: str) -> None:
    assert CATALOGUE.canonical_name(written) == name
    assert find("bearing", written).name == name
    assert CATALOGUE.cage(written).make == "steel"


@pytest.mark.parametrize(
    ("written", "what"),
    [
        ("32216 B", "of a size or a series"),
        ("LM11949/LM11910", "of inch sizes"),
        ("32916", "of a size or a series"),
    ],
)
def test_other_tapered_bearings_are_refused(written: str, what: str) -> None:
    with pytest.raises(UnknownNameError, match=f"this is a tapered roller bearing {what}"):
        find("bearing", written)


def test_new_scene_of_a_tapered_bearing_runs_and_is_plausible() -> None:
    scene = new("32216", speed="1500 rpm", load="5 kN")
    half_loaded = 1.26 * 5000.0 * math.tan(scene.bearing.contact_angle)
    centrifugal = required_axial_load(evolve(scene, {"operation.radial_load": "0 N"}))
    assert scene.operation.axial_load == pytest.approx(half_loaded + centrifugal, rel=0.01)
    assert assemble(scene).load_distribution().inner_force.max() > 0.0
    assert not [message for message in implausible(scene) if "bearing." in message]
    assert "axial_load" in scene.text
    assert "clearance" not in scene.text.replace("pocket_clearance", "")


def test_what_is_written_takes_the_place_of_named_data() -> None:
    scene = new("32216", speed="1500 rpm", load="5 kN")
    changed = evolve(scene, {"bearing.roller_diameter": "16 mm", "bearing.contact_angle": "14 deg"})
    b = changed.bearing
    assert b.pitch_diameter == pytest.approx(0.1089, abs=1e-9)
    across = 0.016 * math.cos(b.angles.middle)
    assert b.outer_raceway_diameter - b.inner_raceway_diameter == pytest.approx(2 * across)
