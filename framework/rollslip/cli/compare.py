"""Commands that hold models and numerical choices against each other: compare, pareto."""

import sys
from collections.abc import Sequence
from pathlib import Path

import click

from rollslip.cli.app import (
    SOME_FAILED,
    Results,
    forget,
    interruptible,
    json_option,
    print_json,
    progress,
    results_options,
    scene_argument,
    scene_of,
    set_option,
    study_option,
)


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
    from rollslip.cli import console, planned
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
        click.echo(planned.comparison_headline(made))
        planned.print_comparison_plan(made)
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


@click.command()
@scene_argument
@study_option
@set_option
@click.option(
    "--choices", metavar="A,B", multiple=True, help="What may differ, such as slices,instants; by default all there is."
)
@click.option("--traction", metavar="A,B", multiple=True, help="Traction models to choose from.")
@click.option("--film", metavar="A,B", multiple=True, help="Film models to choose from.")
@click.option("--rounds", default=5, show_default=True, help="How often each choice is timed.")
@results_options(resume=True)
@json_option
def pareto(
    scene: str,
    study: str | None,
    changes: Sequence[str],
    choices: Sequence[str],
    traction: Sequence[str],
    film: Sequence[str],
    rounds: int,
    results: Results,
) -> None:
    """Hold error against cost for the studies of SCENE: a family of choices, and the front that none of them passes.

    What may differ: slices, quadrature, instants, table_tolerance, integrator, integrator_tolerance, compiled (NumPy in
    its place), traction, film, friction. Errors of numerical choices are against the finest of the same models;
    other models differ from the exact one.
    """
    from rollslip.cli import console, planned
    from rollslip.results.dataset import save
    from rollslip_campaigns.pareto.candidates import plan_family
    from rollslip_campaigns.pareto.pareto import run_family

    made = plan_family(
        scene_of(scene, changes),
        study=study,
        choices=",".join(choices),
        traction=",".join(traction),
        film=",".join(film),
        rounds=rounds,
    )
    if not results.as_json:
        click.echo(console.headline(made.plan))
        planned.print_family(made)
    results.go_to(f"{Path(scene).stem}-pareto")
    kept = results.kept()
    given = {"choices": choices, "traction": traction, "film": film, "set": changes}
    again = ["rollslip", "pareto", scene, *(["--study", study] if study else [])]
    again += [f"--{name}={value}" for name, values in given.items() for value in values]
    go_on = results.go_on([*again, f"--rounds={rounds}"])
    with interruptible(kept, go_on), results.folder() as folder:
        with progress("pareto") as show:
            dataset = run_family(made, kept, lambda share, left, text: show(text, share, left))
        save(dataset, folder / "pareto.nc")
        results.show({"pareto": dataset}, folder)
    forget(kept)
    if results.as_json:
        print_json(console.result_as_dict(dataset) | results.as_dict())
    else:
        console.print_found(dataset)
        results.tell(dataset)
    if any(dataset["status"] != "done"):
        sys.exit(SOME_FAILED)
