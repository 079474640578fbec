"""What is said and drawn of small results, of every account one at least, as texts that a reader compares.

Results are stored in ``tests/results/stored``, so that words alone are under test, and their numbers are whole.
``python tests/support/recorded.py`` writes the text of each beside it; with ``--compute`` it computes them anew first.
Either takes names.
"""

import argparse
import io
import lzma
import math
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr
from matplotlib.colors import to_hex
from matplotlib.ticker import FixedLocator

import motion_samples
from rollslip.results.accounts import account_of
from rollslip.results.accounts import answer as answer_of
from rollslip.results.dataset import with_present_names
from rollslip.results.figures import Figures, plot
from rollslip.results.text import align_columns, collect_warnings, confidence, describe_more_bounds

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.legend import Legend
    from numpy.typing import NDArray

ROOT = Path(__file__).parents[2]
STORED = ROOT / "tests" / "results" / "stored"
EXAMPLES = ROOT / "docs" / "examples"
#: Values that are none but for rounding.
_NOTHING = 1e-13
SCENE = "1032930-70C"
COARSE = "--set accuracy.slices=7 --no-plots"
#: Name -> arguments of `rollslip` that compute it, without --out.
RESULTS = {
    "friction-curve": f"run {SCENE} --study friction-curve --set study.friction-curve.points=11 {COARSE}",
    "effective-friction": f"run {SCENE} --study effective-friction --set study.effective-friction.points=11 "
    "--set study.effective-friction.closure=free-roller --set study.effective-friction.map_points=3 "
    f"--set study.effective-friction.per_roller=true {COARSE}",
    "raceway-friction": f"run {SCENE} --study raceway-friction {COARSE}",
    "steady-slip": f"run gearbox --study steady-slip {COARSE}",
    "steady-slip-branches": f"run turbine --study steady-slip {COARSE} "
    '--set study.steady-slip.inner_speed=["5000rpm","8000rpm"]',
    "steady-slip-largest-drag": f"run 1032930-50C --study steady-slip {COARSE}",
    "thermal-balance": "run 1032930-50C --study thermal-balance --set models.thermal.model=network "
    f"--set models.thermal.oil_flow=15g/s --set study.thermal-balance.duration=1h {COARSE}",
    "surface-damage": "run turbine --study surface-damage "
    f'--set models.damage=["pass-energy","film-parameter"] {COARSE}',
    "rating-life": "run turbine --study rating-life --set operation.radial_load=20kN "
    f"--set study.rating-life.hours=20000 {COARSE}",
    "dynamics": f"run {SCENE} --study dynamics --set study.dynamics.duration=2ms "
    f"--set study.dynamics.points=21 {COARSE}",
    "dynamics-history": f"run {SCENE} --study dynamics --set study.dynamics.duration=20ms "
    f"--set study.dynamics.points=41 {COARSE} "
    '--set study.dynamics.history.inner_speed={shape="run-up",from="3000rpm",within="20ms"}',
    "sweep": f"sweep run turbine --study steady-slip --over operation.radial_load=0.5kN:2kN:3 {COARSE}",
    "supplement": f"supplement paper.toml {COARSE}",
    "cases": f"cases gearbox {EXAMPLES / 'duty.csv'} {COARSE}",
    "window": f"window gearbox --over operation.inner_speed=500rpm:2500rpm:2 {COARSE}",
    "comparison": f"compare {SCENE} --traction muraki,maxwell-eyring {COARSE}",
    "alternatives": f"compare gearbox --oil iso-vg-68,iso-vg-220 {COARSE}",
    "pareto": f"pareto {SCENE} --study friction-curve --choices slices --rounds 1 --no-plots",
    "uncertainty": f"uncertainty gearbox --samples 8 --loads 2 {COARSE}",
    "limit": f"limit {SCENE} --over operation.radial_load=2kN:6kN:3 --keep effective_friction<=0.007 {COARSE}",
    "surrogate": "surrogate gearbox --over radial_load=1kN:2.5kN "
    f"--over temperature=70degC:90degC --over inner_speed=500rpm:1800rpm --error 0.05 --checks 4 {COARSE}",
    "fit": f"fit {EXAMPLES / 'twin-disc.csv'} --rig {EXAMPLES / 'rig.toml'} --parameters eyring_stress --no-plots",
    "validation": "validate klebanov-2022 published-slip --samples 2 --no-plots",
    "ranking": "rank film-limits --traction muraki,maxwell-eyring --no-plots",
}
#: Name -> what gives a text of samples that no run makes.
TEXTS: dict[str, Callable[[], str]] = {
    "motions": motion_samples.told_motions,
    "motions-together": motion_samples.told_together,
}


def compute(name: str) -> None:
    """Compute a result and store it."""
    with tempfile.TemporaryDirectory() as place:
        # a result names the file of its scene, here without a folder
        shutil.copy(EXAMPLES / "paper.toml", place)
        command = [
            sys.executable,
            "-c",
            "from rollslip.cli import main; main()",
            *RESULTS[name].split(),
            "--out",
            "o",
        ]
        done = subprocess.run(command, cwd=place, capture_output=True, text=True, check=False)
        found = sorted(Path(place, "o").rglob("*.nc"), key=lambda path: (len(path.parts), path))
        if not found:
            raise SystemExit(f"{name}: {done.stderr}")
        with lzma.open(STORED / f"{name}.nc.xz", "wb") as file:
            file.write(found[0].read_bytes())


@cache
def stored(name: str) -> "xr.Dataset":
    """Return a stored result."""
    content = io.BytesIO(lzma.decompress((STORED / f"{name}.nc.xz").read_bytes()))
    return with_present_names(xr.load_dataset(content, engine="h5netcdf", phony_dims="access"))


def told(dataset: "xr.Dataset", figures: "Figures") -> str:
    """Return all that is said of a result and stands on its figures."""
    account = account_of(dataset)
    answer = answer_of(dataset)
    said = account.lines(dataset)
    (first, bounds) = collect_warnings([dataset])
    others = [
        text for texts in account.topics(dataset).values() for text in texts if text not in said
    ]
    parts = {
        "answer": answer.lines(80) if answer.rows or answer.summary else [],
        "lines": said,
        "topics": [", ".join(account.topics(dataset)), *others],
        "warned": [
            *first,
            *([describe_more_bounds(bounds)] if bounds else []),
            *filter(None, [confidence([dataset])]),
        ],
    }
    for table in account.tables(dataset):
        parts[f"table {table.caption}".rstrip()] = align_columns(
            [table.head, *map(tuple, table.rows)], math.inf
        )
    parts |= {
        f"figure {name}: {figures.captions[name]}": list(_on(figure))
        for name, figure in figures.items()
    }
    return "\n".join(
        f"== {part}\n" + "".join(f"{line}\n" for line in lines)
        for part, lines in parts.items()
        if lines
    )


@cache
def drawn(name: str) -> "Figures":
    """Return the figures of a stored result, whose text is read before their ticks are changed."""
    return plot(stored(name))


def text_of(name: str) -> str:
    """Return the text of a stored result, or of samples."""
    return TEXTS[name]() if name in TEXTS else told(stored(name), drawn(name))


def _on(figure: "Figure") -> Iterator[str]:
    """Give what a reader sees: labels, ranges, lines with their ends, areas and words."""
    yield from map(_legend, figure.legends)
    for k, axes in enumerate(figure.axes):
        ends = f"x {_range(axes.get_xlim())} {axes.get_xscale()}, y {_range(axes.get_ylim())} {axes.get_yscale()}"
        yield f"axes {k}: {axes.get_title()!r}, {axes.get_xlabel()!r}, {axes.get_ylabel()!r}; {ends}"
        for axis in (axes.xaxis, axes.yaxis):
            labels = (
                axis.get_ticklabels() if isinstance(axis.get_major_locator(), FixedLocator) else []
            )
            names = [
                label.get_text() for label in labels if label.get_text()[:1] not in ("", "$")
            ]  # no numbers
            yield from [f"  ticks: {'; '.join(names)}"] * bool(names)
        yield from _lines(axes)
        areas = len(axes.collections) + len(axes.patches) + len(axes.images)
        yield from [f"  {areas} areas or bars"] * bool(areas)
        yield from [f"  texts: {'; '.join(text.get_text() for text in axes.texts)}"] * bool(
            axes.texts
        )
        if axes.get_legend() is not None:
            yield _legend(axes.get_legend())


def _lines(axes: "Axes") -> Iterator[str]:
    """Give the lines of axes, those together that are drawn alike."""
    alike = dict[str, list["NDArray[np.float64]"]]()
    for line in axes.lines:
        marker = "" if line.get_marker() in ("", "None", None) else line.get_marker()
        colour = (
            "" if marker else to_hex(line.get_color())
        )  # single points go through the colours by themselves
        style = f"line {line.get_linestyle()} {marker}{colour}"
        alike.setdefault(style, []).append(np.array(line.get_data(), float))
    for style, drawn in alike.items():
        x, y = np.concatenate(drawn, axis=1)
        of = f" ({len(drawn)} lines)" if len(drawn) > 1 else ""
        yield f"  {style}{of}: {x.size} points, x {_extent(x)}, y {_extent(y)}"


def _legend(legend: "Legend") -> str:
    texts = [text.get_text() for text in (legend.get_title(), *legend.get_texts())]
    return f"  legend: {'; '.join(filter(None, texts))}"


def _extent(values: "NDArray[np.float64]") -> str:
    """Return first, least, largest and last value: what a wrong unit or order moves."""
    known = values[np.isfinite(values)]
    return (
        " ".join(map(_short, (known[0], known.min(), known.max(), known[-1])))
        if known.size
        else "none"
    )


def _range(ends: tuple[float, float]) -> str:
    return f"{_short(ends[0])} to {_short(ends[1])}"


def _short(value: float) -> str:
    return f"{value:.4g}" if abs(value) > _NOTHING else "0"


def main() -> None:
    """Write texts, and results where that is asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help="of RESULTS and TEXTS; all without a name")
    parser.add_argument("--compute", action="store_true")
    requested = parser.parse_args()
    for name in requested.names or (*RESULTS, *TEXTS):
        if requested.compute and name in RESULTS:
            compute(name)
        (STORED / f"{name}.txt").write_text(text_of(name), encoding="utf-8")


if __name__ == "__main__":
    main()
