from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

class RefusedError(ArithmeticError):
    reason: Any
    def __init__(self, message: str, reason: Any = ...) -> None: ...

class System:
    capsule: object
    owner: Any
    n: int
    head: int
    rollers: int
    block: int
    ledger: int
    shares: int
    watched: int
    evaluations: int
    def __init__(self, capsule: object) -> None: ...
    @property
    def frequencies(self) -> tuple[float, float]: ...
    @property
    def places(self) -> NDArray[np.bool_]: ...
    def until_contact(self, t: float, y: ArrayLike) -> float: ...
    def flight(self, t: float, y: ArrayLike, rates: ArrayLike, most: float) -> float: ...
    def held(
        self,
        since: float,
        at: ArrayLike,
        t: float,
        y: ArrayLike,
        half: float = ...,
        before: ArrayLike | None = ...,
        apart: bool = ...,
    ) -> NDArray[np.float64] | None: ...
    def go(self, t: float, h: float, parts: int, y: ArrayLike) -> NDArray[np.float64] | None: ...
    @property
    def scale(self) -> NDArray[np.float64]: ...
    def rates(self, t: float, y: ArrayLike) -> NDArray[np.float64]: ...
    def __call__(self, t: float, y: ArrayLike) -> NDArray[np.float64]: ...
    def jacobian(self, t: float, y: ArrayLike, central: bool = ...) -> NDArray[np.float64]: ...
    def solve(
        self, t: float, y: ArrayLike, shift: float, right: ArrayLike, central: bool = ...
    ) -> tuple[NDArray[np.float64], int]: ...
    def watch(self, t: float, y: ArrayLike) -> NDArray[np.float64]: ...
    def refusal(self) -> Any: ...

def python_system(
    head_rates: Callable[[float, NDArray[np.float64]], ArrayLike],
    head: int,
    *,
    roller_rates: Callable[[float, NDArray[np.float64], NDArray[np.float64]], tuple[ArrayLike, ArrayLike]] | None = ...,
    rollers: int = ...,
    block: int = ...,
    ledger: int = ...,
    scale: ArrayLike = ...,
    watch: Callable[[float, NDArray[np.float64]], ArrayLike] | None = ...,
    watched: int = ...,
    jacobian: Callable[[float, NDArray[np.float64]], ArrayLike] | None = ...,
    autonomous: bool = ...,
    places: ArrayLike | None = ...,
    swing_frequency: float = ...,
) -> object: ...
