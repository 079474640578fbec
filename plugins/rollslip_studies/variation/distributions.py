"""Distributions of uncertain values, and correlations between them, as a scene states them in ``[uncertainty]``.

- Inverse transform sampling: a distribution is given by its quantile function, of which the argument, a probability
  between 0 and 1, is sampled. Random and quasi-random samples, copulas and truncation are the same for all of them.
- ``scatter`` is the relative standard deviation, sigma/|mean|, which data sheets and handbooks quote; of a uniform
  distribution it is the relative half width. The default of the centre is the value of the scene.
- Correlations are those of a Gaussian copula, between the normal scores. The rank correlation of the values after
  Spearman is then 6/pi asin(rho/2), at most 0.019 less in magnitude.

Source: R. B. Nelsen, An Introduction to Copulas, 2nd ed., Springer, 2006, chapter 2.
"""

import abc
import math
from collections.abc import Mapping, Sequence
from statistics import NormalDist
from typing import Any, Final

import attrs
import numpy as np

from rollslip.errors import did_you_mean, nearest
from rollslip.fields import FieldError, in_range, parameter, positive, refuse_if
from rollslip.scene.changes import Quantity, describe_unknown_key
from rollslip.search import Array
from rollslip.structure import Location, structure
from rollslip.toml import as_list
from rollslip.units import UnitError, as_written, format_quantity, quantity

__all__ = ["DISTRIBUTIONS", "Distribution", "LogUniform", "Uncertainty", "read_uncertainty"]

_optional = attrs.validators.optional(positive)
#: Largest number of values of a normal distribution for which the standard library is used. Evaluating them one by one
#: takes less time than importing SciPy. Doubled, nothing changes but time. Chosen.
_MAX_WITHOUT_SCIPY: Final = 4
#: Least eigenvalue of a correlation matrix, which is positive definite but for rounding. Halved, nothing changes in
#: practice; at 0 the Cholesky factor of a singular matrix may fail.
_MIN_EIGENVALUE: Final = 1e-12


def own_unit(doc: str) -> Any:
    """Return a field in the unit of the uncertain value, which is known only when the scene is read."""
    return attrs.field(default=None, metadata={"doc": doc, "unit": None, "own_unit": True})


@attrs.frozen(kw_only=True)
class Distribution(abc.ABC):
    """Probability distribution of an uncertain value."""

    at_least: Any = own_unit(
        "values below do not occur: the distribution is cut off there and scaled up"
    )
    at_most: Any = own_unit("values above do not occur")

    def __attrs_post_init__(self) -> None:
        refuse_if(
            None not in (self.at_least, self.at_most) and not self.at_least < self.at_most,
            "at_most",
            "must be above at_least",
        )

    @abc.abstractmethod
    def centred(self, nominal: float | None) -> "Distribution":
        """Return the distribution with its parameters complete, by default from the value of the scene."""

    def quantile(self, probability: Array) -> Array:
        """Return the values below which fractions of the distribution lie; both bounds of a truncation are included."""
        low = 0.0
        if self.at_least is not None:
            low = float(self._fraction(np.asarray(self.at_least, dtype=float)))
        high = 1.0
        if self.at_most is not None:
            high = float(self._fraction(np.asarray(self.at_most, dtype=float)))
        refuse_if(
            not high > low,
            "at_least",
            "leaves nothing of the distribution; move at_least or at_most",
        )
        values = self._quantile(low + np.asarray(probability, dtype=float) * (high - low))
        if self.at_least is None and self.at_most is None:
            return values
        return np.clip(values, self.at_least, self.at_most)

    @abc.abstractmethod
    def _quantile(self, probability: Array) -> Array:
        """Return the quantiles of the distribution without truncation, the inverse of `_fraction`."""

    @abc.abstractmethod
    def _fraction(self, value: Array) -> Array:
        """Return the cumulative probability of values, without truncation."""


def _required(value: Any, name: str, nominal: float | None) -> float:
    """Return a parameter, by default the value of the scene; FieldError if there is neither."""
    refuse_if(
        value is None and nominal is None,
        name,
        "missing, and the scene has no value of its own to take for it",
    )
    return float(nominal if value is None else value)  # type: ignore[arg-type]


def _check_alternatives(first: Any, second: Any, names: tuple[str, str]) -> None:
    """Raise a FieldError unless exactly one of two parameters is given."""
    refuse_if(
        (first is None) == (second is None), names[0], f"give either {names[0]} or {names[1]}"
    )


def _normal_quantile(probability: Array) -> Array:
    """Return quantiles of the standard normal distribution."""
    if probability.size <= _MAX_WITHOUT_SCIPY and bool(
        ((probability > 0.0) & (probability < 1.0)).all()
    ):
        return np.array([NormalDist().inv_cdf(p) for p in probability.ravel().tolist()]).reshape(
            probability.shape
        )
    from scipy.special import ndtri

    return np.asarray(ndtri(probability))


def _normal_probability(score: Array) -> Array:
    """Return cumulative probabilities of the standard normal distribution."""
    if score.size <= _MAX_WITHOUT_SCIPY:
        return np.array([0.5 * math.erfc(-z / 2.0**0.5) for z in score.ravel().tolist()]).reshape(
            score.shape
        )
    from scipy.special import ndtr

    return np.asarray(ndtr(score))


@attrs.frozen(kw_only=True)
class Normal(Distribution):
    """x = mean + deviation z, with z normal."""

    mean: Any = own_unit("mean; by default the value of the scene")
    deviation: Any = own_unit("standard deviation")
    scatter: float | None = parameter(
        default=None,
        unit="1",
        doc="standard deviation over mean, in place of deviation",
        validator=_optional,
    )

    def centred(self, nominal: float | None) -> "Normal":
        """Return the distribution with its mean and standard deviation."""
        _check_alternatives(self.deviation, self.scatter, ("deviation", "scatter"))
        mean = _required(self.mean, "mean", nominal)
        deviation = self.deviation if self.scatter is None else self.scatter * abs(mean)
        refuse_if(
            not deviation > 0.0,
            "deviation",
            "must be above 0; of a mean of 0 a relative scatter says nothing",
        )
        return attrs.evolve(self, mean=mean, deviation=deviation, scatter=None)

    def _quantile(self, probability: Array) -> Array:
        return np.asarray(self.mean + self.deviation * _normal_quantile(probability))

    def _fraction(self, value: Array) -> Array:
        return np.asarray(_normal_probability((value - self.mean) / self.deviation))


@attrs.frozen(kw_only=True)
class LogNormal(Distribution):
    """ln x = ln median + s z, with z normal and scatter^2 = exp(s^2) - 1; s is given itself as deviation_of_ln."""

    median: Any = own_unit("median; by default the value of the scene")
    scatter: float | None = parameter(
        default=None, unit="1", doc="standard deviation over mean", validator=_optional
    )
    deviation_of_ln: float | None = parameter(
        default=None,
        unit="1",
        doc="standard deviation s of the logarithm, in place of scatter",
        validator=_optional,
    )

    def centred(self, nominal: float | None) -> "LogNormal":
        """Return the distribution with its median."""
        median = _required(self.median, "median", nominal)
        refuse_if(not median > 0.0, "median", "must be above 0")
        refuse_if(
            self.scatter is None and self.deviation_of_ln is None,
            "scatter",
            "missing, but required (standard deviation over mean); such as 0.1",
        )
        _check_alternatives(self.scatter, self.deviation_of_ln, ("scatter", "deviation_of_ln"))
        return attrs.evolve(self, median=median)

    @property
    def _sigma(self) -> float:
        """Standard deviation s of the logarithm."""
        if self.deviation_of_ln is not None:
            return self.deviation_of_ln
        return math.sqrt(math.log1p(float(self.scatter or 0.0) ** 2))

    def _quantile(self, probability: Array) -> Array:
        return np.asarray(self.median * np.exp(self._sigma * _normal_quantile(probability)))

    def _fraction(self, value: Array) -> Array:
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(
                _normal_probability(np.log(np.maximum(value, 0.0) / self.median) / self._sigma)
            )


@attrs.frozen(kw_only=True)
class Uniform(Distribution):
    """Constant density between low and high."""

    low: Any = own_unit("smallest value")
    high: Any = own_unit("largest value")
    scatter: float | None = parameter(
        default=None,
        unit="1",
        doc="half width over the value of the scene, in place of low and high",
        validator=_optional,
    )

    def centred(self, nominal: float | None) -> "Uniform":
        """Return the distribution with its bounds."""
        if self.scatter is not None and self.low is None and self.high is None:
            centre = _required(None, "low", nominal)
            half_width = abs(centre) * self.scatter
            bounds = {"low": centre - half_width, "high": centre + half_width}
            return attrs.evolve(self, **bounds, scatter=None).centred(None)
        refuse_if(
            self.scatter is not None or self.low is None or self.high is None,
            "low",
            "give low and high, or scatter alone",
        )
        refuse_if(not self.low < self.high, "high", "must be above low")
        return self

    def _quantile(self, probability: Array) -> Array:
        return np.asarray(self.low + probability * (self.high - self.low))

    def _fraction(self, value: Array) -> Array:
        return np.asarray(np.clip((value - self.low) / (self.high - self.low), 0.0, 1.0))


@attrs.frozen(kw_only=True)
class LogUniform(Distribution):
    """Constant density of the logarithm between low and high."""

    low: Any = own_unit("smallest value")
    high: Any = own_unit("largest value")

    def centred(self, nominal: float | None) -> "LogUniform":
        """Return the distribution after a check of its bounds."""
        low = _required(self.low, "low", None)
        high = _required(self.high, "high", None)
        refuse_if(not 0.0 < low < high, "high", "must be above low, and low above 0")
        return self

    def _quantile(self, probability: Array) -> Array:
        return np.asarray(self.low * np.exp(probability * math.log(self.high / self.low)))

    def _fraction(self, value: Array) -> Array:
        return np.asarray(
            np.log(np.clip(value, self.low, self.high) / self.low) / math.log(self.high / self.low)
        )


@attrs.frozen(kw_only=True)
class Triangular(Distribution):
    """Density that rises from low to mode and falls to high, in straight lines."""

    low: Any = own_unit("smallest value")
    mode: Any = own_unit("most probable value; by default the value of the scene")
    high: Any = own_unit("largest value")

    def centred(self, nominal: float | None) -> "Triangular":
        """Return the distribution with its mode."""
        low = _required(self.low, "low", None)
        high = _required(self.high, "high", None)
        mode = _required(self.mode, "mode", nominal)
        refuse_if(
            not (low <= mode <= high and low < high),
            "mode",
            f"low, mode and high must ascend, not {low:g}, {mode:g}, {high:g}",
        )
        return attrs.evolve(self, mode=mode)

    def _quantile(self, probability: Array) -> Array:
        width = self.high - self.low
        rise = self.mode - self.low
        below = self.low + np.sqrt(probability * width * rise)
        above = self.high - np.sqrt((1.0 - probability) * width * (width - rise))
        return np.asarray(np.where(probability * width <= rise, below, above))

    def _fraction(self, value: Array) -> Array:
        width = self.high - self.low
        rise = self.mode - self.low
        v = np.clip(value, self.low, self.high)
        with np.errstate(divide="ignore", invalid="ignore"):
            below = (v - self.low) ** 2 / (width * rise)
            above = 1.0 - (self.high - v) ** 2 / (width * (width - rise))
        return np.asarray(np.where(v <= self.mode, below, above) if rise > 0.0 else above)


#: Name in a scene -> class.
DISTRIBUTIONS: Final[Mapping[str, type[Distribution]]] = {
    "normal": Normal,
    "lognormal": LogNormal,
    "uniform": Uniform,
    "log-uniform": LogUniform,
    "triangular": Triangular,
}


@attrs.frozen(kw_only=True)
class Correlation:
    """Correlation between two uncertain values."""

    between: tuple[str, ...] = parameter(doc="keys of the two values")
    coefficient: float = parameter(
        unit="1", doc="correlation of their normal scores", validator=in_range(-1.0, 1.0, open=True)
    )

    def __attrs_post_init__(self) -> None:
        refuse_if(
            len(self.between) != 2 or self.between[0] == self.between[1],
            "between",
            "two different keys are expected",
        )


@attrs.frozen(eq=False)
class Uncertainty:
    """Uncertain values of a scene: their distributions by key, and the correlation matrix of their normal scores."""

    distributions: Mapping[str, Distribution]
    correlation: Array

    def values(self, probabilities: Array) -> Array:
        """Return samples of the values for samples of independent probabilities between 0 and 1, both (n, d)."""
        p = np.array(probabilities, dtype=float)
        mixed = [k for k in range(p.shape[1]) if np.any(np.delete(self.correlation[k], k) != 0.0)]
        if mixed:
            from scipy.special import ndtr, ndtri

            factor = np.linalg.cholesky(self.correlation[np.ix_(mixed, mixed)])
            # sums in a fixed order: a product of matrices may round differently for one sample and for many
            scores = ndtri(p[:, mixed])
            p[:, mixed] = ndtr(sum(scores[:, [k]] * factor[:, k] for k in range(len(mixed))))
        columns = [
            distribution.quantile(p[:, k])
            for k, distribution in enumerate(self.distributions.values())
        ]
        return np.column_stack(columns) if columns else np.empty((p.shape[0], 0))


def read_uncertainty(
    raw: Mapping[str, object], where: Location, known: dict[str, Quantity], problems: list[str]
) -> Uncertainty:
    """Return the uncertain values of a scene; all its faults are added to ``problems``.

    Parameters
    ----------
    raw : mapping of str to object
        The table ``[uncertainty]``.
    where : Location
        Its location in the scene.
    known : dict of str to Quantity
        The values of the scene that can be varied, by key.
    problems : list of str
        Messages, to which the faults are appended.
    """
    distributions: dict[str, Distribution] = {}
    for key, table, location in _distribution_tables(
        {k: v for k, v in raw.items() if k != "correlation"}, "", where
    ):
        if not isinstance(table, Mapping):
            problems.append(
                location.message(
                    f"a table with distribution = 'NAME' is expected, not {as_written(table)}"
                )
            )
        elif key not in known:
            problems.append(location.message(describe_unknown_key(key, known)))
        elif (distribution := _distribution(table, known[key], location, problems)) is not None:
            distributions[known[key].key] = distribution
    return Uncertainty(
        distributions,
        _correlations(
            raw.get("correlation", ()), where.at("correlation"), list(distributions), problems
        ),
    )


def _distribution_tables(table: Mapping[str, object], prefix: str, where: Location) -> Any:
    """Yield key, table and location of each distribution, also if the value there is not a table."""
    for key, value in table.items():
        path = f"{prefix}.{key}" if prefix else key
        if isinstance(value, Mapping) and "distribution" not in value and value:
            yield from _distribution_tables(value, path, where.at(key))
        else:
            yield path, value, where.at(key)


def _distribution(
    table: Mapping[str, object], uncertain: Quantity, where: Location, problems: list[str]
) -> Distribution | None:
    """Return the distribution of an uncertain value; None if it is wrong, with its faults in ``problems``."""
    if uncertain.unit is None:
        problems.append(
            where.message(
                "is not a number with a unit, and only these can be uncertain; sweep it instead"
            )
        )
        return None
    name = table.get("distribution")
    if not isinstance(name, str) or name not in DISTRIBUTIONS:
        similar_names = nearest(name, DISTRIBUTIONS, count=1) if isinstance(name, str) else []
        hint = did_you_mean(similar_names, f"there are: {', '.join(DISTRIBUTIONS)}")
        problems.append(
            where.at("distribution").message(
                f"no distribution is called {as_written(name)}; {hint}"
            )
        )
        return None
    faults: list[str] = []
    cls = DISTRIBUTIONS[name]
    values = {key: value for key, value in table.items() if key != "distribution"}
    for attribute in attrs.fields(cls):
        if attribute.metadata.get("own_unit") and attribute.name in values:
            try:
                values[attribute.name] = _in_unit(
                    values[attribute.name], uncertain.unit, attribute.name == "deviation"
                )
            except UnitError as error:
                faults.append(where.at(attribute.name).message(str(error)))
                del values[attribute.name]
    distribution = structure(cls, values, where, faults)
    if distribution is not None and not faults:
        nominal = uncertain.value if isinstance(uncertain.value, float) else None
        try:
            distribution = distribution.centred(nominal)
            distribution.quantile(np.array([0.5]))
            return distribution
        except FieldError as error:
            faults.append(where.at(error.field).message(error.reason))
    problems += faults
    return None


def _in_unit(raw: object, unit: str, difference: bool) -> float:
    """Return a value in the unit of the uncertain value; a difference of temperatures must not be a temperature."""
    if difference and unit == "K" and isinstance(raw, str) and "deg" in raw.replace("°", "deg"):
        raise UnitError(
            f"{as_written(raw)} is a temperature, here a difference of temperatures is expected, such as '5 K'"
        )
    return quantity(raw, unit)


def _correlations(raw: object, where: Location, names: Sequence[str], problems: list[str]) -> Array:
    """Return the correlation matrix of the normal scores, in the order of the names."""
    matrix = np.eye(len(names))
    before = len(problems)
    for k, table in enumerate(as_list(raw)):
        correlation = structure(Correlation, table, where.at(k), problems)
        if correlation is None:
            continue
        absent = [key for key in correlation.between if key not in names]
        for key in absent:
            hint = did_you_mean(
                nearest(key, names, count=1), f"there are: {', '.join(names) or 'none'}"
            )
            problems.append(
                where.at(k).at("between").message(f"{key!r} has no distribution here; {hint}")
            )
        if not absent:
            i, j = (names.index(key) for key in correlation.between)
            if matrix[i, j] != 0.0:
                problems.append(
                    where.at(k)
                    .at("between")
                    .message("these two have a correlation already; state it once")
                )
            matrix[i, j] = matrix[j, i] = correlation.coefficient
    if len(problems) == before and names and np.linalg.eigvalsh(matrix)[0] < _MIN_EIGENVALUE:
        problems.append(
            where.message(
                "no values can be correlated so: the matrix of the coefficients is not positive definite; lower some"
            )
        )
    return matrix


def shown(distribution: Distribution, unit: str) -> str:
    """Return the description of a distribution, for example "normal, mean 3415 N, deviation 100 N".

    Parameters
    ----------
    distribution : Distribution
        The distribution.
    unit : str
        SI unit of the value.
    """
    name = next(name for name, cls in DISTRIBUTIONS.items() if cls is type(distribution))
    parts = []
    for attribute in attrs.fields(type(distribution)):
        if (value := getattr(distribution, attribute.name)) is not None:
            text = f"{value:g}"
            if attribute.name == "deviation" and unit == "K":
                text = f"{value:g} K"
            elif attribute.metadata.get("own_unit"):
                text = format_quantity(value, unit)
            parts.append(f"{attribute.name.replace('_', ' ')} {text}")
    return ", ".join((name, *parts))
