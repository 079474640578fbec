"""The command `rollslip limit`."""

import json
import shlex
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import click

from rollslip.cli.app import (
    INTERRUPTED,
    SOME_FAILED,
    Results,
    engine_options,
    json_option,
    print_json,
    progress,
    results_options,
    scene_argument,
    scene_of,
    set_option,
    study_option,
    warn,
)


@click.command()
@scene_argument
@click.option(
    "--over",
    "overs",
    metavar="KEY=LOW:HIGH",
    multiple=True,
    required=True,
    help="What moves, with units; LOW:HIGH:COUNT says how many values are computed first.  [default: 9]",
)
@click.option("--keep", metavar="OUTPUT<=VALUE", required=True, help="The limit of a result, or OUTPUT>=VALUE.")
@click.option("--within", metavar="SHARE", type=float, default=0.01, show_default=True, help="How exactly it is told.")
@study_option
@set_option
@engine_options
@results_options("Folder; goes on with what is in it.", overwrite=False)
@json_option
def limit(
    scene: str,
    overs: Sequence[str],
    keep: str,
    within: float,
    study: str | None,
    changes: Sequence[str],
    engine: Mapping[str, object] | None,
    time_limit: str | None,
    results: Results,
) -> None:
    """Search where a result of SCENE passes a limit while one quantity moves.

    The gentlest run-up that keeps a slip, for example, or the drop of load that skids.
    """
    from rollslip.errors import EngineError
    from rollslip.results.account import account_of
    from rollslip_campaigns.limit.limit import plan_limit, run_limit
    from rollslip_campaigns.sweep.command import sweep_headline
    from rollslip_campaigns.sweep.run import asked_engine
    from rollslip_campaigns.sweep.sampling import parse_overs

    over = {
        key: ",".join(map(str, value)) if isinstance(value, list) else value if isinstance(value, str) else str(value)
        for key, value in parse_overs(overs).items()
    }
    made = plan_limit(
        scene_of(scene, changes), over, keep, study=study, within=within, engine=engine, time_limit=time_limit
    )
    asked_engine(made.sweep)  # refused before a folder is made
    warn(made.sweep.unusual)
    results.go_to(f"{Path(scene).stem}-limit")
    if not results.as_json:
        click.echo(sweep_headline(made.sweep))
        click.echo("\n".join(f"  {line}" for line in made.told))
    go_on = f"go on by the same command with --out {shlex.quote(str(results.target))}"
    try:
        with progress("limit") as show:
            dataset = run_limit(
                made,
                results.target,
                said=lambda text: click.echo(f"  {text}", err=results.as_json),
                report=lambda now: show(*now.told),
            )
    except KeyboardInterrupt:
        click.echo(f"interrupted; what was done is kept; {go_on}", err=True)
        sys.exit(INTERRUPTED)
    except EngineError as error:
        raise EngineError(f"{error}\nwhat was done is kept; {go_on}") from error
    results.show({"limit": dataset}, results.target)
    account = account_of(dataset)
    if results.as_json:
        warnings = json.loads(dataset.attrs["warnings"])
        told = {"scene": made.sweep.given.source} | account.record(dataset)
        print_json(told | {"warnings": warnings} | results.as_dict())
    else:
        click.echo("\n".join(f"  {line}" for line in account.lines(dataset)))
        results.tell(dataset)
    if (dataset["status"].to_numpy() != "ok").any():
        click.echo(f"points that failed are tried again by the same command; {go_on}", err=True)
        sys.exit(SOME_FAILED)
