"""The command `rollslip pareto`, and what it prints before it runs."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

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

if TYPE_CHECKING:
    from rollslip_campaigns.pareto.candidates import Family


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
    from rollslip.cli import console
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
        print_family(made)
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


def print_family(family: "Family") -> None:
    """Print what will be run: the number of choices of each study by kind, rounds and references."""
    for study in family.studies:
        of = {kind: len(family.of(study, kind)) for kind in ("numerical", "modelling", "film", "reference")}
        finest = family.of(study, "reference")[0].resolution
        instants = f" and {finest.instants} instants" if (finest.instants or 1) > 1 else ""
        click.echo(
            f"{study}: {of['numerical']} numerical and {of['modelling']} modelling choices and {of['film']} films, "
            f"{family.rounds} round{'s' * (family.rounds != 1)} each, against {of['reference']} references, the finest "
            f"with {finest.slices} slices{instants}"
        )
    for note in family.notes:
        click.echo(note)
