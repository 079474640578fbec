"""Compare models on one scene: combinations of them, what differs from a reference, and what each costs.

- A combination is the scene with other models in it and runs as ``rollslip run`` would run it, on the same slips,
  loads, instants and slices as all others (a contact model has its own loads): nothing differs but the models.
- A named model takes the place of the scene's model of its kind. Where that is composed, of a child ``hydrodynamic``
  (a blend) or ``film`` (a correction of films), and the named one is not, it takes the place of that child: laws of the
  full film are compared inside the same blend. Results call it "muraki in lambda-blend".
- Names and parameters are checked before anything runs. What fails after that is listed with its error and stops no
  other combination.
"""

import itertools
import time
from collections.abc import Callable, Collection, Mapping
from typing import TYPE_CHECKING, Any, NoReturn

import attrs
import numpy as np

from rollslip.bearing.raceway import RINGS
from rollslip.bearing.resolution import Resolution
from rollslip.catalogue.discovery import available
from rollslip.errors import (
    PluginError,
    RollslipError,
    SceneError,
    UnknownNameError,
    describe_error,
    did_you_mean,
    nearest,
)
from rollslip.planning.campaign import listed
from rollslip.planning.execution import execute
from rollslip.planning.plan import Plan, plan
from rollslip.planning.provenance import origin, together
from rollslip.results.curves import Curves
from rollslip.results.dataset import about
from rollslip.results.words import collect_warnings as of_consequence
from rollslip.results.words import describe_more_bounds, duration_range
from rollslip.scene.changes import evolve
from rollslip.scene.values import DEFAULT_STUDY, Scene
from rollslip.structure import resolved, scene_hash
from rollslip.studies.study import study_class
from rollslip_campaigns.comparison.attribution import (
    Bins,
    EvaluatedSlices,
    attribute_differences,
    keep_criteria,
    keep_friction,
    law_to_sort_by,
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

if TYPE_CHECKING:
    import xarray as xr

    from rollslip_campaigns.comparison import ComparisonSettings


@attrs.frozen(eq=False)
class Combination:
    """A choice for each kind, and the plan of the scene with them, or the error that keeps it from having one."""

    choices: Mapping[str, Choice]
    plan: Plan | None
    error: Exception | None


@attrs.frozen(eq=False, kw_only=True)
class Comparison:
    """What will be compared: the combinations by their labels, and which of them is the reference."""

    scene: Scene
    study: str
    combinations: Mapping[str, Combination]
    reference: str
    named: bool

    @property
    def curves(self) -> Curves:
        """The curves of the study."""
        curves = study_class(self.study).curves_of
        assert curves is not None  # else it would not be compared
        return curves

    @property
    def plans(self) -> dict[str, Plan]:
        """The combinations that can run."""
        return {label: one.plan for label, one in self.combinations.items() if one.plan is not None}

    @property
    def seconds(self) -> float:
        """Estimated time [s]: all are run, checked in about as long, and evaluated again on the slices of one run."""
        return 1.5 * sum(plan.seconds for plan in self.plans.values())

    @property
    def told(self) -> list[str]:
        """What will run, with its size and cost as far as they can be told."""
        from rollslip.cli.console import headline_of

        chosen = [one.choices for one in self.combinations.values()]
        plans = self.plans.values()
        models = dict.fromkeys(
            (kind, c[kind].name, c[kind].full) for kind in chosen[0] for c in chosen
        )
        several = (
            f"{self.study} of {len(self.combinations)} combinations: {', '.join(self.combinations)}"
        )
        slices = sum(plan.evaluations for plan in plans)
        cost = f"about {slices} slices to evaluate, {duration_range(self.seconds)}"
        return [*filter(None, (headline_of(self.scene, models), several, self.exchanged, cost))]

    @property
    def exchanged(self) -> str:
        """Say what models take the place of, where it is not all of the scene's model; empty if it always is."""
        return "; ".join(
            f"{kind} models take the place of the {child} model of the scene's {getattr(self.scene.models, kind).name}"
            for kind, child in CHILD.items()
            if any(
                one.choices[kind].full != one.choices[kind].label
                for one in self.combinations.values()
            )
        )


# Planning -----------------------------------------------------------------------------------------------------------


def plan_comparison(requested: "ComparisonSettings") -> Comparison:
    """Check all names and plan every combination."""
    scene = requested.given
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
    wanted = {} if requested.reference is None else _by_kind(requested.reference, problems, unknown)
    named = {
        kind: read_choice(scene, kind, model, problems, unknown) for kind, model in wanted.items()
    }
    refuse(problems, unknown)
    products = [
        dict(zip(KINDS, each, strict=True)) for each in itertools.product(*choices.values())
    ]
    products.append({kind: named.get(kind, choices[kind][0]) for kind in KINDS})
    shown = [kind for kind in KINDS if len({product[kind].label for product in products}) > 1]
    if not shown:
        raise SceneError(
            [
                "there is nothing to compare: name two models of a kind, as by --film A,B,"
                " or one and another --reference"
            ]
        )
    labels = [" + ".join(product[kind].label for kind in shown) for product in products]
    combinations = {
        label: _combination(scene, study, product)
        for label, product in dict(zip(labels, products, strict=True)).items()
    }
    return Comparison(
        scene=scene,
        study=study,
        combinations=_at_one_resolution(study, combinations),
        reference=labels[-1],
        named=requested.reference is not None,
    )


def _study(scene: Scene, study: str | None) -> str:
    if study is None:
        study = next(
            (name for name in scene.study if study_class(name, scene).curves_of is not None),
            DEFAULT_STUDY,
        )
    if study_class(study, scene).from_scene(scene).curves_of is None:
        others = [name for name, cls in loadable("study") if cls.curves_of is not None]
        raise SceneError(
            [
                f"study {study!r} cannot be compared, only {' and '.join(others)} can; name one by --study"
            ]
        )
    return study


def _by_kind(
    reference: Model | Mapping[str, Model], problems: list[str], unknown: list[PluginError]
) -> dict[str, Model]:
    """Return the models of the reference by kind; a name tells its kind, a table or a model is a traction."""
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
            kinds = f"{', '.join(KINDS[:-1])} or {KINDS[-1]}"
            unknown.append(UnknownNameError(f"reference: no {kinds} is called {name!r}; {hint}"))
        elif kind in found:
            problems.append(f"reference: {found[kind]!r} and {name!r} are both a {kind}; name one")
        else:
            found[kind] = name
    return found


def _combination(scene: Scene, study: str, choices: Mapping[str, Choice]) -> Combination:
    changes: dict[str, object] = {
        f"models.{kind}": choice.table for kind, choice in choices.items()
    }
    outputs = study_class(study).outputs.items()
    larger = [
        name for name, output in outputs if len(output.dims.split()) > 2
    ]  # than a curve, and compared by nobody
    try:
        return Combination(
            choices, plan(evolve(scene, changes), study, cheaper_laws=False, without=larger), None
        )
    except Exception as error:
        return Combination(choices, None, error)


def _at_one_resolution(
    study: str, combinations: Mapping[str, Combination]
) -> dict[str, Combination]:
    """Return the combinations with the slices and instants of the one that needs most, so that all have the same."""
    chosen = [
        one.plan.choices[study].resolution for one in combinations.values() if one.plan is not None
    ]
    planned = [one for one in chosen if one.n_positions is not None]
    if not planned:
        return dict(combinations)
    most = Resolution.maximum_of(planned)

    def alike(plan: Plan) -> Plan:
        own = plan.choices[study].resolution
        same = attrs.evolve(
            own, slices=most.slices, quadrature=most.quadrature, n_positions=most.n_positions
        )
        return plan.at(study, same)

    return {
        label: one if one.plan is None else attrs.evolve(one, plan=alike(one.plan))
        for label, one in combinations.items()
    }


# Running ------------------------------------------------------------------------------------------------------------


def run_comparison(
    comparison: Comparison, progress: Callable[[str, float], None] = lambda text, fraction: None
) -> "xr.Dataset":
    """Run all combinations that can run; see `compare`."""
    begin = time.perf_counter()
    plans = comparison.plans
    errors = {
        label: one.error for label, one in comparison.combinations.items() if one.error is not None
    }

    def tried(labels: Collection[str], begun: float, make: Callable[[str], Any]) -> dict[str, Any]:
        """What can be had of combinations; if nothing can, all errors are raised as one."""
        found = {}
        for k, label in enumerate(labels):
            progress(label, begun + 0.5 * k / len(labels))
            try:
                found[label] = make(label)
            except Exception as error:  # somebody's model may raise anything
                errors[label] = error
        return found or _raise_all(errors)

    # a combination is run, and then evaluated at the slices of another
    done: dict[str, xr.Dataset] = tried(
        plans, 0.0, lambda label: execute(plans[label], comparison.study)
    )
    # without the reference the slices of another serve to measure the cost
    standard = comparison.reference if comparison.reference in done else next(iter(done))
    work = EvaluatedSlices.of(plans[standard], comparison.study, done[standard])
    law = law_to_sort_by([plans[label].assembly.traction for label in (standard, *done)])
    keep = {comparison.reference: keep_criteria(law)}
    evaluated = tried(
        done, 0.5, lambda label: work.evaluate(plans[label], keep.get(label, keep_friction))
    )
    found, first = ({label: both[k] for label, both in evaluated.items()} for k in (0, 1))
    done = {label: done[label] for label in evaluated}
    failed = {label: f"failed: {_text(error)}" for label, error in errors.items()}
    dataset = _merged(comparison, done, failed)
    dataset = dataset.assign(_costs(comparison, done, seconds_per_slice(work, plans, first)))
    dataset = dataset.assign(_errors(comparison, dataset))
    if comparison.reference in found:
        by = Bins.of(plans[comparison.reference], found[comparison.reference], law)
        friction = {label: kept["friction"] for label, kept in found.items()}
        dataset = attribute_differences(
            dataset, comparison.curves.over, comparison.reference, work, friction, by
        )
        own = law is not None and law is plans[comparison.reference].assembly.traction.full_film
        dataset = dataset.assign_attrs(
            sorted_by="" if law is None else law.name, sorted_by_own=int(own)
        )
    return dataset.assign_attrs(_origin(comparison, done, failed, time.perf_counter() - begin))


def _raise_all(errors: Mapping[str, Exception]) -> NoReturn:
    """Raise one error for all, of the first one's class."""
    first = next(iter(errors.values()))
    texts = {label: _text(error) for label, error in errors.items()}
    same = len(set(texts.values())) == 1
    lines = (
        list(texts.values())[:1] if same else [f"{label}: {text}" for label, text in texts.items()]
    )
    if isinstance(first, SceneError):
        raise SceneError(lines)
    raise (type(first) if isinstance(first, RollslipError) else PluginError)(
        "\n".join(lines)
    ) from first


def _text(error: Exception) -> str:
    return str(error) if isinstance(error, RollslipError) else describe_error(error)


# The dataset --------------------------------------------------------------------------------------------------------


def _merged(
    comparison: Comparison, done: "Mapping[str, xr.Dataset]", failed: Mapping[str, str]
) -> "xr.Dataset":
    """Return the curves of all combinations in one dataset, nan where one failed."""
    import xarray as xr

    labels = list(comparison.combinations)
    chosen = [one.choices for one in comparison.combinations.values()]
    results = list(done.values())
    words = {
        str(name): "" for name, values in results[0].variables.items() if values.dtype.kind in "OU"
    }
    dataset = (
        xr.concat(results, "combination", data_vars="all", coords="minimal", compat="override", join="override",
                  combine_attrs="override")
        .assign_coords(combination=list(done))
        .reindex(combination=labels, fill_value={"regime": -1, **words})
    )  # fmt: skip
    if "film_thickness" in dataset:
        dataset["film_thickness"].attrs["long_name"] = "film thickness, the one of film_location"
    critical = dataset["critical_status"]
    texts = [
        [failed[label]] * row.size if label in failed else row.tolist()
        for label, row in zip(labels, critical.to_numpy(), strict=True)
    ]
    dataset["critical_status"] = (critical.dims, np.array(texts), critical.attrs)
    status = np.array([failed.get(label, "done") for label in labels])
    dataset["status"] = ("combination", status, about("1", "what became of the combination"))
    names = {kind: np.array([choices[kind].full for choices in chosen]) for kind in KINDS}
    return dataset.assign_coords(
        {
            kind: ("combination", values, about("1", f"{kind} model"))
            for kind, values in names.items()
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
    """Return film and cost of every combination."""
    curve = comparison.curves.over
    slip = comparison.curves.slip
    labels = list(comparison.combinations)
    cheapest = min(cost, key=cost.__getitem__)
    films, parameters = np.full((2, len(labels), next(iter(done.values())).sizes[curve]), np.nan)
    for label, result in done.items():
        rings = [result.attrs["ring"]] if "ring" in result.attrs else RINGS
        roughness = [
            getattr(comparison.plans[label].assemblies[comparison.study], ring).conditions.roughness
            for ring in rings
        ]
        parameters[labels.index(label)] = result["film_parameter"].isel({slip: 0})
        films[labels.index(label)] = parameters[labels.index(label)] * np.array(roughness)
    seconds = np.array([cost.get(label, np.nan) for label in labels])
    evaluations = np.array(
        [done[label].attrs["evaluations"] if label in done else 0 for label in labels]
    )
    location = [
        comparison.plans[label].assembly.film.location if label in done else "" for label in labels
    ]
    each = "combination"
    return {
        "smallest_film": ((each, curve), films, about("m", "smallest film thickness without slip")),
        "smallest_film_parameter": (
            (each, curve),
            parameters,
            about("1", "smallest film parameter Lambda without slip"),
        ),
        "film_location": (
            each,
            np.array(location),
            about("1", "which film thickness the film model returns"),
        ),
        "seconds_per_slice": (each, seconds, about("s", "time of the chain per slice")),
        "cost": (
            each,
            seconds / cost[cheapest],
            about("1", f"time of the chain over that of {cheapest}"),
        ),
        "evaluations": (each, evaluations, about("1", "slices evaluated by the study")),
    }


def _errors(comparison: Comparison, dataset: "xr.Dataset") -> "dict[str, xr.DataArray]":
    """Return the relative differences of the curves and of their maxima from the reference's."""
    curves = comparison.curves
    which = f"{'error against' if comparison.named else 'difference from'} {comparison.reference}"

    def relative(name: str) -> "xr.DataArray":
        standard = dataset[name].sel(combination=comparison.reference, drop=True)
        with np.errstate(divide="ignore", invalid="ignore"):
            return (dataset[name] / standard - 1.0).where(standard != 0.0)

    found = relative(curves.variable)
    errors: dict[str, tuple[Any, str]] = {
        "difference": (found, "relative {}"),
        "max_error": (abs(found).max(curves.slip), "largest relative {} over the curve"),
        "rms_error": (
            np.sqrt((found**2).mean(curves.slip)),
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
    """Return the attributes of the comparison: those of its runs put together, about the scene as it was given."""
    runs = {label: result.attrs for label, result in done.items()}
    scene = comparison.scene
    first = next(iter(runs.values()))

    warned: dict[str, list[str]] = {}
    for label, result in done.items():
        told, more = of_consequence([result])
        for warning in (
            *told,
            *(
                [f"{describe_more_bounds(more)}; rollslip run of the scene tells of each"]
                if more
                else []
            ),
        ):
            warned.setdefault(warning, []).append(label)
    largest = [
        key
        for key in ("positions_error", "slices_error", "force_residual", "moment_residual")
        if key in first
    ]
    return {key: max(attributes[key] for attributes in runs.values()) for key in largest} | origin(
        study="comparison",
        compared=comparison.study,
        curves=comparison.curves.attribute,
        **({"curves_with": first["curves_with"]} if "curves_with" in first else {}),
        reference=comparison.reference,
        reference_named=int(comparison.named),
        exchanged=comparison.exchanged,
        combinations={
            label: {kind: choice.table for kind, choice in one.choices.items()}
            for label, one in comparison.combinations.items()
        },
        scene_resolved=resolved(scene),
        scene_hash=scene_hash(scene),
        **together(runs.values(), "plan"),
        warnings=[f"{label} {text}" for label, text in failed.items()]
        + [
            text if len(who) == len(done) else f"{', '.join(who)}: {text}"
            for text, who in warned.items()
        ],
        evaluations=sum(int(attributes["evaluations"]) for attributes in runs.values()),
        wall_time=wall_time,
    )
