"""Tapered bearings in scenes: raceways by the pitch diameter, and what is refused in words."""

import math

import pytest

import rollslip
from rollslip.errors import SceneError
from rollslip.geometry.axial import ContactAngles, raceway_diameters
from rollslip.scene.reading import from_raw, parse_scene
from rollslip.scene.values import Scene
from rollslip.structure import resolved

SCENE = """
[bearing]
rollers = 16
roller_diameter = "17 mm"
roller_length = "20.7 mm"
contact_angle = "15.64 deg"
pitch_diameter = "108.5 mm"
[lubricant]
name = "fva-3"
[operation]
inner_speed = "2000 rpm"
radial_load = "6.5 kN"
axial_load = "6 kN"
temperature = "50 degC"
"""


def scene(text: str = SCENE, **changes: object) -> Scene:
    """The scene of a 32216, with changes."""
    read = parse_scene(text, "tapered.toml")
    return rollslip.evolve(
        read, {name.replace("__", "."): value for name, value in changes.items()}
    )


def test_scene_takes_the_pitch_diameter_or_the_raceways() -> None:
    by_pitch = scene().bearing
    assert by_pitch.pitch_diameter == pytest.approx(0.1085, rel=1e-14)
    angles = ContactAngles.with_common_apex(math.radians(15.64), 0.017 / 0.1085)
    inner, outer = raceway_diameters(0.1085, 0.017, angles)
    stated = f"inner_raceway_diameter = {inner!r}\nouter_raceway_diameter = {outer!r}"
    by_raceways = scene(SCENE.replace('pitch_diameter = "108.5 mm"', stated)).bearing
    assert by_raceways.angles == by_pitch.angles
    assert by_pitch.radial_clearance == by_raceways.radial_clearance == 0.0
    larger = scene(bearing__pitch_diameter="110 mm").bearing
    assert larger.pitch_diameter == pytest.approx(0.110, rel=1e-14)


def test_resolved_scene_gives_the_same_bearing() -> None:
    assert from_raw(resolved(scene()), "again").bearing == scene().bearing


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"operation__axial_load": "1 kN"}, "1.926 kN. An opposed bearing gives what lacks"),
        ({"operation__misalignment": "1 mrad"}, "operation.misalignment: the tilt of rings is not"),
        ({"bearing__radial_clearance": "20 um"}, "radial_clearance: an axial load takes up"),
        ({"bearing__mounting.shaft_fit": "k5"}, "mounting: an axial load takes up"),
        ({"bearing__roller_half_angle": "9 deg"}, "roller_half_angle: must be less than half"),
        (
            {
                "bearing__inner_raceway_diameter": "90 mm",
                "bearing__outer_raceway_diameter": "125 mm",
            },
            "do not agree with 108.5 mm",
        ),
        (
            {"bearing__ribs": {"height": "2 mm", "opening_angle": "0.5 deg"}},
            "bearing.ribs.opening_angle: the ends of tapered rollers touch",
        ),
        ({"models__outer_ring": "thin-ring"}, "a flexible ring is not modelled in a tapered"),
    ],
)
def test_what_a_tapered_bearing_does_not_have_is_refused(
    changes: dict[str, str], message: str
) -> None:
    with pytest.raises(SceneError, match=message.replace(".", "\\.")):
        scene(**changes)


def test_pitch_diameter_needs_a_contact_angle() -> None:
    text = SCENE.replace('contact_angle = "15.64 deg"\n', "").replace('axial_load = "6 kN"\n', "")
    text = text.replace(
        "[lubricant]",
        'inner_raceway_diameter = "91 mm"\nouter_raceway_diameter = "126 mm"\n[lubricant]',
    )
    with pytest.raises(SceneError, match=r"bearing\.contact_angle: missing, but pitch_diameter"):
        scene(text)


def test_motions_in_time_refuse_a_tapered_bearing() -> None:
    with pytest.raises(SceneError, match="know no tapered bearing"):
        rollslip.run(scene(accuracy__tolerance=0.05), "dynamics")
