"""Plan a sweep: check all settings before any point is computed, and choose the resolutions.

- What is swept comes from the scene's tables ``[sweep]`` and ``[uncertainty]`` and from the call or the command line.
- A folder belongs to one sweep. If its facts have changed since, an error lists the changes.
- Each value of an axis is checked by itself in the scene, so that a wrong value in the middle of a grid is found before
  the first point. A combination of values that is wrong ends its point with status "outside-domain".
- The resolution is chosen once for all points, because a plan for each point would cost as much as several points, and
  a point without a plan takes 101 slices and doubles its roller positions. The plan of a run is made for the scene and
  for some points that are far apart; the maximum of their resolutions is that of all points. It follows from scene and
  design alone, and is one of the facts. Laws are not replaced by approximations, because the bounds of these would have
  to be checked at each point. Only studies with `Study.shares_resolution` share a resolution: steady slips cost more at
  the resolution of the plan than by doubling.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.bearing.resolution import Resolution
from rollslip.catalogue.installed import THIS_PROCESS
from rollslip.catalogue.packages import check_required
from rollslip.errors import OutputError, RollslipError, SceneError
from rollslip.fields import FieldError
from rollslip.files import whole_file
from rollslip.planning.campaign import listed
from rollslip.planning.plan import estimate, require_memory
from rollslip.planning.plausibility import implausible_in_sweep
from rollslip.planning.provenance import collect_citations, data_references, offers_of
from rollslip.references import Citation
from rollslip.scene.changes import Quantity, describe_unknown_key, evolve, full_key
from rollslip.scene.reading import as_scene, from_raw, load_scene, parse_scene, shipped_scenes
from rollslip.scene.values import DEFAULT_STUDY, Scene
from rollslip.structure import (
    FrozenTable,
    Location,
    raise_problem_if,
    raise_problems,
    resolved,
    structure,
)
from rollslip.studies.outputs import named_outputs
from rollslip.studies.quantities import quantities
from rollslip.studies.study import settings, study_class
from rollslip.units import as_written, format_quantity
from rollslip_campaigns.sweep.definition import Resolutions, Sweep, SweepTable, combination_name
from rollslip_campaigns.sweep.journal import has_died, journal_files
from rollslip_campaigns.sweep.sampling import (
    CANDIDATES,
    Axis,
    Design,
    farthest_points,
    probabilities,
    read_axis,
    read_overs,
)
from rollslip_studies.variation.distributions import Distribution, Uncertainty, read_uncertainty

__all__ = [
    "FILE",
    "assemble_varied",
    "open_sweep",
    "plan_sweep",
    "resolution_at",
    "store_sweep",
    "study_with_outputs",
    "sweep_of_design",
    "with_engine",
    "without_tables",
]

#: Maximum number of values of an axis that are checked in the scene before the start; of a longer axis, values that are
#: evenly spread. Twice as many take twice the time. Chosen.
_MAX_CHECKED_VALUES = 1000
#: Maximum number of points of a sweep; each takes a byte in memory and more in the journal. Chosen: a larger number is
#: mostly a typing error.
_MAX_POINTS = 10_000_000
#: Name of the file with the description of a sweep, in its folder.
FILE: Final = "sweep.json"
#: Number of points, besides the scene itself, for which a resolution is chosen. Twice as many cost twice the time and
#: find extreme points more surely. Chosen: one choice costs about six points.
_RESOLUTION_POINTS: Final = 8
#: Minimum number of points of a combination for which a resolution is chosen. With fewer points the choice, which costs
#: about six points for each of nine, would take longer than it saves. Chosen.
_MIN_POINTS_OF_COMBINATION: Final = 100
#: Advice for a folder whose description is lost.
_RECREATE = "the same command as before, with --out {}, makes it again and takes up the journals"


def plan_sweep(scene: Scene | str, over: object = None, **requested: Any) -> Sweep:
    """Check the settings of a sweep and return its plan; wrong settings raise SceneError with all faults.

    Parameters
    ----------
    scene : Scene or str
        A scene, the name of a shipped one, or a file.
    over : mapping or sequence of str, optional
        What is varied, in addition to the table [sweep] of the scene (`rollslip.sweep`).
    **requested : object
        Settings of `SweepTable`, in place of those of the scene; None for the setting of the scene.
    """
    given = as_scene(scene)
    base = without_tables(given)
    where = Location(given.origins)
    problems = list[str]()
    check_required(base.plugins.require, where.at("plugins").at("require"))
    overrides = {} if over is None else read_overs(over)
    outputs = listed(requested.pop("output", ()))
    changes = {key: value for key, value in requested.items() if value is not None}
    if outputs:
        changes["output"] = outputs
    table, table_location = _read_table(given, changes, problems)
    study = study_with_outputs(base, table.study, table.output)
    cls = study_class(study, base)
    output_names: tuple[str, ...] = ()
    try:
        output_names = named_outputs(cls, table.output)
    except SceneError as error:
        problems += error.problems
    stated = [*_flatten(table.over, "", table_location.at("over"))]
    varying = {key: value for key, value, _ in stated} | overrides
    base, assembly = assemble_varied(base, varying)
    studies = settings(base, study)
    require_memory(studies, assembly)
    known = quantities(assembly, studies)
    is_sampled = table.samples is not None
    overriding = (
        (key.strip(), value, Location({}, tuple(key.strip().split("."))))
        for key, value in overrides.items()
    )
    axes, ranges = _read_axes([*stated, *overriding], known, is_sampled, problems)
    uncertainty = read_uncertainty(
        given.uncertainty or {}, where.at("uncertainty"), known, problems
    )
    uncertainty = (
        _with_ranges(uncertainty, ranges) if is_sampled else Uncertainty({}, np.empty((0, 0)))
    )
    _check_varied(axes, uncertainty, is_sampled, table_location, problems)
    if problems:
        raise SceneError(list(dict.fromkeys(problems)))
    sampled = tuple(known[key] for key in uncertainty.distributions)
    samples = np.empty((1, 0))
    if sampled:
        samples = uncertainty.values(
            probabilities(table.sampling, table.samples or 1, len(sampled), table.seed)
        )
    return sweep_of_design(
        base,
        study,
        output_names,
        Design(tuple(axes), sampled, samples),
        given=given,
        table=attrs.evolve(table, over=FrozenTable(varying)),
        uncertainty=uncertainty,
    )


def sweep_of_design(
    base: Scene,
    study: str,
    outputs: tuple[str, ...],
    design: Design,
    *,
    given: Scene,
    table: SweepTable,
    uncertainty: Uncertainty | None = None,
) -> Sweep:
    """Return the sweep over the points of a design, whose values are checked in the scene.

    Parameters
    ----------
    base : Scene
        The scene that every point changes, without tables of sweeps.
    study : str
        The study.
    outputs : tuple of str
        Variables of the study that are stored.
    design : Design
        The points.
    given : Scene
        The scene as it was given.
    table : SweepTable
        Settings of the sweep.
    uncertainty : Uncertainty, optional
        Distributions of the samples; by default none.
    """
    raise_problem_if(
        design.size > _MAX_POINTS,
        f"sweep: {design.size} points are more than {_MAX_POINTS}; take fewer values or samples",
    )
    assemblies, unusual = _checked_assemblies(base, study, design)
    packages, local = _packages(assemblies, study)
    is_run = table.errors or table.bands
    return Sweep(
        scene=base,
        study=study,
        outputs=outputs,
        design=design,
        uncertainty=Uncertainty({}, np.empty((0, 0))) if uncertainty is None else uncertainty,
        # a point with an error has a plan of its own
        resolutions=Resolutions() if is_run else _chosen_resolutions(base, study, design),
        errors=is_run,
        bands=table.bands,
        packages=packages,
        local=local,
        citations=_citations(assemblies, study),
        table=table,
        given=given,
        unusual=unusual,
        files=settings(base, study)[study].digest(assemblies[0]),
    )


def _check_varied(
    axes: Sequence[Axis],
    uncertainty: Uncertainty,
    is_sampled: bool,
    location: Location,
    problems: list[str],
) -> None:
    """Add messages to the problems: on keys that vary twice or inside a table that varies, and if nothing varies."""
    varied = [*(axis.key for axis in axes), *uncertainty.distributions]
    problems += [
        f"{key}: is both an axis and uncertain; choose one"
        for key in {k for k in varied if varied.count(k) > 1}
    ]
    for outer in set(varied):
        problems += [
            f"{inner}: cannot vary while {outer} does, which takes its place; list tables with the parameter instead"
            for inner in varied
            if inner.startswith(f"{outer}.")
        ]
    if not problems and is_sampled and not uncertainty.distributions:
        problems.append(
            location.at("samples").message(
                "there is nothing to sample; give a range without a count, such as --over "
                "operation.radial_load=500N:5000N, or a table [uncertainty]"
            )
        )
    elif not problems and not varied:
        problems.append(
            location.message(
                "there is nothing to sweep; give --over KEY=LOW:HIGH:COUNT, a list, or samples of an [uncertainty]"
            )
        )


def study_with_outputs(scene: Scene, named: str | None, outputs: Sequence[str]) -> str:
    """Return the name of the study of a sweep: the requested one, else the first that has the outputs, else the first.

    A study that has the outputs under alternative names, such as "slip", comes after those that have them under their
    own; among several of these, studies with a cage come first, as in a run of several studies.

    Parameters
    ----------
    scene : Scene
        The scene, whose studies are considered in order.
    named : str or None
        The requested study.
    outputs : sequence of str
        The requested outputs; empty for the main outputs of the study.
    """
    study_names = [*scene.study] or [DEFAULT_STUDY]
    classes = (
        {study_name: study_class(study_name, scene) for study_name in study_names}
        if outputs
        else {}
    )
    candidates = [
        study_name
        for study_name, study_class_of in classes.items()
        if study_class_of.outputs.keys() >= set(outputs)
    ]
    candidates += sorted(
        (
            study_name
            for study_name, study_class_of in classes.items()
            if {
                name
                for key, output in study_class_of.outputs.items()
                for name in (key, *output.aliases)
            }
            >= set(outputs)
        ),
        key=lambda study_name: not classes[study_name].with_cage,
    )
    return named or next(iter(candidates), study_names[0])


def _read_table(
    given: Scene, requested: Mapping[str, object], problems: list[str]
) -> tuple[SweepTable, Location]:
    """The table [sweep] of a scene with the requested settings in place of its own, and its location in the file."""
    table_values = {**(given.sweep or {}), **requested}
    origins = {
        path: text
        for path, text in given.origins.items()
        if path[:1] != ("sweep",) or path[1:2] not in {(k,) for k in requested}
    }
    place = Location(origins).at("sweep")
    if (table := structure(SweepTable, table_values, place, problems)) is None:
        raise SceneError(problems)
    if table.samples is None and "sampling" in table_values:
        problems.append(
            place.at("sampling").message(
                "selects how samples are drawn, but no samples are requested; give samples"
            )
        )
    return table, place


def _read_axes(
    varied: Sequence[tuple[str, object, Location]],
    known: dict[str, Quantity],
    sampled: bool,
    problems: list[str],
) -> tuple[list[Axis], dict[str, Distribution]]:
    """Axes, and distributions of the ranges that are sampled; of a key that occurs twice, the last one is valid."""
    axes = list[Axis]()
    ranges = dict[str, Distribution]()
    for key, values, location in {full_key(item[0]): item for item in varied}.values():
        if (quantity := known.get(key)) is None:
            problems.append(location.message(describe_unknown_key(key, known)))
            continue
        try:
            axis_or_distribution = read_axis(quantity, values, sampled)
        except RollslipError as error:
            problems.append(
                location.message(error.reason if isinstance(error, FieldError) else str(error))
            )
            continue
        if isinstance(axis_or_distribution, Axis):
            axes.append(axis_or_distribution)
        else:
            ranges[quantity.key] = axis_or_distribution
    return axes, ranges


def without_tables(scene: Scene) -> Scene:
    """Return the scene without the tables of sweeps and cases, which are not part of a point."""
    return attrs.evolve(
        scene,
        sweep=None,
        uncertainty=None,
        cases=None,
        supplement=None,
        raw=FrozenTable(
            {
                key: value
                for key, value in dict(scene.raw or resolved(scene)).items()
                if key not in ("sweep", "uncertainty", "cases", "supplement")
            }
        ),
    )


def assemble_varied(scene: Scene, over: Mapping[str, object]) -> tuple[Scene, Assembly]:
    """Assemble the scene; where this fails, the scene with the first value of each varied key.

    Parameters
    ----------
    scene : Scene
        The scene without the tables of sweeps.
    over : mapping
        Varied values, by key.

    Returns
    -------
    tuple of Scene and Assembly
        The scene that was assembled, and its bearing.
    """
    try:
        return scene, assemble(scene)
    except RollslipError:
        with suppress(RollslipError):  # the error of the scene as it was written is raised
            changed = evolve(
                scene, {key: _first_value(values) for key, values in over.items()}, si=True
            )
            return changed, assemble(changed)
        raise


def _first_value(values: object) -> object:
    """First value of a list or of a range as text."""
    if isinstance(values, str):
        return values.split(",")[0].split(":")[0]
    return values[0] if isinstance(values, Sequence) and values else values


def _flatten(
    table: Mapping[str, object], prefix: str, where: Location
) -> Iterator[tuple[str, object, Location]]:
    """Yield dotted key, value and location of each entry of a table, whose tables may be nested."""
    for key, value in table.items():
        path = f"{prefix}.{key}".removeprefix(".")
        if isinstance(value, Mapping):
            yield from _flatten(value, path, where.at(key))
        else:
            yield path, value, where.at(key)


def _with_ranges(uncertainty: Uncertainty, ranges: Mapping[str, Distribution]) -> Uncertainty:
    """Uncertain quantities with additional independent ranges, which replace distributions of the same keys."""
    remaining = [k for k, key in enumerate(uncertainty.distributions) if key not in ranges]
    distributions = {
        key: distribution
        for key, distribution in uncertainty.distributions.items()
        if key not in ranges
    } | dict(ranges)
    matrix = np.eye(len(distributions))
    matrix[: len(remaining), : len(remaining)] = uncertainty.correlation[
        np.ix_(remaining, remaining)
    ]
    return Uncertainty(distributions, matrix)


def _checked_assemblies(
    base: Scene, study: str, design: Design
) -> tuple[list[Assembly], tuple[str, ...]]:
    """Assemble the scene with each value of an axis, and check it with the bounds of the samples.

    Returns the assemblies and warnings of implausible values; wrong values raise SceneError.
    """
    problems = list[str]()
    unusual = list[str]()
    assemblies = [assemble(base)]
    for axis in design.checked_axes:
        count = len(axis.values)
        accepted_values = list[object]()
        for k in np.unique(np.linspace(0, count - 1, min(count, _MAX_CHECKED_VALUES)).astype(int)):
            value = axis.values[k]
            try:
                scene = evolve(base, {axis.key: value}, si=True)
                assemblies.append(assemble(scene, like=assemblies[0]))
                require_memory(settings(scene, study), assemblies[-1])
                accepted_values.append(axis.value_as_written(k))
            except SceneError as error:
                problems.append(
                    f"{axis.key}: value {k + 1} of {count}, {axis.format_value(value)}: {'; '.join(error.problems)}"
                )
                break
        unusual += implausible_in_sweep(
            base,
            axis.quantity,
            accepted_values,
            "values" if count <= _MAX_CHECKED_VALUES else "values tried",
        )
    for quantity, column in zip(design.sampled, design.samples.T, strict=True):
        bounds = [float(column.min()), float(column.max())]
        for value in bounds:
            try:
                evolve(base, {quantity.key: value}, si=True)
                quantity.read(value)
            except (SceneError, FieldError) as error:
                reason = (
                    "; ".join(error.problems) if isinstance(error, SceneError) else error.reason
                )
                problems.append(
                    f"{quantity.key}: sample {int(np.flatnonzero(column == value)[0])}, "
                    f"{Axis(quantity, ()).format_value(value)}: {reason}; cut the distribution off with at_least or "
                    "at_most"
                )
                break
        else:
            unusual += implausible_in_sweep(
                base,
                quantity,
                [format_quantity(value, quantity.unit or "1", 4) for value in bounds],
                f"ends of the {design.samples_name}",
            )
    raise_problems(problems)
    return assemblies, tuple(unusual)


def _packages(
    assemblies: Sequence[Assembly], study: str
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Packages that the points need, and models that are registered in this process only."""
    offers = {
        offer
        for assembly in assemblies
        for offer in offers_of(
            assembly.scene,
            study,
            (*assembly.models.items(), *settings(assembly.scene, study)[study].models(assembly)),
        )
    }
    local = sorted(
        f"{offer.kind} {offer.name}" for offer in offers if offer.package == THIS_PROCESS
    )
    packages = {offer.package for offer in offers} - {THIS_PROCESS}
    return tuple(sorted(packages | {"rollslip", "numpy", "scipy"})), tuple(local)


def _citations(assemblies: Sequence[Assembly], study: str) -> tuple[Citation, ...]:
    """References of all models, studies and data of the points."""
    models = list[Any]()
    references = list[Citation]()
    for assembly in assemblies:
        models += [
            *assembly.models.values(),
            *(model for _, model in settings(assembly.scene, study)[study].models(assembly)),
        ]
        references += [
            *settings(assembly.scene, study)[study].references,
            *data_references(assembly),
        ]
    return tuple(collect_citations(models, references))


# Resolutions ----------------------------------------------------------------------------------------------------------


def _chosen_resolutions(scene: Scene, study: str, design: Design) -> Resolutions:
    """Choose the resolutions of a sweep.

    1. Group the points by their values of the axes that decide.
    2. In each group of 100 points and more, select points that are far apart, and add the scene with the values of the
       group.
    3. Plan a run for each of them. The maximum of the resolutions is that of the group.
    """
    # models, tolerances and settings of studies have their own resolutions
    deciding = [
        k
        for k, axis in enumerate(design.axes)
        if (axis.quantity.unit is None and not axis.quantity.whole)
        or axis.key.startswith(("accuracy.", "study."))
    ]
    combinations = np.stack(np.unravel_index(np.arange(design.size), design.shape), axis=-1)[
        :, deciding
    ]
    if not study_class(study).shares_resolution:
        return Resolutions()
    resolutions = dict[str, Resolution]()
    for combination in np.unique(combinations, axis=0):
        numbers = np.flatnonzero((combinations == combination).all(axis=1))
        if numbers.size < _MIN_POINTS_OF_COMBINATION:
            continue
        values = {
            design.axes[k].key: design.axes[k].values[int(index)]
            for k, index in zip(deciding, combination, strict=True)
        }
        chosen = [
            resolution
            for changes in (values, *map(design.changes, _distant_points(design, numbers)))
            if (resolution := resolution_at(scene, study, changes)) is not None
        ]
        if chosen:
            resolutions[combination_name(list(values.values()))] = Resolution.maximum_of(chosen)
    return Resolutions(deciding=tuple(design.axes[k].key for k in deciding), chosen=resolutions)


def resolution_at(scene: Scene, study: str, changes: Mapping[str, object]) -> Resolution | None:
    """Return the resolution of the plan of a point, None if the plan fails; the point itself then ends with the reason.

    Parameters
    ----------
    scene : Scene
        The scene of the sweep.
    study : str
        Name of the study.
    changes : mapping
        Values of the point in SI units, by key.
    """
    try:
        changed_scene = evolve(scene, changes, si=True)
        estimated = estimate(study_class(study).from_scene(changed_scene), assemble(changed_scene))
    except RollslipError:
        return None
    return None if estimated.failed else estimated.resolution


def _distant_points(
    design: Design, numbers: "np.ndarray[tuple[int], np.dtype[np.int64]]"
) -> list[int]:
    """Numbers of some points that are far apart in their numeric values (`farthest_points`)."""
    candidates = numbers[np.unique(np.linspace(0, numbers.size - 1, CANDIDATES).astype(int))]
    rows = [
        [value for value in design.changes(int(number)).values() if isinstance(value, int | float)]
        for number in candidates
    ]
    return [
        int(candidates[k]) for k in farthest_points(np.array(rows, dtype=float), _RESOLUTION_POINTS)
    ]


# Folders -------------------------------------------------------------------------------------------------------------


def store_sweep(sweep: Sweep, folder: Path) -> None:
    """Write the description of a sweep to its folder.

    Parameters
    ----------
    sweep : Sweep
        The sweep.
    folder : Path
        Its folder.
    """
    stored = {
        "format": 1,
        "hash": sweep.hash,
        "facts": sweep.facts,
        "source": sweep.given.source,
        "text": sweep.given.text,
        "scene": sweep.given.raw or resolved(sweep.given),
        "table": {
            key: value
            for key, value in attrs.asdict(sweep.table, recurse=False).items()
            if value not in (None, ())
        },
    }
    with whole_file(folder / FILE) as partial:
        partial.write_text(json.dumps(stored, default=dict, indent=1), encoding="utf-8")


def open_sweep(folder: Path) -> Sweep:
    """Return the sweep of a folder; if scene or packages have changed since, OutputError lists the changes."""
    path = folder / FILE
    if not path.is_file():
        inner = f"; {_RECREATE.format(folder)}" if journal_files(folder) else ""
        raise OutputError(f"{folder}: holds no sweep, there is no {FILE}{inner}")
    try:
        stored = json.loads(path.read_text(encoding="utf-8"))
        table = dict(stored["table"])
        facts = stored["facts"]
        source = stored["source"]
        text = stored["text"]
        scene = attrs.evolve(
            from_raw(stored["scene"], source, text),
            sweep=None,
            raw=FrozenTable({k: v for k, v in stored["scene"].items() if k != "sweep"}),
        )
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise OutputError(
            f"{path}: cannot be read ({error}); remove it; {_RECREATE.format(folder)}"
        ) from error
    _refuse_changes(folder, _changed_file(source, text))
    over = table.pop("over", {})
    if "samples" not in table:
        table.pop("sampling", None)
    if has_died(folder):
        table.pop("engine", None)  # an engine is chosen anew, because this one did not survive
    sweep = plan_sweep(scene, over, **table)
    _refuse_changes(folder, _differences(facts, sweep.facts))
    return attrs.evolve(sweep, given=attrs.evolve(sweep.given, source=source, text=text))


def with_engine(sweep: Sweep, engine: object, time_limit: float | str | None) -> Sweep:
    """Return a sweep with another engine or time limit; its facts and hash do not depend on them.

    Parameters
    ----------
    sweep : Sweep
        The sweep.
    engine : object
        Engine, by name or as a table with its parameters; None for that of the sweep.
    time_limit : float or str or None
        Longest time for one point [s], or with a unit; None for that of the sweep.
    """
    settings_given = {"engine": engine, "time_limit": time_limit}
    changed = {name: value for name, value in settings_given.items() if value is not None}
    problems: list[str] = []
    table = structure(SweepTable, changed, Location({}, ("sweep",)), problems)
    if table is None:
        raise SceneError(problems)
    return attrs.evolve(
        sweep,
        table=attrs.evolve(sweep.table, **{name: getattr(table, name) for name in changed}),
    )


def _changed_file(source: str, text: str) -> list[str]:
    """Lines on the changes of a scene's file since its text was stored; none if the file does not exist."""
    if not text or not (Path(source).is_file() or source in shipped_scenes()):
        return []
    try:
        now = load_scene(source)
    except RollslipError as error:
        return [f"{source} can no longer be read: {error}"]
    return _differences(resolved(parse_scene(text, source)), resolved(now))


def _differences(old: Any, new: Any, prefix: str = "") -> list[str]:
    """Lines "key: old -> new" on the differences of nested tables."""
    if isinstance(old, Mapping) and isinstance(new, Mapping):
        return [
            line
            for key in dict.fromkeys((*old, *new))
            for line in _differences(
                old.get(key), new.get(key), f"{prefix}.{key}".removeprefix(".")
            )
        ]
    if json.dumps(old, default=list) == json.dumps(new, default=list):
        return []
    return [f"{prefix}: {_format_fact(old)} -> {_format_fact(new)}"]


def _format_fact(value: object) -> str:
    """Text of a value in a line on a change."""
    if value is None:
        return "nothing"
    return (
        as_written(value)
        if not isinstance(value, list | tuple)
        else ", ".join(map(str, value))[:80]
    )


def _refuse_changes(folder: Path, lines: list[str]) -> None:
    """Raise OutputError with the first ten lines on changes, if there are any."""
    if lines:
        more = f"\n  and {len(lines) - 10} more" if len(lines) > 10 else ""
        shown = "\n  ".join(lines[:10])
        raise OutputError(
            f"{folder}: belongs to another sweep, since then has changed:\n  {shown}{more}\n"
            "undo that, or start anew with another --out"
        )
