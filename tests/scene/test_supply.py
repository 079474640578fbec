"""How oil gets to a bearing: SKF's formulas in its own units, by hand and by their limits."""

import math
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rollslip import evolve, load_scene, plan
from rollslip.bearing.assembly import assemble
from rollslip.bearing.cage import oil_supply
from rollslip.errors import SceneError
from rollslip.scene.supply import DEEPEST, SUPPLIES, Lubrication, OilSupply
from rollslip.structure import Location, structure
from rollslip_plugins.data.cylindrical import CATALOGUE

pytestmark = pytest.mark.quick

SCENE = load_scene("1032930-50C")
#: Bore, outside diameter and rollers of 50 x 90 mm [m], and 3000 1/min [rad/s].
RINGS = (0.05, 0.09)
#: Diameter of a roller [m].
ROLLER = 0.01
SPEED = 100.0 * math.pi
KINDS = st.sampled_from(sorted(SUPPLIES))
SPEEDS = st.floats(1.0, 3000.0)
VISCOSITIES = st.floats(1e-6, 1e-3)


def of(speed=SPEED, viscosity=12e-6, **table):
    return OilSupply.from_lubrication(Lubrication(**table), RINGS, ROLLER, speed, viscosity)


def skf_drag(level, d, D, width, rpm):
    """SKF's later torque of a bath [N mm] as recalled (C), in mm and 1/min: 4 V_M K_roll C_w B d_m^4 n^2."""
    mean = 0.5 * (d + D)
    a = 3.25 * width / mean
    K_roll = 0.65 * 5.1 * (d + D) / (D - d) * 1e-12
    C_w = 2.789e-10 * a**3 - 2.786e-4 * a**2 + 0.0195 * a + 0.6439
    return 4.0 * 7.3e-4 * level / mean * K_roll * C_w * width * mean**4 * rpm**2


def ratios():
    """Torque by churning with C_D = 0.5 over that of SKF's bath, of the ring, for the NU bearings of the catalogue."""
    for name in CATALOGUE.names:
        if re.fullmatch(r"NU\d+E?", name) is None:
            continue
        data = CATALOGUE[name]
        b = data.bearing
        (d, D, width) = map(int, re.search(r"(\d+) x (\d+) x (\d+) mm", data.description).groups())
        speed = 1e6 / (d + D) * math.pi / 30.0  # n d_m = 5e5
        level = 0.5 * b.roller_diameter
        phi = OilSupply.from_lubrication(
            Lubrication(), b.boundaries, b.roller_diameter, speed, 1e-9
        ).oil_fraction
        orbit = (b.inner_raceway_diameter + b.outer_raceway_diameter) / 4
        cage = 0.5 * (1.0 - b.roller_diameter / (2.0 * orbit))  # speed, over that of the ring
        area = b.rollers * b.roller_length * b.roller_diameter
        torque = cage * orbit * 0.5 * phi * 870.0 * area * (cage * speed * orbit) ** 2 / 2.0
        yield torque / (1e-3 * skf_drag(1e3 * level, d, D, width, 1e6 / (d + D)))


def test_the_oil_of_a_bath_resists_as_skfs_bath_drag_does():
    """-30 to +35 % for nine of ten bearings are stated."""
    found = np.fromiter(ratios(), dtype=float)
    assert found.size > 100
    low, middle, high = np.quantile(found, [0.05, 0.5, 0.95])
    assert (low, high) == (pytest.approx(0.70, abs=0.03), pytest.approx(1.35, abs=0.03))
    assert 0.9 < middle < 1.1


def test_a_bath_by_hand():
    # 0.4 5/40, times 1 + (2.6e5 12/(3000 70^2))^1.38
    thick = 1.0 + (2.6e5 * 12.0 / (3000.0 * 4900.0)) ** 1.38
    assert of().oil_fraction == pytest.approx(0.05 * thick, rel=1e-12)
    assert of().oil_layer == 5e-6
    assert of(speed=-SPEED) == of()
    assert of(oil_level=0.01).oil_fraction == pytest.approx(2.0 * of().oil_fraction, rel=1e-12)
    assert of(supply="splash").oil_fraction == pytest.approx(0.5 * of().oil_fraction, rel=1e-12)
    assert of(supply="circulating") == of(supply="jet")
    assert of(supply="jet").oil_fraction == pytest.approx(2.0 * of().oil_fraction, rel=1e-12)
    assert (of(supply="mist").oil_fraction, of(supply="grease").oil_fraction) == (0.01, 0.0)


def test_the_oil_layer_follows_the_supply():
    """5 um where oil is plentiful, 3 where it is thrown, 1 where it is scarce; a low bath is like thrown oil."""
    layers = {kind: of(supply=kind).oil_layer for kind in SUPPLIES}
    assert layers["bath"] == layers["circulating"] == layers["jet"] == 5e-6
    assert layers["splash"] == of(oil_level=0.004).oil_layer == 3e-6
    assert layers["mist"] == layers["grease"] == 1e-6


def test_a_fast_bearing_throws_off_what_a_jet_brings():
    rpm = 5e5 / 70.0
    at, beyond, far = (
        of(speed=fraction * rpm * math.pi / 30.0, viscosity=1e-9, supply="jet")
        for fraction in (1.0, 1.1, 3)
    )
    assert at.oil_fraction == pytest.approx(0.1, rel=1e-6)
    assert beyond.oil_fraction == pytest.approx(0.1 / 1.1**4, rel=1e-6)
    assert far.oil_fraction == 0.03
    assert (
        of(speed=3 * rpm * math.pi / 30.0, viscosity=1e-9, supply="circulating").oil_fraction > 0.09
    )


@given(speed=SPEEDS, viscosity=VISCOSITIES, level=st.floats(0.0, 0.09), more=st.floats(0.0, 0.09))
def test_oil_between_the_rollers_rises_with_the_level_and_is_a_share(speed, viscosity, level, more):
    low, high = sorted((level, more))
    fractions = [of(speed, viscosity, oil_level=one).oil_fraction for one in (low, high)]
    assert 0.0 <= fractions[0] <= fractions[1] <= 1.0


@given(first=KINDS, stated=st.floats(0.0, 1.0))
def test_what_is_stated_stays(first, stated):
    assert of(supply=first, oil_fraction=stated).oil_fraction == stated
    assert of(supply=first, oil_layer=2e-5).oil_layer == 2e-5


@pytest.mark.parametrize(
    ("table", "says"),
    [
        ("tap", "supply: must be one of 'bath', 'splash', 'circulating', 'jet', 'mist', 'grease', not 'tap'"),
        ({"supply": "jet", "oil_level": "5 mm"}, "oil_level: only read for supply = 'bath' or 'splash', not for 'jet'"),
        ({"oil_flow": "1 l/min"}, "oil_flow: only read for supply = 'splash' or 'circulating' or 'jet', not for"),
        ({"oil_level": "5"}, "oil_level: '5' has no unit"),
        ({"oil_fraction": 1.5}, "oil_fraction: must be from 0 to 1"),
        ({"supply": "bath", "level": "5 mm"}, "level: unknown key"),
    ],
)  # fmt: skip
def test_a_fault_is_one_sentence(table, says):
    problems = []
    assert structure(Lubrication, table, Location({}, ()), problems) is None
    assert len(problems) == 1
    assert problems[0].startswith(says)


def test_a_scene_says_nothing_of_it_and_has_a_bath():
    assert SCENE.lubrication == Lubrication()
    assert evolve(SCENE, {"lubrication": "grease"}).lubrication.supply == "grease"
    with pytest.raises(SceneError, match=r"lubrication\.oil_level: must be from 0 to 30 m"):
        evolve(SCENE, {"lubrication.oil_level": "40 m"})


def test_one_layer_of_oil_limits_films_and_rolling_resistance():
    """The layer of the supply is in film and drag; a value that is stated for a model wins."""
    cage = {"mass": "0.4 kg", "inertia": "0.0033 kg m2"}
    scene = evolve(
        SCENE,
        {"cage": cage, "models.film": "inlet-correction", "lubrication.supply": "mist"},
        si=True,
    )
    bearing = assemble(scene)
    assert bearing.film.oil_layer == oil_supply(scene, bearing.lubricant).oil_layer == 1e-6
    assert bearing.cage.drags.resistance.terms[0].oil_layer == 1e-6
    stated = evolve(scene, {"models.film": {"model": "inlet-correction", "oil_layer": "2 um"}})
    assert assemble(stated).film.oil_layer == 2e-6
    plenty = assemble(evolve(scene, {"lubrication.oil_layer": "plenty"}))
    assert plenty.film.oil_layer == 1.0


def test_the_plan_says_where_drags_are_from():
    cage = {"mass": "0.4 kg", "inertia": "0.0033 kg m2"}
    scene = evolve(SCENE, {"cage": cage, "lubrication": "grease"}, si=True)
    parts = [
        part
        for part in plan(scene, "steady-slip").parts
        if part.part in ("drag", "rolling resistance")
    ]
    assert {part.reason for part in parts} == {"default, of lubrication.supply = 'grease'"}
    bare = plan(SCENE, "steady-slip").parts
    reasons = [part.reason for part in bare if part.part == "rolling resistance"]
    assert reasons == ["rolling resistance is not modelled: slip and torque are lower bounds"]


def test_the_deepest_bath_that_was_held_against_is_usual():
    from rollslip.planning.plausibility import implausible

    def told(fraction):
        level = f"{fraction * 180:.3g} mm"
        return [
            one
            for one in implausible(evolve(SCENE, {"lubrication.oil_level": level}, si=True))
            if "oil_level" in str(one)
        ]

    assert not told(0.9 * DEEPEST)
    assert told(1.2 * DEEPEST)
