"""Compare error and cost: run a family of choices, compare it with its reference solution, and find the Pareto front.

1. Run each reference once.
2. Run all other choices in turns, round after round, so that changing loads of the machine affect all alike. A turn
   repeats a short study until it can be timed. The cost is the processor time of the study, of all threads together,
   without reading, planning and binding, because other programs affect it least.
3. The error of a result is its difference from that of the reference solution, relative to the largest value of each
   curve; of all curves the largest counts. The reference solution has an unknown error, too: errors below its
   difference from half its resolution are replaced by this floor.
4. The front is the choices that no other choice dominates: none is as cheap and as exact, and better in one of both.

- A choice is called faster only if each of its rounds is faster than all rounds of the other.
- A choice that fails has a status, and the others go on. A result that does not exist, such as a critical slip outside
  the range, has no error; its status states what the choice and what the reference solution find.
- Finished turns are in a journal, as points of sweeps are: a run that is interrupted or killed loses one turn.
"""

import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from typing import Any

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.bearing.assembly import assemble
from rollslip.bearing.raceway import Array
from rollslip.errors import describe_failure
from rollslip.planning.plan import Plan
from rollslip.planning.plausibility import implausible
from rollslip.planning.progress import ProgressReporter
from rollslip.planning.provenance import combine_origins, models_origin, origin, run_origin
from rollslip.results.dataset import about, xr
from rollslip.structure import scene_hash
from rollslip_campaigns.pareto.candidates import EXACT, HALF, MIN_TURN, Choice, Family
from rollslip_campaigns.pareto.findings import PLANNED, REFERENCE, ROUNDING
from rollslip_campaigns.sweep.journal import StoredValues


def front(cost: Array, error: Array) -> NDArray[np.bool_]:
    """Return which choices no other one dominates, (n,): none is as cheap and as exact, and better in one of both.

    Choices without cost or error are not on the front.
    """
    known = np.isfinite(cost) & np.isfinite(error)
    no_worse = (cost[:, None] <= cost) & (error[:, None] <= error) & known[:, None]
    better = (cost[:, None] < cost) | (error[:, None] < error)
    return np.asarray(known & ~np.any(no_worse & better, axis=0))


# Running --------------------------------------------------------------------------------------------------------------


@attrs.define
class Record:
    """Results and times of a choice.

    Attributes
    ----------
    status : str
        "" before its first turn, "done", or why it failed.
    results : dict
        Values of each result, one row for each curve or a single value, and their status.
    tolerances : dict
        Key of [accuracy] with the tolerance of each result; empty for the general one.
    seconds : list of float
        Processor time of each round [s].
    evaluations : int
        Number of evaluated slices.
    """

    status: str = ""
    results: dict[str, tuple[list[list[float]], str]] = attrs.Factory(dict)
    tolerances: dict[str, str] = attrs.Factory(dict)
    seconds: list[float] = attrs.Factory(list)
    evaluations: int = 0


def run_family(family: Family, folder: Path, show: "ProgressReporter") -> "xr.Dataset":
    """Run all choices of a family, or those that are missing in a folder, and return errors and costs.

    Parameters
    ----------
    family : Family
        The choices.
    folder : Path
        Folder of the journal.
    show : ProgressReporter
        Receives the progress.
    """
    start = time.perf_counter()
    with StoredValues(folder, _digest(family)) as stored:
        records = [Record(**stored.values.get(k, {})) for k in range(len(family.choices))]
        resumed = bool(stored.values)
        # load what is imported at first use before anything is timed; without a better one this time is that of a turn
        first = dict[str, float]()
        for study in family.studies:
            turn_start = time.perf_counter()
            _take_turn(family, family.choices_of(study, "numerical")[0], Record())
            first[study] = time.perf_counter() - turn_start
        timed = [k for k, choice in enumerate(family.choices) if choice.kind != "reference"]
        turns = [(k, 0) for k in range(len(family.choices)) if k not in timed]
        turns += [(k, n) for n in range(family.rounds) for k in timed]
        last = {k: first[choice.study] for k, choice in enumerate(family.choices)}
        for done, (k, n) in enumerate(turns):
            choice = family.choices[k]
            record = records[k]
            if len(record.seconds) > n or record.status not in ("", "done"):
                continue
            # each turn takes as long as the last one of the same choice
            time_left = sum(last[j] for j, _ in turns[done:])
            show(f"{choice.study}: {choice.label}", done / len(turns), time_left)
            turn_start = time.perf_counter()
            _take_turn(family, choice, record)
            last[k] = time.perf_counter() - turn_start
            stored.store(k, attrs.asdict(record))
        return _dataset(family, records, time.perf_counter() - start, resumed)


def _digest(family: Family) -> str:
    """Return a hash of scene, settings of the studies and all choices, but not of the number of rounds."""
    lines = [
        scene_hash(family.plan.scene),
        *(f"{name} {study}" for name, study in family.studies.items()),
        *(
            f"{choice.study} {choice.label} {scene_hash(choice.scene)} {choice.resolution}"
            for choice in family.choices
        ),
    ]
    return sha256("\n".join(lines).encode()).hexdigest()


def _take_turn(family: Family, choice: Choice, record: Record) -> None:
    """Run the study of a choice, store its results the first time, and its processor time."""
    seconds = 0.0
    count = 0
    study = family.studies[choice.study]
    try:
        while seconds < MIN_TURN * (choice.kind != "reference") or not count:
            assembly = assemble(choice.scene, choice.resolution)
            start = time.process_time()
            dataset = study.run(assembly)
            seconds = seconds + time.process_time() - start
            count = count + 1
            if dataset.attrs.get("outcome") == "interrupted":
                raise KeyboardInterrupt
            if dataset.attrs.get("outcome") == "failed":
                record.status = f"failed: {dataset.attrs['outcome_message']}"
                return
    except Exception as error:  # a third-party model may raise anything
        if choice.kind == "reference":
            raise
        record.status = f"failed: {describe_failure(error)}"
        return
    record.seconds.append(seconds / count)
    if not record.status:
        record.status = "done"
        for name, compared in study.compared_values(dataset).items():
            record.results[name] = [*map(list, compared.values)], compared.status
            record.tolerances[name] = compared.tolerance
        record.evaluations = assembly.inner.chain.evaluated
        if dataset.attrs.get("friction") == "conventional":  # a motion counts its own evaluations
            record.evaluations += int(dataset.attrs.get("contacts_evaluated", 0))


# The dataset ----------------------------------------------------------------------------------------------------------


def _dataset(
    family: Family, records: Sequence[Record], wall_time: float, resumed: bool
) -> "xr.Dataset":
    """Return errors, costs and fronts of all choices."""
    several = len(family.studies) > 1

    def full_name(study: str, text: str) -> str:
        return f"{study}: {text}" if several else text

    by_label = _by_label(family, records)
    results = [
        (study, name) for study in family.studies for name in by_label[study, REFERENCE].results
    ]
    tolerance = [
        family.plan.scene.accuracy.of(by_label[study, REFERENCE].tolerances[name])
        for study, name in results
    ]
    labels, kinds, owners = (
        np.array([getattr(choice, name) for choice in family.choices])
        for name in ("label", "kind", "study")
    )
    seconds, median, low, high = _times(records, family.rounds)
    numbers, statuses, floor = _compare_results(family, records, results)
    fronts = _fronts(family, numbers, floor, median, results)
    choice = "choice"
    both = ("choice", "result")
    dataset = xr.Dataset(
        {
            "error": (both, numbers["error"], about("1", "relative error against the finest of the same models")),
            "difference": (
                both,
                numbers["difference"],
                about("1", "relative difference from the finest of the exact model, of films from that of the scene's"),
            ),
            **{
                f"{name}_status": (both, texts.astype(str), about("1", f"what the {name} is, or why there is none"))
                for name, texts in statuses.items()
            },
            "on_front": (both, fronts["error"], about("1", "whether no numerical choice dominates it")),
            "on_model_front": (both, fronts["difference"], about("1", "whether no modelling choice dominates it")),
            "tolerance": ("result", np.array(tolerance), about("1", "error that the scene allows")),
            "floor": ("result", floor, about("1", "difference of the finest from one half as fine")),
            "kind": (choice, kinds, about("1", "numerical, modelling, film or reference")),
            "seconds": (choice, median, about("s", "processor time of the study, median of the rounds")),
            "seconds_low": (choice, low, about("s", "processor time of the study, the fastest round")),
            "seconds_high": (choice, high, about("s", "processor time of the study, the slowest round")),
            "round_seconds": ((choice, "round"), seconds, about("s", "processor time of the study")),
            "evaluations": (choice, np.array([r.evaluations for r in records]), about("1", "slices evaluated")),
            "status": (choice, np.array([r.status for r in records]), about("1", "what became of the choice")),
        },
        {
            choice: (choice, np.array([*map(full_name, owners, labels)]), about("1", "choice")),
            "label": (choice, labels, about("1", "departure from the plan")),
            "result": ("result", np.array([full_name(*pair) for pair in results]), about("1", "result")),
            "result_study": ("result", np.array([study for study, _ in results]), about("1", "study of the result")),
            "round": ("round", np.arange(1, family.rounds + 1), about("1", "round")),
            "study": (choice, owners, about("1", "study")),
            **_coordinates(family),
        },
    )  # fmt: skip
    return dataset.assign_attrs(_origin(family, dataset, records, wall_time, resumed))


def _by_label(family: Family, records: Sequence[Record]) -> dict[tuple[str, str], Record]:
    """Return the records by study and label."""
    return {
        (choice.study, choice.label): record
        for choice, record in zip(family.choices, records, strict=True)
    }


def _fronts(
    family: Family,
    numbers: Mapping[str, Array],
    floor: Array,
    seconds: Array,
    results: Sequence[tuple[str, str]],
) -> dict[str, NDArray[np.int8]]:
    """Return which choices are on the fronts of errors and of differences, (choice, result) each."""
    fronts = {name: np.zeros(values.shape, dtype=np.int8) for name, values in numbers.items()}
    for j, (study, _) in enumerate(results):
        for number, kind in (("error", "numerical"), ("difference", "modelling")):
            rows = [
                k
                for k, choice in enumerate(family.choices)
                if choice.study == study and (choice.kind == kind or choice.label == PLANNED)
            ]
            # below the floor no choice is known to be more exact than another
            bounded = np.maximum(numbers[number][rows, j], floor[j])
            fronts[number][rows, j] = front(seconds[rows], bounded)
    return fronts


def _times(records: Sequence[Record], rounds: int) -> tuple[Array, Array, Array, Array]:
    """Return the time of each round [s], (choice, round), with median, minimum and maximum, (choice,)."""
    seconds = np.full((len(records), rounds), np.nan)
    for k, record in enumerate(records):
        seconds[k, : len(record.seconds)] = record.seconds[:rounds]
    known = ~np.isnan(seconds).all(axis=1)
    median, low, high = (np.full(len(records), np.nan) for _ in range(3))
    for values, reduce in ((median, np.nanmedian), (low, np.nanmin), (high, np.nanmax)):
        values[known] = reduce(seconds[known], axis=1)
    return seconds, median, low, high


def _compare_results(
    family: Family, records: Sequence[Record], results: Sequence[tuple[str, str]]
) -> tuple[dict[str, Array], dict[str, NDArray[Any]], Array]:
    """Return errors and differences with their statuses, (choice, result) each, and the floor of errors, (result,)."""
    by_label = _by_label(family, records)
    shape = (len(records), len(results))
    numbers = {name: np.full(shape, np.nan) for name in ("error", "difference")}
    statuses = {name: np.full(shape, "", dtype=object) for name in numbers}
    floor = np.full(len(results), np.nan)
    for j, (study, name) in enumerate(results):
        reference = by_label[study, REFERENCE]
        exact = by_label.get((study, EXACT), reference)
        half = by_label.get((study, HALF), reference)
        floor[j] = max(_relative_error(half, reference, name)[0], ROUNDING)
        for k, (choice, record) in enumerate(zip(family.choices, records, strict=True)):
            if choice.study != study:
                continue
            base = reference if choice.kind == "film" else exact
            numbers["difference"][k, j], statuses["difference"][k, j] = _relative_error(
                record, base, name
            )
            if choice.kind == "numerical" or choice.label in (REFERENCE, HALF):
                numbers["error"][k, j], statuses["error"][k, j] = _relative_error(
                    record, reference, name
                )
    return numbers, statuses, floor


def _relative_error(record: Record, reference: Record, name: str) -> tuple[float, str]:
    """Return the error of a result, relative to the largest value of its curve, with its status; NaN if it has none."""
    if record.status != "done":
        return np.nan, record.status
    values, status = record.results[name]
    reference_values, reference_status = reference.results[name]
    if np.shape(values) != np.shape(reference_values):
        return np.nan, f"ends after {np.size(values)} of {np.size(reference_values)} instants"
    a = np.array(values)
    b = np.array(reference_values)
    if a.size == 1 and (np.isnan(a).any() or np.isnan(b).any()):
        if np.isnan(a).all() and np.isnan(b).all():
            return np.nan, "none, as the finest"
        if np.isnan(b).any():
            return np.nan, f"{a.item():.3%}, where the finest has none ({reference_status})"
        return np.nan, f"none ({status}), where the finest has {b.item():.3%}"
    scale = np.abs(b).max(axis=1)
    return float((np.abs(a - b).max(axis=1) / np.where(scale > 0.0, scale, 1.0)).max()), "found"


def _coordinates(family: Family) -> dict[str, Any]:
    """Return the settings of all choices as coordinates; 0 positions are doubled until the result converges."""
    rows = list[dict[str, Any]]()
    for choice in family.choices:
        r = choice.resolution
        study = family.studies[choice.study].with_resolution(r)
        own = study.numerical_settings(family.plan.assembly)
        law = family.plan.assembly.traction.full_film.name if r.traction == "named" else r.traction
        rows.append(
            {
                "slices": r.slices if family.plan.assembly.slices > 1 else 1,
                "quadrature": r.quadrature,
                "n_positions": r.n_positions or 0,
                "traction": law,
                "boundary": int(r.boundary),
                "table_tolerance": r.table_tolerance,
                "integrator": own.get("integrator", ""),
                "integrator_tolerance": own.get("integrator_tolerance", np.nan),
                "friction": own.get("friction", ""),
                "level": own.get("level", ""),
                "compiled": int(r.compiled),
                "film": choice.scene.models.film.name,
            }
        )
    return {
        name: (
            "choice",
            np.array([row[name] for row in rows]),
            about("1", name.replace("_", " ") + (", relative" * name.endswith("tolerance"))),
        )
        for name in rows[0]
    }


def _origin(
    family: Family,
    dataset: "xr.Dataset",
    records: Sequence[Record],
    wall_time: float,
    resumed: bool,
) -> dict[str, Any]:
    """Return the attributes: those of the plan, with the models of all choices."""
    warnings = [
        f"{name}: {text}"
        for name, text in zip(dataset["choice"].values, dataset["status"].values, strict=True)
        if text != "done"
    ]
    if resumed:
        warnings.append(
            "the run was interrupted and resumed: not all rounds ran under the same load of the machine"
        )
    warnings += implausible(family.plan.scene)
    evaluations = sum(record.evaluations for record in records)
    first = next(iter(family.studies))
    origins = [
        run_origin(each_plan, evaluations, wall_time) | models_origin(each_plan, first)
        for each_plan in _plans(family)
    ]
    return origins[0] | origin(
        warnings=warnings,
        plan=family.plan.parts_of(first),
        study="pareto",
        studies=list(family.studies),
        rounds=family.rounds,
        notes=family.notes,
        **combine_origins(origins),
    )


def _plans(family: Family) -> Iterator[Plan]:
    """Yield the plan, and the plan with the models of each choice, except those that fail, as their status says."""
    yield family.plan
    for choice in family.choices:
        if choice.kind in ("modelling", "film"):
            with suppress(Exception):
                yield attrs.evolve(family.plan, assembly=assemble(choice.scene, choice.resolution))
