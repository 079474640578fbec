"""What the figures of all studies share: style, colours, sizes, and how they become files.

- A figure is an SVG with outlined letters: it looks the same on every machine, needs no fonts, and prints well. Its
  metadata hold caption and findings, which the report uses as caption and alternative text.
- The same dataset gives the same bytes: fixed salt for ids, no date, matplotlib's own defaults and its own font, so
  that nobody's matplotlibrc has a say. Figures are made without pyplot, so that no state outlives them.
- Widths are those of one and of two columns of a journal page; letters have 7 pt in print.
- Numbers at ticks are plain letters: as mathematical text, in which matplotlib sets them for the sake of a power beside
  the axis, they look the same and take a third of the time of a figure.
"""

import functools
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rollslip.files import whole_file

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure
    from matplotlib.ticker import ScalarFormatter

#: Okabe & Ito (2008), "Color universal design": the blue and the orange are told apart with every kind of colour
#: vision, and in grey.
RING_COLOURS: Final = {"inner": "#0072B2", "outer": "#E69F00"}
#: The same palette for models that are compared, and dashes that tell them apart in grey.
MODEL_COLOURS: Final = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
DASHES: Final = ("solid", (0, (4, 1.5)), (0, (1, 1)), (0, (5, 1.5, 1, 1.5)), (0, (5, 1.5, 1, 1.5, 1, 1.5)))
#: Nunez, Anderton & Renslow (2018): lightness rises evenly, for grey print and every kind of colour vision.
SEQUENTIAL: Final = "cividis"

STYLE: Final[Mapping[str, Any]] = {
    "font.family": "DejaVu Sans",  # comes with matplotlib
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
    "svg.fonttype": "path",
    "svg.hashsalt": "rollslip",
}

MARKER: Final[Mapping[str, Any]] = {"marker": "o", "markersize": 4, "markeredgecolor": "white"}
MM: Final = 1 / 25.4
ONE_COLUMN: Final = (90 * MM, 62 * MM)
TWO_COLUMNS: Final = (190 * MM, 80 * MM)
#: Height of a row of the legend, by which a figure grows so that its axes do not shrink.
ROW: Final = 4 * MM


def save_figures(figures: "Iterable[tuple[str, str, Figure]]", findings: str, folder: Path) -> list[Path]:
    """Write figures, given as name, caption and figure, as SVG files; they have to be drawn while they are iterated.

    Parameters
    ----------
    figures : iterable
        Makes one figure after the other: artists take their style when they are made, and it holds only in here.
    findings : str
        What the dataset says, for those who cannot see the figures.
    folder : Path
        Where the files go; it is made if it does not exist.

    Raises
    ------
    OutputError
        If a file cannot be written; then nothing is left of it.
    """
    from matplotlib import style
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    files = []
    with style.context(["default", dict(STYLE)]):
        for name, caption, figure in figures:
            folder.mkdir(parents=True, exist_ok=True)
            files.append(folder / f"{name}.svg")
            set_plainly(figure)
            canvas: Any = FigureCanvasSVG(figure)
            with whole_file(files[-1]) as partial:
                canvas.print_svg(  # savefig draws every figure once more before
                    partial,
                    metadata={"Title": caption, "Description": findings, "Creator": "rollslip", "Date": None},
                )
    return files


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


@functools.cache
def _plain_ticks() -> "type[ScalarFormatter]":
    from matplotlib.ticker import ScalarFormatter

    class PlainTicks(ScalarFormatter):
        """Mathematical text for the power beside the axis alone."""

        def __call__(self, x: float, pos: int | None = None) -> str:
            return super().__call__(x, pos).removeprefix(r"$\mathdefault{").removesuffix("}$")

    return PlainTicks


def set_plainly(figure: "Figure") -> None:
    """Set the numbers at the ticks of linear axes as plain letters, unless somebody has chosen what stands there."""
    from matplotlib.ticker import ScalarFormatter

    second = [child for axes in figure.axes for child in axes.child_axes]
    for axes in (*figure.axes, *second):
        for axis in (axes.xaxis, axes.yaxis):
            if type(axis.get_major_formatter()) is ScalarFormatter:
                axis.set_major_formatter(_plain_ticks()())


def axis_label(variable: "xr.DataArray", symbol: str, unit: str, name: str = "") -> str:
    """Return the label of an axis: name, symbol and unit."""
    name = name or variable.attrs["long_name"]
    return f"{name[0].upper()}{name[1:]} {symbol} [{unit}]"


def light_to_dark() -> Any:
    """Colours from light to dark for what grows; the palest ones would not be seen on white.

    They are so few that a colour bar is drawn and not embedded as a bitmap.
    """
    import matplotlib
    from matplotlib.colors import ListedColormap

    return ListedColormap(matplotlib.colormaps[SEQUENTIAL](np.linspace(0.8, 0.0, 40)))
