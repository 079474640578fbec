"""What the figures of all studies share: style, colours, sizes, and how they become files.

- Text is text in SVG and PDF: it can be searched, selected, read aloud, and edited. An SVG names Matplotlib's own font
  and one of the same widths that most machines have; a PDF brings its font along.
- The metadata of a file hold caption and findings, which the report uses as caption and alternative text.
- The same dataset gives the same bytes: fixed salt for ids, no date, matplotlib's own defaults and its own font, so
  that nobody's matplotlibrc has a say. Figures are made without pyplot, so that no state outlives them.
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
    from matplotlib.ticker import ScalarFormatter

#: Okabe & Ito (2008), "Color universal design": the blue and the orange are told apart with every kind of colour
#: vision, and in grey. Orange and sky blue are darker than theirs, which have too little contrast for lines on white.
RING_COLOURS: Final = {"inner": "#0072B2", "outer": "#C07F00"}
#: The same palette for models that are compared, and dashes that tell them apart in grey.
MODEL_COLOURS: Final = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#C07F00", "#3A92C8")
DASHES: Final = (
    "solid",
    (0, (4, 1.5)),
    (0, (1, 1)),
    (0, (5, 1.5, 1, 1.5)),
    (0, (5, 1.5, 1, 1.5, 1, 1.5)),
)
#: Nunez, Anderton & Renslow (2018): lightness rises evenly, for grey print and every kind of colour vision.
SEQUENTIAL: Final = "cividis"
#: Brewer (2003): for what has a sign, white at zero; blue and red are told apart with every kind of colour vision.
DIVERGING: Final = "RdBu_r"

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

MARKER: Final[Mapping[str, Any]] = {"marker": "o", "markersize": 4, "markeredgecolor": "white"}
MM: Final = 1 / 25.4
SINGLE_COLUMN: Final = (90 * MM, 62 * MM)
TWO_COLUMNS: Final = (190 * MM, 80 * MM)
#: Height of a row of the legend, by which a figure grows so that its axes do not shrink.
ROW: Final = 4 * MM


def save_figures(
    figures: "Iterable[tuple[str, str, Figure]]",
    findings: str,
    folder: Path,
    formats: Sequence[str] = ("svg",),
) -> list[Path]:
    """Write figures, given as name, caption and figure; they have to be drawn while they are iterated."""
    files = []
    with styled():
        for name, caption, figure in figures:
            folder.mkdir(parents=True, exist_ok=True)
            for one in formats:
                files.append(folder / f"{name}.{one}")
                with whole_file(files[-1]) as partial:
                    FORMATS[one](figure, partial, caption, findings)
    return files


def styled() -> Any:
    """Return the context in which figures are drawn."""
    from matplotlib import style

    return style.context(["default", dict(STYLE)])


def as_svg(figure: "Figure", caption: str, findings: str) -> str:
    """Return a figure as SVG; it is the same text whenever it is the same figure."""
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    set_plainly(figure)
    canvas: Any = FigureCanvasSVG(figure)
    with io.StringIO() as text:
        canvas.print_svg(  # savefig draws every figure once more before
            text,
            metadata={
                "Title": caption,
                "Description": findings,
                "Creator": "rollslip",
                "Date": None,
            },
        )
        return re.sub(
            r"<text>\s*(<tspan.*?</tspan>)\s*</text>", _in_words, text.getvalue(), flags=re.DOTALL
        )


def _in_words(text: re.Match[str]) -> str:
    """Put the letters of mathematical text, which matplotlib writes one by one, together to words."""
    letters = re.findall(
        r'<tspan x="([^"]*)" y="([^"]*)" style="([^"]*)">(.*?)</tspan>', text[1], re.DOTALL
    )
    words: list[list[str]] = []
    for (y, style), some in groupby(
        sorted(letters, key=lambda one: float(one[0])), key=lambda one: one[1:3]
    ):
        run = list(some)
        while (
            run and words and run[0][3].isspace()
        ):  # a space that begins a word would be swallowed
            run.pop(0)
            words[-1][3] += " "
        if run:
            words.append(
                [run[0][0], y, style, "".join(letter for *_, letter in run).replace("\u00a0", " ")]
            )
    said = "".join(
        f'<tspan x="{x}" y="{y}" style="{style}">{word}</tspan>' for x, y, style, word in words
    )
    return f"<text>{said}</text>"


def _svg(figure: "Figure", path: Path, caption: str, findings: str) -> None:
    path.write_text(as_svg(figure, caption, findings), encoding="utf-8")


def _pdf(figure: "Figure", path: Path, caption: str, findings: str) -> None:
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
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    set_plainly(figure)
    figure.set_dpi(_DPI)
    canvas: Any = FigureCanvasAgg(figure)
    canvas.print_png(
        path, metadata={"Title": caption, "Description": findings, "Software": "rollslip"}
    )


#: What figures are written as.
FORMATS: Final[Mapping[str, Any]] = {"svg": _svg, "pdf": _pdf, "png": _png}
#: Dots per inch of a PNG: sharp in print at its size, and on screens that are fine.
_DPI: Final = 300


def lay_out(figure: "Figure") -> None:
    """Place the axes of a figure, once; what is added later has to find room in them.

    Matplotlib would lay it out again when it is saved, at the price of half a figure.
    """
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    if isinstance(figure.get_layout_engine(), ConstrainedLayoutEngine):
        set_plainly(figure)
        FigureCanvasSVG(figure)
        figure.draw_without_rendering()
        figure.set_layout_engine("none")


_RAISED: Final = str.maketrans("0123456789-\N{MINUS SIGN}", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁻")


@functools.cache
def _plain_ticks() -> "type[ScalarFormatter]":
    from matplotlib.ticker import ScalarFormatter

    class PlainTicks(ScalarFormatter):
        """Numbers and the power beside the axis without mathematical text, which is slow to set."""

        def __call__(self, x: float, pos: int | None = None) -> str:
            return super().__call__(x, pos).removeprefix(r"$\mathdefault{").removesuffix("}$")

        def get_offset(self) -> str:
            said = super().get_offset()
            power = re.fullmatch(
                r"\$\\times\\mathdefault\{10\^\{(\S+)\}\}\\mathdefault\{\}\$", said
            )
            return f"×10{power[1].translate(_RAISED)}" if power else said

    return PlainTicks


def set_plainly(figure: "Figure") -> None:
    """Set the numbers at the ticks of linear axes as plain letters, unless somebody has chosen what stands there."""
    from matplotlib.ticker import ScalarFormatter

    second = [child for axes in figure.axes for child in axes.child_axes]
    for axes in (*figure.axes, *second):
        for axis in (axes.xaxis, axes.yaxis):
            if type(axis.get_major_formatter()) is ScalarFormatter:
                axis.set_major_formatter(_plain_ticks()())


def plain_decades(axis: "Axis") -> None:
    """Make an axis logarithmic, marked by the plain numbers 1, 2, 5, 10 ..."""
    from matplotlib.ticker import LogLocator, NullFormatter

    axis.axes.set(**{f"{axis.axis_name}scale": "log"})  # type: ignore[attr-defined]
    axis.set_major_locator(LogLocator(subs=(1, 2, 5), numticks=99))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_locator(LogLocator(subs=tuple(range(1, 10)), numticks=99))
    axis.set_minor_formatter(NullFormatter())


def unit_label(unit: str) -> str:
    """Return a unit as an axis has it: "°C" for "degC", "–" for a plain number.

    Examples
    --------
    >>> unit_label("degC"), unit_label("mm2/s"), unit_label("")
    ('°C', 'mm²/s', '–')
    """
    written = unit.replace("deg", "°").replace("m2", "m²").replace("m3", "m³").replace("um", "µm")
    return written if unit not in ("", "1") else "–"


def axis_label(variable: "xr.DataArray", symbol: str, unit: str, name: str = "") -> str:
    """Return the label of an axis: name, symbol and unit."""
    name = name or variable.attrs["long_name"]
    return f"{name[0].upper()}{name[1:]} {symbol} [{unit}]"


def against_zero(low: float, high: float) -> dict[str, Any]:
    """Return colours and range for values of both signs, of which zero is white; for those of one sign a plain scale.

    What it is goes to `matplotlib.axes.Axes.contourf`, ``pcolormesh`` and the like.
    """
    import matplotlib
    from matplotlib.colors import Normalize

    if not low <= high:  # nothing is known
        low = 0.0
        high = 1.0
    if low < 0.0 < high:
        most = max(-low, high)
        return {"cmap": matplotlib.colormaps[DIVERGING], "norm": Normalize(-most, most)}
    return {"cmap": light_to_dark(), "norm": Normalize(low, high)}


def seamless(bar: "Colorbar") -> None:
    """Leave a colour bar without seams between its colours, and without an outline."""
    bar.outline.set_visible(False)
    bar.solids.set_edgecolor("face")  # type: ignore[union-attr]


def light_to_dark() -> Any:
    """Colours from light to dark for what grows; the palest ones would not be seen on white.

    They are so few that a colour bar is drawn and not embedded as a bitmap.
    """
    import matplotlib
    from matplotlib.colors import ListedColormap

    return ListedColormap(matplotlib.colormaps[SEQUENTIAL](np.linspace(0.8, 0.0, 40)))


# On a dark ground ----------------------------------------------------------------------------------------------------
# Lightness is turned round between the ground and the ink of a report in its dark form, in Oklab (Ottosson 2020), whose
# lightness is close to what people see: what is darker than its neighbour on white is lighter than it here.

#: What white and black become.
GROUND: Final = "#15181c"
INK: Final = "#e6e9ec"

#: Linear sRGB -> responses of the cones, and their cube roots -> Oklab.
_CONES: Final = np.array(
    [
        [0.4122214708, 0.5363325363, 0.0514459929],
        [0.2119034982, 0.6806995451, 0.1073969566],
        [0.0883024619, 0.2817188376, 0.6299787005],
    ]
)
_OKLAB: Final = np.array(
    [
        [0.2104542553, 0.7936177850, -0.0040720468],
        [1.9779984951, -2.4285922050, 0.4505937099],
        [0.0259040371, 0.7827717662, -0.8086757660],
    ]
)
#: Exponent of darkness on white: below one, what is pale there, an orange for instance, is no dark brown here; at 0.55
#: every colour of the palette has a contrast of 3 to its ground, as WCAG 2.2 (1.4.11) asks for.
_LIFT: Final = 0.55
_DRAWN: Final = re.compile(r"\b(fill|stroke): (#[0-9a-f]{6})\b")


def _oklab(colour: str) -> Any:
    encoded = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255.0
    linear = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    return _OKLAB @ np.cbrt(_CONES @ linear)


@functools.cache
def on_dark(colour: str) -> str:
    """Return what a colour "#rrggbb" is on a dark ground.

    Examples
    --------
    >>> on_dark("#ffffff"), on_dark("#000000")
    ('#15181c', '#e6e9ec')
    """
    lightness, *tone = _oklab(colour)
    ground = _oklab(GROUND)
    ink = _oklab(INK)
    # the faint tone of ground and ink comes with them, so that greys lie between the two
    turned = ground + max(0.0, 1.0 - lightness) ** _LIFT * (ink - ground) + np.array([0.0, *tone])
    linear = np.linalg.solve(_CONES, np.linalg.solve(_OKLAB, turned) ** 3).clip(0.0, 1.0)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return "#" + "".join(f"{round(255.0 * part):02x}" for part in encoded)


def adapting(svgs: list[str]) -> str:
    """Return the style sheet by which drawings follow a page that is dark.

    On paper, on a light screen, and where style sheets are not understood, they are as they were.
    """
    drawn = sorted(set().union(*(_DRAWN.findall(svg) for svg in svgs)))
    rules = "".join(
        f'figure [style*="{part}: {of}"]{{{part}:{on_dark(of)}!important}}' for part, of in drawn
    )
    # black is left out in a drawing wherever it is the default
    return f"@media screen and (prefers-color-scheme: dark){{figure svg{{fill:{INK}}}{rules}}}\n"


# The frame of a figure ------------------------------------------------------------------------------------------------

#: Width of a letter of a legend and of the line before it [inch]: what is longer than its column is wrapped.
_LETTER: Final = 0.051
_HANDLE: Final = 0.35


class Sheet:
    """A figure that is being drawn: ``axes`` as Matplotlib gives them for panels, ``handles`` of their legend."""

    def __init__(
        self, size: tuple[float, float] = SINGLE_COLUMN, *panels: Any, **options: Any
    ) -> None:
        from matplotlib.figure import Figure

        self.figure = Figure(figsize=size, layout="constrained")
        place: Any = (
            self.figure.subplot_mosaic
            if isinstance(next(iter(panels), 1), list)
            else self.figure.subplots
        )
        self.axes: Any = place(*panels, **options)
        self.handles: list[Artist] = []

    def line(self, x: Any, y: Any, label: str, axes: Any = None, **style: Any) -> None:
        """Draw a line, or points, that the legend shows."""
        self.handles += (axes or self.axes).plot(x, y, label=label, **style)

    def mark(self, x: Any, y: Any, label: str, **style: Any) -> None:
        """Draw black points that the legend shows."""
        self.line(x, y, label, linestyle="none", color="black", **style)

    def key(self, label: str, **style: Any) -> None:
        """Put into the legend what is drawn otherwise."""
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
        """Label the axes of a single panel, put the legend above and make room for it; ``height`` is that without."""
        if x:
            self.axes.set_xlabel(x)
            self.axes.set_ylabel(y)
        each = -(-len(self.handles) // columns) or 1  # Matplotlib fills columns
        of = [self.handles[k : k + each] for k in range(0, len(self.handles), each)]
        long = sum(max(len(str(one.get_label())) for one in column) for column in of)
        if (width := self.figure.get_figwidth()) < _LETTER * long + _HANDLE * len(of):
            for handle in self.handles:
                room = int((width / len(of) - _HANDLE) / _LETTER)
                handle.set_label(
                    textwrap.fill(str(handle.get_label()), room, break_on_hyphens=False)
                )
        rows = max(
            (sum(str(one.get_label()).count("\n") + 1 for one in column) for column in of),
            default=0,
        )
        if self.handles:
            about = {"title": title, "alignment": "left"} if title else {}
            self.figure.legend(
                handles=self.handles,
                ncols=columns,
                **{"loc": "outside upper left", **about, **legend},
            )
        without = self.figure.get_figheight() if height is None else height
        self.figure.set_figheight(without + ROW * (rows + bool(title)))
        return self.figure
