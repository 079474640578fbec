"""Rollers carried round: the compiled rates against their equations in NumPy, their ledger, and a first motion."""

import math
from types import MappingProxyType

import attrs
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicHermiteSpline

from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.bearing.chain import Chain
from rollslip.catalogue.registry import get_model
from rollslip.errors import ConvergenceError, DomainError
from rollslip.structure import Location, structure
from rollslip_kernels.motion import raceway as compiled
from rollslip_kernels.motion.carried import LEDGER
from rollslip_kernels.motion.system import RefusedError
from rollslip_kernels.slices import Slices
from rollslip_kernels.stages import drag
from rollslip_studies.dynamics.history.settings import HistorySettings
from rollslip_studies.dynamics.history.varying import varying_motion
from rollslip_studies.dynamics.levels import raceway_friction as friction_module
from rollslip_studies.dynamics.levels.cage_and_rollers import carried_motion
from rollslip_studies.dynamics.levels.load_map import build_load_map
from rollslip_studies.dynamics.levels.raceway_friction import FrictionSettings, raceway_friction
from rollslip_studies.motion.time_integration import InitialValueProblem, integrate
from strategies import NumpyForm

#: Few slices for short tests; mass [kg] and inertia [kg m2] are those of the shipped cage.
FAST = {"accuracy.slices": 5, "accuracy.tolerance": 2e-2, "cage.mass": 0.4, "cage.inertia": 3.3e-3}
#: A drag of rollers that roll and one of their pockets.
DRAGS = ["rolling-resistance", {"model": "pocket-friction", "coefficient": 0.08}]
MANY = {"accuracy.slices": 15}  # enough for a table of friction
KINDS = ["constant", "effective", "conventional"]
LEVELS = ["cage-set", "pocket"]
CONVENTIONAL = FrictionSettings(name="conventional", tabulated=False)


def bearing(**changes):
    return assemble(evolve(load_scene("1032930-50C"), FAST | changes, si=True))


MADE = {}


def motion(
    level,
    kind,
    drags=DRAGS,
    torque=0.03,
    critical_slip=math.nan,
    film_limit=math.nan,
    tabulated=False,
    **changes,
):
    """The motion of the scene, tables and loads made once; ``torque`` [N m] against the cage.

    Conventional friction is that of the slices, unless it may be ``tabulated``.
    """
    key = (str(sorted(changes.items())), str(drags))
    if key not in MADE:
        assembly = bearing(**changes | ({"cage.drag": drags} if drags else {}))
        MADE[key] = assembly, build_load_map(assembly.with_resistance(), 2e-2)
    assembly, loads = MADE[key]
    return carried_motion(
        assembly,
        FrictionSettings(
            name=kind,
            tabulated=tabulated,
            coefficient=0.01,
            transition=0.5,
            critical_slip=critical_slip,
            film_limit=film_limit,
        ),
        level=level,
        loads=loads,
        torques=(drag.constant_torque(torque, 1.0),) if torque else (),
    )


def random_state(m, rng):
    """A state with slips of any size, every roller its own, and some in touch with their pockets."""
    y = m.initial(rng.uniform(-0.2, 1.5), rng.uniform(-0.2, 1.0))
    u = m.split(y)
    k = m.assembly.kinematics
    u["cage_angle"][...] = rng.uniform(-50, 50)
    u["roller_spin"][...] *= rng.uniform(0.5, 1.5, 28)
    if m.level == "pocket":
        u["orbital_speed"][...] += rng.normal(0, 0.02 * abs(k.epicyclic_cage_speed), 28)
        u["pocket_position"][...] = 0.55 * m.assembly.cage.pocket_clearance * rng.uniform(-1, 1, 28)
    for name in LEDGER:
        u[name][...] = rng.normal()
    return y


# The equations, in NumPy ---------------------------------------------------------------------------------------------


def plain_friction(m, ring, load, V, u):
    """Traction and rolling resistance of the rollers on a ring, (Z,) each; load (Z, n) [N/m]."""
    raceway = m.assembly.raceways[ring]
    widths = m.assembly.widths
    film = np.hypot(u, 1e-3)
    if m.friction.settings.name == "conventional":
        traction = np.zeros(28)
        resistance = np.zeros(28)
        for j, one in enumerate(load):
            if np.any(one > 0.0):
                slices = raceway.evaluate(one[one > 0.0], film[j], V[j])
                traction[j] = slices.friction * slices.load @ widths[one > 0.0]
                if raceway.chain.resists:
                    resistance[j] = slices.resistance @ widths[one > 0.0]
        return traction, resistance * u / film
    force = load[:, 0]
    if m.friction.settings.name == "constant":
        return 0.01 * force * V / np.sqrt(V**2 + 0.25), None
    table = m.friction.tables[ring]

    def spline(low, high, nodes, at):
        x = np.linspace(low, high, nodes.shape[0])
        return CubicHermiteSpline(x, nodes[..., 0], nodes[..., 1] / (x[1] - x[0]))(
            np.clip(at, low, high)
        )

    v = V / (np.abs(V) + table.sliding_scale)
    return force * spline(*table.limits, table.nodes, v), None


def rise(d, soft):
    return np.where(d <= -soft, 0.0, np.where(d >= soft, d, (d + soft) ** 2 / (4 * soft)))


def plain_pocket(m, x, rate):
    """Force on the cage, both sides' sum, power lost and power stored, (Z,) each."""
    cage = m.assembly.cage
    r = m.assembly.kinematics.roller_radius
    soft = 0.02 / cage.pocket_stiffness
    h0 = m.assembly.inner.conditions.roughness
    force, normal, lost, stored = np.zeros((4, *np.shape(x)))
    for sign in (1, -1):
        d = sign * x - cage.pocket_clearance / 2
        v = sign * rate
        spring = cage.pocket_stiffness * rise(d, soft)
        z = cage.pocket_damping * v
        damped = spring * np.where(z > 0, z, z / (1 - np.minimum(z, 0)))
        if cage.pocket_contact == "film":
            h = h0 + rise(-d - h0, h0)
            viscosity = m.assembly.lubricant.at(m.assembly.scene.operation.temperature).viscosity
            squeeze = 3 * np.sqrt(2) * np.pi * viscosity * 0.015 * (r / h) ** 1.5
            damped = damped + squeeze * np.maximum(v, 0) ** 2 / (np.maximum(v, 0) + 1e-4)
        force = force + sign * (spring + damped)
        normal = normal + spring + damped
        lost = lost + damped * v
        stored = stored + spring * v
    return force, normal, lost, stored


def plain_rates(m, y, torque=0.03, operation=None):
    """The rates, and the power stored in the pockets; at other ring speeds and another direction of the load."""
    a = m.assembly
    k = m.assembly.kinematics
    u = m.split(y)
    Ri = k.inner_radius
    Ro = k.outer_radius
    r = k.roller_radius
    Rm = k.orbit_radius
    wi, wo, turned = operation or (k.direction * k.inner_speed, k.direction * k.outer_speed, 0.0)
    mass = a.roller_mass
    inertia = a.cage.inertia
    w_c = u["cage_speed"]
    s = u["roller_spin"]
    w = u.get("orbital_speed", np.full(28, w_c))
    x = u.get("pocket_position", np.zeros(28))
    psi = u["cage_angle"] + 2 * np.pi * np.arange(28) / 28 + x / Rm
    loads = np.stack(
        [m.loads.at(psi[[j]] - turned, mass * Rm * w[j] ** 2)[:, 0] for j in range(28)], axis=1
    )
    V = Ri * (wi - w) - r * (s + w), r * (s + w) - Ro * (w - wo)
    roll = (Ri * (wi - w) + r * (s + w)) / 2, (Ro * (w - wo) + r * (s + w)) / 2
    F, R = zip(
        *(plain_friction(m, ring, loads[ring], V[ring], roll[ring]) for ring in (0, 1)), strict=True
    )
    if m.friction.settings.name != "conventional":
        R = [
            loads[2 + i, :, 0] * roll[i] / np.hypot(roll[i], 1e-3) if len(loads) > 2 else 0.0 * w
            for i in (0, 1)
        ]
    spin = r * (F[0] - R[0]) - r * (F[1] + R[1])
    orbital = spin + Ri * (F[0] + R[0]) + Ro * (F[1] - R[1])
    stored = lost = np.zeros(28)
    if m.level == "pocket":
        force, normal, lost, stored = plain_pocket(m, x, Rm * (w - w_c))
    else:
        force = orbital / Rm
        normal = np.abs(orbital / Rm)
    mu = 0.0 if a.cage.drags.pocket_friction is None else a.cage.drags.pocket_friction.coefficient
    slide = r * (s + w_c)
    moment = mu * normal * r * slide / np.hypot(slide, 1e-2)
    T = -torque * w_c / np.hypot(w_c, 1.0)
    total = inertia if m.level == "pocket" else inertia + 28 * mass * Rm**2
    rates = {
        "cage_angle": w_c,
        "cage_speed": (T + (Rm * force - moment).sum()) / total,
        "roller_spin": (spin - moment) / (mass * r**2 / 2),
        "orbital_speed": (orbital - Rm * force) / (mass * Rm**2),
        "pocket_position": Rm * (w - w_c),
        "work_rings": (Ri * wi * (F[0] + R[0]) + Ro * wo * (F[1] - R[1])).sum(),
        "work_drag": T * w_c,
        "lost_inner": (F[0] * V[0]).sum(),
        "lost_outer": (F[1] * V[1]).sum(),
        "lost_rolling": 2 * (R[0] * roll[0] + R[1] * roll[1]).sum(),
        "lost_pockets": (lost + moment * (s + w_c)).sum(),
        "impulse_inner": (Ri * (F[0] + R[0])).sum(),
        "impulse_outer": (Ro * (F[1] - R[1])).sum(),
        "impulse_drag": T,
    }
    return rates, stored.sum()


# Rates ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "changes", [{}, {"cage.pocket_contact": "film"}, {"operation.outer_speed": "9000 rpm"}]
)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("level", LEVELS)
def test_rates_are_those_of_the_equations(level, kind, changes):
    m = motion(level, kind, **changes)
    rng = np.random.default_rng(3)
    for _ in range(3):
        y = random_state(m, rng)
        found = m.split(m.system.rates(0.0, y))
        (expected, _) = plain_rates(m, y)
        for name, rate in found.items():
            size = np.abs(expected[name]).max()
            np.testing.assert_allclose(
                rate, expected[name], rtol=1e-12, atol=1e-12 * size, err_msg=name
            )


@pytest.mark.parametrize("level", LEVELS)
def test_rates_read_the_speeds_of_the_rings_and_the_direction_of_the_load(level):
    m = motion(level, "constant")
    rng = np.random.default_rng(4)
    before = m.carried.operation.copy()
    now = (520.0, -40.0, 2.3)
    y = random_state(m, rng)
    m.carried.operation[:] = now
    found = m.split(m.system.rates(0.0, y))
    (expected, _) = plain_rates(m, y, operation=now)
    m.carried.operation[:] = before
    for name, rate in found.items():
        size = np.abs(expected[name]).max()
        np.testing.assert_allclose(
            rate, expected[name], rtol=1e-12, atol=1e-12 * size, err_msg=name
        )


@pytest.mark.soak
def test_within_pockets_a_bearing_goes_through_a_history_as_another_integration_says():
    """DOP853 of the equations in NumPy to 1e-9, ours to 1e-10, until rollers have touched and left their bars."""
    end = 1.5e-3
    of = bearing(**{"cage.drag": ["constant-torque"], "cage.pocket_clearance": "20 um"})
    raw = {
        "inner_speed": {"shape": "ramp", "to": "4000 rpm", "within": end},
        "load_direction": {"shape": "rotation", "speed": "9000 rpm"},
    }
    settings = structure(HistorySettings, raw, Location({}), [])
    history = settings.history(of.scene, end, Location({}))
    friction = FrictionSettings(name="constant", coefficient=0.01, transition=0.5)
    moving = varying_motion(of, friction, history, level="pocket")
    model = of.cage.drags.torques[0]

    def rates(t, y):
        now = history.at(t)
        m = moving.base
        speeds = float(now["inner_speed"]), 0.0, float(now["load_direction"])
        found, _ = plain_rates(m, y, 0.0, speeds)
        torque = float(model.torque(y[1], speeds[0], 0.0))
        found["cage_speed"] += torque / of.cage.inertia
        found["work_drag"] += torque * y[1]
        found["impulse_drag"] += torque
        parts = [np.broadcast_to(found[name], 28) for name in m.names[1]]
        return np.concatenate(
            (
                [found[name] for name in m.names[0]],
                np.stack(parts, axis=1).ravel(),
                [found[name] for name in m.names[2]],
            )
        )

    times = np.linspace(0.0, end, 7)
    y = moving.initial()
    atol = 1e-10 * moving.system.scale
    theirs = solve_ivp(
        rates, (0.0, end), y, "DOP853", t_eval=times, first_step=1e-6, rtol=1e-9, atol=atol
    )
    problem = InitialValueProblem(rates=moving.system, y=y, atol=atol, breaks=moving.breaks)
    ours = integrate(problem, get_model("integrator", "rk45"), times, rtol=1e-10)
    assert ours.outcome == "finished"
    place = moving.split(ours.y)["pocket_position"]
    assert np.abs(place).max() > 0.5 * of.cage.pocket_clearance
    off = moving.split(np.abs(ours.y - theirs.y.T) / moving.system.scale)
    assert (
        off.pop("pocket_position").max() < 1e-9 / of.cage.pocket_clearance
    )  # 1 nm, where bars are pressed in by 200
    assert max(one.max() for one in off.values()) < 1e-7
    assert (
        np.abs(moving.energy_residual(ours.y)).max()
        < 1e-7 * np.abs(moving.works(ours.y)["work_rings"]).max()
    )


@pytest.mark.parametrize("drags", [DRAGS, ()])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("level", LEVELS)
def test_the_ledger_explains_energy_and_angular_momentum_exactly(level, kind, drags):
    m = motion(level, kind, drags, **{"cage.pocket_contact": "film"})
    rng = np.random.default_rng(11)
    for _ in range(5):
        y = random_state(m, rng)
        u = m.split(y)
        rate = m.split(m.system.rates(0.0, y))
        w, dw = (f.get("orbital_speed", np.full(28, f["cage_speed"])) for f in (u, rate))
        cage = m.assembly.cage.inertia
        orbital = m.orbital_inertia
        # both sides are sums of terms that nearly cancel: measured against the largest
        energy = [cage * u["cage_speed"] * rate["cage_speed"], *(orbital * w * dw)]
        energy += [*(m.spin_inertia * u["roller_spin"] * rate["roller_spin"])]
        if level == "pocket":
            energy.append(plain_pocket(m, u["pocket_position"], rate["pocket_position"])[3].sum())
        given = [rate["work_rings"], rate["work_drag"]]
        given += [
            -rate[name] for name in ("lost_inner", "lost_outer", "lost_rolling", "lost_pockets")
        ]
        assert math.fsum(energy) == pytest.approx(
            math.fsum(given), abs=1e-12 * np.abs(energy + given).max()
        )
        momentum = [
            cage * rate["cage_speed"],
            *(orbital * dw),
            *(-m.spin_inertia * rate["roller_spin"]),
        ]
        given = [rate[name] for name in ("impulse_inner", "impulse_outer", "impulse_drag")]
        assert math.fsum(momentum) == pytest.approx(
            math.fsum(given), abs=1e-12 * np.abs(momentum + given).max()
        )
        # nothing that is lost comes back
        for name in ("lost_inner", "lost_outer", "lost_rolling", "lost_pockets"):
            assert rate[name] >= 0.0


@pytest.mark.quick
def test_energy_and_momentum_are_those_the_rates_change():
    drags = [drag if drag != "rolling-resistance" else "goksem-hargreaves" for drag in DRAGS]
    m = motion("pocket", "conventional", drags)
    rng = np.random.default_rng(2)
    y = random_state(m, rng)
    rate = m.system.rates(0.0, y)
    step = 1e-8
    states = np.stack((y - step * rate, y + step * rate))
    for of, residual in ((m.energy, m.energy_residual), (m.angular_momentum, m.momentum_residual)):
        change = np.diff(of(states))[0]
        assert abs(change) > 1e-8 * abs(of(y))
        assert residual(states)[1] == pytest.approx(0.0, abs=1e-5 * abs(change))


@pytest.mark.quick
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("level", LEVELS)
def test_without_drag_the_epicyclic_motion_stays(level, kind):
    m = motion(level, kind, (), 0.0)
    rate = m.split(m.system.rates(0.0, m.initial()))
    assert rate.pop("cage_angle") == m.assembly.kinematics.epicyclic_cage_speed
    slipping = m.split(m.system.rates(0.0, m.initial(0.1, 0.05)))
    for name, value in rate.items():
        size = np.abs(slipping[name]).max()
        assert np.abs(value).max() <= 1e-11 * (size if size else 1.0), name


@pytest.mark.parametrize("kind", KINDS)
def test_without_load_nothing_but_centrifugal_forces_presses(kind):
    m = motion(
        "cage-set",
        kind,
        (),
        0.0,
        **{"operation.radial_load": "0 N", "bearing.radial_clearance": "20 um"},
    )
    rate = m.split(m.system.rates(0.0, m.initial()))
    assert abs(rate["cage_speed"]) < 1e-9
    y = m.initial(0.1, 0.05)
    found = m.outputs([0.0], y)
    pull = m.assembly.roller_mass * m.assembly.kinematics.orbit_radius * y[1] ** 2
    np.testing.assert_array_equal(found["normal_force"][0, 0], 0.0)
    np.testing.assert_allclose(found["normal_force"][0, 1], pull, rtol=1e-9)
    np.testing.assert_array_equal(found["traction_force"][0, 0], 0.0)
    assert np.all(found["traction_force"][0, 1] > 0.0)  # a cage that lags is pulled along


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("level", LEVELS)
def test_a_mirrored_bearing_moves_in_the_mirror(level, kind):
    speeds = {"operation.inner_speed": "-6371 rpm", "operation.outer_speed": "-500 rpm"}
    there = motion(level, kind, **speeds)
    here = motion(level, kind, **{"operation.outer_speed": "500 rpm"})
    assert (there.direction, here.direction) == (-1, 1)
    y = random_state(here, np.random.default_rng(8))
    np.testing.assert_allclose(
        there.system.rates(0.0, y),
        here.system.rates(0.0, y),
        rtol=1e-9,
        atol=1e-9 * np.abs(y).max(),
    )


@pytest.mark.quick
def test_drags_get_the_real_speeds():
    seen = []
    torque = drag.python_drag(lambda *speeds: seen.append(speeds) or 0.5)
    assembly = bearing(**{"operation.inner_speed": "-6000 rpm"})
    m = carried_motion(
        assembly,
        FrictionSettings(name="constant", coefficient=0.0, transition=1.0),
        level="cage-set",
        torques=[torque],
    )
    y = m.initial()
    rate = m.split(m.system.rates(0.0, y))
    inner = assembly.kinematics.inner_speed
    assert seen == [(-y[1], inner, 0.0)]
    assert inner < 0.0 < y[1]
    assert rate["impulse_drag"] == -0.5


@pytest.mark.parametrize("kind", KINDS)
def test_friction_is_smooth_through_standstill_and_backwards(kind):
    """Rollers whose outer contact stops rolling, and rolls backwards."""
    m = motion("cage-set", kind)
    k = m.assembly.kinematics
    w = k.epicyclic_cage_speed
    stop = -w - k.outer_radius * w / k.roller_radius  # spin at which u_o = 0

    def rates(du):
        y = m.initial()
        m.split(y)["roller_spin"][...] = stop + 2.0 * du / k.roller_radius
        assert m.outputs([0.0], y)["rolling_speed"][0, 1, 0] == pytest.approx(du, abs=1e-12)
        return m.system.rates(0.0, y)

    du = np.array([-10.0, -1.0, -1e-3, -1e-6, 0.0, 1e-6, 1e-3, 1.0, 10.0])
    found = np.array([rates(one) for one in du])
    assert np.all(np.isfinite(found))
    middle = found[3:6]
    assert np.abs(np.diff(middle, axis=0)).max() <= 0.02 * np.abs(middle).max()
    np.testing.assert_allclose(
        middle[0] + middle[2], 2 * middle[1], rtol=1e-5, atol=1e-5 * np.abs(middle).max()
    )
    lost = np.array([m.split(one)["lost_rolling"] for one in found])
    assert np.all(lost >= 0.0)


def test_a_roller_is_moved_by_nothing_but_the_cage_and_itself():
    m = motion("pocket", "conventional")
    rng = np.random.default_rng(4)
    y = random_state(m, rng)
    before = m.system.rates(0.0, y)
    for j in (0, 13):
        other = y.copy()
        other[2 + 3 * j : 5 + 3 * j] += [10.0, 1.0, 1e-6]
        moved = np.flatnonzero(m.system.rates(0.0, other) != before)
        own = set(range(2 + 3 * j, 5 + 3 * j))
        assert own <= set(moved) <= own | {1} | set(range(y.size - len(LEDGER), y.size))


# Pockets -------------------------------------------------------------------------------------------------------------


def pocket_forces(m, x, rate=0.0):
    """Tangential forces of rollers on the cage at places [m] and rates [m/s] within their pockets."""
    states = np.tile(m.initial(), (np.size(x), 1))
    u = m.split(states)
    u["pocket_position"][...] = np.reshape(x, (-1, 1))
    u["orbital_speed"][...] += (
        np.reshape(np.broadcast_to(rate, np.shape(x)), (-1, 1)) / m.assembly.kinematics.orbit_radius
    )
    return m.outputs(np.zeros(np.size(x)), states)["pocket_force"][:, 0]


@pytest.mark.quick
@pytest.mark.parametrize("contact", ["metal", "film"])
@pytest.mark.parametrize("clearance", ["0 mm", "0.2 mm", "5 mm"])
@pytest.mark.parametrize("stiffness", ["5e7 N/m", "1e10 N/m"])
def test_pockets_push_smoothly_and_never_pull(contact, clearance, stiffness):
    changes = {
        "cage.pocket_contact": contact,
        "cage.pocket_clearance": clearance,
        "cage.pocket_stiffness": stiffness,
    }
    m = motion("pocket", "constant", (), 0.0, **changes)
    half = 0.5 * m.assembly.cage.pocket_clearance
    K = m.assembly.cage.pocket_stiffness
    for rate in (-1.0, -1e-3, 0.0, 1e-3, 1.0):
        x = half + np.linspace(-5.0, 5.0, 2001) * 0.02 / K
        force = pocket_forces(m, x, rate)
        if half > 0.0 and (
            contact == "metal" or rate >= 0.0
        ):  # else the film of the other side pushes
            assert np.all(force >= 0.0)
            assert rate < 0.0 or np.all(np.diff(force) >= 0.0)
        # a kink would leave second differences of the size of first ones
        first = np.diff(force)
        assert (
            np.abs(np.diff(first)).max() <= 0.02 * np.abs(first).max() + 1e-9 * np.abs(force).max()
        )
        np.testing.assert_allclose(
            pocket_forces(m, -x, -rate), -force, rtol=0, atol=1e-12 * np.abs(force).max()
        )
    deep = half + np.array([1e-6, 2e-6])
    np.testing.assert_allclose(pocket_forces(m, deep), K * (deep - half), rtol=1e-9)
    assert clearance == "0 mm" or pocket_forces(m, np.array([0.0, 0.4 * half])) == pytest.approx(
        0.0
    )
    energy = m.carried.stored_energy(np.array([half + 1e-6, half + 2e-6]))
    assert np.diff(energy)[0] == pytest.approx(0.5 * K * 3e-12, rel=1e-6)
    # the edge of a pocket is soft over 0.02 m/K: there the energy is the integral of the force, too
    edge = half + np.linspace(0.0 if half == 0.0 else -1.0, 1.0, 20001) * 0.02 / K
    force = pocket_forces(m, edge)
    energy = m.carried.stored_energy(edge)
    work = np.concatenate([[0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(edge))])
    np.testing.assert_allclose(energy - energy[0], work, rtol=0, atol=1e-6 * work[-1])


# Refusals, watched values, outputs ------------------------------------------------------------------------------------


@pytest.mark.quick
def test_a_roller_faster_than_the_loads_is_refused_in_words():
    m = motion("pocket", "constant")
    y = m.initial()
    m.split(y)["orbital_speed"][7] = 5000.0
    with pytest.raises(RefusedError) as caught:
        m.system.rates(0.0, y)
    error = m.error(caught.value.reason)
    assert isinstance(error, DomainError)
    assert "roller 7 is carried round faster than 6371 rpm" in str(error)


def test_loads_that_cannot_be_worked_out_on_the_way_say_so(monkeypatch):
    assembly = bearing()
    m = carried_motion(
        assembly, FrictionSettings(name="conventional", tolerance=2e-2), level="cage-set"
    )
    y = m.initial()
    m.system.rates(0.0, y)  # the loads at the epicyclic speed are there

    def no_equilibrium(*_):
        raise ConvergenceError("no equilibrium")

    monkeypatch.setattr(type(assembly), "load_distribution", no_equilibrium)
    m.loads.orbits.accepted.clear()
    m.loads.orbits.solved.clear()
    m.system.rates(0.0, y)
    with pytest.raises(ConvergenceError, match="no equilibrium"):
        m.system.rates(0.0, m.initial(0.7))


def with_traction(m, model):
    """The same assembly with another last stage."""
    assembly = m.assembly
    chain = Chain(*assembly.inner.chain.models[:-1], model)
    changed = [attrs.evolve(raceway, chain=chain) for raceway in assembly.raceways]
    return attrs.evolve(assembly, inner=changed[0], outer=changed[1])


def test_what_a_stage_refuses_is_said_in_words():
    m = motion("cage-set", "conventional", ())

    class Limited(NumpyForm):
        domain = MappingProxyType({"sliding_speed": (-1.0, 1.0)})

    limited = Limited(m.assembly.traction)
    made = carried_motion(
        with_traction(m, limited), CONVENTIONAL, level="cage-set", loads=m.loads, torques=()
    )
    assert np.all(np.isfinite(made.system.rates(0.0, made.initial())))
    with pytest.raises(RefusedError) as caught:
        made.system.rates(0.0, made.initial(0.3))
    error = made.error(caught.value.reason)
    assert isinstance(error, DomainError)
    assert "sliding_speed = 7.5" in str(error)
    assert error.__notes__ == ["in a contact with the inner ring"]
    with pytest.raises(DomainError, match="sliding_speed"):
        made.outputs([0.0], made.initial(0.3))


@pytest.mark.quick
def test_python_stages_and_python_drags_serve():
    m = motion("cage-set", "conventional", ())
    torque = drag.python_drag(lambda cage, inner, outer: -0.03 * cage / math.hypot(cage, 1.0))
    made = carried_motion(
        with_traction(m, NumpyForm(m.assembly.traction)),
        CONVENTIONAL,
        level="cage-set",
        loads=m.loads,
        torques=(torque,),
    )
    y = random_state(m, np.random.default_rng(6))
    expected = m.system.rates(0.0, y)
    np.testing.assert_allclose(
        made.system.rates(0.0, y), expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max()
    )


@pytest.mark.quick
@pytest.mark.parametrize("where", ["traction", "drag"])
def test_an_error_of_a_plugin_comes_out_as_it_is(where):
    class Broken(NumpyForm):
        def evaluate(self, slices):
            raise ConvergenceError("no root")

    def torque(cage, inner, outer):
        raise ConvergenceError("no root")

    m = motion("cage-set", "conventional", ())
    assembly = with_traction(m, Broken(m.assembly.traction)) if where == "traction" else m.assembly
    torques = (drag.python_drag(torque),) if where == "drag" else ()
    made = carried_motion(assembly, CONVENTIONAL, level="cage-set", loads=m.loads, torques=torques)
    with pytest.raises(ConvergenceError, match="no root"):
        made.system.rates(0.0, made.initial())


def test_slip_and_film_are_watched():
    limit = 1.2
    m = motion("cage-set", "conventional", (), critical_slip=0.2, film_limit=limit)
    assert m.system.watched == 2
    for slip in (0.1, 0.3):
        y = m.initial(slip, 0.01)
        film = m.outputs([0.0], y)["film_parameter"]
        found = m.system.watch(0.0, y)
        assert found[0] == pytest.approx(slip - 0.2, abs=1e-12)
        assert found[1] == pytest.approx(np.nanmin(film) - limit, abs=1e-12)
    never = motion("cage-set", "effective", (), film_limit=limit)
    assert never.system.watched == 1
    assert (
        never.system.watch(0.0, never.initial(0.9))[0]
        == never.system.watch(0.0, never.initial(0.0))[0]
        < 0.0
    )


@pytest.mark.quick
def test_outputs_are_those_of_the_contacts():
    m = motion("cage-set", "conventional")
    rng = np.random.default_rng(9)
    states = np.stack([random_state(m, rng) for _ in range(3)])
    found = m.outputs(np.arange(3.0), states)
    for i, y in enumerate(states):
        u = m.split(y)
        k = m.assembly.kinematics
        psi = u["cage_angle"] + 2 * np.pi * np.arange(28) / 28
        loads = m.loads.at(psi, m.assembly.roller_mass * k.orbit_radius * u["cage_speed"] ** 2)
        for ring, raceway in enumerate(m.assembly.raceways):
            force = loads[ring] @ m.assembly.widths
            np.testing.assert_allclose(
                found["normal_force"][i, ring], force, rtol=1e-10, atol=1e-10 * force.max()
            )
            for j in range(28):
                load = loads[ring, j][loads[ring, j] > 0.0]
                if load.size == 0:
                    assert np.isnan(found["film_parameter"][i, ring, j])
                    continue
                rolling = np.hypot(found["rolling_speed"][i, ring, j], 1e-3)
                slices = raceway.evaluate(load, rolling, found["sliding_speed"][i, ring, j])
                film = slices.film_thickness.min() / raceway.conditions.roughness
                assert found["film_parameter"][i, ring, j] == pytest.approx(film, rel=1e-9)
    assert np.all(
        np.isnan(motion("cage-set", "effective").outputs([0.0], states[0])["film_parameter"])
    )


def test_work_is_counted_in_contacts_and_slices():
    effective = motion("cage-set", "effective", ())
    conventional = motion("cage-set", "conventional", ())
    y = conventional.initial(0.1)
    for m in (effective, conventional):
        m.system.rates(0.0, y)
    assert effective.carried.contacts_evaluated == 56
    loads = conventional.loads.at(
        2 * np.pi * np.arange(28) / 28, conventional.assembly.centrifugal_force * 0.81
    )
    assert conventional.carried.contacts_evaluated == np.count_nonzero(loads)


# Conventional friction from a table ----------------------------------------------------------------------------------


@pytest.mark.parametrize("drags", [("rolling-resistance",), ()])
@pytest.mark.parametrize("level", LEVELS)
def test_rates_by_a_table_of_friction_are_those_of_the_slices_to_its_error(level, drags):
    tabulated, sliced = (
        motion(level, "conventional", drags, tabulated=yes, **MANY) for yes in (True, False)
    )
    assert len(tabulated.friction.friction_tables) == 2
    assert not sliced.friction.friction_tables
    error = max(table.error for table in tabulated.friction.friction_tables)
    assert 0.0 < error <= tabulated.friction.settings.table_tolerance(tabulated.assembly)
    rng = np.random.default_rng(5)
    for _ in range(4):
        y = sliced.initial(rng.uniform(0.0, 0.4), rng.uniform(0.0, 0.1))
        sliced.split(y)["cage_angle"][...] = rng.uniform(0.0, 6.0)
        found = tabulated.system.rates(0.0, y)
        expected = sliced.system.rates(0.0, y)
        true = sliced.outputs([0.0], y)
        # the largest friction coefficient there is times every force, as the error is told
        force = (
            0.02 * true["normal_force"][0].sum() + np.abs(true["rolling_resistance"][0]).max() * 56
        )
        k = sliced.assembly.kinematics
        torque = error * (k.inner_radius + k.outer_radius) * force
        wrong = sliced.split(np.abs(found - expected))
        assert wrong["roller_spin"].max() <= torque / sliced.spin_inertia
        assert wrong["cage_speed"] <= torque / sliced.assembly.cage.inertia
        assert wrong["impulse_inner"] + wrong["impulse_outer"] <= torque
        assert np.any(found != expected)


@pytest.mark.parametrize("ring", [0, 1])
def test_the_error_of_a_table_of_friction_is_that_against_the_chain(ring):
    """At contacts of its own choosing, by the chain of the raceway slice by slice."""
    m = motion("cage-set", "conventional", ("rolling-resistance",), tabulated=True, **MANY)
    a = m.assembly
    table = m.friction.friction_tables[ring]
    rng = np.random.default_rng(8)
    raceway = a.raceways[ring]
    gap = rng.uniform(0.2e-6, 1.5e-6, 28)
    load, _ = a.deflect(gap[:, None] - (a.drop - a.drop.min()), raceway.ring)
    slow, fast = (table.speed_scale * end / (1.0 - end) for end in table.speed_ends)
    V = rng.uniform(-30.0, 30.0, 28)
    u = rng.uniform(slow, fast, 28)
    found = compiled.table_friction(m.friction.capsules[ring], load @ a.widths, V, u)
    expected = plain_friction(
        motion("cage-set", "conventional", ("rolling-resistance",), **MANY), ring, load, V, u
    )
    largest = np.abs(expected[0] / (load @ a.widths)).max()
    assert (
        np.abs(found[0] - expected[0]).max()
        <= 2.0 * table.error * max(largest, 0.01) * (load @ a.widths).max()
    )
    assert (
        np.abs(found[1] - expected[1]).max() <= 2.0 * table.error * 1.5 * np.abs(expected[1]).max()
    )


@pytest.mark.quick
@pytest.mark.parametrize("change", ["force", "sliding", "rolling"])
def test_outside_a_table_of_friction_the_chain_is_asked(change):
    m = motion("cage-set", "conventional", (), tabulated=True, **MANY)
    contact = {"force": 100.0, "sliding": 0.5, "rolling": 30.0}
    (table, _) = m.friction.friction_tables
    (capsule, _) = m.friction.capsules
    assert compiled.table_friction(capsule, **contact) is not None
    root = table.root_scale * table.root_ends[1] / (1.0 - table.root_ends[1])
    beyond = {
        "force": [root**2 * 1.001],
        "sliding": [100.0, -100.0],
        "rolling": [10.0, 50.0, -30.0, 0.0],
    }
    for value in [*beyond[change], math.nan]:
        assert compiled.table_friction(capsule, **contact | {change: value}) is None
    sliced = motion("cage-set", "conventional", (), **MANY)
    y = sliced.initial(0.9, 0.9)  # rolls on the outer ring more slowly than the table knows
    found, expected = (one.split(one.system.rates(0.0, y)) for one in (m, sliced))
    assert found["lost_outer"] == expected["lost_outer"] > 0.0
    assert found["lost_inner"] != expected["lost_inner"]


def test_without_force_there_is_no_friction_of_a_table():
    m = motion("cage-set", "conventional", (), tabulated=True, **MANY)
    found = compiled.table_friction(m.friction.capsules[0], 0.0, 0.5, 30.0)
    assert np.all(found == 0.0)


def test_what_has_no_table_of_friction_says_why(monkeypatch):
    assembly = bearing(**{"operation.misalignment": "0.2 mrad"}).with_resistance()
    friction = raceway_friction(assembly, FrictionSettings(name="conventional"))
    assert friction.friction_tables == ()
    assert "rollers tilt" in friction.evaluation_method
    friction = raceway_friction(bearing().with_resistance(), FrictionSettings(name="conventional"))
    assert friction.friction_tables == ()
    assert "5 slices cost no more than a table" in friction.evaluation_method
    m = motion("cage-set", "conventional", (), **MANY)

    friction = raceway_friction(
        with_traction(m, NumpyForm(m.assembly.traction)), FrictionSettings(name="conventional")
    )
    assert friction.friction_tables == ()
    assert "no compiled form" in friction.evaluation_method
    friction = raceway_friction(m.assembly, FrictionSettings(name="conventional", tolerance=1e-7))
    assert friction.friction_tables == ()
    assert "on the inner ring would err by" in friction.evaluation_method

    def ends(*_):
        raise DomainError("no such speed")

    monkeypatch.setattr(friction_module._RollerFriction, "values_at_nodes", ends)
    friction = raceway_friction(m.assembly, FrictionSettings(name="conventional", tolerance=3e-2))
    assert friction.friction_tables == ()
    assert (
        "a law of the inner ring ends where a table of it would have to reach (no such speed)"
        in friction.evaluation_method
    )


def test_film_and_stored_friction_stay_those_of_the_chain():
    tabulated, sliced = (
        motion("pocket", "conventional", (), film_limit=0.5, tabulated=yes, **MANY)
        for yes in (True, False)
    )
    y = sliced.initial(0.2, 0.05)
    done = tabulated.outputs([0.0], y)
    true = sliced.outputs([0.0], y)
    for name in ("traction_force", "film_parameter"):
        np.testing.assert_array_equal(done[name], true[name])
    np.testing.assert_array_equal(tabulated.system.watch(0.0, y), sliced.system.watch(0.0, y))


def test_a_table_of_friction_that_cannot_be_is_refused():
    m = motion("cage-set", "conventional", (), **MANY)
    ends = (2.0, 0.9, 10.0, (0.0, 0.5), 10.0, (0.3, 0.8))
    for shape, message in (
        ((2, 4, 4, 7), "has 1 parts"),
        ((1, 3, 4, 7), "at least"),
        ((1, 4, 4, 8), "odd number"),
    ):
        with pytest.raises(ValueError, match=message):
            compiled.with_table(m.friction.capsules[0], np.zeros(shape), *ends)
    with pytest.raises(ValueError, match="conventional friction"):
        compiled.with_table(compiled.constant(28, 0.1, 0.1), np.zeros((1, 4, 4, 7)), *ends)


# Raceways ------------------------------------------------------------------------------------------------------------


@pytest.mark.quick
def test_a_table_is_held_beyond_its_ends_and_passes_no_nan_on_silently():
    x = np.linspace(-0.5, 0.5, 9)
    nodes = np.stack((x**3, 3 * x**2 * (x[1] - x[0])), axis=1)
    made = compiled.effective(5, nodes, (-0.5, 0.5), 2.0)
    V = np.array([-100.0, -0.3, 0.0, 1.1, 1e300])
    traction, resistance, film, status = compiled.friction(made, 0.0, 10.0, V, 5.0, 3.0)
    assert status == 0
    np.testing.assert_allclose(
        traction, 10.0 * np.clip(V / (np.abs(V) + 2.0), -0.5, 0.5) ** 3, rtol=1e-14
    )
    np.testing.assert_allclose(resistance, 3.0, rtol=1e-7)
    assert np.all(np.isnan(film))
    assert np.isnan(compiled.friction(made, 0.0, 10.0, np.nan, 5.0, 3.0)[0]).all()


@pytest.mark.quick
def test_effective_tables_are_right_to_their_tolerance():
    from rollslip_studies.motion.effective_table import effective_table

    assembly = bearing()
    loads = build_load_map(assembly, 2e-2)
    rolling = float(assembly.kinematics.surface_speeds(0.0, 0.0).inner_rolling)
    rng = np.random.default_rng(12)
    for raceway, load in zip(
        assembly.raceways, loads.loads(assembly.centrifugal_force), strict=True
    ):
        table = effective_table(assembly, raceway, load, 5e-3)
        made = table.raceway(1)
        fraction = load[load > 0.0] / load.sum()
        V = rolling * np.concatenate((rng.uniform(-2, 2, 20), 10 ** rng.uniform(-5, 0, 20)))
        true = np.array(
            [
                raceway.evaluate(load[load > 0.0], rolling, one).friction @ fraction
                for one in V.tolist()
            ]
        )
        found = np.array(
            [compiled.friction(made, 0.0, 1.0, one, rolling, 0.0)[0][0] for one in V.tolist()]
        )
        assert np.abs(found - true).max() <= 5e-3 * np.abs(true).max()


def test_a_chain_as_a_stage_is_the_chain_and_remembers_what_it_refused():
    chain = bearing().inner.chain
    raceway = bearing().inner
    widths = np.array([0.001, 0.002, 0.003, 0.004, 0.005])
    table = Slices(28 * 5, raceway.conditions)
    made = compiled.conventional(chain.kernel, table, 28, widths, False)
    load = np.random.default_rng(0).uniform(-1e4, 2e4, (28, 5))
    V = np.linspace(-3, 3, 28)
    traction, resistance, film, status = compiled.friction(made, load, 0.0, V, 25.0, 0.0)
    assert (status, compiled.refusal(made)) == (0, None)
    np.testing.assert_array_equal(resistance, 0.0)
    for j in range(28):
        one = raceway.evaluate(load[j][load[j] > 0], np.hypot(25.0, compiled.REST_SPEED), V[j])
        assert traction[j] == pytest.approx(
            one.friction * one.load @ widths[load[j] > 0], rel=1e-13
        )
        assert film[j] == pytest.approx(
            one.film_thickness.min() / raceway.conditions.roughness, rel=1e-14
        )
    V[3] = np.nan
    assert compiled.friction(made, load, 0.0, V, 25.0, 0.0)[3] > 0
    refusal = compiled.refusal(made)
    assert refusal == ("input", 3, "sliding_speed", np.count_nonzero(load[:3] > 0))
    assert "lambda-blend: slice" in str(chain.error(refusal, table))
    other = compiled.conventional(
        chain.kernel, Slices(28 * 5, raceway.conditions), 28, widths, False
    )
    assert (
        compiled.refusal(other) is None
    )  # what is remembered belongs to the stage, not to the chain
    assert compiled.refusal(compiled.constant(3, 0.1, 1.0)) is None
    with pytest.raises(ValueError, match="not a chain"):
        chain.kernel.refusal(raceway.chain.models[0].kernel())
    with pytest.raises(ValueError, match="not one of 27 rollers"):
        compiled.conventional(chain.kernel, table, 27, widths, False)
    with pytest.raises(ValueError, match="4 widths for 5 slices"):
        compiled.conventional(chain.kernel, table, 28, widths[1:], False)


def test_bad_tables_are_refused():
    with pytest.raises(ValueError, match=r"shape \(N, 2\) with at least two nodes"):
        compiled.effective(3, np.zeros((4, 3)), (-1, 1), 1.0)
    with pytest.raises(ValueError, match="at least one of each"):
        compiled.constant(0, 0.1, 1.0)
    with pytest.raises(ValueError, match=r"friction nan over 1 m/s"):
        compiled.constant(3, np.nan, 1.0)


# Motion --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize(
    ("method", "drags"), [("Radau", ()), ("LSODA", ()), ("Radau", ["rolling-resistance"])]
)
def test_the_cage_relaxes_and_the_ledger_closes(method, drags, level):
    m = motion(level, "effective", drags, 0.05)
    end, tolerance = (0.1, 1e-6) if level == "cage-set" else (0.002, 1e-5)
    found = solve_ivp(
        m.system,
        (0.0, end),
        m.initial(0.1),
        method,
        jac=m.system.jacobian,
        rtol=tolerance,
        atol=tolerance * m.system.scale,
    )
    assert found.success
    ledger = m.split(found.y.T)
    slip = 1.0 - ledger["cage_speed"] / m.assembly.kinematics.epicyclic_cage_speed
    if level == "cage-set" and not drags:
        assert 0.06 < slip[-1] < 0.08
    else:
        assert 1e-5 < abs(slip[-1] - 0.1) < 0.1
    assert np.abs(m.energy_residual(found.y.T)).max() < 100 * tolerance * ledger["work_rings"][-1]
    assert (
        np.abs(m.momentum_residual(found.y.T)).max() < 100 * tolerance * ledger["impulse_inner"][-1]
    )


def test_the_scene_moves_alike_with_effective_and_conventional_friction():
    """28 rollers with 15 slices: the same transient within 1 % of the cage speed, and the ledger closes."""
    changes = {"accuracy.slices": 15}
    speeds = []
    for kind in ("effective", "conventional"):
        m = motion("cage-set", kind, (), 0.05, **changes)
        found = solve_ivp(
            m.system,
            (0.0, 0.5),
            m.initial(0.1),
            "Radau",
            jac=m.system.jacobian,
            rtol=1e-5,
            atol=1e-5 * m.system.scale,
        )
        assert found.success
        work = m.split(found.y.T)["work_rings"][-1]
        assert np.abs(m.energy_residual(found.y.T)).max() < 1e-3 * work
        speeds.append(np.interp(np.linspace(0, 0.5, 50), found.t, m.split(found.y.T)["cage_speed"]))
    np.testing.assert_allclose(speeds[0], speeds[1], rtol=1e-2)
