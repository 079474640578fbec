"""Declares the fields of scenes, models and studies: unit, meaning, default and allowed values in one place.

Decisions:

- A field carries its unit and its meaning as attrs metadata ("unit", "doc"); reading, messages, the schema and the
  documentation all take them from there.
- A validator looks at one value only and ignores the instance, so that the reader can report every fault of a table at
  once. What concerns several fields is checked in ``__attrs_post_init__``. Both raise `FieldError`.
"""

from collections.abc import Callable, Mapping
from typing import Any

import attrs

from rollslip.errors import RollslipError
from rollslip.units import as_written, check_unit, format_quantity

__all__ = ["FieldError", "at_least", "field", "in_range", "non_negative", "one_of", "own_unit", "parameter", "positive"]


class FieldError(RollslipError, ValueError):
    """A field does not take the value it was given; ``field`` names it and ``reason`` is the sentence about it."""

    def __init__(self, field: str, reason: str) -> None:
        super().__init__(f"{field}: {reason}")
        self.field = field
        self.reason = reason

    def __reduce__(self) -> tuple[type["FieldError"], tuple[str, str]]:
        return type(self), (self.field, self.reason)


def field(
    *,
    doc: str,
    unit: str | None = None,
    default: object = attrs.NOTHING,
    validator: Callable[[Any, Any, Any], object] | None = None,
    key: str | None = None,
    bare: bool = False,
    rest: bool = False,
    words: Mapping[str, object] | None = None,
) -> Any:
    """Declare a field of a frozen attrs class that a scene can fill.

    Parameters
    ----------
    doc
        What the value means, in a few words without a full stop.
    unit
        SI unit of a number; "1" for a plain number. None for text, whole numbers, choices and tables.
    default
        Value (or `attrs.Factory`) of a key that is left out. Without it the key is required.
    validator
        Called as ``validator(instance, attribute, value)``, raises `ValueError`. It must not use the instance.
    key
        Name of the key in the scene, if it is not the name of the field.
    bare
        A string in place of the table fills this field: ``film = "moes"`` for ``film = { model = "moes" }``.
    rest
        The field collects all keys that have no field of their own, unread.
    words
        Texts that a scene may say in place of a value -> the value.
    """
    metadata: dict[str, object] = {
        "doc": doc,
        "unit": None if unit is None else check_unit(unit),
        "bare": bare,
        "rest": rest,
        "words": words or {},
    }
    if key is not None:
        metadata["key"] = key
    return attrs.field(default=default, validator=validator, metadata=metadata)


def own_unit(doc: str) -> Any:
    """Declare a field whose values have the unit of the key at which its table stands."""
    return attrs.field(metadata={"doc": doc, "unit": None, "own_unit": True})


def parameter(
    *,
    doc: str,
    unit: str | None = None,
    default: object = attrs.NOTHING,
    validator: Callable[[Any, Any, Any], object] | None = None,
) -> Any:
    """Declare a parameter of a model or a setting of a study.

    Parameters
    ----------
    doc, unit, default, validator
        As in `field`.

    Examples
    --------
    >>> @attrs.frozen(kw_only=True)
    ... class Eyring:
    ...     stress: float = parameter(default=4e6, unit="Pa", doc="Eyring stress", validator=positive)
    >>> Eyring(stress=-1.0)
    Traceback (most recent call last):
    ...
    rollslip.fields.FieldError: stress: must be above 0, not -1 Pa
    """
    return field(doc=doc, unit=unit, default=default, validator=validator)


def _shown(value: object, attribute: "attrs.Attribute[Any]") -> str:
    unit = attribute.metadata.get("unit")
    if unit is None or isinstance(value, bool) or not isinstance(value, int | float):
        return as_written(value)
    return format_quantity(value, unit, given=attribute.metadata.get("given"))


@attrs.frozen
class _Range:
    """Validator: the value lies in an interval, with or without its ends."""

    low: float | None
    high: float | None
    open: bool = False

    def __call__(self, instance: object, attribute: "attrs.Attribute[Any]", value: Any) -> None:
        above = self.low is None or value > self.low or (value == self.low and not self.open)
        below = self.high is None or value < self.high or (value == self.high and not self.open)
        if not (above and below):
            raise FieldError(attribute.name, f"must be {self._allowed(attribute)}, not {_shown(value, attribute)}")

    def _allowed(self, attribute: "attrs.Attribute[Any]") -> str:
        low, high = (bound if bound == 0 else _shown(bound, attribute) for bound in (self.low, self.high))
        if self.high is None:
            return f"above {low}" if self.open else f"at least {low}"
        if self.low is None:
            return f"below {high}" if self.open else f"at most {high}"
        return f"between {low} and {high}, without the ends" if self.open else f"from {low} to {high}"


@attrs.frozen
class _OneOf:
    """Validator: the value is one of a few."""

    options: tuple[object, ...]

    def __call__(self, instance: object, attribute: "attrs.Attribute[Any]", value: object) -> None:
        if value not in self.options:
            options = ", ".join(as_written(option) for option in self.options)
            raise FieldError(attribute.name, f"must be one of {options}, not {_shown(value, attribute)}")


positive = _Range(0, None, open=True)
"""Validator: above zero."""

non_negative = _Range(0, None)
"""Validator: zero or above."""


def at_least(low: float) -> _Range:
    """Return a validator: `low` or above."""
    return _Range(low, None)


def in_range(low: float, high: float, *, open: bool = False) -> _Range:
    """Return a validator: from `low` to `high`, with the ends unless the interval is `open`."""
    return _Range(low, high, open)


def one_of(*options: object) -> _OneOf:
    """Return a validator: one of `options`."""
    return _OneOf(options)
