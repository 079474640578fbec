"""Compute a point of a sweep as ``rollslip run`` does: by a plan of its own, with the error of its values, and bands.

- An output NAME gets NAME_error, its relative discretisation error a posteriori, if the study estimates it. It is
  infinite where a finer bearing has no such value. ``error_status`` says why a point has no errors.
- With bands, slip and minimum load get NAME_low and NAME_high, their 5 and 95 % bounds by what scatters. An upper bound
  is infinite where the cage skids within its band.
"""

import json
import math
from typing import Any, Final

import numpy as np

from rollslip.planning.execution import compute
from rollslip.planning.plan import plan
from rollslip.results.dataset import about
from rollslip.results.text import Status
from rollslip.scene.values import Scene
from rollslip.studies.outputs import Values, selected_values
from rollslip.studies.study import Study
from rollslip_campaigns.sweep.definition import SweepWork

__all__ = ["evaluate_as_run"]

#: Bands of a result by the name of the slip in them.
_BAND_OF_SLIP: Final = "steady_slip"


def evaluate_as_run(scene: Scene, work: SweepWork) -> Values:
    """Return the outputs of a point with their errors, and bands on request.

    Parameters
    ----------
    scene : Scene
        The scene of the point.
    work : SweepWork
        Study, outputs, and whether there are bands.
    """
    executed = compute(plan(scene, work.study), work.study)
    study = executed.plan.studies[work.study]
    dataset = executed.dataset
    if work.bands:
        dataset = study.with_bands(scene, executed.documented())
    variables, coords, attributes = selected_values(study, dataset, work.outputs)
    added = dict[str, Any]()
    errors = executed.error.total
    for name in variables:
        known = [errors[key] for key in _error_keys(study, name) if key in errors]
        if known:
            added[f"{name}_error"] = _single(
                known[0], "1", f"relative error of {name}, a posteriori"
            )
    status = executed.error.refusal or str(Status.FOUND)
    added["error_status"] = _single(status, "1", "what was found of the errors")
    for name, band in json.loads(dataset.attrs.get("band", "{}")).items():
        output = _output_of_band(study, name)
        if output not in variables:
            continue
        for bound, meaning in (("low", "5 % bound of"), ("high", "95 % bound of")):
            value = math.inf if band[bound] is None else band[bound]
            unit = study.outputs[output].unit
            added[f"{output}_{bound}"] = _single(value, unit, f"{meaning} {output}, by its scatter")
    return {**variables, **added}, coords, attributes


def _single(value: object, unit: str, meaning: str) -> tuple[tuple[str, ...], Any, dict[str, Any]]:
    """Return a single value as a variable."""
    return (), np.asarray(value), about(unit, meaning)


def _error_keys(study: Study, name: str) -> list[str]:
    """Return the keys under which errors of a result may have that of an output: of [accuracy], or its names."""
    controlled = [key for key, output in study.controlled_outputs.items() if output == name]
    names = (name, *study.outputs[name].aliases)
    return [*(name.replace("_", " ") for name in names), *controlled]


def _output_of_band(study: Study, name: str) -> str:
    """Return the output that a band is of: the steady slip has another name in some studies."""
    slips = (
        output
        for output, about in study.outputs.items()
        if {"slip", "cage_slip"} & {*about.aliases}
    )
    return next(slips, name) if name == _BAND_OF_SLIP else name
