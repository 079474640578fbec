from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rollslip_kernels.chain import Chain, Refusal
from rollslip_kernels.slices import Slices

NUMBERS: tuple[str, ...]
LEDGER_UNITS: Mapping[str, str]

class Planar:
    n: int
    def __init__(
        self,
        raceways: Sequence[object],
        deflections: Sequence[Chain],
        contacts: Sequence[Slices],
        drop: ArrayLike,
        widths: ArrayLike,
        drags: Sequence[object],
        rollers: int,
        guidance: int,
        scale: ArrayLike,
        forces: Sequence[tuple[float, ArrayLike]] | None = ...,
        resistances: Sequence[tuple[float, ArrayLike]] | None = ...,
        rings: Sequence[tuple[Sequence[ArrayLike], ArrayLike | None, bool]] | None = ...,
        critical_slip: float = ...,
        film_limit: float = ...,
        each: bool = ...,
        **numbers: float,
    ) -> None: ...
    def system(self, swing_frequency: float = ...) -> object: ...
    @property
    def operation(self) -> NDArray[np.float64]: ...
    def refusal(self) -> tuple[str, Refusal | None] | None: ...
    def outputs(self, t: ArrayLike, y: ArrayLike) -> dict[str, NDArray[np.float64]] | None: ...
    @property
    def contacts_evaluated(self) -> int: ...
    @property
    def deflections_evaluated(self) -> int: ...

def land(
    x: float, y: float, vx: float, vy: float, journal_speed: float, bush_speed: float, **numbers: float
) -> tuple[float, float, float, float, float, float]: ...
