"""The command `rollslip fit`."""

from pathlib import Path

import click

from rollslip.cli.app import Results, json_option, print_json, progress, results_options


@click.command()
@click.argument("data", metavar="DATA.csv", type=click.Path(path_type=Path))
@click.option("--parameters", metavar="NAME,NAME", required=True, help="What to fit, separated by commas.")
@click.option("--traction", metavar="MODEL", help="Traction model, by default that of the rig file.")
@click.option("--film", metavar="MODEL", help="Film model, by default that of the rig file.")
@click.option(
    "--rig", metavar="RIG.toml", type=click.Path(path_type=Path), help="Rig file, by default rig.toml beside the data."
)
@results_options(plots="Write data and oil only.")
@json_option
def fit(
    data: Path,
    parameters: str,
    traction: str | None,
    film: str | None,
    rig: Path | None,
    results: Results,
) -> None:
    """Fit parameters of oil and traction model to DATA of a traction rig, and write results, plots and an oil."""
    from rollslip.cli import console
    from rollslip.results.account import account_of
    from rollslip.results.dataset import save
    from rollslip_campaigns.fit.findings import headline
    from rollslip_campaigns.fit.fit import fit
    from rollslip_campaigns.fit.oil import write_oil

    results.go_to(f"{data.stem}-fit")
    with results.folder() as folder:
        with progress("fit") as show:
            dataset = fit(data, parameters=parameters, traction=traction, film=film, rig=rig, report=show)
        save(dataset, folder / "fit.nc")
        write_oil(dataset, folder / f"{data.stem}.toml")
        results.show({"fit": dataset}, folder)
    if results.as_json:
        print_json(account_of(dataset).record(dataset) | results.as_dict())
        return
    click.echo(headline(dataset))
    console.print_found(dataset)
    results.tell(dataset)
