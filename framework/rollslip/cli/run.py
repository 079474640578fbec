"""Commands on a scene and its studies: write a scene, run it, print its plan, write a report of stored results."""

import shlex
import shutil
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rollslip.cli.app import (
    BAD_PLUGIN,
    BAD_SCENE,
    FAILED_ON,
    INTERRUPTED,
    NOT_CONVERGED,
    Results,
    complete_models,
    interruptible,
    is_interactive,
    json_option,
    print_json,
    progress,
    results_options,
    scene_argument,
    scene_of,
    set_option,
    study_option,
    verbose_option,
    warn,
)

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.cli.time_limit import TimeLimit
    from rollslip.errors import RollslipError
    from rollslip.planning.plan import Plan
    from rollslip.studies.measured import MeasuredPoints


@click.command()
@click.argument("file", required=False, type=click.Path(path_type=Path))
@click.option(
    "--bearing",
    metavar="NAME",
    shell_complete=complete_models,
    help="Such as NU2210 or 'NJ 312 ECP/C3'; rollslip models bearing lists all.",
)
@click.option(
    "--oil",
    "--lubricant",
    "oil",
    metavar="NAME",
    shell_complete=complete_models,
    help="Such as iso-vg-68; rollslip models oil lists all.",
)
@click.option("--speed", metavar="SPEED", help="Of the inner ring, such as '1500 rpm'.")
@click.option("--load", metavar="LOAD", help="Radial load, such as '2 kN'.")
@click.option("--temperature", metavar="T", help="Of the bearing, such as '70 degC'.")
@click.option("--cage", metavar="OF", help="Material of the cage: brass, steel or polyamide.")
@click.option(
    "--supply",
    metavar="KIND",
    help="Oil supply: bath, splash, circulating, jet, mist or grease.",
)
@click.option("--profile", metavar="SHAPE", help="Of the rollers: logarithmic or none.")
def new(file: Path | None, **given: str | None) -> None:
    """Write a complete commented scene into FILE.

    In a terminal it asks for values without an option. Elsewhere these are assumed, and marked in the scene.
    """
    from rollslip.errors import OutputError, RollslipError
    from rollslip.files import whole_file
    from rollslip.planning.new_scene import MEANING, checked, completed, new_scene
    from rollslip.planning.plausibility import implausible
    from rollslip.results.text import small_load_notes
    from rollslip.scene.reading import parse_scene

    interactive = is_interactive()
    if file is None and not interactive:
        raise click.UsageError(
            "name the file and the bearing: rollslip new my.toml --bearing 'NU 2210'; in a terminal it asks for both"
        )
    file = file or Path(click.prompt("file to write", default="my.toml", err=True))
    path = file if file.suffix == ".toml" else file.with_name(f"{file.name}.toml")
    if path.exists():
        raise OutputError(f"{path}: exists, and is not replaced; name another file")
    if not path.parent.is_dir():
        raise OutputError(f"{path.parent}: there is no such folder; make it, or name another file")

    written = {option: text for option, text in given.items() if text is not None}

    def answer(option: str, text: str) -> str:
        try:
            value = checked(option, text)
        except RollslipError as error:
            raise click.UsageError(str(error)) from None
        written[option] = text
        return value

    def prompt(option: str, default: str) -> str:
        value: str = click.prompt(
            MEANING[option], default=default, value_proc=partial(answer, option), err=True
        )
        return value

    values, missing = completed(written, prompt if interactive else None)
    text = new_scene(str(path), frozenset(() if interactive else missing), **values)
    with whole_file(path) as partial_file:
        partial_file.write_text(text, encoding="utf-8")
    unusual = implausible(parse_scene(text, str(path)))
    warn(unusual)
    click.echo(
        f"written to {path}: " + ", ".join(filter(None, (values[option] for option in MEANING)))
    )
    if missing and not interactive:
        click.echo(
            f"assumed, since no option gives it: {', '.join(missing)}; the scene marks it", err=True
        )
    for note in small_load_notes(unusual):
        click.echo(f"note: {note}")
    scene = shlex.quote(str(path))
    click.echo(f"next: rollslip run {scene} --report; what it will do: rollslip plan {scene}")


def verdicts(_: object, __: object, given: Sequence[str]) -> list[str]:
    """Return the verdicts of an option, several separated by commas, with "skid" for "skids"."""
    known = {
        "slip": "slips",
        "slips": "slips",
        "skid": "skids",
        "skids": "skids",
        "unknown": "unknown",
    }
    names = [name.strip().lower() for text in given for name in text.split(",")]
    if wrong := [name for name in names if name not in known]:
        raise click.BadParameter(
            f"{wrong[0]!r} is not a verdict; there are slips, skids and unknown"
        )
    return [known[name] for name in names]


def note_codes(_: object, __: object, given: Sequence[str]) -> list[str]:
    """Return the codes of notes of an option, several separated by commas; unknown ones are refused."""
    if not given:
        return []
    from rollslip.cli.models import explained

    codes = [code.strip().upper() for text in given for code in text.split(",")]
    for code in codes:
        if "verdict" in explained(code):
            raise click.BadParameter(
                f"{code} is a rule of the verdict; notes have codes such as W11"
            )
    return codes


@click.command()
@scene_argument
@study_option
@set_option
@results_options(resume=True)
@click.option(
    "--measured",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="Table of measured points, csv or xlsx, to compare with; its columns are keys and measured values.",
)
@click.option(
    "--verify",
    is_flag=True,
    help="Run at a finer resolution too, and report whether the error of the plan was as predicted.",
)
@click.option(
    "--fail-on",
    "failing",
    multiple=True,
    metavar="VERDICT",
    callback=verdicts,
    help="End with exit code 6 at slips, unknown or skids; each means those behind it too; several with commas.",
)
@click.option(
    "--ignore",
    "ignored",
    metavar="CODE",
    multiple=True,
    callback=note_codes,
    help="Leave out notes, such as W11,W17.",
)
@click.option(
    "--time-limit",
    metavar="TIME",
    help="Time after which a study is ended, such as '60 s'; what others found is kept.",
)
@click.option("--all", "whole", is_flag=True, help="All rows and assumptions of the answer.")
@verbose_option("All findings, with notes, errors and times.")
@json_option
def run(
    scene: str,
    study: str | None,
    changes: Sequence[str],
    measured: Path | None,
    verify: bool,
    failing: Sequence[str],
    ignored: Sequence[str],
    time_limit: str | None,
    whole: bool,
    verbose: bool,
    results: Results,
) -> None:
    """Run the studies of SCENE, a shipped scene or a file, and write results, plots and on request a report.

    It prints the answer: OK, SLIPS, SKIDS or UNKNOWN, and what that rests on; with -v all that was found.
    """
    from rollslip.cli import console
    from rollslip.cli.time_limit import TimeLimit
    from rollslip.planning.execution import read_measured, studies_of_slip
    from rollslip.planning.plan import plan
    from rollslip.results.dataset import save
    from rollslip.results.verdict import is_as_bad

    limit = TimeLimit(time_limit)
    planned = plan(scene_of(scene, changes), study)
    points = None if measured is None else read_measured(measured, planned.assembly)
    if verbose and not results.as_json:
        click.echo(console.headline(planned))
    _print_cost(planned, verbose)
    results.choose_folder(f"{Path(scene).stem}-results")
    checkpoints = results.checkpoint_folder()
    arguments = [scene, *(f"--set={change}" for change in changes)]
    options = ["--study", study] if study else []
    options += [] if measured is None else ["--measured", str(measured)]
    hint = results.resume_hint(["rollslip", "run", *arguments, *options])
    with interruptible(checkpoints, hint), limit.watch(), results.folder() as folder:
        datasets, failures = _run_studies(planned, checkpoints, verify, limit)
        for name in studies_of_slip(datasets.values()):
            datasets[name] = planned.studies[name].with_bands(planned.scene, datasets[name])
        datasets = _compare(planned, datasets, points)
        for name, dataset in datasets.items():
            save(dataset, folder / f"{name}.nc")
        results.show(datasets, folder, shlex.join(arguments))
    outcomes = {dataset.attrs.get("outcome"): dataset for dataset in datasets.values()}
    if "interrupted" not in outcomes:
        shutil.rmtree(checkpoints, ignore_errors=True)
    verdict = _print_answer(
        planned, datasets, failures, results, shlex.join(arguments), ignored, verbose, whole, verify
    )
    _exit_unless_finished(outcomes, failures, hint)
    if any(is_as_bad(verdict, requested) for requested in failing):
        sys.exit(FAILED_ON)


def _compare(
    planned: "Plan", datasets: "dict[str, xr.Dataset]", points: "MeasuredPoints | None"
) -> "dict[str, xr.Dataset]":
    """Return results compared with measured points, if there are any; without the comparison if it is interrupted."""
    from rollslip.planning.execution import with_measured

    if points is None:
        return datasets
    try:
        with progress("measured points") as show:
            return with_measured(datasets, points, planned.scene, show)
    except KeyboardInterrupt:
        click.echo(
            "interrupted: measured points are not compared; the results are stored", err=True
        )
        return datasets


def _print_cost(planned: "Plan", verbose: bool) -> None:
    """Print the notes on cost and cage of a plan; the answer has the cage among its assumptions."""
    from rollslip.planning.lines import describe_own_cage

    own_cage = describe_own_cage(planned.scene, planned.studies)
    for sentence in planned.cost_sentences:
        if verbose or sentence != own_cage:
            click.echo(f"note: {sentence}", err=True)


def _exit_unless_finished(
    outcomes: "dict[Any, xr.Dataset]", failures: "dict[str, RollslipError]", hint: str
) -> None:
    """Exit with a message where a study was interrupted or has failed."""
    if "interrupted" in outcomes:
        click.echo(hint, err=True)
        sys.exit(INTERRUPTED)
    if "failed" in outcomes:
        failed = outcomes["failed"].attrs
        click.echo(f"failed: {failed['outcome_message']}; what was computed is stored", err=True)
        sys.exit({"model": BAD_PLUGIN, "domain": BAD_SCENE}.get(failed["failed_by"], NOT_CONVERGED))
    for name, failure in failures.items():
        raise type(failure)(f"{name} failed, what others found is stored: {failure}") from failure


def _run_studies(
    planned: "Plan", checkpoints: Path, verify: bool, limit: "TimeLimit"
) -> "tuple[dict[str, xr.Dataset], dict[str, RollslipError]]":
    """Return results and errors of the studies of a plan; raise the first error where there is no result."""
    from rollslip.errors import ConvergenceError, DomainError
    from rollslip.planning.execution import execute
    from rollslip.planning.verification import verify as verified

    datasets = dict[str, Any]()
    failures = dict[str, Any]()
    for name in planned.studies:
        try:
            with progress(name, planned.seconds_of(name)) as show:
                datasets[name] = execute(
                    planned, name, checkpoint_folder=checkpoints, progress=show
                )
        except (DomainError, ConvergenceError) as error:  # other studies may have the answer
            failures[name] = error
            continue
        except KeyboardInterrupt:
            if not limit.is_reached:
                raise
            failures[name] = limit.error()
            break
        if verify and datasets[name].attrs.get("outcome", "finished") == "finished":
            with progress(f"{name} at a finer resolution"):
                datasets[name] = verified(planned, name, datasets[name])
        if datasets[name].attrs.get("outcome") == "interrupted":
            break
    if failures and not datasets:
        raise next(iter(failures.values()))
    return datasets, failures


def _print_answer(
    planned: "Plan",
    datasets: "dict[str, xr.Dataset]",
    failures: "dict[str, RollslipError]",
    results: Results,
    scene: str,
    ignored: Sequence[str],
    verbose: bool,
    whole: bool,
    verify: bool,
) -> str:
    """Print the answer of a run and, if requested, its details; return the verdict in small letters."""
    import attrs

    from rollslip.cli import console
    from rollslip.results.accounts import answer
    from rollslip.results.text import confidence

    found = answer(*datasets.values(), scene=scene, ignored=ignored)
    page = results.target / "report.html"
    found = attrs.evolve(
        found,
        faults=(*found.faults, *(f"{name} failed, see below" for name in failures)),
        next=tuple(
            f"read {page}" if page.exists() and step.endswith(" --report") else step
            for step in found.next
        ),
    )
    if results.as_json:
        print_json(console.run_as_dict(planned, datasets, found) | results.as_dict())
    else:
        console.print_answer(found, whole=whole)
        if verbose:
            notes = "".join(
                f"\n  {note.code} {note.text}; {note.consequence}" for note in found.notes
            )
            click.echo(f"confidence: {confidence(datasets.values())}\nnotes:{notes or ' none'}")
        console.print_results(datasets.values(), whole=verbose, errors=verify)
        results.print_summary(*datasets.values())
    return found.verdict.lower()


@click.command()
@scene_argument
@study_option
@set_option
@click.option(
    "--diff",
    "other",
    metavar="OTHER",
    help="Show only differences from the plan of another scene.",
)
@verbose_option("Every part, with its choice, resolution, error, cost and reason.")
@json_option
def plan(
    scene: str,
    study: str | None,
    changes: Sequence[str],
    other: str | None,
    verbose: bool,
    as_json: bool,
) -> None:
    """Print models and resolution of a run of SCENE, and what is left out; with -v all parts with reasons.

    --set changes SCENE, not OTHER: --set operation.radial_load="9 kN" --diff SCENE shows what that value changes.
    """
    from rollslip.cli import console
    from rollslip.cli.units import with_units
    from rollslip.planning.lines import part_as_dict
    from rollslip.planning.plan import plan

    planned = plan(scene_of(scene, changes), study)
    if other is not None:
        pairs = console.changed(planned, plan(scene_of(other, ()), study))
        if as_json:
            parts = [
                [None if part is None else with_units(part_as_dict(part)) for part in pair]
                for pair in pairs
            ]
            print_json([{"this": first, "other": second} for first, second in parts])
        else:
            console.print_changed(pairs, scene, other)
    elif as_json:
        print_json(with_units(planned.as_dict()))
    else:
        if verbose:
            click.echo(console.headline(planned))
            console.print_plan(planned)
        else:
            console.print_short_plan(planned)
        for sentence in planned.cost_sentences:
            click.echo(f"  {sentence}")
        if not verbose:
            click.echo(
                f"every part with its reason: {shlex.join(['rollslip', 'plan', '-v', scene])}"
            )
            click.echo(console.headline(planned))


@click.command()
@click.argument("results", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="File; by default report.html beside the results.",
)
@click.option("--overwrite", is_flag=True, help="Replace the file, if it is a report.")
def report(results: Sequence[Path], out: Path | None, overwrite: bool) -> None:
    """Write one HTML report from stored RESULTS: .nc files, or folders of them."""
    from rollslip.results.figures import report

    click.echo(f"written to {report(*results, out=out, overwrite=overwrite)}")
