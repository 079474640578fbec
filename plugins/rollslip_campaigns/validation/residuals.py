"""Compare calculated with measured values: bands and verdicts of rows, chi-square of series, and statements.

- A row is *inside* if zero lies in the central 95 % of the differences between calculated samples and the measured
  value with its normal error. The normal error is represented by its quantiles, and no distribution of the calculated
  values is assumed.
- Chi-square of a series uses the covariance of the samples and of the measured values (generalised least squares): the
  rows of a series share what scatters.
"""

import math
from collections.abc import Sequence
from typing import Any, Final

import attrs
import numpy as np

from rollslip.search import Array
from rollslip_campaigns.measurement.values import Series, Statement
from rollslip_campaigns.validation.findings import (
    CONFIRMED,
    INSIDE,
    NOT_CONFIRMED,
    OUTSIDE,
    UNDETERMINED,
)

__all__ = [
    "Value",
    "check_statement",
    "compare_series",
]

#: Quantiles that represent the normal error of a measured value. Doubling it refines the tails of a band beyond 0.8 %
#: and doubles the differences of a row; chosen, since the band ends at 2.5 %.
_ERROR_QUANTILES: Final = 64
#: Samples for each row that a covariance needs: with fewer its inverse is too uncertain. Doubling it suppresses
#: chi-square of more series. Chosen, a usual rule.
_SAMPLES_PER_ROW: Final = 10
#: Probabilities at which a band of 95 % ends.
_BAND: Final = (0.025, 0.975)


@attrs.frozen
class Value:
    """Value of a model at one point.

    Attributes
    ----------
    value : float
        The value; infinite outside the range of a study, NaN where there is none.
    reason : str
        Why the value is missing, or of another kind than was measured.
    seconds : float
        Time of one value [s].
    """

    value: float
    reason: str
    seconds: float


def compare_series(
    labels: tuple[str, str, str],
    series: Series,
    nominal: Sequence[Value],
    samples: Array,
    note: str,
) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    """Return the variables of each row of a series, and those of the whole series, by name (see `.validate`).

    Parameters
    ----------
    labels : tuple of str
        Names of data set, series and models.
    series : Series
        The measured rows.
    nominal : sequence of Value
        Calculated values without scatter, one for each row.
    samples : array
        Calculated values with scatter, (samples, rows); no samples for none.
    note : str
        Status of the whole series, where there is one already.
    """
    of_row = dict(zip(("row_data_set", "row_series", "row_models"), labels, strict=True))
    of_group = dict(zip(("group_data_set", "group_series", "group_models"), labels, strict=True))
    return (
        [of_row | _row(series, k, value, samples[:, k]) for k, value in enumerate(nominal)],
        of_group | _series(series, nominal, samples, note),
    )


def _row(series: Series, k: int, value: Value, samples: Array) -> dict[str, Any]:
    """Return the comparison of row k with its calculated value and samples, (samples,)."""
    from scipy.special import ndtri

    row = series.rows[k]
    sampled = samples if samples.size else np.array([value.value])
    unknown = float(np.isnan(sampled).mean())
    status = value.reason
    verdict = UNDETERMINED
    band = (math.nan, math.nan)
    ratio_band = (math.nan, math.nan)
    if unknown <= _BAND[0]:
        known = sampled[~np.isnan(sampled)]
        # quantiles of the normal distribution in the middle of intervals of equal probability
        quantiles = ndtri((np.arange(_ERROR_QUANTILES) + 0.5) / _ERROR_QUANTILES)
        measured = row.measured + row.uncertainty * quantiles
        low, high = _quantiles((known[:, None] - measured[None, :]).ravel())
        verdict = INSIDE if low <= 0.0 <= high else OUTSIDE
        if value.reason and math.isfinite(value.value):  # another kind than was measured
            verdict = UNDETERMINED
        if samples.size:
            band = _quantiles(known)
        if (measured > 0.0).all():
            ratio_band = _quantiles((known[:, None] / measured[None, :]).ravel())
    else:
        status = status or f"{unknown:.0%} of the samples have no value"
    ratio = value.value / row.measured if row.measured else math.nan
    return {
        "row_quantity": series.quantity,
        "row_unit": series.unit,
        "row_condition": row.label,
        "measured": row.measured,
        "uncertainty": row.uncertainty,
        "calculated": value.value,
        "calculated_low": band[0],
        "calculated_high": band[1],
        "ratio": ratio,
        "ratio_low": ratio_band[0],
        "ratio_high": ratio_band[1],
        "row_verdict": verdict,
        "row_status": status,
        "seconds": value.seconds,
    }


def _quantiles(values: Array) -> tuple[float, float]:
    """Return the bounds of the central 95 %, without interpolation, because values may be infinite."""
    low, high = np.quantile(values, _BAND, method="inverted_cdf")
    return float(low), float(high)


def _series(series: Series, nominal: Sequence[Value], samples: Array, note: str) -> dict[str, Any]:
    """Return chi-square of a series, with the covariance of its samples."""
    from scipy.special import chdtrc

    count = len(nominal)
    values = np.array([value.value for value in nominal])
    sigma = np.array([row.uncertainty for row in series.rows])
    deviations = values - np.array([row.measured for row in series.rows])
    status = ""
    if any(value.reason and math.isfinite(value.value) for value in nominal):
        status = next(value.reason for value in nominal if value.reason)
    elif not np.isfinite(values).all() or not np.isfinite(samples).all():
        status = "a value is not known, or beyond the range"
    elif 0 < len(samples) < _SAMPLES_PER_ROW * count:
        status = (
            f"{len(samples)} samples are too few for the covariance of {count} rows, which takes "
            f"{_SAMPLES_PER_ROW} a row"
        )
    if status:
        return {
            "chi2": math.nan,
            "freedom": count,
            "probability": math.nan,
            "chi2_status": note or status,
        }
    covariance = np.diag(sigma**2)
    if len(samples):
        covariance = covariance + np.atleast_2d(np.cov(samples, rowvar=False))
    chi2 = float(deviations @ np.linalg.solve(covariance, deviations))
    return {
        "chi2": chi2,
        "freedom": count,
        "probability": float(chdtrc(count, chi2)),
        "chi2_status": note,
    }


def check_statement(statement: Statement, values: Array) -> str:
    """Return the verdict on a statement: whether the calculated values agree with it.

    Parameters
    ----------
    statement : Statement
        What is expected of the values.
    values : array
        Calculated values at the steps of the statement, (steps,); NaN where there is none.
    """
    limit: Any = statement.limit
    if statement.expect == "none":
        agrees = ~np.isfinite(values)
    elif np.isnan(values).any():
        return UNDETERMINED
    elif statement.expect == "below":
        agrees = values < limit
    elif statement.expect == "above":
        agrees = values > limit
    elif np.isinf(values).sum() > 1:
        return UNDETERMINED
    else:
        rise = np.diff(values)
        minimum = statement.by * np.abs(np.where(np.isfinite(values[:-1]), values[:-1], values[1:]))
        agrees = (rise if statement.expect == "rises" else -rise) > minimum
    return CONFIRMED if agrees.all() else NOT_CONFIRMED
