"""Declare the fields of scenes, models and studies: unit, meaning, default and allowed values in one place.

Decisions:

- A field has its unit and its meaning as attrs metadata ("unit", "doc"); reading, messages, the schema and the
  documentation all take them from there.
- A field has a usual and a possible range. A value outside the possible range is refused. A value outside the usual
  range is accepted, with a warning that proposes another unit (`unusual`): "0.16 m; did you mean '0.16 um'?"
- A validator checks one value only and ignores the instance, so that the reader can report every fault of a table at
  once. Relations of several fields are checked in ``__attrs_post_init__``. Both raise `FieldError`.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any, TypeAlias, TypedDict

import attrs

from rollslip.errors import RollslipError
from rollslip.toml import FrozenTable, as_list
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
"""Lower and upper limit of a range; infinite where it has none."""


class Ranges(TypedDict):
    """Usual and possible range that several fields share: ``field(..., **RANGES)``."""

    usual: Span
    possible: Span


class FieldError(RollslipError, ValueError):
    """A field does not accept its value; ``field`` is its name and ``reason`` the sentence on the fault."""

    def __init__(self, field: str, reason: str) -> None:
        super().__init__(f"{field}: {reason}")
        self.field = field
        self.reason = reason

    def __reduce__(self) -> tuple[type["FieldError"], tuple[str, str]]:
        return type(self), (self.field, self.reason)


def refuse_if(condition: object, field: str, reason: str) -> None:
    """Raise a `FieldError` where a condition holds."""
    if condition:
        raise FieldError(field, reason)


@attrs.frozen(kw_only=True)
class Scatter:
    """Uncertainty of a datum of an oil or a bearing, or of the default of a field, with its source."""

    #: Key in the table ``[lubricant]`` or ``[bearing]`` of a scene, or "LAW.PARAMETER" of a constant of an oil; empty
    #: where a field declares its own uncertainty: ``parameter(..., scatter=Scatter(...))``.
    quantity: str = ""
    #: Name of the distribution, as in the table ``[uncertainty]`` of a scene.
    distribution: str
    #: Parameters of the distribution, with units; a centre that is left out is the value of the scene.
    parameters: Mapping[str, object] = attrs.field(converter=FrozenTable)
    #: A letter of `rollslip.lubricant.GRADES` in parentheses.
    grade: str
    #: Source, in a sentence.
    source: str


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
        Texts that a scene may have in place of a value -> the value.
    usual
        Range of values in practice, in `unit`, of each value of a list; a value outside gives a warning.
    possible
        Range of possible values; a value outside is an error.
    scatter
        Uncertainty of the default, a `rollslip.datasets.Scatter`; None for an exact one.
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
    if possible is not None:
        validator = (
            attrs.validators.and_(validator, within_possible) if validator else within_possible
        )
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
    usual: Span | None = None,
    possible: Span | None = None,
    scatter: object | None = None,
    keywords: Mapping[str, object] | None = None,
) -> Any:
    """Declare a parameter of a model or a setting of a study.

    Parameters
    ----------
    doc, unit, default, validator, usual, possible, scatter, keywords
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
        keywords=keywords,
    )


def _format(value: object, attribute: "attrs.Attribute[Any]") -> str:
    """Return a value as text, in the unit in which the user gave it."""
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
                f"must be {self._allowed(attribute)}, not {_format(value, attribute)}",
            )

    def _allowed(self, attribute: "attrs.Attribute[Any]") -> str:
        low, high = (
            bound if bound == 0 else _format(bound, attribute) for bound in (self.low, self.high)
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
            options = ", ".join(map(as_written, self.options))
            raise FieldError(
                attribute.name, f"must be one of {options}, not {_format(value, attribute)}"
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
    """Validator: a list `value` of a field `attribute` is not empty; the `instance` is not used."""
    refuse_if(not value, attribute.name, "is an empty list; at least one value is needed")


def choice_of(*options: object) -> _ChoiceOf:
    """Return a validator: one of `options`."""
    return _ChoiceOf(options)


# What is usual and what is possible ----------------------------------------------------------------------------------


def within_possible(instance: object, attribute: "attrs.Attribute[Any]", value: object) -> None:
    """Validator: a `value`, or each of a list, is in the possible range of its field; the `instance` is not used.

    Parameters
    ----------
    instance : object
        Not used, so that a value can be checked on its own.
    attribute : attrs.Attribute
        The field.
    value : object
        The value in SI units.

    Raises
    ------
    FieldError
        If a number is outside the range.
    """
    span: Span = attribute.metadata["possible"]
    for number in as_list(value):
        if isinstance(number, int | float) and not span[0] <= number <= span[1]:
            possible = format_span(span, *_unit_and_given(attribute))
            reason = f"must be {possible}, not {_format_number(number, attribute)}"
            raise FieldError(attribute.name, reason + _hint(number, attribute))


def unusual(attribute: "attrs.Attribute[Any]", value: float, given: str | None = None) -> str:
    """Return a message on a value outside the usual range of its field; empty where it is inside.

    Parameters
    ----------
    attribute : attrs.Attribute
        The field.
    value : float
        The value in SI units.
    given : str, optional
        Unit in which the user gave it.
    """
    span: Span | None = attribute.metadata.get("usual")
    if span is None or span[0] <= value <= span[1]:
        return ""
    field_as_given = attribute.evolve(metadata={**attribute.metadata, "given": given})
    usual = format_span(span, *_unit_and_given(field_as_given))
    hint = _hint(value, field_as_given)
    return f"{as_given(value, attribute, given)} is unusual ({usual} is usual)" + hint


def as_given(value: float, attribute: "attrs.Attribute[Any]", given: str | None = None) -> str:
    """Return a value of a field in the unit in which the user gave it, and SI values in the usual unit too.

    Parameters
    ----------
    value : float
        The value in SI units.
    attribute : attrs.Attribute
        The field.
    given : str, optional
        Unit in which the user gave it; by default the SI unit.
    """
    return _format_number(value, attribute.evolve(metadata={**attribute.metadata, "given": given}))


def format_span(span: Span, unit: str | None, given: str | None = None) -> str:
    """Return a range as text: "from 5 nm to 3 um", "at most 4 GPa".

    Parameters
    ----------
    span : (float, float)
        Limits in SI units; infinite where there is none.
    unit : str or None
        The SI unit.
    given : str, optional
        Unit of the text; by default one that suits the size.
    """
    low, high = (_bound(end, unit, given) for end in span)
    if math.isinf(span[1]):
        return f"at least {low}"
    return f"at most {high}" if math.isinf(span[0]) else f"from {low} to {high}"


def _bound(value: float, unit: str | None, given: str | None) -> str:
    if unit is None:
        return f"{value:g}"
    return "0" if value == 0 and unit != "K" else format_quantity(value, unit, given=given)


def _unit_and_given(attribute: "attrs.Attribute[Any]") -> tuple[str | None, str | None]:
    """Return the SI unit of a field, and the unit in which the user gave its value, where it is another."""
    unit = attribute.metadata.get("unit")
    given = attribute.metadata.get("given")
    return unit, None if given in (unit, "1") else given


def _format_number(value: float, attribute: "attrs.Attribute[Any]") -> str:
    """Return a number in the unit in which the user gave it; in SI units also in the usual unit: "0.16 m = 160 mm"."""
    unit, given = _unit_and_given(attribute)
    if unit is None or unit == "1":
        return f"{value:.6g}"
    if given is not None:
        return format_quantity(value, unit, given=given)
    plain = format_quantity(value, unit, given=unit)
    usual = format_quantity(value, unit)
    return plain if plain == usual else f"{plain} = {usual}"


def _hint(value: float, attribute: "attrs.Attribute[Any]") -> str:
    """Return the question whether the same number in another unit, with which it is usual, was meant."""
    unit, given = _unit_and_given(attribute)
    span: Span | None = attribute.metadata.get("usual")
    if unit is None or span is None:
        return ""
    meant = likely(value, given or unit, unit, lambda other: span[0] <= other <= span[1])
    return "" if meant is None else f"; did you mean {meant!r}?"


def submodels(model: Any) -> Iterator[tuple[str, Any]]:
    """Yield kind and model of all models among the parameters of a model, and of their submodels."""
    for attribute in attrs.fields(type(model)) if attrs.has(type(model)) else ():
        if "kind" in attribute.metadata and (child := getattr(model, attribute.name)) is not None:
            yield attribute.metadata["kind"], child
            yield from submodels(child)
