"""Rings that yield and raceways out of round in plane motion: Lagrange's equations, the equilibrium, the ledger."""

import functools

import attrs
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from plane_motion import TINY, Lagrange, motion, random_state, scene_of, yardstick
from rollslip import answer, evolve, run
from rollslip.bearing.assembly import assemble
from rollslip.bearing.equilibrium import solve_equilibrium
from rollslip.catalogue.registry import get_model
from rollslip.errors import DomainError, SceneError
from rollslip_kernels.motion.system import RefusedError
from rollslip_studies.dynamics.levels.planar import LEDGER, PlanarSettings, planar_motion
from rollslip_studies.dynamics.levels.raceway_friction import FrictionSettings
from rollslip_studies.motion.time_integration import InitialValueProblem, integrate

#: Boundary dimensions of the 1032930 [m]: rings need a section.
LIST = ("bearing.catalogue", {"bore": 0.15, "outside_diameter": 0.21, "width": 0.028})
#: Three lobes of a standing ring; the angle is none of symmetry.
LOBES = ("bearing.outer_raceway.form", [{"lobes": 3, "amplitude": "8 um", "angle": "20 deg"}])
#: A thin ring on a seat of 1 GPa, with one force that has an arm.
THIN = {
    "model": "thin", "seat_stiffness": "1e9 Pa", "harmonics": 3, "damping_ratio": 0.1,
    "forces": [{"angle": "30 deg", "radial": "2 kN", "tangential": "1 kN", "arm": "10 mm"}],
}  # fmt: skip
#: Two lobes of a ring that turns with the shaft.
TURNING = ("bearing.inner_raceway.form", [{"lobes": 2, "amplitude": "6 um", "angle": "40 deg"}])
#: A ring thicker than that of the list.
OUTER = {"model": "annulus", "outside": "230 mm", "harmonics": 4}
CONSTANT = FrictionSettings(name="constant", coefficient=0.05, transition=0.1)
#: The same, which widens but does not bend.
HOOP = {"model": "annulus", "outside": "230 mm", "harmonics": 0}
#: A shaft with a bore of 20 mm, whose shapes end at the oval.
INNER = {"model": "annulus", "bore": "20 mm", "harmonics": 2}


def bent_scene(rollers=5, guidance="roller", outer=None, inner=None, more=(), **held):
    rings = [(f"models.{name}_ring", of) for name, of in (("outer", outer), ("inner", inner)) if of]
    return evolve(scene_of(rollers, guidance, **held), dict((LIST, *rings, *more)), si=True)


#: Scene, settings, share of the yardstick that is allowed: 1e-12, but for what a spline leaves of a form.
CASES = {
    "constant": (bent_scene(outer=THIN), {}, 1e-12),
    "effective, both": (bent_scene(5, "inner", OUTER, INNER, cage=(("unbalance", 2e-4),)), {}, 1e-12),
    "conventional, mirrored": (
        bent_scene(4, outer=THIN, drag=("rolling-resistance",), more=(("operation.inner_speed", "-6371 rpm"),)),
        {"gravity_direction": 1.0},
        1e-12,
    ),
    "constant, lobes": (bent_scene(6, outer=OUTER, more=(LOBES,)), {}, 3e-6),
    "constant, lobes, rigid, mirrored": (
        bent_scene(6, more=(LOBES, ("operation.inner_speed", "-6371 rpm"))),
        {"gravity_direction": 1.0},
        3e-6,
    ),
    "constant, lobes of an inner ring that stands": (
        bent_scene(
            5,
            inner=INNER,
            more=(
                ("bearing.inner_raceway.form", LOBES[1]),
                ("operation.outer_speed", "3000 rpm"),
                ("operation.inner_speed", 0.0),
            ),
        ),
        {},
        3e-6,
    ),
    "constant, lobes of an inner ring that turns": (bent_scene(6, "inner", OUTER, more=(TURNING,)), {}, 3e-6),
    "effective, lobes of rings that both turn, mirrored": (
        bent_scene(
            5, outer=HOOP, inner=INNER,
            more=(LOBES, TURNING, ("operation.inner_speed", "-6371 rpm"), ("operation.outer_speed", "900 rpm")),
        ),
        {"gravity_direction": 1.0},
        3e-6,
    ),
}  # fmt: skip


class Bent(Lagrange):
    """The same with shapes cos n psi and sin n psi of the rings, and waves of both raceways, which may turn."""

    def __init__(self, planar, kind):
        super().__init__(planar, kind)
        models = self.assembly.scene.models
        rings = self.assembly.rings
        self.shapes = []  # ring, n, phase, and of the model: mass, stiffness, damping, push
        for at, choice, ring in (
            (0, models.inner_ring, rings.inner),
            (1, models.outer_ring, rings.outer),
        ):
            if choice is None:
                continue
            numbers = range(choice.parameters["harmonics"] + 1)
            seat = choice.name == "thin"
            waves = [
                (n, phase)
                for n in numbers
                if seat or n != 1
                for phase in ((0.0,) if n == 0 else (0.0, np.pi / 2))
            ]
            zeta = choice.parameters.get("damping_ratio", 0.02)
            for (n, phase), M, K, P in zip(
                waves, ring.mass, ring.stiffness, ring.pushes, strict=True
            ):
                self.shapes.append((at, n, phase, M, K, 2 * zeta * np.sqrt(K * M), P))
        self.sense = self.k.direction
        speeds = np.array([self.wi, self.wo])
        b = self.b
        rings = (0, 1)
        forms = [() if of is None else of.form for of in (b.inner_raceway, b.outer_raceway)]
        self.forms = [(k, one.lobes, one.amplitude, one.angle) for k in rings for one in forms[k]]
        self.going = [k for k in rings if speeds[k] and forms[k]]
        self.angles = len(self.going)
        self.speeds = speeds[self.going]

    def coordinates(self, y):
        q, dq = super().coordinates(y)
        head = self.planar.parts(y)[0]
        m = len(self.shapes)
        q = np.concatenate((q, head[10 : 10 + m], head[10 + 2 * m :]))
        return q, np.concatenate((dq, head[10 + m : 10 + 2 * m], self.speeds))

    def energy(self, q, dq):
        own = [M for _, _, _, M, *_ in self.shapes] + [
            1.0
        ] * self.angles  # of these any mass will do
        return super().energy(q, dq) + 0.5 * np.sum(own * dq[5 + 3 * self.Z :] ** 2)

    def heights(self, psi, of_rings):
        """How much gap the raceways take (2, Z): forms, and less what the rings yield."""
        seen = self.sense * psi
        found = [0 * psi, 0 * psi]
        m = len(self.shapes)
        for (ring, n, phase, *_), q in zip(self.shapes, of_rings[:m], strict=True):
            found[ring] = found[ring] - q * np.cos(n * seen - phase)
        gone = dict(zip(self.going, of_rings[m:], strict=True))
        for ring, lobes, amplitude, angle in self.forms:
            turned = self.sense * (psi - gone.get(ring, 0.0))
            found[ring] = found[ring] + amplitude * np.cos(lobes * (turned - angle))
        return np.array(found)

    def places(self, q):
        found = super().places(q)
        taken = self.heights(self.parts(q, self.pitch)[3], q[5 + 3 * self.Z :])
        return np.array([found[0] + taken[0], found[1] + taken[1], found[2], found[3]])

    def of_rings(self, q, dq):
        forces = np.zeros(q.size)
        lost = 0.0
        for k, (_, _, _, _, K, D, P) in enumerate(self.shapes, 5 + 3 * self.Z):
            forces[k] = P - K * q[k] - D * dq[k]
            lost += D * dq[k] ** 2
        psi = self.parts(q, self.pitch)[3]
        return forces, lost, self.heights(psi + 1j * TINY, q[5 + 3 * self.Z :]).imag / TINY


@functools.cache
def case(name):
    scene, more, allowed = CASES[name]
    planar = motion(scene, name.split(",")[0], **more)
    return planar, planar.system, Bent(planar, name.split(",")[0]), allowed


def moved(planar, seed):
    """A random state whose rings have yielded by microns and yield on."""
    y = random_state(planar, seed)
    rng = np.random.default_rng(seed)
    head = planar.parts(y)[0]
    m = planar.bent.shapes
    head[10 : 10 + m] += rng.normal(0.0, 3e-6, m)
    head[10 + m : 10 + 2 * m] = rng.normal(0.0, 0.02, m)
    head[10 + 2 * m :] = rng.uniform(-9.0, 9.0, head.size - 10 - 2 * m)
    return y


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("seed", range(3))
def test_rates_are_those_of_lagranges_equations(name, seed):
    planar, system, lagrange, allowed = case(name)
    y = moved(planar, seed)
    expected, _ = lagrange.rates(0.3, y)
    found = system.rates(0.3, y)
    scale = yardstick(planar, y, expected)
    assert np.all(np.abs(found - expected) <= allowed * scale)
    assert np.any(planar.planar.outputs([0.0], y[None])["normal_force"] > 0.0)
    if planar.bent.names:
        assert np.any(found[10 : len(planar.names[0])] != 0.0)


@pytest.mark.parametrize("name", CASES)
def test_energy_and_angular_momentum_change_by_what_the_ledger_records(name):
    planar, system, _, _ = case(name)
    y = moved(planar, 4)
    rates = system.rates(0.3, y)
    ledger = planar.parts(rates)[2]
    # by states a tiny time apart: energy is quadratic in speeds, shapes and places
    still = y.copy()
    still[-len(LEDGER) :] = 0.0
    done = planar.planar.outputs([0.0], y[None])["normal_force"].max()
    largest = max(np.abs(ledger[:12]).max(), done * 0.1)
    power = (planar.energy(still + 1e-30j * rates) / 1e-30).imag
    assert sum(planar.works(rates).values()) == pytest.approx(power, abs=1e-12 * largest)
    turning = planar.angular_momentum(still + 1e-30j * rates).imag / 1e-30
    assert planar.impulse(rates) == pytest.approx(
        turning, abs=1e-12 * planar.assembly.kinematics.orbit_radius * done
    )


@pytest.mark.parametrize("name", CASES)
def test_derivatives_are_those_of_all_rates(name):
    """By the shares of single rollers, which rates at once do without."""
    planar, system, _, _ = case(name)
    y = moved(planar, 1)
    J = system.jacobian(0.0, y, central=True)
    scale = system.scale
    for k in range(len(planar.names[0]) + 5):
        d = np.zeros(y.size)
        d[k] = 1e-6 * scale[k]
        by_rates = (system.rates(0.0, y + d) - system.rates(0.0, y - d)) / 2e-6
        off = np.abs(J[:, k] * scale[k] - by_rates)
        assert np.all(
            off
            <= 2e-4 * yardstick(planar, y, by_rates)
            + 1e-7 * yardstick(planar, y, system.rates(0.0, y))
        )


# The equilibrium -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("speed", ["6371 rpm", "-6371 rpm"])
@pytest.mark.parametrize("heavy", [False, True])
def test_it_starts_at_rest_in_the_equilibrium_of_rings_that_yield(speed, heavy):
    """With a weight out of the line of load the rings are seen from the line of both."""
    more = LOBES, ("operation.inner_speed", speed), ("bearing.radial_clearance", "-5 um")
    scene = bent_scene(28, outer=THIN, inner=INNER, more=more)
    given = {"inner_ring_mass": 40.0, "gravity_direction": 1.2} if heavy else {"gravity": 0.0}
    planar = motion(scene, coefficient=0.0, contact_damping=0.0, **given)
    y = planar.initial(cage_slip=1.0, roller_slip=1.0)
    rates = planar.system.rates(0.0, y)
    m = planar.bent.shapes
    head, rollers, _ = planar.parts(rates)
    forces = planar.planar.outputs([0.0], y[None])["normal_force"]
    lightest = min(ring.mass.min() for ring in planar.bent.ring_shapes)
    assert np.abs(head[2:4]).max() * planar.settings.inner_ring_mass < 1e-6 * forces.max()
    assert np.abs(head[10 + m :]).max() * lightest < 1e-6 * forces.max()
    spline = 1e-5 * forces.max() / planar.assembly.roller_mass
    assert np.abs(rollers[:, 4]).max() < (
        spline if not heavy else spline + 20.0
    )  # weight of the rollers
    if not heavy:
        held = planar.assembly.load_distribution(cage_speed=0.0)
        assert forces[0, 0] == pytest.approx(held.inner_force[0], abs=1e-5 * forces.max())


def test_a_motion_that_has_settled_is_the_equilibrium_of_the_same_rings():
    """From rigid and round rings, hard damped; rollers are where they have come to."""
    outer = {"model": "annulus", "outside": "230 mm", "harmonics": 4, "damping_ratio": 0.7}
    scene = bent_scene(
        8, outer=outer, inner=INNER, more=(LOBES, ("bearing.radial_clearance", "-10 um"))
    )
    planar = motion(scene, coefficient=0.0, gravity=0.0, contact_damping=30.0)
    y = planar.initial(cage_slip=1.0, roller_slip=1.0)
    a = planar.assembly
    head, rollers, _ = planar.parts(y)
    start = head.copy()
    m = planar.bent.shapes
    head[10 : 10 + m] = 0.0
    system = planar.system
    found = solve_ivp(
        system,
        (0.0, 6e-3),
        y,
        method="LSODA",
        rtol=1e-9,
        atol=1e-9 * system.scale,
        jac=system.jacobian,
    )
    head, rollers, _ = planar.parts(found.y[:, -1])
    psi = head[9] + 2 * np.pi * np.arange(8) / 8 + rollers[:, 0] / a.kinematics.orbit_radius
    case = attrs.evolve(a.load_case(1), psi=psi[None])
    held = solve_equilibrium(case, a.raceways)
    forces = planar.planar.outputs([0.0], found.y[:, -1:].T)["normal_force"][0]
    largest = held.inner_force.max()
    assert np.abs(start[10 : 10 + m]).max() > 1e-6  # it had to go somewhere
    # rollers creep out of the load, against which damping holds
    assert forces[0] == pytest.approx(held.inner_force[0], abs=2e-4 * largest)
    assert forces[1] == pytest.approx(held.outer_force[0], abs=2e-4 * largest)
    assert head[10 : 10 + m] == pytest.approx(
        held.deflection[0], abs=2e-4 * np.abs(held.deflection).max()
    )


def test_ever_stiffer_rings_come_to_the_rigid_motion_and_rigid_ones_are_it_to_the_bit():
    def end(outer, **given):
        # a tolerance that leaves no shape out, however stiff
        scene = bent_scene(12, outer=outer, more=(("accuracy.tolerance", 1e-9),))
        planar = motion(scene, coefficient=0.02, **given)
        problem = InitialValueProblem(
            rates=planar.system, y=planar.initial(0.01), atol=1e-9 * planar.system.scale
        )
        found = integrate(
            problem, get_model("integrator", "rk45"), np.array([0.0, 2e-4]), rtol=1e-9
        )
        assert found.outcome == "finished"
        return planar.planar.outputs([0.0], found.y[-1:])["normal_force"][0], found.y[-1]

    rigid, state = end(None)
    assert np.array_equal(end("rigid")[1], state)
    off = []
    for stiffer in (1.0, 10.0, 100.0):  # of n = 0 and 2 alone, which then swing ten times faster
        ring = {
            "model": "thin",
            "thickness": "10 mm",
            "harmonics": 2,
            "seat_stiffness": 1e12 * stiffer,
        }
        off.append(np.abs(end(ring)[0] - rigid).max() / rigid.max())
    assert off[0] < 0.05
    assert off[1] < 0.2 * off[0]
    assert off[2] < 0.2 * off[1]


def test_a_matrix_with_a_mass_moves_as_the_ring_that_it_stands_for(tmp_path):
    thin = {"model": "thin", "seat_stiffness": "1e9 Pa", "harmonics": 3, "damping_ratio": 0.1}
    scene = bent_scene(12, outer=thin)
    ring = motion(scene).bent.rings.outer
    psi = 2 * np.pi * np.arange(36) / 36
    np.savetxt(
        tmp_path / "C.csv",
        ring.at(psi) / ring.stiffness @ ring.at(psi).T,
        delimiter=",",
        fmt="%.17e",
    )
    file = {
        "model": "compliance",
        "file": str(tmp_path / "C.csv"),
        "mass": f"{float(ring.mass[0])!r} kg",
        "damping_ratio": 0.1,
    }
    forces = []
    for outer in (thin, file):
        planar = motion(bent_scene(12, outer=outer), coefficient=0.02)
        y = planar.initial(0.01)
        planar.parts(y)[1][:, 4] = 1e-2 * np.cos(np.arange(12))
        problem = InitialValueProblem(rates=planar.system, y=y, atol=1e-9 * planar.system.scale)
        found = integrate(
            problem, get_model("integrator", "rk45"), np.linspace(0.0, 3e-4, 4), rtol=1e-9
        )
        forces.append(planar.planar.outputs(np.zeros(4), found.y)["normal_force"])
    assert np.abs(forces[0] - forces[0][0]).max() > 0.1 * forces[0].max()
    assert forces[1] == pytest.approx(forces[0], abs=1e-5 * forces[0].max())


# Forms that turn -----------------------------------------------------------------------------------------------------


def test_a_form_whose_ring_has_stopped_is_a_form_that_stands_to_the_bit():
    """Of a ring that turns at other times; its angle is one more unknown."""
    scene = bent_scene(6, outer=OUTER, more=(LOBES,))
    stands, stopped = (
        planar_motion(assemble(scene), PlanarSettings(inner_ring_mass=3.0), CONSTANT, top_speeds)
        for top_speeds in (None, (667.0, 10.0))
    )
    at = len(stands.names[0])
    assert list(stopped.names[0])[at:] == ["outer_form_angle"]
    for seed in range(3):
        y = moved(stands, seed)
        rates = stopped.system.rates(0.0, np.insert(y, at, 0.0))
        assert rates[at] == 0.0
        assert np.array_equal(np.delete(rates, at), stands.system.rates(0.0, y))


def test_a_form_that_has_turned_is_one_that_begins_there():
    """Rates at an angle of a form, whole cells of its spline, are those of a bearing whose form begins further on."""
    more = ("operation.inner_speed", "500 rpm"), ("operation.outer_speed", "-900 rpm")
    planar, further = (
        motion(
            bent_scene(
                6,
                outer=OUTER,
                more=(
                    *more,
                    ("bearing.inner_raceway.form", [TURNING[1][0] | {"angle": f"{40 + by} deg"}]),
                    ("bearing.outer_raceway.form", [LOBES[1][0] | {"angle": f"{20 - 2 * by} deg"}]),
                ),
            )
        )
        for by in (0, 45)
    )
    y = moved(planar, 5)
    head = planar.parts(y)[0]
    head[-2:] = np.radians([45.0, -90.0])
    there = y.copy()
    planar.parts(there)[0][-2:] = 0.0
    expected = further.system.rates(0.0, there)
    assert np.all(
        np.abs(planar.system.rates(0.0, y) - expected) <= 1e-9 * yardstick(planar, y, expected)
    )


def test_a_bearing_turned_by_a_pitch_with_its_form_and_its_load_is_the_same_with_other_numbers_of_rollers():
    planar = motion(bent_scene(6, "inner", HOOP, more=(TURNING,)), gravity=0.0)
    y = moved(planar, 2)
    pitch = 2 * np.pi / 6
    expected = planar.system.rates(0.0, y)
    turn = np.array([[np.cos(pitch), -np.sin(pitch)], [np.sin(pitch), np.cos(pitch)]])

    def renumbered(y):
        found = y.copy()
        head, rollers, _ = planar.parts(found)
        for place in (0, 2, 4, 6):
            head[place : place + 2] = turn @ head[place : place + 2]
        rollers[:] = np.roll(rollers, 1, axis=0)
        return found

    # the cage, without unbalance, stands as before: the pocket ahead has the roller
    there = renumbered(y)
    planar.parts(there)[0][-1] += pitch
    load = planar.planar.operation
    load[2] = pitch
    found = planar.system.rates(0.0, there)
    planar.parts(there)[0][-1] -= pitch
    without = planar.system.rates(0.0, there)
    load[2] = 0.0
    scale = yardstick(planar, y, expected)
    assert np.all(np.abs(found - renumbered(expected)) <= 1e-9 * scale)
    assert np.any(np.abs(without - renumbered(expected)) > 0.1 * scale)  # two lobes, six rollers


def test_a_form_that_turns_slowly_goes_through_the_equilibria_of_forms_that_stand():
    """What it lags behind, by damping, goes with its speed."""
    outer = {"model": "annulus", "outside": "230 mm", "harmonics": 4, "damping_ratio": 0.7}
    off = []
    for speed in (8.0, 4.0):  # rad/s
        more = LOBES, ("operation.inner_speed", 0.0), ("operation.outer_speed", speed)
        scene = bent_scene(8, outer=outer, more=(*more, ("bearing.radial_clearance", "-10 um")))
        planar = motion(scene, coefficient=0.0, gravity=0.0, contact_damping=30.0)
        a = planar.assembly
        system = planar.system
        y = planar.initial(cage_slip=1.0, roller_slip=1.0)
        there = (0.0, 0.1 / speed)
        found = solve_ivp(
            system,
            there,
            y,
            method="LSODA",
            rtol=1e-9,
            atol=1e-9 * system.scale,
            jac=system.jacobian,
        )
        end = found.y[:, -1]
        head, rollers, _ = planar.parts(end)
        angle = float(head[-1])
        assert angle == pytest.approx(0.1 * planar.direction, rel=1e-9)
        psi = head[9] + 2 * np.pi * np.arange(8) / 8 + rollers[:, 0] / a.kinematics.orbit_radius
        (lobes, amplitude, at) = a.rings.waves[0]
        case = attrs.evolve(
            a.load_case(1),
            psi=psi[None],
            rings=attrs.evolve(a.rings, waves=((lobes, amplitude, at + angle),), turns=()),
        )
        held = solve_equilibrium(case, a.raceways)
        forces = planar.planar.outputs([0.0], end[None])["normal_force"][0]
        begun = planar.planar.outputs([0.0], y[None])["normal_force"][0]
        largest = held.outer_force.max()
        assert np.abs(held.outer_force[0] - begun[1]).max() > 0.1 * largest
        off.append(np.abs(forces[1] - held.outer_force[0]).max() / largest)
    assert off[0] < 2e-3
    assert off[1] < 0.6 * off[0]


# Energy --------------------------------------------------------------------------------------------------------------

#: Palmgren's law, Q = FACTOR d^(10/9) of a roller of 15 mm.
FACTOR = (1e3 / 3.84e-5 * 15**0.8) ** (1 / 0.9)


@functools.cache
def plain(damped=True, rollers=7, lobes=True, turning=False):
    """Straight rollers that nothing rubs, between rings that yield, in pockets that they never reach."""
    outer = {
        "model": "thin",
        "seat_stiffness": "5e8 Pa",
        "harmonics": 3,
        "damping_ratio": 0.05 if damped else 0.0,
    }
    more = (
        ("bearing.profile", "none"),
        ("bearing.radial_clearance", "-20 um"),
        ("models.contact", "palmgren"),
    )
    form = (
        (("bearing.outer_raceway.form", [{"lobes": 2, "amplitude": "5 um", "angle": "40 deg"}]),)
        if lobes
        else ()
    )
    form += (TURNING,) if turning else ()
    inner = {
        "model": "annulus",
        "bore": "20 mm",
        "harmonics": 2,
        "damping_ratio": 0.05 if damped else 0.0,
    }
    cage = (
        ("pocket_clearance", 0.01),
        ("pocket_radial_clearance", 0.01),
        ("pocket_contact", "metal"),
    )
    scene = bent_scene(rollers, outer=outer, inner=inner, more=(*more, *form), cage=cage)
    return motion(scene, coefficient=0.0, gravity=0.0, contact_damping=1.0 if damped else 0.0)


class Plain:
    """The bearing of `plain` without its cage, once more: x, y, q of both rings, psi, rho; and their rates."""

    def __init__(self, planar):
        b = planar.assembly.scene.bearing
        k = planar.assembly.kinematics
        a = planar.assembly
        rings = a.rings
        self.Z = b.rollers
        self.R = k.orbit_radius
        self.m = a.roller_mass
        self.half = b.radial_clearance / 2
        outer = [(1, n, sine) for n in (1, 2, 3) for sine in (0, 1)]
        self.waves = [(0, 0, 0), (0, 2, 0), (0, 2, 1), (1, 0, 0), *outer]  # ring, n, sine
        self.mass = np.concatenate((rings.inner.mass, rings.outer.mass))
        self.K = np.concatenate((rings.inner.stiffness, rings.outer.stiffness))
        ratio = np.concatenate(
            [np.full(r.mass.size, r.damping_ratio) for r in (rings.inner, rings.outer)]
        )
        self.D = 2 * ratio * np.sqrt(self.mass * self.K)
        self.c = planar.settings.contact_damping
        self.M = planar.settings.inner_ring_mass
        self.F = 1037.0
        self.forms = [
            [wave for wave, (_, of) in zip(rings.waves, rings.turns, strict=True) if of == ring]
            for ring in (1, 2)
        ]
        self.speeds = k.inner_speed, 0.0
        self.n = 2 + self.K.size + 2 * self.Z

    def shapes(self, psi):
        """B and dB/dpsi of all shapes by ring, (2, shapes, Z)."""
        B = np.zeros((2, len(self.waves), self.Z))
        slope = np.zeros((2, len(self.waves), self.Z))
        for k, (ring, n, sine) in enumerate(self.waves):
            c = np.cos(n * psi)
            s = np.sin(n * psi)
            B[ring, k], slope[ring, k] = (s, n * c) if sine else (c, -n * s)
        return B, slope

    def contacts(self, t, u, v):
        """Approach and rate of both contacts, and what of it goes with psi."""
        m = self.K.size
        x = u[:2]
        q = u[2 : 2 + m]
        psi = u[2 + m : 2 + m + self.Z]
        rho = u[2 + m + self.Z :]
        vx = v[:2]
        p = v[2 : 2 + m]
        w = v[2 + m : 2 + m + self.Z]
        rise = v[2 + m + self.Z :]
        c = np.cos(psi)
        s = np.sin(psi)
        B, dB = self.shapes(psi)
        f = np.zeros((2, self.Z))
        df = np.zeros((2, self.Z))
        gone = np.zeros((2, self.Z))
        for ring, (waves, speed) in enumerate(zip(self.forms, self.speeds, strict=True)):
            for n, amplitude, at in waves:
                f[ring] += amplitude * np.cos(n * (psi - at - speed * t))
                df[ring] -= n * amplitude * np.sin(n * (psi - at - speed * t))
            gone[ring] = speed * df[ring]
        inner = x[0] * c + x[1] * s - self.half - rho + f[0] - q @ B[0]
        outer = rho + f[1] - q @ B[1]
        across = x[1] * c - x[0] * s + df[0] - q @ dB[0], df[1] - q @ dB[1]
        rates = (
            vx[0] * c + vx[1] * s - rise - p @ B[0] + across[0] * w - gone[0],
            rise - p @ B[1] + across[1] * w - gone[1],
        )
        return (inner, outer), rates, across, B, (c, s)

    def rates(self, t, z):
        u = z[: self.n]
        v = z[self.n :]
        (inner, outer), rates, across, B, (c, s) = self.contacts(t, u, v)
        forces = []
        for d, rate in ((inner, rates[0]), (outer, rates[1])):
            zeta = self.c * rate
            forces.append(
                FACTOR
                * np.maximum(d, 0) ** (10 / 9)
                * np.where(zeta > 0, 1 + zeta, 1 / (1 - np.minimum(zeta, 0)))
            )
        Ni, No = forces
        m = self.K.size
        Z = self.Z
        q = u[2 : 2 + m]
        rho = u[2 + m + Z :]
        p = v[2 : 2 + m]
        w = v[2 + m : 2 + m + Z]
        rise = v[2 + m + Z :]
        radius = self.R + rho
        a = np.concatenate(
            (
                [(self.F - Ni @ c) / self.M, -(Ni @ s) / self.M],
                (B[0] @ Ni + B[1] @ No - self.K * q - self.D * p) / self.mass,
                (-(Ni * across[0] + No * across[1]) / self.m / radius - 2 * rise * w) / radius,
                radius * w**2 + (Ni - No) / self.m,
            )
        )
        return np.concatenate((v, a))

    def energy(self, z):
        """Kinetic, elastic, and that of the load [J]."""
        u = z[: self.n]
        v = z[self.n :]
        (inner, outer), *_ = self.contacts(0.0, u, v)
        m = self.K.size
        Z = self.Z
        radius = self.R + u[2 + m + Z :]
        moving = self.M * v[:2] @ v[:2] + self.mass @ v[2 : 2 + m] ** 2
        moving += self.m * (
            ((radius * v[2 + m : 2 + m + Z]) ** 2).sum() + (v[2 + m + Z :] ** 2).sum()
        )
        stored = sum((FACTOR * np.maximum(d, 0) ** (19 / 9) * 9 / 19).sum() for d in (inner, outer))
        return 0.5 * moving + stored + 0.5 * self.K @ u[2 : 2 + m] ** 2 - self.F * u[0]

    def of(self, planar, y):
        """The same state."""
        head, rollers, _ = planar.parts(y)
        m = self.K.size
        psi = head[9] + 2 * np.pi * np.arange(self.Z) / self.Z + rollers[:, 0] / self.R
        return np.concatenate((head[:2], head[10 : 10 + m], psi, rollers[:, 3],
                               head[2:4], head[10 + m : 10 + 2 * m], rollers[:, 1], rollers[:, 4]))  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("turning", [False, True])
def test_it_moves_as_own_equations_do_under_scipy(turning):
    """A third way to write it down, integrated by DOP853; ours by our Dormand and Prince, and by leapfrog's steps."""
    planar = plain(turning=turning)
    own = Plain(planar)
    system = planar.system
    times = np.linspace(0.0, 6e-4, 7)
    y = planar.initial(0.3)
    head, rollers, _ = planar.parts(y)
    head[10:14] += 2e-6
    rollers[:, 4] += 1e-2
    theirs = solve_ivp(
        own.rates,
        (0.0, times[-1]),
        own.of(planar, y),
        "DOP853",
        t_eval=times,
        rtol=1e-9,
        atol=1e-12,
    ).y.T
    size = np.abs(theirs - theirs[0]).max(axis=0)
    kinds = np.split(size, np.cumsum([2, 10, 7, 7, 2, 10, 7]))
    scale = np.concatenate([np.full(part.size, part.max()) for part in kinds])
    worst = []
    for name, tolerance in (("rk45", 1e-9), ("leapfrog", 1e-5), ("leapfrog", 1e-7)):
        problem = InitialValueProblem(rates=system, y=y, atol=tolerance * system.scale)
        found = integrate(problem, get_model("integrator", name), times, rtol=tolerance)
        off = np.abs(np.array([own.of(planar, one) for one in found.y]) - theirs)
        worst.append((off.max(axis=0) / scale).max())
    assert worst[0] < 2e-6
    assert worst[2] < 5e-3
    assert worst[2] < 0.05 * worst[1]  # of order 2, its steps are a tenth


@settings(max_examples=12, deadline=None)
@given(seed=st.integers(0, 10**6), size=st.floats(0.1, 10.0))
def test_without_drive_energy_falls_and_without_damping_it_stays(seed, size):
    """Whatever the state, by potentials in closed form, over several swings of the fastest."""
    rng = np.random.default_rng(seed)
    for damped in (True, False):
        planar = plain(damped, lobes=False)
        own = Plain(planar)
        system = planar.system
        y = planar.initial(1.0, 1.0)
        head, rollers, _ = planar.parts(y)
        head[:4] += size * rng.normal(size=4) * [1e-6, 1e-6, 1e-2, 1e-2]
        head[10:] += size * np.concatenate((rng.normal(0.0, 1e-6, 10), rng.normal(0.0, 1e-2, 10)))
        rollers[:, 1] += size * rng.normal(size=7)
        rollers[:, 3:] += size * rng.normal(size=(7, 2)) * [1e-6, 1e-2]
        problem = InitialValueProblem(rates=system, y=y, atol=1e-10 * system.scale)
        found = integrate(
            problem, get_model("integrator", "rk45"), np.linspace(0.0, 2e-4, 21), rtol=1e-10
        )
        energy = np.array([own.energy(own.of(planar, one)) for one in found.y])
        given_away = energy[0] - energy.min()
        swings = abs(energy[0]) + 0.5 * planar.settings.inner_ring_mass * 1e-4
        if damped:
            assert np.all(np.diff(energy) <= 1e-7 * swings)
            assert given_away > 1e-5 * swings
        else:
            assert np.abs(energy - energy[0]).max() <= 1e-7 * swings


@pytest.mark.parametrize("name", ["constant", "effective, both", "constant, lobes"])
def test_the_frequency_that_steps_go_by_is_a_bound_and_no_loose_one(name):
    planar, system, _, _ = case(name)
    fastest = np.abs(np.linalg.eigvals(system.jacobian(0.0, planar.initial())).imag).max()
    assert 1.0 <= system.frequencies[1] / fastest < 2.0


def test_what_carries_the_inner_ring_is_told_of_rings_that_yield():
    planar, system, lagrange, _ = case("effective, both")
    for seed in range(3):
        y = moved(planar, seed)
        gaps = lagrange.places(lagrange.coordinates(y)[0])[0] - planar.assembly.drop.min()
        assert system.watch(0.0, y)[2] == pytest.approx(gaps.max(), abs=1e-15)


# Cost ----------------------------------------------------------------------------------------------------------------


def test_four_waves_take_few_more_steps_than_rigid_rings():
    evaluations = {}
    for name, outer in (("rigid", None), ("n <= 4", OUTER)):
        scene = bent_scene(
            28, "outer", outer, cage=(("land_clearance", "0.3 mm"), ("land_width", "5 mm"))
        )
        planar = motion(scene, coefficient=0.02, tabulated=True)
        problem = InitialValueProblem(
            rates=planar.system, y=planar.initial(0.01), atol=1e-5 * planar.system.scale
        )
        found = integrate(
            problem, get_model("integrator", "leapfrog"), np.array([0.0, 1e-2]), rtol=1e-5
        )
        assert found.outcome == "finished"
        evaluations[name] = found.evaluations
        print(
            f"{name}: {found.evaluations} evaluations, {1e-2 / found.processor_time:.2f} times real time"
        )
    assert evaluations["n <= 4"] < 1.25 * evaluations["rigid"]


# What is refused -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (
            {"outer": {"model": "thin", "fit_clearance": "20 um", "seat_stiffness": "1e9 Pa"}},
            "models.outer_ring.fit_cl",
        ),
        (
            {"inner": {"model": "thin", "harmonics": 3}},
            r"the inner ring turns through its own shapes at .* harmonics = 0",
        ),
        (
            {"outer": OUTER, "more": (("operation.outer_speed", "9000 rpm"),)},
            "the outer ring turns through its own",
        ),
    ],
)
def test_rings_of_which_it_knows_nothing_are_refused_in_words(changes, said):
    with pytest.raises(DomainError, match=said):
        motion(bent_scene(5, **changes))


def test_a_ring_without_masses_is_refused_and_a_hoop_may_turn(tmp_path):
    np.savetxt(tmp_path / "C.csv", 1e-9 * np.eye(12), delimiter=",")
    matrix = {"model": "compliance", "file": str(tmp_path / "C.csv")}
    with pytest.raises(DomainError, match="needs the masses of the shapes"):
        motion(bent_scene(5, outer=matrix))
    assert "outer_ring_shape_0" in motion(bent_scene(5, outer=matrix | {"mass": "2 kg"})).bent.names
    hoop = motion(bent_scene(5, inner={"model": "thin", "harmonics": 0}))
    assert list(hoop.bent.names) == ["inner_ring_cos_0", "inner_ring_cos_0_speed"]


def test_a_ring_that_yields_by_more_than_is_small_ends_a_motion_in_words():
    planar, system, _, _ = case("constant")
    y = planar.initial()
    y[11] = -0.76e-3
    with pytest.raises(RefusedError) as refused:
        system.watch(0.0, y)
    said = str(planar.error(refused.value.reason))
    assert said.startswith(
        "the shape of a ring is displaced by 0.00076 m, beyond what small displacements describe"
    )
    y[11] = -0.74e-3
    assert np.isfinite(system.watch(0.0, y)[2])


# Along a history -----------------------------------------------------------------------------------------------------


def along(level="planar", history=(), friction="conventional", **changes):
    # steps are stated: choosing them takes most of the time of a plan
    steps = {"integrator": "rk45", "relative_tolerance": 1e-5}
    found = {"level": level, "duration": "2 ms", "points": 9, "friction": friction} | steps
    found |= {"history": dict(history)} if history else {}
    found |= {"planar": {"inner_ring_mass": "5 kg"}} if level == "planar" else {}
    scene = evolve(
        bent_scene(28, "outer", **changes),
        {
            "accuracy.slices": 5,
            "study.dynamics": found,
            "study.effective-friction.skidding_range": 0,
        },
        si=True,
    )
    return run(scene, "dynamics")


def test_shapes_follow_a_load_that_grows_and_turns():
    way = {"load_direction": {"shape": "ramp", "to": "90 deg", "within": "2 ms"}}
    land = ("land_clearance", "0.3 mm"), ("land_width", "5 mm")
    result = along(history=way, outer={**OUTER, "harmonics": 2, "damping_ratio": 0.5}, cage=land)
    assert result.attrs["outcome"] == "finished"
    _, cosine, sine = result.ring_deflection.values
    assert cosine[0] > 1e-6 > 1e-12 > abs(sine[0])
    # turned by 90 deg, an oval is its opposite: at 45 deg on the way it is all sine
    assert cosine[-1] == pytest.approx(-cosine[0], rel=0.3)
    assert sine[4] == pytest.approx(cosine[0], rel=0.3)


TURNED = {"outer_speed": {"shape": "ramp", "to": "500 rpm", "within": "1 ms"}}


@pytest.mark.parametrize("level", ["pocket", "planar"])
def test_what_stands_and_turns_at_some_time_is_refused(level, tmp_path):
    cage = ("land_clearance", "0.3 mm"), ("land_width", "5 mm")
    np.savetxt(tmp_path / "C.csv", 1e-9 * np.eye(12), delimiter=",")
    matrix = {"model": "compliance", "file": str(tmp_path / "C.csv")}
    if level == "pocket":
        said = "the outer ring turns along the history, with the form of its raceway; choose level 'planar'"
        with pytest.raises(DomainError, match=said):
            along(level, TURNED, more=(LOBES,), cage=cage)
        with pytest.raises(
            SceneError, match="a matrix stands in the line of load, but this ring turns"
        ):
            along(level, TURNED, outer=matrix, cage=cage)
        way = {"load_direction": {"shape": "ramp", "to": "90 deg", "within": "2 ms"}}
        with pytest.raises(DomainError, match="not alike all round stand; choose level 'planar'"):
            along(level, way, more=(LOBES,), cage=cage)
        assert along(level, way, outer=OUTER, cage=cage).attrs["outcome"] == "finished"
    else:
        fast = {"outer_speed": {"shape": "ramp", "to": "9000 rpm", "within": "1 ms"}}
        with pytest.raises(DomainError, match="the outer ring turns through its own shapes"):
            along(level, fast, outer=OUTER, cage=cage)


def test_a_form_goes_round_with_the_speed_that_its_ring_has_along_a_history():
    cage = ("land_clearance", "0.3 mm"), ("land_width", "5 mm")
    way = {
        "inner_speed": {"shape": "ramp", "from": "3000 rpm", "to": "-1000 rpm", "within": "1.5 ms"}
    }
    result = along(history=way, friction="constant", more=(TURNING, LOBES), cage=cage)
    assert result.attrs["outcome"] == "finished"
    assert "a form turns with its ring" in result.attrs["skidding_status"]
    t = result.time.values
    rpm = 2 * np.pi / 60
    ramp = np.minimum(t, 1.5e-3)
    angle = rpm * (3000 * ramp - 4000 * ramp**2 / 2 / 1.5e-3 - 1000 * (t - ramp))
    assert result.form_angle[0].values == pytest.approx(angle, abs=1e-9)
    assert not result.form_angle[1].any()
    assert float(np.abs(result.energy_residual).max()) < 1e-6


@pytest.mark.parametrize("friction", ["effective", "conventional"])
def test_a_form_that_turns_is_planned_and_followed_and_leads_to_no_steady_slip(friction):
    cage = ("land_clearance", "0.3 mm"), ("land_width", "5 mm")
    result = along(friction=friction, more=(TURNING,), outer=HOOP, cage=cage)
    assert result.attrs["outcome"] == "finished"
    assert "a form turns with its ring" in result.attrs["skidding_status"]
    assert "no estimates" not in result.attrs["plan"]
    assert "153 unknowns" in result.attrs["plan"]  # 150, two of the hoop, and the angle
    assert result.form_angle[0].values == pytest.approx(
        6371 * 2 * np.pi / 60 * result.time.values, rel=1e-9
    )
    assert not any("steady-slip" in step for step in answer(result).next)
    standing = along(friction=friction, more=(LOBES,), outer=HOOP, cage=cage)
    assert "form_angle" not in standing
    assert answer(standing).next


def test_forces_come_from_the_table_where_a_form_presses_rollers_beyond_their_share_of_the_load():
    tight = (
        ("bearing.outer_raceway.form", [{"lobes": 2, "amplitude": "20 um"}]),
        ("bearing.radial_clearance", "-20 um"),
    )
    planar = motion(bent_scene(28, more=tight), coefficient=0.02, tabulated=True)
    y = planar.initial()
    before = planar.planar.deflections_evaluated
    assert planar.planar.outputs([0.0], y[None])["normal_force"].max() > 20.0 * 1037.0 / 28
    planar.system.rates(0.0, y)
    assert planar.planar.deflections_evaluated == before == 0
