"""Roller profiles: the drop of the surface below a straight cylinder along the roller (ISO/TS 16281)."""

import numpy as np
from numpy.typing import ArrayLike

from rollslip.errors import DomainError
from rollslip.search import Array

SHAPES = ("none", "iso16281", "circular", "table")


def slice_positions(length: float, slices: int) -> Array:
    """Return the midpoints of equal slices of a roller, from its middle [m], (slices,), by its effective length [m]."""
    if not 0.0 < length < np.inf or slices < 1:
        raise ValueError(
            f"a roller of length {length} m cannot be cut into {slices} slices: both must be positive"
        )
    # Odd integers times half a width: symmetric about the middle to the last bit.
    return np.arange(1.0 - slices, slices, 2.0) * (length / (2.0 * slices))


def profile_drop(
    shape: str,
    positions: ArrayLike,
    roller_length: float,
    roller_diameter: float,
    radius: float | None = None,
    table: tuple[ArrayLike, ArrayLike] | None = None,
) -> Array:
    """Return the radial distance of the surface of a roller from a straight cylinder, P [m].

    - ``none``: a straight roller, P = 0.
    - ``iso16281``: the logarithmic reference profile of ISO/TS 16281,
      P(x) = 0.00035 D ln(1 / (1 - (2 x / L)^2)). It diverges at the ends, which are not midpoints of slices.
    - ``circular``: a circular arc along the full length, P(x) = R - sqrt(R^2 - x^2).
    - ``table``: measured or designed, interpolated by monotone cubics (PCHIP), which pass through every point, do not
      overshoot and have no kinks, at which pressure would concentrate. It need not be symmetric.

    Parameters
    ----------
    shape : str
        One of these.
    positions : array_like
        Positions x from the middle of the roller [m].
    roller_length : float
        Effective length L of the roller [m].
    roller_diameter : float
        Diameter D of the roller [m].
    radius : float, optional
        Radius R of the circular arc [m].
    table : (array_like, array_like), optional
        Ascending positions that cover the roller, and the drop there [m], (n,) each.

    References
    ----------
    ISO/TS 16281:2008, Rolling bearings: methods for calculating the modified reference rating life.
    """
    if shape not in SHAPES:
        raise ValueError(f"unknown roller profile {shape!r}: one of {', '.join(SHAPES)}")
    for name, value, owner in (("radius", radius, "circular"), ("table", table, "table")):
        if (value is None) == (shape == owner):
            raise ValueError(
                f"the roller profile {shape!r} {'needs' if shape == owner else 'has no'} {name!r}"
            )
    if not (0.0 < roller_length < np.inf and 0.0 < roller_diameter < np.inf):
        raise ValueError(
            f"roller length {roller_length} m and diameter {roller_diameter} m must be positive"
        )

    x = np.asarray(positions, dtype=float)
    half = 0.5 * roller_length
    if not np.all(np.abs(x) <= half):
        raise ValueError(
            f"positions must lie on the roller, between {-half} m and {half} m of its middle"
        )
    if radius is not None:
        return _crown(x, half, radius)
    if table is not None:
        return _interpolated(x, half, *(np.asarray(column, dtype=float) for column in table))
    if shape == "none":
        return np.zeros_like(x)
    if np.any(np.abs(x) == half):
        raise DomainError(
            "the logarithmic profile is infinite at the ends of the roller: evaluate it at midpoints of slices"
        )
    return -0.00035 * roller_diameter * np.log1p(-((x / half) ** 2))


def _crown(x: Array, half: float, radius: float) -> Array:
    if not half <= radius < np.inf:
        raise ValueError(
            f"a crown of radius {radius} m does not span the roller: at least half its length, {half} m"
        )
    # R - sqrt(R^2 - x^2) without cancellation: R is a thousand times x.
    crown: Array = x**2 / (radius + np.sqrt((radius - x) * (radius + x)))
    return crown


def _interpolated(x: Array, half: float, position: Array, drop: Array) -> Array:
    if position.ndim != 1 or position.shape != drop.shape or position.size < 2:
        raise ValueError("a profile table needs two positions or more and as many drops")
    if not np.all(np.isfinite([position, drop])):
        raise ValueError("the positions and drops of a profile table must be finite")
    if not np.all(np.diff(position) > 0.0):
        raise ValueError("the positions of a profile table must ascend")
    slack = 1e-9 * half  # rounding of converted units
    if position[0] > -half + slack or position[-1] < half - slack:
        raise ValueError(
            f"the profile table spans {position[0]} to {position[-1]} m from the roller's middle: "
            f"it must cover the roller, {-half} to {half} m"
        )
    from scipy.interpolate import PchipInterpolator

    # the reciprocal of a slope overflows where drops are denormal
    with np.errstate(over="ignore", divide="ignore"):
        interpolated: Array = PchipInterpolator(position, drop)(
            np.clip(x, position[0], position[-1])
        )
    return interpolated
