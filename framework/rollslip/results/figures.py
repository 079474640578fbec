"""Results of a run for users: the datasets with their answer, figures for publication, and a report.

Figures are drawn by the account of a study.
"""

import base64
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import xarray as xr

from rollslip.errors import OutputError
from rollslip.results.accounts import account_of, answer, refuse_unreadable
from rollslip.results.answer import Answer, Note
from rollslip.results.curves import Curves
from rollslip.results.dataset import open_result
from rollslip.results.folder import add_to_manifest
from rollslip.results.style import MM, as_svg, save_figures, styled
from rollslip.results.text import LAW, capitalise, collect_warnings
from rollslip.units import expect_results, quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Figures", "Result", "plot", "report", "save_plots"]


class ResultArray(xr.DataArray):  # type: ignore[no-untyped-call]
    """A variable of a result; one with a single value converts to a number, whatever its dimensions."""

    __slots__ = ()

    def __float__(self) -> float:
        if self.size != 1:
            raise TypeError(
                f"{self.name} has {self.size} values; choose one by index, such as {self.name}[0]"
            )
        return float(self.to_numpy().item())


class Result(xr.Dataset):  # type: ignore[no-untyped-call]
    """The result of a run: the dataset of its first study, with the answer and the datasets of all studies.

    A dataset that is computed from it, for example by ``sel``, is an ordinary dataset of xarray. Attributes that are
    structures are JSON texts.
    """

    __slots__ = ("_complete", "_documented")
    _complete: Callable[[], dict[str, xr.Dataset]]
    #: Results of all studies, once they are complete.
    _documented: dict[str, xr.Dataset] | None

    @classmethod
    def from_studies(
        cls, results: Mapping[str, xr.Dataset], complete: Callable[[], dict[str, xr.Dataset]]
    ) -> "Result":
        """Return the result of a run.

        Notes, bands and costs take as long as many studies, so that they are computed when they are first needed.

        Parameters
        ----------
        results : mapping of str to xarray.Dataset
            Result of each study.
        complete : callable
            Returns the same with notes, bands and costs.
        """
        first = next(iter(results.values()))
        result = cls(first.data_vars, first.coords, first.attrs)
        result._documented = None
        result._complete = complete
        return result

    @property
    def is_of_run(self) -> bool:
        """Whether it is the result of a run; a dataset that is computed from one is not."""
        try:  # hasattr would look for the name among the attributes of the dataset, too
            object.__getattribute__(self, "_complete")
        except AttributeError:
            return False
        return True

    def complete(self) -> dict[str, xr.Dataset]:
        """Return the result of each study, with notes and bands, which are computed once."""
        if not self.is_of_run:
            return {str(self.attrs.get("study", "result")): self}
        if self._documented is None:
            self._documented = self._complete()
            self._attrs = dict(next(iter(self._documented.values())).attrs)
        return self._documented

    @property
    def attrs(self) -> dict[Any, Any]:
        """The attributes of the first study, with notes and bands."""
        if self.is_of_run:
            self.complete()
        attributes: dict[Any, Any] = xr.Dataset.attrs.fget(self)  # type: ignore[attr-defined]
        return attributes

    @attrs.setter
    def attrs(self, value: Mapping[Any, Any]) -> None:
        self._attrs = dict(value)

    def __getitem__(self, key: Any) -> Any:
        value = super().__getitem__(key)
        if isinstance(value, xr.DataArray):
            value.__class__ = ResultArray  # a copy would not share its attributes with the dataset
        return value

    @property
    def studies(self) -> xr.DataTree:
        """The results of all studies, by name."""
        return xr.DataTree.from_dict(self.complete())

    @property
    def answer(self) -> Answer:
        """The answer of all studies."""
        return answer(*self.complete().values())

    @property
    def notes(self) -> tuple[Note, ...]:
        """Notes on laws outside their ranges of validity, each once, the largest changes first."""
        return self.answer.notes

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of all studies as sentences, each once; of laws the most severe ones, all of them are in `notes`."""
        return tuple(collect_warnings(self.complete().values())[0])

    @property
    def figures(self) -> "Figures":
        """Figures of all studies, by name."""
        figures = Figures()
        for dataset in self.complete().values():
            of_study = plot(dataset)
            figures.update(of_study)
            figures.captions |= of_study.captions
        return figures

    def __repr__(self) -> str:
        text = super().__repr__()
        return f"{self.answer}\n\n{text}" if self.is_of_run else text

    def _repr_html_(self) -> str:
        if not self.is_of_run:
            return str(super()._repr_html_())
        tree = self.studies._repr_html_()  # type: ignore[no-untyped-call]
        return f"{self.answer.html()}<details><summary>data of {', '.join(self.complete())}</summary>{tree}</details>"


class Figures(dict[str, "Figure"]):
    """Figures of a result by name; a notebook shows all of them."""

    def __init__(self) -> None:
        super().__init__()
        #: Name -> caption.
        self.captions: dict[str, str] = {}

    def __repr__(self) -> str:
        return f"figures: {', '.join(self) or 'none'}"

    def _repr_html_(self) -> str:
        page = ""
        for name, figure in self.items():
            caption = escape(self.captions[name])
            with styled():
                svg = as_svg(figure, self.captions[name], "")
            # separate documents, because all have the same ids
            picture = f"data:image/svg+xml;base64,{base64.b64encode(svg.encode()).decode()}"
            page += f'<figure><img src="{picture}" alt="{caption}"/><figcaption>{caption}</figcaption></figure>'
        return page


def plot(result: "xr.Dataset | dict[str, xr.Dataset]", width: str | float | None = None) -> Figures:
    """Draw the figures of a result, to look at or to edit.

    Parameters
    ----------
    result : xarray.Dataset or dict
        Result of a study or a campaign; or several results of study dynamics by their names, which are drawn together
        and compared with the first.
    width : str or float, optional
        Width of all figures, as text with a unit, such as "120 mm", or in metres. By default figures of one panel have
        90 mm, those of several panels 190 mm, the columns of a journal; letters have 7 pt at any width.

    Returns
    -------
    Figures
        Matplotlib figures by name, the study's first; none for a study without figures. They are not
        registered in ``matplotlib.pyplot``, and a notebook shows them at the end of a cell.

    Examples
    --------
    >>> import rollslip
    >>> figures = rollslip.plot(rollslip.run("1032930-70C", "friction-curve"))
    >>> figures
    figures: friction-curve
    >>> figures["friction-curve"].axes[0].get_xlabel()
    'Slide–roll ratio $V/u$ [%]'
    """
    results = (result,) if not isinstance(result, dict) else tuple(result.values())
    expect_results("plot", *(results or [result]))
    account = account_of(results[0])
    figures = Figures()
    with styled():
        for name, caption, figure in (
            account.together(result) if isinstance(result, dict) else _drawn(result)
        ):
            if width is not None:
                figure.set_figwidth(1e3 * MM * quantity(width, "m"))
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
        Results, files of results, or folders of files; of a run all studies are reported.
    out : str or Path, optional
        The file; by default ``report.html`` in the folder of the results, or, for several folders, in the current one.
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

    expect_results("report", *(item for item in results if not isinstance(item, str | Path)))
    if out is None:
        folders = {
            Path(item) if _is_folder(item) else Path(item).parent
            for item in results
            if isinstance(item, str | Path)
        }
        out = (folders.pop() if len(folders) == 1 else Path()) / "report.html"
    out = Path(out)
    if out.exists() and not overwrite:
        raise OutputError(f"{out}: exists; name another --out, or --overwrite it")
    if out.exists() and not is_report(out):
        raise OutputError(
            f"{out}: is not a report of rollslip, so it is not replaced; name another --out"
        )
    datasets, sources = _named_datasets(results)
    figures = {}
    with tempfile.TemporaryDirectory() as folder:
        for k, (name, dataset) in enumerate(datasets.items()):
            target = Path(folder) / str(k)
            target.mkdir()
            with refuse_unreadable(sources[name]):
                figures[name] = save_plots(dataset, target)
        with refuse_unreadable(*dict.fromkeys(sources.values())):
            write_report(datasets, figures, out)
    add_to_manifest(out)
    return out


def _named_datasets(
    results: "Sequence[xr.Dataset | str | Path]",
) -> tuple[dict[str, xr.Dataset], dict[str, str]]:
    """Return the datasets of results, files and folders, and their sources, by names that are different for each."""
    items = list[Any]()
    for item in results:
        items += sorted(Path(item).glob("*.nc")) if _is_folder(item) else [item]
    if not items:
        raise OutputError("report: there is no result (.nc) in that folder; name that of a run")
    datasets = dict[str, xr.Dataset]()
    sources = dict[str, str]()
    for number, item in enumerate(items, 1):
        is_stored = not isinstance(item, xr.Dataset)
        result = open_result(item) if is_stored else item
        source = str(item) if is_stored else f"result {number}"
        studies = {result.attrs["study"]: result}
        if isinstance(result, Result):
            studies = result.complete()
        for study, dataset in studies.items():
            name = study
            if study in datasets:
                name = source if is_stored else f"{study} of {source}"
            datasets[name] = dataset
            sources[name] = source
    return datasets, sources


def _is_folder(item: object) -> bool:
    return isinstance(item, str | Path) and Path(item).is_dir()


def save_plots(result: "xr.Dataset", folder: Path, formats: Sequence[str] = ("svg",)) -> list[Path]:
    """Draw the figures of a result into files.

    Parameters
    ----------
    result : xarray.Dataset
        Result of a study or a campaign.
    folder : Path
        Folder of the files; it is created if it does not exist.
    formats : sequence of str
        Any of "svg", "pdf" and "png".

    Returns
    -------
    list of Path
        The files, named after the study: of effective friction, for example, the curves and, if the dataset has them,
        the single rollers ("-rollers") and the map ("-map"). Empty for a study without figures.

    Raises
    ------
    OutputError
        If a file cannot be written; then the file does not exist.
    """
    return save_figures(_drawn(result), account_of(result).paragraph(result), folder, formats)


def _drawn(result: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Yield the figures of the account of a result, then the outputs of laws over the slip of its curves."""
    account = account_of(result)
    yield from account.figures(result)
    if "measured" in result.attrs:
        from rollslip.results.curve_figures import measured_figure

        yield (
            f"{account.name}-measured",
            "Measured values and those calculated at their conditions.",
            measured_figure(result),
        )
    if Curves.from_dataset(result) is not None:
        for name, variable in result.data_vars.items():
            if LAW in variable.attrs:
                from rollslip.results.curve_figures import over_slip

                yield (
                    f"{account.name}-{name}".replace("_", "-"),
                    capitalise(
                        f"{variable.attrs['long_name']} over slip, by {variable.attrs[LAW]!r}."
                    ),
                    over_slip(result, str(name)),
                )
