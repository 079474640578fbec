"""Kinematics and roller profiles."""

import attrs
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rollslip.bearing.kinematics import Kinematics
from rollslip.errors import DomainError
from rollslip.models.profile import profile_drop, slice_positions

pytestmark = pytest.mark.quick

SPEED_6371 = 6371 * 2 * np.pi / 60
BEARING = Kinematics(0.0825, 0.0975, 0.0075, inner_speed=SPEED_6371, outer_speed=0.0)

radii = st.tuples(st.floats(0.01, 1.0), st.floats(0.002, 0.5), st.floats(-1e-3, 1e-3)).map(
    lambda t: (t[0], t[0] + 2 * t[1] * t[0] + t[2] * t[0], t[1] * t[0])
)
speeds = st.floats(-3000, 3000)
slips = st.floats(-1, 1)


@st.composite
def bearings(draw):
    inner, outer, roller = draw(radii)
    inner_speed = draw(speeds)
    outer_speed = draw(speeds)
    assume(abs(inner_speed - outer_speed) > 1e-3)
    bearing = Kinematics(inner, outer, roller, inner_speed, outer_speed)
    assume(bearing.epicyclic_cage_speed != 0.0)
    return bearing


def test_values_of_the_1032930():
    assert BEARING.epicyclic_cage_speed == pytest.approx(305.8, abs=0.05)
    assert BEARING.inner_equivalent_radius == pytest.approx(6.875e-3, rel=1e-14)
    assert BEARING.outer_equivalent_radius == pytest.approx(8.125e-3, rel=1e-14)
    assert BEARING.orbit_radius == pytest.approx(0.09, rel=1e-15)
    assert BEARING.surface_speeds(0.0, 0.0).inner_rolling == pytest.approx(29.8, abs=0.05)
    assert 0.0207 * BEARING.epicyclic_cage_speed**2 * BEARING.orbit_radius == pytest.approx(
        174, abs=0.5
    )


@given(bearings())
def test_nothing_slides_at_the_epicyclic_speeds(bearing):
    speeds = bearing.surface_speeds(0.0, 0.0)
    assert speeds.inner_sliding == speeds.outer_sliding == 0.0
    assert speeds.inner_rolling == speeds.outer_rolling > 0.0


@given(bearings(), slips, slips)
def test_surface_speeds_are_those_of_the_cage_and_roller_speeds(bearing, cage_slip, roller_slip):
    b = bearing
    s = bearing.surface_speeds(cage_slip, roller_slip)
    wi = b.direction * b.inner_speed
    wo = b.direction * b.outer_speed
    inner = b.inner_radius * (wi - s.cage_speed)
    outer = b.outer_radius * (s.cage_speed - wo)
    roller = b.roller_radius * s.roller_speed
    scale = b.outer_radius * (abs(wi) + abs(wo) + abs(s.cage_speed)) + abs(roller)
    assert s.inner_sliding == pytest.approx(inner - roller, abs=1e-13 * scale)
    assert s.outer_sliding == pytest.approx(roller - outer, abs=1e-13 * scale)
    assert s.inner_rolling == pytest.approx((inner + roller) / 2, abs=1e-13 * scale)
    assert s.outer_rolling == pytest.approx((outer + roller) / 2, abs=1e-13 * scale)
    lag = (b.inner_radius + b.outer_radius) * (b.epicyclic_cage_speed - s.cage_speed)
    assert s.inner_sliding + s.outer_sliding == pytest.approx(lag, abs=1e-13 * scale)
    assert 1 - s.cage_speed / b.epicyclic_cage_speed == pytest.approx(cage_slip, abs=1e-13)


@given(bearings(), slips)
def test_outer_contact_rolls_at_the_roller_slip_that_says_so(bearing, cage_slip):
    s = bearing.surface_speeds(cage_slip, bearing.roller_slip_outer_rolling(cage_slip))
    assert abs(s.outer_sliding) <= 1e-14 * (abs(s.inner_sliding) + s.inner_rolling)


@given(bearings(), slips)
def test_leads_are_the_sliding_speeds_without_roller_slip(bearing, cage_slip):
    s = bearing.surface_speeds(cage_slip, 0.0)
    assert bearing.leads(cage_slip) == (s.inner_sliding, s.outer_sliding)


@given(bearings(), slips, slips)
def test_bearing_turning_backwards_is_described_by_its_mirror_image(
    bearing, cage_slip, roller_slip
):
    mirrored = attrs.evolve(
        bearing, inner_speed=-bearing.inner_speed, outer_speed=-bearing.outer_speed
    )
    assert mirrored.direction == -bearing.direction
    ours, theirs = (
        attrs.astuple(b.surface_speeds(cage_slip, roller_slip)) for b in (bearing, mirrored)
    )
    assert ours == theirs
    assert mirrored.epicyclic_roller_speed == bearing.epicyclic_roller_speed > 0.0


def test_surface_speeds_broadcast():
    s = BEARING.surface_speeds(np.linspace(0, 0.2, 5)[:, None], [0.0, 0.1, 0.2])
    assert {np.shape(array) for array in attrs.astuple(s)} == {(5, 3)}


@pytest.mark.parametrize(
    ("changes", "error", "says"),
    [
        ({"outer_speed": SPEED_6371}, DomainError, "nothing rolls"),
        ({"outer_radius": 0.08}, ValueError, "must exceed"),
        ({"roller_radius": 0.1}, ValueError, "must exceed"),
        ({"roller_radius": 0.0}, ValueError, "roller_radius"),
        ({"inner_radius": float("nan")}, ValueError, "inner_radius"),
        ({"inner_speed": float("inf")}, ValueError, "inner_speed"),
    ],
)
def test_impossible_bearings_are_refused(changes, error, says):
    with pytest.raises(error, match=says):
        attrs.evolve(BEARING, **changes)


def test_cage_slip_needs_a_moving_cage():
    bearing = Kinematics(1.0, 2.0, 0.5, inner_speed=2.0, outer_speed=-1.0)
    with pytest.raises(DomainError, match="cage slip"):
        bearing.surface_speeds(0.1, 0.0)
    with pytest.raises(DomainError, match="cage slip"):
        bearing.roller_slip_outer_rolling(0.1)


@given(st.floats(1e-3, 1.0), st.integers(1, 200))
def test_slices_are_equal_symmetric_and_inside(length, n):
    x = slice_positions(length, n)
    assert x.shape == (n,)
    assert np.array_equal(x, -x[::-1])
    assert np.diff(x, prepend=x[0] - length / n) == pytest.approx(length / n, rel=1e-9)
    assert np.all(np.abs(x) < length / 2)


@pytest.mark.parametrize(("length", "n"), [(0.0, 3), (-1.0, 3), (float("nan"), 3), (0.015, 0)])
def test_slices_need_a_roller(length, n):
    with pytest.raises(ValueError, match="must be positive"):
        slice_positions(length, n)


X = slice_positions(0.015, 41)


def test_profiles_follow_their_formulas():
    assert np.all(profile_drop("none", X, 0.015, 0.012) == 0.0)
    log = 0.00035 * 0.012 * np.log(1 / (1 - (2 * X / 0.015) ** 2))
    assert profile_drop("iso16281", X, 0.015, 0.012) == pytest.approx(log, rel=1e-12)
    crown = 1.0 - np.sqrt(1.0 - X**2)
    assert profile_drop("circular", X, 0.015, 0.012, radius=1.0) == pytest.approx(crown, abs=1e-16)
    assert profile_drop("circular", 5e-3, 0.015, 0.012, radius=20.0) == pytest.approx(
        6.25e-7, rel=1e-6
    )


def test_logarithmic_profile_has_its_quadratic_limit_in_the_middle():
    x = 1e-9
    assert profile_drop("iso16281", x, 0.015, 0.012) == pytest.approx(
        0.00035 * 0.012 * (2 * x / 0.015) ** 2, rel=1e-9
    )


@given(st.lists(st.floats(0, 1e-4), min_size=2, max_size=8))
def test_profile_table_is_met_at_its_points_and_not_exceeded_between(drops):
    positions = np.linspace(-0.0075, 0.0075, len(drops))
    assert profile_drop(
        "table", positions, 0.015, 0.012, table=(positions, drops)
    ) == pytest.approx(drops, abs=1e-18)
    between = profile_drop(
        "table", np.linspace(-0.0075, 0.0075, 101), 0.015, 0.012, table=(positions, drops)
    )
    assert min(drops) - 1e-18 <= between.min() <= between.max() <= max(drops) + 1e-18


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"shape": "log"}, "unknown roller profile 'log': one of none, iso16281"),
        ({"shape": "circular"}, "needs 'radius'"),
        ({"shape": "table"}, "needs 'table'"),
        ({"shape": "none", "radius": 1.0}, "has no 'radius'"),
        ({"shape": "circular", "radius": 0.005}, "does not span"),
        ({"shape": "none", "positions": [0.008]}, "must lie on the roller"),
        ({"shape": "none", "positions": [np.nan]}, "must lie on the roller"),
        ({"shape": "none", "roller_diameter": -1.0}, "must be positive"),
        ({"shape": "table", "table": ([-0.007, 0.0075], [0, 0])}, "must cover the roller"),
        ({"shape": "table", "table": ([0.0075, -0.0075], [0, 0])}, "must ascend"),
        (
            {"shape": "table", "table": ([-0.0075, 0.0, 0.0, 0.0075], [0, 0, 1e-6, 0])},
            "must ascend",
        ),
        ({"shape": "table", "table": ([-0.0075, 0.0075], [0, 0, 0])}, "as many drops"),
        ({"shape": "table", "table": ([-0.0075, 0.0075], [0, np.inf])}, "must be finite"),
    ],
)
def test_unfit_profiles_are_refused(arguments, says):
    with pytest.raises(ValueError, match=says):
        profile_drop(
            **{"positions": X, "roller_length": 0.015, "roller_diameter": 0.012} | arguments
        )


def test_logarithmic_profile_has_no_ends():
    with pytest.raises(DomainError, match="infinite at the ends"):
        profile_drop("iso16281", [0.0075], 0.015, 0.012)
