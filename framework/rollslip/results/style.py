"""Style, colours and sizes of all figures, and their files.

- Text is text in SVG and PDF: it can be searched, selected, read aloud, and edited. An SVG names Matplotlib's own font
  and one of the same widths that most machines have; a PDF has its font embedded.
- The metadata of a file have caption and findings, which the report uses as caption and alternative text.
- The same dataset gives the same bytes: fixed salt for ids, no date, matplotlib's own defaults and its own font, so
  that a user's matplotlibrc has no effect. Figures are made without pyplot, so that they leave no state.
- Widths are those of one and of two columns of a journal page; letters have 7 pt in print.
- Numbers at ticks are plain letters: as mathematical text, in which matplotlib sets them for the sake of a power beside
  the axis, they look the same and take a third of the time of a figure.
"""

import functools
import io
import re
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rollslip.files import whole_file

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.artist import Artist
    from matplotlib.axis import Axis
    from matplotlib.colorbar import Colorbar
    from matplotlib.figure import Figure
    from matplotlib.ticker import LogLocator, ScalarFormatter

#: Okabe & Ito (2008), "Color universal design": the blue and the orange are told apart with every kind of colour
#: vision, and in grey. Orange and sky blue are darker than theirs, which have too little contrast for lines on white.
RING_COLOURS: Final = {"inner": "#0072B2", "outer": "#C07F00"}
#: The same palette for models that are compared.
MODEL_COLOURS: Final = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#C07F00", "#3A92C8")
#: Dashes of models that are compared, which are different in grey, too.
DASHES: Final = (
    "solid",
    (0, (4, 1.5)),
    (0, (1, 1)),
    (0, (5, 1.5, 1, 1.5)),
    (0, (5, 1.5, 1, 1.5, 1, 1.5)),
)
#: Nunez, Anderton & Renslow (2018): lightness rises evenly, for grey print and every kind of colour vision.
SEQUENTIAL: Final = "cividis"
#: Brewer (2003): for values of both signs, white at zero; blue and red differ for every kind of colour vision.
DIVERGING: Final = "RdBu_r"

#: Parameters of Matplotlib that differ from its defaults.
STYLE: Final[Mapping[str, Any]] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans", "Verdana", "sans-serif"],  # the first comes with matplotlib
    "font.size": 7.0,
    "axes.labelsize": 7.5,
    "axes.titlesize": 7.5,
    "axes.titlelocation": "left",
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.formatter.limits": (-3, 5),
    "axes.formatter.use_mathtext": True,
    "axes.formatter.useoffset": False,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "lines.linewidth": 1.4,
    "lines.dashed_pattern": (3.2, 1.6),
    "legend.frameon": False,
    "legend.fontsize": 7.0,
    "legend.handlelength": 2.4,
    "legend.labelspacing": 0.3,
    "legend.borderaxespad": 0.0,
    "svg.fonttype": "none",
    "pdf.fonttype": 42,
    "svg.hashsalt": "rollslip",
}

#: Style of markers.
MARKER: Final[Mapping[str, Any]] = {"marker": "o", "markersize": 4, "markeredgecolor": "white"}
#: Millimetre [inch].
MM: Final = 1 / 25.4
#: Size of a figure of one column of a journal page [inch].
SINGLE_COLUMN: Final = (90 * MM, 62 * MM)
#: Size of a figure of two columns [inch].
TWO_COLUMNS: Final = (190 * MM, 80 * MM)
#: Height of a row of the legend [inch], by which a figure grows so that its axes do not shrink.
ROW: Final = 4 * MM


def save_figures(
    figures: "Iterable[tuple[str, str, Figure]]",
    findings: str,
    folder: Path,
    formats: Sequence[str] = ("svg",),
) -> list[Path]:
    """Write figures and return the files.

    Parameters
    ----------
    figures : iterable of (str, str, Figure)
        Name, caption and figure; each has to be drawn during the iteration, in the style of this function.
    findings : str
        Findings of the result, as alternative text.
    folder : Path
        Folder of the files; it is created if it does not exist.
    formats : sequence of str
        Suffixes, of `FORMATS`.
    """
    files = []
    with styled():
        for name, caption, figure in figures:
            folder.mkdir(parents=True, exist_ok=True)
            for suffix in formats:
                files.append(folder / f"{name}.{suffix}")
                with whole_file(files[-1]) as partial:
                    FORMATS[suffix](figure, partial, caption, findings)
    return files


def styled() -> Any:
    """Return the context in which figures are drawn."""
    from matplotlib import style

    return style.context(["default", dict(STYLE)])


def as_svg(figure: "Figure", caption: str, findings: str) -> str:
    """Return a figure as SVG; the same figure gives the same text.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        The figure.
    caption : str
        Its caption, as metadata.
    findings : str
        Its alternative text, as metadata.
    """
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    set_plainly(figure)
    canvas: Any = FigureCanvasSVG(figure)
    with io.StringIO() as text:
        canvas.print_svg(  # savefig would draw every figure twice
            text,
            metadata={
                "Title": caption,
                "Description": findings,
                "Creator": "rollslip",
                "Date": None,
            },
        )
        return re.sub(
            r"<text>\s*(<tspan.*?</tspan>)\s*</text>",
            _join_letters,
            text.getvalue(),
            flags=re.DOTALL,
        )


def _join_letters(text: re.Match[str]) -> str:
    """Return a mathematical text in SVG with its letters, which Matplotlib writes one by one, joined to words."""
    letters = re.findall(
        r'<tspan x="([^"]*)" y="([^"]*)" style="([^"]*)">(.*?)</tspan>', text[1], re.DOTALL
    )
    joined: list[list[str]] = []
    for (y, style), some in groupby(
        sorted(letters, key=lambda letter: float(letter[0])), key=lambda letter: letter[1:3]
    ):
        run = list(some)
        # a space at the start of a word would be lost
        while run and joined and run[0][3].isspace():
            run.pop(0)
            joined[-1][3] += " "
        if run:
            joined.append(
                [run[0][0], y, style, "".join(letter for *_, letter in run).replace("\u00a0", " ")]
            )
    spans = "".join(
        f'<tspan x="{x}" y="{y}" style="{style}">{word}</tspan>' for x, y, style, word in joined
    )
    return f"<text>{spans}</text>"


def _svg(figure: "Figure", path: Path, caption: str, findings: str) -> None:
    """Write a figure as SVG."""
    path.write_text(as_svg(figure, caption, findings), encoding="utf-8", errors="backslashreplace")


def _pdf(figure: "Figure", path: Path, caption: str, findings: str) -> None:
    """Write a figure as PDF."""
    from matplotlib.backends.backend_pdf import FigureCanvasPdf

    set_plainly(figure)
    canvas: Any = FigureCanvasPdf(figure)
    canvas.print_pdf(
        path,
        metadata={
            "Title": caption,
            "Subject": findings,
            "Creator": "rollslip",
            "CreationDate": None,
        },
    )


def _png(figure: "Figure", path: Path, caption: str, findings: str) -> None:
    """Write a figure as PNG."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    set_plainly(figure)
    figure.set_dpi(_DPI)
    canvas: Any = FigureCanvasAgg(figure)
    canvas.print_png(
        path, metadata={"Title": caption, "Description": findings, "Software": "rollslip"}
    )


#: Suffix of a file -> function that writes it.
FORMATS: Final[Mapping[str, Any]] = {"svg": _svg, "pdf": _pdf, "png": _png}
#: Dots per inch of a PNG. Chosen: sharp in print and on fine screens; twice as many make files four times as large.
_DPI: Final = 300


def lay_out(figure: "Figure") -> None:
    """Lay out the axes of a figure once; later additions have to fit into them.

    Matplotlib would lay the figure out again when it is saved, which takes half the time of a figure.
    """
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    if isinstance(figure.get_layout_engine(), ConstrainedLayoutEngine):
        set_plainly(figure)
        FigureCanvasSVG(figure)
        figure.draw_without_rendering()
        figure.set_layout_engine("none")


#: Ratio of the ends of a logarithmic axis from which only powers of ten have labels. With a thousand times as much the
#: labels of an axis of 70 mm overlap.
_MAX_RATIO: Final = 2e3
#: Digits and minus -> superscripts.
_SUPERSCRIPTS: Final = str.maketrans("0123456789-\N{MINUS SIGN}", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁻")


@functools.cache
def _plain_ticks() -> "type[ScalarFormatter]":
    """Return a class of formatters that write numbers at ticks as plain text."""
    from matplotlib.ticker import ScalarFormatter

    class PlainTicks(ScalarFormatter):
        """Numbers at ticks, and the power beside the axis, without mathematical text, which is slow."""

        def __call__(self, x: float, pos: int | None = None) -> str:
            return super().__call__(x, pos).removeprefix(r"$\mathdefault{").removesuffix("}$")

        def get_offset(self) -> str:
            offset = super().get_offset()
            power = re.fullmatch(
                r"\$\\times\\mathdefault\{10\^\{(\S+)\}\}\\mathdefault\{\}\$", offset
            )
            return f"×10{power[1].translate(_SUPERSCRIPTS)}" if power else offset

    return PlainTicks


def set_plainly(figure: "Figure") -> None:
    """Write the numbers at the ticks of linear axes as plain text, unless they have a formatter of their own."""
    from matplotlib.ticker import ScalarFormatter

    second = [child for axes in figure.axes for child in axes.child_axes]
    for axes in (*figure.axes, *second):
        for axis in (axes.xaxis, axes.yaxis):
            if type(axis.get_major_formatter()) is ScalarFormatter:
                axis.set_major_formatter(_plain_ticks()())


@functools.cache
def _decades() -> "type[LogLocator]":
    """Return a class of locators with ticks at 1, 2, 5, 10 ..., or at powers of ten where these have no room."""
    from matplotlib.ticker import LogLocator

    class Decades(LogLocator):
        """Ticks of a logarithmic axis whose labels do not overlap."""

        def tick_values(self, vmin: float, vmax: float) -> Any:
            has_room = vmax < vmin * _MAX_RATIO or not vmin > 0.0
            self.set_params(subs=(1.0, 2.0, 5.0) if has_room else (1.0,), numticks=99)
            return super().tick_values(vmin, vmax)

    return Decades


def plain_decades(axis: "Axis") -> None:
    """Make an axis logarithmic, with ticks at the plain numbers 1, 2, 5, 10 ..."""
    from matplotlib.ticker import LogLocator, NullFormatter

    axis.axes.set(**{f"{axis.axis_name}scale": "log"})  # type: ignore[attr-defined]
    axis.set_major_locator(_decades()())
    axis.set_major_formatter("{x:g}")
    axis.set_minor_locator(LogLocator(subs=tuple(range(1, 10)), numticks=99))
    axis.set_minor_formatter(NullFormatter())


def unit_label(unit: str) -> str:
    """Return a unit for an axis: "°C" for "degC", "–" for a plain number.

    Examples
    --------
    >>> unit_label("degC"), unit_label("mm2/s"), unit_label("")
    ('°C', 'mm²/s', '–')
    """
    written = unit.replace("deg", "°").replace("m2", "m²").replace("m3", "m³").replace("um", "µm")
    return written if unit not in ("", "1") else "–"


def axis_label(variable: "xr.DataArray", symbol: str, unit: str, name: str = "") -> str:
    """Return the label of an axis: name, symbol and unit.

    Parameters
    ----------
    variable : xarray.DataArray
        The variable, with its ``long_name``.
    symbol : str
        Its symbol; may be empty.
    unit : str
        The unit that is shown.
    name : str
        A name in place of ``long_name``.
    """
    name = name or variable.attrs["long_name"]
    return f"{name[0].upper()}{name[1:]} {symbol} [{unit}]"


def against_zero(low: float, high: float) -> dict[str, Any]:
    """Return colour map and normalisation for values of both signs, white at zero; for one sign a sequential map.

    Both are arguments of `matplotlib.axes.Axes.contourf` and ``pcolormesh``.

    Parameters
    ----------
    low, high : float
        Range of the values; NaN if no value is known.
    """
    import matplotlib
    from matplotlib.colors import Normalize

    if not low <= high:  # no value is known
        low = 0.0
        high = 1.0
    if low < 0.0 < high:
        largest = max(-low, high)
        return {"cmap": matplotlib.colormaps[DIVERGING], "norm": Normalize(-largest, largest)}
    return {"cmap": light_to_dark(), "norm": Normalize(low, high)}


def seamless(bar: "Colorbar") -> None:
    """Remove the seams between the colours of a colour bar, and its outline."""
    bar.outline.set_visible(False)
    bar.solids.set_edgecolor("face")  # type: ignore[union-attr]


def light_to_dark() -> Any:
    """Return a colour map from light to dark, without the palest colours, which are not visible on white.

    It has so few colours that a colour bar is drawn and not embedded as a bitmap.
    """
    import matplotlib
    from matplotlib.colors import ListedColormap

    return ListedColormap(matplotlib.colormaps[SEQUENTIAL](np.linspace(0.8, 0.0, 40)))


# Dark pages ----------------------------------------------------------------------------------------------------
# On a dark page the lightness of colours is inverted between ground and ink, in Oklab (Ottosson 2020), whose lightness
# is close to perception: a colour that is darker than its neighbour on white is lighter than it on a dark page.

#: Colour of a dark page, in place of white.
GROUND: Final = "#15181c"
#: Colour of text on a dark page, in place of black.
INK: Final = "#e6e9ec"

#: Matrix of linear sRGB -> responses of the cones (Ottosson 2020).
_CONES: Final = np.array(
    [
        [0.4122214708, 0.5363325363, 0.0514459929],
        [0.2119034982, 0.6806995451, 0.1073969566],
        [0.0883024619, 0.2817188376, 0.6299787005],
    ]
)
#: Matrix of the cube roots of these responses -> Oklab (Ottosson 2020).
_OKLAB: Final = np.array(
    [
        [0.2104542553, 0.7936177850, -0.0040720468],
        [1.9779984951, -2.4285922050, 0.4505937099],
        [0.0259040371, 0.7827717662, -0.8086757660],
    ]
)
#: Exponent of the darkness on white. With 1 a pale orange would become a dark brown; with 0.55 every colour of the
#: palette has a contrast of 3 to the ground, as WCAG 2.2 (1.4.11) requires.
_LIFT: Final = 0.55
#: A colour of a line or an area in SVG.
_SVG_COLOUR: Final = re.compile(r"\b(fill|stroke): (#[0-9a-f]{6})\b")


def _oklab(colour: str) -> Any:
    """Return a colour "#rrggbb" in Oklab, (3,)."""
    encoded = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255.0
    linear = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    return _OKLAB @ np.cbrt(_CONES @ linear)


@functools.cache
def on_dark(colour: str) -> str:
    """Return the colour on a dark page in place of a colour "#rrggbb".

    Examples
    --------
    >>> on_dark("#ffffff"), on_dark("#000000")
    ('#15181c', '#e6e9ec')
    """
    lightness, *tone = _oklab(colour)
    ground = _oklab(GROUND)
    ink = _oklab(INK)
    # ground and ink have a faint tone, so that greys lie between both
    turned = ground + max(0.0, 1.0 - lightness) ** _LIFT * (ink - ground) + np.array([0.0, *tone])
    linear = np.linalg.solve(_CONES, np.linalg.solve(_OKLAB, turned) ** 3).clip(0.0, 1.0)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return "#" + "".join(f"{round(255.0 * part):02x}" for part in encoded)


def adapting(svgs: list[str]) -> str:
    """Return the style sheet that replaces the colours of drawings on a dark page.

    In print, on light pages, and without style sheets they are not changed.
    """
    colours = sorted(set().union(*(_SVG_COLOUR.findall(svg) for svg in svgs)))
    rules = "".join(
        f'figure [style*="{part}: {colour}"]{{{part}:{on_dark(colour)}!important}}'
        for part, colour in colours
    )
    # a drawing does not name black where it is the default
    return f"@media screen and (prefers-color-scheme: dark){{figure svg{{fill:{INK}}}{rules}}}\n"


# Frame of a figure ------------------------------------------------------------------------------------------------

#: Mean width of a letter of a legend [inch], measured at 7 pt: labels that are longer than their column are wrapped.
_LETTER: Final = 0.051
#: Width of the line before a label of a legend [inch].
_HANDLE: Final = 0.35


class Sheet:
    """A figure that is being drawn: its panels ``axes``, as Matplotlib returns them, and ``handles`` of its legend."""

    def __init__(
        self, size: tuple[float, float] = SINGLE_COLUMN, *panels: Any, **options: Any
    ) -> None:
        from matplotlib.figure import Figure

        self.figure = Figure(figsize=size, layout="constrained")
        self.axes: Any
        if panels and isinstance(panels[0], list):
            self.axes = self.figure.subplot_mosaic(*panels, **options)
        else:
            self.axes = self.figure.subplots(*panels, **options)
        self.handles: list[Artist] = []

    def line(self, x: Any, y: Any, label: str, axes: Any = None, **style: Any) -> None:
        """Draw a line, or points, with a label in the legend."""
        self.handles += (axes or self.axes).plot(x, y, label=label, **style)

    def mark(self, x: Any, y: Any, label: str, **style: Any) -> None:
        """Draw black points with a label in the legend."""
        self.line(x, y, label, linestyle="none", color="black", **style)

    def key(self, label: str, **style: Any) -> None:
        """Add a line to the legend only."""
        from matplotlib.lines import Line2D

        self.handles.append(Line2D([], [], label=label, **style))

    def done(
        self,
        x: str = "",
        y: str = "",
        *,
        columns: int = 1,
        height: float | None = None,
        title: str = "",
        **legend: Any,
    ) -> "Figure":
        """Return the figure, with the axes of a single panel labelled, and the legend above.

        Parameters
        ----------
        x, y : str
            Labels of the axes; empty for several panels.
        columns : int
            Columns of the legend.
        height : float, optional
            Height of the figure without the legend [inch].
        title : str
            Title of the legend.
        **legend
            Further arguments of `matplotlib.figure.Figure.legend`.
        """
        if x:
            self.axes.set_xlabel(x)
            self.axes.set_ylabel(y)
        per_column = -(-len(self.handles) // columns) or 1  # Matplotlib fills columns
        groups = [self.handles[k : k + per_column] for k in range(0, len(self.handles), per_column)]
        letters = sum(max(len(str(handle.get_label())) for handle in group) for group in groups)
        width = self.figure.get_figwidth()
        if width < _LETTER * letters + _HANDLE * len(groups):
            room = int((width / len(groups) - _HANDLE) / _LETTER)
            for handle in self.handles:
                handle.set_label(
                    textwrap.fill(str(handle.get_label()), room, break_on_hyphens=False)
                )
        rows = max(
            (sum(str(handle.get_label()).count("\n") + 1 for handle in group) for group in groups),
            default=0,
        )
        if self.handles:
            heading = {"title": title, "alignment": "left"} if title else {}
            self.figure.legend(
                handles=self.handles,
                ncols=columns,
                **{"loc": "outside upper left", **heading, **legend},
            )
        if height is None:
            height = self.figure.get_figheight()
        self.figure.set_figheight(height + ROW * (rows + bool(title)))
        return self.figure
