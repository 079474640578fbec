"""A model that takes its place in a scene: by name, as a table, or made; and what the scene then says."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any, Final

import attrs

from rollslip.catalogue.discovery import available, get_class
from rollslip.catalogue.registry import structure_model
from rollslip.errors import PluginError, SceneError, UnknownNameError
from rollslip.models import SliceModel, left_to_scene
from rollslip.scene.values import Scene
from rollslip.structure import Location, fields_of

#: A model by name, as a table with ``model`` and its parameters, or made.
Model = str | Mapping[str, object] | SliceModel

KINDS: Final = ("contact", "film", "traction")
#: Kind -> the child of a composed model whose place is taken by a model that is not composed.
CHILD: Final = {"film": "film", "traction": "hydrodynamic"}


def loadable(kind: str) -> Iterator[tuple[str, Any]]:
    """Yield name and class of what is offered of a kind; what a broken package offers is left out."""
    for name in available(kind):
        with suppress(PluginError):
            yield name, get_class(kind, name)


@attrs.frozen
class Choice:
    """A model that takes its place in a scene: its name, how results call it, and what the scene then says."""

    name: str
    label: str
    full: str
    table: Mapping[str, object]


def choice_of(scene: Scene, kind: str, model: Model | None) -> Choice:
    """Return what a scene says with a model in it, by default its own."""
    problems = list[str]()
    unknown = list[PluginError]()
    made = read_choice(scene, kind, model, problems, unknown)
    refuse(problems, unknown)
    return made


def refuse(problems: Sequence[str], unknown: Sequence[PluginError]) -> None:
    """Raise all faults of choices at once, as of a plugin only where one is not a wrong name."""
    if unknown:
        named = all(isinstance(error, UnknownNameError) for error in unknown)
        texts = dict.fromkeys([*map(str, unknown), *problems])
        raise (UnknownNameError if named else PluginError)("\n".join(texts))
    if problems:
        raise SceneError(list(dict.fromkeys(problems)))


def read_choice(
    scene: Scene, kind: str, model: Model | None, problems: list[str], unknown: list[PluginError]
) -> Choice:
    """Return what a scene says with a model in it, by default its own; faults are noted."""
    choice = getattr(scene.models, kind)
    own: dict[str, object] = {"model": choice.name, **choice.parameters}
    inner = None
    table = own
    new = None
    try:
        standing = structure_model(kind, own, Location(scene.origins, ("models", kind)), problems)
        inner = (
            getattr(standing, child)
            if (child := CHILD.get(kind, "")) in _children(standing, kind)
            else None
        )
        if model is None:
            name = choice.name if inner is None else inner.name
            return Choice(name, name, name if inner is None else f"{name} in {choice.name}", own)
        table = _as_table(kind, model)
        new = structure_model(kind, table, Location({}, (kind,)), problems)
    except PluginError as error:
        unknown.append(error)
    name = str(table.get("model"))
    label = _label(table)
    bare = table.keys() == {"model"}
    if inner is not None and not _children(new, kind):
        same = bare and name == inner.name
        return Choice(
            name, label, f"{label} in {choice.name}", own if same else {**own, CHILD[kind]: table}
        )
    return Choice(name, label, label, own if bare and name == choice.name else table)


def _children(model: Any, kind: str) -> set[str]:
    """Parameters of a model that are models of its kind themselves; one that could not be made has none."""
    return {a.name for a in getattr(model, "__attrs_attrs__", ()) if a.metadata.get("kind") == kind}


def _as_table(kind: str, model: Model) -> dict[str, object]:
    """Return a model as a scene would state it."""
    if isinstance(model, str):
        return {"model": model}
    if isinstance(model, Mapping):
        return dict(model)
    if not isinstance(model, SliceModel):
        raise PluginError(
            f"{kind}: a name, a table with 'model' or a model is expected, not {model!r}"
        )
    if model.name not in available(kind) or get_class(kind, model.name) is not type(model):
        raise PluginError(
            f"{kind}: {type(model).__qualname__} is not what is called {model.name!r} here; register it"
        )
    table: dict[str, object] = {"model": model.name}
    left = left_to_scene(model)
    for key, attribute in fields_of(type(model)):
        if attribute not in left:
            value = getattr(model, attribute.name)
            child = attribute.metadata.get("kind")
            table[key] = _as_table(child, value) if child else value
    return table


def _label(table: Mapping[str, object]) -> str:
    """Name of a model, with the parameters that were stated: "pan-hamrock(thickness=central)"."""
    stated = {
        key: _label(v) if isinstance(v, Mapping) else v
        for key, v in table.items()
        if key != "model"
    }
    return str(table.get("model")) + (
        f"({', '.join(f'{key}={v}' for key, v in stated.items())})" if stated else ""
    )
