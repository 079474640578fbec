"""How ring speeds, load, its direction and temperature go over time: named shapes, tables, files of measured values.

- A course is a piecewise cubic, held before its first piece and constant in its last, so that it has no end. Straight
  lines and smooth steps are that exactly; sines and decays are cubics through values and slopes, right to 3e-9 of what
  they change by.
- Where it jumps, it has the later value. Jumps and kinks are places where an integrator starts anew; of a table with
  more than a thousand the sharpest thousand, the rest is left to its step control.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.fields import FieldError, choice_of, field, non_negative, positive
from rollslip.search import Array
from rollslip.structure import fields_of

#: Shape -> parameters that it needs, and that it may have.
SHAPES: Final[Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]]] = {
    "table": (("time", "value"), ()),
    "ramp": (("to", "within"), ("from", "at")),
    "step": (("to", "at"), ("from",)),
    "sine": (("amplitude", "period"), ("mean", "phase")),
    "run-up": (("within",), ("from", "to", "at")),
    "coast-down": (("time_constant",), ("from", "to", "at")),
    "emergency-stop": (("within",), ("from", "to", "at")),
    "rotation": (("speed",), ("from", "at")),
}
#: Those that only a speed has, and only the direction of the load.
OF_SPEEDS: Final = ("run-up", "coast-down", "emergency-stop")
OF_DIRECTION: Final = ("rotation",)
#: Pieces of a period of a sine and of a time constant, and time constants after which nothing is left of a decay.
_PER_PERIOD = 200
_PER_CONSTANT = 32
_CONSTANTS = 37
#: Times at which an integrator starts anew, at most, but for jumps.
_MAX_BREAKS: Final = 1000
#: Periods of a sine that a run may have.
_MAX_PERIODS: Final = 10_000


@attrs.frozen(eq=False)
class Course:
    """A value over time."""

    begin: Array  # times at which the pieces begin [s], ascending; of two at the same time the later one counts, (n,)
    powers: Array  # coefficients of the powers 0 to 3 of the time since then, (n, 4); the last piece is constant
    breaks: tuple[float, ...] = ()  # times of jumps and kinks [s]

    def at(self, t: Any) -> Array:
        """Return the values at times [s], of any shape."""
        times = np.asarray(t, dtype=float)
        k = np.maximum(np.searchsorted(self.begin, times, side="right") - 1, 0)
        x = np.maximum(times - self.begin[k], 0.0)
        p = self.powers[k]
        return np.asarray(p[..., 0] + x * (p[..., 1] + x * (p[..., 2] + x * p[..., 3])))

    def scaled(self, factor: float) -> "Course":
        """Return the course of so many times the value."""
        return attrs.evolve(self, powers=factor * self.powers)

    def span(self, end: float) -> tuple[float, float]:
        """Return its least and largest value from 0 to an end [s]."""
        ends = np.append(self.begin[1:], np.inf)
        low = np.clip(self.begin, 0.0, end)
        high = np.clip(ends, 0.0, end)
        low[0] = 0.0
        inside = high > low if end > 0.0 else high >= low
        inside |= (self.begin <= end) & (ends > end)
        _, b, c, d = self.powers.T
        with np.errstate(divide="ignore", invalid="ignore"):
            root = np.sqrt(c * c - 3.0 * b * d)
            q = -(c + np.copysign(root, c))
            turns = np.concatenate((q / (3.0 * d), b / q))
        begin, inner, to = (np.tile(part, 2) for part in (self.begin, low, high))
        turns = np.where(np.isfinite(turns), turns + begin, inner)
        places = np.clip(turns, inner, to)
        k = np.tile(np.arange(self.begin.size), 4)
        x = np.maximum(np.concatenate((low, high, places)) - self.begin[k], 0.0)
        p = self.powers[k]
        values = (p[:, 0] + x * (p[:, 1] + x * (p[:, 2] + x * p[:, 3])))[np.tile(inside, 4)]
        return float(values.min()), float(values.max())


def constant(value: float) -> Course:
    """Return the course of what does not change."""
    return Course(np.zeros(1), np.array([[value, 0.0, 0.0, 0.0]]))


def table(time: Array, value: Array) -> Course:
    """Return the course along straight lines between values, with a jump where two have the same time."""
    powers = np.zeros((time.size, 4))
    apart = np.diff(time)
    powers[:, 0] = value
    powers[:-1, 1] = np.divide(np.diff(value), apart, out=np.zeros(apart.size), where=apart > 0.0)
    jumps = time[1:][(apart == 0.0) & (np.diff(value) != 0.0)]
    bends = np.abs(np.diff(powers[:, 1], prepend=0.0))
    sharpest = np.argsort(bends, kind="stable")[::-1][:_MAX_BREAKS]
    return Course(
        time, powers, tuple(np.union1d(jumps, time[sharpest[bends[sharpest] > 0.0]]).tolist())
    )


def through(time: Array, value: Array, slope: Array) -> Course:
    """Return the smooth course through values with these slopes, which stays at the last."""
    h = np.diff(time)
    rise = np.diff(value)
    powers = np.zeros((time.size, 4))
    powers[:, 0] = value
    powers[:-1, 1] = slope[:-1]
    powers[:-1, 2] = (3.0 * rise / h - 2.0 * slope[:-1] - slope[1:]) / h
    powers[:-1, 3] = (slope[:-1] + slope[1:] - 2.0 * rise / h) / h**2
    return Course(time, powers)


@attrs.frozen(kw_only=True)
class CourseSettings:
    """How one value of the operation goes over time: a shape and its parameters."""

    #: Shapes that are not for this value -> whose they are.
    others: ClassVar[Mapping[str, str]] = MappingProxyType({})

    shape: str = field(
        default="table",
        doc="table, ramp, step, sine; of a speed also run-up, coast-down, emergency-stop; of a direction rotation",
        validator=choice_of(*SHAPES),
    )
    at: float | None = field(
        default=None,
        unit="s",
        doc="time at which it begins to change, by default 0; of a step when it is made",
        validator=attrs.validators.optional(non_negative),
        possible=(0, 1e9),
    )
    within: float | None = field(
        default=None,
        unit="s",
        doc="time that the change of a ramp, run-up or emergency-stop takes",
        validator=attrs.validators.optional(positive),
        possible=(1e-9, 1e9),
    )
    period: float | None = field(
        default=None,
        unit="s",
        doc="period of a sine",
        validator=attrs.validators.optional(positive),
        possible=(1e-9, 1e9),
    )
    phase: float | None = field(
        default=None, unit="rad", doc="phase of a sine at the start, by default 0"
    )
    time_constant: float | None = field(
        default=None,
        unit="s",
        doc="time constant of the exponential decay of a coast-down",
        validator=attrs.validators.optional(positive),
        possible=(1e-9, 1e9),
    )
    time: tuple[float, ...] = field(
        default=(),
        unit="s",
        doc="times of a table, ascending; the same time twice is a jump",
        possible=(-1e9, 1e9),
    )

    def __attrs_post_init__(self) -> None:
        if self.shape in self.others:
            known = ", ".join(shape for shape in SHAPES if shape not in self.others)
            raise FieldError(
                "shape", f"{self.shape!r} is one of {self.others[self.shape]}; there are {known}"
            )
        given = {key for key, value in self.parameters.items() if value not in (None, ())}
        needs, takes = SHAPES[self.shape]
        for key in needs:
            if key not in given:
                raise FieldError(
                    self._field(key), f"missing, but required for shape = {self.shape!r}"
                )
        for key in sorted(given - {*needs, *takes}):
            known = ", ".join((*needs, *takes))
            raise FieldError(
                self._field(key), f"is no parameter of shape = {self.shape!r}, which takes {known}"
            )
        if self.shape == "table":
            times = self.parameters["time"]
            values = self.parameters["value"]
            if len(times) != len(values):
                raise FieldError(
                    "value", f"needs one value for each of {len(times)} times, not {len(values)}"
                )
            if fault := unordered(np.array(times)):
                raise FieldError("time", fault[1])

    def _field(self, key: str) -> str:
        return "from_" if key == "from" else key

    @property
    def parameters(self) -> dict[str, Any]:
        """Parameters of all shapes by key; None, or nothing, where they are not given."""
        return {
            key: getattr(self, attribute.name)
            for key, attribute in fields_of(type(self))
            if key != "shape"
        }

    def course(self, now: float, end: float) -> Course:
        """Return the course up to an end [s], at least, of a value that the operation states to be ``now``.

        That is what a change begins from where nothing else is said; of a run-up it is where the change leads.
        """
        p = self.parameters
        at = p["at"] or 0.0
        if self.shape == "table":
            return table(np.array(p["time"]), np.array(p["value"]))
        if self.shape == "sine":
            mean = now if p["mean"] is None else p["mean"]
            return _sine(mean, p["amplitude"], p["period"], p["phase"] or 0.0, end)
        if self.shape == "rotation":
            begin = p["from"] or 0.0
            left = max(end - at, 0.0)
            turned = table(np.array([0.0, left]), begin + np.array([0.0, p["speed"] * left]))
            return _after(at, begin, turned, breaks=(at,))
        before, after = (now, 0.0) if self.shape in ("coast-down", "emergency-stop") else (0.0, now)
        if self.shape in ("ramp", "step"):
            before = now
        start = before if p["from"] is None else p["from"]
        end = after if p["to"] is None else p["to"]
        if self.shape == "step":
            return table(np.array([0.0, at, at]), np.array([start, start, end]))
        if self.shape == "coast-down":
            t = p["time_constant"] / _PER_CONSTANT * np.arange(_PER_CONSTANT * _CONSTANTS + 1)
            left = np.exp(-t / p["time_constant"])
            slope = -(start - end) / p["time_constant"] * left
            return _after(at, start, through(t, end + (start - end) * left, slope), breaks=(at,))
        if self.shape == "run-up":
            change = through(np.array([0.0, p["within"]]), np.array([start, end]), np.zeros(2))
        else:
            change = table(np.array([0.0, p["within"]]), np.array([start, end]))
        return _after(at, start, change, breaks=(at, at + p["within"]))


def _after(at: float, value: float, change: Course, breaks: tuple[float, ...]) -> Course:
    """A course that holds a value until its change begins."""
    begin = change.begin
    powers = change.powers
    if at > 0.0:
        begin = np.concatenate(([0.0], begin + at))
        powers = np.concatenate(([[value, 0.0, 0.0, 0.0]], powers))
    return Course(begin, powers, tuple(one for one in breaks if one > 0.0))


def _sine(mean: float, amplitude: float, period: float, phase: float, end: float) -> Course:
    if not end / period <= _MAX_PERIODS:
        raise FieldError(
            "period", f"the run has {end / period:.3g} of them, more than {_MAX_PERIODS:,}"
        )
    count = int(np.ceil(end / period * _PER_PERIOD)) + 2
    t = np.linspace(0.0, period / _PER_PERIOD * (count - 1), count)
    angle = 2.0 * np.pi / period * t + phase
    return through(
        t, mean + amplitude * np.sin(angle), 2.0 * np.pi / period * amplitude * np.cos(angle)
    )


def unordered(times: Array) -> tuple[int, str] | None:
    """Return the number of the first time that does not ascend, and what is wrong with it; None if nothing is."""
    apart = np.diff(times)
    back = np.flatnonzero(apart < 0.0)
    if back.size:
        k = int(back[0]) + 1
        return k, f"{times[k]:g} s comes after {times[k - 1]:g} s: times must ascend"
    thrice = np.flatnonzero((apart[1:] == 0.0) & (apart[:-1] == 0.0))
    if thrice.size:
        k = int(thrice[0]) + 2
        return k, f"{times[k]:g} s stands there three times: twice is a jump, more have no meaning"
    return None
