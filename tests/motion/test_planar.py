"""Plane motion: against Lagrange's equations, closed solutions, the equilibrium, and its own ledger."""

import functools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.special import gamma

from plane_motion import (
    CAGE,
    TINY,
    Lagrange,
    land_by_quadrature,
    motion,
    random_state,
    scene_of,
    yardstick,
)
from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.bearing.equilibrium import LoadCase, solve_equilibrium
from rollslip.bearing.raceway import RINGS
from rollslip.bearing.resolution import Resolution
from rollslip.catalogue.registry import get_model
from rollslip.errors import DomainError, SceneError
from rollslip.fields import FieldError
from rollslip.structure import Location, structure
from rollslip_kernels.motion import planar as kernels
from rollslip_kernels.motion.rosenbrock import Rosenbrock
from rollslip_kernels.motion.system import RefusedError
from rollslip_plugins.drag.torques import PetroffLand
from rollslip_studies.dynamics.history.settings import HistorySettings
from rollslip_studies.dynamics.history.varying import varying_motion
from rollslip_studies.dynamics.levels import planar as planar_module
from rollslip_studies.dynamics.levels.planar import (
    HEAD,
    LEDGER,
    ROLLER,
    PlanarSettings,
    planar_motion,
)
from rollslip_studies.dynamics.levels.raceway_friction import FrictionSettings
from rollslip_studies.motion.time_integration import InitialValueProblem, integrate
from tabled import REFERENCES, numbers_of

CASES = {
    "constant": (scene_of(5), {}),
    "constant, guided by a film's play": (
        scene_of(
            6,
            drag=("pocket-friction",),
            cage=(
                ("pocket_contact", "film"),
                ("pocket_radial_clearance", 1e-4),
                ("unbalance", 2e-4),
            ),
        ),
        {"gravity_direction": 2.0},
    ),
    "effective, inner land": (
        scene_of(5, "inner", cage=(("unbalance", 2e-4),)),
        {"gravity_direction": 0.7},
    ),
    "effective, outer land": (
        scene_of(
            5, "outer", ("petroff-land", "constant-torque"), cage=(("pocket_contact", "film"),)
        ),
        {"contact_damping": 2.0},
    ),
    "conventional, resisting": (
        scene_of(4, drag=("rolling-resistance", "pocket-friction"), cage=(("unbalance", 1e-3),)),
        {"gravity": 50.0},
    ),
    "conventional, mirrored, clearance": (
        scene_of(
            4,
            "inner",
            ("constant-torque", "pocket-friction"),
            (("unbalance", 3e-4),),
            (
                ("operation.inner_speed", "-6371 rpm"),
                ("operation.outer_speed", "500 rpm"),
                ("bearing.radial_clearance", "20 um"),
            ),
        ),
        {"gravity_direction": -1.0},
    ),
}


@functools.cache
def case(name):
    scene, more = CASES[name]
    planar = motion(scene, name.split(",")[0], **more)
    return planar, planar.system, Lagrange(planar, name.split(",")[0])


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("seed", range(4))
def test_rates_are_those_of_lagranges_equations(name, seed):
    planar, system, lagrange = case(name)
    y = random_state(planar, seed)
    expected, _ = lagrange.rates(0.3, y)
    found = system.rates(0.3, y)
    assert np.all(np.abs(found - expected) <= 1e-12 * yardstick(planar, y, expected))


@pytest.mark.parametrize("name", CASES)
def test_random_states_touch_every_bar(name):
    planar, _, _ = case(name)
    states = np.array([random_state(planar, seed) for seed in range(4)])
    done = planar.planar.outputs(np.zeros(4), states)
    assert set(np.sign(done["pocket_force"]).flat) >= {-1.0, 1.0}
    guided = planar.assembly.cage.guidance == "roller"
    assert set(np.sign(done["pocket_radial_force"]).flat) == ({-1.0, 0.0, 1.0} if guided else {0.0})


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("seed", range(4))
def test_energy_and_angular_momentum_change_by_what_the_ledger_records(name, seed):
    planar, system, lagrange = case(name)
    y = random_state(planar, seed)
    rates = system.rates(0.3, y)
    head, rollers, ledger = planar.parts(rates)
    q, dq = lagrange.coordinates(y)
    acceleration = np.concatenate(
        (head[[2, 3, 6, 7, 8]], rollers[:, 1] - head[8], rollers[:, 2], rollers[:, 4])
    )
    power = lagrange.energy(q + 1j * TINY * dq, dq + 1j * TINY * acceleration).imag / TINY
    # terms that cancel among themselves are as large as the power of one contact's force
    done = planar.planar.outputs([0.0], y[None])
    largest = max(np.abs(ledger[:12]).max(), done["normal_force"].max() * 0.1)
    assert sum(planar.works(rates).values()) == pytest.approx(power, abs=1e-12 * largest)

    # d/dt of L, which is bilinear in places and speeds, by the states a tiny time apart
    still = y.copy()
    still[-len(LEDGER) :] = 0.0
    ahead = planar.angular_momentum(still + 1e-30j * rates).imag / 1e-30
    arm = planar.assembly.kinematics.orbit_radius
    assert planar.impulse(rates) == pytest.approx(
        ahead, abs=1e-12 * arm * done["normal_force"].max()
    )


def test_kinetic_energy_is_that_of_all_moving_masses():
    for name in CASES:
        planar, _, lagrange = case(name)
        y = random_state(planar, 7)
        assert planar.energy(y) == pytest.approx(
            lagrange.energy(*lagrange.coordinates(y)), rel=1e-14
        )
        assert np.all(planar.energy(np.stack((y, 2 * y)))[0] == planar.energy(y))


@pytest.mark.parametrize(
    "name", ["constant", "effective, inner land", "conventional, mirrored, clearance"]
)
def test_nothing_but_head_and_own_block_moves_a_roller(name):
    planar, system, _ = case(name)
    y = random_state(planar, 5)
    before = planar.parts(system.rates(0.0, y))[1]
    changed = y.copy()
    changed[-len(LEDGER) :] += 1.0
    changed[len(HEAD) : len(HEAD) + len(ROLLER)] *= 1.001
    after = planar.parts(system.rates(0.0, changed))[1]
    assert np.all(after[1:] == before[1:])
    assert np.any(after[0] != before[0])


# The start -----------------------------------------------------------------------------------------------------------


def test_it_starts_at_rest_in_the_equilibrium_of_the_bearing():
    # no damping: where rollers go round, approaches change while forces balance
    planar = motion(scene_of(), coefficient=0.0, gravity=0.0, contact_damping=0.0)
    y = planar.initial(cage_slip=0.1)
    head, rollers, _ = planar.parts(y)
    held = planar.assembly.load_distribution(cage_speed=head[8])
    assert head[:2] == pytest.approx(held.displacement[0], rel=1e-12, abs=1e-18)
    done = planar.planar.outputs([0.0], y[None])
    assert done["normal_force"][0, 0] == pytest.approx(held.inner_force[0], abs=1e-9)
    assert done["normal_force"][0, 1] == pytest.approx(held.outer_force[0], abs=1e-9)
    moving, rising, _ = planar.parts(planar.system.rates(0.0, y))
    load = planar.assembly.scene.operation.radial_load
    assert np.all(np.abs(moving[2:4]) <= 1e-10 * load / planar.settings.inner_ring_mass)
    # the equilibrium has the rollers' mass on the orbit, here it is rho further out
    left = rising[:, 4] - head[8] ** 2 * rollers[:, 3]
    assert np.all(np.abs(left) <= 1e-10 * load / planar.assembly.roller_mass)


@pytest.mark.parametrize("quadrature", ["equal", "gauss"])
def test_it_starts_in_the_equilibrium_of_the_slices_that_it_has(quadrature):
    settings = PlanarSettings(inner_ring_mass=3.0, gravity=0.0, contact_damping=0.0)
    friction = FrictionSettings(name="constant", coefficient=0.0, transition=0.1)
    planar = planar_motion(
        assemble(scene_of(), Resolution(slices=20, quadrature=quadrature)), settings, friction
    )
    y = planar.initial()
    head, _, _ = planar.parts(y)
    held = planar.assembly.load_distribution(cage_speed=head[8])
    assert head[:2] == pytest.approx(held.displacement[0], rel=1e-12, abs=1e-18)
    assert planar.planar.outputs([0.0], y[None])["normal_force"][0, 0] == pytest.approx(
        held.inner_force[0], abs=1e-9
    )


@pytest.mark.parametrize("speed", ["6371 rpm", "-6371 rpm"])
def test_a_heavy_ring_pulls_the_start_out_of_the_line_of_load(speed):
    scene = scene_of(more=(("operation.inner_speed", speed),))
    planar = motion(
        scene, coefficient=0.0, inner_ring_mass=40.0, gravity_direction=1.2, contact_damping=0.0
    )
    y = planar.initial()
    moving, _, _ = planar.parts(planar.system.rates(0.0, y))
    assert np.all(np.abs(moving[2:4]) <= 1e-9)
    assert y[1] * planar.assembly.kinematics.direction > 0.1 * y[0]


def test_a_ring_that_was_pushed_away_settles_in_the_equilibrium():
    planar = motion(scene_of(5), coefficient=0.0, gravity=0.0, contact_damping=30.0)
    y = planar.initial(cage_slip=1.0, roller_slip=1.0)
    y[0] += 1e-6
    system = planar.system
    found = solve_ivp(
        system,
        (0.0, 8e-3),
        y,
        method="LSODA",
        rtol=1e-9,
        atol=1e-9 * system.scale,
        jac=system.jacobian,
    )
    head, rollers, _ = planar.parts(found.y[:, -1])
    psi = (
        2 * np.pi * np.arange(5) / 5 + rollers[:, 0] / planar.assembly.kinematics.orbit_radius
    )  # pushed aside a little
    b = planar.assembly.scene.bearing
    case = LoadCase(psi[None], b.roller_length, planar.assembly.drop, radial_clearance=b.radial_clearance,
                    radial_load=planar.assembly.scene.operation.radial_load)  # fmt: skip
    held = solve_equilibrium(case, planar.assembly.raceways)
    # as rollers drift out of the load it creeps on, 2e-7 m/s, against which the damping holds 6e-6 of the force
    assert head[0] == pytest.approx(held.displacement[0, 0], rel=5e-6)
    assert abs(found.y[2, -1]) < 3e-7 < 1e-4 * np.abs(found.y[2]).max()


# Along a history -----------------------------------------------------------------------------------------------------


def along_history(scene, end, raw, name="constant", **given):
    problems = []
    settings = structure(HistorySettings, raw, Location({}), problems)
    assert not problems
    friction = FrictionSettings(name=name, coefficient=0.05, transition=0.1, tabulated=False)
    planar = PlanarSettings(**{"inner_ring_mass": 3.0} | given)
    history = settings.history(scene, end, Location({}))
    return varying_motion(assemble(scene), friction, history, level="planar", planar=planar)


class Driven(Lagrange):
    """Lagrange's equations under the speed of the inner ring, the load and its direction of a history."""

    def __init__(self, moving):
        super().__init__(moving.base, "constant")
        self.history = moving.history

    def load(self, t):
        now = self.history.at(t)
        return float(now["radial_load"]) * np.array(
            [np.cos(now["load_direction"]), np.sin(now["load_direction"])]
        )

    def rates(self, t, y):
        self.wi = float(self.history.at(t)["inner_speed"])
        return super().rates(t, y)


def driven(end):
    scene = scene_of(3, more=(("accuracy.slices", 3),))
    raw = {
        "inner_speed": {"shape": "ramp", "to": 0.8 * scene.operation.inner_speed, "within": end},
        "radial_load": {"shape": "ramp", "to": "300 N", "within": end},
        "load_direction": {"shape": "ramp", "to": "40 deg", "within": end},
    }
    return along_history(scene, end, raw)


@pytest.mark.parametrize("t", [0.0, 0.2, 0.7, 1.5])
def test_at_every_moment_of_a_history_rates_are_those_of_lagranges_equations(t):
    moving = driven(1.0)
    y = random_state(moving.base, 5)
    lagrange = Driven(moving)
    expected, _ = lagrange.rates(t, y)
    found = moving.system.rates(t, y)
    works, distances = moving.sliding_work_and_distance(found)
    assert np.all(
        np.abs(found[: expected.size] - expected) <= 1e-12 * yardstick(moving.base, y, expected)
    )
    assert distances == pytest.approx(
        np.abs(lagrange.slips(*lagrange.coordinates(y))[[0, 2]]), rel=1e-9
    )
    assert works.sum(axis=1) == pytest.approx(
        [float(moving.split(found)[f"lost_{ring}"]) for ring in RINGS]
    )


@pytest.mark.soak
def test_speed_load_and_its_direction_over_time_move_it_as_lagranges_equations_do():
    """DOP853 of Lagrange's equations to 1e-11, ours to 1e-10; half a millisecond is ten swings of a roller."""
    end = 5e-4
    moving = driven(end)
    times = np.linspace(0.0, end, 6)
    lagrange = Driven(moving)
    y = moving.initial()
    atol = 1e-10 * moving.system.scale
    own = slice(
        -sum(part.size for part in moving.sliding_work_and_distance(y))
    )  # without what each roller does
    theirs = solve_ivp(
        lambda t, y: lagrange.rates(t, y)[0],
        (0.0, end),
        y[own],
        "DOP853",
        t_eval=times,
        rtol=1e-11,
        atol=0.01 * atol[own],
    )
    problem = InitialValueProblem(rates=moving.system, y=y, atol=atol, breaks=moving.breaks)
    ours = integrate(problem, get_model("integrator", "rk45"), times, rtol=1e-10)
    assert ours.outcome == "finished"
    assert np.all(np.abs(ours.y[:, own] - theirs.y.T) <= 1e-7 * moving.system.scale[own])
    steady = solve_ivp(
        moving.base.system.rates, (0.0, end), y, "DOP853", rtol=1e-6, atol=1e3 * atol
    ).y[:, -1]
    assert (
        np.abs(ours.y[-1] - steady)[:4].max() > 1e-2 * moving.system.scale[:4].max()
    )  # a history it is


def test_the_ledger_has_the_work_of_a_load_that_moves():
    moving = driven(5e-4)
    times = np.linspace(0.0, 5e-4, 51)
    problem = InitialValueProblem(
        rates=moving.system, y=moving.initial(), atol=1e-9 * moving.system.scale
    )
    run = integrate(problem, get_model("integrator", "rk45"), times, rtol=1e-9)
    works = moving.works(run.y)
    split = moving.split(run.y)
    assert np.abs(moving.energy_residual(run.y)).max() < 1e-7 * max(
        np.abs(work).max() for work in works.values()
    )
    assert (
        np.abs(moving.momentum_residual(run.y)).max()
        < 1e-9 * np.abs(moving.angular_momentum(run.y)).max()
    )
    now = moving.history.at(times)
    along = np.cos(now["load_direction"])
    across = np.sin(now["load_direction"])
    power = now["radial_load"] * (split["inner_ring_vx"] * along + split["inner_ring_vy"] * across)
    assert works["work_load"][-1] == pytest.approx(np.trapezoid(power, times), rel=2e-3)


@pytest.mark.parametrize("angle", [2 * np.pi / 5, -4 * np.pi / 5])  # so that rollers start alike
def test_a_load_in_another_direction_moves_the_bearing_turned_by_it(angle):
    scene = scene_of(5, "inner", cage=(("unbalance", 2e-4),))
    step = {"shape": "step", "from": f"{angle} rad", "to": f"{angle} rad", "at": 1.0}
    turned = along_history(scene, 1.0, {"load_direction": step}, gravity=0.0)
    plain = motion(scene, gravity=0.0)
    y = random_state(plain, 3)
    c = np.cos(angle)
    s = np.sin(angle)

    def rotated(y, turn):
        y = y.copy()
        for k in (0, 2, 4, 6):  # places and speeds of ring and cage, or their rates
            y[k : k + 2] = c * y[k] - s * y[k + 1], s * y[k] + c * y[k + 1]
        y[9] += turn
        return y

    expected = rotated(plain.system.rates(0.0, y), 0.0)
    behind = np.zeros(turned.system.n - y.size)  # what each roller does
    found = turned.system.rates(0.0, np.append(rotated(y, angle), behind))[: y.size]
    assert np.all(np.abs(found - expected) <= 1e-9 * yardstick(plain, y, expected))
    assert turned.initial()[:2] == pytest.approx(
        rotated(plain.initial(), 0.0)[:2], rel=1e-9, abs=1e-15
    )


# Closed solutions ----------------------------------------------------------------------------------------------------


def rollers_alone(damping=0.0, coefficient=0.0, transition=0.1):
    """Three straight rollers that touch neither the inner ring nor their pockets, nor feel a load."""
    more = ("bearing.radial_clearance", "2 mm"), ("bearing.profile", "none")
    scene = scene_of(3, cage=(("pocket_clearance", 1.0),), more=more)
    given = {"gravity": 0.0, "contact_damping": damping, "inner_ring_mass": 1e12}
    planar = motion(scene, coefficient=coefficient, transition=transition, **given)
    y = np.zeros(planar.system.n)
    planar.parts(y)[1][:, 3] = -5e-4
    return planar, planar.system, y


def impact(damping, speed):
    """Largest approach, duration and speed of parting of a roller thrown at the outer ring."""
    planar, system, y = rollers_alone(damping)
    at = len(HEAD) + 3
    y[at] = 0.0
    y[at + 1] = speed

    def parts(t, y):
        return y[at] if t > 0 else 1.0

    def deepest(t, y):
        return y[at + 1]

    parts.terminal = True
    found = solve_ivp(
        system, (0.0, 1e-3), y, method="DOP853", rtol=1e-12, atol=1e-14 * system.scale, max_step=2e-6,
        events=(parts, deepest),
    )  # fmt: skip
    depth = found.y_events[1][0, at]
    force = (
        1e9 * planar.assembly.deflect(np.array([1e-6]), "outer")[0][0] * planar.assembly.widths[0]
    )
    return depth, found.t_events[0][0], -found.y_events[0][0, at + 1], force / 1e9, planar, found


def test_an_impact_takes_the_depth_and_the_time_of_its_closed_solution():
    # w = K d^n between straight parts: m v0^2/2 = K d^(n+1)/(n+1) and
    # T = 2 int_0^d dx/v = (2 d/v0) sqrt(pi) Gamma(1 + 1/(n+1))/Gamma(1/2 + 1/(n+1))      [Johnson 1985, eq. 11.23 ff.]
    speed = 0.1
    n = 10 / 9
    depth, duration, rebound, at_a_micrometre, planar, _ = impact(0.0, speed)
    m = planar.assembly.roller_mass
    K = at_a_micrometre / 1e-6**n
    expected = ((n + 1) * m * speed**2 / (2 * K)) ** (1 / (n + 1))
    assert depth == pytest.approx(expected, rel=1e-9)
    p = 1 / (n + 1)
    assert duration == pytest.approx(
        2 * expected / speed * np.sqrt(np.pi) * gamma(1 + p) / gamma(0.5 + p), rel=1e-9
    )
    assert rebound == pytest.approx(speed, rel=1e-9)


@pytest.mark.parametrize("damping", [0.3, 5.0])
def test_an_impact_with_damping_parts_at_the_speed_of_its_closed_solution(damping):
    # in: m v dv/dd = -w (1 + c v); out, at speed u: m u du/dd = -w/(1 + c u); the same elastic work W both ways:
    # W/m = v0/c - ln(1 + c v0)/c^2 = u^2/2 + c u^3/3
    speed = 0.2
    _, _, rebound, _, planar, found = impact(damping, speed)
    c = damping
    work = speed / c - np.log1p(c * speed) / c**2
    assert rebound**2 / 2 + c * rebound**3 / 3 == pytest.approx(work, rel=1e-8)
    lost = planar.parts(found.y_events[0][0])[2][list(LEDGER).index("lost_damping")]
    assert lost == pytest.approx(
        planar.assembly.roller_mass / 2 * (speed**2 - rebound**2), rel=1e-8
    )
    assert rebound < speed


def test_a_roller_thrown_round_slides_until_it_rolls():
    # The disc that is thrown without spin, on the inside of a ring: N = m a w^2, so w' = -mu w^2 and J s' = mu N r:
    # w = w0/(1 + mu w0 t), r s = 2 a (w0 - w). From t = 1/(2 mu w0) on it rolls, at w = 2/3 w0; a third of its energy
    # is gone.
    mu = 0.1
    w0 = 300.0
    planar, system, y = rollers_alone(coefficient=mu, transition=1e-2)
    k = planar.assembly.kinematics
    m = planar.assembly.roller_mass
    a = k.outer_radius - k.roller_radius
    rollers = planar.parts(y)[1]
    rollers[:, 1] = w0
    force = m * a * w0**2
    approach = np.geomspace(1e-9, 1e-4, 4001)
    rollers[:, 3] = np.interp(
        force, planar.assembly.deflect(approach, "outer")[0] * planar.assembly.widths[0], approach
    )
    y[8] = w0  # the cage goes along
    at = len(HEAD)

    def nearly_rolls(t, y):
        return k.roller_radius * y[at + 2] - a * y[at + 1] + 1e-2 * a * w0

    end = 1 / (2 * mu * w0)
    found = solve_ivp(
        system, (0.0, 1.5 * end), y, method="DOP853", rtol=1e-8, atol=1e-9 * system.scale,
        events=nearly_rolls, dense_output=True,
    )  # fmt: skip
    half = planar.parts(found.sol(end / 2))[1][0]
    assert half[1] == pytest.approx(w0 / (1 + mu * w0 * end / 2), rel=1e-4)
    assert k.roller_radius * half[2] == pytest.approx(2 * a * (w0 - half[1]), rel=1e-4)
    slow = (2 + 1e-2) / 3
    assert found.t_events[0][0] == pytest.approx((1 / slow - 1) / (mu * w0), rel=3e-4)
    _, last, ledger = planar.parts(found.y[:, -1])
    assert last[:, 1] == pytest.approx(2 / 3 * w0, rel=1e-4)
    assert k.roller_radius * last[:, 2] == pytest.approx(a * last[:, 1], rel=1e-6)
    assert ledger[list(LEDGER).index("lost_outer")] == pytest.approx(
        3 * m * a**2 * w0**2 / 6, rel=3e-4
    )


def test_three_rollers_move_as_in_an_independent_program():
    # references/planar_exudyn.py: full geometry, bodies in space. What is left are small displacements against the
    # radii, 1e-4, and another smoothing of Coulomb's law at rest; they show most where the third roller parts from the
    # inner ring and floats.
    written = numbers_of(REFERENCES / "planar_exudyn.csv")
    expected = {name: np.array([row[name] for row in written]) for name in written[0]}
    scene = scene_of(3, cage=(("pocket_clearance", 1.0),), more=(("bearing.profile", "none"),))
    planar = motion(scene, coefficient=0.05, transition=1e-3, gravity=0.0, contact_damping=0.0)
    y = np.zeros(planar.system.n)
    y[9] = np.radians(0.5)
    t = expected["t"]
    found = solve_ivp(
        planar.system,
        (0.0, t[-1]),
        y,
        method="DOP853",
        rtol=1e-9,
        atol=1e-10 * planar.system.scale,
        t_eval=t,
    )
    u = planar.split(found.y.T)
    turned = (
        u["cage_angle"][:, None] + u["pocket_position"] / planar.assembly.kinematics.orbit_radius
    )
    ours = {"inner_ring_x": u["inner_ring_x"], "inner_ring_y": u["inner_ring_y"]}
    for j in range(3):
        ours[f"position_{j}"] = turned[:, j]
        expected[f"position_{j}"] -= 2 * np.pi * j / 3
        for name in ("orbital_speed", "roller_spin", "radial_position"):
            ours[f"{name.removeprefix('roller_')}_{j}"] = u[name][:, j]
    assert ours.keys() == expected.keys() - {"t"}
    largest = {kind: max(np.abs(v).max() for n, v in expected.items() if n.startswith(kind))
               for kind in ("inner", "position", "orbital", "spin", "radial")}  # fmt: skip
    assert largest["spin"] > 500
    assert largest["radial"] > 4e-6
    for name, values in ours.items():
        scale = largest[name.split("_")[0]]
        assert (
            np.abs(values - expected[name]).max()
            <= (1e-3 if name == "radial_position_2" else 2e-4) * scale
        ), name


# The land ------------------------------------------------------------------------------------------------------------

#: Viscosity [Pa s], lengths [m], floor of the film as a fraction of the clearance, wall: stiffness [N/m], damping
#: [s/m], friction [1].
LAND = {"eta": 0.0086, "radius": 0.0945, "width": 7.5e-3, "clearance": 2.4e-4, "floor": 1e-3,
        "stiffness": 1e8, "damping": 0.3, "friction": 0.1}  # fmt: skip


def land(D, V, journal, bush, **changes):
    n = LAND | changes
    return kernels.land(
        *np.array(D) * n["clearance"], *V, journal, bush,
        radius=n["radius"], clearance=n["clearance"], film=n["radius"] * n["eta"] * (n["width"] / n["clearance"]) ** 3,
        shear=2 * np.pi * n["eta"] * n["width"] * n["radius"] ** 3 / n["clearance"],
        floor=n["floor"], stiffness=n["stiffness"], damping=n["damping"], friction=n["friction"],
    )  # fmt: skip


def test_a_centred_land_drags_as_petroff_says():
    n = LAND
    model = PetroffLand(
        ring="outer",
        viscosity=n["eta"],
        radius=n["radius"],
        width=n["width"],
        clearance=n["clearance"],
    )
    x, y, journal, bush, stored, lost = land((0.0, 0.0), (0.0, 0.0), 300.0, 50.0)
    assert (x, y, stored) == (0.0, 0.0, 0.0)
    assert journal == pytest.approx(model.torque(300.0, 0.0, 50.0), rel=1e-14)
    assert bush == -journal
    assert lost == pytest.approx(-journal * 250.0, rel=1e-14)


@pytest.mark.parametrize("eps", [1e-6, 0.1, 0.5, 0.9, 0.99])
def test_an_eccentric_land_carries_the_load_of_ocvirk(eps):
    # Ocvirk (1952) for a journal in a bush at rest; F along and across the line of centres, with
    # W = eta U L^3/(4 c^2) eps/(1 - eps^2)^2 sqrt(16 eps^2 + pi^2 (1 - eps^2)), tan(phi) = pi sqrt(1 - eps^2)/(4 eps)
    n = LAND
    w = 300.0
    x, y, *_ = land((eps, 0.0), (0.0, 0.0), w, 0.0)
    load = (
        n["eta"]
        * w
        * n["radius"]
        * n["width"] ** 3
        / (4 * n["clearance"] ** 2)
        * eps
        / (1 - eps**2) ** 2
    )
    assert np.hypot(x, y) == pytest.approx(
        load * np.sqrt(16 * eps**2 + np.pi**2 * (1 - eps**2)), rel=1e-12
    )
    assert -y / x == pytest.approx(np.pi * np.sqrt(1 - eps**2) / (4 * eps), rel=1e-12)
    assert x < 0 < y  # back to the middle, and on in the sense of rotation


def test_a_journal_that_whirls_at_half_its_speed_is_not_carried():
    x, y, *_ = land((0.4, 0.0), (0.0, 0.4 * LAND["clearance"] * 150.0), 300.0, 0.0)
    assert np.hypot(x, y) < 1e-12 * np.hypot(*land((0.4, 0.0), (0.0, 0.0), 300.0, 0.0)[:2])


def test_a_centred_journal_is_damped_alike_in_every_direction():
    # half-circle of int cos^2 = pi/2: F = -R eta (L/c)^3 V pi/2
    n = LAND
    for angle in np.linspace(0.0, 6.0, 7):
        V = 0.03 * np.array([np.cos(angle), np.sin(angle)])
        x, y, *_ = land((0.0, 0.0), V, 100.0, -100.0)
        expected = -n["radius"] * n["eta"] * (n["width"] / n["clearance"]) ** 3 * np.pi / 2 * V
        assert [x, y] == pytest.approx(expected, rel=1e-13, abs=1e-13 * np.abs(expected).max())


@given(
    eps=st.floats(1e-3, 0.97),
    angle=st.floats(-7.0, 7.0),
    speed=st.floats(1e-4, 1.0),
    towards=st.floats(-7.0, 7.0),
    journal=st.floats(-700.0, 700.0),
    bush=st.floats(-700.0, 700.0),
)
def test_the_films_force_and_torques_are_those_of_its_pressure(
    eps, angle, speed, towards, journal, bush
):
    D = eps * np.array([np.cos(angle), np.sin(angle)])
    V = speed * np.array([np.cos(towards), np.sin(towards)])
    found = np.array(land(D, V, journal, bush))
    expected = np.array(land_by_quadrature(D * LAND["clearance"], V, journal, bush, LAND))
    scale = np.abs(expected)
    scale[:2] = np.hypot(*expected[:2])
    scale[2:4] = scale[2:4].max()
    assert np.all(np.abs(found - expected) <= 1e-11 * scale + 1e-14)


def test_a_land_stays_finite_and_one_function_beyond_its_clearance():
    at = np.linspace(0.9, 1.1, 2001)
    found = np.array([land((e, 0.0), (0.02, 0.01), 300.0, 0.0) for e in at])
    assert np.all(np.isfinite(found))
    steps = np.abs(np.diff(found, axis=0)).max(axis=0)
    assert np.all(steps <= 0.15 * np.abs(found).max(axis=0))
    assert found[-1, 0] < -LAND["stiffness"] * 0.09 * LAND["clearance"]
    # a bearing's floor of the film: no gap is thinner than it
    film = np.array([land((e, 0.0), (0.02, 0.0), 0.0, 0.0, stiffness=1e-9)[0] for e in (1.0, 1.5)])
    assert 1.0 <= film[1] / film[0] < 3.0


@pytest.mark.parametrize("seed", range(6))
def test_a_land_that_rubs_is_that_of_the_written_law(seed):
    rng = np.random.default_rng(seed)
    angle = rng.uniform(0, 6)
    over = rng.uniform(1.0, 1.05)
    D = over * np.array([np.cos(angle), np.sin(angle)])
    V = rng.normal(0, 0.2, 2)
    found = np.array(land(D, V, 300.0, -20.0))
    expected = np.array(
        land_by_quadrature(D * LAND["clearance"], V, 300.0, -20.0, LAND | {"eta": 0.0})
    )
    film = np.array(land(D, V, 300.0, -20.0, stiffness=1e-30))
    assert found - film == pytest.approx(expected, rel=1e-10, abs=1e-10 * np.abs(found).max())


# The table of rolling resistance -----------------------------------------------------------------------------------


def test_rolling_resistance_is_read_off_every_cell_and_beyond_along_the_last(monkeypatch):
    """Nodes that bend in every cell, unlike those of a bearing, where a neighbour's line is hardly off."""
    nodes = np.array([0.0, 2.0, 3.0, 7.0, 5.0])
    states = np.array([random_state(case("constant")[0], seed) for seed in range(8)])
    for ring in range(2):
        root = np.sqrt(
            case("constant")[0].planar.outputs(np.zeros(8), states)["normal_force"][:, ring]
        )
        step = (
            0.7 * root.max() / (nodes.size - 1)
        )  # so that a part of the forces is beyond the table
        monkeypatch.setattr(
            planar_module, "_resistances", lambda a, most, step=step: [(step, nodes)] * 2
        )
        found = motion(scene_of(5)).planar.outputs(np.zeros(8), states)
        assert np.sqrt(found["normal_force"][:, ring]) == pytest.approx(root, rel=1e-15)
        place = root / step
        assert {*np.floor(place).astype(int).ravel()} >= set(
            range(nodes.size)
        )  # each cell, and beyond
        line = nodes[-1] + (place - (nodes.size - 1)) * (nodes[-1] - nodes[-2])
        expected = np.where(
            place > nodes.size - 1, line, np.interp(place, np.arange(nodes.size), nodes)
        )
        u = found["rolling_speed"][:, ring]
        sign = u / np.hypot(
            u, 1e-3
        )  # which goes through zero within 1 mm/s, as that of all friction in motion
        assert found["rolling_resistance"][:, ring] == pytest.approx(
            expected * sign, rel=1e-13, abs=1e-13
        )


# In motion -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name", ["constant", "effective, inner land", "conventional, mirrored, clearance"]
)
def test_the_ledger_closes_over_a_run(name):
    planar, system, _ = case(name)
    y = planar.initial(cage_slip=0.2)
    y[2:4] += 0.01
    found = solve_ivp(
        system,
        (0.0, 4e-4),
        y,
        method="DOP853",
        rtol=1e-11,
        atol=1e-12 * system.scale,
        max_step=4e-6,
    )
    states = found.y.T
    gained = planar.energy(states) - planar.energy(y)
    turned = np.abs(planar.parts(states)[2]).max()
    assert gained == pytest.approx(
        sum(planar.works(states).values()), abs=1e-9 * max(turned, planar.energy(y))
    )
    momentum = planar.angular_momentum(states) - planar.angular_momentum(y)
    assert momentum == pytest.approx(
        planar.impulse(states), abs=1e-9 * abs(planar.angular_momentum(y))
    )
    lost = planar.parts(states)[2][:, [name.startswith("lost") for name in LEDGER]]
    assert np.all(np.diff(lost, axis=0) >= -1e-12 * turned)


def stepped(planar, end, rtol=1e-5, scale=None, count=401):
    """Instants, states and steps of a run with the integrator that studies use."""
    scale = planar.system.scale if scale is None else scale
    t = np.linspace(0.0, end, count)
    y = np.empty((count, planar.system.n))
    solver = Rosenbrock(planar.system.capsule, 0.0, planar.initial(), end, rtol, rtol * scale)
    assert solver.advance(t_out=t, y_out=y) == ("finished", count), solver.message
    return t, y, solver.steps


def test_rollers_hold_their_cage():
    # Three orbits from the middle of the play: it falls upon the rollers and goes round with them. A roller's place
    # along the radius is rho - x_c.e, so that one of two neighbours bounds |x_c| cos(pi/Z) by half the play, its own
    # deflection and the depth of the bar, which holds a weight of 4 N with 0.1 um, and its impacts with a few.
    play = 1e-4
    rollers = 10
    scene = scene_of(
        rollers,
        drag=("constant-torque", "pocket-friction"),
        cage=(("pocket_radial_clearance", play),),
        more=(("accuracy.slices", 3),),
    )
    planar = motion(scene)
    t, y, _ = stepped(planar, 0.062, count=4001)
    u = planar.split(y)
    done = planar.outputs(t, y)
    assert u["cage_angle"][-1] > 2 * np.pi * 2.9
    away = np.hypot(u["cage_x"], u["cage_y"])
    assert away[0] == 0.0
    reach = play / 2 + np.abs(u["radial_position"]).max() + 4e-6
    assert 0.9 * play / 2 < away.max() < reach / np.cos(np.pi / rollers)
    assert 4.0 < np.abs(done["pocket_radial_force"]).max() < 500.0
    turned = np.abs(planar.parts(y)[2]).max()
    assert np.abs(planar.energy_residual(y)).max() <= 1e-5 * turned


def test_motion_along_the_radius_is_as_exact_as_it_need_be():
    # the scale of it, 30 deflections: against a run held to 1e-9, and with the steps that one deflection would take
    planar = motion(scene_of(drag=("constant-torque",), more=(("accuracy.slices", 5),)))
    fine = planar.system.scale
    tight = planar.system.scale
    planar.parts(tight)[1][:, 3:] /= 30
    t, exact, _ = stepped(planar, 6e-3, 1e-9)
    runs = [stepped(planar, 6e-3, 1e-5, scale)[1:] for scale in (fine, tight)]
    assert runs[0][1] < 0.6 * runs[1][1]
    force = planar.outputs(t, exact)["normal_force"]
    assert np.abs(planar.outputs(t, runs[0][0])["normal_force"] - force).max() <= 1e-3 * force.max()
    for name in ("cage_speed", "cage_x", "pocket_position", "roller_spin"):
        expected = planar.split(exact)[name]
        assert np.abs(planar.split(runs[0][0])[name] - expected).max() <= 2e-3 * np.ptp(expected), (
            name
        )


def test_a_mirrored_bearing_moves_as_its_image():
    """Both rings the other way, gravity mirrored: in the mirror's coordinates the same motion."""
    ways = [(("operation.inner_speed", speed),) for speed in ("6371 rpm", "-6371 rpm")]
    scenes = [
        scene_of(5, "inner", ("constant-torque",), (("unbalance", 1e-3),), way) for way in ways
    ]
    found = []
    for scene, sign in zip(scenes, (1, -1), strict=True):
        planar = motion(scene, "conventional", gravity_direction=sign * 0.7)
        y = random_state(planar, 3)
        found.append(planar.system.rates(0.0, y))
    assert found[1] == pytest.approx(found[0], rel=1e-12, abs=1e-12)


def test_a_drag_of_the_land_is_its_film():
    with_drag = motion(scene_of(5, "outer", ("petroff-land", "constant-torque")))
    without = motion(scene_of(5, "outer", ("constant-torque",)))
    y = random_state(without, 1)
    assert np.all(with_drag.system.rates(0.0, y) == without.system.rates(0.0, y))


# Tables in place of slices -------------------------------------------------------------------------------------------

TABULATED = (
    "constant",
    "effective, inner land",
    "conventional, resisting",
    "conventional, mirrored, clearance",
)


@functools.cache
def both(name, seed):
    """A state, the motion with tables and that of the slices, and the rates of both."""
    scene, more = CASES[name]
    sliced = case(name)[0]
    tabulated = motion(scene, name.split(",")[0], tabulated=True, **more)
    start = sliced.initial(0.05, 0.1)
    y = start + 0.15 * (random_state(sliced, seed) - start)  # within the tables, as motions are
    return y, tabulated, sliced, tabulated.system.rates(0.3, y), sliced.system.rates(0.3, y)


@pytest.mark.parametrize("name", TABULATED)
@pytest.mark.parametrize("seed", range(4))
def test_rates_by_tables_are_those_of_the_slices_to_their_error(name, seed):
    y, tabulated, sliced, found, expected = both(name, seed)
    assert len(tabulated.forces) == 2
    error = max(table.error for table in tabulated.forces)
    error += max((table.error for table in tabulated.friction.friction_tables), default=0.0)
    done, true = (one.outputs(np.zeros(1), y[None]) for one in (tabulated, sliced))
    size = yardstick(sliced, y, expected)
    # tractions of both rings nearly balance
    torque = sliced.assembly.kinematics.outer_radius * np.abs(true["traction_force"]).sum()
    size[-4:] = np.maximum(size[-4:], torque)
    orbits = sliced.parts(size)[1][:, 1]
    orbits[:] = np.maximum(
        orbits, torque / (sliced.assembly.roller_mass * sliced.assembly.kinematics.orbit_radius**2)
    )
    # the error is known half-way between nodes and at random contacts: elsewhere it may be some times that
    assert np.all(np.abs(found - expected) <= 3.0 * error * size)
    assert np.any(found != expected)
    light = max(table.light for table in tabulated.forces)
    wrong = np.abs(done["normal_force"] - true["normal_force"]) / np.maximum(
        true["normal_force"], light
    )
    assert wrong.max() <= 3.0 * max(table.error for table in tabulated.forces)
    assert np.array_equal(done["normal_force"] == 0.0, true["normal_force"] == 0.0)


@pytest.mark.quick
@pytest.mark.parametrize("ring", RINGS)
def test_the_error_of_a_table_of_forces_is_that_against_all_slices(ring):
    """At random gaps, evenly over the root of the deepest, by the deflection law itself."""
    planar = motion(scene_of(5), tabulated=True)
    a = planar.assembly
    table = planar.forces[RINGS.index(ring)]
    gap = table.deepest * np.random.default_rng(4).uniform(size=20_000) ** 2
    true = a.deflect(gap[:, None] - (a.drop - a.drop.min()), ring)[0] @ a.widths
    cells = len(table.coefficients)
    place = np.sqrt(gap / table.deepest) * cells
    cell = np.minimum(place.astype(int), cells - 1)
    found = np.polynomial.polynomial.polyval(place - cell, table.coefficients[cell].T, tensor=False)
    wrong = np.abs(found - true) / np.maximum(true, table.light)
    assert 0.1 * table.error < wrong.max() < 1.5 * table.error <= 1.5 * 3e-5
    usual = a.scene.operation.radial_load / 5 + a.centrifugal_force + 0.1
    assert table.light == pytest.approx(0.01 * usual, rel=1e-12)


@pytest.mark.quick
def test_beyond_a_table_of_forces_the_slices_are_asked():
    tabulated, sliced = (motion(scene_of(5), tabulated=yes) for yes in (True, False))
    y = random_state(sliced, 1)
    deepest = tabulated.forces[0].deepest
    _, rollers, _ = sliced.parts(y)
    rollers[:, 3] = 0.5 * deepest
    within = tabulated.system.rates(0.0, y), sliced.system.rates(0.0, y)
    assert np.any(within[0] != within[1])
    rollers[2, 3] = 1.01 * deepest + min(sliced.assembly.drop)
    assert tabulated.planar.deflections_evaluated == 0
    forces = [one.outputs(np.zeros(1), y[None])["normal_force"][0] for one in (tabulated, sliced)]
    assert np.array_equal(forces[0][1], forces[1][1])
    assert np.any(forces[0][0] != forces[1][0])
    assert tabulated.planar.deflections_evaluated > 0


def test_a_force_that_few_cells_do_not_tell_comes_from_the_slices(monkeypatch):
    monkeypatch.setattr(planar_module, "_MAX_CELLS", 1024)
    scene = scene_of.__wrapped__(5)  # of its own: tables are kept with the bearing
    rough, sliced = (motion(scene, tabulated=yes) for yes in (True, False))
    assert rough.forces == ()
    assert "from every slice" in rough.evaluation_method
    y = random_state(sliced, 3)
    np.testing.assert_array_equal(rough.system.rates(0.0, y), sliced.system.rates(0.0, y))


def test_film_and_stored_friction_are_those_of_the_slices():
    y, tabulated, sliced, *_ = both("conventional, resisting", 2)
    done, true = (one.outputs(np.zeros(1), y[None]) for one in (tabulated, sliced))
    for name in ("traction_force", "film_parameter", "rolling_resistance"):
        np.testing.assert_array_equal(done[name], true[name])


def test_rates_do_not_depend_on_what_was_asked_before():
    """Of the same state the same bits, whatever roller leans on its bar or leaves a table in between."""
    _, tabulated, _, _, _ = both("conventional, resisting", 0)
    states = [random_state(tabulated, seed) for seed in range(4)]
    first = [tabulated.system.rates(0.3, y) for y in states]
    again = [tabulated.system.rates(0.3, y) for y in reversed(states)]
    assert all(np.array_equal(*pair) for pair in zip(first, reversed(again), strict=True))


@pytest.mark.parametrize("name", CASES)
def test_all_rates_at_once_are_the_sums_of_their_parts(name):
    """The Jacobian by differences goes by the parts, with these increments, and all else by the rates at once."""
    planar, system, _ = case(name)
    y = random_state(planar, 2)
    jacobian = system.jacobian(0.3, y)
    rounding = 1e-12 * yardstick(planar, y, system.rates(0.3, y))
    for k in range(len(HEAD) + 2 * len(ROLLER)):
        by = 2.0**-17 * max(abs(y[k]), system.scale[k])
        ahead = y.copy()
        behind = y.copy()
        ahead[k] += by
        behind[k] -= by
        slope = (system.rates(0.3, ahead) - system.rates(0.3, behind)) / (ahead[k] - behind[k])
        assert np.all(np.abs(slope - jacobian[:, k]) <= rounding / by)


# Bad input -----------------------------------------------------------------------------------------------------------


def test_what_tilts_is_refused():
    tilted = scene_of(5, more=(("operation.misalignment", "1 mrad"),))
    with pytest.raises(DomainError, match=r"operation\.misalignment is 0\.001 rad.*level 'pocket'"):
        motion(tilted)
    table = {"shape": "table", "position": ["-7.5 mm", "7.5 mm"], "drop": ["0 um", "3 um"]}
    with pytest.raises(DomainError, match=r"bearing\.profile the same to both"):
        motion(scene_of.__wrapped__(5, more=(("bearing.profile", table),)))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"inner_ring_mass": 0.0}, "inner_ring_mass: must be above 0"),
        ({"contact_damping": -1.0}, "contact_damping: must be at least 0"),
    ],
)
def test_settings_that_cannot_be_are_refused(given, message):
    with pytest.raises(FieldError, match=message):
        PlanarSettings(**{"inner_ring_mass": 3.0} | given)


def test_a_contact_that_its_law_refuses_says_which():
    planar = motion(scene_of(5, more=(("models.contact", "lundberg"),)))
    system = planar.system
    y = planar.initial()
    y[len(HEAD) + 3] = 1.0  # a metre deep
    with pytest.raises(ArithmeticError):
        system.rates(0.0, y)
    who, (what, stage, member, index) = planar.planar.refusal()
    assert (who, what, stage, member, index) == ("outer deflection", "status", 0, "", 0)
    with pytest.raises(
        DomainError, match="lundberg-deflection: slice 0 is outside its domain"
    ) as caught:
        planar.outputs(np.zeros(1), y[None])
    assert caught.value.__notes__ == ["in a contact with the outer ring"]
    with pytest.raises(DomainError, match="lundberg-deflection"):
        raise planar.error(planar.system.refusal())


@pytest.mark.parametrize(("body", "at"), [("inner ring", 0), ("cage", 4)])
def test_what_is_no_small_displacement_is_refused(body, at):
    scene = scene_of(
        5, cage=(("pocket_clearance", 1.0),), more=(("bearing.radial_clearance", "2 mm"),)
    )
    planar = motion(scene, gravity=0.0)
    limit = planar.assembly.kinematics.roller_radius / 10
    y = np.zeros(planar.system.n)
    y[at : at + 2] = -0.5 * limit, 0.8 * limit
    planar.system.watch(0.0, y)
    y[at + 3] = 10.0  # upwards and out
    solver = Rosenbrock(planar.system.capsule, 0.0, y, 1.0, 1e-6, 1e-6 * planar.system.scale)
    assert solver.advance()[0] == "failed"
    assert "not defined" in solver.message
    assert np.hypot(*solver.y[at : at + 2]) > limit
    words = f"the {body} is displaced by 0.00[0-9]+ m, beyond what small displacements describe .*0.00075 m"
    with pytest.raises(DomainError, match=words):
        raise planar.error(planar.system.refusal())
    with pytest.raises(RefusedError):
        planar.system.watch(solver.t, solver.y)


@pytest.mark.parametrize(
    ("table", "expected"),
    [
        ({}, 0.225e-3),
        ({"pocket_clearance": "0.3 mm"}, 3e-4),
        ({"pocket_clearance": "0.3 mm", "pocket_radial_clearance": "0 mm"}, 0.0),
        ({"guidance": "inner"}, None),
    ],
)
def test_the_play_along_the_radius_is_that_along_the_orbit_unless_given(table, expected):
    cage = assemble(evolve(load_scene("1032930-50C"), {"cage": {**CAGE, **table}}, si=True)).cage
    assert cage.pocket_radial_clearance == (expected and pytest.approx(expected, rel=1e-12))


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (
            {"guidance": "outer", "pocket_radial_clearance": "0.1 mm"},
            "cage.pocket_radial_clearance: only read for guidance = 'roller', not for 'outer'",
        ),
        (
            {"pocket_radial_clearance": "-0.1 mm"},
            "cage.pocket_radial_clearance: must be at least 0, not -0.1 mm",
        ),
        ({"pocket_radial_clearance": "0.1"}, "cage.pocket_radial_clearance: '0.1' has no unit"),
    ],
)
def test_a_play_that_cannot_be_is_refused(table, message):
    with pytest.raises(SceneError) as caught:
        _ = assemble(evolve(load_scene("1032930-50C"), {"cage": {**CAGE, **table}}, si=True)).cage
    (found,) = caught.value.problems
    assert message in found


def test_friction_that_is_refused_says_where():
    planar = motion(scene_of(5), "conventional")
    y = planar.initial()
    planar.parts(y)[1][:, 3] = 1.0  # pressures beyond what the oil's law can hold
    with pytest.raises(ArithmeticError):
        planar.system.rates(0.0, y)
    with pytest.raises(DomainError, match="film_viscosity that is not finite") as caught:
        raise planar.error(planar.system.refusal())
    assert caught.value.__notes__ == ["in a contact with the outer ring"]


def test_an_approach_of_the_inner_ring_is_told_whichever_roller_carried_it_before():
    planar = motion(scene_of(6, more=(("bearing.radial_clearance", "40 um"),)))
    b = planar.assembly.scene.bearing
    rng = np.random.default_rng(8)
    orbit = planar.assembly.kinematics.orbit_radius
    signs = []
    for seed in range(40):
        y = random_state(planar, seed)
        head, rollers, _ = planar.parts(y)
        place = rng.uniform(0.0, 2.0 * np.pi)
        head[:2] = rng.uniform(5e-6, 4e-5) * np.array([np.cos(place), np.sin(place)])
        angle = head[8 + 1] + 2.0 * np.pi * np.arange(6) / 6 + rollers[:, 0] / orbit
        gap = head[0] * np.cos(angle) + head[1] * np.sin(angle) - rollers[:, 3]
        most = (gap - b.radial_clearance / 2 - min(planar.assembly.drop)).max()
        told = planar.system.watch(0.0, y)[2]
        assert (told > 0.0) == (most > 0.0)
        assert told > 0.0 or told == pytest.approx(most, abs=1e-12)
        signs.append(most > 0.0)
    assert 5 < sum(signs) < 35


def test_typical_speeds_are_those_of_a_roller_that_swings_by_a_typical_deflection():
    """Its energy is the work of the force on it over the deflection; scales of tolerances follow from both."""
    bearing = assemble(load_scene("1032930-70C"))
    scale = planar_module._scale(bearing, bearing.cage, None)
    length, speed = scale[[0, 2]]
    load = bearing.scene.operation.radial_load / bearing.scene.bearing.rollers
    force = max(load, bearing.centrifugal_force, 1.0)
    assert bearing.roller_mass * speed**2 == pytest.approx(force * length)
    deflected = bearing.deflect(np.array([length]), "outer")[0]
    assert float(deflected[0].mean()) * bearing.scene.bearing.roller_length == pytest.approx(
        force, rel=0.02
    )
