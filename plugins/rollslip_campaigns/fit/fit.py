"""Fits parameters of an oil and of a traction model to what a traction rig has measured.

A parameter that the data do not see is not fitted but kept, and said to be.
"""

import math
import os
import time
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from rollslip.errors import DomainError
from rollslip.fields import FieldError
from rollslip.measurement.rig import Rig, RigData, load_rig, read_data
from rollslip_campaigns.fit.least_squares import Report, estimate
from rollslip_campaigns.fit.problem import Array, Parameter, Raw, RigProblem, friction_at, parameters_named, rig_problem
from rollslip_campaigns.fit.result import Fit, dataset_of

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["fit"]

#: Factor by which a parameter is moved either way, to see whether the data see it at all.
VARIED: Final = 10.0


def fit(
    data: str | os.PathLike[str] | RigData,
    *,
    parameters: str | Iterable[str],
    traction: Raw | None = None,
    film: Raw | None = None,
    rig: str | os.PathLike[str] | Rig | None = None,
    report: Report = lambda text, share: None,
) -> "xr.Dataset":
    """Fit parameters of an oil and of a traction model to the data of a traction rig.

    Parameters
    ----------
    data : str, path or RigData
        Data file, see `rollslip.measurement.rig.read_data`.
    parameters : iterable of str
        What to fit, or the names separated by commas: values and factors of the oil ("eyring_stress",
        "pressure_viscosity", "viscosity_factor") and parameters of the traction model ("flash",
        "hydrodynamic.flash"). They start from the values of the rig file.
    traction, film : str, mapping or model, optional
        Models, by default those of the rig file.
    rig : str, path or Rig, optional
        Rig file, by default ``rig.toml`` beside the data.
    report : callable
        Told how far it is, in words and as a share.

    Returns
    -------
    xarray.Dataset
        Per parameter value, standard_error, interval (level, side), status and limit_status in words, profile;
        covariance and correlation; principal directions with their spread; where the searches ended; per row fitted
        friction and residual; a curve for each operating point. `rollslip_campaigns.fit.oil.write_oil` makes an oil of
        it.

    Raises
    ------
    SceneError
        If the data, the rig or the names of the parameters are wrong; all faults of a file at once.
    PluginError
        If a model or the oil does not exist or cannot be loaded.
    ConvergenceError
        If the fit does not converge.
    """
    begin = time.perf_counter()
    read = data if isinstance(data, RigData) else read_data(data)
    if not isinstance(rig, Rig):
        rig = load_rig(Path(read.source).with_name("rig.toml") if rig is None else rig)
    problem = rig_problem(read, rig, traction, film)
    wanted = parameters_named(problem, parameters)
    fitted = _fit(problem, wanted, report)
    return dataset_of(problem, fitted, wanted, time.perf_counter() - begin)


def _fit(problem: RigProblem, wanted: list[Parameter], report: Report) -> Fit:
    """Fit, and again without the parameters that turn out not to matter, one by one."""
    free, kept = wanted, dict[str, str]()
    largest = float(np.abs(problem.data.columns["friction"]).max())
    while True:
        fitted = fit_parameters(problem, free, kept, report=report)
        unlimited = [
            k for k, profile in enumerate(fitted.estimate.profiles) if not np.isfinite(profile.limits[-1]).any()
        ]
        effects = {k: _effect(fitted, k) for k in unlimited}
        k, (effect, ends) = min(effects.items(), key=lambda item: item[1][0], default=(0, (math.inf, "")))
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
    report: Report = lambda text, share: None,
) -> Fit:
    """Fit some parameters, all of them, with or without their profiles."""
    measured = problem.data.columns["friction"]
    uncertainty = problem.data.columns.get("friction_uncertainty")
    # without uncertainties all rows weigh alike; the size keeps residuals of order 1
    size = float(np.sqrt(np.mean(measured**2))) or 1.0
    weight = np.full(measured.size, size) if uncertainty is None else uncertainty

    def residuals(x: Array) -> Array:
        try:
            return np.asarray((friction_at(problem, free, x) - measured) / weight)
        except (FieldError, DomainError):
            return np.full(measured.size, np.nan)

    low, high = np.array([p.x(p.low) for p in free]), np.array([p.x(p.high) for p in free])
    estimated = estimate(residuals, low, high, known=uncertainty is not None, profiles=profiles, report=report)
    return Fit(problem=problem, parameters=free, weight=weight, kept=dict(kept), estimate=estimated)


def _effect(fitted: Fit, k: int) -> tuple[float, str]:
    """Largest change of friction by a parameter alone, infinite where the law has no value, and how far it moved."""
    parameter, best, changes, ends = fitted.parameters[k], fitted.estimate.best.x, list[Array](), list[str]()
    here = fitted.friction(best)
    for sign in (-1.0, 1.0):
        x = best.copy()
        x[k] = np.clip(x[k] + sign * math.log(VARIED), parameter.x(parameter.low), parameter.x(parameter.high))
        ends.append(parameter.shown(parameter.value(x[k])))
        try:
            changes.append(fitted.friction(x) - here)
        except (FieldError, DomainError):
            return math.inf, ""
    return float(np.abs(changes).max()), " to ".join(ends)
