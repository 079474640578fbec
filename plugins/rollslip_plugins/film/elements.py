"""Piecewise polynomials over the inlet of a line contact, and the deformation that a pressure of theirs causes.

- Polynomials of degree 4, collocated at Radau points; deformation, load and slope of a polynomial are exact.
- The distance counts from the exit upstream, because a stiff film (f -> 0, H = Hm) takes its pressure from downstream:
  the same points in the direction of the flow give an oscillating pressure.
"""

import math
from typing import Final

import numpy as np
from numpy.polynomial import legendre

from rollslip.search import Array

#: Degree of the polynomials. A higher one resolves smooth pressures with fewer elements, and spikes with more. Chosen.
DEGREE: Final = 4
#: Distance from the middle of an element, in halves of it, from which on its integrals are computed by quadrature. At 4
#: the error of that is below 1e-14.
_FAR_DISTANCE: Final = 4.0


def _radau() -> Array:
    """Return the Radau points on [-1, 1], the right end among them."""
    # the roots are of complex type from NumPy 2.5 on
    points: Array = np.sort(np.real(legendre.legroots([0.0] * (DEGREE - 1) + [-1.0, 1.0])))
    points[-1] = 1.0
    return points


_POINTS: Final = _radau()
_NODES: Final = np.append(-1.0, _POINTS)
#: Matrix from values at the nodes of an element to coefficients of Legendre polynomials.
_COEFFICIENTS: Final = np.linalg.inv(legendre.legvander(_NODES, DEGREE))
#: Matrix from values at the nodes to coefficients of the slope.
_SLOPE: Final = legendre.legder(np.eye(DEGREE + 1)) @ _COEFFICIENTS
#: Nodes of Gauss-Legendre quadrature of the kernel far from its singularity.
_GAUSS: Final = legendre.leggauss(8)[0]
#: Weights of the integrals of Legendre polynomials at these nodes.
_FAR_WEIGHTS: Final = legendre.legvander(_GAUSS, DEGREE) * legendre.leggauss(8)[1][:, None]


def _moments(z: Array) -> Array:
    """Return the integrals of P_l(t) ln|z - t| over [-1, 1], l = 0 to the degree, on a last axis.

    For l > 0 they are 2 (Q_(l+1) - Q_(l-1))/(2 l + 1), with Legendre's functions of the second kind, which lose digits
    to cancellation away from the element; there Gauss's rule has an error below 1e-14.
    """
    moments = np.empty((*z.shape, DEGREE + 1))
    far = np.abs(z) > _FAR_DISTANCE
    moments[far] = np.log(np.abs(z[far][:, None] - _GAUSS)) @ _FAR_WEIGHTS
    z = z[~far]
    P = legendre.legvander(z, DEGREE + 1)
    W = np.zeros_like(P)  # Q_l = P_l ln|(1 + z)/(1 - z)|/2 - W_l
    W[:, 1] = 1.0
    for k in range(1, DEGREE + 1):
        W[:, k + 1] = ((2 * k + 1) * z * W[:, k] - k * W[:, k - 1]) / (k + 1)
    ends = [
        np.log(np.where(d == 0.0, 1.0, np.abs(d)))[:, None] for d in (1 + z, 1 - z)
    ]  # 0 ln 0 = 0
    step = P[:, 2:] - P[:, :-2]
    near = np.empty((len(z), DEGREE + 1))
    near[:, :1] = (1 + z)[:, None] * ends[0] + (1 - z)[:, None] * ends[1] - 2
    near[:, 1:] = (step * (ends[0] - ends[1]) - 2 * (W[:, 2:] - W[:, :-2])) / (
        2 * np.arange(1, DEGREE + 1) + 1
    )
    moments[~far] = near
    return moments


class Elements:
    """Elements over the distance y from the exit upstream; P = 0 at y = 0, unknown at the Radau points of each."""

    def __init__(self, edges: Array) -> None:
        self.edges = edges
        self.half = np.diff(edges) / 2
        self.middle = edges[:-1] + self.half
        n = len(self.half)
        self.y = (self.middle[:, None] + self.half[:, None] * _POINTS).ravel()
        self.y[DEGREE - 1 :: DEGREE] = edges[1:]
        self.of_element = np.arange(n)[:, None] * DEGREE + np.arange(DEGREE + 1)
        slope = np.zeros((n * DEGREE, n * DEGREE + 1))
        rule = legendre.legvander(_POINTS, DEGREE - 1) @ _SLOPE
        for k, half in enumerate(self.half):
            slope[k * DEGREE : (k + 1) * DEGREE, self.of_element[k]] = rule / half
        self.slope = slope[:, 1:]
        load = np.zeros(n * DEGREE + 1)
        np.add.at(load, self.of_element, 2 * self.half[:, None] * _COEFFICIENTS[0])
        self.load = load[1:]
        self._at_exit = self._deformation(np.zeros(1))
        self.deformation = self._deformation(self.y) - self._at_exit

    def _deformation(self, y: Array) -> Array:
        """Return the matrix from pressures at the nodes to deformations at distances y."""
        moments = _moments((y[:, None] - self.middle) / self.half)
        moments[..., 0] += 2 * np.log(self.half)
        blocks = (moments @ _COEFFICIENTS) * self.half[:, None]
        matrix = np.zeros((len(y), len(self.y) + 1))
        matrix[:, :-1] = blocks[..., :-1].reshape(len(y), -1)
        matrix[:, DEGREE::DEGREE] += blocks[..., -1]
        return matrix[:, 1:] * (-4 / math.pi)

    def film(self, unknowns: Array, y: Array) -> Array:
        """Return H at distances from the exit, where it is Hm."""
        deformation = (self._deformation(y) - self._at_exit) @ unknowns[:-2]
        return np.asarray(unknowns[-2] + deformation + y * (y / 2 - unknowns[-1]))

    def coefficients(self, pressure: Array) -> Array:
        """Return the coefficients of Legendre polynomials of each element."""
        return np.asarray(np.append(0.0, pressure)[self.of_element] @ _COEFFICIENTS.T)

    def interpolated(self, pressure: Array, y: Array) -> Array:
        """Return the pressure at distances from the exit."""
        k = np.clip(np.searchsorted(self.edges, y) - 1, 0, len(self.half) - 1)
        polynomials = legendre.legvander((y - self.middle[k]) / self.half[k], DEGREE)
        return np.asarray(np.sum(polynomials * self.coefficients(pressure)[k], axis=1))
