"""Branches of steady slips over a parameter such as the radial load, by pseudo-arclength continuation through folds.

A branch is a curve on which the excess torque is zero in the plane of slip and parameter. Both are scaled to the unit
box.

1. At the start the gradient of the excess torque gives the tangent. The branch is followed both ways.
2. Predict the next point by a step along the tangent.
3. Correct it by secants along the normal of the tangent, with slip and parameter both unknown, so that a fold is a
   point like any other. The secants start with the slope of the last point.
4. Reject the point and halve the step where the secants fail or the chord turns by more than the largest turn; give up
   below the smallest step.
5. The next tangent is the last one reflected in the chord, as on a circle. Lengthen the step by half where the
   correction was below a tenth of it.
6. At the edge of the box the last point lies on the edge.
7. Where the parameter turns between neighbours there is a fold: minimise or maximise the parameter over the slip there
   by Brent's bounded method (`scipy.optimize.minimize_scalar`).
8. A slip is stable where more slip leaves more torque to speed the cage up; the stability changes at a fold.

References
----------
H. B. Keller, "Numerical solution of bifurcation and nonlinear eigenvalue problems", in: Applications of Bifurcation
Theory (1977): pseudo-arclength.
"""

import math
from collections.abc import Callable
from typing import Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.bearing.critical import MAX_CAGE_SLIP, search_range_hint
from rollslip.bearing.raceway import Array
from rollslip.errors import ConvergenceError
from rollslip.results.text import SWITCHED_OFF
from rollslip.search import secant_root
from rollslip.units import format_quantity
from rollslip_studies.steady_slip.outputs import VARIED

# Settings of the continuation; lengths are relative to the unit box of slip and parameter. Their effects were measured
# on branches over the load of two scenes of the catalogue, with a constant drag of 0.6 N m: no half or double value
# changed the load at the fold by 1e-7.

#: Length of the first step. Half or twice as much adds or saves three points. Chosen.
_FIRST_STEP: Final = 0.01
#: Largest step. Half of it takes 75 points instead of 40 and 39 % more time, twice of it 24 to 29 points, between which
#: figures draw straight lines. Chosen.
_MAX_STEP: Final = 0.05
#: Step below which the continuation gives up, because no step is small enough where rollers change their motion at
#: once. Half as much costs one halving more. Chosen.
_MIN_STEP: Final = 1e-6
#: Cosine of the largest angle between tangent and chord, 18 degrees, beyond which a step may lead to another branch.
#: Neither 0.8 nor 0.99 changed a point. Chosen.
_MIN_COSINE: Final = 0.95
#: Largest number of steps, rejected ones included, a bound on the time. A branch takes 40 to 80. Chosen.
_MAX_STEPS: Final = 600
#: Tolerance of a point, along the normal. Half or twice as much changes neither points nor time. Chosen.
_TOLERANCE: Final = 1e-7
#: Step of the differences for the gradient. Twice as much doubles their error by curvature, half as much their error by
#: rounding; neither changed a point. Chosen between both.
_DIFFERENCE: Final = 1e-5

#: Part of a range of parameters that a branch may leave out and still count as going through it. It covers the last
#: step of the continuation, which ends inside the range; twice as much calls shorter branches complete. Chosen.
_RANGE_TOLERANCE: Final = 1e-3


@attrs.frozen(eq=False)
class Branch:
    """Steady slips against a parameter, in order along the branch."""

    slip: Array  #: Cage slip [-], (n,).
    parameter: Array  #: Parameter in SI units, (n,).
    stable: NDArray[np.bool_]  #: Whether the slip is stable, (n,); at a fold it is not.
    folds: tuple[int, ...]  #: Indices of the points at which the parameter turns.
    start: int  #: Index of the point from which the branch was followed.

    def passes(self, slip: float, parameter: float) -> bool:
        """Whether the branch goes through a point, within a hundredth of its range of slips.

        Parameters
        ----------
        slip : float
            Cage slip of the point [-].
        parameter : float
            Parameter of the point, in SI units.
        """
        before = self.parameter[:-1]
        after = self.parameter[1:]
        crosses = np.flatnonzero((before - parameter) * (after - parameter) <= 0.0)
        change = np.where(after == before, 1.0, after - before)[crosses]
        fraction = (parameter - before[crosses]) / change
        slips = self.slip[crosses] + fraction * (self.slip[crosses + 1] - self.slip[crosses])
        return bool(np.any(np.abs(slips - slip) <= 0.01 * np.ptp(self.slip)))

    @property
    def at_fold(self) -> NDArray[np.bool_]:
        """Whether the parameter turns at a point, (n,)."""
        return np.isin(np.arange(self.slip.size), self.folds)

    def nearest_fold(self) -> int | None:
        """Return the index of the fold next to the start along the branch; None if the branch has no fold."""
        return min(self.folds, key=lambda fold: abs(fold - self.start), default=None)


def follow(
    excess: Callable[[float, float], float],
    start: tuple[float, float],
    limits: tuple[float, float],
    largest: float,
) -> Branch:
    """Return the branch of a steady slip, followed both ways to slips of 0 and the largest or to the limits.

    Parameters
    ----------
    excess : callable
        Excess torque [N m] at slip and parameter.
    start : tuple of float
        A steady slip [-] and its parameter, in SI units.
    limits : tuple of float
        Smallest and largest value of the parameter.
    largest : float
        Largest slip [-].

    Raises
    ------
    ConvergenceError
        If the branch turns within less than the smallest step, or a fold cannot be located.
    """
    path = _Path(excess, limits, largest)
    first_point = np.array([start[0] / largest, (start[1] - limits[0]) / (limits[1] - limits[0])])
    gradient = path.gradient(first_point)
    along = np.array([-gradient[1], gradient[0]]) / np.hypot(*gradient)
    before, after = (
        path.walk(first_point, sign * along, -sign * float(np.hypot(*gradient)))
        for sign in (-1.0, 1.0)
    )
    z = np.array([*before[::-1], first_point, *after])
    first = len(before)
    folds = list[int]()
    for k in range(z.shape[0] - 2, 0, -1):
        if (z[k, 1] - z[k - 1, 1]) * (z[k + 1, 1] - z[k, 1]) < 0.0:
            fold = path.fold(z[k - 1], z[k + 1], z[k])
            at = k + int((fold - z[k]) @ (z[k + 1] - z[k - 1]) > 0.0)
            z = np.insert(z, at, fold, axis=0)
            folds = [at, *(index + 1 for index in folds)]
            first = first + int(at <= first)
    # in the sense of the first tangent the parameter rises where more slip leaves more torque
    rising = np.sign(np.diff(z[:, 1]))
    stable = np.append(rising, rising[-1]) > 0.0
    stable[folds] = False
    parameter = limits[0] + z[:, 1] * (limits[1] - limits[0])
    return Branch(z[:, 0] * largest, parameter, stable, tuple(folds), first)


@attrs.frozen
class _Path:
    """Excess torque in the unit box of slip and parameter, and the continuation there."""

    excess: Callable[[float, float], float]  #: Excess torque [N m] at slip and parameter.
    limits: tuple[float, float]  #: Smallest and largest parameter, in SI units.
    largest: float  #: Largest slip [-].

    def value(self, z: Array) -> float:
        """Return the excess torque [N m] at a point of the box."""
        low, high = self.limits
        return self.excess(float(z[0]) * self.largest, low + float(z[1]) * (high - low))

    def gradient(self, z: Array) -> Array:
        """Return the gradient of the excess torque [N m] by one-sided differences, towards the inside of the box."""
        here = self.value(z)
        slopes = []
        for axis in range(2):
            shifted = z.copy()
            shifted[axis] -= math.copysign(_DIFFERENCE, z[axis] - 0.5)
            slopes.append((self.value(shifted) - here) / (shifted[axis] - z[axis]))
        return np.array(slopes)

    def walk(self, z: Array, tangent: Array, slope: float) -> list[Array]:
        """Return the points of the branch beyond a point z, until the branch leaves the box."""
        points: list[Array] = []
        step = _FIRST_STEP
        for _ in range(_MAX_STEPS):
            reach = _to_edge(z, tangent)
            if reach <= _MIN_STEP:
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
                if chord @ tangent >= _MIN_COSINE:
                    tangent = 2.0 * (chord @ tangent) * chord - tangent  # as on a circle
                    points.append(corrected)
                    if ends:
                        return points
                    if np.hypot(*(corrected - predicted)) < 0.1 * step:
                        step = 1.5 * step
                    step = min(step, _MAX_STEP)
                    z = corrected
                    continue
            step *= 0.5
            if step < _MIN_STEP:
                break
        parameter = self.limits[0] + z[1] * (self.limits[1] - self.limits[0])
        raise ConvergenceError(
            f"the steady slip cannot be followed beyond a cage slip of {z[0] * self.largest:.4g} at {parameter:.6g}: "
            f"it turns within {step:.0e} of the range, where rollers change their motion at once"
        )

    def _across(
        self, z: Array, across: Array, slope: float, reach: float
    ) -> tuple[Array, float] | None:
        """Return the nearest root on a line within reach, by secants, and the slope there; None if they fail."""
        found = secant_root(
            lambda at: self.value(z + at * across),
            0.0,
            slope,
            tolerance=_TOLERANCE,
            within=(-min(reach, _to_edge(z, -across)), min(reach, _to_edge(z, across))),
        )
        return None if found is None else (z + found[0] * across, found[1])

    def fold(self, left: Array, right: Array, middle: Array) -> Array:
        """Return the point between two others at which the parameter has its extremum, by Brent's bounded method.

        It is a minimum where the parameter of the middle point is smaller than that of the left one.
        """
        from scipy.optimize import minimize_scalar

        sign = 1.0 if middle[1] < left[1] else -1.0
        best = middle
        slope = self.gradient(middle)[1]

        def parameter(slip: float) -> float:
            nonlocal best, slope
            balance = self._across(np.array([slip, best[1]]), np.array([0.0, 1.0]), slope, 1.0)
            if balance is None:
                raise ConvergenceError(
                    f"the fold of the steady slips between cage slips of {left[0] * self.largest:.4g} and "
                    f"{right[0] * self.largest:.4g} cannot be located, where rollers change their motion at once"
                )
            best, slope = balance
            return sign * float(best[1])

        low, high = sorted((float(left[0]), float(right[0])))
        extremum = minimize_scalar(
            parameter, bounds=(low, high), method="bounded", options={"xatol": 1e-3 * (high - low)}
        )
        parameter(float(extremum.x))
        return best


def _to_edge(z: Array, tangent: Array) -> float:
    """Return the distance along a direction to the edge of the unit box."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(
            np.where(
                tangent > 0.0, (1.0 - z) / tangent, np.where(tangent < 0.0, -z / tangent, np.inf)
            ).min()
        )


def describe_no_fold(
    name: str,
    limits: tuple[float, float],
    branches: list[Branch],
    table: str,
    max_cage_slip: float,
    *,
    free: bool = False,
) -> str:
    """Return why the smallest steady slip has no fold over a range of an operating condition.

    Parameters
    ----------
    name : str
        Name of the operating condition, a key of `VARIED`.
    limits : tuple of float
        Its smallest and largest value, in SI units.
    branches : list of Branch
        Steady slips over the condition, that of the smallest slip first.
    table : str
        Table of the scene with the settings of the study.
    max_cage_slip : float
        Largest cage slip of the branches [-].
    free : bool
        Whether nothing drags the cage.

    Examples
    --------
    >>> describe_no_fold("radial_load", (100.0, 200.0), [], "study.steady-slip", 0.9)
    'no limit of the radial load is known: no steady slip at 100 N and none at 200 N; none was sought between them'
    """
    unit, what = VARIED[name]
    low, high = (format_quantity(value, unit) for value in limits)
    if free:
        return f"no limit of the {what}: {SWITCHED_OFF}"
    unknown = f"no limit of the {what} is known"
    if not branches:
        return (
            f"{unknown}: no steady slip at {low} and none at {high}; none was sought between them"
        )
    slip = branches[0].slip
    value = branches[0].parameter
    if np.isclose(slip[[0, -1]], max_cage_slip).any():
        at = format_quantity(float(value[np.argmax(slip)]), unit, 4)
        further = search_range_hint(f"{table}.max_cage_slip", max_cage_slip, MAX_CAGE_SLIP)
        return f"{unknown}: at {at} the steady slip leaves the range, {max_cage_slip:g}{further}"
    if np.ptp(value) < (1.0 - _RANGE_TOLERANCE) * (limits[1] - limits[0]):
        ends = " and ".join(format_quantity(float(end), unit, 4) for end in np.sort(value[[0, -1]]))
        return f"{unknown}: the least steady slip has no fold between {ends}, and ends there"
    return f"no limit of the {what}: the least steady slip has no fold between {low} and {high}"
