"""Convert raw tables to attrs classes strictly, and collect every fault with its location in the file.

- The attrs classes are the schema: `structure` follows their types and metadata. A conversion library would not help,
  because the unit of a number is a property of the field and not of the type.
- Faults are collected and not raised one by one; each names file, line and key.
- The hash of a scene is computed from its values in SI units and not from its text: comments, order and units do not
  change it, but the content of files that models and forms name does.
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

from rollslip.errors import SceneError, nearest
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
    """A location in a scene, for messages: the path of a key, and file and line of each path."""

    origins: Mapping[KeyPath, str]
    path: KeyPath = ()

    def at(self, key: str | int) -> "Location":
        """Return the location of a key, or of an element of a list, below this one."""
        return Location(self.origins, (*self.path, key))

    def message(self, reason: str) -> str:
        """Return a message on this location: ``scene.toml:8: lubricant.alhpa: unknown key``."""
        lengths = range(len(self.path), -1, -1)
        origin = next(
            (self.origins[self.path[:n]] for n in lengths if self.path[:n] in self.origins), None
        )
        return ": ".join(part for part in (origin, _dotted(self.path), reason) if part)


def raise_problems(problems: list[str]) -> None:
    """Raise one `SceneError` with all problems, if there are any."""
    if problems:
        raise SceneError(problems)


def raise_problem_if(condition: object, problem: str) -> None:
    """Raise a `SceneError` with one `problem` where a `condition` holds."""
    if condition:
        raise SceneError([problem])


def _dotted(path: KeyPath) -> str:
    text = ""
    for part in path:
        if isinstance(part, int):
            text += f"[{part}]"
        else:
            plain = re.fullmatch(r"[\w-]{1,80}", part, re.ASCII) is not None
            text += ("." if text else "") + (part if plain else as_written(part))
    return text


#: Type -> the text on the expected value in messages.
_EXPECTED: Final[Mapping[Any, str]] = {
    int: "a whole number is expected", str: "a text is expected", bool: "true or false is expected"
}  # fmt: skip


class _Missing:
    """Marks a value that could not be converted, whose fault is recorded already."""


MISSING = _Missing()


def structure(
    cls: type[T],
    raw: object,
    where: Location | str,
    problems: list[str],
    known: Mapping[str, object] | None = None,
    own: str = "1",
) -> T | None:
    """Return an instance of an attrs class with the values of a raw table, converted strictly.

    A float field takes values of `rollslip.units.quantity`, an int field whole numbers, a bool field true and false, a
    str field text; tuples take lists, attrs classes take tables. A field of a number or an attrs class takes either.
    Other values are not converted.

    Parameters
    ----------
    cls : type
        The attrs class.
    raw : object
        The table as it is written.
    where : Location or str
        Location of the table, for messages, or its dotted key.
    problems : list of str
        Messages on faults are added.
    known : mapping, optional
        Values by key that were converted before.
    own : str
        SI unit of values without a unit of their own (`rollslip.fields.own_unit`).

    Returns
    -------
    object
        The instance; None if there are faults.
    """
    if isinstance(where, str):
        where = Location({}, split_key(where) if where else ())
    bare, fields, by_key, _ = _layout(cls)  # type: ignore[arg-type]  # mypy takes a class for unhashable
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
    values = _converted_fields(cls, raw, where, faults, known, own)
    for key, attribute in by_key.items():
        if attribute.name not in values and attribute.default is attrs.NOTHING:
            kind = types_of(cls)[attribute.name]  # type: ignore[arg-type]
            faults.append(where.at(key).message(_required(kind, attribute)))
    if not faults:
        try:
            return cls(**{fields[name].alias or name: value for name, value in values.items()})
        except FieldError as error:
            faults.append(where.at(_key_of(by_key, error.field)).message(error.reason))
        except ValueError as error:
            faults.append(where.message(str(error)))
    problems += faults
    return None


def _key_of(by_key: "Mapping[str, attrs.Attribute[Any]]", name: str) -> str:
    """Return the key of a field by its name."""
    return next((key for key, attribute in by_key.items() if attribute.name == name), name)


def _converted_fields(
    cls: Any,
    raw: Mapping[str, object],
    where: Location,
    faults: list[str],
    known: Mapping[str, object] | None,
    own: str,
) -> dict[str, object]:
    """Return the values of a raw table by field; messages on wrong values and unknown keys are added to ``faults``."""
    _, _, by_key, rest = _layout(cls)
    values: dict[str, object] = {}
    others: dict[str, object] = {}
    kinds = types_of(cls)
    advice: Mapping[str, str] = getattr(cls, "advice", {})
    for key, value in raw.items():
        attribute = by_key.get(key)
        if attribute is None and rest is not None:
            others[key] = value
        elif attribute is None:
            faults.append(where.at(key).message(advice.get(key) or _unknown(key, by_key)))
        elif known is not None and key in known:
            values[attribute.name] = known[key]
        else:
            values[attribute.name] = _checked(
                kinds[attribute.name], value, attribute, where.at(key), faults, own
            )
            if values[attribute.name] is MISSING and key in advice:
                faults[-1] += f"; {advice[key]}"
    if rest is not None:
        values[rest.name] = _frozen(others, where, faults)
    return values


@cache
def _layout(
    cls: "type[Any]",
) -> "tuple[str | None, dict[str, attrs.Attribute[Any]], dict[str, attrs.Attribute[Any]], attrs.Attribute[Any] | None]":
    """Return the key of a bare name, the fields of a class by name and by key, and the field for all other keys."""
    fields = {a.name: a for a in attrs.fields(cls) if a.init}
    by_key = {key: a for key, a in fields_of(cls) if a.init and not a.metadata.get("rest")}
    rest = next((a for a in fields.values() if a.metadata.get("rest")), None)
    return bare_key(cls), fields, by_key, rest


@cache
def types_of(cls: "type[Any]") -> dict[str, Any]:
    """Return the types of the fields of a class, cached because their evaluation is slow."""
    return get_type_hints(cls)


def fields_of(cls: Any) -> "list[tuple[str, attrs.Attribute[Any]]]":
    """Return key and field of all fields of a class that have a key in a scene."""
    return [
        (key, a) for a in attrs.fields(cls) if (key := a.metadata.get("key", a.name)) is not None
    ]


def bare_key(cls: Any) -> str | None:
    """Return the key that a text in place of the table is the value of; None if the class has no such key."""
    return next((key for key, attribute in fields_of(cls) if attribute.metadata.get("bare")), None)


def _unknown(key: str, known: Collection[str]) -> str:
    """Return the message on an unknown key."""
    if similar := nearest(key, known, count=1):
        return f"unknown key, did you mean '{similar[0]}'?"
    return (
        f"unknown key; known are {', '.join(sorted(known))}"
        if known
        else "unknown key; there are none here"
    )


def _required(kind: object, attribute: "attrs.Attribute[Any]") -> str:
    """Return the message on a required key that is missing."""
    doc = attribute.metadata.get("doc")
    unit = attribute.metadata.get("unit")
    what = f" ({doc})" if doc else ""
    expected = expectation(unit) if unit else _EXPECTED.get(kind, "")
    return f"missing, but required{what}" + (
        f"; {_such_as(expected, attribute)}" if expected else ""
    )


def _such_as(text: str, attribute: "attrs.Attribute[Any]") -> str:
    """Replace the example of a unit in a message by a usual value of the field: no roughness such as 15 mm."""
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
            faults.append(
                where.message(_reason_in_given_unit(attribute, raw, value) or error.reason)
            )
        except (TypeError, ValueError) as error:
            faults.append(where.message(str(error.args[0] if error.args else error)))
    return value


def _reason_in_given_unit(attribute: "attrs.Attribute[Any]", raw: object, value: object) -> str:
    """Return the message of a validator on a value in the unit in which it is written; empty without a unit."""
    unit = attribute.metadata.get("unit")
    if (
        unit is None
        or isinstance(raw, bool)
        or not isinstance(raw, str | Real)
        or attribute.validator is None
    ):
        return ""
    with_unit = attribute.evolve(metadata={**attribute.metadata, "given": unit_given(raw, unit)})
    try:
        attribute.validator(None, with_unit, value)
    except FieldError as error:
        return error.reason
    return ""


def _converted(kind: Any, raw: object, unit: str, where: Location, faults: list[str]) -> object:
    """Return the value of a raw one as a type; `MISSING`, with a message in ``faults``, where it is wrong."""
    origin, arguments, is_attrs_class = _parts(kind)
    if origin in (Union, types.UnionType):
        return _converted_union(arguments, raw, unit, where, faults)
    if is_attrs_class:
        instance = structure(kind, raw, where, faults, own=unit)
        return MISSING if instance is None else instance
    if kind in (Any, object):
        return _frozen(raw, where, faults)
    if kind is float:
        return _converted_number(raw, unit, where, faults)
    if origin is tuple:
        return _converted_list(arguments, raw, unit, where, faults)
    if kind is FrozenTable or origin is Mapping:
        if isinstance(raw, Mapping):
            return _converted_table(arguments, raw, unit, where, faults)
    elif kind is int:
        if (number := _whole_number(raw)) is not None:
            return number
    elif kind not in (bool, str):
        raise TypeError(
            f"{_dotted(where.path)}: a field of type {kind} cannot be read from a scene"
        )
    elif isinstance(raw, kind):
        return raw
    expected = _EXPECTED.get(kind, "a table is expected")
    faults.append(where.message(f"{expected}, not {as_written(raw)}"))
    return MISSING


def _whole_number(raw: object) -> int | None:
    """Return a whole number, also one that is written as 3.0; None for other values."""
    if isinstance(raw, float) and raw.is_integer():
        raw = int(raw)
    if isinstance(raw, Integral) and not isinstance(raw, bool) and _is_storable(raw):
        return int(raw)
    return None


def _converted_union(
    kinds: tuple[Any, ...], raw: object, unit: str, where: Location, faults: list[str]
) -> object:
    """Return a value as the first type of a union; a table as the first attrs class, if there is one."""
    if raw is None and types.NoneType in kinds:
        return None
    first, *others = (kind for kind in kinds if kind is not types.NoneType)
    if others and isinstance(raw, Mapping):
        first = next((kind for kind in others if attrs.has(kind)), first)
    return _converted(first, raw, unit, where, faults)


def _converted_number(raw: object, unit: str, where: Location, faults: list[str]) -> object:
    """Return a quantity in its SI unit."""
    try:
        return quantity(raw, unit)
    except UnitError as error:
        hint = ""
        if isinstance(raw, list | tuple):
            resultant = "the resultant of components, or " * (unit == "N")
            hint = f"; give {resultant}one value: sweep takes several, --over {_dotted(where.path)}=A,B"
        faults.append(where.message(f"{error}{hint}"))
        return MISSING


def _converted_table(
    arguments: tuple[Any, ...],
    raw: Mapping[str, object],
    unit: str,
    where: Location,
    faults: list[str],
) -> object:
    """Return a table of values of one type, or of any values where there is no type."""
    if not arguments:
        return _frozen(raw, where, faults)
    items = {
        key: _converted(arguments[1], value, unit, where.at(key), faults)
        for key, value in raw.items()
    }
    return MISSING if MISSING in items.values() else FrozenTable(items)


@cache
def _parts(kind: Any) -> tuple[Any, tuple[Any, ...], bool]:
    """Return origin and arguments of a generic type, and whether a type is an attrs class."""
    return get_origin(kind), get_args(kind), attrs.has(kind)


def _converted_list(
    kinds: tuple[Any, ...], raw: object, unit: str, where: Location, faults: list[str]
) -> object:
    """Return a list as a tuple; a single name or table of a class with names is a list of one."""
    if isinstance(raw, str | Mapping) and attrs.has(kinds[0]) and bare_key(kinds[0]):
        raw = (raw,)
    if not isinstance(raw, list | tuple):
        faults.append(where.message(f"a list is expected, not {as_written(raw)}; put it in [ ]"))
        return MISSING
    if kinds[-1] is Ellipsis:
        kinds = kinds[:1] * len(raw)
    if len(kinds) != len(raw):
        faults.append(
            where.message(f"a list of {len(kinds)} values is expected, not of {len(raw)}")
        )
        return MISSING
    values = tuple(
        _converted(kind, value, unit, where.at(index), faults)
        for index, (kind, value) in enumerate(zip(kinds, raw, strict=True))
    )
    return MISSING if MISSING in values else values


def _frozen(raw: object, where: Location, faults: list[str]) -> object:
    """Return a value as it is written, read-only, if a scene may have such a value."""
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
    number = _frozen_number(raw)
    if number is MISSING:
        faults.append(
            where.message(
                f"{as_written(raw)} cannot be used: a finite number, a text, a list or a table can"
            )
        )
    return number


def _frozen_number(raw: object) -> object:
    """Return a number, also one of NumPy, as an int or a float; subclasses of these are retained."""
    if isinstance(raw, Integral):
        if _is_storable(raw):
            return raw if isinstance(raw, int) else int(raw)
    elif isinstance(raw, Real) and math.isfinite(raw):
        return raw if isinstance(raw, float) else float(raw)
    return MISSING


def _is_storable(number: Integral) -> bool:
    """Whether a whole number has at most 64 bits, as TOML and other programs require."""
    return -(2**63) <= int(number) < 2**63


# From scenes to plain values -----------------------------------------------------------------------------------------


def resolved(scene: Any) -> dict[str, object]:
    """Return a scene, or one of its tables, with all defaults as a nested dict of SI values.

    Reading it gives the same scene again. Optional values that are not set are left out, because TOML has no null.
    """
    table: dict[str, object] = {}
    for name, key, rest in _keys(type(scene)):  # type: ignore[arg-type]  # mypy takes a class for unhashable
        if (value := getattr(scene, name)) is None:
            continue
        plain = _plain(value)
        if rest and isinstance(plain, dict):
            table.update(plain)
        else:
            table[key] = plain
    return table


@cache
def _keys(cls: Any) -> list[tuple[str, str, bool]]:
    """Return the name of every field that has a key in a scene, the key, and whether it takes all other keys."""
    return [(a.name, key, bool(a.metadata.get("rest"))) for key, a in fields_of(cls)]


def _plain(value: object) -> object:
    """Return a value as plain lists and dicts."""
    if isinstance(value, str | float | int):
        return value
    if isinstance(value, Mapping):
        return {key: _plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return list(map(_plain, value))
    return resolved(value) if attrs.has(type(value)) else value


@cache
def _sorted(cls: Any) -> list[tuple[str, str]]:
    """Return fields and their keys, in the order of the keys."""
    return sorted(((name, key) for name, key, _ in _keys(cls)), key=operator.itemgetter(1))


#: Returns the text of plain values that is hashed.
_canonical: Final = json.JSONEncoder(
    sort_keys=True, separators=(",", ":"), ensure_ascii=True
).encode


def _contents(plain: object) -> str:
    """Return the digests of files that a table names by their full paths, as models and forms do."""
    if isinstance(plain, list):
        return "".join(map(_contents, plain))
    if not isinstance(plain, dict):
        return ""
    digests = "".join(map(_contents, plain.values()))
    file = plain.get("file")
    if (
        isinstance(file, str)
        and "\0" not in file
        and (path := Path(file)).is_absolute()
        and path.is_file()
    ):
        with contextlib.suppress(OSError):  # the reader of the file reports it
            digests += hashlib.sha256(path.read_bytes()).hexdigest()
    return digests


class SceneHashes:
    """Hashes of scenes that share tables with a first one, whose texts are computed once."""

    def __init__(self, scene: Any) -> None:
        self._scene = scene
        self._texts = dict[str, str]()

    def of(self, scene: Any) -> str:
        """Return the SHA-256 of a resolved scene with its files; equal scenes have equal hashes however written."""
        texts = []
        for name, key in _sorted(type(scene)):  # type: ignore[arg-type]
            if (value := getattr(scene, name)) is not None:
                is_shared = value is getattr(self._scene, name)
                text = self._texts.get(name) if is_shared else None
                if text is None:
                    plain = _plain(value)
                    files = "" if name in scene.digested_elsewhere else _contents(plain)
                    text = f"{_canonical(key)}:{_canonical(plain)}{files}"
                if is_shared:
                    self._texts[name] = text
                texts.append(text)
        return hashlib.sha256(f"{{{','.join(texts)}}}".encode()).hexdigest()


def scene_hash(scene: Any) -> str:
    """Return the hash of one scene; see `SceneHashes`."""
    return SceneHashes(scene).of(scene)
