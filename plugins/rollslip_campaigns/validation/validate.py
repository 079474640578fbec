"""Hold data sets against models: calculated over measured with the uncertainty of both, and what was said in words.

- Models are those of a data set's scene, and all combinations of those that are named, put in its place as
  ``rollslip compare`` puts them.
- What is estimated or known to scatter is sampled: the scene's table ``[uncertainty]``, or else the scatter of its oil.
  All rows of a series and all models see the same samples, so that what they share is shared.
- A row is *inside* where zero lies in the central 95 % of the differences between calculated samples and the measured
  value with its normal error. No distribution of the calculated values is assumed.
- Chi-square takes the covariance of the samples with it: an oil that is wrong is wrong in all rows. It is told where
  all rows have finite values and there are ten samples a row; elsewhere a reason stands in its place.
"""

import itertools
import math
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import assemble
from rollslip.catalogue.discovery import available, find, get_class
from rollslip.catalogue.registry import get_model
from rollslip.errors import DomainError, PluginError, RollslipError, SceneError
from rollslip.fields import FieldError
from rollslip.lubricant.oil import Lubricant
from rollslip.models import SliceModel
from rollslip.planning.campaign import listed
from rollslip.planning.provenance import cited, describe_citations, origin, packages_of
from rollslip.results.dataset import about
from rollslip.scene.changes import evolve
from rollslip.scene.values import Scene
from rollslip.search import Array
from rollslip.structure import Location
from rollslip.studies.study import settings
from rollslip.units import quantity as in_unit
from rollslip_campaigns.comparison.choices import KINDS, read_choice, refuse
from rollslip_campaigns.fit.problem import RigProblem, rig_problem
from rollslip_campaigns.measurement import Measurement
from rollslip_campaigns.measurement.values import ContactSeries, Series, Statement
from rollslip_campaigns.sweep.sampling import probabilities
from rollslip_campaigns.validation.findings import shown
from rollslip_campaigns.validation.observables import observe
from rollslip_campaigns.validation.predictions import Predictions, measurement_named, predictions_of
from rollslip_campaigns.validation.residuals import (
    UNDETERMINED,
    Group,
    Judged,
    Said,
    Value,
    held,
    verdict_on,
)
from rollslip_studies.variation.distributions import DISTRIBUTIONS, read_uncertainty
from rollslip_studies.variation.quantities import quantities
from rollslip_studies.variation.scatter import with_scatter

if TYPE_CHECKING:
    import xarray as xr

    from rollslip_campaigns.validation import RankingSettings, ValidationSettings

__all__ = [
    "AS_STATED", "Combination", "Validation", "judged_statement", "nominal_values", "plan_validation",
    "run_validation",
]  # fmt: skip


@attrs.frozen
class Combination:
    """Models by kind that take the place of those of a data set; none for its own."""

    label: str
    models: Mapping[str, str]


#: The models of a data set's own scene.
AS_STATED: Final = Combination("as stated", {})


@attrs.frozen(kw_only=True)
class Validation:
    """What is held against what.

    Attributes
    ----------
    sets : tuple of Measurement
        The data sets.
    combinations : tuple of Combination
        The models.
    predictions : tuple of Predictions
        What other programs give.
    samples, seed : int
        Of what scatters.
    """

    sets: tuple[Measurement, ...]
    combinations: tuple[Combination, ...]
    predictions: tuple[Predictions, ...] = ()
    samples: int
    seed: int

    def origin(self, models: Iterable[SliceModel] = (), **facts: Any) -> dict[str, Any]:
        """Return facts as attributes, with data sets, packages, and what to cite for the data and some models."""
        offers = [
            find("measurement", one.name)
            for one in self.sets
            if one.name in available("measurement")
        ]
        offers += [
            find(kind, name) for one in self.combinations for kind, name in one.models.items()
        ]
        return origin(
            **facts,
            source=", ".join(one.name for one in self.sets),
            packages=packages_of(offers),
            **describe_citations(
                cited(models, [cite for one in self.sets for cite in one.references])
            ),
        )


def plan_validation(requested: "ValidationSettings | RankingSettings") -> Validation:
    """Check what is asked for."""
    names = (
        [requested.data]
        if isinstance(requested.data, str | Path | Measurement)
        else list(requested.data)
    )
    sets = tuple(measurement_named(one) for one in names or available("measurement"))
    if not sets:
        raise SceneError(
            ["there is no data set; 'rollslip plugins new NAME --kind measurement' writes one"]
        )
    if requested.samples == 1:
        raise SceneError(["samples: a band needs 2 at least, or 0 for none, not 1"])
    laws = {kind: listed(getattr(requested, kind)) for kind in KINDS}
    for kind, named in laws.items():
        for name in named:
            find(kind, name)
    wanted = {kind: named for kind, named in laws.items() if named}
    products = (
        [dict(zip(wanted, each, strict=True)) for each in itertools.product(*wanted.values())]
        if wanted
        else []
    )
    combinations = [AS_STATED, *(Combination(" + ".join(one.values()), one) for one in products)]
    known = {one.name for one in sets}
    predictions = predictions_of(requested.predictions, names)
    for one in predictions:
        if one.of not in known:
            raise SceneError(
                [f"{one.source}: predictions of data set {one.of!r}, which is not asked for"]
            )
    return Validation(
        sets=sets,
        combinations=tuple(combinations),
        predictions=tuple(predictions),
        samples=requested.samples,
        seed=requested.seed,
    )


# Running ------------------------------------------------------------------------------------------------------------


def run_validation(
    plan: Validation, report: Callable[[str, float], None] = lambda text, fraction: None
) -> "xr.Dataset":
    """Compute what a validation needs; see `rollslip.validate`."""
    begin = time.perf_counter()
    rows = list[Judged]()
    groups = list[Group]()
    said = list[Said]()
    warnings = list[str]()
    parts = [
        (measurement, thing, combination)
        for measurement in plan.sets
        for thing in list[Series | Statement]([*measurement.series, *measurement.statements])
        for combination in plan.combinations
    ]
    for k, (measurement, thing, combination) in enumerate(parts):
        what = thing.text if isinstance(thing, Statement) else thing.name
        report(f"{measurement.name}: {what}, {combination.label}", k / len(parts))
        if isinstance(thing, Statement):
            said.append(judged_statement(measurement, thing, combination))
        elif thing.rows:
            judged, group = _judged_series(plan, measurement, thing, combination, warnings)
            rows += judged
            groups.append(group)
    for one in plan.predictions:
        measurement = next(each for each in plan.sets if each.name == one.of)
        for series in measurement.series:
            if (values := one.values_of(series)) is not None:
                judged, group = held(
                    (measurement.name, series.name, one.program), series, *values, ""
                )
                rows += judged
                groups.append(group)
    for measurement in plan.sets:
        if measurement.is_form:
            warnings.append(f"{measurement.name} is a form without numbers: {measurement.recipe}")
    return _dataset(plan, rows, groups, said, warnings, time.perf_counter() - begin)


def _scene_with(scene: Scene, combination: Combination) -> Scene:
    """Return a scene with other models in it."""
    problems = list[str]()
    unknown = list[PluginError]()
    tables = {
        f"models.{kind}": dict(read_choice(scene, kind, name, problems, unknown).table)
        for kind, name in combination.models.items()
    }
    refuse(problems, unknown)
    return evolve(scene, tables) if tables else scene


def _judged_series(
    plan: Validation,
    measurement: Measurement,
    series: Series,
    combination: Combination,
    warnings: list[str],
) -> tuple[list[Judged], Group]:
    of = (measurement.name, series.name, combination.label)
    try:
        if isinstance(series, ContactSeries):
            nominal, samples, note = _of_contacts(series, combination, plan)
        else:
            assert series.scene is not None
            nominal, samples, note = _of_bearing(
                series, _scene_with(series.scene, combination), plan
            )
    except RollslipError as error:
        reason = str(error).splitlines()[0]
        failed = [Value(math.nan, reason, math.nan) for _ in series.rows]
        return held(of, series, failed, np.full((0, len(series.rows)), math.nan), reason)
    if note:
        warnings.append(f"{measurement.name}: {note}")
    return held(of, series, nominal, samples, note)


def nominal_values(series: Series, combination: Combination) -> list[Value]:
    """Return what models give for the rows of a series, without scatter."""
    if isinstance(series, ContactSeries):
        return _of_contacts(
            series, combination, Validation(sets=(), combinations=(), samples=0, seed=0)
        )[0]
    assert series.scene is not None
    scene = _scene_with(series.scene, combination)
    return observe(scene, series.quantity, series.at, [dict(row.changes) for row in series.rows])


def _of_bearing(series: Series, scene: Scene, plan: Validation) -> tuple[list[Value], Array, str]:
    """Values of the rows as the scene states them, and with samples of what scatters, shape (sample, row)."""
    nominal = observe(scene, series.quantity, series.at, [dict(row.changes) for row in series.rows])
    note = ""
    sampled = list[dict[str, object]]()
    if plan.samples:
        try:
            sampled = _samples(with_scatter(scene)[0], plan)
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


def _samples(scene: Scene, plan: Validation) -> list[dict[str, object]]:
    """Return samples of what a scene calls uncertain, as changes of it."""
    problems: list[str] = []
    assembly = assemble(scene)
    known = quantities(assembly, settings(scene))
    uncertain = read_uncertainty(
        scene.uncertainty or {}, Location(scene.origins, ("uncertainty",)), known, problems
    )
    if problems:
        raise SceneError(problems)
    keys = list(uncertain.distributions)
    drawn = uncertain.values(probabilities("sobol", plan.samples, len(keys), plan.seed))
    return [dict(zip(keys, row, strict=True)) for row in drawn.tolist()]


def _of_contacts(
    series: ContactSeries, combination: Combination, plan: Validation
) -> tuple[list[Value], Array, str]:
    """Values of a rig's rows, with samples of the oil's own scatter."""
    column = series.quantity.replace("-", "_")
    data = series.data
    if column == "film_thickness":  # what was measured must not take the place of the model
        columns = {name: values for name, values in data.columns.items() if name != column}
        data = attrs.evolve(data, columns=columns | {"slide_roll_ratio": np.zeros(len(data))})
    begin = time.perf_counter()
    film_named = _film_at(series, combination)
    problem = rig_problem(data, series.rig, combination.models.get("traction"), film_named)
    nominal = _contacts(problem, problem.lubricant, column)
    seconds = (time.perf_counter() - begin) / len(data)
    drawn, note = _oils(problem.lubricant, plan)
    lost = 0
    sampled = []
    for oil in drawn:
        try:
            sampled.append(_contacts(problem, oil, column))
        except (DomainError, FieldError):
            lost += 1
            sampled.append(np.full(len(data), math.nan))
    if lost:
        note = f"{lost} of {len(drawn)} samples of the oil lie outside the domain of a model"
    why = ""
    film = problem.film
    wanted = str(series.at.get("location", ""))
    if column == "film_thickness" and film is not None and wanted not in film.location:
        why = f"{film.name} gives the {film.location} film, measured was the {wanted}"
    values = [Value(float(value), why, seconds) for value in nominal]
    return values, np.array(sampled).reshape(len(drawn), len(data)), note


def _film_at(series: ContactSeries, combination: Combination) -> dict[str, object] | str | None:
    """Return the film model that is named, where it has a choice with the film that was measured."""
    own = series.rig.models.film
    name = combination.models.get("film", own.name)
    if "location" not in series.at or "thickness" not in {
        a.name for a in attrs.fields(get_class("film", name))
    }:
        return combination.models.get("film")
    parameters = own.parameters if name == own.name else {}
    return {"model": name, **parameters, "thickness": series.at["location"]}


def _contacts(problem: RigProblem, oil: Lubricant, column: str) -> Array:
    values = np.array(problem.friction(oil, problem.chain))
    if column == "friction":
        return values
    for _, rows, slices in problem.tables:
        values[rows] = slices.film_thickness
    return values


def _oils(oil: Lubricant, plan: Validation) -> tuple[list[Lubricant], str]:
    """Return samples of an oil by its own scatter; none, and why, where it knows of none."""
    if not plan.samples:
        return [], ""
    if not oil.scatter:
        return (
            [],
            f"no band of the calculated values: nothing is known of the scatter of oil {oil.name!r}",
        )
    drawn = probabilities("sobol", plan.samples, len(oil.scatter), plan.seed)
    columns = dict[str, Array]()
    fields = {attribute.name: attribute for attribute in attrs.fields(Lubricant)}
    for k, one in enumerate(oil.scatter):
        unit = fields[one.quantity].metadata.get("unit") or "1"
        stated = {
            key: in_unit(value, unit) if isinstance(value, str) else value
            for key, value in one.parameters.items()
        }
        distribution = DISTRIBUTIONS[one.distribution](**stated)
        columns[one.quantity] = distribution.centred(getattr(oil, one.quantity)).quantile(
            drawn[:, k]
        )
    oils = list[Lubricant]()
    for k in range(plan.samples):
        values: dict[str, Any] = {name: float(column[k]) for name, column in columns.items()}
        oils.append(attrs.evolve(oil, **values))
    return oils, ""


def judged_statement(
    measurement: Measurement, statement: Statement, combination: Combination
) -> Said:
    """Tell whether a statement of a data set holds under some models, with what was found."""
    of = {
        "data_set": measurement.name,
        "models": combination.label,
        "text": statement.text,
        "by": statement.by_whom,
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
        return Said(**of, verdict=UNDETERMINED, found=str(error).splitlines()[0])

    def told(value: Value, quantity: str) -> str:
        if math.isnan(value.value):
            return f"no value ({value.why.partition(';')[0]})"
        return shown(value.value, statement.unit, quantity)

    found = ", ".join(
        f"{step.text}: {told(value, step.quantity or statement.quantity)}"
        for step, value in zip(statement.steps, values, strict=True)
    )
    verdict = verdict_on(statement, np.array([value.value for value in values]))
    return Said(**of, verdict=verdict, found=found)


# Dataset ------------------------------------------------------------------------------------------------------------

#: Variable -> field of a row, unit and meaning.
_OF_ROWS: Final[Mapping[str, tuple[str, str, str]]] = {
    "row_data_set": ("data_set", "1", "data set"),
    "row_series": ("series", "1", "series"),
    "row_models": ("models", "1", "models"),
    "row_quantity": ("quantity", "1", "quantity"),
    "row_unit": ("unit", "1", "unit"),
    "row_condition": ("condition", "1", "condition"),
    "row_verdict": ("verdict", "1", "verdict"),
    "row_status": ("status", "1", "status"),
    "measured": ("measured", "see row_unit", "measured value, in the unit of the row"),
    "uncertainty": ("uncertainty", "see row_unit", "standard uncertainty of it"),
    "calculated": ("calculated", "see row_unit", "calculated value"),
    "calculated_low": ("calculated_low", "see row_unit", "lower end of its 95 % band"),
    "calculated_high": ("calculated_high", "see row_unit", "upper end of its 95 % band"),
    "ratio": ("ratio", "1", "calculated over measured"),
    "ratio_low": ("ratio_low", "1", "lower end of its 95 % band"),
    "ratio_high": ("ratio_high", "1", "upper end of its 95 % band"),
    "seconds": ("seconds", "s", "time of one value"),
}
#: Variable -> field of a group, unit and meaning.
_OF_GROUPS: Final[Mapping[str, tuple[str, str, str]]] = {
    "group_data_set": ("data_set", "1", "data set"),
    "group_series": ("series", "1", "series"),
    "group_models": ("models", "1", "models"),
    "chi2": ("chi2", "1", "chi-square with the covariance of samples"),
    "freedom": ("freedom", "1", "rows"),
    "probability": ("probability", "1", "chance of a larger one"),
    "chi2_status": ("status", "1", "why there is none"),
}
#: Variable -> field of a statement, unit and meaning.
_OF_STATEMENTS: Final[Mapping[str, tuple[str, str, str]]] = {
    f"statement_{name}": (name, "1", name)
    for name in ("data_set", "models", "text", "by", "verdict", "found")
}


def _variables(
    dim: str, cls: type, things: Sequence[Any], columns: Mapping[str, tuple[str, str, str]]
) -> dict[str, Any]:
    """Return variables over a dimension, each a field of some things."""
    kinds = {one.name: object if one.type is str else one.type for one in attrs.fields(cls)}
    return {
        name: (
            dim,
            np.array([getattr(one, field) for one in things], dtype=kinds[field]),
            about(unit, meaning),
        )
        for name, (field, unit, meaning) in columns.items()
    }


def _dataset(
    plan: Validation,
    rows: list[Judged],
    groups: list[Group],
    said: list[Said],
    warnings: list[str],
    seconds: float,
) -> "xr.Dataset":
    import xarray as xr

    dataset = xr.Dataset(
        {
            **_variables("row", Judged, rows, _OF_ROWS),
            **_variables("group", Group, groups, _OF_GROUPS),
            **_variables("statement", Said, said, _OF_STATEMENTS),
        }
    )
    sources = {
        one.name: {"description": one.description, "source": one.source, "estimated": dict(one.estimated),
                   "form": one.is_form}
        for one in plan.sets
    }  # fmt: skip
    requested = {(kind, name) for one in plan.combinations for kind, name in one.models.items()}
    dataset.attrs |= plan.origin(
        [get_model(kind, name) for kind, name in sorted(requested) if _plain(kind, name)],
        study="validation",
        title="Models against what was measured",
        data_sets=sources,
        samples=plan.samples,
        seed=plan.seed,
        warnings=list(dict.fromkeys(warnings)),
        evaluations=len(rows) * (1 + plan.samples),
        wall_time=seconds,
    )
    return dataset


def _plain(kind: str, name: str) -> bool:
    """Whether a model can be made without parameters."""
    try:
        get_model(kind, name)
    except RollslipError:
        return False
    return True
