"""Figures of a result for publication, as the account of its study draws them."""

from pathlib import Path
from typing import TYPE_CHECKING

from rollslip.results.account import account_of
from rollslip.results.style import save_figures

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["plot"]


def plot(dataset: "xr.Dataset", folder: Path) -> list[Path]:
    """Draw the figures of a dataset as SVG files.

    Parameters
    ----------
    dataset : xarray.Dataset
        Result of a study.
    folder : Path
        Where the files go; it is made if it does not exist.

    Returns
    -------
    list of Path
        The files, named after the study: of effective friction, for example, the curves and, if the dataset has them,
        the single rollers ("-rollers") and the map ("-map"). Empty for a study without figures.
    """
    account = account_of(dataset)
    return save_figures(account.figures(dataset), account.paragraph(dataset), folder)
