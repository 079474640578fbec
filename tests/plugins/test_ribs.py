"""Friction of ribs: published film, limits, and the numbers of the prototype."""

import attrs
import numpy as np
import pytest

from rollslip import evolve, get_model, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.models import RibContact
from rollslip_kernels.slices import Conditions

pytestmark = pytest.mark.quick

#: Oil of the prototype: ISO VG 220 at 80 degC; steel of 208 GPa, roller end of an NJ 2312 open by 0.5 deg.
CONDITIONS = Conditions(
    radius=0.0076 / np.sin(np.radians(0.5)),
    length=1.9e-3,
    modulus=208e9 / 0.91,
    roughness=0.24e-6,
    effusivity=np.sqrt(46.0 * 7800.0 * 470.0),
    viscosity=0.03074,
    pressure_viscosity=1.784e-8,
    thermoviscosity=0.03566,
    conductivity=0.134,
    eyring_stress=5e6,
)
#: Loads, rolling and sliding speeds, and friction of the film of a prototype in NumPy, which bisects for the shear
#: stress and shears oil beside the contact out to 1.52 mm [N, m/s, N].
PROTOTYPE = (
    (2.4, 4.0, 0.9, 0.0375745),
    (40.0, 4.0, 0.9, 0.0522078),
    (120.0, 4.0, -0.9, -0.074702),
    (120.0, 0.5, 0.02, 0.0152898),
    (2000.0, 8.0, 2.0, 1.452968),
)


def contact(load, rolling, sliding, **conditions):
    return RibContact(
        conditions=attrs.evolve(CONDITIONS, **conditions),
        load=np.atleast_1d(np.asarray(load, dtype=float)),
        rolling_speed=np.atleast_1d(np.asarray(rolling, dtype=float)),
        sliding_speed=np.atleast_1d(np.asarray(sliding, dtype=float)),
    )


@pytest.mark.parametrize(("load", "rolling", "sliding", "friction"), PROTOTYPE)
def test_the_film_has_the_friction_of_the_prototype(load, rolling, sliding, friction):
    found = get_model("rib", "open-film").friction(contact(load, rolling, sliding))
    # the load at which the oil beside the contact begins to count is 1 mN here, a step there
    assert found[0] == pytest.approx(friction, rel=2e-3 / load + 1e-5)


def test_the_film_is_that_of_hamrock_and_dowson():
    """H = 2.69 U^0.67 G^0.53 W^-0.067 (1 - 0.61 e^-0.73), at U 1e-11, G 5000 and W 1e-6."""
    modulus = 2e11
    radius = 0.1
    given = contact(
        1e-6 * modulus * radius**2,
        1e-11 * modulus * radius / 0.05,
        1.0,
        modulus=modulus,
        radius=radius,
        viscosity=0.05,
        pressure_viscosity=5000 / modulus,
    )
    want = 2.69 * 1e-11**0.67 * 5000**0.53 * 1e-6**-0.067 * (1 - 0.61 * np.exp(-0.73))
    assert get_model("rib", "open-film").film_thickness(given)[0] / radius == pytest.approx(want)


def test_the_shear_stress_solves_its_equation():
    """tau = tau0 asinh(eta e^(-beta zeta tau V) V/(tau0 h)), with no asperities, and no oil beside the contact."""
    law = get_model("rib", "open-film", boundary_coefficient=0.0, reach=1e-3)
    load = np.array([1.0, 30.0, 300.0, 2000.0])
    given = contact(load, 4.0, np.array([1e-4, 0.1, 1.0, 6.0]), roughness=1e-12)
    c = given.conditions
    a = np.cbrt(1.5 * load * c.radius / c.modulus)
    pressure = load / (np.pi * a**2)
    film = law.film_thickness(given)
    stress = law.friction(given) / (np.pi * a**2)
    k = np.log(c.viscosity / 6.315e-5)
    z = c.pressure_viscosity / (5.1e-9 * k)
    viscosity = c.viscosity * np.exp(k * ((1 + 5.1e-9 * pressure) ** z - 1))
    zeta = 0.97 / c.effusivity * np.sqrt(a / (np.pi * 4.0)) + film / (12 * c.conductivity)
    V = given.sliding_speed
    hot = viscosity * np.exp(-c.thermoviscosity * zeta * stress * V)
    assert stress == pytest.approx(c.eyring_stress * np.arcsinh(hot * V / (c.eyring_stress * film)))


def test_rough_ribs_have_boundary_friction():
    law = get_model("rib", "open-film", reach=1e-3)
    rough = law.friction(contact(100.0, 1.0, 1.0, roughness=1.0))
    assert rough[0] == pytest.approx(10.0, rel=1e-4)


def test_the_coefficient_of_an_open_rib_falls_with_load():
    """0.0005 to 0.012 in the prototype's gearbox bearing."""
    load = np.array([2.4, 40.0, 120.0])
    coefficient = get_model("rib", "open-film").friction(contact(load, 4.0, 0.9)) / load
    assert np.all(np.diff(coefficient) < 0.0)
    assert 3e-4 < coefficient[-1] < coefficient[0] < 0.02


def test_ribs_are_read_with_axial_load_alone():
    scene = evolve(
        load_scene("gearbox"),
        {
            "bearing.name": "NJ 2312 ECP",
            "models.rib.coefficient": 0.02,
            "models.rib.model": "constant",
        },
    )
    assert assemble(scene).rib is None
    assert assemble(evolve(scene, {"operation.axial_load": "300 N"})).rib.coefficient == 0.02
