"""Use the mirror symmetry of a roller pitch, after which a bearing of equal rollers repeats itself.

Roller j at position m of M is the mirror image, in the line of load, of roller Z - 1 - j at position M - m. Both carry
the same load, unless a ring or a body force is not symmetric. So only half of the positions are solved for.
"""

from collections.abc import Callable, Collection
from typing import Any, Protocol, TypeVar

import attrs
import numpy as np

from rollslip.search import Array

__all__ = ["over_pitch"]


class Loads(Protocol):
    """Solution at several roller positions: a `rollslip.bearing.equilibrium.LoadDistribution`."""

    @property
    def psi(self) -> Array:
        """Angular positions of the rollers [rad], (n_positions, Z)."""


L = TypeVar("L", bound=Loads)

#: Arrays of a `LoadDistribution`, other than psi, whose first axis is that of the roller positions.
_BY_POSITION = (
    "inner_load", "outer_load", "inner_force", "outer_force", "displacement", "deflection", "roller_shift",
    "roller_tilt", "moment",
)  # fmt: skip


def _largest_residuals(parts: Collection[object]) -> dict[str, Any]:
    """Return the largest residuals and number of iterations of several solutions."""
    names = ("force_residual", "moment_residual", "iterations")
    return {name: max(getattr(part, name) for part in parts) for name in names}


def over_pitch(case: Any, known: L | None, solve: Callable[[Any], L]) -> L:
    """Return the loads at all roller positions of a case; positions that mirror others, or are known, are not solved.

    Parameters
    ----------
    case : LoadCase
        The bearing, with positions `psi` [rad], (n_positions, Z), and whether it is `mirrored`.
    known : LoadDistribution, optional
        Loads at every second position of the case.
    solve : callable
        Returns the loads of a case with fewer positions.

    Returns
    -------
    LoadDistribution
        The loads at all positions. Residuals and iterations are the largest of the parts.
    """
    n_positions = case.psi.shape[0]
    if known is not None and 2 * known.psi.shape[0] != n_positions:
        raise ValueError(
            f"known are {known.psi.shape[0]} positions: of {n_positions} it must be half"
        )
    missing = np.arange(n_positions) if known is None else np.arange(1, n_positions, 2)
    last = n_positions // 2 if case.mirrored else n_positions
    solved = missing[missing <= last]
    images = missing[missing > last]
    if known is None and not images.size:
        return solve(case)
    solution = solve(attrs.evolve(case, psi=case.psi[solved]))

    def at_all_positions(name: str) -> Array:
        part: Array = getattr(solution, name)
        whole = np.empty((n_positions, *part.shape[1:]))
        if known is not None:
            whole[::2] = getattr(known, name)
        whole[solved] = part
        for image in images:
            whole[image] = (
                whole[n_positions - image] if part.ndim == 1 else whole[n_positions - image, ::-1]
            )
        if name == "displacement":
            # the component along the line of load stays, that across it changes sign
            whole[images] = whole[images, ::-1] * np.array([1.0, -1.0])
        if name == "deflection" and case.rings is not None:
            whole[images] = whole[images, ::-1] * case.rings.parity
        return whole

    pitch: dict[str, Any] = {name: at_all_positions(name) for name in _BY_POSITION}
    return attrs.evolve(  # type: ignore[misc]
        solution,
        psi=case.psi,
        **pitch,
        **_largest_residuals((solution,) if known is None else (solution, known)),
    )
