"""The commands `rollslip validate` and `rollslip rank`."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from rollslip.cli.app import Results, json_option, print_json, progress, results_options

if TYPE_CHECKING:
    from rollslip_campaigns.validation.predictions import Predictions


_predictions_option = click.option(
    "--predictions",
    metavar="FILE.csv",
    multiple=True,
    type=click.Path(path_type=Path),
    help="What another program gives for one data set; may be repeated.",
)


@click.command()
@click.argument("data", metavar="[DATA]...", nargs=-1)
@click.option("--traction", metavar="A,B", default="", help="Traction models beside those of the data sets' scenes.")
@click.option("--film", metavar="A,B", default="", help="Film models beside those of the data sets' scenes.")
@click.option("--contact", metavar="A,B", default="", help="Contact models beside those of the data sets' scenes.")
@_predictions_option
@click.option("--form", metavar="FILE.csv", type=click.Path(path_type=Path), help="Write a file for such predictions.")
@click.option(
    "--samples", metavar="N", type=click.IntRange(0), default=128, show_default=True, help="Of what scatters."
)
@click.option("--seed", metavar="N", type=click.IntRange(0), default=0, help="Seed of the samples.")
@results_options()
@json_option
def validate(
    data: Sequence[str],
    traction: str,
    film: str,
    contact: str,
    predictions: Sequence[Path],
    form: Path | None,
    samples: int,
    seed: int,
    results: Results,
) -> None:
    """Hold models against data sets, by name or folder; by default all data sets that are installed.

    Calculated over measured with the uncertainty of both, statements that hold or do not, chi-square where it means
    something: a table, an atlas of figures, a report.
    """
    from rollslip.cli import console
    from rollslip.results.account import account_of
    from rollslip.results.dataset import save
    from rollslip_campaigns.validation.validate import plan_validation, run_validation

    if form is not None:
        _write_form(data, form)
        return
    plan = plan_validation(
        data,
        traction=traction,
        film=film,
        contact=contact,
        predictions=_predictions(data, predictions),
        samples=samples,
        seed=seed,
    )
    results.go_to("validation" if len(plan.sets) != 1 else f"{plan.sets[0].name}-validation")
    with results.folder() as folder:
        with progress("validate") as show:
            dataset = run_validation(plan, lambda share, text: show(text, share))
        save(dataset, folder / "validation.nc")
        results.show({"validation": dataset}, folder)
    if results.as_json:
        print_json(account_of(dataset).record(dataset) | results.as_dict())
        return
    console.print_found(dataset)
    results.tell(dataset)


@click.command()
@click.argument("data", metavar="DATA...", nargs=-1, required=True)
@click.option("--traction", metavar="A,B", default="", help="Traction laws.")
@click.option("--film", metavar="A,B", default="", help="Film laws; all combinations are ranked.")
@click.option("--contact", metavar="A,B", default="", help="Contact laws.")
@click.option("--parameters", metavar="NAME,NAME", default="", help="What is fitted to friction of rigs.")
@_predictions_option
@click.option("--seed", metavar="N", type=click.IntRange(0), default=0, help="Seed of what is drawn.")
@results_options()
@json_option
def rank(
    data: Sequence[str],
    traction: str,
    film: str,
    contact: str,
    parameters: str,
    predictions: Sequence[Path],
    seed: int,
    results: Results,
) -> None:
    """Rank laws by their errors on conditions of DATA that they were not fitted to.

    Parameters are fitted to friction on all conditions but one, and the law is scored on that one, for every condition
    in turn. What cannot be told with a confidence of 95 % is said to be so.
    """
    from rollslip.cli import console
    from rollslip.results.account import account_of
    from rollslip.results.dataset import save
    from rollslip_campaigns.validation.ranking import rank

    results.go_to("ranking" if len(data) != 1 else f"{Path(data[0]).name}-ranking")
    with results.folder() as folder:
        with progress("rank") as show:
            dataset = rank(
                data,
                traction=traction,
                film=film,
                contact=contact,
                parameters=parameters,
                predictions=_predictions(data, predictions),
                seed=seed,
                report=lambda share, text: show(text, share),
            )
        save(dataset, folder / "ranking.nc")
        results.show({"ranking": dataset}, folder)
    if results.as_json:
        print_json(account_of(dataset).record(dataset) | results.as_dict())
        return
    console.print_found(dataset)
    results.tell(dataset)


def _write_form(data: Sequence[str], path: Path) -> None:
    """Write a file for predictions of one data set."""
    from rollslip.files import whole_file
    from rollslip_campaigns.validation.predictions import form
    from rollslip_campaigns.validation.validate import measurement_named

    if len(data) != 1:
        raise click.UsageError("--form needs one data set")
    with whole_file(path) as partial:
        partial.write_text(form(measurement_named(data[0])), encoding="utf-8")
    click.echo(f"written: {path}; fill the column predicted, and give it back by --predictions {path}")


def _predictions(data: Sequence[str], paths: Sequence[Path]) -> "list[Predictions]":
    """Read files of predictions, each of the data set that it names, or of the only one."""
    from rollslip_campaigns.validation.predictions import data_set_of, read_predictions
    from rollslip_campaigns.validation.validate import measurement_named

    return [read_predictions(path, measurement_named(data_set_of(path, data))) for path in paths]
