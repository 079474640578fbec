"""Ribs under axial load: equilibrium anew from the geometry, symmetries and limits, and which bearings have them."""

from types import SimpleNamespace

import attrs
import numpy as np
import pytest

from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.bearing.chain import Chain
from rollslip.bearing.equilibrium import LoadCase, angular_positions, solve_equilibrium, solve_pitch
from rollslip.bearing.ribs import RibPair
from rollslip.errors import SceneError
from rollslip.models.profile import profile_drop, slice_positions
from rollslip.results.text import load_settings
from rollslip_kernels.slices import Conditions
from rollslip_plugins.contact import Palmgren
from rollslip_studies.motion.torque_balance import torque_balance

pytestmark = pytest.mark.quick

#: Forces of ribs of the prototype in `test_forces_are_those_of_the_prototype` [N].
PROTOTYPE_RIBS = [
    127.116066,
    40.568201,
    2.464177,
    2.464177,
    2.464177,
    2.464177,
    2.464177,
    2.464177,
    2.464177,
    2.464177,
    2.464177,
    2.464177,
    107.673964,
]
#: The same on the inner ring [N].
PROTOTYPE_INNER = [
    842.35219,
    129.287101,
    0.0,
    0.0,
    0.0,
    0.0,
    0.0,
    0.0,
    0.0,
    0.0,
    0.0,
    0.0,
    595.658453,
]

GEARBOX = load_scene("gearbox")
NJ = evolve(GEARBOX, {"bearing.name": "NJ 2312 ECP", "operation.radial_load": "1.5 kN"})


def loaded(axial, **changes):
    return evolve(NJ, {"operation.axial_load": axial} | changes, si=True)


def pair(diameter=0.019, pitch=0.096, height=1.9e-3, angle=0.5):
    spin_radius = diameter / 2 - height
    radii = (pitch - diameter) / 2 + height, (pitch + diameter) / 2 - height
    moduli = (2.2857e11, 2.2857e11)
    return RibPair(height, spin_radius / np.sin(np.radians(angle)), spin_radius, radii, moduli)


def contacts(length):
    ring = SimpleNamespace(
        conditions=Conditions(length=length), deflection=Chain(Palmgren().deflection())
    )
    return ring, ring


def case(ribs=None, **changes):
    length = 0.0297
    position = slice_positions(length, 40)
    given = {
        "psi": angular_positions(13, 3),
        "drop": profile_drop("iso16281", position, length, 0.019),
        "radial_clearance": 32.5e-6,
        "radial_load": 1500.0,
        "centrifugal_force": 12.0,
        "axial_load": 300.0,
        "ribs": ribs or pair(),
    }
    return LoadCase(roller_length=length, **(given | changes))


def imbalance(case, solved):
    """Largest imbalance of forces and moments over the largest force, from loads and displacements alone.

    Contacts are those of a sphere on each rib and of Palmgren's line, from the approaches of a rigid roller and ring.
    """
    psi = case.psi
    cos = np.cos(psi)
    x = case.position
    width = case.roller_length / x.size
    ribs = case.ribs
    roller = solved.roller_shift[..., None] + solved.roller_tilt[..., None] * x
    gap = solved.displacement[:, :1] * cos + solved.displacement[:, 1:] * np.sin(psi)
    gap = gap - case.radial_clearance / 2
    outer = roller - case.drop
    inner = gap[..., None] + case.misalignment * x * cos[..., None] - roller - case.drop

    def load(approach):
        # Palmgren: delta = 3.84e-5 Q^0.9/l^0.8 [mm, N]
        force = (1e3 * np.maximum(approach, 0.0) * (1e3 * case.roller_length) ** 0.8 / 3.84e-5) ** (
            1 / 0.9
        )
        return force / case.roller_length

    # the ring moves by z along its axis and turns by the misalignment about the middle of the bearing
    axial = solved.axial_displacement[:, None] - case.misalignment * ribs.ring_radii[0] * cos
    both = axial - 2.0 * ribs.spin_radius * solved.roller_tilt
    stiffness = [2.0 / 3.0 * modulus * np.sqrt(ribs.end_radius) for modulus in ribs.moduli]
    compliance = sum(k ** (-2.0 / 3.0) for k in stiffness)
    rib = (np.maximum(both, 0.0) / compliance) ** 1.5
    scale = max(solved.outer_force.max(), rib.max(), case.radial_load)
    inner_force = load(inner).sum(axis=-1) * width
    outer_force = load(outer).sum(axis=-1) * width
    inner_moment = (load(inner) @ x) * width
    outer_moment = (load(outer) @ x) * width
    imbalances = [
        inner_force + case.centrifugal_force - outer_force,
        (inner_moment - outer_moment + 2.0 * ribs.spin_radius * rib) / case.roller_length,
        (inner_force * cos).sum(axis=1) - case.radial_load,
        (inner_force * np.sin(psi)).sum(axis=1),
        rib.sum(axis=1) - case.axial_load,
        rib - solved.rib_force,
    ]
    moment = (inner_moment * cos).sum(axis=1) - ribs.ring_radii[0] * (rib * cos).sum(axis=1)
    assert solved.moment == pytest.approx(moment, rel=1e-9, abs=1e-9 * scale * case.roller_length)
    return max(np.abs(values).max() for values in imbalances) / scale


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"radial_load": 0.0},
        {"axial_load": 15e3, "radial_load": 3e3},
        {"misalignment": 0.5e-3},
        {"misalignment": -0.5e-3, "radial_clearance": -5e-6},
        {"centrifugal_force": 0.0},
        {"drop": np.zeros(40)},
        {"body_force": (3.0, 0.0), "centrifugal_force": 0.0},
    ],
    ids=str,
)
def test_forces_and_moments_balance_anew_from_the_geometry(changes):
    given = case(**changes)
    solved = solve_equilibrium(given, contacts(given.roller_length))
    if "body_force" in changes:
        given = attrs.evolve(given, centrifugal_force=0.0)
        pull = 3.0 * np.cos(given.psi)
        assert solved.outer_force - solved.inner_force == pytest.approx(pull, abs=1e-8)
        return
    # the deflection of a contact that is hardly loaded is rounded in a clearance of 3e-5 m
    assert imbalance(given, solved) < 1e-10


def test_forces_are_those_of_the_prototype():
    """Prototype of the same model by other means: a minimum of its potential with three coordinates of each roller.

    NumPy, 60 slices of equal width, NJ 2312: at psi = 2 pi (j + 0.3)/13, F_r 1500 N, F_a 300 N, F_c 12 N.
    """
    length = 0.0297
    x = (np.arange(60) + 0.5) / 60 * length - length / 2
    given = case(
        psi=angular_positions(13, 1) + 2 * np.pi * 0.3 / 13,
        drop=0.00035 * 0.019 * -np.log1p(-((2 * x / length) ** 2)),
        ribs=attrs.evolve(pair(), moduli=(208e9 / 0.91, 208e9 / 0.91)),
    )
    solved = solve_equilibrium(given, contacts(length))
    assert solved.rib_force[0] == pytest.approx(PROTOTYPE_RIBS, abs=2e-6)
    assert solved.inner_force[0] == pytest.approx(PROTOTYPE_INNER, abs=2e-6)


def test_random_bearings_find_their_equilibrium():
    """300 bearings, axial over radial load 1e-3 to 10, a sixth of them under pure axial load, some misaligned."""
    random = np.random.default_rng(5)
    worst = 0.0
    iterations = []
    for number in range(300):
        rollers = int(random.integers(8, 30))
        diameter = 10 ** random.uniform(-2.3, -1.3)
        length = diameter * random.uniform(0.8, 2.5)
        pitch = diameter * rollers * random.uniform(1.1, 1.6) / np.pi
        ribs = pair(
            diameter, pitch, diameter * random.uniform(0.05, 0.2), 10 ** random.uniform(-1, 0.3)
        )
        radial = 10 ** random.uniform(0, 3) * 1e4 * diameter**2 * (number % 6 > 0)
        axial = (radial or 1e6 * diameter**2) * 10 ** random.uniform(-3, 1)
        position = slice_positions(length, int(random.integers(8, 60)))
        given = LoadCase(
            angular_positions(rollers, 1) + random.uniform(0, 0.3),
            length,
            profile_drop("iso16281" if number % 3 else "none", position, length, diameter),
            radial_clearance=random.uniform(-5e-6, 1e-4),
            radial_load=radial,
            misalignment=random.uniform(-1e-3, 1e-3) if number % 5 == 0 else 0.0,
            centrifugal_force=10 ** random.uniform(-3, 2) if number % 4 else 0.0,
            axial_load=axial,
            ribs=ribs,
        )
        solved = solve_equilibrium(given, contacts(length))
        worst = max(worst, imbalance(given, solved))
        iterations.append(solved.iterations)
    assert worst < 1e-10
    assert np.median(iterations) < 20


def test_mirror_images_have_mirrored_loads():
    """In the line of load to the last bits, and along the axis: a symmetric row does not know its ends."""
    given = case(psi=angular_positions(13, 1) + 0.1)
    image = attrs.evolve(given, psi=-given.psi)
    law = contacts(given.roller_length)
    solved = solve_equilibrium(given, law)
    mirrored = solve_equilibrium(image, law)
    assert mirrored.rib_force == pytest.approx(solved.rib_force, rel=1e-11)
    assert mirrored.inner_load == pytest.approx(solved.inner_load, rel=1e-9, abs=1e-6)
    over_pitch = solve_pitch(case(), law)
    whole = solve_equilibrium(case(), law)
    for name in ("rib_force", "inner_load", "roller_tilt", "moment", "axial_displacement"):
        found = getattr(over_pitch, name)
        assert found == pytest.approx(
            getattr(whole, name), rel=1e-9, abs=1e-9 * np.abs(found).max()
        )


def test_a_load_on_the_other_ribs_is_that_of_the_bearing_in_a_mirror():
    """Ends of the rollers and the tilt of the ring are exchanged; the forces are computed anew from the geometry."""
    drop = case().drop + np.linspace(0.0, 2e-6, case().drop.size)
    given = case(misalignment=4e-4, drop=drop)
    image = attrs.evolve(given, misalignment=-4e-4, drop=drop[::-1], axial_load=-given.axial_load)
    law = contacts(given.roller_length)
    solved = solve_equilibrium(given, law)
    other = solve_equilibrium(image, law)
    assert other.rib_force == pytest.approx(solved.rib_force, rel=1e-8)
    assert other.inner_load[..., ::-1] == pytest.approx(solved.inner_load, rel=1e-8, abs=1e-4)
    assert other.roller_tilt == pytest.approx(-solved.roller_tilt, rel=1e-7, abs=1e-12)
    assert other.axial_displacement == pytest.approx(-solved.axial_displacement, rel=1e-9)
    assert other.moment == pytest.approx(-solved.moment, rel=1e-8)


def test_both_senses_of_an_axial_load_have_the_same_slip():
    scene = evolve(GEARBOX, {"bearing.name": "NUP 2312 ECP", "operation.axial_load": "0.3 kN"})
    other = evolve(scene, {"operation.axial_load": "-0.3 kN"})
    positions = [assemble(each).load_distribution(2) for each in (scene, other)]
    assert positions[1].rib_force == pytest.approx(positions[0].rib_force, rel=1e-9)
    slips = np.array([0.0, 0.02])
    torques = [torque_balance(assemble(each), 2).torques(slips) for each in (scene, other)]
    assert torques[1] == pytest.approx(torques[0], rel=1e-9)
    pure = evolve(other, {"operation.radial_load": "0 N"}).operation
    assert pure.load == 300.0
    assert pure.with_load(200.0).axial_load == -200.0
    assert load_settings({"radial_load": 1500.0, "axial_load": -300.0}, 3000.0).endswith(
        "--set operation.axial_load='-600 N'"
    )


@pytest.mark.parametrize("name", ["NJ 2312 ECP", "nj2312"])
def test_an_nj_carries_an_axial_load_one_way(name):
    with pytest.raises(SceneError, match="the second bearing of the pair carries it: write 0"):
        evolve(GEARBOX, {"bearing.name": name, "operation.axial_load": "-0.3 kN"})


def test_without_axial_load_the_loads_are_those_of_a_radial_bearing():
    """The rollers tilt in their clearance by a load of 1 mN, which changes loads per length by 1e-6 of the largest."""
    radial = assemble(NJ).load_distribution(3)
    hardly = assemble(loaded(1e-3)).load_distribution(3)
    largest = radial.inner_load.max()
    assert hardly.inner_force == pytest.approx(
        radial.inner_force, abs=1e-9 * radial.inner_force.max()
    )
    assert hardly.inner_load == pytest.approx(radial.inner_load, abs=3e-6 * largest)
    assert np.all(hardly.rib_force.sum(axis=1) == pytest.approx(1e-3, rel=1e-9))


def test_ribs_without_axial_load_change_nothing():
    nu = evolve(GEARBOX, {"operation.radial_load": "1.5 kN"})
    zero = loaded(0.0)
    assert NJ.bearing.ribs is not None
    assert nu.bearing.ribs is None
    for scene in (NJ, zero):
        found = assemble(scene).load_distribution(3)
        want = assemble(nu).load_distribution(3)
        assert np.array_equal(found.inner_load, want.inner_load)
        assert not found.rib_force.any()


def test_flexible_rings_and_ribs_have_one_equilibrium():
    scene = loaded(300.0, **{"models.outer_ring": "annulus"})
    assembly = assemble(scene)
    flexible = assembly.load_distribution(2)
    rigid = assemble(loaded(300.0)).load_distribution(2)
    assert flexible.deflection.shape[1] == assembly.rings.parity.size
    assert max(flexible.force_residual, flexible.moment_residual) < 1e-12
    assert flexible.rib_force.sum(axis=1) == pytest.approx(300.0, rel=1e-12)
    change = np.abs(flexible.rib_force - rigid.rib_force).max()
    assert 1e-3 < change / rigid.rib_force.max() < 0.5


def test_loaded_rollers_carry_the_axial_load():
    """Three of thirteen carry 92 % of it; others tilt in the clearance, as the prototype found them to."""
    force = np.sort(assemble(loaded(300.0)).load_distribution(1).rib_force[0])
    assert force[-3:].sum() / 300.0 == pytest.approx(0.92, abs=0.02)


# The scene ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["NU 2312 ECP", "N 312", "HK2020"])
def test_bearings_without_ribs_refuse_an_axial_load(name):
    with pytest.raises(
        SceneError,
        match=r"operation\.axial_load: nothing in this bearing carries 1 kN along its axis",
    ):
        evolve(GEARBOX, {"bearing.name": name, "operation.axial_load": "1 kN"})


@pytest.mark.parametrize("name", ["NJ 2312 ECP", "NUP 2312"])
def test_catalogue_bearings_have_ribs_by_their_type(name):
    scene = evolve(GEARBOX, {"bearing.name": name, "operation.axial_load": "0.3 kN"})
    ribs = scene.bearing.ribs
    assert ribs.height == pytest.approx(0.10 * scene.bearing.roller_diameter)
    assert np.degrees(ribs.angle) == pytest.approx(0.5)


def test_stated_ribs_carry_an_axial_load():
    scene = evolve(
        GEARBOX,
        {
            "bearing.ribs.height": "2 mm",
            "bearing.ribs.end_radius": "0.8 m",
            "operation.axial_load": "0.3 kN",
        },
    )
    ribs = assemble(scene).ribs
    assert (ribs.end_radius, ribs.spin_radius) == (0.8, pytest.approx(0.0075))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"bearing.ribs.height": "10 mm"},
            "bearing.ribs: height of 10 mm must be less than the radius",
        ),
        (
            {"bearing.ribs.opening_angle": "1 deg", "bearing.ribs.end_radius": "1 m"},
            "bearing.ribs.end_radius: opening_angle says the same",
        ),
        ({"models.rib": "open"}, "no rib is called 'open'"),
        (
            {"models.rib": {"model": "constant", "coefficient": -1}},
            "coefficient: must be at least 0",
        ),
    ],
)
def test_wrong_ribs_are_refused(changes, message):
    with pytest.raises(Exception, match=message):
        assemble(evolve(loaded(300.0), changes))


def test_a_load_case_needs_ribs_and_slices():
    with pytest.raises(ValueError, match="ribs carry it"):
        case(axial_load=0.0)
    with pytest.raises(ValueError, match="more than one slice"):
        case(drop=np.zeros(1))
