"""A scene as a neutral file of parameters that other programs read: JSON, every number with its unit, versioned.

- A number is ``{"value": 0.015, "unit": "m"}``, a list of numbers likewise; what has no unit, a count, a choice or a
  name, stands as it is. All values are there, defaults and those of named bearings too: the file needs no rollslip.
- The way back is exact: a scene that is written and read is equal to the one before, with the same hash. Numbers in SI
  units are floats whose text is the shortest that gives them again; values that a scene keeps as text, of oil, cage and
  models, are parted into number and unit only where the number's text survives, and stay text elsewhere.
- What comes from others may be in any unit that scenes take.
- Files of other programs come and go by these parameters too: `read_foreign`, `write_foreign`, and a format for each
  (`rollslip.scene.formats`), of which this JSON is one.
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
from rollslip.structure import resolved, scene_hash
from rollslip.units import as_written

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "FORMAT", "VERSION", "Json", "from_parameters", "parameter_schema", "read_foreign", "to_parameters",
    "write_foreign",
]  # fmt: skip

FORMAT: Final = "rollslip-parameters"
VERSION: Final = 1
_QUANTITY: Final = re.compile(r"([+-]?\d+(?:\.\d+)?) ([A-Za-z%].*)", re.ASCII)
#: Keys whose values are words, whatever these look like.
_WORDS: Final = frozenset({"title", "description", "name", "model", "source"})


@cache
def _units() -> Mapping[str, str]:
    return {row.key: row.unit for row in schema() if row.unit}


def to_parameters(scene: Scene) -> dict[str, Any]:
    """Return a scene as plain values, to be written as JSON.

    Examples
    --------
    >>> from rollslip import load_scene
    >>> to_parameters(load_scene("1032930-70C"))["parameters"]["bearing"]["roller_diameter"]
    {'value': 0.015, 'unit': 'm'}
    """
    return {"format": FORMAT, "version": VERSION, "parameters": _told(resolved(scene), "")}


def _told(value: object, key: str) -> Any:
    unit = _units().get(key)
    if isinstance(value, Mapping):
        return {
            name: _told(inner, f"{key}.{name}" if key else name) for name, inner in value.items()
        }
    if isinstance(value, list | tuple) and not (
        unit and all(isinstance(one, float) for one in value)
    ):
        return [_told(one, f"{key}[]") for one in value]
    if isinstance(value, str):
        return value if key.rpartition(".")[2] in _WORDS else _parted(value)
    return value if unit is None else {"value": value, "unit": unit}


def _parted(text: str) -> Any:
    """Part a text into number and unit where it comes together again as it was."""
    found = _QUANTITY.fullmatch(text)
    if found is None:
        return text
    number = float(found[1]) if "." in found[1] else int(found[1])
    return {"value": number, "unit": found[2]} if str(number) == found[1] else text


def from_parameters(document: object, source: str = "parameters") -> Scene:
    """Return the scene of a file of parameters."""
    if not isinstance(document, Mapping) or document.get("format") != FORMAT:
        raise SceneError([f"{source}: no file of parameters: 'format' must be {FORMAT!r}"])
    if document.get("version") != VERSION:
        came = as_written(document.get("version"))
        raise SceneError(
            [
                f"{source}: version: {came} is not read, only {VERSION}; write the file anew, or update rollslip"
            ]
        )
    if unknown := sorted(document.keys() - {"format", "version", "parameters"}):
        raise SceneError([f"{source}: {', '.join(map(as_written, unknown))}: unknown key"])
    if not isinstance(parameters := document.get("parameters"), Mapping):
        raise SceneError([f"{source}: parameters: a table is expected"])
    problems: list[str] = []
    raw = _read(parameters, "", source, problems)
    if problems:
        raise SceneError(problems)
    text = json.dumps(document, indent=1, allow_nan=False)
    scene = from_raw(raw, source, text)
    if scene.bearing.mounting is None:
        return scene
    # what follows, the clearance that a mounting leaves and equal temperatures, was written out for others
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
    if isinstance(value, Mapping) and "value" in value and "unit" in value:
        number = value["value"]
        unit = value["unit"]
        numbers = number if isinstance(number, list) else [number]
        good = all(
            isinstance(one, int | float) and not isinstance(one, bool) and _finite(one)
            for one in numbers
        )
        if not good or not isinstance(unit, str) or len(value) > 2:
            problems.append(
                f"{source}: {key}: a finite number, or a list of them, with a text 'unit' is expected"
            )
            return None
        if unit in (_units().get(key), "1"):
            return number
        texts = [f"{one!r} {unit}" for one in numbers]
        return texts if isinstance(number, list) else texts[0]
    if isinstance(value, Mapping):
        return {
            name: _read(inner, f"{key}.{name}" if key else name, source, problems)
            for name, inner in value.items()
        }
    if isinstance(value, list):
        return [_read(one, f"{key}[]", source, problems) for one in value]
    if value is None:
        problems.append(f"{source}: {key}: has no value; leave it out")
    if not _finite(value):
        problems.append(f"{source}: {key}: {value} is no finite number")
    return value


def _finite(value: object) -> bool:
    return not isinstance(value, float) or math.isfinite(value)


def _refused(text: str) -> float:
    raise ValueError(f"{text} is no number")


# Files --------------------------------------------------------------------------------------------------------------


@attrs.frozen
class Json(SceneFormat):
    """The neutral parameters as they are, in JSON."""

    endings: ClassVar[tuple[str, ...]] = (".json",)

    def read(self, content: bytes, source: str) -> Read:
        """Read a file; see `SceneFormat.read`."""
        try:
            return Read(json.loads(decoded(content, source), parse_constant=_refused))
        except (ValueError, RecursionError) as error:
            raise SceneError([f"{source}: not valid JSON: {error}"]) from None

    def write(self, document: Mapping[str, Any], result: "xr.Dataset | None") -> Written:
        """Write a file; results have no place in it."""
        notes = (
            ()
            if result is None
            else ("the result: this format holds parameters alone; not written",)
        )
        return Written(json.dumps(document, indent=2, allow_nan=False) + "\n", notes)


JSON_FORMAT: Final = Json("json")


def read_foreign(path: str | os.PathLike[str]) -> tuple[Scene, tuple[str, ...]]:
    """Read a file of another program, or of parameters, as a scene; say what it lacks and what of it is not used.

    Raises
    ------
    SceneError, PluginError
        As `from_parameters`; if no format has the ending, or the file cannot be read.
    """
    source = readable(os.fspath(path))
    known = _known(path, source)
    try:
        content = content_of(Path(path))
    except OSError as error:
        raise SceneError([f"{source}: cannot be read: {error.strerror or error}"]) from None
    found = known.read(content, source)
    return from_parameters(found.document, source), found.notes


def write_foreign(
    scene: Scene, path: str | os.PathLike[str], result: "xr.Dataset | None" = None, **choices: Any
) -> tuple[str, ...]:
    """Write a scene, with what was calculated of it, into a file that another program reads; say what it cannot hold.

    Choices are fields of the format.

    Raises
    ------
    SceneError
        If no format has the ending or the choices, it cannot hold the scene, or the result is of another scene.
    OutputError
        If the file cannot be written.
    """
    source = readable(os.fspath(path))
    known = _known(path, source)
    if lost := [
        name.replace("_", "-") for name in choices if name not in attrs.fields_dict(type(known))
    ]:
        raise SceneError([f"{source}: format {known.name} does not know --{lost[0]}"])
    if result is not None and (of := str(result.attrs.get("scene_hash", ""))) != (
        own := scene_hash(scene)
    ):
        raise SceneError(
            [f"{source}: the result is of another scene, {of[:12] or 'which it does not say'}, not of {own[:12]}; run "
             "this one, or give the one that was run, with the same --set"]
        )  # fmt: skip
    made = attrs.evolve(known, **choices).write(to_parameters(scene), result)
    with whole_file(Path(path)) as partial:
        partial.write_bytes(made.text if isinstance(made.text, bytes) else made.text.encode())
    return made.notes


def _known(path: str | os.PathLike[str], source: str) -> SceneFormat:
    if (found := format_of(path)) is None:
        raise SceneError(
            [f"{source}: no installed format has this ending; there are: {', '.join(endings())}"]
        )
    return found


def parameter_schema() -> dict[str, Any]:
    """Return the JSON Schema of files of parameters, with the unit and the meaning of every key."""
    root: dict[str, Any] = {"type": "object", "properties": {}}
    for row in schema():
        *tables, name = row.key.split(".")
        at = root
        for table in tables:
            at = at["properties"].setdefault(table, {"type": "object", "properties": {}})
            at.setdefault("properties", {})
        if name == "*":
            at["description"] = row.doc
        else:
            at["properties"].setdefault(name, {}).update(_key_schema(row.unit, row.doc))
            if row.default == "required":
                at.setdefault("required", []).append(name)
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
