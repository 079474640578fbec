"""The grid of an explorer: results at nodes of several quantities, and what lies between them.

- Nodes of a quantity are those of Chebyshev and Lobatto, between which a polynomial through them is close to the best
  there is (Trefethen 2013, Approximation Theory and Approximation Practice, chapter 8). Quantities that span a factor
  are taken by their logarithms.
- Between the nodes the polynomial of all quantities at once is evaluated by its barycentric weights (Berrut & Trefethen
  2004, doi:10.1137/S0036144502417715).
- A result that some node does not have, such as a slip of running away beyond the range, has no such polynomial. It is
  taken from the largest block of nodes around that all have it; where the nodes next to a place do not, there is none.
- The page does the same in the browser; what it shows is held against this module by a test.
"""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.search import Array
from rollslip.units import format_quantity

if TYPE_CHECKING:
    from rollslip.scene.values import Scene

__all__ = ["Dial", "Explorer", "between"]


@attrs.frozen(eq=False)
class Dial:
    """A quantity that a slider moves.

    Attributes
    ----------
    key, name, unit : str
        Its key in a scene, its meaning in words, and its SI unit.
    shown : str
        The unit in which people read it.
    low, high, start : float
        Ends of the slider, and where it stands at first, in SI units.
    count : int
        Nodes, two or more.
    logarithmic : bool
        Whether it is taken by its logarithm.
    """

    key: str
    name: str
    unit: str
    shown: str
    low: float
    high: float
    start: float
    count: int
    logarithmic: bool

    @property
    def nodes(self) -> Array:
        """Its nodes, from `low` to `high`, which are among them."""
        inner = -np.cos(np.pi * np.arange(self.count) / (self.count - 1))
        low, high = self.scaled(np.array([self.low, self.high]))
        values = 0.5 * (low + high) + 0.5 * (high - low) * inner
        nodes = np.exp(values) if self.logarithmic else values
        nodes[[0, -1]] = self.low, self.high
        return np.asarray(nodes)

    @property
    def told(self) -> str:
        """What it is, in words."""
        low, high, start = (
            format_quantity(value, self.unit, 4) for value in (self.low, self.high, self.start)
        )
        return f"{self.key}: {low} to {high}, {self.count} nodes; {start} in the scene"

    def scaled(self, value: Array) -> Array:
        """Return values as they are interpolated over."""
        return np.log(value) if self.logarithmic else np.asarray(value)


@attrs.frozen(eq=False)
class Explorer:
    """What an explorer is made of.

    Attributes
    ----------
    scene : Scene
        The scene without tables of campaigns.
    dials : tuple of Dial
        What sliders move.
    choices : mapping of str to tuple of str
        Models that can be chosen, by key.
    checks : int
        Random places at which it is checked against runs.
    """

    scene: "Scene"
    dials: tuple[Dial, ...]
    choices: Mapping[str, tuple[str, ...]]
    checks: int

    @property
    def told(self) -> list[str]:
        """What moves, and how many points that takes, in words."""
        lines = [
            *(dial.told for dial in self.dials),
            *(f"{key}: {', '.join(of)}" for key, of in self.choices.items()),
        ]
        several = f"{self.size} points, {self.checks} random ones for each combination of models among them"
        return [f"  {line}" for line in (*lines, several)]

    @property
    def size(self) -> int:
        """Points that are computed."""
        combinations = int(np.prod([len(names) for names in self.choices.values()], dtype=int))
        return combinations * (
            int(np.prod([dial.count for dial in self.dials], dtype=int)) + self.checks
        )


def between(dials: Sequence[Dial], table: Array, place: Sequence[float]) -> Array:
    """Return results at a place.

    Parameters
    ----------
    dials : sequence of Dial
        What is varied.
    table : ndarray
        Results at the nodes, shape (nodes of each dial in turn, results); NaN where there is none.
    place : sequence of float
        Values of the dials in SI units, within their ends.

    Returns
    -------
    ndarray
        Results, shape (results,); NaN where there is none.
    """
    nodes = [dial.scaled(dial.nodes) for dial in dials]
    at = [float(dial.scaled(np.array(value))) for dial, value in zip(dials, place, strict=True)]
    found: Array = np.full(table.shape[-1], np.nan)
    everything = [(0, len(one)) for one in nodes]
    for column in range(found.size):
        values = table[..., column]
        finite = np.isfinite(values)
        block = everything if finite.all() else _block(finite, nodes, at)
        if block is not None:
            one = values[tuple(slice(*ends) for ends in block)]
            for (low, high), x, all_of_it in zip(block, at, nodes, strict=True):
                one = np.tensordot(_weights(all_of_it[low:high], x), one, axes=1)
            found[column] = one
    return found


def _block(
    finite: "NDArray[np.bool_]", nodes: Sequence[Array], at: Sequence[float]
) -> list[tuple[int, int]] | None:
    """Return a block of nodes around a place that all have a value, grown to each side in turn; None if none is there.

    Of a node that is met no neighbour is needed.
    """
    block = []
    for all_of_it, x in zip(nodes, at, strict=True):
        k = int(np.clip(np.searchsorted(all_of_it, x, side="right") - 1, 0, all_of_it.size - 2))
        hit = [j for j in (k, k + 1) if all_of_it[j] == x]
        block.append((hit[0], hit[0] + 1) if hit else (k, k + 2))

    def whole(block: Sequence[tuple[int, int]]) -> bool:
        return bool(finite[tuple(slice(*ends) for ends in block)].all())

    if not whole(block):
        return None
    grown = True
    while grown:
        grown = False
        for axis, all_of_it in enumerate(nodes):
            for down, up in ((1, 0), (0, 1)):
                low, high = block[axis]
                wider = [*block[:axis], (low - down, high + up), *block[axis + 1 :]]
                if low >= down and high + up <= all_of_it.size and whole(wider):
                    block = wider
                    grown = True
    return block


def _weights(nodes: Array, at: float) -> Array:
    """Weights of the nodes in the polynomial through all of them, at a place."""
    if (hit := nodes == at).any():
        return np.asarray(hit, dtype=float)
    apart = nodes[:, None] - nodes
    np.fill_diagonal(apart, 1.0)
    terms = 1.0 / (apart.prod(axis=1) * (at - nodes))
    return np.asarray(terms / terms.sum())
