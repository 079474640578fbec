"""Rank laws by how well they predict conditions that they were not fitted to, and say what of it can be told.

- A *condition* is what a rig held at one temperature, load and speed, or a row of any other series. Parameters are
  fitted to friction on all conditions but one, and the law is scored on that one; so for every condition in turn. What
  is fitted to nothing is scored as it is.
- The error of a law on a condition is the root mean square of its misses, over the standard uncertainty of the measured
  values: 1 is as good as the data are, and less than a tenth of that is none. Its *error* is the geometric mean over
  the conditions, so that no single one decides: twice the error is twice the error wherever it is.
- Two laws are held against each other condition by condition. If neither was the better one, the sign of each
  difference would be that of a coin: all tosses, or 4096 drawn ones, tell how often so large a mean difference over its
  spread comes by chance, the largest one among all pairs (Fisher's randomisation, with Westfall and Young's step for
  many pairs). So all that is told of a ranking holds together with a confidence of 95 %. What does not reach it *cannot
  be told*; so is everything of fewer than six conditions, of which no pattern of signs is that rare.
- Intervals of single errors are those of a bootstrap over the conditions: how they scatter under others like them.
- Number of parameters and cost stand beside the error: they are no part of it.
- All this takes conditions for independent: it is of noise alone. What a rig or a day has in common, such as a constant
  error of temperature, is not in it, unless the conditions are grouped by series or set: then the mean difference of a
  group is tossed as one, groups are drawn, and six of them are needed.
"""

import itertools
import math
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.errors import RollslipError, SceneError
from rollslip.planning.campaign import listed
from rollslip.results.dataset import about
from rollslip.search import Array
from rollslip_campaigns.fit.least_squares import estimate, minimise
from rollslip_campaigns.fit.problem import (
    Parameter,
    RigProblem,
    bounds_of,
    friction_at,
    misfit,
    operating_points,
    parameters_named,
    rig_problem,
)
from rollslip_campaigns.measurement import Measurement
from rollslip_campaigns.measurement.values import ContactSeries, Series
from rollslip_campaigns.validation.predictions import Predictions
from rollslip_campaigns.validation.validate import (
    Combination,
    Validation,
    nominal_values,
    plan_validation,
)

if TYPE_CHECKING:
    import xarray as xr

    from rollslip_campaigns.validation import RankingSettings

__all__ = ["FEWEST", "Told", "plan_ranking", "run_ranking", "tell"]

#: Conditions without which nothing is told.
FEWEST: Final = 6
#: What conditions may be grouped by.
GROUPS: Final = ("", "series", "set")
CONFIDENCE: Final = 0.95
_RESAMPLED: Final = 4096
#: Misses over their uncertainty below which one law is no better than another.
_LEAST: Final = 0.1


def plan_ranking(requested: "RankingSettings") -> Validation:
    """Check what is asked for."""
    plan = plan_validation(requested)
    if len(plan.combinations[1:] or plan.combinations) + len(plan.predictions) < 2:
        raise SceneError(
            ["there is nothing to rank: name two laws, as by --traction A,B, or give --predictions"]
        )
    if not any(series.rows for measurement in plan.sets for series in measurement.series):
        raise SceneError(["there is nothing to rank by: the data sets hold no numbers"])
    if requested.groups not in GROUPS:
        raise SceneError(
            [f"groups: {requested.groups!r} is none; write series or set, or leave it out"]
        )
    return plan


def run_ranking(
    plan: Validation,
    requested: "RankingSettings",
    report: Callable[[str, float], None] = lambda text, fraction: None,
) -> "xr.Dataset":
    """Rank laws by their errors on conditions that they were not fitted to."""
    begin = time.perf_counter()
    laws = plan.combinations[1:] or plan.combinations
    wanted = listed(requested.parameters)
    scored = list[_Scored]()
    conditions = list[str]()
    groups = list[str]()
    parts = [
        (measurement, series)
        for measurement in plan.sets
        for series in measurement.series
        if series.rows
    ]
    for measurement, series in parts:
        labels = _labels(series)
        conditions += [f"{measurement.name}, {series.name}: {label}" for label in labels]
        groups += [
            measurement.name + (f", {series.name}" if requested.groups == "series" else "")
        ] * len(labels)
    for k, law in enumerate(laws):
        report(law.label, k / len(laws))
        scored.append(_scored(law, parts, wanted))
    unknown = set(wanted) - {name for one in scored for name in one.fitted}
    if unknown:
        raise SceneError(
            [f"parameters: no law has {', '.join(sorted(unknown))} to fit to these data"]
        )
    scored += [_predicted(one, parts) for one in plan.predictions]
    alike = [
        f"{measurement.name}, {series.name}: uncertainties: {series.about_uncertainty}"
        for measurement, series in parts
        if series.about_uncertainty.startswith("none given")
    ]
    taken = groups if requested.groups else []
    return _dataset(
        plan,
        scored,
        conditions,
        tuple(wanted),
        requested,
        taken,
        alike,
        time.perf_counter() - begin,
    )


# Scores -------------------------------------------------------------------------------------------------------------


@attrs.frozen(kw_only=True)
class _Scored:
    """A law with its error on every condition."""

    label: str
    errors: Array
    fitted: tuple[str, ...] = ()
    parameters: int = 0
    seconds: float = math.nan
    status: str = ""


def _conditions(series: Series) -> list[NDArray[np.intp]]:
    """Rows of each condition of a series."""
    if series.quantity == "friction" and isinstance(series, ContactSeries):
        return operating_points(rig_problem(series.data, series.rig))
    return [np.array([k]) for k in range(len(series.rows))]


def _labels(series: Series) -> list[str]:
    sets = _conditions(series)
    if len(sets) == len(series.rows):
        return [row.label for row in series.rows]
    return [f"point {k} of {len(sets)}" for k in range(1, len(sets) + 1)]


def _errors(series: Series, values: Array) -> Array:
    """Root mean square of the misses over their uncertainty, condition by condition."""
    measured = np.array([row.measured for row in series.rows])
    sigma = np.array([row.uncertainty for row in series.rows])
    misses = (values - measured) / sigma
    return np.array(
        [max(math.sqrt(float(np.mean(misses[rows] ** 2))), _LEAST) for rows in _conditions(series)]
    )


def _scored(
    law: Combination, parts: Sequence[tuple[Measurement, Series]], wanted: Sequence[str]
) -> _Scored:
    errors = list[Array]()
    fitted = list[str]()
    seconds = list[float]()
    try:
        for _, series in parts:
            if series.quantity == "friction" and isinstance(series, ContactSeries):
                values, known, cost = _left_out(series, law, wanted)
                fitted += known
                seconds.append(cost)
            else:
                found = nominal_values(series, law)
                values = np.array([one.value for one in found])
                seconds += [one.seconds for one in found]
            errors.append(_errors(series, values))
    except RollslipError as error:
        count = sum(len(_conditions(series)) for _, series in parts)
        return _Scored(
            label=law.label, errors=np.full(count, math.nan), status=str(error).splitlines()[0]
        )
    names = tuple(dict.fromkeys(fitted))
    every = np.concatenate(errors)
    status = "" if np.isfinite(every).all() else "has no value at some conditions"
    return _Scored(
        label=law.label, errors=every, fitted=names, parameters=len(names), seconds=float(np.median(seconds)),
        status=status,
    )  # fmt: skip


def _left_out(
    series: ContactSeries, law: Combination, wanted: Sequence[str]
) -> tuple[Array, list[str], float]:
    """Friction of every condition by a law that was fitted to all others; what was fitted; seconds a value."""
    problem = rig_problem(
        series.data, series.rig, law.models.get("traction"), law.models.get("film")
    )
    free = _known(problem, wanted)
    begin = time.perf_counter()
    values = problem.friction(problem.lubricant, problem.chain)
    seconds = (time.perf_counter() - begin) / len(series.rows)
    if not free:
        return values, [], seconds
    low, high = bounds_of(free)
    residuals = partial(misfit, problem, free, np.array([row.uncertainty for row in series.rows]))
    whole = estimate(residuals, low, high, known=True, profiles=False).best.x
    for rows in operating_points(problem):
        others = np.setdiff1d(np.arange(values.size), rows)
        found = minimise(lambda x, others=others: residuals(x)[others], whole, low, high)  # type: ignore[misc]
        x = whole if found is None else found.x
        values[rows] = friction_at(problem, free, x)[rows]
    return values, [p.name for p in free], seconds


def _known(problem: RigProblem, wanted: Sequence[str]) -> list[Parameter]:
    """Parameters of these names that a law or its oil has."""
    found = list[Parameter]()
    for name in wanted:
        try:
            found += parameters_named(problem, [name])
        except SceneError:
            continue
    return found


def _predicted(one: Predictions, parts: Sequence[tuple[Measurement, Series]]) -> _Scored:
    errors = []
    for measurement, series in parts:
        values = one.values_of(series) if one.of == measurement.name else None
        given = (
            np.full(len(series.rows), math.nan)
            if values is None
            else np.array([v.value for v in values[0]])
        )
        errors.append(_errors(series, given))
    every = np.concatenate(errors)
    status = "" if np.isfinite(every).all() else "does not predict all conditions"
    return _Scored(label=one.program, errors=every, parameters=one.parameters, status=status)


# Ranking ------------------------------------------------------------------------------------------------------------


@attrs.frozen(eq=False)
class Told:
    """What can be told of errors, shape (law, condition).

    Attributes
    ----------
    probability : ndarray
        (law, law): chance of so large a difference anywhere among all pairs; NaN where nothing can be told.
    low, high : ndarray
        95 % interval of the error of each law by itself.
    """

    probability: Array
    low: Array
    high: Array


def tell(errors: Array, seed: int = 0, groups: Sequence[str] = ()) -> Told:
    """Return which differences between laws are more than chance, with the group of each condition, if any is common.

    A group counts as one, by the mean of its logarithms, however many conditions it has.
    """
    errors = _grouped(errors, groups)
    count, conditions = errors.shape
    probability = np.full((count, count), math.nan)
    low = np.full(count, math.nan)
    high = np.full(count, math.nan)
    kept = np.flatnonzero(np.isfinite(errors).all(axis=1))
    if conditions < FEWEST or not kept.size:
        return Told(probability, low, high)
    scores = np.log(errors)
    generator = np.random.default_rng(seed)
    drawn = generator.integers(conditions, size=(_RESAMPLED, conditions))
    means = np.exp(scores[kept][:, drawn].mean(axis=2))
    low[kept], high[kept] = np.quantile(means, ((1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2), axis=1)
    pairs = list(itertools.combinations(kept, 2))
    signs = _signs(conditions, generator)
    differences = np.array([scores[i] - scores[j] for i, j in pairs]).reshape(
        len(pairs), conditions
    )
    # of what is tossed the sum of squares stays, and with it t rises with the mean alone
    square = np.mean(differences**2, axis=1)
    size = np.sqrt(np.where(square > 0.0, square, 1.0))
    largest = np.max(np.abs(signs @ (differences / size[:, None]).T), axis=1, initial=0.0)
    for k, (i, j) in enumerate(pairs):
        observed = abs(differences[k].sum()) / size[k]
        probability[i, j] = probability[j, i] = float(np.mean(largest >= observed * (1 - 1e-12)))
    return Told(probability, low, high)


def _grouped(errors: Array, groups: Sequence[str]) -> Array:
    """Return geometric means of errors (law, condition) over groups; the errors where there are none."""
    if not groups:
        return errors
    which = np.unique(np.array(groups), return_inverse=True)[1]
    sums = np.array([np.bincount(which, np.log(row)) for row in errors])
    return np.asarray(np.exp(sums / np.bincount(which)))


def _signs(conditions: int, generator: np.random.Generator) -> Array:
    """Return all patterns of signs, or as many drawn ones, the one that was observed among them."""
    if 2**conditions <= _RESAMPLED:
        patterns = (np.arange(2**conditions)[:, None] >> np.arange(conditions)) & 1
    else:
        patterns = generator.integers(2, size=(_RESAMPLED, conditions))
        patterns[0] = 1
    return np.asarray(2.0 * patterns - 1.0, dtype=np.float64)


def _dataset(
    plan: Validation, scored: Sequence[_Scored], conditions: Sequence[str], wanted: tuple[str, ...],
    requested: "RankingSettings", groups: Sequence[str], warnings: Sequence[str], seconds: float,
) -> "xr.Dataset":  # fmt: skip
    import xarray as xr

    mean = np.array(
        [float(np.exp(np.log(_grouped(one.errors[None], groups)).mean())) for one in scored]
    )
    order = sorted(range(len(scored)), key=lambda k: (math.isnan(mean[k]), mean[k]))
    scored = [scored[k] for k in order]
    mean = mean[order]
    labels = [one.label for one in scored]
    if twice := {label for label in labels if labels.count(label) > 1}:
        raise SceneError(
            [f"two are called {label!r}; give a program another name" for label in sorted(twice)]
        )
    errors = np.array([one.errors for one in scored])
    told = tell(errors, requested.seed, groups)
    fitted, status = (
        np.array(one, dtype=object)
        for one in ([", ".join(one.fitted) for one in scored], [one.status for one in scored])
    )
    variables = {
        "error": ("law", mean, about("1", "geometric mean error, over the uncertainty of the data")),
        "error_low": ("law", told.low, about("1", "lower end of its 95 % interval")),
        "error_high": ("law", told.high, about("1", "upper end of its 95 % interval")),
        "parameters": ("law", np.array([one.parameters for one in scored]), about("1", "parameters fitted")),
        "fitted": ("law", fitted, about("1", "what they are")),
        "seconds": ("law", np.array([one.seconds for one in scored]), about("s", "time of one value")),
        "status": ("law", status, about("1", "why there is no error")),
        "condition_error": (("law", "condition"), errors, about("1", "error at a condition")),
        "probability": (("law", "other"), told.probability, about("1", "chance of so large a difference")),
    }  # fmt: skip
    coordinates = {
        "law": ("law", np.array(labels, dtype=object), about("1", "law")),
        "other": ("other", np.array(labels, dtype=object), about("1", "law")),
        "condition": ("condition", np.array(conditions, dtype=object), about("1", "condition")),
    }
    attributes = plan.origin(
        study="ranking",
        title="Laws ranked by conditions that they were not fitted to",
        wanted=list(wanted),
        confidence=CONFIDENCE,
        fewest=FEWEST,
        seed=requested.seed,
        groups=requested.groups,
        independent=len(set(groups)) or len(conditions),
        warnings=[*warnings, *(f"{one.label}: {one.status}" for one in scored if one.status)],
        evaluations=int(errors.size),
        wall_time=seconds,
    )
    return xr.Dataset(variables, coordinates, attributes)
