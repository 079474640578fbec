"""Bounds of a plan: on the discretisation error of a result, and on models that are left out.

- The error of n points is found from its difference to a finer solution by Richardson extrapolation, with the observed
  order of convergence: both differ by 1 - (n/N)^p of it (`richardson_factor`). How much finer the solution is, and
  with which order its error falls if none was observed (`JOINT_ORDER`), stands here alone: of slices (`SLICE_FACTOR`),
  of roller positions (`reference_positions`), of both together (`joint_references`, `JOINT_FACTOR`) and of the slips of
  a continued curve (`reference_slips`).
- Before a run the error is bounded by C n^-2 with the largest C of several numbers of points.
- Some parts of a model change nothing where they are left out (unloaded contacts, one slice under an even load): they
  need no bound. Others change nothing, or little, as long as a quantity stays within a limit, and the quantity is only
  known once it has been computed. For these the chains of a bearing check the limit at every evaluation.
- Where a limit is exceeded the run ends, the model is reinstated, and the run starts again as if the model had never
  been left out. The result says so.
"""

import abc
import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, ClassVar, Final, TypeAlias

import attrs
import numpy as np

from rollslip.bearing.raceway import Array
from rollslip.bearing.regimes import QUANTITIES, groups
from rollslip.bearing.resolution import (
    BoundBrokenError,
    Errors,
    LeftOut,
    Resolution,
    combine_errors,
)
from rollslip.models import TractionModel
from rollslip.results.dataset import xr
from rollslip.scene.values import Accuracy
from rollslip_kernels.slices import Slices

#: Curves at the slips of a probe, (curves, n), and the slips of their maxima, (peaks,).
Sample: TypeAlias = tuple[Array, Array]

# Orders, and reference solutions: how much finer they are ------------------------------------------------------------

#: Lowest order that is taken for an error; one that falls more slowly does not converge. At a half, 2 m + 1 positions
#: show 0.3 of the error of m.
MIN_ORDER: Final = 0.5
#: Highest order that is taken for an error: past the kinks of the loads it falls like n^-2, and more is chance.
MAX_ORDER: Final = 2.0
#: Order that is assumed where two errors do not give one. Chosen, between both limits; with 2 errors would be smaller.
ASSUMED_ORDER: Final = 1.0
#: How many times as many slices a reference solution has where slices alone are refined. With twice as many a contact
#: that ends between two slices may err alike; with 8 the comparison takes twice as long. Chosen.
SLICE_FACTOR: Final = 4
#: How many times as fine a reference solution is where slices and positions are refined together. With 4 the
#: comparison takes four times as long; with less than 2 it shows less than half of an error of order 1. Chosen.
JOINT_FACTOR: Final = 2
#: Order with which errors of slices, and joint errors, fall unless another one is observed: the second on the whole,
#: less by kinks from some numbers to twice as many. With 2 the joint error would be 14 % smaller, with 1 it would be
#: 29 % larger.
JOINT_ORDER: Final = 1.5
#: Factor on a joint error of the minimum over some points, for example the smallest film parameter. The minimum may
#: fall with the order of a half: with twice as many points its error is this many times (2.2) that by `JOINT_ORDER`.
MINIMUM_ERROR_FACTOR: Final = (1.0 - JOINT_FACTOR**-JOINT_ORDER) / (1.0 - JOINT_FACTOR**-MIN_ORDER)
#: Slices of a joint reference at least. Chosen: contacts that end between a few slices may err alike in both runs.
#: Doubled, a check of a coarse run takes twice as long.
_MIN_REFERENCE_SLICES: Final = 40
#: Roller positions of a joint reference at least, where a run has fewer slices than `_MIN_REFERENCE_SLICES`.
#: Chosen; with few of both they may err alike, and nine cost little on few slices.
_MIN_REFERENCE_POSITIONS: Final = 9
#: How many times as many slips a reference solution has where a curve is continued from slip to slip, so that it may
#: depend on the steps. Chosen; with 2 the way through a jump differs less, with 6 a check takes twice as long.
SLIP_FACTOR: Final = 3


def exceeding(errors: Errors, accuracy: Accuracy, fraction: float = 1.0) -> Errors:
    """Return those of some errors that exceed a fraction of their tolerances; NaN exceeds every tolerance."""
    return {
        name: error for name, error in errors.items() if not error <= fraction * accuracy.of(name)
    }


def _largest(error: Array) -> float:
    """Return the largest error; infinite where one is not finite, 0 where there is none."""
    return float(np.nan_to_num(error, nan=np.inf, posinf=np.inf).max(initial=0.0))


def sample_errors(coarse: Sample, fine: Sample) -> Errors:
    """Return the relative errors of friction and critical slip of a sample against a finer one.

    Parameters
    ----------
    coarse, fine : Sample
        Curves and maxima at the same slips.

    Returns
    -------
    mapping of str to float
        "friction", relative to the largest value of each curve. "critical_slip", where a maximum exists: infinite where
        only one of both samples has it. A maximum that neither has belongs to the coarse curves that found it.
    """
    scale = np.abs(fine[0]).max(axis=1, keepdims=True)
    errors = {"friction": _largest(np.abs(coarse[0] - fine[0]) / np.where(scale > 0.0, scale, 1.0))}
    any_has = ~(np.isnan(coarse[1]) & np.isnan(fine[1]))
    if any_has.any():
        errors["critical_slip"] = _largest(np.abs(coarse[1] / fine[1] - 1.0)[any_has])
    return errors


def pointwise_errors(coarse: Sample, fine: Sample) -> Errors:
    """Return errors as `sample_errors`, but that of friction relative to its value at each slip."""
    with np.errstate(divide="ignore", invalid="ignore"):
        change = np.abs(coarse[0] / fine[0] - 1.0)[coarse[0] != fine[0]]
    return {**sample_errors(coarse, fine), "friction": _largest(change)}


def errors_between(
    controlled_outputs: Mapping[str, str], dataset: "xr.Dataset", fine: "xr.Dataset"
) -> dict[str, float]:
    """Return the relative errors of a result against a finer one.

    Parameters
    ----------
    controlled_outputs : mapping of str to str
        Key of [accuracy] -> variable.
    dataset, fine : xarray.Dataset
        Both results, with the same slips.

    Returns
    -------
    dict of str to float
        Errors by key. A variable of several values is a curve, and relative to its largest value; critical slips are
        each relative to themselves. Infinite where only one of both has a value.
    """
    errors = {}
    for result, name in controlled_outputs.items():
        coarse = np.atleast_1d(dataset[name].to_numpy())
        true = np.atleast_1d(fine[name].to_numpy())
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


def richardson_factor(n: float, fine: float, order: float = JOINT_ORDER) -> float:
    """Return the fraction 1 - (n/N)^p of the error of n points by which they differ from N finer ones.

    Richardson extrapolation: the finer ones err, too, so that a difference divided by this factor is the error.

    Parameters
    ----------
    n, fine : float
        Numbers of points.
    order : float
        Order of convergence p, limited to `MIN_ORDER` and `MAX_ORDER`.
    """
    return 1.0 - math.pow(n / fine, min(max(order, MIN_ORDER), MAX_ORDER))


def observed_order(coarse: int, fine: int, coarse_error: float, fine_error: float) -> float:
    """Return the order with which an error falls between two numbers; `ASSUMED_ORDER` where they do not give one."""
    if coarse == fine or not (0.0 < coarse_error < math.inf and 0.0 < fine_error < math.inf):
        return ASSUMED_ORDER
    return math.log(coarse_error / fine_error) / math.log(fine / coarse)


def reference_positions(n_positions: int) -> int:
    """Return the number of roller positions of a reference: only that in the line of load is common to both."""
    return 2 * n_positions + 1


def position_fraction(n_positions: int, order: float) -> float:
    """Return the fraction of the error of some positions by which they differ from `reference_positions`."""
    return richardson_factor(n_positions, reference_positions(n_positions), order)


def joint_references(
    slices: int, n_positions: int, quadrature: str
) -> tuple[tuple[int, int], tuple[int, int]]:
    """Return slices and positions of two references: at Gauss points, and by the quadrature rule of the run.

    The first has pi times as many Gauss points as equal slices: it is twice as fine, and light loads reach only the
    middle of a roller, where Gauss points are pi/2 times as far apart. The second has other slices and positions than
    the first, so that it hardly errs like the run as well.

    Parameters
    ----------
    slices, n_positions : int
        Numbers of the run.
    quadrature : str
        Its quadrature rule, "equal" or "gauss".
    """
    more_positions = reference_positions(n_positions)
    if slices < _MIN_REFERENCE_SLICES:
        more_positions = max(more_positions, _MIN_REFERENCE_POSITIONS)
    density = JOINT_FACTOR * (1.0 if quadrature == "gauss" else 0.5 * math.pi)
    gauss_points = max(math.ceil(density * slices), _MIN_REFERENCE_SLICES)
    return (gauss_points, more_positions), (JOINT_FACTOR * slices + 1, more_positions + 1)


def reference_slips(points: int) -> int:
    """Return the number of slips of a reference, among which are those of a run: every `SLIP_FACTOR`-th."""
    return SLIP_FACTOR * (points - 1) + 1


@attrs.frozen(kw_only=True)
class ErrorBound:
    """A bound C n^-2 on the error of n points, with a constant C for each result."""

    constants: Errors

    @classmethod
    def from_samples(
        cls, numbers: Sequence[int], samples: Sequence[Sample], may_lack: Collection[str] = ()
    ) -> "ErrorBound":
        """Return the smallest bound on the errors by which samples of a ladder differ from the last.

        Maxima that the last lacks are artefacts. Some results may have no bound, as the slip of a flat maximum.

        Parameters
        ----------
        numbers : sequence of int
            Numbers of points.
        samples : sequence of Sample
            Curves and maxima with these numbers.
        may_lack : collection of str
            Results whose errors a study estimates by values after its run: an infinite bound of these is left out.
        """
        is_known = ~np.isnan(samples[-1][1])
        *ladder, fine = ((curves, maxima[is_known]) for curves, maxima in samples)
        scaled = [
            {
                name: n * n / richardson_factor(n, numbers[-1], MAX_ORDER) * error
                for name, error in sample_errors(sample, fine).items()
            }
            for n, sample in zip(numbers[:-1], ladder, strict=True)
        ]
        return cls(
            constants={
                name: constant
                for name, constant in combine_errors(scaled, max).items()
                if name not in may_lack or math.isfinite(constant)
            }
        )

    def errors(self, n: int) -> Errors:
        """Return the bounds on the errors of n points."""
        return {name: constant / (n * n) for name, constant in self.constants.items()}

    def required_points(self, allowed: Errors) -> float:
        """Return the number of points, not rounded, whose errors are bounded by the allowed ones."""
        return max(
            (math.sqrt(constant / allowed[name]) for name, constant in self.constants.items()),
            default=0.0,
        )


@attrs.frozen(kw_only=True)
class ErrorEstimate:
    """The discretisation error that slices and roller positions leave in the result of a run."""

    #: Part ("slices", "n_positions") -> key of [accuracy] -> relative error.
    errors: Mapping[str, Errors]
    #: Key of [accuracy] -> observed order with which the error falls with the positions; only where it was needed.
    orders: Mapping[str, float] = attrs.field(factory=dict)
    #: Errors by refining slices and positions together: of curves by key of [accuracy], of single values by name.
    joint_errors: Errors = attrs.field(factory=dict)
    #: Part -> errors by refining this part alone, or by reinstating what was left out (`LEFT_OUT`); only where the
    #: joint errors exceed the tolerance.
    separate_errors: Mapping[str, Errors] = attrs.field(factory=dict)
    #: Slices of the run.
    slices: int = 0
    #: Why there is no estimate, in words; empty where there is one.
    refusal: str = ""

    @property
    def total(self) -> Errors:
        """Sum over the parts, or the joint error where that is larger."""
        return combine_errors((combine_errors(self.errors.values(), sum), self.joint_errors), max)

    def of_parts(self, parts: Sequence[str]) -> Errors:
        """Return the larger errors of some parts, of those with coarse numbers and those by refining each alone."""
        estimates = (self.errors, self.separate_errors)
        return combine_errors((errors.get(part, {}) for part in parts for errors in estimates), max)

    def joint_factors(self, aims: Errors) -> dict[str, float]:
        """Return how many times as many of each part the joint errors require, so that each part keeps its aim.

        They are computed from the error of each part alone; where these are too small to explain a joint error, all
        parts grow alike.

        Parameters
        ----------
        aims : mapping of str to float
            Relative error that each part may leave, by result.
        """
        parts = [*self.errors]
        factors = dict.fromkeys(parts, 0.0)
        for name, aim in aims.items():
            separate = {part: self.separate_errors.get(part, {}).get(name, 0.0) for part in parts}
            for part, size in separate.items():
                others = sum(separate[other] for other in parts if other != part)
                factors[part] = max(factors[part], math.sqrt(size / max(2.0 * aim - others, aim)))
            if max(factors.values()) <= 1.0:
                factor = math.sqrt(self.joint_errors.get(name, 0.0) / (2.0 * aim))
                factors = dict.fromkeys(parts, factor)
        return factors


def with_observed_slice_order(
    estimate: ErrorEstimate, first: ErrorEstimate | None
) -> ErrorEstimate:
    """Return an estimate by the observed order of slices, from a first run with fewer of them.

    Where a film thins without bound as a slice is relieved, the error falls with the root of their number.

    Parameters
    ----------
    estimate : ErrorEstimate
        Estimate of the present run, by the order `JOINT_ORDER`.
    first : ErrorEstimate or None
        Estimate of the first run; None if this is the first.
    """
    slices = estimate.errors.get("slices", {})
    if first is None or not slices or estimate.slices <= first.slices:
        return estimate
    before = first.errors.get("slices", {})
    errors = {}
    for name, error in slices.items():
        order = observed_order(first.slices, estimate.slices, before.get(name, 0.0), error)
        errors[name] = (
            error * richardson_factor(1, SLICE_FACTOR) / richardson_factor(1, SLICE_FACTOR, order)
        )
    return attrs.evolve(estimate, errors={**estimate.errors, "slices": errors})


# Models that are left out --------------------------------------------------------------------------------------------


class _CheckedModel(LeftOut):
    """A model that is left out as long as quantities of all evaluated slices keep their limits."""

    #: Fields of a resolution that includes the model.
    included: ClassVar[Mapping[str, Any]]

    @abc.abstractmethod
    def checks(self, slices: Slices) -> Iterable[tuple[str, float, bool, str]]:
        """Return quantities of slices: name, value, whether it keeps its limit, and what it is otherwise."""

    def __call__(self, slices: Slices) -> None:
        """Check the quantities of slices."""
        if not len(slices):
            return
        for name, value, is_satisfied, excess in self.checks(slices):
            if not is_satisfied:
                raise BoundBrokenError(self, f"a {name} of {value:.4g} is {excess}")

    def reinstated(self, resolution: Resolution) -> Resolution:
        """Return the resolution with the model."""
        return attrs.evolve(resolution, **self.included)


@attrs.frozen
class BoundaryFriction(_CheckedModel):
    """Boundary friction, which is exactly zero as long as every film parameter is at least a limit."""

    limit: float

    what = "boundary friction"
    included = MappingProxyType({"boundary": True})

    def checks(self, slices: Slices) -> Iterable[tuple[str, float, bool, str]]:
        """Return the smallest film parameter."""
        thinnest = float(slices.film_thickness.min()) / slices.conditions.roughness
        return [("film parameter", thinnest, thinnest >= self.limit, f"below {self.limit:g}")]


@attrs.frozen
class ExactLaw(_CheckedModel):
    """The law that the scene names, replaced by its closed form up to a maximum of each dimensionless group of the law.

    The difference of both grows with each group; it was computed where the groups are largest.
    """

    law: TractionModel
    #: Group -> its maximum.
    max_groups: Mapping[str, float]

    included = MappingProxyType({"traction": "named"})

    @property
    def what(self) -> str:
        """The law by its name."""
        return f"the law {self.law.name!r}"

    def checks(self, slices: Slices) -> Iterable[tuple[str, float, bool, str]]:
        """Return the largest of each group."""
        for name, largest in _largest_groups(self.law, slices).items():
            limit = self.max_groups[name]
            yield name.replace("_", " "), largest, largest <= limit, f"above {limit:.4g}"


@attrs.frozen
class InletHeating(_CheckedModel):
    """The heat of the inlet, which thins a film, up to a maximum of the thermal load."""

    max_thermal_load: float

    what = "the heat of the inlet"
    included = MappingProxyType({"inlet_heating": True})

    def checks(self, slices: Slices) -> Iterable[tuple[str, float, bool, str]]:
        """Return the largest thermal load."""
        largest = max_thermal_load(slices)
        limit = self.max_thermal_load
        return [("thermal load", largest, largest <= limit, f"above {limit:.4g}")]


@attrs.frozen
class LightContacts(_CheckedModel):
    """The pressure of the film itself, which spreads a light load, down to the load parameter M of the mean load.

    The mean load is taken because a few slices hardly touch in any bearing; they carry as little of the friction.
    """

    min_mean_load: float

    what = "the pressure of light contacts"
    included = MappingProxyType({"light_contacts": True})

    def checks(self, slices: Slices) -> Iterable[tuple[str, float, bool, str]]:
        """Return the load parameter of the mean load."""
        load = mean_load(slices)
        limit = self.min_mean_load
        return [("mean load parameter", load, load >= limit, f"below {limit:.4g}")]


def max_thermal_load(slices: Slices) -> float:
    """Return the largest thermal load of the inlets of slices."""
    return float(QUANTITIES["thermal_load"].of(slices).max())


def mean_load(slices: Slices) -> float:
    """Return the load parameter M of the mean load of slices, at the mean of their speeds."""
    U, _, W = groups(slices)
    return float(W.mean() / np.sqrt(2.0 * U).mean())


class Extremes:
    """Extremes of evaluated slices: film parameter, thermal load and groups of a law, and the smallest mean load."""

    def __init__(self, law: TractionModel) -> None:
        self.thinnest = math.inf
        self.groups = dict[str, float]()
        self._law = law
        self.hottest = 0.0
        self.lightest = math.inf

    def __call__(self, slices: Slices) -> None:
        """Update the extremes by evaluated slices."""
        if not len(slices):
            return
        self.thinnest = min(
            self.thinnest, float(slices.film_thickness.min()) / slices.conditions.roughness
        )
        self.hottest = max(self.hottest, max_thermal_load(slices))
        self.lightest = min(self.lightest, mean_load(slices))
        if self._law.closed_form is not None:
            for name, size in _largest_groups(self._law, slices).items():
                self.groups[name] = max(self.groups.get(name, 0.0), size)


def _largest_groups(law: TractionModel, slices: Slices) -> dict[str, float]:
    """Return the largest size of each group of a law in evaluated slices."""
    return {name: float(np.abs(group).max()) for name, group in law.groups(slices).items()}
