"""Reference solutions: how much finer they are than a run, and which fraction of its error their difference shows.

A run of n points errs by C n^-p, a reference of N points by C N^-p. Their difference is 1 - (n/N)^p of the error of the
run (`richardson_factor`); divided by this fraction it is the error (Richardson extrapolation).

- Slices alone: `SLICE_FACTOR`, at Gauss points, and `slice_fraction`.
- Roller positions alone: `reference_positions` and `position_fraction`.
- Both together: `joint_references` and `joint_fraction`.
- Slips of a curve that is continued from slip to slip: `reference_slips`.
"""

import math
from typing import Final

#: Lowest order that is taken for an error; one that falls more slowly does not converge. At a half, 2 m + 1 positions
#: show 0.3 of the error of m.
MIN_ORDER: Final = 0.5
#: Highest order that is taken for an error: past the kinks of the loads it falls like n^-2, and more is chance.
MAX_ORDER: Final = 2.0
#: Order that is assumed where two errors do not give one. Chosen, between both limits; with 2 errors would be smaller.
ASSUMED_ORDER: Final = 1.0
#: How many times as many slices a reference solution has where slices alone are refined. With twice as many a contact
#: that ends between two slices may err alike; with 8 the comparison takes twice as long. Chosen.
SLICE_FACTOR: Final = 4
#: How many times as fine a reference solution is where slices and positions are refined together. With 4 the
#: comparison takes four times as long; with less than 2 it shows less than half of an error of order 1. Chosen.
JOINT_FACTOR: Final = 2
#: Order with which errors of slices, and joint errors, fall unless another one is observed: the second on the whole,
#: less by kinks from some numbers to twice as many. With 2 the joint error would be 14 % smaller, with 1 it would be
#: 29 % larger.
JOINT_ORDER: Final = 1.5
#: Factor on a joint error of the minimum over some points, for example the smallest film parameter. The minimum may
#: fall with the order of a half: with twice as many points its error is this many times (2.2) that by `JOINT_ORDER`.
MINIMUM_ERROR_FACTOR: Final = (1.0 - JOINT_FACTOR**-JOINT_ORDER) / (1.0 - JOINT_FACTOR**-MIN_ORDER)
#: Slices of a joint reference at least. Chosen: contacts that end between a few slices may err alike in both runs.
#: Doubled, a check of a coarse run takes twice as long.
_MIN_SLICES: Final = 40
#: Roller positions of a joint reference at least, where a run has fewer slices than `_MIN_SLICES`. Chosen; with few of
#: both they may err alike, and nine cost little on few slices.
_MIN_POSITIONS: Final = 9
#: How many times as many slips a reference solution has where a curve is continued from slip to slip, so that it may
#: depend on the steps. Chosen; with 2 the way through a jump differs less, with 6 a check takes twice as long.
SLIP_FACTOR: Final = 3


def richardson_factor(n: float, fine: float, order: float = MAX_ORDER) -> float:
    """Return the fraction 1 - (n/N)^p of the error of n points by which they differ from N finer ones.

    Richardson extrapolation: the finer ones err, too, so that a difference divided by this factor is the error.

    Parameters
    ----------
    n, fine : float
        Numbers of points.
    order : float
        Order of convergence p, limited to `MIN_ORDER` and `MAX_ORDER`.
    """
    return 1.0 - math.pow(n / fine, min(max(order, MIN_ORDER), MAX_ORDER))


def observed_order(coarse: int, fine: int, coarse_error: float, fine_error: float) -> float:
    """Return the order with which an error falls between two numbers; `ASSUMED_ORDER` where they do not give one."""
    if coarse == fine or not (0.0 < coarse_error < math.inf and 0.0 < fine_error < math.inf):
        return ASSUMED_ORDER
    return math.log(coarse_error / fine_error) / math.log(fine / coarse)


def slice_fraction(order: float = JOINT_ORDER) -> float:
    """Return the fraction of the error of slices which `SLICE_FACTOR` times as many show, by an order."""
    return richardson_factor(1, SLICE_FACTOR, order)


def reference_positions(n_positions: int) -> int:
    """Return the number of roller positions of a reference: only that in the line of load is common to both."""
    return 2 * n_positions + 1


def position_fraction(n_positions: int, order: float) -> float:
    """Return the fraction of the error of some positions by which they differ from `reference_positions`."""
    return richardson_factor(n_positions, reference_positions(n_positions), order)


def joint_references(
    slices: int, n_positions: int, quadrature: str
) -> tuple[tuple[int, int], tuple[int, int]]:
    """Return slices and positions of two references: at Gauss points, and by the quadrature rule of the run.

    The first has pi times as many Gauss points as equal slices: it is twice as fine, and light loads reach only the
    middle of a roller, where Gauss points are pi/2 times as far apart. The second has other slices and positions than
    the first, so that it hardly errs like the run as well.

    Parameters
    ----------
    slices, n_positions : int
        Numbers of the run.
    quadrature : str
        Its quadrature rule, "equal" or "gauss".
    """
    more_positions = reference_positions(n_positions)
    if slices < _MIN_SLICES:
        more_positions = max(more_positions, _MIN_POSITIONS)
    density = JOINT_FACTOR * (1.0 if quadrature == "gauss" else 0.5 * math.pi)
    gauss_points = max(math.ceil(density * slices), _MIN_SLICES)
    return (gauss_points, more_positions), (JOINT_FACTOR * slices + 1, more_positions + 1)


def joint_fraction(order: float = JOINT_ORDER) -> float:
    """Return the fraction of an error by which a run differs from its `joint_references`, by an order."""
    return richardson_factor(1, JOINT_FACTOR, order)


def reference_slips(points: int) -> int:
    """Return the number of slips of a reference, among which are those of a run: every `SLIP_FACTOR`-th."""
    return SLIP_FACTOR * (points - 1) + 1
