"""Estimate the discretisation error of a study: before a run, to choose its resolution, and after it.

Discretised are the slices along a roller and the roller positions within a pitch. Both estimates compare curves of the
study, computed with different numbers of these, at a few slips: some over the range, and three around each maximum.

Before a run (`choose_by_curves`): a convergence study on coarse numbers.

1. Find the maxima of the curves on a coarse grid of slips (`Probe`).
2. Compute the curves at the slips of the probe on a ladder of numbers of positions, then of slices.
3. Compare each with the last of its ladder, and bound the error by C n^-2 with the largest C (`ErrorBound`). Contacts
   part from their ring somewhere along the roller and the orbit. There a load rises like the power 10/9 of the
   distance, so that all quadratures converge like n^-2.1, with a factor that depends on where the kinks lie between the
   points. A single comparison, or Richardson extrapolation of two numbers, would often meet a small error by chance.
4. Take the smallest numbers whose bounds, added up, keep half of the tolerance.
5. Leave out models that change no curve by more than their fraction of the tolerance, under a bound which is checked
   while the study runs.

A study without curves doubles both numbers until its results change by less than the tolerance (`choose_by_doubling`).

After a run (`estimate_error`): an a posteriori estimate by reference solutions, which share none of the above.

1. Compare with four times as many slices, and with 2 m + 1 positions instead of m. They have one position in common.
2. Divide the difference by 1 - (n/N)^p, the fraction of the error of n points which it shows (Richardson
   extrapolation).
3. Where that is not clearly below the tolerance, repeat with m/2 positions for the observed order p.
4. Refine slices and positions together, since both errors may cancel; and each alone where that exceeds the tolerance.
5. Where the estimate exceeds the tolerance, `refine_resolution` returns the numbers with which to run again.

A maximum is flat: the critical slip changes far more than friction does. Its error is that of the vertex of a parabola
through three slips around it.

References
----------
P. J. Roache, Perspective: a method for uniform reporting of grid refinement studies, J. Fluids Eng. 116 (1994) 405-413:
observed order, Richardson extrapolation and the grid convergence index.
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
from rollslip.studies.answers import Errors, PartialResult, ResolutionChoice, combine_errors
from rollslip.studies.bounds import (
    BoundaryFriction,
    ExactLaw,
    Extremes,
    InletHeating,
    LightContacts,
)

if TYPE_CHECKING:
    import xarray as xr


@attrs.frozen(kw_only=True)
class _ProbeSettings:
    """How many slips a probe samples, and what counts as a maximum."""

    #: Slips of the grid over the range on which maxima are searched. Chosen: a curve has one or two maxima. Twice as
    #: many find maxima that lie closer, at twice the cost.
    grid_slips: int = 13
    #: Every how many slips of that grid the curves are compared, too. Chosen: four slips show the level of a curve.
    stride: int = 3
    #: Slips on which a maximum is searched again between its neighbours of the grid. Chosen: they set the step of the
    #: parabola; with twice as many a maximum that shifts between two resolutions may leave its three slips.
    refined_slips: int = 7
    #: Height, relative to the largest maximum, from which a maximum counts: finer slices may make it the largest. In
    #: scene 7 of docs/tables/plan_proof.csv coarse slices had the other one of two for the largest. Halved, evaluations
    #: are spent on maxima that never become the largest.
    rival_height: float = 0.7
    #: Difference of values around a maximum, relative to it, up to which they are equal but for rounding: such a curve
    #: is level and has no vertex. Rounding is some 1e-14; from about 1e-6 on real maxima would be dropped.
    rounding: float = 1e-9


@attrs.frozen(kw_only=True)
class _ToleranceFractions:
    """Fractions of the tolerance of a result: what parts of the error may take, and from where estimates are doubted.

    All are chosen. They trade the cost of a run against the number of runs that exceed their tolerance; docs/trust/plan
    has these numbers for random scenes.
    """

    #: Of slices and roller positions together before a run. The other half is for tables, models left out and what a
    #: few slips do not show. Doubled, an estimate that is only a little low exceeds the tolerance.
    discretisation: float = 0.5
    #: Of `discretisation` that slices get at least, whatever the positions leave of it. Without it one position that
    #: happens to take all would ask for infinitely many slices.
    slices_at_least: float = 0.3
    #: By which a closed form may change the curves in place of the law that a scene names.
    cheaper_law: float = 0.1
    #: By which every value may change, relative to itself, where a part of a contact is left out. It is relative to the
    #: value since a steady slip goes with the friction at that slip, and not with the largest friction.
    left_out: float = 0.2
    #: Below which an error is believed without its order. Doubled, fewer runs are compared with a third number of
    #: positions, and an order that is worse than expected shows later.
    clear: float = 0.3
    #: From which agreement with one joint reference may be chance, so that a second one is computed. Doubled, more runs
    #: save the second reference, and more errors that cancel by chance are missed.
    chance: float = 0.15
    #: At which slices and positions aim, each, where a run is made again: both stay below the tolerance together, with
    #: some room for an order that is lower than the observed one.
    refined: float = 0.35


@attrs.frozen(kw_only=True)
class _ReferenceSettings:
    """How much finer the reference solutions are with which a run is compared."""

    #: How many times as many slices. With twice as many a contact that ends between two slices may err alike.
    slice_factor: int = 4
    #: Slices of a joint reference at least. Chosen: contacts that end between a few slices may err alike in both runs.
    #: Doubled, a check of a coarse run takes twice as long.
    min_slices: int = 40
    #: Roller positions of a joint reference at least, where a run has fewer slices than `min_slices`. Chosen; with
    #: few of both they may err alike, and nine cost little on few slices.
    min_positions: int = 9
    #: Slips of the curves of another study, where the result has none. Chosen; twice as many take twice as long
    #: and show a maximum between the slips more exactly.
    sampled_slips: int = 25


_PROBE: Final = _ProbeSettings()
_FRACTIONS: Final = _ToleranceFractions()
_REFERENCE: Final = _ReferenceSettings()
#: How many times as many slips a reference solution has where a curve is continued from slip to slip, so that it may
#: depend on the steps. Chosen; with 2 the way through a jump differs less, with 6 a check takes twice as long.
REFERENCE_SLIP_FACTOR: Final = 3

# Ladders of a run that is planned ------------------------------------------------------------------------------------

#: Slices of the ladder; the others are compared with the last. The first is the coarsest that a plan chooses. Twice as
#: many in the last doubles the cost of a plan; its own error, 1/36 of that of 16 slices, is allowed for.
_SLICE_LADDER: Final = (8, 12, 16, 96)
#: Roller positions on which the ladder of slices is computed. Chosen: with one, few rollers are near the ends of the
#: loaded zone; four would double the cost of a plan.
COARSE_POSITIONS: Final = 2
#: Roller positions of the ladder: each number divides the last, so that all cost no more than the last.
_POSITION_LADDER: Final = (1, 2, 3, 4, 6, 12)
#: Roller positions of the ladder where each number is computed for itself, so that twelve would cost too much.
_SEPARATE_POSITION_LADDER: Final = (1, 2, 3, 6)
#: Slices on which positions and laws are compared. Chosen: their changes hardly depend on the slices; twice as many
#: double the cost of a plan.
COARSE_SLICES: Final = 12
#: Fractions of the range of slips at which laws are compared, too. Laws differ most where an oil begins to shear by the
#: stress and not by the viscosity, up to a hundred times as much as at the slips of a maximum.
_SMALL_SLIPS: Final = (1e-4, 3e-4, 1e-3, 3e-3, 1e-2)
#: Roller positions on which laws are compared. Chosen: loads, and slips of free rollers, differ between positions.
_LAW_POSITIONS: Final = 4
#: Factor by which a quantity may exceed the largest that the probe met before what was left out is reinstated. Chosen;
#: with 1 nearly every run would start again, as its slips and positions are others. The error grows by about this much.
_BOUND_MARGIN: Final = 1.2
#: Number from which a needed number of points counts as infinite; a float beyond it may not fit into an integer.
_UNLIMITED: Final = 1e9

# Orders of convergence -----------------------------------------------------------------------------------------------

#: Order with which errors fall where slices and positions are doubled together: the second on the whole, less by kinks
#: from some numbers to twice as many. With 2 the joint error would be 14 % smaller, with 1 it would be 29 % larger.
JOINT_ORDER: Final = 1.5
#: Factor on a joint error of the minimum over some points, for example the smallest film parameter. The minimum may
#: fall with the order of a half: with twice as many points its error is this many times (2.2) that by `JOINT_ORDER`.
MINIMUM_ERROR_FACTOR: Final = (1.0 - 2.0**-JOINT_ORDER) / (1.0 - 2.0**-0.5)
#: Lowest order that is taken for an error; one that falls more slowly does not converge. At a half, 2 m + 1 positions
#: show 0.3 of the error of m.
MIN_ORDER: Final = 0.5
#: Highest order that is taken for an error: past the kinks of the loads it falls like n^-2, and more is chance.
MAX_ORDER: Final = 2.0
#: Order of the mean over positions of a curve with jumps, at the worst, whatever two numbers of positions show: each
#: roller jumps somewhere between two positions.
_JUMP_ORDER: Final = 1.0
#: Order that is assumed where two errors do not give one. Chosen, between both limits; with 2 errors would be smaller.
_ASSUMED_ORDER: Final = 1.0

# Runs that are made again --------------------------------------------------------------------------------------------

#: Name of the part of an error that comes from models left out, which the probe did not show to be needed.
LEFT_OUT: Final = "left out"
#: Number of a resolution -> what messages call it.
_NUMBER_NAMES: Final = {"slices": "slices", "n_positions": "roller positions"}
#: Parts of a contact that may be left out, as fields of a resolution.
_CONTACT_PARTS: Final = ("inlet_heating", "light_contacts")
#: How many times as many slices or positions a run has at most that is made again. Chosen; with 8 a doubtful order may
#: ask for far more than is needed, while a run that is still off after 4 is made again anyway.
_MAX_FACTOR: Final = 4.0
#: Slices of all rollers over an orbit at most with which a run is made again: some seconds of effective friction, and
#: up to a minute of steady slips with their check. Beyond, the error is only reported. A limit of time would let the
#: result depend on the machine.
_MAX_SLICES: Final = 500_000

#: Curves at the slips of a probe, (curves, n), and the slips of their maxima, (peaks,).
Sample: TypeAlias = tuple[Array, Array]


@attrs.frozen(kw_only=True)
class DiscretisedStudy:
    """What choice of resolution and error estimate need of a study: its curves over slip and its single values."""

    #: What a command and a scene call it.
    name: ClassVar[str]
    #: Key of [accuracy] (friction, critical_slip, cage_speed) -> output whose discretisation error is kept below it.
    controlled_outputs: ClassVar[Mapping[str, str]] = MappingProxyType({})
    #: Names of `value_errors` which no finer run reduces soon, for example bounds at the jump of a roller. They are
    #: reported, and no run is made again for them.
    irreducible_errors: ClassVar[frozenset[str]] = frozenset()
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
        """Whether its curves are means over the roller positions within a pitch."""
        return False

    @property
    def has_nested_positions(self) -> bool:
        """Whether the positions of a small number are among those of its multiples, so that they cost nothing more."""
        return True

    @property
    def uses_continuation(self) -> bool:
        """Whether a curve is continued from slip to slip, so that it may depend on the slips in between."""
        return False

    def curves(self, assembly: Assembly, slip: Array, n_positions: Sequence[int]) -> Array:
        """Return its curves at some slips, for each of some numbers of roller positions.

        From these curves a plan finds the smallest numbers of slices and positions. A study may have none.

        Parameters
        ----------
        assembly : Assembly
            The bearing, at the resolution whose slices are to be taken.
        slip : array, shape (n,)
            Slips of the cage, relative to its epicyclic speed.
        n_positions : sequence of int, length k
            Numbers of roller positions within a pitch.

        Returns
        -------
        array, shape (k, curves, n)
            Values of the curves in units of their own.
        """
        raise NotImplementedError(f"study {self.name!r} has no curves")

    def sample_other_contacts(self, assembly: Assembly) -> None:
        """Evaluate a few of the contacts that a run evaluates besides its curves, so that bounds know their values."""

    def curve_study(self, assembly: Assembly) -> "DiscretisedStudy | None":
        """Return the study whose curves choose slices and positions and estimate the error; None if there is none."""
        return None if type(self).curves is DiscretisedStudy.curves else self

    def with_settings(self, **settings: Any) -> Self:
        """Return the study with other settings."""
        return attrs.evolve(self, **settings)

    @classmethod
    def run_batch(
        cls, cases: "Sequence[tuple[Self, Assembly]]", outputs: frozenset[str]
    ) -> list[PartialResult] | None:
        """Return some outputs of several points in one call; None if the study cannot compute these in one call.

        Parameters
        ----------
        cases : sequence of (study, Assembly)
            The points: settings of the study, and the bearing at its resolution.
        outputs : frozenset of str
            Names among the outputs of the study.

        Returns
        -------
        list of PartialResult, or None
            Variables and coordinates of each point, in the order of the cases.
        """
        return None

    def value_errors(self, finer: Assembly, dataset: "xr.Dataset") -> Mapping[str, float]:
        """Return the relative errors of single values of a result, compared with a finer bearing.

        Parameters
        ----------
        finer : Assembly
            The bearing with more slices and roller positions.
        dataset : xarray.Dataset
            The result of the run.

        Returns
        -------
        mapping of str to float
            Differences relative to the finer values, by the names under which they are reported.
        """
        return {}

    def has_error_estimate(self, assembly: Assembly) -> bool:
        """Whether the error of a result is estimated after a run: by curves, or by single values."""
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
    """Return those of some errors that exceed a fraction of their tolerances; NaN exceeds every tolerance."""
    return {
        name: error for name, error in errors.items() if not error <= fraction * accuracy.of(name)
    }


# Curves at a few slips -----------------------------------------------------------------------------------------------


class Probe:
    """A few slips at which curves of a study are sampled: some over the range, and three around each maximum.

    Parameters
    ----------
    study : DiscretisedStudy
        The study that gives the curves.
    assembly : Assembly
        The bearing with coarse slices, on which maxima are searched at one roller position.
    """

    def __init__(self, study: DiscretisedStudy, assembly: Assembly) -> None:
        self._study = study
        grid = slip_grid(study.slip_range, _PROBE.grid_slips)
        slips = [*grid[_PROBE.stride :: _PROBE.stride]]
        peaks = list[tuple[float, ...]]()
        for k, curve in enumerate(study.curves(assembly, grid, (1,))[0]):
            for best in _rival_maxima(curve):
                near = np.linspace(
                    grid[max(best - 1, 0)],
                    grid[min(best + 1, grid.size - 1)],
                    _PROBE.refined_slips + 2,
                )[1:]
                values = study.curves(assembly, near, (1,))[0][k]
                top = max(int(np.argmax(values)), 1)
                if top == near.size - 1:
                    continue  # it rises up to the end of the range
                around = slice(top - 1, top + 2)
                if np.min(np.abs(np.diff(values[around]))) <= _PROBE.rounding * values[top]:
                    continue  # level
                peaks.append((k, len(slips), near[1] - near[0]))
                slips += [*near[around]]
        self._slip = np.array(slips)
        #: Of each maximum its curve, the index of the first of its three slips, and their step, (3, peaks).
        self._peaks = np.array(peaks).reshape(-1, 3).T

    def sample(
        self, assembly: Assembly, *n_positions: int, small_slips: Sequence[float] = ()
    ) -> list[Sample]:
        """Return curves and maxima for each of some numbers of positions.

        Parameters
        ----------
        assembly : Assembly
            The bearing, whose slices are taken.
        *n_positions : int
            Numbers of roller positions within a pitch.
        small_slips : sequence of float
            Slips at which the curves are sampled, too, relative to the range.

        Returns
        -------
        list of Sample
            Curves (curves, n) and slips of the maxima (peaks,) for each number; NaN for a maximum that lies elsewhere.
        """
        slips = np.concatenate((self._slip, np.multiply(small_slips, self._study.slip_range)))
        return [
            (curves, self._maxima(curves))
            for curves in self._study.curves(assembly, slips, n_positions)
        ]

    def _maxima(self, curves: Array) -> Array:
        """Return the slips of the maxima by a parabola each, NaN where its vertex is not among the slips around it."""
        step = self._peaks[2]
        curve, first = self._peaks[:2].astype(int)
        low, middle, high = curves[curve, first + np.arange(3)[:, None]]
        curvature = low - 2.0 * middle + high
        with np.errstate(all="ignore"):
            steps = np.where(curvature < 0.0, 0.5 * (low - high) / curvature, np.inf)
            vertex = self._slip[first + 1] + step * steps
        return np.where(np.abs(steps) <= 0.5 * (_PROBE.refined_slips + 1), vertex, np.nan)


def _rival_maxima(curve: Array) -> list[int]:
    """Return the indices of local maxima of a curve that are high enough to become the largest on finer slices."""
    padded = np.concatenate(([-np.inf], curve, [-np.inf]))
    is_peak = (
        (curve >= padded[:-2])
        & (curve > padded[2:])
        & (curve >= _PROBE.rival_height * curve.max())
        & (curve > 0.0)
    )
    indices: list[int] = np.flatnonzero(is_peak).tolist()
    return indices


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


def _pointwise_errors(coarse: Sample, fine: Sample) -> Errors:
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


def richardson_factor(n: float, fine: float, order: float = MAX_ORDER) -> float:
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


def _observed_order(coarse: int, fine: int, coarse_error: float, fine_error: float) -> float:
    """Return the order with which an error falls between two numbers; `_ASSUMED_ORDER` where they do not give one."""
    if coarse == fine or not (0.0 < coarse_error < math.inf and 0.0 < fine_error < math.inf):
        return _ASSUMED_ORDER
    return math.log(coarse_error / fine_error) / math.log(fine / coarse)


def _min_order(study: DiscretisedStudy) -> float:
    """Return the order with which errors of roller positions fall at least."""
    return _JUMP_ORDER if study.uses_continuation else MIN_ORDER


# Before a run: the coarsest resolution whose estimated error keeps the tolerance -------------------------------------


@attrs.frozen(kw_only=True)
class ErrorBound:
    """A bound C n^-2 on the error of n points, with a constant C for each result."""

    constants: Errors

    @classmethod
    def from_samples(cls, numbers: Sequence[int], samples: Sequence[Sample]) -> "ErrorBound":
        """Return the bound by samples of a ladder, compared with its last; maxima that the last lacks are artefacts."""
        is_known = ~np.isnan(samples[-1][1])
        *ladder, fine = ((curves, maxima[is_known]) for curves, maxima in samples)
        errors = [sample_errors(sample, fine) for sample in ladder]
        return cls.from_errors(numbers[:-1], errors, numbers[-1])

    @classmethod
    def from_errors(
        cls, numbers: Sequence[int], errors: Sequence[Errors], fine: int
    ) -> "ErrorBound":
        """Return the smallest bound on the errors by which some numbers of points differ from `fine` points.

        Parameters
        ----------
        numbers : sequence of int
            Numbers of points.
        errors : sequence of mappings
            Relative errors of each number against the finer points, by result.
        fine : int
            Number of the finer points.
        """
        scaled = [
            {name: n * n / richardson_factor(n, fine) * error for name, error in found.items()}
            for n, found in zip(numbers, errors, strict=True)
        ]
        return cls(constants=combine_errors(scaled, max))

    def errors(self, n: int) -> Errors:
        """Return the bounds on the errors of n points."""
        return {name: constant / (n * n) for name, constant in self.constants.items()}

    def required_points(self, allowed: Errors) -> float:
        """Return the number of points, not rounded, whose errors are bounded by the allowed ones."""
        return max(
            (math.sqrt(constant / allowed[name]) for name, constant in self.constants.items()),
            default=0.0,
        )


def coarse_assembly(assembly: Assembly) -> Assembly:
    """Return a bearing with coarse slices, which show what roller positions change and where maxima are."""
    return assembly.at(attrs.evolve(assembly.resolution, slices=COARSE_SLICES, quadrature="equal"))


def choose_by_curves(
    study: DiscretisedStudy,
    assembly: Assembly,
    *,
    fraction: float = 1.0,
    cheaper_laws: bool = True,
) -> ResolutionChoice:
    """Choose the resolution of a study by its curves on a ladder of coarse slices and roller positions.

    Parameters
    ----------
    study : DiscretisedStudy
        The study that gives the curves.
    assembly : Assembly
        The bearing as the scene states it.
    fraction : float
        Fraction of the tolerance that slices and positions may use.
    cheaper_laws : bool
        Whether models may be left out, or replaced by a closed form, where the tolerance allows it.
    """
    if assembly.scene.accuracy.exact:
        return reference_choice(study, assembly)
    choice, probe, coarse = choose_slices_and_positions(study, assembly, fraction)
    return _choose_laws(choice, study, probe, coarse, cheaper_laws)


def reference_choice(study: DiscretisedStudy, assembly: Assembly) -> ResolutionChoice:
    """Return the reference resolution, with one position where the curves are not means over positions."""
    best = reference_resolution(assembly.scene)
    if study.is_averaged:
        return ResolutionChoice(resolution=best)
    return ResolutionChoice(resolution=attrs.evolve(best, n_positions=1))


def with_table_tolerance(
    choice: ResolutionChoice, assembly: Assembly, fraction: float
) -> ResolutionChoice:
    """Return a choice with tables whose error takes a fraction of the tolerances of friction and cage speed.

    Parameters
    ----------
    choice : ResolutionChoice
        Slices and positions.
    assembly : Assembly
        The bearing, for the tolerances of its scene.
    fraction : float
        Fraction for the tables; 0 for a study without tables.
    """
    if not fraction:
        return choice
    accuracy = assembly.scene.accuracy
    tolerance = fraction * min(accuracy.of("friction"), accuracy.of("cage_speed"))
    return attrs.evolve(
        choice,
        resolution=attrs.evolve(choice.resolution, table_tolerance=tolerance),
        errors={**choice.errors, "tables": {"friction": tolerance}},
    )


def choose_slices_and_positions(
    study: DiscretisedStudy, assembly: Assembly, fraction: float
) -> tuple[ResolutionChoice, Probe, Assembly]:
    """Choose the numbers of slices and positions; return the probe and the bearing with coarse slices, too.

    Parameters
    ----------
    study : DiscretisedStudy
        The study that gives the curves.
    assembly : Assembly
        The bearing as the scene states it.
    fraction : float
        Fraction of the tolerance that slices and positions may use.
    """
    accuracy = assembly.scene.accuracy
    best = reference_resolution(assembly.scene)
    has_slices = assembly.slices > 1
    allowed = {
        name: _FRACTIONS.discretisation * fraction * accuracy.of(name)
        for name in ("friction", "critical_slip")
    }
    coarse = coarse_assembly(assembly)
    probe = Probe(study, coarse)
    n_positions = 1
    position_errors: Errors = {}
    if study.is_averaged:
        numbers = _POSITION_LADDER if study.has_nested_positions else _SEPARATE_POSITION_LADDER
        bound = ErrorBound.from_samples(numbers, probe.sample(coarse, *numbers))
        parts = 1 + has_slices
        each = {name: error / parts for name, error in allowed.items()}
        n_positions = _whole_number(bound.required_points(each), 1, best.n_positions)
        position_errors = bound.errors(n_positions)
    resolution = attrs.evolve(assembly.resolution, quadrature="equal", n_positions=n_positions)
    errors = {"n_positions": position_errors} if position_errors else {}
    if has_slices:
        rest = {
            name: max(error - position_errors.get(name, 0.0), _FRACTIONS.slices_at_least * error)
            for name, error in allowed.items()
        }
        slices, rule, slice_errors = _choose_slices(probe, coarse, rest, best.slices)
        resolution = attrs.evolve(resolution, slices=slices, quadrature=rule)
        errors = {"slices": slice_errors, **errors}
    return ResolutionChoice(resolution=resolution, errors=errors), probe, coarse


def _choose_slices(
    probe: Probe, coarse: Assembly, allowed: Errors, max_slices: int
) -> tuple[int, str, Errors]:
    """Return number and quadrature rule of the slices that keep the allowed errors, and the bounds on their errors."""

    def sample(n: int, rule: str = "equal") -> Sample:
        at = coarse.at(attrs.evolve(coarse.resolution, slices=n, quadrature=rule))
        return probe.sample(at, COARSE_POSITIONS)[0]

    stated = coarse.scene.accuracy.slices
    fine = sample(_SLICE_LADDER[-1])
    rules = ["equal", "gauss"] if stated is None else ["equal"]
    bounds = {
        rule: ErrorBound.from_samples(
            _SLICE_LADDER, [*(sample(n, rule) for n in _SLICE_LADDER[:-1]), fine]
        )
        for rule in rules
    }
    required = {rule: bound.required_points(allowed) for rule, bound in bounds.items()}
    rule = min(required, key=required.__getitem__)
    slices = stated or _whole_number(required[rule], _SLICE_LADDER[0], max_slices)
    return slices, rule, bounds[rule].errors(slices)


def _whole_number(number: float, low: int, high: int | None) -> int:
    """Return a number rounded up, between two limits; without an upper one where that is None or 0, it is the lower."""
    return int(min(max(math.ceil(min(number, _UNLIMITED)), low), high or low))


def _choose_laws(
    choice: ResolutionChoice,
    study: DiscretisedStudy,
    probe: Probe,
    coarse: Assembly,
    cheaper_laws: bool,
) -> ResolutionChoice:
    """Leave out models that change too little, and take a closed form of a law where the tolerance allows it."""
    law = coarse.traction.full_film
    limit = coarse.traction.full_film_from
    resolution = choice.resolution
    errors = dict(choice.errors)
    left_out = list[LeftOut]()
    extremes = Extremes(law)
    probe.sample(coarse.with_bounds(extremes), 1)
    study.sample_other_contacts(coarse.with_bounds(extremes))
    if limit is not None and extremes.thinnest >= limit:
        resolution = attrs.evolve(resolution, boundary=False)
        left_out.append(BoundaryFriction(limit))
    reference: Sample | None = None
    simplifications = _simplifications(coarse, extremes) if cheaper_laws else []
    for name, applies, changes, bound, fraction, error_norm in simplifications:
        if not applies:
            continue
        if reference is None:
            reference = probe.sample(coarse, _LAW_POSITIONS, small_slips=_SMALL_SLIPS)[0]
        cheaper = coarse.at(attrs.evolve(coarse.resolution, **changes))
        sample = probe.sample(cheaper, _LAW_POSITIONS, small_slips=_SMALL_SLIPS)[0]
        error = error_norm(sample, reference)
        if not exceeding(error, coarse.scene.accuracy, fraction):
            resolution = attrs.evolve(resolution, **changes)
            errors[name] = error
            left_out.append(bound)
    return attrs.evolve(
        choice, resolution=resolution, errors=errors, left_out=tuple(left_out), compared_laws=True
    )


def _simplifications(
    coarse: Assembly, extremes: Extremes
) -> list[tuple[str, bool, dict[str, Any], LeftOut, float, Callable[[Sample, Sample], Errors]]]:
    """Return the simplifications of laws: name, whether it applies, change of the resolution, bound, fraction, norm."""
    law = coarse.traction.full_film
    groups = {name: _BOUND_MARGIN * size for name, size in extremes.groups.items()}
    return [
        (
            "inlet_heating",
            bool(coarse.film.inlet_heating),
            {"inlet_heating": False},
            InletHeating(_BOUND_MARGIN * extremes.hottest),
            _FRACTIONS.left_out,
            _pointwise_errors,
        ),
        (
            "light_contacts",
            coarse.pressure in coarse.inner.chain.models,
            {"light_contacts": False},
            LightContacts(extremes.lightest / _BOUND_MARGIN),
            _FRACTIONS.left_out,
            _pointwise_errors,
        ),
        (
            "law",
            bool(groups),
            {"traction": law.closed_form},
            ExactLaw(law, groups),
            _FRACTIONS.cheaper_law,
            sample_errors,
        ),
    ]


def choose_by_doubling(
    run: Callable[[Assembly], "xr.Dataset"],
    controlled_outputs: Mapping[str, str],
    affected_by: Collection[str],
    assembly: Assembly,
) -> ResolutionChoice:
    """Choose the resolution of a study without curves: double each number until the results keep their tolerance.

    Positions are doubled with coarse slices, slices with coarse positions. What the last doubling changed is taken for
    the error that is left; it bounds the error where that falls at least with the inverse of the number.

    Parameters
    ----------
    run : callable
        Computes the result of an assembly.
    controlled_outputs : mapping of str to str
        Key of [accuracy] -> variable.
    affected_by : collection of str
        Numerical choices that change the results: "slices", "n_positions".
    assembly : Assembly
        The bearing as the scene states it.

    Raises
    ------
    ConvergenceError
        If the last doubling, up to the reference resolution, exceeds the tolerance.
    """
    accuracy = assembly.scene.accuracy
    best = reference_resolution(assembly.scene)
    if accuracy.exact or not controlled_outputs:
        return ResolutionChoice(resolution=best if controlled_outputs else assembly.resolution)
    coarse = attrs.evolve(
        assembly.resolution,
        slices=accuracy.slices or _SLICE_LADDER[0],
        quadrature="equal",
        n_positions=COARSE_POSITIONS,
    )

    def solve(**number: Any) -> "xr.Dataset":
        return run(assembly.at(attrs.evolve(coarse, **number)))

    starts = {"n_positions": 1}
    if assembly.slices > 1 and accuracy.slices is None:
        starts["slices"] = _SLICE_LADDER[0]
    numbers: dict[str, Any] = {"n_positions": 1}
    errors = dict[str, Errors]()
    # slices and positions add up
    fraction = 0.5 * _FRACTIONS.discretisation
    for part, start in starts.items():
        if part not in affected_by:
            continue
        number = start
        maximum = getattr(best, part)
        result = solve(**{part: number})
        while number < maximum:
            number = min(2 * number, maximum)
            previous = result
            result = solve(**{part: number})
            errors[part] = errors_between(controlled_outputs, previous, result)
            exceeded = exceeding(errors[part], accuracy, fraction)
            if not exceeded:
                break
        else:
            raise ConvergenceError(_describe_divergence(part, maximum, exceeded))
        numbers[part] = number
    return ResolutionChoice(resolution=attrs.evolve(coarse, **numbers), errors=errors)


def _describe_divergence(part: str, maximum: int, exceeded: Errors) -> str:
    """Say what the last doubling of a number still changes, and which tolerances to raise."""
    changes = " and ".join(
        f"{name.replace('_', ' ')} by {error:.1e}"
        if math.isfinite(error)
        else f"whether {name.replace('_', ' ')} has a value"
        for name, error in exceeded.items()
    )
    raised = " and ".join(f"accuracy.{name}" for name in exceeded)
    number = f"{maximum} {_NUMBER_NAMES[part]}"
    return f"the last doubling up to {number} still changes {changes}; raise {raised}"


# After a run: a posteriori error estimate ----------------------------------------------------------------------------


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


@attrs.frozen(eq=False, kw_only=True)
class _ReferenceComparison:
    """A run, compared with reference solutions on more slices and roller positions."""

    study: DiscretisedStudy
    #: Study that gives the curves; that of the run where none does.
    curve_study: DiscretisedStudy
    #: The bearing of the run.
    assembly: Assembly
    #: The same with coarse slices; the bearing of the run where that is not finer.
    coarse: Assembly
    dataset: "xr.Dataset"
    accuracy: Accuracy
    #: Part of a contact -> whether it takes part once all that was left out is reinstated.
    complete_parts: Mapping[str, Any]

    @cached_property
    def probe(self) -> Probe:
        """The few slips at which curves are compared."""
        return Probe(self.curve_study, self.coarse)

    def solution(self, at: Assembly, n_positions: int, *, dense: bool = False) -> Any:
        """Return the curves on some positions: a dataset over all slips if the study can, else a sample of the probe.

        A dense solution is computed at more slips than it returns, since a continued curve may depend on them.
        """
        import xarray as xr

        study = self.curve_study
        stride = 1
        if study is not self.study:
            study = study.with_settings(points=_REFERENCE.sampled_slips)
        if dense and (points := getattr(study, "points", 0)):
            study = study.with_settings(points=REFERENCE_SLIP_FACTOR * (points - 1) + 1)
            stride = REFERENCE_SLIP_FACTOR
        case = study, at.at(attrs.evolve(at.resolution, n_positions=n_positions))
        results = type(study).run_batch([case], frozenset(study.controlled_outputs.values()))
        if results is None or study.curves_of is None:
            return self.probe.sample(at, n_positions)[0]
        return xr.Dataset(*results[0]).isel({study.curves_of.slip: slice(None, None, stride)})

    def errors_of(self, coarse: Any, fine: Any) -> Errors:
        """Return the relative differences of a solution from a finer one: of samples, or over all slips."""
        if isinstance(fine, tuple):
            return sample_errors(coarse, fine)
        return errors_between(self.curve_study.controlled_outputs, coarse, fine)

    def slice_errors(self, n_positions: int) -> Errors:
        """Return the errors of the slices on some positions, by four times as many Gauss points.

        Where a contact ends between slices their error falls with the square only on the whole, and twice as many may
        err alike. The probe is compared first, and all slips where its error is not clearly below the tolerance.
        """
        resolution = self.assembly.resolution
        finer = attrs.evolve(
            resolution, slices=_REFERENCE.slice_factor * resolution.slices, quadrature="gauss"
        )
        pair = self.assembly, self.assembly.at(finer)
        changes = self.errors_of(*(self.probe.sample(at, n_positions)[0] for at in pair))
        if exceeding(changes, self.accuracy, _FRACTIONS.clear):
            changes = self.errors_of(*(self.solution(at, n_positions) for at in pair))
        return {
            name: change / richardson_factor(1, _REFERENCE.slice_factor, JOINT_ORDER)
            for name, change in changes.items()
        }

    def position_errors(self, at: Assembly, orders: dict[str, float]) -> Errors:
        """Return the errors of the positions by 2 m + 1 others, and put their observed orders into a mapping.

        Of the 2 m + 1 positions only that with a roller in the line of load is among the m of the run. Curves are
        compared over all slips of the result, with the maxima that the study finds there: positions that were chosen by
        a few slips may be worse between them, and where rollers have several balances each changes balance at slips of
        its own. A continued curve is followed over three times as many slips, since it may depend on the steps. Where
        an error is not clearly below its tolerance, m/2 positions are compared, too, for the observed order: that says
        how much of the error the reference itself leaves.
        """
        m = self.assembly.resolution.n_positions or 1
        half = (m + 1) // 2
        lowest = _min_order(self.curve_study)
        reference = self.solution(at, 2 * m + 1, dense=self.curve_study.uses_continuation)
        is_known = (
            at is self.assembly
            and self.curve_study is self.study
            and not isinstance(reference, tuple)
        )
        changes = self.errors_of(self.dataset if is_known else self.solution(at, m), reference)
        if self.curve_study.uses_continuation:
            neighbour = self.errors_of(self.solution(at, m + 1), reference)
            changes = combine_errors((changes, neighbour), max)
        errors = {
            name: change / richardson_factor(m, 2 * m + 1, lowest)
            for name, change in changes.items()
        }
        if not exceeding(errors, self.accuracy, _FRACTIONS.clear):
            return errors
        coarser = self.errors_of(self.solution(at, half), reference)
        orders |= {
            name: _observed_order(half, m, coarser.get(name, 0.0), change)
            for name, change in changes.items()
        }
        return {
            name: change / richardson_factor(m, 2 * m + 1, max(orders[name], lowest))
            for name, change in changes.items()
        }

    def estimate_parts(self) -> ErrorEstimate:
        """Return the errors of slices on coarse positions, and of positions on coarse slices.

        Where they exceed the tolerance, they are estimated again with the positions and slices of the run.
        """
        errors = dict[str, Errors]()
        orders = dict[str, float]()
        estimate = ErrorEstimate(errors=errors, orders=orders, slices=self.assembly.slices)
        m = self.assembly.resolution.n_positions or 1
        if self.assembly.slices > 1:
            errors["slices"] = self.slice_errors(COARSE_POSITIONS)
        if self.curve_study.is_averaged:
            errors["n_positions"] = self.position_errors(self.coarse, orders)
        if self.accuracy.exact:
            return estimate
        is_doubtful = exceeding(
            errors.get("n_positions", {}), self.accuracy, _FRACTIONS.clear
        ) and exceeding(estimate.total, self.accuracy)
        if is_doubtful and self.coarse is not self.assembly:
            errors["n_positions"] = self.position_errors(self.assembly, orders)
        if "slices" in errors and m > COARSE_POSITIONS and exceeding(estimate.total, self.accuracy):
            errors["slices"] = self.slice_errors(min(m, COARSE_SLICES))
        return estimate

    def with_joint_errors(self, estimate: ErrorEstimate) -> ErrorEstimate:
        """Return an estimate with the errors by refining slices and positions together, and each alone.

        The reference has points of Gauss's rule, pi/2 times as many: light loads reach only the middle of a roller,
        where Gauss points lie that much farther apart than equal slices. Where run and reference agree, a second
        reference follows for single values, by the rule of the run and on other positions. Each part alone is refined
        where both together exceed the tolerance.
        """
        resolution = self.assembly.resolution
        orders = {
            name: min(max(order, MIN_ORDER), JOINT_ORDER) for name, order in estimate.orders.items()
        }
        # continued curves depend on more than the few slips of a probe
        has_curves = (
            bool(estimate.errors.get("slices"))
            and "n_positions" in estimate.errors
            and not self.curve_study.uses_continuation
        )
        n_positions = 2 * (resolution.n_positions or 1) + 1
        if resolution.slices < _REFERENCE.min_slices:
            n_positions = max(n_positions, _REFERENCE.min_positions)
        density = 2.0 if resolution.quadrature == "gauss" else math.pi
        slices = max(math.ceil(density * resolution.slices), _REFERENCE.min_slices)
        more_slices = attrs.evolve(resolution, slices=slices, quadrature="gauss")
        both = attrs.evolve(more_slices, n_positions=n_positions, **self.complete_parts)
        joint: Errors = self._refined_errors(both, orders, has_curves)
        # run and reference may err alike by chance; a second reference hardly does as well
        is_small = not exceeding(joint, self.accuracy)
        if is_small and exceeding(joint, self.accuracy, _FRACTIONS.chance):
            second = attrs.evolve(
                resolution,
                slices=2 * resolution.slices + 1,
                n_positions=n_positions + 1,
                **self.complete_parts,
            )
            joint = combine_errors((joint, self._refined_errors(second, orders, False)), max)
        separate: Mapping[str, Errors] = {}
        if exceeding(_reducible(joint, self.study), self.accuracy):
            finer = {
                "slices": more_slices,
                "n_positions": attrs.evolve(resolution, n_positions=n_positions),
                LEFT_OUT: attrs.evolve(resolution, **self.complete_parts),
            }
            separate = {
                part: self._refined_errors(finer[part], orders, has_curves)
                for part in (*estimate.errors, LEFT_OUT)
                if finer[part] != resolution
            }
        return attrs.evolve(estimate, joint_errors=joint, separate_errors=separate)

    def _refined_errors(
        self, finer: Resolution, orders: Mapping[str, float], has_curves: bool
    ) -> dict[str, float]:
        """Return the errors of single values, and of curves at the slips of the probe, against a finer resolution."""
        at = self.assembly.at(finer)
        changes = dict(self.study.value_errors(at, self.dataset))
        if has_curves:
            samples = (
                self.probe.sample(assembly, assembly.resolution.n_positions or 1)[0]
                for assembly in (self.assembly, at)
            )
            changes = {**self.errors_of(*samples), **changes}
        return {
            name: change / richardson_factor(1, 2, orders.get(name, JOINT_ORDER))
            for name, change in changes.items()
        }


def estimate_error(
    study: DiscretisedStudy,
    assembly: Assembly,
    choice: ResolutionChoice,
    dataset: "xr.Dataset",
    first: ErrorEstimate | None = None,
) -> ErrorEstimate:
    """Return the a posteriori error estimate of a result by reference solutions.

    Slices and positions may err against each other, so that at the slips of the probe, and for single values of the
    result, both are refined together, with the models of a contact that were left out. Of a study without curves the
    single values alone are compared, if it has any.

    Parameters
    ----------
    study : DiscretisedStudy
        The study that was run.
    assembly : Assembly
        The bearing at the resolution of the run, without bounds on what is left out.
    choice : ResolutionChoice
        The choice by which the resolution was found.
    dataset : xarray.Dataset
        The result.
    first : ErrorEstimate, optional
        Estimate of the first run, where this one was made again.

    Returns
    -------
    ErrorEstimate
        Without errors, and with a `refusal`, where a reference solution cannot be computed; without both where the
        error of the study is not estimated.
    """
    if not study.has_error_estimate(assembly):
        return ErrorEstimate(errors={})
    accuracy = assembly.scene.accuracy
    curve_study = study.curve_study(assembly)
    coarse = coarse_assembly(assembly)
    if coarse.slices >= assembly.slices or (curve_study and curve_study.uses_continuation):
        # of two maxima of nearly the same height coarse slices may have another one for the largest
        coarse = assembly
    complete = choice.complete_resolution
    comparison = _ReferenceComparison(
        study=study,
        curve_study=curve_study or study,
        assembly=assembly,
        coarse=coarse,
        dataset=dataset,
        accuracy=accuracy,
        complete_parts={name: getattr(complete, name) for name in _CONTACT_PARTS},
    )
    try:
        if curve_study is not None:
            estimate = comparison.estimate_parts()
        elif assembly.slices == 1:
            estimate = ErrorEstimate(errors={"n_positions": {}})
        else:
            estimate = ErrorEstimate(errors={"slices": {}, "n_positions": {}})
        if not accuracy.exact:
            estimate = comparison.with_joint_errors(estimate)
    except ConvergenceError as refusal:  # what was computed stands
        return ErrorEstimate(errors={}, refusal=str(refusal))
    return with_observed_slice_order(estimate, first)


def with_observed_slice_order(
    estimate: ErrorEstimate, first: ErrorEstimate | None
) -> ErrorEstimate:
    """Return an estimate by the observed order of slices, from a first run with fewer of them.

    Where a film thins without bound as a slice is relieved, the error falls with the root of their number.

    Parameters
    ----------
    estimate : ErrorEstimate
        Estimate of the present run.
    first : ErrorEstimate or None
        Estimate of the first run; None if this is the first.
    """
    slices = estimate.errors.get("slices", {})
    if first is None or not slices or estimate.slices <= first.slices:
        return estimate
    before = first.errors.get("slices", {})
    factor = _REFERENCE.slice_factor
    errors = {}
    for name, error in slices.items():
        order = _observed_order(first.slices, estimate.slices, before.get(name, 0.0), error)
        errors[name] = error * richardson_factor(1, factor) / richardson_factor(1, factor, order)
    return attrs.evolve(estimate, errors={**estimate.errors, "slices": errors})


def refine_resolution(
    study: DiscretisedStudy, assembly: Assembly, choice: ResolutionChoice, error: ErrorEstimate
) -> ResolutionChoice | None:
    """Return the resolution with which a run whose error exceeds its tolerance is made again.

    What was left out of a contact is reinstated first, if that leaves much. Otherwise slices and positions get as many
    more as their errors require, by the second order for slices and the observed order for positions, four times as
    many at most.

    Parameters
    ----------
    study : DiscretisedStudy
        The study that was run.
    assembly : Assembly
        The bearing at the resolution of the run.
    choice : ResolutionChoice
        The choice by which the resolution was found.
    error : ErrorEstimate
        The estimated error of the run.

    Returns
    -------
    ResolutionChoice or None
        None where the run is not made again: its error keeps the tolerance, or no number may grow, or it would have too
        many slices, or the study does not compute the curves itself.
    """
    accuracy = assembly.scene.accuracy
    exceeded = exceeding(_reducible(error.total, study), accuracy)
    if not exceeded or not study.may_run_again(assembly):
        return None
    excess = " and ".join(
        f"{name.replace('_', ' ')} off by {size:.1e}" for name, size in exceeded.items()
    )
    by_models = exceeding(error.separate_errors.get(LEFT_OUT, {}), accuracy, _FRACTIONS.refined)
    if exceeded.keys() & by_models.keys():
        return _with_contact_parts(choice, excess)
    numbers = resolution_numbers(choice.resolution)
    limits = resolution_numbers(reference_resolution(assembly.scene))
    finished = [part for part in error.errors if numbers[part] >= limits[part]]
    if exceeded.keys() <= exceeding(_errors_of_parts(error, finished), accuracy).keys():
        return None
    joint_factors = _joint_factors(error, {name: accuracy.of(name) for name in exceeded})
    refined: dict[str, Any] = dict(numbers)
    remaining = dict[str, Errors]()
    for part, errors in error.errors.items():
        orders = _assumed_orders(study, part, error)
        factors = [
            (errors[name] / (_FRACTIONS.refined * accuracy.of(name))) ** (1.0 / orders[name])
            for name in errors
            if name in exceeded
        ]
        factor = min(max(1.0, joint_factors[part], *factors), _MAX_FACTOR)
        refined[part] = max(min(math.ceil(factor * numbers[part]), limits[part]), numbers[part])
        if errors:
            remaining[part] = {
                name: size * (numbers[part] / refined[part]) ** orders[name]
                for name, size in errors.items()
            }
    n_slices = assembly.scene.bearing.rollers * math.prod(refined.values())
    if refined == numbers or n_slices > _MAX_SLICES:
        return None
    first = " and ".join(f"{numbers[part]} {_NUMBER_NAMES[part]}" for part in error.errors)
    return attrs.evolve(
        choice,
        resolution=attrs.evolve(choice.resolution, **refined),
        errors={**choice.errors, **remaining},
        refinement_reason=f"{first} were seen to leave {excess}",
    )


def _assumed_orders(study: DiscretisedStudy, part: str, error: ErrorEstimate) -> dict[str, float]:
    """Return the orders of the errors of a part: the second for slices, the observed ones for positions."""
    lowest = MAX_ORDER if part == "slices" else _min_order(study)
    return {
        name: max(min(error.orders.get(name, _ASSUMED_ORDER), MAX_ORDER), lowest)
        for name in error.errors[part]
    }


def _with_contact_parts(choice: ResolutionChoice, excess: str) -> ResolutionChoice:
    """Return a choice with all that was left out of a contact reinstated; `excess` says what that left."""
    reinstated = (*_CONTACT_PARTS, "law")
    return attrs.evolve(
        choice,
        resolution=choice.complete_resolution,
        left_out=(),
        errors={part: errors for part, errors in choice.errors.items() if part not in reinstated},
        refinement_reason=f"what was left out of a contact was seen to leave {excess}",
    )


def _errors_of_parts(error: ErrorEstimate, parts: Sequence[str]) -> Errors:
    """Return the larger one of the errors of some parts, estimated with coarse numbers and by refining each alone."""
    estimates = (error.errors, error.separate_errors)
    return combine_errors((errors.get(part, {}) for part in parts for errors in estimates), max)


def _joint_factors(error: ErrorEstimate, tolerances: Errors) -> dict[str, float]:
    """Return how many times as many of each part the joint errors require.

    They are computed from the error of each part alone; where these are too small to explain a joint error, all parts
    grow alike.
    """
    parts = [*error.errors]
    factors = dict.fromkeys(parts, 0.0)
    for name, tolerance in tolerances.items():
        separate = {part: error.separate_errors.get(part, {}).get(name, 0.0) for part in parts}
        for part, size in separate.items():
            others = sum(separate[other] for other in parts if other != part)
            rest = max(
                2.0 * _FRACTIONS.refined * tolerance - others, _FRACTIONS.refined * tolerance
            )
            factors[part] = max(factors[part], math.sqrt(size / rest))
        if max(factors.values()) <= 1.0:
            joint = error.joint_errors.get(name, 0.0)
            factors = dict.fromkeys(
                parts, math.sqrt(joint / (2.0 * _FRACTIONS.refined * tolerance))
            )
    return factors


def _reducible(errors: Errors, study: DiscretisedStudy) -> Errors:
    """Return the errors that a finer run reduces."""
    return {name: error for name, error in errors.items() if name not in study.irreducible_errors}


def resolution_numbers(resolution: Resolution) -> dict[str, int]:
    """Return the numbers of slices and roller positions of a resolution, by the names of its fields."""
    return {"slices": resolution.slices, "n_positions": resolution.n_positions or 1}
