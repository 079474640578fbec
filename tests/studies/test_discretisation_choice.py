"""The few slips at which curves are compared, and the fractions of a tolerance that the parts of an error may take."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from rollslip import load_scene, new, plan
from rollslip.bearing.critical import slip_grid
from rollslip.bearing.resolution import Resolution
from rollslip.studies.discretisation.choice import (
    _DISCRETISATION_FRACTION,
    SIMPLIFICATIONS,
    DiscretisedStudy,
    Probe,
    choose_slices_and_positions,
)

pytestmark = pytest.mark.quick


class Study(DiscretisedStudy):
    """A study whose curve is a function of the slip, and which counts the slips that it computes."""

    name = "curve"
    slip_range = 1.0

    def __init__(self, curve):
        object.__setattr__(self, "curve", curve)
        object.__setattr__(self, "computed", [])

    def curves(self, assembly, slip, n_positions):
        self.computed.extend(slip)
        return np.array([[self.curve(np.asarray(slip))] for _ in n_positions])


def peaks(*each):
    """Maxima of some heights over the root of the slip, in which the grid of a probe is even."""
    return lambda slip: sum(
        height * np.exp(-(((np.sqrt(slip) - root) / 0.05) ** 2)) for root, height in each
    )


def maxima(curve):
    """The slips of the maxima that a probe of the curve shows, and how many slips it has computed for them."""
    study = Study(curve)
    probe = Probe(study, None)
    ((_, slips),) = probe.sample(None, 1)
    return slips, len(study.computed)


def test_two_maxima_a_sixth_of_the_range_apart_are_found_by_forty_slips():
    near = 1.0 / 6.0
    found, count = maxima(peaks((0.25, 1.0), (0.25 + near, 1.0)))
    assert np.sqrt(found) == pytest.approx([0.25, 0.25 + near], abs=1e-2)
    assert count <= 40  # those of the grid, of two intervals, and at last those of the probe


@pytest.mark.parametrize("top", [1e-3, 1e-6, 1e-10])
def test_a_maximum_far_below_the_first_slip_of_the_grid_is_found(top):
    """Of friction 2 x/(1 + x^2), x = slip/top, which falls over the whole grid."""
    found, count = maxima(lambda slip: 2.0 * slip / top / (1.0 + (slip / top) ** 2))
    assert found == pytest.approx([top], rel=0.2)
    assert count <= 40 + 8 * math.log(slip_grid(1.0, 13)[1] / top, 4)


def test_a_maximum_counts_that_finer_slices_may_make_the_largest():
    found, _ = maxima(peaks((0.25, 1.0), (0.5, 0.8), (0.75, 0.6)))
    assert np.sqrt(found) == pytest.approx([0.25, 0.5], abs=1e-2)


def test_a_curve_that_is_level_except_for_rounding_has_no_maximum():
    found, _ = maxima(lambda slip: 1.0 + 1e-15 * np.cos(1e5 * slip))
    assert found.size == 0


@pytest.mark.parametrize("top", [0.4, 0.43])
def test_a_vertex_is_as_near_as_the_parabola_through_slips_of_its_step(top):
    """Of 1 - a x^2 (1 - b x) a parabola through three points at a distance h has its vertex off by b h^2/2 at most."""
    skewness = 0.3
    grid = slip_grid(1.0, 13)
    best = int(np.argmin(np.abs(grid - top)))
    step = (grid[best + 1] - grid[best - 1]) / 8.0
    found, _ = maxima(lambda slip: 1.0 - (slip - top) ** 2 * (1.0 - skewness * (slip - top)))
    assert abs(found[0] - top) <= 0.5 * skewness * step**2


def test_curves_are_compared_in_each_quarter_of_the_grid_by_four_slips():
    study = Study(peaks((0.3, 1.0)))
    probe = Probe(study, None)
    study.computed.clear()
    probe.sample(None, 1)
    quarters = np.ceil(4.0 * np.sqrt(study.computed[: len(study.computed) - 3]) - 1e-9)
    assert quarters.tolist() == [1, 2, 3, 4]


def test_parts_of_an_error_may_take_the_whole_tolerance_together_and_no_more():
    """Slices with positions, heat of the inlet, light contacts, and a closed form in place of a law."""
    fractions = [fraction for _, fraction in SIMPLIFICATIONS.values()]
    assert _DISCRETISATION_FRACTION + sum(fractions) == pytest.approx(1.0)


def bearing(resolution):
    """A bearing of which a study needs the accuracy and the resolution alone."""
    return SimpleNamespace(
        scene=load_scene("1032930-70C"), resolution=resolution, slices=resolution.slices, at=bearing
    )


class Coarse(Study):
    """A study whose curve errs by 3/n^2 on n slices, and by B/m^2 on m positions."""

    is_averaged = True

    def curves(self, assembly, slip, n_positions):
        curve = peaks((0.5, 1.0))(slip) * (1.0 + 3.0 / assembly.resolution.slices**2)
        return np.array([[curve * (1.0 + self.curve / m**2)] for m in n_positions])


def test_positions_that_exceed_their_half_of_an_error_make_slices_at_most_half_as_many_again():
    """Nor fewer than where they take that half, which makes slices 2^(1/2) times as many."""
    alone, capped = (
        choose_slices_and_positions(Coarse(B), bearing(Resolution()), 1.0)[0].resolution.slices
        for B in (0.0, 1e6)
    )
    assert 2**0.5 <= capped / alone <= 1.5 * 2**0.5


@pytest.mark.parametrize("compared_as_values", [frozenset(), frozenset({"critical_slip"})])
def test_a_maximum_that_some_positions_lack_is_left_to_a_study_that_gives_it_as_a_value(
    compared_as_values,
):
    """Its slip has no bound then, and took as many positions as the reference resolution has."""

    class Flat(Coarse):
        """A curve whose maximum is at the end of the range for some numbers of positions."""

        def curves(self, assembly, slip, n_positions):
            tilt = {1: 0.0, 2: 3.0}
            return np.array([[slip * (1.0 - slip) + tilt.get(m, 0.0) * slip] for m in n_positions])

    study = Flat(0.0)
    object.__setattr__(study, "compared_as_values", compared_as_values)
    choice, *_ = choose_slices_and_positions(study, bearing(Resolution()), 1.0)
    bounds = choice.errors["n_positions"]
    assert ("critical_slip" in bounds) == (not compared_as_values)
    if not compared_as_values:
        assert bounds["critical_slip"] == math.inf


def test_the_flat_maximum_of_a_heavy_load_takes_no_more_positions_than_its_torque():
    """Torques of this bearing are level from a slip of 20 % on: 128 positions took 40 s in place of 3."""
    scene = new(
        "NU1020", oil="iso-vg-32", speed="882 rpm", load="40 kN", temperature="100 degC", supply="mist"
    )  # fmt: skip
    resolution = plan(scene, "steady-slip").choices["steady-slip"].resolution
    assert resolution.n_positions <= 12
