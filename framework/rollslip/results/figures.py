"""Figures of a result for publication, as the account of its study draws them."""

import base64
from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from rollslip.results.account import account_of, capital
from rollslip.results.curves import Curves
from rollslip.results.dataset import LAW
from rollslip.results.style import as_svg, save_figures, styled

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

__all__ = ["Figures", "plot", "save_plots"]


class Figures(dict[str, "Figure"]):
    """Figures of a result by name, which a notebook shows below each other.

    Attributes
    ----------
    captions : dict of str to str
        What each shows, by the same names.
    """

    def __init__(self) -> None:
        super().__init__()
        self.captions: dict[str, str] = {}

    def __repr__(self) -> str:
        return f"figures: {', '.join(self) or 'none'}"

    def _repr_html_(self) -> str:
        with styled():
            drawn = {name: as_svg(figure, self.captions[name], "") for name, figure in self.items()}
        pictures = {  # each a document of its own: the same ids stand in all of them
            name: f"data:image/svg+xml;base64,{base64.b64encode(svg.encode()).decode()}" for name, svg in drawn.items()
        }
        return "".join(
            f'<figure><img src="{picture}" alt="{escape(self.captions[name])}"/>'
            f"<figcaption>{escape(self.captions[name])}</figcaption></figure>"
            for name, picture in pictures.items()
        )


def plot(result: "xr.Dataset") -> Figures:
    """Draw the figures of a result, to look at or to go on with.

    Parameters
    ----------
    result : xarray.Dataset
        Result of a study or a campaign.

    Returns
    -------
    Figures
        Matplotlib figures by name, the study's first; none for a study without figures. They belong to no window:
        ``matplotlib.pyplot`` knows nothing of them, and a notebook shows them as they stand at the end of a cell.

    Examples
    --------
    >>> import rollslip
    >>> figures = rollslip.plot(rollslip.run("1032930-70C", "friction-curve"))
    >>> figures
    figures: friction-curve
    >>> figures["friction-curve"].axes[0].get_xlabel()
    'Slide–roll ratio $V/u$ [%]'
    """
    figures = Figures()
    with styled():
        for name, caption, figure in _drawn(result):
            figures[name], figures.captions[name] = figure, caption
    return figures


def save_plots(result: "xr.Dataset", folder: Path, formats: Sequence[str] = ("svg",)) -> list[Path]:
    """Draw the figures of a result into files.

    Parameters
    ----------
    result : xarray.Dataset
        Result of a study or a campaign.
    folder : Path
        Where the files go; it is made if it does not exist.
    formats : sequence of str
        Some of "svg", "pdf" and "png".

    Returns
    -------
    list of Path
        The files, named after the study: of effective friction, for example, the curves and, if the dataset has them,
        the single rollers ("-rollers") and the map ("-map"). Empty for a study without figures.

    Raises
    ------
    OutputError
        If a file cannot be written; then nothing is left of it.
    """
    return save_figures(_drawn(result), account_of(result).paragraph(result), folder, formats)


def _drawn(result: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Draw what the account of a result draws, then what laws give beside their columns, over the curves."""
    account = account_of(result)
    yield from account.figures(result)
    if Curves.of(result) is not None:
        for name, variable in result.data_vars.items():
            if LAW in variable.attrs:
                from rollslip.results.curve_figures import over_slip

                about = variable.attrs
                caption = f"{about['long_name']} over slip, by {about[LAW]!r}."
                yield f"{account.name}-{name}".replace("_", "-"), capital(caption), over_slip(result, str(name))
