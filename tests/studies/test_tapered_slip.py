"""Steady slips, losses and answers of tapered bearings."""

import math

import attrs
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from coarse import COARSE
from rollslip import evolve
from rollslip.bearing.assembly import Assembly, assemble
from rollslip.bearing.resolution import as_stated
from rollslip.results.accounts import account_of
from rollslip.results.text import describe_case
from rollslip.results.verdict import Fact
from rollslip.scene.reading import parse_scene
from rollslip.scene.relations import required_axial_load
from rollslip.studies.rating_life.model import dynamic_rating
from rollslip_studies.motion.losses import power_balance
from rollslip_studies.motion.pockets import reason_without_play
from rollslip_studies.motion.torque_balance import TorqueBalance
from without_bands import run

SCENE = parse_scene(
    """
[bearing]
rollers = 16
roller_diameter = "17 mm"
roller_length = "20.7 mm"
contact_angle = "15.64 deg"
pitch_diameter = "108.5 mm"
profile = "logarithmic"
[lubricant]
name = "fva-3"
[operation]
inner_speed = "2000 rpm"
radial_load = 0
axial_load = "6 kN"
temperature = "50 degC"
[accuracy]
tolerance = 0.02
""",
    "tapered.toml",
)


def bearing(**changes: object) -> Assembly:
    """The bearing with few slices, and with changes of the operation in SI units."""
    scene = evolve(SCENE, {f"operation.{name}": value for name, value in changes.items()}, si=True)
    resolution = attrs.evolve(as_stated(scene), slices=6, n_positions=2)
    return assemble(scene, resolution).with_resistance()


def balance_of(assembly: Assembly) -> TorqueBalance:
    return TorqueBalance(assembly, assembly.cage.drags, n_positions=2)


@settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    slip=st.floats(0.0, 0.5),
    speed=st.floats(20.0, 400.0),
    outer=st.sampled_from([0.0, -100.0]),
    axial=st.floats(2e3, 2e4),
    ratio=st.floats(0.0, 2.5),
)
def test_what_the_rings_put_in_is_lost_or_stored(
    slip: float, speed: float, outer: float, axial: float, ratio: float
) -> None:
    assembly = bearing(
        inner_speed=speed, outer_speed=outer, axial_load=axial, radial_load=ratio * axial
    )
    balance = balance_of(assembly)
    power = power_balance(balance, balance.orbit(slip))
    scale = sum(abs(loss.power) for loss in power.losses)
    assert sum(power.rings) == pytest.approx(power.total + power.stored, abs=1e-10 * scale)


def test_rollers_of_a_hardly_tapered_bearing_slip_as_cylindrical_ones() -> None:
    """At an angle of 1e-3 the axial load is that of the outer contacts of the cylindrical row."""
    raceways = 'inner_raceway_diameter = "91.5 mm"\nouter_raceway_diameter = "125.5 mm"'
    text = SCENE.text.replace('contact_angle = "15.64 deg"\n', "")
    text = text.replace('pitch_diameter = "108.5 mm"', raceways)
    text = text.replace('axial_load = "6 kN"\n', "").replace(
        "radial_load = 0", "radial_load = 2000"
    )
    plain = parse_scene(text, "cylindrical.toml")
    angle = 1e-3
    resolution = attrs.evolve(as_stated(plain), slices=12, n_positions=4)
    cylindrical = assemble(plain, resolution)
    axial = float(cylindrical.load_distribution(4).outer_force.sum(axis=1).mean()) * math.sin(angle)
    tapered = assemble(
        evolve(
            SCENE,
            {
                "bearing.contact_angle": angle,
                "operation.radial_load": 2e3,
                "operation.axial_load": axial,
                "models.rib": {"model": "constant", "coefficient": 0.0},
            },
            si=True,
        ),
        resolution,
    )
    # larger slips change the centrifugal force, and with it how far the rings are together
    slips = np.array([0.001, 0.005])
    torques = [balance_of(each.with_resistance()).torques(slips) for each in (cylindrical, tapered)]
    assert torques[1] == pytest.approx(torques[0], rel=1e-3)


def test_loads_vary_in_their_ratio() -> None:
    assembly = bearing(radial_load=3000.0, axial_load=6000.0)
    operation = assembly.at_load(1500.0).scene.operation
    assert (operation.radial_load, operation.axial_load) == (1500.0, 3000.0)
    operation = bearing(axial_load=6000.0).at_load(1500.0).scene.operation
    assert (operation.radial_load, operation.axial_load) == (0.0, 1500.0)


def test_search_for_a_load_ends_where_the_rings_are_held() -> None:
    """Centrifugal forces take 2 to 3 % of the axial load at 4000 rpm; below that the rings are pushed apart."""
    assembly = bearing(radial_load=3000.0, axial_load=2000.0, inner_speed=419.0)
    smallest = assembly.at_load(1e-3)
    held = smallest.scene.operation
    assert held.axial_load / held.radial_load == pytest.approx(2 / 3, rel=1e-12)
    assert 1.0 < held.axial_load / required_axial_load(smallest.scene) < 1.03
    assert smallest.load_distribution(2).inner_force.max() > 0.0
    assert assembly.at_load(2900.0).scene.operation.radial_load == 2900.0


@pytest.mark.slow
def test_answer_has_rows_of_tapered_bearings() -> None:
    coarse = {
        "accuracy.slices": 9,
        "study.steady-slip.points": 9,
        "study.steady-slip.pockets": "set",
    }
    result = run(evolve(SCENE, COARSE | coarse), "steady-slip")
    answer = account_of(result).answer(result)
    rows = {row.key: row for row in answer.rows}
    assert "6 kN axial" in describe_case(result)
    assert not {"clearance", "makers_minimum_load"} & rows.keys()
    # ISO 281, pure axial load: P = 0.4 cot(a) F_a
    life = (rows["largest_load"].value * 0.4 / math.tan(SCENE.bearing.contact_angle)) ** (-10 / 3)
    rating, _ = dynamic_rating(SCENE.bearing)
    assert 1e6 * rating ** (10 / 3) * life == pytest.approx(20_000 * 60 * 2000.0)
    # Q_o = Q_i + F_c/cos(a) along the normals, and the rib bears what both push along the axis of the roller
    assembly = assemble(SCENE)
    angles = SCENE.bearing.angles
    outer = 6000.0 / (16 * math.sin(angles.outer))
    centrifugal = assembly.centrifugal_force
    inner = outer - centrifugal / math.cos(angles.outer)
    rib = (inner + outer) * math.sin(angles.half) + centrifugal * math.sin(angles.middle)
    assert result["rib_force"].values == pytest.approx(rib, rel=2e-3)
    row = rows["axial_load"]
    assert (row.value, row.is_alarm) == (6000.0, False)
    assert required_axial_load(SCENE) == pytest.approx(70, abs=0.5)
    assert "up to 110 N on each; rings part below 70 N" in row.note
    assert Fact.AXIAL_RATIO not in answer.facts or not answer.facts[Fact.AXIAL_RATIO]
    assert rows["minimum_load"].note.endswith("for a slip below 5 %, axial")
    assert 300.0 < rows["minimum_load"].value < 2000.0
    assert "formula_torque" not in result
    assert float(result["loss"].sum()) == pytest.approx(
        float(result["friction_torque"][0]) * SCENE.operation.inner_speed, rel=1e-6
    )


def test_rollers_with_play_are_left_out_in_words() -> None:
    reason = reason_without_play(balance_of(bearing()))
    assert reason == "rollers with play in the pockets of a tapered bearing are not modelled"


def test_pure_axial_load_is_carried_by_all_rollers_alike() -> None:
    loads = bearing().load_distribution(2)
    assert np.ptp(loads.outer_force) < 1e-9 * loads.outer_force.max()
    expected = 6000.0 / (16 * math.sin(math.radians(15.64)))
    assert loads.outer_force == pytest.approx(np.full((2, 16), expected), rel=1e-12)


def test_rib_stands_at_the_large_end_of_the_rollers() -> None:
    """Sliding speed and levers of the equivalent rib are those of the contact, by its place in the axial plane."""
    assembly = bearing()
    b = assembly.scene.bearing
    k = assembly.kinematics
    rib = assembly.ribs
    axis = np.array([math.sin(b.angles.middle), math.cos(b.angles.middle)])
    across = np.array([math.cos(b.angles.middle), -math.sin(b.angles.middle)])
    half = 0.5 * b.roller_length
    rho = k.roller_radius + half * math.sin(b.angles.half) - rib.contact_height
    place = half * math.cos(b.angles.half) * axis - rho * across
    radius = k.orbit_radius + place[0]
    assert rib.scale * rib.spin_radius == pytest.approx(rho, rel=1e-12)
    assert rib.scale * rib.ring_radii[0] == pytest.approx(radius, rel=1e-12)
    assert rib.spin_radius == pytest.approx(k.roller_radius - rib.height, rel=1e-12)
    assert rib.ring_radii[0] == pytest.approx(k.inner_radius + rib.height, rel=1e-12)
    sliding, _ = rib.leads(k, np.array([0.1]))
    cage = 0.9 * k.epicyclic_cage_speed
    expected = radius * (k.inner_speed - cage) - rho * k.epicyclic_roller_speed
    assert rib.scale * sliding[0] == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize(
    ("rib", "torque"),
    [("open-film", 0.022), ({"model": "constant", "coefficient": 0.02}, 0.210)],
)
def test_friction_of_the_rib_adds_to_the_torque(rib: object, torque: float) -> None:
    """A film adds 0.018 to 0.05 N m to the 2.95 N m measured under these conditions, a coefficient of 0.02 8 %."""
    balance = balance_of(
        assemble(evolve(SCENE, {"models.rib": rib}), bearing().resolution).with_resistance()
    )
    power = power_balance(balance, balance.orbit(0.0))
    (loss,) = (loss for loss in power.losses if "rib" in loss.source)
    assert loss.source == "sliding, inner rib"
    assert loss.power / SCENE.operation.inner_speed == pytest.approx(torque, rel=0.05)
