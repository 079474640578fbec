from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rollslip_kernels.chain import Chain, Refusal
from rollslip_kernels.slices import Slices

REST_SPEED: float
OUTPUTS: tuple[str, ...]

def constant(rollers: int, coefficient: float, transition: float) -> object: ...
def effective(
    rollers: int,
    nodes: ArrayLike,
    limits: Sequence[float],
    sliding_scale: float = ...,
    sliding_ratio: float = ...,
    row_limits: Sequence[float] = ...,
    rolling_scale: float = ...,
) -> object: ...
def conventional(
    chain: Chain,
    slices: Slices,
    rollers: int,
    widths: ArrayLike,
    resists: bool,
    position: ArrayLike | None = ...,
    across: float = ...,
) -> object: ...
def with_table(
    raceway: object,
    values: ArrayLike,
    sliding_scale: float,
    sliding_end: float,
    root_scale: float,
    root_ends: Sequence[float],
    speed_scale: float,
    speed_ends: Sequence[float],
) -> object: ...
def table_friction(
    raceway: object, force: ArrayLike, sliding: ArrayLike, rolling: ArrayLike
) -> NDArray[np.float64] | None: ...
def refusal(raceway: object) -> Refusal | None: ...
def friction(
    raceway: object, load: ArrayLike, force: ArrayLike, sliding: ArrayLike, rolling: ArrayLike, resistance: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], int]: ...
