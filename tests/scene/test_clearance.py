"""The clearance in operation: elasticity solved another way, closed forms, the sum by hand, rules of what is stated."""

import math

import attrs
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rollslip import evolve, get_model, load_scene, plan, run
from rollslip.bearing.assembly import assemble
from rollslip.errors import SceneError
from rollslip.fields import FieldError
from rollslip.geometry.bearing import Bearing, Catalogue, Mounting
from rollslip.geometry.surfaces import Material, Raceway
from rollslip.planning.plausibility import implausible
from rollslip.scene.clearance import (
    centrifugal_growth,
    operating_clearance,
    transmitted_fraction,
    usual_fit,
)
from rollslip.scene.reading import from_raw, parse_scene
from rollslip.structure import resolved, scene_hash
from rollslip_plugins.data.cylindrical import CATALOGUE
from rollslip_studies.variation.scatter import with_scatter

STEEL = Material()
PLAIN = Bearing(
    rollers=28,
    roller_diameter=0.015,
    roller_length=0.015,
    inner_raceway_diameter=0.165,
    outer_raceway_diameter=0.195,
)


def scene(bearing="name = 'NU2216'", speed="1500 rpm", more=""):
    return parse_scene(
        f"[bearing]\n{bearing}\n[lubricant]\nname = 'ISO VG 68'\n[operation]\n"
        f"inner_speed = '{speed}'\nradial_load = '5 kN'\ntemperature = '70 degC'\n{more}",
        "scene.toml",
    )


def mounted(speeds=(0.0, 0.0), temperatures=None, bore=None, **mounting):
    """Return the clearance of the plain bearing with a mounting in which nothing acts that is not given."""
    ring = attrs.evolve(PLAIN, catalogue=Catalogue(bore=bore))
    nothing = {
        "shaft_interference": 0.0, "housing_interference": 0.0, "temperature_difference": 0.0, "smoothing": 1.0,
    }  # fmt: skip
    given = {
        key: value
        for key, value in nothing.items()
        if key.replace("interference", "fit") not in mounting
    }
    ring = attrs.evolve(ring, mounting=Mounting(**given | mounting))
    return operating_clearance(ring, speeds, temperatures, rigid=False).clearance


# Elasticity ----------------------------------------------------------------------------------------------------------


def solved(bodies, interference, speed=0.0):
    """Widening of all four edges [m], of diameters, of two bodies pressed together, and the pressure [Pa].

    u = A r + B/r - (1 - nu^2) rho w^2 r^3/(8 E) in each; edges are free, the pressed ones carry the same stress and
    differ by half the interference. Bodies are (material, inside, outside), the inner one first.
    """
    matrix = np.zeros((4, 4))
    right = np.zeros(4)

    def of(k, r):
        material = bodies[k][0]
        E = material.elastic_modulus
        nu = material.poisson_ratio
        force = material.density * speed**2
        moved = -(1 - nu**2) * force * r**3 / (8 * E)
        stress = -(3 + nu) * force * r**2 / 8
        inverse = 1.0 / r if r > 0.0 else 0.0
        return (r, inverse), moved, (E / (1 - nu), -E / (1 + nu) * inverse**2), stress

    (_, a, b), (_, c, d) = ((m, i / 2, o / 2) for m, i, o in bodies)
    assert b == pytest.approx(c)
    if a == 0.0:
        matrix[0, 1] = 1.0  # nothing is singular in a solid shaft
    else:
        _, _, matrix[0, :2], body = of(0, a)
        right[0] = -body
    _, _, matrix[1, 2:], body = of(1, d)
    right[1] = -body
    u, moved, pressed, body = of(0, b)
    u_ring, moved_ring, pressed_ring, body_ring = of(1, b)
    matrix[2] = [*pressed, *np.negative(pressed_ring)]
    right[2] = body_ring - body
    matrix[3] = [*np.negative(u), *u_ring]
    right[3] = interference / 2 + moved - moved_ring
    scale = np.array([1.0, 1e-3, 1.0, 1e-3])
    rows = np.abs(matrix * scale).max(axis=1)
    found = scale * np.linalg.solve(matrix * scale / rows[:, None], right / rows)
    edges = []
    for k, r in ((0, a), (0, b), (1, c), (1, d)):
        u, moved, _, _ = of(k, r)
        edges.append(2.0 * (float(np.dot(found[2 * k : 2 * k + 2], u)) + moved))
    return edges, -(float(np.dot(found[:2], pressed)) + body)


ALUMINIUM = Material(elastic_modulus=70e9, poisson_ratio=0.33, density=2700.0)


@pytest.mark.parametrize("shaft_bore", [0.0, 0.06, 0.12])
@pytest.mark.parametrize("shaft", [STEEL, ALUMINIUM])
def test_a_shaft_widens_the_raceway_as_elasticity_says(shaft_bore, shaft):
    edges, pressure = solved([(shaft, shaft_bore, 0.15), (STEEL, 0.15, 0.165)], 5e-5)
    assert pressure > 0.0
    assert 5e-5 * transmitted_fraction(STEEL, 0.165, 0.15, shaft_bore, shaft) == pytest.approx(
        edges[3], rel=1e-9
    )


@pytest.mark.parametrize("around", [0.22, 0.3, 50.0])
@pytest.mark.parametrize("housing", [STEEL, ALUMINIUM])
def test_a_housing_narrows_the_raceway_as_elasticity_says(around, housing):
    edges, pressure = solved([(STEEL, 0.195, 0.21), (housing, 0.21, around)], 5e-5)
    assert pressure > 0.0
    assert 5e-5 * transmitted_fraction(STEEL, 0.195, 0.21, around, housing) == pytest.approx(
        -edges[0], rel=1e-9
    )
    if around > 1.0:
        assert 5e-5 * transmitted_fraction(STEEL, 0.195, 0.21, math.inf, housing) == pytest.approx(
            -edges[0], rel=1e-4
        )


@pytest.mark.parametrize("rpm", [0.0, 6000.0])
def test_a_hollow_shaft_of_aluminium_presses_and_grows_as_elasticity_says(rpm):
    edges, pressure = solved(
        [(ALUMINIUM, 0.06, 0.15), (STEEL, 0.15, 0.165)], 8e-5, rpm * math.pi / 30
    )
    found = mounted(
        (rpm * math.pi / 30, 0.0),
        shaft_interference=8e-5,
        bore=0.15,
        shaft_bore=0.06,
        shaft_material=ALUMINIUM,
    )
    assert pressure > 0.0
    assert found == pytest.approx(-edges[3], rel=1e-6)


@pytest.mark.parametrize("kelvin", [-60.0, 0.0, 30.0, 60.0])
def test_a_housing_of_aluminium_lets_go_of_its_ring_as_it_warms(kelvin):
    # fitted at 20 degC by 60 um on 210 mm; aluminium 23.8e-6, rings 12e-6 per K
    left = 6e-5 - (23.8e-6 - 12e-6) * 0.21 * kelvin
    found = mounted(
        temperatures=(293.15 + kelvin,) * 3, housing_interference=6e-5, housing_outside_diameter=0.25,
        housing_material=ALUMINIUM, housing_expansion=23.8e-6,
    )  # fmt: skip
    if left > 0.0:
        edges, _ = solved([(STEEL, 0.195, 0.21), (ALUMINIUM, 0.21, 0.25)], left)
        assert found == pytest.approx(edges[0], rel=1e-6)
    else:
        assert found == 0.0


def test_a_scene_has_its_housing_at_its_temperature():
    table = "name = 'NU2216'\n[bearing.mounting]\n{}\ngrowth = false\nhousing_expansion = '23.8e-6 1/K'\n"
    table += "[bearing.mounting.housing_material]\nelastic_modulus = '70 GPa'"
    cold, warm = (
        evolve(
            scene(table.format("housing_interference = '50 um'")),
            {"operation.temperature": at},
            si=True,
        ).bearing
        for at in ("20 degC", "120 degC")
    )
    alone = (
        0.8
        * 5e-5
        * transmitted_fraction(
            STEEL, cold.outer_raceway_diameter, 0.14, math.inf, Material(elastic_modulus=70e9)
        )
    )
    assert warm.radial_clearance - cold.radial_clearance == pytest.approx(alone, abs=2e-12)
    cold, warm = (
        evolve(
            scene(table.format("housing_fit = 'P7'")), {"operation.temperature": at}, si=True
        ).bearing.mounted
        for at in ("20 degC", "120 degC")
    )
    assert warm.deviation < cold.deviation  # a seat that is loose scatters nothing


def test_thin_rings_share_an_interference_by_their_walls():
    # a ring of 1 um on a tube of 3 um, both of 100 mm: each yields by what the other one's wall is of both
    ring = 1e-6
    tube = 3e-6
    found = transmitted_fraction(STEEL, 0.1 + 2 * ring, 0.1, 0.1 - 2 * tube)
    assert found == pytest.approx(tube / (ring + tube), rel=1e-4)
    # a thin ring follows a solid shaft, and a thin one in a thick housing yields all of it
    assert transmitted_fraction(STEEL, 0.1 + 2 * ring, 0.1, 0.0) == pytest.approx(1.0, rel=1e-4)
    assert transmitted_fraction(STEEL, 0.1, 0.1 + 2 * ring, math.inf) == pytest.approx(
        1.0, rel=1e-4
    )


def test_a_thin_hoop_and_a_solid_disc_grow_as_the_books_say():
    force = STEEL.density * 1000.0**2 / STEEL.elastic_modulus
    assert centrifugal_growth(STEEL, 1000.0, 0.2 - 1e-7, 0.2) == pytest.approx(
        (2 * force * 0.1**3,) * 2, rel=1e-5
    )
    assert centrifugal_growth(STEEL, 1000.0, 0.0, 0.2)[1] == pytest.approx(
        2 * 0.7 * force * 0.1**3 / 4, rel=1e-12
    )


@pytest.mark.parametrize("rpm", [0.0, 3000.0, 15000.0])
@pytest.mark.parametrize("interference", [2e-5, 8e-5])
@pytest.mark.parametrize("shaft_bore", [0.0, 0.1])
def test_a_fit_and_speed_change_the_clearance_as_elasticity_says(rpm, interference, shaft_bore):
    edges, pressure = solved(
        [(STEEL, shaft_bore, 0.15), (STEEL, 0.15, 0.165)], interference, rpm * math.pi / 30
    )
    found = mounted(
        (rpm * math.pi / 30, 0.0), shaft_interference=interference, bore=0.15, shaft_bore=shaft_bore
    )
    if pressure > 0.0:
        assert found == pytest.approx(-edges[3], rel=1e-6)  # a clearance is rounded to picometres
    else:  # the ring is loose: it widens as an annulus on nothing, and by no fit
        assert rpm == 15000.0
        assert found == mounted((rpm * math.pi / 30, 0.0), bore=0.15, shaft_bore=shaft_bore)


def test_a_turning_outer_ring_widens_and_a_ring_in_play_is_not_pressed():
    assert mounted((0.0, -900.0)) == pytest.approx(
        centrifugal_growth(STEEL, 900.0, 0.195, 0.21)[0], abs=1e-12
    )
    assert mounted((0.0, -900.0), growth=False) == 0.0
    assert mounted(shaft_interference=-1e-5, housing_interference=-2e-5) == 0.0
    assert mounted(housing_interference=4e-5) == pytest.approx(-4e-5 * 0.195 / 0.21, abs=1e-12)


@pytest.mark.parametrize("housing", [STEEL, ALUMINIUM])
@pytest.mark.parametrize("around", [0.22, 0.4])
def test_rollers_widen_a_rigid_outer_ring_as_they_do_one_that_yields(housing, around):
    sizes = {
        "roller_diameter": 15,
        "roller_length": 15,
        "inner_raceway_diameter": 165,
        "outer_raceway_diameter": 195,
    }
    plain = scene(
        "\n".join(["rollers = 28", *(f"{key} = '{size} mm'" for key, size in sizes.items())]),
        "10000 rpm",
    )
    given = {
        "catalogue": {"bore": "150 mm", "outside_diameter": "210 mm", "width": "28 mm"},
        "mounting": {"initial_clearance": "200 um", "housing_interference": "50 um",
                     "housing_outside_diameter": f"{around} m",
                     "housing_material": {"elastic_modulus": f"{housing.elastic_modulus} Pa",
                                          "poisson_ratio": housing.poisson_ratio}},
    }  # fmt: skip
    changes = {f"bearing.{key}": value for key, value in given.items()}
    rigid = evolve(
        plain,
        changes | {"operation.outer_speed": "-900 rpm", "operation.radial_load": "0 N"},
        si=True,
    )
    hoop = evolve(rigid, {"models.outer_ring": {"model": "annulus", "harmonics": 0}})
    wide = 2.0 * assemble(hoop).load_distribution(1).deflection[0, 0]
    assert rigid.bearing.radial_clearance - hoop.bearing.radial_clearance == pytest.approx(
        wide, abs=2e-12
    )
    assert 5e-7 < wide < 1e-5
    named = evolve(rigid, {"models.outer_ring": "rigid"})
    assert named.bearing.mounted == rigid.bearing.mounted


def test_a_ring_in_play_widens_freely_until_its_seat_holds_it():
    def wide(play, **more):
        b = attrs.evolve(
            PLAIN,
            mounting=Mounting(housing_interference=-play, housing_outside_diameter=0.4, **more),
        )
        one, other = (
            operating_clearance(b, (1000.0, 0.0), rigid=rigid).clearance for rigid in (True, False)
        )
        return one - other

    # Lame, a bare ring of 27 mm (D): rollers of the whole orbit, each of 20.7 g at 0.09 m and 458 rad/s
    a = 0.195
    s = 0.21
    E = STEEL.elastic_modulus
    nu = STEEL.poisson_ratio
    cage = 1000.0 * 0.165 / 0.36
    force = 28 * STEEL.density * math.pi / 4 * 0.015**3 * 0.09 * cage**2
    pressure = force / (math.pi * a * 1.8 * 0.015)
    free = pressure * a / E * ((s**2 + a**2) / (s**2 - a**2) + nu)
    seat = pressure * s / E * 2 * a**2 / (s**2 - a**2)
    assert wide(2e-5) == pytest.approx(free, abs=2e-12)
    assert wide(0.0) < 0.4 * free
    assert wide(0.5 * seat) == pytest.approx(0.5 * (free + wide(0.0)), abs=4e-12)
    assert wide(2e-5, growth=False) == 0.0


def test_a_housing_of_a_ring_that_the_clearance_does_not_know_is_told():
    one = evolve(
        scene(),
        {
            "models.outer_ring": {"model": "annulus", "outside": "200 mm"},
            "models.inner_ring": "annulus",
        },
    )
    told = [text for text in implausible(one) if "is not as in bearing.mounting" in text]
    assert len(told) == 1
    assert "models.outer_ring.outside" in told[0]
    of_both = {"model": "annulus", "bore": "40 mm", "modulus": "70 GPa"}
    hollow = evolve(scene(), {"models.inner_ring": of_both, "bearing.mounting.shaft_bore": "40 mm"})
    told = [text for text in implausible(hollow) if "is not as in bearing.mounting" in text]
    assert ["models.inner_ring.modulus" in text for text in told] == [True]
    known = evolve(one, {"bearing.mounting.housing_outside_diameter": "200 mm"})
    assert implausible(known) == []
    assert implausible(evolve(one, {"bearing.radial_clearance": "20 um"})) == []


# The sum -------------------------------------------------------------------------------------------------------------


def test_on_a_shaft_without_a_ring_no_fit_is_felt_and_the_shaft_grows_as_a_disc():
    bare = attrs.evolve(PLAIN, inner_raceway=Raceway(without_ring=True), mounting=Mounting(
        initial_clearance=5e-5, housing_interference=0.0, temperature_difference=0.0))  # fmt: skip
    assert operating_clearance(bare, (0.0, 0.0), rigid=False).clearance == pytest.approx(
        5e-5, abs=1e-12
    )
    # (1 - nu) rho w^2 r^3/(4 E) of a solid disc, of radii
    grown = 2.0 * (1 - 0.3) * STEEL.density * 1000.0**2 * 0.0825**3 / (4.0 * STEEL.elastic_modulus)
    assert operating_clearance(bare, (1000.0, 0.0), rigid=False).clearance == pytest.approx(
        5e-5 - grown, abs=1e-12
    )
    assert operating_clearance(bare, (0.0, 0.0)).assumed == ()
    hollow = attrs.evolve(
        bare, mounting=attrs.evolve(bare.mounting, shaft_bore=PLAIN.boundaries[0])
    )  # a ring would sit there
    assert operating_clearance(hollow, (0.0, 0.0)).clearance == pytest.approx(5e-5, abs=1e-12)
    for key, value in (("shaft_fit", "k5"), ("shaft_interference", 1e-5)):
        with pytest.raises(FieldError, match="rollers run on the shaft itself"):
            operating_clearance(attrs.evolve(bare, mounting=Mounting(**{key: value})), (0.0, 0.0))
    cup = attrs.evolve(
        bare, outer_raceway=Raceway(without_ring=True), mounting=Mounting(housing_fit="N6")
    )
    with pytest.raises(FieldError, match="rollers run on the housing itself"):
        operating_clearance(cup, (0.0, 0.0))


def test_the_sum_is_that_by_hand():
    read = scene(speed="1e-6 rpm")
    assert str(read.bearing.mounted) == "57.5 CN - 17 m5 - 7.6 for 5 K = 33 um"
    F = read.bearing.inner_raceway_diameter
    E = read.bearing.outer_raceway_diameter
    by_hand = 57.5e-6 - 0.8 * 25e-6 * 0.08 / F - 12e-6 * 5.0 * E
    assert read.bearing.radial_clearance == pytest.approx(by_hand, abs=2e-12)
    # class 40 to 75 um, shaft 11 to 24, bore -15 to 0, each even; a housing that is loose does not scatter
    scatter = np.hypot(35.0, 0.8 * 0.08 / F * np.hypot(13.0, 15.0)) / 12**0.5
    assert 1e6 * read.bearing.mounted.deviation == pytest.approx(scatter)
    assert read.bearing.mounted.assumed == ("shaft_fit", "housing_fit")


@pytest.mark.parametrize(
    # bearing; fit, what is left [um]; scatter and what is left of C3 with the usual fit [um], as an own sum gave them
    ("name", "left", "deviation", "c3"),
    [
        ("NU205", {"k5": 22, "m5": 19}, 8, 37),
        ("NU210", {"k5": 31, "m5": 26, "m6": 25}, 9, 51),
        ("NU2216", {"m5": 33, "m6": 31}, 11, 58),
        ("NU322", {"m5": 39, "m6": 36, "n6": 30}, 13, 71),
        ("NU232", {"m6": 53, "n6": 45}, 16, 98),
    ],
)
def test_usual_bearings_keep_what_others_computed(name, left, deviation, c3):
    still = scene(f"name = '{name}'", speed="1e-6 rpm")
    for fit, clearance in left.items():
        found = evolve(still, {"bearing.mounting.shaft_fit": fit}).bearing.radial_clearance
        assert 1e6 * found == pytest.approx(clearance, abs=0.9)
    assert 1e6 * still.bearing.mounted.deviation == pytest.approx(deviation, abs=0.5)
    loose = evolve(still, {"bearing.clearance_class": "C3"}).bearing
    assert (1e6 * loose.radial_clearance, loose.clearance_class) == (
        pytest.approx(c3, abs=0.9),
        "C3",
    )
    assert loose == scene(f"name = '{name}/C3'", speed="1e-6 rpm").bearing


def test_temperatures_of_rings_take_the_place_of_the_usual_difference():
    still = {"bearing.mounting.shaft_interference": 0.0, "bearing.mounting.growth": False}
    loose = evolve(scene(), still, si=True)
    b = loose.bearing
    warm = evolve(
        loose,
        {"operation.inner_ring_temperature": "82 degC", "operation.roller_temperature": "76 degC"},
    )
    said = 57.5e-6 - 12e-6 * (12.0 * b.inner_raceway_diameter + 2 * 6.0 * b.roller_diameter)
    assert warm.bearing.radial_clearance == pytest.approx(said, abs=2e-12)
    # all parts warm alike where somebody says so: no clearance is lost, at any temperature
    for T in ("20 degC", "70 degC"):
        alike = {"operation.outer_ring_temperature": T, "operation.temperature": T}
        assert evolve(loose, alike, si=True).bearing.radial_clearance == pytest.approx(
            57.5e-6, abs=1e-12
        )


@given(
    st.sampled_from(("NU205", "NU210", "NU2216", "NU322", "NU232")),
    st.floats(0.0, 1e-4), st.floats(0.0, 1e-4), st.floats(0.0, 30.0), st.floats(0.0, 10.0), st.floats(0.0, 1.0),
)  # fmt: skip
def test_more_interference_and_more_heat_leave_less_clearance(
    name, shaft, housing, warm, more, smoothing
):
    b = CATALOGUE[CATALOGUE.canonical_name(name)].bearing

    def left(**mounting):
        given = attrs.evolve(
            b.mounting, initial_clearance=b.radial_clearance, smoothing=smoothing, **mounting
        )
        return operating_clearance(attrs.evolve(b, mounting=given), (0.0, 0.0)).clearance

    base = left(shaft_interference=shaft, housing_interference=housing, temperature_difference=warm)
    for key, value, step in (
        ("shaft_interference", shaft, 1e-6 * more), ("housing_interference", housing, 1e-6 * more),
        ("temperature_difference", warm, more),
    ):  # fmt: skip
        known = {
            "shaft_interference": shaft,
            "housing_interference": housing,
            "temperature_difference": warm,
        }
        tighter = left(**known | {key: value + step})
        assert tighter <= base + 1e-12  # picometres are rounded
        if smoothing > 0.1 and more > 0.1:
            assert tighter < base
    # never more than the whole interference comes through, and all of the rest is linear
    assert (
        b.radial_clearance - base
        <= smoothing * (shaft + housing) + 12e-6 * warm * b.outer_raceway_diameter + 2e-12
    )


@pytest.mark.parametrize("name", ["NU205", "NU 1016", "NU2216", "NJ232"])
def test_classes_stand_in_their_order(name):
    one = scene(f"name = '{name}'")
    found = [
        evolve(one, {"bearing.clearance_class": of}).bearing for of in ("C2", "CN", "C3", "C4")
    ]
    sizes = [bearing.radial_clearance for bearing in found]
    assert sizes == sorted(sizes)
    assert len(set(sizes)) == 4
    assert found[1] == one.bearing
    assert evolve(one, {"bearing.clearance_class": "/c3"}).bearing == found[2]


def test_the_usual_fit_follows_the_bore():
    assert [usual_fit(1e-3 * bore) for bore in (20, 50, 55, 100, 105, 300)] == [
        "k5",
        "k5",
        "m5",
        "m5",
        "m6",
        "m6",
    ]
    assert scene().bearing.boundaries == (0.08, 0.14)
    assert PLAIN.boundaries == (
        pytest.approx(0.15),
        pytest.approx(0.21),
    )  # estimated: half a roller


# One clearance in every study ---------------------------------------------------------------------------------------


def test_a_scene_with_diameters_alone_keeps_the_clearance_of_its_diameters():
    for name in ("1032930-50C", "1032930-70C"):
        assert (load_scene(name).bearing.radial_clearance, load_scene(name).bearing.mounted) == (
            0.0,
            None,
        )
    plain = scene("name = '1032930'")
    assert (plain.bearing.radial_clearance, plain.bearing.mounted, plain.bearing.mounting) == (
        0.0,
        None,
        None,
    )


def test_a_stated_clearance_is_that_in_operation_and_the_rest_is_told_as_unused():
    stated = scene(
        "name = 'NU2216'\nradial_clearance = '20 um'\n[bearing.mounting]\nshaft_fit = 'n6'"
    )
    assert (stated.bearing.radial_clearance, stated.bearing.mounted) == (2e-5, None)
    assert any(
        "bearing.mounting: is not used: bearing.radial_clearance is stated, that in operation"
        in text
        for text in implausible(stated)
    )
    # a slider over the clearance of a scene with a mounting moves it
    assert evolve(
        scene(), {"bearing.radial_clearance": "10 um"}
    ).bearing.radial_clearance == pytest.approx(1e-5)
    for change in ({"bearing.clearance_class": "C3"}, {"bearing.mounting.shaft_fit": "m6"}):
        with pytest.raises(
            SceneError, match=r"changes nothing, since bearing.radial_clearance is stated"
        ):
            evolve(stated, change, si=True)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        (
            {"bearing.mounting.shaft_fit": "x9"},
            "shaft_fit: no fit of a shaft is called 'x9'; there are .*m5, m6",
        ),
        (
            {"bearing.mounting.shaft_fit": "H7"},
            "'H7' is not a fit of a shaft: shafts have small letters",
        ),
        ({"bearing.mounting.housing_fit": "m5"}, "'m5' is not a fit of a housing"),
        (
            {"bearing.clearance_class": "C9"},
            "clearance_class: 'NU2216E' is not listed in class 'C9': write C2, CN",
        ),
        (
            {"bearing.catalogue.bore": "120 mm"},
            "catalogue: bore of 120 mm leaves nothing of a ring at 95 mm",
        ),
        (
            {"bearing.catalogue.outside_diameter": "100 mm"},
            "catalogue: outside_diameter of 100 mm leaves nothing of a ring at 127 mm",
        ),
        (
            {"bearing.mounting.shaft_bore": "80 mm"},
            "shaft_bore: must be less than 80 mm, not 80 mm",
        ),
        (
            {"bearing.mounting.housing_outside_diameter": "120 mm"},
            "must be more than 140 mm, not 120 mm",
        ),
        (
            {"bearing.mounting.temperature_difference": "70 N"},
            "a difference of temperatures is expected, such as '5 K'",
        ),
        (
            {"bearing.mounting.temperature_difference": "300 K"},
            "must be from -150 K to 150 K, not 300 K",
        ),
        (
            {"bearing.mounting": {"shaft_fit": "m5", "shaft_interference": "9 um"}},
            "shaft_fit says the same",
        ),
        (
            {"bearing.mounting.initial_clearance": "20 mm"},
            "radial_clearance: must be less than the roller diameter",
        ),
    ],
)
def test_what_is_wrong_with_a_mounting_is_one_clear_error(changes, says):
    with pytest.raises(SceneError, match=says) as told:
        evolve(scene(), changes, si=True)
    assert len(told.value.problems) == 1


def test_a_class_needs_a_table_or_a_clearance_before_mounting():
    plain = resolved(PLAIN) | {"clearance_class": "C3"}
    plain.pop("radial_clearance")
    raw = dict(scene().raw) | {"bearing": plain}
    with pytest.raises(
        SceneError,
        match=r"clearance_class: only a bearing with bearing.name has classes; give bearing.mo",
    ):
        from_raw(raw, "scene")
    known = from_raw(
        raw | {"bearing": plain | {"mounting": {"initial_clearance": "100 um"}}}, "scene"
    )
    assert str(known.bearing.mounted).startswith("100 C3 - ")
    # of a bearing that somebody measured the class does not scatter
    measured = evolve(scene(), {"bearing.mounting.initial_clearance": "60 um"}).bearing.mounted
    assert measured.deviation < 0.5 * scene().bearing.mounted.deviation


def test_a_preload_is_told_once_with_the_sum():
    (told,) = implausible(
        evolve(scene(), {"bearing.clearance_class": "C2", "bearing.mounting.shaft_fit": "r6"})
    )
    assert "the bearing runs preloaded: 27.5 C2 - 40 r6 - 7.6 for 5 K" in told
    assert implausible(scene()) == []
    with pytest.raises(
        SceneError, match=r"57.5 CN - 17 m5 - 7.6 for 5 K - \d+ for speed = -\d+ um is -.*possible$"
    ):
        evolve(scene(), {"operation.inner_speed": "300000 rpm"})


CAGE = """[cage]
mass = "47.7 g"
inertia = "0.000147 kg m2"
guidance = "roller"
drag = ["churning"]
[accuracy]
tolerance = 0.1
[study.dynamics]
duration = "0.2 ms"
level = "LEVEL"
planar = { inner_ring_mass = "5 kg" }
[study.thermal-balance]
points = 8
[models]
damage = "flash-temperature"
"""


@pytest.mark.soak
@pytest.mark.parametrize(
    ("study", "level"),
    [
        ("effective-friction", "pocket"), ("steady-slip", "pocket"), ("thermal-balance", "pocket"),
        ("surface-damage", "pocket"), ("dynamics", "cage-set"), ("dynamics", "planar"),
    ],
)  # fmt: skip
def test_every_study_has_the_clearance_of_the_mounting_and_tells_its_sum(study, level):
    one = scene(more=CAGE.replace("LEVEL", level))
    text = str(one.bearing.mounted)
    (part,) = (part for part in plan(one, study).parts if part.part == "clearance")
    assert (part.reason, part.choice) == (text, "33 um")
    stated = evolve(one, {"bearing.radial_clearance": one.bearing.radial_clearance}, si=True)
    found = run(one, study)
    same = run(stated, study)
    assert f'"text": "{text}"' in found.attrs["clearance"]
    assert "clearance" not in same.attrs
    numbers = [name for name in found.data_vars if found[name].dtype.kind == "f"]
    for name in numbers:
        np.testing.assert_array_equal(found[name].values, same[name].values)
    if study != "dynamics":  # whose tables take long
        loose = run(evolve(one, {"bearing.clearance_class": "C4"}), study)
        assert any(
            not np.array_equal(found[name].values, loose[name].values, equal_nan=True)
            for name in numbers
        )


@pytest.mark.soak
def test_temperatures_of_a_motion_change_the_clearance_once():
    light = "".join(
        f", {part}_capacity = '1 mJ/K'" for part in ("oil", "inner_ring", "outer_ring", "rollers")
    )
    more = (
        CAGE.replace("LEVEL", "cage-set")
        + f"thermal = {{ model = 'network', oil_flow = '5 g/s'{light} }}\n"
    )
    one = scene(more=more)
    found = run(one, "dynamics")
    # it begins with all parts alike, so that class and fit are all that is taken, once
    alike = {
        f"operation.{part}_temperature": "70 degC"
        for part in ("inner_ring", "outer_ring", "roller")
    }
    begins = evolve(one, alike, si=True).bearing.radial_clearance
    assert begins == pytest.approx(scene().bearing.radial_clearance + 7.62e-6, abs=2e-9)
    assert float(found.radial_clearance[0]) == pytest.approx(begins, abs=1e-9)
    o = {
        name: float(found["course_temperature"].sel(node=name)[-1])
        for name in ("inner ring", "rollers", "outer ring")
    }
    ends = operating_clearance(
        one.bearing, (one.operation.inner_speed, 0.0), tuple(o.values())
    ).clearance
    assert ends != begins
    assert float(found.radial_clearance[-1]) == pytest.approx(ends, abs=1e-8)


def test_it_is_the_same_however_a_scene_is_read():
    one = scene()
    again = from_raw(resolved(one), "again")
    assert again.bearing.radial_clearance == one.bearing.radial_clearance
    assert scene_hash(again) == scene_hash(one)


def test_the_thermal_model_gives_the_clearance_of_a_scene_at_its_temperatures():
    one = evolve(scene(), {"models.thermal": "network", "operation.inner_speed": "9000 rpm"})
    model = get_model("thermal", "network").of(assemble(one))
    T = model.start(one) + np.array([0.0, 22.0, 15.0, 6.0, 0.0, 0.0])
    changes = model.changes(T, one)
    temperatures = {key: value for key, value in changes.items() if key.endswith("temperature")}
    assert len(temperatures) == 4
    stated = evolve(one, temperatures, si=True)
    assert stated.bearing.mounted is not None
    assert changes["bearing.radial_clearance"] == stated.bearing.radial_clearance
    assert evolve(one, changes, si=True).bearing.radial_clearance == stated.bearing.radial_clearance


# Scatter -------------------------------------------------------------------------------------------------------------


def test_its_scatter_follows_class_and_fit_and_moves_the_clearance():
    for changes in ({}, {"bearing.clearance_class": "C3"}, {"bearing.mounting.shaft_fit": "n6"}):
        one = evolve(scene(), changes, si=True)
        made, said = with_scatter(one)
        table = made.uncertainty["bearing.mounting.clearance_deviation"]
        assert (table["distribution"], table["mean"]) == ("normal", "0 um")
        assert float(table["deviation"].removesuffix(" um")) == pytest.approx(
            1e6 * one.bearing.mounted.deviation, rel=5e-3
        )
        assert any(
            text.startswith("bearing.mounting.clearance_deviation (B): clearance in operation")
            for text in said
        )
        moved = evolve(made, {"bearing.mounting.clearance_deviation": "-7 um"}).bearing
        assert moved.radial_clearance == pytest.approx(
            one.bearing.radial_clearance - 7e-6, abs=2e-12
        )
    own, _ = with_scatter(scene("name = 'NU2216'\nradial_clearance = '20 um'"))
    assert "bearing.mounting.clearance_deviation" not in own.uncertainty


@pytest.mark.parametrize(
    ("ring", "part", "sense"), [("inner", "shaft", -1.0), ("outer", "housing", 1.0)]
)
def test_a_raceway_without_ring_widens_with_the_expansion_of_what_it_is_on(ring, part, sense):
    """From 20 degC to 80 degC by (24 - 12)e-6 1/K of its diameter beyond steel, which both sides share."""
    bearing = attrs.evolve(PLAIN, **{f"{ring}_raceway": Raceway(without_ring=True)})
    of = {name: attrs.evolve(Mounting(temperature_difference=0.0), **given) for name, given in
          (("steel", {}), ("alloy", {f"{part}_expansion": 24e-6}))}  # fmt: skip
    steel, alloy = (operating_clearance(attrs.evolve(bearing, mounting=m), (0.0, 0.0), None, 353.15).clearance
                    for m in of.values())  # fmt: skip
    diameter = getattr(bearing, f"{ring}_raceway_diameter")
    assert alloy - steel == pytest.approx(sense * 12e-6 * 60.0 * diameter, rel=1e-9)


def test_the_material_of_a_seat_that_there_is_not_is_refused():
    bare = attrs.evolve(
        PLAIN,
        mounting=Mounting(shaft_material=Material()),
        inner_raceway=Raceway(without_ring=True),
    )
    with pytest.raises(
        FieldError, match=r"rollers run on the shaft itself.*is that of bearing.inner_raceway"
    ):
        operating_clearance(bare, (100.0, 0.0))
