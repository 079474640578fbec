"""Compare models on one scene: combinations of them, their differences from a reference, and their costs.

- A combination is the scene with other models. It runs as ``rollslip run`` would run it, at the same slips, loads,
  roller positions and slices as all others (a contact model has its own loads), so that only the models differ.
- A named model takes the place of the scene's model of its kind. If the scene's model is composed, of a child
  ``hydrodynamic`` (a blend) or ``film`` (a correction of films), and the named model is not, it takes the place of that
  child: laws of the full film are compared inside the same blend. Results call it "muraki in lambda-blend".
- Names and parameters are checked before anything runs. A combination that fails later is listed with its error, and
  the others go on.
"""

import itertools
import time
from collections.abc import Callable, Iterable, Mapping
from typing import Any, NoReturn

import attrs
import numpy as np

from rollslip.bearing.raceway import RINGS, Array
from rollslip.bearing.resolution import Resolution
from rollslip.catalogue.discovery import available
from rollslip.errors import (
    PluginError,
    RollslipError,
    SceneError,
    UnknownNameError,
    describe_failure,
    did_you_mean,
    nearest,
)
from rollslip.planning.campaign import listed
from rollslip.planning.execution import execute, measured_attribute
from rollslip.planning.plan import Plan, plan
from rollslip.planning.provenance import combine_origins, origin
from rollslip.results.curves import Curves
from rollslip.results.dataset import about, xr
from rollslip.results.text import collect_warnings, duration_range
from rollslip.scene.changes import evolve
from rollslip.scene.values import DEFAULT_STUDY, Scene
from rollslip.structure import raise_problem_if, resolved, scene_hash
from rollslip.studies.measured import MeasuredPoints
from rollslip.studies.study import study_class
from rollslip_campaigns.comparison import ComparisonSettings
from rollslip_campaigns.comparison.attribution import (
    Bins,
    EvaluatedSlices,
    attribute_differences,
    extract_criteria,
    extract_friction,
    seconds_per_slice,
)
from rollslip_campaigns.comparison.choices import (
    CHILD,
    KINDS,
    Choice,
    Model,
    loadable,
    read_choice,
    refuse,
)


@attrs.frozen(eq=False)
class Combination:
    """A choice for each kind, and the plan of the scene with them, or the error that prevents a plan."""

    choices: Mapping[str, Choice]
    plan: Plan | None
    error: Exception | None


@attrs.frozen(eq=False, kw_only=True)
class Comparison:
    """Combinations that will be compared.

    Attributes
    ----------
    scene : Scene
        The scene that is changed.
    study : str
        Name of the study that gives the curves.
    combinations : mapping
        Combinations by label.
    reference : str
        Label of the reference.
    named : bool
        Whether the user named a reference, so that differences are errors.
    measured : MeasuredPoints or None
        Measured points to compare with.
    """

    scene: Scene
    study: str
    combinations: Mapping[str, Combination]
    reference: str
    named: bool
    measured: MeasuredPoints | None = None

    @property
    def curves(self) -> Curves:
        """The curves of the study."""
        curves = study_class(self.study).curves_of
        assert curves is not None  # else it would not be compared
        return curves

    @property
    def plans(self) -> dict[str, Plan]:
        """The plans of the combinations that can run, by label."""
        return {
            label: combination.plan
            for label, combination in self.combinations.items()
            if combination.plan is not None
        }

    def scenes_of(self, labels: Iterable[str]) -> dict[str, Scene]:
        """Return the scenes of combinations that can run by their `labels`."""
        return {label: self.plans[label].scene for label in labels}

    @property
    def seconds(self) -> float:
        """The estimated time [s]: runs, checks of about half their time, and the slices of one run again."""
        return 1.5 * sum(plan.seconds for plan in self.plans.values())

    @property
    def messages(self) -> list[str]:
        """Lines that describe the combinations, the number of slices and the estimated time."""
        from rollslip.cli.console import headline_of

        chosen = [combination.choices for combination in self.combinations.values()]
        models = dict.fromkeys(
            (kind, c[kind].name, c[kind].full_label) for kind in chosen[0] for c in chosen
        )
        several = (
            f"{self.study} of {len(self.combinations)} combinations: {', '.join(self.combinations)}"
        )
        slices = sum(plan.evaluations for plan in self.plans.values())
        cost = f"about {slices} slices to evaluate, {duration_range(self.seconds)}"
        return [*filter(None, (headline_of(self.scene, models), several, self.exchanged, cost))]

    @property
    def exchanged(self) -> str:
        """A sentence on which parts of composed models are exchanged; empty if whole models are."""
        return "; ".join(
            f"{kind} models take the place of the {child} model of the scene's {getattr(self.scene.models, kind).name}"
            for kind, child in CHILD.items()
            if any(
                combination.choices[kind].full_label != combination.choices[kind].label
                for combination in self.combinations.values()
            )
        )


# Planning -----------------------------------------------------------------------------------------------------------


def plan_comparison(requested: "ComparisonSettings") -> Comparison:
    """Return the comparison of all combinations, after a check of names and parameters."""
    scene = requested.base_scene
    study = _study(scene, requested.study)
    problems = list[str]()
    unknown = list[PluginError]()
    choices = {
        kind: [
            read_choice(scene, kind, model, problems, unknown)
            for model in listed(getattr(requested, kind)) or [None]
        ]
        for kind in KINDS
    }
    reference = (
        {} if requested.reference is None else _by_kind(requested.reference, problems, unknown)
    )
    named = {
        kind: read_choice(scene, kind, model, problems, unknown)
        for kind, model in reference.items()
    }
    refuse(problems, unknown)
    products = [
        dict(zip(KINDS, models, strict=True)) for models in itertools.product(*choices.values())
    ]
    products.append({kind: named.get(kind, choices[kind][0]) for kind in KINDS})
    varying = [kind for kind in KINDS if len({product[kind].label for product in products}) > 1]
    raise_problem_if(
        not varying,
        "there is nothing to compare: name two models of a kind, as by --film A,B,"
        " or one and another --reference",
    )
    labels = [" + ".join(product[kind].label for kind in varying) for product in products]
    unique = dict(zip(labels, products, strict=True))
    combinations = {label: _combination(scene, study, product) for label, product in unique.items()}
    return Comparison(
        scene=scene,
        study=study,
        combinations=_with_equal_resolution(study, combinations),
        reference=labels[-1],
        named=requested.reference is not None,
        measured=requested.measured_points,
    )


def _study(scene: Scene, study: str | None) -> str:
    """Return the study that is compared, by default the first of the scene that gives curves."""
    if study is None:
        study = next(
            (name for name in scene.study if study_class(name, scene).curves_of is not None),
            DEFAULT_STUDY,
        )
    if study_class(study, scene).from_scene(scene).curves_of is None:
        others = [name for name, cls in loadable("study") if cls.curves_of is not None]
        raise SceneError(
            [
                f"study {study!r} has no curves to compare, only {' and '.join(others)} have; name one by --study, or "
                f"compare results over a load: rollslip sweep run {scene.source} --study {study} "
                "--over models.traction.hydrodynamic=A,B --over load=LOW:HIGH:COUNT"
            ]
        )
    return study


def _by_kind(
    reference: Model | Mapping[str, Model], problems: list[str], unknown: list[PluginError]
) -> dict[str, Model]:
    """Return the models of the reference by kind; the kind of a name is looked up, a table or a model is a traction."""
    if isinstance(reference, Mapping) and "model" not in reference:
        problems += [
            f"reference: there is no {kind!r}, only {', '.join(KINDS)}"
            for kind in set(reference) - set(KINDS)
        ]
        return {kind: reference[kind] for kind in KINDS if kind in reference}  # type: ignore[misc]
    if not isinstance(reference, str):
        return {"traction": reference}
    found: dict[str, Model] = {}
    for name in filter(None, map(str.strip, reference.split(","))):
        kind = next((kind for kind in reversed(KINDS) if name in available(kind)), None)
        if kind is None:
            near = nearest(name, (known for kind in KINDS for known in available(kind)), cutoff=0.4)
            hint = did_you_mean(near, "'rollslip models' lists them")
            unknown.append(
                UnknownNameError(
                    f"reference: no {', '.join(KINDS[:-1])} or {KINDS[-1]} is called {name!r}; {hint}"
                )
            )
        elif kind in found:
            problems.append(f"reference: {found[kind]!r} and {name!r} are both a {kind}; name one")
        else:
            found[kind] = name
    return found


def _combination(scene: Scene, study: str, choices: Mapping[str, Choice]) -> Combination:
    """Return the plan of a scene with other models, without outputs of more dimensions than a curve."""
    changes: dict[str, object] = {
        f"models.{kind}": choice.table for kind, choice in choices.items()
    }
    larger = [
        name for name, output in study_class(study).outputs.items() if len(output.dims.split()) > 2
    ]
    try:
        return Combination(
            choices,
            plan(evolve(scene, changes, si=True), study, cheaper_laws=False, without=larger),
            None,
        )
    except Exception as error:
        return Combination(choices, None, error)


def _with_equal_resolution(
    study: str, combinations: Mapping[str, Combination]
) -> dict[str, Combination]:
    """Return the combinations with the slices and roller positions of the one that needs the largest number of each."""
    resolutions = [
        combination.plan.choices[study].resolution
        for combination in combinations.values()
        if combination.plan is not None
    ]
    planned = [resolution for resolution in resolutions if resolution.n_positions is not None]
    if not planned:
        return dict(combinations)
    maximum = Resolution.maximum_of(planned)
    refined = dict[str, Combination]()
    for label, combination in combinations.items():
        refined[label] = combination
        if combination.plan is not None:
            resolution = attrs.evolve(
                combination.plan.choices[study].resolution,
                slices=maximum.slices,
                quadrature=maximum.quadrature,
                n_positions=maximum.n_positions,
            )
            refined[label] = attrs.evolve(combination, plan=combination.plan.at(study, resolution))
    return refined


# Running ------------------------------------------------------------------------------------------------------------


def run_comparison(
    comparison: Comparison, progress: Callable[[str, float], None] = lambda text, fraction: None
) -> "xr.Dataset":
    """Run all combinations, evaluate their models on the slices of the reference, and return the differences.

    Parameters
    ----------
    comparison : Comparison
        The combinations.
    progress : callable
        Is called with the label of a combination and the fraction that is done.

    Returns
    -------
    xarray.Dataset
        The result of `compare`; values of a combination that failed are NaN, and its ``status`` is the error.

    Raises
    ------
    RollslipError
        If all combinations fail.
    """
    start = time.perf_counter()
    plans = comparison.plans
    reference = comparison.reference
    errors = {
        label: combination.error
        for label, combination in comparison.combinations.items()
        if combination.error is not None
    }
    done = _execute_all(comparison, errors, progress)
    # without the reference the slices of another combination serve to measure the cost
    standard = reference if reference in done else next(iter(done))
    work = EvaluatedSlices.from_result(plans[standard], comparison.study, done[standard])
    laws = (plans[label].assembly.traction.full_film for label in (standard, *done))
    law = next((law for law in laws if law.regimes), None)  # states criteria of its regimes
    columns = dict[str, dict[str, list[Array]]]()
    times = dict[str, Array]()
    for k, label in enumerate(done):
        progress(label, 0.5 + 0.5 * k / len(done))
        extract = extract_criteria(law) if label == reference else extract_friction
        try:
            columns[label], times[label] = work.evaluate(plans[label], extract)
        except Exception as error:  # a third-party model may raise anything
            errors[label] = error
    if not columns:
        _raise_all(errors)
    done = {label: done[label] for label in columns}
    failed = {label: f"failed: {describe_failure(error)}" for label, error in errors.items()}
    dataset = _merged(comparison, done, failed)
    dataset = dataset.assign(_costs(comparison, done, seconds_per_slice(work, plans, times)))
    dataset = dataset.assign(_errors(comparison, dataset))
    if reference in columns:
        dataset = attribute_differences(
            dataset,
            comparison.curves.over,
            reference,
            work,
            {label: values["friction"] for label, values in columns.items()},
            Bins.from_criteria(plans[reference], columns[reference], law),
        )
        own = law is not None and law is plans[reference].assembly.traction.full_film
        dataset = dataset.assign_attrs(
            sorted_by="" if law is None else law.name, sorted_by_own=int(own)
        )
    dataset.attrs |= measured_attribute(
        comparison.measured, comparison.scenes_of(done), report=progress
    )
    return dataset.assign_attrs(_origin(comparison, done, failed, time.perf_counter() - start))


def _execute_all(
    comparison: Comparison, errors: dict[str, Exception], progress: Callable[[str, float], None]
) -> "dict[str, xr.Dataset]":
    """Return the results of all combinations that run, by label; add the errors of the others, raise if none runs."""
    plans = comparison.plans
    done: dict[str, xr.Dataset] = {}
    for k, label in enumerate(plans):
        progress(label, 0.5 * k / len(plans))
        try:
            done[label] = execute(plans[label], comparison.study)
        except Exception as error:  # a third-party model may raise anything
            errors[label] = error
    return done or _raise_all(errors)


def _raise_all(errors: Mapping[str, Exception]) -> NoReturn:
    """Raise one error with the texts of all, of the class of the first one."""
    first = next(iter(errors.values()))
    texts = {label: describe_failure(error) for label, error in errors.items()}
    lines = list(dict.fromkeys(texts.values()))
    if len(lines) > 1:
        lines = [f"{label}: {text}" for label, text in texts.items()]
    if isinstance(first, SceneError):
        raise SceneError(lines)
    error_class = type(first) if isinstance(first, RollslipError) else PluginError
    raise error_class("\n".join(lines)) from first


# The dataset --------------------------------------------------------------------------------------------------------


def _merged(
    comparison: Comparison, done: "Mapping[str, xr.Dataset]", failed: Mapping[str, str]
) -> "xr.Dataset":
    """Return the curves of all combinations in one dataset, NaN where a combination failed."""
    labels = list(comparison.combinations)
    results = list(done.values())
    texts = {
        str(name): "" for name, values in results[0].variables.items() if values.dtype.kind in "OU"
    }
    dataset = (
        xr.concat(
            results,
            "combination",
            data_vars="all",
            coords="minimal",
            compat="override",
            join="override",
            combine_attrs="override",
        )
        .assign_coords(combination=list(done))
        .reindex(combination=labels, fill_value={"regime": -1, **texts})
    )
    if "film_thickness" in dataset:
        dataset["film_thickness"].attrs["long_name"] = "film thickness, the one of film_location"
    critical = dataset["critical_status"]
    statuses = [
        [failed[label]] * row.size if label in failed else row.tolist()
        for label, row in zip(labels, critical.to_numpy(), strict=True)
    ]
    dataset["critical_status"] = (critical.dims, np.array(statuses), critical.attrs)
    status = np.array([failed.get(label, "done") for label in labels])
    dataset["status"] = ("combination", status, about("1", "what became of the combination"))
    return dataset.assign_coords(
        {
            kind: (
                "combination",
                np.array([c.choices[kind].full_label for c in comparison.combinations.values()]),
                about("1", f"{kind} model"),
            )
            for kind in KINDS
        }
        | {
            "combination": (
                "combination",
                np.array(labels),
                about("1", "models of a combination that differ"),
            )
        }
    )


def _costs(
    comparison: Comparison, done: "Mapping[str, xr.Dataset]", cost: Mapping[str, float]
) -> dict[str, Any]:
    """Return the smallest film and the cost of each combination."""
    curve = comparison.curves.over
    labels = list(comparison.combinations)
    cheapest = min(cost, key=cost.__getitem__)
    films, parameters = np.full((2, len(labels), next(iter(done.values())).sizes[curve]), np.nan)
    evaluations = np.zeros(len(labels), dtype=int)
    locations = [""] * len(labels)
    for label, result in done.items():
        rings = [result.attrs["ring"]] if "ring" in result.attrs else RINGS
        roughness = [
            getattr(comparison.plans[label].assemblies[comparison.study], ring).conditions.roughness
            for ring in rings
        ]
        parameters[labels.index(label)] = result["film_parameter"].isel({comparison.curves.slip: 0})
        films[labels.index(label)] = parameters[labels.index(label)] * np.array(roughness)
        evaluations[labels.index(label)] = result.attrs["evaluations"]
        locations[labels.index(label)] = comparison.plans[label].assembly.film.location
    seconds = np.array([cost.get(label, np.nan) for label in labels])
    dim = "combination"
    return {
        "smallest_film": ((dim, curve), films, about("m", "smallest film thickness without slip")),
        "smallest_film_parameter": (
            (dim, curve),
            parameters,
            about("1", "smallest film parameter Lambda without slip"),
        ),
        "film_location": (
            dim,
            np.array(locations),
            about("1", "which film thickness the film model returns"),
        ),
        "seconds_per_slice": (dim, seconds, about("s", "time of the chain per slice")),
        "cost": (
            dim,
            seconds / cost[cheapest],
            about("1", f"time of the chain over that of {cheapest}"),
        ),
        "evaluations": (dim, evaluations, about("1", "slices evaluated by the study")),
    }


def _errors(comparison: Comparison, dataset: "xr.Dataset") -> "dict[str, xr.DataArray]":
    """Return the relative differences of the curves and of their maxima from the reference's."""
    curves = comparison.curves
    which = f"{'error against' if comparison.named else 'difference from'} {comparison.reference}"

    def relative(name: str) -> "xr.DataArray":
        standard = dataset[name].sel(combination=comparison.reference, drop=True)
        with np.errstate(divide="ignore", invalid="ignore"):
            return (dataset[name] / standard - 1.0).where(standard != 0.0)

    difference = relative(curves.variable)
    errors: dict[str, tuple[Any, str]] = {
        "difference": (difference, "relative {}"),
        "max_error": (abs(difference).max(curves.slip), "largest relative {} over the curve"),
        "rms_error": (
            np.sqrt((difference**2).mean(curves.slip)),
            "relative {}, root mean square over the points of the curve",
        ),
        "critical_slip_error": (
            relative(curves.critical),
            "relative {} of the slip at largest traction",
        ),
        "peak_error": (relative("critical_friction"), "relative {} of the largest friction"),
    }
    return {
        name: values.assign_attrs(about("1", text.format(which)))
        for name, (values, text) in errors.items()
    }


def _origin(
    comparison: Comparison,
    done: "Mapping[str, xr.Dataset]",
    failed: Mapping[str, str],
    wall_time: float,
) -> dict[str, Any]:
    """Return the attributes of the comparison: those of its runs together, and the scene as it was given."""
    runs = {label: result.attrs for label, result in done.items()}
    scene = comparison.scene
    first = next(iter(runs.values()))

    warned: dict[str, list[str]] = {}
    for label, result in done.items():
        warnings, _ = collect_warnings([result], laws=False)  # the notes of the answer are on laws
        for warning in warnings:
            warned.setdefault(warning, []).append(label)
    return {
        key: max(attributes[key] for attributes in runs.values())
        for key in ("positions_error", "slices_error", "force_residual", "moment_residual")
        if key in first
    } | origin(
        study="comparison",
        compared=comparison.study,
        curves=attrs.asdict(comparison.curves),
        **({"curves_with": first["curves_with"]} if "curves_with" in first else {}),
        reference=comparison.reference,
        reference_named=int(comparison.named),
        exchanged=comparison.exchanged,
        combinations={
            label: {kind: choice.table for kind, choice in combination.choices.items()}
            for label, combination in comparison.combinations.items()
        },
        scene_resolved=resolved(scene),
        scene_hash=scene_hash(scene),
        **combine_origins(runs.values(), "plan"),
        warnings=[f"{label} {text}" for label, text in failed.items()]
        + [
            text if len(labels) == len(done) else f"{', '.join(labels)}: {text}"
            for text, labels in warned.items()
        ],
        evaluations=sum(int(attributes["evaluations"]) for attributes in runs.values()),
        wall_time=wall_time,
    )
