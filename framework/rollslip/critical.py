"""The critical slip: where the friction of a curve is largest, beyond which it falls with slip."""

from collections.abc import Callable

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.errors import DomainError

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
        The maximum after Brent's method on the two grid intervals around the best point; the first of equal ones. Its
        place is known to the root of the rounding of the friction, some 1e-8 of the interval, since a maximum is flat.

    Raises
    ------
    DomainError
        If the curve holds NaN or infinity.
    """
    from scipy.optimize import minimize_scalar

    if not np.all(np.isfinite(friction)):
        bad = int(np.argmin(np.isfinite(friction)))
        raise DomainError(f"the friction is {friction[bad]} at a slip of {slip[bad]:.4g}: it must be finite all along")
    best = int(np.argmax(friction))
    if not friction[best] > 0.0:
        return Critical(np.nan, np.nan, "no critical slip: there is no friction in the range")
    low, high = float(slip[max(best - 1, 0)]), float(slip[min(best + 1, slip.size - 1)])
    # relative to the interval and to the best value, so that no size of either is lost in a tolerance
    found = minimize_scalar(
        lambda share: -curve(low + float(share) * (high - low)) / float(friction[best]),
        bounds=(0.0, 1.0),
        method="bounded",
        options={"xatol": 1e-9},
    )
    at, largest = float(slip[best]), float(friction[best])
    if -found.fun > 1.0:  # else a kink or a plateau, which the search did not hit
        at = low + float(found.x) * (high - low)
        largest = curve(at)
    if largest - friction[-1] > _FLAT * largest:
        return Critical(at, largest, "found")
    rises = friction[-1] - friction[-2] > _FLAT * largest
    what = "still rises at the end of" if rises else "stays at its largest value up to the end of"
    status = f"no critical slip: friction {what} the range, {slip[-1]:.4g}; raise {allow} to look further"
    return Critical(np.nan, np.nan, status)
