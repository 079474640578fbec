"""The schema: every key that a scene may have, with unit, default, meaning and ranges, for people and the docs."""

from collections.abc import Iterator
from typing import Any, NamedTuple, get_args, get_origin

import attrs

from rollslip.fields import format_span
from rollslip.scene.named import NAMED
from rollslip.scene.values import Scene
from rollslip.structure import FrozenTable, bare_key, fields_of, types_of
from rollslip.units import format_quantity

__all__ = ["SchemaRow", "rows_of", "schema", "shown_default", "shown_range", "shown_type"]


class SchemaRow(NamedTuple):
    """One key that a scene may have, as texts; the default of one without is "required"."""

    key: str
    unit: str
    default: str
    doc: str
    usual: str = ""
    possible: str = ""
    type: str = ""


def schema() -> list[SchemaRow]:
    """Return all keys of a scene, in the order of the documentation."""
    return list(rows_of(Scene, ""))


def rows_of(cls: type, prefix: str) -> Iterator[SchemaRow]:
    """Yield the keys of one table of a scene, ``prefix`` before each."""
    kinds = types_of(cls)
    for name, attribute in fields_of(cls):
        kind = kinds[attribute.name]
        metadata = attribute.metadata
        free = metadata.get("rest") or FrozenTable in (kind, *get_args(kind))
        key = prefix + ("*" if metadata.get("rest") else f"{name}.*" if free else name)
        if attrs.has(kind):
            if bare_key(kind) is not None:
                yield SchemaRow(
                    key, "", shown_default(attribute), metadata["doc"], type="a name, or a table"
                )
            if key in NAMED:
                yield SchemaRow(
                    f"{key}.name",
                    "",
                    "",
                    f"{NAMED[key]}, whose values the other keys change",
                    type="text",
                )
            yield from rows_of(kind, f"{key}.")
        else:
            usual, possible = (shown_range(attribute, which) for which in ("usual", "possible"))
            unit = metadata["unit"] or ""
            shown = shown_type(kind, attribute)
            yield SchemaRow(
                key, unit, shown_default(attribute), metadata["doc"], usual, possible, shown
            )
            if shown == "table" and get_origin(kind) is not tuple:  # one that may be left out
                yield from (
                    row
                    for one in get_args(kind)
                    if attrs.has(one)
                    for row in rows_of(one, f"{key}.")
                )


def shown_type(kind: Any, attribute: "attrs.Attribute[Any]") -> str:
    """Return what a field takes, in words, with the choices where there are some."""
    validator = getattr(
        attribute.validator, "validator", attribute.validator
    )  # that of an optional value
    choices = [
        str(one)
        for one in (*getattr(validator, "options", ()), *attribute.metadata.get("words", ()))
    ]
    kinds = [one for one in get_args(kind) or (kind,) if one is not type(None)]
    many = get_origin(kind) is tuple
    words = {
        float: "quantity" if attribute.metadata.get("unit") not in (None, "1") else "number",
        int: "whole number",
    }
    words |= {bool: "true or false", str: "text", Any: "a name, or a table"}
    if choices and str in kinds:
        return ("list of " if many else "") + " or ".join(choices)
    if any(attrs.has(one) and bare_key(one) is not None for one in kinds):
        return f"a name, or a table{', or a list of them' if many else ''}"
    plain = next((words[one] for one in kinds if one in words), "table")
    if many:
        plural = plain.replace("quantity", "quantities")
        plural = plural.replace("number", "numbers")
        return f"list of {plural.replace('text', 'texts')}"
    return " or ".join([plain, *choices])


def shown_range(attribute: "attrs.Attribute[Any]", which: str) -> str:
    """Return what is "usual", or "possible", of a field as people read it; nothing where it says nothing."""
    span = attribute.metadata.get(which)
    return "" if span is None else format_span(span, attribute.metadata.get("unit"))


def shown_default(attribute: "attrs.Attribute[Any]") -> str:
    """Return the default of a field as people read it: with unit, "required" or "derived"."""
    default = attribute.default
    unit = attribute.metadata.get("unit")
    if default is attrs.NOTHING:
        return "required"
    if isinstance(default, attrs.Factory):  # type: ignore[arg-type]
        return "derived"
    if attrs.has(type(default)):
        bare = (a.name for _, a in fields_of(type(default)) if a.metadata.get("bare"))
        return str(getattr(default, next(bare)))
    if isinstance(default, float) and unit:
        return format_quantity(default, unit)
    return "" if default is None or default == () or default == FrozenTable() else str(default)
