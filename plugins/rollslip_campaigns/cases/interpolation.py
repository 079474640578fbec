"""Interpolate load cases between computed ones, with an error that cases drawn at random show.

1. Take the logarithm of positive columns, scale all columns by their ranges, and leave out directions in which the
   cases do not differ.
2. Compute cases that are far apart (farthest-point sampling). Predict as many further ones before they are computed,
   too, and repeat with twice as many until nearly all differ by less than half of the tolerance.
3. Results are of the same *kind* if the same values exist and have the same sign. A case whose nearest computed ones
   are of several kinds is computed, because nothing is smooth there: a cage begins to skid, or a law has no data.
4. Interpolate all other cases by thin-plate splines of the logarithms of the values through the computed cases of their
   kind.
5. Compute some of these cases, drawn at random. The largest difference is the error that is stated. If it exceeds the
   tolerance, go on at step 2 with twice as many.

References
----------
T. F. Gonzalez, "Clustering to minimize the maximum intercluster distance", Theoretical Computer Science 38 (1985).
J. Duchon, "Splines minimizing rotation-invariant semi-norms in Sobolev spaces" (1977): thin-plate splines.
"""

from collections.abc import Callable, Sequence
from typing import Final, TypeAlias

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.search import Array, Rows
from rollslip_campaigns.sweep.sampling import farthest_points

__all__ = ["Interpolated", "interpolate_cases"]

Flags: TypeAlias = NDArray[np.bool_]

#: Number of cases from which the first further ones are predicted. Half as many hardly span three columns; twice as
#: many are computed where these would do. Chosen.
_FIRST_NODES: Final = 32
#: Largest number of computed cases that are far apart; with more of them, computing all takes hardly longer than the
#: splines. Where the tolerance is not reached with so many, the error is stated all the same. Chosen.
_MAX_NODES: Final = 2048
#: Number of cases drawn at random that are computed to check the error. With 32, the error of nine of ten cases is
#: below the largest one with a probability of 0.97 (1 - 0.9^32); twice as many take twice the time.
_CHECKS: Final = 32
#: Quantile of the differences at predicted cases that decides whether more are needed. The farthest cases are at the
#: corners, where a few differ more than any between them. Chosen.
_QUANTILE: Final = 0.9
#: Number of computed cases nearest to one whose kinds decide whether it is interpolated, per direction. Half as many
#: may lie on one side of it. Chosen.
_NEIGHBOURS: Final = 3
#: Number of computed cases through which each spline goes. More change nothing that the check would see; chosen.
_SPLINE_NODES: Final = 60
#: Directions in which cases differ by less than this, relative to the one in which they differ most, do not count.
_SAME: Final = 1e-6


@attrs.frozen(eq=False)
class Interpolated:
    """Values of all cases, most of them interpolated.

    Attributes
    ----------
    values : ndarray, shape (n, q)
        The values.
    is_computed : ndarray of bool, shape (n,)
        Which cases were computed.
    nearest : ndarray of int, shape (n,)
        Number of the computed case that is nearest to each.
    error : float
        Largest relative difference at the checked cases; 0 without one.
    checked : int
        Number of these.
    """

    values: Array
    is_computed: Flags
    nearest: Rows
    error: float
    checked: int


def interpolate_cases(
    columns: Array,
    compute: Callable[[Sequence[int]], Array],
    tolerance: float,
    floors: Array,
) -> Interpolated:
    """Return values of all cases from those of some.

    Parameters
    ----------
    columns : ndarray, shape (n, d)
        What the cases vary.
    compute : callable
        Computes cases of given numbers, and returns the values of all cases computed so far, NaN elsewhere, (n, q).
    tolerance : float
        Largest relative error of an interpolated value.
    floors : ndarray, shape (q,)
        Sizes of the values below which differences do not count.
    """
    places = _places(columns)
    order = np.array(farthest_points(places, _MAX_NODES))
    drawn = np.random.default_rng(1)
    is_computed = np.zeros(len(places), dtype=bool)
    table = np.empty((len(places), floors.size))

    def add(numbers: Rows) -> None:
        nonlocal table
        is_computed[numbers] = True
        table = compute(np.flatnonzero(is_computed).tolist())

    count = min(_FIRST_NODES, order.size)
    add(order[:count])
    while True:
        further = order[count : 2 * count]
        further = further[~is_computed[further]]
        predicted, is_smooth = _predict(places, table, np.flatnonzero(is_computed), further)
        add(further)
        differences = _differences(predicted, table[further], floors)[is_smooth]
        count = min(2 * count, order.size)
        is_enough = differences.size and np.quantile(differences, _QUANTILE) <= 0.5 * tolerance
        if not is_enough and count < order.size:
            continue
        rest = np.flatnonzero(~is_computed)
        _, is_smooth = _predict(places, table, np.flatnonzero(is_computed), rest)
        add(rest[~is_smooth])
        rest = rest[is_smooth]
        nodes = np.flatnonzero(is_computed)
        predicted, _ = _predict(places, table, nodes, rest)
        checked = np.sort(drawn.choice(rest.size, min(_CHECKS, rest.size), replace=False))
        add(rest[checked])
        errors = _differences(predicted[checked], table[rest[checked]], floors)
        error = float(errors.max(initial=0.0))
        if error <= tolerance or count == order.size:
            break
    values = table.copy()
    is_open = ~is_computed[rest]
    values[rest[is_open]] = predicted[is_open]
    return Interpolated(
        values,
        is_computed,
        _nearest(places, is_computed),
        error,
        checked.size,
    )


def _places(columns: Array) -> Array:
    """Return the cases as points in as many directions as they differ in, (n, k)."""
    scaled = np.where(
        (columns > 0.0).all(axis=0), np.log(np.abs(columns) + (columns <= 0.0)), columns
    )
    width = np.ptp(scaled, axis=0)
    centred = (scaled - scaled.mean(axis=0)) / np.where(width > 0.0, width, 1.0)
    _, sizes, directions = np.linalg.svd(centred, full_matrices=False)
    is_direction = sizes > _SAME * max(float(sizes.max(initial=0.0)), np.finfo(float).tiny)
    return np.asarray(centred @ directions[is_direction].T)


def _predict(places: Array, table: Array, nodes: Rows, numbers: Rows) -> tuple[Array, Flags]:
    """Return predicted values of cases, and whether those near them are all of one kind."""
    from scipy.interpolate import RBFInterpolator
    from scipy.spatial import KDTree

    directions = places.shape[1]
    predicted = np.full((numbers.size, table.shape[1]), np.nan)
    is_smooth = np.zeros(numbers.size, dtype=bool)
    nodes = nodes[np.unique(places[nodes], axis=0, return_index=True)[1]]
    if not numbers.size or nodes.size <= directions + 1:
        return predicted, is_smooth
    signs = np.where(np.isfinite(table[nodes]), np.sign(table[nodes]), 2.0)
    kinds = np.unique(signs, axis=0, return_inverse=True)[1].ravel()
    count = min(_NEIGHBOURS * directions, nodes.size)
    _, nearest = KDTree(places[nodes]).query(places[numbers], k=[*range(1, count + 1)])
    for kind in np.unique(kinds):
        own = nodes[kinds == kind]
        is_near = (kinds[nearest] == kind).all(axis=1)
        if not is_near.any() or own.size <= directions + 1:
            continue
        values = table[own]
        of_kind = values[0].copy()
        is_number = np.isfinite(of_kind) & (of_kind != 0.0)
        spline = RBFInterpolator(
            places[own],
            np.log(np.abs(values[:, is_number])),
            neighbors=min(_SPLINE_NODES, own.size),
        )
        found = np.tile(of_kind, (int(is_near.sum()), 1))
        logs = spline(places[numbers[is_near]])
        found[:, is_number] = np.sign(of_kind[is_number]) * np.exp(logs)
        predicted[is_near] = found
        is_smooth |= is_near
    return predicted, is_smooth


def _differences(predicted: Array, computed: Array, floors: Array) -> Array:
    """Return the largest relative difference of the values of each case; infinite where one has no value, (m,)."""
    with np.errstate(invalid="ignore", divide="ignore"):
        size = np.maximum(np.abs(computed), floors)
        relative = np.abs(predicted - computed) / size
    same = (predicted == computed) | (np.isnan(predicted) & np.isnan(computed))
    relative = np.where(same, 0.0, np.where(np.isfinite(relative), relative, np.inf))
    return np.asarray(relative.max(axis=1, initial=0.0))


def _nearest(places: Array, is_computed: Flags) -> Rows:
    """Return the number of the computed case that is nearest to each case, (n,)."""
    from scipy.spatial import KDTree

    nodes = np.flatnonzero(is_computed)
    nearest = nodes[KDTree(places[nodes]).query(places)[1]]
    return np.asarray(nearest.reshape(len(places)))
