"""Read TOML with the line of every key, so that messages can name it, and store tables read-only.

tomllib does not return the lines of keys. A scanner finds them in a text that tomllib has accepted.
"""

import contextlib
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from decimal import Decimal
from functools import lru_cache
from typing import Any, Final, TypeAlias

from rollslip.errors import SceneError

__all__ = [
    "DEEPEST",
    "FrozenTable",
    "KeyPath",
    "as_list",
    "as_table",
    "has_null",
    "key_lines",
    "loads",
    "parse",
    "split_key",
    "thawed",
]

KeyPath: TypeAlias = tuple[str | int, ...]

#: Largest depth of nested tables and lists. Doubling it changes nothing for scenes, which have less than ten; it has to
#: be far below the depth of Python's stack.
DEEPEST: Final = 32

_PART = r"""[A-Za-z0-9_-]+|"(?:[^"\\\n]|\\.)*"|'[^'\n]*'"""
_KEY = re.compile(rf"(?:{_PART})(?:[ \t]*\.[ \t]*(?:{_PART}))*")
_PARTS = re.compile(_PART)
#: A key of 1000 parts or more, for which tomllib would take minutes: its time is quadratic in the number of parts.
_ENDLESS = re.compile(rf"(?<![A-Za-z0-9_.-])(?<!\. )(?:(?:{_PART})[ \t]*\.[ \t]*){{1000}}")


class FrozenTable(Mapping[str, object]):
    """A read-only, hashable table of values as they are written; inner tables and lists are frozen too."""

    __slots__ = ("_data",)

    def __init__(self, data: Mapping[str, object] | None = None) -> None:
        self._data = {key: _freeze(value) for key, value in (data or {}).items()}

    def __getitem__(self, key: str) -> object:
        return self._data[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._data)

    def __len__(self) -> int:
        return len(self._data)

    def __hash__(self) -> int:
        return hash(frozenset(self._data.items()))

    def __repr__(self) -> str:
        return f"FrozenTable({self._data!r})"


def _freeze(value: object) -> object:
    if isinstance(value, str | float | int | FrozenTable):  # before the slow check for a Mapping
        return value
    if isinstance(value, Mapping):
        return FrozenTable(value)
    return tuple(map(_freeze, value)) if isinstance(value, list | tuple) else value


def thawed(value: object) -> Any:
    """Return a copy of tables and lists that can be changed; arrays and ranges of numbers become lists.

    The values of an xarray array with a unit become texts with that unit.
    """
    if isinstance(value, str | float | int):
        return value
    if isinstance(value, Mapping):
        return {str(key): thawed(inner) for key, inner in value.items()}
    if isinstance(value, Decimal):
        return float(value)
    if (array := getattr(value, "to_numpy", lambda: value)()) is not None and hasattr(
        array, "tolist"
    ):
        plain = array.tolist()
        if not (unit := getattr(value, "attrs", {}).get("units")):
            return plain
        return [f"{x!r} {unit}" for x in plain] if isinstance(plain, list) else f"{plain!r} {unit}"
    return list(map(thawed, value)) if isinstance(value, list | tuple | range) else value


def as_table(raw: object) -> Mapping[str, Any]:
    """Return a table as it is; an empty one in place of what is none."""
    return raw if isinstance(raw, Mapping) else {}


def as_list(raw: Any) -> Sequence[Any]:
    """Return a list as it is; one of a single item in place of what is none."""
    return raw if isinstance(raw, list | tuple) else [raw]


def loads(text: str) -> dict[str, Any]:
    """Return a document as tomllib does, but refuse keys for which tomllib would take minutes."""
    if text.count(".") >= 1000 and (endless := _ENDLESS.search(text)):
        line = text.count("\n", 0, endless.start()) + 1
        raise tomllib.TOMLDecodeError(f"a key has more than 1000 parts (at line {line}, column 1)")
    document = tomllib.loads(text)
    if "0000" in text and has_null(document):
        line = text.count("\n", 0, text.index("0000")) + 1
        raise tomllib.TOMLDecodeError(f"a text has the character U+0000 (at line {line}, column 1)")
    return document


def has_null(value: object) -> bool:
    """Return whether a text in a value, a table or a list has the character U+0000, which no file can hold."""
    if isinstance(value, Mapping):
        return any(map(has_null, (*value, *value.values())))
    return (
        "\0" in value
        if isinstance(value, str)
        else isinstance(value, list) and any(map(has_null, value))
    )


def parse(text: str, source: str) -> tuple[dict[str, Any], dict[KeyPath, str]]:
    """Return a document as nested tables, and file and line of each of its keys.

    Parameters
    ----------
    text : str
        The text of the file.
    source : str
        Name of the file, for messages.

    Raises
    ------
    SceneError
        If the text is not TOML; the message names the line and often the remedy.
    """
    try:
        raw = loads(text)
    except (ValueError, RecursionError) as error:
        raise SceneError([_syntax_error(error, text, source)]) from None
    origins: dict[KeyPath, str] = {
        path: f"{source}:{line}" for path, line in key_lines(text).items()
    }
    origins[()] = source
    return raw, origins


_UNQUOTED = re.compile(r"=\s*[+-]?[\d.]+(?:,|\s*(?![eE][+-]?\d|[xob_])[A-Za-z%/])")
_BARE_TEXT = re.compile(r"=\s*[A-Za-z]")
#: Quotes of word processors and of keyboards of other languages.
_TYPOGRAPHIC = re.compile("[\u2018-\u201f\u00ab\u00bb\u2032\u2033]")


def _syntax_error(error: Exception, text: str, source: str) -> str:
    """Return the message on a text that is not TOML; tomllib states the position as text."""
    if not isinstance(error, tomllib.TOMLDecodeError):  # too many digits or brackets
        return f"{source}: not valid TOML: {error}"
    message, _, where = str(error).rpartition(" (at ")
    if len(message) > 200:  # it may contain a whole key
        message = message[:197] + "..."
    position = re.fullmatch(r"line (\d+), column (\d+)\)", where)
    line = int(position[1]) if position else text.count("\n") + 1
    column = f" (column {position[2]})" if position else " (at the end of the file)"
    written = text.split("\n")[line - 1]
    unquoted = _UNQUOTED.search(written)
    hint = '; write a number as 1.5, and one with a unit in quotes, as "15 mm"' if unquoted else ""
    if found := _TYPOGRAPHIC.search(written):
        hint = f'; {found[0]} is a typographic quote, write " instead'
    elif "Unescaped '\\'" in message or "hex value" in message:
        hint = "; write a path in single quotes, as 'C:\\data\\rig.csv', or with /"
    elif message == "Invalid value" and _BARE_TEXT.search(written):
        hint = '; write a text in quotes, as "moes"'
    elif "'\\n'" in message:
        hint = "; a quote is missing at the end of the line"
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
    """Return the line of each key of a valid TOML document, except keys inside values."""
    lines: dict[KeyPath, int] = {}
    tables: dict[KeyPath, int] = {}  # number of elements so far of each array of tables
    table: KeyPath = ()
    position = 0
    line = 1

    def skip_to(target: int) -> None:
        nonlocal position, line
        line += text.count("\n", position, target)
        position = target

    def note(start: KeyPath, parts: tuple[str, ...]) -> KeyPath:
        """Record the line of a dotted key, and of new tables that it opens."""
        path = start
        for number, part in enumerate(parts[:DEEPEST], 1):  # a deeper key is refused later
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
        parts = split_key(key[0])
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
    """Return the end of blanks and comments."""
    blank = _BLANK.match(text, start)
    assert blank is not None
    return blank.end()


def _value_end(text: str, start: int) -> int:
    """Return the end of a value: the end of its line, outside brackets and quotes."""
    depth = 0
    for token in _VALUE_TOKEN.finditer(text, start):
        if token[0] in ("[", "{"):
            depth += 1
        elif token[0] in ("]", "}"):
            depth -= 1
        elif token[0] == "\n" and depth == 0:
            return token.start()
    return len(text)


@lru_cache
def split_key(text: str) -> tuple[str, ...]:
    """Return the parts of a dotted key, without quotes and escapes."""
    if _KEY.fullmatch(text) is not None:
        with contextlib.suppress(tomllib.TOMLDecodeError):  # an escape that TOML does not have
            parts = _PARTS.findall(text)
            return tuple(
                str(tomllib.loads(f"k={part}")["k"]) if part[0] in "\"'" else part for part in parts
            )
    raise ValueError("is not a key, such as 'operation.radial_load'")
