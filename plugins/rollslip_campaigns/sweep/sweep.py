"""Lays out a sweep: checked as a whole before anything runs, and kept in its folder so that it can go on.

- What is swept comes from the scene's tables ``[sweep]`` and ``[uncertainty]``; a call or the command line adds to it.
- A folder belongs to one sweep; who goes on with it under other facts is told what has changed.
- Values are checked one by one, and every value of an axis once in the scene, so that a wrong one in the middle of a
  grid is found before the first point. What goes wrong only for a combination ends that point as "outside-domain".
- How finely points are computed is chosen once for all of them. A point that nobody planned takes 101 slices and
  doubles its instants; a plan of its own would cost several points. So the plan's choice is made for the scene and for
  some points that lie far apart, and the finest of these serves all: it follows from scene and design alone, and is one
  of the facts. Laws stay as they are named: what is left out under a bound would have to be watched in every point.
  Only of studies that say so (`Study.shares_resolution`): steady slips cost more at the plan's choice than by doubling.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.bearing.resolution import Resolution
from rollslip.catalogue.discovery import named_data
from rollslip.catalogue.installed import THIS_PROCESS
from rollslip.catalogue.packages import check_required
from rollslip.catalogue.registry import find
from rollslip.errors import OutputError, RollslipError, SceneError
from rollslip.fields import FieldError, submodels
from rollslip.files import whole_file
from rollslip.planning.campaign import listed
from rollslip.planning.plan import estimate, require_memory
from rollslip.planning.plausibility import implausible_along
from rollslip.planning.provenance import cited, data_references
from rollslip.references import Citation
from rollslip.scene.changes import Quantity, evolve, full_key, unknown
from rollslip.scene.reading import as_scene, from_raw, load_scene, parse_scene, shipped_scenes
from rollslip.scene.values import DEFAULT_STUDY, Scene
from rollslip.structure import FrozenTable, Location, resolved, structure
from rollslip.studies.outputs import named_outputs
from rollslip.studies.study import settings, study_class
from rollslip.units import as_written, format_quantity
from rollslip_campaigns.sweep.definition import Resolutions, Sweep, SweepTable, combination_name
from rollslip_campaigns.sweep.journal import has_died, journal_files
from rollslip_campaigns.sweep.sampling import (
    Axis,
    Design,
    probabilities,
    read_axis,
    read_overs,
    farthest_points,
)
from rollslip_studies.variation.distributions import Distribution, Uncertainty, read_uncertainty
from rollslip_studies.variation.quantities import quantities

__all__ = [
    "FILE",
    "assemble_varied",
    "open_sweep",
    "plan_sweep",
    "store_sweep",
    "study_with_outputs",
    "with_engine",
]

#: Values of an axis that are tried in the scene, each with all others as they are; those of a longer one lie between.
_TRIED = 1000
_MAX_POINTS = 10_000_000
#: What the sweep is, in its folder.
FILE: Final = "sweep.json"
#: Points besides the scene itself for which a choice is made; a choice costs about six points.
_SPREAD: Final = 8
#: Points of a combination from which on that is worth it.
_WORTH: Final = 100
#: Points among which those far apart are looked for.
_CANDIDATES: Final = 512
_AGAIN = "the same command as before, with --out {}, makes it again and takes up the journals"


def plan_sweep(scene: Scene | str, over: object = None, **requested: Any) -> Sweep:
    """Check a sweep and lay out its points; `requested` are settings of `SweepTable` in place of the scene's."""
    given = as_scene(scene)
    base = _without_tables(given)
    where = Location(given.origins)
    problems = list[str]()
    check_required(base.plugins.require, where.at("plugins").at("require"))
    over = {} if over is None else read_overs(over)
    outputs = listed(requested.pop("output", ()))
    requested = {key: value for key, value in requested.items() if value is not None} | (
        {"output": outputs} if outputs else {}
    )
    table, place = _table(given, requested, problems)
    name = study_with_outputs(base, table.study, table.output)
    cls = study_class(name, base)
    names: tuple[str, ...] = ()
    try:
        names = named_outputs(cls, table.output)
    except SceneError as error:
        problems += error.problems
    stated = [*_leaves(table.over, "", place.at("over"))]
    varying = {key: value for key, value, _ in stated} | over
    base, assembly = assemble_varied(base, varying)
    studies = settings(base, name)
    require_memory(studies, assembly)
    known = quantities(assembly, studies)
    sampled = table.samples is not None
    told = (
        (key.strip(), value, Location({}, tuple(key.strip().split("."))))
        for key, value in over.items()
    )
    axes, ranges = _axes([*stated, *told], known, sampled, problems)
    uncertainty = read_uncertainty(
        given.uncertainty or {}, where.at("uncertainty"), known, problems
    )
    uncertainty = (
        _with_ranges(uncertainty, ranges) if sampled else Uncertainty({}, np.empty((0, 0)))
    )
    varied = [*(axis.key for axis in axes), *uncertainty.distributions]
    problems += _conflicts(varied)
    if not problems and sampled and not uncertainty.distributions:
        problems.append(
            place.at("samples").message(
                "there is nothing to sample; give a range without a count, such as --over "
                "operation.radial_load=500N:5000N, or a table [uncertainty]"
            )
        )
    elif not problems and not varied:
        problems.append(
            place.message(
                "there is nothing to sweep; give --over KEY=LOW:HIGH:COUNT, a list, or samples of an [uncertainty]"
            )
        )
    if problems:
        raise SceneError(list(dict.fromkeys(problems)))
    drawn = np.empty((1, 0))
    if uncertainty.distributions:
        drawn = uncertainty.values(
            probabilities(
                table.sampling, table.samples or 1, len(uncertainty.distributions), table.seed
            )
        )
    design = Design(tuple(axes), tuple(known[key] for key in uncertainty.distributions), drawn)
    if design.size > _MAX_POINTS:
        raise SceneError(
            [
                f"sweep: {design.size} points are more than {_MAX_POINTS}; take fewer values or samples"
            ]
        )
    tried, unusual = _tried(base, name, design)
    packages, local = _packages(tried, name)
    return Sweep(
        scene=base,
        study=name,
        outputs=names,
        design=design,
        uncertainty=uncertainty,
        resolutions=_chosen_resolutions(base, name, design),
        packages=packages,
        local=local,
        citations=_citations(tried, name),
        table=attrs.evolve(table, over=FrozenTable(varying)),
        given=given,
        unusual=unusual,
        files=studies[name].digest(assembly),
    )


def study_with_outputs(scene: Scene, named: str | None, outputs: Sequence[str]) -> str:
    """Return the study that is named, else the first of the scene that has some outputs, or the first of all.

    By other names of theirs, such as "slip", one that has a cage goes first, as in a run of several.
    """
    own = [*scene.study] or [DEFAULT_STUDY]
    classes = {one: study_class(one, scene) for one in own} if outputs else {}
    having = [one for one, of in classes.items() if of.outputs.keys() >= set(outputs)]
    having += sorted(
        (
            one
            for one, of in classes.items()
            if {name for key, output in of.outputs.items() for name in (key, *output.also)}
            >= set(outputs)
        ),
        key=lambda one: not classes[one].with_cage,
    )
    return named or next(iter(having), own[0])


def _table(
    given: Scene, told: Mapping[str, object], problems: list[str]
) -> tuple[SweepTable, Location]:
    """Return the table of a sweep with what was told besides, and where it stands."""
    said = {**(given.sweep or {}), **told}
    origins = {
        path: text
        for path, text in given.origins.items()
        if path[:1] != ("sweep",) or path[1:2] not in {(k,) for k in told}
    }
    place = Location(origins).at("sweep")
    table = structure(SweepTable, said, place, problems)
    if table is None:
        raise SceneError(problems)
    if table.samples is None and "sampling" in said:
        problems.append(
            place.at("sampling").message(
                "says how samples are drawn, but none are asked for; give samples"
            )
        )
    return table, place


def _axes(
    wanted: Sequence[tuple[str, object, Location]],
    known: dict[str, Quantity],
    sampled: bool,
    problems: list[str],
) -> tuple[list[Axis], dict[str, Distribution]]:
    """Return what is crossed, and the ranges that are sampled; of a key that comes twice the last."""
    axes = list[Axis]()
    ranges = dict[str, Distribution]()
    for key, raw, at in {full_key(item[0]): item for item in wanted}.values():
        quantity = known.get(key)
        if quantity is None:
            problems.append(at.message(unknown(key, known)))
            continue
        try:
            axis = read_axis(quantity, raw, sampled)
        except RollslipError as error:
            problems.append(
                at.message(error.reason if isinstance(error, FieldError) else str(error))
            )
            continue
        if isinstance(axis, Axis):
            axes.append(axis)
        else:
            ranges[quantity.key] = axis
    return axes, ranges


def _without_tables(scene: Scene) -> Scene:
    """Return the scene without what is about sweeps, which is no part of a point."""
    raw = {
        key: value
        for key, value in dict(scene.raw or resolved(scene)).items()
        if key not in ("sweep", "uncertainty")
    }
    return attrs.evolve(scene, sweep=None, uncertainty=None, raw=FrozenTable(raw))


def assemble_varied(scene: Scene, over: Mapping[str, object]) -> tuple[Scene, Assembly]:
    """Assemble the scene; where it cannot be, with the first of the values that take the place of its own."""
    try:
        return scene, assemble(scene)
    except RollslipError:
        try:
            changed = evolve(scene, {key: _first(values) for key, values in over.items()})
            return changed, assemble(changed)
        except RollslipError:
            pass  # what is wrong is told of the scene as it was written
        raise


def _first(values: object) -> object:
    if isinstance(values, str):
        return values.split(",")[0].split(":")[0]
    return values[0] if isinstance(values, Sequence) and values else values


def _leaves(
    table: Mapping[str, object], prefix: str, where: Location
) -> Iterator[tuple[str, object, Location]]:
    """Dotted keys, whether the table was written with quoted keys or as tables in tables."""
    for key, value in table.items():
        path = f"{prefix}.{key}" if prefix else key
        if isinstance(value, Mapping):
            yield from _leaves(value, path, where.at(key))
        else:
            yield path, value, where.at(key)


def _with_ranges(uncertainty: Uncertainty, ranges: Mapping[str, Distribution]) -> Uncertainty:
    """Return uncertain values with ranges in their place or beside them."""
    kept = [k for k, key in enumerate(uncertainty.distributions) if key not in ranges]
    distributions = {
        key: one for key, one in uncertainty.distributions.items() if key not in ranges
    } | dict(ranges)
    matrix = np.eye(len(distributions))
    matrix[: len(kept), : len(kept)] = uncertainty.correlation[np.ix_(kept, kept)]
    return Uncertainty(distributions, matrix)


def _conflicts(keys: Sequence[str]) -> list[str]:
    problems = [
        f"{key}: is both an axis and uncertain; choose one"
        for key in {k for k in keys if keys.count(k) > 1}
    ]
    for outer in set(keys):
        problems += [
            f"{inner}: cannot vary while {outer} does, which takes its place; list tables with the parameter instead"
            for inner in keys
            if inner.startswith(f"{outer}.")
        ]
    return problems


def _tried(base: Scene, study: str, design: Design) -> tuple[list[Assembly], tuple[str, ...]]:
    """Put the scene together with every value of an axis, and with the ends of the samples; refuse what is wrong."""
    problems = list[str]()
    unusual = list[str]()
    assemblies = [assemble(base)]
    for axis in design.axes:
        count = len(axis.values)
        judged = list[object]()
        for k in np.unique(np.linspace(0, count - 1, min(count, _TRIED)).astype(int)):
            value = axis.values[k]
            try:
                scene = evolve(base, {axis.key: value})
                assemblies.append(assemble(scene, like=assemblies[0]))
                require_memory(settings(scene, study), assemblies[-1])
                judged.append(axis.written(k))
            except SceneError as error:
                problems.append(
                    f"{axis.key}: value {k + 1} of {count}, {axis.shown(value)}: {'; '.join(error.problems)}"
                )
                break
        unusual += implausible_along(
            base, axis.quantity, judged, "values" if count <= _TRIED else "values tried"
        )
    for of, column in zip(design.sampled, design.samples.T, strict=True):
        ends = [float(column.min()), float(column.max())]
        for value in ends:
            try:
                evolve(base, {of.key: value})
                of.read(value)
            except (SceneError, FieldError) as error:
                number = int(np.flatnonzero(column == value)[0])
                reason = (
                    "; ".join(error.problems) if isinstance(error, SceneError) else error.reason
                )
                shown = Axis(of, ()).shown(value)
                problems.append(
                    f"{of.key}: sample {number}, {shown}: {reason}; cut the distribution off with at_least or at_most"
                )
                break
        else:
            written = [format_quantity(value, of.unit or "1", 4) for value in ends]
            unusual += implausible_along(base, of, written, "ends of the samples")
    if problems:
        raise SceneError(problems)
    return assemblies, tuple(unusual)


def _packages(
    assemblies: Sequence[Assembly], study: str
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Distributions that the points need, and models that only this process has."""
    offers = {("study", study): find("study", study)}
    for assembly in assemblies:
        used = [*assembly.models.items(), *settings(assembly.scene, study)[study].models(assembly)]
        for kind, model in used:
            made = ((kind, model), *submodels(model))
            offers |= {
                (of, one.name): find(of, one.name) for of, one in made if hasattr(one, "name")
            }
        offers |= {
            (offer.kind, offer.name): offer for offer in named_data(assembly.scene.raw or {})
        }
    local = sorted(
        f"{kind} {name}" for (kind, name), offer in offers.items() if offer.package == THIS_PROCESS
    )
    packages = {offer.package for offer in offers.values()} - {THIS_PROCESS}
    return tuple(sorted(packages | {"rollslip", "numpy", "scipy"})), tuple(local)


def _citations(assemblies: Sequence[Assembly], study: str) -> tuple[Citation, ...]:
    models = list[Any]()
    others = list[Citation]()
    for assembly in assemblies:
        models += assembly.models.values()
        models += (model for _, model in settings(assembly.scene, study)[study].models(assembly))
        others += [*settings(assembly.scene, study)[study].references, *data_references(assembly)]
    return tuple(cited(models, others))


# Resolutions ----------------------------------------------------------------------------------------------------------


def _chosen_resolutions(scene: Scene, study: str, design: Design) -> Resolutions:
    """Choose the resolutions of a sweep."""
    deciding = [k for k, axis in enumerate(design.axes) if _decides(axis)]
    combinations = np.stack(np.unravel_index(np.arange(design.size), design.shape), axis=-1)[
        :, deciding
    ]
    if not study_class(study).shares_resolution:
        return Resolutions()
    resolutions = dict[str, Resolution]()
    for places in np.unique(combinations, axis=0):
        numbers = np.flatnonzero((combinations == places).all(axis=1))
        if numbers.size < _WORTH:
            continue
        values = {
            design.axes[k].key: design.axes[k].values[int(place)]
            for k, place in zip(deciding, places, strict=True)
        }
        points = [values, *(design.changes(int(number)) for number in _far_apart(design, numbers))]
        chosen = [
            one
            for one in (_resolution_at(scene, study, changes) for changes in points)
            if one is not None
        ]
        if chosen:
            resolutions[combination_name(list(values.values()))] = Resolution.maximum_of(chosen)
    return Resolutions(deciding=tuple(design.axes[k].key for k in deciding), chosen=resolutions)


def _decides(axis: Axis) -> bool:
    number = axis.quantity.unit is not None or axis.quantity.whole
    return not number or axis.key.startswith(("accuracy.", "study."))


def _resolution_at(scene: Scene, study: str, changes: Mapping[str, object]) -> Resolution | None:
    """Return the plan's choice at a point, None if it has none: the point will say why."""
    try:
        at = evolve(scene, changes) if changes else scene
        estimated = estimate(study_class(study).from_scene(at), assemble(at))
    except RollslipError:
        return None
    return None if estimated.failed else estimated.resolution


def _far_apart(design: Design, numbers: "np.ndarray[tuple[int], np.dtype[np.int64]]") -> list[int]:
    """Numbers of some points that lie far apart in the numbers that they vary."""
    some = numbers[np.unique(np.linspace(0, numbers.size - 1, _CANDIDATES).astype(int))]
    rows = [
        [v for v in design.changes(int(number)).values() if isinstance(v, int | float)]
        for number in some
    ]
    return [int(some[k]) for k in farthest_points(np.array(rows, dtype=float), _SPREAD)]


# Folders -------------------------------------------------------------------------------------------------------------


def store_sweep(sweep: Sweep, folder: Path) -> None:
    """Write down what a sweep is."""
    table = attrs.asdict(sweep.table, recurse=False)
    stored = {
        "format": 1,
        "hash": sweep.hash,
        "facts": sweep.facts,
        "source": sweep.given.source,
        "text": sweep.given.text,
        "scene": sweep.given.raw or resolved(sweep.given),
        "table": {key: value for key, value in table.items() if value not in (None, ())},
    }
    with whole_file(folder / FILE) as partial:
        partial.write_text(json.dumps(stored, default=dict, indent=1), encoding="utf-8")


def open_sweep(folder: Path) -> Sweep:
    """Return the sweep that a folder belongs to."""
    path = folder / FILE
    if not path.is_file():
        inner = f"; {_AGAIN.format(folder)}" if journal_files(folder) else ""
        raise OutputError(f"{folder}: holds no sweep, there is no {FILE}{inner}")
    try:
        stored = json.loads(path.read_text(encoding="utf-8"))
        table = dict(stored["table"])
        facts = stored["facts"]
        scene = from_raw(stored["scene"], stored["source"], stored["text"])
        scene = attrs.evolve(
            scene,
            sweep=None,
            raw=FrozenTable({k: v for k, v in stored["scene"].items() if k != "sweep"}),
        )
        source = stored["source"]
        text = stored["text"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise OutputError(
            f"{path}: cannot be read ({error}); remove it; {_AGAIN.format(folder)}"
        ) from error
    _refuse_changes(folder, _changed_file(source, text))
    over = table.pop("over", {})
    if "samples" not in table:
        table.pop("sampling", None)
    if has_died(folder):
        table.pop("engine", None)  # chosen anew, since that one did not survive
    sweep = plan_sweep(scene, over, **table)
    _refuse_changes(folder, _differences(facts, sweep.facts))
    return attrs.evolve(sweep, given=attrs.evolve(sweep.given, source=source, text=text))


def with_engine(sweep: Sweep, engine: object, time_limit: float | str | None) -> Sweep:
    """Return a sweep with another engine or time limit, where they are given; they are no part of what it is."""
    told = {"engine": engine, "time_limit": time_limit}
    problems: list[str] = []
    table = structure(
        SweepTable,
        {k: v for k, v in told.items() if v is not None},
        Location({}, ("sweep",)),
        problems,
    )
    if table is None:
        raise SceneError(problems)
    changes = {name: getattr(table, name) for name, value in told.items() if value is not None}
    return attrs.evolve(sweep, table=attrs.evolve(sweep.table, **changes))


def _changed_file(source: str, text: str) -> list[str]:
    """What has changed in the file of a scene since its text was stored; nothing if it is gone."""
    if not text or not (Path(source).is_file() or source in shipped_scenes()):
        return []
    try:
        now = load_scene(source)
    except RollslipError as error:
        return [f"{source} can no longer be read: {error}"]
    return _differences(resolved(parse_scene(text, source)), resolved(now))


def _differences(old: Any, new: Any, prefix: str = "") -> list[str]:
    """What has changed, line by line, by dotted key."""
    if isinstance(old, Mapping) and isinstance(new, Mapping):
        keys = dict.fromkeys((*old, *new))
        return [
            line
            for key in keys
            for line in _differences(
                old.get(key), new.get(key), f"{prefix}.{key}" if prefix else str(key)
            )
        ]
    if json.dumps(old, default=list) == json.dumps(new, default=list):
        return []
    return [f"{prefix}: {_was(old)} -> {_was(new)}"]


def _was(value: object) -> str:
    if value is None:
        return "nothing"
    return (
        as_written(value)
        if not isinstance(value, list | tuple)
        else ", ".join(map(str, value))[:80]
    )


def _refuse_changes(folder: Path, lines: list[str]) -> None:
    if lines:
        more = f"\n  and {len(lines) - 10} more" if len(lines) > 10 else ""
        shown = "\n  ".join(lines[:10])
        raise OutputError(
            f"{folder}: belongs to another sweep, since then has changed:\n  {shown}{more}\n"
            "undo that, or start anew with another --out"
        )
