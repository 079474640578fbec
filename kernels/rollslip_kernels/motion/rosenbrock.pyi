from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

REASONS: tuple[str, ...]

def tableau() -> dict[str, Any]: ...
def explicit_tableau() -> dict[str, Any]: ...

class Stepper:
    capsule: object
    n: int
    t: float
    h: float
    t_bound: float
    max_step: float
    status: str
    message: str
    event: int
    rising: bool
    steps: int
    rejected: int
    evaluations: int
    jacobians: int
    factorisations: int
    def __init__(
        self,
        capsule: object,
        t0: float,
        y0: ArrayLike,
        t_bound: float,
        rtol: ArrayLike = ...,
        atol: ArrayLike = ...,
        max_step: float = ...,
        first_step: float | None = ...,
    ) -> None: ...
    @property
    def y(self) -> NDArray[np.float64]: ...
    @property
    def state(self) -> NDArray[np.float64]: ...
    @state.setter
    def state(self, values: ArrayLike) -> None: ...
    @property
    def continuous(self) -> tuple[float, float, NDArray[np.float64]]: ...
    def restart(self, t: float, y: ArrayLike, h: float = ...) -> None: ...
    def step(self) -> str: ...
    def advance(
        self,
        t_stop: float | None = ...,
        t_out: ArrayLike | None = ...,
        y_out: NDArray[np.float64] | None = ...,
        max_steps: int = ...,
    ) -> tuple[str, int]: ...
    def interpolate(self, t: float) -> NDArray[np.float64]: ...

class Rosenbrock(Stepper): ...
class DormandPrince(Stepper): ...
