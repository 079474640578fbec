"""Error against cost: run a family of choices against the finest of it, and find the front that none of them passes.

- Cost is the time that the processor spends in a study, all threads together, without reading, planning and binding:
  what a choice itself takes, which other work on the machine moves least.
- Choices take turns, round after round, so that a machine that changes its mood is unkind to all alike. A turn repeats
  a short study until it can be timed. A choice is called faster only where every one of its rounds is faster.
- A choice that fails is a status and stops no other. A result that is not there, such as a critical slip outside the
  range, has no error: its status says in words what is found, beside what the finest finds.
- What is done is kept in a journal, as points of sweeps are: a run that is interrupted or killed loses one turn.
"""

import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.bearing.assembly import assemble
from rollslip.bearing.raceway import Array
from rollslip.errors import RollslipError, describe_error
from rollslip.planning.plan import Plan
from rollslip.planning.plausibility import implausible
from rollslip.planning.provenance import models_origin, origin, run_origin, together
from rollslip.results.dataset import about
from rollslip.structure import scene_hash
from rollslip_campaigns.pareto.candidates import EXACT, FINEST, HALF, PLANNED, Choice, Family
from rollslip_campaigns.sweep.journal import StoredValues

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.planning.progress import ProgressReporter

#: Processor time [s] that a turn takes at least, so that the clock of every system can tell it.
_TURN: Final = 0.05
#: Error below which rounding governs, whatever the finest and one half as fine differ by.
_ROUNDING: Final = 1e-14


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
    """What is known of a choice so far.

    Attributes
    ----------
    status : str
        "" before its first turn, "done", or why it failed.
    results : dict
        Result -> its values, one row for each curve or a single value, and its status.
    tolerances : dict
        Result -> key of [accuracy] that it is held against; empty for the general one.
    seconds : list of float
        Processor time of each round [s].
    evaluations : int
        Slices evaluated.
    """

    status: str = ""
    results: dict[str, tuple[list[list[float]], str]] = attrs.Factory(dict)
    tolerances: dict[str, str] = attrs.Factory(dict)
    seconds: list[float] = attrs.Factory(list)
    evaluations: int = 0


def run_family(family: Family, folder: Path, show: "ProgressReporter") -> "xr.Dataset":
    """Run all choices of a family, or what is left of them in a folder."""
    begin = time.perf_counter()
    with StoredValues(folder, _digest(family)) as kept:
        records = [Record(**kept.values.get(k, {})) for k in range(len(family.choices))]
        resumed = bool(kept.values)
        for (
            study
        ) in family.studies:  # what is loaded at first use is to be loaded before anything is timed
            _take(family, family.of(study, "numerical")[0], Record())
        timed = [k for k, one in enumerate(family.choices) if one.kind != "reference"]
        turns = [(k, 0) for k in range(len(family.choices)) if k not in timed]
        turns += [(k, n) for n in range(family.rounds) for k in timed]
        last: dict[int, float] = {}
        for done, (k, n) in enumerate(turns):
            choice = family.choices[k]
            record = records[k]
            if len(record.seconds) > n or record.status not in ("", "done"):
                continue
            show(f"{choice.study}: {choice.label}", done / len(turns), _left(turns[done:], last))
            started = time.perf_counter()
            _take(family, choice, record)
            if k in timed:  # a reference says nothing of the others
                last[k] = time.perf_counter() - started
            kept.store(k, attrs.asdict(record))
        return _dataset(family, records, time.perf_counter() - begin, resumed)


def _digest(family: Family) -> str:
    """Return what tells a family from another: scene, settings of the studies and all choices, but not the rounds."""
    choices = [
        f"{one.study} {one.label} {scene_hash(one.scene)} {one.resolution}"
        for one in family.choices
    ]
    studies = [f"{name} {study}" for name, study in family.studies.items()]
    return sha256(
        "\n".join([scene_hash(family.plan.scene), *studies, *choices]).encode()
    ).hexdigest()


def _left(turns: Sequence[tuple[int, int]], last: Mapping[int, float]) -> float:
    """Seconds that turns will take: each as the last one of the same choice, or as the mean of the others'."""
    mean = sum(last.values()) / len(last) if last else np.nan
    return sum(last.get(k, mean) for k, _ in turns)


def _take(family: Family, choice: Choice, record: Record) -> None:
    """Take the turn of a choice: run its study, for the first time keep its results, and time it."""
    spent = 0.0
    count = 0
    study = family.studies[choice.study]
    try:
        while spent < _TURN * (choice.kind != "reference") or not count:
            assembly = assemble(choice.scene, choice.resolution)
            started = time.process_time()
            dataset = study.run(assembly)
            spent = spent + time.process_time() - started
            count = count + 1
            if dataset.attrs.get("outcome") == "interrupted":
                raise KeyboardInterrupt
            if dataset.attrs.get("outcome") == "failed":
                record.status = f"failed: {dataset.attrs['outcome_message']}"
                return
    except Exception as error:  # somebody's model may raise anything
        if choice.kind == "reference":
            raise
        record.status = (
            f"failed: {str(error) if isinstance(error, RollslipError) else describe_error(error)}"
        )
        return
    record.seconds.append(spent / count)
    if not record.status:
        record.status = "done"
        for name, one in study.compared_values(dataset).items():
            record.results[name] = [*map(list, one.values)], one.status
            record.tolerances[name] = one.tolerance
        record.evaluations = assembly.inner.chain.evaluated
        if dataset.attrs.get("friction") == "conventional":  # the motion counts for itself
            record.evaluations += int(dataset.attrs.get("contacts_evaluated", 0))


# The dataset ----------------------------------------------------------------------------------------------------------


def _dataset(
    family: Family, records: Sequence[Record], wall_time: float, resumed: bool
) -> "xr.Dataset":
    import xarray as xr

    of = {
        (one.study, one.label): record for one, record in zip(family.choices, records, strict=True)
    }
    several = len(family.studies) > 1

    def named(study: str, text: str) -> str:
        return f"{study}: {text}" if several else text

    results = [(study, name) for study in family.studies for name in of[study, FINEST].results]
    shape = len(records), len(results)
    numbers = {name: np.full(shape, np.nan) for name in ("error", "difference")}
    words = {name: np.full(shape, "", dtype=object) for name in numbers}
    floor = np.full(len(results), np.nan)
    fronts = {name: np.zeros(shape, dtype=np.int8) for name in numbers}
    tolerance = [
        family.plan.scene.accuracy.of(of[study, FINEST].tolerances[name]) for study, name in results
    ]
    labels, kinds, owners = (
        np.array([getattr(one, what) for one in family.choices])
        for what in ("label", "kind", "study")
    )
    seconds = np.full((len(records), family.rounds), np.nan)
    for k, record in enumerate(records):
        seconds[k, : len(record.seconds)] = record.seconds[: family.rounds]
    known = ~np.isnan(seconds).all(axis=1)
    median, low, high = (np.full(len(records), np.nan) for _ in range(3))
    for values, reduce in ((median, np.nanmedian), (low, np.nanmin), (high, np.nanmax)):
        values[known] = reduce(seconds[known], axis=1)
    for j, (study, name) in enumerate(results):
        reference_resolution = of[study, FINEST]
        exact = of.get((study, EXACT), of[study, FINEST])
        floor[j] = max(
            _compared(of.get((study, HALF), reference_resolution), reference_resolution, name)[0],
            _ROUNDING,
        )
        for k, (one, record) in enumerate(zip(family.choices, records, strict=True)):
            if one.study != study:
                continue
            against = reference_resolution if one.kind == "film" else exact
            numbers["difference"][k, j], words["difference"][k, j] = _compared(
                record, against, name
            )
            if one.kind == "numerical" or one.label in (FINEST, HALF):
                numbers["error"][k, j], words["error"][k, j] = _compared(
                    record, reference_resolution, name
                )
        for number, kind in (("error", "numerical"), ("difference", "modelling")):
            rows = np.flatnonzero((owners == study) & ((kinds == kind) | (labels == PLANNED)))
            # below the floor none is more exact than another, as far as anybody knows
            fronts[number][rows, j] = front(
                median[rows], np.maximum(numbers[number][rows, j], floor[j])
            )
    each = "choice"
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
                for name, texts in words.items()
            },
            "on_front": (both, fronts["error"], about("1", "whether no numerical choice dominates it")),
            "on_model_front": (both, fronts["difference"], about("1", "whether no modelling choice dominates it")),
            "tolerance": ("result", np.array(tolerance), about("1", "error that the scene allows")),
            "floor": ("result", floor, about("1", "difference of the finest from one half as fine")),
            "kind": (each, kinds, about("1", "numerical, modelling, film or reference")),
            "seconds": (each, median, about("s", "processor time of the study, median of the rounds")),
            "seconds_low": (each, low, about("s", "processor time of the study, the fastest round")),
            "seconds_high": (each, high, about("s", "processor time of the study, the slowest round")),
            "round_seconds": ((each, "round"), seconds, about("s", "processor time of the study")),
            "evaluations": (each, np.array([r.evaluations for r in records]), about("1", "slices evaluated")),
            "status": (each, np.array([r.status for r in records]), about("1", "what became of the choice")),
        },
        {
            each: (each, np.array([*map(named, owners, labels)]), about("1", "choice")),
            "label": (each, labels, about("1", "departure from the plan")),
            "result": ("result", np.array([named(*pair) for pair in results]), about("1", "result")),
            "result_study": ("result", np.array([study for study, _ in results]), about("1", "study of the result")),
            "round": ("round", np.arange(1, family.rounds + 1), about("1", "round")),
            "study": (each, owners, about("1", "study")),
            **_coordinates(family),
        },
    )  # fmt: skip
    return dataset.assign_attrs(_origin(family, dataset, records, wall_time, resumed))


def _compared(record: Record, reference: Record, name: str) -> tuple[float, str]:
    """Error of a result, relative to the largest value of its curve and the largest over them, or why it has none."""
    if record.status != "done":
        return np.nan, record.status
    (values, status) = record.results[name]
    (known, told) = reference.results[name]
    if np.shape(values) != np.shape(known):
        return np.nan, f"ends after {np.size(values)} of {np.size(known)} instants"
    a = np.array(values)
    b = np.array(known)
    if a.size == 1 and (np.isnan(a).any() or np.isnan(b).any()):
        if np.isnan(a).all() and np.isnan(b).all():
            return np.nan, "none, as the finest"
        return np.nan, (
            f"{a.item():.3%}, where the finest has none ({told})"
            if np.isnan(b).any()
            else f"none ({status}), where the finest has {b.item():.3%}"
        )
    scale = np.abs(b).max(axis=1)
    return float((np.abs(a - b).max(axis=1) / np.where(scale > 0.0, scale, 1.0)).max()), "found"


def _coordinates(family: Family) -> dict[str, Any]:
    """What was chosen, field by field; 0 instants are doubled until the result stands still."""
    found: dict[str, list[Any]] = {}
    for one in family.choices:
        r = one.resolution
        settings = family.studies[one.study]
        own = settings.with_resolution(r).numerical_settings(family.plan.assembly)
        law = family.plan.assembly.traction.full_film.name if r.traction == "named" else r.traction
        row = {
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
            "film": one.scene.models.film.name,
        }
        for name, value in row.items():
            found.setdefault(name, []).append(value)
    units = {"table_tolerance", "integrator_tolerance"}
    return {
        name: (
            "choice",
            np.array(values),
            about("1", name.replace("_", " ") + (", relative" * (name in units))),
        )
        for name, values in found.items()
    }


def _origin(
    family: Family,
    dataset: "xr.Dataset",
    records: Sequence[Record],
    wall_time: float,
    resumed: bool,
) -> dict[str, Any]:
    """Return the attributes: those of the plan, with the models of all choices."""
    told = zip(dataset["choice"].to_numpy(), dataset["status"].to_numpy(), strict=True)
    warned = [f"{name}: {text}" for name, text in told if text != "done"]
    if resumed:
        warned.append(
            "the run was interrupted and gone on with: not all rounds met the same machine"
        )
    warned += implausible(family.plan.scene)
    evaluations = sum(record.evaluations for record in records)
    first = next(iter(family.studies))
    origins = [
        run_origin(made, evaluations, wall_time) | models_origin(made, first)
        for made in _plans(family)
    ]
    return origins[0] | origin(
        warnings=warned,
        plan=family.plan.parts_of(first),
        study="pareto",
        studies=list(family.studies),
        rounds=family.rounds,
        notes=family.notes,
        **together(origins),
    )


def _plans(family: Family) -> Iterator[Plan]:
    """Yield the plan, and it with the models of each choice where they can be had: its status says so."""
    yield family.plan
    for one in family.choices:
        if one.kind in ("modelling", "film"):
            with suppress(Exception):
                yield attrs.evolve(family.plan, assembly=assemble(one.scene, one.resolution))
