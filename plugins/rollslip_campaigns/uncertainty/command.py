"""The command `rollslip uncertainty`."""

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
    warn,
)


@click.command()
@scene_argument
@click.option("--samples", metavar="N", type=click.IntRange(2), help="Samples of reserve and slips.  [default: 1024]")
@click.option("--until", metavar="H", type=float, help="Double samples until the interval's half width is H, a slip.")
@click.option("--probability", metavar="P", type=float, default=0.99, show_default=True, help="Of what is told.")
@click.option("--loads", metavar="N", type=click.IntRange(0), help="Samples of the least load.  [default: 64]")
@click.option("--indices", metavar="N", type=click.IntRange(0), default=0, help="Rows for Sobol indices, 2^k.")
@click.option("--seed", metavar="N", type=click.IntRange(0), default=0, help="Seed of the samples.")
@set_option
@engine_options
@results_options("Folder; goes on with what is in it.", overwrite=False)
@json_option
def uncertainty(
    scene: str,
    samples: int | None,
    until: float | None,
    probability: float,
    loads: int | None,
    indices: int,
    seed: int,
    changes: Sequence[str],
    engine: Mapping[str, object] | None,
    time_limit: str | None,
    results: Results,
) -> None:
    """Tell the reserve of drag, the steady slip and the least load of SCENE where its data scatter.

    What scatters is in the scene's table [uncertainty]; without one it is what its oil, its bearing and its
    models say of themselves. What the scene states, or --set, does not scatter.
    """
    from rollslip.errors import EngineError
    from rollslip.planning.plan import duration_range
    from rollslip.results.account import account_of
    from rollslip_campaigns.sweep.command import sweep_headline, sweep_planned
    from rollslip_campaigns.sweep.run import asked_engine
    from rollslip_campaigns.uncertainty.findings import failed
    from rollslip_campaigns.uncertainty.margin import expected_seconds, plan_margin, run_margin

    made = plan_margin(
        scene_of(scene, changes),
        samples=samples,
        until=until,
        probability=probability,
        loads=loads,
        indices=indices,
        seed=seed,
        engine=engine,
        time_limit=time_limit,
    )
    asked_engine(made.critical)  # refused before a folder is made
    warn(made.critical.unusual)
    results.go_to(f"{Path(scene).stem}-uncertainty")
    if not results.as_json:
        click.echo(sweep_headline(made.critical))
        sweeps = made.sweeps.values()
        click.echo("\n".join(dict.fromkeys(f"  {line}" for one in sweeps for line in sweep_planned(one))))
        for name, seconds in expected_seconds(made).items():
            click.echo(f"  {name}: {duration_range(seconds)} of one core")
    go_on = f"go on by the same command with --out {shlex.quote(str(results.target))}"
    try:
        with progress("uncertainty") as show:
            dataset = run_margin(
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
    results.show({"uncertainty": dataset}, results.target)
    account = account_of(dataset)
    if results.as_json:
        warnings = json.loads(dataset.attrs["warnings"])
        scene_told = {"scene": made.critical.given.source}
        print_json(scene_told | account.record(dataset) | {"warnings": warnings} | results.as_dict())
    else:
        click.echo("\n".join(f"  {line}" for line in account.lines(dataset)))
        results.tell(dataset)
    if failed(dataset):
        for name, counts in json.loads(dataset.attrs["points"]).items():
            if counts.keys() - {"ok"}:
                again = shlex.join(["rollslip", "sweep", "retry", str(results.target / name), "--failed"])
                click.echo(f"compute points without a result again by: {again}, then {go_on}", err=True)
        sys.exit(SOME_FAILED)
