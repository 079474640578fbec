"""Construct models by name from the parameters of a call or of a scene, with every fault of these at once.

`rollslip.catalogue.discovery` finds names and classes; its functions can be imported from here too.
"""

from collections.abc import Callable, Collection, Iterable, Mapping
from typing import Any, TypeAlias

import attrs

from rollslip.catalogue.discovery import available, catalogue, find, get_class, origin
from rollslip.catalogue.installed import Offer
from rollslip.catalogue.kinds import get_kind
from rollslip.errors import PluginError, describe_error
from rollslip.fields import FieldError
from rollslip.structure import Location, raise_problems, structure
from rollslip.toml import as_table

#: Returns constants of an oil for a law, as defaults of some of its parameters, by the name and parameters of the law.
Constants: TypeAlias = Callable[[str, Collection[str]], Mapping[str, object]]

__all__ = [
    "Offer",
    "available",
    "catalogue",
    "find",
    "get_class",
    "get_model",
    "packages_behind",
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
        Name, as in the list of ``rollslip models``.
    **parameters
        Its parameters: numbers in SI units or texts with a unit; for a parameter that is itself a model an instance, a
        name, or a mapping with ``model`` and its parameters.

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
    return right_model(kind, {"model": name, **parameters}, Location({}, (name,)))


def right_model(kind: str, raw: object, where: Location) -> Any:
    """Return the model that a name or a table stands for; all that is wrong with it is one `SceneError`."""
    problems = list[str]()
    model = structure_model(kind, raw, where, problems)
    raise_problems(problems)
    return model


def structure_models(
    kind: str, named: Iterable[tuple[str, Mapping[str, object]]], where: Location
) -> tuple[Any, ...]:
    """Return the models of a list in a scene, in their order.

    Parameters
    ----------
    kind : str
        Kind of the models.
    named : iterable of (str, mapping)
        Name and parameters of each.
    where : Location
        Location of the list, for messages.

    Raises
    ------
    SceneError
        With every fault of their parameters, and names that are repeated.
    """
    problems = list[str]()
    names = list[str]()
    models: list[Any] = []
    for k, (name, parameters) in enumerate(named):
        models.append(structure_model(kind, {"model": name, **parameters}, where.at(k), problems))
        names.append(name)
    if repeated := sorted({name for name in names if names.count(name) > 1}):
        problems.append(
            where.message(f"{' and '.join(map(repr, repeated))} stands there twice; name each once")
        )
    raise_problems(problems)
    return tuple(models)


def structure_model(
    kind: str,
    raw: object,
    where: Location,
    problems: list[str],
    constants: "Constants | None" = None,
) -> Any:
    """Return the model that a scene describes by a name or a table with ``model``.

    Parameters
    ----------
    kind : str
        Kind of the model.
    raw : object
        The name or the table; a model of the kind is returned as it is.
    where : Location
        Location of the model, for messages.
    problems : list of str
        Faults are added.
    constants : callable, optional
        Returns constants of the oil, as defaults of parameters, by the name of a law and its parameters.

    Returns
    -------
    object
        The model; None if there are faults.

    Raises
    ------
    PluginError
        If there is no such model, or its class raises.
    """
    if isinstance(raw, str):
        raw = {"model": raw}
    if isinstance(raw, get_kind(kind).base):
        return raw
    parameters = dict(as_table(raw))
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
        known = _known_constants(cls, name, constants, where, problems)
        blame = f"constant of the oil, lubricant.models.{name}"
        origins = {(*where.path, key): blame for key in known.keys() - parameters.keys()}
        where = Location({**where.origins, **origins}, where.path)
        parameters = known | parameters
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
        if model is not None and constants is not None:
            children = _default_children(model, children, constants, where, problems) | children
        return (
            model if model is None or None in children.values() else attrs.evolve(model, **children)
        )
    except FieldError as error:  # of a submodel, which the class checks only now
        problems.append(where.at(error.field).message(error.reason))
        return None
    except Exception as error:  # faults of the scene are in problems already
        blame = f"{kind} {name!r} cannot be made ({describe_error(error)}); {origin(cls)}"
        raise PluginError(where.message(blame)) from error


def _known_constants(
    cls: Any, name: str, constants: Constants, where: Location, problems: list[str]
) -> dict[str, Any]:
    """Return the constants of the oil for a law; unknown ones are added to ``problems``."""
    known = attrs.fields_dict(cls)
    table = Location(where.origins, ("lubricant", "models", name))
    values = dict[str, Any]()
    for key, value in constants(name, known).items():
        if key in known:
            values[key] = value
        else:
            problems.append(table.at(key).message(f"{name!r} has no parameter {key!r}"))
    return values


def _default_children(
    model: Any, stated: Collection[str], constants: Constants, where: Location, problems: list[str]
) -> dict[str, Any]:
    """Return the submodels that a scene does not state, with the constants of the oil for them."""
    children = dict[str, Any]()
    for attribute in attrs.fields(type(model)):
        if "kind" in attribute.metadata and attribute.name not in stated:
            own = getattr(model, attribute.name)
            if values := constants(own.name, attrs.fields_dict(type(own))):
                read = structure(type(own), values, where.at(attribute.name), problems)
                changes = {} if read is None else {key: getattr(read, key) for key in values}
                children[attribute.name] = attrs.evolve(own, **changes)
    return children


def packages_behind(name: str) -> dict[str, str]:
    """Return the packages of the study or campaign of a name, and of what reports on it, with their versions.

    Parameters
    ----------
    name : str
        Name of the study or campaign; without one of that name there are no packages.
    """
    kinds = [kind for kind in ("study", "campaign", "account") if name in available(kind)]
    return {offer.package: offer.version for offer in (find(kind, name) for kind in kinds)}
