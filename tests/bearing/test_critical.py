"""The largest friction of a curve: found between the points of its grid, or said why not."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rollslip.bearing.critical import find_critical_slip, search_range_hint, slip_grid

pytestmark = pytest.mark.quick


def test_slips_are_quadratically_denser_towards_zero():
    np.testing.assert_allclose(slip_grid(0.8, 5), [0.0, 0.05, 0.2, 0.45, 0.8], rtol=1e-15)


@given(st.floats(0.01, 0.9), st.floats(1e-4, 10.0))
def test_locate_finds_the_maximum_of_a_known_curve(peak, height):
    slip = np.linspace(0.0, 1.0, 41) ** 2

    def friction(s):
        return height * s / peak * np.exp(1.0 - s / peak)  # maximum height at peak

    found = find_critical_slip(friction, slip, friction(slip), "max")
    # a maximum is only found to the root of the rounding of its value
    assert found.slip == pytest.approx(peak, abs=3e-7)
    assert found.friction == pytest.approx(height, rel=1e-12)
    assert found.bound == found.slip


@pytest.mark.parametrize(
    ("values", "status", "bound"),
    [
        ([0.0, 0.0, 0.0, 0.0], "there is no friction", np.nan),
        ([0.0, 1.0, 2.0, 3.0], "still rises", 0.3),
        ([0.0, 1.0, 1.0, 1.0], "stays at its largest value", 0.3),
    ],
)
def test_locate_says_in_words_what_there_is_instead(values, status, bound):
    slip = np.linspace(0.0, 0.3, 4)
    found = find_critical_slip(
        lambda s: float(np.interp(s, slip, values)), slip, np.array(values), "max_slip"
    )
    assert status in found.status
    assert np.isnan(found.slip)
    assert np.isnan(found.friction)
    assert found.bound == pytest.approx(bound, nan_ok=True)


def test_two_equal_maxima_give_the_first():
    slip = np.linspace(0.0, 1.0, 101)
    friction = np.sin(2 * np.pi * slip) ** 2
    found = find_critical_slip(
        lambda s: float(np.sin(2 * np.pi * s) ** 2), slip, friction, "max_slip"
    )
    assert found.slip == pytest.approx(0.25, abs=1e-6)


@pytest.mark.parametrize("first", [0.1, 0.4, 0.6])
@pytest.mark.parametrize("end", [0.5, 1.0])
def test_a_first_maximum_is_located_beside_a_larger_one_or_a_rise_to_the_end(first, end):
    """Two parabolas, whose tops are known by hand: of 1 near the start, of 2 at 0.5."""
    top = 0.2 * first

    def friction(s):
        return np.maximum(1.0 - ((s - top) / top) ** 2, 2.0 - ((s - 0.5) / 0.2) ** 2)

    slip = slip_grid(end, 81)
    found = find_critical_slip(lambda s: float(friction(s)), slip, friction(slip), "study.a.b")
    assert found.first_slip == pytest.approx(top, rel=1e-6)
    assert found.first_friction == pytest.approx(1.0, rel=1e-12)
    if end > 0.5:
        assert (found.slip, found.friction) == (
            pytest.approx(0.5, rel=1e-6),
            pytest.approx(2.0, rel=1e-12),
        )
    else:
        assert np.isnan(found.slip)


def test_a_single_maximum_is_the_first_too_and_a_ripple_is_none():
    slip = np.linspace(0.0, 1.0, 101)
    ripple = 1e-5 * (np.arange(101) % 2)

    def friction(s):
        return s / 0.5 * np.exp(1.0 - s / 0.5) + np.interp(s, slip, ripple)

    found = find_critical_slip(lambda s: float(friction(s)), slip, friction(slip), "")
    assert (found.first_slip, found.first_friction) == (found.slip, found.friction)
    assert found.slip == pytest.approx(0.5, abs=0.02)
    rising = find_critical_slip(lambda s: s, slip, slip, "")
    assert np.isnan([rising.first_slip, rising.first_friction]).all()


@pytest.mark.parametrize(
    ("largest", "most", "value"),
    [
        (0.05, 0.99, "0.5"),
        (0.3, 0.99, "0.99"),
        (0.99, 0.99, ""),
        (1.0 - 1e-9, 0.99, ""),
        (0.3, 2.0, "2"),
        (2.0, 2.0, ""),
        (30.0, 2.0, ""),
    ],
)
def test_a_range_that_is_at_its_end_is_not_advised_to_go_further(largest, most, value):
    said = search_range_hint("study.a.b", largest, most)
    assert said == (f"; look further with --set study.a.b={value}" if value else "")
    assert search_range_hint("", 0.1, 0.99) == "", "there is not a key"
