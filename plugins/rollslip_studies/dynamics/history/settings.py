"""Settings of an operation that varies over time: one time function for each value, or a file of measured values.

The keys belong to the table of the study that integrates over time, not to ``[operation]``: all studies of a steady
bearing read ``[operation]``, and without a duration a history has no meaning. A value without a time function stays as
``[operation]`` states it.
"""

import hashlib
from collections.abc import Mapping
from functools import cached_property, lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.errors import SceneError
from rollslip.fields import FieldError, field, non_negative, positive, refuse_if
from rollslip.files import content_of, decoded, read_columns
from rollslip.scene.values import Operation, Scene
from rollslip.search import Array
from rollslip.structure import Location
from rollslip.units import format_quantity, quantity
from rollslip_studies.dynamics.history.temperature_path import ThermalPath
from rollslip_studies.dynamics.history.time_functions import (
    OF_DIRECTION,
    OF_SPEEDS,
    Course,
    CourseSettings,
    constant,
    table,
    unordered,
)

#: Temperatures that equal that of the operation unless the scene gives another.
PART_TEMPERATURES: Final = (
    "inner_ring_temperature",
    "roller_temperature",
    "outer_ring_temperature",
)
#: All temperatures of the operation.
TEMPERATURES: Final = ("temperature", *PART_TEMPERATURES)
#: Values of the operation that may have a time function.
VARYING: Final = ("inner_speed", "outer_speed", "radial_load", "load_direction", *TEMPERATURES)
#: Values of the operation that tables of loads and friction depend on.
CONDITIONS: Final = ("radial_load", *TEMPERATURES)
#: Maximum number of faults of a file that a message lists. Chosen: about as many as fit on a screen.
_MAX_FAULTS: Final = 20
#: Number of rows from which a file is read by NumPy. Below it the general reader takes less than 0.1 s. Chosen.
_MIN_ROWS: Final = 1000
#: Amount, relative to the largest value, by which a function that ends at 0 may fall below it, by rounding.
_ROUNDING: Final = 1e-12
#: Difference, relative to the product of the largest ring speeds, up to which speeds are in proportion, by rounding.
_PROPORTION_TOLERANCE: Final = 1e-12


def _like(name: str) -> dict[str, Any]:
    """Unit and ranges of a value of the operation; a direction has any number of turns."""
    if name == "load_direction":
        return {"unit": "rad", "possible": (-1e12, 1e12)}
    known = attrs.fields_dict(Operation)[name].metadata
    return {key: known[key] for key in ("unit", "possible")}


def _value(name: str, doc: str, key: str | None = None, validator: Any = None) -> Any:
    """Return an optional field with unit and ranges of a value of the operation."""
    optional = None if validator is None else attrs.validators.optional(validator)
    return field(default=None, doc=doc, key=key, validator=optional, **_like(name))


def _values(name: str, validator: Any = None) -> Any:
    """Return a field for the values of a table, with unit and ranges of a value of the operation."""
    for_each = None if validator is None else attrs.validators.deep_iterable(validator)
    return field(
        default=(), doc="values of a table at its times", validator=for_each, **_like(name)
    )


_AMPLITUDE: Final = "amplitude of a sine"
#: Name of a value -> what to write where it would fall below 0.
_ADVICE_BELOW_ZERO: Final = {
    "radial_load": "; a load that turns back has a load_direction of 180 deg from there on"
}
_FROM = "value before the change"
_TO = "value after the change"
_OF_SPEEDS = dict.fromkeys(OF_SPEEDS, "speeds")
_OF_DIRECTION = dict.fromkeys(OF_DIRECTION, "the direction of the load")
_MEAN: Final = "mean of a sine, by default that of [operation]"


@attrs.frozen(kw_only=True)
class SpeedCourse(CourseSettings):
    """The speed of a ring over time."""

    others: ClassVar[Mapping[str, str]] = MappingProxyType(_OF_DIRECTION)

    from_: float | None = _value(
        "inner_speed", f"{_FROM}, by default that of [operation]; of a run-up 0", "from"
    )
    to: float | None = _value(
        "inner_speed", f"{_TO}; by default 0, of a run-up that of [operation]"
    )
    mean: float | None = _value("inner_speed", _MEAN)
    amplitude: float | None = _value("inner_speed", _AMPLITUDE)
    value: tuple[float, ...] = _values("inner_speed")


@attrs.frozen(kw_only=True)
class LoadCourse(CourseSettings):
    """The radial load over time."""

    others: ClassVar[Mapping[str, str]] = MappingProxyType(_OF_SPEEDS | _OF_DIRECTION)

    from_: float | None = _value(
        "radial_load", f"{_FROM}, by default that of [operation]", "from", non_negative
    )
    to: float | None = _value("radial_load", _TO, None, non_negative)
    mean: float | None = _value("radial_load", _MEAN, None, non_negative)
    amplitude: float | None = _value("radial_load", _AMPLITUDE, None, non_negative)
    value: tuple[float, ...] = _values("radial_load", non_negative)


@attrs.frozen(kw_only=True)
class DirectionCourse(CourseSettings):
    """The direction of the radial load over time, in the sense of positive speeds."""

    others: ClassVar[Mapping[str, str]] = MappingProxyType(_OF_SPEEDS)

    from_: float | None = _value("load_direction", f"{_FROM}, by default 0", "from")
    to: float | None = _value("load_direction", _TO)
    mean: float | None = _value("load_direction", "mean of a sine, by default 0")
    amplitude: float | None = _value("load_direction", _AMPLITUDE)
    speed: float | None = _value("inner_speed", "speed of a rotation")
    value: tuple[float, ...] = _values("load_direction")


@attrs.frozen(kw_only=True)
class TemperatureCourse(CourseSettings):
    """A temperature over time."""

    others: ClassVar[Mapping[str, str]] = MappingProxyType(_OF_SPEEDS | _OF_DIRECTION)

    from_: float | None = _value(
        "temperature", f"{_FROM}, by default that of [operation]", "from", positive
    )
    to: float | None = _value("temperature", _TO, None, positive)
    mean: float | None = _value("temperature", _MEAN, None, positive)
    amplitude: float | None = field(
        default=None,
        unit="K",
        doc=f"{_AMPLITUDE}, a difference: in K",
        validator=attrs.validators.optional(positive),
    )
    value: tuple[float, ...] = _values("temperature", positive)


def _column(name: str, doc: str) -> Any:
    """Return a positive field of a row with unit and ranges of a value of the operation."""
    return field(default=None, doc=doc, validator=positive, **_like(name))


@attrs.frozen(kw_only=True)
class _Row:
    """A row of a file of measured values."""

    time: float = field(unit="s", doc="time")
    inner_speed: float = field(default=None, doc="speed of the inner ring", **_like("inner_speed"))
    outer_speed: float = field(default=None, doc="speed of the outer ring", **_like("outer_speed"))
    radial_load: float = field(
        default=None, doc="radial load", validator=non_negative, **_like("radial_load")
    )
    load_direction: float = field(
        default=None, doc="direction of the load", **_like("load_direction")
    )
    temperature: float = _column("temperature", "temperature")
    inner_ring_temperature: float = _column(
        "inner_ring_temperature", "temperature of the inner ring"
    )
    roller_temperature: float = _column("roller_temperature", "temperature of the rollers")
    outer_ring_temperature: float = _column(
        "outer_ring_temperature", "temperature of the outer ring"
    )


@attrs.frozen(kw_only=True)
class HistorySettings:
    """Values of the operation that vary over time."""

    inner_speed: SpeedCourse | None = field(default=None, doc="speed of the inner ring over time")
    outer_speed: SpeedCourse | None = field(default=None, doc="speed of the outer ring over time")
    radial_load: LoadCourse | None = field(default=None, doc="radial load over time")
    load_direction: DirectionCourse | None = field(
        default=None, doc="direction of the radial load over time, in the sense of positive speeds"
    )
    temperature: TemperatureCourse | None = field(
        default=None, doc="temperature over time, of all parts that have none of their own"
    )
    inner_ring_temperature: TemperatureCourse | None = field(
        default=None, doc="temperature of the inner ring over time"
    )
    roller_temperature: TemperatureCourse | None = field(
        default=None, doc="temperature of the rollers over time"
    )
    outer_ring_temperature: TemperatureCourse | None = field(
        default=None, doc="temperature of the outer ring over time"
    )
    file: str = field(
        default="",
        doc="CSV with columns time [s] and any of inner_speed [rpm], outer_speed [rpm], radial_load [N], "
        "load_direction [deg], temperature [degC] and those of the parts, in any units; its place is relative to that "
        "of the scene",
    )

    def __attrs_post_init__(self) -> None:
        refuse_if(
            not self.file and not any(getattr(self, name) for name in VARYING),
            "file",
            f"nothing changes: give a table for one of {', '.join(VARYING)}, or a file",
        )

    def history(self, scene: Scene, duration: float, where: Location) -> "History":
        """Return the time functions of a run.

        Parameters
        ----------
        scene : Scene
            The scene, whose operation gives the values without a time function.
        duration : float
            Length of the run [s].
        where : Location
            Location of these settings, for messages.

        Raises
        ------
        SceneError
            With all faults of the settings and the file.
        """
        faults = list[str]()
        courses, digest = self._courses_of_file(scene, duration, where, faults)
        for name in VARYING:
            settings = getattr(self, name)
            if settings is None or name in courses:
                continue
            try:
                courses[name] = settings.course(_stated(scene, name), duration)
            except FieldError as error:
                faults.append(where.at(name).at(error.field).message(error.reason))
                continue
            if settings.shape == "table":
                row = where.at(name).at("time").message("")
                faults += _uncovered(np.array(settings.time), duration, row, row)
        for name in CONDITIONS:
            lowest, highest = courses[name].span(duration) if name in courses else (0.0, 0.0)
            if lowest < -_ROUNDING * highest:
                goes = format_quantity(lowest, _like(name)["unit"])
                advice = _ADVICE_BELOW_ZERO.get(name, "")
                faults.append(
                    where.at(name).message(f"goes down to {goes}: it may not fall below 0{advice}")
                )
        if faults:
            raise SceneError(faults)
        states = [name for name in VARYING if name in courses or name not in PART_TEMPERATURES]
        return History(
            courses={name: courses.get(name) or constant(_stated(scene, name)) for name in states},
            prescribed=tuple(name for name in VARYING if name in courses),
            end=duration,
            sha256=digest,
        )

    def _courses_of_file(
        self, scene: Scene, duration: float, where: Location, faults: list[str]
    ) -> tuple[dict[str, Course], str]:
        """Return the time functions of the file and its hash; without a file none. Faults are appended.

        The path of the file is relative to the scene where that is a file.
        """
        if not self.file:
            return {}, ""
        source = Path(scene.source)
        path = Path(self.file)
        if scene.source.endswith(".toml") and source.exists():
            path = source.parent / path
        try:
            stat = path.stat()
            columns, lines, digest = _read(path, self.file, stat.st_mtime_ns, stat.st_size)
        except OSError as error:
            raise SceneError(
                [where.at("file").message(f"{self.file}: cannot be read: {error.strerror}")]
            ) from None
        courses = dict[str, Course]()
        for name in columns.keys() - {"time"}:
            if getattr(self, name) is not None:
                faults.append(
                    where.at(name).message(f"{self.file} has it too; leave one of both out")
                )
            courses[name] = table(columns["time"], columns[name])
        faults += _uncovered(
            columns["time"], duration, f"{self.file}:{lines[0]}", f"{self.file}:{lines[-1]}"
        )
        return courses, digest


def _stated(scene: Scene, name: str) -> float:
    """Return a value as the operation states it; 0 for the direction of the load, which it does not state."""
    return float(getattr(scene.operation, name, 0.0))


def _uncovered(time: Array, duration: float, first: str, last: str) -> list[str]:
    """Return what is wrong with times that do not cover a run; ``first`` and ``last`` locate their ends."""
    faults = []
    if time[0] > 0.0:
        faults.append(
            f"{first}: the history begins at {time[0]:g} s, after the run, which begins at 0 s; add a row at 0 s"
        )
    if time[-1] < duration:
        faults.append(
            f"{last}: the history ends at {time[-1]:g} s, before the run does at {duration:g} s; add rows, or "
            "shorten the run with its duration"
        )
    return faults


@lru_cache(maxsize=8)
def _read(
    path: Path, source: str, changed: int, size: int
) -> tuple[Mapping[str, Array], Array, str]:
    """Return the columns of a file in SI units, the line of each row, and the hash of its content.

    ``changed`` [ns] and ``size`` identify the version of the file in the cache.
    """
    content = content_of(path)
    text = decoded(content, source)
    parsed = _parsed_by_numpy(text, source)
    if parsed is None:
        faults = list[str]()
        columns, numbers = read_columns(text, source, _Row, faults, _without_values)
        if len(faults) > _MAX_FAULTS:
            faults = [
                *faults[:_MAX_FAULTS],
                f"{source}: and {len(faults) - _MAX_FAULTS} more faults",
            ]
        if faults:
            raise SceneError(faults)
        parsed = {name: np.array(values) for name, values in columns.items()}, np.array(numbers)
    arrays, lines = parsed
    if fault := unordered(arrays["time"]):
        raise SceneError([f"{source}:{lines[fault[0]]}: time: {fault[1]}"])
    return arrays, lines, hashlib.sha256(content).hexdigest()


def _without_values(names: Any) -> str:
    """Return what is wrong with the columns of a file that has none of the varying values; else an empty string."""
    return (
        "" if {*names} & {*VARYING} else f"only a time: a column of {', '.join(VARYING)} is missing"
    )


def _parsed_by_numpy(text: str, source: str) -> tuple[dict[str, Array], Array] | None:
    """Return what `read_columns` returns for a long file without faults, in a hundredth of the time; None otherwise."""
    lines = text.split("\n")
    numbers = [
        number
        for number, line in enumerate(lines)
        if (stripped := line.strip()) and not stripped.startswith("#")
    ]
    if len(numbers) < _MIN_ROWS:
        return None
    faults = list[str]()
    head = "\n".join(lines[k] for k in numbers[:2])
    names = [*read_columns(head, source, _Row, faults, _without_values)[0]]
    try:
        values = np.array([lines[k].split(",") for k in numbers[1:]], dtype=float)
    except ValueError:
        return None
    if faults or values.shape != (len(numbers) - 1, len(names)) or not np.isfinite(values).all():
        return None
    units = [
        cell.partition("[")[2].strip().removesuffix("]").strip()
        for cell in lines[numbers[0]].split(",")
    ]
    columns = dict[str, Array]()
    fields = attrs.fields_dict(_Row)
    for name, unit, column in zip(names, units, values.T, strict=True):
        zero, unity = (quantity(f"{size} {unit}", fields[name].metadata["unit"]) for size in (0, 1))
        columns[name] = zero + (unity - zero) * column
        check: Any = fields[name].validator
        try:  # the extremes violate the limits if any value does
            if check is not None:
                for extreme in (columns[name].min(), columns[name].max()):
                    check(None, fields[name], float(extreme))
        except FieldError:
            return None
    return columns, np.array(numbers[1:]) + 1


@attrs.frozen(eq=False, kw_only=True)
class History:
    """The operation over time."""

    #: Time function of each of `VARYING` [rad/s, N, rad, K], constant where the scene gives none; of
    #: `PART_TEMPERATURES` only where it gives one.
    courses: Mapping[str, Course]
    prescribed: tuple[str, ...]  # names of the values that have a time function in the scene
    end: float  # length of the run [s]
    sha256: str = ""  # hash of the file; empty without one
    #: Path through temperatures that follow from the losses of the bearing: tables then have one axis for all of them.
    path: ThermalPath | None = None

    def at(self, t: Any) -> dict[str, Array]:
        """Return the values at times [s], of any shape."""
        return {name: course.at(t) for name, course in self.courses.items()}

    @cached_property
    def spans(self) -> dict[str, tuple[float, float]]:
        """Smallest and largest of each value during the run."""
        return {name: course.span(self.end) for name, course in self.courses.items()}

    @cached_property
    def varies(self) -> tuple[str, ...]:
        """Names of the values that are not constant during the run."""
        return tuple(name for name, (low, high) in self.spans.items() if low < high)

    @property
    def conditions(self) -> tuple[str, ...]:
        """Names of `CONDITIONS` that have a time function and do not belong to a path."""
        return tuple(
            name
            for name in (CONDITIONS if self.path is None else CONDITIONS[:1])
            if name in self.courses
        )

    @cached_property
    def breaks(self) -> tuple[float, ...]:
        """Times of jumps and kinks within the run [s]."""
        times = {time for course in self.courses.values() for time in course.breaks}
        return tuple(sorted(time for time in times if 0.0 < time < self.end))

    def rings_rest(self, start: float, end: float) -> bool:
        """Return whether both rings are at rest between two times [s]."""
        for name in ("inner_speed", "outer_speed"):
            course = self.courses[name]
            first = max(int(np.searchsorted(course.starts, start, side="right")) - 1, 0)
            last = max(int(np.searchsorted(course.starts, end, side="left")), first + 1)
            if course.powers[first:last].any():
                return False
        return True

    def speeds_in_proportion(self) -> bool:
        """Return whether the ratio of the ring speeds is constant, or one ring is at rest."""
        inner = self.courses["inner_speed"]
        outer = self.courses["outer_speed"]
        stands = (0.0, 0.0) in (self.spans["inner_speed"], self.spans["outer_speed"])
        if stands or not {"inner_speed", "outer_speed"} & {*self.varies}:
            return True
        t = np.union1d(np.linspace(0.0, self.end, 1001), [*inner.breaks, *outer.breaks])
        w_i = inner.at(t)
        w_o = outer.at(t)
        k = int(np.argmax(np.abs(w_i - w_o)))
        difference = np.abs(w_i * w_o[k] - w_o * w_i[k])
        largest = max(np.abs(w_i).max(), np.abs(w_o).max())
        return bool(np.all(difference <= _PROPORTION_TOLERANCE * largest**2))
