"""One roller pitch, after which a bearing of equal rollers repeats itself: which instants of it mirror others.

Roller j at instant m is the mirror image, in the line of load, of roller Z - 1 - j at instant M - m, and carries the
same, unless rings do not mirror themselves.
"""

from collections.abc import Callable, Collection
from typing import Any, Protocol, TypeVar

import attrs
import numpy as np

__all__ = ["over_pitch"]

Floats = np.ndarray[Any, np.dtype[np.float64]]


class Loads(Protocol):
    """What is solved for at instants, as `rollslip.bearing.equilibrium` has it."""

    @property
    def psi(self) -> Floats:
        """Angular positions, (instants, Z)."""


L = TypeVar("L", bound=Loads)

#: Arrays of a `LoadDistribution` whose first axis is that of the instants, beside psi.
_BY_INSTANT = (
    "inner_load", "outer_load", "inner_force", "outer_force", "displacement", "deflection", "roller_shift",
    "roller_tilt", "moment",
)  # fmt: skip


def _worst(parts: Collection[object]) -> dict[str, Any]:
    names = ("force_residual", "moment_residual", "iterations")
    return {name: max(getattr(part, name) for part in parts) for name in names}


def over_pitch(case: Any, known: L | None, solve: Callable[[Any], L]) -> L:
    """Return loads at the instants of a case, some of them solved for, the others mirror images and those known."""
    n_positions = case.psi.shape[0]
    if known is not None and 2 * known.psi.shape[0] != n_positions:
        raise ValueError(
            f"known are {known.psi.shape[0]} instants: of {n_positions} it must be half"
        )
    new = np.arange(n_positions) if known is None else np.arange(1, n_positions, 2)
    last = n_positions // 2 if case.mirrored else n_positions
    solved = new[new <= last]
    images = new[new > last]
    if known is None and not images.size:
        return solve(case)
    solution = solve(attrs.evolve(case, psi=case.psi[solved]))

    def whole_of(name: str) -> Floats:
        part: Floats = getattr(solution, name)
        whole = np.empty((n_positions, *part.shape[1:]))
        if known is not None:
            whole[::2] = getattr(known, name)
        whole[solved] = part
        for image in images:
            whole[image] = (
                whole[n_positions - image] if part.ndim == 1 else whole[n_positions - image, ::-1]
            )
        if name == "displacement":
            whole[images] = whole[images, ::-1] * np.array(
                [1.0, -1.0]
            )  # along the line of load, and across it
        if name == "deflection" and case.rings is not None:
            whole[images] = whole[images, ::-1] * case.rings.parity
        return whole

    pitch: dict[str, Any] = {name: whole_of(name) for name in _BY_INSTANT}
    return attrs.evolve(  # type: ignore[misc]
        solution,
        psi=case.psi,
        **pitch,
        **_worst((solution,) if known is None else (solution, known)),
    )
