from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

LEDGER: dict[str, str]

class Carried:
    def __init__(
        self,
        pocket: bool,
        bearing: Mapping[str, float],
        loads: tuple[float, ArrayLike, Callable[[float], tuple[float, float, ArrayLike, ArrayLike]]],
        inner: object,
        outer: object,
        drags: Sequence[object],
        cage: Mapping[str, float],
        scale: ArrayLike,
        critical_slip: float = ...,
        film_limit: float = ...,
        each: bool = ...,
    ) -> None: ...
    def system(self) -> object: ...
    @property
    def operation(self) -> NDArray[np.float64]: ...
    @property
    def contacts_evaluated(self) -> int: ...
    def refusal(self) -> tuple[str, Any] | None: ...
    def outputs(self, t: ArrayLike, y: ArrayLike) -> dict[str, NDArray[np.float64]] | None: ...
    def stored_energy(self, x: ArrayLike) -> NDArray[np.float64]: ...
