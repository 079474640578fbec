"""Stress of a Maxwell-Eyring oil over a cell of a grid, in closed form: D dS/dX + kappa sinh S = sigma.

In a cell viscosity is frozen, so that no stress relaxes too fast for the grid (D of a bearing is 1e-4 to 1e-2); only
its slow drift with pressure and temperature is taken out first, without which the relaxation would leave an error of
first order.
"""

import numpy as np
from numpy.polynomial.legendre import leggauss

from rollslip.search import Array
from rollslip_plugins.traction.stress import dilogarithm

#: Nodes on (0, 1) of Gauss-Legendre quadrature of the mean stress where relaxation is slow.
RAMP_NODES = leggauss(4)[0] / 2 + 0.5
#: Weights of these nodes.
RAMP_WEIGHTS = leggauss(4)[1] / 2
#: Ratio of the length of a cell to that of relaxation below which this quadrature replaces the closed form, which
#: cancels there; its error is below 1e-13.
_MAX_RAMP = 0.25


def relaxed(start: Array, kappa: Array, sigma: Array, deborah: Array) -> tuple[Array, Array]:
    """Return mean and end of S over a cell of unit length: D S' + kappa sinh S = sigma, all positive.

    tanh(S/2) and exp(-S) both follow from their first values by one Moebius map without a difference; the former has
    the digits of small stresses, the latter those of large ones.
    """
    r = np.hypot(kappa, sigma)
    # tanh(S/2) and exp(-S) at rest
    steady = sigma / (kappa + r)
    fading = kappa / (sigma + r)
    z = np.tanh(start / 2)
    y = np.exp(-start)
    p = np.minimum(r / deborah, 1e30)  # where relaxation is faster its ramp is lost in rounding

    def after(p: Array, steady: Array, fading: Array, z: Array, y: Array) -> Array:
        q = np.exp(-p)
        gone = -np.expm1(-p)
        return _stress(_moebius(steady, z, q, gone), _moebius(fading, y, q, gone))

    # mean = steady stress + [Li2(-x m q) - Li2(-x m) + Li2(x) - Li2(x q)]/p, m = fading^2, x the distance from rest
    small = (z < 0.5) & (steady < 0.5)
    distance = np.where(small, (z - steady) / (1 - z * steady), (fading - y) / (fading + y))
    x = distance * (fading + y) / (fading * (1 + fading * y))
    q = np.exp(-p)
    inner = -x * fading**2
    plus, minus, other_minus, other_plus = _dilogarithm_of_any(
        np.stack([inner * q, inner, x * q, x])
    )
    mean = _stress(steady, fading) + (plus - minus + other_plus - other_minus) / p
    ramp = p < _MAX_RAMP  # there the bracket cancels, while S is smooth
    if np.any(ramp):
        part = (values[ramp, None] for values in (steady, fading, z, y))
        mean[ramp] = after(p[ramp, None] * RAMP_NODES, *part) @ RAMP_WEIGHTS
    return mean, after(p, steady, fading, z, y)


def _moebius(rest: Array, start: Array, q: Array, gone: Array) -> Array:
    """Return the value after relaxation towards ``rest``, by the Moebius map of a step with q = exp(-p)."""
    return (rest * gone + start * (rest**2 + q)) / (1 + rest**2 * q + rest * start * gone)


def _stress(z: Array, y: Array) -> Array:
    """S of tanh(S/2) and exp(-S)."""
    return np.where(z < 0.5, 2 * np.arctanh(np.minimum(z, 0.5)), -np.log(y))


def _dilogarithm_of_any(x: Array) -> Array:
    """Return Li2(x), x < 1, by inversion and reflection."""
    far = x < -1
    near = x > 0.5
    inner = dilogarithm(np.where(far, 1 / np.where(far, x, -1), np.where(near, 1 - x, x)))
    inverted = -(np.pi**2) / 6 - np.log(np.where(far, -x, 1)) ** 2 / 2 - inner
    reflected = (
        np.pi**2 / 6 - np.log(np.where(near, x, 1)) * np.log1p(-np.where(near, x, 0)) - inner
    )
    return np.asarray(np.where(far, inverted, np.where(near, reflected, inner)))


def carried(
    start: Array, kappa: Array, sigma: Array, deborah: Array, change: Array
) -> tuple[Array, Array]:
    """Return mean and end of S over a cell across which ln(kappa) changes, kappa that of its middle.

    With the drift g of the steady stress, R = S - g x follows the equation of S with sigma - D g for sigma, up to terms
    that are odd about the middle. The drift is bounded where that would leave nothing of the drive or of the stress.
    """
    half = -np.tanh(change) * sigma / np.hypot(kappa, sigma) / 2
    half = np.maximum(np.minimum(half, sigma / deborah / 4), -start / 2)
    mean, end = relaxed(start + half, kappa, sigma - 2 * half * deborah, deborah)
    return mean, end + half
