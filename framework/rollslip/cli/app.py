"""What commands share: exit codes, options, where results go, and what is shown while they are computed.

Nothing heavy is imported before a command needs it, so that ``--help`` answers at once.
"""

import functools
import json
import math
import shlex
import shutil
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.scene.values import Scene

#: What the shell sees.
OK, BAD_SCENE, NOT_CONVERGED, SOME_FAILED, BAD_PLUGIN, INTERRUPTED = 0, 2, 3, 4, 5, 130


# Options ------------------------------------------------------------------------------------------------------------

json_option = click.option("--json", "as_json", is_flag=True, help="Print JSON instead of text.")
set_option = click.option(
    "--set", "changes", metavar="KEY=VALUE", multiple=True, help="Change a value of the scene; may be repeated."
)
study_option = click.option("--study", metavar="STUDY", help="Only this study.")
resume_option = click.option(
    "--resume", is_flag=True, help="Go on with the interrupted run that --out was to take the results of."
)


def engine_options(command: Any) -> Any:
    """Add the options that say where points are computed; the command gets `engine`, as a scene would state it."""

    @functools.wraps(command)
    def with_engine(engine: str | None, workers: int | None, scheduler: str | None, **others: Any) -> None:
        command(engine=_engine_table(engine, workers, scheduler), **others)

    for option in (
        click.option("--time-limit", metavar="TIME", help="Longest time for one point, such as '60 s'."),
        click.option("--scheduler", metavar="ADDRESS", help="Scheduler of engine dask."),
        click.option("--workers", metavar="N", type=click.IntRange(1), help="Points at a time."),
        click.option("--engine", metavar="NAME", help="Where: serial, threads, processes, dask; by default chosen."),
    ):
        with_engine = option(with_engine)
    return with_engine


def _engine_table(engine: str | None, workers: int | None, scheduler: str | None) -> dict[str, object] | None:
    """Return engine and its parameters as a scene would state them."""
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


def results_options(
    folder: str = "Folder for the results, new or empty.",
    plots: str = "Write data only.",
    *,
    overwrite: bool = True,
    resume: bool = False,
    report: bool = True,
) -> Callable[[Any], Any]:
    """Add the options of a command that writes results; the command gets `results` in place of them and of --json.

    Parameters
    ----------
    folder, plots : str
        What --out is, and what --no-plots leaves.
    overwrite, resume, report : bool
        Whether there are such options.
    """
    options = [
        click.option("--out", metavar="DIR", type=click.Path(path_type=Path), help=folder),
        *(
            [
                click.option(
                    "--overwrite",
                    is_flag=True,
                    help="Replace what rollslip wrote there, and nothing else.",
                )
            ]
            if overwrite
            else []
        ),
        *([resume_option] if resume else []),
        *([click.option("--report", is_flag=True, help="Write a report in HTML too.")] if report else []),
        click.option("--no-plots", is_flag=True, help=plots),
    ]

    def with_options(command: Any) -> Any:
        @functools.wraps(command)
        def with_results(
            out: Path | None,
            no_plots: bool,
            as_json: bool,
            overwrite: bool = False,
            resume: bool = False,
            report: bool = False,
            **others: Any,
        ) -> None:
            results = Results(
                out, overwrite=overwrite, resume=resume, report=report, plots=not no_plots, as_json=as_json
            )
            command(results=results, **others)

        for option in reversed(options):
            with_results = option(with_results)
        return with_results

    return with_options


# Scenes and results ---------------------------------------------------------------------------------------------------


def scene_of(name: str, changes: Sequence[str]) -> "Scene":
    """Return a scene by name or file, with what --set changes; of what is unusual in it is warned."""
    from rollslip.planning.plausibility import implausible
    from rollslip.scene.changes import evolve, parse_set
    from rollslip.scene.reading import load_scene

    scene = load_scene(name)
    scene = evolve(scene, dict(map(parse_set, changes))) if changes else scene
    warn(implausible(scene))
    return scene


def warn(texts: Iterable[str]) -> None:
    """Print warnings, each once in a command."""
    said: dict[str, None] = click.get_current_context().meta.setdefault(f"{__name__}.warned", {})
    for text in texts:
        if text not in said:
            said[text] = None
            click.echo(f"warning: {text}", err=True)


class Results:
    """Where the results of a command go, and how they are written, drawn and told."""

    def __init__(
        self, out: Path | None, *, overwrite: bool, resume: bool, report: bool, plots: bool, as_json: bool
    ) -> None:
        self._out, self._overwrite, self._resume, self._report, self._plots = out, overwrite, resume, report, plots
        self.as_json = as_json
        self.target = Path()
        self._files: list[str] = []

    def go_to(self, name: str) -> None:
        """Decide the folder: that of --out, or the first of NAME, NAME-2 ... that is free."""
        self.target = self._out if self._out is not None else free_folder(name)

    @contextmanager
    def folder(self) -> Iterator[Path]:
        """Give a folder that becomes the one of the results when all is done, whole or not at all."""
        from rollslip.results.folder import results_folder

        with results_folder(self.target, overwrite=self._overwrite or self._resume) as folder:
            yield folder

    def show(self, datasets: "Mapping[str, xr.Dataset]", folder: Path) -> None:
        """Draw results into the folder that they are stored in, with a report if asked for."""
        figures: dict[str, list[Path]] = {name: [] for name in datasets}
        if self._report or self._plots:
            from rollslip.results.figures import plot

            with progress("plots"):
                figures = {name: plot(dataset, folder) for name, dataset in datasets.items()}
        if self._report:
            from rollslip.results.report import write_report

            write_report(datasets, figures, folder / "report.html")
        self._files = sorted(path.name for path in folder.iterdir() if path.is_file() and path.name[0] != ".")

    def as_dict(self) -> dict[str, Any]:
        """Return where everything was written to, as plain values."""
        return {"folder": str(self.target), "files": self._files}

    def tell(self, *datasets: "xr.Dataset") -> None:
        """Print the warnings of results, those of most consequence, and where everything was written to."""
        from rollslip.results.words import counted, warned

        first, more = warned(datasets)
        warn(first)
        if more:
            warn([f"{counted(more)}; rollslip info of the .nc files in {self.target} tells of each"])
        click.echo(f"written to {self.target}: {', '.join(self._files)}")

    # Runs that can go on after an interruption ------------------------------------------------------------------------

    def kept(self) -> Path:
        """Return the folder in which runs leave what they have computed, until they end."""
        target = self.target.resolve()
        kept = target.parent / f"{target.name}.unfinished"
        if self._resume and not (self._out is not None and kept.is_dir()):
            raise click.UsageError(
                "--resume needs the --out of the run"
                if self._out is None
                else f"there is no interrupted run to go on with in {kept}"
            )
        if kept.exists() and not self._resume:
            raise click.UsageError(f"{kept} holds an interrupted run: go on with it by --resume, or remove it")
        return kept

    def go_on(self, command: Sequence[str]) -> str:
        """Say how to go on with a command that was interrupted."""
        return f"interrupted; go on with: {shlex.join([*command, '--out', str(self.target), '--resume'])}"


def free_folder(name: str) -> Path:
    """Return the first of NAME, NAME-2, NAME-3 ... that does not exist, so that no run touches another's results."""
    path, count = Path(name), 1
    while path.exists() or path.with_name(f"{path.name}.unfinished").exists():
        count += 1
        path = Path(f"{name}-{count}")
    return path


@contextmanager
def interruptible(kept: Path, go_on: str) -> Iterator[None]:
    """Say how to go on with a long run, where it was interrupted while something else was done with it."""
    try:
        yield
    except KeyboardInterrupt:
        if not kept.is_dir():
            raise
        click.echo(go_on, err=True)
        sys.exit(INTERRUPTED)


def forget(kept: Path) -> None:
    """Remove what a run has left for going on, now that it has ended."""
    shutil.rmtree(kept, ignore_errors=True)


# Meanwhile ------------------------------------------------------------------------------------------------------------


@contextmanager
def progress(what: str) -> Iterator[Callable[[str], None]]:
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
def bar(what: str) -> Iterator[Callable[[float, float, str], None]]:
    """Show how far a run of many parts is and how long it will take: a bar on a terminal, else as `progress` does."""

    def left(seconds: float) -> str:
        return "" if math.isnan(seconds) else f", {seconds // 60:.0f} min {seconds % 60:02.0f} s left"

    if not sys.stderr.isatty():
        with progress(what) as say:
            yield lambda share, seconds, text: say(f"{share:.0%}{left(seconds)}, {text}")
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn

    columns = TextColumn("{task.percentage:3.0f} %"), BarColumn(), TextColumn("{task.description}", markup=False)
    with Progress(*columns, console=Console(stderr=True), transient=True) as shown:
        task = shown.add_task(what, total=1.0)
        yield lambda share, seconds, text: shown.update(task, completed=share, description=f"{text}{left(seconds)}")


def print_json(value: object) -> None:
    """Print plain values as JSON."""
    click.echo(json.dumps(value, indent=2, allow_nan=False))
