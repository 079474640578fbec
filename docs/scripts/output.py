"""Where the scripts of the documentation put tables and figures, and in which style; both are the same on every run."""

import csv
import math
import re
from collections.abc import Iterable, Sequence
from pathlib import Path

import matplotlib
from matplotlib.figure import Figure

DOCS = Path(__file__).parents[1]

#: Okabe & Ito (2008): told apart with every kind of colour vision.
BLUE = "#0072B2"
ORANGE = "#D55E00"
GREEN = "#009E73"
PURPLE = "#CC79A7"
BLACK = "#000000"

#: Of a figure, in bytes: pages shall load on a slow line.
LARGEST = 200_000

matplotlib.rcdefaults()  # nobody's matplotlibrc has a say
matplotlib.rcParams.update(
    {
        "font.family": "DejaVu Sans",
        "font.size": 8.0,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.titlelocation": "left",
        "axes.titlesize": 8.0,
        "legend.frameon": False,
        "legend.fontsize": 7.5,
        "lines.linewidth": 1.4,
        "svg.fonttype": "path",
        "svg.hashsalt": "rollslip",
    }
)


def write_table(name: str, header: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Write docs/tables/NAME.csv."""
    path = DOCS / "tables" / f"{name}.csv"
    path.parent.mkdir(exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(header)
        table.writerows(rows)


def read_table(name: str) -> list[dict[str, str]]:
    """Return the rows of docs/tables/NAME.csv."""
    with (DOCS / "tables" / f"{name}.csv").open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def figure(
    columns: int = 1, *, height: float = 2.9, width: float = 3.4, **options: object
) -> tuple[Figure, object]:
    """Return a figure with its axes, side by side."""
    made = Figure(figsize=(width * columns, height), layout="constrained")
    return made, made.subplots(1, columns, **options)


def save_figure(made: Figure, name: str) -> None:
    """Write docs/figures/NAME.svg, without date and version of Matplotlib, of at most `LARGEST` bytes."""
    path = DOCS / "figures" / f"{name}.svg"
    path.parent.mkdir(exist_ok=True)
    made.savefig(path, metadata={"Date": None, "Creator": None})
    path.write_text(rounded(path.read_text(encoding="utf-8")), encoding="utf-8")
    if (size := path.stat().st_size) > LARGEST:
        raise ValueError(
            f"{path.name} has {size} bytes, more than {LARGEST}; draw fewer marks or letters"
        )


def rounded(svg: str) -> str:
    """Return a drawing with coordinates to 0.01 pt: matplotlib writes six digits behind the point."""
    return re.sub(
        r' (?:d|x|y)="[^"]*"', lambda found: re.sub(r"(\.\d\d)\d+", r"\1", found.group()), svg
    )


def percent(slip: float, digits: int = 1) -> str:
    """Return a slip in percent as text; "none" for NaN."""
    return "none" if math.isnan(slip) else f"{100 * slip:.{digits}f}"


def coefficient(friction: float) -> str:
    """Return a friction coefficient as text; "none" for NaN."""
    return "none" if math.isnan(friction) else f"{friction:.5f}"
