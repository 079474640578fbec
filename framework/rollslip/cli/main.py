"""The command line: all commands in one group, and errors as one sentence with an exit code."""

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


#: Groups of commands in the help: title, an example, names.
_GROUPS: Final = (
    ("Will it skid", "rollslip run gearbox", ("new", "run", "cases", "info", "plan")),
    ("What is better, and how far it may go", "rollslip compare gearbox --oil iso-vg-68,iso-vg-220",
     ("compare", "limit", "window", "uncertainty", "sweep", "supplement", "explore", "pareto")),
    ("Measurements", "rollslip validate published-slip", ("validate", "fit", "rank")),
    ("What stands behind it", "rollslip explain W11", ("explain", "models", "schema", "cite", "plugins", "doctor")),
    ("Files", "rollslip report results/*.nc", ("report", "export", "surrogate")),
)  # fmt: skip
_GROUPED: Final = [names for *_, names in _GROUPS]


class _Log(logging.Handler):
    """Writes the log to standard error, above a bar that is drawn there."""

    def emit(self, record: logging.LogRecord) -> None:
        """Write one record."""
        click.echo(self.format(record), err=True)


class _Commands(click.Group):
    """Built-in commands, and those of campaigns, which are imported when they are requested."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return all names."""
        return sorted({*self.commands, *campaigns()})

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Return a command by name; a built-in one before that of a campaign."""
        if cmd_name in self.commands or cmd_name not in campaigns():
            return super().get_command(ctx, cmd_name)
        from rollslip.cli.campaign import command_of

        command: click.Command = command_of(campaign(cmd_name))
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the requested command, or raise with similar names."""
        if args[0] in self.commands or args[0] in campaigns():
            return super().resolve_command(ctx, args)
        return self._listed().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the list of all commands in groups, each with an example."""
        listed = self._listed().commands
        others = sorted(set(listed).difference(*_GROUPED))
        for title, example, names in (*_GROUPS, ("Of other packages", "", others)):
            if known := [name for name in names if name in listed]:
                with formatter.section(title):
                    formatter.write_text(f"$ {example}" if example else "")
                    formatter.write_dl(
                        [(name, _first_sentence(listed[name].help or "")) for name in known]
                    )

    def _listed(self) -> click.Group:
        """Return all commands with their help, those of campaigns without their options."""
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
    help="Log progress to standard error: choices of the plan (info), steps, tables, plugins (debug).",
)
@click.pass_context
def cli(context: click.Context, level: str | None) -> None:
    """Slip of rollers and cage in cylindrical roller bearings."""
    if level is None:
        return
    logger = logging.getLogger("rollslip")
    handler = _Log()
    handler.setFormatter(logging.Formatter("%(levelname)s %(name)s: %(message)s"))
    context.call_on_close(partial(logger.setLevel, logger.level))  # the level of a host program
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


def _handle_interrupts(stack: ExitStack) -> list[int]:
    """Make sure that no interrupt is lost, and return a list to which interrupts are added.

    An interrupt in a finalizer, where Python ignores exceptions, is raised again outside. After an interrupt, errors in
    finalizers of incomplete objects are not reported, nor interrupts in compiled functions that cannot raise.
    """
    unraisable_hook = sys.unraisablehook
    exception_hook = sys.excepthook
    interrupts = list[int]()

    def on_interrupt(number: int, frame: Any) -> None:
        interrupts.append(number)
        signal.default_int_handler(number, frame)

    def interrupt_again() -> None:
        time.sleep(0.02)  # until the finalizer has ended
        _thread.interrupt_main()

    def on_unraisable(lost: Any) -> None:
        if issubclass(lost.exc_type, KeyboardInterrupt):
            _thread.start_new_thread(interrupt_again, ())
        elif not interrupts:
            unraisable_hook(lost)

    # another handler is that of a shell or a host program
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, on_interrupt)

    def on_exception(kind: type[BaseException], *details: Any) -> None:
        if not issubclass(kind, KeyboardInterrupt):
            exception_hook(kind, *details)

    sys.unraisablehook = on_unraisable
    sys.excepthook = on_exception
    stack.callback(setattr, sys, "unraisablehook", unraisable_hook)
    stack.callback(setattr, sys, "excepthook", exception_hook)
    return interrupts


class _Sink(io.FileIO):
    """The file of a standard stream, which discards data that cannot be written, and stores the first error.

    A full disk, or a reader which has ended, must not stop a computation whose results are written to other files.
    """

    lost: OSError | None = None

    def write(self, data: Any) -> int:
        """Write data, or discard them."""
        try:
            return super().write(data)
        except OSError as error:
            self.lost = self.lost or error
            return memoryview(data).nbytes


def _tolerant_stream(stream: Any, stack: ExitStack) -> tuple[Any, _Sink | None]:
    """Return a standard stream that never raises, and its file; streams of tests and host programs unchanged."""
    if stream is None:  # closed
        return stack.enter_context(open(os.devnull, "w", encoding="utf-8")), None
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
    stack.callback(text.close)
    return text, sink


#: Number of new objects after which Python collects garbage, in place of its 700. Halving it collects twice as often;
#: doubling it saves little. Chosen, because the imported libraries create 200,000 permanent objects.
_GC_THRESHOLD: Final = 200_000


def _collect_garbage_rarely(stack: ExitStack, arguments: Sequence[str] | None) -> None:
    """Collect garbage rarely, and not at the end of the process, which saves a third of a second per run."""
    if arguments is not None:  # restored for a host program
        stack.callback(gc.set_threshold, *gc.get_threshold())
    gc.set_threshold(_GC_THRESHOLD, *gc.get_threshold()[1:])
    atexit.register(gc.freeze)


def main(arguments: Sequence[str] | None = None) -> Any:
    """Run the command line and exit with its code; a host program passes arguments and continues afterwards."""
    own_handler = signal.getsignal(signal.SIGINT)
    try:
        code = _program(arguments)
    except KeyboardInterrupt:  # before the command started
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        click.echo("interrupted", err=True)
        code = INTERRUPTED
    if arguments is not None:
        signal.signal(signal.SIGINT, own_handler)
    elif code == INTERRUPTED:
        # a library that an interrupt left half imported may crash at the end of the interpreter
        atexit._run_exitfuncs()
        os._exit(code)
    sys.exit(code)


def _program(arguments: Sequence[str] | None) -> Any:
    """Run the command line with streams that never raise; return its exit code, and ignore later interrupts."""
    _prepare_descriptors_and_signals()
    with ExitStack() as stack:
        output, sink = _tolerant_stream(sys.stdout, stack)
        errors, _ = _tolerant_stream(sys.stderr, stack)
        stack.enter_context(redirect_stdout(output))
        stack.enter_context(redirect_stderr(errors))
        interrupts = _handle_interrupts(stack)
        _collect_garbage_rarely(stack, arguments)
        # matrices here are small: more threads would cost a quarter of a second of processor time per run
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
        try:
            code: Any = _run(arguments, interrupts)
        except SystemExit as leaving:
            code = leaving.code
            notes = getattr(leaving, "__notes__", ())
            if notes and code not in range(
                128, 160
            ):  # a model has called sys.exit, without a signal
                click.echo(f"sys.exit({code!r}) {'; '.join(notes)}", err=True)
                code = BAD_PLUGIN
        except KeyboardInterrupt:  # a second one, during the message on the first
            code = INTERRUPTED
        # the output is complete: a later interrupt would only print a traceback
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        if code == INTERRUPTED:
            # errors in finalizers of incomplete objects are not reported
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


def _prepare_descriptors_and_signals() -> None:
    """Open closed standard descriptors, and make termination signals raise, so that incomplete results are removed."""
    for descriptor in (0, 1, 2):
        try:
            os.fstat(descriptor)
        except OSError:  # closed by the shell: the next file would get this descriptor
            os.open(os.devnull, os.O_RDWR)
    for number in (getattr(signal, name, None) for name in ("SIGTERM", "SIGHUP", "SIGQUIT")):
        # nohup ignores SIGHUP
        if number is not None and signal.getsignal(number) == signal.SIG_DFL:
            signal.signal(number, _terminated)


def _run(arguments: Sequence[str] | None, interrupts: Sequence[int]) -> int:
    """Run the command line; return its exit code, after an error in one sentence."""
    try:
        cli.main(args=arguments, standalone_mode=False, prog_name="rollslip")
    except (KeyboardInterrupt, click.Abort, Exception) as error:
        if not interrupts and isinstance(error, Exception) and not isinstance(error, click.Abort):
            return _report_error(error)
        # an interrupt during an import may become another error
        click.echo("interrupted; nothing was left behind", err=True)
        return INTERRUPTED
    return OK


def _report_error(error: Exception) -> int:
    """Print an error as one sentence and return its exit code; raise it if it is a fault of rollslip."""
    if isinstance(error, click.ClickException):
        error.show()
        return error.exit_code
    if isinstance(error, RollslipError):
        click.echo(str(error), err=True)
        if isinstance(error, ConvergenceError):
            return NOT_CONVERGED
        is_plugin_fault = isinstance(error, PluginError) and not isinstance(error, UnknownNameError)
        return BAD_PLUGIN if is_plugin_fault else BAD_SCENE
    if isinstance(error, BrokenPipeError):
        return OK  # the reader of the output has ended
    if isinstance(error, ImportError):
        # where memory is short, libraries report that others are not installed
        text = f"a library cannot be imported: {error}; memory is too short, or it is damaged: install it again"
        click.echo(str(error) if error.name == "ROLLSLIP_SIMD" else text, err=True)
        return BAD_SCENE
    if wants_memory(error):
        click.echo(
            f"memory is too short ({describe_error(error)}); close other programs, or ask for less",
            err=True,
        )
        return BAD_SCENE
    if isinstance(error, OSError) and error.filename is not None:
        click.echo(
            f"{error.filename}: cannot be used ({error.strerror}); name another place", err=True
        )
        return BAD_SCENE
    notes = [note for note in getattr(error, "__notes__", ()) if note.startswith("raised by ")]
    if not notes or isinstance(error, OSError):
        raise error
    # the error of a third-party model
    click.echo(f"{type(error).__name__}: {error}; {notes[0]}", err=True)
    return BAD_PLUGIN
