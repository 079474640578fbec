"""The command line: reads options, calls the library, prints, and turns errors into one sentence and an exit code.

Nothing heavy is imported before a command needs it, so that ``--help`` answers at once.
"""

import json
import math
import shlex
import shutil
import signal
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import click

from rollslip.errors import ConvergenceError, PluginError, RollslipError

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.campaigns.sweep.sweep import Sweep
    from rollslip.scene.values import Scene

#: What the shell sees.
OK, BAD_SCENE, NOT_CONVERGED, SOME_FAILED, BAD_PLUGIN, INTERRUPTED = 0, 2, 3, 4, 5, 130

_json = click.option("--json", "as_json", is_flag=True, help="Print JSON instead of text.")
_set = click.option(
    "--set", "changes", metavar="KEY=VALUE", multiple=True, help="Change a value of the scene; may be repeated."
)
_study = click.option("--study", metavar="STUDY", help="Only this study.")


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="rollslip")
def cli() -> None:
    """Slip of rollers and cage in cylindrical roller bearings."""


@cli.command()
@click.argument("scene")
@_study
@_set
@click.option("--out", metavar="DIR", type=click.Path(path_type=Path), help="Folder for the results, new or empty.")
@click.option("--overwrite", is_flag=True, help="Replace what is in the folder.")
@click.option("--resume", is_flag=True, help="Go on with the interrupted run that --out was to take the results of.")
@click.option("--report", is_flag=True, help="Write a report in HTML too.")
@click.option("--no-plots", is_flag=True, help="Write data only.")
@click.option("--verify", is_flag=True, help="Run at the finest too, and tell whether the plan kept its word.")
@_json
def run(
    scene: str,
    study: str | None,
    changes: Sequence[str],
    out: Path | None,
    overwrite: bool,
    resume: bool,
    report: bool,
    no_plots: bool,
    verify: bool,
    as_json: bool,
) -> None:
    """Run the studies of SCENE, a shipped scene or a file, and write results, plots and on request a report."""
    from rollslip.cli import console
    from rollslip.files import whole
    from rollslip.planning.execution import execute
    from rollslip.planning.plan import plan
    from rollslip.planning.verification import verify as verified
    from rollslip.results.dataset import save

    made = plan(_scene(scene, changes), study)
    if not as_json:
        click.echo(console.headline(made))
    target = out if out is not None else _free_folder(f"{Path(scene).stem}-results")
    kept = _kept(target, resume, given=out is not None)
    again = ["rollslip", "run", scene, *(["--study", study] if study else []), *(f"--set={c}" for c in changes)]
    go_on = f"interrupted; go on with: {shlex.join([*again, '--out', str(target), '--resume'])}"
    datasets = {}
    with _interruptible(kept, go_on), whole(target, overwrite=overwrite or resume) as folder:
        for name in made.studies:
            with _progress(name) as progress:
                datasets[name] = execute(made, name, kept=kept, progress=progress)
            if verify and datasets[name].attrs.get("outcome", "finished") == "finished":
                with _progress(f"{name} at the finest"):
                    datasets[name] = verified(made, name, datasets[name])
            save(datasets[name], folder / f"{name}.nc")
            if datasets[name].attrs.get("outcome") == "interrupted":
                break
        files = _shown(datasets, folder, plots=not no_plots, report=report)
    outcomes = {dataset.attrs.get("outcome"): dataset for dataset in datasets.values()}
    if "interrupted" not in outcomes:
        shutil.rmtree(kept, ignore_errors=True)
    if as_json:
        _print_json(console.run_as_dict(made, datasets, target, files))
    else:
        for dataset in datasets.values():
            click.echo(console.findings(dataset))
            click.echo(console.kept(dataset))
        _told(target, files, *datasets.values())
    if "interrupted" in outcomes:
        click.echo(go_on, err=True)
        sys.exit(INTERRUPTED)
    if "failed" in outcomes:
        failed = outcomes["failed"].attrs
        click.echo(f"failed: {failed['outcome_message']}; what was computed is kept", err=True)
        sys.exit({"model": BAD_PLUGIN, "domain": BAD_SCENE}.get(failed["failed_by"], NOT_CONVERGED))


@cli.command()
@click.argument("scene")
@_study
@_set
@click.option("--diff", "other", metavar="OTHER", help="Show only what the plan of another scene has otherwise.")
@_json
def plan(scene: str, study: str | None, changes: Sequence[str], other: str | None, as_json: bool) -> None:
    """Print what will be modelled of SCENE, how finely, what is left out, and why.

    --set changes SCENE, not OTHER: --set operation.radial_load="9 kN" --diff SCENE shows what that value changes.
    """
    from rollslip.cli import console
    from rollslip.planning.plan import changed, part_as_dict, plan

    made = plan(_scene(scene, changes), study)
    if other is not None:
        pairs = changed(made, plan(_scene(other, ()), study))
        if as_json:
            parts = [[None if part is None else part_as_dict(part) for part in pair] for pair in pairs]
            _print_json([{"this": this, "other": that} for this, that in parts])
        else:
            console.print_changed(pairs, scene, other)
    elif as_json:
        _print_json(made.as_dict())
    else:
        click.echo(console.headline(made))
        console.print_plan(made)


@cli.command()
@click.argument("data", metavar="DATA.csv", type=click.Path(path_type=Path))
@click.option("--parameters", metavar="NAME,NAME", required=True, help="What to fit, separated by commas.")
@click.option("--traction", metavar="MODEL", help="Traction model, by default that of the rig file.")
@click.option("--film", metavar="MODEL", help="Film model, by default that of the rig file.")
@click.option(
    "--rig", metavar="RIG.toml", type=click.Path(path_type=Path), help="Rig file, by default rig.toml beside the data."
)
@click.option("--out", metavar="DIR", type=click.Path(path_type=Path), help="Folder for the results, new or empty.")
@click.option("--overwrite", is_flag=True, help="Replace what is in the folder.")
@click.option("--no-plots", is_flag=True, help="Write data and oil only.")
@_json
def fit(
    data: Path,
    parameters: str,
    traction: str | None,
    film: str | None,
    rig: Path | None,
    out: Path | None,
    overwrite: bool,
    no_plots: bool,
    as_json: bool,
) -> None:
    """Fit parameters of oil and traction model to DATA of a traction rig, and write results, plots and an oil."""
    from rollslip.campaigns.fit import findings
    from rollslip.campaigns.fit.fit import fit
    from rollslip.campaigns.fit.oil import write_oil
    from rollslip.cli import console
    from rollslip.files import whole
    from rollslip.results.dataset import save

    target = out if out is not None else _free_folder(f"{data.stem}-fit")
    with whole(target, overwrite=overwrite) as folder:
        with _progress("fit"):
            found = fit(data, parameters=parameters, traction=traction, film=film, rig=rig)
        save(found, folder / "fit.nc")
        write_oil(found, folder / f"{data.stem}.toml")
        files = _shown({"fit": found}, folder, plots=not no_plots, report=False)
    if as_json:
        _print_json(findings.as_dict(found) | {"folder": str(target), "files": files})
        return
    click.echo(findings.headline(found))
    console.print_table(
        ("parameter", "value", "error", "68 %", "95 %", "what the data tell"), findings.parameter_rows(found)
    )
    click.echo("\n".join(findings.notes(found)))
    _told(target, files, found)


@cli.command()
@click.argument("scene")
@click.option("--traction", metavar="A,B", multiple=True, help="Traction models to compare.")
@click.option("--film", metavar="A,B", multiple=True, help="Film models to compare.")
@click.option("--contact", metavar="A,B", multiple=True, help="Contact models to compare.")
@click.option(
    "--reference",
    metavar="NAME",
    help="Traction that the others are held against; NAME,NAME for its film and contact too.",
)
@click.option("--study", metavar="STUDY", help="friction-curve or effective-friction.")
@_set
@click.option("--out", metavar="DIR", type=click.Path(path_type=Path), help="Folder for the results, new or empty.")
@click.option("--overwrite", is_flag=True, help="Replace what is in the folder.")
@click.option("--report", is_flag=True, help="Write a report in HTML too.")
@click.option("--no-plots", is_flag=True, help="Write data only.")
@_json
def compare(
    scene: str,
    traction: Sequence[str],
    film: Sequence[str],
    contact: Sequence[str],
    reference: str | None,
    study: str | None,
    changes: Sequence[str],
    out: Path | None,
    overwrite: bool,
    report: bool,
    no_plots: bool,
    as_json: bool,
) -> None:
    """Run every combination of models on SCENE; compare friction, critical slip and cost.

    A model that is not composed of others takes the place of the hydrodynamic model where the scene's traction is a
    blend, such as lambda-blend, and of the film where the scene's film is a correction, such as inlet-correction; --set
    models.traction=NAME takes the blend out of the scene. What --reference does not name is the first of the
    comparison, and without it that is what the others are held against.
    """
    from rollslip.campaigns.comparison.comparison import plan_comparison, run_comparison
    from rollslip.cli import console
    from rollslip.files import whole
    from rollslip.results.dataset import save

    made = plan_comparison(
        _scene(scene, changes),
        contact=",".join(contact),
        film=",".join(film),
        traction=",".join(traction),
        reference=reference,
        study=study,
    )
    if not as_json:
        click.echo(console.comparison_headline(made))
        console.print_comparison_plan(made)
    target = out if out is not None else _free_folder(f"{Path(scene).stem}-comparison")
    with whole(target, overwrite=overwrite) as folder:
        with _progress("compare"):
            dataset = run_comparison(made)
        save(dataset, folder / "compare.nc")
        files = _shown({"comparison": dataset}, folder, plots=not no_plots, report=report)
    if as_json:
        _print_json(console.comparison_as_dict(dataset, target, files))
    else:
        console.print_found(dataset)
        _told(target, files, dataset)
    if any(dataset["status"] != "done"):
        sys.exit(SOME_FAILED)


@cli.group()
def sweep() -> None:
    """Compute many points of a study: a grid, samples, several models; go on after whatever happens."""


_engine = click.option("--engine", metavar="NAME", help="Where: serial, threads, processes, dask; by default chosen.")
_workers = click.option("--workers", metavar="N", type=click.IntRange(1), help="Points at a time.")
_scheduler = click.option("--scheduler", metavar="ADDRESS", help="Scheduler of engine dask.")
_time_limit = click.option("--time-limit", metavar="TIME", help="Longest time for one point, such as '60 s'.")


@sweep.command("run")
@click.argument("scene")
@click.option(
    "--over",
    "overs",
    metavar="KEY=VALUES",
    multiple=True,
    help="What is varied: A,B,C or LOW:HIGH:COUNT, with units, or LOW:HIGH:COUNT:log; LOW:HIGH for samples.",
)
@click.option("--samples", metavar="N", type=click.IntRange(1), help="Samples of ranges and of what is uncertain.")
@click.option("--sampling", metavar="NAME", help="sobol, replicated-sobol, latin-hypercube, saltelli.")
@click.option("--seed", metavar="N", type=click.IntRange(0), help="Seed of the samples.")
@_study
@click.option("--output", "outputs", metavar="NAME", multiple=True, help="Variable to keep; may be repeated.")
@_set
@_engine
@_workers
@_scheduler
@_time_limit
@click.option("--shard", metavar="I/N", help="Only piece I of N, for job arrays; see merge.")
@click.option("--out", metavar="DIR", type=click.Path(path_type=Path), help="Folder for the sweep, new or empty.")
@_json
def sweep_run(
    scene: str,
    overs: Sequence[str],
    samples: int | None,
    sampling: str | None,
    seed: int | None,
    study: str | None,
    outputs: Sequence[str],
    changes: Sequence[str],
    engine: str | None,
    workers: int | None,
    scheduler: str | None,
    time_limit: str | None,
    shard: str | None,
    out: Path | None,
    as_json: bool,
) -> None:
    """Compute a study of SCENE at many points, and keep everything in a folder."""
    from rollslip.campaigns.sweep import findings as sweep_findings
    from rollslip.campaigns.sweep.folder import begin
    from rollslip.campaigns.sweep.run import asked_engine
    from rollslip.campaigns.sweep.sampling import parse_overs, parse_shard
    from rollslip.campaigns.sweep.sweep import plan_sweep

    made = plan_sweep(
        _scene(scene, changes),
        parse_overs(overs),
        samples=samples,
        sampling=sampling,
        seed=seed,
        study=study,
        output=[name.strip() for text in outputs for name in text.split(",")],
        time_limit=time_limit,
        engine=_engine_table(engine, workers, scheduler),
        shard=parse_shard(shard) if shard is not None else (1, 1),
    )
    asked_engine(made)  # refused before a folder is made
    if not as_json:
        click.echo(sweep_findings.headline(made))
        click.echo("\n".join(f"  {line}" for line in sweep_findings.planned(made)))
    _run_sweep(made, begin(made, out if out is not None else _free_folder(f"{Path(scene).stem}-sweep")), (), as_json)


@sweep.command("resume")
@click.argument("folder", type=click.Path(path_type=Path))
@_engine
@_workers
@_scheduler
@_time_limit
@_json
def sweep_resume(
    folder: Path, engine: str | None, workers: int | None, scheduler: str | None, time_limit: str | None, as_json: bool
) -> None:
    """Compute the points of the sweep in FOLDER that are not done yet."""
    from rollslip.campaigns.sweep.sweep import open_sweep, with_engine

    made = with_engine(open_sweep(folder), _engine_table(engine, workers, scheduler), time_limit)
    _run_sweep(made, folder, (), as_json)


@sweep.command("retry")
@click.argument("folder", type=click.Path(path_type=Path))
@click.option("--failed", is_flag=True, help="All points without a result.")
@click.option("--status", "statuses", metavar="STATUS", multiple=True, help="Those of one status, such as timed-out.")
@_engine
@_workers
@_scheduler
@_time_limit
@_json
def sweep_retry(
    folder: Path,
    failed: bool,
    statuses: Sequence[str],
    engine: str | None,
    workers: int | None,
    scheduler: str | None,
    time_limit: str | None,
    as_json: bool,
) -> None:
    """Compute points of the sweep in FOLDER again that have failed."""
    from rollslip.campaigns.sweep.point import FAILED
    from rollslip.campaigns.sweep.sweep import open_sweep, with_engine

    if failed == bool(statuses):
        raise click.UsageError("name the points to compute again: --failed, or --status of one kind")
    if unknown := sorted(set(statuses) - set(FAILED)):
        raise click.UsageError(f"no point fails as {', '.join(unknown)}; there are: {', '.join(FAILED)}")
    made = with_engine(open_sweep(folder), _engine_table(engine, workers, scheduler), time_limit)
    _run_sweep(made, folder, FAILED if failed else tuple(statuses), as_json)


@sweep.command("status")
@click.argument("folder", type=click.Path(path_type=Path))
@click.option("--errors", metavar="N", default=5, show_default=True, type=click.IntRange(0), help="Last errors shown.")
@_json
def sweep_status(folder: Path, errors: int, as_json: bool) -> None:
    """Show how the sweep in FOLDER stands, also while it runs: points by status, time left, last errors."""
    from rollslip.campaigns.sweep.findings import pieces_line, status_lines
    from rollslip.campaigns.sweep.folder import pieces, status
    from rollslip.campaigns.sweep.sweep import FILE

    parts = [] if (folder / FILE).exists() else [status(piece, errors) for piece in pieces(folder)]
    found = parts or [status(folder, errors)]
    if as_json:
        _print_json(
            {"folder": str(folder), "pieces": [one.as_dict() for one in parts]} if parts else found[0].as_dict()
        )
        return
    if parts:
        click.echo(pieces_line(folder, parts))
    for one in found:
        click.echo("\n".join(status_lines(one)))


@sweep.command("merge")
@click.argument("folders", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--out", metavar="DIR", type=click.Path(path_type=Path), help="Folder for all of it; by default FOLDER.")
@_json
def sweep_merge(folders: Sequence[Path], out: Path | None, as_json: bool) -> None:
    """Put the pieces of a job array together: those in FOLDERS, or the folders shard-I-of-N in one FOLDER."""
    from rollslip.campaigns.sweep.folder import merge, pieces

    if len(folders) == 1 and (parts := pieces(folders[0])):
        folders, out = parts, out if out is not None else folders[0]
    if out is None:
        raise click.UsageError(
            f"{folders[0]} holds no folders shard-I-of-N; of other folders --out says where the pieces are put together"
        )
    _tell_sweep(merge(list(folders), out), out, {}, as_json)


def _engine_table(engine: str | None, workers: int | None, scheduler: str | None) -> dict[str, object] | None:
    """Engine and its parameters as a scene would state them."""
    if scheduler is not None and engine not in (None, "dask"):
        raise click.UsageError(f"--scheduler is of engine dask, not of {engine!r}")
    if engine is None and scheduler is None:
        if workers is not None:
            raise click.UsageError("--workers needs an --engine: threads or processes")
        return None
    name = engine or "dask"
    if workers is not None and name in ("serial", "dask"):
        raise click.UsageError(f"--workers is of engines threads and processes, not of {name!r}")
    parameters = {"count": workers, "scheduler": scheduler}
    return {"model": name} | {key: value for key, value in parameters.items() if value is not None}


def _run_sweep(made: "Sweep", folder: Path, again: Sequence[str], as_json: bool) -> None:
    """Run a sweep in its folder and tell what came of it."""
    import os

    from rollslip.campaigns.sweep.findings import progress
    from rollslip.campaigns.sweep.run import described, run_sweep
    from rollslip.errors import BusyError, EngineError, OutputError

    go_on = f"go on with: {shlex.join(['rollslip', 'sweep', 'resume', str(folder)])}"
    try:
        with _progress("sweep") as show:
            settled = run_sweep(
                made,
                folder,
                again=tuple(again),
                said=lambda text: click.echo(f"  {text}", err=as_json),
                report=lambda now: show(progress(now)),
            )
    except KeyboardInterrupt:
        click.echo(f"interrupted at once; what was done is kept; {go_on}", err=True)
        sys.stdout.flush()
        os._exit(INTERRUPTED)  # a thread that still computes would be waited for
    except BusyError:
        raise
    except (EngineError, OutputError) as error:
        raise type(error)(f"{error}\nwhat was done is kept; {go_on}") from error
    if settled.interrupted:
        click.echo(f"interrupted: {progress(settled.progress)}; {go_on}", err=True)
        sys.exit(INTERRUPTED)
    try:
        _tell_sweep(made, folder, described(settled), as_json)
    except KeyboardInterrupt:
        click.echo(f"interrupted; all points are kept; {go_on}", err=True)
        sys.exit(INTERRUPTED)


def _tell_sweep(made: "Sweep", folder: Path, run: dict[str, object], as_json: bool) -> None:
    """Write the dataset of a sweep and say what is in it."""
    from rollslip.campaigns.sweep import findings as sweep_findings
    from rollslip.campaigns.sweep.folder import RESULT, finish

    dataset = finish(made, folder)
    found = sweep_findings.record(dataset)
    if as_json:
        _print_json(
            {"scene": made.given.source, "sweep_hash": made.hash, "study": made.study, "run": run}
            | found
            | {"folder": str(folder), "files": [RESULT]}
        )
    else:
        click.echo("\n".join(f"  {line}" for line in sweep_findings.sentences(dataset)))
        click.echo(f"written to {folder}: {RESULT}")
    if found["counts"]["ok"] < sum(found["counts"].values()):
        told = shlex.join(["rollslip", "sweep", "status", str(folder)])
        click.echo(f"some points have no result; see: {told}", err=True)
        if found["counts"]["pending"]:
            told = shlex.join(["rollslip", "sweep", "resume", str(folder)])
            click.echo(f"{found['counts']['pending']} of them are not computed yet; go on with: {told}", err=True)
        sys.exit(SOME_FAILED)


@cli.command()
@click.argument("scene")
@_study
@_set
@click.option(
    "--choices", metavar="A,B", multiple=True, help="What may differ, such as slices,instants; by default all there is."
)
@click.option("--traction", metavar="A,B", multiple=True, help="Traction models to choose from.")
@click.option("--film", metavar="A,B", multiple=True, help="Film models to choose from.")
@click.option("--rounds", default=5, show_default=True, help="How often each choice is timed.")
@click.option("--out", metavar="DIR", type=click.Path(path_type=Path), help="Folder for the results, new or empty.")
@click.option("--overwrite", is_flag=True, help="Replace what is in the folder.")
@click.option("--resume", is_flag=True, help="Go on with the interrupted run that --out was to take the results of.")
@click.option("--report", is_flag=True, help="Write a report in HTML too.")
@click.option("--no-plots", is_flag=True, help="Write data only.")
@_json
def pareto(
    scene: str,
    study: str | None,
    changes: Sequence[str],
    choices: Sequence[str],
    traction: Sequence[str],
    film: Sequence[str],
    rounds: int,
    out: Path | None,
    overwrite: bool,
    resume: bool,
    report: bool,
    no_plots: bool,
    as_json: bool,
) -> None:
    """Hold error against cost for the studies of SCENE: a family of choices, and the front that none of them passes.

    What may differ: slices, quadrature, instants, table_tolerance, integrator, integrator_tolerance, compiled (NumPy in
    its place), traction, film, friction. Errors of numerical choices are against the finest of the same models;
    other models differ from the exact one.
    """
    from rollslip.campaigns.pareto.candidates import plan_family
    from rollslip.campaigns.pareto.pareto import run_family
    from rollslip.cli import console
    from rollslip.files import whole
    from rollslip.results.dataset import save

    made = plan_family(
        _scene(scene, changes),
        study=study,
        choices=",".join(choices),
        traction=",".join(traction),
        film=",".join(film),
        rounds=rounds,
    )
    if not as_json:
        click.echo(console.headline(made.plan))
        console.print_family(made)
    target = out if out is not None else _free_folder(f"{Path(scene).stem}-pareto")
    kept = _kept(target, resume, given=out is not None)
    given = {"choices": choices, "traction": traction, "film": film, "set": changes}
    again = ["rollslip", "pareto", scene, *(["--study", study] if study else [])]
    again += [f"--{name}={value}" for name, values in given.items() for value in values]
    go_on = f"interrupted; go on with: {shlex.join([*again, f'--rounds={rounds}', '--out', str(target), '--resume'])}"
    with _interruptible(kept, go_on), whole(target, overwrite=overwrite or resume) as folder:
        with _bar("pareto") as progress:
            dataset = run_family(made, kept, progress)
        save(dataset, folder / "pareto.nc")
        files = _shown({"pareto": dataset}, folder, plots=not no_plots, report=report)
    shutil.rmtree(kept, ignore_errors=True)
    if as_json:
        _print_json(console.fronts_as_dict(dataset, target, files))
    else:
        console.print_found(dataset)
        _told(target, files, dataset)
    if any(dataset["status"] != "done"):
        sys.exit(SOME_FAILED)


@cli.command()
@click.argument("what", required=False, metavar="[KIND|NAME]")
@_json
def models(what: str | None, as_json: bool) -> None:
    """List all models, those of one KIND, or show everything about the model called NAME."""
    from rollslip.cli import console

    if as_json:
        _print_json(console.models_as_dict(what))
    else:
        console.print_models(what)


@cli.command()
@click.argument("target", required=False, metavar="[SCENE|RESULT.nc]")
@_set
@_json
def info(target: str | None, changes: Sequence[str], as_json: bool) -> None:
    """Show what follows from a SCENE without running it, what a RESULT holds, or this installation."""
    from rollslip.cli import console

    if target is None:
        rows = console.installation()
    elif target.endswith(".nc"):
        if changes:
            raise click.UsageError("--set changes a scene; a result cannot be changed")
        rows = console.result_info(Path(target))
    else:
        rows = console.scene_info(_scene(target, changes))
    if as_json:
        _print_json({section: dict(values) for section, values in rows.items()})
    else:
        console.print_sections(rows)


@cli.command()
@click.argument("target", metavar="SCENE|RESULT.nc")
@_set
@_json
def cite(target: str, changes: Sequence[str], as_json: bool) -> None:
    """Print what to cite for the models and the oil of a SCENE or a RESULT."""
    from rollslip.planning.plan import plan
    from rollslip.results.dataset import citations, open_result

    if target.endswith(".nc"):
        if changes:
            raise click.UsageError("--set changes a scene; a result cannot be changed")
        texts = json.loads(open_result(target).attrs["citations"])
    else:
        texts = citations(plan(_scene(target, changes)))
    if as_json:
        _print_json(texts)
    else:
        click.echo("\n".join(texts))


@cli.command()
@_json
def doctor(as_json: bool) -> None:
    """Say whether this installation is healthy, and what to do where it is not; exit code 5 if there is a fault."""
    from rollslip.cli.doctor import as_text, examine, healthy

    found = examine()
    if as_json:
        import attrs

        _print_json([attrs.asdict(finding) for finding in found])
    else:
        click.echo(as_text(found))
    if not healthy(found):
        sys.exit(BAD_PLUGIN)


@cli.command()
@click.argument("scene")
@click.option("--samples", metavar="N", type=click.IntRange(2), help="Samples of the critical slip.  [default: 1024]")
@click.option("--until", metavar="H", type=float, help="Double samples until the interval's half width is H, a slip.")
@click.option("--probability", metavar="P", type=float, default=0.99, show_default=True, help="Of the allowable slip.")
@click.option("--steady", metavar="N", type=click.IntRange(0), help="Samples of the steady slip.  [default: 512]")
@click.option("--indices", metavar="N", type=click.IntRange(0), default=0, help="Rows for Sobol indices, 2^k.")
@click.option("--steady-indices", metavar="N", type=click.IntRange(0), default=0, help="Likewise of the steady slip.")
@click.option("--seed", metavar="N", type=click.IntRange(0), default=0, help="Seed of the samples.")
@_set
@_engine
@_workers
@_scheduler
@_time_limit
@click.option("--out", metavar="DIR", type=click.Path(path_type=Path), help="Folder; goes on with what is in it.")
@click.option("--report", is_flag=True, help="Write a report in HTML too.")
@click.option("--no-plots", is_flag=True, help="Write data only.")
@_json
def uncertainty(
    scene: str,
    samples: int | None,
    until: float | None,
    probability: float,
    steady: int | None,
    indices: int,
    steady_indices: int,
    seed: int,
    changes: Sequence[str],
    engine: str | None,
    workers: int | None,
    scheduler: str | None,
    time_limit: str | None,
    out: Path | None,
    report: bool,
    no_plots: bool,
    as_json: bool,
) -> None:
    """Tell the allowable slip of SCENE and the margin to it, where its data scatter.

    What scatters is in the scene's table [uncertainty]; without one it is the scatter that its oil comes with.
    """
    from rollslip.campaigns.sweep import findings as sweep_findings
    from rollslip.campaigns.sweep.run import asked_engine
    from rollslip.campaigns.uncertainty import findings as uncertainty_findings
    from rollslip.campaigns.uncertainty.margin import expected_seconds, plan_margin, run_margin
    from rollslip.errors import EngineError

    made = plan_margin(
        _scene(scene, changes),
        samples=samples,
        until=until,
        probability=probability,
        steady=steady,
        indices=indices,
        steady_indices=steady_indices,
        seed=seed,
        engine=_engine_table(engine, workers, scheduler),
        time_limit=time_limit,
    )
    asked_engine(made.critical)  # refused before a folder is made
    target = out if out is not None else _free_folder(f"{Path(scene).stem}-uncertainty")
    if not as_json:
        click.echo(sweep_findings.headline(made.critical))
        sweeps = made.sweeps.values()
        click.echo("\n".join(dict.fromkeys(f"  {line}" for one in sweeps for line in sweep_findings.planned(one))))
        for name, seconds in expected_seconds(made).items():
            click.echo(f"  {name}: about {sweep_findings.duration(seconds)} of one core")
    go_on = f"go on by the same command with --out {shlex.quote(str(target))}"
    try:
        with _progress("uncertainty") as show:
            dataset = run_margin(
                made,
                target,
                said=lambda text: click.echo(f"  {text}", err=as_json),
                report=lambda now: show(sweep_findings.progress(now)),
            )
    except KeyboardInterrupt:
        click.echo(f"interrupted; what was done is kept; {go_on}", err=True)
        sys.exit(INTERRUPTED)
    except EngineError as error:
        raise EngineError(f"{error}\nwhat was done is kept; {go_on}") from error
    files = _shown({"uncertainty": dataset}, target, plots=not no_plots, report=report)
    if as_json:
        _print_json(
            {"scene": made.critical.given.source}
            | uncertainty_findings.record(dataset)
            | {"warnings": json.loads(dataset.attrs["warnings"]), "folder": str(target), "files": files}
        )
    else:
        click.echo("\n".join(f"  {line}" for line in uncertainty_findings.sentences(dataset)))
        _told(target, files, dataset)
    if uncertainty_findings.failed(dataset):
        sys.exit(SOME_FAILED)


@cli.group()
def plugins() -> None:
    """List, check and start packages that offer models."""


@plugins.command("list")
@click.option("--requirements", is_flag=True, help="Print lines for pip install -r instead.")
@_json
def plugins_list(requirements: bool, as_json: bool) -> None:
    """List the installed packages that offer models, with their state."""
    from rollslip.catalogue import packages as inventory

    if requirements:
        lines = inventory.requirements()
        if as_json:
            _print_json(lines)
        else:
            click.echo("\n".join(lines))
    elif as_json:
        _print_json(inventory.as_dicts(inventory.packages()))
    else:
        click.echo(inventory.as_text(inventory.packages()))


@plugins.command("check")
@click.argument("name")
@click.option("--kind", metavar="KIND", help="Only the model of this kind, where several have the name.")
@click.option("--time-limit", default=120.0, show_default=True, help="Seconds that a check may take.")
@_json
def plugins_check(name: str, kind: str | None, time_limit: float, as_json: bool) -> None:
    """Check the model called NAME by the rules of its kind, in a process of its own."""
    from rollslip import testing
    from rollslip.cli.console import kinds_of
    from rollslip.testing.findings import passed

    findings = [
        finding
        for one in ([kind] if kind is not None else kinds_of(name))
        for finding in testing.check_in_subprocess(one, name, time_limit)
    ]
    if as_json:
        _print_json(testing.as_dict(findings))
    else:
        click.echo(testing.format_findings(findings))
    if not passed(findings):
        sys.exit(BAD_PLUGIN)


@plugins.command("new")
@click.argument("name")
@click.option("--kind", required=True, metavar="KIND", help="What it offers: traction, film, contact ...")
@click.option("--compiled", is_flag=True, help="With a compiled form in Cython.")
def plugins_new(name: str, kind: str, compiled: bool) -> None:
    """Write a complete, tested package called NAME into a new folder."""
    from rollslip.catalogue.scaffold import new

    click.echo(f"written to {new(name, kind, compiled, Path.cwd())}; its README says what comes next")


@cli.command()
@_json
def schema(as_json: bool) -> None:
    """List every key of a scene with unit, default and meaning."""
    from rollslip.cli import console
    from rollslip.scene.reading import schema

    rows = schema()
    if as_json:
        _print_json([row._asdict() for row in rows])
    else:
        console.print_table(("key", "unit", "default", "meaning"), [tuple(map(str, row)) for row in rows])


@cli.command()
@click.argument("results", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--out", default="report.html", show_default=True, type=click.Path(path_type=Path), help="File.")
@click.option("--overwrite", is_flag=True, help="Replace the file.")
def report(results: Sequence[Path], out: Path, overwrite: bool) -> None:
    """Write one HTML report from stored RESULTS (.nc files)."""
    import tempfile

    from rollslip.errors import OutputError
    from rollslip.files import whole_file
    from rollslip.results.dataset import open_result
    from rollslip.results.figures import plot
    from rollslip.results.report import write_report

    if out.exists() and not overwrite:
        raise OutputError(f"{out}: exists; name another --out, or --overwrite it")
    datasets = {}
    for path in results:
        dataset = open_result(path)
        datasets[dataset.attrs["study"] if dataset.attrs["study"] not in datasets else str(path)] = dataset
    with tempfile.TemporaryDirectory() as folder, whole_file(out) as partial:
        figures = {}
        for k, (name, dataset) in enumerate(datasets.items()):
            place = Path(folder) / str(k)
            place.mkdir()
            figures[name] = plot(dataset, place)
        write_report(datasets, figures, partial)
    click.echo(f"written to {out}")


def _scene(name: str, changes: Sequence[str]) -> "Scene":
    from rollslip.scene.reading import evolve, load_scene, parse_set

    scene = load_scene(name)
    return evolve(scene, dict(map(parse_set, changes))) if changes else scene


def _shown(datasets: "Mapping[str, xr.Dataset]", folder: Path, *, plots: bool, report: bool) -> list[str]:
    """Draw results into the folder that they are stored in, with a report if asked for; return the files there."""
    figures: dict[str, list[Path]] = {name: [] for name in datasets}
    if report or plots:
        from rollslip.results.figures import plot

        with _progress("plots"):
            figures = {name: plot(dataset, folder) for name, dataset in datasets.items()}
    if report:
        from rollslip.results.report import write_report

        write_report(datasets, figures, folder / "report.html")
    return sorted(path.name for path in folder.iterdir() if path.is_file())


def _told(target: Path, files: Sequence[str], *datasets: "xr.Dataset") -> None:
    """Print the warnings of results, each once, and where everything was written to."""
    for warning in dict.fromkeys(text for dataset in datasets for text in json.loads(dataset.attrs["warnings"])):
        click.echo(f"warning: {warning}", err=True)
    click.echo(f"written to {target}: {', '.join(files)}")


def _free_folder(name: str) -> Path:
    """First of NAME, NAME-2, NAME-3 ... that does not exist, so that no run touches another's results."""
    path, count = Path(name), 1
    while path.exists() or path.with_name(f"{path.name}.unfinished").exists():
        count += 1
        path = Path(f"{name}-{count}")
    return path


def _kept(target: Path, resume: bool, *, given: bool) -> Path:
    """Folder in which runs in time leave what they have computed, until they end."""
    target = target.resolve()
    kept = target.parent / f"{target.name}.unfinished"
    if resume and not (given and kept.is_dir()):
        raise click.UsageError(
            f"there is no interrupted run to go on with in {kept}" if given else "--resume needs the --out of the run"
        )
    if kept.exists() and not resume:
        raise click.UsageError(f"{kept} holds an interrupted run: go on with it by --resume, or remove it")
    return kept


@contextmanager
def _interruptible(kept: Path, go_on: str) -> Iterator[None]:
    """Say how to go on with a long run, where it was interrupted while something else was done with it."""
    try:
        yield
    except KeyboardInterrupt:
        if not kept.is_dir():
            raise
        click.echo(go_on, err=True)
        sys.exit(INTERRUPTED)


@contextmanager
def _progress(what: str) -> Iterator[Callable[[str], None]]:
    """Show what is going on: on a terminal all the time, else a line every half a minute."""
    if not sys.stderr.isatty():
        said = time.monotonic()

        def line(text: str) -> None:
            nonlocal said
            if time.monotonic() - said >= 30.0:
                said = time.monotonic()
                click.echo(f"{what}: {text}", err=True)

        yield line
        return
    from rich.console import Console

    with Console(stderr=True).status(what) as status:
        yield lambda text: status.update(f"{what}: {text}")


@contextmanager
def _bar(what: str) -> Iterator[Callable[[float, float, str], None]]:
    """Show how far a run of many parts is and how long it will take: a bar on a terminal, else as `_progress` does."""

    def left(seconds: float) -> str:
        return "" if math.isnan(seconds) else f", {seconds // 60:.0f} min {seconds % 60:02.0f} s left"

    if not sys.stderr.isatty():
        with _progress(what) as say:
            yield lambda share, seconds, text: say(f"{share:.0%}{left(seconds)}, {text}")
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn

    columns = TextColumn("{task.percentage:3.0f} %"), BarColumn(), TextColumn("{task.description}", markup=False)
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(what, total=1.0)
        yield lambda share, seconds, text: bar.update(task, completed=share, description=f"{text}{left(seconds)}")


def _print_json(value: object) -> None:
    click.echo(json.dumps(value, indent=2, allow_nan=False))


def _terminated(*_: object) -> NoReturn:
    raise SystemExit(128 + signal.SIGTERM)


def main(arguments: Sequence[str] | None = None) -> Any:
    """Run the command line and leave with its exit code."""
    signal.signal(signal.SIGTERM, _terminated)  # so that half-written results are removed
    try:
        cli.main(args=arguments, standalone_mode=False, prog_name="rollslip")
    except (KeyboardInterrupt, click.Abort):
        click.echo("interrupted; nothing was left behind", err=True)
        sys.exit(INTERRUPTED)
    except click.ClickException as error:
        error.show()
        sys.exit(error.exit_code)
    except RollslipError as error:
        click.echo(str(error), err=True)
        sys.exit(
            BAD_PLUGIN
            if isinstance(error, PluginError)
            else NOT_CONVERGED
            if isinstance(error, ConvergenceError)
            else BAD_SCENE
        )
    except ImportError as error:
        if error.name != "ROLLSLIP_SIMD":
            raise
        click.echo(str(error), err=True)
        sys.exit(BAD_SCENE)
    except BrokenPipeError:
        sys.stderr.close()  # the reader of our output has left; there is nobody to tell
        sys.exit(OK)
    except Exception as error:
        notes = [note for note in getattr(error, "__notes__", ()) if note.startswith("raised by ")]
        if not notes:
            raise
        click.echo(f"{type(error).__name__}: {error}; {notes[0]}", err=True)  # somebody's model, not a fault of ours
        sys.exit(BAD_PLUGIN)
    sys.exit(OK)
