"""Reads scenes: from TOML to frozen checked values, with every fault of the file in one error.

Decisions:

- The attrs classes are the schema: `structure` follows their types and metadata. A conversion library is not needed for
  that, because every scalar has its own strict rule here: its unit is a property of the field and not of the type.
- Faults are collected, not raised one by one, and each names file, line and key. tomllib gives no line of a key, so a
  scanner notes them; it relies on tomllib having accepted the text.
- Where a value came from is kept in ``scene.origins``, so that tables which are read later (parameters of models,
  studies) and values changed by `evolve` are reported with the right place.
- Only the standard library and attrs are imported, the slower modules when an error needs them: a scene must be read
  before a terminal feels slow.
- A scene may name a bearing or surfaces that a plugin offers. They are looked up here, since a scene is complete and
  checked once it is read; only then is a plugin loaded.
"""

import contextlib
import math
import os
import re
import tomllib
import types
from collections.abc import Collection, Iterable, Iterator, Mapping
from functools import cache
from numbers import Integral, Real
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias, TypeVar, Union, get_args, get_origin, get_type_hints

import attrs

from rollslip.errors import PluginError, SceneError
from rollslip.fields import FieldError
from rollslip.scene.values import FrozenTable, Scene, resolved
from rollslip.units import UnitError, as_written, expectation, format_quantity, quantity

__all__ = [
    "SchemaRow",
    "Where",
    "evolve",
    "from_raw",
    "load_scene",
    "nearest",
    "parse_scene",
    "parse_set",
    "schema",
    "shipped_scenes",
    "structure",
]

T = TypeVar("T")
KeyPath: TypeAlias = tuple[str | int, ...]

_PART = r"""[A-Za-z0-9_-]+|"(?:[^"\\\n]|\\.)*"|'[^'\n]*'"""
_KEY = re.compile(rf"(?:{_PART})(?:[ \t]*\.[ \t]*(?:{_PART}))*")
_PARTS = re.compile(_PART)
_CHANGES = "changes"
_DEEPEST = 32  # tables and lists within each other; far more than any scene has, and far less than Python's stack


@attrs.frozen
class Where:
    """A place in a scene, for messages: the path of a key, and the file and line that each path came from."""

    origins: Mapping[KeyPath, str]
    path: KeyPath = ()

    def at(self, key: str | int) -> "Where":
        """Return the place of a key, or of an element of a list, below this one."""
        return Where(self.origins, (*self.path, key))

    def says(self, reason: str) -> str:
        """Return a message about this place: ``scene.toml:8: lubricant.alhpa: unknown key``."""
        lengths = range(len(self.path), -1, -1)
        origin = next((self.origins[self.path[:n]] for n in lengths if self.path[:n] in self.origins), None)
        return ": ".join(part for part in (origin, _dotted(self.path), reason) if part)


def _dotted(path: KeyPath) -> str:
    text = ""
    for part in path:
        if isinstance(part, int):
            text += f"[{part}]"
        else:
            plain = re.fullmatch(r"[\w-]{1,80}", part, re.ASCII) is not None
            text += ("." if text else "") + (part if plain else as_written(part))
    return text


def nearest(word: str, known: Iterable[str], count: int = 3, cutoff: float = 0.6) -> list[str]:
    """Return the known words that look most like `word`, the most similar first."""
    import difflib  # only wrong input needs it

    return difflib.get_close_matches(word, sorted(known), n=count, cutoff=cutoff)


# Conversion ---------------------------------------------------------------------------------------------------------


class _Missing:
    """Marks a value that could not be read; its fault is noted already."""


_MISSING = _Missing()


def structure(
    cls: type[T], raw: object, where: Where | str, problems: list[str], known: Mapping[str, object] | None = None
) -> T | None:
    """Convert a raw table to an instance of an attrs class, strictly.

    A float field takes what `rollslip.units.quantity` takes, an int field whole numbers, a bool field true and false, a
    str field text; tuples take lists, attrs classes take tables. Nothing else is converted.

    Parameters
    ----------
    cls
        attrs class with fields declared by `rollslip.fields.field` or `parameter`.
    raw
        The table, as `tomllib` gives it.
    where
        Place of the table; a plain key if nothing is known about the file.
    problems
        Takes one sentence for every fault found.
    known
        Values of keys of the table that are read already.

    Returns
    -------
    The instance, or None if anything in the table is wrong.
    """
    if isinstance(where, str):
        where = Where({}, tuple(_split_key(where)) if where else ())
    bare = _bare_key(cls)
    fields = {a.name: a for a in _attributes(cls) if a.init}
    by_key = {key: a for a in fields.values() if not a.metadata.get("rest") and (key := _key(a)) is not None}
    rest = next((a for a in fields.values() if a.metadata.get("rest")), None)
    if isinstance(raw, str) and bare is not None:
        raw = {bare: raw}
    if not isinstance(raw, Mapping):
        problems.append(where.says(f"a table{' or a name' if bare else ''} is expected, not {as_written(raw)}"))
        return None
    faults: list[str] = []
    values: dict[str, object] = {}
    others: dict[str, object] = {}
    kinds = _hints(cls)  # type: ignore[arg-type]  # mypy takes a class for unhashable
    for key, value in raw.items():
        attribute = by_key.get(key)
        if attribute is not None and known is not None and key in known:
            values[attribute.name] = known[key]
        elif attribute is not None:
            values[attribute.name] = _checked(kinds[attribute.name], value, attribute, where.at(key), faults)
        elif rest is not None:
            others[key] = value
        else:
            faults.append(where.at(key).says(_unknown(key, by_key)))
    if rest is not None:
        values[rest.name] = _frozen(others, where, faults)
    for key, attribute in by_key.items():
        if attribute.name not in values and attribute.default is attrs.NOTHING:
            faults.append(where.at(key).says(_required(kinds[attribute.name], attribute)))
    if not faults:
        try:
            return cls(**{fields[name].alias or name: value for name, value in values.items()})
        except FieldError as error:
            key = next((key for key, a in by_key.items() if a.name == error.field), error.field)
            faults.append(where.at(key).says(error.reason))
        except ValueError as error:
            faults.append(where.says(str(error)))
    problems += faults
    return None


def _attributes(cls: Any) -> "tuple[attrs.Attribute[Any], ...]":
    attributes: tuple[attrs.Attribute[Any], ...] = attrs.fields(cls)
    return attributes


@cache
def _hints(cls: "type[Any]") -> dict[str, Any]:
    """Types of the fields of a class; working them out takes longer than reading a table by them."""
    return get_type_hints(cls)


def _key(attribute: "attrs.Attribute[Any]") -> str | None:
    """Name of a field's key in the scene; None if it has none."""
    key: str | None = attribute.metadata.get("key", attribute.name)
    return key


def _bare_key(cls: Any) -> str | None:
    """Key that a string in place of the table fills, if the class has one."""
    return next((_key(a) for a in _attributes(cls) if a.metadata.get("bare")), None)


def _unknown(key: str, known: Collection[str]) -> str:
    if alike := nearest(key, known, count=1):
        return f"unknown key, did you mean '{alike[0]}'?"
    return f"unknown key; known are {', '.join(sorted(known))}" if known else "unknown key; there are none here"


def _required(kind: object, attribute: "attrs.Attribute[Any]") -> str:
    doc, unit = attribute.metadata.get("doc"), attribute.metadata.get("unit")
    what = f" ({doc})" if doc else ""
    kinds = {int: "a whole number is expected", str: "a text is expected", bool: "true or false is expected"}
    expected = expectation(unit) if unit else kinds.get(kind, "")  # type: ignore[call-overload]
    return f"missing, but required{what}" + (f"; {expected}" if expected else "")


def _checked(kind: Any, raw: object, attribute: "attrs.Attribute[Any]", where: Where, faults: list[str]) -> object:
    """Convert and validate one field on its own, so that the faults of the other fields are found as well."""
    words = attribute.metadata.get("words", {})
    if isinstance(raw, str) and raw in words:
        return words[raw]
    before = len(faults)
    value = _converted(kind, raw, attribute.metadata.get("unit") or "1", where, faults)
    if words and isinstance(raw, str):
        faults[before:] = [f"{fault}; or write {' or '.join(map(repr, words))}" for fault in faults[before:]]
    if value is not _MISSING and attribute.validator is not None:
        try:
            attribute.validator(None, attribute, value)
        except FieldError as error:
            faults.append(where.says(error.reason))
        except (TypeError, ValueError) as error:
            faults.append(where.says(str(error.args[0] if error.args else error)))
    return value


def _converted(kind: Any, raw: object, unit: str, where: Where, faults: list[str]) -> object:
    """Return the value of a raw one, or `_MISSING` after noting what is wrong with it."""
    origin, arguments = get_origin(kind), get_args(kind)
    if origin in (Union, types.UnionType) and len(arguments) == 2 and types.NoneType in arguments:
        if raw is None:
            return None
        kind = next(argument for argument in arguments if argument is not types.NoneType)
        return _converted(kind, raw, unit, where, faults)
    if kind is FrozenTable:
        if isinstance(raw, Mapping):
            return _frozen(raw, where, faults)
        expected = "a table"
    elif attrs.has(kind):
        value = structure(kind, raw, where, faults)
        return _MISSING if value is None else value
    elif kind in (Any, object):
        return _frozen(raw, where, faults)
    elif origin is Mapping:
        if isinstance(raw, Mapping):
            items = {key: _converted(arguments[1], value, unit, where.at(key), faults) for key, value in raw.items()}
            return _MISSING if _MISSING in items.values() else FrozenTable(items)
        expected = "a table"
    elif origin is tuple:
        if isinstance(raw, list | tuple):
            return _list(arguments, raw, unit, where, faults)
        expected = "a list"
    elif kind is float:
        try:
            return quantity(raw, unit)
        except UnitError as error:
            faults.append(where.says(str(error)))
            return _MISSING
    elif kind is int:
        if isinstance(raw, Integral) and not isinstance(raw, bool) and _storable(raw):
            return int(raw)
        expected = "a whole number"
    elif kind is bool:
        if isinstance(raw, bool):
            return raw
        expected = "true or false"
    elif kind is str:
        if isinstance(raw, str):
            return raw
        expected = "a text"
    else:
        raise TypeError(f"{_dotted(where.path)}: a field of type {kind} cannot be read from a scene")
    faults.append(where.says(f"{expected} is expected, not {as_written(raw)}"))
    return _MISSING


def _list(
    kinds: tuple[Any, ...], raw: list[object] | tuple[object, ...], unit: str, where: Where, faults: list[str]
) -> object:
    if kinds[-1] is Ellipsis:
        kinds = kinds[:1] * len(raw)
    if len(kinds) != len(raw):
        faults.append(where.says(f"a list of {len(kinds)} values is expected, not of {len(raw)}"))
        return _MISSING
    each = enumerate(zip(kinds, raw, strict=True))
    values = tuple(_converted(kind, value, unit, where.at(index), faults) for index, (kind, value) in each)
    return _MISSING if _MISSING in values else values


def _frozen(raw: object, where: Where, faults: list[str]) -> object:
    """Keep a value as it is written, if it is of a kind that a scene may hold."""
    if len(where.path) > _DEEPEST:
        faults.append(where.says(f"is nested too deeply, {_DEEPEST} tables and lists within each other are the most"))
        return _MISSING
    if isinstance(raw, bool | str):
        return raw
    if isinstance(raw, Mapping):
        table = {key: _frozen(value, where.at(key), faults) for key, value in raw.items()}
        return _MISSING if _MISSING in table.values() else FrozenTable(table)
    if isinstance(raw, list | tuple):
        values = tuple(_frozen(value, where.at(index), faults) for index, value in enumerate(raw))
        return _MISSING if _MISSING in values else values
    if isinstance(raw, Integral):
        if _storable(raw):
            return int(raw)
    elif isinstance(raw, Real) and math.isfinite(raw):
        return float(raw)
    faults.append(where.says(f"{as_written(raw)} cannot be used: a finite number, a text, a list or a table can"))
    return _MISSING


def _storable(number: Integral) -> bool:
    """Whether a whole number has the 64 bits that TOML asks for; what has more, no other program can read either."""
    return -(2**63) <= int(number) < 2**63


# Reading ------------------------------------------------------------------------------------------------------------


def shipped_scenes() -> list[str]:
    """Return the names of the scenes that come with the package."""
    return sorted(_shipped())


def _shipped() -> dict[str, Any]:
    from importlib.resources import files  # costs 20 ms, and a path given by the user does not need it

    entries = (files("rollslip") / "scenes").iterdir()
    return {entry.name.removesuffix(".toml"): entry for entry in entries if entry.name.endswith(".toml")}


def load_scene(name_or_path: str | os.PathLike[str]) -> Scene:
    """Read a scene that comes with the package, or one of the user's files.

    Parameters
    ----------
    name_or_path
        Name of a shipped scene ("1032930-70C"), or a path: a string that ends in ".toml" or that exists.

    Raises
    ------
    SceneError
        With every fault of the scene, each with file, line and key.
    PluginError
        If a bearing or surface that it names is not there.
    """
    source = os.fspath(name_or_path)
    path = Path(source)
    if isinstance(name_or_path, str) and not source.endswith(".toml"):
        shipped = _shipped()
        if source in shipped:
            return parse_scene(decoded(shipped[source].read_bytes(), source), source)
        if not source or not path.exists():
            alike = ", ".join(nearest(source, shipped, cutoff=0.0)) or "none"
            raise SceneError(
                [f"{source!r}: no scene of this name is shipped; nearest: {alike} (a file's name ends in .toml)"]
            )
    try:
        content = path.read_bytes()
    except FileNotFoundError:
        raise SceneError([f"{source}: there is no such file"]) from None
    except IsADirectoryError:
        raise SceneError([f"{source}: is a directory; a scene is a .toml file"]) from None
    except (OSError, ValueError) as error:  # ValueError: a null byte in the path
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise SceneError([f"{source}: cannot be read: {reason}"]) from None
    return parse_scene(decoded(content, source), source)


def decoded(content: bytes, source: str) -> str:
    """Return the text of a file in UTF-8; ``source`` is its name in messages."""
    try:
        return content.decode("utf-8-sig")  # some editors put a mark at the start
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise SceneError([f"{source}:{line}: not UTF-8 text; save the file in the encoding UTF-8"]) from None


def parse_scene(text: str, source: str) -> Scene:
    """Read a scene from TOML text.

    Parameters
    ----------
    text
        The content of a scene file.
    source
        Its name in messages.

    Raises
    ------
    SceneError
        With every fault of the scene, each with source, line and key.
    PluginError
        If a bearing or surface that it names is not there.
    """
    try:
        raw = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise SceneError([syntax_error(error, text, source)]) from None
    origins: dict[KeyPath, str] = {path: f"{source}:{line}" for path, line in key_lines(text).items()}
    origins[()] = source
    return _scene(raw, origins, source, text)


def from_raw(raw: Mapping[str, object], source: str, text: str = "") -> Scene:
    """Return the scene of a raw table, such as ``scene.raw`` of another one, checked anew.

    Raises
    ------
    SceneError
        With every fault of the table.
    PluginError
        If a bearing or surface that it names is not there.
    """
    return _scene(_thawed(raw), {(): source}, source, text)


def _scene(
    raw: dict[str, object],
    origins: dict[KeyPath, str],
    source: str,
    text: str,
    known: Mapping[str, object] | None = None,
) -> Scene:
    problems: list[str] = []
    complete = _with_named_data(raw, Where(origins), problems)
    scene = structure(Scene, complete, Where(origins), problems, known)
    if scene is None or problems:
        raise SceneError(problems)
    return attrs.evolve(scene, source=source, text=text, raw=FrozenTable(raw), origins=origins)


#: Tables that may start from the values of a named set that a plugin offers; they are of the kind of that name.
_NAMED = ("bearing", "surface")


def _with_named_data(raw: dict[str, object], where: Where, problems: list[str]) -> dict[str, object]:
    """Return a raw scene with the values of the data that its tables name; the name itself is no value of a scene."""
    complete = dict(raw)
    for kind in _NAMED:
        table, at = raw.get(kind), where.at(kind).at("name")
        if not isinstance(table, Mapping) or "name" not in table:
            continue
        own = {key: value for key, value in table.items() if key != "name"}
        complete[kind] = own
        name = _converted(str, table["name"], "1", at, problems)
        if isinstance(name, str):
            from rollslip.catalogue.discovery import get_class  # only a scene that names data needs a plugin

            try:
                complete[kind] = _filled(own, get_class(kind, name).data)
            except PluginError as error:
                raise PluginError(at.says(str(error))) from error
            if complete[kind] == own:  # as when a name is set in a scene that spells all values out
                problems.append(at.says(f"{name!r} gives nothing, every value is written out; leave out what it gives"))
    return complete


def _filled(table: Mapping[str, object], data: Any) -> dict[str, object]:
    """Fill what a table leaves out with given values, but for those that follow from others and follow on."""
    filled = dict(table)
    for attribute in _attributes(type(data)):
        key, value = _key(attribute), getattr(data, attribute.name)
        if key is None:
            continue
        inner = attrs.has(type(value))
        if key not in filled:
            default: Any = attribute.default
            follows = isinstance(default, attrs.Factory) and default.takes_self and default.factory(data) == value  # type: ignore[arg-type]
            if value is not None and not follows:
                filled[key] = resolved(value) if inner else value
        elif inner and _bare_key(type(value)) is None and isinstance(below := filled[key], Mapping):
            filled[key] = _filled(below, value)  # a table that may be a bare name is a choice, and taken whole
    return filled


_UNQUOTED = re.compile(r"=\s*[+-]?[\d.]+(?:,|\s*(?![eE][+-]?\d|[xob_])[A-Za-z%/])")


def syntax_error(error: Exception, text: str, source: str) -> str:
    """Say where the text is not TOML; tomllib gives the place in words only."""
    if not isinstance(error, tomllib.TOMLDecodeError):  # endless digits or brackets
        return f"{source}: not valid TOML: {error}"
    message, _, place = str(error).rpartition(" (at ")
    message = message if len(message) <= 200 else message[:197] + "..."  # it may spell a whole key out
    found = re.fullmatch(r"line (\d+), column (\d+)\)", place)
    line = int(found[1]) if found else text.count("\n") + 1
    column = f" (column {found[2]})" if found else " (at the end of the file)"
    unquoted = _UNQUOTED.search(text.split("\n")[line - 1])
    hint = '; write a number as 1.5, and one with a unit in quotes, as "15 mm"' if unquoted else ""
    return f"{source}:{line}: not valid TOML: {message}{column}{hint}"


_VALUE_TOKEN = re.compile(
    r'"""(?:\\.|[^\\])*?"{3,5}'
    r"|'''.*?'{3,5}"
    r'|"(?:\\.|[^"\\\n])*"'
    r"|'[^'\n]*'"
    r"|#[^\n]*"
    r"|[\[\]{}\n]"
    r"|[^\"'#\[\]{}\n]+",
    re.DOTALL,
)
_BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")


def key_lines(text: str) -> dict[KeyPath, int]:
    """Map each key of a valid TOML document to its line; keys inside a value count with the key that holds them."""
    lines: dict[KeyPath, int] = {}
    tables: dict[KeyPath, int] = {}  # how many elements each array of tables has so far
    table: KeyPath = ()
    position, line = 0, 1

    def skip_to(target: int) -> None:
        nonlocal position, line
        line += text.count("\n", position, target)
        position = target

    def note(start: KeyPath, parts: list[str]) -> KeyPath:
        """Note the line of a dotted key and, where they are new, of the tables that it opens."""
        path = start
        for number, part in enumerate(parts[:_DEEPEST], 1):  # a deeper key is refused later
            path = (*path, part)
            lines.setdefault(path, line)
            if path in tables and number < len(parts):
                path = (*path, tables[path] - 1)
        return path

    skip_to(_blank_end(text, 0))
    while position < len(text):
        brackets = 2 if text.startswith("[[", position) else int(text.startswith("[", position))
        key = _KEY.search(text, position)
        assert key is not None
        parts = _split_key(key[0])
        if brackets:
            table = note((), parts)
            if brackets == 2:
                tables[table] = tables.get(table, 0) + 1
                table = (*table, tables[table] - 1)
            elif table in tables:
                table = (*table, tables[table] - 1)
            lines[table] = line
            skip_to(text.index("]", key.end()) + brackets)
        else:
            note(table, parts)
            skip_to(_value_end(text, text.index("=", key.end()) + 1))
        skip_to(_blank_end(text, position))
    return lines


def _blank_end(text: str, start: int) -> int:
    blank = _BLANK.match(text, start)
    assert blank is not None
    return blank.end()


def _value_end(text: str, start: int) -> int:
    depth = 0
    for token in _VALUE_TOKEN.finditer(text, start):
        if token[0] in ("[", "{"):
            depth += 1
        elif token[0] in ("]", "}"):
            depth -= 1
        elif token[0] == "\n" and depth == 0:
            return token.start()
    return len(text)


def _split_key(text: str) -> list[str]:
    """Parts of a dotted key, without quotes and escapes."""
    if _KEY.fullmatch(text) is not None:
        with contextlib.suppress(tomllib.TOMLDecodeError):  # an escape that TOML does not have
            parts = _PARTS.findall(text)
            return [str(tomllib.loads(f"k={part}")["k"]) if part[0] in "\"'" else part for part in parts]
    raise ValueError("is not a key, such as 'operation.radial_load'")


# Changing -----------------------------------------------------------------------------------------------------------


def evolve(scene: Scene, changes: Mapping[str, object]) -> Scene:
    """Return a scene with some values changed; the tables that they stand in are checked anew, as is the whole.

    Parameters
    ----------
    scene
        The scene to start from; it stays as it is.
    changes
        New values by dotted key: ``{"lubricant.eyring_stress": "4 MPa", "models.film": "dowson-1968"}``. Values are
        what a scene may hold. A table that is not in the scene yet starts from its defaults.

    Returns
    -------
    Scene
        With the `source` and the `text` of the one it started from.

    Raises
    ------
    SceneError
        With every fault, those of the new values marked with "changes" in place of file and line.
    PluginError
        If a bearing or surface that it names is not there.
    """
    raw: dict[str, Any] = dict(resolved(scene) if scene.raw is None else scene.raw)
    origins = dict(scene.origins)
    problems, changed = [], set[str]()
    for key, value in changes.items():
        try:
            path = tuple(_split_key(key.strip()))
            if path[0] not in changed and path[0] in raw:
                raw[path[0]] = _thawed(raw[path[0]])
            changed.add(path[0])
            _set(raw, path, _thawed(value))
        except (ValueError, RecursionError) as error:
            reason = "is nested too deeply" if isinstance(error, RecursionError) else str(error)
            problems.append(f"{_CHANGES}: {as_written(key)} {reason}")
            continue
        for below in [known for known in origins if known[: len(path)] == path]:
            del origins[below]
        for opened in range(1, min(len(path), _DEEPEST)):
            origins.setdefault(path[:opened], _CHANGES)
        origins[path] = _CHANGES
    if problems:
        raise SceneError(problems)
    kept = {key: getattr(scene, key) for key in raw.keys() - changed}
    return _scene(raw, origins, scene.source, scene.text, kept)


def _set(table: dict[Any, Any], path: tuple[str, ...], value: object) -> None:
    """Set a value deep in a raw scene; a table that is left out or a bare name is written out on the way."""
    kind: Any = Scene
    for part in path[:-1]:
        attribute = next((a for a in _attributes(kind) if _key(a) == part), None) if attrs.has(kind) else None
        kind = _hints(kind)[attribute.name] if attribute is not None else None
        below = table.get(part)
        if not isinstance(below, dict):
            bare = _bare_key(kind) if attrs.has(kind) else None
            if isinstance(below, str) and bare is not None:
                below = {bare: below}
            elif below is not None:
                raise ValueError(f"leads nowhere: {part!r} is not a table")
            else:
                default = attribute.default if attribute is not None else None
                choice = attrs.has(type(default)) and _bare_key(type(default)) is not None
                below = resolved(default) if choice else {}  # of other tables, defaults come when they are read
            table[part] = below
        table = below
    table[path[-1]] = value


def _thawed(value: object) -> Any:
    """Return a copy of tables and lists that can be changed."""
    if isinstance(value, Mapping):
        return {str(key): _thawed(inner) for key, inner in value.items()}
    return [_thawed(inner) for inner in value] if isinstance(value, list | tuple) else value


def parse_set(text: str) -> tuple[str, object]:
    """Split ``key=value`` of the command line into key and value.

    The value is read as TOML where it is a number, true, false, a list, a table or a quoted text; anything else is a
    text as it stands, so that ``operation.radial_load=500 N`` and ``models.film=moes`` need no quotes.

    Examples
    --------
    >>> parse_set("operation.radial_load=500 N"), parse_set("accuracy.slices=21")
    (('operation.radial_load', '500 N'), ('accuracy.slices', 21))
    """
    key, equals, value = text.partition("=")
    if not equals or not key.strip():
        raise SceneError([f"{as_written(text)}: write KEY=VALUE, such as operation.radial_load='500 N'"])
    key, value = key.strip(), value.strip()
    try:
        parsed = tomllib.loads(f"value = {value}")
    except (ValueError, RecursionError):
        return key, value
    plain = parsed.keys() == {"value"} and isinstance(parsed["value"], bool | int | float | str | list | dict)
    return key, parsed["value"] if plain else value


# Schema -------------------------------------------------------------------------------------------------------------


class SchemaRow(NamedTuple):
    """One key that a scene may have: its unit, its default as text ("required" if there is none) and its meaning."""

    key: str
    unit: str
    default: str
    doc: str


def schema() -> list[SchemaRow]:
    """Return all keys of a scene, in the order of the documentation."""
    return list(_rows(Scene, ""))


def _rows(cls: type, prefix: str) -> Iterator[SchemaRow]:
    kinds = _hints(cls)
    for attribute in _attributes(cls):
        name = _key(attribute)
        if name is None:
            continue
        kind, metadata = kinds[attribute.name], attribute.metadata
        free = metadata.get("rest") or FrozenTable in (kind, *get_args(kind))
        key = prefix + ("*" if metadata.get("rest") else f"{name}.*" if free else name)
        if attrs.has(kind):
            if _bare_key(kind) is not None:
                yield SchemaRow(key, "", shown_default(attribute), metadata["doc"])
            if key in _NAMED:
                yield SchemaRow(
                    f"{key}.name", "", "", f"a {key} that a plugin offers, whose values the other keys change"
                )
            yield from _rows(kind, f"{key}.")
        else:
            yield SchemaRow(key, metadata["unit"] or "", shown_default(attribute), metadata["doc"])


def shown_default(attribute: "attrs.Attribute[Any]") -> str:
    """Return the default of a field as people read it: with unit, "required" or "derived"."""
    default, unit = attribute.default, attribute.metadata.get("unit")
    if default is attrs.NOTHING:
        return "required"
    if isinstance(default, attrs.Factory):  # type: ignore[arg-type]
        return "derived"
    if attrs.has(type(default)):
        bare = (a.name for a in _attributes(type(default)) if a.metadata.get("bare"))
        return str(getattr(default, next(bare)))
    if isinstance(default, float) and unit:
        return format_quantity(default, unit)
    return "" if default is None or default == () or default == FrozenTable() else str(default)
