"""The few slips at which curves are compared: where they lie, what maxima they show, and what they cost."""

import numpy as np
import pytest

from rollslip.bearing.critical import slip_grid
from rollslip.studies.error_estimate import DiscretisedStudy, Probe

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


def test_a_maximum_counts_that_finer_slices_may_make_the_largest():
    found, _ = maxima(peaks((0.25, 1.0), (0.5, 0.8), (0.75, 0.6)))
    assert np.sqrt(found) == pytest.approx([0.25, 0.5], abs=1e-2)


def test_a_vertex_is_as_near_as_the_parabola_through_slips_of_its_step():
    """Of 1 - a x^2 (1 - b x) a parabola through three points at a distance h has its vertex off by b h^2/2 at most."""
    top, skewness = 0.4, 0.3
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
