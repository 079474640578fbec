"""Read predictions of other programs for the rows of a data set: plain CSV, which any program can write.

- ``rollslip validate NAME --form FILE.csv`` writes the rows with an empty column, which is then filled with numbers.
- A file belongs to one data set. Its comments may state ``# program: NAME``, and ``# parameters: N`` that were fitted.
"""

import csv
import io
import math
import os
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.catalogue.discovery import available
from rollslip.catalogue.registry import get_model
from rollslip.errors import OutputError, SceneError
from rollslip.files import text_named, whole_file
from rollslip.results.curves import or_none
from rollslip.structure import FrozenTable, raise_problem_if, raise_problems
from rollslip.units import as_written
from rollslip_campaigns.measurement import Measurement, load_measurement
from rollslip_campaigns.measurement.rig import load_rig, read_data
from rollslip_campaigns.measurement.values import QUANTITIES, ContactSeries, Row, Series
from rollslip_campaigns.validation.residuals import Value

__all__ = [
    "Predictions",
    "data_set_of",
    "form",
    "measurement_named",
    "predictions_of",
    "read_predictions",
    "write_form",
]

#: Standard uncertainty of rows for which the data state none, relative to the largest friction. Doubling it halves all
#: errors over the uncertainty; the ranking of laws stays. Chosen, typical of traction rigs; reports say so.
DEFAULT_UNCERTAINTY: Final = 0.01
#: Quantiles that represent the normal error of a predicted value. Doubling it refines the ends of bands; chosen.
_ERROR_QUANTILES = 256
#: Columns of a file of predictions.
_HEAD: Final = ("data_set", "series", "line", "conditions", "unit", "predicted", "uncertainty")


@attrs.frozen(kw_only=True)
class Predictions:
    """Predictions of a program for rows of a data set.

    Attributes
    ----------
    data_set : str
        Name of the data set.
    program : str
        Name of the program.
    parameters : int
        Number of parameters that were fitted to the data for it; 0 if none was.
    source : str
        File.
    values : mapping
        Value and standard uncertainty in SI units, by (series, line in its file).
    """

    data_set: str
    program: str
    parameters: int
    source: str
    values: dict[tuple[str, int], tuple[float, float]] = attrs.field(repr=False)

    def values_of(self, series: Series) -> tuple[list[Value], NDArray[np.float64]] | None:
        """Return predicted values of a series, and samples with errors (samples, rows); None if there are none."""
        predicted = [self.values.get((series.name, row.line)) for row in series.rows]
        if not series.rows or all(prediction is None for prediction in predicted):
            return None
        from scipy.special import ndtri

        errors = ndtri((np.arange(_ERROR_QUANTILES) + 0.5) / _ERROR_QUANTILES)
        values = list[Value]()
        columns = []
        for prediction in predicted:
            value, sigma = prediction or (math.nan, 0.0)
            values.append(Value(value, "" if prediction else "not predicted", math.nan))
            columns.append(value + sigma * errors)
        generator = np.random.default_rng(0)  # errors of different rows are independent
        samples = np.array([generator.permutation(column) for column in columns]).T
        has_errors = any(prediction and prediction[1] for prediction in predicted)
        return values, samples if has_errors else samples[:0]


def measurement_named(name: str | Path | Measurement) -> Measurement:
    """Return a data set by its name, its folder, or the file of a rig that a fit reads."""
    if isinstance(name, Measurement):
        return name
    if Path(name).suffix == ".csv":
        return _measurement_of_file(Path(name))
    if isinstance(name, Path) or (name not in available("measurement") and Path(name).is_dir()):
        return load_measurement(name)
    measurement: Measurement = get_model("measurement", name)
    return measurement


def _measurement_of_file(path: Path) -> Measurement:
    """Return the data set of friction in a file and of rig.toml beside it; the uncertainty may be the default one."""
    data = read_data(path)
    rig = load_rig(path.with_name("rig.toml"))
    friction = data.columns["friction"]
    sigma = data.columns.get("friction_uncertainty")
    about = ""
    if sigma is None:
        sigma = np.full(friction.shape, DEFAULT_UNCERTAINTY * np.abs(friction).max())
        about = (
            f"none given: {100.0 * DEFAULT_UNCERTAINTY:g} % of the largest friction in every row"
        )
    names = [name for name in data.columns if not name.startswith("friction")]
    rows = tuple(
        Row(
            changes=FrozenTable({name: float(data.columns[name][k]) for name in names}),
            measured=float(friction[k]),
            uncertainty=float(sigma[k]),
            line=line,
        )
        for k, line in enumerate(data.lines)
    )
    series = ContactSeries(
        name=path.stem,
        quantity="friction",
        unit=QUANTITIES["friction"].unit,
        rig=rig,
        data=data,
        rows=rows,
        about_uncertainty=about,
    )
    return Measurement(
        name=f"{path.resolve().parent.name}/{path.stem}",
        description=rig.title,
        references=(),
        read="file of a rig",
        licence="",
        series=(series,),
    )


def predictions_of(
    given: Iterable[str | Path | Predictions], names: Sequence[Any]
) -> list[Predictions]:
    """Return predictions; files are read, each for the data set that it names, or for the only one.

    Parameters
    ----------
    given : iterable of str, Path or Predictions
        Files or predictions.
    names : sequence
        The requested data sets.
    """
    return [
        item
        if isinstance(item, Predictions)
        else read_predictions(item, measurement_named(data_set_of(item, names)))
        for item in given
    ]


def write_form(names: Sequence[str], path: Path) -> str:
    """Write a file for predictions of one data set, and return a line that says what to do with it.

    Parameters
    ----------
    names : sequence of str
        The requested data set.
    path : Path
        The new file.
    """
    raise_problem_if(len(names) != 1, "form: needs one data set; name one")
    if path.exists():
        raise OutputError(
            f"{path}: exists, perhaps with numbers in it; name another --form, or remove it"
        )
    with whole_file(path) as partial:
        partial.write_text(form(measurement_named(names[0])), encoding="utf-8")
    return f"written: {path}; fill the column predicted, and give it back by --predictions {path}"


def form(measurement: Measurement) -> str:
    """Return the rows of a data set as CSV with empty columns for predictions, all in SI units."""
    text = io.StringIO()
    text.write(
        f"# Predictions for data set {measurement.name}: fill the column predicted, in the unit of the row;\n"
        "# uncertainty is its standard uncertainty, and may stay empty.\n# program: NAME\n# parameters: 0\n"
    )
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(_HEAD)
    for series in measurement.series:
        for row in series.rows:
            writer.writerow(
                [measurement.name, series.name, row.line, row.label, series.unit, "", ""]
            )
    return text.getvalue()


def read_predictions(path: str | os.PathLike[str], measurement: Measurement) -> Predictions:
    """Return the predictions in a file; all faults are raised at once.

    Parameters
    ----------
    path : str or path
        The file.
    measurement : Measurement
        The data set that it is for.
    """
    source, text = text_named(path)
    comments = dict(re.findall(r"^#\s*(program|parameters):\s*(.+?)\s*$", text, re.MULTILINE))
    lines = _content_lines(text)
    problems = list[str]()
    values = dict[tuple[str, int], tuple[float, float]]()
    raise_problem_if(
        not lines,
        f"{source}: no header; 'rollslip validate NAME --form FILE.csv' writes a file to fill",
    )
    head = [cell.strip() for cell in next(csv.reader([lines[0][1]]))]
    if missing := [name for name in ("series", "line", "predicted") if name not in head]:
        raise SceneError([f"{source}:{lines[0][0]}: missing columns: {', '.join(missing)}"])
    rows = {(series.name, row.line): series for series in measurement.series for row in series.rows}
    for number, line in lines[1:]:
        cells = dict(zip(head, (cell.strip() for cell in next(csv.reader([line]))), strict=False))
        if problem := _read_row(cells, measurement.name, rows, values):
            problems.append(f"{source}:{number}: {problem}")
    count = _whole(comments.get("parameters", "0"))
    if count < 0:
        problems.append(
            f"{source}: parameters: a whole number is expected, not {as_written(comments['parameters'])}"
        )
    if not values and not problems:
        problems.append(f"{source}: no rows are predicted")
    raise_problems(problems)
    return Predictions(
        data_set=measurement.name,
        program=comments.get("program", Path(path).stem),
        parameters=count,
        source=source,
        values=values,
    )


def _read_row(
    cells: Mapping[str, str],
    data_set: str,
    rows: Mapping[tuple[str, int], Series],
    values: dict[tuple[str, int], tuple[float, float]],
) -> str:
    """Add the prediction in the cells of a row to `values`; return the fault of the row, if it has one."""
    key = (cells.get("series", ""), _whole(cells.get("line", "")))
    if cells.get("data_set", data_set) != data_set:
        return f"data_set: {as_written(cells['data_set'])} is not {data_set!r}"
    if key not in rows:
        return f"series {as_written(key[0])} has no row of line {cells.get('line')}"
    if key in values:
        return f"series {as_written(key[0])}, line {key[1]} once more"
    if cells.get("unit", rows[key].unit) != rows[key].unit:
        return f"unit: {as_written(cells['unit'])}; predictions are in {rows[key].unit!r}"
    if (value := _number(cells.get("predicted", ""))) is None:
        return f"predicted: a number is expected, not {as_written(cells.get('predicted', ''))}"
    sigma = _number(cells.get("uncertainty") or "0")
    if sigma is None or sigma < 0.0:
        text = as_written(cells.get("uncertainty", ""))
        return f"uncertainty: a number from 0 on, or nothing, is expected, not {text}"
    values[key] = value, sigma
    return ""


def data_set_of(path: str | os.PathLike[str], requested: Sequence[str]) -> str:
    """Return the name of the data set of a file of predictions: the one that it names, or the only one requested.

    Parameters
    ----------
    path : str or path
        The file.
    requested : sequence of str
        The requested data sets.
    """
    if len(requested) == 1:
        return requested[0]
    source, text = text_named(path)
    rows = csv.DictReader(line for _, line in _content_lines(text))
    named = next((row["data_set"] for row in rows if row.get("data_set")), "")
    raise_problem_if(
        not named,
        f"{source}: has no column data_set; name the data set that it is of in the command",
    )
    return named


def _content_lines(text: str) -> list[tuple[int, str]]:
    """Return number and text of all lines that are neither blank nor comments."""
    return [
        (number, line)
        for number, line in enumerate(text.split("\n"), 1)
        if line.strip() and not line.startswith("#")
    ]


def _whole(text: str) -> int:
    """Return a whole number of up to nine digits, or -1 for other texts."""
    return int(text) if re.fullmatch(r"\d{1,9}", text, re.ASCII) else -1


def _number(text: str) -> float | None:
    """Return a finite number, or None for other texts."""
    try:
        return or_none(float(text))
    except ValueError:
        return None
