"""What each ring's contacts are told and carry, in a bearing whose rings differ in all that they may differ in."""

import math

import numpy as np
import pytest

from rollslip import evolve
from rollslip.bearing.assembly import assemble
from rollslip.bearing.raceway import LoadedContacts
from rollslip.errors import SceneError
from rollslip.scene.reading import load_scene
from rollslip.structure import resolved
from rollslip_kernels.slices import Slices

pytestmark = pytest.mark.quick

SCENE = evolve(
    load_scene("1032930-70C"),
    {
        "surface.inner_raceway_roughness": "0.30 um",
        "surface.outer_raceway_roughness": "0.12 um",
        "surface.roller_roughness": "0.05 um",
        "operation.inner_ring_temperature": "90 degC",
        "operation.outer_ring_temperature": "60 degC",
        "operation.roller_temperature": "80 degC",
        "bearing.material.elastic_modulus": "200 GPa",
        "bearing.material.poisson_ratio": 0.25,
        "bearing.material.thermal_conductivity": "40 W/(m K)",
        "bearing.material.specific_heat": "450 J/(kg K)",
        "bearing.material.density": "7700 kg/m3",
    },
)


@pytest.mark.parametrize(
    ("ring", "roughness", "radius", "celsius"),
    [
        # 1.25 sqrt(Ra1^2 + Ra2^2); roller of 7.5 mm on raceways of 82.5 and 97.5 mm; mean of ring and roller
        ("inner", 1.25 * math.sqrt(0.30**2 + 0.05**2) * 1e-6, 7.5e-3 * 82.5e-3 / 90e-3, 85.0),
        ("outer", 1.25 * math.sqrt(0.12**2 + 0.05**2) * 1e-6, 7.5e-3 * 97.5e-3 / 90e-3, 70.0),
    ],
)
def test_contacts_of_a_ring_have_its_roughness_radius_and_temperature(
    ring, roughness, radius, celsius
):
    assembly = assemble(SCENE)
    conditions = {"inner": assembly.inner, "outer": assembly.outer}[ring].conditions
    oil = assembly.lubricant.at(celsius + 273.15)
    assert conditions.roughness == pytest.approx(roughness, rel=1e-12)
    assert conditions.radius == pytest.approx(radius, rel=1e-12)
    assert conditions.viscosity == pytest.approx(oil.viscosity, rel=1e-12)
    assert conditions.pressure_viscosity == pytest.approx(oil.pressure_viscosity, rel=1e-12)
    assert conditions.modulus == pytest.approx(200e9 / (1 - 0.25**2), rel=1e-12)
    assert conditions.effusivity == pytest.approx(math.sqrt(40.0 * 7700.0 * 450.0), rel=1e-12)
    assert conditions.length == pytest.approx(15e-3, rel=1e-12)


def test_a_shaft_of_another_material_is_half_of_its_contacts():
    bronze = {"elastic_modulus": "110 GPa", "poisson_ratio": 0.34, "thermal_conductivity": "60 W/(m K)",
              "specific_heat": "380 J/(kg K)", "density": "8800 kg/m3"}  # fmt: skip
    shaft = assemble(
        evolve(
            SCENE, {"bearing.inner_raceway.material": bronze, "models.contact": "lundberg"}, si=True
        )
    )
    inner = shaft.inner.conditions
    outer = shaft.outer.conditions
    plain = assemble(SCENE)
    # 2/E' is the sum of (1 - nu^2)/E of both bodies, as Hertz has it; of heat each takes what its effusivity says
    assert 2.0 / inner.modulus == pytest.approx(
        (1 - 0.34**2) / 110e9 + (1 - 0.25**2) / 200e9, rel=1e-12
    )
    both = math.sqrt(60.0 * 380.0 * 8800.0), math.sqrt(40.0 * 7700.0 * 450.0)
    assert inner.effusivity == pytest.approx(sum(both) / 2.0, rel=1e-12)
    assert outer == plain.outer.conditions
    assert shaft.roller_mass == plain.roller_mass
    # b = sqrt(4 w R (sum of (1 - nu^2)/E)/pi)
    [half_width] = shaft.inner.evaluate(np.array([1e5]), 10.0, 0.1).half_width
    soft = (1 - 0.34**2) / 110e9 + (1 - 0.25**2) / 200e9
    assert half_width == pytest.approx(
        math.sqrt(4.0 * 1e5 * inner.radius * soft / math.pi), rel=1e-12
    )
    same = evolve(
        SCENE, {"bearing.inner_raceway.material": resolved(SCENE.bearing.material)}, si=True
    )
    assert assemble(same).inner.conditions == plain.inner.conditions  # to the bit


@pytest.mark.parametrize("ring", ["inner", "outer"])
def test_a_contact_is_pressed_by_the_law_of_its_own_ring(ring):
    assembly = assemble(evolve(SCENE, {"models.contact": "lundberg"}))
    approach = np.linspace(-2e-6, 2e-5, 12)
    load, stiffness = assembly.deflect(approach, ring)
    inner = ring == "inner"
    raceway, other = (assembly.inner, assembly.outer) if inner else (assembly.outer, assembly.inner)
    touching = approach > 0.0
    slices, of_other = (
        Slices(int(touching.sum()), one.conditions, approach=approach[touching])
        for one in (raceway, other)
    )
    raceway.deflection(slices)
    raceway.deflection(of_other)
    np.testing.assert_array_equal(load[touching], slices.load)
    np.testing.assert_array_equal(stiffness[touching], slices.stiffness)
    assert not load[~touching].any()
    assert (
        np.abs(slices.load / of_other.load - 1.0).min() > 1e-3
    )  # the radii differ, and so must the loads


#: Another viscosity and temperature of the oil: deflections and loads do not depend on them and can be shared.
OTHER_OIL = {"lubricant.viscosity_factor": 1.07, "operation.temperature": "68 degC"}


@pytest.mark.parametrize(
    ("changes", "shared"),
    [
        (OTHER_OIL, True),
        ({**OTHER_OIL, "surface.roller_roughness": "0.09 um"}, True),
        ({**OTHER_OIL, "operation.radial_load": "3 kN"}, False),
        ({**OTHER_OIL, "operation.inner_speed": "6000 rpm"}, False),
        ({**OTHER_OIL, "bearing.radial_clearance": "10 um"}, False),
        ({**OTHER_OIL, "models.contact": "lundberg"}, False),
        ({"lubricant.pressure_viscosity_law": "roelands"}, False),
    ],
)
def test_what_is_taken_from_another_bearing_is_the_same_to_the_last_bit(changes, shared):
    scene = evolve(SCENE, changes, si=True)
    like = assemble(SCENE)
    like.load_distribution(2)
    taken = assemble(scene, like=like)
    alone = assemble(scene)
    assert (taken.inner.chain is like.inner.chain) == shared
    assert (taken.load_distribution(2) is like.load_distribution(2)) == shared
    assert taken.lubricant == alone.lubricant
    for own, other, load in zip(
        taken.raceways,
        alone.raceways,
        (alone.load_distribution(2).inner_load, alone.load_distribution(2).outer_load),
        strict=True,
    ):
        assert own.conditions == other.conditions
        some = load[load > 0.0]
        np.testing.assert_array_equal(
            own.evaluate(some, 20.0, 1.0).friction, other.evaluate(some, 20.0, 1.0).friction
        )
    np.testing.assert_array_equal(
        taken.load_distribution(2).inner_load, alone.load_distribution(2).inner_load
    )
    assert taken.cage == alone.cage


def test_a_bearing_under_another_load_is_that_of_a_scene_with_it_to_the_last_bit():
    there = assemble(evolve(SCENE, {"operation.radial_load": "2 kN"})).with_resistance()
    before = assemble(SCENE).with_resistance()
    before.load_distribution(2)
    taken = before.at_load(2000.0)
    assert taken.scene.operation == there.scene.operation
    assert (taken.inner.chain, taken.cage) == (before.inner.chain, there.cage)
    np.testing.assert_array_equal(
        taken.load_distribution(2).inner_load, there.load_distribution(2).inner_load
    )
    assert (
        before.load_distribution(2).inner_force.sum()
        > 1.2 * taken.load_distribution(2).inner_force.sum()
    )


def test_what_is_wrong_with_an_oil_is_said_beside_another_bearing_too():
    scene = evolve(
        SCENE, {"operation.temperature": "-90 degC", "operation.roller_temperature": "-90 degC"}
    )
    said = []
    for like in (None, assemble(SCENE)):
        with pytest.raises(SceneError) as error:
            assemble(scene, like=like)
        said.append(error.value.problems)
    assert said[0] == said[1]


@pytest.mark.parametrize("slices", [6, 7])
@pytest.mark.parametrize("tilt", ["0 mrad", "0.5 mrad"])
def test_loaded_slices_carry_what_their_rollers_carry(slices, tilt):
    assembly = assemble(
        evolve(SCENE, {"accuracy.slices": slices, "operation.misalignment": tilt}, si=True)
    )
    loads = assembly.load_distribution(2)
    for raceway, load in zip(assembly.raceways, (loads.inner_load, loads.outer_load), strict=True):
        contacts = LoadedContacts(raceway, load[0], assembly.widths, 1.0)
        np.testing.assert_allclose(
            contacts.per_roller(contacts.force), load[0] @ assembly.widths, rtol=1e-12
        )
        assert contacts.total == pytest.approx((load[0] @ assembly.widths).sum(), rel=1e-12)
