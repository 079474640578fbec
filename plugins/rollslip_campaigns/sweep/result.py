"""Collect the dataset of a sweep: each variable over the dimensions of the sweep, with the status of each point.

- The dataset is read from the journals row by row, at any time; a point that is not done is "pending". Rows and layouts
  are read one at a time, so that the memory is that of the dataset.
- Values are 64-bit floats, NaN where a point has no value; status and message of the point give the reason.
- ``status`` is the status of the point; a variable of the study with this name is called ``study_status``.
- Validity ranges of laws are checked at a few points with a result: the one nearest to the median of all, and some that
  are far apart. A check costs some milliseconds per point; points between them are not checked.
- The point nearest to the median is compared with a run of its scene that has a plan of its own, as in
  ``rollslip run``. Differences above the tolerance are reported. Transient studies are not compared, because the run
  would take as long as the point.
- A coordinate of the study that is the same for all points, such as its cage slips, is a coordinate of the dataset. A
  coordinate that differs between points becomes a variable, and points with fewer values are filled with NaN.
"""

import json
from collections import Counter
from collections.abc import Iterable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import assemble
from rollslip.errors import describe_error
from rollslip.planning.execution import compute
from rollslip.planning.plan import plan
from rollslip.planning.plausibility import implausible
from rollslip.planning.provenance import describe_citations, describe_scene, origin
from rollslip.results.dataset import STATUS_VARIABLE, about, xr
from rollslip.scene.changes import evolve, full_key
from rollslip.studies import validity
from rollslip.studies.bounds import errors_between
from rollslip.studies.study import settings, study_class
from rollslip.units import unit_given
from rollslip_campaigns.sweep.definition import POINT_VARIABLES, Sweep
from rollslip_campaigns.sweep.journal import STATUSES, check_owner, layouts, records
from rollslip_campaigns.sweep.point import unpack_values
from rollslip_campaigns.sweep.sampling import CANDIDATES, Axis, Design, farthest_points

__all__ = ["collect", "deviations_from_run", "origin_of_points"]

#: Number of points, besides the one nearest to the median, at which validity ranges are checked. Twice as many take
#: twice the time, some milliseconds per point, and find more of the points outside a range. Chosen.
_CHECKED_POINTS: Final = 8


def collect(sweep: Sweep, folder: Path) -> "xr.Dataset":
    """Return the dataset of the points that are done so far.

    Parameters
    ----------
    sweep : Sweep
        The sweep.
    folder : Path
        Its folder, with the journals.

    Returns
    -------
    xarray.Dataset
        Outputs of the study, NaN or "" for points without a result; ``status``, one of "ok", "pending" and the statuses
        of failures; ``message``; ``seconds`` [s].
    """
    check_owner(folder, sweep.hash)
    design = sweep.design
    size = design.size
    status = np.full(size, "pending", dtype=f"<U{max(map(len, (*STATUSES, 'pending')))}")
    message = np.full(size, "", dtype=object)
    seconds = np.full(size, np.nan)
    for row in records(folder):
        if status[row.number] != "ok":
            status[row.number] = row.status
            message[row.number] = row.message
            seconds[row.number] = row.seconds
    fields = _OutputArrays(map(json.loads, layouts(folder)), size)
    parse_layout = lru_cache(maxsize=256)(json.loads)
    stored = set[int]()
    for row in records(folder, "where status = ?", "ok"):
        if row.number not in stored:
            stored.add(row.number)
            fields.fill(row.number, parse_layout(row.layout), row.numbers, row.texts)
    dims = sweep.dims
    names = sweep.names
    result_names = {
        name: f"study_{name}" if name in POINT_VARIABLES else name for name in fields.arrays
    }
    outputs = settings(sweep.scene, sweep.study)[sweep.study].outputs
    variables = dict[str, Any]()
    for name, (over, values, attributes) in fields.variables(dims, design.shape).items():
        if name in outputs and (status_name := result_names.get(outputs[name].status)):
            attributes[STATUS_VARIABLE] = status_name
        variables[result_names[name]] = (over, values, attributes)
    variables |= {
        "status": (dims, status.reshape(design.shape), about("1", "how the point ended")),
        "message": (dims, message.reshape(design.shape), about("1", "why it is not ok")),
        "seconds": (dims, seconds.reshape(design.shape), about("s", "time that the point took")),
    }
    coords = {
        names[axis.key]: (
            names[axis.key],
            axis.coordinate,
            _about(axis.quantity) | _unit_of_axis(axis),
        )
        for axis in design.axes
    }
    if design.has_samples:
        coords["sample"] = ("sample", np.arange(len(design.samples)), about("1", "sample"))
        coords |= {
            names[quantity.key]: ("sample", design.samples[:, k], _about(quantity))
            for k, quantity in enumerate(design.sampled)
        }
    return xr.Dataset(variables, coords | fields.coords, _attributes(sweep, status))


def deviations_from_run(sweep: Sweep, dataset: "xr.Dataset") -> list[str]:
    """Return a warning if the point nearest to the median differs from a run of its scene by more than the tolerance.

    Parameters
    ----------
    sweep : Sweep
        The sweep.
    dataset : xarray.Dataset
        Its dataset, from `collect`.
    """
    done = np.flatnonzero(dataset["status"].to_numpy().ravel() == "ok")
    cls = study_class(sweep.study)
    if not done.size or cls.is_transient or sweep.errors:  # such points are runs
        return []
    number = _spread_numbers(sweep.design, done)[0]
    point = dataset.isel(
        dict(zip(sweep.dims, np.unravel_index(number, sweep.design.shape), strict=True))
    )
    try:
        run_plan = plan(evolve(sweep.scene, sweep.design.changes(number), si=True), sweep.study)
        run = compute(run_plan, sweep.study).dataset
    except Exception as error:
        # a third-party law may raise anything; the dataset is valid all the same
        return [
            f"how far points are off could not be checked at {sweep.design.describe_point(number)}, by a run of the "
            f"scene: {describe_error(error)}"
        ]
    accuracy_keys = {output: key for key, output in cls.controlled_outputs.items()}
    compared = {
        name: accuracy_keys.get(name, name)
        for name in sweep.outputs
        if name in run and name in point and run[name].dtype.kind == "f"
        if run[name].shape == point[name].shape
    }
    deviations = {
        name: errors_between({key: name}, point, run).get(key, 0.0)
        for name, key in compared.items()
    }
    accuracy = run_plan.scene.accuracy
    excessive = [name for name, key in compared.items() if deviations[name] > accuracy.of(key)]
    if not excessive:
        return []
    differences = ", ".join(f"{name} is {deviations[name]:.1e}" for name in excessive)
    return [
        f"at {sweep.design.describe_point(number)} {differences} off a run of the scene, more than the tolerance of "
        f"{accuracy.tolerance:g}; the others of {done.size} points were not run so, and may be as far "
        "off: lower accuracy.tolerance, or run the scene with the values of a point"
    ]


def _unit_of_axis(axis: Axis) -> dict[str, str]:
    """Attribute for figures with the unit in which the values of an axis were given, if it is the same for all."""
    unit = axis.quantity.unit
    units = {unit_given(value, unit) for value in axis.listed} if unit else set()
    given = axis.given_unit or (units.pop() if len(units) == 1 else unit)
    return {} if given is None or given == unit else {"written_in": given}


def _about(quantity: Any) -> dict[str, Any]:
    """Attributes of the coordinate of a quantity."""
    return about(quantity.unit or "1", quantity.doc) | {"key": quantity.key}


def _attributes(sweep: Sweep, status: "np.ndarray[Any, Any]") -> dict[str, Any]:
    """Attributes of the dataset: origin, numbers of points by status, and warnings."""
    selected = status[np.fromiter(sweep.numbers, dtype=int)]
    counts = {name: int((selected == name).sum()) for name in (*STATUSES, "pending")}
    lost = [f"{count} {name}" for name, count in counts.items() if count and name != "ok"]
    warnings = (
        [
            f"{selected.size - counts['ok']} of {selected.size} points have no result: {', '.join(lost)}"
        ]
        if lost
        else []
    )
    exceeded = _describe_validity(
        sweep, _spread_numbers(sweep.design, np.flatnonzero(status == "ok"))
    )
    return origin_of_points(
        sweep,
        [*warnings, *exceeded["unchecked"]],
        exceeded,
        study="sweep",
        swept=sweep.study,
        **_closure(sweep),
        sweep_hash=sweep.hash,
        axes=sweep.facts["axes"],
        sampling=sweep.table.sampling if sweep.design.has_samples else "",
        counts=counts,
    )


def origin_of_points(
    sweep: Sweep, warnings: Iterable[str], validity: Mapping[str, Any], **facts: Any
) -> dict[str, Any]:
    """Return the attributes of a dataset of points: facts of the campaign, and the origin of the points.

    Parameters
    ----------
    sweep : Sweep
        The sweep of the points.
    warnings : iterable of str
        Warnings of the campaign, which come first.
    validity : mapping
        Record of exceeded validity ranges, as in the attribute of a dataset of points; empty for none.
    **facts : object
        Further attributes.
    """
    varied_keys = {*map(full_key, [*sweep.table.over, *sweep.design.keys])}
    outside = [message["text"] for message in validity.get("messages", ()) if message["is_warning"]]
    return origin(
        **facts,
        **describe_scene(sweep.scene, sweep.given),
        resolutions=sweep.resolutions.facts,
        distributions={k: repr(d) for k, d in sweep.uncertainty.distributions.items()},
        correlation=sweep.uncertainty.correlation.tolist(),
        seed=sweep.table.seed,
        packages=sweep.facts["packages"],
        **describe_citations(sweep.citations),
        validity=validity,
        warnings=[*warnings, *implausible(sweep.given, varied_keys), *sweep.unusual, *outside],
    )


def _spread_numbers(design: Design, numbers_done: "np.ndarray[Any, Any]") -> list[int]:
    """Numbers of some points with a result: the one nearest to the median, then some that are far apart."""
    if not numbers_done.size:
        return []
    candidates = numbers_done[
        np.unique(np.linspace(0, numbers_done.size - 1, CANDIDATES).astype(int))
    ]
    indices = np.stack(np.unravel_index(candidates, design.shape), axis=-1)
    columns = [
        axis.coordinate[indices[:, k]] if axis.coordinate.dtype.kind in "if" else indices[:, k]
        for k, axis in enumerate(design.axes)
    ]
    columns += [*design.samples[indices[:, -1]].T] if design.has_samples else []
    rows = np.array(columns, dtype=float).T
    distance_to_median = np.linalg.norm(
        (rows - np.median(rows, axis=0)) / np.maximum(np.ptp(rows, axis=0), 1e-300), axis=1
    )
    return [
        int(candidates[k])
        for k in dict.fromkeys(
            [int(np.argmin(distance_to_median)), *farthest_points(rows, _CHECKED_POINTS)]
        )
    ]


def _describe_validity(sweep: Sweep, numbers: list[int]) -> dict[str, list[Any]]:
    """Record of exceeded validity ranges: of each the most severe message, and at how many of some points."""
    severest = dict[tuple[str, str], validity.ValidityMessage]()
    counts = Counter[tuple[str, str]]()
    unchecked = list[str]()
    for number in numbers:
        try:
            messages = _validity_at(sweep, number)
        except Exception as error:
            # a third-party law may raise anything; the dataset is valid all the same
            unchecked.append(
                f"whether laws are within their range of validity could not be checked at "
                f"{sweep.design.describe_point(number)}: {describe_error(error)}"
            )
            continue
        counts.update(
            {(message.law, message.made_for) for message in messages}
        )  # of both rings once
        for message in messages:
            key = message.law, message.made_for
            known = severest.setdefault(key, message)
            if (message.is_warning, message.severity) > (known.is_warning, known.severity):
                severest[key] = message
    all_points = (
        "all points" if len(numbers) == len(sweep.numbers) else f"all {len(numbers)} points checked"
    )
    return {
        "messages": [
            attrs.asdict(message)
            | {
                "text": f"at {counts[key]} of {len(numbers)} points checked: {message.text}",
                "where": f"at {all_points}"
                if counts[key] == len(numbers)
                else f"at {counts[key]} of {len(numbers)} points checked",
            }
            for key, message in severest.items()
        ],
        "unchecked": unchecked[:1],
    }


def _validity_at(sweep: Sweep, number: int) -> list[validity.ValidityMessage]:
    """Messages on validity ranges that are exceeded at a point, for the state that its study expects."""
    changes = sweep.design.changes(number)
    scene = evolve(sweep.scene, changes, si=True)
    assembly = assemble(scene, sweep.resolutions.lookup(changes))
    study = settings(scene, sweep.study)[sweep.study]
    bearing = assembly.with_resistance() if study.with_cage else assembly
    state, contacts = study.expected_slices(bearing)
    outside, off = validity.check_validity(contacts, bearing, assembly.traction)
    return validity.validity_messages(
        outside,
        off,
        f"at {sweep.design.describe_point(number)}, {state}",
        tolerance=scene.accuracy.tolerance,
    )


def _closure(sweep: Sweep) -> dict[str, str]:
    """Attribute with the closure of the curves of all points; none where the closure varies or the study has none."""
    if any(key.startswith(f"study.{sweep.study}.") for key in sweep.facts["axes"]):
        return {}
    closure = settings(sweep.scene, sweep.study)[sweep.study].curves_with
    return {"curves_with": closure} if closure else {}


class _OutputArrays:
    """Arrays of the outputs, with the maximum size of each inner dimension over all layouts."""

    def __init__(self, layouts: Iterable[Mapping[str, Any]], size: int) -> None:
        self.shapes: dict[str, dict[str, int]] = {}
        self.attributes: dict[str, Mapping[str, Any]] = {}
        self.is_text: dict[str, bool] = {}
        # the first coordinate of each dimension; None if that layout has none
        self.first_coordinates: dict[str, Any] = {}
        self.varying_dims: set[str] = set()
        self.longest_coordinates: dict[str, dict[str, Any]] = {}
        for layout in layouts:
            for name, variable in layout["variables"].items():
                largest = self.shapes.setdefault(name, dict.fromkeys(variable["dims"], 0))
                for dim, length in zip(variable["dims"], variable["shape"], strict=True):
                    largest[dim] = max(largest.get(dim, 0), length)
                self.attributes.setdefault(name, variable["attrs"])
                self.is_text[name] = self.is_text.get(name, False) or variable["text"]
            for dim in _dims(layout):
                coordinate = layout["coords"].get(dim)
                if self.first_coordinates.setdefault(dim, coordinate) != coordinate:
                    self.varying_dims.add(dim)
                if coordinate:
                    self.longest_coordinates[dim] = max(
                        self.longest_coordinates.get(dim, coordinate),
                        coordinate,
                        key=lambda known: len(known["values"]),
                    )
        self._split_coordinates()
        self.arrays = {
            name: np.full(
                (size, *dims.values()),
                "" if self.is_text[name] else np.nan,
                dtype=object if self.is_text[name] else float,
            )
            for name, dims in self.shapes.items()
        }

    def _split_coordinates(self) -> None:
        """Separate the coordinates that all points share from those that become variables."""
        self.coords: dict[str, Any] = {}
        self.index_names: dict[str, str] = {}
        for dim in dict.fromkeys(dim for dims in self.shapes.values() for dim in dims):
            first = self.first_coordinates[dim]
            if first is not None and dim not in self.varying_dims:
                self.coords[dim] = (dim, np.array(first["values"]), first["attrs"])
            elif dim in self.longest_coordinates:
                longest = self.longest_coordinates[dim]
                self.index_names[dim] = f"{dim}_index"
                self.shapes[dim] = {dim: len(longest["values"])}
                self.attributes[dim] = longest["attrs"]
                self.is_text[dim] = longest["text"]

    def fill(self, number: int, layout: Mapping[str, Any], numbers: bytes, texts: str) -> None:
        """Set the values of a point from its row."""
        values = unpack_values(layout, numbers, texts)
        for dim in self.index_names.keys() & _dims(layout):
            values[dim] = (
                np.array(layout["coords"][dim]["values"])
                if dim in layout["coords"]
                else np.arange(0)
            )
        for name, array in values.items():
            index: tuple[Any, ...] = (number, *map(slice, array.shape))
            self.arrays[name][index] = array

    def variables(self, dims: tuple[str, ...], shape: tuple[int, ...]) -> dict[str, Any]:
        """Return dimensions, values and attributes of each variable, over the dimensions of the sweep."""
        return {
            name: (
                (*dims, *(self.index_names.get(dim, dim) for dim in self.shapes[name])),
                (array.astype(str) if self.is_text[name] else array).reshape(
                    (*shape, *array.shape[1:])
                ),
                dict(self.attributes[name]),
            )
            for name, array in self.arrays.items()
        }


def _dims(layout: Mapping[str, Any]) -> set[str]:
    """Dimensions of all variables of a layout."""
    return {dim for variable in layout["variables"].values() for dim in variable["dims"]}
