"""Changes of scenes: what can vary, and values by dotted key, from Python or ``key=value`` of the command line."""

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
from rollslip.structure import bare_key, fields_of, resolved, thawed, types_of
from rollslip.toml import DEEPEST, KeyPath, loads, split_key
from rollslip.units import as_written, quantity, typed, unit_given

__all__ = [
    "CHANGES",
    "NOTED",
    "SHORT",
    "Known",
    "Quantity",
    "evolve",
    "full_key",
    "parse_set",
    "unknown",
]

#: A person's word for a key -> the key.
SHORT: Final[Mapping[str, str]] = MappingProxyType({
    "speed": "operation.inner_speed", "load": "operation.radial_load", "temperature": "operation.temperature",
    "clearance": "bearing.radial_clearance", "oil": "lubricant.name",
})  # fmt: skip
#: What a name may be meant for, where a person's word or a table is given one.
_NAMED: Final = {
    "bearing": "bearing.name",
    "cage": "cage.make",
    "clearance": "bearing.clearance_class",
}
CHANGES: Final = "changes"
#: What the table of an oil may have, which is read where its laws are known.
_OF_OIL: Final = frozenset(attrs.fields_dict(OilTable))
#: Tables of what a scene's note speaks of.
NOTED: Final = frozenset(
    {"bearing", "surface", "lubricant", "lubrication", "operation", "models", "cage"}
)


@attrs.frozen(eq=False)
class Quantity:
    """One value of a scene."""

    key: str  # its dotted key
    unit: str | None  # SI unit of a number; None for whole numbers, texts, choices and models
    doc: str  # what it means
    value: object  # what it is in the scene; None if the scene gives none
    whole: bool  # whether it is a whole number
    attribute: "attrs.Attribute[Any]"  # its field, with the validator
    model: str = ""  # kind of model that it names, empty if it is none

    def read(self, raw: object, given: str | None = None) -> object:
        """Return a value as the scene takes it, checked as far as one value on its own can be."""
        value = raw
        attribute = self.attribute
        if self.unit is not None:
            value = quantity(raw, self.unit)
            given = unit_given(raw, self.unit) if given is None else given
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


class Known(dict[str, Quantity]):
    """Quantities of a scene by key, found by a person's word for it too."""

    def __contains__(self, key: object) -> bool:
        return super().__contains__(full_key(str(key)))

    def __getitem__(self, key: str) -> Quantity:
        return super().__getitem__(full_key(key))

    def get(self, key: str, default: Any = None) -> Any:
        """Return the quantity of a key, or the default."""
        return super().get(full_key(key), default)


def full_key(key: str) -> str:
    """Return the key that a person's word stands for; any other as it is."""
    return SHORT.get(key.strip(), key)


def unknown(key: str, known: dict[str, Quantity]) -> str:
    """Say that there is no such key, and which there are like it; of another study, how that is computed."""
    of, name, *_ = [*key.split("."), "", ""]
    if of == "study" and name and not any(one.startswith(f"study.{name}.") for one in known):
        return (
            f"is of study {name!r}, which is not computed here; sweep that by: rollslip sweep run SCENE --study "
            f"{name}, where values are uncertain with --samples N"
        )
    tail = {one.rpartition(".")[2]: one for one in reversed(known)}
    near = nearest(key, known, count=1) or [
        tail[name] for name in nearest(key.rpartition(".")[2], tail, count=1)
    ]
    hint = did_you_mean(near, "'rollslip schema' and 'rollslip models NAME' list the keys")
    table = key.rpartition(".")[0]
    if table.count(".") > 1 and not any(one.startswith(f"{table}.") for one in known):
        return f"the scene has nothing in {table}, so there is no value of it to vary; add that table to the scene"
    return f"there is no single value of this key to vary; {hint}"


def evolve(scene: Scene | str | PathLike[str], changes: Mapping[str, object]) -> Scene:
    """Return a scene with some values changed; the tables that they stand in are checked anew, as is the whole.

    Parameters
    ----------
    scene
        The scene to start from, which stays as it is; the name of a shipped one, or a file.
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
    scene = as_scene(scene)
    if not (isinstance(changes, Mapping) and all(isinstance(key, str) for key in changes)):
        given = as_written(changes)
        raise SceneError(
            [
                f"changes: values by key are expected, {{'operation.radial_load': '3 kN'}}, not {given}"
            ]
        )
    raw: dict[str, Any] = dict(scene.tables)
    origins = dict(scene.origins)
    problems = []
    changed = set[str]()
    for key, value in changes.items():
        try:
            requested = split_key(full_key(key).strip())
            if key.strip() in _NAMED and str(value)[:1].isalpha() and isinstance(value, str):
                raise ValueError(f"takes no name; write {_NAMED[key.strip()]}={value}")
            if requested[0] == "lubricant" and len(requested) > 1 and requested[1] not in _OF_OIL:
                near = nearest(requested[1], _OF_OIL, count=1)
                raise ValueError(f"is no key{f', did you mean {near[0]!r}?' if near else ''}")
            if requested[0] not in changed and requested[0] in raw:
                raw[requested[0]] = thawed(raw[requested[0]])
            changed.add(requested[0])
            before, path = _set(raw, requested, thawed(value))
        except (ValueError, RecursionError) as error:
            reason = "is nested too deeply" if isinstance(error, RecursionError) else str(error)
            problems.append(f"{CHANGES}: {as_written(key)} {reason}")
            continue
        if isinstance(before, dict | list):
            for below in [known for known in origins if known[: len(path)] == path]:
                del origins[below]
        for opened in range(1, min(len(path), DEEPEST)):
            origins.setdefault(path[:opened], CHANGES)
        origins[path] = CHANGES
    if problems:
        raise SceneError(problems)
    if changed & NOTED and "note" not in changed:  # what it says of the scene holds no more
        raw.pop("note", None)
        origins.pop(("note",), None)
    follows = (
        {"cage", "models"} if "bearing" in changed else set()
    )  # a cage, or none, is what the bearing's name says
    kept = {key: getattr(scene, key) for key in raw.keys() - changed - follows}
    return checked_scene(raw, origins, scene.source, scene.text, kept)


def _set(table: Any, path: tuple[str, ...], value: object) -> tuple[object, KeyPath]:
    """Set a value deep in a raw scene; return the one before, and where it stands.

    A table left out or a bare name is written out. In a list of models one is found by its name.
    """
    kind: Any = Scene
    where = list[str | int]()
    for part in path[:-1]:
        if isinstance(table, list):
            name = where[-1]
            bare = str(bare_key(kind))
            entries = [one if isinstance(one, dict) else {bare: one} for one in table]
            names = [str(one.get(bare)) for one in entries]
            if part not in names:
                raise ValueError(
                    f"leads nowhere: {name!r} names {', '.join(names) or 'nothing'}, not {part!r}"
                )
            where.append(names.index(str(part)))
            table[:] = entries
            table = table[int(where[-1])]
            continue
        attribute = dict(fields_of(kind)).get(str(part)) if attrs.has(kind) else None
        kind = types_of(kind)[attribute.name] if attribute is not None else None
        if type(None) in get_args(kind):
            kind = next((one for one in get_args(kind) if attrs.has(one)), kind)
        below = table.get(part)
        several = get_args(kind)[0] if get_origin(kind) is tuple else None
        if kind is None and isinstance(below, list) and all(map(_names_a_model, below)):
            several = ModelChoice  # in a table that is read with its own class
        if several is not None and attrs.has(several) and bare_key(several) is not None:
            kind = several
            below = [below] if isinstance(below, str | dict) else list(below or ())
            table[part] = below
        elif not isinstance(below, dict):
            bare_of = bare_key(kind) if attrs.has(kind) else None
            if isinstance(below, str) and bare_of is not None:
                below = {bare_of: below}
            elif below is not None:
                raise ValueError(f"leads nowhere: {part!r} is not a table")
            else:
                default = attribute.default if attribute is not None else None
                choice = attrs.has(type(default)) and bare_key(type(default)) is not None
                below = (
                    resolved(default) if choice else {}
                )  # of other tables, defaults come when they are read
            table[part] = below
        where.append(part)
        table = below
    if isinstance(table, list):
        raise ValueError(
            f"leads nowhere: {path[-2]!r} is a list; add a parameter of one, or set all of the list"
        )
    before = table.get(path[-1])
    table[path[-1]] = value
    return before, (*where, path[-1])


def _names_a_model(raw: object) -> bool:
    return isinstance(raw, dict) or (isinstance(raw, str) and raw[:1].isalpha())


def parse_set(text: str) -> tuple[str, object]:
    """Split ``key=value`` of the command line into key and value.

    The value is read as TOML where it is a number, true, false, a list, a table or a quoted text; anything else is a
    text as it stands, so that ``operation.radial_load=500 N`` and ``models.film=moes`` need no quotes. Where a quantity
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
