"""How a steady slip of a cage moves with a parameter, through folds.

- Slips are followed by pseudo-arclength: the next point is sought across the direction in which the last two lie, with
  slip and parameter both unknown, so that a fold is a point like any other. There the parameter turns, and with it the
  stability: a steady slip lasts where more slip leaves more torque to speed the cage up.
"""

from collections.abc import Callable

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.bearing.raceway import Array
from rollslip.errors import ConvergenceError
from rollslip.search import secants

#: Steps along a branch in shares of the box: the first one, the largest, and the smallest before giving up.
_FIRST_STEP = 0.01
_LARGEST_STEP = 0.05
_SMALLEST_STEP = 1e-6
#: Cosine of the largest turn of a branch in one step.
_TURN = 0.95
_MAX_STEPS = 600
#: Precision of a point of a branch, as a share of the box.
_PRECISE = 1e-7
#: Step by which the excess torque is differentiated, as a share of the box.
_NUDGE = 1e-5


@attrs.frozen(eq=False)
class Branch:
    """Steady slips against a parameter, in order along the branch."""

    #: slip, parameter: (n,).
    slip: Array
    parameter: Array
    stable: NDArray[np.bool_]  # whether the cage holds the slip, (n,); not at a fold
    folds: tuple[int, ...]  # numbers of the points at which the parameter turns
    start: int  # number of the point from which it was followed

    def passes(self, slip: float, parameter: float) -> bool:
        """Whether the branch goes through a point, to a hundredth of its size."""
        before = self.parameter[:-1]
        after = self.parameter[1:]
        crosses = np.flatnonzero((before - parameter) * (after - parameter) <= 0.0)
        fraction = (parameter - before[crosses]) / np.where(after == before, 1.0, after - before)[
            crosses
        ]
        slips = self.slip[crosses] + fraction * (self.slip[crosses + 1] - self.slip[crosses])
        return bool(np.any(np.abs(slips - slip) <= 0.01 * np.ptp(self.slip)))

    @property
    def at_fold(self) -> NDArray[np.bool_]:
        """Whether the parameter turns at a point, (n,)."""
        return np.isin(np.arange(self.slip.size), self.folds)

    def nearest_fold(self) -> int | None:
        """Number of the fold next to the start along the branch, None if there is none."""
        return min(self.folds, key=lambda fold: abs(fold - self.start), default=None)


def follow(
    excess: Callable[[float, float], float],
    start: tuple[float, float],
    limits: tuple[float, float],
    largest: float,
) -> Branch:
    """Follow a steady slip both ways through the box of slips up to the largest and of parameters within limits.

    Parameters
    ----------
    excess : callable
        Excess torque [N m] at slip and parameter.
    start : tuple of float
        A steady slip and the parameter it belongs to.
    limits : tuple of float
        Least and largest value of the parameter.
    largest : float
        Largest slip.

    References
    ----------
    H. B. Keller, "Numerical solution of bifurcation and nonlinear eigenvalue problems", in: Applications of Bifurcation
    Theory (1977): pseudo-arclength.
    """
    path = _Path(excess, limits, largest)
    begin = np.array([start[0] / largest, (start[1] - limits[0]) / (limits[1] - limits[0])])
    gradient = path.gradient(begin)
    along = np.array([-gradient[1], gradient[0]]) / np.hypot(*gradient)
    back, there = (
        path.walk(begin, sign * along, -sign * float(np.hypot(*gradient))) for sign in (-1.0, 1.0)
    )
    z = np.array([*back[::-1], begin, *there])
    first = len(back)
    folds = list[int]()
    for k in range(z.shape[0] - 2, 0, -1):
        if (z[k, 1] - z[k - 1, 1]) * (z[k + 1, 1] - z[k, 1]) < 0.0:
            fold = path.fold(z[k - 1], z[k + 1], z[k])
            at = k + int((fold - z[k]) @ (z[k + 1] - z[k - 1]) > 0.0)
            z = np.insert(z, at, fold, axis=0)
            folds = [at, *(number + 1 for number in folds)]
            first = first + int(at <= first)
    # on the way of the first tangent the parameter rises where more slip leaves more torque
    rising = np.sign(np.diff(z[:, 1]))
    stable = np.append(rising, rising[-1]) > 0.0
    stable[folds] = False
    parameter = limits[0] + z[:, 1] * (limits[1] - limits[0])
    return Branch(z[:, 0] * largest, parameter, stable, tuple(folds), first)


class _Path:
    """A branch in the unit box of slip and parameter."""

    def __init__(
        self, excess: Callable[[float, float], float], limits: tuple[float, float], largest: float
    ) -> None:
        self._excess = excess
        self._limits = limits
        self._largest = largest

    def value(self, z: Array) -> float:
        low, high = self._limits
        return self._excess(float(z[0]) * self._largest, low + float(z[1]) * (high - low))

    def gradient(self, z: Array) -> Array:
        """Slopes of the excess torque, towards the inside of the box."""
        here = self.value(z)
        out = []
        for axis in range(2):
            moved = z.copy()
            moved[axis] += _NUDGE if z[axis] < 0.5 else -_NUDGE
            out.append((self.value(moved) - here) / (moved[axis] - z[axis]))
        return np.array(out)

    def walk(self, z: Array, tangent: Array, slope: float) -> list[Array]:
        """Points of the branch from z on until it leaves the box."""
        points: list[Array] = []
        step = _FIRST_STEP
        for _ in range(_MAX_STEPS):
            reach = _to_edge(z, tangent)
            if reach <= _SMALLEST_STEP:
                return points
            ends = reach <= step
            across = np.array([-tangent[1], tangent[0]])
            if ends:  # the last point lies on the edge
                edge = z + reach * tangent
                axis = int(np.argmax(np.maximum(-edge, edge - 1.0)))
                across = np.eye(2)[1 - axis]
            predicted = np.clip(z + min(step, reach) * tangent, 0.0, 1.0)
            balance = self._across(predicted, across, slope, step)
            if balance is not None:
                corrected, slope = balance
                chord = (corrected - z) / np.hypot(*(corrected - z))
                if chord @ tangent >= _TURN:
                    tangent = 2.0 * (chord @ tangent) * chord - tangent  # as on a circle
                    points.append(corrected)
                    if ends:
                        return points
                    near = np.hypot(*(corrected - predicted)) < 0.1 * step
                    z = corrected
                    step = min(step * (1.5 if near else 1.0), _LARGEST_STEP)
                    continue
            step *= 0.5
            if step < _SMALLEST_STEP:
                break
        slip = z[0] * self._largest
        parameter = self._limits[0] + z[1] * (self._limits[1] - self._limits[0])
        raise ConvergenceError(
            f"the steady slip cannot be followed beyond a cage slip of {slip:.4g} at {parameter:.6g}: it turns within "
            f"{step:.0e} of the range, where rollers change their motion at once"
        )

    def _across(
        self, z: Array, across: Array, slope: float, reach: float
    ) -> tuple[Array, float] | None:
        """Nearest balance on a line within reach, by the secant method, and the slope there; None if there is none."""
        within = -min(reach, _to_edge(z, -across)), min(reach, _to_edge(z, across))
        found = secants(
            lambda at: self.value(z + at * across), 0.0, slope, tolerance=_PRECISE, within=within
        )
        return None if found is None else (z + found[0] * across, found[1])

    def fold(self, left: Array, right: Array, middle: Array) -> Array:
        """Place between two points where the parameter is least, or largest, as at the one in the middle."""
        from scipy.optimize import minimize_scalar

        upwards = np.array([0.0, 1.0])
        sign = 1.0 if middle[1] < left[1] else -1.0
        best = middle
        slope = self.gradient(middle)[1]

        def parameter(slip: float) -> float:
            nonlocal best, slope
            balance = self._across(np.array([slip, best[1]]), upwards, slope, 1.0)
            if balance is None:
                raise ConvergenceError(
                    f"the fold of the steady slips between cage slips of {left[0] * self._largest:.4g} and "
                    f"{right[0] * self._largest:.4g} cannot be located, where rollers change their motion at once"
                )
            best, slope = balance
            return sign * float(best[1])

        low, high = sorted((float(left[0]), float(right[0])))
        place = minimize_scalar(
            parameter, bounds=(low, high), method="bounded", options={"xatol": 1e-3 * (high - low)}
        )
        parameter(float(place.x))
        return best


def _to_edge(z: Array, tangent: Array) -> float:
    """Length along a direction to the edge of the unit box."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(
            np.where(
                tangent > 0.0, (1.0 - z) / tangent, np.where(tangent < 0.0, -z / tangent, np.inf)
            ).min()
        )
