"""Make models by name: from the parameters of a call or of a scene, with every fault of them at once.

Which names there are and what is behind them, `rollslip.catalogue.discovery` says; its functions are found here too.
"""

from collections.abc import Callable, Collection, Iterable, Mapping
from typing import Any, TypeAlias

import attrs

from rollslip.catalogue.discovery import available, catalogue, find, get_class, origin
from rollslip.catalogue.installed import Offer
from rollslip.catalogue.kinds import get_kind
from rollslip.errors import PluginError, SceneError, describe_error
from rollslip.fields import FieldError
from rollslip.structure import Location, structure

#: Name of a law and its parameters -> defaults of some of them.
Constants: TypeAlias = Callable[[str, Collection[str]], Mapping[str, object]]

__all__ = [
    "Offer",
    "available",
    "catalogue",
    "find",
    "get_class",
    "get_model",
    "structure_model",
    "structure_models",
]


def get_model(kind: str, name: str, **parameters: object) -> Any:
    """Return a model by name.

    Parameters
    ----------
    kind : str
        One of `rollslip.catalogue.kinds.kinds`: "contact", "film", "traction", "study" ...
    name : str
        Name as ``rollslip models`` lists it.
    **parameters
        Its parameters: numbers in SI units or strings with a unit; for a parameter that is itself a model an
        instance, a name, or a mapping with ``model`` and its parameters.

    Raises
    ------
    PluginError
        If there is no such model or its package cannot be used.
    SceneError
        If a parameter is unknown or has a value that is not allowed; all faults at once.

    Examples
    --------
    >>> get_model("traction", "lambda-blend", hydrodynamic="maxwell-eyring").hydrodynamic.name
    'maxwell-eyring'
    """
    if get_kind(kind).data or get_kind(kind).waits:
        if parameters:
            raise PluginError(
                f"a {kind} takes no parameters here, got {', '.join(parameters)}; set them in a scene"
            )
        return get_class(kind, name)
    problems: list[str] = []
    model = structure_model(kind, {"model": name, **parameters}, Location({}, (name,)), problems)
    if problems:
        raise SceneError(problems)
    return model


def structure_models(
    kind: str, named: Iterable[tuple[str, Mapping[str, object]]], where: Location
) -> tuple[Any, ...]:
    """Return models of a list in a scene, each by its name and parameters, in their order."""
    problems = list[str]()
    names = list[str]()
    models: list[Any] = []
    for k, (name, parameters) in enumerate(named):
        models.append(structure_model(kind, {"model": name, **parameters}, where.at(k), problems))
        names.append(name)
    if twice := sorted({name for name in names if names.count(name) > 1}):
        problems.append(
            where.message(f"{' and '.join(map(repr, twice))} stands there twice; name each once")
        )
    if problems:
        raise SceneError(problems)
    return tuple(models)


def structure_model(
    kind: str,
    raw: object,
    where: Location,
    problems: list[str],
    constants: "Constants | None" = None,
) -> Any:
    """Return the model that a scene describes, by a name or a table with ``model``, or None with its faults noted.

    ``constants`` gives defaults of its parameters, by its name and all that it has.
    """
    if isinstance(raw, str):
        raw = {"model": raw}
    if isinstance(raw, get_kind(kind).base):
        return raw
    parameters = dict(raw) if isinstance(raw, Mapping) else {}
    name = parameters.pop("model", None)
    if not isinstance(name, str):
        problems.append(
            where.message(f"a {kind} model is expected: its name, or a table with model = 'NAME'")
        )
        return None
    try:
        cls = get_class(kind, name)
    except PluginError as error:
        raise type(error)(where.message(str(error))) from error
    if constants is not None:
        known = attrs.fields_dict(cls)
        given = constants(name, attrs.fields_dict(cls))
        of_oil = Location(where.origins, ("lubricant", "models", name))
        problems += [
            of_oil.at(key).message(f"{name!r} has no parameter {key!r}")
            for key in given
            if key not in known
        ]
        parameters = {key: value for key, value in given.items() if key in known} | parameters
    children = {
        attribute.name: structure_model(
            attribute.metadata["kind"],
            parameters.pop(attribute.name),
            where.at(attribute.name),
            problems,
            constants,
        )
        for attribute in attrs.fields(cls)
        if "kind" in attribute.metadata and attribute.name in parameters
    }
    try:
        model = structure(cls, parameters, where, problems)
        if model is not None and constants is not None:  # those that the scene leaves to the law
            for attribute in attrs.fields(cls):
                if "kind" in attribute.metadata and attribute.name not in children:
                    own = getattr(model, attribute.name)
                    if given := constants(own.name, attrs.fields_dict(type(own))):
                        made = structure(type(own), given, where.at(attribute.name), problems)
                        values = (
                            {key: getattr(made, key) for key in given} if made is not None else {}
                        )
                        children[attribute.name] = attrs.evolve(own, **values)
        return (
            model if model is None or None in children.values() else attrs.evolve(model, **children)
        )
    except FieldError as error:  # of a child, which the class sees only now
        problems.append(where.at(error.field).message(error.reason))
        return None
    except Exception as error:  # what a scene can be blamed for is noted already
        blame = f"{kind} {name!r} cannot be made ({describe_error(error)}); {origin(cls)}"
        raise PluginError(where.message(blame)) from error
