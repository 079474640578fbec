"""What shows results: themselves with their answer, figures for publication, and a report.

Figures are drawn as the account of a study draws them.
"""

import base64
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import xarray as xr

from rollslip.errors import OutputError
from rollslip.results.accounts import account_of, answer, telling
from rollslip.results.answer import Answer, Note
from rollslip.results.curves import Curves
from rollslip.results.dataset import open_result
from rollslip.results.folder import take_in
from rollslip.results.style import as_svg, save_figures, styled
from rollslip.results.text import LAW, capitalise, collect_warnings
from rollslip.units import expect_results

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Figures", "Result", "plot", "report", "save_plots"]


class Result(xr.Dataset):  # type: ignore[no-untyped-call]
    """What a run gave: the dataset of its first study, which shows the answer of all, and holds every one of them.

    What is computed from it, by ``sel`` for example, shows itself as any dataset of xarray. ``attrs`` has all that is
    stored, as JSON where it is a structure.
    """

    __slots__ = ("_complete", "_held")
    _complete: Callable[[], dict[str, xr.Dataset]]
    _held: dict[str, xr.Dataset] | None

    @classmethod
    def of(
        cls, results: Mapping[str, xr.Dataset], complete: Callable[[], dict[str, xr.Dataset]]
    ) -> "Result":
        """Return the result of a run, given those of its studies, and what gives them with all that an answer needs.

        Notes, bands and costs take as long as many a study, so they are computed when somebody asks for them.
        """
        first = next(iter(results.values()))
        made = cls(first.data_vars, first.coords, first.attrs)
        made._held = None
        made._complete = complete
        return made

    @property
    def is_of_run(self) -> bool:
        """Whether it is what a run gave; what was computed from it is a dataset like any other."""
        try:  # not by hasattr, which looks for names among the attributes of a dataset, too
            object.__getattribute__(self, "_complete")
        except AttributeError:
            return False
        return True

    def complete(self) -> dict[str, xr.Dataset]:
        """Return the result of each study, with notes and bands, which are computed and stored once."""
        if not self.is_of_run:
            return {str(self.attrs.get("study", "result")): self}
        if self._held is None:
            self._held = self._complete()
            self._attrs = dict(next(iter(self._held.values())).attrs)
        return self._held

    @property
    def attrs(self) -> dict[Any, Any]:
        """All that is stored of the first study, with notes and bands."""
        if self.is_of_run:
            self.complete()
        found: dict[Any, Any] = xr.Dataset.attrs.fget(self)  # type: ignore[attr-defined]
        return found

    @attrs.setter
    def attrs(self, value: Mapping[Any, Any]) -> None:
        self._attrs = dict(value)

    @property
    def studies(self) -> xr.DataTree:
        """Every study that ran, by name."""
        return xr.DataTree.from_dict(self.complete())

    @property
    def answer(self) -> Answer:
        """What has to be known first, of all studies."""
        return answer(*self.complete().values())

    @property
    def notes(self) -> tuple[Note, ...]:
        """Laws that were left, each once, the worst first."""
        return self.answer.notes

    @property
    def warnings(self) -> tuple[str, ...]:
        """What a reader has to know, in sentences, each once; of laws the worst, of which `notes` has all."""
        return tuple(collect_warnings(self.complete().values())[0])

    @property
    def figures(self) -> "Figures":
        """Figures of all studies, by name."""
        drawn = Figures()
        for one in map(plot, self.complete().values()):
            drawn.update(one)
            drawn.captions |= one.captions
        return drawn

    def __repr__(self) -> str:
        return f"{self.answer}\n\n{super().__repr__()}" if self.is_of_run else super().__repr__()

    def _repr_html_(self) -> str:
        if not self.is_of_run:
            return str(super()._repr_html_())
        tree = self.studies._repr_html_()  # type: ignore[no-untyped-call]
        return f"{self.answer.html()}<details><summary>data of {', '.join(self.complete())}</summary>{tree}</details>"


class Figures(dict[str, "Figure"]):
    """Figures of a result by name, which a notebook shows below each other."""

    def __init__(self) -> None:
        super().__init__()
        #: What each shows, by the same names.
        self.captions: dict[str, str] = {}

    def __repr__(self) -> str:
        return f"figures: {', '.join(self) or 'none'}"

    def _repr_html_(self) -> str:
        with styled():
            drawn = {name: as_svg(figure, self.captions[name], "") for name, figure in self.items()}
        pictures = {  # each a document of its own: the same ids stand in all of them
            name: f"data:image/svg+xml;base64,{base64.b64encode(svg.encode()).decode()}"
            for name, svg in drawn.items()
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
    expect_results("plot", result)
    figures = Figures()
    with styled():
        for name, caption, figure in _drawn(result):
            figures[name] = figure
            figures.captions[name] = caption
    return figures


def report(
    *results: "xr.Dataset | str | Path", out: str | Path | None = None, overwrite: bool = False
) -> Path:
    """Write one HTML report of results, as ``rollslip report`` does.

    Parameters
    ----------
    *results : xarray.Dataset, str or Path
        Results, files that hold one each, or folders of them; of a run each of its studies is told.
    out : str or Path, optional
        The file; by default ``report.html`` beside results that stand in one folder, else in the current one.
    overwrite : bool
        Whether it may replace a report.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    OutputError
        If it exists, cannot be written, or a file is no result.
    """
    from rollslip.results.report import is_report, write_report

    if out is None:
        beside = {
            Path(one) if _is_folder(one) else Path(one).parent
            for one in results
            if isinstance(one, str | Path)
        }
        out = (beside.pop() if len(beside) == 1 else Path()) / "report.html"
    expect_results("report", *(one for one in results if not isinstance(one, str | Path)))
    if (out := Path(out)).exists() and not overwrite:
        raise OutputError(f"{out}: exists; name another --out, or --overwrite it")
    if out.exists() and not is_report(out):
        raise OutputError(
            f"{out}: is no report of rollslip, so it is not replaced; name another --out"
        )
    datasets = dict[str, xr.Dataset]()
    places = dict[str, str]()
    stored_too = [sorted(Path(one).glob("*.nc")) if _is_folder(one) else [one] for one in results]
    if not any(stored_too):
        raise OutputError("report: there is no result (.nc) in that folder; name that of a run")
    for number, given in enumerate((one for several in stored_too for one in several), 1):
        one = given if isinstance(given, xr.Dataset) else open_result(given)
        stored = one is not given
        place = str(given) if one is not given else f"result {number}"
        for study, dataset in (
            one.complete() if isinstance(one, Result) else {one.attrs["study"]: one}
        ).items():
            name = study if study not in datasets else place if stored else f"{study} of {place}"
            datasets[name] = dataset
            places[name] = place
    figures = {}
    with tempfile.TemporaryDirectory() as folder:
        for k, (name, dataset) in enumerate(datasets.items()):
            (own := Path(folder) / str(k)).mkdir()
            with telling(places[name]):
                figures[name] = save_plots(dataset, own)
        with telling(*dict.fromkeys(places.values())):
            write_report(datasets, figures, out)
    take_in(out)
    return out


def _is_folder(given: object) -> bool:
    return isinstance(given, str | Path) and Path(given).is_dir()


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
                yield (
                    f"{account.name}-{name}".replace("_", "-"),
                    capitalise(caption),
                    over_slip(result, str(name)),
                )
