"""Design of a sweep: the points of a full factorial grid of axes, and of samples of uncertain quantities.

- Axes are lists and ranges; each is a dimension of the result. Samples are one more dimension, and every combination of
  the axes has the same samples, so that models are compared on the same data.
- The values of a point follow from its number alone (samples vary fastest), so that the points need not be stored and
  any part of them can be computed by any worker.
- Samples come from SciPy, always with a seed: a scrambled Sobol sequence (quasi-Monte Carlo) or a Latin hypercube.
- A single scrambled sequence gives no estimate of its error. "replicated-sobol" takes one sample of each of several
  independently scrambled sequences in turn: their differences estimate the error, and the first samples of the design
  are the first samples of every sequence.
- "saltelli" is the design for Sobol indices (Saltelli et al., Comput. Phys. Commun. 181, 2010, 259): with the halves A
  and B of a Sobol sequence of twice the dimensions, the rows of A, of B, and for each dimension of A with this column
  from B. The rows of one sample follow each other, so that the first samples are a complete design.
"""

import hashlib
import json
import math
import re
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from functools import cached_property
from typing import Any, ClassVar, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.errors import RollslipError, SceneError
from rollslip.fields import FieldError, refuse_if
from rollslip.scene.changes import Quantity, describe_unknown_key, parse_set
from rollslip.search import Array
from rollslip.structure import raise_problem_if
from rollslip.toml import as_list, thawed
from rollslip.units import (
    TypedRange,
    UnitError,
    as_written,
    check_typed,
    evenly,
    format_quantity,
    unit_given,
)
from rollslip.units import quantity as in_unit
from rollslip_studies.variation.distributions import Distribution, LogUniform, Uniform

__all__ = [
    "REPLICATES",
    "SAMPLINGS",
    "Axis",
    "Design",
    "continuous_quantity",
    "farthest_points",
    "label",
    "parse_over",
    "parse_overs",
    "plain_names",
    "probabilities",
    "range_parts",
    "read_axis",
    "read_fraction",
    "read_overs",
    "read_range",
    "read_span",
]

#: Names of the sampling methods.
SAMPLINGS: Final = ("sobol", "replicated-sobol", "latin-hypercube", "saltelli")
#: Number of independently scrambled sequences of "replicated-sobol". Twice as many make the estimate of the error more
#: certain and each sequence half as long, which makes quantiles less exact. Chosen: a power of two, so that with 2^k
#: samples each sequence has a power of two of them, which Sobol sequences need for their balance.
REPLICATES: Final = 8
#: Maximum number of points among which those far apart are selected. More bring them closer to the corners of the
#: design; the time of the selection is proportional. Chosen.
CANDIDATES: Final = 512
#: Ratio of the bounds above which values of a search or an explorer are even in the logarithm. Up to 3 an even grid has
#: neighbours whose relative distances differ by this factor at most. Chosen.
_LOGARITHMIC_RATIO: Final = 3.0
#: Maximum number of values of a range. Larger counts are typing errors, and their values would fill the memory. Chosen:
#: the maximum number of points of a sweep.
_MAX_COUNT = 10_000_000


def probabilities(sampling: str, samples: int, dimensions: int, seed: int) -> Array:
    """Return samples of the unit cube, none of them on its faces, where the inverse of a distribution is infinite.

    Parameters
    ----------
    sampling : str
        One of `SAMPLINGS`.
    samples : int
        Number of samples n.
    dimensions : int
        Number of dimensions d.
    seed : int
        Seed of the random numbers.

    Returns
    -------
    ndarray of float
        Shape (n, d), for "saltelli" (n (d + 2), d).
    """
    from scipy.stats import qmc

    if sampling == "saltelli":
        doubled = probabilities("sobol", samples, 2 * dimensions, seed)
        rows = np.repeat(doubled[:, None, :dimensions], dimensions + 2, axis=1)
        rows[:, 1] = doubled[:, dimensions:]
        for k in range(dimensions):
            rows[:, 2 + k, k] = doubled[:, dimensions + k]
        return rows.reshape(-1, dimensions)
    if sampling in ("sobol", "replicated-sobol"):
        rng = np.random.default_rng(seed)
        streams = [rng] if sampling == "sobol" else rng.spawn(REPLICATES)
        log2_length = max(0, math.ceil(math.log2(samples / len(streams))))
        sequences = [
            qmc.Sobol(dimensions, rng=stream).random_base2(log2_length) for stream in streams
        ]
        samples_drawn = np.stack(sequences, axis=1).reshape(-1, dimensions)[:samples]
    else:
        samples_drawn = qmc.LatinHypercube(dimensions, rng=np.random.default_rng(seed)).random(
            samples
        )
    return np.clip(samples_drawn, 2.0**-54, 1.0 - 2.0**-53)


def label(value: object) -> str:
    """Return the name of a value that is not a number: "muraki", "pan-hamrock(thickness=central)"."""
    if not isinstance(value, Mapping):
        return as_written(value) if isinstance(value, bool) else str(value)
    stated = [f"{key}={label(inner)}" for key, inner in value.items() if key != "model"]
    return str(value.get("model", "")) + (f"({', '.join(stated)})" if stated else "")


@attrs.frozen(eq=False)
class Axis:
    """An axis of a sweep.

    Attributes
    ----------
    quantity : Quantity
        The quantity that is varied.
    values : tuple
        Its values, numbers in SI units.
    listed : tuple
        The values of a list as they were written; empty for a range.
    given_unit : str or None
        Unit in which the bounds of a range were given.
    display_unit : str or None
        Unit in which values are printed; None for the unit that suits the size of each.
    """

    quantity: Quantity
    values: tuple[object, ...]
    listed: tuple[object, ...] = ()
    given_unit: str | None = None
    display_unit: str | None = None

    @property
    def key(self) -> str:
        """Key of the quantity in the scene."""
        return self.quantity.key

    @property
    def coordinate(self) -> "NDArray[Any]":
        """Values of the coordinate in a result: numbers, or names where values are not numbers."""
        number = self.quantity.unit is not None or self.quantity.whole
        return np.array(self.values) if number else np.array(list(map(label, self.values)))

    def value_as_written(self, number: int) -> object:
        """Return a value by number as it was written."""
        if self.listed:
            return self.listed[number]
        value = self.values[number]
        unit = self.quantity.unit
        if self.given_unit in (unit, None) or unit is None or not isinstance(value, float):
            return value
        return format_quantity(value, unit, given=self.given_unit)

    def format_value(self, value: object) -> str:
        """Return a value as text, with its unit."""
        unit = self.quantity.unit
        return (
            format_quantity(value, unit, given=self.display_unit)
            if unit and isinstance(value, float)
            else label(value)
        )


def read_axis(quantity: Quantity, raw: object, sampled: bool) -> Axis | Distribution:
    """Return the axis that a list or a range describes, or the distribution of a range that is sampled.

    Parameters
    ----------
    quantity : Quantity
        The quantity that is varied.
    raw : object
        A list, a single value, or a range "LOW:HIGH:COUNT", "LOW:HIGH:COUNT:log" or, to be sampled, "LOW:HIGH".
    sampled : bool
        Whether the sweep has samples; without them a range needs a count.
    """
    if isinstance(raw, str) and ":" in raw and (quantity.unit is not None or quantity.whole):
        return _range(quantity, raw, sampled)
    if not (listed := as_list(raw)):
        raise FieldError(quantity.key, "the list is empty; give at least one value")
    values = [
        _checked(quantity, value, f"value {k} of {len(listed)}" if len(listed) > 1 else "")
        for k, value in enumerate(listed, 1)
    ]
    counts = Counter(map(label, values))
    if twice := next((name for name in counts if counts[name] > 1), None):
        raise FieldError(quantity.key, f"{twice!r} stands twice in the list")
    return Axis(quantity, tuple(values), tuple(listed))


def parse_over(text: str) -> tuple[str, object]:
    """Split ``key=values`` of the command line into key and values: a range, or a list with commas between.

    Examples
    --------
    >>> parse_over("operation.radial_load=500 N:5 kN:10"), parse_over("models.film=moes, dowson-1968")
    (('operation.radial_load', '500 N:5 kN:10'), ('models.film', ['moes', 'dowson-1968']))
    """
    raise_problem_if(
        "=" not in text,
        f"over: {as_written(text)} has no values; write KEY=LOW:HIGH, such as operation.radial_load='500 N:5 kN'",
    )
    key, value = parse_set(text)
    if not isinstance(value, str):
        return key, value
    if ":" in value:
        return key, TypedRange(value)
    return key, [parse_set(f"{key}={part}")[1] for part in value.split(",")]


def parse_overs(texts: Sequence[str]) -> dict[str, object]:
    """Return the values of several ``key=values``, by key; a key that occurs twice is refused."""
    pairs = list(map(parse_over, texts))
    counts = Counter(key for key, _ in pairs)
    if twice := sorted(key for key in counts if counts[key] > 1):
        raise SceneError(
            [f"{key}: stands in --over twice; put all its values in one" for key in twice]
        )
    return dict(pairs)


def read_fraction(given: float | str) -> float:
    """Return a fraction that is given as a number or in percent; NaN where it is neither."""
    try:
        return in_unit(given, "1") if "%" in str(given) else float(given)
    except (UnitError, ValueError, TypeError):
        return math.nan


def read_overs(given: object) -> dict[str, object]:
    """Return the varied values by key, from a mapping, or from texts ``key=values`` as on the command line."""
    if isinstance(given, Mapping):
        return {str(key): thawed(values) for key, values in given.items()}
    if isinstance(given, str) and "=" in given:
        return parse_overs([given])
    if not isinstance(given, list | tuple) or not all(isinstance(text, str) for text in given):
        wanted = "a mapping such as {'operation.radial_load': '1 kN:5 kN:5'}, or texts KEY=VALUES"
        raise SceneError([f"over: what varies is expected, {wanted}, not {as_written(given)}"])
    return parse_overs(given)


def _checked(
    quantity: Quantity, value: object, description: str, given: str | None = None
) -> object:
    """Read a value of a quantity; an error names the value by its description."""
    try:
        return quantity.read(value, given)
    except (RollslipError, TypeError, ValueError) as error:
        reason = str(error) if isinstance(error, RollslipError) else str(error.args[0])
        if isinstance(error, FieldError):
            reason = error.reason
        raise FieldError(
            quantity.key, f"{description}: {reason}" if description else reason
        ) from error


def _range(quantity: Quantity, text: str, sampled: bool) -> Axis | Distribution:
    """Axis or, without a count, distribution of a range, whose values are even or, with "log", logarithmic."""
    key = quantity.key
    unit = quantity.unit or "1"
    ends, count, logarithmic = range_parts(key, text)
    check_typed(text, ends, unit)
    low, high = evenly(*ends, 2, unit)
    given = unit_given(ends[0], unit)
    refuse_if(not low < high, key, f"{as_written(text)}: the first end must be below the second")
    refuse_if(
        logarithmic and not low > 0.0,
        key,
        f"{as_written(text)}: a logarithmic range must begin above 0",
    )
    if not count:
        refuse_if(
            not sampled,
            key,
            f"{as_written(text)} has no count; write LOW:HIGH:COUNT, or ask for samples",
        )
        refuse_if(
            quantity.whole,
            key,
            f"{as_written(text)}: whole numbers are not sampled; give a count or a list",
        )
        for end, value in (("its low end", low), ("its high end", high)):
            _checked(quantity, value, end, given)
        return LogUniform(low=low, high=high) if logarithmic else Uniform(low=low, high=high)
    refuse_if(
        not count.isascii() or not count.isdecimal() or not 2 <= int(count) <= _MAX_COUNT,
        key,
        f"{as_written(text)}: {as_written(count)} is not a number of values from 2 to {_MAX_COUNT}",
    )
    n = int(count)
    if logarithmic:
        between = [low * math.exp(k / (n - 1) * math.log(high / low)) for k in range(1, n - 1)]
        values: Sequence[object] = (low, *between, high)
    else:
        values = evenly(*ends, n, unit)
    return Axis(
        quantity,
        tuple(_checked(quantity, v, f"point {k} of {n}", given) for k, v in enumerate(values, 1)),
        given_unit=given,
    )


def range_parts(key: str, text: str) -> tuple[tuple[str, str], str, bool]:
    """Split a range into its bounds as they are written, its count or "", and whether it is logarithmic.

    Parameters
    ----------
    key : str
        Key of the quantity, for messages.
    text : str
        The range, "LOW:HIGH", "LOW:HIGH:COUNT" or one of these with ":log".
    """
    parts = [part.strip() for part in text.split(":")]
    logarithmic = parts[-1] == "log"
    numbers = parts[:-1] if logarithmic else parts
    refuse_if(
        len(numbers) not in (2, 3) or not all(parts),
        key,
        f"{as_written(text)} is not a range; write LOW:HIGH:COUNT or LOW:HIGH:COUNT:log",
    )
    refuse_if(
        "," in text,
        key,
        f"{as_written(text)} has a comma; write decimals with a point, and no range in a list",
    )
    low, high, count = numbers if len(numbers) == 3 else (*numbers, "")
    return (low, high), count, logarithmic


def continuous_quantity(known: Mapping[str, Quantity], key: str) -> Quantity:
    """Return the quantity of a key; SceneError if there is none, or if its values are not continuous.

    Parameters
    ----------
    known : mapping of str to Quantity
        Quantities of the scene by key.
    key : str
        The key.
    """
    if key not in known:
        raise SceneError([f"{key}: {describe_unknown_key(key, dict(known))}"])
    quantity = known[key]
    if quantity.unit is None:
        raise SceneError(
            [
                f"{quantity.key}: is not a quantity with continuous values; sweep it with rollslip sweep run"
            ]
        )
    return quantity


def read_span(
    quantity: Quantity, text: str, default: int, allowed: range
) -> tuple[tuple[str, str], int, bool]:
    """Return bounds of a range as they are written, its number of values, and whether these are even in the logarithm.

    They are where the text says so, or where the bounds are above zero and far apart, but not for temperatures.

    Parameters
    ----------
    quantity : Quantity
        The quantity that is varied.
    text : str
        The range, "LOW:HIGH" or "LOW:HIGH:COUNT", with units.
    default : int
        Number of values without a count.
    allowed : range
        Numbers of values that are accepted.
    """
    refuse_if(
        ":" not in text,
        quantity.key,
        f"{text!r} is not a range; write LOW:HIGH or LOW:HIGH:COUNT, with units",
    )
    ends, count, logarithmic = range_parts(quantity.key, text)
    refuse_if(
        count and not (count.isascii() and count.isdecimal() and int(count) in allowed),
        quantity.key,
        f"{text!r}: {count!r} is not a number of values from {allowed[0]} to {allowed[-1]}",
    )
    check_typed(text, ends, str(quantity.unit))
    low, high = evenly(*ends, 2, str(quantity.unit))
    wide = low > 0.0 and high > _LOGARITHMIC_RATIO * low and quantity.unit != "K"
    return ends, int(count or default), logarithmic or wide


def read_range(
    quantity: Quantity, given: object, default: int, allowed: range
) -> tuple[tuple[str, str], int, bool]:
    """Return what `read_span` returns, of a range as a text or a list; SceneError if it is none.

    Parameters
    ----------
    quantity : Quantity
        The quantity that is varied.
    given : object
        The range, "LOW:HIGH" or "LOW:HIGH:COUNT", with units.
    default : int
        Number of values without a count.
    allowed : range
        Numbers of values that are accepted.
    """
    text = given
    if not isinstance(text, str):  # a text may be marked as typed, which str() would lose
        text = ",".join(map(str, as_list(given)))
    try:
        return read_span(quantity, text, default, allowed)
    except (RollslipError, UnitError) as error:
        raise SceneError([f"{quantity.key}: {getattr(error, 'reason', error)}"]) from error


@attrs.frozen(eq=False)
class Design:
    """The points of a sweep.

    Attributes
    ----------
    axes : tuple of Axis
        Axes, which are crossed.
    sampled : tuple of Quantity
        Quantities that are sampled.
    samples : ndarray
        Samples in SI units, shape (n, len(sampled)); n = 1 and no column without samples.
    """

    axes: tuple[Axis, ...]
    sampled: tuple[Quantity, ...]
    samples: Array
    #: What the rows of `samples` are called in messages.
    samples_name: ClassVar[str] = "samples"

    @property
    def has_samples(self) -> bool:
        """Whether the design has a dimension of samples."""
        return bool(self.sampled)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values along each dimension; samples are the last one."""
        return (
            *(len(axis.values) for axis in self.axes),
            *([len(self.samples)] if self.has_samples else []),
        )

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys of the axes, then those of the sampled quantities."""
        return (*(axis.key for axis in self.axes), *(quantity.key for quantity in self.sampled))

    @property
    def size(self) -> int:
        """Number of points."""
        return math.prod(self.shape)

    @property
    def checked_axes(self) -> tuple[Axis, ...]:
        """The axes whose values are checked in the scene one by one."""
        return self.axes

    def changes(self, number: int) -> dict[str, object]:
        """Return the values that the point of a number changes in the scene, by key."""
        index = np.unravel_index(number, self.shape)
        changes = {axis.key: axis.values[int(k)] for axis, k in zip(self.axes, index, strict=False)}
        if self.has_samples:
            changes |= {
                quantity.key: value
                for quantity, value in zip(
                    self.sampled, self.samples[int(index[-1])].tolist(), strict=True
                )
            }
        return changes

    def describe_point(self, number: int) -> str:
        """Return the values of a point as text: "operation.radial_load = 500 N, models.traction = muraki"."""
        axes = {quantity.key: Axis(quantity, ()) for quantity in self.sampled}
        axes |= {axis.key: axis for axis in self.checked_axes}
        return ", ".join(
            f"{key} = {axes[key].format_value(value)}"
            for key, value in self.changes(number).items()
        )

    @cached_property
    def facts(self) -> dict[str, Any]:
        """Facts that identify the design, as plain values of JSON."""
        return {
            "axes": {
                axis.key: json.loads(json.dumps(axis.values, default=dict)) for axis in self.axes
            },
            "sampled": [quantity.key for quantity in self.sampled],
            "samples": hashlib.sha256(
                np.ascontiguousarray(self.samples, dtype="<f8").tobytes()
            ).hexdigest(),
            "size": self.size,
            **self.further_facts,
        }

    @property
    def further_facts(self) -> dict[str, Any]:
        """Facts of a design that has more than axes and samples."""
        return {}


def plain_names(keys: Sequence[str], taken: Collection[str] = ()) -> dict[str, str]:
    """Return the name of the dimension or coordinate of each key: its last part, and more parts if that is ambiguous.

    Parameters
    ----------
    keys : sequence of str
        Dotted keys of the scene.
    taken : collection of str
        Names that are used otherwise.

    Examples
    --------
    >>> plain_names(["operation.radial_load", "models.traction"])
    {'operation.radial_load': 'radial_load', 'models.traction': 'traction'}
    >>> plain_names(["cage.mass", "study.dynamics.planar.mass"])
    {'cage.mass': 'cage_mass', 'study.dynamics.planar.mass': 'planar_mass'}
    """

    def ending(key: str, parts: int) -> str:
        return re.sub(r"\W", "_", "_".join(key.split(".")[-parts:]))

    names = {}
    for key in keys:
        others = {
            ending(other, n)
            for other in keys
            if other != key
            for n in range(1, other.count(".") + 2)
        }
        endings = [ending(key, n) for n in range(1, key.count(".") + 2)]
        available = (name for name in endings if name not in others and name not in taken)
        names[key] = next(available, f"{endings[-1]}_")
    return names


def farthest_points(values: Array, count: int) -> list[int]:
    """Return indices of rows that are far apart, by farthest-point sampling (Gonzalez, 1985).

    The first row is the one with the largest distance from the centre of the ranges, each further one that with the
    largest distance from all rows before it. Columns are scaled by their ranges.

    Parameters
    ----------
    values : ndarray of float, (n, d)
        The rows.
    count : int
        Maximum number of rows that are returned.
    """
    width = np.ptp(values, axis=0)
    values = (values - values.min(axis=0)) / np.where(width > 0.0, width, 1.0)
    chosen = list[int]()
    distance = np.linalg.norm(values - 0.5, axis=1)
    for _ in range(min(count, len(values))):
        k = int(np.argmax(distance))
        distance_to_new = np.linalg.norm(values - values[k], axis=1)
        distance = np.minimum(distance, distance_to_new) if chosen else distance_to_new
        chosen.append(k)
    return chosen
