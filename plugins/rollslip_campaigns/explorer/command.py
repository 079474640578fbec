"""The command ``rollslip explore``."""

import shlex
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import attrs
import click

from rollslip.cli.app import json_option, print_json, progress
from rollslip.cli.campaign import Printing, detail_options, with_settings
from rollslip_campaigns.explorer import ExplorerSettings


@click.option(
    "--out",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="File.  [default: SCENE-explorer.html]",
)
@click.option("--overwrite", is_flag=True, help="Replace the file, if it is a page of rollslip.")
@detail_options
@json_option
def _explore(
    requested: ExplorerSettings,
    about: str,
    out: Path | None,
    overwrite: bool,
    as_json: bool,
    printing: Printing,
) -> None:
    from rollslip.cli.units import with_units
    from rollslip.errors import OutputError
    from rollslip.results.report import is_report
    from rollslip_campaigns.explorer.page import library

    target = out or Path(f"{Path(about).stem}-explorer.html")
    if target.exists() and not overwrite:
        raise OutputError(f"{target}: exists; name another --out, or --overwrite it")
    if target.exists() and not is_report(target):
        raise OutputError(
            f"{target}: is not a page of rollslip and is not replaced; name another --out"
        )
    library()  # a missing library is reported before anything else
    requested = attrs.evolve(requested, out=target)
    planned = requested.plan()
    printing.log(planned.messages)
    with progress("explore") as show, TemporaryDirectory() as folder:
        found = requested.run(planned, Path(folder), show, partial(click.echo, err=True))
    if as_json:
        print_json({"scene": about, "file": str(target), **with_units(found)})
        return
    largest = max((error["largest"] or 0.0 for error in found["errors"].values()), default=0.0)
    checked = (
        f"interpolation error {100.0 * largest:.2g} % at most" if found["errors"] else "not checked"
    )
    click.echo(f"{shlex.quote(str(target))}: page of {found['points']} points, {checked}")
    for line in found["messages"]:
        click.echo(f"  {line}")


explore = click.command("explore")(with_settings(ExplorerSettings, _explore))
