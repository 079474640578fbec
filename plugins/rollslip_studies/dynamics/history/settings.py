"""What a scene says of an operation that changes in time: one course for each value that does, or a file of them.

The keys stand with the study that goes through time, not in ``[operation]``: what stands there is what studies of a
steady bearing take, and without a duration a history means nothing. A value that no course is given for stays as
``[operation]`` has it.
"""

import hashlib
import math
from collections.abc import Mapping
from functools import cached_property, lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.errors import SceneError
from rollslip.fields import FieldError, field, non_negative, positive
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

#: Temperatures that follow that of the operation where nothing else is said.
OF_PARTS: Final = ("inner_ring_temperature", "roller_temperature", "outer_ring_temperature")
#: All of them.
TEMPERATURES: Final = ("temperature", *OF_PARTS)
#: Values of the operation that may have a course.
VARYING: Final = ("inner_speed", "outer_speed", "radial_load", "load_direction", *TEMPERATURES)
#: Those that tables of a bearing at rest depend on.
CONDITIONS: Final = ("radial_load", *TEMPERATURES)
_MAX_FAULTS: Final = 20
#: Share of the largest value by which a course that ends at 0 may miss it.
_ROUNDING: Final = 1e-12


def _like(name: str) -> dict[str, Any]:
    """Unit and ranges of a value of the operation; a direction has any number of turns."""
    if name == "load_direction":
        return {"unit": "rad", "possible": (-1e12, 1e12)}
    known = attrs.fields_dict(Operation)[name].metadata
    return {key: known[key] for key in ("unit", "possible")}


def _value(of: str, doc: str, key: str | None = None, validator: Any = None) -> Any:
    optional = None if validator is None else attrs.validators.optional(validator)
    return field(default=None, doc=doc, key=key, validator=optional, **_like(of))


def _values(of: str, validator: Any = None) -> Any:
    every = None if validator is None else attrs.validators.deep_iterable(validator)
    return field(default=(), doc="values of a table at its times", validator=every, **_like(of))


_AMPLITUDE: Final = "amplitude of a sine"
#: What to do where a value would fall below 0.
_BACK: Final = {
    "radial_load": "; a load that turns back has a load_direction of 180 deg from there on"
}
_FROM = "value before the change"
_TO = "value after the change"
_OF_SPEEDS = dict.fromkeys(OF_SPEEDS, "speeds")
_OF_DIRECTION = dict.fromkeys(OF_DIRECTION, "the direction of the load")
_MEAN: Final = "mean of a sine, by default that of [operation]"


@attrs.frozen(kw_only=True)
class SpeedCourse(CourseSettings):
    """How the speed of a ring goes over time."""

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
    """How the radial load goes over time."""

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
    """How the direction of the radial load goes over time, in the sense of positive speeds."""

    others: ClassVar[Mapping[str, str]] = MappingProxyType(_OF_SPEEDS)

    from_: float | None = _value("load_direction", f"{_FROM}, by default 0", "from")
    to: float | None = _value("load_direction", _TO)
    mean: float | None = _value("load_direction", "mean of a sine, by default 0")
    amplitude: float | None = _value("load_direction", _AMPLITUDE)
    speed: float | None = _value("inner_speed", "speed of a rotation")
    value: tuple[float, ...] = _values("load_direction")


@attrs.frozen(kw_only=True)
class TemperatureCourse(CourseSettings):
    """How the temperature goes over time."""

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


def _of_row(name: str, doc: str) -> Any:
    return field(default=None, doc=doc, validator=positive, **_like(name))


@attrs.frozen(kw_only=True)
class _Row:
    """A row of a file."""

    time: float = field(unit="s", doc="time")
    inner_speed: float = field(default=None, doc="speed of the inner ring", **_like("inner_speed"))
    outer_speed: float = field(default=None, doc="speed of the outer ring", **_like("outer_speed"))
    radial_load: float = field(
        default=None, doc="radial load", validator=non_negative, **_like("radial_load")
    )
    load_direction: float = field(
        default=None, doc="direction of the load", **_like("load_direction")
    )
    temperature: float = _of_row("temperature", "temperature")
    inner_ring_temperature: float = _of_row(
        "inner_ring_temperature", "temperature of the inner ring"
    )
    roller_temperature: float = _of_row("roller_temperature", "temperature of the rollers")
    outer_ring_temperature: float = _of_row(
        "outer_ring_temperature", "temperature of the outer ring"
    )


@attrs.frozen(kw_only=True)
class HistorySettings:
    """What of the operation changes in time, and how."""

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
        if not self.file and not any(getattr(self, name) for name in VARYING):
            raise FieldError(
                "file", f"nothing changes: give a table for one of {', '.join(VARYING)}, or a file"
            )

    def history(self, scene: Scene, duration: float, where: Location) -> "History":
        """Return the courses of a run of so many seconds.

        Parameters
        ----------
        scene : Scene
            The scene, whose operation holds what has no course.
        duration : float
            Length of the run [s].
        where : Location
            Place of these settings, for messages.
        """
        courses = dict[str, Course]()
        faults = list[str]()
        digest = ""
        if self.file:
            path = self._path(scene)
            try:
                stat = path.stat()
                columns, lines, digest = _read(path, self.file, stat.st_mtime_ns, stat.st_size)
            except OSError as error:
                raise SceneError(
                    [where.at("file").message(f"{self.file}: cannot be read: {error.strerror}")]
                ) from None
            for name in columns.keys() - {"time"}:
                if getattr(self, name) is not None:
                    faults.append(
                        where.at(name).message(f"{self.file} has it too; leave one of both out")
                    )
                courses[name] = table(columns["time"], columns[name])
            faults += _uncovered(
                columns["time"], duration, f"{self.file}:{lines[0]}", f"{self.file}:{lines[-1]}"
            )
        for name in VARYING:
            one = getattr(self, name)
            if one is None or name in courses:
                continue
            try:
                courses[name] = one.course(_stated(scene, name), duration)
            except FieldError as error:
                faults.append(where.at(name).at(error.field).message(error.reason))
                continue
            if one.shape == "table":
                faults += _uncovered(
                    np.array(one.time), duration, *2 * (where.at(name).at("time").message(""),)
                )
        for name in CONDITIONS:
            least, most = courses[name].span(duration) if name in courses else (0.0, 0.0)
            if least < -_ROUNDING * most:
                goes = format_quantity(least, _like(name)["unit"])
                faults.append(
                    where.at(name).message(
                        f"goes down to {goes}: it may not fall below 0{_BACK.get(name, '')}"
                    )
                )
        if faults:
            raise SceneError(faults)
        states = [name for name in VARYING if name in courses or name not in OF_PARTS]
        whole = {name: courses.get(name) or constant(_stated(scene, name)) for name in states}
        given = tuple(name for name in VARYING if name in courses)
        return History(courses=whole, given=given, end=duration, sha256=digest)

    def _path(self, scene: Scene) -> Path:
        beside = Path(scene.source)
        return (
            beside.parent / self.file
            if scene.source.endswith(".toml") and beside.exists()
            else Path(self.file)
        )


def _stated(scene: Scene, name: str) -> float:
    """What a value is where nothing else is said; positions count from the line of the load."""
    return float(getattr(scene.operation, name, 0.0))


def _uncovered(time: Array, duration: float, first: str, last: str) -> list[str]:
    said = []
    if time[0] > 0.0:
        said.append(
            f"{first}: the history begins at {time[0]:g} s, the run at 0 s; say how it is from there on"
        )
    if time[-1] < duration:
        said.append(
            f"{last}: the history ends at {time[-1]:g} s, before the run does at {duration:g} s; add what comes, or "
            "shorten the run with its duration"
        )
    return said


@lru_cache(maxsize=8)
def _read(
    path: Path, source: str, changed: int, size: int
) -> tuple[Mapping[str, Array], Array, str]:
    """Columns of a file in SI units, the line of each row, and the hash of its content."""
    content = content_of(path)
    text = decoded(content, source)
    digest = hashlib.sha256(content).hexdigest()
    quick = _quickly(text, source)
    if quick is None:
        faults = list[str]()
        columns, numbers = read_columns(text, source, _Row, faults, _something)
        if faults:
            more = (
                [f"{source}: and {len(faults) - _MAX_FAULTS} more faults"]
                if len(faults) > _MAX_FAULTS
                else []
            )
            raise SceneError([*faults[:_MAX_FAULTS], *more])
        quick = {name: np.array(values) for name, values in columns.items()}, np.array(numbers)
    arrays, lines = quick
    if fault := unordered(arrays["time"]):
        raise SceneError([f"{source}:{lines[fault[0]]}: time: {fault[1]}"])
    return arrays, lines, digest


def _something(names: Any) -> str:
    return (
        "" if {*names} & {*VARYING} else f"only a time: a column of {', '.join(VARYING)} is missing"
    )


def _quickly(text: str, source: str) -> tuple[dict[str, Array], Array] | None:
    """What `read_columns` gives of a long file without faults, in a hundredth of the time; None where it has any."""
    rows = text.split("\n")
    plain = [
        number
        for number, line in enumerate(rows)
        if (bare := line.strip()) and not bare.startswith("#")
    ]
    if len(plain) < 1000:
        return None
    faults = list[str]()
    head = "\n".join(rows[k] for k in plain[:2])
    names = [*read_columns(head, source, _Row, faults, _something)[0]]
    try:
        values = np.array([rows[k].split(",") for k in plain[1:]], dtype=float)
    except ValueError:
        return None
    if faults or values.shape != (len(plain) - 1, len(names)) or not np.isfinite(values).all():
        return None
    units = [
        cell.partition("[")[2].strip().removesuffix("]").strip()
        for cell in rows[plain[0]].split(",")
    ]
    columns = dict[str, Array]()
    known = attrs.fields_dict(_Row)
    for name, unit, column in zip(names, units, values.T, strict=True):
        zero, one = (quantity(f"{size} {unit}", known[name].metadata["unit"]) for size in (0, 1))
        columns[name] = zero + (one - zero) * column
        check: Any = known[name].validator
        try:  # at its ends, which are beyond the limits if any is
            for end in (columns[name].min(), columns[name].max()) if check is not None else ():
                check(None, known[name], float(end))
        except FieldError:
            return None
    return columns, np.array(plain[1:]) + 1


@attrs.frozen(eq=False, kw_only=True)
class History:
    """How the operation goes over time."""

    #: Of each of `VARYING` [rad/s, N, rad, K], constant where nothing was given; of `OF_PARTS` where it was.
    courses: Mapping[str, Course]
    given: tuple[str, ...]  # those that were
    end: float  # length of the run [s]
    sha256: str = ""  # of the file; empty without one
    #: What the bearing is put together along, where temperatures follow from its losses: tables then have one axis for
    #: all of them.
    path: ThermalPath | None = None

    def at(self, t: Any) -> dict[str, Array]:
        """Return the values at times [s], of any shape."""
        return {name: course.at(t) for name, course in self.courses.items()}

    @cached_property
    def spans(self) -> dict[str, tuple[float, float]]:
        """Least and largest of each value during the run."""
        return {name: course.span(self.end) for name, course in self.courses.items()}

    @cached_property
    def varies(self) -> tuple[str, ...]:
        """What is not the same all the time."""
        return tuple(name for name, (low, high) in self.spans.items() if low < high)

    @property
    def conditions(self) -> tuple[str, ...]:
        """What tables of a bearing at rest depend on: `CONDITIONS` that have a course and are not those of a path."""
        one_by_one = CONDITIONS if self.path is None else CONDITIONS[:1]
        return tuple(name for name in one_by_one if name in self.courses)

    @cached_property
    def breaks(self) -> tuple[float, ...]:
        """Times of jumps and kinks within the run [s]."""
        every = {one for course in self.courses.values() for one in course.breaks}
        return tuple(sorted(one for one in every if 0.0 < one < self.end))

    def rings_rest(self, begin: float, end: float) -> bool:
        """Whether both rings stand still between two times [s]."""
        for name in ("inner_speed", "outer_speed"):
            course = self.courses[name]
            first = max(int(np.searchsorted(course.begin, begin, side="right")) - 1, 0)
            if course.powers[
                first : max(int(np.searchsorted(course.begin, end, side="left")), first + 1)
            ].any():
                return False
        return True

    def speeds_in_proportion(self) -> bool:
        """Whether the ratio of the rings' speeds is that of one instant all the time, or one ring stands still."""
        inner = self.courses["inner_speed"]
        outer = self.courses["outer_speed"]
        if (0.0, 0.0) in (self.spans["inner_speed"], self.spans["outer_speed"]):
            return True
        if not {"inner_speed", "outer_speed"} & {*self.varies}:
            return True
        t = np.union1d(np.linspace(0.0, self.end, 1001), [*inner.breaks, *outer.breaks])
        w_i = inner.at(t)
        w_o = outer.at(t)
        k = int(np.argmax(np.abs(w_i - w_o)))
        apart = np.abs(w_i * w_o[k] - w_o * w_i[k])
        return bool(
            np.all(apart <= 1e-12 * max(np.abs(w_i).max(), np.abs(w_o).max()) ** 2)
        ) and math.isfinite(w_i[k])
