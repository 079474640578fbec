"""The judge of what slices and instants leave of curves: a plan asks it before a run, and a witness after it.

- Curves at few slips are held against the same of more slices or instants, which err too.
- Contacts part from their ring somewhere along the roller and somewhere along the orbit. There a load rises like a
  power 10/9 of the distance, so all quadratures converge like n^-2.1 with a factor that depends on where the kinks lie
  between the points. The error is therefore bounded by C n^-2 with the largest C of the ladder. One comparison of two
  resolutions, or Richardson's rule on them, would often meet a small error by chance.
- A maximum is flat: the critical slip moves far more than friction does. Its error is that of the vertex of a parabola
  through three slips around it, estimated and bounded like that of friction.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Final, TypeAlias

import attrs
import numpy as np

from rollslip.bearing.critical import Array, slip_grid

if TYPE_CHECKING:
    import xarray as xr

#: Slips by which maxima are looked for, over the range and then around the best.
_GRID, _AROUND = 13, 7
#: How high a maximum must be to be taken for a rival of the largest.
_RIVAL: Final = 0.7
#: Differences around a maximum that are rounding, relative to it.
_LEVEL: Final = 1e-9

#: Order with which errors are relied on to fall where slices and instants are doubled at once: on the whole it is the
#: second, and by kinks less from some to twice as many.
AT_ONCE: Final = 1.5
#: The least of some points may fall with the order of a half: of twice as many it is off by so many times as much.
LEAST_OF_SOME: Final = (1.0 - 2.0**-AT_ONCE) / (1.0 - 2.0**-0.5)

#: How what is off ends that hangs on where rollers jump to another balance, which no run comes near at once.
WHERE_JUMPED: Final = ", where rollers jump,"

#: Key of [accuracy] -> relative error.
Errors: TypeAlias = Mapping[str, float]
#: What gives curves at some slips, on each of some numbers of instants of a pitch, (k, curves, n).
Curves: TypeAlias = Callable[[Array, Sequence[int]], Array]
#: Curves at the slips of a probe, and the slips of their maxima.
Seen: TypeAlias = tuple[Array, Array]


class Probe:
    """Few slips at which curves are seen: some over the range, three around each maximum of those it is made for."""

    def __init__(self, curves: Curves, slip_range: float) -> None:
        self.slip_range = slip_range
        grid = slip_grid(slip_range, _GRID)
        slips, self._peaks = [*grid[3::3]], list[tuple[int, int, float]]()
        for k, best in self._highest(curves(grid, (1,))[0]):
            near = np.linspace(grid[max(best - 1, 0)], grid[min(best + 1, grid.size - 1)], _AROUND + 2)[1:]
            values = curves(near, (1,))[0][k]
            at = max(int(np.argmax(values)), 1)
            if at == near.size - 1:
                continue  # it rises up to the end of the range
            if np.min(np.abs(np.diff(values[at - 1 : at + 2]))) <= _LEVEL * values[at]:
                continue  # level: no maximum to be found
            self._peaks.append((k, len(slips), float(near[1] - near[0])))
            slips += [*near[at - 1 : at + 2]]
        self._slip = np.array(slips)

    @staticmethod
    def _highest(curves: Array) -> Iterator[tuple[int, int]]:
        """Number of a curve and the place of a maximum, for all that may be the largest at a finer resolution."""
        for k, curve in enumerate(curves):
            padded = np.concatenate(([-np.inf], curve, [-np.inf]))
            peak = (curve >= padded[:-2]) & (curve > padded[2:]) & (curve >= _RIVAL * curve.max()) & (curve > 0.0)
            yield from ((k, int(at)) for at in np.flatnonzero(peak))

    def measure(self, curves: Curves, instants: Sequence[int], small: Sequence[float] = ()) -> list[Seen]:
        """Return what is seen on each of some numbers of instants, curves at some small shares of the range too."""
        found = curves(np.concatenate((self._slip, np.multiply(small, self.slip_range))), instants)
        return [(each, np.array([self._vertex(each, *peak) for peak in self._peaks])) for each in found]

    def _vertex(self, curves: Array, k: int, first: int, step: float) -> float:
        """Slip of a maximum, NaN where there is none among the slips that it was looked for at."""
        low, middle, high = curves[k, first : first + 3]
        curvature = low - 2.0 * middle + high
        steps = 0.5 * (low - high) / curvature if curvature < 0.0 else math.inf
        return float(self._slip[first + 1] + step * steps) if abs(steps) <= 0.5 * (_AROUND + 1) else math.nan


def difference(coarse: Seen, fine: Seen) -> Errors:
    """Return the relative errors of friction, of the largest of its curve, and of the critical slip.

    That is infinite where only one has it. A maximum that neither has is none: it is of what it was looked for with.
    """
    scale = np.abs(fine[0]).max(axis=1, keepdims=True)
    friction = np.abs(coarse[0] - fine[0]) / np.where(scale > 0.0, scale, 1.0)
    found = {"friction": float(friction.max())}
    any_has = ~(np.isnan(coarse[1]) & np.isnan(fine[1]))
    if any_has.any():
        found["critical_slip"] = float(np.abs(coarse[1] / fine[1] - 1.0)[any_has].max())
    return {name: error if error == error else math.inf for name, error in found.items()}


def apart(n: int, fine: int, order: float = 2.0) -> float:
    """Return what share of the error of n points they differ by from finer ones, which err too."""
    return 1.0 - math.pow(n / fine, order)


@attrs.frozen(kw_only=True)
class Bound:
    """What errors are bounded by: C n^-2 with a C for each result."""

    constants: Errors

    @classmethod
    def of(cls, numbers: Sequence[int], seen: Sequence[Seen]) -> "Bound":
        """Return the bound of a ladder, held against its last; maxima that this has not are of too few points."""
        *ladder, fine = ((curves, maxima[~np.isnan(seen[-1][1])]) for curves, maxima in seen)
        return cls.over(numbers[:-1], [difference(one, fine) for one in ladder], numbers[-1])

    @classmethod
    def over(cls, numbers: Sequence[int], errors: Sequence[Errors], fine: int) -> "Bound":
        """Return the least bound on what some numbers of points differ by from finer ones."""
        names = dict.fromkeys(name for one in errors for name in one)
        pairs = [(n * n / apart(n, fine), one) for n, one in zip(numbers, errors, strict=True)]
        return cls(constants={name: max(square * one.get(name, 0.0) for square, one in pairs) for name in names})

    def at(self, n: int) -> Errors:
        """Return the errors of a number of points."""
        return {name: constant / (n * n) for name, constant in self.constants.items()}

    def needed(self, allowed: Errors) -> float:
        """Return how many points errors need."""
        needed = [
            math.sqrt(constant / allowed[name]) if allowed[name] > 0.0 else math.inf if constant > 0.0 else 0.0
            for name, constant in self.constants.items()
        ]
        return max(needed, default=0.0)


def errors_between(judged: Mapping[str, str], dataset: "xr.Dataset", fine: "xr.Dataset") -> dict[str, float]:
    """Return the relative errors of a result against a finer one, infinite where only one has a value.

    A variable of several values is a curve, and relative to its largest one; critical slips are each relative to
    themselves.
    """
    errors = {}
    for result, name in judged.items():
        coarse, true = (np.atleast_1d(one[name].to_numpy()) for one in (dataset, fine))
        if coarse.shape != true.shape or np.any(np.isnan(coarse) != np.isnan(true)):
            errors[result] = math.inf
            continue
        scale = np.abs(true) if result == "critical_slip" else np.fmax.reduce(np.abs(true), axis=-1, keepdims=True)
        scale = np.maximum(scale, fine[name].attrs.get("floor", 0.0))
        off = np.abs(coarse - true) / np.where(scale > 0.0, scale, 1.0)
        if not np.all(np.isnan(off)):
            errors[result] = float(np.nanmax(off))
    return errors
