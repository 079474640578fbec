"""Predictions of other programs for the rows of a data set: a plain CSV, so that closed programs can take part too.

- ``rollslip validate NAME --form FILE.csv`` writes the rows with an empty column; what comes back has numbers there.
- A file is of one data set. Its comments may say ``# program: NAME``, and ``# parameters: N`` that were fitted for it.
"""

import csv
import io
import math
import os
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.catalogue.discovery import available
from rollslip.catalogue.registry import get_model
from rollslip.errors import OutputError, SceneError
from rollslip.files import whole_file
from rollslip.structure import FrozenTable
from rollslip.units import as_written
from rollslip_campaigns.measurement import Measurement, load_measurement
from rollslip_campaigns.measurement.rig import load_rig, read_data, text_named
from rollslip_campaigns.measurement.values import QUANTITIES, ContactSeries, Row, Series
from rollslip_campaigns.validation.residuals import Value

__all__ = [
    "Predictions", "data_set_of", "form", "measurement_named", "predictions_of", "read_predictions", "write_form",
]  # fmt: skip

#: Uncertainty of rows that have none, relative to the largest friction.
ALIKE: Final = 0.01
_HEAD: Final = ("data_set", "series", "line", "conditions", "unit", "predicted", "uncertainty")


@attrs.frozen(kw_only=True)
class Predictions:
    """What a program gives for rows of a data set.

    Attributes
    ----------
    of : str
        The data set.
    program : str
        Who predicts.
    parameters : int
        How many parameters were fitted to the data for it; 0 if nothing was.
    source : str
        File.
    values : mapping
        (series, line in its file) -> value and standard uncertainty in SI units.
    """

    of: str
    program: str
    parameters: int
    source: str
    values: dict[tuple[str, int], tuple[float, float]] = attrs.field(repr=False)

    def values_of(self, series: Series) -> tuple[list[Value], NDArray[np.float64]] | None:
        """Return what is predicted of a series, as values and samples of their errors; None if nothing is."""
        found = [self.values.get((series.name, row.line)) for row in series.rows]
        if not series.rows or all(one is None for one in found):
            return None
        from scipy.special import ndtri

        errors = ndtri((np.arange(256) + 0.5) / 256)
        values = list[Value]()
        columns = []
        for one in found:
            value, sigma = (math.nan, 0.0) if one is None else one
            values.append(Value(value, "" if one is not None else "not predicted", math.nan))
            columns.append(value + sigma * errors)
        generator = np.random.default_rng(0)  # errors of different rows are independent
        columns = [generator.permutation(column) for column in columns]
        sampled = np.array(columns).T
        return values, sampled if any(one is not None and one[1] for one in found) else sampled[:0]


def measurement_named(name: str | Path | Measurement) -> Measurement:
    """Return a data set by its name, its folder, or the file of a rig that a fit reads."""
    if isinstance(name, Measurement):
        return name
    if Path(name).suffix == ".csv":
        return _of_file(Path(name))
    if isinstance(name, Path) or (name not in available("measurement") and Path(name).is_dir()):
        return load_measurement(name)
    made: Measurement = get_model("measurement", name)
    return made


def _of_file(path: Path) -> Measurement:
    """Return the data set of friction in a file, on the rig beside it; without uncertainties all rows weigh alike."""
    data = read_data(path)
    rig = load_rig(path.with_name("rig.toml"))
    friction = data.columns["friction"]
    given = data.columns.get("friction_uncertainty")
    sigma = np.full(friction.shape, ALIKE * np.abs(friction).max()) if given is None else given
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
    about = (
        ""
        if given is not None
        else f"none given: {100.0 * ALIKE:g} % of the largest friction in every row"
    )
    unit = QUANTITIES["friction"].unit
    series = ContactSeries(
        name=path.stem,
        quantity="friction",
        unit=unit,
        rig=rig,
        data=data,
        rows=rows,
        about_uncertainty=about,
    )
    name = f"{path.resolve().parent.name}/{path.stem}"
    return Measurement(
        name=name,
        description=rig.title,
        references=(),
        read="file of a rig",
        licence="",
        series=(series,),
    )


def predictions_of(
    given: Iterable[str | Path | Predictions], names: Sequence[Any]
) -> list[Predictions]:
    """Return predictions, those of files read, each of the data set that it names, or of the only one."""
    return [
        one
        if isinstance(one, Predictions)
        else read_predictions(one, measurement_named(data_set_of(one, names)))
        for one in given
    ]


def write_form(names: Sequence[str], path: Path) -> str:
    """Write a file for predictions of one data set; say what to do with it."""
    if len(names) != 1:
        raise SceneError(["form: needs one data set; name one"])
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
    )
    text.write(
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
    """Read predictions for a data set."""
    source, text = text_named(path)
    comments = dict(re.findall(r"^#\s*(program|parameters):\s*(.+?)\s*$", text, re.MULTILINE))
    lines = [
        (k, line)
        for k, line in enumerate(text.split("\n"), 1)
        if line.strip() and not line.startswith("#")
    ]
    problems = list[str]()
    values = dict[tuple[str, int], tuple[float, float]]()
    if not lines:
        raise SceneError(
            [f"{source}: no header; 'rollslip validate NAME --form FILE.csv' writes a file to fill"]
        )
    head = [cell.strip() for cell in next(csv.reader([lines[0][1]]))]
    if missing := [name for name in ("series", "line", "predicted") if name not in head]:
        raise SceneError([f"{source}:{lines[0][0]}: missing columns: {', '.join(missing)}"])
    rows = {(series.name, row.line): series for series in measurement.series for row in series.rows}
    for number, line in lines[1:]:
        cells = dict(zip(head, (cell.strip() for cell in next(csv.reader([line]))), strict=False))
        place = f"{source}:{number}"
        key = (cells.get("series", ""), _whole(cells.get("line", "")))
        if cells.get("data_set", measurement.name) != measurement.name:
            problems.append(
                f"{place}: data_set: {as_written(cells['data_set'])} is not {measurement.name!r}"
            )
        elif key not in rows:
            problems.append(
                f"{place}: series {as_written(key[0])} has no row of line {cells.get('line')}"
            )
        elif key in values:
            problems.append(f"{place}: series {as_written(key[0])}, line {key[1]} once more")
        elif cells.get("unit", rows[key].unit) != rows[key].unit:
            problems.append(
                f"{place}: unit: {as_written(cells['unit'])}; predictions are in {rows[key].unit!r}"
            )
        else:
            value = _number(cells.get("predicted", ""))
            sigma = _number(cells.get("uncertainty") or "0")
            if value is None or sigma is None or sigma < 0.0:
                what = "predicted" if value is None else "uncertainty"
                wanted = "a number" if value is None else "a number from 0 on, or nothing,"
                problems.append(
                    f"{place}: {what}: {wanted} is expected, not {as_written(cells.get(what, ''))}"
                )
            else:
                values[key] = value, sigma
    count = _whole(comments.get("parameters", "0"))
    if count < 0:
        problems.append(
            f"{source}: parameters: a whole number is expected, not {as_written(comments['parameters'])}"
        )
    if not values and not problems:
        problems.append(f"{source}: no rows are predicted")
    if problems:
        raise SceneError(problems)
    program = comments.get("program", Path(path).stem)
    return Predictions(
        of=measurement.name, program=program, parameters=count, source=source, values=values
    )


def data_set_of(path: str | os.PathLike[str], requested: Sequence[str]) -> str:
    """Return the data set that a file of predictions is of: the one that it names, or the only one asked for."""
    if len(requested) == 1:
        return requested[0]
    source, text = text_named(path)
    rows = csv.DictReader(
        line for line in text.split("\n") if line.strip() and not line.startswith("#")
    )
    named = next((row["data_set"] for row in rows if row.get("data_set")), "")
    if not named:
        raise SceneError(
            [f"{source}: has no column data_set; name the data set that it is of in the command"]
        )
    return named


def _whole(text: str) -> int:
    return int(text) if re.fullmatch(r"\d{1,9}", text, re.ASCII) else -1


def _number(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None
