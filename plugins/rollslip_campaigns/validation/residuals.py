"""Holds calculated values against measured ones: bands and verdicts of rows, chi-square of series, and statements."""

import math
from collections.abc import Mapping, Sequence
from typing import Final

import attrs
import numpy as np

from rollslip.search import Array
from rollslip_campaigns.measurement.values import Series, Statement

__all__ = [
    "BROKEN",
    "HELD",
    "INSIDE",
    "OUTSIDE",
    "UNDETERMINED",
    "Group",
    "Judged",
    "Said",
    "Value",
    "held",
    "verdict_on",
]

#: Points of the normal error of a measured value.
_ERRORS: Final = 64
#: Samples that each row needs for a covariance to mean something.
_FOR_CHI2: Final = 10
INSIDE = "inside"
OUTSIDE = "outside"
UNDETERMINED = "cannot be determined"
HELD = "held"
BROKEN = "not held"
_BAND: Final = (0.025, 0.975)


@attrs.frozen
class Value:
    """What a model gives at one point: the value, infinite outside the range, NaN where there is none; and why."""

    value: float
    why: str
    seconds: float


@attrs.frozen(kw_only=True)
class Judged:
    """A row, held against what was calculated."""

    data_set: str
    series: str
    models: str
    quantity: str
    unit: str
    condition: str
    measured: float
    uncertainty: float
    calculated: float
    calculated_low: float
    calculated_high: float
    ratio: float
    ratio_low: float
    ratio_high: float
    verdict: str
    status: str
    seconds: float


@attrs.frozen(kw_only=True)
class Group:
    """A series under some models, as a whole."""

    data_set: str
    series: str
    models: str
    chi2: float
    freedom: int
    probability: float
    status: str


@attrs.frozen(kw_only=True)
class Said:
    """A statement under some models."""

    data_set: str
    models: str
    text: str
    by: str
    verdict: str
    found: str


def held(
    of: tuple[str, str, str], series: Series, nominal: Sequence[Value], samples: Array, note: str
) -> tuple[list[Judged], Group]:
    """Hold values against the rows of a series; ``of`` are data set, series and models."""
    named = dict(zip(("data_set", "series", "models"), of, strict=True))
    rows = [_row(named, series, k, value, samples[:, k]) for k, value in enumerate(nominal)]
    return rows, _group(named, series, nominal, samples, note)


def _row(named: Mapping[str, str], series: Series, k: int, value: Value, samples: Array) -> Judged:
    row = series.rows[k]
    sampled = samples if samples.size else np.array([value.value])
    unknown = float(np.isnan(sampled).mean())
    status = value.why
    verdict = UNDETERMINED
    band = ratio_band = (math.nan, math.nan)
    if unknown <= _BAND[0]:
        known = sampled[~np.isnan(sampled)]
        error = row.uncertainty * _normal(_ERRORS)
        measured = row.measured + error
        differences = (known[:, None] - measured[None, :]).ravel()
        low, high = _quantiles(differences)
        verdict = INSIDE if low <= 0.0 <= high else OUTSIDE
        if value.why and math.isfinite(value.value):  # it is not what was measured
            verdict = UNDETERMINED
        band = _quantiles(known) if samples.size else band
        if (measured > 0.0).all():
            ratio_band = _quantiles((known[:, None] / measured[None, :]).ravel())
    else:
        status = status or f"{unknown:.0%} of the samples have no value"
    ratio = value.value / row.measured if row.measured else math.nan
    return Judged(
        **named, quantity=series.quantity, unit=series.unit, condition=row.label, measured=row.measured,
        uncertainty=row.uncertainty, calculated=value.value, calculated_low=band[0], calculated_high=band[1],
        ratio=ratio, ratio_low=ratio_band[0], ratio_high=ratio_band[1], verdict=verdict, status=status,
        seconds=value.seconds,
    )  # fmt: skip


def _quantiles(values: Array) -> tuple[float, float]:
    """Ends of the central 95 %; values may be infinite, so nothing is interpolated."""
    low, high = np.quantile(values, _BAND, method="inverted_cdf")
    return float(low), float(high)


def _normal(count: int) -> Array:
    from scipy.special import ndtri

    return np.asarray(ndtri((np.arange(count) + 0.5) / count))


def _group(
    named: Mapping[str, str], series: Series, nominal: Sequence[Value], samples: Array, note: str
) -> Group:
    from scipy.special import chdtrc

    count = len(nominal)
    values = np.array([one.value for one in nominal])
    sigma = np.array([row.uncertainty for row in series.rows])
    misses = values - np.array([row.measured for row in series.rows])
    status = ""
    if any(one.why and math.isfinite(one.value) for one in nominal):
        status = next(one.why for one in nominal if one.why)
    elif not np.isfinite(values).all() or not np.isfinite(samples).all():
        status = "a value is not known, or beyond the range"
    elif 0 < len(samples) < _FOR_CHI2 * count:
        status = f"{len(samples)} samples are too few for the covariance of {count} rows, which takes {_FOR_CHI2} a row"
    if status:
        return Group(
            **named, chi2=math.nan, freedom=count, probability=math.nan, status=note or status
        )
    covariance = np.diag(sigma**2)
    if len(samples):
        covariance = covariance + np.atleast_2d(np.cov(samples, rowvar=False))
    chi2 = float(misses @ np.linalg.solve(covariance, misses))
    return Group(
        **named, chi2=chi2, freedom=count, probability=float(chdtrc(count, chi2)), status=note
    )


def verdict_on(said: Statement, values: Array) -> str:
    """Tell whether values go as a statement says."""
    if said.expect == "none":
        return HELD if not np.isfinite(values).any() else BROKEN
    if np.isnan(values).any():
        return UNDETERMINED
    if said.expect in ("below", "above"):
        assert said.limit is not None
        return (
            HELD
            if (values < said.limit if said.expect == "below" else values > said.limit).all()
            else BROKEN
        )
    if np.isinf(values).sum() > 1:
        return UNDETERMINED
    moves = np.diff(values) * (1.0 if said.expect == "rises" else -1.0)
    least = said.by * np.abs(np.where(np.isfinite(values[:-1]), values[:-1], values[1:]))
    return HELD if (moves > least).all() else BROKEN
