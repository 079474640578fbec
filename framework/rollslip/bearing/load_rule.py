"""Few loads that stand for the thousands of loaded slices of a raceway: Gauss quadrature of force over load.

- At one rolling and one sliding speed the friction of a slice depends on its load alone, so the mean by force over all
  slices is an integral over a discrete measure, the force at each load. Its Gauss rule of m loads is exact for every
  polynomial of degree 2 m - 1 and converges like one to a smooth friction law: 16 loads serve for some thousand slices.
- The rule is taken in the root of the load: half width and pressure go with it.
- Nothing is believed: the rule is held against all slices at some speeds, and its loads are doubled until it agrees.
  A law with a kink, such as film model ``regime``, needs many, or all the slices.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_FIRST, _MOST = 8, 128


def gauss_rule(load: Array, force: Array, count: int) -> Array:
    """Return the Gauss rule of a force distributed over loads.

    With weights q_k = F_k / sum(F) at x_k = sqrt(w_k), Lanczos' recurrence gives the Jacobi matrix of the polynomials
    that are orthogonal over them; its eigenvalues are the nodes x, and the squares of the first components of its
    eigenvectors their weights.

    Parameters
    ----------
    load : ndarray
        Loads per length w [N/m], at least ``count`` different ones, (N,).
    force : ndarray
        Force at each [N], positive, (N,).
    count : int
        Nodes m of the rule.

    Returns
    -------
    ndarray
        Load per length [N/m] and share of the force of each node, (m, 2).

    References
    ----------
    G. H. Golub, J. H. Welsch, Calculation of Gauss quadrature rules, Math. Comp. 23 (1969) 221-230.
    """
    x, basis = np.sqrt(load), np.empty((count, load.size))
    diagonal, beside = np.empty(count), np.empty(count)
    vector = np.sqrt(force / force.sum())
    for k in range(count):
        basis[k] = vector
        vector = x * vector
        diagonal[k] = vector @ basis[k]
        for _ in range(2):  # once more, for what the rounding of the first leaves
            vector = vector - (basis[: k + 1] @ vector) @ basis[: k + 1]
        beside[k] = np.sqrt(vector @ vector)
        vector = vector / beside[k]
    nodes, vectors = np.linalg.eigh(np.diag(diagonal) + np.diag(beside[:-1], 1) + np.diag(beside[:-1], -1))
    return np.stack((nodes**2, vectors[0] ** 2), axis=1)


def load_rule(load: Array, force: Array, mean: Callable[[Array], Array], tolerance: float) -> Array:
    """Return as few loads as leave a mean by force right, with their shares of the force.

    Parameters
    ----------
    load, force : ndarray
        Loads per length [N/m] and forces [N] of all slices, positive, (N,).
    mean : callable
        Means of loads and shares, (m, 2), at all that is looked at.
    tolerance : float
        Largest error, relative to the largest mean.

    Returns
    -------
    ndarray
        Loads per length [N/m] and shares of the force, (m, 2); those of all slices if no few of them are right.
    """
    whole = np.stack((load, force / force.sum()), axis=1)
    different = np.unique(load).size
    if different > _FIRST:
        true = mean(whole)
        scale = float(np.abs(true).max())
    count = _FIRST
    while count < min(different, _MOST + 1):
        rule = gauss_rule(load, force, count)
        if np.abs(mean(rule) - true).max() <= tolerance * scale:
            return rule
        count *= 2
    return whole
