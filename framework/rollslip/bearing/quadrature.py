"""Few loads in place of many: a rule that gives means by force over slices of which the loads differ."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from rollslip_kernels.gauss import rules

__all__ = ["gauss_rule", "load_rule"]

Array = NDArray[np.float64]

# loads of a rule
_FEWEST = 8
_MOST = 128
_ROUNDING = 1e-13  # of a share of the force


def gauss_rule(load: Array, force: Array, count: int) -> Array:
    """Return the Gauss rule of a force distributed over loads.

    With weights q_k at x_k = sqrt(w_k), Lanczos' recurrence gives the Jacobi matrix of the polynomials that are
    orthogonal over them; its eigenvalues are the nodes x, and the squares of the first components of its eigenvectors
    their shares of the weight (`rollslip_kernels.gauss.rules`). The rule is load per length [N/m] and share of the
    force of each node that has one, (m, 2).

    References
    ----------
    G. H. Golub, J. H. Welsch, Calculation of Gauss quadrature rules, Math. Comp. 23 (1969) 221-230.
    """
    nodes, weights = rules(load, force, np.array([0, load.size]), count)
    fraction = weights[0] / force.sum()
    held = (
        fraction > _ROUNDING
    )  # of loads that differ by rounding alone there are fewer: no law takes a load of nothing
    return np.asarray(np.stack((nodes[0], fraction), axis=1)[held])


def load_rule(load: Array, force: Array, mean: Callable[[Array], Array], tolerance: float) -> Array:
    """Return as few loads as leave a mean by force right, with their shares of the force, (m, 2).

    ``mean`` gives the means of a rule at all that is looked at; errors are relative to the largest of them. If no few
    loads are right it is the rule of all slices.
    """
    whole = np.stack((load, force / force.sum()), axis=1)
    different = np.unique(load).size
    if different > _FEWEST:
        true = mean(whole)
        scale = float(np.abs(true).max())
    count = _FEWEST
    while count < min(different, _MOST + 1):
        rule = gauss_rule(load, force, count)
        if np.abs(mean(rule) - true).max() <= tolerance * scale:
            return rule
        count *= 2
    return whole
