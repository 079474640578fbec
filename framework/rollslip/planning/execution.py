"""Run a plan: its studies one after the other, each result with its warnings and its origin."""

import importlib
import json
import logging
import time
from collections.abc import Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from rollslip.bearing.resolution import BoundBrokenError
from rollslip.errors import RollslipError
from rollslip.planning.lines import how_finely
from rollslip.planning.plan import Plan, plan
from rollslip.planning.plausibility import implausible
from rollslip.planning.progress import ProgressReporter, in_notebook, progress_in_notebook
from rollslip.planning.provenance import models_origin, run_origin
from rollslip.planning.verification import accuracy_rows, error_warnings
from rollslip.results.accounts import answer
from rollslip.scene.values import Scene
from rollslip.structure import scene_hash
from rollslip.studies import validity
from rollslip.studies.answers import RunContext, Store
from rollslip.studies.error_estimate import ErrorEstimate, estimate_error, refine_resolution
from rollslip.studies.law_outputs import law_outputs

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.results.figures import Result

_log = logging.getLogger(__name__)


def run(scene: Scene | str, study: str | None = None) -> "Result":
    """Run the studies of a scene.

    Parameters
    ----------
    scene : Scene, str or path
        A scene, the name of a shipped one, or a file.
    study : str, optional
        Only this one, as ``rollslip models study`` lists them.

    Returns
    -------
    Result
        The `xarray.Dataset` of the first study, see there; its attributes hold scene, versions, warnings and citations.
        It shows the ``answer`` of all studies, and has their ``notes``, ``warnings`` and ``figures``; ``studies``, an
        `xarray.DataTree`, holds each of them.

    Raises
    ------
    SceneError, PluginError
        If the scene or a model it names cannot be used.
    DomainError, ConvergenceError
        If a law is asked where it is not defined, or an iteration does not end.

    Examples
    --------
    >>> result = run("1032930-70C")
    >>> round(float(result.critical_cage_slip.sel(ring="inner")), 2)
    0.5
    """
    from rollslip.results.figures import Result

    planned = plan(scene, study)
    executed = dict[str, Executed]()
    for name in planned.studies:
        with progress_in_notebook(name, partial(planned.seconds_of, name)) as show:
            executed[name] = compute(planned, name, progress=show if in_notebook() else None)
        if executed[name].dataset.attrs.get("outcome") == "interrupted":
            break
    return Result.of(
        {name: one.dataset for name, one in executed.items()}, partial(_completed, executed)
    )


@attrs.frozen(kw_only=True, eq=False)
class Executed:
    """A study that ran: its result, and the plans by which it was computed."""

    study: str
    #: The plan before the run, whose cost was estimated.
    planned: Plan
    #: The plan with the resolution of the result.
    plan: Plan
    #: The result with its origin.
    dataset: "xr.Dataset"
    #: What it leaves, estimated a posteriori.
    error: ErrorEstimate
    #: Processor time that it took [s].
    processor_time: float

    def documented(self) -> "xr.Dataset":
        """Return the result with its models, plan, errors, notes and costs, as attributes."""
        found, judged = warnings(self.plan, self.study, self.dataset)
        rows = accuracy_rows(self.plan, self.study, self.error.total, "a posteriori")
        cost = {"estimated": self.planned.seconds_of(self.study), "actual": self.processor_time}
        return self.dataset.assign_attrs(
            models_origin(self.plan, self.study),
            plan=json.dumps(self.plan.parts_of(self.study)),
            accuracy=json.dumps(rows),
            warnings=json.dumps([*error_warnings(self.plan, self.study, self.error), *found]),
            validity=json.dumps(judged),
            cost=json.dumps(cost),
        )


def execute(
    plan: Plan,
    study: str,
    *,
    kept: Path | None = None,
    progress: ProgressReporter | None = None,
    fixed_resolution: bool = False,
) -> "xr.Dataset":
    """Return the result of one study of a plan, with all that its answer rests on but bands: see `compute`."""
    return compute(
        plan, study, kept=kept, progress=progress, fixed_resolution=fixed_resolution
    ).documented()


def compute(
    planned: Plan,
    study: str,
    *,
    kept: Path | None = None,
    progress: ProgressReporter | None = None,
    fixed_resolution: bool = False,
) -> Executed:
    """Return the result of one study of a plan, with nothing that only a reader of its answer needs.

    A run is made again on more slices and roller positions where its error is estimated to exceed the tolerance, if it
    is soon done and would help (`rollslip.studies.error_estimate.refined`); the plan in the result says so.
    """
    plan = planned
    running = plan.studies[study]
    for library in (
        "xarray",
        *running.libraries,
    ):  # what takes longer than many a study is no cost of the first one
        importlib.import_module(library)
    begin = time.perf_counter()
    processor = time.process_time()
    first: ErrorEstimate | None = None
    reinstated = list[str]()
    while True:
        plan, dataset, evaluated = _run(plan, study, kept, progress, reinstated)
        estimated = plan.choices[study]
        unwatched = plan.assembly.at(estimated.resolution)
        error = estimate_error(running, unwatched, estimated, dataset, first)
        if (
            fixed_resolution
            or (finer := refine_resolution(running, unwatched, estimated, error)) is None
        ):
            break
        _log.info("%s runs again, finer: it was off by more than its tolerance", study)
        first = first or error
        plan = plan.again(study, finer)
        if progress is not None:
            progress(f"again, on {how_finely(finer.resolution)}", left=plan.seconds_of(study))
    dataset = dataset.assign(law_outputs(running, unwatched, dataset))
    dataset.attrs |= {
        f"{part}_error": max(found.values()) for part, found in error.errors.items() if found
    }
    dataset.attrs |= {
        "resolution": json.dumps(attrs.asdict(estimated.resolution)),
        "reinstated": json.dumps(reinstated),
    }
    processor_time = time.process_time() - processor
    dataset.attrs |= run_origin(plan, evaluated, time.perf_counter() - begin)
    return Executed(
        study=study,
        planned=planned,
        plan=plan,
        dataset=dataset,
        error=error,
        processor_time=processor_time,
    )


def _run(
    plan: Plan,
    study: str,
    kept: Path | None,
    progress: ProgressReporter | None,
    reinstated: list[str],
) -> "tuple[Plan, xr.Dataset, int]":
    """Return a plan, its result, and how many slices were evaluated for it; what is needed after all is taken back."""
    running = plan.studies[study]
    while True:
        assembly = plan.assemblies[study]
        before = assembly.inner.chain.evaluated
        try:
            store = (
                None
                if kept is None
                else Store(kept, scene_hash(plan.scene) + running.digest(assembly), study)
            )
            dataset = running.run(assembly, RunContext(store=store, progress=progress))
            return plan, dataset, assembly.inner.chain.evaluated - before
        except BoundBrokenError as broken:
            reinstated.append(str(broken))
            _log.info("%s begins again: %s", study, broken)
            plan = plan.with_reinstated(study, broken.bound)


def _completed(executed: Mapping[str, Executed]) -> dict[str, "xr.Dataset"]:
    """Return documented results of studies, with the bands of those that an answer takes its slip from."""
    found = {name: one.documented() for name, one in executed.items()}
    first = next(iter(found))
    for name in {first, *studies_of_slip(found.values())}:
        found[name] = (
            executed[name].plan.studies[name].with_bands(executed[name].plan.scene, found[name])
        )
    return found


def studies_of_slip(results: "Iterable[xr.Dataset]") -> set[str]:
    """Return the studies from which an answer to results takes the cage slip."""
    return {row.by for row in answer(*results).rows if row.key == "cage_slip" and row.by}


def warnings(plan: Plan, study: str, dataset: "xr.Dataset") -> tuple[list[str], dict[str, Any]]:
    """Return in words where the models were used outside what they were made for and what a reader must know.

    The second is what models were made for and how far that was left, as plain values (`rollslip.studies.validity`).
    """
    running = plan.studies[study]
    assembly = plan.assemblies[study]
    accuracy = plan.scene.accuracy
    said = list[validity.ValidityMessage]()
    assembly = assembly.with_resistance() if running.with_cage else assembly
    try:
        contacts = running.validity_slices(assembly, dataset)
        outside, off = validity.check_validity(contacts, assembly, plan.assembly.traction)
        said = validity.validity_messages(
            outside, off, running.validity_state, tolerance=accuracy.tolerance
        )
        found = validity.warning_texts(said, accuracy.tolerance)
    except RollslipError as refusal:  # what was computed stands
        outside = []
        off = None
        found = [
            f"whether models are within their range of validity could not be checked: {refusal}"
        ]
    found += implausible(plan.scene)
    o = plan.scene.operation
    fraction = assembly.weight_fraction
    weighed = (
        running.with_weight
        or not running.bearing_loads
        or (o.carrier, o.gravity_direction) != (None, None)
    )
    if fraction > accuracy.tolerance and not weighed:
        found.append(
            f"the weight of the rollers, {100.0 * fraction:.2g} % of what presses them on average, is left out, as "
            "its direction is not stated; give operation.gravity_direction, 0 deg where the load is itself a weight"
        )
    found += validity.starvation_notes(assembly.film)
    temperatures = dict.fromkeys(raceway.conditions.temperature for raceway in assembly.raceways)
    found += dict.fromkeys(note for T in temperatures for note in assembly.lubricant.notes(T))
    given: Mapping[str, Any] = plan.scene.study.get(study, {})
    found += [
        f"study.{study}.{setting} is {getattr(running, setting)!r}, not {given[setting]!r}, as the scene names it: "
        f"{reason}"
        for setting, reason in plan.choices[study].reasons.items()
        if setting in given
    ]
    if (
        accuracy.slices is not None
        and (error := dataset.attrs.get("slices_error", 0.0)) > accuracy.tolerance
    ):
        found.append(
            f"{plan.choices[study].resolution.slices} slices leave a relative error of about {error:.1e}, more than "
            f"accuracy.tolerance = {accuracy.tolerance:g}; raise accuracy.slices, or let a plan choose by --set "
            "accuracy.slices=auto"
        )
    return found, validity.validity_record(outside, off, said)
