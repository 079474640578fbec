"""Maxima and roots of curves that are known in closed form, or to 30 digits by mpmath, or by SciPy."""

import math
from functools import partial

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq
from scipy.optimize.elementwise import find_minimum

from rollslip.search import find_maxima, illinois_root, polynomial_maximum, secant_root

pytestmark = pytest.mark.quick

#: Curves over 0 to 1, with one maximum inside, of numpy or of mpmath.
SMOOTH = {
    "rises steeply": lambda x, m=np: x * m.exp(-9.0 * x),
    "falls steeply": lambda x, m=np: x**5 * (1.0 - x),
    "bell": lambda x, m=np: m.exp(-(((x - 0.3) / 0.2) ** 2)),
    "narrow": lambda x, m=np: m.exp(-(((x - 0.3001) / 1e-3) ** 2)),
    "on a slope": lambda x, m=np: m.log1p(50.0 * x) / (1.0 + 3.0 * x * x),
}


class Counted:
    """Curves that are counted: how often they are asked, together, and each of them."""

    def __init__(self, *curves):
        self.curves = curves
        self.calls = 0
        self.each = np.zeros(len(curves), dtype=int)

    def __call__(self, rows, places):
        self.calls += 1
        self.each += np.bincount(rows, minlength=self.each.size)
        return np.array(
            [self.curves[row](at) for row, at in zip(rows.tolist(), places, strict=True)]
        )

    def found(self, x):
        """What is found between samples (n, 3)."""
        y = np.array([[curve(at) for at in of] for curve, of in zip(self.curves, x, strict=True)])
        return find_maxima(self, np.array(x, dtype=float), y)


def sampled(curve, points=21):
    """Three samples about the largest of a grid, 0 to 1."""
    grid = np.linspace(0.0, 1.0, points)
    top = int(np.argmax(curve(grid)))
    return grid[[max(top - 1, 0), top, min(top + 1, points - 1)]]


def exact(name, low, high):
    """Place and value of the maximum between two places to 30 digits."""
    with mpmath.workdps(30):
        slope = partial(mpmath.diff, partial(SMOOTH[name], m=mpmath))
        at = mpmath.findroot(slope, (low, high), solver="anderson", verify=False)
        return float(at), float(SMOOTH[name](at, mpmath))


@pytest.mark.parametrize("size", [1.0, 1e-200, 1e200])
@pytest.mark.parametrize("wide", [1.0, 1e-9, 1e9])
def test_maxima_of_smooth_curves_are_those_of_thirty_digits(size, wide):
    curves = Counted(*(lambda x, of=of: size * of(x / wide) for of in SMOOTH.values()))
    points = [1001 if name == "narrow" else 21 for name in SMOOTH]
    places, heights = curves.found(
        [wide * sampled(of, n) for of, n in zip(SMOOTH.values(), points, strict=True)]
    )
    for k, (name, of) in enumerate(SMOOTH.items()):
        low, _, high = sampled(of, points[k])
        at, height = exact(name, low, high)
        assert abs(places[k] / wide - at) < 2e-8 * (high - low), name
        assert heights[k] == pytest.approx(size * height, rel=1e-15), name
    assert max(curves.each) <= 18
    assert curves.calls == max(curves.each) - 1, "what curves ask for is evaluated together"


def test_a_curve_is_what_it_is_alone_whatever_is_searched_beside_it():
    x = [sampled(of) for of in SMOOTH.values()]
    together = Counted(*SMOOTH.values()).found(x)
    for k, of in enumerate(SMOOTH.values()):
        alone = Counted(of).found(x[k : k + 1])
        assert (alone[0][0], alone[1][0]) == (together[0][k], together[1][k])


@given(
    st.floats(0.02, 0.98),
    st.sampled_from([1.0, 1.5, 2.0, 3.0, 6.0]),
    st.floats(0.01, 0.3),
    st.floats(0.2, 1.0),
)
def test_it_is_as_good_as_the_library_on_peaks_from_kinks_to_flat_ones(peak, power, width, skew):
    def curve(x):
        return np.exp(-(np.abs((x - peak) / width * np.where(x < peak, skew, 1.0)) ** power))

    x = sampled(curve, 41)
    counted = Counted(curve)
    (place,), (height,) = counted.found([x])
    tolerances = {"xatol": 1e-10, "xrtol": 0.0, "fatol": 0.0, "frtol": 0.0}
    if x[0] < x[1] < x[2]:
        want = find_minimum(lambda at: -curve(at), tuple(x), tolerances=tolerances, maxiter=300)
        off = (2e-8 * (x[2] - x[0]) / width) ** power
        # where samples differ by rounding alone a search ends early: 2.1e-14 at most in 6,000 random peaks
        assert height >= -want.f_x * (1.0 - max(off, 5e-14))
    assert height >= curve(x).max()
    assert x[0] <= place <= x[2]
    assert counted.calls <= 60


@pytest.mark.parametrize("at", [0.5, 0.5 + 1e-3, 0.5031, 0.5249])
@pytest.mark.parametrize(("left", "right"), [(1.0, 1.0), (1.0, 0.1), (5.0, 100.0)])
def test_a_kink_is_placed_to_1e_8_of_the_interval(at, left, right):
    def curve(x):
        return 1e3 - np.where(x < at, left, right) * np.abs(x - at)

    (place,), (height,) = Counted(curve).found([(0.45, 0.5, 0.55)])
    assert place == pytest.approx(at, abs=2e-9)
    assert height >= 1e3 - 2e-9 * max(left, right)


@pytest.mark.parametrize(
    ("curve", "x", "place"),
    [
        (lambda x: 1.0 + 0.0 * x, (0.0, 0.25, 1.0), 0.25),  # constant: the middle sample
        (lambda x: np.minimum(x, 0.25), (0.0, 0.25, 1.0), 0.25),  # a plateau begins at it
        (lambda x: np.minimum(1.0 - x, 0.5), (0.0, 0.25, 1.0), 0.25),  # or lies on its left
        (lambda x: 1.0 - x, (0.0, 0.0, 1.0), 0.0),  # at an end, from which it falls
        (lambda x: 1.0 + x, (0.0, 1.0, 1.0), 1.0),
        (lambda x: 1.0 + 0.0 * x, (0.0, 0.0, 1.0), 0.0),  # or keeps its value
    ],
)
def test_the_middle_sample_is_the_largest_where_no_other_value_is_larger(curve, x, place):
    curves = Counted(curve)
    found, height = curves.found([x])
    assert (found[0], height[0]) == (place, curve(np.array(place)))
    assert curves.calls <= 45


@pytest.mark.parametrize("at", [1e-3, 0.03, 0.3])
def test_a_maximum_beside_an_end_that_is_the_largest_sample_is_found(at):
    """Of two parabolas, from either end; the other end is as low as it gets."""
    (left, right), heights = Counted(
        lambda x: 2.0 - (x - at) ** 2, lambda x: 2.0 - (1.0 - x - at) ** 2
    ).found([(0.0, 0.0, 1.0), (0.0, 1.0, 1.0)])
    assert (left, right) == (pytest.approx(at, abs=1e-8), pytest.approx(1.0 - at, abs=1e-8))
    assert heights.tolist() == pytest.approx([2.0, 2.0], rel=1e-15)


@pytest.mark.parametrize(("a", "b"), [(0.35, 0.45), (0.26, 0.9), (0.0, 0.2), (0.0, 0.24999)])
def test_a_gap_is_nowhere_larger(a, b, recwarn):
    def curve(x):
        return np.where((x > a) & (x < b), np.nan, 1.0 - (x - 0.4) ** 2)

    (place,), (height,) = Counted(curve).found([(0.0, 0.25, 1.0)])
    assert not recwarn
    assert height >= float(curve(np.array(0.25)))
    if a < 0.4 < b:
        assert not a < place < b
    else:
        assert place == pytest.approx(0.4, abs=1e-8)


# Vertices -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("apart", [0.1, 1e-4, 1e-8, 1e-11])
def test_a_vertex_among_places_however_near_is_that_of_their_polynomial(apart, recwarn):
    x = (0.2 * apart + np.array([-1.0, -apart, 0.0, apart, 1.0])).tolist()
    at, height = polynomial_maximum(x, [1.0 - t**2 + 0.1 * t**3 for t in x])
    assert at == pytest.approx(0.0, abs=1e-8)
    assert height == pytest.approx(1.0, abs=1e-14)
    assert not recwarn.list


@given(st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3), st.floats(-0.9, 0.9))
def test_a_vertex_is_where_the_derivative_of_the_polynomial_is_zero_to_thirty_digits(terms, middle):
    x = [-1.0, -0.6, -0.1, 0.3, 1.0]
    a, b, c = terms
    curve = lambda t: 5 - 8 * (t - middle) ** 2 + a * t**3 / 9 + b * t**4 / 9 + c * t / 9  # noqa: E731
    y = [curve(t) for t in x]
    at, height = polynomial_maximum(x, y)
    if 0 < int(np.argmax(y)) < 4:
        with mpmath.workdps(30):
            want = mpmath.findroot(lambda t: mpmath.diff(curve, t), at, tol=1e-20, verify=False)
        assert at == pytest.approx(float(want), abs=1e-8)  # flat: a root of rounding
        assert height == pytest.approx(float(curve(want)), rel=1e-14)


def test_the_vertex_of_three_samples_is_that_of_the_parabola_and_of_ends_or_level_ones_the_largest_sample():
    assert polynomial_maximum([0.0, 1.0, 3.0], [1.0, 2.0, 1.0]) == (
        pytest.approx(1.5),
        pytest.approx(2.125),
    )
    assert polynomial_maximum([0.0, 1.0, 3.0], [3.0, 2.0, 1.0]) == (0.0, 3.0)
    assert polynomial_maximum([0.0, 1.0, 3.0], [1.0, 2.0, 3.0]) == (3.0, 3.0)
    assert polynomial_maximum([0.0, 1.0, 3.0, 4.0], [2.0, 2.0, 2.0, 2.0]) == (0.0, 2.0)
    assert polynomial_maximum([1.0, 2.0], [0.0, 1.0]) == (2.0, 1.0)


# Roots ----------------------------------------------------------------------------------------------------------------

ROOTS = {
    "straight": (lambda x: 3.0 * x - 1.0, 1.0 / 3.0),
    "bent": (lambda x: math.exp(5.0 * x) - 10.0, math.log(10.0) / 5.0),
    "saturates": (lambda x: math.tanh(30.0 * (x - 0.7)), 0.7),
    "falls": (lambda x: math.cos(3.0 * x), math.pi / 6.0),
    "flat": (lambda x: (x - 0.4) ** 3, 0.4),
    "pole": (lambda x: 1.0 - 0.01 / (x + 1e-3), 0.009),
}


@pytest.mark.parametrize("name", ROOTS)
@pytest.mark.parametrize("turned", [False, True])
def test_a_bracketed_root_is_that_of_the_library(name, turned):
    curve, root = ROOTS[name]
    low, high = (1.0, 0.0) if turned else (0.0, 1.0)
    requested = []
    found = illinois_root(
        lambda x: requested.append(x) or curve(x),
        low,
        high,
        curve(low),
        curve(high),
        relative=1e-10,
    )
    want = brentq(curve, 0.0, 1.0, xtol=1e-12, maxiter=1000)
    tolerance = 1e-4 if name == "flat" else 1e-10
    assert found == pytest.approx(want, rel=tolerance)
    assert found == pytest.approx(root, rel=tolerance)
    assert found == requested[-1], "what is found has been evaluated"
    assert len(requested) <= (70 if name == "flat" else 20)


def test_a_jump_past_zero_and_an_end_that_is_zero_are_roots_and_a_level_end_is_none():
    jump = illinois_root(lambda x: -1.0 if x < 0.123 else 5.0, 0.0, 1.0, -1.0, 5.0, tolerance=1e-9)
    assert jump == pytest.approx(0.123, abs=1e-8)
    level = illinois_root(lambda x: x**5 - 1e-6, 0.0, 1.0, -1e-6, 1.0 - 1e-6, tolerance=1e-4)
    assert level == pytest.approx(10.0**-1.2, abs=1e-4), (
        "where a curve is level, steps are short far from its root"
    )
    assert illinois_root(lambda x: x, 0.0, 1.0, 0.0, 1.0, relative=1e-10) == 0.0
    assert illinois_root(lambda x: x - 1.0, 0.0, 1.0, -1.0, 0.0, relative=1e-10) == 1.0


@pytest.mark.parametrize(
    ("start", "slope", "found"),
    [(0.1, 2.0, 0.12), (0.118, 5.0, 0.12), (0.5, 1.0, None), (0.1, 0.3, None)],
)
def test_a_root_is_found_from_near_it_or_not_at_all(start, slope, found):
    told = secant_root(
        lambda x: np.tanh(3.0 * (x - 0.12)),
        start,
        slope,
        tolerance=1e-9 * start,
        within=(0.5 * start, 1.5 * start),
    )
    assert told is None if found is None else told[0] == pytest.approx(found, rel=1e-12)
    assert told is None or told[1] == pytest.approx(3.0, rel=1e-3)


@pytest.mark.parametrize("curve", [lambda x: 1.0, lambda x: math.nan, lambda x: 1.0 + x * x])
def test_secants_lead_nowhere_where_there_is_no_root(curve):
    assert secant_root(curve, 0.1, 1.0, tolerance=1e-9, within=(-10.0, 10.0)) is None
    assert secant_root(curve, 0.1, 0.0, tolerance=1e-9, within=(-10.0, 10.0)) is None


def test_steps_of_secants_are_no_longer_than_they_may_be():
    requested = []
    within = (-9.0, 9.0)
    root, _ = secant_root(
        lambda x: requested.append(x) or math.atan(x - 3.0),
        0.0,
        0.1,
        tolerance=1e-9,
        within=within,
        longest=1.0,
    )
    assert root == pytest.approx(3.0, abs=1e-9)
    assert np.abs(np.diff(requested)).max() == 1.0
