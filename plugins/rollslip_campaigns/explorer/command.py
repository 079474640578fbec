"""The command `rollslip explore`."""

import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from rollslip.cli.app import engine_options, json_option, print_json, progress, scene_of, set_option

if TYPE_CHECKING:
    from rollslip_campaigns.sweep.run import Progress


@click.command()
@click.argument("scene")
@click.option(
    "--over",
    "overs",
    metavar="KEY=VALUES",
    multiple=True,
    help="What moves: LOW:HIGH or LOW:HIGH:NODES with units, or models A,B; by default load, speed, temperature, "
    "clearance and the law of traction.",
)
@click.option("--checks", metavar="N", type=click.IntRange(0), default=24, show_default=True, help="Random places at "
              "which it is held against runs, for each combination of models.")  # fmt: skip
@set_option
@engine_options
@click.option("--out", metavar="FILE", type=click.Path(path_type=Path), help="File.  [default: SCENE-explorer.html]")
@click.option("--overwrite", is_flag=True, help="Replace the file, if it is a page of rollslip.")
@json_option
def explore(
    scene: str,
    overs: Sequence[str],
    checks: int,
    changes: Sequence[str],
    engine: Mapping[str, object] | None,
    time_limit: str | None,
    out: Path | None,
    overwrite: bool,
    as_json: bool,
) -> None:
    """Write a page in which load, speed, temperature, clearance and models of SCENE move by sliders.

    Effective friction, loads and the slip of running away follow. They are computed beforehand on a grid; the page
    says how far it is off between the nodes. It needs the extra [explorer].
    """
    from rollslip.errors import OutputError
    from rollslip.results.report import is_report
    from rollslip_campaigns.explorer.definition import plan_explorer
    from rollslip_campaigns.explorer.explorer import explore
    from rollslip_campaigns.explorer.page import library
    from rollslip_campaigns.sweep.command import sweep_progress
    from rollslip_campaigns.sweep.sampling import parse_overs

    target = out if out is not None else Path(f"{Path(scene).stem}-explorer.html")
    if target.exists() and not overwrite:
        raise OutputError(f"{target}: exists; name another --out, or --overwrite it")
    if target.exists() and not is_report(target):
        raise OutputError(f"{target}: is no page of rollslip, so it is not replaced; name another --out")
    library()  # refused before anything is computed
    planned = plan_explorer(scene_of(scene, changes), parse_overs(overs), checks=checks)
    if not as_json:
        for dial in planned.dials:
            click.echo(f"  {dial.told}")
        for key, names in planned.choices.items():
            click.echo(f"  {key}: {', '.join(names)}")
        click.echo(f"  {planned.size} points, {checks} random ones for each combination of models among them")
    with progress("explore") as show:

        def told(now: "Progress") -> None:
            show(sweep_progress(now))

        found = explore(planned, out=target, engine=engine, time_limit=time_limit, report=told)
    if as_json:
        print_json({"scene": scene, "file": str(target), **found})
        return
    for line in found["told"]:
        click.echo(f"  {line}")
    click.echo(f"written to {shlex.quote(str(target))}")
