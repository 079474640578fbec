"""The commands ``rollslip sweep``: run, resume, retry and status, and the texts that they print."""

import json
import math
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
)
from rollslip.cli.campaign import (
    Printing,
    detail_options,
    typed_scene,
    warn_unusual,
    with_settings,
)
from rollslip_campaigns.sweep import SweepSettings

if TYPE_CHECKING:
    import xarray as xr

    from rollslip_campaigns.sweep.definition import Sweep
    from rollslip_campaigns.sweep.folder import SweepStatus
    from rollslip_campaigns.sweep.run import Progress


class _SweepCommands(click.Group):
    """The commands of a sweep; the message about an unknown command recognises a scene without a command."""

    def resolve_command(self, ctx: click.Context, args: list[str]) -> Any:
        """Find the command; if the first argument is a scene, raise an error with the command to write."""
        from rollslip.scene.reading import shipped_scenes

        if self.get_command(ctx, args[0]) is None and (
            Path(args[0]).suffix == ".toml" or args[0] in shipped_scenes()
        ):
            raise click.UsageError(
                f"{args[0]} is a scene; write: rollslip sweep run {shlex.join(args)}", ctx
            )
        return super().resolve_command(ctx, args)


sweep = _SweepCommands("sweep", help=SweepSettings.summary)


@results_options("Folder for the sweep, new or empty.", overwrite=False)
@detail_options
@json_option
def _sweep_run(requested: SweepSettings, about: str, results: Results, printing: Printing) -> None:
    from rollslip_campaigns.sweep.folder import create_folder

    planned = requested.plan()
    warn_unusual(planned)
    results.choose_folder(requested.folder_name(planned, about))
    _run_sweep(
        planned, create_folder(planned, results.target), (), results, printing, typed_scene(about)
    )


sweep.command("run")(with_settings(SweepSettings, _sweep_run))


@sweep.command("resume")
@click.argument("folder", type=click.Path(path_type=Path))
@engine_options
@results_options(out=False, overwrite=False)
@detail_options
@json_option
def sweep_resume(
    folder: Path,
    engine: Mapping[str, object] | None,
    time_limit: str | None,
    results: Results,
    printing: Printing,
) -> None:
    """Compute the points of the sweep in FOLDER that are not done yet."""
    from rollslip_campaigns.sweep.folder import open_folder
    from rollslip_campaigns.sweep.sweep import with_engine

    _run_sweep(with_engine(open_folder(folder), engine, time_limit), folder, (), results, printing)


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
@detail_options
@json_option
def sweep_retry(
    folder: Path,
    failed: bool,
    statuses: Sequence[str],
    engine: Mapping[str, object] | None,
    time_limit: str | None,
    results: Results,
    printing: Printing,
) -> None:
    """Compute points of the sweep in FOLDER again that have failed."""
    from rollslip_campaigns.sweep.folder import open_folder
    from rollslip_campaigns.sweep.journal import FAILED
    from rollslip_campaigns.sweep.sweep import with_engine

    if failed == bool(statuses):
        raise click.UsageError(
            "name the points to compute again: --failed, or --status of one kind"
        )
    if unknown := sorted(set(statuses) - set(FAILED)):
        raise click.UsageError(
            f"no point fails as {', '.join(unknown)}; there are: {', '.join(FAILED)}"
        )
    planned = with_engine(open_folder(folder), engine, time_limit)
    _run_sweep(planned, folder, FAILED if failed else tuple(statuses), results, printing)


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
    """Show the status of the sweep in FOLDER, also while it runs: points by status, time left, last errors."""
    from rollslip.cli.units import with_units
    from rollslip_campaigns.sweep.folder import read_status

    status = read_status(folder, errors)
    print_either(as_json, with_units(status.as_dict()), "\n".join(sweep_standing(status)))


def _run_sweep(
    planned: "Sweep",
    folder: Path,
    retry_statuses: Sequence[str],
    results: Results,
    printing: Printing,
    scene: str = "",
) -> None:
    """Run a sweep in its folder and print its results."""
    import os

    from rollslip.errors import BusyError, EngineError, OutputError
    from rollslip_campaigns.sweep.run import describe_outcome, run_sweep

    resume = f"go on with: {shlex.join(['rollslip', 'sweep', 'resume', str(folder)])}"
    try:
        with progress("sweep") as show:
            outcome = run_sweep(
                planned,
                folder,
                retry_statuses=tuple(retry_statuses),
                print_line=lambda text: printing.log([text]),
                report=lambda now: show(*now.summary),
            )
    except KeyboardInterrupt:
        click.echo(f"interrupted at once; what was done is stored; {resume}", err=True)
        sys.stdout.flush()
        os._exit(INTERRUPTED)  # sys.exit would wait for threads that still compute
    except BusyError:
        raise
    except (EngineError, OutputError) as error:
        raise type(error)(f"{error}\nwhat was done is stored; {resume}") from error
    if outcome.interrupted:
        click.echo(f"interrupted: {sweep_progress(outcome.progress)}; {resume}", err=True)
        sys.exit(INTERRUPTED)
    try:
        results.target = folder
        dataset = _write_sweep(planned, folder, results)
        if results.as_json:
            _print_sweep_json(planned, dataset, describe_outcome(outcome), results)
        else:
            printing.show(dataset, results, scene, planned.messages)
        _exit_unless_done(dataset, folder, resume)
    except KeyboardInterrupt:
        click.echo(f"interrupted; all points are stored; {resume}", err=True)
        sys.exit(INTERRUPTED)


def _write_sweep(planned: "Sweep", folder: Path, results: Results) -> "xr.Dataset":
    """Save the dataset of a sweep, with plots and tables where no point is pending, and return it."""
    from rollslip_campaigns.sweep.folder import RESULT, write_result

    dataset = write_result(planned, folder)
    if json.loads(dataset.attrs["counts"])["pending"]:
        results.files = [RESULT]
    else:
        results.show({"sweep": dataset}, folder)
    return dataset


def _print_sweep_json(
    planned: "Sweep", dataset: "xr.Dataset", run: dict[str, object], results: Results
) -> None:
    """Print the results of a sweep as JSON."""
    from rollslip.cli.units import with_units
    from rollslip.results.accounts import account_of, answer

    print_json(
        {
            "scene": planned.given.source,
            "sweep_hash": planned.hash,
            "study": planned.study,
            "answer": with_units(answer(dataset).as_dict()),
            "run": with_units(run),
        }
        | with_units(account_of(dataset).record(dataset), dataset)
        | results.as_dict()
    )


def _exit_unless_done(dataset: "xr.Dataset", folder: Path, resume: str) -> None:
    """Exit with the advice to resume or to retry where points have no result."""
    counts = json.loads(dataset.attrs["counts"])
    if counts["ok"] == sum(counts.values()):
        return
    command = shlex.join(["rollslip", "sweep", "status", str(folder)])
    click.echo(f"some points have no result; see: {command}", err=True)
    if counts["pending"]:
        click.echo(f"{counts['pending']} of them are not computed yet; {resume}", err=True)
    sys.exit(SOME_FAILED)


# Texts ----------------------------------------------------------------------------------------------------------------


def sweep_progress(progress: "Progress") -> str:
    """Return the progress of a sweep in one line."""
    from rollslip.results.text import duration

    text, _, left = progress.summary
    return text if math.isnan(left) else f"{text}, {duration(left)} left"


def sweep_standing(status: "SweepStatus") -> list[str]:
    """Return the status of a sweep, line by line."""
    from rollslip.results.text import duration

    lines = [
        f"sweep of {status.study} in {status.folder}: {status.done} of {status.total} points done"
    ]
    lines += [f"  {name}: {count}" for name, count in status.counts.items()]
    if status.done < status.total:
        lines.append(f"  not yet: {status.total - status.done}")
        if status.left is not None and status.quiet is not None:
            lines.append(
                f"  at the last pace {duration(status.left)} left; the last point came {duration(status.quiet)} ago"
            )
    for writer in status.writers:
        ended = writer["ended"] or (
            "runs" if status.running and writer is status.writers[-1] else "was killed"
        )
        lines.append(
            f"  {writer['host']} process {writer['process']}, {writer['engine']}: {writer['points']} points, {ended}"
        )
    lines += [f"  point {number} {code}: {message}" for number, code, message in status.errors]
    return lines
