"""Write a new data set from a table of measured points and a scene, as ``rollslip validate new`` does."""

import csv
import io
import json
from collections.abc import Sequence
from pathlib import Path
from string import Template
from typing import Final

from rollslip.bearing.assembly import assemble
from rollslip.errors import OutputError
from rollslip.files import whole
from rollslip.planning.execution import read_measured
from rollslip.scene.reading import load_scene
from rollslip.structure import raise_problem_if
from rollslip.studies.measured import MeasuredPoints
from rollslip.units import converted
from rollslip_campaigns.measurement.reading import FILE, MEASURED, UNCERTAINTY, load_measurement
from rollslip_campaigns.measurement.values import QUANTITIES

__all__ = ["new_data_set", "write_data_set"]

#: Significant digits of a number that was converted to SI units and back.
_DIGITS: Final = 12
_HEAD: Final = Template("""\
# Written by rollslip from $table: complete what a reader has to know, and the licence before you pass it on.
name = $name
description = $description

[source]
read = "recorded"
licence = "own record, not published"
references = [$reference]
""")
_SERIES: Final = Template("""
[[series]]
name = $name
quantity = $quantity
unit = $unit
scene = "scene.toml"
data = "$file"
uncertainty = "standard uncertainty as in the table"
""")


def write_data_set(name: str, table: Path, scene: str) -> Path:
    """Write the folder of a data set, and return it; nothing is written where anything is wrong.

    Parameters
    ----------
    name : str
        Name of the data set, or a folder that ends in it.
    table : Path
        Table of measured points, see `rollslip.run`.
    scene : str
        File or name of the scene.
    """
    target = Path(name)
    if target.exists():
        raise OutputError(f"{target}: exists, and is left as it is; choose another name")
    read = load_scene(scene)
    points = read_measured(table, assemble(read))
    texts = _texts(target.name, points, read.title or scene)
    with whole(target) as partial:
        (partial / "scene.toml").write_text(read.text, encoding="utf-8")
        for file, text in texts.items():
            (partial / file).write_text(text, encoding="utf-8")
        load_measurement(partial)
    return target


def _texts(name: str, points: MeasuredPoints, title: str) -> dict[str, str]:
    """Return the texts of the data set and of its tables, by file."""
    quantities = {quantity: quantity.replace("/", "-") for quantity in points.quantities}
    source = Path(points.table.source).name
    text = _HEAD.substitute(
        table=source,
        name=_quoted(name),
        description=_quoted(f"{', '.join(map(_plain_name, quantities))} of {title}"),
        reference=_quoted(f"Own record in the table {source}"),
    )
    tables = dict[str, str]()
    for quantity, stem in quantities.items():
        own = quantity.replace("_", "-")
        file = f"{stem.replace('_', '-')}.csv"
        text += _SERIES.substitute(
            name=_quoted(_plain_name(quantity)),
            quantity=_quoted(own if own in QUANTITIES else quantity),
            unit=_quoted(points.units[quantity]),
            file=file,
        )
        tables[file] = _table(points, quantity)
    return {FILE: text, **tables}


def _table(points: MeasuredPoints, quantity: str) -> str:
    """Return the rows of a quantity in the units of the table that was read."""
    units = {column.key: column.unit or "1" for column in points.table.columns}
    varied = [column for column in points.table.columns if column.quantity is not None]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    heads = [
        f"{column.key} [{units[column.key]}]" if column.is_number else column.key
        for column in varied
    ]
    unit = units[quantity]
    writer.writerow([*heads, f"{MEASURED} [{unit}]", f"{UNCERTAINTY} [{unit}]"])
    for value in points.values:
        if value.quantity != quantity:
            continue
        cells = [
            _number(value.conditions[column.key], points.units[column.key], units[column.key])
            if column.is_number
            else str(value.conditions[column.key])
            for column in varied
        ]
        si = points.units[quantity]
        numbers = [_number(number, si, unit) for number in (value.value, value.uncertainty)]
        writer.writerow([*cells, *numbers])
    return text.getvalue()


def _number(value: float, si: str, unit: str) -> str:
    """Return a value [si] in a unit as text."""
    return f"{float(converted(value, si, unit)):.{_DIGITS}g}"


def _plain_name(quantity: str) -> str:
    """Return a quantity in words."""
    return quantity.rpartition("/")[2].replace("_", " ")


def _quoted(text: str) -> str:
    """Return a text as TOML takes it, which has the strings of JSON."""
    return json.dumps(text, ensure_ascii=False)


def new_data_set(names: Sequence[str], table: Path | None, scene: str) -> str:
    """Write the data set that is requested by ``new NAME``, and return a line that says what to do with it.

    Parameters
    ----------
    names : sequence of str
        "new" and the name.
    table : Path or None
        Table of measured points.
    scene : str
        File or name of the scene.
    """
    raise_problem_if(
        len(names) != 2 or names[0] != "new" or table is None or not scene,
        "new: name the data set, the table and the scene: rollslip validate new NAME --from slip.csv --scene my.toml",
    )
    assert table is not None
    folder = write_data_set(names[1], table, scene)
    return f"written: {folder}; compare models with it by: rollslip validate {folder}"
