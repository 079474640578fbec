"""Write a fit as a dataset, with statuses and warnings.

- A value that the data do not determine is NaN, with a status that says so.
- Intervals are those of the profile likelihood; the covariance is stored as well.
- The oil is the ``[lubricant]`` table of the rig file with the fitted values, and is read in the same way.
"""

import hashlib
import importlib.metadata
import json
from collections.abc import Collection, Sequence
from functools import reduce
from pathlib import Path
from typing import Any, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.catalogue.registry import find
from rollslip.lubricant.oil import Lubricant
from rollslip.models import SliceModel, TractionModel
from rollslip.planning.provenance import (
    collect_citations,
    describe_citations,
    describe_lubricant,
    describe_models,
    origin,
    packages_of,
)
from rollslip.results.dataset import about, xr
from rollslip.search import Array
from rollslip.structure import resolved
from rollslip.studies import validity
from rollslip.units import format_quantity
from rollslip_campaigns.fit.findings import DETERMINED, UNKNOWN, parameter_rows
from rollslip_campaigns.fit.least_squares import LEVELS, PROFILE_POINTS, LeastSquaresEstimate, Stop
from rollslip_campaigns.fit.problem import (
    Indices,
    Parameter,
    RigProblem,
    friction_at,
    operating_points,
    with_values,
)
from rollslip_kernels.slices import Slices

__all__ = ["Fit", "dataset_of"]

#: Points of a drawn curve; doubling it changes figures and files only. Chosen.
CURVE_POINTS: Final = 201
#: Probability below which a deviation is not attributed to chance, in the tests of chi2 and of signs of residuals.
#: Doubling it doubles the fraction of good fits with a warning. Chosen, a usual level of significance.
_SIGNIFICANCE: Final = 0.01
#: Slide-roll ratio of a contact with one surface at rest; above it, surfaces run against each other.
_MAX_SLIDE_ROLL = 2.0
#: Fraction of the largest friction below which residuals are rounding, so that their order says nothing. Doubling it
#: changes nothing for measured data.
_RESIDUAL_ROUNDING = 1e-9
#: Component of a parameter in the weakest principal direction above which the status names this parameter. Doubling it
#: names fewer parameters; chosen.
_MIN_COMPONENT = 0.1
#: Rise of chi2, in variances, above which another minimum is a different one; below, searches ended beside each other.
#: Doubling it changes nothing for separate minima. Chosen.
_MIN_OTHER_RISE = 0.01


@attrs.frozen(eq=False, kw_only=True)
class Fit:
    """Estimate of the parameters that the data determine, and the statuses of those that were fixed."""

    problem: RigProblem
    parameters: list[Parameter]
    weight: Array
    fixed: dict[str, str]
    estimate: LeastSquaresEstimate

    @property
    def values(self) -> list[float]:
        """The fitted values."""
        return self.values_at(self.estimate.best.x)

    @property
    def laws(self) -> tuple[Lubricant, TractionModel]:
        """Oil and traction model with the fitted values."""
        return with_values(self.problem, self.parameters, self.values)

    @property
    def sigma(self) -> Array:
        """Standard deviation of the friction of each row, given or estimated."""
        return self.estimate.scale * self.weight

    def values_at(self, x: Array) -> list[float]:
        """Return the values of the parameters at coordinates."""
        return [
            float(p.value(coordinate)) for p, coordinate in zip(self.parameters, x, strict=True)
        ]

    def friction(self, x: Array) -> Array:
        """Return the friction of all rows at coordinates, (rows,)."""
        return friction_at(self.problem, self.parameters, x)


# Dataset ------------------------------------------------------------------------------------------------------------


def dataset_of(
    problem: RigProblem, fit: Fit, requested: Sequence[Parameter], wall_time: float
) -> "xr.Dataset":
    """Return a fit as a dataset.

    Parameters
    ----------
    problem : RigProblem
        Measured contacts with oil and models.
    fit : Fit
        The fit of those parameters that the data determine.
    requested : sequence of Parameter
        All parameters that were requested.
    wall_time : float
        Time [s] of the fit.

    Returns
    -------
    xarray.Dataset
        See `rollslip.fit`. Standard errors and limits that the data do not determine are NaN; ``status`` and
        ``limit_status`` say why.
    """
    # this evaluation also stores the film in the tables of the problem
    fitted_friction = fit.friction(fit.estimate.best.x)
    film = np.empty(len(problem.data))
    for _, rows, slices in problem.tables:
        film[rows] = slices.film_thickness
    sets = operating_points(problem)
    point = np.empty(len(problem.data), dtype=np.intp)
    for k, rows in enumerate(sets):
        point[rows] = k
    c = problem.data.columns
    variables = {
        **_parameter_variables(fit, requested),
        **_search_variables(fit),
        "slide_roll_ratio": ("row", c["slide_roll_ratio"], about("1", "slide-roll ratio")),
        "rolling_speed": ("row", c["rolling_speed"], about("m/s", "rolling speed")),
        "load_per_length": ("row", problem.load, about("N/m", "normal force per length")),
        "temperature": ("row", c["temperature"], about("K", "temperature")),
        "film_thickness": ("row", film, about("m", "film thickness")),
        "friction": ("row", c["friction"], about("1", "friction coefficient")),
        "fitted_friction": ("row", fitted_friction, about("1", "fitted friction coefficient")),
        "residual": (
            "row",
            c["friction"] - fitted_friction,
            about("1", "measured less fitted friction"),
        ),
        "uncertainty": (
            "row",
            fit.sigma,
            about("1", "standard deviation of the friction, given or estimated"),
        ),
        "operating_point": ("row", point, about("1", "operating point")),
        "line": ("row", np.array(problem.data.lines), about("1", "line of the data file")),
        **_curves(fit, sets),
    }
    names, determined = ([p.name for p in parameters] for parameters in (requested, fit.parameters))
    dataset = xr.Dataset(
        variables,
        coords={
            "parameter": ("parameter", np.array(names, dtype=str), about("1", "parameter")),
            "with_parameter": (
                "with_parameter",
                np.array(names, dtype=str),
                about("1", "parameter"),
            ),
            "fitted_parameter": (
                "fitted_parameter",
                np.array(determined, dtype=str),
                about("1", "parameter that the data see"),
            ),
            "level": ("level", np.array(LEVELS), about("1", "level of confidence")),
            "side": ("side", np.array(["lower", "upper"]), about("1", "side of an interval")),
        },
    )
    known = "friction_uncertainty" in c
    dataset.attrs |= {
        "freedom": fit.estimate.freedom,
        "scatter": float(np.sqrt(np.mean(dataset["residual"].to_numpy() ** 2))),
        "uncertainties": "given" if known else "estimated from the residuals",
        "warnings": json.dumps(_warnings(fit, sets)),
        "wall_time": wall_time,
    }
    if known:  # otherwise chi2 has no scale
        dataset.attrs["chi2"] = fit.estimate.best.chi2
    dataset.attrs |= _provenance(fit, dataset)
    return dataset


def _parameter_variables(fit: Fit, requested: Sequence[Parameter]) -> dict[str, Any]:
    """Return the variables of all parameters; a fixed one has a value and a status only."""
    estimate = fit.estimate
    parameters = fit.parameters
    position = [requested.index(p) for p in parameters]
    unit = "see unit"
    n = len(requested)
    points = 2 * PROFILE_POINTS + 1

    def for_all(values: Any, *shape: int) -> Array:
        expanded = np.full((n, *shape), np.nan)
        expanded[position] = np.array(values, dtype=float).reshape(len(parameters), *shape)
        return expanded

    value = np.array([p.start for p in requested])
    value[position] = fit.values
    # covariances are of the logarithm, or of the value itself where the sign may change
    size = np.array([1.0 if p.logarithmic else p.size for p in parameters])
    covariance = np.full((n, n), np.nan)
    covariance[np.ix_(position, position)] = estimate.covariance * np.outer(size, size)
    error = np.sqrt(np.diag(covariance))
    profiles = list(zip(parameters, estimate.profiles, strict=True))
    status, limit_status = _all_statuses(fit, requested)
    absolute = error * np.array(
        [v if p.logarithmic else 1.0 for p, v in zip(requested, value, strict=True)]
    )
    return {
        "unit": (
            "parameter",
            np.array([p.unit for p in requested], dtype=str),
            about("1", "unit of the parameter"),
        ),
        "meaning": (
            "parameter",
            np.array([p.doc for p in requested], dtype=str),
            about("1", "what the parameter is"),
        ),
        "start_value": (
            "parameter",
            [p.start for p in requested],
            about(unit, "value before the fit"),
        ),
        "value": ("parameter", value, about(unit, "value")),
        "standard_error": (
            "parameter",
            np.where(np.array(status) == DETERMINED, absolute, np.nan),
            about(unit, "standard error after the covariance"),
        ),
        "interval": (
            ("parameter", "level", "side"),
            for_all([p.value(profile.limits) for p, profile in profiles], len(LEVELS), 2),
            about(unit, "interval of confidence after the profile likelihood"),
        ),
        "status": ("parameter", np.array(status, dtype=str), about("1", "what the data determine")),
        "limit_status": (
            ("parameter", "side"),
            np.array(limit_status, dtype=str),
            about("1", "whether the data give a limit"),
        ),
        "covariance": (
            ("parameter", "with_parameter"),
            covariance,
            about("1", "covariance of the logarithms, of the values where the sign may change"),
        ),
        "correlation": (
            ("parameter", "with_parameter"),
            covariance / np.outer(error, error),
            about("1", "correlation"),
        ),
        "profile_value": (
            ("parameter", "profile_point"),
            for_all([p.value(profile.x) for p, profile in profiles], points),
            about(unit, "fixed value"),
        ),
        "profile_rise": (
            ("parameter", "profile_point"),
            for_all([profile.rise for _, profile in profiles], points),
            about("1", "rise of chi2 over the variance"),
        ),
        "rise_limit": (
            "level",
            np.array(estimate.quantiles),
            about("1", "rise at which an interval ends"),
        ),
    }


def _all_statuses(fit: Fit, requested: Sequence[Parameter]) -> tuple[list[str], list[list[str]]]:
    """Return the statuses of all requested parameters, and those of their lower and upper limits."""
    estimate = fit.estimate
    statuses = {
        name: (status, ["not determined", "not determined"]) for name, status in fit.fixed.items()
    }
    for parameter, profile in zip(fit.parameters, estimate.profiles, strict=True):
        has_limit = np.isfinite(profile.limits[-1])
        sides = ["found", "found"]
        for k, side in enumerate(("lower", "upper")):
            if not has_limit[k]:
                end = parameter.format(parameter.value(profile.ends[k]))
                sides[k] = _describe_open_side(fit, side, end, profile.stops[k])
        if has_limit.all():
            status = DETERMINED
        elif has_limit.any():
            status = sides[int(np.argmin(has_limit))]
        else:
            weakest = np.abs(estimate.directions[int(np.argmax(estimate.spread))])
            partners = [
                p.name
                for p, component in zip(fit.parameters, weakest, strict=True)
                if component > _MIN_COMPONENT
            ]
            together = f"only a combination of {' and '.join(partners)} is"
            status = f"not determined: {together if len(partners) > 1 else '; '.join(sides)}"
        statuses[parameter.name] = (status, sides)
    return [statuses[p.name][0] for p in requested], [statuses[p.name][1] for p in requested]


def _search_variables(fit: Fit) -> dict[str, Any]:
    """Return the variables of the ends of all searches, and of the principal directions."""
    estimate = fit.estimate
    ends = np.full((len(estimate.others), 2, len(fit.parameters)), np.nan)
    chi2 = np.full(len(estimate.others), np.nan)
    for k, minimum in enumerate(estimate.others):
        if minimum is not None:
            ends[k] = [fit.values_at(minimum.start), fit.values_at(minimum.x)]
            chi2[k] = minimum.chi2
    return {
        "search_start": (
            ("search", "fitted_parameter"),
            ends[:, 0],
            about("see unit", "where a search started"),
        ),
        "search_end": (
            ("search", "fitted_parameter"),
            ends[:, 1],
            about("see unit", "where it ended"),
        ),
        "search_chi2": ("search", chi2, about("1", "sum of squares where it ended")),
        "spread": (
            "direction",
            estimate.spread,
            about("1", "standard deviation along a principal direction"),
        ),
        "direction_part": (
            ("direction", "fitted_parameter"),
            estimate.directions,
            about("1", "part of a parameter's logarithm in a principal direction"),
        ),
    }


def _describe_open_side(fit: Fit, side: str, end: str, stop: Stop) -> str:
    """Return the status of a side without a limit: how far was searched, and what stopped the search."""
    if stop is None:
        return f"the {side} limit {UNKNOWN}: searched to {end}, the law has no value beyond"
    if not stop:
        return f"the data give no {side} limit, searched to {end}"
    bounded = [fit.parameters[j] for j in stop]
    ranges = " and ".join(
        f"{p.name} (searched from {p.format(p.low)} to {p.format(p.high)})" for p in bounded
    )
    return (
        f"the {side} limit {UNKNOWN}: searched to {end}, beyond which {ranges} would have to leave its range; start "
        f"{' or '.join(p.name for p in bounded)} elsewhere, or fit without it"
    )


def _curves(fit: Fit, sets: Sequence[Indices]) -> dict[str, Any]:
    """Return the fitted curve of each operating point at its mean conditions, and these conditions."""
    problem = fit.problem
    lubricant, traction = fit.laws
    chain = problem.chain_of(traction)
    c = problem.data.columns
    slip = np.empty((len(sets), CURVE_POINTS))
    friction = np.empty((len(sets), CURVE_POINTS))
    conditions = np.empty((3, len(sets)))
    for k, rows in enumerate(sets):
        measured = c["slide_roll_ratio"][rows]
        temperature = float(c["temperature"][rows].mean())
        speed = float(c["rolling_speed"][rows].mean())
        slip[k] = np.linspace(min(measured.min(), 0.0), max(measured.max(), 0.0), CURVE_POINTS)
        film = (
            {}
            if problem.film is not None
            else {"film_thickness": float(np.median(c["film_thickness"][rows]))}
        )
        slices = Slices(
            CURVE_POINTS,
            problem.conditions(lubricant, temperature),
            load=float(problem.load[rows].mean()),
            rolling_speed=speed,
            sliding_speed=slip[k] * speed,
            **film,
        )
        chain(slices)
        friction[k] = slices.friction
        conditions[:, k] = (temperature, slices.pressure[0], speed)
    return {
        "curve_slip": (("point", "curve_point"), slip, about("1", "slide-roll ratio")),
        "curve_friction": (
            ("point", "curve_point"),
            friction,
            about("1", "fitted friction coefficient"),
        ),
        "point_temperature": ("point", conditions[0], about("K", "temperature")),
        "point_pressure": ("point", conditions[1], about("Pa", "mean Hertz pressure")),
        "point_speed": ("point", conditions[2], about("m/s", "rolling speed")),
    }


# Warnings -----------------------------------------------------------------------------------------------------------


def _warnings(fit: Fit, sets: Sequence[Indices]) -> list[str]:
    """Return the warnings about a fit."""
    from scipy.special import bdtr, chdtrc

    problem = fit.problem
    estimate = fit.estimate
    warnings = []
    if (
        "friction_uncertainty" in problem.data.columns
        and chdtrc(estimate.freedom, estimate.best.chi2) < _SIGNIFICANCE
    ):
        warnings.append(
            f"the model does not fit the data within their uncertainties (chi2 {estimate.best.chi2:.4g} at "
            f"{estimate.freedom} degrees of freedom): values and intervals hold only as far as it does"
        )
    slides = np.abs(problem.data.columns["slide_roll_ratio"])
    if count := int(np.count_nonzero(slides > _MAX_SLIDE_ROLL)):
        warnings.append(
            f"{count} of {slides.size} rows have a slide-roll ratio above 2, at most {slides.max():.3g}, as surfaces "
            "that run against each other have; so has per cent under [1]: then write slide_roll_ratio [%]"
        )
    residuals = estimate.best.residuals
    largest = float(np.abs(problem.data.columns["friction"]).max())
    is_exact = float(np.abs(residuals * fit.weight).max()) <= _RESIDUAL_ROUNDING * largest
    # binomial test: the probability of so few changes of sign along the curves if the residuals are random
    changes = sum(int(np.count_nonzero(np.diff(residuals[rows] > 0.0))) for rows in sets)
    chance = float(bdtr(changes, sum(rows.size - 1 for rows in sets), 0.5))
    if chance < _SIGNIFICANCE and not is_exact:
        warnings.append(
            f"the residuals are not random along the curves (probability {chance:.1g}): the model misses something "
            "that the data show, and the intervals, which take the errors for independent, are too narrow"
        )
    warnings += _other_minima(fit)
    error = np.sqrt(np.diag(estimate.covariance))
    nonlinear = [
        p.name
        for p, x, profile, error_of_x in zip(
            fit.parameters, estimate.best.x, estimate.profiles, error, strict=True
        )
        if np.isfinite(profile.limits[-1]).all()
        and not np.all(_same_size(profile.limits[0] - x, error_of_x))
    ]
    if nonlinear:
        warnings.append(
            f"the law is far from linear within the intervals of {', '.join(nonlinear)}: what follows from the "
            "covariance, standard error and correlation, does not hold; the intervals do"
        )
    fit.friction(estimate.best.x)  # stores film and pressure of the fit in the tables
    # oil and traction are fitted: within the data their values compensate the deviations of their laws
    excesses = validity.range_excesses(
        [model for kind, model in problem.models.items() if kind != "traction"],
        [validity.RingSlices("", slices, np.ones(len(slices))) for _, _, slices in problem.tables],
    )
    warnings += [
        message.text for message in validity.validity_messages(excesses, None, what="of the rows")
    ]
    return warnings


def _same_size(distances: Array, width: float) -> NDArray[np.bool_]:
    """Return whether distances are within a factor of two of the expected width."""
    fraction = np.abs(distances) / width
    return np.asarray((fraction > 0.5) & (fraction < 2.0))


def _other_minima(fit: Fit) -> list[str]:
    """Return a warning if searches ended in another minimum."""
    estimate = fit.estimate
    different = [
        end
        for end in estimate.others
        if end is not None
        and end.converged
        and (end.chi2 - estimate.best.chi2) / estimate.scale**2 > _MIN_OTHER_RISE
    ]
    if not different:
        return []
    second = min(different, key=lambda end: end.chi2)
    rise = (second.chi2 - estimate.best.chi2) / estimate.scale**2
    at = ", ".join(
        f"{p.name} {p.format(value)}"
        for p, value in zip(fit.parameters, fit.values_at(second.x), strict=True)
    )
    fit_quality = "which fits worse"
    if rise < estimate.quantiles[-1]:
        fit_quality = "which the data do not exclude"
    return [
        f"{len(different)} of {len(estimate.others)} searches ended in another minimum, {fit_quality} (chi2 higher by "
        f"{rise:.3g} variances): {at}"
    ]


# Origin -------------------------------------------------------------------------------------------------------------


def _provenance(fit: Fit, dataset: "xr.Dataset") -> dict[str, Any]:
    """Return the attributes on data, rig, models, citations and packages."""
    problem = fit.problem
    models = problem.models
    oil = problem.lubricant
    rig = problem.rig
    offers = [find(kind, model.name) for kind, model in models.items()]
    if rig.lubricant.name is not None:
        offers.append(find("lubricant", rig.lubricant.name))
    described = describe_models(models.items())
    requested = json.dumps(
        [resolved(rig), described, problem.data.sha256, list(dataset["parameter"].values)],
        sort_keys=True,
    )
    return origin(
        study="fit",
        title=rig.title,
        source=problem.data.source,
        measurements=problem.data.text,
        data_sha256=problem.data.sha256,
        rig=rig.text,
        rig_resolved=resolved(rig),
        scene_hash=hashlib.sha256(requested.encode()).hexdigest(),
        packages=packages_of(offers),
        models=described,
        lubricant=describe_lubricant(oil),
        **describe_citations(
            collect_citations([*models.values(), oil.pressure_viscosity_law], oil.references)
        ),
        evaluations=problem.evaluated,
        **_tables(fit, dataset),
    )


def _tables(fit: Fit, dataset: "xr.Dataset") -> dict[str, str]:
    """Return the tables of a scene with the fitted values, as JSON."""
    problem = fit.problem
    values = fit.values
    oil = {
        p.key[0]: value / p.unit_value
        for p, value in zip(fit.parameters, values, strict=True)
        if p.of_oil
    }
    table = resolved(problem.rig.lubricant)
    at = " to ".join(
        dict.fromkeys(
            format_quantity(T, "K", 4) for T, *_ in (problem.tables[0], problem.tables[-1])
        )
    )
    film = "measured film" if problem.film is None else f"film {problem.film.name}"
    described = ", ".join(
        f"{name} {value} (95 %: {limits}; {status})"
        for name, value, _, _, limits, status in parameter_rows(dataset)
    )
    source = (
        f"Fitted by rollslip {importlib.metadata.version('rollslip')} to {Path(problem.data.source).name} (sha256 "
        f"{problem.data.sha256}) with traction {problem.traction.name} and {film} at {at}: {described}."
    )
    source = " ".join(filter(None, (str(table.get("source", "")), source)))
    fitted = {p.key: value for p, value in zip(fit.parameters, values, strict=True) if not p.of_oil}
    constants: dict[str, Any] = {**problem.lubricant.models}
    for path, value in fitted.items():
        law = reduce(getattr, path[:-1], problem.traction)
        constants[law.name] = {**constants.get(law.name, {}), path[-1]: value}
    models = {"models": constants} if constants else {}
    tables = {"lubricant_table": json.dumps({**table, **oil, **models, "source": source})}
    if fitted:
        tables["traction_table"] = json.dumps(_model_table(fit.laws[1], fitted))
    return tables


def _model_table(
    model: SliceModel, omitted: Collection[tuple[str, ...]], *prefix: str
) -> dict[str, object]:
    """Return the table of a model in a scene, without the fields at omitted paths, which the table of the oil has."""
    table: dict[str, object] = {"model": model.name}
    for attribute in getattr(model, "__attrs_attrs__", ()):
        value = getattr(model, attribute.name)
        path = (*prefix, attribute.name)
        if attribute.metadata.get("key", attribute.name) is not None and path not in omitted:
            table[attribute.name] = (
                _model_table(value, omitted, *path) if isinstance(value, SliceModel) else value
            )
    return table
