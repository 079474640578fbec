"""The JSON Schema of scenes, by which editors complete keys and mark errors.

It is made from the rows that ``rollslip schema`` lists, with the models and studies that are installed. It checks the
form only; whether values fit together is checked when a scene is read.

References
----------
A. Wright, H. Andrews, B. Hutton, JSON Schema: a media type for describing JSON documents, draft-07 (2019).
"""

import re
from typing import Any, Final

from rollslip.catalogue.discovery import available
from rollslip.planning.keys import keys
from rollslip.scene.schema import SchemaRow
from rollslip.scene.values import APPROACHES, SEPARATORS, model_kind

__all__ = ["json_schema"]

#: Version of the standard; draft 7 is what editors of TOML understand.
_DRAFT: Final = "http://json-schema.org/draft-07/schema#"
#: Type in a row -> its JSON Schema.
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
        node = root
        is_of_law = len(tables) > 1 and tables[0] == "models" and name not in ("model", "*")
        if is_of_law and len(tables) > 2:  # parameter of a submodel
            continue
        for table in tables:
            node = _table(node, table)
        if name == "*":
            node["additionalProperties"] = True
        elif is_of_law:  # laws may give one name to different parameters
            node.setdefault("properties", {}).setdefault(name, {"description": row.doc})
        else:
            _add_key(node, name, row)
    return root


def _table(node: dict[str, Any], name: str) -> Any:
    """Return the schema of a table in another table; it allows only keys that have a row."""
    table = node.setdefault("properties", {}).setdefault(name, {})
    if "anyOf" in table:  # a name, or a table
        return next(option for option in table["anyOf"] if option.get("type") == "object")
    table.setdefault("type", "object")
    if table["type"] == "object":
        table.setdefault("additionalProperties", False)
    return table


def _add_key(node: dict[str, Any], name: str, row: SchemaRow) -> None:
    """Add the schema of a key to that of its table."""
    description = {
        "description": ", ".join(filter(None, (row.doc, row.usual and f"usually {row.usual}")))
    }
    if row.unit not in ("", "1"):
        description["description"] += f" [{row.unit}]"
    kind = re.fullmatch(r"models\.(\w+)(\.model)?", row.key)
    names: dict[str, Any] = {}
    if kind:
        own_names = {"approach": APPROACHES, "separator": SEPARATORS}.get(kind[1])
        names = {"enum": [*(own_names or available(model_kind(kind[1])))]}
    if row.type.startswith("a name, or a table"):
        schema: dict[str, Any] = {
            "anyOf": [
                {"type": "string", **names},
                {"type": "object", "properties": {}, "additionalProperties": False},
            ]
        }
        if row.type.endswith("list of them"):
            schema["anyOf"].append({"type": "array"})
    elif names:
        schema = {"type": "string", **names}
    elif row.type.startswith("list of"):
        schema = {"type": "array"}
    else:
        types = [row.type] if row.type in _TYPES else row.type.split(" or ")
        options = [_TYPES[name] for name in types if name in _TYPES]
        choices = [name for name in types if name not in _TYPES]
        if choices:
            options.append({"enum": choices})
        schema = options[0] if len(options) == 1 else {"anyOf": options}
    node.setdefault("properties", {}).setdefault(name, {}).update(schema | description)
