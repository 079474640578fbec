"""The commands `rollslip sweep`: run, resume, retry and status; what they print before and meanwhile."""

import json
import shlex
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rollslip.cli.app import (
    INTERRUPTED,
    SOME_FAILED,
    Results,
    engine_options,
    json_option,
    print_either,
    print_json,
    progress,
    results_options,
    warn,
)
from rollslip.cli.campaign import with_settings
from rollslip_campaigns.sweep import SweepSettings

if TYPE_CHECKING:
    from rollslip_campaigns.sweep.definition import Sweep
    from rollslip_campaigns.sweep.folder import Status
    from rollslip_campaigns.sweep.run import Progress


class _Steps(click.Group):
    """The commands of a sweep; a scene in the place of one is told from a mistyped one."""

    def resolve_command(self, ctx: click.Context, args: list[str]) -> Any:
        """Find the command, or say that one is missing before the scene."""
        from rollslip.scene.reading import shipped_scenes

        if self.get_command(ctx, args[0]) is None and (
            Path(args[0]).suffix == ".toml" or args[0] in shipped_scenes()
        ):
            raise click.UsageError(
                f"{args[0]} is a scene; write: rollslip sweep run {shlex.join(args)}", ctx
            )
        return super().resolve_command(ctx, args)


sweep = _Steps("sweep", help=SweepSettings.summary)


@results_options("Folder for the sweep, new or empty.", overwrite=False)
@json_option
def _sweep_run(requested: SweepSettings, about: str, results: Results) -> None:
    from rollslip_campaigns.sweep.folder import begin

    made = requested.plan()
    warn(made.unusual)
    if not results.as_json:
        click.echo("\n".join(made.told))
    results.go_to(requested.place(made, about))
    _run_sweep(made, begin(made, results.target), (), results)


sweep.command("run")(with_settings(SweepSettings, _sweep_run))


@sweep.command("resume")
@click.argument("folder", type=click.Path(path_type=Path))
@engine_options
@results_options(out=False, overwrite=False)
@json_option
def sweep_resume(
    folder: Path, engine: Mapping[str, object] | None, time_limit: str | None, results: Results
) -> None:
    """Compute the points of the sweep in FOLDER that are not done yet."""
    from rollslip_campaigns.sweep.sweep import open_sweep, with_engine

    made = with_engine(open_sweep(folder), engine, time_limit)
    _run_sweep(made, folder, (), results)


@sweep.command("retry")
@click.argument("folder", type=click.Path(path_type=Path))
@click.option("--failed", is_flag=True, help="All points without a result.")
@click.option(
    "--status",
    "statuses",
    metavar="STATUS",
    multiple=True,
    help="Those of one status, such as timed-out.",
)
@engine_options
@results_options(out=False, overwrite=False)
@json_option
def sweep_retry(
    folder: Path,
    failed: bool,
    statuses: Sequence[str],
    engine: Mapping[str, object] | None,
    time_limit: str | None,
    results: Results,
) -> None:
    """Compute points of the sweep in FOLDER again that have failed."""
    from rollslip_campaigns.sweep.journal import FAILED
    from rollslip_campaigns.sweep.sweep import open_sweep, with_engine

    if failed == bool(statuses):
        raise click.UsageError(
            "name the points to compute again: --failed, or --status of one kind"
        )
    if unknown := sorted(set(statuses) - set(FAILED)):
        raise click.UsageError(
            f"no point fails as {', '.join(unknown)}; there are: {', '.join(FAILED)}"
        )
    made = with_engine(open_sweep(folder), engine, time_limit)
    _run_sweep(made, folder, FAILED if failed else tuple(statuses), results)


@sweep.command("status")
@click.argument("folder", type=click.Path(path_type=Path))
@click.option(
    "--errors",
    metavar="N",
    default=5,
    show_default=True,
    type=click.IntRange(0),
    help="Last errors shown.",
)
@json_option
def sweep_status(folder: Path, errors: int, as_json: bool) -> None:
    """Show how the sweep in FOLDER stands, also while it runs: points by status, time left, last errors."""
    from rollslip.cli.units import with_units
    from rollslip_campaigns.sweep.folder import status

    found = status(folder, errors)
    print_either(as_json, with_units(found.as_dict()), "\n".join(sweep_standing(found)))


def _run_sweep(made: "Sweep", folder: Path, again: Sequence[str], results: Results) -> None:
    """Run a sweep in its folder and tell what came of it."""
    import os

    from rollslip.errors import BusyError, EngineError, OutputError
    from rollslip_campaigns.sweep.run import described, run_sweep

    go_on = f"go on with: {shlex.join(['rollslip', 'sweep', 'resume', str(folder)])}"
    try:
        with progress("sweep") as show:
            settled = run_sweep(
                made,
                folder,
                again=tuple(again),
                said=lambda text: click.echo(f"  {text}", err=results.as_json),
                report=lambda now: show(*now.told),
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
        click.echo(f"interrupted: {sweep_progress(settled.progress)}; {go_on}", err=True)
        sys.exit(INTERRUPTED)
    try:
        _tell_sweep(made, folder, described(settled), results)
    except KeyboardInterrupt:
        click.echo(f"interrupted; all points are kept; {go_on}", err=True)
        sys.exit(INTERRUPTED)


def _tell_sweep(made: "Sweep", folder: Path, run: dict[str, object], results: Results) -> None:
    """Write the dataset of a sweep and say what is in it."""
    from rollslip.cli import console
    from rollslip.cli.units import with_units
    from rollslip.results.accounts import account_of
    from rollslip_campaigns.sweep.folder import RESULT, finish

    dataset = finish(made, folder)
    account = account_of(dataset)
    found = account.record(dataset)
    files = [
        RESULT,
        *(results.show({"sweep": dataset}, folder) if not found["counts"]["pending"] else []),
    ]
    if results.as_json:
        print_json(
            {
                "scene": made.given.source,
                "sweep_hash": made.hash,
                "study": made.study,
                "run": with_units(run),
            }
            | with_units(found, dataset)
            | {"folder": str(folder), "files": files}
        )
    else:
        console.print_found(dataset, "  ")
        click.echo(f"written to {folder}: {', '.join(files)}")
    warn(json.loads(dataset.attrs["left"]))
    if found["counts"]["ok"] < sum(found["counts"].values()):
        told = shlex.join(["rollslip", "sweep", "status", str(folder)])
        click.echo(f"some points have no result; see: {told}", err=True)
        if found["counts"]["pending"]:
            told = shlex.join(["rollslip", "sweep", "resume", str(folder)])
            click.echo(
                f"{found['counts']['pending']} of them are not computed yet; go on with: {told}",
                err=True,
            )
        sys.exit(SOME_FAILED)


# What is said ---------------------------------------------------------------------------------------------------------


def sweep_progress(of: "Progress") -> str:
    """Return how far a sweep is, in one line."""
    from rollslip.results.words import duration

    left = f", {duration(of.left)} left" if of.left is not None else ""
    return f"{of.told[0]}{left}"


def sweep_standing(of: "Status") -> list[str]:
    """Return how a sweep stands, line by line."""
    from rollslip.results.words import duration

    lines = [f"sweep of {of.study} in {of.folder}: {of.done} of {of.total} points done"]
    lines += [f"  {name}: {count}" for name, count in of.counts.items()]
    if of.done < of.total:
        lines.append(f"  not yet: {of.total - of.done}")
        if of.left is not None and of.quiet is not None:
            lines.append(
                f"  at the last pace {duration(of.left)} left; the last point came {duration(of.quiet)} ago"
            )
    for writer in of.writers:
        ended = writer["ended"] or (
            "runs" if of.running and writer is of.writers[-1] else "was killed"
        )
        who = f"{writer['host']} process {writer['process']}, {writer['engine']}"
        lines.append(f"  {who}: {writer['points']} points, {ended}")
    lines += [f"  point {number} {status}: {message}" for number, status, message in of.errors]
    return lines
