"""Find the models that installed packages offer, and load the ones that are asked for.

- The catalogue is read from package metadata; listing it imports nobody's code.
- Entry points are loaded one by one by us: pluggy's own loader stops at the first broken one and takes the host down.
- pluggy collects, once a name is asked for, what the module behind that name offers; after that a model is an object
  like any other and nothing of this is on the hot path.
"""

import difflib
import importlib.metadata
import os
from collections.abc import Mapping
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import attrs

from rollslip.errors import PluginError, SceneError
from rollslip.reading import Where, structure

if TYPE_CHECKING:
    import pluggy

#: Kind -> the hook that collects it; the entry-point group is "rollslip.<kind>".
KINDS: Final = MappingProxyType(
    {
        "contact": "contact_models",
        "film": "film_models",
        "traction": "traction_models",
        "drag": "drag_models",
        "integrator": "integrator_models",
        "lubricant": "lubricants",
    }
)


@attrs.frozen(kw_only=True)
class Offer:
    """One name that one installed package offers.

    ``state`` is "ok", "disabled" (by ROLLSLIP_DISABLED_PLUGINS), "incompatible" (its package requires another
    rollslip) or "shadowed" (two packages offer the name); ``cause`` says why in a sentence.
    """

    kind: str
    name: str
    package: str
    version: str
    module: str
    state: str = "ok"
    cause: str = ""


@cache
def catalogue() -> tuple[Offer, ...]:
    """Return everything offered, by kind and name, without importing any of it."""
    offers: dict[tuple[str, str, str], Offer] = {}
    for distribution in importlib.metadata.distributions():
        for point in distribution.entry_points:
            kind = point.group.removeprefix("rollslip.")
            if kind in KINDS and point.group != kind:
                state, cause = _state(distribution)
                offer = Offer(
                    kind=kind,
                    name=point.name,
                    package=distribution.name,
                    version=distribution.version,
                    module=point.value,
                    state=state,
                    cause=cause,
                )
                # a package found twice on the path is one package: the first one is what Python imports
                offers.setdefault((kind, point.name, distribution.name), offer)
    usable: dict[tuple[str, str], list[Offer]] = {}
    for offer in offers.values():
        if offer.state == "ok":
            usable.setdefault((offer.kind, offer.name), []).append(offer)
    return tuple(
        sorted(
            (_shadowed(offer, usable.get((offer.kind, offer.name), [])) for offer in offers.values()),
            key=lambda o: (list(KINDS).index(o.kind), o.name, o.package),
        )
    )


def available(kind: str) -> Mapping[str, Offer]:
    """Return the models of a kind that can be asked for: name -> offer.

    Parameters
    ----------
    kind : str
        "contact", "film", "traction", "drag", "integrator" or "lubricant".

    Raises
    ------
    PluginError
        If there is no such kind.
    """
    _check_kind(kind)
    return MappingProxyType({offer.name: offer for offer in catalogue() if offer.kind == kind and offer.state == "ok"})


def find(kind: str, name: str) -> Offer:
    """Return the offer behind a name.

    Raises
    ------
    PluginError
        If no package offers it (the message gives the nearest three), or the one that does cannot be used.
    """
    _check_kind(kind)
    offers = [offer for offer in catalogue() if offer.kind == kind and offer.name == name]
    for offer in offers:
        if offer.state == "ok":
            return offer
    if offers:
        raise PluginError(f"{kind} {name!r} of package {offers[0].package}: {offers[0].cause}")
    names = list(available(kind))
    near = difflib.get_close_matches(name, names, n=3, cutoff=0.4)
    hint = f"did you mean {' or '.join(map(repr, near))}?" if near else f"there are: {', '.join(names) or 'none'}"
    raise PluginError(f"no {kind} is called {name!r}; {hint} ('rollslip models {kind}' lists them)")


def get_class(kind: str, name: str) -> Any:
    """Return what a package offers under a name, a model class or a lubricant, importing only that package's module.

    Raises
    ------
    PluginError
        If the name is unknown, or its package cannot be imported or does not offer what its metadata promises.
    """
    return _load(find(kind, name))


@cache
def _load(offer: Offer) -> Any:
    blame = f"{offer.kind} {offer.name!r} of package {offer.package} {offer.version}"
    try:
        module = importlib.import_module(offer.module)
    except Exception as error:
        raise PluginError(
            f"{blame} cannot be imported ({type(error).__name__}: {error}); repair or uninstall {offer.package}"
        ) from error
    manager = _manager()
    if not manager.is_registered(module):
        manager.register(module, name=f"{offer.package}:{offer.module}")
    hook = getattr(manager.hook, KINDS[offer.kind])
    others = [plugin for plugin in manager.get_plugins() if plugin is not module]
    offered = [thing for things in manager.subset_hook_caller(hook.name, others)() for thing in things]
    for thing in offered:
        if getattr(thing, "name", None) == offer.name:
            return thing
    names = ", ".join(repr(getattr(thing, "name", None)) for thing in offered) or "nothing"
    raise PluginError(f"{blame}: its {hook.name}() offers {names}, but its entry point promises {offer.name!r}")


@cache
def _manager() -> "pluggy.PluginManager":
    import pluggy

    from rollslip import hookspecs

    manager = pluggy.PluginManager("rollslip")
    manager.add_hookspecs(hookspecs)
    return manager


def _check_kind(kind: str) -> None:
    if kind not in KINDS:
        near = difflib.get_close_matches(kind, KINDS, n=1)
        hint = f"did you mean {near[0]!r}?" if near else f"there are: {', '.join(KINDS)}"
        raise PluginError(f"no kind of model is called {kind!r}; {hint}")


def _state(distribution: importlib.metadata.Distribution) -> tuple[str, str]:
    """State of a package by its metadata alone."""
    disabled = {name.strip() for name in os.environ.get("ROLLSLIP_DISABLED_PLUGINS", "").split(",")}
    if distribution.name in disabled:
        return "disabled", "disabled by ROLLSLIP_DISABLED_PLUGINS; remove it there to use it"
    if distribution.name == "rollslip":
        return "ok", ""
    from packaging.requirements import InvalidRequirement, Requirement

    ours = importlib.metadata.version("rollslip")
    for line in distribution.requires or ():
        try:
            requirement = Requirement(line)
        except InvalidRequirement:
            continue  # pip already refused or accepted it; only a readable requirement on rollslip concerns us
        if requirement.name == "rollslip" and not requirement.specifier.contains(ours, prereleases=True):
            cause = f"requires rollslip{requirement.specifier}, this is {ours}; install a version that fits"
            return "incompatible", cause
    return "ok", ""


def _shadowed(offer: Offer, same_name: list[Offer]) -> Offer:
    if offer.state != "ok" or len(same_name) < 2:
        return offer
    packages = " and ".join(sorted(o.package for o in same_name))
    return attrs.evolve(
        offer,
        state="shadowed",
        cause=f"packages {packages} offer this name; uninstall one or put it in ROLLSLIP_DISABLED_PLUGINS",
    )


def get_model(kind: str, name: str, **parameters: object) -> Any:
    """Return a model by name.

    Parameters
    ----------
    kind : str
        "contact", "film", "traction", "drag", "integrator" or "lubricant".
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
    if kind == "lubricant":
        if parameters:
            raise PluginError(f"a lubricant takes no parameters here, got {', '.join(parameters)}; set them in a scene")
        return get_class(kind, name)
    problems: list[str] = []
    model = structure_model(kind, {"model": name, **parameters}, Where({}, (name,)), problems)
    if problems:
        raise SceneError(problems)
    return model


def structure_model(kind: str, raw: object, where: Where, problems: list[str]) -> Any:
    """Return the model that a scene describes, by a name or a table with ``model``, or None with its faults noted.

    Raises
    ------
    PluginError
        If there is no such model or its package cannot be used; the message gives the place in the scene.
    """
    if isinstance(raw, str):
        raw = {"model": raw}
    if not isinstance(raw, Mapping):
        return raw
    parameters = dict(raw)
    name = parameters.pop("model", None)
    if not isinstance(name, str):
        problems.append(where.says(f"a {kind} model is expected: its name, or a table with model = 'NAME'"))
        return None
    try:
        cls = get_class(kind, name)
    except PluginError as error:
        raise PluginError(where.says(str(error))) from error
    children = {
        attribute.name: structure_model(
            attribute.metadata["kind"], parameters.pop(attribute.name), where.at(attribute.name), problems
        )
        for attribute in attrs.fields(cls)
        if "kind" in attribute.metadata and attribute.name in parameters
    }
    model = structure(cls, parameters, where, problems)
    return model if model is None or None in children.values() else attrs.evolve(model, **children)
