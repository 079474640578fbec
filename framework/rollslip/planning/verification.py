"""Whether a plan kept its word: errors measured afterwards, against finer runs."""

import json
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import attrs

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.planning.plan import Plan
from rollslip.studies.answers import Errors, Estimated
from rollslip.studies.estimates import FEW, SOME, Probe, difference, errors_between
from rollslip.studies.study import Study

if TYPE_CHECKING:
    import xarray as xr


def judge(study: Study, assembly: Assembly, estimated: Estimated) -> Mapping[str, Errors]:
    """Return what slices and instants leave, measured afterwards where they were chosen: against twice as many each.

    What the doubling moves is 3/4 of an error that falls with the square. Of a study without curves nothing is known
    beyond its own estimate.
    """
    curved, resolution = study.curved(assembly), estimated.resolution
    if resolution.instants is None or curved is None:
        return {}
    few = assembly.at(attrs.evolve(resolution, slices=min(FEW, assembly.slices), quadrature="equal"))
    probe, moved = Probe(curved, few), dict[str, Errors]()
    if assembly.slices > 1:
        finer = assembly.at(attrs.evolve(resolution, slices=2 * resolution.slices))
        moved["slices"] = difference(probe.measure(assembly, (SOME,))[0], probe.measure(finer, (SOME,))[0])
    if curved.averaged:
        moved["instants"] = difference(*probe.measure(few, (resolution.instants, 2 * resolution.instants)))
    return {part: {name: error / 0.75 for name, error in errors.items()} for part, errors in moved.items()}


def verify(plan: Plan, study: str, dataset: "xr.Dataset") -> "xr.Dataset":
    """Return a result that says what it is off from the same at the finest resolution, which is run for that.

    A study whose finest would take days is held against one four times as fine, whose error is a sixteenth. Attribute
    ``accuracy`` then holds actual errors, and a warning tells of a tolerance not kept.

    Parameters
    ----------
    plan : Plan
        What was run.
    study : str
        The study.
    dataset : Dataset
        Its result.
    """
    running = plan.studies[study]
    running = running.without(frozenset(running.outputs.keys() - set(running.judged.values())))
    resolution, how = running.finer(plan.scene, plan.estimated[study].resolution)
    fine = running.at(resolution).run(assemble(plan.scene, resolution))
    found = errors_between(running.judged, dataset, fine)
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


def accuracy_rows(plan: Plan, study: str, found: Mapping[str, float], how: str) -> list[dict[str, Any]]:
    """Return rows of result, tolerance, estimated error and the error that was found."""
    estimated = plan.estimated[study].total

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
