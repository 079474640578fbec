"""Temperatures of film and surfaces along a contact, as linear functions of the heat release in a cell of the grid.

- The cells are even in phi, x = -b cos(phi), where the surfaces' temperature is smooth.
- The film's temperature has an exact solution in a cell, in the modes of conduction, so that no film is too thin.
"""

import abc
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander

from rollslip.search import Array


class Cells(NamedTuple):
    """Cells along the contact, even in phi of x = -b cos(phi); lengths in half widths."""

    edge: Array
    middle: Array
    width: Array
    #: (edges, cells): integral of q(x')/sqrt(x - x') up to an edge from the mean q of the cells
    flash: Array


@lru_cache(maxsize=16)
def even_cells(n: int) -> Cells:
    """Return n cells; q is taken as linear in a cell, with the slope between its mean and that of the cell before."""
    edge = np.pi * np.arange(n + 1) / n
    middle = (edge[1:] + edge[:-1]) / 2

    def difference(a: Array, b: Array) -> Array:
        """Return cos(b) - cos(a) without cancellation."""
        return 2 * np.sin((a + b) / 2) * np.sin((a - b) / 2)

    width = difference(edge[1:], edge[:-1])
    gap = difference(middle[1:], middle[:-1])
    root = np.sqrt(np.maximum(difference(edge[:, None], edge), 0))
    behind = np.tri(n + 1, n, -1, dtype=bool)
    rise = np.where(behind, width / np.where(behind, root[:, :-1] + root[:, 1:], 1), 0)
    flash = 2 * rise
    tilt = rise[:, 1:] ** 3 / (3 * gap)
    flash[:, 1:] += tilt
    flash[:, :-1] -= tilt
    return Cells(-np.cos(edge), -np.cos(middle), width, flash)


class Modes(NamedTuple):
    """Modes of conduction between walls at zero, over half the film: polynomials, even about its middle."""

    place: Array
    weight: Array
    #: (places, modes), orthonormal over the half film
    shape: Array
    mean: Array
    #: decay over x/b times the film's capacity
    rate: Array


@lru_cache(maxsize=16)
def conduction_modes(m: int) -> Modes:
    """Return m modes, and m + 1 places of Gauss's rule."""
    place, weight = (values[m + 1 :] for values in leggauss(2 * (m + 1)))
    legendre = legvander(place, 2 * m)
    # P_2j - P_2j+2 vanish at the wall, and the products of their slopes are orthogonal
    basis = (legendre[:, 0 : 2 * m : 2] - legendre[:, 2 : 2 * m + 1 : 2]) / np.sqrt(
        4 * np.arange(m) + 3
    )
    inverse, vectors = np.linalg.eigh(basis.T @ (weight[:, None] * basis))
    shape = basis @ vectors[:, ::-1] / np.sqrt(inverse[::-1])
    return Modes(place, weight, shape, weight @ shape, 4 / inverse[::-1])


class Heat(abc.ABC):
    """Temperatures of a cell as offset + response @ release, in units of tau0 V h/K_f; release in those of tau0 V/h."""

    #: Weights of the mean over the nodes across the film.
    weight: Array
    #: Whether stored elastic energy counts as heat.
    of_all_work: bool = True

    @abc.abstractmethod
    def affine(self, i: int) -> tuple[Array, Array]:
        """Return offset (s, places) and response (s, places, places) of cell i."""

    def advance(self, i: int, release: Array) -> None:  # noqa: B027 - most have no memory
        """Go on to the next cell with the heat released in cell i at the places."""


class LocalHeat(Heat):
    """Uniform across the film and in proportion to the stress of the cell."""

    def __init__(self, zeta: Array) -> None:
        self.weight = np.ones(1)
        self._affine = np.zeros((zeta.size, 1)), zeta[:, None, None]

    def affine(self, i: int) -> tuple[Array, Array]:
        """Return the same for every cell."""
        return self._affine


class ConductedHeat(Heat):
    """Conduction and convection of the film between two equal surfaces, and the surfaces' flash temperature."""

    of_all_work = False

    def __init__(self, capacity: Array, flash: Array, grid: Cells, modes: Modes) -> None:
        self.weight = modes.weight
        s = capacity.size
        n = grid.width.size
        self._capacity = capacity[:, None]
        self._flash = flash
        self._grid = grid
        self._modes = modes
        self._amplitude = np.zeros((s, modes.rate.size))
        self.surface = np.zeros((s, n + 1))  # at the edges
        self.flux = np.zeros((s, n))  # from the film into one surface, in units of 2 tau0 V
        self._project = (modes.shape * modes.weight[:, None]).T

    def affine(self, i: int) -> tuple[Array, Array]:
        """Solve the cell for a release that is constant along it; mean values over the cell."""
        m = self._modes
        grid = self._grid
        storage = self._capacity / grid.width[i]
        decay = m.rate / storage
        gone = -np.expm1(-decay)
        mean_decay = gone / decay
        self._gone = gone
        self._storage = storage
        # response of a mode at the end of the cell, and its mean over the cell
        self._end = gone / m.rate
        mean = (1 - mean_decay) / m.rate
        # the heat that does not remain in the film flows into the surfaces, which determines their temperature
        stored = m.mean * self._end * storage
        into = self._flash * grid.flash[i + 1, i] / 4
        fraction = 1 + into * storage[:, 0] * (1 - stored @ m.mean)
        known = self._flash * (self.flux[:, :i] @ grid.flash[i + 1, :i]) - self.surface[:, i]
        given_back = (gone * self._amplitude) @ m.mean * storage[:, 0]
        self._rise = (known + into * given_back) / fraction
        self._rise_of_release = (into / fraction)[:, None] * (m.weight - stored @ self._project)
        offset = (self.surface[:, i] + self._rise / 2)[:, None] + (
            mean_decay * self._amplitude - mean * storage * self._rise[:, None] * m.mean
        ) @ m.shape.T
        response = (m.shape * mean[:, None, :]) @ self._project
        response += (0.5 - (mean * storage * m.mean) @ m.shape.T)[
            :, :, None
        ] * self._rise_of_release[:, None, :]
        return offset, response

    def advance(self, i: int, release: Array) -> None:
        """Let the heat of the cell flow into film and surfaces."""
        m = self._modes
        rise = self._rise + np.sum(self._rise_of_release * release, axis=1)
        source = release @ self._project.T - self._storage * rise[:, None] * m.mean
        change = self._end * source - self._gone * self._amplitude
        self.flux[:, i] = (release @ m.weight - self._storage[:, 0] * (rise + change @ m.mean)) / 4
        self.surface[:, i + 1] = self.surface[:, i] + rise
        self._amplitude = self._amplitude + change
