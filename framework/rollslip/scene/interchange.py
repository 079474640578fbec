"""Write and read a scene as a neutral file of parameters for other programs: versioned JSON, each number with its unit.

- A number is ``{"value": 0.015, "unit": "m"}``, and so is a list of numbers; a value without unit, such as a count, a
  choice or a name, is a plain JSON value. All values are written, with defaults and those of named bearings, so that
  the file can be read without rollslip.
- The round trip is exact: a scene that is written and read is equal to the original, with the same hash. Numbers in SI
  units are written with the shortest text that gives the same float. Texts of oil, cage and models are split into
  number and unit only where the text of the number is restored exactly.
- Files that other programs write may use any unit that scenes accept.
- Files of other programs are converted from and to these parameters: `read_foreign`, `write_foreign`, with a format for
  each (`rollslip.scene.formats`), of which this JSON is one.
"""

import contextlib
import json
import math
import os
import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Final

import attrs

from rollslip.errors import SceneError
from rollslip.files import content_of, decoded, readable, whole_file
from rollslip.scene.formats import Read, SceneFormat, Written, endings, format_of
from rollslip.scene.reading import from_raw
from rollslip.scene.schema import schema
from rollslip.scene.values import Scene
from rollslip.structure import raise_problems, resolved, scene_hash
from rollslip.toml import as_list
from rollslip.units import as_written

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "FORMAT", "VERSION", "Json", "from_parameters", "parameter_schema", "read_foreign", "to_parameters",
    "write_foreign",
]  # fmt: skip

#: Name of the format, in its files.
FORMAT: Final = "rollslip-parameters"
#: Version of the format, in its files: to be raised when a reader of the present version would misread a file.
VERSION: Final = 1
_QUANTITY: Final = re.compile(r"([+-]?\d+(?:\.\d+)?) ([A-Za-z%].*)", re.ASCII)
#: Keys whose values are texts, even where these look like a number with a unit.
_TEXT_KEYS: Final = frozenset({"title", "description", "name", "model", "source"})


@cache
def _units() -> Mapping[str, str]:
    """Return the SI unit of each key of a scene that has one."""
    return {row.key: row.unit for row in schema() if row.unit}


def to_parameters(scene: Scene) -> dict[str, Any]:
    """Return a scene as plain values, to be written as JSON.

    Examples
    --------
    >>> from rollslip import load_scene
    >>> to_parameters(load_scene("1032930-70C"))["parameters"]["bearing"]["roller_diameter"]
    {'value': 0.015, 'unit': 'm'}
    """
    return {"format": FORMAT, "version": VERSION, "parameters": _parameter(resolved(scene), "")}


def _parameter(value: object, key: str) -> Any:
    """Return a value of a scene, or all values of a table, as parameters with units."""
    unit = _units().get(key)
    if isinstance(value, Mapping):
        return {
            name: _parameter(inner, f"{key}.{name}".removeprefix("."))
            for name, inner in value.items()
        }
    if isinstance(value, list | tuple) and not (
        unit and all(isinstance(element, float) for element in value)
    ):
        return [_parameter(element, f"{key}[]") for element in value]
    if isinstance(value, str):
        return value if key.rpartition(".")[2] in _TEXT_KEYS else _split_quantity(value)
    return value if unit is None else {"value": value, "unit": unit}


def _split_quantity(text: str) -> Any:
    """Return number and unit of a text, or the text itself where both would not give it again."""
    if (found := _QUANTITY.fullmatch(text)) is None:
        return text
    number = float(found[1]) if "." in found[1] else int(found[1])
    return {"value": number, "unit": found[2]} if str(number) == found[1] else text


def from_parameters(document: object, source: str = "parameters") -> Scene:
    """Return the scene of a file of parameters.

    Parameters
    ----------
    document : object
        The content of the file, as of `to_parameters`.
    source : str
        Name of the file, for messages.

    Raises
    ------
    SceneError
        With every fault, if the document has another format or version, or its scene is wrong.
    """
    if not isinstance(document, Mapping) or document.get("format") != FORMAT:
        raise SceneError([f"{source}: no file of parameters: 'format' must be {FORMAT!r}"])
    if document.get("version") != VERSION:
        version = as_written(document.get("version"))
        raise SceneError(
            [
                f"{source}: version: {version} is not read, only {VERSION}; write the file anew, or update rollslip"
            ]
        )
    if unknown := sorted(document.keys() - {"format", "version", "parameters"}):
        raise SceneError([f"{source}: {', '.join(map(as_written, unknown))}: unknown key"])
    if not isinstance(parameters := document.get("parameters"), Mapping):
        raise SceneError([f"{source}: parameters: a table is expected"])
    problems: list[str] = []
    raw = _read(parameters, "", source, problems)
    raise_problems(problems)
    text = json.dumps(document, indent=1, allow_nan=False)
    scene = from_raw(raw, source, text)
    if scene.bearing.mounting is None:
        return scene
    # the file states values that follow from others: the clearance in operation, and equal temperatures
    operation = raw["operation"]
    bearing = {key: value for key, value in raw["bearing"].items() if key != "radial_clearance"}
    equal = [
        key
        for key in operation
        if key.endswith("_temperature") and operation[key] == operation["temperature"]
    ]
    for left_out in (equal, []):
        stated = {key: value for key, value in operation.items() if key not in left_out}
        with contextlib.suppress(SceneError):
            follows = from_raw(raw | {"bearing": bearing, "operation": stated}, source, text)
            if follows.bearing.radial_clearance == scene.bearing.radial_clearance:
                return follows
    return scene


def _read(value: object, key: str, source: str, problems: list[str]) -> Any:
    """Return a parameter, or a table of them, as a raw scene has it; faults are added to ``problems``."""
    if isinstance(value, Mapping) and "value" in value and "unit" in value:
        return _read_quantity(value, key, source, problems)
    if isinstance(value, Mapping):
        return {
            name: _read(inner, f"{key}.{name}".removeprefix("."), source, problems)
            for name, inner in value.items()
        }
    if isinstance(value, list):
        return [_read(element, f"{key}[]", source, problems) for element in value]
    if value is None:
        problems.append(f"{source}: {key}: has no value; leave it out")
    if not _finite(value):
        problems.append(f"{source}: {key}: {value} is not a finite number")
    return value


def _read_quantity(value: Mapping[str, Any], key: str, source: str, problems: list[str]) -> Any:
    """Return a number, or a list of numbers, with unit: plain in SI units, a text in others."""
    number = value["value"]
    unit = value["unit"]
    numbers = as_list(number)
    are_numbers = all(
        isinstance(x, int | float) and not isinstance(x, bool) and _finite(x) for x in numbers
    )
    if not are_numbers or not isinstance(unit, str) or len(value) > 2:
        problems.append(
            f"{source}: {key}: a finite number, or a list of them, with a text 'unit' is expected"
        )
        return None
    if unit in (_units().get(key), "1"):
        return number
    texts = [f"{x!r} {unit}" for x in numbers]
    return texts if isinstance(number, list) else texts[0]


def _finite(value: object) -> bool:
    return not isinstance(value, float) or math.isfinite(value)


def _refuse_constant(text: str) -> float:
    """Refuse NaN and Infinity, which are not numbers of JSON."""
    raise ValueError(f"{text} is not a number")


# Files --------------------------------------------------------------------------------------------------------------


@attrs.frozen
class Json(SceneFormat):
    """The neutral parameters as they are, in JSON."""

    endings: ClassVar[tuple[str, ...]] = (".json",)

    def read(self, content: bytes, source: str) -> Read:
        """Return the parameters of a file from its `content`; its `source` is named in messages."""
        try:
            return Read(json.loads(decoded(content, source), parse_constant=_refuse_constant))
        except (ValueError, RecursionError) as error:
            raise SceneError([f"{source}: not valid JSON: {error}"]) from None

    def write(self, document: Mapping[str, Any], result: "xr.Dataset | None") -> Written:
        """Return the file of a `document`; a `result` is not written."""
        notes = (
            ()
            if result is None
            else ("the result: this format holds parameters alone; not written",)
        )
        return Written(json.dumps(document, indent=2, allow_nan=False) + "\n", notes)


#: The built-in format, which the catalogue finds in this module.
JSON_FORMAT: Final = Json("json")


def read_foreign(path: str | os.PathLike[str]) -> tuple[Scene, tuple[str, ...]]:
    """Return the scene of another program's file, or of a file of parameters, and notes on missing and unused items.

    Raises
    ------
    SceneError, PluginError
        As `from_parameters`; if no format has the ending, or the file cannot be read.
    """
    source = readable(os.fspath(path))
    file_format = _format_of(path, source)
    try:
        content = content_of(Path(path))
    except OSError as error:
        raise SceneError([f"{source}: cannot be read: {error.strerror or error}"]) from None
    read = file_format.read(content, source)
    return from_parameters(read.document, source), read.notes


def write_foreign(
    scene: Scene, path: str | os.PathLike[str], result: "xr.Dataset | None" = None, **choices: Any
) -> tuple[str, ...]:
    """Write a scene, with its results, into a file of another program; return notes on what the format cannot hold.

    Parameters
    ----------
    scene : Scene
        The scene.
    path : str or path
        The file; its suffix decides on the format.
    result : xarray.Dataset, optional
        A result of that scene.
    **choices
        Fields of the format.

    Raises
    ------
    SceneError
        If no format has the ending or the choices, it cannot hold the scene, or the result is of another scene.
    OutputError
        If the file cannot be written.
    """
    source = readable(os.fspath(path))
    file_format = _format_of(path, source)
    if unknown := [
        name.replace("_", "-")
        for name in choices
        if name not in attrs.fields_dict(type(file_format))
    ]:
        raise SceneError([f"{source}: format {file_format.name} does not know --{unknown[0]}"])
    if result is not None and (other := str(result.attrs.get("scene_hash", ""))) != (
        own := scene_hash(scene)
    ):
        raise SceneError(
            [
                f"{source}: the result is of another scene, {other[:12] or 'which it does not say'}, not of "
                f"{own[:12]}; run this one, or give the one that was run, with the same --set"
            ]
        )
    file = attrs.evolve(file_format, **choices).write(to_parameters(scene), result)
    with whole_file(Path(path)) as partial:
        partial.write_bytes(file.text if isinstance(file.text, bytes) else file.text.encode())
    return file.notes


def _format_of(path: str | os.PathLike[str], source: str) -> SceneFormat:
    """Return the format of a file by its suffix; raise `SceneError` where no format has it."""
    if (file_format := format_of(path)) is None:
        raise SceneError(
            [f"{source}: no installed format has this ending; there are: {', '.join(endings())}"]
        )
    return file_format


def parameter_schema() -> dict[str, Any]:
    """Return the JSON Schema of files of parameters, with the unit and the meaning of every key."""
    root: dict[str, Any] = {"type": "object", "properties": {}}
    for row in schema():
        *tables, name = row.key.split(".")
        node = root
        for table in tables:
            node = node["properties"].setdefault(table, {"type": "object", "properties": {}})
            node.setdefault("properties", {})
        if name == "*":
            node["description"] = row.doc
        else:
            node["properties"].setdefault(name, {}).update(_key_schema(row.unit, row.doc))
            if row.default == "required":
                node.setdefault("required", []).append(name)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Parameters of a cylindrical roller bearing, its oil and its operation",
        "type": "object",
        "required": ["format", "version", "parameters"],
        "additionalProperties": False,
        "properties": {
            "format": {"const": FORMAT},
            "version": {"const": VERSION},
            "parameters": root,
        },
    }


def _key_schema(unit: str, doc: str) -> dict[str, Any]:
    """Return the JSON Schema of one key: any value, or a number or numbers with unit."""
    if not unit:
        return {"description": doc}
    number = {"oneOf": [{"type": "number"}, {"type": "array", "items": {"type": "number"}}]}
    return {
        "description": f"{doc} [{unit}]",
        "type": "object",
        "required": ["value", "unit"],
        "additionalProperties": False,
        "properties": {"value": number, "unit": {"type": "string", "examples": [unit]}},
    }
