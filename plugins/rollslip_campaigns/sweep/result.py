"""The dataset of a sweep: every variable over the dimensions of the sweep, with the status of every point.

- It is read from the journals row by row, and can be made at any time; a point that is not done yet is "pending".
- What it takes of memory is the dataset: rows and layouts, of which every point may have its own, are read one by one.
- Values are 64-bit floats, NaN where a point has none; its status and message say why. Nothing is left out.
- ``status`` is that of the point; a study's own variable of this name is ``study_status``.
- Whether laws are used for what they were made for is judged at a few points that have a result: the one in the middle
  and those that lie farthest apart. It costs some milliseconds a point, and what lies between them is not looked at.
- The point in the middle is held against a run of its scene by a plan of its own, as ``rollslip run`` makes it; motions
  in time are not, which take as long once more. What the two differ by beyond the tolerance is told.
- A coordinate of the study that is the same for all points, such as its cage slips, is one of the dataset. Where it
  differs between points it becomes a variable of its own over them, and points with fewer values are filled with NaN.
"""

import json
from collections import Counter
from collections.abc import Iterable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rollslip.bearing.assembly import assemble
from rollslip.errors import describe_error
from rollslip.planning.execution import compute
from rollslip.planning.plan import plan
from rollslip.planning.plausibility import implausible
from rollslip.planning.provenance import describe_citations, describe_scene, origin
from rollslip.results.dataset import STATUS_VARIABLE, about
from rollslip.results.words import describe_more_bounds
from rollslip.scene.changes import evolve, full_key
from rollslip.studies import validity
from rollslip.studies.error_estimate import errors_between
from rollslip.studies.study import settings, study_class
from rollslip.units import unit_given
from rollslip_campaigns.sweep.definition import POINT_VARIABLES, Sweep
from rollslip_campaigns.sweep.journal import STATUSES, check_owner, layouts, records
from rollslip_campaigns.sweep.point import unpack_values
from rollslip_campaigns.sweep.sampling import Axis, Design, farthest_points

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["deviations_from_run", "collect", "origin_of_points"]

#: Points at which laws are judged beside the one in the middle, and those among which they are looked for.
_CORNERS: Final = 8
_CANDIDATES: Final = 512
#: Bounds that are told in full, at most.
_TOLD: Final = 3


def collect(sweep: Sweep, folder: Path) -> "xr.Dataset":
    """Return what a sweep has given so far."""
    import xarray as xr

    check_owner(folder, sweep.hash)
    design = sweep.design
    size = sweep.design.size
    status = np.full(size, "pending", dtype=f"<U{max(map(len, (*STATUSES, 'pending')))}")
    message = np.full(size, "", dtype=object)
    seconds = np.full(size, np.nan)
    for row in records(folder):
        if status[row.number] != "ok":
            status[row.number] = row.status
            message[row.number] = row.message
            seconds[row.number] = row.seconds
    fields = _Fields(map(json.loads, layouts(folder)), size)
    parsed = lru_cache(maxsize=256)(json.loads)
    filled = set[int]()
    for row in records(folder, "where status = ?", "ok"):
        if row.number not in filled:
            filled.add(row.number)
            fields.fill(row.number, parsed(row.layout), row.numbers, row.texts)
    dims = sweep.dims
    names = sweep.names
    called = {name: f"study_{name}" if name in POINT_VARIABLES else name for name in fields.arrays}
    known = settings(sweep.scene, sweep.study)[sweep.study].outputs
    told = {name: called.get(one.status) for name, one in known.items()}
    variables = {
        called[name]: (of, values, said | ({STATUS_VARIABLE: by} if (by := told.get(name)) else {}))
        for name, (of, values, said) in fields.variables(dims, design.shape).items()
    }
    variables |= {
        "status": (dims, status.reshape(design.shape), about("1", "how the point ended")),
        "message": (dims, message.reshape(design.shape), about("1", "why it is not ok")),
        "seconds": (dims, seconds.reshape(design.shape), about("s", "time that the point took")),
    }
    coords = {
        names[axis.key]: (names[axis.key], axis.coordinate, _about(axis.quantity) | _written(axis))
        for axis in design.axes
    }
    if design.has_samples:
        coords["sample"] = ("sample", np.arange(len(design.samples)), about("1", "sample"))
        coords |= {
            names[of.key]: ("sample", design.samples[:, k], _about(of))
            for k, of in enumerate(design.sampled)
        }
    return xr.Dataset(variables, coords | fields.coords, _attributes(sweep, status))


def deviations_from_run(sweep: Sweep, dataset: "xr.Dataset") -> list[str]:
    """Return by how much the point in the middle differs from a run of its scene, where that is too much."""
    done = np.flatnonzero(dataset["status"].to_numpy().ravel() == "ok")
    cls = study_class(sweep.study)
    if not done.size or cls.is_transient:
        return []
    number = _corners(sweep.design, done)[0]
    point = dataset.isel(
        dict(zip(sweep.dims, np.unravel_index(number, sweep.design.shape), strict=True))
    )
    try:
        made = plan(evolve(sweep.scene, sweep.design.changes(number)), sweep.study)
        run = compute(made, sweep.study).dataset
    except Exception as error:  # somebody's law may raise anything; what was computed stands
        place = sweep.design.shown(number)
        return [
            f"how far points are off could not be checked at {place}, by a run of the scene: {describe_error(error)}"
        ]
    keys = {of: key for key, of in cls.controlled_outputs.items()}
    alike = [of for of in sweep.outputs if of in run and of in point and run[of].dtype.kind == "f"]
    errors = {
        of: apart
        for of in alike
        if run[of].shape == point[of].shape
        and (apart := errors_between({keys.get(of, of): of}, point, run).get(keys.get(of, of), 0.0))
        > made.scene.accuracy.of(keys.get(of, of))
    }
    if not errors:
        return []
    off = ", ".join(f"{of} is {apart:.1e}" for of, apart in errors.items())
    return [
        f"at {sweep.design.shown(number)} {off} off a run of the scene, more than the tolerance of "
        f"{made.scene.accuracy.tolerance:g}; the others of {done.size} points were not run so, and may be as far off: "
        "lower accuracy.tolerance, or run the scene with the values of a point"
    ]


def _written(axis: Axis) -> dict[str, str]:
    """The unit in which the values of an axis were given, for figures, where all have the same."""
    unit = axis.quantity.unit
    given = (
        {axis.given}
        if axis.given
        else {unit_given(value, unit) for value in axis.listed}
        if unit
        else set()
    )
    return {"written_in": one} if len(given) == 1 and (one := str(given.pop())) != unit else {}


def _about(quantity: Any) -> dict[str, Any]:
    return about(quantity.unit or "1", quantity.doc) | {"key": quantity.key}


def _attributes(sweep: Sweep, status: "np.ndarray[Any, Any]") -> dict[str, Any]:
    own = status[np.fromiter(sweep.numbers, dtype=int)]
    counts = {name: int((own == name).sum()) for name in (*STATUSES, "pending")}
    lost = [f"{count} {name}" for name, count in counts.items() if count and name != "ok"]
    warnings = (
        [f"{own.size - counts['ok']} of {own.size} points have no result: {', '.join(lost)}"]
        if lost
        else []
    )
    left = _left(sweep, _corners(sweep.design, np.flatnonzero(status == "ok")))
    return origin_of_points(
        sweep,
        warnings,
        left,
        study="sweep",
        swept=sweep.study,
        **_resting(sweep),
        sweep_hash=sweep.hash,
        axes=sweep.facts["axes"],
        sampling=sweep.table.sampling if sweep.design.has_samples else "",
        counts=counts,
        left=left,
    )


def origin_of_points(
    sweep: Sweep, warnings: Iterable[str], outside: Iterable[str], **facts: Any
) -> dict[str, Any]:
    """Return facts as attributes of a campaign, with where its points come from; `outside` is said of their laws."""
    moved = {*map(full_key, sweep.table.over)}
    return origin(
        **facts,
        **describe_scene(sweep.scene, sweep.given),
        resolutions=sweep.resolutions.facts,
        distributions={k: repr(d) for k, d in sweep.uncertainty.distributions.items()},
        correlation=sweep.uncertainty.correlation.tolist(),
        seed=sweep.table.seed,
        packages=sweep.facts["packages"],
        **describe_citations(sweep.citations),
        warnings=[*warnings, *implausible(sweep.given, moved), *sweep.unusual, *outside],
    )


def _corners(design: Design, done: "np.ndarray[Any, Any]") -> list[int]:
    """Numbers of some points that have a result: in the middle of all, and as far apart as can be."""
    if not done.size:
        return []
    some = done[np.unique(np.linspace(0, done.size - 1, _CANDIDATES).astype(int))]
    places = np.stack(np.unravel_index(some, design.shape), axis=-1)
    columns = [
        axis.coordinate[places[:, k]] if axis.coordinate.dtype.kind in "if" else places[:, k]
        for k, axis in enumerate(design.axes)
    ]
    columns += [*design.samples[places[:, -1]].T] if design.has_samples else []
    rows = np.array(columns, dtype=float).T
    middle = np.linalg.norm(
        (rows - np.median(rows, axis=0)) / np.maximum(np.ptp(rows, axis=0), 1e-300), axis=1
    )
    return [
        int(some[k])
        for k in dict.fromkeys([int(np.argmin(middle)), *farthest_points(rows, _CORNERS)])
    ]


def _left(sweep: Sweep, numbers: list[int]) -> list[str]:
    """Say at how many of some points laws are outside what they were made for, each where it matters most."""
    worst = dict[tuple[str, str], validity.Told]()
    count = Counter[tuple[str, str]]()
    others = list[str]()
    for number in numbers:
        try:
            said = _told(sweep, number)
        except Exception as error:  # somebody's law may raise anything; what was computed stands
            others.append(
                f"whether laws are within their range of validity could not be checked at "
                f"{sweep.design.shown(number)}: {describe_error(error)}"
            )
            continue
        for one in said:
            key = one.law, one.made_for
            count[key] += 1
            known = worst.setdefault(key, one)
            if (one.warned, one.weight) > (known.warned, known.weight):
                worst[key] = one
    ranked = sorted(
        worst, key=lambda key: (not worst[key].warned, not worst[key].measured, -worst[key].weight)
    )
    first = [key for key in ranked[:_TOLD] if worst[key].warned]
    found = [
        f"at {count[key]} of {len(numbers)} points checked: {worst[key].text}" for key in first
    ]
    if more := [f"{worst[key].short} at {count[key]} of them" for key in ranked[len(first) :]]:
        found.append(describe_more_bounds(more))
    if found:
        which = (
            f"only {len(numbers)} of {len(sweep.numbers)} points were checked, which lie far apart"
        )
        whole = "all points were checked" if len(numbers) == len(sweep.numbers) else which
        found[-1] += (
            f"; {whole}; rollslip run of the scene with the values of a point tells all of it"
        )
    return [*found, *others[:1]]


def _told(sweep: Sweep, number: int) -> list[validity.Told]:
    """Return what laws are outside of at a point, with its values, where the study expects it to be."""
    changes = sweep.design.changes(number)
    scene = evolve(sweep.scene, changes)
    assembly = assemble(scene, sweep.resolutions.lookup(changes))
    study = settings(scene, sweep.study)[sweep.study]
    bearing = assembly.with_resistance() if study.with_cage else assembly
    state, contacts = study.expected_slices(bearing)
    outside, off = validity.judged(contacts, bearing, assembly.traction)
    where = f"at {sweep.design.shown(number)}, {state}"
    return validity.told(outside, off, where, tolerance=scene.accuracy.tolerance)


def _resting(sweep: Sweep) -> dict[str, str]:
    """What the curves of all points rest on, as their study says it; nothing where that varies."""
    if any(key.startswith(f"study.{sweep.study}.") for key in sweep.facts["axes"]):
        return {}
    said = settings(sweep.scene, sweep.study)[sweep.study].curves_with
    return {"curves_with": said} if said else {}


class _Fields:
    """The arrays of the outputs, large enough for every layout."""

    def __init__(self, layouts: Iterable[Mapping[str, Any]], size: int) -> None:
        self.shapes: dict[str, dict[str, int]] = {}
        self.said: dict[str, Mapping[str, Any]] = {}
        self.text: dict[str, bool] = {}
        self.first: dict[
            str, Any
        ] = {}  # coordinate of a dimension, None where that layout has none
        self.differ: set[str] = set()
        self.longest: dict[str, dict[str, Any]] = {}
        for layout in layouts:
            for name, of in layout["variables"].items():
                self._variable(name, of)
            for dim in _dims(layout):
                self._coordinate(dim, layout["coords"].get(dim))
        self._same_or_own()
        self.arrays = {
            name: np.full(
                (size, *dims.values()),
                "" if self.text[name] else np.nan,
                dtype=object if self.text[name] else float,
            )
            for name, dims in self.shapes.items()
        }

    def _variable(self, name: str, of: Mapping[str, Any]) -> None:
        largest = self.shapes.setdefault(name, dict.fromkeys(of["dims"], 0))
        for dim, length in zip(of["dims"], of["shape"], strict=True):
            largest[dim] = max(largest.get(dim, 0), length)
        self.said.setdefault(name, of["attrs"])
        self.text[name] = self.text.get(name, False) or of["text"]

    def _coordinate(self, dim: str, coordinate: Any) -> None:
        if self.first.setdefault(dim, coordinate) != coordinate:
            self.differ.add(dim)
        if coordinate:
            self.longest[dim] = max(
                self.longest.get(dim, coordinate),
                coordinate,
                key=lambda known: len(known["values"]),
            )

    def _same_or_own(self) -> None:
        """Tell coordinates that all points share from those that become variables."""
        self.coords: dict[str, Any] = {}
        self.own: dict[str, str] = {}
        for dim in dict.fromkeys(dim for dims in self.shapes.values() for dim in dims):
            first = self.first[dim]
            if first is not None and dim not in self.differ:
                self.coords[dim] = (dim, np.array(first["values"]), first["attrs"])
            elif dim in self.longest:
                longest = self.longest[dim]
                self.own[dim] = f"{dim}_index"
                self.shapes[dim] = {dim: len(longest["values"])}
                self.said[dim] = longest["attrs"]
                self.text[dim] = longest["text"]

    def fill(self, number: int, layout: Mapping[str, Any], numbers: bytes, texts: str) -> None:
        """Set the values of a point."""
        values = unpack_values(layout, numbers, texts)
        dims = _dims(layout)
        for dim in self.own.keys() & dims:
            values[dim] = (
                np.array(layout["coords"][dim]["values"])
                if dim in layout["coords"]
                else np.arange(0)
            )
        for name, array in values.items():
            place: tuple[Any, ...] = (number, *map(slice, array.shape))
            self.arrays[name][place] = array

    def variables(self, dims: tuple[str, ...], shape: tuple[int, ...]) -> dict[str, Any]:
        """Return the arrays over the dimensions of the sweep."""
        return {
            name: (
                (*dims, *(self.own.get(dim, dim) for dim in self.shapes[name])),
                (array.astype(str) if self.text[name] else array).reshape(
                    (*shape, *array.shape[1:])
                ),
                dict(self.said[name]),
            )
            for name, array in self.arrays.items()
        }


def _dims(layout: Mapping[str, Any]) -> set[str]:
    return {dim for of in layout["variables"].values() for dim in of["dims"]}
