"""Estimates the discretisation error of a study: before a run to choose its resolution, and after it.

Both compare curves of a study on slices and roller positions of different numbers, at few slips: some over the range,
and three around each maximum.

- **Before a run** curves are computed on a ladder of small numbers. Contacts part from their ring somewhere along the
  roller and the orbit. There a load rises like the power 10/9 of the distance, so all quadratures converge like n^-2.1,
  with a factor that depends on where the kinks lie between the points. The error is therefore bounded by C n^-2 with
  the largest C of the ladder: one comparison of two numbers, or Richardson's rule on them, would often meet a small
  error by chance. The coarsest resolution is chosen whose errors, added up, keep the tolerance.
- **After a run** its result is compared with a reference solution on more slices and positions, which shares none of
  the grounds of that choice: an a posteriori error estimate. Where it exceeds the tolerance, `refined` says on how many
  slices and positions to run again.
- A maximum is flat: the critical slip changes far more than friction does. Its error is that of the vertex of a
  parabola through three slips around it.
"""

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Final, Self, TypeAlias

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.critical import Array, slip_grid
from rollslip.bearing.resolution import LeftOut, Resolution, reference_resolution
from rollslip.errors import ConvergenceError
from rollslip.results.curves import Curves
from rollslip.scene.values import Accuracy
from rollslip.studies.answers import Errors, PartialResult, ResolutionChoice, combined
from rollslip.studies.bounds import (
    BoundaryFriction,
    ExactLaw,
    Extremes,
    InletHeating,
    LightContacts,
)

if TYPE_CHECKING:
    import xarray as xr

#: Slips at which maxima are searched over the range.
_GRID: Final = 13
#: Slips at which a maximum is searched again between its neighbours on that grid.
_AROUND: Final = 7
#: How high a maximum must be, relative to the largest, to be a rival that finer slices may make the largest.
_RIVAL: Final = 0.7
#: Differences around a maximum that are rounding, relative to it.
_LEVEL: Final = 1e-9

#: Share of the tolerance that slices and roller positions may take before a run; the rest is for all else.
_AIM: Final = 0.5
#: Share of the tolerance that a closed form may take in place of the law that a scene names.
_LAW: Final = 0.1
#: Share of the tolerance by which every value may change where a part of a model is left out, relative to itself: a
#: slip goes with the friction at that slip, and not with the largest one.
_LEFT: Final = 0.2
#: Slices of the ladder; the others are compared with the last.
_SLICES: Final = (8, 12, 16, 96)
#: Roller positions on which the ladder of slices is computed.
SOME: Final = 2
#: Roller positions of the ladder, each a part of the last, with which they are compared.
_INSTANTS: Final = (1, 2, 3, 4, 6, 12)
#: Likewise, where each number is computed for itself.
_SINGLY: Final = (1, 2, 3, 6)
#: Slices on which roller positions and laws are compared: few of them show what these do.
COARSE_SLICES: Final = 12
#: Shares of the range of slips at which laws are compared, too: where an oil begins to shear by the stress and not by
#: the viscosity they differ most, which is far below the slips of a maximum.
_SMALL: Final = (1e-4, 3e-4, 1e-3, 3e-3, 1e-2)
#: Roller positions on which laws are compared, since neither rollers nor loads are alike.
_OF_LAWS: Final = 4
#: How far beyond what was met groups of the rheology may go before a closed form gives way.
_MARGIN: Final = 1.2

#: Order with which errors are relied on to fall where slices and positions are doubled at once: on the whole it is the
#: second, and by kinks less from some to twice as many.
AT_ONCE: Final = 1.5
#: The least of some points may fall with the order of a half: of twice as many it is off by so many times as much.
LEAST_OF_SOME: Final = (1.0 - 2.0**-AT_ONCE) / (1.0 - 2.0**-0.5)
#: How the name of an error ends that depends on where rollers jump to another balance; no finer run comes near at once.
WHERE_JUMPED: Final = ", where rollers jump,"
#: Order that every error is taken to have at least: an error that falls more slowly does not converge.
MIN_ORDER: Final = 0.5
#: Order that no error is taken to exceed: past the kinks of the loads it falls like n^-2.
MAX_ORDER: Final = 2.0
#: Order of the mean of a curve with jumps at the worst, whatever two numbers of positions show by chance.
_OF_JUMPS: Final = 1.0
#: Share of the tolerance below which an error needs no order to be believed.
_CLEAR: Final = 0.3
#: How many times as many slices the reference solution has.
_FINER_SLICES: Final = 4
#: Slices that a reference solution of more slices and positions has at least, as few may err alike.
_SOME_SLICES: Final = 40
#: Roller positions that it has at least where slices are fewer than these.
_SOME_POSITIONS: Final = 9
#: Share of the tolerance above which that reference may agree by chance, so that another one is computed.
_BEYOND_CHANCE: Final = 0.15
#: How many times as many slips the reference solution goes along where a curve is followed from slip to slip.
DENSER: Final = 3
#: Slips of the reference solution of curves of which the result holds none.
_SAMPLED_SLIPS: Final = 25
#: Name of the part of an error that models leave which few slips did not show to be needed.
LEFT_OUT: Final = "left out"
#: Parts of a contact that may be left out, as fields of a resolution.
_PARTS_OF_CONTACT: Final = ("inlet_heating", "light_contacts")
#: Share of the tolerance that slices and roller positions aim at, each, where a run is made again.
_AIM_AGAIN: Final = 0.35
#: How many times as many slices or roller positions a run that is made again has at most.
_MAX_FACTOR: Final = 4.0
#: Slices of all rollers over an orbit with which a run is made again at most, some seconds of effective friction and up
#: to a minute of steady slips with their check; beyond, its error is only reported. A limit of time would let the
#: result depend on the machine.
_MAX_SLICES: Final = 500_000

#: Curves at the slips of a probe, (curves, n), and the slips of their maxima, (peaks,).
Sample: TypeAlias = tuple[Array, Array]


@attrs.frozen(kw_only=True)
class DiscretisedStudy:
    """What of a study says how finely it is to be run, and how far it is off: curves over a slip, and single values."""

    #: What a command and a scene call it.
    name: ClassVar[str]
    #: Key of [accuracy] (friction, critical_slip, cage_speed) -> variable of the result that is held against it.
    controlled_outputs: ClassVar[Mapping[str, str]] = MappingProxyType({})
    #: Its friction curves, if it gives some.
    curves_of: ClassVar[Curves | None] = None

    @property
    def slip_range(self) -> float:
        """Slip up to which its curves go; for studies with `curves`."""
        raise NotImplementedError(
            f"study {self.name!r} gives curves, but does not say up to which slip"
        )

    @property
    def is_averaged(self) -> bool:
        """Whether its curves are means over the instants of a pitch."""
        return False

    @property
    def has_nested_positions(self) -> bool:
        """Whether fewer instants are among more, and cost nothing beside them."""
        return True

    @property
    def uses_continuation(self) -> bool:
        """Whether a curve is followed from slip to slip, so that it may depend on the slips on the way."""
        return False

    def curves(self, assembly: Assembly, slip: Array, n_positions: Sequence[int]) -> Array:
        """Return its curves at some slips, on each of some numbers of instants, (k, curves, n).

        By curves the fewest slices and instants are found with the least work; a study may have none.
        """
        raise NotImplementedError(f"study {self.name!r} has no curves")

    def sample_other_contacts(self, assembly: Assembly) -> None:
        """Evaluate a few contacts of what a run evaluates beside its curves."""

    def curve_study(self, assembly: Assembly) -> "DiscretisedStudy | None":
        """Return what gives the curves by which slices and instants are chosen and judged; None if nothing does."""
        return None if type(self).curves is DiscretisedStudy.curves else self

    def with_settings(self, **settings: Any) -> Self:
        """Return the study with other settings."""
        return attrs.evolve(self, **settings)

    @classmethod
    def run_batch(
        cls, cases: "Sequence[tuple[Self, Assembly]]", outputs: frozenset[str]
    ) -> list[PartialResult] | None:
        """Return some outputs of several points in one go; None if there is no such way to these."""
        return None

    def value_errors(self, finer: Assembly, dataset: "xr.Dataset") -> Mapping[str, float]:
        """Return by how much single values of a result are off, by a bearing with more slices and instants at once.

        Relative, by the names under which people are told.
        """
        return {}

    def has_error_estimate(self, assembly: Assembly) -> bool:
        """Whether it is estimated after a run how far a result is off: curves, or single values."""
        has_values = (
            type(self).value_errors is not DiscretisedStudy.value_errors
            and not assembly.scene.accuracy.exact
        )
        return assembly.resolution.n_positions is not None and (
            has_values or self.curve_study(assembly) is not None
        )

    def may_run_again(self, assembly: Assembly) -> bool:
        """Whether a result whose error exceeds its tolerance is run again, finer: one that has the curves itself."""
        return not assembly.scene.accuracy.exact and self.curve_study(assembly) in (None, self)


def exceeding(errors: Errors, accuracy: Accuracy, fraction: float = 1.0) -> Errors:
    """Return those of some errors that exceed a fraction of their tolerances."""
    return {
        name: error for name, error in errors.items() if not error <= fraction * accuracy.of(name)
    }


# Curves at few slips -------------------------------------------------------------------------------------------------


class Probe:
    """Few slips at which curves of a study are sampled: some over the range, and three around each maximum."""

    def __init__(self, study: DiscretisedStudy, assembly: Assembly) -> None:
        self._study = study
        grid = slip_grid(study.slip_range, _GRID)
        slips = [*grid[3::3]]
        peaks = list[tuple[float, ...]]()
        for k, curve in enumerate(study.curves(assembly, grid, (1,))[0]):
            padded = np.concatenate(([-np.inf], curve, [-np.inf]))
            is_peak = (
                (curve >= padded[:-2])
                & (curve > padded[2:])
                & (curve >= _RIVAL * curve.max())
                & (curve > 0.0)
            )
            for best in np.flatnonzero(is_peak).tolist():
                near = np.linspace(
                    grid[max(best - 1, 0)], grid[min(best + 1, grid.size - 1)], _AROUND + 2
                )[1:]
                values = study.curves(assembly, near, (1,))[0][k]
                top = max(int(np.argmax(values)), 1)
                if top == near.size - 1:
                    continue  # it rises up to the end of the range
                if (
                    not np.min(np.abs(np.diff(values[top - 1 : top + 2]))) <= _LEVEL * values[top]
                ):  # else level
                    peaks.append((k, len(slips), near[1] - near[0]))
                    slips += [*near[top - 1 : top + 2]]
        self._slip = np.array(slips)
        self._peaks = np.array(peaks).reshape(-1, 3).T

    def sample(
        self, assembly: Assembly, *n_positions: int, small: Sequence[float] = ()
    ) -> list[Sample]:
        """Return curves and maxima on each of some numbers of positions, at small shares of the range of slips too."""
        slips = np.concatenate((self._slip, np.multiply(small, self._study.slip_range)))
        return [
            (curves, self._maxima(curves))
            for curves in self._study.curves(assembly, slips, n_positions)
        ]

    def _maxima(self, curves: Array) -> Array:
        """Return the slips of the maxima, NaN where there is none among the slips around it."""
        step = self._peaks[2]
        curve, first = self._peaks[:2].astype(int)
        low, middle, high = curves[curve, first + np.arange(3)[:, None]]
        curvature = low - 2.0 * middle + high
        with np.errstate(all="ignore"):
            steps = np.where(curvature < 0.0, 0.5 * (low - high) / curvature, np.inf)
            vertex = self._slip[first + 1] + step * steps
        return np.where(np.abs(steps) <= 0.5 * (_AROUND + 1), vertex, np.nan)


def _largest(error: Array) -> float:
    return float(np.nan_to_num(error, nan=np.inf, posinf=np.inf).max(initial=0.0))


def difference(coarse: Sample, fine: Sample) -> Errors:
    """Return the relative errors of friction, of the largest of its curve, and of the critical slip.

    That is infinite where only one has it. A maximum that neither has is none: it is of what it was looked for with.
    """
    scale = np.abs(fine[0]).max(axis=1, keepdims=True)
    found = {"friction": _largest(np.abs(coarse[0] - fine[0]) / np.where(scale > 0.0, scale, 1.0))}
    any_has = ~(np.isnan(coarse[1]) & np.isnan(fine[1]))
    if any_has.any():
        found["critical_slip"] = _largest(np.abs(coarse[1] / fine[1] - 1.0)[any_has])
    return found


def _everywhere(coarse: Sample, fine: Sample) -> Errors:
    """Return errors as `difference`, but that of friction relative to its value at each slip."""
    with np.errstate(divide="ignore", invalid="ignore"):
        change = np.abs(coarse[0] / fine[0] - 1.0)[coarse[0] != fine[0]]
    return {**difference(coarse, fine), "friction": _largest(change)}


def errors_between(
    controlled_outputs: Mapping[str, str], dataset: "xr.Dataset", fine: "xr.Dataset"
) -> dict[str, float]:
    """Return the relative errors of a result against a finer one, infinite where only one has a value.

    A variable of several values is a curve, and relative to its largest one; critical slips are each relative to
    themselves.
    """
    errors = {}
    for result, name in controlled_outputs.items():
        coarse, true = (np.atleast_1d(one[name].to_numpy()) for one in (dataset, fine))
        if coarse.shape != true.shape or np.any(np.isnan(coarse) != np.isnan(true)):
            errors[result] = math.inf
        elif not np.all(np.isnan(true)):
            scale = (
                np.abs(true)
                if result == "critical_slip"
                else np.fmax.reduce(np.abs(true), axis=-1, keepdims=True)
            )
            scale = np.maximum(scale, fine[name].attrs.get("floor", 0.0))
            errors[result] = float(
                np.nanmax(np.abs(coarse - true) / np.where(scale > 0.0, scale, 1.0))
            )
    return errors


def error_fraction(n: float, fine: float, order: float = MAX_ORDER) -> float:
    """Return the fraction of the error of n points by which they differ from finer ones, which err too.

    The order is taken to be at least a half and two at most.
    """
    return 1.0 - math.pow(n / fine, min(max(order, MIN_ORDER), MAX_ORDER))


def _order(few: int, many: int, before: float, after: float) -> float:
    """Order with which an error falls from few to many; 1 where nothing can be told of it."""
    if few == many or not (0.0 < before < math.inf and 0.0 < after < math.inf):
        return 1.0
    return math.log(before / after) / math.log(many / few)


def _min_order(study: DiscretisedStudy) -> float:
    return _OF_JUMPS if study.uses_continuation else MIN_ORDER


# Before a run: the coarsest resolution whose estimated error keeps the tolerance --------------------------------------


@attrs.frozen(kw_only=True)
class Bound:
    """What errors are bounded by: C n^-2 with a C for each result."""

    constants: Errors

    @classmethod
    def of(cls, numbers: Sequence[int], samples: Sequence[Sample]) -> "Bound":
        """Return the bound of a ladder, compared with its last; maxima that this has not are of too few points."""
        known = ~np.isnan(samples[-1][1])
        *ladder, fine = ((curves, maxima[known]) for curves, maxima in samples)
        return cls.over(numbers[:-1], [difference(one, fine) for one in ladder], numbers[-1])

    @classmethod
    def over(cls, numbers: Sequence[int], errors: Sequence[Errors], fine: int) -> "Bound":
        """Return the least bound on what some numbers of points differ by from finer ones."""
        pairs = zip(numbers, errors, strict=True)
        scaled = [
            {name: n * n / error_fraction(n, fine) * error for name, error in one.items()}
            for n, one in pairs
        ]
        return cls(constants=combined(scaled, max))

    def at(self, n: int) -> Errors:
        """Return the errors of a number of points."""
        return {name: constant / (n * n) for name, constant in self.constants.items()}

    def needed(self, allowed: Errors) -> float:
        """Return how many points errors need."""
        return max(
            (math.sqrt(constant / allowed[name]) for name, constant in self.constants.items()),
            default=0.0,
        )


def coarse_slices(assembly: Assembly) -> Assembly:
    """Return a bearing with few slices, by which it is seen what positions do and where maxima are."""
    return assembly.at(attrs.evolve(assembly.resolution, slices=COARSE_SLICES, quadrature="equal"))


def by_curves(
    study: DiscretisedStudy, assembly: Assembly, *, fraction: float = 1.0, cheaper_laws: bool = True
) -> ResolutionChoice:
    """Choose the resolution of a study by its curves, on a ladder of few slices and roller positions."""
    if assembly.scene.accuracy.exact:
        return reference_choice(study, assembly)
    estimated, probe, few = slices_and_positions(study, assembly, fraction)
    return _laws(estimated, study, probe, few, cheaper_laws)


def reference_choice(study: DiscretisedStudy, assembly: Assembly) -> ResolutionChoice:
    """Return the finest of all, on as many positions as the curves are means over."""
    best = reference_resolution(assembly.scene)
    return ResolutionChoice(
        resolution=best if study.is_averaged else attrs.evolve(best, n_positions=1)
    )


def with_tables(
    estimated: ResolutionChoice, assembly: Assembly, fraction: float
) -> ResolutionChoice:
    """Return a choice with tables that take a share of the tolerances of friction and cage speed."""
    if not fraction:
        return estimated
    accuracy = assembly.scene.accuracy
    table = fraction * min(accuracy.of("friction"), accuracy.of("cage_speed"))
    return attrs.evolve(
        estimated,
        resolution=attrs.evolve(estimated.resolution, table_tolerance=table),
        errors={**estimated.errors, "tables": {"friction": table}},
    )


def slices_and_positions(
    study: DiscretisedStudy, assembly: Assembly, fraction: float
) -> tuple[ResolutionChoice, Probe, Assembly]:
    """Choose slices and positions alone; return probe and bearing with few slices, by which that was done, too."""
    accuracy = assembly.scene.accuracy
    best = reference_resolution(assembly.scene)
    parts = 1 + (assembly.slices > 1)
    allowed = {name: _AIM * fraction * accuracy.of(name) for name in ("friction", "critical_slip")}
    few = coarse_slices(assembly)
    probe = Probe(study, few)
    n_positions = 1
    left: Errors = {}
    if study.is_averaged:
        numbers = _INSTANTS if study.has_nested_positions else _SINGLY
        bound = Bound.of(numbers, probe.sample(few, *numbers))
        each = {name: error / parts for name, error in allowed.items()}
        n_positions = _whole(bound.needed(each), 1, best.n_positions)
        left = bound.at(n_positions)
    resolution = attrs.evolve(assembly.resolution, quadrature="equal", n_positions=n_positions)
    errors = {"n_positions": left} if left else {}
    if assembly.slices > 1:

        def sampled(n: int, rule: str = "equal") -> Sample:
            return probe.sample(
                few.at(attrs.evolve(few.resolution, slices=n, quadrature=rule)), SOME
            )[0]

        rest = {
            name: max(error - left.get(name, 0.0), 0.3 * error) for name, error in allowed.items()
        }
        fine = sampled(_SLICES[-1])
        rules = ["equal", "gauss"] if accuracy.slices is None else ["equal"]
        bounds = {
            rule: Bound.of(_SLICES, [*(sampled(n, rule) for n in _SLICES[:-1]), fine])
            for rule in rules
        }
        needed = {rule: bound.needed(rest) for rule, bound in bounds.items()}
        rule = min(needed, key=needed.__getitem__)
        slices = accuracy.slices or _whole(needed[rule], _SLICES[0], best.slices)
        resolution = attrs.evolve(resolution, slices=slices, quadrature=rule)
        errors = {"slices": bounds[rule].at(slices), **errors}
    return ResolutionChoice(resolution=resolution, errors=errors), probe, few


def _whole(number: float, low: int, high: int | None) -> int:
    return int(min(max(math.ceil(min(number, 1e9)), low), high or low))


def _laws(
    chosen: ResolutionChoice,
    study: DiscretisedStudy,
    probe: Probe,
    few: Assembly,
    cheaper_laws: bool,
) -> ResolutionChoice:
    """Leave out what is not needed, or changes too little, and take a closed form where its share allows it."""
    law = few.traction.full_film
    limit = few.traction.full_film_from
    resolution = chosen.resolution
    errors = dict(chosen.errors)
    left_out = list[LeftOut]()
    extremes = Extremes(law)
    probe.sample(few.with_bounds(extremes), 1)
    study.sample_other_contacts(few.with_bounds(extremes))
    if limit is not None and extremes.thinnest >= limit:
        resolution = attrs.evolve(resolution, boundary=False)
        left_out.append(BoundaryFriction(limit))
    most = {name: _MARGIN * value for name, value in extremes.groups.items()}
    is_light = few.pressure in few.inner.chain.models
    choices: list[tuple[str, bool, dict[str, Any], LeftOut, float, Callable[[Sample, Sample], Errors]]] = [
        ("inlet_heating", bool(few.film.inlet_heating), {"inlet_heating": False},
         InletHeating(_MARGIN * extremes.hottest), _LEFT, _everywhere),
        ("light_contacts", is_light, {"light_contacts": False},
         LightContacts(extremes.lightest / _MARGIN), _LEFT, _everywhere),
        ("law", bool(extremes.groups), {"traction": law.closed_form}, ExactLaw(law, most), _LAW, difference),
    ]  # fmt: skip
    reference = list[Sample]()
    for name, applies, changes, bound, fraction, change in choices:
        if not (cheaper_laws and applies):
            continue
        reference = reference or probe.sample(few, _OF_LAWS, small=_SMALL)
        cheaper = few.at(attrs.evolve(few.resolution, **changes))
        error = change(probe.sample(cheaper, _OF_LAWS, small=_SMALL)[0], reference[0])
        if not exceeding(error, few.scene.accuracy, fraction):
            resolution = attrs.evolve(resolution, **changes)
            errors[name] = error
            left_out.append(bound)
    return attrs.evolve(
        chosen, resolution=resolution, errors=errors, left_out=tuple(left_out), laws_tried=True
    )


def by_doubling(
    run: Callable[[Assembly], "xr.Dataset"],
    controlled_outputs: Mapping[str, str],
    affected_by: Collection[str],
    assembly: Assembly,
) -> ResolutionChoice:
    """Choose the resolution of a study without curves: doubled until what is judged stands still.

    Positions are doubled with few slices, slices with few positions. What the last doubling changed is taken for the
    error that is left, which bounds it where it falls at least with the inverse of their number.
    """
    accuracy = assembly.scene.accuracy
    best = reference_resolution(assembly.scene)
    if accuracy.exact or not controlled_outputs:
        return ResolutionChoice(resolution=best if controlled_outputs else assembly.resolution)
    few = attrs.evolve(
        assembly.resolution,
        slices=accuracy.slices or _SLICES[0],
        quadrature="equal",
        n_positions=SOME,
    )

    def solved(**number: Any) -> "xr.Dataset":
        return run(assembly.at(attrs.evolve(few, **number)))

    starts = {"n_positions": 1}
    if assembly.slices > 1 and accuracy.slices is None:
        starts["slices"] = _SLICES[0]
    numbers: dict[str, Any] = {"n_positions": 1}
    errors = dict[str, Errors]()
    for part, number in starts.items():
        if part not in affected_by:
            continue
        most = getattr(best, part)
        fine = solved(**{part: number})
        while number < most:
            number = min(2 * number, most)
            coarse = fine
            fine = solved(**{part: number})
            errors[part] = errors_between(controlled_outputs, coarse, fine)
            off = exceeding(errors[part], accuracy, 0.5 * _AIM)  # slices and positions add up
            if not off:
                break
        else:
            raise ConvergenceError(_unsettled(part, most, off))
        numbers[part] = number
    return ResolutionChoice(resolution=attrs.evolve(few, **numbers), errors=errors)


def _unsettled(part: str, most: int, off: Errors) -> str:
    changes = " and ".join(
        f"{name.replace('_', ' ')} by {error:.1e}"
        if math.isfinite(error)
        else f"whether {name.replace('_', ' ')} has a value"
        for name, error in off.items()
    )
    raised = " and ".join(f"accuracy.{name}" for name in off)
    return f"the last doubling up to {most} {part} still changes {changes}; raise {raised}"


# After a run: a posteriori error estimate -----------------------------------------------------------------------------


@attrs.frozen(kw_only=True)
class ErrorEstimate:
    """What slices and roller positions leave in the result of a run."""

    #: Part -> key of [accuracy] -> relative error.
    errors: Mapping[str, Errors]
    #: Key of [accuracy] -> order with which the error falls with the positions; only where it is needed.
    orders: Mapping[str, float] = attrs.field(factory=dict)
    #: What more slices and positions at once change: curves and maxima by key of [accuracy], single values by name.
    at_once: Errors = attrs.field(factory=dict)
    #: What more of each part alone changes, where both at once change more than the tolerance.
    alone: Mapping[str, Errors] = attrs.field(factory=dict)
    #: Slices of the run.
    slices: int = 0
    #: Why there is no estimate, in words; empty where there is one.
    refusal: str = ""

    @property
    def total(self) -> Errors:
        """Sum over the parts, or what both change at once where that is more."""
        return combined((combined(self.errors.values(), sum), self.at_once), max)


@attrs.frozen(eq=False, kw_only=True)
class _Run:
    """A run, compared with reference solutions on more slices and roller positions."""

    study: DiscretisedStudy
    #: Study that gives the curves, that of the run where none does.
    curve_study: DiscretisedStudy
    #: The bearing of the run, and the same with few slices.
    assembly: Assembly
    few: Assembly
    dataset: "xr.Dataset"
    accuracy: Accuracy
    #: Which parts of a contact take part once all that was left out is taken back in.
    complete: Mapping[str, Any]

    @cached_property
    def probe(self) -> Probe:
        """Few slips at which curves are compared."""
        return Probe(self.curve_study, self.few)

    def solution(self, at: Assembly, n_positions: int, *, dense: bool = False) -> Any:
        """Return curves on some positions: a dataset over all slips if the study has a short way to it, else a sample.

        Dense ones go along more slips than they give.
        """
        import xarray as xr

        study = self.curve_study
        times = 1
        if study is not self.study:
            study = study.with_settings(points=_SAMPLED_SLIPS)
        if dense and (points := getattr(study, "points", 0)):
            study = study.with_settings(points=DENSER * (points - 1) + 1)
            times = DENSER
        case = study, at.at(attrs.evolve(at.resolution, n_positions=n_positions))
        found = type(study).run_batch([case], frozenset(study.controlled_outputs.values()))
        if found is None or study.curves_of is None:
            return self.probe.sample(at, n_positions)[0]
        return xr.Dataset(*found[0]).isel({study.curves_of.slip: slice(None, None, times)})

    def change(self, coarse: Any, fine: Any) -> Errors:
        """Return the relative errors of curves against finer ones: of samples, or over all slips."""
        if isinstance(fine, tuple):
            return difference(coarse, fine)
        return errors_between(self.curve_study.controlled_outputs, coarse, fine)

    def of_slices(self, n_positions: int) -> Errors:
        """Return the errors of slices on some positions, by four times as many after Gauss's rule.

        Where a contact ends between slices their error falls with the square only on the whole, and twice as many may
        err alike. Few slips show it, and where it is not clearly below its tolerance those of the result.
        """
        resolution = self.assembly.resolution
        many = attrs.evolve(
            resolution, slices=_FINER_SLICES * resolution.slices, quadrature="gauss"
        )
        pair = self.assembly, self.assembly.at(many)
        changes = self.change(*(self.probe.sample(at, n_positions)[0] for at in pair))
        if exceeding(changes, self.accuracy, _CLEAR):
            changes = self.change(*(self.solution(at, n_positions) for at in pair))
        return {
            name: change / error_fraction(1, _FINER_SLICES, AT_ONCE)
            for name, change in changes.items()
        }

    def of_positions(self, at: Assembly, orders: dict[str, float]) -> Errors:
        """Return the errors of the positions by 2 m + 1 others, and put the orders with which they fall in a mapping.

        Of these only the one with a roller in the line of load is among the m of the run. Curves are compared over all
        slips of the result, with the maxima that the study finds there: what was chosen by few slips may be worse
        between them, and where rollers have several balances each goes its own way over the slips. A curve that is
        followed from slip to slip is followed over three times as many, since its way may depend on the steps. An error
        that is not clearly below its tolerance is compared with half as many positions, too, for the order with which
        it falls: that says how much the reference itself leaves.
        """
        m = self.assembly.resolution.n_positions or 1
        half = (m + 1) // 2
        least = _min_order(self.curve_study)
        reference = self.solution(at, 2 * m + 1, dense=self.curve_study.uses_continuation)
        is_known = (
            at is self.assembly
            and self.curve_study is self.study
            and not isinstance(reference, tuple)
        )
        changes = self.change(self.dataset if is_known else self.solution(at, m), reference)
        if self.curve_study.uses_continuation:
            changes = combined((changes, self.change(self.solution(at, m + 1), reference)), max)
        errors = {
            name: change / error_fraction(m, 2 * m + 1, least) for name, change in changes.items()
        }
        if not exceeding(errors, self.accuracy, _CLEAR):
            return errors
        before = self.change(self.solution(at, half), reference)
        orders |= {
            name: _order(half, m, before.get(name, 0.0), change) for name, change in changes.items()
        }
        return {
            name: change / error_fraction(m, 2 * m + 1, max(orders[name], least))
            for name, change in changes.items()
        }

    def of_parts(self) -> ErrorEstimate:
        """Return the errors of slices and of positions, with few slices, on few positions.

        If they exceed the tolerance, they are estimated again with those of the run.
        """
        errors = dict[str, Errors]()
        orders = dict[str, float]()
        found = ErrorEstimate(errors=errors, orders=orders, slices=self.assembly.slices)
        m = self.assembly.resolution.n_positions or 1
        if self.assembly.slices > 1:
            errors["slices"] = self.of_slices(SOME)
        if self.curve_study.is_averaged:
            errors["n_positions"] = self.of_positions(self.few, orders)
        if self.accuracy.exact:
            return found
        is_off = exceeding(errors.get("n_positions", {}), self.accuracy, _CLEAR) and exceeding(
            found.total, self.accuracy
        )
        if is_off and self.few is not self.assembly:
            errors["n_positions"] = self.of_positions(self.assembly, orders)
        if "slices" in errors and m > SOME and exceeding(found.total, self.accuracy):
            errors["slices"] = self.of_slices(min(m, COARSE_SLICES))
        return found

    def with_both(self, found: ErrorEstimate) -> ErrorEstimate:
        """Return an estimate with what twice as many slices and positions at once change, and more of each alone.

        These are points of Gauss's rule, pi/2 times as many: light loads reach only the middle of a roller, where they
        lie as much farther apart than equal slices. Where they agree others follow, by the rule of the run and on other
        positions, for single values. Those of each part are looked at where both change more than the tolerance.
        """
        resolution = self.assembly.resolution
        orders = {name: min(max(order, MIN_ORDER), AT_ONCE) for name, order in found.orders.items()}
        # curves that are followed from slip to slip hang on more than few slips
        compares = (
            bool(found.errors.get("slices"))
            and "n_positions" in found.errors
            and not self.curve_study.uses_continuation
        )

        def errors_by(finer: Resolution, *, of_curves: bool = compares) -> Errors:
            at = self.assembly.at(finer)
            changes = dict(self.study.value_errors(at, self.dataset))
            if of_curves:
                samples = (
                    self.probe.sample(one, one.resolution.n_positions or 1)[0]
                    for one in (self.assembly, at)
                )
                changes = {**self.change(*samples), **changes}
            return {
                name: change / error_fraction(1, 2, orders.get(name, AT_ONCE))
                for name, change in changes.items()
            }

        more = 2 * (resolution.n_positions or 1) + 1
        if resolution.slices < _SOME_SLICES:
            more = max(more, _SOME_POSITIONS)
        dense = math.ceil(
            (2.0 if resolution.quadrature == "gauss" else math.pi) * resolution.slices
        )
        twice = attrs.evolve(resolution, slices=max(dense, _SOME_SLICES), quadrature="gauss")
        at_once = errors_by(attrs.evolve(twice, n_positions=more, **self.complete))
        # they may err as the run does by chance, and others hardly do as well
        if exceeding(at_once, self.accuracy, _BEYOND_CHANCE) and not exceeding(
            at_once, self.accuracy
        ):
            others = attrs.evolve(
                resolution, slices=2 * resolution.slices + 1, n_positions=more + 1, **self.complete
            )
            at_once = combined((at_once, errors_by(others, of_curves=False)), max)
        alone = dict[str, Errors]()
        if exceeding(_without_jumps(at_once), self.accuracy):
            finer = {"slices": twice, "n_positions": attrs.evolve(resolution, n_positions=more)}
            finer[LEFT_OUT] = attrs.evolve(resolution, **self.complete)
            parts = [part for part in (*found.errors, LEFT_OUT) if finer[part] != resolution]
            alone = {part: errors_by(finer[part]) for part in parts}
        return attrs.evolve(found, at_once=at_once, alone=alone)


def estimate_error(
    study: DiscretisedStudy,
    assembly: Assembly,
    estimated: ResolutionChoice,
    dataset: "xr.Dataset",
    first: ErrorEstimate | None = None,
) -> ErrorEstimate:
    """Return the a posteriori error estimate of a result, by reference solutions; `first` is that of its first run.

    The resolution of the result was chosen by the `estimated` error.

    Slices and positions may err against each other, so at few slips, or for single values of the result, twice as many
    of both are taken at once, with the models of a contact that were left out at few slips. Of a study without curves
    the single values alone are compared, if it has any.
    """
    if not study.has_error_estimate(assembly):
        return ErrorEstimate(errors={})
    accuracy = assembly.scene.accuracy
    curve_study = study.curve_study(assembly)
    few = coarse_slices(assembly)
    if few.slices >= assembly.slices or (curve_study and curve_study.uses_continuation):
        few = assembly  # of two maxima of nearly the same height few slices may have another one for the largest
    whole = estimated.complete
    run = _Run(
        study=study,
        curve_study=curve_study or study,
        assembly=assembly,
        few=few,
        dataset=dataset,
        accuracy=accuracy,
        complete={name: getattr(whole, name) for name in _PARTS_OF_CONTACT},
    )
    try:
        found = ErrorEstimate(
            errors={part: {} for part in ("slices", "n_positions")[assembly.slices == 1 :]}
        )
        if curve_study is not None:
            found = run.of_parts()
        if not accuracy.exact:
            found = run.with_both(found)
    except ConvergenceError as refusal:  # what was computed stands
        return ErrorEstimate(errors={}, refusal=str(refusal))
    return by_seen_order(found, first)


def by_seen_order(found: ErrorEstimate, first: ErrorEstimate | None) -> ErrorEstimate:
    """Return an estimate by the order with which the error of slices fell since a first run with fewer.

    Where a film thins without bound as a slice is relieved, it falls with the root of their number.
    """
    slices = found.errors.get("slices", {})
    if first is None or not slices or found.slices <= first.slices:
        return found
    before = first.errors.get("slices", {})
    errors = {}
    for name, error in slices.items():
        order = _order(first.slices, found.slices, before.get(name, 0.0), error)
        errors[name] = (
            error * error_fraction(1, _FINER_SLICES) / error_fraction(1, _FINER_SLICES, order)
        )
    return attrs.evolve(found, errors={**found.errors, "slices": errors})


def refined(
    study: DiscretisedStudy, assembly: Assembly, estimated: ResolutionChoice, error: ErrorEstimate
) -> ResolutionChoice | None:
    """Return the resolution with which a run is made again whose error exceeds its tolerance; None if it is not.

    Slices take the second order of their rule, positions the order that was seen, a half at least: few may err alike.
    Four times as many at most, and again up to the finest. A run is not made again that kept its tolerance, which is
    not the curves themselves, or that would have too many slices.
    """
    accuracy = assembly.scene.accuracy
    off = exceeding(_without_jumps(error.total), accuracy)
    if not off or not study.may_run_again(assembly):
        return None
    resolution = estimated.resolution
    found = " and ".join(
        f"{name.replace('_', ' ')} off by {size:.1e}" for name, size in off.items()
    )
    if off.keys() & exceeding(error.alone.get(LEFT_OUT, {}), accuracy, _AIM_AGAIN).keys():
        reinstated = (*_PARTS_OF_CONTACT, "law")
        return attrs.evolve(
            estimated,
            resolution=estimated.complete,
            left_out=(),
            errors={
                part: errors for part, errors in estimated.errors.items() if part not in reinstated
            },
            seen=f"what was left out of a contact was seen to leave {found}",
        )
    numbers = numbers_of(resolution)
    most = numbers_of(reference_resolution(assembly.scene))
    finished = [part for part in error.errors if numbers[part] >= most[part]]
    stays = combined(
        (of.get(part, {}) for part in finished for of in (error.errors, error.alone)), max
    )
    if off.keys() <= exceeding(stays, accuracy).keys():
        return None
    times = _growth(error, {name: accuracy.of(name) for name in off})
    more: dict[str, Any] = dict(numbers)
    left = dict[str, Errors]()
    for part, errors in error.errors.items():
        least = MAX_ORDER if part == "slices" else _min_order(study)
        orders = {name: max(min(error.orders.get(name, 1.0), MAX_ORDER), least) for name in errors}
        exceeded = [name for name in errors if name in off]
        aims = [
            (errors[name] / (_AIM_AGAIN * accuracy.of(name))) ** (1.0 / orders[name])
            for name in exceeded
        ]
        factor = min(max(1.0, times[part], *aims), _MAX_FACTOR)
        more[part] = max(min(math.ceil(factor * numbers[part]), most[part]), numbers[part])
        if errors:
            left[part] = {
                name: size * (numbers[part] / more[part]) ** orders[name]
                for name, size in errors.items()
            }
    if more == numbers or assembly.scene.bearing.rollers * math.prod(more.values()) > _MAX_SLICES:
        return None
    return attrs.evolve(
        estimated,
        resolution=attrs.evolve(resolution, **more),
        errors={**estimated.errors, **left},
        seen=f"{' and '.join(f'{numbers[part]} {part}' for part in error.errors)} were seen to leave {found}",
    )


def _growth(error: ErrorEstimate, tolerances: Errors) -> dict[str, float]:
    """How many times as many of each part what both change at once needs: of what changes it alone, else of both."""
    parts = [*error.errors]
    times = dict.fromkeys(parts, 0.0)
    for name, tolerance in tolerances.items():
        left = {part: error.alone.get(part, {}).get(name, 0.0) for part in parts}
        for part, size in left.items():
            others = sum(left[other] for other in parts if other != part)
            rest = max(2.0 * _AIM_AGAIN * tolerance - others, _AIM_AGAIN * tolerance)
            times[part] = max(times[part], math.sqrt(size / rest))
        if max(times.values()) <= 1.0:
            times = dict.fromkeys(
                parts, math.sqrt(error.at_once.get(name, 0.0) / (2.0 * _AIM_AGAIN * tolerance))
            )
    return times


def _without_jumps(errors: Errors) -> Errors:
    return {name: error for name, error in errors.items() if not name.endswith(WHERE_JUMPED)}


def numbers_of(resolution: Resolution) -> dict[str, int]:
    """Return how many slices and roller positions a resolution has."""
    return {"slices": resolution.slices, "n_positions": resolution.n_positions or 1}
