"""Choose a model of a scene: by name, as a table of parameters, or as an object, and the table of the changed scene.

A model that is not composed of others takes the place of the child of a composed one: the hydrodynamic traction of a
blend such as lambda-blend, or the film of a correction such as inlet-correction.
"""

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

#: A model: its name, a table with ``model`` and its parameters, or an object.
Model = str | Mapping[str, object] | SliceModel

#: Kinds of models that are compared.
KINDS: Final = ("contact", "film", "traction")
#: Field of the child, in a composed model of each kind, that a model which is not composed replaces.
CHILD: Final = {"film": "film", "traction": "hydrodynamic"}


def loadable(kind: str) -> Iterator[tuple[str, Any]]:
    """Yield name and class of all models, or studies, of a kind, without those of packages that cannot be imported."""
    for name in available(kind):
        with suppress(PluginError):
            yield name, get_class(kind, name)


@attrs.frozen
class Choice:
    """A model chosen for a scene.

    Attributes
    ----------
    name : str
        Name of the model.
    label : str
        Name with the parameters that were stated, for results.
    full_label : str
        Label with the composed model around it: "muraki in lambda-blend".
    table : mapping
        Table of this kind in the changed scene.
    """

    name: str
    label: str
    full_label: str
    table: Mapping[str, object]


def choice_of(scene: Scene, kind: str, model: Model | None) -> Choice:
    """Return the choice of a model for a scene, by default the scene's own; faults are raised.

    Parameters
    ----------
    scene : Scene
        The scene.
    kind : str
        Kind of the model: contact, film or traction.
    model : str, mapping, SliceModel or None
        The model; None for that of the scene.
    """
    problems = list[str]()
    unknown = list[PluginError]()
    choice = read_choice(scene, kind, model, problems, unknown)
    refuse(problems, unknown)
    return choice


def refuse(problems: Sequence[str], unknown: Sequence[PluginError]) -> None:
    """Raise all faults of choices in one error: `PluginError` if any model is at fault beyond a wrong name."""
    if unknown:
        named = all(isinstance(error, UnknownNameError) for error in unknown)
        texts = dict.fromkeys([*map(str, unknown), *problems])
        raise (UnknownNameError if named else PluginError)("\n".join(texts))
    if problems:
        raise SceneError(list(dict.fromkeys(problems)))


def read_choice(
    scene: Scene, kind: str, model: Model | None, problems: list[str], unknown: list[PluginError]
) -> Choice:
    """Return the choice of a model for a scene, by default the scene's own; add faults to `problems` and `unknown`."""
    choice = getattr(scene.models, kind)
    own: dict[str, object] = {"model": choice.name, **choice.parameters}
    inner = None
    table = own
    new = None
    try:
        present = structure_model(kind, own, Location(scene.origins, ("models", kind)), problems)
        inner = (
            getattr(present, child)
            if (child := CHILD.get(kind, "")) in _children(present, kind)
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
        if not bare or name != inner.name:
            own = {**own, CHILD[kind]: table}
        return Choice(name, label, f"{label} in {choice.name}", own)
    return Choice(name, label, label, own if bare and name == choice.name else table)


def _children(model: Any, kind: str) -> set[str]:
    """Return the parameters of a model that are models of the same kind; none if the model could not be made."""
    return {a.name for a in getattr(model, "__attrs_attrs__", ()) if a.metadata.get("kind") == kind}


def _as_table(kind: str, model: Model) -> dict[str, object]:
    """Return the table of a model in a scene."""
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
    """Return the name of a model with the parameters that were stated: "pan-hamrock(thickness=central)"."""
    stated = [
        f"{key}={_label(value) if isinstance(value, Mapping) else value}"
        for key, value in table.items()
        if key != "model"
    ]
    name = str(table.get("model"))
    return f"{name}({', '.join(stated)})" if stated else name
