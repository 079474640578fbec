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

from rollslip.search import Array, vertex

__all__ = ["FAST", "largest_rise", "rise"]

#: Largest theta sqrt(Pe) of a fast surface, by mpmath (tools/references/flash_temperature.py).
FAST: Final = 0.8730080546599797
#: Nodes of the double exponential rule on each side of a place, and how far the rule goes towards its ends.
_NODES = 60
_REACH = 3.3
#: Least distance, for a side without length, which adds nothing.
_TINY: Final = 1e-300
#: Places of the first search for the largest rise, then around the best of them.
_PLACES = 65
_AROUND = 33
#: Peclet numbers between which the largest rise is interpolated in their logarithms, and the degree of that.
_SLOWEST = 1e-5
_FASTEST = 1e6
_DEGREE: Final = 80


def _rule() -> tuple[Array, Array, Array]:
    """Nodes on (0, 1), what is left of them to 1, and weights: tanh-sinh, which ends with singularities do not harm."""
    t = np.linspace(-_REACH, _REACH, 2 * _NODES + 1)
    inner = 0.5 * np.pi * np.sinh(t)
    low = 1.0 / (1.0 + np.exp(-2.0 * inner))
    high = 1.0 / (1.0 + np.exp(2.0 * inner))
    return low, high, 0.5 * np.pi * np.cosh(t) * (t[1] - t[0]) * 2.0 * low * high


def rise(peclet: Any, places: Any) -> Array:
    """Return theta at Peclet numbers above 0 and places X = x/b from -1 to 1, which broadcast.

    Its relative error is below 1e-9 for Pe from 1e-5 to 1e3.
    """
    from scipy.special import k0e  # takes longer to import than a module of models may

    peclet, X = np.broadcast_arrays(
        np.asarray(peclet, dtype=float), np.asarray(places, dtype=float)
    )
    Pe = peclet[..., None]
    near, far, weight = (
        _rule()
    )  # from a place and from the end of the contact, in lengths of the side
    found = np.zeros(X.shape)
    for behind, length in ((True, 1.0 + X), (False, 1.0 - X)):
        away = np.maximum(near * length[..., None], _TINY)  # |X - s|
        flux = np.sqrt(far * length[..., None] * (2.0 - far * length[..., None]))
        kernel = k0e(Pe * away) * (1.0 if behind else np.exp(-2.0 * Pe * away))
        found += (flux * kernel) @ weight * length
    return found / np.pi


def _largest(peclet: Array) -> Array:
    """Largest theta over the contact, by search."""
    places = np.linspace(-1.0, 1.0, _PLACES)
    at = places[np.argmax(rise(peclet[:, None], places), axis=1)]
    step = places[1] - places[0]
    around = np.linspace(np.maximum(at - step, -1.0), np.minimum(at + step, 1.0), _AROUND, axis=1)
    return np.array(
        [vertex(x, y)[1] for x, y in zip(around, rise(peclet[:, None], around), strict=True)]
    )


@cache
def _logarithm() -> Chebyshev:
    """Logarithm of the largest theta over that of the Peclet number, between the limits."""
    ends = [math.log(_SLOWEST), math.log(_FASTEST)]
    found: Chebyshev = Chebyshev.interpolate(
        lambda x: np.log(_largest(np.exp(x))), _DEGREE, domain=ends
    )
    return found


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
