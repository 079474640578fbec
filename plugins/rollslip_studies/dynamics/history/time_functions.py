"""Time functions (courses) of ring speeds, load, its direction and temperature: named shapes and tables.

- A course is a piecewise cubic polynomial of time, constant before its first piece and in its last, so that it has no
  end. Straight lines and smooth steps are cubics exactly. Sines and exponential decays are cubic Hermite interpolants
  through values and slopes, within 3e-9 of the amplitude.
- At a jump a course has the later value. An integrator starts anew at jumps and kinks. Of a table with more than a
  thousand kinks it does so at the sharpest thousand, and controls its step at the others.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.fields import FieldError, choice_of, field, non_negative, positive, refuse_if
from rollslip.search import Array
from rollslip.structure import fields_of

#: Shape -> parameters that it requires, and optional ones.
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
#: Shapes that only a speed has.
OF_SPEEDS: Final = ("run-up", "coast-down", "emergency-stop")
#: Shapes that only the direction of the load has.
OF_DIRECTION: Final = ("rotation",)
#: Number of cubics for a period of a sine. Its error is (2 pi/200)^4/384 = 3e-9 of the amplitude; doubling the number
#: divides that by 16.
_PIECES_PER_PERIOD: Final = 200
#: Number of cubics for a time constant of an exponential decay. Its error is (1/32)^4/384 = 3e-9 of the change.
_PIECES_PER_TIME_CONSTANT: Final = 32
#: Number of time constants after which a decay ends: exp(-37) = 9e-17, less than rounding of the change.
_DECAY_TIME_CONSTANTS: Final = 37
#: Maximum number of kinks at which an integrator starts anew. Halving it leaves more kinks to the step control;
#: doubling it starts an integrator more often at small kinks of measured values. Chosen.
_MAX_BREAKS: Final = 1000
#: Maximum number of periods of a sine in a run. It bounds the memory: 200 pieces of 40 bytes each for a period. Chosen.
_MAX_PERIODS: Final = 10_000


@attrs.frozen(eq=False)
class Course:
    """A time function: a value as a piecewise cubic polynomial of time."""

    starts: Array  # times at which the pieces start [s], (n,), ascending; of two equal ones the later piece counts
    powers: Array  # coefficients of the powers 0 to 3 of the time since then, (n, 4); the last piece is constant
    breaks: tuple[float, ...] = ()  # times of jumps and kinks [s]

    def at(self, t: Any) -> Array:
        """Return the values at times [s], of any shape."""
        times = np.asarray(t, dtype=float)
        k = np.maximum(np.searchsorted(self.starts, times, side="right") - 1, 0)
        x = np.maximum(times - self.starts[k], 0.0)
        p = self.powers[k]
        return np.asarray(p[..., 0] + x * (p[..., 1] + x * (p[..., 2] + x * p[..., 3])))

    def scaled(self, factor: float) -> "Course":
        """Return the course of the value times a factor."""
        return attrs.evolve(self, powers=factor * self.powers)

    def span(self, end: float) -> tuple[float, float]:
        """Return the smallest and the largest value from 0 to an end [s]: at ends of pieces or where the slope is 0."""
        piece_ends = np.append(self.starts[1:], np.inf)
        low = np.clip(self.starts, 0.0, end)
        high = np.clip(piece_ends, 0.0, end)
        low[0] = 0.0
        inside = high > low if end > 0.0 else high >= low
        inside |= (self.starts <= end) & (piece_ends > end)
        _, b, c, d = self.powers.T
        with np.errstate(divide="ignore", invalid="ignore"):
            q = -(c + np.copysign(np.sqrt(c * c - 3.0 * b * d), c))
            extrema = np.concatenate((q / (3.0 * d), b / q))
        lower = np.tile(low, 2)
        extrema = np.where(np.isfinite(extrema), extrema + np.tile(self.starts, 2), lower)
        extrema = np.clip(extrema, lower, np.tile(high, 2))
        k = np.tile(np.arange(self.starts.size), 4)
        x = np.maximum(np.concatenate((low, high, extrema)) - self.starts[k], 0.0)
        p = self.powers[k]
        values = (p[:, 0] + x * (p[:, 1] + x * (p[:, 2] + x * p[:, 3])))[np.tile(inside, 4)]
        return float(values.min()), float(values.max())


def constant(value: float) -> Course:
    """Return the course of a constant value."""
    return Course(np.zeros(1), np.array([[value, 0.0, 0.0, 0.0]]))


def table(time: Array, value: Array) -> Course:
    """Return the course along straight lines between values, with a jump where two have the same time.

    Parameters
    ----------
    time : ndarray, shape (n,)
        Times [s], ascending.
    value : ndarray, shape (n,)
        Values at these times.
    """
    powers = np.zeros((time.size, 4))
    steps = np.diff(time)
    powers[:, 0] = value
    powers[:-1, 1] = np.divide(np.diff(value), steps, out=np.zeros(steps.size), where=steps > 0.0)
    kinks = np.abs(np.diff(powers[:, 1], prepend=0.0))
    sharpest = np.argsort(kinks, kind="stable")[::-1][:_MAX_BREAKS]
    breaks = np.union1d(
        time[1:][(steps == 0.0) & (np.diff(value) != 0.0)], time[sharpest[kinks[sharpest] > 0.0]]
    )
    return Course(time, powers, tuple(breaks.tolist()))


def hermite(time: Array, value: Array, slope: Array) -> Course:
    """Return the cubic Hermite interpolant, which stays at the last value.

    Parameters
    ----------
    time : ndarray, shape (n,)
        Times [s], ascending.
    value, slope : ndarray, shape (n,)
        Values and their derivatives [1/s] at these times.
    """
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
    """Settings of a time function: a shape and its parameters."""

    #: Shapes that this value does not have -> the values that have them.
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
            refuse_if(
                key not in given,
                self._field(key),
                f"missing, but required for shape = {self.shape!r}",
            )
        for key in sorted(given - {*needs, *takes}):
            known = ", ".join((*needs, *takes))
            raise FieldError(
                self._field(key),
                f"is not a parameter of shape = {self.shape!r}, which takes {known}",
            )
        if self.shape == "table":
            times = self.parameters["time"]
            values = self.parameters["value"]
            refuse_if(
                len(times) != len(values),
                "value",
                f"needs one value for each of {len(times)} times, not {len(values)}",
            )
            if fault := unordered(np.array(times)):
                raise FieldError("time", fault[1])

    def _field(self, key: str) -> str:
        """Return the name of the field of a key."""
        return "from_" if key == "from" else key

    @property
    def parameters(self) -> dict[str, Any]:
        """Parameters of all shapes by key; None, or an empty tuple, where they are not given."""
        return {
            key: getattr(self, attribute.name)
            for key, attribute in fields_of(type(self))
            if key != "shape"
        }

    def course(self, now: float, end: float) -> Course:
        """Return the course.

        Parameters
        ----------
        now : float
            Value that the operation states. A change starts from it unless ``from`` is given; a run-up ends at it.
        end : float
            Time up to which the course is needed [s].
        """
        p = self.parameters
        at = p["at"] or 0.0
        if self.shape == "table":
            return table(np.array(p["time"]), np.array(p["value"]))
        if self.shape == "sine":
            mean = now if p["mean"] is None else p["mean"]
            return _sine(mean, p["amplitude"], p["period"], p["phase"] or 0.0, end)
        if self.shape == "rotation":
            return _rotation(at, p["from"] or 0.0, p["speed"], end)
        start = now
        target = now
        if self.shape == "run-up":
            start = 0.0
        if self.shape in ("coast-down", "emergency-stop"):
            target = 0.0
        if p["from"] is not None:
            start = p["from"]
        if p["to"] is not None:
            target = p["to"]
        if self.shape == "step":
            return table(np.array([0.0, at, at]), np.array([start, start, target]))
        if self.shape == "coast-down":
            return _decay(at, start, target, p["time_constant"])
        if self.shape == "run-up":
            change = hermite(np.array([0.0, p["within"]]), np.array([start, target]), np.zeros(2))
        else:
            change = table(np.array([0.0, p["within"]]), np.array([start, target]))
        return _delayed(at, start, change, breaks=(at, at + p["within"]))


def _delayed(at: float, value: float, change: Course, breaks: tuple[float, ...]) -> Course:
    """Return a course that has a constant value until a change starts at a time [s]."""
    starts = change.starts
    powers = change.powers
    if at > 0.0:
        starts = np.concatenate(([0.0], starts + at))
        powers = np.concatenate(([[value, 0.0, 0.0, 0.0]], powers))
    return Course(starts, powers, tuple(time for time in breaks if time > 0.0))


def _rotation(at: float, start: float, speed: float, end: float) -> Course:
    """Return an angle [rad] that increases with a speed [rad/s] from a time [s] on."""
    rest = max(end - at, 0.0)
    return _delayed(
        at, start, table(np.array([0.0, rest]), start + np.array([0.0, speed * rest])), breaks=(at,)
    )


def _decay(at: float, start: float, target: float, time_constant: float) -> Course:
    """Return an exponential decay from a value to another from a time [s] on, with a time constant [s]."""
    pieces = _PIECES_PER_TIME_CONSTANT * _DECAY_TIME_CONSTANTS
    t = time_constant / _PIECES_PER_TIME_CONSTANT * np.arange(pieces + 1, dtype=float)
    fraction = np.exp(-t / time_constant)
    change = hermite(
        t, target + (start - target) * fraction, -(start - target) / time_constant * fraction
    )
    return _delayed(at, start, change, breaks=(at,))


def _sine(mean: float, amplitude: float, period: float, phase: float, end: float) -> Course:
    """Return a sine with a period [s] and a phase [rad], up to an end [s]."""
    refuse_if(
        not end / period <= _MAX_PERIODS,
        "period",
        f"the run has {end / period:.3g} of them, more than {_MAX_PERIODS:,}",
    )
    count = int(np.ceil(end / period * _PIECES_PER_PERIOD)) + 2
    t = np.linspace(0.0, period / _PIECES_PER_PERIOD * (count - 1), count)
    angle = 2.0 * np.pi / period * t + phase
    return hermite(
        t, mean + amplitude * np.sin(angle), 2.0 * np.pi / period * amplitude * np.cos(angle)
    )


def unordered(times: Array) -> tuple[int, str] | None:
    """Return the index of the first time [s] that does not ascend and what is wrong with it; None if all ascend."""
    steps = np.diff(times)
    descending = np.flatnonzero(steps < 0.0)
    if descending.size:
        k = int(descending[0]) + 1
        return k, f"{times[k]:g} s comes after {times[k - 1]:g} s: times must ascend"
    thrice = np.flatnonzero((steps[1:] == 0.0) & (steps[:-1] == 0.0))
    if thrice.size:
        k = int(thrice[0]) + 2
        return k, f"{times[k]:g} s stands there three times: twice is a jump, more have no meaning"
    return None
