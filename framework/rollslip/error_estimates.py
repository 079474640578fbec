"""Chooses the coarsest resolution whose estimated error keeps what a scene asks for.

- Nothing is taken from a list: a study's curves are computed at few slips, on a ladder of small numbers of slices and
  instants, and held against a finer one. What a study costs at the finest is a hundred times that and more.
- Contacts part from their ring somewhere along the roller and somewhere along the orbit. There a load rises like a
  power 10/9 of the distance, so all quadratures converge like n^-2.1 with a factor that depends on where the kinks lie
  between the points. The error is therefore bounded by C n^-2 with the largest C of the ladder. One comparison of two
  resolutions, or Richardson's rule on them, would often meet a small error by chance.
- A maximum is flat: the critical slip moves far more than friction does. Its error is that of the vertex of a parabola
  through three slips around it, estimated and bounded like that of friction.
- Errors of different parts add up at most. Together they get `_AIM` of the tolerance.
"""

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Final, Protocol

import attrs
import numpy as np

from rollslip.friction_curve import slip_grid
from rollslip.resolution import Resolution, finest

if TYPE_CHECKING:
    from rollslip.assembly import Array, Assembly

#: Share of the tolerance that slices and instants may take, and that laws evaluated more cheaply may.
_AIM: Final = 0.5
_LAW: Final = 0.1
#: Slices of the ladder and those they are held against, on some instants of a pitch.
_SLICES: Final = (8, 12, 16)
_FINE: Final = 96
_SOME: Final = 2
#: Instants of the ladder, each a part of the last, which they are held against; few slices tell of them.
_INSTANTS: Final = (1, 2, 3, 4, 6, 12)
_FEW: Final = 12
_QUADRATURES: Final = ("equal", "gauss")
#: Slips by which maxima are looked for, over the range and then around the best.
_GRID, _AROUND = 13, 7

#: Result -> relative error.
Errors = Mapping[str, float]


class Curved(Protocol):
    """A study that gives curves over a slip, each with a maximum perhaps."""

    @property
    def slip_range(self) -> float:
        """Slip up to which the curves go."""
        ...

    @property
    def averaged(self) -> bool:
        """Whether the curves are means over the instants of a pitch."""
        ...

    def curves(self, assembly: "Assembly", slip: "Array", instants: Sequence[int]) -> "Array":
        """Return the curves at some slips, on each of some numbers of instants, (k, curves, n)."""
        ...


class Probe:
    """The curves of a study at few slips: some over the range, three around each maximum."""

    def __init__(self, study: Curved, assembly: "Assembly") -> None:
        self.study = study
        grid = slip_grid(study.slip_range, _GRID)
        slips, self._peaks = [*grid[2::3]], list[tuple[int, int, float]]()
        for k, curve in enumerate(self._curves(assembly, grid)):
            best = int(np.argmax(curve))
            near = np.linspace(grid[max(best - 1, 0)], grid[min(best + 1, grid.size - 1)], _AROUND + 2)[1:]
            at = int(np.argmax(self._curves(assembly, near)[k]))
            if not curve[best] > 0.0 or at == near.size - 1:
                continue  # no friction, or it rises up to the end of the range
            at = max(at, 1)
            self._peaks.append((k, len(slips), float(near[1] - near[0])))
            slips += [*near[at - 1 : at + 2]]
        self._slip = np.array(slips)

    def _curves(self, assembly: "Assembly", slip: "Array") -> "Array":
        return np.asarray(self.study.curves(assembly, slip, (1,))[0])

    def measure(self, assembly: "Assembly", instants: Sequence[int]) -> list[tuple["Array", "Array"]]:
        """Return the curves, and the slips of their maxima, on each of some numbers of instants."""
        found = self.study.curves(assembly, self._slip, instants)
        return [(curves, np.array([self._vertex(curves, *peak) for peak in self._peaks])) for curves in found]

    def _vertex(self, curves: "Array", k: int, first: int, step: float) -> float:
        low, middle, high = curves[k, first : first + 3]
        curvature = low - 2.0 * middle + high
        return float(self._slip[first + 1] + 0.5 * step * (low - high) / curvature) if curvature < 0.0 else math.nan


def difference(coarse: tuple["Array", "Array"], fine: tuple["Array", "Array"]) -> Errors:
    """Return the relative errors of friction, of the largest of its curve, and of the critical slip."""
    scale = np.abs(fine[0]).max(axis=1, keepdims=True)
    friction = np.abs(coarse[0] - fine[0]) / np.where(scale > 0.0, scale, 1.0)
    found = {"friction": float(friction.max())}
    if fine[1].size:
        found["critical_slip"] = float(np.abs(coarse[1] / fine[1] - 1.0).max())
    return {name: error if error == error else math.inf for name, error in found.items()}


@attrs.frozen(kw_only=True)
class Bound:
    """What errors are bounded by: C n^-2 with a C for each result."""

    constants: Errors

    @classmethod
    def over(cls, numbers: Sequence[int], errors: Sequence[Errors], fine: int) -> "Bound":
        """Return the least bound on what some numbers of points differ by from finer ones, which err too."""
        names = dict.fromkeys(name for one in errors for name in one)
        pairs = [(n * n / (1.0 - (n / fine) ** 2), one) for n, one in zip(numbers, errors, strict=True)]
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


@attrs.frozen(kw_only=True)
class Choice:
    """A resolution and the errors that its parts are estimated to leave, result by result."""

    resolution: Resolution
    errors: Mapping[str, Errors]

    def total(self) -> Errors:
        """Return the sum of the errors of all parts, result by result."""
        names = dict.fromkeys(name for part in self.errors.values() for name in part)
        return {name: sum(part.get(name, 0.0) for part in self.errors.values()) for name in names}


def choose(study: Curved, assembly: "Assembly", share: float = 1.0) -> Choice:
    """Choose slices and instants for the curves of a study.

    Parameters
    ----------
    study : Curved
        The study.
    assembly : Assembly
        Its bearing, at any resolution.
    share : float
        Share of the scene's tolerance that is theirs.

    Raises
    ------
    RollslipError
        If the curves cannot be computed.
    """
    accuracy, best = assembly.scene.accuracy, finest(assembly.scene)
    allowed = {name: _AIM * share * accuracy.of(name) for name in ("friction", "critical_slip")}
    even, fixed = assembly.slices == 1, accuracy.slices is not None
    few = assembly.at(attrs.evolve(assembly.resolution, slices=_FEW, quadrature="equal"))
    probe = Probe(study, few)
    instants, over_instants = 1, Bound(constants={})
    if study.averaged:
        *ladder, fine = probe.measure(few, _INSTANTS)
        over_instants = Bound.over(_INSTANTS[:-1], [difference(one, fine) for one in ladder], _INSTANTS[-1])
        half = {name: 0.5 * error for name, error in allowed.items()}
        instants = _whole(over_instants.needed(half if not even else allowed), 1, best.instants)
    left = over_instants.at(instants)
    rest = {name: max(error - left.get(name, 0.0), 0.3 * error) for name, error in allowed.items()}
    slices, quadrature, over_slices = assembly.resolution.slices, "equal", Bound(constants={})
    if not even:
        (fine,) = probe.measure(few.at(attrs.evolve(few.resolution, slices=_FINE)), (_SOME,))
        bounds = {}
        for rule in _QUADRATURES[: 1 if fixed else None]:
            each = [few.at(attrs.evolve(few.resolution, slices=n, quadrature=rule)) for n in _SLICES]
            bounds[rule] = Bound.over(
                _SLICES, [difference(probe.measure(one, (_SOME,))[0], fine) for one in each], _FINE
            )
        quadrature = min(bounds, key=lambda rule: bounds[rule].needed(rest))
        over_slices = bounds[quadrature]
        slices = accuracy.slices or _whole(over_slices.needed(rest), _SLICES[0], best.slices)
    resolution = attrs.evolve(
        best if accuracy.exact else assembly.resolution, slices=slices, quadrature=quadrature, instants=instants
    )
    if accuracy.exact:
        resolution = best
    errors = {
        "slices": over_slices.at(resolution.slices),
        "instants": over_instants.at(resolution.instants or 1),
    }
    return Choice(resolution=resolution, errors={part: error for part, error in errors.items() if error})


def _whole(number: float, least: int, most: int | None) -> int:
    return int(min(max(math.ceil(min(number, 1e9)), least), most or least))
