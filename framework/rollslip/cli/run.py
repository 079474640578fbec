"""Commands about the studies of a scene: run them, print their plan, write a report of stored results."""

import sys
from collections.abc import Sequence
from pathlib import Path

import click

from rollslip.cli.app import (
    BAD_PLUGIN,
    BAD_SCENE,
    INTERRUPTED,
    NOT_CONVERGED,
    Results,
    forget,
    interruptible,
    json_option,
    print_json,
    progress,
    results_options,
    scene_of,
    set_option,
    study_option,
)


@click.command()
@click.argument("scene")
@study_option
@set_option
@results_options(resume=True)
@click.option("--verify", is_flag=True, help="Run at the finest too, and tell whether the plan kept its word.")
@json_option
def run(scene: str, study: str | None, changes: Sequence[str], verify: bool, results: Results) -> None:
    """Run the studies of SCENE, a shipped scene or a file, and write results, plots and on request a report."""
    from rollslip.cli import console
    from rollslip.planning.execution import execute
    from rollslip.planning.plan import plan
    from rollslip.planning.verification import verify as verified
    from rollslip.results.dataset import save
    from rollslip.results.words import verdict

    made = plan(scene_of(scene, changes), study)
    if not results.as_json:
        click.echo(console.headline(made))
    for sentence in made.foreseen:
        click.echo(f"note: {sentence}", err=True)
    results.go_to(f"{Path(scene).stem}-results")
    kept = results.kept()
    go_on = results.go_on(
        ["rollslip", "run", scene, *(["--study", study] if study else []), *(f"--set={c}" for c in changes)]
    )
    datasets = {}
    with interruptible(kept, go_on), results.folder() as folder:
        for name in made.studies:
            with progress(name) as show:
                datasets[name] = execute(made, name, kept=kept, progress=show)
            if verify and datasets[name].attrs.get("outcome", "finished") == "finished":
                with progress(f"{name} at the finest"):
                    datasets[name] = verified(made, name, datasets[name])
            save(datasets[name], folder / f"{name}.nc")
            if datasets[name].attrs.get("outcome") == "interrupted":
                break
        results.show(datasets, folder)
    outcomes = {dataset.attrs.get("outcome"): dataset for dataset in datasets.values()}
    if "interrupted" not in outcomes:
        forget(kept)
    if results.as_json:
        print_json(console.run_as_dict(made, datasets) | results.as_dict())
    else:
        for first in (told := verdict(datasets.values())):
            click.echo(first)
        for dataset in datasets.values():
            click.echo(console.findings(dataset, told))
            click.echo(console.kept(dataset))
        results.tell(*datasets.values())
    if "interrupted" in outcomes:
        click.echo(go_on, err=True)
        sys.exit(INTERRUPTED)
    if "failed" in outcomes:
        failed = outcomes["failed"].attrs
        click.echo(f"failed: {failed['outcome_message']}; what was computed is kept", err=True)
        sys.exit({"model": BAD_PLUGIN, "domain": BAD_SCENE}.get(failed["failed_by"], NOT_CONVERGED))


@click.command()
@click.argument("scene")
@study_option
@set_option
@click.option("--diff", "other", metavar="OTHER", help="Show only what the plan of another scene has otherwise.")
@json_option
def plan(scene: str, study: str | None, changes: Sequence[str], other: str | None, as_json: bool) -> None:
    """Print what will be modelled of SCENE, how finely, what is left out, and why.

    --set changes SCENE, not OTHER: --set operation.radial_load="9 kN" --diff SCENE shows what that value changes.
    """
    from rollslip.cli import console
    from rollslip.planning.plan import changed, part_as_dict, plan

    made = plan(scene_of(scene, changes), study)
    if other is not None:
        pairs = changed(made, plan(scene_of(other, ()), study))
        if as_json:
            parts = [[None if part is None else part_as_dict(part) for part in pair] for pair in pairs]
            print_json([{"this": this, "other": that} for this, that in parts])
        else:
            console.print_changed(pairs, scene, other)
    elif as_json:
        print_json(made.as_dict())
    else:
        click.echo(console.headline(made))
        console.print_plan(made)
        for sentence in made.foreseen:
            click.echo(f"note: {sentence}", err=True)


@click.command()
@click.argument("results", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--out", default="report.html", show_default=True, type=click.Path(path_type=Path), help="File.")
@click.option("--overwrite", is_flag=True, help="Replace the file, if it is a report.")
def report(results: Sequence[Path], out: Path, overwrite: bool) -> None:
    """Write one HTML report from stored RESULTS (.nc files)."""
    import tempfile

    from rollslip.errors import OutputError
    from rollslip.results.dataset import open_result, telling
    from rollslip.results.figures import plot
    from rollslip.results.report import is_report, write_report

    if out.exists() and not overwrite:
        raise OutputError(f"{out}: exists; name another --out, or --overwrite it")
    if out.exists() and not is_report(out):
        raise OutputError(f"{out}: is no report of rollslip, so it is not replaced; name another --out")
    datasets = {}
    for path in results:
        dataset = open_result(path)
        datasets[dataset.attrs["study"] if dataset.attrs["study"] not in datasets else str(path)] = dataset
    with tempfile.TemporaryDirectory() as folder:
        figures = {}
        for k, (name, dataset) in enumerate(datasets.items()):
            place = Path(folder) / str(k)
            place.mkdir()
            with telling(results[k]):
                figures[name] = plot(dataset, place)
        with telling(*results):
            write_report(datasets, figures, out)
    click.echo(f"written to {out}")
