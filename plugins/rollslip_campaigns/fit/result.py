"""What a fit has found, as a dataset.

- There is no number without a meaning: what the data do not determine is NaN, with a sentence beside it.
- The intervals are those of the profile likelihood; the covariance stands beside them.
- The oil is the ``[lubricant]`` table of the rig file with the fitted values in it, so that it is read as that one was.
"""

import hashlib
import importlib.metadata
import json
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.catalogue.registry import find
from rollslip.lubricant.oil import Lubricant
from rollslip.models import SliceModel, TractionModel
from rollslip.planning.provenance import (
    cited,
    describe_citations,
    describe_lubricant,
    describe_models,
    origin,
    packages_of,
)
from rollslip.results.dataset import about
from rollslip.search import Array
from rollslip.structure import resolved
from rollslip.studies import validity
from rollslip.units import format_quantity
from rollslip_campaigns.fit.findings import UNKNOWN, parameter_rows
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

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Fit", "dataset_of"]

#: Points of a drawn curve.
CURVE_POINTS: Final = 201
#: Probability below which chance is not believed.
_UNLIKELY: Final = 0.01
#: Slide-roll ratio where one surface stands; residuals that are rounding, relative to the largest friction.
_OPPOSED = 2.0
_ROUNDED = 1e-9


@attrs.frozen(eq=False, kw_only=True)
class Fit:
    """What was found: the estimate of the parameters that the data see, and why the others were kept."""

    problem: RigProblem
    parameters: list[Parameter]
    weight: Array
    kept: dict[str, str]
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
        """Values of the parameters at their coordinates."""
        return [float(p.value(one)) for p, one in zip(self.parameters, x, strict=True)]

    def friction(self, x: Array) -> Array:
        """Friction of all rows."""
        return friction_at(self.problem, self.parameters, x)


# Dataset ------------------------------------------------------------------------------------------------------------


def dataset_of(
    problem: RigProblem, fitted: Fit, wanted: Sequence[Parameter], wall_time: float
) -> "xr.Dataset":
    """Return what was found about the parameters that were asked for, see `rollslip_campaigns.fit.fit.fit`."""
    import xarray as xr

    fitted_friction = fitted.friction(
        fitted.estimate.best.x
    )  # the tables of the problem now hold its film
    film = np.empty(len(problem.data))
    for _, rows, slices in problem.tables:
        film[rows] = slices.film_thickness
    sets = operating_points(problem)
    c = problem.data.columns
    variables = {
        **_of_parameters(fitted, wanted),
        **_of_searches(fitted),
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
            fitted.sigma,
            about("1", "standard deviation of the friction, given or estimated"),
        ),
        "operating_point": ("row", _numbered(sets), about("1", "operating point")),
        "line": ("row", np.array(problem.data.lines), about("1", "line of the data file")),
        **_curves(fitted, sets),
    }
    names, used = ([p.name for p in parameters] for parameters in (wanted, fitted.parameters))
    coordinates = {
        "parameter": ("parameter", _texts(names), about("1", "parameter")),
        "with_parameter": ("with_parameter", _texts(names), about("1", "parameter")),
        "fitted_parameter": (
            "fitted_parameter",
            _texts(used),
            about("1", "parameter that the data see"),
        ),
        "level": ("level", np.array(LEVELS), about("1", "level of confidence")),
        "side": ("side", _texts(["lower", "upper"]), about("1", "side of an interval")),
    }
    dataset = xr.Dataset(variables, coords=coordinates)
    known = "friction_uncertainty" in c
    dataset.attrs |= {
        "freedom": fitted.estimate.freedom,
        "scatter": float(np.sqrt(np.mean(dataset["residual"].to_numpy() ** 2))),
        "uncertainties": "given" if known else "estimated from the residuals",
        "warnings": json.dumps(_warnings(fitted, sets)),
        "wall_time": wall_time,
    }
    if known:  # otherwise it is a sum of squares without a scale
        dataset.attrs["chi2"] = fitted.estimate.best.chi2
    dataset.attrs |= _provenance(fitted, dataset)
    return dataset


def _texts(values: Any) -> NDArray[Any]:
    return np.array(values, dtype=str)


def _of_parameters(fitted: Fit, wanted: Sequence[Parameter]) -> dict[str, Any]:
    """Variables of all parameters; those that were kept have a value and a status only."""
    estimate = fitted.estimate
    used = fitted.parameters
    place = [wanted.index(p) for p in used]
    unit = "see unit"
    n = len(wanted)
    points = 2 * PROFILE_POINTS + 1

    def whole(values: Any, *shape: int) -> Array:
        all_parameters = np.full((n, *shape), np.nan)
        all_parameters[place] = np.array(values, dtype=float).reshape(len(used), *shape)
        return all_parameters

    value = np.array([p.start for p in wanted])
    value[place] = fitted.values
    # covariances are of the logarithm, or of the value itself where the sign may change
    size = np.array([1.0 if p.logarithmic else p.size for p in used])
    covariance = np.full((n, n), np.nan)
    covariance[np.ix_(place, place)] = estimate.covariance * np.outer(size, size)
    error = np.sqrt(np.diag(covariance))
    limits = [p.value(profile.limits) for p, profile in zip(used, estimate.profiles, strict=True)]
    status = [fitted.kept.get(p.name, "") for p in wanted]
    limit_status = [["not determined"] * 2 for _ in wanted]
    for k, words in zip(place, _words(fitted), strict=True):
        status[k], limit_status[k] = words
    absolute = error * np.array(
        [v if p.logarithmic else 1.0 for p, v in zip(wanted, value, strict=True)]
    )
    determined = np.array([words == "determined" for words in status])
    held = [p.value(profile.x) for p, profile in zip(used, estimate.profiles, strict=True)]
    return {
        "unit": (
            "parameter",
            _texts([p.unit for p in wanted]),
            about("1", "unit of the parameter"),
        ),
        "meaning": (
            "parameter",
            _texts([p.doc for p in wanted]),
            about("1", "what the parameter is"),
        ),
        "start_value": (
            "parameter",
            [p.start for p in wanted],
            about(unit, "value before the fit"),
        ),
        "value": ("parameter", value, about(unit, "value")),
        "standard_error": (
            "parameter",
            np.where(determined, absolute, np.nan),
            about(unit, "standard error after the covariance"),
        ),
        "interval": (
            ("parameter", "level", "side"),
            whole(limits, len(LEVELS), 2),
            about(unit, "interval of confidence after the profile likelihood"),
        ),
        "status": ("parameter", _texts(status), about("1", "what the data tell")),
        "limit_status": (
            ("parameter", "side"),
            _texts(limit_status),
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
            whole(held, points),
            about(unit, "value held"),
        ),
        "profile_rise": (
            ("parameter", "profile_point"),
            whole([profile.rise for profile in estimate.profiles], points),
            about("1", "rise of chi2 over the variance"),
        ),
        "rise_limit": (
            "level",
            np.array(estimate.quantiles),
            about("1", "rise at which an interval ends"),
        ),
    }


def _of_searches(fitted: Fit) -> dict[str, Any]:
    """Variables about where searches ended, and of the principal directions."""
    estimate = fitted.estimate
    ends = np.full((len(estimate.others), 2, len(fitted.parameters)), np.nan)
    chi2 = np.full(len(estimate.others), np.nan)
    for k, minimum in enumerate(estimate.others):
        if minimum is not None:
            ends[k] = [fitted.values_at(minimum.start), fitted.values_at(minimum.x)]
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


def _words(fitted: Fit) -> list[tuple[str, list[str]]]:
    """Say of each fitted parameter what the data tell, and of both its limits."""
    estimate = fitted.estimate
    said = []
    for parameter, profile in zip(fitted.parameters, estimate.profiles, strict=True):
        given = np.isfinite(profile.limits[-1])
        sides = [
            "found"
            if limit
            else _no_limit(fitted, side, parameter.shown(parameter.value(end)), stop)
            for side, limit, end, stop in zip(
                ("lower", "upper"), given, profile.ends, profile.stops, strict=True
            )
        ]
        if given.all():
            status = "determined"
        elif given.any():
            status = sides[int(np.argmin(given))]
        else:
            weakest = np.abs(estimate.directions[int(np.argmax(estimate.spread))])
            partners = [
                p.name for p, part in zip(fitted.parameters, weakest, strict=True) if part > 0.1
            ]
            together = f"only a combination of {' and '.join(partners)} is"
            status = f"not determined: {together if len(partners) > 1 else '; '.join(sides)}"
        said.append((status, sides))
    return said


def _no_limit(fitted: Fit, side: str, end: str, stop: Stop) -> str:
    """Say of a side without a limit how far was looked, and whether that is what the data say."""
    if stop is None:
        return f"the {side} limit {UNKNOWN}: searched to {end}, the law has no value beyond"
    if not stop:
        return f"the data give no {side} limit, searched to {end}"
    held = [fitted.parameters[j] for j in stop]
    ranges = " and ".join(
        f"{p.name} (searched from {p.shown(p.low)} to {p.shown(p.high)})" for p in held
    )
    return (
        f"the {side} limit {UNKNOWN}: searched to {end}, beyond which {ranges} would have to leave its range; start "
        f"{' or '.join(p.name for p in held)} elsewhere, or fit without it"
    )


def _numbered(sets: Sequence[Indices]) -> Indices:
    numbers = np.empty(sum(rows.size for rows in sets), dtype=np.intp)
    for k, rows in enumerate(sets):
        numbers[rows] = k
    return numbers


def _curves(fitted: Fit, sets: Sequence[Indices]) -> dict[str, Any]:
    """The fitted curve of each operating point, at its mean conditions, and these."""
    problem = fitted.problem
    (lubricant, traction) = fitted.laws
    chain = problem.chain_of(traction)
    c = problem.data.columns
    slip = np.empty((len(sets), CURVE_POINTS))
    friction = np.empty((len(sets), CURVE_POINTS))
    held = np.empty((3, len(sets)))
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
        held[:, k] = (temperature, slices.pressure[0], speed)
    return {
        "curve_slip": (("point", "curve_point"), slip, about("1", "slide-roll ratio")),
        "curve_friction": (
            ("point", "curve_point"),
            friction,
            about("1", "fitted friction coefficient"),
        ),
        "point_temperature": ("point", held[0], about("K", "temperature")),
        "point_pressure": ("point", held[1], about("Pa", "mean Hertz pressure")),
        "point_speed": ("point", held[2], about("m/s", "rolling speed")),
    }


# Warnings -----------------------------------------------------------------------------------------------------------


def _warnings(fitted: Fit, sets: Sequence[Indices]) -> list[str]:
    """Say what a reader of the result has to know."""
    from scipy.special import chdtrc

    problem = fitted.problem
    estimate = fitted.estimate
    said = []
    if (
        "friction_uncertainty" in problem.data.columns
        and chdtrc(estimate.freedom, estimate.best.chi2) < _UNLIKELY
    ):
        said.append(
            f"the model does not fit the data within their uncertainties (chi2 {estimate.best.chi2:.4g} at "
            f"{estimate.freedom} degrees of freedom): values and intervals hold only as far as it does"
        )
    slides = np.abs(problem.data.columns["slide_roll_ratio"])
    if many := int(np.count_nonzero(slides > _OPPOSED)):
        said.append(
            f"{many} of {slides.size} rows have a slide-roll ratio above 2, at most {slides.max():.3g}, as surfaces "
            "that run against each other have; so has per cent under [1]: then write slide_roll_ratio [%]"
        )
    largest = float(np.abs(problem.data.columns["friction"]).max())
    exact = float(np.abs(estimate.best.residuals * fitted.weight).max()) <= _ROUNDED * largest
    chance = 1.0 if exact else _chance_of_order(estimate.best.residuals, sets)
    if chance < _UNLIKELY:
        said.append(
            f"the residuals are not random along the curves (probability {chance:.1g}): the model misses something "
            "that the data show, and the intervals, which take the errors for independent, are too narrow"
        )
    said += _other_minima(fitted)
    error = np.sqrt(np.diag(estimate.covariance))
    bent = [
        p.name
        for p, x, profile, width in zip(
            fitted.parameters, estimate.best.x, estimate.profiles, error, strict=True
        )
        if np.isfinite(profile.limits[-1]).all()
        and not np.all(_same_size(profile.limits[0] - x, width))
    ]
    if bent:
        said.append(
            f"the law is far from linear within the intervals of {', '.join(bent)}: what follows from the covariance, "
            "standard error and correlation, does not hold; the intervals do"
        )
    fitted.friction(estimate.best.x)  # the tables keep what was evaluated last
    rows = [validity.Filled("", slices, np.ones(len(slices))) for _, _, slices in problem.tables]
    # oil and traction are what is fitted: within the data their values make up for what the laws are off
    given = [model for kind, model in problem.models.items() if kind != "traction"]
    said += [
        one.text for one in validity.told(validity.outside(given, rows), None, what="of the rows")
    ]
    return said


def _same_size(distances: Array, width: float) -> NDArray[np.bool_]:
    """Whether distances are within a factor of two of the width expected."""
    fraction = np.abs(distances) / width
    return np.asarray((fraction > 0.5) & (fraction < 2.0))


def _other_minima(fitted: Fit) -> list[str]:
    estimate = fitted.estimate
    rises = [
        (end, (end.chi2 - estimate.best.chi2) / estimate.scale**2)
        for end in estimate.others
        if end is not None
    ]
    elsewhere = [(end, rise) for end, rise in rises if end.converged and rise > 0.01]
    if not elsewhere:
        return []
    second, rise = min(elsewhere, key=lambda pair: pair[1])
    values = zip(fitted.parameters, fitted.values_at(second.x), strict=True)
    at = ", ".join(f"{p.name} {p.shown(value)}" for p, value in values)
    judged = (
        "which the data do not exclude" if rise < estimate.quantiles[-1] else "which fits worse"
    )
    return [
        f"{len(elsewhere)} of {len(estimate.others)} searches ended in another minimum, {judged} (chi2 higher by "
        f"{rise:.3g} variances): {at}"
    ]


def _chance_of_order(residuals: Array, sets: Sequence[Indices]) -> float:
    """Probability that random residuals change their sign along the curves as seldom as these do."""
    from scipy.special import bdtr

    changes = sum(int(np.count_nonzero(np.diff(residuals[rows] > 0.0))) for rows in sets)
    return float(bdtr(changes, sum(rows.size - 1 for rows in sets), 0.5))


# Origin -------------------------------------------------------------------------------------------------------------


def _provenance(fitted: Fit, dataset: "xr.Dataset") -> dict[str, Any]:
    problem = fitted.problem
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
        **describe_citations(cited([*models.values(), oil.pressure_viscosity_law], oil.references)),
        evaluations=problem.evaluated,
        **_tables(fitted, dataset),
    )


def _tables(fitted: Fit, dataset: "xr.Dataset") -> dict[str, str]:
    """Tables of a scene with what was fitted, as JSON."""
    problem = fitted.problem
    values = fitted.values
    oil = {
        p.key[0]: value / p.unit_value
        for p, value in zip(fitted.parameters, values, strict=True)
        if p.of_oil
    }
    written = resolved(problem.rig.lubricant)
    at = " to ".join(
        dict.fromkeys(
            format_quantity(T, "K", 4) for T, *_ in (problem.tables[0], problem.tables[-1])
        )
    )
    film = "measured film" if problem.film is None else f"film {problem.film.name}"
    values_told = ", ".join(
        f"{name} {value} (95 %: {limits}; {status})"
        for name, value, _, _, limits, status in parameter_rows(dataset)
    )
    source = (
        f"Fitted by rollslip {importlib.metadata.version('rollslip')} to {Path(problem.data.source).name} (sha256 "
        f"{problem.data.sha256}) with traction {problem.traction.name} and {film} at {at}: {values_told}."
    )
    source = " ".join(filter(None, (str(written.get("source", "")), source)))
    found = {
        p.key: value for p, value in zip(fitted.parameters, values, strict=True) if not p.of_oil
    }
    constants: dict[str, Any] = {**problem.lubricant.models}
    for path, value in found.items():
        law = problem.traction
        for name in path[:-1]:
            law = getattr(law, name)
        constants[law.name] = {**constants.get(law.name, {}), path[-1]: value}
    models = {"models": constants} if constants else {}
    tables = {"lubricant_table": json.dumps({**written, **oil, **models, "source": source})}
    if found:
        tables["traction_table"] = json.dumps(_model_table(fitted.laws[1], found))
    return tables


def _model_table(
    model: SliceModel, left: Collection[tuple[str, ...]], *at: str
) -> dict[str, object]:
    """A model as a scene writes it, less what stands with the oil, by paths from ``at``."""
    table: dict[str, object] = {"model": model.name}
    for attribute in getattr(model, "__attrs_attrs__", ()):
        value = getattr(model, attribute.name)
        path = (*at, attribute.name)
        if (
            attribute.metadata.get("key", attribute.name) is not None and path not in left
        ):  # what the oil puts in
            table[attribute.name] = (
                _model_table(value, left, *path) if isinstance(value, SliceModel) else value
            )
    return table
