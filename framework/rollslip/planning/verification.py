"""Report the discretisation error of a run: by its a posteriori estimate, and with ``--verify`` by a finer run."""

import json
import math
from collections.abc import Mapping
from typing import Any, Final

from rollslip.bearing.assembly import assemble
from rollslip.bearing.resolution import Errors, reference_resolution, resolution_numbers
from rollslip.planning.plan import Plan
from rollslip.results.curves import or_none
from rollslip.results.dataset import xr
from rollslip.scene.values import EXACT, Accuracy
from rollslip.studies.bounds import (
    MAX_ORDER,
    MIN_ORDER,
    ErrorEstimate,
    errors_between,
    exceeding,
    reference_slips,
)

#: Ratio of error and tolerance that is taken at least when a smaller tolerance is proposed: with a smaller one the next
#: plan may have the same numbers, and the user types in vain. Doubled, the next run is up to 1.4 times as fine at
#: second order. Chosen.
_MIN_RATIO: Final = 2.0
#: Ratio that is taken where the error is not known. Doubled, the proposed tolerance is half as large at second order.
#: Chosen: with `_PROPOSED_FRACTION` there are then 4.5 times as many points.
_UNKNOWN_RATIO: Final = 10.0
#: Fraction of the tolerance by which the proposed one keeps a distance. With 1 the next run may just exceed it again.
_PROPOSED_FRACTION: Final = 0.5


def error_warnings(plan: Plan, study: str, error: ErrorEstimate) -> list[str]:
    """Return the warnings on errors that exceed their tolerances, or are not known, with what to type.

    Parameters
    ----------
    plan : Plan
        The plan by which the result was computed.
    study : str
        Name of the study.
    error : ErrorEstimate
        The estimated error of the result.
    """
    accuracy = plan.scene.accuracy
    by_stated_slices: Errors = {}
    if accuracy.slices is not None:
        by_stated_slices = exceeding(error.errors.get("slices", {}), accuracy)
    warnings = list[str]()
    if error.refusal:
        warnings.append(
            f"the discretisation error is not known, as on more slices or positions {error.refusal}"
        )
    if by_stated_slices:
        result = max(by_stated_slices, key=lambda name: by_stated_slices[name] / accuracy.of(name))
        warnings.append(
            f"{accuracy.slices} slices leave a relative error of about {by_stated_slices[result]:.1e} of "
            f"{result.replace('_', ' ')}, more than the tolerance of {accuracy.of(result):g}; raise "
            "accuracy.slices, or let a plan choose by --set accuracy.slices=auto"
        )
    irreducible = plan.studies[study].irreducible_errors
    for result, relative_error in exceeding(error.total, accuracy).items():
        # "exact" is the reference resolution, whatever error it leaves; slices that the scene states have their warning
        if accuracy.of(result) == EXACT or result in by_stated_slices:
            continue
        if result in irreducible:
            warnings.append(f"{result} errs by {relative_error:.1e} at most: {irreducible[result]}")
        else:
            excess = _excess(result, relative_error, accuracy, error)
            warnings.append(f"{excess}; {_remedy(plan, study, result, relative_error, error)}")
    return warnings


def _excess(result: str, relative_error: float, accuracy: Accuracy, error: ErrorEstimate) -> str:
    """Return the clause on the error of a result, and on its order of convergence where that is known."""
    name = result.replace("_", " ")
    if not math.isfinite(relative_error):
        return f"how far {name} is off cannot be determined: on other positions or slices there is none"
    convergence = ""
    if result in error.orders:
        convergence = f"; it falls with the order {error.orders[result]:.1f} of the positions"
        if error.orders[result] < MIN_ORDER:
            convergence = "; it does not fall with the positions"
    return (
        f"{name} errs by about {relative_error:.1e}, more than the tolerance of {accuracy.of(result):g}, as "
        f"positions and slices other than those of the run show{convergence}"
    )


def _remedy(
    plan: Plan, study_name: str, result: str, relative_error: float, error: ErrorEstimate
) -> str:
    """Return the clause on what to type so that a result keeps its tolerance.

    A tolerance is proposed from the observed order p of the positions. The numbers of a plan follow its tolerance with
    the second order, while the error falls with order p: to lower the error by a ratio r, the tolerance has to fall by
    r^(2/p).
    """
    accuracy = plan.scene.accuracy
    study = plan.studies[study_name]
    tolerance = accuracy.of(result)
    key = result if hasattr(accuracy, result) else "tolerance"
    numbers = resolution_numbers(plan.choices[study_name].resolution)
    limits = resolution_numbers(reference_resolution(plan.scene))
    # the stated slices may be the cause of a joint error, and no tolerance changes them
    if accuracy.slices is not None and result in error.joint_errors:
        remedy = "raise accuracy.slices, or let a plan choose by --set accuracy.slices=auto"
    elif all(numbers[part] >= limits[part] for part in error.errors):
        remedy = f"raise accuracy.{key}; this is the finest that a plan takes"
    else:
        order = min(max(error.orders.get(result, MAX_ORDER), MIN_ORDER), MAX_ORDER)
        ratio = _UNKNOWN_RATIO
        if math.isfinite(relative_error):
            ratio = max(relative_error / tolerance, _MIN_RATIO)
        finer = _PROPOSED_FRACTION * tolerance * ratio ** (-2.0 / order)
        remedy = "type --set accuracy.tolerance=exact"
        if finer > EXACT:
            remedy = f"type --set accuracy.{key}={finer:.0e}"
    if (
        result == "critical_slip"
        and study.uses_continuation
        and (points := getattr(study, "points", 0))
    ):
        remedy += (
            f", or go along more slips by --set {study.table}.points={reference_slips(points)}"
        )
    return remedy


def verify(plan: Plan, study: str, dataset: "xr.Dataset") -> "xr.Dataset":
    """Return a result with its actual errors, by a run at the finest resolution.

    A study whose finest run would take days is compared with one four times as fine, whose error is a sixteenth if it
    falls with the second order (`MAX_ORDER`), and a half at the lowest order (`MIN_ORDER`).

    Parameters
    ----------
    plan : Plan
        The plan by which the result was computed.
    study : str
        Name of the study.
    dataset : xarray.Dataset
        The result.

    Returns
    -------
    xarray.Dataset
        The result, with actual errors in the attribute ``accuracy``, and a warning for each tolerance that is exceeded.
    """
    whole = plan.studies[study]
    controlled = whole.without_outputs(
        frozenset(whole.outputs.keys() - set(whole.controlled_outputs.values()))
    )
    resolution, method = controlled.verification_resolution(
        plan.scene, plan.choices[study].resolution
    )
    finer = controlled.with_resolution(resolution)
    assembly = assemble(plan.scene, resolution)
    fine = finer.completed(assembly, finer.run(assembly))
    errors = errors_between(controlled.controlled_outputs, dataset, fine)
    rows = accuracy_rows(plan, study, errors, method)
    exceeded = [
        f"{row['result'].replace('_', ' ')} errs by {row['found']:.1e} {method}, more than the tolerance of "
        f"{row['tolerance']:g}; run with a smaller accuracy.{row['result']}"
        for row in rows
        if row["found"] is not None and row["found"] > row["tolerance"] > EXACT
    ]
    exceeded += [
        f"{result.replace('_', ' ')} has a value either here or in the finer result, but not in both; run with a "
        f"smaller accuracy.{result}"
        for result, error in errors.items()
        if error == math.inf
    ]
    exceeded += json.loads(dataset.attrs["warnings"])
    return dataset.assign_attrs(accuracy=json.dumps(rows), warnings=json.dumps(exceeded))


def accuracy_rows(
    plan: Plan, study: str, actual: Mapping[str, float], method: str
) -> list[dict[str, Any]]:
    """Return rows of result, tolerance, planned error and actual error; an error that is not finite is None.

    A row has the planned error as "estimated", the actual one as "found", and the method of the latter as "how".

    Parameters
    ----------
    plan : Plan
        The plan by which the result was computed.
    study : str
        Name of the study.
    actual : mapping of str to float
        Errors that were found after the run.
    method : str
        How these were found.
    """
    planned = plan.choices[study].total
    return [
        {
            "result": result,
            "tolerance": plan.scene.accuracy.of(result),
            "estimated": or_none(planned.get(result, math.inf)),
            "found": or_none(actual.get(result, math.inf)),
            "how": method,
        }
        for result in dict.fromkeys((*planned, *actual))
    ]
