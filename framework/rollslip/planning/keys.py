"""All keys that a scene can have, those of cage, oil, studies and models included, and a search among them.

A table whose keys belong to plugins has the key ``*`` in `rollslip.scene.schema`: it is replaced by the fields of the
classes that are installed.
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

#: Other name of a table -> its key.
_TABLES: Final = {
    "oil": "lubricant",
    "material": "bearing.material",
    "model": "models",
    "studies": "study",
}
#: Kinds of laws whose parameters are keys of a scene.
_LAWS: Final = ("contact", "film", "pressure", "traction")


def keys(*, models: bool = False) -> list[SchemaRow]:
    """Return all keys in the order of a scene; the parameters of all models, which are many, only on request."""
    rows: list[SchemaRow] = []
    for row in schema():
        rows += _expand(row.key, models) or [row]
    return rows


def _expand(key: str, models: bool) -> list[SchemaRow]:
    """Return the keys in place of a key that ends in a star; none where users choose them freely."""
    if key == "cage.*":
        return list(rows_of(Cage, "cage."))
    if key == "lubricant.*":
        return [row for row in rows_of(OilTable, "lubricant.") if row.key != "lubricant.name"]
    if key == "study.*":
        return [
            row
            for name in available("study")
            for row in _class_rows("study", name, f"study.{name}.")
        ]
    for kind in _LAWS:
        if key == f"models.{kind}.*" and models:
            return [
                row._replace(doc=f"{row.doc} (of model {name!r})")
                for name in available(kind)
                for row in _class_rows(kind, name, f"models.{kind}.")
            ]
    return []


def _class_rows(kind: str, name: str, prefix: str) -> Iterator[SchemaRow]:
    """Yield the keys of the fields of a plugin's class; none for one that cannot be imported."""
    try:
        cls = get_class(kind, name)
    except PluginError:  # `rollslip plugins list` says so
        return
    yield from rows_of(cls, prefix)


def keys_of(what: str) -> list[SchemaRow]:
    """Return the keys that a text means: a key, a table, a study, or a part of a key."""
    word = _TABLES.get(what.strip()) or full_key(what.strip())
    every = keys(models=word.startswith("models"))
    rows = [row for row in every if row.key == word or row.key.startswith(f"{word}.")]
    if rows:
        return rows
    every = keys(models=True)
    rows = [row for row in every if f".{word}." in f".{row.key}."]
    if rows:
        return rows
    parts = {part: None for row in every for part in (row.key, *row.key.split(".")) if part != "*"}
    hint = did_you_mean(nearest(word, parts, cutoff=0.5), "'rollslip schema' lists all")
    raise SceneError([f"no key of a scene is called {what!r}; {hint}"])


def example(row: SchemaRow) -> str:
    """Return a value of a key in TOML: its default, or a value of its type."""
    value = _example_value(row)
    if row.type.startswith("list"):
        return "[]" if value in ("", "NAME") or value.startswith("list") else f'["{value}"]'
    if value in ("True", "False"):
        return value.lower()
    return value if re.fullmatch(r"[-+0-9.e]+", value) else f'"{value}"'


def _example_value(row: SchemaRow) -> str:
    """Return the default of a key as text, else an example of its unit, else of its type."""
    if row.default not in ("required", "derived", ""):
        return row.default
    if row.unit and (match := re.search(r"such as (.+)$", expectation(row.unit))):
        return match.group(1).strip("'")
    if row.type == "whole number":
        minimum = re.search(r"from (\d+)", row.usual)
        return minimum.group(1) if minimum else "1"
    if row.type in ("text", "a name, or a table", "table"):
        return "NAME"
    return row.type.split(" or ")[0]
