from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from rollslip_kernels.slices import Slices

ROWS: int

def solve(
    stages: Sequence[object],
    tables: Sequence[Slices],
    direction: NDArray[np.float64],
    form: NDArray[np.float64],
    xi: NDArray[np.float64],
    drop: NDArray[np.float64],
    weights: NDArray[np.float64],
    length: float,
    clearance: float,
    rise: float,
    given: NDArray[np.float64],
    held: NDArray[np.float64],
    stops: NDArray[np.float64],
    outer: int,
    centrifugal: NDArray[np.float64],
    reach: float,
    found: dict[str, NDArray[np.float64]],
    pull: NDArray[np.float64] | None = None,
) -> Literal["", "inner", "outer", "range"]: ...
