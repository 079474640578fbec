"""Every key that a scene can have, those of cage, oil, studies and models included, found by any part of it.

What a table of a scene leaves to plugins stands in `rollslip.scene.schema` as ``*``: here their classes are asked.
"""

import re
from collections.abc import Iterator
from typing import Final

from rollslip.bearing.cage import Cage
from rollslip.catalogue.discovery import available, get_class
from rollslip.errors import PluginError, SceneError, did_you_mean, nearest
from rollslip.lubricant.table import OilTable
from rollslip.scene.changes import full_key
from rollslip.scene.schema import SchemaRow, rows_of, schema
from rollslip.units import expectation

__all__ = ["example", "keys", "keys_of"]

#: What people call a table.
_TABLES: Final = {
    "oil": "lubricant",
    "material": "bearing.material",
    "model": "models",
    "studies": "study",
}
_LAWS: Final = ("contact", "film", "pressure", "traction")


def keys(*, models: bool = False) -> list[SchemaRow]:
    """Return all keys in the order of a scene; the parameters of all models, which are many, only where asked for."""
    found: list[SchemaRow] = []
    for row in schema():
        found += _behind(row.key, models) or [row]
    return found


def _behind(key: str, models: bool) -> list[SchemaRow]:
    """Return what stands behind a key that ends in a star; nothing where that is free."""
    if key == "cage.*":
        return list(rows_of(Cage, "cage."))
    if key == "lubricant.*":
        return [row for row in rows_of(OilTable, "lubricant.") if row.key != "lubricant.name"]
    if key == "study.*":
        return [
            row for name in available("study") for row in _of_class("study", name, f"study.{name}.")
        ]
    for kind in _LAWS:
        if key == f"models.{kind}.*" and models:
            return [
                row._replace(doc=f"{row.doc} (of model {name!r})")
                for name in available(kind)
                for row in _of_class(kind, name, f"models.{kind}.")
            ]
    return []


def _of_class(kind: str, name: str, prefix: str) -> Iterator[SchemaRow]:
    try:
        cls = get_class(kind, name)
    except PluginError:  # `rollslip plugins list` says so
        return
    yield from rows_of(cls, prefix)


def keys_of(what: str) -> list[SchemaRow]:
    """Return the keys that a word means: a key, a table, a study, or the last part of a key."""
    word = _TABLES.get(what.strip()) or full_key(what.strip())
    every = keys(models=word.startswith("models"))
    if found := [row for row in every if row.key == word or row.key.startswith(f"{word}.")]:
        return found
    every = keys(models=True)
    if found := [row for row in every if f".{word}." in f".{row.key}."]:
        return found
    parts = {part: None for row in every for part in (row.key, *row.key.split(".")) if part != "*"}
    hint = did_you_mean(nearest(word, parts, cutoff=0.5), "'rollslip schema' lists all")
    raise SceneError([f"no key of a scene is called {what!r}; {hint}"])


def example(row: SchemaRow) -> str:
    """Return a value of a key as a scene may have it: its default, or one of its kind."""
    value = row.default if row.default not in ("required", "derived", "") else ""
    if not value and row.unit:
        such = re.search(r"such as (.+)$", expectation(row.unit))
        value = such.group(1).strip("'") if such else ""
    if not value and row.type == "whole number":
        least = re.search(r"from (\d+)", row.usual)
        return least.group(1) if least else "1"
    if not value:
        value = (
            row.type.split(" or ")[0]
            if row.type not in ("text", "a name, or a table", "table")
            else "NAME"
        )
    if row.type.startswith("list"):
        return "[]" if value in ("", "NAME") or value.startswith("list") else f'["{value}"]'
    if value in ("True", "False"):
        return value.lower()
    return value if re.fullmatch(r"[-+0-9.e]+", value) else f'"{value}"'
