"""Run a plan: its studies one after the other, each result with its warnings and its origin.

1. Run the study at the resolution of the plan. Where a bound on a model that was left out is exceeded, reinstate the
   model and start again.
2. Estimate the error of the result a posteriori.
3. Where it exceeds the tolerance, and a finer run is soon done, refine the resolution and repeat.
4. Add the outputs of laws, the origin, and, if an answer needs them, warnings, validity and errors.
"""

import importlib
import json
import logging
import time
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import attrs

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.resolution import BoundBrokenError
from rollslip.catalogue.discovery import naming_package
from rollslip.errors import RollslipError
from rollslip.planning.lines import describe_resolution
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
from rollslip.studies.bounds import ErrorEstimate
from rollslip.studies.discretisation.error_estimate import estimate_error, refine_resolution
from rollslip.studies.law_outputs import law_outputs
from rollslip.studies.study import settings

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.results.figures import Result
    from rollslip.studies.measured import MeasuredPoints

_log = logging.getLogger(__name__)
#: Part of the discretisation error, a field of a resolution -> attribute of a result, where it is not the part's name.
_ERROR_ATTRIBUTES: Final = {"n_positions": "positions_error"}


def run(scene: Scene | str, study: str | None = None, *, measured: object = None) -> "Result":
    """Run the studies of a scene.

    Parameters
    ----------
    scene : Scene, str or path
        A scene, the name of a shipped one, or a file.
    study : str, optional
        Only this study, one of those that ``rollslip models study`` lists.
    measured : path or pandas.DataFrame, optional
        Table of measured points: keys of the scene, and measured values with their standard uncertainties, such as
        ``cage_slip [%]`` and ``cage_slip_uncertainty [%]``. Answer and figures compare them with values calculated at
        their conditions.

    Returns
    -------
    Result
        The `xarray.Dataset` of the first study. Its attributes have the scene, versions, warnings and citations. It
        shows the ``answer`` of all studies, and has their ``notes``, ``warnings`` and ``figures``; ``studies`` is an
        `xarray.DataTree` of all of them.

    Raises
    ------
    SceneError, PluginError
        If the scene or a model it names cannot be used.
    DomainError, ConvergenceError
        If a law is evaluated outside its domain, or an iteration does not converge.

    Examples
    --------
    >>> result = run("1032930-70C")
    >>> round(float(result.critical_cage_slip.sel(ring="inner")), 2)
    0.5
    """
    from rollslip.results.figures import Result

    planned = plan(scene, study)
    points = None if measured is None else read_measured(measured, planned.assembly)
    executed = dict[str, Executed]()
    for name in planned.studies:
        with progress_in_notebook(name, partial(planned.seconds_of, name)) as show:
            executed[name] = compute(planned, name, progress=show if in_notebook() else None)
        if executed[name].dataset.attrs.get("outcome") == "interrupted":
            break
    return Result.from_studies(
        {name: run.dataset for name, run in executed.items()}, partial(_completed, executed, points)
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
    #: Its discretisation error, estimated a posteriori.
    error: ErrorEstimate
    #: Processor time of the run [s].
    processor_time: float

    def documented(self) -> "xr.Dataset":
        """Return the result with its models, plan, errors, notes and costs, as attributes."""
        model_warnings, checks = warnings(self.plan, self.study, self.dataset)
        numerical = error_warnings(self.plan, self.study, self.error)
        return self.dataset.assign_attrs(
            models_origin(self.plan, self.study),
            plan=json.dumps(self.plan.parts_of(self.study)),
            accuracy=json.dumps(
                accuracy_rows(self.plan, self.study, self.error.total, "a posteriori")
            ),
            warnings=json.dumps([*numerical, *model_warnings]),
            validity=json.dumps(checks),
            cost=json.dumps(
                {"estimated": self.planned.seconds_of(self.study), "actual": self.processor_time}
            ),
        )


def execute(
    plan: Plan,
    study: str,
    *,
    checkpoint_folder: Path | None = None,
    progress: ProgressReporter | None = None,
    fixed_resolution: bool = False,
) -> "xr.Dataset":
    """Return the result of one study of a plan, with all that its answer needs except bands.

    Parameters
    ----------
    plan : Plan
        The plan.
    study : str
        Name of the study.
    checkpoint_folder : Path, optional
        Folder for checkpoints of a long study.
    progress : ProgressReporter, optional
        Shows the progress.
    fixed_resolution : bool
        Whether the resolution of the plan is kept though the error exceeds the tolerance.
    """
    return compute(
        plan,
        study,
        checkpoint_folder=checkpoint_folder,
        progress=progress,
        fixed_resolution=fixed_resolution,
    ).documented()


def compute(
    planned: Plan,
    study: str,
    *,
    checkpoint_folder: Path | None = None,
    progress: ProgressReporter | None = None,
    fixed_resolution: bool = False,
) -> Executed:
    """Return the result of one study of a plan, without what only its answer needs.

    A run is made again on more slices and roller positions where its error is estimated to exceed the tolerance, if
    that helps and is soon done (`rollslip.studies.discretisation.error_estimate.refine_resolution`). The plan in the
    result says so.

    Parameters
    ----------
    planned : Plan
        The plan.
    study : str
        Name of the study.
    checkpoint_folder : Path, optional
        Folder for checkpoints of a long study.
    progress : ProgressReporter, optional
        Shows the progress.
    fixed_resolution : bool
        Whether the resolution of the plan is kept though the error exceeds the tolerance.
    """
    plan = planned
    running = plan.studies[study]
    # importing them takes longer than many studies, and is not part of the cost of the first one
    for library in ("xarray", *running.libraries):
        importlib.import_module(library)
    start = time.perf_counter()
    processor_start = time.process_time()
    first: ErrorEstimate | None = None
    reinstated = list[str]()
    with naming_package("study", running):
        while True:
            plan, dataset, evaluated = _run(plan, study, checkpoint_folder, progress, reinstated)
            choice = plan.choices[study]
            # without the bounds on what is left out, which a reference solution may exceed
            assembly = plan.assembly.at(choice.resolution)
            error = estimate_error(running, assembly, choice, dataset, first)
            if fixed_resolution:
                break
            if (finer := refine_resolution(running, assembly, choice, error)) is None:
                break
            _log.info("%s runs again, finer: it erred by more than its tolerance", study)
            first = first or error
            plan = plan.refined(study, finer)
            if progress is not None:
                progress(
                    f"again, on {describe_resolution(finer.resolution)}",
                    left=plan.seconds_of(study),
                )
        dataset = running.completed(assembly, dataset)
        dataset = dataset.assign(law_outputs(running, assembly, dataset))
    dataset.attrs |= {
        _ERROR_ATTRIBUTES.get(part, f"{part}_error"): max(errors.values())
        for part, errors in error.errors.items()
        if errors
    } | {
        "resolution": json.dumps(attrs.asdict(choice.resolution)),
        "reinstated": json.dumps(reinstated),
    }
    dataset.attrs |= run_origin(plan, evaluated, time.perf_counter() - start)
    return Executed(
        study=study,
        planned=planned,
        plan=plan,
        dataset=dataset,
        error=error,
        processor_time=time.process_time() - processor_start,
    )


def _run(
    plan: Plan,
    study: str,
    checkpoint_folder: Path | None,
    progress: ProgressReporter | None,
    reinstated: list[str],
) -> "tuple[Plan, xr.Dataset, int]":
    """Return the plan with what had to be reinstated, its result, and how many slices were evaluated for it."""
    running = plan.studies[study]
    while True:
        assembly = plan.assemblies[study]
        before = assembly.inner.chain.evaluated
        try:
            store = (
                None
                if checkpoint_folder is None
                else Store(
                    checkpoint_folder, scene_hash(plan.scene) + running.digest(assembly), study
                )
            )
            dataset = running.run(assembly, RunContext(store=store, progress=progress))
            return plan, dataset, assembly.inner.chain.evaluated - before
        except BoundBrokenError as broken:
            reinstated.append(str(broken))
            _log.info("%s starts again: %s", study, broken)
            plan = plan.with_reinstated(study, broken.bound)


def _completed(
    executed: Mapping[str, Executed], points: "MeasuredPoints | None"
) -> dict[str, "xr.Dataset"]:
    """Return documented results of studies, with the bands of those from which an answer takes the slip."""
    results = {name: run.documented() for name, run in executed.items()}
    first = next(iter(results))
    for name in {first, *studies_of_slip(results.values())}:
        plan = executed[name].plan
        results[name] = plan.studies[name].with_bands(plan.scene, results[name])
    return with_measured(results, points, executed[first].plan.scene)


def read_measured(given: object, assembly: Assembly) -> "MeasuredPoints":
    """Return the measured points of a table beside a bearing; all faults of the table are raised in one error.

    Parameters
    ----------
    given : path or pandas.DataFrame
        The table.
    assembly : Assembly
        The bearing.
    """
    from rollslip.studies.measured import read_points
    from rollslip.studies.quantities import quantities

    return read_points(given, quantities(assembly, settings(assembly.scene)), assembly.scene)


def with_measured(
    results: "Mapping[str, xr.Dataset]",
    points: "MeasuredPoints | None",
    scene: Scene,
    report: Callable[[str, float], object] = lambda text, fraction: None,
) -> "dict[str, xr.Dataset]":
    """Return results of a run, of which one has the comparison with measured points as its attribute ``measured``.

    Parameters
    ----------
    results : mapping of str to xarray.Dataset
        Results with bands, by study.
    points : MeasuredPoints or None
        The measured points; None for the results as they are.
    scene : Scene
        The scene of the run.
    report : callable
        Receives the progress: a text, and the fraction that is done.
    """
    if points is None:
        return dict(results)
    studies = [study.name for study, _ in points.quantities.values()]
    target = next((name for name in studies if name in results), next(iter(results)))
    attribute = measured_attribute(points, {"": scene}, {"": results}, report)
    return {**results, target: results[target].assign_attrs(attribute)}


def measured_attribute(
    points: "MeasuredPoints | None",
    scenes: Mapping[str, Scene],
    results: "Mapping[str, Mapping[str, xr.Dataset]]" = MappingProxyType({}),
    report: Callable[[str, float], object] = lambda text, fraction: None,
) -> dict[str, str]:
    """Return the comparison of scenes with measured points as the attribute ``measured``; nothing without points.

    Parameters
    ----------
    points : MeasuredPoints or None
        The measured points.
    scenes : mapping of str to Scene
        Scenes by label; the label of a single one is empty.
    results : mapping of str to mapping
        Results of a scene with bands, by study, as far as they are known, by label.
    report : callable
        Receives the progress: a text, and the fraction that is done of a scene.
    """
    if points is None:
        return {}
    from rollslip.studies.measured import compare_points

    records = list[dict[str, Any]]()
    for label, scene in scenes.items():
        known = results.get(label, {})
        records += compare_points(
            points, scene, partial(_result_with_bands, scene_hash(scene), known), label, report
        )
    return {"measured": json.dumps(records)}


def _result_with_bands(
    hash_of_known: str, known: "Mapping[str, xr.Dataset]", scene: Scene, study: str
) -> "xr.Dataset":
    """Return the result of a study at a scene with bands; that which is known if the scene has the hash of that."""
    if study in known and scene_hash(scene) == hash_of_known:
        return known[study]
    planned = plan(scene, study)
    return planned.studies[study].with_bands(scene, execute(planned, study))


def studies_of_slip(results: "Iterable[xr.Dataset]") -> set[str]:
    """Return the studies from which an answer to results takes the cage slip."""
    return {row.study for row in answer(*results).rows if row.key == "cage_slip" and row.study}


def warnings(plan: Plan, study: str, dataset: "xr.Dataset") -> tuple[list[str], dict[str, Any]]:
    """Return the warnings about the models of a result, and the record of their validity.

    Parameters
    ----------
    plan : Plan
        The plan by which the result was computed.
    study : str
        Name of the study.
    dataset : xarray.Dataset
        The result.

    Returns
    -------
    list of str, dict
        Warnings without full stops; the record of `rollslip.studies.validity.validity_record`.
    """
    running = plan.studies[study]
    assembly = plan.assemblies[study]
    accuracy = plan.scene.accuracy
    messages = list[validity.ValidityMessage]()
    if running.with_cage:
        assembly = assembly.with_resistance()
    try:
        contacts = running.validity_slices(assembly, dataset)
        excesses, difference = validity.check_validity(contacts, assembly, plan.assembly.traction)
        messages = validity.validity_messages(
            excesses, difference, running.validity_state, tolerance=accuracy.tolerance
        )
        texts = validity.warning_texts(messages, accuracy.tolerance)
    except RollslipError as refusal:  # what was computed stands
        excesses = []
        difference = None
        texts = [
            f"whether models are within their range of validity could not be checked: {refusal}"
        ]
    texts += implausible(plan.scene)
    operation = plan.scene.operation
    has_direction = (operation.carrier, operation.gravity_direction) != (None, None)
    is_left_out = running.bearing_loads and not (running.with_weight or has_direction)
    if is_left_out and assembly.weight_fraction > accuracy.tolerance:
        texts.append(
            f"roller weight ({100.0 * assembly.weight_fraction:.2g} % of the mean contact load) is ignored; set "
            "operation.gravity_direction = '0 deg' if the load points down"
        )
    texts += dict.fromkeys(
        note
        for raceway in assembly.raceways
        for note in assembly.lubricant.notes(raceway.conditions.temperature)
    )
    stated: Mapping[str, Any] = plan.scene.study.get(study, {})
    texts += [
        f"study.{study}.{setting} is {getattr(running, setting)!r}, not {stated[setting]!r}, as the scene names it: "
        f"{reason}"
        for setting, reason in plan.choices[study].reasons.items()
        if setting in stated
    ]
    return texts, validity.validity_record(excesses, difference, messages)
