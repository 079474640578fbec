"""Measured points beside a result: read them from a table, and compare them with values calculated at their conditions.

The columns of the table are keys of the scene, and measured values with their standard uncertainties: ``cage_slip [%]``
and ``cage_slip_uncertainty [%]``. Keys that it does not have are as in the scene.

A measured value m and a calculated one y are compared by the normalised error of ISO 13528,

    E_n = |y - m| / sqrt(U_m^2 + U_y^2),

with expanded uncertainties U of 95 %: of the measured value twice its standard uncertainty; of the calculated value
that of the end of its band, between quantiles of 5 and 95 %, which lies towards the measured one. Both agree within
their uncertainties where E_n is at most 1. Where a calculated value has no band, U_y is 0, and the result says so.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import attrs
import numpy as np

from rollslip.bearing.assembly import assemble
from rollslip.catalogue.discovery import available, get_class
from rollslip.errors import PluginError, RollslipError, SceneError
from rollslip.files import faults_of
from rollslip.results.accounts import account_of
from rollslip.results.curves import or_none
from rollslip.scene.changes import Quantity, evolve
from rollslip.scene.values import Scene
from rollslip.structure import resolved, scene_hash
from rollslip.studies.answers import Measurable
from rollslip.studies.study import Study
from rollslip.studies.tables import FurtherColumn, KeyTable, read_table
from rollslip.units import as_written

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["MeasuredPoints", "MeasuredValue", "compare_points", "measurables", "read_points"]

#: Dimensions of an output with a value for each steady slip.
_STEADY: Final = "steady"
#: What the name of the column of a standard uncertainty ends with.
_UNCERTAINTY: Final = "_uncertainty"
#: Expanded over standard uncertainty, of 95 % (JCGM 100:2008, 6.3.3).
_COVERAGE: Final = 2.0
#: Normal score of the ends of a band, which lie at quantiles of 5 and 95 %.
_BAND_SCORE: Final = 1.645
#: Relative difference of a condition from the value of the scene below which it counts as that. Chosen: far below the
#: digits of a table, above rounding in the conversion of units.
_SAME: Final = 1e-9

#: Receives a text, and the fraction that is done.
Report: TypeAlias = Callable[[str, float], object]
#: Returns the result of a study at a scene, with bands.
Compute: TypeAlias = "Callable[[Scene, str], xr.Dataset]"


@attrs.frozen(kw_only=True)
class MeasuredValue:
    """A measured value.

    Attributes
    ----------
    quantity : str
        Name of its column.
    place : str
        File and line.
    conditions : mapping
        Values of the scene at which it was measured, by key.
    value, uncertainty : float
        The value and its standard uncertainty [SI].
    """

    quantity: str
    place: str
    conditions: Mapping[str, Any]
    value: float
    uncertainty: float


@attrs.frozen(kw_only=True)
class MeasuredPoints:
    """Measured values of a table.

    Attributes
    ----------
    table : KeyTable
        The table.
    quantities : mapping
        Study that calculates a quantity, and its variable, by the name of the column.
    units : mapping
        SI unit of a quantity or a key of the scene; empty for names.
    values : tuple of MeasuredValue
        The values, row by row.
    """

    table: KeyTable
    quantities: Mapping[str, tuple[type[Study], Measurable]]
    units: Mapping[str, str]
    values: tuple[MeasuredValue, ...]


def measurables() -> dict[str, tuple[type[Study], Measurable]]:
    """Return study and variable of each quantity that can be measured; of two studies the first."""
    found = dict[str, tuple[type[Study], Measurable]]()
    for study in _usable_studies():
        for quantity, measurable in study.measured.items():
            found.setdefault(quantity, (study, measurable))
    return found


def _usable_studies() -> Iterator[type[Study]]:
    """Yield the studies whose packages can be imported."""
    for name in available("study"):
        with suppress(PluginError):
            yield get_class("study", name)


def _columns() -> dict[str, tuple[type[Study], Measurable]]:
    """Return study and variable by the name of a column: quantities with one value, and outputs as STUDY/VARIABLE."""
    columns = {
        quantity.replace("-", "_"): (study, measurable)
        for quantity, (study, measurable) in measurables().items()
        if study.outputs[measurable.variable].dims in ("", _STEADY)
    }
    for study in _usable_studies():
        for variable, output in study.outputs.items():
            if output.dims in ("", _STEADY) and not output.attribute:
                index = 0 if output.dims else None
                columns[f"{study.name}/{variable}"] = (
                    study,
                    Measurable(variable=variable, steady_index=index),
                )
    return columns


def read_points(given: object, known: Mapping[str, Quantity], scene: Scene) -> MeasuredPoints:
    """Return the measured values of a table; all its faults are raised in one error.

    Parameters
    ----------
    given : path or pandas.DataFrame
        A file .csv or .xlsx, or a frame.
    known : mapping of str to Quantity
        Quantities of the scene by key.
    scene : Scene
        The scene, of which the conditions of each row are changes.
    """
    columns = _columns()
    units = {
        name: study.outputs[measurable.variable].unit
        for name, (study, measurable) in columns.items()
    }
    further = {name: FurtherColumn(unit) for name, unit in units.items()}
    further |= {
        f"{name}{_UNCERTAINTY}": FurtherColumn(unit, minimum=0.0) for name, unit in units.items()
    }
    table = read_table(given, known, further)
    names = [name for name in table.values if name in columns]
    problems = _faults_of_quantities(table, names, columns)
    values = list[MeasuredValue]()
    for k, place in enumerate(table.places):
        conditions = {
            column.key: table.values[column.key][k]
            for column in table.columns
            if column.quantity is not None
        }
        problems += [f"{place}: {fault}" for fault in _faults_of_conditions(scene, conditions)]
        values += _values_of_row(table, k, conditions, names)
    problems += [
        f"{value.place}: {value.quantity}{_UNCERTAINTY}: must be above 0, the standard uncertainty of the value"
        for value in values
        if not value.uncertainty > 0.0
    ]
    if problems:
        raise faults_of(table.source, problems)
    of_scene = {
        column.key: column.quantity.unit or ""
        for column in table.columns
        if column.quantity is not None
    }
    return MeasuredPoints(
        table=table,
        quantities={name: columns[name] for name in names},
        units={name: units[name] for name in names} | of_scene,
        values=tuple(values),
    )


def _faults_of_conditions(scene: Scene, conditions: Mapping[str, Any]) -> list[str]:
    """Return why a scene under some conditions is no bearing; empty if it is one."""
    try:
        assemble(evolve(scene, conditions, si=True))
    except SceneError as error:
        return [text.removeprefix("changes: ") for text in error.problems]
    except RollslipError as error:
        return [str(error)]
    return []


def _values_of_row(
    table: KeyTable, k: int, conditions: Mapping[str, Any], names: list[str]
) -> list[MeasuredValue]:
    """Return the measured values in row k that have an uncertainty, at the conditions of the row."""
    return [
        MeasuredValue(
            quantity=name,
            place=table.places[k],
            conditions=conditions,
            value=table.values[name][k],
            uncertainty=table.values[f"{name}{_UNCERTAINTY}"][k],
        )
        for name in names
        if f"{name}{_UNCERTAINTY}" in table.values
    ]


def _faults_of_quantities(
    table: KeyTable, names: list[str], columns: Mapping[str, object]
) -> list[str]:
    """Return the faults of the columns of measured values and of their uncertainties."""
    faults = list[str]()
    if not names:
        known = ", ".join(name for name in columns if "/" not in name)
        faults.append(
            f"{table.source}: no column has a measured value; there are {known}, and STUDY/VARIABLE"
        )
    of_table = {column.key: column.unit for column in table.columns}
    faults += [
        f"{table.source}: {name}: its standard uncertainty is missing; add a column "
        f"{as_written(f'{name}{_UNCERTAINTY} [{of_table[name] or 1}]')}"
        for name in names
        if f"{name}{_UNCERTAINTY}" not in of_table
    ]
    faults += [
        f"{table.source}: {key}: has no column {as_written(key.removesuffix(_UNCERTAINTY))}"
        for key in of_table
        if key.endswith(_UNCERTAINTY) and key.removesuffix(_UNCERTAINTY) not in of_table
    ]
    return faults


def compare_points(
    points: MeasuredPoints,
    scene: Scene,
    compute: Compute,
    alternative: str = "",
    report: Report = lambda text, fraction: None,
) -> list[dict[str, Any]]:
    """Return measured and calculated values with their normalised errors, as plain values for an attribute.

    Parameters
    ----------
    points : MeasuredPoints
        The measured values.
    scene : Scene
        The scene.
    compute : callable
        Returns the result of a study, by its name, at a scene, with bands.
    alternative : str
        Label of the scene, where several are compared.
    report : callable
        Receives the progress: a text, and the fraction that is done.
    """
    results = dict[tuple[str, str], Any]()
    records = list[dict[str, Any]]()
    own = resolved(scene)
    for k, point in enumerate(points.values):
        report(f"{alternative} {point.place}".strip(), k / len(points.values))
        study, measurable = points.quantities[point.quantity]
        changed = evolve(scene, point.conditions, si=True)
        key = scene_hash(changed), study.name
        if key not in results:
            try:
                results[key] = compute(changed, study.name)
            except RollslipError as error:
                results[key] = str(error).splitlines()[0]
        calculated = math.nan
        band = None
        status = results[key]
        if not isinstance(results[key], str):
            calculated, status = _calculated(results[key], study, measurable)
            band = _band(results[key], point.quantity)
        low, high = band or (math.nan, math.nan)
        records.append(
            {
                "alternative": alternative,
                "quantity": point.quantity,
                "unit": points.units[point.quantity],
                "place": point.place,
                "conditions": {
                    key: [value, points.units[key]] for key, value in point.conditions.items()
                },
                "differing": [
                    key
                    for key, value in point.conditions.items()
                    if not _is_same(value, _nested(own, key))
                ],
                "measured": point.value,
                "standard_uncertainty": point.uncertainty,
                "calculated": or_none(calculated),
                "low": or_none(low),
                "high": or_none(high),
                "status": status,
                "normalised_error": or_none(_normalised_error(point, calculated, band)),
            }
        )
    return records


def _calculated(
    dataset: "xr.Dataset", study: type[Study], measurable: Measurable
) -> tuple[float, str]:
    """Return the value of a measured quantity in a result, and why it has none."""
    values = dataset[measurable.variable].to_numpy()
    if measurable.steady_index is not None and "stable" in dataset:
        values = values[dataset["stable"].to_numpy() == 1]
    if values.size and values.dtype.kind in "fi":
        value = float(np.ravel(values)[measurable.steady_index or 0])
        if math.isfinite(value):
            return value, ""
    status = study.outputs[measurable.variable].status
    return math.nan, str(dataset[status].item()) if status in dataset else "no value"


def _band(dataset: "xr.Dataset", name: str) -> tuple[float, float] | None:
    """Return the band of a quantity in the answer to a result; None where it has none."""
    rows = account_of(dataset).answer(dataset).rows
    return next((row.band for row in rows if row.key == name), None)


def _normalised_error(
    point: MeasuredValue, calculated: float, band: tuple[float, float] | None
) -> float:
    """Return the normalised error of a calculated value; NaN where there is none, or its band has no end there."""
    expanded = _COVERAGE * point.uncertainty
    of_value = 0.0
    if band is not None:
        end = band[1] if point.value > calculated else band[0]
        if math.isinf(end):
            return math.nan
        of_value = _COVERAGE * abs(end - calculated) / _BAND_SCORE
    return abs(calculated - point.value) / math.hypot(expanded, of_value)


def _is_same(value: object, other: object) -> bool:
    """Whether a condition is the value of the scene."""
    if isinstance(value, float) and isinstance(other, int | float):
        return math.isclose(value, other, rel_tol=_SAME)
    return value == other


def _nested(tables: Any, key: str) -> object:
    """Return the value at a dotted key of nested tables; None where there is none."""
    for part in key.split("."):
        tables = tables.get(part) if isinstance(tables, Mapping) else None
    return tables
