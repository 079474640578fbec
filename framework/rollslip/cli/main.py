"""The command line as a whole: all commands in one group, and errors turned into one sentence and an exit code."""

import _thread
import atexit
import gc
import io
import logging
import os
import signal
import sys
import time
from collections.abc import Sequence
from contextlib import ExitStack, redirect_stderr, redirect_stdout
from functools import partial
from typing import Any, Final, NoReturn

import click

from rollslip.cli.app import BAD_PLUGIN, BAD_SCENE, INTERRUPTED, NOT_CONVERGED, OK
from rollslip.cli.catalogue import cite, doctor, explain, export, info, models, plugins, schema
from rollslip.cli.run import new, plan, report, run
from rollslip.errors import (
    ConvergenceError,
    PluginError,
    RollslipError,
    UnknownNameError,
    describe_error,
    wants_memory,
)
from rollslip.planning.campaign import campaign, campaigns, help_of

__all__ = ["cli", "main"]


#: Commands as people look for them: what for, an example, names.
_GROUPS: Final = (
    ("Will it skid", "rollslip run gearbox", ("new", "run", "info", "plan")),
    ("What is better, and how far it may go", "rollslip compare gearbox --oil iso-vg-68,iso-vg-220",
     ("compare", "limit", "uncertainty", "sweep", "explore", "pareto")),
    ("Measurements", "rollslip validate published-slip", ("validate", "fit", "rank")),
    ("What stands behind it", "rollslip explain W11", ("explain", "models", "schema", "cite", "plugins", "doctor")),
    ("Files", "rollslip report results/*.nc", ("report", "export")),
)  # fmt: skip
_GROUPED: Final = [names for *_, names in _GROUPS]


class _Log(logging.Handler):
    """Writes the log to standard error, above a bar that is drawn there."""

    def emit(self, record: logging.LogRecord) -> None:
        """Write one record."""
        click.echo(self.format(record), err=True)


class _Commands(click.Group):
    """Our commands, and those of campaigns, each imported when it is asked for."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return all names."""
        return sorted({*self.commands, *campaigns()})

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Return a command by name; ours before that of a campaign."""
        if cmd_name in self.commands or cmd_name not in campaigns():
            return super().get_command(ctx, cmd_name)
        from rollslip.cli.campaign import command_of

        command: click.Command = command_of(campaign(cmd_name))
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the command that is asked for, or name those that may have been meant."""
        known = args[0] in self.commands or args[0] in campaigns()
        return (
            super().resolve_command(ctx, args)
            if known
            else self._listed().resolve_command(ctx, args)
        )

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List all commands in groups, each with an example, and whole sentences."""
        listed = self._listed().commands
        left = set(self._listed().commands)
        for title, example, names in (
            *_GROUPS,
            ("Of other packages", "", sorted(left.difference(*_GROUPED))),
        ):
            if known := [name for name in names if name in listed]:
                with formatter.section(title):
                    formatter.write_text(f"$ {example}" if example else "")
                    formatter.write_dl(
                        [(name, _first_sentence(listed[name].help or "")) for name in known]
                    )

    def _listed(self) -> click.Group:
        """All commands, those of campaigns by what they say of themselves."""
        listed = dict(self.commands)
        for name in campaigns():
            try:
                summary = campaign(name).summary or help_of(campaign(name))
            except PluginError as error:
                summary = str(error)
            listed.setdefault(name, click.Command(name, help=summary))
        return click.Group(commands=listed)


def _first_sentence(help: str) -> str:
    return " ".join(help.partition("\n\n")[0].split()).partition(". ")[0].rstrip(".")


@click.group(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="rollslip")
@click.option(
    "--log",
    "level",
    type=click.Choice(("warning", "info", "debug"), case_sensitive=False),
    help="Tell on standard error what is done meanwhile: choices of the plan (info), steps, tables, plugins (debug).",
)
@click.pass_context
def cli(context: click.Context, level: str | None) -> None:
    """Slip of rollers and cage in cylindrical roller bearings."""
    if level is None:
        return
    logger = logging.getLogger("rollslip")
    handler = _Log()
    handler.setFormatter(logging.Formatter("%(levelname)s %(name)s: %(message)s"))
    context.call_on_close(partial(logger.setLevel, logger.level))  # a host goes on with its own
    context.call_on_close(partial(logger.removeHandler, handler))
    logger.addHandler(handler)
    logger.setLevel(level.upper())


for _command in (
    cite,
    doctor,
    explain,
    export,
    info,
    models,
    new,
    plan,
    plugins,
    report,
    run,
    schema,
):
    cli.add_command(_command)


def _terminated(number: int, *_: object) -> NoReturn:
    raise SystemExit(128 + number)


def _heard(into: ExitStack) -> list[int]:
    """Let no interrupt be lost: where Python ignores what is raised, in finalizers, it is raised again outside.

    Finalizers of what was half built when an interrupt came have nothing to tell; compiled functions that cannot raise
    show it before they ignore it. Returned is what comes.
    """
    before = sys.unraisablehook
    shown = sys.excepthook
    came = list[int]()

    def interrupted(number: int, frame: Any) -> None:
        came.append(number)
        signal.default_int_handler(number, frame)

    def again() -> None:
        time.sleep(0.02)  # until the finalizer has ended
        _thread.interrupt_main()

    def ignored(lost: Any) -> None:
        if issubclass(lost.exc_type, KeyboardInterrupt):
            _thread.start_new_thread(again, ())
        elif not came:
            before(lost)

    if (
        signal.getsignal(signal.SIGINT) is signal.default_int_handler
    ):  # else a shell or a host wants it otherwise
        signal.signal(signal.SIGINT, interrupted)

    def show(kind: type[BaseException], *of: Any) -> None:
        if not issubclass(kind, KeyboardInterrupt):
            shown(kind, *of)

    sys.unraisablehook = ignored
    sys.excepthook = show
    into.callback(setattr, sys, "unraisablehook", before)
    into.callback(setattr, sys, "excepthook", shown)
    return came


class _Sink(io.FileIO):
    """The file behind a standard stream; what it does not take is lost, the first time with its reason.

    A full disk or a reader who has left must not end a computation whose results go elsewhere.
    """

    lost: OSError | None = None

    def write(self, data: Any) -> int:
        """Write, or forget."""
        try:
            return super().write(data)
        except OSError as error:
            self.lost = self.lost or error
            return memoryview(data).nbytes


def _patient(stream: Any, into: ExitStack) -> tuple[Any, _Sink | None]:
    """Return a standard stream that never raises, and what it writes to; others, of tests and hosts, as they are."""
    if stream is None:  # closed
        return into.enter_context(open(os.devnull, "w", encoding="utf-8")), None
    if stream not in (sys.__stdout__, sys.__stderr__):
        return stream, None
    try:
        stream.flush()
        sink = _Sink(stream.fileno(), "w", closefd=False)
        text = io.TextIOWrapper(
            io.BufferedWriter(sink),
            stream.encoding,
            "backslashreplace",
            line_buffering=stream.line_buffering,
        )
    except (OSError, ValueError):  # it has no file
        return stream, None
    into.callback(text.close)
    return text, sink


#: New objects before Python looks for garbage again, in place of its 700: libraries make 200,000 that stay.
_OBJECTS: Final = 200_000


def _seldom_collected(into: ExitStack, arguments: Sequence[str] | None) -> None:
    """Look for garbage seldom, and not once more at the end, when all memory goes back: a third of a second a run."""
    if arguments is not None:  # for a host, whose next object makes Python look through all
        into.callback(gc.set_threshold, *gc.get_threshold())
    gc.set_threshold(_OBJECTS, *gc.get_threshold()[1:])
    atexit.register(gc.freeze)


def main(arguments: Sequence[str] | None = None) -> Any:
    """Run the command line and leave with its exit code; arguments are given by a host, which goes on afterwards."""
    heard = signal.getsignal(signal.SIGINT)
    try:
        code = _program(arguments)
    except KeyboardInterrupt:  # before the command began
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        click.echo("interrupted", err=True)
        code = INTERRUPTED
    if arguments is not None:
        signal.signal(signal.SIGINT, heard)
    elif (
        code == INTERRUPTED
    ):  # a library that was half imported when it came may not survive the interpreter's end
        atexit._run_exitfuncs()
        os._exit(code)
    sys.exit(code)


def _program(arguments: Sequence[str] | None) -> Any:
    """Run the command line between streams that never raise; return its exit code, and hear no interrupt any more."""
    for descriptor in (0, 1, 2):
        try:
            os.fstat(descriptor)
        except OSError:  # closed by the shell: the next file that is opened must not take its place
            os.open(os.devnull, os.O_RDWR)
    for number in (getattr(signal, name, None) for name in ("SIGTERM", "SIGHUP", "SIGQUIT")):
        if (
            number is not None and signal.getsignal(number) == signal.SIG_DFL
        ):  # nohup ignores the second
            signal.signal(number, _terminated)  # so that half-written results are removed
    with ExitStack() as stack:
        output, sink = _patient(sys.stdout, stack)
        errors, _ = _patient(sys.stderr, stack)
        stack.enter_context(redirect_stdout(output))
        stack.enter_context(redirect_stderr(errors))
        came = _heard(stack)
        _seldom_collected(stack, arguments)
        # matrices here are small: more threads would only wait, a quarter of a second of processor time in a run
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
        try:
            code: Any = _run(arguments, came)
        except SystemExit as leaving:
            code = leaving.code
            if (blamed := getattr(leaving, "__notes__", ())) and code not in range(
                128, 160
            ):  # no signal, but a model
                click.echo(f"sys.exit({code!r}) {'; '.join(blamed)}", err=True)
                code = BAD_PLUGIN
        except KeyboardInterrupt:  # a second one, while the first was told
            code = INTERRUPTED
        # all has been said and written: what comes now comes too late, and would only end in Python's words
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        if (
            code == INTERRUPTED
        ):  # what was half built when it came ends here, and its finalizers have nothing to tell
            sys.unraisablehook = lambda lost: None
            gc.collect()
        for stream in (output, errors):
            stream.flush()
        if (
            sink is not None
            and sink.lost is not None
            and not isinstance(sink.lost, BrokenPipeError)
        ):
            reason = sink.lost.strerror or sink.lost
            click.echo(
                f"standard output: cannot be written ({reason}); free some space, or write elsewhere",
                err=True,
            )
            code = code or BAD_SCENE
    return code


def _run(arguments: Sequence[str] | None, came: Sequence[int]) -> int:
    """Run the command line; return its exit code, after an error in one sentence."""
    try:
        cli.main(args=arguments, standalone_mode=False, prog_name="rollslip")
    except (KeyboardInterrupt, click.Abort, Exception) as error:
        if not came and isinstance(error, Exception) and not isinstance(error, click.Abort):
            return _told(error)
        # what is imported or built while an interrupt comes may turn it into an error of its own
        click.echo("interrupted; nothing was left behind", err=True)
        return INTERRUPTED
    return OK


def _told(error: Exception) -> int:
    """Tell an error in one sentence and return its exit code; raise it if it is a fault of this program."""
    try:
        raise error
    except click.ClickException as error:
        error.show()
        return error.exit_code
    except RollslipError as error:
        click.echo(str(error), err=True)
        if isinstance(error, ConvergenceError):
            return NOT_CONVERGED
        return (
            BAD_PLUGIN
            if isinstance(error, PluginError) and not isinstance(error, UnknownNameError)
            else BAD_SCENE
        )
    except ImportError as error:
        # where memory is short, libraries say of others too that these are not installed
        missing = f"a library cannot be imported: {error}; memory is too short, or it is damaged: install it again"
        click.echo(str(error) if error.name == "ROLLSLIP_SIMD" else missing, err=True)
        return BAD_SCENE
    except BrokenPipeError:
        return OK  # the reader of our output has left; there is nobody to tell
    except OSError as error:
        if wants_memory(error):
            return _short_of_memory(error)
        if error.filename is None:
            raise
        click.echo(
            f"{error.filename}: cannot be used ({error.strerror}); name another place", err=True
        )
        return BAD_SCENE
    except Exception as error:
        if wants_memory(error):
            return _short_of_memory(error)
        notes = [note for note in getattr(error, "__notes__", ()) if note.startswith("raised by ")]
        if not notes:
            raise
        click.echo(
            f"{type(error).__name__}: {error}; {notes[0]}", err=True
        )  # somebody's model, not a fault of ours
        return BAD_PLUGIN


def _short_of_memory(error: Exception) -> int:
    click.echo(
        f"memory is too short ({describe_error(error)}); close other programs, or ask for less",
        err=True,
    )
    return BAD_SCENE
