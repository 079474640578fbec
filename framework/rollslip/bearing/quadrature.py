"""Replace the loads of many slices by those of a Gauss rule, which gives the same means of friction by force.

1. Friction at one rolling and one sliding speed is a function of the load per length alone, so that its mean by force
   is an integral over a discrete measure: the force at each load.
2. The Gauss rule of m nodes of that measure is found by Lanczos' recurrence and the eigenvalues of its Jacobi matrix
   (`gauss_rule`, Golub and Welsch).
3. The number of nodes is doubled from 8 until the means at some probe speeds agree with those over all slices within a
   tolerance; where 128 do not suffice, all slices are taken (`load_rule`).
"""

from collections.abc import Callable

import numpy as np

from rollslip.search import Array
from rollslip_kernels.gauss import rules

__all__ = ["gauss_rule", "load_rule"]


#: Nodes of the first rule that is tried. Halving it costs one more comparison, doubling it nodes that a smooth law does
#: not need. Chosen: smooth laws of friction need 16.
_MIN_LOADS = 8
#: Largest number of nodes that is tried before all slices are taken. Doubling it helps only laws with kinks, with 256
#: nodes of some thousand slices. Chosen.
_MAX_LOADS = 128
#: Fraction of the force below which a node is dropped: loads that differ by rounding alone give nodes without weight.
#: Doubling it changes nothing; it stands between the rounding of an eigenvector (1e-16) and the tolerance of tables.
_MIN_FRACTION = 1e-13


def gauss_rule(load: Array, force: Array, count: int) -> Array:
    """Return the Gauss rule of a force distributed over loads.

    With weights q_k at x_k = sqrt(w_k), Lanczos' recurrence gives the Jacobi matrix of the polynomials that are
    orthogonal over them; its eigenvalues are the nodes x, and the squares of the first components of its eigenvectors
    are their fractions of the weight (`rollslip_kernels.gauss.rules`).

    Parameters
    ----------
    load : ndarray
        Load per length of each slice [N/m], (n,).
    force : ndarray
        Force of each slice [N], (n,): the weights.
    count : int
        Number of nodes m.

    Returns
    -------
    ndarray
        Load per length [N/m] and fraction of the force [1] of each node that has one, (at most m, 2).

    References
    ----------
    G. H. Golub, J. H. Welsch, Calculation of Gauss quadrature rules, Math. Comp. 23 (1969) 221-230.
    """
    nodes, weights = rules(load, force, np.array([0, load.size]), count)
    fraction = weights[0] / force.sum()
    significant = fraction > _MIN_FRACTION
    return np.asarray(np.stack((nodes[0], fraction), axis=1)[significant])


def load_rule(load: Array, force: Array, mean: Callable[[Array], Array], tolerance: float) -> Array:
    """Return the smallest Gauss rule tried whose means by force agree with those over all slices.

    Parameters
    ----------
    load : ndarray
        Load per length of each slice [N/m], (n,).
    force : ndarray
        Force of each slice [N], (n,).
    mean : callable
        Returns the means of friction of a rule, (m, 2), at all probe speeds, (k,).
    tolerance : float
        Allowed difference, relative to the largest mean over all slices [1].

    Returns
    -------
    ndarray
        Load per length [N/m] and fraction of the force [1] of each node, (m, 2); of all slices if no rule agrees.
    """
    whole = np.stack((load, force / force.sum()), axis=1)
    different = np.unique(load).size
    if different > _MIN_LOADS:
        reference = mean(whole)
        scale = float(np.abs(reference).max())
    count = _MIN_LOADS
    while count < min(different, _MAX_LOADS + 1):
        rule = gauss_rule(load, force, count)
        if np.abs(mean(rule) - reference).max() <= tolerance * scale:
            return rule
        count *= 2
    return whole
