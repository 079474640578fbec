"""The command ``rollslip explore``."""

import shlex
from pathlib import Path
from tempfile import TemporaryDirectory

import attrs
import click

from rollslip.cli.app import json_option, print_json, progress
from rollslip.cli.campaign import with_settings
from rollslip_campaigns.explorer import ExplorerSettings


@click.option(
    "--out",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="File.  [default: SCENE-explorer.html]",
)
@click.option("--overwrite", is_flag=True, help="Replace the file, if it is a page of rollslip.")
@json_option
def _explore(
    requested: ExplorerSettings, about: str, out: Path | None, overwrite: bool, as_json: bool
) -> None:
    from rollslip.cli.units import with_units
    from rollslip.errors import OutputError
    from rollslip.results.report import is_report
    from rollslip_campaigns.explorer.page import library

    target = out if out is not None else Path(f"{Path(about).stem}-explorer.html")
    if target.exists() and not overwrite:
        raise OutputError(f"{target}: exists; name another --out, or --overwrite it")
    if target.exists() and not is_report(target):
        raise OutputError(
            f"{target}: is not a page of rollslip and is not replaced; name another --out"
        )
    library()  # a missing library is reported before anything else
    requested = attrs.evolve(requested, out=target)
    planned = requested.plan()
    if not as_json:
        click.echo("\n".join(planned.messages))
    with progress("explore") as show, TemporaryDirectory() as folder:
        found = requested.run(planned, Path(folder), show, lambda text: None)
    if as_json:
        print_json({"scene": about, "file": str(target), **with_units(found)})
        return
    for line in found["messages"]:
        click.echo(f"  {line}")
    click.echo(f"written to {shlex.quote(str(target))}")


explore = click.command("explore")(with_settings(ExplorerSettings, _explore))
