"""Estimate the discretisation error of a study after a run, by reference solutions, and refine a run that exceeds it.

The estimate uses the slips of a probe (`rollslip.studies.discretisation.choice.Probe`), and none of the solutions and
bounds by which the resolution was chosen.

1. Compare with four times as many slices, and with 2 m + 1 positions instead of m. They have one position in common.
   `rollslip.studies.bounds` has how much finer each reference solution is.
2. Divide the difference by 1 - (n/N)^p, the fraction of the error of n points which it shows (Richardson
   extrapolation).
3. Where that is not clearly below the tolerance, repeat with m/2 positions for the observed order p.
4. Refine slices and positions together, since both errors may cancel; and each alone where that exceeds the tolerance.
5. Where the estimate exceeds the tolerance, `refine_resolution` returns the numbers with which to run again.

References
----------
P. J. Roache, Perspective: a method for uniform reporting of grid refinement studies, J. Fluids Eng. 116 (1994) 405-413:
observed order, Richardson extrapolation and the grid convergence index.
"""

import math
from collections.abc import Mapping
from functools import cached_property
from typing import Any, Final

import attrs

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.resolution import (
    Errors,
    Resolution,
    combine_errors,
    reference_resolution,
    resolution_numbers,
)
from rollslip.errors import ConvergenceError
from rollslip.results.dataset import xr
from rollslip.scene.values import Accuracy
from rollslip.studies.answers import ResolutionChoice
from rollslip.studies.bounds import (
    ASSUMED_ORDER,
    JOINT_FACTOR,
    JOINT_ORDER,
    MAX_ORDER,
    MIN_ORDER,
    SLICE_FACTOR,
    SLIP_FACTOR,
    ErrorEstimate,
    Sample,
    errors_between,
    exceeding,
    joint_references,
    observed_order,
    position_fraction,
    reference_positions,
    reference_slips,
    richardson_factor,
    sample_errors,
    with_observed_slice_order,
)
from rollslip.studies.discretisation.choice import (
    COARSE_POSITIONS,
    GRID_SLIPS,
    NUMBER_NAMES,
    POSITION_LADDER,
    SIMPLIFICATIONS,
    DiscretisedStudy,
    Probe,
    coarse_assembly,
)

# Fractions of the tolerance of a result from which estimates are doubted, and at which refined runs aim. All are
# chosen. They trade the cost of a run against the number of runs that exceed their tolerance; docs/trust/plan has these
# numbers for random scenes.

#: Below which an error is believed without its order, and slices are compared at the slips of the probe alone. Doubled,
#: fewer runs are compared with a third number of positions, and an order that is lower than assumed is noticed only
#: nearer to the tolerance. Chosen: an error of three times its estimate keeps the tolerance.
_CLEAR_FRACTION: Final = 0.3
#: From which an error that keeps its tolerance by one joint reference may do so by chance, so that a second reference
#: is computed. Below it the error is believed. Doubled, 539 in place of 293 of the 831 random runs of
#: docs/tables/promise.csv save the second reference. Chosen: the actual errors of those 293 are 0.13 of the tolerance
#: at most, so that a run whose error is seven times as large still keeps it.
_CHANCE_FRACTION: Final = 0.15
#: At which slices and positions aim, each, where a run is made again: both stay below the tolerance together, at 0.7 of
#: it, with some room for an order that is lower than the observed one. Halved, numbers are twice as
#: large at order 1; doubled, both together exceed the tolerance.
_REFINED_FRACTION: Final = 0.35

# Orders --------------------------------------------------------------------------------------------------------------

#: Lowest order that is taken for the mean over positions of a continued curve, in place of `MIN_ORDER`: each roller
#: jumps somewhere between two positions, so that the error falls at least with the inverse of their number. Two numbers
#: of positions that show less do so by chance. With `MIN_ORDER` errors would be estimated up to 1.7 times as large,
#: with 2 up to a third smaller.
_JUMP_ORDER: Final = 1.0

# Runs that are made again --------------------------------------------------------------------------------------------

#: Name of the part of an error that comes from models left out, which the probe did not show to be needed.
LEFT_OUT: Final = "left out"
#: Parts of a contact that may be left out, as fields of a resolution.
_CONTACT_PARTS: Final = ("inlet_heating", "light_contacts")
#: How many times as many slices or positions a run has at most that is made again. Chosen; with 8 a doubtful order may
#: ask for far more than is needed, while a run that is still off after 4 is made again anyway. With 2 no error of
#: order 1 that exceeds its tolerance would reach its aim.
_MAX_FACTOR: Final = 4.0
#: Slices of all rollers over an orbit at most with which a run is made again: some seconds of effective friction, and
#: up to a minute of steady slips with their check. Beyond, the error is only reported. Doubled, such runs take up to
#: twice as long. Chosen; a limit of time would let the result depend on the machine.
_MAX_SLICES: Final = 500_000


def _min_order(study: DiscretisedStudy) -> float:
    """Return the order with which errors of roller positions fall at least."""
    return _JUMP_ORDER if study.uses_continuation else MIN_ORDER


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

    @cached_property
    def own_sample(self) -> Sample:
        """The sample of the probe at the resolution of the run."""
        return self.probe.sample(self.assembly, self.assembly.resolution.n_positions or 1)[0]

    def solution(self, at: Assembly, n_positions: int, *, dense: bool = False) -> Any:
        """Return the curves on some positions: a dataset over all slips if the study can, else a sample of the probe.

        A dense solution is computed at more slips than it returns, since a continued curve may depend on them.
        """
        import xarray as xr

        study = self.curve_study
        stride = 1
        if study is not self.study:
            # the result has no curves: those of the other study on the grid of the probe, its intervals halved
            study = study.with_settings(points=2 * GRID_SLIPS - 1)
        if dense and (points := getattr(study, "points", 0)):
            study = study.with_settings(points=reference_slips(points))
            stride = SLIP_FACTOR
        results = type(study).run_batch(
            [(study, at.at(attrs.evolve(at.resolution, n_positions=n_positions)))],
            frozenset(study.controlled_outputs.values()),
        )
        if results is None or study.curves_of is None:
            return self.probe.sample(at, n_positions)[0]
        return xr.Dataset(*results[0]).isel({study.curves_of.slip: slice(None, None, stride)})

    def errors_of(self, coarse: Any, fine: Any) -> Errors:
        """Return the relative differences of a solution from a finer one: of samples, or over all slips."""
        study = self.curve_study
        if isinstance(fine, tuple):
            errors = sample_errors(coarse, fine)
        else:
            errors = errors_between(study.controlled_outputs, coarse, fine)
        return {name: errors[name] for name in errors if name not in study.compared_as_values}

    def slice_errors(self, n_positions: int) -> Errors:
        """Return the errors of the slices on some positions, by four times as many Gauss points.

        Where a contact ends between slices their error falls with the square only on the whole, and twice as many may
        err alike. The probe is compared first, and all slips where its error is not clearly below the tolerance.
        """
        resolution = self.assembly.resolution
        finer = attrs.evolve(
            resolution, slices=SLICE_FACTOR * resolution.slices, quadrature="gauss"
        )
        pair = self.assembly, self.assembly.at(finer)
        changes = self.errors_of(*(self.probe.sample(at, n_positions)[0] for at in pair))
        if (
            exceeding(changes, self.accuracy, _CLEAR_FRACTION)
            and self.curve_study.curves_of is not None
        ):
            changes = self.errors_of(*(self.solution(at, n_positions) for at in pair))
        return {
            name: change / richardson_factor(1, SLICE_FACTOR) for name, change in changes.items()
        }

    def position_errors(self, at: Assembly, orders: dict[str, float]) -> Errors:
        """Return the errors of the positions by 2 m + 1 others, and put their observed orders into a mapping.

        With S(m) a curve on m positions and p its order, its error is |S(m) - S(2 m + 1)|/(1 - (m/(2 m + 1))^p). At
        first p is the lowest order. Where that error is not clearly below its tolerance, p is observed.

        Of the 2 m + 1 positions only that with a roller in the line of load is among the m of the run. Curves are
        compared over all slips of the result, with the maxima that the study finds there: positions that were chosen by
        a few slips may be worse between them, and where rollers have several balances each changes balance at slips of
        its own. A continued curve is followed over three times as many slips, since it may depend on the steps; it is
        compared on m + 1 positions, too, and the larger difference counts.
        """
        m = self.assembly.resolution.n_positions or 1
        lowest = _min_order(self.curve_study)
        reference = self.solution(
            at, reference_positions(m), dense=self.curve_study.uses_continuation
        )
        is_known = (
            at is self.assembly
            and self.curve_study is self.study
            and not isinstance(reference, tuple)
        )
        changes = self.errors_of(self.dataset if is_known else self.solution(at, m), reference)
        if self.curve_study.uses_continuation:
            others = self.errors_of(self.solution(at, m + 1), reference)
            changes = combine_errors((changes, others), max)
        errors = {name: change / position_fraction(m, lowest) for name, change in changes.items()}
        if not exceeding(errors, self.accuracy, _CLEAR_FRACTION):
            return errors
        orders |= self.observed_orders(at, changes, reference)
        return {
            name: change / position_fraction(m, max(orders[name], lowest))
            for name, change in changes.items()
        }

    def observed_orders(self, at: Assembly, changes: Errors, reference: Any) -> dict[str, float]:
        """Return the orders with which differences from a reference fall from half of the positions to all of them.

        A single position has no half, and its order is assumed.
        """
        m = self.assembly.resolution.n_positions or 1
        half = (m + 1) // 2
        coarser = self.errors_of(self.solution(at, half), reference) if half < m else {}
        return {
            name: observed_order(half, m, coarser.get(name, 0.0), changes[name]) for name in changes
        }

    def estimate_parts(self) -> ErrorEstimate:
        """Return the errors of slices on coarse positions, and of positions on coarse slices.

        Where they exceed the tolerance, they are estimated again with the positions and slices of the run, those of
        slices on the largest number of `POSITION_LADDER` at most: with more the comparison takes longer. They are
        empty for a study whose results are all compared as values.
        """
        errors = dict[str, Errors]()
        orders = dict[str, float]()
        estimate = ErrorEstimate(errors=errors, orders=orders, slices=self.assembly.slices)
        m = self.assembly.resolution.n_positions or 1
        if self.curve_study.controlled_outputs.keys() <= self.curve_study.compared_as_values:
            errors |= {"slices": {}, "n_positions": {}}
            return estimate
        if self.assembly.slices > 1:
            errors["slices"] = self.slice_errors(COARSE_POSITIONS)
        if self.curve_study.is_averaged:
            errors["n_positions"] = self.position_errors(self.coarse, orders)
        if self.accuracy.exact:
            return estimate
        if (
            self.coarse is not self.assembly
            and exceeding(errors.get("n_positions", {}), self.accuracy, _CLEAR_FRACTION)
            and exceeding(estimate.total, self.accuracy)
        ):
            errors["n_positions"] = self.position_errors(self.assembly, orders)
        if "slices" in errors and m > COARSE_POSITIONS and exceeding(estimate.total, self.accuracy):
            errors["slices"] = self.slice_errors(min(m, POSITION_LADDER[-1]))
        return estimate

    def with_joint_errors(self, estimate: ErrorEstimate) -> ErrorEstimate:
        """Return an estimate with the errors by refining slices and positions together, and each alone.

        Where they keep the tolerance, but exceed `_CHANCE_FRACTION` of it, a second reference follows for single
        values. Each part alone is refined where both together exceed the tolerance. An observed order of the positions
        counts for joint errors and for those of slices, too, if it is below `JOINT_ORDER`: it makes them larger. Joint
        errors contain those of what was left out, as if these fell with that order.
        """
        resolution = self.assembly.resolution
        orders = {
            name: min(max(order, MIN_ORDER), JOINT_ORDER) for name, order in estimate.orders.items()
        }
        # continued curves depend on more than the few slips of a probe
        is_probed = not self.curve_study.uses_continuation and self.curve_study.is_averaged
        has_curves = is_probed and bool(estimate.errors.get("slices"))
        gauss_numbers, same_rule_numbers = joint_references(
            self.assembly.slices, resolution.n_positions or 1, resolution.quadrature
        )
        finer = {
            "slices": attrs.evolve(resolution, slices=gauss_numbers[0], quadrature="gauss"),
            "n_positions": attrs.evolve(resolution, n_positions=gauss_numbers[1]),
            LEFT_OUT: attrs.evolve(resolution, **self.complete_parts),
        }
        all_refined = attrs.evolve(
            finer["slices"], n_positions=gauss_numbers[1], **self.complete_parts
        )
        joint: Errors = self._refined_errors(all_refined, orders, has_curves)
        # run and reference may err alike by chance; a second reference hardly does as well
        if not exceeding(joint, self.accuracy) and exceeding(
            joint, self.accuracy, _CHANCE_FRACTION
        ):
            cross_check = attrs.evolve(
                finer[LEFT_OUT], slices=same_rule_numbers[0], n_positions=same_rule_numbers[1]
            )
            joint = combine_errors((joint, self._refined_errors(cross_check, orders, False)), max)
        separate: Mapping[str, Errors] = {}
        if exceeding(_reducible(joint, self.study), self.accuracy):
            separate = {
                part: self._refined_errors(finer[part], orders, has_curves)
                for part in (*estimate.errors, LEFT_OUT)
                if finer[part] != resolution
            }
        return attrs.evolve(estimate, joint_errors=joint, separate_errors=separate)

    def _refined_errors(
        self, finer: Resolution, orders: Mapping[str, float], has_curves: bool
    ) -> dict[str, float]:
        """Return the errors of single values, and of curves at the slips of the probe, against a finer resolution.

        A reference with the same numbers, and with all models, shows the whole error of what was left out, without a
        factor of Richardson's.
        """
        at = self.assembly.at(finer)
        changes = dict(self.study.value_errors(at, self.dataset))
        if has_curves:
            fine = self.probe.sample(at, finer.n_positions or 1)[0]
            changes = {**self.errors_of(self.own_sample, fine), **changes}
        if resolution_numbers(finer) == resolution_numbers(self.assembly.resolution):
            return changes
        return {
            name: change / richardson_factor(1, JOINT_FACTOR, orders.get(name, JOINT_ORDER))
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
        # no cheaper, or coarse slices may have another one of two maxima of nearly the same height for the largest
        coarse = assembly
    comparison = _ReferenceComparison(
        study=study,
        curve_study=curve_study or study,
        assembly=assembly,
        coarse=coarse,
        dataset=dataset,
        accuracy=accuracy,
        complete_parts={name: getattr(choice.complete_resolution, name) for name in _CONTACT_PARTS},
    )
    try:
        estimate = ErrorEstimate(
            errors={part: {} for part in NUMBER_NAMES if part != "slices" or assembly.slices > 1}
        )
        if curve_study is not None:
            estimate = comparison.estimate_parts()
        if not accuracy.exact:
            estimate = comparison.with_joint_errors(estimate)
    except ConvergenceError as refusal:  # what was computed stands
        return ErrorEstimate(errors={}, refusal=str(refusal))
    return with_observed_slice_order(estimate, first)


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
    aims = {name: _REFINED_FRACTION * accuracy.of(name) for name in exceeded}
    excess = " and ".join(
        f"{name.replace('_', ' ')} off by {exceeded[name]:.1e}" for name in exceeded
    )
    by_models = error.separate_errors.get(LEFT_OUT, {})
    if exceeded.keys() & exceeding(by_models, accuracy, _REFINED_FRACTION).keys():
        return _with_contact_parts(choice, excess)
    numbers = resolution_numbers(choice.resolution)
    limits = resolution_numbers(reference_resolution(assembly.scene))
    finished = [part for part in error.errors if numbers[part] >= limits[part]]
    # parts that are as fine as the reference exceed the tolerance alone
    if exceeded.keys() <= exceeding(error.of_parts(finished), accuracy).keys():
        return None
    refined, remaining = _refined_numbers(study, error, aims, numbers, limits)
    # a bearing of one slice has no error of slices, and its resolution any number of them
    size = assembly.scene.bearing.rollers * math.prod(refined[part] for part in error.errors)
    if refined == numbers or size > _MAX_SLICES:
        return None
    first = " and ".join(f"{numbers[part]} {NUMBER_NAMES[part]}" for part in error.errors)
    return attrs.evolve(
        choice,
        resolution=attrs.evolve(choice.resolution, **refined),
        errors={**choice.errors, **remaining},
        refinement_reason=f"{first} were seen to leave {excess}",
    )


def _refined_numbers(
    study: DiscretisedStudy,
    error: ErrorEstimate,
    aims: Errors,
    numbers: Mapping[str, int],
    limits: Mapping[str, int],
) -> tuple[dict[str, Any], dict[str, Errors]]:
    """Return numbers of slices and positions with which each part keeps its aim, and the errors that these leave.

    With E the error of n points and p its order, an aim A needs (E/A)^(1/p) times as many. Where a joint error needs
    more (`ErrorEstimate.joint_factors`), that counts.

    Parameters
    ----------
    study : DiscretisedStudy
        The study that was run.
    error : ErrorEstimate
        The estimated error of the run.
    aims : mapping of str to float
        Relative error that each part may leave, by result.
    numbers, limits : mapping of str to int
        Numbers of the run and of the reference resolution, by part.
    """
    joint_factors = error.joint_factors(aims)
    refined: dict[str, Any] = dict(numbers)
    remaining = dict[str, Errors]()
    for part, errors in error.errors.items():
        orders = _assumed_orders(study, part, error)
        factors = [
            (errors[name] / aims[name]) ** (1.0 / orders[name]) for name in errors if name in aims
        ]
        factor = min(max(1.0, joint_factors[part], *factors), _MAX_FACTOR)
        refined[part] = max(min(math.ceil(factor * numbers[part]), limits[part]), numbers[part])
        if errors:
            ratio = numbers[part] / refined[part]
            remaining[part] = {name: errors[name] * ratio ** orders[name] for name in errors}
    return refined, remaining


def _assumed_orders(study: DiscretisedStudy, part: str, error: ErrorEstimate) -> dict[str, float]:
    """Return the orders of the errors of a part: the second for slices, the observed ones for positions."""
    if part == "slices":
        return dict.fromkeys(error.errors[part], MAX_ORDER)
    lowest = _min_order(study)
    return {
        name: max(min(error.orders.get(name, ASSUMED_ORDER), MAX_ORDER), lowest)
        for name in error.errors[part]
    }


def _with_contact_parts(choice: ResolutionChoice, excess: str) -> ResolutionChoice:
    """Return a choice with all that was left out of a contact reinstated; `excess` says what that left."""
    return attrs.evolve(
        choice,
        resolution=choice.complete_resolution,
        left_out=(),
        errors={part: choice.errors[part] for part in choice.errors if part not in SIMPLIFICATIONS},
        refinement_reason=f"what was left out of a contact was seen to leave {excess}",
    )


def _reducible(errors: Errors, study: DiscretisedStudy) -> Errors:
    """Return the errors that a finer run reduces."""
    return {name: error for name, error in errors.items() if name not in study.irreducible_errors}
