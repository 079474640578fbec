"""The schema: every key that a scene may have, with unit, default, meaning and ranges, for users and documentation."""

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
    """One key that a scene may have, as texts; the default of a key without default is "required"."""

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
    """Yield a row for each key of one table of a scene.

    Parameters
    ----------
    cls : type
        Class of the table.
    prefix : str
        Dotted key of the table, with a dot at its end.
    """
    kinds = types_of(cls)
    for name, attribute in fields_of(cls):
        kind = kinds[attribute.name]
        metadata = attribute.metadata
        key = prefix + name
        if metadata.get("rest"):
            key = f"{prefix}*"
        elif FrozenTable in (kind, *get_args(kind)):
            key += ".*"
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
                for member in filter(attrs.has, get_args(kind)):
                    yield from rows_of(member, f"{key}.")


def shown_type(kind: Any, attribute: "attrs.Attribute[Any]") -> str:
    """Return the type of a field as users read it, with its choices.

    Parameters
    ----------
    kind : type
        Type of the values.
    attribute : attrs.Attribute
        The field.
    """
    # the validator of an optional value is inside another one
    validator = getattr(attribute.validator, "validator", attribute.validator)
    options = (*getattr(validator, "options", ()), *attribute.metadata.get("keywords", ()))
    choices = list(map(str, options))
    kinds = [member for member in get_args(kind) or (kind,) if member is not type(None)]
    is_list = get_origin(kind) is tuple
    type_names = {
        float: "quantity" if attribute.metadata.get("unit") not in (None, "1") else "number",
        int: "whole number",
        bool: "true or false",
        str: "text",
        Any: "a name, or a table",
    }
    if choices and str in kinds:
        return ("list of " if is_list else "") + " or ".join(choices)
    if any(attrs.has(member) and bare_key(member) is not None for member in kinds):
        return f"a name, or a table{', or a list of them' if is_list else ''}"
    plain = next((type_names[member] for member in kinds if member in type_names), "table")
    if is_list:
        plural = plain.replace("quantity", "quantities").replace("number", "numbers")
        return f"list of {plural.replace('text', 'texts')}"
    return " or ".join([plain, *choices])


def shown_range(attribute: "attrs.Attribute[Any]", which: str) -> str:
    """Return a range of a field as users read it; empty where the field has none.

    Parameters
    ----------
    attribute : attrs.Attribute
        The field.
    which : str
        "usual" or "possible".
    """
    span = attribute.metadata.get(which)
    return "" if span is None else format_span(span, attribute.metadata.get("unit"))


def shown_default(attribute: "attrs.Attribute[Any]") -> str:
    """Return the default of a field as users read it: with unit, "required" or "derived"."""
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
