"""The schema of a scene as JSON Schema, by which editors complete keys and mark what is wrong.

It is made from the rows that ``rollslip schema`` lists, with the models and studies that are installed. It holds form
only: that an oil knows a temperature, or that two keys go together, is found when a scene is read.

References
----------
A. Wright, H. Andrews, B. Hutton, JSON Schema: a media type for describing JSON documents, draft-07 (2019).
"""

import re
from typing import Any, Final

from rollslip.catalogue.discovery import available
from rollslip.planning.keys import keys
from rollslip.scene.schema import SchemaRow
from rollslip.scene.values import SEPARATORS, model_kind

__all__ = ["json_schema"]

_DRAFT: Final = "http://json-schema.org/draft-07/schema#"
_TYPES: Final[dict[str, dict[str, Any]]] = {
    "quantity": {"type": ["number", "string"]},
    "number": {"type": ["number", "string"]},
    "whole number": {"type": "integer"},
    "true or false": {"type": "boolean"},
    "text": {"type": "string"},
    "table": {"type": "object"},
    "a name": {"type": "string"},
    "list of them": {"type": "array"},
}


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema of scenes, with what is installed."""
    root: dict[str, Any] = {
        "$schema": _DRAFT,
        "title": "rollslip scene",
        "type": "object",
        "additionalProperties": False,
    }
    for row in keys(models=True):
        *tables, name = row.key.split(".")
        at = root
        of_law = len(tables) > 1 and tables[0] == "models" and name not in ("model", "*")
        if of_law and len(tables) > 2:  # of a law in a law
            continue
        for table in tables:
            at = _table(at, table)
        if name == "*":
            at["additionalProperties"] = True
        elif of_law:  # laws may give one name to different things
            at.setdefault("properties", {}).setdefault(name, {"description": row.doc})
        else:
            _put(at, name, row)
    return root


def _table(at: dict[str, Any], name: str) -> Any:
    """The table of a name below another, which knows no key that no row has."""
    of = at.setdefault("properties", {}).setdefault(name, {})
    if "anyOf" in of:  # a name, or a table
        return next(one for one in of["anyOf"] if one.get("type") == "object")
    of.setdefault("type", "object")
    if of["type"] == "object":
        of.setdefault("additionalProperties", False)
    return of


def _put(at: dict[str, Any], name: str, row: SchemaRow) -> None:
    """Put a key into its table."""
    said = {"description": ", ".join(filter(None, (row.doc, row.usual and f"usually {row.usual}")))}
    if row.unit not in ("", "1"):
        said["description"] += f" [{row.unit}]"
    kind = re.fullmatch(r"models\.(\w+)(\.model)?", row.key)
    names: dict[str, Any] = {}
    if kind:
        names = {
            "enum": [*(SEPARATORS if kind[1] == "separator" else available(model_kind(kind[1])))]
        }
    if row.type.startswith("a name, or a table"):
        table = {"type": "object", "properties": {}, "additionalProperties": False}
        of: dict[str, Any] = {"anyOf": [{"type": "string", **names}, table]}
        if row.type.endswith("list of them"):
            of["anyOf"].append({"type": "array"})
    else:
        of = {"type": "string", **names} if names else _type(row.type)
    at.setdefault("properties", {}).setdefault(name, {}).update(of | said)


def _type(words: str) -> dict[str, Any]:
    """What a key takes, from the words of its row: one kind, or one of several names."""
    if words.startswith("list of"):
        return {"type": "array"}
    kinds = words.split(" or ") if words != "true or false" else [words]
    known = [_TYPES[one] for one in kinds if one in _TYPES]
    names = [one for one in kinds if one not in _TYPES]
    each = [*known, *([{"enum": names}] if names else [])]
    return each[0] if len(each) == 1 else {"anyOf": each}
