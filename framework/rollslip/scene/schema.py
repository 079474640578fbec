"""The schema: every key that a scene may have, with unit, default, meaning and ranges, for people and the docs."""

from collections.abc import Iterator
from typing import Any, NamedTuple, get_args

import attrs

from rollslip.fields import span_in_words
from rollslip.scene.reading import NAMED
from rollslip.scene.values import Scene
from rollslip.structure import FrozenTable, attributes, bare_key, key_of, types_of
from rollslip.units import format_quantity

__all__ = ["SchemaRow", "schema", "shown_default", "shown_range"]


class SchemaRow(NamedTuple):
    """One key that a scene may have, as texts: unit, default ("required" if there is none), meaning, and ranges."""

    key: str
    unit: str
    default: str
    doc: str
    usual: str = ""
    possible: str = ""


def schema() -> list[SchemaRow]:
    """Return all keys of a scene, in the order of the documentation."""
    return list(_rows(Scene, ""))


def _rows(cls: type, prefix: str) -> Iterator[SchemaRow]:
    kinds = types_of(cls)
    for attribute in attributes(cls):
        name = key_of(attribute)
        if name is None:
            continue
        kind, metadata = kinds[attribute.name], attribute.metadata
        free = metadata.get("rest") or FrozenTable in (kind, *get_args(kind))
        key = prefix + ("*" if metadata.get("rest") else f"{name}.*" if free else name)
        if attrs.has(kind):
            if bare_key(kind) is not None:
                yield SchemaRow(key, "", shown_default(attribute), metadata["doc"])
            if key in NAMED:
                yield SchemaRow(
                    f"{key}.name", "", "", f"a {key} that a plugin offers, whose values the other keys change"
                )
            yield from _rows(kind, f"{key}.")
        else:
            ranges = (shown_range(attribute, which) for which in ("usual", "possible"))
            yield SchemaRow(key, metadata["unit"] or "", shown_default(attribute), metadata["doc"], *ranges)


def shown_range(attribute: "attrs.Attribute[Any]", which: str) -> str:
    """Return what is "usual", or "possible", of a field as people read it; nothing where it says nothing."""
    span = attribute.metadata.get(which)
    return "" if span is None else span_in_words(span, attribute.metadata.get("unit"))


def shown_default(attribute: "attrs.Attribute[Any]") -> str:
    """Return the default of a field as people read it: with unit, "required" or "derived"."""
    default, unit = attribute.default, attribute.metadata.get("unit")
    if default is attrs.NOTHING:
        return "required"
    if isinstance(default, attrs.Factory):  # type: ignore[arg-type]
        return "derived"
    if attrs.has(type(default)):
        bare = (a.name for a in attributes(type(default)) if a.metadata.get("bare"))
        return str(getattr(default, next(bare)))
    if isinstance(default, float) and unit:
        return format_quantity(default, unit)
    return "" if default is None or default == () or default == FrozenTable() else str(default)
