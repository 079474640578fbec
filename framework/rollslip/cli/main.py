"""The command line as a whole: all commands in one group, and errors turned into one sentence and an exit code."""

import signal
import sys
from collections.abc import Sequence
from typing import Any, NoReturn

import click

from rollslip.cli.app import BAD_PLUGIN, BAD_SCENE, INTERRUPTED, NOT_CONVERGED, OK
from rollslip.cli.catalogue import cite, doctor, info, models, plugins, schema
from rollslip.cli.compare import compare, pareto
from rollslip.cli.fit import fit
from rollslip.cli.run import plan, report, run
from rollslip.cli.sweep import sweep
from rollslip.cli.uncertainty import uncertainty
from rollslip.errors import ConvergenceError, PluginError, RollslipError

__all__ = ["cli", "main"]


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="rollslip")
def cli() -> None:
    """Slip of rollers and cage in cylindrical roller bearings."""


for _command in (
    cite, compare, doctor, fit, info, models, pareto, plan, plugins, report, run, schema, sweep, uncertainty,
):  # fmt: skip
    cli.add_command(_command)


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
