"""Rank laws by their errors on conditions that they were not fitted to, and test which differences are significant.

1. A *condition* is one operating point of a rig (one temperature, load and speed), or a row of any other series.
2. Score each law by leave-one-out cross-validation: fit its parameters to friction on all conditions except one, and
   compute the error on that one; so for each condition in turn. A law without fitted parameters is scored as it is.
3. The error on a condition is the root mean square of the deviations over the standard uncertainty of the measured
   values: 1 is as good as the data, and less than a tenth counts as a tenth. The error of a law is the geometric mean
   over the conditions, so that no single one decides.
4. Compare each pair of laws by Fisher's randomisation test on the differences of the logarithms of their errors: if
   neither law was better, the sign of each difference would be random. All patterns of signs, or 4096 random ones, give
   the probability of so large a mean difference over its spread. The largest one among all pairs is taken for each
   pattern (the step of Westfall and Young for multiple tests), so that all conclusions hold together with a confidence
   of 95 %.
5. Differences without this confidence *cannot be determined*; so are all with fewer than six conditions, of which no
   pattern of signs is rare enough.
6. Intervals of single errors are those of a bootstrap over the conditions.

- The number of parameters and the time of a value are reported and are no part of the error.
- The test takes conditions for independent. Errors that are common to a rig or a day, such as a constant error of
  temperature, are not in it, unless conditions are grouped by series or set: then the mean difference of a group has
  one random sign, whole groups are drawn, and six groups are needed.
"""

import itertools
import math
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from typing import Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.errors import RollslipError, SceneError
from rollslip.planning.campaign import listed
from rollslip.results.dataset import about, xr
from rollslip.search import Array
from rollslip.structure import raise_problem_if
from rollslip_campaigns.fit.least_squares import Residuals, estimate, minimise
from rollslip_campaigns.fit.problem import (
    Parameter,
    bounds_of,
    friction_at,
    misfit,
    operating_points,
    parameters_named,
    rig_problem,
)
from rollslip_campaigns.measurement import Measurement
from rollslip_campaigns.measurement.values import ContactSeries, Series
from rollslip_campaigns.validation import RankingSettings
from rollslip_campaigns.validation.predictions import Predictions
from rollslip_campaigns.validation.validate import (
    Combination,
    Validation,
    nominal_values,
    plan_validation,
)

__all__ = ["MIN_CONDITIONS", "Significance", "estimate_significance", "plan_ranking", "run_ranking"]

#: Smallest number of conditions, or groups, for a conclusion: with five, 2^-4 = 6 % of the patterns of signs are as
#: extreme as all signs alike, more than 1 - `CONFIDENCE`; with six 3 %.
MIN_CONDITIONS: Final = 6
#: What conditions may be grouped by.
GROUPS: Final = ("", "series", "set")
#: Confidence of all conclusions together, and of the intervals. Halving 1 - confidence leaves fewer conclusions.
CONFIDENCE: Final = 0.95
#: Number of random patterns of signs, and of bootstrap samples; all patterns where there are fewer. Doubling it halves
#: the smallest probability, 1/4096, which is far below 5 %; chosen.
_RESAMPLES: Final = 4096
#: Error on a condition, over the uncertainty, below which one law is no better than another. Without it, a law that
#: agrees by chance would decide the geometric mean. Doubling it ignores more differences; chosen.
_MIN_ERROR: Final = 0.1
#: Relative tolerance of the comparison of statistics: patterns that give the observed value count in spite of rounding.
_TIE_TOLERANCE: Final = 1e-12


def plan_ranking(requested: "RankingSettings") -> Validation:
    """Return the laws and data sets that are requested, after a check of names and numbers."""
    plan = plan_validation(requested)
    raise_problem_if(
        len(plan.combinations[1:] or plan.combinations) + len(plan.predictions) < 2,
        "there is nothing to rank: name two laws, as by --traction A,B, or give --predictions",
    )
    raise_problem_if(
        not any(series.rows for measurement in plan.sets for series in measurement.series),
        "there is nothing to rank by: the data sets hold no numbers",
    )
    raise_problem_if(
        requested.groups not in GROUPS,
        f"groups: {requested.groups!r} is none; write series or set, or leave it out",
    )
    return plan


def run_ranking(
    plan: Validation,
    requested: "RankingSettings",
    report: Callable[[str, float], None] = lambda text, fraction: None,
) -> "xr.Dataset":
    """Return laws ranked by their errors on conditions that they were not fitted to.

    Parameters
    ----------
    plan : Validation
        Data sets, laws and predictions.
    requested : RankingSettings
        Parameters to fit, groups and seed.
    report : callable
        Receives the progress: a text, and the fraction that is done.

    Returns
    -------
    xarray.Dataset
        See `rollslip.rank`. The error of a law is NaN where its ``status`` says why; probabilities and intervals are
        NaN where there are too few conditions.
    """
    start = time.perf_counter()
    laws = plan.combinations[1:] or plan.combinations
    names = listed(requested.parameters)
    scores = list[_Score]()
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
        group = measurement.name
        if requested.groups == "series":
            group = f"{measurement.name}, {series.name}"
        groups += [group] * len(labels)
    for k, law in enumerate(laws):
        report(law.label, k / len(laws))
        scores.append(_score_law(law, parts, names))
    unknown = set(names) - {name for score in scores for name in score.fitted}
    raise_problem_if(
        unknown, f"parameters: no law has {', '.join(sorted(unknown))} to fit to these data"
    )
    scores += [_score_predictions(predictions, parts) for predictions in plan.predictions]
    warnings = [
        f"{measurement.name}, {series.name}: uncertainties: {series.about_uncertainty}"
        for measurement, series in parts
        if series.about_uncertainty.startswith("none given")
    ]
    return _dataset(
        plan,
        scores,
        conditions,
        tuple(names),
        requested,
        groups if requested.groups else [],
        warnings,
        time.perf_counter() - start,
    )


# Scores -------------------------------------------------------------------------------------------------------------


@attrs.frozen(kw_only=True)
class _Score:
    """Errors of a law on all conditions, (conditions,), and what they cost."""

    label: str
    errors: Array
    fitted: tuple[str, ...] = ()
    parameters: int = 0
    seconds: float = math.nan
    status: str = ""


def _conditions(series: Series) -> list[NDArray[np.intp]]:
    """Return the rows of each condition of a series."""
    if series.quantity == "friction" and isinstance(series, ContactSeries):
        return operating_points(rig_problem(series.data, series.rig))
    return [np.array([k]) for k in range(len(series.rows))]


def _labels(series: Series) -> list[str]:
    """Return the labels of the conditions of a series."""
    sets = _conditions(series)
    if len(sets) == len(series.rows):
        return [row.label for row in series.rows]
    return [f"point {k} of {len(sets)}" for k in range(1, len(sets) + 1)]


def _errors(series: Series, values: Array) -> Array:
    """Return the root mean square of the deviations over their uncertainty, for each condition."""
    measured = np.array([row.measured for row in series.rows])
    deviations = (values - measured) / np.array([row.uncertainty for row in series.rows])
    return np.array(
        [
            max(math.sqrt(float(np.mean(deviations[rows] ** 2))), _MIN_ERROR)
            for rows in _conditions(series)
        ]
    )


def _score_law(
    law: Combination, parts: Sequence[tuple[Measurement, Series]], names: Sequence[str]
) -> _Score:
    """Return the errors of a law; NaN with a status where it fails."""
    errors = list[Array]()
    fitted = list[str]()
    seconds = list[float]()
    try:
        for _, series in parts:
            if series.quantity == "friction" and isinstance(series, ContactSeries):
                values, parameters, cost = _cross_validate(series, law, names)
                fitted += parameters
                seconds.append(cost)
            else:
                calculated = nominal_values(series, law)
                values = np.array([value.value for value in calculated])
                seconds += [value.seconds for value in calculated]
            errors.append(_errors(series, values))
    except RollslipError as error:
        count = sum(len(_conditions(series)) for _, series in parts)
        return _Score(
            label=law.label, errors=np.full(count, math.nan), status=str(error).splitlines()[0]
        )
    fitted_names = tuple(dict.fromkeys(fitted))
    all_errors = np.concatenate(errors)
    status = "" if np.isfinite(all_errors).all() else "has no value at some conditions"
    return _Score(
        label=law.label,
        errors=all_errors,
        fitted=fitted_names,
        parameters=len(fitted_names),
        seconds=float(np.median(seconds)),
        status=status,
    )


def _cross_validate(
    series: ContactSeries, law: Combination, names: Sequence[str]
) -> tuple[Array, list[str], float]:
    """Return friction on each condition by a law fitted to all others, the parameters, and the time of a value [s]."""
    problem = rig_problem(
        series.data, series.rig, law.models.get("traction"), law.models.get("film")
    )
    # those of the named parameters that the law or its oil has
    free = list[Parameter]()
    for name in names:
        with suppress(SceneError):
            free += parameters_named(problem, [name])
    start = time.perf_counter()
    values = problem.friction(problem.lubricant, problem.chain)
    seconds = (time.perf_counter() - start) / len(series.rows)
    if not free:
        return values, [], seconds
    low, high = bounds_of(free)
    residuals = partial(misfit, problem, free, np.array([row.uncertainty for row in series.rows]))
    fitted_to_all = estimate(residuals, low, high, known=True, profiles=False).best.x
    for rows in operating_points(problem):
        others = np.setdiff1d(np.arange(values.size), rows)
        minimum = minimise(partial(_select, residuals, others), fitted_to_all, low, high)
        x = fitted_to_all if minimum is None else minimum.x
        values[rows] = friction_at(problem, free, x)[rows]
    return values, [p.name for p in free], seconds


def _select(residuals: Residuals, rows: NDArray[np.intp], x: Array) -> Array:
    """Return the residuals of some rows at coordinates x."""
    return residuals(x)[rows]


def _score_predictions(
    predictions: Predictions, parts: Sequence[tuple[Measurement, Series]]
) -> _Score:
    """Return the errors of the predictions of a program; NaN where it does not predict all conditions."""
    errors = []
    for measurement, series in parts:
        values = predictions.values_of(series) if predictions.data_set == measurement.name else None
        predicted = np.full(len(series.rows), math.nan)
        if values is not None:
            predicted = np.array([value.value for value in values[0]])
        errors.append(_errors(series, predicted))
    all_errors = np.concatenate(errors)
    status = "" if np.isfinite(all_errors).all() else "does not predict all conditions"
    return _Score(
        label=predictions.program,
        errors=all_errors,
        parameters=predictions.parameters,
        status=status,
    )


# Ranking ------------------------------------------------------------------------------------------------------------


@attrs.frozen(eq=False)
class Significance:
    """Significance of the differences between the errors of laws.

    Attributes
    ----------
    probability : ndarray
        (law, law): probability of so large a difference by chance anywhere among all pairs; NaN where it cannot be
        determined.
    low, high : ndarray
        Bounds of the 95 % interval of the error of each law by itself; NaN likewise.
    """

    probability: Array
    low: Array
    high: Array


def estimate_significance(errors: Array, seed: int = 0, groups: Sequence[str] = ()) -> Significance:
    """Return which differences between laws are more than chance, by a randomisation test.

    Parameters
    ----------
    errors : array
        Errors of the laws, (law, condition); a law with NaN is left out.
    seed : int
        Seed of random patterns and of the bootstrap.
    groups : sequence of str
        Group of each condition. A group counts as one condition, by its geometric mean error; empty for no groups.
    """
    errors = _grouped(errors, groups)
    count, conditions = errors.shape
    probability = np.full((count, count), math.nan)
    low = np.full(count, math.nan)
    high = np.full(count, math.nan)
    complete = np.flatnonzero(np.isfinite(errors).all(axis=1))
    if conditions < MIN_CONDITIONS or not complete.size:
        return Significance(probability, low, high)
    scores = np.log(errors)
    generator = np.random.default_rng(seed)
    resampled = generator.integers(conditions, size=(_RESAMPLES, conditions))
    means = np.exp(scores[complete][:, resampled].mean(axis=2))
    low[complete], high[complete] = np.quantile(
        means, ((1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2), axis=1
    )
    pairs = list(itertools.combinations(complete, 2))
    signs = _signs(conditions, generator)
    differences = np.array([scores[i] - scores[j] for i, j in pairs]).reshape(
        len(pairs), conditions
    )
    # the sum of squares does not depend on the signs, so that t rises with the mean alone
    square = np.mean(differences**2, axis=1)
    size = np.sqrt(np.where(square > 0.0, square, 1.0))
    largest = np.max(np.abs(signs @ (differences / size[:, None]).T), axis=1, initial=0.0)
    for k, (i, j) in enumerate(pairs):
        observed = abs(differences[k].sum()) / size[k]
        probability[i, j] = float(np.mean(largest >= observed * (1 - _TIE_TOLERANCE)))
        probability[j, i] = probability[i, j]
    return Significance(probability, low, high)


def _grouped(errors: Array, groups: Sequence[str]) -> Array:
    """Return the geometric means of errors (law, condition) over groups; the errors where there are none."""
    if not groups:
        return errors
    which = np.unique(np.array(groups), return_inverse=True)[1]
    sums = [np.bincount(which, np.log(row)) for row in errors]
    return np.asarray(np.exp(sums / np.bincount(which)))


def _signs(conditions: int, generator: np.random.Generator) -> Array:
    """Return all patterns of signs, or random ones with the observed one among them, (patterns, conditions)."""
    if 2**conditions <= _RESAMPLES:
        patterns = (np.arange(2**conditions)[:, None] >> np.arange(conditions)) & 1
    else:
        patterns = generator.integers(2, size=(_RESAMPLES, conditions))
        patterns[0] = 1
    return np.asarray(2.0 * patterns - 1.0, dtype=np.float64)


def _dataset(
    plan: Validation,
    scores: Sequence[_Score],
    conditions: Sequence[str],
    names: tuple[str, ...],
    requested: "RankingSettings",
    groups: Sequence[str],
    warnings: Sequence[str],
    seconds: float,
) -> "xr.Dataset":
    """Return the result, with the smallest error first."""
    mean = np.array(
        [float(np.exp(np.log(_grouped(score.errors[None], groups)).mean())) for score in scores]
    )
    order = sorted(range(len(scores)), key=lambda k: (math.isnan(mean[k]), mean[k]))
    scores = [scores[k] for k in order]
    mean = mean[order]
    labels = [score.label for score in scores]
    if repeated := {label for label in labels if labels.count(label) > 1}:
        raise SceneError(
            [f"two are called {label!r}; give a program another name" for label in sorted(repeated)]
        )
    errors = np.array([score.errors for score in scores])
    significance = estimate_significance(errors, requested.seed, groups)
    fitted = np.array([", ".join(score.fitted) for score in scores], dtype=object)
    status = np.array([score.status for score in scores], dtype=object)
    variables = {
        "error": ("law", mean, about("1", "geometric mean error, over the uncertainty of the data")),
        "error_low": ("law", significance.low, about("1", "lower end of its 95 % interval")),
        "error_high": ("law", significance.high, about("1", "upper end of its 95 % interval")),
        "parameters": ("law", np.array([score.parameters for score in scores]), about("1", "parameters fitted")),
        "fitted": ("law", fitted, about("1", "what they are")),
        "seconds": ("law", np.array([score.seconds for score in scores]), about("s", "time of one value")),
        "status": ("law", status, about("1", "why there is no error")),
        "condition_error": (("law", "condition"), errors, about("1", "error at a condition")),
        "probability": (("law", "other"), significance.probability, about("1", "chance of so large a difference")),
    }  # fmt: skip
    coordinates = {
        "law": ("law", np.array(labels, dtype=object), about("1", "law")),
        "other": ("other", np.array(labels, dtype=object), about("1", "law")),
        "condition": ("condition", np.array(conditions, dtype=object), about("1", "condition")),
    }
    attributes = plan.origin(
        study="ranking",
        title="Laws ranked by conditions that they were not fitted to",
        wanted=list(names),
        confidence=CONFIDENCE,
        min_conditions=MIN_CONDITIONS,
        seed=requested.seed,
        groups=requested.groups,
        independent=len(set(groups)) or len(conditions),
        warnings=[
            *warnings,
            *(f"{score.label}: {score.status}" for score in scores if score.status),
        ],
        evaluations=int(errors.size),
        wall_time=seconds,
    )
    return xr.Dataset(variables, coordinates, attributes)
