"""The command `rollslip compare`, and what it prints before it runs."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from rollslip.cli.app import (
    SOME_FAILED,
    Results,
    json_option,
    print_json,
    progress,
    results_options,
    scene_argument,
    scene_of,
    set_option,
)

if TYPE_CHECKING:
    from rollslip_campaigns.comparison.comparison import Comparison


@click.command()
@scene_argument
@click.option("--traction", metavar="A,B", multiple=True, help="Traction models to compare.")
@click.option("--film", metavar="A,B", multiple=True, help="Film models to compare.")
@click.option("--contact", metavar="A,B", multiple=True, help="Contact models to compare.")
@click.option(
    "--reference",
    metavar="NAME",
    help="Traction that the others are held against; NAME,NAME for its film and contact too.",
)
@click.option("--study", metavar="STUDY", help="Study with friction curves; by default the first of the scene.")
@set_option
@results_options()
@json_option
def compare(
    scene: str,
    traction: Sequence[str],
    film: Sequence[str],
    contact: Sequence[str],
    reference: str | None,
    study: str | None,
    changes: Sequence[str],
    results: Results,
) -> None:
    """Run every combination of models on SCENE; compare friction, critical slip and cost.

    A model that is not composed of others takes the place of the hydrodynamic model where the scene's traction is a
    blend, such as lambda-blend, and of the film where the scene's film is a correction, such as inlet-correction; --set
    models.traction=NAME takes the blend out of the scene. What --reference does not name is the first of the
    comparison, and without it that is what the others are held against.
    """
    from rollslip.cli import console
    from rollslip.results.dataset import save
    from rollslip_campaigns.comparison.comparison import plan_comparison, run_comparison

    made = plan_comparison(
        scene_of(scene, changes),
        contact=",".join(contact),
        film=",".join(film),
        traction=",".join(traction),
        reference=reference,
        study=study,
    )
    if not results.as_json:
        click.echo(comparison_headline(made))
        print_comparison_plan(made)
    results.go_to(f"{Path(scene).stem}-comparison")
    with results.folder() as folder:
        with progress("compare", made.seconds) as show:
            dataset = run_comparison(made, show)
        save(dataset, folder / "compare.nc")
        results.show({"compare": dataset}, folder)
    if results.as_json:
        print_json(console.result_as_dict(dataset) | results.as_dict())
    else:
        console.print_found(dataset)
        results.tell(dataset)
    if any(dataset["status"] != "done"):
        sys.exit(SOME_FAILED)


def comparison_headline(comparison: "Comparison") -> str:
    """Return the first line of a comparison, with the models of all combinations."""
    from rollslip.cli.console import headline_of

    chosen = [one.choices for one in comparison.combinations.values()]
    models = dict.fromkeys((kind, c[kind].name, c[kind].full) for kind in chosen[0] for c in chosen)
    return headline_of(comparison.scene, models)


def print_comparison_plan(comparison: "Comparison") -> None:
    """Print what a comparison will run, with its size and cost as far as they can be told."""
    from rollslip.planning.plan import duration_range

    plans = comparison.plans.values()
    click.echo(
        f"{comparison.study} of {len(comparison.combinations)} combinations: {', '.join(comparison.combinations)}"
    )
    if comparison.exchanged:
        click.echo(comparison.exchanged)
    slices = sum(plan.evaluations for plan in plans)
    click.echo(f"about {slices} slices to evaluate, {duration_range(comparison.seconds)}")
