from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from rollslip_kernels.slices import Slices

Array = NDArray[np.float64]
Found = NDArray[np.bool_]
#: Stage, table, load, force, width, first, resists.
Ring = tuple[object, Slices, Array, Array, Array, NDArray[np.intp], bool]
#: Nodes, limits, scale, force, resistance.
Curve = tuple[Array, tuple[float, float], float, Array, Array]
Rows = NDArray[np.intp]

NUDGED: float
SLIDES: float

class Spin:
    def __init__(
        self,
        rollers: int,
        rings: Sequence[Ring | Curve] | Callable[[Array], tuple[Array, Array]],
        radii: tuple[float, float, float, float],
        rolling: float,
        slow: float = 0.0,
        pocket: float = 0.0,
        brakes: Array | None = None,
    ) -> None: ...
    @property
    def evaluated(self) -> tuple[int, int]: ...
    def at(self, inner: Array, outer: Array) -> None: ...
    def torques(self, slip: Array) -> tuple[Array, Array, str]: ...
    @property
    def tractions(self) -> Array: ...
    def on_cage(self, slip: Array, tractions: Array, resistances: Array) -> Array: ...
    def balanced(self, low: Array, high: Array, guess: Array | None = None) -> tuple[Array, Found, str]: ...
    def followed(
        self, leads: Array, rolls: float, slips: Array, ends: Array, known: Array, near: Array, slope: Array
    ) -> tuple[Array, Found, Array, int, str]: ...
    def periodic(self, guess: Array, inertia: float, damping: float = 0.0) -> tuple[Array, float, float, str]: ...
    def sent_round(
        self,
        rows: Rows,
        around: int,
        inertia: Array,
        bracket: Array,
        wide: Array,
        starts: Array,
        orbits: int,
        exact: float,
        known: Array | None = None,
    ) -> tuple[Array, Found, Array, str]: ...
    def settled(
        self,
        rows: Rows,
        around: int,
        inertia: Array,
        guess: Array,
        unit: Array,
        settles: float = ...,
        as_guessed: bool = False,
    ) -> tuple[Array, Array, Array, Found, str]: ...
