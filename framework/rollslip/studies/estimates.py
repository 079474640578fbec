"""Chooses the coarsest resolution whose estimated error keeps what a scene asks for.

- Nothing is taken from a list: a study's curves are computed at few slips, on a ladder of small numbers of slices and
  instants, and held against a finer one. What a study costs at the finest is a hundred times that and more.
- Contacts part from their ring somewhere along the roller and somewhere along the orbit. There a load rises like a
  power 10/9 of the distance, so all quadratures converge like n^-2.1 with a factor that depends on where the kinks lie
  between the points. The error is therefore bounded by C n^-2 with the largest C of the ladder. One comparison of two
  resolutions, or Richardson's rule on them, would often meet a small error by chance.
- A maximum is flat: the critical slip moves far more than friction does. Its error is that of the vertex of a parabola
  through three slips around it, estimated and bounded like that of friction.
- Errors of different parts add up at most. Together they get `_AIM` of the tolerance, and each part that is
  left out `_LEFT`.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar, Final, Protocol, TypeAlias

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.critical import slip_grid
from rollslip.bearing.raceway import Array
from rollslip.bearing.resolution import LeftOut, Resolution, finest
from rollslip.errors import ConvergenceError
from rollslip.studies.answers import Errors, Estimated
from rollslip.studies.bounds import BoundaryFriction, ExactLaw, Extremes, InletHeating, LightContacts

if TYPE_CHECKING:
    import xarray as xr

#: Share of the tolerance that slices and instants may take, and that laws evaluated more cheaply may.
_AIM: Final = 0.5
_LAW: Final = 0.1
#: And each part of a model that is left out, by which every value may move, relative to itself: a slip goes with the
#: friction at that slip, and not with the largest one.
_LEFT: Final = 0.2
#: Slices of the ladder and those they are held against, on some instants of a pitch.
_SLICES: Final = (8, 12, 16)
_FINE: Final = 96
SOME: Final = 2
#: Instants of the ladder, each a part of the last, which they are held against; few slices tell of them.
_INSTANTS: Final = (1, 2, 3, 4, 6, 12)
#: Likewise, where each number is computed for itself.
_SINGLY: Final = (1, 2, 3, 6)
FEW: Final = 12
_QUADRATURES: Final = ("equal", "gauss")
#: Slips by which maxima are looked for, over the range and then around the best.
_GRID, _AROUND = 13, 7

#: How high a maximum must be to be taken for a rival of the largest.
_RIVAL: Final = 0.7
#: Shares of the range at which laws are held against each other, too: where an oil begins to shear by the stress and
#: not by the viscosity they are farthest apart, which is far below the slips that a maximum asks for; and on how many
#: instants, since neither rollers nor loads are alike.
_SMALL: Final = (1e-4, 3e-4, 1e-3, 3e-3, 1e-2)
_OF_LAWS: Final = 4
#: Differences around a maximum that are rounding, relative to it.
_LEVEL: Final = 1e-9
#: How far beyond what was met groups of the rheology may go before a closed form gives way.
_MARGIN: Final = 1.2


Difference: TypeAlias = Callable[[tuple[Array, Array], tuple[Array, Array]], Errors]


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

    @property
    def nested(self) -> bool:
        """Whether fewer instants are among more, and cost nothing beside them."""
        ...

    def curves(self, assembly: Assembly, slip: Array, instants: Sequence[int]) -> Array:
        """Return the curves at some slips, on each of some numbers of instants, (k, curves, n)."""
        ...

    def beyond(self, assembly: Assembly) -> None:
        """Evaluate a few contacts of what a run evaluates beside its curves."""
        ...


class Probe:
    """The curves of a study at few slips: some over the range, three around each maximum."""

    def __init__(self, study: Curved, assembly: Assembly) -> None:
        self.study = study
        grid = slip_grid(study.slip_range, _GRID)
        slips, self._peaks = [*grid[3::3]], list[tuple[int, int, float]]()
        for k, best in self._highest(self._curves(assembly, grid)):
            near = np.linspace(grid[max(best - 1, 0)], grid[min(best + 1, grid.size - 1)], _AROUND + 2)[1:]
            values = self._curves(assembly, near)[k]
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

    def _curves(self, assembly: Assembly, slip: Array) -> Array:
        return np.asarray(self.study.curves(assembly, slip, (1,))[0])

    def measure(
        self, assembly: Assembly, instants: Sequence[int], small: Sequence[float] = ()
    ) -> list[tuple[Array, Array]]:
        """Return the curves, at some small shares of the range too, and the slips of their maxima.

        Both on each of some numbers of instants.
        """
        slip = np.concatenate((self._slip, np.multiply(small, self.study.slip_range)))
        found = self.study.curves(assembly, slip, instants)
        return [(curves, np.array([self._vertex(curves, *peak) for peak in self._peaks])) for curves in found]

    def _vertex(self, curves: Array, k: int, first: int, step: float) -> float:
        """Slip of a maximum, NaN where there is none among the slips that it was looked for at."""
        low, middle, high = curves[k, first : first + 3]
        curvature = low - 2.0 * middle + high
        steps = 0.5 * (low - high) / curvature if curvature < 0.0 else math.inf
        return float(self._slip[first + 1] + step * steps) if abs(steps) <= 0.5 * (_AROUND + 1) else math.nan


def difference(coarse: tuple[Array, Array], fine: tuple[Array, Array]) -> Errors:
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


def _of_fine(coarse: tuple[Array, Array], fine: tuple[Array, Array]) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Return both without maxima that the fine one has not: those are of few slices and instants."""
    there = ~np.isnan(fine[1])
    return (coarse[0], coarse[1][there]), (fine[0], fine[1][there])


def _everywhere(coarse: tuple[Array, Array], fine: tuple[Array, Array]) -> Errors:
    """Return errors as `difference`, but that of friction relative to its value at each slip."""
    with np.errstate(divide="ignore", invalid="ignore"):
        off = np.abs(coarse[0] / fine[0] - 1.0)[coarse[0] != fine[0]]
    own = float(off.max(initial=0.0))
    return {**difference(coarse, fine), "friction": own if own == own else math.inf}


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


def by_curves(
    curved: Curved, assembly: Assembly, *, share: float = 1.0, tables: float = 0.0, cheaper_laws: bool = True
) -> Estimated:
    """Choose the resolution of a study by its curves, on a ladder of few slices and instants."""
    if assembly.scene.accuracy.exact:
        return exactly(curved, assembly)
    estimated, probe, few = _curves(curved, assembly, share)
    return with_tables(_laws(estimated, probe, few, cheaper_laws), assembly, tables)


def exactly(curved: Curved, assembly: Assembly) -> Estimated:
    """Return the finest of all, on as many instants as the curves are means over."""
    best = finest(assembly.scene)
    return Estimated(resolution=attrs.evolve(best, instants=best.instants if curved.averaged else 1))


def slices_and_instants(curved: Curved, assembly: Assembly, share: float) -> tuple[Estimated, Assembly]:
    """Choose slices and instants alone; return the bearing with few slices, too, that they were chosen with."""
    estimated, _, few = _curves(curved, assembly, share)
    return estimated, few


def with_tables(estimated: Estimated, assembly: Assembly, share: float) -> Estimated:
    """Return a choice with tables that take a share of the tolerances of friction and cage speed."""
    if not share:
        return estimated
    accuracy = assembly.scene.accuracy
    table = share * min(accuracy.of("friction"), accuracy.of("cage_speed"))
    return attrs.evolve(
        estimated,
        resolution=attrs.evolve(estimated.resolution, table_tolerance=table),
        errors={**estimated.errors, "tables": {"friction": table}},
    )


def _curves(study: Curved, assembly: Assembly, share: float) -> tuple[Estimated, Probe, Assembly]:
    """Slices and instants; also the probe, and the bearing with few slices that it was made for."""
    accuracy, best = assembly.scene.accuracy, finest(assembly.scene)
    allowed = {name: _AIM * share * accuracy.of(name) for name in ("friction", "critical_slip")}
    even, fixed = assembly.slices == 1, accuracy.slices is not None
    few = assembly.at(attrs.evolve(assembly.resolution, slices=FEW, quadrature="equal"))
    probe = Probe(study, few)
    instants, over_instants = 1, Bound(constants={})
    if study.averaged:
        numbers = _INSTANTS if study.nested else _SINGLY
        *ladder, fine = probe.measure(few, numbers)
        errors = [difference(*_of_fine(one, fine)) for one in ladder]
        over_instants = Bound.over(numbers[:-1], errors, numbers[-1])
        half = {name: 0.5 * error for name, error in allowed.items()}
        instants = _whole(over_instants.needed(half if not even else allowed), 1, best.instants)
    left = over_instants.at(instants)
    rest = {name: max(error - left.get(name, 0.0), 0.3 * error) for name, error in allowed.items()}
    slices, quadrature, over_slices = assembly.resolution.slices, "equal", Bound(constants={})
    if not even:
        (fine,) = probe.measure(few.at(attrs.evolve(few.resolution, slices=_FINE)), (SOME,))
        bounds = {}
        for rule in _QUADRATURES[: 1 if fixed else None]:
            each = [few.at(attrs.evolve(few.resolution, slices=n, quadrature=rule)) for n in _SLICES]
            errors = [difference(*_of_fine(probe.measure(one, (SOME,))[0], fine)) for one in each]
            bounds[rule] = Bound.over(_SLICES, errors, _FINE)
        quadrature = min(bounds, key=lambda rule: bounds[rule].needed(rest))
        over_slices = bounds[quadrature]
        slices = accuracy.slices or _whole(over_slices.needed(rest), _SLICES[0], best.slices)
    found = {"slices": over_slices.at(slices), "instants": over_instants.at(instants)}
    return (
        Estimated(
            resolution=attrs.evolve(assembly.resolution, slices=slices, quadrature=quadrature, instants=instants),
            errors={part: error for part, error in found.items() if error},
        ),
        probe,
        few,
    )


def _whole(number: float, least: int, most: int | None) -> int:
    return int(min(max(math.ceil(min(number, 1e9)), least), most or least))


def _laws(chosen: Estimated, probe: Probe, few: Assembly, cheaper_laws: bool) -> Estimated:
    """Leave out what is not needed, or moves too little, and take a closed form where its share allows it."""
    accuracy, law, left_out = few.scene.accuracy, few.traction.full_film, list[LeftOut]()
    resolution, errors = chosen.resolution, dict(chosen.errors)
    extremes, limit = Extremes(law), few.traction.full_film_from
    probe.measure(few.with_bounds(extremes), (1,))
    probe.study.beyond(few.with_bounds(extremes))
    if limit is not None and extremes.thinnest >= limit:
        resolution = attrs.evolve(resolution, boundary=False)
        left_out.append(BoundaryFriction(limit))
    reference = cache(lambda: probe.measure(few, (_OF_LAWS,), _SMALL)[0])

    def serves(cheaper: Resolution, share: float = _LAW, moved: Difference = difference) -> Errors | None:
        """Errors that less leaves, None where they are too large."""
        found = moved(probe.measure(few.at(cheaper), (_OF_LAWS,), _SMALL)[0], reference())
        return found if all(error <= share * accuracy.of(name) for name, error in found.items()) else None

    without: list[tuple[str, bool, LeftOut]] = [
        ("inlet_heating", bool(few.film.inlet_heating), InletHeating(_MARGIN * extremes.hottest)),
        ("light_contacts", few.pressure in few.inner.chain.models, LightContacts(extremes.lightest / _MARGIN)),
    ]
    for name, there, bound in without:
        out: dict[str, Any] = {name: False}
        if (
            cheaper_laws
            and there
            and (found := serves(attrs.evolve(few.resolution, **out), _LEFT, _everywhere)) is not None
        ):
            resolution, errors[name] = attrs.evolve(resolution, **out), found
            left_out.append(bound)
    closed = attrs.evolve(few.resolution, traction=law.closed_form or "named")
    if cheaper_laws and extremes.groups and (found := serves(closed)) is not None:
        resolution, errors["law"] = attrs.evolve(resolution, traction=closed.traction), found
        most = {name: _MARGIN * value for name, value in extremes.groups.items()}
        left_out.append(ExactLaw(law, most))
    return attrs.evolve(chosen, resolution=resolution, errors=errors, left_out=tuple(left_out), laws_tried=True)


# Without curves -------------------------------------------------------------------------------------------------------


class Judged(Protocol):
    """A study whose results can be held against each other."""

    judged: ClassVar[Mapping[str, str]]
    acts: ClassVar[frozenset[str]]

    def run(self, assembly: Assembly) -> "xr.Dataset":
        """Return the result."""
        ...


def by_doubling(study: Judged, assembly: Assembly) -> Estimated:
    """Choose the resolution of a study of which nothing else is known: doubled until what is judged stands still.

    Instants are doubled with few slices, slices with few instants. What the last doubling moved is taken for the error
    that is left, which bounds it where it falls at least with the inverse of their number.
    """
    accuracy, best = assembly.scene.accuracy, finest(assembly.scene)
    if accuracy.exact or not study.judged:
        return Estimated(resolution=best if study.judged else assembly.resolution)
    share = 0.5 * _AIM  # slices and instants add up
    errors = dict[str, Errors]()
    few = attrs.evolve(assembly.resolution, slices=accuracy.slices or _SLICES[0], quadrature="equal", instants=SOME)

    def with_many(part: str, number: int) -> "xr.Dataset":
        changes: dict[str, Any] = {part: number}
        return study.run(assembly.at(attrs.evolve(few, **changes)))

    def doubled(part: str, start: int, most: int) -> int:
        number, before = start, with_many(part, start)
        while number < most:
            number = min(2 * number, most)
            after = with_many(part, number)
            errors[part] = errors_between(study.judged, before, after)
            if all(error <= share * accuracy.of(result) for result, error in errors[part].items()):
                return number
            before = after
        moved = {result: error for result, error in errors[part].items() if not error <= share * accuracy.of(result)}
        told = {result: result.replace("_", " ") for result in moved}
        found = " and ".join(
            f"{told[result]} by {error:.1e}" if math.isfinite(error) else f"whether {told[result]} has a value"
            for result, error in moved.items()
        )
        raised = " and ".join(f"accuracy.{result}" for result in moved)
        raise ConvergenceError(f"the last doubling up to {most} {part} still changes {found}; raise {raised}")

    instants = doubled("instants", 1, best.instants or 1) if "instants" in study.acts else 1
    slices = few.slices
    if assembly.slices > 1 and "slices" in study.acts and accuracy.slices is None:
        slices = doubled("slices", _SLICES[0], best.slices)
    return Estimated(resolution=attrs.evolve(few, slices=slices, instants=instants), errors=errors)


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
        off = np.abs(coarse - true) / np.where(scale > 0.0, scale, 1.0)
        if not np.all(np.isnan(off)):
            errors[result] = float(np.nanmax(off))
    return errors
