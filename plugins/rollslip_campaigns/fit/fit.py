"""Fits parameters of an oil and of a traction model to what a traction rig has measured.

A parameter that the data do not see is not fitted but kept, and said to be.
"""

import math
import time
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from rollslip.errors import DomainError
from rollslip.fields import FieldError
from rollslip.search import Array
from rollslip_campaigns.fit.least_squares import Report, estimate
from rollslip_campaigns.fit.problem import (
    Parameter,
    RigProblem,
    bounds_of,
    misfit,
    parameters_named,
    rig_problem,
)
from rollslip_campaigns.fit.result import Fit, dataset_of
from rollslip_campaigns.measurement.rig import Rig, RigData, load_rig, read_data

if TYPE_CHECKING:
    import xarray as xr

    from rollslip_campaigns.fit import FitSettings

__all__ = ["plan_fit", "run_fit"]

#: Factor by which a parameter is moved either way, to see whether the data see it at all.
VARIED: Final = 10.0


def plan_fit(requested: "FitSettings") -> tuple[RigProblem, list[Parameter]]:
    """Read data and rig, and return the problem with what is to be fitted."""
    read = requested.data if isinstance(requested.data, RigData) else read_data(requested.data)
    rig = requested.rig
    if not isinstance(rig, Rig):
        rig = load_rig(Path(read.source).with_name("rig.toml") if rig is None else rig)
    problem = rig_problem(read, rig, requested.traction, requested.film)
    return problem, parameters_named(problem, requested.parameters)


def run_fit(problem: RigProblem, wanted: list[Parameter], report: Report) -> "xr.Dataset":
    """Fit."""
    begin = time.perf_counter()
    fitted = _fit(problem, wanted, report)
    return dataset_of(problem, fitted, wanted, time.perf_counter() - begin)


def _fit(problem: RigProblem, wanted: list[Parameter], report: Report) -> Fit:
    """Fit, and again without the parameters that turn out not to matter, one by one."""
    free = wanted
    kept = dict[str, str]()
    largest = float(np.abs(problem.data.columns["friction"]).max())
    while True:
        fitted = fit_parameters(problem, free, kept, report=report)
        unlimited = [
            k
            for k, profile in enumerate(fitted.estimate.profiles)
            if not np.isfinite(profile.limits[-1]).any()
        ]
        effects = {k: _effect(fitted, k) for k in unlimited}
        k, (effect, ends) = min(
            effects.items(), key=lambda item: item[1][0], default=(0, (math.inf, ""))
        )
        scatter = float(np.sqrt(np.mean(fitted.sigma**2)))
        if effect > scatter:
            return fitted
        kept[free[k].name] = (
            f"not determined, kept at {free[k].shown(free[k].start)}: from {ends} it changes friction by at most "
            f"{100 * effect / largest:.2g} % of its largest value, the data scatter by {100 * scatter / largest:.2g} %"
        )
        free = [p for p in free if p is not free[k]]


def fit_parameters(
    problem: RigProblem,
    free: list[Parameter],
    kept: Mapping[str, str] = {},
    *,
    profiles: bool = True,
    report: Report = lambda text, fraction: None,
) -> Fit:
    """Fit some parameters, all of them, with or without their profiles."""
    measured = problem.data.columns["friction"]
    uncertainty = problem.data.columns.get("friction_uncertainty")
    # without uncertainties all rows weigh alike; the size keeps residuals of order 1
    size = float(np.sqrt(np.mean(measured**2))) or 1.0
    weight = np.full(measured.size, size) if uncertainty is None else uncertainty
    residuals = partial(misfit, problem, free, weight)
    known = uncertainty is not None
    estimated = estimate(residuals, *bounds_of(free), known=known, profiles=profiles, report=report)
    return Fit(problem=problem, parameters=free, weight=weight, kept=dict(kept), estimate=estimated)


def _effect(fitted: Fit, k: int) -> tuple[float, str]:
    """Largest change of friction by a parameter alone, infinite where the law has no value, and how far it moved."""
    parameter = fitted.parameters[k]
    best = fitted.estimate.best.x
    changes = list[Array]()
    ends = list[str]()
    here = fitted.friction(best)
    for sign in (-1.0, 1.0):
        x = best.copy()
        x[k] = np.clip(
            x[k] + sign * math.log(VARIED), parameter.x(parameter.low), parameter.x(parameter.high)
        )
        ends.append(parameter.shown(parameter.value(x[k])))
        try:
            changes.append(fitted.friction(x) - here)
        except (FieldError, DomainError):
            return math.inf, ""
    return float(np.abs(changes).max()), " to ".join(ends)
