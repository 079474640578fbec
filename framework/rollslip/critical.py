"""The critical slip: where the friction of a curve is largest, beyond which it falls with slip."""

from collections.abc import Callable

import attrs
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: A maximum that the rest of the curve undercuts by less than this share is rounding, not a falling branch.
_FLAT = 1e-9


@attrs.frozen
class Critical:
    """The largest friction of a curve: ``slip`` and ``friction``, both NaN unless it lies inside the range.

    ``status`` says in words what was found.
    """

    slip: float
    friction: float
    status: str


def locate(curve: Callable[[float], float], slip: Array, friction: Array, allow: str) -> Critical:
    """Locate the largest friction on the continuous curve, not on its grid.

    Parameters
    ----------
    curve : callable
        Friction at one slip.
    slip, friction : ndarray
        The curve on a grid, slip ascending, shape (n,).
    allow : str
        Setting that widens the range, for the status.

    Returns
    -------
    Critical
        The maximum after Brent's method on the two grid intervals around the best point.
    """
    from scipy.optimize import minimize_scalar

    best = int(np.argmax(friction))
    if not friction[best] > 0.0:
        return Critical(np.nan, np.nan, "no critical slip: there is no friction in the range")
    found = minimize_scalar(
        lambda s: -curve(float(s)),
        bounds=(slip[max(best - 1, 0)], slip[min(best + 1, slip.size - 1)]),
        method="bounded",
        options={"xatol": 1e-10},
    )
    at, largest = float(slip[best]), float(friction[best])
    if -found.fun > largest:  # else a kink or a plateau, which the search did not hit
        at, largest = float(found.x), float(-found.fun)
    if largest - friction[-1] > _FLAT * largest:
        return Critical(at, largest, "found")
    rises = friction[-1] - friction[-2] > _FLAT * largest
    what = "still rises at the end of" if rises else "stays at its largest value up to the end of"
    status = f"no critical slip: friction {what} the range, {slip[-1]:.4g}; raise {allow} to look further"
    return Critical(np.nan, np.nan, status)
