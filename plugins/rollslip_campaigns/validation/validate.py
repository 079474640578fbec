"""Compare models with data sets: calculated over measured values with the uncertainty of both, and statements.

- Models are those of the scene of a data set, and all combinations of those that are named, in its place as
  ``rollslip compare`` puts them there.
- What is estimated, or known to scatter, is sampled by a Sobol sequence: the table ``[uncertainty]`` of the scene, or
  else the scatter of its oil. All rows of a series and all models have the same samples, so that common errors are
  common.
- Rows, chi-square and statements are evaluated in module `residuals`. Chi-square is reported where all rows have finite
  values and there are ten samples for each row; elsewhere there is a reason.
"""

import itertools
import math
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import assemble
from rollslip.bearing.chain import Chain
from rollslip.catalogue.discovery import available, find, get_class
from rollslip.catalogue.registry import get_model
from rollslip.errors import DomainError, PluginError, RollslipError, SceneError
from rollslip.fields import FieldError
from rollslip.lubricant.oil import Lubricant
from rollslip.models import SliceModel
from rollslip.planning.campaign import listed
from rollslip.planning.provenance import collect_citations, describe_citations, origin, packages_of
from rollslip.results.dataset import about, xr
from rollslip.scene.changes import evolve
from rollslip.scene.values import Scene
from rollslip.search import Array
from rollslip.structure import Location, raise_problem_if, raise_problems
from rollslip.studies.quantities import quantities
from rollslip.studies.study import settings
from rollslip.units import quantity as in_unit
from rollslip_campaigns.comparison.choices import KINDS, read_choice, refuse
from rollslip_campaigns.fit.problem import RigProblem, rig_problem
from rollslip_campaigns.measurement import Measurement
from rollslip_campaigns.measurement.values import ContactSeries, Series, Statement
from rollslip_campaigns.sweep.sampling import probabilities
from rollslip_campaigns.validation import RankingSettings, ValidationSettings
from rollslip_campaigns.validation.findings import UNDETERMINED, format_value
from rollslip_campaigns.validation.observables import observe
from rollslip_campaigns.validation.predictions import Predictions, measurement_named, predictions_of
from rollslip_campaigns.validation.residuals import (
    Value,
    check_statement,
    compare_series,
)
from rollslip_studies.variation.distributions import DISTRIBUTIONS, read_uncertainty
from rollslip_studies.variation.scatter import with_scatter

__all__ = [
    "AS_STATED",
    "Combination",
    "Validation",
    "evaluate_statement",
    "nominal_values",
    "plan_validation",
    "run_validation",
]

#: Default number of samples of a contact: chi-square needs ten a row. Twice as many narrow what is left to chance in a
#: band by a third. Chosen: a power of two, as Sobol sequences need.
_CONTACT_SAMPLES: Final = 128
#: Default number of samples of a bearing, where each takes a third of a second: the 5 and 95 % bounds are then known to
#: a tenth of the width of the band, of 128 samples to a twentieth. Twice as many let `rollslip validate` take twice its
#: minutes. Chosen, likewise.
_BEARING_SAMPLES: Final = 32


@attrs.frozen
class Combination:
    """Models by kind in place of those of a data set; an empty mapping for its own models."""

    label: str
    models: Mapping[str, str]


#: The models of the scene of a data set.
AS_STATED: Final = Combination("as stated", {})


@attrs.frozen(kw_only=True)
class Validation:
    """Data sets and the models that are compared with them.

    Attributes
    ----------
    sets : tuple of Measurement
        The data sets.
    combinations : tuple of Combination
        The models.
    predictions : tuple of Predictions
        Predictions of other programs.
    samples, bearing_samples, seed : int
        Numbers of samples of what scatters, for contacts and for bearings, and seed of the sequence.
    """

    sets: tuple[Measurement, ...]
    combinations: tuple[Combination, ...]
    predictions: tuple[Predictions, ...] = ()
    samples: int
    bearing_samples: int = 0
    seed: int

    def origin(self, models: Iterable[SliceModel] = (), **facts: Any) -> dict[str, Any]:
        """Return facts as attributes, with data sets, packages, and citations of data and models.

        Parameters
        ----------
        models : iterable of SliceModel
            Models to cite.
        **facts
            Attributes.
        """
        offers = [
            find("measurement", measurement.name)
            for measurement in self.sets
            if measurement.name in available("measurement")
        ]
        offers += [
            find(kind, name)
            for combination in self.combinations
            for kind, name in combination.models.items()
        ]
        return origin(
            **facts,
            source=", ".join(measurement.name for measurement in self.sets),
            packages=packages_of(offers),
            **describe_citations(
                collect_citations(
                    models, [cite for measurement in self.sets for cite in measurement.references]
                )
            ),
        )


def plan_validation(requested: "ValidationSettings | RankingSettings") -> Validation:
    """Return the data sets, models and predictions that are requested, after a check of all names."""
    names = requested.data
    names = [names] if isinstance(names, str | Path | Measurement) else list(names)
    sets = tuple(measurement_named(name) for name in names or available("measurement"))
    raise_problem_if(
        not sets, "there is no data set; 'rollslip plugins new NAME --kind measurement' writes one"
    )
    raise_problem_if(
        requested.samples == 1, "samples: a band needs 2 at least, or 0 for none, not 1"
    )
    known = {measurement.name for measurement in sets}
    combinations = _combinations(requested)
    predictions = predictions_of(requested.predictions, names)
    for prediction in predictions:
        raise_problem_if(
            prediction.data_set not in known,
            f"{prediction.source}: predictions of data set {prediction.data_set!r}, which is not requested",
        )
    return Validation(
        sets=sets,
        combinations=combinations,
        predictions=tuple(predictions),
        samples=_CONTACT_SAMPLES if requested.samples is None else requested.samples,
        bearing_samples=_BEARING_SAMPLES if requested.samples is None else requested.samples,
        seed=requested.seed,
    )


def _combinations(requested: "ValidationSettings | RankingSettings") -> tuple[Combination, ...]:
    """Return the models as stated, and all combinations of the named models, whose names are checked."""
    laws = {kind: listed(getattr(requested, kind)) for kind in KINDS}
    for kind, names in laws.items():
        for name in names:
            find(kind, name)
    if not (named := {kind: names for kind, names in laws.items() if names}):
        return (AS_STATED,)
    return (
        AS_STATED,
        *(
            Combination(" + ".join(names), dict(zip(named, names, strict=True)))
            for names in itertools.product(*named.values())
        ),
    )


# Running ------------------------------------------------------------------------------------------------------------


def run_validation(
    plan: Validation, report: Callable[[str, float], None] = lambda text, fraction: None
) -> "xr.Dataset":
    """Return the comparison of models with data; see `rollslip.validate`.

    Parameters
    ----------
    plan : Validation
        Data sets, models and predictions.
    report : callable
        Receives the progress: a text, and the fraction that is done.
    """
    start = time.perf_counter()
    rows = list[dict[str, Any]]()
    groups = list[dict[str, Any]]()
    statements = list[dict[str, Any]]()
    warnings = list[str]()
    parts = [
        (measurement, part, combination)
        for measurement in plan.sets
        for part in list[Series | Statement]([*measurement.series, *measurement.statements])
        for combination in plan.combinations
    ]
    for k, (measurement, part, combination) in enumerate(parts):
        text = part.text if isinstance(part, Statement) else part.name
        report(f"{measurement.name}: {text}, {combination.label}", k / len(parts))
        if isinstance(part, Statement):
            statements.append(evaluate_statement(measurement, part, combination))
        elif part.rows:
            compared, group = _compare_models(plan, measurement, part, combination, warnings)
            rows += compared
            groups.append(group)
    for prediction in plan.predictions:
        measurement = next(known for known in plan.sets if known.name == prediction.data_set)
        for series in measurement.series:
            if (values := prediction.values_of(series)) is not None:
                compared, group = compare_series(
                    (measurement.name, series.name, prediction.program), series, *values, ""
                )
                rows += compared
                groups.append(group)
    warnings += [
        f"{measurement.name} is a form without numbers: {measurement.recipe}"
        for measurement in plan.sets
        if measurement.is_form
    ]
    return _dataset(plan, rows, groups, statements, warnings, time.perf_counter() - start)


def _scene_with(scene: Scene, combination: Combination) -> Scene:
    """Return a scene with the models of a combination."""
    problems = list[str]()
    unknown = list[PluginError]()
    tables = {
        f"models.{kind}": dict(read_choice(scene, kind, name, problems, unknown).table)
        for kind, name in combination.models.items()
    }
    refuse(problems, unknown)
    return evolve(scene, tables, si=True)


def _compare_models(
    plan: Validation,
    measurement: Measurement,
    series: Series,
    combination: Combination,
    warnings: list[str],
) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    """Return the comparison of a series with models; notes are added to `warnings`, an error is the status."""
    labels = (measurement.name, series.name, combination.label)
    try:
        if isinstance(series, ContactSeries):
            nominal, samples, note = _contact_values(series, combination, plan)
        else:
            assert series.scene is not None
            nominal, samples, note = _bearing_values(
                series, _scene_with(series.scene, combination), plan
            )
    except RollslipError as error:
        reason = str(error).splitlines()[0]
        failed = [Value(math.nan, reason, math.nan) for _ in series.rows]
        return compare_series(
            labels, series, failed, np.full((0, len(series.rows)), math.nan), reason
        )
    if note:
        warnings.append(f"{measurement.name}: {note}")
    return compare_series(labels, series, nominal, samples, note)


def nominal_values(series: Series, combination: Combination) -> list[Value]:
    """Return the values of models for the rows of a series, without scatter.

    Parameters
    ----------
    series : Series
        The measured rows.
    combination : Combination
        The models.
    """
    if isinstance(series, ContactSeries):
        return _contact_values(
            series, combination, Validation(sets=(), combinations=(), samples=0, seed=0)
        )[0]
    assert series.scene is not None
    scene = _scene_with(series.scene, combination)
    return observe(scene, series.quantity, series.at, [dict(row.changes) for row in series.rows])


def _bearing_values(
    series: Series, scene: Scene, plan: Validation
) -> tuple[list[Value], Array, str]:
    """Return values of the rows without scatter, samples with scatter (samples, rows), and a note if there are none."""
    nominal = observe(scene, series.quantity, series.at, [dict(row.changes) for row in series.rows])
    note = ""
    sampled = list[dict[str, object]]()
    if plan.bearing_samples:
        try:
            sampled = _sample_scene(with_scatter(scene)[0], plan)
        except SceneError as error:
            note = f"no band of the calculated values: {error.problems[0]}"
    columns = []
    for row in series.rows:
        points = [
            {**{k: v for k, v in sample.items() if k not in row.changes}, **row.changes}
            for sample in sampled
        ]
        columns.append(
            [value.value for value in observe(scene, series.quantity, series.at, points)]
        )
    return nominal, np.array(columns, dtype=float).T.reshape(len(sampled), len(series.rows)), note


def _sample_scene(scene: Scene, plan: Validation) -> list[dict[str, object]]:
    """Return samples of the uncertain quantities of a scene, as changes of it."""
    problems: list[str] = []
    uncertain = read_uncertainty(
        scene.uncertainty or {},
        Location(scene.origins, ("uncertainty",)),
        quantities(assemble(scene), settings(scene)),
        problems,
    )
    raise_problems(problems)
    keys = list(uncertain.distributions)
    drawn = uncertain.values(probabilities("sobol", plan.bearing_samples, len(keys), plan.seed))
    return [dict(zip(keys, row, strict=True)) for row in drawn.tolist()]


def _contact_values(
    series: ContactSeries, combination: Combination, plan: Validation
) -> tuple[list[Value], Array, str]:
    """Return the values of the rows of a rig, samples with the scatter of the oil (samples, rows), and a note."""
    column = series.quantity.replace("-", "_")
    data = series.data
    if column != "friction":  # a measured film would replace the model
        columns = {name: values for name, values in data.columns.items() if name != column}
        data = attrs.evolve(data, columns=columns | {"slide_roll_ratio": np.zeros(len(data))})
    start = time.perf_counter()
    problem = rig_problem(
        data, series.rig, combination.models.get("traction"), _film_model(series, combination)
    )
    law = _resistance_law(series.at) if column == "contact_resistance" else None
    nominal = _contact_column(problem, problem.lubricant, column, law)
    seconds = (time.perf_counter() - start) / len(data)
    oils, note = _sample_oils(problem.lubricant, plan)
    failed = 0
    sampled = []
    for oil in oils:
        try:
            sampled.append(_contact_column(problem, oil, column, law))
        except (DomainError, FieldError):
            failed += 1
            sampled.append(np.full(len(data), math.nan))
    if failed:
        note = f"{failed} of {len(oils)} samples of the oil lie outside the domain of a model"
    reason = ""
    film = problem.film
    location = str(series.at.get("location", ""))
    if column == "film_thickness" and film is not None and location not in film.location:
        reason = f"{film.name} gives the {film.location} film, measured was the {location}"
    values = [Value(float(value), reason, seconds) for value in nominal]
    return values, np.array(sampled).reshape(len(oils), len(data)), note


def _film_model(series: ContactSeries, combination: Combination) -> dict[str, object] | str | None:
    """Return the film model, at the location that was measured if the model has a choice."""
    own = series.rig.models.film
    name = combination.models.get("film", own.name)
    if "location" not in series.at or "thickness" not in {
        a.name for a in attrs.fields(get_class("film", name))
    }:
        return combination.models.get("film")
    parameters = own.parameters if name == own.name else {}
    return {"model": name, **parameters, "thickness": series.at["location"]}


def _resistance_law(at: Mapping[str, object]) -> Chain:
    """Return the drag that a series of rolling resistance names as ``law``, with its parameters."""
    raise_problem_if(
        "law" not in at, "contact-resistance: name the drag, such as at = { law = 'NAME' }"
    )
    parameters = {name: value for name, value in at.items() if name != "law"}
    return Chain(get_model("drag", str(at["law"]), **parameters))


def _contact_column(
    problem: RigProblem, oil: Lubricant, column: str, law: Chain | None = None
) -> Array:
    """Return friction, film thickness [m] or, by a law, rolling resistance [N/m] of all rows with an oil, (rows,)."""
    values = np.array(problem.friction(oil, problem.chain))
    for _, rows, slices in problem.tables:
        if law is not None:
            law(slices)
            values[rows] = slices.resistance
        elif column == "film_thickness":
            values[rows] = slices.film_thickness
    return values


def _sample_oils(oil: Lubricant, plan: Validation) -> tuple[list[Lubricant], str]:
    """Return samples of an oil by its own scatter; or none and the reason, where the oil states no scatter."""
    if not plan.samples:
        return [], ""
    if not oil.scatter:
        return (
            [],
            f"no band of the calculated values: nothing is known of the scatter of oil {oil.name!r}",
        )
    drawn = probabilities("sobol", plan.samples, len(oil.scatter), plan.seed)
    columns = dict[str, Array]()
    for k, scatter in enumerate(oil.scatter):
        unit = attrs.fields_dict(Lubricant)[scatter.quantity].metadata.get("unit") or "1"
        stated = {
            key: in_unit(value, unit) if isinstance(value, str) else value
            for key, value in scatter.parameters.items()
        }
        distribution = DISTRIBUTIONS[scatter.distribution](**stated)
        columns[scatter.quantity] = distribution.centred(getattr(oil, scatter.quantity)).quantile(
            drawn[:, k]
        )
    rows = np.transpose([*columns.values()]).tolist()
    return [attrs.evolve(oil, **dict(zip(columns, row, strict=True))) for row in rows], ""


def evaluate_statement(
    measurement: Measurement, statement: Statement, combination: Combination
) -> dict[str, Any]:
    """Return the variables of a statement of a data set under some models, by name: verdict and calculated values.

    Parameters
    ----------
    measurement : Measurement
        The data set.
    statement : Statement
        The statement, with the steps at which it is evaluated.
    combination : Combination
        The models.
    """
    labels = {
        "statement_data_set": measurement.name,
        "statement_models": combination.label,
        "statement_text": statement.text,
        "statement_by": statement.by_whom,
    }
    assert statement.scene is not None
    try:
        scene = _scene_with(statement.scene, combination)
        values = [
            observe(
                scene,
                step.quantity or statement.quantity,
                step.at if step.quantity else statement.at,
                [step.changes],
            )[0]
            for step in statement.steps
        ]
    except RollslipError as error:
        reason = str(error).splitlines()[0]
        return labels | {"statement_verdict": UNDETERMINED, "statement_found": reason}
    texts = list[str]()
    for step, value in zip(statement.steps, values, strict=True):
        text = f"no value ({value.reason.partition(';')[0]})"
        if not math.isnan(value.value):
            text = format_value(value.value, statement.unit, step.quantity or statement.quantity)
        texts.append(f"{step.text}: {text}")
    verdict = check_statement(statement, np.array([value.value for value in values]))
    return labels | {"statement_verdict": verdict, "statement_found": ", ".join(texts)}


# Dataset ------------------------------------------------------------------------------------------------------------

#: Name of a variable -> its type, unit and meaning.
_Variables = Mapping[str, tuple[type, str, str]]
#: Type, unit and meaning of each variable of a row.
_ROW_VARIABLES: Final[_Variables] = {
    "row_data_set": (object, "1", "data set"),
    "row_series": (object, "1", "series"),
    "row_models": (object, "1", "models"),
    "row_quantity": (object, "1", "quantity"),
    "row_unit": (object, "1", "unit"),
    "row_condition": (object, "1", "condition"),
    "row_verdict": (object, "1", "verdict"),
    "row_status": (object, "1", "status"),
    "measured": (float, "see row_unit", "measured value, in the unit of the row"),
    "uncertainty": (float, "see row_unit", "standard uncertainty of it"),
    "calculated": (float, "see row_unit", "calculated value"),
    "calculated_low": (float, "see row_unit", "lower end of its 95 % band"),
    "calculated_high": (float, "see row_unit", "upper end of its 95 % band"),
    "ratio": (float, "1", "calculated over measured"),
    "ratio_low": (float, "1", "lower end of its 95 % band"),
    "ratio_high": (float, "1", "upper end of its 95 % band"),
    "seconds": (float, "s", "time of one value"),
}
#: Type, unit and meaning of each variable of a series as a whole; chi-square is NaN where its status says why.
_SERIES_VARIABLES: Final[_Variables] = {
    "group_data_set": (object, "1", "data set"),
    "group_series": (object, "1", "series"),
    "group_models": (object, "1", "models"),
    "chi2": (float, "1", "chi-square with the covariance of samples"),
    "freedom": (int, "1", "rows"),
    "probability": (float, "1", "chance of a larger one"),
    "chi2_status": (object, "1", "why there is none"),
}
#: Type, unit and meaning of each variable of a statement.
_STATEMENT_VARIABLES: Final[_Variables] = {
    f"statement_{name}": (object, "1", name)
    for name in ("data_set", "models", "text", "by", "verdict", "found")
}


def _variables(
    dim: str, results: Sequence[Mapping[str, Any]], columns: _Variables
) -> dict[str, Any]:
    """Return variables over a dimension, each from the values of some results."""
    return {
        name: (dim, np.array([row[name] for row in results], dtype=kind), about(unit, meaning))
        for name, (kind, unit, meaning) in columns.items()
    }


def _dataset(
    plan: Validation,
    rows: list[dict[str, Any]],
    groups: list[dict[str, Any]],
    statements: list[dict[str, Any]],
    warnings: list[str],
    seconds: float,
) -> "xr.Dataset":
    """Return the result: rows, series and statements, with data sets and citations."""
    dataset = xr.Dataset(
        {
            **_variables("row", rows, _ROW_VARIABLES),
            **_variables("group", groups, _SERIES_VARIABLES),
            **_variables("statement", statements, _STATEMENT_VARIABLES),
        }
    )
    requested = {
        (kind, name)
        for combination in plan.combinations
        for kind, name in combination.models.items()
    }
    models = list[SliceModel]()
    for kind, name in sorted(requested):
        with suppress(RollslipError):  # a model that cannot be made without parameters
            models.append(get_model(kind, name))
    dataset.attrs |= plan.origin(
        models,
        study="validation",
        title="Models against what was measured",
        data_sets={
            measurement.name: {
                "description": measurement.description,
                "source": measurement.source,
                "estimated": dict(measurement.estimated),
                "form": measurement.is_form,
                "measured": measurement.measured,
            }
            for measurement in plan.sets
        },
        samples=plan.samples,
        seed=plan.seed,
        warnings=list(dict.fromkeys(warnings)),
        evaluations=len(rows) * (1 + plan.samples),
        wall_time=seconds,
    )
    return dataset
