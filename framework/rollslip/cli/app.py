"""Common parts of commands: exit codes, options, folders of results, and the display of progress.

Slow modules are imported only by the commands that need them, so that ``--help`` answers quickly.
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

#: Exit code of a command that was successful.
OK = 0
#: Exit code for a wrong scene or wrong options, which click uses too.
BAD_SCENE = 2
#: Exit code for an iteration that did not converge.
NOT_CONVERGED = 3
#: Exit code of a campaign of which some points failed.
SOME_FAILED = 4
#: Exit code for a plugin that is missing or broken.
BAD_PLUGIN = 5
#: Exit code for a verdict named by --fail-on.
FAILED_ON = 6
#: Exit code of an interrupted command: 128 plus the number of SIGINT, as shells have it.
INTERRUPTED = 130

#: File formats of plots; a test compares them with those that can be written.
FORMATS = frozenset({"svg", "pdf", "png"})
#: File formats of tables.
TABLES = frozenset({"csv", "xlsx"})
#: Endings of files with the points of a campaign, which are not listed beside its results.
_OF_POINTS = (".sqlite", ".lock", "sweep.json")
#: Options on the output of results, not on the computation; names of the fields of `Results`.
OUTPUT_OPTIONS = frozenset({"out", "overwrite", "resume", "report", "as_json"})


# Options ------------------------------------------------------------------------------------------------------------


def complete_scenes(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[str]:
    """Return completions of a scene: names of shipped ones, and files and folders."""
    from rollslip.scene.reading import shipped_scenes

    folder = Path(incomplete) if incomplete.endswith("/") else Path(incomplete).parent
    paths = [
        f"{path}/" if path.is_dir() else str(path)
        for path in sorted(folder.glob("*"))
        if path.is_dir() or path.suffix == ".toml"
    ]
    return [name for name in (*shipped_scenes(), *paths) if name.startswith(incomplete)]


def complete_keys(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[str]:
    """Return completions of a key of a scene, with "=" for ``--set``."""
    from rollslip.planning.keys import keys

    sign = "=" if param.name == "changes" else ""
    known = (
        f"{row.key}{sign}"
        for row in keys(models=incomplete.startswith("models."))
        if not row.key.endswith("*")
    )
    return [key for key in dict.fromkeys(known) if key.startswith(incomplete)]


def complete_models(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[str]:
    """Return completions of the name of a model or a kind; for an option that is a kind, of its models only."""
    from rollslip.catalogue.discovery import available, families
    from rollslip.catalogue.kinds import offered_kinds

    own_kind = {"oil": "lubricant"}.get(param.name or "", param.name or "")
    kinds = [own_kind] if own_kind in offered_kinds() else offered_kinds()
    names = offered_kinds() if len(kinds) > 1 else []
    names += [name for kind in kinds for name in available(kind)]
    names += [name for kind in kinds for _, family in families(kind) for name in family.names]
    return [name for name in dict.fromkeys(names) if name.startswith(incomplete)]


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
    help="Resume the interrupted run of folder --out.",
)


def verbose_option(help_text: str) -> Callable[[Any], Any]:
    """Add the option of a longer output."""
    return click.option("-v", "--verbose", is_flag=True, help=help_text)


def engine_options(command: Any) -> Any:
    """Add the options of the engine that computes points; the command gets `engine`, as a scene would state it."""

    @functools.wraps(command)
    def with_engine(
        engine: str | None, workers: int | None, scheduler: str | None, **others: Any
    ) -> None:
        command(engine=_engine_table(engine, workers, scheduler), **others)

    for option in (
        click.option(
            "--time-limit", metavar="TIME", help="Time limit for one point, such as '60 s'."
        ),
        click.option("--scheduler", metavar="ADDRESS", help="Scheduler of engine dask."),
        click.option("--workers", metavar="N", type=click.IntRange(1), help="Points at a time."),
        click.option(
            "--engine",
            metavar="NAME",
            help="serial, threads, processes or dask; by default the fastest.",
        ),
    ):
        with_engine = option(with_engine)
    return with_engine


def _formats(
    context: click.Context, option: click.Parameter, texts: tuple[str, ...]
) -> tuple[str, ...]:
    """Return the formats of all --format."""
    text = ",".join(texts)
    names = tuple(dict.fromkeys(filter(None, (name.strip().lower() for name in text.split(",")))))
    if not names or set(names) - FORMATS - TABLES:
        known = ", ".join(sorted(FORMATS | TABLES))
        raise click.BadParameter(f"{text!r}; name some of {known}, separated by commas")
    return names


def _engine_table(
    engine: str | None, workers: int | None, scheduler: str | None
) -> dict[str, object] | None:
    """Return an engine with its parameters as a scene would state it."""
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
            "--overwrite", is_flag=True, help="Replace results of rollslip in the folder, and no other files."
        ),
        "resume": resume_option,
        "report": click.option("--report", is_flag=True, help="Write a report in HTML too."),
        "no_plots": click.option("--no-plots", is_flag=True, help=plots),
        "formats": click.option(
            "--format", "formats", metavar="NAME,NAME", multiple=True, default=("svg",), show_default=True,
            callback=_formats,
            help="Files of the plots: svg, pdf, png; of a table: csv, xlsx; svg,csv for both.",
        ),
    }  # fmt: skip
    left_out = {
        name
        for name, is_included in (("out", out), ("overwrite", overwrite), ("resume", resume))
        if not is_included
    }

    def with_options(command: Any) -> Any:
        @functools.wraps(command)
        def with_results(no_plots: bool, formats: tuple[str, ...], **given: Any) -> None:
            own = {name: given.pop(name) for name in OUTPUT_OPTIONS & given.keys()}
            plot_formats = () if no_plots else FORMATS.intersection(formats)
            results = Results(
                formats=tuple(name for name in formats if name in plot_formats),
                tables=tuple(name for name in formats if name in TABLES),
                **own,
            )
            command(results=results, **given)

        for name in reversed(options):
            if name not in left_out:
                with_results = options[name](with_results)
        return with_results

    return with_options


# Scenes and results ---------------------------------------------------------------------------------------------------


def scene_of(name: str, changes: Sequence[str], over: Sequence[str] = ()) -> "Scene":
    """Return a scene by name or file, also one of another program, with the changes of --set.

    Notes are printed on items that a file of another program lacks, or that are not used. Warnings are printed on
    unusual values, except those of keys in ``over`` (KEY=VALUES).
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
    scene = evolve(scene, dict(map(parse_set, changes)))
    warn(implausible(scene, {full_key(text.partition("=")[0]) for text in over}))
    return scene


def warn(texts: Iterable[str]) -> None:
    """Print warnings, each once in a command, except that on SKF's minimum load, which answers have."""
    from rollslip.results.text import CATALOGUE_LOAD_WARNING

    printed: dict[str, None] = click.get_current_context().meta.setdefault(f"{__name__}.warned", {})
    for text in texts:
        if text not in printed and CATALOGUE_LOAD_WARNING not in text:
            printed[text] = None
            click.echo(f"warning: {text}", err=True)


@attrs.define(kw_only=True)
class Results:
    """Output of the results of a command: folder, plots, tables and report."""

    #: Whether a report is written.
    report: bool
    #: File formats of plots.
    formats: tuple[str, ...]
    #: File formats of tables.
    tables: tuple[str, ...]
    #: Whether results are printed as JSON.
    as_json: bool
    out: Path | None = None
    overwrite: bool = False
    resume: bool = False
    target: Path = attrs.field(factory=Path, init=False)
    files: list[str] = attrs.field(factory=list, init=False)

    def choose_folder(self, name: str) -> None:
        """Set the folder: that of --out, or the first of NAME, NAME-2 ... that does not exist."""
        self.target = self.out or free_folder(name)

    @contextmanager
    def folder(self) -> Iterator[Path]:
        """Yield a temporary folder, which is renamed to that of the results at the end of the block."""
        from rollslip.results.folder import results_folder

        with results_folder(self.target, overwrite=self.overwrite or self.resume) as folder:
            yield folder
            # the results are complete: an interrupt from here on would wrongly report that nothing is written
            signal.signal(signal.SIGINT, signal.SIG_IGN)

    def show(
        self, datasets: "Mapping[str, xr.Dataset]", folder: Path, scene: str = ""
    ) -> list[str]:
        """Write plots, tables and a report of results, as requested, into their folder; return the names of files."""
        figures = dict[str, list[Path]]()
        written = list[str]()
        if self.report or self.formats:
            with progress("plots"):
                figures, written = self._save_plots(datasets, folder)
        if self.tables:
            from rollslip.results.table import save_tables

            written += [file.name for file in save_tables(datasets, folder, self.tables)]
        if self.report:
            from rollslip.results.report import write_report

            write_report(datasets, figures, folder / "report.html", scene)
            if "svg" not in self.formats:  # they were for the report only
                for file in (file for files in figures.values() for file in files):
                    file.unlink()
            written.append("report.html")
        self.files = sorted(
            path.name for path in folder.iterdir() if path.is_file() and path.name[0] != "."
        )
        return written

    def _save_plots(
        self, datasets: "Mapping[str, xr.Dataset]", folder: Path
    ) -> tuple[dict[str, list[Path]], list[str]]:
        """Write plots; return those in SVG by result, for the report, and the names of requested files."""
        from rollslip.results.accounts import answer
        from rollslip.results.figures import save_plots

        formats = dict.fromkeys((*self.formats, *(["svg"] if self.report else [])))
        figures = dict[str, list[Path]]()
        written = list[str]()
        # maps mark the operating slip, which may be the result of another study
        slip = next(
            (row.value for row in answer(*datasets.values()).rows if row.key == "cage_slip"),
            math.nan,
        )
        for name, dataset in datasets.items():
            files = save_plots(dataset.assign_attrs(operating_slip=slip), folder, tuple(formats))
            figures[name] = [file for file in files if file.suffix == ".svg"]
            written += [file.name for file in files if file.suffix[1:] in self.formats]
        return figures, written

    def as_dict(self) -> dict[str, Any]:
        """Return folder and files of the results as plain values."""
        return {"folder": str(self.target), "files": self.files}

    def print_summary(self, *datasets: "xr.Dataset") -> None:
        """Print the warnings of results that their answer does not have, and the files that were written."""
        from rollslip.results.text import collect_warnings

        texts, _ = collect_warnings(datasets, laws=False)
        warn(texts)
        files = [name for name in self.files if not name.endswith(_OF_POINTS)]
        click.echo(f"written to {self.target}: {', '.join(files)}")

    # Runs that can go on after an interruption ------------------------------------------------------------------------

    def checkpoint_folder(self) -> Path:
        """Return the folder for checkpoints of a run, which exists until it ends."""
        target = self.target.resolve()
        checkpoints = target.parent / f"{target.name}.unfinished"
        if self.resume and not (self.out is not None and checkpoints.is_dir()):
            raise click.UsageError(
                "--resume needs the --out of the run"
                if self.out is None
                else f"there is no interrupted run to continue in {checkpoints}"
            )
        if checkpoints.exists() and not self.resume:
            raise click.UsageError(
                f"{checkpoints} contains an interrupted run: continue it by --resume, or remove it"
            )
        return checkpoints

    def resume_hint(self, command: Sequence[str]) -> str:
        """Return the message on how to resume an interrupted command."""
        return f"interrupted; continue with: {shlex.join([*command, '--out', str(self.target), '--resume'])}"


def free_folder(name: str) -> Path:
    """Return the first of NAME, NAME-2, NAME-3 ... that does not exist, so that no results are replaced."""
    path = Path(name)
    count = 1
    while path.exists() or path.with_name(f"{path.name}.unfinished").exists():
        count += 1
        path = Path(f"{name}-{count}")
    return path


@contextmanager
def interruptible(checkpoints: Path, hint: str) -> Iterator[None]:
    """Print a hint on how to resume where a run with a folder of checkpoints is interrupted in the block."""
    try:
        yield
    except KeyboardInterrupt:
        if not checkpoints.is_dir():
            raise
        click.echo(hint, err=True)
        sys.exit(INTERRUPTED)


# Terminal and progress ------------------------------------------------------------------------------------------------

#: Time between two lines on the progress without a terminal [s]. Doubling it halves the length of logs. Chosen.
_LINE_INTERVAL = 30.0


def is_interactive() -> bool:
    """Return whether a user can answer questions at a terminal."""
    return sys.stdin is not None and sys.stdin.isatty() and sys.stderr.isatty()


def terminal(*, stderr: bool = False, width: int | None = None) -> "Console":
    """Return the console of rich for tables and bars, which does not change texts."""
    from rich.console import Console

    return Console(stderr=stderr, width=width, highlight=False)


@contextmanager
def progress(what: str, seconds: float = math.nan) -> "Iterator[ProgressReporter]":
    """Show the progress of a computation and its remaining time: a bar on a terminal, else a line every 30 s.

    The block gets a function of a text, the finished fraction [1] and the remaining time [s]. Messages that are printed
    in the block appear above the bar, which is removed at the end.
    """
    from rollslip.planning.progress import ProgressTimer

    timer = ProgressTimer(seconds)
    if not sys.stderr.isatty():
        printed = timer.start

        def line(text: str, fraction: float = math.nan, left: float = math.nan) -> None:
            nonlocal printed
            timer.update(fraction, left)
            if timer.updated - printed >= _LINE_INTERVAL:
                printed = timer.updated
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

    class TimeLeftColumn(ProgressColumn):
        def render(self, task: Task) -> Text:
            return Text(timer.format_time_left())

    columns = (
        SpinnerColumn(),
        TextColumn("{task.description}", markup=False),
        BarColumn(20),
        TimeElapsedColumn(),
        TimeLeftColumn(),
    )

    class AboveBar(FileProxy):
        encoding = "utf-8"  # without an encoding click writes directly to the terminal, into the line of the bar

    console = terminal(stderr=True)
    shown = Progress(
        *columns, console=console, transient=True, redirect_stdout=False, redirect_stderr=False
    )
    with shown, ExitStack() as redirections:
        # output to a file or a pipe must not appear on the terminal of the bar
        if sys.stdout.isatty():
            redirections.enter_context(redirect_stdout(AboveBar(console, sys.stdout)))
        redirections.enter_context(redirect_stderr(AboveBar(console, sys.stderr)))
        task = shown.add_task(what, total=None)

        def show(text: str, fraction: float = math.nan, left: float = math.nan) -> None:
            timer.update(fraction, left)
            is_known = not math.isnan(fraction)
            shown.update(
                task,
                description=f"{what}: {text}",
                total=1.0 if is_known else None,
                completed=fraction if is_known else 0.0,
            )

        yield show


def print_json(value: object) -> None:
    """Print plain values as JSON."""
    click.echo(json.dumps(value, indent=2, allow_nan=False))


def print_either(as_json: bool, value: object, text: object) -> None:
    """Print plain values as JSON, or the text with the same content."""
    if as_json:
        print_json(value)
    else:
        click.echo(text)
