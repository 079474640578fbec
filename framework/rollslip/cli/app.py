"""What commands share: exit codes, options, where results go, and what is shown while they are computed.

Nothing heavy is imported before a command needs it, so that ``--help`` answers at once.
"""

import functools
import json
import math
import shlex
import signal
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs
import click

if TYPE_CHECKING:
    import xarray as xr
    from rich.console import Console

    from rollslip.planning.progress import ProgressReporter
    from rollslip.scene.values import Scene

#: What the shell sees.
OK = 0
BAD_SCENE = 2
NOT_CONVERGED = 3
SOME_FAILED = 4
BAD_PLUGIN = 5
FAILED_ON = 6
INTERRUPTED = 130

#: What plots are written as; a test holds that it is what can be written.
FORMATS = frozenset({"svg", "pdf", "png"})
TABLES = frozenset({"csv", "xlsx"})
#: Options that say where results go and how, not what is computed; as names of the fields of `Results`.
OF_RESULTS = frozenset({"out", "overwrite", "resume", "report", "as_json"})


# Options ------------------------------------------------------------------------------------------------------------


def complete_scenes(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[str]:
    """Scenes that begin so: shipped ones, and files and folders here."""
    from rollslip.scene.reading import shipped_scenes

    here = Path(incomplete) if incomplete.endswith("/") else Path(incomplete).parent
    inside = sorted(here.iterdir()) if here.is_dir() else []
    places = [
        f"{path}/" if path.is_dir() else str(path)
        for path in inside
        if path.is_dir() or path.suffix == ".toml"
    ]
    return [one for one in (*shipped_scenes(), *places) if one.startswith(incomplete)]


def complete_keys(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[str]:
    """Keys of a scene that begin so; behind the sign of ``--set`` the value is the user's."""
    from rollslip.planning.keys import keys

    sign = "=" if param.name == "changes" else ""
    found = (
        f"{row.key}{sign}"
        for row in keys(models=incomplete.startswith("models."))
        if not row.key.endswith("*")
    )
    return [one for one in dict.fromkeys(found) if one.startswith(incomplete)]


def complete_models(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[str]:
    """Names of models and kinds that begin so; for an option, of the kind that it names."""
    from rollslip.catalogue.discovery import available, families
    from rollslip.catalogue.kinds import offered_kinds

    of = {"oil": "lubricant"}.get(param.name or "", param.name or "")
    kinds = [of] if of in offered_kinds() else offered_kinds()
    names = offered_kinds() if len(kinds) > 1 else []
    names += [name for kind in kinds for name in available(kind)]
    names += [name for kind in kinds for _, family in families(kind) for name in family.names]
    return [one for one in dict.fromkeys(names) if one.startswith(incomplete)]


scene_argument = click.argument("scene", shell_complete=complete_scenes)
json_option = click.option("--json", "as_json", is_flag=True, help="Print JSON instead of text.")
set_option = click.option(
    "--set",
    "changes",
    metavar="KEY=VALUE",
    multiple=True,
    shell_complete=complete_keys,
    help="Change a value of the scene; may be repeated.",
)
study_option = click.option(
    "--study", metavar="STUDY", shell_complete=complete_models, help="Only this study."
)
resume_option = click.option(
    "--resume",
    is_flag=True,
    help="Go on with the interrupted run that --out was to take the results of.",
)


def verbose_option(what: str) -> Callable[[Any], Any]:
    """Add the option that says all of it; `what` is what comes then."""
    return click.option("-v", "--verbose", is_flag=True, help=what)


def engine_options(command: Any) -> Any:
    """Add the options that say where points are computed; the command gets `engine`, as a scene would state it."""

    @functools.wraps(command)
    def with_engine(
        engine: str | None, workers: int | None, scheduler: str | None, **others: Any
    ) -> None:
        command(engine=_engine_table(engine, workers, scheduler), **others)

    for option in (
        click.option(
            "--time-limit", metavar="TIME", help="Longest time for one point, such as '60 s'."
        ),
        click.option("--scheduler", metavar="ADDRESS", help="Scheduler of engine dask."),
        click.option("--workers", metavar="N", type=click.IntRange(1), help="Points at a time."),
        click.option(
            "--engine",
            metavar="NAME",
            help="Where: serial, threads, processes, dask; by default chosen.",
        ),
    ):
        with_engine = option(with_engine)
    return with_engine


def _formats(context: click.Context, option: click.Parameter, text: str) -> tuple[str, ...]:
    """Return what --format names."""
    names = tuple(dict.fromkeys(filter(None, (name.strip().lower() for name in text.split(",")))))
    if not names or set(names) - FORMATS - TABLES:
        known = ", ".join(sorted(FORMATS | TABLES))
        raise click.BadParameter(f"{text!r}; name some of {known}, separated by commas")
    return names


def _engine_table(
    engine: str | None, workers: int | None, scheduler: str | None
) -> dict[str, object] | None:
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
    out: bool = True,
    overwrite: bool = True,
    resume: bool = False,
) -> Callable[[Any], Any]:
    """Add the options of a command that writes results; the command gets `results` in place of them and of --json."""
    options = {
        "out": click.option("--out", metavar="DIR", type=click.Path(path_type=Path), help=folder),
        "overwrite": click.option(
            "--overwrite", is_flag=True, help="Replace what rollslip wrote there, and nothing else."
        ),
        "resume": resume_option,
        "report": click.option("--report", is_flag=True, help="Write a report in HTML too."),
        "no_plots": click.option("--no-plots", is_flag=True, help=plots),
        "formats": click.option(
            "--format", "formats", metavar="NAME,NAME", default="svg", show_default=True, callback=_formats,
            help="Files of the plots: svg, pdf, png; of a table: csv, xlsx.",
        ),
    }  # fmt: skip
    left_out = {
        name
        for name, wanted in (("out", out), ("overwrite", overwrite), ("resume", resume))
        if not wanted
    }

    def with_options(command: Any) -> Any:
        @functools.wraps(command)
        def with_results(no_plots: bool, formats: tuple[str, ...], **given: Any) -> None:
            own = {name: given.pop(name) for name in OF_RESULTS & given.keys()}
            plotted = () if no_plots else FORMATS.intersection(formats)
            results = Results(
                formats=tuple(one for one in formats if one in plotted),
                tables=tuple(one for one in formats if one in TABLES),
                **own,
            )
            command(results=results, **given)

        for name in reversed(options):
            with_results = with_results if name in left_out else options[name](with_results)
        return with_results

    return with_options


# Scenes and results ---------------------------------------------------------------------------------------------------


def scene_of(
    name: str, changes: Sequence[str], later: str = "", over: Sequence[str] = ()
) -> "Scene":
    """Return a scene by name or file, also of another program, with what --set changes.

    What such a file lacks, and what of it is not used, is told, and of what is unusual it is warned, but for what says
    ``later`` and for keys of ``over``, KEY=VALUES.
    """
    from rollslip.planning.plausibility import implausible
    from rollslip.scene.changes import evolve, full_key, parse_set
    from rollslip.scene.formats import format_of
    from rollslip.scene.reading import load_scene

    if format_of(name) is None:
        scene = load_scene(name)
    else:
        from rollslip.scene.interchange import read_foreign

        scene, notes = read_foreign(name)
        for note in notes:
            click.echo(f"note: {note}", err=True)
    scene = evolve(scene, dict(map(parse_set, changes))) if changes else scene
    moved = {full_key(one.partition("=")[0]) for one in over}
    warn(text for text in implausible(scene, moved) if not later or later not in text)
    return scene


def warn(texts: Iterable[str]) -> None:
    """Print warnings, each once in a command."""
    said: dict[str, None] = click.get_current_context().meta.setdefault(f"{__name__}.warned", {})
    for text in texts:
        if text not in said:
            said[text] = None
            click.echo(f"warning: {text}", err=True)


@attrs.define(kw_only=True)
class Results:
    """Where the results of a command go, and how they are written, drawn and told."""

    report: bool
    formats: tuple[str, ...]  #: Of plots.
    tables: tuple[str, ...]  #: Formats of tables.
    as_json: bool
    out: Path | None = None
    overwrite: bool = False
    resume: bool = False
    target: Path = attrs.field(factory=Path, init=False)
    files: list[str] = attrs.field(factory=list, init=False)

    def go_to(self, name: str) -> None:
        """Decide the folder: that of --out, or the first of NAME, NAME-2 ... that is free."""
        self.target = self.out if self.out is not None else free_folder(name)

    @contextmanager
    def folder(self) -> Iterator[Path]:
        """Give a folder that becomes the one of the results when all is done, whole or not at all."""
        from rollslip.results.folder import results_folder

        with results_folder(self.target, overwrite=self.overwrite or self.resume) as folder:
            yield folder
            # whole: an interrupt from here on would be told as if nothing had been written
            signal.signal(signal.SIGINT, signal.SIG_IGN)

    def show(
        self, datasets: "Mapping[str, xr.Dataset]", folder: Path, scene: str = ""
    ) -> list[str]:
        """Draw results into the folder where they are stored as NAME.nc, with a report if asked for.

        Return the names of what was written.
        """
        figures = dict[str, list[Path]]()
        written = list[str]()
        if self.report or self.formats:
            from rollslip.results.accounts import answer
            from rollslip.results.figures import save_plots

            drawn = dict.fromkeys((*self.formats, *(["svg"] if self.report else [])))
            with progress("plots"):
                slip = next(
                    (
                        row.value
                        for row in answer(*datasets.values()).rows
                        if row.key == "cage_slip"
                    ),
                    math.nan,
                )
                for (
                    name,
                    dataset,
                ) in datasets.items():  # maps show where the cage runs, also by another study
                    files = save_plots(
                        dataset.assign_attrs(operating_slip=slip), folder, tuple(drawn)
                    )
                    figures[name] = [file for file in files if file.suffix == ".svg"]
                    written += [file.name for file in files if file.suffix[1:] in self.formats]
        if self.tables:
            from rollslip.results.table import save_tables

            written += [file.name for file in save_tables(datasets, folder, self.tables)]
        if self.report:
            from rollslip.results.report import write_report

            write_report(datasets, figures, folder / "report.html", scene)
            if "svg" not in self.formats:  # they were for the report alone
                for file in (file for files in figures.values() for file in files):
                    file.unlink()
            written.append("report.html")
        self.files = sorted(
            path.name for path in folder.iterdir() if path.is_file() and path.name[0] != "."
        )
        return written

    def as_dict(self) -> dict[str, Any]:
        """Return where everything was written to, as plain values."""
        return {"folder": str(self.target), "files": self.files}

    def tell(self, *datasets: "xr.Dataset", laws: bool = True) -> None:
        """Print the warnings of results, those of most consequence, and where everything was written to.

        Without ``laws`` those of laws outside their range are not among them: an answer has them as notes.
        """
        from rollslip.results.text import collect_warnings, describe_more_bounds

        first, more = collect_warnings(datasets, laws=laws)
        warn(first)
        if more:
            warn(
                [
                    f"{describe_more_bounds(more)}; rollslip info of the .nc files in {self.target} tells of each"
                ]
            )
        click.echo(f"written to {self.target}: {', '.join(self.files)}")

    # Runs that can go on after an interruption ------------------------------------------------------------------------

    def checkpoint_folder(self) -> Path:
        """Return the folder in which runs leave what they have computed, until they end."""
        target = self.target.resolve()
        kept = target.parent / f"{target.name}.unfinished"
        if self.resume and not (self.out is not None and kept.is_dir()):
            raise click.UsageError(
                "--resume needs the --out of the run"
                if self.out is None
                else f"there is no interrupted run to go on with in {kept}"
            )
        if kept.exists() and not self.resume:
            raise click.UsageError(
                f"{kept} holds an interrupted run: go on with it by --resume, or remove it"
            )
        return kept

    def go_on(self, command: Sequence[str]) -> str:
        """Say how to go on with a command that was interrupted."""
        return f"interrupted; go on with: {shlex.join([*command, '--out', str(self.target), '--resume'])}"


def free_folder(name: str) -> Path:
    """Return the first of NAME, NAME-2, NAME-3 ... that does not exist, so that no run touches another's results."""
    path = Path(name)
    count = 1
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


# Meanwhile ------------------------------------------------------------------------------------------------------------


def at_a_terminal() -> bool:
    """Return whether somebody is there to be asked."""
    return sys.stdin is not None and sys.stdin.isatty() and sys.stderr.isatty()


def terminal(*, stderr: bool = False, width: int | None = None) -> "Console":
    """Return the console of rich to which tables and bars are written; texts go there as they are."""
    from rich.console import Console

    return Console(stderr=stderr, width=width, highlight=False)


@contextmanager
def progress(what: str, seconds: float = math.nan) -> "Iterator[ProgressReporter]":
    """Show how far something is and how long it will take: a bar on a terminal, else a line every half a minute.

    Messages that are printed meanwhile stand above the bar. The bar vanishes at the end.
    """
    from rollslip.planning.progress import ProgressTimer

    timer = ProgressTimer(seconds)
    if not sys.stderr.isatty():
        said = timer.start

        def line(text: str, fraction: float = math.nan, left: float = math.nan) -> None:
            nonlocal said
            timer.update(fraction, left)
            if timer.updated - said >= 30.0:
                said = timer.updated
                click.echo(
                    ": ".join([what, ", ".join(filter(None, [text, timer.format_time_left()]))]),
                    err=True,
                )

        yield line
        return
    from rich.file_proxy import FileProxy
    from rich.progress import (
        BarColumn,
        Progress,
        ProgressColumn,
        SpinnerColumn,
        Task,
        TextColumn,
        TimeElapsedColumn,
    )
    from rich.text import Text

    class Left(ProgressColumn):
        def render(self, task: Task) -> Text:
            return Text(timer.format_time_left())

    columns = (
        SpinnerColumn(),
        TextColumn("{task.description}", markup=False),
        BarColumn(20),
        TimeElapsedColumn(),
        Left(),
    )

    class Above(FileProxy):
        encoding = "utf-8"  # without one click writes past it, into the line of the bar

    console = terminal(stderr=True)
    shown = Progress(
        *columns, console=console, transient=True, redirect_stdout=False, redirect_stderr=False
    )
    with shown, ExitStack() as above:
        # what goes to a file or a pipe must not be drawn into the terminal of the bar
        if sys.stdout.isatty():
            above.enter_context(redirect_stdout(Above(console, sys.stdout)))
        above.enter_context(redirect_stderr(Above(console, sys.stderr)))
        task = shown.add_task(what, total=None)

        def show(text: str, fraction: float = math.nan, left: float = math.nan) -> None:
            timer.update(fraction, left)
            known = not math.isnan(fraction)
            shown.update(
                task,
                description=f"{what}: {text}",
                total=1.0 if known else None,
                completed=fraction if known else 0.0,
            )

        yield show


def print_json(value: object) -> None:
    """Print plain values as JSON."""
    click.echo(json.dumps(value, indent=2, allow_nan=False))


def print_either(as_json: bool, value: object, text: object) -> None:
    """Print plain values as JSON, or the text that says the same."""
    if as_json:
        print_json(value)
    else:
        click.echo(text)
