from collections.abc import Callable, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

MOST_AXES: Final[int]

class Varying:
    def __init__(
        self,
        courses: Sequence[tuple[ArrayLike, ArrayLike]],
        ranges: Sequence[tuple[float, float]],
        around: Callable[[tuple[float, ...]], tuple[Sequence[Sequence[float]], Sequence[Any]]],
        *,
        speed_axis: int = ...,
        root_axis: int = ...,
        cage_speed: int,
        inner_share: float,
        still: float = ...,
        autonomous: bool = ...,
        scale: ArrayLike,
    ) -> None: ...
    def system(self, swing_frequency: float = ...) -> object: ...
    def values(self, t: ArrayLike) -> NDArray[np.float64]: ...
    @property
    def stations(self) -> tuple[Any, ...]: ...
    @property
    def contacts_evaluated(self) -> int: ...
    @property
    def refused_by(self) -> Any: ...
    def refusal(self) -> tuple[str, Any] | None: ...
    def outputs(self, t: ArrayLike, y: ArrayLike) -> dict[str, NDArray[np.float64]] | None: ...
    def stored_energy(self, x: ArrayLike) -> NDArray[np.float64]: ...
