"""Temperature of a surface under a moving source of heat, with a flux that is elliptic as Hertz's pressure is.

- In the frame of the contact the surface moves with speed v, and the field stands still. A half-space of conductivity K
  and diffusivity kappa is warmed by the flux q(s) = q_0 sqrt(1 - s^2), s = x/b in [-1, 1], by (Jaeger 1942)::

      T(x) = (q_0 b/K) theta(x/b),   theta(X) = (1/pi) int_-1^1 sqrt(1 - s^2) exp(Pe (X - s)) K_0(Pe |X - s|) ds

  with Pe = v b/(2 kappa). It is counted from far below the surface; a band that stands still has no such field, and
  theta grows without bound as Pe falls to 0.
- Fast surfaces (Pe >> 1) are warmed as by a heat flux into depth alone, and theta sqrt(Pe) is a function of X: Blok's.
"""

import math
from functools import cache
from typing import Any, Final

import numpy as np
from numpy.polynomial import Chebyshev

from rollslip.search import Array, polynomial_maximum

__all__ = ["FAST", "largest_rise", "rise"]

#: Largest theta sqrt(Pe) of a fast surface, by mpmath (tools/references/flash_temperature.py).
FAST: Final = 0.8730080546599797
#: Number of nodes of the double exponential (tanh-sinh) quadrature on each side of a position. Its relative error is
#: below 1e-9; halving the number loses about half of the digits.
_NODES = 60
#: Range of the variable of this quadrature: the weights at its ends are below rounding.
_RANGE = 3.3
#: Distance that replaces 0 for a side without length, whose integral is 0.
_TINY: Final = 1e-300
#: Number of positions of the first search for the largest rise. Chosen: the rise has one smooth maximum.
_COARSE_POSITIONS = 65
#: Number of positions around the best of them, through which a polynomial is laid. Chosen.
_FINE_POSITIONS = 33
#: Smallest Peclet number of the interpolation of the largest rise; below it the limit is within 1e-6.
_SLOWEST = 1e-5
#: Largest Peclet number of this interpolation; above it the limit is within 1e-6.
_FASTEST = 1e6
#: Degree of the Chebyshev interpolation in the logarithm of the Peclet number: its error is below 1e-6.
_DEGREE: Final = 80


def _rule() -> tuple[Array, Array, Array]:
    """Return nodes x on (0, 1), 1 - x, and weights of tanh-sinh quadrature, which singular ends do not affect."""
    t = np.linspace(-_RANGE, _RANGE, 2 * _NODES + 1)
    inner = 0.5 * np.pi * np.sinh(t)
    low = 1.0 / (1.0 + np.exp(-2.0 * inner))
    high = 1.0 / (1.0 + np.exp(2.0 * inner))
    return low, high, 0.5 * np.pi * np.cosh(t) * (t[1] - t[0]) * 2.0 * low * high


def rise(peclet: Any, places: Any) -> Array:
    """Return theta, with a relative error below 1e-9 for Peclet numbers from 1e-5 to 1e3.

    Parameters
    ----------
    peclet : array_like
        Peclet numbers above 0 [1].
    places : array_like
        Positions X = x/b from -1 to 1; broadcast with the Peclet numbers.
    """
    from scipy.special import k0e

    peclet, X = np.broadcast_arrays(
        np.asarray(peclet, dtype=float), np.asarray(places, dtype=float)
    )
    Pe = peclet[..., None]
    near, far, weight = _rule()  # distances from the position and from the end of the contact
    integral = np.zeros(X.shape)
    for upstream, length in ((True, 1.0 + X), (False, 1.0 - X)):
        distance = np.maximum(near * length[..., None], _TINY)  # |X - s|
        flux = np.sqrt(far * length[..., None] * (2.0 - far * length[..., None]))
        kernel = k0e(Pe * distance) * (1.0 if upstream else np.exp(-2.0 * Pe * distance))
        integral += (flux * kernel) @ weight * length
    return integral / np.pi


def _largest(peclet: Array) -> Array:
    """Return the largest theta over the contact, by search."""
    coarse = np.linspace(-1.0, 1.0, _COARSE_POSITIONS)
    best = coarse[np.argmax(rise(peclet[:, None], coarse), axis=1)]
    step = coarse[1] - coarse[0]
    fine = np.linspace(
        np.maximum(best - step, -1.0), np.minimum(best + step, 1.0), _FINE_POSITIONS, axis=1
    )
    return np.array(
        [
            polynomial_maximum(x, y)[1]
            for x, y in zip(fine, rise(peclet[:, None], fine), strict=True)
        ]
    )


@cache
def _logarithm() -> Chebyshev:
    """Return the logarithm of the largest theta as a function of that of the Peclet number, between the limits."""
    interpolant: Chebyshev = Chebyshev.interpolate(
        lambda x: np.log(_largest(np.exp(x))),
        _DEGREE,
        domain=[math.log(_SLOWEST), math.log(_FASTEST)],
    )
    return interpolant


def largest_rise(peclet: Array) -> Array:
    """Return the largest theta over the contact at Peclet numbers, (n,), not negative; infinite where one is 0.

    Interpolated between Pe of 1e-5 and 1e6, where its relative error is below 1e-6; beyond them the limits, which are
    as near: FAST/sqrt(Pe), and (ln(2/Pe) - 0.5772 + 1/2 + ln 2)/2.
    """
    peclet = np.asarray(peclet, dtype=float)
    with np.errstate(divide="ignore"):
        at = np.log(peclet)
        slow = 0.5 * (np.log(2.0) - at - np.euler_gamma + 0.5 + np.log(2.0))
        fast = FAST / np.sqrt(peclet)
    between = np.exp(_logarithm()(np.clip(at, math.log(_SLOWEST), math.log(_FASTEST))))
    return np.asarray(np.where(peclet < _SLOWEST, slow, np.where(peclet > _FASTEST, fast, between)))
