"""Grid of an explorer: tensor-product polynomial interpolation of results at Chebyshev-Lobatto nodes.

- The nodes of each quantity are Chebyshev-Lobatto points, whose interpolating polynomial is close to the best
  approximation (Trefethen 2013, Approximation Theory and Approximation Practice, chapter 8). Quantities with a range of
  more than a factor are interpolated over their logarithms.
- The polynomial of all quantities together is evaluated by its barycentric weights (Berrut & Trefethen 2004,
  doi:10.1137/S0036144502417715).
- A result may be missing at some nodes, for example a skidding slip beyond the range. It is then interpolated over the
  largest block of nodes around the point in which all have it. If a node next to the point lacks it, there is no value.
- The page has the same algorithm in JavaScript; a test compares both.
"""

import math
from collections.abc import Mapping, Sequence

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.scene.values import Scene
from rollslip.search import Array
from rollslip.units import format_quantity

__all__ = ["Dial", "Explorer", "interpolate"]


@attrs.frozen(eq=False)
class Dial:
    """A quantity with a slider.

    Attributes
    ----------
    key : str
        Key in the scene.
    name : str
        Label.
    unit : str
        SI unit.
    shown : str
        Unit for display.
    low : float
        Lower bound, in SI units.
    high : float
        Upper bound, in SI units.
    start : float
        Initial value, in SI units.
    count : int
        Number of nodes, two or more.
    logarithmic : bool
        Whether results are interpolated over the logarithm of the quantity.
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
        """Chebyshev-Lobatto nodes from `low` to `high`, which are nodes too."""
        inner = -np.cos(np.pi * np.arange(self.count) / (self.count - 1))
        low, high = self.scaled(np.array([self.low, self.high]))
        values = 0.5 * (low + high) + 0.5 * (high - low) * inner
        nodes = np.exp(values) if self.logarithmic else values
        nodes[[0, -1]] = self.low, self.high
        return np.asarray(nodes)

    @property
    def message(self) -> str:
        """Line that describes the quantity."""
        low, high, start = (
            format_quantity(value, self.unit, 4) for value in (self.low, self.high, self.start)
        )
        return f"{self.key}: {low} to {high}, {self.count} nodes; {start} in the scene"

    def scaled(self, value: Array) -> Array:
        """Return values on the scale of the interpolation, logarithmic or linear."""
        return np.log(value) if self.logarithmic else np.asarray(value)


@attrs.frozen(eq=False)
class Explorer:
    """The plan of an explorer.

    Attributes
    ----------
    scene : Scene
        The scene without tables of campaigns.
    dials : tuple of Dial
        Quantities with sliders.
    choices : mapping of str to tuple of str
        Key -> names of the models to choose from.
    checks : int
        Number of random points at which the interpolation is compared with runs, for each combination of models.
    """

    scene: "Scene"
    dials: tuple[Dial, ...]
    choices: Mapping[str, tuple[str, ...]]
    checks: int

    @property
    def messages(self) -> list[str]:
        """Lines that describe quantities, models and the number of points, printed before the points are computed."""
        return [
            *(f"  {dial.message}" for dial in self.dials),
            *(f"  {key}: {', '.join(names)}" for key, names in self.choices.items()),
            f"  {self.size} points, {self.checks} random ones for each combination of models among them",
        ]

    @property
    def size(self) -> int:
        """Number of points that are computed."""
        combinations = math.prod(map(len, self.choices.values()))
        return combinations * (math.prod(dial.count for dial in self.dials) + self.checks)


def interpolate(dials: Sequence[Dial], table: Array, position: Sequence[float]) -> Array:
    """Return the interpolated results at a point.

    Parameters
    ----------
    dials : sequence of Dial
        The varied quantities.
    table : ndarray
        Results at the nodes, shape (nodes of each dial in turn, results); NaN where there is none.
    place : sequence of float
        Values of the quantities in SI units, within their bounds.

    Returns
    -------
    ndarray
        Results, shape (results,); NaN where there is none.
    """
    nodes = [dial.scaled(dial.nodes) for dial in dials]
    point = [
        float(dial.scaled(np.array(value))) for dial, value in zip(dials, position, strict=True)
    ]
    results: Array = np.full(table.shape[-1], np.nan)
    all_nodes = [(0, len(axis_nodes)) for axis_nodes in nodes]
    for column in range(results.size):
        values = table[..., column]
        finite = np.isfinite(values)
        block = all_nodes if finite.all() else _complete_block(finite, nodes, point)
        if block is not None:
            block_values = values[tuple(slice(*ends) for ends in block)]
            for (low, high), x, axis_nodes in zip(block, point, nodes, strict=True):
                block_values = np.tensordot(
                    _barycentric_weights(axis_nodes[low:high], x), block_values, axes=1
                )
            results[column] = block_values
    return results


def _complete_block(
    finite: "NDArray[np.bool_]", nodes: Sequence[Array], point: Sequence[float]
) -> list[tuple[int, int]] | None:
    """Block of nodes around a point that all have a value, as (start, end) for each axis; None if there is none.

    1. Start with the two nodes next to the point on each axis, or with one node if the point is at it.
    2. Extend the block by a layer of nodes on each side in turn, as long as all nodes of the layer have a value.
    """
    block = []
    for axis_nodes, x in zip(nodes, point, strict=True):
        k = int(np.clip(np.searchsorted(axis_nodes, x, side="right") - 1, 0, axis_nodes.size - 2))
        hit_nodes = [j for j in (k, k + 1) if axis_nodes[j] == x]
        block.append((hit_nodes[0], hit_nodes[0] + 1) if hit_nodes else (k, k + 2))

    def is_complete(block: Sequence[tuple[int, int]]) -> bool:
        return bool(finite[tuple(slice(*ends) for ends in block)].all())

    if not is_complete(block):
        return None
    has_grown = True
    while has_grown:
        has_grown = False
        for axis, axis_nodes in enumerate(nodes):
            for extend_low, extend_high in ((1, 0), (0, 1)):
                low, high = block[axis]
                extended = [
                    *block[:axis],
                    (low - extend_low, high + extend_high),
                    *block[axis + 1 :],
                ]
                if (
                    low >= extend_low
                    and high + extend_high <= axis_nodes.size
                    and is_complete(extended)
                ):
                    block = extended
                    has_grown = True
    return block


def _barycentric_weights(nodes: Array, x: float) -> Array:
    """Weights of the values at the nodes in their interpolating polynomial at x (barycentric formula)."""
    if (hit := nodes == x).any():
        return np.asarray(hit, dtype=float)
    differences = nodes[:, None] - nodes
    np.fill_diagonal(differences, 1.0)
    terms = 1.0 / (differences.prod(axis=1) * (x - nodes))
    return np.asarray(terms / terms.sum())
