"""What is reported of the error of a run: its a posteriori estimate, and on request its difference to a finer run."""

import json
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from rollslip.bearing.assembly import assemble
from rollslip.bearing.resolution import reference_resolution
from rollslip.planning.plan import Plan
from rollslip.scene.values import EXACT, Accuracy
from rollslip.studies.error_estimate import (
    MAX_ORDER,
    MIN_ORDER,
    REFERENCE_SLIP_FACTOR,
    ErrorEstimate,
    errors_between,
    exceeding,
    resolution_numbers,
)

if TYPE_CHECKING:
    import xarray as xr


def error_warnings(plan: Plan, study: str, error: ErrorEstimate) -> list[str]:
    """Return where the error of a run exceeds its tolerance, or is not known to keep it, with what to type."""
    accuracy = plan.scene.accuracy
    of_slices = error.errors.get("slices", {}) if accuracy.slices is not None else {}
    warnings = list[str]()
    if error.refusal:
        warnings.append(
            f"how far this is off could not be judged, as on more slices or positions {error.refusal}"
        )
    for result, size in exceeding(error.total, accuracy).items():
        # "exact" is the finest, whatever it leaves; slices that the scene fixes have a warning of their own
        if accuracy.of(result) == EXACT or of_slices.get(result, 0.0) > accuracy.of(result):
            continue
        if result in plan.studies[study].irreducible_errors:
            warnings.append(
                f"{result} is off by {size:.1e} at most: it is that just before one jumps, between two positions"
            )
        else:
            warnings.append(
                f"{_excess(result, size, accuracy, error)}; {_remedy(plan, study, result, size, error)}"
            )
    return warnings


def _excess(result: str, size: float, accuracy: Accuracy, error: ErrorEstimate) -> str:
    """Say by how much a result is off, and how that falls with the positions where it is known."""
    name = result.replace("_", " ")
    if not math.isfinite(size):
        return f"how far {name} is off cannot be determined: on other positions or slices there is none"
    falls = ""
    if result in error.orders:
        falls = f"; it falls with the order {error.orders[result]:.1f} of the positions"
        if error.orders[result] < MIN_ORDER:
            falls = "; it does not fall with the positions"
    return (
        f"{name} is off by about {size:.1e}, more than the tolerance of {accuracy.of(result):g}, as positions and "
        f"slices other than those of the run show{falls}"
    )


def _remedy(plan: Plan, study: str, result: str, size: float, error: ErrorEstimate) -> str:
    """Say what to type so that a result keeps its tolerance."""
    accuracy = plan.scene.accuracy
    running = plan.studies[study]
    tolerance = accuracy.of(result)
    key = result if hasattr(accuracy, result) else "tolerance"
    numbers = resolution_numbers(plan.choices[study].resolution)
    most = resolution_numbers(reference_resolution(plan.scene))
    if accuracy.slices is not None and result in error.joint_errors:  # which slices may leave, too
        remedy = "raise accuracy.slices, or let a plan choose by --set accuracy.slices=auto"
    elif all(numbers[part] >= most[part] for part in error.errors):
        remedy = f"raise accuracy.{key}; this is the finest that a plan takes"
    else:
        order = min(max(error.orders.get(result, MAX_ORDER), MIN_ORDER), MAX_ORDER)
        ratio = max(size / tolerance, 2.0) if math.isfinite(size) else 10.0
        finer = 0.5 * tolerance * ratio ** (-2.0 / order)
        remedy = (
            f"type --set accuracy.{key}={finer:.0e}"
            if finer > EXACT
            else "type --set accuracy.tolerance=exact"
        )
    if (
        result == "critical_slip"
        and running.uses_continuation
        and (points := getattr(running, "points", 0))
    ):
        remedy += f", or go along more slips by --set {running.table}.points={REFERENCE_SLIP_FACTOR * points - 2}"
    return remedy


def verify(plan: Plan, study: str, dataset: "xr.Dataset") -> "xr.Dataset":
    """Return a result that says what it is off from the same at the finest resolution, which is run for that.

    A study whose finest would take days is held against one four times as fine, whose error is a sixteenth. Attribute
    ``accuracy`` then holds actual errors, and a warning tells of a tolerance not kept.
    """
    running = plan.studies[study]
    running = running.without_outputs(
        frozenset(running.outputs.keys() - set(running.controlled_outputs.values()))
    )
    resolution, how = running.verification_resolution(plan.scene, plan.choices[study].resolution)
    fine = running.with_resolution(resolution).run(assemble(plan.scene, resolution))
    found = errors_between(running.controlled_outputs, dataset, fine)
    rows = accuracy_rows(plan, study, found, how)
    broken = [
        f"{row['result'].replace('_', ' ')} is off by {row['found']:.1e} of the finest result, more than the "
        f"tolerance of {row['tolerance']:g}; run with a smaller accuracy.{row['result']}"
        for row in rows
        if row["found"] is not None and row["found"] > row["tolerance"]
    ]
    broken += [
        f"{result.replace('_', ' ')} has a value either here or in the finest result, but not in both; run with a "
        f"smaller accuracy.{result}"
        for result, error in found.items()
        if error == math.inf
    ]
    told = json.dumps([*broken, *json.loads(dataset.attrs["warnings"])])
    return dataset.assign_attrs(accuracy=json.dumps(rows), warnings=told)


def accuracy_rows(
    plan: Plan, study: str, found: Mapping[str, float], how: str
) -> list[dict[str, Any]]:
    """Return rows of result, tolerance, estimated error and the error that was found."""
    estimated = plan.choices[study].total

    def number(errors: Mapping[str, float], result: str) -> float | None:
        return errors[result] if math.isfinite(errors.get(result, math.inf)) else None

    return [
        {
            "result": result,
            "tolerance": plan.scene.accuracy.of(result),
            "estimated": number(estimated, result),
            "found": number(found, result),
            "how": how,
        }
        for result in dict.fromkeys((*estimated, *found))
    ]
