"""Tables of effective friction: no extrema that the law lacks, stated errors that hold, order, and hard laws.

References are the laws themselves: closed expressions with their own derivatives, or all slices of a bearing.
"""

import itertools
import json
import math
from concurrent.futures import ThreadPoolExecutor

import attrs
import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq, minimize_scalar

from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.errors import ConvergenceError
from rollslip_kernels.motion import raceway as compiled
from rollslip_studies.motion import effective_table as tables
from rollslip_studies.motion.effective_table import curve_table, effective_table
from strategies import decades
from without_bands import run

#: Rolling speed [m/s], about that of the paper's bearing.
ROLLING = 30.0
REACH = 8.0 * ROLLING
EPSILON = float(np.finfo(float).eps)


def friction_of(table, V, u=ROLLING):
    """Friction from the compiled table, all speeds in one call."""
    V = np.asarray(V, dtype=float)
    return compiled.friction(table.raceway(V.size), 0.0, 1.0, V, u, 0.0)[0]


def places(table, points):
    """Sliding speeds (N - 1, points + 1) at equal shares of every cell, ends included, of a table over V."""
    x = np.linspace(*table.limits, table.nodes.shape[0])
    inside = x[:-1, None] + np.linspace(0.0, 1.0, points + 1) * np.diff(x)[:, None]
    inside[:, -1] = x[1:]
    return table.sliding_scale * inside / (1.0 - np.abs(inside))


def rounding(table):
    """Size of a change of friction that is rounding: of its value, and of the place in the table."""
    size, steepest = np.abs(table.nodes.reshape(-1, table.nodes.shape[-1])[:, :2]).max(axis=0)
    return 16.0 * EPSILON * size + 4.0 * EPSILON * steepest * table.nodes.shape[-2]


def turns(values, least):
    """Number of times that a sequence turns, smaller changes left out."""
    steps = np.diff(values)
    return int(np.count_nonzero(np.diff(np.sign(steps[np.abs(steps) > least]))))


@attrs.frozen
class Hump:
    """a asinh(V/v)/(1 + |V|/w) and, as of asperities, b (V/z) exp(1 - |V|/z), with their derivative."""

    a: float
    v: float
    w: float
    b: float = 0.0
    z: float = 1.0

    def __call__(self, V):
        W = np.abs(V)
        film = self.a * np.arcsinh(W / self.v) / (1.0 + W / self.w)
        return np.sign(V) * (film + self.b * W / self.z * np.exp(1.0 - W / self.z))

    def slope(self, V):
        W = np.abs(V)
        film = 1.0 / np.hypot(W, self.v) / (1.0 + W / self.w)
        film -= np.arcsinh(W / self.v) / self.w / (1.0 + W / self.w) ** 2
        return self.a * film + self.b / self.z * (1.0 - W / self.z) * np.exp(1.0 - W / self.z)

    def extrema(self):
        """Sliding speeds V > 0 at which it turns, by its derivative."""
        V = REACH * np.geomspace(1e-9, 1.0, 4001)
        d = self.slope(V)
        found = np.flatnonzero(d[:-1] * d[1:] < 0.0)
        return [brentq(self.slope, V[k], V[k + 1], xtol=1e-300, rtol=1e-14) for k in found]


def humps(asperities):
    return st.builds(
        Hump,
        a=decades(-3, -1),
        v=decades(-2, 0.5),
        w=decades(0, 1.7),
        b=decades(-3, -1) if asperities else st.just(0.0),
        z=decades(-1.5, 0.5) if asperities else st.just(1.0),
    )


@st.composite
def tabulated(draw):
    law = draw(humps(draw(st.booleans())))
    tolerance = draw(st.sampled_from([1e-2, 1e-3, 1e-5]))
    return law, tolerance, curve_table(law, ROLLING, tolerance)


# Shape ---------------------------------------------------------------------------------------------------------------


@given(tabulated())
@settings(max_examples=25)
def test_a_cell_without_an_extremum_stays_between_its_ends_and_no_extremum_is_invented(case):
    law, _, table = case
    V = places(table, 24)
    found = friction_of(table, V.ravel()).reshape(V.shape)
    true = law(V)
    least = rounding(table)
    monotone = np.array([turns(row, least) == 0 for row in true])
    low = np.minimum(true[:, 0], true[:, -1])
    high = np.maximum(true[:, 0], true[:, -1])
    off = np.maximum(low[:, None] - found, found - high[:, None]).max(axis=1)
    assert off[monotone].max() <= least
    joined = np.append(found[:, :-1].ravel(), found[-1, -1])
    ends = np.append(true[:, 0], true[-1, -1])
    assert turns(joined, least) == turns(ends, least) <= 2 * len(law.extrema())


@given(tabulated())
@settings(max_examples=25)
def test_the_error_between_all_nodes_is_the_stated_one(case):
    law, tolerance, table = case
    V = places(table, 37)
    error = np.abs(friction_of(table, V.ravel()) - law(V).ravel()).max() / np.abs(law(V)).max()
    assert table.error <= tolerance
    assert (
        error <= 1.125 * tolerance
    )  # what effective_table leaves of its tolerance to the rest of a cell
    assert error <= 1.5 * table.error + 16.0 * EPSILON


@given(tabulated())
@settings(max_examples=25)
def test_critical_speed_and_slope_at_no_slip_are_kept_to_the_stated_errors(case):
    law, _, table = case
    middle = table.nodes.shape[0] // 2
    slope = table.nodes[middle, 1] * middle / table.limits[1] / table.sliding_scale
    assert abs(slope / float(law.slope(0.0)) - 1.0) <= table.slope_error + 1e-8
    assert table.slope_error <= 1e-6
    best = max(law.extrema(), key=law)
    if best > 0.5 * REACH:
        assert math.isnan(table.critical_speed)
        assert math.isnan(table.critical_error)
        return
    assert table.critical_error <= 1e-6
    around = best * (1.0 + np.linspace(-2e-3, 2e-3, 4001))
    found = friction_of(table, around)
    assert abs(around[np.argmax(found)] / best - 1.0) <= table.critical_error + 1e-6
    assert abs(found.max() / float(law(best)) - 1.0) <= table.critical_error
    assert friction_of(table, [0.99 * best, table.critical_speed, 1.01 * best]).argmax() == 1


@pytest.mark.parametrize("w", [6.3, 50.0])
def test_a_rise_that_is_smaller_than_the_tolerance_keeps_its_slope(w):
    """Asperities of a hundredth of the friction, met at a thousandth of the film's speed, are most of the slope."""
    law = Hump(a=0.1, v=3.16, w=w, b=1e-3, z=0.0316)
    table = curve_table(law, ROLLING, 1e-2)
    middle = table.nodes.shape[0] // 2
    slope = table.nodes[middle, 1] * middle / table.limits[1] / table.sliding_scale
    assert slope == pytest.approx(law.slope(0.0), rel=1e-8)
    assert table.slope_error <= 1e-6
    assert table.error <= 1e-2


@given(tabulated())
@settings(max_examples=15)
def test_an_odd_law_stays_odd_and_the_ends_are_held(case):
    _, _, table = case
    np.testing.assert_array_equal(table.nodes[:, 0], -table.nodes[::-1, 0])
    np.testing.assert_array_equal(table.nodes[:, 1], table.nodes[::-1, 1])
    V = np.concatenate((np.geomspace(1e-9, 1.0, 200) * REACH, [0.0]))
    found = friction_of(table, V)
    np.testing.assert_allclose(friction_of(table, -V), -found, rtol=0.0, atol=rounding(table))
    assert found[-1] == 0.0
    beyond = friction_of(table, REACH * np.array([1.0, 1.001, 10.0, 1e9]))
    np.testing.assert_allclose(beyond, table.nodes[-1, 0], rtol=1e-14)


@given(tabulated())
@settings(max_examples=15)
def test_value_and_slope_are_continuous_at_the_nodes(case):
    _, _, table = case
    x = np.linspace(*table.limits, table.nodes.shape[0])
    size = np.abs(table.nodes[:, 0]).max()
    step = 1e-3
    near = x[1:-1] + (x[1] - x[0]) * step * np.array([[-2], [-1], [0], [1], [2]])
    f = friction_of(table, (table.sliding_scale * near / (1.0 - np.abs(near))).ravel()).reshape(
        near.shape
    )
    np.testing.assert_allclose(f[2], table.nodes[1:-1, 0], rtol=0.0, atol=rounding(table))
    before = (3 * f[2] - 4 * f[1] + f[0]) / (2 * step)
    after = (-3 * f[2] + 4 * f[3] - f[4]) / (2 * step)
    steepest = np.abs(table.nodes[:, 1]).max()
    np.testing.assert_allclose(
        before, table.nodes[1:-1, 1], rtol=0.0, atol=1e-5 * steepest + 1e-12 * size
    )
    np.testing.assert_allclose(
        after, table.nodes[1:-1, 1], rtol=0.0, atol=1e-5 * steepest + 1e-12 * size
    )


# Order ---------------------------------------------------------------------------------------------------------------


def test_the_order_is_four_everywhere_and_at_the_maximum():
    law = Hump(0.02, 0.5, 4.0)
    best = law.extrema()[0]
    tables = {}
    for tolerance in np.geomspace(1e-3, 3e-9, 40):
        table = curve_table(law, ROLLING, tolerance)
        tables[table.nodes.shape[0]] = table
    errors = []
    at_maximum = []
    for table in tables.values():
        V = places(table, 20)
        off = np.abs(friction_of(table, V.ravel()) - law(V).ravel()).reshape(V.shape).max(axis=1)
        errors.append(off.max())
        at_maximum.append(off[(V[:, 0] >= 0.8 * best) & (V[:, -1] <= 1.25 * best)].max())
        assert abs(table.critical_speed / best - 1.0) < 1e-7
    assert len(tables) >= 4
    for found in (errors, at_maximum):
        orders = [math.log2(a / b) for a, b in itertools.pairwise(found)]
        assert orders[-2:] == pytest.approx([4.0, 4.0], abs=0.3), orders


def test_extrema_that_are_no_nodes_are_neither_flattened_nor_moved():
    """A second maximum and the minimum between: the largest friction alone is made a node."""
    law = Hump(0.02, 2.0, 20.0, 0.01, 0.1)
    first, least, largest = law.extrema()
    table = curve_table(law, ROLLING, 1e-5)
    assert table.critical_speed == pytest.approx(largest, rel=1e-7)
    for at, sign in ((first, -1.0), (least, 1.0)):
        found = minimize_scalar(
            lambda V, sign=sign: sign * friction_of(table, [V])[0],
            bounds=(0.8 * at, 1.2 * at),
            method="bounded",
            options={"xatol": 1e-9},
        )
        assert found.x == pytest.approx(at, rel=1e-2)
        assert sign * found.fun == pytest.approx(float(law(at)), rel=2e-5)


# Bearings ------------------------------------------------------------------------------------------------------------


def bearing(**changes):
    return assemble(evolve(load_scene("1032930-50C"), {"accuracy.slices": 5, **changes}, si=True))


def all_slices(raceway, load, rolling):
    """Effective friction as its definition has it, of every loaded slice."""
    loaded = load[load > 0.0]

    def friction(V):
        return (
            np.array(
                [raceway.evaluate(loaded, rolling, one).friction @ loaded for one in np.ravel(V)]
            )
            / loaded.sum()
        )

    return friction


SCENES = st.fixed_dictionaries(
    {
        "operation.temperature": st.floats(300.0, 390.0),
        "operation.radial_load": st.floats(500.0, 2e4),
        "operation.inner_speed": st.floats(100.0, 900.0),
        "lubricant.eyring_stress": st.floats(1e6, 1e7),
        "surface.roller_roughness": st.floats(2e-8, 8e-7),
    }
)


@given(SCENES, st.integers(0, 1))
@settings(max_examples=12, phases=[Phase.explicit, Phase.generate], derandomize=True)
def test_curves_of_bearings_are_those_of_all_their_slices(changes, ring):
    assembly = bearing(**changes)
    raceway = assembly.raceways[ring]
    distribution = assembly.load_distribution(4)
    load = (distribution.inner_load, distribution.outer_load)[ring].reshape(-1, 5)
    rolling = float(assembly.kinematics.surface_speeds(0.0, 0.0).inner_rolling)
    friction = all_slices(raceway, load, rolling)
    table = effective_table(assembly, raceway, load, 1e-3)
    V = places(table, 3)[::4]
    true = friction(V)
    assert np.abs(friction_of(table, V.ravel()) - true).max() <= 1e-3 * np.abs(true).max()
    joined = friction_of(table, np.unique(places(table, 8)))
    assert turns(joined, rounding(table)) == turns(table.nodes[:, 0], rounding(table))
    near = 1e-9 * table.sliding_scale
    middle = table.nodes.shape[0] // 2
    slope = table.nodes[middle, 1] * middle / table.limits[1] / table.sliding_scale
    assert abs(slope / (friction(near)[0] / near) - 1.0) <= table.slope_error + 1e-4
    if not math.isnan(table.critical_speed):
        found = minimize_scalar(
            lambda V: -friction(V)[0],
            bounds=(0.9 * table.critical_speed, 1.1 * table.critical_speed),
            method="bounded",
            options={"xatol": 1e-8 * table.critical_speed},
        )
        assert abs(table.critical_speed / found.x - 1.0) <= table.critical_error + 1e-6
        assert (
            abs(float(friction_of(table, [table.critical_speed])[0]) / -found.fun - 1.0)
            <= table.critical_error
        )


def loads_of(assembly):
    distribution = assembly.load_distribution(4)
    return distribution.inner_load.reshape(-1, distribution.inner_load.shape[2])


def test_a_table_does_not_depend_on_threads():
    assembly = bearing(**{"accuracy.slices": 15})
    load = loads_of(assembly)

    def made(_=None):
        return effective_table(assembly, assembly.inner, load, 1e-2).nodes

    first = made()
    with ThreadPoolExecutor(4) as pool:
        for nodes in pool.map(made, range(4)):
            np.testing.assert_array_equal(nodes, first)


# Hard laws -----------------------------------------------------------------------------------------------------------


def test_friction_that_does_not_change_is_a_flat_table():
    table = curve_table(lambda V: np.full_like(V, 0.03), ROLLING, 1e-8)
    np.testing.assert_allclose(
        friction_of(table, np.linspace(-REACH, REACH, 101)), 0.03, rtol=1e-15
    )
    assert (table.error, table.slope_error) == (0.0, 0.0)
    assert math.isnan(table.critical_speed)


@pytest.mark.parametrize("law", [lambda V: 0.05 * V / np.hypot(V, 0.5), lambda V: 1e-4 * V])
def test_friction_without_a_maximum_has_no_critical_speed(law):
    table = curve_table(law, ROLLING, 1e-6)
    assert math.isnan(table.critical_speed)
    assert table.record["critical_speed"] is table.record["critical_error"] is None
    V = places(table, 11)
    found = friction_of(table, V.ravel())
    np.testing.assert_allclose(found, law(V).ravel(), rtol=0.0, atol=1.125e-6 * law(REACH))
    assert turns(found, rounding(table)) == 0


def test_a_kink_of_the_law_gives_no_ripple():
    """A maximum with a corner in it is the critical speed, and met by a node."""

    def law(V):
        return np.sign(V) * np.where(np.abs(V) < 2.0, 0.01 * np.abs(V), 0.04 / (np.abs(V) + 1e-300))

    table = curve_table(lambda V: np.minimum(law(V), 0.02) if np.ndim(V) else law(V), ROLLING, 1e-2)
    V = places(table, 16)
    assert turns(friction_of(table, np.unique(V)), rounding(table)) == 2
    assert table.critical_speed == pytest.approx(2.0, rel=1e-6)


def corner(V):
    """A rise that ends in a corner, and a slow one beyond: splines overshoot here."""
    return 0.02 * np.sign(V) * np.minimum(np.abs(V) / 3.0, 1.0 + 1e-4 * np.abs(V))


def test_a_corner_makes_no_ripple():
    table = curve_table(corner, ROLLING, 5e-3)
    assert turns(friction_of(table, np.unique(places(table, 16))), rounding(table)) == 0


def test_a_law_that_bends_far_from_where_it_rises_gets_the_cells_that_it_takes():
    law = lambda V: np.tanh(V / 1e-7) + np.tanh(V / 1e-2)  # noqa: E731
    table = curve_table(law, 10.0, 1e-4)
    V = np.geomspace(1e-9, 1.0, 997)
    assert table.nodes.shape[0] > 4097
    assert np.abs(friction_of(table, V) - law(V)).max() < 2e-4


def test_a_law_that_jumps_is_said_to_be_too_much():
    with pytest.raises(
        ConvergenceError,
        match=r"relative error of .* with the most nodes.*raise accuracy\.tolerance",
    ):
        curve_table(np.sign, ROLLING, 1e-3)


@pytest.mark.parametrize("tolerance", [1e-7, 1e-8])
def test_a_very_small_tolerance_is_reached(tolerance):
    assembly = bearing()
    load = loads_of(assembly)[::7]
    rolling = float(assembly.kinematics.surface_speeds(0.0, 0.0).inner_rolling)
    table = effective_table(assembly, assembly.inner, load, tolerance)
    V = rolling * np.geomspace(1e-6, 8.0, 200)
    true = all_slices(assembly.inner, load, rolling)(V)
    assert np.abs(friction_of(table, V) - true).max() <= tolerance * true.max()


def test_a_tolerance_below_rounding_is_refused():
    assembly = bearing()
    says = r"the table of effective friction still has a relative error of .* raise accuracy\.tolerance"
    with pytest.raises(ConvergenceError, match=says):
        effective_table(assembly, assembly.inner, loads_of(assembly)[:1], 1e-17)


def test_where_nothing_is_loaded_there_is_no_friction():
    assembly = bearing()
    table = effective_table(assembly, assembly.inner, np.zeros((4, 5)), 1e-3)
    assert np.all(table.nodes == 0.0)
    assert (table.error, table.slope_error) == (0.0, 0.0)
    np.testing.assert_array_equal(friction_of(table, [-1.0, 0.0, 1.0]), 0.0)


def test_a_film_that_passes_the_limits_of_the_blend_is_tabulated():
    assembly = bearing(**{"operation.temperature": 380.0, "surface.roller_roughness": 6e-7})
    load = loads_of(assembly)
    table = effective_table(assembly, assembly.inner, load, 1e-2)
    rolling = float(assembly.kinematics.surface_speeds(0.0, 0.0).inner_rolling)
    V = rolling * np.concatenate((np.geomspace(1e-5, 2.0, 30), -np.geomspace(1e-5, 2.0, 30)))
    true = all_slices(assembly.inner, load, rolling)(V)
    assert np.abs(friction_of(table, V) - true).max() <= 1e-2 * np.abs(true).max()
    film = assembly.inner.evaluate(load[load > 0.0], rolling, 0.0).film_thickness
    assert (film / assembly.inner.conditions.roughness).min() < 1.5


# Results -------------------------------------------------------------------------------------------------------------


def test_a_motion_says_how_right_its_tables_are():
    changes = {
        "accuracy.slices": 5,
        "accuracy.tolerance": 1e-2,
        "study.dynamics": {
            "friction": "effective",
            "duration": 1e-3,
            "points": 3,
        },
        "study.effective-friction.closure": "free-roller",
        "study.effective-friction.max_cage_slip": 0.4,
        "study.effective-friction.points": 11,
        "study.effective-friction.skidding_range": 0,
    }
    found = run(evolve(load_scene("1032930-50C"), changes, si=True), "dynamics")
    records = json.loads(found.attrs["effective_tables"])
    assert list(records) == ["inner", "outer"]
    for record in records.values():
        assert 0.0 < record["error"] <= 1e-2
        assert 0.0 <= record["slope_error"] <= 1e-2
        assert 0.0 < record["critical_error"] <= 1e-2
        assert record["critical_speed"] > 0.0
        assert len(record["nodes"]) == 1
    conventional = changes | {
        "study.dynamics": {"friction": "conventional", "duration": 1e-3, "points": 3}
    }
    assert (
        "effective_tables"
        not in run(evolve(load_scene("1032930-50C"), conventional, si=True), "dynamics").attrs
    )


@pytest.mark.quick
@pytest.mark.parametrize("nodes", [4, 5, 9, 33, 300])
def test_slopes_are_those_of_the_library_s_splines(nodes):
    rng = np.random.default_rng(nodes)
    places = np.arange(nodes)
    values = rng.normal(size=nodes)
    rise = rng.normal()
    clamped = CubicSpline(places, values, bc_type=((1, rise), "not-a-knot"))
    np.testing.assert_allclose(tables._spline(values, rise), clamped(places, 1), rtol=0, atol=1e-13)


def test_what_classes_of_load_leave_is_added_to_what_cells_leave(monkeypatch):
    assembly = assemble(load_scene("1032930-50C"))
    found = []
    for left in ((0.0, 0.0, 0.0), (1e-3, 2e-3, 3e-3)):
        monkeypatch.setattr(
            tables,
            "_group_slices",
            lambda *_, left=left: (Hump(0.02, 0.1, 5.0), left),
        )
        found.append(effective_table(assembly, assembly.inner, np.ones((2, 3)), 1e-2))
    more = [
        getattr(found[1], name) - getattr(found[0], name)
        for name in ("error", "slope_error", "critical_error")
    ]
    assert more == pytest.approx([1e-3, 2e-3, 3e-3])
