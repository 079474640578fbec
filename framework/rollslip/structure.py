"""Makes attrs classes of raw tables: strict, with every fault noted and its place in the file.

- The attrs classes are the schema: `structure` follows their types and metadata. A conversion library is not needed for
  that, because every scalar has its own strict rule here: its unit is a property of the field and not of the type.
- Faults are collected, not raised one by one, and each names file, line and key.
- The hash of a scene is taken of its values in SI units, not of the text: comments, order and units do not change it,
  but what stands in files of models and forms does.
"""

import contextlib
import hashlib
import json
import math
import operator
import re
import types
from collections.abc import Collection, Mapping
from functools import cache
from numbers import Integral, Real
from pathlib import Path
from typing import Any, Final, TypeVar, Union, get_args, get_origin, get_type_hints

import attrs

from rollslip.errors import nearest
from rollslip.fields import FieldError
from rollslip.toml import DEEPEST, FrozenTable, KeyPath, split_key, thawed
from rollslip.units import UnitError, as_written, expectation, format_quantity, quantity, unit_given

__all__ = [
    "FrozenTable",
    "Location",
    "SceneHashes",
    "bare_key",
    "resolved",
    "scene_hash",
    "structure",
    "thawed",
    "types_of",
]

T = TypeVar("T")


@attrs.frozen
class Location:
    """A place in a scene, for messages: the path of a key, and the file and line that each path came from."""

    origins: Mapping[KeyPath, str]
    path: KeyPath = ()

    def at(self, key: str | int) -> "Location":
        """Return the place of a key, or of an element of a list, below this one."""
        return Location(self.origins, (*self.path, key))

    def message(self, reason: str) -> str:
        """Return a message about this place: ``scene.toml:8: lubricant.alhpa: unknown key``."""
        lengths = range(len(self.path), -1, -1)
        origin = next(
            (self.origins[self.path[:n]] for n in lengths if self.path[:n] in self.origins), None
        )
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


#: What is expected of a value of a plain type.
_EXPECTED: Final[Mapping[Any, str]] = {
    int: "a whole number is expected", str: "a text is expected", bool: "true or false is expected"
}  # fmt: skip


class _Missing:
    """Marks a value that could not be read; its fault is noted already."""


MISSING = _Missing()


def structure(
    cls: type[T],
    raw: object,
    where: Location | str,
    problems: list[str],
    known: Mapping[str, object] | None = None,
    own: str = "1",
) -> T | None:
    """Convert a raw table to an instance of an attrs class, strictly.

    A float field takes what `rollslip.units.quantity` takes, an int field whole numbers, a bool field true and false, a
    str field text; tuples take lists, attrs classes take tables. A field of a number or an attrs class takes either.
    Nothing else is converted.
    """
    if isinstance(where, str):
        where = Location({}, split_key(where) if where else ())
    bare, fields, by_key, rest = _layout(cls)  # type: ignore[arg-type]  # mypy takes a class for unhashable
    if isinstance(raw, str) and bare is not None:
        raw = {bare: raw}
    if not isinstance(raw, Mapping):
        problems.append(
            where.message(
                f"a table{' or a name' if bare else ''} is expected, not {as_written(raw)}"
            )
        )
        return None
    faults: list[str] = []
    values: dict[str, object] = {}
    others: dict[str, object] = {}
    kinds = types_of(cls)  # type: ignore[arg-type]  # mypy takes a class for unhashable
    advice: Mapping[str, str] = getattr(cls, "advice", {})
    for key, value in raw.items():
        attribute = by_key.get(key)
        if attribute is not None and known is not None and key in known:
            values[attribute.name] = known[key]
        elif attribute is not None:
            values[attribute.name] = _checked(
                kinds[attribute.name], value, attribute, where.at(key), faults, own
            )
            if values[attribute.name] is MISSING and key in advice:
                faults[-1] += f"; {advice[key]}"
        elif rest is not None:
            others[key] = value
        else:
            faults.append(where.at(key).message(advice.get(key) or _unknown(key, by_key)))
    if rest is not None:
        values[rest.name] = _frozen(others, where, faults)
    for key, attribute in by_key.items():
        if attribute.name not in values and attribute.default is attrs.NOTHING:
            faults.append(where.at(key).message(_required(kinds[attribute.name], attribute)))
    if not faults:
        try:
            return cls(**{fields[name].alias or name: value for name, value in values.items()})
        except FieldError as error:
            key = next((key for key, a in by_key.items() if a.name == error.field), error.field)
            faults.append(where.at(key).message(error.reason))
        except ValueError as error:
            faults.append(where.message(str(error)))
    problems += faults
    return None


@cache
def _layout(
    cls: "type[Any]",
) -> "tuple[str | None, dict[str, attrs.Attribute[Any]], dict[str, attrs.Attribute[Any]], attrs.Attribute[Any] | None]":
    """Return of a class the key of a bare name, its fields by name and by key, and the one that takes what is left."""
    fields = {a.name: a for a in attrs.fields(cls) if a.init}
    by_key = {key: a for key, a in fields_of(cls) if a.init and not a.metadata.get("rest")}
    return (
        bare_key(cls),
        fields,
        by_key,
        next((a for a in fields.values() if a.metadata.get("rest")), None),
    )


@cache
def types_of(cls: "type[Any]") -> dict[str, Any]:
    """Return the types of the fields of a class; working them out takes longer than reading a table by them."""
    return get_type_hints(cls)


def fields_of(cls: Any) -> "list[tuple[str, attrs.Attribute[Any]]]":
    """Return key and field of all fields of a class that have a key in a scene."""
    return [
        (key, a) for a in attrs.fields(cls) if (key := a.metadata.get("key", a.name)) is not None
    ]


def bare_key(cls: Any) -> str | None:
    """Return the key that a string in place of the table fills, if the class has one."""
    return next((key for key, attribute in fields_of(cls) if attribute.metadata.get("bare")), None)


def _unknown(key: str, known: Collection[str]) -> str:
    if alike := nearest(key, known, count=1):
        return f"unknown key, did you mean '{alike[0]}'?"
    return (
        f"unknown key; known are {', '.join(sorted(known))}"
        if known
        else "unknown key; there are none here"
    )


def _required(kind: object, attribute: "attrs.Attribute[Any]") -> str:
    doc = attribute.metadata.get("doc")
    unit = attribute.metadata.get("unit")
    what = f" ({doc})" if doc else ""
    expected = expectation(unit) if unit else _EXPECTED.get(kind, "")
    return f"missing, but required{what}" + (
        f"; {_such_as(expected, attribute)}" if expected else ""
    )


def _such_as(text: str, attribute: "attrs.Attribute[Any]") -> str:
    """Put a usual value of a field in place of the example of its unit, where that is none: no roughness of 15 mm."""
    unit = attribute.metadata.get("unit")
    (low, high) = attribute.metadata.get("usual") or (0.0, 0.0)
    example = re.search("such as '([^']+)'", text)
    if unit is None or example is None or not 0.0 < low < high < math.inf:
        return text
    with contextlib.suppress(UnitError):
        if not low <= quantity(example[1], unit) <= high:
            usual = format_quantity(float(f"{math.sqrt(low * high):.1g}"), unit)
            return text.replace(example[0], f"such as '{usual}'")
    return text


def _checked(
    kind: Any,
    raw: object,
    attribute: "attrs.Attribute[Any]",
    where: Location,
    faults: list[str],
    own: str,
) -> object:
    """Convert and validate one field on its own, so that the faults of the other fields are found as well."""
    keywords = attribute.metadata.get("keywords", {})
    if isinstance(raw, str) and raw in keywords:
        return keywords[raw]
    before = len(faults)
    unit = own if attribute.metadata.get("own_unit") else attribute.metadata.get("unit") or "1"
    value = _converted(kind, raw, unit, where, faults)
    faults[before:] = [_such_as(fault, attribute) for fault in faults[before:]]
    if keywords and isinstance(raw, str):
        faults[before:] = [
            f"{fault}; or write {' or '.join(map(repr, keywords))}" for fault in faults[before:]
        ]
    if value is not MISSING and attribute.validator is not None:
        try:
            attribute.validator(None, attribute, value)
        except FieldError as error:
            faults.append(where.message(_in_the_unit_given(attribute, raw, value) or error.reason))
        except (TypeError, ValueError) as error:
            faults.append(where.message(str(error.args[0] if error.args else error)))
    return value


def _in_the_unit_given(attribute: "attrs.Attribute[Any]", raw: object, value: object) -> str:
    """Say what a validator says of a value, in the unit in which it was written; nothing where there is none."""
    unit = attribute.metadata.get("unit")
    if (
        unit is None
        or isinstance(raw, bool)
        or not isinstance(raw, str | Real)
        or attribute.validator is None
    ):
        return ""
    told = attribute.evolve(metadata={**attribute.metadata, "given": unit_given(raw, unit)})
    try:
        attribute.validator(None, told, value)
    except FieldError as error:
        return error.reason
    return ""


def _converted(kind: Any, raw: object, unit: str, where: Location, faults: list[str]) -> object:
    """Return the value of a raw one, or `MISSING` after noting what is wrong with it."""
    origin, arguments, fields = _parts(kind)
    if origin in (Union, types.UnionType):
        if raw is None and types.NoneType in arguments:
            return None
        first, *others = (argument for argument in arguments if argument is not types.NoneType)
        if others and isinstance(raw, Mapping):
            first = next((kind for kind in others if attrs.has(kind)), first)
        return _converted(first, raw, unit, where, faults)
    if kind is FrozenTable:
        if isinstance(raw, Mapping):
            return _frozen(raw, where, faults)
    elif fields:
        value = structure(kind, raw, where, faults, own=unit)
        return MISSING if value is None else value
    elif kind in (Any, object):
        return _frozen(raw, where, faults)
    elif origin is Mapping:
        if isinstance(raw, Mapping):
            items = {
                key: _converted(arguments[1], value, unit, where.at(key), faults)
                for key, value in raw.items()
            }
            return MISSING if MISSING in items.values() else FrozenTable(items)
    elif origin is tuple:
        if isinstance(raw, str | Mapping) and attrs.has(arguments[0]) and bare_key(arguments[0]):
            raw = (raw,)  # of things that have names one may stand alone
        if isinstance(raw, list | tuple):
            return _list(arguments, raw, unit, where, faults)
    elif kind is float:
        try:
            return quantity(raw, unit)
        except UnitError as error:
            of = "the resultant of components, or " * (unit == "N")
            one = f"; give {of}one value: sweep takes several, --over {_dotted(where.path)}=A,B"
            faults.append(where.message(f"{error}{one * isinstance(raw, list | tuple)}"))
            return MISSING
    elif kind is int:
        raw = int(raw) if isinstance(raw, float) and raw.is_integer() else raw
        if isinstance(raw, Integral) and not isinstance(raw, bool) and _storable(raw):
            return int(raw)
    elif kind in (bool, str):
        if isinstance(raw, kind):
            return raw
    else:
        raise TypeError(
            f"{_dotted(where.path)}: a field of type {kind} cannot be read from a scene"
        )
    told = f"{_EXPECTED.get(kind, 'a table is expected')}, not {as_written(raw)}"
    if origin is tuple:
        told = f"a list is expected, not {as_written(raw)}; put it in [ ]"
    faults.append(where.message(told))
    return MISSING


@cache
def _parts(kind: Any) -> tuple[Any, tuple[Any, ...], bool]:
    """Return what a type is made from, of what, and whether it is an attrs class."""
    return get_origin(kind), get_args(kind), attrs.has(kind)


def _list(
    kinds: tuple[Any, ...],
    raw: list[object] | tuple[object, ...],
    unit: str,
    where: Location,
    faults: list[str],
) -> object:
    if kinds[-1] is Ellipsis:
        kinds = kinds[:1] * len(raw)
    if len(kinds) != len(raw):
        faults.append(
            where.message(f"a list of {len(kinds)} values is expected, not of {len(raw)}")
        )
        return MISSING
    each = enumerate(zip(kinds, raw, strict=True))
    values = tuple(
        _converted(kind, value, unit, where.at(index), faults) for index, (kind, value) in each
    )
    return MISSING if MISSING in values else values


def _frozen(raw: object, where: Location, faults: list[str]) -> object:
    """Keep a value as it is written, if it is of a kind that a scene may hold."""
    if len(where.path) > DEEPEST:
        faults.append(
            where.message(
                f"is nested too deeply, {DEEPEST} tables and lists within each other are the most"
            )
        )
        return MISSING
    if isinstance(raw, bool | str) or (type(raw) is float and math.isfinite(raw)):
        return raw
    if isinstance(raw, Mapping):
        table = {key: _frozen(value, where.at(key), faults) for key, value in raw.items()}
        return MISSING if MISSING in table.values() else FrozenTable(table)
    if isinstance(raw, list | tuple):
        values = tuple(_frozen(value, where.at(index), faults) for index, value in enumerate(raw))
        return MISSING if MISSING in values else values
    if isinstance(raw, Integral):
        if _storable(raw):
            return raw if isinstance(raw, int) else int(raw)
    elif isinstance(raw, Real) and math.isfinite(raw):
        return raw if isinstance(raw, float) else float(raw)
    faults.append(
        where.message(
            f"{as_written(raw)} cannot be used: a finite number, a text, a list or a table can"
        )
    )
    return MISSING


def _storable(number: Integral) -> bool:
    """Whether a whole number has the 64 bits that TOML asks for; what has more, no other program can read either."""
    return -(2**63) <= int(number) < 2**63


# And back ------------------------------------------------------------------------------------------------------------


def resolved(scene: Any) -> dict[str, object]:
    """Return a scene, or one of its tables, with all defaults as a nested dict of SI values.

    It reads as the same scene again. Optional values that are not set are left out, because TOML has no null.
    """
    table: dict[str, object] = {}
    for name, key, rest in _keys(type(scene)):  # type: ignore[arg-type]  # mypy takes a class for unhashable
        value = getattr(scene, name)
        if value is None:
            continue
        plain = _plain(value)
        if rest and isinstance(plain, dict):
            table.update(plain)
        else:
            table[key] = plain
    return table


@cache
def _keys(cls: Any) -> list[tuple[str, str, bool]]:
    """Name of every field that has a key in a scene, the key, and whether it takes the rest of the table."""
    return [(a.name, key, bool(a.metadata.get("rest"))) for key, a in fields_of(cls)]


def _plain(value: object) -> object:
    if isinstance(value, str | float | int):
        return value
    if isinstance(value, Mapping):
        return {key: _plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    return resolved(value) if attrs.has(type(value)) else value


@cache
def _sorted(cls: Any) -> list[tuple[str, str]]:
    """Fields and their keys, in the order of the keys."""
    return sorted(((name, key) for name, key, _ in _keys(cls)), key=operator.itemgetter(1))


#: The text of plain values that is hashed.
_canonical: Final = json.JSONEncoder(
    sort_keys=True, separators=(",", ":"), ensure_ascii=True
).encode


def _contents(plain: object) -> str:
    """Digests of files that a table names by their full paths, as models and forms do; history has its own."""
    if isinstance(plain, list):
        return "".join(map(_contents, plain))
    if not isinstance(plain, dict):
        return ""
    found = "".join(map(_contents, plain.values()))
    file = plain.get("file")
    if (
        isinstance(file, str)
        and "\0" not in file
        and (path := Path(file)).is_absolute()
        and path.is_file()
    ):
        with contextlib.suppress(OSError):  # who reads it says so
            found += hashlib.sha256(path.read_bytes()).hexdigest()
    return found


class SceneHashes:
    """Hashes of scenes that share tables with one of them, of which the text is made once."""

    def __init__(self, scene: Any) -> None:
        self._scene = scene
        self._known = dict[str, str]()

    def of(self, scene: Any) -> str:
        """Return the SHA-256 of a resolved scene with its files; equal scenes have equal hashes however written."""
        texts = []
        for name, key in _sorted(type(scene)):  # type: ignore[arg-type]
            if (value := getattr(scene, name)) is not None:
                own = value is getattr(self._scene, name)
                text = self._known.get(name) if own else None
                if text is None:
                    plain = _plain(value)
                    files = "" if name in scene.digested_elsewhere else _contents(plain)
                    text = f"{_canonical(key)}:{_canonical(plain)}{files}"
                if own:
                    self._known[name] = text
                texts.append(text)
        return hashlib.sha256(f"{{{','.join(texts)}}}".encode()).hexdigest()


def scene_hash(scene: Any) -> str:
    """Return the hash of one scene; see `SceneHashes`."""
    return SceneHashes(scene).of(scene)
