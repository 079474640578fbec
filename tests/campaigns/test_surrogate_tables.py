"""Tables of a surrogate whose friction is known in closed form: what lies between nodes, balances and files."""

import math
import re
import shutil
import subprocess
import xml.etree.ElementTree as ET
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from scipy.interpolate import BarycentricInterpolator
from scipy.optimize import brentq

import rollslip
from rollslip.bearing.assembly import assemble
from rollslip.catalogue import discovery
from rollslip.cli.main import main
from rollslip.errors import ConvergenceError, SceneError
from rollslip.scene.formats import format_of
from rollslip_campaigns.surrogate import SurrogateSettings, plan
from rollslip_campaigns.surrogate import drags as surrogate_drags
from rollslip_campaigns.surrogate import surrogate as made_by
from rollslip_campaigns.surrogate.drags import OPERATION_KEYS, drag_errors, tabulate_drags
from rollslip_campaigns.surrogate.exports import C, Csv, _description, c_header
from rollslip_campaigns.surrogate.plan import _speed_bounds
from rollslip_campaigns.surrogate.tables import Axis, Tables, weights
from rollslip_studies.motion.orbit_loads import orbit_loads
from rollslip_studies.motion.rib_friction import LINEAR_SPEED

pytestmark = pytest.mark.quick
#: Radius of the inner raceway [m].
RI = 0.08
#: Radius of the outer raceway [m]: rollers of 10 mm radius fit between them.
RO = 0.1
# slide-roll ratios are even in asinh of them over the first, by the second
SMALL = 1e-4
#: Distance of nodes in asinh.
STEP = 0.5
#: Height of ribs above the raceways [m].
HEIGHT = 0.001


def dataset(
    rise=1e-3,
    largest=0.05,
    resistance=0.0,
    drags=(0.0, 0.0, 0.0, 0.0),
    forces=(1000.0, 1200.0),
    growth=(0, 0, 0, 0),
    ribs=0.0,
):
    """Friction that rises by so much from node to node, on each ring with one force and resistance.

    It grows by a share along temperature, load, cage ratio and rolling speed. That of ribs is so many newtons at each
    node of the sliding speed, on the outer ring half of it.
    """
    size = (2, 2, 2, 2, 2)
    dims = ("ring", "temperature", "radial_load", "cage_ratio", "rolling_speed")
    grown = 1.0 + np.tensordot(growth, np.indices(size[1:]), axes=1)[..., None]
    force = np.broadcast_to(np.reshape(forces, (2, 1, 1, 1, 1)), size)
    cages = np.sinh(np.arange(8))
    numbers = {"inner_radius": RI, "outer_radius": RO, "roller_radius": 0.01, "orbit_radius": 0.09, "roller_mass": 0.02,
               "orbital_inertia": 1e-3, "spin_inertia": 2e-5, "first_load": 2e3, "first_temperature": 350.0,
               "first_inner_speed": 100.0, "first_outer_speed": -7.0}  # fmt: skip
    lead = {name: ("temperature", np.full(2, value)) for name, value in zip(
        ("drag_inner", "drag_outer"), drags, strict=False)}  # fmt: skip
    # so much at the rolling speed of rings that are 100 rad/s apart, in proportion to the logarithm of it
    fraction = np.log(np.array([0.1, 50.0])) / math.log(100.0 / (1.0 / RI + 1.0 / RO))
    if ribs:
        of_ribs = ribs * np.reshape((1.0, 0.5), (2, 1, 1, 1, 1, 1)) * grown * np.arange(9.0)
        lead["rib_friction"] = ((*dims, "rib_sliding"), of_ribs)
        lead["rib_sliding"] = ("rib_sliding", LINEAR_SPEED * np.sinh(np.arange(9.0)))
        numbers |= {"rib_radius": 0.01 - HEIGHT, "axial_ratio": 0.2}
    lead["drag_cage"] = (("temperature", "rolling_speed"), np.tile(drags[2] * fraction, (2, 1)))
    return xr.Dataset(
        {
            "mean_friction": ((*dims, "slide_roll"), np.broadcast_to(rise * grown * np.arange(25.0), (*size, 25))),
            "largest_friction": (dims, np.full(size, largest)),
            "ring_resistance": (dims, np.full(size, resistance)),
            "ring_force": (dims, force),
            "drag_rest": (("temperature", "cage_speed"), np.tile(drags[3] * np.arange(8.0), (2, 1))),
            "temperature_range": ("end", [340.0, 360.0]),
            "radial_load_range": ("end", [1e3, 3e3]),
            **lead,
            **{name: ((), value) for name, value in numbers.items()},
        },
        coords={"temperature": [340.0, 360.0], "radial_load": [1e3, 3e3], "cage_ratio": [0.1, 10.0],
                "rolling_speed": [0.1, 50.0], "slide_roll": SMALL * np.sinh(STEP * np.arange(25)), "cage_speed": cages},
        attrs={"sliding_small": SMALL, "error": 0.01, "packages": "{}", "source": "nobody's"},
    )  # fmt: skip


def folded(**given):
    return Tables.from_dataset(dataset(**given)).interpolate(350.0, 2e3)


def test_weights_are_those_of_the_four_nodes_around():
    axis = Axis(np.geomspace(1.0, 100.0, 7), True)
    np.testing.assert_allclose(axis.weights(axis.nodes), np.eye(7), atol=1e-12)
    assert np.flatnonzero(weights(12, 5.5)[0]).tolist() == [4, 5, 6, 7]


def test_traction_and_resistance_are_those_of_the_law():
    V = np.array([0.3, -0.3, 0.01])
    u = np.array([5.0, 5.0, 1e-3])
    traction, resistance = folded(resistance=3.0).ring_forces(1, np.full(3, 40.0), V, u)
    film = np.hypot(u, 1e-3)
    x = np.minimum(np.arcsinh(np.abs(V) / (SMALL * film)) / STEP, 24.0)
    assert traction == pytest.approx(np.sign(V) * 1e-3 * x * 1200.0)
    assert resistance == pytest.approx(3.0 * u / film)


def test_drags_go_with_the_lead_of_rings_and_with_the_speed_of_the_cage():
    one = folded(drags=(0.02, 0.03, 1e-4, 0.1))
    w = np.array([20.0, -20.0])
    oil = math.log(107.0 / (1.0 / RI + 1.0 / RO)) / math.log(100.0 / (1.0 / RI + 1.0 / RO))
    by_hand = (
        0.02 * (100.0 - w)
        + 0.03 * (-7.0 - w)
        - 1e-4 * oil * abs(w) * w
        + np.sign(w) * 0.1 * np.arcsinh(20.0)
    )
    assert one.drag(w, 100.0, -7.0) == pytest.approx(by_hand)


@pytest.mark.parametrize("slip", [0.0, 0.05])
@pytest.mark.parametrize("resistance", [0.0, 2.0])
def test_rollers_are_where_their_torques_balance(slip, resistance):
    one = folded(resistance=resistance)
    inner = 100.0
    outer = 10.0
    w = (RI * inner + RO * outer) / (RI + RO) * (1.0 - slip)
    a = RI * (inner - w)
    b = RO * (w - outer)

    def forces(c):
        return [*one.ring_forces(0, np.array([w]), np.array([a - c]), np.array([0.5 * (a + c)])),
                *one.ring_forces(1, np.array([w]), np.array([c - b]), np.array([0.5 * (b + c)]))]  # fmt: skip

    def spin(c):
        Fi, Si, Fo, So = forces(c)
        return float((Fi - Si - Fo - So)[0])

    Fi, Si, Fo, So = (
        float(each[0])
        for each in forces(brentq(spin, min(a, b) - 0.5, max(a, b) + 0.5, xtol=1e-14))
    )
    left, on_inner, on_outer = one._balance(np.array([w]), np.array([inner]), outer)
    assert on_inner[0] == pytest.approx(RI * (Fi + Si), rel=1e-3, abs=1e-4)
    assert on_outer[0] == pytest.approx(RO * (Fo - So), rel=1e-3, abs=1e-4)
    assert left[0] == pytest.approx(on_inner[0] + on_outer[0])


@pytest.mark.parametrize("height", [0.0, 1e-12, 0.003])
def test_ribs_have_the_friction_of_raceways_whose_radii_are_theirs(height):
    """Where they have no height they are raceways, of a coefficient that goes with the speed of the rib."""
    result = dataset(ribs=10.0).assign(rib_radius=0.01 - height)
    one = Tables.from_dataset(result).interpolate(350.0, 2e3)
    w, a, b, c = (np.array([value]) for value in (40.0, 4.0, 4.4, 4.1))
    turning, inner, outer = one.ribs(w, a, b, c)
    lever = 1.0 - height / 0.01
    sliding = a * (1.0 + height / RI) - lever * c, lever * c - b * (1.0 - height / RO)
    forces = [
        half * 10.0 * np.sign(V) * np.arcsinh(abs(V) / LINEAR_SPEED)
        for half, V in zip((1.0, 0.5), sliding, strict=True)
    ]
    assert turning == pytest.approx(lever * (forces[0] - forces[1]))
    assert inner == pytest.approx((RI + height) * forces[0])
    assert outer == pytest.approx((RO - height) * forces[1])


def test_ribs_take_the_power_that_both_rings_and_the_cage_give():
    """At the spin that balances, with all losses added up contact by contact."""
    one = folded(resistance=2.0, ribs=3.0)
    inner = np.array([100.0])
    outer = 10.0
    w = (RI * inner + RO * outer) / (RI + RO) * 0.97
    a = RI * (inner - w)
    b = RO * (w - outer)

    def spin(c):
        (Fi, Si), (Fo, So) = one._forces(w, a, b, np.array([c]))
        return float((Fi - Si - Fo - So + one.ribs(w, a, b, np.array([c]))[0])[0])

    c = brentq(spin, a[0] - 0.5, a[0] + 0.5, xtol=1e-14)
    (Fi, Si), (Fo, So) = one._forces(w, a, b, np.array([c]))
    _, inner_rib, outer_rib = one.ribs(w, a, b, np.array([c]))
    heat = Fi * (a - c) + Fo * (c - b) + Si * (a + c) + So * (c + b)
    heat += inner_rib / (RI + HEIGHT) * (a * (1.0 + HEIGHT / RI) - c * (1.0 - HEIGHT / 0.01))
    heat += outer_rib / (RO - HEIGHT) * (c * (1.0 - HEIGHT / 0.01) - b * (1.0 - HEIGHT / RO))
    left, on_inner, on_outer = one._balance(w, inner, outer)
    assert on_inner * inner + on_outer * outer - left * w == pytest.approx(heat, rel=1e-4)


def test_a_bearing_that_runs_steadily_takes_in_what_it_loses():
    one = folded(resistance=2.0, drags=(1e-3, 0.0, 1e-4, 0.1))
    found = one.steady_state(np.array([100.0, 150.0]), 10.0)
    w = (RI * np.array([100.0, 150.0]) + RO * 10.0) / (RI + RO) * (1.0 - found.cage_slip)
    oil = np.log(np.array([90.0, 140.0]) / (1.0 / RI + 1.0 / RO)) / math.log(
        100.0 / (1.0 / RI + 1.0 / RO)
    )
    ground = 1e-4 * oil * w**2 - 0.1 * np.arcsinh(w)  # torque that no ring gives back
    assert found.torque + found.outer_torque == pytest.approx(ground, abs=1e-4)
    assert found.power_loss == pytest.approx(
        found.torque * np.array([100.0, 150.0]) + found.outer_torque * 10.0
    )
    # the outer ring takes what the inner one gives a roller, 0.05 of 1000 N, less both resistances
    most = RI * (46.0 + 3.0 * 2.0) + RO * (46.0 - 2.0)
    assert found.drag_reserve == pytest.approx(
        most / abs(one.drag(w, np.array([100.0, 150.0]), 10.0)), rel=1e-3
    )


def test_where_nothing_is_carried_there_is_no_slip_and_no_reserve():
    found = folded(rise=1e-6, largest=0.5, drags=(0.0, 1.0, 0.0, 0.0)).steady_state(
        np.array([100.0]), -7.0
    )
    assert np.isnan([found.cage_slip[0], found.torque[0], found.power_loss[0]]).all()
    assert found.drag_reserve[0] == 1.0


def test_speeds_of_a_plan_hold_those_of_its_ranges():
    over = {"inner_speed": "100 rpm:1000 rpm", "outer_speed": "10 rpm:20 rpm"}
    scene = rollslip.evolve(rollslip.load_scene("gearbox"), {"operation.outer_speed": "15 rpm"})
    told = (
        SurrogateSettings(scene, over, engine="serial").plan().sweep.scene.study["raceway-friction"]
    )
    b = scene.bearing
    rpm = math.pi / 30.0
    Ri = b.inner_raceway_diameter / 2
    Ro = b.outer_raceway_diameter / 2
    assert told["fastest"] == pytest.approx(1.6 * Ri * Ro / (Ri + Ro) * 990.0 * rpm)
    ratios = [
        Ro * (Ri * inner + Ro * outer) / (Ri * Ro * (inner - outer))
        for inner, outer in ((1000, 10), (100, 20))
    ]
    assert [told["smallest_ratio"], told["largest_ratio"]] == pytest.approx(ratios)
    backwards = rollslip.evolve(scene, {"operation.inner_speed": "-500 rpm"})
    ends = SurrogateSettings(backwards, {}, engine="serial").plan().ranges["operation.inner_speed"]
    assert ends == pytest.approx((-600.0 * rpm, -75.0 * rpm))


#: Speeds of both rings of scene turbine [rpm], and the largest mean error of the contact forces. Half and twice of
#: `_MIN_CAGE_RATIO` exceed the first, half and twice of `_MAX_CAGE_RATIO` the second one.
OF_BOTH_RINGS = {
    "against": ((2000.0, 12000.0), (-8000.0, -1000.0), 6e-4),
    "alike": ((2000.0, 12000.0), (2000.0, 11000.0), 0.0172),
}


@pytest.mark.parametrize(("inner", "outer", "limit"), OF_BOTH_RINGS.values(), ids=OF_BOTH_RINGS)
def test_contact_forces_of_tables_are_those_of_both_rings_in_motion(inner, outer, limit):
    bearing = assemble(rollslip.load_scene("turbine"))
    Ri = bearing.kinematics.inner_radius
    Ro = bearing.kinematics.outer_radius
    rpm = math.pi / 30.0
    ranges = {
        key: (rpm * low, rpm * high)
        for key, (low, high) in zip(OPERATION_KEYS[2:], (inner, outer), strict=True)
    }
    slow, fast, low, high = _speed_bounds(bearing, ranges)
    of_inner, of_outer = (
        np.random.default_rng(1).uniform(*np.transpose([*ranges.values()]), (4000, 2)).T
    )
    u = Ri * Ro / (Ri + Ro) * np.abs(of_inner - of_outer)
    cage = np.abs(Ri * of_inner + Ro * of_outer) / (Ri + Ro)
    # forces of a contact depend on the speed of the cage alone
    axis = Axis(np.geomspace(low, high, 9), logarithmic=True)
    nodes = np.outer(np.clip(u, slow, fast), axis.nodes) / Ro
    speeds = fast * high / Ro * np.linspace(0.0, 1.0, 400) ** 3
    errors = []
    for loads, _ in orbit_loads(bearing, 4, speeds)[:2]:
        force = loads.reshape(speeds.size, -1).sum(axis=1)
        tabulated = weights(9, axis.position(Ro * cage / u)) * np.interp(nodes, speeds, force)
        exact = np.interp(cage, speeds, force)
        errors.append(np.abs(tabulated.sum(axis=1) / exact - 1.0).mean())
    assert np.mean(errors) < limit


def test_a_drag_that_tables_do_not_reproduce_is_refused(monkeypatch):
    monkeypatch.setattr(plan, "drag_error", lambda *arguments: 0.3)
    with pytest.raises(SceneError, match=r"errs by 30 %; allow a larger error"):
        SurrogateSettings("gearbox", {}, engine="serial").plan()


def test_an_error_of_a_fifth_is_the_most_that_is_asked_for():
    with pytest.raises(SceneError, match=r"a fraction from 0\.0001 to 0\.2 is expected"):
        SurrogateSettings("gearbox", {}, error=0.5, engine="serial").plan()


def test_drags_are_told_apart_by_what_they_go_with():
    drag = [{"model": "constant-torque", "size": "0.2 N m"}]
    scene = rollslip.evolve(rollslip.load_scene("gearbox"), {"cage.drag": drag}, si=True)
    ranges = dict.fromkeys(("operation.inner_speed", "operation.outer_speed"), (0.0, 100.0))
    at = np.array([350.0])
    tables = tabulate_drags(scene, at, ranges, np.geomspace(1.0, 10.0, 5))
    found = tables.terms
    assert [found["inner"][0], found["outer"][0], *found["cage"][0]] == pytest.approx(
        [0.0] * 7, abs=1e-6
    )
    assert drag_errors(scene, at, tables)[0] < 3e-3  # it jumps at rest
    assert (tables.cage_top, found["rest"][0, -1]) == (
        pytest.approx(100.0),
        pytest.approx(-0.2, rel=1e-3),
    )


def test_any_sum_of_leads_and_a_square_is_found_and_nothing_else(monkeypatch):
    def drags(torque):
        def made(lead=50.0):
            of = SimpleNamespace(torque=lambda *speeds: torque(*speeds, lead))
            radii = SimpleNamespace(inner_radius=1.0, outer_radius=1.0)
            return SimpleNamespace(kinematics=radii, cage=SimpleNamespace(drags=of))

        monkeypatch.setattr(surrogate_drags, "assemble", lambda _: made())
        monkeypatch.setattr(surrogate_drags, "at_rolling_speed", lambda _, u: made(2.0 * u))
        ranges = dict.fromkeys(("operation.inner_speed", "operation.outer_speed"), (0.0, 100.0))
        scene = rollslip.load_scene("gearbox")
        at = np.array([350.0])
        tables = tabulate_drags(scene, at, ranges, u)
        return tables.terms, drag_errors(scene, at, tables)[0]

    u = np.geomspace(10.0, 50.0, 9)
    found, off = drags(
        lambda w, wi, wo, n: 0.02 * (wi - w) + 0.03 * (wo - w) - 1e-3 * math.log(n) * abs(w) * w
    )
    assert [found[name][0] for name in ("inner", "outer")] == pytest.approx([0.02, 0.03])
    assert found["cage"][0] == pytest.approx(1e-3 * np.log(2.0 * u))
    assert np.abs(found["rest"]).max() < 1e-8
    assert off < 1e-8
    assert drags(lambda w, wi, wo, n: 1e-3 * w * wi)[1] > 0.1


def test_temperatures_are_refined_until_the_drags_between_them_are_within_the_error(monkeypatch):
    rate = 0.1  # 1/K

    def exponential(T):
        return math.exp(-rate * (T - 330.0))

    def bearing(scene):
        def torque(w, wi, wo):
            return exponential(scene.operation.temperature) * (wi - w)

        radii = SimpleNamespace(inner_radius=1.0, outer_radius=1.0)
        return SimpleNamespace(
            kinematics=radii, cage=SimpleNamespace(drags=SimpleNamespace(torque=torque))
        )

    monkeypatch.setattr(surrogate_drags, "assemble", bearing)
    monkeypatch.setattr(surrogate_drags, "at_rolling_speed", lambda bearing, u: bearing)
    ranges = dict.fromkeys(OPERATION_KEYS, (1.0, 100.0)) | {OPERATION_KEYS[0]: (330.0, 370.0)}
    scene = rollslip.load_scene("gearbox")
    plan = SimpleNamespace(
        ranges=ranges,
        rolling=np.geomspace(10.0, 50.0, 4),
        sweep=SimpleNamespace(scene=scene),
    )

    def error(count):
        """Of the polynomial through the four nearest of so many nodes, half-way between nodes."""
        nodes = np.linspace(330.0, 370.0, count)
        between = 0.5 * (nodes[1:] + nodes[:-1])
        first = np.clip(np.arange(count - 1) - 1, 0, count - 4)
        by = [
            BarycentricInterpolator(nodes[k : k + 4], [*map(exponential, nodes[k : k + 4])])(T)
            for k, T in zip(first, between, strict=True)
        ]
        return np.max(np.abs(np.array(by) / [*map(exponential, between)] - 1.0))

    nodes = SimpleNamespace(
        plan=plan,
        tables=lambda T, W: {
            name: np.ones((len(T), len(W), *[1] * count))
            for name, count in made_by._TABLE_AXES.items()
        },
    )
    # errors of torques are at most those of the coefficient, since leads are at most the largest speed
    for level, nodes_of_level in enumerate((7, 13), start=1):
        allowed = math.sqrt(error(nodes_of_level) * error((nodes_of_level + 1) // 2))
        assert made_by._refine_rows(nodes, [0, 0], allowed) == [level, 0]


DRIVER = r"""
#include <stdio.h>
#include <stdlib.h>
int main(void) {
    bearing *b = malloc(bearing_size());
    double *v = bearing_values(b), T, W, inner, outer, slip;
    while (scanf("%lf %lf %lf %lf %lf", &T, &W, &inner, &outer, &slip) == 5) {
        bearing_init(b);
        v[B_TEMPERATURE] = T, v[B_RADIAL_LOAD] = W, v[B_INNER_SPEED] = inner, v[B_OUTER_SPEED] = outer;
        v[B_FIRST_CAGE_SLIP] = slip;
        bearing_start(b);
        printf("%.17g %.17g %.17g\n", v[B_TORQUE], v[B_OUTER_TORQUE], v[B_POWER_LOSS]);
    }
    return 0;
}
"""


@pytest.mark.skipif(
    shutil.which("cc") is None, reason="an export in C is run by what a C compiler makes of it"
)
@pytest.mark.parametrize("ribs", [0.0, 7.0])
def test_an_export_in_c_reads_along_every_axis_what_the_tables_hold(tmp_path, ribs):
    """Torques of both rings and the power loss, with rollers half-way between the rings."""
    result = dataset(
        resistance=2.0, drags=(0.02, 0.03, 1e-4, 0.1), growth=(0.1, 0.2, 0.3, 0.4), ribs=ribs
    )
    (tmp_path / "driver.c").write_text(f"{C('c').render(result).text}\n{DRIVER}", encoding="utf-8")
    subprocess.run(["cc", "-std=c11", "driver.c", "-o", "driver", "-lm"], cwd=tmp_path, check=True)
    operations = [
        (345.0, 1.2e3, 100.0, -7.0, 0.02),
        (357.0, 2.7e3, 40.0, 15.0, 0.3),
        (341.0, 2e3, 3.0, 2.0, -0.4),
    ]
    lines = "".join(f"{' '.join(map(str, one))}\n" for one in operations)
    done = subprocess.run(
        [tmp_path / "driver"], input=lines, capture_output=True, text=True, check=True
    )
    for (T, W, inner, outer, slip), told in zip(operations, done.stdout.splitlines(), strict=True):
        one = Tables.from_dataset(result).interpolate(T, W)
        w = np.array([(RI * inner + RO * outer) / (RI + RO) * (1.0 - slip)])
        ahead = RI * (inner - w)
        behind = RO * (w - outer)
        surface = 0.5 * (ahead + behind)
        Fi, Si = one.ring_forces(0, w, ahead - surface, 0.5 * (ahead + surface))
        Fo, So = one.ring_forces(1, w, surface - behind, 0.5 * (surface + behind))
        by_inner = 0.02 * (inner - w)
        by_outer = 0.03 * (outer - w)
        loss = (
            Fi * (ahead - surface)
            + Fo * (surface - behind)
            + Si * (ahead + surface)
            + So * (surface + behind)
        )
        loss += by_inner * inner + by_outer * outer - one.drag(w, inner, outer) * w
        turning, inner_rib, outer_rib = one.ribs(w, ahead, behind, surface)
        # what turns the rollers takes power that goes into their spin, and not into the ribs
        loss += inner_rib * (inner - w) - outer_rib * (w - outer) - turning * surface
        on_inner = RI * (Fi + Si) + by_inner + inner_rib
        expected = [on_inner, RO * (Fo - So) + by_outer + outer_rib, loss]
        assert [float(value) for value in told.split()] == pytest.approx(
            np.concatenate(expected), rel=1e-6
        )


def test_files_for_other_programs_hold_the_numbers_of_the_tables():
    result = dataset()
    text, guid = c_header(result)
    numbers = {
        name: float(value) for name, value in re.findall(r"#define (\w+) ([-\d.e]+)\n", text)
    }
    assert (numbers["X_STEPS"], numbers["X_SMALL"]) == (pytest.approx(1.0 / STEP), SMALL)
    steps = {"T": 20.0, "W": math.log(3.0), "R": math.log(100.0), "U": math.log(500.0)}
    assert {letter: numbers[f"{letter}_STEP"] for letter in steps} == pytest.approx(steps)
    assert (numbers["FIRST_INNER"], numbers["FIRST_OUTER"], numbers["RI"]) == (100.0, -7.0, RI)
    root = ET.fromstring(_description(result, guid, False))
    assert "friction within 1 % of nobody's" in root.get("description")
    known = root.findall("ModelVariables/ScalarVariable")
    outputs = [
        known[int(one.get("index")) - 1].get("causality")
        for one in root.findall("ModelStructure/Outputs/*")
    ]
    assert set(outputs) == {"output"}
    load = next(one for one in known if one.get("name") == "radial_load").find("Real")
    assert (float(load.get("min")), float(load.get("max"))) == (1e3, 3e3)


def test_a_row_without_a_balance_has_empty_cells():
    axes = {"temperature": [350.0], "radial_load": [1e3], "inner_speed": [100.0, 9.0]}
    columns = ("steady_cage_slip", "friction_torque", "outer_torque", "power_loss", "drag_reserve")
    values = (math.nan, math.nan, math.nan, math.nan, 0.5)
    made = xr.Dataset(
        {name: (tuple(axes), np.full((1, 1, 2), value), {"units": "1"})
         for name, value in zip(columns, values, strict=True)}
        | {"inner_radius": RI, "outer_radius": RO, "first_outer_speed": 0.0},
        coords={name: (name, value, {"units": "1"}) for name, value in axes.items()}
        | {"rolling_speed": [1.0, 9.0]},
    )  # fmt: skip
    written = Csv("csv").render(made)
    assert written.text.splitlines()[1:] == ["350,1000,100,,,,,0.5,1", "350,1000,9,,,,,0.5,0"]
    assert "radial_load 1000 to 1000" in written.notes[0]


def test_of_two_endings_the_longer_one_says_the_format(monkeypatch):
    class Longer(Csv):
        endings = (".tables.json",)

    monkeypatch.setattr(discovery, "_registered", {})
    discovery.add("format", Longer("longer"))
    assert [format_of(name).name for name in ("a.tables.json", "tables.json", "b.JSON")] == [
        "longer",
        "json",
        "json",
    ]


class Counted:
    """Nodes of which those of a grid are known as soon as it is requested, in a time by the clock."""

    count = made_by._Nodes.count

    def __init__(self, seconds):
        ranges = dict.fromkeys(OPERATION_KEYS, (1.0, 2.0))
        self.plan = SimpleNamespace(ranges=ranges, error=0.01, seconds=seconds)
        self.results = dict[int, object]()

    def seconds(self):
        return 1.0


def test_rows_are_refined_as_long_as_their_nodes_end_in_time(monkeypatch):
    now = 0.0
    monkeypatch.setattr(made_by.time, "monotonic", lambda: now)
    nodes = Counted(90.0)
    found = []
    for levels, allowed in made_by._levels_in_time(nodes, 0.0):
        now += nodes.count(levels) - len(nodes.results)
        nodes.results = dict.fromkeys(range(nodes.count(levels)))
        found.append(levels)
        assert 0.0 < allowed < 0.01
    # 16, 28 and 49 nodes; 91 would end after 42 more
    assert found == [(0, 0), (0, 1), (1, 1)]
    assert next(made_by._levels_in_time(Counted(1.0), now))[0] == (0, 0)
    monkeypatch.setattr(made_by, "cores", lambda: 2)
    assert made_by._describe_cost(Counted(60.0), 8, 1.0) == (
        "24 operations of 1 s each on 2 processors take about 14 s, more nodes at most 1 min 0 s"
    )


def test_the_time_of_a_node_is_that_of_its_computation_whenever_that_was(monkeypatch):
    monkeypatch.setattr(made_by, "cores", lambda: 2)
    rows = [SimpleNamespace(seconds=3.0), SimpleNamespace(seconds=5.0)]
    monkeypatch.setattr(made_by, "records", lambda folder: rows)
    nodes = made_by._Nodes(SimpleNamespace(), SimpleNamespace(folder="nodes"))
    assert nodes.seconds() == 2.0  # 4 s on one of two processors


def test_a_scene_is_exported_by_one_command(monkeypatch, tmp_path):
    requested = []

    def run(self, made, folder, show, message):
        requested.append((self.scene.operation.radial_load, self.within, self.checks))
        raise ConvergenceError("it ends here")

    monkeypatch.setattr(SurrogateSettings, "plan", lambda self: None)
    monkeypatch.setattr(SurrogateSettings, "run", run)
    for words in (["--within", "5 s"], []):
        with pytest.raises(SystemExit):
            main(["export", "gearbox", "--out", str(tmp_path / "b.fmu"), *words])
    assert requested == [(1500.0, "5 s", 8), (1500.0, "1 min", 8)]
