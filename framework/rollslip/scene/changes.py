"""Change values of scenes by dotted key, from Python or from ``key=value`` on the command line."""

import re
from collections.abc import Mapping
from os import PathLike
from types import MappingProxyType
from typing import Any, Final, get_args, get_origin

import attrs

from rollslip.errors import SceneError, did_you_mean, nearest
from rollslip.fields import FieldError
from rollslip.files import readable
from rollslip.lubricant.table import OilTable
from rollslip.scene.reading import as_scene, checked_scene
from rollslip.scene.values import ModelChoice, Scene
from rollslip.structure import bare_key, fields_of, raise_problems, resolved, thawed, types_of
from rollslip.toml import DEEPEST, KeyPath, loads, split_key
from rollslip.units import as_written, quantity, typed, unit_given

__all__ = [
    "CHANGES",
    "NOTED",
    "SHORT",
    "KnownQuantities",
    "Quantity",
    "assumed_keys",
    "describe_unknown_key",
    "evolve",
    "full_key",
    "parse_set",
    "stated_values",
]

#: Short name of a key -> the key.
SHORT: Final[Mapping[str, str]] = MappingProxyType({
    "speed": "operation.inner_speed", "load": "operation.radial_load", "temperature": "operation.temperature",
    "clearance": "bearing.radial_clearance", "oil": "lubricant.name",
})  # fmt: skip
#: Short name or table that is given a name in place of a value -> the key which takes that name.
_NAME_KEYS: Final = {
    "bearing": "bearing.name",
    "cage": "cage.make",
    "clearance": "bearing.clearance_class",
}
#: Origin of values that were changed, in place of file and line.
CHANGES: Final = "changes"
#: Keys of the table of an oil, which is read later than the scene, where its laws are known.
_OIL_KEYS: Final = frozenset(attrs.fields_dict(OilTable))
#: A line of a new scene whose value was assumed, or that starts a table.
_ASSUMED: Final = re.compile(r"^\s*(?:\[([\w.-]+)\]|(\w+)\s*=.*#.*\bASSUMED\b)", re.MULTILINE)
#: Tables that a scene's note describes: a change of one makes the note invalid.
NOTED: Final = frozenset(
    {"bearing", "surface", "lubricant", "lubrication", "operation", "models", "cage"}
)


@attrs.frozen(eq=False)
class Quantity:
    """One value of a scene that can be varied."""

    #: Dotted key.
    key: str
    #: SI unit of a number; None for whole numbers, texts, choices and models.
    unit: str | None
    #: Meaning, in one line.
    doc: str
    #: Value in the scene; None if the scene has none.
    value: object
    #: Whether it is a whole number.
    whole: bool
    #: Its field, with the validator.
    attribute: "attrs.Attribute[Any]"
    #: Kind of the model that it names; empty if it names none.
    model: str = ""

    def read(self, raw: object, given: str | None = None) -> object:
        """Return a new value as the scene takes it, checked as far as a single value can be.

        Parameters
        ----------
        raw : object
            The value as it is written: a number in SI units, a text with a unit, a choice, a name.
        given : str, optional
            Unit in which messages show the value; by default that of ``raw``.

        Raises
        ------
        ValueError
            If the value is not possible.
        """
        value = raw
        attribute = self.attribute
        if self.unit is not None:
            value = quantity(raw, self.unit)
            if given is None:
                given = unit_given(raw, self.unit)
            attribute = attribute.evolve(metadata={**attribute.metadata, "given": given})
        elif self.whole:
            if isinstance(raw, bool) or not isinstance(raw, int | float) or raw != int(raw):
                raise FieldError(self.key, f"a whole number is expected, not {as_written(raw)}")
            value = int(raw)
        elif self.model:
            return raw  # a name or a table, which is read with the scene
        if self.attribute.validator is not None:
            self.attribute.validator(None, attribute, value)
        return value


class KnownQuantities(dict[str, Quantity]):
    """Quantities of a scene by key or by the short name of a key (`SHORT`)."""

    def __contains__(self, key: object) -> bool:
        return super().__contains__(full_key(str(key)))

    def __getitem__(self, key: str) -> Quantity:
        return super().__getitem__(full_key(key))

    def get(self, key: str, default: Any = None) -> Any:
        """Return the quantity of a `key`, or the `default`."""
        return super().get(full_key(key), default)


def full_key(key: str) -> str:
    """Return the key that a short name stands for, and any other key as it is."""
    return SHORT.get(key.strip(), key)


def describe_unknown_key(key: str, known: dict[str, Quantity]) -> str:
    """Return a message on a key that does not exist, with similar ones, or with the command that computes its study.

    Parameters
    ----------
    key : str
        The key that was given.
    known : dict of str to Quantity
        Quantities of the scene by key.
    """
    table, name, *_ = [*key.split("."), "", ""]
    if table == "study" and name and not any(k.startswith(f"study.{name}.") for k in known):
        return (
            f"is of study {name!r}, which is not computed here; sweep that by: rollslip sweep run SCENE --study "
            f"{name}, where values are uncertain with --samples N"
        )
    by_name = {k.rpartition(".")[2]: k for k in reversed(known)}
    near = nearest(key, known, count=1) or [
        by_name[name] for name in nearest(key.rpartition(".")[2], by_name, count=1)
    ]
    hint = did_you_mean(near, "'rollslip schema' and 'rollslip models NAME' list the keys")
    table = key.rpartition(".")[0]
    if table.count(".") > 1 and not any(k.startswith(f"{table}.") for k in known):
        return f"the scene has nothing in {table}, so there is no value of it to vary; add that table to the scene"
    return f"there is no single value of this key to vary; {hint}"


def evolve(
    scene: Scene | str | PathLike[str], changes: Mapping[str, object], *, si: bool = False
) -> Scene:
    """Return a scene with some values changed; their tables, and the relations of all values, are checked again.

    Parameters
    ----------
    scene
        The scene to start from, which is not modified; the name of a shipped one, or a file.
    changes
        New values by dotted key: ``{"lubricant.eyring_stress": "4 MPa", "models.film": "dowson-1968"}``. A table that
        is not in the scene yet starts from its defaults.
    si
        Whether numbers are in SI units. Otherwise a number is refused where the quantity has a unit, as on the command
        line: 3000 for a speed in rad/s is often meant in rpm.

    Returns
    -------
    Scene
        With the `source` and the `text` of the one it started from.

    Raises
    ------
    SceneError
        With every fault, those of the new values marked with "changes" in place of file and line.
    PluginError
        If a bearing or surface that it names does not exist.
    """
    scene = as_scene(scene)
    if not (isinstance(changes, Mapping) and all(isinstance(key, str) for key in changes)):
        given = as_written(changes)
        raise SceneError(
            [
                f"changes: values by key are expected, {{'operation.radial_load': '3 kN'}}, not {given}"
            ]
        )
    if not changes:
        return scene
    raw: dict[str, Any] = dict(scene.tables)
    origins = dict(scene.origins)
    problems = []
    changed = set[str]()
    for key, value in changes.items():
        try:
            requested = _requested_path(key, value)
            if requested[0] not in changed and requested[0] in raw:
                raw[requested[0]] = thawed(raw[requested[0]])
            changed.add(requested[0])
            plain = thawed(value)
            old_value, path = _set(raw, requested, plain if si else typed(plain))
        except (ValueError, RecursionError) as error:
            reason = "is nested too deeply" if isinstance(error, RecursionError) else str(error)
            problems.append(f"{CHANGES}: {as_written(key)} {reason}")
            continue
        _mark_changed(origins, path, old_value)
    raise_problems(problems)
    if changed & NOTED and "note" not in changed:  # the note may not apply to the changed scene
        raw.pop("note", None)
        origins.pop(("note",), None)
    unchanged = raw.keys() - changed
    if "bearing" in changed:  # cage and separator follow from the name of a bearing
        unchanged -= {"cage", "models"}
    known_tables = {key: getattr(scene, key) for key in unchanged}
    return checked_scene(raw, origins, scene.source, scene.text, known_tables)


def _mark_changed(origins: dict[KeyPath, str], path: KeyPath, old_value: object) -> None:
    """Make "changes" the origin of a path and of new tables above it; forget origins inside the value before."""
    if isinstance(old_value, dict | list):
        for below in [known for known in origins if known[: len(path)] == path]:
            del origins[below]
    for depth in range(1, min(len(path), DEEPEST)):
        origins.setdefault(path[:depth], CHANGES)
    origins[path] = CHANGES


def _requested_path(key: str, value: object) -> tuple[str, ...]:
    """Return the path of a key that is to be changed; raise ValueError where it cannot take the value."""
    path = split_key(full_key(key).strip())
    if key.strip() in _NAME_KEYS and str(value)[:1].isalpha() and isinstance(value, str):
        raise ValueError(f"takes no name; write {_NAME_KEYS[key.strip()]}={value}")
    if path[0] == "lubricant" and len(path) > 1 and path[1] not in _OIL_KEYS:
        near = nearest(path[1], _OIL_KEYS, count=1)
        raise ValueError(f"is not a key{f', did you mean {near[0]!r}?' if near else ''}")
    return path


def _set(table: Any, path: tuple[str, ...], value: object) -> tuple[object, KeyPath]:
    """Set a value deep in a raw scene; return the value before, and its path with indices into lists.

    A table that is left out, or is a bare name, becomes a table. An entry of a list of models is found by its name.
    """
    kind: Any = Scene
    where = list[str | int]()
    for part in path[:-1]:
        if isinstance(table, list):
            where.append(_named_entry(table, str(bare_key(kind)), str(part), where[-1]))
            table = table[int(where[-1])]
            continue
        attribute = dict(fields_of(kind)).get(str(part)) if attrs.has(kind) else None
        kind = types_of(kind)[attribute.name] if attribute is not None else None
        if type(None) in get_args(kind):
            kind = next((member for member in get_args(kind) if attrs.has(member)), kind)
        below = table.get(part)
        if (element := _element_type(kind, below)) is not None:
            kind = element
            table[part] = [below] if isinstance(below, str | dict) else list(below or ())
        elif not isinstance(below, dict):
            table[part] = _opened_table(below, kind, attribute, str(part))
        where.append(part)
        table = table[part]
    if isinstance(table, list):
        raise ValueError(
            f"does not exist: {path[-2]!r} is a list; add a parameter of one, or set all of the list"
        )
    old_value = table.get(path[-1])
    table[path[-1]] = value
    return old_value, (*where, path[-1])


def _named_entry(entries: list[Any], bare: str, name: str, key: object) -> int:
    """Return the index of the entry with a name in a list of models, whose bare names become tables."""
    tables = [entry if isinstance(entry, dict) else {bare: entry} for entry in entries]
    names = [str(table.get(bare)) for table in tables]
    if name not in names:
        raise ValueError(
            f"does not exist: {key!r} names {', '.join(names) or 'nothing'}, not {name!r}"
        )
    entries[:] = tables
    return names.index(name)


def _element_type(kind: Any, value: object) -> Any:
    """Return the class of the entries of a list of models; None where a key takes no such list."""
    element = get_args(kind)[0] if get_origin(kind) is tuple else None
    if kind is None and isinstance(value, list) and all(map(_names_a_model, value)):
        element = ModelChoice  # in a table that is read later, with its own class
    if element is not None and attrs.has(element) and bare_key(element) is not None:
        return element
    return None


def _opened_table(
    value: object, kind: Any, attribute: "attrs.Attribute[Any] | None", key: str
) -> dict[str, Any]:
    """Return the table that a bare name, or a missing value with the default of its field, stands for."""
    # parameters of a model are read later, with its own class; among them a name is that of a model within it
    table = ModelChoice if kind is None and _names_a_model(value) else kind
    bare = bare_key(table) if attrs.has(table) else None
    if isinstance(value, str) and bare is not None:
        return {bare: value}
    if value is not None:
        raise ValueError(f"does not exist: {key!r} is not a table")
    default = attribute.default if attribute is not None else None
    fields = fields_of(type(default)) if attrs.has(type(default)) else []
    if any(a.metadata.get("bare") and a.default is attrs.NOTHING for _, a in fields):
        return dict(resolved(default))
    return {}  # defaults of other tables are added when these are read


def _names_a_model(raw: object) -> bool:
    return isinstance(raw, dict) or (isinstance(raw, str) and raw[:1].isalpha())


def assumed_keys(scene: Scene) -> list[str]:
    """Return the dotted keys of the values that ``rollslip new`` assumed, as their comments say, and nobody changed."""
    table = ""
    keys = []
    for next_table, key in _ASSUMED.findall(scene.text):
        table = next_table or table
        path = (*table.split("."), key)
        origins = {scene.origins.get(path[:depth]) for depth in range(1, len(path) + 1)}
        if key and CHANGES not in origins:
            keys.append(".".join(path))
    return keys


def stated_values(scene: Scene) -> dict[str, Any]:
    """Return the tables of a scene as they are written, without the values that ``rollslip new`` assumed."""
    stated: dict[str, Any] = thawed(scene.tables)
    for key in assumed_keys(scene):
        *tables, name = key.split(".")
        below = stated
        for table in tables:
            below = below.get(table, {})
        below.pop(name, None)
    return stated


def parse_set(text: str) -> tuple[str, object]:
    """Split ``key=value`` of the command line into key and value.

    The value is read as TOML where it is a number, true, false, a list, a table or a quoted text; anything else is
    taken as a text, so that ``operation.radial_load=500 N`` and ``models.film=moes`` need no quotes. Where a quantity
    has a unit, a number without one is refused (`rollslip.units.typed`).

    Examples
    --------
    >>> parse_set("operation.radial_load=500 N"), parse_set("accuracy.slices=21")
    (('operation.radial_load', '500 N'), ('accuracy.slices', 21))
    """
    key, equals, value = readable(text).partition("=")
    if not equals or not key.strip():
        raise SceneError(
            [f"{as_written(text)}: write KEY=VALUE, such as operation.radial_load='500 N'"]
        )
    key = key.strip()
    value = value.strip()
    try:
        parsed = loads(f"value = {value}")
    except (ValueError, RecursionError):
        return key, value
    plain = parsed.keys() == {"value"} and isinstance(
        parsed["value"], bool | int | float | str | list | dict
    )
    return key, typed(parsed["value"]) if plain else value
