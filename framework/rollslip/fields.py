"""Declares the fields of scenes, models and studies: unit, meaning, default and allowed values in one place.

Decisions:

- A field carries its unit and its meaning as attrs metadata ("unit", "doc"); reading, messages, the schema and the
  documentation all take them from there.
- A field says what is usual and what is possible of its value. What is not possible is refused; what is not usual is
  read, and whoever runs the scene is told (`unusual`), with what was likely meant: "0.16 m; did you mean '0.16 um'?"
- A validator looks at one value only and ignores the instance, so that the reader can report every fault of a table at
  once. What concerns several fields is checked in ``__attrs_post_init__``. Both raise `FieldError`.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any, TypeAlias, TypedDict

import attrs

from rollslip.errors import RollslipError
from rollslip.toml import FrozenTable
from rollslip.units import as_written, check_unit, format_quantity, likely

__all__ = [
    "FieldError",
    "Ranges",
    "Scatter",
    "Span",
    "as_given",
    "at_least",
    "choice_of",
    "field",
    "format_span",
    "in_range",
    "non_negative",
    "not_empty",
    "own_unit",
    "parameter",
    "positive",
    "unusual",
    "within_possible",
]

Span: TypeAlias = tuple[float, float]
"""Least and largest of something; infinite where it has no end."""


class Ranges(TypedDict):
    """What is usual, and what is possible, of fields that have it in common: ``field(..., **RANGES)``."""

    usual: Span
    possible: Span


class FieldError(RollslipError, ValueError):
    """A field does not take the value it was given; ``field`` names it and ``reason`` is the sentence about it."""

    def __init__(self, field: str, reason: str) -> None:
        super().__init__(f"{field}: {reason}")
        self.field = field
        self.reason = reason

    def __reduce__(self) -> tuple[type["FieldError"], tuple[str, str]]:
        return type(self), (self.field, self.reason)


@attrs.frozen(kw_only=True)
class Scatter:
    """How uncertain a datum of an oil or a bearing is, or a value that a field has by default, and who says so."""

    #: Key of the table of a scene, ``[lubricant]`` or ``[bearing]``, that scatters; empty where a field declares it of
    #: itself: ``parameter(..., scatter=Scatter(...))``.
    quantity: str = ""
    distribution: str  #: Name of its distribution, as in the table ``[uncertainty]`` of a scene.
    #: Its parameters there, with units; a centre that is left out is the value of the scene.
    parameters: Mapping[str, object] = attrs.field(converter=FrozenTable)
    grade: str  #: A letter of `rollslip.lubricant.GRADES` in parentheses.
    source: str  #: Where it comes from, in a sentence.


def field(
    *,
    doc: str,
    unit: str | None = None,
    default: object = attrs.NOTHING,
    validator: Callable[[Any, Any, Any], object] | None = None,
    key: str | None = None,
    bare: bool = False,
    rest: bool = False,
    keywords: Mapping[str, object] | None = None,
    usual: Span | None = None,
    possible: Span | None = None,
    scatter: object | None = None,
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
    keywords
        Texts that a scene may say in place of a value -> the value.
    usual
        Least and largest value that is met in practice, in `unit`; outside of it a warning. Of each value of a list.
    possible
        Least and largest value that anything can have; outside of it an error.
    scatter
        How uncertain a value is that no scene states, a `rollslip.datasets.Scatter`; None for not.
    """
    metadata: dict[str, object] = {
        "doc": doc,
        "unit": None if unit is None else check_unit(unit),
        "bare": bare,
        "rest": rest,
        "keywords": keywords or {},
        "usual": usual,
        "possible": possible,
        "scatter": scatter,
    }
    if key is not None:
        metadata["key"] = key
    checks = [
        check
        for check in (validator, None if possible is None else within_possible)
        if check is not None
    ]
    both = attrs.validators.and_(*checks) if len(checks) > 1 else checks[0] if checks else None
    return attrs.field(default=default, validator=both, metadata=metadata)


def own_unit(doc: str) -> Any:
    """Declare a field whose values have the unit of the key at which its table stands."""
    return attrs.field(metadata={"doc": doc, "unit": None, "own_unit": True})


def parameter(
    *,
    doc: str,
    unit: str | None = None,
    default: object = attrs.NOTHING,
    validator: Callable[[Any, Any, Any], object] | None = None,
    usual: Span | None = None,
    possible: Span | None = None,
    scatter: object | None = None,
) -> Any:
    """Declare a parameter of a model or a setting of a study.

    Parameters
    ----------
    doc, unit, default, validator, usual, possible, scatter
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
    return field(
        doc=doc,
        unit=unit,
        default=default,
        validator=validator,
        usual=usual,
        possible=possible,
        scatter=scatter,
    )


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
            raise FieldError(
                attribute.name,
                f"must be {self._allowed(attribute)}, not {_shown(value, attribute)}",
            )

    def _allowed(self, attribute: "attrs.Attribute[Any]") -> str:
        low, high = (
            bound if bound == 0 else _shown(bound, attribute) for bound in (self.low, self.high)
        )
        if self.high is None:
            return f"above {low}" if self.open else f"at least {low}"
        if self.low is None:
            return f"below {high}" if self.open else f"at most {high}"
        return (
            f"between {low} and {high}, without the ends" if self.open else f"from {low} to {high}"
        )


@attrs.frozen
class _ChoiceOf:
    """Validator: the value is one of a few."""

    options: tuple[object, ...]

    def __call__(self, instance: object, attribute: "attrs.Attribute[Any]", value: object) -> None:
        if value not in self.options:
            options = ", ".join(as_written(option) for option in self.options)
            raise FieldError(
                attribute.name, f"must be one of {options}, not {_shown(value, attribute)}"
            )


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


def not_empty(instance: object, attribute: "attrs.Attribute[Any]", value: Any) -> None:
    """Validator: a list is not empty."""
    if not value:
        raise FieldError(attribute.name, "is an empty list; at least one value is needed")


def choice_of(*options: object) -> _ChoiceOf:
    """Return a validator: one of `options`."""
    return _ChoiceOf(options)


# What is usual and what is possible ----------------------------------------------------------------------------------


def within_possible(instance: object, attribute: "attrs.Attribute[Any]", value: object) -> None:
    """Validator: a value, or each of a list, lies within what its field declares to be possible."""
    span: Span = attribute.metadata["possible"]
    for one in value if isinstance(value, tuple) else (value,):
        if isinstance(one, int | float) and not span[0] <= one <= span[1]:
            came = f"must be {format_span(span, *_unit_and_given(attribute))}, not {_told(one, attribute)}"
            raise FieldError(attribute.name, came + _hint(one, attribute))


def unusual(attribute: "attrs.Attribute[Any]", value: float, given: str | None = None) -> str:
    """Say that a value of a field is outside what is usual, and what was likely meant; nothing where it is not."""
    span: Span | None = attribute.metadata.get("usual")
    if span is None or span[0] <= value <= span[1]:
        return ""
    told = attribute.evolve(metadata={**attribute.metadata, "given": given})
    usual = format_span(span, *_unit_and_given(told))
    return f"{as_given(value, attribute, given)} is unusual ({usual} is usual)" + _hint(value, told)


def as_given(value: float, attribute: "attrs.Attribute[Any]", given: str | None = None) -> str:
    """Show a value of a field as it was given; what was given in SI units as people read it too."""
    return _told(value, attribute.evolve(metadata={**attribute.metadata, "given": given}))


def format_span(span: Span, unit: str | None, given: str | None = None) -> str:
    """Say from what to what: "from 5 nm to 3 um", "at most 4 GPa"."""
    low, high = (_bound(end, unit, given) for end in span)
    if math.isinf(span[1]):
        return f"at least {low}"
    return f"at most {high}" if math.isinf(span[0]) else f"from {low} to {high}"


def _bound(value: float, unit: str | None, given: str | None) -> str:
    if unit is None:
        return f"{value:g}"
    return "0" if value == 0 and unit != "K" else format_quantity(value, unit, given=given)


def _unit_and_given(attribute: "attrs.Attribute[Any]") -> tuple[str | None, str | None]:
    """Unit of a field, and that in which a person gave its value, where it is another."""
    unit = attribute.metadata.get("unit")
    given = attribute.metadata.get("given")
    return unit, None if given in (unit, "1") else given


def _told(value: float, attribute: "attrs.Attribute[Any]") -> str:
    unit, given = _unit_and_given(attribute)
    if unit is None or unit == "1":
        return f"{value:.6g}"
    if given is not None:
        return format_quantity(value, unit, given=given)
    plain = format_quantity(value, unit, given=unit)
    read = format_quantity(value, unit)
    return plain if plain == read else f"{plain} = {read}"


def _hint(value: float, attribute: "attrs.Attribute[Any]") -> str:
    """Ask whether the same number with another unit was meant, one that makes it usual."""
    unit, given = _unit_and_given(attribute)
    span: Span | None = attribute.metadata.get("usual")
    if unit is None or span is None:
        return ""
    meant = likely(value, given or unit, unit, lambda other: span[0] <= other <= span[1])
    return "" if meant is None else f"; did you mean {meant!r}?"


def submodels(model: Any) -> Iterator[tuple[str, Any]]:
    """Yield kind and model of all models that a model holds as parameters, and of theirs."""
    for attribute in attrs.fields(type(model)) if attrs.has(type(model)) else ():
        if "kind" in attribute.metadata and (child := getattr(model, attribute.name)) is not None:
            yield attribute.metadata["kind"], child
            yield from submodels(child)
