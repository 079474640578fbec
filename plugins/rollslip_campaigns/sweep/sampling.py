"""Which points a sweep has: axes that are crossed, and samples of what varies together.

- Axes are lists and ranges; each is a dimension of the result. Samples are one dimension more, and every combination of
  the axes sees the same samples, so that models are compared on equal terms.
- A point is its number, counted with the samples running fastest; its values follow from the number alone. Nobody
  needs to keep the points, and a piece of them can be computed anywhere.
- Samples are quasi-random (scrambled Sobol sequence) or stratified (Latin hypercube) from SciPy, always seeded.
- One scrambled sequence does not tell how exact it is. Several scramblings do: they are independent of each other. One
  sample of each in turn makes a sequence whose first samples are several whole ones too.
- The samples after Saltelli, for Sobol indices, are those of a Sobol sequence of twice the dimensions, A and B, and for
  each dimension A with this one from B. They stand sample by sample, so that the first ones are a design too.
"""

import hashlib
import json
import math
import re
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from functools import cached_property
from typing import Any, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.errors import RollslipError, SceneError
from rollslip.fields import FieldError
from rollslip.scene.changes import Quantity, parse_set
from rollslip.search import Array
from rollslip.toml import thawed
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
    "label",
    "parse_over",
    "parse_overs",
    "plain_names",
    "probabilities",
    "range_parts",
    "read_axis",
    "read_fraction",
    "read_overs",
    "spread_points",
]

SAMPLINGS: Final = ("sobol", "replicated-sobol", "latin-hypercube", "saltelli")
#: Independent scramblings of a replicated Sobol sequence; of a power of two of samples each is a whole one.
REPLICATES: Final = 8
_MOST = 10_000_000


def probabilities(sampling: str, samples: int, dimensions: int, seed: int) -> Array:
    """Return points of the unit cube, none of them on its faces."""
    from scipy.stats import qmc

    if sampling == "saltelli":
        both = probabilities("sobol", samples, 2 * dimensions, seed)
        rows = np.repeat(both[:, None, :dimensions], dimensions + 2, axis=1)
        rows[:, 1] = both[:, dimensions:]
        for k in range(dimensions):
            rows[:, 2 + k, k] = both[:, dimensions + k]
        return rows.reshape(-1, dimensions)
    if sampling in ("sobol", "replicated-sobol"):
        rng = np.random.default_rng(seed)
        streams = [rng] if sampling == "sobol" else rng.spawn(REPLICATES)
        power = max(0, math.ceil(math.log2(samples / len(streams))))
        each = [qmc.Sobol(dimensions, rng=one).random_base2(power) for one in streams]
        drawn = np.stack(each, axis=1).reshape(-1, dimensions)[:samples]
    else:
        drawn = qmc.LatinHypercube(dimensions, rng=np.random.default_rng(seed)).random(samples)
    return np.clip(drawn, 2.0**-54, 1.0 - 2.0**-53)


def label(value: object) -> str:
    """Return how results call a value that is no number: "muraki", "pan-hamrock(thickness=central)"."""
    if not isinstance(value, Mapping):
        return as_written(value) if isinstance(value, bool) else str(value)
    stated = [f"{key}={label(inner)}" for key, inner in value.items() if key != "model"]
    return str(value.get("model", "")) + (f"({', '.join(stated)})" if stated else "")


@attrs.frozen(eq=False)
class Axis:
    """One key with the values that it takes one after the other; how a list was written, and the unit of a range.

    Values are told in ``told_in``, or in the unit that suits the size of each.
    """

    quantity: Quantity
    values: tuple[object, ...]
    listed: tuple[object, ...] = ()
    given: str | None = None
    told_in: str | None = None

    @property
    def key(self) -> str:
        """Its key."""
        return self.quantity.key

    @property
    def coordinate(self) -> "NDArray[Any]":
        """Values for the coordinate of a result."""
        number = self.quantity.unit is not None or self.quantity.whole
        return (
            np.array(self.values) if number else np.array([label(value) for value in self.values])
        )

    def written(self, number: int) -> object:
        """Return a value by number as it was written."""
        if self.listed:
            return self.listed[number]
        value = self.values[number]
        unit = self.quantity.unit
        if self.given in (unit, None) or unit is None or not isinstance(value, float):
            return value
        return format_quantity(value, unit, given=self.given)

    def shown(self, value: object) -> str:
        """Return a value in words."""
        unit = self.quantity.unit
        return (
            format_quantity(value, unit, given=self.told_in)
            if unit and isinstance(value, float)
            else label(value)
        )


def read_axis(quantity: Quantity, raw: object, sampled: bool) -> Axis | Distribution:
    """Return the axis that a list or a range describes, or the distribution of a range to be sampled."""
    if isinstance(raw, str) and ":" in raw and (quantity.unit is not None or quantity.whole):
        return _range(quantity, raw, sampled)
    listed = list(raw) if isinstance(raw, list | tuple) else [raw]
    if not listed:
        raise FieldError(quantity.key, "the list is empty; give at least one value")
    values = []
    for k, value in enumerate(listed, 1):
        values.append(
            _checked(quantity, value, f"value {k} of {len(listed)}" if len(listed) > 1 else "")
        )
    counts = Counter(label(value) for value in values)
    if twice := next((name for name, count in counts.items() if count > 1), None):
        raise FieldError(quantity.key, f"{twice!r} stands twice in the list")
    return Axis(quantity, tuple(values), tuple(listed))


def parse_over(text: str) -> tuple[str, object]:
    """Split ``key=values`` of the command line into key and values: a range, or a list with commas between.

    Examples
    --------
    >>> parse_over("operation.radial_load=500 N:5 kN:10"), parse_over("models.film=moes, dowson-1968")
    (('operation.radial_load', '500 N:5 kN:10'), ('models.film', ['moes', 'dowson-1968']))
    """
    key, value = parse_set(text)
    if not isinstance(value, str):
        return key, value
    if ":" in value:
        return key, TypedRange(value)
    return key, [parse_set(f"{key}={part}")[1] for part in value.split(",")]


def parse_overs(texts: Sequence[str]) -> dict[str, object]:
    """Return what several ``key=values`` say, by key."""
    pairs = [parse_over(text) for text in texts]
    keys = [key for key, _ in pairs]
    if twice := sorted({key for key in keys if keys.count(key) > 1}):
        raise SceneError(
            [f"{key}: stands in --over twice; put all its values in one" for key in twice]
        )
    return dict(pairs)


def read_fraction(given: float | str) -> float:
    """Return a share that is given as a number or in percent; NaN where it is neither."""
    try:
        return in_unit(given, "1") if "%" in str(given) else float(given)
    except (UnitError, ValueError, TypeError):
        return math.nan


def read_overs(given: object) -> dict[str, object]:
    """Return what is varied, by key: a mapping as it is, texts as those of the command line."""
    if isinstance(given, Mapping):
        return {str(key): thawed(values) for key, values in given.items()}
    if isinstance(given, str) and "=" in given:
        return parse_overs([given])
    if not isinstance(given, list | tuple) or not all(isinstance(text, str) for text in given):
        wanted = "a mapping such as {'operation.radial_load': '1 kN:5 kN:5'}, or texts KEY=VALUES"
        raise SceneError([f"over: what varies is expected, {wanted}, not {as_written(given)}"])
    return parse_overs(given)


def _checked(quantity: Quantity, value: object, which: str, given: str | None = None) -> object:
    try:
        return quantity.read(value, given)
    except RollslipError as error:
        reason = error.reason if isinstance(error, FieldError) else str(error)
        raise FieldError(quantity.key, f"{which}: {reason}" if which else reason) from error
    except (TypeError, ValueError) as error:
        raise FieldError(
            quantity.key, f"{which}: {error.args[0]}" if which else str(error.args[0])
        ) from error


def _range(quantity: Quantity, text: str, sampled: bool) -> Axis | Distribution:
    key = quantity.key
    unit = quantity.unit or "1"
    ends, count, logarithmic = range_parts(key, text)
    check_typed(text, ends, unit)
    low, high = evenly(*ends, 2, unit)
    given = unit_given(ends[0], unit)
    if not low < high:
        raise FieldError(key, f"{as_written(text)}: the first end must be below the second")
    if logarithmic and not low > 0.0:
        raise FieldError(key, f"{as_written(text)}: a logarithmic range must begin above 0")
    if not count:
        if not sampled:
            raise FieldError(
                key, f"{as_written(text)} has no count; write LOW:HIGH:COUNT, or ask for samples"
            )
        if quantity.whole:
            raise FieldError(
                key, f"{as_written(text)}: whole numbers are not sampled; give a count or a list"
            )
        for end, value in (("its low end", low), ("its high end", high)):
            _checked(quantity, value, end, given)
        return LogUniform(low=low, high=high) if logarithmic else Uniform(low=low, high=high)
    if not count.isascii() or not count.isdecimal() or not 2 <= int(count) <= _MOST:
        raise FieldError(
            key, f"{as_written(text)}: {as_written(count)} is no count of values from 2 to {_MOST}"
        )
    n = int(count)
    if logarithmic:
        between = [low * math.exp(k / (n - 1) * math.log(high / low)) for k in range(1, n - 1)]
        values: Sequence[object] = (low, *between, high)
    else:
        values = evenly(*ends, n, unit)
    checked = (_checked(quantity, v, f"point {k} of {n}", given) for k, v in enumerate(values, 1))
    return Axis(quantity, tuple(checked), given=given)


def range_parts(key: str, text: str) -> tuple[tuple[str, str], str, bool]:
    """Return both ends of a range as they are written, its count or "", and whether it is logarithmic."""
    parts = [part.strip() for part in text.split(":")]
    logarithmic = parts[-1] == "log"
    numbers = parts[:-1] if logarithmic else parts
    if len(numbers) not in (2, 3) or not all(parts):
        raise FieldError(
            key, f"{as_written(text)} is no range; write LOW:HIGH:COUNT or LOW:HIGH:COUNT:log"
        )
    if "," in text:
        raise FieldError(
            key,
            f"{as_written(text)} has a comma; write decimals with a point, and no range in a list",
        )
    low, high, count = numbers if len(numbers) == 3 else (*numbers, "")
    return (low, high), count, logarithmic


@attrs.frozen(eq=False)
class Design:
    """The points of a sweep.

    Attributes
    ----------
    axes : tuple of Axis
        What is crossed.
    sampled : tuple of Quantity
        What the samples are of.
    samples : ndarray
        Samples in SI units, shape (n, len(sampled)); n = 1 and no column without samples.
    has_samples : bool
        Whether there is a dimension of samples.
    """

    axes: tuple[Axis, ...]
    sampled: tuple[Quantity, ...]
    samples: Array

    @property
    def has_samples(self) -> bool:
        """Whether there is a dimension of samples."""
        return bool(self.sampled)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values along every dimension."""
        return (
            *(len(axis.values) for axis in self.axes),
            *([len(self.samples)] if self.has_samples else []),
        )

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys of all that varies: of the axes, then of what is sampled."""
        return (*(axis.key for axis in self.axes), *(one.key for one in self.sampled))

    @property
    def size(self) -> int:
        """Number of points."""
        return math.prod(self.shape)

    def changes(self, number: int) -> dict[str, object]:
        """Return what a point changes in the scene, by key."""
        place = np.unravel_index(number, self.shape) if self.shape else ()
        changes = {axis.key: axis.values[int(k)] for axis, k in zip(self.axes, place, strict=False)}
        if self.has_samples:
            row = self.samples[int(place[-1])].tolist()
            changes |= {of.key: value for of, value in zip(self.sampled, row, strict=True)}
        return changes

    def shown(self, number: int) -> str:
        """Return a point in words: "operation.radial_load = 500 N, models.traction = muraki"."""
        axes = {axis.key: axis for axis in (*(Axis(one, ()) for one in self.sampled), *self.axes)}
        return ", ".join(
            f"{key} = {axes[key].shown(value)}" for key, value in self.changes(number).items()
        )

    @cached_property
    def facts(self) -> dict[str, Any]:
        """What tells this design from another, as plain values."""
        return {
            "axes": {
                axis.key: json.loads(json.dumps(axis.values, default=dict)) for axis in self.axes
            },
            "sampled": [one.key for one in self.sampled],
            "samples": hashlib.sha256(
                np.ascontiguousarray(self.samples, dtype="<f8").tobytes()
            ).hexdigest(),
            "size": self.size,
        }


def plain_names(keys: Sequence[str], taken: Collection[str] = ()) -> dict[str, str]:
    """Return the name of the dimension or coordinate of each key: its last part, and more of it only to tell it apart.

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
        free = [one for one in endings if one not in others and one not in taken]
        names[key] = free[0] if free else f"{endings[-1]}_"
    return names


def spread_points(values: Array, most: int) -> list[int]:
    """Return some rows by number, the first far from the middle, each as far as can be from those before it."""
    width = np.ptp(values, axis=0)
    values = (values - values.min(axis=0)) / np.where(width > 0.0, width, 1.0)
    taken = list[int]()
    distance = np.linalg.norm(values - 0.5, axis=1)
    for _ in range(min(most, len(values))):
        k = int(np.argmax(distance))
        apart = np.linalg.norm(values - values[k], axis=1)
        distance = np.minimum(distance, apart) if taken else apart
        taken.append(k)
    return taken
