"""Fit parameters of an oil and of a traction model to friction measured on a traction rig.

1. Fit all requested parameters by least squares (`rollslip_campaigns.fit.least_squares`).
2. Take the parameters without any limit at 95 %. Change each alone by a factor of ten either way; its effect is the
   largest change of friction.
3. If the smallest effect does not exceed the scatter of the data, fix this parameter at its initial value, state so in
   its status, and go on at step 1 without it. Otherwise stop.
"""

import math
import time
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Final

import numpy as np

from rollslip.errors import DomainError
from rollslip.fields import FieldError
from rollslip.results.dataset import xr
from rollslip.search import Array
from rollslip_campaigns.fit import FitSettings
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

__all__ = ["plan_fit", "run_fit"]

#: Factor by which a parameter is changed either way, to estimate its effect on friction. Doubling it fixes fewer
#: parameters at their initial values. Chosen: on a logarithmic scale half of the range that is searched.
EFFECT_FACTOR: Final = 10.0


def plan_fit(requested: "FitSettings") -> tuple[RigProblem, list[Parameter]]:
    """Return the problem that a data file and a rig file state, and the parameters to fit."""
    data = requested.data if isinstance(requested.data, RigData) else read_data(requested.data)
    rig = requested.rig
    if not isinstance(rig, Rig):
        rig = load_rig(Path(data.source).with_name("rig.toml") if rig is None else rig)
    problem = rig_problem(data, rig, requested.traction, requested.film)
    return problem, parameters_named(problem, requested.parameters)


def run_fit(problem: RigProblem, requested: list[Parameter], report: Report) -> "xr.Dataset":
    """Return the fit of the requested parameters.

    Parameters
    ----------
    problem : RigProblem
        Measured contacts with oil and models.
    requested : list of Parameter
        Parameters to fit; those that the data do not determine are fixed.
    report : callable
        Receives the progress: a text, and the fraction that is done.
    """
    start = time.perf_counter()
    free = requested
    fixed = dict[str, str]()
    largest = float(np.abs(problem.data.columns["friction"]).max())
    while True:
        fit = fit_parameters(problem, free, fixed, report=report)
        # of parameters without a limit, the one with the smallest effect is fixed first
        effects = {
            k: _effect(fit, k)
            for k, profile in enumerate(fit.estimate.profiles)
            if not np.isfinite(profile.limits[-1]).any()
        }
        k, (effect, ends) = min(
            effects.items(), key=lambda item: item[1][0], default=(0, (math.inf, ""))
        )
        scatter = float(np.sqrt(np.mean(fit.sigma**2)))
        if effect > scatter:
            return dataset_of(problem, fit, requested, time.perf_counter() - start)
        fixed[free[k].name] = (
            f"not determined, kept at {free[k].format(free[k].start)}: from {ends} it changes friction by at most "
            f"{100 * effect / largest:.2g} % of its largest value, the data scatter by {100 * scatter / largest:.2g} %"
        )
        free = [p for p in free if p is not free[k]]


def fit_parameters(
    problem: RigProblem,
    free: list[Parameter],
    fixed: Mapping[str, str] = {},
    *,
    profiles: bool = True,
    report: Report = lambda text, fraction: None,
) -> Fit:
    """Return the fit of some parameters.

    Parameters
    ----------
    problem : RigProblem
        Measured contacts with oil and models.
    free : list of Parameter
        Parameters to fit.
    fixed : mapping
        Statuses of parameters that are not fitted, by name.
    profiles : bool
        Whether likelihood profiles are followed.
    report : callable
        Receives the progress.
    """
    measured = problem.data.columns["friction"]
    uncertainty = problem.data.columns.get("friction_uncertainty")
    # without uncertainties all rows have the same weight; the size keeps residuals of order 1
    size = float(np.sqrt(np.mean(measured**2))) or 1.0
    weight = np.full(measured.size, size) if uncertainty is None else uncertainty
    return Fit(
        problem=problem,
        parameters=free,
        weight=weight,
        fixed=dict(fixed),
        estimate=estimate(
            partial(misfit, problem, free, weight),
            *bounds_of(free),
            known=uncertainty is not None,
            profiles=profiles,
            report=report,
        ),
    )


def _effect(fit: Fit, k: int) -> tuple[float, str]:
    """Return the largest change of friction by parameter k alone, and its range; infinite if the law has no value."""
    parameter = fit.parameters[k]
    best = fit.estimate.best.x
    changes = list[Array]()
    ends = list[str]()
    friction = fit.friction(best)
    for sign in (-1.0, 1.0):
        x = best.copy()
        x[k] = np.clip(
            x[k] + sign * math.log(EFFECT_FACTOR),
            parameter.x(parameter.low),
            parameter.x(parameter.high),
        )
        ends.append(parameter.format(parameter.value(x[k])))
        try:
            changes.append(fit.friction(x) - friction)
        except (FieldError, DomainError):
            return math.inf, ""
    return float(np.abs(changes).max()), " to ".join(ends)
